//! `<shape>`: geometry, what it is made of, and what it emits.

use std::path::PathBuf;
use std::rc::Rc;

use glam::{DAffine3, DMat3, DVec3};

use super::loader::{Loader, Sides};
use super::object::Object;
use crate::error::{Error, Result};
use crate::scene::load::limits::SHAPES;
use crate::scene::load::{obj, ply, serialized};
use crate::scene::{Mesh, SurfaceDescription, material};

const SUPPORTED: [&str; 11] =
    ["obj", "ply", "serialized", "rectangle", "disk", "cube", "cylinder", "sphere", "shapegroup", "instance", "merge"];

impl Loader {
    /// Adds a shape to a group.
    pub(super) fn add_shape(&mut self, object: &Rc<Object>, group: usize) -> Result<()> {
        self.shapes += 1;
        if self.shapes > SHAPES {
            let message =
                format!("the scene has more than {SHAPES} shapes by here, those of merged shapes counted each time");
            return Err(object.error(message));
        }
        match object.plugin.as_str() {
            "shapegroup" => return self.shape_group(object).map(|_| ()),
            // Its shapes stay what they are: how they are stored changes no image.
            "merge" => {
                for shape in object.objects_of("shape") {
                    self.add_shape(&shape, group)?;
                    self.builder.within_limits()?;
                }
                return object.finish();
            }
            "instance" => return self.add_instance(object),
            _ => {}
        }
        let to_world = object.transform("to_world")?;
        let flip = object.boolean("flip_normals", false)?;
        let name = object.id.clone().unwrap_or_else(|| object.plugin.clone());
        object.optional_float("silhouette_sampling_weight")?; // of derivatives, which are not computed
        let surface = self.surface(object)?;
        match object.plugin.as_str() {
            "sphere" => {
                let radius = object.positive_float("radius", 1.0)?;
                let centre = object.optional_vector("center")?.unwrap_or(DVec3::ZERO);
                let lengths = [
                    to_world.matrix3.x_axis.length(),
                    to_world.matrix3.y_axis.length(),
                    to_world.matrix3.z_axis.length(),
                ];
                let spread = lengths.iter().fold(0.0f64, |most, length| most.max((length / lengths[0] - 1.0).abs()));
                let [x, y, z] =
                    [to_world.matrix3.x_axis, to_world.matrix3.y_axis, to_world.matrix3.z_axis].map(DVec3::normalize);
                if spread > 1e-4 || x.dot(y).abs().max(x.dot(z).abs()).max(y.dot(z).abs()) > 1e-4 {
                    return Err(object.property_error(
                        "to_world",
                        "it makes the sphere an ellipsoid: only uniform scaling is supported",
                    ));
                }
                let turned = flip != (to_world.matrix3.determinant() < 0.0);
                let radius = radius * lengths[0] * if turned { -1.0 } else { 1.0 };
                let axes = DMat3::from_cols(x, y, z);
                self.builder.oriented_sphere(group, &name, to_world.transform_point3(centre), radius, axes, surface);
            }
            kind @ ("rectangle" | "disk") => {
                // The normal follows the inverse transpose, whatever the map does to the winding.
                let mirrored = to_world.matrix3.determinant() < 0.0;
                let mesh = if kind == "disk" { Mesh::disk() } else { Mesh::rectangle() };
                self.builder.mesh(group, &name, mesh.turned(flip != mirrored), to_world, surface);
            }
            "cylinder" => {
                let radius = object.positive_float("radius", 1.0)?;
                let start = object.optional_vector("p0")?.unwrap_or(DVec3::ZERO);
                let along = object.optional_vector("p1")?.unwrap_or(DVec3::Z) - start;
                let place = cylinder_place(start, along, radius).ok_or_else(|| {
                    object.property_error("p1", "it is the same point as 'p0': the cylinder has no length")
                })?;
                let to_world = to_world * place;
                self.builder.mesh(group, &name, Mesh::cylinder().turned(flip), to_world, surface);
            }
            "cube" => {
                let mirrored = to_world.matrix3.determinant() < 0.0;
                self.builder.mesh(group, &name, Mesh::cube().turned(flip != mirrored), to_world, surface);
            }
            "obj" | "ply" | "serialized" => {
                let (file, mesh) = read_mesh(object, &self.builder.attributes)?;
                self.builder.mesh(group, &file.display().to_string(), mesh.turned(flip), to_world, surface);
            }
            _ => return Err(object.unknown_plugin(&SUPPORTED)),
        }
        object.finish()
    }

