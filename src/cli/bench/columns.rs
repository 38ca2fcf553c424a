//! The columns of a bench: techniques x backends, and once more with each ablation.

use std::collections::HashSet;

use lumbre::bench::{Lumbre, Variant};
use lumbre::error::{Error, Result, one_of};
use lumbre::gpu::Gpu;
use lumbre::layout::backend::Backend;
use lumbre::render::{Settings, Technique};
use lumbre::scene::{LightSelection, Scene};
use lumbre::techniques::{Bias, Sampler, Solves};

use super::entry::Entry;

/// Something that is changed to see what it buys.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Ablation {
    NoSpecialise,
    Lights(LightSelection),
    Sampler(Sampler),
}

/// Every ablation, by its name on the command line.
const ABLATIONS: [(&str, Ablation); 4] = [
    ("no-specialise", Ablation::NoSpecialise),
    ("lights=power", Ablation::Lights(LightSelection::Power)),
    ("lights=tree", Ablation::Lights(LightSelection::Tree)),
    ("sampler=independent", Ablation::Sampler(Sampler::Independent)),
];

pub(super) fn parse_ablations(names: &[String]) -> Result<Vec<(&'static str, Ablation)>> {
    let find = |name: &String| {
        ABLATIONS.iter().find(|(known, _)| known == name).copied().ok_or_else(|| {
            Error::Usage(format!("no ablation '{name}': valid are {}", one_of(ABLATIONS.map(|(known, _)| known))))
        })
    };
    names.iter().map(find).collect()
}

/// One column.
#[derive(Clone, Debug)]
pub(super) struct Column {
    pub name: String,
    technique: Technique,
    backend: Backend,
    ablation: Option<(&'static str, Ablation)>,
}

impl Column {
    /// All columns; two of the same name get numbers.
    pub fn all(
        techniques: &[Technique],
        backends: &[String],
        ablations: &[(&'static str, Ablation)],
        gpu: &Gpu,
    ) -> Result<Vec<Self>> {
        let backends = backends.iter().map(|name| gpu.backend(Some(name))).collect::<Result<Vec<_>>>()?;
        let mut names = HashSet::new();
        let mut all = Vec::new();
        for technique in techniques {
            for backend in &backends {
                // Where there is one sampler only, an ablation of it is the technique once more.
                let changes = |ablation: &(&'static str, Ablation)| {
                    !matches!(ablation.1, Ablation::Sampler(_)) || technique.row.samplers().len() > 1
                };
                let ablations = ablations.iter().copied().filter(changes).map(Some);
                for ablation in std::iter::once(None).chain(ablations) {
                    let option = ablation.map_or(String::new(), |(name, _)| format!(", {name}"));
                    let plain = format!("{} on {}{option}", technique.describe(), backend.name());
                    let name = (1..).map(|n| if n == 1 { plain.clone() } else { format!("{plain} #{n}") });
                    let name = name.into_iter().find(|name| names.insert(name.clone())).unwrap_or_default();
                    all.push(Self { name, technique: technique.clone(), backend: *backend, ablation });
                }
            }
        }
        Ok(all)
    }

    /// The column for a scene; `reload` reads the scene anew with another selection of lights.
    pub fn variant(
        &self,
        gpu: &Gpu,
        entry: &Entry,
        reload: &dyn Fn(LightSelection) -> Result<Scene>,
    ) -> Result<Variant> {
        let row = self.technique.row;
        let mut settings = Settings {
            backend: self.backend,
            rr_depth: entry.scene.technique.rr_depth.unwrap_or(row.rr_depth),
            ..entry.settings.for_technique(self.technique.clone())
        };
        let mut options = Vec::new();
        let mut scene = None;
        if let Some((name, ablation)) = self.ablation {
            options.push(name.to_owned());
            match ablation {
                Ablation::NoSpecialise => settings.specialise = false,
                Ablation::Sampler(sampler) => settings.sampler = sampler,
                Ablation::Lights(how) => scene = Some(reload(how)?),
            }
        }
        let subject = Lumbre::new(gpu, scene.as_ref().unwrap_or(&entry.scene), &settings, entry.load)?;
        Ok(Variant {
            name: self.name.clone(),
            technique: self.technique.describe(),
            backend: self.backend.name().to_owned(),
            options,
            bias: bias(&self.technique, entry),
            subject: Box::new(subject),
        })
    }
}

/// What the image of a technique lacks against the reference; empty where it lacks nothing.
fn bias(technique: &Technique, entry: &Entry) -> String {
    let row = technique.row;
    let mut all = Vec::new();
    if let Bias::Biased(why) | Bias::Consistent(why) = row.bias {
        all.push(why.to_owned());
    }
    for parameter in row.parameters {
        let chosen = parameter.biased.filter(|(value, _)| technique.value(parameter.name) == Some(value));
        all.extend(chosen.map(|(_, why)| why.to_owned()));
    }
    if row.solves < entry.solves {
        all.push(format!("accounts for {} only", row.solves.what()));
    }
    all.extend(technique.misses(&entry.scene).map(|missed| format!("does not find {missed}")));
    all.join("; ")
}

/// The light that a reference of these techniques' images is to have: all that any of them accounts for.
pub(super) fn wanted_light(techniques: &[Technique]) -> Solves {
    techniques.iter().map(|technique| technique.row.solves).max().unwrap_or(Solves::Everything)
}
