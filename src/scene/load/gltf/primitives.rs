//! Primitives of meshes as triangles.

use glam::{DVec3, Vec2, Vec3, Vec4};
use gltf::json::accessor::{ComponentType, Type};
use gltf::json::mesh::{Mode, Primitive, Semantic};
use gltf::json::validation::Checked;

use super::accessors::Accessors;
use super::pose::{self, Pose};
use crate::error::Result;
use crate::scene::Mesh;
use crate::scene::description::ELEMENTS;
use crate::scene::load::tangents;

const SMALL: &[ComponentType] =
    &[ComponentType::F32, ComponentType::I8, ComponentType::U8, ComponentType::I16, ComponentType::U16];
const SIGNED: &[ComponentType] = &[ComponentType::F32, ComponentType::I8, ComponentType::I16];
const UNSIGNED: &[ComponentType] = &[ComponentType::F32, ComponentType::U8, ComponentType::U16];

/// An extension that is not read.
const DRACO: &str = "KHR_draco_mesh_compression";

/// What a material takes of its primitives.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Wanted {
    /// The sets of texture coordinates: the first and the second of a mesh.
    pub uv_sets: [Option<u32>; 2],
    /// Tangents, for a normal map or anisotropy; along the second set where true.
    pub tangents: Option<bool>,
    /// Vertex colours.
    pub colours: bool,
    /// The alpha of vertex colours.
    pub opacity: bool,
}

/// Reads primitives.
pub(super) struct Primitives<'a> {
    pub accessors: Accessors<'a>,
    /// Vertices and triangles so far: many meshes may share the same few bytes.
    elements: u64,
}

impl<'a> Primitives<'a> {
    pub fn new(accessors: Accessors<'a>) -> Self {
        Self { accessors, elements: 0 }
    }

    /// Counts vertices and triangles that the scene is to hold.
    pub fn count(&mut self, element: &str, more: usize) -> Result<()> {
        self.elements += more as u64;
        if self.elements > ELEMENTS {
            return Err(self.accessors.document.wrong(
                element,
                format!("the scene has more than {ELEMENTS} vertices and triangles by here, and no more are read"),
            ));
        }
        Ok(())
    }

