//! The passes and parameters that techniques with a grid of light vertices share.

use super::{Over, Parameter, Pass, Values, pass};

/// Empties the cells of the grid, see `shaders/core/grid_build.glsl`.
pub const GRID_CLEAR: Pass = pass("grid-clear", Over::Elements);
/// Counts the light vertices of each cell.
pub const GRID_COUNT: Pass = pass("grid-count", Over::Elements);
/// Gives each cell its run of places.
pub const GRID_ALLOT: Pass = pass("grid-allot", Over::Elements);
/// Puts each light vertex in a place of its cell.
pub const GRID_FILL: Pass = pass("grid-fill", Over::Elements);

/// Within which paths from the camera meet vertices of light subpaths, see `radius.rs`.
pub const RADIUS: Parameter = Parameter {
    name: "radius",
    about: "radius of the first sample's merges, as a share of the radius of all that does not emit; 0 is one over the root of the number \
            of light subpaths in a sample, which is that of pixels where there is room",
    values: Values::Number(0.0, 1.0, 0.0),
    biased: None,
    misses: &[],
};

/// How that shrinks.
pub const ALPHA: Parameter = Parameter {
    name: "alpha",
    about: "how slowly the radius shrinks: its square falls like samples^(alpha - 1), the variance like samples^-alpha",
    values: Values::Number(0.01, 1.0, 2.0 / 3.0),
    biased: Some(("1", "with alpha=1 its radius stays as it is")),
    misses: &[],
};
