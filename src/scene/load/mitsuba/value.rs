//! What a property may hold.

use glam::{DAffine3, DVec3};

use super::spectrum::{Illuminant, Spectrum};
use crate::scene::single;

#[derive(Clone, Debug)]
pub(super) enum Value {
    Float(f64),
    Integer(i64),
    Boolean(bool),
    Text(String),
    Vector(DVec3),
    Rgb([f64; 3]),
    Uniform(f64),
    /// A spectrum's colours; its samples could be many times the text that names their file.
    Spectrum(SpectrumColours),
    Transform(DAffine3),
}

/// A spectrum as linear sRGB.
#[derive(Clone, Copy, Debug)]
pub(super) struct SpectrumColours {
    /// Of what emits.
    pub emission: [f64; 3],
    /// Of what reflects, and of pure numbers.
    pub reflectance: [f64; 3],
}

impl From<Spectrum> for SpectrumColours {
    fn from(spectrum: Spectrum) -> Self {
        Self {
            emission: spectrum.linear_srgb(Illuminant::EqualEnergy),
            reflectance: spectrum.linear_srgb(Illuminant::D65),
        }
    }
}

impl Value {
    /// Fails where single precision cannot hold its numbers; the message says which one.
    pub fn check(&self) -> Result<(), String> {
        match self {
            Self::Float(value) | Self::Uniform(value) => single::check([*value]),
            Self::Vector(value) => single::check(value.to_array()),
            Self::Rgb(rgb) => single::check(*rgb),
            Self::Spectrum(SpectrumColours { emission, reflectance }) => {
                let colours = emission.iter().chain(reflectance).copied();
                single::check(colours).map_err(|message| format!("its colour in linear sRGB: {message}"))
            }
            Self::Transform(map) => {
                single::check(map.to_cols_array()).map_err(|message| format!("an entry of its matrix: {message}"))
            }
            Self::Integer(_) | Self::Boolean(_) | Self::Text(_) => Ok(()),
        }
    }

    /// Its kind, for messages.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Float(_) => "a float",
            Self::Integer(_) => "an integer",
            Self::Boolean(_) => "a boolean",
            Self::Text(_) => "a string",
            Self::Vector(_) => "a point or vector",
            Self::Rgb(_) => "an rgb colour",
            Self::Uniform(_) | Self::Spectrum(_) => "a spectrum",
            Self::Transform(_) => "a transform",
        }
    }
}

/// What a colour stands for, which says how a spectrum becomes one: a uniform spectrum is grey as a reflectance or as an
/// unbounded number (an index of refraction), but as an emission it is equal-energy white.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Colour {
    Reflectance,
    Unbounded,
    Emission,
}
