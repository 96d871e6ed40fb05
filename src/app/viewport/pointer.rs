//! Interaction of the pointer with the view. A drag of an arrow sets its load, a drag of the base of an
//! object moves it along the body, a drag of the body grabs it, and a drag of empty space moves the view. The wheel zooms about the pointer.

use egui::{CursorIcon, PointerButton};

use crate::app::interface::*;
use crate::app::session::Grab;
use crate::app::viewport::arrow::{self, Drag, LoadArrow};
use crate::app::viewport::base::{self, Base, PressedBase};
use crate::app::viewport::body_mesh::BodyMesh;
use crate::app::viewport::camera_controller::{CameraController, CameraMove};
use crate::app::viewport::objects::Object;
use crate::app::viewport::probe;
use crate::app::viewport::projection::Projection;

/// Target of a press, or of a pointer that is not pressed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
enum Held {
    /// None, or one outside the view.
    #[default]
    Nothing,
    /// The tip of an arrow.
    Tip(Grip),
    /// The base of an object.
    Base(PressedBase),
    /// The body, pressed at a point; grabbed once the pointer leaves it.
    Body(PressedPoint),
    /// The view, pressed at a point of a body that cannot be grabbed.
    Point(MaterialPoint),
    /// Empty space.
    Space,
}

/// Material point that is pressed, of a body that can be grabbed.
#[derive(Clone, Copy, Debug, PartialEq)]
struct PressedPoint {
    point: MaterialPoint,
    /// Vector from the point to the pointer when it was pressed, m.
    offset: Vector2<f64>,
    /// `true` if the body is grabbed.
    grabs: bool,
}

/// Grabbed arrow, and the pointer's movement since then.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Grip {
    pub arrow: LoadArrow,
    pressed: Pos2,
    last: Pos2,
    /// `true` once the pointer has left the place of the press; a return to it restores the load.
    has_moved: bool,
    /// Movement of the tip: smaller than the pointer's in slow mode.
    drag: Drag,
}

impl Grip {
    /// Moves the tip with the pointer, which is now at `at`; by a tenth of the distance if `slow`.
    fn drag_to(&mut self, at: Pos2, slow: bool) {
        const SLOW: f32 = 0.1;
        /// Movements of less than this, points, do not count as a drag.
        const STILL: f32 = 2.0;
        let part = if slow { SLOW } else { 1.0 };
        self.drag.by += part * (at - self.last);
        self.drag.angle += f64::from(part) * self.arrow.angle_between(self.last, at);
        self.last = at;
        self.has_moved |= at.distance(self.pressed) >= STILL;
    }

    /// Returns the movement of the tip; `None` if it has not moved.
    pub(crate) fn drag(&self) -> Option<Drag> {
        self.has_moved.then_some(self.drag)
    }
}

/// State of the pointer: its hover target and the target of its press.
#[derive(Debug, Default)]
pub(crate) struct Pointer {
    held: Held,
    /// Target under a pointer that is not pressed.
    over: Held,
    at: Option<Pos2>,
    /// `true` if the wheel was last turned over the view. Scrolling that began elsewhere does not zoom it.
    scrolls: bool,
}

/// Interaction of the pointer with the view in one frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Interaction {
    pub camera: Option<CameraMove>,
    pub grab: Grab,
    /// Index of a load, its new value, and the new direction of a force, degrees.
    pub load: Option<(usize, (f64, Option<f64>))>,
    /// Index of a load that is reset to the value in the scene's document.
    pub restore: Option<usize>,
    /// Object whose base was dropped, or cut that is dragged, and the position there.
    pub dropped: Option<(Object, Pos2)>,
    /// Point of the body that was clicked.
    pub clicked: Option<MaterialPoint>,
}

/// Distance within which the pointer counts as on a thin body, points.
const NEAR: f64 = 8.0;

/// Distance between pointer and pressed point from which a press is a drag, points.
const DRAG_DISTANCE: f64 = 4.0;

/// Interaction that the body allows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Interactivity {
    /// Nothing can be hit: the elements are drawn apart, or the body is no result.
    Absent,
    /// No interaction; the values of the point under the pointer can be shown.
    None,
    /// The values of a point can be shown; the body cannot be grabbed.
    Visible,
    /// The body can also be grabbed.
    Grabbable,
}

/// Hit targets of the pointer in a view with this response: those of the last frame, because that is what the user sees.
pub(crate) struct HitTargets<'a> {
    pub response: &'a Response,
    pub camera: &'a CameraController,
    pub body: &'a BodyMesh,
    pub interactivity: Interactivity,
    pub arrows: &'a [LoadArrow],
    /// Bases of the objects that can be moved.
    pub bases: &'a [Base],
}

impl Held {
    /// Returns the material point of the body at the target.
    fn point(self) -> Option<MaterialPoint> {
        match self {
            Self::Body(PressedPoint { point, .. }) | Self::Point(point) => Some(point),
            Self::Base(base) => base.point,
            Self::Tip(_) | Self::Space | Self::Nothing => None,
        }
    }
}

