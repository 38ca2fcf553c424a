//! Mitsuba's materials and textures: what each parameter becomes, and that techniques agree on what shading frames do.

use crate::common::gltf::load;
use crate::common::room::{LAMP, scene};
use crate::common::{assert_off, render, settings, with_gpu};
use lumbre::layout::backend::Backend;
use lumbre::layout::{
    MATERIAL_BLEND, MATERIAL_DIFFUSE, MATERIAL_PRINCIPLED_THIN, MATERIAL_THIN_DIELECTRIC, NONE, PROPERTIES,
    PROPERTY_ALPHA_U, PROPERTY_ALPHA_V, PROPERTY_ROUGHNESS, TEXTURE_ATTRIBUTE,
};
use lumbre::render::Settings;
use lumbre::render::film::Film;
use lumbre::scene::Scene;

/// A scene of one square of this BSDF.
fn square(bsdf: &str) -> Scene {
    scene(&format!("<shape type='rectangle'>{bsdf}</shape>"))
}

fn board(name: &str, a: &str, b: &str) -> String {
    format!(
        "<texture type='checkerboard' name='{name}'><rgb name='color0' value='{a}'/><rgb name='color1' value='{b}'/></texture>"
    )
}

/// The properties of the first material that textures multiply.
fn textured(scene: &Scene) -> Vec<&'static str> {
    let own = scene.textures_of(&scene.materials[0]);
    own.iter().map(|own| PROPERTIES[own.property as usize].constant).collect()
}

#[test]
fn every_parameter_of_the_documentation_is_textured() {
    let plugins: [(&str, &[&str]); 8] = [
        ("diffuse", &["reflectance"]),
        ("conductor", &["eta", "k", "specular_reflectance"]),
        ("roughconductor", &["alpha_u", "alpha_v", "eta", "k", "specular_reflectance"]),
        ("roughdielectric", &["alpha_u", "alpha_v", "specular_reflectance", "specular_transmittance"]),
        ("thindielectric", &["specular_reflectance", "specular_transmittance"]),
        ("roughplastic", &["diffuse_reflectance", "specular_reflectance"]),
        (
            "principled",
            &[
                "base_color",
                "roughness",
                "anisotropic",
                "metallic",
                "spec_trans",
                "spec_tint",
                "sheen",
                "sheen_tint",
                "flatness",
                "clearcoat",
                "clearcoat_gloss",
            ],
        ),
        (
            "principledthin",
            &[
                "base_color",
                "roughness",
                "anisotropic",
                "spec_trans",
                "eta",
                "spec_tint",
                "sheen",
                "sheen_tint",
                "flatness",
                "diff_trans",
            ],
        ),
    ];
    for (plugin, parameters) in plugins {
        let textures: String = parameters.iter().map(|name| board(name, "0.5", "0.25")).collect();
        let scene = square(&format!("<bsdf type='{plugin}'>{textures}</bsdf>"));
        let mut found = textured(&scene);
        assert_eq!(found.len(), parameters.len(), "{plugin}: {found:?}");
        found.sort_unstable();
        found.dedup();
        assert_eq!(found.len(), parameters.len(), "{plugin}: one texture has taken the place of another: {found:?}");
    }
}

/// One texture for both directions of roughness, two, or one beside a number.
#[test]
fn roughness_is_textured_by_direction() {
    let of = |inner: &str| {
        let scene = square(&format!("<bsdf type='roughconductor'>{inner}</bsdf>"));
        let properties: Vec<u32> = scene.textures_of(&scene.materials[0]).iter().map(|own| own.property).collect();
        (properties, [scene.materials[0].alpha_u, scene.materials[0].alpha_v])
    };
    let (one, other) = (board("alpha", "0.5", "0.25"), board("alpha_v", "0.5", "0.25"));
    assert_eq!(of(&one), (vec![PROPERTY_ROUGHNESS], [1.0; 2]));
    assert_eq!(of(&format!("{one}{other}")), (vec![PROPERTY_ALPHA_U, PROPERTY_ALPHA_V], [1.0; 2]));
    let number = "<float name='alpha_u' value='0.125'/>";
    assert_eq!(of(&format!("{number}{other}")), (vec![PROPERTY_ALPHA_V], [0.125, 1.0]));
    assert_eq!(of("<float name='alpha' value='0'/>"), (vec![], [1e-4; 2]));
}

