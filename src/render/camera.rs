//! Camera: conversion between metres of the plane and points of a view.

use std::ops::RangeInclusive;

use nalgebra::Vector2;

/// Camera with a centre and a magnification.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Point of the plane in the middle of the view, m.
    pub center: Vector2<f64>,
    /// Magnification, points of the view per metre.
    pub scale: f64,
}

/// Space kept free around a fitted box, points.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Margins {
    /// Left and right.
    pub sides: f64,
    /// Above.
    pub top: f64,
    /// Below.
    pub bottom: f64,
}

impl Camera {
    /// Range of useful magnifications, points per metre.
    const SCALES: RangeInclusive<f64> = 1e-9..=1e12;

    /// Returns the camera that fits the box from `low` to `high`, m, into a view of size `view`, points, inside the
    /// margins. In a small view the margins shrink.
    pub fn fit(low: Vector2<f64>, high: Vector2<f64>, view: [f64; 2], margins: Margins) -> Self {
        /// Largest fraction of a view that margins may take.
        const LARGEST: f64 = 0.7;
        let extent = (high - low).map(|v| v.max(1e-12));
        let shrink = |total: f64, view: f64| (LARGEST * view / total.max(1e-9)).min(1.0);
        let across = shrink(2.0 * margins.sides, view[0]);
        let down = shrink(margins.top + margins.bottom, view[1]);
        let room = [
            (view[0] - across * 2.0 * margins.sides).max(1.0),
            (view[1] - down * (margins.top + margins.bottom)).max(1.0),
        ];
        let scale = (room[0] / extent.x).min(room[1] / extent.y).clamp(*Self::SCALES.start(), *Self::SCALES.end());
        let lift = Vector2::new(0.0, 0.5 * down * (margins.bottom - margins.top) / scale);
        Self { center: (low + high) * 0.5 - lift, scale }
    }

    /// Returns the view position of a point of the plane, in points to the right of and below the middle of the view.
    pub fn to_view(&self, p: Vector2<f64>) -> [f64; 2] {
        let d = (p - self.center) * self.scale;
        [d.x, -d.y]
    }

    /// Returns the point of the plane at a view position, in points to the right of and below the middle of the view.
    pub fn to_world(&self, at: [f64; 2]) -> Vector2<f64> {
        self.center + Vector2::new(at[0], -at[1]) / self.scale
    }

    /// Moves the visible part of the plane by this many points to the right and down.
    pub fn pan(&mut self, by: [f64; 2]) {
        self.center -= Vector2::new(by[0], -by[1]) / self.scale;
    }

    /// Magnifies by `factor`, within the range `scales`; the point of the plane at `at` stays in place.
    pub fn zoom(&mut self, factor: f64, at: [f64; 2], scales: RangeInclusive<f64>) {
        let fixed = self.to_world(at);
        // A magnification outside the range may stay, but moves no further outside.
        let (low, high) = (scales.start().min(self.scale), scales.end().max(self.scale));
        let scale = (self.scale * factor).max(low).min(high);
        self.center = fixed + (self.center - fixed) * (self.scale / scale);
        self.scale = scale;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn zoom_keeps_the_point_under_the_pointer() {
        let mut camera = Camera { center: Vector2::new(3.0, -1.0), scale: 50.0 };
        let at = [120.0, -35.0];
        let before = camera.to_world(at);
        camera.zoom(1.7, at, 1.0..=1e3);
        assert!((camera.to_world(at) - before).norm() < 1e-12);
        assert!((camera.scale - 85.0).abs() < 1e-12);
    }

    #[test]
    fn fit_shows_the_whole_box() {
        let (low, high) = (Vector2::new(-1.0, -2.0), Vector2::new(9.0, 3.0));
        let camera = Camera::fit(low, high, [800.0, 300.0], Margins { sides: 20.0, top: 10.0, bottom: 50.0 });
        for corner in [low, high, Vector2::new(low.x, high.y), Vector2::new(high.x, low.y)] {
            let [x, y] = camera.to_view(corner);
            assert!(x.abs() <= 380.0 + 1e-9 && (-140.0 - 1e-9..=100.0 + 1e-9).contains(&y), "{corner} at {x}, {y}");
        }
    }

    #[test]
    fn an_empty_view_or_box_gives_a_finite_camera() {
        let point = Vector2::new(1.0, 1.0);
        let camera = Camera::fit(point, point, [0.0, 0.0], Margins { sides: 40.0, top: 40.0, bottom: 40.0 });
        assert!(camera.scale.is_finite() && camera.scale > 0.0);
    }
}
