//! Pictures: from a texture to memory to a PNG file.

use std::io::BufWriter;
use std::path::Path;

use super::{Gpu, RenderError};

/// Rows of pixels, RGBA, eight bits each.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Picture {
    /// Width and height.
    pub size: [u32; 2],
    /// `4 · width · height` bytes, from the top.
    pub rgba: Vec<u8>,
}

impl Picture {
    /// Writes a PNG file.
    ///
    /// # Errors
    /// [`RenderError::Write`].
    pub fn write_png(&self, path: &Path) -> Result<(), RenderError> {
        let failed = |reason: String| RenderError::Write { path: path.to_owned(), reason };
        let file = std::fs::File::create(path).map_err(|e| failed(e.to_string()))?;
        let mut encoder = png::Encoder::new(BufWriter::new(file), self.size[0], self.size[1]);
        encoder.set_color(png::ColorType::Rgba);
        encoder.set_depth(png::BitDepth::Eight);
        let mut writer = encoder.write_header().map_err(|e| failed(e.to_string()))?;
        writer.write_image_data(&self.rgba).map_err(|e| failed(e.to_string()))?;
        writer.finish().map_err(|e| failed(e.to_string()))
    }
}

/// Draws an SVG picture, without a GPU, with the same fonts on every machine.
///
/// # Errors
/// [`RenderError::Svg`].
pub fn draw_svg(svg: &str) -> Result<Picture, RenderError> {
    let mut options = resvg::usvg::Options::default();
    let fonts = options.fontdb_mut();
    for data in egui::FontDefinitions::default().font_data.values() {
        fonts.load_font_data(data.font.as_ref().as_ref().to_vec());
    }
    let tree = resvg::usvg::Tree::from_str(svg, &options).map_err(|e| RenderError::Svg(e.to_string()))?;
    let size = tree.size().to_int_size();
    let mut pixels = resvg::tiny_skia::Pixmap::new(size.width(), size.height())
        .ok_or_else(|| RenderError::Svg("the picture has no size".to_owned()))?;
    resvg::render(&tree, resvg::tiny_skia::Transform::default(), &mut pixels.as_mut());
    // The background is opaque, so premultiplied and straight alpha are the same.
    Ok(Picture { size: [size.width(), size.height()], rgba: pixels.take() })
}

/// Waits for everything submitted, and copies an RGBA texture to memory.
///
/// # Errors
/// [`RenderError::ReadBack`].
pub fn read_texture(gpu: &Gpu, texture: &wgpu::Texture) -> Result<Picture, RenderError> {
    const PIXEL: u32 = 4;
    let (width, height) = (texture.width(), texture.height());
    let row = PIXEL * width;
    let padded_row = row.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
    let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("picture"),
        size: u64::from(padded_row) * u64::from(height),
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
        mapped_at_creation: false,
    });
    let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    encoder.copy_texture_to_buffer(
        texture.as_image_copy(),
        wgpu::TexelCopyBufferInfo {
            buffer: &buffer,
            layout: wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(padded_row),
                rows_per_image: Some(height),
            },
        },
        texture.size(),
    );
    gpu.queue.submit([encoder.finish()]);
    let slice = buffer.slice(..);
    let (sender, receiver) = std::sync::mpsc::channel();
    slice.map_async(wgpu::MapMode::Read, move |result| {
        // The receiver is there until the poll below returns.
        let _ = sender.send(result);
    });
    let failed = |reason: String| RenderError::ReadBack(reason);
    gpu.device.poll(wgpu::PollType::wait_indefinitely()).map_err(|e| failed(e.to_string()))?;
    receiver.recv().map_err(|e| failed(e.to_string()))?.map_err(|e| failed(e.to_string()))?;
    let mapped = slice.get_mapped_range().map_err(|e| failed(e.to_string()))?;
    let rgba = mapped.chunks_exact(padded_row as usize).flat_map(|line| &line[..row as usize]).copied().collect();
    Ok(Picture { size: [width, height], rgba })
}
