//! Panel section of the result: status, iterations, errors, certificate, times.

use super::*;
use crate::app::diagnosis::{DRIFT_TIP, drift, drift_text, error_tip, errors, load_text, rho, stability, state_text};
use crate::app::session::clock::fraction;
use crate::study::rho_text;

/// Width of the names of the rows, points.
const NAME_WIDTH: f32 = 84.0;

pub(super) fn summary(session: &Session) -> String {
    let moves = session.simulation().motion().is_some();
    tr(if moves { "energy, steps, times" } else { "stability, reactions, times" }).to_owned()
}

pub(super) fn show(ui: &mut Ui, session: &Session) {
    let simulation = session.simulation();
    ui.spacing_mut().item_spacing.y = 3.0;
    let mut row = |name: &str, value: String, tip: &str| {
        let (name, tip) = (tr(name), tr(tip));
        ui.horizontal_top(|ui| {
            let left = ui.cursor().left();
            let label = ui.label(RichText::new(name).small().weak()).on_hover_text(tip);
            ui.add_space((left + NAME_WIDTH - label.rect.right() - ui.spacing().item_spacing.x).max(0.0));
            ui.add(Label::new(RichText::new(value).size(13.0)).wrap()).on_hover_text(tip);
        });
    };
    if let Some(motion) = simulation.motion() {
        motion_rows(&mut row, session, motion);
        displacement_rows(&mut row, simulation);
        frame_row(&mut row, session, ("Step", "Computing time of a time step"));
    } else {
        search_rows(&mut row, session);
    }
}

fn search_rows(row: &mut ResultRow<'_>, session: &Session) {
    // All values are those of the drawn body.
    let simulation = session.drawn();
    let method = simulation.scene().solver.method;
    if let Some(state) = state_text(session) {
        row("State", state, "State of the body that is drawn");
    }
    let (n, residual) = (simulation.iterations(), format!("{:.2e}", simulation.residual()));
    let is_fallback = session.fallback().is_some();
    let text = match is_fallback {
        true => fill!("%{n} to the state that is drawn, residual %{residual}", n, residual),
        false => fill!("%{n} since the last change, residual %{residual}", n, residual),
    };
    let tip = "Iterations since the last change, from the state before it; the status has those from rest. Residual: \
               out-of-balance force over the sum of the elements' absolute forces";
    row("Iterations", text, tip);
    displacement_rows(row, simulation);
    let text =
        errors(session).own.zip(session.known_reference().and_then(Reference::first)).map(|(error, reference)| {
            let whole = engineering(reference.displacement.norm(), "m");
            let own = percent(reference.own_error_percent);
            fill!("%{error} ± %{own} of %{whole}", error = percent(error), own, whole)
        });
    row("Error", known(text), &error_tip(session.known_reference(), session.reference_failure()));
    quality_rows(row, session);
    let Some(search) = simulation.equilibrium() else { return };
    let (factor, steps) = (search.load_factor(), search.load_steps());
    if steps > 1 || factor != 1.0 {
        let part = percent(100.0 * factor);
        let text =
            if factor == 1.0 { steps.to_string() } else { fill!("%{n}, at %{part} of the load", n = steps, part) };
        row("Load steps", text, "Number of steps in which the load is applied");
    }
    let word = stability(simulation).map_or(UNKNOWN, |stable| if stable { "stable" } else { "unstable" });
    row("Equilibrium", tr(word).to_owned(), "Stable if the exact tangent stiffness A + G is positive definite");
    if method == MethodKind::Warped {
        let own = || search.certificate()?.fixed_point_rho;
        let rho = if is_fallback { own() } else { rho(session) };
        let text = rho.filter(|_| simulation.status().is_success()).map(|rho| {
            let text = sentence(&said(&rho_text(rho)));
            let load = load_text(session.drawn().scene()).filter(|_| is_fallback);
            load.map_or(text.clone(), |load| fill!("At %{load}: %{text}", load, text))
        });
        let tip = "ρ: spectral radius of the warped iteration where the solve ended, the largest |λ| with G v = λ A v";
        row("ρ", known(text), tip);
    }
    // The energy is a sum over all elements, which is too expensive for every frame of a motion.
    if simulation.is_at_rest() {
        let energy = simulation.problem().elastic_energy(simulation.state());
        row("Energy", engineering(energy, "J"), "Elastic energy stored in the body");
        supports::reaction_rows(row, simulation);
    }
    if let Some(auto) = search.auto_report() {
        let [solves, factors] = [count(auto.solves, "back substitution"), count(auto.factorizations, "factorization")];
        let error = match auto.estimated_error {
            error if error.is_finite() => Some(fill!("Estimated error %{error}", error = percent(100.0 * error))),
            _ => None,
        };
        let tip = joined(error.into_iter().chain([solves, factors]));
        row("Auto", sentence(&said(&auto.decision)), &tip);
    }
    frame_row(row, session, ("Frame", "Computing time of the iterations of one displayed frame"));
}

