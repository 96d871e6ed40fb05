//! Diagnosis of a result: its error and the source of the error, its status in words, and edits that would improve it.

use crate::app::interface::*;
use crate::app::session::facts::first_probe;
use crate::app::session::object_name;
use crate::exact_beam::error_percent;
use crate::format;
use crate::stress::strain_warning;
use crate::study::{Claim, FOLDS, MovedPoint, ProbeReference, moved_points};

/// Definition of the energy drift, as shown in the user interface.
pub(crate) const DRIFT_TIP: &str = "Energy added by the integrator (negative: lost), over the energy put in by the \
                                    initial state, loads and grabs";

/// Returns the energy drift of a motion relative to the energy put in; `None` at rest, and of a motion that has stopped,
/// whose energies have no meaning.
pub(crate) fn drift(simulation: &Simulation) -> Option<f64> {
    let motion = simulation.motion().filter(|_| !matches!(simulation.status(), Status::Stopped(_)))?;
    Some(motion.ledger().drift_of_input())
}

/// Formats an energy drift with its sign; rounding errors are 0.
pub(crate) fn drift_text(drift: f64) -> String {
    /// Largest drift, percent, that is a rounding error.
    const ROUNDING: f64 = 1e-6;
    let drift = 100.0 * drift;
    if drift.abs() < ROUNDING { "0 %".to_owned() } else { percent(drift) }
}

/// Main source of an error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ErrorSource {
    Mesh,
    Theory,
    /// Mesh or iteration, of a result that was accepted before it converged.
    MeshOrIteration,
}

impl ErrorSource {
    pub(crate) fn word(self) -> &'static str {
        match self {
            Self::Mesh => "mesh",
            Self::Theory => "theory",
            Self::MeshOrIteration => "mesh or iteration",
        }
    }
}

/// Errors at the first probe, percent of the reference displacement; `None` if not known.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Errors {
    pub own: Option<f64>,
    /// The error with the largest error of the reference added.
    pub bound: Option<f64>,
    pub linear: Option<f64>,
    pub source: Option<ErrorSource>,
}

/// Compares the state, and the state of linear theory, with the reference solution. Returns no errors while the body
/// moves or is grabbed: the reference solution holds for equilibrium only.
pub(crate) fn errors(session: &Session) -> Errors {
    let simulation = session.simulation();
    let at_rest = simulation.is_at_rest() && simulation.mouse_spring().is_none();
    let Some(reference) = session.known_reference().filter(|_| at_rest) else { return Errors::default() };
    let Some(first) = reference.first() else { return Errors::default() };
    // A reference that is behind the load belongs to the body that it was asked for.
    let behind = session.live().filter(|live| !live.is_of(session.scene()));
    let percent_of = |u: Option<Vector2<f64>>| Some((error_percent(u?, first.displacement)?, u?));
    // A state that is not drawn, diverges, or is not the one to which loading from rest leads, has no error to show.
    let is_elsewhere = session.path().is_some_and(|path| path.elsewhere.is_some());
    let own = percent_of(behind.map_or_else(|| first_probe(simulation), |behind| behind.own))
        .filter(|_| session.fallback().is_none() && !is_elsewhere);
    let source = own.filter(|(error, _)| format::percent(*error) != format::percent(0.0)).map(|(_, u)| {
        let theory = reference.linear.filter(|_| simulation.is_linear());
        let [of_theory, of_mesh] =
            theory.map_or([0.0, 1.0], |fine| [(fine - first.displacement).norm(), (u - fine).norm()]);
        // Where the errors of mesh and theory cancel, a finer mesh leaves the larger one.
        let whole = (u - first.displacement).norm();
        match simulation.status() {
            _ if of_theory > of_mesh.min(whole) => ErrorSource::Theory,
            Status::Accepted => ErrorSource::MeshOrIteration,
            _ => ErrorSource::Mesh,
        }
    });
    let linear = behind.map_or_else(|| session.linear().and_then(first_probe), |behind| behind.linear);
    let linear = percent_of(linear).map(|(error, _)| error);
    let own = own.map(|(error, _)| error);
    Errors { own, bound: own.map(|error| first.error_bound(error)), linear, source }
}

