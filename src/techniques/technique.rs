//! A technique as it was chosen: a row of the table with values for its parameters.

use super::table::{
    Missing, Parameter, Pass, RareLight, SHADER_PARAMETERS, Solves, TECHNIQUES, TechniqueRow, Values, find,
};
use crate::error::{Error, Result, one_of};
use crate::scene::Scene;

/// Materials that a warning names; of more it says how many there are.
const NAMED: usize = 8;

/// A row of the table with values for its parameters.
#[derive(Clone, Debug)]
pub struct Technique {
    /// The row.
    pub row: &'static TechniqueRow,
    /// One value per parameter of the row, as text.
    values: Vec<String>,
}

impl Technique {
    /// The technique of that name with its default parameters, or with those that follow: `direct:sampling=bsdf`.
    pub fn parse(text: &str) -> Result<Self> {
        let mut parts = text.split(':');
        let name = parts.next().unwrap_or_default();
        let row = find(name).ok_or_else(|| {
            Error::Usage(format!("no technique '{name}': valid are {}", one_of(TECHNIQUES.iter().map(|row| row.name))))
        })?;
        let mut technique =
            Self { row, values: row.parameters.iter().map(|parameter| default_text(&parameter.values)).collect() };
        for part in parts {
            let (name, value) = part.split_once('=').ok_or_else(|| {
                Error::Usage(format!("'{part}' in '{text}': a parameter is written {}:name=value", row.name))
            })?;
            technique.set(name, value)?;
        }
        Ok(technique)
    }

    /// Sets one parameter.
    pub fn set(&mut self, name: &str, value: &str) -> Result<()> {
        let row = self.row;
        let index = row.parameters.iter().position(|parameter| parameter.name == name).ok_or_else(|| {
            let valid = if row.parameters.is_empty() {
                String::from("it has none")
            } else {
                format!("valid are {}", one_of(row.parameters.iter().map(|p| p.name)))
            };
            Error::Usage(format!("technique {} has no parameter '{name}'; {valid}", row.name))
        })?;
        word(&row.parameters[index], value)
            .map_err(|valid| Error::Usage(format!("{}:{name}={value}: valid are {valid}", row.name)))?;
        value.clone_into(&mut self.values[index]);
        Ok(())
    }

    /// The value of a parameter, as text.
    pub fn value(&self, name: &str) -> Option<&str> {
        self.row
            .parameters
            .iter()
            .zip(&self.values)
            .find(|(parameter, _)| parameter.name == name)
            .map(|(_, value)| value.as_str())
    }

    /// The value of a parameter that is a number; its default where the technique has no such parameter.
    pub(super) fn number(&self, parameter: &Parameter) -> f64 {
        let text = self.value(parameter.name).map_or_else(|| default_text(&parameter.values), str::to_owned);
        text.parse().unwrap_or_default() // checked when it was set
    }

    /// Whether a pass of the row takes part.
    pub(super) fn has_pass(&self, pass: &Pass) -> bool {
        self.passes().any(|own| own == pass)
    }

