//! Files of frames: animated GIF or PNG, or a folder of images.

use std::fs::File;
use std::io::{BufWriter, Seek as _, SeekFrom, Write as _};
use std::path::{Path, PathBuf};

use super::RecordError;
use super::colors::GifPalette;
use crate::image::Picture;

/// Format of a recording.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MovieFormat {
    /// Animated GIF: supported everywhere, 256 colours.
    Gif,
    /// A folder of numbered PNG files.
    Folder,
}

/// Returns a duration, s, in the unit of a GIF, 1/100 s.
fn hundredths(seconds: f64) -> u16 {
    (100.0 * seconds).round() as u16
}

impl MovieFormat {
    /// Returns the format for a path.
    ///
    /// # Errors
    /// [`RecordError::UnknownFormat`], and [`RecordError::NoFolder`] if the file's folder does not exist.
    pub fn of(path: &Path) -> Result<Self, RecordError> {
        let is_folder = path.is_dir() || path.file_name().is_some() && path.extension().is_none();
        let is_gif = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("gif"));
        match path.parent().filter(|folder| !folder.as_os_str().is_empty() && !folder.is_dir()) {
            _ if is_folder => Ok(Self::Folder),
            _ if !is_gif => Err(RecordError::UnknownFormat(path.to_owned())),
            Some(folder) => Err(RecordError::NoFolder(folder.to_owned())),
            None => Ok(Self::Gif),
        }
    }

    /// Returns the duration of a frame at this rate, or the nearest one that the format supports, s.
    pub(super) fn delay(self, rate: u16) -> f64 {
        /// Viewers replace shorter delays of a GIF, in 1/100 s, by a longer default.
        const SHORTEST: u16 = 2;
        let wanted = 1.0 / f64::from(rate.max(1));
        match self {
            Self::Gif => f64::from(hundredths(wanted).max(SHORTEST)) / 100.0,
            Self::Folder => wanted,
        }
    }
}

/// Recording that is being written to its file or folder. A GIF that is dropped unfinished ends after its last whole
/// frame; without one its file is removed.
pub(super) struct Film {
    path: PathBuf,
    /// Duration of a frame, s.
    delay: f64,
    /// Number of frames.
    pictures: u64,
    /// Length of the GIF with these frames, bytes.
    length: u64,
    /// `None` for a folder, and once the GIF is finished.
    gif: Option<Box<Gif>>,
}

struct Gif {
    encoder: gif::Encoder<BufWriter<File>>,
    palette: GifPalette,
    before: Vec<u8>,
    now: Vec<u8>,
}

/// Removes the numbered images of an earlier recording from a folder.
///
/// # Errors
/// [`RecordError::HasPictures`] if there are some and `overwrite` is `false`.
pub(super) fn clear(folder: &Path, overwrite: bool) -> Result<(), RecordError> {
    let is_picture = |path: &PathBuf| {
        let number = path.file_name().and_then(|name| name.to_str()?.strip_prefix("frame-")?.strip_suffix(".png"));
        number.is_some_and(|number| number.len() >= 4 && number.bytes().all(|b| b.is_ascii_digit()))
    };
    // A folder that does not exist has no images.
    let Ok(entries) = std::fs::read_dir(folder) else { return Ok(()) };
    let pictures: Vec<PathBuf> = entries.filter_map(|entry| Some(entry.ok()?.path())).filter(is_picture).collect();
    if !pictures.is_empty() && !overwrite {
        return Err(RecordError::HasPictures { folder: folder.to_owned(), count: pictures.len() });
    }
    for picture in &pictures {
        std::fs::remove_file(picture).map_err(|error| failed(picture, &error))?;
    }
    Ok(())
}

