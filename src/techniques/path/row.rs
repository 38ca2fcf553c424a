//! The rows of the path tracers: all paths begin at the camera, and nothing is kept from one sample to the next.

use super::{Bias, Correlated, Missing, PIXELS, Parameter, RareLight, Solves, TechniqueRow, Values};

/// Direct lighting.
pub const DIRECT: TechniqueRow = TechniqueRow {
    name: "direct",
    title: "direct lighting",
    file: "techniques/path/direct.glsl",
    passes: PIXELS,
    solves: Solves::Direct,
    bias: Bias::Unbiased,
    rr_depth: 1,
    correlated: Correlated::Nothing,
    tells_strategies: false,
    compensates_mis: false,
    misses: &[],
    rare: &[],
    referee: true,
    good_at: "soft shadows, and to see each way of sampling them by itself",
    bad_at: "rooms: nothing in it has bounced twice",
    measured: "47 % of the light on surfaces in `cornell`, 30 % in `door_ajar`",
    spanish: [
        "emisión y luz directa",
        "insesgada",
        "sombras suaves, y ver por separado cada manera de muestrearlas",
        "habitaciones: en ella nada ha rebotado dos veces",
    ],
    parameters: &[Parameter {
        name: "sampling",
        about: "what chooses the direction to the light: both with MIS, the lights, or the BSDF",
        values: Values::Choice(&["mis", "emitter", "bsdf"]),
        biased: None,
        misses: &[],
    }],
};

/// Recursive ray tracing.
pub const WHITTED: TechniqueRow = TechniqueRow {
    name: "whitted",
    title: "recursive ray tracing (Whitted)",
    file: "techniques/path/whitted.glsl",
    passes: PIXELS,
    solves: Solves::Mirrored,
    bias: Bias::Unbiased,
    rr_depth: 5,
    correlated: Correlated::Nothing,
    tells_strategies: false,
    compensates_mis: false,
    misses: &[],
    rare: &[],
    referee: true,
    good_at: "mirrors and clear glass under direct light: one sample follows all branches",
    bad_at: "light between matte surfaces, and what glass lets through to them: it has neither",
    measured: "0.74 of the relMSE of one sampled branch on the glass of `cornell_spheres`, at equal rays",
    spanish: [
        "emisión y luz directa, también la que muestran los espejos y el vidrio liso",
        "insesgada",
        "espejos y vidrio claro bajo luz directa: una muestra sigue todas las ramas",
        "la luz entre superficies mates y la que un vidrio deja pasar hasta ellas: no tiene ninguna de las dos",
    ],
    parameters: &[
        Parameter {
            name: "branches",
            about: "where glass or a coating both reflects and refracts: follow both, or sample one",
            values: Values::Choice(&["both", "one"]),
            biased: None,
            misses: &[],
        },
        Parameter {
            name: "lights",
            about: "area: a random point of a light for each shadow ray; point: the middle of each triangle or sphere stands for all of \
                    it, so that shadows are sharp",
            values: Values::Choice(&["area", "point"]),
            biased: Some(("point", "its lights are points, whose shadows are sharp")),
            misses: &[],
        },
        Parameter {
            name: "shadow-rays",
            about: "rays to lights from each vertex, rounded down",
            values: Values::Number(1.0, 256.0, 1.0),
            biased: None,
            misses: &[],
        },
    ],
};

/// Path tracing by BSDF sampling alone.
pub const PATH_IMPLICIT: TechniqueRow = TechniqueRow {
    name: "path-implicit",
    title: "implicit path tracing (BSDF sampling only)",
    file: "techniques/path/path_implicit.glsl",
    passes: PIXELS,
    solves: Solves::Everything,
    bias: Bias::Unbiased,
    rr_depth: 1,
    correlated: Correlated::Nothing,
    tells_strategies: false,
    compensates_mis: false,
    misses: &[Missing::DeltaLights],
    rare: &[RareLight::Caustics],
    referee: false,
    good_at: "lamps and skies so large that BSDF samples hit them; the shortest path tracer to read",
    bad_at: "small lamps, which BSDF samples seldom hit",
    measured: "1/46 of `path` in `cornell`, 1/63 on `veach_mis`",
    spanish: [
        "todo el transporte de luz",
        "insesgada",
        "lámparas y cielos tan grandes que el azar los encuentra; es el trazador más corto de leer",
        "lámparas pequeñas, que el azar rara vez encuentra",
    ],
    parameters: &[
        Parameter {
            name: "form",
            about: "unbiased: emission at every vertex, Russian roulette; biased: ends at the first light or at a fixed \
                    length (8 segments where --max-depth sets none)",
            values: Values::Choice(&["unbiased", "biased"]),
            biased: Some(("biased", "its biased form ends paths at the first light or at a fixed length")),
            misses: &[],
        },
        Parameter {
            name: "q",
            about: "probability that Russian roulette ends the path at a vertex",
            values: Values::Number(0.0, 0.99, 0.1),
            biased: None,
            misses: &[],
        },
    ],
};

/// Path tracing with next-event estimation.
pub const PATH: TechniqueRow = TechniqueRow {
    name: "path",
    title: "explicit path tracing (next-event estimation with MIS)",
    file: "techniques/path/path.glsl",
    passes: PIXELS,
    solves: Solves::Everything,
    bias: Bias::Unbiased,
    rr_depth: 1,
    correlated: Correlated::Nothing,
    tells_strategies: false,
    compensates_mis: true,
    misses: &[Missing::DeltaCaustics],
    rare: &[RareLight::Caustics],
    referee: true,
    good_at: "most scenes: wherever next-event estimation samples the light",
    bad_at: "caustics, and lamps hidden in their fittings",
    measured: "46 times `path-implicit` in `cornell`; 1/93 of `photon` in `torus_in_glass`, 1/58 of `bdpt` in \
               `bidirectional_room`",
    spanish: [
        "todo el transporte de luz",
        "insesgada",
        "la mayoría de las escenas: siempre que los caminos de la cámara puedan apuntar a la luz",
        "cáusticas, y lámparas escondidas en sus pantallas",
    ],
    parameters: &[],
};

/// Path tracing, written as the rendering equation recurses.
pub const PATH_RECURSIVE: TechniqueRow = TechniqueRow {
    name: "path-recursive",
    title: "explicit path tracing as the rendering equation recurses",
    file: "techniques/path/path_recursive.glsl",
    passes: PIXELS,
    solves: Solves::Everything,
    bias: Bias::Unbiased,
    rr_depth: 1,
    correlated: Correlated::Nothing,
    tells_strategies: false,
    compensates_mis: true,
    misses: &[Missing::DeltaCaustics],
    rare: &[RareLight::Caustics],
    referee: false,
    good_at: "reading the rendering equation in the code",
    bad_at: "speed: what its calls wait for is kept in memory",
    measured: "0.55 of the samples per second of `path` in `cornell` on an H200",
    spanish: [
        "todo el transporte de luz",
        "insesgada",
        "leer la ecuación de render en el código",
        "la velocidad: lo que esperan sus llamadas se guarda en memoria",
    ],
    parameters: &[Parameter {
        name: "returns",
        about: "radiance: each call weighs what the inner one returns; nothing: it hands the weight down and adds by itself, which \
                is path, on lavapipe to the last bit",
        values: Values::Choice(&["radiance", "nothing"]),
        biased: None,
        misses: &[],
    }],
};
