//! Markov chains on a target that is known: a mosaic of lamps that fills the image, where paths have one segment and bring what the
//! lamp there emits. Chains are at places in proportion to that.

use glam::DVec3;

use super::Run;
use super::figure::Figure;
use super::geometry::{lamp, look};
use super::sampling::chi_square_z;
use crate::error::Result;
use crate::render::{Renderer, Settings};
use crate::scene::{Scene, SceneBuilder};

/// Lamps along each side of the mosaic, and pixels of the image.
const LAMPS: usize = 8;
const SIZE: u32 = 128;

/// What the lamp in this place emits: 1 to 64, neighbours quite different.
fn radiance(column: usize, row: usize) -> f64 {
    (1 + (37 * (LAMPS * row + column) + 11) % (LAMPS * LAMPS)) as f64
}

fn mosaic() -> Result<Scene> {
    let mut builder = SceneBuilder::new("mosaic");
    let side = 2.0 / LAMPS as f64;
    for row in 0..LAMPS {
        for column in 0..LAMPS {
            let surface = lamp(&mut builder, [radiance(column, row); 3]);
            let corner = DVec3::new(-1.0 + side * column as f64, 1.0 - side * (row + 1) as f64, 0.0);
            builder.parallelogram(corner, DVec3::X * side, DVec3::Y * side, surface);
        }
    }
    look(&mut builder, SIZE, DVec3::Z, DVec3::ZERO, 90.0)?;
    builder.finish()
}

/// Where chains are after the first mutation, which is where they began as far as that was right, and after many, few of them large
/// steps, against what lamps emit.
pub(super) fn chains(run: &mut Run) -> Result<()> {
    let scene = mosaic()?;
    let cells = (0..LAMPS * LAMPS).map(|cell| radiance(cell % LAMPS, cell / LAMPS));
    let all: f64 = cells.clone().sum();
    for form in run.pick(vec!["primary", "multiplexed", "paths"], vec!["primary", "paths"]) {
        let technique = format!("mlt:form={form}:chains={}:candidates=8:large-step=0.05", SIZE * SIZE);
        let settings = Settings { max_depth: Some(1), ..run.settings(&scene, &technique)? };
        let mut renderer = Renderer::new(run.gpu, &scene, &settings)?;
        for mutations in [1, run.pick(128, 64)] {
            while renderer.advance(mutations)? {}
            let chains = renderer.chains()?;
            let mut counts = vec![0.0; LAMPS * LAMPS];
            let place = |x: f32| ((f64::from(x) / f64::from(SIZE) * LAMPS as f64) as usize).min(LAMPS - 1);
            chains.iter().for_each(|chain| counts[LAMPS * place(chain.position[1]) + place(chain.position[0])] += 1.0);
            let expected: Vec<f64> = cells.clone().map(|cell| cell / all * chains.len() as f64).collect();
            let z = chi_square_z(&counts, &expected);
            run.note(Figure::at_most(
                "mlt",
                format!("{form}, {mutations} mutations: chi-square z of 64 cells"),
                z,
                3.0,
            ));
        }
    }
    Ok(())
}
