//! How a mesh stands: its morph targets at their weights, and its skin over the joints where the file places them.

use std::rc::Rc;

use glam::{DAffine3, DMat4, DVec3, Vec3};
use gltf::json::accessor::{ComponentType, Type};
use gltf::json::mesh::{MorphTarget, Primitive, Semantic};
use gltf::json::validation::Checked;

use super::accessors::Accessors;
use super::document::Document;
use crate::error::Result;
use crate::scene::Mesh;

const SMALL: &[ComponentType] =
    &[ComponentType::F32, ComponentType::I8, ComponentType::U8, ComponentType::I16, ComponentType::U16];

/// How a mesh stands.
#[derive(Clone, Debug, Default)]
pub(super) struct Pose {
    /// Of each morph target; those that are missing are 0.
    pub weights: Rc<[f64]>,
    /// World from bind pose, of each joint of a skin.
    pub joints: Option<Rc<[DAffine3]>>,
}

/// How many maps [`joints`] makes and reads for a skin, be they needed or not.
pub(super) fn joint_count(document: &Document, skin: usize, element: &str) -> Result<u64> {
    let skin = document.get(&document.skins, "skins", skin, element)?;
    let matrices = skin.inverse_bind_matrices.and_then(|index| document.accessors.get(index));
    Ok(matrices.map_or(0, |accessor| accessor.count.0).max(skin.joints.len() as u64))
}

/// The maps of a skin's joints, given where nodes stand; `element` is what refers to it.
pub(super) fn joints(
    accessors: Accessors,
    skin: usize,
    element: &str,
    place: impl Fn(usize) -> Option<DAffine3>,
) -> Result<Vec<DAffine3>> {
    let document = accessors.document;
    let skin_name = format!("skins[{skin}]");
    let skin = document.get(&document.skins, "skins", skin, element)?;
    let inverse: Vec<[f32; 16]> = match skin.inverse_bind_matrices {
        None => vec![DMat4::IDENTITY.as_mat4().to_cols_array(); skin.joints.len()],
        Some(index) => {
            let name = format!("{skin_name}.inverseBindMatrices");
            accessors.vectors(index, &name, &[Type::Mat4], &[ComponentType::F32], 0.0)?
        }
    };
    if inverse.len() < skin.joints.len() {
        let (found, needed) = (inverse.len(), skin.joints.len());
        return Err(document.wrong(&skin_name, format!("it has {found} inverseBindMatrices for {needed} joints")));
    }
    let map = |(joint, inverse): (&usize, &[f32; 16])| {
        let place = place(*joint).ok_or_else(|| {
            document.wrong(&skin_name, format!("its joint nodes[{joint}] does not belong to the scene that is read"))
        })?;
        let map = place * DAffine3::from_mat4(DMat4::from_cols_array(&inverse.map(f64::from)));
        document.computed(&skin_name, &format!("where its joint nodes[{joint}] stands"), map.to_cols_array())?;
        Ok(map)
    };
    skin.joints.iter().zip(&inverse).map(map).collect()
}

/// Puts a mesh that was just read, with the vertices of its file, into a pose.
pub(super) fn apply(
    accessors: Accessors,
    primitive: &Primitive,
    element: &str,
    pose: &Pose,
    mesh: &mut Mesh,
) -> Result<()> {
    for (number, target) in primitive.targets.iter().flatten().enumerate() {
        let weight = pose.weights.get(number).copied().unwrap_or(0.0);
        if weight != 0.0 {
            morph(accessors, target, &format!("{element}.targets[{number}]"), weight, mesh)?;
        }
    }
    if !mesh.normals.is_empty() && primitive.targets.is_some() {
        mesh.normals.iter_mut().for_each(|normal| *normal = normal.normalize_or_zero());
    }
    match &pose.joints {
        Some(joints) => skin(accessors, primitive, element, joints, mesh),
        None => Ok(()),
    }
}

