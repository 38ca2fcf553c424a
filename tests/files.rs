//! Files as Unix has them: links, modes, pipes and devices; standard streams that nobody reads or that have no room; signals that were ignored
//! when the program began; arguments and names that are no plain text.

use std::ffi::OsStr;
use std::io::Read;
use std::os::unix::ffi::OsStrExt;
use std::os::unix::fs::{FileTypeExt, MetadataExt, PermissionsExt, symlink};
use std::path::Path;
use std::process::{Command, Output, Stdio};

use crate::common::program::{self, errors, lumbre, signal, wait_for};
use lumbre::files::{check_writable, replace_file};
use lumbre::image::{read_attribute, read_image};

/// A room of one wall, too simple to take any time.
const WALL: &str = r#"<scene version="3.0.0"><sensor type="perspective"><film type="hdrfilm">
    <integer name="width" value="8"/><integer name="height" value="8"/><rfilter type="box"/></film></sensor>
    <shape type="rectangle"><transform name="to_world"><rotate y="1" angle="180"/><translate z="2"/></transform>
    <bsdf type="diffuse"/></shape><emitter type="constant"/></scene>"#;

fn write(path: &Path, text: &str) -> lumbre::Result<()> {
    check_writable(path)?;
    replace_file(path, |file| file.write_all(text.as_bytes()).map_err(|error| error.to_string()))
}

fn mode(path: &Path) -> u32 {
    path.metadata().unwrap().permissions().mode() & 0o777
}

fn fifo(path: &Path) {
    assert!(Command::new("mkfifo").arg(path).status().unwrap().success());
}

#[test]
fn links_stay_and_modes_are_kept() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    std::fs::create_dir(at("there")).unwrap();
    std::fs::write(at("there/file"), "old").unwrap();
    std::fs::set_permissions(at("there/file"), std::fs::Permissions::from_mode(0o640)).unwrap();
    symlink("there/file", at("link")).unwrap();
    symlink("link", at("link to it")).unwrap();
    symlink("there/new", at("dangling")).unwrap();
    for (name, behind) in [("link to it", "there/file"), ("link", "there/file"), ("dangling", "there/new")] {
        write(&at(name), name).unwrap();
        assert!(at(name).is_symlink(), "{name}");
        assert_eq!(std::fs::read_to_string(at(behind)).unwrap(), name);
    }
    assert_eq!(mode(&at("there/file")), 0o640);
    assert_eq!(program::files(&at("there")), ["file", "new"], "nothing else is left");

    // An owner and a group that are not this process's, where it may give files away.
    if std::os::unix::fs::chown(at("there/file"), Some(4242), Some(4243)).is_ok() {
        write(&at("link"), "given").unwrap();
        let there = at("there/file").metadata().unwrap();
        assert_eq!((there.uid(), there.gid(), mode(&at("there/file"))), (4242, 4243, 0o640));
    }

    symlink("round", at("round")).unwrap();
    symlink("nowhere/file", at("lost")).unwrap();
    for (name, cause) in [
        ("round", "ymbolic link"),
        ("lost", "there is no folder"),
        ("there", "it is a folder"),
        ("x/", "it is a folder"),
    ] {
        let message = check_writable(&at(name)).unwrap_err().to_string();
        assert!(message.contains(cause), "{name}: {message}");
    }
    assert!(check_writable(Path::new("")).unwrap_err().to_string().contains("the name is empty"));
}

#[test]
fn pipes_and_devices_are_written_to() {
    let folder = tempfile::tempdir().unwrap();
    let pipe = folder.path().join("pipe");
    fifo(&pipe);
    // More than a pipe holds at once.
    let text = "0123456789".repeat(20_000);
    let reader = std::thread::spawn({
        let pipe = pipe.clone();
        move || std::fs::read_to_string(pipe).unwrap()
    });
    write(&pipe, &text).unwrap();
    assert!(reader.join().unwrap() == text && pipe.metadata().unwrap().file_type().is_fifo());

    let link = folder.path().join("link");
    symlink("/dev/null", &link).unwrap();
    for name in [Path::new("/dev/null"), &link] {
        write(name, &text).unwrap();
        assert!(Path::new("/dev/null").metadata().unwrap().file_type().is_char_device() && link.is_symlink());
    }
    let message = write(Path::new("/dev/full"), "x").unwrap_err().to_string();
    assert!(message.contains("/dev/full") && message.contains("No space left"), "{message}");
}

