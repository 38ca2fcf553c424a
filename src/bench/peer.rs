//! Another renderer in the same bench: a child process that stays alive, spoken to over its standard input and output.
//!
//! Each message is one JSON object on one line; the peer answers each with one line. What it writes to standard error is kept
//! for the message that says why it failed. At any time it may answer `{"error": "one line"}`.
//!
//! | lumbre says | the peer answers |
//! |---|---|
//! | `{"open": {"scene": FILE, "defines": {NAME: VALUE, ...}, "width": W, "height": H, "max_depth": N, "rr_depth": N or null, "folder": FOLDER}}` | `{"renderer": "Mitsuba 3.9.1", "variant": "scalar_rgb", "technique": "path", "setup": {"load": S, "build": S, "compile": S}, "notes": ["..."]}` |
//! | `{"begin": SEED}` | `{"ok": true}` |
//! | `{"advance": {"spp": N, "seconds": T or null}}` | `{"spp": N, "seconds": S, "image": FILE, "nonfinite": N}` |
//!
//! `open` comes once and first. The scene's path is absolute, `defines` are the values of `-D`, `max_depth` is the longest path in
//! segments (-1: no limit), `rr_depth` the length from which on paths may end by chance (null: as the peer is used to), and `folder` is where the peer puts its
//! images. `begin` drops what was rendered and begins a run whose random numbers depend on the seed. `advance` goes on with the
//! run until it has N samples per pixel or has rendered for T seconds, whichever comes first, and writes the mean of all samples since
//! `begin` to an image (EXR, linear). Its `spp` and `seconds` count since `begin` as well; `seconds` are those of rendering alone,
//! writing the image excluded. Standard input ends when the bench does, and so should the peer.

