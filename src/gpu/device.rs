//! One device made ready: its logical device, its queue, its allocator, and what its driver allows.

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use ash::{ext, khr, vk};
use gpu_allocator::vulkan::{Allocator, AllocatorCreateDesc};
use gpu_allocator::{AllocationSizes, AllocatorDebugSettings};

use super::address_space;
use super::fault::Fault;
use super::instance::{Instance, InstanceShared};
use super::journal::{BufferRecord, Journal, SubmissionRecord};
use super::omission::{Step, omits};
use super::presenting::Presenting;
use super::submission::Submission;
use super::survey::{DeviceKind, RAY_QUERY_EXTENSIONS, Survey};
use crate::error::{Error, Result, one_of};
use crate::layout::backend::Backend;

/// A device ready for work. Cheap to clone: the clones are one device.
#[derive(Clone)]
pub struct Gpu {
    pub(super) shared: Arc<GpuShared>,
}

/// What the driver allows, as far as lumbre meets it.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// Largest number of workgroups of one dispatch along x.
    pub max_workgroups: u32,
    /// Nanoseconds of one tick of a timestamp; 0 where the queue has none.
    pub timestamp_period: f64,
    /// Alignment of the scratch memory of acceleration-structure builds.
    pub scratch_alignment: u64,
    /// Primitives that one bottom-level acceleration structure may hold.
    pub max_blas_primitives: u64,
    /// Instances that a top-level acceleration structure may hold.
    pub max_instances: u64,
    /// Bytes of the largest single allocation.
    pub max_allocation: u64,
    /// Bytes of the largest buffer.
    pub max_buffer: u64,
    /// Whether shaders can add to 64-bit integers in buffers atomically (`shaderBufferInt64Atomics`).
    pub int64_atomics: bool,
    /// Whether it counts the invocations of shaders (`pipelineStatisticsQuery`).
    pub counts_invocations: bool,
}

pub(super) struct GpuShared {
    pub(super) raw: ash::Device,
    pub(super) survey: Survey,
    pub(super) limits: Limits,
    pub(super) acceleration: Option<khr::acceleration_structure::Device>,
    names: Option<ext::debug_utils::Device>,
    // Taken out first when dropped: it must go before the device.
    allocator: Mutex<Option<Allocator>>,
    in_use: AtomicU64,
    peak: AtomicU64,
    submission: Mutex<Submission>,
    pub(super) journal: Mutex<Option<Journal>>,
    /// What there is: name, bytes and address of each buffer.
    buffers: Mutex<Vec<(String, u64, u64)>>,
    pub(super) fault: Fault,
    pub(super) instance: Arc<InstanceShared>,
}

impl Gpu {
    /// Opens the device that `selector` names (index, UUID or a part of the name), or, without one, the first of the
    /// fastest kind: discrete, integrated, virtual, then the processor.
    pub fn open(instance: &Instance, selector: Option<&str>) -> Result<Self> {
        address_space::check()?;
        let devices = instance.devices()?;
        let describe = |survey: &Survey| format!("{} ({})", survey.index, survey.name);
        if devices.is_empty() {
            return Err(Error::Device(String::from(
                "no Vulkan device on this machine: install a driver (Debian and Ubuntu: mesa-vulkan-drivers, which brings lavapipe)",
            )));
        }
        let chosen = match selector {
            Some(selector) => devices.iter().find(|survey| survey.answers_to(selector)).ok_or_else(|| {
                Error::Usage(format!(
                    "no device '{selector}': valid are {}, a UUID, or a part of a name",
                    one_of(devices.iter().map(describe))
                ))
            })?,
            None => devices.iter().filter(|survey| survey.usable()).min_by_key(|survey| rank(survey.kind)).ok_or_else(
                || {
                    let why = devices
                        .iter()
                        .map(|survey| format!("{} lacks {}", describe(survey), survey.missing.join(", ")));
                    Error::Device(format!("no usable Vulkan device: {}", why.collect::<Vec<_>>().join("; ")))
                },
            )?,
        };
        if !chosen.usable() {
            return Err(Error::Device(format!("device {} lacks {}", describe(chosen), chosen.missing.join(", "))));
        }
        Self::create(instance, chosen.clone(), &Presenting::Nothing)
    }

