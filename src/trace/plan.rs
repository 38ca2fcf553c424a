//! A trace in the plan of its scene, as SVG: seen from above, as the camera has it.

use std::collections::HashMap;
use std::fmt::Write;

use glam::{DVec2, DVec3};

use super::types::{Subpath, Trace};
use crate::error::Result;
use crate::layout::SPHERE_BIT;
use crate::scene::Scene;

/// Width of the picture.
const WIDTH: f64 = 900.0;
/// Around the plan.
const MARGIN: f64 = 30.0;
/// Edges that are drawn of a scene; of larger ones every so manieth.
const MOST_EDGES: usize = 20_000;
/// Triangles that are looked at.
const MOST_TRIANGLES: usize = 400_000;
/// Cosine between the normals of neighbours, below which their common edge is drawn.
const CREASE: f64 = 0.94;

/// The two axes of the plan: across and down. What is left out is the axis closest to the camera's up.
struct Axes {
    across: DVec3,
    down: DVec3,
    name: String,
}

impl Axes {
    fn of(scene: &Scene, camera: Option<&str>) -> Result<Self> {
        let up = scene.camera(camera)?.to_world.matrix3.y_axis.abs();
        let axis = |dropped: DVec3, across: DVec3, down: DVec3, name: &str| Self {
            across,
            down,
            name: format!("{name} (without {})", letter(dropped)),
        };
        Ok(if up.y >= up.x && up.y >= up.z {
            axis(DVec3::Y, DVec3::X, DVec3::Z, "x to the right, z down")
        } else if up.z >= up.x {
            axis(DVec3::Z, DVec3::X, DVec3::NEG_Y, "x to the right, y up")
        } else {
            axis(DVec3::X, DVec3::Z, DVec3::NEG_Y, "z to the right, y up")
        })
    }

    fn project(&self, p: DVec3) -> DVec2 {
        DVec2::new(p.dot(self.across), p.dot(self.down))
    }
}

fn letter(axis: DVec3) -> char {
    if axis == DVec3::X {
        'x'
    } else if axis == DVec3::Y {
        'y'
    } else {
        'z'
    }
}

/// What the scene looks like in plan: segments and circles in world coordinates.
#[derive(Default)]
struct Outline {
    segments: Vec<[DVec2; 2]>,
    circles: Vec<(DVec2, f64)>,
}

/// The edges of meshes where they end or turn, and spheres.
fn outline(scene: &Scene, axes: &Axes) -> Outline {
    let mut out = Outline::default();
    let mut left = MOST_TRIANGLES;
    for placed in &scene.instances {
        let group = &scene.groups[placed.group];
        let world = |p: [f32; 3]| placed.to_world.transform_point3(DVec3::from(p.map(f64::from))) + scene.origin;
        let triangles = group.triangles.start as usize..group.triangles.end as usize;
        // Vertices are told by their bits: neighbours have the same.
        let mut edges: HashMap<[[u32; 3]; 2], (usize, DVec3, bool)> = HashMap::new();
        for primitive in scene.primitives[triangles].iter().take(left) {
            let corners = [primitive.v0, primitive.v1, primitive.v2];
            let [a, b, c] = corners.map(world);
            let normal = (b - a).cross(c - a).normalize_or_zero();
            for side in 0..3 {
                let bits = [corners[side], corners[(side + 1) % 3]].map(|corner| corner.map(f32::to_bits));
                let key = if bits[0] <= bits[1] { bits } else { [bits[1], bits[0]] };
                let edge = edges.entry(key).or_insert((0, normal, false));
                edge.0 += 1;
                edge.2 |= edge.1.dot(normal).abs() < CREASE;
            }
        }
        left = left.saturating_sub(group.triangles.len());
        let drawn = edges.into_iter().filter(|(_, (count, _, turns))| *count != 2 || *turns);
        let ends = drawn.map(|(key, _)| key.map(|corner| axes.project(world(corner.map(f32::from_bits)))));
        out.segments.extend(ends);
        for index in group.spheres.clone() {
            let sphere = &scene.primitives[index as usize];
            debug_assert!(sphere.surface & SPHERE_BIT != 0);
            let radius = placed.to_world.transform_vector3(DVec3::X * f64::from(sphere.v1[0])).length();
            out.circles.push((axes.project(world(sphere.v0)), radius));
        }
    }
    // The same order each time, whatever the table's.
    let key = |segment: &[DVec2; 2]| segment.map(|end| end.to_array().map(f64::to_bits));
    out.segments.sort_unstable_by_key(key);
    let step = out.segments.len().div_ceil(MOST_EDGES).max(1);
    out.segments = out.segments.into_iter().step_by(step).collect();
    out
}

/// Where points of the plan lie in the picture.
struct Frame {
    least: DVec2,
    scale: f64,
    height: f64,
}

impl Frame {
    fn around(points: impl Iterator<Item = DVec2>) -> Self {
        let finite = points.filter(|point| point.is_finite());
        let (least, most) = finite.fold((DVec2::MAX, DVec2::MIN), |(least, most), p| (least.min(p), most.max(p)));
        let (least, size) = if least.x <= most.x { (least, most - least) } else { (DVec2::ZERO, DVec2::ONE) };
        let scale = (WIDTH - 2.0 * MARGIN) / size.x.max(size.y * 0.8).max(1e-9);
        Self { least, scale, height: size.y * scale + 2.0 * MARGIN }
    }

