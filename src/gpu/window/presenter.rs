//! A device that shows pictures in a window.

use std::rc::Rc;
use std::sync::Arc;

use ash::vk;

use super::painter::{Mesh, Painter};
use super::surface::{NativeWindow, Surface};
use super::swapchain::{Swapchain, Turn, format};
use super::texture::TextureChange;
use crate::error::{Error, Result};
use crate::gpu::presenting::Presenting;
use crate::gpu::{Gpu, Instance, Survey};

/// What became of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shown {
    /// It is shown.
    Yes,
    /// The window has another size by now, or no room for a frame yet: it is to be drawn again.
    Again,
    /// The window has no pixels: it is minimised.
    Minimised,
}

/// Shows pictures in a window, by a device of its own: so it answers whatever another one is doing.
pub struct Presenter {
    // In the order in which they go.
    painter: Painter,
    swapchain: Option<Swapchain>,
    surface: Rc<Surface>,
    format: vk::SurfaceFormatKHR,
    gpu: Gpu,
}

impl Presenter {
    /// Opens the device that `selector` names, if it can show pictures in this window, else the first one that can. The instance is one for
    /// the window's display ([`super::instance`]).
    pub fn new(instance: &Instance, selector: Option<&str>, window: &Arc<dyn NativeWindow>) -> Result<Self> {
        let surface = Rc::new(Surface::new(instance, window)?);
        let presenting = Presenting::Surface(&surface.loader, surface.raw);
        let mut devices: Vec<Survey> = instance.devices()?.into_iter().filter(Survey::usable).collect();
        devices.sort_by_key(|survey| !selector.is_some_and(|selector| survey.answers_to(selector)));
        let mut refusals = Vec::new();
        for survey in devices {
            match Gpu::create(instance, survey, &presenting) {
                Ok(gpu) => {
                    let format = format(&gpu, &surface)?;
                    return Ok(Self {
                        painter: Painter::new(&gpu, format.format)?,
                        swapchain: None,
                        surface,
                        format,
                        gpu,
                    });
                }
                Err(error) => refusals.push(error.to_string()),
            }
        }
        let why = if refusals.is_empty() { String::from("there is none") } else { refusals.join("; ") };
        Err(Error::Device(format!("no device can show pictures in a window: {why}")))
    }

    /// What the device is.
    pub fn survey(&self) -> &Survey {
        self.gpu.survey()
    }

    /// The messages of the validation layer since the last call; always empty where it is off.
    pub fn take_validation_messages(&self) -> Vec<String> {
        self.gpu.take_validation_messages()
    }

    /// Changes a texture, or makes it.
    pub fn change_texture(&mut self, id: u64, change: &TextureChange) -> Result<()> {
        self.painter.change_texture(id, change)
    }

    /// Frees a texture, if there is one of that number.
    pub fn free_texture(&mut self, id: u64) -> Result<()> {
        self.painter.free_texture(id)
    }

    /// Draws a frame for a window of so many pixels and shows it.
    pub fn show(&mut self, size: [u32; 2], meshes: &[Mesh]) -> Result<Shown> {
        if self.swapchain.as_ref().is_none_or(|own| own.size != size || !own.fits()) {
            let old = self.swapchain.take();
            self.swapchain = Swapchain::new(&self.gpu, &self.surface, self.format, size, old)?;
        }
        let Some(swapchain) = &mut self.swapchain else { return Ok(Shown::Minimised) };
        let index = match swapchain.acquire()? {
            Turn::Done(index) => index,
            Turn::NotYet => return Ok(Shown::Again),
            Turn::OutOfDate => {
                self.swapchain = None;
                return Ok(Shown::Again);
            }
        };
        let (image, view) = swapchain.images[index as usize];
        self.painter.draw(image, view, swapchain.size, meshes)?;
        match swapchain.present(index)? {
            Turn::Done(()) => Ok(Shown::Yes),
            Turn::NotYet | Turn::OutOfDate => {
                self.swapchain = None;
                Ok(Shown::Again)
            }
        }
    }
}
