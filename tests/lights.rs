//! Every light: what sampling it gives against what rays find and against integrals in double precision.

use std::f64::consts::{PI, TAU};

use crate::common::sampling::{Findings, Rings, chi_square_z, numbers, spread};
use crate::common::{canon, room, scene_path, settings, with_gpu};
use glam::{DAffine3, DMat3, DVec2, DVec3, Vec2};
use lumbre::gpu::Gpu;
use lumbre::image::{Texels, TextureImage};
use lumbre::layout::backend::Backend;
use lumbre::layout::{LightAnswer, LightQuery};
use lumbre::render::{Probe, Technique};
use lumbre::scene::light::{Falloff, Lamp};
use lumbre::scene::texture::{Pattern, TextureDescription, Wrap};
use lumbre::scene::{Mesh, Scene, SceneBuilder, SurfaceDescription};
use lumbre::verify::scattering::vector;

/// An image, as the host looks it up: bilinear, repeated across and, unless `clamp`, down.
#[derive(Clone)]
struct Image {
    width: usize,
    height: usize,
    texels: Vec<[f32; 4]>,
    clamp: bool,
}

impl Image {
    /// Smooth variation without a pattern, each texel positive.
    fn waves(width: usize, height: usize) -> Self {
        let texel = |index: usize| {
            let t = index as f32;
            [1.0 + (1.7 * t).sin() * 0.8, 1.0 + (2.3 * t + 1.0).sin() * 0.9, 1.0 + (0.9 * t + 2.0).cos() * 0.7, 1.0]
        };
        Self { width, height, texels: (0..width * height).map(texel).collect(), clamp: false }
    }

    fn at(&self, uv: DVec2) -> DVec3 {
        let p = uv * DVec2::new(self.width as f64, self.height as f64) - 0.5;
        let (corner, f) = (p.floor(), p - p.floor());
        let texel = |dx: i64, dy: i64| {
            let x = (corner.x as i64 + dx).rem_euclid(self.width as i64) as usize;
            let y = corner.y as i64 + dy;
            let last = self.height as i64 - 1;
            let y = if self.clamp { y.clamp(0, last) } else { y.rem_euclid(self.height as i64) } as usize;
            let [r, g, b, _] = self.texels[y * self.width + x];
            DVec3::new(f64::from(r), f64::from(g), f64::from(b))
        };
        texel(0, 0).lerp(texel(1, 0), f.x).lerp(texel(0, 1).lerp(texel(1, 1), f.x), f.y)
    }

    /// Adds it as a texture.
    fn add(&self, builder: &mut SceneBuilder) -> u32 {
        let image = builder.image(TextureImage {
            source: "test".into(),
            width: self.width as u32,
            height: self.height as u32,
            texels: Texels::Float(self.texels.clone()),
        });
        let wrap = [Wrap::Repeat, if self.clamp { Wrap::Clamp } else { Wrap::Repeat }];
        builder.texture(TextureDescription { wrap, ..TextureDescription::new(Pattern::Image(image)) })
    }
}

/// What emits, as the host integrates it.
enum Emitter {
    /// Corners, their texture coordinates, radiance, texture.
    Triangle([DVec3; 3], [DVec2; 3], DVec3, Option<Image>),
    /// Centre, radius (negative: emits inwards), radiance, texture.
    Sphere(DVec3, f64, DVec3, Option<Image>),
    /// Constant radiance from everywhere.
    Constant(DVec3),
    /// Factor, image, axes of the image in the world.
    Environment(DVec3, Image, DMat3),
    /// A dark sphere, beside which other emitters are small.
    Dark(DVec3, f64),
}

const UVS: [DVec2; 3] = [DVec2::new(0.1, 0.2), DVec2::new(1.9, 0.4), DVec2::new(0.6, 1.7)];

