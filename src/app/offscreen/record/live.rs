//! Recording of the window as it is drawn: frames at a constant rate, encoded in a background thread.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, TryRecvError, sync_channel};

use egui::{ClippedPrimitive, Color32, Pos2, Rect, Shape, Stroke};
use egui_wgpu::ScreenDescriptor;

use super::RecordError;
use super::film::{Film, MovieFormat};
use crate::app::language::{self, Language, count, fill, said, tr};
use crate::app::offscreen::painter::PaintStage;
use crate::app::platform::new_file::NewFile;
use crate::app::task::thread::{Task, Update};
use crate::image::Picture;
use crate::render::{Gpu, RenderError, View, to_rgba};

/// Frames per second.
const RATE: u16 = 25;
/// Largest side of the frames, pixels: larger windows are scaled down.
const MAX_SIDE: f32 = 1280.0;
/// Largest number of frames being copied from the graphics device; further frames are skipped.
const MAX_READ: usize = 2;
/// Largest number of frames waiting for the encoder; further frames are skipped.
const MAX_WAITING: usize = 4;

/// Recording of the window. Dropping it ends it with the frames taken so far.
pub(crate) struct LiveRecording {
    path: PathBuf,
    task: Task<(), String>,
    /// Channel to the encoder; `None` once the recording is stopped.
    sender: Option<SyncSender<(u64, Picture)>>,
    /// Number of the frame at which the recording ends.
    end: Arc<AtomicU64>,
    target: wgpu::Texture,
    size: [u32; 2],
    pending: Vec<Reading>,
    /// Read-back buffers that can be reused.
    free: Vec<wgpu::Buffer>,
    /// Time of the first frame, s.
    start: Option<f64>,
    /// Number of the last frame taken.
    last: Option<u64>,
}

/// Frame that the graphics device is still copying to memory.
struct Reading {
    number: u64,
    buffer: wgpu::Buffer,
    mapped: Receiver<Result<(), wgpu::BufferAsyncError>>,
}

impl LiveRecording {
    /// Starts recording a window of this size, pixels, drawn in this format, into a file.
    ///
    /// # Errors
    /// The system cannot start another thread.
    pub(crate) fn start(
        gpu: &Gpu,
        format: wgpu::TextureFormat,
        window: [u32; 2],
        file: NewFile,
        language: Language,
    ) -> std::io::Result<Self> {
        let scale = (MAX_SIDE / window[0].max(window[1]).max(1) as f32).min(1.0);
        let size = window.map(|side| ((side as f32 * scale).round() as u32).max(1));
        let target = gpu.target("recording", format, size, 1, wgpu::TextureUsages::COPY_SRC);
        let (sender, receiver) = sync_channel(MAX_WAITING);
        let end = Arc::new(AtomicU64::new(0));
        let (path, own_end) = (file.path().to_owned(), end.clone());
        let task = Task::start("recording", move |_| {
            language::speak(language);
            encode(file.path(), &receiver, &own_end)
        })?;
        Ok(Self {
            path,
            task,
            sender: Some(sender),
            end,
            target,
            size,
            pending: Vec::new(),
            free: Vec::new(),
            start: None,
            last: None,
        })
    }

    /// Returns the duration recorded at `now`, s.
    pub(crate) fn seconds(&self, now: f64) -> f64 {
        self.start.map_or(0.0, |start| now - start)
    }

    /// Returns the number of the frame that is due at `now`; `None` if it has been taken already, or the recording is
    /// stopped.
    pub(crate) fn due(&self, now: f64) -> Option<u64> {
        let number = (self.seconds(now) * f64::from(RATE)).max(0.0) as u64;
        (self.sender.is_some() && self.last.is_none_or(|last| number > last)).then_some(number)
    }

