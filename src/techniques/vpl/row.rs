//! The row of instant radiosity.

use super::{Bias, Correlated, Missing, Over, Parameter, Pass, RareLight, Solves, TechniqueRow, Values, pass};

/// Makes the virtual point lights of a sample.
pub const LIGHTS: Pass = pass("lights", Over::Jobs);
/// Gathers from them.
const CAMERA: Pass = pass("camera", Over::Pixels);

/// How many virtual point lights there are.
pub const SUBPATHS: Parameter = Parameter {
    name: "subpaths",
    about: "light subpaths of a sample, rounded down",
    values: Values::Number(1.0, 1_048_576.0, 1024.0),
    biased: None,
    misses: &[],
};

/// Instant radiosity.
pub const VPL: TechniqueRow = TechniqueRow {
    name: "vpl",
    title: "instant radiosity (virtual point lights)",
    file: "techniques/vpl/vpl.glsl",
    passes: &[LIGHTS, CAMERA],
    solves: Solves::Everything,
    bias: Bias::Unbiased,
    rr_depth: 1,
    correlated: Correlated::Pixels,
    tells_strategies: false,
    compensates_mis: false,
    misses: &[Missing::DeltaCaustics],
    rare: &[RareLight::Caustics],
    referee: false,
    good_at: "rooms with much light between matte surfaces: what is hard to reach for a path is shared by all pixels",
    bad_at: "corners and glossy surfaces, where virtual point lights show as splotches; caustics",
    measured: "51 times `path` (18 to 144) in `bidirectional_room`, where `bdpt` has 38; 0.40 in `cornell` and in `cornell_spheres`",
    spanish: [
        "todo el transporte de luz",
        "insesgada",
        "habitaciones con mucha luz entre superficies mates: lo que a un camino le cuesta alcanzar lo comparten todos los píxeles",
        "esquinas y superficies satinadas, donde las luces puntuales virtuales se ven como manchas; cáusticas",
    ],
    parameters: &[
        Parameter {
            name: "compensate",
            about: "yes: what clamping takes is found by paths that go on; no: it is lost, and caustics with it",
            values: Values::Choice(&["yes", "no"]),
            biased: Some(("no", "light between surfaces that are close is clamped, and caustics are missing")),
            misses: &[],
        },
        Parameter {
            name: "clamp",
            about: "bound of the geometry term between a vertex and a virtual point light, times the square of the radius of all that does \
                    not emit; 0 is none",
            values: Values::Number(0.0, 1e9, 10.0),
            biased: None,
            misses: &[],
        },
        Parameter {
            name: "gathered",
            about: "light subpaths whose virtual point lights a vertex gathers from, rounded down",
            values: Values::Number(1.0, 65536.0, 4.0),
            biased: None,
            misses: &[],
        },
        SUBPATHS,
    ],
};
