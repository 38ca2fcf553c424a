//! The table of techniques: the only place where a new one is announced.
//!
//! A technique is one row here and one file in `shaders/integrators/`. `build.rs` reads the same table and compiles every
//! row, pass and backend; the command line, the tests and the documentation iterate it.

use crate::layout::{BIDIRECTIONAL_LENGTH, LIGHT_VERTEX_BYTES, PHOTON_BYTES, PHOTONS_OF_PATH};

/// What transport a technique accounts for; each kind is a part of the next.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Solves {
    /// Emission and light that was scattered once: paths of one and two segments.
    Direct,
    /// The same as the camera sees it by way of any number of mirrors and smooth glass.
    Mirrored,
    /// All of it: the rendering equation.
    Everything,
}

impl Solves {
    /// What it is, in words.
    pub fn what(self) -> &'static str {
        match self {
            Self::Direct => "emission and direct light",
            Self::Mirrored => "emission and direct light, also as mirrors and smooth glass show them",
            Self::Everything => "full light transport",
        }
    }
}

/// How the expected image relates to the true one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bias {
    /// The expected image is the true one at any number of samples.
    Unbiased,
    /// It is not, however many samples are taken; the text says what is missing.
    Biased(&'static str),
    /// It is not at any number of samples, but becomes so as that grows; the text says what is wrong until then.
    Consistent(&'static str),
}

/// Light that a technique cannot find, however many samples are taken, in scenes that have it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Missing {
    /// That of lights which no direction hits by chance.
    DeltaLights,
    /// What it becomes by way of mirrors and smooth glass.
    DeltaCaustics,
    /// Of that, what the camera sees by way of mirrors and smooth glass in turn.
    HiddenDeltaCaustics,
    /// What no path from a light can be shown to the camera from.
    Unshowable,
}

impl Missing {
    /// What it is, in words.
    pub fn what(self) -> &'static str {
        match self {
            Self::DeltaLights => "the light of points, spots, projectors and parallel light",
            Self::DeltaCaustics => "caustics of points, spots, projectors and parallel light",
            Self::HiddenDeltaCaustics => {
                "caustics of points, spots, projectors and parallel light that the camera sees by way of mirrors and smooth glass"
            }
            Self::Unshowable => {
                "the background as the camera sees it, and whatever it sees by way of mirrors and smooth glass"
            }
        }
    }
}

/// What a pass runs over.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Over {
    /// The pixels of the image, each with a run of samples; a part of them in each frame. One that comes after a pass over
    /// anything else begins a stage: its first frame waits until that has seen what all frames left.
    Pixels,
    /// All pixels, once they have all had their run of samples.
    Image,
    /// All places for vertices of light paths, likewise ([`Kept::Grid`]).
    LightVertices,
    /// All cells of the grid, likewise.
    Cells,
}

/// What is kept of paths from the lights.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kept {
    /// Nothing.
    Nothing,
    /// The vertices of each path, for the path from the camera of the same pixel and sample.
    Paths,
    /// Vertices of all paths of one sample, for all its paths from the camera to find in a grid: bytes of one, and how many of a
    /// path.
    Grid(u32, u32),
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
    /// The value that makes an unbiased technique biased, and what is wrong then.
    pub biased: Option<(&'static str, &'static str)>,
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
    /// Whether its samples reach pixels as splats: then its last pass is `resolve`.
    pub splats: bool,
    /// What it keeps of paths from the lights.
    pub kept: Kept,
    /// What it cannot find in scenes that have it.
    pub misses: &'static [Missing],
    /// The light that it is a good choice for; README.md says by which measurement.
    pub good_at: &'static str,
    /// The light that another technique is better for, and what it costs.
    pub bad_at: &'static str,
    /// Its parameters.
    pub parameters: &'static [Parameter],
}

const PIXELS: &[Pass] = &[Pass { name: "pixels", over: Over::Pixels }];

/// The pass that adds splats to the film.
const RESOLVE: Pass = Pass { name: "resolve", over: Over::Image };

