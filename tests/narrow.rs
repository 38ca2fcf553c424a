//! What is as smooth as a mirror, but for a roughness: every technique finds what `path` finds, or says that it does not.

use crate::common::room::{LAMP, scene};
use crate::common::{assert_off, has_time, largest_off, render, settings, with_gpu};
use lumbre::gpu::Gpu;
use lumbre::layout::backend::Backend;
use lumbre::render::film::Film;
use lumbre::render::{Settings, Technique};
use lumbre::scene::Scene;

/// A kind of material by its alpha, from 0 to 0.01.
type Kind = (&'static str, fn(f64) -> String);

/// The kinds that have a lobe of that width.
const KINDS: [Kind; 5] = [
    ("conductor", |alpha| {
        format!(
            "<bsdf type='roughconductor'><string name='material' value='Al'/><string name='distribution' value='ggx'/>
             <float name='alpha' value='{alpha}'/></bsdf>"
        )
    }),
    ("dielectric", |alpha| format!("<bsdf type='roughdielectric'><float name='alpha' value='{alpha}'/></bsdf>")),
    ("principled", |alpha| {
        format!(
            "<bsdf type='principled'><rgb name='base_color' value='0.8, 0.6, 0.4'/><float name='roughness' value='{}'/>
             <float name='metallic' value='0.7'/></bsdf>",
            alpha.sqrt()
        )
    }),
    ("plastic", |alpha| {
        format!(
            "<bsdf type='roughplastic'><rgb name='diffuse_reflectance' value='0.1, 0.2, 0.3'/>
             <float name='alpha' value='{alpha}'/></bsdf>"
        )
    }),
    ("coat", |alpha| {
        format!(
            "<bsdf type='principled'><rgb name='base_color' value='0.4, 0.5, 0.6'/><float name='roughness' value='0.6'/>
             <float name='clearcoat' value='1'/><float name='clearcoat_gloss' value='{}'/></bsdf>",
            1.0 - 10.0 * alpha
        )
    }),
];

/// A floor, a wall and a ball of this material under a lamp. The camera sees all of it, or the floor in front of the ball alone.
fn room(material: &str, sees_ball: bool) -> Scene {
    let (origin, target) = if sees_ball { ("0, 1, 4.5", "0, 0.7, 0") } else { ("0, 1.2, 0.9", "0, 0, 1.4") };
    let matte =
        "<bsdf type='twosided'><bsdf type='diffuse'><rgb name='reflectance' value='0.6, 0.5, 0.4'/></bsdf></bsdf>";
    scene(&format!(
        "<sensor type='perspective'><float name='fov' value='40'/>
            <transform name='to_world'><lookat origin='{origin}' target='{target}' up='0, 1, 0'/></transform></sensor>
         <shape type='rectangle'><transform name='to_world'><scale value='3'/><rotate x='1' angle='-90'/></transform>{matte}</shape>
         <shape type='rectangle'><transform name='to_world'><scale value='3'/><translate z='-1.5'/></transform>{matte}</shape>
         <shape type='sphere'><point name='center' x='0' y='0.8' z='0'/><float name='radius' value='0.8'/>{material}</shape>
         {LAMP}"
    ))
}

fn film(gpu: &Gpu, scene: &Scene, technique: &str, seed: u32, spp: u32) -> Film {
    let settings = Settings { width: 24, height: 24, seed, ..settings(scene, technique, Backend::Bvh) };
    render(gpu, scene, &settings, spp)
}

/// Whoever evaluates lobes for directions that are given would find next to nothing here: 28 % of the light was lost.
#[test]
fn narrow_lobes_are_followed() {
    with_gpu(|gpu| {
        let scene = room(&KINDS[2].1(0.0), true);
        let truth = film(gpu, &scene, "path", 1000, 2048);
        for technique in ["photon", "vcm:form=ppm"] {
            assert_off(technique, &film(gpu, &scene, technique, 1, 256), &truth, 0.02);
        }
    });
}

/// Light tracing says that it misses what is seen in them, and finds all of their caustics.
#[test]
fn narrow_lobes_throw_caustics() {
    with_gpu(|gpu| {
        let scene = room(&KINDS[0].1(1e-3), false);
        assert!(Technique::parse("light").unwrap().misses(&scene).is_some_and(|what| what.contains("as smooth")));
        let truth = film(gpu, &scene, "path", 1000, 2048);
        assert_off("light", &film(gpu, &scene, "light", 1, 512), &truth, 0.02);
    });
}

/// All kinds, all techniques, from what is clamped to 1e-4 to what is a hundred times as wide.
#[test]
fn every_technique_agrees_on_narrow_lobes() {
    if !has_time() {
        return;
    }
    let all = [
        "photon",
        "photon:direct=photons",
        "vcm",
        "vcm:form=ppm",
        "vcm:form=bpm",
        "vpl",
        "bdpt",
        "mlt",
        "mlt:form=multiplexed",
    ];
    with_gpu(|gpu| {
        for (name, kind) in KINDS {
            for alpha in [0.0, 1e-4, 1e-3, 0.01] {
                let scene = room(&kind(alpha), true);
                let truth = film(gpu, &scene, "path", 1000, 8192);
                for technique in all {
                    let found = film(gpu, &scene, technique, 1, 1024);
                    assert_off(&format!("{name} of alpha {alpha}: {technique}"), &found, &truth, 0.02);
                }
                let hidden = room(&kind(alpha), false);
                let truth = film(gpu, &hidden, "path", 1000, 8192);
                let off = largest_off(&film(gpu, &hidden, "light", 1, 2048), &truth, 0..24, 0..24);
                println!("{name} of alpha {alpha}: light tracing of its caustics is off by {off:+.4}");
                assert!(off.abs() < 0.02, "{name} of alpha {alpha}: light tracing is off by {off}");
                // Nearly a mirror: recursive ray tracing shows in it what it shows in one.
                let [here, mirror] = [alpha, 0.0].map(|alpha| film(gpu, &room(&kind(alpha), true), "whitted", 1, 1024));
                assert_off(&format!("{name} of alpha {alpha}: whitted"), &here, &mirror, 0.02);
            }
        }
    });
}
