//! Gallery of the built-in scenes, each with picture, name and description.

use std::collections::BTreeMap;
use std::sync::LazyLock;

use egui::text::TextWrapping;
use egui::{ColorImage, Image, TextureHandle, TextureOptions};

use crate::app::interface::*;
use crate::app::widgets::buttons::described;

/// Size of a picture, and height of its entry, points.
const PICTURE: Vec2 = vec2(112.0, 68.0);
const HEIGHT: f32 = 80.0;
/// Number of columns, and largest width of an entry, points.
const COLUMNS: usize = 2;
const WIDEST: f32 = 420.0;

type GalleryEntry = (&'static registry::BuiltIn, Scene);

static ENTRIES: LazyLock<Vec<GalleryEntry>> = LazyLock::new(|| {
    registry::BUILT_IN.iter().filter_map(|built_in| Some((built_in, Scene::from_toml(built_in.toml).ok()?))).collect()
});

/// Groups of entries with their headings.
const GROUPS: [(Analysis, &str); 2] = [(Analysis::Dynamic, "Dynamic"), (Analysis::Static, "Static")];

/// Returns a beam without supports and loads, to be changed in the panel.
fn new_beam() -> Scene {
    let mut scene = Scene::beam(10.0, 1.0).with_element(ElementKind::T6).with_cells(20, 2);
    (scene.name, scene.about) = (tr("New beam").to_owned(), String::new());
    scene
}

/// Returns a beam on a pin and a roller with a force on its middle, each over a tenth of the height.
fn on_two_supports() -> Scene {
    let scene = new_beam().point_support([0.5, -0.5], &[Axis::X, Axis::Y]).point_support([9.5, -0.5], &[Axis::Y]);
    scene.point_force([5.0, 0.5], [0.0, -1000.0]).with_widths(0.1).probe("middle", [5.0, -0.5])
}

/// Gallery; it has its pictures while it is open.
#[derive(Default)]
pub(crate) struct Gallery {
    pictures: BTreeMap<&'static str, TextureHandle>,
    is_open: bool,
}

impl Gallery {
    /// Shows the button with the scene's name, which opens the gallery.
    pub(crate) fn show(&mut self, ui: &mut Ui, session: &Session, actions: &mut Vec<Action>) {
        let window = ui.ctx().content_rect().size();
        let opened = ComboBox::from_id_salt("scene")
            .selected_text(tr(&session.scene().name))
            .width(150.0)
            .height(window.y - 64.0)
            .truncate()
            .show_ui(ui, |ui| self.entries(ui, session, window.x, actions));
        self.is_open = opened.inner.is_some();
        if !self.is_open {
            self.pictures.clear();
        }
        opened.response.widget_info(|| WidgetInfo {
            current_text_value: Some(tr(&session.scene().name).to_owned()),
            ..WidgetInfo::labeled(Role::ComboBox, true, tr("Scene"))
        });
        opened.response.on_hover_text(tr(&session.scene().about));
    }

    fn entries(&mut self, ui: &mut Ui, session: &Session, window: f32, actions: &mut Vec<Action>) {
        /// Width of the margins and the scroll bar, points.
        const BESIDE: f32 = 36.0;
        const GAP: f32 = 6.0;
        let palette = Palette::new(ui.visuals());
        let width = ((window - BESIDE - GAP) / COLUMNS as f32).clamp(0.0, WIDEST);
        ui.set_width(width * COLUMNS as f32 + GAP);
        ui.spacing_mut().item_spacing = vec2(GAP, GAP);
        let top = ui.horizontal(|ui| {
            let tip = with_keys(ui.ctx(), tr("Open a scene file, or a recent one (Ctrl+O)"));
            if ui.button(tr("Open a file…")).on_hover_text(tip).clicked() {
                actions.push(Action::OpenFile);
            }
            ui.label(RichText::new(tr("or drop one on the window")).small().weak());
            ui.label(tr("New beam:"));
            let tip = tr("Start a beam of your own; the panel has its length and height");
            let clamped = || new_beam().clamp("left").force("right", [0.0, -1000.0]).probe("tip", "right");
            for (name, scene) in [("clamped left", clamped as fn() -> Scene), ("on two supports", on_two_supports)] {
                if ui.button(tr(name)).on_hover_text(tip).clicked() {
                    actions.push(Action::New(Box::new(scene())));
                    ui.close();
                }
            }
        });
        if !self.is_open {
            // The list would open where it was last scrolled to.
            ui.scroll_to_rect_animation(top.response.rect, Some(Align::TOP), egui::style::ScrollAnimation::none());
        }
        // If the gallery was opened with a key, an entry gets the keyboard focus.
        let by_key = ui.input(|i| !i.pointer.any_down() && !i.pointer.any_released());
        for (analysis, heading) in GROUPS {
            ui.label(RichText::new(tr(heading)).small().weak());
            let group: Vec<&GalleryEntry> = ENTRIES.iter().filter(|(_, scene)| scene.analysis == analysis).collect();
            for row in group.chunks(COLUMNS) {
                ui.horizontal(|ui| {
                    for entry in row {
                        let is_present = entry.0.id == session.document().source.name.as_os_str();
                        let is_edited = is_present && session.is_edited();
                        let response = self.entry(ui, &palette, entry, width, (is_present, is_edited));
                        if is_present && !self.is_open && by_key {
                            response.scroll_to_me(Some(Align::Center));
                            response.request_focus();
                        }
                        if response.clicked() {
                            actions.push(Action::Open(entry.0.id.into()));
                            // A click closes the gallery by itself, a key does not.
                            ui.close();
                        }
                    }
                });
            }
        }
    }

    fn entry(
        &mut self,
        ui: &mut Ui,
        palette: &Palette,
        (built_in, scene): &GalleryEntry,
        width: f32,
        (is_present, is_edited): (bool, bool),
    ) -> Response {
        const PADDING: f32 = 6.0;
        const TEXT: f32 = 12.0;
        let (rect, response) = ui.allocate_exact_size(vec2(width, HEIGHT), Sense::click());
        response.widget_info(|| WidgetInfo::selected(Role::Button, true, is_present, built_in.id));
        ui.ctx().accesskit_node_builder(response.id, |node| node.set_description(tr(&scene.about)));
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
        let plate = Rect::from_min_size(rect.min + vec2(PADDING, PADDING), PICTURE);
        ui.painter().rect_filled(plate, 4.0, palette.canvas);
        let texture = self.pictures.entry(built_in.id).or_insert_with(|| texture(ui.ctx(), built_in));
        Image::new(&*texture).corner_radius(4).paint_at(ui, plate);
        let left = plate.right() + TEXT;
        // On selected or hovered entries only the main text colour has enough contrast.
        let quiet = if fill == palette.control { palette.secondary } else { palette.text };
        let about = if is_edited { "Edited. Choose it again to open it without the edits." } else { &scene.about };
        let mut job = described(tr(&scene.name), tr(about), palette.text, quiet);
        job.wrap = TextWrapping { max_width: rect.right() - PADDING - left, max_rows: 4, ..TextWrapping::default() };
        let galley = ui.painter().layout_job(job);
        let at = pos2(left, rect.center().y - 0.5 * galley.size().y);
        ui.painter().galley(at, galley, palette.text);
        response
    }
}

/// Returns the picture of a scene; empty if it cannot be read.
fn texture(ctx: &Context, entry: &registry::BuiltIn) -> TextureHandle {
    let image = || {
        let mut reader = png::Decoder::new(std::io::Cursor::new(entry.picture)).read_info().ok()?;
        let mut rgba = vec![0; reader.output_buffer_size()?];
        let info = reader.next_frame(&mut rgba).ok()?;
        Some(ColorImage::from_rgba_unmultiplied([info.width, info.height].map(|side| side as usize), &rgba))
    };
    ctx.load_texture(entry.id, image().unwrap_or_default(), TextureOptions::LINEAR)
}
