//! What the tests share: devices with validation on, and statistics that print what they found.

pub mod alone;
pub mod clock;
pub mod gltf;
pub mod hostile;
pub mod mutation;
pub mod program;
pub mod room;
pub mod sampling;
pub mod seeds;
pub mod truth;
#[cfg(feature = "view")]
pub mod xdnd;

use std::path::{Path, PathBuf};
use std::sync::{Condvar, Mutex, PoisonError};

use lumbre::error::Error;
use lumbre::gpu::{Gpu, Instance};
use lumbre::layout::backend::{BACKENDS, Backend};
use lumbre::render::film::Film;
use lumbre::render::{Renderer, Settings, Technique};
use lumbre::scene::{LoadOptions, Scene};
use lumbre::statistics::Estimate;
pub use lumbre::verify::comparison::{LargestZ, average, largest_off, largest_z, tile_average};
use lumbre::verify::{Effort, Figure, Verdict, comparison};

/// The devices that no test has at the moment, and how many there are in all.
struct Pool {
    free: Vec<Gpu>,
    made: usize,
}

static POOL: Mutex<Pool> = Mutex::new(Pool { free: Vec::new(), made: 0 });
static GIVEN_BACK: Condvar = Condvar::new();

/// A device that goes back to the pool, unless the test that has it fails: nobody knows what it left behind there.
struct Borrowed(Option<Gpu>);

impl Borrowed {
    /// Waits for a device: there are as many as cores, since a CPU device compiles on one of them, each with an instance of its own, so
    /// that the validation layer's messages are those of one test.
    fn take() -> Self {
        let most = std::thread::available_parallelism().map_or(1, usize::from);
        let mut pool = POOL.lock().unwrap_or_else(PoisonError::into_inner);
        while pool.free.is_empty() && pool.made >= most {
            pool = GIVEN_BACK.wait(pool).unwrap_or_else(PoisonError::into_inner);
        }
        match pool.free.pop() {
            Some(gpu) => Self(Some(gpu)),
            None => {
                pool.made += 1;
                drop(pool);
                // Counted off again by this where it cannot be opened.
                let mut opened = Self(None);
                opened.0 = Some(open_gpu().expect("a Vulkan device"));
                opened
            }
        }
    }
}

impl Drop for Borrowed {
    fn drop(&mut self) {
        let gpu = self.0.take().filter(|_| !std::thread::panicking());
        let mut pool = POOL.lock().unwrap_or_else(PoisonError::into_inner);
        match gpu {
            Some(gpu) => pool.free.push(gpu),
            None => pool.made -= 1,
        }
        GIVEN_BACK.notify_one();
    }
}

/// Runs a test on a device that it has for itself, and fails it if the validation layer had anything to say.
pub fn with_gpu<T>(run: impl FnOnce(&Gpu) -> T) -> T {
    clock::start();
    let borrowed = Borrowed::take();
    let gpu = borrowed.0.as_ref().unwrap();
    let before = gpu.take_validation_messages();
    assert!(before.is_empty(), "validation messages from before this test: {before:#?}");
    let result = run(gpu);
    let messages = gpu.take_validation_messages();
    assert!(messages.is_empty(), "Vulkan validation: {messages:#?}");
    result
}

/// `LUMBRE_TEST_DEVICE` chooses the device, `LUMBRE_TEST_VALIDATE=0` runs without the validation layer (on machines that
/// have none).
pub fn open_gpu() -> lumbre::error::Result<Gpu> {
    let validate = std::env::var("LUMBRE_TEST_VALIDATE").as_deref() != Ok("0");
    Gpu::open(&Instance::new(validate)?, std::env::var("LUMBRE_TEST_DEVICE").ok().as_deref())
}

/// Fails where the validation layer had anything to say.
pub fn check_gpu(gpu: &Gpu) -> lumbre::error::Result<()> {
    gpu.take_validation_messages().into_iter().next().map_or(Ok(()), |message| Err(Error::Validation(message)))
}

/// Whether there is time for everything (`make thorough`): on two slow cores that is more than two hours, most of which the driver spends on kernels.
pub fn has_time() -> bool {
    std::env::var_os("LUMBRE_TEST_THOROUGH").is_some()
}

/// Every backend where there is time, else `bvh`: for what each technique does alike through either, which tests/agreement.rs and the short
/// forms of `lumbre verify` (tests/verify.rs) hold it to every time.
pub fn backends_in_time(gpu: &Gpu) -> Vec<Backend> {
    if has_time() { backends(gpu) } else { vec![Backend::Bvh] }
}

/// Rows of `lumbre verify` in their full form, and in their long one where there is time: prints each figure, and fails with those beyond their bounds.
pub fn verify(names: &[&str]) {
    let mut broken = Vec::new();
    let effort = if has_time() { Effort::Long } else { Effort::Full };
    with_gpu(|gpu| {
        let backends = backends_in_time(gpu);
        for case in names.iter().map(|name| lumbre::verify::find(name).unwrap()) {
            for backend in lumbre::verify::measured_on(case, &backends) {
                let outcome = lumbre::verify::measure(gpu, case, backend, effort, None).unwrap();
                for figure in outcome.figures {
                    let line = format!("{} on {}: {figure:?}", case.name, backend.name());
                    println!("{line}");
                    if figure.verdict == Verdict::Fail {
                        broken.push(line);
                    }
                }
            }
        }
    });
    assert!(broken.is_empty(), "{}", broken.join("\n"));
}

