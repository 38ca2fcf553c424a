//! What a checkpoint belongs to: all that the bits of its image depend on.

use std::hash::{DefaultHasher, Hasher};

use serde::{Deserialize, Serialize};

use crate::error::all_of;
use crate::gpu::Gpu;
use crate::render::{Settings, kernels_fingerprint};
use crate::scene::Scene;

/// Names and values of what the bits of an image depend on, besides the number of samples.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Identity(Vec<(String, String)>);

impl Identity {
    /// Of a rendering of this scene with these settings on that device.
    pub fn of(scene: &Scene, settings: &Settings, gpu: &Gpu) -> Self {
        let mut hasher = DefaultHasher::new();
        scene.hash_content(&mut hasher);
        let survey = gpu.survey();
        let Settings { technique, backend, width, height, filter, camera, max_depth, rr_depth, .. } = settings;
        let Settings { sampler, seed, lengths, strategies, specialise, arithmetic, chunk, .. } = settings;
        let depth = max_depth.map_or(String::from("none"), |depth| depth.to_string());
        let entries = [
            ("scene", format!("{:016x}", hasher.finish())),
            ("technique", technique.full()),
            ("size", format!("{width}x{height}")),
            ("seed", seed.to_string()),
            ("backend", backend.name().to_owned()),
            ("camera", camera.clone().unwrap_or_else(|| String::from("the first"))),
            ("longest path", depth),
            ("roulette from segment", rr_depth.to_string()),
            ("sampler", sampler.name().to_owned()),
            ("filter", format!("{filter:?}")),
            ("layers by length", lengths.to_string()),
            ("layers by strategy", strategies.map_or(0, |strategies| strategies.longest).to_string()),
            ("specialised", specialise.to_string()),
            ("arithmetic", format!("{arithmetic:?}")),
            ("chunk", chunk.to_string()),
            ("device", survey.name.clone()),
            ("driver", survey.driver.clone()),
            ("lumbre", env!("CARGO_PKG_VERSION").to_owned()),
            ("kernels", format!("{:016x}", kernels_fingerprint())),
        ];
        Self(entries.into_iter().map(|(name, value)| (name.to_owned(), value)).collect())
    }

    /// What differs from `asked`, each with both values; nothing where all is the same.
    pub fn differs(&self, asked: &Self) -> Option<String> {
        let value = |of: &Self, name: &str| of.0.iter().find(|(key, _)| key == name).map(|(_, value)| value.clone());
        let names = self.0.iter().chain(&asked.0).map(|(name, _)| name);
        let mut different: Vec<String> = Vec::new();
        for name in names {
            let (own, other) = (value(self, name), value(asked, name));
            let [own_text, other_text] = [&own, &other].map(|value| value.as_deref().unwrap_or("nothing"));
            let text = format!("{name} ({own_text} there, {other_text} asked for)");
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
