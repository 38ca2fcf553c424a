//! The types of GLSL as the host names them, and the description of a shared struct.

#![allow(non_camel_case_types)]

/// A GLSL `float`.
pub type float = f32;
/// A GLSL `uint`.
pub type uint = u32;
/// A GLSL `vec2`.
pub type vec2 = [f32; 2];
/// A GLSL `vec3`, 12 bytes under scalar layout.
pub type vec3 = [f32; 3];
/// A GLSL `vec4`.
pub type vec4 = [f32; 4];
/// A GLSL `uvec3`.
pub type uvec3 = [u32; 3];
/// A GLSL `uvec2`; also a 64-bit device address, low word first.
pub type uvec2 = [u32; 2];

/// A 64-bit device address as the shared structs hold it.
pub const fn address(value: u64) -> uvec2 {
    [value as u32, (value >> 32) as u32]
}

/// One member of a shared struct, as the host lays it out.
#[derive(Clone, Copy, Debug)]
pub struct Member {
    /// The member's name, the same on both sides.
    pub name: &'static str,
    /// Bytes from the start of the struct.
    pub offset: usize,
}

/// One shared struct: its GLSL text and the host's layout of it.
#[derive(Clone, Copy, Debug)]
pub struct SharedStruct {
    /// The struct's name, the same on both sides.
    pub name: &'static str,
    /// Bytes of one element of an array of it.
    pub size: usize,
    /// Its members in order.
    pub members: &'static [Member],
    /// Its declaration in GLSL.
    pub glsl: &'static str,
}
