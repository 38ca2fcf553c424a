//! Means over few independent runs, with intervals that say how sure they are, and tests of what differs.

use serde::{Deserialize, Serialize};

use super::significance::two_sided_p;

/// Confidence of the intervals that are reported.
pub const CONFIDENCE: f64 = 0.95;
/// Level of the tests that say "significant": so strict that an A/A comparison seldom does.
pub const SIGNIFICANCE: f64 = 0.01;
/// Degrees of freedom up to which probabilities are summed up exactly.
const EXACT_FREEDOM: u32 = 200;
/// Deviations of a normal variable within which it lies with [`CONFIDENCE`].
const NORMAL_REACH: f64 = 1.959_964;

/// A mean with its confidence interval.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Interval {
    /// The estimate.
    pub mean: f64,
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

impl Interval {
    /// The mean of independent values with Student's interval around it. Of one value there is no interval: both ends are it.
    pub fn of(values: &[f64]) -> Self {
        Self::with_confidence(values, CONFIDENCE)
    }

    /// The mean of independent values with Student's interval of this confidence (0 to 1) around it. Of one value both ends are it.
    pub fn with_confidence(values: &[f64], confidence: f64) -> Self {
        let n = values.len();
        let mean = values.iter().sum::<f64>() / n.max(1) as f64;
        if n < 2 {
            return Self { mean, low: mean, high: mean };
        }
        let variance = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / (n - 1) as f64;
        let reach = student_quantile(0.5 + 0.5 * confidence, (n - 1) as u32) * (variance / n as f64).sqrt();
        Self { mean, low: mean - reach, high: mean + reach }
    }

    /// The geometric mean of positive values with its interval: what ratios and efficiencies are averaged by.
    pub fn geometric(values: &[f64]) -> Self {
        Self::geometric_with(values, CONFIDENCE)
    }

    /// The geometric mean of positive values with its interval of this confidence (0 to 1).
    pub fn geometric_with(values: &[f64], confidence: f64) -> Self {
        let logs: Vec<f64> = values.iter().map(|value| value.max(f64::MIN_POSITIVE).ln()).collect();
        let Self { mean, low, high } = Self::with_confidence(&logs, confidence);
        Self { mean: mean.exp(), low: low.exp(), high: high.exp() }
    }

    /// The ratio of the geometric means of two independent sets of positive values, the second over the first, with Welch's interval of the
    /// difference of their logarithms (Welch 1947).
    pub fn ratio(old: &[f64], new: &[f64], confidence: f64) -> Self {
        let moments = |values: &[f64]| {
            let logs: Vec<f64> = values.iter().map(|value| value.max(f64::MIN_POSITIVE).ln()).collect();
            let n = logs.len() as f64;
            let mean = logs.iter().sum::<f64>() / n.max(1.0);
            let variance = logs.iter().map(|log| (log - mean).powi(2)).sum::<f64>() / (n - 1.0).max(1.0);
            (mean, variance / n.max(1.0), (n - 1.0).max(1.0))
        };
        let ((a, va, fa), (b, vb, fb)) = (moments(old), moments(new));
        let both = va + vb;
        let freedom = if both > 0.0 { both * both / (va * va / fa + vb * vb / fb) } else { 1.0 };
        let reach = student_quantile(0.5 + 0.5 * confidence, freedom.floor().max(1.0) as u32) * both.sqrt();
        let difference = b - a;
        Self { mean: difference.exp(), low: (difference - reach).exp(), high: (difference + reach).exp() }
    }

    /// The interval once an independent normal error of this standard deviation, which all values share, is added.
    #[must_use]
    pub fn widened(self, deviation: f64) -> Self {
        let reach = |end: f64| (end - self.mean).hypot(NORMAL_REACH * deviation);
        Self { mean: self.mean, low: self.mean - reach(self.low), high: self.mean + reach(self.high) }
    }

    /// Whether a value lies within.
    pub fn contains(&self, value: f64) -> bool {
        (self.low..=self.high).contains(&value)
    }
}

