//! Mitsuba's binary meshes (`.serialized`), versions 3 and 4, as its documentation of the shape `serialized` describes them.
//!
//! A file is a sequence of meshes, each an uncompressed header (two 16-bit words) and a zlib stream, and ends with their
//! offsets and their count. All numbers are little-endian. No count in a file is believed: memory grows with what is read.

use std::fs::File;
use std::io::{BufReader, Read, Seek, SeekFrom};
use std::path::Path;

use flate2::bufread::ZlibDecoder;
use glam::{DVec3, Vec2};

use super::limits::{MESH_BYTES, MESH_NAME};
use crate::error::{Error, Result};
use crate::files::{DEFLATE_RATIO, open};
use crate::scene::Mesh;

const MAGIC: u16 = 0x041c;
const HAS_NORMALS: u32 = 0x0001;
const HAS_UVS: u32 = 0x0002;
const HAS_COLOURS: u32 = 0x0008;
const DOUBLE_PRECISION: u32 = 0x2000;

/// Items that are read at once.
const BLOCK: u64 = 4096;

/// Reads one mesh of a file, counted from 0. Vertex colours are skipped, and so is the flag that asks for face normals, which
/// Mitsuba 3 does not heed either.
pub(super) fn read(path: &Path, index: u32) -> Result<Mesh> {
    let failed = |error: std::io::Error| Error::read(path, error);
    let wrong = |message: String| Error::scene(path, message);
    let mut file = open(path)?;
    let bytes = file.metadata().map_err(failed)?.len();
    let version = header(path, &mut file)?;
    if index > 0 {
        let start = offset(&mut file, bytes, version, index).map_err(|error| match error.kind() {
            std::io::ErrorKind::InvalidData => wrong(error.to_string()),
            _ => failed(error),
        })?;
        file.seek(SeekFrom::Start(start)).map_err(failed)?;
        if header(path, &mut file)? != version {
            return Err(wrong(format!(
                "mesh {index} at byte {start} is not of version {version}, as the first one is"
            )));
        }
    }
    let compressed = bytes - file.stream_position().map_err(failed)?.min(bytes);
    let mut stream = Stream {
        path,
        inner: ZlibDecoder::new(BufReader::new(file)),
        left: compressed.saturating_mul(DEFLATE_RATIO).min(MESH_BYTES),
    };
    stream.mesh(version)
}

/// The version, if this is the header of a mesh.
fn header(path: &Path, file: &mut File) -> Result<u16> {
    let mut bytes = [0; 4];
    file.read_exact(&mut bytes).map_err(|error| match error.kind() {
        std::io::ErrorKind::UnexpectedEof => Error::scene(path, "not a serialized mesh: the file ends in its header"),
        _ => Error::read(path, error),
    })?;
    let [magic, version] = [[bytes[0], bytes[1]], [bytes[2], bytes[3]]].map(u16::from_le_bytes);
    match (magic, version) {
        (MAGIC, 3 | 4) => Ok(version),
        (MAGIC, _) => Err(Error::scene(path, format!("the mesh is of version {version}, and 3 and 4 are read"))),
        _ => Err(Error::scene(path, format!("not a serialized mesh: it begins with {magic:#06x}, not {MAGIC:#06x}"))),
    }
}

/// Where a mesh begins, from the end of the file; what makes no sense there is `InvalidData`.
fn offset(file: &mut File, bytes: u64, version: u16, index: u32) -> std::io::Result<u64> {
    let wrong = |message: String| std::io::Error::new(std::io::ErrorKind::InvalidData, message);
    let mut count = [0; 4];
    file.seek(SeekFrom::Start(bytes.saturating_sub(4)))?;
    file.read_exact(&mut count)?;
    let count = u32::from_le_bytes(count);
    let width = if version == 3 { 4 } else { 8 };
    let table = bytes
        .checked_sub(4 + width * u64::from(count))
        .ok_or_else(|| wrong(format!("the file ends with a count of {count} meshes, which it has no room for")))?;
    if index >= count {
        return Err(wrong(format!("mesh {index} is asked for, and the file ends with a count of {count} (from 0)")));
    }
    let mut entry = [0; 8];
    file.seek(SeekFrom::Start(table + width * u64::from(index)))?;
    file.read_exact(&mut entry[..width as usize])?;
    let start = u64::from_le_bytes(entry);
    if start >= table {
        return Err(wrong(format!("mesh {index} is said to begin at byte {start}, and the meshes end at {table}")));
    }
    Ok(start)
}

