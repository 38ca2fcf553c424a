//! Markov chains on a target that is known: a mosaic of lamps that fills the image, where paths have one segment and contribute what
//! the lamp there emits. Chains are at places in proportion to that, each weighted by the compression of its target (`bound` of `mlt`).

use glam::DVec3;

use super::Run;
use super::figure::Figure;
use super::geometry::{lamp, look};
use super::sampling::chi_square_z;
use crate::error::Result;
use crate::render::{Renderer, Settings};
use crate::scene::{Scene, SceneBuilder};
use crate::techniques::Chains;

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
        let technique = format!("mlt:form={form}:chains={}:candidates=131072:large-step=0.05:bound=2", SIZE * SIZE);
        let settings = Settings { max_depth: Some(1), ..run.settings(&scene, &technique)? };
        let mut renderer = Renderer::new(run.gpu, &scene, &settings)?;
        for mutations in [1, run.pick(128, 64)] {
            while renderer.advance(mutations)? {}
            let state = renderer.state::<Chains>()?;
            let chains = state.states()?;
            let bound = state.bound();
            // What stands for the chains at each lamp, and its square.
            let mut sums = vec![[0.0; 2]; LAMPS * LAMPS];
            let place = |x: f32| ((f64::from(x) / f64::from(SIZE) * LAMPS as f64) as usize).min(LAMPS - 1);
            for chain in &chains {
                let stands_for = 1.0 + f64::from(chain.contribution) / bound;
                let [sum, squares] = &mut sums[LAMPS * place(chain.position[1]) + place(chain.position[0])];
                *sum += stands_for;
                *squares += stands_for * stands_for;
            }
            // A sum of so many, each as large as their mean by squares, scatters as a count of them does.
            let total: f64 = sums.iter().map(|[sum, _]| sum).sum();
            let each = |[sum, squares]: [f64; 2]| if sum > 0.0 { squares / sum } else { 1.0 };
            let counts: Vec<f64> = sums.iter().map(|cell| cell[0] / each(*cell)).collect();
            let expected: Vec<f64> =
                cells.clone().zip(&sums).map(|(cell, sums)| cell / all * total / each(*sums)).collect();
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
