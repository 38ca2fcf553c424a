//! A tree over lights, from which one is chosen by a bound on its contribution to a point (Conty Estevez and Kulla 2018, "Importance
//! sampling of many lights with adaptive tree splitting").
//!
//! Each node bounds the places, the directions and the intensity of the lights below it. At a point, descending by the
//! children's importance there chooses a light in logarithmic time; the product of the choices is its probability. Bounds are
//! conservative: a light that can shed anything on a point is never left out, or the estimate would be biased.

use std::f64::consts::PI;

use glam::{DVec2, DVec3, Vec3};

use super::light::{importance, triangle_area, unreachable_kind};
use crate::layout::{
    LIGHT_LEAF_BIT, LIGHT_POINT, LIGHT_PROJECTOR, LIGHT_SPHERE, LIGHT_SPOT, LIGHT_TRIANGLE, Light, LightNode,
};

/// A tree over lights; empty where all are selected from the table.
#[derive(Clone, Debug, Default)]
pub(super) struct LightTree {
    /// The nodes, the root first; children lie side by side.
    pub nodes: Vec<LightNode>,
    /// Origin of their coordinates.
    pub origin: Vec3,
    /// Factor on coordinates relative to that.
    pub scale: f32,
}

/// Candidates of a split along each axis.
const BINS: usize = 12;
/// Levels that a trail of 32 bits can tell apart.
const MOST_LEVELS: u32 = 31;
/// Added to half angles of cones, radians: more than what packing their axis and their cosine takes away.
const CONE_MARGIN: f64 = 1e-3;

/// What some lights have in common.
#[derive(Clone, Copy, Debug)]
struct LightBounds {
    min: DVec3,
    max: DVec3,
    /// Axis of the cone of directions that they face.
    axis: DVec3,
    /// Half angle of that cone.
    facing: f64,
    /// Angle to the direction that a light faces beyond which it sheds nothing.
    spread: f64,
    /// Sum of their greatest radiant intensities, W/sr.
    intensity: f64,
}

impl LightBounds {
    /// Of one light that lies at a finite place; `factor` is what its texture leaves of its intensity.
    fn of(light: &Light, factor: f64) -> Self {
        let at = |v: [f32; 3]| Vec3::from(v).as_dvec3();
        let point = |axis: DVec3, facing: f64, spread: f64| {
            let position = at(light.position);
            (position, position, axis, facing, spread)
        };
        let strength = factor * importance(light.radiance.map(f64::from));
        let ((min, max, axis, facing, spread), intensity) = match light.kind {
            LIGHT_TRIANGLE => {
                let [v0, v1, v2] = [light.position, light.v1, light.v2].map(at);
                let normal = (v1 - v0).cross(v2 - v0).normalize_or(DVec3::Z);
                let bounds = (v0.min(v1).min(v2), v0.max(v1).max(v2), normal, 0.0, 0.5 * PI);
                (bounds, strength * triangle_area(light))
            }
            LIGHT_SPHERE => {
                let (centre, radius) = (at(light.position), f64::from(light.v1[0].abs()));
                ((centre - radius, centre + radius, DVec3::Z, PI, 0.5 * PI), strength * PI * radius * radius)
            }
            LIGHT_SPOT => {
                let [cutoff, beam] = [light.v2[0], light.v2[1]].map(f64::from);
                (point(at(light.v1), beam, cutoff - beam), strength)
            }
            LIGHT_PROJECTOR => {
                let corner = DVec2::new(light.v2[0].into(), light.v2[1].into()).length();
                // Intensity goes with 1 / cos^3 from the axis.
                (point(at(light.v1), corner.atan(), 0.0), strength * (1.0 + corner * corner).powf(1.5))
            }
            LIGHT_POINT => (point(DVec3::Z, PI, 0.0), strength),
            // What has no place: the caller keeps it out of the tree.
            kind => unreachable_kind(kind, ((DVec3::splat(-1e18), DVec3::splat(1e18), DVec3::Z, PI, PI), 0.0)),
        };
        Self { min, max, axis: axis.normalize_or(DVec3::Z), facing: facing.min(PI), spread: spread.max(0.0), intensity }
    }

    fn union(self, other: Self) -> Self {
        let (axis, facing) = cone_union((self.axis, self.facing), (other.axis, other.facing));
        Self {
            min: self.min.min(other.min),
            max: self.max.max(other.max),
            axis,
            facing,
            spread: self.spread.max(other.spread),
            intensity: self.intensity + other.intensity,
        }
    }

