//! Camera controller: the camera fits the whole body, with smooth transitions, or stays where the user has moved it.

use crate::app::interface::*;

/// Lowest and highest corner of a box, m.
pub(crate) type Box2 = [Vector2<f64>; 2];

/// Time constant of the camera animation, s.
const EASE: f64 = 0.11;
/// The animation stops within this distance of its target, points.
const THERE: f64 = 0.3;
/// Smallest and largest magnification relative to the one that fits the body at rest.
const ZOOM: [f64; 2] = [0.02, 2e4];

/// Largest room for the arrows of loads on a side, relative to the view: the body keeps half of it.
pub(crate) const ARROW_ROOM: f64 = 0.25;

/// Returns the smallest box that contains a box and a point.
pub(crate) fn grow([low, high]: Box2, point: &Vector2<f64>) -> Box2 {
    [low.inf(point), high.sup(point)]
}

/// Returns a box that also contains the points of linear theory, unless it would be much larger: the other bodies would be
/// shown too small then.
pub(crate) fn grow_to_linear(whole: Box2, linear: impl Iterator<Item = Vector2<f64>>) -> Box2 {
    /// Largest size of the box with these points, relative to the box without them.
    const LARGEST: f64 = 1.5;
    let size_of = |[low, high]: Box2| (high - low).norm();
    let with = linear.fold(whole, |with, point| grow(with, &point));
    if size_of(with) < LARGEST * size_of(whole) { with } else { whole }
}

/// Movement of the camera by the pointer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum CameraMove {
    To(Camera),
    /// Return to the camera that fits the whole body.
    Fit,
}

/// Camera of a view, and the target of its animation.
#[derive(Clone, Debug)]
pub(crate) struct CameraController {
    /// Camera set by the user; `None` means fit to the body.
    pub own: Option<Camera>,
    /// Box that the camera fits, m.
    pub whole: Box2,
    /// Box of the body at rest, m.
    rest: Box2,
    /// Current camera.
    pub shown: Camera,
    /// `true` until the first frame of a body, which is shown without animation.
    is_new: bool,
}

impl CameraController {
    /// Creates the camera of a body with the rest box `rest`, m.
    pub(crate) fn new(rest: Box2) -> Self {
        let camera = Camera { center: (rest[0] + rest[1]) * 0.5, scale: 1.0 };
        Self { own: None, whole: rest, rest, shown: camera, is_new: true }
    }

    /// Changes to a body with the rest box `rest`, m. A camera set by the user is kept.
    pub(crate) fn set_body(&mut self, rest: Box2) {
        (self.rest, self.whole) = (rest, rest);
    }

    /// Sets the box that the camera fits, m; boxes that are not finite are ignored. To be called for converged states
    /// and motions only.
    pub(crate) fn set_whole(&mut self, whole: Box2) {
        let sound = |p: &Vector2<f64>| p.x.is_finite() && p.y.is_finite();
        if whole.iter().all(sound) {
            self.whole = whole;
        }
    }

    /// Jumps to `camera` without animation, so that dragging does not lag.
    pub(crate) fn set_camera(&mut self, camera: Camera) {
        self.own = Some(camera);
        self.shown = camera;
        self.is_new = false;
    }

    /// Moves the camera as the pointer has asked for.
    pub(crate) fn follow(&mut self, pointer: Option<CameraMove>) {
        match pointer {
            Some(CameraMove::To(camera)) => self.set_camera(camera),
            Some(CameraMove::Fit) => self.own = None,
            None => {}
        }
    }

    /// Returns the range of useful magnifications in a view of size `view`, points.
    pub(crate) fn scales(&self, view: [f64; 2]) -> std::ops::RangeInclusive<f64> {
        let home = Camera::fit(self.rest[0], self.rest[1], view, Margins::default()).scale;
        ZOOM[0] * home..=ZOOM[1] * home
    }

    /// Turns to `fitted`, which shows [`Self::whole`], in this frame of the view. While a load is dragged (`drags`) it jumps
    /// there and never zooms in, so that the arrow stays under the pointer and in the view; else it moves there if it `eases`.
    pub(crate) fn turn_to(&mut self, ui: &Ui, mut fitted: Camera, eases: bool, drags: bool) {
        if drags {
            fitted.scale = fitted.scale.min(self.shown.scale);
        }
        let dt = f64::from(ui.input(|i| i.stable_dt));
        if self.aim(fitted, (eases && !drags).then_some(dt)) {
            ui.ctx().request_repaint();
        }
    }

