//! Arguments that several sub-commands take, and how they are parsed.

use std::path::PathBuf;

use clap::Args;

use lumbre::error::{Error, Result, one_of};
use lumbre::gpu::{Gpu, Instance};
use lumbre::scene::{LightSelection, LoadOptions, Scene, SceneFormat};
use lumbre::techniques::{SAMPLERS, Sampler};

use super::output::say;

/// Which device to run on.
#[derive(Args)]
pub(super) struct DeviceArgs {
    /// Device by index, UUID, or a part of its name; by default the first of the fastest kind
    #[arg(short = 'd', long, value_name = "SEL")]
    pub(super) device: Option<String>,

    /// Check every Vulkan call with the Khronos validation layer; a message fails the command
    #[arg(long)]
    pub(super) validate: bool,
}

/// Which scene to read.
#[derive(Args)]
pub(super) struct SceneArgs {
    /// Scene file: Mitsuba 3 (.xml), glTF 2.0 (.gltf, .glb), .obj or .ply; '-' is standard input, with --format
    pub(super) scene: PathBuf,

    /// Format of the scene, whatever its name: xml, gltf, glb, obj or ply
    #[arg(long, value_name = "NAME")]
    pub(super) format: Option<SceneFormat>,

    /// Set a parameter of a Mitsuba scene
    #[arg(short = 'D', value_name = "NAME=VALUE", value_parser = parse_define)]
    pub(super) defines: Vec<(String, String)>,

    /// How lights are selected: by power, from a tree by place and direction, or auto, which takes the tree from 33 lights on
    #[arg(long, value_name = "HOW", default_value = "auto")]
    pub(super) lights: LightSelection,

    /// Give rough metals and rough glass of a Mitsuba scene back what they lose to multiple scattering, which Mitsuba does not
    #[arg(long)]
    pub(super) energy_compensation: bool,

    /// Filter the images of materials over what a path sees of them: less noise, and a blur; Mitsuba looks up points
    #[arg(long)]
    pub(super) mip_maps: bool,
}

impl DeviceArgs {
    pub(super) fn open(&self) -> Result<Gpu> {
        Gpu::open(&Instance::new(self.validate)?, self.device.as_deref())
    }

    /// Fails if validation had anything to say.
    pub(super) fn report_validation(gpu: &Gpu) -> Result<()> {
        let messages = gpu.take_validation_messages();
        match messages.split_first() {
            None => Ok(()),
            Some((first, rest)) => {
                rest.iter().for_each(|message| say!("validation: {message}"));
                Err(Error::Validation(first.clone()))
            }
        }
    }
}

impl SceneArgs {
    pub(super) fn options(&self) -> LoadOptions {
        LoadOptions {
            format: self.format,
            defines: self.defines.clone(),
            lights: self.lights,
            energy_compensation: self.energy_compensation,
            mip_maps: self.mip_maps,
        }
    }

    pub(super) fn load(&self) -> Result<Scene> {
        lumbre::scene::load(&self.scene, &self.options())
    }
}

pub(super) fn parse_define(text: &str) -> Result<(String, String), String> {
    match text.split_once('=') {
        Some((name, value)) if !name.is_empty() => Ok((name.to_owned(), value.to_owned())),
        _ => Err(String::from("it must be NAME=VALUE")),
    }
}

/// `--max-depth`: a number of segments, or nothing for no limit.
#[derive(Clone, Copy)]
pub(super) struct Depth(pub Option<u32>);

pub(super) fn parse_depth(text: &str) -> Result<Depth, String> {
    match text.parse::<i64>() {
        Ok(-1) => Ok(Depth(None)),
        Ok(depth @ 0..=0xffff_fffe) => Ok(Depth(u32::try_from(depth).ok())),
        _ => Err(String::from("it must be 0 or more, or -1 for no limit")),
    }
}

pub(super) fn parse_sampler(text: &str) -> Result<Sampler, String> {
    Sampler::find(text).ok_or_else(|| format!("valid are {}", one_of(SAMPLERS.iter().map(|row| row.name))))
}

pub(super) fn parse_size(text: &str) -> Result<(u32, u32), String> {
    let sides =
        text.split_once(['x', 'X']).and_then(|(width, height)| Some((width.parse().ok()?, height.parse().ok()?)));
    sides
        .filter(|(width, height)| (1..=65536).contains(width) && (1..=65536).contains(height))
        .ok_or_else(|| String::from("it must be WIDTHxHEIGHT, each 1 to 65536"))
}

pub(super) fn parse_positive(text: &str) -> Result<f64, String> {
    text.parse::<f64>()
        .ok()
        .filter(|number| *number > 0.0 && number.is_finite())
        .ok_or_else(|| String::from("it must be a number above 0"))
}
