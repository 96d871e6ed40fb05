//! Colour bar and scale bar of a view, the room that they take, and the magnification of a drawing.

use crate::app::interface::*;

/// Height that the colour bar takes at the bottom of the view, points.
pub(crate) const LEGEND_HEIGHT: f32 = 66.0;

/// Width that the colour bar takes on the right of the view, points.
pub(crate) const LEGEND_WIDTH: f32 = 300.0;

/// Smallest size of a view with a colour bar, and smallest width of a view with line key and scale bar, points.
const LEGEND_VIEW: Vec2 = vec2(420.0, 200.0);
pub(super) const KEY_WIDTH: f32 = 220.0;

/// Returns `true` if a view of size `view`, points, has a colour bar.
pub(crate) fn has_legend(view: Vec2) -> bool {
    view.x >= LEGEND_VIEW.x && view.y >= LEGEND_VIEW.y
}

/// Returns `true` if a picture without bars is so small, points, that it has no arrows and no names.
pub(crate) fn is_tiny(options: &ViewOptions, view: Vec2) -> bool {
    !options.layout.bars && view.x < KEY_WIDTH
}

/// Paints the colours of a map from the lowest to the highest.
pub(crate) fn color_bar(painter: &Painter, bar: Rect, map: ColorMap) {
    const STRIPS: u32 = 128;
    let mut mesh = egui::Mesh::default();
    for i in 0..STRIPS {
        let at = |i: u32| bar.left() + bar.width() * i as f32 / STRIPS as f32;
        let [r, g, b] = map.color((f64::from(i) + 0.5) / f64::from(STRIPS));
        let strip = Rect::from_min_max(pos2(at(i), bar.top()), pos2(at(i + 1), bar.bottom()));
        mesh.add_colored_rect(strip, Color32::from_rgb(r, g, b));
    }
    painter.add(mesh);
}

/// Returns the label of a body that is drawn with a multiple of its displacement.
pub(crate) fn magnified(factor: f64) -> String {
    fill!("displacement × %{factor}", factor = number(three_digits(factor)))
}

/// Space between the left side of the view and the scale bar, points.
pub(super) const SCALE_BAR_LEFT: f32 = 18.0;

/// Returns the length of the scale bar in m and in points.
pub(super) fn scale(camera: &Camera) -> (f64, f32) {
    let length = round_down(110.0 / camera.scale);
    (length, (length * camera.scale) as f32)
}

/// Paints a scale bar of a round length.
pub(crate) fn scale_bar(painter: &Painter, rect: Rect, camera: &Camera, palette: &Palette) {
    if rect.width() < KEY_WIDTH || rect.height() < 100.0 {
        return;
    }
    let (length, bar) = scale(camera);
    let left = rect.left_bottom() + vec2(SCALE_BAR_LEFT, -20.0);
    let stroke = Stroke::new(1.5, palette.text);
    painter.line_segment([left, left + vec2(bar, 0.0)], stroke);
    for x in [0.0, bar] {
        painter.line_segment([left + vec2(x, -4.0), left + vec2(x, 4.0)], stroke);
    }
    let middle = left + vec2(bar * 0.5, -6.0);
    painter.text(middle, Align2::CENTER_BOTTOM, engineering(length, "m"), FontId::proportional(SMALL), palette.text);
}
