//! The description of a scene while it is collected.

use std::collections::HashMap;
use std::path::PathBuf;

use glam::{DAffine3, DMat3, DVec3};

use super::camera::Camera;
use super::filter::Filter;
use super::group::{Group, Shape};
use super::light::Lamp;
use super::limits::{ELEMENTS, IMAGE_BYTES, MATERIALS};
use super::material::{self, MaterialDescription, MaterialMaps};
use super::mesh::Mesh;
use super::request::{FilmSettings, LightSelection, TechniqueRequest};
use super::surface::SurfaceDescription;
use super::texture::{Pattern, TextureDescription};
use crate::error::{Error, Result};
use crate::image::{Texels, TextureImage};
use crate::layout::{Blend, MATERIAL_BLEND, MATERIAL_HAS_TRANSMISSION, Material, NONE};

/// What a file holds, in double precision, as loaders and tests describe it; `finish` makes a [`Scene`](crate::scene::Scene) of it.
#[derive(Clone, Debug)]
pub struct SceneBuilder {
    pub(in crate::scene) source: PathBuf,
    /// Cameras, in the order of the file.
    pub cameras: Vec<Camera>,
    /// The image that the file asks for.
    pub film: FilmSettings,
    /// The technique that the file asks for.
    pub technique: TechniqueRequest,
    /// Lights that no surface carries.
    pub lamps: Vec<Lamp>,
    /// Radiance of the background.
    pub background: Option<[f64; 3]>,
    /// A texture that multiplies it, and the image's axes in the world (its up axis is the second).
    pub environment: Option<(u32, DMat3)>,
    /// Whether a surface was described as a light, be its radiance 0. No sky stands in for lights of a scene that has some, dark as they are.
    pub has_area_light: bool,
    /// How its lights are selected.
    pub light_selection: LightSelection,
    /// Give images of materials smaller levels of detail.
    pub mip_maps: bool,
    /// What the user should know.
    pub warnings: Vec<String>,
    pub(in crate::scene) images: Vec<TextureImage>,
    pub(in crate::scene) textures: Vec<TextureDescription>,
    /// The names of the attributes of meshes that textures show.
    pub(in crate::scene) attributes: Vec<String>,
    /// Checkerboards by those whose squares have changed places.
    exchanged: HashMap<u32, u32>,
    pub(in crate::scene) materials: Vec<MaterialDescription>,
    /// Their names in the file, where they have any.
    pub(in crate::scene) names: HashMap<usize, String>,
    pub(in crate::scene) blends: Vec<Blend>,
    pub(in crate::scene) surfaces: Vec<SurfaceDescription>,
    pub(in crate::scene) groups: Vec<Group>,
    pub(in crate::scene) instances: Vec<(usize, DAffine3)>,
    /// Vertices and triangles so far.
    elements: u64,
    /// Bytes of images so far.
    image_bytes: u64,
    /// What there is too much of.
    excess: Option<String>,
}

/// The group that everything belongs to that is placed once.
pub(crate) const WORLD: usize = 0;

impl SceneBuilder {
    /// An empty scene; `source` names it in messages.
    pub fn new(source: impl Into<PathBuf>) -> Self {
        Self {
            source: source.into(),
            cameras: Vec::new(),
            film: FilmSettings { width: 512, height: 512, filter: Filter::Box },
            technique: TechniqueRequest::default(),
            lamps: Vec::new(),
            background: None,
            environment: None,
            has_area_light: false,
            light_selection: LightSelection::default(),
            mip_maps: false,
            warnings: Vec::new(),
            images: Vec::new(),
            textures: Vec::new(),
            attributes: Vec::new(),
            exchanged: HashMap::new(),
            materials: Vec::new(),
            names: HashMap::new(),
            blends: Vec::new(),
            surfaces: Vec::new(),
            groups: vec![Group { name: String::from("world"), shapes: Vec::new() }],
            instances: Vec::new(),
            elements: 0,
            image_bytes: 0,
            excess: None,
        }
    }

    /// Fails where more was added than a scene may hold; what is beyond was not kept. [`Self::finish`] asks by itself.
    pub(in crate::scene) fn within_limits(&self) -> Result<()> {
        self.excess.as_ref().map_or(Ok(()), |message| Err(Error::scene(&self.source, message)))
    }

    /// Adds an image for textures to show.
    pub fn image(&mut self, mut image: TextureImage) -> usize {
        self.image_bytes += image.bytes().len() as u64;
        if self.image_bytes > IMAGE_BYTES {
            let source = image.source.display();
            self.excess.get_or_insert(format!(
                "the images of the scene take {} bytes with {source}, and {IMAGE_BYTES} is the most that is read",
                self.image_bytes
            ));
            (image.width, image.height, image.texels) = (1, 1, Texels::Srgb8(vec![[0; 4]]));
        }
        self.images.push(image);
        self.images.len() - 1
    }

    /// The index of an attribute of meshes, for a texture to show.
    pub fn attribute(&mut self, name: &str) -> usize {
        self.attributes.iter().position(|known| known == name).unwrap_or_else(|| {
            self.attributes.push(name.to_owned());
            self.attributes.len() - 1
        })
    }

