//! What a scene file asks of the renderer besides its content: an image, a technique, a way to select lights.

use super::filter::Filter;
use crate::error::one_of;

/// The image that a scene file asks for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FilmSettings {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Reconstruction filter.
    pub filter: Filter,
}

/// What a scene file asks of the renderer; the command line goes before it.
#[derive(Clone, Debug, Default)]
pub struct TechniqueRequest {
    /// A technique of the table, with its parameters as `name=value`.
    pub integrator: Option<(String, Vec<(String, String)>)>,
    /// The file asks for an integrator that there is not: what is wrong with it, where the command line names no technique.
    pub refused: Option<String>,
    /// The camera looks through emitters and does not see the background; they light the scene all the same.
    pub hide_emitters: bool,
    /// Samples per pixel.
    pub spp: Option<u32>,
    /// Longest path in segments; `Some(None)` is no limit.
    pub max_depth: Option<Option<u32>>,
    /// Segments before Russian roulette.
    pub rr_depth: Option<u32>,
    /// Further layers of the image: the name of each, and what it shows, as `--aov` calls it.
    pub aovs: Vec<(String, &'static str)>,
}

/// How the lights of a scene are selected.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LightSelection {
    /// From a tree where there are more than 32 lights, else by power.
    #[default]
    Auto,
    /// In proportion to power, wherever the point lies.
    Power,
    /// From a tree, by place and direction; lights infinitely far by power.
    Tree,
}

impl LightSelection {
    /// Every way, by its name on the command line.
    pub const ALL: [(&str, Self); 3] = [("auto", Self::Auto), ("power", Self::Power), ("tree", Self::Tree)];

    /// Its name.
    pub fn name(self) -> &'static str {
        Self::ALL.iter().find(|(_, how)| *how == self).map_or("", |(name, _)| name)
    }
}

impl std::str::FromStr for LightSelection {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        let found = Self::ALL.iter().find(|(known, _)| *known == name);
        found.map(|(_, how)| *how).ok_or_else(|| format!("valid are {}", one_of(Self::ALL.map(|(known, _)| known))))
    }
}
