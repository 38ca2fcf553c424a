//! PLY meshes: ASCII and both binary encodings.

use std::io::{BufRead, BufReader};
use std::path::Path;

use glam::{DAffine3, DVec3, Vec2, Vec3, Vec4};
use ply_rs_bw::parser::{ParseError, Parser, Reader};
use ply_rs_bw::ply::{ElementDef, Header, Property, PropertyAccess, PropertyAccessResult, PropertyType, ScalarType};

use super::ply_attributes::{self, Column};
use super::polygons;
use crate::error::{Error, Result};
use crate::files::open;
use crate::image::srgb_to_linear;
use crate::layout::MATERIAL_HAS_COLOURS;
use crate::scene::description::WORLD;
use crate::scene::{Mesh, SceneBuilder, material};

/// Names of texture coordinates, the first pair that a file has: those of Blender and MeshLab, of Mitsuba, and of others.
const UVS: [[&str; 2]; 4] = [["u", "v"], ["s", "t"], ["texture_u", "texture_v"], ["texture_s", "texture_t"]];
/// Names of colours.
const COLOURS: [[&str; 3]; 3] =
    [["red", "green", "blue"], ["r", "g", "b"], ["diffuse_red", "diffuse_green", "diffuse_blue"]];
/// Names of the list of a face's corners.
const CORNERS: [&str; 2] = ["vertex_indices", "vertex_index"];

/// Reads a scene: the mesh in its vertices' colours, else in grey.
pub fn load(path: &Path) -> Result<SceneBuilder> {
    let mut builder = SceneBuilder::new(path);
    let mesh = read_all(path, true, &[])?;
    let has_colours = !mesh.colours.is_empty();
    let material = builder.material(material::diffuse([if has_colours { 1.0 } else { 0.5 }; 3]));
    if has_colours {
        builder.material_mut(material).record.flags |= MATERIAL_HAS_COLOURS;
    }
    let surface = builder.both_sides(material);
    builder.mesh(WORLD, &path.display().to_string(), mesh, DAffine3::IDENTITY, surface);
    Ok(builder)
}

/// Reads positions, normals (if all three are there), texture coordinates, faces, which may be polygons or strips of triangles, and those of the
/// attributes of these names that there are.
pub fn read(path: &Path, attributes: &[String]) -> Result<Mesh> {
    read_all(path, false, attributes)
}

/// Reads a mesh, with its vertices' colours if they are wanted.
fn read_all(path: &Path, wants_colours: bool, attributes: &[String]) -> Result<Mesh> {
    let wrong = |error: ParseError| parse_error(path, &error, "");
    let mut reader = Reader::new(BufReader::new(open(path)?));
    let header = Parser::<Skipped>::new().read_header(&mut reader).map_err(wrong)?;
    let mut mesh = Mesh::default();
    let mut faces = Faces::default();
    let mut columns = Vec::new();
    for (_, element) in &header.elements {
        // Any number of them would take no byte.
        if element.properties.is_empty() && element.count > 0 {
            return Err(Error::scene(path, format!("the element '{}' has no properties", element.name)));
        }
        match element.name.as_str() {
            "vertex" => {
                read_vertices(path, &mut reader, element, &header, wants_colours, attributes, &mut mesh)?;
            }
            "face" => {
                check_corners(path, element)?;
                columns = ply_attributes::columns(element, attributes);
                let read = if columns.is_empty() {
                    in_batches(&mut reader, element, &header, |index, face: Corners| faces.push(index, &face.0))
                } else {
                    in_batches(&mut reader, element, &header, |index, face: WithAll<Corners>| {
                        columns.iter_mut().for_each(|column| column.take(&face.all));
                        faces.push(index, &face.own.0)
                    })
                };
                read.map_err(|error| error.located(path))?;
            }
            "tristrips" => {
                check_corners(path, element)?;
                in_batches(&mut reader, element, &header, |_, strip: Corners| {
                    faces.push_strips(&strip.0);
                    Ok(())
                })
                .map_err(|error| error.located(path))?;
            }
            _ => {
                // Something else, such as edges: read past it.
                in_batches(&mut reader, element, &header, |_, _: Skipped| Ok(()))
                    .map_err(|error| error.located(path))?;
            }
        }
    }
    if mesh.positions.is_empty() {
        return Err(Error::scene(path, "the file has no element 'vertex' with data: it is not a mesh"));
    }
    if faces.triangles.is_empty() && faces.counts.is_empty() {
        return Err(Error::scene(path, "the file has no faces: there is nothing to render"));
    }
    faces.check(path, mesh.positions.len())?;
    mesh.face_attributes = columns.into_iter().map(Column::into_attribute).collect();
    // Of triangles alone; a texture that shows those of other faces does not find them.
    if mesh.face_attributes.iter().any(|own| own.values.len() != faces.triangles.len()) || !faces.counts.is_empty() {
        mesh.face_attributes.clear();
    }
    mesh.triangles = faces.triangles;
    let polygons = polygons::cut(&mesh.positions, &faces.corners, faces.counts.into_iter());
    mesh.triangles.extend(polygons.map_err(|message| Error::scene(path, message))?);
    Ok(mesh)
}

