//! What a rough metal or rough glass loses because its model follows light through one scattering among microfacets only,
//! integrated once per material; `shaders/materials/compensation.glsl` gives it back.

use std::collections::HashMap;
use std::f64::consts::PI;

use glam::DVec3;
use rayon::prelude::*;

use super::fresnel::{diffuse_reflectance, mean_fresnel};
use super::microfacets::Microfacets;
use super::quadrature::gauss_legendre;
use crate::layout::{
    COMPENSATION_CELLS, Compensation, MASKING_CORRELATED, MATERIAL_ROUGH_DIELECTRIC, MICROFACET_BECKMANN,
    PROPERTY_ALPHA_U, PROPERTY_ALPHA_V, PROPERTY_ROUGHNESS,
};
use crate::scene::material::MaterialDescription;

/// Values of a row: missing energy by the square root of the cosine, which resolves grazing angles.
const CELLS: usize = COMPENSATION_CELLS as usize;
/// Rows of a table over a roughness that a texture scales.
const FACTOR_ROWS: usize = 32;
/// Rows of a table over the azimuth of anisotropic microfacets.
const AZIMUTH_ROWS: usize = 12;
/// The least roughness, the shaders' own.
const LEAST_ALPHA: f64 = 1e-4;

/// How the rows of a table differ.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rows {
    /// There is one.
    One,
    /// By the squared sine of the direction's azimuth, evenly.
    Azimuth,
    /// By the square root of a factor on the roughness, evenly.
    Factor,
}

impl Rows {
    /// How many there are.
    pub fn count(self) -> usize {
        match self {
            Self::One => 1,
            Self::Azimuth => AZIMUTH_ROWS,
            Self::Factor => FACTOR_ROWS,
        }
    }

    /// Points in azimuth and angle of the rule that normals are integrated by, and the share of the circle that the azimuth
    /// covers: half, where the other half mirrors it. More rows take fewer points each; the kink where facets begin to reflect
    /// totally, seen from the side of the greater index, takes more.
    fn rule(self, beckmann: bool, eta: Option<f64>) -> Vec<(f64, f64, f64)> {
        let (azimuths, angles, circle) = match self {
            Self::One => (24, 96, 0.5),
            Self::Azimuth => (48, 32, 1.0),
            Self::Factor => (24, 48, 0.5),
        };
        let times = if eta.is_some_and(|eta| eta < 1.0) { 2 } else { 1 };
        let (azimuths, angles) = (times * azimuths, times * angles);
        let angles = gauss_legendre(angles);
        let point = |index: usize, (s, weight): &(f64, f64)| {
            let u = circle * (index as f64 + 0.5) / azimuths as f64;
            let weight = weight / azimuths as f64;
            // The number that Beckmann's steep slopes come from is stretched towards its end, where they grow without limit.
            if beckmann { (u, s * (2.0 - s), weight * 2.0 * (1.0 - s)) } else { (u, *s, weight) }
        };
        (0..azimuths).flat_map(|index| angles.iter().map(move |angle| point(index, angle))).collect()
    }
}

/// Share of the light from a direction of `w.z` > 0 that no single scattering accounts for.
fn missing(facets: &Microfacets, eta: Option<f64>, w: DVec3, rule: &[(f64, f64, f64)]) -> f64 {
    let (reflected, transmitted) = facets.scattered(w, eta, rule);
    (1.0 - reflected - transmitted).max(0.0)
}

/// Cosine-weighted mean, 2 times the integral over mu of M(mu) mu, of a row of values over x = sqrt(mu) with straight lines
/// between them: exactly what the shaders interpolate, so that what is given back is what is missing.
fn mean_of_row(row: &[f32]) -> f64 {
    let cell = 1.0 / (row.len() - 1) as f64;
    let points = gauss_legendre(3); // exact up to degree 5
    let of_cell = |(index, ends): (usize, &[f32])| -> f64 {
        let [a, b] = [ends[0], ends[1]].map(f64::from);
        points
            .iter()
            .map(|(t, weight)| weight * cell * 4.0 * ((index as f64 + t) * cell).powi(3) * (a + (b - a) * t))
            .sum()
    };
    row.windows(2).enumerate().map(of_cell).sum()
}

/// Shares of the circle that belong to each of `count` rows over the squared sine of the azimuth, with straight lines
/// between them.
fn azimuth_shares(count: usize) -> Vec<f64> {
    const STEPS: usize = 4096;
    let mut shares = vec![0.0; count];
    for step in 0..STEPS {
        let at = (0.5 * PI * (step as f64 + 0.5) / STEPS as f64).sin().powi(2) * (count - 1) as f64;
        let row = (at as usize).min(count - 2);
        shares[row] += (1.0 - (at - row as f64)) / STEPS as f64;
        shares[row + 1] += (at - row as f64) / STEPS as f64;
    }
    shares
}

