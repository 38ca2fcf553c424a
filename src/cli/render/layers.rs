//! `--aov`: further layers of an EXR file.

use lumbre::error::{Error, Result, one_of};
use lumbre::image::{Image, NamedLayer};
use lumbre::render::aovs::{AOVS, AovFilm, AovRow, find};
use lumbre::render::film::Film;
use lumbre::scene::Scene;

/// All AOVs.
const ALL: &str = "all";
/// What the film holds besides the image: the variance of each pixel's mean, and how many samples a pixel has.
const OF_FILM: [&str; 2] = ["variance", "samples"];

/// A layer that is asked for.
pub(super) struct Layer {
    /// Its name in the file.
    name: String,
    /// The AOV that it shows; nothing for what the film holds.
    aov: Option<&'static AovRow>,
}

/// The layers that can be asked for.
pub(in crate::cli) fn names() -> Vec<&'static str> {
    OF_FILM.into_iter().chain(AOVS.iter().map(|row| row.name)).chain([ALL]).collect()
}

/// The layers that the command line asks for.
pub(super) fn parse(names: &[String]) -> Result<Vec<Layer>> {
    let mut layers: Vec<Layer> = Vec::new();
    for name in names {
        match (find(name), name.as_str()) {
            (None, ALL) => layers.extend(AOVS.iter().map(|row| Layer { name: row.name.to_owned(), aov: Some(row) })),
            (aov, name) if aov.is_some() || OF_FILM.contains(&name) => {
                layers.push(Layer { name: name.to_owned(), aov })
            }
            _ => {
                return Err(Error::Usage(format!("no layer '{name}': valid are {}", one_of(self::names()))));
            }
        }
    }
    distinct(layers)
}

/// The layer of a denoised image that holds it as it was.
const NOISY: &str = "noisy";

/// The layers of a denoised image.
pub(super) fn with_noisy(mut layers: Vec<Layer>) -> Result<Vec<Layer>> {
    layers.push(Layer { name: String::from(NOISY), aov: None });
    distinct(layers)
}

/// The layers that a scene's file asks for.
pub(super) fn of_scene(scene: &Scene) -> Result<Vec<Layer>> {
    let layer = |(name, shown): &(String, &'static str)| Layer { name: name.clone(), aov: find(shown) };
    distinct(scene.technique.aovs.iter().map(layer).collect())
}

/// Fails where two have one name.
fn distinct(layers: Vec<Layer>) -> Result<Vec<Layer>> {
    let repeated = layers.iter().enumerate().find(|(index, own)| layers[..*index].iter().any(|it| it.name == own.name));
    match repeated {
        Some((_, layer)) => Err(Error::Usage(format!("the layer '{}' is asked for twice", layer.name))),
        None => Ok(layers),
    }
}

/// Whether some of them are AOVs.
pub(super) fn have_aovs(layers: &[Layer]) -> bool {
    layers.iter().any(|layer| layer.aov.is_some())
}

/// The layers as images. AOVs that could not be made are left out.
pub(super) fn images(layers: &[Layer], film: &Film, aovs: Option<&AovFilm>) -> Vec<NamedLayer> {
    let image = |pixels| Image { width: film.width, height: film.height, pixels };
    let one = |layer: &Layer| {
        let name = layer.name.clone();
        Some(match (layer.aov, aovs) {
            (Some(row), Some(aovs)) => NamedLayer { name, channels: row.channels, image: image(aovs.values(row)) },
            (Some(_), None) => return None,
            (None, _) if layer.name == OF_FILM[0] => NamedLayer::colours(name, film.mean_variance()),
            (None, _) if layer.name == NOISY => NamedLayer::colours(name, film.mean()),
            (None, _) => NamedLayer::colours(name, image(film.counts.iter().map(|count| [*count as f32; 3]).collect())),
        })
    };
    layers.iter().filter_map(one).collect()
}

/// The most objects whose names go into the header of a file.
const MOST_NAMES: usize = 1 << 16;

/// What the header says of AOVs: their samples, and what the numbers of materials and objects stand for, as JSON.
pub(super) fn header(layers: &[Layer], scene: &Scene, aovs: &AovFilm) -> Vec<(String, String)> {
    let mut all = vec![(String::from("lumbre.aov_samples"), aovs.samples.to_string())];
    let mut names = |aov: &str, key: &str, names: Vec<Option<&str>>| {
        if layers.iter().any(|layer| layer.aov.is_some_and(|row| row.name == aov)) && names.len() <= MOST_NAMES {
            let named = names.into_iter().zip(1..).filter_map(|(name, id)| Some((format!("{id}"), name?.into())));
            let named: serde_json::Map<String, serde_json::Value> = named.collect();
            all.push((format!("lumbre.{key}"), serde_json::Value::Object(named).to_string()));
        }
    };
    names("material_id", "material_names", scene.material_names.iter().map(Option::as_deref).collect());
    names("object_id", "object_names", scene.object_names().into_iter().map(Some).collect());
    all
}
