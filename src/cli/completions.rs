//! `lumbre completions`: what a shell needs to complete commands, options and their values.

use clap::Args;
use clap_complete::Shell;

use lumbre::error::Result;

use super::known::command;
use super::output::print;

#[derive(Args)]
pub(super) struct CompletionsArgs {
    /// The shell; `make install` puts the completions of bash, zsh and fish where these look for them
    shell: Shell,
}

pub(super) fn run(args: &CompletionsArgs) -> Result<()> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut command(), "lumbre", &mut script);
    print(String::from_utf8_lossy(&script).trim_end());
    Ok(())
}
