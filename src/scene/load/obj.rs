//! OBJ meshes: with their MTL materials as a scene of their own, or as bare geometry for a Mitsuba shape.

use std::cell::Cell;
use std::fs::File;
use std::io::{self, BufRead, BufReader, Read};
use std::path::Path;

use glam::{DAffine3, DVec3, Vec2, Vec3};
use tobj::LoadError;

use crate::error::{Error, Result};
use crate::files::open;
use crate::layout::Material;
use crate::scene::description::WORLD;
use crate::scene::{Mesh, SceneBuilder, SurfaceDescription, material};

const OPTIONS: tobj::LoadOptions =
    tobj::LoadOptions { single_index: true, triangulate: true, ignore_points: true, ignore_lines: true };

/// Reads all faces as one mesh, without materials. Vertices are shared between groups, as the file shares them;
/// texture coordinates are as the file gives them.
pub(super) fn read_geometry(path: &Path) -> Result<Mesh> {
    let reader = Lines::open(path, &["g", "o", "usemtl", "mtllib", "s"])?;
    let (models, _) = read(path, reader, |_| Ok((Vec::new(), Default::default())))?;
    let mut models = models.into_iter();
    match (models.next(), models.next()) {
        (Some(model), None) if !model.mesh.indices.is_empty() => Ok(to_mesh(model.mesh)),
        (_, None) => Err(Error::scene(path, "the file has no faces")),
        _ => Err(Error::scene(path, "the file holds more than one mesh")),
    }
}

/// Reads a scene: each group with its material. `Ke` makes an area light, a missing MTL file a warning and grey. What is
/// left is what [`SceneBuilder::finish`] does.
pub fn load(path: &Path) -> Result<SceneBuilder> {
    let missing: Cell<Option<Error>> = Cell::new(None);
    let broken: Cell<Option<Error>> = Cell::new(None);
    let (models, materials) = read(path, Lines::open(path, &[])?, |name| {
        let library = path.parent().unwrap_or(Path::new("")).join(name);
        let mut lines = match Lines::open(&library, &[]) {
            Ok(lines) => Lines { are_materials: true, ..lines },
            Err(error) => {
                missing.set(Some(error));
                return Err(LoadError::OpenFileFailed);
            }
        };
        tobj::load_mtl_buf(&mut lines).inspect_err(|error| broken.set(Some(lines.error(&library, *error, "MTL"))))
    })?;
    if let Some(error) = broken.take() {
        return Err(error);
    }
    if models.iter().all(|model| model.mesh.indices.is_empty()) {
        return Err(Error::scene(path, "the file has no faces"));
    }
    let mut builder = SceneBuilder::new(path);
    if let Some(error) = missing.take() {
        builder.warnings.push(format!("{error}; its materials are grey"));
    }
    let materials = materials.unwrap_or_default();
    let grey = builder.matte([0.5; 3]);
    let mut surfaces = Vec::new();
    for described in &materials {
        if described.diffuse_texture.is_some()
            || described.normal_texture.is_some()
            || described.dissolve_texture.is_some()
        {
            builder.warnings.push(format!("material '{}': its textures are not read", described.name));
        }
        let id = builder.material(to_material(described));
        builder.name_material(id, &described.name);
        let emission = described.emissive.unwrap_or_default();
        if emission.iter().any(|channel| !(0.0..1e30).contains(channel)) {
            return Err(Error::scene(
                path,
                format!("material '{}': Ke is {emission:?}, and must be 0 or more", described.name),
            ));
        }
        surfaces.push(builder.surface(SurfaceDescription {
            front: Some(id),
            back: Some(id),
            emission,
            ..SurfaceDescription::default()
        }));
    }
    for model in models {
        let surface = model.mesh.material_id.and_then(|id| surfaces.get(id)).copied().unwrap_or(grey);
        // In OBJ files v runs upwards.
        let mesh = to_mesh(model.mesh).with_flipped_v(true);
        builder.mesh(WORLD, &model.name, mesh, DAffine3::IDENTITY, surface);
    }
    Ok(builder)
}

/// What an MTL entry stands for: `illum` 3 and 5 are mirrors, 4, 6, 7 and 9 glass, everything else is diffuse.
fn to_material(described: &tobj::Material) -> Material {
    let colour = |value: Option<[f64; 3]>, default: f64| {
        value.unwrap_or([default; 3]).map(|channel| channel.clamp(0.0, 1.0) as f32)
    };
    let specular = colour(described.specular, 1.0);
    match described.illumination_model {
        Some(3 | 5) => material::conductor([0.0; 3], [1.0; 3], specular, None),
        Some(4 | 6 | 7 | 9) => {
            let index = described.optical_density.filter(|index| *index > 1.0).unwrap_or(1.5);
            let filter = described.unknown_param.get("Tf").and_then(|text| parse_colour(text)).unwrap_or([1.0; 3]);
            material::dielectric(index as f32, [1.0; 3], filter, None)
        }
        _ => material::diffuse(colour(described.diffuse, 0.5)),
    }
}

fn parse_colour(text: &str) -> Option<[f32; 3]> {
    let numbers: Vec<f32> = text.split_whitespace().map_while(|part| part.parse().ok()).collect();
    numbers.try_into().ok().filter(|rgb: &[f32; 3]| rgb.iter().all(|channel| (0.0..=1.0).contains(channel)))
}

