//! EXT_mesh_gpu_instancing: a node's mesh at many places.

use std::collections::BTreeMap;

use glam::{DAffine3, DQuat, DVec3};
use gltf::json::accessor::{ComponentType, Type};
use serde::Deserialize;

use super::accessors::Accessors;
use super::document::Node;
use crate::error::Result;

const NAME: &str = "EXT_mesh_gpu_instancing";
const TURNS: &[ComponentType] = &[ComponentType::F32, ComponentType::I8, ComponentType::I16];

#[derive(Deserialize)]
struct Instancing {
    #[serde(default)]
    attributes: BTreeMap<String, usize>,
}

/// The maps of a node's instances to the node: one that changes nothing where it has none. Attributes of other names are for applications.
pub(super) fn instances(accessors: Accessors, node: &Node, element: &str) -> Result<Vec<DAffine3>> {
    let document = accessors.document;
    let Some(Instancing { attributes }) = document.extension(&node.extensions, NAME, element)? else {
        return Ok(vec![DAffine3::IDENTITY]);
    };
    let place = |name: &str| format!("{element}.extensions.{NAME}.attributes.{name}");
    let read = |name: &str| {
        let index = attributes.get(name);
        index
            .map(|index| accessors.vectors::<3>(*index, &place(name), &[Type::Vec3], &[ComponentType::F32], 0.0))
            .transpose()
    };
    let (translations, scales) = (read("TRANSLATION")?, read("SCALE")?);
    let rotations = attributes.get("ROTATION");
    let rotations = rotations
        .map(|index| accessors.vectors::<4>(*index, &place("ROTATION"), &[Type::Vec4], TURNS, 0.0))
        .transpose()?;
    let counts = [translations.as_ref().map(Vec::len), rotations.as_ref().map(Vec::len), scales.as_ref().map(Vec::len)];
    let mut counts = counts.into_iter().flatten();
    let count = counts.next().unwrap_or(0);
    if counts.any(|other| other != count) {
        return Err(document.wrong(element, format!("the attributes of its {NAME} have different numbers of elements")));
    }
    let vector = |values: &Option<Vec<[f32; 3]>>, index: usize, default: DVec3| {
        values.as_ref().map_or(default, |values| DVec3::from(values[index].map(f64::from)))
    };
    let map = |index: usize| {
        let rotation =
            rotations.as_ref().map_or(DQuat::IDENTITY, |values| DQuat::from_array(values[index].map(f64::from)));
        if rotation.length_squared() == 0.0 {
            return Err(document.wrong(&place("ROTATION"), format!("element {index} is not a quaternion of length 1")));
        }
        Ok(DAffine3::from_scale_rotation_translation(
            vector(&scales, index, DVec3::ONE),
            rotation.normalize(),
            vector(&translations, index, DVec3::ZERO),
        ))
    };
    (0..count).map(map).collect()
}
