//! Render pass of the bodies: coloured triangles and the wireframe, multisampled, drawn directly into the frame.

use bytemuck::{Pod, Zeroable};
use nalgebra::{Matrix2, Vector2};

use super::colormap::ColorMap;
use super::{Camera, Gpu};
use crate::assembly::Kinematics;
use crate::rotation::Rotation;
use crate::scene::Material;
use crate::simulation::Field;
use crate::stress::Local;

/// Input for drawing a body.
#[derive(Clone, Copy, Debug)]
pub struct Frame<'a> {
    /// Revision number of positions, triangles, components and lines; equal numbers reuse the GPU upload.
    pub stamp: u64,
    /// Node positions, m.
    pub positions: &'a [Vector2<f64>],
    /// Triangles, as indices of nodes.
    pub triangles: &'a [[u32; 3]],
    /// Displayed field.
    pub field: Field,
    /// Components of the field at every position, which are interpolated: ε₁₁, ε₂₂, ε₁₂, cos θ, sin θ; or u_x, u_y; or
    /// the value of an element. The others are 0.
    pub components: &'a [Option<[f64; 5]>],
    /// Largest magnitude of a component that is not of the rotation.
    pub largest_component: f64,
    /// Material of the body.
    pub material: Material,
    /// Strain measure of the state.
    pub kinematics: Kinematics,
    /// Colour where the field has no value, gamma space.
    pub absent_color: [u8; 3],
    /// Values of the field at both ends of the colour map.
    pub range: [f64; 2],
    /// The colour map.
    pub map: ColorMap,
    /// Lines over the triangles, as indices of nodes; empty for none.
    pub lines: &'a [[u32; 2]],
    /// Triangle adjacent to each line. The line fades if the triangle's height on the screen is small, because the
    /// lines are then too close together.
    pub triangles_of_lines: &'a [u32],
    /// Number of triangles across an element.
    pub pieces: u32,
    /// Colour of the lines, gamma space, straight (not premultiplied) alpha.
    pub line_color: [u8; 4],
    /// Background colour of the view, gamma space.
    pub background: [u8; 3],
    /// Colour of the target outside the views, gamma space.
    pub surround: [u8; 3],
}

impl Frame<'_> {
    /// Returns the unit of the components in the shader. Rounding in f32 does not depend on units if components and
    /// values are of order 1.
    fn component_unit(&self) -> f64 {
        if self.largest_component > 0.0 { self.largest_component } else { 1.0 }
    }
}

/// Rectangle of a target, pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Viewport {
    /// Left and top edge.
    pub corner: [u32; 2],
    /// Width and height.
    pub size: [u32; 2],
}

impl Viewport {
    /// Returns the part of the rectangle that is inside a target of this size.
    fn within(self, target: [u32; 2]) -> Self {
        let corner = [0, 1].map(|axis| self.corner[axis].min(target[axis]));
        Self { corner, size: [0, 1].map(|axis| self.size[axis].min(target[axis] - corner[axis])) }
    }
}

/// Body in a rectangle of a target.
#[derive(Clone, Copy, Debug)]
pub struct View<'a> {
    /// Rectangle in which the body is drawn; all of it is filled.
    pub viewport: Viewport,
    /// Body and colours.
    pub frame: Frame<'a>,
    /// Camera.
    pub camera: Camera,
}

#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
struct Vertex {
    position: [f32; 2],
    /// Opaque: the colour of the vertex. Transparent: the colour where the field has no value.
    color: [u8; 4],
    /// First three components of the field, relative to the largest.
    components: [f32; 3],
    /// cos θ, sin θ.
    rotation: [f32; 2],
}

impl Vertex {
    /// Returns a vertex with a colour of its own.
    fn colored(position: [f32; 2], color: [u8; 4]) -> Self {
        Self { position, color, components: [0.0; 3], rotation: [0.0; 2] }
    }
}

/// Inputs that the vertices of a view were computed from.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Uploaded {
    stamp: u64,
    camera: Camera,
    pixels_per_point: f64,
    /// Size of the view, pixels.
    size: [u32; 2],
    field: (Field, Material, Kinematics),
    range: [f64; 2],
    lines: usize,
    colors: [[u8; 3]; 2],
    line_color: [u8; 4],
    /// Indices of the first vertex of its triangles, of its lines, and of the next view.
    parts: [u32; 3],
}

/// Number of samples of the colour map in the shader.
const MAP_COLORS: usize = 64;

