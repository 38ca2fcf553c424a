//! Merging checkpoints: sums are added exactly.

use std::path::{Path, PathBuf};

use super::CHAINS_ARE_OWN;
use super::order::{Part, put_in_order};
use crate::checkpoint::{Checkpoints, Header, read, read_header};
use crate::error::{Error, Result};
use crate::render::film::Film;
use crate::render::{Counted, SavedFilm};

/// What shards came to.
pub struct Merged {
    /// That of one run; what it says of the rendering is the first shard's.
    pub header: Header,
    /// What each shard says of its rendering, in their order.
    pub abouts: Vec<serde_json::Value>,
    /// The film.
    pub film: Film,
    /// What was counted.
    pub counted: Counted,
    /// What is to be said of it.
    pub notes: Vec<String>,
    /// The sums, and the technique's own state at the end; nothing of chains, which each shard had to itself.
    saved: Option<(SavedFilm, Vec<u8>)>,
}

/// Merges checkpoints.
pub fn merge(paths: &[PathBuf]) -> Result<Merged> {
    let mut parts = paths.iter().map(|path| part(path)).collect::<Result<Vec<_>>>()?;
    let devices_differ = put_in_order(&mut parts)?;
    let mut parts = parts.into_iter();
    let Some(first) = parts.next() else { return Err(Error::Usage(String::from("there is nothing to merge"))) };
    let (mut header, mut saved, mut state) = read_part(&first)?;
    let samples = first.shard.samples;
    let mut abouts = vec![header.about.clone()];
    let has_chains = header.shape.samples_are_correlated;
    let mut film = has_chains.then(|| film_of(&header, &saved));
    for part in parts {
        let (next_header, next, next_state) = read_part(&part)?;
        header.spent += next_header.spent;
        abouts.push(next_header.about.clone());
        if next_header.shape != header.shape {
            return Err(Error::read(&part.path, "its film is not that of the others, though its settings are"));
        }
        if let Some(film) = &mut film {
            film.add(&film_of(&next_header, &next));
            saved.counted.add(&next.counted);
        } else {
            saved.append(&next);
        }
        state = next_state;
    }
    header.identity = header.identity.whole();
    (header.spp, header.shard, header.scale) = (samples, None, None);
    let mut notes = Vec::new();
    if has_chains {
        notes.push(CHAINS_ARE_OWN.to_owned());
    }
    if devices_differ {
        notes.push(String::from("shards are of different devices: the image is right, and has the bits of neither"));
    }
    let film = match film {
        Some(film) => film,
        None => saved.film(samples),
    };
    let counted = saved.counted.clone();
    Ok(Merged { header, abouts, film, counted, notes, saved: (!has_chains).then_some((saved, state)) })
}

fn part(path: &Path) -> Result<Part> {
    let Header { identity, shard, spp, .. } = read_header(path)?;
    let Some(shard) = shard else {
        return Err(Error::Usage(format!(
            "{} is no shard: it is a rendering by itself; valid are checkpoints of lumbre render --shard",
            path.display()
        )));
    };
    Ok(Part { path: path.to_owned(), identity, shard, spp })
}

fn read_part(part: &Part) -> Result<(Header, SavedFilm, Vec<u8>)> {
    let (header, saved, state) = read(&part.path)?;
    if !saved.ends_at(part.shard.first() + part.shard.count()) {
        return Err(Error::read(&part.path, "its samples do not end where its header says"));
    }
    Ok((header, saved, state))
}

/// The film of a shard by itself.
fn film_of(header: &Header, saved: &SavedFilm) -> Film {
    saved.film(header.spp).scaled(header.scale)
}

impl Merged {
    /// Writes it as the checkpoint of one run.
    pub fn save(&mut self, path: &Path) -> Result<()> {
        let Some((saved, state)) = &mut self.saved else {
            return Err(Error::Usage(format!(
                "{}: {CHAINS_ARE_OWN}, so there is none to go on with; valid outputs are .exr and .png",
                path.display()
            )));
        };
        Checkpoints::open(path)?.save_film(&self.header, saved, state)
    }
}