    /// Makes a device of one that the instance listed, for work that includes `presenting`.
    pub(super) fn create(instance: &Instance, survey: Survey, presenting: &Presenting) -> Result<Self> {
        let fault = Fault::from_environment()?;
        let failed = |doing: &str| {
            let doing = format!("{doing} on {}", survey.name);
            move |code: vk::Result| Error::Vulkan { doing: doing.clone(), code: code.to_string() }
        };
        let raw_instance = &instance.shared.raw;
        // SAFETY: the device was listed by this instance, which is alive.
        let families = unsafe { raw_instance.get_physical_device_queue_family_properties(survey.raw) };
        let (family, properties) = families
            .iter()
            .enumerate()
            .find(|(index, family)| presenting.suits(survey.raw, *index as u32, family.queue_flags))
            .ok_or_else(|| Error::Device(format!("{} has no {}", survey.name, presenting.queue())))?;
        let family = family as u32;
        let has_timestamps = properties.timestamp_valid_bits > 0;

        let ray_query = survey.refusal(Backend::RayQuery).is_none();
        let mut extensions: Vec<_> =
            RAY_QUERY_EXTENSIONS.iter().filter(|_| ray_query).map(|name| name.as_ptr()).collect();
        extensions.extend(presenting.extensions());
        let priorities = [1.0];
        let queues = [vk::DeviceQueueCreateInfo::default().queue_family_index(family).queue_priorities(&priorities)];
        let limits = Limits::read(raw_instance, survey.raw, ray_query, has_timestamps);
        let features = vk::PhysicalDeviceFeatures::default()
            .shader_int64(true)
            .pipeline_statistics_query(limits.counts_invocations);
        let mut vulkan12 = vk::PhysicalDeviceVulkan12Features::default()
            .buffer_device_address(!omits(Step::Features))
            .scalar_block_layout(true)
            .shader_buffer_int64_atomics(limits.int64_atomics);
        let mut vulkan13 = vk::PhysicalDeviceVulkan13Features::default()
            .synchronization2(true)
            .maintenance4(true)
            .dynamic_rendering(presenting.draws());
        let mut acceleration =
            vk::PhysicalDeviceAccelerationStructureFeaturesKHR::default().acceleration_structure(true);
        let mut query = vk::PhysicalDeviceRayQueryFeaturesKHR::default().ray_query(true);
        let mut info = vk::DeviceCreateInfo::default()
            .queue_create_infos(&queues)
            .enabled_extension_names(&extensions)
            .enabled_features(&features)
            .push_next(&mut vulkan12)
            .push_next(&mut vulkan13);
        if ray_query {
            info = info.push_next(&mut acceleration).push_next(&mut query);
        }
        // SAFETY: all that `info` points to lives through the call; the survey found every feature and extension.
        let raw = unsafe { raw_instance.create_device(survey.raw, &info, None) }
            .map_err(failed("create a logical device"))?;

        let names = instance.shared.has_names.then(|| ext::debug_utils::Device::new(raw_instance, &raw));
        let allocator = Allocator::new(&AllocatorCreateDesc {
            instance: raw_instance.clone(),
            device: raw.clone(),
            physical_device: survey.raw,
            debug_settings: AllocatorDebugSettings::default(),
            buffer_device_address: !omits(Step::AddressMemory),
            allocation_sizes: AllocationSizes::new(32 << 20, 16 << 20),
        })
        .map_err(|error| Error::Device(format!("no allocator for {}: {error}", survey.name)))?;
        // SAFETY: the family has one queue at least, and that one was created with the device.
        let queue = unsafe { raw.get_device_queue(family, 0) };
        let submission = Submission::new(&raw, queue, family).map_err(failed("create the command buffer"))?;
        let gpu = Self {
            shared: Arc::new(GpuShared {
                acceleration: ray_query.then(|| khr::acceleration_structure::Device::new(raw_instance, &raw)),
                limits,
                names,
                allocator: Mutex::new(Some(allocator)),
                in_use: AtomicU64::new(0),
                peak: AtomicU64::new(0),
                submission: Mutex::new(submission),
                journal: Mutex::new(None),
                buffers: Mutex::new(Vec::new()),
                fault,
                survey,
                instance: instance.shared.clone(),
                raw,
            }),
        };
        gpu.name_submission();
        Ok(gpu)
    }

    fn name_submission(&self) {
        let submission = self.submission();
        self.name(submission.queue, "compute queue");
        self.name(submission.pool, "command pool");
        self.name(submission.commands, "command buffer");
        self.name(submission.fence, "submission done");
        self.name(submission.timestamps, "timestamps");
    }

    /// What the device is.
    pub fn survey(&self) -> &Survey {
        &self.shared.survey
    }

    /// What its driver allows.
    pub fn limits(&self) -> &Limits {
        &self.shared.limits
    }

