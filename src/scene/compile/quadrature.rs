//! Quadrature rules.

use std::f64::consts::PI;

/// Points of Gauss and Legendre's rule on 0 to 1 with their weights, which sum to 1.
pub fn gauss_legendre(count: usize) -> Vec<(f64, f64)> {
    let n = count as f64;
    (0..count)
        .map(|index| {
            let mut x = (PI * (index as f64 + 0.75) / (n + 0.5)).cos();
            let mut slope = 1.0;
            for _ in 0..8 {
                // Legendre's polynomials by their recurrence; the derivative of the last one gives Newton's step.
                let (mut last, mut value) = (1.0, x);
                for k in 2..=count {
                    let k = k as f64;
                    (last, value) = (value, ((2.0 * k - 1.0) * x * value - (k - 1.0) * last) / k);
                }
                slope = n * (x * value - last) / (x * x - 1.0);
                x -= value / slope;
            }
            (0.5 * (1.0 - x), 1.0 / ((1.0 - x * x) * slope * slope))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Integrates a polynomial of degree 2 n - 1 exactly.
    #[test]
    fn gauss_legendre_is_exact_for_polynomials() {
        for count in [2, 5, 16, 32] {
            let degree = 2 * count - 1;
            let found: f64 = gauss_legendre(count).iter().map(|(x, weight)| weight * x.powi(degree as i32)).sum();
            let expected = 1.0 / (degree + 1) as f64;
            assert!((found / expected - 1.0).abs() < 1e-12, "{count} points: {found} against {expected}");
        }
    }
}
