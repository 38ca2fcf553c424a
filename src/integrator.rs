//! The table of techniques: the only place where a new one is announced.
//!
//! A technique is one row here and one file in `shaders/integrators/`. `build.rs` reads the same table and compiles every
//! row, pass and backend; the command line, the tests and the documentation iterate it.

use crate::layout::{BIDIRECTIONAL_LENGTH, LightVertex, PHOTONS_OF_PATH, Photon};

/// What transport a technique accounts for; each kind is a part of the next.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Solves {
    /// Emission and light that was scattered once: paths of one and two segments.
    Direct,
    /// The same as the camera sees it by way of any number of mirrors and smooth glass.
    Mirrored,
    /// All of it between surfaces that are taken for diffuse.
    Diffuse,
    /// All of it: the rendering equation.
    Everything,
}

impl Solves {
    /// What it is, in words.
    pub fn what(self) -> &'static str {
        match self {
            Self::Direct => "emission and direct light",
            Self::Mirrored => "emission and direct light, also as mirrors and smooth glass show them",
            Self::Diffuse => "full light transport, all surfaces taken for diffuse",
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

/// Light that a technique finds, but only where a direction or a connection that was not aimed at it meets it by chance. Its samples are
/// rare and bright then, and a variance that is estimated before there were some says nothing of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Chance {
    /// What small lights become by way of mirrors and smooth glass.
    Caustics,
    /// Of that, what the camera sees by way of mirrors and smooth glass in turn.
    HiddenCaustics,
    /// What the camera sees by way of surfaces that are nearly smooth.
    Reflections,
    /// What glossy surfaces show of caustics.
    GlossyCaustics,
}

impl Chance {
    /// What it is, in words.
    pub fn what(self) -> &'static str {
        match self {
            Self::Caustics => "caustics of small lights",
            Self::HiddenCaustics => "caustics of small lights that the camera sees by way of mirrors and smooth glass",
            Self::Reflections => "what the camera sees in surfaces that are nearly smooth",
            Self::GlossyCaustics => "caustics of small lights on glossy surfaces",
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
    /// The patches of the scene ([`Kept::Patches`]), between samples of the image and in frames of their own.
    Patches,
    /// Their vertices, likewise.
    PatchVertices,
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
    /// Markov chains, each with its current path. Frames of no samples make the paths that they may begin with.
    Chains,
    /// No paths, but what patches of the scene's surfaces have received.
    Patches,
}

/// One dispatch of a technique's frame.
#[derive(Clone, Copy, Debug)]
pub struct Pass {
    /// Its name: `PASS_<NAME>` is defined while its shader is compiled.
    pub name: &'static str,
    /// What it runs over.
    pub over: Over,
    /// The parameter's value with which it takes part; nothing is always.
    pub with: Option<(&'static str, &'static str)>,
}

/// The values that a parameter takes.
#[derive(Clone, Copy, Debug)]
pub enum Values {
    /// One of these words; the shader gets the index. The first one is the default.
    Choice(&'static [&'static str]),
    /// A number between the first two; the third is the default. The shader gets its bits.
    Number(f32, f32, f32),
}

/// One parameter of a technique: the specialisation constant `PARAM0` is the first one's, and so on up to the fourth. Further ones are for
/// the host alone.
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
    /// What the technique cannot find with a value, besides what it never finds.
    pub misses: &'static [(&'static str, Missing)],
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
    /// What it finds only by chance in scenes that have it.
    pub by_chance: &'static [Chance],
    /// Whether it may make and check references: its samples are independent, and no other row finds the same light in the same way and
    /// sooner.
    pub referee: bool,
    /// The light that it is a good choice for.
    pub good_at: &'static str,
    /// The light that another technique is better for, and what it costs.
    pub bad_at: &'static str,
    /// A figure for both; README.md says from which measurements these are. Ratios are efficiencies, 1 / (relMSE x seconds).
    pub measured: &'static str,
    /// Its parameters.
    pub parameters: &'static [Parameter],
}

/// A pass that always takes part.
const fn pass(name: &'static str, over: Over) -> Pass {
    Pass { name, over, with: None }
}

/// One that takes part where a parameter has this value.
const fn pass_with(name: &'static str, over: Over, parameter: &'static str, value: &'static str) -> Pass {
    Pass { name, over, with: Some((parameter, value)) }
}

const PIXELS: &[Pass] = &[pass("pixels", Over::Pixels)];

