//! `lumbre list`: the tables of techniques and samplers, in lines of at most 100 characters.

use lumbre::error::{Result, all_of};
use lumbre::techniques::{Bias, SAMPLERS, TECHNIQUES, TechniqueRow, Values};

use super::print;

/// Where text begins, beside names.
const INDENT: usize = 15;
/// Where it ends.
const WIDTH: usize = 100;

pub(super) fn run() -> Result<()> {
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
    Ok(())
}

/// What the table says of a technique, each with its label.
fn about(row: &TechniqueRow) -> Vec<(&'static str, String)> {
    let bias = match row.bias {
        Bias::Unbiased => String::from("unbiased"),
        Bias::Biased(why) => format!("biased: {why}"),
        Bias::Consistent(why) => format!("consistent: {why}"),
    };
    let mut lines = vec![("solves", row.solves.what().to_owned()), ("bias", bias)];
    if !row.misses.is_empty() {
        lines.push(("misses", all_of(row.misses.iter().map(|missing| missing.what()))));
    }
    if !row.by_chance.is_empty() {
        lines.push(("by chance", all_of(row.by_chance.iter().map(|chance| chance.what()))));
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
