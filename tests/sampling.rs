//! Random numbers and sampling maps, through the shaders' own functions.

use crate::common::sampling::{Mapped, random, random_from};
use crate::common::with_gpu;
use glam::Vec3;
use lumbre::layout::RandomQuery;
use lumbre::techniques::Sampler;

/// The first 2^m samples of each half of a pixel's, those of even and of odd index, are a (0, m, 2)-net in each pair of numbers (Niederreiter
/// 1992, definition 4.1): every rectangle of area 2^-m whose sides are powers of two, at a multiple of them, holds exactly one. No two pairs
/// are the same, nor are those of the halves.
#[test]
fn sobol_pairs_are_nets() {
    const LARGEST: u32 = 10;
    let mut queries = Vec::new();
    for (pixel, dimension, seed) in [(0, 0, 0), (1, 0, 0), (77, 3, 0), (77, 4, 9), (1 << 20, 513, u32::MAX)] {
        for half in 0..2 {
            let samples = (0..1 << LARGEST).map(|index| 2 * index + half);
            queries.extend(samples.map(|sample_index| RandomQuery { pixel, sample_index, dimension, seed }));
        }
    }
    with_gpu(|gpu| {
        let rows = random_from(gpu, Sampler::Sobol, &queries);
        let mut first = Vec::new();
        for points in rows.chunks(1 << LARGEST) {
            for pair in [0, 2] {
                for m in 0..=LARGEST {
                    for across in 0..=m {
                        let mut taken = vec![false; 1 << m];
                        for point in &points[..1 << m] {
                            let column = (point[pair] * (1u32 << across) as f32) as usize;
                            let row = (point[pair + 1] * (1u32 << (m - across)) as f32) as usize;
                            let cell = column << (m - across) | row;
                            assert!(!std::mem::replace(&mut taken[cell], true), "2^{m} points, 2^{across} columns");
                        }
                    }
                }
                first.push((points[0][pair].to_bits(), points[0][pair + 1].to_bits()));
            }
        }
        first.sort_unstable();
        first.dedup();
        assert_eq!(first.len(), 20, "pairs are scrambled alike");
    });
}

#[test]
fn maps_have_the_moments_of_their_shapes() {
    let queries: Vec<RandomQuery> = (0..1 << 18).map(|pixel| RandomQuery { pixel, ..RandomQuery::default() }).collect();
    with_gpu(|gpu| {
        let rows = random(gpu, &queries);
        let n = rows.len() as f64;
        let check = |name: &str, expected: f64, deviation: f64, value: &dyn Fn(&Mapped) -> f64| {
            let mean = rows.iter().map(value).sum::<f64>() / n;
            assert!((mean - expected).abs() < 4.0 * deviation / n.sqrt(), "{name}: {mean} against {expected}");
        };
        let at = |row: &Mapped, index: usize| f64::from(row[index]);
        // A uniform disk: E x^2 = 1/4, E r^4 = 1/3. A cosine hemisphere: E z = 2/3, E z^2 = 1/2. A sphere: E z^2 = 1/3.
        // A triangle: E b = 1/3, E b^2 = 1/6, E b1 b2 = 1/12.
        check("disk x", 0.0, 0.5, &|row| at(row, 4));
        check("disk x^2", 0.25, 0.25, &|row| at(row, 4).powi(2));
        check("disk r^4", 1.0 / 3.0, 0.3, &|row| (at(row, 4).powi(2) + at(row, 5).powi(2)).powi(2));
        check("hemisphere z", 2.0 / 3.0, 0.236, &|row| at(row, 8));
        check("hemisphere z^2", 0.5, 0.289, &|row| at(row, 8).powi(2));
        check("sphere z^2", 1.0 / 3.0, 0.3, &|row| at(row, 11).powi(2));
        check("sphere x y", 0.0, 0.26, &|row| at(row, 9) * at(row, 10));
        check("triangle b1", 1.0 / 3.0, 0.236, &|row| at(row, 12));
        check("triangle b1^2", 1.0 / 6.0, 0.2, &|row| at(row, 12).powi(2));
        check("triangle b1 b2", 1.0 / 12.0, 0.08, &|row| at(row, 12) * at(row, 13));
        for row in &rows {
            let [hemisphere, sphere] = [6, 9].map(|index| Vec3::new(row[index], row[index + 1], row[index + 2]));
            assert!((hemisphere.length() - 1.0).abs() < 1e-6 && hemisphere.z >= 0.0, "{hemisphere}");
            assert!((sphere.length() - 1.0).abs() < 1e-6, "{sphere}");
            assert!(row[12] >= 0.0 && row[13] >= 0.0 && row[12] + row[13] <= 1.0 + 1e-6);
        }
    });
}
