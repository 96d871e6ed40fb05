//! The pointer over the view. A press takes one thing: the tip of an arrow sets its force, the body is pulled, empty
//! space moves the view. The wheel zooms to the pointer.

use std::ops::RangeInclusive;

use egui::{CursorIcon, Pos2, Response, Ui, Vec2};
use nalgebra::Vector2;

use super::arrow::{self, Arrow};
use super::overlay::HotArrow;
use super::playback::Playback;
use crate::mesh::{MaterialPoint, Segment};
use crate::render::Camera;
use crate::simulation::Simulation;

/// What the pointer has done to the view.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) enum Look {
    /// Nothing.
    #[default]
    Same,
    /// Somewhere else.
    At(Camera),
    /// Back to the whole body.
    Fit,
}

/// What a press has taken, until it is let go.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
enum Held {
    /// There is no press, or it was elsewhere.
    #[default]
    Nothing,
    /// The tip of an arrow, as it was when it was pressed, and where it was pressed.
    Tip(Arrow, Pos2),
    /// The body, at a point.
    Body(MaterialPoint),
    /// The view, at a point of a body that cannot be pulled.
    Point(MaterialPoint),
    /// Empty space.
    Space,
}

/// What the pointer is on, or has taken.
#[derive(Debug, Default)]
pub(super) struct Pointer {
    held: Held,
    /// The arrow under a pointer that is not pressed.
    over_tip: Option<Arrow>,
    /// The material point under a pointer that is not pressed.
    over_body: Option<MaterialPoint>,
    /// Where the pointer is.
    at: Option<Pos2>,
}

/// What the pointer asks for in one frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Wish {
    pub look: Look,
    /// A force by its number among the loads: N, and degrees.
    pub force: Option<(usize, f64, f64)>,
    /// A load by its number, that is to be as in the scene's file again.
    pub restore: Option<usize>,
    /// A click on the body, or `None` in it for one beside the body.
    pub clicked: Option<Option<MaterialPoint>>,
}

/// So near to a thin body, points, counts as on it.
const NEAR: f64 = 8.0;
/// A tip that has moved less than this since it was pressed, points, has not been dragged.
const STILL: f32 = 2.0;

/// The body under the pointer.
pub(super) enum Body<'a> {
    /// None that could be reached.
    None,
    /// One that says its values and cannot be pulled.
    Seen(&'a Simulation),
    /// One that can be pulled.
    InHand(&'a mut Simulation, &'a mut Playback),
}

impl Body<'_> {
    fn simulation(&self) -> Option<&Simulation> {
        match self {
            Self::None => None,
            Self::Seen(simulation) => Some(simulation),
            Self::InHand(simulation, _) => Some(simulation),
        }
    }
}

/// What a hand needs to find what it reaches for.
pub(super) struct Reach<'a> {
    pub camera: Camera,
    /// Where the nodes are, m.
    pub positions: &'a [Vector2<f64>],
    pub outline: &'a [Segment],
    pub arrows: &'a [Arrow],
    /// Whether the elements are drawn elsewhere: there is nothing to reach then.
    pub apart: bool,
    /// Magnifications that the wheel may reach.
    pub scales: RangeInclusive<f64>,
}

impl Reach<'_> {
    /// The place in the plane under a place in the view, m.
    fn place(&self, response: &Response, at: Pos2) -> Vector2<f64> {
        let at = at - response.rect.center();
        self.camera.to_world([f64::from(at.x), f64::from(at.y)])
    }

    fn point(&self, simulation: &Simulation, place: Vector2<f64>) -> Option<MaterialPoint> {
        if self.apart {
            return None;
        }
        simulation.system().mesh().pick(self.positions, self.outline, place, NEAR / self.camera.scale)
    }
}

impl Pointer {
    /// The arrow whose tip it is on, or has taken.
    pub(super) fn hot_arrow(&self) -> Option<HotArrow> {
        if let Held::Tip(arrow, pressed) = self.held {
            let by = self.at.map_or(Vec2::ZERO, |at| at - pressed);
            return Some(HotArrow { arrow, dragged: (by.length() >= STILL).then_some(by) });
        }
        self.over_tip.map(|arrow| HotArrow { arrow, dragged: None })
    }

    /// The material point it is over, and where it is, while nothing is pressed.
    pub(super) fn over_body(&self) -> Option<(MaterialPoint, Pos2)> {
        self.over_body.zip(self.at)
    }

    /// Whether it has taken something of the body or its loads: a view that moved then would move the place under it.
    pub(super) fn holds(&self) -> bool {
        matches!(self.held, Held::Tip(..) | Held::Body(_))
    }

