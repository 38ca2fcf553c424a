//! What scene files mean: each test states the picture that a small file must give.

use std::path::PathBuf;

use crate::common::{assert_mean, average, backends, backends_in_time, canon, load_files, render, settings, with_gpu};
use glam::DVec3;
use lumbre::layout::backend::Backend;
use lumbre::layout::{MATERIAL_DIELECTRIC, NONE, SMOOTH_BIT, SPHERE_BIT};
use lumbre::render::Settings;
use lumbre::scene::{Filter, LoadOptions, Needs, Scene};

/// A Mitsuba scene of these elements and a camera at (0, 0, 5) that looks at the origin.
fn mitsuba(body: &str) -> Scene {
    let camera = r#"<sensor type="perspective"><float name="fov" value="20"/>
        <transform name="to_world"><lookat origin="0, 0, 5" target="0, 0, 0" up="0, 1, 0"/></transform>
        <film type="hdrfilm"><integer name="width" value="16"/><integer name="height" value="16"/><rfilter type="box"/></film></sensor>"#;
    load_files(&[("scene.xml", &format!(r#"<scene version="3.0.0">{camera}{body}</scene>"#))]).unwrap()
}

/// The mean of the picture that `path` makes, on the first backend.
fn mean(scene: &Scene, spp: u32) -> [f64; 3] {
    with_gpu(|gpu| {
        average(&render(gpu, scene, &settings(scene, "path", backends(gpu)[0]), spp)).map(|channel| channel.mean)
    })
}

fn close(found: [f64; 3], expected: [f64; 3]) {
    let off = found.iter().zip(expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(
        off < 2e-3 * expected.iter().fold(0.1, |most: f64, value| most.max(*value)),
        "{found:?} against {expected:?}"
    );
}

#[test]
fn the_canon_loads_without_warnings_and_renders() {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let mut files: Vec<_> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .filter(|name| name.ends_with(".xml"))
        .collect();
    files.sort();
    assert!(files.len() >= 6, "{files:?}");
    for name in files {
        let text = std::fs::read_to_string(crate::common::scene_path(&name)).unwrap();
        assert!(text.contains("What to look for:"), "{name} should open with a comment that says what to look for");
        let scene = canon(&name, &[]);
        assert!(scene.warnings.is_empty(), "{name}: {:?}", scene.warnings);
        with_gpu(|gpu| {
            for backend in backends_in_time(gpu) {
                let mut settings = settings(&scene, "path", backend);
                (settings.width, settings.height) = (32, 24);
                let film = render(gpu, &scene, &settings, 8);
                let [r, g, _] = film.average(); // the sun of small_vcm.xml has no blue
                assert!(r.min(g) > 1e-3, "{name} on {}: {:?}", backend.name(), film.average());
            }
        });
    }
}

/// A unit square that emits 1, 2, 3 and fills the picture.
const EMITTER: &str =
    r#"<shape type="rectangle"><emitter type="area"><rgb name="radiance" value="1, 2, 3"/></emitter></shape>"#;

#[test]
fn area_lights_shine_from_their_front_only() {
    close(mean(&mitsuba(EMITTER), 4), [1.0, 2.0, 3.0]);
    let turned =
        EMITTER.replace("<emitter", r#"<transform name="to_world"><rotate y="1" angle="180"/></transform><emitter"#);
    let turned = mitsuba(&format!(r#"{turned}<emitter type="constant"><rgb name="radiance" value="0.25"/></emitter>"#));
    close(mean(&turned, 4), [0.0; 3]); // black from behind, and it hides the sky
    let flipped = EMITTER.replace("<emitter", r#"<boolean name="flip_normals" value="true"/><emitter"#);
    let flipped =
        mitsuba(&format!(r#"{flipped}<emitter type="constant"><rgb name="radiance" value="0.25"/></emitter>"#));
    close(mean(&flipped, 4), [0.0; 3]);
}

#[test]
fn disks_and_cylinders_shine_outwards() {
    let sky = r#"<emitter type="constant"><rgb name="radiance" value="0.25"/></emitter>"#;
    let shape = |kind: &str, transform: &str, extra: &str| {
        let opening = format!(
            r#"<shape type="{kind}">{extra}<transform name="to_world">{transform}</transform><emitter type="area""#
        );
        let body = EMITTER.replace(r#"<shape type="rectangle"><emitter type="area""#, &opening);
        mitsuba(&format!("{body}{sky}"))
    };
    let flip = r#"<boolean name="flip_normals" value="true"/>"#;
    let lit = [1.0, 2.0, 3.0];
    close(mean(&shape("disk", r#"<scale value="2"/>"#, ""), 4), lit);
    close(mean(&shape("disk", r#"<scale value="2"/>"#, flip), 4), [0.0; 3]);
    close(mean(&shape("disk", r#"<scale x="-2" y="3"/>"#, ""), 4), lit);
    close(mean(&shape("disk", r#"<scale x="2" y="2" z="-1"/>"#, ""), 4), [0.0; 3]);
    // A cylinder along x that fills the picture, seen from outside, and one along the view that is seen from inside.
    let axis =
        r#"<point name="p0" x="-9" y="0" z="0"/><point name="p1" x="9" y="0" z="0"/><float name="radius" value="2"/>"#;
    close(mean(&shape("cylinder", "", axis), 4), lit);
    close(mean(&shape("cylinder", r#"<scale x="-1"/>"#, axis), 4), lit);
    close(mean(&shape("cylinder", "", &format!("{axis}{flip}")), 4), [0.0; 3]);
    // It is so long that no ray finds its far end.
    let inside = r#"<scale x="2" y="2" z="-90000"/><translate z="6"/>"#;
    close(mean(&shape("cylinder", inside, ""), 4), [0.0; 3]);
    close(mean(&shape("cylinder", inside, flip), 4), lit);
}

#[test]
fn cylinders_lie_between_their_points() {
    let scene = mitsuba(
        r#"<shape type="cylinder"><point name="p0" x="1" y="0" z="0"/><point name="p1" x="1" y="2" z="0"/>
        <float name="radius" value="0.5"/><transform name="to_world"><scale x="2"/></transform></shape>"#,
    );
    // An ellipse in x and z: Mitsuba warns of it, and has the same one.
    let expected = [(1.0, 3.0), (0.0, 2.0), (-0.5, 0.5)];
    for (axis, (low, high)) in expected.into_iter().enumerate() {
        let off = (scene.bounds.min[axis] - low).abs().max((scene.bounds.max[axis] - high).abs());
        assert!(off < 1e-4, "axis {axis}: {:?}", scene.bounds);
    }
    for corners in &scene.corners {
        let normal = glam::Vec3::from(scene.normals[corners.i0 as usize]);
        assert!(normal.y.abs() < 1e-6 && (normal.length() - 1.0).abs() < 1e-6, "{normal}");
    }
}

#[test]
fn mirrored_shapes_keep_their_front() {
    // The inverse transpose carries the normal: a mirrored rectangle still faces +z, a mirrored cube outwards, and a
    // mirrored sphere inwards, as in Mitsuba.
    let mirror = r#"<transform name="to_world"><scale x="-1"/></transform>"#;
    close(mean(&mitsuba(&EMITTER.replace("<emitter", &format!("{mirror}<emitter"))), 4), [1.0, 2.0, 3.0]);
    let cube = EMITTER.replace("rectangle", "cube").replace("<emitter", &format!("{mirror}<emitter"));
    close(mean(&mitsuba(&cube), 4), [1.0, 2.0, 3.0]);
    let mirror = r#"<transform name="to_world"><scale x="-2" y="2" z="2"/></transform>"#;
    let sphere = EMITTER.replace("rectangle", "sphere").replace("<emitter", &format!("{mirror}<emitter"));
    close(mean(&mitsuba(&format!("{sphere}<emitter type=\"constant\"/>")), 4), [0.0; 3]);
}

#[test]
fn the_background_fills_what_is_empty() {
    close(
        mean(&mitsuba(r#"<emitter type="constant"><rgb name="radiance" value="0.5, 0.25, 4"/></emitter>"#), 1),
        [0.5, 0.25, 4.0],
    );
    // A uniform spectrum that emits is equal-energy white, whose linear sRGB values are these.
    let white = mitsuba(r#"<emitter type="constant"><spectrum name="radiance" value="0.5"/></emitter>"#);
    close(mean(&white, 1), [0.6024, 0.47415, 0.45446]);
}

/// Samples over wavelength become the colours that Mitsuba 3.9 makes of them: as a reflectance and as an index of refraction
/// under D65, as an emission without it.
#[test]
fn spectra_become_colours() {
    let samples = r#"value="400:0.1, 500:0.5, 600:0.9, 700:0.2""#;
    let body = |samples: &str| {
        format!(
            r##"<scene version="3.0.0"><bsdf type="diffuse"><spectrum name="reflectance" {samples}/></bsdf>
            <bsdf type="conductor"><spectrum name="eta" value="580:1.5, 590:2.5, 720:2"/><spectrum name="k" value="0.25"/></bsdf>
            <bsdf type="diffuse"><srgb name="reflectance" value="#ffbc00"/></bsdf>
            <emitter type="constant"><spectrum name="radiance" {samples}/></emitter></scene>"##
        )
    };
    let near = |found: [f32; 3], expected: [f32; 3]| {
        let off = found.iter().zip(expected).map(|(a, b)| (a - b).abs() / b.max(0.01)).fold(0.0, f32::max);
        assert!(off < 1e-4, "{found:?} against {expected:?}");
    };
    let file = "# nm, value\n400 0.1\n500 0.5 # green\n\n600 0.9\n700 0.2\n";
    for (text, files) in [(body(samples), vec![]), (body(r#"filename="x.spd""#), vec![("x.spd", file)])] {
        let scene = load_files(&[vec![("scene.xml", text.as_str())], files].concat()).unwrap();
        near(scene.materials[0].reflectance, [0.833_826, 0.689_122, 0.265_243]);
        near(scene.background.unwrap(), [0.974_324, 0.661_608, 0.229_711]);
        // An index of refraction may exceed 1; what is negative is clamped, which is said.
        near(scene.materials[1].conductor_eta, [2.828_887, 0.073_553, 0.0]);
        assert_eq!(scene.materials[1].conductor_k, [0.25; 3]);
        let said = scene.warnings.iter().filter(|warning| warning.contains("scene.xml:2: 'eta'")).count();
        assert_eq!(said, 1, "{:?}", scene.warnings);
        // 0xbc / 255 = 0.737255, and ((0.737255 + 0.055) / 1.055)^2.4 = 0.502886.
        near(scene.materials[2].reflectance, [1.0, 0.502_886, 0.0]);
    }
    let orange = r#"<scene version="3.0.0"><bsdf type="diffuse"><spectrum name="reflectance" value="590:1, 830:1"/></bsdf></scene>"#;
    let scene = load_files(&[("scene.xml", orange)]).unwrap();
    assert_eq!(scene.materials[0].reflectance[0], 1.0, "a reflectance is clamped to 1, too");
}

/// A large square at z = 0, lit by something in front of it.
fn lit(emitter: &str, bsdf: &str) -> Scene {
    mitsuba(&format!(
        r#"<shape type="rectangle"><transform name="to_world"><scale value="50"/></transform>{bsdf}</shape>{emitter}"#
    ))
}

const GREY: &str = r#"<bsdf type="diffuse"><rgb name="reflectance" value="0.5"/></bsdf>"#;

#[test]
fn a_directional_light_gives_its_irradiance() {
    // L = albedo / pi * E cos; light that travels along -z meets the square head-on.
    let expected = 0.5 / std::f64::consts::PI * 2.0;
    let light = |direction: &str| {
        format!(
            r#"<emitter type="directional"><vector name="direction" {direction}/><rgb name="irradiance" value="2"/></emitter>"#
        )
    };
    close(mean(&lit(&light(r#"x="0" y="0" z="-1""#), GREY), 4), [expected; 3]);
    close(mean(&lit(&light(r#"x="0" y="3" z="-3""#), GREY), 4), [expected * 0.5f64.sqrt(); 3]);
    close(mean(&lit(&light(r#"x="0" y="0" z="1""#), GREY), 4), [0.0; 3]);
}

#[test]
fn point_and_spot_lights_give_intensity_over_distance_squared() {
    let close_up = |scene: &Scene| {
        with_gpu(|gpu| {
            let mut settings = settings(scene, "path", backends(gpu)[0]);
            settings.width = 1;
            settings.height = 1;
            let mut scene = scene.clone();
            scene.cameras[0].fov = 0.01; // one point of the square
            average(&render(gpu, &scene, &settings, 16))[0].mean
        })
    };
    let distance2 = 4.0;
    let expected = 0.5 / std::f64::consts::PI * 7.0 / distance2;
    let point = r#"<emitter type="point"><point name="position" x="0" y="0" z="2"/><rgb name="intensity" value="7"/></emitter>"#;
    assert!((close_up(&lit(point, GREY)) / expected - 1.0).abs() < 1e-3);
    // In the beam a spot is a point; halfway between beam and cut-off it has half the intensity; beyond, none.
    let spot = |angle: f64| {
        format!(
            r#"<emitter type="spot"><float name="cutoff_angle" value="30"/><float name="beam_width" value="20"/>
            <rgb name="intensity" value="7"/><transform name="to_world">
            <rotate x="1" angle="{angle}"/><rotate y="1" angle="180"/><translate z="2"/></transform></emitter>"#
        )
    };
    for (angle, share) in [(0.0, 1.0), (15.0, 1.0), (25.0, 0.5), (35.0, 0.0)] {
        let found = close_up(&lit(&spot(angle), GREY)) / expected;
        assert!((found - share).abs() < 1e-3, "{angle} degrees off the axis: {found} of the intensity, not {share}");
    }
}

#[test]
fn one_sided_materials_are_black_from_behind() {
    let sky = r#"<emitter type="constant"><rgb name="radiance" value="1"/></emitter>"#;
    let turned = |bsdf: &str| {
        mitsuba(&format!(
            r#"{sky}<shape type="rectangle"><transform name="to_world"><scale value="50"/><rotate y="1" angle="180"/></transform>{bsdf}</shape>"#
        ))
    };
    close(mean(&lit(sky, GREY), 64), [0.5; 3]);
    close(mean(&turned(GREY), 4), [0.0; 3]);
    close(mean(&turned(&format!(r#"<bsdf type="twosided">{GREY}</bsdf>"#)), 64), [0.5; 3]);
    let other = r#"<bsdf type="diffuse"><rgb name="reflectance" value="0.25"/></bsdf>"#;
    close(mean(&turned(&format!(r#"<bsdf type="twosided">{GREY}{other}</bsdf>"#)), 64), [0.25; 3]);
}

#[test]
fn mirrors_show_what_they_face() {
    // A perfect mirror shows the sky; with eta and k it is darker by Fresnel's factor at (almost) normal incidence:
    // ((eta - 1)² + k²) / ((eta + 1)² + k²).
    let sky = r#"<emitter type="constant"><rgb name="radiance" value="1"/></emitter>"#;
    close(mean(&lit(sky, r#"<bsdf type="conductor"/>"#), 4), [1.0; 3]);
    let (eta, k): (f64, f64) = (0.2, 3.9);
    let fresnel = ((eta - 1.0).powi(2) + k * k) / ((eta + 1.0).powi(2) + k * k);
    let metal = r#"<bsdf type="conductor"><rgb name="eta" value="0.2"/><rgb name="k" value="3.9"/></bsdf>"#;
    close(mean(&lit(sky, metal), 4), [fresnel; 3]);
}

#[test]
fn conductors_have_names() {
    let metal = |name: &str| {
        let kind = if name == "W" { "roughconductor" } else { "conductor" };
        let rough = if name == "W" { r#"<string name="distribution" value="ggx"/>"# } else { "" };
        let bsdf = format!(r#"<bsdf type="{kind}"><string name="material" value="{name}"/>{rough}</bsdf>"#);
        let scene = load_files(&[("scene.xml", &format!(r#"<scene version="3.0.0">{bsdf}</scene>"#))]).unwrap();
        (scene.materials[0].conductor_eta, scene.materials[0].conductor_k)
    };
    // As Mitsuba 3.9 has them.
    assert_eq!(metal("Au"), ([0.143_036, 0.375_307, 1.442_05], [3.983, 2.385_56, 1.603_36]));
    assert_eq!(metal("W"), ([4.370_82, 3.300_25, 2.998_41], [3.500_64, 2.604_87, 2.273_23]));
    assert_eq!(metal("AlAs"), metal("AlAs_palik"));
    assert_ne!(metal("Cu"), metal("Cu_palik"));
    assert_eq!(metal("none"), ([0.0; 3], [1.0; 3]));
    // One of the two indices alone leaves the other at the mirror's.
    let scene = r#"<scene version="3.0.0"><bsdf type="conductor"><rgb name="eta" value="1, 2, 3"/></bsdf></scene>"#;
    let scene = load_files(&[("scene.xml", scene)]).unwrap();
    assert_eq!((scene.materials[0].conductor_eta, scene.materials[0].conductor_k), ([1.0, 2.0, 3.0], [1.0; 3]));
}

#[test]
fn transforms_apply_in_order() {
    // First the scale, then the shift: the square lies at x = 3 with a half-width of 2, and the camera's centre sees x = 0.
    let at = |parts: &str| {
        mitsuba(&EMITTER.replace("<emitter", &format!("<transform name=\"to_world\">{parts}</transform><emitter")))
    };
    let bounds = |scene: &Scene| (scene.bounds.min.x, scene.bounds.max.x);
    assert_eq!(bounds(&at(r#"<scale value="2"/><translate x="3"/>"#)), (1.0, 5.0));
    assert_eq!(bounds(&at(r#"<translate x="3"/><scale value="2"/>"#)), (4.0, 8.0));
    let (low, high) = bounds(&at(r#"<matrix value="0 -1 0 5  1 0 0 0  0 0 1 0  0 0 0 1"/>"#));
    assert!((low - 4.0).abs() < 1e-6 && (high - 6.0).abs() < 1e-6);
}

#[test]
fn groups_are_placed_by_instances() {
    let scene = mitsuba(
        r#"<shape type="shapegroup" id="group">
            <shape type="rectangle"><ref id="grey"/></shape>
            <shape type="sphere"><float name="radius" value="0.5"/><ref id="grey"/></shape>
        </shape>
        <shape type="instance"><ref id="group"/><transform name="to_world"><translate x="3"/></transform></shape>
        <shape type="instance"><ref id="group"/><transform name="to_world"><scale value="2"/></transform></shape>
        <emitter type="constant"/>"#
            .replace(
                "<shape type=\"shapegroup\"",
                &format!("{}<shape type=\"shapegroup\"", GREY.replace("<bsdf", "<bsdf id=\"grey\"")),
            )
            .as_str(),
    );
    assert_eq!((scene.groups.len(), scene.instances.len()), (2, 2));
    assert_eq!((scene.bounds.min.x, scene.bounds.max.x), (-2.0, 4.0));
    assert!(Needs::of(&scene).instances && Needs::of(&scene).spheres);
}

/// Normals go by the inverse transpose: a slanted square that is stretched by its instance is lit like one that was
/// stretched in its file.
#[test]
fn stretched_instances_turn_their_normals() {
    let slanted = r#"<transform name="to_world"><rotate x="1" angle="-50"/>STRETCH</transform>"#;
    let stretch = r#"<scale x="1" y="1" z="3"/>"#;
    let light = r#"<emitter type="directional"><vector name="direction" value="0.2, -1, -0.4"/></emitter>"#;
    let plain = format!(r#"<shape type="rectangle">{}{GREY}</shape>{light}"#, slanted.replace("STRETCH", stretch));
    let placed = format!(
        r#"<shape type="shapegroup" id="g"><shape type="rectangle">{}{GREY}</shape></shape>
        <shape type="instance"><ref id="g"/><transform name="to_world">{stretch}</transform></shape>{light}"#,
        slanted.replace("STRETCH", "")
    );
    let [expected, found] = [plain, placed].map(|body| mean(&mitsuba(&body), 64));
    assert!(expected[0] > 0.01, "{expected:?}");
    assert!((found[0] / expected[0] - 1.0).abs() < 1e-3, "{found:?} against {expected:?}");
}

/// A flat square as OBJ or PLY, counter-clockwise from +z.
const SQUARE_OBJ: &str = "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nf 1 2 3 4\n";

#[test]
fn meshes_get_vertex_normals_unless_told_otherwise() {
    let scene = |extra: &str| {
        let xml = format!(
            r#"<scene version="3.0.0"><shape type="obj"><string name="filename" value="square.obj"/>{extra}</shape><emitter type="constant"/></scene>"#
        );
        load_files(&[("scene.xml", xml.as_str()), ("square.obj", SQUARE_OBJ)]).unwrap()
    };
    let smooth = scene("");
    assert!(smooth.primitives.iter().all(|primitive| primitive.surface & SMOOTH_BIT != 0));
    assert!(smooth.normals.iter().all(|normal| *normal == [0.0, 0.0, 1.0]));
    let flat = scene(r#"<boolean name="face_normals" value="true"/>"#);
    assert!(flat.primitives.iter().all(|primitive| primitive.surface & SMOOTH_BIT == 0));
    assert!(flat.normals.is_empty() && flat.corners.is_empty(), "what no mesh has is not stored");
}

#[test]
fn obj_brings_its_materials_along() {
    let obj =
        "mtllib square.mtl\nv -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nusemtl red\nf 1 2 3\nusemtl glow\nf -4 -2 -1\n";
    let mtl = "newmtl red\nKd 0.8 0.1 0.1\nnewmtl glow\nKd 0 0 0\nKe 2 3 4\n";
    let scene = load_files(&[("square.obj", obj), ("square.mtl", mtl)]).unwrap();
    assert_eq!(scene.primitives.len(), 2);
    assert_eq!(scene.lights.len(), 1);
    assert_eq!(scene.lights[0].radiance, [2.0, 3.0, 4.0]);
    let red = &scene.materials[scene.surfaces[scene.primitives[0].surface as usize].front as usize];
    assert_eq!(red.reflectance, [0.8, 0.1, 0.1]);
    assert_eq!(scene.warnings.len(), 1, "only the camera is missing: {:?}", scene.warnings);

    let scene = load_files(&[("square.obj", obj)]).unwrap();
    assert!(scene.warnings.iter().any(|warning| warning.contains("square.mtl")), "{:?}", scene.warnings);
}

/// The same triangle in the three encodings of PLY, with a property that nobody knows.
#[test]
fn ply_encodings_agree() {
    let header = |format: &str| {
        format!(
            "ply\nformat {format} 1.0\ncomment a triangle\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
             property uchar confidence\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
        )
    };
    let positions = [[0.0f32, 0.0, 0.0], [1.0, 0.0, 0.5], [0.0, 2.0, 0.0]];
    let mut files = vec![(header("ascii") + "0 0 0 7\n1 0 0.5 7\n0 2 0 7\n3 0 1 2\n").into_bytes()];
    for big in [false, true] {
        let mut bytes = header(if big { "binary_big_endian" } else { "binary_little_endian" }).into_bytes();
        for position in positions {
            position.iter().for_each(|value| bytes.extend(if big { value.to_be_bytes() } else { value.to_le_bytes() }));
            bytes.push(7);
        }
        bytes.push(3);
        [0i32, 1, 2].iter().for_each(|index| bytes.extend(if big { index.to_be_bytes() } else { index.to_le_bytes() }));
        files.push(bytes);
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("triangle.ply");
    for bytes in files {
        std::fs::write(&path, bytes).unwrap();
        let scene = lumbre::scene::load(&path, &LoadOptions::default()).unwrap();
        let mut found = [scene.primitives[0].v0, scene.primitives[0].v1, scene.primitives[0].v2];
        found.sort_by(|a, b| a.partial_cmp(b).unwrap());
        let mut expected = positions;
        expected.sort_by(|a, b| a.partial_cmp(b).unwrap());
        assert_eq!(found, expected);
    }
}

#[test]
fn includes_and_parameters_are_resolved() {
    let scene = r#"<scene version="3.0.0"><default name="level" value="0.25"/><include filename="light.xml"/>
        <shape type="sphere"><float name="radius" value="$radius"/></shape></scene>"#;
    let light = r#"<scene version="3.0.0"><default name="radius" value="2"/>
        <emitter type="constant"><rgb name="radiance" value="$level, 0, $level"/></emitter></scene>"#;
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in [("scene.xml", scene), ("light.xml", light)] {
        std::fs::write(folder.path().join(name), text).unwrap();
    }
    let path = folder.path().join("scene.xml");
    let plain = lumbre::scene::load(&path, &LoadOptions::default()).unwrap();
    assert_eq!((plain.background, plain.primitives[0].v1[0]), (Some([0.25, 0.0, 0.25]), 2.0));
    let defines = vec![(String::from("level"), String::from("3")), (String::from("radius"), String::from("0.5"))];
    let defined = lumbre::scene::load(&path, &LoadOptions { defines, ..LoadOptions::default() }).unwrap();
    assert_eq!((defined.background, defined.primitives[0].v1[0]), (Some([3.0, 0.0, 3.0]), 0.5));
}

#[test]
fn glass_is_one_material_on_both_sides() {
    let scene = mitsuba(
        r#"<shape type="sphere"><bsdf type="dielectric"><string name="int_ior" value="water"/></bsdf></shape><emitter type="constant"/>"#,
    );
    let surface = scene.surfaces[0];
    assert_eq!(surface.front, surface.back);
    assert_ne!(surface.front, NONE);
    let glass = scene.materials[surface.front as usize];
    assert_eq!(glass.kind, MATERIAL_DIELECTRIC);
    assert!((glass.eta - 1.333 / 1.000_277).abs() < 1e-6);
    assert!(scene.primitives[0].surface & SPHERE_BIT != 0);
}

#[test]
fn defaults_step_in_with_a_warning() {
    let scene = load_files(&[("square.obj", SQUARE_OBJ)]).unwrap();
    assert_eq!(scene.background, Some([1.0; 3]));
    assert!(scene.warnings.iter().any(|warning| warning.contains("no camera")));
    assert!(scene.warnings.iter().any(|warning| warning.contains("no light")));
    let [r, ..] = mean(&scene, 16);
    assert!(r > 0.1, "the camera should see the square or the sky");
}

#[test]
fn degenerate_triangles_are_dropped_and_counted() {
    let obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 2 0 0\nf 1 2 3\nf 1 2 4\nf 1 1 2\n";
    let scene = load_files(&[("mesh.obj", obj)]).unwrap();
    assert_eq!(scene.primitives.len(), 1);
    assert!(scene.warnings.iter().any(|warning| warning.starts_with("2 of 3 triangles")), "{:?}", scene.warnings);
}

/// A scene far from the world's origin is moved near it before it is rounded to single precision.
#[test]
fn far_scenes_keep_their_detail() {
    let far = DVec3::new(3e6, -7e6, 1e6);
    let xml = format!(
        r#"<scene version="3.0.0"><sensor type="perspective"><transform name="to_world">
        <lookat origin="{}, {}, {}" target="{}, {}, {}" up="0, 1, 0"/></transform></sensor>
        <shape type="cube"><transform name="to_world"><scale value="0.001"/><translate x="{}" y="{}" z="{}"/></transform></shape></scene>"#,
        far.x,
        far.y,
        far.z + 0.01,
        far.x,
        far.y,
        far.z,
        far.x,
        far.y,
        far.z
    );
    let scene = load_files(&[("scene.xml", &xml)]).unwrap();
    let size = scene.bounds.max - scene.bounds.min;
    assert!((size - glam::Vec3::splat(0.002)).abs().max_element() < 1e-8, "the cube measures {size}");
    assert!(scene.cameras[0].to_world.translation.length() < 1.0);
}

/// Whatever the filter, a constant picture stays what it is, and the film's noise shows the filter's weights alone.
#[test]
fn filters_keep_the_mean() {
    let scene = mitsuba(EMITTER);
    let third = 1.0 / 3.0;
    with_gpu(|gpu| {
        for filter in [Filter::Tent { radius: 1.0 }, Filter::GAUSSIAN, Filter::Mitchell { b: third, c: third }] {
            let mut settings = settings(&scene, "path", Backend::Bvh);
            settings.filter = filter;
            let film = render(gpu, &scene, &settings, 400);
            assert_mean(&format!("{filter:?}"), average(&film)[1], 2.0);
        }
        // Its negative lobes make it noisier than the bound on the others allows for: what the weights are off by shows in a hundredth.
        let filter = Filter::Lanczos { lobes: 3 };
        let found =
            average(&render(gpu, &scene, &Settings { filter, ..settings(&scene, "path", Backend::Bvh) }, 4000))[1];
        let sigma = found.variance.sqrt();
        assert!(sigma < 4e-3 && (found.mean - 2.0).abs() < 4.0 * sigma, "{} +- {sigma}", found.mean);
    });
}

/// A filter wider than a pixel carries light across an edge, by the share that its integral says.
#[test]
fn filters_blur_as_their_formula_says() {
    // The square fills x < 0 of the picture: pixel 7 is the last lit one, its centre half a pixel from the edge.
    let scene =
        mitsuba(&EMITTER.replace("<emitter", r#"<transform name="to_world"><translate x="-1"/></transform><emitter"#));
    with_gpu(|gpu| {
        for filter in [Filter::Tent { radius: 1.0 }, Filter::GAUSSIAN] {
            let mut settings = settings(&scene, "path", Backend::Bvh);
            settings.filter = filter;
            let image = render(gpu, &scene, &settings, 4000).mean();
            let share = |from: f64, to: f64| {
                let steps = 10_000;
                let x = |index: i32| from + (to - from) * (f64::from(index) + 0.5) / f64::from(steps);
                (0..steps).map(|index| filter.value(x(index))).sum::<f64>() * (to - from)
            };
            let radius = filter.radius();
            for (column, edge) in [(7, 0.5), (8, -0.5)] {
                let expected = share(-radius, edge) / share(-radius, radius);
                let found = (4..12).map(|row| f64::from(image.pixels[row * 16 + column][0])).sum::<f64>() / 8.0;
                assert!((found - expected).abs() < 0.01, "{filter:?}, column {column}: {found} against {expected}");
            }
        }
    });
}

/// The option reaches rough metals and rough glass, those inside of other BSDFs and with a textured roughness as well, and
/// nothing else; under a white sky what loses nothing cannot be seen.
#[test]
fn energy_compensation_is_for_rough_metals_and_rough_glass() {
    let body = |bsdf: &str| {
        let sky = r#"<emitter type="constant"><rgb name="radiance" value="1"/></emitter>"#;
        let camera = r#"<sensor type="perspective"><float name="fov" value="20"/>
            <transform name="to_world"><lookat origin="0, 0, 3" target="0, 0, 0" up="0, 1, 0"/></transform>
            <film type="hdrfilm"><integer name="width" value="32"/><integer name="height" value="32"/><rfilter type="box"/></film></sensor>"#;
        format!(r#"<scene version="3.0.0">{camera}{sky}<shape type="sphere">{bsdf}</shape></scene>"#)
    };
    let load = |bsdf: &str, energy_compensation: bool| {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("scene.xml");
        std::fs::write(&path, body(bsdf)).unwrap();
        lumbre::scene::load(&path, &LoadOptions { energy_compensation, ..LoadOptions::default() }).unwrap()
    };
    let rough = r#"<texture name="alpha" type="checkerboard"><rgb name="color0" value="0.9"/><rgb name="color1" value="0.3"/>
        <transform name="to_uv"><scale value="3"/></transform></texture><string name="distribution" value="ggx"/>"#;
    for bsdf in [
        format!(r#"<bsdf type="twosided"><bsdf type="roughconductor">{rough}</bsdf></bsdf>"#),
        format!(r#"<bsdf type="roughdielectric">{rough}</bsdf>"#),
    ] {
        let (full, plain) = (load(&bsdf, true), load(&bsdf, false));
        assert_eq!((full.compensations.len(), plain.compensations.len()), (1, 0));
        assert!(Needs::of(&full).energy_compensation && !Needs::of(&plain).energy_compensation);
        let ([full, ..], [plain, ..]) = (mean(&full, 512), mean(&plain, 64));
        println!("{bsdf}: {full:.5} with compensation, {plain:.5} without");
        assert!((full - 1.0).abs() < 5e-3, "{bsdf}: {full}");
        assert!(plain < 0.9, "{bsdf}: {plain}");
    }
    // What differs in colour only shares its table.
    let metal = |name: &str| format!(r#"<bsdf type="roughconductor"><string name="material" value="{name}"/></bsdf>"#);
    let scene = load(&format!(r#"<bsdf type="twosided">{}{}</bsdf>"#, metal("Au"), metal("Cu")), true);
    let [gold, copper] = &scene.compensations[..] else { panic!("{:?}", scene.compensations) };
    assert!(gold.table == copper.table && gold.mean_fresnel != copper.mean_fresnel, "{gold:?} {copper:?}");
    let scene = load(r#"<bsdf type="roughplastic"/>"#, true);
    assert!(scene.compensations.is_empty());
    assert!(scene.warnings.iter().any(|warning| warning.contains("energy compensation")), "{:?}", scene.warnings);
    let path = crate::common::scene_path("gltf_room/room.gltf");
    let options = LoadOptions { energy_compensation: true, ..LoadOptions::default() };
    let error = lumbre::scene::load(&path, &options).unwrap_err().to_string();
    assert!(error.contains("energy compensation"), "{error}");
}

/// Film, filter and number of samples are each sensor's own, and a crop shows what the whole image shows there.
#[test]
fn each_sensor_has_its_own_film() {
    let sensor = |id: &str, width: u32, height: u32, more: &str, count: &str| {
        format!(
            r#"<sensor type="perspective" id="{id}"><float name="fov" value="40"/><film type="hdrfilm">
            <integer name="width" value="{width}"/><integer name="height" value="{height}"/>{more}</film>{count}</sensor>"#
        )
    };
    let sampler =
        |count: u32| format!(r#"<sampler type="independent"><integer name="sample_count" value="{count}"/></sampler>"#);
    let half = r#"<integer name="crop_offset_x" value="32"/><integer name="crop_width" value="32"/>
        <integer name="crop_height" value="48"/><rfilter type="box"/>"#;
    let sensors = [
        sensor("wide", 64, 48, r#"<rfilter type="box"/>"#, &sampler(16)),
        sensor("strip", 96, 32, r#"<rfilter type="tent"/>"#, &sampler(7)),
        sensor("right_half", 64, 48, half, ""),
        String::from(r#"<sensor type="perspective" id="bare"/>"#),
    ];
    let scene =
        load_files(&[("scene.xml", &format!(r#"<scene version="3.0.0">{}</scene>"#, sensors.concat()))]).unwrap();
    let asked = |name: &str| {
        let camera = scene.camera(Some(name)).unwrap();
        let mut own = settings(&scene, "path", Backend::Bvh);
        own.set_camera(&scene, Some(name)).unwrap();
        let film = scene.film_of(camera);
        assert_eq!((own.width, own.height, own.filter), (film.width, film.height, film.filter), "{name}");
        (film.width, film.height, film.filter, scene.spp_of(camera))
    };
    assert_eq!(asked("wide"), (64, 48, Filter::Box, Some(16)));
    assert_eq!(asked("strip"), (96, 32, Filter::Tent { radius: 1.0 }, Some(7)));
    assert_eq!(asked("right_half"), (32, 48, Filter::Box, None));
    assert_eq!(asked("bare"), (768, 576, Filter::GAUSSIAN, None));
    let [whole, part] = ["wide", "right_half"].map(|name| scene.camera(Some(name)).unwrap());
    let [whole, part] = [whole.image_plane(64, 48), part.image_plane(32, 48)];
    let off = |a: DVec3, b: DVec3| (a - b).length();
    assert!(off(part.corner, whole.corner + 32.0 * whole.dx) < 1e-12);
    assert!(off(part.dx, whole.dx) < 1e-15 && off(part.dy, whole.dy) < 1e-15);
}

/// A light of radiance 0 is a light: the image is black, and no sky stands in.
#[test]
fn lights_of_radiance_0_are_lights() {
    let wall = r#"<shape type="rectangle"><bsdf type="diffuse"/></shape>"#;
    let black = |name: &str| format!(r#"<rgb name="{name}" value="0"/>"#);
    for body in [
        format!(r#"{wall}<emitter type="constant">{}</emitter>"#, black("radiance")),
        format!(r#"{wall}<emitter type="point">{}</emitter>"#, black("intensity")),
        format!(r#"<shape type="rectangle"><emitter type="area">{}</emitter></shape>"#, black("radiance")),
    ] {
        let scene = mitsuba(&body);
        assert!(scene.background.is_none() && scene.lights.is_empty(), "{body}");
        assert!(scene.warnings.iter().any(|warning| warning.contains("the image is black")), "{:?}", scene.warnings);
    }
    assert_eq!(
        mean(&mitsuba(&format!(r#"{wall}<emitter type="constant">{}</emitter>"#, black("radiance"))), 1),
        [0.0; 3]
    );
    assert!(mitsuba(wall).background.is_some(), "without any light one stands in");

    let gltf = r#"{"asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}], "extensionsUsed": ["KHR_lights_punctual"],
        "nodes": [{"extensions": {"KHR_lights_punctual": {"light": 0}}}],
        "extensions": {"KHR_lights_punctual": {"lights": [{"type": "point", "intensity": 0}]}}}"#;
    assert!(load_files(&[("scene.gltf", gltf)]).unwrap().background.is_none());
}
