//! Where commands are run, each once: what it wrote stays in the lecture's folder for the next time.
//!
//! A command counts as done when its stamp is there. The stamp is written last, and holds what the command was, what its
//! outcome depends on, and what its files held: whatever an interruption leaves behind does not fit it.

use std::collections::HashMap;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::io::Read;
use std::os::unix::process::CommandExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::rc::Rc;
use std::time::{Duration, Instant};

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::command::{Scale, Shot, typed};
use super::run::{Compared, Run};
use crate::error::{Error, Result};
use crate::files::replace_file;
use crate::gpu::with_the_users_environment;
use crate::image::read_image;
use crate::render::kernels_fingerprint;
use crate::scene::{self, LoadOptions};

/// How often a running command is looked at.
const PAUSE: Duration = Duration::from_millis(5);

/// Where and how commands run.
pub struct Place<'a> {
    /// The program itself.
    pub program: PathBuf,
    /// The lecture's folder, as it was given: it is a part of the commands.
    pub folder: PathBuf,
    /// Where the scenes are.
    pub scenes: String,
    /// Options that every rendering gets.
    pub options: Vec<String>,
    /// The device and its driver: figures of another one are not this one's.
    pub device: String,
    /// How small the lecture is.
    pub scale: Scale,
    /// Whether to stop.
    pub interrupted: &'a dyn Fn() -> bool,
    /// Tells what is going on.
    pub say: &'a dyn Fn(&str),
}

/// What is written last.
#[derive(Serialize, Deserialize, PartialEq)]
struct Stamp {
    schema: String,
    command: String,
    depends_on: String,
    /// Files that the command wrote, and a hash of what each held.
    files: Vec<(String, String)>,
    /// Seconds that the whole command took.
    took: f64,
}

/// The laboratory.
pub struct Lab<'a> {
    place: Place<'a>,
    renderings: HashMap<String, (String, Rc<Run>)>,
    comparisons: HashMap<String, Compared>,
    scenes: HashMap<String, u64>,
    commands: Vec<String>,
    took: f64,
}

impl<'a> Lab<'a> {
    /// One whose folder exists and can be written to.
    pub fn new(place: Place<'a>) -> Result<Self> {
        let runs = place.folder.join("runs");
        std::fs::create_dir_all(&runs).map_err(|error| Error::write(&runs, error))?;
        Ok(Self {
            place,
            renderings: HashMap::new(),
            comparisons: HashMap::new(),
            scenes: HashMap::new(),
            commands: Vec::new(),
            took: 0.0,
        })
    }

    /// Seconds that all commands took together, those of earlier times included.
    pub fn took(&self) -> f64 {
        self.took
    }

    /// Where the page goes.
    pub fn page(&self) -> PathBuf {
        self.place.folder.join("index.html")
    }

    /// Tells what is going on.
    pub fn say(&self, what: &str) {
        (self.place.say)(what);
    }

    /// The commands that were asked for since the last time this was.
    pub fn take_commands(&mut self) -> Vec<String> {
        std::mem::take(&mut self.commands)
    }

    /// Renders, or finds what was rendered. The name is that of the files.
    pub fn render(&mut self, name: &str, shot: Shot) -> Result<Rc<Run>> {
        let (image, json) = (self.file(name, "exr"), self.file(name, "json"));
        let mut arguments = shot.arguments(&self.place.scenes, self.place.scale);
        arguments.extend(self.place.options.iter().cloned());
        let outputs = ["-o".into(), path_text(&image), "--json".into(), path_text(&json), "-q".into()];
        arguments.extend(outputs);
        let command = typed(&arguments);
        self.note(&command);
        if let Some((before, run)) = self.renderings.get(name) {
            // Two pictures of one name would take turns at being rendered.
            return if *before == command { Ok(run.clone()) } else { Err(clash(name)) };
        }
        let scene = self.scene_hash(&shot.file(&self.place.scenes))?;
        let depends_on = format!("{scene:016x} {:016x} {}", kernels_fingerprint(), self.place.device);
        self.obtain(name, &arguments, &depends_on, &[&image, &json])?;
        let run =
            Rc::new(Run { name: name.to_owned(), image: read_image(&image)?, figures: read_json(&json)?, file: image });
        self.renderings.insert(name.to_owned(), (command, run.clone()));
        Ok(run)
    }

    /// Compares an image with a reference.
    pub fn compare(&mut self, run: &Run, reference: &Run) -> Result<Compared> {
        let name = format!("{}-against-{}", run.name, reference.name);
        let json = self.file(&name, "json");
        let arguments = ["compare".into(), path_text(&run.file), path_text(&reference.file)];
        let arguments: Vec<String> = arguments.into_iter().chain(["--json".into(), path_text(&json)]).collect();
        self.note(&typed(&arguments));
        if let Some(found) = self.comparisons.get(&name) {
            return Ok(found.clone());
        }
        let depends_on = format!("{} {}", hash_of(&run.file)?, hash_of(&reference.file)?);
        self.obtain(&name, &arguments, &depends_on, &[&json])?;
        let found = Compared { figures: read_json(&json)? };
        self.comparisons.insert(name, found.clone());
        Ok(found)
    }

