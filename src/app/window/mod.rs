//! Window: receives winit events and draws frames. At rest no frames are drawn.

mod clicks;
mod open_window;
#[cfg(target_arch = "wasm32")]
pub(crate) mod page;
mod report;
#[cfg(target_arch = "wasm32")]
mod worker;

use std::cell::RefCell;
use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::sync::Arc;

use egui::ViewportId;
use thiserror::Error;
use web_time::{Duration, Instant};
use winit::application::ApplicationHandler;
use winit::event::{StartCause, WindowEvent};
use winit::event_loop::{ActiveEventLoop, ControlFlow, EventLoop};
use winit::window::{Window, WindowId};

use crate::app::language::{fill, tr};
use crate::app::offscreen::record::{LiveRecording, pointer};
use crate::app::offscreen::recorder::Recorder;
use crate::app::platform::{self, IS_PAGE};
use crate::app::session::recovery::RecoveryCopies;
use crate::app::shell::lab::{Lab, Request};
use crate::app::shell::settings::Settings;
use crate::app::task::solve::MAX_UNKNOWNS;
use crate::app::task::thread::POLL;
use crate::app::window::open_window::{BareWindow, Graphics, OpenWindow, ScreenshotError, new_file};
use crate::app::{AppError, ThemeChoice};
use crate::render::RenderError;
use crate::scene::{Scene, Source, registry};
use crate::simulation::Simulation;

/// Connection to a display.
pub struct Display(EventLoop<()>);

/// Reason for which there is no display.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum NoDisplay {
    /// No environment variable names a display.
    #[error("there is no display (neither WAYLAND_DISPLAY nor DISPLAY is set)")]
    NotSet,
    /// The display refused the connection.
    #[error(transparent)]
    Refused(#[from] winit::error::EventLoopError),
    /// A dynamically loaded library is missing.
    #[error("an X11 library is missing; scripts/setup installs libxkbcommon-x11-0, libxcursor1 and libxi6")]
    LibraryMissing,
}

impl Display {
    /// Connects to the display.
    ///
    /// # Errors
    /// [`NoDisplay`].
    pub fn open() -> Result<Self, NoDisplay> {
        #[cfg(all(unix, not(target_os = "macos")))]
        if ["WAYLAND_DISPLAY", "WAYLAND_SOCKET", "DISPLAY"].iter().all(|name| std::env::var_os(name).is_none()) {
            return Err(NoDisplay::NotSet);
        }
        // winit panics if an X library that it loads dynamically is missing; the panic becomes an error with a message.
        let hook = std::panic::take_hook();
        std::panic::set_hook(Box::new(|_| {}));
        let opened = std::panic::catch_unwind(EventLoop::new);
        std::panic::set_hook(hook);
        match opened {
            Ok(event_loop) => Ok(Self(event_loop?)),
            Err(_) => Err(NoDisplay::LibraryMissing),
        }
    }
}

/// Returns `true` if a scene is so large that it is meshed in the background after the window has opened.
#[must_use]
pub fn opens_in_background(scene: &Scene) -> bool {
    scene.unknowns() > MAX_UNKNOWNS
}

/// Opens the window and returns when it is closed. Without a simulation the scene is meshed in the background while the
/// window shows another one: see [`opens_in_background`]. `adapter` is a part of the name of the graphics adapter;
/// `None` stands for `WGPU_ADAPTER_NAME`. If no scene was asked for, which `is_default` says, the first start tells a
/// story.
///
/// # Errors
/// [`AppError`]: no adapter, or no window.
pub fn run(
    display: Display,
    source: Source,
    scene: Scene,
    simulation: Option<Simulation>,
    adapter: Option<String>,
    is_default: bool,
) -> Result<(), AppError> {
    let settings = Settings::file().as_deref().map(Settings::load).unwrap_or_default();
    let mut app = App::new((source, scene, simulation), settings, None, is_default)?;
    app.adapter = adapter;
    app.run(display)
}

/// Returns the warning for edits of which there is no copy.
fn no_copy(reason: impl std::fmt::Display) -> String {
    fill!("Unsaved changes would not survive a crash: %{reason}", reason = reason)
}

