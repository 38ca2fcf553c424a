//! Every BSDF, through the shaders' own functions.

use crate::common::sampling::{Findings, Rings, chi_square_z, direction, numbers, spread, with_materials};
use crate::common::{settings, with_gpu};
use glam::DVec3;
use lumbre::gpu::Gpu;
use lumbre::layout::backend::Backend;
use lumbre::layout::{
    BsdfAnswer, BsdfQuery, Layered, MASKING_CORRELATED, MATERIAL_PRINCIPLED_THIN, Material, Principled,
};
use lumbre::render::Probe;
use lumbre::scene::material::{self, Detail, MaterialDescription, plain_layers};
use lumbre::verify::families::{FAMILIES, Family, is_thin};
use lumbre::verify::scattering::{self, Asked, both_ways, vector};

const WHITE: [f32; 3] = [1.0; 3];
/// A mirror that reflects everything: index 0 + i.
const PERFECT: ([f32; 3], [f32; 3]) = ([0.0; 3], [1.0; 3]);

/// A material to test, with what is known of it.
struct Case {
    name: &'static str,
    material: MaterialDescription,
    /// Roughness (alpha) of its narrowest lobe.
    narrowest: f64,
    /// Light that passes goes straight on, but for roughness.
    thin: bool,
    /// It neither absorbs nor, in theory, loses energy to multiple scattering.
    lossless: bool,
    /// What its albedo stays below: 1.002, or more where the published model is known to give back more than it gets.
    energy: f64,
}

impl Case {
    fn transmits(&self) -> bool {
        self.material.transmits()
    }

    /// Its lobes are deltas, all of them.
    fn is_delta(&self) -> bool {
        ["conductor", "dielectric", "thin dielectric"].contains(&self.name)
    }

    /// Microfacets of a thin principled sheet let pass what they would not the other way round.
    fn is_reciprocal(&self) -> bool {
        let Detail::Principled(parameters) = &self.material.detail else { return true };
        self.material.record.kind != MATERIAL_PRINCIPLED_THIN || parameters.spec_trans == 0.0
    }

    fn thin(self) -> Self {
        Self { thin: true, ..self }
    }

    fn lossless(self) -> Self {
        Self { lossless: true, ..self }
    }

    fn energy(self, energy: f64) -> Self {
        Self { energy, ..self }
    }

    /// Outgoing directions: from grazing to normal, and from below where the material transmits.
    fn outgoing(&self) -> Vec<[f32; 3]> {
        let above = [0.15, 0.5, 0.95].map(|cos| direction(cos, 0.7 + cos));
        let below = above.map(|[x, y, z]| [x, y, -z]);
        if self.transmits() { above.into_iter().chain(below).collect() } else { above.to_vec() }
    }
}

fn case(name: &'static str, narrowest: f64, material: impl Into<MaterialDescription>) -> Case {
    Case { name, material: material.into(), narrowest, thin: false, lossless: false, energy: 1.002 }
}

/// A rough metal or rough glass that gets back what it loses to multiple scattering.
fn compensated(name: &'static str, narrowest: f64, material: Material, beckmann: bool) -> Case {
    let made = MaterialDescription::from(material).compensated();
    case(name, narrowest, if beckmann { made.beckmann() } else { made })
}

fn flagged(material: Material, flag: u32) -> Material {
    Material { flags: material.flags | flag, ..material }
}

fn principled(base: [f32; 3], roughness: f32, parameters: Principled) -> MaterialDescription {
    material::principled(base, roughness, 1.5, parameters)
}

fn thin(base: [f32; 3], roughness: f32, parameters: Principled) -> MaterialDescription {
    material::principled_thin(base, roughness, 1.5, parameters)
}

fn layered(base: [f32; 3], roughness: f32, layers: Layered) -> MaterialDescription {
    material::layered(base, roughness, 1.5, layers)
}

