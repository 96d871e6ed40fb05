//! Figures in the window: the plot, the table next to it, the choice of quantities, and export to files.

use super::*;
use crate::app::platform::files::{self, NewFile};

/// Format of a file with a figure: its extension, its description, and the function that writes its text.
type FigureFormat = (&'static str, &'static str, fn(&Figure) -> String);
const FORMATS: [FigureFormat; 2] = [
    ("csv", "Every point as a table, with units", Figure::csv),
    ("svg", "The plot and its table as a vector drawing", |figure| plot::figures([figure]).svg()),
];

/// Saves the text of a figure in the current folder under the first free name, and returns its path.
pub(crate) fn save(extension: &str, text: &str) -> Result<PathBuf, Sentence> {
    let new = NewFile::create(Path::new(""), extension).map_err(|error| error.to_string())?;
    let path = new.path().to_owned();
    files::save(&path, text.as_bytes())
        .map_err(|error| Sentence::located(path.display().to_string(), error.to_string()))?;
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

/// Draws the chart of a figure between two corners, and the values of the point under the pointer; returns the painter with
/// the axes.
pub(crate) fn plot(ui: &mut Ui, figure: &Figure, corners: [[f64; 2]; 2]) -> (ChartPainter, [ChartAxis; 2]) {
    let (response, frame, mut painter) = chart::area(ui);
    let axes = plot::chart(&mut painter, figure, corners, &frame);
    let places = figure.series.iter().flat_map(|series| {
        let points = series.points.iter().filter_map(|point| figure.place(point));
        points.map(move |[x, y]| ([axes[0].place(x), axes[1].place(y)], (series, [x, y])))
    });
    chart::hover(ui, &response, places, |(series, values)| {
        let unit = |i| figure.quantity(i).map_or("", |quantity| quantity.unit);
        let [x, y] = [0, 1].map(|i| engineering(three_digits(values[i]), unit(i)));
        format!("{}\n{x}, {y}", series.name)
    });
    (painter, axes)
}

pub(crate) fn export_menu(ui: &mut Ui, figure: &Figure, actions: &mut Vec<Action>) {
    ui.menu_button(tr("Export"), |ui| {
        for (extension, tip, text) in FORMATS {
            if ui.button(extension.to_uppercase()).on_hover_text(tr(tip)).clicked() {
                actions.push(Action::Export(extension, text(figure)));
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
    let places: &[[f64; 2]] = if row.mark.is_line() { &[[0.0; 2], [16.0, 0.0]] } else { &[[8.0, 0.0]] };
    plot::draw(&mut ChartPainter::new(ui, rect.left_center()), row.ink, row.mark, places, 4.5);
    let painter = ui.painter();
    let small = FontId::proportional(SMALL);
    let right = painter.text(rect.right_center(), Align2::RIGHT_CENTER, value, small, palette.text);
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
