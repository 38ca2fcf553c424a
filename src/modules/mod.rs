//! What shader modules there are, and how their text becomes SPIR-V.
//!
//! `build.rs` includes this folder and compiles all of them into the program. With the feature `hot-reload` the program has the compiler as well:
//! `lumbre view` then takes shaders from their files whenever these change.

pub mod compile;
pub mod source;
pub mod variants;
