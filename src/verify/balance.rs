//! What decides on mutations of paths, through `shaders/kernels/test/mutations.glsl`, against the densities by their definition.
//!
//! A mutation from path x to path y is to be accepted with probability f(y) T(y to x) / (f(x) T(x to y)) (Hastings 1970), where f is the
//! contribution of a path and T the density with which it is proposed, both per area at all vertices that scatter by no delta lobe. Here they are
//! multiplied out in double precision.

use super::Run;
use super::defined_paths::{Defined, FLATTEST, LAMP_AREA, Link, PINHOLE, room};
use super::figure::{Figure, Worst};
use crate::error::Result;
use crate::render::{Probe, Renderer, Settings};
use crate::techniques::Chains;

/// Vertices of the longest path that is looked at.
const MOST: usize = 9;

/// The kinds of mutations, as `shaders/techniques/metropolis/path_mutations.glsl` has them.
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

impl Defined {
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
    let (x, flattest_x) = Defined::of(&answer.from, from_segments, PINHOLE);
    let (y, flattest_y) = Defined::of(&answer.to, segments, PINHOLE);
    let there = y.proposed(kind, first, last, from_segments, shares);
    let back = x.proposed(kind, first, last + from_segments - segments, segments, shares);
    (y.contribution() * back / (x.contribution() * there), flattest_x.min(flattest_y))
}

/// Each mutation's ratio against its definition.
pub(super) fn balance(run: &mut Run) -> Result<()> {
    let scene = room(PINHOLE, 1.0)?;
    let technique = "mlt:form=paths:chains=4096:candidates=65536:large-step=0.2";
    let settings = Settings { max_depth: Some(MOST as u32 - 1), ..run.settings(&scene, technique)? };
    let mut renderer = Renderer::new(run.gpu, &scene, &settings)?;
    while renderer.advance(2)? {}
    let shares = renderer.state::<Chains>()?.shares().to_vec();
    let probe = Probe::new(run.gpu, &scene, &settings, "test/mutations")?;
    let mut worst: [Worst; 4] = Default::default();
    let mut counts = [0; 4];
    for round in 0..run.pick(8, 2) {
        let answers: Vec<Answer> = probe.run_on_state(&renderer, &vec![1_000_000 + round; 4096])?;
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
