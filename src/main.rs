//! The command line: `lumbre help` lists what it can do.

#![warn(clippy::print_stdout, clippy::print_stderr)] // they panic where nobody can read them: `cli::output` does not

mod cli;

fn main() -> std::process::ExitCode {
    std::process::ExitCode::from(cli::main())
}
