//! From what a file holds, in double precision, to the flat single-precision scene.

use std::collections::HashMap;
use std::path::PathBuf;

use glam::{DAffine3, DMat3, DQuat, DVec3, Vec3, Vec4};

use super::camera::{Camera, FovAxis};
use super::light::{Lamp, fill_alias_table, importance, power, triangle_area};
use super::material::{self, Detail, MaterialDescription};
use super::mesh::Mesh;
use super::texture::{Pattern, TextureDescription, TextureImage, srgb_table};
use super::{Environment, FilmSettings, Filter, Group, Instance, Scene, TechniqueRequest, environment};
use crate::bvh::{Bounds, primitive_bounds};
use crate::error::{Error, Result};
use crate::layout::{
    Blend, Corners, LIGHT_PROJECTOR, LIGHT_SPHERE, LIGHT_SPOT, LIGHT_TRIANGLE, Layered, Light, MATERIAL_BLEND,
    MATERIAL_HAS_TANGENTS, MATERIAL_HAS_TRANSMISSION, Material, MaterialTextures, NONE, Plastic, Primitive, Principled,
    SMOOTH_BIT, SPHERE_BIT, SURFACE_MASK, Surface, TANGENT_BIT, UV_BIT,
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

#[derive(Clone, Debug)]
enum Shape {
    Mesh { mesh: Mesh, to_group: DAffine3 },
    Sphere { centre: DVec3, radius: f64, axes: DMat3 },
}

#[derive(Clone, Debug)]
struct PendingGroup {
    name: String,
    shapes: Vec<(Shape, usize, String)>,
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
    /// What the user should know.
    pub warnings: Vec<String>,
    images: Vec<TextureImage>,
    textures: Vec<TextureDescription>,
    materials: Vec<MaterialDescription>,
    blends: Vec<Blend>,
    surfaces: Vec<SurfaceDescription>,
    groups: Vec<PendingGroup>,
    instances: Vec<(usize, DAffine3)>,
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
            warnings: Vec::new(),
            images: Vec::new(),
            textures: Vec::new(),
            materials: Vec::new(),
            blends: Vec::new(),
            surfaces: Vec::new(),
            groups: vec![PendingGroup { name: String::from("world"), shapes: Vec::new() }],
            instances: Vec::new(),
        }
    }

    /// Adds an image for textures to show.
    pub fn image(&mut self, image: TextureImage) -> usize {
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
        let mut copy = self.materials[material].clone();
        if copy.record.kind == MATERIAL_BLEND {
            let mut blend = self.blends[copy.record.detail as usize];
            blend.first = self.changed_material(blend.first as usize, change) as u32;
            blend.second = self.changed_material(blend.second as usize, change) as u32;
            self.blends.push(blend);
            copy.record.detail = self.blends.len() as u32 - 1;
        } else {
            change(&mut copy.textures);
        }
        self.material(copy)
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

        let mut flat = Flat::new(&self);
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
        flat.close_attributes();
        let is_textured = !self.textures.is_empty();
        let mut tables = if is_textured { srgb_table() } else { Vec::new() };
        let filed = file_materials(&self.materials, &mut tables);

        let mut lights: Vec<Light> = self.lamps.iter().map(|lamp| lamp.entry(origin, &mut tables)).collect();
        lights.extend(flat.emitters.iter().map(|emitter| emitter.0));
        if lights.is_empty() && self.background.is_none_or(|rgb| importance(rgb) == 0.0) {
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
            background = None; // a black image
        }
        let mut brightness = HashMap::new();
        let weights: Vec<f64> =
            lights.iter().map(|light| self.light_power(light, &flat.surfaces, radius, &mut brightness)).collect();
        let background_probability = match (background.is_some(), weights.iter().sum::<f64>() > 0.0) {
            (true, true) => 0.5, // neither can starve the other, whichever the scene shows more of
            (true, false) => 1.0,
            (false, _) => 0.0,
        };
        if weights.iter().sum::<f64>() > 0.0 {
            fill_alias_table(&mut lights, &weights, 1.0 - background_probability);
        } else {
            lights.clear();
        }
        // The density with which a point of each emitting surface is picked, for paths that hit it by themselves.
        for (light, (_, surface)) in lights.iter().skip(self.lamps.len()).zip(&flat.emitters) {
            flat.surfaces[*surface].light_density = if light.kind == LIGHT_SPHERE {
                light.probability
            } else {
                (f64::from(light.probability) / triangle_area(light)) as f32
            };
        }

        for camera in &mut self.cameras {
            camera.to_world.translation -= origin;
        }
        Ok(Scene {
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
            materials: filed.materials,
            material_textures: filed.textures,
            blends: self.blends,
            plastics: filed.plastics,
            principleds: filed.principleds,
            layereds: filed.layereds,
            textures: self.textures.iter().map(|texture| texture.entry(&self.images)).collect(),
            images: self.images,
            tables,
            lights,
            background: background.map(|rgb| rgb.map(|channel| channel as f32)),
            environment,
            background_probability: background_probability as f32,
            groups: placed,
            instances,
            origin,
            bounds,
            warnings: self.warnings,
        })
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

    /// The flux that a light brings, its texture included. `brightness` keeps the means of textures, which take a look at
    /// every texel: a mesh of many lights shares one.
    fn light_power(&self, light: &Light, surfaces: &[Surface], radius: f64, brightness: &mut HashMap<u32, f64>) -> f64 {
        let texture = match light.kind {
            LIGHT_TRIANGLE | LIGHT_SPHERE => surfaces[light.source as usize].emission_texture,
            LIGHT_SPOT | LIGHT_PROJECTOR => light.source,
            _ => NONE,
        };
        let factor = Some(texture).filter(|texture| *texture != NONE).map_or(1.0, |texture| {
            *brightness.entry(texture).or_insert_with(|| importance(self.texture_mean(texture)))
        });
        power(light, radius) * factor
    }

    /// The box around everything that is placed, in world coordinates; nothing where there is no geometry.
    fn world_extent(&self) -> Result<Option<(DVec3, DVec3)>> {
        let mut all: Option<(DVec3, DVec3)> = None;
        let mut place = |group: usize, to_world: &DAffine3| {
            for (shape, _, _) in &self.groups[group].shapes {
                let mut include = |point: DVec3, reach: DVec3| {
                    let (min, max) = all.get_or_insert((point - reach, point + reach));
                    (*min, *max) = (min.min(point - reach), max.max(point + reach));
                };
                match shape {
                    Shape::Mesh { mesh, to_group } => {
                        let map = *to_world * *to_group;
                        mesh.positions
                            .iter()
                            .for_each(|position| include(map.transform_point3(*position), DVec3::ZERO));
                    }
                    Shape::Sphere { centre, radius, .. } => {
                        let rows = to_world.matrix3.transpose();
                        let reach =
                            DVec3::new(rows.x_axis.length(), rows.y_axis.length(), rows.z_axis.length()) * radius.abs();
                        include(to_world.transform_point3(*centre), reach);
                    }
                }
            }
        };
        place(WORLD, &DAffine3::IDENTITY);
        for (group, to_world) in &self.instances {
            place(*group, to_world);
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

/// The materials' records and what goes beside them.
#[derive(Default)]
struct Filed {
    materials: Vec<Material>,
    textures: Vec<MaterialTextures>,
    plastics: Vec<Plastic>,
    principleds: Vec<Principled>,
    layereds: Vec<Layered>,
}

fn file_materials(descriptions: &[MaterialDescription], tables: &mut Vec<f32>) -> Filed {
    let mut filed = Filed::default();
    for description in descriptions {
        let mut record = description.record;
        match &description.detail {
            Detail::None => {}
            Detail::Plastic(plastic) => {
                let (table, inside) = description.coating();
                let (first, internal_reflectance) = (tables.len() as u32, inside as f32);
                record.detail = filed.plastics.len() as u32;
                filed.plastics.push(Plastic { table: first, internal_reflectance, ..*plastic });
                tables.extend(table);
            }
            Detail::Principled(principled) => {
                record.detail = filed.principleds.len() as u32;
                filed.principleds.push(*principled);
            }
            Detail::Layered(layered) => {
                record.detail = filed.layereds.len() as u32;
                filed.layereds.push(*layered);
            }
        }
        let textures = &description.textures;
        if description.is_textured() {
            record.textures = filed.textures.len() as u32;
            filed.textures.push(*textures);
        }
        if textures.normal != NONE || textures.bump != NONE {
            record.flags |= MATERIAL_HAS_TANGENTS;
        }
        filed.materials.push(record);
    }
    filed
}

/// The flat arrays while they grow.
struct Flat {
    primitives: Vec<Primitive>,
    corners: Vec<Corners>,
    /// Vertices that have any attribute so far: where the next one's attributes go.
    vertices: usize,
    normals: Vec<[f32; 3]>,
    uvs: Vec<[f32; 2]>,
    tangents: Vec<[f32; 4]>,
    colours: Vec<[f32; 4]>,
    surfaces: Vec<Surface>,
    /// Entries of the light table and the surface that each belongs to.
    emitters: Vec<(Light, usize)>,
    degenerate: usize,
    triangles_seen: usize,
}

impl Flat {
    fn new(builder: &SceneBuilder) -> Self {
        let side = |side: Side| side.map_or(NONE, |material| material as u32);
        let surfaces = builder
            .surfaces
            .iter()
            .map(|description| {
                // What transmits is one material seen from both sides.
                let glass = description.front.filter(|front| builder.materials[*front].transmits());
                Surface {
                    front: side(description.front),
                    back: side(glass.or(description.back)),
                    emission: description.emission.map(|channel| channel as f32),
                    light_density: 0.0,
                    emission_texture: description.emission_texture.unwrap_or(NONE),
                    opacity: description.mask.map_or(1.0, |mask| mask.opacity as f32),
                    opacity_texture: description.mask.and_then(|mask| mask.texture).unwrap_or(NONE),
                    opacity_cutoff: description.mask.map_or(0.0, |mask| mask.cutoff as f32),
                }
            })
            .collect();
        Self {
            primitives: Vec::new(),
            corners: Vec::new(),
            vertices: 0,
            normals: Vec::new(),
            uvs: Vec::new(),
            tangents: Vec::new(),
            colours: Vec::new(),
            surfaces,
            emitters: Vec::new(),
            degenerate: 0,
            triangles_seen: 0,
        }
    }

    fn add_group(
        &mut self,
        source: &std::path::Path,
        group: PendingGroup,
        to_local: DAffine3,
        is_world: bool,
    ) -> Result<Group> {
        let first = self.primitives.len() as u32;
        let mut spheres = Vec::new();
        for (shape, surface, name) in group.shapes {
            let emission = self.surfaces[surface].emission.map(f64::from);
            let emits = importance(emission) > 0.0;
            if emits && !is_world {
                let message = format!(
                    "shape '{name}' emits and belongs to '{}', which is placed by instances: give each light a place of its own",
                    group.name
                );
                return Err(Error::scene(source, message));
            }
            match shape {
                Shape::Mesh { mesh, to_group } => {
                    self.add_mesh(source, &name, &mesh, to_local * to_group, surface, emits)?
                }
                Shape::Sphere { centre, radius, axes } => {
                    spheres.push((to_local.transform_point3(centre).as_vec3(), radius as f32, axes, surface, emits))
                }
            }
        }
        let middle = self.primitives.len() as u32;
        for (centre, radius, axes, mut surface, emits) in spheres {
            // Each emitting sphere has a density of its own, which its surface holds.
            if emits && self.emitters.iter().any(|(_, other)| *other == surface) {
                self.surfaces.push(self.surfaces[surface]);
                surface = self.surfaces.len() - 1;
            }
            let mirror = if axes.determinant() < 0.0 { -1.0 } else { 1.0 };
            let turn = DQuat::from_mat3(&(axes * mirror)).normalize();
            let turn = if turn.w < 0.0 { -turn } else { turn };
            let v1 = [radius, mirror as f32, 0.0];
            let v2 = turn.xyz().as_vec3().to_array();
            self.primitives.push(Primitive { v0: centre.into(), v1, v2, surface: surface as u32 | SPHERE_BIT });
            self.corners.push(Corners { i0: NONE, i1: NONE, i2: NONE });
            if emits {
                let radiance = self.surfaces[surface].emission;
                self.emitters.push((
                    Light {
                        kind: LIGHT_SPHERE,
                        position: centre.into(),
                        v1,
                        v2,
                        radiance,
                        source: surface as u32,
                        ..Light::default()
                    },
                    surface,
                ));
            }
        }
        Ok(Group { name: group.name, triangles: first..middle, spheres: middle..self.primitives.len() as u32 })
    }

    /// Takes in the vertex attributes of a mesh; the bits of [`Primitive::surface`] that say which there are.
    fn add_attributes(&mut self, mesh: &Mesh, to_local: DAffine3) -> Result<u32, String> {
        let count = mesh.positions.len();
        for (what, given) in [
            ("normals", mesh.normals.len()),
            ("texture coordinates", mesh.uvs.len()),
            ("tangents", mesh.tangents.len()),
            ("colours", mesh.colours.len()),
        ] {
            if given != 0 && given != count {
                return Err(format!("{given} {what} for {count} vertices"));
            }
        }
        if let Some(bad) = mesh.uvs.iter().position(|uv| !uv.is_finite()) {
            return Err(format!("the texture coordinates of vertex {bad} are {}: they must be finite", mesh.uvs[bad]));
        }
        let for_normals: DMat3 = to_local.matrix3.inverse().transpose();
        let base = self.vertices;
        let mut flags = 0;
        if !mesh.normals.is_empty() {
            flags |= SMOOTH_BIT;
            self.normals.resize(base, [0.0; 3]);
            let turned = |normal: &Vec3| (for_normals * normal.as_dvec3()).normalize_or_zero().as_vec3().to_array();
            self.normals.extend(mesh.normals.iter().map(turned));
        }
        if !mesh.uvs.is_empty() {
            flags |= UV_BIT;
            self.uvs.resize(base, [0.0; 2]);
            self.uvs.extend(mesh.uvs.iter().map(|uv| uv.to_array()));
        }
        if !mesh.tangents.is_empty() {
            flags |= TANGENT_BIT;
            self.tangents.resize(base, [0.0; 4]);
            let turned = |tangent: &Vec4| {
                (to_local.matrix3 * tangent.truncate().as_dvec3())
                    .normalize_or_zero()
                    .as_vec3()
                    .extend(tangent.w)
                    .to_array()
            };
            self.tangents.extend(mesh.tangents.iter().map(turned));
        }
        if !mesh.colours.is_empty() {
            self.colours.resize(base, [1.0; 4]);
            self.colours.extend(mesh.colours.iter().map(|colour| colour.to_array()));
        }
        if flags != 0 || !mesh.colours.is_empty() {
            self.vertices += count;
        }
        Ok(flags)
    }

    /// Brings the attributes that some meshes have to the same length for all.
    fn close_attributes(&mut self) {
        let count = self.vertices;
        if count == 0 {
            self.corners = Vec::new();
        }
        if !self.normals.is_empty() {
            self.normals.resize(count, [0.0; 3]);
        }
        if !self.uvs.is_empty() {
            self.uvs.resize(count, [0.0; 2]);
        }
        if !self.tangents.is_empty() {
            self.tangents.resize(count, [0.0; 4]);
        }
        if !self.colours.is_empty() {
            self.colours.resize(count, [1.0; 4]);
        }
    }

    fn add_mesh(
        &mut self,
        source: &std::path::Path,
        name: &str,
        mesh: &Mesh,
        to_local: DAffine3,
        surface: usize,
        emits: bool,
    ) -> Result<()> {
        let wrong = |message: String| Error::scene(source, format!("mesh '{name}': {message}"));
        if let Some(bad) = mesh.positions.iter().position(|position| !position.is_finite()) {
            return Err(wrong(format!(
                "vertex {bad} of {} is {}: coordinates must be finite",
                mesh.positions.len(),
                mesh.positions[bad]
            )));
        }
        let positions: Vec<Vec3> =
            mesh.positions.iter().map(|position| to_local.transform_point3(*position).as_vec3()).collect();
        let first_normal = self.vertices as u32;
        let flags = self.add_attributes(mesh, to_local).map_err(wrong)?;
        let smooth = flags & SMOOTH_BIT;
        let has_attributes = self.vertices as u32 > first_normal;
        self.triangles_seen += mesh.triangles.len();
        for (index, triangle) in mesh.triangles.iter().enumerate() {
            if let Some(bad) = triangle.iter().find(|vertex| **vertex as usize >= positions.len()) {
                return Err(wrong(format!(
                    "triangle {index} refers to vertex {bad}, and there are {} vertices (0 to {})",
                    positions.len(),
                    positions.len().saturating_sub(1)
                )));
            }
            let mut triangle = *triangle;
            let [v0, v1, v2] = triangle.map(|vertex| positions[vertex as usize]);
            let scaled_normal = (v1 - v0).as_dvec3().cross((v2 - v0).as_dvec3());
            if scaled_normal.length_squared() == 0.0 {
                self.degenerate += 1;
                continue;
            }
            // Vertex normals say which side is the front, where there are any.
            if smooth != 0 {
                let sum: Vec3 =
                    triangle.iter().map(|vertex| Vec3::from(self.normals[(first_normal + vertex) as usize])).sum();
                if scaled_normal.dot(sum.as_dvec3()) < 0.0 {
                    triangle.swap(1, 2);
                }
            }
            // The vertex opposite the longest edge first: the edges that meet there make the best conditioned normal.
            let [v0, v1, v2] = triangle.map(|vertex| positions[vertex as usize].as_dvec3());
            let opposite = [v1.distance_squared(v2), v2.distance_squared(v0), v0.distance_squared(v1)];
            let longest = (0..3).fold(0, |best, edge| if opposite[edge] > opposite[best] { edge } else { best });
            triangle.rotate_left(longest);
            let [v0, v1, v2] = triangle.map(|vertex| positions[vertex as usize]);
            self.primitives.push(Primitive {
                v0: v0.into(),
                v1: v1.into(),
                v2: v2.into(),
                surface: surface as u32 & SURFACE_MASK | flags,
            });
            let corner = |vertex: u32| if has_attributes { first_normal + vertex } else { NONE };
            self.corners.push(Corners { i0: corner(triangle[0]), i1: corner(triangle[1]), i2: corner(triangle[2]) });
            if emits {
                let radiance = self.surfaces[surface].emission;
                let light = Light {
                    kind: LIGHT_TRIANGLE,
                    position: v0.into(),
                    v1: v1.into(),
                    v2: v2.into(),
                    radiance,
                    source: surface as u32,
                    corners: if flags & UV_BIT != 0 { triangle.map(corner) } else { [NONE; 3] },
                    ..Light::default()
                };
                self.emitters.push((light, surface));
            }
        }
        Ok(())
    }
}

/// The point that single precision is kept fine around: the world's own origin as long as the scene is near it, which
/// leaves round coordinates round; else the camera, where precision is seen.
fn choose_origin(extent: Option<(DVec3, DVec3)>, camera: DVec3) -> DVec3 {
    let Some((min, max)) = extent else { return DVec3::ZERO };
    let (min, max) = (min.min(camera), max.max(camera));
    let far = min.abs().max(max.abs()).max_element();
    if far <= 4.0 * (max - min).length() { DVec3::ZERO } else { camera.round() }
}

/// A camera that sees the whole of the box from a little above.
fn framing_camera(extent: Option<(DVec3, DVec3)>) -> Camera {
    let (min, max) = extent.unwrap_or((DVec3::splat(-1.0), DVec3::splat(1.0)));
    let (centre, radius) = ((min + max) / 2.0, ((max - min).length() / 2.0).max(1e-6));
    let fov: f64 = 40.0;
    let distance = radius / (fov.to_radians() / 2.0).sin();
    let from = centre + DVec3::new(0.5, 0.35, 1.0).normalize() * distance;
    let to_world = super::camera::look_at(from, centre, DVec3::Y).unwrap_or(DAffine3::from_translation(from));
    Camera::new("default", to_world, fov, FovAxis::Smaller)
}

impl Scene {
    /// The camera of that name or number, or the first one.
    pub fn camera(&self, name: Option<&str>) -> Result<&Camera> {
        let Some(name) = name else { return Ok(&self.cameras[0]) };
        let by_index = name.parse::<usize>().ok().and_then(|index| self.cameras.get(index));
        self.cameras.iter().find(|camera| camera.name == name).or(by_index).ok_or_else(|| {
            let valid = self.cameras.iter().enumerate().map(|(index, camera)| format!("{index} ('{}')", camera.name));
            Error::Usage(format!(
                "{} has no camera '{name}'; it has {}",
                self.source.display(),
                crate::error::one_of(valid)
            ))
        })
    }

    /// The box of one group, in its own space.
    pub fn group_bounds(&self, group: &Group) -> Bounds {
        self.primitives[group.primitives()].iter().map(primitive_bounds).fold(Bounds::EMPTY, Bounds::union)
    }
}
