//! A window that Vulkan draws in: its surface, its swapchain, and what is drawn, triangles with textures.
//!
//! Each frame is recorded, submitted, waited for and then presented, like all work of lumbre: nothing of a frame is under way while the next
//! one is made, so whatever becomes of the window can be answered between two frames.

mod painter;
mod presenter;
mod surface;
mod swapchain;
mod texture;

pub use painter::{Mesh, PaintVertex};
pub use presenter::{Presenter, Shown};
pub use surface::{NativeWindow, instance};
pub use texture::TextureChange;
