//! Work for the queue: one command buffer, recorded, submitted and waited for.
//!
//! Passes of one frame are separated by one global memory barrier: they hand whole buffers to each other, so nothing
//! finer would let the device overlap more.

use std::time::{Duration, Instant};

use ash::vk;

use super::buffer::Buffer;
use super::device::Gpu;
use super::pipeline::{Bindings, Pipeline};
use crate::error::{Error, Result};

/// The command buffer that all work goes through, with the fence that says it is done and two timestamps.
pub(super) struct Submission {
    queue: vk::Queue,
    pool: vk::CommandPool,
    commands: vk::CommandBuffer,
    fence: vk::Fence,
    timestamps: vk::QueryPool,
}

/// How long a submission took.
#[derive(Clone, Copy, Debug, Default)]
pub struct Work {
    /// Between the first and the last command, by the device's clock; by the host's where the queue has no timestamps.
    pub device: Duration,
    /// From submission until the host knew that it was done.
    pub wall: Duration,
}

/// Records one submission.
pub struct Commands<'a> {
    gpu: &'a Gpu,
    raw: vk::CommandBuffer,
}

impl Submission {
    pub(super) fn new(device: &ash::Device, queue: vk::Queue, family: u32) -> Result<Self, vk::Result> {
        let pool_info = vk::CommandPoolCreateInfo::default()
            .queue_family_index(family)
            .flags(vk::CommandPoolCreateFlags::RESET_COMMAND_BUFFER);
        // SAFETY: the device is alive throughout; each handle comes from it and is destroyed in `destroy`, where
        // destroying a null handle (of a failed creation) is allowed.
        unsafe {
            let mut new = Self {
                queue,
                pool: device.create_command_pool(&pool_info, None)?,
                commands: vk::CommandBuffer::null(),
                fence: vk::Fence::null(),
                timestamps: vk::QueryPool::null(),
            };
            let filled = new.fill(device);
            if filled.is_err() {
                new.destroy(device);
            }
            filled.map(|()| new)
        }
    }

    unsafe fn fill(&mut self, device: &ash::Device) -> Result<(), vk::Result> {
        let commands = vk::CommandBufferAllocateInfo::default().command_pool(self.pool).command_buffer_count(1);
        let timestamps = vk::QueryPoolCreateInfo::default().query_type(vk::QueryType::TIMESTAMP).query_count(2);
        // SAFETY: the caller's device is alive and the pool belongs to it.
        unsafe {
            self.commands = device.allocate_command_buffers(&commands)?[0];
            self.fence = device.create_fence(&vk::FenceCreateInfo::default(), None)?;
            self.timestamps = device.create_query_pool(&timestamps, None)?;
        }
        Ok(())
    }

    pub(super) fn name(&self, gpu: &Gpu) {
        gpu.name(self.queue, "compute queue");
        gpu.name(self.pool, "command pool");
        gpu.name(self.commands, "command buffer");
        gpu.name(self.fence, "submission done");
        gpu.name(self.timestamps, "timestamps");
    }

    pub(super) unsafe fn destroy(&mut self, device: &ash::Device) {
        // SAFETY: the caller says that the queue is idle; the command buffer goes with its pool.
        unsafe {
            device.destroy_query_pool(self.timestamps, None);
            device.destroy_fence(self.fence, None);
            device.destroy_command_pool(self.pool, None);
        }
    }
}

impl Gpu {
    /// Records commands, submits them and waits until they are done. `pass` and `work` name them in errors.
    ///
    /// What is recorded must live for `'a`, which the borrow of `self` makes longer than the submission.
    pub fn run<'a>(&'a self, pass: &str, work: &str, record: impl FnOnce(&mut Commands<'a>)) -> Result<Work> {
        let is_lost = self.shared.fault.loses_device_at_run();
        self.submit(pass, work, is_lost, record)
    }

