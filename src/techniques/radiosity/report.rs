//! What patches tell about themselves: how many there are, whether their form factors conserve energy, and what is left of the light.

use serde::Serialize;

use super::super::state::StateReport;
use crate::error::{Error, Result};

use super::patches::{FIRST_COLUMN, PatchMesh};

/// Figures of a rendering with patches.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct PatchReport {
    /// Patches.
    pub patches: usize,
    /// Vertices at their corners.
    pub vertices: usize,
    /// Rays of a patch in a round.
    pub rays: u32,
    /// Rounds in which light was passed on.
    pub rounds: u32,
    /// Share of the light that was still on its way when the image began.
    pub residual: f64,
    /// Sums of a patch's form factors to all others, 1 in a closed scene: the least, the mean by area, and the greatest.
    pub row_sums: [f64; 3],
    /// Share of rays that met what has no patch: the back of a surface, or one that reflects nothing.
    pub blocked: f64,
    /// Form factors between the fronts of surfaces, from row to column, where these are few.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub form_factors: Vec<Vec<f64>>,
    /// The largest difference between A_i F_ij and A_j F_ji, as a share of the larger area.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reciprocity: Option<f64>,
}

impl PatchReport {
    /// The report of the rendering: the figures, and what the summary says of them.
    pub(super) fn report(&self) -> Result<StateReport> {
        let Self { patches, vertices, rays, rounds, residual, row_sums: [least, mean, greatest], blocked, .. } = self;
        let reciprocity = self.reciprocity.map_or(String::new(), |off| format!(", reciprocity off by {off:.1e}"));
        Ok(StateReport {
            key: "patches",
            figures: serde_json::to_value(self).map_err(|error| Error::Device(error.to_string()))?,
            summary: vec![
                format!("patches    {patches} with {vertices} vertices, {rounds} rounds of {rays} rays"),
                format!("           form factors sum to {least:.4} to {greatest:.4}, mean {mean:.6}{reciprocity}"),
                format!(
                    "           light still on its way {residual:.1e}, stopped by what has no patch {:.2} %",
                    100.0 * blocked
                ),
            ],
        })
    }

    /// From what the rays of each patch met.
    pub(super) fn new(mesh: &PatchMesh, counts: &[u32], surfaces: usize) -> Self {
        let columns = mesh.columns() as usize;
        let mut report = Self { patches: mesh.patches.len(), vertices: mesh.vertices(), ..Self::default() };
        let (mut least, mut greatest, mut area_sum) = (f64::MAX, 0.0f64, 0.0);
        let told_apart = if mesh.has_surfaces { surfaces } else { 0 };
        let mut flows = vec![vec![0.0; told_apart]; told_apart];
        let mut areas = vec![0.0; told_apart];
        for (patch, row) in mesh.patches.iter().zip(counts.chunks_exact(columns)) {
            let rays: u64 = row.iter().map(|count| u64::from(*count)).sum();
            if rays == 0 {
                continue;
            }
            let (area, share) = (f64::from(patch.area), |column: usize| f64::from(row[column]) / rays as f64);
            let sum = 1.0 - share(0);
            (least, greatest) = (least.min(sum), greatest.max(sum));
            area_sum += area;
            report.row_sums[1] += area * sum;
            report.blocked += area * share(1);
            if told_apart > 0 && patch.back == 0 {
                let own = (patch.column - FIRST_COLUMN) as usize;
                areas[own] += area;
                (0..surfaces).for_each(|to| flows[own][to] += area * share(FIRST_COLUMN as usize + to));
            }
        }
        if area_sum > 0.0 {
            report.row_sums = [least, report.row_sums[1] / area_sum, greatest];
            report.blocked /= area_sum;
            if told_apart > 0 {
                report.tell_apart(&flows, &areas);
            }
        }
        report
    }

    /// Takes in what goes from surface to surface, area times form factor.
    fn tell_apart(&mut self, flows: &[Vec<f64>], areas: &[f64]) {
        let factor = |flow: f64, area: f64| if area > 0.0 { flow / area } else { 0.0 };
        self.form_factors =
            flows.iter().zip(areas).map(|(row, area)| row.iter().map(|flow| factor(*flow, *area)).collect()).collect();
        let pairs = (0..areas.len()).flat_map(|a| (0..a).map(move |b| (a, b)));
        let off = |(a, b): (usize, usize)| factor((flows[a][b] - flows[b][a]).abs(), areas[a].max(areas[b]));
        self.reciprocity = Some(pairs.map(off).fold(0.0, f64::max));
    }
}
