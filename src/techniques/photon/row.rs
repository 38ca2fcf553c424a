//! The row of progressive photon mapping.

#[path = "structs.rs"]
pub mod structs;

use super::merging::{ALPHA, GRID_ALLOT, GRID_CLEAR, GRID_COUNT, GRID_FILL, RADIUS};
use super::{Bias, Correlated, Over, Parameter, Pass, RareLight, Solves, TechniqueRow, Values, pass};

/// Traces light subpaths and stores photons.
pub const LIGHT: Pass = pass("light", Over::Pixels);
/// Traces camera paths and gathers photons.
pub const CAMERA: Pass = pass("camera", Over::Pixels);

/// Progressive photon mapping.
pub const PHOTON: TechniqueRow = TechniqueRow {
    name: "photon",
    title: "progressive photon mapping",
    file: "techniques/photon/photon.glsl",
    passes: &[LIGHT, GRID_CLEAR, GRID_COUNT, GRID_ALLOT, GRID_FILL, CAMERA],
    solves: Solves::Everything,
    bias: Bias::Consistent("blurred by a radius that shrinks with every sample"),
    rr_depth: 1,
    correlated: Correlated::Pixels,
    tells_strategies: false,
    compensates_mis: false,
    misses: &[],
    rare: &[RareLight::GlossyCaustics],
    referee: true,
    good_at: "caustics, also as mirrors and glass show them",
    bad_at: "glossy surfaces, and light that next-event estimation samples well",
    measured: "93 times `path` in `torus_in_glass`, 158 in `reflected_caustic`; 0.074 in `cornell`, 0.51 in `small_vcm`",
    spanish: [
        "todo el transporte de luz",
        "consistente: desenfocada en un radio que mengua con cada muestra",
        "cáusticas, también como las muestran los espejos y los vidrios",
        "superficies satinadas, y luz a la que es fácil apuntar",
    ],
    parameters: &[
        Parameter {
            name: "direct",
            about: "what estimates light that was scattered once: next-event estimation, or photons like all other",
            values: Values::Choice(&["nee", "photons"]),
            biased: None,
            misses: &[],
        },
        RADIUS,
        ALPHA,
    ],
};
