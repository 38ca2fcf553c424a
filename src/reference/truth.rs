//! The image that stands for the truth.

use super::certificate::Certificate;
use crate::image::Image;
use crate::image::metrics::RELATIVE_FLOOR;

/// The image that stands for the truth, with the variance of each of its pixels where that is known.
#[derive(Clone, Debug)]
pub struct Truth {
    /// The image.
    pub image: Image,
    /// Variance of its pixels.
    pub variance: Option<Image>,
    /// An error of the kind that it has, from two halves of what it is made of; see [`crate::reference::Series::noise`].
    pub noise: Option<Image>,
    /// What is known of it besides.
    pub certificate: Option<Certificate>,
    /// Where its witness differs: red where that is brighter, blue where it is darker, by deviations of tiles of 4 x 4 pixels; full colour
    /// is 6.
    pub difference_map: Option<Image>,
    /// Mean of the variance of its pixels: what it adds to the MSE of any image that is compared with it.
    mse: f64,
    /// What its variance adds to the relMSE of any image that is compared with it.
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
        Self {
            image,
            variance,
            noise: None,
            certificate: None,
            difference_map: None,
            mse: mse / count,
            relmse: relmse / count,
            deviations,
        }
    }

    /// This image with what is known of it. How uncertain its own error is says how uncertain the noise is that is taken off; a blur of
    /// it stays in all errors.
    #[must_use]
    pub fn certified(mut self, certificate: Certificate) -> Self {
        let error = &certificate.error;
        let relative = (0.5 * (error.relmse.high - error.relmse.low) / 1.96 / error.relmse.mean).clamp(0.0, 1.0);
        let uncertain = if relative.is_finite() { relative * self.relmse } else { 0.0 };
        self.deviations[1] = self.deviations[1].max(uncertain).hypot(error.bias);
        self.certificate = Some(certificate);
        self
    }

    /// This image with an error of the kind that it has.
    #[must_use]
    pub fn with_noise(mut self, noise: Option<Image>) -> Self {
        self.noise = noise;
        self
    }

    /// This image with a picture of where its witness differs.
    #[must_use]
    pub fn with_difference_map(mut self, map: Option<Image>) -> Self {
        self.difference_map = map;
        self
    }

    /// Its own noise as a relMSE, where its variance is known.
    pub fn relmse(&self) -> Option<f64> {
        self.variance.as_ref().map(|_| self.relmse)
    }

    /// What its own noise adds to the MSE and to the relMSE of any image that is compared with it; 0 where it is not known.
    pub fn noise_of_errors(&self) -> [f64; 2] {
        [self.mse, self.relmse]
    }

    /// Standard deviations that the reference's own error gives to all MSEs and relMSEs alike.
    pub fn deviations(&self) -> [f64; 2] {
        self.deviations
    }

    /// relMSE of the blur that it may have.
    pub fn bias(&self) -> f64 {
        self.certificate.as_ref().map_or(0.0, |certificate| certificate.error.bias)
    }

    /// Why figures against it are not to be trusted, in one sentence; nothing where another technique confirmed it.
    pub fn doubt(&self) -> Option<String> {
        match &self.certificate {
            Some(certificate) => certificate.doubt(),
            None => Some(String::from("nothing is known of how it was made, and nothing checked it")),
        }
    }
}