fn cases() -> Vec<Case> {
    let (eta, k) = ([0.2, 0.92, 1.1], [3.9, 2.45, 2.14]);
    let colour = [0.9, 0.5, 0.2];
    let metal = |alpha| material::conductor(eta, k, WHITE, Some(alpha));
    let glass = |eta, alpha: f32| material::dielectric(eta, WHITE, WHITE, Some([alpha; 2]));
    let mirror = |alpha| material::conductor(PERFECT.0, PERFECT.1, WHITE, Some(alpha));
    let none = Principled::default();
    let plain = plain_layers(0.0);
    vec![
        case("diffuse", 1.0, material::diffuse([0.2, 0.5, 0.8])),
        case("conductor", 1.0, material::conductor(eta, k, WHITE, None)),
        case("rough conductor 0.001", 0.001, metal([0.001; 2])),
        case("rough conductor 0.1", 0.1, metal([0.1; 2])),
        case("rough conductor 0.5, correlated", 0.5, flagged(metal([0.5; 2]), MASKING_CORRELATED)),
        case("rough conductor 0.2 x 0.6", 0.2, metal([0.2, 0.6])),
        case("rough conductor 1.0", 1.0, metal([1.0; 2])),
        case("Beckmann conductor 0.1", 0.1, MaterialDescription::from(metal([0.1; 2])).beckmann()),
        case("Beckmann conductor 0.6 x 0.2", 0.2, MaterialDescription::from(metal([0.6, 0.2])).beckmann()),
        case("dielectric", 1.0, material::dielectric(1.5, WHITE, WHITE, None)).lossless(),
        case("thin dielectric", 1.0, material::thin_dielectric(1.5, WHITE, WHITE)).thin().lossless(),
        case("rough dielectric 0.01", 0.01, glass(1.5, 0.01)),
        case("rough dielectric 0.1", 0.1, glass(1.5, 0.1)),
        case("rough dielectric 0.4", 0.4, glass(1.5, 0.4)),
        case("rough dielectric 0.5 x 0.1", 0.1, material::dielectric(1.5, WHITE, WHITE, Some([0.5, 0.1]))),
        case("rough dielectric 1.0, dense", 1.0, glass(2.4, 1.0)),
        case("rough dielectric 0.3, thin", 0.3, glass(1.0 / 1.33, 0.3)),
        case("Beckmann dielectric 0.2", 0.2, MaterialDescription::from(glass(1.5, 0.2)).beckmann()),
        compensated("compensated metal 0.3", 0.3, metal([0.3; 2]), false),
        compensated("compensated metal 0.2 x 0.6", 0.2, metal([0.2, 0.6]), false),
        compensated("compensated metal 1.0, correlated", 1.0, flagged(metal([1.0; 2]), MASKING_CORRELATED), false),
        compensated("compensated Beckmann metal 0.7", 0.7, metal([0.7; 2]), true),
        compensated("compensated mirror 0.05", 0.05, mirror([0.05; 2]), false).lossless(),
        compensated("compensated mirror 0.9", 0.9, mirror([0.9; 2]), false).lossless(),
        compensated("compensated mirror 0.6 x 0.2", 0.2, mirror([0.6, 0.2]), false).lossless(),
        compensated("compensated Beckmann mirror 0.8 x 0.3", 0.3, mirror([0.8, 0.3]), true).lossless(),
        compensated("compensated glass 0.2", 0.2, glass(1.5, 0.2), false).lossless(),
        compensated("compensated glass 0.8, dense", 0.8, glass(2.5, 0.8), false).lossless(),
        compensated("compensated glass 0.5, thin", 0.5, glass(1.0 / 1.33, 0.5), false).lossless(),
        compensated(
            "compensated glass 0.7 x 0.3",
            0.3,
            material::dielectric(1.5, WHITE, WHITE, Some([0.7, 0.3])),
            false,
        )
        .lossless(),
        compensated("compensated Beckmann glass 0.6", 0.6, glass(1.5, 0.6), true).lossless(),
        compensated(
            "compensated glass, tinted",
            0.4,
            material::dielectric(1.5, [0.9, 0.6, 0.3], [0.3, 0.6, 0.9], Some([0.4; 2])),
            false,
        ),
        case("plastic", 1.0, material::plastic(1.5, WHITE, WHITE, false, None)).lossless(),
        case("plastic, nonlinear", 1.0, material::plastic(1.9, colour, [0.5; 3], true, None)),
        case("plastic without a highlight", 1.0, material::plastic(1.5, colour, [0.0; 3], false, None)),
        case("rough plastic 0.1", 0.1, material::plastic(1.5, WHITE, WHITE, false, Some(0.1))),
        case("rough plastic 0.4, nonlinear", 0.4, material::plastic(1.9, colour, WHITE, true, Some(0.4))),
        case("Beckmann plastic 0.2", 0.2, material::plastic(1.5, colour, WHITE, false, Some(0.2)).beckmann()),
        // Burley's diffuse lobe is independent of the specular one, which adds to it: white, 1.25 at most.
        case("principled, plain", 0.25, principled(WHITE, 0.5, none)).energy(1.21),
        case("principled, metallic", 0.16, principled(WHITE, 0.4, Principled { metallic: 1.0, ..none })),
        case(
            "principled, anisotropic",
            0.07,
            principled(colour, 0.5, Principled { metallic: 0.7, anisotropic: 0.9, ..none }),
        ),
        case(
            "principled, clear coat",
            0.03,
            principled(colour, 0.6, Principled { clearcoat: 1.0, clearcoat_gloss: 0.7, ..none }),
        )
        .energy(1.14),
        case(
            "principled, glossy coat",
            0.001,
            principled(colour, 0.6, Principled { clearcoat: 1.0, clearcoat_gloss: 1.0, ..none }),
        )
        .energy(1.14),
        case("principled, sheen", 0.5, principled(colour, 0.7, Principled { sheen: 1.0, sheen_tint: 0.5, ..none }))
            .energy(1.3),
        case("principled, glass", 0.16, principled(WHITE, 0.4, Principled { spec_trans: 1.0, ..none })),
        case(
            "principled, half glass",
            0.25,
            principled(colour, 0.5, Principled { spec_trans: 0.5, metallic: 0.2, ..none }),
        ),
        case("principled, flat", 0.36, principled(WHITE, 0.6, Principled { flatness: 1.0, ..none })).energy(1.45),
        case("principled, tinted", 0.25, principled(colour, 0.5, Principled { spec_tint: 1.0, ..none })).energy(1.12),
        case("principled thin, glass", 0.09, thin(WHITE, 0.5, Principled { spec_trans: 1.0, ..none })).thin(),
        case(
            "principled thin, sheet",
            0.05,
            thin(
                colour,
                0.4,
                Principled { spec_trans: 0.4, diff_trans: 0.7, anisotropic: 0.5, spec_tint: 0.6, ..none },
            ),
        )
        .thin(),
        case(
            "principled thin, cloth",
            0.2,
            thin(colour, 0.7, Principled { diff_trans: 1.2, sheen: 0.8, sheen_tint: 0.5, flatness: 0.5, ..none }),
        )
        .thin()
        .energy(1.04),
        // glTF weights the diffuse lobe by Fresnel's factor of the half vector, which towards grazing is less than what the
        // specular lobe takes.
        case("layered, dielectric", 0.16, layered(WHITE, 0.4, plain)).energy(1.24),
        case("layered, metal", 0.09, layered(WHITE, 0.3, plain_layers(1.0))),
        case("layered, half metal", 0.25, layered(colour, 0.5, plain_layers(0.5))),
        case(
            "layered, anisotropic",
            0.16,
            layered(colour, 0.4, Layered { anisotropy: 0.7, anisotropy_direction: [0.6, 0.8], ..plain_layers(0.6) }),
        ),
        case(
            "layered, iridescent",
            0.16,
            layered(
                colour,
                0.4,
                Layered { iridescence: 0.9, iridescence_eta: 1.8, iridescence_thickness: 300.0, ..plain_layers(0.5) },
            ),
        ),
        case(
            "layered, diffuse transmission",
            0.16,
            layered(
                colour,
                0.4,
                Layered { diffuse_transmission: 0.6, diffuse_transmission_colour: [0.2, 0.9, 0.4], ..plain },
            ),
        )
        .thin(),
        case(
            "layered, diffuse and specular transmission",
            0.16,
            layered(colour, 0.4, Layered { diffuse_transmission: 0.6, transmission: 0.4, ..plain }),
        )
        .thin()
        .energy(1.08),
        case(
            "layered, specular",
            0.25,
            layered(colour, 0.5, Layered { specular: 0.6, specular_colour: [2.0, 1.0, 0.5], ..plain }),
        ),
        case("layered, thin wall", 0.09, layered(WHITE, 0.3, Layered { transmission: 1.0, ..plain })).thin(),
        case("layered, half thin wall", 0.25, layered(colour, 0.5, Layered { transmission: 0.6, ..plain })).thin(),
        case("layered, volume", 0.16, layered(WHITE, 0.4, Layered { transmission: 1.0, is_volume: 1, ..plain })),
        case(
            "layered, iridescent volume",
            0.16,
            layered(
                WHITE,
                0.4,
                Layered {
                    transmission: 1.0,
                    is_volume: 1,
                    iridescence: 1.0,
                    iridescence_eta: 1.8,
                    iridescence_thickness: 300.0,
                    ..plain
                },
            ),
        ),
        case(
            "layered, coated volume",
            0.01,
            layered(
                colour,
                0.5,
                Layered { transmission: 0.8, is_volume: 1, clearcoat: 1.0, clearcoat_roughness: 0.1, ..plain },
            ),
        ),
        case(
            "layered, coated wall",
            0.04,
            layered(WHITE, 0.5, Layered { transmission: 1.0, clearcoat: 0.8, clearcoat_roughness: 0.2, ..plain }),
        )
        .thin(),
        case(
            "layered, clear coat",
            0.01,
            layered(colour, 0.5, Layered { clearcoat: 1.0, clearcoat_roughness: 0.1, ..plain }),
        ),
        case(
            "layered, tilted clear coat",
            0.04,
            layered(
                colour,
                0.5,
                Layered { clearcoat: 1.0, clearcoat_roughness: 0.3, clearcoat_normal: [0.36, -0.48, 0.8], ..plain },
            ),
        ),
        case(
            "layered, sheen",
            0.36,
            layered(colour, 0.6, Layered { sheen_colour: WHITE, sheen_roughness: 0.4, ..plain }),
        ),
        case(
            "layered, sheen on a wall",
            0.25,
            layered(
                WHITE,
                0.5,
                Layered { transmission: 0.7, sheen_colour: [0.2, 0.5, 0.9], sheen_roughness: 0.8, ..plain },
            ),
        )
        .thin(),
    ]
}