#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
struct ViewUniform {
    scale: [f32; 2],
    range: [f32; 2],
    lambda: f32,
    mu: f32,
    thinning: f32,
    out_of_plane: f32,
    unit: f32,
    field: u32,
    is_corotated: u32,
    /// WebGL needs multiples of 16 bytes.
    padding: u32,
}

impl ViewUniform {
    /// Returns the uniform of a body, with clip space units per metre.
    fn new(frame: &Frame<'_>, scale: [f32; 2]) -> Self {
        let (material, lame) = (frame.material, frame.material.lame());
        let unit = frame.component_unit();
        let stress = material.young * unit;
        // The numbers are those of the fields in `mesh.wgsl`.
        let (field, value) = match frame.field {
            Field::MeshError | Field::DisplacementX | Field::StrainX => (0, unit),
            Field::DisplacementY | Field::StrainY => (1, unit),
            Field::ShearStrain => (2, unit),
            Field::Displacement | Field::ReferenceDistance => (3, unit),
            Field::RotationAngle => (4, 1.0),
            Field::LargestStrain => (5, unit),
            Field::LargerPrincipalStrain => (6, unit),
            Field::SmallerPrincipalStrain => (7, unit),
            Field::EnergyDensity => (8, stress * unit),
            Field::VonMises => (9, stress),
            Field::MaterialStressX => (10, stress),
            Field::MaterialStressY => (11, stress),
            Field::MaterialShearStress => (12, stress),
            Field::StressX => (13, stress),
            Field::StressY => (14, stress),
            Field::ShearStress => (15, stress),
            Field::LargerPrincipalStress => (16, stress),
            Field::SmallerPrincipalStress => (17, stress),
        };
        let [low, high] = frame.range.map(|end| end / value);
        let range = [low, high - low].map(|v| v as f32);
        let unit_trace = Local { strain: Matrix2::identity() * 0.5, rotation: Rotation::IDENTITY };
        Self {
            scale,
            // The shader takes the middle of the colour map for an empty range.
            range: if range.iter().all(|v| v.is_finite()) { range } else { [0.0; 2] },
            lambda: (lame.lambda / material.young) as f32,
            mu: (lame.mu / material.young) as f32,
            thinning: -unit_trace.strain(&material).zz as f32,
            out_of_plane: material.out_of_plane_stress(1.0) as f32,
            unit: unit as f32,
            field,
            is_corotated: u32::from(frame.kinematics == Kinematics::Corotated),
            padding: 0,
        }
    }
}

/// Creates a buffer of this size, bytes, which is written from the processor.
fn buffer(gpu: &Gpu, label: &str, size: u64, usage: wgpu::BufferUsages) -> wgpu::Buffer {
    let usage = usage | wgpu::BufferUsages::COPY_DST;
    gpu.device.create_buffer(&wgpu::BufferDescriptor { label: Some(label), size, usage, mapped_at_creation: false })
}

/// Renderer of bodies for targets of one format.
#[derive(Debug)]
pub struct BodyRenderer {
    backgrounds: wgpu::RenderPipeline,
    triangles: wgpu::RenderPipeline,
    lines: wgpu::RenderPipeline,
    layout: wgpu::BindGroupLayout,
    map: wgpu::Buffer,
    /// Colour map in the buffer `map`.
    uploaded_map: Option<ColorMap>,
    /// Uniform buffers with their bind groups, one per view; created on first use.
    bindings: Vec<(wgpu::Buffer, wgpu::BindGroup)>,
    vertices: wgpu::Buffer,
    scratch: Vec<Vertex>,
    /// Inputs of the vertices in the vertex buffer.
    uploaded: Vec<Uploaded>,
    format: wgpu::TextureFormat,
    /// Multisampled texture, which is resolved into the target; `None` without multisampling.
    multisampled: Option<wgpu::TextureView>,
    /// Size of the target, pixels.
    size: [u32; 2],
}

