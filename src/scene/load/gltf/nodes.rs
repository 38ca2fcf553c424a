//! The hierarchy of nodes: where everything stands, and the meshes that it places.

use std::collections::HashMap;
use std::rc::Rc;

use glam::{DAffine3, DMat4, DQuat, DVec3, Vec4};

use super::accessors::Accessors;
use super::buffers::Buffers;
use super::document::{Document, Node, SceneEntry};
use super::instancing;
use super::materials::Materials;
use super::pose::{self, Pose};
use super::primitives::Primitives;
use crate::error::Result;
use crate::scene::description::WORLD;
use crate::scene::load::limits::{JOINTS, SHAPES};
use crate::scene::{Mesh, SceneBuilder, single};

/// A node where it stands.
#[derive(Clone, Copy, Debug)]
pub(super) struct Placement {
    /// Its index.
    pub node: usize,
    /// World from node.
    pub to_world: DAffine3,
}

impl Placement {
    /// Its name in messages.
    pub fn element(&self) -> String {
        format!("nodes[{}]", self.node)
    }
}

/// All nodes of a scene, parents before their children.
pub(super) fn placements(document: &Document, scene: &SceneEntry) -> Result<Vec<Placement>> {
    let mut seen = vec![false; document.nodes.len()];
    let mut placements = Vec::new();
    let mut waiting: Vec<(usize, DAffine3, Option<usize>)> =
        scene.nodes.iter().rev().map(|node| (*node, DAffine3::IDENTITY, None)).collect();
    while let Some((index, above, parent)) = waiting.pop() {
        let from = parent.map_or_else(|| scene.element.clone(), |parent| format!("nodes[{parent}]"));
        let node = document.get(&document.nodes, "nodes", index, &from)?;
        let element = format!("nodes[{index}]");
        // A tree: so that there is no cycle, and that no few nodes stand for very many.
        if std::mem::replace(&mut seen[index], true) {
            return Err(document.wrong(&from, format!("its child {element} has another parent, or is above it")));
        }
        let to_world = above * local(document, node, &element)?;
        document.computed(&element, "where it stands", to_world.to_cols_array())?;
        placements.push(Placement { node: index, to_world });
        waiting.extend(node.children.iter().rev().map(|child| (*child, to_world, Some(index))));
    }
    Ok(placements)
}

/// Parent from node.
fn local(document: &Document, node: &Node, element: &str) -> Result<DAffine3> {
    if let Some(matrix) = node.matrix {
        let matrix = DMat4::from_cols_array(&matrix);
        let last = matrix.row(3) - glam::DVec4::W;
        if last.abs().max_element() > 1e-6 || last.is_nan() {
            return Err(document.wrong(element, "the last row of its matrix must be 0, 0, 0, 1"));
        }
        return Ok(DAffine3::from_mat4(matrix));
    }
    let rotation = DQuat::from_array(node.rotation.unwrap_or([0.0, 0.0, 0.0, 1.0]));
    if !(rotation.length_squared() > 0.0 && rotation.length_squared().is_finite()) {
        return Err(document.wrong(element, "its rotation is not a quaternion of length 1"));
    }
    let translation = DVec3::from(node.translation.unwrap_or_default());
    let scale = DVec3::from(node.scale.unwrap_or([1.0; 3]));
    Ok(DAffine3::from_scale_rotation_translation(scale, rotation.normalize(), translation))
}

/// A mesh of the file in the builder.
#[derive(Clone, Debug)]
enum Built {
    /// In a group, to be placed by instances.
    Group(usize),
    /// To be put into the world at each place: meshes, their surfaces and names.
    Parts(Vec<(Mesh, usize, String)>),
}

/// Where a mesh is to stand.
struct Place {
    mesh: usize,
    to_world: DAffine3,
    /// That of a mesh with a pose of its own, which is nowhere else.
    pose: Option<Pose>,
}

/// The places of the meshes that nodes carry. What is scaled to nothing is left out.
fn places(
    document: &Document,
    accessors: Accessors,
    placements: &[Placement],
    warnings: &mut Vec<String>,
) -> Result<Vec<Place>> {
    let stands: HashMap<usize, DAffine3> =
        placements.iter().map(|placement| (placement.node, placement.to_world)).collect();
    let mut places = Vec::new();
    let mut skins: HashMap<usize, Rc<[DAffine3]>> = HashMap::new();
    let mut joints_so_far = 0;
    let too_many = |element: &str, what: &str, most: u32| {
        document.wrong(element, format!("the scene has more than {most} {what} by here, and no more are read"))
    };
    for placement in placements {
        let (node, element) = (&document.nodes[placement.node], placement.element());
        let Some(mesh) = node.mesh else { continue };
        let weights = &document.get(&document.meshes, "meshes", mesh, &element)?.weights;
        let weights = || weights.iter().flatten().map(|weight| f64::from(*weight)).collect();
        let own_weights: Option<Rc<[f64]>> = node.weights.as_ref().map(|weights| Rc::from(&weights[..]));
        if let Some(skin) = node.skin {
            // Its joints place it, and not the node.
            let joints = match skins.get(&skin) {
                Some(known) => known.clone(),
                None => {
                    joints_so_far += pose::joint_count(document, skin, &element)?;
                    if joints_so_far > u64::from(JOINTS) {
                        return Err(too_many(&element, "joints of skins and matrices for them", JOINTS));
                    }
                    let made = pose::joints(accessors, skin, &element, |node| stands.get(&node).copied())?;
                    skins.entry(skin).or_insert(made.into()).clone()
                }
            };
            if places.len() >= SHAPES as usize {
                return Err(too_many(&element, "placed meshes", SHAPES));
            }
            let pose = Pose { weights: own_weights.unwrap_or_else(weights), joints: Some(joints) };
            places.push(Place { mesh, to_world: DAffine3::IDENTITY, pose: Some(pose) });
            continue;
        }
        let instances = instancing::instances(accessors, node, &element)?;
        if places.len() + instances.len() > SHAPES as usize {
            return Err(too_many(&element, "placed meshes, instances counted,", SHAPES));
        }
        let mut is_left_out = false;
        for to_node in instances {
            let to_world = placement.to_world * to_node;
            if to_world.matrix3.determinant() == 0.0 {
                is_left_out = true;
                continue;
            }
            document.computed(&element, "where its instance stands", to_world.to_cols_array())?;
            if to_world.inverse().to_cols_array().into_iter().any(|value| !single::fits(value)) {
                return Err(document.wrong(&element, "its scale is too large or too small to be undone"));
            }
            let pose = own_weights.clone().map(|weights| Pose { weights, joints: None });
            places.push(Place { mesh, to_world, pose });
        }
        if is_left_out {
            warnings.push(format!("{element}: it is scaled to nothing, and its mesh is left out"));
        }
    }
    Ok(places)
}

