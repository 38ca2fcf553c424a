//! The images that MTL entries name, with the options before the name.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use super::mtl::file;
use crate::error::{Error, Result};
use crate::image::{Encoding, read_texture};
use crate::scene::SceneBuilder;
use crate::scene::single;
use crate::scene::texture::{Pattern, TextureDescription, Wrap};

/// Of no one channel of an image is meant, but its colour or its luminance.
const ALL: u32 = 4;
/// The channel of an image that masks it.
const ALPHA: u32 = 3;

/// What stands behind a keyword such as `map_Kd`.
#[derive(Clone, Debug, PartialEq)]
struct Reference {
    name: String,
    /// `-s` and `-o`: texture coordinates, v upwards, times the first plus the second.
    scale: [f32; 2],
    offset: [f32; 2],
    /// `-mm`: values times the second plus the first.
    base_gain: [f32; 2],
    /// `-clamp`.
    clamp: bool,
    /// `-imfchan`.
    channel: Option<u32>,
    /// `-bm`.
    bump: f32,
}

/// A texture in the builder.
#[derive(Clone, Copy, Debug)]
pub(super) struct Texture {
    pub index: u32,
    /// Its image has equal channels everywhere.
    pub is_grey: bool,
    /// `-bm`: how high bumps are.
    pub bump: f32,
}

/// What a material takes of an image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Use {
    /// A colour, sRGB.
    Colour,
    /// A number: the luminance.
    Number,
    /// An opacity: the alpha channel where it says something, else the luminance.
    Opacity,
}

/// The images of a file's materials, each decoded once for each encoding.
#[derive(Default)]
pub(super) struct Textures {
    images: HashMap<(PathBuf, Encoding), (usize, bool, bool)>,
}

impl Textures {
    /// Adds the texture that `text` names, in the file `mtl` or beside it; nothing where there is no such file, which a warning says.
    pub fn add(
        &mut self,
        builder: &mut SceneBuilder,
        mtl: &Path,
        what: &str,
        text: &str,
        used: Use,
    ) -> Result<Option<Texture>> {
        let reference = parse(text).map_err(|message| Error::scene(mtl, format!("{what}: {message}")))?;
        let folder = mtl.parent().unwrap_or(Path::new(""));
        let names = [&reference.name, reference.name.split(" #").next().unwrap_or_default()];
        let Some(path) = names.into_iter().find_map(|name| file(folder, name)) else {
            builder.warnings.push(format!("{what}: there is no file '{}', and it is left out", reference.name));
            return Ok(None);
        };
        let encoding = if used == Use::Colour { Encoding::Srgb } else { Encoding::Linear };
        let key = (path, encoding);
        let (image, has_alpha, is_grey) = match self.images.get(&key) {
            Some(known) => *known,
            None => {
                let image = read_texture(&key.0, encoding)?;
                let (has_alpha, is_grey) = (image.texels.has_alpha(), image.texels.is_grey());
                let made = (builder.image(image), has_alpha, is_grey);
                builder.within_limits()?;
                self.images.insert(key, made);
                made
            }
        };
        let ([su, sv], [ou, ov]) = (reference.scale, reference.offset);
        let [base, gain] = reference.base_gain;
        let channel = match used {
            Use::Colour => ALL,
            Use::Opacity if has_alpha => reference.channel.unwrap_or(ALPHA),
            Use::Number | Use::Opacity => reference.channel.unwrap_or(ALL),
        };
        let description = TextureDescription {
            wrap: [if reference.clamp { Wrap::Clamp } else { Wrap::Repeat }; 2],
            channel,
            // v runs downwards here.
            map: [[su, 0.0, ou], [0.0, sv, 1.0 - sv - ov]],
            scale: [gain; 4],
            offset: [base; 4],
            ..TextureDescription::new(Pattern::Image(image))
        };
        Ok(Some(Texture { index: builder.texture(description), is_grey, bump: reference.bump }))
    }
}

