//! Images in memory, written as PNG and rendered from SVG.

use std::io::BufWriter;
use std::path::{Path, PathBuf};

use thiserror::Error;

/// Reason why an image could not be made.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum PictureError {
    /// The SVG cannot be drawn.
    #[error("the picture cannot be drawn: {0}")]
    Svg(String),
    /// The picture cannot be written.
    #[error("{path}: {reason}", path = path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// The reason.
        reason: String,
    },
}

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
    ///
    /// # Errors
    /// [`PictureError::Write`].
    pub fn write_png(&self, path: &Path) -> Result<(), PictureError> {
        let failed = |reason: String| PictureError::Write { path: path.to_owned(), reason };
        let file = std::fs::File::create(path).map_err(|e| failed(e.to_string()))?;
        let mut encoder = png::Encoder::new(BufWriter::new(file), self.size[0], self.size[1]);
        encoder.set_color(png::ColorType::Rgba);
        encoder.set_depth(png::BitDepth::Eight);
        let mut writer = encoder.write_header().map_err(|e| failed(e.to_string()))?;
        writer.write_image_data(&self.rgba).map_err(|e| failed(e.to_string()))?;
        writer.finish().map_err(|e| failed(e.to_string()))
    }
}

/// Font with the Chinese glyphs of the window.
pub(crate) const CHINESE_FONT: &[u8] = include_bytes!("../assets/fonts/NotoSansSC-subset.otf");

/// Renders an SVG image without a GPU, with the same fonts on every machine.
///
/// # Errors
/// [`PictureError::Svg`].
pub fn draw_svg(svg: &str) -> Result<Picture, PictureError> {
    let mut options = resvg::usvg::Options::default();
    let fonts = options.fontdb_mut();
    for font in [epaint_default_fonts::UBUNTU_LIGHT, epaint_default_fonts::HACK_REGULAR, CHINESE_FONT] {
        fonts.load_font_data(font.to_vec());
    }
    let tree = resvg::usvg::Tree::from_str(svg, &options).map_err(|e| PictureError::Svg(e.to_string()))?;
    let size = tree.size().to_int_size();
    let mut pixels = resvg::tiny_skia::Pixmap::new(size.width(), size.height())
        .ok_or_else(|| PictureError::Svg("the picture has no size".to_owned()))?;
    resvg::render(&tree, resvg::tiny_skia::Transform::default(), &mut pixels.as_mut());
    // The background is opaque, so premultiplied and straight alpha are the same.
    Ok(Picture { size: [size.width(), size.height()], rgba: pixels.take() })
}
