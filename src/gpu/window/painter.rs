//! Drawing triangles that are covered with textures: the pipeline, the textures, and the buffers that triangles go through.

use std::collections::HashMap;

use ash::vk;
use gpu_allocator::MemoryLocation;

use super::texture::{Texture, TextureChange, change_layout};
use crate::error::Result;
use crate::gpu::queue::Recording;
use crate::gpu::{Buffer, Gpu};

/// A corner of a triangle.
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct PaintVertex {
    /// Its place in pixels of the window, from the upper left.
    pub position: [f32; 2],
    /// Its place in the texture, 0 to 1.
    pub uv: [f32; 2],
    /// What the texture is multiplied by: sRGB with premultiplied alpha.
    pub colour: [u8; 4],
}

/// Triangles with one texture, within a part of the window.
#[derive(Clone, Debug)]
pub struct Mesh {
    /// Left, top, width and height in pixels of that part.
    pub clip: [u32; 4],
    /// The number of the texture.
    pub texture: u64,
    /// Corners of the triangles.
    pub vertices: Vec<PaintVertex>,
    /// Three corners for each triangle.
    pub indices: Vec<u32>,
}

/// The most textures at one time: the letters, the picture, and what is about to go.
const MOST_TEXTURES: u32 = 64;

static VERTEX_SHADER: &[u8] = include_bytes!(concat!(env!("OUT_DIR"), "/interface.vert.spv"));
static FRAGMENT_SHADER: &[u8] = include_bytes!(concat!(env!("OUT_DIR"), "/interface.frag.spv"));

/// What draws a window.
pub(super) struct Painter {
    gpu: Gpu,
    set_layout: vk::DescriptorSetLayout,
    layout: vk::PipelineLayout,
    pipeline: vk::Pipeline,
    /// Not smooth, smooth.
    samplers: [vk::Sampler; 2],
    pool: vk::DescriptorPool,
    textures: HashMap<u64, (Texture, vk::DescriptorSet)>,
    vertices: Option<Buffer>,
    indices: Option<Buffer>,
}

impl Painter {
    /// For images of this format.
    pub fn new(gpu: &Gpu, format: vk::Format) -> Result<Self> {
        let mut new = Self {
            gpu: gpu.clone(),
            set_layout: vk::DescriptorSetLayout::null(),
            layout: vk::PipelineLayout::null(),
            pipeline: vk::Pipeline::null(),
            samplers: [vk::Sampler::null(); 2],
            pool: vk::DescriptorPool::null(),
            textures: HashMap::new(),
            vertices: None,
            indices: None,
        };
        new.make_bindings()?;
        new.pipeline = new.make_pipeline(format)?;
        gpu.name(new.pipeline, "interface");
        Ok(new)
    }

    fn make_bindings(&mut self) -> Result<()> {
        let (gpu, device) = (&self.gpu, &self.gpu.shared.raw);
        let bindings = [vk::DescriptorSetLayoutBinding::default()
            .descriptor_type(vk::DescriptorType::COMBINED_IMAGE_SAMPLER)
            .descriptor_count(1)
            .stage_flags(vk::ShaderStageFlags::FRAGMENT)];
        let info = vk::DescriptorSetLayoutCreateInfo::default().bindings(&bindings);
        let sizes = [vk::DescriptorPoolSize::default()
            .ty(vk::DescriptorType::COMBINED_IMAGE_SAMPLER)
            .descriptor_count(MOST_TEXTURES)];
        let pool = vk::DescriptorPoolCreateInfo::default()
            .flags(vk::DescriptorPoolCreateFlags::FREE_DESCRIPTOR_SET)
            .max_sets(MOST_TEXTURES)
            .pool_sizes(&sizes);
        let failed = || gpu.failed("prepare drawing in the window");
        // SAFETY: the device is alive; what is made is freed when the painter is dropped.
        unsafe {
            self.set_layout = device.create_descriptor_set_layout(&info, None).map_err(failed())?;
            self.pool = device.create_descriptor_pool(&pool, None).map_err(failed())?;
            for (sampler, filter) in self.samplers.iter_mut().zip([vk::Filter::NEAREST, vk::Filter::LINEAR]) {
                let info = vk::SamplerCreateInfo::default()
                    .mag_filter(filter)
                    .min_filter(vk::Filter::LINEAR)
                    .address_mode_u(vk::SamplerAddressMode::CLAMP_TO_EDGE)
                    .address_mode_v(vk::SamplerAddressMode::CLAMP_TO_EDGE)
                    .address_mode_w(vk::SamplerAddressMode::CLAMP_TO_EDGE);
                *sampler = device.create_sampler(&info, None).map_err(failed())?;
            }
            let layouts = [self.set_layout];
            let ranges = [vk::PushConstantRange::default().stage_flags(vk::ShaderStageFlags::VERTEX).size(8)];
            let info = vk::PipelineLayoutCreateInfo::default().set_layouts(&layouts).push_constant_ranges(&ranges);
            self.layout = device.create_pipeline_layout(&info, None).map_err(failed())?;
        }
        Ok(())
    }

