//! Card of locking: the same beam with every element, one button each.

use super::*;

/// Shows one button per element.
pub(super) fn show(ui: &mut Ui, scene: &Scene, actions: &mut Vec<Action>) {
    for element in scene.elements() {
        let chosen = scene.element() == element;
        let button = ui.add(Button::selectable(chosen, RichText::new(element.id()).size(16.0)));
        if button.clicked() && !chosen {
            actions.push(Action::edit("Element", scene, |scene| scene.set_element(element)));
        }
        ui.add(Label::new(RichText::new(tr(element.entry().about)).small().weak()).wrap());
        ui.add_space(2.0);
    }
}
