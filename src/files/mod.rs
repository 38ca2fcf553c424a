//! Files: read within limits, locked, and replaced only when the new one is complete.

mod destination;
pub(crate) mod lock;
mod promise;
mod read;
mod replace;
mod standard_input;

pub(crate) use destination::{file_behind, folder_of, is_stream};
pub use destination::{is_standard_output, same_file};
pub use promise::{check_folder_name, check_promise, promise_of};
pub(crate) use read::{DEFLATE_RATIO, FILE_BYTES, open, read_bytes, read_text};
pub(crate) use replace::inherit;
pub use replace::{WriteSeek, check_writable, replace_by, replace_file};
pub use standard_input::STANDARD_INPUT;
pub(crate) use standard_input::take_standard_input;
