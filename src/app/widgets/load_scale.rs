//! Scale between a load and the length of its arrow or the way of its slider: proportional around the value that the scene
//! opens with, logarithmic far beyond it.

use crate::scene::{Load, Scene};

/// The largest loads that a scene opens with. Its arrows have their opening length there.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct OpeningLoads {
    /// Largest force, N; `None` where the scene has none.
    pub force: Option<f64>,
    /// Largest moment, N m; `None` where the scene has none.
    pub moment: Option<f64>,
}

impl OpeningLoads {
    /// Finds the largest loads of a scene as it was opened.
    pub(crate) fn of(scene: &Scene) -> Self {
        let largest = |sizes: &mut dyn Iterator<Item = f64>| {
            let largest = sizes.fold(0.0, f64::max);
            (largest > 0.0 && largest.is_finite()).then_some(largest)
        };
        Self {
            force: largest(&mut scene.loads.iter().filter_map(|load| match load {
                Load::Force { force: [x, y], .. } => Some(x.hypot(*y)),
                _ => None,
            })),
            moment: largest(&mut scene.loads.iter().filter_map(|load| match load {
                Load::Moment { moment, .. } => Some(moment.abs()),
                _ => None,
            })),
        }
    }
}

/// Monotone, continuous map from the size of a load to a length, in points, radians or parts of a slider.
///
/// With x the load over its opening value: from the stub at x = 0 a parabola up to the opening length at x = 1, whose tangent
/// there goes through the origin; the tangent up to x = 2, so that an arrow of twice the length is twice the load; a
/// logarithm beyond.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LoadScale {
    /// Load that has the opening length.
    pub usual: f64,
    /// Length of no load.
    pub stub: f64,
    /// Length of the opening value.
    pub opening: f64,
    /// Length of a tenfold load, beyond twice the opening value.
    pub decade: f64,
}

/// Load over its opening value from which on lengths are logarithmic.
const STRAIGHT: f64 = 2.0;

impl LoadScale {
    /// Length of a load.
    pub(crate) fn length(self, load: f64) -> f64 {
        let x = load / self.usual;
        if x <= 1.0 {
            self.stub + x * (self.opening - 2.0 * self.stub + self.stub * x)
        } else if x <= STRAIGHT {
            self.opening * x
        } else {
            self.opening * STRAIGHT + self.decade * (x / STRAIGHT).log10()
        }
    }

    /// Load of a length.
    pub(crate) fn load(self, length: f64) -> f64 {
        let x = if length <= self.stub {
            0.0
        } else if length <= self.opening {
            // The root of stub x² + b x = c that is positive, in the form without cancellation.
            let (b, c) = (self.opening - 2.0 * self.stub, length - self.stub);
            2.0 * c / (b + (b * b + 4.0 * self.stub * c).sqrt())
        } else if length <= STRAIGHT * self.opening {
            length / self.opening
        } else {
            STRAIGHT * 10f64.powf((length - STRAIGHT * self.opening) / self.decade)
        };
        x * self.usual
    }

    /// Scale of a slider from 0 to 1 whose end is `largest`. The opening value is in the middle third.
    pub(crate) fn slider(usual: f64, largest: f64) -> Self {
        const OPENING: f64 = 0.4;
        /// Least decades of the logarithmic end.
        const LEAST: f64 = 0.3;
        let decades = (largest / (STRAIGHT * usual)).log10().max(LEAST);
        Self { usual, stub: 0.0, opening: OPENING, decade: (1.0 - STRAIGHT * OPENING) / decades }
    }

    /// Scale of a slider from −1 to 1 whose ends are ∓`largest`. The opening value is in the middle third.
    pub(crate) fn two_sided_slider(usual: f64, largest: f64) -> Self {
        const OPENING: f64 = 0.3;
        let one_sided = Self::slider(usual, largest);
        let rest = (1.0 - STRAIGHT * OPENING) / (1.0 - STRAIGHT * one_sided.opening);
        Self { opening: OPENING, decade: one_sided.decade * rest, ..one_sided }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SCALES: [LoadScale; 3] = [
        LoadScale { usual: 3e4, stub: 16.0, opening: 72.0, decade: 60.0 },
        LoadScale { usual: 2e-3, stub: 0.5, opening: 2.4, decade: 1.6 },
        LoadScale { usual: 700.0, stub: 0.0, opening: 0.4, decade: 0.1 },
    ];

    #[test]
    fn lengths_go_to_loads_and_back_and_grow() {
        for scale in SCALES {
            let mut before = -1.0;
            for i in -60..=60 {
                let load = scale.usual * 10f64.powf(f64::from(i) * 0.1);
                let length = scale.length(load);
                assert!(length > before, "{scale:?}: {load} {length}");
                before = length;
                assert!((scale.load(length) / load - 1.0).abs() < 1e-6, "{scale:?}: {load} {}", scale.load(length));
            }
            assert_eq!((scale.length(0.0), scale.load(scale.stub), scale.load(0.0)), (scale.stub, 0.0, 0.0));
            // No jump from piece to piece.
            for x in [1.0, STRAIGHT] {
                let [below, above] = [1.0 - 1e-9, 1.0 + 1e-9].map(|near| scale.length(near * x * scale.usual));
                assert!((above - below).abs() < 1e-6 * scale.opening, "{scale:?} at {x}");
            }
        }
    }

    #[test]
    fn twice_the_length_is_twice_the_load() {
        for scale in SCALES {
            assert!((scale.length(scale.usual) - scale.opening).abs() < 1e-12 * scale.opening);
            assert!((scale.load(2.0 * scale.opening) / scale.usual - 2.0).abs() < 1e-12);
            // The same rate just below.
            let rate = (scale.load(scale.opening) - scale.load(0.999 * scale.opening)) / (0.001 * scale.usual);
            assert!((rate - 1.0).abs() < 0.01, "{scale:?}: {rate}");
        }
    }

    #[test]
    fn a_slider_ends_at_the_largest_load_with_the_usual_one_in_the_middle_third() {
        for (usual, largest) in [(30e3, 1e6), (1.0, 1e5), (5.0, 10.0), (9.81, 1e3)] {
            let scale = LoadScale::slider(usual, largest);
            assert!((1.0 / 3.0..2.0 / 3.0).contains(&scale.length(usual)));
            assert!(scale.length(largest) <= 1.0 + 1e-12, "{usual} {largest}");
            let scale = LoadScale::two_sided_slider(usual, largest);
            assert!(scale.length(usual) < 1.0 / 3.0 && scale.length(largest) <= 1.0 + 1e-12);
        }
        assert!((LoadScale::slider(30e3, 1e6).length(1e6) - 1.0).abs() < 1e-12);
    }
}
