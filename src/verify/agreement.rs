//! Techniques against each other where no closed form is known.

use glam::{DAffine3, DVec3, Vec2};

use super::comparison::{average, tile_average};
use super::figure::Figure;
use super::geometry::{lamp, look};
use super::{Run, room};
use crate::error::Result;
use crate::image::{Texels, TextureImage};
use crate::layout::backend::Backend;
use crate::render::{Renderer, Settings};
use crate::scene::material::{self, MaterialDescription};
use crate::scene::texture::{Pattern, TextureDescription};
use crate::scene::{Mesh, Scene, SceneBuilder, SurfaceDescription};
use crate::statistics::Estimate;

/// A floor of side 6 with bumps or with normals from an image.
fn uneven_floor(builder: &mut SceneBuilder, texels: Vec<[f32; 4]>, side: u32, is_bump: bool, albedo: [f32; 3]) {
    let image = TextureImage { source: "bumps".into(), width: side, height: side, texels: Texels::Float(texels) };
    let image = builder.image(image);
    let texture = builder.texture(TextureDescription::new(Pattern::Image(image)));
    let mut floor: MaterialDescription = material::diffuse(albedo).into();
    floor.record.flags |= crate::layout::MATERIAL_HAS_TANGENTS;
    if is_bump {
        (floor.textures.bump, floor.textures.bump_scale) = (texture, 0.3);
    } else {
        floor.textures.normal = texture;
    }
    let floor = Some(builder.material(floor));
    let floor = builder.surface(SurfaceDescription { front: floor, ..SurfaceDescription::default() });
    let place = DAffine3::from_scale(DVec3::splat(3.0)) * DAffine3::from_rotation_x(-std::f64::consts::FRAC_PI_2);
    builder.mesh(0, "floor", Mesh::rectangle(), place, floor);
}

