//! The surface of a window of the system's.

use std::sync::Arc;

use ash::{khr, vk};
use raw_window_handle::{HasDisplayHandle, HasWindowHandle, RawDisplayHandle};

use crate::error::{Error, Result};
use crate::gpu::instance::{Instance, InstanceShared};

/// A window of the system's, by its handles.
pub trait NativeWindow: HasDisplayHandle + HasWindowHandle {}
impl<T: HasDisplayHandle + HasWindowHandle> NativeWindow for T {}

/// Loads Vulkan for windows of this display.
pub fn instance(validate: bool, display: &dyn HasDisplayHandle) -> Result<Instance> {
    let failed =
        |error: &dyn std::fmt::Display| Error::Device(format!("Vulkan cannot show pictures on this display: {error}"));
    let handle = display.display_handle().map_err(|error| failed(&error))?.as_raw();
    let extensions = ash_window::enumerate_required_extensions(handle).map_err(|error| failed(&error))?;
    Instance::with_extensions(validate, extensions).map_err(|error| match error {
        Error::Vulkan { code, .. } => failed(&code),
        other => other,
    })
}

/// The surface of a window, which it keeps open.
pub(super) struct Surface {
    pub raw: vk::SurfaceKHR,
    pub loader: khr::surface::Instance,
    // After the surface, which is destroyed before them.
    _window: Arc<dyn NativeWindow>,
    _instance: Arc<InstanceShared>,
}

impl Surface {
    /// That of a window, for an instance that [`instance`] made.
    pub fn new(instance: &Instance, window: &Arc<dyn NativeWindow>) -> Result<Self> {
        let failed = |error: &dyn std::fmt::Display| Error::Vulkan {
            doing: String::from("make a surface of the window"),
            code: error.to_string(),
        };
        let display: RawDisplayHandle = window.display_handle().map_err(|error| failed(&error))?.as_raw();
        let handle = window.window_handle().map_err(|error| failed(&error))?.as_raw();
        let shared = &instance.shared;
        // SAFETY: the instance has the display's extensions; it and the window, and with that its display, are kept alive beside the surface.
        let raw = unsafe { ash_window::create_surface(&shared.entry, &shared.raw, display, handle, None) }
            .map_err(|code| failed(&code))?;
        Ok(Self {
            raw,
            loader: khr::surface::Instance::new(&shared.entry, &shared.raw),
            _window: window.clone(),
            _instance: shared.clone(),
        })
    }
}

impl Drop for Surface {
    fn drop(&mut self) {
        // SAFETY: swapchains hold their surface, so none is left; the instance lives still.
        unsafe { self.loader.destroy_surface(self.raw, None) };
    }
}
