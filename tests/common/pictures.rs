//! Pictures of scenes, and measures of their difference.
#![allow(dead_code, reason = "each test uses its part")]

use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use warpbeam::app::{Lab, Picture};
use warpbeam::scene::Analysis;

use super::lab::lab_of;
use super::{scene, scene_with};

/// Returns the `--set` assignments for a scene's picture: a body in motion is drawn half a second after its start.
pub fn for_picture(id: &str) -> &'static [&'static str] {
    match scene(id).analysis {
        Analysis::Dynamic => &["dynamics.duration=0.5"],
        _ => &[],
    }
}

/// Returns a lab with a built-in scene, changed by [`for_picture`].
pub fn lab(id: &str) -> Lab {
    lab_of(id, scene_with(id, for_picture(id)))
}

pub fn read_png(path: &Path) -> Picture {
    let file = File::open(path).unwrap_or_else(|e| unreachable!("{}: {e}", path.display()));
    let mut reader = png::Decoder::new(BufReader::new(file)).read_info().unwrap();
    let mut rgba = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut rgba).unwrap();
    assert_eq!((info.color_type, info.bit_depth), (png::ColorType::Rgba, png::BitDepth::Eight));
    Picture { size: [info.width, info.height], rgba }
}

pub fn pixel(picture: &Picture, x: u32, y: u32) -> [u8; 3] {
    let at = 4 * (y * picture.size[0] + x) as usize;
    [picture.rgba[at], picture.rgba[at + 1], picture.rgba[at + 2]]
}

/// Returns the largest difference of two colours' components.
pub fn distance(a: [u8; 3], b: [u8; 3]) -> u8 {
    a.iter().zip(b).map(|(a, b)| a.abs_diff(b)).max().unwrap()
}

/// Returns the share of pixels that differ visibly, that is by more than the antialiasing of different drivers.
pub fn difference(a: &Picture, b: &Picture) -> f64 {
    const VISIBLE: u8 = 24;
    assert_eq!(a.size, b.size);
    let pixels = a.rgba.chunks(4).zip(b.rgba.chunks(4));
    let different = pixels.filter(|(a, b)| a.iter().zip(*b).any(|(a, b)| a.abs_diff(*b) > VISIBLE)).count();
    different as f64 / f64::from(a.size[0] * a.size[1])
}
