//! `<sensor>`, with its `<film>`, `<rfilter>` and `<sampler>`.

use super::loader::Loader;
use super::object::Object;
use crate::error::{Result, one_of};
use crate::scene::FilmSettings;
use crate::scene::camera::{Camera, FovAxis, Projection, WHOLE};
use crate::scene::filter::Filter;
use crate::scene::single;

const AXES: [(&str, FovAxis); 5] = [
    ("x", FovAxis::X),
    ("y", FovAxis::Y),
    ("diagonal", FovAxis::Diagonal),
    ("smaller", FovAxis::Smaller),
    ("larger", FovAxis::Larger),
];

/// Samplers differ in how they spread their points; all that is taken from one is the number of samples.
const SAMPLERS: [&str; 5] = ["independent", "stratified", "multijitter", "orthogonal", "ldsampler"];

impl Loader {
    pub(super) fn add_sensor(&mut self, object: &Object) -> Result<()> {
        let to_world = object.transform("to_world")?;
        let (projection, (fov, axis)) = match object.plugin.as_str() {
            "perspective" => (Projection::Pinhole, field_of_view(object)?),
            "thinlens" => {
                let radius = object
                    .optional_float("aperture_radius")?
                    .ok_or_else(|| object.error("a thinlens needs 'aperture_radius'"))?;
                if radius < 0.0 {
                    return Err(object.property_error("aperture_radius", format!("{radius} is negative")));
                }
                let focus = object.positive_float("focus_distance", object.positive_float("far_clip", 1e4)?)?;
                (Projection::ThinLens { radius, focus }, field_of_view(object)?)
            }
            "orthographic" => (Projection::Orthographic, (45.0, FovAxis::X)),
            _ => return Err(object.unknown_plugin(&["perspective", "thinlens", "orthographic"])),
        };
        // Clipping hides geometry from the camera; a scene that relies on it would look wrong silently.
        let (near, far) = (object.positive_float("near_clip", 1e-2)?, object.positive_float("far_clip", 1e4)?);
        if near >= far {
            return Err(object.property_error("near_clip", format!("{near} is not below far_clip ({far})")));
        }
        for ignored in ["focus_distance", "shutter_open", "shutter_close"] {
            object.optional_float(ignored)?; // of lenses, and of motion, which other sensors and scenes do not have
        }
        if object.has("srf") {
            object.ignore("srf");
            self.builder
                .warnings
                .push(format!("{}: its sensor response 'srf' is left out: images are linear sRGB", object.title()));
        }
        let principal_point =
            [object.float("principal_point_offset_x", 0.0)?, object.float("principal_point_offset_y", 0.0)?];
        let name = object.id.clone().unwrap_or_else(|| format!("camera{}", self.builder.cameras.len()));
        let (film, window) = match object.object_of("film")? {
            Some(film) => read_film(&film)?,
            None => (FilmSettings { width: 768, height: 576, filter: Filter::GAUSSIAN }, WHOLE),
        };
        let mut camera = Camera { principal_point, projection, window, ..Camera::new(&name, to_world, fov, axis) };
        if let Some(sampler) = object.object_of("sampler")? {
            if !SAMPLERS.contains(&sampler.plugin.as_str()) {
                return Err(sampler.unknown_plugin(&SAMPLERS));
            }
            let count = sampler.optional_integer("sample_count")?.unwrap_or(4);
            for ignored in ["seed", "strength"] {
                sampler.optional_integer(ignored)?;
            }
            sampler.boolean("jitter", true)?;
            let spp = u32::try_from(count).ok().filter(|count| *count > 0);
            camera.spp =
                Some(spp.ok_or_else(|| sampler.property_error("sample_count", format!("{count} is not 1 or more")))?);
            sampler.finish()?;
        }
        if self.builder.cameras.is_empty() {
            (self.builder.film, self.builder.technique.spp) = (film, camera.spp.take());
        } else {
            camera.film = Some(film);
        }
        self.builder.cameras.push(camera);
        object.finish()
    }
}

