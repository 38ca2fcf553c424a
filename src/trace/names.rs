//! What a vertex lies on: the names of its shape and material.

use crate::layout::{
    LIGHTS, MATERIALS, MUTATION_BEGINS, MUTATION_BIDIRECTIONAL, MUTATION_CAUSTIC, MUTATION_LARGE, MUTATION_LENS,
    MUTATION_MULTI_CHAIN, MUTATION_RUN, NONE, PathRecord, RECORDED_LIGHT, SURFACE_MASK,
};
use crate::render::DeviceScene;
use crate::scene::{NamedShape, Scene};

/// The name of the shape that a vertex lies on, where it has one.
pub(super) fn shape(scene: &Scene, on_device: &DeviceScene, record: &PathRecord) -> Option<String> {
    if record.flags & RECORDED_LIGHT != 0 {
        return light(scene, record.primitive);
    }
    let primitive = *on_device.order().get(record.primitive as usize)?;
    let shape = scene.shapes.iter().find(|shape| shape.primitives.contains(&primitive))?;
    (!shape.name.is_empty()).then(|| shape.name.clone())
}

/// The name of a light that was sampled: of its shape, where it has one.
fn light(scene: &Scene, index: u32) -> Option<String> {
    let light = scene.lights.get(index as usize)?;
    let kind = LIGHTS.get(light.kind as usize)?;
    let of_light = |primitive: u32| {
        scene.primitives.get(primitive as usize).is_some_and(|one| one.surface & SURFACE_MASK == light.source)
    };
    let of_shape = |shape: &&NamedShape| !kind.delta && shape.primitives.clone().any(of_light);
    let shape = scene.shapes.iter().find(of_shape).filter(|shape| !shape.name.is_empty());
    Some(shape.map_or_else(|| format!("{} light {index}", kind.prefix), |shape| shape.name.clone()))
}

/// The material of the surface of a light that was sampled.
fn light_material(scene: &Scene, index: u32) -> Option<u32> {
    let light = scene.lights.get(index as usize).filter(|light| !LIGHTS[light.kind as usize].delta)?;
    scene.surfaces.get(light.source as usize).map(|surface| surface.front)
}

/// The word for a sort of mutation.
pub(super) fn mutation(sort: u32) -> &'static str {
    match sort {
        MUTATION_BEGINS => "bootstrap sample",
        MUTATION_LARGE => "large step",
        MUTATION_RUN => "large step until a light is met",
        MUTATION_BIDIRECTIONAL => "bidirectional mutation",
        MUTATION_LENS => "lens perturbation",
        MUTATION_MULTI_CHAIN => "multi-chain perturbation",
        MUTATION_CAUSTIC => "caustic perturbation",
        _ => "small step",
    }
}

/// The name of its material and the word for its kind; nothing where it reflects nothing.
pub(super) fn material(scene: &Scene, record: &PathRecord) -> Option<String> {
    let own = if record.flags & RECORDED_LIGHT != 0 {
        light_material(scene, record.primitive)
    } else {
        Some(record.material)
    };
    let index = own.filter(|material| *material != NONE)? as usize;
    let kind = MATERIALS.get(scene.materials.get(index)?.kind as usize)?.word;
    Some(match scene.material_names.get(index).and_then(Option::as_ref) {
        Some(name) => format!("'{name}' ({kind})"),
        None => format!("material {index} ({kind})"),
    })
}
