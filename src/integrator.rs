//! The table of techniques: the only place where a new one is announced.
//!
//! A technique is one row here and one file in `shaders/integrators/`. `build.rs` reads the same table and compiles every
//! row, pass and backend; the command line, the tests and the documentation iterate it.

/// What transport a technique accounts for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Solves {
    /// Emission and light that was scattered once: paths of one and two segments.
    Direct,
    /// All of it: the rendering equation.
    Everything,
}

/// How the expected image relates to the true one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bias {
    /// The expected image is the true one at any number of samples.
    Unbiased,
    /// It is not, however many samples are taken; the text says what is missing.
    Biased(&'static str),
}

/// What a pass runs over.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Over {
    /// The pixels of the image, each with a run of samples; a part of them in each frame.
    Pixels,
    /// All pixels, once they have all had their run of samples.
    Image,
}

/// One dispatch of a technique's frame.
#[derive(Clone, Copy, Debug)]
pub struct Pass {
    /// Its name: `PASS_<NAME>` is defined while its shader is compiled.
    pub name: &'static str,
    /// What it runs over.
    pub over: Over,
}

/// The values that a parameter takes.
#[derive(Clone, Copy, Debug)]
pub enum Values {
    /// One of these words; the shader gets the index. The first one is the default.
    Choice(&'static [&'static str]),
    /// A number between the first two; the third is the default. The shader gets its bits.
    Number(f32, f32, f32),
}

/// One parameter of a technique: the specialisation constant `PARAM0` is the first one's, and so on.
#[derive(Clone, Copy, Debug)]
pub struct Parameter {
    /// Its name on the command line: `-i technique:name=value`.
    pub name: &'static str,
    /// What it does.
    pub about: &'static str,
    /// What it may be.
    pub values: Values,
}

/// One technique.
#[derive(Clone, Copy, Debug)]
pub struct Integrator {
    /// Its name on the command line.
    pub name: &'static str,
    /// Its name in the literature.
    pub title: &'static str,
    /// Its file in `shaders/integrators/`.
    pub file: &'static str,
    /// The dispatches of one frame, in order.
    pub passes: &'static [Pass],
    /// What transport it accounts for.
    pub solves: Solves,
    /// How its expectation relates to the truth, with default parameters.
    pub bias: Bias,
    /// Segments after which Russian roulette may end a path, unless the scene or the command line says.
    pub rr_depth: u32,
    /// Whether its samples reach pixels as splats: then its last pass is [`RESOLVE`].
    pub splats: bool,
    /// Whether it keeps the vertices of a light path for each sample.
    pub light_vertices: bool,
    /// What it cannot find, where that depends on the scene.
    pub misses: Option<&'static str>,
    /// Whether it sees lights that no direction hits by chance: points, spots, parallel light.
    pub sees_delta_lights: bool,
    /// Its parameters.
    pub parameters: &'static [Parameter],
}

const PIXELS: &[Pass] = &[Pass { name: "pixels", over: Over::Pixels }];

/// The pass that adds splats to the film.
const RESOLVE: Pass = Pass { name: "resolve", over: Over::Image };

/// Every technique.
pub const INTEGRATORS: &[Integrator] = &[
    Integrator {
        name: "direct",
        title: "direct lighting",
        file: "direct.glsl",
        passes: PIXELS,
        solves: Solves::Direct,
        bias: Bias::Unbiased,
        rr_depth: 5,
        splats: false,
        light_vertices: false,
        misses: None,
        sees_delta_lights: true,
        parameters: &[Parameter {
            name: "sampling",
            about: "what chooses the direction to the light: both with MIS, the lights, or the BSDF",
            values: Values::Choice(&["mis", "emitter", "bsdf"]),
        }],
    },
    Integrator {
        name: "path-implicit",
        title: "implicit path tracing (BSDF sampling only)",
        file: "path_implicit.glsl",
        passes: PIXELS,
        solves: Solves::Everything,
        bias: Bias::Unbiased,
        rr_depth: 1,
        splats: false,
        light_vertices: false,
        misses: None,
        sees_delta_lights: false,
        parameters: &[
            Parameter {
                name: "form",
                about: "unbiased: emission at every vertex, Russian roulette; biased: ends at the first light or at a fixed \
                        length (8 segments where --max-depth sets none)",
                values: Values::Choice(&["unbiased", "biased"]),
            },
            Parameter {
                name: "q",
                about: "probability that Russian roulette ends the path at a vertex",
                values: Values::Number(0.0, 0.99, 0.1),
            },
        ],
    },
    Integrator {
        name: "path",
        title: "explicit path tracing (next-event estimation with MIS)",
        file: "path.glsl",
        passes: PIXELS,
        solves: Solves::Everything,
        bias: Bias::Unbiased,
        rr_depth: 5,
        splats: false,
        light_vertices: false,
        misses: None,
        sees_delta_lights: true,
        parameters: &[],
    },
    Integrator {
        name: "light",
        title: "light tracing",
        file: "light.glsl",
        passes: &[Pass { name: "paths", over: Over::Pixels }, RESOLVE],
        solves: Solves::Everything,
        bias: Bias::Unbiased,
        rr_depth: 5,
        splats: true,
        light_vertices: false,
        misses: Some("the background as the camera sees it, and whatever it sees by way of mirrors and smooth glass"),
        sees_delta_lights: true,
        parameters: &[],
    },
    Integrator {
        name: "bdpt",
        title: "bidirectional path tracing",
        file: "bdpt.glsl",
        passes: &[Pass { name: "light", over: Over::Pixels }, Pass { name: "camera", over: Over::Pixels }, RESOLVE],
        solves: Solves::Everything,
        bias: Bias::Unbiased,
        rr_depth: 5,
        splats: true,
        light_vertices: true,
        misses: None,
        sees_delta_lights: true,
        parameters: &[Parameter {
            name: "weights",
            about: "how the strategies for a path are combined: the power heuristic, the balance heuristic, or their plain mean",
            values: Values::Choice(&["power", "balance", "none"]),
        }],
    },
];

/// The row of that name.
pub fn find(name: &str) -> Option<&'static Integrator> {
    INTEGRATORS.iter().find(|row| row.name == name)
}
