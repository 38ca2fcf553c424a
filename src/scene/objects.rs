//! Objects: the shapes of a scene as they are placed, each with a number.

use super::Scene;

impl Scene {
    /// For each primitive, the number of its shape within its group, from 0.
    pub(crate) fn shape_numbers(&self) -> Vec<u32> {
        let mut numbers = vec![0; self.primitives.len()];
        let mut next = vec![0; self.groups.len()];
        for shape in &self.shapes {
            numbers[shape.primitives.start as usize..shape.primitives.end as usize].fill(next[shape.group]);
            next[shape.group] += 1;
        }
        numbers
    }

    /// For each instance, how many objects there are in all instances before it.
    pub(crate) fn object_numbers(&self) -> Vec<u32> {
        let mut sizes = vec![0; self.groups.len()];
        self.shapes.iter().for_each(|shape| sizes[shape.group] += 1);
        let mut before = 0;
        let next = |instance: &super::Instance| {
            let own = before;
            before += sizes[instance.group];
            own
        };
        self.instances.iter().map(next).collect()
    }

    /// The name of each object: of object n, the one at n.
    pub fn object_names(&self) -> Vec<&str> {
        let mut names = vec![Vec::new(); self.groups.len()];
        self.shapes.iter().for_each(|shape| names[shape.group].push(shape.name.as_str()));
        self.instances.iter().flat_map(|placed| names[placed.group].iter().copied()).collect()
    }
}
