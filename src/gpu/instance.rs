//! The Vulkan instance: the loader, validation, and the list of physical devices.

use std::ffi::{CStr, c_char, c_void};
use std::sync::{Arc, Mutex, PoisonError};

use ash::{ext, vk};

use super::mesa;
use super::omission::{self, Step};
use super::survey::{Survey, version_text};
use crate::error::{Error, Result};

/// Messages of the validation layer that nobody has read yet.
pub(super) type Messages = Mutex<Vec<String>>;

const VALIDATION_LAYER: &CStr = c"VK_LAYER_KHRONOS_validation";

/// The loaded Vulkan library and an instance of it.
pub struct Instance {
    pub(super) shared: Arc<InstanceShared>,
}

pub(super) struct InstanceShared {
    pub(super) raw: ash::Instance,
    /// Whether objects can be given names.
    pub(super) has_names: bool,
    debug: Option<Debug>,
    // Last, so that the library outlives what came from it. Surfaces of windows are made through it.
    #[cfg_attr(not(feature = "view"), allow(dead_code))]
    pub(super) entry: ash::Entry,
}

struct Debug {
    utils: ext::debug_utils::Instance,
    messenger: vk::DebugUtilsMessengerEXT,
    messages: Box<Messages>,
}

impl Instance {
    /// Loads Vulkan. With `validate`, every call is checked by the Khronos validation layer, which must be installed.
    pub fn new(validate: bool) -> Result<Self> {
        Self::with_extensions(validate, &[])
    }

    /// As [`Self::new`], with further extensions, which fails where the loader lacks one of them.
    pub(super) fn with_extensions(validate: bool, further: &[*const c_char]) -> Result<Self> {
        mesa::widen();
        omission::read()?;
        // SAFETY: loading the library runs its initialisers; the Vulkan loader's have no precondition.
        let entry = unsafe { ash::Entry::load() }.map_err(|error| {
            Error::Device(format!(
                "no Vulkan loader (libvulkan.so.1) on this machine: {error}. Install it (Debian and Ubuntu: libvulkan1)"
            ))
        })?;
        // SAFETY: `entry` is loaded; the call has no other precondition.
        let version = unsafe { entry.try_enumerate_instance_version() }.ok().flatten().unwrap_or(vk::API_VERSION_1_0);
        if version < vk::API_VERSION_1_3 {
            return Err(Error::Device(format!(
                "the Vulkan loader is {}, and lumbre needs 1.3 or later",
                version_text(version)
            )));
        }

        // SAFETY: as above.
        let available = unsafe { entry.enumerate_instance_extension_properties(None) }.unwrap_or_default();
        let has_names =
            available.iter().any(|extension| extension.extension_name_as_c_str() == Ok(ext::debug_utils::NAME));
        let mut layers = Vec::new();
        let mut extensions = further.to_vec();
        if has_names || validate {
            extensions.push(ext::debug_utils::NAME.as_ptr());
        }
        if validate {
            // SAFETY: as above.
            let available = unsafe { entry.enumerate_instance_layer_properties() }.unwrap_or_default();
            if !available.iter().any(|layer| layer.layer_name_as_c_str() == Ok(VALIDATION_LAYER)) {
                return Err(Error::Device(String::from(
                    "the Khronos validation layer is not installed (Debian and Ubuntu: vulkan-validationlayers)",
                )));
            }
            layers.push(VALIDATION_LAYER.as_ptr());
        }
        let application = vk::ApplicationInfo::default()
            .application_name(c"lumbre")
            .engine_name(c"lumbre")
            .api_version(if omission::omits(Step::ApiVersion) { vk::API_VERSION_1_0 } else { vk::API_VERSION_1_3 });
        let info = vk::InstanceCreateInfo::default()
            .application_info(&application)
            .enabled_layer_names(&layers)
            .enabled_extension_names(&extensions);
        // SAFETY: `info` and all that it points to live through the call; layers and extensions were found above.
        let raw = unsafe { entry.create_instance(&info, None) }
            .map_err(|code| Error::Vulkan { doing: String::from("create an instance"), code: code.to_string() })?;
        let debug = if validate { Some(Debug::new(&entry, &raw)?) } else { None };
        Ok(Self { shared: Arc::new(InstanceShared { raw, has_names: has_names || validate, debug, entry }) })
    }

