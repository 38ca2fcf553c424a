//! What a submission is made of: dispatches of pipelines, barriers, buffers that are cleared.

use ash::vk;

use super::buffer::Buffer;
use super::device::Gpu;
use super::journal::CommandRecord;
use super::omission::{Step, omits};
use super::pipeline::{Bindings, Pipeline};
use super::queue::{Recording, Work};
use crate::error::Result;

/// Records one submission.
pub struct Commands<'a>(Recording<'a>);

impl Gpu {
    /// Records commands, submits them and waits until they are done. `pass` and `work` name them in errors.
    ///
    /// What is recorded must live for `'a`, which the borrow of `self` makes longer than the submission.
    pub fn run<'a>(&'a self, pass: &str, work: &str, record: impl FnOnce(&mut Commands<'a>)) -> Result<Work> {
        self.run_raw(pass, work, |recording| record(&mut Commands(*recording)))
    }
}

impl<'a> Commands<'a> {
    /// Runs `workgroups` workgroups of a pipeline with these push constants.
    pub fn dispatch(&mut self, pipeline: &'a Pipeline, bindings: &'a Bindings, push_constants: &[u8], workgroups: u32) {
        let Recording { device, raw, .. } = self.0;
        let told = || CommandRecord::dispatch(&pipeline.name, workgroups, push_constants);
        // SAFETY: the pipeline and the bindings were made for each other's layout by `Pipeline::bind`, and both live for
        // 'a, until the submission is done. The addresses in the push constants and uniforms are the caller's to keep
        // alive: the renderer owns every buffer that it passes on.
        self.0.command(told, || unsafe {
            device.cmd_bind_pipeline(raw, vk::PipelineBindPoint::COMPUTE, pipeline.raw);
            if !omits(Step::DescriptorSet) {
                device.cmd_bind_descriptor_sets(
                    raw,
                    vk::PipelineBindPoint::COMPUTE,
                    pipeline.layout,
                    0,
                    &[bindings.set],
                    &[],
                );
            }
            if !omits(Step::PushConstants) {
                device.cmd_push_constants(raw, pipeline.layout, vk::ShaderStageFlags::COMPUTE, 0, push_constants);
            }
            device.cmd_dispatch(raw, workgroups, 1, 1);
        });
    }

    /// Everything before it is done and visible to everything after it, the host included.
    pub fn barrier(&mut self) {
        self.0.barrier();
    }

    /// Sets every byte of a buffer to zero.
    pub fn clear(&mut self, buffer: &'a Buffer) {
        // SAFETY: the buffer lives for 'a, until the submission is done; buffers have a multiple of four bytes.
        unsafe { self.0.clear(buffer.raw) };
    }
}
