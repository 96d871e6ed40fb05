//! Limits of methods and elements as a drawing: the load curve above, and a strip for each method and element below it.

use super::axes::ChartAxis;
use super::drawing::{Anchor, DrawTarget, Drawing, KEY_BOX};
use crate::format::engineering;
use crate::scene::Scene;
use crate::sentence::sentence;
use crate::study::figure::{Ink, LoadAxis};
use crate::study::limits::{MethodLimits, Rating, Strip, load_text};
use crate::study::path_chart::Render;

/// Width by which bars overlap, so that no gap shows between those of one colour.
const OVERLAP: f64 = 0.5;
/// Colour of the slanted lines over a bar.
const HATCH: Ink = Ink::Fixed([0x33; 3]);

/// Draws the limits of a scene over the load.
pub fn limits(limits: &MethodLimits, scene: &Scene) -> Drawing {
    let (loads, curve) = (&LoadAxis::of(scene), [56.0, 216.0]);
    // A motion has no load curve.
    let has_curve = !limits.reference.is_empty();
    let (across, strips) = ([150.0, 760.0], 44.0 + curve[usize::from(has_curve)]);
    let chart = LimitsChart { limits, loads, across, curve, has_curve, strips, row: 26.0, height: 18.0 };
    let (bottom, mut drawing) = (chart.bottom(), Drawing::default());
    drawing.page([1060.0, bottom + 84.0], 20.0, &scene.name);
    chart.grid(&mut drawing);
    // The scene's own load.
    if limits.contains(1.0) {
        let own = chart.axis().place(1.0);
        drawing.line(&[[own, curve[0]], [own, bottom]], Ink::Text, 1.0, &[]);
        drawing.text([own, curve[0] - 6.0], Anchor::Middle, Ink::Text, "the scene");
    }
    chart.draw(&mut drawing, &ToString::to_string, &|_| Ink::Text);
    let (mut x, y) = (20.0, bottom + 46.0);
    for (ink, name) in Rating::ALL.map(|rating| rating.entry(limits.duration.is_some())) {
        x = drawing.key([x, y], (ink, &name.to_string()));
    }
    drawing.key([x, y], (Ink::Paper, "strains above 10 %, or inverted elements"));
    hatch(&mut drawing, [[x, y], [KEY_BOX; 2]], HATCH);
    chart.name(&mut drawing, 38.0, &ToString::to_string);
    drawing
}

/// Places of the limits in a drawing, all on one axis of loads.
pub(crate) struct LimitsChart<'a> {
    pub limits: &'a MethodLimits,
    pub loads: &'a LoadAxis,
    /// Left and right ends of the curve and the strips.
    pub across: [f64; 2],
    /// Upper and lower ends of the load curve.
    pub curve: [f64; 2],
    /// `true` if the load curve is drawn.
    pub has_curve: bool,
    /// Upper edge of the first strip.
    pub strips: f64,
    /// Distance from one strip to the next, and height of their bars.
    pub row: f64,
    pub height: f64,
}

