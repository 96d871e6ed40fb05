//! Figures in the window: the plot, the table next to it, the choice of quantities, and export to files.

use crate::app::action::{Action, FigureFile};
use crate::app::view_options::CurvePlot;
use std::path::{Path, PathBuf};

use egui::{Align2, Color32, FontId, Rect, ScrollArea, Sense, Stroke, Ui, WidgetInfo, pos2, vec2};
use egui_plot::{Line, LineStyle, MarkerShape, PlotPoints, Points};
use thiserror::Error;

use crate::app::language::tr;
use crate::app::platform::files;
use crate::app::platform::new_file::NewFile;
use crate::app::widgets::buttons::option_button;
use crate::app::widgets::palette::{BODY, Palette, SMALL};
use crate::app::widgets::plot::{segments, still};
use crate::sentence::Sentence;
use crate::study::figure::{Figure, FigurePoint, FigureSeries, Ink, Mark};

/// Reason for which a figure is not saved.
#[derive(Debug, Error)]
#[error("{}", Sentence::from(self))]
pub(crate) enum FigureSaveError {
    NoFile(#[from] std::io::Error),
    File { path: PathBuf, reason: std::io::Error },
}

impl From<&FigureSaveError> for Sentence {
    fn from(error: &FigureSaveError) -> Self {
        match error {
            FigureSaveError::NoFile(error) => error.to_string().into(),
            FigureSaveError::File { path, reason } => Self::located(path.display().to_string(), reason.to_string()),
        }
    }
}

/// Saves a figure in the current folder under the first free name, and returns its path.
pub(crate) fn save(figure: &Figure, file: FigureFile) -> Result<PathBuf, FigureSaveError> {
    let new = NewFile::create(Path::new(""), file.extension())?;
    let bytes = match file {
        FigureFile::Csv => figure.csv().into_bytes(),
        FigureFile::Svg => crate::plot::figure(figure).svg().into_bytes(),
    };
    let path = new.path().to_owned();
    match files::save(&path, &bytes) {
        Ok(()) => Ok(path),
        Err(reason) => Err(FigureSaveError::File { path, reason }),
    }
}

/// Parts of a figure in the window: the plot, and the table to its right.
pub(crate) struct Parts {
    pub plot: Rect,
    pub table: Rect,
}

impl Parts {
    pub(crate) fn of(whole: Rect) -> Self {
        let split = whole.right() - (0.4 * whole.width()).clamp(196.0, 330.0);
        Self {
            plot: Rect::from_min_max(whole.min, pos2(split - 12.0, whole.bottom())),
            table: Rect::from_min_max(pos2(split, whole.top()), whole.max),
        }
    }
}

/// Draws the plot.
pub(crate) fn plot(ui: &mut Ui, id: &str, figure: &Figure) {
    let palette = Palette::new(ui.visuals());
    let corners = figure.corners();
    let [x, y] = [0, 1].map(|axis| figure.quantity(axis).map_or(("", ""), |q| (q.name.as_str(), q.unit)));
    let mut plot = still(&palette, id, x, y).set_margin_fraction(egui::Vec2::ZERO);
    for [x, y] in corners {
        plot = plot.include_x(x).include_y(y);
    }
    if figure.has_one_scale() {
        plot = plot.data_aspect(1.0);
    }
    let is_inside = |p: &[f64; 2]| {
        let slack = [0, 1].map(|i| 1e-9 * (corners[1][i] - corners[0][i]));
        (0..2).all(|i| p[i] >= corners[0][i] - slack[i] && p[i] <= corners[1][i] + slack[i])
    };
    plot.show(ui, |plot| {
        let mut smaller = 0.0;
        for series in &figure.series {
            let color = color(&palette, series.ink);
            let places = |present: Option<bool>| -> Vec<[f64; 2]> {
                let own = series.points.iter().filter(|point| present.is_none_or(|p| p == point.is_present));
                own.filter_map(|point| figure.place(point)).collect()
            };
            if series.mark.is_line() {
                let style = match series.mark {
                    Mark::Dashes => LineStyle::dashed_loose(),
                    Mark::Dots => LineStyle::dotted_dense(),
                    _ => LineStyle::Solid,
                };
                // A dashed line must be one line: split into many segments it would have no gaps.
                let lines = match series.mark {
                    Mark::Line => segments(&places(None)),
                    _ => vec![places(None)],
                };
                for line in lines.into_iter().filter_map(|line| clipped(&line, corners)) {
                    let line = Line::new(series.name.clone(), PlotPoints::from(line));
                    plot.line(line.color(color).width(2.0).style(style));
                }
                continue;
            }
            for (is_present, radius, step) in [(false, 3.8, 0.7), (true, 7.0, 1.4)] {
                let mut own = places(Some(is_present));
                own.retain(is_inside);
                let (shape, filled) = marker_shape(series.mark);
                let points = Points::new(series.name.clone(), own).color(color).shape(shape).filled(filled);
                // Marks at the same position get different sizes, so that all are visible.
                plot.points(points.radius((radius - step * smaller as f32).max(2.4)));
            }
            if series.mark == Mark::Disc {
                smaller += 1.0;
            }
        }
    });
    // The space for tick labels is known one frame late, so changed limits need another frame.
    let id = ui.scope_id().with(("corners", id));
    if ui.data_mut(|data| data.get_temp(id).replace(corners).is_none_or(|before: [[f64; 2]; 2]| before != corners)) {
        ui.data_mut(|data| data.insert_temp(id, corners));
        ui.ctx().request_repaint();
    }
}

/// Returns the part of a line inside the corners, from its first point inside; `None` if the line is outside.
fn clipped(line: &[[f64; 2]], [low, high]: [[f64; 2]; 2]) -> Option<Vec<[f64; 2]>> {
    let inside = |p: &[f64; 2]| (0..2).all(|i| p[i] >= low[i] && p[i] <= high[i]);
    let mut kept = Vec::new();
    for pair in line.windows(2) {
        let [a, b] = [pair[0], pair[1]];
        // Parameters of the part inside; Liang and Barsky 1984.
        let (mut from, mut to) = (0.0_f64, 1.0_f64);
        for i in 0..2 {
            let d = b[i] - a[i];
            for (distance, outward) in [(a[i] - low[i], -d), (high[i] - a[i], d)] {
                if outward == 0.0 {
                    if distance < 0.0 {
                        to = -1.0;
                    }
                } else if outward < 0.0 {
                    from = from.max(distance / outward);
                } else {
                    to = to.min(distance / outward);
                }
            }
        }
        if from > to {
            continue;
        }
        let at = |t: f64| [0, 1].map(|i| a[i] + t * (b[i] - a[i]));
        if kept.is_empty() {
            kept.push(if inside(&a) { a } else { at(from) });
        }
        kept.push(if inside(&b) { b } else { at(to) });
    }
    (kept.len() > 1).then_some(kept)
}

fn color(palette: &Palette, ink: Ink) -> Color32 {
    match ink {
        Ink::Method(method) => palette.method(method),
        Ink::Unstable => palette.error,
        Ink::BeamTheory | Ink::Scene => palette.text,
    }
}

fn marker_shape(mark: Mark) -> (MarkerShape, bool) {
    match mark {
        Mark::Ring => (MarkerShape::Circle, false),
        Mark::Cross => (MarkerShape::Cross, true),
        _ => (MarkerShape::Circle, true),
    }
}

/// Shows the choice of quantities and the export menu.
pub(crate) fn controls(
    ui: &mut Ui,
    figure: &Figure,
    offered: &[CurvePlot],
    shown: CurvePlot,
    actions: &mut Vec<Action>,
) {
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing = vec2(4.0, 2.0);
        for &plot in offered {
            let (word, tip) = plot.text();
            if ui.add(option_button(plot == shown, tr(word))).on_hover_text(tr(tip)).clicked() {
                actions.push(Action::Plot(plot));
            }
        }
        export_menu(ui, figure, actions);
    });
}

