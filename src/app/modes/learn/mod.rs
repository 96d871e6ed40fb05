//! Mode Learn: the article on a row of cards. Each card sets up its scene, and the user can change everything at any
//! time. The user's own scene is put aside, and restored when the mode ends.

use cards::CardDisplay;
use frames::angle_text;
use matrices::Triangle;
use nalgebra::{DMatrix, Matrix2};

use super::*;
use crate::app::viewport::body_mesh::BodyMesh;
use crate::app::widgets::buttons::at_right;
use crate::rotation::Rotation;

mod area;
mod cards;
mod code;
mod formula;
mod frames;
mod matrices;
mod residuals;

pub(crate) use cards::{CARDS, Card, Setup};
pub(crate) use code::{AT_REST, SOLVE, UNTIL};

/// Height of the row of cards, points, and its largest fraction of the window's height.
const HEIGHT: f32 = 258.0;
const SHARE: f32 = 0.42;
/// Width of the navigation to the other cards, points.
const NAVIGATION: f32 = 420.0;

/// Largest number of elements that are painted one by one.
const MAX_ELEMENTS: usize = 3000;

pub(crate) struct Learn {
    /// Number of the card that was displayed last, from 0.
    pub card: usize,
    /// Index of the element that was selected last.
    picked: usize,
    /// Fraction of the exploded view: 0 for the body itself, 1 for separate, rotated-back elements.
    rotation_part: f64,
    messages: Messages,
    /// Highlighted line of the pseudocode, from 0.
    pub line: usize,
    /// Highlighted line in the last frame.
    shown_line: usize,
    /// Largest body that the card's slider reaches.
    pub reach: Option<Simulation>,
}

/// View that a card paints over.
pub(crate) struct CardView<'a> {
    pub simulation: &'a Simulation,
    pub body: &'a BodyMesh,
    pub projection: Projection,
}

impl CardView<'_> {
    /// Returns `true` if there are too many elements to paint each of them.
    fn is_fine(&self) -> bool {
        self.simulation.system().mesh().element_count() > MAX_ELEMENTS
    }

    fn points_of(&self, element: usize) -> &[Vector2<f64>] {
        let each = self.body.points.len() / self.simulation.system().mesh().element_count().max(1);
        self.body.points.get(element * each..(element + 1) * each).unwrap_or_default()
    }

    /// Returns the outline of an element as drawn.
    fn corners(&self, element: usize) -> Vec<Pos2> {
        let entry = self.simulation.system().mesh().element().entry();
        let points = self.points_of(element);
        let lattice = (entry.cell.lattice)(entry.drawn_pieces);
        let around = lattice.sides.iter().flat_map(|side| &side[..side.len().saturating_sub(1)]);
        around.filter_map(|&p| points.get(p as usize)).map(|&p| self.projection.point(p)).collect()
    }
}

impl Learn {
    /// Creates the mode at card number `card`, from 0.
    pub(crate) fn new(card: usize) -> Self {
        Self {
            card: card.min(CARDS.len() - 1),
            picked: 6,
            rotation_part: 1.0,
            messages: Messages::new(),
            line: 0,
            shown_line: 0,
            reach: None,
        }
    }

