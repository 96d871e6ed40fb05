//! Tests of the real window on a virtual display, driven by xdotool.
//!
//! If Xvfb, xdotool or openbox is missing, the test reports this and passes, unless `WARPBEAM_REQUIRE_XVFB` is set, as
//! `scripts/test` does after installing them.

use std::fs::File;
use std::io::{BufRead, BufReader, Write as _};
use std::process::{Child, Command, Stdio};
use std::sync::{Mutex, MutexGuard};
use std::time::{Duration, Instant};

use crate::common::drop::drop_file;
use crate::common::lab::*;
use x11rb::protocol::xproto::{ConnectionExt, ImageFormat, MapState};

/// Longest time to wait for a condition: a busy machine takes half a minute to compile shaders for the first time.
const PATIENCE: Duration = Duration::from_secs(240);
/// Time after which a key or a click without an effect is repeated, because it may be lost.
const AGAIN: Duration = Duration::from_secs(5);

/// Runs one desktop at a time, so that windows do not compete for processors.
static ONE_AT_A_TIME: Mutex<()> = Mutex::new(());

/// A virtual display with a window manager. Both end when the value is dropped.
struct Desktop {
    _turn: MutexGuard<'static, ()>,
    server: Child,
    manager: Child,
    name: String,
    /// Folder for the programs' settings, so that those of the user are not touched.
    config: tempfile::TempDir,
}

impl Drop for Desktop {
    fn drop(&mut self) {
        for child in [&mut self.manager, &mut self.server] {
            let _ = child.kill();
            let _ = child.wait();
        }
    }
}

impl Desktop {
    /// Starts the display and the window manager; returns `None` if a program is missing.
    fn start() -> Option<Self> {
        let turn = ONE_AT_A_TIME.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        let there = |program: &str| {
            Command::new("sh").args(["-c", &format!("command -v {program}")]).output().unwrap().status.success()
        };
        let missing: Vec<_> = ["Xvfb", "xdotool", "openbox"].into_iter().filter(|p| !there(p)).collect();
        if !missing.is_empty() {
            assert!(std::env::var_os("WARPBEAM_REQUIRE_XVFB").is_none(), "missing: {missing:?}");
            // Writes to the stream directly: the test harness shows captured output of failed tests only.
            let _ =
                writeln!(std::io::stderr(), "skipped: {missing:?} not installed; `scripts/setup test` installs them");
            return None;
        }
        let mut server = Command::new("Xvfb");
        server.args(["-displayfd", "1", "-screen", "0", "1600x1100x24", "-nolisten", "tcp", "-noreset"]);
        let mut server = server.stdout(Stdio::piped()).stderr(Stdio::null()).spawn().unwrap();
        let mut number = String::new();
        BufReader::new(server.stdout.take().unwrap()).read_line(&mut number).unwrap();
        let name = format!(":{}", number.trim());
        let config = tempfile::tempdir().unwrap();
        // openbox announces itself too early, and loses windows until it runs this command.
        let ready = config.path().join("ready");
        let mut manager = Command::new("openbox");
        manager.args(["--startup", &format!("touch '{}'", ready.display())]);
        let manager = manager.env("DISPLAY", &name).stderr(Stdio::null()).spawn().unwrap();
        let desktop = Self { _turn: turn, server, manager, name, config };
        wait_for("the window manager", || ready.exists().then_some(()));
        Some(desktop)
    }

    fn command(&self, program: &str) -> Command {
        let mut command = Command::new(program);
        command.env("DISPLAY", &self.name).env_remove("WAYLAND_DISPLAY").env_remove("WAYLAND_SOCKET");
        command.env("XDG_CONFIG_HOME", self.config.path());
        command
    }

