//! Statistics: confidence intervals of few runs, and tests of whether two estimates have the same mean.

mod intervals;
#[cfg(test)]
pub(crate) mod random;
mod significance;

pub use intervals::{
    CONFIDENCE, Interval, SIGNIFICANCE, log_interpolate, log_slope, student_quantile, student_two_sided,
};
pub use significance::{Estimate, sidak, two_sided_p, two_sided_z};