    /// Fails where the device lacks 64-bit atomics; `what` needs them, and `otherwise` says what is valid there.
    pub(crate) fn require_int64_atomics(&self, what: &str, otherwise: &str) -> Result<()> {
        if self.limits().int64_atomics {
            return Ok(());
        }
        Err(Error::Usage(format!(
            "{what} needs the feature shaderBufferInt64Atomics, which {} lacks; {otherwise}",
            self.survey().name
        )))
    }

    /// The messages of the validation layer since the last call; always empty where it is off.
    pub fn take_validation_messages(&self) -> Vec<String> {
        self.shared.instance.take_messages()
    }

    /// Bytes that lumbre holds on the device now.
    pub fn bytes_in_use(&self) -> u64 {
        self.shared.in_use.load(Ordering::Relaxed)
    }

    /// The most bytes that it has held since the last [`Gpu::reset_peak`].
    pub fn peak_bytes(&self) -> u64 {
        self.shared.peak.load(Ordering::Relaxed)
    }

    /// Bytes that can still be allocated on the device's largest heap: what the driver's budget leaves, where it tells one
    /// (VK_EXT_memory_budget), else all that lumbre does not hold. On a processor what a limit on address space leaves, if that is less.
    pub fn free_memory(&self) -> u64 {
        let own = if self.survey().kind == DeviceKind::Cpu { address_space::left_for_data() } else { None };
        self.free_on_heap().min(own.unwrap_or(u64::MAX))
    }

    fn free_on_heap(&self) -> u64 {
        let (instance, survey) = (&self.shared.instance.raw, self.survey());
        if !survey.has_memory_budget {
            return survey.memory.saturating_sub(self.bytes_in_use());
        }
        let mut budget = vk::PhysicalDeviceMemoryBudgetPropertiesEXT::default();
        let mut properties = vk::PhysicalDeviceMemoryProperties2::default().push_next(&mut budget);
        // SAFETY: the device belongs to the live instance and has the extension that the chained structure is part of.
        unsafe { instance.get_physical_device_memory_properties2(survey.raw, &mut properties) };
        let heaps = properties.memory_properties;
        let heaps = heaps.memory_heaps_as_slice().iter().zip(budget.heap_budget.iter().zip(&budget.heap_usage));
        heaps
            .filter(|(heap, _)| heap.flags.contains(vk::MemoryHeapFlags::DEVICE_LOCAL))
            .max_by_key(|(heap, _)| heap.size)
            .map_or(0, |(heap, (budget, usage))| (*budget).min(heap.size).saturating_sub(*usage))
    }

    /// Begins to write down what the queue is given.
    pub fn start_journal(&self) -> Result<()> {
        let journal = Journal::new(&self.shared.raw, self.limits().counts_invocations);
        *self.journal() = Some(journal.map_err(self.failed("create the query pools of a journal"))?);
        Ok(())
    }

    /// Ends that: what the queue was given since then, and the buffers that there are now, by name.
    pub fn end_journal(&self) -> (Vec<SubmissionRecord>, Vec<BufferRecord>) {
        let journal = self.journal().take();
        let submissions = journal.map_or(Vec::new(), |journal| {
            // SAFETY: each submission is waited for, so that nothing uses the pools.
            unsafe { journal.destroy(&self.shared.raw) };
            journal.into_submissions()
        });
        let mut buffers: Vec<BufferRecord> = self
            .buffers()
            .iter()
            .map(|(name, size, address)| BufferRecord {
                name: name.clone(),
                size: *size,
                address: format!("{address:016x}"),
            })
            .collect();
        buffers.sort_by(|one, other| one.address.cmp(&other.address));
        (submissions, buffers)
    }

    pub(super) fn journal(&self) -> MutexGuard<'_, Option<Journal>> {
        self.shared.journal.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn buffers(&self) -> MutexGuard<'_, Vec<(String, u64, u64)>> {
        self.shared.buffers.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Takes note of a buffer.
    pub(super) fn list_buffer(&self, name: &str, size: u64, address: u64) {
        self.buffers().push((name.to_owned(), size, address));
    }

    /// Forgets the buffer of that address.
    pub(super) fn unlist_buffer(&self, address: u64) {
        let mut buffers = self.buffers();
        if let Some(index) = buffers.iter().rposition(|(.., own)| *own == address) {
            buffers.swap_remove(index);
        }
    }

    /// Begins a new measurement of the peak.
    pub fn reset_peak(&self) {
        self.shared.peak.store(self.bytes_in_use(), Ordering::Relaxed);
    }

    pub(super) fn count_allocation(&self, bytes: u64) {
        let now = self.shared.in_use.fetch_add(bytes, Ordering::Relaxed) + bytes;
        self.shared.peak.fetch_max(now, Ordering::Relaxed);
    }