    pub(crate) fn card(&self) -> &'static Card {
        &CARDS[self.card.min(CARDS.len() - 1)]
    }

    /// Goes to card number `card`, from 0.
    pub(crate) fn go_to(&mut self, card: usize) {
        self.card = card.min(CARDS.len() - 1);
        self.messages.clear();
    }

    /// Returns `true` if the elements are drawn apart from each other.
    pub(crate) fn is_apart(&self) -> bool {
        self.card().content == CardDisplay::Exploded && self.rotation_part > 0.0
    }

    /// Returns the line of the pseudocode that a step goes to; `None` on other cards.
    pub(crate) fn next_line(&self, simulation: &Simulation, ended: bool) -> Option<usize> {
        (self.card().content == CardDisplay::Code && code::describes(simulation)).then(|| code::after(self.line, ended))
    }

    /// Returns `true` if the card shows ρ at the equilibrium.
    pub(crate) fn shows_rho(&self) -> bool {
        matches!(self.card().content, CardDisplay::Steps | CardDisplay::Methods)
    }

    /// Selects the element that is drawn at a position in the window.
    pub(crate) fn pick(&mut self, view: &CardView<'_>, at: Pos2) {
        let place = |p: u32| view.body.points.get(p as usize).map(|&p| view.projection.point(p));
        let side = |a: Pos2, b: Pos2| (b - a).x * (at - a).y - (b - a).y * (at - a).x;
        let found = view.body.geometry.triangles.iter().position(|corners| {
            let [Some(a), Some(b), Some(c)] = corners.map(place) else { return false };
            let sides = [side(a, b), side(b, c), side(c, a)];
            sides.iter().all(|s| *s >= 0.0) || sides.iter().all(|s| *s <= 0.0)
        });
        let each = view.body.geometry.triangles.len() / view.simulation.system().mesh().element_count().max(1);
        if let Some(triangle) = found {
            self.picked = triangle / each.max(1);
        }
    }

    pub(crate) fn paint(&self, painter: &Painter, view: &CardView<'_>) {
        match self.card().content {
            CardDisplay::Frames | CardDisplay::Matrices | CardDisplay::Code => frames::paint(painter, view, self),
            CardDisplay::Exploded => frames::paint_rotated_back(painter, view, self),
            _ => {}
        }
    }

    /// Shows numbers and controls next to the text.
    fn show_content(&mut self, ui: &mut Ui, session: &Session, actions: &mut Vec<Action>) {
        match self.card().content {
            CardDisplay::Area => area::show(ui, session, self, actions),
            CardDisplay::Frames => frames::show(ui, session, self, actions),
            CardDisplay::Exploded => frames::show_rotated_back(ui, session, self, actions),
            CardDisplay::Matrices => matrices::show(ui, session, self, actions),
            CardDisplay::Code => code::show(ui, session, self, actions),
            CardDisplay::Steps => residuals::steps(ui, session, actions),
            CardDisplay::Methods => residuals::methods(ui, session, actions),
            CardDisplay::Elements => residuals::elements(ui, session.scene(), actions),
            CardDisplay::ToMeasure => {
                let tip = "Leave the cards, and measure your own scene (B)";
                if ui.button(tr("Open Measure")).on_hover_text(tr(tip)).clicked() {
                    actions.push(Action::Toggle(Toggle::Tab(MeasureTab::HowFast)));
                }
            }
        }
    }

    pub(crate) fn show(&mut self, ui: &mut Ui, session: &Session, keys: bool, actions: &mut Vec<Action>) {
        if keys {
            actions.extend(self.keys(ui.ctx()));
        }
        let frame = Frame::side_top_panel(ui.style()).fill(Color32::TRANSPARENT);
        let frame = frame.inner_margin(Margin { left: 14, right: 10, top: 6, bottom: 4 });
        let height = HEIGHT.min(SHARE * ui.ctx().content_rect().height());
        Panel::bottom("learn").exact_size(height).resizable(false).frame(frame).show(ui, |ui| {
            self.header(ui, actions);
            ui.add_space(2.0);
            let card = self.card();
            let bars = egui::scroll_area::ScrollBarVisibility::VisibleWhenNeeded;
            ui.spacing_mut().scroll = egui::style::ScrollStyle::solid();
            let number = self.card;
            let (left, right) = split(ui.available_rect_before_wrap());
            let mut column = |rect: Rect, part: &str, show: &mut dyn FnMut(&mut Ui)| {
                let layout = Layout::top_down(Align::Min);
                let mut ui = ui.new_child(egui::UiBuilder::new().max_rect(rect).layout(layout));
                ui.set_clip_rect(rect.expand(3.0).intersect(ui.clip_rect()));
                // A scroll bar that appears would wrap the text differently, which might hide the bar again.
                let room = ui.available_width() - ui.spacing().scroll.allocated_width();
                let area = ScrollArea::vertical().id_salt((part, number)).auto_shrink([false, false]);
                area.scroll_bar_visibility(bars).show(&mut ui, |ui| {
                    ui.set_max_width(room);
                    show(ui);
                });
            };
            column(left, "words", &mut |ui| text(ui, card));
            column(right, "drawing", &mut |ui| self.show_content(ui, session, actions));
        });
    }

    /// Shows the title, and the navigation to the other cards.
    fn header(&self, ui: &mut Ui, actions: &mut Vec<Action>) {
        let palette = Palette::new(ui.visuals());
        let (card, count) = (self.card, CARDS.len());
        let title = RichText::new(tr(self.card().title)).size(HEADLINE).strong().color(palette.text);
        ui.horizontal(|ui| {
            let room = (ui.available_width() - NAVIGATION).max(0.0);
            ui.scope(|ui| {
                ui.set_max_width(room);
                ui.add(Label::new(title).truncate());
            });
            at_right(ui, "cards", |ui| {
                ui.spacing_mut().item_spacing.x = 6.0;
                let mut button = |ui: &mut Ui, is_on: bool, name: &str, tip: &str, action: Action| {
                    if ui.add_enabled(is_on, Button::new(tr(name))).on_hover_text(tr(tip)).clicked() {
                        actions.push(action);
                    }
                };
                let (before, after) = (Action::Card(card.saturating_sub(1)), Action::Card(card + 1));
                button(ui, card > 0, "‹ Back", "The card before (left arrow)", before);
                let place = fill!("%{n} of %{count}", n = card + 1, count);
                ui.label(RichText::new(place).color(palette.secondary));
                button(ui, card + 1 < count, "Next ›", "The next card (right arrow or Enter)", after);
                button(ui, true, "Set up again", "Restores this card’s scene", Action::Card(card));
                button(ui, true, "Story", "A story of twenty seconds; any key or click ends it", Action::Story);
                let leave = Action::Toggle(Toggle::Mode(Mode::Explore));
                button(ui, true, "Leave", "Back to your own scene (Esc)", leave);
            });
        });
    }

    /// Returns the action of the keys pressed in this frame. Except for Escape, keys work only if no control has the
    /// focus.
    fn keys(&self, ctx: &Context) -> Option<Action> {
        let escape = ctx.input(|i| i.key_pressed(Key::Escape));
        if escape && !ctx.text_edit_focused() {
            return Some(Action::Toggle(Toggle::Mode(Mode::Explore)));
        }
        if ctx.memory(|memory| memory.focused().is_some()) {
            return None;
        }
        let (forth, back) = ctx.input(|i| {
            let plain = i.modifiers.is_none();
            let pressed = |key| plain && i.key_pressed(key);
            (pressed(Key::ArrowRight) || pressed(Key::Enter), pressed(Key::ArrowLeft))
        });
        match (forth, back) {
            (true, _) if self.card + 1 < CARDS.len() => Some(Action::Card(self.card + 1)),
            (_, true) if self.card > 0 => Some(Action::Card(self.card - 1)),
            _ => None,
        }
    }
}

