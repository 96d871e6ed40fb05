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
use warpbeam::IntegratorKind;
use warpbeam::method::METHODS;

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

/// Asserts that no other method or integrator has similar colours.
fn has_own_colors(colors: [[u8; 3]; 2]) {
    for theme in [0, 1] {
        let all = METHODS.iter().map(|m| m.colors).chain(IntegratorKind::all().map(|kind| kind.entry().colors));
        let apart = |a: [u8; 3]| a.iter().zip(colors[theme]).map(|(a, b)| u32::from(a.abs_diff(b))).sum::<u32>();
        assert_eq!(all.filter(|other| apart(other[theme]) <= 80).count(), 1, "{colors:?}");
    }
}

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
