//! The triangles and the rays that are measured as a file, so that other ray tracers can be measured with the same.

use std::path::Path;

use super::sets::RayKind;
use crate::error::{Error, Result};
use crate::files::replace_file;
use crate::layout::RayRecord;
use crate::scene::{Needs, Scene};

/// Writes the scene's triangles and sets of rays: a line `lumbre-rays-1`, a line `triangles N`, for each set a line with its kind, how
/// many rays it has, and `closest` or `any`, and a line `end`; then numbers of 32 bits, low byte first: nine coordinates for each
/// triangle, seven numbers for each ray (origin, direction, greatest distance). Scenes with spheres or with instances are an error.
pub fn export(scene: &Scene, kinds: &[(RayKind, Vec<RayRecord>)], path: &Path) -> Result<()> {
    let refused = |what: &str| {
        Err(Error::Usage(format!(
            "{}: rays are written for scenes of triangles alone; this one has {what}",
            scene.source.display()
        )))
    };
    let needs = Needs::of(scene);
    if needs.spheres {
        return refused("spheres");
    }
    if needs.instances {
        return refused("instances");
    }
    let mut head = format!("lumbre-rays-1\ntriangles {}\n", scene.primitives.len());
    for (kind, rays) in kinds {
        let wants = if *kind == RayKind::Shadow { "any" } else { "closest" };
        head += &format!("{} {} {wants}\n", kind.name(), rays.len());
    }
    head += "end\n";
    replace_file(path, |out| {
        let mut write = |bytes: &[u8]| out.write_all(bytes).map_err(|error| error.to_string());
        write(head.as_bytes())?;
        for triangle in &scene.primitives {
            write(bytemuck::cast_slice(&[triangle.v0, triangle.v1, triangle.v2]))?;
        }
        for (_, rays) in kinds {
            write(bytemuck::cast_slice(rays))?;
        }
        Ok(())
    })
}
