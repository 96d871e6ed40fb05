//! Overlays of the body: outlines, supports, load arrows, colour bar, scale bar, and text.

use egui::epaint::RectShape;

use crate::app::diagnosis::{Errors, error_text, errors, load_text};
use crate::app::interface::*;
use crate::app::session::playback::MotionSample;
use crate::app::viewport::arrow::{LoadArrow, is_seen};
use crate::app::viewport::arrow_painter::paint_arrow;
use crate::app::viewport::bars::{KEY_WIDTH, LEGEND_HEIGHT, color_bar, has_legend, is_tiny, magnified, scale_bar};
use crate::app::viewport::body_view::BodyView;
use crate::app::viewport::probe;
use crate::app::viewport::projection::{DrawnBody, Projection};
use crate::section::Section;
use crate::study::figure::Ink;
use crate::study::section_chart;

/// Content of the overlays.
pub(crate) struct Overlay<'a> {
    pub view: &'a BodyView,
    pub body: DrawnBody<'a>,
    /// Scene that was asked for, if no equilibrium was found; another body is drawn in its place, dimmed.
    pub wanted: Option<&'a Scene>,
    pub options: &'a ViewOptions,
    /// `true` if the elements are drawn apart from each other: nothing is painted at the body's own place then.
    pub apart: bool,
    /// Drawn outline of the reference solution, m: closed lines.
    pub exact: &'a [Vec<Vector2<f64>>],
    /// Note about the state.
    pub note: Option<&'a str>,
    /// Session of Explore and Learn; `None` for a pane, which shares line key and colour bar with all panes.
    pub session: Option<&'a Session>,
    /// Displacement of the linear solution, m, if its outline is drawn.
    pub ghost: Option<&'a [Vector2<f64>]>,
}

impl Overlay<'_> {
    /// Returns the scene by whose method the drawn body is named; a body at rest in place of another one is not a result.
    fn named(&self) -> &Scene {
        let is_at_rest = self.body.positions == self.body.system.mesh().nodes();
        self.wanted.filter(|_| is_at_rest).unwrap_or(self.body.scene)
    }
}

/// Paints all overlays; those of a pane are at the body only.
pub(crate) fn paint(painter: &Painter, overlay: &Overlay<'_>, visuals: &Visuals) {
    let rect = overlay.view.rect;
    if rect.width() < 8.0 || rect.height() < 8.0 {
        return;
    }
    let palette = Palette::new(visuals);
    if overlay.wanted.is_some() {
        dim(painter, rect, &palette);
    }
    outlines(painter, overlay, &palette);
    let mut labels = Labels::new(painter, visuals);
    // Painted below the arrows, so that their tips stay visible and can be grabbed anywhere.
    if let Some(session) = overlay.session {
        labels.taken.extend(key(painter, overlay, session, &palette));
        labels.taken.extend(legend(painter, overlay, &palette));
    }
    on_body(&mut labels, overlay);
    if let Some(session) = overlay.session {
        scale_bar(painter, rect, &overlay.body.projection.camera, &palette);
        pull(&mut labels, overlay, session);
    }
    if let Some(note) = overlay.note {
        let (below, above, beside) = if overlay.session.is_some() { (46.0, 84.0, 48.0) } else { (8.0, 8.0, 24.0) };
        let places = [
            (rect.center_top() + vec2(0.0, below), Align2::CENTER_TOP),
            (rect.center_bottom() - vec2(0.0, above), Align2::CENTER_BOTTOM),
        ];
        let (at, anchor) = beside_body(&labels, overlay, note, &places);
        labels.add(at, anchor, note, palette.text, rect.width() - beside);
    }
}

