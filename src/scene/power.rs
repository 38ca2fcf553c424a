//! Where the light of a scene comes from: the flux of each kind of emitter.

use std::collections::BTreeMap;
use std::f64::consts::PI;

use super::Scene;
use super::compile::light::{area, unreachable_kind};
use crate::layout::{
    LIGHT_DIRECTIONAL, LIGHT_POINT, LIGHT_PROJECTOR, LIGHT_SPHERE, LIGHT_SPOT, LIGHT_TRIANGLE, Light, NONE,
    TEXTURE_IMAGE,
};

/// Steps of the quadrature over a spot's angle.
const STEPS: u32 = 256;

/// What the emitters of one kind shed together.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Power {
    /// How many there are: triangles and spheres of area lights, lamps, or the one background.
    pub count: u64,
    /// Flux, W for each channel of linear sRGB; of what is infinitely far, into a sphere around the scene.
    pub watts: [f64; 3],
}

impl Scene {
    /// The flux of each kind of emitter that the scene has, by its name: area, background, directional, point, projector or spot. Where a
    /// texture shapes an emitter its mean counts, and masks do not.
    pub fn powers(&self) -> BTreeMap<&'static str, Power> {
        let mut all: BTreeMap<&'static str, Power> = BTreeMap::new();
        let mut means: BTreeMap<u32, [f64; 3]> = BTreeMap::new();
        let mut add = |kind, watts: [f64; 3]| {
            let power = all.entry(kind).or_insert(Power { count: 0, watts: [0.0; 3] });
            power.count += 1;
            power.watts.iter_mut().zip(watts).for_each(|(sum, watts)| *sum += watts);
        };
        for light in &self.lights {
            let (kind, extent, texture) = self.emits(light);
            let mean = match texture {
                NONE => [1.0; 3],
                texture => *means.entry(texture).or_insert_with(|| self.texture_mean(texture, |_| 1.0)),
            };
            add(kind, [0, 1, 2].map(|channel| extent * f64::from(light.radiance[channel]) * mean[channel]));
        }
        if let Some(radiance) = self.background {
            // Of each row of an image as much as its part of the sphere.
            let mean = self
                .environment
                .as_ref()
                .map_or([1.0; 3], |environment| self.texture_mean(environment.texture, |row| (PI * row).sin()));
            let extent = 4.0 * PI * PI * f64::from(self.radius()).powi(2);
            add("background", [0, 1, 2].map(|channel| extent * f64::from(radiance[channel]) * mean[channel]));
        }
        all
    }

    /// The name of a light's kind, its flux per radiance, and the texture that multiplies that, or `NONE`.
    fn emits(&self, light: &Light) -> (&'static str, f64, u32) {
        let [first, second, falloff] = light.v2.map(f64::from);
        match light.kind {
            LIGHT_TRIANGLE | LIGHT_SPHERE => {
                ("area", PI * area(light).unwrap_or_default(), self.surfaces[light.source as usize].emission_texture)
            }
            LIGHT_POINT => ("point", 4.0 * PI, NONE),
            LIGHT_SPOT => ("spot", spot_extent(first, second, falloff != 0.0), light.source),
            LIGHT_PROJECTOR => ("projector", 4.0 * first * second, light.source),
            LIGHT_DIRECTIONAL => ("directional", PI * f64::from(self.radius()).powi(2), NONE),
            kind => ("other", unreachable_kind(kind, 0.0), NONE),
        }
    }

    /// The mean of a texture's values, each row of an image, from 0 at the top to 1, with this weight.
    fn texture_mean(&self, texture: u32, weight: impl Fn(f64) -> f64) -> [f64; 3] {
        let texture = &self.textures[texture as usize];
        if texture.kind != TEXTURE_IMAGE {
            return [0, 1, 2].map(|channel| 0.5 * f64::from(texture.scale[channel] + texture.offset[channel]));
        }
        let image = &self.images[texture.texels[0] as usize];
        let (mut sum, mut total) = ([0.0; 3], 0.0);
        for y in 0..image.height {
            let weight = weight((f64::from(y) + 0.5) / f64::from(image.height));
            for x in 0..image.width {
                let texel = image.texel(x, y);
                for channel in 0..3 {
                    let value = texel[channel] * texture.scale[channel] + texture.offset[channel];
                    sum[channel] += weight * f64::from(value.max(0.0));
                }
            }
            total += weight * f64::from(image.width);
        }
        sum.map(|sum| sum / f64::max(total, f64::MIN_POSITIVE))
    }
}

