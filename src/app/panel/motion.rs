//! Panel section of a motion: integrator, time step, solves per step, damping, speed, and the other integrators for
//! comparison.

use egui::Ui;

use crate::app::language::{fill, joined, tr};
use crate::app::panel::{Action, NumberRow, PanelState, number_rows, picker};
use crate::app::readout::Readout;
use crate::app::session::clock::{fraction, speed_of_period};
use crate::app::widgets::buttons::option_button;
use crate::app::widgets::number_field::{NumberField, SliderScale, show_message};
use crate::dynamics::INTEGRATORS;
use crate::format::{engineering, three_digits};
use crate::scene::limits;

/// Selectable speeds with their labels.
const SPEEDS: [(f64, &str); 4] = [(1.0, "1"), (0.5, "1/2"), (0.25, "1/4"), (0.125, "1/8")];

/// Rows of time step, solves per step and damping.
const TIME: [NumberRow; 4] = [
    NumberRow {
        field: NumberField {
            label: "Time step",
            tooltip: "Length of a time step, s. Half the step takes twice the work and, at second order, has a \
                      quarter of the error.",
            limit: limits::TIME_STEP,
            slider: 1e-4..=0.1,
            scale: SliderScale::Logarithmic(1e-4),
            whole: false,
        },
        get: |s| s.dynamics.time_step,
        set: |s, v| s.dynamics.time_step = v,
    },
    NumberRow {
        field: NumberField {
            label: "Solves per stage",
            tooltip: "Linear solves per stage of a time step; 0: as many as the tolerance needs.",
            limit: limits::Limit { unit: "", min: 0.0, max: 20.0 },
            slider: 0.0..=4.0,
            scale: SliderScale::Linear,
            whole: true,
        },
        get: |s| f64::from(s.dynamics.iterations),
        set: |s, v| s.dynamics.iterations = v as u32,
    },
    NumberRow {
        field: NumberField {
            label: "Mass damping α",
            tooltip: "Mass-proportional (Rayleigh) damping α, 1/s: damps every motion, also of a rigid body. \
                      Amplitudes of vibrations fall by a factor e in 2/α seconds.",
            limit: limits::MASS_DAMPING,
            slider: 0.0..=10.0,
            scale: SliderScale::Logarithmic(1e-3),
            whole: false,
        },
        get: |s| s.dynamics.damping.mass,
        set: |s, v| s.dynamics.damping.mass = v,
    },
    NumberRow {
        field: NumberField {
            label: "Stiffness damping β",
            tooltip: "Stiffness-proportional (Rayleigh) damping β, s: damps vibrations, high frequencies most; a \
                      rigid rotation is not damped.",
            limit: limits::STIFFNESS_DAMPING,
            slider: 0.0..=1.0,
            scale: SliderScale::Logarithmic(1e-5),
            whole: false,
        },
        get: |s| s.dynamics.damping.stiffness,
        set: |s, v| s.dynamics.damping.stiffness = v,
    },
];

/// Returns a summary of integrator and time step.
pub(super) fn summary(input: &Readout<'_>) -> String {
    let settings = &input.scene.dynamics;
    joined([tr(settings.integrator.id()), &engineering(settings.time_step, "s")])
}

pub(super) fn show(ui: &mut Ui, input: &Readout<'_>, state: &mut PanelState, actions: &mut Vec<Action>) {
    let settings = &input.scene.dynamics;
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        ui.label(tr("Speed"));
        let mut button = |speed: f64, word: &str, tip: &str| {
            let chosen = (input.playback.clock.speed() - speed).abs() < 1e-9;
            if ui.add(option_button(chosen, word)).on_hover_text(tip).clicked() {
                actions.push(Action::Speed(speed));
            }
        };
        for (speed, word) in SPEEDS {
            button(speed, word, tr("Simulated seconds per second: 1 is real time, less is slow motion"));
        }
        if let Some((frequency, speed)) = input.frequency.and_then(|f| Some((f, speed_of_period(f)?))) {
            let frequency = engineering(three_digits(frequency), "Hz");
            let tip =
                fill!("One period of the lowest natural frequency, %{frequency}, per second", frequency = frequency);
            button(speed, &fraction(speed), &tip);
        }
    });
    let chosen = settings.integrator.entry();
    let entries = INTEGRATORS.iter().map(|entry| (entry.id, entry.about));
    let picked = picker(ui, "Integrator", (chosen.id, chosen.about), entries);
    if let Some(entry) = INTEGRATORS.iter().find(|entry| Some(entry.id) == picked) {
        let mut scene = Box::new(input.scene.clone());
        scene.dynamics.integrator = entry.kind;
        actions.push(Action::Edit("Integrator", scene));
    }
    show_message(ui, &state.messages, "Integrator");
    ui.horizontal_wrapped(|ui| {
        ui.label(tr("Compare integrators"))
            .on_hover_text(tr("The same motion with other integrators: outlines in the view, lines in the plots"));
        for entry in INTEGRATORS.iter().filter(|entry| entry.kind != settings.integrator) {
            let is_shown = input.playback.companions().iter().any(|c| c.integrator == entry.kind);
            if ui.add(option_button(is_shown, tr(entry.id))).on_hover_text(tr(entry.about)).clicked() {
                actions.push(Action::Compare(entry.kind));
            }
        }
    });
    number_rows(ui, input, state, actions, TIME);
    if let Some(critical) = input.simulation.motion().and_then(crate::simulation::Motion::critical_step) {
        let text = fill!("The critical time step near rest is %{step}.", step = engineering(critical, "s"));
        if settings.time_step > critical {
            let set = |step: f64| {
                let mut scene = Box::new(input.scene.clone());
                scene.dynamics.time_step = step;
                Action::Edit("Time step", scene)
            };
            ui.horizontal_wrapped(|ui| {
                ui.colored_label(ui.visuals().error_fg_color, text);
                if ui.button(tr("Use 0.9 of it")).clicked() {
                    actions.push(set(three_digits(0.9 * critical)));
                }
            });
        } else {
            ui.small(text);
        }
    }
}
