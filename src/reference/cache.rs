//! References that were made before, by all that they depend on.

use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::{Path, PathBuf};

use super::certificate::SCHEMA;
use super::file::{read, write};
use super::make::make;
use super::parts::{self, Parts};
use super::request::{Budget, Request, Step};
use super::truth::Truth;
use crate::error::{Error, Result};
use crate::files::is_stream;
use crate::render::kernels_fingerprint;

/// Counts up whenever references are made in another way: older ones are not taken then.
const REVISION: u32 = 4;

impl Request<'_> {
    /// What the image depends on, in 64 bits, but for how long it is rendered: the scene, the settings, the kernels, the
    /// device, whose seconds count.
    pub fn key(&self) -> u64 {
        let mut hasher = DefaultHasher::new();
        self.scene.hash_content(&mut hasher);
        // The technique is chosen, and the seed is the request's.
        let mut settings = self.settings.clone();
        settings.seed = self.seed;
        let survey = self.gpu.survey();
        format!("{settings:?} {:?} {SCHEMA} {REVISION} {} {}", self.solves, survey.name, survey.driver)
            .hash(&mut hasher);
        kernels_fingerprint().hash(&mut hasher);
        if let Budget::Samples(samples) = self.budget {
            samples.to_bits().hash(&mut hasher);
        }
        hasher.finish()
    }
}

/// Takes a reference from a folder, where one is that had as much time, or makes it and puts it there. The second value says whether it
/// was there.
///
/// # Errors
///
/// As of [`make`].
pub fn obtain(request: &Request, folder: &Path, hear: &mut dyn FnMut(Step) -> Result<()>) -> Result<(Truth, bool)> {
    let key = request.key();
    let path = folder.join(format!("reference-{key:016x}.exr"));
    let (width, height) = (request.settings.width, request.settings.height);
    // What cannot be read, or was cut short by something else than us, is made anew.
    if path.exists()
        && let Ok(truth) = read(&path, width, height)
        && truth.certificate.as_ref().is_some_and(|certificate| request.budget.is_within(certificate.budget))
    {
        return Ok((truth, true));
    }
    let truth = resume(request, &path, hear)?;
    Ok((truth, false))
}

/// Makes a reference and writes it; one that was interrupted goes on from what is kept beside it.
///
/// # Errors
///
/// As of [`make`], and a file that cannot be written.
pub fn resume(request: &Request, path: &Path, hear: &mut dyn FnMut(Step) -> Result<()>) -> Result<Truth> {
    if is_stream(path) {
        // There is no file beside it to keep anything in.
        let truth = make(request, hear)?;
        write(path, &truth)?;
        return Ok(truth);
    }
    let kept: PathBuf = parts::path(path);
    let key = request.key();
    let truth = make(&Request { parts: Some((&kept, key)), ..*request }, hear).map_err(|error| match error {
        Error::Interrupted(_) if Parts::read(&kept, key).is_some() => Error::Interrupted(format!(
            "what was rendered of the reference is kept in {}; the same command goes on",
            kept.display()
        )),
        other => other,
    })?;
    write(path, &truth)?;
    // It is of no further use; that it cannot be removed is no reason to fail.
    let _ = std::fs::remove_file(&kept);
    Ok(truth)
}

impl Budget {
    /// Whether so many seconds are as many as are asked for.
    fn is_within(self, seconds: f64) -> bool {
        match self {
            Self::Seconds(asked) => seconds >= asked,
            Self::Samples(_) => true,
        }
    }
}
