//! From meshes and spheres in double precision to the flat arrays of primitives and their attributes.

use std::collections::HashSet;
use std::path::Path;

use glam::{DAffine3, DMat3, DQuat, Vec3, Vec4};

use super::light::importance;
use crate::error::{Error, Result, some_of};
use crate::layout::{
    Corners, LIGHT_SPHERE, LIGHT_TRIANGLE, Light, NONE, Primitive, SMOOTH_BIT, SPHERE_BIT, SURFACE_EMITS_BEHIND,
    SURFACE_HAS_ALPHA_COLOURS, SURFACE_MASK, Surface, TANGENT_BIT, UV_BIT,
};
use crate::scene::description::{Group as GroupDescription, Mesh, Shape, Side, SurfaceDescription};
use crate::scene::single::RANGE;
use crate::scene::{Group, NamedShape};

/// The corners of a primitive without vertex attributes.
const NO_CORNERS: Corners = Corners { i0: NONE, i1: NONE, i2: NONE };

/// The bits of a triangle's vertices, the same whichever of them comes first. Its two sides differ.
fn same_triangle(vertices: [Vec3; 3]) -> [[u32; 3]; 3] {
    let mut bits = vertices.map(|v| (v + 0.0).to_array().map(f32::to_bits)); // a zero without its sign
    let least = (0..3).min_by_key(|index| bits[*index]).unwrap_or(0);
    bits.rotate_left(least);
    bits
}

/// Fails where a mesh has a vertex attribute that single precision cannot hold, or that is no number; the message names the vertex. Of normals and
/// tangents that are no numbers nothing is known: they are 0.
fn check_attributes(mesh: &Mesh) -> Result<(), String> {
    let wrong = |what: &str, vertex: usize, values: &dyn std::fmt::Display| {
        Err(format!("the {what} of vertex {vertex} are {values}: they must be finite; {RANGE}"))
    };
    for (what, uvs) in [("texture coordinates", &mesh.uvs), ("second texture coordinates", &mesh.second_uvs)] {
        if let Some(bad) = uvs.iter().position(|uv| !uv.is_finite()) {
            return wrong(what, bad, &uvs[bad]);
        }
    }
    if let Some(bad) = mesh.normals.iter().position(|normal| normal.abs().max_element() == f32::INFINITY) {
        return wrong("components of the normal", bad, &mesh.normals[bad]);
    }
    if let Some(bad) = mesh.tangents.iter().position(|tangent| tangent.abs().max_element() == f32::INFINITY) {
        return wrong("components of the tangent", bad, &mesh.tangents[bad]);
    }
    let of_attributes = mesh.attributes.iter().map(|own| (own.name.as_str(), &own.values));
    for (what, values) in [("colours", &mesh.colours)].into_iter().chain(of_attributes) {
        if let Some(bad) = values.iter().position(|value| !value.is_finite()) {
            return wrong(what, bad, &values[bad]);
        }
    }
    Ok(())
}

/// A primitive that emits.
#[derive(Clone, Copy, Debug)]
pub(super) struct Emitter {
    /// Its entry of the light table, still without probabilities.
    pub light: Light,
    /// Its surface.
    pub surface: usize,
    /// The primitive.
    pub primitive: usize,
    /// It is the other side of the primitive's; the emitter before it is the front.
    pub is_behind: bool,
}

/// The flat arrays while they grow.
pub(super) struct Flat {
    pub primitives: Vec<Primitive>,
    /// Of the primitives up to the last one that has any; empty where none has, which most of the largest scenes are like.
    pub corners: Vec<Corners>,
    /// Vertices that have any attribute so far: where the next one's attributes go.
    pub vertices: usize,
    pub normals: Vec<[f32; 3]>,
    pub uvs: Vec<[f32; 2]>,
    pub second_uvs: Vec<[f32; 2]>,
    pub tangents: Vec<[f32; 4]>,
    pub colours: Vec<[f32; 4]>,
    /// What textures show of vertices, attribute by attribute.
    pub attributes: Vec<Vec<[f32; 4]>>,
    /// The names of these.
    names: Vec<String>,
    /// Which of them each surface shows.
    shown: Vec<Vec<usize>>,
    pub surfaces: Vec<Surface>,
    /// The shapes of each group.
    pub shapes: Vec<NamedShape>,
    /// Groups so far.
    groups: usize,
    /// The lights that primitives are.
    pub emitters: Vec<Emitter>,
    pub degenerate: usize,
    /// Emitting triangles that lie on another one.
    pub repeated: usize,
    emitting: HashSet<[[u32; 3]; 3]>,
    pub triangles_seen: usize,
}

