//! Starts and interrupts the program. The functions wait for conditions, not for fixed times.

use std::fs::{self, File};
use std::io::Read as _;
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

use nix::pty::openpty;
pub use nix::sys::signal::Signal;
use nix::sys::signal::kill;
use nix::unistd::Pid;

use super::program;

/// A running program, killed when the value is dropped, so that it never outlives its test.
#[derive(Debug)]
pub struct Running(Option<Child>);

impl Drop for Running {
    fn drop(&mut self) {
        if let Some(child) = &mut self.0 {
            let _ = child.kill();
            let _ = child.wait();
        }
    }
}

/// Starts the program with its output piped.
fn start(folder: &Path, args: &[&str]) -> Running {
    Running(Some(program(folder, args).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()))
}

/// Waits until `condition` returns `true`. Fails after 300 s.
fn wait_for(what: &str, mut condition: impl FnMut() -> bool) {
    const NEVER: Duration = Duration::from_secs(300);
    let began = Instant::now();
    while !condition() {
        assert!(began.elapsed() < NEVER, "waited for {what} in vain");
        std::thread::sleep(Duration::from_millis(5));
    }
}

impl Running {
    fn id(&self) -> u32 {
        self.0.as_ref().unwrap().id()
    }

    /// Returns `true` if the process handles SIGINT itself.
    fn listens(&self) -> bool {
        const SIGINT_BIT: u64 = 1 << 1;
        let status = fs::read_to_string(format!("/proc/{}/status", self.id())).unwrap();
        let caught = status.lines().find_map(|line| line.strip_prefix("SigCgt:")).unwrap();
        u64::from_str_radix(caught.trim(), 16).unwrap() & SIGINT_BIT != 0
    }
}

/// Starts the program, and sends a signal once it handles signals and a condition holds; fails unless the exit code is 1.
pub fn interrupted(folder: &Path, args: &[&str], signal: Signal, mut is_time: impl FnMut() -> bool) -> Output {
    let mut running = start(folder, args);
    wait_for("a handler of signals, and a part of the result", || running.listens() && is_time());
    kill(Pid::from_raw(running.id() as i32), signal).unwrap();
    let output = running.0.take().unwrap().wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(1), "{args:?}: {}", super::stderr(&output));
    output
}

/// Runs the program with standard error on a terminal; returns its exit code and the text written there.
pub fn on_a_terminal(folder: &Path, args: &[&str]) -> (Option<i32>, String) {
    let terminal = openpty(None, None).unwrap();
    let start = |mut program: Command| {
        program.env("TERM", "xterm").stdin(Stdio::null()).stdout(Stdio::null()).stderr(terminal.slave).spawn().unwrap()
    };
    let mut running = Running(Some(start(program(folder, args))));
    // The read ends when the last copy of the slave is closed: the program has the only one.
    let (mut screen, mut text) = (File::from(terminal.master), Vec::new());
    let _ = screen.read_to_end(&mut text);
    (running.0.take().unwrap().wait().unwrap().code(), String::from_utf8_lossy(&text).into_owned())
}
