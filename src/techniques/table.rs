//! The table of techniques: the only place where a new one is announced.
//!
//! A technique has a row in its family's folder and its shader, and is named in `families` here, with what it keeps on the device.
//! `build.rs` includes the same table and compiles a module for every row, pass and backend; the command line, the tests and the documentation iterate it.

#[path = "merging/row.rs"]
pub mod merging;

use crate::layout::SharedStruct;

/// Calls `$callback! { FAMILIES }`. A family is `FOLDER "ROWS' FILE": ROW keeps STATE, ROW keeps STATE;`: the constants of its rows in
/// `FOLDER/row.rs`, and with each the state's kind in `FOLDER/mod.rs`. `with structs` before the colon: `row.rs` has a module `structs`
/// of what the family's shaders alone share with the host.
///
/// The build script, which knows no states, leaves them out; `mod.rs` makes the states' modules and [`TechniqueRow::state`] of them.
macro_rules! families {
    ($callback:ident) => {
        $callback! {
            path "path/row.rs": DIRECT keeps Nothing, WHITTED keeps Nothing, PATH_IMPLICIT keeps Nothing, PATH keeps Nothing,
                PATH_RECURSIVE keeps Nothing;
            light "light/row.rs": LIGHT keeps LightTracing;
            bidirectional "bidirectional/row.rs": BDPT keeps Connecting, VCM keeps ConnectingAndMerging;
            photon "photon/row.rs" with structs: PHOTON keeps PhotonMapping;
            metropolis "metropolis/row.rs" with structs: MLT keeps MarkovChains;
            radiosity "radiosity/row.rs" with structs: RADIOSITY keeps Patches;
            vpl "vpl/row.rs": VPL keeps VirtualLights;
        }
    };
}
pub(crate) use families;

macro_rules! rows {
    ($( $family:ident $file:literal $(with $structs:ident)? : $($row:ident keeps $state:ident),+ ; )+) => {
        $(
            #[path = $file]
            pub mod $family;
        )+

        /// Every technique, in the order in which they are listed.
        pub const TECHNIQUES: &[TechniqueRow] = &[$($($family::$row),+),+];

        /// The structs that families of techniques share with their shaders alone.
        pub fn structs() -> impl Iterator<Item = &'static SharedStruct> {
            let families: &[&'static [SharedStruct]] = &[$($($family::$structs::STRUCTS,)?)+];
            families.iter().copied().flatten()
        }
    };
}
families!(rows);

/// What transport a technique accounts for; each kind is a part of the next.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Solves {
    /// Emission and light that was scattered once: paths of one and two segments.
    Direct,
    /// Emission and direct light, also as the camera sees them by way of any number of mirrors and smooth glass.
    Mirrored,
    /// Full light transport between surfaces, each of which is taken for diffuse.
    Diffuse,
    /// Full light transport: the rendering equation.
    Everything,
}

impl Solves {
    /// What it is, in words.
    pub fn what(self) -> &'static str {
        match self {
            Self::Direct => "emission and direct light",
            Self::Mirrored => {
                "emission and direct light, also as mirrors, smooth glass and what is as smooth show them"
            }
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
    /// The expected image differs from the true one at any number of samples; the text says what is missing.
    Biased(&'static str),
    /// The expected image differs from the true one by what tends to 0 with the number of samples; the text says what is wrong until
    /// then.
    Consistent(&'static str),
}

/// Light that a technique cannot find, however many samples are taken, in scenes that have it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Missing {
    /// All light of delta lights (point, spot, projector, directional), which no BSDF sample hits.
    DeltaLights,
    /// Caustics of delta lights: their light by way of mirrors and smooth glass.
    DeltaCaustics,
    /// Caustics of delta lights that the camera sees by way of mirrors and smooth glass in turn (SDS paths).
    HiddenDeltaCaustics,
    /// Light that no vertex of a light subpath can be connected to the camera for: the background as the camera sees it, and all that
    /// the camera sees by way of mirrors, smooth glass and what is as smooth (`NARROW_ALPHA`).
    NotConnectableToCamera,
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
            Self::NotConnectableToCamera => {
                "the background as the camera sees it, and whatever it sees by way of mirrors, smooth glass and what is as smooth"
            }
        }
    }
}

/// Light that a technique finds in rare, bright samples alone, where its next-event estimation or its connections cannot sample it and a
/// BSDF sample must hit it. A variance that is estimated before such a sample came is too low.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RareLight {
    /// Caustics of small lights: their light by way of mirrors and smooth glass.
    Caustics,
    /// Caustics of small lights that the camera sees by way of mirrors and smooth glass in turn (SDS paths).
    HiddenCaustics,
    /// What the camera sees in surfaces that are nearly smooth.
    Reflections,
    /// Caustics of small lights that the camera sees in glossy surfaces.
    GlossyCaustics,
}

impl RareLight {
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

/// What of a technique's samples is correlated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Correlated {
    /// Nothing: all samples of all pixels are independent.
    Nothing,
    /// The pixels of one sample, which share light subpaths: the variance of a pixel's samples tells the pixel's error, but a mean over
    /// pixels is off by more than those variances say.
    Pixels,
    /// The pixels of one sample and the samples of one pixel: the variance of samples does not tell the error.
    Samples,
}

/// What a pass runs over.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Over {
    /// The pixels of the image, each with a run of samples; each frame takes a part of the pixels. A pass over pixels that comes after a
    /// pass over anything else begins a stage: its first frame waits until the pass before has seen what all frames left.
    Pixels,
    /// All pixels, once all of them have had their run of samples.
    Image,
    /// All elements of something that the technique keeps, once all pixels have had their run of samples; the technique's state says how
    /// many elements there are.
    Elements,
    /// What a job goes over that the technique's state asks for, between samples of the image and in submissions of its own.
    Jobs,
}