/// Shows the menu that exports a figure.
pub(crate) fn export_menu(ui: &mut Ui, figure: &Figure, actions: &mut Vec<Action>) {
    ui.menu_button(tr("Export"), |ui| {
        for (file, tip) in FigureFile::ALL {
            if ui.button(file.extension().to_uppercase()).on_hover_text(tr(tip)).clicked() {
                actions.push(Action::Export(Box::new(figure.clone()), file));
            }
        }
    });
}

/// Shows the table: marks, names, current values and errors.
pub(crate) fn table(ui: &mut Ui, figure: &Figure) {
    ui.spacing_mut().item_spacing.y = 2.0;
    ScrollArea::vertical().id_salt("table").auto_shrink([false, false]).show(ui, |ui| {
        if figure.head.iter().any(|text| !text.is_empty()) {
            head(ui, figure);
        }
        for (series, value) in figure.rows() {
            show_row(ui, series, value);
        }
    });
}

fn head(ui: &mut Ui, figure: &Figure) {
    let palette = Palette::new(ui.visuals());
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), 18.0), Sense::hover());
    let [name, value] = &figure.head;
    let put =
        |at, align: Align2, text, color| _ = ui.painter().text(at, align, text, FontId::proportional(SMALL), color);
    put(rect.left_center(), Align2::LEFT_CENTER, name, palette.load);
    put(rect.right_center(), Align2::RIGHT_CENTER, value, palette.secondary);
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Label, true, format!("{name} {value}").trim()));
}

