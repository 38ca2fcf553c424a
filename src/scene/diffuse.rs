//! What a technique that knows diffuse surfaces alone makes of a scene.

use super::Scene;
use crate::layout::{MATERIAL_BLEND, MATERIAL_DIFFUSE, MATERIALS, NONE};

impl Scene {
    /// The materials in use that are not diffuse: by name, where they have one, and kind. Of a blend those that it is made of.
    pub fn not_diffuse(&self) -> Vec<String> {
        let mut pending: Vec<u32> = self.surfaces.iter().flat_map(|surface| [surface.front, surface.back]).collect();
        let mut seen = vec![false; self.materials.len()];
        while let Some(index) = pending.pop() {
            if index == NONE || std::mem::replace(&mut seen[index as usize], true) {
                continue;
            }
            let material = &self.materials[index as usize];
            if material.kind == MATERIAL_BLEND {
                let blend = &self.blends[material.detail as usize];
                pending.extend([blend.first, blend.second]);
            }
        }
        let others = (0..self.materials.len()).filter(|index| seen[*index]);
        let others = others.filter(|index| !matches!(self.materials[*index].kind, MATERIAL_DIFFUSE | MATERIAL_BLEND));
        let called = |index: usize| {
            let kind = MATERIALS[self.materials[index].kind as usize].word;
            match self.material_names.get(index).and_then(Option::as_ref) {
                Some(name) => format!("'{name}' ({kind})"),
                None => format!("material {index} ({kind})"),
            }
        };
        others.map(called).collect()
    }
}
