//! Paths in a room with a mirror, rough metal and water, and the densities with which techniques make them, by definition and in double
//! precision. What mirrors and water in between do to a solid angle is not derived but measured, by following neighbouring rays:
//! nothing is shared with the shaders but the paths themselves.

use std::f64::consts::PI;

use glam::DVec3;

use super::geometry::{glowing, look};
use crate::error::Result;
use crate::scene::camera::Projection;
use crate::scene::{Scene, SceneBuilder, SurfaceDescription, material};

/// Side of the image, pixels, and its field of view, degrees.
const SIZE: u32 = 64;
const FOV: f64 = 70.0;
/// Refractive index of the water.
const WATER: f64 = 1.33;
/// The share that matte walls and the glowing ceiling reflect.
const ALBEDO: f64 = 0.6;
/// Roughness of the metal.
const ALPHA: f64 = 0.5;
/// Area of the ceiling, which is the lamp.
pub(super) const LAMP_AREA: f64 = 4.0;
/// Paths with a shorter segment or a flatter cosine than this are left to others: single precision tells too little of them.
pub(super) const FLATTEST: f64 = 0.05;

/// What a wall is of.
#[derive(Clone, Copy)]
pub(super) enum Of {
    Matte,
    Lamp,
    /// Reflects all of the light (GGX, Smith's masking of either direction by itself).
    Metal,
    Mirror,
    Water,
}

/// A wall of the room: the axis that it is across, where it is, and what of.
type Wall = (usize, f64, Of);

const WALLS: [Wall; 7] = [
    (0, -1.0, Of::Mirror),
    (0, 1.0, Of::Matte),
    (1, -1.0, Of::Matte),
    (1, 1.0, Of::Lamp),
    (2, -1.0, Of::Metal),
    (2, 1.0, Of::Matte),
    (1, -0.4, Of::Water),
];

/// Where the camera is, and what it looks at.
#[derive(Clone, Copy)]
pub(super) struct View {
    pub from: DVec3,
    pub at: DVec3,
    /// Radius of its lens, which lies across the z axis; 0 is a pinhole.
    pub lens: f64,
}

/// From a pinhole, askew.
pub(super) const PINHOLE: View = View { from: DVec3::new(0.2, 0.35, 0.9), at: DVec3::new(-0.3, -0.3, -1.0), lens: 0.0 };

/// Through a large lens, straight on.
pub(super) const LENS: View = View { from: DVec3::new(0.2, 0.35, 0.9), at: DVec3::new(0.2, 0.35, -1.0), lens: 0.3 };

/// A room with a mirror and rough metal for walls, half full of water, under a glowing ceiling: two units wide, times `scale`.
pub(super) fn room(view: View, scale: f64) -> Result<Scene> {
    let mut builder = SceneBuilder::new("room");
    for (axis, at, of) in WALLS {
        let surface = match of {
            Of::Matte => builder.matte([ALBEDO as f32; 3]),
            Of::Lamp => glowing(&mut builder, [ALBEDO as f32; 3], [1.0; 3]),
            Of::Metal | Of::Mirror | Of::Water => {
                let roughness = matches!(of, Of::Metal).then_some([ALPHA as f32; 2]);
                let front = Some(builder.material(match of {
                    Of::Water => material::dielectric(WATER as f32, [1.0; 3], [1.0; 3], None),
                    _ => material::conductor([0.0; 3], [1.0; 3], [1.0; 3], roughness),
                }));
                builder.surface(SurfaceDescription { front, ..SurfaceDescription::default() })
            }
        };
        let (mut corner, mut a, mut b) = (DVec3::splat(-1.0), DVec3::ZERO, DVec3::ZERO);
        corner[axis] = at;
        a[(axis + 1) % 3] = 2.0;
        b[(axis + 2) % 3] = 2.0;
        // Normals point into the room, that of the water upwards.
        let (a, b) = if at == 1.0 { (b, a) } else { (a, b) };
        builder.parallelogram(corner * scale, a * scale, b * scale, surface);
    }
    look(&mut builder, SIZE, view.from * scale, view.at * scale, FOV)?;
    if let Some(camera) = builder.cameras.last_mut().filter(|_| view.lens > 0.0) {
        camera.projection = Projection::ThinLens { radius: view.lens * scale, focus: 1.5 * scale };
    }
    builder.finish()
}

