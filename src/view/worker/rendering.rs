//! A rendering that is looked at while it goes on.

use std::time::{Duration, Instant};

use crate::error::Result;
use crate::gpu::Gpu;
use crate::image::Image;
use crate::image::metrics::pixels::squared_errors;
use crate::render::{Renderer, Settings, Technique, Watch};
use crate::scene::{Camera, Scene};
use crate::techniques::AovSettings;
use crate::trace::{Subpath, Trace, trace_brightest};
use crate::view::layer::Layer;
use crate::view::news::{Picture, Traced};
use crate::view::wanted::{Asked, Layers, Wanted};

/// The least time between two pictures: 30 of them a second.
const LEAST_INTERVAL: Duration = Duration::from_millis(33);
/// Time between two pictures, in times that making one takes: so that most of the time goes into samples.
const INTERVAL_SHARE: u32 = 4;
/// Time after which a picture is shown some of whose pixels have no sample yet.
const PATIENCE: Duration = Duration::from_millis(500);
/// Time after which the camera moves on where there is no such picture.
const LONG_PATIENCE: Duration = Duration::from_secs(2);
/// Samples of which the brightest is looked for where all pixels have to be rendered for one.
const MOST_OF_ALL_PIXELS: u32 = 64;
/// Time over which the samples per second are averaged.
const RATE_TIME: f64 = 1.0;

/// What is wanted, then what the scene's file asks for, then the defaults.
pub(super) fn settings(wanted: &Wanted, scene: &Scene, gpu: &Gpu) -> Result<Settings> {
    let mut overrides = wanted.choice.overrides.clone();
    let technique = Technique::of_scene(scene, overrides.technique()?)?;
    // Another technique may have been chosen since, which does not offer the sampler.
    overrides.sampler = overrides.sampler.filter(|own| technique.row.samplers().iter().any(|row| row.sampler == *own));
    let mut settings = overrides.settle(scene, gpu)?;
    match wanted.choice.layers {
        Layers::Nothing => {}
        Layers::Lengths(most) => settings.lengths = most,
        Layers::Strategies(most) => settings.show_strategies(scene, most)?,
    }
    // Whoever looks waits for the first picture: what makes kernels faster and takes longer to compile is left out.
    settings.expected_samples = 0;
    settings.aovs = wanted.choice.has_aovs.then_some(AovSettings { through_specular: false });
    Ok(settings)
}

/// The index of the camera that is looked through.
fn camera_index(scene: &Scene, wanted: &Wanted) -> Result<usize> {
    let camera = scene.camera(wanted.choice.overrides.camera.as_deref())?;
    Ok(scene.cameras.iter().position(|own| std::ptr::eq(own, camera)).unwrap_or(0))
}

/// The camera of the scene's file that is looked through, before it is moved.
pub(super) fn camera_of_file(scene: &Scene, wanted: &Wanted) -> Result<Camera> {
    Ok(scene.cameras[camera_index(scene, wanted)?].clone())
}

/// Where the vertices of each subpath are seen in the image, in pixels.
fn places(scene: &Scene, settings: &Settings, traced: &Trace) -> Vec<Vec<Option<[f32; 2]>>> {
    let Ok(plane) = settings.image_plane(scene) else { return Vec::new() };
    let place = |position: [f64; 3]| {
        plane.project(glam::DVec3::from(position) - scene.origin).map(|place| place.map(|pixels| pixels as f32))
    };
    let of_subpath = |subpath: &Subpath| {
        let begins = if subpath.from_light { place(subpath.beginning.position) } else { None };
        std::iter::once(begins).chain(subpath.vertices.iter().map(|vertex| place(vertex.position))).collect()
    };
    traced.subpaths.iter().map(of_subpath).collect()
}

/// A renderer, and when its next picture is due.
pub(super) struct Rendering {
    renderer: Renderer,
    /// How often shaders had been taken from their files when its kernels were made.
    pub shaders: u64,
    /// What it is seen from.
    pub camera_number: u64,
    /// That camera.
    camera: Camera,
    /// The camera of the file, and its index.
    of_file: (usize, Camera),
    /// When the samples began.
    began: Instant,
    shown: Option<Shown>,
    /// What it showed.
    last: Option<Image>,
    rate: Rate,
}

/// The last picture.
struct Shown {
    at: Instant,
    took: Duration,
    samples: f64,
    layer: Layer,
}

/// Samples per second, of late.
#[derive(Default)]
struct Rate {
    since: Option<(Instant, f64)>,
    known: f64,
}

impl Rate {
    /// Takes note of the samples by now.
    fn update(&mut self, samples: f64) -> f64 {
        let (at, before) = *self.since.get_or_insert((Instant::now(), samples));
        let seconds = at.elapsed().as_secs_f64();
        if self.known == 0.0 || seconds > RATE_TIME {
            self.known = if seconds > 0.0 { (samples - before) / seconds } else { 0.0 };
        }
        if seconds > RATE_TIME {
            self.since = Some((Instant::now(), samples));
        }
        self.known
    }
}

impl Rendering {
    pub fn new(gpu: &Gpu, scene: &mut Scene, settings: Settings, wanted: &Wanted, watch: Watch) -> Result<Self> {
        let index = camera_index(scene, wanted)?;
        let of_file = scene.cameras[index].clone();
        scene.cameras[index] = wanted.camera.clone().unwrap_or_else(|| of_file.clone());
        let renderer = Renderer::watched(gpu, scene, &settings, watch);
        // Whoever asks next finds the scene as its file has it.
        scene.cameras[index] = of_file.clone();
        Ok(Self {
            renderer: renderer?,
            shaders: 0,
            camera_number: wanted.camera_number,
            camera: wanted.camera.clone().unwrap_or_else(|| of_file.clone()),
            of_file: (index, of_file),
            began: Instant::now(),
            shown: None,
            last: None,
            rate: Rate::default(),
        })
    }

