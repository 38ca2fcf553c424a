//! OBJ meshes: with their MTL materials as a scene of their own, or as bare geometry for a Mitsuba shape.

mod lines;
mod materials;
mod mtl;
mod statements;
mod textures;

use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::path::{Path, PathBuf};

use glam::{DAffine3, DVec3, Vec2, Vec3, Vec4};

use super::{polygons, tangents};
use crate::error::{Error, Result, all_of};
use crate::image::srgb_to_linear;
use crate::layout::MATERIAL_HAS_COLOURS;
use crate::scene::description::WORLD;
use crate::scene::{Mesh, SceneBuilder};
use materials::{Loaded, Materials};
use statements::{Names, Part, Statements};
use textures::Textures;

/// Faces keep their corners: polygons are cut here.
const OPTIONS: tobj::LoadOptions =
    tobj::LoadOptions { single_index: true, triangulate: false, ignore_points: true, ignore_lines: true };

/// Names that a warning lists at most.
const LISTED: usize = 8;

/// What an OBJ file holds.
struct Contents {
    parts: Vec<(Part, Mesh)>,
    names: Names,
    /// Some vertices have colours.
    has_colours: bool,
}

/// Reads all faces as one mesh, without materials. Vertices are shared between groups, as the file shares them; texture coordinates are as
/// the file gives them. Where some faces have normals, those of the others are computed; texture coordinates that are missing are 0.
pub(super) fn read_geometry(path: &Path) -> Result<Mesh> {
    let mut parts = read(path, false)?.parts.into_iter().map(|(_, mesh)| mesh);
    let mut all = parts.next().unwrap_or_default();
    for mut more in parts {
        for mesh in [&mut all, &mut more] {
            if mesh.normals.is_empty() {
                mesh.compute_normals();
            }
        }
        if all.uvs.len() + more.uvs.len() > 0 {
            all.uvs.resize(all.positions.len(), Vec2::ZERO);
            more.uvs.resize(more.positions.len(), Vec2::ZERO);
        }
        let first = all.positions.len() as u32;
        all.triangles.extend(more.triangles.iter().map(|triangle| triangle.map(|vertex| first + vertex)));
        all.positions.append(&mut more.positions);
        all.normals.append(&mut more.normals);
        all.uvs.append(&mut more.uvs);
    }
    Ok(all)
}

/// Reads a scene: each group with its material. `Ke` makes an area light; what is missing is a warning and grey. What is left is what
/// [`SceneBuilder::finish`] does.
pub fn load(path: &Path) -> Result<SceneBuilder> {
    let Contents { parts, names, has_colours } = read(path, true)?;
    let mut builder = SceneBuilder::new(path);
    warn(&names, &mut builder.warnings);
    let entries = entries(path, &names, &mut builder.warnings)?;
    let mut materials = Materials { builder: &mut builder, textures: Textures::default(), left_out: BTreeMap::new() };
    let mut loaded: HashMap<Option<usize>, Option<Loaded>> = HashMap::new();
    // What has colours of its own needs no other.
    let grey = materials.builder.material(crate::scene::material::diffuse([if has_colours { 1.0 } else { 0.5 }; 3]));
    let default = materials.builder.both_sides(grey);
    let mut unknown = BTreeSet::new();
    for (part, mesh) in parts {
        let name = part.material.map(|material| names.materials[material].as_str());
        let found = match loaded.get(&part.material) {
            Some(known) => *known,
            None => {
                let entry = name.and_then(|name| find(&entries, name));
                let made = entry.map(|(library, entry)| materials.add(library, entry)).transpose()?;
                loaded.insert(part.material, made);
                made
            }
        };
        unknown.extend(name.filter(|_| found.is_none()));
        let group = names.groups[part.group].as_str();
        // In OBJ files v runs upwards.
        let mut mesh = mesh.with_flipped_v(true);
        if let Some(found) = found.filter(|found| found.is_textured) {
            if mesh.uvs.is_empty() {
                let name = name.unwrap_or_default();
                materials
                    .builder
                    .warnings
                    .push(format!("'{group}' has no texture coordinates, and its material '{name}' has images"));
                mesh.uvs = vec![Vec2::ZERO; mesh.positions.len()];
            }
            if found.wants_tangents {
                mesh = tangents::with_tangents(mesh, false);
            }
        }
        let surface = found.map_or(default, |found| found.surface);
        materials.builder.mesh(WORLD, group, mesh, DAffine3::IDENTITY, surface);
    }
    if has_colours {
        for material in loaded.values().flatten().map(|loaded| loaded.material).chain([grey]) {
            materials.builder.material_mut(material).record.flags |= MATERIAL_HAS_COLOURS;
        }
    }
    let left_out = materials.left_out;
    if !left_out.is_empty() {
        let words = left_out.iter().map(|(word, count)| format!("{word} ({count})"));
        builder.warnings.push(format!("not read of its materials, with how many say it: {}", all_of(words)));
    }
    if !unknown.is_empty() {
        let names = listed(unknown.iter().map(|name| format!("'{name}'")));
        builder.warnings.push(format!("no MTL file has these materials, and they are grey: {names}"));
    }
    Ok(builder)
}

