//! What the kernels that tests and `lumbre rays` run are asked, and what they answer.

#[allow(unused_imports)] // named by the documentation
use super::constants::*;
use super::types::{Member, SharedStruct, float, uint, vec3, vec4};

shared_structs! {
    /// A ray and what to report of it, for the kernels that tests and `lumbre rays` run.
    pub struct RayRecord {
        /// Origin.
        origin: vec3,
        /// Direction; distances are in units of its length.
        direction: vec3,
        /// Largest distance that counts.
        t_max: float,
    }

    /// The answer to a [`RayRecord`].
    pub struct HitRecord {
        /// Distance in units of the direction's length, negative where nothing was hit.
        t: float,
        /// Primitive index, in the order of the uploaded primitives.
        primitive: uint,
        /// Instance index.
        instance: uint,
        /// Barycentric weight of the second vertex.
        u: float,
        /// Barycentric weight of the third vertex.
        v: float,
        /// 1 where `trace_any` found the ray blocked.
        blocked: uint,
    }

    /// What traversal tested for a [`RayRecord`]: see `shaders/kernels/rays/count.glsl`.
    pub struct TraversalCount {
        /// Nodes that were read until the nearest hit was known.
        closest_nodes: uint,
        /// Triangles and spheres that were tested for it.
        closest_primitives: uint,
        /// Nodes that were read until any hit was known.
        any_nodes: uint,
        /// Triangles and spheres that were tested for that.
        any_primitives: uint,
    }

    /// Directions and uniform numbers to ask a BSDF about.
    pub struct BsdfQuery {
        /// Index of the material.
        material: uint,
        /// Outgoing direction, local.
        wo: vec3,
        /// Incident direction to evaluate, local.
        wi: vec3,
        /// Numbers to sample another one with.
        u: vec3,
    }

    /// The answer to a [`BsdfQuery`].
    pub struct BsdfAnswer {
        /// f |cos| of the query's directions.
        value: vec3,
        /// Density of the query's incident direction.
        pdf_w: float,
        /// The sampled incident direction.
        sampled: vec3,
        /// f |cos| / density of the sampled direction.
        weight: vec3,
        /// Density of the sampled direction.
        sampled_pdf_w: float,
        /// f |cos| of the sampled direction, evaluated.
        sampled_value: vec3,
        /// Density of the sampled direction, evaluated.
        evaluated_pdf_w: float,
        /// 1 where the sampled lobe is a delta.
        delta: uint,
    }

    /// A point that light is sampled at, and a direction to look in from there.
    pub struct LightQuery {
        /// The point, in coordinates of the scene's arrays.
        point: vec3,
        /// The direction, unit.
        direction: vec3,
        /// Unit normal of the surface that receives the light there, or zero where it may come from anywhere.
        normal: vec3,
        /// Numbers to sample a light with.
        u: vec4,
    }

    /// The answer to a [`LightQuery`].
    pub struct LightAnswer {
        /// The sampled direction.
        wi: vec3,
        /// Radiance / density of the sample; of a delta light, irradiance on a facing surface / probability.
        weight: vec3,
        /// Density of the sample over solid angle; 0 where there is none.
        pdf_w: float,
        /// 1 where no direction hits the sampled light by chance.
        delta: uint,
        /// 1 where nothing stands between the point and the sample.
        visible: uint,
        /// Emission that a ray in the sampled direction finds.
        found: vec3,
        /// Density of choosing what it finds.
        found_pdf_w: float,
        /// Emission in the query's direction.
        asked: vec3,
        /// Density of choosing what lies there.
        asked_pdf_w: float,
    }

    /// A coordinate of the random numbers.
    pub struct RandomQuery {
        /// Pixel index.
        pixel: uint,
        /// Sample index.
        sample_index: uint,
        /// Block of four dimensions.
        dimension: uint,
        /// Seed.
        seed: uint,
    }
}
