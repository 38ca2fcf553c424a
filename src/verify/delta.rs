//! Mirrors and smooth glass: paths that never end by themselves, and glass in glass.

use glam::{DAffine3, DVec3};

use super::Run;
use super::comparison::average;
use super::figure::Figure;
use super::geometry::{closed_cube, inside_out, look};
use crate::error::Result;
use crate::render::Settings;
use crate::scene::material::{self, MaterialDescription};
use crate::scene::{Scene, SceneBuilder, SurfaceDescription};

fn surface(builder: &mut SceneBuilder, material: impl Into<MaterialDescription>, emission: f64) -> usize {
    let front = Some(builder.material(material));
    builder.surface(SurfaceDescription { front, emission: [emission; 3], ..SurfaceDescription::default() })
}

/// Walls that are mirrors of reflectance r and emit Le: L = Le / (1 - r), a path of k segments contributes Le r^(k - 1), exactly. Then a
/// camera in a cube of glass, from which rays beyond the critical angle of all faces never come out; all others see eta^2.
pub(super) fn traps(run: &mut Run) -> Result<()> {
    const R: f32 = 0.99;
    let mut builder = SceneBuilder::new("mirrors");
    let mirror = material::conductor([0.0; 3], [1.0; 3], [R; 3], None);
    let wall = surface(&mut builder, mirror, 1.0 - f64::from(R));
    builder.mesh(0, "mirrors", inside_out(closed_cube()), DAffine3::IDENTITY, wall);
    look(&mut builder, 16, DVec3::new(0.1, 0.2, 0.3), DVec3::new(-1.0, 0.3, 0.2), 60.0)?;
    let scene = builder.finish()?;
    let settings = Settings { max_depth: Some(1000), rr_depth: 2000, ..run.settings(&scene, "path")? };
    let film = run.render(&scene, &settings, 4)?;
    let expected = 1.0 - f64::from(R).powi(1000);
    let found = average(&film)[0].mean;
    run.note(Figure::relative("path", "a box of mirrors, 1000 segments, against the series", found, expected, 1e-5));
    let film = run.render(&scene, &run.settings(&scene, "path")?, run.pick(512, 128))?;
    run.mean_within("path", "a box of mirrors, no limit", &film, 0, 1.0, 2e-3);

    let mut builder = SceneBuilder::new("glass");
    let glass = surface(&mut builder, material::dielectric(1.5, [1.0; 3], [1.0; 3], None), 0.0);
    builder.mesh(0, "glass", closed_cube(), DAffine3::IDENTITY, glass);
    builder.background = Some([1.0; 3]);
    // Along a diagonal of the cube all three cosines are 0.577: sines of 0.816 against 0.667. Nothing ever leaves.
    look(&mut builder, 8, DVec3::new(0.1, 0.2, 0.3), DVec3::new(1.1, 1.2, 1.3), 1.0)?;
    let scene = builder.finish()?;
    let film = run.render(&scene, &run.settings(&scene, "path")?, run.pick(16, 4))?;
    run.note(Figure::at_most("path", "light in what total reflection holds, no limit", average(&film)[0].mean, 0.0));
    Ok(())
}

/// Balls of glass one in the other, of index 1.2 and 1.5 (each relative to what is around it), and two that overlap: under a white sky
/// whatever loses nothing is not to be seen.
pub(super) fn nested(run: &mut Run) -> Result<()> {
    let scene = |balls: &[(DVec3, f64, f32)]| -> Result<Scene> {
        let mut builder = SceneBuilder::new("glass");
        for (centre, radius, eta) in balls {
            let glass = surface(&mut builder, material::dielectric(*eta, [1.0; 3], [1.0; 3], None), 0.0);
            builder.sphere(0, "ball", *centre, *radius, glass);
        }
        builder.background = Some([1.0; 3]);
        look(&mut builder, 32, DVec3::new(0.0, 0.0, 4.0), DVec3::ZERO, 35.0)?;
        builder.finish()
    };
    let aside = DVec3::X * 0.4;
    for (name, balls) in [
        ("one in the other", [(DVec3::ZERO, 1.0, 1.2), (DVec3::ZERO, 0.6, 1.5)]),
        ("overlapping", [(aside, 0.7, 1.5), (-aside, 0.7, 1.5)]),
    ] {
        let scene = scene(&balls)?;
        // Roulette of a constant probability knows nothing of what comes back on the way out of glass: where light goes round in it, a
        // sample has no finite variance.
        for technique in run.thorough(&scene).into_iter().filter(|technique| *technique != "path-implicit") {
            let film = run.render(&scene, &run.settings(&scene, technique)?, run.pick(256, 64))?;
            run.mean(technique, name, &film, 0, 1.0);
        }
    }
    Ok(())
}
