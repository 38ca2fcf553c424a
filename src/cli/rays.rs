//! `lumbre rays`.

use clap::Args;
use lumbre::error::Result;

#[derive(Args)]
pub(super) struct RaysArgs {}

pub(super) fn run(_: &RaysArgs) -> Result<()> {
    Ok(())
}
