//! What a physical device is and can do, and why a backend is refused on it.

use std::ffi::CStr;

use ash::{ext, khr, vk};
use serde::Serialize;

use super::mesa;
use crate::layout::backend::{BACKENDS, Backend};

/// The kind of hardware behind a device.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum DeviceKind {
    /// A graphics card.
    DiscreteGpu,
    /// A GPU that shares the processor's memory.
    IntegratedGpu,
    /// A GPU lent by a hypervisor.
    VirtualGpu,
    /// The processor itself, such as lavapipe.
    Cpu,
    /// Something else.
    Other,
}

/// One physical device.
#[derive(Clone, Debug, Serialize)]
pub struct Survey {
    #[serde(skip)]
    pub(super) raw: vk::PhysicalDevice,
    #[serde(skip)]
    pub(super) has_memory_budget: bool,
    /// Its place in the driver's list.
    pub index: usize,
    /// Its name.
    pub name: String,
    /// Its UUID, 32 hexadecimal digits in the usual groups.
    pub uuid: String,
    /// What kind of hardware it is.
    pub kind: DeviceKind,
    /// The driver's name and version.
    pub driver: String,
    /// The Vulkan version that it supports.
    pub vulkan: String,
    /// Bytes of its largest device-local heap.
    pub memory: u64,
    /// Threads that run in lockstep.
    pub subgroup_size: u32,
    /// Environment variables that lumbre has set for its driver, as `NAME=VALUE`.
    pub environment: Vec<String>,
    /// What lumbre needs of any device and this one lacks; empty where it is usable.
    pub missing: Vec<String>,
    /// Per backend, why it is refused; `null` where it works.
    pub backends: Vec<BackendSupport>,
}

/// Whether a backend works on a device.
#[derive(Clone, Debug, Serialize)]
pub struct BackendSupport {
    /// The backend's name.
    pub name: &'static str,
    /// Why not, or nothing where it works.
    pub refused: Option<String>,
}

/// What ray queries need beyond Vulkan 1.3.
pub(super) const RAY_QUERY_EXTENSIONS: [&CStr; 3] =
    [khr::acceleration_structure::NAME, khr::ray_query::NAME, khr::deferred_host_operations::NAME];

impl Survey {
    pub(super) fn new(instance: &ash::Instance, raw: vk::PhysicalDevice, index: usize) -> Self {
        // SAFETY: `raw` was listed by `instance`, which is alive.
        let version = unsafe { instance.get_physical_device_properties(raw) }.api_version;
        let mut vulkan11 = vk::PhysicalDeviceVulkan11Properties::default();
        let mut vulkan12 = vk::PhysicalDeviceVulkan12Properties::default();
        let mut properties = vk::PhysicalDeviceProperties2::default().push_next(&mut vulkan11).push_next(&mut vulkan12);
        if version >= vk::API_VERSION_1_2 {
            // SAFETY: as above; the chained structures belong to Vulkan 1.2, which the device has.
            unsafe { instance.get_physical_device_properties2(raw, &mut properties) };
        } else {
            // SAFETY: as above, without the chain.
            properties.properties = unsafe { instance.get_physical_device_properties(raw) };
        }
        let basic = properties.properties;
        // SAFETY: as above.
        let memory = unsafe { instance.get_physical_device_memory_properties(raw) };
        let memory =
            memory.memory_heaps_as_slice().iter().filter(|heap| heap.flags.contains(vk::MemoryHeapFlags::DEVICE_LOCAL));
        // SAFETY: as above.
        let extensions = unsafe { instance.enumerate_device_extension_properties(raw) }.unwrap_or_default();
        let has = |name: &CStr| extensions.iter().any(|extension| extension.extension_name_as_c_str() == Ok(name));

        let missing = missing_features(instance, raw, version);
        let ray_query = RAY_QUERY_EXTENSIONS
            .iter()
            .find(|name| !has(name))
            .map(|name| format!("the device lacks {}", name.to_string_lossy()));
        let backends = BACKENDS
            .iter()
            .map(|row| BackendSupport {
                name: row.name,
                refused: match (missing.is_empty(), row.backend) {
                    (false, _) => Some(format!("the device lacks {}", missing.join(", "))),
                    (true, Backend::RayQuery) => ray_query.clone(),
                    (true, Backend::Bvh) => None,
                },
            })
            .collect();

        Self {
            raw,
            has_memory_budget: version >= vk::API_VERSION_1_1 && has(ext::memory_budget::NAME),
            index,
            name: text(basic.device_name_as_c_str()),
            uuid: uuid_text(&vulkan11.device_uuid),
            kind: match basic.device_type {
                vk::PhysicalDeviceType::DISCRETE_GPU => DeviceKind::DiscreteGpu,
                vk::PhysicalDeviceType::INTEGRATED_GPU => DeviceKind::IntegratedGpu,
                vk::PhysicalDeviceType::VIRTUAL_GPU => DeviceKind::VirtualGpu,
                vk::PhysicalDeviceType::CPU => DeviceKind::Cpu,
                _ => DeviceKind::Other,
            },
            driver: format!("{} {}", text(vulkan12.driver_name_as_c_str()), text(vulkan12.driver_info_as_c_str()))
                .trim()
                .to_owned(),
            vulkan: version_text(version),
            memory: memory.map(|heap| heap.size).max().unwrap_or(0),
            subgroup_size: vulkan11.subgroup_size,
            environment: if vulkan12.driver_id == vk::DriverId::MESA_LLVMPIPE { mesa::was_set() } else { Vec::new() },
            missing,
            backends,
        }
    }