struct Bench<'a> {
    probe: Probe,
    cases: Vec<Case>,
    gpu: &'a Gpu,
}

impl<'a> Bench<'a> {
    fn new(gpu: &'a Gpu, cases: Vec<Case>) -> Self {
        let scene = with_materials(&cases.iter().map(|case| case.material.clone()).collect::<Vec<_>>());
        let probe = Probe::new(gpu, &scene, &settings(&scene, "path", Backend::Bvh), "test/bsdf").unwrap();
        Self { probe, cases, gpu }
    }

    fn ask(&self, queries: &[BsdfQuery]) -> Vec<BsdfAnswer> {
        self.probe.run(queries).unwrap()
    }

    /// What becomes of `wo` for each of these numbers; what is evaluated is the way back.
    fn sample(&self, material: usize, wo: [f32; 3], numbers: &[[f32; 3]]) -> Vec<BsdfAnswer> {
        let ask = |u: &[f32; 3]| BsdfQuery { material: material as u32, wo, wi: wo, u: *u };
        self.ask(&numbers.iter().map(ask).collect::<Vec<_>>())
    }

    fn asked(&self, id: usize) -> Asked<'_> {
        Asked { id, material: &self.cases[id].material, thin: self.cases[id].thin }
    }

    fn numbers(&self, count: usize, seed: u32) -> Vec<[f32; 3]> {
        numbers(self.gpu, count, seed).into_iter().map(|[a, b, c, _]| [a, b, c]).collect()
    }
}

/// Where lobes of `wo` peak: the mirror direction on its side, the refracted one on the other.
fn peaks(case: &Case, wo: [f32; 3]) -> [DVec3; 2] {
    let w = vector(wo);
    let mirror = DVec3::new(-w.x, -w.y, w.z);
    let eta = f64::from(case.material.record.eta);
    let eta = if w.z > 0.0 { eta } else { 1.0 / eta };
    let cos2 = 1.0 - (1.0 - w.z * w.z) / (eta * eta);
    let through =
        if case.thin || cos2 <= 0.0 { -w } else { DVec3::new(-w.x / eta, -w.y / eta, -cos2.sqrt() * w.z.signum()) };
    [mirror, through]
}

/// Samples fall where the density says (a chi-square test over rings around the peaks of the lobes), the density integrates
/// to one with what is invalid, and f |cos| integrates to the albedo that sampling finds.
#[test]
fn bsdf_samples_follow_their_density() {
    const RINGS: usize = 32;
    const SECTORS: usize = 16;
    const FINE: usize = 6;
    const SAMPLES: usize = 60_000;
    with_gpu(|gpu| {
        let bench = Bench::new(gpu, cases());
        let samples = bench.numbers(SAMPLES, 11);
        let mut findings = Findings::default();
        let mut worst = (0.0f64, String::new());
        for (material, case) in bench.cases.iter().enumerate().filter(|(_, case)| !case.is_delta()) {
            for wo in case.outgoing() {
                let name = format!("{}, wo.z = {:+.2}", case.name, wo[2]);
                let sides = peaks(case, wo).map(|axis| {
                    let first = (0.02 * case.narrowest).min(0.01);
                    Rings::new(axis, first, std::f64::consts::PI, RINGS, SECTORS)
                });
                let mut points = Vec::new();
                for (side, rings) in sides.iter().enumerate().take(if case.transmits() { 2 } else { 1 }) {
                    let here = f64::from(wo[2]) * if side == 0 { 1.0 } else { -1.0 };
                    let above = rings.points(FINE).into_iter().filter(|(w, _, _)| w.z * here > 0.0);
                    points.extend(above.map(|(w, solid_angle, cell)| (w, solid_angle, side * rings.cells() + cell)));
                }
                let queries: Vec<_> = points
                    .iter()
                    .map(|(w, _, _)| BsdfQuery { material: material as u32, wo, wi: w.as_vec3().into(), u: [0.5; 3] })
                    .collect();
                let mut expected = vec![0.0; 2 * sides[0].cells()];
                let mut integral = [0.0; 3];
                for (answer, (_, solid_angle, cell)) in bench.ask(&queries).iter().zip(&points) {
                    let sound = answer.pdf_w >= 0.0 && answer.pdf_w.is_finite();
                    findings.check(sound, || format!("{name}: density {}", answer.pdf_w));
                    expected[*cell] += f64::from(answer.pdf_w) * solid_angle * SAMPLES as f64;
                    integral.iter_mut().zip(answer.value).for_each(|(sum, f)| *sum += f64::from(f) * solid_angle);
                }
                let mut observed = vec![0.0; expected.len()];
                let mut others = 0.0; // invalid, or of a delta lobe
                let (mut sum, mut squares) = ([0.0; 3], [0.0; 3]);
                for answer in bench.sample(material, wo, &samples) {
                    if answer.sampled_pdf_w == 0.0 || answer.delta != 0 {
                        others += 1.0;
                        continue;
                    }
                    let wi = vector(answer.sampled);
                    let side = usize::from(wi.z * f64::from(wo[2]) < 0.0);
                    observed[side * sides[0].cells() + sides[side].cell(wi).unwrap()] += 1.0;
                    for channel in 0..3 {
                        sum[channel] += f64::from(answer.weight[channel]);
                        squares[channel] += f64::from(answer.weight[channel]).powi(2);
                    }
                }
                let z = chi_square_z(&observed, &expected);
                let share = (expected.iter().sum::<f64>() + others) / SAMPLES as f64;
                let count = SAMPLES as f64;
                let mut off = 0.0f64;
                for channel in 0..3 {
                    let mean = sum[channel] / count;
                    let sigma = ((squares[channel] / count - mean * mean).max(0.0) / count).sqrt();
                    off = off.max((mean - integral[channel]).abs() / (4.0 * sigma + 5e-3 * mean + 1e-6));
                }
                println!(
                    "{name}: chi-square z {z:+.2}, density {share:.4}, albedo {:.4} integrates to {:.4} ({off:.2} of the bound)",
                    sum[1] / count,
                    integral[1]
                );
                // p > 0.01 for all of them together (Sidak): z below 4 for about two hundred tests.
                findings.check(z < 4.0, || format!("{name}: chi-square z {z:.2}"));
                findings.check((share - 1.0).abs() < 0.012, || format!("{name}: the density integrates to {share:.4}"));
                findings.check(off < 1.0, || {
                    let mean = sum.map(|sum| sum / count);
                    format!("{name}: albedo by sampling {mean:.4?}, by integration {integral:.4?}")
                });
                if z > worst.0 {
                    worst = (z, name);
                }
            }
        }
        println!("largest chi-square z: {:.2}, {}", worst.0, worst.1);
    });
}

