//! From runs to figures: means over seeds with their intervals.

use super::results::{
    CurvePoint, Figure, Floor, HEAVY_TAIL, LEAST_ERROR, Pair, Point, Ratio, Row, Run, VariantResults,
};
use super::run::{Bench, Event, Variant};
use crate::error::Result;
use crate::image::Image;
use crate::image::metrics::squared_bias;
use crate::statistics::{CONFIDENCE, Interval, SIGNIFICANCE, log_slope};

/// Deviations by which a squared bias must exceed zero to be called one.
const FLOOR_DEVIATIONS: f64 = 4.0;

/// The figures of one scene.
pub struct Summary {
    /// One entry per variant.
    pub variants: Vec<VariantResults>,
    /// Each variant against the first one.
    pub pairs: Vec<Pair>,
    /// All variants after the same time.
    pub equal_time: Option<Row>,
    /// All variants at the same number of samples.
    pub equal_spp: Option<Row>,
}

impl Bench<'_> {
    /// Runs the scene and sums it up.
    pub fn results(&self, variants: &mut [Variant], mut hear: impl FnMut(Event) -> Result<()>) -> Result<Summary> {
        let runs = self.run(variants, &mut hear)?;
        let (all, pairs) = self.summed_up(variants, &runs)?;
        hear(Event::Rows)?;
        let (equal_time, equal_spp) = self.rows(variants, &runs)?;
        Ok(Summary { variants: all, pairs, equal_time, equal_spp })
    }

    /// The figures of runs, one list for each variant, and of each variant against the first.
    pub(super) fn summed_up(
        &self,
        variants: &[Variant],
        runs: &[Vec<Run>],
    ) -> Result<(Vec<VariantResults>, Vec<Pair>)> {
        let mut all = Vec::new();
        for (variant, runs) in variants.iter().zip(runs) {
            let images: Vec<Image> = runs.iter().map(|run| self.image(run)).collect::<Result<_>>()?;
            let bias = squared_bias(&images, &self.truth.image, self.truth.variance.as_ref());
            let floor = Floor {
                relmse: bias.relative,
                deviation: bias.deviation,
                flagged: images.len() > 1 && bias.relative > FLOOR_DEVIATIONS * bias.deviation + self.truth.bias(),
            };
            let pixels = self.truth.image.pixels.len() as f64;
            all.push(figures(variant, runs, floor, pixels, self.truth.deviations()));
        }
        let pairs = all.iter().skip(1).map(|variant| pair(variant, &all[0])).collect();
        Ok((all, pairs))
    }
}

fn last_points(runs: &[Run]) -> Vec<&Point> {
    runs.iter().filter_map(|run| run.points.last()).collect()
}

fn figures(variant: &Variant, runs: &[Run], floor: Floor, pixels: f64, shared: [f64; 2]) -> VariantResults {
    let last = last_points(runs);
    let over = |value: &dyn Fn(&Point) -> f64| last.iter().map(|point| value(point)).collect::<Vec<f64>>();
    let worst_share = last.iter().map(|point| point.worst_share).fold(0.0, f64::max);
    let slope_of = if worst_share > HEAVY_TAIL { Figure::Median } else { Figure::Relmse };
    let slopes: Vec<f64> = runs.iter().filter_map(|run| slope(run, slope_of)).collect();
    let rays: Option<Vec<f64>> =
        runs.iter().zip(&last).map(|(run, point)| run.rays.map(|rays| point.per_second(rays as f64))).collect();
    let estimates: Option<Vec<f64>> =
        last.iter().map(|point| point.estimated_relmse.map(|own| own / point.relmse.max(LEAST_ERROR))).collect();
    let subject = &variant.subject;
    VariantResults {
        name: variant.name.clone(),
        renderer: subject.renderer(),
        technique: variant.technique.clone(),
        backend: variant.backend.clone(),
        options: variant.options.clone(),
        bias: variant.bias.clone(),
        notes: subject.notes(),
        setup: subject.setup(),
        device_bytes: subject.device_bytes(),
        curve: curve(runs, shared),
        efficiency: Interval::geometric(&over(&Point::efficiency)),
        trimmed_efficiency: Interval::geometric(&over(&|point| point.efficiency_by(Figure::Trimmed))),
        parts_efficiency: Interval::geometric(&over(&|point| point.efficiency_by(Figure::Parts))),
        median_efficiency: Interval::geometric(&over(&|point| point.efficiency_by(Figure::Median))),
        worst_share,
        slope: Interval::of(&slopes),
        slope_of,
        floor,
        energy_ratio: Interval::of(&over(&|point| point.energy_ratio)),
        estimate_ratio: estimates.map(|values| Interval::geometric(&values)),
        samples_per_s: Interval::geometric(&over(&|point| point.per_second(point.spp as f64 * pixels))),
        rays_per_s: rays.map(|values| Interval::geometric(&values)),
        runs: runs.to_vec(),
    }
}

