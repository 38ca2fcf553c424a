//! Bytes of any kind as input of the loaders, and the rules that hold whatever they are: `tests/hostile.rs` and the fuzz targets
//! go by them.
//!
//! A loader either makes a scene whose indices exist and whose numbers are finite, or says in one line what is wrong. It neither
//! panics, nor takes more memory than [`MOST_MEMORY`].

#![allow(dead_code, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::alloc::{GlobalAlloc, Layout, System};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

use lumbre::bvh::{Bvh, CHUNK};
use lumbre::layout::SURFACE_MASK;
use lumbre::scene::{LoadOptions, Needs, Scene};

/// The most bytes that loading one of the small files here may have allocated at once.
pub const MOST_MEMORY: usize = 1 << 30;
/// Allocations beyond this in all fail, which ends the process: a machine should survive its tests.
const NO_MEMORY: usize = 6 << 30;
/// The most characters of a message.
const LONGEST_MESSAGE: usize = 4000;
/// Parts of an input that stand for files of their own are divided by this.
pub const SEPARATOR: &[u8] = b"\n#####\n";

/// The system's allocator, which counts.
pub struct Bounded;

static LIVE: AtomicUsize = AtomicUsize::new(0);
static PEAK: AtomicUsize = AtomicUsize::new(0);

impl Bounded {
    /// Counts new bytes, unless there are too many.
    fn take(bytes: usize) -> bool {
        let live = LIVE.fetch_add(bytes, Relaxed).saturating_add(bytes);
        if live > NO_MEMORY {
            LIVE.fetch_sub(bytes, Relaxed);
            return false;
        }
        PEAK.fetch_max(live, Relaxed);
        true
    }
}

