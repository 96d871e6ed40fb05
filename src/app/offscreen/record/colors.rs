//! Palette of a whole recording, and the lookup of colours in it.

use std::collections::HashMap;
use std::iter::repeat_n;

use quantizr::{Image, Options, QuantizeResult};

use crate::image::Picture;

type Rgb = [u8; 3];

/// Largest number of colours of a GIF.
const MAX_COLORS: usize = 256;
/// Number of colours that are taken over exactly: the most frequent ones, so that backgrounds and texts keep their
/// colours.
const EXACT: usize = 32;

/// At most 256 colours that represent all colours.
#[derive(Debug)]
pub(super) struct GifPalette {
    colors: Vec<Rgb>,
    /// Indices of colours looked up so far.
    known: HashMap<Rgb, u8>,
}

impl GifPalette {
    /// Makes a palette for pictures like these.
    pub(super) fn of(pictures: &[Picture]) -> Self {
        let mut counts: HashMap<Rgb, u64> = HashMap::new();
        for color in pictures.iter().flat_map(colors) {
            *counts.entry(color).or_default() += 1;
        }
        let mut counts: Vec<_> = counts.into_iter().collect();
        // Sorted by frequency, then by value, so that the result is the same in every run.
        counts.sort_by_key(|&(color, count)| (std::cmp::Reverse(count), color));
        let rare = counts.split_off(counts.len().min(if counts.len() > MAX_COLORS { EXACT } else { MAX_COLORS }));
        let mut palette: Vec<Rgb> = counts.into_iter().map(|(color, _)| color).collect();
        palette.extend(quantized(&rare, MAX_COLORS - palette.len()));
        if palette.is_empty() {
            palette.push([0; 3]);
        }
        Self { colors: palette, known: HashMap::new() }
    }

    /// Returns red, green and blue of all colours.
    pub(super) fn bytes(&self) -> &[u8] {
        self.colors.as_flattened()
    }

    /// Computes the palette indices of an image's pixels, without dithering, whose pattern would flicker.
    pub(super) fn indices(&mut self, picture: &Picture, indices: &mut Vec<u8>) {
        /// Largest number of cached colours.
        const MAX_KNOWN: usize = 1 << 18;
        let Self { colors: palette, known } = self;
        if known.len() > MAX_KNOWN {
            known.clear();
        }
        indices.clear();
        let mut last = None;
        for color in colors(picture) {
            // Adjacent pixels mostly have the same colour.
            let place = match last {
                Some((before, found)) if before == color => found,
                _ => *known.entry(color).or_insert_with(|| nearest(palette, color)),
            };
            last = Some((color, place));
            indices.push(place);
        }
    }
}

fn colors(picture: &Picture) -> impl Iterator<Item = Rgb> {
    picture.rgba.as_chunks().0.iter().map(|&[r, g, b, _]: &[u8; 4]| [r, g, b])
}

/// Returns the index of the nearest colour.
fn nearest(palette: &[Rgb], color: Rgb) -> u8 {
    let distance = |other: &Rgb| -> u32 {
        // The eye is most sensitive to green, and least to blue.
        other.iter().zip(color).zip([3, 6, 1]).map(|((&a, b), weight)| weight * u32::from(a.abs_diff(b)).pow(2)).sum()
    };
    (0..=u8::MAX).zip(palette).min_by_key(|(_, other)| distance(other)).map_or(0, |(place, _)| place)
}

/// Means of groups of similar colours, of which a frequent one weighs more than a rare one.
fn quantized(colors: &[(Rgb, u64)], most: usize) -> Vec<Rgb> {
    // The square root of the count: rare colours of the body matter beside the large areas of the background. It also keeps
    // sums of colours exact in quantizr's single precision, which would else cut groups of a single colour.
    let pixels = colors.iter().flat_map(|&([r, g, b], count)| repeat_n([r, g, b, u8::MAX], count.isqrt() as usize));
    let pixels: Vec<u8> = pixels.flatten().collect();
    let mut options = Options::default();
    let Ok(image) = Image::new(&pixels, pixels.len() / 4, 1) else { return Vec::new() };
    if pixels.is_empty() || options.set_max_colors(most as i32).is_err() {
        return Vec::new();
    }
    let result = QuantizeResult::quantize(&image, &options);
    let palette = result.get_palette();
    palette.entries.iter().take(palette.count as usize).map(|color| [color.r, color.g, color.b]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(colors: impl Iterator<Item = Rgb>) -> Picture {
        let rgba: Vec<u8> = colors.flat_map(|[r, g, b]| [r, g, b, 255]).collect();
        Picture { size: [rgba.len() as u32 / 4, 1], rgba }
    }

    #[test]
    fn few_colours_stay_as_they_are() {
        let few = picture((0..200).map(|i| [i, 255 - i, 7]));
        let mut palette = GifPalette::of(std::slice::from_ref(&few));
        let mut indices = Vec::new();
        palette.indices(&few, &mut indices);
        for (pixel, index) in few.rgba.chunks(4).zip(&indices) {
            assert_eq!(&pixel[..3], &palette.bytes()[3 * usize::from(*index)..][..3]);
        }
    }

    #[test]
    fn many_colours_are_near_ones_and_the_background_is_exact() {
        let background = [22, 24, 28];
        // A gradient, another gradient that is wide, and a large background.
        let gradient = (0..4000_u32).map(|i| [(i / 16) as u8, (i / 20) as u8, 128 - (i / 40) as u8]);
        let many = picture(gradient.chain(std::iter::repeat_n(background, 9000)));
        let mut palette = GifPalette::of(std::slice::from_ref(&many));
        assert!(palette.bytes().len() <= 3 * MAX_COLORS);
        let mut indices = Vec::new();
        palette.indices(&many, &mut indices);
        for (pixel, index) in many.rgba.chunks(4).zip(&indices) {
            let color = &palette.bytes()[3 * usize::from(*index)..][..3];
            let off = pixel.iter().zip(color).map(|(a, b)| a.abs_diff(*b)).max();
            assert!(off <= Some(if pixel[..3] == background { 0 } else { 4 }), "{pixel:?} {color:?}");
        }
    }

    #[test]
    fn no_picture_has_a_palette_too() {
        assert_eq!(GifPalette::of(&[]).bytes(), [0, 0, 0]);
    }
}
