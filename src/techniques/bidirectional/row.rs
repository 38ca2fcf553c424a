//! The rows of bidirectional path tracing and of vertex connection and merging.

use super::merging::{ALPHA, GRID_ALLOT, GRID_CLEAR, GRID_COUNT, GRID_FILL, RADIUS};
use super::{Bias, Correlated, Missing, Over, Parameter, Pass, RESOLVE, RareLight, Solves, TechniqueRow, Values, pass};

/// Traces light subpaths, splats their vertices and keeps them.
pub const LIGHT: Pass = pass("light", Over::Pixels);
/// Traces camera subpaths and connects them to light subpaths.
pub const CAMERA: Pass = pass("camera", Over::Pixels);

/// How strategies are weighed, see `shaders/techniques/bidirectional/mis.glsl`.
const WEIGHTS: Parameter = Parameter {
    name: "weights",
    about: "how the strategies for a path are combined: the power heuristic, the balance heuristic, or their plain mean",
    values: Values::Choice(&["power", "balance", "none"]),
    biased: None,
    misses: &[],
};

/// Bidirectional path tracing.
pub const BDPT: TechniqueRow = TechniqueRow {
    name: "bdpt",
    title: "bidirectional path tracing",
    file: "techniques/bidirectional/bdpt.glsl",
    passes: &[LIGHT, CAMERA, RESOLVE],
    solves: Solves::Everything,
    bias: Bias::Unbiased,
    rr_depth: 1,
    correlated: Correlated::Nothing,
    tells_strategies: true,
    compensates_mis: false,
    misses: &[Missing::HiddenDeltaCaustics],
    rare: &[RareLight::HiddenCaustics],
    referee: true,
    good_at: "lamps in fittings, rooms lit by way of a wall, caustics seen directly",
    bad_at: "light that next-event estimation samples well, as a sample takes several times as long; caustics seen in mirrors",
    measured: "58 times `path` in `bidirectional_room`, 185 in `caustic_small_light`; 0.50 in `cornell`, 0.91 in \
               `torus_in_glass`",
    spanish: [
        "todo el transporte de luz",
        "insesgada",
        "lámparas con pantalla, habitaciones iluminadas a través de una pared, cáusticas vistas directamente",
        "luz a la que es fácil apuntar, pues cada muestra tarda varias veces más; cáusticas vistas en espejos",
    ],
    parameters: &[WEIGHTS],
};

/// Vertex connection and merging.
pub const VCM: TechniqueRow = TechniqueRow {
    name: "vcm",
    title: "vertex connection and merging",
    file: "techniques/bidirectional/vcm.glsl",
    passes: &[LIGHT, GRID_CLEAR, GRID_COUNT, GRID_ALLOT, GRID_FILL, CAMERA, RESOLVE],
    solves: Solves::Everything,
    bias: Bias::Consistent("its merges are blurred by a radius that shrinks with every sample"),
    rr_depth: 1,
    correlated: Correlated::Pixels,
    tells_strategies: false,
    compensates_mis: false,
    misses: &[],
    rare: &[],
    referee: true,
    good_at: "all kinds of light in one image, caustics seen in mirrors and glossy surfaces included",
    bad_at: "light that next-event estimation samples well: its samples take the longest",
    measured: "97 times `path` in `ring_caustic`, 85 in `reflected_caustic`, 3.2 in `small_vcm`; 0.21 in `cornell`",
    spanish: [
        "todo el transporte de luz",
        "consistente: desenfocada en un radio que mengua con cada muestra",
        "toda clase de luz en una imagen, incluidas las cáusticas vistas en espejos y las superficies satinadas",
        "luz a la que es fácil apuntar: sus muestras son las que más tardan",
    ],
    parameters: &[
        WEIGHTS,
        Parameter {
            name: "form",
            about: "which strategies take part: all; bpm, merges anywhere alone; ppm, a merge at the camera's first vertex that is no \
                    mirror or smooth glass; bpt, all but merges; paths of more than 16 segments come from the camera alone",
            values: Values::Choice(&["vcm", "bpm", "ppm", "bpt"]),
            biased: None,
            misses: &[("bpt", Missing::HiddenDeltaCaustics)],
        },
        RADIUS,
        ALPHA,
    ],
};
