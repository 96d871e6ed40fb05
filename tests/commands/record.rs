//! Tests of recordings, decoded as a viewer decodes them.

use std::fs::{self, File};
use std::path::Path;

use crate::common::*;

/// A decoded recording: its size, and each picture in RGB with the time that it is shown, s.
struct Movie {
    size: [usize; 2],
    frames: Vec<(Vec<u8>, f64)>,
}

fn decode_gif(path: &Path) -> Movie {
    let mut decoder = gif::Decoder::new(File::open(path).unwrap()).unwrap();
    let (width, height) = (usize::from(decoder.width()), usize::from(decoder.height()));
    assert_eq!(decoder.repeat(), gif::Repeat::Infinite);
    let palette = decoder.global_palette().unwrap().to_vec();
    let mut canvas = vec![0; 3 * width * height];
    let mut frames = Vec::new();
    while let Some(frame) = decoder.read_next_frame().unwrap() {
        assert!(frame.palette.is_none(), "one palette");
        for (y, row) in frame.buffer.chunks(usize::from(frame.width)).enumerate() {
            for (x, &index) in row.iter().enumerate() {
                let at = 3 * ((usize::from(frame.top) + y) * width + usize::from(frame.left) + x);
                canvas[at..at + 3].copy_from_slice(&palette[3 * usize::from(index)..][..3]);
            }
        }
        frames.push((canvas.clone(), f64::from(frame.delay) / 100.0));
    }
    Movie { size: [width, height], frames }
}

/// The numbered pictures of a folder, in RGB. It has nothing else.
fn decode_folder(folder: &Path) -> Vec<([usize; 2], Vec<u8>)> {
    let count = fs::read_dir(folder).unwrap().count();
    let pictures = (1..=count).map(|k| pictures::read_png(&folder.join(format!("frame-{k:04}.png"))));
    let rgb = |rgba: &[u8]| rgba.chunks(4).flat_map(|pixel| pixel[..3].to_vec()).collect();
    pictures.map(|picture| (picture.size.map(|side| side as usize), rgb(&picture.rgba))).collect()
}

fn record(folder: &Path, args: &[&str]) -> String {
    succeeds_in(folder, &[&["record"], args].concat())
}

/// Returns the largest and the mean difference of two pictures.
fn difference(a: &[u8], b: &[u8]) -> (u8, f64) {
    assert_eq!(a.len(), b.len());
    let off = a.iter().zip(b).map(|(a, b)| a.abs_diff(*b));
    (off.clone().max().unwrap_or(0), off.map(f64::from).sum::<f64>() / a.len() as f64)
}

/// Both formats show the same: the requested number of pictures, all different, in GIF with its nearest colours.
#[test]
fn a_motion_is_recorded_in_every_format() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let args = ["swing", "--seconds", "0.4", "--size", "320x200"];
    let text = record(folder, &[&args[..], &["-o", "swing.gif"]].concat());
    assert!(text.contains("11 pictures, 25 per second"), "{text}");
    record(folder, &[&args[..], &["-o", "frames"]].concat());
    let (gif, pngs) = (decode_gif(&folder.join("swing.gif")), decode_folder(&folder.join("frames")));
    assert_eq!((gif.size, gif.frames.len()), ([320, 200], 11));
    assert_eq!(pngs.len(), 11);
    assert!(gif.frames.iter().all(|(_, delay)| (delay - 0.04).abs() < 1e-9));
    for (k, ((gif, _), (size, png))) in gif.frames.iter().zip(&pngs).enumerate() {
        assert_eq!(*size, [320, 200], "picture {k}");
        let (_, mean) = difference(gif, png);
        assert!(mean < 0.5, "picture {k}: colours are off by {mean} on average");
        // The background's colour is exact.
        assert_eq!(gif[..3], png[..3]);
    }
    assert!(gif.frames.windows(2).all(|w| w[0].0 != w[1].0) && pngs.windows(2).all(|w| w[0] != w[1]), "it moves");
    record(folder, &[&args[..], &["-o", "again.gif"]].concat());
    assert_eq!(fs::read(folder.join("swing.gif")).unwrap(), fs::read(folder.join("again.gif")).unwrap());
}

/// Camera and colours are fixed: nothing changes at the clamp and in the legend.
#[test]
fn camera_and_colours_stay_the_same_through_a_recording() {
    let folder = tempfile::tempdir().unwrap();
    record(folder.path(), &["swing", "--seconds", "1", "--fps", "5", "--size", "400x300", "-o", "frames"]);
    let pictures = decode_folder(&folder.path().join("frames"));
    assert_eq!(pictures.len(), 6);
    // The legend's words and colours, and the scale: the lowest sixth of the picture.
    let below = |rgb: &[u8]| rgb[3 * 400 * 250..].to_vec();
    for (_, rgb) in &pictures[1..] {
        assert_eq!(below(rgb), below(&pictures[0].1), "the range or the scale moved");
    }
}

