//! Panel section of the display options.

use super::*;

pub(super) fn options(ui: &mut Ui, panel: &mut Panel<'_>) {
    let shown = panel.view.field;
    combo(ui, "Colour", tr(shown.name()), "The quantity the body is coloured with", None, |ui| {
        for (i, field) in Field::ALL.into_iter().enumerate() {
            // A line between stresses, strains, displacements and the rest.
            let before = i.checked_sub(1).and_then(|before| Field::ALL.get(before));
            if before.is_some_and(|before| before.unit() != field.unit()) {
                ui.separator();
            }
            if ui.selectable_label(field == shown, tr(field.name())).clicked() {
                panel.actions.push(Action::Color(field));
            }
        }
    });
    let values = panel.values;
    let mut fixed = panel.view.fixed_range.is_some();
    let tip = tr("Keep the ends of the colour map fixed; otherwise they follow the values");
    if ui.checkbox(&mut fixed, tr("Fixed colour range")).on_hover_text(tip).changed() {
        panel.view.fixed_range = fixed.then_some(values);
    }
    if let Some(range) = panel.view.fixed_range {
        let (factor, unit) = shown.display_unit();
        // The range of the current values, extended by half its width at both ends. It does not depend on the fixed
        // range, so the slider does not change while it is dragged.
        let [low, high] = values.map(|end| factor * end);
        let span = high - low;
        for (end, label) in ["Lowest", "Highest"].into_iter().enumerate() {
            let limit = limits::Limit { unit, min: -1e30, max: 1e30 };
            let field =
                NumberField::new(label, limit, low - 0.5 * span..=high + 0.5 * span).tip("Limit of the colour map");
            let Some(new) = panel.number(ui, &field, factor * range[end], None) else { continue };
            let mut changed = range;
            changed[end] = new / factor;
            // The middle colour of a field with a sign stays at 0.
            if shown.has_sign() {
                let largest = changed[end].abs();
                changed = [-largest, largest];
            }
            if changed[0] < changed[1] {
                panel.view.fixed_range = Some(changed);
            } else {
                let reason = match shown.has_sign() {
                    true => sentence!("expected a value other than 0: the colours are symmetric about 0"),
                    false => sentence!("expected the lowest value below the highest"),
                };
                panel.state.messages.insert(label, reason);
            }
        }
    }
    magnification(ui, panel);
    let view = &mut *panel.view;
    ui.horizontal_wrapped(|ui| {
        let tip = "Each element's own values, not smoothed at the nodes: they jump where the mesh is coarse";
        ui.checkbox(&mut view.raw, tr("Each element alone")).on_hover_text(tr(tip));
        ui.checkbox(&mut view.lines.wireframe, tr("Wireframe")).on_hover_text(tr("Element edges (W)"));
        ui.checkbox(&mut view.lines.rest_outline, tr("Rest")).on_hover_text(tr("Outline of the body at rest (O)"));
        if panel.scene.analysis == Analysis::Dynamic {
            ui.checkbox(&mut view.lines.trail, tr("Trail")).on_hover_text(tr("Path of the tip (Y)"));
        } else {
            let tip = "Outline of the reference solution, where it is known (X)";
            ui.checkbox(&mut view.lines.exact, tr("Reference")).on_hover_text(tr(tip));
            ui.checkbox(&mut view.lines.ghost, tr("Linear")).on_hover_text(tr("Outline of the linear solution (G)"));
        }
        if ui.button(tr("Fit")).on_hover_text(tr("Show the whole body (F)")).clicked() {
            panel.actions.push(Action::Fit);
        }
    });
}