/// The pass that adds splats to the film.
const RESOLVE: Pass = pass("resolve", Over::Image);

/// The passes that put the vertices of light paths into the grid, see `shaders/lib/grid_main.glsl`.
const GRID: [Pass; 4] = [
    pass("grid-clear", Over::Cells),
    pass("grid-count", Over::LightVertices),
    pass("grid-allot", Over::Cells),
    pass("grid-fill", Over::LightVertices),
];

/// How strategies are weighed, see `shaders/lib/bidirectional.glsl`.
const WEIGHTS: Parameter = Parameter {
    name: "weights",
    about: "how the strategies for a path are combined: the power heuristic, the balance heuristic, or their plain mean",
    values: Values::Choice(&["power", "balance", "none"]),
    biased: None,
    misses: &[],
};

/// Within which paths from the camera meet vertices of light paths, see `src/render/merge_radius.rs`.
const RADIUS: Parameter = Parameter {
    name: "radius",
    about: "within which the first sample looks for light paths, as a share of the radius of all that does not emit; 0 is one over \
            the root of the number of light paths in a sample, which is that of pixels where there is room",
    values: Values::Number(0.0, 1.0, 0.0),
    biased: None,
    misses: &[],
};

/// How that shrinks.
const ALPHA: Parameter = Parameter {
    name: "alpha",
    about: "how slowly it shrinks: its square falls like samples^(alpha - 1), the variance like samples^-alpha",
    values: Values::Number(0.01, 1.0, 2.0 / 3.0),
    biased: Some(("1", "with alpha=1 its radius stays as it is")),
    misses: &[],
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
        by_chance: &[],
        referee: true,
        good_at: "soft shadows, and to see each way of sampling them by itself",
        bad_at: "rooms: nothing in it has bounced twice",
        measured: "47 % of the light that surfaces show the camera in `cornell`, 30 % in `door_ajar`",
        parameters: &[Parameter {
            name: "sampling",
            about: "what chooses the direction to the light: both with MIS, the lights, or the BSDF",
            values: Values::Choice(&["mis", "emitter", "bsdf"]),
            biased: None,
            misses: &[],
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
        by_chance: &[],
        referee: true,
        good_at: "mirrors and clear glass under direct light: one sample follows all branches",
        bad_at: "light between matte surfaces, and what glass lets through to them: it has neither",
        measured: "0.74 of the relMSE of one branch by chance on the glass of `cornell_spheres`, at equal rays",
        parameters: &[
            Parameter {
                name: "branches",
                about: "where glass or a coating both reflects and refracts: follow both, or one by chance",
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
        by_chance: &[Chance::Caustics],
        referee: false,
        good_at: "lamps and skies so large that chance finds them; the shortest path tracer to read",
        bad_at: "small lamps, which chance seldom finds",
        measured: "1/46 of `path` in `cornell`, 1/63 on `veach_mis`",
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
        by_chance: &[Chance::Caustics],
        referee: true,
        good_at: "most scenes: wherever the camera's paths can aim at the light",
        bad_at: "caustics, and lamps hidden in their fittings",
        measured: "46 times `path-implicit` in `cornell`; 1/93 of `photon` in `torus_in_glass`, 1/58 of `bdpt` in \
                   `bidirectional_room`",
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
        by_chance: &[Chance::Caustics],
        referee: false,
        good_at: "reading the rendering equation in the code",
        bad_at: "speed: what its calls wait for is kept in memory",
        measured: "0.55 of the samples per second of `path` in `cornell` on an H200",
        parameters: &[Parameter {
            name: "returns",
            about: "radiance: each call weighs what the inner one returns; nothing: it hands the weight down and adds by itself, which \
                    is path, on lavapipe to the last bit",
            values: Values::Choice(&["radiance", "nothing"]),
            biased: None,
            misses: &[],
        }],
    },
    Integrator {
        name: "light",
        title: "light tracing",
        file: "light.glsl",
        passes: &[pass("paths", Over::Pixels), RESOLVE],
        solves: Solves::Everything,
        bias: Bias::Unbiased,
        rr_depth: 5,
        splats: true,
        kept: Kept::Nothing,
        misses: &[Missing::Unshowable],
        by_chance: &[Chance::Reflections],
        referee: true,
        good_at: "caustics on matte surfaces, which the camera sees directly",
        bad_at: "mirrors and glass, which stay black, and rooms of which the camera sees little",
        measured: "22 times `path` in `caustic_small_light`, 0.68 in `cornell`; 0.82 of the light of the former, 0.54 in \
                   `reflected_caustic`: the rest stays black",
        parameters: &[],
    },
    Integrator {
        name: "bdpt",
        title: "bidirectional path tracing",
        file: "bdpt.glsl",
        passes: &[pass("light", Over::Pixels), pass("camera", Over::Pixels), RESOLVE],
        solves: Solves::Everything,
        bias: Bias::Unbiased,
        rr_depth: 5,
        splats: true,
        kept: Kept::Paths,
        misses: &[Missing::HiddenDeltaCaustics],
        by_chance: &[Chance::HiddenCaustics],
        referee: true,
        good_at: "lamps in fittings, rooms lit by way of a wall, caustics seen directly",
        bad_at: "light that is easy to aim at, as a sample takes several times as long; caustics seen in mirrors",
        measured: "58 times `path` in `bidirectional_room`, 185 in `caustic_small_light`; 0.50 in `cornell`, 0.91 in \
                   `torus_in_glass`",
        parameters: &[WEIGHTS],
    },
    Integrator {
        name: "vcm",
        title: "vertex connection and merging",
        file: "vcm.glsl",
        passes: &[
            pass("light", Over::Pixels),
            GRID[0],
            GRID[1],
            GRID[2],
            GRID[3],
            pass("camera", Over::Pixels),
            RESOLVE,
        ],
        solves: Solves::Everything,
        bias: Bias::Consistent("its merges are blurred by a radius that shrinks with every sample"),
        rr_depth: 5,
        splats: true,
        kept: Kept::Grid(size_of::<LightVertex>() as u32, BIDIRECTIONAL_LENGTH - 1),
        misses: &[],
        by_chance: &[],
        referee: true,
        good_at: "all kinds of light in one image, caustics seen in mirrors and glossy surfaces included",
        bad_at: "light that is easy to aim at: its samples take the longest",
        measured: "97 times `path` in `ring_caustic`, 85 in `reflected_caustic`, 3.2 in `small_vcm`; 0.21 in `cornell`",
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
    },
    Integrator {
        name: "photon",
        title: "progressive photon mapping",
        file: "photon.glsl",
        passes: &[pass("light", Over::Pixels), GRID[0], GRID[1], GRID[2], GRID[3], pass("camera", Over::Pixels)],
        solves: Solves::Everything,
        bias: Bias::Consistent("blurred by a radius that shrinks with every sample"),
        rr_depth: 5,
        splats: false,
        kept: Kept::Grid(size_of::<Photon>() as u32, PHOTONS_OF_PATH),
        misses: &[],
        by_chance: &[Chance::GlossyCaustics],
        referee: true,
        good_at: "caustics, also as mirrors and glass show them",
        bad_at: "glossy surfaces, and light that is easy to aim at",
        measured: "93 times `path` in `torus_in_glass`, 158 in `reflected_caustic`; 0.074 in `cornell`, 0.51 in `small_vcm`",
        parameters: &[
            Parameter {
                name: "direct",
                about: "what brings light that was scattered once: next-event estimation, or photons like all other",
                values: Values::Choice(&["nee", "photons"]),
                biased: None,
                misses: &[],
            },
            RADIUS,
            ALPHA,
        ],
    },
    Integrator {
        name: "mlt",
        title: "Metropolis light transport",
        file: "mlt.glsl",
        passes: &[
            pass_with("primary", Over::Pixels, "form", "primary"),
            pass_with("multiplexed", Over::Pixels, "form", "multiplexed"),
            pass_with("paths", Over::Pixels, "form", "paths"),
            RESOLVE,
        ],
        solves: Solves::Everything,
        bias: Bias::Consistent("the mean that all visits of its chains are scaled by is estimated from the same paths"),
        rr_depth: 5,
        splats: true,
        kept: Kept::Chains,
        misses: &[],
        by_chance: &[Chance::HiddenCaustics],
        referee: false,
        good_at: "rooms lit by way of a wall: a path that was hard to find leads to its neighbours",
        bad_at: "light that is easy to aim at, where visits to the same paths say little that is new; light that only chance finds",
        measured: "`multiplexed` 21 times `path` in `bidirectional_room`, where `bdpt` has 80 times, and 0.028 in `cornell`; \
                   `paths` over `bdpt` 0.15 (0.06 to 0.39) in `door_ajar`, 1.2 (0.2 to 7.0) in `torus_in_glass`, 0.25 (0.04 to \
                   1.6) in `ring_caustic`: their means are right, and fireflies decide",
        parameters: &[
            Parameter {
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
            },
            Parameter {
                name: "large-step",
                about: "probability that a mutation draws all numbers anew",
                values: Values::Number(0.01, 1.0, 0.3),
                biased: None,
                misses: &[],
            },
            Parameter {
                name: "chains",
                about: "how many there are at most, as few less as make one mutation for each pixel and sample come out even; 0 is one for each \
                        pixel, as far as they fit into 256 MiB",
                values: Values::Number(0.0, 16777216.0, 0.0),
                biased: None,
                misses: &[],
            },
            Parameter {
                name: "candidates",
                about: "paths that chains may begin with, rounded down; there are as many as chains at least",
                values: Values::Number(1.0, 268435456.0, 1048576.0),
                biased: None,
                misses: &[],
            },
            Parameter {
                name: "bound",
                about: "K, in means of the target over all paths that bring anything: one that brings w is visited in proportion to w / (1 + w / K), \
                        and each visit counts for 1 + w / K",
                values: Values::Number(1.5, 1e9, 1000.0),
                biased: None,
                misses: &[],
            },
        ],
    },
    Integrator {
        name: "radiosity",
        title: "radiosity by stochastic Jacobi iteration",
        file: "radiosity.glsl",
        passes: &[
            pass("albedo", Over::Patches),
            pass_with("gather", Over::Patches, "solver", "gather"),
            pass_with("shoot", Over::Patches, "solver", "shoot"),
            pass_with("collect", Over::Patches, "solver", "shoot"),
            pass("vertices", Over::PatchVertices),
            pass("pixels", Over::Pixels),
        ],
        solves: Solves::Diffuse,
        bias: Bias::Biased(
            "surfaces are diffuse, and patches of them have one irradiance each, which smaller patches make exact",
        ),
        rr_depth: 5,
        splats: false,
        kept: Kept::Patches,
        misses: &[],
        by_chance: &[],
        referee: true,
        good_at: "rooms that are diffuse: all of their light from any side, without noise once it is solved",
        bad_at: "sharp shadows, which patches blur, and all that is not diffuse, which it treats as if it were",
        measured: "2.1 times `path` in `cornell` within its first 1.7 s, with an error that stays: relMSE 1.2e-4",
        parameters: &[
            Parameter {
                name: "solver",
                about: "gather: patches collect light by rays that leave them; shoot: lights and patches send it out, by as many rays as \
                        there is power",
                values: Values::Choice(&["gather", "shoot"]),
                biased: None,
                misses: &[],
            },
            Parameter {
                name: "shown",
                about: "vertices: interpolated from the patches' corners; patches: as they are; gathered: light from the patches and the \
                        lights, collected anew at each point",
                values: Values::Choice(&["vertices", "patches", "gathered"]),
                biased: None,
                misses: &[],
            },
            Parameter {
                name: "patches",
                about: "along the longest edge in the scene; all others have as many as keeps them as large, rounded up",
                values: Values::Number(1.0, 65536.0, 32.0),
                biased: None,
                misses: &[],
            },
            Parameter {
                name: "adaptive",
                about: "above 0, patches may be up to 8 times as long as that where irradiance differs from one to the next by less than \
                        this share of it",
                values: Values::Number(0.0, 10.0, 0.0),
                biased: None,
                misses: &[],
            },
            Parameter {
                name: "rays",
                about: "that each patch sends out in a round, one of which goes before each sample of the image; 0 is as many as all \
                        patches together have pixels, up to 64",
                values: Values::Number(0.0, 65536.0, 0.0),
                biased: None,
                misses: &[],
            },
        ],
    },
];

/// The stage of each of some passes: a pass over pixels begins another one where the pass before it was not over pixels.
pub fn stages<'a>(passes: impl Iterator<Item = &'a Pass>) -> Vec<u32> {
    let mut stage = 0;
    let mut before = Over::Pixels;
    let next = |pass: &Pass| {
        if matches!(pass.over, Over::Patches | Over::PatchVertices) {
            return stage; // not in the frames of the image
        }
        stage += u32::from(pass.over == Over::Pixels && before != Over::Pixels);
        before = pass.over;
        stage
    };
    passes.map(next).collect()
}

/// The row of that name.
pub fn find(name: &str) -> Option<&'static Integrator> {
    INTEGRATORS.iter().find(|row| row.name == name)
}
