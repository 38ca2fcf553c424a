//! From what a file holds, in double precision, to the flat single-precision scene.

use std::collections::HashMap;
use std::path::PathBuf;

use glam::{DAffine3, DMat3, DVec3, Vec3};

use super::camera::Camera;
use super::flatten::{Flat, PendingGroup, Shape, union};
use super::light::{Lamp, importance};
use super::light_table::{self, Candidate, LightSelection};
use super::limits::{ELEMENTS, IMAGE_BYTES, MATERIALS};
use super::material::{self, MaterialDescription, file_materials};
use super::mesh::Mesh;
use super::placement::{choose_origin, framing_camera};
use super::texture::{Pattern, TextureDescription, srgb_table};
use super::{Environment, FilmSettings, Filter, Instance, Scene, TechniqueRequest, environment, mip_maps};
use crate::bvh::Bounds;
use crate::error::{Error, Result, plain};
use crate::image::{Texels, TextureImage};
use crate::layout::{
    Blend, LIGHT_PROJECTOR, LIGHT_SPHERE, LIGHT_SPOT, LIGHT_TRIANGLE, Light, MATERIAL_BLEND, MATERIAL_HAS_TRANSMISSION,
    Material, MaterialTextures, NONE, Surface,
};

/// What one side of a surface is made of.
pub type Side = Option<usize>;

/// What a surface stops of the light that falls on it; the rest goes straight on.
#[derive(Clone, Copy, Debug)]
pub struct Mask {
    /// The share that it stops.
    pub opacity: f64,
    /// A texture that multiplies it.
    pub texture: Option<u32>,
    /// Where above 0, opacities below it count as 0 and others as 1.
    pub cutoff: f64,
}

/// A surface: the materials of its two sides (indices from [`SceneBuilder::material`]) and what its front emits.
#[derive(Clone, Copy, Debug, Default)]
pub struct SurfaceDescription {
    /// The side that normals point to.
    pub front: Side,
    /// The other side.
    pub back: Side,
    /// Radiance of the front, W/(m² sr).
    pub emission: [f64; 3],
    /// A texture that multiplies it.
    pub emission_texture: Option<u32>,
    /// What it stops; nothing stops all.
    pub mask: Option<Mask>,
}

