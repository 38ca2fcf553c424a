//! What a checkpoint belongs to: all that the bits of its image depend on.

use std::hash::{DefaultHasher, Hasher};

use serde::{Deserialize, Serialize};

use crate::error::all_of;
use crate::gpu::Gpu;
use crate::render::{Settings, kernels_fingerprint};
use crate::scene::Scene;
use crate::techniques::Strategies;

/// The entry that says which share of the samples it is.
const SHARD: &str = "shard";

/// The entries that say on what it was rendered.
const MACHINE: [&str; 2] = ["device", "driver"];

/// Names and values of what the bits of an image depend on, besides the number of samples.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Identity(Vec<(String, String)>);

impl Identity {
    /// Of a rendering of this scene with these settings on that device.
    pub fn of(scene: &Scene, settings: &Settings, gpu: &Gpu) -> Self {
        let mut hasher = DefaultHasher::new();
        scene.hash_content(&mut hasher);
        let survey = gpu.survey();
        // Without `..`: a new setting does not compile until it is listed below, or left out with the reason why.
        let Settings {
            technique,
            backend,
            width,
            height,
            filter,
            camera,
            max_depth,
            rr_depth,
            sampler,
            seed,
            shard,
            lengths,
            strategies,
            aovs: _, // made anew once the image is there, whose bits they do not change
            specialise,
            driver_specialises,
            arithmetic,
            expected_samples: _, // the checkpoint's header keeps it, and what goes on takes it from there
            records: _,          // what is told of the paths changes none of them
            chunk,
        } = settings;
        let camera = camera.as_ref().map_or(String::from("the first"), |name| format!("'{name}'"));
        let depth = max_depth.map_or(String::from("none"), |depth| depth.to_string());
        // Whether there is a lens is the camera's, and so the scene's.
        let by_strategy = strategies.map_or(0, |Strategies { longest, lens: _ }| longest);
        let entries = [
            ("scene", format!("{:016x}", hasher.finish())),
            ("technique", technique.full()),
            ("size", format!("{width}x{height}")),
            ("seed", seed.to_string()),
            ("backend", backend.name().to_owned()),
            ("camera", camera),
            ("longest path", depth),
            ("roulette from segment", rr_depth.to_string()),
            ("sampler", sampler.name().to_owned()),
            ("filter", format!("{filter:?}")),
            ("layers by length", lengths.to_string()),
            ("layers by strategy", by_strategy.to_string()),
            ("specialised", specialise.to_string()),
            // The same bits by intent, and in tests; but a driver is free to regroup sums otherwise.
            ("specialised by the driver", driver_specialises.to_string()),
            ("arithmetic", format!("{arithmetic:?}")),
            (SHARD, shard.map_or(String::from("none"), |shard| format!("{shard} of {} samples", shard.samples))),
            ("chunk", chunk.to_string()),
            ("device", survey.name.clone()),
            ("driver", survey.driver.clone()),
            ("lumbre", env!("CARGO_PKG_VERSION").to_owned()),
            ("kernels", format!("{:016x}", kernels_fingerprint())),
        ];
        Self(entries.into_iter().map(|(name, value)| (name.to_owned(), value)).collect())
    }

    /// The same as if it were rendered on no device in particular.
    pub fn anywhere(mut self) -> Self {
        self.0.retain(|(name, _)| !MACHINE.contains(&name.as_str()));
        self
    }

    /// That of the rendering that a shard is a part of.
    pub fn whole(mut self) -> Self {
        self.0.iter_mut().filter(|(name, _)| name == SHARD).for_each(|(_, value)| *value = String::from("none"));
        self
    }

    /// What differs from `asked`, each with both values; nothing where all is the same.
    pub fn differs(&self, asked: &Self) -> Option<String> {
        self.differs_from(asked, ["there", "asked for"])
    }

    /// What differs from `asked`, each with both values and the words for where they are; nothing where all is the same.
    pub fn differs_from(&self, asked: &Self, [here, there]: [&str; 2]) -> Option<String> {
        let value = |of: &Self, name: &str| of.0.iter().find(|(key, _)| key == name).map(|(_, value)| value.clone());
        let names = self.0.iter().chain(&asked.0).map(|(name, _)| name);
        let mut different: Vec<String> = Vec::new();
        for name in names {
            let (own, other) = (value(self, name), value(asked, name));
            let [own_text, other_text] = [&own, &other].map(|value| value.as_deref().unwrap_or("nothing"));
            let text = format!("{name} ({own_text} {here}, {other_text} {there})");
            if own != other && !different.contains(&text) {
                different.push(text);
            }
        }
        (!different.is_empty()).then(|| all_of(different))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_differs_is_named_once() {
        let of = |entries: &[(&str, &str)]| {
            Identity(entries.iter().map(|(name, value)| (String::from(*name), String::from(*value))).collect())
        };
        let (a, b) = (of(&[("seed", "1"), ("size", "8x8")]), of(&[("seed", "2"), ("size", "8x8"), ("new", "3")]));
        assert_eq!(a.differs(&a), None);
        let text = a.differs(&b).unwrap();
        assert_eq!(text, "seed (1 there, 2 asked for) and new (nothing there, 3 asked for)");
    }
}
