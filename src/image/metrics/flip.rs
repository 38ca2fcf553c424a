//! LDR-FLIP (Andersson, Nilsson, Akenine-Moller et al. 2020): how different two pictures look when a viewer flips between
//! them. Section and equation numbers are the paper's. Checked against NVIDIA's own implementation in `tests/metrics.rs`.

use crate::image::Image;

/// Pixels per degree of a 4K display 0.7 m wide, seen from 0.7 m: the paper's default.
const PIXELS_PER_DEGREE: f32 = 67.020_64;

/// Reference white of the conversion between sRGB and XYZ.
const WHITE: [f32; 3] = [0.950_428_55, 1.0, 1.088_900_4];

/// A single-channel image.
#[derive(Clone)]
struct Plane {
    width: usize,
    height: usize,
    values: Vec<f32>,
}

/// The error of each pixel, 0 to 1, over the sRGB pictures of two linear images (clamped to 0..1).
pub fn flip_map(image: &Image, reference: &Image) -> Vec<f32> {
    let [test, truth] = [image, reference].map(to_ycxcz);
    let colour = colour_differences(&test, &truth);
    let feature = feature_differences(&test[0], &truth[0]);
    // Equation 20: features raise the colour error.
    colour.iter().zip(&feature).map(|(colour, feature)| colour.powf(1.0 - feature)).collect()
}

fn to_ycxcz(image: &Image) -> [Plane; 3] {
    let plane = |channel: usize| {
        let value = |pixel: &[f32; 3]| {
            let clamped = pixel.map(|c| if c.is_finite() { c.clamp(0.0, 1.0) } else { 0.0 });
            // The picture is what a display shows: eight bits per channel are not modelled, the clamp is.
            rgb_to_ycxcz(clamped)[channel]
        };
        Plane {
            width: image.width as usize,
            height: image.height as usize,
            values: image.pixels.iter().map(value).collect(),
        }
    };
    [plane(0), plane(1), plane(2)]
}

fn rgb_to_xyz([r, g, b]: [f32; 3]) -> [f32; 3] {
    [
        0.412_390_8 * r + 0.357_584_33 * g + 0.180_480_8 * b,
        0.212_639 * r + 0.715_168_7 * g + 0.072_192_32 * b,
        0.019_330_818 * r + 0.119_194_78 * g + 0.950_532_15 * b,
    ]
}

fn xyz_to_rgb([x, y, z]: [f32; 3]) -> [f32; 3] {
    [
        3.240_97 * x - 1.537_383_2 * y - 0.498_610_76 * z,
        -0.969_243_65 * x + 1.875_967_5 * y + 0.041_555_06 * z,
        0.055_630_08 * x - 0.203_976_96 * y + 1.056_971_5 * z,
    ]
}

