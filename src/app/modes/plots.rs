//! Plots under the body. Of a motion: energy by kind, and displacement of the first probe over time. Of a body at rest: the
//! stress along each section of the scene, and N, V and M along its beam.

use super::*;
use crate::app::diagnosis::state_text;
use crate::app::session::playback::{History, MotionSample};
use crate::app::task::thread::{Reporter, Task, Update};
use crate::app::view_options::MotionPlot;
use crate::app::viewport::objects::add_middle_section;
use crate::format::Context;
use crate::section::{Section, SectionError};
use crate::simulation::Equilibrium;
use crate::state::State;
use crate::study::section_chart::{self, COMPONENTS, STRESSES};

/// Sections of one equilibrium.
struct Cuts {
    of: (State, Scene),
    /// `true` if the computation ended unexpectedly.
    has_failed: bool,
    /// Sections of the scene.
    own: Vec<Result<Section, SectionError>>,
    /// Sections along the beam; none if the body has no axis.
    along: Vec<Section>,
    /// Contexts of the forces in all of them.
    contexts: [Context; 3],
}

impl Cuts {
    fn of(simulation: &Simulation) -> Self {
        let (own, along) = (simulation.scene_sections(), simulation.diagram_sections().unwrap_or_default());
        let all: Vec<Section> = own.iter().flatten().chain(&along).cloned().collect();
        let contexts = section_chart::contexts(&all, simulation);
        Self { has_failed: false, contexts, own, along, ..Self::failed(simulation) }
    }

    /// Returns the result of a computation that ended unexpectedly.
    fn failed(simulation: &Simulation) -> Self {
        let of = (simulation.state().clone(), simulation.scene().clone());
        Self { of, has_failed: true, own: Vec::new(), along: Vec::new(), contexts: Default::default() }
    }

    fn is_of(&self, simulation: &Simulation) -> bool {
        self.of.0 == *simulation.state() && self.of.1 == *simulation.scene()
    }

    fn offered(&self) -> Vec<SectionFigure> {
        let along = if self.along.is_empty() { 0 } else { COMPONENTS.len() };
        let stresses = (0..self.own.len()).flat_map(|i| [0, 1].map(|component| SectionFigure::Stress(i, component)));
        stresses.chain((0..along).map(SectionFigure::Along)).collect()
    }

    fn figure(&self, shown: SectionFigure) -> Result<Figure, SectionError> {
        let scene = &self.of.1;
        match shown {
            SectionFigure::Stress(i, component) => {
                let section = self.own.get(i).ok_or(SectionError::Missed)?.as_ref().map_err(|error| *error)?;
                let figures = section_chart::stress(section, scene, &self.contexts, &|name| said(name));
                figures.into_iter().nth(component).ok_or(SectionError::Missed)
            }
            SectionFigure::Along(i) => {
                let figures = section_chart::forces(&self.along, scene, &self.contexts, &|name| said(name));
                figures.into_iter().nth(i).ok_or(SectionError::NoAxis)
            }
        }
    }
}

/// Figure of the sections.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum SectionFigure {
    /// Stress along the section of the scene with the first index, as the second index of [`STRESSES`].
    Stress(usize, usize),
    /// Component along the beam, as an index of [`COMPONENTS`].
    Along(usize),
}

/// Plots of the sections of the last equilibrium, computed once per state.
#[derive(Default)]
pub(crate) struct SectionPlot {
    cuts: Option<Cuts>,
    computing: Option<Task<(), Box<Cuts>>>,
    shown: Option<SectionFigure>,
    /// Number of sections of the scene that was shown last.
    count: usize,
}

impl SectionPlot {
    /// Largest number of unknowns of a body whose sections are computed on the window's thread.
    const MAX_UNKNOWNS: usize = 2000;

    /// Requests the sections of an equilibrium; returns `true` while they are pending.
    fn request(&mut self, simulation: &Simulation) -> bool {
        if let Some(task) = &self.computing {
            match task.poll() {
                Update::None | Update::Progress(()) => return true,
                Update::Done(cuts) => self.cuts = Some(*cuts),
                // The same computation would end in the same way.
                Update::Died => self.cuts = Some(Cuts::failed(simulation)),
            }
            self.computing = None;
        }
        let Some(equilibrium) = simulation.equilibrium().filter(|_| simulation.status().is_success()) else {
            return false;
        };
        if self.cuts_of(simulation).is_some() {
            return false;
        }
        if simulation.system().dofs() > Self::MAX_UNKNOWNS && !IS_PAGE {
            let copy = Equilibrium::snapshot(equilibrium);
            self.computing = Task::start("sections", move |_: &Reporter<_, _>| Box::new(Cuts::of(&copy))).ok();
        }
        if self.computing.is_none() {
            self.cuts = Some(Cuts::of(simulation));
        }
        self.computing.is_some()
    }

    /// Returns the sections of a state, if they have been computed.
    fn cuts_of(&self, simulation: &Simulation) -> Option<&Cuts> {
        self.cuts.as_ref().filter(|cuts| cuts.is_of(simulation))
    }

