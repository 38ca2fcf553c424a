//! What to render with.

use super::bidirectional::{LONGEST, Strategies};
use super::sampler::Sampler;
use super::shard::Shard;
use super::table::{Correlated, TECHNIQUES};
use super::technique::Technique;
use crate::bvh::CHUNK;
use crate::error::{Error, Result, one_of};
use crate::gpu::Gpu;
use crate::layout::backend::Backend;
use crate::scene::camera::ImagePlane;
use crate::scene::{Filter, Needs, Scene};
use crate::spirv::Arithmetic;

/// Slots of an image: its pixels in whole tiles of 8 x 8.
pub(crate) fn slots(width: u32, height: u32) -> u64 {
    u64::from(width.div_ceil(8)) * u64::from(height.div_ceil(8)) * 64
}

/// How AOVs are sampled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AovSettings {
    /// Of what mirrors and smooth glass show, rather than of these themselves.
    pub through_specular: bool,
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
    /// The share of the samples that is rendered, where it is not all of them.
    pub shard: Option<Shard>,
    /// Layers by path length; 0 for none. The last one also takes every longer path.
    pub lengths: u32,
    /// Layers by strategy, whose longest paths must be the longest there are.
    pub strategies: Option<Strategies>,
    /// AOVs, sampled besides the image.
    pub aovs: Option<AovSettings>,
    /// Compile only what the scene needs; otherwise everything there is, which gives the same bits.
    pub specialise: bool,
    /// Give the driver whole modules and the values of their constants, rather than modules that hold no more than these leave: it takes
    /// longer and gives the same bits.
    pub driver_specialises: bool,
    /// How the driver may treat arithmetic on floats.
    pub arithmetic: Arithmetic,
    /// Expected pixel samples: whether work that only pays off over many of them is worth it.
    pub expected_samples: u64,
    /// Records of paths that there is room for ([`crate::render::Wanted`]); 0 compiles kernels that record nothing.
    pub records: u32,
    /// The most primitives that get a tree in one piece (`bvh`): larger groups are cut into chunks. The answers are the same.
    pub chunk: usize,
}

impl Settings {
    /// What the scene's file asks for, with a technique and a backend.
    pub fn new(scene: &Scene, technique: Technique, backend: Backend) -> Self {
        Self {
            rr_depth: scene.technique.rr_depth.unwrap_or(technique.row.rr_depth),
            sampler: technique.row.samplers()[0].sampler,
            technique,
            backend,
            width: scene.film.width,
            height: scene.film.height,
            filter: scene.film.filter,
            camera: None,
            max_depth: scene.technique.max_depth.unwrap_or(None),
            seed: 0,
            shard: None,
            lengths: 0,
            strategies: None,
            aovs: None,
            specialise: true,
            driver_specialises: false,
            arithmetic: Arithmetic::Free,
            expected_samples: u64::MAX,
            records: 0,
            chunk: CHUNK,
        }
    }

    /// The same settings for another technique, which draws its numbers as it does by default.
    pub fn for_technique(&self, technique: Technique) -> Self {
        Self { sampler: technique.row.samplers()[0].sampler, technique, ..self.clone() }
    }

    /// Looks through the camera of that name or number, or the first one: with the image that the scene's file asks for through it.
    pub fn set_camera(&mut self, scene: &Scene, name: Option<&str>) -> Result<()> {
        let film = scene.film_of(scene.camera(name)?);
        self.camera = name.map(str::to_owned);
        (self.width, self.height, self.filter) = (film.width, film.height, film.filter);
        Ok(())
    }

    /// Keeps the layers of all strategies of paths of up to `most` segments, which is where paths end then.
    pub fn show_strategies(&mut self, scene: &Scene, most: u32) -> Result<()> {
        let longest = self.max_depth.map_or(most, |depth| depth.min(most));
        self.strategies = Some(Strategies::of(longest, scene.camera(self.camera.as_deref())?));
        self.max_depth = Some(longest);
        Ok(())
    }

    /// Layers of the film besides the image itself.
    pub fn layers(&self) -> u32 {
        self.strategies.map_or(self.lengths, |strategies| 2 * strategies.all().count() as u32)
    }

    /// The seed of the numbers that are drawn. Chains do not follow from the index of a sample: those of each shard have a seed of their own.
    pub(crate) fn random_seed(&self) -> u32 {
        match self.shard {
            Some(shard) if self.technique.row.correlated == Correlated::Samples => {
                self.seed.wrapping_add((shard.number - 1).wrapping_mul(0x9e37_79b9))
            }
            _ => self.seed,
        }
    }

    /// Pixels of the image.
    pub(crate) fn pixels(&self) -> u64 {
        u64::from(self.width) * u64::from(self.height)
    }

    /// Slots of the image: its pixels in whole tiles of 8 x 8.
    pub(crate) fn slots(&self) -> u64 {
        slots(self.width, self.height)
    }

    /// What the kernel models.
    pub(crate) fn needs(&self, scene: &Scene) -> Needs {
        let needs = if self.specialise { Needs::of(scene) } else { Needs::everything(scene) };
        // Texture coordinates are an AOV.
        Needs { uvs: needs.uvs || self.aovs.is_some(), ..needs }
    }

    /// The rays of the image.
    pub(crate) fn image_plane(&self, scene: &Scene) -> Result<ImagePlane> {
        Ok(scene.camera(self.camera.as_deref())?.image_plane(self.width, self.height))
    }

    /// Fails where they make no sense, or the device lacks the backend. What the technique's state demands is checked by itself
    /// (`StateKind::check`).
    pub(crate) fn check(&self, gpu: &Gpu, scene: &Scene) -> Result<()> {
        gpu.require(self.backend)?;
        let bad = |what: String| Err(Error::Usage(what));
        if self.width == 0 || self.height == 0 || self.width > 65536 || self.height > 65536 {
            return bad(format!(
                "an image of {}x{} pixels: width and height must be 1 to 65536",
                self.width, self.height
            ));
        }
        let row = self.technique.row;
        if row.splats() {
            let others = TECHNIQUES.iter().filter(|row| !row.splats()).map(|row| row.name);
            gpu.require_int64_atomics(row.name, &format!("valid there are {}", one_of(others)))?;
        }
        if let Some(strategies) = self.strategies {
            let combining = TECHNIQUES.iter().filter(|row| row.tells_strategies).map(|row| row.name);
            if !row.tells_strategies {
                return bad(format!("--strategies with {}: it is valid with {}", row.name, one_of(combining)));
            }
            let longest = strategies.longest;
            if !(1..=LONGEST).contains(&longest) || self.max_depth.is_none_or(|depth| depth > longest) {
                return bad(format!(
                    "layers by strategy (--strategies) for {longest} segments: they must be all that paths may have, 1 to {LONGEST}"
                ));
            }
            if strategies != Strategies::of(longest, scene.camera(self.camera.as_deref())?) {
                let [listed, used] = if strategies.lens { ["with", "without"] } else { ["without", "with"] };
                return bad(format!(
                    "layers by strategy (--strategies) of a camera {listed} a lens, and the image's is one {used}: they must be those of \
                     the image's camera"
                ));
            }
            if self.lengths > 0 {
                return bad(String::from(
                    "layers by strategy (--strategies) and by path length (--lengths): choose one",
                ));
            }
        }
        if self.lengths > 64 {
            return bad(format!("{} layers by path length: 64 is the most", self.lengths));
        }
        Ok(())
    }
}
