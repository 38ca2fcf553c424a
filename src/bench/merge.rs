//! Benches of the same variants with other seeds, put together: their runs are those of one bench, and the figures are made of them anew.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use super::results::{Results, SceneResults, Setup, VariantResults};
use super::run::{Bench, Limits, Variant};
use super::subject::{Snapshot, Stop, Subject};
use crate::error::{Error, Result};
use crate::reference;

/// The file of a bench's folder that holds what it found.
const RESULTS: &str = "results.json";

/// What was said of a subject that ran elsewhere.
struct Measured {
    renderer: String,
    setup: Setup,
    device_bytes: Option<u64>,
    notes: Vec<String>,
}

impl Subject for Measured {
    fn renderer(&self) -> String {
        self.renderer.clone()
    }

    fn setup(&self) -> Setup {
        self.setup
    }

    fn device_bytes(&self) -> Option<u64> {
        self.device_bytes
    }

    fn notes(&self) -> Vec<String> {
        self.notes.clone()
    }

    fn begin(&mut self, _: u32) -> Result<()> {
        Err(Error::Usage(String::from("a run of another bench cannot begin again")))
    }

    fn advance(&mut self, _: Stop) -> Result<Snapshot> {
        self.begin(0)?;
        Err(Error::Usage(String::from("a run of another bench cannot go on")))
    }
}

/// Merges the benches of some folders into a new one: copies the images of their runs there, and makes the figures anew. Images of equal time and equal
/// samples are the first one's. Fails, with the folder's name, where one measured something else, elsewhere, or a seed that another one has.
pub fn merge(folders: &[PathBuf], output: &Path) -> Result<Results> {
    let all = folders.iter().map(|folder| read(folder)).collect::<Result<Vec<_>>>()?;
    let Some(((first_folder, first), others)) = all.split_first() else {
        return Err(Error::Usage(String::from("there is nothing to merge")));
    };
    if output.join(RESULTS).exists() {
        return Err(Error::Usage(format!("{} holds a bench already: choose another folder", output.display())));
    }
    for (folder, other) in others {
        if let Some(differs) = difference((first_folder, first), (folder, other))? {
            return Err(Error::Usage(format!(
                "{} is not of the same bench as {}: {differs}",
                folder.display(),
                first_folder.display()
            )));
        }
    }
    check_seeds(&all)?;
    copy(&first_folder.join("images"), &output.join("images"))?;
    for (folder, _) in &all {
        copy(&folder.join("runs"), &output.join("runs"))?;
    }
    let mut merged = first.clone();
    for (folder, other) in others {
        let (command, name) = (&other.command, folder.display());
        merged.command += &format!("; {command} ({name})");
        merged.seeds += other.seeds;
    }
    for (index, scene) in merged.scenes.iter_mut().enumerate() {
        for (_, other) in others {
            for (variant, from) in scene.variants.iter_mut().zip(&other.scenes[index].variants) {
                variant.runs.extend_from_slice(&from.runs);
            }
        }
        sum_up(output, scene, Limits { seeds: first.seeds, seconds: first.seconds, spp: first.spp, first_seed: 0 })?;
    }
    Ok(merged)
}

fn read(folder: &Path) -> Result<(&Path, Results)> {
    Ok((folder, Results::read(&folder.join(RESULTS))?))
}

/// Makes the figures of a scene's runs anew.
fn sum_up(folder: &Path, scene: &mut SceneResults, limits: Limits) -> Result<()> {
    let truth = reference::read(&folder.join(&scene.reference.image), scene.width, scene.height)?;
    let bench = Bench { folder, scene: &scene.name, limits, fingerprint: 0, truth: &truth };
    let variant = |of: &VariantResults| Variant {
        name: of.name.clone(),
        technique: of.technique.clone(),
        backend: of.backend.clone(),
        options: of.options.clone(),
        bias: of.bias.clone(),
        subject: Box::new(Measured {
            renderer: of.renderer.clone(),
            setup: of.setup,
            device_bytes: of.device_bytes,
            notes: of.notes.clone(),
        }),
    };
    let variants: Vec<Variant> = scene.variants.iter().map(variant).collect();
    let mut runs: Vec<_> = scene.variants.iter().map(|variant| variant.runs.clone()).collect();
    runs.iter_mut().for_each(|runs| runs.sort_by_key(|run| run.seed));
    (scene.variants, scene.pairs) = bench.summed_up(&variants, &runs)?;
    Ok(())
}