fn read_vertices(
    path: &Path,
    reader: &mut Reader<impl BufRead>,
    element: &ElementDef,
    header: &Header,
    wants_colours: bool,
    attributes: &[String],
    mesh: &mut Mesh,
) -> Result<()> {
    for needed in ["x", "y", "z"] {
        if !element.properties.contains_key(needed) {
            return Err(Error::scene(path, format!("the element 'vertex' has no property '{needed}'")));
        }
    }
    let has = |names: &[&str]| names.iter().all(|name| element.properties.contains_key(*name));
    let has_normals = has(&["nx", "ny", "nz"]);
    let uvs = UVS.iter().position(|names| has(&names[..]));
    let colours = COLOURS.iter().position(|names| wants_colours && has(&names[..]));
    // Bytes are meant as painting programs have them, other numbers as they are.
    let is_integer = colours.is_some_and(|set| {
        let kind = element.properties.get(COLOURS[set][0]).map(|property| &property.data_type);
        !matches!(kind, Some(PropertyType::Scalar(ScalarType::Float | ScalarType::Double)))
    });
    let mut columns = ply_attributes::columns(element, attributes);
    // What the largest files have is read without room for more.
    let read = if uvs.is_none() && colours.is_none() && columns.is_empty() {
        in_batches(reader, element, header, |_, vertex: Vertex<()>| {
            mesh.positions.push(vertex.position);
            if has_normals {
                mesh.normals.push(vertex.normal);
            }
            Ok(())
        })
    } else {
        let mut take = |vertex: Vertex<Looks>| {
            mesh.positions.push(vertex.position);
            if has_normals {
                mesh.normals.push(vertex.normal);
            }
            if let Some(set) = uvs {
                mesh.uvs.push(Vec2::from(vertex.looks.uvs[set]));
            }
            if let Some(set) = colours {
                let channel = |value: f32| if is_integer { srgb_to_linear(value) } else { value };
                let [r, g, b] = vertex.looks.colours[set].map(|value| channel(value.clamp(0.0, 1.0)));
                mesh.colours.push(Vec4::new(r, g, b, 1.0));
            }
        };
        if columns.is_empty() {
            in_batches(reader, element, header, |_, vertex: Vertex<Looks>| {
                take(vertex);
                Ok(())
            })
        } else {
            in_batches(reader, element, header, |_, vertex: WithAll<Vertex<Looks>>| {
                columns.iter_mut().for_each(|column| column.take(&vertex.all));
                take(vertex.own);
                Ok(())
            })
        }
    };
    mesh.attributes = columns.into_iter().map(Column::into_attribute).collect();
    read.map_err(|error| error.located(path))
}

/// Fails where an element has no list of corners, or one that is not of integers.
fn check_corners(path: &Path, element: &ElementDef) -> Result<()> {
    let name = &element.name;
    match CORNERS.iter().find_map(|name| element.properties.get(*name)).map(|property| &property.data_type) {
        Some(PropertyType::List(_, ScalarType::Float | ScalarType::Double) | PropertyType::Scalar(_)) => {
            Err(Error::scene(path, format!("the element '{name}' has vertex indices that are no list of integers")))
        }
        None => Err(Error::scene(path, format!("the element '{name}' has no property 'vertex_indices'"))),
        Some(_) => Ok(()),
    }
}

/// Faces before it is known where their corners are.
#[derive(Default)]
struct Faces {
    triangles: Vec<[u32; 3]>,
    /// The corners of all other polygons, and how many each has.
    corners: Vec<u32>,
    counts: Vec<usize>,
}