    fn make_pipeline(&self, format: vk::Format) -> Result<vk::Pipeline> {
        let (gpu, device) = (&self.gpu, &self.gpu.shared.raw);
        let words = |bytes: &[u8]| -> Vec<u32> { bytemuck::pod_collect_to_vec(bytes) };
        let module = |bytes: &[u8]| {
            let words = words(bytes);
            // SAFETY: the device is alive, and the module was made by the compiler with this program.
            unsafe { device.create_shader_module(&vk::ShaderModuleCreateInfo::default().code(&words), None) }
        };
        let failed = || gpu.failed("make the pipeline that draws the window");
        let vertex = module(VERTEX_SHADER).map_err(failed())?;
        let fragment = module(FRAGMENT_SHADER);
        let stage =
            |stage, module| vk::PipelineShaderStageCreateInfo::default().stage(stage).module(module).name(c"main");
        let stages = [
            stage(vk::ShaderStageFlags::VERTEX, vertex),
            stage(vk::ShaderStageFlags::FRAGMENT, fragment.unwrap_or_default()),
        ];
        let corners = [vk::VertexInputBindingDescription::default().stride(size_of::<PaintVertex>() as u32)];
        let attribute = |location, format, offset: usize| {
            vk::VertexInputAttributeDescription::default().location(location).format(format).offset(offset as u32)
        };
        let attributes = [
            attribute(0, vk::Format::R32G32_SFLOAT, std::mem::offset_of!(PaintVertex, position)),
            attribute(1, vk::Format::R32G32_SFLOAT, std::mem::offset_of!(PaintVertex, uv)),
            attribute(2, vk::Format::R8G8B8A8_UNORM, std::mem::offset_of!(PaintVertex, colour)),
        ];
        let input = vk::PipelineVertexInputStateCreateInfo::default()
            .vertex_binding_descriptions(&corners)
            .vertex_attribute_descriptions(&attributes);
        let assembly =
            vk::PipelineInputAssemblyStateCreateInfo::default().topology(vk::PrimitiveTopology::TRIANGLE_LIST);
        let viewport = vk::PipelineViewportStateCreateInfo::default().viewport_count(1).scissor_count(1);
        let raster = vk::PipelineRasterizationStateCreateInfo::default()
            .polygon_mode(vk::PolygonMode::FILL)
            .cull_mode(vk::CullModeFlags::NONE)
            .line_width(1.0);
        let samples =
            vk::PipelineMultisampleStateCreateInfo::default().rasterization_samples(vk::SampleCountFlags::TYPE_1);
        // Colours are multiplied by their alpha already.
        let blends = [vk::PipelineColorBlendAttachmentState::default()
            .blend_enable(true)
            .src_color_blend_factor(vk::BlendFactor::ONE)
            .dst_color_blend_factor(vk::BlendFactor::ONE_MINUS_SRC_ALPHA)
            .color_blend_op(vk::BlendOp::ADD)
            .src_alpha_blend_factor(vk::BlendFactor::ONE)
            .dst_alpha_blend_factor(vk::BlendFactor::ONE_MINUS_SRC_ALPHA)
            .alpha_blend_op(vk::BlendOp::ADD)
            .color_write_mask(vk::ColorComponentFlags::RGBA)];
        let blend = vk::PipelineColorBlendStateCreateInfo::default().attachments(&blends);
        let changing = [vk::DynamicState::VIEWPORT, vk::DynamicState::SCISSOR];
        let dynamic = vk::PipelineDynamicStateCreateInfo::default().dynamic_states(&changing);
        let formats = [format];
        let mut rendering = vk::PipelineRenderingCreateInfo::default().color_attachment_formats(&formats);
        let info = [vk::GraphicsPipelineCreateInfo::default()
            .stages(&stages)
            .vertex_input_state(&input)
            .input_assembly_state(&assembly)
            .viewport_state(&viewport)
            .rasterization_state(&raster)
            .multisample_state(&samples)
            .color_blend_state(&blend)
            .dynamic_state(&dynamic)
            .layout(self.layout)
            .push_next(&mut rendering)];
        let made = match fragment {
            // SAFETY: all that `info` points to lives through the call.
            Ok(_) => unsafe { device.create_graphics_pipelines(vk::PipelineCache::null(), &info, None) }
                .map_err(|(_, code)| code),
            Err(code) => Err(code),
        };
        // SAFETY: the pipeline is made of them, or could not be; null handles are allowed.
        unsafe {
            device.destroy_shader_module(vertex, None);
            device.destroy_shader_module(fragment.unwrap_or_default(), None);
        }
        Ok(made.map_err(failed())?[0])
    }