    fn centre(&self) -> DVec3 {
        0.5 * (self.min + self.max)
    }

    /// What it costs to have these lights in one node: how much they shed, over how large a box, over how many directions
    /// (Conty Estevez and Kulla 2018, equations 1 and 2; of the box the diagonal's square in place of the surface, which says
    /// nothing of lights in a row).
    fn cost(&self) -> f64 {
        let area = (self.max - self.min).length_squared();
        let reach = (self.facing + self.spread).min(PI);
        let (sin, cos) = self.facing.sin_cos();
        let directions = 2.0 * PI * (1.0 - cos)
            + 0.5 * PI * (2.0 * reach * sin - (self.facing - 2.0 * reach).cos() - 2.0 * self.facing * sin + cos);
        self.intensity * area * directions
    }
}

/// The smallest cone around two, each an axis and a half angle (Conty Estevez and Kulla 2018, algorithm 1).
fn cone_union(a: (DVec3, f64), b: (DVec3, f64)) -> (DVec3, f64) {
    let (wide, narrow) = if a.1 >= b.1 { (a, b) } else { (b, a) };
    let apart = 2.0 * (wide.0 - narrow.0).length().atan2((wide.0 + narrow.0).length());
    if (apart + narrow.1).min(PI) <= wide.1 {
        return wide;
    }
    let half = 0.5 * (wide.1 + apart + narrow.1);
    if half >= PI {
        return (wide.0, PI);
    }
    let across = (narrow.0 - wide.0 * wide.0.dot(narrow.0)).normalize_or_zero();
    if across == DVec3::ZERO {
        return (wide.0, PI); // opposite axes: no turn is shorter than the others
    }
    let turn = half - wide.1;
    (wide.0 * turn.cos() + across * turn.sin(), half)
}

/// Builds a tree over lights that have a place; `factors` are what textures leave of each one's intensity, and `first` is
/// the index of the first of them in the light table. Beside it, for each light, the way to its leaf: the lowest bit is the turn at
/// the root, 1 to the second child.
pub(super) fn build(lights: &[Light], factors: &[f64], first: u32) -> (LightTree, Vec<u32>) {
    let bounds: Vec<LightBounds> =
        lights.iter().zip(factors).map(|(light, factor)| LightBounds::of(light, *factor)).collect();
    let Some(all) = bounds.iter().copied().reduce(LightBounds::union) else { return Default::default() };
    let scale = 1.0 / (0.5 * (all.max - all.min).length()).max(f64::from(f32::MIN_POSITIVE) * 1e6);
    let mut build = Build {
        bounds: &bounds,
        tree: LightTree { nodes: vec![LightNode::default()], origin: all.centre().as_vec3(), scale: scale as f32 },
        trails: vec![0; lights.len()],
        first,
        total: all.intensity.max(f64::MIN_POSITIVE),
    };
    let mut order: Vec<u32> = (0..lights.len() as u32).collect();
    build.node(0, &mut order, 0, 0);
    (build.tree, build.trails)
}

struct Build<'a> {
    bounds: &'a [LightBounds],
    tree: LightTree,
    trails: Vec<u32>,
    first: u32,
    total: f64,
}

