//! Metropolis light transport: Markov chains on the device.

mod chains;

pub use chains::Chains;
pub(super) use chains::MarkovChains;