/// Errors above this value, percent, are large: they need a remedy.
const LARGE_ERROR: f64 = 5.0;

/// Ratio of the reference's own error to a large error above which both are stated.
const COARSE: f64 = 0.25;

/// Returns sentences about cuts through the mesh, about points that act on a node, and about held points too close to
/// others, with the numbers of loads and supports in the panel.
fn notes_on_mesh(simulation: &Simulation) -> Vec<Sentence> {
    let moved = moved_points(simulation.scene(), simulation.mesh());
    let moved = moved.into_iter().map(|point| Sentence::from(&MovedPoint { key: object_name(&point.key), ..point }));
    let crowded = simulation.system().crowded_supports(|i| object_name(&format!("support.{i}")));
    simulation.system().seams().iter().cloned().chain(moved).chain(crowded).collect()
}

/// Returns a strain in words if it is too large for the linear material law.
pub(crate) fn strain_text(strain: f64) -> Option<String> {
    strain_warning(strain).map(|_| fill!("nodal strain %{strain}", strain = percent(100.0 * strain)))
}

/// Returns a reason to doubt a result, or its error if that is small, in a few words that stand beside the error; `None`
/// if there is none, or no error.
pub(crate) fn doubt(session: &Session, errors: &Errors) -> Option<String> {
    if !session.simulation().status().is_success() || session.simulation().motion().is_some() {
        return None;
    }
    let quality = &session.model.quality;
    if quality.is_inside_out(session.simulation()) {
        // The status has it too.
        return errors.own.map(|_| tr("inverted elements").to_owned());
    }
    let strained = strain_text(quality.deformation.max_strain);
    let known = errors.own.zip(session.known_reference().and_then(Reference::first));
    let coarse = known.and_then(|(own, first)| coarse_text(own, &first));
    let doubts: Vec<String> = strained.into_iter().chain(coarse).collect();
    if !doubts.is_empty() {
        return Some(doubts.join(" · "));
    }
    let small = errors.own.filter(|&own| !is_large(own));
    let off = session.known_reference().filter(|_| small.is_some())?.beam_off_by_percent;
    off.filter(|&off| error_level(off) > 0).map(|off| said(&Claim::beam_theory(off)))
}

/// Returns the reference's own error in words if it hides how large an error, percent, is.
pub(crate) fn coarse_text(own: f64, reference: &ProbeReference) -> Option<String> {
    let is_hidden = error_level(reference.error_bound(own)) > error_level(own);
    let is_coarse = is_hidden || is_large(own) && reference.own_error_percent > COARSE * own;
    is_coarse.then(|| fill!("reference ± %{own}", own = percent(reference.own_error_percent)))
}

/// Formats the error of a result, percent: about, while the reference follows the load; its bound, where the error of the
/// reference hides it.
pub(crate) fn error_text(own: Option<f64>, bound: Option<f64>, is_live: bool) -> String {
    /// Smallest ratio of the bound to an error that says nothing, and smallest bound, percent, that matters.
    const HIDDEN: [f64; 2] = [3.0, 0.01];
    let Some(own) = own else { return UNKNOWN.to_owned() };
    match bound {
        Some(bound) if bound > HIDDEN[0] * own && bound > HIDDEN[1] => format!("≤ {}", format::bound_percent(bound)),
        _ if is_live => format!("≈ {}", percent(own)),
        _ => percent(own),
    }
}

/// Returns `true` for an error, percent, that needs a remedy.
pub(crate) fn is_large(error: f64) -> bool {
    error > LARGE_ERROR
}

/// Returns 0 for a small error, 1 for a larger one, 2 for one that needs a remedy.
fn error_level(error: f64) -> u8 {
    u8::from(error > 1.0) + u8::from(is_large(error))
}

/// Returns the colour of an error, percent.
pub(crate) fn error_color(palette: &Palette, error: Option<f64>) -> Color32 {
    match error.map(error_level) {
        Some(0) => palette.good,
        Some(1) => palette.warning,
        Some(_) => palette.large,
        None => palette.secondary,
    }
}

