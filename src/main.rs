//! Entry point of the command line program.

#![forbid(unsafe_code)]

use std::process::ExitCode;

fn main() -> ExitCode {
    warpbeam::cli::main()
}
