//! The arguments of `lumbre render`.

use std::path::PathBuf;

use clap::Args;

use lumbre::scene::{Camera, Scene};
use lumbre::techniques::LONGEST;

use super::super::args::{DeviceArgs, SceneArgs, parse_positive};
use super::super::settings::SettingsArgs;
use super::{keep, tev};

/// Samples per pixel where neither the command line nor the scene says.
const DEFAULT_SPP: u32 = 64;

#[derive(Args)]
pub(in super::super) struct RenderArgs {
    #[command(flatten)]
    pub(super) scene: SceneArgs,

    #[command(flatten)]
    pub(super) settings: SettingsArgs,

    /// Output: .exr (linear, 32-bit float) or .png (sRGB); may repeat. '-' is an EXR to standard output. By default both, named after the scene
    #[arg(short = 'o', long, value_name = "FILE")]
    pub(super) output: Vec<PathBuf>,

    /// Samples per pixel
    #[arg(short = 'n', long, value_name = "SPP", value_parser = clap::value_parser!(u32).range(1..), allow_negative_numbers = true)]
    pub(super) spp: Option<u32>,

    /// Render for this long instead, and until each pixel has a sample
    #[arg(short = 't', long, value_name = "SECONDS", conflicts_with = "spp", value_parser = parse_positive, allow_negative_numbers = true)]
    pub(super) time: Option<f64>,

    /// Stop once the estimate of the relMSE, from the variance of the samples, is no more than this; with -n or -t at the latest there
    #[arg(short = 'e', long, value_name = "RELMSE", value_parser = parse_positive, allow_negative_numbers = true)]
    pub(super) error: Option<f64>,

    /// Write one EXR layer per path length, whose sum is the image; N layers, the last of which takes all longer paths
    #[arg(long, value_name = "N", num_args = 0..=1, default_missing_value = "0", require_equals = true,
          value_parser = clap::value_parser!(u32).range(0..=64))]
    pub(super) lengths: Option<u32>,

    /// Write the contribution of each strategy (s, t) of bidirectional path tracing, unweighted and weighted, for paths of up to N segments (6 at
    /// most), which is where paths end then: EXR layers, and as PNG a pyramid of them
    #[arg(long, value_name = "N", num_args = 0..=1, default_missing_value = "6", require_equals = true, conflicts_with = "lengths",
          value_parser = clap::value_parser!(u32).range(1..=i64::from(LONGEST)))]
    pub(super) strategies: Option<u32>,

    /// Further EXR layers, separated by commas: variance (of each pixel's mean), samples, or AOVs (docs/aovs.md): albedo, normal,
    /// geometric_normal, position, depth, uv, material_id, object_id, emission, or all of these. By default those that the scene asks for
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    pub(super) aov: Vec<String>,

    /// Let AOVs tell what mirrors and smooth glass show, rather than these themselves
    #[arg(long)]
    pub(super) aov_through_specular: bool,

    /// Name the N brightest samples: pixel, sample, value, and the command that tells what happened to their paths. It costs some speed
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = clap::value_parser!(u32).range(0..=10_000), hide_default_value = true,
          conflicts_with_all = ["strategies", "shard", "resume"])]
    pub(super) fireflies: u32,

    /// Write what one frame does to this folder: passes, barriers, buffers, timestamps, as JSON and as a picture. Rendering begins after that, and
    /// has of -t what is left then
    #[arg(long, value_name = "DIR", conflicts_with = "resume")]
    pub(super) record: Option<PathBuf>,

    /// Denoise the image by Open Image Denoise, where its library is installed, with its albedo and normals; the layer `noisy` of an EXR is
    /// the image as it was. For techniques whose noise is independent from pixel to pixel
    #[arg(long, conflicts_with_all = ["lengths", "strategies", "shard"])]
    pub(super) denoise: bool,

    /// Render a share of the samples, to be put together by `lumbre merge`: shard K of N (1/8 to 8/8), of the -n samples per pixel of all of them,
    /// in blocks of 64. Writes images only where -o asks for them
    #[arg(long, value_name = "K/N", value_parser = parse_shard, conflicts_with_all = ["time", "error"])]
    pub(super) shard: Option<(u32, u32)>,

    /// Write the figures as JSON ('-' is standard output)
    #[arg(long, value_name = "FILE")]
    pub(super) json: Option<PathBuf>,

    /// Show the picture in progress in the viewer tev that listens there; localhost:14158 by its default
    #[arg(long, value_name = "HOST:PORT", value_parser = tev::parse)]
    pub(super) tev: Option<String>,

    /// Keep the rendering in this file, so that --resume can go on if it ends before its time; the one before it is FILE.previous
    #[arg(long, value_name = "FILE")]
    pub(super) checkpoint: Option<PathBuf>,

    /// Seconds between two checkpoints
    #[arg(long, value_name = "SECONDS", default_value_t = keep::INTERVAL, requires = "checkpoint", value_parser = parse_positive, allow_negative_numbers = true)]
    pub(super) checkpoint_interval: f64,

    /// Go on from the checkpoint, to the same bits as if nothing had happened; begin anew where there is none yet
    #[arg(long, requires = "checkpoint")]
    pub(super) resume: bool,

    /// Compile everything there is into the kernel instead of what the scene needs: the same bits, to see what that buys
    #[arg(long)]
    pub(super) no_specialise: bool,

    /// Leave it to the driver to cut kernels down to what the scene needs: the same bits, to see what doing so beforehand buys
    #[arg(long)]
    pub(super) driver_specialises: bool,

    /// Have the driver compute as the shaders are written, without regrouping sums and products: the last bits then follow their text alone, which
    /// is how benches/same_bits.py compares two versions
    #[arg(long, conflicts_with = "driver_specialises")]
    pub(super) exact_arithmetic: bool,

    #[command(flatten)]
    pub(super) device: DeviceArgs,

    /// Print nothing but errors
    #[arg(short, long)]
    pub(super) quiet: bool,
}

fn parse_shard(text: &str) -> Result<(u32, u32), String> {
    let numbers = text.split_once('/').and_then(|(number, of)| Some((number.parse().ok()?, of.parse().ok()?)));
    numbers
        .filter(|(number, of)| (1..=*of).contains(number))
        .ok_or_else(|| String::from("it must be K/N with K from 1 to N"))
}

impl RenderArgs {
    /// Samples per pixel that end the rendering, where time and error do not.
    pub(super) fn asked_spp(&self, scene: &Scene, camera: &Camera) -> u32 {
        self.spp.or(scene.spp_of(camera)).unwrap_or(DEFAULT_SPP)
    }

    /// Pixel samples that the rendering will come to: none where it is over at once, no end of them where that is not known.
    pub(super) fn expected_samples(&self, scene: &Scene, camera: &Camera) -> u64 {
        match (self.time, self.error) {
            (Some(seconds), _) if seconds < 2.0 => 0,
            (Some(_), _) | (None, Some(_)) => u64::MAX,
            (None, None) => {
                let film = scene.film_of(camera);
                let (width, height) = self.settings.size.unwrap_or((film.width, film.height));
                u64::from(width) * u64::from(height) * u64::from(self.asked_spp(scene, camera))
            }
        }
    }
}
