//! `--checkpoint` and `--resume`: when a rendering is written down, and from where it goes on.

use std::path::Path;
use std::time::Instant;

use lumbre::checkpoint::{Checkpoints, Found, Header, Identity};
use lumbre::error::{Error, Result};
use lumbre::gpu::Gpu;
use lumbre::render::{Renderer, Settings};
use lumbre::scene::Scene;

use super::about::About;
use crate::cli::output::say;

/// Seconds between two checkpoints where the command line does not say.
pub(super) const INTERVAL: f64 = 60.0;

/// Keeps a rendering in a file, where that was asked for.
pub(super) struct CheckpointWriter {
    /// Nothing where it was not.
    files: Option<Checkpoints>,
    interval: f64,
    identity: Identity,
    about: serde_json::Value,
    found: Option<Found>,
    last: Instant,
    /// Samples per pixel of the last checkpoint; nothing before the first.
    kept: Option<u32>,
}

impl CheckpointWriter {
    /// Takes hold of the file, and finds what to go on from where that is asked for.
    pub fn new(
        file: Option<&Path>,
        interval: f64,
        resume: bool,
        quiet: bool,
        (scene, settings, gpu): (&Scene, &mut Settings, &Gpu),
    ) -> Result<Self> {
        let mut files = file.map(Checkpoints::open).transpose()?;
        let identity = Identity::of(scene, settings, gpu);
        let found = match &mut files {
            Some(files) if resume => files.find(&identity)?,
            _ => None,
        };
        if let (Some(files), None, false) = (&files, &found, quiet) {
            let path = files.path().display();
            if resume {
                say!("note: there is no {path} yet: the rendering begins anew");
            } else if let Some(older) = files.peek() {
                say!(
                    "note: {path} holds {} spp of an earlier rendering, which --resume goes on from: this one takes its place after {interval} s",
                    older.spp
                );
            }
        }
        if let Some(Found { header, path, warning }) = &found {
            settings.expected_samples = header.expected_samples;
            if let Some(warning) = warning {
                say!("warning: {warning}");
            }
            if !quiet {
                say!("note: going on from {}: {} spp after {:.1} s", path.display(), header.spp, header.spent);
            }
        }
        Ok(Self {
            files,
            interval,
            identity,
            about: serde_json::Value::Null,
            kept: found.as_ref().map(|found| found.header.spp),
            found,
            last: Instant::now(),
        })
    }

    /// Takes over what checkpoints say of the rendering and its settings.
    pub fn about(&mut self, about: &About) {
        self.about = serde_json::to_value(about).unwrap_or_default();
    }

    /// What the rendering is.
    pub fn identity(&self) -> &Identity {
        &self.identity
    }

    /// Gives the renderer the state that was found. Returns the seconds that were spent on it, and where an error is looked at next.
    pub fn restore(&mut self, renderer: &mut Renderer) -> Result<(f64, Option<u32>)> {
        self.last = Instant::now();
        let (Some(files), Some(found)) = (&self.files, &self.found) else { return Ok((0.0, None)) };
        files.restore(found, renderer)?;
        Ok((found.header.spent, found.header.next_look))
    }

    /// Writes a checkpoint if it is time for one. That it cannot be written does not end the rendering: the one before it is there still,
    /// and the disk may have room again at the next.
    pub fn offer(&mut self, renderer: &mut Renderer, spent: f64, next_look: Option<u32>) -> Result<()> {
        if self.files.is_none() || self.last.elapsed().as_secs_f64() < self.interval {
            return Ok(());
        }
        match self.save(renderer, spent, next_look) {
            Err(error @ Error::File { .. }) => {
                let kept =
                    self.kept.map_or(String::from("none is kept yet"), |spp| format!("that of {spp} spp is kept"));
                say!("warning: no new checkpoint: {error}; {kept}, and the rendering goes on");
                Ok(())
            }
            other => other,
        }
    }

    /// Writes a checkpoint.
    pub fn save(&mut self, renderer: &mut Renderer, spent: f64, next_look: Option<u32>) -> Result<()> {
        let Some(files) = &mut self.files else { return Ok(()) };
        let header = Header::of(renderer, self.identity.clone(), self.about.clone())?;
        let header = Header { spent, next_look, ..header };
        self.last = Instant::now();
        files.save(&header, renderer)?;
        self.kept = Some(header.spp);
        Ok(())
    }

    /// The error with what is left of the rendering, and how to go on.
    pub fn explain(&self, error: Error) -> Error {
        if !matches!(error, Error::DeviceLost { .. } | Error::OutOfMemory { .. } | Error::Vulkan { .. }) {
            return error;
        }
        let kept = match &self.files {
            None => String::from("nothing of the rendering is left; --checkpoint FILE would have kept it"),
            Some(files) => self.kept().unwrap_or_else(|| {
                format!("there was no checkpoint yet in {}: the rendering begins anew", files.path().display())
            }),
        };
        Error::Stopped { cause: Box::new(error), kept }
    }

    /// What the last checkpoint keeps, and how to go on; nothing where there is none.
    pub fn kept(&self) -> Option<String> {
        let (path, spp) = (self.files.as_ref()?.path().display(), self.kept?);
        Some(format!("{path} keeps {spp} spp: the same command with --resume goes on from there"))
    }
}
