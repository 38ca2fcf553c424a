//! Denoising by Intel Open Image Denoise, whose library is looked for when it is asked for: lumbre neither needs it to be built nor to start.

mod library;

use crate::error::Result;
use crate::image::Image;
use library::{Device, Library};

/// Open Image Denoise, ready to work.
pub struct Denoiser {
    device: Device,
    version: String,
}

/// What the camera sees of surfaces, for edges and textures to stay: one value for each pixel of the image.
#[derive(Clone, Copy, Debug)]
pub struct Features<'a> {
    /// Albedo, 0 to 1.
    pub albedo: &'a [[f32; 3]],
    /// Shading normals in world space.
    pub normal: &'a [[f32; 3]],
}

impl Denoiser {
    /// Loads the library and chooses the fastest device that it knows. Fails, saying what to install, where there is no such library.
    pub fn open() -> Result<Self> {
        let device = Device::new(Library::load()?)?;
        let version = device.version();
        Ok(Self { device, version })
    }

    /// Its name and version: "Open Image Denoise 2.3.1".
    pub fn name(&self) -> String {
        format!("Open Image Denoise {}", self.version)
    }

    /// The image without its noise, which must be independent from pixel to pixel. `image` is linear, of any range.
    pub fn denoise(&self, image: &Image, features: Features) -> Result<Image> {
        let inputs = [("color", &image.pixels[..]), ("albedo", features.albedo), ("normal", features.normal)];
        let pixels = self.device.ray_tracing_filter((image.width as usize, image.height as usize), &inputs)?;
        Ok(Image { pixels, ..*image })
    }
}
