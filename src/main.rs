//! The command line: `lumbre help` lists what it can do.

mod cli;

fn main() -> std::process::ExitCode {
    std::process::ExitCode::from(cli::main())
}
