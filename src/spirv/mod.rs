//! Makes of a kernel that models everything the one that a scene needs: specialisation constants become plain ones, branches that they
//! decide go, and with these all that nothing leads to or refers to any more.
//!
//! A driver does the same when it is given constants, but it reads the whole module first, which takes it a hundred times as long as
//! this does. Pure functions on words; no Vulkan. The passes, in order:
//!
//! 1. [`module`] takes the words apart, by the table in [`op`];
//! 2. [`propagate`] finds which values are constant and which blocks can be reached ([`fold`] evaluates single instructions);
//! 3. [`live`] finds what of these blocks has any effect;
//! 4. [`emit`] writes that down, with identifiers numbered anew. Structured control flow stays structured: a selection that is decided
//!    becomes a plain branch, a loop keeps its merge and the block that goes back, even where nothing leads there.

pub mod copies;
pub mod emit;
pub mod fold;
pub mod live;
pub mod module;
pub mod op;
pub mod propagate;

use module::Module;

pub use emit::Arithmetic;

/// A module that was made for some values of its specialisation constants.
#[derive(Clone, Debug)]
pub struct Specialised {
    /// Its words.
    pub words: Vec<u32>,
    /// Instructions that it had, without names.
    pub before: usize,
    /// Instructions that are left.
    pub after: usize,
}

/// The module for these values: pairs of a `constant_id` and its bits. A constant without a pair keeps its default. Fails where the words
/// are no module of the kind that glslang writes for a compute shader.
pub fn specialise(words: &[u32], constants: &[(u32, u32)], arithmetic: Arithmetic) -> Result<Specialised, String> {
    let module = Module::parse(words)?;
    let found = propagate::Propagation::run(&module, constants)?;
    let live = live::Live::find(&found);
    let (words, after) = emit::emit(&live, arithmetic);
    Ok(Specialised { words, before: module.code.len(), after })
}

/// The module without what is there for people and tools only: names and sources. Fails as [`specialise`] does.
pub fn strip(words: &[u32]) -> Result<Vec<u32>, String> {
    let module = Module::parse(words)?;
    let mut stripped = words[..module::HEADER].to_vec();
    module.code.iter().for_each(|instruction| stripped.extend_from_slice(module.words_of(*instruction)));
    Ok(stripped)
}
