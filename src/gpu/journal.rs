//! What the queue was given, command by command, with timestamps and pipeline statistics: for `render --record`.

use std::time::Instant;

use ash::vk;
use serde::Serialize;

/// Commands of one submission that are timed; those beyond are listed without.
const MOST: u32 = 512;

/// One submission.
#[derive(Clone, Debug, Serialize)]
pub struct SubmissionRecord {
    /// What it is for.
    pub pass: String,
    /// The work in it.
    pub work: String,
    /// Seconds of the host's clock from the beginning of the journal until it was submitted.
    pub submitted_s: f64,
    /// Seconds from then until the host knew that it was done.
    pub wall_s: f64,
    /// Its commands, in their order.
    pub commands: Vec<CommandRecord>,
}

/// One command.
#[derive(Clone, Debug, Serialize)]
pub struct CommandRecord {
    /// `dispatch`, `barrier`, `fill` or `copy`.
    pub kind: &'static str,
    /// The pipeline's or the buffer's name; of a barrier what it orders.
    pub name: String,
    /// Of a dispatch: its workgroups.
    pub workgroups: Option<u32>,
    /// Of a dispatch: the push constants, in hexadecimal words.
    pub push_constants: Vec<String>,
    /// Microseconds of the device's clock from the submission's first command to when this one began; nothing where the queue has no timestamps.
    pub begin_us: Option<f64>,
    /// And to when it was done.
    pub end_us: Option<f64>,
    /// Of a dispatch: the invocations of the shader that the device has counted, where it can.
    pub invocations: Option<u64>,
}

/// A buffer on the device.
#[derive(Clone, Debug, Serialize)]
pub struct BufferRecord {
    /// Its name.
    pub name: String,
    /// Its bytes.
    pub size: u64,
    /// Its address, in hexadecimal.
    pub address: String,
}

/// What a journal keeps on the device, and what it has written down.
pub(super) struct Journal {
    began: Instant,
    timestamps: vk::QueryPool,
    /// Null where the device cannot count.
    statistics: vk::QueryPool,
    submissions: Vec<SubmissionRecord>,
    /// Of the submission that is being recorded.
    commands: Vec<CommandRecord>,
}

impl Journal {
    pub(super) fn new(device: &ash::Device, counts: bool) -> Result<Self, vk::Result> {
        let timestamps = vk::QueryPoolCreateInfo::default().query_type(vk::QueryType::TIMESTAMP).query_count(2 * MOST);
        let statistics = vk::QueryPoolCreateInfo::default()
            .query_type(vk::QueryType::PIPELINE_STATISTICS)
            .query_count(MOST)
            .pipeline_statistics(vk::QueryPipelineStatisticFlags::COMPUTE_SHADER_INVOCATIONS);
        let mut new = Self {
            began: Instant::now(),
            timestamps: vk::QueryPool::null(),
            statistics: vk::QueryPool::null(),
            submissions: Vec::new(),
            commands: Vec::new(),
        };
        // SAFETY: the device is alive, and has the feature where it counts.
        unsafe {
            new.timestamps = device.create_query_pool(&timestamps, None)?;
            if counts {
                new.statistics = device.create_query_pool(&statistics, None).inspect_err(|_| new.destroy(device))?;
            }
        }
        Ok(new)
    }

    /// # Safety
    ///
    /// The queue is idle.
    pub(super) unsafe fn destroy(&self, device: &ash::Device) {
        // SAFETY: the caller says that nothing uses the pools; destroying null is allowed.
        unsafe {
            device.destroy_query_pool(self.timestamps, None);
            device.destroy_query_pool(self.statistics, None);
        }
    }

    /// Begins a submission: its command buffer has been begun.
    pub(super) fn begin(&mut self, device: &ash::Device, raw: vk::CommandBuffer) {
        self.commands.clear();
        // SAFETY: the command buffer is being recorded, and the pools belong to its device.
        unsafe {
            device.cmd_reset_query_pool(raw, self.timestamps, 0, 2 * MOST);
            if self.statistics != vk::QueryPool::null() {
                device.cmd_reset_query_pool(raw, self.statistics, 0, MOST);
            }
        }
    }

