//! Figures in the window: the plot, the table next to it, the choice of quantities, and export to files.

use egui_plot::{Line, LineStyle, MarkerShape, PlotBounds, PlotPoints, Points};

use crate::app::action::FigureFile;
use crate::app::interface::*;
use crate::app::platform::files;
use crate::app::platform::new_file::NewFile;
use crate::app::widgets::plot::{segments, still};
use crate::study::figure::{Figure, FigurePoint, FigureSeries, Ink, Mark};

/// Saves a figure in the current folder under the first free name, and returns its path.
///
/// # Errors
/// Error of the operating system.
pub(crate) fn save(figure: &Figure, file: FigureFile) -> Result<PathBuf, Sentence> {
    let new = NewFile::create(Path::new(""), file.extension()).map_err(|error| error.to_string())?;
    let bytes = match file {
        FigureFile::Csv => figure.csv().into_bytes(),
        FigureFile::Svg => crate::plot::figures([figure]).svg().into_bytes(),
    };
    let path = new.path().to_owned();
    files::save(&path, &bytes).map_err(|error| Sentence::located(path.display().to_string(), error.to_string()))?;
    Ok(path)
}

/// Shows a plot, and to its right its controls and its table; returns the area of the plot.
pub(crate) fn beside(ui: &mut Ui, plot: impl FnOnce(&mut Ui), table: impl FnOnce(&mut Ui)) -> Rect {
    let whole = ui.available_rect_before_wrap();
    let split = whole.right() - (0.4 * whole.width()).clamp(196.0, 330.0);
    let left = whole.with_max_x(split - 12.0);
    ui.scope_builder(UiBuilder::new().max_rect(left), plot);
    ui.scope_builder(UiBuilder::new().max_rect(whole.with_min_x(split)), table);
    ui.advance_cursor_after_rect(whole);
    left
}

/// Draws the plot.
pub(crate) fn plot(ui: &mut Ui, id: &str, figure: &Figure) {
    let palette = Palette::new(ui.visuals());
    let corners = figure.corners();
    let [x, y] = [0, 1].map(|axis| figure.quantity(axis).map_or(("", ""), |q| (q.name.as_str(), q.unit)));
    let mut plot = still(&palette, id, x, y);
    if figure.has_one_scale() {
        plot = plot.data_aspect(1.0);
    }
    let is_inside = |p: &[f64; 2]| {
        let slack = [0, 1].map(|i| 1e-9 * (corners[1][i] - corners[0][i]));
        (0..2).all(|i| p[i] >= corners[0][i] - slack[i] && p[i] <= corners[1][i] + slack[i])
    };
    plot.show(ui, |plot| {
        plot.set_plot_bounds(PlotBounds::from_min_max(corners[0], corners[1]));
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
                for line in lines {
                    let line = Line::new(series.name.clone(), PlotPoints::from(line));
                    plot.line(line.color(color).width(2.0).style(style));
                }
                continue;
            }
            for (is_present, radius, step) in [(false, 3.8, 0.7), (true, 7.0, 1.4)] {
                let mut own = places(Some(is_present));
                own.retain(is_inside);
                let shape = if series.mark == Mark::Cross { MarkerShape::Cross } else { MarkerShape::Circle };
                let points = Points::new(series.name.clone(), own).color(color).shape(shape);
                let points = points.filled(series.mark != Mark::Ring);
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

fn color(palette: &Palette, ink: Ink) -> Color32 {
    match ink {
        Ink::Method(method) => palette.method(method),
        Ink::Unstable => palette.error,
        Ink::BeamTheory | Ink::Scene => palette.text,
    }
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