/// Every backend that the device has. On a machine that is to have both (`LUMBRE_TEST_BACKENDS=all`), a missing one fails.
pub fn backends(gpu: &Gpu) -> Vec<Backend> {
    let all: Vec<Backend> = BACKENDS.iter().map(|row| row.backend).collect();
    let (there, refused): (Vec<_>, Vec<_>) =
        all.into_iter().partition(|backend| gpu.survey().refusal(*backend).is_none());
    for backend in refused {
        let why = gpu.survey().refusal(backend).unwrap_or_default();
        assert!(std::env::var("LUMBRE_TEST_BACKENDS").as_deref() != Ok("all"), "{}: {why}", backend.name());
        eprintln!("not tested: {}: {why}", backend.name());
    }
    there
}

/// A file in `scenes/`.
pub fn scene_path(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(name)
}

/// A scene of the canon with parameters.
pub fn canon(name: &str, defines: &[(&str, &str)]) -> Scene {
    let defines = defines.iter().map(|(name, value)| ((*name).to_owned(), (*value).to_owned())).collect();
    lumbre::scene::load(&scene_path(name), &LoadOptions { defines, ..LoadOptions::default() })
        .expect("a scene of the canon")
}

/// Settings for a technique on a backend, by the scene's own film.
pub fn settings(scene: &Scene, technique: &str, backend: Backend) -> Settings {
    Settings::new(scene, Technique::parse(technique).expect("a technique"), backend)
}

/// Renders, and checks that no sample was dropped.
pub fn render(gpu: &Gpu, scene: &Scene, settings: &Settings, spp: u32) -> Film {
    let film = lumbre::render::render(gpu, scene, settings, spp).expect("a rendering");
    let name = settings.technique.describe();
    assert_eq!(film.nonfinite, 0, "{name} on {}: {:?}", settings.backend.name(), film.bad_samples);
    film
}

/// The films of so many seeds from that of the settings on, all by the same kernels; no sample was dropped.
pub fn films(gpu: &Gpu, scene: &Scene, settings: &Settings, seeds: u32, spp: u32) -> Vec<Film> {
    let mut renderer = Renderer::new(gpu, scene, settings).unwrap();
    let film = |seed| {
        renderer.restart(seed).unwrap();
        while renderer.advance(spp).unwrap() {}
        let film = renderer.film().unwrap();
        assert_eq!(film.nonfinite, 0, "{:?}", film.bad_samples);
        film
    };
    (settings.seed..settings.seed + seeds).map(film).collect()
}

/// Prints a figure, and fails unless it is within its bound.
pub fn assert_within(figure: &Figure) {
    println!("{figure:?}");
    assert!(figure.verdict == Verdict::Pass, "{figure:?}");
}

/// Fails unless the measured mean is within 0.1 % of the expected value or three standard deviations, whichever is more.
/// The measurement must be able to see 1 %.
pub fn assert_mean(what: &str, measured: Estimate, expected: f64) {
    assert_within(&comparison::mean(what, "mean", measured, expected, 1e-3, ""));
}

/// Compares two films of the same scene tile by tile: a z-test of each tile and channel, Sidak-corrected, and one of the
/// whole image, three channels, each at a third of the 0.1 % level.
pub fn assert_same_mean(what: &str, a: &Film, b: &Film, tile: u32) {
    comparison::same_mean(what, "mean", a, b, tile, 1e-3 / 3.0).iter().for_each(assert_within);
}

/// Fails unless a film's mean is within this share of another one's, in each channel that has light.
pub fn assert_off(what: &str, found: &Film, truth: &Film, bound: f64) {
    let off = largest_off(found, truth, 0..found.width, 0..found.height);
    assert_within(&Figure::at_most(what, "mean off", off.abs(), bound));
}

/// A film of two samples per pixel whose means are these, with these variances of them.
pub fn film_of(width: u32, height: u32, pixels: &[[Estimate; 3]]) -> Film {
    let all = |value: fn(&Estimate) -> f64| pixels.iter().map(|pixel| pixel.each_ref().map(value)).collect();
    Film {
        width,
        height,
        counts: vec![2; pixels.len()],
        sums: all(|of| 2.0 * of.mean),
        squares: all(|of| 2.0 * (of.mean * of.mean + of.variance)),
        ..Film::default()
    }
}

/// Writes files to a folder of their own and loads the first one.
pub fn load_files(files: &[(&str, &str)]) -> lumbre::Result<Scene> {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in files {
        std::fs::write(folder.path().join(name), text).unwrap();
    }
    lumbre::scene::load(&folder.path().join(files[0].0), &lumbre::scene::LoadOptions::default())
}