struct App {
    lab: Lab,
    ctx: egui::Context,
    /// Settings as stored in their file.
    settings: Settings,
    settings_file: Option<PathBuf>,
    /// `true` if the file of the settings is to be made although they have their defaults: the next start is not the
    /// first one.
    needs_settings_file: bool,
    /// Copy of unsaved edits; `None` if the system has no folder for it.
    recovery: Option<RecoveryCopies>,
    open: Option<OpenWindow>,
    /// Window that has been opened and is taken over by the next event.
    opening: Rc<RefCell<Option<Result<OpenWindow, AppError>>>>,
    /// Recording of the window.
    recording: Option<LiveRecording>,
    /// Recording of the scene from its start.
    scene_recording: Option<Recorder>,
    /// Time at which the window opened.
    start: Instant,
    /// Events that are processed in the next frame.
    later: Vec<egui::Event>,
    /// Time of the next frame that egui has requested without an event.
    wake: Option<Instant>,
    /// Part of the name of the graphics adapter; `None` stands for that of the environment.
    adapter: Option<String>,
    /// Times at which the graphics device failed.
    losses: Vec<Instant>,
    /// Reason for which the graphics resources are being made again.
    lost: Option<String>,
    error: Option<AppError>,
}

impl App {
    /// Prepares a window with these settings, or a message that they could not be read, and with this card of Learn,
    /// from 1. `is_default` is `true` if no scene was asked for: the first start then tells the story.
    fn new(
        (source, scene, simulation): (Source, Scene, Option<Simulation>),
        (settings, unreadable): (Settings, Option<String>),
        card: Option<usize>,
        is_default: bool,
    ) -> Result<Self, AppError> {
        let first_picture = source.name.to_str() == Some(registry::DEFAULT);
        let file = Settings::file();
        let ctx = egui::Context::default();
        let lab = match simulation {
            Some(simulation) => Some(Lab::new(source, scene, simulation)),
            None => Lab::opening(source, scene),
        };
        let Some(mut lab) = lab else {
            return Err(AppError::Window("the scene to begin with is missing".to_owned()));
        };
        lab.set_settings(&ctx, settings.clone());
        lab.set_easing(!lab.reduces_motion());
        let is_first_start = unreadable.is_none() && file.as_deref().is_some_and(Settings::is_missing);
        unreadable.into_iter().for_each(|message| _ = lab.warn(message));
        let folder = file.as_deref().and_then(Path::parent).map(|folder| folder.join("unsaved"));
        let recovery = folder.and_then(|folder| match RecoveryCopies::open(&folder) {
            Ok((recovery, left)) => {
                left.into_iter().for_each(|left| lab.offer(left));
                for (file, reason) in recovery.unreadable() {
                    let file = file.display();
                    lab.warn(fill!(
                        "%{file} has unsaved changes, but cannot be read: %{reason}",
                        file = file,
                        reason = reason
                    ));
                }
                Some(recovery)
            }
            Err(error) => {
                lab.warn(no_copy(format!("{}: {error}", folder.display())));
                None
            }
        });
        match card {
            Some(card) => lab.show_card(card),
            None if is_default && is_first_start && !lab.offers_unsaved() => lab.tell_story(),
            None if first_picture && !lab.reduces_motion() => lab.introduce(),
            None => {}
        }
        let needs_settings_file = lab.story().is_some();
        Ok(Self {
            lab,
            ctx,
            settings,
            settings_file: file,
            needs_settings_file,
            recovery,
            open: None,
            opening: Rc::default(),
            recording: None,
            scene_recording: None,
            start: Instant::now(),
            later: Vec::new(),
            wake: None,
            adapter: None,
            losses: Vec::new(),
            lost: None,
            error: None,
        })
    }

    /// Opens the window and returns when it is closed.
    fn run(self, display: Display) -> Result<(), AppError> {
        let ended = platform::start::run(display.0, self).map_err(|e| AppError::Window(e.to_string()))?;
        let Some(mut app) = ended else { return Ok(()) };
        let ended = app.recording.as_ref().and_then(|recording| recording.ended(true));
        let scene_ended = app.scene_recording.as_mut().and_then(|recorder| recorder.ended(true));
        // The window that would show the messages is closed.
        ended.into_iter().chain(scene_ended).for_each(|text| eprintln!("warpbeam: {text}"));
        app.keep_settings();
        app.error.map_or(Ok(()), Err)
    }
}

