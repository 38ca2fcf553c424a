//! The weights that `bdpt` gives to paths that it makes, against their definition: layers of strategies have a path by itself and weighted,
//! `shaders/kernels/test/joined_paths.glsl` has its vertices.

use std::collections::HashMap;
use std::f64::consts::PI;

use glam::DVec3;

use super::Run;
use super::defined_paths::{Defined, FLATTEST, LAMP_AREA, LENS, PINHOLE, View, room};
use super::figure::{Figure, Worst};
use crate::error::Result;
use crate::render::film::StrategyLayers;
use crate::render::{Probe, Settings};
use crate::techniques::{LONGEST, Strategies, Strategy};

/// Vertices of a path that fit into an answer.
const MOST: usize = 8;

/// A vertex of a path from the light.
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
struct FromLight {
    position: [f32; 3],
    /// 1 where it scatters by a delta lobe.
    delta: f32,
    /// The point of the camera that it is shown to, and the pixel; -1 is none.
    target: [f32; 3],
    seen_by: f32,
    /// Where the ray from here runs into the lens, and the pixel; -1 is nowhere.
    lens: [f32; 3],
    met_by: f32,
}

/// A vertex of a path from the camera.
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
struct FromCamera {
    position: [f32; 3],
    delta: f32,
    /// The point of the lamp that next-event estimation takes.
    lamp: [f32; 3],
    unused: f32,
}

/// Both paths of a pixel.
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
struct Answer {
    pixel: f32,
    light_count: f32,
    camera_count: f32,
    unused: f32,
    from_light: [FromLight; MOST],
    from_camera: [FromCamera; MOST],
}

/// A path by its vertices from the camera to the lamp, each with 1 where it scatters by a delta lobe.
type Vertices = Vec<[f32; 4]>;

impl Answer {
    /// The first t vertices from the camera, then the first s from the light, or the point that next-event estimation takes, where s is 1.
    /// Nothing where either has fewer, or they cannot be joined.
    fn joined(&self, Strategy { s, t }: Strategy) -> Option<Vertices> {
        let (s, t) = (s as usize, t as usize);
        if t > self.camera_count as usize || s > self.light_count as usize {
            return None;
        }
        let mut vertices: Vertices = self.from_camera[..t].iter().map(|v| with(v.position, v.delta)).collect();
        match s {
            1 => vertices.push(with(self.from_camera[t - 1].lamp, 0.0)),
            _ => vertices.extend(self.from_light[..s].iter().rev().map(|v| with(v.position, v.delta))),
        }
        let meet = |vertex: Option<&[f32; 4]>| vertex.is_some_and(|vertex| vertex[3] == 0.0);
        (s == 0 || meet(vertices.get(t - 1)) && meet(vertices.get(t))).then_some(vertices)
    }
}

fn with([x, y, z]: [f32; 3], delta: f32) -> [f32; 4] {
    [x, y, z, delta]
}

/// Solid angle of the triangle of the ceiling that this point is on, of the two that it is made of (Van Oosterom and Strackee 1983).
fn lamp_solid_angle(from: DVec3, point: DVec3) -> f64 {
    let corner = |x: f64, z: f64| DVec3::new(x, 1.0, z) - from;
    let third = if point.x > point.z { corner(1.0, -1.0) } else { corner(-1.0, 1.0) };
    let [a, b, c] = [corner(-1.0, -1.0), third, corner(1.0, 1.0)];
    let [la, lb, lc] = [a, b, c].map(DVec3::length);
    let below = la * lb * lc + a.dot(b) * lc + a.dot(c) * lb + b.dot(c) * la;
    2.0 * a.dot(b.cross(c)).abs().atan2(below)
}

