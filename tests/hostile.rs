//! Files that are broken, or that lie, or that are made to explode: each is refused quickly, in bounded memory, with one line that
//! says what is wrong and where; and whatever is done to a file, nothing panics.
//!
//! `tests/corpus` holds a file for each kind of fault (`make.py` there says what is wrong with it), `fuzz/` the targets that
//! looked for more.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use base64::Engine;

use crate::common::alone::alone;
use crate::common::hostile::{Folder, Format, check_file};
use crate::common::mutation::{self, Mutator};
use lumbre::scene::Scene;

/// What a broken file may take, on a machine that does other things besides.
const LONGEST: Duration = Duration::from_secs(20);

const FORMATS: [(Format, &str); 6] = [
    (Format::Mitsuba, "mitsuba"),
    (Format::Gltf, "gltf"),
    (Format::Obj, "obj"),
    (Format::Ply, "ply"),
    (Format::Serialized, "serialized"),
    (Format::Image, "image"),
];

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The files of a folder, in order.
fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
    let mut files: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).filter(|path| path.is_file()).collect();
    files.sort();
    files
}

/// Reads a file of the corpus; meshes and images that are no scenes by way of one.
fn read(path: &Path) -> Result<Scene, String> {
    let name = path.display();
    let body = match path.parent().and_then(Path::file_name).and_then(|name| name.to_str()) {
        Some("serialized") => {
            format!(r#"<shape type="serialized"><string name="filename" value="{name}"/></shape>"#)
        }
        Some("image") => format!(r#"<emitter type="envmap"><string name="filename" value="{name}"/></emitter>"#),
        _ => return check_file(path, path.parent().unwrap()),
    };
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("scene.xml");
    std::fs::write(&scene, format!(r#"<scene version="3.0.0">{body}</scene>"#)).unwrap();
    check_file(&scene, path)
}

/// A file of the corpus, and what its message must contain.
const BROKEN: &[(&str, &[&str])] = &[
    ("mitsuba/empty.xml", &["empty.xml:1", "root"]),
    ("mitsuba/truncated.xml", &["truncated.xml", "not well-formed XML"]),
    ("mitsuba/latin1.xml", &["latin1.xml:3", "not UTF-8"]),
    ("mitsuba/utf16.xml", &["utf16.xml:1", "not UTF-8"]),
    ("mitsuba/zero_byte.xml", &["zero_byte.xml:2", "\\0"]),
    ("mitsuba/deep.xml", &["deep.xml:2", "more than 64 deep"]),
    ("mitsuba/deep_references.xml", &["deep_references.xml:67", "more than 64 deep, references included"]),
    ("mitsuba/entity_bomb.xml", &["entity_bomb.xml", "<!DOCTYPE>"]),
    ("mitsuba/external_entity.xml", &["external_entity.xml", "<!DOCTYPE>"]),
    ("mitsuba/parameter_bomb.xml", &["parameter_bomb.xml:9", "$e6", "more than 16777216 bytes"]),
    ("mitsuba/include_cycle.xml", &["include_cycle.xml:2", "more than 16 deep", "cycle"]),
    ("mitsuba/include_bomb.xml", &["bomb2.xml", "more than 1048576 elements"]),
    ("mitsuba/include_folder.xml", &["include_folder.xml:2", "it is not a file"]),
    ("mitsuba/reference_to_itself.xml", &["reference_to_itself.xml:2", "<shape> refers to itself"]),
    ("mitsuba/instance_of_its_own.xml", &["instance_of_its_own.xml:3", "instance", "inside a shapegroup"]),
    ("mitsuba/integrators.xml", &["integrators.xml:2", "'aov'", "may have one"]),
    ("mitsuba/lines_in_a_name.xml", &["lines_in_a_name.xml:2", "velvet\\nerror"]),
    ("mitsuba/long_name.xml", &["long_name.xml:2", "velvet", " ... ", "supported are", "principled"]),
    ("mitsuba/huge_film.xml", &["huge_film.xml:3", "'width'", "70000", "65536"]),
    ("mitsuba/huge_integer.xml", &["huge_integer.xml:3", "'max_depth'", "not an integer"]),
    ("mitsuba/infinite_matrix.xml", &["infinite_matrix.xml:2", "'to_world'", "1e200 is out of range"]),
    ("gltf/empty.gltf", &["empty.gltf", "JSON"]),
    ("gltf/empty.glb", &["empty.glb", "JSON"]),
    ("gltf/truncated.gltf", &["truncated.gltf", "line 32"]),
    ("gltf/truncated.glb", &["truncated.glb", "claims 1296 bytes", "it has 400"]),
    ("gltf/chunk_too_long.glb", &["chunk_too_long.glb", "the chunk at byte 12 claims 4294967280 bytes"]),
    ("gltf/total_too_long.glb", &["total_too_long.glb", "claims 4294967295 bytes"]),
    ("gltf/latin1.gltf", &["latin1.gltf", "line 16 column"]),
    ("gltf/utf16.gltf", &["utf16.gltf", "line 1 column 1"]),
    ("gltf/deep.gltf", &["deep.gltf", "recursion limit"]),
    ("gltf/deep_extras.gltf", &["deep_extras.gltf", "recursion limit"]),
    ("gltf/cycle.gltf", &["nodes[2]", "nodes[1]", "is above it"]),
    ("gltf/own_child.gltf", &["nodes[1]", "is above it"]),
    ("gltf/two_parents.gltf", &["scenes[0]", "nodes[2]", "has another parent"]),
    ("gltf/node_missing.gltf", &["scenes[0]", "nodes[4294967295]", "has 3 nodes"]),
    (
        "gltf/accessor_out_of_range.gltf",
        &["meshes[0].primitives[0].attributes.POSITION: accessor 0", "bufferViews[0]", "48 bytes"],
    ),
    ("gltf/accessor_4e9.gltf", &["accessor 0", "4000000000 elements", "bufferViews[0]"]),
    ("gltf/accessor_2e64.gltf", &["primitives[0].indices: accessor 1", "18446744073709551615 elements"]),
    ("gltf/accessor_without_bytes.gltf", &["accessor 0", "1000000000000 elements", "no bufferView", "1048576"]),
    ("gltf/view_out_of_range.gltf", &["bufferViews[1]", "9223372036854775808", "buffers[0]"]),
    ("gltf/buffer_too_short.gltf", &["buffers[0]", "byteLength is 4000000000", "60 bytes"]),
    ("gltf/index_out_of_range.gltf", &["primitives[0].indices: accessor 1", "refers to vertex 49024", "there are 4"]),
    ("gltf/sparse_out_of_range.gltf", &["primitives[0].indices: accessor 1", "replaces element 191"]),
    ("gltf/sparse_more_than_all.gltf", &["primitives[0].indices: accessor 1", "sparse.count is 4", "has 3 elements"]),
    ("gltf/escape_parent.gltf", &["buffers[0]", "leaves the scene's folder"]),
    ("gltf/escape_encoded.gltf", &["buffers[0]", "leaves the scene's folder"]),
    ("gltf/escape_absolute.gltf", &["buffers[0]", "absolute"]),
    ("gltf/escape_backslash.gltf", &["buffers[0]", "leaves the scene's folder"]),
    ("gltf/escape_scheme.gltf", &["buffers[0]", "not a relative path"]),
    ("gltf/escape_device.gltf", &["buffers[0]", "absolute"]),
    ("gltf/escape_image.gltf", &["images[0]", "leaves the scene's folder"]),
    ("gltf/zero_byte_in_path.gltf", &["buffers[0]", "no path may have"]),
    ("gltf/image_lies.gltf", &["images[0]", "60000 x 60000", "268435456"]),
    ("obj/empty.obj", &["empty.obj", "no faces"]),
    ("obj/truncated.obj", &["truncated.obj:6", "position"]),
    ("obj/index_too_large.obj", &["index_too_large.obj:5", "vertex 4", "there are 3"]),
    ("obj/index_zero.obj", &["index_zero.obj:4", "the corner '0'", "integers from 1"]),
    ("obj/index_far_back.obj", &["index_far_back.obj:4", "vertex -4000000000", "3 by here"]),
    ("obj/index_far_back_texture.obj", &["index_far_back_texture.obj:6", "texture coordinate -6148914691236517206"]),
    ("obj/index_far_back_normal.obj", &["index_far_back_normal.obj:6", "normal -6148914691236517206"]),
    ("obj/absurd_index.obj", &["absurd_index.obj:4", "face"]),
    ("obj/not_finite.obj", &["not_finite.obj", "must be finite"]),
    ("obj/latin1.obj", &["latin1.obj:2", "UTF-8"]),
    ("obj/zero_bytes.obj", &["zero_bytes.obj:1", "position"]),
    ("obj/one_endless_line.obj", &["one_endless_line.obj:4", "face"]),
    ("obj/short_colour.obj", &["short_colour.mtl:2", "Kd", "three numbers"]),
    ("obj/mtl_latin1.obj", &["mtl_latin1.mtl:1", "UTF-8"]),
    ("obj/mtl_no_number.obj", &["mtl_no_number.mtl:3", "MTL"]),
    ("obj/negative_light.obj", &["negative_light.mtl", "material 'a'", "Ke"]),
    ("obj/mtl_folder.obj", &["mtl_folder.obj:5", "face"]),
    ("ply/empty.ply", &["empty.ply", "magic number"]),
    ("ply/truncated_header.ply", &["truncated_header.ply:5", "property fl"]),
    ("ply/truncated.ply", &["truncated.ply:12", "'1 '"]),
    ("ply/truncated_binary.ply", &["truncated_binary.ply", "'vertex'", "expected 3, got 2"]),
    ("ply/vertices_4e9.ply", &["'vertex'", "announces 4294967295 of 'vertex'"]),
    ("ply/vertices_2e64.ply", &["'vertex'", "announces 18446744073709551615 of 'vertex'"]),
    ("ply/vertices_2e70.ply", &["vertices_2e70.ply:4", "element vertex 1180591620717411303424"]),
    ("ply/faces_4e9.ply", &["'face'", "announces 4294967295 of 'face'"]),
    ("ply/list_4e9.ply", &["'face'", "expected 1, got 0"]),
    ("ply/list_negative.ply", &["list_negative.ply", "negative"]),
    ("ply/list_of_fractions.ply", &["'face'", "no list of integers"]),
    ("ply/without_bytes.ply", &["'nothing'", "no properties"]),
    ("ply/without_indices.ply", &["'face'", "'vertex_indices'"]),
    ("ply/index_too_large.ply", &["triangle 0", "vertex 3", "0 to 2"]),
    ("ply/infinite.ply", &["infinite.ply", "must be finite"]),
    ("ply/latin1.ply", &["latin1.ply", "UTF-8"]),
    ("ply/one_endless_line.ply", &["one_endless_line.ply", "end_header"]),
    ("serialized/empty.serialized", &["empty.serialized", "header"]),
    ("serialized/wrong_magic.serialized", &["0x4b50", "0x041c"]),
    ("serialized/truncated.serialized", &["truncated.serialized", "cannot be read"]),
    ("serialized/checksum.serialized", &["checksum.serialized", "corrupt"]),
    ("serialized/vertices_4e9.serialized", &["4294967295 positions"]),
    ("serialized/vertices_2e64.serialized", &["18446744073709551615 vertices"]),
    ("serialized/triangles_2e64.serialized", &["18446744073709551615 triangles"]),
    ("serialized/index_too_large.serialized", &["triangle 0", "vertex 3"]),
    ("serialized/endless_name.serialized", &["name", "65536"]),
    ("serialized/bomb.serialized", &["triangles", "too early"]),
    ("image/empty.png", &["empty.png", "PNG, JPEG"]),
    ("image/text.png", &["text.png", "PNG, JPEG"]),
    ("image/truncated.png", &["truncated.png", "too early"]),
    ("image/checksum.png", &["checksum.png", "CRC"]),
    ("image/short_data.png", &["short_data.png", "not a valid", "enough data"]),
    ("image/nothing.png", &["nothing.png", "dimensions"]),
    ("image/60000x60000.png", &["60000 x 60000", "268435456"]),
    ("image/16384x16384.png", &["16384 x 16384", "more than its 69 bytes can hold"]),
    ("image/side_2e31.png", &["side_2e31.png", "limit"]),
    ("image/bomb.png", &["20000 x 20000", "268435456"]),
    ("image/truncated.hdr", &["truncated.hdr", "too early"]),
    ("image/60000x60000.hdr", &["60000 x 60000", "268435456"]),
    ("image/16384x16384.hdr", &["16384 x 16384", "more than its 69 bytes can hold"]),
    ("image/no_size.hdr", &["no_size.hdr", "height"]),
    ("image/truncated.jpg", &["truncated.jpg", "Not enough bytes"]),
    ("image/65500x65500.jpg", &["65500 x 65500", "268435456"]),
    ("image/16384x16384.jpg", &["16384 x 16384", "more than its 316 bytes can hold"]),
    ("image/truncated.exr", &["truncated.exr", "missing bytes"]),
    ("image/65535x65535.exr", &["65535 x 65535", "268435456"]),
    ("image/16384x16384.exr", &["16384 x 16384", "more than its 447 bytes can hold"]),
    ("image/box_2e31.exr", &["box_2e31.exr", "window"]),
    ("image/box_inside_out.exr", &["box_inside_out.exr", "EXR"]),
    ("image/b44_wraps.exr", &["b44_wraps.exr", "texel (0, 0)", "NaN"]),
    ("image/not_a_number.exr", &["not_a_number.exr", "texel (3, 3)", "NaN"]),
];

#[test]
fn broken_files_are_refused() {
    // Memory is counted for the whole process.
    alone(|| {
        let corpus = root().join("tests/corpus");
        let mut faults = Vec::new();
        let mut seen = BTreeSet::new();
        for (name, expected) in BROKEN {
            seen.insert(corpus.join(name));
            let start = Instant::now();
            let found = read(&corpus.join(name));
            let taken = start.elapsed();
            match found {
                Ok(_) => faults.push(format!("{name}: was read")),
                Err(message) => {
                    let missing: Vec<_> = expected.iter().filter(|part| !message.contains(**part)).collect();
                    if !missing.is_empty() {
                        faults.push(format!("{name}: {missing:?} is not in: {message}"));
                    }
                }
            }
            if taken > LONGEST {
                faults.push(format!("{name}: took {taken:?}"));
            }
        }
        for (_, name) in FORMATS {
            for path in files(&corpus.join(name)) {
                let is_part = path.extension().is_some_and(|extension| extension == "mtl");
                if !is_part && !seen.contains(&path) {
                    faults.push(format!("{} has no row: {:?}", path.display(), read(&path).err()));
                }
            }
        }
        assert!(faults.is_empty(), "{}", faults.join("\n"));
    });
}

/// The files that mutations begin with are sound, and those that would explode if they were read naively are read.
#[test]
fn sound_files_are_read() {
    // Memory is counted for the whole process.
    alone(|| {
        let folder = Folder::new("lumbre-sound");
        for (format, name) in FORMATS {
            for path in files(&root().join("tests/corpus/sound").join(name)) {
                let start = Instant::now();
                let messages = folder.check(format, &std::fs::read(&path).unwrap());
                assert!(messages.is_empty(), "{}: {messages:?}", path.display());
                assert!(start.elapsed() < LONGEST, "{}", path.display());
            }
        }
    });
}

/// What a line of a file is costs no more where there are many of them, or where one is very long.
#[test]
fn many_elements_take_their_share_of_time() {
    // Memory is counted for the whole process.
    alone(|| {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("scene.xml");
        let elements = r#"<default name="a" value="b"/>"#.repeat(100_000);
        std::fs::write(&path, format!("<scene version=\"3.0.0\">\n{elements}\n<shape type=\"teapot\"/></scene>"))
            .unwrap();
        let start = Instant::now();
        assert!(check_file(&path, &path).unwrap_err().contains("scene.xml:3"));
        assert!(start.elapsed() < LONGEST, "{:?}", start.elapsed());
        // A statement of a million lines, which took minutes where each line was searched from its beginning.
        let path = folder.path().join("scene.obj");
        let triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
        std::fs::write(&path, format!("{triangle}call {}\n", "1 \\\n".repeat(1_000_000))).unwrap();
        let start = Instant::now();
        assert_eq!(check_file(&path, &path).unwrap().primitives.len(), 1);
        assert!(start.elapsed() < LONGEST, "{:?}", start.elapsed());
        // An image of 16 MiB of text, and a thousand materials of it, of which each decoded it again.
        let path = folder.path().join("scene.gltf");
        let image = image_with_bytes_behind(12 << 20);
        let count = 1000;
        let list = |one: &dyn Fn(usize) -> String| (0..count).map(one).collect::<Vec<_>>().join(",");
        let text = format!(
            r#"{{"asset": {{"version": "2.0"}}, "images": [{{"uri": "{image}"}}], "textures": [{{"source": 0}}],
            "materials": [{}], "meshes": [{{"primitives": [{}]}}], "nodes": [{{"mesh": 0}}],
            "accessors": [{{"componentType": 5126, "type": "VEC3", "count": 3}}]}}"#,
            list(&|_| String::from(r#"{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}"#)),
            list(&|index| format!(r#"{{"attributes": {{"POSITION": 0}}, "material": {index}}}"#)),
        );
        std::fs::write(&path, text).unwrap();
        let start = Instant::now();
        let scene = check_file(&path, &path).unwrap();
        assert_eq!((scene.images.len(), scene.textures.len()), (1, count));
        assert!(start.elapsed() < LONGEST, "{:?}", start.elapsed());
    });
}

/// The data URI of a PNG image of one texel, with so many bytes behind its end.
fn image_with_bytes_behind(bytes: usize) -> String {
    let mut png = crate::common::gltf::png(1, 1, &[[200, 100, 50, 255]]);
    png.resize(png.len() + bytes, 0);
    format!("data:image/png;base64,{}", base64::engine::general_purpose::STANDARD.encode(png))
}

/// Folders, devices and pipes are no files: opened as such some of them would never end.
#[test]
fn what_is_no_file_is_refused() {
    // Memory is counted for the whole process.
    alone(|| {
        let temporary = tempfile::tempdir().unwrap();
        let refused = |path: &Path, expected: &str| {
            let message = check_file(path, temporary.path()).unwrap_err();
            assert!(message.contains(expected) && message.contains("it is not a file"), "{message}");
        };
        for name in ["a.xml", "a.gltf", "a.glb", "a.obj", "a.ply"] {
            let path = temporary.path().join(name);
            std::fs::create_dir(&path).unwrap();
            refused(&path, name);
        }
        let scene = temporary.path().join("scene.xml");
        for name in ["a.ply", "/dev/zero"] {
            for body in [
                format!(r#"<shape type="ply"><string name="filename" value="{name}"/></shape>"#),
                format!(r#"<shape type="obj"><string name="filename" value="{name}"/></shape>"#),
                format!(r#"<shape type="serialized"><string name="filename" value="{name}"/></shape>"#),
                format!(r#"<emitter type="envmap"><string name="filename" value="{name}"/></emitter>"#),
                format!(r#"<bsdf type="diffuse"><spectrum name="reflectance" filename="{name}"/></bsdf>"#),
                format!(r#"<include filename="{name}"/>"#),
            ] {
                std::fs::write(&scene, format!("<scene version=\"3.0.0\">\n{body}</scene>")).unwrap();
                refused(&scene, "scene.xml:2");
            }
        }
        let gltf = temporary.path().join("scene.gltf");
        std::fs::write(&gltf, r#"{"asset": {"version": "2.0"}, "buffers": [{"byteLength": 1, "uri": "a.ply"}]}"#)
            .unwrap();
        refused(&gltf, "a.ply");
        // A missing material library is a warning, and so is one that is no file.
        let obj = temporary.path().join("scene.obj");
        std::fs::write(&obj, "mtllib a.ply\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
        let scene = check_file(&obj, temporary.path()).unwrap();
        assert!(scene.warnings.iter().any(|warning| warning.contains("it is not a file")), "{:?}", scene.warnings);
    });
}

/// What mutations of a format begin with: what is small enough of the corpus, the scenes and the references; and how many of
/// them, the first ones, are sound.
fn seeds(format: Format, name: &str) -> (Vec<Vec<u8>>, usize) {
    let mut folders = vec![root().join("tests/corpus/sound").join(name)];
    match format {
        Format::Mitsuba => folders.extend([root().join("scenes"), root().join("tests/references")]),
        Format::Gltf => folders.push(root().join("scenes/gltf_room")),
        Format::Obj => folders.push(root().join("scenes/cornell")),
        Format::Image => folders.push(root().join("tests/references")),
        Format::Ply | Format::Serialized => {}
    }
    let extensions: &[&str] = match format {
        Format::Mitsuba => &["xml"],
        Format::Gltf => &["gltf", "glb"],
        Format::Obj => &["obj"],
        Format::Ply => &["ply"],
        Format::Serialized => &["serialized"],
        Format::Image => &["png", "jpg", "hdr", "exr"],
    };
    let is_seed = |path: &PathBuf| {
        let extension = path.extension().unwrap_or_default().to_str().unwrap();
        extensions.contains(&extension) && path.metadata().unwrap().len() <= 1 << 13
    };
    let mut seeds = Vec::new();
    let mut add = |folder: &Path| {
        seeds.extend(files(folder).into_iter().filter(is_seed).map(|path| std::fs::read(path).unwrap()));
        seeds.len()
    };
    let sound = folders.iter().map(|folder| add(folder)).last().unwrap_or_default();
    add(&root().join("tests/corpus").join(name));
    if format == Format::Mitsuba {
        seeds.iter_mut().for_each(|seed| *seed = mutation::retargeted(seed));
    }
    (seeds, sound)
}

/// Many small changes to files of each format, the same ones each time: no panic, no more memory than the limit.
#[test]
fn mutations_never_panic() {
    // Memory is counted for the whole process.
    alone(|| {
        let folder = Folder::new("lumbre-mutations");
        for ((format, name), rounds) in FORMATS.into_iter().zip([6000; 6]) {
            let (seeds, sound) = seeds(format, name);
            let mut mutator = Mutator::new(20_240_607);
            let (start, mut read) = (Instant::now(), 0);
            for _ in 0..rounds {
                read += usize::from(folder.check(format, &mutator.mutated(&seeds, sound)).is_empty());
            }
            println!(
                "{name}: {rounds} mutations of {} files ({sound} sound), {read} were read, {:?}",
                seeds.len(),
                start.elapsed()
            );
            assert!(
                read > rounds / 100 && read < rounds * 9 / 10,
                "{name}: {read} of {rounds} were read: mutations of no use"
            );
        }
    });
}