/// The table of a material: for each row, and for each side of glass (outside, inside), the mean of the missing energy and then
/// [`COMPENSATION_CELLS`] values of it. Facets of relative index `eta` reflect and refract; without one they are perfect mirrors.
pub fn table(facets: Microfacets, eta: Option<f64>, rows: Rows) -> Vec<f32> {
    let sides = eta.map_or(vec![None], |eta| vec![Some(eta), Some(1.0 / eta)]);
    let rules: Vec<_> = sides.iter().map(|side| rows.rule(facets.beckmann, *side)).collect();
    let lines: Vec<(usize, usize)> =
        (0..rows.count()).flat_map(|row| (0..sides.len()).map(move |side| (row, side))).collect();
    let last_row = rows.count().max(2) as f64 - 1.0;
    let values: Vec<f32> = (0..lines.len() * CELLS)
        .into_par_iter()
        .map(|index| {
            let (row, side) = lines[index / CELLS];
            let mu = ((index % CELLS) as f64 / (CELLS - 1) as f64).powi(2).max(1e-6);
            let at = row as f64 / last_row;
            let (facets, sin2_phi) = match rows {
                Rows::One => (facets, 0.0),
                Rows::Azimuth => (facets, at),
                Rows::Factor => {
                    (Microfacets { alpha: facets.alpha.map(|alpha| (alpha * at * at).max(LEAST_ALPHA)), ..facets }, 0.0)
                }
            };
            let sine = (1.0 - mu * mu).max(0.0).sqrt();
            let w = DVec3::new(sine * (1.0f64 - sin2_phi).sqrt(), sine * sin2_phi.sqrt(), mu);
            missing(&facets, sides[side], w, &rules[side]) as f32
        })
        .collect();
    let mut means: Vec<f64> = values.chunks(CELLS).map(mean_of_row).collect();
    if rows == Rows::Azimuth {
        let shares = azimuth_shares(rows.count());
        for side in 0..sides.len() {
            let lines = means.iter().skip(side).step_by(sides.len());
            let mean: f64 = lines.zip(&shares).map(|(mean, share)| mean * share).sum();
            means.iter_mut().skip(side).step_by(sides.len()).for_each(|of_row| *of_row = mean);
        }
    }
    let line = |(row, mean): (&[f32], f64)| std::iter::once(mean as f32).chain(row.iter().copied()).collect::<Vec<_>>();
    values.chunks(CELLS).zip(means).flat_map(line).collect()
}

/// Tables that have been made: materials that differ in colour only share theirs.
pub(super) type Known = HashMap<[u32; 5], u32>;