    fn xdotool(&self, args: &[&str]) -> String {
        let output = self.command("xdotool").args(args).output().unwrap();
        assert!(output.status.success(), "xdotool {args:?}: {}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8(output.stdout).unwrap()
    }

    /// Presses a key in a window; returns `true` if there was a window to receive it.
    fn key(&self, window: &str, key: &str) -> bool {
        let keys = ["windowactivate", "--sync", window, "key", "--clearmodifiers", key];
        self.command("xdotool").args(keys).output().unwrap().status.success()
    }
}

/// These keys close a window without unsaved edits, and one with them.
const CLOSE: &[&str] = &["alt+F4"];
const DISCARD: &[&str] = &["alt+F4", "d"];

/// The program and its window.
struct Window<'a> {
    desktop: &'a Desktop,
    process: Child,
    id: String,
    /// Output of the program. It is a file because a pipe that is not read would block the program.
    output: tempfile::NamedTempFile,
}

impl<'a> Window<'a> {
    fn open(desktop: &'a Desktop, args: &[&str]) -> Self {
        Self::open_in(desktop, std::path::Path::new("."), args)
    }

    fn open_in(desktop: &'a Desktop, folder: &std::path::Path, args: &[&str]) -> Self {
        let output = tempfile::NamedTempFile::new().unwrap();
        let stream = || Stdio::from(output.as_file().try_clone().unwrap());
        let mut program = desktop.command(env!("CARGO_BIN_EXE_warpbeam"));
        let process = program.args(args).current_dir(folder).stderr(stream()).stdout(stream()).spawn().unwrap();
        let mut window = Self { desktop, process, id: String::new(), output };
        let start = Instant::now();
        while window.id.is_empty() {
            let ended = window.process.try_wait().unwrap();
            let said = window.said();
            assert!(ended.is_none() && start.elapsed() < PATIENCE, "no window ({ended:?}); the program said: {said:?}");
            let search = ["search", "--onlyvisible", "--pid", &window.process.id().to_string(), "--name", "warpbeam"];
            let found = desktop.command("xdotool").args(search).output().unwrap();
            window.id = String::from_utf8(found.stdout).unwrap().lines().last().unwrap_or_default().to_owned();
            std::thread::sleep(Duration::from_millis(50));
        }
        window.settle();
        window
    }

    /// Returns the program's output up to now.
    fn said(&self) -> String {
        std::fs::read_to_string(self.output.path()).unwrap()
    }

    /// Returns `true` if every thread of the program sleeps; a thread that waits for a processor counts as running.
    fn sleeps(&self) -> bool {
        std::fs::read_dir(format!("/proc/{}/task", self.process.id())).unwrap().flatten().all(|task| {
            // A thread may end in the meantime.
            let stat = std::fs::read_to_string(task.path().join("stat")).unwrap_or_default();
            stat.rsplit(')').next().is_none_or(|rest| !rest.trim_start().starts_with(['R', 'D']))
        })
    }

    /// Returns the window's pixels, four bytes each; empty while the window is not on the screen.
    fn image(&self) -> Vec<u8> {
        let (connection, _) = x11rb::connect(Some(&self.desktop.name)).unwrap();
        let id: u32 = self.id.parse().unwrap();
        let geometry = connection.get_geometry(id).unwrap().reply().unwrap();
        let image = connection.get_image(ImageFormat::Z_PIXMAP, id, 0, 0, geometry.width, geometry.height, !0);
        image.unwrap().reply().map(|reply| reply.data).unwrap_or_default()
    }

    /// Waits until the program sleeps and its picture does not change, and returns the picture.
    fn settle(&self) -> Vec<u8> {
        const LOOKS: u32 = 6;
        let mut last = Vec::new();
        let mut same = 0;
        wait_for("a picture that stands still", || {
            let image = self.image();
            let drawn = image.chunks(4).any(|p| p[..3] != image[..3]);
            same = if drawn && image == last && self.sleeps() { same + 1 } else { 0 };
            last = image;
            (same >= LOOKS).then_some(())
        });
        last
    }