/// Shows the buttons that step (name, tooltip, and `true` if it can), return to rest, and iterate to the end.
fn step_buttons(ui: &mut Ui, session: &Session, step: (&'static str, &'static str, bool), actions: &mut Vec<Action>) {
    let goes_on = *session.simulation().status() == Status::Running && !session.is_running();
    for (name, tip, on, action) in [
        (step.0, step.1, step.2, Action::Step),
        ("From rest", "Back to rest (R)", true, Action::Reset),
        ("Go on", "Iterate to the end (Space)", goes_on, Action::ToggleRun),
    ] {
        if ui.add_enabled(on, Button::new(tr(name))).on_hover_text(tr(tip)).clicked() {
            actions.push(action);
        }
    }
}

/// Returns the areas of the text, and of the numbers and controls next to it.
fn split(rect: Rect) -> (Rect, Rect) {
    /// Largest width of the text, points: longer lines are hard to read.
    const WIDEST: f32 = 470.0;
    const GUTTER: f32 = 24.0;
    const WIDEST_DRAWING: f32 = 620.0;
    let width = (0.48 * (rect.width() - GUTTER)).min(WIDEST);
    let drawing = rect.with_min_x(rect.left() + width + GUTTER);
    (rect.with_max_x(rect.left() + width), drawing.with_max_x(drawing.right().min(drawing.left() + WIDEST_DRAWING)))
}

