//! Tests of whether two estimates can have the same mean.

/// Probability that a standard normal variable exceeds |z| in magnitude (two-sided p-value).
pub fn two_sided_p(z: f64) -> f64 {
    erfc(z.abs() / std::f64::consts::SQRT_2)
}

/// The |z| that a standard normal variable exceeds with this probability, to within 20 / 2^60.
pub fn two_sided_z(p: f64) -> f64 {
    let (mut low, mut high) = (0.0, 20.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if two_sided_p(middle) > p { low = middle } else { high = middle }
    }
    high
}

/// Complementary error function (Numerical Recipes, third edition, section 6.2.2: relative error below 1.2e-7).
fn erfc(x: f64) -> f64 {
    let t = 2.0 / (2.0 + x.abs());
    let series = [
        -1.265_512_23,
        1.000_023_68,
        0.374_091_96,
        0.096_784_18,
        -0.186_288_06,
        0.278_868_07,
        -1.135_203_98,
        1.488_515_87,
        -0.822_152_23,
        0.170_872_77,
    ];
    let polynomial = series.iter().rev().fold(0.0, |sum, coefficient| sum * t + coefficient);
    let value = t * (-x * x + polynomial).exp();
    if x >= 0.0 { value } else { 2.0 - value }
}

/// The significance of one of `count` tests so that all of them together have significance `alpha` (Sidak 1967).
pub fn sidak(alpha: f64, count: usize) -> f64 {
    1.0 - (1.0 - alpha).powf(1.0 / count.max(1) as f64)
}

/// The mean of some values and the variance of that mean.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Estimate {
    /// The mean.
    pub mean: f64,
    /// Its variance.
    pub variance: f64,
}

impl Estimate {
    /// From independent values.
    pub fn of(values: &[f64]) -> Self {
        let n = values.len() as f64;
        let mean = values.iter().sum::<f64>() / n;
        let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
        Self { mean, variance: squares / (n * (n - 1.0).max(1.0)) }
    }

    /// How many standard deviations the two means are apart (Welch's statistic).
    pub fn z(&self, other: &Self) -> f64 {
        let difference = self.mean - other.mean;
        if difference == 0.0 { 0.0 } else { difference / (self.variance + other.variance).sqrt() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn p_values_of_the_normal_distribution() {
        for (z, p) in [(0.0, 1.0), (1.0, 0.317_310_5), (1.96, 0.049_995_8), (3.0, 0.002_699_8), (6.0, 1.973_2e-9)] {
            assert!((two_sided_p(z) / p - 1.0).abs() < 1e-4, "{z}: {}", two_sided_p(z));
            assert!((two_sided_z(p) - z).abs() < 1e-3, "{p}: {}", two_sided_z(p));
        }
    }

    #[test]
    fn sidak_of_one_test_is_the_significance() {
        assert!((sidak(0.01, 1) - 0.01).abs() < 1e-12);
        assert!((sidak(0.01, 1000) - 1.005e-5).abs() < 1e-7);
    }
}
