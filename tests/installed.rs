//! Completions that complete, and a manual page of each subcommand.

use std::process::Command;

use lumbre::techniques::TECHNIQUES;

use crate::common::program::{fails, lumbre, works};

/// What bash offers for the last of the words.
fn completed(script: &str, words: &str) -> Vec<String> {
    let ask = format!(
        "{script}\nCOMP_WORDS=({words}); COMP_CWORD=$((${{#COMP_WORDS[@]}} - 1))\n\
         _lumbre lumbre \"${{COMP_WORDS[COMP_CWORD]}}\" \"${{COMP_WORDS[COMP_CWORD - 1]}}\"; echo \"${{COMPREPLY[*]}}\""
    );
    let output = Command::new("bash").args(["--norc", "-c", &ask]).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap().split_whitespace().map(str::to_owned).collect()
}

#[test]
fn bash_completes_commands_options_and_their_values() {
    let output = lumbre().args(["completions", "bash"]).output().unwrap();
    assert!(output.status.success());
    let script = String::from_utf8(output.stdout).unwrap();
    assert_eq!(completed(&script, "lumbre re"), ["render", "reference"]);
    assert_eq!(completed(&script, "lumbre render --driver"), ["--driver-specialises"]);
    assert_eq!(completed(&script, "lumbre bench --backend r"), ["ray-query"]);
    let techniques: Vec<&str> = TECHNIQUES.iter().map(|row| row.name).collect();
    assert_eq!(completed(&script, "lumbre render -i \"\""), techniques);
    for shell in ["zsh", "fish"] {
        let output = lumbre().args(["completions", shell]).output().unwrap();
        let script = String::from_utf8(output.stdout).unwrap();
        assert!(techniques.iter().all(|name| script.contains(name)), "{shell}");
    }
    let mut unknown = lumbre();
    unknown.args(["completions", "cmd"]);
    assert!(fails(unknown, 2).contains("bash"));
}

#[test]
fn every_subcommand_has_a_manual_page() {
    let folder = tempfile::tempdir().unwrap();
    let mut command = lumbre();
    command.args(["man", "new/pages"]).current_dir(folder.path());
    works(command);
    let page = |name: &str| {
        let path = folder.path().join("new/pages").join(format!("{name}.1"));
        std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
    };
    let whole = page("lumbre");
    let help = String::from_utf8(lumbre().arg("--help").output().unwrap().stdout).unwrap();
    let commands = help.split("Commands:").nth(1).unwrap().lines().skip(1).take_while(|line| !line.is_empty());
    let commands: Vec<&str> = commands.filter_map(|line| line.split_whitespace().next()).collect();
    assert!(commands.contains(&"render") && commands.contains(&"man"), "{commands:?}");
    for name in commands.into_iter().filter(|name| *name != "help") {
        assert!(page(&format!("lumbre-{name}")).contains(".SH SYNOPSIS"), "{name}");
        assert!(whole.contains(&format!("lumbre\\-{name}(1)")), "{name}");
    }
    assert!(page("lumbre-render").contains("radiosity") && whole.contains(".SH EXAMPLES\n.nf\nlumbre render"));
}
