//! What sub-commands write to the user: text, warnings, JSON, a bar.

use std::io::{IsTerminal, Write};
use std::path::Path;

use indicatif::{ProgressBar, ProgressStyle};
use serde::Serialize;

use lumbre::error::{Error, Result};
use lumbre::files::{check_writable, replace_file};
use lumbre::scene::Scene;

/// Writes to standard output; a reader that has gone away is no error.
pub(super) fn print(text: &str) {
    let _ = writeln!(std::io::stdout().lock(), "{text}");
}

pub(super) fn print_warnings(scene: &Scene) {
    for warning in &scene.warnings {
        eprintln!("warning: {}: {warning}", scene.source.display());
    }
}

/// Fails where the JSON that was asked for could not be written.
pub(super) fn check_json(path: Option<&Path>) -> Result<()> {
    path.filter(|path| *path != Path::new("-")).map_or(Ok(()), check_writable)
}

/// Writes a value as JSON to a file, or to standard output where the path is `-`.
pub(super) fn write_json(path: &Path, value: &impl Serialize) -> Result<()> {
    let text = serde_json::to_string_pretty(value).map_err(|error| Error::write(path, error))?;
    if path == Path::new("-") {
        print(&text);
        return Ok(());
    }
    replace_file(path, |file| writeln!(file, "{text}").map_err(|error| error.to_string()))
}

/// A bar of a thousand steps on standard error, where that is a terminal.
pub(super) fn bar_on_terminal() -> Option<ProgressBar> {
    std::io::stderr().is_terminal().then(|| {
        let bar = ProgressBar::new(1000);
        if let Ok(style) = ProgressStyle::with_template("{wide_bar} {msg}") {
            bar.set_style(style);
        }
        bar
    })
}