    /// A primitive as a mesh; nothing where it has no triangles.
    pub fn read(
        &mut self,
        primitive: &Primitive,
        element: &str,
        wanted: Wanted,
        pose: &Pose,
        warnings: &mut Vec<String>,
    ) -> Result<Option<Mesh>> {
        let (accessors, document) = (self.accessors, self.accessors.document);
        let Checked::Valid(mode) = primitive.mode else {
            return Err(document.wrong(element, "its mode is unknown: valid are 0 to 6"));
        };
        if !matches!(mode, Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan) {
            warnings.push(format!("{element}: points and lines are not read"));
            return Ok(None);
        }
        let attribute = |semantic: Semantic| {
            let name = format!("{element}.attributes.{}", semantic.to_string());
            primitive.attributes.get(&Checked::Valid(semantic)).map(|accessor| (accessor.value(), name))
        };
        let compressed = primitive.extensions.as_ref().is_some_and(|others| others.others.contains_key(DRACO));
        let has_data = |(accessor, _): &(usize, String)| {
            document.accessors.get(*accessor).is_none_or(|accessor| accessor.buffer_view.is_some())
        };
        if compressed && !attribute(Semantic::Positions).as_ref().is_some_and(has_data) {
            return Err(
                document.wrong(element, format!("its data are in {DRACO}, which is not read: decompress it before"))
            );
        }
        let Some((positions, name)) = attribute(Semantic::Positions) else {
            return Err(document.wrong(element, "it has no POSITION"));
        };
        let positions = accessors.vectors::<3>(positions, &name, &[Type::Vec3], SMALL, 0.0)?;
        self.count(element, positions.len())?;
        let same = |name: &str, count: usize| {
            if count == positions.len() {
                return Ok(());
            }
            Err(document.wrong(name, format!("has {count} elements, and POSITION has {}", positions.len())))
        };
        let mut mesh =
            Mesh { triangles: self.triangles(primitive, element, mode, positions.len())?, ..Mesh::default() };
        if let Some((index, name)) = attribute(Semantic::Normals) {
            let normals = accessors.vectors::<3>(index, &name, &[Type::Vec3], SIGNED, 0.0)?;
            same(&name, normals.len())?;
            mesh.normals = normals.into_iter().map(Vec3::from).collect();
        }
        for (place, set) in wanted.uv_sets.into_iter().enumerate() {
            let Some(set) = set else { continue };
            let uvs = match attribute(Semantic::TexCoords(set)) {
                Some((index, name)) => {
                    let uvs = accessors.vectors::<2>(index, &name, &[Type::Vec2], SMALL, 0.0)?;
                    same(&name, uvs.len())?;
                    uvs.into_iter().map(Vec2::from).collect()
                }
                None => {
                    warnings.push(format!("{element}: its material has textures, and it has no TEXCOORD_{set}"));
                    vec![Vec2::ZERO; positions.len()]
                }
            };
            *if place == 0 { &mut mesh.uvs } else { &mut mesh.second_uvs } = uvs;
        }
        if wanted.tangents == Some(false) && mesh.uvs.is_empty() {
            // Only to place tangents by: those that are missing are none.
            if let Some((index, name)) = attribute(Semantic::TexCoords(0)) {
                let uvs = accessors.vectors::<2>(index, &name, &[Type::Vec2], SMALL, 0.0)?;
                same(&name, uvs.len())?;
                mesh.uvs = uvs.into_iter().map(Vec2::from).collect();
            }
        }
        if let Some((index, name)) = attribute(Semantic::Colors(0)).filter(|_| wanted.colours) {
            let colours = accessors.vectors::<4>(index, &name, &[Type::Vec3, Type::Vec4], UNSIGNED, 1.0)?;
            same(&name, colours.len())?;
            let counted = |[r, g, b, a]: [f32; 4]| Vec4::new(r, g, b, if wanted.opacity { a } else { 1.0 });
            mesh.colours = colours.into_iter().map(|colour| counted(colour).clamp(Vec4::ZERO, Vec4::ONE)).collect();
        }
        mesh.positions = positions.into_iter().map(|position| Vec3::from(position).as_dvec3()).collect::<Vec<DVec3>>();
        if wanted.tangents.is_some() {
            // Tangents without normals are to be ignored.
            if let Some((index, name)) = attribute(Semantic::Tangents).filter(|_| !mesh.normals.is_empty()) {
                let tangents = accessors.vectors::<4>(index, &name, &[Type::Vec4], SIGNED, 1.0)?;
                if tangents.len() != mesh.positions.len() {
                    let (found, wanted) = (tangents.len(), mesh.positions.len());
                    return Err(document.wrong(&name, format!("has {found} elements, and POSITION has {wanted}")));
                }
                mesh.tangents = tangents.into_iter().map(Vec4::from).collect();
            }
        }
        pose::apply(accessors, primitive, element, pose, &mut mesh)?;
        let places = |by_second: &bool| if *by_second { !mesh.second_uvs.is_empty() } else { !mesh.uvs.is_empty() };
        if let Some(by_second_uvs) = wanted.tangents.filter(|_| mesh.tangents.is_empty()).filter(places) {
            mesh = tangents::with_tangents(mesh, by_second_uvs);
        }
        Ok((!mesh.triangles.is_empty()).then_some(mesh))
    }

    fn triangles(
        &mut self,
        primitive: &Primitive,
        element: &str,
        mode: Mode,
        vertices: usize,
    ) -> Result<Vec<[u32; 3]>> {
        let document = self.accessors.document;
        let indices: Vec<u32> = match primitive.indices {
            Some(index) => {
                let name = format!("{element}.indices");
                let indices = self.accessors.indices(index.value(), &name)?;
                if let Some(place) = indices.iter().position(|vertex| *vertex as usize >= vertices) {
                    return Err(document.wrong(
                        &name,
                        format!(
                            "accessor {index}: element {place} refers to vertex {}, and there are {vertices}",
                            indices[place]
                        ),
                    ));
                }
                indices
            }
            None => (0..vertices as u32).collect(),
        };
        // The orders of glTF 2.0, section 3.7.2.1.
        let triangles: Vec<[u32; 3]> = match mode {
            Mode::TriangleStrip => indices
                .windows(3)
                .enumerate()
                .map(|(index, w)| if index % 2 == 0 { [w[0], w[1], w[2]] } else { [w[0], w[2], w[1]] })
                .collect(),
            Mode::TriangleFan => {
                indices.windows(2).skip(1).map(|w| [w[0], w[1], indices.first().copied().unwrap_or_default()]).collect()
            }
            _ => indices.chunks_exact(3).map(|c| [c[0], c[1], c[2]]).collect(),
        };
        self.count(element, triangles.len())?;
        Ok(triangles)
    }
}
