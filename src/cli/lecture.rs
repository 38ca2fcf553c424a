//! `lumbre lecture`: one page with every comparison of a lecture on global illumination, measured here.

use std::path::PathBuf;
use std::sync::atomic::Ordering;
use std::time::SystemTime;

use clap::Args;

use lumbre::error::{Error, Result};
use lumbre::files::{check_folder_name, check_writable};
use lumbre::lecture::{Circumstances, Lab, Place, Scale, choose, write};

use super::args::DeviceArgs;
use super::host;
use super::interrupt::listen_for_interrupts;
use super::output::{print, say};

#[derive(Args)]
pub(super) struct LectureArgs {
    /// Folder for index.html and what the commands write. The same command goes on where it was interrupted
    #[arg(short = 'o', long, value_name = "DIR", default_value = "out/lecture")]
    output: PathBuf,

    /// Only this chapter; may repeat
    #[arg(long, value_name = "CHAPTER")]
    only: Vec<String>,

    /// Run every command again
    #[arg(long)]
    fresh: bool,

    /// Folder of the scenes
    #[arg(long, value_name = "DIR", default_value = "scenes")]
    scenes: PathBuf,

    /// Sides of all pictures times this
    #[arg(long, value_name = "FACTOR", default_value_t = 1.0, value_parser = parse_scale)]
    scale: f64,

    /// Hardly any samples: to see whether all of it works
    #[arg(long, hide = true)]
    quick: bool,

    /// Ray backend: auto, ray-query or bvh
    #[arg(long, value_name = "NAME", default_value = "auto")]
    backend: String,

    #[command(flatten)]
    device: DeviceArgs,

    /// Print nothing but errors
    #[arg(short, long)]
    quiet: bool,
}

/// What of the full work the test of all chapters does.
const QUICK: f64 = 0.002;

fn parse_scale(text: &str) -> Result<f64, String> {
    let number = text.parse::<f64>().ok().filter(|number| (0.05..=20.0).contains(number));
    number.ok_or_else(|| String::from("it must be a number from 0.05 to 20"))
}

pub(super) fn run(args: &LectureArgs) -> Result<()> {
    let interrupted = listen_for_interrupts();
    let chapters = choose(&args.only)?;
    if !args.scenes.is_dir() {
        let folder = args.scenes.display();
        return Err(Error::Usage(format!("there is no folder {folder}: --scenes says where lumbre's scenes are")));
    }
    check_folder_name(&args.output)?;
    std::fs::create_dir_all(&args.output).map_err(|error| Error::write(&args.output, error))?;
    check_writable(&args.output.join("index.html")).map_err(|error| Error::write(&args.output, error))?;
    let (device, device_id) = {
        let gpu = args.device.open()?;
        gpu.backend(Some(&args.backend))?;
        let device = host::device(&gpu);
        let id = format!("{} {}", device.name, device.driver);
        (device, id)
    };
    let runs = args.output.join("runs");
    if args.fresh && runs.exists() {
        std::fs::remove_dir_all(&runs).map_err(|error| Error::write(&runs, error))?;
    }
    let say = |text: &str| {
        if !args.quiet {
            say!("{text}");
        }
    };
    let place = Place {
        program: std::env::current_exe()
            .map_err(|error| Error::Device(format!("cannot find lumbre itself: {error}")))?,
        folder: args.output.clone(),
        scenes: args.scenes.display().to_string(),
        options: options(args),
        device: device_id,
        scale: Scale { side: args.scale, work: if args.quick { QUICK } else { 1.0 } },
        interrupted: &|| interrupted.load(Ordering::Relaxed),
        say: &say,
    };
    let circumstances = Circumstances {
        version: env!("CARGO_PKG_VERSION").to_owned(),
        command: host::command_line(),
        made: humantime::format_rfc3339_seconds(SystemTime::now()).to_string().replace('T', " ").replace('Z', " UTC"),
        device,
    };
    let mut lab = Lab::new(place)?;
    write(&chapters, &mut lab, &circumstances)?;
    if !args.quiet {
        print(&format!("wrote {}", lab.page().display()));
    }
    Ok(())
}

/// What every rendering gets of this command's options.
fn options(args: &LectureArgs) -> Vec<String> {
    let mut options = Vec::new();
    if let Some(device) = &args.device.device {
        options.extend(["--device".into(), device.clone()]);
    }
    if args.backend != "auto" {
        options.extend(["--backend".into(), args.backend.clone()]);
    }
    if args.device.validate {
        options.push("--validate".into());
    }
    options
}
