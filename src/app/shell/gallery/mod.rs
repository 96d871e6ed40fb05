//! Gallery of the built-in scenes, each with thumbnail, name and description.

use std::collections::BTreeMap;
use std::sync::LazyLock;

use egui::text::{LayoutJob, TextWrapping};
use egui::{
    Align, ComboBox, Context, FontId, Rect, Response, RichText, Role, Sense, Stroke, StrokeKind, TextFormat, Ui,
    WidgetInfo, style::ScrollAnimation, vec2,
};

use self::thumbnail::Thumbnail;
use self::thumbnail_task::{Made, ThumbnailWork};
use crate::app::action::Action;
use crate::app::language::tr;
use crate::app::readout::Readout;
use crate::app::task::thread::{POLL, Task, Update};
use crate::app::widgets::palette::{BODY, Palette, SMALL};
use crate::app::widgets::text::with_keys;
use crate::scene::{Analysis, Scene, registry};

pub(crate) mod thumbnail;
pub(crate) mod thumbnail_task;

/// Size of a thumbnail, and height of its entry, points.
const THUMBNAIL: egui::Vec2 = vec2(112.0, 68.0);
const HEIGHT: f32 = 80.0;
/// Largest width of an entry in two columns, and smallest width for which there are two columns, points.
const WIDEST: f32 = 420.0;
const NARROWEST: f32 = 340.0;

/// Built-in scene in the gallery.
struct GalleryEntry {
    id: &'static str,
    name: String,
    about: String,
    analysis: Analysis,
}

static ENTRIES: LazyLock<Vec<GalleryEntry>> = LazyLock::new(|| {
    let entry = |built_in: &registry::BuiltIn| {
        let Scene { name, about, analysis, .. } = Scene::from_toml(built_in.toml).ok()?;
        Some(GalleryEntry { id: built_in.id, name, about, analysis })
    };
    registry::BUILT_IN.iter().filter_map(entry).collect()
});

/// Groups of entries with their headings.
const GROUPS: [(Analysis, &str); 2] = [(Analysis::Dynamic, "Dynamic"), (Analysis::Static, "Static")];

/// Gallery with its thumbnails, which are made when it is opened for the first time.
#[derive(Debug, Default)]
pub(crate) struct Gallery {
    thumbnails: BTreeMap<&'static str, Thumbnail>,
    work: ThumbnailState,
    is_open: bool,
}

/// State of the work on the thumbnails.
#[derive(Debug, Default)]
enum ThumbnailState {
    #[default]
    NotBegun,
    Running(Task<Made, ()>),
    Ended,
}

impl Gallery {
    /// Receives the thumbnails that are ready; starts the work on the first call.
    fn poll(&mut self, ctx: &Context) {
        if matches!(self.work, ThumbnailState::NotBegun) {
            // If the thread cannot be started, the gallery shows names and descriptions only.
            self.work = Task::run(ThumbnailWork).map_or(ThumbnailState::Ended, ThumbnailState::Running);
        }
        while let ThumbnailState::Running(task) = &self.work {
            match task.poll() {
                Update::Progress((number, thumbnail)) => {
                    let built_in = registry::BUILT_IN.get(number);
                    self.thumbnails.extend(built_in.map(|built_in| (built_in.id, thumbnail)));
                }
                Update::None => return ctx.request_repaint_after(POLL),
                Update::Done(()) | Update::Died => self.work = ThumbnailState::Ended,
            }
        }
    }

    /// Shows the button with the scene's name, which opens the gallery.
    pub(crate) fn show(&mut self, ui: &mut Ui, input: &Readout<'_>, wide: bool, actions: &mut Vec<Action>) {
        let palette = Palette::new(ui.visuals());
        let window = ui.ctx().content_rect().size();
        let label = ui.label(RichText::new(tr("Scene")).color(palette.secondary));
        let opened = ComboBox::from_id_salt("scene")
            .selected_text(tr(&input.scene.name))
            .width(if wide { 190.0 } else { 120.0 })
            .height((window.y - 64.0).max(200.0))
            .truncate()
            .show_ui(ui, |ui| self.entries(ui, input, window.x, actions));
        self.is_open = opened.inner.is_some();
        opened.response.labelled_by(label.id).on_hover_text(tr(&input.scene.about));
    }