/// Returns a text, or the sign for an unknown number.
fn known(text: Option<String>) -> String {
    text.unwrap_or_else(|| UNKNOWN.to_owned())
}

/// Function that shows a row of the result: name, value, and tooltip.
type ResultRow<'a> = dyn FnMut(&str, String, &str) + 'a;

fn displacement_rows(row: &mut ResultRow<'_>, simulation: &Simulation) {
    /// Largest number of probes that are shown.
    const MAX_PROBES: usize = 8;
    for probe in simulation.problem().probes().iter().take(MAX_PROBES) {
        let u = probe.mean(simulation.displacement());
        row(&format!("{} Δx, Δy", tr(&probe.name)), engineering_pair(u.into(), "m"), "Displacement of the probe");
    }
    row("Area", signed_percent(simulation.area_change()), "Change of the body\u{2019}s area, compared with rest");
}

/// Shows the estimated mesh error, the largest stress and the largest strain.
fn quality_rows(row: &mut ResultRow<'_>, session: &Session) {
    let quality = &session.model.quality;
    let is_known = session.drawn().status().is_success() && quality.is_of(session.drawn());
    let error = quality.stress.mesh_error_percent.filter(|_| is_known);
    let text = known(error.map(|error| fill!("%{error} (estimate)", error = percent(error))));
    let tip = "Error of the mesh alone, in the energy norm: the elements' stresses compared with those recovered at \
               the nodes";
    row("Error in energy", text, tip);
    let text = quality.stress.largest.filter(|_| is_known).map(|(node, von_mises)| {
        let stress = engineering(three_digits(von_mises), "Pa");
        let place = engineering_pair(session.drawn().mesh().node(node).into(), "m");
        match quality.stress.singularity {
            Some(_) => fill!("%{stress} at %{place}; depends on the mesh", stress, place),
            None => fill!("%{stress} at %{place}", stress, place),
        }
    });
    let tip = tr("Largest von Mises stress (Cauchy), and its point at rest; no yielding is modelled").to_owned();
    let tip = std::iter::once(tip).chain(quality.stress.singularity.as_ref().map(said)).collect::<Vec<_>>().join("; ");
    row("Stress", known(text), &tip);
    let strain = engineering(three_digits(100.0 * quality.deformation.max_strain), "%");
    let warnings: Vec<String> = quality.warnings().filter(|_| is_known).map(|warning| said(&warning)).collect();
    let text = match (is_known, warnings.is_empty()) {
        (false, _) => UNKNOWN.to_owned(),
        (true, true) => strain,
        (true, false) => fill!("%{strain}: too large", strain),
    };
    let tip = std::iter::once(tr("The largest principal strain").to_owned()).chain(warnings);
    let tip = tip.collect::<Vec<_>>().join("; ");
    row("Strain", text, &tip);
}

fn frame_row(row: &mut ResultRow<'_>, session: &Session, (name, what): (&str, &str)) {
    let unknowns = count(session.simulation().system().dofs() as u64, "unknown");
    let time = engineering(three_digits(session.frame.timings.total().as_secs_f64()), "s");
    row(name, joined([time, unknowns]), what);
}

/// Shows time, real-time factor, steps and energy of a motion.
fn motion_rows(row: &mut ResultRow<'_>, session: &Session, motion: Motion<'_>) {
    row("Time", format!("{:.2} s", session.simulation().state().time()), "Simulated time");
    let clock = &session.playback.clock;
    let factor = match clock.factor {
        Some(factor) if clock.lags() => fill!("%{factor} of real time: slower than asked", factor = fraction(factor)),
        Some(factor) => fill!("%{factor} of real time", factor = fraction(factor)),
        None => UNKNOWN.to_owned(),
    };
    let tip = "Simulated seconds per second; fewer than requested if the machine cannot keep up";
    row("Speed", factor, tip);
    let counts = motion.counts();
    let halvings = (counts.halvings > 0).then(|| count(counts.halvings, "halving"));
    let text =
        joined([counts.steps.to_string(), count(counts.solves, "back substitution")].into_iter().chain(halvings));
    row("Steps", text, "Time steps since the start; a step that does not converge is halved");
    if let Some(decision) = motion.decision() {
        let factors = count(counts.factorizations, "factorization");
        let linear = count(counts.linear_steps, "step");
        let tip = fill!(
            "%{factors} for %{solves}; %{linear} under linear theory",
            factors,
            solves = count(counts.solves, "back substitution"),
            linear
        );
        row("Auto", sentence(&said(&decision)), &tip);
    }
    let ledger = motion.ledger();
    let joules = |value: f64| engineering(value, "J");
    row("Kinetic", joules(ledger.kinetic), "Kinetic energy");
    row("Elastic", joules(ledger.elastic), "Energy stored in the body");
    let drift = drift(session.simulation());
    row("Drift", known(drift.map(drift_text)), DRIFT_TIP);
    if let Some((_, force)) = session.simulation().mouse_spring() {
        row("Grab", engineering(force.norm(), "N"), "Force of the mouse spring that pulls the body");
    }
}