impl Build<'_> {
    /// Fills the node `index` with these lights, which lie `level` turns below the root by `trail`.
    fn node(&mut self, index: usize, lights: &mut [u32], level: u32, trail: u32) {
        let all = self.union(lights);
        let link = if let [light] = lights {
            self.trails[*light as usize] = trail;
            (self.first + *light) | LIGHT_LEAF_BIT
        } else {
            let children = self.tree.nodes.len();
            self.tree.nodes.extend([LightNode::default(); 2]);
            let middle = self.split(lights, &all, level);
            let (left, right) = lights.split_at_mut(middle);
            self.node(children, left, level + 1, trail);
            self.node(children + 1, right, level + 1, trail | 1 << level);
            children as u32
        };
        self.tree.nodes[index] = self.packed(&all, link);
    }

    fn union(&self, lights: &[u32]) -> LightBounds {
        let mut all = self.bounds[lights[0] as usize];
        for light in &lights[1..] {
            all = all.union(self.bounds[*light as usize]);
        }
        all
    }

    /// Parts the lights in two and says where the second part begins.
    fn split(&self, lights: &mut [u32], all: &LightBounds, level: u32) -> usize {
        let half = lights.len() / 2;
        let centre = |light: u32| self.bounds[light as usize].centre();
        let (low, high) = lights.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), light| {
            (low.min(centre(*light)), high.max(centre(*light)))
        });
        // Halves from here on are what is left of the trail.
        let levels_of_halves = u32::BITS - (lights.len() as u32 - 1).leading_zeros();
        let best = if level + levels_of_halves >= MOST_LEVELS { None } else { self.best_split(lights, all, low, high) };
        let Some((axis, edge)) = best else {
            let axis = (0..3).fold(0, |best, axis| if (high - low)[axis] > (high - low)[best] { axis } else { best });
            lights.select_nth_unstable_by(half, |a, b| centre(*a)[axis].total_cmp(&centre(*b)[axis]));
            return half;
        };
        let mut middle = 0;
        for index in 0..lights.len() {
            if bin(centre(lights[index])[axis], low[axis], high[axis]) <= edge {
                lights.swap(index, middle);
                middle += 1;
            }
        }
        middle
    }

    /// The axis and the last bin of the first part of the cheapest split into two parts; nothing where all centres agree.
    fn best_split(&self, lights: &[u32], all: &LightBounds, low: DVec3, high: DVec3) -> Option<(usize, usize)> {
        let longest = (all.max - all.min).max_element();
        let mut best: Option<(f64, usize, usize)> = None;
        for axis in (0..3).filter(|axis| high[*axis] > low[*axis]) {
            let mut bins: [Option<LightBounds>; BINS] = [None; BINS];
            for light in lights {
                let bounds = self.bounds[*light as usize];
                let slot = &mut bins[bin(bounds.centre()[axis], low[axis], high[axis])];
                *slot = Some(slot.map_or(bounds, |other| other.union(bounds)));
            }
            let join = |a: Option<LightBounds>, b: Option<LightBounds>| match (a, b) {
                (Some(a), Some(b)) => Some(a.union(b)),
                (a, b) => a.or(b),
            };
            let mut after = [None; BINS];
            for slot in (0..BINS - 1).rev() {
                after[slot] = join(bins[slot + 1], after[slot + 1]);
            }
            // Long thin boxes are worth cutting across.
            let regular = longest / (all.max - all.min)[axis].max(longest * 1e-6);
            let mut before = None;
            for edge in 0..BINS - 1 {
                before = join(before, bins[edge]);
                let (Some(left), Some(right)) = (before, after[edge]) else { continue };
                let cost = regular * (left.cost() + right.cost());
                if best.is_none_or(|(least, _, _)| cost < least) {
                    best = Some((cost, axis, edge));
                }
            }
        }
        best.map(|(_, axis, edge)| (axis, edge))
    }

    /// The node as the shader reads it.
    fn packed(&self, bounds: &LightBounds, link: u32) -> LightNode {
        let (origin, scale) = (self.tree.origin.as_dvec3(), f64::from(self.tree.scale));
        let centre = (bounds.centre() - origin) * scale;
        let radius = 0.5 * (bounds.max - bounds.min).length() * scale;
        // What rounding the centre takes away is given back to the radius.
        let rounded = centre.as_vec3();
        let slack = (centre - rounded.as_dvec3()).length() + f64::from(f32::EPSILON) * (radius + centre.length());
        let (sine, cosine) = (bounds.facing + CONE_MARGIN).min(PI).sin_cos();
        let spread = (bounds.spread + CONE_MARGIN).min(PI).cos();
        LightNode {
            centre: rounded.into(),
            radius: if radius == 0.0 { 0.0 } else { (radius + slack) as f32 },
            axis: octahedral(bounds.axis) | snorm(spread, 8, f64::floor) << 24,
            facing: snorm(cosine, 16, f64::floor) | snorm(sine, 16, f64::ceil) << 16,
            intensity: (bounds.intensity / self.total) as f32,
            link,
        }
    }
}

/// The bin of a centre between the lowest and the highest.
fn bin(centre: f64, low: f64, high: f64) -> usize {
    (((centre - low) / (high - low) * BINS as f64) as usize).min(BINS - 1)
}