    /// Changes a texture, or makes it.
    pub fn change_texture(&mut self, id: u64, change: &TextureChange) -> Result<()> {
        let fits = |texture: &Texture| texture.size == change.size && texture.is_smooth == change.is_smooth;
        if let Some((texture, _)) = self.textures.get_mut(&id).filter(|(own, _)| change.at.is_some() || fits(own)) {
            return texture.change(change);
        }
        self.free_texture(id)?;
        let (gpu, device) = (&self.gpu, &self.gpu.shared.raw);
        let mut texture = Texture::new(gpu, change.size, change.is_smooth)?;
        texture.change(&TextureChange { at: None, ..*change })?;
        let layouts = [self.set_layout];
        let info = vk::DescriptorSetAllocateInfo::default().descriptor_pool(self.pool).set_layouts(&layouts);
        // SAFETY: pool and layout are alive; that the pool is full is an error.
        let sets = unsafe { device.allocate_descriptor_sets(&info) }
            .map_err(gpu.failed("allocate the descriptor set of a picture"))?;
        let images = [vk::DescriptorImageInfo::default()
            .sampler(self.samplers[usize::from(change.is_smooth)])
            .image_view(texture.view)
            .image_layout(vk::ImageLayout::SHADER_READ_ONLY_OPTIMAL)];
        let write = [vk::WriteDescriptorSet::default()
            .dst_set(sets[0])
            .descriptor_type(vk::DescriptorType::COMBINED_IMAGE_SAMPLER)
            .image_info(&images)];
        // SAFETY: the set is not in use yet, and goes before the texture.
        unsafe { device.update_descriptor_sets(&write, &[]) };
        self.textures.insert(id, (texture, sets[0]));
        Ok(())
    }

    /// Frees a texture, if there is one of that number.
    pub fn free_texture(&mut self, id: u64) -> Result<()> {
        let Some((_, set)) = self.textures.remove(&id) else { return Ok(()) };
        // SAFETY: nothing on the queue uses it, because every submission is waited for.
        unsafe { self.gpu.shared.raw.free_descriptor_sets(self.pool, &[set]) }
            .map_err(self.gpu.failed("free the descriptor set of a picture"))
    }

    /// Draws meshes in an image of this size, which is for presenting then.
    pub fn draw(&mut self, image: vk::Image, view: vk::ImageView, size: [u32; 2], meshes: &[Mesh]) -> Result<()> {
        let vertices: Vec<u8> =
            meshes.iter().flat_map(|mesh| bytemuck::cast_slice::<_, u8>(&mesh.vertices)).copied().collect();
        let indices: Vec<u8> =
            meshes.iter().flat_map(|mesh| bytemuck::cast_slice::<_, u8>(&mesh.indices)).copied().collect();
        fill(&self.gpu, &mut self.vertices, "corners of triangles", vk::BufferUsageFlags::VERTEX_BUFFER, &vertices)?;
        fill(&self.gpu, &mut self.indices, "triangles", vk::BufferUsageFlags::INDEX_BUFFER, &indices)?;
        let this = &*self;
        let [undefined, drawn, shown] =
            [vk::ImageLayout::UNDEFINED, vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL, vk::ImageLayout::PRESENT_SRC_KHR];
        self.gpu.run_raw("the window", &format!("{}x{}", size[0], size[1]), |recording| {
            change_layout(recording.device, recording.raw, image, [undefined, drawn]);
            this.record(recording, view, size, meshes);
            change_layout(recording.device, recording.raw, image, [drawn, shown]);
        })?;
        Ok(())
    }

