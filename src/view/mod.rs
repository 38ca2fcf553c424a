//! `lumbre view`: a window that shows a scene while it is rendered.
//!
//! Two threads, each with a device of its own. The [`worker`](Worker) loads scenes, makes kernels and renders; what it is to do is a [`Wanted`],
//! what it has to tell is [`News`] with a [`Picture`] in host memory. The [window](open) draws the last picture and the panel, and writes
//! what the user does into the next [`Wanted`]. So the window answers while kernels compile, and a device that is lost takes down neither
//! the window nor the picture.

mod camera;
mod display;
mod inspect;
mod interface;
mod layer;
mod news;
mod panel;
mod reload;
mod screenshot;
mod state;
mod wanted;
mod window;
mod worker;

pub use camera::Viewpoint;
pub use display::{Curve, Display};
pub use inspect::{Inspection, inspect};
pub use layer::Layer;
pub use news::{Doing, Facts, News, Picture};
pub use wanted::{Choice, Wanted};
pub use window::{Start, open};
pub use worker::Worker;
