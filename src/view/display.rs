//! From linear values to what a screen shows: exposure, tone curve, false colour.

use std::sync::OnceLock;

use crate::image::{Image, srgb_byte};

/// How values beyond what a screen can show come to be shown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Curve {
    /// As PNG files of `lumbre render` have them: clamped to 1.
    #[default]
    Clamped,
    /// x / (1 + x), channel by channel (Reinhard et al. 2002).
    Reinhard,
    /// A fit of the curve of ACES (Narkowicz 2015).
    Filmic,
}

impl Curve {
    /// Every curve, by its name.
    pub const ALL: [(&str, Self); 3] =
        [("clamped", Self::Clamped), ("Reinhard", Self::Reinhard), ("filmic", Self::Filmic)];

    fn of(self, x: f32) -> f32 {
        match self {
            Self::Clamped => x,
            Self::Reinhard => x / (1.0 + x),
            Self::Filmic => x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14),
        }
    }
}

/// How values become colours.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scale {
    /// Radiance or the like: by exposure and curve.
    Radiance,
    /// Colours of 0 to 1, as they are.
    Colour,
    /// Components of unit vectors, -1 to 1.
    Direction,
    /// From the least to the largest of each channel.
    Range,
    /// A colour for each number, black for 0.
    Number,
}

/// What the user has chosen of it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Display {
    /// Powers of two that radiance is multiplied by.
    pub exposure: f32,
    /// The tone curve.
    pub curve: Curve,
    /// Shows luminance by colours: black, blue, red, yellow, white from 2^-6 to 2^2 after exposure.
    pub false_colour: bool,
}

/// Powers of two of luminance at the two ends of the false colours.
pub(super) const FALSE_COLOUR_RANGE: [f32; 2] = [-6.0, 2.0];

/// The false colours, evenly spaced in the logarithm.
const FALSE_COLOURS: [[f32; 3]; 6] =
    [[0.0, 0.0, 0.0], [0.05, 0.03, 0.4], [0.45, 0.02, 0.35], [0.85, 0.15, 0.03], [1.0, 0.7, 0.05], [1.0, 1.0, 0.9]];

/// The false colour, linear, of a share of the range.
pub(super) fn false_colour(share: f32) -> [f32; 3] {
    let at = share.clamp(0.0, 1.0) * (FALSE_COLOURS.len() - 1) as f32;
    let first = (at as usize).min(FALSE_COLOURS.len() - 2);
    let part = at - first as f32;
    std::array::from_fn(|channel| {
        FALSE_COLOURS[first][channel] * (1.0 - part) + FALSE_COLOURS[first + 1][channel] * part
    })
}

/// A colour for a number that has no meaning beside others.
fn colour_of_number(number: f32) -> [f32; 3] {
    if number < 0.5 {
        return [0.0; 3];
    }
    let bits = (number as u32).wrapping_mul(0x9e37_79b1);
    std::array::from_fn(|channel| 0.08 + 0.8 * ((bits >> (8 * channel + 8) & 0xff) as f32 / 255.0).powi(2))
}

impl Display {
    /// What a screen is to show, linear from 0 to 1: what [`srgb_byte`] makes bytes of.
    pub fn tone(&self, image: &Image, scale: Scale) -> Image {
        let range = if scale == Scale::Range { range_of(image) } else { [[0.0; 3], [1.0; 3]] };
        let mut shown = image.clone();
        in_parts(&mut shown.pixels, |pixel| *pixel = self.tone_of(*pixel, scale, range));
        shown
    }

    fn tone_of(&self, pixel: [f32; 3], scale: Scale, [least, most]: [[f32; 3]; 2]) -> [f32; 3] {
        match scale {
            Scale::Radiance => {
                let gain = self.exposure.exp2();
                let radiance = pixel.map(|value| value * gain);
                if self.false_colour {
                    let luminance = 0.2126 * radiance[0] + 0.7152 * radiance[1] + 0.0722 * radiance[2];
                    let [first, last] = FALSE_COLOUR_RANGE;
                    return false_colour((luminance.max(0.0).log2() - first) / (last - first));
                }
                radiance.map(|value| self.curve.of(value))
            }
            Scale::Colour => pixel,
            Scale::Direction => pixel.map(|value| 0.5 * value + 0.5),
            Scale::Range => std::array::from_fn(|channel| {
                (pixel[channel] - least[channel]) / (most[channel] - least[channel]).max(f32::MIN_POSITIVE)
            }),
            Scale::Number => colour_of_number(pixel[0]),
        }
    }
}

