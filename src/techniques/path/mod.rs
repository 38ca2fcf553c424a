//! Path tracers: they keep nothing on the device.

pub(super) use super::state::Nothing;
