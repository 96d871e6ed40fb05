//! Read-back of a texture to memory.

use super::{Gpu, RenderError};
use crate::image::Picture;

/// Waits for all submitted work, and copies a texture of four bytes a pixel, RGBA or BGRA, to memory.
pub fn read_texture(gpu: &Gpu, texture: &wgpu::Texture) -> Result<Picture, RenderError> {
    const PIXEL: u32 = 4;
    let failed = |reason: String| RenderError::ReadBack(reason);
    gpu.failure().map_or(Ok(()), |reason| Err(failed(reason)))?;
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
        // The receiver exists until the poll below returns.
        let _ = sender.send(result);
    });
    // Waiting for a lost device panics.
    gpu.failure().map_or(Ok(()), |reason| Err(failed(reason)))?;
    gpu.device.poll(wgpu::PollType::wait_indefinitely()).map_err(|e| failed(e.to_string()))?;
    receiver.recv().map_err(|e| failed(e.to_string()))?.map_err(|e| failed(e.to_string()))?;
    let mapped = slice.get_mapped_range().map_err(|e| failed(e.to_string()))?;
    let mut rgba: Vec<u8> =
        mapped.chunks_exact(padded_row as usize).flat_map(|line| &line[..row as usize]).copied().collect();
    // Pixels of a window can be BGRA.
    if matches!(texture.format(), wgpu::TextureFormat::Bgra8Unorm | wgpu::TextureFormat::Bgra8UnormSrgb) {
        rgba.as_chunks_mut().0.iter_mut().for_each(|pixel: &mut [u8; 4]| pixel.swap(0, 2));
    }
    Ok(Picture { size: [width, height], rgba })
}
