//! Lights selected from a tree: no light is lost, the density is the one that is evaluated, and many lights cost little.

use std::f64::consts::PI;

use crate::common::sampling::{Findings, numbers};
use crate::common::{assert_same_mean, backends, canon, render, scene_path, settings, with_gpu};
use glam::{DAffine3, DVec3};
use lumbre::gpu::Gpu;
use lumbre::layout::backend::Backend;
use lumbre::layout::{LightAnswer, LightQuery};
use lumbre::render::Probe;
use lumbre::scene::light::{Falloff, Lamp};
use lumbre::scene::{LightSelection, LoadOptions, Mesh, Scene, SceneBuilder, SurfaceDescription, load};
use lumbre::statistics::{Estimate, sidak, two_sided_p};
use lumbre::verify::expectations::polygon_irradiance;
use lumbre::verify::scattering::vector;

/// A light whose irradiance the host knows, occlusion aside.
#[derive(Clone, Copy)]
enum Known {
    Triangle([DVec3; 3], f64),
    Sphere(DVec3, f64, f64),
    Point(DVec3, f64),
    Spot(DVec3, DVec3, f64),
    Directional(DVec3, f64),
}

const SPOT_CUTOFF: f64 = 0.6;
const SPOT_BEAM: f64 = 0.35;

impl Known {
    fn add(&self, builder: &mut SceneBuilder) {
        let surface = |builder: &mut SceneBuilder, radiance: f64| {
            builder.surface(SurfaceDescription { emission: [radiance; 3], ..SurfaceDescription::default() })
        };
        match *self {
            Self::Triangle(corners, radiance) => {
                let surface = surface(builder, radiance);
                let mesh = Mesh { positions: corners.to_vec(), triangles: vec![[0, 1, 2]], ..Mesh::default() };
                builder.mesh(0, "light", mesh, DAffine3::IDENTITY, surface);
            }
            Self::Sphere(centre, radius, radiance) => {
                let surface = surface(builder, radiance);
                builder.sphere(0, "light", centre, radius, surface);
            }
            Self::Point(position, intensity) => {
                builder.lamps.push(Lamp::Point { position, intensity: [intensity; 3] });
            }
            Self::Spot(position, direction, intensity) => builder.lamps.push(Lamp::Spot {
                position,
                direction,
                intensity: [intensity; 3],
                cutoff: SPOT_CUTOFF,
                beam_width: SPOT_BEAM,
                falloff: Falloff::Angle,
                texture: None,
            }),
            Self::Directional(direction, irradiance) => {
                builder.lamps.push(Lamp::Directional { direction, irradiance: [irradiance; 3] });
            }
        }
    }

    /// Irradiance at p on a surface of normal n; nothing where no closed form is known.
    fn irradiance(&self, p: DVec3, n: DVec3) -> Option<f64> {
        let lamp = |position: DVec3, intensity: f64| {
            let d = position - p;
            intensity * (d.normalize().dot(n)).max(0.0) / d.length_squared()
        };
        Some(match *self {
            Self::Triangle([a, b, c], radiance) => {
                if (b - a).cross(c - a).dot(p - a) <= 0.0 {
                    return Some(0.0);
                }
                radiance * polygon_irradiance(&[a, b, c], p, n)
            }
            Self::Sphere(centre, radius, radiance) => {
                let d = centre - p;
                let height = d.dot(n);
                match height {
                    _ if d.length() <= radius => return None,
                    _ if height <= -radius => 0.0,
                    _ if height < radius => return None,
                    _ => PI * radiance * (radius / d.length()).powi(2) * height / d.length(),
                }
            }
            Self::Point(position, intensity) => lamp(position, intensity),
            Self::Spot(position, direction, intensity) => {
                let angle = (p - position).angle_between(direction);
                lamp(position, intensity) * ((SPOT_CUTOFF - angle) / (SPOT_CUTOFF - SPOT_BEAM)).clamp(0.0, 1.0)
            }
            Self::Directional(direction, irradiance) => irradiance * (-direction.dot(n)).max(0.0),
        })
    }
}

/// Numbers between 0 and 1 that look random (a linear congruence of Knuth's, upper bits).
struct Stream(u64);

impl Stream {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    fn within(&mut self, reach: f64) -> DVec3 {
        (DVec3::new(self.next(), self.next(), self.next()) - 0.5) * (2.0 * reach)
    }

    fn direction(&mut self) -> DVec3 {
        let (z, phi) = (1.0 - 2.0 * self.next(), 2.0 * PI * self.next());
        DVec3::new(phi.cos() * (1.0 - z * z).sqrt(), phi.sin() * (1.0 - z * z).sqrt(), z)
    }
}

