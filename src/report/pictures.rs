//! The pictures of a page, each in it once, however often it is shown.

use std::collections::HashMap;
use std::path::Path;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use image::ImageDecoder;

use super::html::escape;
use crate::bench::results::{Results, Row};
use crate::error::{Error, Result};

/// Pictures up to this width are shown with visible pixels when enlarged; larger ones are mostly made smaller.
const PIXELATED: u32 = 400;

/// The pictures of a page.
#[derive(Default)]
pub struct Pictures {
    list: Vec<Picture>,
    by_name: HashMap<String, usize>,
}

struct Picture {
    width: u32,
    height: u32,
    base64: String,
}

impl Pictures {
    /// Those that a bench's results name, from its folder.
    pub fn read(folder: &Path, results: &Results) -> Result<Self> {
        let mut pictures = Self::default();
        for scene in &results.scenes {
            for name in [Some(&scene.reference.picture), scene.reference.difference_map.as_ref()].into_iter().flatten()
            {
                pictures.add(folder, name)?;
            }
            let cells = scene.equal_time.iter().chain(&scene.equal_spp).flat_map(|Row { cells, .. }| cells);
            for cell in cells {
                for name in [&cell.picture, &cell.crop, &cell.heat_map] {
                    pictures.add(folder, name)?;
                }
            }
        }
        Ok(pictures)
    }

    fn add(&mut self, folder: &Path, name: &str) -> Result<()> {
        if self.by_name.contains_key(name) {
            return Ok(());
        }
        let path = folder.join(name);
        let bytes = std::fs::read(&path).map_err(|error| Error::read(&path, error))?;
        let (width, height) = image::codecs::png::PngDecoder::new(std::io::Cursor::new(&bytes))
            .map_err(|error| {
                Error::read(&path, format!("the pictures of a report are PNG files, and this is none ({error})"))
            })?
            .dimensions();
        self.insert(name, (width, height), &bytes);
        Ok(())
    }

    /// Takes a PNG file of that size; the first one of a name stays.
    pub fn insert(&mut self, name: &str, (width, height): (u32, u32), png: &[u8]) {
        if !self.by_name.contains_key(name) {
            self.by_name.insert(name.to_owned(), self.list.len());
            self.list.push(Picture { width, height, base64: STANDARD.encode(png) });
        }
    }

    /// The id of a picture's element in the page, which its script looks up.
    pub fn id(&self, name: &str) -> String {
        format!("picture-{}", self.by_name.get(name).copied().unwrap_or(usize::MAX))
    }

    /// An element that shows a picture, with a text for those who do not see it.
    pub fn show(&self, name: &str, text: &str) -> String {
        let Some(Picture { width, height, .. }) = self.by_name.get(name).and_then(|index| self.list.get(*index)) else {
            return String::new();
        };
        let pixelated = if *width <= PIXELATED { " pixelated" } else { "" };
        format!(
            "<svg class=\"picture{pixelated}\" viewBox=\"0 0 {width} {height}\" role=\"img\" aria-label=\"{}\">\
             <use href=\"#{}\"/></svg>",
            escape(text),
            self.id(name)
        )
    }

    /// The element that holds them all, itself invisible.
    pub fn store(&self) -> String {
        let images = self.list.iter().enumerate().map(|(index, Picture { width, height, base64 })| {
            format!(
                "<image id=\"picture-{index}\" width=\"{width}\" height=\"{height}\" \
                 href=\"data:image/png;base64,{base64}\"/>\n"
            )
        });
        format!(
            "<svg class=\"store\" width=\"0\" height=\"0\" aria-hidden=\"true\"><defs>\n{}</defs></svg>\n",
            images.collect::<String>()
        )
    }
}
