//! The thread that renders: it brings about what is wanted, and tells what there is to see.

mod rendering;
mod shared;

use std::sync::{Arc, Weak};
use std::thread::JoinHandle;
use std::time::Duration;

use crate::error::{Error, Result};
use crate::gpu::{Gpu, Instance};
use crate::image::{Image, read_image};
use crate::scene::{Scene, load};

use super::news::{Doing, Facts, News};
use super::reload::Reloader;
use super::wanted::{Choice, Wanted};
use rendering::Rendering;
use shared::Shared;

/// How often in a row a device may be lost, without a picture in between, before that is the end of it.
const MOST_LOSSES: u32 = 5;
/// How often the files of shaders are looked at.
const SHADER_INTERVAL: Duration = Duration::from_millis(250);
/// Seconds to wait before a lost device is opened again, times the losses in a row.
const LOSS_PAUSE: f64 = 0.2;

/// A thread that renders. It ends when this is dropped.
pub struct Worker {
    shared: Arc<Shared>,
    thread: Option<JoinHandle<Vec<String>>>,
}

impl Worker {
    /// Starts it on what is wanted. `wake` is called, on the worker's thread, when there is news.
    pub fn start(instance: Instance, wanted: Wanted, wake: impl Fn() + Send + Sync + 'static) -> Result<Self> {
        let reloader = wanted.shaders.as_deref().map(Reloader::new).transpose()?;
        let shared = Arc::new(Shared::new(wanted, Box::new(wake)));
        if let Some(reloader) = &reloader {
            watch_shaders(reloader.clone(), Arc::downgrade(&shared))?;
        }
        let hands = Hands {
            shared: shared.clone(),
            instance,
            losses: 0,
            messages: Vec::new(),
            answered: 0,
            reloader,
            reloaded: (0, [""; 2]),
            taken: 0,
        };
        let thread = std::thread::Builder::new()
            .name(String::from("worker"))
            .spawn(move || hands.work())
            .map_err(|error| Error::Device(format!("no thread to render with: {error}")))?;
        Ok(Self { shared, thread: Some(thread) })
    }

    /// Wants something else from now on.
    pub fn want(&self, wanted: Wanted) {
        self.shared.want(wanted);
    }

    /// What it has told so far.
    pub fn news(&self) -> News {
        self.shared.news()
    }

    /// What went wrong before there was any picture; once.
    pub fn take_fatal(&self) -> Option<Error> {
        self.shared.take_fatal()
    }

    /// Ends it, and waits until it has; the messages of the validation layer.
    pub fn end(mut self) -> Vec<String> {
        self.shared.quit();
        self.thread.take().and_then(|thread| thread.join().ok()).unwrap_or_default()
    }
}

