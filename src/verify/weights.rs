//! The weights of bidirectional strategies, through `shaders/kernels/test/strategies.glsl`, against their definition.

use glam::DVec3;

use super::Run;
use super::figure::Worst;
use super::geometry::{Random, lamp};
use crate::error::Result;
use crate::render::Probe;
use crate::scene::SceneBuilder;

/// Vertices that a path of the test may have.
const MOST: usize = 8;

/// A path by its densities; see `shaders/kernels/test/strategies.glsl`.
#[derive(Clone, Copy)]
struct Query {
    vertices: f32,
    camera_density: f32,
    emission_a: f32,
    emission_w: f32,
    choice_a: f32,
    to_light: [f32; MOST],
    to_camera: [f32; MOST],
    delta: [f32; MOST],
    distance2: [f32; MOST],
    near_cosine: [f32; MOST],
    far_cosine: [f32; MOST],
    merging: [f32; MOST],
    /// 0 is a pinhole.
    lens_a: f32,
}

impl Query {
    fn floats(&self) -> [f32; 64] {
        let mut all = vec![self.vertices, self.camera_density, self.emission_a, self.emission_w, self.choice_a];
        for part in
            [self.to_light, self.to_camera, self.delta, self.distance2, self.near_cosine, self.far_cosine, self.merging]
        {
            all.extend(part);
        }
        all.push(self.lens_a);
        all.resize(64, 0.0);
        std::array::from_fn(|index| all[index])
    }

    /// Densities per area with which each strategy makes the path, 0 where it cannot: first those that take 0, 1, ... all vertices from
    /// the light (Veach 1997, equations 10.7 to 10.9), then, from the place after the longest path's, merges at each vertex, where both parts come (Georgiev et al. 2012, equation 8).
    fn densities(&self, form: &str) -> [f64; 2 * MOST] {
        let n = self.vertices as usize;
        let at = |values: &[f32; MOST], index: usize| f64::from(values[index]);
        let [camera, emission_a, emission_w, choice_a] =
            [self.camera_density, self.emission_a, self.emission_w, self.choice_a].map(f64::from);
        let is_delta = |vertex: usize| self.delta[vertex] != 0.0;
        // Densities of a delta vertex leave out the same infinite factor either way: it drops out of all ratios.
        let to_far = |edge: usize| at(&self.far_cosine, edge) / at(&self.distance2, edge);
        let to_near = |edge: usize| at(&self.near_cosine, edge) / at(&self.distance2, edge);
        let from_camera = |t: usize| -> f64 {
            let later: f64 =
                (1..t.saturating_sub(1)).map(|vertex| at(&self.to_light, vertex) * to_far(vertex)).product();
            if t < 2 { 1.0 } else { camera * to_far(0) * later }
        };
        let from_light = |s: usize| match s {
            0 => 1.0,
            1 if n == 2 => emission_a,
            1 => choice_a,
            _ => {
                let later = (n - s + 1..n - 1).map(|vertex| at(&self.to_camera, vertex) * to_near(vertex - 1));
                emission_a * emission_w * to_near(n - 2) * later.product::<f64>()
            }
        };
        let (connects, merges) = (["vcm", "bpt"].contains(&form), form != "bpt");
        let mut all = [0.0; 2 * MOST];
        let lens = if self.lens_a > 0.0 { f64::from(self.lens_a) } else { 1.0 };
        for (s, density) in all.iter_mut().enumerate().take(n) {
            let t = n - s;
            let joins_delta = s > 0 && t > 1 && is_delta(t - 1) || s > 1 && is_delta(t);
            *density = if joins_delta || s > 0 && !connects { 0.0 } else { lens * from_camera(t) * from_light(s) };
        }
        // The first segment of a light subpath is not looked at: (1, 1) and (0, 2) do better.
        all[n] = if self.lens_a > 0.0 && connects && n > 2 { from_light(n) } else { 0.0 };
        for vertex in (1..n - 1).filter(|vertex| merges && !is_delta(*vertex)) {
            all[MOST + vertex] = lens * from_camera(vertex + 1) * from_light(n - vertex) * at(&self.merging, vertex);
        }
        all
    }
}

