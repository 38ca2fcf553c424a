//! Vertices that hang on the edge of a larger patch: they take what that patch shows there, or the surface would be torn (Baum, Mann,
//! Smith and Winget 1991, "Making radiosity usable", on T-vertices). Across the edges of faces nothing is mended.

use std::collections::HashMap;

use super::faces::{Face, Shape};
use super::mesh::PatchMesh;
use crate::layout::NONE;

/// Where a vertex hangs.
#[derive(Clone, Copy)]
struct Hook {
    /// Cells along the edge.
    length: u32,
    /// The edge's ends, and the share of the second one.
    ends: [u32; 2],
    share: f32,
}

/// A place on the cells' grid of a side.
type Place = (u32, u32, u32, u32);

/// Replaces the terms of hanging vertices.
pub(super) fn anchor(mesh: &mut PatchMesh, faces: &[Face]) {
    if mesh.nodes.iter().all(|node| node.level == 0) {
        return;
    }
    let mut hooks: Vec<(u32, Hook)> = hooks(mesh, faces).into_iter().collect();
    // The ends of an edge may hang on longer ones.
    hooks.sort_by_key(|(vertex, hook)| (std::cmp::Reverse(hook.length), *vertex));
    let mut changed: HashMap<u32, Vec<[u32; 2]>> = HashMap::new();
    for (vertex, hook) in hooks {
        let mut terms = Vec::new();
        for (end, share) in hook.ends.into_iter().zip([1.0 - hook.share, hook.share]) {
            let range = mesh.term_first[end as usize] as usize..mesh.term_first[end as usize + 1] as usize;
            let of_end = changed.get(&end).map_or(&mesh.terms[range], Vec::as_slice);
            terms.extend(of_end.iter().map(|[patch, weight]| [*patch, (share * f32::from_bits(*weight)).to_bits()]));
        }
        changed.insert(vertex, terms);
    }
    let (first, terms) = (std::mem::take(&mut mesh.term_first), std::mem::take(&mut mesh.terms));
    mesh.term_first.push(0);
    for vertex in 0..first.len() - 1 {
        let own = &terms[first[vertex] as usize..first[vertex + 1] as usize];
        mesh.terms.extend_from_slice(changed.get(&(vertex as u32)).map_or(own, Vec::as_slice));
        mesh.term_first.push(mesh.terms.len() as u32);
    }
}

/// The longest edge within which each vertex lies, where there is one.
fn hooks(mesh: &PatchMesh, faces: &[Face]) -> HashMap<u32, Hook> {
    let mut at: HashMap<Place, u32> = HashMap::new();
    for patch in 0..mesh.patches.len() {
        at.extend(corners(mesh, faces, patch));
    }
    let mut found: HashMap<u32, Hook> = HashMap::new();
    for patch in (0..mesh.patches.len()).filter(|patch| mesh.nodes[*patch].level > 0) {
        let length = 1u32 << mesh.nodes[patch].level;
        let own = corners(mesh, faces, patch);
        let edges: &[[usize; 2]] =
            if own.len() == 3 { &[[0, 1], [1, 2], [2, 0]] } else { &[[0, 1], [1, 3], [3, 2], [2, 0]] };
        for [from, to] in edges {
            let ((a, first), (b, last)) = (own[*from], own[*to]);
            let between = |a: u32, b: u32, step: u32| (a * (length - step) + b * step) / length;
            for step in 1..length {
                let place = (a.0, a.1, between(a.2, b.2, step), between(a.3, b.3, step));
                let Some(vertex) = at.get(&place) else { continue };
                let hook = Hook { length, ends: [first, last], share: step as f32 / length as f32 };
                let kept = found.entry(*vertex).or_insert(hook);
                if kept.length < length {
                    *kept = hook;
                }
            }
        }
    }
    // Where a rim has two sides, an end may be the vertex itself: a sphere's pole.
    found.retain(|vertex, hook| !hook.ends.contains(vertex));
    found
}

/// The corners of a patch on the grid of its side, with their vertices.
fn corners(mesh: &PatchMesh, faces: &[Face], patch: usize) -> Vec<(Place, u32)> {
    let (own, node) = (&mesh.patches[patch], mesh.nodes[patch]);
    let triangle = matches!(faces[own.face as usize].shape, Shape::Triangle { .. });
    let size = 1u32 << node.level;
    let place = |x: u32, y: u32| (own.face, own.back, x * size, y * size);
    let (x, y) = (node.x, node.y);
    let places = match (triangle, node.on_head) {
        (true, true) => vec![place(x + 1, y + 1), place(x, y + 1), place(x + 1, y)],
        (true, false) => vec![place(x, y), place(x + 1, y), place(x, y + 1)],
        (false, _) => vec![place(x, y), place(x + 1, y), place(x, y + 1), place(x + 1, y + 1)],
    };
    places.into_iter().zip(mesh.corners[patch]).filter(|(_, vertex)| *vertex != NONE).collect()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use std::collections::HashSet;

    use glam::{DAffine3, DVec3};

    use super::super::Quartered;
    use super::*;
    use crate::scene::{Camera, Mesh, SceneBuilder};

    /// The weighted sum of a vertex for values of patches.
    fn value(mesh: &PatchMesh, vertex: u32, of: &[f32]) -> f32 {
        let range = mesh.term_first[vertex as usize] as usize..mesh.term_first[vertex as usize + 1] as usize;
        mesh.terms[range].iter().map(|[patch, weight]| f32::from_bits(*weight) * of[*patch as usize]).sum()
    }

    /// Whatever the patches' values, a vertex on the edge of a larger patch lies on the line between the edge's ends, down two sizes.
    #[test]
    fn nothing_is_torn() {
        let mut builder = SceneBuilder::new("hanging");
        let surface = builder.matte([0.5; 3]);
        builder.mesh(0, "square", Mesh::rectangle(), DAffine3::IDENTITY, surface);
        builder.cameras.push(Camera::look_at(DVec3::Z * 5.0, DVec3::ZERO, DVec3::Y, 40.0).unwrap());
        let scene = builder.finish().unwrap();
        let coarse = PatchMesh::new(&scene, 16.0, 2, &Quartered::These(HashSet::new())).unwrap();
        assert_eq!(coarse.patches.len(), 2 * 16);
        let root = coarse.nodes[5];
        let mut quartered = HashSet::from([(0, false, root)]);
        let finer = PatchMesh::new(&scene, 16.0, 2, &Quartered::These(quartered.clone())).unwrap();
        quartered.extend(finer.nodes.iter().filter(|node| node.level == 1).take(1).map(|node| (0, false, *node)));
        let mesh = PatchMesh::new(&scene, 16.0, 2, &Quartered::These(quartered)).unwrap();
        assert_eq!(mesh.patches.len(), 2 * 16 + 3 + 3);
        let values: Vec<f32> = (0..mesh.patches.len()).map(|patch| ((patch * 7919) % 101) as f32).collect();
        let mut shapes = super::super::faces::faces(&scene);
        shapes.iter_mut().for_each(|face| face.divide(2.0 / 16.0, 2));
        let hooks = hooks(&mesh, &shapes);
        // Four around the quartered patch's rim, and two of the smallest, of which two more lie on its own rim.
        assert!(hooks.len() >= 6, "{}", hooks.len());
        for (vertex, hook) in hooks {
            let [a, b] = hook.ends.map(|end| value(&mesh, end, &values));
            let expected = a + hook.share * (b - a);
            assert!((value(&mesh, vertex, &values) - expected).abs() < 1e-3, "{vertex}");
        }
    }
}
