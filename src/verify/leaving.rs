//! Rays that leave the surface that the ray before them has met, through `shaders/kernels/test/leave.glsl`.

use glam::{DAffine3, DVec3, Vec3};

use super::Run;
use super::figure::{Figure, Worst};
use super::geometry::Random;
use crate::error::Result;
use crate::layout::Primitive;
use crate::render::Probe;
use crate::scene::{Mesh, SceneBuilder};

/// Origin, direction, length, direction of the second ray.
type Query = [f32; 10];

/// What the kernel says of one query.
struct Answer {
    t: f32,
    primitive: u32,
    margin: f32,
    position: DVec3,
    next_t: f32,
    next: u32,
}

fn ask(probe: &Probe, queries: &[Query]) -> Result<Vec<Answer>> {
    let words: Vec<[u32; 12]> = probe.run(queries)?;
    let order = |index: u32| probe.order().get(index as usize).copied().unwrap_or(u32::MAX);
    let answer = |w: &[u32; 12]| {
        let f = w.map(f32::from_bits);
        let position = Vec3::new(f[4], f[5], f[6]).as_dvec3();
        Answer { t: f[0], primitive: order(w[1]), margin: f[3], position, next_t: f[10], next: order(w[11]) }
    };
    Ok(words.iter().map(answer).collect())
}

fn query(origin: DVec3, direction: DVec3, w: DVec3) -> Query {
    let [o, d, w] = [origin, direction.normalize(), w].map(|v| v.as_vec3().to_array());
    [o[0], o[1], o[2], d[0], d[1], d[2], 3e38, w[0], w[1], w[2]]
}

fn corners(primitive: &Primitive) -> [DVec3; 3] {
    [primitive.v0, primitive.v1, primitive.v2].map(|v| Vec3::from(v).as_dvec3())
}

/// Triangles with coordinates of 10^-8 to 10^8, all in one scene; each is met a thousand times, and left in directions of both sides.
pub(super) fn self_intersection(run: &mut Run) -> Result<()> {
    let (triangles, rays) = run.pick((1000, 1000), (200, 200));
    let mut random = Random(41);
    let mut builder = SceneBuilder::new("triangles");
    let surface = builder.matte([0.5; 3]);
    let mut mesh = Mesh::default();
    for index in 0..triangles {
        let first = mesh.positions.len() as u32;
        for _ in 0..3 {
            let mut coordinate = || {
                let sign = if random.next() < 0.5 { -1.0 } else { 1.0 };
                sign * 10f64.powf(16.0 * random.next() - 8.0)
            };
            // Every fourth is small for where it lies.
            let corner = DVec3::new(coordinate(), coordinate(), coordinate());
            let last = mesh.positions.last().copied().unwrap_or_default();
            let near = index % 4 == 0 && mesh.positions.len() as u32 > first;
            mesh.positions.push(if near { last + random.direction() * 1e-3 * last.length() } else { corner });
        }
        mesh.triangles.push([first, first + 1, first + 2]);
    }
    builder.mesh(0, "triangles", mesh, DAffine3::IDENTITY, surface);
    builder.background = Some([1.0; 3]);
    let scene = builder.finish()?;
    let probe = run.probe(&scene, "leave")?;
    let (mut met, mut again, mut first) = (0usize, 0usize, String::new());
    let (mut ulps, mut margins) = (Worst::default(), Worst::default());
    let all: Vec<usize> = (0..scene.primitives.len()).collect();
    for some in all.chunks(100) {
        let mut queries = Vec::new();
        for slot in some {
            let [a, b, c] = corners(&scene.primitives[*slot]);
            let normal = (b - a).cross(c - a).normalize_or(DVec3::X);
            let size = (b - a).length().max((c - a).length());
            for _ in 0..rays {
                let (u, v) = (random.next(), random.next());
                let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
                let target = a + (b - a) * u + (c - a) * v;
                let side = if random.next() < 0.5 { -1.0 } else { 1.0 };
                let aside = random.direction();
                let away = (normal * side + aside * 0.9).normalize();
                let origin = (target + away * size * 10f64.powf(-4.0 * random.next())).as_vec3().as_dvec3();
                queries.push(query(origin, target - origin, random.direction()));
            }
        }
        for (answer, query) in ask(&probe, &queries)?.iter().zip(&queries) {
            if answer.t < 0.0 {
                continue;
            }
            // The one that was aimed at, or another one before it.
            let slot = answer.primitive;
            met += 1;
            if answer.next_t >= 0.0 && answer.next == answer.primitive {
                again += 1;
                if first.is_empty() {
                    first = format!("triangle {slot}, query {query:?}: met again at {:e}", answer.next_t);
                }
            }
            let [a, b, c] = corners(&scene.primitives[slot as usize]);
            let normal = (b - a).cross(c - a).normalize_or_zero();
            let off = normal.dot(answer.position - a).abs();
            margins.see(off / f64::from(answer.margin), || {
                format!("triangle {slot}: {off:e} off its plane, margin {:e}", answer.margin)
            });
            let (origin, direction) = (
                DVec3::new(query[0].into(), query[1].into(), query[2].into()),
                DVec3::new(query[3].into(), query[4].into(), query[5].into()),
            );
            let there = origin + direction * f64::from(answer.t);
            let scale = answer.position.abs().max(origin.abs()).max_element().max(f64::from(answer.t));
            let far = (there - answer.position).length() / (scale * f64::from(f32::EPSILON));
            ulps.see(far, || format!("triangle {slot}, query {query:?}"));
        }
    }
    let missed = 1.0 - met as f64 / (triangles * rays) as f64;
    run.note(Figure::at_most("leave", "share of rays that met nothing to leave", missed, 0.1));
    run.note(
        Figure::at_most("leave", format!("rays that meet the triangle that they leave, of {met}"), again as f64, 0.0)
            .worst(first),
    );
    run.note(margins.figure("leave", "a point's distance from its plane, in margins of the offset", 1.0));
    let place = ulps.place.clone();
    run.note(
        Figure::told("leave", "largest |o + t d - p|, in ulps of the largest coordinate or t", ulps.value).worst(place),
    );
    shells(run)
}

