//! Speed against error: which technique and backend reaches which error in which time, and how sure that is.

pub mod results;
pub mod stats;
