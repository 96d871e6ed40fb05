//! Handles of the loads that a press can grab: the tip of a force arrow, or the end of a moment arrow.

use egui::{Color32, Painter, Pos2, Vec2};

use crate::app::viewport::arrow::{Arrow, ForceArrows, NEAR, is_seen, point_of_application};
use crate::app::viewport::moment_arrow::{MomentArrow, moment_range};
use crate::app::viewport::projection::Projection;
use crate::scene::{Load, Place};

/// Handle at the end of a load's arrow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Handle {
    Force(Arrow),
    Moment(MomentArrow),
}

/// New value of a load whose handle is dragged.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Pull {
    /// Magnitude, N, and direction, degrees.
    Force(f64, f64),
    /// Moment, N m.
    Moment(f64),
}

/// Displacement of a handle since it was grabbed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Drag {
    /// Displacement, points.
    by: Vec2,
    /// Rotation about the centre of a moment arrow, rad, counter-clockwise.
    angle: f64,
}

/// Handle under the pointer, or grabbed by it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct HotHandle {
    pub handle: Handle,
    /// Displacement since it was grabbed.
    pub dragged: Option<Drag>,
}

impl Handle {
    /// Returns the index of the load among the scene's loads.
    pub(crate) fn load(&self) -> usize {
        match self {
            Self::Force(arrow) => arrow.load,
            Self::Moment(arrow) => arrow.load,
        }
    }

    pub(crate) fn tip(&self) -> Pos2 {
        match self {
            Self::Force(arrow) => arrow.tip(),
            Self::Moment(arrow) => arrow.tip(),
        }
    }

    /// Returns the point where a force arrow begins, or the centre of a moment arrow.
    pub(crate) fn foot(&self) -> Pos2 {
        match self {
            Self::Force(arrow) => arrow.from,
            Self::Moment(arrow) => arrow.center,
        }
    }

    /// Returns the new value of the load after a drag.
    fn pull(&self, drag: Drag, snap: bool) -> Pull {
        match self {
            Self::Force(arrow) => {
                let (magnitude, degrees) = arrow.dragged(drag.by, snap);
                Pull::Force(magnitude, degrees)
            }
            Self::Moment(arrow) => Pull::Moment(arrow.dragged(drag.angle, snap)),
        }
    }

    /// Paints the dragged arrow at the position where it was grabbed.
    pub(crate) fn paint(&self, painter: &Painter, drag: Drag, color: Color32) {
        match self {
            Self::Force(arrow) => arrow.paint_handle(painter, drag.by, color),
            Self::Moment(arrow) => arrow.paint_handle(painter, drag.angle, color),
        }
    }
}

/// Returns the handle that a press at `pointer` grabs.
pub(crate) fn at(handles: &[Handle], pointer: Pos2) -> Option<&Handle> {
    nearest(handles, NEAR, |handle| handle.tip().distance(pointer))
}

/// Returns the handle of the force arrow whose shaft a press at `pointer` grabs.
pub(crate) fn of_shaft(handles: &[Handle], pointer: Pos2) -> Option<&Handle> {
    /// Distance from a shaft within which a press grabs it, points.
    const NEAR: f32 = 5.0;
    nearest(handles, NEAR, |handle| match handle {
        Handle::Force(Arrow { from, vector, .. }) => {
            let along = ((pointer - *from).dot(*vector) / vector.length_sq()).clamp(0.0, 1.0);
            pointer.distance(*from + along * *vector)
        }
        Handle::Moment(_) => f32::INFINITY,
    })
}

/// Returns the item at the smallest distance from the pointer, if it is at most `near`, points.
pub(crate) fn nearest<T>(items: &[T], near: f32, distance: impl Fn(&T) -> f32) -> Option<&T> {
    let near = items.iter().map(|item| (distance(item), item)).filter(|(d, _)| *d <= near);
    near.min_by(|(a, _), (b, _)| a.total_cmp(b)).map(|(_, item)| item)
}

/// Grabbed handle, and the pointer's movement since then.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Grip {
    pub handle: Handle,
    pressed: Pos2,
    last: Pos2,
    /// `true` once the pointer has left the place of the press; a return to it restores the load.
    has_moved: bool,
    /// Displacement of the handle, points: smaller than the pointer's in slow mode.
    by: Vec2,
    angle: f64,
}

impl Grip {
    /// Grabs `handle` with a press at `pressed`.
    pub(crate) fn new(handle: Handle, pressed: Pos2) -> Self {
        Self { handle, pressed, last: pressed, has_moved: false, by: Vec2::ZERO, angle: 0.0 }
    }

    /// Moves the handle with the pointer, which is now at `at`; by a tenth of the distance if `slow`.
    pub(crate) fn drag_to(&mut self, at: Pos2, slow: bool) {
        const SLOW: f32 = 0.1;
        /// Movements of less than this, points, do not count as a drag.
        const STILL: f32 = 2.0;
        let part = if slow { SLOW } else { 1.0 };
        self.by += part * (at - self.last);
        if let Handle::Moment(arrow) = self.handle {
            self.angle += f64::from(part) * arrow.angle_between(self.last, at);
        }
        self.last = at;
        self.has_moved |= at.distance(self.pressed) >= STILL;
    }

    /// Returns the displacement of the handle; `None` if it has not moved.
    pub(crate) fn drag(&self) -> Option<Drag> {
        self.has_moved.then_some(Drag { by: self.by, angle: self.angle })
    }

    /// Returns the new value of the load, if the handle has been dragged.
    pub(crate) fn pull(&self, snap: bool) -> Option<Pull> {
        Some(self.handle.pull(self.drag()?, snap))
    }
}

impl ForceArrows<'_> {
    /// Returns the circular arrows of all moments that act at the current time.
    pub(crate) fn moment_arrows(&self, projection: &Projection) -> Vec<MomentArrow> {
        let mesh = self.system.mesh();
        let [usual, _] = moment_range(self.opening, &self.scene.material, self.system);
        let shown = self.scene.loads.iter().enumerate().filter(|(_, load)| is_seen(load, self.time));
        let moment_arrows = shown.filter_map(|(load, of)| {
            let Load::Moment { edge, moment, .. } = of else { return None };
            let edge = Place::from(edge.as_str());
            let center = point_of_application(mesh, self.positions, &edge, false)?;
            let center = projection.point(center);
            center.is_finite().then(|| MomentArrow::new(load, center, *moment, usual))
        });
        moment_arrows.collect()
    }

    /// Returns the handles of all loads that act at the current time.
    pub(crate) fn handles(&self, projection: &Projection) -> Vec<Handle> {
        let arrows = self.arrows(projection).into_iter().map(Handle::Force);
        arrows.chain(self.moment_arrows(projection).into_iter().map(Handle::Moment)).collect()
    }
}