/// Adds the meshes that nodes carry. One that several nodes use becomes a group that instances place; one that is used once
/// or emits goes into the world.
pub(super) fn load_meshes(
    document: &Document,
    buffers: &Buffers,
    placements: &[Placement],
    builder: &mut SceneBuilder,
) -> Result<()> {
    let accessors = Accessors { document, buffers };
    let places = places(document, accessors, placements, &mut builder.warnings)?;
    let mut materials = Materials::new(document, buffers);
    let mut primitives = Primitives::new(accessors);
    let mut uses = vec![0usize; document.meshes.len()];
    let mut mirrored = vec![false; document.meshes.len()];
    for place in places.iter().filter(|place| place.pose.is_none()) {
        uses[place.mesh] += 1;
        mirrored[place.mesh] |= place.to_world.matrix3.determinant() < 0.0;
    }
    let mut built: Vec<Option<Built>> = vec![None; document.meshes.len()];
    for Place { mesh: index, to_world, pose } in places {
        if pose.is_none() {
            uses[index] -= 1;
        }
        let is_last = pose.is_some() || uses[index] == 0;
        let known = if pose.is_none() { built[index].take() } else { None };
        let mesh = match known {
            Some(mesh) => mesh,
            None => {
                let use_ = Use { index, is_shared: !is_last, is_mirrored: mirrored[index], pose };
                build(document, &mut materials, &mut primitives, use_, builder)?
            }
        };
        let mut put = |mesh: Mesh, surface: usize, name: &str| {
            builder.mesh(WORLD, name, placed(mesh, to_world), to_world, surface);
        };
        match mesh {
            Built::Group(group) => {
                builder.instance(group, to_world);
                built[index] = Some(mesh);
            }
            Built::Parts(parts) if is_last => {
                parts.into_iter().for_each(|(mesh, surface, name)| put(mesh, surface, &name))
            }
            Built::Parts(parts) => {
                for (mesh, surface, name) in &parts {
                    // What is read once and put into the world again counts again.
                    primitives.count(name, mesh.positions.len() + mesh.triangles.len())?;
                    put(mesh.clone(), *surface, name);
                }
                built[index] = Some(Built::Parts(parts));
            }
        }
    }
    Ok(())
}

/// A mesh as it must be to be placed by that map.
fn placed(mesh: Mesh, to_world: DAffine3) -> Mesh {
    if to_world.matrix3.determinant() >= 0.0 {
        return mesh;
    }
    // A mirror turns the order of the corners round, by which alone a flat mesh tells its front, and takes a bitangent to
    // the other side of the normal and the tangent.
    let is_flat = mesh.normals.is_empty();
    let mut mesh = mesh.turned(is_flat);
    mesh.tangents.iter_mut().for_each(|tangent: &mut Vec4| tangent.w = -tangent.w);
    mesh
}

/// What is to be built of a mesh.
struct Use {
    index: usize,
    /// It stands elsewhere, too.
    is_shared: bool,
    /// Some place mirrors it.
    is_mirrored: bool,
    pose: Option<Pose>,
}

fn build(
    document: &Document,
    materials: &mut Materials,
    primitives: &mut Primitives,
    Use { index, is_shared, is_mirrored, pose }: Use,
    builder: &mut SceneBuilder,
) -> Result<Built> {
    let mut parts = Vec::new();
    let mut needs_world = !is_shared;
    let mesh = document.get(&document.meshes, "meshes", index, "nodes")?;
    let pose = pose.unwrap_or_else(|| Pose {
        weights: mesh.weights.iter().flatten().map(|weight| f64::from(*weight)).collect(),
        joints: None,
    });
    for (number, primitive) in mesh.primitives.iter().enumerate() {
        let element = format!("meshes[{index}].primitives[{number}]");
        let material = materials.get(builder, primitive.material.map(|index| index.value()), &element)?;
        let Some(mesh) = primitives.read(primitive, &element, material.wanted, &pose, &mut builder.warnings)? else {
            continue;
        };
        if !mesh.colours.is_empty() {
            material.with_colours(builder, mesh.colours.iter().any(|colour| colour.w < 1.0));
        }
        // An instance has one sign of the bitangent for all its placements.
        needs_world |= material.emits || (is_mirrored && !mesh.tangents.is_empty());
        parts.push((mesh, material.surface, element));
    }
    if needs_world || parts.is_empty() {
        return Ok(Built::Parts(parts));
    }
    let group = builder.group(&format!("meshes[{index}]"));
    for (mesh, surface, name) in parts {
        builder.mesh(group, &name, mesh, DAffine3::IDENTITY, surface);
    }
    Ok(Built::Group(group))
}