    /// The same for all work, copies included; where the device `is_lost`, it fails like a driver that says so.
    fn submit<'a>(
        &'a self,
        pass: &str,
        work: &str,
        is_lost: bool,
        record: impl FnOnce(&mut Commands<'a>),
    ) -> Result<Work> {
        let submission = self.submission();
        let device = &self.shared.raw;
        let lost = |code: vk::Result| match code {
            vk::Result::ERROR_DEVICE_LOST => {
                Error::DeviceLost { device: self.survey().name.clone(), pass: pass.to_owned(), work: work.to_owned() }
            }
            vk::Result::ERROR_OUT_OF_DEVICE_MEMORY | vk::Result::ERROR_OUT_OF_HOST_MEMORY => Error::OutOfMemory {
                what: format!("{pass} ({work})"),
                needs: 0,
                in_use: self.bytes_in_use(),
                limit: format!(" ({code})"),
            },
            code => Error::Vulkan { doing: format!("run {pass} ({work})"), code: code.to_string() },
        };
        if is_lost {
            return Err(lost(vk::Result::ERROR_DEVICE_LOST));
        }
        let commands = submission.commands;
        // SAFETY: the mutex in `submission` makes this thread the only user of the queue, pool and command buffer, and the
        // wait below ends before it is released, so recording never meets a buffer in use.
        unsafe {
            device.reset_command_buffer(commands, vk::CommandBufferResetFlags::empty()).map_err(lost)?;
            let begin = vk::CommandBufferBeginInfo::default().flags(vk::CommandBufferUsageFlags::ONE_TIME_SUBMIT);
            device.begin_command_buffer(commands, &begin).map_err(lost)?;
            device.cmd_reset_query_pool(commands, submission.timestamps, 0, 2);
            device.cmd_write_timestamp2(commands, vk::PipelineStageFlags2::NONE, submission.timestamps, 0);
        }
        record(&mut Commands { gpu: self, raw: commands });
        let started;
        // SAFETY: as above; the fence is unsignalled because each wait is followed by a reset.
        unsafe {
            device.cmd_write_timestamp2(commands, vk::PipelineStageFlags2::ALL_COMMANDS, submission.timestamps, 1);
            device.end_command_buffer(commands).map_err(lost)?;
            let infos = [vk::CommandBufferSubmitInfo::default().command_buffer(commands)];
            let submit = [vk::SubmitInfo2::default().command_buffer_infos(&infos)];
            started = Instant::now();
            device.queue_submit2(submission.queue, &submit, submission.fence).map_err(lost)?;
            device.wait_for_fences(&[submission.fence], true, u64::MAX).map_err(lost)?;
            device.reset_fences(&[submission.fence]).map_err(lost)?;
        }
        let wall = started.elapsed();
        let period = self.limits().timestamp_period;
        let mut ticks = [0u64; 2];
        // SAFETY: both queries were written by the submission that the fence says is done.
        let read = unsafe {
            device.get_query_pool_results(submission.timestamps, 0, &mut ticks, vk::QueryResultFlags::TYPE_64)
        };
        let device = match read {
            Ok(()) if period > 0.0 => Duration::from_nanos((ticks[1].wrapping_sub(ticks[0]) as f64 * period) as u64),
            _ => wall,
        };
        Ok(Work { device, wall })
    }

    pub(super) fn transfer(&self, what: &str, from: &Buffer, to: &Buffer, region: vk::BufferCopy) -> Result<()> {
        let is_lost = self.shared.fault.has_lost_device();
        self.submit(what, &format!("{} bytes", region.size), is_lost, |commands| {
            commands.barrier();
            // SAFETY: both buffers are alive until the submission is done, and the callers keep the region inside both.
            unsafe { commands.gpu.shared.raw.cmd_copy_buffer(commands.raw, from.raw, to.raw, &[region]) };
            commands.barrier();
        })?;
        Ok(())
    }

    pub(super) fn clear(&self, buffer: &Buffer) -> Result<()> {
        let is_lost = self.shared.fault.has_lost_device();
        self.submit("clearing", &format!("{} bytes", buffer.size()), is_lost, |commands| commands.clear(buffer))?;
        Ok(())
    }
}

impl<'a> Commands<'a> {
    /// Runs `workgroups` workgroups of a pipeline with these push constants.
    pub fn dispatch(&mut self, pipeline: &'a Pipeline, bindings: &'a Bindings, push_constants: &[u8], workgroups: u32) {
        let device = &self.gpu.shared.raw;
        // SAFETY: the pipeline and the bindings were made for each other's layout by `Pipeline::bind`, and both live for
        // 'a, until the submission is done. The addresses in the push constants and uniforms are the caller's to keep
        // alive: the renderer owns every buffer that it passes on.
        unsafe {
            device.cmd_bind_pipeline(self.raw, vk::PipelineBindPoint::COMPUTE, pipeline.raw);
            device.cmd_bind_descriptor_sets(
                self.raw,
                vk::PipelineBindPoint::COMPUTE,
                pipeline.layout,
                0,
                &[bindings.set],
                &[],
            );
            device.cmd_push_constants(self.raw, pipeline.layout, vk::ShaderStageFlags::COMPUTE, 0, push_constants);
            device.cmd_dispatch(self.raw, workgroups, 1, 1);
        }
    }

    /// Everything before it is done and visible to everything after it, the host included.
    pub fn barrier(&mut self) {
        let stages = vk::PipelineStageFlags2::ALL_COMMANDS | vk::PipelineStageFlags2::HOST;
        let barriers = [vk::MemoryBarrier2::default()
            .src_stage_mask(stages)
            .src_access_mask(vk::AccessFlags2::MEMORY_WRITE)
            .dst_stage_mask(stages)
            .dst_access_mask(vk::AccessFlags2::MEMORY_READ | vk::AccessFlags2::MEMORY_WRITE)];
        let info = vk::DependencyInfo::default().memory_barriers(&barriers);
        // SAFETY: the command buffer is being recorded.
        unsafe { self.gpu.shared.raw.cmd_pipeline_barrier2(self.raw, &info) };
    }

    /// Sets every byte of a buffer to zero.
    pub fn clear(&mut self, buffer: &'a Buffer) {
        self.barrier();
        // SAFETY: the buffer is alive until the submission is done; its size is a multiple of four.
        unsafe { self.gpu.shared.raw.cmd_fill_buffer(self.raw, buffer.raw, 0, vk::WHOLE_SIZE, 0) };
        self.barrier();
    }

    pub(super) fn raw(&self) -> vk::CommandBuffer {
        self.raw
    }
}
