//! A rendering that was written down, as far as it is the same for all techniques: read, added up and written without a device.

use std::io::{Read, Write};
use std::path::Path;

use super::counted::Counted;
use super::film::Film;
use super::sums::{self, FilmShape, FilmSums};
use crate::error::{Error, Result};
use crate::techniques::{HostStore, StateStream, Store};

/// What [`super::Renderer::save`] writes before the technique's own state.
#[derive(Clone, Debug)]
pub struct SavedFilm {
    shape: FilmShape,
    /// Index of the next sample, stage, slots that are through it, samples of the pass.
    position: [u32; 4],
    sums: FilmSums,
    /// What was counted.
    pub counted: Counted,
}

impl SavedFilm {
    /// Reads it from a stream, which messages call `file`.
    pub fn read(file: &Path, shape: &FilmShape, from: &mut dyn Read) -> Result<Self> {
        if !shape.is_possible() {
            return Err(Error::read(file, "its header states a film of a size that cannot be"));
        }
        let stores: Vec<HostStore> = shape.bytes().into_iter().map(HostStore::new).collect();
        let (mut position, mut counted, mut any) = ([0; 4], Counted::default(), false);
        let mut stream = StateStream::restoring(file, from);
        stream.numbers(&mut position)?;
        let (film, layers, planes) = (&stores[0], &stores[1], &stores[2..]);
        let all: Vec<&dyn Store> = planes.iter().map(|plane| plane as &dyn Store).collect();
        sums::exchange(&mut stream, [film, layers], &all, &mut any, &mut counted)?;
        let sums = FilmSums {
            pixels: film.values(),
            layers: if shape.layers > 0 { layers.values() } else { Vec::new() },
            blocks: planes.iter().filter(|_| any).flat_map(HostStore::values).collect(),
        };
        Ok(Self { shape: shape.clone(), position, sums, counted })
    }

    /// Writes it.
    pub fn write(&mut self, file: &Path, to: &mut dyn Write) -> Result<()> {
        let mut stream = StateStream::saving(file, to);
        stream.numbers(&mut self.position)?;
        let FilmSums { pixels, layers, blocks } = &self.sums;
        let film = HostStore::of(pixels);
        // A buffer of nothing takes four bytes.
        let layers = if layers.is_empty() { HostStore::new(4) } else { HostStore::of(layers) };
        let planes: Vec<HostStore> = blocks.chunks(3 * pixels.len().max(1)).map(HostStore::of).collect();
        let all: Vec<&dyn Store> = planes.iter().map(|plane| plane as &dyn Store).collect();
        sums::exchange(&mut stream, [&film, &layers], &all, &mut !planes.is_empty(), &mut self.counted)
    }

    /// Whether all pixels have the same samples, up to this index.
    pub fn ends_at(&self, sample: u32) -> bool {
        self.position[..3] == [sample, 0, 0]
    }

    /// Adds the samples that follow on these.
    pub fn append(&mut self, next: &Self) {
        self.position = next.position;
        self.sums.append(&next.sums);
        self.counted.add(&next.counted);
    }

    /// The film, of so many samples of each pixel.
    pub fn film(&self, spp: u32) -> Film {
        let pixels = self.shape.width as usize * self.shape.height as usize;
        let mut film = self.sums.film(&self.shape, vec![u64::from(spp); pixels]);
        film.nonfinite = self.counted.nonfinite;
        film.bad_samples.clone_from(&self.counted.bad_samples);
        film
    }
}
