//! Random numbers, through `shaders/kernels/test/random.glsl`.

use super::Run;
use super::figure::{Figure, Worst};
use super::sampling::chi_square_z;
use crate::error::Result;
use crate::layout::RandomQuery;
use crate::render::{Probe, Settings};
use crate::scene::SceneBuilder;
use crate::techniques::{SAMPLERS, Sampler};

/// The four numbers, then the maps of the first two.
type Mapped = [f32; 14];

fn correlation(a: &[f64], b: &[f64]) -> f64 {
    let n = a.len() as f64;
    let mean = |values: &[f64]| values.iter().sum::<f64>() / n;
    let (ma, mb) = (mean(a), mean(b));
    let covariance = a.iter().zip(b).map(|(x, y)| (x - ma) * (y - mb)).sum::<f64>();
    let spread = |values: &[f64], mean: f64| values.iter().map(|x| (x - mean).powi(2)).sum::<f64>();
    covariance / (spread(a, ma) * spread(b, mb)).sqrt()
}

/// Numbers of neighbouring pixels, samples and dimensions, of seeds, and of dimensions past any table.
pub(super) fn random_numbers(run: &mut Run) -> Result<()> {
    const SIDE: u32 = 512;
    let at = |index: u32| RandomQuery { pixel: index % SIDE, sample_index: index / SIDE, dimension: 3, seed: 1 };
    let base: Vec<RandomQuery> = (0..SIDE * SIDE).map(at).collect();
    let moved = |change: fn(&mut RandomQuery)| {
        let mut queries = base.clone();
        queries.iter_mut().for_each(change);
        queries
    };
    let neighbours = [
        ("the next pixel", moved(|q| q.pixel += 1)),
        ("the pixel below", moved(|q| q.pixel += 1920)),
        ("the next sample", moved(|q| q.sample_index += 1)),
        ("the next sample of its half", moved(|q| q.sample_index += 2)),
        ("the next dimensions", moved(|q| q.dimension += 1)),
        ("dimensions far on", moved(|q| q.dimension += 100_000)),
        ("another seed", moved(|q| q.seed = 2)),
        ("pixel and sample swapped", moved(|q| (q.pixel, q.sample_index) = (q.sample_index + 1, q.pixel))),
    ];
    let bound = 3.0 / f64::from(SIDE); // 3 / sqrt(N)
    let mut builder = SceneBuilder::new("numbers");
    let matte = builder.matte([0.5; 3]);
    builder.sphere(0, "ball", glam::DVec3::ZERO, 1.0, matte);
    let scene = builder.finish()?;
    for row in SAMPLERS {
        let settings = Settings { sampler: row.sampler, ..run.settings(&scene, "path")? };
        let probe = Probe::new(run.gpu, &scene, &settings, "test/random")?;
        let columns = |queries: &[RandomQuery]| -> Result<Vec<Vec<f64>>> {
            let rows: Vec<Mapped> = probe.run(queries)?;
            Ok((0..4).map(|index| rows.iter().map(|row| f64::from(row[index])).collect()).collect())
        };
        let here = columns(&base)?;
        let (mut worst, mut uniform) = (Worst::default(), Worst::default());
        let mut outside = 0;
        for (index, values) in here.iter().enumerate() {
            outside += values.iter().filter(|value| !(0.0..1.0).contains(*value)).count();
            let mut counts = vec![0.0; 1024];
            values.iter().for_each(|value| counts[((value * 1024.0) as usize).min(1023)] += 1.0);
            uniform.see(chi_square_z(&counts, &vec![values.len() as f64 / 1024.0; 1024]), || format!("number {index}"));
            for (other, others) in here.iter().enumerate().take(index) {
                worst.see(correlation(values, others).abs(), || format!("numbers {index} and {other}"));
            }
        }
        for (name, queries) in &neighbours {
            if row.sampler == Sampler::Sobol && *name == "the next sample of its half" {
                continue; // it is meant to lie elsewhere than the last one
            }
            for (index, values) in columns(queries)?.iter().enumerate() {
                worst.see(correlation(&here[index], values).abs(), || format!("{name}, number {index}"));
            }
        }
        run.note(worst.figure(row.name, "largest correlation", bound));
        run.note(uniform.figure(row.name, "chi-square z of 1024 cells", 3.0));
        run.note(Figure::at_most(row.name, "numbers outside of [0, 1)", outside as f64, 0.0));
    }
    Ok(())
}
