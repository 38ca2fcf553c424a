//! How a scene is to be read.

use crate::scene::LightSelection;

/// How a scene is to be read.
#[derive(Clone, Debug, Default)]
pub struct LoadOptions {
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
