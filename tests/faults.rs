//! What goes wrong outside of a rendering that took hours: the disk, the folder, another process, the device. Each is one line that says
//! what, where, what is kept, and how to go on.

use std::path::Path;
use std::process::{Child, Command};
use std::time::Duration;

use crate::common::program::{errors, fails, files, render, signal, start, wait_for, works};
use lumbre::image::read_image;

/// From now on the process may write no file beyond so many bytes: to it the disk is full. (The limit cannot be there from the beginning:
/// lavapipe's memory is a file, too.)
fn fill_disk_of(child: &Child, bytes: u32) {
    let limit = format!("prlimit --pid {} --fsize={bytes}", child.id());
    assert!(Command::new("sh").args(["-c", &limit]).status().unwrap().success(), "{limit}");
}

/// The command without the signal that would end it at that limit.
fn untroubled(command: &Command) -> Command {
    let quoted = |text: &std::ffi::OsStr| format!("'{}'", text.to_str().unwrap());
    let words: Vec<String> = std::iter::once(command.get_program()).chain(command.get_args()).map(quoted).collect();
    let mut shell = Command::new("sh");
    shell.args(["-c", &format!("trap '' XFSZ; exec {}", words.join(" "))]);
    shell.current_dir(command.get_current_dir().unwrap());
    shell
}

/// On a full disk the rendering goes on; what fits is written, what does not leaves the old file whole; the last checkpoint is there.
#[test]
fn a_full_disk_tears_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    works(render(folder, "cornell.xml", "--size 16x16 -n 2 -o a.exr"));
    let old = std::fs::read(folder.join("a.exr")).unwrap();
    let line = "--size 64x64 -n 1000000 -o a.exr -o a.png --checkpoint c --checkpoint-interval 0.05";
    let child = start(untroubled(&render(folder, "cornell.xml", line)));
    wait_for(&folder.join("c.previous"));
    fill_disk_of(&child, 16_000);
    std::thread::sleep(Duration::from_millis(500));
    signal(&child, "TERM");
    let output = child.wait_with_output().unwrap();
    let said = errors(&output);
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.contains("warning: no new checkpoint: cannot write c: "), "{said}");
    assert!(said.contains(" spp is kept, and the rendering goes on"), "{said}");
    let last = said.lines().last().unwrap();
    assert!(last.starts_with("error: cannot write a.exr: ") && last.contains("; c keeps "), "{said}");
    assert!(std::fs::read(folder.join("a.exr")).unwrap() == old, "the old file is torn");
    assert_eq!(read_image(&folder.join("a.png")).unwrap().width, 64, "what fits is written");
    assert_eq!(files(folder), ["a.exr", "a.png", "c", "c.previous"], "nothing is left behind");
    works(render(folder, "cornell.xml", &format!("{line} --resume").replace("1000000", "1")));
    assert_eq!(read_image(&folder.join("a.exr")).unwrap().width, 64);
}

/// Without a checkpoint, an image that cannot be written where it should be goes to the folder for temporary files.
#[test]
fn an_image_that_cannot_be_written_is_kept_elsewhere() {
    let folder = tempfile::tempdir().unwrap();
    let (folder, elsewhere) = (folder.path(), tempfile::tempdir().unwrap());
    std::fs::create_dir(folder.join("gone")).unwrap();
    let mut command = render(folder, "cornell.xml", "--size 16x16 -n 10000000 -o gone/a.exr");
    command.env("TMPDIR", elsewhere.path());
    let child = start(command);
    std::thread::sleep(Duration::from_millis(700));
    std::fs::remove_dir(folder.join("gone")).unwrap();
    std::fs::write(folder.join("gone"), "a file in its place").unwrap();
    signal(&child, "TERM");
    let output = child.wait_with_output().unwrap();
    let said = errors(&output);
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.contains("error: cannot write gone/a.exr: ") && said.contains("; the image is kept in "), "{said}");
    let kept = files(elsewhere.path());
    assert!(kept.len() == 1 && read_image(&elsewhere.path().join(&kept[0])).unwrap().width == 16, "{kept:?}");
}

/// An output folder that goes away is made again.
#[test]
fn a_folder_that_went_away_is_made_again() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    std::fs::create_dir(folder.join("out")).unwrap();
    let line = "--size 16x16 -n 1000000 -o out/a.exr --checkpoint c --checkpoint-interval 0.05";
    let child = start(render(folder, "cornell.xml", line));
    wait_for(&folder.join("c"));
    std::fs::remove_dir(folder.join("out")).unwrap();
    signal(&child, "TERM");
    let output = child.wait_with_output().unwrap();
    assert!(output.status.success(), "{}", errors(&output));
    assert!(errors(&output).contains("warning: the folder out went away and was made again"), "{}", errors(&output));
    assert_eq!(read_image(&folder.join("out/a.exr")).unwrap().width, 16);
}