/// Returns the first of several places at which a text does not cross the body's outline, else the first one.
fn beside_body(labels: &Labels<'_>, overlay: &Overlay<'_>, text: &str, places: &[(Pos2, Align2)]) -> (Pos2, Align2) {
    let (projection, geometry) = (&overlay.body.projection, overlay.body.geometry);
    let position = |node: u32| overlay.body.positions[node as usize];
    let on_line = |point| projection.point(geometry.point(point, &position));
    let size = labels.painter.layout_no_wrap(text.to_owned(), FontId::proportional(BODY), Color32::WHITE).size();
    let is_free = |(at, anchor): &&(Pos2, Align2)| {
        let frame = anchor.anchor_size(*at, size).expand(4.0);
        let crosses = |ends: &[_]| Rect::from_points(&[on_line(ends[0]), on_line(ends[1])]).intersects(frame);
        !geometry.outline.iter().any(|line| line.windows(2).any(crosses))
    };
    *places.iter().find(is_free).unwrap_or(&places[0])
}

/// Dims the body in `rect`, which is not the state that was asked for.
pub(crate) fn dim(painter: &Painter, rect: Rect, palette: &Palette) {
    painter.rect_filled(rect, 0.0, palette.canvas.gamma_multiply(0.55));
}

/// Paints the outlines of the body, of the body at rest, and of other solutions.
fn outlines(painter: &Painter, overlay: &Overlay<'_>, palette: &Palette) {
    let (projection, geometry) = (&overlay.body.projection, overlay.body.geometry);
    let draw = |place: &dyn Fn(u32) -> Vector2<f64>, stroke: Stroke| {
        for line in &geometry.outline {
            // Shorter pieces, points, would fade in the antialiasing; they are joined to the next one.
            const SHORTEST: f64 = 2.0;
            let mut points = line.iter().map(|&p| geometry.point(p, place));
            let Some(mut from) = points.next() else { continue };
            let mut points = points.peekable();
            while let Some(to) = points.next() {
                let long = (to - from).norm() * projection.camera.scale >= SHORTEST;
                if long || points.peek().is_none() {
                    if let Some(segment) = projection.segment(from, to) {
                        painter.line_segment(segment, stroke);
                    }
                    from = to;
                }
            }
        }
    };
    let rest = |n: u32| overlay.body.mesh().nodes()[n as usize];
    let drawn = |n: u32, u: &[Vector2<f64>]| rest(n) + u[n as usize] * overlay.view.body.magnification;
    if overlay.options.lines.rest_outline {
        draw(&rest, Stroke::new(1.0, palette.rest));
    }
    if let Some(linear) = overlay.ghost {
        draw(&|n| drawn(n, linear), Stroke::new(1.5, palette.ink(Ink::Solution(MethodKind::Linear.entry().colors))));
    }
    if !overlay.apart {
        draw(&|n| overlay.body.positions[n as usize], Stroke::new(1.5, palette.solution(overlay.named())));
    }
    let is_late = overlay.session.and_then(is_late) == Some(true);
    for line in overlay.exact.iter().filter(|_| !is_late) {
        // A background stroke keeps the line visible over the body.
        dashed(painter, projection, line, Stroke::new(3.5, palette.canvas.gamma_multiply(0.8)));
        dashed(painter, projection, line, Stroke::new(1.7, palette.exact));
    }
    if let Some(session) = overlay.session.filter(|_| overlay.options.lines.trail) {
        trail(painter, overlay, &session.playback, palette);
    }
}

