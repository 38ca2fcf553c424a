//! Tests that must have a process for themselves: what they measure is the whole process's.

use std::process::Command;

use lumbre::gpu::with_the_users_environment;

/// Set to the name of the test that has this process for itself.
const ALONE: &str = "LUMBRE_TEST_ALONE";

/// Runs a test in a process of its own: a child of this program that runs nothing else, to whose output and success the test is
/// held. It may be asked for by name as any other: then it runs the same way.
pub fn alone(run: impl FnOnce()) {
    let name = std::thread::current().name().unwrap().to_owned();
    if std::env::var(ALONE).is_ok_and(|alone| alone == name) {
        return run();
    }
    let mut child = Command::new(std::env::current_exe().unwrap());
    with_the_users_environment(&mut child)
        .args([&name, "--exact", "--include-ignored", "--nocapture", "--test-threads", "2"])
        .env(ALONE, &name);
    let output = child.output().unwrap();
    let said = String::from_utf8_lossy(&output.stdout);
    println!("{said}{}", String::from_utf8_lossy(&output.stderr));
    assert!(output.status.success(), "{name} failed in its own process: {}", output.status);
    assert!(said.contains("test result: ok. 1 passed; 0 failed; 0 ignored"), "{name} was not run in its own process");
}
