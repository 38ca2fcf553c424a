//! Light subpaths that are kept for camera subpaths: shared by all techniques that have them.

#[allow(unused_imports)] // named by the documentation
use super::constants::*;
use super::types::{Member, SharedStruct, float, uint, uvec2, vec2, vec3};

shared_structs! {
    /// What techniques with light subpaths or splats keep. Their tables begin with it.
    pub struct LightSubpathTable {
        /// Device address of the splats: for each sample of a dispatch, pixel and layer three 64-bit integers in units of
        /// [`SceneUniforms::splat_unit`](super::SceneUniforms::splat_unit); layers are those by path length, or the one that is the image.
        splats: uvec2,
        /// Device address of the light subpaths: for each slot and sample of a dispatch, or for each of a sample, the number of its
        /// vertices, then room for `light_vertices` of them.
        light_paths: uvec2,
        /// Vertices that a light subpath has room for.
        light_vertices: uint,
        /// Light subpaths in each sample of the image.
        light_path_count: uint,
        /// Device address of the grid that holds the vertices of light subpaths: the number of places taken, then [`GridCell`]s.
        grid_cells: uvec2,
        /// Device address of those places: indices of vertices, subpath by subpath, `light_vertices` for each.
        grid_places: uvec2,
        /// Cells of the grid, a power of two; 0 where there is none.
        grid_cell_count: uint,
    }

    /// A vertex of a light subpath, for paths from the camera to be connected to it.
    pub struct LightVertex {
        /// Its position.
        position: vec3,
        /// Unit direction in which light came.
        direction: vec3,
        /// Unit geometric normal of the surface.
        normal: vec3,
        /// Primitive that was hit.
        primitive: uint,
        /// Its instance.
        instance: uint,
        /// Barycentric weights of its second and third vertex.
        uv: vec2,
        /// Power that arrives there, W, over the density of the path.
        power: vec3,
        /// Recursive MIS quantity d_vcm (Georgiev 2012, eqs. 31 and 34), see docs/mis.md.
        d_vcm: float,
        /// Recursive MIS quantity d_vc (eqs. 32 and 35).
        d_vc: float,
        /// Random dimension with which its material was chosen.
        dimension: uint,
        /// Segments from the light to it.
        segments: uint,
        /// Absorption of the medium that light came through, 1/m.
        absorption: vec3,
    }

    /// A cell of the grid that holds the vertices of light subpaths.
    pub struct GridCell {
        /// Its first place.
        first: uint,
        /// How many there are.
        count: uint,
    }

    /// A place of a cell, which a vertex has taken.
    pub struct GridPlace {
        /// The vertex's position.
        position: vec3,
        /// Its number: that of its subpath times the most vertices of one, and its own in the subpath.
        index: uint,
    }
}