impl Emitter {
    /// Adds it to a scene; spheres of the same radiance share a surface.
    fn add(&self, builder: &mut SceneBuilder, shared: &mut Vec<(DVec3, usize)>) {
        let surface = |builder: &mut SceneBuilder, radiance: &DVec3, image: &Option<Image>| {
            let emission_texture = image.as_ref().map(|image| image.add(builder));
            builder.surface(SurfaceDescription {
                emission: radiance.to_array(),
                emission_texture,
                ..SurfaceDescription::default()
            })
        };
        match self {
            Self::Triangle(positions, uvs, radiance, image) => {
                let surface = surface(builder, radiance, image);
                let uvs = uvs.iter().map(|uv| Vec2::new(uv.x as f32, uv.y as f32)).collect();
                let mesh = Mesh { positions: positions.to_vec(), uvs, triangles: vec![[0, 1, 2]], ..Mesh::default() };
                builder.mesh(0, "triangle", mesh, DAffine3::IDENTITY, surface);
            }
            Self::Sphere(centre, radius, radiance, image) => {
                let known = shared.iter().find(|(known, _)| known == radiance && image.is_none());
                let surface = known.map_or_else(|| surface(builder, radiance, image), |(_, surface)| *surface);
                shared.push((*radiance, surface));
                builder.sphere(0, "sphere", *centre, *radius, surface);
            }
            Self::Constant(radiance) => builder.background = Some(radiance.to_array()),
            Self::Dark(centre, radius) => {
                let matte = builder.matte([0.5; 3]);
                builder.sphere(0, "dark", *centre, *radius, matte);
            }
            Self::Environment(factor, image, axes) => {
                builder.background = Some(factor.to_array());
                builder.environment = Some((image.add(builder), *axes));
            }
        }
    }

    /// Irradiance at p on a surface of normal n, by the midpoint rule.
    fn irradiance(&self, p: DVec3, n: DVec3) -> DVec3 {
        const SIDE: usize = 600;
        let unit = |index: usize| (index as f64 + 0.5) / SIDE as f64;
        let cells = (0..SIDE * SIDE).map(|index| (unit(index % SIDE), unit(index / SIDE)));
        let patch = |at: DVec3, normal: DVec3, area: f64, radiance: DVec3| {
            let d = at - p;
            let wi = d.normalize();
            radiance * (wi.dot(n).max(0.0) * (-wi.dot(normal)).max(0.0) * area / d.length_squared())
        };
        let cell = 1.0 / (SIDE * SIDE) as f64;
        match self {
            Self::Triangle([a, b, c], uvs, radiance, image) => {
                let scaled = (*b - *a).cross(*c - *a);
                let (normal, area) = (scaled.normalize(), 0.5 * scaled.length());
                cells
                    .map(|(u, v)| {
                        // The unit square onto the triangle: (u, v) to (1 - v) u, v, stretched by 2 (1 - v).
                        let (s, t) = (u * (1.0 - v), v);
                        let factor = image
                            .as_ref()
                            .map_or(DVec3::ONE, |image| image.at(uvs[0] * (1.0 - s - t) + uvs[1] * s + uvs[2] * t));
                        let at = *a * (1.0 - s - t) + *b * s + *c * t;
                        patch(at, normal, area * 2.0 * (1.0 - v) * cell, *radiance * factor)
                    })
                    .sum()
            }
            // Whole above the horizon: pi L (r / d)^2 cos.
            Self::Sphere(centre, radius, radiance, None) if *radius > 0.0 => {
                let d = *centre - p;
                assert!(d.dot(n) > *radius, "a sphere that the horizon cuts has another formula");
                *radiance * (PI * radius * radius / d.length_squared() * d.normalize().dot(n))
            }
            Self::Sphere(centre, radius, radiance, image) => cells
                .map(|(u, v)| {
                    let (phi, z) = (TAU * u, 1.0 - 2.0 * v);
                    let outward = DVec3::new((1.0 - z * z).sqrt() * phi.cos(), (1.0 - z * z).sqrt() * phi.sin(), z);
                    let factor = image.as_ref().map_or(DVec3::ONE, |image| image.at(DVec2::new(u, z.acos() / PI)));
                    let at = *centre + outward * radius.abs();
                    patch(at, outward * radius.signum(), 4.0 * PI * radius * radius * cell, *radiance * factor)
                })
                .sum(),
            Self::Constant(radiance) => *radiance * PI,
            Self::Dark(..) => DVec3::ZERO,
            Self::Environment(factor, image, axes) => cells
                .map(|(u, v)| {
                    let (phi, theta) = (TAU * u, PI * v);
                    let d = DVec3::new(phi.sin() * theta.sin(), theta.cos(), -phi.cos() * theta.sin());
                    let solid_angle = 2.0 * PI * PI * theta.sin() * cell;
                    *factor * image.at(DVec2::new(u, v)) * ((*axes * d).dot(n).max(0.0) * solid_angle)
                })
                .sum(),
        }
    }
}

/// Emitters seen from a point.
struct Case {
    name: &'static str,
    emitters: Vec<Emitter>,
    point: DVec3,
    normal: DVec3,
    /// Around what, and how far, light comes from.
    axis: DVec3,
    reach: f64,
}

fn triangle(a: DVec3, b: DVec3, c: DVec3) -> Emitter {
    Emitter::Triangle([a, b, c], UVS, DVec3::new(1.0, 2.0, 0.5), None)
}