/// What of two benches differs that must not; nothing where they can be merged.
fn difference((folder, first): (&Path, &Results), (other_folder, other): (&Path, &Results)) -> Result<Option<String>> {
    let mut all = vec![
        ("the version", first.version.clone(), other.version.clone()),
        ("the device", format!("{:?}", first.device), format!("{:?}", other.device)),
        ("seconds of a run", format!("{:?}", first.seconds), format!("{:?}", other.seconds)),
        ("samples of a run", format!("{:?}", first.spp), format!("{:?}", other.spp)),
        ("the scenes", names(first), names(other)),
    ];
    for (own, its) in first.scenes.iter().zip(&other.scenes) {
        let size = |scene: &SceneResults| {
            format!("{}x{}, depth {}, {} triangles", scene.width, scene.height, scene.max_depth, scene.triangles)
        };
        all.push(("the image", size(own), size(its)));
        let variants = |scene: &SceneResults| {
            let named = scene.variants.iter().map(|of| format!("{} of {}", of.name, of.renderer));
            named.collect::<Vec<_>>().join(", ")
        };
        all.push(("the variants", variants(own), variants(its)));
    }
    if let Some((what, own, its)) = all.into_iter().find(|(_, own, its)| own != its) {
        return Ok(Some(format!("{what} ({its} there, {own} here)")));
    }
    for (own, its) in first.scenes.iter().zip(&other.scenes) {
        let image =
            |folder: &Path, scene: &SceneResults| crate::image::read_image(&folder.join(&scene.reference.image));
        if image(folder, own)? != image(other_folder, its)? {
            return Ok(Some(format!(
                "errors in {} are against another reference; give both benches the same one with --reference",
                own.name
            )));
        }
    }
    Ok(None)
}

fn names(results: &Results) -> String {
    results.scenes.iter().map(|scene| scene.name.as_str()).collect::<Vec<_>>().join(", ")
}

/// Fails where two benches have runs of one seed.
fn check_seeds(all: &[(&Path, Results)]) -> Result<()> {
    let mut seen: BTreeMap<(usize, usize, u32), &Path> = BTreeMap::new();
    for (folder, results) in all {
        for (scene, of_scene) in results.scenes.iter().enumerate() {
            for (variant, of) in of_scene.variants.iter().enumerate() {
                for run in &of.runs {
                    if let Some(other) = seen.insert((scene, variant, run.seed), folder) {
                        return Err(Error::Usage(format!(
                            "{} and {} both have seed {} of {}: each counts once; lumbre bench --first-seed begins with another",
                            other.display(),
                            folder.display(),
                            run.seed,
                            of.name
                        )));
                    }
                }
            }
        }
    }
    Ok(())
}

/// Copies the files of a folder, but for what is kept of runs for going on with that bench.
fn copy(from: &Path, to: &Path) -> Result<()> {
    fs::create_dir_all(to).map_err(|error| Error::write(to, error))?;
    for entry in fs::read_dir(from).map_err(|error| Error::read(from, error))? {
        let path = entry.map_err(|error| Error::read(from, error))?.path();
        let is_image = path.extension().is_some_and(|extension| extension != "json");
        if let (true, Some(name)) = (path.is_file() && is_image, path.file_name()) {
            let target = to.join(name);
            fs::copy(&path, &target).map_err(|error| Error::write(&target, error))?;
        }
    }
    Ok(())
}