/// Quantile of Student's t distribution with `freedom` degrees of freedom (at least 1), by bisection of its distribution
/// function, which is exact for whole degrees (Abramowitz and Stegun 1964, 26.7.3 and 26.7.4).
pub fn student_quantile(p: f64, freedom: u32) -> f64 {
    if p < 0.5 {
        return -student_quantile(1.0 - p, freedom);
    }
    let (mut low, mut high) = (0.0, 2.0);
    while student_below(high, freedom) < p && high < 1e12 {
        high *= 2.0;
    }
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if student_below(middle, freedom) < p { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// Probability that a t-distributed variable is at least as far from 0 as `t`.
pub fn student_two_sided(t: f64, freedom: u32) -> f64 {
    if freedom <= EXACT_FREEDOM {
        return 2.0 * (1.0 - student_below(t.abs(), freedom));
    }
    // As many terms as degrees of freedom are too many: the normal variable that is about as improbable (Abramowitz and Stegun 1964, 26.7.8).
    let f = f64::from(freedom);
    two_sided_p(t * (1.0 - 0.25 / f) / (1.0 + 0.5 * t * t / f).sqrt())
}

/// Probability that a t-distributed variable lies below t >= 0.
fn student_below(t: f64, freedom: u32) -> f64 {
    let n = f64::from(freedom);
    let theta = (t / n.sqrt()).atan();
    let cos2 = theta.cos().powi(2);
    // Probability of |variable| < t.
    let within = if freedom % 2 == 1 {
        let (mut term, mut sum) = (theta.cos(), 0.0);
        let mut k = 1;
        while k < freedom {
            sum += term;
            k += 2;
            term *= cos2 * f64::from(k - 1) / f64::from(k);
        }
        2.0 / std::f64::consts::PI * (theta + theta.sin() * sum)
    } else {
        let (mut term, mut sum) = (1.0, 0.0);
        let mut k = 0;
        while k < freedom {
            sum += term;
            k += 2;
            term *= cos2 * f64::from(k - 1) / f64::from(k);
        }
        theta.sin() * sum
    };
    0.5 + 0.5 * within
}

/// The slope of log y over log x by least squares; nothing below two points with positive values.
pub fn log_slope(points: impl Iterator<Item = (f64, f64)>) -> Option<f64> {
    let logs: Vec<(f64, f64)> = points.filter(|(x, y)| *x > 0.0 && *y > 0.0).map(|(x, y)| (x.ln(), y.ln())).collect();
    let n = logs.len() as f64;
    let (mx, my) = (logs.iter().map(|p| p.0).sum::<f64>() / n, logs.iter().map(|p| p.1).sum::<f64>() / n);
    let spread: f64 = logs.iter().map(|(x, _)| (x - mx).powi(2)).sum();
    (logs.len() >= 2 && spread > 0.0).then(|| logs.iter().map(|(x, y)| (x - mx) * (y - my)).sum::<f64>() / spread)
}

/// What `y` is at `x` on the way from point to point, straight in logarithms; nothing outside of the points.
pub fn log_interpolate(points: &[(f64, f64)], x: f64) -> Option<f64> {
    points.windows(2).find(|pair| (pair[0].0..=pair[1].0).contains(&x)).map(|pair| {
        let [(x0, y0), (x1, y1)] = [pair[0], pair[1]];
        if x1 <= x0 || y0 <= 0.0 || y1 <= 0.0 {
            return y1;
        }
        let t = (x / x0).ln() / (x1 / x0).ln();
        (y0.ln() * (1.0 - t) + y1.ln() * t).exp()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_of_student() {
        // Abramowitz and Stegun 1964, table 26.10.
        for (p, freedom, t) in [
            (0.975, 1, 12.706),
            (0.975, 2, 4.303),
            (0.975, 3, 3.182),
            (0.975, 4, 2.776),
            (0.975, 9, 2.262),
            (0.995, 4, 4.604),
            (0.995, 30, 2.750),
            (0.95, 120, 1.658),
        ] {
            let found = student_quantile(p, freedom);
            assert!((found - t).abs() < 6e-4, "t({p}, {freedom}) is {t}, not {found}");
            assert!((student_quantile(1.0 - p, freedom) + found).abs() < 1e-9);
        }
    }

    #[test]
    fn two_sided_probabilities_of_student() {
        for (p, freedom) in [(0.05, 1), (0.01, 4), (1e-5, 15), (1e-6, 30)] {
            let found = student_two_sided(-student_quantile(1.0 - 0.5 * p, freedom), freedom);
            assert!((found / p - 1.0).abs() < 1e-3, "{p}, {freedom}: {found}");
        }
        // Where the approximation takes over.
        for t in [1.0, 4.0, 6.0] {
            let (exact, near) = (student_two_sided(t, EXACT_FREEDOM), student_two_sided(t, EXACT_FREEDOM + 1));
            assert!((near / exact - 1.0).abs() < 0.05, "{t}: {near:e} after {exact:e}");
        }
    }

    #[test]
    fn slopes_and_interpolation() {
        let curve = [(1.0, 8.0), (2.0, 4.0), (4.0, 2.0)];
        assert!((log_slope(curve.into_iter()).unwrap() + 1.0).abs() < 1e-12);
        assert!(log_slope([(1.0, 2.0)].into_iter()).is_none());
        assert!((log_interpolate(&curve, 3.0).unwrap() - 8.0 / 3.0).abs() < 1e-12);
        assert!(log_interpolate(&curve, 5.0).is_none());
    }
}