/// As a number a checkerboard shows its squares the other way round, as Mitsuba's does.
#[test]
fn checkerboards_of_numbers_and_of_colours() {
    let inner = board("color0", "0.1", "0.2");
    let nested = |name: &str| {
        format!("<texture type='checkerboard' name='{name}'>{inner}<float name='color1' value='0.3'/></texture>")
    };
    let scene = square(&format!("<bsdf type='principled'>{}{}</bsdf>", nested("base_color"), nested("roughness")));
    let seen = |index: usize| scene.textures[scene.textures_of(&scene.materials[0])[index].texture as usize];
    let (colour, number) = (seen(0), seen(1));
    assert_eq!((colour.offset[0], colour.texels[1]), (0.3, NONE));
    assert_eq!((number.scale[0], number.texels[0]), (0.3, NONE));
    let [inner, exchanged] = [colour.texels[0], number.texels[1]].map(|index| scene.textures[index as usize]);
    assert_eq!((inner.scale[0], exchanged.scale[0]), (0.1, 0.2));
}

const PLY: &str = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n
property float warm_0\nproperty float warm_1\nproperty float warm_2\nproperty float wet_x\nelement face 2\n
property list uchar int vertex_indices\nproperty float red\nproperty float green\nproperty float blue\nend_header\n
-1 -1 0 0.1 0.2 0.3 0.5\n1 -1 0 0.4 0.5 0.6 0.5\n1 1 0 0.7 0.8 0.9 0.25\n-1 1 0 1 1 1 0.25\n
3 0 1 2 0.1 0.2 0.3\n3 0 2 3 0.4 0.5 0.6\n";

fn painted(property: &str, attribute: &str) -> lumbre::error::Result<Scene> {
    let xml = format!(
        "<scene version='3.0.0'><shape type='ply'><string name='filename' value='a.ply'/><bsdf type='principled'>
         <texture type='mesh_attribute' name='{property}'><string name='name' value='{attribute}'/></texture>
         </bsdf></shape></scene>"
    );
    let ply: String = PLY.lines().filter(|line| !line.is_empty()).map(|line| format!("{line}\n")).collect();
    load(xml.as_bytes(), "scene.xml", &[("a.ply", ply.as_bytes())])
}

#[test]
fn meshes_have_attributes() {
    let scene = painted("base_color", "vertex_warm").unwrap();
    assert_eq!((scene.textures[0].kind, scene.attributes.len()), (TEXTURE_ATTRIBUTE, 4));
    assert_eq!((scene.attributes[1], scene.attributes[3]), ([0.4, 0.5, 0.6, 1.0], [1.0; 4]));
    let scene = painted("roughness", "vertex_wet").unwrap();
    assert_eq!(scene.attributes[2], [0.25, 0.25, 0.25, 1.0]);
    // What differs from face to face is at vertices of their own.
    let scene = painted("base_color", "face_color").unwrap();
    assert_eq!(scene.attributes.len(), 6);
    assert_eq!((scene.attributes[0], scene.attributes[5]), ([0.1, 0.2, 0.3, 1.0], [0.4, 0.5, 0.6, 1.0]));
    let error = painted("base_color", "vertex_cold").unwrap_err().to_string();
    assert!(error.contains("'vertex_cold', which it does not have; it has none"), "{error}");
    let error = painted("base_color", "cold").unwrap_err().to_string();
    assert!(error.contains("scene.xml:2") && error.contains("vertex_ nor with face_"), "{error}");
}

/// What stops light of masks in masks, and of blends of what lets it pass.
#[test]
fn masks_and_blends_nest() {
    let matte = "<bsdf type='diffuse'/>";
    let mask = |opacity: &str, inner: &str| format!("<bsdf type='mask'>{opacity}{inner}</bsdf>");
    let number = |value: f64| format!("<float name='opacity' value='{value}'/>");
    let blend = |weight: &str, a: &str, b: &str| format!("<bsdf type='blendbsdf'>{weight}{a}{b}</bsdf>");
    let quarter = "<float name='weight' value='0.25'/>";
    let opacity = |bsdf: &str| {
        let scene = square(bsdf);
        (scene.surfaces[0].opacity, scene.surfaces[0].opacity_texture)
    };
    let half = mask(&number(0.5), matte);
    assert_eq!(opacity(&mask(&number(0.5), &half)), (0.25, NONE));
    let textured = opacity(&mask(&board("opacity", "1", "0"), &half));
    assert!(textured.0 == 0.5 && textured.1 != NONE, "{textured:?}");
    assert_eq!(opacity(&blend(quarter, &half, matte)), (0.625, NONE));
    assert_eq!(square(&blend(quarter, &half, matte)).blends[0].weight, 0.4, "0.25 of 0.625");
    assert_eq!(opacity(&blend(quarter, "<bsdf type='null'/>", matte)), (0.25, NONE));
    let by_texture = board("weight", "0.75", "0");
    let scene = square(&blend(&by_texture, matte, "<bsdf type='null'/>"));
    let rest = &scene.textures[scene.surfaces[0].opacity_texture as usize];
    assert_eq!((scene.surfaces[0].opacity, rest.scale[0], rest.offset[0]), (1.0, 1.0, 0.25));
    let two =
        format!("<scene version='3.0.0'><shape type='sphere'>{}</shape></scene>", blend(&by_texture, &half, &half));
    let error = load(two.as_bytes(), "scene.xml", &[]).unwrap_err().to_string();
    assert!(error.contains("scene.xml:1") && error.contains("numbers"), "{error}");
}