/// Flux of a spot of intensity 1 on its axis: full up to the angle `beam`, none beyond `cutoff` (radians), and in between as
/// `shaders/lights/spot.glsl` has it.
fn spot_extent(cutoff: f64, beam: f64, by_cosine: bool) -> f64 {
    let falloff = |angle: f64| {
        if by_cosine {
            ((angle.cos() - cutoff.cos()) / (beam.cos() - cutoff.cos())).powi(2)
        } else {
            (cutoff - angle) / (cutoff - beam)
        }
    };
    let step = (cutoff - beam).max(0.0) / f64::from(STEPS);
    let ring = |index: u32| {
        let angle = beam + (f64::from(index) + 0.5) * step;
        falloff(angle) * angle.sin() * step
    };
    2.0 * PI * (1.0 - beam.cos() + if step > 0.0 { (0..STEPS).map(ring).sum::<f64>() } else { 0.0 })
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use glam::DVec3;

    use super::*;
    use crate::scene::light::{Falloff, Lamp};
    use crate::scene::{SceneBuilder, SurfaceDescription};

    #[test]
    fn each_kind_sheds_its_flux() {
        let mut builder = SceneBuilder::new("scene");
        let glowing = builder.surface(SurfaceDescription { emission: [1.0, 2.0, 3.0], ..Default::default() });
        builder.parallelogram(DVec3::ZERO, DVec3::X * 2.0, DVec3::Y * 3.0, glowing);
        let (position, direction) = (DVec3::ZERO, DVec3::Z);
        builder.lamps.push(Lamp::Point { position, intensity: [1.0; 3] });
        builder.lamps.push(Lamp::Point { position, intensity: [0.0, 1.0, 2.0] });
        let (cutoff, beam_width) = (1.2, 0.4);
        for falloff in [Falloff::Angle, Falloff::Cosine] {
            let intensity = [1.0; 3];
            builder.lamps.push(Lamp::Spot {
                position,
                direction,
                intensity,
                cutoff,
                beam_width,
                falloff,
                texture: None,
            });
        }
        builder.lamps.push(Lamp::Directional { direction, irradiance: [5.0; 3] });
        builder.background = Some([0.25; 3]);
        let scene = builder.finish().unwrap();
        let powers = scene.powers();
        let close = |kind: &str, count: u64, expected: [f64; 3]| {
            let power = &powers[kind];
            assert_eq!(power.count, count, "{kind}");
            let off = power.watts.iter().zip(expected).map(|(a, b)| (a - b).abs() / b).fold(0.0, f64::max);
            assert!(off < 1e-5, "{kind}: {:?} instead of {expected:?}", power.watts);
        };
        close("area", 2, [1.0, 2.0, 3.0].map(|radiance| 6.0 * PI * radiance));
        close("point", 2, [1.0, 2.0, 3.0].map(|intensity| 4.0 * PI * intensity));
        // The integrals of both falloffs: by parts, and of a square of the cosine.
        let (near, far) = (f64::cos(beam_width), f64::cos(cutoff));
        let by_angle = (f64::sin(beam_width) - f64::sin(cutoff)) / (cutoff - beam_width) + near;
        let both = 2.0 * PI * (2.0 * (1.0 - near) + by_angle + (near - far) / 3.0);
        close("spot", 2, [both; 3]);
        let radius = f64::from(scene.radius());
        close("directional", 1, [5.0 * PI * radius * radius; 3]);
        close("background", 1, [PI * PI * radius * radius; 3]);
        assert_eq!(powers.len(), 5);
    }
}
