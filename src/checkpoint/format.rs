//! The bytes of a checkpoint: magic number, version, header, state, checksum.

use std::fs::File;
use std::io::{BufReader, BufWriter, Read, Write};
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::identity::Identity;
use crate::error::{Error, Result};
use crate::render::{FilmShape, Renderer, SavedFilm};
use crate::techniques::{FilmScale, Shard};

/// What each begins with.
pub(super) const MAGIC: &[u8; 8] = b"lumbreCP";
/// Counts up whenever what follows is laid out differently.
const VERSION: u32 = 5;
/// The most bytes of a header: what is longer is none.
const MOST_HEADER: u32 = 1 << 20;
/// Bytes of the checksum at the end: CRC-32 (IEEE 802.3) of all before it.
const CHECKSUM: u64 = 4;
/// Bytes before the header: magic number, version, the header's length.
const PREFIX: u64 = 16;

/// What can be told of a rendering without a device.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Header {
    /// What it belongs to.
    pub identity: Identity,
    /// The setting of that name. It decides about work ahead, so what goes on goes by what it began with.
    pub expected_samples: u64,
    /// Samples that every pixel has.
    pub spp: u32,
    /// Seconds that were spent on rendering.
    pub spent: f64,
    /// Where it is to stop at an error: samples per pixel at which that is looked at next.
    pub next_look: Option<u32>,
    /// The share of the samples that it is.
    pub shard: Option<Shard>,
    /// How to read the film.
    pub shape: FilmShape,
    /// What the film is multiplied by, with the estimate of the brightness that this follows from: its mean and its variance.
    pub scale: Option<[f64; 3]>,
    /// What the header of an image says of the rendering and its settings.
    pub about: serde_json::Value,
}

impl Header {
    /// Of a rendering as it stands; `about` is what the header of an image says of it.
    pub fn of(renderer: &Renderer, identity: Identity, about: serde_json::Value) -> Result<Self> {
        let scale = |scale: FilmScale| [scale.factor, scale.brightness.mean, scale.brightness.variance];
        Ok(Self {
            identity,
            expected_samples: renderer.settings().expected_samples,
            spp: renderer.spp(),
            spent: 0.0,
            next_look: None,
            shard: renderer.settings().shard,
            shape: renderer.shape(),
            scale: renderer.film_scale()?.map(scale),
            about,
        })
    }
}

/// Writes what follows on the header to a stream; messages call it by the path.
pub(super) type Save<'a> = dyn FnMut(&Path, &mut dyn Write) -> Result<()> + 'a;

/// Sums what passes through.
struct Summing<T> {
    inner: T,
    sum: crc32fast::Hasher,
}

impl<T: Write> Write for Summing<T> {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        let written = self.inner.write(bytes)?;
        self.sum.update(&bytes[..written]);
        Ok(written)
    }

    fn flush(&mut self) -> std::io::Result<()> {
        self.inner.flush()
    }
}

/// Writes a checkpoint to `path`, which becomes a new file, and waits until it is on the disk.
pub(super) fn write(path: &Path, header: &Header, save: &mut Save) -> Result<()> {
    let failed = |error: std::io::Error| Error::write(path, error);
    let file = File::create(path).map_err(failed)?;
    let mut to = Summing { inner: BufWriter::new(&file), sum: crc32fast::Hasher::new() };
    let text = serde_json::to_vec(header).map_err(|error| Error::write(path, error))?;
    to.write_all(MAGIC).map_err(failed)?;
    to.write_all(&VERSION.to_le_bytes()).map_err(failed)?;
    to.write_all(&(text.len() as u32).to_le_bytes()).map_err(failed)?;
    to.write_all(&text).map_err(failed)?;
    save(path, &mut to)?;
    let sum = to.sum.clone().finalize();
    to.write_all(&sum.to_le_bytes()).map_err(failed)?;
    to.flush().map_err(failed)?;
    file.sync_all().map_err(failed)
}

