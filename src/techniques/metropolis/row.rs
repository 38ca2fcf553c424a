//! The row of Metropolis light transport.

#[path = "structs.rs"]
pub mod structs;

use super::{
    Bias, Correlated, Missing, Over, Parameter, Pass, RESOLVE, RareLight, Solves, TechniqueRow, Values, pass_with,
};

/// Mutates the random numbers of `path`.
pub const PRIMARY: Pass = pass_with("primary", Over::Pixels, FORM.name, "primary");
/// Mutates the random numbers of one strategy of `bdpt` at a time.
pub const MULTIPLEXED: Pass = pass_with("multiplexed", Over::Pixels, FORM.name, "multiplexed");
/// Mutates the vertices of paths.
pub const PATHS: Pass = pass_with("paths", Over::Pixels, FORM.name, "paths");

/// What chains mutate.
pub const FORM: Parameter = Parameter {
    name: "form",
    about: "what is mutated: primary, the random numbers of path; multiplexed, those of one strategy of bdpt at a time; paths, \
            the vertices of paths of up to 32 segments",
    values: Values::Choice(&["primary", "multiplexed", "paths"]),
    biased: Some(("paths", "its paths have 32 segments at most")),
    misses: &[
        ("primary", Missing::DeltaCaustics),
        ("multiplexed", Missing::HiddenDeltaCaustics),
        ("paths", Missing::HiddenDeltaCaustics),
    ],
};
/// The probability of a large step.
pub const LARGE_STEP: Parameter = Parameter {
    name: "large-step",
    about: "probability of a large step: a mutation that samples an independent path",
    values: Values::Number(0.01, 1.0, 0.3),
    biased: None,
    misses: &[],
};
/// The most chains.
pub const CHAINS: Parameter = Parameter {
    name: "chains",
    about: "how many there are at most, as few less as make one mutation for each pixel and sample come out even; 0 is one for each \
            pixel, as far as they fit into 256 MiB",
    values: Values::Number(0.0, 16777216.0, 0.0),
    biased: None,
    misses: &[],
};
/// Bootstrap samples.
pub const BOOTSTRAP_SAMPLES: Parameter = Parameter {
    name: "candidates",
    about: "bootstrap samples: paths that chains may begin with, rounded down; there are as many as chains at least",
    values: Values::Number(1.0, 268435456.0, 1048576.0),
    biased: None,
    misses: &[],
};
/// The bound of the chains' target.
pub const BOUND: Parameter = Parameter {
    name: "bound",
    about: "K, in means of the target over all paths that contribute: a path of contribution w over density is visited in proportion to \
            w / (1 + w / K), and each visit counts for 1 + w / K",
    values: Values::Number(1.5, 1e9, 1000.0),
    biased: None,
    misses: &[],
};

/// Metropolis light transport.
pub const MLT: TechniqueRow = TechniqueRow {
    name: "mlt",
    title: "Metropolis light transport",
    file: "techniques/metropolis/mlt.glsl",
    passes: &[PRIMARY, MULTIPLEXED, PATHS, RESOLVE],
    solves: Solves::Everything,
    bias: Bias::Consistent("the mean that all visits of its chains are scaled by is estimated from the same paths"),
    rr_depth: 1,
    correlated: Correlated::Samples,
    tells_strategies: false,
    compensates_mis: false,
    misses: &[],
    rare: &[RareLight::HiddenCaustics],
    referee: false,
    good_at: "rooms lit by way of a wall: a path that was hard to find leads to its neighbours",
    bad_at: "light that next-event estimation samples well, where correlated samples gain nothing; light that it cannot sample (SDS paths)",
    measured: "`multiplexed` 21 times `path` in `bidirectional_room`, where `bdpt` has 80 times, and 0.028 in `cornell`; \
               `paths` over `bdpt` 0.15 (0.06 to 0.39) in `door_ajar`, 1.2 (0.2 to 7.0) in `torus_in_glass`, 0.25 (0.04 to \
               1.6) in `ring_caustic`: their means are right, and fireflies decide",
    spanish: [
        "todo el transporte de luz",
        "consistente: la media por la que se escalan las visitas de sus cadenas se estima con los mismos caminos",
        "salas iluminadas a través de una pared: un camino difícil de encontrar lleva a sus vecinos",
        "luz a la que es fácil apuntar, donde volver a los mismos caminos dice poco de nuevo; luz que solo el azar encuentra",
    ],
    parameters: &[FORM, LARGE_STEP, CHAINS, BOOTSTRAP_SAMPLES, BOUND],
};