/// Two triangles, normal (b - a) x (d - a).
fn quad(a: DVec3, b: DVec3, d: DVec3) -> Vec<Emitter> {
    vec![triangle(a, b, b + d - a), triangle(a, b + d - a, d)]
}

fn cases() -> Vec<Case> {
    let v = DVec3::new;
    let case = |name, emitters, point, normal: DVec3, axis, reach| Case {
        name,
        emitters,
        point,
        normal: normal.normalize(),
        axis,
        reach,
    };
    let radiance = DVec3::new(1.0, 2.0, 0.5);
    let waves = Image::waves(4, 3);
    // One texel in a hundred sheds most of the light; some shed none.
    let mut peaks = Image { clamp: true, ..Image::waves(16, 8) };
    for (index, texel) in peaks.texels.iter_mut().enumerate() {
        let factor = match index {
            37 => 3000.0,
            90 => 500.0,
            _ if index % 16 < 4 => 0.0,
            _ => 1.0,
        };
        *texel = texel.map(|value| value * factor);
    }
    let turn = DMat3::from_rotation_y(0.7) * DMat3::from_rotation_x(0.4);
    let textured = Emitter::Triangle(
        [v(-1.0, -1.0, 2.0), v(-1.0, 1.5, 2.2), v(2.0, 0.0, 1.8)],
        UVS,
        radiance,
        Some(waves.clone()),
    );
    vec![
        case(
            "triangle",
            vec![triangle(v(-1.0, -1.0, 2.0), v(-1.0, 1.5, 2.2), v(2.0, 0.0, 1.8))],
            v(0.2, 0.1, 0.0),
            DVec3::Z,
            v(0.05, 0.1, 1.0),
            1.0,
        ),
        case(
            "close triangle",
            vec![triangle(v(-1.0, -1.0, 0.3), v(-1.0, 1.5, 0.3), v(2.0, 0.0, 0.5))],
            v(0.2, 0.1, 0.0),
            DVec3::Z,
            v(0.05, 0.1, 1.0),
            1.7,
        ),
        case(
            "quad",
            quad(v(-1.0, -1.0, 2.0), v(-1.0, 1.0, 2.0), v(1.0, -1.0, 2.0)),
            v(0.3, 0.2, 0.1),
            v(0.2, 0.0, 1.0),
            v(-0.2, 0.1, 1.0),
            0.9,
        ),
        case(
            "close quad",
            quad(v(-1.0, -1.0, 0.25), v(-1.0, 1.0, 0.25), v(1.0, -1.0, 0.25)),
            v(0.3, 0.2, 0.0),
            v(0.2, 0.0, 1.0),
            v(-0.2, 0.1, 1.0),
            1.8,
        ),
        case(
            "far quad",
            quad(v(-1.0, -1.0, 300.0), v(-1.0, 1.0, 300.0), v(1.0, -1.0, 300.0)),
            v(20.0, 40.0, 3.0),
            v(0.1, -0.1, 1.0),
            v(-20.0, -40.0, 297.0),
            0.008,
        ),
        case("textured triangle", vec![textured], v(0.2, 0.1, 0.0), v(0.1, 0.3, 1.0), v(0.05, 0.1, 1.0), 1.0),
        case(
            "triangle, small in its scene",
            vec![
                triangle(v(-1.0, -1.0, 2.0), v(-1.0, 1.5, 2.2), v(2.0, 0.0, 1.8)),
                Emitter::Dark(v(0.0, 0.0, -60.0), 50.0),
            ],
            v(0.2, 0.1, 0.0),
            DVec3::Z,
            v(0.05, 0.1, 1.0),
            1.0,
        ),
        case(
            "textured quad, small in its scene",
            vec![
                Emitter::Triangle(
                    [v(-1.0, -1.0, 1.0), v(-1.0, 1.0, 1.0), v(1.0, -1.0, 1.0)],
                    UVS,
                    radiance,
                    Some(waves.clone()),
                ),
                triangle(v(-1.0, 1.0, 1.0), v(1.0, 1.0, 1.0), v(1.0, -1.0, 1.0)),
                Emitter::Dark(v(0.0, 0.0, -60.0), 50.0),
            ],
            v(0.2, 0.1, 0.0),
            DVec3::Z,
            v(0.05, 0.1, 1.0),
            1.2,
        ),
        case(
            "sphere",
            vec![Emitter::Sphere(v(1.0, 2.0, 3.0), 0.7, radiance, None)],
            v(0.3, 0.0, 0.4),
            v(0.5, 0.3, 1.0),
            v(0.75, 2.0, 2.6),
            0.3,
        ),
        case(
            "sphere almost touched",
            vec![Emitter::Sphere(v(0.0, 0.0, 2.0), 1.0, radiance, None)],
            v(0.0, 0.1, 0.95),
            DVec3::Z,
            v(0.1, 0.0, 1.0),
            1.6,
        ),
        case(
            "far sphere",
            vec![Emitter::Sphere(v(1.0, 2.0, 900.0), 0.7, radiance, None)],
            v(0.3, 0.0, 0.4),
            DVec3::Z,
            v(0.75, 2.05, 899.6),
            0.001,
        ),
        case(
            "inside of a sphere",
            vec![Emitter::Sphere(v(1.0, 2.0, 3.0), -2.0, radiance, None)],
            v(0.3, 1.0, 3.4),
            v(0.5, 0.3, 1.0),
            v(0.1, 0.2, 1.0),
            PI,
        ),
        case(
            "textured sphere",
            vec![Emitter::Sphere(v(1.0, 2.0, 3.0), 0.9, radiance, Some(waves.clone()))],
            v(0.3, 0.0, 0.4),
            v(0.5, 0.3, 1.0),
            v(0.75, 2.0, 2.6),
            0.4,
        ),
        case(
            "inside of a textured sphere",
            vec![Emitter::Sphere(v(1.0, 2.0, 3.0), -2.0, radiance, Some(waves))],
            v(0.3, 1.0, 3.4),
            v(0.5, 0.3, 1.0),
            v(0.1, 0.2, 1.0),
            PI,
        ),
        case("constant", vec![Emitter::Constant(radiance)], DVec3::ZERO, v(0.5, 0.3, 1.0), DVec3::Z, PI),
        case(
            "environment",
            vec![Emitter::Environment(radiance, peaks, turn)],
            DVec3::ZERO,
            v(0.5, 0.3, 1.0),
            DVec3::Y,
            PI,
        ),
        case(
            "several",
            {
                let mut all = quad(v(-1.0, -1.0, 2.0), v(-1.0, 1.0, 2.0), v(1.0, -1.0, 2.0));
                all.push(Emitter::Sphere(v(4.0, 0.0, 2.0), 0.7, radiance, None));
                all.push(Emitter::Sphere(v(-4.0, 1.0, 1.9), 1.5, radiance, None));
                all.push(triangle(v(0.0, -3.0, 1.0), v(2.0, -3.0, 1.0), v(0.0, -4.0, 3.0)));
                all
            },
            DVec3::ZERO,
            DVec3::Z,
            v(0.1, 0.2, 1.0),
            PI,
        ),
    ]
}

