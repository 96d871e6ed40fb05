//! [`Lab`]: the complete content of a window. Window, screenshots and tests all show it through [`Lab::ui`].

use crate::app::interface::*;
use crate::app::modes::compare::Compare;
use crate::app::modes::learn::{self, Learn};
use crate::app::modes::measure::Measure;
use crate::app::modes::section_plot::SectionPlot;
use crate::app::panel::PanelState;
use crate::app::session::Notice;
use crate::app::session::document::{Document, built_in};
use crate::app::session::recovery::Unsaved;
use crate::app::shell::file_dialog::FileDialog;
use crate::app::shell::gallery::Gallery;
use crate::app::shell::settings::Settings;
use crate::app::viewport::main_view::{CardContent, Content, MainView};

/// Request of the lab to the window that shows it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Request {
    /// Save an image of the window.
    Screenshot,
    /// Close the window.
    Close,
    /// Remove the copy of unsaved edits left by a crashed window.
    DiscardCopy,
}

/// Model with its view and tools. The mode Learn has a desk of its own.
#[derive(Debug)]
pub struct Desk {
    /// Model.
    pub session: Session,
    pub(crate) viewport: MainView,
    /// Display options.
    pub view: ViewOptions,
    pub(super) panel: PanelState,
    pub(super) compare: Compare,
    pub(super) measure: Measure,
    pub(super) sections: SectionPlot,
}

impl Desk {
    pub(super) fn new(session: Session) -> Self {
        Self {
            viewport: MainView::new(session.simulation().system().mesh()),
            view: ViewOptions::default(),
            panel: PanelState::default(),
            compare: Compare::new(session.is_motion()),
            measure: Measure::default(),
            sections: SectionPlot::default(),
            session,
        }
    }

    /// Returns `true` if the calculation or the motion that is shown has ended.
    pub(super) fn has_ended(&self) -> bool {
        match self.view.mode {
            Mode::Compare => !self.compare.goes_on(),
            _ => self.session.has_ended(),
        }
    }
}

/// Story while it is told.
#[derive(Debug)]
pub(super) struct Story {
    /// Time of the start, s.
    pub start: Option<f64>,
    /// Index of the current part, and the time until its end, s.
    pub part: usize,
    pub left: f64,
    /// `true` if each part is a still.
    pub is_still: bool,
    /// `true` if the body is compared with the reference solution: under the scene's load.
    pub compares: bool,
    /// View options before the story.
    pub view: ViewOptions,
    /// The user's desk, if the story was started in Learn.
    pub aside: Option<Box<Desk>>,
}

/// Complete content of a window.
pub struct Lab {
    /// Desk of the scene, or of the mode Learn.
    pub desk: Desk,
    pub(super) learn: Learn,
    /// In Learn, the user's desk, which is restored when the mode ends.
    pub(super) aside: Option<Box<Desk>>,
    /// Story of the first start, while it is told.
    pub(super) story: Option<Box<Story>>,
    pub(super) dialog: Option<FileDialog>,
    /// Action that would lose unsaved edits, while the user is asked about them.
    pub(super) question: Option<Action>,
    /// Edits left by a crashed window, while they are offered.
    pub left: Option<Unsaved>,
    /// Requests to the window after this frame.
    pub(super) requests: Vec<Request>,
    /// Settings that neither the display options nor egui has.
    pub settings: Settings,
    /// Message, and the time until which it is shown, s.
    pub(super) toast: Option<(String, f64)>,
    /// Warnings, and the number of them that the user has closed.
    pub(super) warnings: Vec<String>,
    pub(super) closed_warnings: usize,
    pub(super) gallery: Gallery,
    /// `true` if an edit during the last [`Self::ui`] has left parts that show the scene before it, which are to be laid
    /// out again before they are displayed.
    pub is_mixed: bool,
}

impl Lab {
    /// Creates a lab with `scene`, iterating from rest.
    pub fn new(source: Source, scene: Scene, simulation: Simulation) -> Self {
        Self {
            desk: Desk::new(Session::new(source, scene, simulation)),
            learn: Learn::new(0),
            aside: None,
            story: None,
            dialog: None,
            question: None,
            left: None,
            requests: Vec::new(),
            settings: Settings::default(),
            toast: None,
            warnings: Vec::new(),
            closed_warnings: 0,
            gallery: Gallery::default(),
            is_mixed: false,
        }
    }