/// weight = f |cos| / pdf, and what `sample` says of its direction is what `eval` and `pdf` say of it.
#[test]
fn bsdf_sample_eval_and_pdf_agree() {
    with_gpu(|gpu| {
        let bench = Bench::new(gpu, cases());
        let samples = bench.numbers(10_000, 77);
        let mut findings = Findings::default();
        for (material, case) in bench.cases.iter().enumerate().filter(|(_, case)| !case.is_delta()) {
            // Rounding of directions moves narrow lobes in proportion to what they are wide.
            let bound = (2e-2f32).max(2e-4 / case.narrowest as f32);
            let mut worst = 0.0f32;
            for wo in case.outgoing() {
                for answer in bench.sample(material, wo, &samples) {
                    // Directions along the surface amplify rounding without limit, as the density does.
                    if answer.sampled_pdf_w == 0.0 || answer.delta != 0 || answer.sampled[2].abs() < 1e-3 {
                        continue;
                    }
                    let relative = |a: f32, b: f32| (a - b).abs() / a.abs().max(b.abs()).max(1e-4);
                    let pdf = relative(answer.sampled_pdf_w, answer.evaluated_pdf_w);
                    let value = (0..3)
                        .map(|c| relative(answer.weight[c] * answer.sampled_pdf_w, answer.sampled_value[c]))
                        .fold(0.0, f32::max);
                    worst = worst.max(pdf).max(value);
                }
            }
            println!("{}: largest relative difference {worst:.1e}, bound {bound:.1e}", case.name);
            findings.check(worst < bound, || format!("{}: {worst}", case.name));
        }
    });
}

/// The albedos of these materials, each channel's.
fn albedos(bench: &Bench, materials: &[usize], wo: [f32; 3], numbers: &[[f32; 3]]) -> Vec<[f64; 3]> {
    let all: Vec<Asked> = materials.iter().map(|id| bench.asked(*id)).collect();
    scattering::albedos(&bench.probe, &all, wo, numbers).unwrap()
}

fn albedo(bench: &Bench, material: usize, wo: [f32; 3], numbers: &[[f32; 3]]) -> [f64; 3] {
    albedos(bench, &[material], wo, numbers)[0]
}

/// No material gives back more than it gets; one that cannot lose anything gives all of it back.
#[test]
fn bsdf_energy_is_conserved() {
    with_gpu(|gpu| {
        let bench = Bench::new(gpu, cases());
        // The choice between two lobes is a jump that spread numbers average out slowly.
        let (few, many) = (spread(16_384), grid(256));
        let mut findings = Findings::default();
        for (material, case) in bench.cases.iter().enumerate() {
            let samples = if case.name.starts_with("compensated") { &many } else { &few };
            let (mut least, mut most) = (f64::MAX, 0.0f64);
            for cos in [0.03, 0.1, 0.2, 0.4, 0.7, 1.0] {
                for cos in [cos, -cos].into_iter().take(if case.transmits() { 2 } else { 1 }) {
                    let albedo = albedo(&bench, material, direction(cos, 0.7), samples);
                    let peak = albedo.iter().copied().fold(0.0, f64::max);
                    (least, most) = (least.min(peak), most.max(peak));
                    findings.check(peak <= case.energy, || format!("{}, cos {cos}: albedo {albedo:.4?}", case.name));
                    findings.check(!case.lossless || albedo.iter().all(|albedo| (albedo - 1.0).abs() < 2e-3), || {
                        format!("{}, cos {cos}: albedo {albedo:.4?} of something lossless", case.name)
                    });
                }
            }
            println!("{}: albedo {least:.4} to {most:.4}, bound {}", case.name, case.energy);
            findings.check(least > 0.1, || format!("{}: albedo {least}", case.name));
            // A bound that is not 1 says how far the model goes over, and no further.
            findings.check(case.energy < 1.01 || most > case.energy - 0.05, || {
                format!("{}: albedo {most}, and the bound is {}", case.name, case.energy)
            });
        }
    });
}

/// Where glass disperses, each channel is that of glass of its own index of refraction (KHR_materials_dispersion: 1/40 of what is above 1 for each
/// unit), and the density is the mean of theirs.
#[test]
fn dispersion_gives_each_channel_its_index() {
    with_gpu(|gpu| {
        let glass = |eta: f32, dispersion: f32| {
            let layers = Layered { transmission: 1.0, is_volume: 1, dispersion, ..plain_layers(0.0) };
            case("glass", 0.16, material::layered(WHITE, 0.4, eta, layers))
        };
        let bench = Bench::new(gpu, vec![glass(1.5, 2.0), glass(1.475, 0.0), glass(1.5, 0.0), glass(1.525, 0.0)]);
        let mut queries = Vec::new();
        for two in bench.numbers(4_000, 37).chunks_exact(2) {
            let [wo, wi] = [two[0], two[1]].map(|[a, b, _]| direction(2.0 * a - 1.0, std::f32::consts::TAU * b));
            queries.extend((0..4).map(|material| BsdfQuery { material, wo, wi, u: [0.5; 3] }));
        }
        let mut compared = 0;
        for answers in bench.ask(&queries).chunks_exact(4) {
            let (all, channels) = (answers[0], &answers[1..]);
            let expected = [0, 1, 2].map(|channel| channels[channel].value[channel]);
            let pdf = channels.iter().map(|answer| answer.pdf_w).sum::<f32>() / 3.0;
            let is_near = |a: f32, b: f32| (a - b).abs() <= 1e-4 * a.abs().max(b.abs()) + 1e-6;
            assert!(all.value.iter().zip(expected).all(|(a, b)| is_near(*a, b)), "{:?} {expected:?}", all.value);
            assert!(is_near(all.pdf_w, pdf), "{} {pdf}", all.pdf_w);
            compared += usize::from(expected[0] > 0.0 && expected[0] != expected[2]);
        }
        assert!(compared > 500, "{compared} differ between channels");
    });
}