    fn place(&self, p: DVec2) -> DVec2 {
        (p - self.least) * self.scale + MARGIN
    }
}

/// The scene in plan with the trace's subpaths in it; segments to light samples are dashed, those in shadow grey, and so is the one that joins the two subpaths
/// of a chain's path.
///
/// Fails where the scene has no camera of that name.
pub fn svg(scene: &Scene, trace: &Trace, camera: Option<&str>) -> Result<String> {
    let axes = Axes::of(scene, camera)?;
    let outline = outline(scene, &axes);
    let project = |p: [f64; 3]| axes.project(DVec3::from(p));
    let of_path = |path: &Subpath| {
        std::iter::once(project(path.beginning.position))
            .chain(path.vertices.iter().map(|vertex| project(vertex.position)))
            .collect::<Vec<_>>()
    };
    let circles = outline.circles.iter().flat_map(|(centre, radius)| [*centre - *radius, *centre + *radius]);
    let frame = Frame::around(
        outline.segments.iter().flatten().copied().chain(circles).chain(trace.subpaths.iter().flat_map(of_path)),
    );
    let mut out = format!(
        r##"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {:.0}" font-family="sans-serif" font-size="13">
<rect width="100%" height="100%" fill="#fff"/>
<g stroke="#bbb" stroke-width="0.7" fill="none"><path d=""##,
        frame.height + 24.0
    );
    for segment in &outline.segments {
        let [a, b] = segment.map(|end| frame.place(end));
        let _ = write!(out, "M{:.1} {:.1}L{:.1} {:.1}", a.x, a.y, b.x, b.y);
    }
    out += "\"/>\n";
    for (centre, radius) in &outline.circles {
        let c = frame.place(*centre);
        let _ = writeln!(out, r#"<circle cx="{:.1}" cy="{:.1}" r="{:.1}"/>"#, c.x, c.y, radius * frame.scale);
    }
    out += "</g>\n";
    for path in &trace.subpaths {
        let colour = if path.from_light { "#c60" } else { "#06c" };
        lights(&mut out, path, &frame, &project);
        polyline(&mut out, path, &frame, &project, colour);
    }
    if let (Some(_), [camera, light]) = (&trace.proposal, trace.subpaths.as_slice()) {
        let [a, b] = [camera, light].map(|path| frame.place(project(path.end())));
        dashed(&mut out, a, b, "#c60");
    }
    let [x, y] = trace.pixel;
    let about = format!("{}: {}, pixel {x},{y}, sample {}; {}", trace.scene, trace.integrator, trace.sample, axes.name);
    let about = crate::report::html::escape(&about);
    let _ = writeln!(out, r##"<text x="{MARGIN}" y="{:.0}" fill="#333">{about}</text>"##, frame.height + 10.0);
    out += "</svg>\n";
    Ok(out)
}

fn lights(out: &mut String, path: &Subpath, frame: &Frame, project: &impl Fn([f64; 3]) -> DVec2) {
    for vertex in &path.vertices {
        let from = frame.place(project(vertex.position));
        for light in &vertex.light_samples {
            let direction = project(light.direction) * (60.0 / frame.scale);
            let to = light.position.map_or(project(vertex.position) + direction, project);
            let to = frame.place(to);
            let colour = if light.transmittance > 0.0 { "#e0a000" } else { "#999" };
            dashed(out, from, to, colour);
        }
    }
}

fn dashed(out: &mut String, from: DVec2, to: DVec2, colour: &str) {
    let _ = writeln!(
        out,
        r#"<path d="M{:.1} {:.1}L{:.1} {:.1}" stroke="{colour}" stroke-dasharray="5 4" fill="none"/>"#,
        from.x, from.y, to.x, to.y
    );
}

fn polyline(out: &mut String, path: &Subpath, frame: &Frame, project: &impl Fn([f64; 3]) -> DVec2, colour: &str) {
    let begins = frame.place(project(path.beginning.position));
    let mut d = format!("M{:.1} {:.1}", begins.x, begins.y);
    let mut marks = format!(r#"<circle cx="{:.1}" cy="{:.1}" r="5" fill="{colour}"/>"#, begins.x, begins.y);
    for vertex in &path.vertices {
        let p = frame.place(project(vertex.position));
        let _ = write!(d, "L{:.1} {:.1}", p.x, p.y);
        let _ = write!(
            marks,
            r##"<circle cx="{:.1}" cy="{:.1}" r="3.5" fill="{colour}"/><text x="{:.1}" y="{:.1}" fill="{colour}">{}</text>"##,
            p.x,
            p.y,
            p.x + 6.0,
            p.y - 5.0,
            vertex.index
        );
    }
    let left = path.vertices.last().map_or((path.beginning.position, path.beginning.direction), |vertex| {
        (vertex.position, vertex.scatterings.last().map_or([0.0; 3], |scattering| scattering.direction))
    });
    if path.leaves_the_scene() {
        let from = frame.place(project(left.0));
        let to = from + project(left.1) * 60.0;
        let _ = write!(d, "M{:.1} {:.1}L{:.1} {:.1}", from.x, from.y, to.x, to.y);
    }
    let _ = writeln!(out, r#"<path d="{d}" stroke="{colour}" stroke-width="1.8" fill="none"/>{marks}"#);
}
