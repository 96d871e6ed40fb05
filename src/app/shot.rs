//! Pictures of a lab without a window.

use std::ops::ControlFlow;
use std::path::Path;

use egui_wgpu::ScreenDescriptor;

use super::lab::Lab;
use super::stage::Stage;
use super::{AppError, ThemeChoice};
use crate::picture::Picture;
use crate::render::{FORMAT, Gpu, RenderError, read_texture};
use crate::scene::{Scene, Source};
use crate::simulation::{Simulation, Status};
use crate::study::{Extent, Study};

/// Largest side of a shot, pixels.
pub const MAX_SHOT_SIDE: u32 = 8192;

/// What a shot looks like.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ShotOptions {
    /// Pixels.
    pub size: [u32; 2],
    /// Whether the panel is in it.
    pub panel: bool,
    /// Whether the load curve is.
    pub curve: bool,
    /// Whether error against time is, measured now; in the place of the load curve.
    pub study: bool,
    /// Light or dark.
    pub theme: ThemeChoice,
}

impl Default for ShotOptions {
    fn default() -> Self {
        Self { size: [1280, 800], panel: true, curve: false, study: false, theme: ThemeChoice::default() }
    }
}

/// Solves the scene and writes its picture; returns how the solve ended.
///
/// # Errors
/// [`AppError::Render`].
pub fn shot(
    source: Source,
    scene: Scene,
    simulation: Simulation,
    options: &ShotOptions,
    output: &Path,
) -> Result<Status, AppError> {
    let gpu = Gpu::headless()?;
    let mut lab = Lab::new(source, scene, simulation);
    lab.set_adapter(gpu.describe());
    lab.set_panel(options.panel);
    if options.curve {
        lab.show_curve();
    }
    if options.study {
        match Study::new(lab.scene(), Extent::Full, &mut |_| ControlFlow::Continue(())) {
            Ok(study) => lab.show_study(study),
            Err(error) => log::error!("no study: {error}"),
        }
    }
    lab.solve();
    let picture = picture(&gpu, &mut lab, options.size, 1.0, options.theme.into())?;
    picture.write_png(output).map_err(RenderError::from)?;
    Ok(lab.simulation().status().clone())
}

/// Draws the lab as it stands into a picture of this many pixels.
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
    /// egui needs a pass to learn sizes, another to use them, and one more to come to rest.
    const PASSES: u32 = 3;
    if size.iter().any(|&side| side > gpu.max_side()) {
        return Err(RenderError::TooLarge { size, limit: gpu.max_side() });
    }
    let ctx = egui::Context::default();
    ctx.set_theme(theme);
    let mut stage = Stage::new(gpu, FORMAT);
    let screen = ScreenDescriptor { size_in_pixels: size, pixels_per_point };
    let mut primitives = Vec::new();
    for pass in 0..PASSES {
        let mut input = egui::RawInput {
            screen_rect: Some(egui::Rect::from_min_size(
                egui::Pos2::ZERO,
                egui::vec2(size[0] as f32, size[1] as f32) / pixels_per_point,
            )),
            time: Some(f64::from(pass)),
            max_texture_side: Some(gpu.max_side() as usize),
            focused: true,
            ..Default::default()
        };
        input.viewports.entry(egui::ViewportId::ROOT).or_default().native_pixels_per_point = Some(pixels_per_point);
        let mut output = ctx.run_ui(input, |ui| {
            lab.ui(ui, Some(stage.body_texture()));
        });
        stage.set_textures(gpu, &mut output.textures_delta);
        output.textures_delta.free.clear();
        primitives = ctx.tessellate(std::mem::take(&mut output.shapes), pixels_per_point);
    }
    let target = gpu.target("shot", size, 1, wgpu::TextureUsages::COPY_SRC);
    stage.paint(gpu, &target.create_view(&wgpu::TextureViewDescriptor::default()), &screen, &primitives, lab);
    read_texture(gpu, &target)
}
