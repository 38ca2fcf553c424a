//! The row of radiosity.

#[path = "structs.rs"]
pub mod structs;

use super::{Bias, Correlated, Over, Parameter, Pass, Solves, TechniqueRow, Values, pass, pass_with};

/// Measures the albedo of patches.
pub const ALBEDO: Pass = pass("albedo", Over::Jobs);
/// Collects irradiance by rays that leave patches.
pub const GATHER: Pass = pass_with("gather", Over::Jobs, SOLVER.name, "gather");
/// Sends power from lights and patches along rays.
pub const SHOOT: Pass = pass_with("shoot", Over::Jobs, SOLVER.name, "shoot");
/// Adds to the irradiance of patches what was shot at them.
pub const COLLECT: Pass = pass_with("collect", Over::Jobs, SOLVER.name, "shoot");
/// Interpolates the irradiance of patches at their vertices.
pub const VERTICES: Pass = pass("vertices", Over::Jobs);
/// Shows the patches to the camera.
pub const PIXELS: Pass = pass("pixels", Over::Pixels);

/// How patches pass light on.
pub const SOLVER: Parameter = Parameter {
    name: "solver",
    about: "gather: patches collect light by rays that leave them; shoot: lights and patches send it out, by as many rays as \
            there is power",
    values: Values::Choice(&["gather", "shoot"]),
    biased: None,
    misses: &[],
};
/// How the image shows patches.
pub const SHOWN: Parameter = Parameter {
    name: "shown",
    about: "vertices: interpolated from the patches' corners; patches: as they are; gathered: light from the patches and the \
            lights, collected anew at each point",
    values: Values::Choice(&["vertices", "patches", "gathered"]),
    biased: None,
    misses: &[],
};
/// How small patches are.
pub const PATCHES: Parameter = Parameter {
    name: "patches",
    about: "along the longest edge in the scene; all others have as many as keeps them as large, rounded up",
    values: Values::Number(1.0, 65536.0, 32.0),
    biased: None,
    misses: &[],
};
/// The difference above which patches are quartered; 0 quarters none.
pub const ADAPTIVE: Parameter = Parameter {
    name: "adaptive",
    about: "above 0, patches may be up to 8 times as long as that where irradiance differs from one to the next by less than \
            this share of it",
    values: Values::Number(0.0, 10.0, 0.0),
    biased: None,
    misses: &[],
};
/// Rays of a patch in a round.
pub const RAYS: Parameter = Parameter {
    name: "rays",
    about: "that each patch sends out in a round, one of which goes before each sample of the image; 0 is as many as all \
            patches together have pixels, up to 64",
    values: Values::Number(0.0, 65536.0, 0.0),
    biased: None,
    misses: &[],
};

/// Radiosity.
pub const RADIOSITY: TechniqueRow = TechniqueRow {
    name: "radiosity",
    title: "radiosity by stochastic Jacobi iteration",
    file: "techniques/radiosity/radiosity.glsl",
    passes: &[ALBEDO, GATHER, SHOOT, COLLECT, VERTICES, PIXELS],
    solves: Solves::Diffuse,
    bias: Bias::Biased(
        "surfaces are diffuse, and patches of them have one irradiance each, which smaller patches make exact",
    ),
    rr_depth: 1,
    correlated: Correlated::Pixels,
    tells_strategies: false,
    compensates_mis: false,
    misses: &[],
    rare: &[],
    referee: true,
    good_at: "rooms that are diffuse: all of their light from any side, without noise once it is solved",
    bad_at: "sharp shadows, which patches blur, and all that is not diffuse, which it treats as if it were",
    measured: "2.1 times `path` in `cornell` within its first 1.7 s, with an error that stays: relMSE 1.2e-4",
    spanish: [
        "todo el transporte de luz, tomando por difusas todas las superficies",
        "sesgada: las superficies son difusas y cada parche tiene una sola irradiancia; con parches menores se vuelve exacta",
        "habitaciones difusas: toda su luz desde cualquier lado, sin ruido una vez resuelta",
        "sombras nítidas, que los parches desenfocan, y todo lo que no es difuso, que trata como si lo fuera",
    ],
    parameters: &[SOLVER, SHOWN, PATCHES, ADAPTIVE, RAYS],
};
