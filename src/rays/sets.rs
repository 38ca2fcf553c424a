//! The rays that are measured, by kind, in the order of the image and out of it.

use serde::Serialize;

use crate::error::Result;
use crate::gpu::{Buffer, Gpu};
use crate::layout::{FilmPixel, RAY_BOUNCES, RayRecord};
use crate::render::{Probe, Settings};
use crate::scene::Scene;

/// A kind of ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum RayKind {
    /// From the camera through neighbouring pixels.
    Primary,
    /// From where paths hit towards a light: any hit ends it.
    Shadow,
    /// From where paths hit, as a diffuse surface scatters.
    DiffuseBounce,
}

impl RayKind {
    /// Its name, as in JSON.
    pub fn name(self) -> &'static str {
        match self {
            Self::Primary => "primary",
            Self::Shadow => "shadow",
            Self::DiffuseBounce => "diffuse-bounce",
        }
    }
}

/// The rays of each kind in the order of the pixels that they come from; those of paths that left the scene are taken out.
pub fn make(gpu: &Gpu, scene: &Scene, settings: &Settings) -> Result<Vec<(RayKind, Vec<RayRecord>)>> {
    let slots = settings.slots() as u32;
    let sets = 1 + 2 * RAY_BOUNCES as usize;
    let records = Buffer::zeroed(gpu, "rays", sets as u64 * u64::from(slots) * size_of::<RayRecord>() as u64)?;
    let unused = Buffer::zeroed(gpu, "film", settings.pixels() * size_of::<FilmPixel>() as u64)?;
    Probe::new(gpu, scene, settings, "rays/make")?.run_on(&records, &unused, slots)?;
    let all: Vec<RayRecord> = records.read(sets * slots as usize)?;
    let mut kinds =
        vec![(RayKind::Primary, Vec::new()), (RayKind::Shadow, Vec::new()), (RayKind::DiffuseBounce, Vec::new())];
    for (index, set) in all.chunks_exact(slots as usize).enumerate() {
        let kind = if index == 0 { 0 } else { 1 + (index - 1) % 2 };
        kinds[kind].1.extend(set.iter().filter(|ray| ray.t_max > 0.0));
    }
    kinds.retain(|(_, rays)| !rays.is_empty());
    Ok(kinds)
}

/// A random order of so many elements, the same in every call, each order as probable as any other (Fisher and Yates 1938, as
/// Durstenfeld 1964 does it). Element i of the shuffled list is element `shuffle(count)[i]` of the original.
pub fn shuffle(count: usize) -> Vec<u32> {
    let mut order: Vec<u32> = (0..count as u32).collect();
    let mut state = 0u64;
    for last in (1..count).rev() {
        // SplitMix64 (Steele, Lea and Flood 2014). The product's high word is uniform up to 2^-32 for the counts here.
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (state ^ state >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mixed = (mixed ^ mixed >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        let uniform = mixed ^ mixed >> 31;
        order.swap(last, ((u128::from(uniform) * (last as u128 + 1)) >> 64) as usize);
    }
    order
}