/// A floor with bumps or with normals from an image, and an octahedron that is shaded as a ball, under a lamp or a white sky.
fn uneven(texels: Vec<[f32; 4]>, side: u32, is_bump: bool, sky: bool) -> Result<Scene> {
    let mut builder = SceneBuilder::new("uneven");
    uneven_floor(&mut builder, texels, side, is_bump, if sky { [1.0; 3] } else { [0.7, 0.6, 0.5] });
    if sky {
        builder.background = Some([1.0; 3]);
    } else {
        let v = DVec3::new;
        let positions = vec![DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z];
        let normals = positions.iter().map(|position| position.as_vec3()).collect();
        let triangles = vec![[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
        let ball = Mesh { positions, normals, triangles, ..Mesh::default() };
        let skin = Some(builder.material(material::plastic(1.5, [0.5; 3], [1.0; 3], false, Some(0.3))));
        let skin = builder.surface(SurfaceDescription { front: skin, ..SurfaceDescription::default() });
        let place = DAffine3::from_translation(v(0.0, 0.9, 0.0)) * DAffine3::from_scale(DVec3::splat(0.8));
        builder.mesh(0, "ball", ball, place, skin);
        let light = lamp(&mut builder, [9.0, 8.0, 7.0]);
        builder.parallelogram(v(-0.6, 2.6, -0.6), DVec3::X * 1.2, DVec3::Z * 1.2, light);
    }
    look(&mut builder, 48, DVec3::new(0.0, 1.5, 6.0), DVec3::new(0.0, 0.5, 0.0), 40.0)?;
    builder.finish()
}

/// Light that grazes a floor with bumps, and a ceiling that is lit from there: what a path from the light meets first changes what it
/// carries on.
fn grazed(texels: Vec<[f32; 4]>, side: u32) -> Result<Scene> {
    let mut builder = SceneBuilder::new("grazed");
    uneven_floor(&mut builder, texels, side, true, [0.9; 3]);
    let v = DVec3::new;
    let ceiling = builder.matte([0.7, 0.6, 0.5]);
    builder.parallelogram(v(-3.0, 1.2, -3.0), DVec3::X * 6.0, DVec3::Z * 6.0, ceiling);
    let light = lamp(&mut builder, [9.0, 8.0, 7.0]);
    builder.parallelogram(v(-2.9, 0.01, -2.0), DVec3::Y * 0.3, DVec3::Z * 4.0, light);
    // Of the floor, where paths from the light hardly ever come to its far end, it sees nothing.
    look(&mut builder, 32, v(0.0, 0.2, 4.5), v(0.0, 1.2, 1.5), 40.0)?;
    builder.finish()
}

/// Heights without a pattern.
fn heights(side: u32) -> Vec<[f32; 4]> {
    (0..side * side).map(|index| [0.5 + 0.5 * (1.7 * index as f32).sin(); 4].map(|v| v.min(1.0))).collect()
}

/// Normals, some of which point below the surface (a third component under one half is a negative one).
fn normals_below(side: u32) -> Vec<[f32; 4]> {
    let of = |index: u32| {
        let t = index as f32;
        let tilt = Vec2::new((1.3 * t).sin(), (2.1 * t).cos());
        [0.5 + 0.5 * tilt.x, 0.5 + 0.5 * tilt.y, 0.5 + 0.45 * (0.7 * t).sin(), 1.0]
    };
    (0..side * side).map(of).collect()
}

fn all_agree(run: &mut Run, what: &str, scene: &Scene, spp: u32) -> Result<()> {
    let settings = run.settings(scene, "path")?;
    let truth = run.render(scene, &Settings { seed: 1000, ..settings }, 8 * spp)?;
    for (seed, technique) in
        (0..).zip(if run.is_short() || run.backend != Backend::Bvh { vec!["light"] } else { vec!["light", "bdpt"] })
    {
        let settings = Settings { seed, ..run.settings(scene, technique)? };
        let film = run.render(scene, &settings, spp)?;
        run.same(technique, what, &film, &truth, 12);
    }
    Ok(())
}

/// Paths from the light need Veach's adjoint of normals that are not those of the surface.
pub(super) fn shading_normals(run: &mut Run) -> Result<()> {
    let scene = uneven(heights(16), 16, true, false)?;
    all_agree(run, "bumps and a coarse ball", &scene, run.pick(56, 48))?;
    if run.backend == Backend::Bvh {
        // The factor asks nothing of how rays are met.
        all_agree(run, "bumps that light grazes", &grazed(heights(16), 16)?, run.pick(64, 48))?;
    }
    Ok(())
}

/// Normal maps that point below the surface: nothing is lit from behind, gained or not finite, and light's paths agree.
pub(super) fn normals_below_surface(run: &mut Run) -> Result<()> {
    let scene = uneven(normals_below(16), 16, false, false)?;
    all_agree(run, "a normal map", &scene, run.pick(56, 48))?;
    let scene = uneven(normals_below(16), 16, false, true)?;
    let film = run.render(&scene, &run.settings(&scene, "path")?, run.pick(400, 256))?;
    // White under a white sky: what a pixel has beyond one is gained, but for noise.
    let (mean, variance) = (film.mean(), film.mean_variance());
    let mut worst = super::figure::Worst::default();
    for (pixel, (value, variance)) in mean.pixels.iter().zip(&variance.pixels).enumerate() {
        let bound = 1.002 + 5.0 * f64::from(variance[1]).sqrt();
        worst.see(f64::from(value[1]) / bound, || format!("pixel ({}, {}): {}", pixel % 48, pixel / 48, value[1]));
    }
    run.note(worst.figure("path", "brightest pixel of a white floor under a white sky, in bounds", 1.0));
    Ok(())
}

/// The lamp within a ball of glass over a floor: what each technique has of the light that photon mapping's limit has. Each says by
/// itself what it misses, which is no failure.
pub(super) fn specular_diffuse_specular(run: &mut Run) -> Result<()> {
    let mut builder = SceneBuilder::new("glass");
    let floor = builder.matte([0.7; 3]);
    builder.parallelogram(DVec3::new(-3.0, 0.0, -3.0), DVec3::Z * 6.0, DVec3::X * 6.0, floor);
    let glass = Some(builder.material(material::dielectric(1.5, [1.0; 3], [1.0; 3], None)));
    let glass = builder.surface(SurfaceDescription { front: glass, ..SurfaceDescription::default() });
    builder.sphere(0, "glass", DVec3::new(0.0, 1.2, 0.0), 0.8, glass);
    let light = lamp(&mut builder, [40.0; 3]);
    builder.sphere(0, "lamp", DVec3::new(0.0, 1.2, 0.0), 0.2, light);
    look(&mut builder, 32, DVec3::new(0.0, 2.5, 6.0), DVec3::new(0.0, 0.4, 0.0), 40.0)?;
    let scene = builder.finish()?;
    let settings = run.settings(&scene, "photon:radius=0.01")?;
    let limit = run.render(&scene, &settings, run.pick(768, 256))?.average()[1];
    let all = vec!["path-implicit", "path", "light", "bdpt", "vcm", "mlt"];
    let techniques =
        run.pick(if run.backend == Backend::Bvh { all } else { vec!["path-implicit", "path"] }, vec!["path"]);
    for technique in techniques {
        let settings = run.settings(&scene, technique)?;
        let film = run.render(&scene, &settings, run.pick(768, 256))?;
        let found = average(&film)[1];
        let missing = settings.technique.misses(&scene);
        let share = 1.0 - found.mean / limit;
        let what = format!("energy missing against photon mapping's {limit:.4}");
        let sigma = found.variance.sqrt() / limit;
        // Photon mapping blurs over edges by its radius: a hundredth.
        let told = Figure::told(technique, what.clone(), share).worst(missing.clone().unwrap_or_default());
        run.note(if missing.is_some() {
            told
        } else {
            Figure::at_most(technique, what, share.abs(), 0.02 + 3.0 * sigma)
        });
    }
    Ok(())
}

/// However many chains share the same number of mutations, the mean is off by less than its noise over 32 seeds.
pub(super) fn mlt_start(run: &mut Run) -> Result<()> {
    let scene = room::lit(room::MATTE, room::ROUGH_METAL, 32)?;
    let limited = |settings: Settings| Settings { max_depth: Some(6), ..settings };
    let settings = limited(run.settings(&scene, "path")?);
    let film = run.render(&scene, &Settings { seed: 1000, ..settings }, run.pick(8192, 2048))?;
    let truth = tile_average(&film, 0..32, 0..32)[1];
    for form in run.pick(vec!["primary", "multiplexed", "paths"], vec!["primary"]) {
        // They divide the 1024 mutations of a sample, or are divided by them.
        let mut counts = vec![(103, 32), (10_240, 32), (1_048_576, 32)];
        if run.is_long() {
            counts.extend([(1024, 32), (102_400, 32)]);
        }
        for (chains, seeds) in run.pick(counts, vec![(1024, 16)]) {
            let technique = format!("mlt:form={form}:chains={chains}:candidates=65536");
            let settings = limited(run.settings(&scene, &technique)?);
            let mut renderer = Renderer::new(run.gpu, &scene, &settings)?;
            let mut means = Vec::new();
            for seed in 0..seeds {
                renderer.restart(seed)?;
                while renderer.advance(16)? {}
                means.push(renderer.film()?.average()[1]);
            }
            let found = Estimate::of(&means);
            let off = found.mean / truth.mean - 1.0;
            let what = format!("{form}, {chains} chains: |z| of the mean over {} seeds", means.len());
            // The level of two standard deviations for all of them together (Sidak).
            let bound = run.pick(2.8, 2.5);
            run.note(
                Figure::at_most("mlt", what, found.z(&truth).abs(), bound)
                    .worst(format!("off by {:+.3} %", 100.0 * off)),
            );
            run.note(Figure::at_most("mlt", format!("{form}, {chains} chains: the mean off"), off.abs(), 0.015));
        }
    }
    Ok(())
}