fn scene_of(emitters: &[Emitter]) -> Scene {
    let mut builder = SceneBuilder::new("lights");
    let mut shared = Vec::new();
    emitters.iter().for_each(|emitter| emitter.add(&mut builder, &mut shared));
    builder.finish().unwrap()
}

struct Bench {
    probe: Probe,
    origin: DVec3,
}

impl Bench {
    /// Light samples that find all light by themselves.
    fn new(gpu: &Gpu, scene: &Scene) -> Self {
        Self::of_technique(gpu, scene, "light")
    }

    /// Light samples as a technique takes them: with MIS compensation the darker part of an environment is left to BSDF samples.
    fn of_technique(gpu: &Gpu, scene: &Scene, technique: &str) -> Self {
        let probe = Probe::new(gpu, scene, &settings(scene, technique, Backend::Bvh), "test/light").unwrap();
        Self { probe, origin: scene.origin }
    }

    fn sample(&self, point: DVec3, numbers: &[[f32; 4]]) -> Vec<LightAnswer> {
        let point = (point - self.origin).as_vec3().to_array();
        let queries: Vec<_> =
            numbers.iter().map(|u| LightQuery { point, direction: [0.0, 0.0, 1.0], normal: [0.0; 3], u: *u }).collect();
        self.probe.run(&queries).unwrap()
    }

    fn look(&self, point: DVec3, directions: impl Iterator<Item = DVec3>) -> Vec<LightAnswer> {
        let point = (point - self.origin).as_vec3().to_array();
        let ask = |direction: DVec3| LightQuery {
            point,
            direction: direction.as_vec3().into(),
            normal: [0.0; 3],
            u: [0.5; 4],
        };
        self.probe.run(&directions.map(ask).collect::<Vec<_>>()).unwrap()
    }
}

fn relative(a: f64, b: f64) -> f64 {
    (a - b).abs() / a.abs().max(b.abs()).max(1e-30)
}

