//! Numbers as people read them: three significant digits, powers of ten where there would be many zeros.

use crate::statistics::Interval;

/// What stands where there is no number.
const NONE: &str = "–";
/// Powers of ten that are written out.
const PLAIN: std::ops::Range<i32> = -3..4;

/// Powers of ten by which the end of an interval may exceed the mean and still be written in the same one.
const FAR: i32 = 2;

/// A number of three significant digits.
pub fn figure(value: f64) -> String {
    if let Some(text) = special(value) {
        return text;
    }
    let exponent = exponent_of(value);
    if PLAIN.contains(&exponent) {
        fixed(value, (2 - exponent).max(0))
    } else {
        format!("{}·{}", fixed(value / 10f64.powi(exponent), 2), power_of_ten(exponent))
    }
}

/// The mean of an interval, and its ends in brackets unless both are the mean.
pub fn interval(interval: &Interval) -> (String, Option<String>) {
    let Interval { mean, low, high } = *interval;
    if !has_ends(interval) {
        return (figure(mean), None);
    }
    // Both ends in the mean's power of ten: they are read against it. One that is far above would have many digits there.
    let exponent = if mean == 0.0 { exponent_of(high - low) } else { exponent_of(mean) };
    if high.is_finite() && exponent_of(high) > exponent + FAR {
        return (figure(mean), Some(format!("[{}, {}]", figure(low), figure(high))));
    }
    let ends = if PLAIN.contains(&exponent) {
        let decimals = (2 - exponent).max(0);
        let end = |value: f64| special(value).unwrap_or_else(|| fixed(value, decimals));
        format!("[{}, {}]", end(low), end(high))
    } else {
        let scale = 10f64.powi(exponent);
        let end = |value: f64| special(value).unwrap_or_else(|| fixed(value / scale, 2));
        format!("[{}, {}]·{}", end(low), end(high), power_of_ten(exponent))
    };
    (figure(mean), Some(ends))
}

/// Whether there is more to an interval than its mean.
fn has_ends(Interval { mean, low, high }: &Interval) -> bool {
    let is_point = low == mean && high == mean;
    mean.is_finite() && !is_point && !low.is_nan() && !high.is_nan()
}

/// The mean and the ends of an interval with a fixed number of decimals, for figures near 1.
pub fn interval_fixed(interval: &Interval, decimals: i32) -> (String, Option<String>) {
    let Interval { mean, low, high } = *interval;
    let text = |value: f64| if value.is_finite() { fixed(value, decimals) } else { figure(value) };
    (text(mean), has_ends(interval).then(|| format!("[{}, {}]", text(low), text(high))))
}

/// An interval on one line.
pub fn interval_line(value: &Interval) -> String {
    match interval(value) {
        (mean, Some(ends)) => format!("{mean} {ends}"),
        (mean, None) => mean,
    }
}

/// A number without needless zeros: 95, 99.9.
pub fn trimmed(value: f64) -> String {
    special(value).unwrap_or_else(|| ((value * 1000.0).round() / 1000.0).to_string())
}

/// An interval in other units.
pub fn scaled(interval: &Interval, factor: f64) -> Interval {
    Interval { mean: interval.mean * factor, low: interval.low * factor, high: interval.high * factor }
}

/// The label of a tick at `digit` times ten to the power of `exponent`.
pub fn tick(digit: u32, exponent: i32) -> String {
    match (PLAIN.contains(&exponent), digit) {
        (true, _) => format!("{:.*}", (-exponent).max(0) as usize, f64::from(digit) * 10f64.powi(exponent)),
        (false, 1) => power_of_ten(exponent),
        (false, _) => format!("{digit}·{}", power_of_ten(exponent)),
    }
}

/// A whole number with thin spaces between thousands.
pub fn whole(value: u64) -> String {
    let digits = value.to_string();
    let mut text = String::new();
    for (index, digit) in digits.chars().enumerate() {
        if index > 0 && (digits.len() - index).is_multiple_of(3) {
            text.push('\u{202f}');
        }
        text.push(digit);
    }
    text
}

/// Samples per pixel: whole where they are, else of three significant digits.
pub fn samples(value: f64) -> String {
    if value.is_finite() && value >= 0.0 && (value.fract() == 0.0 || value >= 100.0) {
        whole(value.round() as u64)
    } else {
        figure(value)
    }
}

fn special(value: f64) -> Option<String> {
    match value {
        value if value.is_nan() => Some(String::from(NONE)),
        0.0 => Some(String::from("0")),
        f64::INFINITY => Some(String::from("∞")),
        f64::NEG_INFINITY => Some(String::from("−∞")),
        _ => None,
    }
}

/// The power of ten of a finite number other than zero, as rounded to three digits.
fn exponent_of(value: f64) -> i32 {
    format!("{value:.2e}").split_once('e').and_then(|(_, exponent)| exponent.parse().ok()).unwrap_or(0)
}

fn fixed(value: f64, decimals: i32) -> String {
    format!("{value:.*}", decimals.max(0) as usize).replace('-', "−")
}

fn power_of_ten(exponent: i32) -> String {
    let raised = |character| match character {
        '-' => '⁻',
        '0' => '⁰',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        '4' => '⁴',
        '5' => '⁵',
        '6' => '⁶',
        '7' => '⁷',
        '8' => '⁸',
        _ => '⁹',
    };
    format!("10{}", exponent.to_string().chars().map(raised).collect::<String>())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_digits() {
        for (value, text) in [
            (0.0, "0"),
            (1.0, "1.00"),
            (0.012345, "0.0123"),
            (0.0099999, "0.0100"),
            (-12.345, "−12.3"),
            (1234.0, "1234"),
            (99_999.0, "1.00·10⁵"),
            (3.21e-7, "3.21·10⁻⁷"),
            (f64::INFINITY, "∞"),
            (f64::NAN, "–"),
        ] {
            assert_eq!(figure(value), text);
        }
        assert_eq!((tick(1, -5), tick(2, -3), tick(5, 2)), ("10⁻⁵".into(), "0.002".into(), "500".into()));
        assert_eq!((whole(999), whole(1_234_567)), ("999".into(), "1\u{202f}234\u{202f}567".into()));
    }

    #[test]
    fn ends_share_the_power_of_ten() {
        let of = |mean, low, high| interval_line(&Interval { mean, low, high });
        assert_eq!(of(2e-5, 9e-6, 3e-5), "2.00·10⁻⁵ [0.90, 3.00]·10⁻⁵");
        assert_eq!(of(0.5, 0.4, 0.6), "0.500 [0.400, 0.600]");
        assert_eq!(of(0.5, 0.5, 0.5), "0.500");
        assert_eq!(of(0.0, -1e-3, 1e-3), "0 [−0.00100, 0.00100]");
        assert_eq!(of(0.536, 1e-6, 341_615.0), "0.536 [1.00·10⁻⁶, 3.42·10⁵]");
        assert_eq!(of(f64::INFINITY, f64::NAN, f64::INFINITY), "∞");
    }
}