fn magnification(ui: &mut Ui, panel: &mut Panel<'_>) {
    let names = [
        (Magnification::None, "True scale"),
        (Magnification::Automatic, "Automatic"),
        (Magnification::Factor(10.0), "Factor"),
    ];
    let present = panel.view.magnification;
    let is_same = |a: Magnification| std::mem::discriminant(&a) == std::mem::discriminant(&present);
    let chosen = names.iter().find(|(own, _)| is_same(*own)).map_or("", |(_, name)| name);
    let tip = "Draws the body with a multiple of its displacement; it cannot be grabbed then";
    combo(ui, "Displacement", tr(chosen), tip, None, |ui| {
        for (own, name) in names {
            if ui.selectable_label(is_same(own), tr(name)).clicked() && !is_same(own) {
                panel.view.magnification = own;
            }
        }
    });
    if let Magnification::Factor(factor) = panel.view.magnification {
        let field = NumberField::new("Magnification", Magnification::LIMIT, 1.0..=1e4).logarithmic(1.0);
        if let Some(factor) = panel.number(ui, &field.tip("Factor of the drawn displacement"), factor, None) {
            panel.view.magnification = Magnification::Factor(factor);
        }
    }
}

pub(super) fn summary(view: &ViewOptions, scene: &Scene) -> String {
    let moves = scene.analysis == Analysis::Dynamic;
    let name = tr(view.field.name());
    // Drops a remark in brackets or after a comma from the field's name.
    let field = name.split([',', '(', '，', '（']).next().unwrap_or(name).trim_end();
    let shown = [
        (view.lines.rest_outline, "rest"),
        (view.lines.exact && !moves, "reference"),
        (view.lines.ghost && !moves, "linear"),
        (view.lines.trail && moves, "trail"),
    ];
    let shown = shown.into_iter().filter(|(on, _)| *on).map(|(_, word)| tr(word));
    joined(std::iter::once(field).chain(shown))
}

/// Shows the name and the description of the scene, and the buttons that open, save and copy.
pub(super) fn keep(ui: &mut Ui, panel: &mut Panel<'_>) {
    const SAVE_AS: &str =
        "Save the scene to another file; `warpbeam record FILE -o FILE.gif` makes a GIF of it (Ctrl+Shift+S)";
    let scene = panel.scene;
    type Part = fn(&mut Scene) -> &mut String;
    let parts: [(&str, &String, Part); 2] =
        [("Name", &scene.name, |scene| &mut scene.name), ("Description", &scene.about, |scene| &mut scene.about)];
    for (label, own, part) in parts {
        let id = Id::unique((label, "of the scene"));
        // The text while it is typed.
        let typed: Option<String> = ui.data(|data| data.get_temp(id));
        let mut text = typed.unwrap_or_else(|| tr(own).to_owned());
        let field = |ui: &mut Ui| {
            let name = ui.label(tr(label));
            ui.add(TextEdit::singleline(&mut text).desired_width(f32::INFINITY)).labelled_by(name.id)
        };
        let response = ui.horizontal(field).inner;
        if response.lost_focus() && text != tr(own) {
            panel.edit(label, |scene| part(scene).clone_from(&text));
        }
        let is_typed = response.has_focus();
        ui.data_mut(|data| match is_typed {
            true => _ = data.insert_temp(id, text),
            false => data.remove::<String>(id),
        });
    }
    ui.horizontal_wrapped(|ui| {
        for (name, tip, action) in [
            ("Open…", "Open a scene file; one can also be dropped on the window (Ctrl+O)", Action::OpenFile),
            ("Save", "Save the scene to its file (Ctrl+S)", Action::Save),
            ("Save as…", SAVE_AS, Action::SaveAs),
            ("Screenshot", "Save a screenshot as a PNG file in the current folder (S)", Action::Screenshot),
            ("Copy as TOML", "Copy the scene as TOML, with the command that solves it (C)", Action::Copy),
            ("Copy link", "Copy the address of this page with the whole scene in it (U)", Action::CopyLink),
        ] {
            let tip = with_keys(ui.ctx(), tr(tip));
            if action.is_available() && ui.button(tr(name)).on_hover_text(tip).clicked() {
                panel.actions.push(action);
            }
        }
    });
}
