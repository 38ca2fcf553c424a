//! What sub-commands write to the user: text, warnings, JSON, a bar.

use std::io::{ErrorKind, IsTerminal, Write};
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use indicatif::{ProgressBar, ProgressStyle};
use serde::Serialize;

use lumbre::error::{Error, Result};
use lumbre::files::{STANDARD_INPUT, check_promise, check_writable, is_standard_output, replace_file, same_file};
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

/// Fails where the JSON that was asked for could not be written, or its name is that of another sort of file.
pub(super) fn check_json(path: Option<&Path>) -> Result<()> {
    check_file(path, "JSON", "json")
}

/// Fails where a file that holds this, and may end in `.own`, could not be written, or its name is that of another sort of file.
pub(super) fn check_file(path: Option<&Path>, holds: &str, own: &str) -> Result<()> {
    let Some(path) = path.filter(|path| !is_dash(path)) else { return Ok(()) };
    check_promise(path, holds, own)?;
    check_writable(path)
}

/// Whether an output is named `-`, which stands for standard output.
fn is_dash(path: &Path) -> bool {
    path == Path::new(STANDARD_INPUT)
}

/// The file to write to where an output is named so: `-` is standard output.
pub(super) fn destination(path: &Path) -> PathBuf {
    if is_dash(path) { PathBuf::from("/dev/stdout") } else { path.to_owned() }
}

/// Whether an output goes to standard output, which then holds nothing else.
pub(super) fn takes_standard_output(path: &Path) -> bool {
    is_dash(path) || is_standard_output(path)
}

/// Fails where two outputs are one file, or both go to standard output.
pub(super) fn check_apart<'a>(outputs: impl IntoIterator<Item = &'a Path>) -> Result<()> {
    let mut is_taken = false;
    let mut files: Vec<PathBuf> = Vec::new();
    for path in outputs {
        if takes_standard_output(path) && std::mem::replace(&mut is_taken, true) {
            let message = "standard output takes one output, and two are to go there: give the other a file";
            return Err(Error::Usage(String::from(message)));
        }
        // Nothing in a device or a pipe is replaced.
        let Some(file) = same_file(path).filter(|_| !is_dash(path)) else { continue };
        if files.contains(&file) {
            return Err(Error::Usage(format!("{} is to be two outputs: give each its own file", path.display())));
        }
        files.push(file);
    }
    Ok(())
}

/// Writes a value as JSON to a file, or to standard output where the path is `-`.
pub(super) fn write_json(path: &Path, value: &impl Serialize) -> Result<()> {
    let text = serde_json::to_string_pretty(value).map_err(|error| Error::write(path, error))?;
    if is_dash(path) {
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
