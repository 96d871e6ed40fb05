//! Tests of a window whose graphics device is lost. They run on a virtual display, in a process of their own.

use std::io::{BufRead, BufReader, Write};
use std::process::{Child, Command, Stdio};

use winit::platform::x11::EventLoopBuilderExtX11;

use super::*;
use crate::app::session::document::built_in;
use crate::scene::{Load, registry};

/// Environment variable that is set in the process with the window.
const CHILD: &str = "WARPBEAM_TEST_LOSS";
/// Longest time of a step; a busy machine takes long to compile shaders for the first time.
const PATIENCE: Duration = Duration::from_secs(240);

/// Process that ends when the value is dropped.
struct Ended(Child);

impl Drop for Ended {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// Window that loses its graphics device twice, with a screenshot before each loss.
struct Losing {
    app: App,
    since: Instant,
    losses: usize,
    /// `true` if a screenshot has been asked for.
    is_asked: bool,
}

/// Returns the pixels of a screenshot, and their number in a row; `None` if the file is not complete.
fn screenshot(number: usize) -> Option<(Vec<u8>, usize)> {
    let file = std::fs::File::open(format!("warpbeam-{number:03}.png")).ok()?;
    let mut reader = png::Decoder::new(BufReader::new(file)).read_info().ok()?;
    let mut pixels = vec![0; reader.output_buffer_size()?];
    let info = reader.next_frame(&mut pixels).ok()?;
    Some((pixels, info.line_size))
}

impl ApplicationHandler for Losing {
    fn resumed(&mut self, event_loop: &ActiveEventLoop) {
        self.app.resumed(event_loop);
    }

    fn window_event(&mut self, event_loop: &ActiveEventLoop, id: WindowId, event: WindowEvent) {
        self.app.window_event(event_loop, id, event);
        assert!(self.since.elapsed() < PATIENCE, "{} losses", self.losses);
        let Some(open) = self.app.open.as_ref().filter(|open| open.graphics.gpu.failure().is_none()) else { return };
        if screenshot(self.losses + 1).is_some() {
            open.graphics.gpu.device.destroy();
            // The device is lost once its work has ended.
            open.graphics.gpu.device.poll(wgpu::PollType::wait_indefinitely()).unwrap();
            assert!(open.graphics.gpu.failure().is_some());
            (self.losses, self.is_asked) = (self.losses + 1, false);
        } else if !std::mem::replace(&mut self.is_asked, true) {
            let (key, modifiers) = (egui::Key::S, egui::Modifiers::NONE);
            self.app.later.push(egui::Event::Key { key, physical_key: None, pressed: true, repeat: false, modifiers });
        }
    }

    fn about_to_wait(&mut self, event_loop: &ActiveEventLoop) {
        self.app.about_to_wait(event_loop);
        self.app.open.iter().for_each(|open| open.bare.window.request_redraw());
    }
}

/// Opens the window, loses its device twice, and checks what is kept.
fn lose() {
    let (source, scene) = built_in(registry::DEFAULT).unwrap();
    let simulation = Simulation::new(&scene).unwrap();
    let settings = Settings::file().as_deref().map(Settings::load).unwrap();
    let mut app = App::new((source, scene.clone(), Some(simulation)), settings, None, false).unwrap();
    let mut edited = scene.clone();
    let Load::Force { force, .. } = &mut edited.loads[0] else { unreachable!() };
    force[1] *= 0.5;
    app.lab.set_scene(edited.clone()).unwrap();
    let event_loop = EventLoop::builder().with_any_thread(true).build().unwrap();
    let mut losing = Losing { app, since: Instant::now(), losses: 0, is_asked: false };
    event_loop.run_app(&mut losing).unwrap();

    let Losing { app, losses, .. } = losing;
    assert_eq!(losses, 2);
    let text = app.error.unwrap().to_string();
    assert!(text.contains("failed twice: the device was lost") && text.contains("--adapter"), "{text}");
    assert_eq!(app.lab.scene(), &edited);
    // The panel is drawn as before, with its fonts.
    let view = app.lab.view_rect();
    let (right, bottom) = (4 * (view.right() as usize + 1), view.bottom() as usize);
    let panel = |number| {
        let (pixels, row) = screenshot(number).unwrap();
        pixels.chunks(row).take(bottom).flat_map(|line| line[right.min(line.len())..].to_vec()).collect::<Vec<u8>>()
    };
    let first = panel(1);
    assert!(first.len() > 100_000, "{}", first.len());
    assert!(panel(2) == first);
}

/// The first start tells the story and makes a file of settings, so that later starts do not tell it.
#[test]
fn only_the_first_start_tells_the_story() {
    let name = "app::window::tests::only_the_first_start_tells_the_story";
    if std::env::var_os(CHILD).is_none() {
        let folder = tempfile::tempdir().unwrap();
        let output = Command::new(std::env::current_exe().unwrap())
            .args(["--exact", name])
            .env(CHILD, "1")
            .env("XDG_CONFIG_HOME", folder.path())
            .output()
            .unwrap();
        let out = String::from_utf8_lossy(&output.stdout);
        return assert!(output.status.success() && out.contains("1 passed"), "{out}");
    }
    let file = Settings::file().unwrap();
    let open = |is_default| {
        let (source, scene) = built_in(registry::DEFAULT).unwrap();
        let simulation = Simulation::new(&scene).unwrap();
        App::new((source, scene, Some(simulation)), Settings::load(&file), None, is_default).unwrap()
    };
    let tells = |app: &App| app.lab.story().is_some();
    let mut other = open(false);
    assert!(!tells(&other), "a scene was asked for");
    other.keep_settings();
    let mut first = open(true);
    assert!(tells(&first) && !file.exists());
    first.keep_settings();
    assert!(!tells(&open(true)));
    std::fs::write(&file, "theme = 3").unwrap();
    assert!(!tells(&open(true)), "the settings could not be read");
}

#[test]
fn a_lost_device_is_replaced_once() {
    if std::env::var_os(CHILD).is_some() {
        return lose();
    }
    let server = Command::new("Xvfb")
        .args(["-displayfd", "1", "-screen", "0", "1600x1100x24", "-nolisten", "tcp", "-noreset"])
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn();
    let Ok(mut server) = server.map(Ended) else {
        assert!(std::env::var_os("WARPBEAM_REQUIRE_XVFB").is_none(), "Xvfb is missing");
        let _ = writeln!(std::io::stderr(), "skipped: no Xvfb; `scripts/setup test` installs it");
        return;
    };
    let mut number = String::new();
    BufReader::new(server.0.stdout.take().unwrap()).read_line(&mut number).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let output = Command::new(std::env::current_exe().unwrap())
        .args(["--exact", "app::window::tests::a_lost_device_is_replaced_once", "--nocapture"])
        .current_dir(folder.path())
        .env(CHILD, "1")
        .env("DISPLAY", format!(":{}", number.trim()))
        .env_remove("WAYLAND_DISPLAY")
        .env_remove("WAYLAND_SOCKET")
        .env("XDG_CONFIG_HOME", folder.path())
        .output()
        .unwrap();
    let [out, err] = [output.stdout, output.stderr].map(|text| String::from_utf8_lossy(&text).into_owned());
    assert!(output.status.success() && out.contains("1 passed"), "{out}\n{err}");
    assert!(err.contains("Unsaved changes are kept"), "{err}");
    let copy = std::fs::read_to_string(folder.path().join("warpbeam/unsaved/0.toml")).unwrap();
    assert!(copy.contains("-750.0"), "{copy}");
}
