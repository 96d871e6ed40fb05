//! Drawings as pixels.

use skrifa::instance::{LocationRef, Size};
use skrifa::outline::{DrawSettings, OutlinePen};
use skrifa::{FontRef, GlyphId, MetadataProvider as _};
use vello_cpu::color::{AlphaColor, Srgb};
use vello_cpu::kurbo::{self, Affine, BezPath, Cap, Join, Point, Shape as _};
use vello_cpu::{Pixmap, RenderContext, Resources};

use super::drawing::{Anchor, Color, Drawing, DrawingItem, Outline, Shape, Stroke, Text};
use crate::image::{CHINESE_FONT, Picture, PictureError};

/// Fonts in the order in which a letter is looked for.
static FONTS: [&[u8]; 3] = [epaint_default_fonts::UBUNTU_LIGHT, epaint_default_fonts::HACK_REGULAR, CHINESE_FONT];
/// Accuracy of circles, pixels.
const ACCURACY: f64 = 0.01;

impl Drawing {
    /// Draws the pixels, without a GPU, with the same fonts on every machine.
    ///
    /// # Errors
    /// [`PictureError::TooLarge`].
    pub fn picture(&self) -> Result<Picture, PictureError> {
        let size = self.size.map(|side| side.ceil() as u32);
        let [Ok(width), Ok(height)] = size.map(u16::try_from) else { return Err(PictureError::TooLarge { size }) };
        let fonts: Vec<FontRef<'_>> = FONTS.iter().filter_map(|font| FontRef::new(font).ok()).collect();
        let mut context = RenderContext::new(width, height);
        for item in &self.items {
            match item {
                DrawingItem::Shape(shape) => shape.paint(&mut context),
                DrawingItem::Text(text) => text.paint(&mut context, &fonts),
                DrawingItem::Clip([[x, y], [width, height]]) => {
                    let rect = kurbo::Rect::from_origin_size((*x, *y), (*width, *height));
                    context.push_clip_layer(&rect.to_path(ACCURACY));
                }
                DrawingItem::EndClip => context.pop_layer(),
            }
        }
        context.flush();
        let mut pixels = Pixmap::new(width, height);
        context.render(&mut pixels, &mut Resources::new());
        // The paper is opaque, so premultiplied and straight alpha are the same.
        Ok(Picture { size, rgba: pixels.data_as_u8_slice().to_vec() })
    }
}

impl Shape {
    fn paint(&self, context: &mut RenderContext) {
        context.set_paint(color(self.color).with_alpha(self.opacity as f32));
        let path = self.outline.path();
        match self.stroke {
            None => context.fill_path(&path),
            Some(Stroke { width, dashes }) => {
                let stroke = kurbo::Stroke::new(width).with_caps(Cap::Butt).with_join(Join::Round);
                context.set_stroke(stroke.with_dashes(0.0, dashes));
                context.stroke_path(&path);
            }
        }
    }
}

impl Outline {
    fn path(&self) -> BezPath {
        let lines = |points: &[[f64; 2]]| {
            let mut path = BezPath::new();
            for (i, &[x, y]) in points.iter().enumerate() {
                if i == 0 { path.move_to((x, y)) } else { path.line_to((x, y)) }
            }
            path
        };
        match self {
            Self::Line(points) => lines(points),
            Self::Polygon(points) => {
                let mut path = lines(points);
                path.close_path();
                path
            }
            Self::Rect([[x, y], [width, height]]) => {
                kurbo::Rect::from_origin_size((*x, *y), (*width, *height)).to_path(ACCURACY)
            }
            Self::Circle([x, y], radius) => kurbo::Circle::new((*x, *y), *radius).to_path(ACCURACY),
        }
    }
}

impl Text {
    fn paint(&self, context: &mut RenderContext, fonts: &[FontRef<'_>]) {
        let mut path = BezPath::new();
        let mut pen = Pen { path: &mut path, at: 0.0 };
        let size = Size::new(self.size as f32);
        for letter in self.text.chars() {
            let Some((font, glyph)) = glyph(fonts, letter) else { continue };
            if let Some(outline) = font.outline_glyphs().get(glyph) {
                // Without hints an outline cannot fail but by a broken font; the letter is then left out.
                let _ = outline.draw(DrawSettings::unhinted(size, LocationRef::default()), &mut pen);
            }
            let advance = font.glyph_metrics(size, LocationRef::default()).advance_width(glyph);
            pen.at += f64::from(advance.unwrap_or_default());
        }
        let before = match self.anchor {
            Anchor::Start => 0.0,
            Anchor::Middle => 0.5,
            Anchor::End => 1.0,
        };
        let angle = if self.is_upright { -std::f64::consts::FRAC_PI_2 } else { 0.0 };
        let [x, y] = self.at;
        let start = Affine::translate((-before * pen.at, 0.0));
        path.apply_affine(Affine::translate((x, y)) * Affine::rotate(angle) * start);
        context.set_paint(color(self.color));
        context.fill_path(&path);
    }
}

/// The first font that has a letter, with the letter's number in it.
fn glyph<'a, 'b>(fonts: &'a [FontRef<'b>], letter: char) -> Option<(&'a FontRef<'b>, GlyphId)> {
    fonts.iter().find_map(|font| Some((font, font.charmap().map(letter)?)))
}