impl Flat {
    /// With one surface per description; `transmits` says of each material whether light passes through it, `shown` of each surface which of the
    /// attributes of those names it shows.
    pub fn new(
        descriptions: &[SurfaceDescription],
        transmits: &[bool],
        names: Vec<String>,
        shown: Vec<Vec<usize>>,
    ) -> Self {
        let side = |side: Side| side.map_or(NONE, |material| material as u32);
        let surfaces = descriptions
            .iter()
            .map(|description| {
                // What transmits is one material seen from both sides.
                let glass = description.front.filter(|front| transmits[*front]);
                Surface {
                    front: side(description.front),
                    back: side(description.back.or(glass)),
                    emission: description.emission.map(|channel| channel as f32),
                    light_density: 0.0,
                    light_trail: 0,
                    light_trail_behind: 0,
                    emission_density: 0.0,
                    emission_texture: description.emission_texture.unwrap_or(NONE),
                    opacity: description.mask.map_or(1.0, |mask| mask.opacity as f32),
                    opacity_texture: description.mask.and_then(|mask| mask.texture).unwrap_or(NONE),
                    opacity_cutoff: description.mask.map_or(0.0, |mask| mask.cutoff as f32),
                    flags: if description.emits_behind { SURFACE_EMITS_BEHIND } else { 0 }
                        | if description.has_alpha_colours { SURFACE_HAS_ALPHA_COLOURS } else { 0 },
                }
            })
            .collect();
        Self {
            primitives: Vec::new(),
            corners: Vec::new(),
            vertices: 0,
            normals: Vec::new(),
            uvs: Vec::new(),
            second_uvs: Vec::new(),
            tangents: Vec::new(),
            colours: Vec::new(),
            attributes: vec![Vec::new(); names.len()],
            names,
            shown,
            surfaces,
            shapes: Vec::new(),
            groups: 0,
            emitters: Vec::new(),
            degenerate: 0,
            repeated: 0,
            emitting: HashSet::new(),
            triangles_seen: 0,
        }
    }

