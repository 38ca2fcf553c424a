//! From a description in double precision to the flat arrays of a [`Scene`] in single precision: placed around a nearby
//! origin, without what is degenerate, checked, and with the tables that lights and materials are sampled by.

pub(crate) mod alias;
mod attributes;
pub mod compensation;
pub(crate) mod environment;
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
mod ranges;
mod texture;

use std::collections::HashMap;

use glam::{DAffine3, Vec3};

use crate::bvh::Bounds;
use crate::error::{Error, Result, plain};
use crate::image::srgb_table;
use crate::layout::Light;
use crate::scene::description::{SceneBuilder, WORLD};
use crate::scene::material::MaterialDescription;
use crate::scene::{Instance, Scene};
use flatten::Flat;
use light::{importance, textured_share};
use light_table::Candidate;
use materials::material_records;
use placement::{choose_origin, framing_camera, world_extent};

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
        let extent = world_extent(&self)?;
        if self.cameras.is_empty() {
            self.warnings.push(String::from("the scene has no camera: one that frames its bounds stands in"));
            self.cameras.push(framing_camera(extent));
        }
        ranges::check(&self)?;
        let origin = choose_origin(extent, self.cameras[0].to_world.translation);

        let transmits: Vec<bool> = self.materials.iter().map(MaterialDescription::transmits).collect();
        let shown = attributes::of_surfaces(&self)?;
        let mut flat = Flat::new(&self.surfaces, &transmits, std::mem::take(&mut self.attributes), shown);
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
        let records = material_records(&self.materials, &mut tables);

        let lamps: Vec<Light> = self.lamps.iter().map(|lamp| lamp.entry(origin, &mut tables)).collect();
        let is_lit = self.has_area_light || !lamps.is_empty() || !flat.emitters.is_empty() || self.background.is_some();
        if !is_lit {
            self.warnings.push(String::from("the scene has no light: a white sky of radiance 1 stands in"));
            self.background = Some([1.0; 3]);
        }
        let bounds = extent.map_or(Bounds { min: Vec3::ZERO, max: Vec3::ZERO }, |(min, max)| Bounds {
            min: (min - origin).as_vec3(),
            max: (max - origin).as_vec3(),
        });
        // 0 where all is one point: then parallel light has no power there.
        let radius = f64::from(bounds.radius());
        let mut background = self.background.filter(|rgb| importance(*rgb) > 0.0);
        let (environment, background_table) = match (self.environment, background) {
            (Some((texture, axes)), Some(_)) => environment::sampled(&self, texture, axes)?.unzip(),
            _ => (None, None),
        };
        if self.environment.is_some() && environment.is_none() {
            background = None;
            self.warnings.push(String::from("the image of the environment is black: it sheds no light"));
        }
        let mut brightness = HashMap::new();
        let mut factor = |light: &Light| textured_share(&self, light, &flat.surfaces, &mut brightness);
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

        if table.lights.is_empty() && self.background.is_none_or(|rgb| importance(rgb) == 0.0) {
            self.warnings.push(String::from("all lights of the scene have radiance 0: the image is black"));
        }

        for camera in &mut self.cameras {
            camera.to_world.translation -= origin;
        }
        let mut textures: Vec<_> =
            self.textures.iter().map(|texture| texture.entry(&self.images, flat.vertices)).collect();
        if self.mip_maps {
            mip_maps::add(&mut self.images, &mut textures, &records.property_textures);
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
            second_uvs: flat.second_uvs,
            tangents: flat.tangents,
            colours: flat.colours,
            attributes: flat.attributes.concat(),
            surfaces: flat.surfaces,
            material_names: (0..records.materials.len()).map(|index| self.names.remove(&index)).collect(),
            materials: records.materials,
            material_textures: records.textures,
            property_textures: records.property_textures,
            blends: self.blends,
            plastics: records.plastics,
            principleds: records.principleds,
            layereds: records.layereds,
            compensations: records.compensations,
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
            shapes: flat.shapes,
            instances,
            origin,
            bounds,
            warnings: self.warnings.into_iter().map(plain).collect(),
        };
        scene.immerse_lights();
        Ok(scene)
    }
}
