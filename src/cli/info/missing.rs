//! `lumbre info --missing`: what of some scenes would be refused, or left out.

use std::collections::HashSet;
use std::path::Path;

use serde::Serialize;

use lumbre::error::{Error, Result};
use lumbre::scene::LoadOptions;
use lumbre::scene::load::{missing, scene_files};

use crate::cli::output::{print, takes_standard_output, write_json};

#[derive(Serialize)]
struct Row {
    scene: String,
    loads: bool,
    refused: Vec<String>,
    warnings: Vec<String>,
}

/// Tries all scenes; fails if any would be refused.
pub(super) fn run<'a>(named: impl Iterator<Item = &'a Path>, options: &LoadOptions, json: Option<&Path>) -> Result<()> {
    let mut rows = Vec::new();
    // Files of a folder that belong to another scene of it are tried as part of that.
    let (mut of_folders, mut parts) = (Vec::new(), HashSet::new());
    for named in named {
        for file in scene_files(named)? {
            let found = missing(&file, options);
            let scene = file.display().to_string();
            parts.extend(found.names.iter().filter_map(|name| name.canonicalize().ok()));
            of_folders.push(named.is_dir().then(|| file.canonicalize().ok()).flatten());
            rows.push(Row { scene, loads: found.refused.is_empty(), refused: found.refused, warnings: found.warnings });
        }
    }
    let mut of_folders = of_folders.into_iter();
    rows.retain(|_| of_folders.next().flatten().is_none_or(|file| !parts.contains(&file)));
    if let Some(path) = json {
        write_json(path, &rows)?;
    }
    if !json.is_some_and(takes_standard_output) {
        for row in &rows {
            print(&format!("{} {}", if row.loads { "loads  " } else { "refused" }, row.scene));
            row.refused.iter().for_each(|message| print(&format!("        {message}")));
            row.warnings.iter().for_each(|message| print(&format!("        warning: {message}")));
        }
    }
    let refused = rows.iter().filter(|row| !row.loads).count();
    if refused > 0 {
        return Err(Error::Usage(format!("{refused} of {} scenes would be refused", rows.len())));
    }
    Ok(())
}
