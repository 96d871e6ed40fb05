//! Story of the first start: in five parts the default scene shows linear theory, the limit of the warped iteration,
//! Newton's method and another element. It ends as it began: with that scene, or with the card of Learn that was open.

use super::*;
use crate::app::platform::page;
use crate::app::shell::lab::Story;

struct Part {
    /// Text over the body, of at most eight words.
    caption: &'static str,
    /// Duration, s.
    seconds: f64,
    /// Returns the method, the element, and the load relative to the scene's, at a fraction of the duration.
    setting: fn(f64) -> (MethodKind, ElementKind, f64),
    /// `true` if the outline of the linear solution is shown, and (second) that of the reference solution.
    outlines: [bool; 2],
}

/// Load beyond the limit of the warped iteration, and the largest one, relative to the scene's.
const PAST: f64 = 1.8;
const FAR: f64 = 2.5;

const PARTS: [Part; 5] = [
    Part {
        caption: "Linear theory (orange) grows; warped keeps its area.",
        seconds: 5.0,
        setting: |t| (MethodKind::Warped, ElementKind::T6, between(0.0, 1.0, t / 0.8)),
        outlines: [true, false],
    },
    Part {
        caption: "Beyond ρ ≈ 1 the warped iteration diverges.",
        seconds: 4.5,
        setting: |t| (MethodKind::Warped, ElementKind::T6, between(1.0, PAST, t / 0.8)),
        outlines: [false, false],
    },
    Part {
        caption: "Newton\u{2019}s method carries on.",
        seconds: 3.0,
        setting: |t| (MethodKind::Newton, ElementKind::T6, between(PAST, FAR, t / 0.8)),
        outlines: [false, false],
    },
    Part {
        caption: "Three-node triangles lock; six-node ones do not.",
        seconds: 4.5,
        setting: |t| {
            let element = if t < 0.5 { ElementKind::T3 } else { ElementKind::T6 };
            (MethodKind::Newton, element, between(FAR, 1.0, t / 0.25))
        },
        outlines: [false, true],
    },
    Part {
        caption: "Your turn: drag the arrow.",
        seconds: 3.0,
        setting: |_| (MethodKind::Warped, ElementKind::T6, 1.0),
        outlines: [true, true],
    },
];

/// Space that the bodies of all parts take beyond the beam at rest, m: to the right and below.
const BEYOND: Vector2<f64> = Vector2::new(0.5, 7.0);
/// Distance of the caption from the top of the view, points: below the line key and the note of a diverged load.
const CAPTION: f32 = 80.0;
/// Margins around the bodies, as parts of the height of the view; the caption is above them.
const MARGINS: [f64; 2] = [0.26, 0.12];

/// Moves from one load to another, with zero velocity at both ends.
fn between(from: f64, to: f64, t: f64) -> f64 {
    let t = t.clamp(0.0, 1.0);
    from + (to - from) * t * t * (3.0 - 2.0 * t)
}

/// Returns the duration of the story, s.
pub(crate) fn seconds() -> f64 {
    PARTS.iter().map(|part| part.seconds).sum()
}

impl Lab {
    /// Tells the story on the default scene, from the time of the next [`Self::advance`] on. Does nothing if an edited
    /// scene or another one would be lost.
    pub fn tell_story(&mut self) {
        let Some((source, scene)) = built_in(registry::DEFAULT) else { return };
        let is_lost = self.aside.is_none() && (*self.scene() != scene || self.desk.session.undo.can_undo());
        if self.story.is_some() || is_lost {
            return;
        }
        let Desk { session, view, panel, .. } = &mut self.desk;
        // Cannot fail: the scene is built in.
        if session.set_scene(scene).is_err() {
            return;
        }
        session.rebase(source);
        session.set_running(true);
        *panel = PanelState::default();
        let layout = LayoutOptions { panel: true, sheet: false, ..view.layout };
        let own = ViewOptions { layout, ..ViewOptions::default() };
        let view = std::mem::replace(view, own);
        let (is_still, aside) = (self.reduces_motion(), self.aside.take());
        let (start, part, left, compares) = (None, 0, 0.0, false);
        self.story = Some(Box::new(Story { start, part, left, is_still, compares, view, aside }));
    }

    /// Returns the index of the story's current part, and its caption; `None` if no story is told.
    pub fn story(&self) -> Option<(usize, &'static str)> {
        let part = self.story.as_ref()?.part;
        Some((part, PARTS.get(part)?.caption))
    }

    /// Returns `true` if animations are replaced by stills.
    pub(crate) fn reduces_motion(&self) -> bool {
        self.settings.reduced_motion || page::prefers_reduced_motion()
    }

