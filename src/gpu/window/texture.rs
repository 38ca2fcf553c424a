//! Pictures on the device that triangles are covered with.

use ash::vk;
use gpu_allocator::MemoryLocation;
use gpu_allocator::vulkan::{Allocation, AllocationCreateDesc, AllocationScheme};

use crate::error::{Error, Result};
use crate::gpu::{Buffer, Gpu};

/// A picture, or a part of one, that is to be on the device: rows of pixels from the upper left, sRGB with premultiplied alpha.
#[derive(Clone, Copy, Debug)]
pub struct TextureChange<'a> {
    /// The upper left corner of the part that changes; nothing for all of it, which may have another size than before.
    pub at: Option<[u32; 2]>,
    /// Width and height in pixels of what changes.
    pub size: [u32; 2],
    /// Its pixels.
    pub pixels: &'a [[u8; 4]],
    /// Whether it is smooth between pixels where it is shown larger.
    pub is_smooth: bool,
}

/// What textures hold.
const FORMAT: vk::Format = vk::Format::R8G8B8A8_UNORM;

/// A texture. Freed when dropped.
pub(super) struct Texture {
    gpu: Gpu,
    image: vk::Image,
    allocation: Option<Allocation>,
    pub view: vk::ImageView,
    pub size: [u32; 2],
    pub is_smooth: bool,
    /// Whether it has pixels yet.
    is_filled: bool,
}

/// A view of the colours of an image.
pub(super) fn view_of(gpu: &Gpu, image: vk::Image, format: vk::Format) -> Result<vk::ImageView> {
    let info = vk::ImageViewCreateInfo::default()
        .image(image)
        .view_type(vk::ImageViewType::TYPE_2D)
        .format(format)
        .subresource_range(COLOURS);
    // SAFETY: the image is alive and was made for this format.
    unsafe { gpu.shared.raw.create_image_view(&info, None) }.map_err(gpu.failed("make a view of an image"))
}

/// All there is of an image.
pub(super) const COLOURS: vk::ImageSubresourceRange = vk::ImageSubresourceRange {
    aspect_mask: vk::ImageAspectFlags::COLOR,
    base_mip_level: 0,
    level_count: 1,
    base_array_layer: 0,
    layer_count: 1,
};

/// Brings an image from one layout to another, once all before it is done and before all that comes after it.
pub(super) fn change_layout(
    device: &ash::Device,
    commands: vk::CommandBuffer,
    image: vk::Image,
    [from, to]: [vk::ImageLayout; 2],
) {
    let barriers = [vk::ImageMemoryBarrier2::default()
        .src_stage_mask(vk::PipelineStageFlags2::ALL_COMMANDS)
        .src_access_mask(vk::AccessFlags2::MEMORY_WRITE)
        .dst_stage_mask(vk::PipelineStageFlags2::ALL_COMMANDS)
        .dst_access_mask(vk::AccessFlags2::MEMORY_READ | vk::AccessFlags2::MEMORY_WRITE)
        .old_layout(from)
        .new_layout(to)
        .src_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
        .dst_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
        .image(image)
        .subresource_range(COLOURS)];
    let info = vk::DependencyInfo::default().image_memory_barriers(&barriers);
    // SAFETY: the caller records the commands, and the image lives until they are done.
    unsafe { device.cmd_pipeline_barrier2(commands, &info) };
}