    pub(crate) fn is_pending(&self) -> bool {
        self.computing.is_some()
    }

    /// Computes the sections of an equilibrium, and waits for them.
    pub(crate) fn wait(&mut self, simulation: &Simulation) {
        if self.cuts_of(simulation).is_none() {
            (self.cuts, self.computing) = (Some(Cuts::of(simulation)), None);
        }
    }

    /// Shows the plots of the drawn equilibrium, with a description if it is not the result for the scene; a scene without a
    /// section, or whose first result is pending, gets the reason.
    pub(crate) fn show(&mut self, ui: &mut Ui, session: &Session, actions: &mut Vec<Action>) {
        let simulation = session.drawn();
        if self.request(simulation) {
            ui.ctx().request_repaint_after(POLL);
        }
        let count = self.cuts_of(simulation).map_or(self.count, |cuts| cuts.own.len());
        if std::mem::replace(&mut self.count, count) < count {
            // A new section is shown.
            self.shown = Some(SectionFigure::Stress(count - 1, 0));
        }
        let cuts = self.cuts_of(simulation);
        let offered = cuts.map(Cuts::offered).unwrap_or_default();
        let has_none = cuts.is_some_and(|cuts| cuts.own.is_empty());
        // The bending moment, or the stress along the first section.
        let usual = if has_none { offered.last() } else { offered.first() };
        let shown = self.shown.filter(|figure| offered.contains(figure)).or(usual.copied());
        let drawn = cuts.zip(shown).map(|(cuts, shown)| cuts.figure(shown));
        let reason = match cuts {
            Some(cuts) if cuts.has_failed => "the computation ended unexpectedly",
            Some(_) => "No section has been added.",
            None => "Sections are being computed.",
        };
        let show_plot = |ui: &mut Ui| match &drawn {
            Some(Ok(drawn)) => _ = figure::plot(ui, drawn, drawn.corners()),
            Some(Err(error)) => _ = ui.centered_and_justified(|ui| ui.weak(said(error))),
            None => _ = ui.centered_and_justified(|ui| ui.weak(tr(reason))),
        };
        let show_table = |ui: &mut Ui| {
            if let Some(state) = state_text(session) {
                ui.weak(state);
            }
            ui.horizontal_wrapped(|ui| {
                ui.spacing_mut().item_spacing = vec2(4.0, 2.0);
                let is_numbered = offered.contains(&SectionFigure::Stress(1, 0));
                self.shown = options(ui, offered.iter().map(|figure| figure.option(is_numbered)), shown).or(self.shown);
                if has_none {
                    let tip = "Adds a section through the middle of the body; the context menu of the body adds one at a point";
                    if ui.button(tr("Add a section")).on_hover_text(tr(tip)).clicked() {
                        let add = |scene: &mut Scene| add_middle_section(scene, simulation.system());
                        actions.push(Action::edit("Sections", session.scene(), add));
                    }
                }
                if let Some(Ok(drawn)) = &drawn {
                    figure::export_menu(ui, drawn, actions);
                }
            });
            if let Some(Ok(drawn)) = &drawn {
                figure::table(ui, drawn);
            }
        };
        figure::beside(ui, show_plot, show_table);
    }
}

impl SectionFigure {
    /// Returns the figure with the words of the choice and a description; stresses are numbered if there are several.
    fn option(self, is_numbered: bool) -> (Self, String, &'static str) {
        match self {
            Self::Stress(i, component) => {
                let symbol = STRESSES.get(component).map_or("", |(symbol, ..)| symbol);
                let tip = "Stress along the section, recovered and of beam theory";
                (self, if is_numbered { format!("{symbol} {}", i + 1) } else { symbol.to_owned() }, tip)
            }
            Self::Along(i) => {
                let symbol = COMPONENTS.get(i).map_or("", |component| component.symbol);
                (self, symbol.to_owned(), "Along the beam, in sections normal to its axis; the slope of M is \u{2212}V")
            }
        }
    }
}

const PLOTS: [(MotionPlot, &str, &str); 2] = [
    (MotionPlot::Energy, "Energy", "Energy over time, by kind"),
    (MotionPlot::Tip, "Tip", "Displacement of the first probe over time"),
];

/// Duration that is shown, s; more if the displayed moment is earlier.
const SHOWN: f64 = 12.0;
/// Largest number of points of a line; longer lines are thinned.
const MAX_POINTS: usize = 1000;
/// Size of the sample of a line's colour, points.
const SAMPLE: Vec2 = vec2(14.0, 3.0);

/// Returns the line of a value in the last seconds of a motion.
fn line(
    (name, ink): (&str, Ink),
    (history, seconds): (&History, f64),
    value: impl Fn(&MotionSample) -> f64,
) -> FigureSeries {
    let samples: Vec<&MotionSample> = history.last(seconds).collect();
    let stride = samples.len().div_ceil(MAX_POINTS).max(1);
    let points = samples.iter().rev().step_by(stride).map(|s| vec![s.time, value(s)]).collect();
    FigureSeries::new(tr(name).to_owned(), ink, Mark::Line, points)
}

