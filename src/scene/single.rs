//! The range of a scene's numbers. Files give them in double precision, and the device takes them in single precision: a finite number that is too
//! large would become infinite there, and what is computed from it no number at all.

/// The range, for messages.
pub(in crate::scene) const RANGE: &str = "numbers must lie in -3.4e38 to 3.4e38";

/// Whether single precision holds this as a finite number.
pub(in crate::scene) fn fits(value: f64) -> bool {
    (value as f32).is_finite()
}

/// Fails where single precision does not hold all of these as finite numbers; the message names the first that it does not.
pub(in crate::scene) fn check(values: impl IntoIterator<Item = f64>) -> Result<(), String> {
    match values.into_iter().find(|value| !fits(*value)) {
        Some(value) => Err(format!("{value:?} is out of range: {RANGE}")),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_range_is_that_of_single_precision() {
        let most = f64::from(f32::MAX);
        assert!(check([0.0, -0.0, most, -most, 1e-300]).is_ok());
        // What rounds to the largest number is that number.
        assert!(fits(3.402_823_47e38) && !fits(3.41e38));
        for bad in [1e39, -1e300, f64::INFINITY, f64::NAN] {
            assert!(!fits(bad), "{bad}");
        }
        assert_eq!(check([1.0, 1e39, 2e39]), Err(format!("1e39 is out of range: {RANGE}")));
    }
}
