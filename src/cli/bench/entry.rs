//! A scene of a bench.

use std::path::PathBuf;

use lumbre::reference::Truth;
use lumbre::render::Settings;
use lumbre::scene::Scene;
use lumbre::techniques::Solves;

/// A scene with what it is compared with.
pub(super) struct Entry {
    pub name: String,
    pub file: PathBuf,
    pub scene: Scene,
    pub load: f64,
    pub settings: Settings,
    /// The light that the reference has.
    pub solves: Solves,
    pub given: Option<(PathBuf, Truth)>,
}
