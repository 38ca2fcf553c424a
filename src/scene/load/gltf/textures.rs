//! Textures: images, how they are sampled, and what a material takes of them.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use gltf::json::extensions::texture::TextureTransform;
use gltf::json::material::NormalTexture;
use gltf::json::texture::{Info, MagFilter, WrappingMode};
use gltf::json::validation::Checked;
use serde::Deserialize;

use super::buffers::Buffers;
use super::document::Document;
use super::uri::{Encoded, Resource, resolve};
use crate::error::Result;
use crate::files::{FILE_BYTES, read_bytes};
use crate::image::{Encoding, decode_texture};
use crate::scene::SceneBuilder;
use crate::scene::texture::{Pattern, TextureDescription, Wrap};

/// What a material says of one of its textures.
#[derive(Clone, Debug)]
pub(super) struct Reference {
    texture: usize,
    /// The set of texture coordinates.
    pub set: u32,
    transform: TextureTransform,
}

impl Reference {
    /// That of any texture but the normal map.
    pub fn new(info: &Info) -> Self {
        let transform = info.extensions.as_ref().and_then(|extensions| extensions.texture_transform.clone());
        Self::of(info.index.value(), info.tex_coord, transform)
    }

    /// That of a normal map, whose extensions the JSON types do not know.
    pub fn normal(document: &Document, info: &NormalTexture, element: &str) -> Result<Self> {
        let transform = match &info.extensions {
            Some(extensions) => document.extension(&extensions.others, "KHR_texture_transform", element)?,
            None => None,
        };
        Ok(Self::of(info.index.value(), info.tex_coord, transform))
    }

    fn of(texture: usize, set: u32, transform: Option<TextureTransform>) -> Self {
        let transform = transform.unwrap_or_default();
        Self { texture, set: transform.tex_coord.unwrap_or(set), transform }
    }

    /// Rows of the map from the surface's texture coordinates to the texture's: scaled, then rotated, then moved. v runs
    /// down, so the rotation that the extension calls counter-clockwise takes u to -v.
    fn map(&self) -> [[f32; 3]; 2] {
        let ([x, y], [sx, sy]) = (self.transform.offset.0, self.transform.scale.0);
        let (sin, cos) = self.transform.rotation.0.sin_cos();
        [[cos * sx, sin * sy, x], [-sin * sx, cos * sy, y]]
    }
}

/// How a texture is looked up.
#[derive(Clone, Copy, Debug)]
pub(super) struct LookUp {
    pub encoding: Encoding,
    /// What a scalar takes of it.
    pub channel: u32,
    /// By the second set of its surface's texture coordinates.
    pub by_second_uvs: bool,
}

/// Where an image's bytes are.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
enum Bytes {
    File(PathBuf),
    View(usize),
    /// In the URI of this image.
    Inside(usize),
}

/// EXT_texture_webp: an image that stands in for the texture's own.
#[derive(Deserialize)]
struct Webp {
    source: usize,
}

/// The textures of a file, each image decoded once per encoding.
pub(super) struct Textures<'a> {
    document: &'a Document,
    buffers: &'a Buffers,
    images: HashMap<(Bytes, Encoding), Image>,
}

#[derive(Clone, Copy)]
struct Image {
    index: usize,
    /// Some texel lets something pass.
    has_alpha: bool,
}

impl<'a> Textures<'a> {
    pub fn new(document: &'a Document, buffers: &'a Buffers) -> Self {
        Self { document, buffers, images: HashMap::new() }
    }

