//! `lumbre view` on a display without a screen (Xvfb), by keys and clicks as a user gives them (xdotool).

use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::time::{Duration, Instant};

use lumbre::image::{read_attribute, read_image};
use lumbre::layout::backend::Backend;
use lumbre::render::Renderer;

use crate::common::program::{fails, files, lumbre, render, works};
use crate::common::xdnd::drop_file;
use crate::common::{canon, scene_path, settings, with_gpu};

/// How long anything may take on a machine that does something else as well.
const PATIENCE: Duration = Duration::from_secs(120);

/// A process that ends with the test.
struct Guarded(Child);

impl Drop for Guarded {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// A display without a screen.
struct Display {
    name: String,
    _server: Guarded,
}

impl Display {
    /// Starts it. Where Xvfb or xdotool is missing this says so, unless `.ci/setup` has brought them: then the test fails.
    fn start() -> Option<Self> {
        let lacks = ["Xvfb", "xdotool"].into_iter().find(|name| Command::new(name).arg("-version").output().is_err());
        if let Some(name) = lacks {
            let required = std::env::var("LUMBRE_TEST_DISPLAY").as_deref() == Ok("required");
            assert!(!required, "there is no {name}, and LUMBRE_TEST_DISPLAY=required asks for it");
            eprintln!("skipped: there is no {name}");
            return None;
        }
        // It chooses a number that is free, and says which.
        let mut server = Command::new("Xvfb")
            .args(["-displayfd", "1", "-screen", "0", "1280x900x24", "-nolisten", "tcp"])
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let mut number = String::new();
        BufReader::new(server.stdout.take().unwrap()).read_line(&mut number).unwrap();
        assert!(!number.trim().is_empty(), "Xvfb ended before it had a display");
        Some(Self { name: format!(":{}", number.trim()), _server: Guarded(server) })
    }

    /// Does what a user would.
    fn user(&self, does: &str) -> String {
        let output = Command::new("xdotool").args(does.split(' ')).env("DISPLAY", &self.name).output().unwrap();
        assert!(output.status.success(), "xdotool {does}: {}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8(output.stdout).unwrap().trim().to_owned()
    }
}

/// The program with its window.
struct Viewer {
    process: Guarded,
    says: Receiver<String>,
    said: Vec<String>,
}

impl Viewer {
    /// `lumbre view` of the Cornell box in `folder`.
    fn start(display: &Display, folder: &Path, args: &str, environment: &[(&str, &str)]) -> Self {
        let mut command = lumbre();
        command.arg("view").arg(scene_path("cornell.xml")).args(args.split(' ')).args(["--verbose", "--validate"]);
        if let Ok(device) = std::env::var("LUMBRE_TEST_DEVICE") {
            command.args(["--device", &device]);
        }
        command.current_dir(folder).env("DISPLAY", &display.name).env_remove("WAYLAND_DISPLAY");
        command.envs(environment.iter().copied()).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut process = Guarded(command.spawn().unwrap());
        let lines = BufReader::new(process.0.stdout.take().unwrap()).lines();
        let (sender, says) = channel();
        std::thread::spawn(move || lines.map_while(Result::ok).try_for_each(|line| sender.send(line)));
        Self { process, says, said: Vec::new() }
    }

    /// Waits for a line that begins so.
    fn waits_for(&mut self, beginning: &str) -> String {
        let began = Instant::now();
        while began.elapsed() < PATIENCE {
            match self.says.recv_timeout(Duration::from_millis(100)) {
                Ok(line) => {
                    self.said.push(line.clone());
                    if line.starts_with(beginning) {
                        return line;
                    }
                }
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => break,
            }
        }
        let _ = self.process.0.kill();
        let errors = std::io::read_to_string(self.process.0.stderr.take().unwrap()).unwrap();
        panic!("no line '{beginning}' after {:.0?}, but {:#?}\n{errors}", began.elapsed(), self.said);
    }

    /// Waits for the end, which must be a good one: without a message of the validation layer.
    fn ends(mut self) {
        let status = self.process.0.wait().unwrap();
        let errors = std::io::read_to_string(self.process.0.stderr.take().unwrap()).unwrap();
        assert!(status.success() && errors.is_empty(), "{status}: {errors}");
    }

