//! Spectra given as samples over wavelength, and their colour in linear sRGB as Mitsuba 3's RGB modes compute it.
//!
//! The samples are joined by straight lines and are zero outside. With the CIE 1931 2-degree observer and its illuminant S,
//! XYZ = c Σ xyz(λ) S(λ) v(λ) Δλ, with c such that the luminance of v = 1 is 1. What reflects, and what is a pure number such
//! as an index of refraction, is seen under D65, so that white stays (1, 1, 1); what emits is seen as it is (S = 1). The sum
//! runs over Mitsuba's 1000 wavelengths from 360 to 830 nm, both ends included, with Δλ a thousandth of the range: it is 0.1%
//! below the integral, here as there.

use std::path::Path;

use crate::error::{Error, Result};
use crate::files::read_text;
use crate::scene::load::limits::SPECTRUM_BYTES;

/// Wavelength of the first entry of the tables, nm.
const FIRST: f64 = 360.0;
/// Wavelength of their last entry, nm.
const LAST: f64 = 830.0;
/// Wavelengths that the sum runs over.
const STEPS: u32 = 1000;
/// One over the integral of y, 1/nm: a uniform spectrum of 1 has luminance 1.
const Y_SCALE: f64 = 1.0 / 106.750_259_4;
/// One over the mean of D65 weighted with y: a reflectance of 1 has luminance 1.
const D65_SCALE: f64 = 1.0 / 98.997_417_5;
/// Linear sRGB from XYZ, row by row (IEC 61966-2-1's primaries and white, in the digits that Mitsuba uses).
const SRGB_FROM_XYZ: [[f64; 3]; 3] =
    [[3.240_479, -1.537_150, -0.498_535], [-0.969_256, 1.875_991, 0.041_556], [0.055_648, -0.204_043, 1.057_311]];

/// CIE illuminant E of luminance 1 in linear sRGB, the colour of a uniform emission spectrum.
pub(super) const EQUAL_ENERGY_WHITE: [f64; 3] = [1.204_794, 0.948_291, 0.908_916];

/// The light that a spectrum is seen under.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Illuminant {
    /// For what emits.
    EqualEnergy,
    /// For what reflects, and for pure numbers.
    D65,
}

/// Values over wavelength, linear between the samples and zero outside.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Spectrum {
    /// Wavelengths in nm, increasing, each with its value; there are two or more.
    samples: Vec<(f64, f64)>,
}

impl Spectrum {
    /// From `wavelength:value` pairs, in nm, separated by commas or spaces. The error says what is wrong.
    pub(super) fn parse(text: &str) -> Result<Self, String> {
        let mut spectrum = Self { samples: Vec::new() };
        for part in text.split([',', ' ', '\t', '\n', '\r']).filter(|part| !part.is_empty()) {
            let pair = part.split_once(':').and_then(|(wavelength, value)| Some((finite(wavelength)?, finite(value)?)));
            let (wavelength, value) =
                pair.ok_or_else(|| format!("'{part}' is not a wavelength:value pair such as 550:0.5"))?;
            spectrum.push(wavelength, value)?;
        }
        spectrum.checked()
    }

    /// From wavelengths in nm and as many values, both separated by commas or spaces.
    pub(super) fn from_lists(wavelengths: &[f64], values: &[f64]) -> Result<Self, String> {
        if wavelengths.len() != values.len() {
            return Err(format!(
                "there are {} wavelengths and {} values: each needs the other",
                wavelengths.len(),
                values.len()
            ));
        }
        let mut spectrum = Self { samples: Vec::new() };
        wavelengths.iter().zip(values).try_for_each(|(wavelength, value)| spectrum.push(*wavelength, *value))?;
        spectrum.checked()
    }