/// Lights of every kind, strewn over clusters, with intensities over three orders of magnitude; `scale` is that of their places.
fn strewn(count: usize, scale: f64, seed: u64) -> Vec<Known> {
    let mut stream = Stream(seed);
    let mut lights = vec![Known::Directional(DVec3::new(0.3, -0.9, 0.2).normalize(), 0.02)];
    for index in 0..count {
        let cluster =
            DVec3::new((index % 5) as f64 * 3.0 - 6.0, (index % 3) as f64 - 1.0, (index % 7) as f64 * 2.0 - 6.0);
        let at = (cluster + stream.within(0.7)) * scale;
        let strength = 10f64.powf(3.0 * stream.next() - 2.0);
        let size = 0.15 * scale * (0.2 + stream.next());
        lights.push(match index % 10 {
            0..6 => {
                let (a, b) = stream.direction().any_orthonormal_pair();
                Known::Triangle([at, at + a * size, at + b * (size * 0.7)], strength)
            }
            6 => Known::Sphere(at, 0.5 * size, strength),
            7 => Known::Point(at, 0.02 * strength * scale * scale),
            _ => Known::Spot(at, stream.direction(), 0.2 * strength * scale * scale),
        });
    }
    lights
}

fn scene_of(lights: &[Known], how: LightSelection) -> Scene {
    let mut builder = SceneBuilder::new("many lights");
    lights.iter().for_each(|light| light.add(&mut builder));
    builder.light_selection = how;
    builder.finish().unwrap()
}

/// Samples of the lights of a scene, by the shader's own functions.
struct Bench {
    probe: Probe,
    origin: DVec3,
    numbers: Vec<[f32; 4]>,
}

impl Bench {
    fn new(gpu: &Gpu, scene: &Scene, numbers: Vec<[f32; 4]>) -> Self {
        let probe = Probe::new(gpu, scene, &settings(scene, "path", Backend::Bvh), "test/light").unwrap();
        Self { probe, origin: scene.origin, numbers }
    }

    fn sample(&self, p: DVec3, n: DVec3) -> Vec<LightAnswer> {
        let (point, normal) = ((p - self.origin).as_vec3().to_array(), n.as_vec3().to_array());
        let query = |u: &[f32; 4]| LightQuery { point, direction: [0.0, 0.0, 1.0], normal, u: *u };
        self.probe.run(&self.numbers.iter().map(query).collect::<Vec<_>>()).unwrap()
    }
}

/// Points among, beside and far from the lights, each with a normal.
fn receivers(scale: f64) -> Vec<(DVec3, DVec3)> {
    let mut stream = Stream(11);
    (0..24)
        .map(|index| {
            let reach = [4.0, 9.0, 60.0][index % 3];
            (stream.within(reach) * scale, stream.direction())
        })
        .collect()
}

/// Irradiance by samples of the tree against the sum over all lights in double precision, at scales from 1e-3 to 1e3. A light that
/// the tree leaves out where it could shed something, or a wrong probability, shows as a bias.
#[test]
fn no_light_is_lost() {
    const SAMPLES: usize = 1 << 16;
    with_gpu(|gpu| {
        let uniform = numbers(gpu, SAMPLES, 21);
        let mut findings = Findings::default();
        let mut zs = Vec::new();
        let mut seen_well = 0;
        for (scale, seed) in [(1.0, 1), (1e-3, 2), (1e3, 3)] {
            let lights = strewn(150, scale, seed);
            let scene = scene_of(&lights, LightSelection::Tree);
            assert!(!scene.light_tree.is_empty());
            let bench = Bench::new(gpu, &scene, uniform.clone());
            for (p, n) in receivers(scale) {
                let expected: Option<f64> = lights.iter().map(|light| light.irradiance(p, n)).sum();
                let Some(expected) = expected else { continue };
                let is_dark = expected == 0.0;
                let values: Vec<f64> = bench
                    .sample(p, n)
                    .iter()
                    .map(|answer| f64::from(answer.weight[0]) * vector(answer.wi).dot(n).max(0.0))
                    .collect();
                let found = Estimate::of(&values);
                if is_dark {
                    findings.check(found.mean == 0.0, || format!("scale {scale}, at {p}: {} against 0", found.mean));
                    continue;
                }
                let z = (found.mean - expected) / found.variance.sqrt().max(1e-4 * expected);
                zs.push((z, format!("scale {scale}, at {p}: {} against {expected}", found.mean)));
                seen_well += usize::from(found.variance.sqrt() < 0.03 * expected);
            }
        }
        assert!(zs.len() > 50 && seen_well > 50, "{seen_well} of {} receivers to 3 %", zs.len());
        let (worst, place) = zs.iter().max_by(|a, b| a.0.abs().total_cmp(&b.0.abs())).unwrap();
        let sum: f64 = zs.iter().map(|(z, _)| z).sum::<f64>() / (zs.len() as f64).sqrt();
        println!("{} receivers: largest z {worst:.2} ({place}), of all {sum:.2}", zs.len());
        findings.check(two_sided_p(*worst) > sidak(0.01, zs.len()), || format!("z = {worst:.2} {place}"));
        findings.check(two_sided_p(sum) > 1e-3, || format!("all receivers together: z = {sum:.2}"));
    });
}