#[test]
fn rates_are_rounded_to_those_of_the_format_and_slow_motion_is_slow() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let short = ["swing", "--size", "64x64", "--seconds", "0.2"];
    let text = record(folder, &[&short[..], &["--fps", "30", "-o", "a.gif"]].concat());
    assert!(text.contains("7 pictures, 33.33 per second") && text.contains("cannot have 30"), "{text}");
    assert!(decode_gif(&folder.join("a.gif")).frames.iter().all(|(_, delay)| (delay - 0.03).abs() < 1e-9));
    let text = record(folder, &[&short[..], &["--fps", "30", "-o", "frames"]].concat());
    assert!(text.contains("7 pictures, 30 per second\n"), "{text}");
    // A tenth of the speed gives ten times as many pictures of the same time.
    record(folder, &[&short[..], &["--speed", "0.1", "-o", "slow.gif"]].concat());
    assert_eq!(decode_gif(&folder.join("slow.gif")).frames.len(), 51);
}

/// The story is recorded without a scene, in full and the same every time.
#[test]
fn the_story_is_recorded_in_place_of_a_scene() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let args = ["--story", "--fps", "2", "--size", "400x300"];
    let text = record(folder, &[&args[..], &["-o", "a.gif"]].concat());
    assert!(text.contains("40 pictures, 2 per second"), "{text}");
    let movie = decode_gif(&folder.join("a.gif"));
    assert_eq!((movie.size, movie.frames.len()), ([400, 300], 40));
    assert!(movie.frames.windows(2).filter(|pair| pair[0].0 != pair[1].0).count() > 15, "the body stands still");
    record(folder, &[&args[..], &["-o", "b.gif"]].concat());
    assert_eq!(fs::read(folder.join("a.gif")).unwrap(), fs::read(folder.join("b.gif")).unwrap());
    for refused in [&["--story", "article"][..], &["--story", "--seconds", "2"], &[]] {
        ends_in(folder, 2, &[&["record", "-o", "c.gif"], refused].concat());
    }
}

/// The path to an equilibrium is recorded with one iteration per picture, and the last picture stays longer.
#[test]
fn a_search_is_recorded_iteration_by_iteration() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let iterations = solve_json(&["elastica"])["iterations"].as_u64().unwrap() as usize;
    record(folder, &["elastica", "--size", "200x200", "-o", "a.gif"]);
    record(folder, &["elastica", "--size", "200x200", "-o", "frames"]);
    let movie = decode_gif(&folder.join("a.gif"));
    assert_eq!(movie.frames.len(), iterations + 1);
    let (last, others) = movie.frames.split_last().unwrap();
    assert!(others.iter().all(|(_, delay)| (delay - 0.25).abs() < 1e-9) && (last.1 - 2.25).abs() < 1e-9);
    assert_eq!(fs::read_dir(folder.join("frames")).unwrap().count(), iterations + 1 + 8);
    let args = ["record", "cantilever", "--set", "load.0.force=[0,-9000]", "--size", "64x64", "-o", "diverged"];
    assert!(ends_in(folder, 1, &args)[1].contains("diverged"));
    assert!(decode_folder(&folder.join("diverged")).len() > 1);
    // A motion that explodes is recorded up to that point.
    let args = ["record", "swing", "--set", "dynamics.integrator=symplectic-euler", "--size", "64x64", "-o", "a.gif"];
    let [_, said] = ends_in(folder, 1, &args);
    assert!(said.contains("stopped: the motion exploded"), "{said}");
    let frames = decode_gif(&folder.join("a.gif")).frames.len();
    assert!((1..51).contains(&frames), "{frames}");
}

/// Ctrl-C leaves a shorter recording that every viewer can open.
#[cfg(target_os = "linux")]
#[test]
fn an_interrupted_recording_is_shorter_and_valid() {
    use crate::common::process::{Signal, interrupted};
    let folder = tempfile::tempdir().unwrap();
    for name in ["a.gif", "frames"] {
        let path = folder.path().join(name);
        // Slow motion: the motion is short, and its pictures are many.
        let args = ["record", "swing", "--speed", "0.001", "--size", "128x128", "-o", name];
        let output = interrupted(folder.path(), &args, Signal::SIGINT, || match name {
            "frames" => fs::read_dir(&path).is_ok_and(|pictures| pictures.count() > 10),
            _ => fs::metadata(&path).is_ok_and(|file| file.len() > 30_000),
        });
        assert!(stderr(&output).contains("the recording is partial"), "{}", stderr(&output));
        let pictures = if name == "a.gif" { decode_gif(&path).frames.len() } else { decode_folder(&path).len() };
        assert!((1..50_000).contains(&pictures));
        let said = format!("{pictures} picture");
        assert!(stdout(&output).contains(&said), "{said}: {}", stdout(&output));
    }
    let args = ["record", "swing", "--seconds", "1e5", "-o", "none.gif"];
    let output = interrupted(folder.path(), &args, Signal::SIGINT, || true);
    assert!(stderr(&output).contains("nothing was written"), "{}", stderr(&output));
    assert!(!folder.path().join("none.gif").exists());
}