/// Paints supports, loads, probes and sections.
fn on_body(labels: &mut Labels<'_>, overlay: &Overlay<'_>) {
    let (painter, palette) = (labels.painter, Palette::new(labels.visuals));
    if let Some(edge) = &overlay.options.edge {
        for segment in edge_segments(overlay, edge) {
            painter.line_segment(segment, Stroke::new(9.0, palette.load.gamma_multiply(0.35)));
            painter.line_segment(segment, Stroke::new(3.5, palette.load));
        }
    }
    if !overlay.apart {
        // A force on an edge is distributed along it; its arrow is that of the whole.
        for load in &overlay.body.scene.loads {
            if let Load::Force { place: Place::Edge(edge), .. } = load
                && is_seen(load, overlay.body.time)
            {
                for segment in edge_segments(overlay, edge) {
                    painter.line_segment(segment, Stroke::new(2.5, palette.load));
                }
            }
        }
        supports(painter, overlay, &palette);
        if is_tiny(overlay.options, overlay.view.rect.size()) {
            return;
        }
        loads(labels, overlay, &palette);
        weights(labels, overlay, &palette);
        if let Some(session) = overlay.session {
            moved_supports(labels, overlay, session.simulation(), &palette);
        }
        probes(labels, overlay);
        if let Some(session) = overlay.session {
            sections(labels, overlay, session.drawn(), &palette);
        }
    }
}

/// For a reference that follows a dragged load, returns `true` if the body has moved far since it was asked for.
fn is_late(session: &Session) -> Option<bool> {
    session.live().map(|live| live.is_late(session.drawn()))
}

/// Returns the drawn sides of a named edge.
fn edge_segments<'a>(overlay: &'a Overlay<'_>, edge: &str) -> impl Iterator<Item = [Pos2; 2]> + use<'a> {
    let segments = overlay.body.mesh().edges().get(edge).into_iter().flatten();
    segments.flat_map(|side| side.nodes().windows(2)).filter_map(|piece| {
        let [from, to] = [*piece.first()?, *piece.get(1)?].map(|n| overlay.body.positions.get(n as usize).copied());
        overlay.body.projection.segment(from?, to?)
    })
}

/// Paints the sections: the cut, and arrows of the forces on the part behind it, which show directions only.
fn sections(labels: &mut Labels<'_>, overlay: &Overlay<'_>, simulation: &Simulation, palette: &Palette) {
    /// Length of an arrow and of the part of the cut outside the body, points.
    const ARROW: f32 = 46.0;
    const OUTSIDE: f32 = 8.0;
    // A small view has room for the numbers of the sections only; the panel has their values.
    let (is_roomy, painter) = (has_legend(overlay.body.projection.rect.size()), labels.painter);
    let lines = simulation.scene().sections.iter();
    let sections: Vec<Section> = lines.filter_map(|&line| simulation.section_forces(line).ok()).collect();
    for (i, section) in sections.iter().enumerate() {
        let end = |i: usize| section.rest[i] + (section.ends[i] - section.rest[i]) * overlay.view.body.magnification;
        let [from, to] = [0, 1].map(|i| overlay.body.projection.point(end(i)));
        // The axes of the cut as it is drawn: a magnified body has other ones.
        let (middle, tangent) = (from + (to - from) * 0.5, (to - from).normalized());
        let normal = -tangent.rot90();
        if !(tangent.is_finite() && middle.is_finite()) {
            continue;
        }
        let color = palette.support;
        let stroke = Stroke::new(1.5, color);
        painter.add(egui::Shape::dashed_line(&[from - tangent * OUTSIDE, to + tangent * OUTSIDE], stroke, 7.0, 3.0));
        // The ends turn the section.
        for end in [from, to] {
            painter.circle_filled(end, 3.0, color);
        }
        // The plots have positive distances at this end.
        let plus = to + tangent * OUTSIDE - normal * 9.0;
        painter.text(plus, Align2::CENTER_CENTER, "+", FontId::proportional(BODY), color);
        // Forces below the rounding errors of the solve are 0.
        let contexts = section_chart::contexts(std::slice::from_ref(section), simulation);
        let text = section_chart::text(section, &contexts);
        let forces = [section.forces.normal, section.forces.shear, section.forces.moment];
        let [tension, shear, moment] = std::array::from_fn(|i| contexts[i].rounded(forces[i]));
        let least = 1e-3 * (section.force.norm() + moment.abs() / overlay.body.system.size());
        for (force, axis) in [(tension, normal), (shear, tangent)] {
            if force.abs() > least {
                paint_arrow(painter, middle, axis * ARROW.copysign(force as f32), color, false);
            }
        }
        if moment.abs() > least * overlay.body.system.size() {
            LoadArrow::of_moment(0, middle, moment, moment.abs()).paint_shape(labels, color, false);
        }
        // The label is at the upper end, outside the body.
        let (end, below) = if from.y <= to.y { (from, to) } else { (to, from) };
        let outward = (end - below).normalized();
        let anchor = match outward.x {
            x if x > 0.7 => Align2::LEFT_CENTER,
            x if x < -0.7 => Align2::RIGHT_CENTER,
            x if x > 0.1 => Align2::LEFT_BOTTOM,
            x if x < -0.1 => Align2::RIGHT_BOTTOM,
            _ => Align2::CENTER_BOTTOM,
        };
        let label = match (is_roomy, sections.len()) {
            (true, 1) => text,
            (true, _) => format!("{}: {text}", i + 1),
            (false, 1) => continue,
            (false, _) => (i + 1).to_string(),
        };
        labels.add(end + outward * (OUTSIDE + 12.0), anchor, &label, color, 320.0);
    }
}