/// The density of a sample is the one that is evaluated where a ray in its direction ends, and its weight times that is the
/// radiance that the ray finds.
#[test]
fn light_samples_are_what_rays_find() {
    with_gpu(|gpu| {
        let samples = numbers(gpu, 20_000, 5);
        let mut findings = Findings::default();
        for case in cases() {
            let bench = Bench::new(gpu, &scene_of(&case.emitters));
            let (mut worst, mut seen, mut missed) = ([0.0f64; 2], 0, 0);
            for answer in bench.sample(case.point, &samples) {
                if answer.pdf_w == 0.0 || answer.visible == 0 {
                    continue; // it faces away, or another light stands before it
                }
                seen += 1;
                let density = relative(f64::from(answer.pdf_w), f64::from(answer.found_pdf_w));
                let radiance = (vector(answer.weight) * f64::from(answer.pdf_w) - vector(answer.found)).length()
                    / vector(answer.found).length().max(1e-30);
                if density < 1e-2 {
                    worst = [worst[0].max(density), worst[1].max(radiance)];
                } else {
                    missed += 1; // rays to the very edge pass it, and texels of an environment end somewhere
                }
            }
            println!(
                "{}: {seen} samples, {missed} missed, density off by {:.1e}, radiance by {:.1e}",
                case.name, worst[0], worst[1]
            );
            findings.check(seen > 5000, || format!("{}: only {seen} of {} seen", case.name, samples.len()));
            findings.check(missed * 1000 <= seen, || format!("{}: {missed} of {seen} missed", case.name));
            findings.check(worst[0] < 1e-3, || format!("{}: density off by {:.1e}", case.name, worst[0]));
            findings.check(worst[1] < 1e-3, || format!("{}: radiance off by {:.1e}", case.name, worst[1]));
        }
    });
}

/// A lamp that is a millionth of all power, behind which a bright one stands that nobody sees: the few numbers that choose it place samples all
/// over it, not at as few places from one edge on.
#[test]
fn dim_lamps_are_sampled_all_over() {
    let sphere = |z: f64, radiance: f64| Emitter::Sphere(DVec3::new(0.0, 0.0, z), 0.5, DVec3::splat(radiance), None);
    let scene = scene_of(&[sphere(2.0, 1.0), sphere(-60.0, 1e6)]);
    // Each lamp is an entry of two: the dim one keeps the first 2e-6 of its entry.
    let chosen = |first: u32| (first..first + 64).map(|z| z as f32 / 16_777_216.0);
    let all = [0, 1 << 23].into_iter().flat_map(chosen);
    let numbers: Vec<[f32; 4]> =
        all.flat_map(|z| (0..64).map(move |y| [0.5, (f32::from(y as u8) + 0.5) / 64.0, z, 0.25])).collect();
    with_gpu(|gpu| {
        let answers = Bench::new(gpu, &scene).sample(DVec3::ZERO, &numbers);
        let least = (1.0 - 0.25f64.powi(2)).sqrt(); // cosine at the lamp's edge
        let places: Vec<f64> = answers
            .iter()
            .filter(|answer| answer.wi[2] > 0.0)
            .map(|answer| (1.0 - f64::from(answer.wi[2])) / (1.0 - least))
            .collect();
        let mean = places.iter().sum::<f64>() / places.len() as f64;
        println!("{} of {} numbers choose the dim lamp, and fall at {mean:.4} of it", places.len(), numbers.len());
        assert!((16 * 64..=18 * 64).contains(&places.len()), "{} numbers choose the dim lamp", places.len());
        assert!((mean - 0.5).abs() < 0.01, "its samples fall at {mean} of it in the mean");
    });
}

