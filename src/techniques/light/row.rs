//! The row of light tracing.

use super::{Bias, Correlated, Missing, Over, Pass, RESOLVE, RareLight, Solves, TechniqueRow, pass};

/// Traces light subpaths and splats their vertices.
pub const PATHS: Pass = pass("paths", Over::Pixels);

/// Light tracing.
pub const LIGHT: TechniqueRow = TechniqueRow {
    name: "light",
    title: "light tracing",
    file: "techniques/light/light.glsl",
    passes: &[PATHS, RESOLVE],
    solves: Solves::Everything,
    bias: Bias::Unbiased,
    rr_depth: 1,
    correlated: Correlated::Nothing,
    tells_strategies: false,
    compensates_mis: false,
    misses: &[Missing::NotConnectableToCamera],
    rare: &[RareLight::Reflections],
    referee: true,
    good_at: "caustics on matte surfaces, which the camera sees directly",
    bad_at: "mirrors and glass, which stay black, and rooms of which the camera sees little",
    measured: "22 times `path` in `caustic_small_light`, 0.68 in `cornell`; 0.82 of the light of the former, 0.54 in \
               `reflected_caustic`: the rest stays black",
    spanish: [
        "todo el transporte de luz",
        "insesgada",
        "cáusticas sobre superficies mates que la cámara ve directamente",
        "espejos y vidrios, que quedan negros, y habitaciones de las que la cámara ve poco",
    ],
    parameters: &[],
};
