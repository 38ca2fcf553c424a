//! `lumbre man`: the manual pages, one of the program and one of each subcommand.

use std::path::PathBuf;

use clap::Args;
use clap_mangen::Man;
use clap_mangen::roff::{Roff, bold, roman};

use lumbre::error::{Error, Result};
use lumbre::files::{check_folder_name, replace_by};

use super::known::command;

/// The page with the examples.
const PAGE: &str = include_str!("../../docs/command_line.md");

#[derive(Args)]
pub(super) struct ManArgs {
    /// Folder for the pages: lumbre.1, lumbre-render.1 and so on
    #[arg(value_name = "DIR")]
    folder: PathBuf,
}

pub(super) fn run(args: &ManArgs) -> Result<()> {
    check_folder_name(&args.folder)?;
    std::fs::create_dir_all(&args.folder).map_err(|error| Error::write(&args.folder, error))?;
    for (name, page) in pages().map_err(|error| Error::write(&args.folder, error))? {
        replace_by(&args.folder.join(name), &page)?;
    }
    Ok(())
}

/// The name of each page's file, and the page.
fn pages() -> std::io::Result<Vec<(String, Vec<u8>)>> {
    let brief = |subcommand: clap::Command| {
        subcommand.mut_args(|argument| {
            // A list that stands in the text already is not written again.
            let text = argument.get_help().map(ToString::to_string).unwrap_or_default();
            let told = argument.get_possible_values().iter().all(|value| text.contains(value.get_name()));
            argument.hide_possible_values(told)
        })
    };
    let mut whole = command().disable_help_subcommand(true).mut_subcommands(brief);
    whole.build();
    let source = format!("lumbre {}", env!("CARGO_PKG_VERSION"));
    let page = |command: &clap::Command| {
        let man = Man::new(command.clone()).source(&source).manual("lumbre");
        let mut text = Vec::new();
        man.render(&mut text)?;
        std::io::Result::Ok((man.get_filename(), text))
    };
    let mut pages = vec![page(&whole)?];
    ends(&whole).to_writer(&mut pages[0].1)?;
    for subcommand in whole.get_subcommands() {
        pages.push(page(subcommand)?);
    }
    Ok(pages)
}

/// What ends the page of the program: the exit status, examples, and the other pages.
fn ends(command: &clap::Command) -> Roff {
    let mut roff = Roff::new();
    roff.control("SH", ["EXIT STATUS"]);
    for (status, meaning) in [("0", "done"), ("1", "the work failed"), ("2", "the command or the scene is wrong")] {
        roff.control("TP", []).text([bold(status)]).text([roman(meaning)]);
    }
    roff.control("SH", ["EXAMPLES"]);
    roff.control("nf", []);
    examples().for_each(|line| {
        roff.text([roman(line)]);
    });
    roff.control("fi", []);
    roff.control("SH", ["SEE ALSO"]);
    let pages = command.get_subcommands().map(|own| format!("lumbre-{}(1)", own.get_name()));
    roff.text([roman(pages.collect::<Vec<_>>().join(", "))]);
    roff
}

/// The commands that docs/command_line.md gives as examples.
fn examples() -> impl Iterator<Item = &'static str> {
    let block = PAGE.split("```sh\n").nth(1).unwrap_or_default();
    block.lines().take_while(|line| *line != "```")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_page_has_examples() {
        assert!(examples().count() > 5 && examples().all(|line| line.starts_with("lumbre ")));
    }
}