/// One dispatch of a technique: a constant of its family, by which its state and the renderer refer to it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pass {
    /// The pass's name within its technique, see [`Pass::define`] and [`TechniqueRow::module`].
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

/// How many parameters of a technique, from the first on, its shaders get: specialisation constants `PARAM0`, `PARAM1` and so on, which
/// they call by the parameters' names ([`TechniqueRow::parameters_glsl`]). Further ones are for the host alone.
pub const SHADER_PARAMETERS: usize = 4;

/// One parameter of a technique.
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
pub struct TechniqueRow {
    /// Its name on the command line.
    pub name: &'static str,
    /// Its name in the literature.
    pub title: &'static str,
    /// Its shader's path in `shaders/`.
    pub file: &'static str,
    /// Its passes, in the order in which a frame dispatches them.
    pub passes: &'static [Pass],
    /// What transport it accounts for.
    pub solves: Solves,
    /// How its expectation relates to the truth, with default parameters.
    pub bias: Bias,
    /// Segments after which Russian roulette may end a path, unless the scene or the command line says.
    pub rr_depth: u32,
    /// What of its samples is correlated.
    pub correlated: Correlated,
    /// Whether its film can tell strategies (s, t) apart.
    pub tells_strategies: bool,
    /// Whether each light sample is combined with a BSDF sample by MIS, so that next-event estimation may leave what of the environment is darker than
    /// its mean to the latter (MIS compensation, Karlik et al. 2019).
    pub compensates_mis: bool,
    /// What it cannot find in scenes that have it.
    pub misses: &'static [Missing],
    /// What it finds in rare, bright samples alone in scenes that have it.
    pub rare: &'static [RareLight],
    /// Whether it may make and check references: its samples are independent, and no other row finds the same light in the same way and
    /// sooner.
    pub referee: bool,
    /// The light that it is a good choice for.
    pub good_at: &'static str,
    /// The light that another technique is better for, and what it costs.
    pub bad_at: &'static str,
    /// A figure for both; docs/speed.md and docs/light_paths.md have the measurements. Ratios are efficiencies, 1 / (relMSE x seconds).
    pub measured: &'static str,
    /// In Spanish, for the page of the lecture: what it solves, its bias, what it is good and bad at.
    pub spanish: [&'static str; 4],
    /// Its parameters.
    pub parameters: &'static [Parameter],
}

impl Pass {
    /// The macro that is defined while the pass is compiled: `PASS_GRID_CLEAR`.
    pub fn define(&self) -> String {
        format!("PASS_{}", self.name.to_uppercase().replace('-', "_"))
    }
}

impl TechniqueRow {
    /// Whether its samples reach pixels as splats.
    pub fn splats(&self) -> bool {
        self.passes.contains(&RESOLVE)
    }

    /// Whether all its subpaths begin at the camera, and nothing is kept between dispatches: it has the pass over pixels alone.
    pub fn is_unidirectional(&self) -> bool {
        self.passes == PIXELS
    }

    /// Whether all its subpaths begin at lights, and reach the image by connections to the camera.
    pub fn is_light_tracing(&self) -> bool {
        self.misses.contains(&Missing::NotConnectableToCamera)
    }

    /// Whether it merges camera subpaths with the vertices of light subpaths nearby.
    pub fn merges(&self) -> bool {
        self.passes.contains(&merging::GRID_FILL)
    }

    /// The name of the module of one pass for a backend: `vcm.grid-clear.bvh`.
    pub fn module(&self, pass: &Pass, backend: &str) -> String {
        format!("{}.{}.{backend}", self.name, pass.name)
    }

    /// The text of `generated/parameters.glsl` in its modules: for each parameter that a shader gets a macro that is its value, and for
    /// each word of a choice a constant to compare it with: `SAMPLING == SAMPLING_EMITTER`, `1.0 - Q`.
    pub fn parameters_glsl(&self) -> String {
        let upper = |name: &str| name.to_uppercase().replace('-', "_");
        let mut text = format!("// Generated from the row of {}.\n", self.name);
        for (index, parameter) in self.parameters.iter().take(SHADER_PARAMETERS).enumerate() {
            let name = upper(parameter.name);
            match parameter.values {
                Values::Choice(words) => {
                    text += &format!("#define {name} PARAM{index}\n");
                    for (value, word) in words.iter().enumerate() {
                        text += &format!("const uint {name}_{} = {value}u;\n", upper(word));
                    }
                }
                Values::Number(..) => text += &format!("#define {name} uintBitsToFloat(PARAM{index})\n"),
            }
        }
        text
    }
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

/// The stage of each of some passes: a pass over pixels begins another one where the pass before it was not over pixels.
pub fn stages<'a>(passes: impl Iterator<Item = &'a Pass>) -> Vec<u32> {
    let mut stage = 0;
    let mut before = Over::Pixels;
    let next = |pass: &Pass| {
        if pass.over == Over::Jobs {
            return stage; // not in the frames of the image
        }
        stage += u32::from(pass.over == Over::Pixels && before != Over::Pixels);
        before = pass.over;
        stage
    };
    passes.map(next).collect()
}

/// The row of that name.
pub fn find(name: &str) -> Option<&'static TechniqueRow> {
    TECHNIQUES.iter().find(|row| row.name == name)
}
