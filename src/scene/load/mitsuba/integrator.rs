//! `<integrator>`: the technique that a scene asks for; the command line goes before it.

use super::loader::Loader;
use super::object::Object;
use crate::error::Result;

const SUPPORTED: [&str; 7] = ["path", "direct", "volpath", "volpathmis", "ptracer", "moment", "aov"];

impl Loader {
    pub(super) fn set_integrator(&mut self, object: &Object) -> Result<()> {
        match object.plugin.as_str() {
            // Wrappers that add channels of their own: the technique is the one inside.
            "moment" | "aov" => {
                object.optional_text("aovs")?;
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