impl Film {
    /// Starts a recording of pictures that look like `samples`.
    pub(super) fn create(
        path: &Path,
        format: MovieFormat,
        delay: f64,
        samples: &[Picture],
    ) -> Result<Self, RecordError> {
        let failed = |reason: &dyn std::fmt::Display| failed(path, reason);
        let file = || Ok(BufWriter::new(File::create(path).map_err(|e| failed(&e))?));
        let gif = match format {
            MovieFormat::Gif => {
                let palette = GifPalette::of(samples);
                // A side of a frame has at most 8192 pixels.
                let size = samples.first().map_or([0; 2], |sample| sample.size);
                let [width, height] = size.map(|side| u16::try_from(side).unwrap_or(u16::MAX));
                let mut encoder = gif::Encoder::new(file()?, width, height, palette.bytes()).map_err(|e| failed(&e))?;
                encoder.set_repeat(gif::Repeat::Infinite).map_err(|e| failed(&e))?;
                Some(Box::new(Gif { encoder, palette, before: Vec::new(), now: Vec::new() }))
            }
            MovieFormat::Folder => {
                std::fs::create_dir_all(path).map_err(|e| failed(&e))?;
                None
            }
        };
        Ok(Self { path: path.to_owned(), delay, pictures: 0, length: 0, gif })
    }

    /// Adds a frame whose duration is `hold` s longer than that of others.
    pub(super) fn add(&mut self, picture: &Picture, hold: f64) -> Result<(), RecordError> {
        let Self { path, delay, pictures, length, gif } = self;
        let failed = |reason: &dyn std::fmt::Display| failed(path, reason);
        match gif {
            Some(gif) => {
                gif.add(picture, *delay + hold).map_err(|e| failed(&e))?;
                let file = gif.encoder.get_mut();
                *length = file.flush().and_then(|()| file.stream_position()).map_err(|e| failed(&e))?;
            }
            None => {
                let copies = 1 + (hold / *delay).round() as u64;
                for copy in 1..=copies {
                    let path = path.join(format!("frame-{:04}.png", *pictures + copy));
                    picture.write_png(&path).map_err(|e| RecordError::Write { path, reason: e.to_string() })?;
                }
            }
        }
        *pictures += 1;
        Ok(())
    }

    /// Ends the file.
    pub(super) fn finish(mut self) -> Result<(), RecordError> {
        let Some(gif) = self.gif.take() else { return Ok(()) };
        let failed = |reason: &dyn std::fmt::Display| failed(&self.path, reason);
        let mut file = gif.encoder.into_inner().map_err(|e| failed(&e))?;
        file.flush().map_err(|e| failed(&e))
    }
}

impl Drop for Film {
    fn drop(&mut self) {
        let Some(gif) = self.gif.take() else { return };
        // The encoder writes the rest of its buffer.
        drop(gif);
        // The recording has failed, and its error is reported; a second error would add nothing.
        let _ = if self.pictures == 0 { std::fs::remove_file(&self.path) } else { end_early(&self.path, self.length) };
    }
}

/// Completes a GIF that has frames up to this length.
fn end_early(path: &Path, length: u64) -> std::io::Result<()> {
    const TRAILER: u8 = 0x3b;
    let mut file = File::options().write(true).open(path)?;
    file.set_len(length)?;
    file.seek(SeekFrom::Start(length))?;
    file.write_all(&[TRAILER])
}

fn failed(path: &Path, reason: &dyn std::fmt::Display) -> RecordError {
    RecordError::Write { path: path.to_owned(), reason: reason.to_string() }
}

impl Gif {
    /// Adds the changed part of a frame that is shown for this time: the smallest rectangle that contains it.
    fn add(&mut self, picture: &Picture, seconds: f64) -> Result<(), gif::EncodingError> {
        let Self { encoder, palette, before, now } = self;
        palette.indices(picture, now);
        let whole = picture.size[0] as usize;
        let [left, top, width, height] = changed(before, now, whole);
        let rows = now.chunks(whole.max(1)).skip(top).take(height);
        let buffer = rows.flat_map(|row| row.iter().skip(left).take(width)).copied().collect();
        // Cannot fail: frames are much smaller.
        let [left, top, width, height] = [left, top, width, height].map(|n| u16::try_from(n).unwrap_or(u16::MAX));
        let delay = hundredths(seconds);
        encoder.write_frame(&gif::Frame { delay, left, top, width, height, buffer, ..gif::Frame::default() })?;
        std::mem::swap(before, now);
        Ok(())
    }
}