/// Collects a scene; see the module's text.
#[derive(Clone, Debug)]
pub struct SceneBuilder {
    source: PathBuf,
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
    /// How its lights are selected.
    pub light_selection: LightSelection,
    /// Give images of materials smaller levels of detail.
    pub mip_maps: bool,
    /// What the user should know.
    pub warnings: Vec<String>,
    images: Vec<TextureImage>,
    textures: Vec<TextureDescription>,
    materials: Vec<MaterialDescription>,
    /// Their names in the file, where they have any.
    names: HashMap<usize, String>,
    blends: Vec<Blend>,
    surfaces: Vec<SurfaceDescription>,
    groups: Vec<PendingGroup>,
    instances: Vec<(usize, DAffine3)>,
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
            light_selection: LightSelection::default(),
            mip_maps: false,
            warnings: Vec::new(),
            images: Vec::new(),
            textures: Vec::new(),
            materials: Vec::new(),
            names: HashMap::new(),
            blends: Vec::new(),
            surfaces: Vec::new(),
            groups: vec![PendingGroup { name: String::from("world"), shapes: Vec::new() }],
            instances: Vec::new(),
            elements: 0,
            image_bytes: 0,
            excess: None,
        }
    }

    /// Fails where more was added than a scene may hold; what is beyond was not kept. [`Self::finish`] asks by itself.
    pub(super) fn within_limits(&self) -> Result<()> {
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

    /// Adds a texture.
    pub fn texture(&mut self, texture: TextureDescription) -> u32 {
        self.textures.push(texture);
        self.textures.len() as u32 - 1
    }

    /// Mean of a texture's values.
    fn texture_mean(&self, texture: u32) -> [f64; 3] {
        let texture = &self.textures[texture as usize];
        match texture.pattern {
            Pattern::Checkerboard(a, b) => [0, 1, 2].map(|channel| 0.5 * f64::from(a[channel] + b[channel])),
            Pattern::Image(image) => {
                let mean = self.images[image].mean();
                [0, 1, 2].map(|i| (mean[i] * f64::from(texture.scale[i]) + f64::from(texture.offset[i])).max(0.0))
            }
        }
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
    pub(super) fn texture_size(&self, texture: u32) -> [u32; 2] {
        match self.textures[texture as usize].pattern {
            Pattern::Checkerboard(..) => [1; 2],
            Pattern::Image(image) => self.image_size(image),
        }
    }

    /// Texels of an image across and down.
    pub(super) fn image_size(&self, image: usize) -> [u32; 2] {
        [self.images[image].width, self.images[image].height]
    }

    /// A copy of a material, and of those that it blends, whose textures are changed.
    pub(super) fn changed_material(&mut self, material: usize, change: impl Fn(&mut MaterialTextures) + Copy) -> usize {
        self.changed(material, change, &mut HashMap::new())
    }

    /// `copies` holds what was copied: blends may share what they blend, and then have far more ways down than materials.
    fn changed(
        &mut self,
        material: usize,
        change: impl Fn(&mut MaterialTextures) + Copy,
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

    /// Adds a diffuse surface that is the same from both sides: short for [`Self::material`] and [`Self::surface`].
    pub fn matte(&mut self, reflectance: [f32; 3]) -> usize {
        let material = self.material(material::diffuse(reflectance));
        self.surface(SurfaceDescription {
            front: Some(material),
            back: Some(material),
            ..SurfaceDescription::default()
        })
    }

    /// Adds a group, to be placed by [`Self::instance`].
    pub fn group(&mut self, name: &str) -> usize {
        self.groups.push(PendingGroup { name: name.to_owned(), shapes: Vec::new() });
        self.groups.len() - 1
    }

    /// Adds triangles to a group (0 is the world itself). `name` says in messages which mesh it is.
    pub fn mesh(&mut self, group: usize, name: &str, mesh: Mesh, to_group: DAffine3, surface: usize) {
        self.elements += (mesh.positions.len() + mesh.triangles.len()) as u64;
        if self.elements > ELEMENTS {
            self.excess.get_or_insert(format!(
                "the scene has {} vertices and triangles with '{name}', and {ELEMENTS} is the most that is read",
                self.elements
            ));
            return;
        }
        self.groups[group].shapes.push((Shape::Mesh { mesh, to_group }, surface, name.to_owned()));
    }

    /// Adds a sphere to a group. A negative radius turns its normal inwards.
    pub fn sphere(&mut self, group: usize, name: &str, centre: DVec3, radius: f64, surface: usize) {
        self.oriented_sphere(group, name, centre, radius, DMat3::IDENTITY, surface);
    }

    /// The same with the axes (orthonormal) that its texture coordinates go by.
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

    /// Places everything around a nearby origin, drops degenerate triangles, fills the light table, and puts in the
    /// defaults that the file left open.
    pub fn finish(mut self) -> Result<Scene> {
        self.within_limits()?;
        if self.film.width == 0 || self.film.height == 0 {
            return Err(Error::scene(
                &self.source,
                format!("the film is {} x {} pixels: both must be 1 or more", self.film.width, self.film.height),
            ));
        }
        let extent = self.world_extent()?;
        if self.cameras.is_empty() {
            self.warnings.push(String::from("the scene has no camera: one that frames its bounds stands in"));
            self.cameras.push(framing_camera(extent));
        }
        let origin = choose_origin(extent, self.cameras[0].to_world.translation);

        let transmits: Vec<bool> = self.materials.iter().map(MaterialDescription::transmits).collect();
        let mut flat = Flat::new(&self.surfaces, &transmits);
        let groups = std::mem::take(&mut self.groups);
        let mut placed = Vec::new();
        for (index, group) in groups.into_iter().enumerate() {
            let (to_local, is_world) =
                if index == WORLD { (DAffine3::from_translation(-origin), true) } else { (DAffine3::IDENTITY, false) };
            placed.push(flat.add_group(&self.source, group, to_local, is_world)?);
        }
        let mut instances = Vec::new();
        if !placed[WORLD].primitives().is_empty() || self.instances.is_empty() {
            instances.push(Instance { group: WORLD, to_world: DAffine3::IDENTITY });
        }
        for (group, to_world) in &self.instances {
            let mut to_world = *to_world;
            to_world.translation -= origin;
            instances.push(Instance { group: *group, to_world });
        }
        if flat.degenerate > 0 {
            self.warnings.push(format!(
                "{} of {} triangles have no area and were dropped",
                flat.degenerate, flat.triangles_seen
            ));
        }
        if flat.repeated > 0 {
            self.warnings.push(format!("{} emitting triangles lie on another one and were dropped", flat.repeated));
        }
        flat.close_attributes();
        let is_textured = !self.textures.is_empty();
        let mut tables = if is_textured { srgb_table() } else { Vec::new() };
        let filed = file_materials(&self.materials, &mut tables);

        let lamps: Vec<Light> = self.lamps.iter().map(|lamp| lamp.entry(origin, &mut tables)).collect();
        if lamps.is_empty() && flat.emitters.is_empty() && self.background.is_none_or(|rgb| importance(rgb) == 0.0) {
            self.warnings.push(String::from("the scene has no light: a white sky of radiance 1 stands in"));
            self.background = Some([1.0; 3]);
        }
        let bounds = extent.map_or(Bounds { min: Vec3::ZERO, max: Vec3::ZERO }, |(min, max)| Bounds {
            min: (min - origin).as_vec3(),
            max: (max - origin).as_vec3(),
        });
        let radius = (bounds.max - bounds.min).length() as f64 * 0.5;
        let mut background = self.background.filter(|rgb| importance(*rgb) > 0.0);
        let environment = match (self.environment, background) {
            (Some((texture, axes)), Some(_)) => self.sample_environment(texture, axes)?,
            _ => None,
        };
        if self.environment.is_some() && environment.is_none() {
            background = None;
            self.warnings.push(String::from("the image of the environment is black: it sheds no light"));
        }
        let mut brightness = HashMap::new();
        let mut factor = |light: &Light| self.light_factor(light, &flat.surfaces, &mut brightness);
        let mut candidates: Vec<Candidate> =
            lamps.into_iter().map(|lamp| Candidate::lamp(lamp, factor(&lamp))).collect();
        candidates.extend(flat.emitters.iter().map(|emitter| Candidate::emitter(emitter, factor(&emitter.light))));
        let table = light_table::arrange(
            candidates,
            self.light_selection,
            background.is_some(),
            radius,
            &mut flat.surfaces,
            &mut flat.primitives,
        );

        for camera in &mut self.cameras {
            camera.to_world.translation -= origin;
        }
        let mut textures: Vec<_> = self.textures.iter().map(|texture| texture.entry(&self.images)).collect();
        if self.mip_maps {
            mip_maps::add(&mut self.images, &mut textures, &filed.textures, &filed.layereds);
        }
        let mut scene = Scene {
            source: self.source,
            cameras: self.cameras,
            film: self.film,
            technique: self.technique,
            primitives: flat.primitives,
            corners: flat.corners,
            normals: flat.normals,
            uvs: flat.uvs,
            tangents: flat.tangents,
            colours: flat.colours,
            surfaces: flat.surfaces,
            material_names: (0..filed.materials.len()).map(|index| self.names.remove(&index)).collect(),
            materials: filed.materials,
            material_textures: filed.textures,
            blends: self.blends,
            plastics: filed.plastics,
            principleds: filed.principleds,
            layereds: filed.layereds,
            compensations: filed.compensations,
            textures,
            images: self.images,
            tables,
            lights: table.lights,
            table_lights: table.in_table,
            table_probability: table.table_probability as f32,
            light_tree: table.tree,
            background: background.map(|rgb| rgb.map(|channel| channel as f32)),
            environment,
            background_probability: table.background_probability as f32,
            groups: placed,
            instances,
            origin,
            bounds,
            warnings: self.warnings.into_iter().map(plain).collect(),
        };
        scene.immerse_lights();
        Ok(scene)
    }

    /// The environment with the table that it is sampled by; nothing where it is black.
    fn sample_environment(&self, texture: u32, axes: DMat3) -> Result<Option<Environment>> {
        let Pattern::Image(image) = self.textures[texture as usize].pattern else {
            return Err(Error::scene(&self.source, "an environment must be an image"));
        };
        let rows = [axes.x_axis, axes.y_axis, axes.z_axis].map(|axis| axis.normalize().as_vec3().to_array());
        Ok(environment::table(&self.images[image]).map(|(table, cells)| Environment {
            texture,
            from_world: rows,
            table,
            cells,
        }))
    }

    /// What its texture leaves of a light in the mean. `brightness` keeps the means of textures, which take a look at every
    /// texel: a mesh of many lights shares one.
    fn light_factor(&self, light: &Light, surfaces: &[Surface], brightness: &mut HashMap<u32, f64>) -> f64 {
        let texture = match light.kind {
            LIGHT_TRIANGLE | LIGHT_SPHERE => surfaces[light.source as usize].emission_texture,
            LIGHT_SPOT | LIGHT_PROJECTOR => light.source,
            _ => NONE,
        };
        Some(texture)
            .filter(|texture| *texture != NONE)
            .map_or(1.0, |texture| *brightness.entry(texture).or_insert_with(|| importance(self.texture_mean(texture))))
    }

    /// The box around everything that is placed, in world coordinates; nothing where there is no geometry. A group that is
    /// placed more than once counts by its box, not by its vertices, which may be many times all that the scene holds.
    fn world_extent(&self) -> Result<Option<(DVec3, DVec3)>> {
        let mut placements = vec![0usize; self.groups.len()];
        self.instances.iter().for_each(|(group, _)| placements[*group] += 1);
        let boxes: Vec<Option<(DVec3, DVec3)>> = self
            .groups
            .iter()
            .zip(&placements)
            .map(|(group, count)| if *count > 1 { group.extent(&DAffine3::IDENTITY) } else { None })
            .collect();
        let mut all = self.groups[WORLD].extent(&DAffine3::IDENTITY);
        for (group, to_world) in &self.instances {
            let placed = match boxes[*group] {
                Some((min, max)) => {
                    let corner = |index: usize| {
                        let pick = |axis: usize| if index >> axis & 1 == 0 { min[axis] } else { max[axis] };
                        to_world.transform_point3(DVec3::new(pick(0), pick(1), pick(2)))
                    };
                    (0..8).map(|index| (corner(index), corner(index))).reduce(union)
                }
                None => self.groups[*group].extent(to_world),
            };
            all = all.into_iter().chain(placed).reduce(union);
        }
        match all {
            Some((min, max))
                if !(min.is_finite() && max.is_finite() && min.abs().max(max.abs()).max_element() < 1e18) =>
            {
                Err(Error::scene(
                    &self.source,
                    format!("the scene spans {min} to {max}: coordinates must be finite and below 1e18"),
                ))
            }
            extent => Ok(extent),
        }
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
