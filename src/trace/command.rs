//! The command that tells what happened to the paths of a sample.

use std::path::Path;

use crate::scene::LoadOptions;
use crate::techniques::{Overrides, Settings};

/// The `lumbre trace` that loads the file in that way, comes to those settings, and asks what the last words say, as a shell takes it.
pub fn command(
    file: &Path,
    options: &LoadOptions,
    overrides: &Overrides,
    settings: &Settings,
    asks: &[&str],
) -> String {
    let of_scene = options.words(file);
    let of_settings = overrides.words(settings);
    let own = of_scene.iter().chain(&of_settings).map(String::as_str);
    let words: Vec<&str> = ["lumbre", "trace"].into_iter().chain(own).chain(asks.iter().copied()).collect();
    shlex::try_join(words.iter().copied()).unwrap_or_else(|_| words.join(" "))
}