/// Returns left, top, width and height of the rectangle in which two frames of this width differ: the whole frame if
/// there was none before, and one pixel if they are equal.
fn changed(before: &[u8], now: &[u8], width: usize) -> [usize; 4] {
    let width = width.max(1);
    if before.len() != now.len() {
        return [0, 0, width, now.len() / width];
    }
    let (mut left, mut right, mut top, mut bottom) = (width, 0, usize::MAX, 0);
    for (y, (a, b)) in before.chunks(width).zip(now.chunks(width)).enumerate() {
        let differs = |(a, b): (&u8, &u8)| a != b;
        if let Some(first) = a.iter().zip(b).position(differs) {
            let last = a.iter().zip(b).rposition(differs).unwrap_or(first);
            (left, right, top, bottom) = (left.min(first), right.max(last), top.min(y), y);
        }
    }
    if top == usize::MAX {
        return [0, 0, 1, 1];
    }
    [left, top, right - left + 1, bottom - top + 1]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn delays_are_rounded_to_the_units_of_the_format() {
        for (rate, expected) in [(25, 4), (50, 2), (30, 3), (100, 2), (1, 100), (4, 25)] {
            assert_eq!(hundredths(MovieFormat::Gif.delay(rate)), expected);
            assert_eq!(MovieFormat::Gif.delay(rate), f64::from(expected) / 100.0);
        }
        assert!((MovieFormat::Folder.delay(30) - 1.0 / 30.0).abs() < 1e-15);
        assert_eq!(hundredths(MovieFormat::Gif.delay(4) + 2.0), 225);
    }

    #[test]
    fn the_changed_rectangle_is_the_smallest() {
        let before = vec![0; 20];
        let mut now = before.clone();
        assert_eq!(changed(&before, &now, 5), [0, 0, 1, 1]);
        assert_eq!(changed(&[], &now, 5), [0, 0, 5, 4]);
        (now[7], now[14]) = (1, 1);
        assert_eq!(changed(&before, &now, 5), [2, 1, 3, 2]);
    }

    #[test]
    fn names_choose_the_format() {
        let of = |name: &str| MovieFormat::of(Path::new(name));
        assert!(matches!(of("a.gif"), Ok(MovieFormat::Gif)) && matches!(of("a.GIF"), Ok(MovieFormat::Gif)));
        assert!(matches!(of("frames"), Ok(MovieFormat::Folder)) && matches!(of("."), Ok(MovieFormat::Folder)));
        assert!(["a.mp4", "a.png"].map(of).iter().all(|of| matches!(of, Err(RecordError::UnknownFormat(_)))));
        assert!(matches!(of("no/such/folder/a.gif"), Err(RecordError::NoFolder(_))));
    }

    /// Whatever interrupts a recording, no broken file is left.
    #[test]
    fn a_recording_that_is_not_finished_ends_after_its_last_frame() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("cut.gif");
        let picture = |red| Picture { size: [4, 4], rgba: [red, 0, 0, 255].repeat(16) };
        let film = || Film::create(&path, MovieFormat::Gif, MovieFormat::Gif.delay(25), &[picture(9)]).unwrap();
        let mut whole = film();
        (0..2).for_each(|red| whole.add(&picture(red), 0.0).unwrap());
        whole.finish().unwrap();
        let bytes = std::fs::read(&path).unwrap();
        let mut cut = film();
        (0..2).for_each(|red| cut.add(&picture(red), 0.0).unwrap());
        // A part of a third frame.
        cut.gif.as_mut().unwrap().encoder.get_mut().write_all(&[0x2c, 0, 0, 0]).unwrap();
        drop(cut);
        assert_eq!(std::fs::read(&path).unwrap(), bytes);
        drop(film());
        assert!(!path.exists());
    }
}