    /// Returns the window's size, and `true` if it is on the screen.
    fn geometry(&self) -> ([u16; 2], bool) {
        let (connection, _) = x11rb::connect(Some(&self.desktop.name)).unwrap();
        let id: u32 = self.id.parse().unwrap();
        let size = connection.get_geometry(id).unwrap().reply().unwrap();
        let attributes = connection.get_window_attributes(id).unwrap().reply().unwrap();
        ([size.width, size.height], attributes.map_state == MapState::VIEWABLE)
    }

    /// Returns `true` if the window shows this picture.
    fn shows(&self, picture: &[u8]) -> bool {
        let image = self.image();
        image.len() == picture.len() && changed(&image, picture) < 2_000
    }

    /// Waits until more than this number of pixels differ from a picture.
    fn wait_for_change(&self, what: &str, picture: &[u8], pixels: usize) {
        wait_for(what, || (changed(picture, &self.image()) > pixels).then_some(()));
    }

    /// Waits until the window shows this picture.
    fn wait_for_picture(&self, what: &str, picture: &[u8]) {
        wait_for(what, || self.shows(picture).then_some(()));
    }

    /// Presses a key; returns `true` if there was a window to receive it.
    fn key(&self, key: &str) -> bool {
        self.desktop.key(&self.id, key)
    }

    fn point(&self, at: Pos2) {
        self.desktop.xdotool(&["mousemove", "--window", &self.id, &format!("{:.0}", at.x), &format!("{:.0}", at.y)]);
    }

    /// Returns the processor time used since the start, in clock ticks.
    fn ticks(&self) -> u64 {
        let stat = std::fs::read_to_string(format!("/proc/{}/stat", self.process.id())).unwrap();
        let fields: Vec<&str> = stat.rsplit(')').next().unwrap().split_whitespace().collect();
        fields[11].parse::<u64>().unwrap() + fields[12].parse::<u64>().unwrap()
    }

    /// Closes the window by these keys, as a window manager does, and checks that the program ends without an error; returns
    /// its output.
    fn close(mut self, keys: &[&str]) -> String {
        let (desktop, id) = (self.desktop, self.id.clone());
        let press = || keys.iter().for_each(|key| _ = desktop.key(&id, key));
        let status = ask_until("the program to end", press, || self.process.try_wait().unwrap());
        Self::check_end(status.code(), self.said())
    }

    fn check_end(code: Option<i32>, said: String) -> String {
        assert!(code == Some(0) && !said.contains("panicked"), "{code:?}: {said}");
        said
    }
}

impl Drop for Window<'_> {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

fn wait_for<T>(what: &str, mut ready: impl FnMut() -> Option<T>) -> T {
    let start = Instant::now();
    loop {
        if let Some(value) = ready() {
            return value;
        }
        assert!(start.elapsed() < PATIENCE, "waited in vain for {what}");
        std::thread::sleep(Duration::from_millis(100));
    }
}

/// Returns the article's scene at rest, with the layout of the window but without a display.
fn laid_out() -> Ui {
    let mut lab = lab_of("article", scene("article"));
    lab.solve();
    let mut ui = window(SIZE, lab);
    ui.run_steps(3);
    ui
}

/// Reads a PNG file in the order of X images, BGRx; returns `None` if the file is incomplete.
fn read_bgrx(path: &std::path::Path) -> Option<Vec<u8>> {
    let mut reader = png::Decoder::new(BufReader::new(File::open(path).ok()?)).read_info().ok()?;
    let mut rgba = vec![0; reader.output_buffer_size()?];
    reader.next_frame(&mut rgba).ok()?;
    Some(rgba.chunks(4).flat_map(|p| [p[2], p[1], p[0], 0]).collect())
}

/// Returns the number of pixels that differ; the fourth byte of an X image is no colour.
fn changed(a: &[u8], b: &[u8]) -> usize {
    a.chunks(4).zip(b.chunks(4)).filter(|(a, b)| a.iter().zip(*b).take(3).any(|(a, b)| a.abs_diff(*b) > 24)).count()
}