fn show_row(ui: &mut Ui, row: &FigureSeries, value: &str) {
    /// Width of the column of marks, points.
    const MARK: f32 = 22.0;
    let palette = Palette::new(ui.visuals());
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), 20.0), Sense::hover());
    let painter = ui.painter();
    paint_mark(ui, rect.left_center() + vec2(8.0, 0.0), row.mark, color(&palette, row.ink));
    let ink = if row.mark == Mark::Cross { palette.error } else { palette.text };
    let right = painter.text(rect.right_center(), Align2::RIGHT_CENTER, value, FontId::proportional(SMALL), ink);
    let room = (right.left() - rect.left() - MARK - 8.0).max(0.0);
    let mut job = egui::text::LayoutJob::simple_singleline(row.name.clone(), FontId::proportional(BODY), palette.text);
    job.wrap = egui::text::TextWrapping::truncate_at_width(room);
    let galley = painter.layout_job(job);
    let at = Align2::LEFT_CENTER.anchor_size(rect.left_center() + vec2(MARK, 0.0), galley.size());
    painter.galley(at.min, galley, palette.text);
    let separator = if value.is_empty() { "" } else { ": " };
    let spoken = format!("{}{separator}{value}", row.name);
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Label, true, &spoken));
    response.on_hover_text(spoken);
}

fn paint_mark(ui: &Ui, center: egui::Pos2, mark: Mark, color: Color32) {
    let painter = ui.painter();
    let stroke = Stroke::new(2.0, color);
    let ends = [center - vec2(8.0, 0.0), center + vec2(8.0, 0.0)];
    let across = |d: egui::Vec2| {
        painter.line_segment([center - d, center + d], stroke);
    };
    match mark {
        Mark::Line => _ = painter.line_segment(ends, stroke),
        Mark::Dashes => _ = painter.add(egui::Shape::dashed_line(&ends, stroke, 4.0, 3.0)),
        Mark::Dots => _ = painter.add(egui::Shape::dotted_line(&ends, color, 4.0, 1.2)),
        Mark::Ring => _ = painter.circle_stroke(center, 4.0, Stroke::new(1.5, color)),
        Mark::Cross => [vec2(4.0, 4.0), vec2(4.0, -4.0)].into_iter().for_each(across),
        Mark::Disc => _ = painter.circle_filled(center, 4.5, color),
    }
}

/// Returns the point of a figure for a load and the displacement under it.
pub(crate) fn point(load: f64, u: nalgebra::Vector2<f64>) -> FigurePoint {
    FigurePoint::new([load, u.x, u.y])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_cut_at_the_corners() {
        let corners = [[0.0, 0.0], [2.0, 1.0]];
        let line = [[-1.0, 0.5], [1.0, 0.5], [1.0, 3.0]];
        assert_eq!(clipped(&line, corners), Some(vec![[0.0, 0.5], [1.0, 0.5], [1.0, 1.0]]));
        assert_eq!(clipped(&[[3.0, 0.0], [3.0, 1.0]], corners), None);
        assert_eq!(clipped(&[[0.0, -1.0], [-1.0, 0.0]], corners), None);
    }
}
