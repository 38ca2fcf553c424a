//! What to render with.

use super::radiosity::shoots;
use crate::bvh::CHUNK;
use crate::error::{Error, Result, one_of};
use crate::gpu::Gpu;
use crate::integrator::{self, Chance, INTEGRATORS, Integrator, Kept, Missing, Parameter, Pass, Solves, Values};
use crate::layout::backend::Backend;
use crate::sampler::{SAMPLERS, Sampler};
use crate::scene::camera::ImagePlane;
use crate::scene::{Filter, Needs, Scene};
use crate::spirv::Arithmetic;
use crate::strategies::{LONGEST, Strategies};

/// Materials that a warning names; of more it says how many there are.
const NAMED: usize = 8;

/// A row of the table with values for its parameters.
#[derive(Clone, Debug)]
pub struct Technique {
    /// The row.
    pub row: &'static Integrator,
    /// One value per parameter of the row, as text.
    values: Vec<String>,
}

impl Technique {
    /// The technique of that name with its default parameters, or with those that follow: `direct:sampling=bsdf`.
    pub fn parse(text: &str) -> Result<Self> {
        let mut parts = text.split(':');
        let name = parts.next().unwrap_or_default();
        let row = integrator::find(name).ok_or_else(|| {
            Error::Usage(format!("no technique '{name}': valid are {}", one_of(INTEGRATORS.iter().map(|row| row.name))))
        })?;
        let mut technique =
            Self { row, values: row.parameters.iter().map(|parameter| default_text(&parameter.values)).collect() };
        for part in parts {
            let (name, value) = part.split_once('=').ok_or_else(|| {
                Error::Usage(format!("'{part}' in '{text}': a parameter is written {}:name=value", row.name))
            })?;
            technique.set(name, value)?;
        }
        Ok(technique)
    }

    /// Sets one parameter.
    pub fn set(&mut self, name: &str, value: &str) -> Result<()> {
        let row = self.row;
        let index = row.parameters.iter().position(|parameter| parameter.name == name).ok_or_else(|| {
            let valid = if row.parameters.is_empty() {
                String::from("it has none")
            } else {
                format!("valid are {}", one_of(row.parameters.iter().map(|p| p.name)))
            };
            Error::Usage(format!("technique {} has no parameter '{name}'; {valid}", row.name))
        })?;
        word(&row.parameters[index], value)
            .map_err(|valid| Error::Usage(format!("{}:{name}={value}: valid are {valid}", row.name)))?;
        value.clone_into(&mut self.values[index]);
        Ok(())
    }

    /// The value of a parameter, as text.
    pub fn value(&self, name: &str) -> Option<&str> {
        self.row
            .parameters
            .iter()
            .zip(&self.values)
            .find(|(parameter, _)| parameter.name == name)
            .map(|(_, value)| value.as_str())
    }