/// Adds what a target moves.
fn morph(accessors: Accessors, target: &MorphTarget, element: &str, weight: f64, mesh: &mut Mesh) -> Result<()> {
    let count = mesh.positions.len();
    let read = |name: &str, index: usize| {
        let name = format!("{element}.{name}");
        let moves = accessors.vectors::<3>(index, &name, &[Type::Vec3], SMALL, 0.0)?;
        if moves.len() != count {
            let found = moves.len();
            return Err(accessors.document.wrong(&name, format!("has {found} elements, and POSITION has {count}")));
        }
        Ok(moves)
    };
    if let Some(index) = target.positions {
        let moves = read("POSITION", index.value())?;
        mesh.positions.iter_mut().zip(moves).for_each(|(to, by)| *to += weight * Vec3::from(by).as_dvec3());
    }
    let weight = weight as f32;
    if let Some(index) = target.normals.filter(|_| !mesh.normals.is_empty()) {
        let moves = read("NORMAL", index.value())?;
        mesh.normals.iter_mut().zip(moves).for_each(|(to, by)| *to += weight * Vec3::from(by));
    }
    if let Some(index) = target.tangents.filter(|_| !mesh.tangents.is_empty()) {
        let moves = read("TANGENT", index.value())?;
        mesh.tangents.iter_mut().zip(moves).for_each(|(to, by)| *to += (weight * Vec3::from(by)).extend(0.0));
    }
    Ok(())
}

/// Moves each vertex by the weighted mean of its joints' maps (glTF 2.0, section 3.7.3.1), to where it stands in the world.
fn skin(
    accessors: Accessors,
    primitive: &Primitive,
    element: &str,
    joints: &[DAffine3],
    mesh: &mut Mesh,
) -> Result<()> {
    let document = accessors.document;
    let count = mesh.positions.len();
    let mut maps = vec![(DAffine3::ZERO, 0.0f64); count];
    for set in 0u32.. {
        let attribute =
            |semantic: Semantic| primitive.attributes.get(&Checked::Valid(semantic)).map(|index| index.value());
        let (Some(joint_set), Some(weight_set)) = (attribute(Semantic::Joints(set)), attribute(Semantic::Weights(set)))
        else {
            break;
        };
        let name = format!("{element}.attributes.JOINTS_{set}");
        let whole = &[ComponentType::U8, ComponentType::U16];
        let indices = accessors.vectors::<4>(joint_set, &name, &[Type::Vec4], whole, 0.0)?;
        let shares = &[ComponentType::F32, ComponentType::U8, ComponentType::U16];
        let weights_name = format!("{element}.attributes.WEIGHTS_{set}");
        let weights = accessors.vectors::<4>(weight_set, &weights_name, &[Type::Vec4], shares, 0.0)?;
        if indices.len() != count || weights.len() != count {
            let (found, other) = (indices.len(), weights.len());
            return Err(document.wrong(
                &name,
                format!("it and its weights have {found} and {other} elements, and POSITION has {count}"),
            ));
        }
        for ((map, indices), weights) in maps.iter_mut().zip(indices).zip(weights) {
            for (joint, weight) in indices.into_iter().zip(weights).filter(|(_, weight)| *weight != 0.0) {
                let Some(place) = joints.get(joint as usize) else {
                    let last = joints.len();
                    return Err(document.wrong(&name, format!("refers to joint {joint}, and the skin has {last}")));
                };
                let weight = f64::from(weight);
                map.0.matrix3 += place.matrix3 * weight;
                map.0.translation += place.translation * weight;
                map.1 += weight;
            }
        }
    }
    for (index, (map, total)) in maps.into_iter().enumerate() {
        // What no joint holds stays with the first.
        let map = match total {
            total if total > 0.0 => {
                DAffine3 { matrix3: map.matrix3 * total.recip(), translation: map.translation / total }
            }
            _ => joints.first().copied().unwrap_or(DAffine3::IDENTITY),
        };
        mesh.positions[index] = map.transform_point3(mesh.positions[index]);
        let for_normals = map.matrix3.inverse().transpose();
        if let Some(normal) = mesh.normals.get_mut(index) {
            let turned: DVec3 = for_normals * normal.as_dvec3();
            *normal = if turned.is_finite() { turned.normalize_or_zero().as_vec3() } else { *normal };
        }
        if let Some(tangent) = mesh.tangents.get_mut(index) {
            let turned = (map.matrix3 * tangent.truncate().as_dvec3()).normalize_or_zero();
            *tangent = turned.as_vec3().extend(tangent.w);
        }
    }
    Ok(())
}