/// Reads the header, after the checksum of the whole file was found right; otherwise says what is wrong with it.
pub(super) fn read_header(path: &Path) -> Result<Header, String> {
    let failed = |error: std::io::Error| error.to_string();
    let file = File::open(path).map_err(failed)?;
    let length = file.metadata().map_err(failed)?.len();
    if length < PREFIX + CHECKSUM {
        return Err(format!("it is cut short: {length} bytes"));
    }
    let mut from = BufReader::with_capacity(1 << 20, file);
    let mut prefix = [0; PREFIX as usize];
    from.read_exact(&mut prefix).map_err(failed)?;
    let word = |at: usize| u32::from_le_bytes([prefix[at], prefix[at + 1], prefix[at + 2], prefix[at + 3]]);
    if &prefix[..8] != MAGIC {
        return Err(String::from("it is no checkpoint of lumbre"));
    }
    if word(8) != VERSION {
        return Err(format!("it has version {}, and this lumbre reads version {VERSION}", word(8)));
    }
    let text_length = word(12);
    if text_length > MOST_HEADER || u64::from(text_length) > length - PREFIX - CHECKSUM {
        return Err(String::from("it is damaged or cut short: its header is longer than the file"));
    }
    let mut text = vec![0; text_length as usize];
    from.read_exact(&mut text).map_err(failed)?;
    let mut sum = crc32fast::Hasher::new();
    sum.update(&prefix);
    sum.update(&text);
    let mut left = length - PREFIX - CHECKSUM - u64::from(text_length);
    let mut chunk = vec![0; 1 << 20];
    while left > 0 {
        let part = left.min(chunk.len() as u64) as usize;
        from.read_exact(&mut chunk[..part]).map_err(failed)?;
        sum.update(&chunk[..part]);
        left -= part as u64;
    }
    let mut stated = [0; CHECKSUM as usize];
    from.read_exact(&mut stated).map_err(failed)?;
    if u32::from_le_bytes(stated) != sum.finalize() {
        return Err(String::from("it is damaged or cut short: its checksum is wrong"));
    }
    serde_json::from_slice(&text).map_err(|error| format!("its header cannot be read: {error}"))
}

/// What follows on the header of a checkpoint that was read.
fn after_header(path: &Path) -> Result<BufReader<File>> {
    let failed = |error: std::io::Error| Error::read(path, error);
    let mut from = BufReader::with_capacity(1 << 20, File::open(path).map_err(failed)?);
    let mut prefix = [0; PREFIX as usize];
    from.read_exact(&mut prefix).map_err(failed)?;
    let header = u32::from_le_bytes([prefix[12], prefix[13], prefix[14], prefix[15]]);
    from.seek_relative(i64::from(header)).map_err(failed)?;
    Ok(from)
}

/// The film of a checkpoint whose header was read, and the technique's own state after it.
pub(super) fn read_film(path: &Path, header: &Header) -> Result<(SavedFilm, Vec<u8>)> {
    let mut from = after_header(path)?;
    let film = SavedFilm::read(path, &header.shape, &mut from)?;
    let mut state = Vec::new();
    from.read_to_end(&mut state).map_err(|error| Error::read(path, error))?;
    state.truncate(state.len().saturating_sub(CHECKSUM as usize));
    Ok((film, state))
}

/// Gives a renderer the state of a checkpoint whose header was read.
pub(super) fn restore(path: &Path, renderer: &mut Renderer) -> Result<()> {
    let failed = |error: std::io::Error| Error::read(path, error);
    let mut from = after_header(path)?;
    renderer.restore(path, &mut from)?;
    let mut rest = Vec::new();
    from.take(CHECKSUM + 1).read_to_end(&mut rest).map_err(failed)?;
    if rest.len() as u64 == CHECKSUM { Ok(()) } else { Err(Error::read(path, "it holds more than this rendering has")) }
}