    /// The passes that take part, in order.
    pub(super) fn passes(&self) -> impl Iterator<Item = &'static Pass> {
        self.row.passes.iter().filter(|pass| pass.with.is_none_or(|(name, value)| self.value(name) == Some(value)))
    }

    /// The specialisation constants `PARAM0` to `PARAM3`.
    pub(super) fn words(&self) -> [u32; 4] {
        let mut words = [0; 4];
        for ((parameter, value), out) in self.row.parameters.iter().zip(&self.values).zip(&mut words) {
            *out = word(parameter, value).unwrap_or_default(); // checked when it was set
        }
        words
    }

    /// What the image of this scene lacks against the true one because of what the technique cannot find; nothing where it finds all.
    pub fn misses(&self, scene: &Scene) -> Option<String> {
        let has = |missing: &Missing| match missing {
            Missing::DeltaLights => scene.has_delta_lights(),
            Missing::DeltaCaustics | Missing::HiddenDeltaCaustics => scene.has_delta_lights() && scene.has_smooth(),
            Missing::Unshowable => scene.background.is_some() || scene.has_smooth(),
        };
        let by_value = self.row.parameters.iter().zip(&self.values).flat_map(|(parameter, value)| {
            parameter.misses.iter().filter(move |(with, _)| with == value).map(|(_, missing)| *missing)
        });
        let all: Vec<&str> = self.row.misses.iter().copied().chain(by_value).filter(has).map(Missing::what).collect();
        (!all.is_empty()).then(|| all.join(", and "))
    }

    /// What the technique finds only by chance in this scene, in words; nothing where it aims at all there is.
    pub fn finds_by_chance(&self, scene: &Scene) -> Option<String> {
        let has = |chance: &&Chance| match chance {
            Chance::Caustics | Chance::HiddenCaustics => scene.has_specular() && scene.has_small_lights(),
            Chance::Reflections => scene.has_specular(),
            Chance::GlossyCaustics => scene.has_specular() && scene.has_small_lights() && scene.has_glossy(),
        };
        let all: Vec<&str> = self.row.by_chance.iter().filter(has).map(|chance| chance.what()).collect();
        (!all.is_empty()).then(|| all.join(", and "))
    }

    /// The materials of this scene that the technique takes for diffuse ones, though they are not; nothing where there are none.
    pub fn simplifies(&self, scene: &Scene) -> Option<String> {
        let others = if self.row.solves == Solves::Diffuse { scene.not_diffuse() } else { Vec::new() };
        let (named, more) = others.split_at(others.len().min(NAMED));
        let more = if more.is_empty() { String::new() } else { format!(" and {} more", more.len()) };
        (!others.is_empty()).then(|| format!("{}{more}", named.join(", ")))
    }

    /// The name with every parameter.
    pub fn full(&self) -> String {
        let all = self.row.parameters.iter().zip(&self.values);
        all.fold(self.row.name.to_owned(), |text, (parameter, value)| format!("{text}:{}={value}", parameter.name))
    }

    /// The name with every parameter that is not at its default.
    pub fn describe(&self) -> String {
        let changed = self
            .row
            .parameters
            .iter()
            .zip(&self.values)
            .filter(|(parameter, value)| default_text(&parameter.values) != **value);
        changed.fold(self.row.name.to_owned(), |text, (parameter, value)| format!("{text}:{}={value}", parameter.name))
    }
}

fn default_text(values: &Values) -> String {
    match values {
        Values::Choice(words) => words.first().copied().unwrap_or_default().to_owned(),
        Values::Number(_, _, default) => default.to_string(),
    }
}

/// The shader's word for a value, or what would be valid.
fn word(parameter: &Parameter, value: &str) -> Result<u32, String> {
    match parameter.values {
        Values::Choice(words) => {
            words.iter().position(|word| *word == value).map(|index| index as u32).ok_or_else(|| one_of(words))
        }
        Values::Number(low, high, _) => value
            .parse::<f32>()
            .ok()
            .filter(|number| (low..=high).contains(number))
            .map(f32::to_bits)
            .ok_or_else(|| format!("numbers from {low} to {high}")),
    }
}

/// What to render with.
#[derive(Clone, Debug)]
pub struct Settings {
    /// The technique and its parameters.
    pub technique: Technique,
    /// The ray backend.
    pub backend: Backend,
    /// Width of the image in pixels.
    pub width: u32,
    /// Height of the image in pixels.
    pub height: u32,
    /// Reconstruction filter.
    pub filter: Filter,
    /// Name or number of the camera; the first one where it is nothing.
    pub camera: Option<String>,
    /// Longest path in segments; nothing is no limit. 1 is emission only, 2 adds direct light.
    pub max_depth: Option<u32>,
    /// Segments after which Russian roulette may end a path.
    pub rr_depth: u32,
    /// Where uniform numbers come from.
    pub sampler: Sampler,
    /// Seed of the random numbers.
    pub seed: u32,
    /// Layers by path length; 0 for none. The last one also takes every longer path.
    pub lengths: u32,
    /// Layers by strategy, whose longest paths must be the longest there are.
    pub strategies: Option<Strategies>,
    /// Compile only what the scene needs; otherwise everything there is, which gives the same bits.
    pub specialise: bool,
    /// Give the driver whole modules and the values of their constants, rather than modules that hold no more than these leave: it takes
    /// longer and gives the same bits.
    pub driver_specialises: bool,
    /// How the driver may treat arithmetic on floats.
    pub arithmetic: Arithmetic,
    /// Expected pixel samples: whether work that only pays off over many of them is worth it.
    pub expected_samples: u64,
    /// The most primitives that get a tree in one piece (`bvh`): larger groups are cut into chunks. The answers are the same.
    pub chunk: usize,
}