/// f(wo, wi) = f(wi, wo), with the factor eta^2 between the two sides of a dielectric (Veach 1997, equation 5.14).
#[test]
fn bsdfs_are_reciprocal() {
    with_gpu(|gpu| {
        let bench = Bench::new(gpu, cases());
        let uniform = bench.numbers(40_000, 31);
        let mut findings = Findings::default();
        let reciprocal = |(_, case): &(usize, &Case)| !case.is_delta() && case.is_reciprocal();
        for (material, case) in bench.cases.iter().enumerate().filter(reciprocal) {
            // Half of the pairs anywhere, half near the peaks.
            let mut pairs = Vec::new();
            for (index, two) in uniform.chunks_exact(2).enumerate() {
                let [a, b] = [two[0], two[1]].map(|[a, b, _]| direction(2.0 * a - 1.0, std::f32::consts::TAU * b));
                if index % 2 == 0 {
                    pairs.push((a, b));
                } else {
                    let axis = peaks(case, a)[usize::from(two[0][2] < 0.5)];
                    pairs.push((a, (axis + vector(b) * case.narrowest).normalize().as_vec3().into()));
                }
            }
            pairs.retain(|(a, b)| case.transmits() || a[2] > 0.0 && b[2] > 0.0);
            pairs.retain(|(a, b)| a[2].abs() > 1e-2 && b[2].abs() > 1e-2);
            let ask = |wo, wi| BsdfQuery { material: material as u32, wo, wi, u: [0.5; 3] };
            let there = bench.ask(&pairs.iter().map(|(a, b)| ask(*a, *b)).collect::<Vec<_>>());
            let back = bench.ask(&pairs.iter().map(|(a, b)| ask(*b, *a)).collect::<Vec<_>>());
            let (mut worst, mut compared) = ((0.0f64, String::new()), 0);
            for (((a, b), there), back) in pairs.iter().zip(&there).zip(&back) {
                for [f, g] in both_ways(&bench.asked(material), *a, *b, there, back) {
                    if f.max(g) > 1e-4 {
                        compared += 1;
                        let difference = (f - g).abs() / f.max(g);
                        if difference > worst.0 {
                            worst = (difference, format!("{a:?} {b:?}: {f} against {g}"));
                        }
                    }
                }
            }
            println!("{}: largest relative difference {:.1e} of {compared}", case.name, worst.0);
            findings.check(compared > 5_000, || format!("{}: only {compared} compared", case.name));
            findings.check(worst.0 < 1e-5, || format!("{}: {:.1e}, {}", case.name, worst.0, worst.1));
        }
    });
}

/// All families, each at these roughnesses.
fn family_cases(roughness: &[f32]) -> Vec<Case> {
    let of_family = |(name, family, _): &Family| {
        let case = |r: &f32| Case { thin: is_thin(name), ..case(name, 1.0, family(*r)) };
        roughness.iter().map(case).collect::<Vec<_>>()
    };
    FAMILIES.iter().flat_map(of_family).collect()
}

/// A midpoint rule of `side` squared points over the numbers that microfacets are made of, with the golden ratio's multiples for
/// the number that chooses between lobes: what is smooth in the former is averaged closer than by spread numbers.
fn grid(side: usize) -> Vec<[f32; 3]> {
    let golden = 0.5 * (5.0f64.sqrt() - 1.0);
    let at = |index: usize| ((index as f64 + 0.5) / side as f64) as f32;
    let choice = |index: usize| ((0.5 + index as f64 * golden).fract() as f32).min(0.999_999_9);
    (0..side * side).map(|index| [at(index / side), at(index % side), choice(index)]).collect()
}

/// Albedo of what compensation adds to the material `plain`, which is `full` with it: the difference of what is evaluated,
/// integrated. Of microfacets without a direction it depends on the cosine alone, and is smooth, so a line of directions will
/// do. Radiance that crossed into a medium is taken back to what it was.
fn added(bench: &Bench, [plain, full]: [usize; 2], cos: f32) -> [f64; 3] {
    const STEPS: usize = 256;
    let wo = direction(cos, 0.7);
    let eta = f64::from(bench.cases[full].material.record.eta);
    let mut queries = Vec::new();
    let mut weights = Vec::new();
    for side in [1.0f32, -1.0].into_iter().take(if bench.cases[full].transmits() { 2 } else { 1 }) {
        let crossed = side * cos < 0.0;
        let eta2 = if !crossed { 1.0 } else { (if cos > 0.0 { eta } else { 1.0 / eta }).powi(2) };
        for step in 0..STEPS {
            // By the square root of the cosine, away from the highlight.
            let x = (step as f64 + 0.5) / STEPS as f64;
            weights.push(std::f64::consts::TAU * 2.0 * x / STEPS as f64 * eta2);
            let wi = direction(side * (x * x) as f32, 0.7);
            queries.push(wi);
        }
    }
    let ask = |material: usize| {
        let query = |wi: &[f32; 3]| BsdfQuery { material: material as u32, wo, wi: *wi, u: [0.5; 3] };
        bench.ask(&queries.iter().map(query).collect::<Vec<_>>())
    };
    let (with, without) = (ask(full), ask(plain));
    let mut sum = [0.0; 3];
    for ((with, without), weight) in with.iter().zip(&without).zip(&weights) {
        let pairs = with.value.iter().zip(without.value);
        sum.iter_mut().zip(pairs).for_each(|(sum, (with, without))| *sum += weight * f64::from(with - without));
    }
    sum
}

/// What compensation is for: no energy is lost, from any direction and on either side, and none is gained.
#[test]
fn compensated_materials_lose_nothing() {
    const ALPHAS: [f32; 5] = [0.05, 0.15, 0.35, 0.65, 1.0];
    const COSINES: [f32; 10] = [0.02, 0.05, 0.1, 0.2, 0.3, 0.45, 0.6, 0.75, 0.9, 1.0];
    let shapes = [(false, 0), (true, 0)];
    let indices = [None, Some(1.33f32), Some(1.5), Some(2.5)];
    let mut kinds = Vec::new();
    for eta in indices {
        for (beckmann, flag) in shapes {
            for alpha in ALPHAS {
                let alpha = Some([alpha; 2]);
                let plain = match eta {
                    None => material::conductor(PERFECT.0, PERFECT.1, WHITE, alpha),
                    Some(eta) => material::dielectric(eta, WHITE, WHITE, alpha),
                };
                let plain = MaterialDescription::from(flagged(plain, flag));
                kinds.push(case("", 1.0, if beckmann { plain.beckmann() } else { plain }));
            }
        }
    }
    let full = kinds.iter().map(|plain| case("", 1.0, plain.material.clone().compensated())).collect::<Vec<_>>();
    let count = kinds.len();
    with_gpu(|gpu| {
        let bench = Bench::new(gpu, kinds.into_iter().chain(full).collect());
        let samples = grid(256);
        let mut findings = Findings::default();
        for (group, eta) in indices.iter().enumerate() {
            let (mut least, mut most, mut without) = (f64::MAX, 0.0f64, f64::MAX);
            for plain in group * shapes.len() * ALPHAS.len()..(group + 1) * shapes.len() * ALPHAS.len() {
                let record = bench.cases[plain].material.record;
                for cos in COSINES.into_iter().flat_map(|cos| [cos, -cos]).filter(|cos| *cos > 0.0 || eta.is_some()) {
                    let single = albedo(&bench, plain, direction(cos, 0.7), &samples)[0];
                    let albedo = single + added(&bench, [plain, plain + count], cos)[0];
                    (least, most, without) = (least.min(albedo), most.max(albedo), without.min(single));
                    findings.check((albedo - 1.0).abs() < 5e-3 && albedo <= 1.002, || {
                        let (alpha, flags) = (record.alpha_u, record.flags);
                        format!("eta {eta:?}, alpha {alpha}, flags {flags}, cos {cos}: {single:.5}, then {albedo:.5}")
                    });
                }
            }
            println!("eta {eta:?}: albedo {least:.4} to {most:.4}; without compensation {without:.4} and more");
        }
    });
}

