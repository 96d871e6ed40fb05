//! Scale between a load and the length of its arrow or the position on its slider: proportional around the opening
//! value, which is the value in the scene as opened, and logarithmic far beyond it.

/// Monotone, continuous map from the magnitude of a load to a length, in points, radians or fractions of a slider.
///
/// Let x be the load divided by its opening value. The map is a parabola from the stub length at x = 0 to the opening
/// length at x = 1, where its tangent passes through the origin; this tangent up to x = `straight`, so that an arrow of
/// twice the length is twice the load; and a logarithm beyond.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LoadScale {
    /// Opening value: the load that has the opening length.
    pub usual: f64,
    /// Length of a zero load.
    pub stub: f64,
    /// Length of the opening value.
    pub opening: f64,
    /// Ratio of a load to its opening value above which lengths are logarithmic.
    pub straight: f64,
    /// Additional length per factor of ten above it.
    pub decade: f64,
}

/// Ratio of a load to its opening value above which sliders and the arrows of moments are logarithmic.
pub(crate) const STRAIGHT: f64 = 2.0;

impl LoadScale {
    pub(crate) fn length(self, load: f64) -> f64 {
        let x = load / self.usual;
        if x <= 1.0 {
            self.stub + x * (self.opening - 2.0 * self.stub + self.stub * x)
        } else if x <= self.straight {
            self.opening * x
        } else {
            self.opening * self.straight + self.decade * (x / self.straight).log10()
        }
    }

    pub(crate) fn load(self, length: f64) -> f64 {
        let x = if length <= self.stub {
            0.0
        } else if length <= self.opening {
            // The positive root of stub x² + b x = c, in the form without cancellation.
            let (b, c) = (self.opening - 2.0 * self.stub, length - self.stub);
            2.0 * c / (b + (b * b + 4.0 * self.stub * c).sqrt())
        } else if length <= self.straight * self.opening {
            length / self.opening
        } else {
            self.straight * 10f64.powf((length - self.straight * self.opening) / self.decade)
        };
        x * self.usual
    }

    /// Returns the scale of an arrow whose length is proportional to the load up to three times the opening value, and
    /// logarithmic beyond with the same slope there, so that no pixel of a drag is worth much more than the one before.
    pub(crate) fn smooth(usual: f64, opening: f64) -> Self {
        const STRAIGHT: f64 = 3.0;
        Self { usual, stub: 0.0, opening, straight: STRAIGHT, decade: STRAIGHT * opening * std::f64::consts::LN_10 }
    }

    /// Returns the scale of a slider from 0 to 1 whose upper end is `largest`, or of one from −1 to 1 with the ends
    /// ∓`largest` if it `is_two_sided`. The opening value is in the middle third of the whole slider.
    pub(crate) fn slider(usual: f64, largest: f64, is_two_sided: bool) -> Self {
        /// Smallest number of decades of the logarithmic part.
        const MIN_DECADES: f64 = 0.3;
        let opening = if is_two_sided { 0.3 } else { 0.4 };
        let decades = (largest / (STRAIGHT * usual)).log10().max(MIN_DECADES);
        let decade = (1.0 - STRAIGHT * opening) / decades;
        Self { usual, stub: 0.0, opening, straight: STRAIGHT, decade }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SCALES: [LoadScale; 3] = [
        LoadScale { usual: 3e4, stub: 0.0, opening: 72.0, straight: 3.0, decade: 500.0 },
        LoadScale { usual: 2e-3, stub: 0.5, opening: 2.4, straight: STRAIGHT, decade: 1.6 },
        LoadScale { usual: 700.0, stub: 0.0, opening: 0.4, straight: STRAIGHT, decade: 0.1 },
    ];

    /// The force under the tip of an arrow grows evenly, from one pixel to the next.
    #[test]
    fn no_pixel_of_a_smooth_scale_is_worth_much_more_than_the_one_before() {
        for opening in [50.0, 72.0] {
            let scale = LoadScale::smooth(3e4, opening);
            let step = |pixel: u32| scale.load(f64::from(pixel)) - scale.load(f64::from(pixel) - 1.0);
            for pixel in 2..=400 {
                let ratio = step(pixel) / step(pixel - 1);
                assert!(ratio > 0.999 && ratio < 1.5, "{opening}: {ratio} at {pixel}");
            }
        }
        // 100 points beyond the tip of the article's arrow.
        let load = LoadScale::smooth(3e4, 72.0).load(172.0);
        assert!((load - 72e3).abs() < 1e3, "{load}");
    }

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
            // The pieces are continuous.
            for x in [1.0, scale.straight] {
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
            // The slope is the same on both sides of the opening value.
            let rate = (scale.load(scale.opening) - scale.load(0.999 * scale.opening)) / (0.001 * scale.usual);
            assert!((rate - 1.0).abs() < 0.01, "{scale:?}: {rate}");
        }
    }

    #[test]
    fn a_slider_ends_at_the_largest_load_with_the_usual_one_in_the_middle_third() {
        for (usual, largest) in [(30e3, 1e6), (1.0, 1e5), (5.0, 10.0), (9.81, 1e3)] {
            let scale = LoadScale::slider(usual, largest, false);
            assert!((1.0 / 3.0..2.0 / 3.0).contains(&scale.length(usual)));
            assert!(scale.length(largest) <= 1.0 + 1e-12, "{usual} {largest}");
            let scale = LoadScale::slider(usual, largest, true);
            assert!(scale.length(usual) < 1.0 / 3.0 && scale.length(largest) <= 1.0 + 1e-12);
        }
        assert!((LoadScale::slider(30e3, 1e6, false).length(1e6) - 1.0).abs() < 1e-12);
    }
}
