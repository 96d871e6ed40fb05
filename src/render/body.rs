//! The body's pass: coloured triangles and the wireframe, multisampled, straight into the frame.

use bytemuck::{Pod, Zeroable};
use nalgebra::Vector2;

use super::colormap::{self, ColorMap};
use super::{Camera, Gpu};

/// What is drawn of a body.
#[derive(Clone, Copy, Debug)]
pub struct Frame<'a> {
    /// Node positions, m.
    pub positions: &'a [Vector2<f64>],
    /// Corners of the triangles.
    pub triangles: &'a [[u32; 3]],
    /// A value at every corner of every triangle, if it has one; between them it is linear.
    pub values: &'a [[Option<f64>; 3]],
    /// The colour of triangles without, gamma space.
    pub absent_color: [u8; 3],
    /// The values at the two ends of the colour map.
    pub range: [f64; 2],
    /// The colour map.
    pub map: ColorMap,
    /// Lines between nodes, over the triangles; empty for none.
    pub lines: &'a [[u32; 2]],
    /// A triangle beside each line: lines that its height leaves too close to the next ones fade.
    pub beside: &'a [u32],
    /// Triangles across an element.
    pub pieces: u32,
    /// Their colour, gamma space, straight alpha.
    pub line_color: [u8; 4],
    /// What is behind the body, gamma space.
    pub background: [u8; 3],
    /// What is beside the view, gamma space.
    pub surround: [u8; 3],
}

/// A rectangle of a target, pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Viewport {
    /// Left and top.
    pub corner: [u32; 2],
    /// Width and height.
    pub size: [u32; 2],
}

impl Viewport {
    /// The part of it that is in a target of this size.
    fn within(self, target: [u32; 2]) -> Self {
        let corner = [0, 1].map(|axis| self.corner[axis].min(target[axis]));
        Self { corner, size: [0, 1].map(|axis| self.size[axis].min(target[axis] - corner[axis])) }
    }
}

#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
struct Vertex {
    position: [f32; 2],
    color: [u8; 4],
    /// Where its value lies in the colour map, 0 to 1; negative where its colour is its own.
    value: f32,
}

/// The value of a vertex that has a colour of its own.
const COLORED: f32 = -1.0;
/// Colours that the shader has of the colour map.
const MAP_COLORS: usize = 64;

#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
struct CameraUniform {
    scale: [f32; 2],
    padding: [f32; 2],
}

/// Draws bodies into targets of one format.
#[derive(Debug)]
pub struct BodyRenderer {
    triangles: wgpu::RenderPipeline,
    lines: wgpu::RenderPipeline,
    camera: wgpu::Buffer,
    map: wgpu::Buffer,
    /// What is in there.
    uploaded_map: Option<ColorMap>,
    bind_group: wgpu::BindGroup,
    vertices: wgpu::Buffer,
    scratch: Vec<Vertex>,
    format: wgpu::TextureFormat,
    /// Where pixels have several samples; resolved into the target.
    multisampled: Option<wgpu::TextureView>,
    /// Of the target, pixels.
    size: [u32; 2],
}

