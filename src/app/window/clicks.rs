//! Events of one frame: at most one button event of the pointer, which acts at the position where it happened.

use egui::Event;

/// Removes the events that follow the first button event, and returns them for the next frame.
///
/// egui applies a button event at the position of the pointer at the end of a frame. In slow frames the pointer has
/// moved on by then.
pub(crate) fn after_first(events: &mut Vec<Event>) -> Vec<Event> {
    let is_button = |event: &Event| matches!(event, Event::PointerButton { .. });
    let moves_on = |event: &Event| is_button(event) || matches!(event, Event::PointerMoved(_) | Event::PointerGone);
    match events.iter().position(is_button) {
        Some(first) if events[first + 1..].iter().any(moves_on) => events.split_off(first + 1),
        _ => Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use egui::{Modifiers, PointerButton, pos2};

    use super::*;

    fn button(x: f32, pressed: bool) -> Event {
        Event::PointerButton { pos: pos2(x, 0.0), button: PointerButton::Primary, pressed, modifiers: Modifiers::NONE }
    }

    fn moved(x: f32) -> Event {
        Event::PointerMoved(pos2(x, 0.0))
    }

    #[test]
    fn a_press_a_release_and_where_the_pointer_went_are_frames_of_their_own() {
        let all = [moved(1.0), button(1.0, true), moved(2.0), button(2.0, false), Event::Copy, moved(3.0)];
        let mut left = all.to_vec();
        let mut frames = Vec::new();
        while !left.is_empty() {
            let later = after_first(&mut left);
            frames.push(std::mem::replace(&mut left, later));
        }
        assert_eq!(frames.len(), 3);
        assert_eq!(frames.concat(), all, "no event is lost, and none overtakes another");
        for frame in &frames {
            let buttons = frame.iter().filter(|event| matches!(event, Event::PointerButton { .. })).count();
            assert!(buttons <= 1);
        }
        assert_eq!(frames[0].last(), Some(&button(1.0, true)), "a press is where the pointer was");
    }

    #[test]
    fn frames_without_buttons_or_with_one_at_the_end_stay_whole() {
        for whole in [vec![], vec![moved(1.0), moved(2.0)], vec![moved(1.0), button(1.0, true)]] {
            let mut events = whole.clone();
            assert_eq!((after_first(&mut events), events), (Vec::new(), whole));
        }
    }

    /// A click acts on the widget where it happened, even if the pointer moves on within the same frame.
    #[test]
    fn a_click_lands_where_it_was_pressed() {
        let ctx = egui::Context::default();
        let mut clicked = [false; 2];
        let mut frame = |events: Vec<Event>| {
            let screen = egui::Rect::from_min_size(pos2(0.0, 0.0), egui::vec2(200.0, 100.0));
            let input = egui::RawInput { screen_rect: Some(screen), events, ..Default::default() };
            let mut output = ctx.run_ui(input, |ui| {
                for (i, left) in [0.0, 100.0].into_iter().enumerate() {
                    let place = egui::Rect::from_min_size(pos2(left, 0.0), egui::vec2(90.0, 50.0));
                    let response = ui.interact(place, egui::Id::unique(("place", i)), egui::Sense::click());
                    clicked[i] |= response.clicked();
                }
            });
            output.textures_delta.clear();
        };
        frame(vec![]);
        let mut left = vec![moved(50.0), button(50.0, true), button(50.0, false), moved(150.0)];
        while !left.is_empty() {
            let later = after_first(&mut left);
            frame(std::mem::replace(&mut left, later));
        }
        assert_eq!(clicked, [true, false]);
    }
}