/// Shows sentences, formulas, the definitions of symbols and the task.
fn text(ui: &mut Ui, card: &Card) {
    let palette = Palette::new(ui.visuals());
    let text = spaced(RichText::new(tr(card.text)), BODY).color(palette.text);
    ui.add(Label::new(text).wrap());
    ui.add_space(4.0);
    let chip = Frame::new().fill(palette.canvas).corner_radius(6.0).inner_margin(Margin::symmetric(12, 5));
    chip.show(ui, |ui| {
        ui.horizontal_wrapped(|ui| {
            let width = ui.max_rect().width();
            let set = |part: &&str| formula::fitted(ui.painter(), part, formula::SIZE, palette.text, width);
            let galleys: Vec<_> = card.formula.iter().map(set).collect();
            // The formulas move closer together if that fits them into one row.
            let gaps = width - galleys.iter().map(|galley| galley.size().x).sum::<f32>();
            let gap = gaps / card.formula.len().saturating_sub(1).max(1) as f32;
            ui.spacing_mut().item_spacing.x = gap.floor().clamp(14.0, 36.0);
            for (part, galley) in card.formula.iter().zip(galleys) {
                let response = ui.add(Label::new(galley).extend());
                response.widget_info(|| WidgetInfo::labeled(Role::Label, true, formula::plain(part)));
            }
        });
    });
    ui.add_space(2.0);
    let symbols = RichText::new(tr(card.symbols)).small().weak();
    ui.add(Label::new(spaced(symbols, SMALL)).wrap());
    ui.add_space(4.0);
    ui.horizontal_wrapped(|ui| {
        let (rect, _) = ui.allocate_exact_size(vec2(10.0, 16.0), Sense::hover());
        let triangle = [vec2(-3.0, -5.0), vec2(5.0, 0.0), vec2(-3.0, 5.0)].map(|v| rect.center() + v);
        ui.painter().add(Shape::convex_polygon(triangle.to_vec(), palette.accent, Stroke::NONE));
        ui.label(RichText::new(tr(card.task)).color(palette.accent).font(FontId::proportional(BODY)));
    });
}

const NOT_TRIANGLES: &str = "These numbers are for three-node triangles only.";

/// Shows the reason for which a card cannot show the scene, with a button that sets up the card again.
fn not_triangles(ui: &mut Ui, text: &str, learn: &Learn, actions: &mut Vec<Action>) {
    ui.horizontal_wrapped(|ui| {
        ui.label(tr(text));
        if ui.button(tr("Back to the article’s beam")).clicked() {
            actions.push(Action::Card(learn.card));
        }
    });
}

/// Returns the number of cards of the mode Learn.
pub fn card_count() -> usize {
    CARDS.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_card_sets_up_a_scene_and_has_a_text() {
        for card in CARDS {
            let (_, mut scene) = crate::app::session::document::built_in("article").unwrap();
            card.setup.edit(&mut scene);
            assert!(scene.validate().is_ok(), "{}", card.title);
            let sentences = card.text.split_inclusive(['.', '?']).filter(|s| s.trim().len() > 3).count();
            assert!((2..=4).contains(&sentences), "{}: {sentences} sentences", card.title);
            assert!(!card.formula.is_empty() && !card.symbols.is_empty() && !card.task.is_empty());
        }
    }
    /// Every variable is defined on the card where it first appears, or on an earlier one.
    #[test]
    fn every_letter_of_the_formulas_is_defined() {
        let mut defined = String::new();
        for card in CARDS {
            defined.push_str(card.symbols);
            defined.push_str(card.text);
            for letter in card.formula.iter().flat_map(|markup| formula::variables(markup)) {
                let is_defined = [":", ",", "x:"].iter().any(|end| defined.contains(&format!("{letter}{end}")))
                    || ["angle", "strain", "by"].iter().any(|before| defined.contains(&format!("{before} {letter}")));
                assert!(is_defined, "{}: {letter}", card.title);
            }
        }
    }
}