    /// Whether lumbre runs on it at all.
    pub fn usable(&self) -> bool {
        self.missing.is_empty()
    }

    /// Why `backend` is refused, or nothing where it works.
    pub fn refusal(&self, backend: Backend) -> Option<&str> {
        self.backends
            .iter()
            .find(|support| support.name == backend.name())
            .and_then(|support| support.refused.as_deref())
    }

    /// Whether `selector` names this device: its index, its UUID, or a part of its name.
    pub fn answers_to(&self, selector: &str) -> bool {
        match selector.parse::<usize>() {
            Ok(index) => index == self.index,
            Err(_) => {
                let wanted = selector.to_lowercase();
                self.uuid == wanted
                    || self.uuid.replace('-', "") == wanted
                    || self.name.to_lowercase().contains(&wanted)
            }
        }
    }
}

/// What lumbre needs of any device and this one lacks, by the specification's names.
fn missing_features(instance: &ash::Instance, raw: vk::PhysicalDevice, version: u32) -> Vec<String> {
    if version < vk::API_VERSION_1_3 {
        return vec![format!("Vulkan 1.3 (it has {})", version_text(version))];
    }
    let mut vulkan12 = vk::PhysicalDeviceVulkan12Features::default();
    let mut features = vk::PhysicalDeviceFeatures2::default().push_next(&mut vulkan12);
    // SAFETY: the device belongs to the live instance and has Vulkan 1.3, which the chained structure is part of.
    unsafe { instance.get_physical_device_features2(raw, &mut features) };
    let int64 = features.features.shader_int64;
    let needed = [
        ("shaderInt64", int64),
        ("bufferDeviceAddress", vulkan12.buffer_device_address),
        ("scalarBlockLayout", vulkan12.scalar_block_layout),
    ];
    let mut missing: Vec<String> =
        needed.iter().filter(|(_, has)| *has == vk::FALSE).map(|(name, _)| format!("the feature {name}")).collect();
    // SAFETY: as above.
    let queues = unsafe { instance.get_physical_device_queue_family_properties(raw) };
    if !queues.iter().any(|queue| queue.queue_flags.contains(vk::QueueFlags::COMPUTE)) {
        missing.push(String::from("a compute queue"));
    }
    missing
}

fn text(name: Result<&CStr, std::ffi::FromBytesUntilNulError>) -> String {
    name.map_or_else(|_| String::from("?"), |name| name.to_string_lossy().into_owned())
}

fn uuid_text(bytes: &[u8; 16]) -> String {
    let hex = |range: std::ops::Range<usize>| bytes[range].iter().map(|byte| format!("{byte:02x}")).collect::<String>();
    format!("{}-{}-{}-{}-{}", hex(0..4), hex(4..6), hex(6..8), hex(8..10), hex(10..16))
}

/// A packed Vulkan version as text.
pub(super) fn version_text(version: u32) -> String {
    format!("{}.{}.{}", vk::api_version_major(version), vk::api_version_minor(version), vk::api_version_patch(version))
}
