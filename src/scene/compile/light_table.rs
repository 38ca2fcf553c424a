//! How lights are selected: from an alias table in proportion to their power, or from a tree by bounds on
//! their contribution to the point.

use super::alias::alias_table;
use super::flatten::Emitter;
use super::light::{area, power};
use super::light_tree::{self, LightTree};
use crate::layout::{LIGHT_DIRECTIONAL, LIGHT_LEAF_BIT, LIGHT_SPHERE, Light, Primitive, SURFACE_MASK, Surface};
use crate::scene::LightSelection;
use crate::scene::description::ELEMENTS;

/// Lights from which on a tree is worth its descent.
const MANY: usize = 32;

/// The lights of a scene with the probabilities of selecting them.
#[derive(Clone, Debug, Default)]
pub(super) struct LightTable {
    /// Those of the alias table come first; the others are leaves of the tree.
    pub lights: Vec<Light>,
    /// How many are in the alias table.
    pub in_table: u32,
    /// Probability of selecting from the table, where the background was not selected.
    pub table_probability: f64,
    pub tree: LightTree,
    /// Probability of selecting the background.
    pub background_probability: f64,
}

/// A light that waits for its place in the table: where it comes from, and what its texture leaves of it in the mean.
#[derive(Clone, Copy, Debug)]
pub(super) struct Candidate {
    pub light: Light,
    /// The surface and the primitive that it is, if it is one, and whether it is the other side of that: the candidate before it is the front.
    pub of: Option<(usize, usize, bool)>,
    pub factor: f64,
}

impl Candidate {
    pub fn lamp(light: Light, factor: f64) -> Self {
        Self { light, of: None, factor }
    }

    pub fn emitter(emitter: &Emitter, factor: f64) -> Self {
        Self { light: emitter.light, of: Some((emitter.surface, emitter.primitive, emitter.is_behind)), factor }
    }
}

/// Arranges the lights, and writes into the surfaces the densities with which points of them are picked, for paths that
/// hit them by themselves. With a tree each emitting primitive gets a surface of its own, which holds the way to its leaf.
pub(super) fn arrange(
    mut candidates: Vec<Candidate>,
    how: LightSelection,
    has_background: bool,
    scene_radius: f64,
    surfaces: &mut Vec<Surface>,
    primitives: &mut [Primitive],
) -> LightTable {
    let weigh = |candidate: &Candidate| power(&candidate.light, scene_radius) * candidate.factor;
    let total: f64 = candidates.iter().map(weigh).sum();
    if total <= 0.0 {
        return LightTable { background_probability: f64::from(u8::from(has_background)), ..LightTable::default() };
    }
    // Neither can starve the other, whichever the scene shows more of.
    let background_probability = if has_background { 0.5 } else { 0.0 };
    let is_far = |candidate: &Candidate| candidate.light.kind == LIGHT_DIRECTIONAL;
    let near = candidates.iter().filter(|candidate| !is_far(candidate)).count();
    let with_tree = match how {
        LightSelection::Auto => near > MANY,
        LightSelection::Power => false,
        LightSelection::Tree => near > 0,
    };
    // The table's lights first.
    candidates.sort_by_key(|candidate| with_tree && !is_far(candidate));
    let in_table = if with_tree { candidates.len() - near } else { candidates.len() };
    let weights: Vec<f64> = candidates.iter().map(weigh).collect();
    let table_total: f64 = weights[..in_table].iter().sum();
    let table_probability = match with_tree {
        _ if table_total <= 0.0 => 0.0,
        false => 1.0,
        true => (table_total / total).clamp(0.1, 0.9),
    };
    let mut lights: Vec<Light> = candidates.iter().map(|candidate| candidate.light).collect();
    let any = 1.0 - background_probability;
    if table_total > 0.0 {
        for ((light, weight), (keep, alias)) in lights.iter_mut().zip(&weights).zip(alias_table(&weights[..in_table])) {
            light.probability = (weight / table_total * table_probability * any) as f32;
            (light.keep, light.alias) = (keep, alias);
        }
    }
    let factors: Vec<f64> = candidates[in_table..].iter().map(|candidate| candidate.factor).collect();
    let (tree, trails) = light_tree::build(&lights[in_table..], &factors, in_table as u32);
    let to_tree = ((1.0 - table_probability) * any) as f32;
    for light in &mut lights[in_table..] {
        light.probability = to_tree; // times what the tree says at a point
    }
    for (index, (light, (keep, alias))) in lights.iter_mut().zip(alias_table(&weights)).enumerate() {
        light.emission_probability = (weights[index] / total * any) as f32;
        (light.emission_keep, light.emission_alias) = (keep, alias);
        light.trail = index.checked_sub(in_table).map_or(0, |leaf| trails[leaf]);
    }
    for (index, candidate) in candidates.iter().enumerate() {
        let Some((mut surface, primitive, is_behind)) = candidate.of else { continue };
        if index >= in_table {
            surface = if is_behind { surfaces.len() - 1 } else { own_surface(surfaces, &mut primitives[primitive]) };
            lights[index].source = surface as u32;
            let own = &mut surfaces[surface];
            *if is_behind { &mut own.light_trail_behind } else { &mut own.light_trail } = trails[index - in_table];
        }
        let light = &lights[index];
        let Some(area) = area(light) else { continue };
        let is_sphere = light.kind == LIGHT_SPHERE;
        surfaces[surface].light_density =
            if is_sphere { light.probability } else { (f64::from(light.probability) / area) as f32 };
        surfaces[surface].emission_density = (f64::from(light.emission_probability) / area) as f32;
    }
    LightTable { lights, in_table: in_table as u32, table_probability, tree, background_probability }
}

/// Gives a primitive a copy of its surface for itself.
fn own_surface(surfaces: &mut Vec<Surface>, primitive: &mut Primitive) -> usize {
    let copy = surfaces[(primitive.surface & SURFACE_MASK) as usize];
    surfaces.push(copy);
    let own = surfaces.len() - 1;
    primitive.surface = primitive.surface & !SURFACE_MASK | own as u32 & SURFACE_MASK;
    own
}

const _: () = assert!(ELEMENTS <= SURFACE_MASK as u64 + 1, "each triangle can have a surface of its own");
const _: () = assert!(LIGHT_LEAF_BIT > SURFACE_MASK, "a light's index fits beside the leaf bit");