    fn entries(&mut self, ui: &mut Ui, input: &Readout<'_>, window: f32, actions: &mut Vec<Action>) {
        /// Width of the margins and the scroll bar, points.
        const BESIDE: f32 = 36.0;
        const GAP: f32 = 6.0;
        self.poll(ui.ctx());
        let palette = Palette::new(ui.visuals());
        let room = (window - BESIDE).max(160.0);
        let columns = if room >= 2.0 * NARROWEST + GAP { 2 } else { 1 };
        let width = ((room - GAP * (columns - 1) as f32) / columns as f32).min(if columns > 1 { WIDEST } else { room });
        ui.set_width(width * columns as f32 + GAP * (columns - 1) as f32);
        ui.spacing_mut().item_spacing = vec2(GAP, GAP);
        let top = ui.horizontal(|ui| {
            let tip = with_keys(ui.ctx(), tr("Open a scene file, or a recent one (Ctrl+O)"));
            if ui.button(tr("Open a file…")).on_hover_text(tip).clicked() {
                actions.push(Action::OpenFile);
            }
            ui.label(RichText::new(tr("or drop one on the window")).small().color(palette.secondary));
        });
        if !self.is_open {
            // The list would open where it was last scrolled to.
            ui.scroll_to_rect_animation(top.response.rect, Some(Align::TOP), ScrollAnimation::none());
        }
        // If the gallery was opened with a key, an entry gets the keyboard focus.
        let by_key = ui.input(|i| !i.pointer.any_down() && !i.pointer.any_released());
        for (analysis, heading) in GROUPS {
            ui.label(RichText::new(tr(heading)).small().color(palette.secondary));
            let group: Vec<&GalleryEntry> = ENTRIES.iter().filter(|entry| entry.analysis == analysis).collect();
            for row in group.chunks(columns) {
                ui.horizontal(|ui| {
                    for entry in row {
                        let is_present = entry.id == input.scene_name;
                        let response = self.entry(ui, &palette, entry, width, is_present);
                        if is_present && !self.is_open && by_key {
                            response.scroll_to_me(Some(Align::Center));
                            response.request_focus();
                        }
                        if response.clicked() {
                            actions.push(Action::Open(entry.id));
                            // A click closes the gallery by itself, a key does not.
                            ui.close();
                        }
                    }
                });
            }
        }
    }

    fn entry(&self, ui: &mut Ui, palette: &Palette, entry: &GalleryEntry, width: f32, is_present: bool) -> Response {
        const PADDING: f32 = 6.0;
        const TEXT: f32 = 12.0;
        let (rect, response) = ui.allocate_exact_size(vec2(width, HEIGHT), Sense::click());
        response.widget_info(|| WidgetInfo::selected(Role::Button, true, is_present, entry.id));
        ui.ctx().accesskit_node_builder(response.id, |node| node.set_description(tr(&entry.about)));
        if response.gained_focus() {
            response.scroll_to_me(None);
        }
        if !ui.is_rect_visible(rect) {
            return response;
        }
        let fill = match (is_present, response.hovered() || response.has_focus()) {
            (true, _) => palette.chosen,
            (false, true) => palette.hovered,
            (false, false) => palette.control,
        };
        let edge = if response.has_focus() { Stroke::new(1.5, palette.accent) } else { Stroke::NONE };
        ui.painter().rect(rect, 5.0, fill, edge, StrokeKind::Inside);
        let plate = Rect::from_min_size(rect.min + vec2(PADDING, PADDING), THUMBNAIL);
        ui.painter().rect_filled(plate, 4.0, palette.canvas);
        match self.thumbnails.get(entry.id) {
            Some(thumbnail) => thumbnail.paint(&ui.painter_at(plate), plate, palette),
            None => {
                _ = ui.painter().hline(
                    plate.center().x - 8.0..=plate.center().x + 8.0,
                    plate.center().y,
                    (2.0, palette.line),
                )
            }
        }
        let left = plate.right() + TEXT;
        let format = |size: f32, color| TextFormat { font_id: FontId::proportional(size), color, ..Default::default() };
        // On selected or hovered entries only the main text colour has enough contrast.
        let quiet = if fill == palette.control { palette.secondary } else { palette.text };
        let mut job = LayoutJob::default();
        job.append(tr(&entry.name), 0.0, format(BODY, palette.text));
        job.append("\n", 0.0, format(BODY, palette.text));
        job.append(tr(&entry.about), 0.0, format(SMALL, quiet));
        job.wrap = TextWrapping { max_width: rect.right() - PADDING - left, max_rows: 4, ..TextWrapping::default() };
        let galley = ui.painter().layout_job(job);
        let at = egui::pos2(left, rect.center().y - 0.5 * galley.size().y);
        ui.painter().galley(at, galley, palette.text);
        response
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A background thread makes the thumbnails of all scenes, and the work then ends.
    #[test]
    fn thumbnails_are_computed_in_the_background() {
        let ctx = Context::default();
        let mut gallery = Gallery::default();
        assert!(matches!(gallery.work, ThumbnailState::NotBegun), "nothing is made before it is opened");
        while !matches!(gallery.work, ThumbnailState::Ended) {
            gallery.poll(&ctx);
            std::thread::sleep(std::time::Duration::from_millis(5));
        }
        assert_eq!(gallery.thumbnails.len(), ENTRIES.len());
        assert_eq!(ENTRIES.len(), registry::BUILT_IN.len());
    }
}