/// What comes back of a coloured metal is what its missing energy, found with a perfect mirror of the same roughness, comes to
/// by the series F^2 E / (1 - F (1 - E)) (Kulla and Conty 2017), with the means of Fresnel reflectance F and albedo E.
#[test]
fn compensated_metals_follow_the_series() {
    let gold = ([0.143, 0.374, 1.442], [3.983, 2.386, 1.603]);
    let alpha = 0.7;
    let of = |(eta, k): ([f32; 3], [f32; 3]), tint| {
        MaterialDescription::from(material::conductor(eta, k, tint, Some([alpha; 2])))
    };
    let tint = [1.0, 0.8, 0.5];
    let all = [of(gold, tint), of(gold, tint).compensated(), of(PERFECT, WHITE)];
    // Fresnel's equations for conductors by complex numbers, averaged by the midpoint rule.
    let fresnel = |mu: f64, eta: f64, k: f64| {
        // c = sqrt(n^2 - sin^2) with n = eta + i k.
        let (re, im) = (eta * eta - k * k - (1.0 - mu * mu), 2.0 * eta * k);
        let r = re.hypot(im);
        let (x, y) = ((0.5 * (r + re)).sqrt(), (0.5 * (r - re)).sqrt());
        let perpendicular = ((mu - x).powi(2) + y * y) / ((mu + x).powi(2) + y * y);
        let (a, b) = ((eta * eta - k * k) * mu, 2.0 * eta * k * mu);
        let parallel = ((a - x).powi(2) + (b - y).powi(2)) / ((a + x).powi(2) + (b + y).powi(2));
        0.5 * (parallel + perpendicular)
    };
    with_gpu(|gpu| {
        let bench = Bench::new(gpu, all.into_iter().map(|material| case("", 1.0, material)).collect());
        let samples = spread(65_536);
        // The mean albedo of the mirror, in steps of the cosine squared.
        let steps = 32;
        let cosine = |step: usize| ((step as f32 + 0.5) / steps as f32).sqrt();
        let few = spread(8192);
        let mean =
            (0..steps).map(|step| albedo(&bench, 2, direction(cosine(step), 0.7), &few)[0]).sum::<f64>() / steps as f64;
        let mut findings = Findings::default();
        for cos in [0.1, 0.3, 0.6, 1.0] {
            let [single, mirror] = [0, 2].map(|material| albedo(&bench, material, direction(cos, 0.7), &samples));
            let back = added(&bench, [0, 1], cos);
            for channel in 0..3 {
                let (eta, k) = (f64::from(gold.0[channel]), f64::from(gold.1[channel]));
                let f = (0..4096)
                    .map(|step| ((f64::from(step) + 0.5) / 4096.0).sqrt())
                    .map(|mu| fresnel(mu, eta, k) / 4096.0)
                    .sum::<f64>()
                    * f64::from(tint[channel]);
                let expected = f * f * mean / (1.0 - f * (1.0 - mean)) * (1.0 - mirror[0]);
                let (found, full) = (back[channel], single[channel] + back[channel]);
                println!(
                    "cos {cos}, channel {channel}: {found:.5} comes back against {expected:.5} of {:.5}",
                    1.0 - mirror[0]
                );
                findings.check((found - expected).abs() < 1e-3, || format!("cos {cos}: {found} against {expected}"));
                findings.check(found > 0.0 && full < 1.0, || format!("cos {cos}: {single:?} and {back:?}"));
            }
        }
    });
}

/// Nothing overflows or divides by zero as roughness or the angle to the surface vanish, and a microfacet that sampling
/// chose by what is visible never weighs more than one.
#[test]
fn nothing_breaks_as_roughness_vanishes() {
    let roughness: Vec<f32> = (0..=10).map(|step| 10f32.powf(-0.25 * step as f32)).collect(); // alpha 1 to 1e-5
    let cosines = [1.0, 0.3, 0.1, 0.03, 0.01, 3e-3, 1e-3, 1e-6, 1e-9];
    with_gpu(|gpu| {
        let samples = numbers(gpu, 512, 3).into_iter().map(|[a, b, c, _]| [a, b, c]).collect::<Vec<_>>();
        let mut findings = Findings::default();
        let bench = Bench::new(gpu, family_cases(&roughness));
        for (index, (name, ..)) in FAMILIES.iter().enumerate() {
            let mut heaviest = 0.0f32;
            for (step, r) in roughness.iter().enumerate() {
                let material = index * roughness.len() + step;
                let transmits = bench.cases[material].transmits();
                let eta2 = if transmits { bench.cases[material].material.record.eta.powi(2) } else { 1.0 };
                for cos in cosines.into_iter().flat_map(|cos| [cos, -cos]).filter(|cos| *cos > 0.0 || transmits) {
                    for answer in bench.sample(material, direction(cos, 0.7), &samples) {
                        let all = [answer.pdf_w, answer.sampled_pdf_w, answer.evaluated_pdf_w].into_iter();
                        let all = all.chain(answer.value).chain(answer.weight).chain(answer.sampled_value);
                        let finite = all.chain(answer.sampled).all(f32::is_finite);
                        findings.check(finite, || format!("{name}, alpha {:.0e}, cos {cos}: {answer:?}", r * r));
                        heaviest = heaviest.max(answer.weight[0] / eta2);
                    }
                }
            }
            println!("{name}: largest weight {heaviest:.3}");
            let bounded = matches!(*name, "GGX conductor" | "GGX dielectric" | "principled metal" | "layered metal");
            findings.check(!bounded || heaviest < 1.01, || format!("{name}: weight {heaviest}"));
        }
    });
}