    /// Draws the window again as the frame with this number, and starts reading it back; skips it if too many frames
    /// are being read.
    pub(crate) fn take(
        &mut self,
        gpu: &Gpu,
        stage: &mut PaintStage,
        (views, primitives): (&[View<'_>], &[ClippedPrimitive]),
        screen: &ScreenDescriptor,
        (number, now): (u64, f64),
    ) {
        if self.pending.len() >= MAX_READ {
            return;
        }
        // If the size of the window has changed, the image is scaled so that it fits.
        let [x, y] = [0, 1].map(|axis| self.size[axis] as f32 / screen.size_in_pixels[axis].max(1) as f32);
        let own = ScreenDescriptor { size_in_pixels: self.size, pixels_per_point: screen.pixels_per_point * x.min(y) };
        let view = self.target.create_view(&wgpu::TextureViewDescriptor::default());
        stage.paint(gpu, &view, &own, primitives, views);
        let reading = self.read(gpu, number);
        self.pending.push(reading);
        self.start.get_or_insert(now);
        self.last = Some(number);
    }

    /// Copies the target into a buffer, which is mapped when the device has finished.
    fn read(&mut self, gpu: &Gpu, number: u64) -> Reading {
        let row = padded_row(self.size[0]);
        let buffer = self.free.pop().unwrap_or_else(|| {
            gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("recording"),
                size: u64::from(row) * u64::from(self.size[1]),
                usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
                mapped_at_creation: false,
            })
        });
        let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        encoder.copy_texture_to_buffer(
            self.target.as_image_copy(),
            wgpu::TexelCopyBufferInfo {
                buffer: &buffer,
                layout: wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(row), rows_per_image: None },
            },
            self.target.size(),
        );
        gpu.queue.submit([encoder.finish()]);
        let (sender, mapped) = std::sync::mpsc::channel();
        // The receiver may have been dropped with the recording.
        buffer.slice(..).map_async(wgpu::MapMode::Read, move |result| drop(sender.send(result)));
        Reading { number, buffer, mapped }
    }

    /// Passes the frames that have arrived from the graphics device to the encoder, without waiting. Those of a device
    /// that has failed do not arrive.
    pub(crate) fn pass_frames(&mut self, gpu: &Gpu) {
        if gpu.failure().is_some() {
            return self.pending.clear();
        }
        let _ = gpu.device.poll(wgpu::PollType::Poll);
        while let Some(first) = self.pending.first() {
            match first.mapped.try_recv() {
                Err(TryRecvError::Empty) => return,
                Ok(Ok(())) => {
                    let Reading { number, buffer, .. } = self.pending.remove(0);
                    if let Ok(picture) = self.picture(&buffer) {
                        // If the encoder's queue is full, the frame is skipped.
                        let _ = self.sender.as_ref().map(|sender| sender.try_send((number, picture)));
                    }
                    buffer.unmap();
                    self.free.push(buffer);
                }
                Ok(Err(_)) | Err(TryRecvError::Disconnected) => drop(self.pending.remove(0)),
            }
        }
    }

    fn picture(&self, buffer: &wgpu::Buffer) -> Result<Picture, RenderError> {
        let mapped = buffer.slice(..).get_mapped_range().map_err(|e| RenderError::ReadBack(e.to_string()))?;
        let row = 4 * self.size[0] as usize;
        let lines = mapped.chunks_exact(padded_row(self.size[0]) as usize);
        let mut rgba: Vec<u8> = lines.filter_map(|line| line.get(..row)).flatten().copied().collect();
        to_rgba(self.target.format(), &mut rgba);
        Ok(Picture { size: self.size, rgba })
    }

    /// Ends the recording with the frames taken so far; the file is complete once [`Self::ended`] returns a message.
    pub(crate) fn stop(&mut self, gpu: &Gpu, now: f64) {
        if !self.is_running() {
            return;
        }
        if gpu.failure().is_none() {
            // Waits for the frames that the device is still copying.
            let _ = gpu.device.poll(wgpu::PollType::wait_indefinitely());
        }
        self.pass_frames(gpu);
        self.end.store((self.seconds(now) * f64::from(RATE)).max(0.0) as u64, Ordering::Relaxed);
        self.sender = None;
    }

    /// Returns `true` while frames are taken.
    pub(crate) fn is_running(&self) -> bool {
        self.sender.is_some()
    }

    /// Returns a message once the recording has ended or failed; waits for it if `waits` is `true`.
    pub(crate) fn ended(&self, waits: bool) -> Option<String> {
        match self.task.next(waits) {
            Update::Done(text) => Some(text),
            Update::Died => Some(tr("The recording ended unexpectedly").to_owned()),
            Update::Progress(()) | Update::None => None,
        }
    }

    /// Returns the recording indicator in the window, which is not recorded.
    pub(crate) fn mark(&self, ctx: &egui::Context, view: Rect, now: f64) -> Vec<Shape> {
        let visuals = ctx.global_style().visuals.clone();
        let seconds = format!("{:.1}", self.seconds(now));
        let text = if self.is_running() {
            fill!("recording %{seconds} s (V stops it)", seconds = seconds)
        } else {
            fill!("Saving %{file}", file = self.path.display())
        };
        let color = visuals.strong_text_color();
        let galley = ctx.fonts_mut(|fonts| fonts.layout_no_wrap(text, egui::FontId::proportional(14.0), color));
        const DOT: f32 = 6.0;
        // Below the line key.
        let corner = view.left_top() + egui::vec2(16.0, 44.0);
        let text = corner + egui::vec2(3.0 * DOT, 0.0);
        let rect = Rect::from_min_max(corner, text + galley.size()).expand(6.0);
        let dot = Pos2::new(corner.x + DOT, corner.y + 0.5 * galley.size().y);
        vec![
            Shape::rect_filled(rect, 4.0, visuals.extreme_bg_color.gamma_multiply(0.85)),
            Shape::circle_filled(dot, DOT, RED),
            Shape::galley(text, galley, color),
        ]
    }
}