/// Number of lost devices in [`LOSS_PERIOD`] after which the window closes with an error.
const MAX_LOSSES: usize = 3;
/// Time after which a lost device no longer counts.
const LOSS_PERIOD: Duration = Duration::from_secs(60);

impl App {
    /// Draws a frame; after an error of the device, makes the graphics resources again.
    fn redraw(&mut self, event_loop: &ActiveEventLoop) {
        let drawn = if self.device_failure().is_none() { self.frame(event_loop) } else { Ok(()) };
        if let Some(reason) = self.device_failure() {
            self.renew_graphics(event_loop, reason);
        } else if let Err(error) = drawn {
            self.quit(event_loop, Some(error));
        }
    }

    fn device_failure(&self) -> Option<String> {
        self.open.as_ref().and_then(|open| open.graphics.gpu.failure())
    }

    /// Makes the iterations of one frame, draws it, and schedules the next frame that egui requests.
    fn frame(&mut self, event_loop: &ActiveEventLoop) -> Result<(), AppError> {
        let Some(open) = &mut self.open else {
            return Ok(());
        };
        if open.hidden {
            return Ok(());
        }
        let Some(texture) = open.acquire()? else {
            return Ok(());
        };
        let now = self.start.elapsed().as_secs_f64();
        self.lab.advance(now);
        self.follow_scene_recording();
        let Some(open) = &mut self.open else { return Ok(()) };
        let size = [open.graphics.configuration.width, open.graphics.configuration.height];
        let mut input = open.bare.take_input(&self.ctx, now, size);
        let mut events = std::mem::take(&mut self.later);
        events.append(&mut input.events);
        open.bare.clipboard.paste(&mut events);
        platform::page::join_touches(&mut events);
        self.later = clicks::after_first(&mut events);
        input.events = events;
        let mut requests = Vec::new();
        let (mut mark, mut cursor) = (Vec::new(), None);
        let mut output = self.ctx.run_ui(input, |ui| {
            requests.extend(self.lab.ui(ui));
            if let Some(recording) = &self.recording {
                mark = recording.mark(ui.ctx(), self.lab.view_rect(), now);
                cursor = pointer(ui.ctx());
                ui.ctx().request_repaint_after(POLL);
            }
        });
        if let Some(reason) = open.bare.clipboard.after(&output.platform_output) {
            self.lab.say(&self.ctx, fill!("Not copied: %{reason}", reason = reason));
            self.ctx.request_repaint();
        }
        open.bare.input.handle_platform_output_with_event_loop(
            &open.bare.window,
            event_loop,
            std::mem::take(&mut output.platform_output),
        );
        let mut primitives = self.ctx.tessellate(std::mem::take(&mut output.shapes), output.pixels_per_point);
        open.graphics.stage.set_textures(&open.graphics.gpu, &mut output.textures_delta);
        let whole = self.ctx.content_rect();
        let over = |shapes: Vec<egui::Shape>| {
            let clipped = shapes.into_iter().map(|shape| egui::epaint::ClippedShape {
                clip_rect: whole,
                shape,
                transform_after_tessellation: egui::emath::TSTransform::IDENTITY,
            });
            self.ctx.tessellate(clipped.collect(), output.pixels_per_point)
        };
        let screen = open.graphics.screen(output.pixels_per_point);
        let views = self.lab.views(screen.pixels_per_point);
        // A page saves the frame that it has drawn.
        let takes_screenshot = !IS_PAGE && requests.contains(&Request::Screenshot);
        let screenshot = takes_screenshot.then(|| open.graphics.screenshot(&screen, &primitives, &views));
        if let Some(recording) = &mut self.recording {
            recording.pass_frames(&open.graphics.gpu);
            if let Some(number) = recording.due(now) {
                let own = primitives.len();
                primitives.extend(over(cursor.into_iter().collect()));
                let drawn = (views.as_slice(), primitives.as_slice());
                recording.take(&open.graphics.gpu, &mut open.graphics.stage, drawn, &screen, (number, now));
                primitives.truncate(own);
            }
            primitives.extend(over(mark));
        }
        let view = texture.texture.create_view(&wgpu::TextureViewDescriptor::default());
        open.graphics.stage.paint(&open.graphics.gpu, &view, &screen, &primitives, &views);
        open.bare.window.pre_present_notify();
        open.graphics.gpu.queue.present(texture);
        open.graphics.stage.free_textures(&mut output.textures_delta);
        platform::page::set_title(&open.bare.window, &self.lab.title());
        platform::page::ask_before_leaving(self.lab.unsaved().is_some());
        platform::page::drawn(|frames| report::json(&self.lab, frames));

        let delay = output.viewport_output.get(&ViewportId::ROOT).map_or(Duration::MAX, |v| v.repaint_delay);
        let delay = delay.min(self.keep_unsaved());
        self.keep_settings();
        self.schedule(if self.later.is_empty() { delay } else { Duration::ZERO });
        for request in requests {
            match request {
                Request::Screenshot => self.say_saved(screenshot.as_ref()),
                Request::DiscardCopy => self.recovery.iter_mut().for_each(RecoveryCopies::discard_left),
                Request::Record => self.record(now),
                Request::RecordScene => self.record_scene(),
                Request::Close => self.close(event_loop),
            }
        }
        if let Some(text) = self.recording.as_ref().and_then(|recording| recording.ended(false)) {
            self.recording = None;
            self.say(text);
        }
        Ok(())
    }

