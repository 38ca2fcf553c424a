//! What decides on mutations of paths, through `shaders/test/mutations.glsl`, against the densities by their definition.
//!
//! A mutation from path x to path y is to be accepted with probability f(y) T(y to x) / (f(x) T(x to y)) (Hastings 1970), where f is what a path
//! brings and T the density with which it is proposed, both per area at all vertices that scatter by no delta lobe. Here they are
//! multiplied out in double precision. What mirrors and water in between do to a solid angle is not derived but measured, by
//! following neighbouring rays: nothing is shared with the shader but the path itself.

use std::f64::consts::PI;

use glam::DVec3;

use super::Run;
use super::figure::{Figure, Worst};
use super::geometry::{glowing, look};
use crate::error::Result;
use crate::render::{Probe, Renderer, Settings};
use crate::scene::{Scene, SceneBuilder, SurfaceDescription, material};

/// Vertices of the longest path that is looked at.
const MOST: usize = 9;
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
const LAMP_AREA: f64 = 4.0;
/// Paths with a shorter segment or a flatter cosine than this are left to others: single precision tells too little of them.
const FLATTEST: f64 = 0.05;

/// What a wall is of.
#[derive(Clone, Copy)]
enum Of {
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

/// The kinds of mutations, as `shaders/lib/path_mutations.glsl` has them.
const KINDS: [&str; 4] = ["large step", "bidirectional", "from the camera", "towards the camera"];

/// Large steps that run until they meet a light do so surely as far as this vertex, and with this probability at each further one.
const RUN_SURE: usize = 4;
const RUN_ON: f64 = 0.75;

/// What the kernel says of one chain.
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
struct Answer {
    /// What decides; 0 where nothing was proposed.
    ratio: f32,
    kind: f32,
    from_segments: f32,
    segments: f32,
    /// The vertices in between were made anew.
    first: f32,
    last: f32,
    unused: [f32; 2],
    /// The paths: positions, and 1 where it is scattered by a delta lobe.
    from: [[f32; 4]; MOST],
    to: [[f32; 4]; MOST],
}

/// Where the camera is, and what it looks at.
fn eye() -> (DVec3, DVec3) {
    (DVec3::new(0.2, 0.35, 0.9), DVec3::new(-0.3, -0.3, -1.0))
}

/// A room with a mirror and rough metal for walls, half full of water, under a glowing ceiling.
fn room() -> Result<Scene> {
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
        builder.parallelogram(corner, a, b, surface);
    }
    let (from, at) = eye();
    look(&mut builder, SIZE, from, at, FOV)?;
    builder.finish()
}

/// One segment or more of a path, between two vertices that scatter by no delta lobe.
struct Link {
    /// These vertices.
    from: usize,
    to: usize,
    /// Unit directions into it, at the one and at the other.
    directions: [DVec3; 2],
    /// Solid angle at the first one per area at the other, and the other way round.
    solid_angles: [f64; 2],
    /// Radiance at the first one over that at the other.
    scale: f64,
}

/// What a surface does at a vertex where the path goes on.
struct Scattering {
    /// Of what comes from one direction, the part that goes on to the other: the BSDF times the cosine towards the light.
    passes: f64,
    /// Densities over solid angle of going on towards the light, and towards the camera.
    to_light: f64,
    to_camera: f64,
}

/// A path as its definition needs it.
struct Measured {
    segments: usize,
    /// It meets the lamp on its way.
    meets_lamp: bool,
    links: Vec<Link>,
    /// At the end of each link but the last one.
    scattering: Vec<Scattering>,
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
    const STEP: f64 = 1e-4;
    let from = vertices[0];
    let direction = (vertices[1] - from).normalize();
    let (s, t) = direction.any_orthonormal_pair();
    let moved = |by: DVec3| followed(from, (direction + by * STEP).normalize(), chain, end);
    let across = |axis: DVec3| (moved(axis) - moved(-axis)) / (2.0 * STEP);
    1.0 / across(s).cross(across(t)).length()
}