    /// Planck's law: the spectral radiance of a black body at a temperature in kelvin, W/(m² sr nm), between two wavelengths in nm.
    pub(super) fn black_body(temperature: f64, [first, last]: [f64; 2]) -> Result<Self, String> {
        // CODATA 2014: twice Planck's constant times the speed of light squared, W m²; their product over Boltzmann's constant, m K.
        const SCALE: f64 = 2.0 * 6.626_070_04e-34 * 2.997_924_58e8 * 2.997_924_58e8;
        const PER_KELVIN: f64 = 6.626_070_04e-34 * 2.997_924_58e8 / 1.380_648_52e-23;
        let radiance = |nanometres: f64| {
            let metres = nanometres * 1e-9;
            1e-9 * SCALE / (metres.powi(5) * (PER_KELVIN / (metres * temperature)).exp_m1())
        };
        let wavelengths: Vec<f64> = (0..=470).map(|step| first + (last - first) * f64::from(step) / 470.0).collect();
        let values: Vec<f64> = wavelengths.iter().copied().map(radiance).collect();
        Self::from_lists(&wavelengths, &values)
    }

    /// From a file with a wavelength in nm and a value on each line; `#` starts a comment.
    pub(super) fn read(path: &Path) -> Result<Self> {
        let text = read_text(path, SPECTRUM_BYTES)?;
        let mut spectrum = Self { samples: Vec::new() };
        for (index, line) in text.lines().enumerate() {
            let data = line.split('#').next().unwrap_or_default();
            let wrong = |message: String| Error::scene_line(path, index as u32 + 1, message);
            let numbers: Vec<Option<f64>> = data.split_whitespace().map(finite).collect();
            match numbers[..] {
                [] => {}
                [Some(wavelength), Some(value)] => spectrum.push(wavelength, value).map_err(wrong)?,
                _ => return Err(wrong(format!("'{}' is not a wavelength in nm and a value", data.trim()))),
            }
        }
        spectrum.checked().map_err(|message| Error::scene(path, message))
    }

    fn push(&mut self, wavelength: f64, value: f64) -> Result<(), String> {
        if let Some((last, _)) = self.samples.last().filter(|(last, _)| *last >= wavelength) {
            return Err(format!("the wavelength {wavelength} follows {last}: wavelengths must increase"));
        }
        if value < 0.0 {
            return Err(format!("the value {value} at {wavelength} nm is negative"));
        }
        self.samples.push((wavelength, value));
        Ok(())
    }

    fn checked(self) -> Result<Self, String> {
        match self.samples.len() {
            0 | 1 => Err(format!("a spectrum needs two samples or more, and has {}", self.samples.len())),
            _ => Ok(self),
        }
    }

    /// The value at a wavelength in nm.
    fn value(&self, wavelength: f64) -> f64 {
        let next = self.samples.partition_point(|(at, _)| *at <= wavelength);
        match (next.checked_sub(1).and_then(|index| self.samples.get(index)), self.samples.get(next)) {
            (Some((x0, y0)), Some((x1, y1))) => y0 + (y1 - y0) * (wavelength - x0) / (x1 - x0),
            (Some((last, value)), None) if *last == wavelength => *value,
            _ => 0.0,
        }
    }

    /// The colour in linear sRGB. A channel is below 0 where the colour is more saturated than sRGB can be.
    pub(super) fn linear_srgb(&self, illuminant: Illuminant) -> [f64; 3] {
        let mut xyz = [0.0; 3];
        for step in 0..STEPS {
            let wavelength = FIRST + (LAST - FIRST) * f64::from(step) / f64::from(STEPS - 1);
            let light = match illuminant {
                Illuminant::EqualEnergy => 1.0,
                Illuminant::D65 => interpolate(&D65, (wavelength - FIRST) / 10.0) * D65_SCALE,
            };
            let weight = self.value(wavelength) * light * Y_SCALE * (LAST - FIRST) / f64::from(STEPS);
            let at = (wavelength - FIRST) / 5.0;
            for (sum, curve) in xyz.iter_mut().zip([&X_BAR[..], &Y_BAR, &Z_BAR]) {
                *sum += weight * interpolate(curve, at);
            }
        }
        SRGB_FROM_XYZ.map(|row| row.iter().zip(xyz).map(|(factor, value)| factor * value).sum())
    }
}

/// The table at a fractional index; zero beyond its end.
fn interpolate(table: &[f64], at: f64) -> f64 {
    let entry = |index: usize| table.get(index).copied().unwrap_or(0.0);
    let (index, fraction) = (at as usize, at.fract());
    entry(index) * (1.0 - fraction) + entry(index + 1) * fraction
}

