//! Tests that need a process of their own: they change the current folder or measure the memory of the process.

use std::process::Command;

/// Environment variable that names the test which the process was started for.
const TEST: &str = "WARPBEAM_TEST_ALONE";

/// Runs a test, `topic::name`, in a process of its own; returns `false` in that process, which then runs the body.
pub fn ran_alone(test: &str) -> bool {
    if std::env::var_os(TEST).is_some_and(|alone| alone == *test) {
        return false;
    }
    let mut program = Command::new(std::env::current_exe().unwrap());
    let output = program.args(["--exact", test, "--nocapture"]).env(TEST, test).output().unwrap();
    let [out, err] = [output.stdout, output.stderr].map(|text| String::from_utf8_lossy(&text).into_owned());
    assert!(output.status.success() && out.contains("1 passed"), "{test}:\n{out}\n{err}");
    true
}
