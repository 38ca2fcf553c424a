//! `lumbre list`: the tables of techniques and samplers, in lines of at most 100 characters or as Markdown.

use clap::Args;

use lumbre::error::{Result, all_of};
use lumbre::layout::backend::BACKENDS;
use lumbre::techniques::{Bias, Parameter, SAMPLERS, TECHNIQUES, TechniqueRow, Values};

use super::markdown::{Table, code};
use super::output::print;

/// Where text begins, beside names.
const INDENT: usize = 15;
/// Where it ends.
const WIDTH: usize = 100;

#[derive(Args)]
pub(super) struct ListArgs {
    /// Write docs/techniques.md: techniques with their parameters, samplers and backends as Markdown tables
    #[arg(long)]
    markdown: bool,
}

pub(super) fn run(args: &ListArgs) -> Result<()> {
    if args.markdown {
        print(page().trim_end());
    } else {
        plain();
    }
    Ok(())
}

fn plain() {
    for row in TECHNIQUES {
        print(&format!("{:<14} {}", row.name, row.title));
        for (what, text) in about(row) {
            print(&indented(&format!("{what:<10}"), &text));
        }
        for parameter in row.parameters {
            let values = match parameter.values {
                Values::Choice(words) => words.join("|"),
                Values::Number(low, high, default) => format!("{low}..{high}, default {default}"),
            };
            print(&format!("{:INDENT$}:{}={values}", "", parameter.name));
            print(&indented("  ", parameter.about));
        }
    }
    print("samplers");
    for row in SAMPLERS {
        print(&format!("{:<14} {}", row.name, indented("", row.about).trim_start()));
    }
}

fn bias(row: &TechniqueRow) -> String {
    match row.bias {
        Bias::Unbiased => String::from("unbiased"),
        Bias::Biased(why) => format!("biased: {why}"),
        Bias::Consistent(why) => format!("consistent: {why}"),
    }
}

/// The whole of docs/techniques.md.
fn page() -> String {
    let mut text = String::from(
        "# Techniques\n\n\
         `lumbre list --markdown > docs/techniques.md` writes this page from the tables in the code; a test holds them equal. On the command line a\n\
         technique is `-i NAME:parameter=value:parameter=value`; the first value of a choice is its default.\n\n\
         ## What each computes\n\n",
    );
    let none = || String::from("nothing");
    let mut table = Table::new(&[
        "name",
        "technique",
        "accounts for",
        "bias",
        "cannot find, of that",
        "finds with rare, bright samples",
        "shader",
    ]);
    for row in TECHNIQUES {
        let misses = row.misses.iter().map(|missing| missing.what());
        let rare = row.rare.iter().map(|light| light.what());
        table.row(&[
            code(row.name),
            row.title.to_owned(),
            row.solves.what().to_owned(),
            bias(row),
            if row.misses.is_empty() { none() } else { all_of(misses) },
            if row.rare.is_empty() { none() } else { all_of(rare) },
            shader(row.file),
        ]);
    }
    text.push_str(&table.end());
    text.push_str(
        "## What each is good and bad at\n\n\
         Ratios are efficiencies, 1 / (relMSE x seconds), at equal time. They are from [speed against error](speed.md), from\n\
         [paths from the light](light_paths.md) and [on a GPU](gpu.md), and the rest from `make lecture`.\n\n",
    );
    let mut table = Table::new(&["name", "good at", "bad at", "measured"]);
    for row in TECHNIQUES {
        table.row(&[code(row.name), row.good_at.to_owned(), row.bad_at.to_owned(), row.measured.to_owned()]);
    }
    text.push_str(&table.end());
    text.push_str("## Parameters\n\n");
    let mut table = Table::new(&["technique", "parameter", "values", "what it does", "with a value"]);
    for row in TECHNIQUES {
        for parameter in row.parameters {
            table.row(&[
                code(row.name),
                code(parameter.name),
                values(parameter),
                parameter.about.to_owned(),
                consequences(parameter),
            ]);
        }
    }
    text.push_str(&table.end());
    text.push_str("## Samplers\n\n`--sampler` chooses one; the first that a technique can take is its default.\n\n");
    let mut table = Table::new(&["name", "what it is"]);
    for row in SAMPLERS {
        table.row(&[code(row.name), row.about.to_owned()]);
    }
    text.push_str(&table.end());
    text.push_str(
        "## Ray backends\n\n`--backend` chooses one; `auto` takes ray queries on GPUs that have them, and the BVH on processors.\n\n",
    );
    let mut table = Table::new(&["name", "shader"]);
    for row in BACKENDS {
        table.row(&[code(row.name), shader(&format!("trace/{}", row.file))]);
    }
    text.push_str(&table.end());
    text
}

/// A link to a file below `shaders/`.
fn shader(file: &str) -> String {
    format!("[{}](../shaders/{file})", code(file.rsplit('/').next().unwrap_or(file)))
}

/// The values of a parameter for a table.
fn values(parameter: &Parameter) -> String {
    match parameter.values {
        Values::Choice(words) => words.iter().map(|word| code(word)).collect::<Vec<_>>().join(", "),
        Values::Number(low, high, default) => format!("{low} to {high}, default {default}"),
    }
}

/// What the values of a parameter do to the bias and to the light that is found.
fn consequences(parameter: &Parameter) -> String {
    let biased = parameter
        .biased
        .iter()
        .map(|(value, why)| format!("{}: biased, {why}", code(&format!("{}={value}", parameter.name))));
    let misses = parameter
        .misses
        .iter()
        .map(|(value, what)| format!("{}: cannot find {}", code(&format!("{}={value}", parameter.name)), what.what()));
    biased.chain(misses).collect::<Vec<_>>().join("; ")
}

/// What the table says of a technique, each with its label.
fn about(row: &TechniqueRow) -> Vec<(&'static str, String)> {
    let mut lines = vec![("solves", row.solves.what().to_owned()), ("bias", bias(row))];
    if !row.misses.is_empty() {
        lines.push(("misses", all_of(row.misses.iter().map(|missing| missing.what()))));
    }
    if !row.rare.is_empty() {
        lines.push(("rarely", all_of(row.rare.iter().map(|light| light.what()))));
    }
    lines.extend([("good at", row.good_at.to_owned()), ("bad at", row.bad_at.to_owned())]);
    lines.push(("measured", row.measured.replace('`', "")));
    lines
}

/// Text after a label, broken into lines that begin where its first one does.
fn indented(label: &str, text: &str) -> String {
    let begin = INDENT + label.chars().count();
    let mut lines = vec![format!("{:INDENT$}{label}", "")];
    let mut room = WIDTH - begin;
    for word in text.split_whitespace() {
        let length = word.chars().count() + 1;
        if length > room && room < WIDTH - begin {
            lines.push(" ".repeat(begin));
            room = WIDTH - begin;
        }
        if let Some(line) = lines.last_mut() {
            line.push_str(word);
            line.push(' ');
        }
        room = room.saturating_sub(length);
    }
    lines.iter().map(|line| line.trim_end()).collect::<Vec<_>>().join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_break_between_words_and_begin_alike() {
        let text = indented("label  ", &"word ".repeat(40));
        assert!(text.lines().all(|line| line.chars().count() <= WIDTH));
        assert!(text.lines().skip(1).all(|line| line.starts_with(&" ".repeat(INDENT + 7)) && !line.contains("label")));
        assert_eq!(text.matches("word").count(), 40);
    }
}
