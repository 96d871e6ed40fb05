//! Painter of a frame into a texture: the render pass of the bodies, then egui over it. Window, shots and recordings
//! all use it.

use egui::epaint::ImageDelta;
use egui::{ClippedPrimitive, TextureId, TextureOptions, TexturesDelta};
use egui_wgpu::{RendererOptions, ScreenDescriptor};

use crate::render::{BodyRenderer, Gpu, View};

/// Draws frames with one device into targets of one format.
pub(crate) struct PaintStage {
    egui: egui_wgpu::Renderer,
    body: BodyRenderer,
}

impl PaintStage {
    pub(crate) fn new(gpu: &Gpu, format: wgpu::TextureFormat) -> Self {
        // Deterministic: the same image in the window, in a shot, and on another machine.
        let egui = egui_wgpu::Renderer::new(&gpu.device, format, RendererOptions::PREDICTABLE);
        Self { egui, body: BodyRenderer::new(gpu, format) }
    }

    /// Uploads the whole texture of egui's fonts; to be called once if another stage has drawn this context before.
    pub(crate) fn restore_font(&mut self, gpu: &Gpu, ctx: &egui::Context) {
        if ctx.cumulative_pass_nr() > 0 {
            let delta = ImageDelta::full(ctx.fonts(|fonts| fonts.image()), TextureOptions::LINEAR);
            self.egui.update_texture(&gpu.device, &gpu.queue, TextureId::default(), &delta);
        }
    }

    /// Uploads the changes of egui's textures.
    pub(crate) fn set_textures(&mut self, gpu: &Gpu, delta: &mut TexturesDelta) {
        for (id, deltas) in delta.set.drain() {
            for delta in &deltas {
                self.egui.update_texture(&gpu.device, &gpu.queue, id, delta);
            }
        }
    }

    /// Frees the textures that egui no longer uses; to be called after the frame that used them.
    pub(crate) fn free_textures(&mut self, delta: &mut TexturesDelta) {
        for id in delta.free.drain() {
            self.egui.free_texture(&id);
        }
    }

    /// Draws the bodies in their views, and over them the user interface, tessellated into `primitives`. Draws nothing
    /// with a device that has failed.
    pub(crate) fn paint(
        &mut self,
        gpu: &Gpu,
        target: &wgpu::Texture,
        screen: &ScreenDescriptor,
        primitives: &[ClippedPrimitive],
        views: &[View<'_>],
    ) {
        let target = &target.create_view(&wgpu::TextureViewDescriptor::default());
        let ScreenDescriptor { size_in_pixels, pixels_per_point } = *screen;
        let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        self.body.draw(gpu, &mut encoder, (target, size_in_pixels), views, f64::from(pixels_per_point));
        // egui panics if it cannot upload its vertices.
        if gpu.failure().is_some() {
            return;
        }
        let callbacks = self.egui.update_buffers(&gpu.device, &gpu.queue, &mut encoder, primitives, screen);
        let mut pass = encoder
            .begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("egui"),
                color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                    view: target,
                    depth_slice: None,
                    resolve_target: None,
                    ops: wgpu::Operations { load: wgpu::LoadOp::Load, store: wgpu::StoreOp::Store },
                })],
                ..Default::default()
            })
            .forget_lifetime();
        self.egui.render(&mut pass, primitives, screen);
        drop(pass);
        gpu.queue.submit(callbacks.into_iter().chain([encoder.finish()]));
    }
}
