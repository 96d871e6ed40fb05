//! Recordings of a lab without a window.

use thiserror::Error;

use self::film::Film;
pub use self::film::MovieFormat;
use crate::app::AppError;
use crate::app::language;
use crate::app::offscreen::options::RecordOptions;
use crate::app::offscreen::shot::Canvas;
use crate::app::prelude::*;
use crate::app::session::Session;
use crate::app::session::document::built_in;
use crate::app::shell::lab::Lab;
use crate::app::shell::story;
use crate::app::widgets::text::Labels;
use crate::image::Picture;
use crate::render::interpolated_field::InterpolatedField;
use crate::render::{Gpu, RenderError};
use crate::scene::{DynamicsSettings, registry};
use crate::simulation::{PointValues, SimulationError};
use crate::state::State;

mod colors;
mod film;

/// Default frames per second of a motion: a rate that GIF represents exactly.
const MOTION_RATE: u16 = 25;
/// Default frames per second of an iteration: slow enough to see each frame.
const SEARCH_RATE: u16 = 4;
/// Default frames per second of the story of the first start.
const STORY_RATE: u16 = 10;
/// Duration for which an equilibrium is shown at the end, s.
const HOLD: f64 = 2.0;
/// Tolerance for rounding, as a fraction of a step or of the time between frames.
const NO_TIME: f64 = 1e-6;
/// Largest size of the area shown of a motion, relative to the body; states beyond it are cut off.
const LARGEST_VIEW: f64 = 20.0;
/// Largest size of the area shown of an iteration, relative to the area of rest and final state.
const LARGEST_WAY: f64 = 1.5;
/// Largest number of frames that a palette is made from.
const SAMPLES: usize = 12;

/// Reason for which there is no recording.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum RecordError {
    /// The file name has an unknown format.
    #[error(
        "{}: expected a file name ending in .gif, or the name of a folder for numbered pictures, \
         which ffmpeg makes a film of",
        .0.display()
    )]
    UnknownFormat(PathBuf),
    /// The folder of the file does not exist.
    #[error("{}: no such folder", .0.display())]
    NoFolder(PathBuf),
    /// The folder already contains numbered images.
    #[error("{}: has {count} numbered pictures; --overwrite replaces them", folder.display())]
    HasPictures {
        /// The folder.
        folder: PathBuf,
        /// Number of numbered images.
        count: usize,
    },
    /// A duration was requested for a body at rest.
    #[error("expected no --seconds and no --speed: this scene is static, and each picture is an iteration")]
    NotInMotion,
    /// The scene cannot be simulated.
    #[error("{scene}: {error}")]
    Simulation {
        /// Name of the scene.
        scene: String,
        /// Reason.
        error: SimulationError,
    },
    /// The recording cannot be written.
    #[error("{}: {reason}", path.display())]
    Write {
        /// Path of the file.
        path: PathBuf,
        /// The reason.
        reason: String,
    },
}

impl From<&RecordError> for Sentence {
    fn from(error: &RecordError) -> Self {
        match error {
            RecordError::Simulation { scene, error } => Self::located(scene.as_str(), error),
            RecordError::Write { path, reason } => Self::located(path.display().to_string(), reason.as_str()),
            other => other.to_string().into(),
        }
    }
}

/// Result of a recording.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Recorded {
    /// Number of frames written; 0 means that there is no file.
    pub pictures: u64,
    /// Frames per second, as the format represents them.
    pub rate: f64,
    /// The format.
    pub format: MovieFormat,
    /// `true` if the recording was cancelled before its end.
    pub interrupted: bool,
    /// Final status of the motion or iteration, or its status when it was cancelled.
    pub status: Status,
}

