//! The image that stands for the truth: read from a file, or made once and kept by what it depends on.

use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::{Path, PathBuf};

use super::measure::Truth;
use crate::error::{Error, Result};
use crate::film::Image;
use crate::gpu::Gpu;
use crate::input::{read_image, read_layer};
use crate::output::{NamedLayer, Picture, write_picture};
use crate::render::{Renderer, Settings, kernels_fingerprint};
use crate::scene::Scene;

/// The name of the EXR layer that holds the variance of each pixel's mean, as `lumbre render --aov variance` writes it.
const VARIANCE: &str = "variance";

/// Reads a reference. Its variance is taken from the layer `variance`, where it has one.
pub fn read(path: &Path, width: u32, height: u32) -> Result<Truth> {
    let image = read_image(path)?;
    if (image.width, image.height) != (width, height) {
        return Err(Error::Usage(format!(
            "the reference {} has {}x{} pixels and the scene's image {width}x{height}: they must be of one size",
            path.display(),
            image.width,
            image.height
        )));
    }
    if let Some(bad) = image.pixels.iter().position(|pixel| pixel.iter().any(|value| !value.is_finite())) {
        return Err(Error::read(
            path,
            format!("pixel ({}, {}) is not finite: a reference must be", bad as u32 % width, bad as u32 / width),
        ));
    }
    if image.pixels.iter().flatten().all(|value| *value == 0.0) {
        return Err(Error::read(path, "the image is black: nothing can be compared with it"));
    }
    let variance = read_layer(path, VARIANCE)?.filter(|layer| is_variance(layer, width, height));
    Ok(Truth::new(image, variance))
}

fn is_variance(layer: &Image, width: u32, height: u32) -> bool {
    (layer.width, layer.height) == (width, height)
        && layer.pixels.iter().flatten().all(|value| value.is_finite() && *value >= 0.0)
}

/// A reference that is to be made, or was made before.
pub struct Recipe<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// An unbiased technique, the image's size and everything else; the seed is not one of the bench's.
    pub settings: Settings,
    /// Samples per pixel.
    pub spp: u32,
}

impl Recipe<'_> {
    /// What the image depends on, in 64 bits: the scene's arrays, the settings, and the kernels themselves.
    pub fn key(&self) -> u64 {
        let mut hasher = DefaultHasher::new();
        self.scene.hash_content(&mut hasher);
        format!("{:?}", self.settings).hash(&mut hasher);
        (self.spp, kernels_fingerprint()).hash(&mut hasher);
        hasher.finish()
    }

    /// Where it is kept in a folder.
    pub fn path(&self, folder: &Path) -> PathBuf {
        folder.join(format!("reference-{:016x}.exr", self.key()))
    }

    /// Takes it from the folder, or makes it and puts it there; `progress` hears the share that is done. The second value
    /// says whether it was there.
    pub fn obtain(
        &self,
        gpu: &Gpu,
        folder: &Path,
        mut progress: impl FnMut(f64) -> Result<()>,
    ) -> Result<(Truth, bool)> {
        let path = self.path(folder);
        // What cannot be read, or was cut short by something else than us, is made anew.
        if path.exists()
            && let Ok(truth) = read(&path, self.settings.width, self.settings.height)
            && truth.variance.is_some()
        {
            return Ok((truth, true));
        }
        let mut renderer = Renderer::new(gpu, self.scene, &self.settings)?;
        while renderer.advance(self.spp)? {
            progress(renderer.progress() / f64::from(self.spp))?;
        }
        let film = renderer.film()?;
        let (image, variance) = (film.mean(), film.mean_variance());
        let header = vec![
            (String::from("lumbre.scene"), self.scene.source.display().to_string()),
            (String::from("lumbre.integrator"), self.settings.technique.describe()),
            (String::from("lumbre.spp"), self.spp.to_string()),
        ];
        let layers = vec![NamedLayer { name: VARIANCE.to_owned(), image: variance.clone() }];
        write_picture(&path, &Picture { image: image.clone(), layers, header })?;
        Ok((Truth::new(image, Some(variance)), false))
    }
}
