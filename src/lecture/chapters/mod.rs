//! The chapters, in the lecture's order.

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
mod prelude;
mod radiosity;
mod roulette;
mod scenes;
mod strategies;

use super::chapter::Chapter;

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