/// Two squares of side 1 that stand 4e-5 apart, at the origin and at (100, 100, 100): what leaves the lower one upwards meets the upper.
fn shells(run: &mut Run) -> Result<()> {
    let gap = 4e-5;
    for (name, at) in [("at the origin", DVec3::ZERO), ("within a scene of size 10", DVec3::splat(3.0))] {
        let mut builder = SceneBuilder::new("shells");
        let surface = builder.matte([0.5; 3]);
        let (right, back) = (DVec3::X, DVec3::Z);
        builder.parallelogram(at, back, right, surface);
        builder.parallelogram(at + DVec3::Y * gap, right, back, surface);
        builder.parallelogram(at - DVec3::splat(5.0), right, back, surface);
        builder.parallelogram(at + DVec3::splat(5.0), right, back, surface);
        let scene = builder.finish()?;
        let mut random = Random(43);
        let queries: Vec<Query> = (0..run.pick(100_000, 20_000))
            .map(|_| {
                let target = at + DVec3::new(0.3 + 0.4 * random.next(), 0.0, 0.3 + 0.4 * random.next());
                // From below, and on upwards at up to 85 degrees.
                let origin = target - DVec3::new(random.next() - 0.5, 1.0, random.next() - 0.5);
                let w = DVec3::new(random.next() - 0.5, 0.09 + random.next(), random.next() - 0.5).normalize();
                query(origin, target - origin, w)
            })
            .collect();
        let mut lost = Worst::default();
        let mut count = 0;
        let answers = ask(&run.probe(&scene, "leave")?, &queries)?;
        for (index, answer) in answers.iter().enumerate() {
            let lower = answer.t > 0.0 && answer.primitive < 2;
            if !(lower && (2..4).contains(&answer.next)) {
                count += 1;
                lost.see(1.0, || format!("query {:?}: met {}, then {}", queries[index], answer.primitive, answer.next));
            }
        }
        let what = format!("shells 4e-5 of their size apart, {name}: rays that pass the second, of {}", queries.len());
        run.note(Figure::at_most("leave", what, f64::from(count), 0.0).worst(lost.place));
    }
    Ok(())
}
