//! The arrays of a scene that kernels read, each declared once.
//!
//! A row is a field of `scene::Scene` with all that follows from it: its part of the scene's hash, of the prediction of memory and of
//! the upload; its device address in [`super::SceneUniforms`], by the same name; and its buffer reference in GLSL. To add an array, add a
//! row and fill the field where scenes are compiled.

/// Calls `$callback! { whole { ROWS } changed { ROWS } made { ROWS } }`. Rows of the first two are fields of `scene::Scene`:
///
/// - `whole`: uploaded as they are. Behind `if` stands the member of [`super::Needs`] without which no kernel reads the array;
/// - `changed`: of the same size on the device, but in another order or with addresses in them, which the upload sees to;
/// - `made`: what the upload makes by itself.
///
/// A row is `FIELD: ELEMENT in BUFFER, NAME`: what an element is on both sides, the GLSL type of a reference to the array (none
/// where the words are taken apart by hand), and its name in reports of memory.
macro_rules! scene_arrays {
    ($callback:ident) => {
        $callback! {
            whole {
                /// Vertex normals, unit. This and the other vertex attributes share their indices, and each is empty where no mesh has it.
                normals: vec3 in Vectors, "normals";
                /// Texture coordinates of vertices.
                uvs: vec2 in Vectors2, "texture coordinates" if uvs;
                /// A second set of them.
                second_uvs: vec2 in Vectors2, "second texture coordinates" if second_uvs;
                /// Tangents of vertices: direction, and the sign of the bitangent.
                tangents: vec4 in Vectors4, "tangents" if tangents;
                /// Vertex colours, linear red, green and blue, and opacity.
                colours: vec4 in Vectors4, "vertex colours" if colours;
                /// Attributes of vertices that textures show, one after the other: each has a value for every vertex.
                attributes: vec4 in Vectors4, "vertex attributes" if attributes;
                /// What primitives are made of and what they emit.
                surfaces: Surface in Surfaces, "surfaces";
                /// The parameters of the BSDFs.
                materials: Material in Materials, "materials";
                /// The textures of the materials.
                material_textures: MaterialTextures in TextureSets, "material textures";
                /// Which texture multiplies which property, material by material.
                property_textures: PropertyTexture in PropertyTextures, "textured properties";
                /// The two materials of each blend.
                blends: Blend in Blends, "blends";
                /// Parameters of plastics that [`Material`] has no room for.
                plastics: Plastic in Plastics, "plastics";
                /// Parameters of principled materials that [`Material`] has no room for.
                principleds: Principled in Principleds, "principled materials";
                /// Parameters of layered materials that [`Material`] has no room for.
                layereds: Layered in Layereds, "layered materials";
                /// What rough metals and rough glass lose to multiple scattering.
                compensations: Compensation in Compensations, "energy compensation";
                /// Tables of floats; where anything is textured, the first 256 decode 8-bit sRGB.
                tables: float in Floats, "tables";
                /// The lights, with the probability of selecting each of those in the alias table, which come first.
                lights: Light in Lights, "lights";
                /// Nodes of the tree that the other lights are selected from, the root first; children lie side by side.
                light_tree: LightNode in LightNodes, "light tree";
            }
            changed {
                /// All triangles and spheres, group by group; within a group the triangles come first. On the device, in the order of
                /// the acceleration structure.
                primitives: Primitive, "primitives";
                /// Where the vertex attributes of each primitive lie; empty where no mesh has any. On the device, in the order of the
                /// primitives.
                corners: Corners in Triples, "corners";
                /// Textures; each names its image, whose address stands there on the device.
                textures: Texture in Textures, "textures";
                /// Alias table over the cells of the environment's image, row by row. On the device, of those alone that are brighter
                /// than the mean, where the technique leaves the others to BSDF samples.
                background_table: AliasEntry in AliasTable, "environment table";
            }
            made {
                /// Nodes of backend `bvh`, [`NODE_BYTES`] each: of the instances first, then of each group.
                nodes, "nodes";
                /// Placements of groups.
                instances: Instance in Instances, "instances";
                /// The positions that divide the integral of the pixel filter's absolute value into [`FILTER_CELLS`] equal parts.
                filter_table: float in Floats, "pixel filter";
            }
        }
    };
}
pub(crate) use scene_arrays;

macro_rules! array_names {
    ($( $section:ident {
        $( $(#[$doc:meta])* $field:ident $(: $kind:ident)? $(in $buffer:ident)?, $name:literal $(if $need:ident)?; )*
    } )*) => {
        /// The names of the arrays in reports of memory, by field.
        #[derive(Clone, Copy, Debug)]
        #[allow(missing_docs)] // each member is the name of the array that is called so
        pub struct ArrayNames {
            $( $( pub $field: &'static str, )* )*
        }

        /// The name of each array in reports of memory.
        pub const ARRAY_NAMES: ArrayNames = ArrayNames { $( $( $field: $name, )* )* };
    };
}
scene_arrays!(array_names);

/// The GLSL type of a reference to an array.
#[derive(Clone, Copy, Debug)]
pub struct BufferReference {
    /// Its name.
    pub name: &'static str,
    /// The GLSL type of an element.
    pub element: &'static str,
    /// The array: its address is this member of `scene`.
    pub array: &'static str,
}

macro_rules! buffer_references {
    ($( $section:ident {
        $( $(#[$doc:meta])* $field:ident $(: $kind:ident)? $(in $buffer:ident)?, $name:literal $(if $need:ident)?; )*
    } )*) => {
        /// The references of all rows that have one; some rows share theirs.
        const ROWS: &[Option<BufferReference>] = &[$($( buffer_references!(@row $field $($kind)? $(in $buffer)?) ),*),*];
    };
    (@row $field:ident $kind:ident in $buffer:ident) => {
        Some(BufferReference { name: stringify!($buffer), element: stringify!($kind), array: stringify!($field) })
    };
    (@row $field:ident $($kind:ident)?) => {
        None
    };
}
scene_arrays!(buffer_references);

/// The type of a reference to the array of such elements, and the array; nothing where there is none.
pub fn of_element(element: &str) -> Option<(&'static str, &'static str)> {
    ROWS.iter().flatten().find(|row| row.element == element).map(|row| (row.name, row.array))
}

/// Every GLSL type of a reference to an array, once.
pub fn buffer_references() -> Vec<BufferReference> {
    let mut all: Vec<BufferReference> = Vec::new();
    for row in ROWS.iter().flatten() {
        if all.iter().all(|earlier| earlier.name != row.name) {
            all.push(*row);
        }
    }
    all
}