/// At rest nothing is redrawn: at least one of 15 intervals of two seconds uses almost no processor time.
#[test]
fn the_window_survives_being_idle_minimized_and_resized() {
    let Some(desktop) = Desktop::start() else { return };
    let window = Window::open(&desktop, &["run", "cantilever"]);
    window.point(Pos2::new(1000.0, 850.0));
    let before = window.settle();
    let used = (0..15).map(|_| {
        let before = window.ticks();
        std::thread::sleep(Duration::from_secs(2));
        window.ticks() - before
    });
    // An interval has 200 ticks; a loop that polls or redraws uses most of them.
    assert!(used.take_while(|&used| used > 4).count() < 15, "no two seconds in thirty were idle");
    desktop.xdotool(&["windowminimize", &window.id]);
    wait_for("the window to go", || (!window.geometry().1).then_some(()));
    desktop.xdotool(&["windowmap", &window.id]);
    wait_for("the window to come back", || window.geometry().1.then_some(()));
    window.wait_for_picture("the same picture after restoring", &before);
    // No side can be smaller than the smallest usable size.
    for (asked, size) in
        [([1, 1], [640, 480]), ([700, 37], [700, 480]), ([1300, 850], [1300, 850]), ([1280, 800], [1280, 800])]
    {
        let [width, height] = asked.map(|side: u16| side.to_string());
        desktop.xdotool(&["windowsize", &window.id, &width, &height]);
        wait_for("the window's new size", || (window.geometry().0 == size).then_some(()));
    }
    window.wait_for_picture("the same picture after resizing", &before);
    "F1 Escape w o g x t 2 3 4 1 p p b b space n r space f c".split(' ').for_each(|key| _ = window.key(key));
    window.settle();
    window.close(CLOSE);
}

/// A motion ends at rest, also after a release, and a reset shows the same motion with the same end.
#[test]
fn a_body_in_motion_is_pulled_released_and_reset() {
    let Some(desktop) = Desktop::start() else { return };
    // The damping is strong enough that the body rests after some seconds.
    let window = Window::open(&desktop, &["run", "jelly", "--set", "dynamics.damping.mass=15"]);
    let before = window.settle();
    // The body is in the middle of the view.
    let at = Pos2::new(498.0, 330.0);
    window.point(at);
    desktop.xdotool(&["mousedown", "1"]);
    wait_for("the pointer to hold the body and to pull it", || {
        [40.0, 80.0, 120.0].into_iter().for_each(|reach| window.point(at + vec2(reach, -0.5 * reach)));
        (changed(&before, &window.image()) > 20_000).then_some(())
    });
    desktop.xdotool(&["mouseup", "1"]);
    window.point(Pos2::new(1200.0, 735.0));
    window.settle();
    window.key("r");
    // The range of colours grows with the displayed frames of the motion, so that the pictures differ slightly.
    wait_for("the same end of the same motion", || {
        let image = window.image();
        (image.len() == before.len() && changed(&image, &before) < 100_000).then_some(())
    });
    window.close(CLOSE);
}

/// The picture is that of `shot`, and the language is kept for the next start.
#[test]
fn a_dropped_file_is_opened_and_shown_in_chinese() {
    let Some(desktop) = Desktop::start() else { return };
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("dropped.toml");
    std::fs::write(&path, scene("bracket").to_toml().unwrap()).unwrap();
    let window = Window::open(&desktop, &["run", "article"]);
    let switch = laid_out().get_by_label("Language").rect().center();
    drop_file(&desktop.name, window.id.parse().unwrap(), &path, PATIENCE);
    let title = || desktop.xdotool(&["getwindowname", &window.id]);
    wait_for("the dropped scene", || title().starts_with("Bracket").then_some(()));
    let english = window.settle();
    window.point(switch);
    desktop.xdotool(&["click", "1"]);
    window.wait_for_change("another language", &english, 5_000);
    window.point(FREE);
    shot_is(&path, &["--language", "zh"], &window.settle());
    window.close(CLOSE);
    let kept = std::fs::read_to_string(desktop.config.path().join("warpbeam").join("settings.toml")).unwrap();
    assert!(kept.contains("language = \"zh\""), "{kept}");
}