// SAFETY: every call goes to the system's allocator as it is; a null pointer, which says that there is no memory, is a valid answer.
unsafe impl GlobalAlloc for Bounded {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        if !Self::take(layout.size()) {
            return std::ptr::null_mut();
        }
        // SAFETY: the caller's promise is passed on.
        unsafe { System.alloc(layout) }
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        if !Self::take(layout.size()) {
            return std::ptr::null_mut();
        }
        // SAFETY: the caller's promise is passed on.
        unsafe { System.alloc_zeroed(layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        // Both may exist while the contents move.
        if !Self::take(size) {
            return std::ptr::null_mut();
        }
        LIVE.fetch_sub(layout.size(), Relaxed);
        // SAFETY: the caller's promise is passed on.
        unsafe { System.realloc(pointer, layout, size) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        LIVE.fetch_sub(layout.size(), Relaxed);
        // SAFETY: the caller's promise is passed on.
        unsafe { System.dealloc(pointer, layout) }
    }
}

/// What bytes are read as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Mitsuba XML.
    Mitsuba,
    /// glTF as text; as .glb where it begins like one; a separator puts the binary chunk of a .glb behind the text.
    Gltf,
    /// OBJ, and behind a separator its MTL file `scene.mtl`.
    Obj,
    /// PLY.
    Ply,
    /// A serialized mesh; what begins with `raw` is the contents of its zlib stream, which no change to its bytes could reach.
    Serialized,
    /// An image in any format, as a texture and as an environment.
    Image,
}

/// A folder that inputs are written to; what they may refer to lies there.
pub struct Folder {
    path: PathBuf,
}

const PLY: &str = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
     element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
const OBJ: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n";
/// A triangle of a serialized mesh: flags, name, counts, positions, corners.
pub fn serialized_triangle() -> Vec<u8> {
    let mut bytes = [0x1000u32.to_le_bytes().to_vec(), b"t\0".to_vec()].concat();
    [3u64, 1].iter().for_each(|count| bytes.extend(count.to_le_bytes()));
    [0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0].iter().for_each(|value| bytes.extend(value.to_le_bytes()));
    [0u32, 1, 2].iter().for_each(|index| bytes.extend(index.to_le_bytes()));
    bytes
}

/// The file that this is the zlib stream of.
pub fn serialized_file(stream: &[u8]) -> Vec<u8> {
    let mut encoder = flate2::write::ZlibEncoder::new(vec![0x1c, 0x04, 4, 0], flate2::Compression::fast());
    encoder.write_all(stream).unwrap();
    encoder.finish().unwrap()
}

/// The .glb file of this text and these bytes.
pub fn glb(text: &[u8], data: &[u8]) -> Vec<u8> {
    let padded = |bytes: &[u8], with: u8| {
        let mut bytes = bytes.to_vec();
        bytes.resize(bytes.len().next_multiple_of(4), with);
        bytes
    };
    let (text, data) = (padded(text, b' '), padded(data, 0));
    let word = |value: usize| (value as u32).to_le_bytes();
    let length = 28 + text.len() + data.len();
    [b"glTF\x02\0\0\0", &word(length)[..], &word(text.len()), b"JSON", &text, &word(data.len()), b"BIN\0", &data]
        .concat()
}

fn split(bytes: &[u8]) -> Option<(&[u8], &[u8])> {
    let at = bytes.windows(SEPARATOR.len()).position(|window| window == SEPARATOR)?;
    Some((&bytes[..at], &bytes[at + SEPARATOR.len()..]))
}

impl Folder {
    /// Makes a folder of that name, and in it what inputs may refer to: in memory, where there is such a place, since a disk takes
    /// far longer to write an input than a loader to read it.
    pub fn new(name: &str) -> Self {
        let memory = Some(PathBuf::from("/dev/shm")).filter(|folder| folder.is_dir());
        let path = memory.unwrap_or_else(std::env::temp_dir).join(format!("{name}-{}", std::process::id()));
        std::fs::create_dir_all(&path).unwrap();
        let folder = Self { path };
        let shape = |kind: &str| {
            format!(
                r#"<scene version="3.0.0"><shape type="{kind}"><string name="filename" value="scene.{kind}"/></shape></scene>"#
            )
        };
        for kind in ["obj", "ply", "serialized"] {
            folder.write(&format!("{kind}.xml"), shape(kind).as_bytes());
        }
        let image = r#"<string name="filename" value="scene.image"/>"#;
        folder.write(
            "image.xml",
            format!(
                r#"<scene version="3.0.0"><emitter type="envmap">{image}</emitter><shape type="rectangle"><bsdf type="diffuse">
                <texture name="reflectance" type="bitmap">{image}<boolean name="raw" value="true"/></texture></bsdf></shape></scene>"#
            )
            .as_bytes(),
        );
        folder.write("mesh.ply", PLY.as_bytes());
        folder.write("mesh.obj", OBJ.as_bytes());
        folder.write("mesh.serialized", &serialized_file(&serialized_triangle()));
        folder.write("data.bin", &[0; 256]);
        folder.write("x.spd", b"400 0.1\n700 0.5\n");
        folder.write("part.xml", br#"<scene version="3.0.0"><bsdf type="diffuse" id="part"/></scene>"#);
        let mut png = std::io::Cursor::new(Vec::new());
        image::RgbImage::from_fn(2, 2, |x, y| image::Rgb([90 * x as u8, 90 * y as u8, 30]))
            .write_to(&mut png, image::ImageFormat::Png)
            .unwrap();
        folder.write("image.png", &png.into_inner());
        folder
    }

    fn write(&self, name: &str, bytes: &[u8]) {
        std::fs::write(self.path.join(name), bytes).unwrap();
    }

    /// Writes an input; the files to load it by.
    fn put(&self, format: Format, bytes: &[u8]) -> Vec<&'static str> {
        match format {
            Format::Mitsuba => {
                self.write("scene.xml", bytes);
                vec!["scene.xml"]
            }
            Format::Gltf => {
                if bytes.starts_with(b"glTF") {
                    self.write("scene.glb", bytes);
                } else if let Some((text, data)) = split(bytes) {
                    self.write("scene.glb", &glb(text, data));
                } else {
                    self.write("scene.gltf", bytes);
                    return vec!["scene.gltf"];
                }
                vec!["scene.glb"]
            }
            Format::Obj => {
                let (obj, mtl) = split(bytes).unwrap_or((bytes, b""));
                self.write("scene.obj", obj);
                self.write("scene.mtl", mtl);
                vec!["scene.obj", "obj.xml"]
            }
            Format::Ply => {
                self.write("scene.ply", bytes);
                vec!["scene.ply", "ply.xml"]
            }
            Format::Serialized => {
                match bytes.strip_prefix(b"raw") {
                    Some(stream) => self.write("scene.serialized", &serialized_file(stream)),
                    None => self.write("scene.serialized", bytes),
                }
                vec!["serialized.xml"]
            }
            Format::Image => {
                self.write("scene.image", bytes);
                vec!["image.xml"]
            }
        }
    }

