//! Random numbers, sampling maps and BSDFs, through the shaders' own functions.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

use common::{settings, with_gpu};
use std::f64::consts::PI;

use glam::{DVec3, Vec3};
use lumbre::backend::Backend;
use lumbre::gpu::Gpu;
use lumbre::layout::{BsdfAnswer, BsdfQuery, Material, RandomQuery};
use lumbre::render::Probe;
use lumbre::scene::{Scene, SceneBuilder, SurfaceDescription, material};

/// What `shaders/test/random.glsl` writes: the four numbers, then the maps of the first two.
type Mapped = [f32; 14];

fn random(gpu: &Gpu, queries: &[RandomQuery]) -> Vec<Mapped> {
    let scene = with_materials(&[material::diffuse([0.5; 3])]);
    let probe = Probe::new(gpu, &scene, &settings(&scene, "path", Backend::Bvh), "test/random").unwrap();
    probe.run(queries).unwrap()
}

/// A scene that uses these materials, so that none is left out of the kernel.
fn with_materials(materials: &[Material]) -> Scene {
    let mut builder = SceneBuilder::new("materials");
    for (index, material) in materials.iter().enumerate() {
        let id = builder.material(*material);
        let surface =
            builder.surface(SurfaceDescription { front: Some(id), back: None, ..SurfaceDescription::default() });
        builder.sphere(0, "sphere", DVec3::new(index as f64 * 3.0, 0.0, 0.0), 1.0, surface);
    }
    builder.finish().unwrap()
}

fn correlation(a: &[f64], b: &[f64]) -> f64 {
    let n = a.len() as f64;
    let mean = |values: &[f64]| values.iter().sum::<f64>() / n;
    let (ma, mb) = (mean(a), mean(b));
    let covariance = a.iter().zip(b).map(|(x, y)| (x - ma) * (y - mb)).sum::<f64>();
    let spread = |values: &[f64], mean: f64| values.iter().map(|x| (x - mean).powi(2)).sum::<f64>();
    covariance / (spread(a, ma) * spread(b, mb)).sqrt()
}

/// Chi-square statistic of counts against expectations, as a standard normal deviate (Wilson and Hilferty 1931).
fn chi_square_z(observed: &[f64], expected: &[f64]) -> f64 {
    // Cells with small expectations are pooled, as the test's asymptotics ask for.
    let (mut pooled, mut cells, mut statistic) = ((0.0, 0.0), 0.0, 0.0);
    for (o, e) in observed.iter().zip(expected) {
        pooled = (pooled.0 + o, pooled.1 + e);
        if pooled.1 >= 10.0 {
            statistic += (pooled.0 - pooled.1).powi(2) / pooled.1;
            cells += 1.0;
            pooled = (0.0, 0.0);
        }
    }
    let freedom: f64 = cells - 1.0;
    ((statistic / freedom).powf(1.0 / 3.0) - (1.0 - 2.0 / (9.0 * freedom))) / (2.0 / (9.0 * freedom)).sqrt()
}

#[test]
fn random_numbers_are_uniform_and_uncorrelated() {
    const SIDE: u32 = 512;
    let base: Vec<RandomQuery> = (0..SIDE * SIDE)
        .map(|index| RandomQuery { pixel: index % SIDE, sample_index: index / SIDE, dimension: 3, seed: 1 })
        .collect();
    let moved = |change: fn(&mut RandomQuery)| {
        let mut queries = base.clone();
        queries.iter_mut().for_each(change);
        queries
    };
    let neighbours = [
        ("the next pixel", moved(|q| q.pixel += 1)),
        ("the pixel below", moved(|q| q.pixel += 1920)),
        ("the next sample", moved(|q| q.sample_index += 1)),
        ("the next dimensions", moved(|q| q.dimension += 1)),
        ("dimensions far on", moved(|q| q.dimension += 100_000)),
        ("another seed", moved(|q| q.seed = 2)),
        ("pixel and sample swapped", moved(|q| (q.pixel, q.sample_index) = (q.sample_index + 1, q.pixel))),
    ];
    with_gpu(|gpu| {
        let column = |rows: &[Mapped], index: usize| rows.iter().map(|row| f64::from(row[index])).collect::<Vec<f64>>();
        let here = random(gpu, &base);
        let bound = 3.0 / f64::from(SIDE); // 3 / sqrt(N)
        for index in 0..4 {
            let values = column(&here, index);
            let n = values.len() as f64;
            assert!(values.iter().all(|value| (0.0..1.0).contains(value)));
            let mean = values.iter().sum::<f64>() / n;
            assert!((mean - 0.5).abs() < 3.0 * (1.0 / 12.0 / n).sqrt(), "number {index}: mean {mean}");
            let mut counts = vec![0.0; 1024];
            values.iter().for_each(|value| counts[(value * 1024.0) as usize] += 1.0);
            let z = chi_square_z(&counts, &vec![n / 1024.0; 1024]);
            println!("number {index}: mean {mean:.5}, chi-square z {z:.2}");
            assert!(z < 3.0, "number {index}: chi-square z {z}");
            for other in 0..index {
                let r = correlation(&values, &column(&here, other));
                assert!(r.abs() < bound, "numbers {index} and {other}: correlation {r}");
            }
        }
        for (name, queries) in neighbours {
            let there = random(gpu, &queries);
            for index in 0..4 {
                let r = correlation(&column(&here, index), &column(&there, index));
                println!("{name}, number {index}: correlation {r:+.5}, bound {bound:.5}");
                assert!(r.abs() < bound, "{name}, number {index}: correlation {r}");
            }
        }
    });
}

