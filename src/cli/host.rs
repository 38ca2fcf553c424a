//! What a bench or a lecture says of where it ran, and where benches keep what others can use.

use std::path::{Path, PathBuf};

use lumbre::bench::results::Device;
use lumbre::error::{Error, Result};
use lumbre::gpu::Gpu;

/// The command line, with arguments that need it in quotes.
pub(in crate::cli) fn command_line() -> String {
    let quoted = |argument: String| {
        let plain = |c: char| c.is_ascii_alphanumeric() || "-_./,:=+@%".contains(c);
        if !argument.is_empty() && argument.chars().all(plain) { argument } else { format!("'{argument}'") }
    };
    let arguments = std::env::args_os().skip(1).map(|argument| quoted(argument.to_string_lossy().into_owned()));
    std::iter::once(String::from("lumbre")).chain(arguments).collect::<Vec<_>>().join(" ")
}

/// The device and the host.
pub(in crate::cli) fn device(gpu: &Gpu) -> Device {
    let survey = gpu.survey();
    // Linux says which processor it is; elsewhere its architecture must do.
    let processor = std::fs::read_to_string("/proc/cpuinfo").ok().and_then(|text| {
        let line = text.lines().find(|line| line.starts_with("model name"))?;
        Some(line.split_once(':')?.1.trim().to_owned())
    });
    let (os, architecture) = (std::env::consts::OS, std::env::consts::ARCH);
    Device {
        name: survey.name.clone(),
        driver: survey.driver.clone(),
        processors: std::thread::available_parallelism().map_or(1, |count| count.get() as u32),
        host: processor.map_or(format!("{os} {architecture}"), |name| format!("{os} {architecture}, {name}")),
    }
}

/// Where references are kept for other benches: the user's cache, or the bench's own folder where there is none.
pub(super) fn cache_folder(output: &Path) -> Result<PathBuf> {
    let base = std::env::var_os("XDG_CACHE_HOME")
        .map(PathBuf::from)
        .filter(|path| path.is_absolute())
        .or_else(|| Some(PathBuf::from(std::env::var_os("HOME")?).join(".cache")));
    let folder = base.map(|base| base.join("lumbre").join("references"));
    if let Some(folder) = folder.filter(|folder| std::fs::create_dir_all(folder).is_ok()) {
        return Ok(folder);
    }
    let folder = output.join("references");
    std::fs::create_dir_all(&folder).map_err(|error| Error::write(&folder, error))?;
    Ok(folder)
}
