//! The images of a window that take turns being shown.

use std::rc::Rc;

use ash::{khr, vk};

use super::surface::Surface;
use crate::error::{Error, Result};
use crate::gpu::Gpu;

/// What became of an image that was to be acquired or presented.
pub(super) enum Turn<T> {
    /// It went well.
    Done(T),
    /// The swapchain fits the window no more, and is to be made anew.
    OutOfDate,
    /// No image is free yet: the window may be hidden.
    NotYet,
}

/// Nanoseconds to wait for a free image.
const WAIT: u64 = 100_000_000;

/// The swapchain of a surface, for a window of one size.
pub(super) struct Swapchain {
    gpu: Gpu,
    surface: Rc<Surface>,
    loader: khr::swapchain::Device,
    raw: vk::SwapchainKHR,
    /// Its images, with a view of each.
    pub images: Vec<(vk::Image, vk::ImageView)>,
    /// Their size in pixels.
    pub size: [u32; 2],
    acquired: vk::Fence,
    fits: bool,
}

/// The format of the images that a surface takes: one whose values are shown as they are, for the interface is blended in sRGB values.
pub(super) fn format(gpu: &Gpu, surface: &Surface) -> Result<vk::SurfaceFormatKHR> {
    // SAFETY: device and surface are of one instance and alive.
    let all = unsafe { surface.loader.get_physical_device_surface_formats(gpu.survey().raw, surface.raw) }
        .map_err(gpu.failed("list the formats of the window"))?;
    let plain = [vk::Format::B8G8R8A8_UNORM, vk::Format::R8G8B8A8_UNORM, vk::Format::A2B10G10R10_UNORM_PACK32];
    plain.iter().find_map(|format| all.iter().find(|own| own.format == *format)).copied().ok_or_else(|| {
        Error::Device(format!("the window takes no picture of 8 bits without conversion on {}", gpu.survey().name))
    })
}

impl Swapchain {
    /// For a window that has `size` pixels now, in the place of an older one. Nothing where the window has no pixels: it is minimised.
    pub fn new(
        gpu: &Gpu,
        surface: &Rc<Surface>,
        format: vk::SurfaceFormatKHR,
        size: [u32; 2],
        old: Option<Self>,
    ) -> Result<Option<Self>> {
        let device = gpu.survey().raw;
        // SAFETY: device and surface are of one instance and alive.
        let can = unsafe { surface.loader.get_physical_device_surface_capabilities(device, surface.raw) }
            .map_err(gpu.failed("ask what the window can show"))?;
        // All bits set: the swapchain decides the size.
        let extent = if can.current_extent.width == u32::MAX {
            let within = |size: u32, least: u32, most: u32| size.max(least).min(most);
            vk::Extent2D {
                width: within(size[0], can.min_image_extent.width, can.max_image_extent.width),
                height: within(size[1], can.min_image_extent.height, can.max_image_extent.height),
            }
        } else {
            can.current_extent
        };
        if extent.width == 0 || extent.height == 0 || size[0] == 0 || size[1] == 0 {
            return Ok(None);
        }
        let most = if can.max_image_count == 0 { u32::MAX } else { can.max_image_count };
        let opaque = [vk::CompositeAlphaFlagsKHR::OPAQUE, vk::CompositeAlphaFlagsKHR::INHERIT];
        let alpha = opaque.into_iter().find(|flag| can.supported_composite_alpha.contains(*flag));
        let info = vk::SwapchainCreateInfoKHR::default()
            .surface(surface.raw)
            .min_image_count((can.min_image_count + 1).min(most))
            .image_format(format.format)
            .image_color_space(format.color_space)
            .image_extent(extent)
            .image_array_layers(1)
            .image_usage(vk::ImageUsageFlags::COLOR_ATTACHMENT)
            .image_sharing_mode(vk::SharingMode::EXCLUSIVE)
            .pre_transform(can.current_transform)
            .composite_alpha(alpha.unwrap_or(vk::CompositeAlphaFlagsKHR::PRE_MULTIPLIED))
            .present_mode(vk::PresentModeKHR::FIFO)
            .clipped(true)
            .old_swapchain(old.as_ref().map_or(vk::SwapchainKHR::null(), |old| old.raw));
        let loader = khr::swapchain::Device::new(&gpu.shared.instance.raw, &gpu.shared.raw);
        // SAFETY: the device has the extension, the surface is alive, and the format and the extent are of those that it said; the old
        // swapchain is of the same surface and goes after this.
        let raw = unsafe { loader.create_swapchain(&info, None) }.map_err(gpu.failed("make a swapchain"))?;
        drop(old);
        let mut new = Self {
            gpu: gpu.clone(),
            surface: surface.clone(),
            loader,
            raw,
            images: Vec::new(),
            size: [extent.width, extent.height],
            acquired: vk::Fence::null(),
            fits: true,
        };
        new.fill(format.format)?;
        Ok(Some(new))
    }