#[test]
fn maps_have_the_moments_of_their_shapes() {
    let queries: Vec<RandomQuery> = (0..1 << 18).map(|pixel| RandomQuery { pixel, ..RandomQuery::default() }).collect();
    with_gpu(|gpu| {
        let rows = random(gpu, &queries);
        let n = rows.len() as f64;
        let check = |name: &str, expected: f64, deviation: f64, value: &dyn Fn(&Mapped) -> f64| {
            let mean = rows.iter().map(value).sum::<f64>() / n;
            assert!((mean - expected).abs() < 4.0 * deviation / n.sqrt(), "{name}: {mean} against {expected}");
        };
        let at = |row: &Mapped, index: usize| f64::from(row[index]);
        // A uniform disk: E x^2 = 1/4, E r^4 = 1/3. A cosine hemisphere: E z = 2/3, E z^2 = 1/2. A sphere: E z^2 = 1/3.
        // A triangle: E b = 1/3, E b^2 = 1/6, E b1 b2 = 1/12.
        check("disk x", 0.0, 0.5, &|row| at(row, 4));
        check("disk x^2", 0.25, 0.25, &|row| at(row, 4).powi(2));
        check("disk r^4", 1.0 / 3.0, 0.3, &|row| (at(row, 4).powi(2) + at(row, 5).powi(2)).powi(2));
        check("hemisphere z", 2.0 / 3.0, 0.236, &|row| at(row, 8));
        check("hemisphere z^2", 0.5, 0.289, &|row| at(row, 8).powi(2));
        check("sphere z^2", 1.0 / 3.0, 0.3, &|row| at(row, 11).powi(2));
        check("sphere x y", 0.0, 0.26, &|row| at(row, 9) * at(row, 10));
        check("triangle b1", 1.0 / 3.0, 0.236, &|row| at(row, 12));
        check("triangle b1^2", 1.0 / 6.0, 0.2, &|row| at(row, 12).powi(2));
        check("triangle b1 b2", 1.0 / 12.0, 0.08, &|row| at(row, 12) * at(row, 13));
        for row in &rows {
            let [hemisphere, sphere] = [6, 9].map(|index| Vec3::new(row[index], row[index + 1], row[index + 2]));
            assert!((hemisphere.length() - 1.0).abs() < 1e-6 && hemisphere.z >= 0.0, "{hemisphere}");
            assert!((sphere.length() - 1.0).abs() < 1e-6, "{sphere}");
            assert!(row[12] >= 0.0 && row[13] >= 0.0 && row[12] + row[13] <= 1.0 + 1e-6);
        }
    });
}

/// A material to test, with what is known of it.
struct Case {
    name: &'static str,
    material: Material,
    transmits: bool,
    /// It neither absorbs nor, in theory, loses energy to multiple scattering.
    lossless: bool,
}