fn color([r, g, b]: Color) -> AlphaColor<Srgb> {
    AlphaColor::from_rgba8(r, g, b, u8::MAX)
}

/// Collects outlines of letters, with y downwards.
struct Pen<'a> {
    path: &'a mut BezPath,
    /// Place of the letter.
    at: f64,
}

impl Pen<'_> {
    fn point(&self, x: f32, y: f32) -> Point {
        Point::new(self.at + f64::from(x), -f64::from(y))
    }
}

impl OutlinePen for Pen<'_> {
    fn move_to(&mut self, x: f32, y: f32) {
        self.path.move_to(self.point(x, y));
    }

    fn line_to(&mut self, x: f32, y: f32) {
        self.path.line_to(self.point(x, y));
    }

    fn quad_to(&mut self, cx: f32, cy: f32, x: f32, y: f32) {
        self.path.quad_to(self.point(cx, cy), self.point(x, y));
    }

    fn curve_to(&mut self, ax: f32, ay: f32, bx: f32, by: f32, x: f32, y: f32) {
        self.path.curve_to(self.point(ax, ay), self.point(bx, by), self.point(x, y));
    }

    fn close(&mut self) {
        self.path.close_path();
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test may fail")]

    use super::super::drawing::{BLACK, solid};
    use super::*;

    const RED: Color = [0xff, 0, 0];

    fn pixel(picture: &Picture, [x, y]: [usize; 2]) -> &[u8] {
        &picture.rgba[4 * (y * picture.size[0] as usize + x)..][..3]
    }

    #[test]
    fn shapes_are_at_their_places() {
        let mut drawing = Drawing::new([40.0, 30.0]);
        drawing.rect([[10.0, 12.0], [5.0, 6.0]], RED);
        drawing.add(Shape::filled(Outline::Circle([30.0, 8.0], 4.0), BLACK));
        drawing.line(vec![[0.0, 25.0], [40.0, 25.0]], RED, Stroke { width: 2.0, dashes: &[8.0, 8.0] });
        drawing.clipped([[0.0, 0.0], [4.0, 30.0]], |drawing| drawing.rect([[0.0, 0.0], [20.0, 4.0]], BLACK));
        drawing.add(Shape { opacity: 0.5, ..Shape::filled(Outline::Rect([[36.0, 16.0], [4.0, 4.0]]), BLACK) });
        let picture = drawing.picture().unwrap();
        assert_eq!((picture.size, picture.rgba.len()), ([40, 30], 4 * 40 * 30));
        for at in [[10, 12], [14, 17], [1, 24], [6, 25], [20, 25]] {
            assert_eq!(pixel(&picture, at), RED, "{at:?}");
        }
        for at in [[30, 8], [32, 8], [2, 2]] {
            assert_eq!(pixel(&picture, at), BLACK, "{at:?}");
        }
        // Beside them, in the gap of the dashes, beyond the clip and after it.
        for at in [[9, 12], [15, 17], [12, 25], [8, 2], [35, 8]] {
            assert_eq!(pixel(&picture, at), [0xff; 3], "{at:?}");
        }
        assert!(pixel(&picture, [38, 18]).iter().all(|v| (0x7e..=0x81).contains(v)));
        drawing.line(vec![[0.0; 2], [1.0; 2]], RED, solid(1.0));
        assert_ne!(drawing.picture().unwrap(), picture);
    }

    #[test]
    fn texts_are_anchored() {
        /// Columns or rows that have ink, from the first to the last.
        fn inked(picture: &Picture, axis: usize) -> [usize; 2] {
            let [width, height] = picture.size.map(|side| side as usize);
            let all = (0..height).flat_map(|y| (0..width).map(move |x| [x, y]));
            let ink: Vec<usize> = all.filter(|&at| pixel(picture, at)[0] < 0xc0).map(|at| at[axis]).collect();
            [*ink.iter().min().unwrap(), *ink.iter().max().unwrap()]
        }
        for text in ["MMMM", "位移 αβ"] {
            for (anchor, [from, to]) in [(Anchor::Start, [50, 99]), (Anchor::Middle, [20, 80]), (Anchor::End, [0, 50])]
            {
                for is_upright in [false, true] {
                    let mut drawing = Drawing::new([100.0, 100.0]);
                    drawing.items.push(DrawingItem::Text(Text { is_upright, ..Text::new([50.0, 50.0], anchor, text) }));
                    let [low, high] = inked(&drawing.picture().unwrap(), usize::from(is_upright));
                    let [low, high] = if is_upright { [100 - high, 100 - low] } else { [low, high] };
                    assert!(from <= low && high <= to && high - low > 20, "{text} {anchor:?}: {low} to {high}");
                }
            }
        }
    }

    #[test]
    fn a_picture_beyond_all_sizes_is_refused() {
        assert!(matches!(Drawing::new([1e6, 10.0]).picture(), Err(PictureError::TooLarge { size: [1_000_000, 10] })));
    }
}
