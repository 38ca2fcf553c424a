//! The surfaces of a scene divided into patches, for radiosity.
//!
//! A face is a triangle, two triangles that are a parallelogram, or a sphere. It is divided into cells of equal area, and each side
//! that has a material gets patches of them. Patches meet in vertices, whose values are weighted sums of those of the patches around.

mod faces;
mod hanging;
mod mesh;
mod vertices;

use crate::error::{Error, Result};
use crate::layout::{NONE, SURFACE_MASK};
use crate::scene::Scene;
use crate::techniques::table::radiosity::structs::{Patch, PatchFace};
use faces::Face;
pub use faces::Node;
use mesh::BACKS;
pub use mesh::{FIRST_COLUMN, PatchMesh, Quartered};

/// The most patches that a scene may have.
const MOST: u64 = 1 << 22;
/// The most surfaces whose form factors are told apart.
const SURFACES: usize = 16;

impl PatchMesh {
    /// Patches of a size that puts so many along the longest edge; or larger ones where they may be quartered `levels` times to come
    /// to that size, but are not.
    pub fn new(scene: &Scene, along_longest: f64, levels: u32, quartered: &Quartered) -> Result<Self> {
        let mut shapes = faces::faces(scene);
        let longest = shapes.iter().map(Face::longest).fold(0.0, f64::max);
        if longest > 0.0 {
            shapes.iter_mut().for_each(|face| face.divide(longest / along_longest, levels));
        }
        let count: u64 = shapes.iter().map(Face::patches).sum();
        if count > MOST {
            return Err(Error::Usage(format!(
                "radiosity:patches={along_longest}: {} would have {count} patches, and {MOST} is the most",
                scene.source.display()
            )));
        }
        let has_surfaces = scene.surfaces.len() <= SURFACES;
        let count_columns = FIRST_COLUMN + if has_surfaces { scene.surfaces.len() as u32 } else { 1 };
        let mut mesh = Self { has_surfaces, count_columns, ..Self::default() };
        mesh.place(scene, &shapes);
        for (index, face) in shapes.iter().enumerate() {
            mesh.add_face(scene, face, index as u32, quartered);
        }
        vertices::join(&mut mesh, &shapes);
        Ok(mesh)
    }

    /// Which face each placed primitive belongs to.
    fn place(&mut self, scene: &Scene, shapes: &[Face]) {
        for instance in &scene.instances {
            self.starts.push(self.face_of.len() as u32);
            let count = scene.groups[instance.group].primitives().len();
            self.face_of.resize(self.face_of.len() + count, NONE);
        }
        for (index, face) in shapes.iter().enumerate() {
            let group = scene.instances[face.instance].group;
            let first = self.starts[face.instance] as usize;
            for primitive in [Some(face.primitive), face.second].into_iter().flatten() {
                let within = primitive - scene.groups[group].primitives().start;
                self.face_of[first + within] = index as u32;
            }
        }
    }

    fn add_face(&mut self, scene: &Scene, face: &Face, index: u32, quartered: &Quartered) {
        let surface = scene.primitives[face.primitive].surface & SURFACE_MASK;
        let mut sides = [NONE; 2];
        for (back, first) in sides.iter_mut().enumerate().filter(|(back, _)| face.sides[*back]) {
            *first = self.cells.len() as u32;
            self.cells.resize(self.cells.len() + (face.across * face.down) as usize, NONE);
            let mut pending: Vec<Node> = face.roots().collect();
            pending.reverse();
            while let Some(node) = pending.pop() {
                if node.level > 0 && quartered.has(index, back == 1, node) {
                    pending.extend(face.quarters(node).into_iter().rev());
                    continue;
                }
                for cell in face.cells(node) {
                    self.cells[(*first + cell) as usize] = self.patches.len() as u32;
                }
                let (corner, extent) = face.extent(node);
                self.nodes.push(node);
                self.patches.push(Patch {
                    face: index,
                    back: back as u32,
                    corner: corner.as_vec2().into(),
                    extent: extent.as_vec2().into(),
                    area: face.area(corner, extent) as f32,
                    column: match (back, self.has_surfaces) {
                        (0, true) => FIRST_COLUMN + surface,
                        (0, false) => FIRST_COLUMN,
                        _ => BACKS,
                    },
                });
            }
        }
        self.faces.push(PatchFace {
            primitive: face.primitive as u32,
            second: face.second.map_or(NONE, |second| second as u32),
            turn: face.turn,
            instance: face.instance as u32,
            across: face.across,
            down: face.down,
            front: sides[0],
            back: sides[1],
        });
    }
}