impl BodyRenderer {
    /// Creates the pipelines for targets of this format.
    pub fn new(gpu: &Gpu, format: wgpu::TextureFormat) -> Self {
        let device = &gpu.device;
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("body"),
            source: wgpu::ShaderSource::Wgsl(include_str!("../../shaders/mesh.wgsl").into()),
        });
        let size = size_of::<[[f32; 4]; MAP_COLORS]>() as u64;
        let map = buffer(gpu, "colour map", size, wgpu::BufferUsages::UNIFORM);
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
            label: Some("view"),
            entries: &[uniform(0, wgpu::ShaderStages::VERTEX_FRAGMENT), uniform(1, wgpu::ShaderStages::FRAGMENT)],
        });
        let pipeline_layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("body"),
            bind_group_layouts: &[Some(&layout)],
            immediate_size: 0,
        });
        let pipeline = |topology, fragment, blend| {
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
                        attributes: &wgpu::vertex_attr_array![0 => Float32x2, 1 => Unorm8x4, 2 => Float32x3, 3 => Float32x2],
                    })],
                },
                primitive: wgpu::PrimitiveState { topology, ..Default::default() },
                depth_stencil: None,
                multisample: wgpu::MultisampleState { count: gpu.samples(), ..Default::default() },
                fragment: Some(wgpu::FragmentState {
                    module: &module,
                    entry_point: Some(fragment),
                    compilation_options: wgpu::PipelineCompilationOptions::default(),
                    targets: &[Some(wgpu::ColorTargetState { format, blend, write_mask: wgpu::ColorWrites::ALL })],
                }),
                multiview_mask: None,
                cache: None,
            })
        };
        Self {
            // Separate pipelines speed up software rendering: opaque triangles are not blended, and flat colours need
            // no lookup.
            backgrounds: pipeline(wgpu::PrimitiveTopology::TriangleList, "flat_fragment", None),
            triangles: pipeline(wgpu::PrimitiveTopology::TriangleList, "mapped_fragment", None),
            lines: pipeline(wgpu::PrimitiveTopology::LineList, "flat_fragment", Some(wgpu::BlendState::ALPHA_BLENDING)),
            layout,
            map,
            uploaded_map: None,
            bindings: Vec::new(),
            vertices: buffer(gpu, "body", 1024, wgpu::BufferUsages::VERTEX),
            scratch: Vec::new(),
            uploaded: Vec::new(),
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

    /// Draws views, which must not overlap and must have the same colour map, into a target of this size, pixels, and
    /// fills all of the target. `pixels_per_point` converts the cameras' points to pixels.
    pub fn draw(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        (target, size): (&wgpu::TextureView, [u32; 2]),
        views: &[View<'_>],
        pixels_per_point: f64,
    ) {
        if size != self.size {
            self.multisampled = Self::multisampled(gpu, self.format, size);
            self.size = size;
        }
        let surround = views.first().map_or([0; 3], |view| view.frame.surround);
        let views = views.iter().map(|view| View { viewport: view.viewport.within(size), ..*view });
        let views: Vec<View<'_>> = views.filter(|view| !view.viewport.size.contains(&0)).collect();
        self.upload(gpu, &views, pixels_per_point);

        // All views have the same colour map.
        if let Some(map) = views.first().map(|view| view.frame.map).filter(|map| self.uploaded_map != Some(*map)) {
            let color = |i: usize| map.color(i as f64 / (MAP_COLORS - 1) as f64).map(|c| f32::from(c) / 255.0);
            let colors: [[f32; 4]; MAP_COLORS] = std::array::from_fn(|i| {
                let [r, g, b] = color(i);
                [r, g, b, 1.0]
            });
            gpu.queue.write_buffer(&self.map, 0, bytemuck::cast_slice(&colors));
            self.uploaded_map = Some(map);
        }

        let [r, g, b] = surround.map(|c| f64::from(c) / 255.0);
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
        pass.set_vertex_buffer(0, self.vertices.slice(..));
        let mut first = 0;
        for ((view, uploaded), (_, bind_group)) in views.iter().zip(&self.uploaded).zip(&self.bindings) {
            let Viewport { corner: [x, y], size: [width, height] } = view.viewport;
            let [triangles, lines, end] = uploaded.parts;
            pass.set_viewport(x as f32, y as f32, width as f32, height as f32, 0.0, 1.0);
            pass.set_scissor_rect(x, y, width, height);
            pass.set_bind_group(0, bind_group, &[]);
            for (pipeline, vertices) in
                [(&self.backgrounds, first..triangles), (&self.triangles, triangles..lines), (&self.lines, lines..end)]
            {
                pass.set_pipeline(pipeline);
                pass.draw(vertices, 0..1);
            }
            first = end;
        }
    }

    /// Uploads the vertices of all views and their uniforms, unless they are already uploaded.
    fn upload(&mut self, gpu: &Gpu, views: &[View<'_>], pixels_per_point: f64) {
        let wanted = |view: &View<'_>, parts| Uploaded {
            stamp: view.frame.stamp,
            camera: view.camera,
            pixels_per_point,
            size: view.viewport.size,
            field: (view.frame.field, view.frame.material, view.frame.kinematics),
            range: view.frame.range,
            lines: view.frame.lines.len(),
            colors: [view.frame.background, view.frame.absent_color],
            line_color: view.frame.line_color,
            parts,
        };
        let is_there = views.len() == self.uploaded.len()
            && views.iter().zip(&self.uploaded).all(|(view, uploaded)| wanted(view, uploaded.parts) == *uploaded);
        if is_there {
            return;
        }
        self.scratch.clear();
        self.uploaded.clear();
        for (i, view) in views.iter().enumerate() {
            let View { viewport, frame, camera } = view;
            let pixels_per_metre = camera.scale * pixels_per_point;
            let seen = viewport.size.map(|side| f64::from(side) / pixels_per_metre);
            let parts = self.add_vertices(frame, camera, seen);
            self.uploaded.push(wanted(view, parts));
            let clip_per_metre = viewport.size.map(|side| (2.0 * pixels_per_metre / f64::from(side)) as f32);
            let uniform = ViewUniform::new(frame, clip_per_metre);
            if self.bindings.len() == i {
                let own = buffer(gpu, "view", size_of::<ViewUniform>() as u64, wgpu::BufferUsages::UNIFORM);
                let bind_group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
                    label: Some("view"),
                    layout: &self.layout,
                    entries: &[
                        wgpu::BindGroupEntry { binding: 0, resource: own.as_entire_binding() },
                        wgpu::BindGroupEntry { binding: 1, resource: self.map.as_entire_binding() },
                    ],
                });
                self.bindings.push((own, bind_group));
            }
            gpu.queue.write_buffer(&self.bindings[i].0, 0, bytemuck::bytes_of(&uniform));
        }
        let bytes: &[u8] = bytemuck::cast_slice(&self.scratch);
        if self.vertices.size() < bytes.len() as u64 {
            let size = (bytes.len() as u64).next_power_of_two();
            self.vertices = buffer(gpu, "body", size, wgpu::BufferUsages::VERTEX);
        }
        gpu.queue.write_buffer(&self.vertices, 0, bytes);
    }

    /// Adds the vertices of the background, of the body's triangles, and of the lines. Returns the indices of the first
    /// triangle vertex and of the first line vertex, and the end. `view` is the visible size, m.
    fn add_vertices(&mut self, frame: &Frame<'_>, camera: &Camera, view: [f64; 2]) -> [u32; 3] {
        // Subtracted before the conversion to `f32`, to keep the precision at high magnification far from the origin.
        let position = |node: u32| {
            let d = frame.positions.get(node as usize).copied().unwrap_or_default() - camera.center;
            [d.x as f32, d.y as f32]
        };
        let [r, g, b] = frame.background;
        let [x, y] = view.map(|side| (0.5 * side) as f32);
        let corners = [[-x, -y], [x, -y], [x, y], [-x, -y], [x, y], [-x, y]];
        self.scratch.extend(corners.map(|corner| Vertex::colored(corner, [r, g, b, 255])));
        let triangles = self.scratch.len() as u32;
        let [r, g, b] = frame.absent_color;
        let unit = frame.component_unit();
        for triangle in frame.triangles {
            // A triangle whose components are missing at a corner is drawn without values.
            let corners = triangle.map(|node| frame.components.get(node as usize).copied().flatten());
            let is_known = corners.iter().all(Option::is_some);
            self.scratch.extend(triangle.iter().zip(corners).map(|(&node, components)| {
                let [x, y, xy, cos, sin] = components.unwrap_or_default();
                Vertex {
                    position: position(node),
                    color: [r, g, b, if is_known { 0 } else { 255 }],
                    components: [x, y, xy].map(|c| (c / unit) as f32),
                    rotation: [cos, sin].map(|c| c as f32),
                }
            }));
        }
        let lines = self.scratch.len() as u32;
        let at = |node: u32| frame.positions.get(node as usize).copied().unwrap_or_default();
        let [r, g, b, opacity] = frame.line_color;
        for (line, &triangles_of_lines) in frame.lines.iter().zip(frame.triangles_of_lines) {
            let Some(corners) = frame.triangles.get(triangles_of_lines as usize) else { continue };
            let [p, q, s] = corners.map(at);
            let length = (at(line[1]) - at(line[0])).norm();
            let height = (q - p).perp(&(s - p)).abs() / length * f64::from(frame.pieces);
            let strength = line_strength(height * camera.scale);
            if strength > 0.0 {
                let color = [r, g, b, (f64::from(opacity) * strength) as u8];
                self.scratch.extend(line.map(|node| Vertex::colored(position(node), color)));
            }
        }
        [triangles, lines, self.scratch.len() as u32]
    }
}