impl Drop for Worker {
    fn drop(&mut self) {
        self.shared.quit();
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

/// Looks whether shaders change, for as long as the worker is there.
fn watch_shaders(mut reloader: Reloader, shared: Weak<Shared>) -> Result<()> {
    let watch = move || {
        loop {
            std::thread::sleep(SHADER_INTERVAL);
            let Some(shared) = shared.upgrade() else { return };
            if reloader.has_changed() {
                shared.shaders_changed();
            }
        }
    };
    let thread = std::thread::Builder::new().name(String::from("shaders")).spawn(watch);
    thread.map(drop).map_err(|error| Error::Device(format!("no thread to watch shaders with: {error}")))
}

/// The device that was asked for.
struct Opened {
    selector: Option<String>,
    gpu: Gpu,
}

/// A scene that was read.
struct Loaded {
    number: u64,
    scene: Scene,
    reference: Option<Image>,
}

/// What the thread works with.
struct Hands {
    shared: Arc<Shared>,
    instance: Instance,
    /// Losses of the device since the last picture.
    losses: u32,
    messages: Vec<String>,
    /// The last question about a pixel that was answered.
    answered: u64,
    /// Takes shaders from their files.
    reloader: Option<Reloader>,
    /// The change of the shaders that was compiled last, and the technique and the backend that it was compiled for.
    reloaded: (u64, [&'static str; 2]),
    /// How often shaders were taken from their files.
    taken: u64,
}

/// What there is by now, the last of which needs all before it.
#[derive(Default)]
struct There {
    opened: Option<Opened>,
    loaded: Option<Loaded>,
    rendering: Option<(Choice, Rendering)>,
}

impl Hands {
    fn work(mut self) -> Vec<String> {
        let mut there = There::default();
        // What was wanted when something failed: nothing is tried again until something else is wanted.
        let mut failed = false;
        let mut may_rest = false;
        while let Some(wanted) = self.shared.next(may_rest, &mut failed) {
            may_rest = match self.go_on(&wanted, &mut there, failed) {
                Ok(rests) => rests || failed,
                Err(error @ Error::DeviceLost { .. }) if self.losses < MOST_LOSSES => {
                    self.losses += 1;
                    there.rendering = None;
                    self.close(&mut there);
                    let message = error.to_string();
                    self.shared.tell(|news| {
                        news.losses += 1;
                        news.trouble = Some(format!("{message}; it is opened again"));
                    });
                    std::thread::sleep(Duration::from_secs_f64(LOSS_PAUSE * f64::from(self.losses)));
                    false
                }
                Err(error) => {
                    there.rendering = None;
                    self.shared.fail(error, wanted.scene_number);
                    failed = true;
                    true
                }
            };
        }
        there.rendering = None;
        self.close(&mut there);
        self.messages
    }

    /// Closes the device, and takes down what the validation layer said of it.
    fn close(&mut self, there: &mut There) {
        if let Some(opened) = there.opened.take() {
            self.messages.extend(opened.gpu.take_validation_messages());
        }
    }

    /// Does the next thing; whether there is nothing more to do.
    fn go_on(&mut self, wanted: &Wanted, there: &mut There, failed: bool) -> Result<bool> {
        if there.loaded.as_ref().is_none_or(|loaded| loaded.number != wanted.scene_number) {
            if failed {
                return Ok(true);
            }
            self.shared.tell(|news| news.doing = Doing::Loading);
            let scene = load(&wanted.scene, &wanted.options)?;
            let reference = wanted.reference.as_deref().map(read_image).transpose()?;
            there.rendering = None;
            there.loaded = Some(Loaded { number: wanted.scene_number, scene, reference });
        }
        if there.opened.as_ref().is_none_or(|opened| opened.selector != wanted.device) {
            if failed {
                return Ok(true);
            }
            there.rendering = None;
            self.close(there);
            let gpu = Gpu::open(&self.instance, wanted.device.as_deref())?;
            there.opened = Some(Opened { selector: wanted.device.clone(), gpu });
        }
        let (Some(loaded), Some(opened)) = (&mut there.loaded, &there.opened) else { return Ok(true) };
        if there.rendering.as_ref().is_none_or(|(choice, _)| *choice != wanted.choice) {
            if failed {
                return Ok(true);
            }
            there.rendering = None;
            let mut made = self.begin(wanted, loaded, &opened.gpu)?;
            made.shaders = self.taken;
            there.rendering = Some((wanted.choice.clone(), made));
        }
        let Some((_, rendering)) = &mut there.rendering else { return Ok(true) };
        let (changes, [technique, backend]) = (self.shared.shader_changes(), rendering.names());
        // What is compiled is what is shown: another technique finds its modules as they were.
        let is_due = changes > 0 && self.reloaded != (changes, [technique, backend]);
        if let (Some(reloader), true) = (&self.reloader, is_due) {
            self.reloaded = (changes, [technique, backend]);
            self.shared.tell(|news| news.doing = Doing::Building("compiling shaders", None));
            match reloader.reload(technique, backend) {
                // Kernels are made of the new ones; the last picture stays meanwhile.
                Ok(()) => {
                    self.taken += 1;
                    self.shared.tell(|news| news.shader_error = None);
                    there.rendering = None;
                    return Ok(false);
                }
                Err(why) => self.shared.tell(|news| news.shader_error = Some(why)),
            }
        }
        let moves = rendering.camera_number != wanted.camera_number && rendering.may_look();
        if moves && !rendering.look(&mut loaded.scene, wanted)? {
            // Kernels for another kind of camera.
            there.rendering = None;
            return Ok(false);
        }
        let rests = rendering.advance(wanted)?;
        let doing = if rests { Doing::Resting } else { Doing::Rendering };
        if let Some(picture) = rendering.picture(wanted, loaded.reference.as_ref(), rests)? {
            self.losses = 0;
            self.shared.show(picture, doing.clone());
        }
        if let Some(asked) = wanted.asked.filter(|asked| asked.number > self.answered) {
            self.shared.tell_doing(Doing::Building("tracing the pixel", None));
            let traced = rendering.trace(&opened.gpu, &mut loaded.scene, asked);
            self.answered = asked.number;
            self.shared.tell(|news| news.traced = Some(Arc::new(traced)));
        }
        self.shared.tell_doing(doing);
        Ok(rests)
    }

    /// Makes the kernels for what is wanted.
    fn begin(&self, wanted: &Wanted, loaded: &mut Loaded, gpu: &Gpu) -> Result<Rendering> {
        let settings = rendering::settings(wanted, &loaded.scene, gpu)?;
        let devices = self.instance.devices()?.into_iter().map(|survey| survey.name).collect();
        let mut facts = facts(wanted, &loaded.scene, &settings, gpu, devices)?;
        if let Some(reference) =
            loaded.reference.as_ref().filter(|own| (own.width, own.height) != (settings.width, settings.height))
        {
            facts.warnings.push(format!(
                "the reference has {}x{} pixels and the image {}x{}: they are not compared",
                reference.width, reference.height, settings.width, settings.height
            ));
        }
        self.shared.tell(|news| news.facts = Some(Arc::new(facts)));
        let watch = |building: crate::render::Building| {
            self.shared.tell_doing(Doing::Building(building.doing, building.share));
        };
        Rendering::new(gpu, &mut loaded.scene, settings, wanted, &watch)
    }
}

/// What is to be known of a scene and of how it is rendered.
fn facts(
    wanted: &Wanted,
    scene: &Scene,
    settings: &crate::render::Settings,
    gpu: &Gpu,
    devices: Vec<String>,
) -> Result<Facts> {
    let (centre, radius) = scene.core();
    let technique = &settings.technique;
    let lacks = technique.misses(scene).map(|what| format!("{} does not find {what}", technique.row.name));
    let simplifies =
        technique.simplifies(scene).map(|what| format!("{} takes for diffuse: {what}", technique.row.name));
    Ok(Facts {
        scene_number: wanted.scene_number,
        scene: wanted.scene.clone(),
        cameras: scene.cameras.iter().map(|camera| camera.name.clone()).collect(),
        camera: rendering::camera_of_file(scene, wanted)?,
        core: (centre.as_dvec3(), f64::from(radius)),
        warnings: scene.warnings.iter().cloned().chain(lacks).chain(simplifies).collect(),
        settings: settings.clone(),
        device: gpu.survey().index,
        devices,
    })
}