/// The decompressed bytes of one mesh.
struct Stream<'a> {
    path: &'a Path,
    inner: ZlibDecoder<BufReader<File>>,
    /// Bytes that may still come.
    left: u64,
}

impl Stream<'_> {
    fn mesh(&mut self, version: u16) -> Result<Mesh> {
        let flags = u32::from_le_bytes(self.bytes("flags")?);
        if version == 4 {
            self.skip_name()?;
        }
        let vertices = u64::from_le_bytes(self.bytes("number of vertices")?);
        let triangles = u64::from_le_bytes(self.bytes("number of triangles")?);
        if vertices == 0 || triangles == 0 {
            return Err(self.wrong(format!("the mesh has {vertices} vertices and {triangles} triangles: it is empty")));
        }
        if vertices > u64::from(u32::MAX) {
            return Err(
                self.wrong(format!("the mesh has {vertices} vertices, and {} is the most that is read", u32::MAX))
            );
        }
        let double = flags & DOUBLE_PRECISION != 0;
        let mut mesh = Mesh::default();
        self.vectors("positions", vertices, double, |x| mesh.positions.push(DVec3::from_array(x)))?;
        if flags & HAS_NORMALS != 0 {
            self.vectors("normals", vertices, double, |x| mesh.normals.push(DVec3::from_array(x).as_vec3()))?;
        }
        if flags & HAS_UVS != 0 {
            self.vectors("texture coordinates", vertices, double, |[u, v]| {
                mesh.uvs.push(Vec2::new(u as f32, v as f32))
            })?;
        }
        if flags & HAS_COLOURS != 0 {
            self.vectors("colours", vertices, double, |_: [f64; 3]| ())?;
        }
        self.items("triangles", triangles, 12, |bytes| {
            let (corners, _) = bytes.as_chunks::<4>();
            mesh.triangles.push([0, 1, 2].map(|corner| u32::from_le_bytes(corners[corner])));
        })?;
        // The stream's checksum is compared where it ends; what follows the mesh, if anything, is left alone.
        self.inner
            .read(&mut [0])
            .map_err(|error| self.wrong(format!("the mesh's data are damaged: their end cannot be read: {error}")))?;
        mesh.check_indices(self.path)?;
        Ok(mesh)
    }

    fn wrong(&self, message: String) -> Error {
        Error::scene(self.path, message)
    }

    fn bytes<const N: usize>(&mut self, what: &str) -> Result<[u8; N]> {
        let mut bytes = [0; N];
        self.items(what, 1, N, |read| bytes.copy_from_slice(read))?;
        Ok(bytes)
    }

    /// Reads past a string that ends with a zero.
    fn skip_name(&mut self) -> Result<()> {
        for _ in 0..MESH_NAME {
            if self.bytes("name")? == [0] {
                return Ok(());
            }
        }
        Err(self.wrong(format!("the mesh's name has more than {MESH_NAME} bytes: this is not a serialized mesh")))
    }

    /// Reads vectors of `N` numbers in single or double precision.
    fn vectors<const N: usize>(
        &mut self,
        what: &str,
        count: u64,
        double: bool,
        mut take: impl FnMut([f64; N]),
    ) -> Result<()> {
        self.items(what, count, N * if double { 8 } else { 4 }, |bytes| {
            let mut vector = [0.0; N];
            if double {
                vector.iter_mut().zip(bytes.as_chunks().0).for_each(|(x, bytes)| *x = f64::from_le_bytes(*bytes));
            } else {
                let single = bytes.as_chunks().0.iter().map(|bytes| f64::from(f32::from_le_bytes(*bytes)));
                vector.iter_mut().zip(single).for_each(|(x, value)| *x = value);
            }
            take(vector);
        })
    }

    /// Reads items of so many bytes each, block by block.
    fn items(&mut self, what: &str, count: u64, size: usize, mut take: impl FnMut(&[u8])) -> Result<()> {
        let total = count.checked_mul(size as u64).filter(|total| *total <= self.left).ok_or_else(|| {
            self.wrong(format!("the mesh claims {count} {what}, more than the rest of the file can hold"))
        })?;
        self.left -= total;
        let mut block = vec![0; count.min(BLOCK) as usize * size];
        let mut missing = count;
        while missing > 0 {
            let some = missing.min(BLOCK);
            let block = &mut block[..some as usize * size];
            self.inner.read_exact(block).map_err(|error| {
                let cause = match error.kind() {
                    std::io::ErrorKind::UnexpectedEof => String::from("the data end too early"),
                    _ => error.to_string(),
                };
                self.wrong(format!("the mesh's {what} cannot be read: {cause}"))
            })?;
            block.chunks_exact(size).for_each(&mut take);
            missing -= some;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use std::io::Write;

    use glam::Vec3;

    use super::*;

    /// Two triangles, as `flags` wants them, moved by `x`.
    fn mesh(version: u16, flags: u32, x: f64) -> Vec<u8> {
        let mut data = flags.to_le_bytes().to_vec();
        if version == 4 {
            data.extend(b"a square\0");
        }
        data.extend(4u64.to_le_bytes());
        data.extend(2u64.to_le_bytes());
        let mut floats = |values: &[f64]| {
            for value in values {
                if flags & DOUBLE_PRECISION != 0 {
                    data.extend(value.to_le_bytes());
                } else {
                    data.extend((*value as f32).to_le_bytes());
                }
            }
        };
        floats(&[x - 1.0, -1.0, 0.0, x + 1.0, -1.0, 0.25, x + 1.0, 1.0, 0.0, x - 1.0, 1.0, 0.5]);
        if flags & HAS_NORMALS != 0 {
            floats(&[0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 1.0, 0.0]);
        }
        if flags & HAS_UVS != 0 {
            floats(&[0.125, 0.25, 0.875, 0.25, 0.875, 0.75, 0.125, 0.75]);
        }
        if flags & HAS_COLOURS != 0 {
            floats(&[0.5; 12]);
        }
        [0u32, 1, 2, 0, 2, 3].iter().for_each(|index| data.extend(index.to_le_bytes()));
        pack(version, &data)
    }

    fn pack(version: u16, data: &[u8]) -> Vec<u8> {
        let mut out = [MAGIC.to_le_bytes(), version.to_le_bytes()].concat();
        let mut encoder = flate2::write::ZlibEncoder::new(&mut out, flate2::Compression::default());
        encoder.write_all(data).unwrap();
        encoder.finish().unwrap();
        out
    }

    fn file(version: u16, meshes: &[Vec<u8>]) -> Vec<u8> {
        let mut out = Vec::new();
        let mut offsets = Vec::new();
        for mesh in meshes {
            if version == 4 {
                offsets.extend((out.len() as u64).to_le_bytes());
            } else {
                offsets.extend((out.len() as u32).to_le_bytes());
            }
            out.extend(mesh);
        }
        out.extend(offsets);
        out.extend((meshes.len() as u32).to_le_bytes());
        out
    }

    fn read_bytes(bytes: &[u8], index: u32) -> Result<Mesh> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("mesh.serialized");
        std::fs::write(&path, bytes).unwrap();
        read(&path, index)
    }

    const DOUBLE_ALL: u32 = DOUBLE_PRECISION | HAS_NORMALS | HAS_UVS | HAS_COLOURS;

    /// Mitsuba 3.9 reads the same from these bytes.
    #[test]
    fn meshes_come_back() {
        for version in [3, 4] {
            for flags in [0x1000, 0x1000 | HAS_NORMALS, 0x1000 | HAS_UVS, 0x1010 | HAS_COLOURS, DOUBLE_ALL] {
                let bytes = file(version, &[mesh(version, flags, 0.0), mesh(version, flags, 5.0)]);
                for (index, x) in [(0, 0.0), (1, 5.0)] {
                    let found = read_bytes(&bytes, index).unwrap();
                    let expected =
                        [(x - 1.0, -1.0, 0.0), (x + 1.0, -1.0, 0.25), (x + 1.0, 1.0, 0.0), (x - 1.0, 1.0, 0.5)];
                    assert_eq!(found.positions, expected.map(DVec3::from), "version {version}, flags {flags:#x}");
                    let normals = [Vec3::Z, Vec3::Z, Vec3::Z, Vec3::Y];
                    assert_eq!(found.normals, if flags & HAS_NORMALS != 0 { &normals[..] } else { &[] });
                    let uvs = [(0.125, 0.25), (0.875, 0.25), (0.875, 0.75), (0.125, 0.75)].map(Vec2::from);
                    assert_eq!(found.uvs, if flags & HAS_UVS != 0 { &uvs[..] } else { &[] });
                    assert_eq!(found.triangles, [[0, 1, 2], [0, 2, 3]]);
                }
            }
        }
    }

    #[test]
    fn many_blocks_are_read() {
        let count = 3 * BLOCK as u32 + 7;
        let mut data = DOUBLE_PRECISION.to_le_bytes().to_vec();
        data.extend(u64::from(count).to_le_bytes());
        data.extend(1u64.to_le_bytes());
        (0..3 * count).for_each(|value| data.extend(f64::from(value).to_le_bytes()));
        [0, 1, count - 1].iter().for_each(|index| data.extend(index.to_le_bytes()));
        let found = read_bytes(&file(3, &[pack(3, &data)]), 0).unwrap();
        assert_eq!(found.positions.len(), count as usize);
        let last = f64::from(3 * count - 3);
        assert_eq!(found.positions[count as usize - 1], DVec3::new(last, last + 1.0, last + 2.0));
    }

    /// One line that names the file.
    fn refused(bytes: &[u8], index: u32, expected: &str) {
        let message = read_bytes(bytes, index).unwrap_err().to_string();
        assert!(message.contains("mesh.serialized") && !message.contains('\n'), "{message}");
        assert!(message.contains(expected), "'{expected}' is not in: {message}");
    }

    #[test]
    fn broken_files_are_refused() {
        let fine = file(4, &[mesh(4, DOUBLE_ALL, 0.0), mesh(4, DOUBLE_ALL, 5.0)]);
        refused(b"", 0, "header");
        refused(b"ply\nformat", 0, "0x6c70");
        refused(&[0x1c, 0x04, 5, 0, 0, 0], 0, "version 5");
        refused(&fine, 2, "a count of 2");
        refused(&fine, u32::MAX, "a count of 2");
        refused(&fine[..fine.len() - 4], 1, "count");
        let mut table = fine.clone();
        let entry = table.len() - 12;
        table[entry..entry + 8].fill(0xff);
        refused(&table, 1, "begin at byte");
        table[entry..entry + 8].copy_from_slice(&1u64.to_le_bytes());
        refused(&table, 1, "not a serialized mesh");
        let mut count = fine.clone();
        let end = count.len() - 4;
        count[end..].fill(0xff);
        refused(&count, 1, "no room");
        refused(&file(3, &[mesh(3, 0x1000, 0.0), mesh(4, 0x1000, 0.0)]), 1, "version 3");
        // Cut anywhere, or with any byte changed: the stream has a checksum. Only past the mesh's own data may it be wrong.
        let single = mesh(4, DOUBLE_ALL, 0.0);
        let whole = read_bytes(&single, 0).unwrap();
        for length in 0..single.len() {
            assert!(read_bytes(&single[..length], 0).is_err(), "{length} of {} bytes", single.len());
        }
        for at in 0..single.len() {
            let mut changed = single.clone();
            changed[at] ^= 0x55;
            if let Ok(mesh) = read_bytes(&changed, 0) {
                assert_eq!(
                    (mesh.positions, mesh.triangles),
                    (whole.positions.clone(), whole.triangles.clone()),
                    "byte {at}"
                );
            }
        }
    }

    #[test]
    fn counts_are_not_believed() {
        let start = |vertices: u64, triangles: u64| {
            let mut data = 0x1000u32.to_le_bytes().to_vec();
            data.extend(vertices.to_le_bytes());
            data.extend(triangles.to_le_bytes());
            data
        };
        let claim = |vertices, triangles, expected: &str| {
            refused(&file(3, &[pack(3, &start(vertices, triangles))]), 0, expected);
        };
        claim(0, 1, "empty");
        claim(3, 0, "empty");
        claim(u64::MAX, 1, "the most that is read");
        claim(u64::from(u32::MAX), 1, "4294967295 positions");
        claim(3, 1, "too early");
        let with = |vertices: u64, triangles, tail: &[u8]| {
            let mut data = start(vertices, triangles);
            data.extend(vec![0; 12 * vertices as usize]);
            data.extend(tail);
            file(3, &[pack(3, &data)])
        };
        refused(&with(3, u64::MAX, &[]), 0, "claims 18446744073709551615 triangles");
        refused(&with(3, 1, &[0, 0, 0, 0, 1, 0, 0, 0, 3, 0, 0, 0]), 0, "vertex 3");
        // A name that never ends.
        let mut data = 0x1000u32.to_le_bytes().to_vec();
        data.extend(vec![b'x'; 2 * MESH_NAME as usize]);
        refused(&file(4, &[pack(4, &data)]), 0, "name");
        // A stream that unpacks to far more than it should: no more of it is read than the counts ask for.
        let bomb = with(3, 1, &vec![0; 64 << 20]);
        assert_eq!(read_bytes(&bomb, 0).unwrap().triangles, [[0, 0, 0]]);
    }
}
