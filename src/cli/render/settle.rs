//! What the command line, the scene and the defaults come to together.

use std::path::PathBuf;

use lumbre::error::{Error, Result};
use lumbre::gpu::Gpu;
use lumbre::render::Settings;
use lumbre::scene::Scene;
use lumbre::spirv::Arithmetic;
use lumbre::techniques::{Correlated, Shard};

use super::super::output::say;
use super::args::RenderArgs;
use super::job::Job;
use super::{denoise, fireflies};

/// Layers by path length where the paths have no limit.
const DEFAULT_LENGTHS: u32 = 16;

/// What the command line, then the scene, then the defaults ask for.
pub(super) fn settle(args: &RenderArgs, scene: &Scene, gpu: &Gpu, outputs: Vec<PathBuf>) -> Result<(Settings, Job)> {
    let camera = scene.camera(args.settings.camera.as_deref())?;
    let mut settings = args.settings.overrides().settle(scene, gpu)?;
    let technique = &settings.technique;
    if args.error.is_some() && technique.row.correlated == Correlated::Samples {
        return Err(Error::Usage(format!(
            "--error with {}: its samples are correlated, so their variance does not tell the error; valid are -n and -t",
            technique.row.name
        )));
    }
    if args.denoise {
        denoise::check(technique.row)?;
    }
    settings.specialise = !args.no_specialise;
    settings.driver_specialises = args.driver_specialises;
    if args.exact_arithmetic {
        settings.arithmetic = Arithmetic::Exact;
    }
    settings.lengths = match args.lengths {
        None => 0,
        Some(0) => settings.max_depth.unwrap_or(DEFAULT_LENGTHS).clamp(1, DEFAULT_LENGTHS),
        Some(count) => count,
    };
    if let Some(most) = args.strategies {
        let before = settings.max_depth;
        settings.show_strategies(scene, most)?;
        if let Some(longest) = settings.max_depth
            && settings.max_depth != before
            && settings.technique.row.tells_strategies
            && !args.quiet
        {
            say!("note: paths end after {longest} segments, for --strategies to show all of them");
        }
    }
    let spp = match (args.time, args.error) {
        (Some(_), _) => u32::MAX,
        (None, Some(_)) => args.spp.unwrap_or(u32::MAX),
        (None, None) => args.asked_spp(scene, camera),
    };
    settings.records = if args.fireflies > 0 { fireflies::room(&settings) } else { 0 };
    settings.expected_samples = args.expected_samples(scene, camera);
    settings.shard = args.shard.map(|(number, of)| Shard::new(number, of, spp)).transpose()?;
    let spp = settings.shard.map_or(spp, Shard::count);
    Ok((settings, Job { outputs, spp, time: args.time }))
}
