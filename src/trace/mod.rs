//! What happens to the paths of one sample of a pixel: `lumbre trace`.
//!
//! The technique's own kernels follow the same paths once more, compiled to record what they do (`shaders/core/record.glsl`). [`trace`] takes that
//! sample and puts the [records](crate::layout::PathRecord) together: the subpaths vertex by vertex, the strategies with their
//! weights, what light subpaths from elsewhere splat onto the pixel, and the sample's value, which all of these add up to.

mod assemble;
mod command;
mod names;
mod plan;
mod text;
mod types;

use crate::error::{Error, Result};
use crate::gpu::Gpu;
use crate::layout::{
    PathRecord, RECORD_BEGIN, RECORD_MUTATION, RECORD_ROULETTE, RECORD_SPLAT, RECORD_STRATEGY, RECORD_VALUE,
    RECORD_VISIT,
};
use crate::render::{Renderer, Settings, Wanted};
use crate::scene::Scene;

pub use command::command;
pub use plan::svg;
pub use text::text;
pub use types::{
    Beginning, Contribution, Emission, LightSample, Proposal, Roulette, Scattering, Splat, StrategyContribution,
    Subpath, Trace, Vertex, Visit,
};

/// Records that there is room for. A path of the longest kind has a few for each vertex; merging techniques have one for each photon met.
const ROOM: u32 = 1 << 18;

/// Samples of a pixel of which the brightest is looked for.
pub const MOST_SAMPLES: u32 = 4096;

/// Bits of all kinds of records.
const EVERYTHING: u32 = (1 << (RECORD_MUTATION + 1)) - 1;
/// Bits of the kinds that follow a subpath from vertex to vertex.
const SUBPATH: u32 = (1 << (RECORD_ROULETTE + 1)) - (1 << RECORD_BEGIN);

/// Bits of the kinds that follow a path which a chain has proposed.
const PROPOSAL: u32 = SUBPATH | 1 << RECORD_STRATEGY | 1 << RECORD_MUTATION;

/// Which sample.
#[derive(Clone, Copy, Debug)]
pub struct Request {
    /// Column of the pixel, from the left.
    pub x: u32,
    /// Row of the pixel, from the top.
    pub y: u32,
    /// Index of the sample within the pixel.
    pub sample: u32,
}

/// Follows the paths of one sample of one pixel, as a rendering with these settings has them. Techniques in which a sample depends on those before it take
/// these first.
///
/// Fails where the pixel is not in the image, or as a rendering does.
pub fn trace(gpu: &Gpu, scene: &Scene, settings: &Settings, request: Request) -> Result<Trace> {
    let mut renderer = recording(gpu, scene, settings, request.x, request.y)?;
    follow(scene, &mut renderer, request)
}

/// The same for the brightest of the first `samples` samples of a pixel, of [`MOST_SAMPLES`] where there are more.
pub fn trace_brightest(gpu: &Gpu, scene: &Scene, settings: &Settings, x: u32, y: u32, samples: u32) -> Result<Trace> {
    let mut renderer = recording(gpu, scene, settings, x, y)?;
    let sample = brightest(&mut renderer, x, y, samples.clamp(1, MOST_SAMPLES))?;
    renderer.restart(settings.seed)?;
    follow(scene, &mut renderer, Request { x, y, sample })
}

/// A renderer that records what a pixel of its image is made of.
fn recording(gpu: &Gpu, scene: &Scene, settings: &Settings, x: u32, y: u32) -> Result<Renderer> {
    if x >= settings.width || y >= settings.height {
        return Err(Error::Usage(format!(
            "--pixel {x},{y}: the image has {}x{} pixels, so valid are 0,0 to {},{}",
            settings.width,
            settings.height,
            settings.width - 1,
            settings.height - 1
        )));
    }
    let recording =
        Settings { records: ROOM, lengths: 0, strategies: None, aovs: None, shard: None, ..settings.clone() };
    Renderer::new(gpu, scene, &recording)
}

