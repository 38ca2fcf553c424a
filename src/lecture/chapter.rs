//! What a chapter is, and what is said of how it was made.

use super::lab::Lab;
use super::sheet::Sheet;
use super::text::{self, Text};
use crate::bench::results::Device;
use crate::error::Result;
use crate::techniques;

/// A chapter.
pub struct Chapter {
    /// Its name on the command line and within the page.
    pub name: &'static str,
    /// Its title in English and in Spanish.
    pub titles: (&'static str, &'static str),
    /// Techniques that it is about: without one of them in the table, there is no such chapter.
    pub needs: &'static [&'static str],
    /// Renders and writes it.
    pub write: fn(&mut Lab, &mut Sheet) -> Result<()>,
}

impl Chapter {
    /// Its title.
    pub fn title(&self) -> Text {
        text::text(self.titles.0, self.titles.1)
    }

    /// Whether the table has all techniques that it is about.
    pub fn is_there(&self) -> bool {
        self.needs.iter().all(|name| techniques::find(name).is_some())
    }
}

/// Where, when and by what a lecture is made.
pub struct Circumstances {
    /// The program's version.
    pub version: String,
    /// The command.
    pub command: String,
    /// The time.
    pub made: String,
    /// The device and the host.
    pub device: Device,
}