const RED: Color32 = Color32::from_rgb(214, 40, 40);

/// Returns the mouse pointer as a shape: the system draws the real one over the window, so recordings would lack it.
pub(crate) fn pointer(ctx: &egui::Context) -> Option<Shape> {
    let (at, is_down) = ctx.input(|i| (i.pointer.latest_pos(), i.pointer.any_down()));
    let radius = if is_down { 6.0 } else { 8.0 };
    let fill = if is_down { RED } else { Color32::from_white_alpha(96) };
    let shape = |at| egui::epaint::CircleShape { center: at, radius, fill, stroke: Stroke::new(1.5, Color32::BLACK) };
    at.map(|at| Shape::Circle(shape(at)))
}

/// Returns the number of bytes of a row in a buffer.
fn padded_row(width: u32) -> u32 {
    (4 * width).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT)
}

/// Writes the frames as they arrive, each shown until the next; returns the final message.
fn encode(path: &Path, pictures: &Receiver<(u64, Picture)>, end: &AtomicU64) -> String {
    match write(path, pictures, end) {
        Ok(0) => tr("Nothing was recorded").to_owned(),
        Ok(written) => fill!("Saved %{file}, %{pictures}", file = path.display(), pictures = count(written, "picture")),
        Err((0, error)) => fill!("No recording: %{reason}", reason = said(&error)),
        Err((written, error)) => fill!(
            "Saved %{file}, %{pictures}; then: %{reason}",
            file = path.display(),
            pictures = count(written, "picture"),
            reason = said(&error)
        ),
    }
}

