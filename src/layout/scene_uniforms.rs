//! What a rendering's kernels all read: the uniform buffer of a scene.

use super::arrays::scene_arrays;
use super::types::{Member, SharedStruct, float, uint, uvec2, vec2, vec3};
#[allow(unused_imports)] // named by the documentation
use super::{constants::*, scene_structs::*};

macro_rules! scene_uniforms {
    ($( $section:ident {
        $( $(#[$doc:meta])* $field:ident $(: $kind:ident)? $(in $buffer:ident)?, $name:literal $(if $need:ident)?; )*
    } )*) => {
        shared_structs! {
            /// What stays the same through one rendering: the beginning of the uniform buffer at [`BINDING_SCENE`]. After it come
            /// [`UNIFORM_SURFACES`] surfaces, [`UNIFORM_MATERIALS`] materials and [`UNIFORM_LIGHTS`] lights, for scenes that have
            /// no more than that of a kind.
            pub struct SceneUniforms {
                /// Width of the image in pixels.
                width: uint,
                /// Height of the image in pixels.
                height: uint,
                /// Camera position.
                camera_origin: vec3,
                /// Direction through the corner (0, 0) of the image; not of unit length.
                camera_corner: vec3,
                /// Change of that direction per pixel to the right.
                camera_dx: vec3,
                /// Change of it per pixel down.
                camera_dy: vec3,
                /// Change of the ray's origin per unit of lens, along the image; zero for a pinhole. For an orthographic camera,
                /// change of the origin per pixel to the right.
                lens_x: vec3,
                /// Change of the ray's origin per unit of lens, down the image; of an orthographic camera, per pixel down.
                lens_y: vec3,
                /// Distance along the viewing direction at which a thin lens is in focus, in lengths of it.
                focus: float,
                /// Absorption of the medium that the camera stands in, 1/m.
                camera_absorption: vec3,
                /// Radiance of the background, or the factor on its texture.
                background: vec3,
                /// Texture of the background, or [`NONE`].
                background_texture: uint,
                /// World to background space, first row.
                background_x: vec3,
                /// World to background space, second row.
                background_y: vec3,
                /// World to background space, third row.
                background_z: vec3,
                /// Cells of the environment's alias table, across and down.
                background_cells: uvec2,
                /// Probability of selecting the background as the light to sample.
                background_probability: float,
                /// Entries of the light table.
                light_count: uint,
                /// Lights that are selected from the alias table: the first ones. Others are selected from the tree.
                table_lights: uint,
                /// Probability of selecting one from the table, where the background was not selected.
                table_probability: float,
                /// Probability of going to the tree.
                tree_probability: float,
                /// Origin of the coordinates of the [`LightNode`]s.
                light_tree_origin: vec3,
                /// Factor on coordinates relative to that.
                light_tree_scale: float,
                /// Centre of a sphere around everything that is placed.
                centre: vec3,
                /// Its radius.
                radius: float,
                /// Centre of a sphere around what does not emit: most light subpaths of lights far off are sent there.
                core_centre: vec3,
                /// Its radius.
                core_radius: float,
                /// Value of one unit of the splats' fixed-point numbers.
                splat_unit: float,
                /// Parameters of the pixel filter: tent (radius, 0); Gaussian (standard deviation, radius); Mitchell (B, C); Lanczos (lobes, 0).
                filter_parameters: vec2,
                /// One over the filter's integral.
                filter_scale: float,
                $($(
                    #[doc = concat!("Device address of the array: ", $name, "; 0 where it is empty.")]
                    $field: uvec2,
                )*)*
            }
        }
    };
}
scene_arrays!(scene_uniforms);