/// The slope of a run's log error over log time, over the later half of its octaves: the first frames are overhead.
fn slope(run: &Run, of: Figure) -> Option<f64> {
    let end = run.points.last()?.spp as f64;
    let late = run.points.iter().filter(|point| point.spp as f64 >= end.sqrt());
    log_slope(late.map(|point| (point.seconds, point.error(of))))
}

/// Means over the seeds, at each number of samples that all runs were looked at, and at their ends.
fn curve(runs: &[Run], shared: [f64; 2]) -> Vec<CurvePoint> {
    let Some(first) = runs.first() else { return Vec::new() };
    let on_the_way = |run: &Run| run.points.len().saturating_sub(1);
    let mut columns: Vec<Vec<&Point>> = (0..on_the_way(first))
        .filter_map(|index| {
            let spp = first.points[index].spp;
            runs.iter().map(|run| run.points[..on_the_way(run)].iter().find(|point| point.spp == spp)).collect()
        })
        .collect();
    columns.push(last_points(runs));
    columns.iter().filter(|column| !column.is_empty()).map(|column| mean_point(column, shared)).collect()
}

fn mean_point(points: &[&Point], [of_mse, of_relmse]: [f64; 2]) -> CurvePoint {
    let over = |value: fn(&Point) -> f64| Interval::of(&points.iter().map(|point| value(point)).collect::<Vec<f64>>());
    let device: Option<Vec<f64>> = points.iter().map(|point| point.device_seconds).collect();
    CurvePoint {
        spp: over(|point| point.spp as f64).mean,
        seconds: over(|point| point.seconds),
        device_seconds: device.map(|values| Interval::of(&values)),
        relmse: over(|point| point.relmse).widened(of_relmse),
        trimmed_relmse: over(|point| point.trimmed_relmse),
        parts_relmse: over(|point| point.parts_relmse),
        median_relmse: over(|point| point.median_relmse),
        mse: over(|point| point.mse).widened(of_mse),
        mape: over(|point| point.mape),
        flip: over(|point| point.flip),
    }
}

/// Two variants. Runs of one seed count as independent where the techniques differ, as these draw different numbers.
fn pair(variant: &VariantResults, against: &VariantResults) -> Pair {
    let ends = |variant: &VariantResults, value: &dyn Fn(&Point) -> f64| -> Vec<f64> {
        last_points(&variant.runs).into_iter().map(value).collect()
    };
    // The same technique draws the same numbers for the same seed, whatever traces its rays.
    let is_paired = variant.technique == against.technique && variant.runs.len() == against.runs.len();
    let ratio = |value: &dyn Fn(&Point) -> f64| Ratio::of(&ends(against, value), &ends(variant, value), is_paired);
    let by = |figure: Figure| ratio(&|point| point.efficiency_by(figure));
    let (efficiency, parts, trimmed) = (by(Figure::Relmse), by(Figure::Parts), by(Figure::Trimmed));
    let is_heavy = variant.worst_share.max(against.worst_share) > HEAVY_TAIL;
    // How much better a technique is that lacks rare samples, they tell; whether it is, all other pixels do.
    let alike = (parts.ratio.mean > 1.0) == (trimmed.ratio.mean > 1.0);
    let (decided_by, tested_by, significant) = if is_heavy {
        (Figure::Parts, Figure::Trimmed, trimmed.significant && alike)
    } else {
        (Figure::Relmse, Figure::Relmse, efficiency.significant)
    };
    Pair {
        variant: variant.name.clone(),
        against: against.name.clone(),
        efficiency,
        trimmed,
        parts,
        median: by(Figure::Median),
        speed_ratio: ratio(&|point| point.per_second(point.spp as f64)).ratio,
        decided_by,
        tested_by,
        significant,
    }
}

impl Ratio {
    /// Of two sets of figures, the second over the first: seed by seed, or independent of each other.
    fn of(against: &[f64], own: &[f64], is_paired: bool) -> Self {
        let pairs: Vec<f64> = own.iter().zip(against).map(|(own, against)| own / against).collect();
        let interval = |confidence: f64| {
            if is_paired {
                Interval::geometric_with(&pairs, confidence)
            } else {
                Interval::ratio(against, own, confidence)
            }
        };
        let significant = own.len() > 1 && against.len() > 1 && !interval(1.0 - SIGNIFICANCE).contains(1.0);
        Self { ratio: interval(CONFIDENCE), significant }
    }
}
