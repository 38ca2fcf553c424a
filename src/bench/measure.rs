//! Errors of an image against a reference whose own noise is known.

use super::results::Point;
use super::subject::Snapshot;
use crate::error::Result;
use crate::film::Image;
use crate::metrics::{RELATIVE_FLOOR, compare};

/// The image that stands for the truth, with the variance of each of its pixels where that is known.
#[derive(Clone, Debug)]
pub struct Truth {
    /// The image.
    pub image: Image,
    /// Variance of its pixels.
    pub variance: Option<Image>,
    /// Mean of that variance: what it adds to the MSE of any image that is compared with it.
    mse: f64,
    /// The same as a relMSE.
    relmse: f64,
    /// Standard deviations of what is left of both once their expectations are taken off: an error that all runs share.
    deviations: [f64; 2],
}

impl Truth {
    /// An image with the variance of its pixels, which must be of the same size.
    pub fn new(image: Image, variance: Option<Image>) -> Self {
        let (mut mse, mut relmse, mut variances) = (0.0, 0.0, [0.0; 2]);
        if let Some(variance) = &variance {
            for (b, w) in image.pixels.iter().flatten().zip(variance.pixels.iter().flatten()) {
                let (w, scale) = (f64::from(*w), 1.0 / (f64::from(*b).powi(2) + RELATIVE_FLOOR));
                mse += w;
                relmse += w * scale;
                // The square of a normal variable of variance w has the variance 2 w².
                variances = [variances[0] + 2.0 * w * w, variances[1] + 2.0 * (w * scale).powi(2)];
            }
        }
        let count = (3 * image.pixels.len()).max(1) as f64;
        let deviations = variances.map(|variance| variance.sqrt() / count);
        Self { image, variance, mse: mse / count, relmse: relmse / count, deviations }
    }

    /// Its own noise as a relMSE, where its variance is known.
    pub fn relmse(&self) -> Option<f64> {
        self.variance.as_ref().map(|_| self.relmse)
    }

    /// Standard deviations that the reference's noise gives to all MSEs and relMSEs alike.
    pub fn deviations(&self) -> [f64; 2] {
        self.deviations
    }

    /// The figures of a snapshot. The reference's own noise is taken off MSE and relMSE: the expectation of (a - b)² is the
    /// error of a and the variance of b.
    pub fn point(&self, snapshot: &Snapshot) -> Result<Point> {
        let found = compare(&snapshot.image, &self.image)?;
        Ok(Point {
            spp: snapshot.spp.round() as u64,
            seconds: snapshot.seconds,
            device_seconds: snapshot.device_seconds,
            mse: found.mse - self.mse,
            relmse: found.relmse - self.relmse,
            mape: found.mape,
            flip: found.flip,
            energy_ratio: found.energy_ratio,
            estimated_relmse: snapshot.estimated_relmse,
        })
    }
}