    /// Takes down a command and records it between two timestamps.
    pub(super) fn record(
        &mut self,
        device: &ash::Device,
        raw: vk::CommandBuffer,
        command: CommandRecord,
        record: impl FnOnce(),
    ) {
        let index = self.commands.len() as u32;
        let is_counted = command.kind == "dispatch" && self.statistics != vk::QueryPool::null();
        self.commands.push(command);
        if index >= MOST {
            record();
            return;
        }
        let stage = vk::PipelineStageFlags2::ALL_COMMANDS;
        // SAFETY: the command buffer is being recorded; each query is written once after the reset.
        unsafe {
            device.cmd_write_timestamp2(raw, stage, self.timestamps, 2 * index);
            if is_counted {
                device.cmd_begin_query(raw, self.statistics, index, vk::QueryControlFlags::empty());
            }
            record();
            if is_counted {
                device.cmd_end_query(raw, self.statistics, index);
            }
            device.cmd_write_timestamp2(raw, stage, self.timestamps, 2 * index + 1);
        }
    }

    /// Ends a submission, which is done: reads what the device has noted.
    pub(super) fn end(&mut self, device: &ash::Device, period: f64, pass: &str, work: &str, submitted: Instant) {
        let wall_s = submitted.elapsed().as_secs_f64();
        let mut commands = std::mem::take(&mut self.commands);
        let timed = commands.len().min(MOST as usize);
        let mut ticks = vec![0u64; 2 * timed];
        let flags = vk::QueryResultFlags::TYPE_64;
        // SAFETY: the queries were written by the submission, which is done.
        let read = timed > 0 && unsafe { device.get_query_pool_results(self.timestamps, 0, &mut ticks, flags) }.is_ok();
        if read && period > 0.0 {
            let first = ticks[0];
            let since = |tick: u64| Some(tick.wrapping_sub(first) as f64 * period / 1e3);
            for (command, own) in commands.iter_mut().zip(ticks.chunks_exact(2)) {
                (command.begin_us, command.end_us) = (since(own[0]), since(own[1]));
            }
        }
        for (index, command) in commands.iter_mut().enumerate().take(timed) {
            let mut count = [0u64];
            if command.kind == "dispatch" && self.statistics != vk::QueryPool::null() {
                // SAFETY: as above.
                let read = unsafe { device.get_query_pool_results(self.statistics, index as u32, &mut count, flags) };
                command.invocations = read.is_ok().then_some(count[0]);
            }
        }
        let submitted_s = submitted.duration_since(self.began).as_secs_f64();
        self.submissions.push(SubmissionRecord {
            pass: pass.to_owned(),
            work: work.to_owned(),
            submitted_s,
            wall_s,
            commands,
        });
    }

    /// What was written down.
    pub(super) fn into_submissions(self) -> Vec<SubmissionRecord> {
        self.submissions
    }
}

impl CommandRecord {
    /// A command of a kind, not timed yet.
    pub(super) fn new(kind: &'static str, name: &str) -> Self {
        Self {
            kind,
            name: name.to_owned(),
            workgroups: None,
            push_constants: Vec::new(),
            begin_us: None,
            end_us: None,
            invocations: None,
        }
    }

    /// A dispatch.
    pub(super) fn dispatch(pipeline: &str, workgroups: u32, push_constants: &[u8]) -> Self {
        let words = push_constants.chunks_exact(4).map(|word| u32::from_le_bytes([word[0], word[1], word[2], word[3]]));
        let push_constants = words.map(|word| format!("{word:08x}")).collect();
        Self { workgroups: Some(workgroups), push_constants, ..Self::new("dispatch", pipeline) }
    }
}