impl Defined {
    /// Densities per area with which strategies make the path, with 0, 1, ... all of its vertices from the light; 0 where one cannot (Veach
    /// 1997, equations 10.7 to 10.9). `ends` are its last vertices but one and the last one.
    fn strategies(&self, lens: f64, ends: [DVec3; 2]) -> Vec<f64> {
        let count = self.links.len();
        let forwards = |links: std::ops::Range<usize>| links.map(|link| self.forwards(link)).product::<f64>();
        let backwards = |links: std::ops::Range<usize>| links.map(|link| self.backwards(link)).product::<f64>();
        let on_lens = if lens > 0.0 { 1.0 / (PI * lens * lens) } else { 1.0 };
        let mut all = vec![0.0; self.segments + 2];
        all[0] = on_lens * forwards(0..count);
        for (join, link) in self.links.iter().enumerate().filter(|(_, link)| link.to == link.from + 1) {
            let s = self.segments - link.from;
            // Next-event estimation takes one of two triangles, and of this one a direction.
            let end = if s == 1 && self.segments > 1 {
                let way = ends[1] - ends[0];
                0.5 / lamp_solid_angle(ends[0], ends[1]) * way.normalize().y.abs() / way.length_squared()
            } else {
                1.0 / LAMP_AREA
            };
            all[s] = on_lens * forwards(0..join) * end * backwards(join + 1..count);
        }
        // The first segment of a light subpath is not looked at: (1, 1) and (0, 2) do better.
        if lens > 0.0 && self.segments > 1 {
            all[self.segments + 1] = backwards(0..count) / LAMP_AREA;
        }
        all
    }
}

