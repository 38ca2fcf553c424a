//! What a vertex lies on: the names of its shape and material.

use crate::layout::{MATERIALS, NONE, PathRecord};
use crate::render::DeviceScene;
use crate::scene::Scene;

/// The name of the shape that a vertex lies on, where it has one.
pub(super) fn shape(scene: &Scene, on_device: &DeviceScene, record: &PathRecord) -> Option<String> {
    let primitive = *on_device.order().get(record.primitive as usize)?;
    let shape = scene.shapes.iter().find(|shape| shape.primitives.contains(&primitive))?;
    (!shape.name.is_empty()).then(|| shape.name.clone())
}

/// The name of its material and the word for its kind; nothing where it reflects nothing.
pub(super) fn material(scene: &Scene, record: &PathRecord) -> Option<String> {
    if record.material == NONE {
        return None;
    }
    let index = record.material as usize;
    let kind = MATERIALS.get(scene.materials.get(index)?.kind as usize)?.word;
    Some(match scene.material_names.get(index).and_then(Option::as_ref) {
        Some(name) => format!("'{name}' ({kind})"),
        None => format!("material {index} ({kind})"),
    })
}