impl LimitsChart<'_> {
    pub fn axis(&self) -> ChartAxis {
        ChartAxis::logarithmic(self.limits.range, self.across)
    }

    /// Returns the vertical axis of the curve; `None` if the curve is not drawn.
    pub fn up(&self) -> Option<ChartAxis> {
        let [top, bottom] = self.curve;
        let lengths = self.limits.reference.iter().filter_map(|(_, u)| u.map(|u| u.norm()));
        self.has_curve.then(|| ChartAxis::decades(lengths, [bottom, top]))
    }

    /// Returns the lower end of the strips.
    pub fn bottom(&self) -> f64 {
        self.strips + self.row * self.limits.strips.len() as f64
    }

    /// Draws the lines and numbers of the axis of loads.
    pub fn grid(&self, drawing: &mut dyn DrawTarget) {
        for (x, factor) in self.axis().ticks() {
            drawing.line(&[[x, self.curve[0]], [x, self.bottom()]], Ink::Grid, 1.0, &[]);
            drawing.text([x, self.bottom() + 18.0], Anchor::Middle, Ink::Text, &load_text(self.loads, factor));
        }
    }

    /// Draws the name of the axis of loads, this far below the strips.
    pub fn name(&self, drawing: &mut dyn DrawTarget, below: f64, render: Render<'_>) {
        let at = [0.5 * (self.across[0] + self.across[1]), self.bottom() + below];
        drawing.text(at, Anchor::Middle, Ink::Text, &render(&self.limits.axis_text(self.loads)));
    }

    /// Draws the critical load, the curve and the strips; `ink` returns the colour of a strip's name.
    pub fn draw(&self, drawing: &mut dyn DrawTarget, render: Render<'_>, ink: &dyn Fn(&Strip) -> Ink) {
        let (axis, [left, right]) = (self.axis(), self.across);
        if let Some(critical) = self.limits.critical().filter(|&critical| self.limits.contains(critical)) {
            let x = axis.place(critical);
            let (ink, _) = Rating::NotConverged.entry(false);
            drawing.line(&[[x, self.curve[0]], [x, self.bottom()]], ink, 1.5, &[6.0, 4.0]);
        }
        self.draw_curve(drawing, render);
        for (row, strip) in self.limits.strips.iter().enumerate() {
            let y = self.strips + self.row * row as f64;
            let base = y + 0.5 * self.height + 5.0;
            let name = strip.name(|id| render(&id.into()));
            drawing.text([left - 12.0, base], Anchor::End, ink(strip), &name);
            // The colours of a strip that is not complete may still change.
            let is_complete = strip.done >= 1.0;
            let opacity = if is_complete { 1.0 } else { 0.35 };
            if !is_complete {
                drawing.rect([[left, y], [right - left, self.height]], Ink::Grid, 1.0);
            }
            let overlap = if is_complete { OVERLAP } else { 0.0 };
            for (ends, (rating, is_beyond_law)) in strip.pieces() {
                let [from, to] = ends.map(|factor| axis.place(factor));
                drawing.rect([[from, y], [to - from + overlap, self.height]], rating.entry(false).0, opacity);
                if is_beyond_law {
                    hatch(drawing, [[from, y], [to - from, self.height]], HATCH);
                }
            }
            let done = || Some(sentence!("%{done} solved", done = format!("{:.0} %", 100.0 * strip.done)));
            let end = if is_complete { strip.end(self.loads) } else { done() };
            let end = end.map_or_else(String::new, |end| render(&end));
            drawing.text([right + 12.0, base], Anchor::Start, Ink::Text, &end);
        }
    }

    /// Draws the length of the reference displacement over the load.
    fn draw_curve(&self, drawing: &mut dyn DrawTarget, render: Render<'_>) {
        let (axis, Some(up), [left, right], [top, _]) = (self.axis(), self.up(), self.across, self.curve) else {
            return;
        };
        for (y, length) in up.ticks() {
            drawing.line(&[[left, y], [right, y]], Ink::Grid, 1.0, &[]);
            drawing.text([left - 12.0, y + 4.0], Anchor::End, Ink::Text, &engineering(length, "m"));
        }
        let length = |u: &Option<nalgebra::Vector2<f64>>| u.map(|u| u.norm()).filter(|u| *u > 0.0);
        for known in self.limits.reference.split(|(_, u)| length(u).is_none()) {
            let places = known.iter().filter_map(|(factor, u)| Some([axis.place(*factor), up.place(length(u)?)]));
            drawing.line(&places.collect::<Vec<_>>(), Ink::Reference, 2.0, &[]);
        }
        let name = render(&sentence!("reference displacement\nof the first probe"));
        for (i, line) in name.lines().enumerate() {
            drawing.text([right + 12.0, top + 12.0 + 18.0 * i as f64], Anchor::Start, Ink::Text, line);
        }
    }
}

/// Draws slanted lines over a bar, which is given by its upper left corner and its size.
pub(crate) fn hatch(drawing: &mut dyn DrawTarget, bar: [[f64; 2]; 2], ink: Ink) {
    const GAP: f64 = 7.0;
    let [[left, top], [width, height]] = bar;
    drawing.clip(Some(bar));
    // Lines of neighbouring bars meet.
    let mut x = (left / GAP).floor() * GAP - height;
    while x < left + width {
        drawing.line(&[[x, top + height], [x + height, top]], ink, 1.2, &[]);
        x += GAP;
    }
    drawing.clip(None);
}