/// Takes options and name apart; the message says which number is out of range. Options that change nothing here are skipped: `-blendu`, `-blendv`, `-boost`, `-cc`, `-t`, `-texres`, `-type`.
fn parse(text: &str) -> Result<Reference, String> {
    let mut reference = Reference {
        name: String::new(),
        scale: [1.0; 2],
        offset: [0.0; 2],
        base_gain: [0.0, 1.0],
        clamp: false,
        channel: None,
        bump: 1.0,
    };
    let mut rest = text.trim_ascii();
    while let Some((option, after)) = rest.split_once(|c: char| c.is_ascii_whitespace()) {
        let mut after = after.trim_ascii_start();
        // Up to so many arguments that the test takes; a name is left behind them.
        let mut take = |most: usize, is_one: &dyn Fn(&str) -> bool| {
            let mut taken = Vec::new();
            while taken.len() < most
                && let Some((word, behind)) = after.split_once(|c: char| c.is_ascii_whitespace())
                && is_one(word)
            {
                taken.push(word);
                after = behind.trim_ascii_start();
            }
            taken
        };
        let is_number = |word: &str| word.parse::<f64>().is_ok_and(f64::is_finite);
        let numbers = |words: Vec<&str>| -> Result<Vec<f32>, String> {
            let values: Vec<f64> = words.iter().filter_map(|word| word.parse().ok()).collect();
            single::check(values.iter().copied()).map_err(|message| format!("{option}: {message}"))?;
            Ok(values.into_iter().map(|value| value as f32).collect())
        };
        match option {
            "-s" | "-o" | "-t" => {
                let values = numbers(take(3, &is_number))?;
                let into = match option {
                    "-s" => &mut reference.scale[..],
                    "-o" => &mut reference.offset[..],
                    _ => &mut [],
                };
                into.iter_mut().zip(values).for_each(|(into, value)| *into = value);
            }
            "-mm" => {
                let values = numbers(take(2, &is_number))?;
                reference.base_gain.iter_mut().zip(values).for_each(|(into, value)| *into = value);
            }
            "-bm" => reference.bump = numbers(take(1, &is_number))?.first().copied().unwrap_or(1.0),
            "-boost" | "-texres" => drop(take(1, &is_number)),
            "-clamp" => reference.clamp = take(1, &|_| true) == ["on"],
            "-imfchan" => {
                reference.channel = match take(1, &|_| true)[..] {
                    ["r"] => Some(0),
                    ["g"] => Some(1),
                    ["b"] => Some(2),
                    ["m"] => Some(ALPHA),
                    _ => Some(ALL),
                }
            }
            "-blendu" | "-blendv" | "-cc" | "-type" => drop(take(1, &|_| true)),
            _ => break,
        }
        rest = after;
    }
    reference.name = rest.to_owned();
    Ok(reference)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;

    #[test]
    fn options_stand_before_a_name_that_may_hold_blanks() {
        let plain = parse("brick wall.png").unwrap();
        assert_eq!((plain.name.as_str(), plain.scale, plain.offset), ("brick wall.png", [1.0; 2], [0.0; 2]));
        let all =
            parse("-blendu off -s 2 3 1 -o .5 -mm 0.1 0.8 -clamp on -bm 0.25 -imfchan r -texres 512 maps\\a b.png")
                .unwrap();
        let expected = Reference {
            name: String::from("maps\\a b.png"),
            scale: [2.0, 3.0],
            offset: [0.5, 0.0],
            base_gain: [0.1, 0.8],
            clamp: true,
            channel: Some(0),
            bump: 0.25,
        };
        assert_eq!(all, expected);
        // A name that reads as a number or as an option, and options without their arguments.
        assert_eq!(parse("-s 2 2 2 1").unwrap().name, "1");
        assert_eq!(parse("-cube.png").unwrap().name, "-cube.png");
        assert_eq!(
            (parse("-s a.png").unwrap().name, parse("-clamp").unwrap().name),
            (String::from("a.png"), String::from("-clamp"))
        );
    }
}