    /// Adds a texture to the builder; nothing where the file gives it no image, which `warnings` then says.
    pub fn add(
        &mut self,
        builder: &mut SceneBuilder,
        reference: &Reference,
        element: &str,
        LookUp { encoding, channel, by_second_uvs }: LookUp,
    ) -> Result<Option<u32>> {
        let document = self.document;
        let index = reference.texture;
        let texture = document.get(&document.textures, "textures", index, element)?;
        let name = format!("textures[{index}]");
        let webp: Option<Webp> = match &texture.extensions {
            Some(extensions) => document.extension(&extensions.others, "EXT_texture_webp", &name)?,
            None => None,
        };
        let source = webp.map_or(texture.source.value(), |webp| webp.source);
        if source == u32::MAX as usize {
            builder.warnings.push(format!("{name} has no image that is read"));
            return Ok(None);
        }
        let image = self.image(builder, source, &name, encoding)?;
        if channel == ALPHA && !image.has_alpha && encoding == Encoding::Srgb {
            return Ok(None); // opaque everywhere: what meets it needs no look at it
        }
        let map = reference.map();
        if map.iter().flatten().any(|value| !value.is_finite()) {
            return Err(document.wrong(element, "its KHR_texture_transform is not finite"));
        }
        let mut description = TextureDescription {
            channel,
            map,
            second_uvs: by_second_uvs,
            ..TextureDescription::new(Pattern::Image(image.index))
        };
        if let Some(sampler) = texture.sampler {
            let sampler = document.get(&document.samplers, "samplers", sampler.value(), &name)?;
            let wrap = |mode: &Checked<WrappingMode>| match mode {
                Checked::Valid(WrappingMode::ClampToEdge) => Ok(Wrap::Clamp),
                Checked::Valid(WrappingMode::MirroredRepeat) => Ok(Wrap::Mirror),
                Checked::Valid(WrappingMode::Repeat) => Ok(Wrap::Repeat),
                Checked::Invalid => Err(document.wrong(&name, "its sampler's wrapS or wrapT is unknown")),
            };
            description.wrap = [wrap(&sampler.wrap_s)?, wrap(&sampler.wrap_t)?];
            description.nearest = matches!(sampler.mag_filter, Some(Checked::Valid(MagFilter::Nearest)));
        }
        Ok(Some(builder.texture(description)))
    }

    fn image(&mut self, builder: &mut SceneBuilder, index: usize, element: &str, encoding: Encoding) -> Result<Image> {
        let document = self.document;
        let image = document.get(&document.images, "images", index, element)?;
        let name = format!("images[{index}]");
        let folder = document.path.parent().unwrap_or(Path::new(""));
        let mut inside_uri = None;
        let place = match (&image.uri, image.buffer_view) {
            (Some(uri), None) => match resolve(folder, uri).map_err(|message| document.wrong(&name, message))? {
                Resource::File(path) => Bytes::File(path),
                Resource::Data(encoded) => {
                    inside_uri = Some(encoded);
                    Bytes::Inside(index)
                }
            },
            (None, Some(view)) => Bytes::View(view.value()),
            _ => return Err(document.wrong(&name, "has neither or both of uri and bufferView, and must have one")),
        };
        if let Some(known) = self.images.get(&(place.clone(), encoding)) {
            return Ok(*known);
        }
        let inside = PathBuf::from(format!("{}: {name}", document.path.display()));
        let texels = match &place {
            Bytes::File(path) => decode_texture(&read_bytes(path, FILE_BYTES)?, path, encoding)?,
            Bytes::View(view) => decode_texture(self.buffers.view(document, *view, &name)?.bytes, &inside, encoding)?,
            Bytes::Inside(_) => {
                let bytes = inside_uri.map_or(Ok(Vec::new()), Encoded::decode);
                decode_texture(&bytes.map_err(|message| document.wrong(&name, message))?, &inside, encoding)?
            }
        };
        let has_alpha = texels.texels.has_alpha();
        let image = Image { index: builder.image(texels), has_alpha };
        builder.within_limits()?;
        self.images.insert((place, encoding), image);
        Ok(image)
    }
}

/// Channels of scalars.
pub(super) const RED: u32 = 0;
pub(super) const GREEN: u32 = 1;
pub(super) const BLUE: u32 = 2;
pub(super) const ALPHA: u32 = 3;
/// For colours, of which no one channel is meant.
pub(super) const COLOUR: u32 = 4;