/// Records a scene's motion, or its iteration to equilibrium, from the start; without a scene, the story of the first
/// start as the window tells it. The simulation runs twice: once to find the ranges of the camera and of the colours, so
/// that both are constant, and once to draw. A recording cancelled by `observe` is shorter; if no frame has been drawn
/// yet, there is none.
///
/// # Errors
/// [`AppError::Render`], [`AppError::Record`].
pub fn record(
    of: Option<(Source, Scene)>,
    options: &RecordOptions,
    output: &Path,
    observe: Observer<'_>,
) -> Result<Recorded, AppError> {
    let format = MovieFormat::of(output)?;
    if format == MovieFormat::Folder && !options.overwrite {
        // Fails before the simulation, not after it.
        film::clear(output, false)?;
    }
    let is_story = of.is_none();
    let missing = || AppError::Window("the scene to begin with is missing".to_owned());
    let (source, mut scene) = of.or_else(|| built_in(registry::DEFAULT)).ok_or_else(missing)?;
    let moves = scene.analysis == Analysis::Dynamic;
    if !moves && !is_story && (options.seconds.is_some() || options.speed.is_some()) {
        return Err(RecordError::NotInMotion.into());
    }
    if let Some(seconds) = options.seconds.filter(|_| moves) {
        scene.dynamics.duration = seconds;
    }
    let failed = |error| RecordError::Simulation { scene: source.name.display().to_string(), error };
    let simulation = Simulation::new(&scene).map_err(failed)?;
    let again = || Simulation::with_system(&scene, simulation.system().clone()).map_err(failed);
    let gpu = Gpu::headless(options.look.adapter.adapter.as_deref())?;
    let mut canvas = Canvas::new(&gpu, options.size, 1.0, options.look.theme.into())?;

    let rate = match moves {
        true => MOTION_RATE,
        false if is_story => STORY_RATE,
        false => SEARCH_RATE,
    };
    let delay = format.delay(options.fps.unwrap_or(rate));
    let between = delay * options.speed.unwrap_or(1.0);
    let mut recorded = Recorded { pictures: 0, rate: 1.0 / delay, format, interrupted: true, status: Status::Running };
    let mut preview = None;
    if !is_story {
        preview = Preview::new(between, &mut Session::new(source.clone(), scene.clone(), again()?), observe);
        if preview.is_none() {
            return Ok(recorded);
        }
    }
    let told = (story::seconds() / delay).ceil() as u64;
    let pictures = preview.as_ref().map_or(told, |preview| preview.pictures);

    let lab_of = |body| prepared(Lab::new(source.clone(), scene.clone(), body), options, preview.as_ref());
    let new_lab = || again().map(lab_of);
    let samples = match format {
        MovieFormat::Gif => samples(&mut canvas, new_lab()?, preview.as_ref(), (delay, pictures))?,
        _ => Vec::new(),
    };
    let mut lab = new_lab()?;
    if format == MovieFormat::Folder {
        film::clear(output, options.overwrite)?;
    }
    let now = sentence!("recording %{file}", file = output.display().to_string());
    let mut film = Film::create(output, format, delay, &samples)?;
    for k in 0..pictures {
        let progress = Progress { fraction: k as f64 / pictures as f64, now: Some(&now) };
        let goes_on = match is_story {
            true => observe(progress).is_continue(),
            false => {
                let observe = &mut |_| observe(progress).continue_value();
                advance(&mut lab.desk.session, k, between, observe) == Some(true)
            }
        };
        // Even a cancelled recording has one frame, because a file without frames is invalid.
        if k > 0 && !goes_on {
            break;
        }
        if is_story {
            tell(&mut lab, delay, k);
        }
        let picture = draw(&mut canvas, &mut lab, k)?;
        let holds = k + 1 == pictures && !moves && !is_story;
        film.add(&picture, if holds { HOLD } else { 0.0 })?;
        recorded.pictures = k + 1;
    }
    film.finish()?;
    recorded.interrupted = recorded.pictures < pictures;
    recorded.status = match lab.simulation().status() {
        // The last frame may be earlier than the last step.
        Status::Running if moves && !recorded.interrupted => Status::Finished,
        status => status.clone(),
    };
    Ok(recorded)
}

/// Returns a lab with the view that shows all that a preview has seen, or at the beginning of the story.
fn prepared(mut lab: Lab, options: &RecordOptions, preview: Option<&Preview>) -> Lab {
    lab.settings.language = options.look.language;
    if let Some(preview) = preview {
        lab.desk.view.layout.bars = false;
        let camera = lab.fit(preview.area.into(), options.size.map(f64::from));
        lab.desk.viewport.camera.set_camera(camera);
        lab.desk.view.fixed_range = Some(preview.range);
    } else {
        lab.tell_story();
    }
    lab
}

/// Draws pictures over the whole recording, from which the colours of a GIF are chosen. `preview` is that of a scene; a story
/// has none, and this many pictures that each last for `delay`, s.
fn samples(
    canvas: &mut Canvas,
    mut lab: Lab,
    preview: Option<&Preview>,
    (delay, pictures): (f64, u64),
) -> Result<Vec<Picture>, AppError> {
    let mut samples = Vec::new();
    for state in preview.iter().flat_map(|preview| &preview.samples) {
        // Cannot fail: the state belongs to the same equations.
        if lab.desk.session.restore(state) {
            samples.push(draw(canvas, &mut lab, 0)?);
        }
    }
    for k in (0..SAMPLES as u64).filter(|_| preview.is_none()) {
        tell(&mut lab, delay, (k * pictures + pictures / 2) / SAMPLES as u64);
        samples.push(draw(canvas, &mut lab, 0)?);
    }
    Ok(samples)
}

/// Shows frame `k` of the story, whose frames last for `delay`, s.
fn tell(lab: &mut Lab, delay: f64, k: u64) {
    lab.advance(k as f64 * delay);
    lab.finish_story_frame();
}

