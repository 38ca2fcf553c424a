//! A number that stands for all that a scene's picture depends on.
//!
//! Each struct is taken apart without `..`: a new field does not compile until it is hashed here, or is left out with the reason why no
//! picture depends on it. Numbers go in by their bits, and whatever has a length after its length.

use std::hash::{Hash, Hasher};
use std::mem::discriminant;

use bytemuck::Pod;

use super::camera::Projection;
use super::{Camera, Environment, FilmSettings, Filter, Group, Instance, Scene, TechniqueRequest};
use crate::bvh::Bounds;
use crate::image::{Texels, TextureImage};
use crate::layout::scene_arrays;

macro_rules! hash_content {
    (
        whole { $( $(#[$doc:meta])* $field:ident : $kind:ident in $buffer:ident, $name:literal $(if $need:ident)?; )* }
        changed { $( $(#[$other_doc:meta])* $other:ident : $other_kind:ident $(in $other_buffer:ident)?, $other_name:literal; )* }
        made { $($made:tt)* }
    ) => {
        impl Scene {
            /// Feeds everything that a picture depends on to a hash: arrays, images, cameras, film; not names in messages and warnings.
            pub fn hash_content(&self, hasher: &mut impl Hasher) {
                let Self {
                    source: _, // for messages
                    cameras,
                    film,
                    technique,
                    material_names: _, // for messages: surfaces know materials by their indices
                    images,
                    table_lights,
                    table_probability,
                    light_tree_origin,
                    light_tree_scale,
                    background,
                    environment,
                    background_probability,
                    groups,
                    shapes: _, // for AOVs, which no image depends on
                    instances,
                    origin,
                    bounds,
                    warnings: _, // messages
                    $($field,)*
                    $($other,)*
                } = self;
                parts(cameras, hasher);
                film.feed(hasher);
                technique.feed(hasher);
                $(array($field, hasher);)*
                $(array($other, hasher);)*
                parts(images, hasher);
                bits(table_lights, hasher);
                bits(table_probability, hasher);
                bits(light_tree_origin, hasher);
                bits(light_tree_scale, hasher);
                array(background.as_slice(), hasher);
                parts(environment.as_slice(), hasher);
                bits(background_probability, hasher);
                parts(groups, hasher);
                parts(instances, hasher);
                bits(origin, hasher);
                bounds.feed(hasher);
            }
        }
    };
}
scene_arrays!(hash_content);

/// Feeds a number, or a fixed number of them.
fn bits<T: Pod>(value: &T, hasher: &mut impl Hasher) {
    hasher.write(bytemuck::bytes_of(value));
}

/// Feeds numbers after how many elements they make: else two arrays in a row could trade some unseen.
fn array<T: Pod>(elements: &[T], hasher: &mut impl Hasher) {
    elements.len().hash(hasher);
    hasher.write(bytemuck::cast_slice(elements));
}

/// Feeds parts of a scene after how many there are.
fn parts<T: Part>(parts: &[T], hasher: &mut impl Hasher) {
    parts.len().hash(hasher);
    parts.iter().for_each(|part| part.feed(hasher));
}

/// A part of a scene that is more than plain numbers.
trait Part {
    /// Feeds what a picture depends on.
    fn feed(&self, hasher: &mut impl Hasher);
}

impl Part for Camera {
    fn feed(&self, hasher: &mut impl Hasher) {
        // The name decides which camera `--camera NAME` is.
        let Self { name, to_world, fov, axis, principal_point, projection, window, film, spp } = self;
        name.hash(hasher);
        bits(to_world, hasher);
        bits(fov, hasher);
        discriminant(axis).hash(hasher);
        bits(principal_point, hasher);
        projection.feed(hasher);
        bits(window, hasher);
        parts(film.as_slice(), hasher);
        array(spp.as_slice(), hasher);
    }
}

impl Part for Projection {
    fn feed(&self, hasher: &mut impl Hasher) {
        discriminant(self).hash(hasher);
        match self {
            Self::Pinhole | Self::Orthographic => (),
            Self::ThinLens { radius, focus } => bits(&[*radius, *focus], hasher),
        }
    }
}

impl Part for FilmSettings {
    fn feed(&self, hasher: &mut impl Hasher) {
        let Self { width, height, filter } = self;
        bits(&[*width, *height], hasher);
        filter.feed(hasher);
    }
}

impl Part for Filter {
    fn feed(&self, hasher: &mut impl Hasher) {
        discriminant(self).hash(hasher);
        match self {
            Self::Box => (),
            Self::Tent { radius } => bits(radius, hasher),
            Self::Gaussian { stddev, radius } => bits(&[*stddev, *radius], hasher),
            Self::Mitchell { b, c } => bits(&[*b, *c], hasher),
            Self::Lanczos { lobes } => lobes.hash(hasher),
        }
    }
}

impl Part for TechniqueRequest {
    fn feed(&self, hasher: &mut impl Hasher) {
        // What is refused is for messages, and no image depends on AOVs.
        let Self { integrator, refused: _, hide_emitters, spp, max_depth, rr_depth, aovs: _ } = self;
        integrator.hash(hasher);
        hide_emitters.hash(hasher);
        spp.hash(hasher);
        max_depth.hash(hasher);
        rr_depth.hash(hasher);
    }
}

impl Part for TextureImage {
    fn feed(&self, hasher: &mut impl Hasher) {
        let Self { source: _, width, height, texels } = self; // the source is for messages
        bits(&[*width, *height], hasher);
        discriminant(texels).hash(hasher);
        match texels {
            Texels::Srgb8(texels) | Texels::Linear8(texels) => array(texels, hasher),
            Texels::Float(texels) => array(texels, hasher),
        }
    }
}

impl Part for Environment {
    fn feed(&self, hasher: &mut impl Hasher) {
        let Self { texture, from_world, cells } = self;
        bits(texture, hasher);
        bits(from_world, hasher);
        bits(cells, hasher);
    }
}

impl Part for Group {
    fn feed(&self, hasher: &mut impl Hasher) {
        let Self { name: _, triangles, spheres } = self; // the name is for messages: instances know groups by their indices
        triangles.hash(hasher);
        spheres.hash(hasher);
    }
}

impl Part for Instance {
    fn feed(&self, hasher: &mut impl Hasher) {
        let Self { group, to_world } = self;
        group.hash(hasher);
        bits(to_world, hasher);
    }
}

impl Part for Bounds {
    fn feed(&self, hasher: &mut impl Hasher) {
        let Self { min, max } = self;
        bits(min, hasher);
        bits(max, hasher);
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use std::hash::DefaultHasher;
    use std::path::PathBuf;

    use bytemuck::Zeroable;
    use glam::{DAffine3, DVec3, Vec3};

    use super::*;
    use crate::scene::NamedShape;
    use crate::scene::camera::FovAxis;

    macro_rules! of_arrays {
        (
            whole { $( $(#[$doc:meta])* $field:ident : $kind:ident in $buffer:ident, $name:literal $(if $need:ident)?; )* }
            changed { $( $(#[$other_doc:meta])* $other:ident : $other_kind:ident $(in $other_buffer:ident)?, $other_name:literal; )* }
            made { $($made:tt)* }
        ) => {
            /// A scene with one of everything, each of it nothing but zeros.
            fn scene() -> Scene {
                fn one<T: Zeroable>() -> Vec<T> {
                    vec![T::zeroed()]
                }
                Scene {
                    source: PathBuf::from("scene.xml"),
                    cameras: vec![Camera::new("camera", DAffine3::ZERO, 0.0, FovAxis::X)],
                    film: FilmSettings { width: 0, height: 0, filter: Filter::Box },
                    technique: TechniqueRequest::default(),
                    material_names: vec![None],
                    images: vec![TextureImage {
                        source: PathBuf::from("image.png"),
                        width: 0,
                        height: 0,
                        texels: Texels::Srgb8(one()),
                    }],
                    table_lights: 0,
                    table_probability: 0.0,
                    light_tree_origin: Vec3::ZERO,
                    light_tree_scale: 0.0,
                    background: Some([0.0; 3]),
                    environment: Some(Environment { texture: 0, from_world: [[0.0; 3]; 3], cells: [0; 2] }),
                    background_probability: 0.0,
                    groups: vec![Group { name: String::from("group"), triangles: 0..0, spheres: 0..0 }],
                    shapes: Vec::new(),
                    instances: vec![Instance { group: 0, to_world: DAffine3::ZERO }],
                    origin: DVec3::ZERO,
                    bounds: Bounds { min: Vec3::ZERO, max: Vec3::ZERO },
                    warnings: Vec::new(),
                    $($field: one(),)*
                    $($other: one(),)*
                }
            }

            /// The bytes of each array.
            fn bytes_of_arrays(scene: &mut Scene) -> Vec<&mut [u8]> {
                vec![
                    $(bytemuck::cast_slice_mut(&mut scene.$field),)*
                    $(bytemuck::cast_slice_mut(&mut scene.$other),)*
                ]
            }
        };
    }
    scene_arrays!(of_arrays);

    fn hash(scene: &Scene) -> u64 {
        let mut hasher = DefaultHasher::new();
        scene.hash_content(&mut hasher);
        hasher.finish()
    }

    /// Changes the fields of one struct of the scene, each by itself; it must become another scene (`other`) or stay the same (`same`).
    /// The rows must be all fields: what they leave out is missing in a pattern, and the compiler says "inaccessible fields".
    macro_rules! check_fields {
        ($struct:ident, |$scene:ident| $place:expr, { $($field:ident: $outcome:ident |$it:ident| $change:expr;)* } $($rest:tt)?) => {{
            let mut $scene = scene();
            let $struct { $($field: _,)* $($rest)? } = &mut $place;
            $(
                let mut $scene = scene();
                let $it = &mut $place.$field;
                $change;
                let name = concat!(stringify!($struct), "::", stringify!($field));
                assert_eq!(hash(&$scene) != hash(&scene()), stringify!($outcome) == "other", "{name}");
            )*
        }};
    }

    #[test]
    fn every_field_counts_but_messages() {
        check_fields!(Scene, |scene| scene, {
            source: same |it| it.push("elsewhere");
            cameras: other |it| it.push(it[0].clone());
            film: other |it| it.width = 1;
            technique: other |it| it.spp = Some(1);
            material_names: same |it| it[0] = Some(String::from("gold"));
            images: other |it| it.push(it[0].clone());
            table_lights: other |it| *it = 1;
            table_probability: other |it| *it = 1.0;
            light_tree_origin: other |it| it.z = 1.0;
            light_tree_scale: other |it| *it = 1.0;
            background: other |it| *it = None;
            environment: other |it| *it = None;
            background_probability: other |it| *it = 1.0;
            groups: other |it| it.push(it[0].clone());
            shapes: same |it| it.push(NamedShape { name: String::new(), group: 0, primitives: 0..0 });
            instances: other |it| it.push(it[0]);
            origin: other |it| it.z = 1.0;
            bounds: other |it| it.max.z = 1.0;
            warnings: same |it| it.push(String::from("a face was dropped"));
        } ..); // the arrays are below
        check_fields!(Camera, |scene| scene.cameras[0], {
            name: other |it| it.push('2');
            to_world: other |it| it.translation.z = 1.0;
            fov: other |it| *it = 1.0;
            axis: other |it| *it = FovAxis::Y;
            principal_point: other |it| it[1] = 1.0;
            projection: other |it| *it = Projection::Orthographic;
            window: other |it| it[3] = 0.5;
            film: other |it| *it = Some(FilmSettings { width: 1, height: 1, filter: Filter::Box });
            spp: other |it| *it = Some(1);
        });
        check_fields!(FilmSettings, |scene| scene.film, {
            width: other |it| *it = 1;
            height: other |it| *it = 1;
            filter: other |it| *it = Filter::GAUSSIAN;
        });
        check_fields!(TechniqueRequest, |scene| scene.technique, {
            integrator: other |it| *it = Some((String::from("path"), Vec::new()));
            refused: same |it| *it = Some(String::new());
            hide_emitters: other |it| *it = true;
            spp: other |it| *it = Some(0);
            max_depth: other |it| *it = Some(None);
            rr_depth: other |it| *it = Some(0);
            aovs: same |it| it.push((String::from("depth"), "depth"));
        });
        check_fields!(TextureImage, |scene| scene.images[0], {
            source: same |it| it.push("elsewhere");
            width: other |it| *it = 1;
            height: other |it| *it = 1;
            texels: other |it| *it = Texels::Srgb8(vec![[0, 0, 0, 1]]);
        });
        check_fields!(Group, |scene| scene.groups[0], {
            name: same |it| it.push('2');
            triangles: other |it| it.end = 1;
            spheres: other |it| it.end = 1;
        });
        check_fields!(Instance, |scene| scene.instances[0], {
            group: other |it| *it = 1;
            to_world: other |it| it.translation.z = 1.0;
        });
        check_fields!(Bounds, |scene| scene.bounds, {
            min: other |it| it.z = 1.0;
            max: other |it| it.z = 1.0;
        });
        check_fields!(Environment, |scene| scene.environment.as_mut().unwrap(), {
            texture: other |it| *it = 1;
            from_world: other |it| it[2][2] = 1.0;
            cells: other |it| it[1] = 1;
        });
    }

    /// A bit of the last member of each array makes another scene.
    #[test]
    fn every_array_counts() {
        for index in 0..bytes_of_arrays(&mut scene()).len() {
            let mut other = scene();
            *bytes_of_arrays(&mut other)[index].last_mut().unwrap() = 1;
            assert_ne!(hash(&other), hash(&scene()), "array {index}");
        }
    }

    /// What is a choice with parameters: each choice and each parameter makes another scene.
    #[test]
    fn every_choice_counts() {
        let all_differ = |changes: &[&dyn Fn(&mut Scene)]| {
            let mut hashes: Vec<u64> = Vec::new();
            for (index, change) in changes.iter().enumerate() {
                let mut scene = scene();
                change(&mut scene);
                let hash = hash(&scene);
                let before = hashes.iter().position(|other| *other == hash);
                assert_eq!(before, None, "change {index} has the hash of an earlier one");
                hashes.push(hash);
            }
        };
        all_differ(&[
            &|it| it.film.filter = Filter::Box,
            &|it| it.film.filter = Filter::Tent { radius: 1.0 },
            &|it| it.film.filter = Filter::Tent { radius: 2.0 },
            &|it| it.film.filter = Filter::Gaussian { stddev: 1.0, radius: 2.0 },
            &|it| it.film.filter = Filter::Gaussian { stddev: 2.0, radius: 2.0 },
            &|it| it.film.filter = Filter::Gaussian { stddev: 1.0, radius: 3.0 },
            &|it| it.film.filter = Filter::Mitchell { b: 1.0, c: 2.0 },
            &|it| it.film.filter = Filter::Mitchell { b: 2.0, c: 2.0 },
            &|it| it.film.filter = Filter::Mitchell { b: 1.0, c: 3.0 },
            &|it| it.film.filter = Filter::Lanczos { lobes: 3 },
            &|it| it.film.filter = Filter::Lanczos { lobes: 2 },
        ]);
        all_differ(&[
            &|it| it.cameras[0].projection = Projection::Pinhole,
            &|it| it.cameras[0].projection = Projection::Orthographic,
            &|it| it.cameras[0].projection = Projection::ThinLens { radius: 1.0, focus: 2.0 },
            &|it| it.cameras[0].projection = Projection::ThinLens { radius: 2.0, focus: 2.0 },
            &|it| it.cameras[0].projection = Projection::ThinLens { radius: 1.0, focus: 3.0 },
        ]);
        // The same bytes in each form; then other ones.
        all_differ(&[
            &|it| it.images[0].texels = Texels::Srgb8(vec![[0; 4]; 4]),
            &|it| it.images[0].texels = Texels::Linear8(vec![[0; 4]; 4]),
            &|it| it.images[0].texels = Texels::Float(vec![[0.0; 4]]),
            &|it| it.images[0].texels = Texels::Float(vec![[0.0, 0.0, 0.0, 1.0]]),
        ]);
        let asks = |it: &mut Scene, name: &str, values: &[(&str, &str)]| {
            let values = values.iter().map(|(name, value)| (String::from(*name), String::from(*value))).collect();
            it.technique.integrator = Some((String::from(name), values));
        };
        all_differ(&[
            &|it| asks(it, "vcm", &[("radius", "1")]),
            &|it| asks(it, "vcm", &[("radius", "2")]),
            &|it| asks(it, "vcm", &[("alpha", "1")]),
            &|it| asks(it, "vcm", &[("radius", "1"), ("alpha", "1")]),
            &|it| asks(it, "sppm", &[("radius", "1")]),
        ]);
    }

    /// Where only the lengths tell: all elements are zeros, and as many bytes of them.
    #[test]
    fn arrays_do_not_trade_elements() {
        let with = |tangents: usize, colours: usize| {
            hash(&Scene { tangents: vec![[0.0; 4]; tangents], colours: vec![[0.0; 4]; colours], ..scene() })
        };
        assert_ne!(with(1, 2), with(2, 1));
        assert_ne!(with(0, 3), with(3, 0));
        // A group feeds 16 bytes, an instance 104.
        let with = |groups: usize, instances: usize| {
            let scene = scene();
            let groups = vec![scene.groups[0].clone(); groups];
            hash(&Scene { groups, instances: vec![scene.instances[0]; instances], ..scene })
        };
        assert_ne!(with(13, 0), with(0, 2));
    }
}