    /// Every physical device, in the driver's order: what it is, what it can do, and why a backend is refused on it.
    pub fn devices(&self) -> Result<Vec<Survey>> {
        // SAFETY: the instance is alive.
        let devices = unsafe { self.shared.raw.enumerate_physical_devices() }
            .map_err(|code| Error::Vulkan { doing: String::from("list the devices"), code: code.to_string() })?;
        Ok(devices
            .into_iter()
            .enumerate()
            .map(|(index, device)| Survey::new(&self.shared.raw, device, index))
            .collect())
    }
}

impl InstanceShared {
    /// The messages of the validation layer since the last call.
    pub(super) fn take_messages(&self) -> Vec<String> {
        let Some(debug) = &self.debug else { return Vec::new() };
        std::mem::take(&mut *debug.messages.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

impl Debug {
    fn new(entry: &ash::Entry, instance: &ash::Instance) -> Result<Self> {
        let utils = ext::debug_utils::Instance::new(entry, instance);
        let messages: Box<Messages> = Box::default();
        let user_data: *const Messages = &*messages;
        let info = vk::DebugUtilsMessengerCreateInfoEXT::default()
            .message_severity(
                vk::DebugUtilsMessageSeverityFlagsEXT::WARNING | vk::DebugUtilsMessageSeverityFlagsEXT::ERROR,
            )
            .message_type(vk::DebugUtilsMessageTypeFlagsEXT::VALIDATION | vk::DebugUtilsMessageTypeFlagsEXT::GENERAL)
            .pfn_user_callback(Some(on_message))
            .user_data(user_data.cast_mut().cast());
        // SAFETY: the extension is enabled; `user_data` points into a box that lives until the messenger is destroyed.
        let messenger = unsafe { utils.create_debug_utils_messenger(&info, None) }.map_err(|code| Error::Vulkan {
            doing: String::from("listen to the validation layer"),
            code: code.to_string(),
        })?;
        Ok(Self { utils, messenger, messages })
    }
}

/// Called by the validation layer, on the thread that made the offending call.
unsafe extern "system" fn on_message(
    severity: vk::DebugUtilsMessageSeverityFlagsEXT,
    kind: vk::DebugUtilsMessageTypeFlagsEXT,
    data: *const vk::DebugUtilsMessengerCallbackDataEXT<'_>,
    user_data: *mut c_void,
) -> vk::Bool32 {
    // Loaders and drivers chat under GENERAL about what they found on the machine; that is no message about lumbre.
    let chatter =
        kind == vk::DebugUtilsMessageTypeFlagsEXT::GENERAL && severity != vk::DebugUtilsMessageSeverityFlagsEXT::ERROR;
    if chatter || data.is_null() || user_data.is_null() {
        return vk::FALSE;
    }
    // SAFETY: `user_data` is the address of the messages given at creation, which outlive the messenger.
    let messages = unsafe { &*user_data.cast::<Messages>() };
    // SAFETY: Vulkan passes a valid structure whose message is null or a C string.
    let text = unsafe { (*data).message_as_c_str() };
    let text = text.map_or_else(String::new, |text| text.to_string_lossy().into_owned());
    if omission::omits_any() {
        // What comes next may end the process.
        let _ = std::io::Write::write_fmt(&mut std::io::stderr(), format_args!("validation: {text}\n"));
    }
    messages.lock().unwrap_or_else(PoisonError::into_inner).push(text);
    vk::FALSE
}

impl Drop for InstanceShared {
    fn drop(&mut self) {
        // SAFETY: everything made from the instance holds it alive, so nothing is left; the messenger goes first, then
        // its messages with `debug`, then the library with `entry`.
        unsafe {
            if let Some(debug) = &self.debug {
                debug.utils.destroy_debug_utils_messenger(debug.messenger, None);
            }
            self.raw.destroy_instance(None);
        }
    }
}