    /// The surface of a shape: its BSDF and its area light.
    fn surface(&mut self, object: &Object) -> Result<usize> {
        let emission = match object.object_of("emitter")? {
            None => None,
            Some(emitter) if emitter.plugin == "area" => Some(self.radiance(&emitter)?),
            // A beam along the normal, which no path from the camera finds: Mitsuba's `path` shows nothing of it either.
            Some(emitter) if emitter.plugin == "directionalarea" => {
                self.radiance(&emitter)?;
                self.builder
                    .warnings
                    .push(format!("{}: its beam is left out, as Mitsuba's path tracers leave it out", emitter.title()));
                Some(([0.0; 3], None))
            }
            Some(emitter) => {
                return Err(emitter.error(format!("a shape can only hold an area light, not {}", emitter.title())));
            }
        };
        let sides = match object.object_of("bsdf")? {
            Some(bsdf) => self.material(&bsdf)?,
            // Mitsuba's defaults: grey, or black where the shape is a light.
            None if emission.is_some() => Sides::default(),
            None => Sides { front: Some(self.builder.material(material::diffuse([0.5; 3]))), ..Sides::default() },
        };
        let sides = if emission.is_some() { self.emitting(sides) } else { sides };
        self.builder.has_area_light |= emission.is_some();
        let (emission, emission_texture) = emission.unwrap_or_default();
        Ok(self.builder.surface(SurfaceDescription {
            front: sides.front,
            back: sides.back,
            emission,
            emission_texture,
            mask: sides.mask,
            ..SurfaceDescription::default()
        }))
    }

    /// The group that a `shapegroup` stands for.
    fn shape_group(&mut self, object: &Rc<Object>) -> Result<usize> {
        if let Some(made) = self.groups.get(&Rc::as_ptr(object)) {
            return Ok(*made);
        }
        let group = self.builder.group(object.id.as_deref().unwrap_or("shapegroup"));
        self.groups.insert(Rc::as_ptr(object), group);
        for shape in object.objects_of("shape") {
            if matches!(shape.plugin.as_str(), "shapegroup" | "instance") {
                return Err(shape.error(format!("{} cannot be inside a shapegroup", shape.title())));
            }
            self.add_shape(&shape, group)?;
            self.builder.within_limits()?;
        }
        object.finish()?;
        Ok(group)
    }

    fn add_instance(&mut self, object: &Object) -> Result<()> {
        let to_world = object.transform("to_world")?;
        let Some(shape) = object.object_of("shape")?.filter(|shape| shape.plugin == "shapegroup") else {
            return Err(object.error("an instance needs a <ref> to a shapegroup"));
        };
        let group = self.shape_group(&shape)?;
        self.builder.instance(group, to_world);
        object.finish()
    }
}

/// Where the unit cylinder goes that begins at a point and runs along a vector; nothing where that has no length.
fn cylinder_place(start: DVec3, along: DVec3, radius: f64) -> Option<DAffine3> {
    // Texture coordinates begin at the first axis of the frame of Duff et al. 2017, here as in Mitsuba.
    let (x, y) = along.try_normalize()?.any_orthonormal_pair();
    Some(DAffine3::from_mat3_translation(DMat3::from_cols(radius * x, radius * y, along), start))
}

