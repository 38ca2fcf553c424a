//! A number that stands for all that a scene's picture depends on.

use std::hash::{Hash, Hasher};

use super::Scene;

impl Scene {
    /// Feeds everything that a picture depends on to a hash: arrays, images, cameras, film; not names and warnings.
    pub fn hash_content(&self, hasher: &mut impl Hasher) {
        fn bytes<T: bytemuck::Pod>(array: &[T], hasher: &mut impl Hasher) {
            bytemuck::cast_slice::<T, u8>(array).hash(hasher);
        }
        bytes(&self.primitives, hasher);
        bytes(&self.corners, hasher);
        bytes(&self.normals, hasher);
        bytes(&self.uvs, hasher);
        bytes(&self.tangents, hasher);
        bytes(&self.colours, hasher);
        bytes(&self.surfaces, hasher);
        bytes(&self.materials, hasher);
        bytes(&self.material_textures, hasher);
        bytes(&self.blends, hasher);
        bytes(&self.plastics, hasher);
        bytes(&self.principleds, hasher);
        bytes(&self.layereds, hasher);
        bytes(&self.compensations, hasher);
        bytes(&self.textures, hasher);
        self.images.iter().for_each(|image| image.bytes().hash(hasher));
        bytes(&self.tables, hasher);
        bytes(&self.lights, hasher);
        bytes(&self.light_tree.nodes, hasher);
        self.environment.iter().for_each(|environment| bytes(&environment.table, hasher));
        // What has no fixed layout, by its text.
        let rest = (&self.cameras, &self.film, &self.technique, &self.background, &self.instances);
        format!("{rest:?} {} {}", self.background_probability, self.table_probability).hash(hasher);
    }
}
