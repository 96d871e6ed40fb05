//! Interaction of the pointer with the view. A drag of an arrow sets its load, a drag of the base of an
//! object moves it along the body, a drag of the body grabs it, and a drag of empty space moves the view. The wheel zooms about the pointer.

use egui::{CursorIcon, Modifiers, Pos2, Response, Ui, Vec2};
use nalgebra::Vector2;

use crate::app::session::Grab;
use crate::app::viewport::base::{self, Base, HotBase};
use crate::app::viewport::body_mesh::BodyMesh;
use crate::app::viewport::camera_controller::{CameraController, CameraMove};
use crate::app::viewport::handle::{self, Grip, Handle, HotHandle, Pull};
use crate::app::viewport::objects::Object;
use crate::app::viewport::probe;
use crate::app::viewport::projection::Projection;
use crate::assembly::System;
use crate::mesh::{MaterialPoint, Mesh};

/// Target of the current press.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
enum Held {
    /// No press, or one outside the view.
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

/// Base of an object that is pressed.
#[derive(Clone, Copy, Debug, PartialEq)]
struct PressedBase {
    base: Base,
    /// Position of the press.
    pressed: Pos2,
    /// Material point under the press.
    point: Option<MaterialPoint>,
    /// Position of the pointer once it has left the position of the press.
    dragged: Option<Pos2>,
}

/// State of the pointer: its hover target and the target of its press.
#[derive(Debug, Default)]
pub(crate) struct Pointer {
    held: Held,
    /// Load handle under a pointer that is not pressed.
    over_tip: Option<Handle>,
    /// Base of an object under a pointer that is not pressed.
    over_base: Option<Base>,
    /// Material point under a pointer that is not pressed.
    over_body: Option<MaterialPoint>,
    /// Position of the pointer.
    at: Option<Pos2>,
    /// `true` if the wheel was last turned over the view. Scrolling that began elsewhere does not zoom it.
    scrolls: bool,
}

/// Interaction of the pointer with the view in one frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Interaction {
    pub camera: CameraMove,
    pub grab: Grab,
    /// Index of a load, and its new value.
    pub load: Option<(usize, Pull)>,
    /// Index of a load that is reset to the value in the scene's document.
    pub restore: Option<usize>,
    /// Object whose base was dropped, or cut that is dragged, and the position there.
    pub dropped: Option<(Object, Pos2)>,
    /// Click in the view: on a point of the body, or `Some(None)` outside the body.
    pub clicked: Option<Option<MaterialPoint>>,
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
    /// Handles of the load arrows.
    pub handles: &'a [Handle],
    /// Bases of the objects that can be moved.
    pub bases: &'a [Base],
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

    /// Returns the handle that a press grabs; a base comes before the shaft that begins at it.
    fn handle(&self, at: Pos2) -> Option<Handle> {
        let of_shaft = || base::near(self.bases, at).is_none().then(|| handle::of_shaft(self.handles, at)).flatten();
        handle::at(self.handles, at).or_else(of_shaft).copied()
    }

    fn point(&self, place: Vector2<f64>) -> Option<MaterialPoint> {
        let outline = &self.body.geometry.boundary;
        self.mesh()?.pick(&self.body.nodes, outline, place, NEAR / self.camera.shown.scale)
    }
}

impl Pointer {
    /// Returns the load handle that is under the pointer or grabbed.
    pub(crate) fn hot_handle(&self) -> Option<HotHandle> {
        if let Held::Tip(grip) = self.held {
            return Some(HotHandle { handle: grip.handle, dragged: grip.drag() });
        }
        self.over_tip.map(|handle| HotHandle { handle, dragged: None })
    }

    /// Returns the base that is under the pointer or dragged.
    pub(crate) fn hot_base(&self) -> Option<HotBase> {
        if let Held::Base(held) = self.held {
            return Some(HotBase { base: held.base, dragged: held.dragged });
        }
        self.over_base.map(|base| HotBase { base, dragged: None })
    }

    /// Returns the material point under the pointer and the pointer's position, while nothing is pressed.
    pub(crate) fn over_body(&self) -> Option<(MaterialPoint, Pos2)> {
        self.over_body.zip(self.at)
    }

    /// Returns `true` if a load handle, a base or the body is held.
    pub(crate) fn holds(&self) -> bool {
        matches!(self.held, Held::Tip(..) | Held::Base(_) | Held::Body(_))
    }

    /// Returns `true` if the tip of an arrow is dragged: its load depends on the pointer alone, so that the view may move.
    pub(crate) fn drags_tip(&self) -> bool {
        matches!(self.held, Held::Tip(grip) if grip.drag().is_some())
    }

    /// Returns `true` if the body is grabbed.
    fn grabs(&self) -> bool {
        matches!(self.held, Held::Body(PressedPoint { grabs: true, .. }))
    }