/// A rough material whose roughness vanishes reflects what the smooth one does.
#[test]
fn the_smooth_ones_are_the_limit() {
    let (eta, k) = ([0.2, 0.92, 1.1], [3.9, 2.45, 2.14]);
    let almost = Some([1e-4; 2]);
    let pairs: Vec<[MaterialDescription; 2]> = vec![
        [material::conductor(eta, k, WHITE, almost).into(), material::conductor(eta, k, WHITE, None).into()],
        [material::dielectric(1.5, WHITE, WHITE, almost).into(), material::dielectric(1.5, WHITE, WHITE, None).into()],
        [
            material::plastic(1.5, [0.5; 3], WHITE, false, Some(1e-4)),
            material::plastic(1.5, [0.5; 3], WHITE, false, None),
        ],
        [principled(WHITE, 0.03, Principled { spec_trans: 1.0, ..Principled::default() }), {
            material::dielectric(1.5, WHITE, WHITE, None).into()
        }],
    ];
    with_gpu(|gpu| {
        let bench = Bench::new(gpu, pairs.into_iter().flatten().map(|material| case("", 1.0, material)).collect());
        let samples = spread(16_384);
        let mut findings = Findings::default();
        for pair in 0..bench.cases.len() / 2 {
            for cos in [0.1, 0.3, 0.6, 1.0] {
                let [rough, smooth] = [0, 1].map(|side| albedo(&bench, 2 * pair + side, direction(cos, 0.7), &samples));
                println!("pair {pair}, cos {cos}: {rough:.4?} against {smooth:.4?}");
                let near = (0..3).all(|channel| (rough[channel] - smooth[channel]).abs() < 5e-3);
                findings.check(near, || format!("pair {pair}, cos {cos}: {rough:.4?} against {smooth:.4?}"));
            }
        }
    });
}

