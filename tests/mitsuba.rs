//! Mitsuba's scenes as people have them: references, old versions, plugins that are values.

use crate::common::{load_files, render, settings, with_gpu};
use lumbre::layout::backend::Backend;
use lumbre::render::Settings;
use lumbre::render::film::Film;
use lumbre::scene::{LoadOptions, Scene};

/// One scene, written as Mitsuba's files are found: with references to what comes later, aliases, emitters and textures by reference, folders to
/// look in, and textures that are values. All say the same.
#[test]
fn references_go_anywhere_and_constants_are_values() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir_all(folder.path().join("common/parts")).unwrap();
    let square = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    std::fs::write(folder.path().join("common/parts/square.obj"), square).unwrap();
    let included =
        r#"<scene version="3.0.0"><bsdf type="diffuse" id="later"><ref name="reflectance" id="grey"/></bsdf></scene>"#;
    std::fs::write(folder.path().join("common/included.xml"), included).unwrap();
    let of = |body: &str| {
        let path = folder.path().join("scene.xml");
        std::fs::write(&path, format!(r#"<scene version="3.0.0">{body}</scene>"#)).unwrap();
        lumbre::scene::load(&path, &LoadOptions::default()).unwrap()
    };
    let shape =
        |inner: &str| format!(r#"<shape type="obj"><string name="filename" value="parts/square.obj"/>{inner}</shape>"#);
    let plain = r#"<bsdf type="diffuse"><rgb name="reflectance" value="0.25"/></bsdf><emitter type="area"><rgb name="radiance" value="2, 3, 4"/></emitter>"#;
    let expected = of(&format!(r#"<path value="common"/>{}"#, shape(plain)));
    assert_eq!(expected.primitives.len(), 1);
    let grey = r#"<texture type="rawconstant" id="grey"><float name="value" value="0.25"/></texture>"#;
    let light = r#"<emitter type="area" id="lamp"><spectrum type="srgb" name="radiance"><rgb name="color" value="2, 3, 4"/></spectrum></emitter>"#;
    let by_reference = shape(r#"<ref id="paint"/><ref id="lamp"/>"#);
    for body in [
        format!(
            r#"<path value="common"/>{by_reference}<include filename="included.xml"/><alias id="later" as="paint"/>{light}{grey}"#
        ),
        format!(
            r#"<alias id="later" as="paint"/>{grey}{light}<path value="common"/><include filename="included.xml"/>{by_reference}"#
        ),
    ] {
        let found = of(&body);
        assert_eq!(found.surfaces[0].emission, expected.surfaces[0].emission, "{body}");
        let material = |scene: &Scene| scene.materials[scene.surfaces[0].front as usize].reflectance;
        assert_eq!(material(&found), material(&expected), "{body}");
        assert_eq!(found.primitives[0].v1, expected.primitives[0].v1, "{body}");
    }
}

/// Versions before 2 have other names for the same; new ones do not know these.
#[test]
fn old_versions_are_read_as_mitsuba_upgrades_them() {
    let of = |version: &str, body: &str| {
        load_files(&[("scene.xml", &format!(r#"<scene version="{version}">{body}</scene>"#))])
    };
    let old = r##"<integrator type="path"><integer name="maxDepth" value="5"/><boolean name="hideEmitters" value="True"/></integrator>
        <sensor type="perspective"><string name="fovAxis" value="smaller"/><transform name="toWorld"><lookAt origin="0,0,3" target="0,0,0" up="0,1,0"/></transform>
        <film type="hdrfilm"><integer name="width" value="8"/><integer name="height" value="4"/><string name="pixelFormat" value="rgb"/></film>
        <sampler type="independent"><integer name="sampleCount" value="7"/></sampler></sensor>
        <shape type="sphere"><bsdf type="diffuse"><rgb name="diffuseReflectance" value="#ff0033"/></bsdf></shape>
        <shape type="sphere"><bsdf type="dielectric"><float name="intIOR" value="1.5"/><float name="extIOR" value="1"/></bsdf></shape>
        <shape type="sphere"><bsdf type="diffuse"><texture name="reflectance" type="checkerboard"><float name="uscale" value="4"/>
        <float name="uoffset" value="0.5"/></texture></bsdf></shape><emitter type="constant"/>"##;
    let scene = of("0.6.0", old).unwrap();
    assert_eq!((scene.technique.max_depth, scene.technique.hide_emitters), (Some(Some(5)), true));
    let material = |surface: usize| scene.materials[scene.surfaces[surface].front as usize];
    assert_eq!(material(0).reflectance, [1.0, 0.0, 0.2]);
    assert!((material(1).eta - 1.5).abs() < 1e-6);
    // Moved by the offset, then scaled.
    assert_eq!(scene.textures[0].row_u, [4.0, 0.0, 2.0]);
    let message = of("3.0.0", old).unwrap_err().to_string();
    assert!(message.contains("#ff0033"), "{message}");
    assert!(of("new", old).unwrap_err().to_string().contains("'new' is not a version"));
}

/// A scene that asks for it is seen without its lights, and lit by them all the same: by every technique.
#[test]
fn emitters_can_be_hidden() {
    let body = |hidden: bool, shapes: &str| {
        let xml = format!(
            r#"<scene version="3.0.0"><integrator type="path"><boolean name="hide_emitters" value="{hidden}"/><integer name="max_depth" value="2"/></integrator>
            <sensor type="perspective"><float name="fov" value="40"/><transform name="to_world"><lookat origin="0, 0, 4" target="0, 0, 0" up="0, 1, 0"/></transform>
            <film type="hdrfilm"><integer name="width" value="16"/><integer name="height" value="16"/><rfilter type="box"/></film></sensor>{shapes}</scene>"#
        );
        load_files(&[("scene.xml", &xml)]).unwrap()
    };
    // A wall, and a lamp between it and the camera that faces the wall on one side and the camera on the other.
    let wall = r#"<shape type="rectangle"><bsdf type="twosided"><bsdf type="diffuse"/></bsdf></shape>"#;
    let lamp = r#"<shape type="sphere"><point name="center" x="0" y="0" z="1"/><float name="radius" value="0.5"/><emitter type="area"><rgb name="radiance" value="3"/></emitter></shape>"#;
    let scene = body(true, &format!("{wall}{lamp}"));
    let seen = body(false, &format!("{wall}{lamp}"));
    with_gpu(|gpu| {
        let of = |scene: &Scene, technique: &str, spp: u32| {
            let settings = Settings { max_depth: Some(2), ..settings(scene, technique, Backend::Bvh) };
            render(gpu, scene, &settings, spp)
        };
        let truth = of(&scene, "path", 4096);
        // The middle of the wall, behind the lamp, is lit most; where the lamp is seen it is brighter than any wall.
        let middle = |film: &Film| film.mean().pixels[8 * 16 + 8][0];
        assert!((middle(&of(&seen, "path", 64)) - 3.0).abs() < 1e-3);
        assert!(middle(&truth) < 1.5 && middle(&truth) > 0.3, "{}", middle(&truth));
        for technique in ["path-implicit", "light", "bdpt", "vcm", "photon", "vpl"] {
            let film = of(&scene, technique, 1024);
            let mean = |film: &Film| film.mean().pixels.iter().map(|pixel| f64::from(pixel[1])).sum::<f64>() / 256.0;
            let (found, expected) = (mean(&film), mean(&truth));
            println!("{technique}: {found} against {expected}");
            assert!((found / expected - 1.0).abs() < 0.03, "{technique}: {found} against {expected}");
        }
    });
}

/// An integrator that there is not is refused where it would be used, with what there is; what cannot be read says why.
#[test]
fn what_is_refused_says_why() {
    let of = |body: &str| load_files(&[("scene.xml", &format!(r#"<scene version="3.0.0">{body}</scene>"#))]);
    let shape = r#"<shape type="sphere"/>"#;
    let refused = |integrator: &str| of(&format!("{integrator}{shape}")).unwrap().technique.refused.unwrap();
    assert!(refused(r#"<integrator type="magic"/>"#).contains("supported are path, direct"));
    assert!(refused(r#"<integrator type="prb"/>"#).contains("derivatives are not computed"));
    for (body, reason) in [
        (r#"<medium type="homogeneous"/>"#, "participating media"),
        (r#"<shape type="sphere"><medium name="interior" type="homogeneous"/></shape>"#, "participating media"),
        (r#"<shape type="sdfgrid"/>"#, "signed distance fields"),
        (r#"<shape type="bsplinecurve"/>"#, "curves"),
        (r#"<emitter type="sunsky"/>"#, "model of the sky"),
        (r#"<bsdf type="hair"/>"#, "hair"),
        (r#"<bsdf type="polarizer"/>"#, "polarisation"),
        (r#"<sensor type="distant"/>"#, "perspective"),
    ] {
        let message = of(&format!("{shape}{body}")).unwrap_err().to_string();
        assert!(message.contains("scene.xml:1") && message.contains(reason), "{body}: {message}");
    }
}

/// `rotate` takes its axis as it is, as Mitsuba 3.9 does: the matrix is the one that it gives for 15 degrees around (0, 1, 1).
#[test]
fn rotations_are_those_of_mitsuba() {
    let of = |axis: &str| {
        let body = format!(
            r#"<shape type="rectangle"><transform name="to_world"><rotate {axis} angle="15"/></transform></shape>"#
        );
        load_files(&[("scene.xml", &format!(r#"<scene version="3.0.0">{body}</scene>"#))]).unwrap()
    };
    let corner = |scene: &Scene| {
        let bounds = scene.bounds.max - scene.bounds.min;
        [bounds.x / 2.0, bounds.y / 2.0, bounds.z / 2.0]
    };
    let stretched = of(r#"y="1" z="1""#);
    for (found, expected) in corner(&stretched).iter().zip([1.22474, 1.25882, 0.292893]) {
        assert!((found - expected).abs() < 1e-5, "{found} against {expected}");
    }
    assert!(stretched.warnings.iter().any(|warning| warning.contains("no unit vector")));
    let turned = of(r#"z="1""#);
    let expected = 15f32.to_radians().cos() + 15f32.to_radians().sin();
    assert!(
        (corner(&turned)[0] - expected).abs() < 1e-6 && !turned.warnings.iter().any(|warning| warning.contains("unit"))
    );
}

/// What shares its parts has far more ways down than parts: none of these takes long, and shapes that are too many are an error.
#[test]
fn shared_parts_do_not_multiply() {
    let of = |body: &str| load_files(&[("scene.xml", &format!(r#"<scene version="3.0.0">{body}</scene>"#))]);
    let levels =
        |first: &str, next: &dyn Fn(usize) -> String| (1..60).fold(first.to_owned(), |text, level| text + &next(level));
    let merged = levels(r#"<shape type="merge" id="s0"><shape type="sphere"/></shape>"#, &|level| {
        let below = level - 1;
        format!(r#"<shape type="merge" id="s{level}"><ref id="s{below}"/><ref id="s{below}"/></shape>"#)
    });
    let message = of(&merged).unwrap_err().to_string();
    assert!(message.contains("more than 1048576 shapes"), "{message}");
    let squares = levels(r#"<texture type="checkerboard" id="t0"/>"#, &|level| {
        let below = level - 1;
        format!(
            r#"<texture type="checkerboard" id="t{level}"><ref name="color0" id="t{below}"/><ref name="color1" id="t{below}"/></texture>"#
        )
    });
    let lamp = r#"<shape type="rectangle"><emitter type="area"><ref name="radiance" id="t59"/></emitter></shape>"#;
    assert_eq!(of(&format!("{squares}{lamp}")).unwrap().lights.len(), 2);
    let blends = levels(r#"<bsdf type="diffuse" id="b0"/>"#, &|level| {
        let below = level - 1;
        format!(r#"<bsdf type="blendbsdf" id="b{level}"><ref id="b{below}"/><ref id="b{below}"/></bsdf>"#)
    });
    let attribute = r#"<bsdf type="diffuse"><texture name="reflectance" type="mesh_attribute"><string name="name" value="vertex_c"/></texture></bsdf>"#;
    assert!(of(&format!(r#"{attribute}{blends}<shape type="sphere"><ref id="b59"/></shape>"#)).is_ok());
}

/// Of many names that a file gives, a message about another one lists the few that are most like it.
#[test]
fn unknown_names_are_told_the_nearest() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.xml");
    let refused = |body: &str, defines: Vec<(String, String)>| {
        std::fs::write(&path, format!(r#"<scene version="3.0.0">{body}</scene>"#)).unwrap();
        let options = LoadOptions { defines, ..LoadOptions::default() };
        lumbre::scene::load(&path, &options).unwrap_err().to_string()
    };
    let paints: String = (0..500).map(|index| format!(r#"<bsdf type="diffuse" id="paint{index}"/>"#)).collect();
    let message = refused(&format!(r#"{paints}<shape type="sphere"><ref id="pint77"/></shape>"#), vec![]);
    assert!(
        message.ends_with("unknown id 'pint77'; the scene has 500 ids, such as paint77, paint17, paint177 and paint27"),
        "{message}"
    );
    let message = refused(r#"<bsdf type="diffuse" id="a"/><shape type="sphere"><ref id="b"/></shape>"#, vec![]);
    assert!(message.ends_with("the scene has a"), "{message}");
    let message = refused(r#"<shape type="sphere"><ref id="b"/></shape>"#, vec![]);
    assert!(message.ends_with("the scene has none"), "{message}");
    let defaults: String = (0..500).map(|index| format!(r#"<default name="size{index}" value="1"/>"#)).collect();
    let message = refused(&format!(r#"{defaults}<string name="a" value="$sise3"/>"#), vec![]);
    assert!(message.contains("'$sise3' is not defined; defined: 500 parameters, such as size3, "), "{message}");
    let message = refused(&defaults, vec![(String::from("sise3"), String::new())]);
    assert!(message.contains("no parameter of that name; it has 500 parameters, such as size3, "), "{message}");
}
