//! Recording of the scene from its start into a GIF in the current folder, made in the background.

use crate::app::ThemeChoice;
use crate::app::language::{self, Language, count, fill, said, tr};
use crate::app::offscreen::record::{RecordOptions, record};
use crate::app::platform::new_file::NewFile;
use crate::app::task::thread::{Reporter, Task, Update};
use crate::progress::Progress;
use crate::scene::{Scene, Source};

/// Size of the recording, pixels.
const SIZE: [u32; 2] = [640, 400];

/// Progress report: the fraction done, and the current phase, if it is another one.
type Report = (f32, Option<String>);

/// Recording in a background thread. Dropping it cancels it.
#[derive(Debug)]
pub(crate) struct Recorder {
    task: Task<Report, String>,
    /// Fraction that is done, 0 to 1.
    fraction: f32,
    /// Description of the current phase.
    text: String,
}

impl Recorder {
    /// Starts recording a scene into a file.
    ///
    /// # Errors
    /// The system cannot start another thread.
    pub(crate) fn start(
        source: Source,
        scene: Scene,
        (theme, language): (ThemeChoice, Language),
        adapter: Option<String>,
        file: NewFile,
    ) -> std::io::Result<Self> {
        let options = RecordOptions {
            size: SIZE,
            seconds: None,
            speed: None,
            fps: None,
            overwrite: true,
            theme,
            language,
            adapter,
        };
        let task = Task::start("record", move |reporter| work(&source, scene, &options, &file, reporter))?;
        Ok(Self { task, fraction: 0.0, text: String::new() })
    }

    /// Returns the text that shows the progress.
    pub(crate) fn progress(&self) -> String {
        let percent = format!("{:.0}", 100.0 * self.fraction);
        fill!("%{doing}: %{percent} % (Shift+V stops it)", doing = self.text, percent = percent)
    }

    /// Ends the recording with the frames drawn so far.
    pub(crate) fn stop(&self) {
        self.task.cancel();
    }

    /// Returns the final message once the recording has ended; waits for it if `waits` is `true`.
    pub(crate) fn ended(&mut self, waits: bool) -> Option<String> {
        loop {
            match self.task.next(waits) {
                Update::Progress((fraction, text)) => {
                    self.fraction = fraction;
                    self.text = text.unwrap_or(std::mem::take(&mut self.text));
                }
                Update::Done(text) => return Some(text),
                Update::None => return None,
                Update::Died => return Some(tr("The recording ended unexpectedly").to_owned()),
            }
        }
    }
}

fn work(
    source: &Source,
    scene: Scene,
    options: &RecordOptions,
    file: &NewFile,
    reporter: &Reporter<Report, String>,
) -> String {
    language::speak(options.language);
    let path = file.path();
    let observe = &|progress: Progress<'_>| reporter.report((progress.fraction as f32, progress.now.map(said)));
    match record(source, scene, options, path, observe) {
        Ok(recorded) if recorded.pictures == 0 => tr("Nothing was recorded").to_owned(),
        Ok(recorded) => {
            fill!("Saved %{file}, %{pictures}", file = path.display(), pictures = count(recorded.pictures, "picture"))
        }
        Err(error) => fill!("No recording: %{reason}", reason = said(&error)),
    }
}