/// The image of a `<film>`, and the part of the whole image that it is.
fn read_film(film: &Object) -> Result<(FilmSettings, [f64; 4])> {
    if film.plugin != "hdrfilm" {
        return Err(film.unknown_plugin(&["hdrfilm"]));
    }
    let mut window = WHOLE;
    let size = |name: &'static str, default: i64| {
        let value = film.optional_integer(name)?.unwrap_or(default);
        u32::try_from(value)
            .ok()
            .filter(|value| (1..=65536).contains(value))
            .ok_or_else(|| film.property_error(name, format!("{value} is not in 1 to 65536")))
    };
    let (mut width, mut height) = (size("width", 768)?, size("height", 576)?);
    if ["crop_offset_x", "crop_offset_y", "crop_width", "crop_height"].iter().any(|name| film.has(name)) {
        let (whole_width, whole_height) = (width, height);
        let offset = |name: &'static str| -> Result<u32> {
            let value = film.optional_integer(name)?.unwrap_or(0);
            u32::try_from(value).map_err(|_| film.property_error(name, format!("{value} is negative")))
        };
        let (left, top) = (offset("crop_offset_x")?, offset("crop_offset_y")?);
        (width, height) = (size("crop_width", i64::from(width))?, size("crop_height", i64::from(height))?);
        if u64::from(left) + u64::from(width) > u64::from(whole_width)
            || u64::from(top) + u64::from(height) > u64::from(whole_height)
        {
            return Err(film.error(format!(
                    "the crop of {width} x {height} pixels at ({left}, {top}) does not fit into {whole_width} x {whole_height}"
                )));
        }
        let share = |part: u32, whole: u32| f64::from(part) / f64::from(whole);
        window = [
            share(left, whole_width),
            share(top, whole_height),
            share(width, whole_width),
            share(height, whole_height),
        ];
    }
    for ignored in ["file_format", "pixel_format", "component_format"] {
        film.optional_text(ignored)?; // what is written is the command line's business
    }
    for ignored in ["sample_border", "compensate", "banner"] {
        film.boolean(ignored, false)?; // pixels are sampled one by one, with sums that lose nothing
    }
    let filter = match film.object_of("rfilter")? {
        Some(filter) => read_filter(&filter)?,
        None => Filter::GAUSSIAN,
    };
    film.finish()?;
    Ok((FilmSettings { width, height, filter }, window))
}

pub(super) fn field_of_view(object: &Object) -> Result<(f64, FovAxis)> {
    let axis = object.optional_text("fov_axis")?;
    let focal_length = object.optional_text("focal_length")?;
    if let Some(fov) = object.optional_float("fov")? {
        if focal_length.is_some() {
            return Err(object.error("a camera has 'fov' or 'focal_length', not both"));
        }
        if !(fov > 0.0 && fov < 180.0) {
            return Err(object.property_error("fov", format!("{fov} is not between 0 and 180 degrees")));
        }
        let name = axis.unwrap_or("x");
        let axis = AXES.iter().find(|(known, _)| *known == name).map(|(_, axis)| *axis);
        return Ok((
            fov,
            axis.ok_or_else(|| {
                object.property_error("fov_axis", format!("'{name}' is not {}", one_of(AXES.map(|row| row.0))))
            })?,
        ));
    }
    // A focal length is of the 36 x 24 mm format, whose diagonal the image's diagonal stands for.
    let text = focal_length.unwrap_or("50mm");
    let millimetres = text.trim().trim_end_matches("mm").trim().parse::<f64>().ok();
    let millimetres = millimetres.filter(|length| *length > 0.0 && single::fits(*length));
    let millimetres = millimetres
        .ok_or_else(|| object.property_error("focal_length", format!("'{text}' is not a length such as 50mm")))?;
    Ok((2.0 * (36f64.hypot(24.0) / (2.0 * millimetres)).atan().to_degrees(), FovAxis::Diagonal))
}

fn read_filter(object: &Object) -> Result<Filter> {
    let third = 1.0 / 3.0;
    let filter = match object.plugin.as_str() {
        "box" => Filter::Box,
        "tent" => Filter::Tent { radius: object.positive_float("radius", 1.0)? },
        "gaussian" => {
            let stddev = object.positive_float("stddev", 0.5)?;
            let radius = 4.0 * stddev;
            single::check([radius])
                .map_err(|message| object.property_error("stddev", format!("4 times it: {message}")))?;
            Filter::Gaussian { stddev, radius }
        }
        "mitchell" => Filter::Mitchell { b: object.float("B", third)?, c: object.float("C", third)? },
        "catmullrom" => Filter::Mitchell { b: 0.0, c: 0.5 },
        "lanczos" => {
            let lobes = object.optional_integer("lobes")?.unwrap_or(3);
            let lobes = u32::try_from(lobes).ok().filter(|lobes| (1..=16).contains(lobes));
            Filter::Lanczos { lobes: lobes.ok_or_else(|| object.property_error("lobes", "it must be 1 to 16"))? }
        }
        _ => return Err(object.unknown_plugin(&["box", "tent", "gaussian", "mitchell", "catmullrom", "lanczos"])),
    };
    object.finish()?;
    Ok(filter)
}
