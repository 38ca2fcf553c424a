//! What chapters share: pictures, captions, figures, and the names that each of them uses.

pub use crate::error::Result;
pub use crate::image::Image;
pub use crate::lecture::chapter::Chapter;
pub use crate::lecture::lab::Lab;
pub use crate::lecture::run::{Compared, Run};
pub use crate::lecture::sheet::{Cell, Sheet};
pub use crate::lecture::text::{Text, same, text};
pub use crate::report::number::{figure, samples};
pub use crate::statistics::Estimate;

use crate::lecture::view;

/// A rendering as a picture: exposed, with the lines below it.
pub fn picture(run: &Run, exposure: f64, title: Text, alt: Text, caption: Vec<Text>) -> Cell {
    image(&run.name, &run.image, exposure, title, alt, caption)
}

/// Any image of linear values as a picture.
pub fn image(name: &str, image: &Image, exposure: f64, title: Text, alt: Text, caption: Vec<Text>) -> Cell {
    Cell { name: name.to_owned(), image: view::exposed(image, exposure), title, alt, caption }
}

/// A figure with what it is.
pub fn of(value: impl std::fmt::Display, unit: &str) -> Text {
    same(format!("<strong>{value}</strong> {unit}"))
}

pub fn relmse(found: &Compared) -> Text {
    of(figure(found.relmse()), "relMSE")
}

pub fn spp(run: &Run) -> Text {
    same(format!("{} spp", samples(run.spp())))
}

pub fn seconds(run: &Run) -> Text {
    same(format!("{} s", figure(run.seconds())))
}

/// What pictures at equal time say below them.
pub fn error_caption(run: &Run, found: &Compared) -> Vec<Text> {
    vec![relmse(found), spp(run), seconds(run)]
}

/// A share as percent with its sign and its standard error.
pub fn percent_off(estimate: Estimate) -> String {
    let error = 100.0 * estimate.variance.sqrt();
    let digits = if error < 0.02 {
        3
    } else if error < 0.2 {
        2
    } else {
        1
    };
    format!("{:+.digits$} ± {error:.digits$} %", 100.0 * estimate.mean).replace('-', "−")
}

/// A mean over another one, less 1; both have errors of their own.
pub fn relative(a: &Estimate, b: &Estimate) -> Estimate {
    let ratio = a.mean / b.mean;
    let variance = ratio * ratio * (a.variance / (a.mean * a.mean) + b.variance / (b.mean * b.mean));
    Estimate { mean: ratio - 1.0, variance }
}

/// The note below pictures that says how they were exposed.
pub fn exposure_note(exposure: f64) -> Text {
    text(format!("Exposure ×{exposure}."), format!("Exposición ×{exposure}."))
}

/// Words between backquotes as code.
pub fn code(source: &str) -> String {
    let parts = source.split('`').enumerate();
    parts.map(|(index, part)| if index % 2 == 1 { format!("<code>{part}</code>") } else { part.to_owned() }).collect()
}
