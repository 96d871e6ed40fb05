//! The one way a lab gets onto a texture: the body's pass, then egui over it. Window and shot both draw through here.

use egui::{ClippedPrimitive, TexturesDelta};
use egui_wgpu::{RendererOptions, ScreenDescriptor};

use crate::app::shell::lab::Lab;
use crate::render::{BodyRenderer, Gpu, Viewport};

/// Draws labs with one device into targets of one format.
pub(crate) struct Stage {
    egui: egui_wgpu::Renderer,
    body: BodyRenderer,
}

impl Stage {
    pub(crate) fn new(gpu: &Gpu, format: wgpu::TextureFormat) -> Self {
        // Predictable: the same picture in the window, in a shot, and on another machine.
        let egui = egui_wgpu::Renderer::new(&gpu.device, format, RendererOptions::PREDICTABLE);
        Self { egui, body: BodyRenderer::new(gpu, format) }
    }

    /// Uploads what egui changed of its textures.
    pub(crate) fn set_textures(&mut self, gpu: &Gpu, delta: &mut TexturesDelta) {
        for (id, deltas) in delta.set.drain() {
            for delta in &deltas {
                self.egui.update_texture(&gpu.device, &gpu.queue, id, delta);
            }
        }
    }

    /// Drops what egui no longer uses; after the frame that used it.
    pub(crate) fn free_textures(&mut self, delta: &mut TexturesDelta) {
        for id in delta.free.drain() {
            self.egui.free_texture(&id);
        }
    }

    /// Draws the lab, laid out by the last [`Lab::ui`] and tessellated into `primitives`.
    pub(crate) fn paint(
        &mut self,
        gpu: &Gpu,
        target: &wgpu::TextureView,
        screen: &ScreenDescriptor,
        primitives: &[ClippedPrimitive],
        lab: &Lab,
    ) {
        let ScreenDescriptor { size_in_pixels, pixels_per_point } = *screen;
        let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let views = lab.views(pixels_per_point);
        self.body.draw(gpu, &mut encoder, (target, size_in_pixels), &views, f64::from(pixels_per_point));
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

/// The pixels of a place in the window, with so many of them a point.
pub(crate) fn viewport(place: egui::Rect, pixels_per_point: f32) -> Viewport {
    let place = place * pixels_per_point;
    let [corner, end] = [place.min, place.max].map(|p| [p.x, p.y].map(|v| v.round().max(0.0) as u32));
    Viewport { corner, size: [0, 1].map(|axis| end[axis].saturating_sub(corner[axis])) }
}