/// The mesh that a shape names, and its file. It has vertex normals, from the file or computed, unless `face_normals` says
/// otherwise.
fn read_mesh(object: &Object, attributes: &[String]) -> Result<(PathBuf, Mesh)> {
    let file = object.file("filename")?;
    let read = match object.plugin.as_str() {
        // OBJ files count v upwards, and images are stored from the top.
        "obj" => {
            object.boolean("flip_tex_coords", true).and_then(|flip| Ok(obj::read_geometry(&file)?.with_flipped_v(flip)))
        }
        "ply" => object
            .boolean("flip_tex_coords", false)
            .and_then(|flip| Ok(ply::read(&file, attributes)?.with_flipped_v(flip))),
        _ => serialized::read(&file, shape_index(object)?),
    };
    let mut mesh = read.map_err(|error| match error {
        Error::File { cause, .. } => {
            object.property_error("filename", format!("cannot read {}: {cause}", file.display()))
        }
        other => other,
    })?;
    if object.boolean("face_normals", false)? {
        mesh.normals = Vec::new();
    } else if mesh.normals.is_empty() {
        mesh.compute_normals();
    }
    Ok((file, mesh))
}

/// Which mesh of a file that holds several, counted from 0.
fn shape_index(object: &Object) -> Result<u32> {
    let index = object.optional_integer("shape_index")?.unwrap_or(0);
    u32::try_from(index).map_err(|_| object.property_error("shape_index", format!("{index} is not 0 or more")))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use glam::Vec2;

    use super::*;
    use crate::scene::load::mitsuba::{document, parse};

    /// Points on cylinders from the origin and the first texture coordinate that Mitsuba 3.9 reports for them.
    #[test]
    fn cylinders_begin_where_mitsuba_s_do() {
        let cases = [
            ([0.0, 0.0, 1.0], [-0.857493, 0.514496, 0.25], 0.413990),
            ([0.0, 0.0, -2.0], [0.857493, -0.514496, -0.5], 0.086010),
            ([1.0, 0.0, 0.0], [0.25, -0.813734, 0.581238], 0.651284),
            ([0.0, -1.0, 0.0], [-0.919145, -0.25, 0.393919], 0.435559),
            ([1.0, 2.0, 3.0], [-0.158248, 1.316497, 0.341752], 0.306517),
        ];
        for (along, point, expected) in cases {
            let place = cylinder_place(DVec3::ZERO, DVec3::from(along), 1.0).unwrap();
            let local = place.inverse().transform_point3(DVec3::from(point));
            let turns = (local.y.atan2(local.x) / std::f64::consts::TAU).rem_euclid(1.0);
            assert!((turns - expected).abs() < 2e-6 && (local.z - 0.25).abs() < 1e-6, "{along:?}: {turns}, {local}");
        }
        assert_eq!(cylinder_place(DVec3::ONE, DVec3::ZERO, 1.0), None);
    }

    /// Mitsuba flips the texture coordinates of OBJ files, unless told otherwise, and those of PLY files only if told so.
    #[test]
    fn texture_coordinates_flip_as_in_mitsuba() {
        let folder = tempfile::tempdir().unwrap();
        let obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0.25 0.125\nvt 0.5 0\nvt 0 1\nf 1/1 2/2 3/3\n";
        let ply = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
             property float u\nproperty float v\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n\
             0 0 0 0.25 0.125\n1 0 0 0.5 0\n0 1 0 0 1\n3 0 1 2\n";
        std::fs::write(folder.path().join("mesh.obj"), obj).unwrap();
        std::fs::write(folder.path().join("mesh.ply"), ply).unwrap();
        let path = folder.path().join("scene.xml");
        let (as_given, flipped) = (Vec2::new(0.25, 0.125), Vec2::new(0.25, 0.875));
        for (kind, option, expected) in [
            ("obj", None, flipped),
            ("obj", Some(true), flipped),
            ("obj", Some(false), as_given),
            ("ply", None, as_given),
            ("ply", Some(true), flipped),
            ("ply", Some(false), as_given),
        ] {
            let option =
                option.map_or(String::new(), |on| format!(r#"<boolean name="flip_tex_coords" value="{on}"/>"#));
            let shape =
                format!(r#"<shape type="{kind}"><string name="filename" value="mesh.{kind}"/>{option}</shape>"#);
            std::fs::write(&path, format!(r#"<scene version="3.0.0">{shape}</scene>"#)).unwrap();
            let scene = parse::parse(&document::read(&path, &[]).unwrap()).unwrap();
            let (_, mesh) = read_mesh(&scene.objects()[0], &[]).unwrap();
            assert_eq!(mesh.uvs[0], expected, "{shape}");
        }
    }
}
