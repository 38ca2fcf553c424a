//! Images that stand for the truth: made by a technique that can find the light, and checked by another one.
//!
//! [`make`] tries every technique that may make a reference of the scene for a moment, lets the best one run with many
//! independent seeds ([`Series`]), and has an independent run of another one look at the result tile by tile ([`Witness`]). What came of
//! it is the [`Certificate`], which stays with the image.

mod cache;
mod candidates;
mod certificate;
mod file;
mod make;
mod parts;
mod pilot;
mod request;
mod runner;
mod series;
mod tails;
mod tiles;
mod truth;
mod witness;
mod work;

pub use cache::{obtain, resume};
pub use candidates::{Candidate, candidates};
pub use certificate::{Certificate, Difference, Maker, OwnError, Pilot, SCHEMA, Witness};
pub use file::{read, read_certificate, write};
pub use make::{check, make};
pub use request::{Budget, Request, Step};
pub use series::Series;
pub use tails::own_error;
pub use tiles::{Tile, TileMean, TileMeans, difference_map};
pub use truth::Truth;
pub use witness::{Kinds, hold_against};
