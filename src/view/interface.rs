//! egui on a [`Presenter`]: its input, its textures, its triangles.

use egui::epaint::{ImageData, Primitive};
use egui::{ClippedPrimitive, Context, FullOutput, TextureId, TextureOptions, TexturesDelta};

use crate::error::Result;
use crate::gpu::window::{Mesh, PaintVertex, Presenter, TextureChange};

/// The number of the texture that is the picture.
pub(super) const PICTURE: TextureId = TextureId::User(0);

/// The number that a texture has for the device.
fn number(id: TextureId) -> u64 {
    match id {
        TextureId::Managed(number) => number << 1,
        TextureId::User(number) => number << 1 | 1,
    }
}

/// Puts the picture on the device.
pub(super) fn set_picture(
    presenter: &mut Presenter,
    size: [u32; 2],
    pixels: &[[u8; 4]],
    is_smooth: bool,
) -> Result<()> {
    presenter.change_texture(number(PICTURE), &TextureChange { at: None, size, pixels, is_smooth })
}

/// Brings the textures of egui up to date before a frame is drawn.
pub(super) fn set_textures(presenter: &mut Presenter, textures: &TexturesDelta) -> Result<()> {
    for (id, delta) in &textures.set {
        let ImageData::Color(image) = &delta.image;
        let whole = |value: usize| u32::try_from(value).unwrap_or(u32::MAX);
        let change = TextureChange {
            at: delta.pos.map(|at| at.map(whole)),
            size: image.size.map(whole),
            pixels: bytemuck::cast_slice(&image.pixels),
            is_smooth: delta.options.magnification == TextureOptions::LINEAR.magnification,
        };
        presenter.change_texture(number(*id), &change)?;
    }
    Ok(())
}

/// Frees the textures that egui is done with, after the frame.
pub(super) fn free_textures(presenter: &mut Presenter, textures: &TexturesDelta) -> Result<()> {
    textures.free.iter().try_for_each(|id| presenter.free_texture(number(*id)))
}

/// The triangles of a frame, in pixels.
pub(super) fn meshes(context: &Context, output: &FullOutput) -> Vec<Mesh> {
    let scale = output.pixels_per_point;
    let primitives = context.tessellate(output.shapes.clone(), scale);
    primitives.into_iter().filter_map(|primitive| mesh(primitive, scale)).collect()
}

fn mesh(ClippedPrimitive { clip_rect, primitive }: ClippedPrimitive, scale: f32) -> Option<Mesh> {
    let Primitive::Mesh(mesh) = primitive else { return None };
    let pixel = |point: f32| (point * scale).round().max(0.0) as u32;
    let [left, top, right, bottom] =
        [pixel(clip_rect.min.x), pixel(clip_rect.min.y), pixel(clip_rect.max.x), pixel(clip_rect.max.y)];
    let vertex = |vertex: &egui::epaint::Vertex| PaintVertex {
        position: [vertex.pos.x * scale, vertex.pos.y * scale],
        uv: [vertex.uv.x, vertex.uv.y],
        colour: vertex.color.to_array(),
    };
    (!mesh.indices.is_empty()).then(|| Mesh {
        clip: [left, top, right.saturating_sub(left), bottom.saturating_sub(top)],
        texture: number(mesh.texture_id),
        vertices: mesh.vertices.iter().map(vertex).collect(),
        indices: mesh.indices,
    })
}