/// Shows the chosen plot of a motion, with the names of its lines above it.
pub(crate) fn show_motion(ui: &mut Ui, chosen: &mut MotionPlot, session: &Session) {
    let (playback, integrator) = (&session.playback, session.scene().dynamics.integrator);
    let palette = Palette::new(ui.visuals());
    let axis = playback.history.axis();
    let probe = format!("{} {}", tr(&playback.history.probe), ["x", "y"][axis]);
    let before_end = playback.shown.zip(playback.span()).map(|(shown, [_, last])| last - shown);
    let seconds = before_end.unwrap_or_default().max(SHOWN);
    let (y, series) = match chosen {
        MotionPlot::Energy => (FigureQuantity::new(tr("energy"), "J"), energies(&playback.history, seconds, &palette)),
        MotionPlot::Tip => {
            let look = (integrator.id(), Ink::of(&Setting::of(session.scene())));
            (FigureQuantity::new(probe, "m"), vec![line(look, (&playback.history, seconds), |s| s.displacement[axis])])
        }
    };
    ui.horizontal_wrapped(|ui| {
        *chosen = options(ui, PLOTS, Some(*chosen)).unwrap_or(*chosen);
        ui.spacing_mut().item_spacing.x = 14.0;
        let shown = series.iter().filter(|line| !line.points.is_empty());
        for line in shown {
            let sample = |ui: &Ui, sample| _ = ui.painter().rect_filled(sample, 1.0, palette.ink(line.ink));
            legend::entry(ui, &line.name, SAMPLE, &sample);
        }
    });
    if playback.history.samples.is_empty() {
        ui.centered_and_justified(|ui| ui.weak(tr("No time step yet: press Run or Step.")));
        return;
    }
    let quantities = vec![FigureQuantity::new(tr("time"), "s"), y];
    let drawn = Figure { quantities, axes: [0, 1], series, ..Figure::default() };
    let [mut low, mut high] = drawn.corners();
    // The oldest and the latest moment are at the edges.
    let mut times = playback.history.last(seconds).map(|sample| sample.time);
    if let Some(times) = times.next().zip(times.last()) {
        (low[0], high[0]) = times;
    }
    let (mut painter, [time, value]) = figure::plot(ui, &drawn, [low, high]);
    // Displayed moment, if it is not the latest.
    if let Some(x) = playback.shown.map(|shown| time.place(shown)) {
        painter.line(&[low[1], high[1]].map(|end| [x, value.place(end)]), Ink::Text, 1.0, &[]);
    }
}

/// Name of a kind of energy, its colour, and the function that returns its value, J.
type EnergyKind = (&'static str, Color32, fn(&MotionSample) -> f64);

/// Returns the energies of a motion by kind, and their sum. Energies that are always zero have no line.
fn energies(history: &History, seconds: f64, palette: &Palette) -> Vec<FigureSeries> {
    let [kinetic, elastic, potential, dissipated, lost, put_in] = palette.energies();
    let kinds: [EnergyKind; 6] = [
        ("kinetic", kinetic, |s| s.ledger.kinetic),
        ("elastic", elastic, |s| s.ledger.elastic),
        ("potential of loads", potential, |s| s.ledger.potential),
        ("dissipated", dissipated, |s| s.ledger.dissipated),
        ("lost by the integrator", lost, |s| s.ledger.integrator),
        ("energy input", put_in, |s| s.ledger.pulses + s.ledger.mouse_spring + s.ledger.edits),
    ];
    let shown = kinds.into_iter().filter(|(_, _, value)| history.samples.iter().any(|s| value(s) != 0.0));
    let parts = shown.map(|(name, color, value)| {
        let [r, g, b, _] = color.to_array();
        line((name, Ink::Fixed([r, g, b])), (history, seconds), value)
    });
    parts.chain([line(("total", Ink::Text), (history, seconds), |s| s.ledger.total())]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The shear force along a beam jumps at a point load, by the load, and is not drawn as a slope.
    #[test]
    fn the_shear_force_jumps_at_a_point_load() {
        let scene = Scene::beam(10.0, 1.0).with_cells(20, 2).clamp("left").point_force([4.3, 0.2], [0.0, -1.0]);
        let mut simulation = Simulation::new(&scene).unwrap();
        simulation.solve();
        let cuts = Cuts::of(&simulation);
        let pairs = cuts.along.windows(2);
        let steps = pairs.map(|p| (p[1].line.at.x - p[0].line.at.x, (p[1].forces.shear - p[0].forces.shear).abs()));
        let (distance, jump) = steps.max_by(|a, b| a.1.total_cmp(&b.1)).unwrap();
        assert!(distance < 1e-4 && (jump - 1.0).abs() < 1e-3, "{jump} N within {distance} m");
        assert!(cuts.along.windows(2).all(|p| p[0].line.at.x <= p[1].line.at.x));
    }
}
