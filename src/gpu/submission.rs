//! The handles that all work on the queue goes through.

use ash::vk;

/// The command buffer that all work goes through, with the fence that says it is done and two timestamps.
pub(super) struct Submission {
    pub(super) queue: vk::Queue,
    pub(super) pool: vk::CommandPool,
    pub(super) commands: vk::CommandBuffer,
    pub(super) fence: vk::Fence,
    pub(super) timestamps: vk::QueryPool,
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

    pub(super) unsafe fn destroy(&mut self, device: &ash::Device) {
        // SAFETY: the caller says that the queue is idle; the command buffer goes with its pool.
        unsafe {
            device.destroy_query_pool(self.timestamps, None);
            device.destroy_fence(self.fence, None);
            device.destroy_command_pool(self.pool, None);
        }
    }
}