/// Position without a control that the pointer would highlight.
const FREE: Pos2 = Pos2::new(420.0, 735.0);

/// Asserts that `shot` makes a picture of a scene file; only times and numbers of iterations may differ.
fn shot_is(scene: &std::path::Path, options: &[&str], picture: &[u8]) {
    let path = scene.with_extension("png");
    let args = ["shot", scene.to_str().unwrap(), "--size", "1280x800", "-o", path.to_str().unwrap()];
    assert_eq!(warpbeam(&[&args, options].concat()).status.code(), Some(0));
    let different = changed(&read_bgrx(&path).unwrap(), picture);
    assert!(different < 5_000, "{different} pixels differ from what `shot` makes");
}

/// `solve` converges to the displayed result. A screenshot during the drag shows it, and does not end it.
#[test]
fn the_tip_of_the_arrow_is_dragged_saved_and_undone() {
    let Some(desktop) = Desktop::start() else { return };
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.toml");
    std::fs::write(&path, scene("article").to_toml().unwrap()).unwrap();
    let window = Window::open_in(&desktop, folder.path(), &["run", path.to_str().unwrap()]);
    let tip = laid_out().tip();
    window.point(FREE);
    let before = window.settle();
    window.point(tip);
    desktop.xdotool(&["mousedown", "1"]);
    // To the left and up: a smaller force in another direction.
    let drag = |parts: [f32; 2]| parts.map(|part| window.point(tip + vec2(-60.0, -45.0) * part));
    drag([0.25, 0.5]);
    window.wait_for_change("the beam to follow the arrow", &before, 5_000);
    let held = window.settle();
    let screenshot = folder.path().join("warpbeam-001.png");
    // The window has the focus: to give it again would end the drag.
    let press = || _ = desktop.xdotool(&["key", "s"]);
    let screenshot = ask_until("the whole screenshot", press, || read_bgrx(&screenshot));
    assert_eq!(screenshot.len(), held.len());
    // The arrow that is held is highlighted.
    let different = changed(&screenshot, &held);
    assert!(different < 20, "{different} pixels differ from the window");
    window.wait_for_picture("the message to vanish", &held);
    drag([0.75, 1.0]);
    window.wait_for_change("the drag to go on after the screenshot", &held, 5_000);
    window.wait_for_change("the beam to follow the arrow", &before, 10_000);
    desktop.xdotool(&["mouseup", "1"]);
    window.point(FREE);
    let after = window.settle();
    let force = || force(&Scene::from_toml(&std::fs::read_to_string(&path).unwrap()).unwrap());
    press_until(&window, "ctrl+s", "the saved scene", || force() != [0.0, -30_000.0]);
    let [fx, fy] = force();
    assert!(fx < 0.0 && fy < 0.0 && fx.hypot(fy) < 30_000.0, "{fx} {fy}");
    let json = solve_json(&[path.to_str().unwrap()]);
    assert_eq!(json["status"], "converged", "{json}");
    shot_is(&path, &[], &after);
    press_until(&window, "ctrl+z", "the scene as it was", || changed(&before, &window.image()) < 2_000);
    window.close(DISCARD);
}