    /// Adds a texture.
    pub fn texture(&mut self, texture: TextureDescription) -> u32 {
        self.textures.push(texture);
        self.textures.len() as u32 - 1
    }

    /// This texture where it is no checkerboard; else one whose squares, and those of all checkerboards within, have changed places.
    pub(in crate::scene) fn with_squares_exchanged(&mut self, texture: u32) -> u32 {
        let mut copy = self.textures[texture as usize];
        let Pattern::Checkerboard(a, b) = copy.pattern else { return texture };
        if let Some(made) = self.exchanged.get(&texture) {
            return *made;
        }
        let [first, second] = copy.squares.map(|square| square.map(|inner| self.with_squares_exchanged(inner)));
        (copy.pattern, copy.squares) = (Pattern::Checkerboard(b, a), [second, first]);
        let made = self.texture(copy);
        self.exchanged.insert(texture, made);
        made
    }

    /// The texture of 1 less so much of another one; none of a checkerboard of textures.
    pub(in crate::scene) fn rest_of_texture(&mut self, texture: u32, share: f32) -> Option<u32> {
        let mut rest = self.textures[texture as usize];
        match &mut rest.pattern {
            Pattern::Checkerboard(a, b) if rest.squares == [None; 2] => {
                [a, b].into_iter().for_each(|colour| *colour = colour.map(|channel| 1.0 - share * channel));
            }
            Pattern::Checkerboard(..) => return None,
            Pattern::Image(_) | Pattern::Attribute(_) => {
                rest.scale = rest.scale.map(|factor| -share * factor);
                rest.offset = rest.offset.map(|added| 1.0 - share * added);
            }
        }
        Some(self.texture(rest))
    }

    /// Adds a material.
    pub fn material(&mut self, material: impl Into<MaterialDescription>) -> usize {
        self.materials.push(material.into());
        self.materials.len() - 1
    }

    /// Says what a material is called, unless that is known.
    pub fn name_material(&mut self, material: usize, name: &str) {
        self.names.entry(material).or_insert_with(|| name.to_owned());
    }

    /// A material that was added.
    pub fn material_mut(&mut self, material: usize) -> &mut MaterialDescription {
        &mut self.materials[material]
    }

    /// Texels of a texture's image across and down; 1 x 1 of a pattern.
    pub(in crate::scene) fn texture_size(&self, texture: u32) -> [u32; 2] {
        match self.textures[texture as usize].pattern {
            Pattern::Checkerboard(..) | Pattern::Attribute(_) => [1; 2],
            Pattern::Image(image) => self.image_size(image),
        }
    }

    /// Texels of an image across and down.
    pub(in crate::scene) fn image_size(&self, image: usize) -> [u32; 2] {
        [self.images[image].width, self.images[image].height]
    }

    /// A copy of a material, and of those that it blends, whose textures are changed.
    pub(in crate::scene) fn changed_material(
        &mut self,
        material: usize,
        change: impl Fn(&mut MaterialMaps) + Copy,
    ) -> usize {
        self.changed(material, change, &mut HashMap::new())
    }

    /// `copies` holds what was copied: blends may share what they blend, and then have far more ways down than materials.
    fn changed(
        &mut self,
        material: usize,
        change: impl Fn(&mut MaterialMaps) + Copy,
        copies: &mut HashMap<usize, usize>,
    ) -> usize {
        if let Some(copy) = copies.get(&material) {
            return *copy;
        }
        if self.materials.len() >= MATERIALS {
            self.excess.get_or_insert(format!("the scene has more than {MATERIALS} materials, copies counted"));
            return material;
        }
        let mut copy = self.materials[material].clone();
        if copy.record.kind == MATERIAL_BLEND {
            let mut blend = self.blends[copy.record.detail as usize];
            blend.first = self.changed(blend.first as usize, change, copies) as u32;
            blend.second = self.changed(blend.second as usize, change, copies) as u32;
            self.blends.push(blend);
            copy.record.detail = self.blends.len() as u32 - 1;
        } else {
            change(&mut copy.textures);
        }
        let made = self.material(copy);
        copies.insert(material, made);
        made
    }

    /// Adds a material that is the second of two with this probability, which a texture may multiply, else the first.
    pub fn blend(&mut self, first: usize, second: usize, weight: f64, texture: Option<u32>) -> usize {
        self.blends.push(Blend {
            first: first as u32,
            second: second as u32,
            weight: weight as f32,
            weight_texture: texture.unwrap_or(NONE),
        });
        let either = self.materials[first].record.flags | self.materials[second].record.flags;
        let record = Material {
            kind: MATERIAL_BLEND,
            flags: either & MATERIAL_HAS_TRANSMISSION,
            detail: self.blends.len() as u32 - 1,
            textures: NONE,
            ..Material::default()
        };
        self.material(record)
    }

    /// Adds a surface.
    pub fn surface(&mut self, surface: SurfaceDescription) -> usize {
        self.surfaces.push(surface);
        self.surfaces.len() - 1
    }