/// Returns the status as a sentence, and `true` if it reports a failure.
pub(crate) fn status_text(session: &Session) -> (String, bool) {
    let simulation = session.simulation();
    let word = match simulation.status() {
        Status::NotConverged(reason) => return (fill!("Does not converge: %{reason}.", reason = said(reason)), true),
        Status::Diverged(reason) => return (fill!("Diverged: %{reason}.", reason = said(reason)), true),
        Status::Stopped(reason) => {
            return (fill!("Stopped: %{reason}. Showing the last finite state.", reason = said(reason)), true);
        }
        Status::Converged => "Converged",
        Status::Accepted => "Accepted",
        Status::Running | Status::Finished if !session.is_running() => "Paused",
        Status::Running | Status::Finished if simulation.motion().is_none() => "Iterating",
        // The duration applies to runs without a window; in the window a motion continues.
        Status::Running | Status::Finished if simulation.is_at_rest() => "At rest",
        Status::Running | Status::Finished => "Running",
    };
    (tr(word).to_owned(), false)
}

/// Returns the status in one line, such as `Converged · stable · 21 iterations`, and `true` if it needs attention.
/// `remedy` stands beside it: its sentence is not repeated.
pub(crate) fn summary(session: &Session, remedy: Option<&Remedy>) -> (String, bool) {
    let simulation = session.simulation();
    let (mut text, bad) = status_text(session);
    if bad {
        return (text, true);
    }
    let mut add = |part: String| {
        if remedy.is_none_or(|remedy| remedy.text != sentence(&part)) {
            text.push_str(" · ");
            text.push_str(&part);
        }
    };
    let inside_out = session.model.quality.is_inside_out(simulation);
    if inside_out {
        add(tr("inverted elements").to_owned());
    }
    if simulation.motion().is_some() {
        add(format!("{:.2} s", simulation.state().time()));
        return (text, inside_out);
    }
    if let Some(stable) = stability(simulation) {
        add(tr(if stable { "stable" } else { "unstable" }).to_owned());
    }
    match session.timed_from_rest().filter(|_| simulation.status().is_success()) {
        Some(solve) if !solve.is_solved => add(tr("not reached from rest").to_owned()),
        // From a state under another load, fewer or more may have been needed.
        Some(solve) if solve.iterations > 0 => add(count(solve.iterations, "iteration")),
        None if simulation.iterations() > 0 => add(count(simulation.iterations(), "iteration")),
        _ => {}
    }
    if *simulation.status() == Status::Running && simulation.iterations() > 0 {
        let part = simulation.equilibrium().map(|search| search.load_factor());
        if let Some(part) = part.filter(|part| 0.0 < *part && *part < 1.0) {
            add(fill!("at %{part} of the load", part = percent(100.0 * part)));
        }
        add(fill!("residual %{residual}", residual = format!("{:.1e}", simulation.residual())));
    }
    if runs_away(session) {
        add(tr("diverges if it runs on").to_owned());
    }
    notes_on_mesh(simulation).iter().for_each(|note| add(said(note)));
    let path = session.path();
    if let Some(path) = &path {
        path.claims().map(|claim| said(&claim)).for_each(&mut add);
    }
    let is_critical = path.and_then(|path| path.critical).is_some_and(|factor| factor <= 1.0);
    (text, inside_out || is_critical || runs_away(session) || stability(simulation) == Some(false))
}

/// Returns `true` if a converged equilibrium is stable; `None` if it has no certificate.
pub(crate) fn stability(simulation: &Simulation) -> Option<bool> {
    let certificate = simulation.equilibrium()?.certificate()?;
    certificate.stable.filter(|_| *simulation.status() == Status::Converged)
}

/// Returns the spectral radius ρ of the warped iteration at the equilibrium; `None` if that is not known.
pub(crate) fn rho(session: &Session) -> Option<f64> {
    let own = || session.simulation().equilibrium().filter(|_| session.simulation().status().is_success());
    session.facts.rho.get(session.scene()).copied().or_else(|| own()?.certificate()?.fixed_point_rho)
}

/// Returns `true` if a result was accepted of a warped iteration that diverges if it runs on.
fn runs_away(session: &Session) -> bool {
    let is_accepted = *session.simulation().status() == Status::Accepted;
    let is_warped = session.scene().solver.method == MethodKind::Warped;
    is_accepted && is_warped && rho(session).is_some_and(|rho| rho > 1.0)
}

