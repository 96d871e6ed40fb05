//! Open window: its surface, its graphics device, and what draws into it.

use egui::{ClippedPrimitive, ViewportId};
use egui_wgpu::ScreenDescriptor;
use winit::dpi::PhysicalSize;
use winit::event_loop::OwnedDisplayHandle;
use winit::window::Window;

use crate::app::AppError;
use crate::app::offscreen::painter::PaintStage;
use crate::app::platform::clipboard::Clipboard;
use crate::app::platform::files::NewFile;
use crate::app::prelude::*;
use crate::render::{AdapterSearch, Candidate, Gpu, NO_WINDOW, RenderError, View, instance, read_texture, wanted_name};

/// Window, and the graphics resources that draw into it. The order of the fields matters: the surface must be dropped
/// before its window.
pub(super) struct OpenWindow {
    pub(super) graphics: Graphics,
    pub(super) bare: BareWindow,
    pub(super) hidden: bool,
    /// Number of consecutive frames for which the surface returned no texture.
    failures: u32,
}

/// Window without graphics resources; it stays open when they are made again.
pub(super) struct BareWindow {
    pub(super) input: egui_winit::State,
    pub(super) clipboard: Clipboard,
    pub(super) window: Arc<Window>,
}

pub(super) struct Graphics {
    surface: wgpu::Surface<'static>,
    pub(super) configuration: wgpu::SurfaceConfiguration,
    pub(super) stage: PaintStage,
    pub(super) gpu: Gpu,
    instance: wgpu::Instance,
}

/// Number of frames without a texture after which the window closes with an error.
const MAX_FAILURES: u32 = 10;

impl Graphics {
    /// Creates the graphics resources on the best adapter that draws into this window.
    pub(super) async fn new(
        window: &Arc<Window>,
        display: OwnedDisplayHandle,
        adapter: Option<&str>,
    ) -> Result<Self, AppError> {
        let instance = |backends| {
            let display = Box::new(display.clone());
            instance(wgpu::InstanceDescriptor::new_with_display_handle_from_env(display), backends)
        };
        let surface = |instance: &wgpu::Instance| instance.create_surface(window.clone()).map(Some);
        let search = AdapterSearch { name: wanted_name(adapter), instance, surface };
        Ok(search.first_usable(async |candidate| Self::on(candidate, window.inner_size()).await).await?)
    }

    /// Creates the graphics resources on this adapter, for a window of this size.
    async fn on(candidate: Candidate, size: PhysicalSize<u32>) -> Result<Self, String> {
        let Candidate { instance, adapter, surface } = candidate;
        let surface = surface.ok_or(NO_WINDOW)?;
        let gpu = Gpu::usable(adapter).await?;
        let capabilities = surface.get_capabilities(&gpu.adapter);
        let format = egui_wgpu::preferred_framebuffer_format(&capabilities.formats).map_err(|e| e.to_string())?;
        let configuration = surface.get_default_config(&gpu.adapter, size.width.max(1), size.height.max(1));
        let mut configuration = configuration.ok_or(NO_WINDOW)?;
        configuration.format = format;
        configuration.present_mode = wgpu::PresentMode::AutoVsync;
        let made = gpu.without_error(|| {
            surface.configure(&gpu.device, &configuration);
            PaintStage::new(&gpu, format)
        });
        let stage = made.await?;
        Ok(Self { surface, configuration, stage, gpu, instance })
    }

    /// Draws the frame of the window again, into an image, and saves it under a new name.
    pub(super) fn screenshot(
        &mut self,
        screen: &ScreenDescriptor,
        primitives: &[ClippedPrimitive],
        views: &[View<'_>],
    ) -> Result<PathBuf, String> {
        let file = NewFile::create(Path::new(""), "png").map_err(|error| error.to_string())?;
        let Self { gpu, stage, configuration, .. } = self;
        let usage = wgpu::TextureUsages::COPY_SRC;
        let target = gpu.target("screenshot", configuration.format, screen.size_in_pixels, 1, usage);
        stage.paint(gpu, &target, screen, primitives, views);
        let picture = read_texture(gpu, &target).map_err(|error| error.to_string())?;
        picture.write_png(file.path()).map_err(|error| RenderError::from(error).to_string())?;
        Ok(file.path().to_owned())
    }
}

impl BareWindow {
    pub(super) fn new(window: Arc<Window>, ctx: egui::Context) -> Self {
        let scale = window.scale_factor() as f32;
        let input = egui_winit::State::new(ctx, ViewportId::ROOT, &window, Some(scale), window.theme(), None);
        Self { input, clipboard: Clipboard::open(), window }
    }

    /// Takes the input of the next frame, at this time, s, for a surface of this size, pixels.
    ///
    /// [`egui_winit::State::take_egui_input`] asks the display for the size of the window, and winit panics where
    /// another program has just destroyed it.
    pub(super) fn take_input(&mut self, ctx: &egui::Context, time: f64, size: [u32; 2]) -> egui::RawInput {
        let size = egui::vec2(size[0] as f32, size[1] as f32) / egui_winit::pixels_per_point(ctx, &self.window);
        let input = self.input.egui_input_mut();
        input.time = Some(time);
        input.screen_rect = Some(egui::Rect::from_min_size(egui::Pos2::ZERO, size));
        let viewport = input.viewports.entry(ViewportId::ROOT).or_default();
        viewport.native_pixels_per_point = Some(self.window.scale_factor() as f32);
        input.take()
    }
}

impl OpenWindow {
    /// Draws into a window with these graphics resources. `ctx` may have been drawn with others before.
    pub(super) fn new(mut graphics: Graphics, mut bare: BareWindow, ctx: &egui::Context) -> Self {
        bare.input.set_max_texture_side(graphics.gpu.max_side() as usize);
        graphics.stage.restore_font(&graphics.gpu, ctx);
        Self { graphics, bare, hidden: false, failures: 0 }
    }

    pub(super) fn resize(&mut self, width: u32, height: u32) {
        // On some systems a minimised window has size zero, with which a surface cannot be configured.
        self.hidden = width == 0 || height == 0;
        if !self.hidden {
            self.graphics.configuration.width = width.min(self.graphics.gpu.max_side());
            self.graphics.configuration.height = height.min(self.graphics.gpu.max_side());
            self.configure();
        }
    }

    fn configure(&self) {
        let Graphics { surface, gpu, configuration, .. } = &self.graphics;
        surface.configure(&gpu.device, configuration);
    }

    /// Returns the texture of the next frame; `None` if there is none this time.
    pub(super) fn acquire(&mut self) -> Result<Option<wgpu::SurfaceTexture>, AppError> {
        use wgpu::CurrentSurfaceTexture as Current;
        let reason = match self.graphics.surface.get_current_texture() {
            Current::Success(texture) | Current::Suboptimal(texture) => {
                self.failures = 0;
                return Ok(Some(texture));
            }
            Current::Occluded => return Ok(None),
            Current::Timeout => "the display did not answer in time",
            Current::Outdated => {
                self.configure();
                "the surface stays out of date"
            }
            Current::Lost => {
                let made = self.graphics.instance.create_surface(self.bare.window.clone());
                let lost = |e| AppError::Window(format!("the surface was lost: {e}"));
                self.graphics.surface = made.map_err(lost)?;
                self.configure();
                "the surface was lost"
            }
            Current::Validation => "the surface is not valid",
        };
        self.failures += 1;
        if self.failures >= MAX_FAILURES {
            return Err(AppError::Window(reason.to_owned()));
        }
        self.bare.window.request_redraw();
        Ok(None)
    }
}