/// Marks the probes at points, with their names. Those of edges are at the arrows of the loads, as a rule.
fn probes(labels: &mut Labels<'_>, overlay: &Overlay<'_>) {
    const RADIUS: f32 = 3.5;
    /// Distances, points, by which a label moves down to a place beside the body.
    const SHIFTS: [f32; 9] = [0.0, -8.0, 28.0, -16.0, 36.0, -24.0, 44.0, -32.0, 52.0];
    let color = labels.visuals.strong_text_color();
    for own in &overlay.body.scene.probes {
        let Place::At(at) = own.place else { continue };
        let Some(at) = overlay.body.place(at.into()).map(|at| overlay.body.projection.point(at)) else { continue };
        labels.painter.circle(at, RADIUS, labels.visuals.extreme_bg_color, Stroke::new(1.5, color));
        // A label inside a thin body would hide it.
        let places = SHIFTS.map(|shift| (at + vec2(8.0, -4.0 + shift), Align2::LEFT_BOTTOM));
        let (at, anchor) = beside_body(labels, overlay, tr(&own.name), &places);
        labels.add(at, anchor, tr(&own.name), color, 160.0);
    }
}

/// Paints a dashed line through points. The dashes continue around corners.
fn dashed(painter: &Painter, projection: &Projection, line: &[Vector2<f64>], stroke: Stroke) {
    const DASH: f32 = 6.0;
    const PERIOD: f32 = 10.0;
    let mut phase = 0.0_f32;
    for ends in line.windows(2) {
        let Some([from, to]) = projection.segment(ends[0], ends[1]) else { continue };
        let length = (to - from).length();
        let at = |s: f32| from + (to - from) * (s / length);
        let mut s = -phase;
        while s < length {
            let (begin, end) = (s.max(0.0), (s + DASH).min(length));
            if begin < end {
                painter.line_segment([at(begin), at(end)], stroke);
            }
            s += PERIOD;
        }
        phase = (phase + length) % PERIOD;
    }
}

/// Paints the fading trail of the first probe over the last seconds.
fn trail(painter: &Painter, overlay: &Overlay<'_>, playback: &Playback, palette: &Palette) {
    /// Duration of the trail, s.
    const DURATION: f64 = 2.0;
    const MAX_PIECES: usize = 400;
    let color = palette.solution(overlay.body.scene);
    let end = playback.shown.unwrap_or(f64::INFINITY);
    let end = end.min(playback.history.samples.back().map_or(0.0, |s| s.time));
    let drawn = |s: &MotionSample| s.position + s.displacement * (overlay.view.body.magnification - 1.0);
    let points: Vec<Vector2<f64>> = playback.history.before(end, DURATION).map(drawn).collect();
    let stride = points.len().div_ceil(MAX_PIECES).max(1);
    let kept: Vec<_> = points.iter().rev().step_by(stride).collect();
    for (i, ends) in kept.windows(2).enumerate() {
        if let Some(segment) = overlay.body.projection.segment(*ends[0], *ends[1]) {
            let age = i as f32 / kept.len() as f32;
            painter.line_segment(segment, Stroke::new(1.5, color.gamma_multiply(0.8 * (1.0 - age))));
        }
    }
}