    pub(super) fn count_free(&self, bytes: u64) {
        self.shared.in_use.fetch_sub(bytes, Ordering::Relaxed);
    }

    pub(super) fn with_allocator<T>(&self, run: impl FnOnce(&mut Allocator) -> T) -> Option<T> {
        self.shared.allocator.lock().unwrap_or_else(PoisonError::into_inner).as_mut().map(run)
    }

    pub(super) fn submission(&self) -> MutexGuard<'_, Submission> {
        self.shared.submission.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Gives an object a name that validation messages and debuggers show.
    pub(super) fn name(&self, handle: impl vk::Handle, name: &str) {
        let Some(names) = &self.shared.names else { return };
        let Ok(name) = std::ffi::CString::new(name) else { return };
        let info = vk::DebugUtilsObjectNameInfoEXT::default().object_handle(handle).object_name(&name);
        // SAFETY: the handle is alive and belongs to this device; a failure only costs the name.
        let _ = unsafe { names.set_debug_utils_object_name(&info) };
    }

    /// Turns a failed call into an error that says what was being done.
    pub(super) fn failed(&self, doing: impl Into<String>) -> impl FnOnce(vk::Result) -> Error {
        let doing = doing.into();
        let device = self.survey().name.clone();
        let in_use = self.bytes_in_use();
        move |code| match code {
            vk::Result::ERROR_DEVICE_LOST => {
                Error::DeviceLost { device, pass: doing, work: String::from("no frame was running") }
            }
            vk::Result::ERROR_OUT_OF_DEVICE_MEMORY | vk::Result::ERROR_OUT_OF_HOST_MEMORY => {
                Error::OutOfMemory { what: doing, needs: 0, in_use, limit: format!(" ({code})") }
            }
            code => Error::Vulkan { doing, code: code.to_string() },
        }
    }
}

impl Limits {
    fn read(instance: &ash::Instance, device: vk::PhysicalDevice, ray_query: bool, has_timestamps: bool) -> Self {
        let mut acceleration = vk::PhysicalDeviceAccelerationStructurePropertiesKHR::default();
        let mut maintenance = vk::PhysicalDeviceMaintenance3Properties::default();
        let mut maintenance4 = vk::PhysicalDeviceMaintenance4Properties::default();
        let mut properties =
            vk::PhysicalDeviceProperties2::default().push_next(&mut maintenance).push_next(&mut maintenance4);
        if ray_query {
            properties = properties.push_next(&mut acceleration);
        }
        // SAFETY: the device belongs to the live instance and has what the chained structures are part of.
        unsafe { instance.get_physical_device_properties2(device, &mut properties) };
        let limits = properties.properties.limits;
        let mut vulkan12 = vk::PhysicalDeviceVulkan12Features::default();
        let mut features = vk::PhysicalDeviceFeatures2::default().push_next(&mut vulkan12);
        // SAFETY: as above.
        unsafe { instance.get_physical_device_features2(device, &mut features) };
        let base = features.features;
        Self {
            counts_invocations: base.pipeline_statistics_query == vk::TRUE,
            int64_atomics: vulkan12.shader_buffer_int64_atomics == vk::TRUE,
            max_workgroups: limits.max_compute_work_group_count[0],
            timestamp_period: if has_timestamps { f64::from(limits.timestamp_period) } else { 0.0 },
            scratch_alignment: u64::from(acceleration.min_acceleration_structure_scratch_offset_alignment).max(1),
            max_blas_primitives: acceleration.max_primitive_count,
            max_instances: acceleration.max_instance_count,
            max_allocation: maintenance.max_memory_allocation_size,
            max_buffer: maintenance4.max_buffer_size,
        }
    }
}

fn rank(kind: DeviceKind) -> u8 {
    match kind {
        DeviceKind::DiscreteGpu => 0,
        DeviceKind::IntegratedGpu => 1,
        DeviceKind::VirtualGpu => 2,
        DeviceKind::Other => 3,
        DeviceKind::Cpu => 4,
    }
}

impl Drop for GpuShared {
    fn drop(&mut self) {
        // SAFETY: every object made from the device holds it alive, so none is left but the ones freed here; nothing runs
        // on the queue, because each submission is waited for.
        unsafe {
            let _ = self.raw.device_wait_idle();
            if let Some(journal) = self.journal.get_mut().unwrap_or_else(PoisonError::into_inner).take() {
                journal.destroy(&self.raw);
            }
            self.submission.get_mut().unwrap_or_else(PoisonError::into_inner).destroy(&self.raw);
            drop(self.allocator.get_mut().unwrap_or_else(PoisonError::into_inner).take());
            self.raw.destroy_device(None);
        }
    }
}
