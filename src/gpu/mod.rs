//! Vulkan: the only home of ash and, but for the library of `denoise`, of `unsafe`.
//!
//! [`Instance`] finds the devices, [`Gpu`] is one of them made ready, and everything that lives on it ([`Buffer`],
//! [`Pipeline`], [`accel`]) holds it alive and frees itself. Handles never leave this module.

pub mod accel;
mod address_space;
mod backends;
mod buffer;
mod commands;
mod device;
mod fault;
mod instance;
mod journal;
mod mesa;
mod omission;
mod pipeline;
mod presenting;
mod queue;
mod submission;
mod survey;
#[cfg(feature = "view")]
pub mod window;

pub use buffer::Buffer;
pub use commands::Commands;
pub use device::{Gpu, Limits};

pub use instance::Instance;
pub use journal::{BufferRecord, CommandRecord, SubmissionRecord};
#[cfg(feature = "view")]
pub use mesa::draw_triangles;
pub use mesa::{compile_quickly, with_the_users_environment};
#[cfg(feature = "hot-reload")]
pub use pipeline::replace_modules;
pub use pipeline::{Bindings, Kernel, Pipeline, module, module_names, modules_fingerprint};
pub use queue::Work;
pub use survey::{DeviceKind, Survey};