    /// Advances the animation by one frame of `dt` s: towards `fitted`, which shows [`Self::whole`], or towards the
    /// camera set by the user. Without `dt` it jumps there. Returns `true` while the animation is in progress.
    fn aim(&mut self, fitted: Camera, dt: Option<f64>) -> bool {
        let goal = self.own.unwrap_or(fitted);
        let (Some(dt), false) = (dt, self.is_new) else {
            self.shown = goal;
            self.is_new = false;
            return false;
        };
        let part = 1.0 - (-dt.max(0.0) / EASE).exp();
        // Magnifications are interpolated geometrically.
        let ratio = (goal.scale / self.shown.scale).powf(part);
        self.shown.scale *= ratio;
        self.shown.center += (goal.center - self.shown.center) * part;
        let missing = (goal.center - self.shown.center).norm() * goal.scale.max(self.shown.scale);
        let stretched = (goal.scale / self.shown.scale).ln().abs() * 1e3;
        let there = missing < THERE && stretched < THERE;
        if there || !(missing + stretched).is_finite() {
            self.shown = goal;
        }
        !there
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const REST: Box2 = [Vector2::new(0.0, -0.5), Vector2::new(10.0, 0.5)];
    const VIEW: [f64; 2] = [800.0, 600.0];

    fn fitted(controller: &CameraController) -> Camera {
        let [low, high] = controller.whole;
        Camera::fit(low, high, VIEW, Margins::default())
    }

    #[test]
    fn the_first_camera_is_set_at_once_and_later_ones_ease() {
        let mut controller = CameraController::new(REST);
        assert!(!controller.aim(fitted(&controller), Some(0.016)));
        let first = controller.shown;
        assert_eq!(first, fitted(&controller));
        controller.set_whole([Vector2::new(0.0, -8.0), Vector2::new(10.0, 0.5)]);
        let goal = fitted(&controller);
        let distance = |camera: Camera| (camera.center - goal.center).norm();
        let mut last = distance(first);
        let mut frames = 0;
        while controller.aim(goal, Some(0.016)) {
            assert!(distance(controller.shown) < last, "it does not come nearer");
            let scale = controller.shown.scale;
            assert!(scale >= goal.scale.min(first.scale) && scale <= goal.scale.max(first.scale), "it overshoots");
            last = distance(controller.shown);
            frames += 1;
        }
        assert_eq!(controller.shown, goal);
        assert!((10..200).contains(&frames), "{frames} frames");
    }

    /// The position after a given time does not depend on the number of frames.
    #[test]
    fn the_path_of_the_camera_depends_on_time_and_not_on_frames() {
        let after = |frames: u32| {
            let mut controller = CameraController::new(REST);
            controller.aim(fitted(&controller), None);
            controller.set_whole([Vector2::new(-50.0, -20.0), Vector2::new(60.0, 30.0)]);
            for _ in 0..frames {
                controller.aim(fitted(&controller), Some(0.12 / f64::from(frames)));
            }
            controller.shown
        };
        let (one, many) = (after(1), after(40));
        assert!((one.scale / many.scale - 1.0).abs() < 1e-9 && (one.center - many.center).norm() < 1e-9);
    }

    #[test]
    fn a_moved_view_stays_until_it_is_fitted_again() {
        let mut controller = CameraController::new(REST);
        controller.aim(fitted(&controller), None);
        let own = Camera { center: Vector2::new(3.0, 1.0), scale: 200.0 };
        controller.set_camera(own);
        controller.set_whole([Vector2::new(0.0, -30.0), Vector2::new(10.0, 0.5)]);
        assert!(!controller.aim(fitted(&controller), Some(0.016)));
        assert_eq!(controller.shown, own);
        controller.own = None;
        assert!(controller.aim(fitted(&controller), Some(0.016)));
        assert_ne!(controller.shown, own);
    }

    #[test]
    fn zoom_is_bounded_by_the_size_of_the_body() {
        let controller = CameraController::new(REST);
        let scales = controller.scales(VIEW);
        let mut camera = fitted(&controller);
        for _ in 0..1000 {
            camera.zoom(1.5, [10.0, 10.0], scales.clone());
        }
        assert!(camera.scale <= *scales.end() && camera.scale.is_finite());
        (0..1000).for_each(|_| camera.zoom(0.5, [10.0, 10.0], scales.clone()));
        assert!(camera.scale * 10.0 >= 10.0, "the body of 10 m is {} points", camera.scale * 10.0);
    }

    #[test]
    fn a_state_that_is_not_finite_is_not_followed() {
        let mut controller = CameraController::new(REST);
        controller.set_whole([Vector2::new(f64::NAN, 0.0), Vector2::new(1.0, 1.0)]);
        assert_eq!(controller.whole, REST);
    }
}