/// A heuristic's name and exponent.
type Heuristic = (&'static str, i32);

const POWER: Heuristic = ("power", 2);

/// What the layers of one sample say, by the strategies' numbers of vertices.
struct Layers(HashMap<(u32, u32), StrategyLayers>);

impl Layers {
    /// The weight that a strategy has in a pixel; nothing where it contributes too little there for layers to tell, which hold multiples of
    /// a small unit.
    fn weight(&self, Strategy { s, t }: Strategy, pixel: f32) -> Option<Weight> {
        let layers = self.0.get(&(s, t))?;
        let [alone, weighted] = [&layers.unweighted, &layers.weighted].map(|sums| sums[pixel as usize][1]);
        (alone > LEAST).then(|| Weight { value: weighted / alone, is_exact: weighted > LEAST })
    }
}

/// A weight, and whether the layers tell it to single precision, however small it is.
struct Weight {
    value: f64,
    is_exact: bool,
}

/// How far weights are off their definitions at most, also as shares of these, and how many were compared.
#[derive(Default)]
struct Found {
    off: Worst,
    off_share: Worst,
    count: usize,
}

/// Brought by a strategy, this is a million of the film's units in this room, whose lamp has a radiance of 1.
const LEAST: f64 = 1e-4;

/// The contribution of light subpaths to pixels, by connections to the camera or through the lens, by strategy and pixel: the path, where there is only one.
fn shown(answers: &[Answer]) -> HashMap<(u32, u32, u32), Vec<Vertices>> {
    let mut all: HashMap<_, Vec<Vertices>> = HashMap::new();
    for answer in answers {
        for (vertex, from) in (1..).zip(&answer.from_light[..answer.light_count as usize]) {
            let path = |from: [f32; 3]| {
                let light = answer.from_light[..vertex as usize].iter().rev().map(|v| with(v.position, v.delta));
                std::iter::once(with(from, 0.0)).chain(light).collect()
            };
            if from.seen_by >= 0.0 && from.delta == 0.0 {
                all.entry((vertex, 1, from.seen_by as u32)).or_default().push(path(from.target));
            }
            if from.met_by >= 0.0 {
                all.entry((vertex + 1, 0, from.met_by as u32)).or_default().push(path(from.lens));
            }
        }
    }
    all
}

/// The weights of one sample's paths, through a camera and by a heuristic, in a room of this scale.
fn measured(run: &mut Run, view: View, scale: f64, (heuristic, exponent): Heuristic) -> Result<Found> {
    let scene = room(view, scale)?;
    let strategies = Strategies::of(LONGEST, scene.camera(None)?);
    let technique = format!("bdpt:weights={heuristic}");
    let settings = Settings {
        strategies: Some(strategies),
        max_depth: Some(LONGEST),
        rr_depth: u32::MAX,
        ..run.settings(&scene, &technique)?
    };
    let film = run.render(&scene, &settings, 1)?;
    let layers =
        Layers(film.strategies.into_iter().map(|layers| ((layers.strategy.s, layers.strategy.t), layers)).collect());
    let pixels = settings.width * settings.height;
    let answers: Vec<Answer> =
        Probe::new(run.gpu, &scene, &settings, "test/joined_paths")?.run(&vec![0u32; pixels as usize])?;
    let mut found = Found::default();
    let mut see = |strategy: Strategy, pixel: f32, vertices: &[[f32; 4]]| {
        let Some(weight) = layers.weight(strategy, pixel) else { return };
        let unit: Vertices = vertices
            .iter()
            .map(|[x, y, z, delta]| {
                let [x, y, z] = [x, y, z].map(|x| (f64::from(*x) / scale) as f32);
                [x, y, z, *delta]
            })
            .collect();
        let Some(expected) = defined(&unit, strategy, view, exponent) else { return };
        let off = (weight.value - expected).abs();
        let place = || format!("{}, pixel {pixel}: {} against {expected}", strategy.name(), weight.value);
        found.count += 1;
        found.off.see(off, place);
        if weight.is_exact {
            found.off_share.see(off / expected, place);
        }
    };
    for answer in &answers {
        for strategy in strategies.all().filter(|strategy| strategy.t > 1) {
            if let Some(vertices) = answer.joined(strategy) {
                see(strategy, answer.pixel, &vertices);
            }
        }
    }
    for ((s, t, pixel), paths) in shown(&answers) {
        // Layers cannot tell two paths in one pixel apart.
        if let [path] = paths.as_slice() {
            see(Strategy { s, t }, pixel as f32, path);
        }
    }
    Ok(found)
}

/// The weight of a strategy for a path, by definition; nothing where single precision tells too little of the path.
fn defined(vertices: &[[f32; 4]], strategy: Strategy, view: View, exponent: i32) -> Option<f64> {
    let segments = vertices.len() - 1;
    let (path, flattest) = Defined::of(vertices, segments, view);
    let at = |i: usize| DVec3::from_array([0, 1, 2].map(|axis| f64::from(vertices[i][axis])));
    let densities = path.strategies(view.lens, [at(segments - 1), at(segments)]);
    let share = |density: f64| if exponent == 0 { f64::from(u8::from(density > 0.0)) } else { density.powi(exponent) };
    let shares: Vec<f64> = densities.into_iter().map(share).collect();
    (flattest >= 4.0 * FLATTEST).then(|| shares[strategy.s as usize] / shares.iter().sum::<f64>())
}

/// Each weight against its definition, to a pinhole and to a lens, however large the scene is.
pub(super) fn path_weights(run: &mut Run) -> Result<()> {
    let mut rooms = vec![("a lens", LENS, 1e-4, POWER)];
    if !run.is_short() {
        rooms.push(("a pinhole", PINHOLE, 1e4, POWER));
    }
    if run.is_long() {
        rooms.extend([
            ("a pinhole", PINHOLE, 1.0, POWER),
            ("a pinhole", PINHOLE, 1.0, ("balance", 1)),
            ("a lens", LENS, 1.0, POWER),
            ("a lens", LENS, 1.0, ("none", 0)),
        ]);
    }
    for (camera, view, scale, heuristic) in rooms {
        let found = measured(run, view, scale, heuristic)?;
        let technique = format!("bdpt:weights={}", heuristic.0);
        let what = |what: &str| format!("{camera}, scale {scale}: {what}");
        // What single precision loses of a density counts as often as the heuristic multiplies by it.
        let times = f64::from(heuristic.1.max(1));
        run.note(found.off.figure(&technique, what("a weight off its definition"), 1e-5 * times));
        run.note(found.off_share.figure(&technique, what("the same as a share of the weight"), 5e-5 * times));
        run.note(Figure::told(&technique, what("paths compared"), found.count as f64));
    }
    Ok(())
}