/// Samples fall where the density says, and it integrates to one with the samples that face away.
#[test]
fn light_samples_follow_their_density() {
    const SAMPLES: usize = 30_000;
    with_gpu(|gpu| {
        let samples = numbers(gpu, SAMPLES, 6);
        let mut findings = Findings::default();
        let all = cases();
        let plain = all.iter().map(|case| (case, "light"));
        let is_environment = |case: &&Case| matches!(case.emitters[..], [Emitter::Environment(..)]);
        for (case, technique) in plain.chain(all.iter().filter(is_environment).map(|case| (case, "path"))) {
            let bench = Bench::of_technique(gpu, &scene_of(&case.emitters), technique);
            // Cells: rings around what is seen; of an image, halves of its texels, where its density has its steps.
            type Cell = Box<dyn Fn(DVec3) -> Option<usize>>;
            let (points, count, cell): (Vec<(DVec3, f64, usize)>, usize, Cell) =
                if let [Emitter::Environment(_, image, axes)] = &case.emitters[..] {
                    let (columns, rows, fine) = (2 * image.width, 2 * image.height, 12);
                    let mut points = Vec::new();
                    for y in 0..rows * fine {
                        for x in 0..columns * fine {
                            let phi = TAU * (x as f64 + 0.5) / (columns * fine) as f64;
                            let theta = PI * (y as f64 + 0.5) / (rows * fine) as f64;
                            let d = DVec3::new(phi.sin() * theta.sin(), theta.cos(), -phi.cos() * theta.sin());
                            let solid_angle = 2.0 * PI * PI * theta.sin() / (columns * rows * fine * fine) as f64;
                            points.push((*axes * d, solid_angle, y / fine * columns + x / fine));
                        }
                    }
                    let back = axes.transpose();
                    let cell = move |w: DVec3| {
                        let d = back * w;
                        let u = d.x.atan2(-d.z).rem_euclid(TAU) / TAU;
                        let v = d.y.clamp(-1.0, 1.0).acos() / PI;
                        let (x, y) = ((u * columns as f64) as usize, (v * rows as f64) as usize);
                        Some(y.min(rows - 1) * columns + x.min(columns - 1))
                    };
                    (points, columns * rows, Box::new(cell))
                } else {
                    let rings = Rings::new(case.axis, 0.1 * case.reach, case.reach, 24, 24);
                    (rings.points(14), rings.cells(), Box::new(move |w| rings.cell(w)))
                };
            let mut expected = vec![0.0; count];
            let looks = bench.look(case.point, points.iter().map(|(w, _, _)| *w));
            for (answer, (_, solid_angle, cell)) in looks.iter().zip(&points) {
                expected[*cell] += f64::from(answer.asked_pdf_w) * solid_angle * SAMPLES as f64;
            }
            let mut observed = vec![0.0; count];
            let mut others = 0.0;
            for answer in bench.sample(case.point, &samples) {
                if answer.pdf_w == 0.0 || answer.visible == 0 {
                    others += 1.0;
                } else if let Some(cell) = cell(vector(answer.wi)) {
                    observed[cell] += 1.0;
                } else {
                    findings.check(false, || format!("{}: {:?} lies beyond the cells", case.name, answer.wi));
                }
            }
            let z = chi_square_z(&observed, &expected);
            let share = (expected.iter().sum::<f64>() + others) / SAMPLES as f64;
            println!("{}: chi-square z {z:+.2}, density {share:.4} (with {others} unseen)", case.name);
            findings.check(z < 3.3, || format!("{}: chi-square z {z:.2}", case.name));
            findings
                .check((share - 1.0).abs() < 5e-3, || format!("{}: the density integrates to {share:.4}", case.name));
        }
    });
}

/// Mean irradiance of light samples on a surface of normal n, and its standard deviation.
fn irradiance(bench: &Bench, point: DVec3, normal: DVec3, numbers: &[[f32; 4]]) -> (DVec3, f64) {
    let (mut sum, mut squares) = (DVec3::ZERO, 0.0);
    for answer in bench.sample(point, numbers).iter().filter(|answer| answer.visible != 0) {
        let value = vector(answer.weight) * vector(answer.wi).dot(normal).max(0.0);
        sum += value;
        squares += value.y * value.y;
    }
    let n = numbers.len() as f64;
    (sum / n, ((squares / n - (sum.y / n).powi(2)).max(0.0) / n).sqrt())
}

/// Irradiance by sampling against integration on the host.
#[test]
fn irradiance_is_that_of_the_emitters() {
    with_gpu(|gpu| {
        let samples = spread::<4>(1 << 16);
        let mut findings = Findings::default();
        for case in cases() {
            let bench = Bench::new(gpu, &scene_of(&case.emitters));
            let expected: DVec3 = case.emitters.iter().map(|emitter| emitter.irradiance(case.point, case.normal)).sum();
            let (found, sigma) = irradiance(&bench, case.point, case.normal, &samples);
            let off = (found - expected).abs().max_element() / expected.max_element();
            let bound = (1e-3f64).max(3.0 * sigma / expected.y);
            println!("{}: {found:.5} against {expected:.5}, off by {off:.1e}, bound {bound:.1e}", case.name);
            findings.check(off < bound, || format!("{}: {found} against {expected}", case.name));
        }
    });
}