    /// Whether there was something to see of where it stands: else nothing would be seen of a way along which pictures take their time.
    pub fn may_look(&self) -> bool {
        let patience = if self.shows_parts() { PATIENCE } else { LONG_PATIENCE };
        self.shown.is_some() || self.began.elapsed() > patience
    }

    /// Whether there is something to see before every pixel has a sample: not where light comes to pixels from all over the image.
    fn shows_parts(&self) -> bool {
        self.renderer.settings().technique.row.is_unidirectional()
    }

    /// Looks through the camera that is wanted now. Where that is of another kind, it does not: the kernels are to be made anew.
    pub fn look(&mut self, scene: &mut Scene, wanted: &Wanted) -> Result<bool> {
        let (index, of_file) = &self.of_file;
        let camera = wanted.camera.as_ref().unwrap_or(of_file);
        let kind = |camera: &Camera| camera.image_plane(1, 1).kind;
        if kind(camera) != kind(of_file) {
            return Ok(false);
        }
        scene.cameras[*index] = camera.clone();
        let looked = self.renderer.look(scene);
        scene.cameras[*index] = of_file.clone();
        looked?;
        self.camera = camera.clone();
        self.camera_number = wanted.camera_number;
        self.began = Instant::now();
        self.shown = None;
        self.rate.since = None;
        Ok(true)
    }

    /// What happened in the brightest sample of a pixel so far.
    pub fn trace(&self, gpu: &Gpu, scene: &mut Scene, asked: Asked) -> Traced {
        let settings = self.renderer.settings();
        let [x, y] = asked.pixel;
        let (index, of_file) = &self.of_file;
        scene.cameras[*index] = self.camera.clone();
        let samples = self.renderer.spp().max(1);
        let most = if self.shows_parts() { samples } else { samples.min(MOST_OF_ALL_PIXELS) };
        let traced = trace_brightest(gpu, scene, settings, x, y, most);
        let places = traced.as_ref().map_or(Vec::new(), |traced| places(scene, settings, traced));
        scene.cameras[*index] = of_file.clone();
        let trace = traced.map_err(|error| error.to_string());
        Traced { number: asked.number, camera_number: self.camera_number, trace, places }
    }

    /// The names of the technique and of the backend.
    pub fn names(&self) -> [&'static str; 2] {
        let settings = self.renderer.settings();
        [settings.technique.row.name, settings.backend.name()]
    }

    /// Takes the next samples, unless it rests; whether it does.
    pub fn advance(&mut self, wanted: &Wanted) -> Result<bool> {
        let target = wanted.spp.unwrap_or(u32::MAX);
        // What is at rest is shown all the same.
        if wanted.is_paused && self.renderer.has_image() {
            self.rate = Rate::default();
            return Ok(true);
        }
        Ok(!self.renderer.advance(target)?)
    }

    /// A picture, where one is due: of what is new, and at once where it rests.
    pub fn picture(&mut self, wanted: &Wanted, reference: Option<&Image>, rests: bool) -> Result<Option<Picture>> {
        let samples = self.renderer.progress();
        let is_due = match &self.shown {
            None => self.renderer.has_image() || self.shows_parts() && self.began.elapsed() > PATIENCE,
            Some(shown) if shown.layer != wanted.layer => true,
            Some(shown) if shown.samples == samples => false,
            Some(shown) => rests || shown.at.elapsed() > LEAST_INTERVAL.max(shown.took * INTERVAL_SHARE),
        };
        if !is_due {
            return Ok(None);
        }
        let started = Instant::now();
        let film = self.renderer.film()?;
        let is_of_file = wanted.camera.is_none();
        let reference = reference.filter(|own| is_of_file && (own.width, own.height) == (film.width, film.height));
        let mut image = wanted.layer.of(&film, &self.renderer, reference)?;
        if let Some(last) = self.last.as_ref().filter(|own| own.pixels.len() == image.pixels.len() && film.spp() == 0) {
            // Pixels without a sample show what was there before.
            let pairs = image.pixels.iter_mut().zip(&last.pixels).zip(&film.counts);
            pairs.filter(|(_, count)| **count == 0).for_each(|((pixel, before), _)| *pixel = *before);
        }
        self.last = Some(image.clone());
        let error = reference.map(|reference| {
            let errors = squared_errors(&film.mean(), reference);
            errors.iter().filter(|error| error.is_finite()).sum::<f64>() / errors.len().max(1) as f64
        });
        let pixels = f64::from(film.width) * f64::from(film.height);
        let settings = self.renderer.settings();
        let picture = Picture {
            image,
            layer: wanted.layer,
            scene_number: wanted.scene_number,
            made_by: format!("{} on {}", settings.technique.describe(), settings.backend.name()),
            shaders: self.shaders,
            camera_number: self.camera_number,
            spp: samples,
            seconds: self.renderer.seconds().render,
            rate: self.rate.update(samples * pixels),
            estimate: film.error_estimate(),
            error,
            nonfinite: film.nonfinite,
        };
        self.shown = Some(Shown { at: Instant::now(), took: started.elapsed(), samples, layer: wanted.layer });
        Ok(Some(picture))
    }
}
