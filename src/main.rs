//! Entry point of the command line program, and of the module of the web page.

#![forbid(unsafe_code)]

#[cfg(not(target_arch = "wasm32"))]
fn main() -> std::process::ExitCode {
    warpbeam::cli::main()
}

#[cfg(target_arch = "wasm32")]
fn main() {
    warpbeam::app::open_page();
}
