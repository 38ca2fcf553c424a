//! Caustics with a known answer: a circular mirror in parallel light throws a nephroid (NUMERICS' row of caustics).

use crate::common::room::scene;
use crate::common::{backends, backends_in_time, settings, with_gpu};
use lumbre::image::Image;
use lumbre::render::{Settings, render};
use lumbre::scene::Scene;

/// Pixels of the image, which shows a square of side 2.1 around the ring's centre from straight above.
const SIZE: u32 = 84;
const SIDE: f64 = 2.1;
/// Height of the wall, a cylinder of radius 1.
const HEIGHT: f64 = 0.5;
/// Above the horizon, in degrees: light that meets the wall opposite comes down at R/2 from 0.29 R below the cusp.
const ELEVATION: f64 = 30.0;
const IRRADIANCE: f64 = 4.0;
const ALBEDO: f64 = 0.5;
/// Paths from the light to the mirror, the table, and the camera.
const SEGMENTS: u32 = 3;

/// A wall that is a perfect mirror on a matte table, in parallel light towards +z and down, seen along parallel rays: the plan of
/// scenes/ring_caustic.xml, without thickness and rounded edges.
fn ring() -> Scene {
    let (sine, cosine) = ELEVATION.to_radians().sin_cos();
    let half = SIDE / 2.0;
    scene(&format!(
        "<sensor type='orthographic'><transform name='to_world'><scale x='{half}' y='{half}' z='1'/>
         <lookat origin='0, 12, 0' target='0, 0, 0' up='0, 0, 1'/></transform>
         <film type='hdrfilm'><integer name='width' value='{SIZE}'/><integer name='height' value='{SIZE}'/><rfilter type='box'/></film></sensor>
         <shape type='rectangle'><transform name='to_world'><rotate x='1' angle='-90'/><scale value='1.2'/></transform>
         <bsdf type='diffuse'><rgb name='reflectance' value='{ALBEDO}'/></bsdf></shape>
         <shape type='cylinder'><point name='p0' x='0' y='0' z='0'/><point name='p1' x='0' y='{HEIGHT}' z='0'/>
         <bsdf type='twosided'><bsdf type='conductor'/></bsdf></shape>
         <emitter type='directional'><vector name='direction' x='0' y='{}' z='{cosine}'/>
         <rgb name='irradiance' value='{IRRADIANCE}'/></emitter>",
        -sine
    ))
}

/// Irradiance of the table by light that the wall has reflected once, for each pixel: the flux of the wall's elements, each put down
/// where it goes. The element at angle a off the light's direction gets cos(elevation) cos(a) of the light and sends it back by
/// 2 a; it must pass over the wall behind, and come down before it meets the wall again.
fn predicted() -> Vec<f64> {
    let (sine, cosine) = ELEVATION.to_radians().sin_cos();
    let slope = sine / cosine;
    let pixel = SIDE / f64::from(SIZE);
    let mut flux = vec![0.0; (SIZE * SIZE) as usize];
    let (angles, heights) = (6000, 1200);
    let (da, dh) = (std::f64::consts::PI / f64::from(angles), HEIGHT / f64::from(heights));
    for i in 0..angles {
        let a = (f64::from(i) + 0.5) * da - std::f64::consts::FRAC_PI_2;
        let chord = 2.0 * a.cos();
        for j in 0..heights {
            let height = (f64::from(j) + 0.5) * dh;
            let way = height / slope;
            if way > chord || height + chord * slope < HEIGHT {
                continue;
            }
            // x across the light, z along it.
            let (x, z) = (a.sin() - way * (2.0 * a).sin(), a.cos() - way * (2.0 * a).cos());
            let (column, row) = ((SIDE / 2.0 - x) / pixel, (SIDE / 2.0 - z) / pixel);
            if (0.0..f64::from(SIZE)).contains(&column) && (0.0..f64::from(SIZE)).contains(&row) {
                flux[row as usize * SIZE as usize + column as usize] += IRRADIANCE * cosine * a.cos() * da * dh;
            }
        }
    }
    flux.into_iter().map(|flux| flux / (pixel * pixel)).collect()
}

