//! The chapters, in the lecture's order, and what they share.

mod branching;
mod choice;
mod contest;
mod difficult;
mod direct_global;
mod equation;
mod explicit;
mod lengths;
mod light_tracing;
mod metropolis;
mod photons;
mod radiosity;
mod roulette;
mod scenes;
mod spanish;
mod strategies;

use super::lab::Lab;
use super::run::{Compared, Run};
use super::sheet::{Cell, Sheet};
use super::text::{Text, same, text};
use super::{Chapter, view};
use crate::error::Result;
use crate::image::Image;
use crate::report::number::{figure, samples};
use crate::statistics::Estimate;

/// Every chapter.
pub const CHAPTERS: &[Chapter] = &[
    equation::CHAPTER,
    direct_global::CHAPTER,
    lengths::CHAPTER,
    roulette::CHAPTER,
    explicit::CHAPTER,
    branching::CHAPTER,
    difficult::CHAPTER,
    light_tracing::CHAPTER,
    strategies::CHAPTER,
    metropolis::CHAPTER,
    photons::CHAPTER,
    radiosity::CHAPTER,
    choice::CHAPTER,
];

/// A rendering as a picture: exposed, with the lines below it.
fn picture(run: &Run, exposure: f64, title: Text, alt: Text, caption: Vec<Text>) -> Cell {
    image(&run.name, &run.image, exposure, title, alt, caption)
}

/// Any image of linear values as a picture.
fn image(name: &str, image: &Image, exposure: f64, title: Text, alt: Text, caption: Vec<Text>) -> Cell {
    Cell { name: name.to_owned(), image: view::exposed(image, exposure), title, alt, caption }
}

/// A figure with what it is.
fn of(value: impl std::fmt::Display, unit: &str) -> Text {
    same(format!("<strong>{value}</strong> {unit}"))
}

fn relmse(found: &Compared) -> Text {
    of(figure(found.relmse()), "relMSE")
}

fn spp(run: &Run) -> Text {
    same(format!("{} spp", samples(run.spp())))
}

fn seconds(run: &Run) -> Text {
    same(format!("{} s", figure(run.seconds())))
}

/// What pictures at equal time say below them.
fn error_caption(run: &Run, found: &Compared) -> Vec<Text> {
    vec![relmse(found), spp(run), seconds(run)]
}

/// A share as percent with its sign and its standard error.
fn percent_off(estimate: Estimate) -> String {
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
fn relative(a: &Estimate, b: &Estimate) -> Estimate {
    let ratio = a.mean / b.mean;
    let variance = ratio * ratio * (a.variance / (a.mean * a.mean) + b.variance / (b.mean * b.mean));
    Estimate { mean: ratio - 1.0, variance }
}

/// The note below pictures that says how they were exposed.
fn exposure_note(exposure: f64) -> Text {
    text(format!("Exposure ×{exposure}."), format!("Exposición ×{exposure}."))
}

/// Words between backquotes as code.
fn code(source: &str) -> String {
    let parts = source.split('`').enumerate();
    parts.map(|(index, part)| if index % 2 == 1 { format!("<code>{part}</code>") } else { part.to_owned() }).collect()
}