impl Measured {
    /// A path, and its shortest segment or flattest cosine, whichever is less.
    fn of(vertices: &[[f32; 4]], segments: usize) -> (Self, f64) {
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
                flattest = flattest.min((after[on.0] / after.length()).abs());
                chain.push((on, through));
            }
            let back: Vec<DVec3> = points.iter().rev().copied().collect();
            let chain_back: Vec<_> = chain.iter().rev().copied().collect();
            let directions = [points[1] - points[0], back[1] - back[0]].map(DVec3::normalize);
            let forwards = solid_angle(&points, &chain, wall(position(to), false));
            // Nothing goes towards the pinhole by its area.
            let backwards = if from == 0 { 0.0 } else { solid_angle(&back, &chain_back, wall(position(from), false)) };
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
        (Self { segments, meets_lamp: (1..segments).any(on_lamp), links, scattering }, flattest)
    }

    /// Density of directions at the camera, over solid angle: positions in the image are uniform.
    fn camera_density(&self) -> f64 {
        let side = 2.0 * (0.5 * FOV.to_radians()).tan();
        let cosine = (eye().1 - eye().0).normalize().dot(self.links[0].directions[0]);
        1.0 / (cosine.powi(3) * side * side)
    }

    /// What the path brings, per area at its vertices: the mean over pixels of a sensor that answers by one.
    fn brings(&self) -> f64 {
        let links: f64 = self.links.iter().map(|link| link.solid_angles[0] * link.scale).product();
        self.camera_density() * links * self.scattering.iter().map(|vertex| vertex.passes).product::<f64>()
    }

    /// Density with which the end of a link is made from its beginning, per area.
    fn forwards(&self, link: usize) -> f64 {
        let lobe = if link == 0 { self.camera_density() } else { self.scattering[link - 1].to_light };
        lobe * self.links[link].solid_angles[0]
    }

    /// And the other way round; the lamp's directions are in proportion to the cosine.
    fn backwards(&self, link: usize) -> f64 {
        let Link { directions, solid_angles, .. } = &self.links[link];
        let lobe = self.scattering.get(link).map_or(directions[1].y.abs() / PI, |vertex| vertex.to_camera);
        lobe * solid_angles[1]
    }

    /// Density of making the vertices between two others, each number of them from the camera as likely as any other.
    fn bidirectional(&self, first: usize, last: usize) -> f64 {
        let of_light = last > self.segments;
        let inside: Vec<(usize, &Link)> =
            self.links.iter().enumerate().filter(|(_, link)| link.from >= first && link.to <= last).collect();
        let joined = |j: usize| -> f64 {
            let made = |(index, link): &(usize, &Link)| match (link.to <= j, link.from > j) {
                (true, _) => self.forwards(*index),
                (_, true) => self.backwards(*index),
                _ => 1.0,
            };
            let densities: f64 = inside.iter().map(made).product();
            densities * if of_light && j < self.segments { 1.0 / LAMP_AREA } else { 1.0 }
        };
        let joins = inside.iter().filter(|(_, link)| link.to == link.from + 1).map(|(_, link)| link.from);
        let sum: f64 = joins.chain(of_light.then_some(self.segments)).map(joined).sum();
        sum / (last - first) as f64
    }

    /// Density of large steps, `shares` of which are of each number of segments, and the last one of what runs until it meets the lamp.
    fn large(&self, shares: &[f64]) -> f64 {
        let from_camera: f64 = (0..self.links.len()).map(|link| self.forwards(link)).product();
        let goes_on = RUN_ON.powi(self.segments.saturating_sub(RUN_SURE) as i32);
        let runs = if self.meets_lamp { 0.0 } else { shares[MOST - 1] * goes_on * from_camera };
        runs + shares[self.segments - 1] * self.bidirectional(0, self.segments + 1)
    }

    /// Density with which a mutation of this kind proposes it, up to what is the same of the way back.
    fn proposed(&self, kind: usize, first: usize, last: usize, from_segments: usize, shares: &[f64]) -> f64 {
        let made = self.links.iter().filter(|link| link.to < last);
        match kind {
            0 => self.large(shares),
            1 => self.bidirectional(first, last) / (from_segments + 1) as f64,
            // The place in the image and directions are moved as far as back again.
            2 => self.camera_density() * made.map(|link| link.solid_angles[0]).product::<f64>(),
            _ => self.links.iter().filter(|link| link.to == last).map(|link| link.solid_angles[1]).product(),
        }
    }
}

/// The ratio that decides, by its definition, and the flattest of both paths. `shares` are the probabilities of kinds of large steps.
fn defined(answer: &Answer, shares: &[f64]) -> (f64, f64) {
    let [kind, from_segments, segments, first, last] =
        [answer.kind, answer.from_segments, answer.segments, answer.first, answer.last].map(|number| number as usize);
    let (x, flattest_x) = Measured::of(&answer.from, from_segments);
    let (y, flattest_y) = Measured::of(&answer.to, segments);
    let there = y.proposed(kind, first, last, from_segments, shares);
    let back = x.proposed(kind, first, last + from_segments - segments, segments, shares);
    (y.brings() * back / (x.brings() * there), flattest_x.min(flattest_y))
}

/// Each mutation's ratio against its definition.
pub(super) fn balance(run: &mut Run) -> Result<()> {
    let scene = room()?;
    let technique = "mlt:form=paths:chains=4096:candidates=65536:large-step=0.2";
    let settings = Settings { max_depth: Some(MOST as u32 - 1), ..run.settings(&scene, technique)? };
    let mut renderer = Renderer::new(run.gpu, &scene, &settings)?;
    while renderer.advance(2)? {}
    let shares = renderer.kind_shares();
    let probe = Probe::new(run.gpu, &scene, &settings, "test/mutations")?;
    let mut worst: [Worst; 4] = Default::default();
    let mut counts = [0; 4];
    for round in 0..run.pick(8, 2) {
        let answers: Vec<Answer> = probe.run_on_chains(&renderer, &vec![1_000_000 + round; 4096])?;
        for (chain, answer) in answers.iter().enumerate().filter(|(_, answer)| answer.ratio > 0.0) {
            let (expected, flattest) = defined(answer, &shares);
            if flattest < FLATTEST {
                continue;
            }
            let kind = answer.kind as usize;
            counts[kind] += 1;
            worst[kind].see((f64::from(answer.ratio) / expected - 1.0).abs(), || {
                let Answer { from_segments, segments, first, last, ratio, .. } = answer;
                format!(
                    "chain {chain}, {from_segments} to {segments} segments, vertices {first} to {last}: {ratio} against {expected}"
                )
            });
        }
    }
    for ((kind, worst), count) in KINDS.iter().zip(worst).zip(counts) {
        run.note(worst.figure("mlt:form=paths", format!("{kind}: the ratio off its definition"), 1e-3));
        run.note(Figure::told("mlt:form=paths", format!("{kind}: proposals compared"), f64::from(count)));
    }
    Ok(())
}