fn finite(text: &str) -> Option<f64> {
    text.parse().ok().filter(|value: &f64| value.is_finite())
}

/// The bytes of `#rrggbb` as shares of 255.
pub(super) fn hexadecimal(text: &str) -> Option<[f64; 3]> {
    let hex = text.trim().strip_prefix('#')?;
    let bits = (hex.len() == 6 && hex.bytes().all(|digit| digit.is_ascii_hexdigit())).then_some(hex)?;
    let bits = u32::from_str_radix(bits, 16).ok()?;
    Some([16, 8, 0].map(|shift| f64::from(bits >> shift & 0xff) / 255.0))
}

/// A colour as `#rrggbb` or as three numbers in 0 to 1, both with sRGB's transfer curve, in linear sRGB.
pub(super) fn decode_srgb(text: &str) -> Option<[f64; 3]> {
    let encoded: [f64; 3] = match text.trim().starts_with('#').then(|| hexadecimal(text)) {
        Some(bytes) => bytes?,
        None => {
            let parts = text.split([',', ' ', '\t', '\n', '\r']).filter(|part| !part.is_empty());
            let numbers: Vec<f64> = parts.map(finite).collect::<Option<_>>()?;
            numbers.try_into().ok().filter(|rgb: &[f64; 3]| rgb.iter().all(|channel| (0.0..=1.0).contains(channel)))?
        }
    };
    // IEC 61966-2-1.
    Some(
        encoded.map(|channel| if channel <= 0.04045 { channel / 12.92 } else { ((channel + 0.055) / 1.055).powf(2.4) }),
    )
}

/// CIE 1931 2-degree colour-matching function x, every 5 nm from [`FIRST`] (CIE 15:2004).
const X_BAR: [f64; 95] = [
    1.299e-4, 2.321e-4, 4.149e-4, 7.416e-4, 0.001368, 0.002236, 0.004243, 0.00765, 0.01431, 0.02319, 0.04351, 0.07763,
    0.13438, 0.21477, 0.2839, 0.3285, 0.34828, 0.34806, 0.3362, 0.3187, 0.2908, 0.2511, 0.19536, 0.1421, 0.09564,
    0.05795, 0.03201, 0.0147, 0.0049, 0.0024, 0.0093, 0.0291, 0.06327, 0.1096, 0.1655, 0.22575, 0.2904, 0.3597,
    0.43345, 0.51205, 0.5945, 0.6784, 0.7621, 0.8425, 0.9163, 0.9786, 1.0263, 1.0567, 1.0622, 1.0456, 1.0026, 0.9384,
    0.85445, 0.7514, 0.6424, 0.5419, 0.4479, 0.3608, 0.2835, 0.2187, 0.1649, 0.1212, 0.0874, 0.0636, 0.04677, 0.0329,
    0.0227, 0.01584, 0.0113592, 0.00811092, 0.00579035, 0.00410946, 0.00289933, 0.00204919, 0.00143997, 9.99949e-4,
    6.90079e-4, 4.76021e-4, 3.32301e-4, 2.34826e-4, 1.6615e-4, 1.17413e-4, 8.30753e-5, 5.87065e-5, 4.15099e-5,
    2.93533e-5, 2.06738e-5, 1.45598e-5, 1.0254e-5, 7.22146e-6, 5.08587e-6, 3.58165e-6, 2.52252e-6, 1.77651e-6,
    1.25114e-6,
];

