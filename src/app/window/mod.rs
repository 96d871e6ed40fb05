//! Window: receives winit events and draws frames. At rest no frames are drawn.

mod clicks;
mod open_window;
#[cfg(target_arch = "wasm32")]
pub(crate) mod page;
mod report;
#[cfg(target_arch = "wasm32")]
mod worker;

use std::cell::RefCell;
use std::io::ErrorKind;
use std::rc::Rc;

use egui::ViewportId;
use egui_wgpu::ScreenDescriptor;
use thiserror::Error;
use winit::application::ApplicationHandler;
use winit::event::{StartCause, WindowEvent};
use winit::event_loop::{ActiveEventLoop, ControlFlow, EventLoop};
use winit::window::{Window, WindowId};

use crate::app::AppError;
use crate::app::interface::*;
use crate::app::platform::{self, IS_PAGE};
use crate::app::session::recovery::RecoveryCopies;
use crate::app::shell::lab::{Lab, Request};
use crate::app::shell::settings::Settings;
use crate::app::task::solve::MAX_UNKNOWNS;
use crate::app::window::open_window::{BareWindow, Graphics, OpenWindow};
use crate::render::RenderError;

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
    fill!("Unsaved changes would not survive a crash: %{reason}", reason)
}

struct App {
    lab: Lab,
    ctx: Context,
    /// Settings as stored in their file.
    settings: Settings,
    /// `true` if the file of the settings is to be made although they have their defaults: the next start is not the
    /// first one.
    needs_settings_file: bool,
    /// Copy of unsaved edits; `None` if the system has no folder for it.
    recovery: Option<RecoveryCopies>,
    open: Option<OpenWindow>,
    /// Window that has been opened and is taken over by the next event.
    opening: Rc<RefCell<Option<Result<OpenWindow, AppError>>>>,
    /// Time at which the window opened.
    start: Instant,
    /// Events that are processed in the next frame.
    later: Vec<Event>,
    /// Time of the next frame that egui has requested without an event.
    wake: Option<Instant>,
    /// Part of the name of the graphics adapter; `None` stands for that of the environment.
    adapter: Option<String>,
    /// Reason for which the graphics device was lost; there is a second one, once.
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
        let file = Settings::file();
        let ctx = Context::default();
        let lab = match simulation {
            Some(simulation) => Some(Lab::new(source, scene, simulation)),
            None => Lab::opening(source, scene),
        };
        let mut lab = lab.ok_or_else(|| AppError::Window("the scene to begin with is missing".to_owned()))?;
        lab.set_settings(&ctx, settings.clone());
        lab.set_easing(!lab.reduces_motion());
        let is_missing = |file: &Path| platform::settings::read(file).is_err_and(|e| e.kind() == ErrorKind::NotFound);
        let is_first_start = file.as_deref().is_some_and(is_missing);
        unreadable.into_iter().for_each(|message| _ = lab.warn(message));
        let folder = file.as_deref().and_then(Path::parent).map(|folder| folder.join("unsaved"));
        let recovery = folder.and_then(|folder| match RecoveryCopies::open(&folder) {
            Ok((recovery, left)) => {
                lab.left = left;
                recovery.unreadable.iter().for_each(|message| _ = lab.warn(message.clone()));
                Some(recovery)
            }
            Err(error) => {
                lab.warn(no_copy(format!("{}: {error}", folder.display())));
                None
            }
        });
        match card {
            Some(card) => lab.show_card(card),
            None if is_default && is_first_start && lab.left.is_none() => lab.tell_story(),
            None => {}
        }
        let needs_settings_file = lab.story().is_some();
        Ok(Self {
            lab,
            ctx,
            settings,
            needs_settings_file,
            recovery,
            open: None,
            opening: Rc::default(),
            start: Instant::now(),
            later: Vec::new(),
            wake: None,
            adapter: None,
            lost: None,
            error: None,
        })
    }

    fn run(self, display: Display) -> Result<(), AppError> {
        let ended = platform::page::run(display.0, self).map_err(|e| AppError::Window(e.to_string()))?;
        let Some(mut app) = ended else { return Ok(()) };
        app.keep_settings();
        app.error.map_or(Ok(()), Err)
    }

    /// Draws a frame; after the first error of a device, makes the graphics resources again.
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
        let size = [open.graphics.configuration.width, open.graphics.configuration.height];
        let side = |axis: usize| size[axis] as f32 / open.bare.window.scale_factor() as f32 / platform::SMALLEST[axis];
        self.ctx.set_zoom_factor(self.ctx.zoom_factor().max(1.0).min(side(0)).min(side(1)));
        let mut input = open.bare.take_input(&self.ctx, now, size);
        let mut events = std::mem::take(&mut self.later);
        events.append(&mut input.events);
        open.bare.clipboard.paste(&mut events);
        platform::page::join_touches(&mut events);
        self.later = clicks::after_first(&mut events);
        input.events = events;
        let mut requests = Vec::new();
        let again = egui::RawInput { events: Vec::new(), ..input.clone() };
        let mut output = egui::FullOutput::default();
        for input in [input, again] {
            output.append(self.ctx.run_ui(input, |ui| requests.extend(self.lab.ui(ui))));
            if !std::mem::take(&mut self.lab.is_mixed) {
                break;
            }
        }
        if let Some(reason) = open.bare.clipboard.after(&output.platform_output) {
            self.lab.say(&self.ctx, fill!("Not copied: %{reason}", reason));
            self.ctx.request_repaint();
        }
        let platform = std::mem::take(&mut output.platform_output);
        open.bare.input.handle_platform_output_with_event_loop(&open.bare.window, event_loop, platform);
        let primitives = self.ctx.tessellate(std::mem::take(&mut output.shapes), output.pixels_per_point);
        open.graphics.stage.set_textures(&open.graphics.gpu, &mut output.textures_delta);
        let screen = ScreenDescriptor { size_in_pixels: size, pixels_per_point: output.pixels_per_point };
        let views = self.lab.views(screen.pixels_per_point);
        // A page saves the frame that it has drawn.
        let takes_screenshot = !IS_PAGE && requests.contains(&Request::Screenshot);
        let mut screenshot = takes_screenshot.then(|| open.graphics.screenshot(&screen, &primitives, &views));
        open.graphics.stage.paint(&open.graphics.gpu, &texture.texture, &screen, &primitives, &views);
        open.bare.window.pre_present_notify();
        open.graphics.gpu.queue.present(texture);
        open.graphics.stage.free_textures(&mut output.textures_delta);
        platform::page::set_title(&open.bare.window, &self.lab.title());
        platform::page::ask_before_leaving(self.lab.unsaved().is_some());
        platform::page::drawn(|frames| report::json(&self.lab, frames));

        let delay = output.viewport_output.get(&ViewportId::ROOT).map_or(Duration::MAX, |v| v.repaint_delay);
        let delay = delay.min(self.keep_unsaved());
        self.keep_settings();
        let is_due = delay.is_zero() || !self.later.is_empty();
        // A delay that overflows means never.
        self.wake = Instant::now().checked_add(delay).filter(|_| !is_due);
        if is_due {
            self.request_redraw();
        }
        for request in requests {
            match request {
                Request::Screenshot => self.say_saved(screenshot.take()),
                Request::DiscardCopy => {
                    let edits = self.lab.unsaved();
                    let discarded = self.recovery.as_mut().map(|recovery| recovery.discard_left(edits));
                    match discarded.transpose() {
                        Ok(next) => self.lab.left = next.flatten(),
                        Err(error) => self.warn(no_copy(error)),
                    }
                }
                Request::Close => self.close(event_loop),
            }
        }
        Ok(())
    }

    /// Makes the graphics resources of a window.
    fn open_graphics(&mut self, event_loop: &ActiveEventLoop, bare: BareWindow) {
        let (opening, display, ctx) = (self.opening.clone(), event_loop.owned_display_handle(), self.ctx.clone());
        let (window, adapter) = (bare.window.clone(), self.adapter.clone());
        platform::page::open(async move {
            let made = Graphics::new(&window, display, adapter.as_deref()).await;
            *opening.borrow_mut() = Some(made.map(|graphics| OpenWindow::new(graphics, bare, &ctx)));
            window.request_redraw();
        });
        self.take_window(event_loop);
    }

    /// Makes the graphics resources again after the device failed; closes the window with an error if the second device
    /// fails too.
    fn renew_graphics(&mut self, event_loop: &ActiveEventLoop, reason: String) {
        if self.lost.is_some() {
            return self.quit(event_loop, Some(RenderError::Lost { reason }.into()));
        }
        // A window may have one surface at a time.
        let Some(OpenWindow { graphics, bare, .. }) = self.open.take() else { return };
        drop(graphics);
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
                if let Some(reason) = self.lost.clone() {
                    self.say(fill!("Graphics restarted with %{adapter}: %{reason}", adapter, reason));
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
        match recovery.keep_at_once(Some(edits)) {
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

    fn say(&mut self, message: String) {
        self.lab.say(&self.ctx, message);
        self.request_redraw();
    }

    fn request_redraw(&self) {
        self.open.iter().for_each(|open| open.bare.window.request_redraw());
    }

    /// Prints and shows a warning, once.
    fn warn(&mut self, message: String) {
        if self.lab.warn(message) {
            self.request_redraw();
        }
    }

    /// Says where a screenshot was saved, or why it was not; a page saves its frame now.
    fn say_saved(&mut self, screenshot: Option<Result<PathBuf, String>>) {
        const NAME: &str = "warpbeam.png";
        let saved = match (screenshot, &self.open) {
            (Some(saved), _) => saved.map(|path| path.display().to_string()),
            (None, Some(open)) => platform::page::save_frame(&open.bare.window, NAME).map(|()| NAME.to_owned()),
            (None, None) => return,
        };
        let message = match saved {
            Ok(file) => fill!("Saved %{file}", file),
            Err(reason) => fill!("No screenshot: %{reason}", reason),
        };
        self.say(message);
    }

    /// Writes the settings to their file, if they have changed.
    fn keep_settings(&mut self) {
        let settings = self.lab.settings(&self.ctx);
        let is_due = std::mem::take(&mut self.needs_settings_file) || settings != self.settings;
        if is_due && let Some(file) = Settings::file() {
            match settings.save(&self.settings, &file) {
                Ok(()) => self.settings = settings,
                Err(error) => {
                    let reason = format!("{}: {error}", file.display());
                    self.warn(fill!("The settings are not saved: %{reason}", reason));
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
        let attributes = platform::page::window(attributes, event_loop, self.settings.size());
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
                self.lab.settings.size = [points.width, points.height];
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
        self.request_redraw();
    }

    fn about_to_wait(&mut self, event_loop: &ActiveEventLoop) {
        event_loop.set_control_flow(self.wake.map_or(ControlFlow::Wait, ControlFlow::WaitUntil));
    }
}

#[cfg(target_os = "linux")]
#[cfg(test)]
mod tests;
