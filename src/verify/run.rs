//! What a row is given: a device, a backend, and where its figures and images go.

use std::path::{Path, PathBuf};

use super::comparison::{self, average, oddest_pixel};
use super::figure::Figure;
use crate::error::Result;
use crate::gpu::Gpu;
use crate::image::{Picture, write_picture};
use crate::layout::backend::Backend;
use crate::render::film::Film;
use crate::render::{Probe, Renderer, Settings, Technique};
use crate::scene::Scene;
use crate::statistics::{Estimate, sidak};
use crate::techniques::{Bias, Correlated, Solves, TECHNIQUES, TechniqueRow};

/// How much is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effort {
    /// The full form, and closed forms by techniques that need many samples for them.
    Long,
    /// Every technique, and what the bounds ask for: minutes.
    Full,
    /// One or two techniques and fewer samples and rays: seconds.
    Short,
}

/// The device and backend of a row's measurement, and what it has found.
pub struct Run<'a> {
    /// The device.
    pub gpu: &'a Gpu,
    /// The backend.
    pub backend: Backend,
    case: &'static str,
    effort: Effort,
    folder: Option<PathBuf>,
    figures: Vec<Figure>,
    files: Vec<String>,
    /// Samples that were dropped where none should be, and the first of them.
    dropped: (u64, String),
}

/// Whether the technique finds all light that the scene has.
fn finds_all(technique: &str, scene: &Scene) -> bool {
    Technique::parse(technique).is_ok_and(|technique| technique.misses(scene).is_none())
}

impl<'a> Run<'a> {
    pub(super) fn new(
        gpu: &'a Gpu,
        case: &'static str,
        backend: Backend,
        effort: Effort,
        folder: Option<&Path>,
    ) -> Self {
        let folder = folder.map(Path::to_owned);
        Self { gpu, backend, case, effort, folder, figures: Vec::new(), files: Vec::new(), dropped: (0, String::new()) }
    }

    pub(super) fn finish(mut self) -> (Vec<Figure>, Vec<String>) {
        if self.dropped.0 > 0 {
            let figure = Figure::at_most("", "samples that are not finite", self.dropped.0 as f64, 0.0);
            self.figures.push(figure.worst(self.dropped.1));
        }
        (self.figures, self.files)
    }

    /// The first of two, or the second where little time is to be spent.
    pub(super) fn pick<T>(&self, full: T, short: T) -> T {
        if self.is_short() { short } else { full }
    }

    /// Samples per pixel of what holds estimators: half as many on other backends than `bvh`, for they differ in how rays are met alone,
    /// and what that loses is no matter of noise.
    pub(super) fn samples(&self, full: u32, short: u32) -> u32 {
        self.pick(if self.backend == Backend::Bvh { full } else { full / 2 }, short)
    }

    /// Whether little time is to be spent.
    pub(super) fn is_short(&self) -> bool {
        self.effort == Effort::Short
    }

    /// Whether there is time for all.
    pub(super) fn is_long(&self) -> bool {
        self.effort == Effort::Long
    }

    /// Takes a figure in.
    pub(super) fn note(&mut self, figure: Figure) {
        self.figures.push(figure);
    }

    /// Takes a figure in that the driver's own ray queries may push beyond its bound.
    pub(super) fn note_of_driver(&mut self, figure: Figure) {
        let driver = &self.gpu.survey().driver;
        self.figures.push(if self.backend == Backend::RayQuery { figure.by_driver(driver) } else { figure });
    }

    /// Settings for a technique on this backend, by the scene's film.
    pub(super) fn settings(&self, scene: &Scene, technique: &str) -> Result<Settings> {
        Ok(Settings { expected_samples: 0, ..Settings::new(scene, Technique::parse(technique)?, self.backend) })
    }

    /// Renders with so many samples, as `lumbre render` would; keeps the image and counts samples that are not finite.
    pub(super) fn render(&mut self, scene: &Scene, settings: &Settings, spp: u32) -> Result<Film> {
        let film = self.film(scene, settings, spp)?;
        if let Some(bad) = film.bad_samples.first() {
            let place =
                format!("{}, pixel ({}, {}), sample {}", settings.technique.describe(), bad.x, bad.y, bad.sample);
            if self.dropped.0 == 0 {
                self.dropped.1 = place;
            }
            self.dropped.0 += film.nonfinite;
        }
        Ok(film)
    }