fn to_mesh(mesh: tobj::Mesh) -> Mesh {
    // Each array goes as soon as it is taken over: a large mesh is not held twice.
    let tobj::Mesh { positions, normals, texcoords, indices, .. } = mesh;
    let triangles = indices.chunks_exact(3).map(|triangle| [triangle[0], triangle[1], triangle[2]]).collect();
    drop(indices);
    let uvs = texcoords.chunks_exact(2).map(|uv| Vec2::new(uv[0] as f32, uv[1] as f32)).collect();
    drop(texcoords);
    let single: Vec<Vec3> = normals.chunks_exact(3).map(|normal| DVec3::from_slice(normal).as_vec3()).collect();
    drop(normals);
    let positions = positions.chunks_exact(3).map(DVec3::from_slice).collect();
    Mesh { positions, normals: single, uvs, tangents: Vec::new(), colours: Vec::new(), triangles }
}

fn read(path: &Path, mut reader: Lines, materials: impl Fn(&Path) -> tobj::MTLLoadResult) -> Result<Models> {
    tobj::load_obj_buf(&mut reader, &OPTIONS, materials).map_err(|error| {
        let line = reader.number;
        match error {
            // Indices are resolved where a group ends, which is where the reader stands.
            LoadError::FaceVertexOutOfBounds
            | LoadError::FaceNormalOutOfBounds
            | LoadError::FaceTexCoordOutOfBounds => {
                let what = error.to_string().replace("face ", "").replace(" index out of bounds", "");
                Error::scene(path, format!("a face before line {} refers to a {what} that does not exist", line + 1))
            }
            _ => reader.error(path, error, "OBJ"),
        }
    })
}

/// What the OBJ reader returns: the groups, and the materials or why there are none.
type Models = (Vec<tobj::Model>, Result<Vec<tobj::Material>, LoadError>);

/// Reads line by line, counting them; lines that begin with one of the skipped keywords read as empty. What the reader of the
/// format takes for granted is checked here.
struct Lines {
    inner: BufReader<File>,
    line: Vec<u8>,
    position: usize,
    number: u32,
    skipped: &'static [&'static str],
    /// They are of an MTL file.
    are_materials: bool,
    /// Vertices, texture coordinates and normals so far.
    counts: [u32; 3],
    /// What is wrong with the last line.
    wrong: Option<String>,
}

impl Lines {
    fn open(path: &Path, skipped: &'static [&'static str]) -> Result<Self> {
        let inner = BufReader::new(open(path)?);
        let (line, counts) = (Vec::new(), [0; 3]);
        Ok(Self { inner, line, position: 0, number: 0, skipped, are_materials: false, counts, wrong: None })
    }

    /// The error of a reader that stands at the last line.
    fn error(&self, path: &Path, error: LoadError, format: &str) -> Error {
        let message = self.wrong.clone().unwrap_or_else(|| format!("not a valid {format} file: {error}"));
        Error::scene_line(path, self.number, message)
    }

    /// Takes the last line in; says what is wrong with it.
    fn check(&mut self) -> Result<(), String> {
        let text = std::str::from_utf8(&self.line).map_err(|_| String::from("the file is not text (UTF-8)"))?;
        let mut words = text.split_whitespace();
        let keyword = words.next().unwrap_or_default();
        if self.are_materials {
            let is_colour = ["Ka", "Kd", "Ks", "Ke"].contains(&keyword);
            return if is_colour && words.count() < 3 { Err(format!("{keyword} needs three numbers")) } else { Ok(()) };
        }
        if let Some(kind) = ["v", "vt", "vn"].iter().position(|known| *known == keyword) {
            self.counts[kind] = self.counts[kind].saturating_add(1);
        }
        if ["f", "l"].contains(&keyword) {
            let kinds = ["vertex", "texture coordinate", "normal"];
            for (index, (kind, count)) in words.flat_map(|word| word.split('/').zip(kinds.into_iter().zip(self.counts)))
            {
                // What is no integer at all is the reader's to report.
                if index.parse::<i64>().is_ok_and(|index| index < -i64::from(count) || index > i64::from(u32::MAX)) {
                    return Err(format!("the face refers to {kind} {index}, and there are {count} by here"));
                }
            }
        }
        Ok(())
    }
}

impl Read for Lines {
    fn read(&mut self, out: &mut [u8]) -> io::Result<usize> {
        let available = self.fill_buf()?;
        let count = available.len().min(out.len());
        out[..count].copy_from_slice(&available[..count]);
        self.consume(count);
        Ok(count)
    }
}

impl BufRead for Lines {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        if self.position == self.line.len() {
            self.line.clear();
            self.position = 0;
            if self.inner.read_until(b'\n', &mut self.line)? > 0 {
                self.number += 1;
                if let Err(message) = self.check() {
                    self.wrong = Some(message);
                    return Err(io::ErrorKind::InvalidData.into());
                }
                let keyword = self.line.trim_ascii_start().split(u8::is_ascii_whitespace).next().unwrap_or_default();
                if self.skipped.iter().any(|skipped| skipped.as_bytes() == keyword) {
                    self.line = vec![b'\n'];
                }
            }
        }
        Ok(&self.line[self.position..])
    }

    fn consume(&mut self, count: usize) {
        self.position += count;
    }
}