/// The passes that put the vertices of light paths into the grid, see `shaders/lib/grid_main.glsl`.
const GRID: [Pass; 4] = [
    Pass { name: "grid-clear", over: Over::Cells },
    Pass { name: "grid-count", over: Over::LightVertices },
    Pass { name: "grid-allot", over: Over::Cells },
    Pass { name: "grid-fill", over: Over::LightVertices },
];

/// How strategies are weighed, see `shaders/lib/bidirectional.glsl`.
const WEIGHTS: Parameter = Parameter {
    name: "weights",
    about: "how the strategies for a path are combined: the power heuristic, the balance heuristic, or their plain mean",
    values: Values::Choice(&["power", "balance", "none"]),
    biased: None,
};

/// Within which paths from the camera meet vertices of light paths, see `src/render/merge_radius.rs`.
const RADIUS: Parameter = Parameter {
    name: "radius",
    about: "within which the first sample looks for light paths, as a share of the radius of all that does not emit; 0 is one over \
            the root of the number of light paths in a sample, which is that of pixels where there is room",
    values: Values::Number(0.0, 1.0, 0.0),
    biased: None,
};

/// How that shrinks.
const ALPHA: Parameter = Parameter {
    name: "alpha",
    about: "how slowly it shrinks: its square falls like samples^(alpha - 1), the variance like samples^-alpha",
    values: Values::Number(0.0, 1.0, 2.0 / 3.0),
    biased: None,
};

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
        kept: Kept::Nothing,
        misses: &[],
        good_at: "soft shadows, and to see each way of sampling them by itself",
        bad_at: "rooms: nothing in it has bounced twice",
        parameters: &[Parameter {
            name: "sampling",
            about: "what chooses the direction to the light: both with MIS, the lights, or the BSDF",
            values: Values::Choice(&["mis", "emitter", "bsdf"]),
            biased: None,
        }],
    },
    Integrator {
        name: "whitted",
        title: "recursive ray tracing (Whitted)",
        file: "whitted.glsl",
        passes: PIXELS,
        solves: Solves::Mirrored,
        bias: Bias::Unbiased,
        rr_depth: 5,
        splats: false,
        kept: Kept::Nothing,
        misses: &[],
        good_at: "mirrors and clear glass under direct light: one sample follows all branches",
        bad_at: "light between matte surfaces, and what glass lets through to them: it has neither",
        parameters: &[
            Parameter {
                name: "branches",
                about: "where glass or a coating both reflects and refracts: follow both, or one by chance",
                values: Values::Choice(&["both", "one"]),
                biased: None,
            },
            Parameter {
                name: "lights",
                about: "area: a random point of a light for each shadow ray; point: the same one of each triangle or sphere, so that \
                        shadows are sharp",
                values: Values::Choice(&["area", "point"]),
                biased: Some(("point", "its lights are points, whose shadows are sharp")),
            },
            Parameter {
                name: "shadow-rays",
                about: "rays to lights from each vertex, rounded down",
                values: Values::Number(1.0, 256.0, 1.0),
                biased: None,
            },
        ],
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
        kept: Kept::Nothing,
        misses: &[Missing::DeltaLights],
        good_at: "lamps and skies so large that chance finds them; the shortest path tracer to read",
        bad_at: "small lamps, which chance seldom finds",
        parameters: &[
            Parameter {
                name: "form",
                about: "unbiased: emission at every vertex, Russian roulette; biased: ends at the first light or at a fixed \
                        length (8 segments where --max-depth sets none)",
                values: Values::Choice(&["unbiased", "biased"]),
                biased: Some(("biased", "its biased form ends paths at the first light or at a fixed length")),
            },
            Parameter {
                name: "q",
                about: "probability that Russian roulette ends the path at a vertex",
                values: Values::Number(0.0, 0.99, 0.1),
                biased: None,
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
        kept: Kept::Nothing,
        misses: &[Missing::DeltaCaustics],
        good_at: "most scenes: wherever the camera's paths can aim at the light",
        bad_at: "caustics, and lamps hidden in their fittings",
        parameters: &[],
    },
    Integrator {
        name: "path-recursive",
        title: "explicit path tracing as the rendering equation recurses",
        file: "path_recursive.glsl",
        passes: PIXELS,
        solves: Solves::Everything,
        bias: Bias::Unbiased,
        rr_depth: 5,
        splats: false,
        kept: Kept::Nothing,
        misses: &[Missing::DeltaCaustics],
        good_at: "reading the rendering equation in the code",
        bad_at: "speed: what its calls wait for is kept in memory",
        parameters: &[Parameter {
            name: "returns",
            about: "radiance: each call weighs what the inner one returns; nothing: it hands the weight down and adds by itself, which \
                    is path to the last bit",
            values: Values::Choice(&["radiance", "nothing"]),
            biased: None,
        }],
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
        kept: Kept::Nothing,
        misses: &[Missing::Unshowable],
        good_at: "caustics on matte surfaces, which the camera sees directly",
        bad_at: "mirrors and glass, which stay black, and rooms of which the camera sees little",
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
        kept: Kept::Paths,
        misses: &[Missing::HiddenDeltaCaustics],
        good_at: "lamps in fittings, rooms lit by way of a wall, caustics seen directly",
        bad_at: "light that is easy to aim at, as a sample takes several times as long; caustics seen in mirrors",
        parameters: &[WEIGHTS],
    },
    Integrator {
        name: "vcm",
        title: "vertex connection and merging",
        file: "vcm.glsl",
        passes: &[
            Pass { name: "light", over: Over::Pixels },
            GRID[0],
            GRID[1],
            GRID[2],
            GRID[3],
            Pass { name: "camera", over: Over::Pixels },
            RESOLVE,
        ],
        solves: Solves::Everything,
        bias: Bias::Consistent("its merges are blurred by a radius that shrinks with every sample"),
        rr_depth: 5,
        splats: true,
        kept: Kept::Grid(LIGHT_VERTEX_BYTES, BIDIRECTIONAL_LENGTH - 1),
        misses: &[],
        good_at: "all kinds of light in one image, caustics seen in mirrors and glossy surfaces included",
        bad_at: "light that is easy to aim at: its samples take the longest",
        parameters: &[
            WEIGHTS,
            Parameter {
                name: "form",
                about: "which strategies take part: all; bpm, merges anywhere alone; ppm, a merge at the camera's first vertex that is no \
                        mirror or smooth glass; bpt, all but merges",
                values: Values::Choice(&["vcm", "bpm", "ppm", "bpt"]),
                biased: None,
            },
            RADIUS,
            ALPHA,
        ],
    },
    Integrator {
        name: "photon",
        title: "progressive photon mapping",
        file: "photon.glsl",
        passes: &[
            Pass { name: "light", over: Over::Pixels },
            GRID[0],
            GRID[1],
            GRID[2],
            GRID[3],
            Pass { name: "camera", over: Over::Pixels },
        ],
        solves: Solves::Everything,
        bias: Bias::Consistent("blurred by a radius that shrinks with every sample"),
        rr_depth: 5,
        splats: false,
        kept: Kept::Grid(PHOTON_BYTES, PHOTONS_OF_PATH),
        misses: &[],
        good_at: "caustics, also as mirrors and glass show them",
        bad_at: "glossy surfaces, and light that is easy to aim at",
        parameters: &[
            Parameter {
                name: "direct",
                about: "what brings light that was scattered once: next-event estimation, or photons like all other",
                values: Values::Choice(&["nee", "photons"]),
                biased: None,
            },
            RADIUS,
            ALPHA,
        ],
    },
];

impl Integrator {
    /// The stage of each pass: a pass over pixels begins another one where the pass before it was not over pixels.
    pub fn stages(&self) -> Vec<u32> {
        let mut stage = 0;
        let mut before = Over::Pixels;
        let mut next = |pass: &Pass| {
            stage += u32::from(pass.over == Over::Pixels && before != Over::Pixels);
            before = pass.over;
            stage
        };
        self.passes.iter().map(&mut next).collect()
    }
}

/// The row of that name.
pub fn find(name: &str) -> Option<&'static Integrator> {
    INTEGRATORS.iter().find(|row| row.name == name)
}
