//! Errors of an image against a reference whose own noise is known.

use super::results::Point;
use super::subject::Snapshot;
use crate::error::Result;
use crate::image::metrics::compare;
use crate::image::metrics::pixels::pixel_errors;
use crate::reference::Truth;

impl Truth {
    /// The figures of a snapshot. The reference's own noise is taken off MSE and relMSE: the expectation of (a - b)² is the
    /// error of a and the variance of b.
    pub fn point(&self, snapshot: &Snapshot) -> Result<Point> {
        let found = compare(&snapshot.image, &self.image)?;
        let pixels = pixel_errors(&snapshot.image, &self.image, self.variance.as_ref(), self.noise.as_ref());
        let [mse, relmse] = self.noise_of_errors();
        Ok(Point {
            spp: snapshot.spp.round() as u64,
            seconds: snapshot.seconds,
            device_seconds: snapshot.device_seconds,
            mse: found.mse - mse,
            relmse: found.relmse - relmse,
            trimmed_relmse: pixels.trimmed,
            parts_relmse: pixels.of_parts,
            median_relmse: pixels.median,
            worst_share: pixels.worst_share,
            mape: found.mape,
            flip: found.flip,
            energy_ratio: found.energy_ratio,
            estimated_relmse: snapshot.estimated_relmse,
        })
    }
}