    /// A surface that was added.
    pub fn surface_mut(&mut self, surface: usize) -> &mut SurfaceDescription {
        &mut self.surfaces[surface]
    }

    /// Adds a diffuse surface that is the same from both sides: short for [`Self::material`] and [`Self::surface`].
    pub fn matte(&mut self, reflectance: [f32; 3]) -> usize {
        let material = self.material(material::diffuse(reflectance));
        self.both_sides(material)
    }

    /// Adds a surface of one material that is the same from both sides.
    pub fn both_sides(&mut self, material: usize) -> usize {
        self.surface(SurfaceDescription {
            front: Some(material),
            back: Some(material),
            ..SurfaceDescription::default()
        })
    }

    /// Adds a group, to be placed by [`Self::instance`].
    pub fn group(&mut self, name: &str) -> usize {
        self.groups.push(Group { name: name.to_owned(), shapes: Vec::new() });
        self.groups.len() - 1
    }

    /// Adds triangles to a group (0 is the world itself). `name` says in messages which mesh it is.
    pub fn mesh(&mut self, group: usize, name: &str, mesh: Mesh, to_group: DAffine3, surface: usize) {
        let mesh = mesh.split();
        self.elements += (mesh.positions.len() + mesh.triangles.len()) as u64;
        if self.elements > ELEMENTS {
            self.excess.get_or_insert(format!(
                "the scene has {} vertices and triangles with '{name}', and {ELEMENTS} is the most that is read",
                self.elements
            ));
            return;
        }
        let shape = Shape::Mesh { mesh: Box::new(mesh), to_group };
        self.groups[group].shapes.push((shape, surface, name.to_owned()));
    }

    /// Adds a sphere to a group. A negative radius turns its normal inwards.
    pub fn sphere(&mut self, group: usize, name: &str, centre: DVec3, radius: f64, surface: usize) {
        self.oriented_sphere(group, name, centre, radius, DMat3::IDENTITY, surface);
    }

    /// Adds a sphere to a group, whose texture coordinates go by these orthonormal axes. A negative radius turns its normal inwards.
    pub fn oriented_sphere(
        &mut self,
        group: usize,
        name: &str,
        centre: DVec3,
        radius: f64,
        axes: DMat3,
        surface: usize,
    ) {
        self.groups[group].shapes.push((Shape::Sphere { centre, radius, axes }, surface, name.to_owned()));
    }

    /// Places a group.
    pub fn instance(&mut self, group: usize, to_world: DAffine3) {
        self.instances.push((group, to_world));
    }

    /// Adds a parallelogram whose normal is `edge1` x `edge2`.
    pub fn parallelogram(&mut self, corner: DVec3, edge1: DVec3, edge2: DVec3, surface: usize) {
        let positions = vec![corner, corner + edge1, corner + edge1 + edge2, corner + edge2];
        let mesh = Mesh { positions, triangles: vec![[0, 1, 2], [0, 2, 3]], ..Mesh::default() };
        self.mesh(WORLD, "parallelogram", mesh, DAffine3::IDENTITY, surface);
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;

    /// The limits are too large to be met in earnest: what was added before is made up.
    #[test]
    fn what_is_too_much_is_named_and_not_kept() {
        let image = || TextureImage {
            source: PathBuf::from("big.png"),
            width: 2,
            height: 1,
            texels: Texels::Linear8(vec![[0; 4]; 2]),
        };
        let refused = |builder: SceneBuilder, expected: &[&str]| {
            assert!(builder.within_limits().is_err());
            let message = builder.finish().unwrap_err().to_string();
            assert!(expected.iter().all(|part| message.contains(part)), "{message}");
        };
        let mut builder = SceneBuilder::new("scene.xml");
        let surface = builder.matte([0.5; 3]);
        builder.elements = ELEMENTS - 6;
        builder.mesh(WORLD, "fits", Mesh::rectangle(), DAffine3::IDENTITY, surface);
        assert!(builder.within_limits().is_ok() && builder.groups[WORLD].shapes.len() == 1);
        builder.mesh(WORLD, "one more", Mesh::rectangle(), DAffine3::IDENTITY, surface);
        assert_eq!(builder.groups[WORLD].shapes.len(), 1);
        refused(builder, &["scene.xml", "134217734", "'one more'", "134217728"]);

        let mut builder = SceneBuilder::new("scene.xml");
        builder.image_bytes = IMAGE_BYTES - 8;
        builder.image(image());
        assert!(builder.within_limits().is_ok());
        let index = builder.image(image());
        assert_eq!(builder.image_size(index), [1, 1]);
        refused(builder, &["scene.xml", "big.png", "4294967296"]);

        let mut builder = SceneBuilder::new("scene.xml");
        let material = builder.material(material::diffuse([0.5; 3]));
        builder.materials = vec![builder.materials[0].clone(); MATERIALS];
        builder.changed_material(material, |_| ());
        assert_eq!(builder.materials.len(), MATERIALS);
        refused(builder, &["scene.xml", "1048576 materials"]);
    }
}