    /// Creates a lab that shows the first built-in scene until `scene`, which is large, has been meshed in the
    /// background; `None` if the built-in scene cannot be shown.
    pub(crate) fn opening(source: Source, scene: Scene) -> Option<Self> {
        let (own, meanwhile) = built_in(registry::DEFAULT)?;
        let mut simulation = Simulation::new(&meanwhile).ok()?;
        simulation.solve();
        let mut lab = Self::new(own, meanwhile, simulation);
        let session = &mut lab.desk.session;
        if let Err(error) = session.replace(Unsaved { document: Document::new(source, scene.clone()), scene }) {
            session.notices.push(Notice { label: None, message: (&error).into() });
        }
        Some(lab)
    }

    /// Returns `true` if motions are compared; the body of Explore is then paused.
    pub(super) fn compares_motions(&self) -> bool {
        self.desk.view.mode == Mode::Compare && self.desk.session.is_motion()
    }

    /// Iterates to equilibrium, or as far as a displayed frame has time, if the lab runs; or makes the time steps that are due
    /// at `now`, s (any clock that runs in real time). Returns `true` if more remain.
    pub fn advance(&mut self, now: f64) -> bool {
        if self.story.is_some() {
            self.advance_story(now);
        } else if self.compares_motions() {
            let Desk { session, compare, .. } = &mut self.desk;
            session.poll();
            session.playback.clock.rest();
            compare.advance_motions(session, now);
        } else if self.desk.session.advance(now) {
            self.learn.line = learn::UNTIL;
        }
        self.apply_session_changes();
        self.story.is_some() || self.iterates()
    }

    /// Returns `true` if the next frame changes the body.
    pub fn iterates(&self) -> bool {
        if self.compares_motions() {
            return self.desk.session.is_running() && self.desk.compare.goes_on() && !self.desk.compare.is_timing;
        }
        self.desk.session.iterates()
    }

    /// Iterates until the status is final, or to the end of the motion's duration, and computes all displayed results.
    pub fn solve(&mut self) {
        let has_search = *self.simulation().status() == Status::Running;
        let learns_rho = self.learns_rho();
        self.desk.session.solve(learns_rho);
        self.apply_session_changes();
        let Desk { session, view, compare, measure, sections, .. } = &mut self.desk;
        measure.obtain(session, view, false, true);
        if session.is_motion() {
            return;
        }
        if view.drawer == Some(Drawer::Section) {
            sections.wait(session.simulation());
        }
        if view.mode == Mode::Compare {
            compare.solve_to_end(session, view.layout.bars);
        }
        if has_search {
            self.learn.line = learn::UNTIL;
        }
    }

    /// Returns the desk of the user's scene, which Learn puts aside; `None` while the story is told on it.
    pub(super) fn own_desk(&self) -> Option<&Desk> {
        let aside = self.story.as_ref().map_or(&self.aside, |story| &story.aside);
        aside.as_deref().or_else(|| self.story.is_none().then_some(&self.desk))
    }

    /// Returns `true` if a card of Learn shows ρ at the equilibrium.
    pub(super) fn learns_rho(&self) -> bool {
        self.aside.is_some() && self.learn.shows_rho()
    }

    pub(super) fn content(&self) -> Content<'_> {
        let Self { desk: Desk { session, view, panel, .. }, learn, aside, .. } = self;
        content(session, view, panel, aside.is_some().then_some(learn))
    }

    pub(super) fn viewport_and_content(&mut self) -> (&mut MainView, Content<'_>) {
        let Self { desk: Desk { session, viewport, view, panel, .. }, learn, aside, .. } = self;
        (viewport, content(session, view, panel, aside.is_some().then_some(learn)))
    }
}

fn content<'a>(
    session: &'a Session,
    options: &'a ViewOptions,
    panel: &PanelState,
    learn: Option<&'a Learn>,
) -> Content<'a> {
    Content {
        session,
        options,
        direction: panel.force_direction(),
        card: learn.map(|learn| CardContent { is_apart: learn.is_apart(), reach: learn.reach.as_ref() }),
    }
}
