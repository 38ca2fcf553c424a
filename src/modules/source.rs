//! The text of a shader: its files, and what is generated from the host's lists.

use std::fs;
use std::path::{Path, PathBuf};

use super::variants::Variant;
use crate::layout::{self, SharedStruct};
use crate::table;

/// The shaders' folder, and the texts that are generated for all of them.
pub struct Sources {
    folder: PathBuf,
    generated: Vec<(&'static str, String)>,
}

impl Sources {
    /// The shaders in this folder.
    pub fn new(folder: &Path) -> Self {
        let of_techniques: Vec<&'static SharedStruct> = table::structs().collect();
        let generated = vec![
            ("generated/layout.glsl", layout::glsl(&of_techniques)),
            ("generated/inline.glsl", layout::inline_glsl()),
            ("generated/materials.glsl", layout::materials_glsl()),
            ("generated/properties.glsl", layout::properties_glsl()),
            ("generated/lights.glsl", layout::lights_glsl()),
        ];
        Self { folder: folder.to_owned(), generated }
    }

    /// The text of a file in the folder.
    pub fn read(&self, file: &str) -> Result<String, String> {
        let path = self.folder.join(file);
        fs::read_to_string(&path).map_err(|error| format!("cannot read {}: {error}", path.display()))
    }

    /// What `#include "name"` stands for in a module: the name that messages show, and the text.
    pub fn resolve(&self, name: &str, variant: &Variant) -> Result<(String, String), String> {
        let generated = |name: &str| self.generated.iter().find(|(own, _)| *own == name).map(|(_, text)| text.clone());
        let (shown, text) = if name == "generated/parameters.glsl" {
            (name.to_owned(), variant.technique.map_or_else(String::new, table::TechniqueRow::parameters_glsl))
        } else if let Some(text) = generated(name) {
            (name.to_owned(), text)
        } else {
            let file = match name {
                "trace/backend.glsl" => format!("trace/{}", variant.backend.file),
                name => name.to_owned(),
            };
            (format!("shaders/{file}"), self.read(&file)?)
        };
        // Each file takes part once, as if it had an include guard.
        let guard: String =
            shown.chars().map(|c| if c.is_ascii_alphanumeric() { c.to_ascii_uppercase() } else { '_' }).collect();
        Ok((shown, format!("#ifndef INCLUDED_{guard}\n#define INCLUDED_{guard}\n#line 1\n{text}\n#endif\n")))
    }
}