/// The next window offers them, and Restore brings them back. An answered offer is not repeated.
#[test]
fn edits_survive_a_killed_window() {
    let Some(desktop) = Desktop::start() else { return };
    let mut window = Window::open(&desktop, &["run", "article"]);
    let at = laid_out().slider("Force");
    window.point(at(0.5));
    desktop.xdotool(&["mousedown", "1"]);
    window.point(at(0.3));
    desktop.xdotool(&["mouseup", "1"]);
    window.point(FREE);
    let copies = desktop.config.path().join("warpbeam").join("unsaved");
    let edited = window.settle();
    wait_for("a copy of the edits", || copies.join("0.toml").exists().then_some(()));
    window.process.kill().unwrap();
    window.process.wait().unwrap();
    let restore = {
        let (_place, left) = RecoveryCopies::open(&copies).unwrap();
        let mut ui = laid_out();
        ui.state_mut().left = Some(left.unwrap());
        // Learn shows a scene of its own, to which the edits do not belong.
        ui.state_mut().show_card(1);
        ui.run_steps(3);
        assert!(!ui.has(Role::Button, "Restore"));
        ui.click_for("Leave", 3);
        ui.rect(Role::Button, "Restore").center()
    };
    let next = Window::open(&desktop, &["run", "article"]);
    let offered = next.settle();
    assert!(changed(&offered, &edited) > 10_000, "it starts with the scene as it was opened");
    let click = || {
        // A second click after the first one would inspect the body under the button.
        if next.shows(&offered) {
            next.point(restore);
            desktop.xdotool(&["click", "1"]);
            next.point(FREE);
        }
    };
    ask_until("the restored edits", click, || next.shows(&edited).then_some(()));
    wait_for("another copy", || copies.join("1.toml").exists().then_some(()));
    assert!(!copies.join("0.toml").exists(), "it would be offered again");
    next.close(DISCARD);
    assert!(!copies.join("1.toml").exists());
}

/// Edits survive a window that is destroyed at once, as the menu of macOS does it.
#[test]
fn edits_survive_a_destroyed_window() {
    let Some(desktop) = Desktop::start() else { return };
    let mut window = Window::open(&desktop, &["run", "article"]);
    let copies = desktop.config.path().join("warpbeam").join("unsaved");
    let scene = || {
        let copy = std::fs::read_to_string(copies.join("0.toml")).ok()?;
        Some(toml::from_str::<toml::Table>(&copy).unwrap()["scene"].clone())
    };
    let at = laid_out().slider("Force");
    window.point(at(0.4));
    desktop.xdotool(&["mousedown", "1"]);
    let first = wait_for("a copy of the first edit", scene);
    // The body iterates to the equilibrium of the first edit, which changes the picture, too.
    let before = window.settle();
    window.point(at(0.7));
    window.wait_for_change("the second edit", &before, 1_000);
    desktop.xdotool(&["windowclose", &window.id]);
    let (code, said) = (window.process.wait().unwrap().code(), window.said());
    // Before winit learns that the window is destroyed, it may ask the display for its size, and panic.
    let is_winits =
        code == Some(2) && ["defect of the program", "winit", "GetGeometry"].iter().all(|part| said.contains(part));
    if !is_winits {
        Window::check_end(code, said);
    }
    assert_ne!(scene().unwrap(), first);
}

/// Presses a key, again if it has had no effect for a while, until a condition holds.
fn press_until(window: &Window<'_>, key: &str, what: &str, mut done: impl FnMut() -> bool) {
    ask_until(what, || _ = window.key(key), || done().then_some(()));
}

/// Calls `ask`, again if it has had no effect for a while, until `ready` returns a value: a key or a click can be lost
/// while another window gets the focus.
fn ask_until<T>(what: &str, mut ask: impl FnMut(), mut ready: impl FnMut() -> Option<T>) -> T {
    let mut asked: Option<Instant> = None;
    wait_for(what, || {
        let value = ready();
        if value.is_none() && asked.is_none_or(|at| at.elapsed() > AGAIN) {
            ask();
            asked = Some(Instant::now());
        }
        value
    })
}

/// Where neither settings nor copies of unsaved edits can be written, the user learns it, once.
#[test]
fn a_window_without_a_folder_for_settings_says_so() {
    let Some(desktop) = Desktop::start() else { return };
    std::fs::write(desktop.config.path().join("warpbeam"), "a file in place of the folder").unwrap();
    let window = Window::open(&desktop, &["run", "article"]);
    window.key("p");
    let messages = ["Unsaved changes would not survive a crash: ", "The settings are not saved: "];
    wait_for("the warnings", || messages.iter().all(|message| window.said().contains(message)).then_some(()));
    let said = window.close(CLOSE);
    assert!(messages.iter().all(|message| said.matches(message).count() == 1), "{said}");
}