    fn file(&self, name: &str, extension: &str) -> PathBuf {
        self.place.folder.join("runs").join(format!("{name}.{extension}"))
    }

    fn note(&mut self, command: &str) {
        if !self.commands.iter().any(|known| known == command) {
            self.commands.push(command.to_owned());
        }
    }

    /// What a scene's pictures depend on.
    fn scene_hash(&mut self, file: &str) -> Result<u64> {
        if let Some(hash) = self.scenes.get(file) {
            return Ok(*hash);
        }
        let mut hasher = DefaultHasher::new();
        scene::load(Path::new(file), &LoadOptions::default())?.hash_content(&mut hasher);
        let hash = hasher.finish();
        self.scenes.insert(file.to_owned(), hash);
        Ok(hash)
    }

    /// Runs a command unless its stamp says that it was run already.
    fn obtain(&mut self, name: &str, arguments: &[String], depends_on: &str, outputs: &[&Path]) -> Result<()> {
        if (self.place.interrupted)() {
            return Err(self.stopped());
        }
        let path = self.file(name, "stamp");
        let command = typed(arguments);
        let stamp = |took: f64| -> Result<Stamp> {
            let held = |path: &&Path| Ok((path_text(path), hash_of(path)?));
            Ok(Stamp {
                schema: String::from("lumbre-lecture-1"),
                command: command.clone(),
                depends_on: depends_on.to_owned(),
                files: outputs.iter().map(held).collect::<Result<_>>()?,
                took,
            })
        };
        let before = std::fs::read_to_string(&path).ok().and_then(|text| serde_json::from_str::<Stamp>(&text).ok());
        if let Some(before) = before
            && stamp(before.took).is_ok_and(|now| now == before)
        {
            self.took += before.took;
            return Ok(());
        }
        // Whatever the files hold from now on, it is not what a stamp says.
        if path.exists() {
            std::fs::remove_file(&path).map_err(|error| Error::write(&path, error))?;
        }
        let started = Instant::now();
        self.run(&command, arguments)?;
        let took = started.elapsed().as_secs_f64();
        (self.place.say)(&format!("{took:6.1} s  {command}"));
        let text = serde_json::to_string_pretty(&stamp(took)?).map_err(|error| Error::write(&path, error))?;
        replace_file(&path, |file| writeln!(file, "{text}").map_err(|error| error.to_string()))?;
        self.took += took;
        Ok(())
    }

    fn run(&self, command: &str, arguments: &[String]) -> Result<()> {
        let failed = |message: String| Error::Command { command: command.to_owned(), message };
        // In a group of its own: an interrupt from the terminal reaches this program alone. A rendering that it reached would keep
        // what it has, which looks like one that is done.
        let mut child = with_the_users_environment(&mut Command::new(&self.place.program))
            .args(arguments)
            .process_group(0)
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .map_err(|error| failed(error.to_string()))?;
        let complaints = child.stderr.take();
        let listener = std::thread::spawn(move || {
            let mut text = Vec::new();
            let _ = complaints.map(|mut stream| stream.read_to_end(&mut text));
            String::from_utf8_lossy(&text).into_owned()
        });
        let status = loop {
            match child.try_wait().map_err(|error| failed(error.to_string()))? {
                Some(status) => break status,
                None if (self.place.interrupted)() => {
                    end(&mut child);
                    return Err(self.stopped());
                }
                None => std::thread::sleep(PAUSE),
            }
        };
        let said = listener.join().unwrap_or_default();
        if status.success() {
            return Ok(());
        }
        let reason = said.lines().find_map(|line| line.strip_prefix("error: ")).map(String::from);
        Err(failed(reason.unwrap_or_else(|| status.to_string())))
    }

    fn stopped(&self) -> Error {
        let folder = self.place.folder.display();
        Error::Interrupted(format!("what was rendered is kept in {folder}; the same command goes on"))
    }
}

fn end(child: &mut Child) {
    let _ = child.kill();
    let _ = child.wait();
}

fn clash(name: &str) -> Error {
    Error::Usage(format!("the lecture has two pictures of the name {name}"))
}

fn path_text(path: &Path) -> String {
    path.display().to_string()
}

fn hash_of(path: &Path) -> Result<String> {
    let bytes = std::fs::read(path).map_err(|error| Error::read(path, error))?;
    let mut hasher = DefaultHasher::new();
    bytes.hash(&mut hasher);
    Ok(format!("{:016x}", hasher.finish()))
}

fn read_json(path: &Path) -> Result<Value> {
    let text = std::fs::read_to_string(path).map_err(|error| Error::read(path, error))?;
    serde_json::from_str(&text).map_err(|error| Error::read(path, error))
}
