//! `lumbre view`.

use std::path::PathBuf;

use clap::Args;

use lumbre::error::Result;

use super::args::{DeviceArgs, SceneArgs};
use super::settings::SettingsArgs;

#[derive(Args)]
#[cfg_attr(not(feature = "view"), allow(dead_code))]
pub(super) struct ViewArgs {
    #[command(flatten)]
    scene: SceneArgs,

    #[command(flatten)]
    settings: SettingsArgs,

    /// Samples per pixel that are enough; by default it goes on until the window is closed
    #[arg(short = 'n', long, value_name = "SPP", value_parser = clap::value_parser!(u32).range(1..), allow_negative_numbers = true)]
    spp: Option<u32>,

    /// An image that stands for the truth: the panel tells the relMSE against it, and the difference can be shown
    #[arg(long, value_name = "FILE")]
    reference: Option<PathBuf>,

    /// Take shaders from this folder whenever its files change: needs the feature hot-reload
    #[arg(long, value_name = "DIR")]
    shaders: Option<PathBuf>,

    #[command(flatten)]
    device: DeviceArgs,

    /// Say on standard output what happens: pictures, pixels that were clicked on, screenshots
    #[arg(short, long)]
    verbose: bool,
}

#[cfg(feature = "view")]
pub(super) fn run(args: &ViewArgs) -> Result<()> {
    use lumbre::error::Error;
    use lumbre::image::format_of;
    use lumbre::view::{Choice, Layer, Start, Wanted, open};

    use super::interrupt::listen_for_interrupts;
    use super::output::{print, say};

    // What is wrong with the command itself is said before there is a window.
    let overrides = args.settings.overrides();
    overrides.check()?;
    let files = [Some(&args.scene.scene), args.reference.as_ref()];
    for path in files.into_iter().flatten().filter(|path| path.as_os_str() != "-") {
        std::fs::File::open(path).map_err(|error| Error::read(path, error))?;
    }
    args.reference.as_deref().map(format_of).transpose()?;
    let wanted = Wanted {
        scene: args.scene.scene.clone(),
        options: args.scene.options(),
        scene_number: 0,
        device: args.device.device.clone(),
        choice: Choice { overrides, ..Choice::default() },
        camera: None,
        camera_number: 0,
        layer: Layer::Image,
        reference: args.reference.clone(),
        is_paused: false,
        asked: None,
        shaders: args.shaders.clone(),
        spp: args.spp,
    };
    let verbose = args.verbose;
    let messages = open(Start {
        wanted,
        validate: args.device.validate,
        interrupted: listen_for_interrupts(),
        tell: Box::new(move |line| {
            if verbose {
                print(line);
            }
        }),
    })?;
    let Some((first, rest)) = messages.split_first() else { return Ok(()) };
    rest.iter().for_each(|message| say!("validation: {message}"));
    Err(Error::Validation(first.clone()))
}

#[cfg(not(feature = "view"))]
pub(super) fn run(_: &ViewArgs) -> Result<()> {
    let message = "this lumbre was built without its window; with it: cargo build --release --features view";
    Err(lumbre::error::Error::Usage(String::from(message)))
}