/// Where the cusp lies on the axis, from the bright curve that runs into it: in each column, how far the brightest pixel is off the
/// nephroid x = sin^3 t, z = cos t (3/2 - cos^2 t), whose own cusp is at 1/2. The brightest pixel of the axis itself tells less, however small
/// pixels are: where the curve is a pixel off the axis it has come on by 3/2 of the pixel's size to the power of 2/3, which is more.
fn cusp(at: &dyn Fn(u32, u32) -> f64) -> f64 {
    let place = |index: u32| SIDE / 2.0 - (f64::from(index) + 0.5) * SIDE / f64::from(SIZE);
    let off = |column: u32| {
        let brightest = (0..SIZE / 2).max_by(|a, b| at(column, *a).total_cmp(&at(column, *b))).unwrap();
        let cosine = place(column).abs().cbrt().asin().cos();
        place(brightest) - cosine * (1.5 - cosine * cosine)
    };
    let columns: Vec<u32> = (0..SIZE).filter(|column| (0.04..0.34).contains(&place(*column).abs())).collect();
    0.5 + columns.iter().map(|column| off(*column)).sum::<f64>() / columns.len() as f64
}

/// Means over the blocks of 4 by 4 pixels that lie well inside the ring.
fn blocks(at: &dyn Fn(u32, u32) -> f64) -> Vec<f64> {
    let centre = |index: u32| SIDE / 2.0 - f64::from(index + 2) * SIDE / f64::from(SIZE);
    let origins = (0..SIZE).step_by(4).flat_map(|y| (0..SIZE).step_by(4).map(move |x| (x, y)));
    let inside = origins.filter(|(x, y)| centre(*x).hypot(centre(*y)) < 0.9);
    inside.map(|(x, y)| (0..16).map(|k| at(x + k % 4, y + k / 4)).sum::<f64>() / 16.0).collect()
}

/// The cusp lies half a radius from the centre, within a pixel, and the irradiance is that of the density of rays.
#[test]
fn a_ring_throws_a_nephroid() {
    let scene = ring();
    let expected = predicted();
    let expected_at = |x: u32, y: u32| expected[(y * SIZE + x) as usize];
    let pixel = SIDE / f64::from(SIZE);
    assert!((cusp(&expected_at) - 0.5).abs() < pixel, "the prediction's own cusp is at {}", cusp(&expected_at));
    // Photons and merges blur the curve: they are left a wider berth where it is sharp, none in the mean.
    for (technique, spp, tolerance) in [
        ("light", 2048, 0.015),
        ("bdpt", 1024, 0.015),
        ("photon:radius=0.004", 1024, 0.05),
        ("vcm:radius=0.004", 512, 0.05),
    ] {
        with_gpu(|gpu| {
            // What mirrors do is no matter of how rays are met; one technique shows that they are.
            for backend in if technique == "light" { backends(gpu) } else { backends_in_time(gpu) } {
                let settings = Settings {
                    lengths: SEGMENTS + 1,
                    max_depth: Some(SEGMENTS),
                    ..settings(&scene, technique, backend)
                };
                let film = render(gpu, &scene, &settings, spp).unwrap();
                let image: Image = film.length(SEGMENTS as usize - 1);
                // Radiance of a matte table over albedo / pi.
                let found = |x: u32, y: u32| {
                    f64::from(image.pixels[(y * SIZE + x) as usize][1]) * std::f64::consts::PI / ALBEDO
                };
                let what = format!("{technique} on {}", backend.name());
                let at = cusp(&found);
                let (wanted, got) = (blocks(&expected_at), blocks(&found));
                let whole = got.iter().sum::<f64>() / wanted.iter().sum::<f64>();
                let bright = wanted.iter().copied().fold(0.0, f64::max);
                let worst = wanted.iter().zip(&got).map(|(a, b)| (a - b).abs() / bright).fold(0.0, f64::max);
                println!(
                    "{what}: cusp at {at:.3} R, energy {whole:.4}, blocks off by {worst:.4} of the brightest at most"
                );
                assert!((at - 0.5).abs() <= pixel, "{what}: cusp at {at}");
                assert!((whole - 1.0).abs() < 0.004, "{what}: {whole} of the energy");
                assert!(worst < tolerance, "{what}: a block is off by {worst} of the brightest");
            }
        });
    }
}