/// What a compensated material needs; its table goes to the end of `tables`, unless it is `known`.
pub(super) fn file(description: &MaterialDescription, tables: &mut Vec<f32>, known: &mut Known) -> Compensation {
    let record = &description.record;
    let is_glass = record.kind == MATERIAL_ROUGH_DIELECTRIC;
    let alpha = [record.alpha_u, record.alpha_v];
    let rows = if description.textures.any_of(&[PROPERTY_ROUGHNESS, PROPERTY_ALPHA_U, PROPERTY_ALPHA_V]) {
        Rows::Factor
    } else if alpha[0] != alpha[1] {
        Rows::Azimuth
    } else {
        Rows::One
    };
    let eta = if is_glass { record.eta } else { 0.0 };
    let shape = record.flags & (MASKING_CORRELATED | MICROFACET_BECKMANN);
    let key = [shape, alpha[0].to_bits(), alpha[1].to_bits(), eta.to_bits(), rows.count() as u32];
    let first = *known.entry(key).or_insert_with(|| {
        let first = tables.len() as u32;
        let mut alpha = alpha.map(|alpha| f64::from(alpha).max(LEAST_ALPHA));
        if rows == Rows::Factor {
            alpha = [(alpha[0] * alpha[1]).sqrt(); 2]; // a table has no room for the azimuth besides
        }
        let facets = Microfacets {
            alpha,
            beckmann: shape & MICROFACET_BECKMANN != 0,
            correlated: shape & MASKING_CORRELATED != 0,
        };
        tables.extend(table(facets, is_glass.then_some(f64::from(eta)), rows));
        first
    });
    let mean_fresnel = if is_glass {
        [diffuse_reflectance(f64::from(eta)) as f32, 0.0, 0.0]
    } else {
        let of =
            |channel: usize| mean_fresnel(record.conductor_eta[channel].into(), record.conductor_k[channel].into());
        [0, 1, 2].map(|channel| of(channel) as f32)
    };
    Compensation {
        mean_fresnel,
        table: first,
        rows: rows.count() as u32,
        alpha: if rows == Rows::Factor { (record.alpha_u * record.alpha_v).sqrt() } else { 0.0 },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn facets(alpha: f64, beckmann: bool, correlated: bool) -> Microfacets {
        Microfacets { alpha: [alpha; 2], beckmann, correlated }
    }

    /// With correlated masking and alpha = 1, f = 1 / (2 pi (mu_o + mu_i)), so that the albedo is 1 - mu ln(1 + 1 / mu), which is
    /// 1 - ln 2 at normal incidence, and its mean 4 (1 - ln 2) / 3. Of alpha 0.5 and 0.1 the means are 0.7003 and 0.9719.
    #[test]
    fn ggx_misses_what_is_known() {
        let line = table(facets(1.0, false, true), None, Rows::One);
        let mut worst = 0.0f64;
        for (cell, value) in line[1..].iter().enumerate().skip(1) {
            let mu = (cell as f64 / (CELLS - 1) as f64).powi(2);
            worst = worst.max((f64::from(*value) - mu * (1.0 + 1.0 / mu).ln()).abs());
        }
        println!("alpha 1: largest difference {worst:.1e}");
        assert!(worst < 3e-4, "{worst}");
        let exact = 4.0 / 3.0 * (1.0 - std::f64::consts::LN_2);
        for (alpha, mean) in [(1.0, exact), (0.5, 0.7003), (0.1, 0.9719)] {
            let found = 1.0 - f64::from(table(facets(alpha, false, true), None, Rows::One)[0]);
            println!("alpha {alpha}: mean {found:.5} against {mean:.5}");
            assert!((found - mean).abs() < 2e-4, "alpha {alpha}: mean {found} against {mean}");
        }
    }

    /// Between the table's values the missing energy is within 0.1 % of the albedo, of mirrors and of either side of glass.
    #[test]
    fn tables_are_fine_enough() {
        let mut worst = (0.0f64, String::new());
        for beckmann in [false, true] {
            for eta in [None, Some(1.5)] {
                for alpha in [0.01, 0.05, 0.2, 0.6, 1.0] {
                    let facets = facets(alpha, beckmann, false);
                    let lines = table(facets, eta, Rows::One);
                    for (side, line) in lines.chunks(CELLS + 1).enumerate() {
                        let eta = eta.map(|eta: f64| if side == 0 { eta } else { 1.0 / eta });
                        let rule = Rows::One.rule(beckmann, eta);
                        for cell in (0..CELLS - 1).step_by(3) {
                            let mu = ((cell as f64 + 0.5) / (CELLS - 1) as f64).powi(2);
                            let w = DVec3::new((1.0 - mu * mu).sqrt(), 0.0, mu);
                            let off =
                                0.5 * f64::from(line[1 + cell] + line[2 + cell]) - missing(&facets, eta, w, &rule);
                            if off.abs() > worst.0 {
                                worst = (
                                    off.abs(),
                                    format!("beckmann {beckmann}, eta {eta:?}, alpha {alpha}, cosine {mu:.4}"),
                                );
                            }
                        }
                    }
                }
            }
        }
        println!("largest difference between values: {:.1e} at {}", worst.0, worst.1);
        assert!(worst.0 < 1e-3, "{:.1e} at {}", worst.0, worst.1);
    }

    /// The mean of a row is that of straight lines between its values, and anisotropic rows that are all alike keep it.
    #[test]
    fn means_are_those_of_what_is_interpolated() {
        let row: Vec<f32> = (0..CELLS).map(|cell| if cell % 2 == 0 { 0.25 } else { 0.75 }).collect();
        let steps = 1 << 20;
        let expected: f64 = (0..steps)
            .map(|step| {
                let mu = (step as f64 + 0.5) / steps as f64;
                let at = mu.sqrt() * (CELLS - 1) as f64;
                let (cell, t) = ((at as usize).min(CELLS - 2), at - at.floor());
                2.0 * mu * (f64::from(row[cell]) * (1.0 - t) + f64::from(row[cell + 1]) * t) / steps as f64
            })
            .sum();
        assert!((mean_of_row(&row) - expected).abs() < 1e-6, "{} against {expected}", mean_of_row(&row));
        assert!((azimuth_shares(AZIMUTH_ROWS).iter().sum::<f64>() - 1.0).abs() < 1e-12);
        let (one, all) =
            (table(facets(0.5, false, false), None, Rows::One), table(facets(0.5, false, false), None, Rows::Azimuth));
        assert!((one[0] - all[0]).abs() < 5e-4, "{} against {}", one[0], all[0]);
    }

    /// A perfect mirror reflects everything on average, a dielectric written as a conductor what the dielectric does.
    #[test]
    fn mean_fresnel_is_the_known_one() {
        assert!((mean_fresnel(0.0, 1.0) - 1.0).abs() < 1e-12);
        let (conductor, dielectric) = (mean_fresnel(1.5, 0.0), diffuse_reflectance(1.5));
        assert!((conductor - dielectric).abs() < 1e-6, "{conductor} against {dielectric}");
    }
}