/// Paints the mouse spring from the body to the pointer, with its force.
fn pull(labels: &mut Labels<'_>, overlay: &Overlay<'_>, session: &Session) {
    /// Half width of a coil, points.
    const COIL: f32 = 5.0;
    const PITCH: f32 = 7.0;
    // The force of a paused motion would be that of the pointer's velocity alone.
    let is_shown = !session.is_motion() || session.is_running();
    let Some((spring, force)) = session.simulation().mouse_spring().filter(|_| is_shown) else { return };
    let (painter, palette) = (labels.painter, Palette::new(labels.visuals));
    let held = probe::place(overlay.body.mesh(), overlay.body.positions, spring.point());
    let held = held.unwrap_or_default();
    let [from, to] = [held, spring.target()].map(|p| overlay.body.projection.point(p));
    painter.circle_filled(from, 4.5, palette.mouse_spring);
    painter.circle_stroke(to, 7.0, Stroke::new(2.0, palette.mouse_spring));
    let vector = to - from;
    let length = vector.length();
    let stroke = Stroke::new(1.8, palette.mouse_spring);
    if length > 4.0 * PITCH {
        // Straight ends with a zigzag between them.
        let along = vector / length;
        let across = vec2(-along.y, along.x) * COIL;
        let coils = (((length - 2.0 * PITCH) / PITCH).floor()).min(40.0) as u32;
        let pitch = (length - 2.0 * PITCH) / coils as f32;
        let mut points = vec![from, from + along * PITCH];
        points.extend((0..coils).map(|i| {
            let side = if i % 2 == 0 { 1.0 } else { -1.0 };
            from + along * (PITCH + pitch * (i as f32 + 0.5)) + across * side
        }));
        points.extend([to - along * PITCH, to]);
        painter.add(egui::Shape::line(points, stroke));
    } else {
        painter.line_segment([from, to], stroke);
    }
    let angle = force.y.atan2(force.x).to_degrees().round() + 0.0;
    let label = format!("{}, {angle:.0}°", engineering(three_digits(force.norm()), "N"));
    labels.add(to + vec2(0.0, -14.0), Align2::CENTER_BOTTOM, &label, palette.mouse_spring, 200.0);
}