    /// Takes in a group.
    pub fn add_group(
        &mut self,
        source: &Path,
        group: GroupDescription,
        to_local: DAffine3,
        is_world: bool,
    ) -> Result<Group> {
        let first = self.primitives.len() as u32;
        let own_group = self.groups;
        self.groups += 1;
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
            let start = self.primitives.len() as u32;
            match shape {
                Shape::Mesh { mesh, to_group } => {
                    self.add_mesh(source, &name, &mesh, to_local * to_group, surface, emits)?
                }
                Shape::Sphere { centre, radius, axes } => {
                    if let Some(first) = self.shown[surface].first() {
                        let message = format!(
                            "sphere '{name}': its material shows the mesh attribute '{}', and a sphere has none",
                            self.names[*first]
                        );
                        return Err(Error::scene(source, message));
                    }
                    let centre = to_local.transform_point3(centre).as_vec3();
                    spheres.push((centre, radius as f32, axes, surface, emits, self.shapes.len()))
                }
            }
            // Of spheres, which follow all triangles, below.
            let primitives = start..self.primitives.len() as u32;
            self.shapes.push(NamedShape { name, group: own_group, primitives });
        }
        let middle = self.primitives.len() as u32;
        let mut lit_surfaces: HashSet<usize> = self.emitters.iter().map(|emitter| emitter.surface).collect();
        for (centre, radius, axes, mut surface, emits, shape) in spheres {
            let own = self.primitives.len() as u32;
            self.shapes[shape].primitives = own..own + 1;
            // Each emitting sphere has a density of its own, which its surface holds.
            if emits && !lit_surfaces.insert(surface) {
                self.surfaces.push(self.surfaces[surface]);
                surface = self.surfaces.len() - 1;
            }
            let mirror = if axes.determinant() < 0.0 { -1.0 } else { 1.0 };
            let turn = DQuat::from_mat3(&(axes * mirror)).normalize();
            let turn = if turn.w < 0.0 { -turn } else { turn };
            let v1 = [radius, mirror as f32, 0.0];
            let v2 = turn.xyz().as_vec3().to_array();
            self.primitives.push(Primitive { v0: centre.into(), v1, v2, surface: surface as u32 | SPHERE_BIT });
            if emits {
                let radiance = self.surfaces[surface].emission;
                let light = Light {
                    kind: LIGHT_SPHERE,
                    position: centre.into(),
                    v1,
                    v2,
                    radiance,
                    source: surface as u32,
                    ..Light::default()
                };
                self.emitters.push(Emitter { light, surface, primitive: self.primitives.len() - 1, is_behind: false });
            }
        }
        Ok(Group { name: group.name, triangles: first..middle, spheres: middle..self.primitives.len() as u32 })
    }

    /// Takes in the vertex attributes of a mesh; the bits of [`Primitive::surface`] that say which there are. A light knows its vertices by their
    /// texture coordinates: one whose surface looks at others of their attributes has such coordinates, be they 0.
    fn add_attributes(&mut self, mesh: &Mesh, to_local: DAffine3, surface: usize, emits: bool) -> Result<u32, String> {
        let count = mesh.positions.len();
        for (what, given) in [
            ("normals", mesh.normals.len()),
            ("texture coordinates", mesh.uvs.len()),
            ("second texture coordinates", mesh.second_uvs.len()),
            ("tangents", mesh.tangents.len()),
            ("colours", mesh.colours.len()),
        ]
        .into_iter()
        .chain(mesh.attributes.iter().map(|own| (own.name.as_str(), own.values.len())))
        {
            if given != 0 && given != count {
                return Err(format!("{given} {what} for {count} vertices"));
            }
        }
        check_attributes(mesh)?;
        let for_normals: DMat3 = to_local.matrix3.inverse().transpose();
        let base = self.vertices;
        let mut flags = 0;
        if !mesh.normals.is_empty() {
            flags |= SMOOTH_BIT;
            self.normals.resize(base, [0.0; 3]);
            let turned = |normal: &Vec3| (for_normals * normal.as_dvec3()).normalize_or_zero().as_vec3().to_array();
            self.normals.extend(mesh.normals.iter().map(turned));
        }
        let has_alpha = self.surfaces[surface].flags & SURFACE_HAS_ALPHA_COLOURS != 0 && !mesh.colours.is_empty();
        if !mesh.uvs.is_empty() || emits && (has_alpha || !mesh.second_uvs.is_empty()) {
            flags |= UV_BIT;
            self.uvs.resize(base, [0.0; 2]);
            self.uvs.extend(mesh.uvs.iter().map(|uv| uv.to_array()));
            self.uvs.resize(base + count, [0.0; 2]);
        }
        if !mesh.second_uvs.is_empty() {
            self.second_uvs.resize(base, [0.0; 2]);
            self.second_uvs.extend(mesh.second_uvs.iter().map(|uv| uv.to_array()));
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
        let mut has_attributes = !mesh.second_uvs.is_empty();
        for (name, values) in self.names.iter().zip(&mut self.attributes) {
            if let Some(own) = mesh.attributes.iter().find(|own| own.name == *name) {
                values.resize(base, [0.0; 4]);
                values.extend(own.values.iter().map(|value| value.to_array()));
                has_attributes = true;
            }
        }
        if flags != 0 || !mesh.colours.is_empty() || has_attributes {
            self.vertices += count;
        }
        Ok(flags)
    }

    /// Brings the attributes that some meshes have to the same length for all.
    pub fn close_attributes(&mut self) {
        let count = self.vertices;
        if count > 0 {
            self.corners.resize(self.primitives.len(), NO_CORNERS);
        }
        self.primitives.shrink_to_fit();
        if !self.normals.is_empty() {
            self.normals.resize(count, [0.0; 3]);
        }
        if !self.uvs.is_empty() {
            self.uvs.resize(count, [0.0; 2]);
        }
        if !self.second_uvs.is_empty() {
            self.second_uvs.resize(count, [0.0; 2]);
        }
        if !self.tangents.is_empty() {
            self.tangents.resize(count, [0.0; 4]);
        }
        if !self.colours.is_empty() {
            self.colours.resize(count, [1.0; 4]);
        }
        self.attributes.iter_mut().for_each(|values| values.resize(count, [0.0; 4]));
    }

    fn add_mesh(
        &mut self,
        source: &Path,
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
        let lacks = |index: &&usize| mesh.attributes.iter().all(|own| own.name != self.names[**index]);
        if let Some(index) = self.shown.get(surface).and_then(|shown| shown.iter().find(lacks)) {
            let own: Vec<&str> = mesh.attributes.iter().map(|own| own.name.as_str()).collect();
            let name = &self.names[*index];
            let own = some_of(own, "attributes", name);
            return Err(wrong(format!(
                "its material shows the mesh attribute '{name}', which it does not have; it has {own}"
            )));
        }
        let flags = self.add_attributes(mesh, to_local, surface, emits).map_err(wrong)?;
        let smooth = flags & SMOOTH_BIT;
        let has_attributes = self.vertices as u32 > first_normal;
        self.triangles_seen += mesh.triangles.len();
        self.primitives.reserve(mesh.triangles.len());
        if has_attributes {
            self.corners.resize(self.primitives.len(), NO_CORNERS);
            self.corners.reserve(mesh.triangles.len());
        }
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
            // Of lights that lie on each other a ray sees one: what is sampled from the others would be light that is not there.
            let behind = self.surfaces[surface].flags & SURFACE_EMITS_BEHIND != 0;
            if emits {
                let sides = [Some([v0, v1, v2]), behind.then_some([v0, v2, v1])];
                let sides = sides.into_iter().flatten().map(same_triangle);
                // One that is dropped leaves its place to others.
                if sides.clone().any(|side| self.emitting.contains(&side)) {
                    self.repeated += 1;
                    continue;
                }
                self.emitting.extend(sides);
            }
            self.primitives.push(Primitive {
                v0: v0.into(),
                v1: v1.into(),
                v2: v2.into(),
                surface: surface as u32 & SURFACE_MASK | flags,
            });
            let corner = |vertex: u32| if has_attributes { first_normal + vertex } else { NONE };
            if has_attributes {
                let [i0, i1, i2] = triangle.map(corner);
                self.corners.push(Corners { i0, i1, i2 });
            }
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
                let primitive = self.primitives.len() - 1;
                self.emitters.push(Emitter { light, surface, primitive, is_behind: false });
                if behind {
                    let [a, b, c] = light.corners;
                    let light = Light { v1: light.v2, v2: light.v1, corners: [a, c, b], ..light };
                    self.emitters.push(Emitter { light, surface, primitive, is_behind: true });
                }
            }
        }
        Ok(())
    }
}