/// Describes the equilibrium that is drawn in place of one that was not found: its load, and the load that was asked for, with
/// their directions if these differ; or its method, if the loads are equal.
pub(crate) fn equilibrium_text(drawn: &Scene, wanted: &Scene) -> String {
    /// Smallest difference of two directions that a person sees, rad.
    const TURNED: f64 = 0.02;
    let loads = only_load(drawn).zip(only_load(wanted));
    let are_turned = loads.is_some_and(|((own, _), (asked, _))| own.angle(&asked) > TURNED);
    let text = |(load, unit): (Vector2<f64>, &str)| match engineering(three_digits(load.norm()), unit) {
        size if are_turned => {
            let angle = format!("{:.0}°", load.y.atan2(load.x).to_degrees());
            fill!("%{load} towards %{angle}", load = size, angle)
        }
        size => size,
    };
    match loads.map(|(own, asked)| [own, asked].map(text)) {
        Some([own, asked]) if own != asked => {
            fill!("equilibrium at %{load}; %{wanted} not reached", load = own, wanted = asked)
        }
        _ if drawn.solver.method != wanted.solver.method => {
            fill!("equilibrium under %{method}", method = tr(drawn.solver.method.id()))
        }
        _ => tr("equilibrium of an earlier load").to_owned(),
    }
}

/// Describes a drawn body that is not the result for the scene; `None` if it is.
pub(crate) fn state_text(session: &Session) -> Option<String> {
    session.fallback().map(|drawn| equilibrium_text(drawn.scene(), session.scene()))
}

/// Returns the magnitude of a scene's only load as text; `None` where [`only_load`] is.
pub(crate) fn load_text(scene: &Scene) -> Option<String> {
    only_load(scene).map(|(load, unit)| engineering(three_digits(load.norm()), unit))
}

/// Returns a scene's only load with its unit, a moment along x, of several zeros the first; `None` if it has no load or
/// several, or moves a support.
fn only_load(scene: &Scene) -> Option<(Vector2<f64>, &'static str)> {
    let vector = |load: &Load| match *load {
        Load::Force { force, .. } => (force.into(), "N"),
        Load::Gravity { acceleration, .. } => (acceleration.into(), "m/s²"),
        Load::Moment { moment, .. } => (Vector2::new(moment, 0.0), "N m"),
    };
    let mut loads = scene.loads.iter().map(vector).filter(|(load, _)| *load != Vector2::zeros());
    let only = loads.next().or_else(|| scene.loads.first().map(vector));
    only.filter(|_| loads.next().is_none() && !scene.supports.iter().any(Support::moves))
}

/// Limit of an explicit integrator.
const EXPLICIT: &str = "An explicit integrator explodes if its time step is too long; the pull of a grab and large strains \
                        make the longest possible step shorter.";

/// Returns `true` if it is known that no error of the result can be measured.
pub(crate) fn is_without_reference(session: &Session) -> bool {
    session.reference_failure().is_some()
        || session.known_reference().is_some_and(|reference| reference.first().is_none())
}