    /// Renders with so many samples and keeps the image; samples that are not finite are the caller's to judge.
    pub(super) fn film(&mut self, scene: &Scene, settings: &Settings, spp: u32) -> Result<Film> {
        let samples = u64::from(settings.width) * u64::from(settings.height) * u64::from(spp);
        let expected_samples = samples.max(settings.expected_samples);
        let mut renderer = Renderer::new(self.gpu, scene, &Settings { expected_samples, ..settings.clone() })?;
        while renderer.advance(spp)? {}
        let film = renderer.film()?;
        if let Some(folder) = &self.folder {
            let technique = settings.technique.describe().replace([':', '='], "-");
            let (case, backend, count) = (self.case, self.backend.name(), self.files.len());
            let file = folder.join(format!("{case}-{backend}-{count:03}-{technique}.exr"));
            let header = vec![(String::from("settings"), format!("{technique} on {backend}, {spp} samples per pixel"))];
            write_picture(&file, &Picture { image: film.mean(), layers: Vec::new(), header })?;
            self.files.push(file.display().to_string());
        }
        Ok(film)
    }

    /// The kernel `shaders/kernels/test/<name>.glsl` for a scene.
    pub(super) fn probe(&self, scene: &Scene, name: &str) -> Result<Probe> {
        Probe::new(self.gpu, scene, &self.settings(scene, "path")?, &format!("test/{name}"))
    }

    /// Unbiased techniques of independent pixels that this backend is to show; in the short form `path`, and in the furnace `bdpt`. The
    /// furnace is every technique's; besides it, contributions of light subpaths need no second backend, for they trace by the same functions,
    /// and `path-recursive` is `path` to the last bit (tests/recursion.rs).
    pub(super) fn unbiased(&self) -> Vec<&'static TechniqueRow> {
        let (of_furnace, on_bvh) = (self.case == "furnace", self.backend == Backend::Bvh);
        let short = |row: &TechniqueRow| row.name == "path" || row.name == "bdpt" && on_bvh && of_furnace;
        let full =
            |row: &TechniqueRow| of_furnace || row.name != "path-recursive" && (on_bvh || row.is_unidirectional());
        let fits = |row: &&TechniqueRow| if self.is_short() { short(row) } else { full(row) };
        let independent = |row: &&TechniqueRow| row.bias == Bias::Unbiased && row.correlated == Correlated::Nothing;
        TECHNIQUES.iter().filter(independent).filter(fits).collect()
    }

    /// Of those, the ones that find all there is in a scene of which the camera sees a tiny part. Light tracing would, but next to
    /// none of its paths come there.
    pub(super) fn thorough(&self, scene: &Scene) -> Vec<&'static str> {
        let rows = self.unbiased().into_iter();
        rows.filter(|row| row.solves == Solves::Everything && !row.is_light_tracing())
            .map(|row| row.name)
            .filter(|name| finds_all(name, scene))
            .collect()
    }

    /// What else finds all there is, in the long form: light tracing, where many pixels see its light or its lights aim, and what blurs by a
    /// radius, `vcm` also by merges alone. One backend is enough.
    pub(super) fn and_from_lights(&self, scene: &Scene) -> Vec<&'static str> {
        let asked = self.is_long() && self.backend == Backend::Bvh;
        let rows = TECHNIQUES.iter().filter(|row| asked && (row.is_light_tracing() || row.merges()));
        let merges = asked.then_some("vcm:form=bpm");
        rows.map(|row| row.name).chain(merges).filter(|name| finds_all(name, scene)).collect()
    }

    /// Holds a film's mean against a value: within 0.1 % or three standard deviations of the estimate, whichever is more. An estimate
    /// that could not see 1 % fails.
    pub(super) fn mean(&mut self, technique: &str, what: &str, film: &Film, channel: usize, expected: f64) {
        self.mean_within(technique, what, film, channel, expected, 1e-3);
    }

    /// Holds a film's mean against a value: within this share or three standard deviations of the estimate, whichever is more.
    pub(super) fn mean_within(
        &mut self,
        technique: &str,
        what: &str,
        film: &Film,
        channel: usize,
        expected: f64,
        share: f64,
    ) {
        let estimate = average(film)[channel];
        self.estimate(technique, what, estimate, expected, share, oddest_pixel(film, channel));
    }

    /// Holds any estimate against a value: within this share or three of its standard deviations, whichever is more.
    pub(super) fn estimate(
        &mut self,
        technique: &str,
        what: &str,
        found: Estimate,
        expected: f64,
        share: f64,
        worst: String,
    ) {
        self.note(comparison::mean(technique, what, found, expected, share, worst));
    }

    /// Holds two films of the same scene against each other: the largest z of all tiles and channels at the 1 % level of all together
    /// (Sidak), and that of the whole image.
    pub(super) fn same(&mut self, technique: &str, what: &str, a: &Film, b: &Film, tile: u32) {
        comparison::same_mean(technique, what, a, b, tile, sidak(1e-3, 3))
            .into_iter()
            .for_each(|figure| self.note(figure));
    }
}