    fn fill(&mut self, format: vk::Format) -> Result<()> {
        let device = &self.gpu.shared.raw;
        // SAFETY: the swapchain is alive; what is made is destroyed with it.
        let images = unsafe { self.loader.get_swapchain_images(self.raw) }
            .map_err(self.gpu.failed("list the images of the swapchain"))?;
        for image in images {
            let view = super::texture::view_of(&self.gpu, image, format)?;
            self.images.push((image, view));
        }
        // SAFETY: the device is alive.
        self.acquired = unsafe { device.create_fence(&vk::FenceCreateInfo::default(), None) }
            .map_err(self.gpu.failed("create a fence"))?;
        self.gpu.name(self.acquired, "image acquired");
        Ok(())
    }

    /// Waits a while for an image to draw in; its index.
    pub fn acquire(&mut self) -> Result<Turn<u32>> {
        let device = &self.gpu.shared.raw;
        // SAFETY: the fence is not signalled, as each use of it ends in a reset, and only this thread has the swapchain.
        let acquired = unsafe { self.loader.acquire_next_image(self.raw, WAIT, vk::Semaphore::null(), self.acquired) };
        let (index, is_suboptimal) = match acquired {
            Ok(found) => found,
            Err(vk::Result::TIMEOUT | vk::Result::NOT_READY) => return Ok(Turn::NotYet),
            Err(vk::Result::ERROR_OUT_OF_DATE_KHR) => return Ok(Turn::OutOfDate),
            Err(code) => return Err(self.gpu.failed("acquire an image of the window")(code)),
        };
        // SAFETY: the fence is the one above, which acquiring signals.
        unsafe {
            device
                .wait_for_fences(&[self.acquired], true, u64::MAX)
                .and_then(|()| device.reset_fences(&[self.acquired]))
        }
        .map_err(self.gpu.failed("wait for an image of the window"))?;
        self.fits &= !is_suboptimal;
        Ok(Turn::Done(index))
    }

    /// Whether it fits the window exactly; where it does not, a new one may.
    pub fn fits(&self) -> bool {
        self.fits
    }

    /// Shows an image that was drawn in; that must be done.
    pub fn present(&mut self, index: u32) -> Result<Turn<()>> {
        let submission = self.gpu.submission();
        let (swapchains, indices) = ([self.raw], [index]);
        let info = vk::PresentInfoKHR::default().swapchains(&swapchains).image_indices(&indices);
        // SAFETY: the image was acquired and is in the layout for presenting; the submission that drew in it was waited for, and the lock makes
        // this thread the only user of the queue.
        match unsafe { self.loader.queue_present(submission.queue, &info) } {
            Ok(is_suboptimal) => {
                self.fits &= !is_suboptimal;
                Ok(Turn::Done(()))
            }
            Err(vk::Result::ERROR_OUT_OF_DATE_KHR) => Ok(Turn::OutOfDate),
            Err(code) => Err(self.gpu.failed("show an image in the window")(code)),
        }
    }
}

impl Drop for Swapchain {
    fn drop(&mut self) {
        let device = &self.gpu.shared.raw;
        // SAFETY: drawing is waited for before presenting, and presenting is by the wait here; the surface is alive as long as this.
        unsafe {
            let _ = device.device_wait_idle();
            device.destroy_fence(self.acquired, None);
            for (_, view) in &self.images {
                device.destroy_image_view(*view, None);
            }
            self.loader.destroy_swapchain(self.raw, None);
        }
        let _ = &self.surface;
    }
}