fn cases() -> Vec<Case> {
    let white = [1.0; 3];
    let (eta, k) = ([0.2, 0.92, 1.1], [3.9, 2.45, 2.14]);
    let case = |name, material, transmits, lossless| Case { name, material, transmits, lossless };
    vec![
        case("diffuse", material::diffuse([0.2, 0.5, 0.8]), false, false),
        case("conductor", material::conductor(eta, k, white, None), false, false),
        case("rough conductor 0.1", material::conductor(eta, k, white, Some([0.1; 2])), false, false),
        case("rough conductor 0.5", material::conductor(eta, k, white, Some([0.5; 2])), false, false),
        case("rough conductor 0.2 x 0.6", material::conductor(eta, k, white, Some([0.2, 0.6])), false, false),
        case("rough conductor 1.0", material::conductor(eta, k, white, Some([1.0; 2])), false, false),
        case("dielectric", material::dielectric(1.5, white, white, None), true, true),
        case("rough dielectric 0.1", material::dielectric(1.5, white, white, Some([0.1; 2])), true, false),
        case("rough dielectric 0.4", material::dielectric(1.5, white, white, Some([0.4; 2])), true, false),
        case("rough dielectric 1.0, dense", material::dielectric(2.4, white, white, Some([1.0; 2])), true, false),
        case("rough dielectric 0.3, thin", material::dielectric(1.0 / 1.33, white, white, Some([0.3; 2])), true, false),
    ]
}

/// The cases whose BSDF is a function.
fn smooth_free(case: &Case) -> bool {
    case.name != "conductor" && case.name != "dielectric"
}

struct Bench<'a> {
    probe: Probe,
    cases: Vec<Case>,
    gpu: &'a Gpu,
}

impl<'a> Bench<'a> {
    fn new(gpu: &'a Gpu) -> Self {
        let cases = cases();
        let scene = with_materials(&cases.iter().map(|case| case.material).collect::<Vec<_>>());
        let probe = Probe::new(gpu, &scene, &settings(&scene, "path", Backend::Bvh), "test/bsdf").unwrap();
        Self { probe, cases, gpu }
    }

    fn ask(&self, queries: &[BsdfQuery]) -> Vec<BsdfAnswer> {
        self.probe.run(queries).unwrap()
    }

    /// Uniform numbers, three to a query.
    fn numbers(&self, count: usize, seed: u32) -> Vec<[f32; 3]> {
        let queries: Vec<_> =
            (0..count as u32).map(|pixel| RandomQuery { pixel, sample_index: 0, dimension: 0, seed }).collect();
        random(self.gpu, &queries).iter().map(|row| [row[0], row[1], row[2]]).collect()
    }
}

fn direction(cos_theta: f32, phi: f32) -> [f32; 3] {
    let sin_theta = (1.0 - cos_theta * cos_theta).max(0.0).sqrt();
    [sin_theta * phi.cos(), sin_theta * phi.sin(), cos_theta]
}

/// Outgoing directions: from grazing to normal, and from below where the material transmits.
fn outgoing(case: &Case) -> Vec<[f32; 3]> {
    let above = [0.1, 0.2, 0.5, 0.8, 0.999].map(|cos| direction(cos, 0.7 + cos));
    let below = above.map(|[x, y, z]| [x, y, -z]);
    if case.transmits { above.into_iter().chain(below).collect() } else { above.to_vec() }
}

