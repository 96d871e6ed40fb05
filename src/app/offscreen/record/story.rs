//! Recording of the story of the first start.

use std::path::Path;

use super::film::{self, Film, MovieFormat};
use super::{RecordError, RecordOptions, Recorded, SAMPLES};
use crate::app::AppError;
use crate::app::language;
use crate::app::offscreen::shot::Canvas;
use crate::app::session::document::built_in;
use crate::app::shell::lab::Lab;
use crate::app::shell::story;
use crate::image::Picture;
use crate::progress::{Observer, Progress};
use crate::render::{Gpu, RenderError};
use crate::sentence::sentence;
use crate::simulation::{Simulation, Status};

/// Default frames per second.
const RATE: u16 = 10;

/// Records the story of the first start as the window tells it. A recording cancelled by `observe` is shorter.
///
/// # Errors
/// [`AppError::Render`], [`AppError::Record`].
pub fn record_story(options: &RecordOptions, output: &Path, observe: Observer<'_>) -> Result<Recorded, AppError> {
    let format = MovieFormat::of(output)?;
    if format == MovieFormat::Folder {
        film::clear(output, options.overwrite)?;
    }
    let missing = || AppError::Window("the scene to begin with is missing".to_owned());
    let (source, scene) = built_in(crate::scene::registry::DEFAULT).ok_or_else(missing)?;
    let simulation = Simulation::new(&scene)
        .map_err(|error| RecordError::Simulation { scene: source.name.display().to_string(), error })?;
    let gpu = Gpu::headless_on(options.adapter.as_deref())?;
    let mut canvas = Canvas::new(&gpu, options.size, 1.0, options.theme.into())?;
    let delay = format.delay(options.fps.unwrap_or(RATE));
    let pictures = (story::seconds() / delay.seconds()).ceil() as u64;
    let new_lab = || {
        let again = Simulation::with_system(&scene, simulation.system().clone());
        let mut lab = again.map(|simulation| Lab::new(source.clone(), scene.clone(), simulation)).ok()?;
        lab.set_language(options.language);
        lab.tell_story();
        Some(lab)
    };
    let mut draw = |lab: &mut Lab, k: u64| -> Result<Picture, RenderError> {
        language::speak(options.language);
        lab.advance(k as f64 * delay.seconds());
        lab.finish_story_frame();
        canvas.draw(lab, &mut |_| {})
    };
    let mut samples = Vec::new();
    if format == MovieFormat::Gif {
        let mut lab = new_lab().ok_or_else(missing)?;
        let count = SAMPLES as u64;
        for k in 0..count {
            samples.push(draw(&mut lab, (k * pictures + pictures / 2) / count)?);
        }
    }
    let mut lab = new_lab().ok_or_else(missing)?;
    let now = sentence!("recording %{file}", file = output.display().to_string());
    let mut film = Film::create(output, format, delay, &samples, options.size)?;
    let mut recorded =
        Recorded { pictures: 0, rate: 1.0 / delay.seconds(), format, interrupted: true, status: Status::Running };
    for k in 0..pictures {
        let progress = Progress { fraction: k as f64 / pictures as f64, now: Some(&now) };
        // Even a cancelled recording has one frame, because a file without frames is invalid.
        if observe(progress).is_break() && k > 0 {
            break;
        }
        film.add(&draw(&mut lab, k)?, 0.0)?;
        recorded.pictures = k + 1;
    }
    film.finish()?;
    recorded.interrupted = recorded.pictures < pictures;
    recorded.status = lab.simulation().status().clone();
    Ok(recorded)
}