    /// Reads an input by every way that there is to it, and fails where a rule is broken. The messages of those that did not
    /// read it.
    pub fn check(&self, format: Format, bytes: &[u8]) -> Vec<String> {
        let ways = self.put(format, bytes);
        ways.iter().filter_map(|name| check_file(&self.path.join(name), &self.path).err()).collect()
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        // Where a rule was broken the input stays, to be looked at.
        if !std::thread::panicking() {
            let _ = std::fs::remove_dir_all(&self.path);
        }
    }
}

/// Reads a scene, and fails where a rule is broken; a message must contain the path `named`.
pub fn check_file(path: &Path, named: &Path) -> Result<Scene, String> {
    let before = LIVE.load(Relaxed);
    PEAK.store(before, Relaxed);
    let found = lumbre::scene::load(path, &LoadOptions::default());
    let taken = PEAK.load(Relaxed).saturating_sub(before);
    assert!(taken <= MOST_MEMORY, "{}: {} MiB were allocated", path.display(), taken >> 20);
    match found {
        Ok(scene) => {
            check_scene(&scene);
            Ok(scene)
        }
        Err(error) => {
            let message = error.to_string();
            assert_eq!(error.exit_status(), 2, "the file is at fault: {message}");
            assert!(!message.contains(char::is_control), "one line of plain text: {message:?}");
            assert!(message.chars().count() <= LONGEST_MESSAGE, "a short message: {message}");
            assert!(message.contains(&named.display().to_string()), "the message names the file: {message}");
            Err(message)
        }
    }
}

/// All numbers of a scene but those of its geometry and its images, each list with its name.
fn numbers(scene: &Scene) -> Vec<(&'static str, Vec<f32>)> {
    let materials = scene.materials.iter().flat_map(|m| {
        let of_metals = m.conductor_eta.into_iter().chain(m.conductor_k);
        [m.alpha_u, m.alpha_v, m.eta].into_iter().chain(m.reflectance).chain(m.transmittance).chain(of_metals)
    });
    let lights = scene.lights.iter().flat_map(|light| {
        let corners = light.v1.into_iter().chain(light.v2);
        light.position.into_iter().chain(corners).chain(light.radiance).chain([light.probability])
    });
    let textures = scene.textures.iter().flat_map(|t| t.scale.into_iter().chain(t.offset));
    let layers = scene.layereds.iter().flat_map(|l| {
        l.absorption.into_iter().chain(l.specular_colour).chain([
            l.dispersion,
            l.iridescence_eta,
            l.iridescence_thickness,
        ])
    });
    let rays = scene.cameras.iter().flat_map(|camera| {
        let film = camera.film.unwrap_or(scene.film);
        let plane = camera.image_plane(film.width, film.height);
        let vectors = [plane.origin, plane.corner, plane.dx, plane.dy, plane.lens_x, plane.lens_y];
        vectors.into_iter().flat_map(|vector| vector.as_vec3().to_array()).chain([plane.focus as f32])
    });
    let places = scene.instances.iter().flat_map(|placed| placed.to_world.to_cols_array().map(|value| value as f32));
    vec![
        ("normals", scene.normals.concat()),
        ("uvs", scene.uvs.concat()),
        ("second uvs", scene.second_uvs.concat()),
        ("tangents", scene.tangents.concat()),
        ("colours", scene.colours.concat()),
        ("attributes", scene.attributes.concat()),
        ("materials", materials.collect()),
        ("layers", layers.collect()),
        ("lights", lights.collect()),
        ("textures", textures.collect()),
        ("emission", scene.surfaces.iter().flat_map(|surface| surface.emission).collect()),
        ("background", scene.background.into_iter().flatten().collect()),
        ("rays", rays.collect()),
        ("places", places.collect()),
    ]
}

/// Every index exists, all numbers are finite, and what is made of a scene before it is uploaded can be made.
fn check_scene(scene: &Scene) {
    assert!(!scene.cameras.is_empty() && scene.film.width > 0 && scene.film.height > 0);
    for camera in &scene.cameras {
        assert!(camera.to_world.is_finite(), "camera {camera:?}");
    }
    for primitive in &scene.primitives {
        assert!(((primitive.surface & SURFACE_MASK) as usize) < scene.surfaces.len());
        let numbers = [primitive.v0, primitive.v1, primitive.v2];
        assert!(numbers.iter().flatten().all(|value| value.is_finite()), "{primitive:?}");
    }
    for (what, numbers) in numbers(scene) {
        let bad = numbers.iter().position(|value| !value.is_finite());
        assert!(bad.is_none(), "{what}: number {bad:?} of {} is not finite", numbers.len());
    }
    for group in &scene.groups {
        assert!(group.triangles.end == group.spheres.start && group.spheres.end as usize <= scene.primitives.len());
    }
    for instance in &scene.instances {
        assert!(instance.group < scene.groups.len() && instance.to_world.is_finite(), "{instance:?}");
    }
    for image in &scene.images {
        assert!(image.width > 0 && image.height > 0);
    }
    assert!(scene.warnings.iter().all(|warning| !warning.contains(char::is_control)), "{:?}", scene.warnings);
    let _ = Needs::of(scene).describe();
    for group in &scene.groups {
        let primitives = &scene.primitives[group.primitives()];
        // Larger trees take their time and nothing new.
        if primitives.len() <= 2000 {
            let boxes: Vec<_> = primitives.iter().map(lumbre::bvh::primitive_bounds).collect();
            Bvh::over_primitives(primitives, CHUNK, &|_| {}).validate(&boxes).unwrap();
        }
    }
}