/// The least and the largest finite value of each channel.
fn range_of(image: &Image) -> [[f32; 3]; 2] {
    let start = [[f32::INFINITY; 3], [f32::NEG_INFINITY; 3]];
    image.pixels.iter().fold(start, |[mut least, mut most], pixel| {
        for channel in 0..3 {
            let value = pixel[channel];
            if value.is_finite() {
                least[channel] = least[channel].min(value);
                most[channel] = most[channel].max(value);
            }
        }
        [least, most]
    })
}

/// Opaque sRGB pixels of what [`Display::tone`] made: [`srgb_byte`] of each value, faster.
pub fn srgb_pixels(shown: &Image) -> Vec<[u8; 4]> {
    let steps = steps();
    let mut pairs: Vec<([f32; 3], [u8; 4])> = shown.pixels.iter().map(|pixel| (*pixel, [0, 0, 0, 255])).collect();
    in_parts(&mut pairs, |(pixel, bytes)| {
        for (value, byte) in pixel.iter().zip(bytes) {
            *byte = steps.partition_point(|step| step <= value) as u8;
        }
    });
    pairs.into_iter().map(|(_, bytes)| bytes).collect()
}

/// The least value that each byte from 1 on stands for.
fn steps() -> &'static [f32; 255] {
    static STEPS: OnceLock<[f32; 255]> = OnceLock::new();
    STEPS.get_or_init(|| {
        std::array::from_fn(|index| {
            // Positive floats are in the order of their bits.
            let (mut below, mut at) = (0, 1.0f32.to_bits());
            while at - below > 1 {
                let middle = below + (at - below) / 2;
                if usize::from(srgb_byte(f32::from_bits(middle))) > index { at = middle } else { below = middle }
            }
            f32::from_bits(at)
        })
    })
}

/// Pixels below which one thread is as good as several.
const FEW: usize = 1 << 17;

/// Does something to each element, on as many threads as there are cores where they are many: threads of its own, as the shared ones may be
/// waiting for a driver to compile.
fn in_parts<T: Send>(all: &mut [T], change: impl Fn(&mut T) + Sync) {
    if all.len() < FEW {
        all.iter_mut().for_each(change);
        return;
    }
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    std::thread::scope(|scope| {
        for part in all.chunks_mut(all.len().div_ceil(threads)) {
            let change = &change;
            scope.spawn(move || part.iter_mut().for_each(change));
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    fn image(pixels: Vec<[f32; 3]>) -> Image {
        Image { width: pixels.len() as u32, height: 1, pixels }
    }

    /// A screenshot of the viewer has the bytes of a PNG of `lumbre render`.
    #[test]
    fn bytes_are_those_of_png_files() {
        let values = (0..40_000u32).map(|index| [index as f32 / 30_000.0, f32::from_bits(index << 16), -1.0]);
        let shown = image(values.collect());
        for (bytes, pixel) in srgb_pixels(&shown).iter().zip(&shown.pixels) {
            let expected = pixel.map(|value| if value == f32::INFINITY { 255 } else { srgb_byte(value) });
            assert_eq!(bytes[..3], expected, "{pixel:?}");
        }
        assert_eq!(Display::default().tone(&shown, Scale::Radiance).pixels[..9], shown.pixels[..9]);
    }

    #[test]
    fn exposure_doubles_and_curves_stay_below_one() {
        let bright = Display { exposure: 1.0, ..Display::default() };
        assert_eq!(bright.tone(&image(vec![[0.1, 0.2, 4.0]]), Scale::Radiance).pixels, [[0.2, 0.4, 8.0]]);
        for curve in [Curve::Reinhard, Curve::Filmic] {
            let mut before = 0.0;
            for step in 1..200 {
                let shown = curve.of(step as f32 * 0.1);
                assert!(shown > before && shown < 1.04, "{curve:?}: {shown}");
                before = shown;
            }
        }
    }

    #[test]
    fn false_colours_tell_luminance() {
        let display = Display { false_colour: true, ..Display::default() };
        let at = |value: f32| display.tone(&image(vec![[value; 3]]), Scale::Radiance).pixels[0];
        assert_eq!((at(0.0), at(f32::NAN)), ([0.0; 3], [0.0; 3]));
        assert_eq!(at(4.0), FALSE_COLOURS[5]);
        assert!(at(0.25)[0] > at(0.0625)[0]);
    }
}