/// Explains the status, one sentence per entry.
pub(crate) fn explanation(session: &Session) -> Vec<String> {
    let simulation = session.simulation();
    let mut lines: Vec<String> = session.has_failed().then(|| status_text(session).0).into_iter().collect();
    let is_solved = match simulation.motion() {
        Some(_) => !matches!(simulation.status(), Status::Stopped(_)),
        None => simulation.status().is_success(),
    };
    if is_without_reference(session) && simulation.motion().is_none() {
        let reason = error_tip(session.known_reference(), session.reference_failure());
        lines.push(fill!("The error is not known. %{reason}", reason));
    }
    if is_solved && session.model.quality.is_inside_out(simulation) {
        let text = "Inverted elements: an element has negative area, which no real body can have, although the \
                    equations are solved. Reduce the load, or refine the mesh.";
        lines.push(tr(text).to_owned());
    }
    if let Some(motion) = simulation.motion() {
        let counts = motion.counts();
        let (steps, solves) = (count(counts.steps, "step"), count(counts.solves, "back substitution"));
        lines.push(fill!("%{steps} so far, with %{solves}.", steps, solves));
        let text = match session.scene().dynamics.integrator.entry().is_explicit() {
            true => EXPLICIT,
            false => "A time step that does not converge is halved. The drift is the energy that the integrator adds.",
        };
        lines.push(tr(text).to_owned());
        return lines;
    }
    lines.extend(notes_on_mesh(simulation).iter().map(|note| sentence(&said(note))));
    let (residual, asked) = (number(two_digits(simulation.residual())), number(session.scene().solver.tolerance));
    if *simulation.status() == Status::Accepted {
        let text = "Accepted after %{iterations} from rest, as the scene asks: the relative residual is %{residual}, the \
                    tolerance is %{asked}.";
        lines.push(fill!(text, iterations = count(simulation.iterations(), "iteration"), residual, asked));
    }
    let part = simulation.equilibrium().map(|search| search.load_factor()).filter(|part| *part < 1.0);
    if let Some(part) = part.filter(|_| simulation.residual() <= session.scene().solver.tolerance) {
        let text = "The last iterate balances %{part} of the load; the next step of the load is not reached.";
        lines.push(fill!(text, part = percent(100.0 * part)));
    } else if !simulation.status().is_success() {
        let text = "The forces of the last iterate do not balance: the relative residual is %{residual}, the tolerance \
                    is %{asked}.";
        lines.push(fill!(text, residual, asked));
    }
    let rho = rho(session).filter(|_| session.scene().solver.method == MethodKind::Warped);
    if let Some(rho) = rho.filter(|_| !simulation.status().is_success() || runs_away(session)) {
        let text = if rho > 1.0 {
            "At the equilibrium that is sought, each iteration multiplies a small error by about ρ = %{rho}: it grows."
        } else {
            "At the equilibrium that is sought, each iteration multiplies a small error by about ρ = %{rho}, but the \
             iteration from rest does not come near it."
        };
        lines.push(fill!(text, rho = rho_number(rho)));
    }
    let claims = Claim::of_result(simulation, rho, session.path().as_ref(), None);
    // The status has the others.
    let explains = |claim: &&Claim| match claim.id {
        // An iterate that was accepted early is no equilibrium; the remedy offers the method that helps a diverging one.
        "disturbance" => *simulation.status() == Status::Converged,
        "helps" => !matches!(simulation.status(), Status::Diverged(_)),
        id => matches!(id, "converged" | "stable" | "unstable"),
    };
    lines.extend(claims.iter().filter(explains).map(|claim| sentence(&said(claim))));
    lines
}

/// Edit that would improve a result, with its description and the edited scene.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Remedy {
    /// Description of the problem.
    pub text: String,
    /// Label of the button.
    pub offer: String,
    pub action: Action,
}