    /// Makes the graphics resources of a window.
    fn open_graphics(&mut self, event_loop: &ActiveEventLoop, bare: BareWindow) {
        let (opening, display, ctx) = (self.opening.clone(), event_loop.owned_display_handle(), self.ctx.clone());
        let (window, adapter) = (bare.window.clone(), self.adapter.clone());
        platform::graphics::open(async move {
            let made = Graphics::new(&window, display, adapter.as_deref()).await;
            *opening.borrow_mut() = Some(made.map(|graphics| OpenWindow::new(graphics, bare, &ctx)));
            window.request_redraw();
        });
        self.take_window(event_loop);
    }

    /// Makes the graphics resources again after the device failed. Closes the window with an error if that happens too
    /// often.
    fn renew_graphics(&mut self, event_loop: &ActiveEventLoop, reason: String) {
        // A window may have one surface at a time.
        let Some(OpenWindow { graphics, bare, .. }) = self.open.take() else { return };
        if let Some(recording) = &mut self.recording {
            recording.stop(&graphics.gpu, self.start.elapsed().as_secs_f64());
        }
        drop(graphics);
        let now = Instant::now();
        self.losses.retain(|loss| now.saturating_duration_since(*loss) < LOSS_PERIOD);
        self.losses.push(now);
        if self.losses.len() >= MAX_LOSSES {
            let error = RenderError::Lost { times: self.losses.len(), reason };
            return self.quit(event_loop, Some(error.into()));
        }
        self.lost = Some(reason);
        self.open_graphics(event_loop, bare);
    }

    /// Takes over the window once its graphics device is there.
    fn take_window(&mut self, event_loop: &ActiveEventLoop) {
        let opened = self.opening.borrow_mut().take();
        match opened {
            Some(Ok(open)) => {
                let adapter = open.graphics.gpu.describe();
                open.bare.window.request_redraw();
                self.open = Some(open);
                if let Some(reason) = self.lost.take() {
                    self.say(fill!(
                        "Graphics restarted with %{adapter}: %{reason}",
                        adapter = adapter,
                        reason = reason
                    ));
                }
            }
            Some(Err(error)) => self.quit(event_loop, Some(error)),
            None => {}
        }
    }

    /// Stores a copy of unsaved edits; returns the delay until the next attempt.
    fn keep_unsaved(&mut self) -> Duration {
        let Some(recovery) = &mut self.recovery else { return Duration::MAX };
        match recovery.keep(self.lab.unsaved()) {
            Ok(due) => due.map_or(Duration::MAX, |due| due.saturating_duration_since(Instant::now())),
            Err(error) => {
                self.warn(no_copy(error));
                Duration::MAX
            }
        }
    }