#[test]
fn what_is_alike_from_both_sides_may_be_two_sided() {
    let within =
        |inner: &str| format!("<bsdf type='twosided'><boolean name='allow_transmission' value='true'/>{inner}</bsdf>");
    let scene = square(&within("<bsdf type='principledthin'/>"));
    assert_eq!(scene.materials[scene.surfaces[0].back as usize].kind, MATERIAL_PRINCIPLED_THIN);
    let scene = square(&within("<bsdf type='mask'><bsdf type='diffuse'/></bsdf>"));
    assert_eq!((scene.surfaces[0].opacity, scene.surfaces[0].back), (0.5, scene.surfaces[0].front));
    let glass =
        format!("<scene version='3.0.0'><shape type='sphere'>{}</shape></scene>", within("<bsdf type='dielectric'/>"));
    let error = load(glass.as_bytes(), "scene.xml", &[]).unwrap_err().to_string();
    assert!(error.contains("two sides that differ"), "{error}");
}

fn film(gpu: &lumbre::gpu::Gpu, scene: &Scene, technique: &str, seed: u32, spp: u32) -> Film {
    let settings = Settings { width: 24, height: 24, seed, ..settings(scene, technique, Backend::Bvh) };
    render(gpu, scene, &settings, spp)
}

/// Emission does not depend on the BSDF: a lamp that lets all light pass is seen, lights the floor, and casts no shadow.
#[test]
fn what_lets_light_pass_emits() {
    let lamp = |bsdf: &str| {
        scene(&format!(
            "<sensor type='perspective'><transform name='to_world'><lookat origin='0, 1, 4' target='0, 0.7, 0' up='0, 1, 0'/></transform></sensor>
             <shape type='rectangle'><transform name='to_world'><scale value='3'/><rotate x='1' angle='-90'/></transform><bsdf type='diffuse'/></shape>
             <shape type='rectangle'><transform name='to_world'><scale value='0.4'/><translate y='1'/></transform>{bsdf}
                <emitter type='area'><rgb name='radiance' value='5'/></emitter></shape>"
        ))
    };
    let scene = lamp("<bsdf type='null'/>");
    assert_eq!(scene.materials[scene.surfaces[1].front as usize].kind, MATERIAL_THIN_DIELECTRIC);
    let masked = lamp("<bsdf type='mask'><float name='opacity' value='0.25'/><bsdf type='diffuse'/></bsdf>");
    let blend = masked.materials[masked.surfaces[1].front as usize];
    assert_eq!((blend.kind, masked.blends[blend.detail as usize].weight), (MATERIAL_BLEND, 0.25));
    assert_eq!(masked.materials[masked.blends[blend.detail as usize].second as usize].kind, MATERIAL_DIFFUSE);
    with_gpu(|gpu| {
        let [solid, null] = ["", "<bsdf type='null'/>"].map(|bsdf| film(gpu, &lamp(bsdf), "path", 1, 512));
        assert_off("a lamp of nothing against a black one", &null, &solid, 0.02);
        assert_off("bdpt", &film(gpu, &scene, "bdpt", 2, 256), &solid, 0.02);
    });
}

/// Normals that lean far enough for the camera to be below them, with what their slopes shadow.
#[test]
fn techniques_agree_on_flipped_normals() {
    let leaning = board("normalmap", "0.95, 0.5, 0.65", "0.2, 0.2, 0.7");
    let floor = scene(&format!(
        "<sensor type='perspective'><float name='fov' value='40'/>
            <transform name='to_world'><lookat origin='0.3, 0.7, 3.2' target='0, 0, 0' up='0, 1, 0'/></transform></sensor>
         <shape type='rectangle'><transform name='to_world'><scale value='2'/><rotate x='1' angle='-90'/></transform>
            <bsdf type='normalmap'>{}<bsdf type='diffuse'><rgb name='reflectance' value='0.6'/></bsdf></bsdf></shape>
         <shape type='rectangle'><transform name='to_world'><scale value='2'/><translate z='-1.5'/></transform><bsdf type='diffuse'/></shape>
         {LAMP}",
        leaning.replace("name='normalmap'>", "name='normalmap'><transform name='to_uv'><scale value='3'/></transform>")
    ));
    with_gpu(|gpu| {
        let truth = film(gpu, &floor, "path", 1000, 2048);
        for technique in ["bdpt", "light"] {
            assert_off(technique, &film(gpu, &floor, technique, 1, 512), &truth, 0.01);
        }
    });
}