/// Samples fall where the density says: a chi-square test on a grid over the sphere of directions.
#[test]
fn bsdf_samples_follow_their_density() {
    const ROWS: usize = 32;
    const COLUMNS: usize = 32;
    const FINE: usize = 24; // quadrature points of a cell along each side
    const SAMPLES: usize = 200_000;
    with_gpu(|gpu| {
        let bench = Bench::new(gpu);
        let mut tests = Vec::new();
        for (material, case) in bench.cases.iter().enumerate().filter(|(_, case)| smooth_free(case)) {
            for wo in outgoing(case) {
                let ask = |wi: [f32; 3], u: [f32; 3]| BsdfQuery { material: material as u32, wo, wi, u };
                // The expected counts: the density integrated over each cell of cos(theta) x phi.
                let (fine_rows, fine_columns) = (ROWS * FINE, COLUMNS * FINE);
                let queries: Vec<_> = (0..fine_rows * fine_columns)
                    .map(|index| {
                        let theta = PI as f32 * ((index / fine_columns) as f32 + 0.5) / fine_rows as f32;
                        let phi = 2.0 * PI as f32 * ((index % fine_columns) as f32 + 0.5) / fine_columns as f32;
                        ask(direction(theta.cos(), phi), [0.5; 3])
                    })
                    .collect();
                let mut expected = vec![0.0; ROWS * COLUMNS];
                for (index, answer) in bench.ask(&queries).iter().enumerate() {
                    assert!(answer.pdf_w >= 0.0 && answer.pdf_w.is_finite(), "{}: density {}", case.name, answer.pdf_w);
                    let (fine_row, fine_column) = (index / fine_columns, index % fine_columns);
                    // The solid angle of a patch: its width in phi times the difference of its cosines.
                    let edge = |row: usize| (PI * row as f64 / fine_rows as f64).cos();
                    let solid_angle = 2.0 * PI / fine_columns as f64 * (edge(fine_row) - edge(fine_row + 1));
                    expected[fine_row / FINE * COLUMNS + fine_column / FINE] +=
                        f64::from(answer.pdf_w) * solid_angle * SAMPLES as f64;
                }
                let queries: Vec<_> =
                    bench.numbers(SAMPLES, material as u32).into_iter().map(|u| ask([0.0, 0.0, 1.0], u)).collect();
                let mut observed = vec![0.0; ROWS * COLUMNS];
                let mut invalid = 0.0;
                for answer in bench.ask(&queries) {
                    if answer.sampled_pdf_w == 0.0 {
                        invalid += 1.0;
                        continue;
                    }
                    let [x, y, z] = answer.sampled.map(f64::from);
                    let row = ((z.clamp(-1.0, 1.0).acos() / PI * ROWS as f64) as usize).min(ROWS - 1);
                    let column =
                        ((y.atan2(x).rem_euclid(2.0 * PI) / (2.0 * PI) * COLUMNS as f64) as usize).min(COLUMNS - 1);
                    observed[row * COLUMNS + column] += 1.0;
                }
                // Narrow peaks are not resolved by the quadrature: those cells are compared as one.
                let total: f64 = expected.iter().sum::<f64>() + invalid;
                let share = total / SAMPLES as f64;
                tests.push((case.name, wo, chi_square_z(&observed, &expected), share));
            }
        }
        for (name, wo, z, share) in &tests {
            println!(
                "{name}, wo.z = {:.3}: chi-square z {z:.2}, density integrates to {share:.4} with what is invalid",
                wo[2]
            );
        }
        // p > 0.01 for all of them together (Sidak): z below 3.7 for about fifty tests.
        let worst = tests.iter().max_by(|a, b| a.2.total_cmp(&b.2)).unwrap();
        assert!(worst.2 < 3.7, "{}, wo {:?}: chi-square z {}", worst.0, worst.1, worst.2);
        for (name, wo, _, share) in &tests {
            assert!((share - 1.0).abs() < 0.01, "{name}, wo {wo:?}: the density integrates to {share}");
        }
    });
}

/// weight = f |cos| / pdf, and what `sample` says of its direction is what `eval` and `pdf` say of it.
#[test]
fn bsdf_sample_eval_and_pdf_agree() {
    with_gpu(|gpu| {
        let bench = Bench::new(gpu);
        for (material, case) in bench.cases.iter().enumerate().filter(|(_, case)| smooth_free(case)) {
            for wo in outgoing(case) {
                let queries: Vec<_> = bench
                    .numbers(20_000, 77)
                    .into_iter()
                    .map(|u| BsdfQuery { material: material as u32, wo, wi: [0.0, 0.0, 1.0], u })
                    .collect();
                let mut worst: f32 = 0.0;
                for (query, answer) in
                    queries.iter().zip(bench.ask(&queries)).filter(|(_, answer)| answer.sampled_pdf_w > 0.0)
                {
                    // Directions along the surface amplify rounding without limit, as the density does.
                    if answer.sampled[2].abs() < 1e-3 {
                        continue;
                    }
                    let relative = |a: f32, b: f32| (a - b).abs() / a.abs().max(b.abs()).max(1e-4);
                    let pdf = relative(answer.sampled_pdf_w, answer.evaluated_pdf_w);
                    let value = (0..3)
                        .map(|c| relative(answer.weight[c] * answer.sampled_pdf_w, answer.sampled_value[c]))
                        .fold(0.0, f32::max);
                    worst = worst.max(pdf).max(value);
                    assert!(pdf < 2e-2 && value < 2e-2, "{}: {query:?} {answer:?}", case.name);
                }
                assert!(worst < 2e-2, "{}, wo {wo:?}: {worst}", case.name);
            }
        }
    });
}