    /// Waits for the end, which must be a failure. Returns what it says of that.
    fn fails(mut self) -> String {
        let status = self.process.0.wait().unwrap();
        assert_eq!(status.code(), Some(1), "{status}");
        std::io::read_to_string(self.process.0.stderr.take().unwrap()).unwrap()
    }
}

/// The window, with the keyboard on it.
fn window(display: &Display) -> String {
    let window = display.user("search --sync --onlyvisible --name lumbre");
    let window = window.lines().last().unwrap_or_default().to_owned();
    display.user(&format!("windowfocus --sync {window}"));
    window
}

/// Orbits, resizes, hides and shows the window; what is shown then, once the camera is back, has the bits of `lumbre render`.
#[test]
fn a_user_looks_around_and_takes_a_screenshot() {
    let Some(display) = Display::start() else { return };
    let folder = tempfile::tempdir().unwrap();
    let mut viewer = Viewer::start(&display, folder.path(), "--size 64x48 -n 32", &[]);
    viewer.waits_for("picture of ");
    let window = window(&display);
    viewer.waits_for("done: 32 spp from the scene's camera");
    // What the pointer does is told apart from a click by the time that it takes.
    display.user("mousemove 400 400 mousedown 1");
    for _ in 0..4 {
        display.user("mousemove_relative 15 5 sleep 0.05");
    }
    display.user("mouseup 1");
    viewer.waits_for("done: 32 spp from elsewhere");
    display.user("key --delay 50 p");
    viewer.waits_for("wrote cornell-view-001.png, cornell-view-001.exr");
    display.user(&format!("windowsize --sync {window} 900 600 windowunmap --sync {window} sleep 0.2"));
    display.user(&format!("windowmap --sync {window} windowfocus --sync {window}"));
    display.user("key --delay 50 r");
    viewer.waits_for("done: 32 spp from the scene's camera");
    display.user("key --delay 50 plus plus f P");
    viewer.waits_for("wrote cornell-view-002.png, cornell-view-002.exr");
    display.user("key --delay 50 0 f F12");
    viewer.waits_for("wrote cornell-view-003.png, cornell-view-003.exr");
    display.user("mousemove 300 300 click 1");
    let pixel = viewer.waits_for("pixel ");
    display.user("key q");
    viewer.ends();

    let args = "--size 64x48 -n 32 -o true.exr -o true.png -q --backend bvh";
    works(render(folder.path(), "cornell.xml", args));
    let at = |name: &str| folder.path().join(name);
    let same = |a: &str, b: &str| read_image(&at(a)).unwrap() == read_image(&at(b)).unwrap();
    assert!(same("cornell-view-003.exr", "true.exr"), "the viewer's image is not that of render");
    assert!(same("cornell-view-003.png", "true.png"));
    assert!(same("cornell-view-002.exr", "true.exr") && !same("cornell-view-002.png", "true.png"));
    assert!(!same("cornell-view-001.exr", "true.exr"), "dragging moved nothing");
    assert_eq!(read_attribute(&at("cornell-view-003.exr"), "lumbre.spp").unwrap().as_deref(), Some("32.00"));
    // The pixel that was clicked on, and its value.
    let (place, value) = pixel.strip_prefix("pixel ").unwrap().split_once(": ").unwrap();
    let (x, y) = place.split_once(',').unwrap();
    let index = y.parse::<usize>().unwrap() * 64 + x.parse::<usize>().unwrap();
    let value: Vec<f32> = value.split(' ').map(|value| value.parse().unwrap()).collect();
    assert_eq!(read_image(&at("true.exr")).unwrap().pixels[index].to_vec(), value);
    assert_eq!(files(folder.path()).len(), 8);
}

/// Both devices are lost again and again, that of the window and that which renders; there is a picture all the same.
#[test]
fn lost_devices_are_opened_again() {
    let Some(display) = Display::start() else { return };
    let folder = tempfile::tempdir().unwrap();
    let mut viewer = Viewer::start(&display, folder.path(), "--size 16x16", &[("LUMBRE_FAULT", "device-lost@60")]);
    viewer.waits_for("picture of ");
    window(&display);
    viewer.waits_for("losses of the device so far: 2");
    while !viewer.said.iter().any(|line| line.contains("the window's device is opened again")) {
        display.user("key --delay 20 plus minus");
        viewer.said.extend(viewer.says.try_iter());
    }
    display.user("key --delay 50 Escape");
    viewer.ends();
}

/// A file that is no scene changes nothing; one that is takes the place of the other.
#[test]
fn dropped_scenes_are_opened() {
    let Some(display) = Display::start() else { return };
    let folder = tempfile::tempdir().unwrap();
    let mut viewer = Viewer::start(&display, folder.path(), "--size 24x16 -n 4", &[]);
    viewer.waits_for("done: 4 spp");
    let window: u32 = window(&display).parse().unwrap();
    let broken = folder.path().join("broken.obj");
    std::fs::write(&broken, "f 1 2 3\n").unwrap();
    drop_file(&display.name, window, &broken);
    viewer.waits_for(&broken.display().to_string());
    let sound = scene_path("veach_mis.xml");
    drop_file(&display.name, window, &sound);
    viewer.waits_for(&format!("picture of {}", sound.display()));
    display.user("key --delay 50 q");
    viewer.ends();
}

/// Copies a folder with all that is in it.
#[cfg(feature = "hot-reload")]
fn copy_folder(from: &Path, to: &Path) {
    std::fs::create_dir(to).unwrap();
    for entry in std::fs::read_dir(from).unwrap().map(Result::unwrap) {
        let target = to.join(entry.file_name());
        if entry.path().is_dir() {
            copy_folder(&entry.path(), &target);
        } else {
            std::fs::copy(entry.path(), target).unwrap();
        }
    }
}

/// A shader with a mistake is told with file and line, over a window that goes on as it was; one that is right again makes a new picture.
#[test]
#[cfg(feature = "hot-reload")]
fn changed_shaders_are_taken_while_the_window_is_open() {
    let Some(display) = Display::start() else { return };
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    copy_folder(&Path::new(env!("CARGO_MANIFEST_DIR")).join("shaders"), &at("shaders"));
    let file = at("shaders/materials/diffuse.glsl");
    let sound = std::fs::read_to_string(&file).unwrap();
    let args = "-i path --backend bvh --size 24x16 -n 4 --shaders shaders";
    let mut viewer = Viewer::start(&display, folder.path(), args, &[]);
    viewer.waits_for("done: 4 spp");
    window(&display);
    let screenshot = |viewer: &mut Viewer, number: u32| {
        display.user("key --delay 50 p");
        let name = format!("cornell-view-{number:03}.exr");
        viewer.waits_for(&format!("wrote cornell-view-{number:03}.png, {name}"));
        read_image(&at(&name)).unwrap()
    };
    let before = screenshot(&mut viewer, 1);

    std::fs::write(&file, format!("{sound}float broken = nothing_of_that_name;\n")).unwrap();
    let place = format!("shaders: shaders/materials/diffuse.glsl:{}: error: ", sound.lines().count() + 1);
    let said = viewer.waits_for(&place);
    assert!(said.contains("nothing_of_that_name"), "{said}");
    assert!(screenshot(&mut viewer, 2) == before, "the picture is another one, of shaders that do not compile");

    // Half of the light is lost at each diffuse surface.
    std::fs::write(&file, sound.replace("return m.reflectance *", "return 0.5 * m.reflectance *")).unwrap();
    let said = viewer.waits_for("picture of ");
    assert!(said.contains(" on bvh with changed shaders, "), "{said}");
    viewer.waits_for("done: 4 spp");
    let after = screenshot(&mut viewer, 3);
    let mean = |image: &lumbre::image::Image| image.average().iter().sum::<f64>();
    assert!(mean(&after) < 0.95 * mean(&before), "{} after {}", mean(&after), mean(&before));

    // The text of the beginning makes the picture of the beginning.
    std::fs::write(&file, sound).unwrap();
    viewer.waits_for("picture of ");
    viewer.waits_for("done: 4 spp");
    assert!(screenshot(&mut viewer, 4) == before);
    display.user("key q");
    viewer.ends();
}

/// What a moved camera sees has the bits of what one sees that was there from the start, also where techniques keep something between samples.
#[test]
fn moved_cameras_see_what_others_see_there() {
    let scene = canon("cornell.xml", &[]);
    let elsewhere = {
        let mut scene = scene.clone();
        scene.cameras[0].to_world.translation += glam::DVec3::new(0.3, 0.2, -0.1);
        scene
    };
    with_gpu(|gpu| {
        for technique in ["path", "photon", "mlt"] {
            let mut settings = settings(&scene, technique, Backend::Bvh);
            (settings.width, settings.height) = (24, 16);
            let image = |renderer: &mut Renderer| {
                while renderer.advance(4).unwrap() {}
                renderer.film().unwrap().mean()
            };
            let mut moved = Renderer::new(gpu, &scene, &settings).unwrap();
            let before = image(&mut moved);
            moved.look(&elsewhere).unwrap();
            let after = image(&mut moved);
            let there = image(&mut Renderer::new(gpu, &elsewhere, &settings).unwrap());
            assert!(after == there && after != before, "{technique}");
            moved.look(&scene).unwrap();
            assert!(image(&mut moved) == before, "{technique}, back again");
        }
    });
}

/// A display that ends, and a window that something else destroys, end the program with one line.
#[test]
fn a_display_that_goes_away_is_told() {
    let folder = tempfile::tempdir().unwrap();
    for what in ["the server ends", "the window is destroyed"] {
        let Some(display) = Display::start() else { return };
        let mut viewer = Viewer::start(&display, folder.path(), "-i path --size 64x64", &[]);
        viewer.waits_for("picture of");
        if what == "the server ends" {
            drop(display);
        } else {
            display.user(&format!("windowclose {}", window(&display)));
        }
        let said = viewer.fails();
        assert_eq!(said.trim(), "error: the display went away, or destroyed the window", "{what}");
    }
}

#[test]
fn without_a_display_it_says_so() {
    let mut command = lumbre();
    command.arg("view").arg(scene_path("cornell.xml"));
    for name in ["DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET"] {
        command.env_remove(name);
    }
    let said = fails(command, 1);
    assert!(said.contains("there is no display (neither WAYLAND_DISPLAY nor DISPLAY is set)"), "{said}");
}