/// The index of the brightest sample of a pixel; the first one where all are black.
fn brightest(renderer: &mut Renderer, x: u32, y: u32, samples: u32) -> Result<u32> {
    let pixel = y * renderer.settings().width + x;
    renderer.want_records(&Wanted { kinds: 1 << RECORD_VALUE, pixel: Some(pixel), ..Wanted::NOTHING })?;
    if renderer.settings().technique.row.is_unidirectional() {
        renderer.sample_pixel(x, y, 0, samples)?;
    } else {
        while renderer.advance(samples)? {}
    }
    let (records, _) = renderer.records()?;
    let brightness = |record: &&PathRecord| record.value.iter().copied().fold(0.0, f32::max);
    let finite = records.iter().filter(|record| brightness(record).is_finite());
    let first = |one: &&PathRecord, other: &&PathRecord| {
        brightness(one).total_cmp(&brightness(other)).then(other.sample_index.cmp(&one.sample_index))
    };
    Ok(finite.max_by(first).map_or(0, |record| record.sample_index))
}

/// Takes a sample of a pixel, and tells what happened in it.
fn follow(scene: &Scene, renderer: &mut Renderer, request: Request) -> Result<Trace> {
    if request.sample == u32::MAX {
        return Err(Error::Usage(format!("--sample {}: valid are 0 to {}", u32::MAX, u32::MAX - 1)));
    }
    let settings = renderer.settings().clone();
    let pixel = request.y * settings.width + request.x;
    let row = settings.technique.row;
    let wanted = Wanted {
        kinds: EVERYTHING,
        pixel: Some(pixel),
        sample: Some(request.sample),
        // Connections of a pixel are to the light subpath of the same number.
        light_path: row.tells_strategies.then_some(pixel),
        ..Wanted::NOTHING
    };
    let mut records = take(renderer, &wanted, request)?;
    let is_told = |source: u32| {
        records.iter().any(|record| record.from_light == 1 && record.kind == RECORD_BEGIN && record.pixel == source)
    };
    let is_elsewhere = |source: &u32| (row.tells_strategies || row.is_light_tracing()) && !is_told(*source);
    if let Some(source) = brightest_splat(&records).filter(is_elsewhere) {
        renderer.restart(settings.seed)?;
        let wanted = Wanted { kinds: SUBPATH, light_path: Some(source), ..wanted };
        let from_light = |record: &PathRecord| record.from_light == 1;
        records.extend(take(renderer, &wanted, request)?.into_iter().filter(from_light));
    }
    if let Some(path) = brightest_visit(&records) {
        renderer.restart(settings.seed)?;
        // It may have been proposed in an earlier sample.
        let wanted = Wanted { kinds: PROPOSAL, sample: None, chain_path: Some(path), ..wanted };
        records.extend(take(renderer, &wanted, request)?);
    }
    let factor = renderer.film_factor()?;
    Ok(assemble::assemble(scene, renderer, request, &records, factor))
}

/// Takes the sample, and returns what was recorded of it.
fn take(renderer: &mut Renderer, wanted: &Wanted, request: Request) -> Result<Vec<PathRecord>> {
    renderer.want_records(wanted)?;
    if renderer.settings().technique.row.is_unidirectional() {
        renderer.sample_pixel(request.x, request.y, request.sample, 1)?;
    } else {
        let target = request.sample + 1;
        while renderer.advance(target)? {}
    }
    let (records, lost) = renderer.records()?;
    if lost > 0 {
        return Err(Error::Usage(format!(
            "the sample has {} records, and there is room for {ROOM}: a lower --max-depth or, where photons are merged, a smaller radius makes fewer",
            u64::from(lost) + u64::from(ROOM)
        )));
    }
    Ok(records)
}

/// The path of the visit that adds most to the pixel: its chain, and the mutation that proposed it.
fn brightest_visit(records: &[PathRecord]) -> Option<[u32; 2]> {
    let visits = records.iter().filter(|record| record.kind == RECORD_VISIT);
    let brightness = |record: &PathRecord| record.throughput.iter().sum::<f32>();
    visits.max_by(|one, other| brightness(one).total_cmp(&brightness(other))).map(|record| [record.s, record.vertex])
}

/// The light subpath that adds most to the pixel.
fn brightest_splat(records: &[PathRecord]) -> Option<u32> {
    let splats = records.iter().filter(|record| record.kind == RECORD_SPLAT);
    let brightness = |record: &PathRecord| record.value.iter().sum::<f32>();
    splats.max_by(|one, other| brightness(one).total_cmp(&brightness(other))).map(|record| record.vertex)
}
