//! The SPIR-V modules that there are: technique x pass x backend from the table in `src/techniques/table.rs`, and the kernels in `shaders/kernels`.

use std::fs;
use std::path::Path;

use crate::layout::backend::{BACKENDS, BackendRow};
use crate::table::{self, TECHNIQUES, TechniqueRow};

/// One SPIR-V module to make.
pub struct Variant {
    /// Its name: `path.pixels.bvh`.
    pub name: String,
    /// Path below the folder of the shaders.
    pub file: String,
    /// What `#include "trace/backend.glsl"` stands for.
    pub backend: &'static BackendRow,
    /// Whose parameters `#include "generated/parameters.glsl"` stands for.
    pub technique: Option<&'static TechniqueRow>,
    /// A macro that is defined as 1.
    pub define: Option<String>,
}

/// The names of the files in a folder, in order.
pub fn files_in(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let mut names: Vec<String> = entries.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

/// The technique whose parameters a kernel that belongs to none has: it says so in a line `// Parameters of technique: NAME`.
fn technique_of_kernel(file: &Path) -> Result<Option<&'static TechniqueRow>, String> {
    let text = fs::read_to_string(file).map_err(|error| format!("cannot read {}: {error}", file.display()))?;
    let Some(name) = text.lines().find_map(|line| line.strip_prefix("// Parameters of technique: ")) else {
        return Ok(None);
    };
    let found = table::find(name.trim()).map(Some);
    found.ok_or_else(|| format!("{}: there is no technique '{}'", file.display(), name.trim()))
}

/// All of them; `shaders` is the folder of the shaders.
pub fn variants(shaders: &Path) -> Result<Vec<Variant>, String> {
    let mut all = Vec::new();
    for backend in BACKENDS {
        for row in TECHNIQUES {
            for pass in row.passes {
                all.push(Variant {
                    name: row.module(pass, backend.name),
                    file: row.file.to_owned(),
                    backend,
                    technique: Some(row),
                    define: Some(pass.define()),
                });
            }
        }
        for folder in ["film", "rays", "test"] {
            for kernel in files_in(&shaders.join("kernels").join(folder)).iter().filter(|file| file.ends_with(".glsl"))
            {
                // What a driver traverses on its own cannot be counted.
                if kernel == "count.glsl" && !backend.counts {
                    continue;
                }
                let file = format!("kernels/{folder}/{kernel}");
                let technique = technique_of_kernel(&shaders.join(&file))?;
                let name = format!("{folder}/{}.{}", kernel.trim_end_matches(".glsl"), backend.name);
                all.push(Variant { name, file, backend, technique, define: None });
            }
        }
    }
    Ok(all)
}
