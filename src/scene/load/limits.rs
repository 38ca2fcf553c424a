//! What is the most that is read, in one place: a file can claim anything, and a few bytes can stand for very many. Each limit
//! is far above what scenes need, and the error that it gives names it.

/// Bytes of the XML of a scene, and of all that it includes, again each time.
pub(super) const XML_BYTES: u64 = 256 << 20;
/// Elements of the XML of a scene, and of all that it includes.
pub(super) const XML_ELEMENTS: u32 = 1 << 20;
/// Files that include each other more deeply than this are taken for a cycle.
pub(super) const INCLUDES: usize = 16;
/// Elements, and objects by way of references, nested in each other: what reads them is recursive, and no scene needs more.
pub(super) const DEPTH: usize = 64;
/// Shapes that are placed, those of shapes that are merged again each time: merged shapes may share what they hold. Of glTF the meshes that
/// nodes and their instances place.
pub(super) const SHAPES: u32 = 1 << 20;
/// Joints of all skins of a glTF file: the few bytes that name one stand for a matrix.
pub(super) const JOINTS: u32 = 1 << 20;
/// Bytes that parameters stand for where they are used, all uses together: parameters may hold other parameters.
pub(super) const PARAMETER_BYTES: usize = 16 << 20;
/// Bytes of a file with a spectrum.
pub(super) const SPECTRUM_BYTES: u64 = 16 << 20;

/// Bytes of the JSON of a glTF file; in memory it takes many times that.
pub(super) const JSON_BYTES: usize = 256 << 20;
/// Elements of a glTF accessor that no bytes of its own stand for.
pub(super) const ZEROS: u64 = 1 << 20;

/// Bytes of a serialized mesh, decompressed.
pub(super) const MESH_BYTES: u64 = 4 << 30;
/// Bytes of the name of a serialized mesh.
pub(super) const MESH_NAME: u64 = 1 << 16;
