//! Images of a lab without a window.

use egui_wgpu::ScreenDescriptor;

use crate::app::AppError;
use crate::app::offscreen::options::ShotOptions;
use crate::app::offscreen::painter::PaintStage;
use crate::app::prelude::*;
use crate::app::shell::lab::Lab;
use crate::app::view_options::{Drawer, MeasureTab};
use crate::image::Picture;
use crate::render::{FORMAT, Gpu, RenderError, read_texture};
use crate::study::{Extent, Study, StudyError};

/// Result of [`shot`].
#[derive(Clone, Debug, PartialEq)]
pub struct Shot {
    /// Status of the scene's solution.
    pub status: Status,
    /// Reason for which the image shows no study, although [`ShotOptions::study`] asks for one.
    pub study_error: Option<StudyError>,
}

/// Solves the scene and writes its image. `observe` receives the progress of a study and can cancel it: the image then
/// shows the measurements made so far.
///
/// # Errors
/// [`AppError::Render`].
pub fn shot(
    source: Source,
    scene: Scene,
    simulation: Simulation,
    options: &ShotOptions,
    output: &Path,
    observe: Observer<'_>,
) -> Result<Shot, AppError> {
    let gpu = Gpu::headless(options.look.adapter.adapter.as_deref())?;
    let mut lab = Lab::new(source, scene, simulation);
    lab.settings.language = options.look.language;
    let view = &mut lab.desk.view;
    view.layout.bars = !options.no_panel;
    view.color_with(options.field);
    view.magnification = options.magnify.unwrap_or_default();
    view.drawer = options.sections.then_some(Drawer::Section).or(options.motion.then_some(Drawer::Motion));
    if options.curve {
        lab.show_tab(MeasureTab::LoadCurve);
    }
    if let Some(card) = options.learn {
        lab.show_card(card.into());
    }
    let mut study_error = None;
    if options.study {
        match Study::new(lab.scene(), Extent::Full, observe) {
            Ok(study) => lab.show_study(study),
            Err(error) => study_error = Some(error),
        }
    }
    if options.limits {
        lab.show_tab(MeasureTab::HowFar);
    }
    if let Some(panes) = &options.compare {
        lab.show_comparison(panes);
    }
    lab.solve();
    let picture = picture(&gpu, &mut lab, options.size, 1.0, options.look.theme.into())?;
    picture.write_png(output).map_err(RenderError::from)?;
    Ok(Shot { status: lab.simulation().status().clone(), study_error })
}

/// Draws the current state of the lab into an image of this size, pixels.
///
/// # Errors
/// [`RenderError::TooLarge`], [`RenderError::ReadBack`].
pub fn picture(
    gpu: &Gpu,
    lab: &mut Lab,
    size: [u32; 2],
    pixels_per_point: f32,
    theme: egui::Theme,
) -> Result<Picture, RenderError> {
    Canvas::new(gpu, size, pixels_per_point, theme)?.draw(lab, &mut |_| {})
}

/// Time of each stage of a frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FrameTimes {
    /// Layout: controls, plots, and the body mesh.
    pub layout: Duration,
    /// Conversion of egui's shapes to triangles.
    pub tessellate: Duration,
    /// Uploads, and recording of commands for the graphics device.
    pub record: Duration,
    /// Remaining time of the graphics device: all of the drawing for software rendering.
    pub draw: Duration,
}

/// Resources for drawing images of one size one after the other.
pub struct Canvas<'a> {
    gpu: &'a Gpu,
    ctx: egui::Context,
    stage: PaintStage,
    target: wgpu::Texture,
    screen: ScreenDescriptor,
    /// Number of egui's passes so far.
    passes: u32,
}

impl<'a> Canvas<'a> {
    /// Creates a canvas of this size, pixels.
    ///
    /// # Errors
    /// [`RenderError::TooLarge`].
    pub fn new(gpu: &'a Gpu, size: [u32; 2], pixels_per_point: f32, theme: egui::Theme) -> Result<Self, RenderError> {
        if size.iter().any(|&side| side > gpu.max_side()) {
            return Err(RenderError::TooLarge { size, limit: gpu.max_side() });
        }
        let ctx = egui::Context::default();
        ctx.set_theme(theme);
        let stage = PaintStage::new(gpu, FORMAT);
        let target = gpu.target("shot", FORMAT, size, 1, wgpu::TextureUsages::COPY_SRC);
        let screen = ScreenDescriptor { size_in_pixels: size, pixels_per_point };
        Ok(Self { gpu, ctx, stage, target, screen, passes: 0 })
    }

    /// Draws the current state of the lab, and the shapes of `over` on top of it.
    ///
    /// # Errors
    /// [`RenderError::ReadBack`].
    pub(crate) fn draw(&mut self, lab: &mut Lab, over: &mut dyn FnMut(&egui::Context)) -> Result<Picture, RenderError> {
        self.submit(lab, over);
        read_texture(self.gpu, &self.target)
    }

    /// Draws the current state of the lab and waits for the device, without reading the image: measures the cost of a
    /// frame.
    ///
    /// # Errors
    /// [`RenderError::ReadBack`].
    pub fn paint(&mut self, lab: &mut Lab) -> Result<FrameTimes, RenderError> {
        let times = self.submit(lab, &mut |_| {});
        let start = Instant::now();
        let failed = |reason| RenderError::ReadBack(reason);
        self.gpu.failure().map_or(Ok(()), |reason| Err(failed(reason)))?;
        let done = self.gpu.device.poll(wgpu::PollType::wait_indefinitely());
        done.map_err(|error| failed(error.to_string()))?;
        Ok(FrameTimes { draw: start.elapsed(), ..times })
    }

    /// Submits a frame to the device; returns the time of each stage.
    fn submit(&mut self, lab: &mut Lab, over: &mut dyn FnMut(&egui::Context)) -> FrameTimes {
        /// egui needs one pass to measure sizes, another to use them, and a third to settle.
        const FIRST_PASSES: u32 = 3;
        let Self { gpu, ctx, stage, target, screen, passes } = self;
        let ScreenDescriptor { size_in_pixels: size, pixels_per_point } = *screen;
        let points = egui::vec2(size[0] as f32, size[1] as f32) / pixels_per_point;
        let mut stage_start = Instant::now();
        let mut lap = || std::mem::replace(&mut stage_start, Instant::now()).elapsed();
        let mut output = egui::FullOutput::default();
        for _ in 0..if *passes == 0 { FIRST_PASSES } else { 1 } {
            let mut input = egui::RawInput {
                screen_rect: Some(egui::Rect::from_min_size(egui::Pos2::ZERO, points)),
                time: Some(f64::from(*passes)),
                max_texture_side: Some(gpu.max_side() as usize),
                focused: true,
                ..Default::default()
            };
            input.viewports.entry(egui::ViewportId::ROOT).or_default().native_pixels_per_point = Some(pixels_per_point);
            output.append(ctx.run_ui(input, |ui| {
                lab.ui(ui);
                over(ui.ctx());
            }));
            *passes = passes.saturating_add(1);
        }
        let layout = lap();
        let primitives = ctx.tessellate(output.shapes, pixels_per_point);
        let tessellate = lap();
        stage.set_textures(gpu, &mut output.textures_delta);
        stage.paint(gpu, target, screen, &primitives, &lab.views(pixels_per_point));
        stage.free_textures(&mut output.textures_delta);
        FrameTimes { layout, tessellate, record: lap(), draw: Duration::ZERO }
    }
}
