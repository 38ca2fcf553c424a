//! What an EXR holds besides the image: further layers, AOVs, and the image before it was denoised.

use std::path::PathBuf;

use lumbre::denoise::Denoiser;
use lumbre::error::{Error, Result};
use lumbre::image::Picture;
use lumbre::render::film::Film;
use lumbre::render::{Renderer, Settings};
use lumbre::scene::Scene;
use lumbre::techniques::AovSettings;

use super::args::RenderArgs;
use super::layers::{self, Layer};
use super::outputs::has_exr;
use super::report::{self, Report};

/// The layers that are to be written, and what denoises.
pub(super) struct Extras {
    layers: Vec<Layer>,
    denoiser: Option<Denoiser>,
}

impl Extras {
    /// Those that the command line asks for, as `layers`, or else the scene; asks the settings for what they take.
    pub fn settle(
        args: &RenderArgs,
        mut layers: Vec<Layer>,
        scene: &Scene,
        outputs: &[PathBuf],
        settings: &mut Settings,
    ) -> Result<Self> {
        if layers.is_empty() && has_exr(outputs) {
            layers = layers::of_scene(scene)?;
        }
        let denoiser = args.denoise.then(Denoiser::open).transpose()?;
        if denoiser.is_some() {
            layers = layers::with_noisy(layers)?;
        }
        let through_specular = args.aov_through_specular;
        settings.aovs = (denoiser.is_some() || layers::have_aovs(&layers)).then_some(AovSettings { through_specular });
        if through_specular && settings.aovs.is_none() {
            let message =
                "--aov-through-specular is about AOVs, and none is asked for: valid is with --aov or --denoise";
            return Err(Error::Usage(String::from(message)));
        }
        Ok(Self { layers, denoiser })
    }

    /// The picture with all layers, denoised where that was asked for, and what could not be made: the image is to be written all the same.
    pub fn picture(
        &self,
        scene: &Scene,
        renderer: &Renderer,
        film: &Film,
        result: &mut Report,
    ) -> (Picture, Option<Error>) {
        let (aovs, mut lost) = match renderer.aovs() {
            Ok(aovs) => (aovs, None),
            Err(error) => (None, Some(error)),
        };
        let mut denoised = None;
        if let (Some(denoiser), Some(aovs)) = (&self.denoiser, &aovs) {
            match super::denoise::denoise(denoiser, &film.mean(), aovs) {
                Ok(image) => (denoised, result.denoiser) = (Some(image), Some(denoiser.name())),
                Err(error) => lost = Some(error),
            }
        }
        let mut picture = report::picture(film, result, layers::images(&self.layers, film, aovs.as_ref()));
        picture.image = denoised.unwrap_or(picture.image);
        if let Some(aovs) = &aovs {
            picture.header.extend(layers::header(&self.layers, scene, aovs));
        }
        (picture, lost)
    }
}