fn random_path(random: &mut Random) -> Query {
    let mut numbers = |range: f64| -> [f32; MOST] { std::array::from_fn(|_| scale(random, range)) };
    // Densities of directions: some vertices are glossy, both ways.
    let gloss = numbers(1e2).map(|value| value.max(1.0).powi(2));
    let (to_light, to_camera) = (numbers(10.0), numbers(10.0));
    let glossy = |pdf: [f32; MOST]| std::array::from_fn(|vertex| pdf[vertex] * gloss[vertex]);
    let (to_light, to_camera) = (glossy(to_light), glossy(to_camera));
    let (distance2, near, far, merging) = (numbers(1e2), numbers(10.0), numbers(10.0), numbers(1e2));
    let lens_a = if random.next() < 0.5 { scale(random, 1e2) } else { 0.0 };
    Query {
        vertices: (2 + (random.next() * 7.0) as u32) as f32,
        camera_density: scale(random, 1e2),
        emission_a: scale(random, 1e4),
        emission_w: scale(random, 10.0),
        choice_a: scale(random, 1e4),
        to_light,
        to_camera,
        delta: std::array::from_fn(|_| if random.next() < 0.2 { 1.0 } else { 0.0 }),
        distance2,
        near_cosine: near.map(|value| value / 10.0),
        far_cosine: far.map(|value| value / 10.0),
        merging,
        lens_a,
    }
}

/// Between 1/range and range, evenly in its logarithm.
fn scale(random: &mut Random, range: f64) -> f32 {
    range.powf(2.0 * random.next() - 1.0) as f32
}

/// The shader's weights, put together along the path, are those of the definition from products of densities in double precision, and
/// they sum to one, for each heuristic and however large the scene is.
pub(super) fn weights(run: &mut Run) -> Result<()> {
    let mut random = Random(7);
    let paths: Vec<Query> = (0..run.pick(4096, 1024)).map(|_| random_path(&mut random)).collect();
    let floats: Vec<[f32; 64]> = paths.iter().map(Query::floats).collect();
    let forms = ["vcm", "bpm", "bpt"].into_iter().flat_map(|form| {
        [("power", 2.0), ("balance", 1.0), ("none", 0.0)].map(|(weights, exponent)| (1.0, form, weights, exponent))
    });
    let scaled = [1e-4, 1e4].map(|scale| (scale, "vcm", "power", 2.0));
    for (scale, form, weights, exponent) in forms.chain(scaled) {
        let mut builder = SceneBuilder::new("light");
        let light = lamp(&mut builder, [1.0; 3]);
        builder.parallelogram(DVec3::new(-scale, -scale, 0.0), DVec3::X * 2.0 * scale, DVec3::Y * 2.0 * scale, light);
        let scene = builder.finish()?;
        let technique = format!("vcm:weights={weights}:form={form}");
        let probe = Probe::new(run.gpu, &scene, &run.settings(&scene, &technique)?, "test/strategies")?;
        let found: Vec<[f32; 2 * MOST]> = probe.run(&floats)?;
        let (mut worst, mut worst_sum) = (Worst::default(), Worst::default());
        for (index, (path, found)) in paths.iter().zip(&found).enumerate() {
            let shares = path.densities(form).map(|density| if density > 0.0 { density.powf(exponent) } else { 0.0 });
            let total: f64 = shares.iter().sum();
            for (strategy, (share, found)) in shares.iter().zip(found).enumerate() {
                let (expected, found) = (share / total, f64::from(*found));
                worst.see((expected - found).abs(), || {
                    format!("path {index}, strategy {strategy}: {found} against {expected}")
                });
            }
            let sum: f64 = found.iter().map(|weight| f64::from(*weight)).sum();
            worst_sum.see((sum - 1.0).abs(), || format!("path {index}: {sum}"));
        }
        run.note(worst.figure(&technique, format!("a weight off its definition, scale {scale}"), 1e-5));
        run.note(worst_sum.figure(&technique, format!("their sum off one, scale {scale}"), 1e-5));
    }
    Ok(())
}
