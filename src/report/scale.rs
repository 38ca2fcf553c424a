//! A logarithmic axis: from values to places, and where its ticks stand.

use super::number;
use crate::statistics::Interval;

/// Least ratio of an axis's ends: any such range holds two ticks of 1, 2, 5.
const LEAST_SPAN: f64 = 0.7;
/// How far interval ends may widen an axis beyond the means, in decades.
const WHISKER_ROOM: f64 = 0.5;

/// A logarithmic axis.
#[derive(Clone, Copy, Debug)]
pub struct LogScale {
    /// Decimal logarithms of the ends.
    low: f64,
    high: f64,
    /// Where the ends are drawn.
    from: f64,
    to: f64,
}

/// A line across the chart.
#[derive(Clone, Debug)]
pub struct Tick {
    /// Where.
    pub at: f64,
    /// Its label; lines between labels have none.
    pub label: Option<String>,
}

/// Whether a value has a place on a logarithmic axis.
pub fn drawable(value: f64) -> bool {
    value.is_finite() && value > 0.0
}

impl LogScale {
    /// An axis on which all of the means lie, drawn between two places; nothing where there are none.
    pub fn around<'a>(values: impl Iterator<Item = &'a Interval> + Clone, from: f64, to: f64) -> Option<Self> {
        let means = values.clone().map(|value| value.mean).filter(|mean| drawable(*mean)).map(f64::log10);
        let (low, high) = means.fold((f64::MAX, f64::MIN), |(low, high), log| (low.min(log), high.max(log)));
        if low > high {
            return None;
        }
        let room = low - WHISKER_ROOM..=high + WHISKER_ROOM;
        let ends = values.filter(|value| drawable(value.mean)).flat_map(|value| [value.low, value.high]);
        let logs = ends.filter(|end| drawable(*end)).map(|end| end.log10().clamp(*room.start(), *room.end()));
        let (low, high) = logs.fold((low, high), |(low, high), log| (low.min(log), high.max(log)));
        let margin = 0.04 * (high - low) + 0.5 * (LEAST_SPAN - (high - low)).max(0.0);
        Some(Self { low: low - margin, high: high + margin, from, to })
    }

    /// Whether a value lies between its ends, or at most so many decades beyond them.
    pub fn reaches(&self, value: f64, decades: f64) -> bool {
        drawable(value) && (self.low - decades..=self.high + decades).contains(&value.log10())
    }

    /// This axis with room for one more value.
    pub fn extended(&self, value: f64) -> Self {
        let (log, margin) = (value.log10(), 0.04 * (self.high - self.low));
        if self.reaches(value, 0.0) {
            return *self;
        }
        Self { low: self.low.min(log - margin), high: self.high.max(log + margin), ..*self }
    }

    /// Where a value is drawn; what lies beyond an end is drawn at that end.
    pub fn at(&self, value: f64) -> f64 {
        let log = if value > 0.0 { value.log10() } else { self.low };
        let share = (log - self.low) / (self.high - self.low);
        self.from + share.clamp(0.0, 1.0) * (self.to - self.from)
    }

    /// The values at both ends.
    pub fn ends(&self) -> (f64, f64) {
        (10f64.powf(self.low), 10f64.powf(self.high))
    }

    /// Ticks, with labels at decades; where those are few, at 1, 2 and 5 times a decade; where those are few, at all digits.
    /// Labels keep `distance` from each other.
    pub fn ticks(&self, distance: f64) -> Vec<Tick> {
        let exponents = self.low.floor() as i32..=self.high.floor() as i32;
        let all: Vec<(u32, i32)> = exponents
            .flat_map(|exponent| (1..=9).map(move |digit| (digit, exponent)))
            .filter(|(digit, exponent)| {
                let log = f64::from(*digit).log10() + f64::from(*exponent);
                (self.low - 1e-9..=self.high + 1e-9).contains(&log)
            })
            .collect();
        let count = |rank: u32| all.iter().filter(|(digit, _)| rank_of(*digit) <= rank).count();
        let labelled = (0..2).find(|rank| count(*rank) >= 3).unwrap_or(2);
        // Between many decades, further lines are no help.
        let drawn = if count(0) > 4 { 0 } else { 2 };

        let at = |digit: u32, exponent: i32| self.at(f64::from(digit) * 10f64.powi(exponent));
        let mut labels: Vec<f64> = Vec::new();
        for rank in 0..=labelled {
            for (digit, exponent) in all.iter().filter(|(digit, _)| rank_of(*digit) == rank) {
                let place = at(*digit, *exponent);
                if labels.iter().all(|label| (label - place).abs() >= distance) {
                    labels.push(place);
                }
            }
        }
        let ticks = all.into_iter().filter(|(digit, _)| rank_of(*digit) <= drawn).map(|(digit, exponent)| {
            let at = at(digit, exponent);
            Tick { at, label: labels.contains(&at).then(|| number::tick(digit, exponent)) }
        });
        ticks.collect()
    }
}

/// How soon a tick at this digit is worth a label.
fn rank_of(digit: u32) -> u32 {
    match digit {
        1 => 0,
        2 | 5 => 1,
        _ => 2,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scale(values: &[f64]) -> LogScale {
        let values: Vec<Interval> = values.iter().map(|v| Interval { mean: *v, low: *v, high: *v }).collect();
        LogScale::around(values.iter(), 0.0, 300.0).unwrap()
    }

    #[test]
    fn every_axis_has_labels_with_room_between_them() {
        for (low, high) in [(1.0, 1.0), (0.37, 0.4), (2.1, 9.9), (1e-3, 2e-2), (5.0, 5e3), (1e-9, 1e9), (3e-12, 2e14)] {
            let ticks = scale(&[low, high]).ticks(40.0);
            let labels: Vec<f64> = ticks.iter().filter(|tick| tick.label.is_some()).map(|tick| tick.at).collect();
            assert!((2..=8).contains(&labels.len()), "{low}..{high}: {labels:?}");
            assert!(labels.windows(2).all(|pair| pair[1] - pair[0] >= 40.0), "{low}..{high}: {labels:?}");
            assert!(ticks.iter().all(|tick| (0.0..=300.0).contains(&tick.at)));
        }
        let ticks = scale(&[1.0, 1000.0]).ticks(40.0);
        let labels: Vec<String> = ticks.into_iter().filter_map(|tick| tick.label).collect();
        assert_eq!(labels, ["1", "10", "100", "1000"]);
    }

    #[test]
    fn an_axis_makes_room_for_what_is_near() {
        let axis = scale(&[1.0, 1000.0]);
        for (value, reached) in [(0.3, true), (0.01, false), (9e3, true), (0.0, false), (f64::NAN, false)] {
            assert_eq!(axis.reaches(value, 1.0), reached, "{value}");
            if reached {
                let place = axis.extended(value).at(value);
                assert!(!axis.reaches(value, 0.0) && (1.0..=299.0).contains(&place), "{value} at {place}");
            }
        }
        assert_eq!(axis.extended(10.0).ends(), axis.ends());
    }

    #[test]
    fn values_without_a_place() {
        let of = |mean| Interval { mean, low: f64::NEG_INFINITY, high: f64::NAN };
        assert!(LogScale::around([of(0.0), of(-1.0), of(f64::NAN), of(f64::INFINITY)].iter(), 0.0, 1.0).is_none());
        let scale = LogScale::around([of(0.0), of(1.0)].iter(), 0.0, 1.0).unwrap();
        assert!(scale.at(-1.0) == 0.0 && scale.at(f64::NAN) == 0.0 && scale.at(f64::INFINITY) == 1.0);
    }
}