/// Paints the supports. Fixed edges are hatched if both directions are fixed, and have rollers if one is. Other fixed
/// nodes and points have a triangle, which stands on a line if only one direction is fixed.
fn supports(painter: &Painter, overlay: &Overlay<'_>, palette: &Palette) {
    const HATCH: f32 = 7.0;
    const ROLLER: f32 = 3.5;
    let (positions, pattern) = (overlay.body.positions, overlay.body.system.pattern());
    let stroke = Stroke::new(1.5, palette.support);
    let mut drawn = vec![false; positions.len()];
    for side in &overlay.body.geometry.boundary {
        let both = [0, 1].map(|axis| side.ends().iter().all(|&end| pattern.fixed(end)[axis]));
        if both == [false, false] {
            continue;
        }
        let [p, q] = side.ends().map(|n| overlay.body.projection.point(positions[n as usize]));
        // The outline runs counter-clockwise in the plane, so the outside is on its right; the window's y axis points
        // down.
        let along = (q - p).normalized();
        let outward = vec2(-along.y, along.x);
        if !along.is_finite() || along == Vec2::ZERO {
            continue;
        }
        side.nodes().iter().for_each(|&n| drawn[n as usize] = true);
        if both == [true, true] {
            painter.line_segment([p, q], Stroke::new(2.5, palette.support));
            let strokes = ((q - p).length() / HATCH).ceil().clamp(1.0, 500.0);
            for i in 0..strokes as u32 {
                let foot = p + (q - p) * (i as f32 + 0.5) / strokes;
                painter.line_segment([foot, foot + (outward + along * 0.8) * HATCH], stroke);
            }
        } else {
            for end in [p, q] {
                painter.circle_stroke(end + outward * (ROLLER + 1.5), ROLLER, stroke);
            }
            painter.line_segment([p, q].map(|e| e + outward * (2.0 * ROLLER + 3.0)), stroke);
        }
    }
    let nodes = (0..).zip(drawn).filter(|(_, drawn)| !drawn).map(|(n, _)| (positions[n as usize], pattern.fixed(n)));
    for (at, fixed) in nodes.chain(overlay.body.system.held_places(positions)) {
        if fixed == [false, false] {
            continue;
        }
        // A roller stands on the line that it moves along.
        let away = if fixed == [true, false] { vec2(-1.0, 0.0) } else { vec2(0.0, 1.0) };
        let (p, across) = (overlay.body.projection.point(at), 7.0 * away.rot90());
        let foot = p + 11.0 * away;
        let triangle = vec![p, foot - across, foot + across];
        painter.add(egui::Shape::convex_polygon(triangle, palette.support.gamma_multiply(0.6), stroke));
        if fixed != [true, true] {
            let line = foot + 4.0 * away;
            painter.line_segment([line - 1.3 * across, line + 1.3 * across], stroke);
        }
    }
}

fn loads(labels: &mut Labels<'_>, overlay: &Overlay<'_>, palette: &Palette) {
    // The filled arrow belongs to the body, and the outline is the load that was asked for.
    let wanted = DrawnBody { scene: overlay.wanted.unwrap_or(overlay.body.scene), ..overlay.body };
    let is_outline = overlay.wanted.is_some();
    if is_outline {
        for own in overlay.body.arrows().iter().filter(|own| own.value != 0.0) {
            own.paint_shape(labels, palette.load, false);
        }
    }
    let hot = overlay.view.pointer.hot_arrow();
    for arrow in wanted.arrows() {
        let is_hot = hot.is_some_and(|grip| grip.arrow.load == arrow.load && grip.drag().is_none());
        arrow.paint(labels, palette.load, (is_hot, is_outline));
    }
    if let Some((grip, drag)) = hot.and_then(|grip| Some((grip, grip.drag()?))) {
        grip.arrow.paint_dragged(labels.painter, drag, palette.load);
    }
}

/// Paints the arrows of gravity in a corner.
fn weights(labels: &mut Labels<'_>, overlay: &Overlay<'_>, palette: &Palette) {
    /// Length of the arrow, which shows the direction only, and its shortest length in a low view, points.
    const WEIGHT: f32 = 58.0;
    const SHORTEST: f32 = 18.0;
    /// Height above the arrow, and of the label and the time line under it, points.
    const TOP: f32 = 30.0;
    const UNDER: f32 = 56.0;
    for load in overlay.body.scene.loads.iter().filter(|load| is_seen(load, overlay.body.time)) {
        let Load::Gravity { acceleration: [x, y], .. } = load else { continue };
        let direction = vec2(*x as f32, -*y as f32).normalized();
        if direction == Vec2::ZERO || !direction.is_finite() {
            continue;
        }
        // An arrow that points up begins where one that points down ends.
        let vector = direction * WEIGHT.min(overlay.view.rect.height() - TOP - UNDER).max(SHORTEST);
        let from = overlay.view.rect.right_top() + vec2(-64.0, TOP + (-vector.y).max(0.0));
        let tip = paint_arrow(labels.painter, from, vector, palette.load, false);
        let label = engineering(x.hypot(*y), "m/s²");
        labels.add(tip + vec2(0.0, 6.0), Align2::CENTER_TOP, &label, palette.load, 200.0);
    }
}

