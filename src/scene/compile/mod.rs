//! From a description in double precision to the flat arrays of a [`Scene`] in single precision: placed around a nearby
//! origin, without what is degenerate, checked, and with the tables that lights and materials are sampled by.

pub(crate) mod alias;
pub mod compensation;
mod environment;
mod flatten;
pub mod fresnel;
pub(crate) mod light;
mod light_table;
mod light_tree;
mod materials;
pub mod microfacets;
pub mod mip_maps;
mod placement;
pub mod plastic;
mod quadrature;
mod texture;

use std::collections::HashMap;

use glam::{DAffine3, DMat3, DVec3, Vec3};

use crate::bvh::Bounds;
use crate::error::{Error, Result, plain};
use crate::image::srgb_table;
use crate::layout::{AliasEntry, LIGHT_PROJECTOR, LIGHT_SPHERE, LIGHT_SPOT, LIGHT_TRIANGLE, Light, NONE, Surface};
use crate::scene::description::texture::Pattern;
use crate::scene::description::{SceneBuilder, WORLD, union};
use crate::scene::material::MaterialDescription;
use crate::scene::{Environment, Instance, Scene};
use flatten::Flat;
use light::importance;
use light_table::Candidate;
use materials::file_materials;
use placement::{choose_origin, framing_camera};

impl SceneBuilder {
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
        let (environment, background_table) = match (self.environment, background) {
            (Some((texture, axes)), Some(_)) => self.sample_environment(texture, axes)?.unzip(),
            _ => (None, None),
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
            light_tree: table.tree.nodes,
            light_tree_origin: table.tree.origin,
            light_tree_scale: table.tree.scale,
            background: background.map(|rgb| rgb.map(|channel| channel as f32)),
            environment,
            background_table: background_table.unwrap_or_default(),
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
    fn sample_environment(&self, texture: u32, axes: DMat3) -> Result<Option<(Environment, Vec<AliasEntry>)>> {
        let Pattern::Image(image) = self.textures[texture as usize].pattern else {
            return Err(Error::scene(&self.source, "an environment must be an image"));
        };
        let rows = [axes.x_axis, axes.y_axis, axes.z_axis].map(|axis| axis.normalize().as_vec3().to_array());
        Ok(environment::table(&self.images[image])
            .map(|(table, cells)| (Environment { texture, from_world: rows, cells }, table)))
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
}