    /// Follows the pointer over the view that `response` belongs to.
    pub(super) fn follow(&mut self, ui: &Ui, response: &Response, reach: &Reach<'_>, mut body: Body<'_>) -> Wish {
        let (pressed, origin, down, at, let_go_at, fingers, snap) = ui.input(|i| {
            let pointer = &i.pointer;
            let fingers = i.multi_touch().map(|touch| touch.translation_delta);
            let (pressed, down) = (pointer.primary_pressed(), pointer.primary_down());
            let let_go_at = i.events.iter().rev().find_map(|event| match event {
                egui::Event::PointerButton { pos, button: egui::PointerButton::Primary, pressed: false, .. } => {
                    Some(*pos)
                }
                _ => None,
            });
            (pressed, pointer.press_origin(), down, pointer.interact_pos(), let_go_at, fingers, i.modifiers.shift)
        });
        self.at = at;
        let mut wish = Wish::default();
        // A quick click is pressed and released within one frame. Two fingers move the view: what the first has taken is
        // let go.
        let is_here = response.is_pointer_button_down_on() || response.clicked();
        if pressed && is_here && fingers.is_none() {
            // Since the press the pointer may have moved on.
            let at = origin.or(at);
            self.held = at.map_or(Held::Nothing, |at| Self::take(response, reach, &mut body, at));
        }
        // After it was let go the pointer may have moved on, too.
        if let Some(at) = let_go_at.or(at) {
            self.drag(response, reach, &mut body, (at, snap), &mut wish);
        }
        if response.double_clicked() {
            match self.held {
                Held::Tip(arrow, _) => wish.restore = Some(arrow.load),
                Held::Body(_) | Held::Point(_) | Held::Space => wish.look = Look::Fit,
                Held::Nothing => {}
            }
        } else if response.clicked() {
            match self.held {
                Held::Body(point) | Held::Point(point) => wish.clicked = Some(Some(point)),
                Held::Space => wish.clicked = Some(None),
                Held::Tip(..) | Held::Nothing => {}
            }
        }
        if !down || fingers.is_some() {
            if let (Held::Body(_), Body::InHand(simulation, playback)) = (self.held, &mut body) {
                simulation.release();
                playback.release();
            }
            self.held = Held::Nothing;
        }
        self.hover(ui, response, reach, &body, down);
        if wish.look == Look::Same {
            wish.look = self.look(ui, response, reach, fingers);
        }
        wish
    }

    /// What a press here takes: a tip before the body that it may lie over.
    fn take(response: &Response, reach: &Reach<'_>, body: &mut Body<'_>, at: Pos2) -> Held {
        if let Some(arrow) = arrow::at(reach.arrows, at) {
            return Held::Tip(*arrow, at);
        }
        let place = reach.place(response, at);
        let Some(point) = body.simulation().and_then(|simulation| reach.point(simulation, place)) else {
            return Held::Space;
        };
        let Body::InHand(simulation, playback) = body else { return Held::Point(point) };
        if !simulation.grab(point) {
            return Held::Space;
        }
        playback.grab(point);
        Held::Body(point)
    }

    /// Moves what is held to where the pointer is.
    fn drag(
        &self,
        response: &Response,
        reach: &Reach<'_>,
        body: &mut Body<'_>,
        (at, snap): (Pos2, bool),
        wish: &mut Wish,
    ) {
        match self.held {
            Held::Tip(arrow, pressed) if (at - pressed).length() >= STILL => {
                let (magnitude, degrees) = arrow.dragged(at - pressed, snap);
                wish.force = Some((arrow.load, magnitude, degrees));
            }
            Held::Body(_) => {
                let Body::InHand(simulation, playback) = body else { return };
                let place = reach.place(response, at);
                if simulation.hand().is_some_and(|(hand, _)| hand.target() != place) {
                    // A pointer has a finite place.
                    let _ = simulation.pull_to(place);
                    playback.pull_to(place);
                }
            }
            Held::Tip(..) | Held::Point(_) | Held::Space | Held::Nothing => {}
        }
    }

    /// Finds what is under the pointer, and says so with the cursor.
    fn hover(&mut self, ui: &Ui, response: &Response, reach: &Reach<'_>, body: &Body<'_>, down: bool) {
        (self.over_tip, self.over_body) = (None, None);
        let cursor = match self.held {
            Held::Tip(..) => Some(CursorIcon::Move),
            Held::Body(_) => Some(CursorIcon::Grabbing),
            Held::Point(_) | Held::Space => Some(CursorIcon::AllScroll),
            Held::Nothing => response.hover_pos().filter(|_| !down).map(|at| {
                self.over_tip = arrow::at(reach.arrows, at).copied();
                if self.over_tip.is_some() {
                    return CursorIcon::Move;
                }
                self.over_body = body.simulation().and_then(|body| reach.point(body, reach.place(response, at)));
                match (self.over_body, body) {
                    (Some(_), Body::InHand(..)) => CursorIcon::Grab,
                    _ => CursorIcon::Default,
                }
            }),
        };
        if let Some(cursor) = cursor {
            ui.set_cursor_icon(cursor);
        }
    }

    /// Moves and zooms the view.
    fn look(&self, ui: &Ui, response: &Response, reach: &Reach<'_>, fingers: Option<Vec2>) -> Look {
        let mut camera = reach.camera;
        let mut look = Look::Same;
        // Two fingers move the view together, wherever they are.
        let drag = fingers.unwrap_or_else(|| response.drag_delta());
        if drag != Vec2::ZERO && !self.holds() {
            camera.pan([f64::from(drag.x), f64::from(drag.y)]);
            look = Look::At(camera);
        }
        if let Some(pointer) = response.hover_pos() {
            let (scroll, pinch) = ui.input(|i| (i.smooth_scroll_delta().y, i.zoom_delta()));
            let factor = f64::from(pinch) * (f64::from(scroll) * 0.004).exp();
            // A pointer that only rests over the view must not stop it from following the body.
            if factor != 1.0 {
                let at = pointer - response.rect.center();
                camera.zoom(factor, [f64::from(at.x), f64::from(at.y)], reach.scales.clone());
                look = Look::At(camera);
            }
        }
        look
    }
}
