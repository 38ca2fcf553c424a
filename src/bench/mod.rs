//! Speed against error: which technique and backend reaches which error in which time, and how sure that is.
//!
//! [`run`] measures every [`Subject`] of a scene with several seeds, in turn, and keeps each run as a file so that an
//! interrupted bench goes on where it stopped; [`Bench::results`] makes a [`Summary`] of the runs.

pub mod against;
mod measure;
pub mod merge;
pub mod peer;
pub mod results;
mod rows;
pub mod run;
pub mod subject;
mod summary;

pub use crate::reference::Truth;
pub use peer::{Peer, SceneRequest};
pub use run::{Bench, Limits, Variant};
pub use subject::{Lumbre, Snapshot, Stop, Subject};
pub use summary::Summary;
