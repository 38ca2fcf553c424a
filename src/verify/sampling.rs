//! Statistics of random choices: evenly spread numbers, cells of directions, chi-square.

use glam::DVec3;

/// Chi-square statistic of counts against expectations, as a standard normal deviate (Wilson and Hilferty 1931).
pub fn chi_square_z(observed: &[f64], expected: &[f64]) -> f64 {
    // Cells with small expectations are pooled, as the test's asymptotics ask for.
    let (mut pooled, mut cells, mut statistic) = ((0.0, 0.0), 0.0, 0.0);
    for (o, e) in observed.iter().zip(expected) {
        pooled = (pooled.0 + o, pooled.1 + e);
        if pooled.1 >= 10.0 {
            statistic += (pooled.0 - pooled.1).powi(2) / pooled.1;
            cells += 1.0;
            pooled = (0.0, 0.0);
        }
    }
    let freedom: f64 = cells - 1.0;
    ((statistic / freedom).powf(1.0 / 3.0) - (1.0 - 2.0 / (9.0 * freedom))) / (2.0 / (9.0 * freedom)).sqrt()
}

/// Evenly spread points of the unit cube of `N` dimensions (Roberts 2018, the R sequence): what is averaged over them
/// converges faster than over random ones.
pub fn spread<const N: usize>(count: usize) -> Vec<[f32; N]> {
    // The root of x^(N + 1) = x + 1.
    let root = (0..50).fold(1.5f64, |x, _| (1.0 + x).powf(1.0 / (N + 1) as f64));
    let steps: [f64; N] = std::array::from_fn(|axis| root.powi(-(axis as i32 + 1)));
    (0..count)
        .map(|index| steps.map(|step| ((0.5 + (index + 1) as f64 * step).fract() as f32).min(0.999_999_9)))
        .collect()
}

/// A direction by its cosine to +z and azimuth.
pub fn direction(cos_theta: f32, phi: f32) -> [f32; 3] {
    let sin_theta = (1.0 - cos_theta * cos_theta).max(0.0).sqrt();
    [sin_theta * phi.cos(), sin_theta * phi.sin(), cos_theta]
}

/// Cells of directions around an axis: rings that widen in proportion to their angle, cut into sectors, so that peaks along
/// the axis are resolved whatever their width.
pub struct Rings {
    axis: DVec3,
    across: [DVec3; 2],
    edges: Vec<f64>,
    sectors: usize,
}

impl Rings {
    /// Rings up to the angle `last`, the first of which is a disk of angle `first`.
    pub fn new(axis: DVec3, first: f64, last: f64, rings: usize, sectors: usize) -> Self {
        let axis = axis.normalize();
        let (a, b) = axis.any_orthonormal_pair();
        let ratio = (last / first).powf(1.0 / (rings - 1) as f64);
        let mut edges = vec![0.0];
        edges.extend((0..rings).map(|ring| first * ratio.powi(ring as i32)));
        Self { axis, across: [a, b], edges, sectors }
    }

    /// Cells in all.
    pub fn cells(&self) -> usize {
        (self.edges.len() - 1) * self.sectors
    }

    /// The cell that a direction falls into; nothing beyond the last ring.
    pub fn cell(&self, direction: DVec3) -> Option<usize> {
        let [x, y] = self.across.map(|across| across.dot(direction));
        let angle = x.hypot(y).atan2(self.axis.dot(direction));
        let ring = self.edges.partition_point(|edge| *edge <= angle).checked_sub(1)?;
        let sector = y.atan2(x).rem_euclid(std::f64::consts::TAU) / std::f64::consts::TAU * self.sectors as f64;
        (ring + 1 < self.edges.len()).then(|| ring * self.sectors + (sector as usize).min(self.sectors - 1))
    }

    /// Points of a midpoint rule over all cells, `fine` along each side of a cell: direction, solid angle, cell.
    pub fn points(&self, fine: usize) -> Vec<(DVec3, f64, usize)> {
        let mut points = Vec::with_capacity(self.cells() * fine * fine);
        for (ring, edge) in self.edges.windows(2).enumerate() {
            for i in 0..fine {
                let at = |step: f64| {
                    let t = (i as f64 + step) / fine as f64;
                    if ring == 0 { edge[1] * t.sqrt() } else { edge[0] * (edge[1] / edge[0]).powf(t) }
                };
                let (low, angle, high) = (at(0.0), at(0.5), at(1.0));
                let step = std::f64::consts::TAU / (self.sectors * fine) as f64;
                // cos(low) - cos(high), without cancellation.
                let solid_angle = 2.0 * (0.5 * (low + high)).sin() * (0.5 * (high - low)).sin() * step;
                for j in 0..self.sectors * fine {
                    let phi = (j as f64 + 0.5) * step;
                    let around = self.across[0] * phi.cos() + self.across[1] * phi.sin();
                    let direction = self.axis * angle.cos() + around * angle.sin();
                    points.push((direction, solid_angle, ring * self.sectors + j / fine));
                }
            }
        }
        points
    }
}
