//! Material, mesh, element, method.

use egui::{ComboBox, Ui};

use super::{Action, PanelInput, PanelState, number_row};
use crate::app::action::MOST_ITERATIONS;
use crate::app::field::{NumberField, show_message};
use crate::method::METHODS;
use crate::scene::{Analysis, Plane, Scene, limits};

pub(super) fn material(ui: &mut Ui, scene: &Scene, state: &mut PanelState, actions: &mut Vec<Action>) {
    let mut row = |field: NumberField, value: f64, set: fn(&mut Scene, f64)| {
        number_row(ui, scene, state, actions, (field, value), set);
    };
    let m = &scene.material;
    row(
        NumberField {
            label: "Young E",
            tooltip: "Young's modulus, Pa: the stiffness. Rubber 1e6, wood 1e10, steel 2e11.",
            limit: limits::YOUNG,
            slider: 1e3..=1e12,
            logarithmic: Some(1e3),
            whole: false,
        },
        m.young,
        |s, v| s.material.young = v,
    );
    row(
        NumberField {
            label: "Poisson ν",
            tooltip: "Poisson ratio: how much it thins when pulled. 0.5 keeps the volume; plane strain stops before it.",
            limit: m.plane.poisson_limit(),
            slider: -0.5..=0.499,
            logarithmic: None,
            whole: false,
        },
        m.poisson,
        |s, v| s.material.poisson = v,
    );
    row(
        NumberField {
            label: "Density ρ",
            tooltip: "Density, kg/m³: weight, and inertia in motion.",
            limit: limits::DENSITY,
            slider: 0.0..=20_000.0,
            logarithmic: Some(1.0),
            whole: false,
        },
        m.density,
        |s, v| s.material.density = v,
    );
    row(
        NumberField {
            label: "Thickness t",
            tooltip: "Thickness out of the plane, m: stiffness and weight grow with it.",
            limit: limits::THICKNESS,
            slider: 1e-3..=10.0,
            logarithmic: Some(1e-3),
            whole: false,
        },
        m.thickness,
        |s, v| s.material.thickness = v,
    );
    ui.horizontal(|ui| {
        ui.label("Plane");
        for (plane, word, tip) in [
            (Plane::Stress, "stress", "No stress out of the plane: a thin plate."),
            (Plane::Strain, "strain", "No strain out of the plane: a slice of something long."),
        ] {
            if ui.radio(m.plane == plane, word).on_hover_text(tip).clicked() && m.plane != plane {
                let mut scene = Box::new(scene.clone());
                scene.material.plane = plane;
                actions.push(Action::Edit("Plane", scene));
            }
        }
    });
    show_message(ui, &state.messages, "Plane");
}

pub(super) fn mesh_and_method(ui: &mut Ui, input: &PanelInput<'_>, state: &mut PanelState, actions: &mut Vec<Action>) {
    let scene = input.scene;
    for (axis, label, tooltip, most) in [
        (0, "Cells along", "Cells along the beam; each is two triangles or a quadrilateral.", 400.0),
        (1, "Cells across", "Cells across the beam; each is two triangles or a quadrilateral.", 40.0),
    ] {
        let field = NumberField {
            label,
            tooltip,
            limit: limits::CELLS,
            slider: 1.0..=most,
            logarithmic: Some(1.0),
            whole: true,
        };
        let Some(beam) = &scene.beam else { continue };
        if let Some(new) = field.show(ui, &mut state.messages, f64::from(beam.cells[axis])) {
            let mut scene = Box::new(scene.clone());
            if let Some(beam) = &mut scene.beam {
                beam.cells[axis] = new as u32;
            }
            actions.push(Action::Edit(label, scene));
        }
    }
    ui.horizontal(|ui| {
        let label = ui.label("Method");
        ComboBox::from_id_salt("method")
            .selected_text(scene.solver.method.id())
            .show_ui(ui, |ui| {
                for entry in METHODS {
                    let selected = entry.kind == scene.solver.method;
                    if ui.selectable_label(selected, entry.kind.id()).on_hover_text(entry.about).clicked() && !selected
                    {
                        let mut scene = Box::new(scene.clone());
                        scene.solver.method = entry.kind;
                        actions.push(Action::Edit("Method", scene));
                    }
                }
            })
            .response
            .labelled_by(label.id)
            .on_hover_text(scene.solver.method.entry().about);
    });
    show_message(ui, &state.messages, "Method");
    ui.horizontal(|ui| {
        ui.label("Element");
        for element in scene.elements() {
            let selected = scene.element() == element;
            if ui.radio(selected, element.id()).on_hover_text(element.entry().about).clicked() && !selected {
                let mut scene = Box::new(scene.clone());
                scene.set_element(element);
                actions.push(Action::Edit("Element", scene));
            }
        }
    });
    show_message(ui, &state.messages, "Element");
    if scene.analysis == Analysis::Dynamic {
        return;
    }
    let field = NumberField {
        label: "Per frame",
        tooltip: "Iterations a displayed frame: more converge in fewer frames, which take longer.",
        limit: limits::Limit { unit: "", min: 1.0, max: f64::from(MOST_ITERATIONS) },
        slider: 1.0..=20.0,
        logarithmic: None,
        whole: true,
    };
    if let Some(new) = field.show(ui, &mut state.messages, f64::from(input.iterations)) {
        actions.push(Action::Iterations(new as u32));
    }
}
