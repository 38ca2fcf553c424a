//! `--fireflies`: the brightest samples of an image, each with the command that explains it.

use std::cmp::Ordering;

use serde::Serialize;

use lumbre::error::Result;
use lumbre::layout::{PathRecord, RECORD_VALUE};
use lumbre::render::{Renderer, Settings, Wanted};

use super::super::output::print;

/// The least and the most records that kernels have room for.
const ROOM: [u64; 2] = [1 << 18, 1 << 21];

/// Records that there is room for: of all samples of a frame, which is bounded to so many, and of all pixels, where a pass goes over these at once.
pub(super) fn room(settings: &Settings) -> u32 {
    let pixels = u64::from(settings.width) * u64::from(settings.height);
    pixels.clamp(ROOM[0], ROOM[1]) as u32
}

/// One of the brightest samples.
#[derive(Clone, Debug, Serialize)]
pub(in super::super) struct Firefly {
    x: u32,
    y: u32,
    sample: u32,
    /// What the film took, W/(m² sr).
    value: [f64; 3],
    /// Tells what happened to its paths.
    command: String,
}

/// The brightest samples so far. Kernels record those that are brighter than the least of them.
pub(super) struct Fireflies {
    most: usize,
    brightest: Vec<PathRecord>,
    /// Samples that there was no room for: one of them may have been brighter.
    lost: u64,
}

fn brightness(record: &PathRecord) -> f32 {
    record.value.iter().fold(0.0, |most, channel| most.max(*channel))
}

fn brighter_first(one: &PathRecord, other: &PathRecord) -> Ordering {
    let place = |record: &PathRecord| (record.sample_index, record.pixel);
    brightness(other).total_cmp(&brightness(one)).then(place(one).cmp(&place(other)))
}

impl Fireflies {
    /// Begins to look for so many.
    pub fn new(most: u32, renderer: &mut Renderer) -> Result<Self> {
        let fireflies = Self { most: most as usize, brightest: Vec::new(), lost: 0 };
        if most > 0 {
            renderer.bound_frames(u64::from(renderer.settings().records));
            fireflies.want(renderer)?;
        }
        Ok(fireflies)
    }

    fn want(&self, renderer: &mut Renderer) -> Result<()> {
        let least = self.brightest.get(self.most - 1).map_or(0.0, brightness);
        renderer.want_records(&Wanted { kinds: 1 << RECORD_VALUE, threshold: least, ..Wanted::NOTHING })
    }

    /// Takes in what a frame has recorded.
    pub fn update(&mut self, renderer: &mut Renderer) -> Result<()> {
        if self.most == 0 {
            return Ok(());
        }
        let (records, lost) = renderer.records()?;
        self.lost += u64::from(lost);
        if records.is_empty() {
            return Ok(());
        }
        self.brightest.extend(records.into_iter().filter(|record| brightness(record).is_finite()));
        self.brightest.sort_by(brighter_first);
        self.brightest.truncate(self.most);
        self.want(renderer)
    }

    /// Samples that there was no room for.
    pub fn lost(&self) -> u64 {
        self.lost
    }

    /// The brightest, the first one first; `command` traces a sample of a pixel.
    pub fn found(&self, renderer: &Renderer, command: impl Fn(u32, u32, u32) -> String) -> Result<Vec<Firefly>> {
        let factor = renderer.film_factor()?;
        let width = renderer.settings().width;
        let firefly = |record: &PathRecord| {
            let (x, y, sample) = (record.pixel % width, record.pixel / width, record.sample_index);
            let value = record.value.map(|channel| f64::from(channel) * factor);
            Firefly { x, y, sample, value, command: command(x, y, sample) }
        };
        Ok(self.brightest.iter().map(firefly).collect())
    }
}

/// Prints them with their commands.
pub(super) fn print_fireflies(found: &[Firefly]) {
    for (index, Firefly { x, y, sample, value: [r, g, b], command }) in found.iter().enumerate() {
        let title = if index == 0 { "brightest " } else { "          " };
        print(&format!("{title} pixel {x},{y} sample {sample}: ({r:.4}, {g:.4}, {b:.4})"));
        print(&format!("             {command}"));
    }
}