    /// Stores a copy of unsaved edits when the window closes without a question about them.
    fn keep_at_end(&mut self) {
        let (Some(recovery), Some(edits)) = (&mut self.recovery, self.lab.unsaved()) else { return };
        match recovery.keep_at_once(edits) {
            Ok(()) => self.warn(tr("Unsaved changes are kept; the next window offers to restore them").to_owned()),
            Err(error) => self.warn(no_copy(error)),
        }
    }

    /// Closes the window. The user has decided to discard edits that are still unsaved.
    fn close(&mut self, event_loop: &ActiveEventLoop) {
        if let Some(recovery) = &mut self.recovery
            && let Err(error) = recovery.keep(None)
        {
            self.warn(fill!("The copy of unsaved changes could not be removed: %{reason}", reason = error));
        }
        self.quit(event_loop, None);
    }

    /// Starts recording the window, or ends the recording.
    fn record(&mut self, now: f64) {
        let Some(open) = &self.open else { return };
        if let Some(recording) = &mut self.recording {
            recording.stop(&open.graphics.gpu, now);
            return open.bare.window.request_redraw();
        }
        let size = [open.graphics.configuration.width, open.graphics.configuration.height];
        let format = open.graphics.configuration.format;
        let started = new_file("gif")
            .and_then(|file| LiveRecording::start(&open.graphics.gpu, format, size, file, self.lab.language()));
        match started {
            Ok(recording) => {
                self.recording = Some(recording);
                open.bare.window.request_redraw();
            }
            Err(reason) => self.say(fill!("No recording: %{reason}", reason = reason)),
        }
    }

    /// Starts recording the scene from its start, or ends that recording.
    fn record_scene(&mut self) {
        if let Some(recorder) = &self.scene_recording {
            return recorder.stop();
        }
        let theme = if self.ctx.theme() == egui::Theme::Dark { ThemeChoice::Dark } else { ThemeChoice::Light };
        let (source, scene) = (self.lab.source().clone(), self.lab.scene().clone());
        let (language, adapter) = (self.lab.language(), self.adapter.clone());
        match new_file("gif").and_then(|file| Recorder::start(source, scene, (theme, language), adapter, file)) {
            Ok(recorder) => self.scene_recording = Some(recorder),
            Err(reason) => self.say(fill!("No recording: %{reason}", reason = reason)),
        }
        self.schedule(Duration::ZERO);
    }

    /// Shows the progress of the scene's recording, or its end.
    fn follow_scene_recording(&mut self) {
        let Some(recorder) = &mut self.scene_recording else { return };
        let ended = recorder.ended(false);
        let progress = ended.is_none().then(|| recorder.progress());
        self.lab.show_recording(progress);
        if let Some(text) = ended {
            self.scene_recording = None;
            self.lab.say(&self.ctx, text);
        }
    }

    /// Shows a message.
    fn say(&mut self, message: String) {
        self.lab.say(&self.ctx, message);
        if let Some(open) = &self.open {
            open.bare.window.request_redraw();
        }
    }

    /// Prints and shows a warning, once.
    fn warn(&mut self, message: String) {
        if self.lab.warn(message)
            && let Some(open) = &self.open
        {
            open.bare.window.request_redraw();
        }
    }

    fn schedule(&mut self, delay: Duration) {
        self.wake = None;
        if delay.is_zero() {
            if let Some(open) = &self.open {
                open.bare.window.request_redraw();
            }
        } else {
            // A delay that overflows means never.
            self.wake = Instant::now().checked_add(delay);
        }
    }

    /// Says where a screenshot was saved, or why it was not; a page saves its frame now.
    fn say_saved(&mut self, screenshot: Option<&Result<PathBuf, ScreenshotError>>) {
        const NAME: &str = "warpbeam.png";
        let saved = match (screenshot, &self.open) {
            (Some(saved), _) => saved.as_ref().map(|path| path.display().to_string()).map_err(ToString::to_string),
            (None, Some(open)) => platform::page::save_frame(&open.bare.window, NAME).map(|()| NAME.to_owned()),
            (None, None) => return,
        };
        let message = match saved {
            Ok(file) => fill!("Saved %{file}", file = file),
            Err(reason) => fill!("No screenshot: %{reason}", reason = reason),
        };
        self.say(message);
    }

