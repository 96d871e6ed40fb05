//! Images in memory, written as PNG files.

use std::path::Path;

use thiserror::Error;

/// Reason why an image could not be made.
#[derive(Debug, Error)]
#[error("{0}")]
pub struct PictureError(String);

/// Pixels of an image, RGBA, eight bits per channel.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Picture {
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// `4 · width · height` bytes, rows from top to bottom.
    pub rgba: Vec<u8>,
}

impl Picture {
    /// Writes a PNG file.
    pub fn write_png(&self, path: &Path) -> Result<(), PictureError> {
        let failed = |error: std::io::Error| PictureError(format!("{}: {error}", path.display()));
        std::fs::write(path, self.png()?).map_err(failed)
    }

    /// Returns the bytes of a PNG file.
    pub fn png(&self) -> Result<Vec<u8>, PictureError> {
        let failed = |error: png::EncodingError| PictureError(format!("the picture cannot be encoded: {error}"));
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, self.size[0], self.size[1]);
        encoder.set_color(png::ColorType::Rgba);
        encoder.set_depth(png::BitDepth::Eight);
        let mut writer = encoder.write_header().map_err(failed)?;
        writer.write_image_data(&self.rgba).map_err(failed)?;
        writer.finish().map_err(failed)?;
        Ok(bytes)
    }
}

/// Font with the Chinese glyphs of the window.
pub(crate) static CHINESE_FONT: &[u8] = include_bytes!("../assets/fonts/NotoSansSC-subset.otf");