impl Faces {
    #[inline]
    fn push(&mut self, index: usize, corners: &[u32]) -> Result<(), String> {
        match *corners {
            [a, b, c] => {
                self.triangles.push([a, b, c]);
                Ok(())
            }
            _ => self.push_polygon(index, corners),
        }
    }

    fn push_polygon(&mut self, index: usize, corners: &[u32]) -> Result<(), String> {
        match *corners {
            [] => {}
            [_] | [_, _] => {
                return Err(format!("face {index} has {} vertices, and needs three or more", corners.len()));
            }
            _ => {
                self.corners.extend(corners);
                self.counts.push(corners.len());
            }
        }
        Ok(())
    }

    /// Strips, with an index of -1 between them; every other triangle runs the other way.
    fn push_strips(&mut self, corners: &[u32]) {
        for strip in corners.split(|vertex| *vertex == u32::MAX) {
            let turned =
                |(index, w): (usize, &[u32])| if index % 2 == 0 { [w[0], w[1], w[2]] } else { [w[1], w[0], w[2]] };
            self.triangles.extend(strip.windows(3).enumerate().map(turned));
        }
    }

    /// Fails where a face refers to a vertex that does not exist.
    fn check(&self, path: &Path, count: usize) -> Result<()> {
        let is_bad = |vertex: &u32| *vertex as usize >= count;
        let largest = |vertices: &[u32]| vertices.iter().copied().fold(0, u32::max);
        if !is_bad(&largest(self.triangles.as_flattened()).max(largest(&self.corners))) {
            return Ok(());
        }
        let triangle = self.triangles.iter().enumerate().find_map(|(index, triangle)| {
            Some((format!("triangle {index}"), *triangle.iter().find(|vertex| is_bad(vertex))?))
        });
        let polygon = || Some((String::from("a polygon"), *self.corners.iter().find(|vertex| is_bad(vertex))?));
        let Some((face, vertex)) = triangle.or_else(polygon) else { return Ok(()) };
        let last = count.saturating_sub(1);
        let message = format!("{face} refers to vertex {vertex}, and there are {count} vertices (0 to {last})");
        Err(Error::scene(path, message))
    }
}

/// Elements that are held at once as the parser returns them: each face is a list of its own there, which takes several times
/// the memory that its triangles do.
const BATCH: usize = 1 << 16;

/// Why an element could not be taken in.
enum Refusal {
    Unreadable(ParseError, String),
    Wrong(String),
}

impl Refusal {
    fn located(&self, path: &Path) -> Error {
        match self {
            Self::Unreadable(error, announced) => parse_error(path, error, announced),
            Self::Wrong(message) => Error::scene(path, message),
        }
    }
}

/// Reads all elements of one kind, and hands each on with its number.
fn in_batches<E: PropertyAccess>(
    reader: &mut Reader<impl BufRead>,
    element: &ElementDef,
    header: &Header,
    mut take: impl FnMut(usize, E) -> Result<(), String>,
) -> Result<(), Refusal> {
    let parser = Parser::<E>::new();
    let mut part = element.clone();
    for first in (0..element.count).step_by(BATCH) {
        part.count = BATCH.min(element.count - first);
        let read = parser.read_payload_for_element(reader, &part, header).map_err(|error| {
            Refusal::Unreadable(error, format!("; the header announces {} of '{}'", element.count, element.name))
        })?;
        for (index, item) in read.into_iter().enumerate() {
            take(first + index, item).map_err(Refusal::Wrong)?;
        }
    }
    Ok(())
}

/// The parser's error as one line: its own first line, the text that it could not read, and what was announced.
fn parse_error(path: &Path, error: &ParseError, announced: &str) -> Error {
    let message = error.to_string();
    let mut lines = message.lines().map(|line| line.trim().trim_end_matches(['.', ':']));
    let mut what = lines.next().unwrap_or("unreadable");
    if error.line().is_some() {
        what = what.split_once(": ").map_or(what, |(_, rest)| rest);
    }
    let text = lines.find_map(|line| line.strip_prefix("String: '"));
    let text = text.map_or(String::new(), |text| format!(": '{}'", text.trim_end_matches('\'')));
    let message = format!("not a valid PLY file: {what}{text}{announced}");
    match error.line().and_then(|line| u32::try_from(line).ok()) {
        Some(line) => Error::scene_line(path, line, message),
        None => Error::scene(path, message),
    }
}

