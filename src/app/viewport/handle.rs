//! What a press can take of the loads: the tip of a force's arrow, or the end of a moment's.

use egui::{Color32, Painter, Pos2, Vec2};

use crate::app::viewport::arrow::{Arrow, Forces, NEAR, is_seen, load_point};
use crate::app::viewport::moment_arrow::{Turn, moment_range};
use crate::app::viewport::projection::Projection;
use crate::scene::{Load, Place};

/// The end of a load's arrow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Handle {
    Force(Arrow),
    Moment(Turn),
}

/// What a dragged handle asks of its load.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Pull {
    /// Magnitude, N, and direction, degrees.
    Force(f64, f64),
    /// N m.
    Moment(f64),
}

/// How a handle has been dragged since it was taken.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Drag {
    /// Points.
    by: Vec2,
    /// About the middle of a moment's arrow, rad, counter-clockwise.
    turned: f64,
}

/// A handle that the pointer is on, or has taken.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct HotHandle {
    pub handle: Handle,
    /// Where it has been dragged since it was taken.
    pub dragged: Option<Drag>,
}

impl Handle {
    /// The load's number among the scene's.
    pub(crate) fn load(&self) -> usize {
        match self {
            Self::Force(arrow) => arrow.load,
            Self::Moment(turn) => turn.load,
        }
    }

    pub(crate) fn tip(&self) -> Pos2 {
        match self {
            Self::Force(arrow) => arrow.tip(),
            Self::Moment(turn) => turn.tip(),
        }
    }

    /// Place that the arrow begins at, or goes round.
    pub(crate) fn foot(&self) -> Pos2 {
        match self {
            Self::Force(arrow) => arrow.from,
            Self::Moment(turn) => turn.center,
        }
    }

    /// What the load is to be after a drag.
    fn pull(&self, drag: Drag, snap: bool) -> Pull {
        match self {
            Self::Force(arrow) => {
                let (magnitude, degrees) = arrow.dragged(drag.by, snap);
                Pull::Force(magnitude, degrees)
            }
            Self::Moment(turn) => Pull::Moment(turn.dragged(drag.turned, snap)),
        }
    }

    /// Paints, where it was when it was taken, what the pointer has made of it.
    pub(crate) fn paint(&self, painter: &Painter, drag: Drag, color: Color32) {
        match self {
            Self::Force(arrow) => arrow.paint_handle(painter, drag.by, color),
            Self::Moment(turn) => turn.paint_handle(painter, drag.turned, color),
        }
    }
}

/// The handle that a press here takes hold of.
pub(crate) fn at(handles: &[Handle], pointer: Pos2) -> Option<&Handle> {
    let near = handles.iter().map(|handle| (handle.tip().distance(pointer), handle)).filter(|(d, _)| *d <= NEAR);
    near.min_by(|(a, _), (b, _)| a.total_cmp(b)).map(|(_, handle)| handle)
}

/// A handle that was taken, and the pointer's way since.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Grip {
    pub handle: Handle,
    pressed: Pos2,
    last: Pos2,
    /// Way of the handle, points: shorter than that of the pointer while it is slow.
    by: Vec2,
    turned: f64,
}

impl Grip {
    /// Taken here.
    pub(crate) fn new(handle: Handle, pressed: Pos2) -> Self {
        Self { handle, pressed, last: pressed, by: Vec2::ZERO, turned: 0.0 }
    }

    /// Moves it with the pointer, which is here now; a tenth of the way where it is `slow`.
    pub(crate) fn follow(&mut self, at: Pos2, slow: bool) {
        const SLOW: f32 = 0.1;
        let part = if slow { SLOW } else { 1.0 };
        self.by += part * (at - self.last);
        if let Handle::Moment(turn) = self.handle {
            self.turned += f64::from(part) * turn.angle_between(self.last, at);
        }
        self.last = at;
    }

    /// How it has been dragged; `None` where it has not moved.
    pub(crate) fn drag(&self) -> Option<Drag> {
        /// What has moved less than this, points, has not been dragged.
        const STILL: f32 = 2.0;
        let way = self.last - self.pressed;
        (way.length() >= STILL).then_some(Drag { by: self.by, turned: self.turned })
    }

    /// What the load is to be, where the handle has been dragged.
    pub(crate) fn pull(&self, snap: bool) -> Option<Pull> {
        Some(self.handle.pull(self.drag()?, snap))
    }
}

impl Forces<'_> {
    /// The circular arrows of all moments that act at the present time.
    pub(crate) fn turns(&self, projection: &Projection) -> Vec<Turn> {
        let mesh = self.system.mesh();
        let [usual, _] = moment_range(self.opening, &self.scene.material, self.system);
        let shown = self.scene.loads.iter().enumerate().filter(|(_, load)| is_seen(load, self.time));
        let turns = shown.filter_map(|(load, of)| {
            let Load::Moment { edge, moment, .. } = of else { return None };
            let center = projection.point(load_point(mesh, self.positions, &Place::from(edge.as_str()))?);
            center.is_finite().then(|| Turn::new(load, center, *moment, usual))
        });
        turns.collect()
    }

    /// What can be taken of them.
    pub(crate) fn handles(&self, projection: &Projection) -> Vec<Handle> {
        let arrows = self.arrows(projection).into_iter().map(Handle::Force);
        arrows.chain(self.turns(projection).into_iter().map(Handle::Moment)).collect()
    }
}