/// A value in -1..1 as a signed integer of some bits.
fn snorm(value: f64, bits: u32, round: impl Fn(f64) -> f64) -> u32 {
    let most = f64::from((1 << (bits - 1)) - 1);
    (round(value.clamp(-1.0, 1.0) * most) as i32 as u32) & ((1 << bits) - 1)
}

/// A unit vector in 24 bits (Meyer et al. 2010, "On floating-point normal vectors": the octahedron, unfolded).
fn octahedral(v: DVec3) -> u32 {
    let p = v.truncate() / (v.x.abs() + v.y.abs() + v.z.abs());
    let folded = if v.z >= 0.0 { p } else { (1.0 - DVec2::new(p.y, p.x).abs()) * p.signum() };
    snorm(folded.x, 12, f64::round) | snorm(folded.y, 12, f64::round) << 12
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::layout::NONE;

    fn triangle(at: DVec3, size: f64, radiance: f32) -> Light {
        let place = |offset: DVec3| (at + offset).as_vec3().to_array();
        Light {
            kind: LIGHT_TRIANGLE,
            position: place(DVec3::ZERO),
            v1: place(DVec3::X * size),
            v2: place(DVec3::Y * size),
            radiance: [radiance; 3],
            source: NONE,
            ..Light::default()
        }
    }

    /// Follows a trail to its leaf.
    fn leaf(tree: &LightTree, mut trail: u32) -> u32 {
        let mut node = tree.nodes[0];
        while node.link & LIGHT_LEAF_BIT == 0 {
            node = tree.nodes[(node.link + (trail & 1)) as usize];
            trail >>= 1;
        }
        node.link & !LIGHT_LEAF_BIT
    }

    #[test]
    fn trails_lead_to_their_lights() {
        // In a heap, in a row, all in one place, and at distances that halve: the last would make a chain.
        let places: [fn(u32) -> DVec3; 4] = [
            |i| DVec3::new(f64::from(i * 7 % 13), f64::from(i * 5 % 11), f64::from(i % 3)),
            |i| DVec3::X * f64::from(i),
            |_| DVec3::ONE,
            |i| DVec3::X * 0.5f64.powi(i as i32),
        ];
        for place in places {
            for count in [1, 2, 3, 100] {
                let lights: Vec<Light> = (0..count).map(|i| triangle(place(i), 0.1, 1.0 + i as f32)).collect();
                let (tree, trails) = build(&lights, &vec![1.0; lights.len()], 5);
                assert_eq!(tree.nodes.len(), 2 * lights.len() - 1);
                for (index, trail) in trails.iter().enumerate() {
                    assert_eq!(leaf(&tree, *trail), 5 + index as u32);
                }
                assert!((f64::from(tree.nodes[0].intensity) - 1.0).abs() < 1e-6);
            }
        }
    }

    #[test]
    fn cones_contain_both() {
        let directions: Vec<DVec3> = (0..40)
            .map(|i| {
                let (z, phi) = (1.0 - 2.0 * (f64::from(i) + 0.5) / 40.0, f64::from(i) * 2.4);
                DVec3::new(phi.cos() * (1.0 - z * z).sqrt(), phi.sin() * (1.0 - z * z).sqrt(), z)
            })
            .collect();
        for (i, a) in directions.iter().enumerate() {
            for (j, b) in directions.iter().enumerate() {
                let (angle_a, angle_b) = (0.04 * i as f64, 0.07 * j as f64);
                let (axis, half) = cone_union((*a, angle_a), (*b, angle_b));
                for (inner, angle) in [(a, angle_a), (b, angle_b)] {
                    let reach = axis.angle_between(*inner) + angle;
                    assert!(reach.min(PI) <= half + 1e-6, "{reach} beyond {half}");
                }
            }
        }
    }

    #[test]
    fn packing_keeps_axes() {
        for v in [DVec3::Z, -DVec3::Z, DVec3::new(0.6, -0.48, 0.64), DVec3::new(-0.36, 0.48, -0.8)] {
            let bits = octahedral(v);
            let part = |bits: u32| f64::from((bits << 20) as i32 >> 20) / 2047.0;
            let (x, y) = (part(bits), part(bits >> 12));
            let z = 1.0 - x.abs() - y.abs();
            let fold = (-z).max(0.0);
            let back = DVec3::new(x - fold.copysign(x), y - fold.copysign(y), z).normalize();
            assert!(back.distance(v) < 0.5 * CONE_MARGIN, "{v} became {back}");
        }
    }
}