    fn record(&self, recording: &Recording, view: vk::ImageView, [width, height]: [u32; 2], meshes: &[Mesh]) {
        let (device, commands) = (recording.device, recording.raw);
        let attachments = [vk::RenderingAttachmentInfo::default()
            .image_view(view)
            .image_layout(vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL)
            .load_op(vk::AttachmentLoadOp::CLEAR)
            .store_op(vk::AttachmentStoreOp::STORE)];
        let area = vk::Rect2D { offset: vk::Offset2D::default(), extent: vk::Extent2D { width, height } };
        let info = vk::RenderingInfo::default().render_area(area).layer_count(1).color_attachments(&attachments);
        let viewport =
            [vk::Viewport { width: width as f32, height: height as f32, max_depth: 1.0, ..Default::default() }];
        let points = [width as f32, height as f32];
        // SAFETY: the commands are being recorded; image, buffers, pipeline and sets live until the submission is done. Indices are those of the
        // mesh's own vertices, which follow each other in the buffer; clips lie inside the image.
        unsafe {
            device.cmd_begin_rendering(commands, &info);
            if let (Some(vertices), Some(indices)) = (&self.vertices, &self.indices) {
                device.cmd_bind_pipeline(commands, vk::PipelineBindPoint::GRAPHICS, self.pipeline);
                device.cmd_set_viewport(commands, 0, &viewport);
                device.cmd_bind_vertex_buffers(commands, 0, &[vertices.raw], &[0]);
                device.cmd_bind_index_buffer(commands, indices.raw, 0, vk::IndexType::UINT32);
                let stages = vk::ShaderStageFlags::VERTEX;
                device.cmd_push_constants(commands, self.layout, stages, 0, bytemuck::cast_slice(&points));
                let (mut first_vertex, mut first_index) = (0, 0);
                for mesh in meshes {
                    let count = mesh.indices.len() as u32;
                    let [x, y, w, h] = mesh.clip;
                    let (x, y) = (x.min(width), y.min(height));
                    let extent = vk::Extent2D { width: w.min(width - x), height: h.min(height - y) };
                    if let Some((_, set)) = self.textures.get(&mesh.texture) {
                        let clip = [vk::Rect2D { offset: vk::Offset2D { x: x as i32, y: y as i32 }, extent }];
                        device.cmd_set_scissor(commands, 0, &clip);
                        let graphics = vk::PipelineBindPoint::GRAPHICS;
                        device.cmd_bind_descriptor_sets(commands, graphics, self.layout, 0, &[*set], &[]);
                        device.cmd_draw_indexed(commands, count, 1, first_index, first_vertex, 0);
                    }
                    first_vertex += mesh.vertices.len() as i32;
                    first_index += count;
                }
            }
            device.cmd_end_rendering(commands);
        }
    }
}

/// Writes to a buffer that the host sees, in the place of which comes a larger one where there is no room.
fn fill(gpu: &Gpu, buffer: &mut Option<Buffer>, name: &str, usage: vk::BufferUsageFlags, bytes: &[u8]) -> Result<()> {
    if bytes.is_empty() {
        return Ok(());
    }
    if buffer.as_ref().is_none_or(|buffer| buffer.size() < bytes.len() as u64) {
        let size = (bytes.len() as u64).next_power_of_two();
        *buffer = None;
        *buffer = Some(Buffer::with_usage(gpu, name, size, usage, MemoryLocation::CpuToGpu)?);
    }
    if let Some(buffer) = buffer {
        buffer.mapped()?[..bytes.len()].copy_from_slice(bytes);
    }
    Ok(())
}

impl Drop for Painter {
    fn drop(&mut self) {
        let device = &self.gpu.shared.raw;
        // SAFETY: nothing on the queue uses them, because every submission is waited for; null handles are allowed, and the sets go with their pool.
        unsafe {
            device.destroy_pipeline(self.pipeline, None);
            device.destroy_pipeline_layout(self.layout, None);
            self.samplers.iter().for_each(|sampler| device.destroy_sampler(*sampler, None));
            device.destroy_descriptor_pool(self.pool, None);
            device.destroy_descriptor_set_layout(self.set_layout, None);
        }
    }
}
