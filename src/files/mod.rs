//! Files: read within limits, locked, and replaced only when the new one is complete.

pub(crate) mod lock;
mod read;
mod replace;

pub(crate) use read::{DEFLATE_RATIO, FILE_BYTES, open, read_bytes, read_text};
pub(crate) use replace::folder_of;
pub use replace::{WriteSeek, check_writable, replace_file};
