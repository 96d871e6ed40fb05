//! The one way a lab gets onto a texture: the body's pass, then egui over it. Window and shot both draw through here.

use egui::{ClippedPrimitive, TextureId, TexturesDelta};
use egui_wgpu::{RendererOptions, ScreenDescriptor};

use super::lab::Lab;
use crate::render::{BodyRenderer, Gpu};

/// Draws labs with one device into targets of one format.
pub(super) struct Stage {
    egui: egui_wgpu::Renderer,
    body: BodyRenderer,
    body_texture: TextureId,
}

impl Stage {
    pub(super) fn new(gpu: &Gpu, format: wgpu::TextureFormat) -> Self {
        // Predictable: the same picture in the window, in a shot, and on another machine.
        let mut egui = egui_wgpu::Renderer::new(&gpu.device, format, RendererOptions::PREDICTABLE);
        let body = BodyRenderer::new(gpu);
        let body_texture = egui.register_native_texture(&gpu.device, body.texture(), wgpu::FilterMode::Nearest);
        Self { egui, body, body_texture }
    }

    /// The texture the body is drawn into, for [`Lab::ui`].
    pub(super) fn body_texture(&self) -> TextureId {
        self.body_texture
    }

    /// Uploads what egui changed of its textures.
    pub(super) fn set_textures(&mut self, gpu: &Gpu, delta: &mut TexturesDelta) {
        for (id, deltas) in delta.set.drain() {
            for delta in &deltas {
                self.egui.update_texture(&gpu.device, &gpu.queue, id, delta);
            }
        }
    }

    /// Drops what egui no longer uses; after the frame that used it.
    pub(super) fn free_textures(&mut self, delta: &mut TexturesDelta) {
        for id in delta.free.drain() {
            self.egui.free_texture(&id);
        }
    }

    /// Draws the lab, laid out by the last [`Lab::ui`] and tessellated into `primitives`.
    pub(super) fn paint(
        &mut self,
        gpu: &Gpu,
        target: &wgpu::TextureView,
        screen: &ScreenDescriptor,
        primitives: &[ClippedPrimitive],
        lab: &Lab,
    ) {
        let pixels_per_point = f64::from(screen.pixels_per_point);
        let view = lab.view_rect().size() * screen.pixels_per_point;
        if self.body.resize(gpu, [view.x.round() as u32, view.y.round() as u32]) {
            self.egui.update_egui_texture_from_wgpu_texture(
                &gpu.device,
                self.body.texture(),
                wgpu::FilterMode::Nearest,
                self.body_texture,
            );
        }
        let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        self.body.draw(gpu, &mut encoder, &lab.frame(), &lab.camera(), pixels_per_point);
        let callbacks = self.egui.update_buffers(&gpu.device, &gpu.queue, &mut encoder, primitives, screen);
        let mut pass = encoder
            .begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("egui"),
                color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                    view: target,
                    depth_slice: None,
                    resolve_target: None,
                    ops: wgpu::Operations {
                        load: wgpu::LoadOp::Clear(wgpu::Color::BLACK),
                        store: wgpu::StoreOp::Store,
                    },
                })],
                ..Default::default()
            })
            .forget_lifetime();
        self.egui.render(&mut pass, primitives, screen);
        drop(pass);
        gpu.queue.submit(callbacks.into_iter().chain([encoder.finish()]));
    }
}
