//! The body's pass: coloured triangles and the wireframe, multisampled into a texture.

use bytemuck::{Pod, Zeroable};
use nalgebra::Vector2;

use super::{Camera, FORMAT, Gpu, colormap};

/// What is drawn of a body.
#[derive(Clone, Copy, Debug)]
pub struct Frame<'a> {
    /// Node positions, m.
    pub positions: &'a [Vector2<f64>],
    /// Corners of the triangles.
    pub triangles: &'a [[u32; 3]],
    /// A value a triangle, if it has one.
    pub values: &'a [Option<f64>],
    /// The colour of triangles without, gamma space.
    pub absent_color: [u8; 3],
    /// The values at the two ends of the colour map.
    pub range: [f64; 2],
    /// Lines between nodes, over the triangles; empty for none.
    pub lines: &'a [[u32; 2]],
    /// Their colour, gamma space, straight alpha.
    pub line_color: [u8; 4],
    /// What is behind the body, gamma space.
    pub background: [u8; 3],
}

/// Four samples are what every WebGPU adapter has.
const SAMPLES: u32 = 4;

#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
struct Vertex {
    position: [f32; 2],
    color: [u8; 4],
}

#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
struct CameraUniform {
    scale: [f32; 2],
    padding: [f32; 2],
}

/// Draws bodies into a texture of its own.
#[derive(Debug)]
pub struct BodyRenderer {
    triangles: wgpu::RenderPipeline,
    lines: wgpu::RenderPipeline,
    camera: wgpu::Buffer,
    bind_group: wgpu::BindGroup,
    vertices: wgpu::Buffer,
    scratch: Vec<Vertex>,
    multisampled: wgpu::TextureView,
    resolved: wgpu::TextureView,
    size: [u32; 2],
}

impl BodyRenderer {
    /// Pipelines and a 1×1 target; [`Self::resize`] gives it its size.
    #[must_use]
    pub fn new(gpu: &Gpu) -> Self {
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
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("camera"),
            entries: &[wgpu::BindGroupLayoutEntry {
                binding: 0,
                visibility: wgpu::ShaderStages::VERTEX,
                ty: wgpu::BindingType::Buffer {
                    ty: wgpu::BufferBindingType::Uniform,
                    has_dynamic_offset: false,
                    min_binding_size: None,
                },
                count: None,
            }],
        });
        let bind_group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("camera"),
            layout: &layout,
            entries: &[wgpu::BindGroupEntry { binding: 0, resource: camera.as_entire_binding() }],
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
                        attributes: &wgpu::vertex_attr_array![0 => Float32x2, 1 => Unorm8x4],
                    })],
                },
                primitive: wgpu::PrimitiveState { topology, ..Default::default() },
                depth_stencil: None,
                multisample: wgpu::MultisampleState { count: SAMPLES, ..Default::default() },
                fragment: Some(wgpu::FragmentState {
                    module: &module,
                    entry_point: Some("fragment"),
                    compilation_options: wgpu::PipelineCompilationOptions::default(),
                    targets: &[Some(wgpu::ColorTargetState {
                        format: FORMAT,
                        blend: Some(wgpu::BlendState::ALPHA_BLENDING),
                        write_mask: wgpu::ColorWrites::ALL,
                    })],
                }),
                multiview_mask: None,
                cache: None,
            })
        };
        let [multisampled, resolved] = Self::targets(gpu, [1, 1]);
        Self {
            triangles: pipeline(wgpu::PrimitiveTopology::TriangleList),
            lines: pipeline(wgpu::PrimitiveTopology::LineList),
            camera,
            bind_group,
            vertices: Self::vertex_buffer(gpu, 1024),
            scratch: Vec::new(),
            multisampled,
            resolved,
            size: [1, 1],
        }
    }

    fn targets(gpu: &Gpu, size: [u32; 2]) -> [wgpu::TextureView; 2] {
        let view = |texture: wgpu::Texture| texture.create_view(&wgpu::TextureViewDescriptor::default());
        [
            view(gpu.target("body, multisampled", size, SAMPLES, wgpu::TextureUsages::empty())),
            view(gpu.target("body", size, 1, wgpu::TextureUsages::TEXTURE_BINDING)),
        ]
    }

    fn vertex_buffer(gpu: &Gpu, bytes: u64) -> wgpu::Buffer {
        gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("body"),
            size: bytes,
            usage: wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        })
    }

    /// Gives the target this size in pixels, within what the device can; says whether it is a new texture.
    pub fn resize(&mut self, gpu: &Gpu, size: [u32; 2]) -> bool {
        let size = size.map(|side| side.clamp(1, gpu.max_side()));
        if size == self.size {
            return false;
        }
        [self.multisampled, self.resolved] = Self::targets(gpu, size);
        self.size = size;
        true
    }

    /// The texture drawn into.
    #[must_use]
    pub fn texture(&self) -> &wgpu::TextureView {
        &self.resolved
    }

    /// Draws `frame` as `camera` sees it, with this many pixels a point.
    pub fn draw(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        frame: &Frame<'_>,
        camera: &Camera,
        pixels_per_point: f64,
    ) {
        let triangle_vertices = self.fill_vertices(frame, camera);
        let bytes: &[u8] = bytemuck::cast_slice(&self.scratch);
        if self.vertices.size() < bytes.len() as u64 {
            self.vertices = Self::vertex_buffer(gpu, (bytes.len() as u64).next_power_of_two());
        }
        gpu.queue.write_buffer(&self.vertices, 0, bytes);
        let clip_per_metre = self.size.map(|side| (2.0 * camera.scale * pixels_per_point / f64::from(side)) as f32);
        let uniform = CameraUniform { scale: clip_per_metre, padding: [0.0; 2] };
        gpu.queue.write_buffer(&self.camera, 0, bytemuck::bytes_of(&uniform));

        let [r, g, b] = frame.background.map(|c| f64::from(c) / 255.0);
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("body"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &self.multisampled,
                depth_slice: None,
                resolve_target: Some(&self.resolved),
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color { r, g, b, a: 1.0 }),
                    store: wgpu::StoreOp::Discard,
                },
            })],
            ..Default::default()
        });
        pass.set_bind_group(0, &self.bind_group, &[]);
        pass.set_vertex_buffer(0, self.vertices.slice(..));
        pass.set_pipeline(&self.triangles);
        pass.draw(0..triangle_vertices, 0..1);
        pass.set_pipeline(&self.lines);
        pass.draw(triangle_vertices..self.scratch.len() as u32, 0..1);
    }

    /// Triangle vertices, then line vertices; returns how many of the former.
    fn fill_vertices(&mut self, frame: &Frame<'_>, camera: &Camera) -> u32 {
        // Relative to the camera before it becomes f32: zoomed in far from the origin, digits matter.
        let position = |node: u32| {
            let d = frame.positions.get(node as usize).copied().unwrap_or_default() - camera.center;
            [d.x as f32, d.y as f32]
        };
        self.scratch.clear();
        for (triangle, &value) in frame.triangles.iter().zip(frame.values) {
            let color = |value| colormap::color(colormap::position(value, frame.range));
            let [r, g, b] = value.map_or(frame.absent_color, color);
            self.scratch.extend(triangle.map(|node| Vertex { position: position(node), color: [r, g, b, 255] }));
        }
        let triangle_vertices = self.scratch.len() as u32;
        for line in frame.lines {
            self.scratch.extend(line.map(|node| Vertex { position: position(node), color: frame.line_color }));
        }
        triangle_vertices
    }
}
