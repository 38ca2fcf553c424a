//! From what a file holds, in double precision, to the flat single-precision scene.

use std::path::PathBuf;

use glam::{DAffine3, DMat3, DVec3, Vec3};

use super::camera::{Camera, FovAxis};
use super::light::{Lamp, fill_alias_table, importance, power, triangle_area};
use super::material::{self, transmits};
use super::mesh::Mesh;
use super::{FilmSettings, Filter, Group, Instance, Scene, TechniqueRequest};
use crate::bvh::{Bounds, primitive_bounds};
use crate::error::{Error, Result};
use crate::layout::{
    Corners, LIGHT_SPHERE, LIGHT_TRIANGLE, Light, Material, NONE, Primitive, SMOOTH_BIT, SPHERE_BIT, SURFACE_MASK,
    Surface,
};

/// What one side of a surface is made of.
pub type Side = Option<usize>;

/// A surface: the materials of its two sides (indices from [`SceneBuilder::material`]) and what its front emits.
#[derive(Clone, Copy, Debug, Default)]
pub struct SurfaceDescription {
    /// The side that normals point to.
    pub front: Side,
    /// The other side.
    pub back: Side,
    /// Radiance of the front, W/(m² sr).
    pub emission: [f64; 3],
}

#[derive(Clone, Debug)]
enum Shape {
    Mesh { mesh: Mesh, to_group: DAffine3 },
    Sphere { centre: DVec3, radius: f64 },
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
    /// What the user should know.
    pub warnings: Vec<String>,
    materials: Vec<Material>,
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
            warnings: Vec::new(),
            materials: Vec::new(),
            surfaces: Vec::new(),
            groups: vec![PendingGroup { name: String::from("world"), shapes: Vec::new() }],
            instances: Vec::new(),
        }
    }

    /// Adds a material.
    pub fn material(&mut self, material: Material) -> usize {
        self.materials.push(material);
        self.materials.len() - 1
    }

    /// Adds a surface.
    pub fn surface(&mut self, surface: SurfaceDescription) -> usize {
        self.surfaces.push(surface);
        self.surfaces.len() - 1
    }

    /// Adds a diffuse surface that is the same from both sides: short for [`Self::material`] and [`Self::surface`].
    pub fn matte(&mut self, reflectance: [f32; 3]) -> usize {
        let material = self.material(material::diffuse(reflectance));
        self.surface(SurfaceDescription { front: Some(material), back: Some(material), emission: [0.0; 3] })
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
        self.groups[group].shapes.push((Shape::Sphere { centre, radius }, surface, name.to_owned()));
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
        if flat.corners.iter().all(|corners| corners.i0 == NONE) {
            flat.corners = Vec::new();
        }

        let mut lights: Vec<Light> = self.lamps.iter().map(|lamp| lamp.entry(origin)).collect();
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
        let background = self.background.filter(|rgb| importance(*rgb) > 0.0);
        let weights: Vec<f64> = lights.iter().map(|light| power(light, radius)).collect();
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
            surfaces: flat.surfaces,
            materials: self.materials,
            lights,
            background: background.map(|rgb| rgb.map(|channel| channel as f32)),
            background_probability: background_probability as f32,
            groups: placed,
            instances,
            origin,
            bounds,
            warnings: self.warnings,
        })
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
                    Shape::Sphere { centre, radius } => {
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

/// The flat arrays while they grow.
struct Flat {
    primitives: Vec<Primitive>,
    corners: Vec<Corners>,
    normals: Vec<[f32; 3]>,
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
                let glass = description.front.filter(|front| transmits(&builder.materials[*front]));
                Surface {
                    front: side(description.front),
                    back: side(glass.or(description.back)),
                    emission: description.emission.map(|channel| channel as f32),
                    light_density: 0.0,
                }
            })
            .collect();
        Self {
            primitives: Vec::new(),
            corners: Vec::new(),
            normals: Vec::new(),
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
                Shape::Sphere { centre, radius } => {
                    spheres.push((to_local.transform_point3(centre).as_vec3(), radius as f32, surface, emits))
                }
            }
        }
        let middle = self.primitives.len() as u32;
        for (centre, radius, surface, emits) in spheres {
            let v1 = [radius, 0.0, 0.0];
            self.primitives.push(Primitive {
                v0: centre.into(),
                v1,
                v2: [0.0; 3],
                surface: surface as u32 | SPHERE_BIT,
            });
            self.corners.push(Corners { i0: NONE, i1: NONE, i2: NONE });
            if emits {
                let radiance = self.surfaces[surface].emission;
                self.emitters.push((
                    Light { kind: LIGHT_SPHERE, position: centre.into(), v1, radiance, ..Light::default() },
                    surface,
                ));
            }
        }
        Ok(Group { name: group.name, triangles: first..middle, spheres: middle..self.primitives.len() as u32 })
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
        if !mesh.normals.is_empty() && mesh.normals.len() != mesh.positions.len() {
            return Err(wrong(format!("{} normals for {} vertices", mesh.normals.len(), mesh.positions.len())));
        }
        let positions: Vec<Vec3> =
            mesh.positions.iter().map(|position| to_local.transform_point3(*position).as_vec3()).collect();
        let first_normal = self.normals.len() as u32;
        let for_normals: DMat3 = to_local.matrix3.inverse().transpose();
        self.normals.extend(
            mesh.normals
                .iter()
                .map(|normal| (for_normals * normal.as_dvec3()).normalize_or_zero().as_vec3().to_array()),
        );
        let smooth = if mesh.normals.is_empty() { 0 } else { SMOOTH_BIT };
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
                surface: surface as u32 & SURFACE_MASK | smooth,
            });
            let corner = |vertex: u32| if smooth == 0 { NONE } else { first_normal + vertex };
            self.corners.push(Corners { i0: corner(triangle[0]), i1: corner(triangle[1]), i2: corner(triangle[2]) });
            if emits {
                let radiance = self.surfaces[surface].emission;
                let light = Light {
                    kind: LIGHT_TRIANGLE,
                    position: v0.into(),
                    v1: v1.into(),
                    v2: v2.into(),
                    radiance,
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
    Camera { name: String::from("default"), to_world, fov, axis: FovAxis::Smaller, principal_point: [0.0; 2] }
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