use std::io::{BufRead, BufReader, Read, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStderr, ChildStdin, ChildStdout, Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

use serde::Deserialize;
use serde::de::DeserializeOwned;
use serde_json::{Map, Value, json};
use tempfile::TempDir;

use super::results::Setup;
use super::run::Variant;
use super::subject::{Snapshot, Stop, Subject};
use crate::error::{Error, Result};
use crate::gpu::with_the_users_environment;
use crate::image::read_image;

/// The longest answer that is read, in bytes: whatever a peer prints, it must not fill the memory.
const LONGEST_ANSWER: u64 = 1 << 20;

/// How long a peer that has hung up is waited for, and what it wrote to standard error.
const PATIENCE: Duration = Duration::from_secs(2);

/// What a peer is asked to render.
#[derive(Clone, Debug)]
pub struct SceneRequest {
    /// The scene file.
    pub file: PathBuf,
    /// Parameters of the scene, as `-D` sets them.
    pub defines: Vec<(String, String)>,
    /// Width of the image in pixels.
    pub width: u32,
    /// Height of the image in pixels.
    pub height: u32,
    /// Longest path in segments, -1 for no limit.
    pub max_depth: i64,
    /// Length in segments from which on paths may end by Russian roulette, where the scene says so: otherwise each renderer does as it is used to.
    pub rr_depth: Option<u32>,
}

/// What a peer says of itself.
#[derive(Deserialize)]
struct Opened {
    renderer: String,
    variant: String,
    technique: String,
    #[serde(default)]
    setup: Setup,
    #[serde(default)]
    notes: Vec<String>,
}

/// What a peer says of a run.
#[derive(Deserialize)]
struct Advanced {
    spp: f64,
    seconds: f64,
    image: PathBuf,
    #[serde(default)]
    nonfinite: u64,
}

/// Another renderer, as a process. It is killed when this is dropped.
pub struct Peer {
    line: Line,
    opened: Opened,
    size: (u32, u32),
    /// Samples and seconds of the run so far.
    so_far: (f64, f64),
    /// Where it puts its images.
    folder: TempDir,
}

impl Peer {
    /// Starts the program `command[0]` with its arguments and has it open the scene; its images go to a folder of their own in
    /// `folder`, which is removed in the end.
    pub fn start(command: &[String], scene: &SceneRequest, folder: &Path) -> Result<Self> {
        Self::start_as(&command.join(" "), command, scene, folder)
    }

    /// The column of a bench that `--peer NAME=COMMAND` asks for. The command is split into words as a shell would, and no
    /// shell runs it.
    pub fn variant(text: &str, scene: &SceneRequest, folder: &Path) -> Result<Variant> {
        let (name, command) = parse(text)?;
        let peer = Self::start_as(&name, &command, scene, folder)?;
        Ok(Variant {
            name,
            technique: peer.opened.technique.clone(),
            backend: peer.opened.variant.clone(),
            options: Vec::new(),
            bias: String::new(),
            subject: Box::new(peer),
        })
    }

    fn start_as(name: &str, command: &[String], scene: &SceneRequest, folder: &Path) -> Result<Self> {
        let folder =
            tempfile::Builder::new().prefix("peer-").tempdir_in(folder).map_err(|error| Error::write(folder, error))?;
        let mut line = Line::start(name, command)?;
        let absolute = |path: &Path| std::path::absolute(path).map_err(|error| Error::read(path, error));
        let defines: Map<String, Value> =
            scene.defines.iter().map(|(name, value)| (name.clone(), Value::from(value.as_str()))).collect();
        let request = json!({"open": {
            "scene": absolute(&scene.file)?,
            "defines": defines,
            "width": scene.width,
            "height": scene.height,
            "max_depth": scene.max_depth,
            "rr_depth": scene.rr_depth,
            "folder": absolute(folder.path())?,
        }});
        let opened = line.ask("open", &request)?;
        Ok(Self { line, opened, size: (scene.width, scene.height), so_far: (0.0, 0.0), folder })
    }

    /// Checks that an answer can be: a peer that stands still would be asked for ever.
    fn check(&self, found: &Advanced, stop: Stop) -> Result<()> {
        let (spp, seconds) = self.so_far;
        let wrong = if !(found.spp > 0.0 && found.spp >= spp && found.spp.is_finite()) {
            format!("it has {} samples per pixel after {spp}", found.spp)
        } else if !(found.seconds >= seconds && found.seconds.is_finite()) {
            format!("it has rendered for {} seconds after {seconds}", found.seconds)
        } else if found.spp > f64::from(stop.spp).max(spp) {
            format!("it took {} samples per pixel where {} were asked for", found.spp, stop.spp)
        } else if found.spp < f64::from(stop.spp) && stop.seconds.is_none_or(|limit| found.seconds < limit) {
            format!("it stopped early, at {} samples per pixel and {} seconds", found.spp, found.seconds)
        } else {
            return Ok(());
        };
        Err(self.line.error(wrong))
    }
}

impl Subject for Peer {
    fn renderer(&self) -> String {
        self.opened.renderer.clone()
    }

    fn setup(&self) -> Setup {
        self.opened.setup
    }

    fn device_bytes(&self) -> Option<u64> {
        None
    }

    fn notes(&self) -> Vec<String> {
        self.opened.notes.clone()
    }

    fn begin(&mut self, seed: u32) -> Result<()> {
        #[derive(Deserialize)]
        struct Begun {
            ok: bool,
        }
        self.so_far = (0.0, 0.0);
        let begun: Begun = self.line.ask("begin", &json!({ "begin": seed }))?;
        if begun.ok { Ok(()) } else { Err(self.line.error("it does not begin, and does not say why")) }
    }

    fn advance(&mut self, stop: Stop) -> Result<Snapshot> {
        let request = json!({"advance": {"spp": stop.spp, "seconds": stop.seconds}});
        let found: Advanced = self.line.ask("advance", &request)?;
        self.check(&found, stop)?;
        self.so_far = (found.spp, found.seconds);
        let path = self.folder.path().join(&found.image);
        let image = read_image(&path).map_err(|error| self.line.error(error))?;
        let (width, height) = self.size;
        if (image.width, image.height) != self.size {
            let (w, h) = (image.width, image.height);
            return Err(self.line.error(format!("its image has {w}x{h} pixels where {width}x{height} were asked for")));
        }
        if let Some(bad) = image.pixels.iter().position(|pixel| pixel.iter().any(|value| !value.is_finite())) {
            let (x, y) = (bad as u32 % width, bad as u32 / width);
            return Err(self.line.error(format!("pixel ({x}, {y}) of its image is not finite")));
        }
        Ok(Snapshot {
            image,
            spp: found.spp,
            seconds: found.seconds,
            device_seconds: None,
            rays: None,
            nonfinite: found.nonfinite,
            estimated_relmse: None,
        })
    }
}

/// The name and the words of a command in `NAME=COMMAND`.
fn parse(text: &str) -> Result<(String, Vec<String>)> {
    let invalid = || {
        Error::Usage(format!("'{text}' names no peer: it must be NAME=COMMAND, as in 'mitsuba=mitsuba.py scalar_rgb'"))
    };
    let (name, command) = text.split_once('=').ok_or_else(invalid)?;
    let words = shlex::split(command)
        .ok_or_else(|| Error::Usage(format!("peer {name}: a quote in '{command}' does not end")))?;
    if name.is_empty() || words.is_empty() {
        return Err(invalid());
    }
    Ok((name.to_owned(), words))
}

/// A process and the way to talk to it.
struct Line {
    name: String,
    child: Child,
    to: ChildStdin,
    from: BufReader<ChildStdout>,
    /// What it last wrote to standard error, once that has ended.
    last_words: Receiver<String>,
}

impl Line {
    fn start(name: &str, command: &[String]) -> Result<Self> {
        let cannot = |why: &dyn std::fmt::Display| Error::Usage(format!("cannot start peer {name}: {why}"));
        let (program, arguments) = command.split_first().ok_or_else(|| cannot(&"no program is named"))?;
        let mut child = with_the_users_environment(&mut Command::new(program))
            .args(arguments)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .map_err(|error| cannot(&format!("'{program}': {error}")))?;
        let (Some(to), Some(from), Some(errors)) = (child.stdin.take(), child.stdout.take(), child.stderr.take())
        else {
            return Err(cannot(&"it has no standard streams"));
        };
        let (tell, last_words) = channel();
        // A pipe that nobody reads fills up and stops whoever writes to it.
        std::thread::spawn(move || tell.send(last_line(errors)));
        Ok(Self { name: name.to_owned(), child, to, from: BufReader::new(from), last_words })
    }

    fn error(&self, message: impl std::fmt::Display) -> Error {
        Error::Peer { name: self.name.clone(), message: message.to_string() }
    }

    /// Says one line and waits for the answer. A peer that Ctrl-C has ended too is one that has hung up.
    fn ask<T: DeserializeOwned>(&mut self, what: &str, request: &Value) -> Result<T> {
        let said = writeln!(self.to, "{request}").and_then(|()| self.to.flush());
        let mut answer = Vec::new();
        let heard = said.and_then(|()| (&mut self.from).take(LONGEST_ANSWER).read_until(b'\n', &mut answer));
        if answer.last() != Some(&b'\n') && (answer.len() as u64) < LONGEST_ANSWER {
            return Err(match heard {
                Ok(_) => self.hung_up(what),
                Err(error) if error.kind() == std::io::ErrorKind::BrokenPipe => self.hung_up(what),
                Err(error) => self.error(format!("cannot talk to it: {error}")),
            });
        }
        let text = String::from_utf8_lossy(&answer);
        let text = text.trim();
        let shown: String = text.chars().take(120).collect();
        let value: Value = serde_json::from_str(text)
            .ok()
            .filter(Value::is_object)
            .ok_or_else(|| self.error(format!("its answer to '{what}' is no JSON object: {shown}")))?;
        if let Some(error) = value.get("error") {
            return Err(self.error(error.as_str().map_or_else(|| error.to_string(), str::to_owned)));
        }
        serde_json::from_value(value).map_err(|error| self.error(format!("its answer to '{what}': {error}: {shown}")))
    }

    /// Why there is no answer.
    fn hung_up(&mut self, what: &str) -> Error {
        let started = Instant::now();
        let ended = loop {
            match self.child.try_wait() {
                Ok(Some(status)) => break format!("ended ({status})"),
                Ok(None) if started.elapsed() < PATIENCE => std::thread::sleep(Duration::from_millis(10)),
                _ => break String::from("hung up"),
            }
        };
        let last = self.last_words.recv_timeout(PATIENCE).unwrap_or_default();
        let last = if last.is_empty() { String::from("it said nothing") } else { format!("its last words: {last}") };
        self.error(format!("it {ended} and did not answer '{what}'; {last}"))
    }
}

impl Drop for Line {
    fn drop(&mut self) {
        // One that has ended already cannot be killed, which is as well.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Reads to the end; the last line that is not blank, or its beginning where it is long.
fn last_line(errors: ChildStderr) -> String {
    let mut last = String::new();
    let mut from = BufReader::new(errors);
    let mut bytes = Vec::new();
    while (&mut from).take(LONGEST_ANSWER).read_until(b'\n', &mut bytes).is_ok_and(|count| count > 0) {
        let text = String::from_utf8_lossy(&bytes);
        if !text.trim().is_empty() {
            last = text.trim().chars().take(300).collect();
        }
        bytes.clear();
    }
    last
}
