//! Every struct, constant and binding that the host and the shaders share, from one source.
//!
//! `build.rs` includes this file, writes [`glsl`] to `generated/layout.glsl`, and each shader includes that; so a field
//! that is added here exists on both sides or on neither. `tests/layout.rs` reads the compiled SPIR-V back and compares
//! each member's offset with the host's.
//!
//! Rules: scalar block layout; each shared struct has alignment 4, so that it has no padding on either side; a device
//! address is a [`uvec2`] (low word, high word); lengths in scene units, angles in radians, radiance in W/(m² sr) per
//! colour channel (linear sRGB primaries).

#![allow(non_camel_case_types)]

#[macro_use]
mod macros;
mod aovs;
mod arrays;
pub mod backend;
mod constants;
mod features;
mod frame_structs;
mod light_subpaths;
mod lights;
mod materials;
mod probes;
mod properties;
mod records;
mod scene_structs;
mod scene_uniforms;
mod specialisation;
mod types;

pub use aovs::*;
pub(crate) use arrays::scene_arrays;
pub use arrays::{ARRAY_NAMES, ArrayNames};
pub use constants::*;
pub(crate) use features::features;
pub use frame_structs::*;
pub use light_subpaths::*;
pub use lights::*;
pub(crate) use macros::shared_structs;
pub use materials::*;
pub use probes::*;
pub use properties::*;
pub use records::*;
pub use scene_structs::*;
pub use scene_uniforms::*;
pub use specialisation::*;
pub use types::*;

/// Every shared struct but those that one family of techniques has to itself, in the order of declaration.
pub fn structs() -> impl Iterator<Item = &'static SharedStruct> {
    let rooms = [
        scene_structs::STRUCTS,
        scene_uniforms::STRUCTS,
        frame_structs::STRUCTS,
        light_subpaths::STRUCTS,
        aovs::STRUCTS,
        probes::STRUCTS,
        records::STRUCTS,
    ];
    rooms.into_iter().flatten()
}

/// `LightVertex` as `LIGHT_VERTEX`.
fn upper_case(name: &str) -> String {
    let word = |(index, letter): (usize, char)| {
        let gap = if index > 0 && letter.is_uppercase() { "_" } else { "" };
        format!("{gap}{}", letter.to_ascii_uppercase())
    };
    name.chars().enumerate().map(word).collect()
}

/// The text of `generated/layout.glsl`, with the structs that families of techniques have to themselves. Beside what is
/// declared it has `<STRUCT>_BYTES` for each shared struct, the bytes of one element of an array of it, and a buffer reference for each
/// array of a scene.
pub fn glsl(of_techniques: &[&'static SharedStruct]) -> String {
    let mut text = String::from("// Generated from src/layout/.\n\n");
    for constant in CONSTANTS {
        text += &format!("const uint {} = {}u;\n", constant.name, constant.value);
    }
    let kinds =
        [MATERIALS.iter().map(|kind| kind.constant).collect(), LIGHTS.iter().map(|kind| kind.constant).collect()];
    for kinds in kinds {
        let kinds: Vec<&str> = kinds;
        kinds.iter().enumerate().for_each(|(value, name)| text += &format!("const uint {name} = {value}u;\n"));
    }
    text += &format!("const float NARROW_ALPHA = {NARROW_ALPHA:?};\n");
    let [red, green, blue] = LUMINANCE;
    text += &format!("const vec3 LUMINANCE = vec3({red:?}, {green:?}, {blue:?});\n");
    for shared in structs().chain(of_techniques.iter().copied()) {
        text += &format!("const uint {}_BYTES = {}u;\n", upper_case(shared.name), shared.size);
    }
    text.push('\n');
    for constant in specialisation() {
        let default = if constant.kind == "bool" { "false" } else { "1" }; // 1: some are sizes of arrays
        text +=
            &format!("layout(constant_id = {}) const {} {} = {default};\n", constant.id, constant.kind, constant.name);
    }
    text.push('\n');
    for shared in structs().chain(of_techniques.iter().copied()) {
        text += shared.glsl;
        text.push('\n');
    }
    for arrays::BufferReference { name, element, .. } in arrays::buffer_references() {
        text += &format!(
            "layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer {name} {{ {element} at[]; }};\n"
        );
    }
    text
}

/// The text of `generated/inline.glsl`: `INLINE_PRIMITIVES(visit_triangle, visit_sphere)` calls `visit_triangle(index, v0, v1, v2)` or
/// `visit_sphere(index, centre, radius)` for each primitive that the kernel holds as constants. Straight-line on purpose: a loop over constants is a
/// loop over memory.
pub fn inline_glsl() -> String {
    let mut text = String::from("// Generated from src/layout/.\n\n");
    for coordinate in 0..9 * INLINE_MAX {
        text +=
            &format!("layout(constant_id = {}) const float INLINE_{coordinate} = 0;\n", INLINE_FIRST_ID + coordinate);
    }
    text += "\n#define INLINE_PRIMITIVES(visit_triangle, visit_sphere)";
    for primitive in 0..INLINE_MAX {
        let vertex = |k: u32| {
            let first = 9 * primitive + 3 * k;
            format!("vec3(INLINE_{}, INLINE_{}, INLINE_{})", first, first + 1, first + 2)
        };
        let (mask, bit) =
            if primitive < 32 { ("INLINE_SPHERES", primitive) } else { ("INLINE_SPHERES_HIGH", primitive - 32) };
        text += &format!(
            " \\\n    if (INLINE_COUNT > {primitive}u) {{ \\\n        if (({mask} & {}u) != 0u) visit_sphere({primitive}u, {}, INLINE_{}) \\\n        \
             else visit_triangle({primitive}u, {}, {}, {}) \\\n    }}",
            1u32 << bit,
            vertex(0),
            9 * primitive + 3,
            vertex(0),
            vertex(1),
            vertex(2)
        );
    }
    text.push('\n');
    text
}