/// Returns the most effective remedy; `None` if nothing is wrong or no edit helps.
pub(crate) fn remedy(session: &Session, errors: &Errors) -> Option<Remedy> {
    let (simulation, scene) = (session.simulation(), session.scene());
    let has_stopped = matches!(simulation.status(), Status::Stopped(_));
    if has_stopped && scene.dynamics.integrator.entry().is_explicit() {
        let action = Action::edit("Integrator", scene, |scene| scene.dynamics.integrator = IntegratorKind::TrBdf2);
        let offer = fill!("Use %{integrator}", integrator = IntegratorKind::TrBdf2.id());
        return Some(Remedy { text: tr(EXPLICIT).to_owned(), offer, action });
    }
    let restart =
        |text: &str, offer| Some(Remedy { text: sentence(text), offer: tr(offer).to_owned(), action: Action::Reset });
    if simulation.motion().is_some() || !simulation.is_at_rest() {
        let is_free = simulation.motion().is_some() && !has_stopped && simulation.mouse_spring().is_none();
        let is_inverted = is_free && session.model.quality.is_inside_out(simulation);
        return if is_inverted { restart(tr("inverted elements"), "Reset") } else { None };
    }
    let with_newton = |text: String| {
        let action = Action::edit("Method", scene, |scene| scene.solver.method = MethodKind::Newton);
        Remedy { text, offer: tr("Use newton").to_owned(), action }
    };
    if !simulation.status().is_success() {
        let text = match rho(session) {
            Some(rho) if rho > 1.0 => fill!("Does not converge: ρ = %{rho} > 1.", rho = rho_number(rho)),
            Some(rho) if scene.solver.method == MethodKind::Warped => {
                fill!("Does not converge from rest, though ρ = %{rho} < 1.", rho = rho_number(rho))
            }
            _ => fill!("The %{method} iteration does not converge.", method = tr(scene.solver.method.id())),
        };
        return (scene.solver.method != MethodKind::Newton).then(|| with_newton(text));
    }
    // Loading from rest would lead to an unstable equilibrium if the path buckles.
    let plain = session.path().filter(|path| path.buckling.is_none());
    if let Some(elsewhere) = plain.and_then(|path| path.claims().find(|claim| claim.id == "elsewhere")) {
        return restart(&said(&elsewhere), "Load from rest");
    }
    let own = errors.own.filter(|&error| is_large(error));
    let off = percent(own?);
    if errors.source == Some(ErrorSource::MeshOrIteration) {
        let text = "%{error} error: the iteration is stopped early.";
        let (offer, label, method) = match runs_away(session) {
            true => ("Use newton", "Method", MethodKind::Newton),
            false => ("Iterate to the tolerance", "Accept after", scene.solver.method),
        };
        let edit = |scene: &mut Scene| (scene.solver.accept_after, scene.solver.method) = (0, method);
        let action = Action::edit(label, scene, edit);
        return Some(Remedy { text: fill!(text, error = off), offer: tr(offer).to_owned(), action });
    }
    if errors.source == Some(ErrorSource::Theory) {
        return Some(with_newton(fill!("%{error} error of linear theory.", error = off)));
    }
    if scene.element() == ElementKind::T3 {
        let better = [ElementKind::T6, ElementKind::Q4].into_iter().find(|e| scene.elements().any(|own| own == *e))?;
        let mut scene = Box::new(scene.clone());
        scene.set_element(better);
        let text = fill!("%{error} error: three-node triangles lock in bending.", error = off);
        let mut offer = fill!("Try %{element}", element = better.id());
        // A body that bends more rotates more, and the warped iteration may then diverge.
        if scene.solver.method == MethodKind::Warped {
            scene.solver.method = MethodKind::Newton;
            offer = fill!("Try %{element} with newton", element = better.id());
        }
        return Some(Remedy { text, offer, action: Action::Edit("Element", scene) });
    }
    let mut scene = Box::new(scene.clone());
    let beam = scene.beam.as_mut()?;
    beam.cells = beam.cells.map(|n| n.saturating_mul(2));
    let fits = f64::from(beam.cells[0]) * f64::from(beam.cells[1]) <= limits::TOTAL_CELLS.max;
    let text = fill!("%{error} error: the mesh is coarse.", error = off);
    let action = Action::Edit("Cells along", scene);
    fits.then_some(Remedy { text, offer: tr("Refine the mesh").to_owned(), action })
}

/// Formats ρ with two significant digits, or as many as tell it from 1.
pub(crate) fn rho_number(rho: f64) -> String {
    if two_digits(rho) == 1.0 && rho != 1.0 {
        number((1e4 * rho).round() / 1e4)
    } else {
        engineering(two_digits(rho), "")
    }
}

/// Explains the error: that of the first probe's displacement, compared with the reference solution; or why there is
/// none.
pub(crate) fn error_tip(reference: Option<&Reference>, failure: Option<&Sentence>) -> String {
    if let Some(failure) = failure {
        return sentence(&said(failure));
    }
    if let Some(reference) = reference.filter(|reference| reference.first().is_none()) {
        return sentence(&said(reference));
    }
    let folds = reference.is_some_and(|reference| reference.folds).then(|| format!("\n{}", sentence(tr(FOLDS))));
    let reference = reference.map_or_else(|| tr("the reference solution (not known yet)").to_owned(), said);
    let tip = "Distance of the first probe, in x and y, from %{reference}; relative to its displacement";
    fill!(tip, reference) + &folds.unwrap_or_default()
}
