//! What `make install` brings besides the program: completions that complete, a manual page of each subcommand, and nothing that stays behind.

use std::path::{Path, PathBuf};
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

/// The files below a folder, by their paths from there.
fn files(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut queue = vec![folder.to_owned()];
    while let Some(next) = queue.pop() {
        for path in std::fs::read_dir(&next).unwrap().map(|entry| entry.unwrap().path()) {
            if path.is_dir() { queue.push(path) } else { found.push(path.strip_prefix(folder).unwrap().to_owned()) }
        }
    }
    found.sort();
    found
}

/// A later version takes the files of the one before away, and uninstalling leaves what others have put there.
#[test]
fn installing_and_uninstalling_leave_nothing_behind() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str| {
        let path = folder.path().join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, "").unwrap();
    };
    for name in ["bin/lumbre", "share/man/man1/lumbre.1", "share/doc/lumbre/scenes/a scene.xml"] {
        write(&format!("first/{name}"));
        write(&format!("prefix/{}", name.replace("lumbre", "other")));
    }
    write("second/bin/lumbre");
    let prefix = folder.path().join("prefix");
    let others = files(&prefix);
    let install = |arguments: &[&str]| {
        let mut command = Command::new(concat!(env!("CARGO_MANIFEST_DIR"), "/packaging/install"));
        command.args(arguments).current_dir(folder.path());
        command
    };
    works(install(&["first", "prefix"]));
    assert_eq!(files(&prefix).len(), others.len() + 4);
    works(install(&["second", "prefix"]));
    let list = Path::new("share/doc/lumbre/FILES");
    let mut now = others.clone();
    now.extend([PathBuf::from("bin/lumbre"), list.to_owned()]);
    now.sort();
    assert_eq!(files(&prefix), now);
    // A list that names what is not lumbre's takes nothing away.
    let path = prefix.join(list);
    let listed = std::fs::read_to_string(&path).unwrap();
    std::fs::write(&path, format!("{listed}bin/other\nshare/doc/lumbre/../other/scenes/a scene.xml\n")).unwrap();
    works(install(&["--remove", "prefix"]));
    assert_eq!(files(&prefix), others);
    assert!(fails(install(&["--remove", "prefix"]), 1).contains("no lumbre is installed below prefix"));
}
