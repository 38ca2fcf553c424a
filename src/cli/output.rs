//! What sub-commands write to the user: text, warnings, JSON, a bar.

use std::io::{ErrorKind, IsTerminal, Write};
use std::path::Path;
use std::sync::OnceLock;

use indicatif::{ProgressBar, ProgressStyle};
use serde::Serialize;

use lumbre::error::{Error, Result};
use lumbre::files::{check_writable, replace_file};
use lumbre::scene::Scene;

/// Why standard output could not be written, the first time.
static REFUSED: OnceLock<String> = OnceLock::new();

/// Writes a line to standard output. A reader that has gone away is no error; any other is told by [`finish`].
pub(super) fn print(text: &str) {
    note(writeln!(std::io::stdout().lock(), "{text}"));
}

/// Takes note of what came of writing to standard output.
pub(super) fn note(written: std::io::Result<()>) {
    if let Err(error) = written
        && error.kind() != ErrorKind::BrokenPipe
    {
        REFUSED.get_or_init(|| error.to_string());
    }
}

/// Ends writing to standard output; fails where some of that was lost.
pub(super) fn finish() -> Result<()> {
    note(std::io::stdout().flush());
    REFUSED.get().map_or(Ok(()), |cause| Err(Error::write(Path::new("standard output"), cause)))
}

/// Writes a line to standard error, as `eprintln!` does; that nobody can read it is no error.
macro_rules! say {
    ($($text:tt)*) => {{
        let _ = std::io::Write::write_fmt(&mut std::io::stderr().lock(), format_args!("{}\n", format_args!($($text)*)));
    }};
}
pub(super) use say;

pub(super) fn print_warnings(scene: &Scene) {
    for warning in &scene.warnings {
        say!("warning: {}: {warning}", scene.source.display());
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
        return finish();
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
