//! What the command line is told to shells and manual pages: the command with the values that its options take.

use clap::builder::PossibleValuesParser;

use lumbre::layout::backend::BACKENDS;
use lumbre::lecture::CHAPTERS;
use lumbre::scene::{LightSelection, SceneFormat};
use lumbre::techniques::{SAMPLERS, TECHNIQUES};
use lumbre::verify::CASES;

use super::render;

/// An option by its long name without the dashes, and the values that it takes: of techniques their names, which parameters may follow.
type Values = (&'static str, fn() -> Vec<&'static str>);

/// Every option whose values are known, in whichever subcommands it stands.
const VALUES: &[Values] = &[
    ("aov", render::layer_names),
    ("backend", || std::iter::once("auto").chain(BACKENDS.iter().map(|row| row.name)).collect()),
    ("case", || CASES.iter().map(|case| case.name).collect()),
    ("format", || SceneFormat::ALL.iter().map(|(name, _)| *name).collect()),
    ("integrator", || TECHNIQUES.iter().map(|row| row.name).collect()),
    ("lights", || LightSelection::ALL.iter().map(|(name, _)| *name).collect()),
    ("only", || CHAPTERS.iter().map(|chapter| chapter.name).collect()),
    ("sampler", || SAMPLERS.iter().map(|row| row.name).collect()),
];

/// The command with what its options take. It is not what parses: errors about values are the options' own.
pub(super) fn command() -> clap::Command {
    let known = |argument: clap::Arg| {
        let found = VALUES.iter().find(|(option, _)| argument.get_long() == Some(option));
        match found {
            Some((_, values)) => argument.value_parser(PossibleValuesParser::new(values())),
            None => argument,
        }
    };
    super::whole_command().mut_subcommands(|subcommand| subcommand.mut_args(known))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_list_of_values_is_that_of_an_option() {
        let command = command();
        for (option, values) in VALUES {
            let values = values();
            let has_it = |argument: &&clap::Arg| argument.get_long() == Some(option);
            let mut found = command.get_subcommands().filter_map(|own| own.get_arguments().find(has_it)).peekable();
            assert!(found.peek().is_some() && !values.is_empty(), "--{option}");
            for argument in found {
                let told = argument.get_possible_values();
                assert!(
                    told.iter().map(clap::builder::PossibleValue::get_name).eq(values.iter().copied()),
                    "--{option}"
                );
            }
        }
    }
}
