//! Tests of every entry of a registry, under its name: `cargo test --test registry -- t6` runs those of one element.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test may fail")]

/// Lists functions with their names.
macro_rules! tests {
    ($($name:ident)*) => { &[$((stringify!($name), $name)),*] };
}

#[path = "../common/mod.rs"]
mod common;
mod elements;
mod integrators;
mod methods;
#[cfg(feature = "app")]
mod pictures;
mod scenes;

use std::process::ExitCode;

use libtest_mimic::{Arguments, Trial};

fn main() -> ExitCode {
    let args = Arguments::from_args();
    let suites = [
        elements::trials(),
        integrators::trials(),
        methods::trials(),
        scenes::trials(),
        #[cfg(feature = "app")]
        pictures::trials(),
    ];
    libtest_mimic::run(&args, suites.into_iter().flatten().collect()).exit_code()
}

/// Name and function of a test that every entry of a registry must pass.
type Test<T> = (&'static str, fn(T));

/// Returns every test for every entry, named `suite::entry::test`.
fn suite<T: Copy + Send + 'static>(
    name: &str,
    entries: impl IntoIterator<Item = (String, T)>,
    tests: &[Test<T>],
) -> Vec<Trial> {
    let mut trials = Vec::new();
    for (id, entry) in entries {
        for &(test, run) in tests {
            trials.push(Trial::test(format!("{name}::{id}::{test}"), move || {
                run(entry);
                Ok(())
            }));
        }
    }
    trials
}