/// Draws the lab, with the time or the iteration above the scale, where no legend is; the story has captions of its own.
fn draw(canvas: &mut Canvas<'_>, lab: &mut Lab, k: u64) -> Result<Picture, RenderError> {
    language::speak(lab.settings.language);
    let simulation = lab.simulation();
    let text = match simulation.motion() {
        Some(_) => {
            // The number of digits distinguishes consecutive steps.
            let digits = -simulation.scene().dynamics.time_step.log10();
            format!("{:.*} s", digits.ceil().clamp(2.0, 9.0) as usize, simulation.state().time())
        }
        None if lab.story().is_some() => String::new(),
        None => fill!("iteration %{n}", n = k),
    };
    canvas.draw(lab, &mut |ctx| {
        let painter = ctx.layer_painter(egui::LayerId::new(egui::Order::Foreground, egui::Id::unique("recorded time")));
        let (screen, visuals) = (ctx.content_rect(), &ctx.global_style().visuals);
        let above_scale = screen.left_bottom() + egui::vec2(16.0, -48.0);
        if !text.is_empty() {
            let color = visuals.strong_text_color();
            Labels::new(&painter, visuals).add(above_scale, egui::Align2::LEFT_BOTTOM, &text, color, screen.width());
        }
    })
}

/// Advances a session, which records the trail, to frame `k`: frames of a motion are `between` s of simulated time apart, and
/// show the last step that is not later; an iteration has one frame per iteration. `observe` receives the time. Returns
/// `false` if there is no such frame, and `None` if the recording was cancelled on the way.
fn advance(session: &mut Session, k: u64, between: f64, observe: &mut dyn FnMut(f64) -> Option<()>) -> Option<bool> {
    let time = |session: &Session| session.simulation().state().time();
    let is_running = |session: &Session| *session.simulation().status() == Status::Running;
    observe(time(session))?;
    if !session.is_motion() {
        let exists = k == 0 || is_running(session);
        if k > 0 && exists {
            session.iterate();
        }
        return Some(exists);
    }
    let DynamicsSettings { duration, time_step, .. } = session.simulation().scene().dynamics;
    let at = k as f64 * between;
    if at > duration + NO_TIME * between {
        return Some(false);
    }
    while is_running(session) && time(session) + time_step <= at + NO_TIME * time_step {
        session.iterate();
        observe(time(session))?;
    }
    // A motion that has been stopped has no further frames.
    let given_up = matches!(session.simulation().status(), Status::Stopped(_)) && time(session) + time_step <= at;
    Some(!given_up)
}

/// Ranges of a recording, found before its frames are drawn.
struct Preview {
    pictures: u64,
    /// Box that contains the body in all frames, m.
    area: (Vector2<f64>, Vector2<f64>),
    /// Range of the colour map.
    range: [f64; 2],
    /// Evenly spaced samples of the states.
    samples: Vec<State>,
}

impl Preview {
    /// Simulates the whole recording; `None` if it was cancelled.
    fn new(between: f64, session: &mut Session, observe: Observer<'_>) -> Option<Self> {
        let now = sentence!("preparing the recording");
        let (moves, duration) = (session.is_motion(), session.scene().dynamics.duration);
        let area = session.simulation().mesh().bounds();
        let largest = LARGEST_VIEW * (area.1 - area.0).norm();
        let mut preview = Self { pictures: 0, area, range: [0.0, 1.0], samples: Vec::new() };
        let (mut field, mut largest_value) = (InterpolatedField::default(), 0.0_f64);
        let mut largest_of = |simulation: &Simulation| {
            field.update(simulation, Field::default(), PointValues::Recovered, &[]);
            field.largest(simulation.system().mesh())
        };
        let mut areas = Vec::new();
        let mut stride = 1;
        let fraction = |time| if moves { time / duration } else { 0.0 };
        let observe = &mut |time| observe(Progress { fraction: fraction(time), now: Some(&now) }).continue_value();
        while advance(session, preview.pictures, between, observe)? {
            let simulation = session.simulation();
            let area = bounds(simulation);
            if !moves {
                areas.push(area);
            } else if preview.include(area, largest) {
                // Unstable states extend neither the view nor the colour range.
                largest_value = largest_value.max(largest_of(simulation));
            }
            if preview.pictures.is_multiple_of(stride) {
                preview.samples.push(simulation.state().clone());
                if preview.samples.len() > SAMPLES {
                    let mut even = (0..).map(|i: u32| i.is_multiple_of(2));
                    preview.samples.retain(|_| even.next().unwrap_or_default());
                    stride *= 2;
                }
            }
            preview.pictures += 1;
        }
        if !moves {
            preview.include(bounds(session.simulation()), f64::INFINITY);
            let largest = LARGEST_WAY * (preview.area.1 - preview.area.0).norm();
            for area in areas {
                preview.include(area, largest);
            }
            largest_value = largest_of(session.simulation());
        }
        preview.range = Field::default().range(largest_value);
        Some(preview)
    }