/// A file in a folder that takes no new files is written where it is.
#[test]
fn a_file_in_a_closed_folder_is_written_in_place() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("file");
    std::fs::write(&file, "a longer text").unwrap();
    std::fs::set_permissions(folder.path(), std::fs::Permissions::from_mode(0o555)).unwrap();
    let before = file.metadata().unwrap().ino();
    write(&file, "short").unwrap();
    assert_eq!(std::fs::read_to_string(&file).unwrap(), "short");
    // The superuser may make files in any folder.
    let is_closed = std::fs::File::create(folder.path().join("new")).is_err();
    assert!(!is_closed || file.metadata().unwrap().ino() == before);
    std::fs::set_permissions(folder.path(), std::fs::Permissions::from_mode(0o755)).unwrap();
}

/// Runs `lumbre` with these arguments in `folder`, between `before` and `after`, in the shell's words.
fn in_shell(folder: &Path, before: &str, args: &str, after: &str) -> Output {
    let program = lumbre();
    let line = format!("{before} {} {args} {after}", program.get_program().to_str().unwrap());
    let output = Command::new("sh").args(["-c", &line]).current_dir(folder).output().unwrap();
    assert!(!errors(&output).contains("panicked"), "{line}: {}", errors(&output));
    output
}

#[test]
fn rendering_writes_through_links_and_pipes() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    std::fs::create_dir(at("store")).unwrap();
    for (link, file) in [("a.exr", "store/a.exr"), ("c", "store/c"), ("a.json", "store/a.json")] {
        std::fs::write(at(file), "").unwrap();
        std::fs::set_permissions(at(file), std::fs::Permissions::from_mode(0o600)).unwrap();
        symlink(file, at(link)).unwrap();
    }
    fifo(&at("p.png"));
    // A name beyond Latin-1, and a scene from standard input.
    std::fs::write(at("łódź.xml"), WALL).unwrap();
    let outputs = "-n 2 -o a.exr -o p.png -o łódź.exr --json a.json --checkpoint c";
    let output = in_shell(
        folder.path(),
        "cat p.png > p & ",
        &format!("render łódź.xml {outputs}"),
        "; status=$?; wait; exit $status",
    );
    assert!(output.status.success(), "{}", errors(&output));
    for (link, file) in [("a.exr", "store/a.exr"), ("c", "store/c"), ("a.json", "store/a.json")] {
        assert!(at(link).is_symlink() && at(file).metadata().unwrap().len() > 0, "{link}");
        assert_eq!(mode(&at(file)), 0o600, "{file}");
    }
    let png = std::fs::read(at("p")).unwrap();
    assert!(png.starts_with(b"\x89PNG") && at("p.png").metadata().unwrap().file_type().is_fifo());
    assert_eq!(read_attribute(&at("łódź.exr"), "lumbre.scene").unwrap().as_deref(), Some("łódź.xml"));

    let output = in_shell(folder.path(), "", "render --format xml - -n 2 -o -", "< łódź.xml > out.exr");
    assert!(output.status.success(), "{}", errors(&output));
    assert_eq!(
        read_image(&at("out.exr")).unwrap(),
        read_image(&at("a.exr")).unwrap(),
        "and nothing else on standard output"
    );
}

#[test]
fn standard_streams_may_be_closed_or_full() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("wall.xml"), WALL).unwrap();
    for args in ["list", "--help", "list --help", "info wall.xml --json -", "info wall.xml"] {
        let output = in_shell(folder.path(), "", args, "> /dev/full");
        let said = errors(&output);
        assert!(
            output.status.code() == Some(1) && said.contains("error: cannot write standard output"),
            "{args}: {said}"
        );
        let output = in_shell(folder.path(), "", args, "> /dev/full 2> /dev/full");
        assert_eq!(output.status.code(), Some(1), "{args}");
    }
    for (args, after, status) in [
        ("list", ">&-", 0),
        ("info wall.xml --json nowhere/a.json", "2>&-", 2),
        ("info wall.xml --json nowhere/a.json", "2> /dev/full", 2),
        ("nothing", "> /dev/full 2> /dev/full", 2),
        ("compare", "2> /dev/full", 2),
    ] {
        assert_eq!(in_shell(folder.path(), "", args, after).status.code(), Some(status), "{args} {after}");
    }
    // A reader that goes away is no error.
    let mut command = lumbre();
    let mut child = command.arg("list").stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    drop(child.stdout.take());
    let mut said = String::new();
    child.stderr.take().unwrap().read_to_string(&mut said).unwrap();
    assert!(child.wait().unwrap().success() && said.is_empty(), "{said}");
}

