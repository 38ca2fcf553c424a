//! The report of a bench: one page that needs nothing but itself, and the curves as a table for other programs.
//!
//! The page is well-formed as XML too, so that a test can parse it; every text from outside passes `html::escape`.

pub(crate) mod chart;
mod csv;
mod figures;
pub mod html;
pub(crate) mod number;
mod page;
pub(crate) mod pictures;
mod reference;
mod rows;
mod scale;
mod scene;
mod summary;

use std::path::Path;

use crate::bench::results::Results;
use crate::error::{Error, Result};
use crate::files::replace_by;
use pictures::Pictures;

/// Writes `index.html` and `results.csv` into the folder of a bench.
///
/// The page holds the pictures that the results name, the results themselves and all its style and script: it can be
/// sent as one file. The columns of the table are those of [`CSV_COLUMNS`].
///
/// # Errors
///
/// A picture that is missing or that is not a PNG file, a folder that cannot be written to.
pub fn write(folder: &Path, results: &Results) -> Result<()> {
    let page_file = folder.join("index.html");
    let pictures = Pictures::read(folder, results)?;
    let table = csv::table(results);
    let json = serde_json::to_string(results).map_err(|error| Error::write(&page_file, error))?;
    let csv = serde_json::to_string(&table).map_err(|error| Error::write(&page_file, error))?;
    let page = page::page(results, &pictures, &json, &csv);
    save(&folder.join("results.csv"), &table)?;
    save(&page_file, &page)
}

pub use csv::COLUMNS as CSV_COLUMNS;

fn save(path: &Path, text: &str) -> Result<()> {
    replace_by(path, text.as_bytes())
}
