//! `<shape>`: geometry, what it is made of, and what it emits.

use std::rc::Rc;

use glam::{DAffine3, DMat3, DVec3};

use super::Loader;
use super::object::{Colour, Object};
use crate::error::Result;
use crate::scene::builder::SurfaceDescription;
use crate::scene::mesh::Mesh;
use crate::scene::{material, obj, ply};

const SUPPORTED: [&str; 9] =
    ["obj", "ply", "rectangle", "disk", "cube", "cylinder", "sphere", "shapegroup", "instance"];

impl Loader {
    /// Adds a shape to a group.
    pub(super) fn add_shape(&mut self, object: &Rc<Object>, group: usize) -> Result<()> {
        match object.plugin.as_str() {
            "shapegroup" => return self.shape_group(object).map(|_| ()),
            "instance" => return self.add_instance(object),
            _ => {}
        }
        let to_world = object.transform("to_world")?;
        let flip = object.boolean("flip_normals", false)?;
        let name = object.id.clone().unwrap_or_else(|| object.plugin.clone());
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
                self.builder.sphere(group, &name, to_world.transform_point3(centre), radius, surface);
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
                let axis = along.try_normalize().ok_or_else(|| {
                    object.property_error("p1", "it is the same point as 'p0': the cylinder has no length")
                })?;
                // Texture coordinates begin at the first axis of the frame of Duff et al. 2017, here as in Mitsuba.
                let (x, y) = axis.any_orthonormal_pair();
                let place = DMat3::from_cols(radius * x, radius * y, along);
                let to_world = to_world * DAffine3::from_mat3_translation(place, start);
                self.builder.mesh(group, &name, Mesh::cylinder().turned(flip), to_world, surface);
            }
            "cube" => {
                let mirrored = to_world.matrix3.determinant() < 0.0;
                self.builder.mesh(group, &name, Mesh::cube().turned(flip != mirrored), to_world, surface);
            }
            kind @ ("obj" | "ply") => {
                let face_normals = object.boolean("face_normals", false)?;
                // OBJ files count v upwards, and Mitsuba downwards.
                let flip_v = object.boolean("flip_tex_coords", kind == "obj")?;
                let file = object.file("filename")?;
                let read = if kind == "obj" { obj::read_geometry(&file) } else { ply::read(&file) };
                let mut mesh = read.map_err(|error| match error {
                    crate::error::Error::File { cause, .. } => {
                        object.property_error("filename", format!("cannot read {}: {cause}", file.display()))
                    }
                    other => other,
                })?;
                if face_normals {
                    mesh.normals = Vec::new();
                } else if mesh.normals.is_empty() {
                    mesh.compute_normals();
                }
                self.builder.mesh(
                    group,
                    &file.display().to_string(),
                    mesh.turned(flip).with_flipped_v(flip_v),
                    to_world,
                    surface,
                );
            }
            _ => return Err(object.unknown_plugin(&SUPPORTED)),
        }
        object.finish()
    }

    /// The surface of a shape: its BSDF and its area light.
    fn surface(&mut self, object: &Object) -> Result<usize> {
        let emission = match object.object_of("emitter")? {
            None => None,
            Some(emitter) if emitter.plugin == "area" => {
                let radiance = emitter.colour("radiance", Colour::Emission, 1.0)?;
                emitter.finish()?;
                Some(radiance)
            }
            Some(emitter) => {
                return Err(emitter.error(format!("a shape can only hold an area light, not {}", emitter.title())));
            }
        };
        let (front, back) = match object.object_of("bsdf")? {
            Some(bsdf) => self.material(&bsdf)?,
            // Mitsuba's defaults: grey, or black where the shape is a light.
            None if emission.is_some() => (None, None),
            None => (Some(self.builder.material(material::diffuse([0.5; 3]))), None),
        };
        Ok(self.builder.surface(SurfaceDescription { front, back, emission: emission.unwrap_or([0.0; 3]) }))
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