    /// Processes the pointer over the view.
    pub(crate) fn process(&mut self, ui: &Ui, targets: &HitTargets<'_>) -> Interaction {
        let response = targets.response;
        let (pressed, origin, down, at, let_go_at, fingers, keys) = ui.input(|i| {
            let pointer = &i.pointer;
            let fingers = i.multi_touch().map(|touch| touch.translation_delta);
            let (pressed, down) = (pointer.primary_pressed(), pointer.primary_down());
            let let_go_at = i.events.iter().rev().find_map(|event| match event {
                egui::Event::PointerButton { pos, button: egui::PointerButton::Primary, pressed: false, .. } => {
                    Some(*pos)
                }
                _ => None,
            });
            (pressed, pointer.press_origin(), down, pointer.interact_pos(), let_go_at, fingers, i.modifiers)
        });
        self.at = at;
        let mut interaction = Interaction::default();
        // A quick click is pressed and released within one frame. Two fingers move the view and release the target of
        // the first one.
        let is_here = response.is_pointer_button_down_on() || response.clicked();
        if pressed && is_here && fingers.is_none() {
            // The pointer may have moved since the press.
            let at = origin.or(at);
            self.held = at.map_or(Held::Nothing, |at| Self::take(targets, at));
        }
        // The pointer may also have moved after the release.
        if let Some(at) = let_go_at.or(at) {
            self.drag(targets, (at, keys), &mut interaction);
        }
        if response.double_clicked() {
            match self.held {
                Held::Tip(grip) => interaction.restore = Some(grip.handle.load()),
                Held::Body(_) | Held::Point(_) | Held::Space => interaction.camera = CameraMove::Fit,
                Held::Base(_) | Held::Nothing => {}
            }
        } else if response.clicked() {
            match self.held {
                Held::Body(PressedPoint { point, .. }) | Held::Point(point) => interaction.clicked = Some(Some(point)),
                Held::Base(held) => interaction.clicked = held.point.map(Some),
                Held::Space => interaction.clicked = Some(None),
                Held::Tip(..) | Held::Nothing => {}
            }
        }
        if !down || fingers.is_some() {
            interaction.grab.release = self.grabs();
            // A click may also move by a few points.
            if let (Held::Base(PressedBase { base, dragged: Some(at), .. }), None, false) =
                (self.held, fingers, response.clicked())
            {
                interaction.dropped = Some((base.object, at));
            }
            self.held = Held::Nothing;
        }
        self.hover(ui, targets, down);
        if interaction.camera == CameraMove::None {
            interaction.camera = self.move_camera(ui, targets, fingers);
        }
        interaction
    }

    /// Returns the target of a press; load handles and bases come before the body, which they may cover.
    fn take(targets: &HitTargets<'_>, at: Pos2) -> Held {
        if let Some(handle) = targets.handle(at) {
            return Held::Tip(Grip::new(handle, at));
        }
        let place = targets.place(at);
        if let Some(base) = base::near(targets.bases, at) {
            return Held::Base(PressedBase { base: *base, pressed: at, point: targets.point(place), dragged: None });
        }
        let reached = targets.point(place).filter(|_| targets.interactivity != Interactivity::None);
        let Some(point) = reached else { return Held::Space };
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
                interaction.load = grip.pull(keys.shift).map(|pull| (grip.handle.load(), pull));
            }
            Held::Base(held) => {
                let has_left = f64::from(held.pressed.distance(at)) > DRAG_DISTANCE;
                if has_left || held.dragged.is_some() {
                    held.dragged = Some(at);
                    // The body does not depend on its cuts, whose forces follow the pointer.
                    let is_cut = matches!(held.base.object, Object::Section(_) | Object::SectionEnd { .. });
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
        (self.over_tip, self.over_base, self.over_body) = (None, None, None);
        let cursor = match self.held {
            Held::Tip(..) => Some(CursorIcon::Move),
            Held::Body(_) | Held::Base(_) => Some(CursorIcon::Grabbing),
            Held::Point(_) | Held::Space => Some(CursorIcon::AllScroll),
            Held::Nothing => targets.response.hover_pos().filter(|_| !down).map(|at| {
                self.over_tip = targets.handle(at);
                if self.over_tip.is_some() {
                    return CursorIcon::Move;
                }
                self.over_body = targets.point(targets.place(at));
                self.over_base = base::near(targets.bases, at).copied();
                if self.over_base.is_some() {
                    return CursorIcon::Move;
                }
                match (self.over_body, targets.interactivity) {
                    (Some(_), Interactivity::Grabbable) => CursorIcon::Grab,
                    (Some(_), Interactivity::None) => CursorIcon::Crosshair,
                    _ => CursorIcon::Default,
                }
            }),
        };
        if let Some(cursor) = cursor {
            ui.set_cursor_icon(cursor);
        }
    }

    /// Moves and zooms the view.
    fn move_camera(&mut self, ui: &Ui, targets: &HitTargets<'_>, fingers: Option<Vec2>) -> CameraMove {
        let (response, mut camera) = (targets.response, targets.camera.shown);
        let mut look = CameraMove::None;
        // Two fingers move the view, whatever is under them.
        // A click whose pointer moves by a few points does not move the view.
        let is_drag = ui.input(|i| i.pointer.is_decidedly_dragging());
        let drag = fingers.unwrap_or(if is_drag { response.drag_delta() } else { Vec2::ZERO });
        if drag != Vec2::ZERO && !self.holds() {
            camera.pan([f64::from(drag.x), f64::from(drag.y)]);
            look = CameraMove::To(camera);
        }
        let is_zoom_gesture = ui.input(|i| {
            i.events.iter().any(|event| matches!(event, egui::Event::MouseWheel { .. } | egui::Event::Zoom(_)))
        });
        if is_zoom_gesture {
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
                look = CameraMove::To(camera);
            }
        }
        look
    }
}