/// Irradiance of lamps, in closed form.
fn lamp_irradiance(lamp: &Lamp, image: &Image, p: DVec3, n: DVec3) -> DVec3 {
    let towards = |position: DVec3| {
        let d = position - p;
        (d.normalize(), d.length_squared())
    };
    match *lamp {
        Lamp::Point { position, intensity } => {
            let (wi, d2) = towards(position);
            DVec3::from(intensity) * wi.dot(n).max(0.0) / d2
        }
        Lamp::Spot { position, direction, intensity, cutoff, beam_width, texture, .. } => {
            let (wi, d2) = towards(position);
            let angle = (-wi).dot(direction).clamp(-1.0, 1.0).acos();
            let falloff = ((cutoff - angle) / (cutoff - beam_width)).clamp(0.0, 1.0);
            let factor = texture.map_or(DVec3::ONE, |(_, axes)| {
                let local = axes.transpose() * -wi;
                image.at(DVec2::new(local.x, local.y) / local.z / cutoff.tan() * 0.5 + 0.5)
            });
            DVec3::from(intensity) * factor * (falloff * wi.dot(n).max(0.0) / d2)
        }
        Lamp::Projector { position, axes, irradiance, tangents, .. } => {
            let (wi, d2) = towards(position);
            let local = axes.transpose() * -wi;
            let uv = 0.5 - DVec2::new(local.x / tangents[0], local.y / tangents[1]) / local.z * 0.5;
            let lit = local.z > 0.0 && uv.min_element() >= 0.0 && uv.max_element() <= 1.0;
            // On the plane at distance 1, E = I cos^3.
            let intensity = DVec3::from(irradiance) * image.at(uv) / local.z.powi(3);
            if lit { intensity * (wi.dot(n).max(0.0) / d2) } else { DVec3::ZERO }
        }
        Lamp::Directional { direction, irradiance } => DVec3::from(irradiance) * (-direction).dot(n).max(0.0),
    }
}

#[test]
fn lamps_shed_what_their_formulas_say() {
    let v = DVec3::new;
    let image = Image::waves(5, 4);
    let axes = DMat3::from_rotation_y(0.3) * DMat3::from_rotation_x(PI - 0.2);
    let position = v(0.3, 1.0, 4.0);
    let lamps = |texture: u32| -> Vec<(&'static str, Vec<Lamp>)> {
        let spot = |texture| Lamp::Spot {
            position,
            direction: axes.z_axis,
            intensity: [3.0, 2.0, 1.0],
            cutoff: 0.8,
            beam_width: 0.3,
            falloff: Falloff::Angle,
            texture,
        };
        let point = Lamp::Point { position: v(1.0, 2.0, 2.0), intensity: [1.0, 5.0, 2.0] };
        let sun = Lamp::Directional { direction: v(0.3, -0.2, -1.0).normalize(), irradiance: [0.5, 1.0, 0.2] };
        let projector = Lamp::Projector { position, axes, texture, irradiance: [2.0, 1.0, 3.0], tangents: [0.7, 0.5] };
        vec![
            ("point", vec![point]),
            ("spot", vec![spot(None)]),
            ("directional", vec![sun]),
            ("projector", vec![projector]),
            ("textured spot", vec![spot(Some((texture, axes)))]),
            ("all", vec![point, spot(None), sun, projector, spot(Some((texture, axes)))]),
        ]
    };
    let points =
        [v(0.0, 0.0, 0.0), v(0.7, -0.3, 1.0), v(-1.0, 1.5, 0.5), v(1.3, 0.2, 0.7), v(2.5, 2.0, -1.0), v(0.4, 0.9, 3.0)];
    with_gpu(|gpu| {
        let mut findings = Findings::default();
        let samples = spread::<4>(1 << 14);
        for index in 0..lamps(0).len() {
            let mut builder = SceneBuilder::new("lamps");
            let texture = image.add(&mut builder);
            let (name, lamps) = lamps(texture).swap_remove(index);
            builder.lamps = lamps.clone();
            let matte = builder.matte([0.5; 3]);
            builder.sphere(0, "somewhere", v(0.0, 0.0, -9.0), 1.0, matte);
            let bench = Bench::new(gpu, &builder.finish().unwrap());
            let mut lit = 0;
            for point in points {
                let normal = v(0.1, 0.2, 1.0).normalize();
                let expected: DVec3 = lamps.iter().map(|lamp| lamp_irradiance(lamp, &image, point, normal)).sum();
                let (found, _) = irradiance(&bench, point, normal, &samples);
                let off = (found - expected).abs().max_element() / expected.max_element().max(1e-9);
                let bound = if lamps.len() == 1 { 5e-5 } else { 3e-3 };
                println!("{name}: {found:.6} against {expected:.6}, off by {off:.1e}");
                findings.check(off < bound, || format!("{name} at {point}: {found} against {expected}"));
                lit += usize::from(expected.max_element() > 0.0);
            }
            findings.check(lit >= 3, || format!("{name}: only {lit} points are lit"));
        }
    });
}