/// Albedo of GGX with Smith's height-correlated masking and a Fresnel factor of 1: 1 - ln 2 at normal incidence for
/// alpha = 1 in closed form, 0.4507 at cos = 0.5, by quadrature.
#[test]
fn ggx_albedo_is_the_known_one() {
    let mut mirror = material::conductor(PERFECT.0, PERFECT.1, WHITE, Some([1.0; 2]));
    mirror.flags = MASKING_CORRELATED;
    let scene = with_materials(&[mirror.into()]);
    with_gpu(|gpu| {
        let probe = Probe::new(gpu, &scene, &settings(&scene, "path", Backend::Bvh), "test/bsdf").unwrap();
        let numbers = numbers(gpu, 1 << 20, 9);
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

/// Fresnel's and Snell's laws of smooth glass: 4 % at normal incidence, total reflection beyond the critical angle.
#[test]
fn smooth_glass_follows_fresnel_and_snell() {
    let scene = with_materials(&[material::dielectric(1.5, WHITE, WHITE, None).into()]);
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

/// A thin sheet reflects 2 r / (1 + r): 0.0769231 at normal incidence for an index of 1.5.
#[test]
fn a_thin_sheet_reflects_what_a_slab_does() {
    let scene = with_materials(&[material::thin_dielectric(1.5, WHITE, WHITE).into()]);
    with_gpu(|gpu| {
        let probe = Probe::new(gpu, &scene, &settings(&scene, "path", Backend::Bvh), "test/bsdf").unwrap();
        for wo in [[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]] {
            let ask = |lobe| BsdfQuery { material: 0, wo, wi: [0.0, 0.0, 1.0], u: [0.5, 0.5, lobe] };
            let answers: Vec<BsdfAnswer> = probe.run(&[ask(0.0), ask(0.999_999)]).unwrap();
            assert!((answers[0].sampled_pdf_w - 0.076_923_1).abs() < 1e-6, "{:?}", answers[0]);
            assert!((answers[1].sampled_pdf_w - 0.923_076_9).abs() < 1e-6, "{:?}", answers[1]);
            assert_eq!((answers[0].sampled, answers[1].sampled), (wo, wo.map(|x| -x)));
        }
    });
}

/// f |cos| of a principled material, term by term as published (Burley 2012, sections 5.3 to 5.6, and 2015, section 4; the clear
/// coat's masking and the tint as in Mitsuba's documentation).
fn principled_reference(m: &Material, p: &Principled, wo: DVec3, wi: DVec3) -> DVec3 {
    let [metallic, trans] = [p.metallic, p.spec_trans].map(f64::from);
    let (base, rough, eta) = (vector(m.reflectance), f64::from(m.alpha_u), f64::from(m.eta));
    let (front, reflected) = (wo.z > 0.0, wo.z * wi.z > 0.0);
    let ratio = if front { eta } else { 1.0 / eta };
    let h = (wo + wi * if reflected { 1.0 } else { ratio }).normalize();
    let h = h * h.z.signum();
    let (oh, ih) = (wo.dot(h), wi.dot(h));
    if oh * wo.z <= 0.0 || ih * wi.z <= 0.0 {
        return DVec3::ZERO;
    }
    let aspect = (1.0 - 0.9 * f64::from(p.anisotropic)).sqrt();
    let [ax, ay] = [rough * rough / aspect, rough * rough * aspect].map(|alpha| alpha.max(1e-3));
    let d = 1.0 / (std::f64::consts::PI * ax * ay * ((h.x / ax).powi(2) + (h.y / ay).powi(2) + h.z * h.z).powi(2));
    let g1 = |w: DVec3, ax: f64, ay: f64| {
        let tan2 = ((ax * w.x).powi(2) + (ay * w.y).powi(2)) / (w.z * w.z);
        2.0 / (1.0 + (1.0 + tan2).sqrt())
    };
    let g = g1(wo, ax, ay) * g1(wi, ax, ay);
    let sin2_t = (1.0 - oh * oh) / (ratio * ratio);
    let fresnel = if sin2_t >= 1.0 {
        1.0
    } else {
        let (ci, ct) = (oh.abs(), (1.0 - sin2_t).sqrt());
        let (s, p) = ((ci - ratio * ct) / (ci + ratio * ct), (ratio * ci - ct) / (ratio * ci + ct));
        0.5 * (s * s + p * p)
    };
    if !reflected {
        let share = (1.0 - metallic) * trans * (1.0 - fresnel) * d * g * (oh * ih).abs();
        return base.powf(0.5) * (share / (wo.z.abs() * (oh + ratio * ih).powi(2)));
    }
    let weight = |c: f64| (1.0 - c).powi(5);
    let schlick = |r0: DVec3| r0 + (DVec3::ONE - r0) * weight(oh);
    let luminance = base.dot(DVec3::new(0.212671, 0.715160, 0.072169));
    let tint = base / luminance;
    let shine = d * g / (4.0 * wo.z.abs());
    if !front {
        return DVec3::splat((1.0 - metallic) * trans * fresnel * shine);
    }
    let r0 = ((eta - 1.0) / (eta + 1.0)).powi(2);
    let tinted = f64::from(p.spec_tint);
    let mut value = (schlick(base) * metallic
        + (schlick(tint * r0) * tinted + DVec3::splat(fresnel * (1.0 - tinted))) * (1.0 - metallic))
        * shine;
    let a = 0.1 + (0.001 - 0.1) * f64::from(p.clearcoat_gloss);
    let gtr1 = (a * a - 1.0) / (std::f64::consts::PI * (a * a).ln() * (1.0 + (a * a - 1.0) * h.z * h.z));
    let coat = g1(wo, 0.25, 0.25) * g1(wi, 0.25, 0.25) * gtr1 * wi.z;
    value += schlick(DVec3::splat(0.04)) * (0.25 * f64::from(p.clearcoat) * coat);
    if metallic == 1.0 || trans == 1.0 {
        return value;
    }
    let (fo, fi) = (weight(wo.z), weight(wi.z));
    let fd90 = 0.5 + 2.0 * rough * oh * oh;
    let diffuse = (1.0 + (fd90 - 1.0) * fo) * (1.0 + (fd90 - 1.0) * fi);
    // Burley 2012: the lobe as one product. Burley 2015 splits it into base and retro-reflection, which sum to the same.
    let ss90 = rough * oh * oh;
    let ss = (1.0 + (ss90 - 1.0) * fo) * (1.0 + (ss90 - 1.0) * fi);
    let flat = 1.25 * (ss * (1.0 / (wo.z + wi.z) - 0.5) + 0.5);
    let diffuse = diffuse + (flat - diffuse) * f64::from(p.flatness);
    value += base * ((1.0 - metallic) * (1.0 - trans) * diffuse * wi.z / std::f64::consts::PI);
    let sheen = DVec3::ONE.lerp(tint, f64::from(p.sheen_tint));
    value + sheen * (f64::from(p.sheen) * (1.0 - metallic) * weight(oh) * wi.z)
}

/// f |cos| of a thin principled material, term by term as published (Burley 2015, section 5.3).
fn principled_thin_reference(m: &Material, p: &Principled, wo: DVec3, wi: DVec3) -> DVec3 {
    let reflected = wo.z * wi.z > 0.0;
    let (wo, wi) = (DVec3::new(wo.x, wo.y, wo.z.abs()), DVec3::new(wi.x, wi.y, wi.z.abs()));
    let (base, eta, rough) = (vector(m.reflectance), f64::from(m.eta), f64::from(m.alpha_u));
    let [trans, passed] = [p.spec_trans, 0.5 * p.diff_trans].map(f64::from);
    let h = (wo + wi).normalize();
    let cos = wo.dot(h);
    let aspect = (1.0 - 0.9 * f64::from(p.anisotropic)).sqrt();
    let spread = if reflected { rough } else { (0.65 * eta - 0.35) * rough };
    let [ax, ay] = [spread * spread / aspect, spread * spread * aspect].map(|alpha| alpha.max(1e-3));
    let d = 1.0 / (std::f64::consts::PI * ax * ay * ((h.x / ax).powi(2) + (h.y / ay).powi(2) + h.z * h.z).powi(2));
    let g1 = |w: DVec3| 2.0 / (1.0 + (1.0 + ((ax * w.x).powi(2) + (ay * w.y).powi(2)) / (w.z * w.z)).sqrt());
    let inside = (1.0 - (1.0 - cos * cos) / (eta * eta)).sqrt();
    let (s, t) = ((cos - eta * inside) / (cos + eta * inside), (eta * cos - inside) / (eta * cos + inside));
    let fresnel = 0.5 * (s * s + t * t);
    let shine = trans * d * g1(wo) * g1(wi) / (4.0 * wo.z);
    let diffuse = (1.0 - trans) * wi.z;
    if !reflected {
        // Nothing passes a microfacet from above its plane.
        let shine = if DVec3::new(wi.x, wi.y, -wi.z).dot(h) < 0.0 { shine } else { 0.0 };
        return base * (shine * (1.0 - fresnel) + diffuse * passed / std::f64::consts::PI);
    }
    let weight = |c: f64| (1.0 - c).powi(5);
    let tint = base / base.dot(DVec3::new(0.212671, 0.715160, 0.072169));
    let r0 = tint * ((eta - 1.0) / (eta + 1.0)).powi(2);
    let tinted = DVec3::splat(fresnel).lerp(r0 + (DVec3::ONE - r0) * weight(cos), f64::from(p.spec_tint));
    let (fo, fi) = (weight(wo.z), weight(wi.z));
    let lobe = |f90: f64| (1.0 + (f90 - 1.0) * fo) * (1.0 + (f90 - 1.0) * fi);
    let flat = 1.25 * (lobe(rough * cos * cos) * (1.0 / (wo.z + wi.z) - 0.5) + 0.5);
    let plain = lobe(0.5 + 2.0 * rough * cos * cos);
    let scattered = base * ((plain + (flat - plain) * f64::from(p.flatness)) / std::f64::consts::PI);
    let sheen = DVec3::ONE.lerp(tint, f64::from(p.sheen_tint)) * (f64::from(p.sheen) * weight(cos));
    tinted * shine + (scattered + sheen) * (diffuse * (1.0 - passed))
}

#[test]
fn principled_is_the_published_model() {
    with_gpu(|gpu| {
        let bench = Bench::new(gpu, cases());
        let uniform = bench.numbers(8_000, 41);
        let mut findings = Findings::default();
        for (material, case) in bench.cases.iter().enumerate() {
            let Detail::Principled(parameters) = &case.material.detail else { continue };
            let pairs = uniform.chunks_exact(2).map(|two| {
                let [a, b] = [two[0], two[1]].map(|[a, b, _]| direction(2.0 * a - 1.0, std::f32::consts::TAU * b));
                let axis = peaks(case, a)[usize::from(two[0][2] < 0.5)];
                let near = (axis + vector(b) * 0.3).normalize().as_vec3().into();
                (a, if two[1][2] < 0.5 { b } else { near })
            });
            let sound = |a: &[f32; 3], b: &[f32; 3]| case.transmits() || a[2] > 0.0 && b[2] > 0.0;
            let pairs: Vec<_> = pairs.filter(|(a, b)| sound(a, b) && a[2].abs() > 0.02 && b[2].abs() > 0.02).collect();
            let ask = |(wo, wi): &([f32; 3], [f32; 3])| BsdfQuery {
                material: material as u32,
                wo: *wo,
                wi: *wi,
                u: [0.5; 3],
            };
            let answers = bench.ask(&pairs.iter().map(ask).collect::<Vec<_>>());
            let mut worst = (0.0f64, String::new());
            for (answer, (wo, wi)) in answers.iter().zip(&pairs) {
                let thin = case.material.record.kind == MATERIAL_PRINCIPLED_THIN;
                let model = if thin { principled_thin_reference } else { principled_reference };
                let expected = model(&case.material.record, parameters, vector(*wo), vector(*wi));
                let off = (vector(answer.value) - expected).abs().max_element() / expected.max_element().max(1e-3);
                if off > worst.0 {
                    worst = (off, format!("{wo:?} {wi:?}: {:?} against {expected}", answer.value));
                }
            }
            println!("{}: largest relative difference {:.1e} of {}", case.name, worst.0, pairs.len());
            findings.check(worst.0 < 1e-3, || format!("{}: {:.1e} at {}", case.name, worst.0, worst.1));
        }
    });
}
