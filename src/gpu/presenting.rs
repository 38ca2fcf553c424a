//! What a device is opened for besides compute work.

use std::ffi::c_char;

use ash::{khr, vk};

/// What a device is to show pictures on.
pub(super) enum Presenting<'a> {
    /// Nothing: it computes.
    Nothing,
    /// A window.
    #[cfg_attr(not(feature = "view"), allow(dead_code))]
    Surface(&'a khr::surface::Instance, vk::SurfaceKHR),
}

impl Presenting<'_> {
    /// Whether a family of queues does what is needed.
    pub fn suits(&self, device: vk::PhysicalDevice, family: u32, flags: vk::QueueFlags) -> bool {
        match self {
            Self::Nothing => flags.contains(vk::QueueFlags::COMPUTE),
            Self::Surface(loader, surface) => {
                // SAFETY: device and surface belong to the loader's instance, which is alive, and the device has that family.
                let shows = || unsafe { loader.get_physical_device_surface_support(device, family, *surface) };
                flags.contains(vk::QueueFlags::GRAPHICS | vk::QueueFlags::COMPUTE) && shows().unwrap_or(false)
            }
        }
    }

    /// What such a queue is called.
    pub fn queue(&self) -> &'static str {
        match self {
            Self::Nothing => "compute queue",
            Self::Surface(..) => "queue that draws and presents to a window",
        }
    }

    /// The extensions that it takes.
    pub fn extensions(&self) -> impl Iterator<Item = *const c_char> {
        self.draws().then(|| khr::swapchain::NAME.as_ptr()).into_iter()
    }

    /// Whether the device draws.
    pub fn draws(&self) -> bool {
        !matches!(self, Self::Nothing)
    }
}