    /// The passes that take part, in order.
    pub(crate) fn passes(&self) -> impl Iterator<Item = &'static Pass> {
        self.row.passes.iter().filter(|pass| pass.with.is_none_or(|(name, value)| self.value(name) == Some(value)))
    }

    /// The specialisation constants `PARAM0` to `PARAM3`.
    pub(crate) fn words(&self) -> [u32; SHADER_PARAMETERS] {
        let mut words = [0; SHADER_PARAMETERS];
        for ((parameter, value), out) in self.row.parameters.iter().zip(&self.values).zip(&mut words) {
            *out = word(parameter, value).unwrap_or_default(); // checked when it was set
        }
        words
    }

    /// The technique that is asked for, else the one that the scene's file asks for, else path tracing, or, where that would leave out
    /// caustics of lights without extent or show them as rare, bright samples, bidirectional path tracing. Fails where the file asks for one that there is not.
    pub fn of_scene(scene: &Scene, asked: Option<Self>) -> Result<Self> {
        match (asked, &scene.technique.integrator) {
            (Some(technique), _) => Ok(technique),
            (None, Some((name, parameters))) => {
                let mut technique = Self::parse(name)?;
                parameters.iter().try_for_each(|(name, value)| technique.set(name, value))?;
                Ok(technique)
            }
            (None, None) => match &scene.technique.refused {
                Some(refused) => Err(Error::Usage(format!("{refused}; -i chooses another technique"))),
                None => {
                    let path = Self::parse("path")?;
                    let suits =
                        !scene.has_delta_lights() || path.misses(scene).is_none() && path.finds_rarely(scene).is_none();
                    if suits { Ok(path) } else { Self::parse("bdpt") }
                }
            },
        }
    }

    /// What the image of this scene lacks against the true one because of what the technique cannot find; nothing where it finds all.
    pub fn misses(&self, scene: &Scene) -> Option<String> {
        let has = |missing: &Missing| match missing {
            Missing::DeltaLights => scene.has_delta_lights(),
            Missing::DeltaCaustics | Missing::HiddenDeltaCaustics => scene.has_delta_lights() && scene.has_smooth(),
            Missing::NotConnectableToCamera => scene.background.is_some() || scene.has_smooth() || scene.has_narrow(),
        };
        let by_value = self.row.parameters.iter().zip(&self.values).flat_map(|(parameter, value)| {
            parameter.misses.iter().filter(move |(with, _)| with == value).map(|(_, missing)| *missing)
        });
        let all: Vec<&str> = self.row.misses.iter().copied().chain(by_value).filter(has).map(Missing::what).collect();
        (!all.is_empty()).then(|| all.join(", and "))
    }

    /// The light of this scene that the technique finds with rare, bright samples alone, in words; nothing where there is none.
    pub fn finds_rarely(&self, scene: &Scene) -> Option<String> {
        let has = |light: &&RareLight| match light {
            RareLight::Caustics | RareLight::HiddenCaustics => scene.has_specular() && scene.has_small_lights(),
            RareLight::Reflections => scene.has_specular(),
            RareLight::GlossyCaustics => scene.has_specular() && scene.has_small_lights() && scene.has_glossy(),
        };
        let all: Vec<&str> = self.row.rare.iter().filter(has).map(|light| light.what()).collect();
        (!all.is_empty()).then(|| all.join(", and "))
    }

    /// The materials of this scene that the technique takes for diffuse ones, though they are not; nothing where there are none.
    pub fn simplifies(&self, scene: &Scene) -> Option<String> {
        let others = if self.row.solves == Solves::Diffuse { scene.not_diffuse() } else { Vec::new() };
        let (named, more) = others.split_at(others.len().min(NAMED));
        let more = if more.is_empty() { String::new() } else { format!(" and {} more", more.len()) };
        (!others.is_empty()).then(|| format!("{}{more}", named.join(", ")))
    }

    /// The name with every parameter.
    pub fn full(&self) -> String {
        let all = self.row.parameters.iter().zip(&self.values);
        all.fold(self.row.name.to_owned(), |text, (parameter, value)| format!("{text}:{}={value}", parameter.name))
    }

    /// The name with every parameter that is not at its default.
    pub fn describe(&self) -> String {
        let changed = self
            .row
            .parameters
            .iter()
            .zip(&self.values)
            .filter(|(parameter, value)| default_text(&parameter.values) != **value);
        changed.fold(self.row.name.to_owned(), |text, (parameter, value)| format!("{text}:{}={value}", parameter.name))
    }
}

fn default_text(values: &Values) -> String {
    match values {
        Values::Choice(words) => words.first().copied().unwrap_or_default().to_owned(),
        Values::Number(_, _, default) => default.to_string(),
    }
}

/// The shader's word for a value, or what would be valid.
fn word(parameter: &Parameter, value: &str) -> Result<u32, String> {
    match parameter.values {
        Values::Choice(words) => {
            words.iter().position(|word| *word == value).map(|index| index as u32).ok_or_else(|| one_of(words))
        }
        Values::Number(low, high, _) => value
            .parse::<f32>()
            .ok()
            .filter(|number| (low..=high).contains(number))
            .map(f32::to_bits)
            .ok_or_else(|| format!("numbers from {low} to {high}")),
    }
}