/// One segment or more of a path, between two vertices that scatter by no delta lobe.
pub(super) struct Link {
    /// These vertices.
    pub from: usize,
    pub to: usize,
    /// Unit directions into it, at the one and at the other.
    pub directions: [DVec3; 2],
    /// Solid angle at the first one per area at the other, and the other way round; nothing goes towards a pinhole by its area.
    pub solid_angles: [f64; 2],
    /// Radiance at the first one over that at the other.
    pub scale: f64,
}

/// What a surface does at a vertex where the path goes on.
pub(super) struct Scattering {
    /// Of what comes from one direction, the part that goes on to the other: the BSDF times the cosine towards the light.
    pub passes: f64,
    /// Densities over solid angle of going on towards the light, and towards the camera.
    pub to_light: f64,
    pub to_camera: f64,
}

/// A path from the camera to the lamp as its definition needs it.
pub(super) struct Defined {
    pub segments: usize,
    /// It meets the lamp on its way.
    pub meets_lamp: bool,
    pub links: Vec<Link>,
    /// At the end of each link but the last one.
    pub scattering: Vec<Scattering>,
    view: View,
}

/// The wall that a vertex is on.
fn wall(position: DVec3, delta: bool) -> Wall {
    let on = WALLS.iter().filter(|wall| matches!(wall.2, Of::Mirror | Of::Water) == delta);
    let off = |(axis, at, _): &Wall| (position[*axis] - at).abs();
    on.copied().min_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or(WALLS[0])
}

/// Matte walls by Lambert's law, metal by Walter et al. 2007, equation 20, with normals drawn from those that are seen (Heitz 2014).
fn scattering((axis, _, of): Wall, to_camera: DVec3, to_light: DVec3) -> Scattering {
    let [o, i] = [to_camera[axis].abs(), to_light[axis].abs()];
    if !matches!(of, Of::Metal) {
        return Scattering { passes: ALBEDO / PI * i, to_light: i / PI, to_camera: o / PI };
    }
    let alpha2 = ALPHA * ALPHA;
    let h2 = (to_camera + to_light).normalize()[axis].powi(2);
    let d = alpha2 / (PI * (h2 * (alpha2 - 1.0) + 1.0).powi(2));
    let visible = |cosine: f64| 2.0 / (1.0 + (1.0 + alpha2 * (1.0 / (cosine * cosine) - 1.0)).sqrt());
    Scattering {
        passes: d * visible(o) * visible(i) / (4.0 * o),
        to_light: d * visible(o) / (4.0 * o),
        to_camera: d * visible(i) / (4.0 * i),
    }
}

/// Where a ray comes to that meets these walls, each with whether it passes through, and then the last one.
fn followed(from: DVec3, direction: DVec3, chain: &[(Wall, bool)], end: Wall) -> DVec3 {
    let (mut at, mut d) = (from, direction);
    let meet = |at: DVec3, d: DVec3, (axis, place, _): Wall| at + d * ((place - at[axis]) / d[axis]);
    for (wall, through) in chain {
        let axis = wall.0;
        at = meet(at, d, *wall);
        if *through {
            let mut refracted = d * if d[axis] < 0.0 { 1.0 / WATER } else { WATER };
            refracted[axis] = 0.0;
            refracted[axis] = d[axis].signum() * (1.0 - refracted.length_squared()).sqrt();
            d = refracted;
        } else {
            d[axis] = -d[axis];
        }
    }
    meet(at, d, end)
}

/// Solid angle at the first vertex per area at the last one of a chain, by differences between neighbouring rays.
fn solid_angle(vertices: &[DVec3], chain: &[(Wall, bool)], end: Wall) -> f64 {
    const STEP: f64 = 1e-5;
    let from = vertices[0];
    let direction = (vertices[1] - from).normalize();
    let (s, t) = direction.any_orthonormal_pair();
    let moved = |by: DVec3| followed(from, (direction + by * STEP).normalize(), chain, end);
    let across = |axis: DVec3| (moved(axis) - moved(-axis)) / (2.0 * STEP);
    1.0 / across(s).cross(across(t)).length()
}