impl Settings {
    /// What the scene's file asks for, with a technique and a backend.
    pub fn new(scene: &Scene, technique: Technique, backend: Backend) -> Self {
        Self {
            rr_depth: scene.technique.rr_depth.unwrap_or(technique.row.rr_depth),
            technique,
            backend,
            width: scene.film.width,
            height: scene.film.height,
            filter: scene.film.filter,
            camera: None,
            max_depth: scene.technique.max_depth.unwrap_or(None),
            sampler: SAMPLERS[0].sampler,
            seed: 0,
            lengths: 0,
            strategies: None,
            specialise: true,
            driver_specialises: false,
            arithmetic: Arithmetic::Free,
            expected_samples: u64::MAX,
            chunk: CHUNK,
        }
    }

    /// Layers of the film besides the image itself.
    pub fn layers(&self) -> u32 {
        self.strategies.map_or(self.lengths, |strategies| 2 * strategies.all().count() as u32)
    }

    /// What the kernel models.
    pub(super) fn needs(&self, scene: &Scene) -> Needs {
        if self.specialise { Needs::of(scene) } else { Needs::everything(scene) }
    }

    /// The rays of the image.
    pub(super) fn image_plane(&self, scene: &Scene) -> Result<ImagePlane> {
        Ok(scene.camera(self.camera.as_deref())?.image_plane(self.width, self.height))
    }

    /// Fails where they make no sense, or the device lacks the backend.
    pub(super) fn check(&self, gpu: &Gpu, scene: &Scene) -> Result<()> {
        gpu.require(self.backend)?;
        let bad = |what: String| Err(Error::Usage(what));
        if self.width == 0 || self.height == 0 || self.width > 65536 || self.height > 65536 {
            return bad(format!(
                "an image of {}x{} pixels: width and height must be 1 to 65536",
                self.width, self.height
            ));
        }
        let row = self.technique.row;
        if row.splats && !gpu.limits().int64_atomics {
            let others = INTEGRATORS.iter().filter(|row| !row.splats).map(|row| row.name);
            return bad(format!(
                "{} needs the feature shaderBufferInt64Atomics, which {} lacks; valid there are {}",
                row.name,
                gpu.survey().name,
                one_of(others)
            ));
        }
        if shoots(self) && !gpu.limits().int64_atomics {
            return bad(format!(
                "radiosity:solver=shoot needs the feature shaderBufferInt64Atomics, which {} lacks; solver=gather does without",
                gpu.survey().name
            ));
        }
        if let Some(strategies) = self.strategies {
            let combining = INTEGRATORS.iter().filter(|row| row.kept == Kept::Paths).map(|row| row.name);
            if row.kept != Kept::Paths {
                return bad(format!("--strategies with {}: valid is it with {}", row.name, one_of(combining)));
            }
            let longest = strategies.longest;
            if !(1..=LONGEST).contains(&longest) || self.max_depth.is_none_or(|depth| depth > longest) {
                return bad(format!(
                    "layers by strategy (--strategies) for {longest} segments: they must be all that paths may have, 1 to {LONGEST}"
                ));
            }
            if strategies != Strategies::of(longest, scene.camera(self.camera.as_deref())?) {
                return bad(String::from(
                    "layers by strategy of a camera with a lens, or of one without: the other is used",
                ));
            }
            if self.lengths > 0 {
                return bad(String::from(
                    "layers by strategy (--strategies) and by path length (--lengths): choose one",
                ));
            }
        }
        if row.kept == Kept::Chains && self.sampler != SAMPLERS[0].sampler {
            return bad(format!(
                "random numbers of {} are its chains' own: valid is --sampler {}",
                row.name, SAMPLERS[0].name
            ));
        }
        if self.lengths > 64 {
            return bad(format!("{} layers by path length: 64 is the most", self.lengths));
        }
        Ok(())
    }
}