    /// Writes the settings to their file, if they have changed.
    fn keep_settings(&mut self) {
        let settings = self.lab.settings(&self.ctx);
        let is_due = std::mem::take(&mut self.needs_settings_file) || settings != self.settings;
        if let (Some(file), true) = (&self.settings_file, is_due) {
            match settings.save(&self.settings, file) {
                Ok(()) => self.settings = settings,
                Err(error) => {
                    let reason = format!("{}: {error}", file.display());
                    self.warn(fill!("The settings are not saved: %{reason}", reason = reason));
                }
            }
        }
    }

    fn quit(&mut self, event_loop: &ActiveEventLoop, error: Option<AppError>) {
        if let Some(error) = &error {
            platform::page::fail(&error.to_string());
            self.keep_at_end();
        }
        self.error = self.error.take().or(error);
        if let (Some(recording), Some(open)) = (&mut self.recording, &self.open) {
            recording.stop(&open.graphics.gpu, self.start.elapsed().as_secs_f64());
        }
        self.scene_recording.iter().for_each(Recorder::stop);
        // The surface must be dropped before the display connection closes.
        self.open = None;
        event_loop.exit();
    }
}

impl ApplicationHandler for App {
    fn resumed(&mut self, event_loop: &ActiveEventLoop) {
        if self.open.is_some() {
            return;
        }
        let attributes = Window::default_attributes().with_title(self.lab.title());
        let attributes = platform::start::window(attributes, event_loop, self.settings.size());
        let window = match event_loop.create_window(attributes) {
            Ok(window) => Arc::new(window),
            Err(error) => return self.quit(event_loop, Some(AppError::Window(error.to_string()))),
        };
        self.open_graphics(event_loop, BareWindow::new(window, self.ctx.clone()));
    }

    fn new_events(&mut self, _: &ActiveEventLoop, cause: StartCause) {
        if let (StartCause::ResumeTimeReached { .. }, Some(open)) = (cause, &self.open) {
            self.wake = None;
            open.bare.window.request_redraw();
        }
    }

    fn window_event(&mut self, event_loop: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        self.take_window(event_loop);
        let Some(open) = &mut self.open else { return };
        open.bare.clipboard.before(&event, &mut open.bare.input);
        let wants = open.bare.input.on_window_event(&open.bare.window, &event);
        match event {
            WindowEvent::CloseRequested => {
                if self.lab.request_close(&self.ctx) {
                    return self.close(event_loop);
                }
                // The question about unsaved edits must be visible.
                open.bare.window.set_minimized(false);
                open.bare.window.request_redraw();
            }
            WindowEvent::Destroyed => {
                // The menu of macOS, or another program, has ended the window without a question.
                self.keep_at_end();
                self.keep_settings();
                return self.quit(event_loop, None);
            }
            WindowEvent::Resized(size) => {
                open.resize(size.width, size.height);
                let points = size.to_logical::<f32>(open.bare.window.scale_factor());
                self.lab.set_window_size([points.width, points.height]);
                open.bare.window.request_redraw();
            }
            WindowEvent::Occluded(occluded) => {
                open.hidden = occluded;
                if !occluded {
                    open.bare.window.request_redraw();
                }
            }
            WindowEvent::RedrawRequested => return self.redraw(event_loop),
            _ => {}
        }
        if wants.repaint {
            open.bare.window.request_redraw();
        }
    }

    fn user_event(&mut self, _: &ActiveEventLoop, (): ()) {
        self.open.iter().for_each(|open| open.bare.window.request_redraw());
    }

    fn about_to_wait(&mut self, event_loop: &ActiveEventLoop) {
        event_loop.set_control_flow(self.wake.map_or(ControlFlow::Wait, ControlFlow::WaitUntil));
    }
}

#[cfg(target_os = "linux")]
#[cfg(test)]
mod tests;
