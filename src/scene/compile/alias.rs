//! Choosing one of many in proportion to weights, in constant time (Walker 1977, in Vose's order).

/// For each entry, the probability of keeping it once it is drawn uniformly, and the entry to take instead. Weights of zero
/// are never chosen; there must be one that is not.
pub(crate) fn alias_table(weights: &[f64]) -> Vec<(f32, u32)> {
    let sum: f64 = weights.iter().sum();
    let count = weights.len();
    let mut share: Vec<f64> = weights.iter().map(|weight| weight / sum * count as f64).collect();
    let mut table = vec![(1.0, 0); count];
    let (mut small, mut large): (Vec<usize>, Vec<usize>) = (0..count).partition(|index| share[*index] < 1.0);
    while let (Some(lesser), Some(greater)) = (small.last().copied(), large.last().copied()) {
        small.pop();
        table[lesser] = (share[lesser] as f32, greater as u32);
        share[greater] -= 1.0 - share[lesser];
        if share[greater] < 1.0 {
            large.pop();
            small.push(greater);
        }
    }
    // What rounding leaves over has a share of one.
    for rest in small.into_iter().chain(large) {
        table[rest] = (1.0, rest as u32);
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The probability with which the table selects each entry.
    fn selected(table: &[(f32, u32)]) -> Vec<f64> {
        let mut probability = vec![0.0; table.len()];
        for (index, (keep, alias)) in table.iter().enumerate() {
            probability[index] += f64::from(*keep) / table.len() as f64;
            probability[*alias as usize] += (1.0 - f64::from(*keep)) / table.len() as f64;
        }
        probability
    }

    #[test]
    fn entries_are_selected_in_proportion() {
        let skewed = |count: usize| (0..count).map(|index| 1e-3 + (index as f64 * 0.37).sin().powi(8) * 1e4).collect();
        let cases: [Vec<f64>; 5] =
            [vec![3.0], vec![1.0, 5.0, 0.0, 0.25, 3.75, 2.0], vec![1.0; 7], skewed(5), skewed(1000)];
        for weights in cases {
            let sum: f64 = weights.iter().sum();
            for (weight, found) in weights.iter().zip(selected(&alias_table(&weights))) {
                let expected = weight / sum;
                assert!((found - expected).abs() < 1e-6, "{found} against {expected}");
            }
        }
    }
}
