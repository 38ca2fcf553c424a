//! What tests of random choices share: uniform numbers from the device, and findings that are all
//! reported before a test fails.

use lumbre::gpu::Gpu;
use lumbre::layout::RandomQuery;
use lumbre::layout::backend::Backend;
use lumbre::render::{Probe, Settings};
use lumbre::scene::Scene;
use lumbre::scene::material::{self, MaterialDescription};
use lumbre::techniques::Sampler;

#[allow(unused_imports)]
pub use lumbre::verify::sampling::{Rings, chi_square_z, direction, spread};

use super::settings;

/// What `shaders/kernels/test/random.glsl` writes: the four numbers, then the maps of the first two.
pub type Mapped = [f32; 14];

pub fn random(gpu: &Gpu, queries: &[RandomQuery]) -> Vec<Mapped> {
    random_from(gpu, Sampler::Independent, queries)
}

/// Random numbers at the queries' coordinates, from a sampler.
pub fn random_from(gpu: &Gpu, sampler: Sampler, queries: &[RandomQuery]) -> Vec<Mapped> {
    let scene = with_materials(&[material::diffuse([0.5; 3]).into()]);
    let settings = Settings { sampler, ..settings(&scene, "path", Backend::Bvh) };
    Probe::new(gpu, &scene, &settings, "test/random").unwrap().run(queries).unwrap()
}

/// A scene that uses these materials, so that none is left out of the kernel.
pub fn with_materials(materials: &[MaterialDescription]) -> Scene {
    lumbre::verify::scattering::scene_with(materials).unwrap()
}

/// Uniform numbers, four to a query.
pub fn numbers(gpu: &Gpu, count: usize, seed: u32) -> Vec<[f32; 4]> {
    let queries: Vec<_> =
        (0..count as u32).map(|pixel| RandomQuery { pixel, sample_index: 0, dimension: 0, seed }).collect();
    random(gpu, &queries).iter().map(|row| [row[0], row[1], row[2], row[3]]).collect()
}

/// What a test has found wrong: it looks at every case before it fails.
#[derive(Default)]
pub struct Findings(Vec<String>);

impl Findings {
    /// Notes what is wrong unless `right`.
    pub fn check(&mut self, right: bool, wrong: impl FnOnce() -> String) {
        if !right {
            self.0.push(wrong());
        }
    }
}

impl Drop for Findings {
    fn drop(&mut self) {
        if !std::thread::panicking() && !self.0.is_empty() {
            let shown: Vec<_> = self.0.iter().take(60).map(String::as_str).collect();
            panic!("{} findings:\n{}", self.0.len(), shown.join("\n"));
        }
    }
}
