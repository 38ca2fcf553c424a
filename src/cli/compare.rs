//! `lumbre compare`: how far an image is from a reference.

use std::path::PathBuf;

use clap::Args;
use serde::Serialize;

use lumbre::error::Result;
use lumbre::files::check_writable;
use lumbre::image::metrics::{Comparison, compare, heat_map, heat_scale, same_size};
use lumbre::image::{Format, Picture, check_format, read_image, write_picture};
use lumbre::reference::{Certificate, Truth, read, read_certificate};

use super::output::{check_apart, check_json, print, write_json};

#[derive(Args)]
pub(super) struct CompareArgs {
    /// Image, EXR or PNG
    image: PathBuf,

    /// What it should be
    reference: PathBuf,

    /// Write a picture of the relative difference: red where the image is too bright, blue where too dark
    #[arg(long, value_name = "FILE")]
    heatmap: Option<PathBuf>,

    /// Write the figures as JSON ('-' is standard output)
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

/// The figures, with what the reference says of itself.
#[derive(Serialize)]
struct Compared {
    #[serde(flatten)]
    compared: Comparison,
    #[serde(skip_serializing_if = "Option::is_none")]
    reference: Option<Known>,
}

/// What is known of a reference that has a certificate.
#[derive(Serialize)]
struct Known {
    /// The relMSE without what the reference's own noise adds to it.
    relmse_less_noise: f64,
    /// Why it is not confirmed.
    doubt: Option<String>,
    certificate: Certificate,
}

impl Known {
    fn of(truth: &Truth, compared: &Comparison) -> Option<Self> {
        let certificate = truth.certificate.clone()?;
        let relmse_less_noise = compared.relmse - truth.relmse().unwrap_or(0.0);
        Some(Self { relmse_less_noise, doubt: certificate.doubt(), certificate })
    }
}

pub(super) fn run(args: &CompareArgs) -> Result<()> {
    if let Some(path) = &args.heatmap {
        check_format(path, "a heat map", Format::Png)?;
        check_writable(path)?;
    }
    check_json(args.json.as_deref())?;
    check_apart(args.heatmap.iter().chain(&args.json).map(PathBuf::as_path))?;
    let (image, reference) = (read_image(&args.image)?, read_image(&args.reference)?);
    same_size(&image, &reference)?;
    let compared = compare(&image, &reference)?;
    let known = match read_certificate(&args.reference)? {
        Some(_) => Known::of(&read(&args.reference, reference.width, reference.height)?, &compared),
        None => None,
    };
    let found = Compared { compared, reference: known };
    if let Some(path) = &args.heatmap {
        let scale = heat_scale(&image, &reference);
        let map = heat_map(&image, &reference, scale);
        write_picture(path, &Picture { image: map, layers: Vec::new(), header: Vec::new() })?;
        if args.json.is_none() {
            print(&format!("heat map      full colour is a relative difference of {scale:.4}"));
        }
    }
    if let Some(path) = &args.json {
        return write_json(path, &found);
    }
    let Compared { compared: found, reference: known } = found;
    print(&format!("mse           {:.6e}", found.mse));
    print(&format!("rmse          {:.6e}", found.rmse));
    print(&format!("relmse        {:.6e}", found.relmse));
    print(&format!("mape          {:.6e}", found.mape));
    print(&format!("flip          {:.6}", found.flip));
    print(&format!("energy ratio  {:.6}", found.energy_ratio));
    print(&format!("max abs       {:.6e}", found.max_abs));
    print(&format!("nonfinite     {}", found.nonfinite));
    if let Some(known) = known {
        let less = known.relmse_less_noise;
        print(&format!("reference     by {}, {}", known.certificate.makers(), known.certificate.error_in_words()));
        print(&format!("relmse        {less:.6e} without the reference's own noise"));
        if let Some(doubt) = known.doubt {
            print(&format!("warning       the reference is not confirmed: {doubt}"));
        }
    }
    Ok(())
}