/// Two processes on one output: the file is one's or the other's, whole. Two on one checkpoint: the second is refused.
#[test]
fn two_processes_do_not_meet() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let both: Vec<_> = [24, 32]
        .map(|size| start(render(folder, "cornell.xml", &format!("--size {size}x{size} -n 64 -o a.exr -o a.png"))))
        .into();
    for child in both {
        let output = child.wait_with_output().unwrap();
        assert!(output.status.success(), "{}", errors(&output));
    }
    let width = read_image(&folder.join("a.exr")).unwrap().width;
    assert!(width == 24 || width == 32);
    assert_eq!(files(folder), ["a.exr", "a.png"]);

    let line = "--size 16x16 -n 1000000 -o b.exr --checkpoint c --checkpoint-interval 0.05";
    let first = start(render(folder, "cornell.xml", line));
    wait_for(&folder.join("c"));
    let said = fails(render(folder, "cornell.xml", line), 2);
    assert!(said.starts_with("error: c is in use: another lumbre writes its checkpoints there"), "{said}");
    signal(&first, "KILL");
    first.wait_with_output().unwrap();
    // The lock went with its process, the file that it was on did not.
    works(render(folder, "cornell.xml", "--size 16x16 -n 1 -o b.exr --checkpoint c --resume"));
    assert!(!folder.join("c.lock").exists());
}

fn with_fault(folder: &Path, fault: &str, args: &str) -> Command {
    let mut command = render(folder, "cornell.xml", args);
    command.env("LUMBRE_FAULT", fault);
    command
}

/// A device that is lost: the pass, the frame, what is kept, and how to go on; and going on works, to the same bits.
#[test]
fn a_lost_device_says_what_is_kept() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let line = "--size 32x32 -n 3000 -o a.exr";
    let said = fails(with_fault(folder, "device-lost@4", line), 1);
    let expected = " was lost during path on bvh: 1024 pixels from slot 0, samples ";
    assert!(said.starts_with("error: the device ") && said.contains(expected), "{said}");
    assert!(said.ends_with("; nothing of the rendering is left; --checkpoint FILE would have kept it"), "{said}");
    let kept = format!("{line} --checkpoint c --checkpoint-interval 0.001 -q");
    let said = fails(with_fault(folder, "device-lost@2", &kept), 1);
    assert!(said.ends_with("; there was no checkpoint yet in c: the rendering begins anew"), "{said}");
    let said = fails(with_fault(folder, "device-lost@5", &kept), 1);
    assert!(
        said.contains("; c keeps ") && said.ends_with(" spp: the same command with --resume goes on from there"),
        "{said}"
    );
    assert_eq!(files(folder), ["c", "c.previous"]);
    works(render(folder, "cornell.xml", &format!("{kept} --resume")));
    works(render(folder, "cornell.xml", "--size 32x32 -n 3000 -o whole.exr"));
    assert!(read_image(&folder.join("a.exr")).unwrap() == read_image(&folder.join("whole.exr")).unwrap());
}

/// Memory that is not there although the driver had promised it: every buffer of a rendering, one after the other.
#[test]
fn exhausted_memory_says_what_would_fit() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let mut refused = Vec::new();
    for at in 1..200 {
        let output =
            with_fault(folder, &format!("out-of-memory@{at}"), "--size 32x32 -n 8 -o a.png -q").output().unwrap();
        let said = errors(&output);
        if output.status.success() {
            break;
        }
        assert_eq!(output.status.code(), Some(1), "{said}");
        assert!(said.starts_with("error: out of device memory: '") && said.lines().count() == 1, "{said}");
        let building = said.contains("; the rendering takes ") && said.contains(" in all, --size 16x16 ");
        assert!(building || said.contains("; nothing of the rendering is left"), "{said}");
        refused.push(said.split('\'').nth(1).unwrap().to_owned());
    }
    for name in ["film", "tally", "scene uniforms", "staging for upload", "staging for readback"] {
        assert!(refused.iter().any(|refused| refused == name), "'{name}' is not among {refused:?}");
    }
    assert!(fails(with_fault(folder, "fire", "-n 1"), 2).contains("LUMBRE_FAULT=fire: valid are device-lost@N"));
}