/// Linearised CIELAB: Y, Cx, Cz (section 4.1).
fn rgb_to_ycxcz(rgb: [f32; 3]) -> [f32; 3] {
    let [x, y, z] = rgb_to_xyz(rgb);
    let (x, y, z) = (x / WHITE[0], y / WHITE[1], z / WHITE[2]);
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

fn ycxcz_to_rgb([luma, cx, cz]: [f32; 3]) -> [f32; 3] {
    let y = (luma + 16.0) / 116.0;
    xyz_to_rgb([(y + cx / 500.0) * WHITE[0], y * WHITE[1], (y - cz / 200.0) * WHITE[2]])
}

/// CIELAB with the Hunt effect: colours of dark pixels count less (equation 5).
fn rgb_to_hunt_lab(rgb: [f32; 3]) -> [f32; 3] {
    const DELTA: f32 = 6.0 / 29.0;
    let f = |t: f32| if t > DELTA * DELTA * DELTA { t.cbrt() } else { t / (3.0 * DELTA * DELTA) + 4.0 / 29.0 };
    let [x, y, z] = rgb_to_xyz(rgb);
    let (x, y, z) = (f(x / WHITE[0]), f(y / WHITE[1]), f(z / WHITE[2]));
    let l = 116.0 * y - 16.0;
    [l, 0.01 * l * 500.0 * (x - y), 0.01 * l * 200.0 * (y - z)]
}

/// The HyAB distance (equation 6).
fn hyab(a: [f32; 3], b: [f32; 3]) -> f32 {
    (a[0] - b[0]).abs() + (a[1] - b[1]).hypot(a[2] - b[2])
}

/// Colour pipeline: the eye's contrast sensitivity, then a perceptual distance, then its range compressed (section 4.1).
fn colour_differences(test: &[Plane; 3], truth: &[Plane; 3]) -> Vec<f32> {
    const EXPONENT: f32 = 0.7;
    const KNEE: f32 = 0.4;
    const KNEE_VALUE: f32 = 0.95;
    let [test, truth] = [test, truth].map(|planes| {
        // Contrast sensitivity as sums of Gaussians, (weight, spread) per channel (table 1).
        const GAUSSIANS: [&[(f32, f32)]; 3] = [&[(1.0, 0.0047)], &[(1.0, 0.0053)], &[(34.1, 0.04), (13.5, 0.025)]];
        let blurred: Vec<Plane> =
            planes.iter().zip(GAUSSIANS).map(|(plane, terms)| contrast_filter(plane, terms)).collect();
        (0..blurred[0].values.len())
            .map(|index| {
                let rgb = ycxcz_to_rgb([blurred[0].values[index], blurred[1].values[index], blurred[2].values[index]]);
                rgb_to_hunt_lab(rgb.map(|channel| channel.clamp(0.0, 1.0)))
            })
            .collect::<Vec<_>>()
    });
    let largest = hyab(rgb_to_hunt_lab([0.0, 1.0, 0.0]), rgb_to_hunt_lab([0.0, 0.0, 1.0])).powf(EXPONENT);
    let knee = KNEE * largest;
    test.iter()
        .zip(&truth)
        .map(|(a, b)| {
            let error = hyab(*a, *b).powf(EXPONENT);
            if error < knee {
                error * KNEE_VALUE / knee
            } else {
                KNEE_VALUE + (error - knee) / (largest - knee) * (1.0 - KNEE_VALUE)
            }
        })
        .collect()
}

/// The filter sum of a sqrt(pi / b) exp(-pi² r² / b), r in degrees, over (a, b), with weights that sum to one. Each
/// Gaussian is separable, their sum is not, so that they are applied one by one.
fn contrast_filter(plane: &Plane, terms: &[(f32, f32)]) -> Plane {
    use std::f32::consts::PI;
    let radius = (3.0 * (0.04 / (2.0 * PI * PI)).sqrt() * PIXELS_PER_DEGREE).ceil() as i32;
    let mut out = Plane { values: vec![0.0; plane.values.len()], ..plane.clone() };
    let mut total = 0.0;
    for (a, b) in terms {
        let kernel: Vec<f32> =
            (-radius..=radius).map(|x| (-PI * PI * (x as f32 / PIXELS_PER_DEGREE).powi(2) / b).exp()).collect();
        let weight = a * (PI / b).sqrt();
        let sum: f32 = kernel.iter().sum();
        total += weight * sum * sum;
        let blurred = convolve(plane, &kernel, &kernel);
        out.values.iter_mut().zip(&blurred.values).for_each(|(out, value)| *out += weight * value);
    }
    out.values.iter_mut().for_each(|value| *value /= total);
    out
}

/// Feature pipeline: differences in edges and in points (section 4.2).
fn feature_differences(test: &Plane, truth: &Plane) -> Vec<f32> {
    const WIDTH: f32 = 0.082; // degrees
    let deviation = 0.5 * WIDTH * PIXELS_PER_DEGREE;
    let radius = (3.0 * deviation).ceil() as i32;
    let positions: Vec<f32> = (-radius..=radius).map(|x| x as f32).collect();
    let bell = |x: &f32| (-x * x / (2.0 * deviation * deviation)).exp();
    let gaussian: Vec<f32> = positions.iter().map(bell).collect();
    let sum: f32 = gaussian.iter().sum();
    let gaussian: Vec<f32> = gaussian.iter().map(|value| value / sum).collect();
    let edge = balance(positions.iter().map(|x| -x * bell(x)).collect());
    let point = balance(positions.iter().map(|x| (x * x / (deviation * deviation) - 1.0) * bell(x)).collect());
    let strength = |plane: &Plane, kernel: &[f32]| {
        let luma = Plane { values: plane.values.iter().map(|value| (value + 16.0) / 116.0).collect(), ..plane.clone() };
        let (x, y) = (convolve(&luma, kernel, &gaussian), convolve(&luma, &gaussian, kernel));
        x.values.iter().zip(&y.values).map(|(x, y)| x.hypot(*y)).collect::<Vec<f32>>()
    };
    let differences = |kernel: &[f32]| -> Vec<f32> {
        strength(test, kernel).iter().zip(strength(truth, kernel)).map(|(a, b)| (a - b).abs()).collect()
    };
    differences(&edge)
        .iter()
        .zip(differences(&point))
        .map(|(edge, point)| (edge.max(point) / 2f32.sqrt()).sqrt())
        .collect()
}

/// Scales the positive weights to sum to 1 and the negative ones to -1.
fn balance(mut kernel: Vec<f32>) -> Vec<f32> {
    let positive: f32 = kernel.iter().filter(|weight| **weight > 0.0).sum();
    let negative: f32 = -kernel.iter().filter(|weight| **weight < 0.0).sum::<f32>();
    kernel.iter_mut().for_each(|weight| *weight /= if *weight > 0.0 { positive } else { negative });
    kernel
}

/// Separable convolution; the image goes on beyond its edges with the pixels there.
fn convolve(plane: &Plane, along_x: &[f32], along_y: &[f32]) -> Plane {
    let (width, height) = (plane.width, plane.height);
    let reach = |kernel: &[f32]| (kernel.len() / 2) as isize;
    let inside = |at: isize, size: usize| at.clamp(0, size as isize - 1) as usize;
    let mut rows = vec![0.0; plane.values.len()];
    for (y, out) in rows.chunks_mut(width.max(1)).enumerate() {
        let row = &plane.values[y * width..(y + 1) * width];
        for (x, out) in out.iter_mut().enumerate() {
            let at = |k: usize| row[inside(x as isize + k as isize - reach(along_x), width)];
            *out = along_x.iter().enumerate().map(|(k, weight)| weight * at(k)).sum();
        }
    }
    let mut values = vec![0.0; plane.values.len()];
    for (y, out) in values.chunks_mut(width.max(1)).enumerate() {
        for (k, weight) in along_y.iter().enumerate() {
            let from = inside(y as isize + k as isize - reach(along_y), height) * width;
            out.iter_mut().zip(&rows[from..from + width]).for_each(|(out, value)| *out += weight * value);
        }
    }
    Plane { width, height, values }
}
