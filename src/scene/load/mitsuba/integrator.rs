//! `<integrator>`: the technique that a scene asks for; the command line goes before it.

use super::loader::Loader;
use super::object::Object;
use crate::error::{Result, one_of};

const SUPPORTED: [&str; 7] = ["path", "direct", "volpath", "volpathmis", "ptracer", "moment", "aov"];

/// The AOVs of Mitsuba, and what `--aov` calls them.
const AOVS: [(&str, &str); 7] = [
    ("albedo", "albedo"),
    ("depth", "depth"),
    ("position", "position"),
    ("uv", "uv"),
    ("geo_normal", "geometric_normal"),
    ("sh_normal", "normal"),
    ("shape_index", "object_id"),
];

/// The most bytes of a layer's name: with its channel it must fit into the header of an EXR file.
const NAME_BYTES: usize = 200;

/// The layer and the AOV of `NAME:TYPE`.
fn aov(text: &str) -> Result<(String, &'static str), String> {
    let (name, kind) = text.split_once(':').ok_or_else(|| format!("'{text}' is not NAME:TYPE"))?;
    if name.is_empty() || name.len() > NAME_BYTES {
        return Err(format!("the name of a layer has {} bytes: valid are 1 to {NAME_BYTES}", name.len()));
    }
    let found = AOVS.iter().find(|(known, _)| *known == kind);
    let (_, aov) = found.ok_or_else(|| {
        format!("the AOV type '{kind}' of '{name}' is not read: valid are {}", one_of(AOVS.map(|(known, _)| known)))
    })?;
    Ok((name.to_owned(), aov))
}

impl Loader {
    pub(super) fn set_integrator(&mut self, object: &Object) -> Result<()> {
        match object.plugin.as_str() {
            // Wrappers that add channels of their own: the technique is the one inside.
            "moment" | "aov" => {
                if let Some(list) = object.optional_text("aovs")? {
                    let tokens = list.split(',').map(str::trim).filter(|token| !token.is_empty());
                    for token in tokens.collect::<Vec<_>>() {
                        let aov = aov(token).map_err(|message| object.property_error("aovs", message))?;
                        self.builder.technique.aovs.push(aov);
                    }
                }
                if let Some(inner) = object.object_of("integrator")? {
                    self.set_integrator(&inner)?;
                }
            }
            "path" | "volpath" | "volpathmis" | "ptracer" => {
                let depth = object.optional_integer("max_depth")?.unwrap_or(-1);
                self.builder.technique.max_depth = Some(match depth {
                    -1 => None,
                    0.. => Some(u32::try_from(depth).unwrap_or(u32::MAX - 1)),
                    _ => {
                        return Err(
                            object.property_error("max_depth", format!("{depth} is not 0 or more, nor -1 (no limit)"))
                        );
                    }
                });
                if let Some(depth) = object.optional_integer("rr_depth")? {
                    let depth = u32::try_from(depth).ok().filter(|depth| *depth > 0);
                    let depth = depth.ok_or_else(|| object.property_error("rr_depth", "it must be 1 or more"))?;
                    self.builder.technique.rr_depth = Some(depth);
                }
                self.hide_emitters(object)?;
                object.optional_integer("samples_per_pass")?; // how the work is cut changes no image
                // Without media the volumetric ones are `path`.
                let name = if object.plugin == "ptracer" { "light" } else { "path" };
                self.builder.technique.integrator = Some((String::from(name), Vec::new()));
            }
            "direct" => {
                for count in ["shading_samples", "emitter_samples", "bsdf_samples"] {
                    object.optional_integer(count)?; // one sample of each, and MIS, whatever the file asks for
                }
                self.hide_emitters(object)?;
                self.builder.technique.integrator = Some((String::from("direct"), Vec::new()));
            }
            // An error only where the command line names no technique.
            _ => {
                self.builder.technique.refused = Some(object.unknown_plugin(&SUPPORTED).to_string());
                return Ok(());
            }
        }
        object.finish()
    }

    fn hide_emitters(&mut self, object: &Object) -> Result<()> {
        self.builder.technique.hide_emitters = object.boolean("hide_emitters", false)?;
        Ok(())
    }
}
