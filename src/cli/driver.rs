//! A graphics driver that complains where there is no desktop.

/// Mesa's own switch for its layer that chooses between graphics devices.
#[cfg(target_os = "linux")]
const NO_DEVICE_SELECTION: &str = "NODEVICE_SELECT";

/// Where nobody is logged in to a desktop, Mesa's layer that chooses between graphics devices prints an error of its own for
/// every picture. Only the environment of a new process can switch it off, so the program replaces itself by itself, once.
/// Where that fails the program goes on, and the error is printed.
#[cfg(target_os = "linux")]
pub(super) fn silence() {
    use std::os::unix::process::CommandExt;

    let is_set = |name: &str| std::env::var_os(name).is_some_and(|value| !value.is_empty());
    if is_set("XDG_RUNTIME_DIR") || is_set(NO_DEVICE_SELECTION) {
        return;
    }
    if let Ok(program) = std::env::current_exe() {
        let error =
            std::process::Command::new(program).args(std::env::args_os().skip(1)).env(NO_DEVICE_SELECTION, "1").exec();
        log::debug!("not started anew: {error}");
    }
}

/// Other systems' drivers say nothing.
#[cfg(not(target_os = "linux"))]
pub(super) fn silence() {}
