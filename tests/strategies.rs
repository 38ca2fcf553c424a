//! The strategies of bidirectional path tracing: their weights against the definition, and what each of them brings.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

use common::room::scene;
use common::{backends, canon, render, settings, with_gpu};
use lumbre::backend::Backend;
use lumbre::film::Film;
use lumbre::metrics::stats::Estimate;
use lumbre::render::{Probe, Settings};
use lumbre::strategies::Strategy;

/// Vertices that a path of the test may have.
const MOST: usize = 8;

/// A path by its densities; see `shaders/test/strategies.glsl`.
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
        all.try_into().unwrap()
    }

    /// Densities per area with which each strategy makes the path, 0 where it cannot: first those that take 0, 1, ... all vertices from
    /// the light (Veach 1997, equations 10.7 to 10.9), then, from the place after the longest path's, merges at each vertex, where both parts come (Georgiev et al. 2012, equation 8).
    fn densities(&self, form: &str) -> [f64; 2 * MOST] {
        let n = self.vertices as usize;
        let at = |values: &[f32; MOST], index: usize| f64::from(values[index]);
        let [camera, emission_a, emission_w, choice_a] =
            [self.camera_density, self.emission_a, self.emission_w, self.choice_a].map(f64::from);
        let is_delta = |vertex: usize| self.delta[vertex] != 0.0;
        // A delta vertex goes on with the same probability either way: it drops out of all ratios.
        let pdf = |values: &[f32; MOST], vertex: usize| if is_delta(vertex) { 1.0 } else { at(values, vertex) };
        let to_far = |edge: usize| at(&self.far_cosine, edge) / at(&self.distance2, edge);
        let to_near = |edge: usize| at(&self.near_cosine, edge) / at(&self.distance2, edge);
        let from_camera = |t: usize| -> f64 {
            let later: f64 =
                (1..t.saturating_sub(1)).map(|vertex| pdf(&self.to_light, vertex) * to_far(vertex)).product();
            if t < 2 { 1.0 } else { camera * to_far(0) * later }
        };
        let from_light = |s: usize| match s {
            0 => 1.0,
            1 if n == 2 => emission_a,
            1 => choice_a,
            _ => {
                let later = (n - s + 1..n - 1).map(|vertex| pdf(&self.to_camera, vertex) * to_near(vertex - 1));
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
        // The first segment of a light path is not looked at: (1, 1) and (0, 2) do better.
        all[n] = if self.lens_a > 0.0 && connects && n > 2 { from_light(n) } else { 0.0 };
        for vertex in (1..n - 1).filter(|vertex| merges && !is_delta(*vertex)) {
            all[MOST + vertex] = lens * from_camera(vertex + 1) * from_light(n - vertex) * at(&self.merging, vertex);
        }
        all
    }
}

/// Random numbers of a plain generator (Steele, Lea and Flood 2014, SplitMix).
struct Random(u64);

impl Random {
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Between 1/range and range, evenly in its logarithm.
    fn scale(&mut self, range: f64) -> f32 {
        range.powf(2.0 * self.uniform() - 1.0) as f32
    }
}

fn random_path(random: &mut Random) -> Query {
    let mut numbers = |range: f64| -> [f32; MOST] { std::array::from_fn(|_| random.scale(range)) };
    // Densities of directions: some vertices are glossy, both ways.
    let gloss = numbers(1e2).map(|value| value.max(1.0).powi(2));
    let (to_light, to_camera) = (numbers(10.0), numbers(10.0));
    let glossy = |pdf: [f32; MOST]| std::array::from_fn(|vertex| pdf[vertex] * gloss[vertex]);
    let (to_light, to_camera) = (glossy(to_light), glossy(to_camera));
    let (distance2, near, far, merging) = (numbers(1e2), numbers(10.0), numbers(10.0), numbers(1e2));
    let lens_a = if random.uniform() < 0.5 { random.scale(1e2) } else { 0.0 };
    Query {
        vertices: (2 + (random.uniform() * 7.0) as u32) as f32,
        camera_density: random.scale(1e2),
        emission_a: random.scale(1e4),
        emission_w: random.scale(10.0),
        choice_a: random.scale(1e4),
        to_light,
        to_camera,
        delta: std::array::from_fn(|_| if random.uniform() < 0.2 { 1.0 } else { 0.0 }),
        distance2,
        near_cosine: near.map(|value| value / 10.0),
        far_cosine: far.map(|value| value / 10.0),
        merging,
        lens_a,
    }
}

/// The shader's weights, put together along the path, are those of the definition from products of densities in double precision, and
/// they sum to one, for each heuristic and however large the scene is.
#[test]
fn weights_are_those_of_the_definition() {
    let mut random = Random(7);
    let paths: Vec<Query> = (0..4096).map(|_| random_path(&mut random)).collect();
    let floats: Vec<[f32; 64]> = paths.iter().map(Query::floats).collect();
    let forms = ["vcm", "bpm", "bpt"].into_iter().flat_map(|form| {
        [("power", 2.0), ("balance", 1.0), ("none", 0.0)].map(|(weights, exponent)| (1.0, form, weights, exponent))
    });
    let scaled = [1e-4, 1e4].map(|scale| (scale, "vcm", "power", 2.0));
    with_gpu(|gpu| {
        for (scale, form, weights, exponent) in forms.chain(scaled) {
            let scene = scene(&format!(
                "<shape type='rectangle'><transform name='to_world'><scale value='{scale}'/></transform>
                 <emitter type='area'><rgb name='radiance' value='1'/></emitter></shape>"
            ));
            let what = format!("vcm:weights={weights}:form={form}");
            let settings = settings(&scene, &what, Backend::Bvh);
            let probe = Probe::new(gpu, &scene, &settings, "test/strategies").unwrap();
            let found: Vec<[f32; 2 * MOST]> = probe.run(&floats).unwrap();
            let (mut worst, mut worst_sum) = (0.0f64, 0.0f64);
            for (path, found) in paths.iter().zip(&found) {
                let shares =
                    path.densities(form).map(|density| if density > 0.0 { density.powf(exponent) } else { 0.0 });
                let total: f64 = shares.iter().sum();
                for (share, found) in shares.iter().zip(found) {
                    worst = worst.max((share / total - f64::from(*found)).abs());
                }
                let sum: f64 = found.iter().map(|weight| f64::from(*weight)).sum();
                worst_sum = worst_sum.max((sum - 1.0).abs());
            }
            println!("{what} at scale {scale}: off by {worst:.1e} at most, their sum by {worst_sum:.1e}");
            assert!(
                worst < 1e-5 && worst_sum < 1e-5,
                "{what} at scale {scale}: off by {worst}, their sum by {worst_sum}"
            );
        }
    });
}

/// Weighted layers sum to the image; and each strategy by itself, where all surfaces are matte, brings all light of its path length.
#[test]
fn each_strategy_brings_all_of_its_length() {
    const LONGEST: u32 = 4;
    const SEEDS: u32 = 12;
    let scene = canon("cornell.xml", &[("size", "32")]);
    with_gpu(|gpu| {
        let truth = {
            let settings =
                Settings { lengths: LONGEST, max_depth: Some(LONGEST), ..settings(&scene, "path", Backend::Bvh) };
            let films: Vec<_> = (0..SEEDS)
                .map(|seed| render(gpu, &scene, &Settings { seed: 100 + seed, ..settings.clone() }, 512))
                .collect();
            (0..LONGEST as usize)
                .map(|layer| {
                    let averages: Vec<f64> = films.iter().map(|film| film.length(layer).average()[1]).collect();
                    Estimate::of(&averages)
                })
                .collect::<Vec<_>>()
        };
        for backend in backends(gpu) {
            let settings =
                Settings { strategies: LONGEST, max_depth: Some(LONGEST), ..settings(&scene, "bdpt", backend) };
            let films: Vec<_> =
                (0..SEEDS).map(|seed| render(gpu, &scene, &Settings { seed, ..settings.clone() }, 256)).collect();
            for (index, strategy) in Strategy::up_to(LONGEST).enumerate() {
                let average = |film: &Film| film.image_of(&film.strategies[index].unweighted).average()[1];
                let found = Estimate::of(&films.iter().map(average).collect::<Vec<f64>>());
                let z = found.z(&truth[strategy.segments() as usize - 1]);
                println!("{} on {}: {:.5}, z {z:.2}", strategy.name(), backend.name(), found.mean);
                // Few runs: Student's t with 11 degrees of freedom, of 14 comparisons on two backends.
                assert!(z.abs() < 5.0, "{} on {}: z {z}", strategy.name(), backend.name());
                assert!(found.variance.sqrt() < 0.05 * found.mean, "{}: too coarse", strategy.name());
            }
            let (film, image) = (&films[0], films[0].mean());
            let weighted: Vec<_> = film.strategies.iter().map(|layers| film.image_of(&layers.weighted)).collect();
            for (pixel, whole) in image.pixels.iter().enumerate() {
                for (channel, whole) in whole.iter().enumerate() {
                    let sum: f64 = weighted.iter().map(|layer| f64::from(layer.pixels[pixel][channel])).sum();
                    assert!((sum - f64::from(*whole)).abs() <= 1e-5 * f64::from(*whole).max(1e-3), "pixel {pixel}");
                }
            }
        }
    });
}
