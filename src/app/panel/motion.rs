//! Panel section of a motion: integrator, time step, solves per step, damping and speed.

use super::*;

/// Selectable speeds with their labels.
const SPEEDS: [(f64, &str); 7] = [
    (1.0, "1"),
    (0.5, "1/2"),
    (0.25, "1/4"),
    (0.125, "1/8"),
    (1.0 / 32.0, "1/32"),
    (1.0 / 128.0, "1/128"),
    (1e-3, "1/1000"),
];

/// Rows of time step, solves per step and damping.
const TIME: [NumberRow; 4] = [
    NumberField::new("Time step", keys::range("dynamics.time_step"), 1e-4..=0.1)
        .logarithmic(1e-4)
        .tip(
            "Length of a time step, s. Half the step takes twice the work and, at second order, has a quarter of the \
             error.",
        )
        .row(|s| s.dynamics.time_step, |s, v| s.dynamics.time_step = v),
    NumberField::new("Solves per stage", limits::Limit { unit: "", min: 0.0, max: 20.0 }, 0.0..=4.0)
        .whole()
        .tip("Linear solves per stage of a time step; 0: as many as the tolerance needs.")
        .row(|s| f64::from(s.dynamics.iterations), |s, v| s.dynamics.iterations = v as u32),
    NumberField::new("Mass damping α", keys::range("dynamics.damping.mass"), 0.0..=10.0)
        .logarithmic(1e-3)
        .tip(
            "Mass-proportional (Rayleigh) damping α, 1/s: damps every motion, also of a rigid body. Amplitudes of \
             vibrations fall by a factor e in 2/α seconds.",
        )
        .row(|s| s.dynamics.damping.mass, |s, v| s.dynamics.damping.mass = v),
    NumberField::new("Stiffness damping β", keys::range("dynamics.damping.stiffness"), 0.0..=1.0)
        .logarithmic(1e-5)
        .tip(
            "Stiffness-proportional (Rayleigh) damping β, s: damps vibrations, high frequencies most; a rigid rotation \
             is not damped.",
        )
        .row(|s| s.dynamics.damping.stiffness, |s, v| s.dynamics.damping.stiffness = v),
];

pub(super) fn summary(scene: &Scene) -> String {
    joined([tr(scene.dynamics.integrator.id()), &engineering(scene.dynamics.time_step, "s")])
}

pub(super) fn show(ui: &mut Ui, panel: &mut Panel<'_>) {
    let (session, settings) = (panel.session, &panel.scene.dynamics);
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        ui.label(tr("Speed"));
        let tip = "Simulated seconds per second: 1 is real time, less is slow motion";
        let speeds = SPEEDS.map(|(speed, word)| (speed, word, tip));
        panel.actions.extend(options(ui, speeds, Some(session.playback.clock.speed)).map(Action::Speed));
    });
    let chosen = settings.integrator.entry();
    let entries = INTEGRATORS.iter().map(|entry| (entry.kind, entry.id, entry.about));
    panel.picker(ui, "Integrator", (chosen.id, chosen.about), entries, |scene, kind| scene.dynamics.integrator = kind);
    panel.rows(ui, TIME);
    if let Some(critical) = session.simulation().motion().and_then(crate::simulation::Motion::critical_step) {
        let text = fill!("The critical time step near rest is %{step}.", step = engineering(critical, "s"));
        if settings.time_step <= critical {
            ui.small(text);
            return;
        }
        ui.horizontal_wrapped(|ui| {
            ui.colored_label(ui.visuals().error_fg_color, text);
            if ui.button(tr("Use 0.9 of it")).clicked() {
                panel.edit("Time step", |scene| scene.dynamics.time_step = three_digits(0.9 * critical));
            }
        });
    }
}