/// No material gives back more than it gets; one that cannot lose anything gives all of it back.
#[test]
fn bsdf_energy_is_conserved() {
    with_gpu(|gpu| {
        let bench = Bench::new(gpu);
        for (material, case) in bench.cases.iter().enumerate() {
            for wo in outgoing(case) {
                let queries: Vec<_> = bench
                    .numbers(100_000, 5)
                    .into_iter()
                    .map(|u| BsdfQuery { material: material as u32, wo, wi: [0.0, 0.0, 1.0], u })
                    .collect();
                // Radiance that crosses into a medium of index eta is scaled by 1 / eta^2; energy is not.
                let eta = if wo[2] > 0.0 { case.material.eta } else { 1.0 / case.material.eta };
                let mut sum = 0.0;
                for answer in bench.ask(&queries) {
                    let crossed = case.transmits && answer.sampled[2] * wo[2] < 0.0;
                    sum += f64::from(answer.weight[0]) * f64::from(if crossed { eta * eta } else { 1.0 });
                }
                let albedo = sum / queries.len() as f64;
                println!("{}, wo.z = {:+.3}: albedo {albedo:.4}", case.name, wo[2]);
                assert!(albedo <= 1.002, "{}, wo {wo:?}: albedo {albedo}", case.name);
                assert!(!case.lossless || (albedo - 1.0).abs() < 5e-3, "{}, wo {wo:?}: albedo {albedo}", case.name);
                assert!(albedo > 0.1, "{}, wo {wo:?}: albedo {albedo}", case.name);
            }
        }
    });
}

/// Albedo of GGX with Smith's height-correlated masking and a Fresnel factor of 1: 1 - ln 2 at normal incidence for
/// alpha = 1 in closed form, 0.4507 at cos = 0.5, by quadrature.
#[test]
fn ggx_albedo_is_the_known_one() {
    let mut mirror = material::conductor([0.0; 3], [1.0; 3], [1.0; 3], Some([1.0; 2])); // eta 0, k 1 reflects everything
    mirror.flags = lumbre::layout::MASKING_CORRELATED;
    let scene = with_materials(&[mirror]);
    with_gpu(|gpu| {
        let probe = Probe::new(gpu, &scene, &settings(&scene, "path", Backend::Bvh), "test/bsdf").unwrap();
        let queries: Vec<_> =
            (0..1 << 20).map(|pixel| RandomQuery { pixel, seed: 9, ..RandomQuery::default() }).collect();
        let numbers = random(gpu, &queries);
        for (cos, expected) in [(1.0, 1.0 - std::f64::consts::LN_2), (0.5, 0.4507)] {
            let queries: Vec<_> = numbers
                .iter()
                .map(|row| BsdfQuery {
                    material: 0,
                    wo: direction(cos, 0.3),
                    wi: [0.0, 0.0, 1.0],
                    u: [row[0], row[1], row[2]],
                })
                .collect();
            let answers: Vec<BsdfAnswer> = probe.run(&queries).unwrap();
            let albedo = answers.iter().map(|answer| f64::from(answer.weight[0])).sum::<f64>() / answers.len() as f64;
            println!("alpha 1, cos {cos}: albedo {albedo:.5} against {expected:.5}");
            assert!((albedo - expected).abs() < 1.5e-3, "cos {cos}: {albedo} against {expected}");
        }
    });
}