/// Returns the opacity of lines at this distance, points: denser lines would hide the colours of the body.
fn line_strength(spacing: f64) -> f64 {
    /// Distances, points, from which on lines are opaque, and up to which they are invisible.
    const CLEAR: f64 = 6.0;
    const GONE: f64 = 2.0;
    // The spacing of a degenerate triangle is NaN, for which the comparison is `false`.
    if spacing > GONE { ((spacing - GONE) / (CLEAR - GONE)).min(1.0) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::Picture;
    use crate::render::{FORMAT, colormap, read_texture};
    use crate::scene::Plane;

    fn drawn(gpu: &Gpu, renderer: &mut BodyRenderer, views: &[View<'_>]) -> Picture {
        let size = [120, 80];
        let texture = gpu.target("test", FORMAT, size, 1, wgpu::TextureUsages::COPY_SRC);
        let target = texture.create_view(&wgpu::TextureViewDescriptor::default());
        let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        renderer.draw(gpu, &mut encoder, (&target, size), views, 1.0);
        gpu.queue.submit([encoder.finish()]);
        read_texture(gpu, &texture).unwrap()
    }

    /// An upload is reused only if nothing visible has changed.
    #[test]
    fn a_used_renderer_draws_what_a_new_one_does() {
        let gpu = Gpu::headless(None).unwrap();
        let mut used = BodyRenderer::new(&gpu, FORMAT);
        let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(Vector2::from);
        let sheared = square.map(|x| Vector2::new(x.x + 0.5 * x.y, x.y));
        let frame = Frame {
            stamp: 1,
            positions: &square,
            triangles: &[[0, 1, 2], [0, 2, 3]],
            field: Field::MeshError,
            components: &[0.0, 0.2, 1.0, f64::NAN].map(|v| v.is_finite().then_some([v, 0.0, 0.0, 0.0, 0.0])),
            largest_component: 1.0,
            material: Material::default(),
            kinematics: Kinematics::Corotated,
            absent_color: [90, 90, 90],
            range: [0.0, 1.0],
            map: ColorMap::SequentialOnDark,
            lines: &[[0, 2], [1, 2]],
            triangles_of_lines: &[0, 0],
            pieces: 1,
            line_color: [255, 255, 255, 200],
            background: [20, 20, 30],
            surround: [60, 60, 60],
        };
        let viewport = Viewport { corner: [10, 0], size: [100, 80] };
        let view = View { viewport, frame, camera: Camera { center: Vector2::new(0.5, 0.5), scale: 50.0 } };
        let other_place = Viewport { corner: [0, 0], size: [50, 40] };
        let others: [Vec<View<'_>>; 11] = [
            vec![View { frame: Frame { stamp: 2, positions: &sheared, ..frame }, ..view }],
            vec![View { camera: Camera { scale: 30.0, ..view.camera }, ..view }],
            vec![View { frame: Frame { range: [0.0, 2.0], ..frame }, ..view }],
            vec![View { frame: Frame { lines: &[], triangles_of_lines: &[], ..frame }, ..view }],
            vec![View { frame: Frame { absent_color: [200, 0, 0], ..frame }, ..view }],
            vec![View { frame: Frame { background: [0, 90, 0], ..frame }, ..view }],
            vec![View { frame: Frame { line_color: [0, 0, 0, 255], ..frame }, ..view }],
            vec![View { frame: Frame { map: ColorMap::SequentialOnLight, ..frame }, ..view }],
            vec![View { viewport: other_place, ..view }],
            vec![
                View { viewport: other_place, ..view },
                View { viewport: Viewport { corner: [50, 30], size: [70, 50] }, ..view },
            ],
            vec![],
        ];
        let shown = drawn(&gpu, &mut used, &[view]);
        for (i, views) in others.iter().enumerate() {
            let other = drawn(&gpu, &mut used, views);
            assert!(other.rgba != shown.rgba, "change {i} is not seen");
            let fresh = drawn(&gpu, &mut BodyRenderer::new(&gpu, FORMAT), views);
            assert!(other.rgba == fresh.rgba, "change {i}: something from before is drawn");
            assert!(drawn(&gpu, &mut used, &[view]).rgba == shown.rgba, "change {i} stays");
        }
    }

    /// The shader computes the value at every pixel as [`Field::of_components`] does.
    #[test]
    fn pixels_have_the_colour_of_their_value() {
        let gpu = Gpu::headless(None).unwrap();
        let mut renderer = BodyRenderer::new(&gpu, FORMAT);
        let corners = [[0.0, 0.0], [120.0, 0.0], [0.0, 80.0]].map(Vector2::from);
        let viewport = Viewport { corner: [0, 0], size: [120, 80] };
        let camera = Camera { center: Vector2::new(60.0, 40.0), scale: 1.0 };
        // Bending with shear about a neutral axis through the triangle; a body that is inverted at a corner; and a large
        // rotation.
        let strains = [[1.0, -0.3, 0.2], [-0.8, 0.3, -0.1], [0.4, 0.2, 0.5]];
        let inverted = [[-1.3, 0.1, 0.0], [0.2, 0.3, 0.1], [0.1, -0.2, 0.3]];
        let angles = [2.8_f64, -0.4, 1.1];
        let turned = |strains: [[f64; 3]; 3]| {
            [0, 1, 2].map(|i: usize| [strains[i][0], strains[i][1], strains[i][2], angles[i].cos(), angles[i].sin()])
        };
        let (mut judged, mut absent) = (0, 0);
        for (young, poisson, plane, size) in [
            (1e6, 0.3, Plane::Stress, 0.2),
            (210e9, 0.499, Plane::Strain, 1e-3),
            (1e-3, -0.6, Plane::Strain, 0.3),
            (7e10, 0.2, Plane::Stress, 1e-22),
        ] {
            let material = Material { young, poisson, plane, ..Material::default() };
            let scaled = turned(strains.map(|own| own.map(|e| e * size)));
            let fields = Field::ALL.into_iter().flat_map(|field| match field {
                Field::VonMises | Field::StressX => vec![(field, scaled), (field, turned(inverted))],
                _ => vec![(field, scaled)],
            });
            for ((field, corners_components), kinematics) in
                fields.flat_map(|it| [(it, Kinematics::Corotated), (it, Kinematics::Linear)])
            {
                let value = |components| field.of_components(components, &material, kinematics);
                let largest = corners_components.iter().filter_map(|own| value(*own)).map(f64::abs).fold(0.0, f64::max);
                let magnitudes = corners_components.iter().flat_map(|own| &own[..3]).map(|c| c.abs());
                let frame = Frame {
                    stamp: 1 + judged,
                    positions: &corners,
                    triangles: &[[0, 1, 2]],
                    field,
                    components: &corners_components.map(Some),
                    largest_component: magnitudes.fold(0.0, f64::max),
                    material,
                    kinematics,
                    absent_color: [90, 90, 90],
                    range: field.range(largest),
                    map: ColorMap::SequentialOnDark,
                    lines: &[],
                    triangles_of_lines: &[],
                    pieces: 1,
                    line_color: [0; 4],
                    background: [200, 0, 0],
                    surround: [200, 0, 0],
                };
                let picture = drawn(&gpu, &mut renderer, &[View { viewport, frame, camera }]);
                for (x, y) in [(4, 70), (10, 40), (30, 60), (50, 50), (80, 70), (100, 76), (3, 10), (40, 45)] {
                    let at = [f64::from(x) + 0.5, 80.0 - (f64::from(y) + 0.5)];
                    let (b, c) = (at[0] / 120.0, at[1] / 80.0);
                    let weights = [1.0 - b - c, b, c];
                    let own = std::array::from_fn(|i| (0..3).map(|n| weights[n] * corners_components[n][i]).sum());
                    let wanted = value(own)
                        .map_or(frame.absent_color, |value| frame.map.color(colormap::position(value, frame.range)));
                    let pixel = &picture.rgba[(y as usize * 120 + x as usize) * 4..][..3];
                    let off = pixel.iter().zip(wanted).map(|(&p, w)| p.abs_diff(w)).max().unwrap();
                    let about = format!("{field:?} {kinematics:?} {material:?} at {x}, {y}");
                    assert!(off <= 4, "{about}: {pixel:?} is not {wanted:?}, {:?}", value(own));
                    judged += 1;
                    absent += u32::from(value(own).is_none());
                }
            }
        }
        assert!(absent > 0 && absent < 40, "{absent} of {judged}");
    }

    #[test]
    fn dense_lines_fade() {
        assert_eq!([0.5, 2.0, 6.0, 60.0, f64::NAN].map(line_strength), [0.0, 0.0, 1.0, 1.0, 0.0]);
        assert!((0.4..0.6).contains(&line_strength(4.0)));
    }
}
