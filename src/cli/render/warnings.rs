//! What a user should know of a technique in a scene before its image is there.

use lumbre::render::Settings;
use lumbre::scene::{Camera, Scene};
use lumbre::techniques::Correlated;

use super::super::output::say;

/// Says what the image will lack, or have too much of; `to_error` is whether it ends at an estimated error.
pub(super) fn say_all(scene: &Scene, camera: &Camera, settings: &Settings, to_error: bool) {
    let technique = &settings.technique;
    let name = technique.row.name;
    if let Some(missed) = technique.misses(scene) {
        say!("warning: {name} does not find {missed}: the image lacks it");
    }
    if let (Some(light), true) = (technique.finds_rarely(scene), to_error) {
        say!(
            "warning: {name} finds {light} only with rare, bright samples: --error does not see those that have not come yet"
        );
    }
    let stands_at = camera.to_world.translation - scene.origin;
    if technique.row.is_light_tracing() && scene.is_within_smooth_glass(stands_at) {
        say!(
            "warning: the camera stands within smooth glass: {name} shows it nothing that lies outside; valid is any other technique"
        );
    }
    if let Some(taken) = technique.simplifies(scene) {
        say!("warning: {name} takes for diffuse, with the albedo that they have: {taken}");
    }
    if settings.shard.is_some() && technique.row.correlated == Correlated::Samples {
        say!("note: {name}: {}", lumbre::merge::CHAINS_ARE_OWN);
    }
}
