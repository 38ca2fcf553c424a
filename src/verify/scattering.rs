//! What is asked of BSDFs through `shaders/kernels/test/bsdf.glsl`: albedos, and values in both directions.

use glam::DVec3;

use crate::error::Result;
use crate::layout::{BsdfAnswer, BsdfQuery};
use crate::render::Probe;
use crate::scene::material::MaterialDescription;
use crate::scene::{Scene, SceneBuilder, SurfaceDescription};

/// A material of a probe's scene.
#[derive(Clone, Copy, Debug)]
pub struct Asked<'a> {
    /// Its index in the scene.
    pub id: usize,
    /// Its description.
    pub material: &'a MaterialDescription,
    /// Light passes it without a change of medium, as through a sheet.
    pub thin: bool,
}

/// A scene that uses these materials, so that a kernel made for it knows each of them.
pub fn scene_with(materials: &[MaterialDescription]) -> Result<Scene> {
    let mut builder = SceneBuilder::new("materials");
    for (index, material) in materials.iter().enumerate() {
        let front = Some(builder.material(material.clone()));
        let surface = builder.surface(SurfaceDescription { front, ..SurfaceDescription::default() });
        builder.sphere(0, "sphere", DVec3::X * (3.0 * index as f64), 1.0, surface);
    }
    builder.finish()
}

/// A vector of the device in double precision.
pub fn vector(v: [f32; 3]) -> DVec3 {
    DVec3::from(v.map(f64::from))
}

/// Albedo of each of these materials for `wo`, each channel's: the mean weight of what is sampled with these numbers. Radiance that crossed
/// into a medium of index eta is taken back to what it was (divided by 1 / eta^2).
pub fn albedos(probe: &Probe, all: &[Asked], wo: [f32; 3], numbers: &[[f32; 3]]) -> Result<Vec<[f64; 3]>> {
    let ask = |id: usize, u: &[f32; 3]| BsdfQuery { material: id as u32, wo, wi: [0.0, 0.0, 1.0], u: *u };
    let queries: Vec<_> = all.iter().flat_map(|asked| numbers.iter().map(move |u| ask(asked.id, u))).collect();
    let answers: Vec<BsdfAnswer> = probe.run(&queries)?;
    let albedo = |(asked, answers): (&Asked, &[BsdfAnswer])| {
        let eta = f64::from(asked.material.record.eta);
        let eta = if wo[2] > 0.0 { eta } else { 1.0 / eta };
        let mut sum = [0.0; 3];
        for answer in answers {
            let crossed = asked.material.transmits() && !asked.thin && answer.sampled[2] * wo[2] < 0.0;
            let factor = if crossed { eta * eta } else { 1.0 };
            sum.iter_mut().zip(answer.weight).for_each(|(sum, weight)| *sum += f64::from(weight) * factor);
        }
        sum.map(|sum| sum / answers.len() as f64)
    };
    Ok(all.iter().zip(answers.chunks(numbers.len())).map(albedo).collect())
}

/// The BSDF from `a` to `b` and back, by channel, from the answers for (wo, wi) = (a, b) and (b, a): equal where it is reciprocal. Light that
/// leaves along a direction in a medium of index eta counts over eta^2 (Veach 1997, equation 5.14): 1 above, the material's below.
pub fn both_ways(asked: &Asked, a: [f32; 3], b: [f32; 3], there: &BsdfAnswer, back: &BsdfAnswer) -> [[f64; 2]; 3] {
    let eta2 = f64::from(asked.material.record.eta).powi(2);
    [0, 1, 2].map(|channel| {
        // Of the BSDF itself: f |cos| over the cosine of the incident direction.
        let mut f = f64::from(there.value[channel]) / f64::from(b[2].abs());
        let mut g = f64::from(back.value[channel]) / f64::from(a[2].abs());
        if a[2] * b[2] < 0.0 && !asked.thin {
            if b[2] < 0.0 { f *= eta2 } else { g *= eta2 }
        }
        [f, g]
    })
}