/// Says what of the file is not read.
fn warn(names: &Names, warnings: &mut Vec<String>) {
    if names.empty_material {
        warnings.push(String::from("a usemtl names no material: what follows it is grey"));
    }
    if names.small_faces > 0 {
        warnings.push(format!("{} faces of fewer than three corners are left out", names.small_faces));
    }
    if !names.skipped.is_empty() {
        let words = names.skipped.iter().map(|(word, count)| format!("'{word}' ({count})"));
        warnings.push(format!("statements that are not read: {}", all_of(words)));
    }
}

/// The first few of a list.
fn listed(names: impl ExactSizeIterator<Item = String>) -> String {
    let more = names.len().saturating_sub(LISTED);
    let text = all_of(names.take(LISTED));
    if more > 0 { format!("{text} (and {more} more)") } else { text }
}

/// A name without the comment that may stand behind it: names may have a `#` of their own.
fn without_note(name: &str) -> &str {
    name.split(" #").next().unwrap_or_default().trim_ascii_end()
}

/// A material of a library by its name, with or without a comment behind it.
fn find<'a>(
    entries: &'a HashMap<String, (PathBuf, tobj::Material)>,
    name: &str,
) -> Option<(&'a Path, &'a tobj::Material)> {
    let (path, entry) = entries.get(name).or_else(|| entries.get(without_note(name)))?;
    Some((path, entry))
}

/// The materials of all libraries that the file names, by name; of those in several, the one of the first.
fn entries(
    path: &Path,
    names: &Names,
    warnings: &mut Vec<String>,
) -> Result<HashMap<String, (PathBuf, tobj::Material)>> {
    let folder = path.parent().unwrap_or(Path::new(""));
    let mut entries = HashMap::new();
    let mut seen = BTreeSet::new();
    let libraries = names.libraries.iter().flat_map(|text| mtl::libraries(folder, text));
    for (count, library) in libraries.enumerate() {
        if count == mtl::MAX_LIBRARIES {
            warnings.push(format!("more than {count} MTL files are named, and the others are not read"));
            break;
        }
        if !seen.insert(library.clone()) {
            continue;
        }
        let (materials, has_nameless) = match mtl::read(&library) {
            Err(error @ Error::File { .. }) => {
                warnings.push(format!("{error}; its materials are grey"));
                continue;
            }
            read => read?,
        };
        if has_nameless {
            warnings.push(format!("{}: a newmtl names no material, and is left out", library.display()));
        }
        // Of those that a library has twice, the last.
        for material in materials.into_iter().rev() {
            let short = without_note(&material.name).to_owned();
            for name in [material.name.clone(), short] {
                entries.entry(name).or_insert((library.clone(), material.clone()));
            }
        }
    }
    Ok(entries)
}

fn read(path: &Path, is_scene: bool) -> Result<Contents> {
    let mut statements = Statements::open(path, is_scene, false)?;
    let no_materials = |_: &Path| Ok(Default::default());
    let mut read = tobj::load_obj_buf(&mut statements, &OPTIONS, no_materials);
    if statements.needs_colours {
        statements = Statements::open(path, is_scene, true)?;
        read = tobj::load_obj_buf(&mut statements, &OPTIONS, no_materials);
    }
    let (models, _) = read.map_err(|error| statements.error(error))?;
    let mut parts = Vec::new();
    for model in models.into_iter().filter(|model| !model.mesh.indices.is_empty()) {
        let part = model.name.parse().ok().and_then(|number: usize| statements.names.parts.get(number)).copied();
        let part = part.unwrap_or_default();
        let group = &statements.names.groups[part.group];
        let mesh = to_mesh(model.mesh).map_err(|message| Error::scene(path, format!("'{group}': {message}")))?;
        parts.push((part, mesh));
    }
    if parts.is_empty() {
        return Err(Error::scene(path, "the file has no faces"));
    }
    Ok(Contents { parts, names: statements.names, has_colours: statements.has_colours })
}

fn to_mesh(mesh: tobj::Mesh) -> Result<Mesh, String> {
    // Each array goes as soon as it is taken over: a large mesh is not held twice.
    let tobj::Mesh { positions, vertex_color, normals, texcoords, indices, face_arities, .. } = mesh;
    let uvs = texcoords.chunks_exact(2).map(|uv| Vec2::new(uv[0] as f32, uv[1] as f32)).collect();
    drop(texcoords);
    let normals_of = |normals: Vec<f64>| normals.chunks_exact(3).map(|n| DVec3::from_slice(n).as_vec3()).collect();
    let normals: Vec<Vec3> = normals_of(normals);
    // As painting programs write them, by sRGB's curve.
    let linear = |channel: f64| srgb_to_linear(channel.clamp(0.0, 1.0) as f32);
    let colour = |rgb: &[f64]| Vec4::new(linear(rgb[0]), linear(rgb[1]), linear(rgb[2]), 1.0);
    let colours = vertex_color.chunks_exact(3).map(colour).collect();
    drop(vertex_color);
    let positions: Vec<DVec3> = { positions }.chunks_exact(3).map(DVec3::from_slice).collect();
    let triangles = if face_arities.is_empty() {
        indices.chunks_exact(3).map(|triangle| [triangle[0], triangle[1], triangle[2]]).collect()
    } else {
        polygons::cut(&positions, &indices, face_arities.iter().map(|count| *count as usize))?
    };
    Ok(Mesh { positions, normals, uvs, colours, triangles, ..Mesh::default() })
}