/// Paints the reaction of every moving support as an arrow.
fn moved_supports(labels: &mut Labels<'_>, overlay: &Overlay<'_>, simulation: &Simulation, palette: &Palette) {
    /// Length of the arrow of a reaction, which shows the direction only, points.
    const REACTION: f32 = 58.0;
    let held = simulation.problem().supports();
    let reactions = if held.move_the_body() { simulation.support_reactions() } else { Vec::new() };
    let supports = overlay.body.scene.supports.iter().zip(reactions).zip(held.all());
    for ((support, reaction), held) in supports.filter(|((support, _), _)| support.moves()) {
        let direction = vec2(reaction.force.x as f32, -reaction.force.y as f32).normalized();
        if direction == Vec2::ZERO || !direction.is_finite() {
            continue;
        }
        let moved = (reaction.middle - held.middle) * overlay.view.body.magnification;
        let middle = overlay.body.projection.point(held.middle + moved);
        // A reaction along the prescribed displacement pushes, and its arrow ends at the support; otherwise it begins
        // there.
        let pushes = reaction.force.dot(&Vector2::from(support.displacement)) >= 0.0;
        let from = if pushes { middle - direction * REACTION } else { middle };
        let tip = paint_arrow(labels.painter, from, direction * REACTION, palette.support, false);
        let tail = if pushes { from } else { tip };
        let (anchor, away) = match (pushes, direction.y > 0.0) {
            (true, true) | (false, false) => (Align2::CENTER_BOTTOM, -6.0),
            (true, false) | (false, true) => (Align2::CENTER_TOP, 6.0),
        };
        let label = engineering(reaction.force.norm(), "N");
        labels.add(tail + vec2(0.0, away), anchor, &label, palette.support, 200.0);
    }
}

/// Paints the colour bar with its title and ticks in the lower right corner, and returns its area.
fn legend(painter: &Painter, overlay: &Overlay<'_>, palette: &Palette) -> Option<Rect> {
    const MAX_TICKS: u32 = 5;
    const SIZE: Vec2 = vec2(240.0, 10.0);
    let rect = overlay.view.rect;
    if !has_legend(rect.size()) {
        return None;
    }
    let field = overlay.options.field;
    let (factor, unit) = field.display_unit();
    let [low, high] = overlay.view.body.range.map(|end| factor * end);
    let has_values = overlay.view.body.has_values();
    let (power, symbol) = if has_values { prefix(&[low, high], unit) } else { (0, "") };
    let raw = overlay.options.raw && !field.is_of_elements() && !field.is_of_displacement();
    let raw = if raw { tr(", each element alone") } else { "" };
    let range = match (has_values, overlay.options.fixed_range) {
        (false, _) => tr(", not known"),
        (true, Some(_)) => tr(", fixed range"),
        (true, None) => "",
    };
    let title = format!("{}, {symbol}{unit}{raw}{range}", tr(field.name()));
    let font = FontId::proportional(SMALL);
    let corner = rect.right_bottom() - vec2(SIZE.x + 32.0, LEGEND_HEIGHT - 6.0);
    let frame = Rect::from_min_size(corner - vec2(14.0, 5.0), vec2(SIZE.x + 34.0, 56.0));
    painter.rect_filled(frame, 5.0, palette.canvas.gamma_multiply(0.85));
    painter.text(corner, Align2::LEFT_TOP, title, font.clone(), palette.text);
    let bar = Rect::from_min_size(corner + vec2(0.0, 19.0), SIZE);
    color_bar(painter, bar, palette.map(field));
    if overlay.wanted.is_some() {
        dim(painter, bar, palette);
    }
    for value in ticks(low, high, MAX_TICKS).into_iter().filter(|_| has_values) {
        let x = bar.left() + bar.width() * ((value - low) / (high - low)) as f32;
        let text = engineering(value / 10f64.powi(power), "");
        painter.line_segment([pos2(x, bar.bottom()), pos2(x, bar.bottom() + 4.0)], Stroke::new(1.0, palette.text));
        painter.text(pos2(x, bar.bottom() + 5.0), Align2::CENTER_TOP, text, font.clone(), palette.text);
    }
    Some(frame)
}