#[derive(Clone, Copy, Default)]
struct Vertex<L> {
    position: DVec3,
    normal: Vec3,
    looks: L,
}

/// Texture coordinates and colours, in the order of [`UVS`] and [`COLOURS`].
#[derive(Clone, Copy, Default)]
struct Looks {
    uvs: [[f32; 2]; UVS.len()],
    colours: [[f32; 3]; COLOURS.len()],
}

/// What a vertex keeps beside its position and its normal.
trait Keep: Default {
    /// Takes a property in, unless it is something else.
    fn keep(&mut self, name: &str, property: &Property) -> PropertyAccessResult;
}

impl Keep for () {
    fn keep(&mut self, _: &str, _: &Property) -> PropertyAccessResult {
        PropertyAccessResult::Ignored
    }
}

impl Keep for Looks {
    fn keep(&mut self, name: &str, property: &Property) -> PropertyAccessResult {
        let at = |names: &[&str]| names.iter().position(|known| *known == name);
        if let Some(at) = at(UVS.as_flattened()) {
            self.uvs.as_flattened_mut()[at] = scalar(property).unwrap_or_default() as f32;
        } else if let Some(at) = at(COLOURS.as_flattened()) {
            self.colours.as_flattened_mut()[at] = share(property).unwrap_or_default() as f32;
        } else {
            return PropertyAccessResult::Ignored;
        }
        PropertyAccessResult::Set
    }
}

/// The corners of a face or a strip.
#[derive(Default)]
struct Corners(Vec<u32>);

struct Skipped;

/// An element with all numbers that it has, by their names.
struct WithAll<E> {
    own: E,
    all: Vec<(String, f32)>,
}

/// A number.
fn scalar(property: &Property) -> Option<f64> {
    match property {
        Property::Double(value) => Some(*value),
        Property::Float(value) => Some(f64::from(*value)),
        other => other.to_f32_lossy().map(f64::from),
    }
}

/// A colour as 0 to 1.
fn share(property: &Property) -> Option<f64> {
    let scale = match property {
        Property::UChar(_) => 255.0,
        Property::UShort(_) => 65535.0,
        Property::Char(_) => 127.0,
        Property::Short(_) => 32767.0,
        _ => 1.0,
    };
    scalar(property).map(|value| value / scale)
}

impl<L: Keep> PropertyAccess for Vertex<L> {
    fn new() -> Self {
        Self::default()
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        let Some(value) = scalar(&property) else { return PropertyAccessResult::Ignored };
        match name {
            "x" => self.position.x = value,
            "y" => self.position.y = value,
            "z" => self.position.z = value,
            "nx" => self.normal.x = value as f32,
            "ny" => self.normal.y = value as f32,
            "nz" => self.normal.z = value as f32,
            _ => return self.looks.keep(name, &property),
        }
        PropertyAccessResult::Set
    }
}

impl<E: PropertyAccess> PropertyAccess for WithAll<E> {
    fn new() -> Self {
        Self { own: E::new(), all: Vec::new() }
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        if let Some(value) = scalar(&property) {
            self.all.push((name.to_owned(), value as f32));
        }
        self.own.set_property(name, property);
        PropertyAccessResult::Set
    }
}

impl PropertyAccess for Corners {
    fn new() -> Self {
        Self::default()
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        if !CORNERS.contains(&name) {
            return PropertyAccessResult::Ignored;
        }
        // A negative index is out of range, which the check of all faces reports.
        self.0 = match property {
            Property::ListChar(list) => list.into_iter().map(|index| i32::from(index) as u32).collect(),
            Property::ListShort(list) => list.into_iter().map(|index| i32::from(index) as u32).collect(),
            Property::ListInt(list) => list.into_iter().map(|index| index as u32).collect(),
            other => match other.to_u32_list() {
                Some(list) => list,
                None => return PropertyAccessResult::Ignored,
            },
        };
        PropertyAccessResult::Set
    }
}

impl PropertyAccess for Skipped {
    fn new() -> Self {
        Self
    }

    fn set_property(&mut self, _: &str, _: Property) -> PropertyAccessResult {
        PropertyAccessResult::Ignored
    }
}
