//! Start of the window from Windows Explorer, which has no terminal.
//!
//! On Windows the program is a console program, so that `cmd` and PowerShell wait for its end, show its output and
//! receive its exit code. A program of the graphics subsystem has none of that. Explorer opens a console for a console
//! program: from Windows 11 24H2 on the manifest (`assets/windows-manifest.xml`) prevents that, and before the window
//! leaves its console at once, which closes it.

/// Leaves the console and returns `true` if Windows Explorer has started the program. Errors then need a dialog.
pub(super) fn leave_console() -> bool {
    let is_parent = parent().is_some_and(|name| name.eq_ignore_ascii_case("explorer.exe"));
    if is_parent && let Err(error) = winsafe::FreeConsole() {
        log::debug!("no console to leave: {error}");
    }
    is_parent
}

/// Returns the file name of the program that has started this one.
fn parent() -> Option<String> {
    let mut snapshot = winsafe::HPROCESSLIST::CreateToolhelp32Snapshot(winsafe::co::TH32CS::SNAPPROCESS, None).ok()?;
    let processes = snapshot.iter_processes().flatten();
    let processes: Vec<_> = processes.map(|p| (p.th32ProcessID, p.th32ParentProcessID, p.szExeFile())).collect();
    let own = winsafe::GetCurrentProcessId();
    let (_, parent, _) = processes.iter().find(|(id, ..)| *id == own)?;
    processes.iter().find(|(id, ..)| id == parent).map(|(.., name)| name.clone())
}

/// Shows an error in a dialog.
pub(super) fn show_error(text: &str) {
    use winsafe::prelude::Handle as _;

    // If the dialog cannot be shown, there is nothing left that could show the error.
    let _ = winsafe::HWND::NULL.MessageBox(text, "warpbeam", winsafe::co::MB::ICONERROR);
}