impl Defined {
    /// A path of vertices, each with 1 where it scatters by a delta lobe, and its shortest segment or flattest cosine, whichever is less.
    pub fn of(vertices: &[[f32; 4]], segments: usize, view: View) -> (Self, f64) {
        let position = |i: usize| DVec3::from_array([0, 1, 2].map(|axis| f64::from(vertices[i][axis])));
        let is_delta = |i: usize| vertices[i][3] != 0.0;
        let (mut links, mut flattest, mut from) = (Vec::new(), 1.0f64, 0);
        for to in (1..=segments).filter(|i| !is_delta(*i)) {
            let points: Vec<DVec3> = (from..=to).map(position).collect();
            let (mut chain, mut scale) = (Vec::new(), 1.0);
            for i in from + 1..to {
                let on = wall(position(i), true);
                let (before, after) = (position(i) - position(i - 1), position(i + 1) - position(i));
                let through = before[on.0] * after[on.0] > 0.0;
                if through {
                    scale *= if before[on.0] < 0.0 { WATER.powi(-2) } else { WATER.powi(2) };
                }
                flattest =
                    [before, after].into_iter().map(|way| (way[on.0] / way.length()).abs()).fold(flattest, f64::min);
                chain.push((on, through));
            }
            let back: Vec<DVec3> = points.iter().rev().copied().collect();
            let chain_back: Vec<_> = chain.iter().rev().copied().collect();
            let directions = [points[1] - points[0], back[1] - back[0]].map(DVec3::normalize);
            let forwards = solid_angle(&points, &chain, wall(position(to), false));
            let backwards = match from {
                0 if view.lens == 0.0 => 0.0,
                0 => solid_angle(&back, &chain_back, (2, view.from.z, Of::Matte)),
                _ => solid_angle(&back, &chain_back, wall(position(from), false)),
            };
            flattest = points.windows(2).map(|pair| pair[0].distance(pair[1])).fold(flattest, f64::min);
            for (i, direction) in [from, to].into_iter().zip(directions).filter(|(i, _)| *i > 0) {
                flattest = flattest.min(direction[wall(position(i), false).0].abs());
            }
            links.push(Link { from, to, directions, solid_angles: [forwards, backwards], scale });
            from = to;
        }
        let at =
            |pair: &[Link]| scattering(wall(position(pair[0].to), false), pair[0].directions[1], pair[1].directions[0]);
        let scattering = links.windows(2).map(at).collect();
        let on_lamp = |i: usize| !is_delta(i) && matches!(wall(position(i), false).2, Of::Lamp);
        (Self { segments, meets_lamp: (1..segments).any(on_lamp), links, scattering, view }, flattest)
    }

    /// Density of directions at the camera, over solid angle: positions in the image are uniform.
    pub fn camera_density(&self) -> f64 {
        let side = 2.0 * (0.5 * FOV.to_radians()).tan();
        let cosine = (self.view.at - self.view.from).normalize().dot(self.links[0].directions[0]);
        1.0 / (cosine.powi(3) * side * side)
    }

    /// The contribution of the path, per area at its vertices: the mean over pixels of a sensor that answers by one.
    pub fn contribution(&self) -> f64 {
        let links: f64 = self.links.iter().map(|link| link.solid_angles[0] * link.scale).product();
        self.camera_density() * links * self.scattering.iter().map(|vertex| vertex.passes).product::<f64>()
    }

    /// Density with which the end of a link is made from its beginning, per area.
    pub fn forwards(&self, link: usize) -> f64 {
        let lobe = if link == 0 { self.camera_density() } else { self.scattering[link - 1].to_light };
        lobe * self.links[link].solid_angles[0]
    }

    /// And the other way round; the lamp's directions are in proportion to the cosine.
    pub fn backwards(&self, link: usize) -> f64 {
        let Link { directions, solid_angles, .. } = &self.links[link];
        let lobe = self.scattering.get(link).map_or(directions[1].y.abs() / PI, |vertex| vertex.to_camera);
        lobe * solid_angles[1]
    }
}