#[test]
fn no_argument_makes_a_panic() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("wall.xml"), WALL).unwrap();
    let odd = OsStr::from_bytes(b"\xff.xml");
    std::fs::write(folder.path().join(odd), WALL).unwrap();
    let refused = |args: &[&OsStr]| {
        let output = lumbre().args(args).current_dir(folder.path()).output().unwrap();
        let said = errors(&output);
        assert!(!said.contains("panicked") && said.contains("error: "), "{args:?}: {said}");
        assert_eq!(output.status.code(), Some(2), "{args:?}: {said}");
    };
    refused(&[OsStr::from_bytes(b"\xfe")]);
    refused(&[OsStr::new("info"), OsStr::from_bytes(b"\xfe.xml")]);
    refused(&[OsStr::new("info"), odd, OsStr::new("-D"), OsStr::from_bytes(b"a=\xff")]);
    for line in [
        "info|",
        "info|-",
        "info|wall.xml|--format|",
        "info|wall.xml|--json|",
        "info|wall.xml|--size|99999999999999999999x1",
        "render|wall.xml|-o|",
        "render|wall.xml|-o|a.exr/",
        "render|wall.xml|-n|99999999999999999999",
        "render|wall.xml|-t|1e999",
        "render|wall.xml|--camera|",
        "render|wall.xml|--checkpoint|/dev/null",
        "render|wall.xml|--checkpoint|c|--checkpoint-interval|-1",
        "render|wall.xml|-i|",
        "render|wall.xml|-D|",
        "compare||",
    ] {
        refused(&line.split('|').map(OsStr::new).collect::<Vec<_>>());
    }
    // Names that are not UTF-8 are names, and the largest numbers are numbers.
    let line = "-n|1|--max-depth|4294967294|--rr-depth|4294967295|--seed|4294967295|--checkpoint|c|--checkpoint-interval|1e300|-o|a.exr";
    let output = lumbre().arg("render").arg(odd).args(line.split('|')).current_dir(folder.path()).output().unwrap();
    assert!(output.status.success(), "{}", errors(&output));
}

/// Drivers crash or hang where they get no more address space: there is a message before that.
#[test]
fn a_limit_on_address_space_is_a_message() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("wall.xml"), WALL).unwrap();
    for kibibytes in [300_000, 500_000, 900_000] {
        let limit = format!("ulimit -v {kibibytes};");
        let output = in_shell(folder.path(), &limit, "render wall.xml -n 1 -o a.exr", "");
        let said = errors(&output);
        assert!(output.status.code() == Some(1) && said.contains("error: "), "{kibibytes}: {said}");
        assert!(said.contains("address space (ulimit -v)"), "{said}");
    }
}

#[test]
fn an_ignored_signal_stays_ignored() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("wall.xml"), WALL).unwrap();
    let program = lumbre();
    let line = format!(
        "trap '' HUP INT; exec {} render wall.xml -t 600 -o a.exr --checkpoint c --checkpoint-interval 0.01",
        program.get_program().to_str().unwrap()
    );
    let mut command = Command::new("sh");
    command.args(["-c", &line]).current_dir(folder.path());
    let child = program::start(command);
    wait_for(&folder.path().join("c"));
    signal(&child, "HUP");
    signal(&child, "INT");
    // The first that counts: a second one would end it at once, with another status and without an image.
    signal(&child, "TERM");
    let output = child.wait_with_output().unwrap();
    assert!(output.status.success(), "{}", errors(&output));
    assert!(String::from_utf8_lossy(&output.stdout).contains("interrupted"));
    read_image(&folder.path().join("a.exr")).unwrap();
}