/// The colour matching function y, sampled as [`X_BAR`].
const Y_BAR: [f64; 95] = [
    3.917e-6, 6.965e-6, 1.239e-5, 2.202e-5, 3.9e-5, 6.4e-5, 1.2e-4, 2.17e-4, 3.96e-4, 6.4e-4, 0.00121, 0.00218, 0.004,
    0.0073, 0.0116, 0.01684, 0.023, 0.0298, 0.038, 0.048, 0.06, 0.0739, 0.09098, 0.1126, 0.13902, 0.1693, 0.20802,
    0.2586, 0.323, 0.4073, 0.503, 0.6082, 0.71, 0.7932, 0.862, 0.91485, 0.954, 0.9803, 0.99495, 1.0, 0.995, 0.9786,
    0.952, 0.9154, 0.87, 0.8163, 0.757, 0.6949, 0.631, 0.5668, 0.503, 0.4412, 0.381, 0.321, 0.265, 0.217, 0.175,
    0.1382, 0.107, 0.0816, 0.061, 0.04458, 0.032, 0.0232, 0.017, 0.01192, 0.00821, 0.005723, 0.004102, 0.002929,
    0.002091, 0.001484, 0.001047, 7.4e-4, 5.2e-4, 3.611e-4, 2.492e-4, 1.719e-4, 1.2e-4, 8.48e-5, 6e-5, 4.24e-5, 3e-5,
    2.12e-5, 1.499e-5, 1.06e-5, 7.4657e-6, 5.2578e-6, 3.7029e-6, 2.6078e-6, 1.8366e-6, 1.2934e-6, 9.1093e-7, 6.4153e-7,
    4.5181e-7,
];

/// The colour matching function z, sampled as [`X_BAR`]; it is 0 beyond the last entry.
const Z_BAR: [f64; 58] = [
    6.061e-4, 0.001086, 0.001946, 0.003486, 0.00645, 0.01055, 0.02005, 0.03621, 0.06785, 0.1102, 0.2074, 0.3713,
    0.6456, 1.03905, 1.3856, 1.62296, 1.74706, 1.7826, 1.77211, 1.7441, 1.6692, 1.5281, 1.28764, 1.0419, 0.81295,
    0.6162, 0.46518, 0.3533, 0.272, 0.2123, 0.1582, 0.1117, 0.07825, 0.05725, 0.04216, 0.02984, 0.0203, 0.0134,
    0.00875, 0.00575, 0.0039, 0.00275, 0.0021, 0.0018, 0.00165, 0.0014, 0.0011, 0.001, 8e-4, 6e-4, 3.4e-4, 2.4e-4,
    1.9e-4, 1e-4, 5e-5, 3e-5, 2e-5, 1e-5,
];