/// An environment shows in a direction what its image has there, to a few thousandths of a texel: inverse trigonometric functions of a driver
/// may be off by a hundredth.
#[test]
fn environments_show_what_lies_in_a_direction() {
    let image = Image { clamp: true, ..Image::waves(512, 256) };
    let mut builder = SceneBuilder::new("environment");
    builder.background = Some([1.0; 3]);
    builder.environment = Some((image.add(&mut builder), DMat3::IDENTITY));
    let matte = builder.matte([0.5; 3]);
    builder.sphere(0, "somewhere", DVec3::new(0.0, 0.0, -90.0), 0.1, matte);
    let scene = builder.finish().unwrap();
    let directions: Vec<DVec3> = spread::<4>(1 << 12)
        .iter()
        .map(|u| {
            let (z, turn) = (1.0 - 2.0 * f64::from(u[0]), TAU * f64::from(u[1]));
            let sine = (1.0 - z * z).sqrt();
            DVec3::new(sine * turn.cos(), z, sine * turn.sin()).as_vec3().as_dvec3()
        })
        .collect();
    with_gpu(|gpu| {
        let found = Bench::new(gpu, &scene).look(DVec3::ZERO, directions.iter().copied());
        let off = directions.iter().zip(&found).map(|(d, found)| {
            let across = d.x.atan2(-d.z) / TAU;
            let uv = DVec2::new(across - across.floor(), d.normalize().y.acos() / PI);
            // Neighbouring texels differ by up to 1.6.
            (vector(found.asked) - image.at(uv)).abs().max_element()
        });
        let worst = off.fold(0.0, f64::max);
        println!("environment: off by {worst:.1e}");
        assert!(worst < 3e-4, "off by {worst:.1e}");
    });
}

/// Of emitting triangles that lie on each other one stays, and one that is dropped takes neither of its sides from others.
#[test]
fn lights_on_each_other_are_one() {
    let [a, b, c] = [DVec3::ZERO, DVec3::X, DVec3::Y];
    let lights = |shapes: &[([DVec3; 3], bool)]| {
        let mut builder = SceneBuilder::new("lights");
        for (positions, emits_behind) in shapes {
            let emission = [1.0; 3];
            let surface =
                builder.surface(SurfaceDescription { emission, emits_behind: *emits_behind, ..Default::default() });
            let mesh = Mesh { positions: positions.to_vec(), triangles: vec![[0, 1, 2]], ..Mesh::default() };
            builder.mesh(0, "light", mesh, DAffine3::IDENTITY, surface);
        }
        let scene = builder.finish().unwrap();
        (scene.primitives.len(), scene.lights.len())
    };
    let (front, back) = ([a, b, c], [b, a, c]);
    assert_eq!(lights(&[(front, false), ([b, c, a], false)]), (1, 1));
    assert_eq!(lights(&[(front, false), (back, false)]), (2, 2));
    assert_eq!(lights(&[(front, true), (back, true)]), (1, 2));
    // The back of the second lies on the first; the third is the second's front, which nobody has.
    assert_eq!(lights(&[(back, false), (front, true), (front, false)]), (2, 2));
    // The front of the second lies on the first; the third is the second's back.
    assert_eq!(lights(&[(front, false), (front, true), (back, false)]), (2, 2));
}

/// What is rendered where neither the user nor the file names a technique: lights without extent make caustics of what reflects narrowly, and path
/// tracing would leave those out or show them as rare, bright samples.
#[test]
fn the_technique_by_default_finds_the_light() {
    let chosen = |light: &str, material: &str| {
        let scene = room::scene(&format!("{light}<shape type='sphere'>{material}</shape><shape type='rectangle'/>"));
        Technique::of_scene(&scene, None).unwrap().row.name
    };
    let point = "<emitter type='point'/>";
    let sky = "<emitter type='constant'/>";
    let (glass, metal) =
        ("<bsdf type='dielectric'/>", "<bsdf type='roughconductor'><float name='alpha' value='0.01'/></bsdf>");
    assert_eq!(chosen(point, ""), "path");
    assert_eq!(chosen(point, glass), "bdpt");
    assert_eq!(chosen(point, metal), "bdpt");
    assert_eq!(chosen(sky, glass), "path");
    let room = lumbre::scene::load(&scene_path("gltf_room/room.gltf"), &Default::default()).unwrap();
    assert_eq!(Technique::of_scene(&room, None).unwrap().row.name, "bdpt");
    let asked = Technique::parse("vcm").unwrap();
    assert_eq!(Technique::of_scene(&room, Some(asked)).unwrap().row.name, "vcm");
    assert_eq!(Technique::of_scene(&canon("cornell.xml", &[]), None).unwrap().row.name, "path");
}