impl Texture {
    /// A texture without pixels yet.
    pub fn new(gpu: &Gpu, size: [u32; 2], is_smooth: bool) -> Result<Self> {
        let device = &gpu.shared.raw;
        let [width, height] = size;
        let info = vk::ImageCreateInfo::default()
            .image_type(vk::ImageType::TYPE_2D)
            .format(FORMAT)
            .extent(vk::Extent3D { width, height, depth: 1 })
            .mip_levels(1)
            .array_layers(1)
            .samples(vk::SampleCountFlags::TYPE_1)
            .tiling(vk::ImageTiling::OPTIMAL)
            .usage(vk::ImageUsageFlags::SAMPLED | vk::ImageUsageFlags::TRANSFER_DST)
            .sharing_mode(vk::SharingMode::EXCLUSIVE);
        // SAFETY: the device is alive; what is made is freed when the texture is dropped.
        let image = unsafe { device.create_image(&info, None) }
            .map_err(gpu.failed(format!("make a picture of {width}x{height}")))?;
        let mut new = Self {
            gpu: gpu.clone(),
            image,
            allocation: None,
            view: vk::ImageView::null(),
            size,
            is_smooth,
            is_filled: false,
        };
        gpu.name(image, "picture");
        // SAFETY: the image is alive.
        let requirements = unsafe { device.get_image_memory_requirements(image) };
        let needs = requirements.size;
        let allocation = gpu
            .with_allocator(|allocator| {
                allocator.allocate(&AllocationCreateDesc {
                    name: "picture",
                    requirements,
                    location: MemoryLocation::GpuOnly,
                    linear: false,
                    allocation_scheme: AllocationScheme::GpuAllocatorManaged,
                })
            })
            .ok_or_else(|| Error::Device(String::from("the device is being closed")))?
            .map_err(|error| Error::OutOfMemory {
                what: format!("a picture of {width}x{height}"),
                needs,
                in_use: gpu.bytes_in_use(),
                limit: format!(" ({error})"),
            })?;
        // SAFETY: the memory was allocated for what the image requires and is bound once.
        let bound = unsafe { device.bind_image_memory(image, allocation.memory(), allocation.offset()) };
        new.allocation = Some(allocation);
        bound.map_err(gpu.failed("bind memory to a picture"))?;
        new.view = view_of(gpu, image, FORMAT)?;
        Ok(new)
    }

    /// Changes all of it or a part, which must lie inside it.
    pub fn change(&mut self, change: &TextureChange) -> Result<()> {
        let ([x, y], [width, height]) = (change.at.unwrap_or_default(), change.size);
        let is_inside = x + width <= self.size[0] && y + height <= self.size[1];
        if !is_inside || change.pixels.len() != width as usize * height as usize {
            return Err(Error::Device(format!(
                "{} pixels for {width}x{height} at {x}, {y} of a picture of {}x{}",
                change.pixels.len(),
                self.size[0],
                self.size[1]
            )));
        }
        if change.pixels.is_empty() {
            return Ok(());
        }
        let bytes: &[u8] = bytemuck::cast_slice(change.pixels);
        let usage = vk::BufferUsageFlags::empty();
        let mut staging = Buffer::with_usage(
            &self.gpu,
            "staging for a picture",
            bytes.len() as u64,
            usage,
            MemoryLocation::CpuToGpu,
        )?;
        staging.mapped()?[..bytes.len()].copy_from_slice(bytes);
        let region = [vk::BufferImageCopy::default()
            .image_subresource(vk::ImageSubresourceLayers {
                aspect_mask: vk::ImageAspectFlags::COLOR,
                mip_level: 0,
                base_array_layer: 0,
                layer_count: 1,
            })
            .image_offset(vk::Offset3D { x: x as i32, y: y as i32, z: 0 })
            .image_extent(vk::Extent3D { width, height, depth: 1 })];
        let image = self.image;
        let (filled, read) = (vk::ImageLayout::TRANSFER_DST_OPTIMAL, vk::ImageLayout::SHADER_READ_ONLY_OPTIMAL);
        // What it holds beside the part stays.
        let before = if self.is_filled { read } else { vk::ImageLayout::UNDEFINED };
        self.gpu.run_raw("the upload of a picture", &format!("{width}x{height}"), |recording| {
            change_layout(recording.device, recording.raw, image, [before, filled]);
            // SAFETY: buffer and image live until the submission is done, which the call waits for; the region lies inside both.
            unsafe { recording.device.cmd_copy_buffer_to_image(recording.raw, staging.raw, image, filled, &region) };
            change_layout(recording.device, recording.raw, image, [filled, read]);
        })?;
        self.is_filled = true;
        Ok(())
    }
}

impl Drop for Texture {
    fn drop(&mut self) {
        // SAFETY: nothing on the queue uses it, because every submission is waited for; null handles are allowed.
        unsafe {
            self.gpu.shared.raw.destroy_image_view(self.view, None);
            self.gpu.shared.raw.destroy_image(self.image, None);
        }
        if let Some(allocation) = self.allocation.take() {
            // A failure here means that the allocator's own books are wrong; there is nobody to tell.
            let _ = self.gpu.with_allocator(|allocator| allocator.free(allocation));
        }
    }
}
