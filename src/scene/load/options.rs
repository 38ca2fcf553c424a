//! How a scene is to be read.

use std::path::Path;

use crate::error::one_of;
use crate::scene::LightSelection;

/// A format of scenes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SceneFormat {
    /// Mitsuba 3.
    Xml,
    /// glTF 2.0, as text or binary.
    Gltf,
    /// Wavefront OBJ with its MTL files.
    Obj,
    /// A PLY mesh.
    Ply,
}

impl SceneFormat {
    /// Every format by its names: extensions of files, and values of `--format`.
    pub const ALL: [(&str, Self); 5] =
        [("xml", Self::Xml), ("gltf", Self::Gltf), ("glb", Self::Gltf), ("obj", Self::Obj), ("ply", Self::Ply)];
}

impl std::str::FromStr for SceneFormat {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        let found = Self::ALL.iter().find(|(known, _)| *known == name);
        found
            .map(|(_, format)| *format)
            .ok_or_else(|| format!("valid are {}", one_of(Self::ALL.map(|(known, _)| known))))
    }
}

impl SceneFormat {
    /// Its first name.
    pub fn name(self) -> &'static str {
        Self::ALL.iter().find(|(_, format)| *format == self).map_or("", |(name, _)| name)
    }

    /// The format that the extension of a file's name says.
    pub fn by_extension(path: &Path) -> Option<Self> {
        path.extension()?.to_string_lossy().to_lowercase().parse().ok()
    }
}

/// How a scene is to be read.
#[derive(Clone, Debug, Default)]
pub struct LoadOptions {
    /// Its format; where it is nothing, the extension of its name says.
    pub format: Option<SceneFormat>,
    /// Parameters of a Mitsuba scene, `-D name=value`.
    pub defines: Vec<(String, String)>,
    /// How its lights are selected.
    pub lights: LightSelection,
    /// Give rough metals and rough glass of a Mitsuba scene back what they lose to multiple scattering, which Mitsuba does
    /// not.
    pub energy_compensation: bool,
    /// Filter the images of materials over what a path sees of them, with less noise and a blur; Mitsuba looks up points.
    pub mip_maps: bool,
}

impl LoadOptions {
    /// The words of a command line that loads this file in the same way.
    pub fn words(&self, file: &Path) -> Vec<String> {
        let mut words = vec![file.display().to_string()];
        let mut add = |flag: &str, value: String| words.extend([flag.to_owned(), value]);
        if let Some(format) = self.format {
            add("--format", format.name().to_owned());
        }
        for (name, value) in &self.defines {
            add("-D", format!("{name}={value}"));
        }
        if self.lights != LightSelection::Auto {
            add("--lights", self.lights.name().to_owned());
        }
        words.extend(self.energy_compensation.then(|| String::from("--energy-compensation")));
        words.extend(self.mip_maps.then(|| String::from("--mip-maps")));
        words
    }
}