/// CIE standard illuminant D65, every 10 nm from [`FIRST`] (CIE 15:2004); it is linear between these.
const D65: [f64; 48] = [
    46.6383, 52.0891, 49.9755, 54.6482, 82.7549, 91.486, 93.4318, 86.6823, 104.865, 117.008, 117.812, 114.861, 115.923,
    108.811, 109.354, 107.802, 104.79, 107.689, 104.405, 104.046, 100.0, 96.3342, 95.788, 88.6856, 90.0062, 89.5991,
    87.6987, 83.2886, 83.6992, 80.0268, 80.2146, 82.2778, 78.2842, 69.7213, 71.6091, 74.349, 61.604, 69.8856, 75.087,
    63.5927, 46.4182, 66.8054, 63.3828, 64.304, 59.4519, 51.959, 57.4406, 60.3125,
];

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;

    /// A spectrum with the colours that Mitsuba 3.9 (`scalar_rgb`) gives it as an index of refraction and as a radiance;
    /// it clamps channels below 0.
    const MITSUBA: [(&str, [f64; 3], [f64; 3]); 8] = [
        (
            "400:0.1, 500:0.5, 600:0.9, 700:0.2",
            [0.833825827, 0.689121544, 0.265242606],
            [0.97432369, 0.6616081, 0.229710832],
        ),
        ("360:0.5 830:0.5", [0.499492645, 0.499436855, 0.499400795], [0.602441847, 0.47411409, 0.454633415]),
        (
            "300:0.2, 450:0.9, 471.3:0.1, 555.5:0.7, 900:0.3",
            [0.765660167, 0.521276951, 0.589770138],
            [0.883341849, 0.500079632, 0.54879564],
        ),
        (
            "380:0.02, 430:0.05, 480:0.11, 530:0.32, 580:0.61, 630:0.77, 680:0.8, 730:0.79, 780:0.75",
            [0.853802085, 0.392351717, 0.0343116671],
            [0.983897269, 0.376666188, 0.0238012876],
        ),
        ("540:0.4, 545:0.9, 550:0.4, 800:0.35", [0.5244627, 0.238933012, 0.0], [0.590023041, 0.233455092, 0.0]),
        ("620:1, 700:1", [0.43754667, 0.0, 0.0], [0.52106148, 0.0, 0.0]),
        ("400:0.9, 500:0.9, 501:0.02, 700:0.02", [0.0, 0.0349671803, 0.98222965], [0.0, 0.0274029318, 0.901645482]),
        ("580:1.5, 590:2.5, 720:2", [2.82888722, 0.0735526904, 0.0], [3.20967007, 0.0703689903, 0.0]),
    ];

    #[test]
    fn colours_are_those_of_mitsuba() {
        let agrees = |text: &str, illuminant, expected: [f64; 3]| {
            let found = Spectrum::parse(text).unwrap().linear_srgb(illuminant);
            for (found, expected) in found.iter().zip(expected) {
                let error = if expected == 0.0 { found.max(0.0) } else { (found / expected - 1.0).abs() };
                assert!(error < 1e-4, "{text}, {illuminant:?}: {found} against {expected}");
            }
        };
        for (text, under_d65, as_it_is) in MITSUBA {
            agrees(text, Illuminant::D65, under_d65);
            agrees(text, Illuminant::EqualEnergy, as_it_is);
        }
    }

    /// Linear sRGB of black bodies as Mitsuba 3.9 renders them in its spectral mode, with 10^6 wavelengths each.
    #[test]
    fn black_bodies_have_the_colours_of_mitsuba() {
        for (temperature, expected) in [(5000.0, [15275.6, 12094.9, 9603.56]), (2000.0, [16.0277, 4.1164, 0.13045])] {
            let found = Spectrum::black_body(temperature, [FIRST, LAST]).unwrap().linear_srgb(Illuminant::EqualEnergy);
            for (found, expected) in found.iter().zip(expected) {
                assert!((found - expected).abs() < 3e-3 * expected, "{temperature} K: {found} against {expected}");
            }
        }
    }

    #[test]
    fn uniform_spectra_are_white() {
        // The sums are those of the integrals, but for Mitsuba's step.
        let one = Spectrum::parse("300:1 900:1").unwrap();
        for (illuminant, white) in [(Illuminant::D65, [1.0; 3]), (Illuminant::EqualEnergy, EQUAL_ENERGY_WHITE)] {
            for (found, expected) in one.linear_srgb(illuminant).iter().zip(white) {
                assert!((found / expected - 1.0).abs() < 1.3e-3, "{illuminant:?}: {found} against {expected}");
            }
        }
        let from_matrix = SRGB_FROM_XYZ.map(|row| row.iter().sum::<f64>());
        for (found, expected) in EQUAL_ENERGY_WHITE.iter().zip(from_matrix) {
            assert!((found - expected).abs() < 1e-6);
        }
    }

    #[test]
    fn bad_spectra_say_what_is_wrong() {
        let cases = [
            ("", "two samples"),
            ("500:1", "two samples"),
            ("500:1 400:1", "400 follows 500"),
            ("500:1 500:2", "must increase"),
            ("400:0.1 500", "'500'"),
            ("400: 0.1", "'400:'"),
            ("400:nan 500:1", "'400:nan'"),
            ("400:-1 500:1", "negative"),
        ];
        for (text, expected) in cases {
            let message = Spectrum::parse(text).unwrap_err();
            assert!(message.contains(expected), "'{expected}' is not in: {message}");
        }
    }

    #[test]
    fn encoded_colours_are_decoded() {
        assert_eq!(decode_srgb("#ffffff"), Some([1.0; 3]));
        assert_eq!(decode_srgb("1 1, 1"), Some([1.0; 3]));
        // 0xa0 / 255 = 0.627451, and ((0.627451 + 0.055) / 1.055)^2.4 = 0.351533; 0x05 / 255 / 12.92 = 0.001518.
        let [r, g, b] = decode_srgb("#A005b1").unwrap();
        assert!(
            (r - 0.351533).abs() < 1e-6 && (g - 0.001518).abs() < 1e-6 && (b - 0.439657).abs() < 1e-6,
            "{r} {g} {b}"
        );
        for wrong in ["", "#fff", "#fffffg", "#+fffff", "ffffff", "0.5", "0, 0, 2", "#ééé"] {
            assert_eq!(decode_srgb(wrong), None, "{wrong}");
        }
    }
}
