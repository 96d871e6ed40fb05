//! Workaround for a graphics driver that prints errors without a desktop session.

/// Environment variable that disables Mesa's device selection layer.
const NO_DEVICE_SELECTION: &str = "NODEVICE_SELECT";

/// Restarts the program once with Mesa's device selection layer disabled, if there is no desktop session: the layer
/// would print an error for every image, and only the environment of a new process can disable it. If the restart
/// fails, the program continues, and the error is printed.
pub(super) fn silence() {
    use std::os::unix::process::CommandExt;

    let is_set = |name: &str| std::env::var_os(name).is_some_and(|value| !value.is_empty());
    if is_set("XDG_RUNTIME_DIR") || is_set(NO_DEVICE_SELECTION) {
        return;
    }
    if let Ok(program) = std::env::current_exe() {
        let error =
            std::process::Command::new(program).args(std::env::args_os().skip(1)).env(NO_DEVICE_SELECTION, "1").exec();
        log::debug!("not restarted: {error}");
    }
}
