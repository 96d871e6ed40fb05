//! Programs that are interrupted. Conditions are waited for, not durations.

use std::fs;
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

use super::program;

/// Starts the program.
pub fn start(folder: &Path, args: &[&str]) -> Child {
    program(folder, args).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
}

/// Waits until something is so; fails where it never will be.
pub fn wait_for(what: &str, mut condition: impl FnMut() -> bool) {
    const NEVER: Duration = Duration::from_secs(300);
    let began = Instant::now();
    while !condition() {
        assert!(began.elapsed() < NEVER, "waited for {what} in vain");
        std::thread::sleep(Duration::from_millis(5));
    }
}

/// Whether a process has a handler of its own for SIGINT.
pub fn listens(child: &Child) -> bool {
    const SIGINT_BIT: u64 = 1 << 1;
    let status = fs::read_to_string(format!("/proc/{}/status", child.id())).unwrap();
    let caught = status.lines().find_map(|line| line.strip_prefix("SigCgt:")).unwrap();
    u64::from_str_radix(caught.trim(), 16).unwrap() & SIGINT_BIT != 0
}

/// Presses Ctrl-C, and waits for the end.
pub fn interrupt(child: Child) -> Output {
    let sent = Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert!(sent.success());
    child.wait_with_output().unwrap()
}
