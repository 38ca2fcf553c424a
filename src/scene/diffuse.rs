//! What a technique that knows diffuse surfaces alone makes of a scene.

use super::Scene;
use crate::layout::{MATERIAL_BLEND, MATERIAL_DIFFUSE, MATERIALS};

impl Scene {
    /// The materials in use that are not diffuse: by name, where they have one, and kind. Of a blend those that it is made of.
    pub fn not_diffuse(&self) -> Vec<String> {
        let others = self.materials_in_use().into_iter();
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