impl HitTargets<'_> {
    /// Returns the mesh of the body; `None` if nothing can be hit.
    fn mesh(&self) -> Option<&Mesh> {
        self.body.system.as_deref().map(System::mesh).filter(|_| self.interactivity != Interactivity::Absent)
    }

    /// Returns the position in the plane of a point of the view, m.
    fn place(&self, at: Pos2) -> Vector2<f64> {
        Projection { camera: self.camera.shown, rect: self.response.rect }.place(at)
    }

    /// Returns the vector from a material point to a position in the plane, m; `None` if the mesh has no such point.
    fn offset(&self, point: MaterialPoint, place: Vector2<f64>) -> Option<Vector2<f64>> {
        Some(place - probe::place(self.mesh()?, &self.body.nodes, point)?)
    }
}

impl Pointer {
    /// Returns the target of the press, or the one under the pointer.
    fn hot(&self) -> Held {
        if self.held == Held::Nothing { self.over } else { self.held }
    }

    /// Returns the arrow that is under the pointer or grabbed.
    pub(crate) fn hot_arrow(&self) -> Option<Grip> {
        if let Held::Tip(grip) = self.hot() { Some(grip) } else { None }
    }

    /// Returns the base that is under the pointer or dragged.
    pub(crate) fn hot_base(&self) -> Option<PressedBase> {
        if let Held::Base(base) = self.hot() { Some(base) } else { None }
    }

    /// Returns the material point under the pointer and the pointer's position, while nothing is pressed.
    pub(crate) fn over_body(&self) -> Option<(MaterialPoint, Pos2)> {
        self.over.point().zip(self.at)
    }

    /// Returns `true` if an arrow, a base or the body is held.
    pub(crate) fn holds(&self) -> bool {
        matches!(self.held, Held::Tip(..) | Held::Base(_) | Held::Body(_))
    }

    /// Returns `true` if the tip of an arrow is dragged: its load depends on the pointer alone, so that the view may move.
    pub(crate) fn drags_tip(&self) -> bool {
        matches!(self.held, Held::Tip(grip) if grip.drag().is_some())
    }

    pub(crate) fn process(&mut self, ui: &Ui, targets: &HitTargets<'_>) -> Interaction {
        let response = targets.response;
        let released = |event: &Event| match event {
            Event::PointerButton { pos, button: PointerButton::Primary, pressed: false, .. } => Some(*pos),
            _ => None,
        };
        let (pointer, keys) = ui.input(|i| (i.pointer.clone(), i.modifiers));
        let (fingers, let_go_at) = ui.input(|i| (i.multi_touch(), i.events.iter().rev().find_map(released)));
        let (fingers, down) = (fingers.map(|touch| touch.translation_delta), pointer.primary_down());
        self.at = pointer.interact_pos();
        let mut interaction = Interaction::default();
        // A quick click is pressed and released within one frame. Two fingers move the view and release the target of
        // the first one.
        let is_here = response.is_pointer_button_down_on() || response.clicked();
        if pointer.primary_pressed() && is_here && fingers.is_none() {
            // The pointer may have moved since the press.
            let at = pointer.press_origin().or(self.at);
            self.held = at.map_or(Held::Nothing, |at| Self::take(targets, at));
        }
        // The pointer may also have moved after the release.
        if let Some(at) = let_go_at.or(self.at) {
            self.drag(targets, (at, keys), &mut interaction);
        }
        if response.double_clicked() {
            match self.held {
                Held::Tip(grip) => interaction.restore = Some(grip.arrow.load),
                Held::Body(_) | Held::Point(_) | Held::Space => interaction.camera = Some(CameraMove::Fit),
                Held::Base(_) | Held::Nothing => {}
            }
        } else if response.clicked() {
            interaction.clicked = self.held.point();
        }
        if !down || fingers.is_some() {
            interaction.grab.release = matches!(self.held, Held::Body(PressedPoint { grabs: true, .. }));
            // A click may also move by a few points.
            if let (Held::Base(PressedBase { base, dragged: Some(at), .. }), None, false) =
                (self.held, fingers, response.clicked())
            {
                interaction.dropped = Some((base.object, at));
            }
            self.held = Held::Nothing;
        }
        self.hover(ui, targets, down);
        interaction.camera = interaction.camera.or_else(|| self.move_camera(ui, targets, fingers));
        interaction
    }

    /// Returns the target at a position; arrows and bases come before the body, which they may cover, and a base before the
    /// shaft that begins at it.
    fn take(targets: &HitTargets<'_>, at: Pos2) -> Held {
        let base = arrow::nearest(targets.bases, base::NEAR, |base| base.at.distance(at));
        if let Some(arrow) = arrow::under(targets.arrows, at, base.is_none()) {
            let drag = Drag::default();
            return Held::Tip(Grip { arrow: *arrow, pressed: at, last: at, has_moved: false, drag });
        }
        let place = targets.place(at);
        let (nodes, outline) = (&targets.body.nodes, &targets.body.geometry.boundary);
        let near = NEAR / targets.camera.shown.scale;
        let point = targets.mesh().and_then(|mesh| mesh.pick(nodes, outline, place, near));
        if let Some(base) = base {
            return Held::Base(PressedBase { base: *base, pressed: at, point, dragged: None });
        }
        let Some(point) = point else { return Held::Space };
        match targets.offset(point, place) {
            Some(offset) if targets.interactivity == Interactivity::Grabbable => {
                Held::Body(PressedPoint { point, offset, grabs: false })
            }
            _ => Held::Point(point),
        }
    }

