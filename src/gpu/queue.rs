//! Work for the queue: one command buffer, recorded, submitted and waited for.
//!
//! Passes of one submission are separated by one global memory barrier: they hand whole buffers to each other, so nothing
//! finer would let the device overlap more.

use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use ash::vk;

use super::device::Gpu;
use super::journal::{CommandRecord, Journal};
use super::omission::{Step, omits};
use crate::error::{Error, Result};

/// How long a submission took.
#[derive(Clone, Copy, Debug, Default)]
pub struct Work {
    /// Between the first and the last command, by the device's clock; by the host's where the queue has no timestamps.
    pub device: Duration,
    /// From submission until the host knew that it was done.
    pub wall: Duration,
}

/// The command buffer of a submission while it is recorded.
#[derive(Clone, Copy)]
pub(super) struct Recording<'a> {
    pub(super) device: &'a ash::Device,
    pub(super) raw: vk::CommandBuffer,
    /// Where there is a journal.
    journal: Option<&'a Mutex<Option<Journal>>>,
}

impl Recording<'_> {
    /// Records a command; where there is a journal, `told` says what it is, and it is timed.
    pub(super) fn command(&self, told: impl FnOnce() -> CommandRecord, record: impl FnOnce()) {
        let journal = self.journal.map(|journal| journal.lock().unwrap_or_else(PoisonError::into_inner));
        match journal {
            Some(mut journal) => match journal.as_mut() {
                Some(journal) => journal.record(self.device, self.raw, told(), record),
                None => record(),
            },
            None => record(),
        }
    }

    /// Everything before it is done and visible to everything after it, the host included.
    pub(super) fn barrier(&self) {
        let told = || CommandRecord::new("barrier", "all writes before all reads and writes, the host's too");
        self.command(told, || self.barrier_raw());
    }

    fn barrier_raw(&self) {
        if omits(Step::Barrier) {
            return;
        }
        let stages = vk::PipelineStageFlags2::ALL_COMMANDS | vk::PipelineStageFlags2::HOST;
        let barriers = [vk::MemoryBarrier2::default()
            .src_stage_mask(stages)
            .src_access_mask(vk::AccessFlags2::MEMORY_WRITE)
            .dst_stage_mask(stages)
            .dst_access_mask(vk::AccessFlags2::MEMORY_READ | vk::AccessFlags2::MEMORY_WRITE)];
        let info = vk::DependencyInfo::default().memory_barriers(&barriers);
        // SAFETY: the command buffer is being recorded.
        unsafe { self.device.cmd_pipeline_barrier2(self.raw, &info) };
    }

    /// Sets every byte of a buffer to zero.
    ///
    /// # Safety
    ///
    /// The buffer is of this device and alive until the submission is done; its size is a multiple of four.
    pub(super) unsafe fn clear(&self, buffer: vk::Buffer) {
        self.barrier();
        let told = || CommandRecord::new("fill", "with zeros");
        // SAFETY: the caller says what this needs.
        self.command(told, || unsafe { self.device.cmd_fill_buffer(self.raw, buffer, 0, vk::WHOLE_SIZE, 0) });
        self.barrier();
    }
}

impl Gpu {
    /// Records commands, submits them and waits until they are done. `pass` and `work` name them in errors. What is recorded
    /// must live until this returns.
    pub(super) fn run_raw<'a>(&'a self, pass: &str, work: &str, record: impl FnOnce(&Recording<'a>)) -> Result<Work> {
        self.submit(pass, work, self.shared.fault.loses_device_at_run(), record)
    }

    /// Submits any work, copies included. Where the device `is_lost`, it fails like a driver that says so.
    fn submit<'a>(
        &'a self,
        pass: &str,
        work: &str,
        is_lost: bool,
        record: impl FnOnce(&Recording<'a>),
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
            if !omits(Step::QueryReset) {
                device.cmd_reset_query_pool(commands, submission.timestamps, 0, 2);
            }
            device.cmd_write_timestamp2(commands, vk::PipelineStageFlags2::NONE, submission.timestamps, 0);
        }
        let journal = self.journal().as_mut().map(|journal| journal.begin(device, commands));
        record(&Recording { device, raw: commands, journal: journal.map(|()| &self.shared.journal) });
        let started;
        // SAFETY: as above; the fence is unsignalled because each wait is followed by a reset.
        unsafe {
            device.cmd_write_timestamp2(commands, vk::PipelineStageFlags2::ALL_COMMANDS, submission.timestamps, 1);
            if !omits(Step::EndCommands) {
                device.end_command_buffer(commands).map_err(lost)?;
            }
            let infos = [vk::CommandBufferSubmitInfo::default().command_buffer(commands)];
            let submit = [vk::SubmitInfo2::default().command_buffer_infos(&infos)];
            started = Instant::now();
            device.queue_submit2(submission.queue, &submit, submission.fence).map_err(lost)?;
            device.wait_for_fences(&[submission.fence], true, u64::MAX).map_err(lost)?;
            if !omits(Step::FenceReset) {
                device.reset_fences(&[submission.fence]).map_err(lost)?;
            }
        }
        let wall = started.elapsed();
        if let Some(journal) = self.journal().as_mut() {
            journal.end(device, self.limits().timestamp_period, pass, work, started);
        }
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

    /// Copies a region from one buffer to another. `what` names the copy in errors.
    ///
    /// # Safety
    ///
    /// Both buffers are of this device and alive until this returns, and the region lies inside both.
    pub(super) unsafe fn transfer(
        &self,
        what: &str,
        from: vk::Buffer,
        to: vk::Buffer,
        region: vk::BufferCopy,
    ) -> Result<()> {
        let is_lost = self.shared.fault.has_lost_device();
        self.submit(what, &format!("{} bytes", region.size), is_lost, |recording| {
            recording.barrier();
            let told = || CommandRecord::new("copy", what);
            // SAFETY: the caller says what this needs; the submission is done before this returns.
            recording.command(told, || unsafe { recording.device.cmd_copy_buffer(recording.raw, from, to, &[region]) });
            recording.barrier();
        })?;
        Ok(())
    }

    /// Sets every byte of a buffer of `size` bytes to zero.
    ///
    /// # Safety
    ///
    /// The buffer is of this device and alive until this returns; its size is a multiple of four.
    pub(super) unsafe fn clear(&self, buffer: vk::Buffer, size: u64) -> Result<()> {
        let is_lost = self.shared.fault.has_lost_device();
        self.submit("clearing", &format!("{size} bytes"), is_lost, |recording| {
            // SAFETY: the caller says what this needs; the submission is done before this returns.
            unsafe { recording.clear(buffer) };
        })?;
        Ok(())
    }
}