/// f(wo, wi) = f(wi, wo), with the factor eta^2 between the two sides of a dielectric (Veach 1997, equation 5.14).
#[test]
fn bsdfs_are_reciprocal() {
    with_gpu(|gpu| {
        let bench = Bench::new(gpu);
        let numbers = bench.numbers(20_000, 31);
        let directions: Vec<_> =
            numbers.iter().map(|[a, b, _]| direction(2.0 * a - 1.0, std::f32::consts::TAU * b)).collect();
        for (material, case) in bench.cases.iter().enumerate().filter(|(_, case)| smooth_free(case)) {
            let mut pairs: Vec<_> = directions.chunks_exact(2).map(|pair| (pair[0], pair[1])).collect();
            if !case.transmits {
                pairs.retain(|(a, b)| a[2] > 0.0 && b[2] > 0.0);
            }
            pairs.retain(|(a, b)| a[2].abs() > 1e-2 && b[2].abs() > 1e-2);
            let ask = |wo, wi| BsdfQuery { material: material as u32, wo, wi, u: [0.5; 3] };
            let there = bench.ask(&pairs.iter().map(|(a, b)| ask(*a, *b)).collect::<Vec<_>>());
            let back = bench.ask(&pairs.iter().map(|(a, b)| ask(*b, *a)).collect::<Vec<_>>());
            let mut worst: f64 = 0.0;
            for (((a, b), there), back) in pairs.iter().zip(&there).zip(&back) {
                let eta2 = f64::from(case.material.eta).powi(2);
                for channel in 0..3 {
                    // Of the BSDF itself: f |cos| over the cosine of the incident direction.
                    let mut f = f64::from(there.value[channel]) / f64::from(b[2].abs());
                    let mut g = f64::from(back.value[channel]) / f64::from(a[2].abs());
                    if a[2] * b[2] < 0.0 {
                        // Light that comes along b and leaves along a: f / eta_a^2 = g / eta_b^2, eta being the index of
                        // the medium that a direction lies in: 1 above, the material's below.
                        if b[2] < 0.0 {
                            f *= eta2;
                        } else {
                            g *= eta2;
                        }
                    }
                    if f.max(g) > 1e-4 {
                        worst = worst.max((f - g).abs() / f.max(g));
                    }
                }
            }
            println!("{}: largest relative difference {worst:.1e}", case.name);
            assert!(worst < 1e-5, "{}: {worst}", case.name);
        }
    });
}

/// Fresnel's and Snell's laws of smooth glass: 4 % at normal incidence, total reflection beyond the critical angle.
#[test]
fn smooth_glass_follows_fresnel_and_snell() {
    let scene = with_materials(&[material::dielectric(1.5, [1.0; 3], [1.0; 3], None)]);
    with_gpu(|gpu| {
        let probe = Probe::new(gpu, &scene, &settings(&scene, "path", Backend::Bvh), "test/bsdf").unwrap();
        let ask = |wo: [f32; 3], lobe: f32| -> BsdfAnswer {
            let answers: Vec<BsdfAnswer> =
                probe.run(&[BsdfQuery { material: 0, wo, wi: [0.0, 0.0, 1.0], u: [0.5, 0.5, lobe] }]).unwrap();
            answers[0]
        };
        let (reflected, refracted) = (0.0, 0.999_999);
        assert!((ask([0.0, 0.0, 1.0], reflected).sampled_pdf_w - 0.04).abs() < 1e-6);
        assert!((ask([0.0, 0.0, -1.0], reflected).sampled_pdf_w - 0.04).abs() < 1e-6);
        for cos in [0.05f32, 0.3, 0.7, 0.95] {
            let wo = direction(cos, 1.1);
            let answer = ask(wo, refracted);
            let (sin_i, sin_t) = ((1.0 - cos * cos).sqrt(), answer.sampled[0].hypot(answer.sampled[1]));
            assert!((sin_i - 1.5 * sin_t).abs() < 1e-5, "Snell at cos {cos}: {sin_i} against 1.5 x {sin_t}");
            assert!(answer.sampled[2] < 0.0);
            // Fresnel's equations in double precision.
            let (cos_i, cos_t) = (f64::from(cos), (1.0 - (f64::from(sin_i) / 1.5).powi(2)).sqrt());
            let parallel = (1.5 * cos_i - cos_t) / (1.5 * cos_i + cos_t);
            let perpendicular = (cos_i - 1.5 * cos_t) / (cos_i + 1.5 * cos_t);
            let expected = 0.5 * (parallel * parallel + perpendicular * perpendicular);
            let found = f64::from(ask(wo, reflected).sampled_pdf_w);
            assert!((found - expected).abs() < 1e-6, "Fresnel at cos {cos}: {found} against {expected}");
        }
        // From inside, the critical angle has sin = 1 / 1.5.
        let critical = (1.0 - 1.0 / 2.25f32).sqrt();
        assert_eq!(ask(direction(-(critical - 1e-4), 0.2), refracted).sampled_pdf_w, 1.0, "total internal reflection");
        assert!(ask(direction(-(critical + 1e-3), 0.2), refracted).sampled[2] > 0.0, "refraction just before it");
    });
}