    /// Shows the story at the time `now`, s. The body depends on that time only, not on the frames before.
    pub(super) fn advance_story(&mut self, now: f64) {
        let Some(story) = &mut self.story else { return };
        let mut time = now - *story.start.get_or_insert(now);
        let Some((number, part)) = PARTS.iter().enumerate().find(|(_, part)| {
            let is_current = time < part.seconds;
            time -= if is_current { 0.0 } else { part.seconds };
            is_current
        }) else {
            return self.end_story();
        };
        (story.part, story.left) = (number, part.seconds - time);
        let (method, element, load) = (part.setting)(if story.is_still { 1.0 } else { time / part.seconds });
        story.compares = load == 1.0;
        let Desk { session, view, .. } = &mut self.desk;
        [view.lines.ghost, view.lines.exact] = part.outlines;
        let mut scene = session.document().original.clone();
        scene.solver.method = method;
        scene.set_element(element);
        scene.scale_loads(load);
        if *session.scene() == scene && session.has_ended() {
            return;
        }
        if session.set_scene(scene).is_err() {
            return self.end_story();
        }
        session.solve_from_rest();
    }

    /// Waits for the reference solution, if the body is compared with it.
    pub(crate) fn finish_story_frame(&mut self) {
        if self.story.as_ref().is_some_and(|story| story.compares) {
            self.desk.session.obtain_reference(true);
        }
    }

    /// Ends the story if the user does something; a movement of the pointer alone does not count.
    pub(super) fn end_story_on_input(&mut self, ctx: &Context) {
        let is_input = |event: &Event| match event {
            Event::Key { pressed, repeat, .. } => *pressed && !repeat,
            Event::PointerButton { pressed, .. } => *pressed,
            Event::Touch { phase, .. } => *phase == egui::TouchPhase::Start,
            Event::MouseWheel { .. } | Event::Zoom(_) | Event::Paste(_) | Event::AccessKitActionRequest(_) => true,
            _ => false,
        };
        if self.story.is_some() && ctx.input(|i| i.events.iter().any(is_input) || !i.raw.dropped_files.is_empty()) {
            self.end_story();
            // The key that ends the story does nothing else.
            ctx.input_mut(|i| i.events.retain(|event| !matches!(event, Event::Key { pressed: true, .. })));
        }
    }

    /// Ends the story: the scene is solved as it was opened, or Learn shows its card again.
    pub(super) fn end_story(&mut self) {
        let Some(story) = self.story.take() else { return };
        (self.desk.view, self.aside) = (story.view, story.aside);
        self.desk.viewport.camera.own = None;
        if self.aside.is_some() {
            return self.set_card_up();
        }
        let session = &mut self.desk.session;
        let original = session.document().original.clone();
        if *session.scene() != original && session.set_scene(original).is_ok() {
            session.solve_from_rest();
        }
    }

    /// Fits the camera to the bodies of all parts: a camera that followed the body would hide its growth.
    pub(super) fn aim_story(&mut self) {
        if self.story.is_none() {
            return;
        }
        let Desk { session, viewport, .. } = &mut self.desk;
        let (low, high) = session.simulation().system().mesh().bounds();
        let (low, high) = (low - Vector2::new(0.0, BEYOND.y), high + Vector2::new(BEYOND.x, 0.0));
        let rect = viewport.view.rect;
        let size @ [_, height] = [rect.width(), rect.height()].map(f64::from);
        let [top, bottom] = MARGINS.map(|part| part * height);
        viewport.camera.set_camera(Camera::fit(low, high, size, Margins { sides: 76.0, top, bottom }));
    }

    /// Paints the caption, and in the last part a ring around the tip of the arrow.
    pub(super) fn paint_story(&self, ui: &Ui, painter: &Painter, rect: Rect) {
        const RING: f32 = 13.0;
        let Some((part, caption)) = self.story() else { return };
        let palette = Palette::new(ui.visuals());
        if part + 1 == PARTS.len() {
            for (_, tip) in self.arrow_tips() {
                painter.circle_stroke(tip, RING, Stroke::new(2.5, palette.accent));
            }
        }
        let caption = tr(caption);
        let font = FontId::proportional(HEADLINE);
        let galley = painter.layout(caption.to_owned(), font, palette.text, (rect.width() - 48.0).max(40.0));
        let area = Align2::CENTER_TOP.anchor_size(rect.center_top() + vec2(0.0, CAPTION), galley.size());
        painter.rect_filled(area.expand2(vec2(12.0, 5.0)), 6.0, palette.panel);
        painter.galley(area.min, galley, palette.text);
        // For screen readers.
        let response = ui.interact(area, Id::unique("story"), Sense::empty());
        response.widget_info(|| WidgetInfo::labeled(Role::Label, true, caption));
    }
}