/// Paints the line key with the error of each solution, and returns its area.
fn key(painter: &Painter, overlay: &Overlay<'_>, session: &Session, palette: &Palette) -> Option<Rect> {
    const GAP: f32 = 16.0;
    const ROW: f32 = 20.0;
    let rect = overlay.view.rect;
    if rect.width() < KEY_WIDTH {
        return None;
    }
    let late = is_late(session);
    let values = |word: &str, [error, bound]: [Option<f64>; 2], body: &Simulation| {
        let error = error.filter(|_| late != Some(true));
        let error = error.map(|error| format!("  {}", error_text(Some(error), bound, late.is_some())));
        format!("{}{} \u{b7} {}", tr(word), error.unwrap_or_default(), area_text(body.area_change()))
    };
    let Errors { own, bound, linear, .. } = errors(session);
    let own = match overlay.body.scene.analysis {
        Analysis::Static => values(overlay.named().solver.method.id(), [own, bound], session.drawn()),
        Analysis::Dynamic => values(overlay.body.scene.dynamics.integrator.id(), [None; 2], session.drawn()),
    };
    let mut lines = Vec::new();
    if overlay.view.body.magnification != 1.0 {
        lines.push((palette.text, None, magnified(overlay.view.body.magnification)));
    }
    lines.push((palette.solution(overlay.named()), Some(LegendMark::Line), own));
    if let Some(solution) = session.linear().filter(|_| overlay.ghost.is_some()) {
        let text = values(MethodKind::Linear.id(), [linear, None], solution);
        lines.push((palette.ink(Ink::Solution(MethodKind::Linear.entry().colors)), Some(LegendMark::Line), text));
    }
    if !overlay.exact.is_empty() {
        // A body in place of a search has another load.
        let scene = session.live().map_or(session.simulation().scene(), |live| &live.key);
        let load = overlay.wanted.and_then(|_| load_text(scene));
        let text = load.map_or_else(|| tr("reference").to_owned(), |load| fill!("reference at %{load}", load));
        lines.push((palette.exact, Some(LegendMark::Dashes), text));
    }
    if overlay.options.lines.rest_outline {
        lines.push((palette.rest, Some(LegendMark::Outline), tr("rest").to_owned()));
    }
    let font = FontId::proportional(BODY);
    let indent = |mark: Option<LegendMark>| if mark.is_some() { LegendMark::WIDTH + 6.0 } else { 0.0 };
    // Wrapped into rows if the view is narrow.
    let most = (rect.width() - 32.0).max(1.0);
    let (corner, mut at, mut widest) = (rect.left_top() + vec2(16.0, 12.0), Vec2::ZERO, 0.0_f32);
    let background = painter.add(Shape::Noop);
    for (color, mark, text) in lines {
        let galley = painter.layout_no_wrap(text, font.clone(), palette.text);
        let width = indent(mark) + galley.size().x;
        if at.x > 0.0 && at.x + width > most {
            at = vec2(0.0, at.y + ROW);
        }
        let left = corner + at + vec2(0.0, 0.5 * ROW);
        if let Some(mark) = mark {
            mark.paint(painter, left, color);
        }
        painter.galley(left + vec2(indent(mark), -0.5 * galley.size().y), galley, palette.text);
        widest = widest.max(at.x + width);
        at.x += width + GAP;
    }
    let frame = Rect::from_min_size(corner, vec2(widest, at.y + ROW)).expand2(vec2(8.0, 4.0));
    painter.set(background, RectShape::filled(frame, 5.0, palette.canvas.gamma_multiply(0.85)));
    Some(frame)
}
