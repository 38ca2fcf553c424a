//! The program as a process: started, killed, and asked what it said.

use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};

use lumbre::gpu::with_the_users_environment;

/// The program.
pub fn lumbre() -> Command {
    super::clock::start_child();
    let mut command = Command::new(env!("CARGO_BIN_EXE_lumbre"));
    // As a user would start it, whatever a test before has set for the driver in this process.
    with_the_users_environment(&mut command);
    command
}

/// `lumbre render` of a scene of the canon in `folder`, on the tests' device.
pub fn render(folder: &Path, scene: &str, args: &str) -> Command {
    let mut command = lumbre();
    command.arg("render").arg(super::scene_path(scene)).args(args.split_whitespace()).current_dir(folder);
    if let Ok(device) = std::env::var("LUMBRE_TEST_DEVICE") {
        command.args(["--device", &device]);
    }
    command
}

/// Starts it without anything on the terminal.
pub fn start(mut command: Command) -> Child {
    command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
}

/// What a run said on standard error.
pub fn errors(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// Runs it to its end, which must be a good one; what it said on standard error.
pub fn works(mut command: Command) -> String {
    let output = command.output().unwrap();
    let said = errors(&output);
    assert!(output.status.success(), "{command:?}: {said}");
    said
}

/// Runs it to its end, which must be this exit status; the line that says why.
pub fn fails(mut command: Command, status: i32) -> String {
    let output = command.output().unwrap();
    let said = errors(&output);
    assert_eq!(output.status.code(), Some(status), "{command:?}: {said}");
    assert!(!said.contains("panicked"), "{said}");
    said.lines().rfind(|line| line.starts_with("error: ")).unwrap_or_else(|| panic!("no error in: {said}")).to_owned()
}

/// Sends a signal by name.
pub fn signal(child: &Child, name: &str) {
    // The shell's own `kill`: the program of that name is not on every machine.
    assert!(Command::new("sh").args(["-c", &format!("kill -{name} {}", child.id())]).status().unwrap().success());
}

/// Waits until a file is there.
pub fn wait_for(path: &Path) {
    let started = std::time::Instant::now();
    while !path.exists() {
        assert!(started.elapsed().as_secs() < 60, "{} does not come", path.display());
        std::thread::sleep(std::time::Duration::from_millis(2));
    }
}

/// Files of a folder, by name.
pub fn files(folder: &Path) -> Vec<String> {
    let name = |entry: std::io::Result<std::fs::DirEntry>| entry.unwrap().file_name().into_string().unwrap();
    let mut names: Vec<String> = std::fs::read_dir(folder).unwrap().map(name).collect();
    names.sort();
    names
}

/// The figures of a JSON file, without what time decides.
pub fn figures(path: &PathBuf) -> serde_json::Value {
    let mut json: serde_json::Value = serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap();
    let figures = json.as_object_mut().unwrap();
    for name in ["seconds", "mrays_per_s", "samples_per_s", "peak_device_bytes"] {
        figures.remove(name).unwrap();
    }
    json
}