/// Returns the number of frames in the file; the error also contains the reason for an early end.
fn write(path: &Path, pictures: &Receiver<(u64, Picture)>, end: &AtomicU64) -> Result<u64, (u64, RecordError)> {
    let delay = MovieFormat::Gif.delay(RATE);
    let Ok((mut number, mut picture)) = pictures.recv() else { return Ok(0) };
    let samples = std::slice::from_ref(&picture);
    let mut film = Film::create(path, MovieFormat::Gif, delay, samples, picture.size).map_err(|error| (0, error))?;
    film.adapt();
    loop {
        let next = pictures.recv();
        let until = next.as_ref().map_or_else(|_| end.load(Ordering::Relaxed), |(number, _)| *number);
        // A frame is also shown during the following frames that were skipped or equal.
        let hold = until.saturating_sub(number).saturating_sub(1) as f64 * delay.seconds();
        film.add(&picture, hold).map_err(|error| (film.pictures(), error))?;
        match next {
            Ok(next) => (number, picture) = next,
            Err(_) => break,
        }
    }
    let written = film.pictures();
    film.finish().map(|()| written).map_err(|error| (written, error))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::shell::lab::Lab;
    use crate::render::{FORMAT, read_texture};
    use crate::scene::{Source, open};
    use crate::simulation::Simulation;

    /// Returns the frames of a GIF in RGB, each with its duration in 1/100 s.
    fn decode(path: &Path) -> Vec<(Vec<u8>, u16)> {
        let mut options = gif::DecodeOptions::new();
        options.set_color_output(gif::ColorOutput::RGBA);
        let mut decoder = options.read_info(std::fs::File::open(path).unwrap()).unwrap();
        let width = usize::from(decoder.width());
        let mut canvas = vec![0; 3 * width * usize::from(decoder.height())];
        let mut frames = Vec::new();
        while let Some(frame) = decoder.read_next_frame().unwrap() {
            for (i, pixel) in frame.buffer.chunks(4).enumerate() {
                let (x, y) = (i % usize::from(frame.width), i / usize::from(frame.width));
                let at = 3 * ((usize::from(frame.top) + y) * width + usize::from(frame.left) + x);
                canvas[at..at + 3].copy_from_slice(&pixel[..3]);
            }
            frames.push((canvas.clone(), frame.delay));
        }
        frames
    }

    fn plain(color: [u8; 3], other: [u8; 3]) -> Picture {
        let pixel = |i: u32| if i.is_multiple_of(2) { color } else { other };
        let rgba = (0..400).flat_map(|i| pixel(i).into_iter().chain([255])).collect();
        Picture { size: [20, 20], rgba }
    }

    /// Writes frames with their numbers, and returns the message of `encode`.
    fn encoded(path: &Path, pictures: Vec<(u64, Picture)>, end: u64) -> String {
        let (sender, receiver) = sync_channel(pictures.len());
        pictures.into_iter().for_each(|picture| sender.send(picture).unwrap());
        drop(sender);
        encode(path, &receiver, &AtomicU64::new(end))
    }

    #[test]
    fn a_window_is_recorded_as_it_is_drawn_and_no_memory_grows() {
        let gpu = Gpu::headless().unwrap();
        let folder = tempfile::tempdir().unwrap();
        let file = NewFile::create(folder.path(), "gif").unwrap();
        let path = file.path().to_owned();
        let source = Source { name: "swing".into(), assignments: Vec::new() };
        let scene = open(&source).unwrap();
        let mut lab = Lab::new(source, scene.clone(), Simulation::new(&scene).unwrap());
        let (ctx, mut stage) = (egui::Context::default(), PaintStage::new(&gpu, FORMAT));
        let screen = ScreenDescriptor { size_in_pixels: [640, 400], pixels_per_point: 1.0 };
        let mut recording = LiveRecording::start(&gpu, FORMAT, [640, 400], file, Language::English).unwrap();
        let (frames, between) = (60, 0.03);
        for k in 0..frames {
            let now = f64::from(k) * between;
            lab.advance(now);
            let input = egui::RawInput {
                screen_rect: Some(Rect::from_min_size(Pos2::ZERO, egui::vec2(640.0, 400.0))),
                time: Some(now),
                ..Default::default()
            };
            let mut mark = Vec::new();
            let mut output = ctx.run_ui(input, |ui| {
                lab.ui(ui);
                mark = recording.mark(ui.ctx(), lab.view_rect(), now);
            });
            assert_eq!(mark.len(), 3);
            let primitives = ctx.tessellate(output.shapes, 1.0);
            stage.set_textures(&gpu, &mut output.textures_delta);
            recording.pass_frames(&gpu);
            if let Some(number) = recording.due(now) {
                recording.take(
                    &gpu,
                    &mut stage,
                    (&lab.views(screen.pixels_per_point), &primitives),
                    &screen,
                    (number, now),
                );
            }
            assert!(recording.pending.len() <= MAX_READ && recording.free.len() <= MAX_READ);
            stage.free_textures(&mut output.textures_delta);
        }
        let last = read_texture(&gpu, &recording.target).unwrap();
        recording.stop(&gpu, f64::from(frames) * between);
        assert!(!recording.is_running() && recording.due(9.0).is_none());
        let text = recording.ended(true).unwrap();
        assert!(text.starts_with("Saved"), "{text}");
        let movie = decode(&path);
        assert!(movie.len() >= 3, "{}", movie.len());
        // The film has the duration of the recording, in steps of 0.04 s.
        let length: u16 = movie.iter().map(|(_, delay)| delay).sum();
        assert!(length.abs_diff(180) <= 8 && movie.iter().all(|(_, delay)| delay.is_multiple_of(4)), "{length}");
        let (shown, _) = movie.last().unwrap();
        let drawn = last.rgba.chunks(4).flat_map(|pixel| &pixel[..3]);
        let far = drawn.zip(shown).filter(|(a, b)| a.abs_diff(**b) > 24).count();
        // Frames may be skipped, including the last one; most of the two images is equal.
        assert!(far < shown.len() / 20, "{far} of {} differ", shown.len());
        assert!(movie.windows(2).any(|pair| pair[0].0 != pair[1].0), "nothing moves");
    }

    #[test]
    fn pictures_are_shown_until_the_next_and_get_colours_of_their_own() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("colours.gif");
        let [first, second] = [plain([10, 20, 30], [40, 50, 60]), plain([250, 120, 10], [0, 255, 0])];
        let text = encoded(&path, vec![(0, first.clone()), (5, second.clone()), (6, first.clone())], 10);
        assert!(text.contains("3 pictures"), "{text}");
        let movie = decode(&path);
        let rgb = |p: &Picture| p.rgba.chunks(4).flat_map(|pixel| pixel[..3].to_vec()).collect::<Vec<u8>>();
        assert_eq!(movie, [(rgb(&first), 20), (rgb(&second), 4), (rgb(&first), 16)]);
    }

    #[test]
    fn a_recording_that_cannot_be_written_leaves_no_file() {
        let folder = tempfile::tempdir().unwrap();
        // The folder does not exist.
        let text = encoded(&folder.path().join("none/a.gif"), vec![(0, plain([1; 3], [2; 3]))], 1);
        assert!(text.starts_with("No recording") && text.contains("a.gif"), "{text}");
        assert_eq!(encoded(&folder.path().join("empty.gif"), Vec::new(), 0), "Nothing was recorded");
        #[cfg(target_os = "linux")]
        {
            let full = folder.path().join("full.gif");
            std::os::unix::fs::symlink("/dev/full", &full).unwrap();
            let text = encoded(&full, vec![(0, plain([1; 3], [2; 3]))], 1);
            assert!(text.starts_with("No recording") && text.contains("space"), "{text}");
        }
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    }

    #[test]
    fn an_encoder_that_panics_is_reported_when_the_window_has_closed_too() {
        let gpu = Gpu::headless().unwrap();
        let folder = tempfile::tempdir().unwrap();
        let file = NewFile::create(folder.path(), "gif").unwrap();
        let mut recording = LiveRecording::start(&gpu, FORMAT, [64, 64], file, Language::English).unwrap();
        recording.task = Task::start("panics", |_| std::panic::panic_any("meant")).unwrap();
        assert_eq!(recording.ended(true).unwrap(), "The recording ended unexpectedly");
    }
}