    /// Extends the box to contain another, unless it would become larger than `largest`; returns `true` if it was
    /// extended.
    fn include(&mut self, (low, high): (Vector2<f64>, Vector2<f64>), largest: f64) -> bool {
        let (low, high) = (self.area.0.inf(&low), self.area.1.sup(&high));
        // `false` also for a box that is not finite.
        let fits = (high - low).norm() <= largest;
        if fits {
            self.area = (low, high);
        }
        fits
    }
}

/// Returns the box that contains the current positions of the nodes, m.
fn bounds(simulation: &Simulation) -> (Vector2<f64>, Vector2<f64>) {
    let nodes = simulation.system().mesh().nodes().iter().zip(simulation.displacement()).map(|(x, u)| x + u);
    let none = (Vector2::repeat(f64::INFINITY), Vector2::repeat(f64::NEG_INFINITY));
    nodes.fold(none, |(low, high), p| (low.inf(&p), high.sup(&p)))
}

#[cfg(test)]
mod tests {
    use std::ops::ControlFlow;

    use super::*;

    fn session(id: &str, set: &[&str]) -> Session {
        let source = Source { name: id.into(), assignments: set.iter().map(|s| (*s).to_owned()).collect() };
        let scene = crate::scene::open(&source).unwrap();
        let simulation = Simulation::new(&scene).unwrap();
        Session::new(source, scene, simulation)
    }

    /// Advances through all frames, calls `each` for every frame, and returns their number.
    fn run(between: f64, mut session: Session, each: &mut dyn FnMut(u64, &Simulation)) -> u64 {
        let mut k = 0;
        while advance(&mut session, k, between, &mut |_| Some(())) == Some(true) {
            each(k, session.simulation());
            k += 1;
        }
        k
    }

    #[test]
    fn a_picture_shows_the_last_step_that_is_not_later() {
        // Steps that are shorter than the time between frames, equal to it, and longer.
        for (step, between, pictures) in [(0.01, 0.04, 26), (0.01, 0.03, 34), (0.04, 0.04, 26), (0.1, 0.04, 26)] {
            let swing = session("swing", &[&format!("dynamics.time_step={step}"), "dynamics.duration=1"]);
            let seen = run(between, swing, &mut |k, simulation| {
                let (at, time) = (k as f64 * between, simulation.state().time());
                assert!(time <= at + 1e-9 && time > at - step + 1e-9, "picture {k} at {at} s shows {time} s");
            });
            assert_eq!(seen, pictures, "{step}, {between}");
        }
    }

    #[test]
    fn the_preview_spans_every_picture() {
        for id in ["swing", "jelly", "spin", "elastica"] {
            let again = || session(id, if id == "elastica" { &[] } else { &["dynamics.duration=1.5"] });
            let preview = Preview::new(0.04, &mut again(), &|_| ControlFlow::Continue(())).unwrap();
            assert!(preview.samples.len() <= SAMPLES && preview.samples.len() >= SAMPLES.min(3), "{id}");
            let moves = again().is_motion();
            let seen = run(0.04, again(), &mut |k, simulation| {
                let (low, high) = bounds(simulation);
                // Iterations before the equilibrium may leave the frame; the equilibrium is inside it.
                let shown = moves || *simulation.status() == Status::Converged;
                assert!(!shown || low >= preview.area.0 && high <= preview.area.1, "{id}, picture {k}");
                let field = InterpolatedField::new(simulation, Field::default(), PointValues::Recovered);
                let largest = field.largest(simulation.system().mesh());
                // The colour range of a body at rest covers its last state only.
                assert!(!moves || largest <= preview.range[1], "{id}, picture {k}");
            });
            assert_eq!(seen, preview.pictures, "{id}");
        }
        let cancelled = Preview::new(0.04, &mut session("swing", &["dynamics.duration=1"]), &|progress| {
            if progress.fraction > 0.5 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        });
        assert!(cancelled.is_none());
    }

    /// An unstable motion does not make the view infinitely large.
    #[test]
    fn an_unstable_motion_leaves_the_picture() {
        let mut swing = session("swing", &["dynamics.integrator=symplectic-euler", "dynamics.time_step=0.001"]);
        let size = {
            let (low, high) = swing.simulation().mesh().bounds();
            (high - low).norm()
        };
        let preview = Preview::new(0.001, &mut swing, &|_| ControlFlow::Continue(())).unwrap();
        assert!((preview.area.1 - preview.area.0).norm() <= LARGEST_VIEW * size && preview.range[1].is_finite());
        assert!(preview.pictures > 1);
    }
}