    /// Moves the pressed target with the pointer.
    fn drag(&mut self, targets: &HitTargets<'_>, (at, keys): (Pos2, Modifiers), interaction: &mut Interaction) {
        match &mut self.held {
            Held::Tip(grip) => {
                grip.drag_to(at, keys.alt || keys.ctrl);
                interaction.load = grip.drag().map(|drag| (grip.arrow.load, grip.arrow.dragged(drag, keys.shift)));
            }
            Held::Base(held) => {
                let has_left = f64::from(held.pressed.distance(at)) > DRAG_DISTANCE;
                if has_left || held.dragged.is_some() {
                    held.dragged = Some(at);
                    // The body does not depend on its cuts, whose forces follow the pointer.
                    let is_cut = matches!(held.base.object, Object::Section(_) | Object::SectionEnd(..));
                    interaction.dropped = is_cut.then_some((held.base.object, at));
                }
            }
            Held::Body(press) if targets.interactivity == Interactivity::Grabbable => {
                let place = targets.place(at);
                if !press.grabs {
                    // In a motion, the body can also move away from a pointer that stands still.
                    let moved = targets.offset(press.point, place).map_or(0.0, |offset| (offset - press.offset).norm());
                    press.grabs = moved * targets.camera.shown.scale > DRAG_DISTANCE;
                    interaction.grab.start = press.grabs.then_some(press.point);
                }
                interaction.grab.target = press.grabs.then_some(place);
            }
            Held::Body(_) | Held::Point(_) | Held::Space | Held::Nothing => {}
        }
    }

    /// Finds the target under the pointer, and sets the cursor.
    fn hover(&mut self, ui: &Ui, targets: &HitTargets<'_>, down: bool) {
        let hovered = targets.response.hover_pos().filter(|_| self.held == Held::Nothing && !down);
        self.over = hovered.map_or(Held::Nothing, |at| Self::take(targets, at));
        let cursor = match (self.held, self.over) {
            (Held::Tip(_), _) | (_, Held::Tip(_) | Held::Base(_)) => Some(CursorIcon::Move),
            (Held::Body(_) | Held::Base(_), _) => Some(CursorIcon::Grabbing),
            (Held::Point(_) | Held::Space, _) => Some(CursorIcon::AllScroll),
            (_, Held::Body(_)) => Some(CursorIcon::Grab),
            (_, Held::Point(_)) if targets.interactivity == Interactivity::None => Some(CursorIcon::Crosshair),
            (_, Held::Point(_) | Held::Space) => Some(CursorIcon::Default),
            (Held::Nothing, Held::Nothing) => None,
        };
        if let Some(cursor) = cursor {
            ui.set_cursor_icon(cursor);
        }
    }

    /// Moves and zooms the view.
    fn move_camera(&mut self, ui: &Ui, targets: &HitTargets<'_>, fingers: Option<Vec2>) -> Option<CameraMove> {
        let (response, mut camera) = (targets.response, targets.camera.shown);
        let mut look = None;
        // Two fingers move the view, whatever is under them.
        // A click whose pointer moves by a few points does not move the view.
        let is_drag = ui.input(|i| i.pointer.is_decidedly_dragging());
        let drag = fingers.unwrap_or(if is_drag { response.drag_delta() } else { Vec2::ZERO });
        if drag != Vec2::ZERO && !self.holds() {
            camera.pan([f64::from(drag.x), f64::from(drag.y)]);
            look = Some(CameraMove::To(camera));
        }
        let is_zoom = |event: &Event| matches!(event, Event::MouseWheel { .. } | Event::Zoom(_));
        if ui.input(|i| i.events.iter().any(is_zoom)) {
            self.scrolls = response.hover_pos().is_some();
        }
        if let Some(pointer) = response.hover_pos().filter(|_| self.scrolls || fingers.is_some()) {
            let (scroll, pinch) = ui.input(|i| (i.smooth_scroll_delta().y, i.zoom_delta()));
            let factor = f64::from(pinch) * (f64::from(scroll) * 0.004).exp();
            // A resting pointer must not stop the view from following the body.
            if factor != 1.0 {
                let at = pointer - response.rect.center();
                let size = response.rect.size();
                let scales = targets.camera.scales([f64::from(size.x), f64::from(size.y)]);
                camera.zoom(factor, [f64::from(at.x), f64::from(at.y)], scales);
                look = Some(CameraMove::To(camera));
            }
        }
        look
    }
}