/// The density of a sample is the one that is evaluated for a ray that finds the same place.
#[test]
fn densities_agree() {
    with_gpu(|gpu| {
        let lights = strewn(300, 1.0, 4);
        let bench = Bench::new(gpu, &scene_of(&lights, LightSelection::Auto), numbers(gpu, 4096, 22));
        let (mut seen, mut missed, mut worst) = (0, 0, 0.0f64);
        for (p, n) in receivers(1.0) {
            for answer in bench.sample(p, n) {
                if answer.delta == 1 || answer.visible == 0 {
                    continue;
                }
                seen += 1;
                let (a, b) = (f64::from(answer.pdf_w), f64::from(answer.found_pdf_w));
                let off = (a - b).abs() / a.max(b);
                if off > 1e-2 { missed += 1 } else { worst = worst.max(off) }
            }
        }
        println!("{seen} samples, {missed} met another light, density off by {worst:.1e}");
        assert!(seen > 20_000 && missed * 500 < seen && worst < 1e-3);
    });
}

fn alley(how: LightSelection) -> Scene {
    let defines = [("width", "96"), ("height", "96"), ("max_depth", "3")];
    let defines = defines.map(|(name, value)| (name.to_owned(), value.to_owned())).to_vec();
    load(&scene_path("many_lights.xml"), &LoadOptions { defines, lights: how, ..LoadOptions::default() }).unwrap()
}

/// An alley under 7560 lights: the tree's picture is that of selection by power, on every backend, with far less noise.
#[test]
fn tree_and_power_agree() {
    let (power, tree) = (alley(LightSelection::Power), alley(LightSelection::Auto));
    assert!(power.light_tree.is_empty() && tree.light_tree.len() == 2 * 7560 - 1);
    with_gpu(|gpu| {
        let mut settings_power = settings(&power, "direct:sampling=emitter", Backend::Bvh);
        settings_power.seed = 1;
        let truth = render(gpu, &power, &settings_power, 256);
        for backend in backends(gpu) {
            let found = render(gpu, &tree, &settings(&tree, "direct:sampling=emitter", backend), 32);
            assert_same_mean(&format!("emitter samples on {}", backend.name()), &found, &truth, 16);
            let variance = |film: &lumbre::render::film::Film, spp: f64| {
                let mut all: Vec<f32> = film.mean_variance().pixels.iter().flatten().copied().collect();
                all.sort_by(f32::total_cmp);
                f64::from(all[all.len() / 2]) * spp
            };
            let ratio = variance(&truth, 256.0) / variance(&found, 32.0);
            println!("{}: the median pixel's variance is {ratio:.1} times smaller from the tree", backend.name());
            assert!(ratio > 4.0, "{ratio}");
        }
        let mis = render(gpu, &tree, &settings(&tree, "path", Backend::Bvh), 64);
        let mut settings_power = settings(&power, "path", Backend::Bvh);
        settings_power.seed = 1;
        let truth = render(gpu, &power, &settings_power, 256);
        assert_same_mean("path", &mis, &truth, 16);
    });
}

/// Few lights keep the table; asking for a tree gives one, and asking for power never does.
#[test]
fn the_choice_is_the_users() {
    let few = |how| {
        let defines = Vec::new();
        load(&scene_path("veach_mis.xml"), &LoadOptions { defines, lights: how, ..LoadOptions::default() }).unwrap()
    };
    assert!(few(LightSelection::Auto).light_tree.is_empty());
    assert!(!few(LightSelection::Tree).light_tree.is_empty());
    assert!(alley(LightSelection::Power).light_tree.is_empty());
    assert!(canon("cornell.xml", &[]).light_tree.is_empty());
}