impl BodyRenderer {
    /// Pipelines for targets of this format.
    #[must_use]
    pub fn new(gpu: &Gpu, format: wgpu::TextureFormat) -> Self {
        let device = &gpu.device;
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("body"),
            source: wgpu::ShaderSource::Wgsl(include_str!("../../shaders/mesh.wgsl").into()),
        });
        let camera = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("camera"),
            size: size_of::<CameraUniform>() as u64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let map = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("colour map"),
            size: size_of::<[[f32; 4]; MAP_COLORS]>() as u64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let uniform = |binding, visibility| wgpu::BindGroupLayoutEntry {
            binding,
            visibility,
            ty: wgpu::BindingType::Buffer {
                ty: wgpu::BufferBindingType::Uniform,
                has_dynamic_offset: false,
                min_binding_size: None,
            },
            count: None,
        };
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("camera"),
            entries: &[uniform(0, wgpu::ShaderStages::VERTEX), uniform(1, wgpu::ShaderStages::FRAGMENT)],
        });
        let bind_group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("camera"),
            layout: &layout,
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: camera.as_entire_binding() },
                wgpu::BindGroupEntry { binding: 1, resource: map.as_entire_binding() },
            ],
        });
        let pipeline_layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("body"),
            bind_group_layouts: &[Some(&layout)],
            immediate_size: 0,
        });
        let pipeline = |topology| {
            device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: Some("body"),
                layout: Some(&pipeline_layout),
                vertex: wgpu::VertexState {
                    module: &module,
                    entry_point: Some("vertex"),
                    compilation_options: wgpu::PipelineCompilationOptions::default(),
                    buffers: &[Some(wgpu::VertexBufferLayout {
                        array_stride: size_of::<Vertex>() as u64,
                        step_mode: wgpu::VertexStepMode::Vertex,
                        attributes: &wgpu::vertex_attr_array![0 => Float32x2, 1 => Unorm8x4, 2 => Float32],
                    })],
                },
                primitive: wgpu::PrimitiveState { topology, ..Default::default() },
                depth_stencil: None,
                multisample: wgpu::MultisampleState { count: gpu.samples(), ..Default::default() },
                fragment: Some(wgpu::FragmentState {
                    module: &module,
                    entry_point: Some("fragment"),
                    compilation_options: wgpu::PipelineCompilationOptions::default(),
                    targets: &[Some(wgpu::ColorTargetState {
                        format,
                        blend: Some(wgpu::BlendState::ALPHA_BLENDING),
                        write_mask: wgpu::ColorWrites::ALL,
                    })],
                }),
                multiview_mask: None,
                cache: None,
            })
        };
        Self {
            triangles: pipeline(wgpu::PrimitiveTopology::TriangleList),
            lines: pipeline(wgpu::PrimitiveTopology::LineList),
            camera,
            map,
            uploaded_map: None,
            bind_group,
            vertices: Self::vertex_buffer(gpu, 1024),
            scratch: Vec::new(),
            format,
            multisampled: Self::multisampled(gpu, format, [1, 1]),
            size: [1, 1],
        }
    }

    fn multisampled(gpu: &Gpu, format: wgpu::TextureFormat, size: [u32; 2]) -> Option<wgpu::TextureView> {
        let several = Some(gpu.samples()).filter(|&samples| samples > 1)?;
        let texture = gpu.target("body, multisampled", format, size, several, wgpu::TextureUsages::empty());
        Some(texture.create_view(&wgpu::TextureViewDescriptor::default()))
    }

    fn vertex_buffer(gpu: &Gpu, bytes: u64) -> wgpu::Buffer {
        gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("body"),
            size: bytes,
            usage: wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        })
    }

    /// Draws `frame` as `camera` sees it, with this many pixels a point, into a part of a target of this size (pixels),
    /// all of which it fills.
    pub fn draw(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        (target, size): (&wgpu::TextureView, [u32; 2]),
        viewport: Viewport,
        frame: &Frame<'_>,
        (camera, pixels_per_point): (&Camera, f64),
    ) {
        if size != self.size {
            self.multisampled = Self::multisampled(gpu, self.format, size);
            self.size = size;
        }
        let viewport = viewport.within(size);
        let pixels_per_metre = camera.scale * pixels_per_point;
        let triangle_vertices =
            self.fill_vertices(frame, camera, viewport.size.map(|s| f64::from(s) / pixels_per_metre));
        let bytes: &[u8] = bytemuck::cast_slice(&self.scratch);
        if self.vertices.size() < bytes.len() as u64 {
            self.vertices = Self::vertex_buffer(gpu, (bytes.len() as u64).next_power_of_two());
        }
        gpu.queue.write_buffer(&self.vertices, 0, bytes);
        let clip_per_metre = viewport.size.map(|side| (2.0 * pixels_per_metre / f64::from(side.max(1))) as f32);
        let uniform = CameraUniform { scale: clip_per_metre, padding: [0.0; 2] };
        gpu.queue.write_buffer(&self.camera, 0, bytemuck::bytes_of(&uniform));

        if self.uploaded_map != Some(frame.map) {
            let color = |i: usize| frame.map.color(i as f64 / (MAP_COLORS - 1) as f64).map(|c| f32::from(c) / 255.0);
            let colors: [[f32; 4]; MAP_COLORS] = std::array::from_fn(|i| {
                let [r, g, b] = color(i);
                [r, g, b, 1.0]
            });
            gpu.queue.write_buffer(&self.map, 0, bytemuck::cast_slice(&colors));
            self.uploaded_map = Some(frame.map);
        }

        let [r, g, b] = frame.surround.map(|c| f64::from(c) / 255.0);
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("body"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: self.multisampled.as_ref().unwrap_or(target),
                depth_slice: None,
                resolve_target: self.multisampled.is_some().then_some(target),
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color { r, g, b, a: 1.0 }),
                    store: if self.multisampled.is_some() { wgpu::StoreOp::Discard } else { wgpu::StoreOp::Store },
                },
            })],
            ..Default::default()
        });
        let Viewport { corner: [x, y], size: [width, height] } = viewport;
        if width == 0 || height == 0 {
            return;
        }
        pass.set_viewport(x as f32, y as f32, width as f32, height as f32, 0.0, 1.0);
        pass.set_scissor_rect(x, y, width, height);
        pass.set_bind_group(0, &self.bind_group, &[]);
        pass.set_vertex_buffer(0, self.vertices.slice(..));
        pass.set_pipeline(&self.triangles);
        pass.draw(0..triangle_vertices, 0..1);
        pass.set_pipeline(&self.lines);
        pass.draw(triangle_vertices..self.scratch.len() as u32, 0..1);
    }

    /// Triangle vertices, the background's before the body's, then line vertices; returns how many of the former.
    /// `view` is what is seen, m.
    fn fill_vertices(&mut self, frame: &Frame<'_>, camera: &Camera, view: [f64; 2]) -> u32 {
        // Relative to the camera before it becomes f32: zoomed in far from the origin, digits matter.
        let position = |node: u32| {
            let d = frame.positions.get(node as usize).copied().unwrap_or_default() - camera.center;
            [d.x as f32, d.y as f32]
        };
        self.scratch.clear();
        let [r, g, b] = frame.background;
        let [x, y] = view.map(|side| (0.5 * side) as f32);
        let corners = [[-x, -y], [x, -y], [x, y], [-x, -y], [x, y], [-x, y]];
        self.scratch.extend(corners.map(|position| Vertex { position, color: [r, g, b, 255], value: COLORED }));
        let [r, g, b] = frame.absent_color;
        for (triangle, values) in frame.triangles.iter().zip(frame.values) {
            // A triangle without a value at one of its corners has none.
            let known = values.iter().all(Option::is_some);
            self.scratch.extend(triangle.iter().zip(values).map(|(&node, value)| {
                let at = value.filter(|_| known).map(|value| colormap::position(value, frame.range) as f32);
                Vertex { position: position(node), color: [r, g, b, 255], value: at.unwrap_or(COLORED) }
            }));
        }
        let triangle_vertices = self.scratch.len() as u32;
        let at = |node: u32| frame.positions.get(node as usize).copied().unwrap_or_default();
        let [r, g, b, opacity] = frame.line_color;
        for (line, &beside) in frame.lines.iter().zip(frame.beside) {
            let Some(corners) = frame.triangles.get(beside as usize) else { continue };
            let [p, q, s] = corners.map(at);
            let length = (at(line[1]) - at(line[0])).norm();
            let height = (q - p).perp(&(s - p)).abs() / length * f64::from(frame.pieces);
            let strength = line_strength(height * camera.scale);
            if strength > 0.0 {
                let color = [r, g, b, (f64::from(opacity) * strength) as u8];
                self.scratch.extend(line.map(|node| Vertex { position: position(node), color, value: COLORED }));
            }
        }
        triangle_vertices
    }
}

/// How much is seen of lines that are so far apart, points: denser ones would hide the body's colours.
fn line_strength(spacing: f64) -> f64 {
    /// From here on they are drawn in full, and below the second not at all.
    const CLEAR: f64 = 6.0;
    const GONE: f64 = 2.0;
    // Not a number where a triangle has no extent: nothing to see.
    if spacing > GONE { ((spacing - GONE) / (CLEAR - GONE)).min(1.0) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dense_lines_fade() {
        assert_eq!([0.5, 2.0, 6.0, 60.0, f64::NAN].map(line_strength), [0.0, 0.0, 1.0, 1.0, 0.0]);
        assert!((0.4..0.6).contains(&line_strength(4.0)));
    }
}
