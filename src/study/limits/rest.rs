//! Limits of the methods and elements of a scene at rest: each solves it from rest under parts of its loads, compared with
//! the reference of the same loads.

use std::sync::Mutex;

use super::{GOOD, LimitPoint, MethodLimits, RANGE, REFERENCE, USABLE};
use crate::study::load_path::{LoadPath, MAX_UNKNOWNS};
use crate::study::prelude::*;
use crate::study::reference::{first_probe, system_of};
use crate::study::{ProbeReference, Reference};

/// Loads per decade at which the error is measured.
const PER_DECADE: f64 = 6.0;

/// Computes the limits of a scene at rest: see [`MethodLimits::of`].
pub(super) fn limits(
    scene: &Scene,
    observe: Observer<'_>,
    partial: &(dyn Fn(&MethodLimits) + Sync),
) -> Result<MethodLimits> {
    /// Power of the load above which a displacement grows fast, as next to buckling: errors have a peak there.
    const FAST: f64 = 2.0;
    if scene.probes.is_empty() {
        return Err(StudyError::NoProbe);
    }
    let own = Setting::of(scene);
    let system = |element| Ok((element, system_of(&Setting { element, ..own }.apply(scene))?));
    let mut systems = scene.elements().map(system).collect::<Result<Vec<_>, StudyError>>()?;
    systems.sort_by_key(|(element, _)| *element != own.element);
    let rest = AtRest { scene, systems, references: Mutex::default() };
    let now = sentence!("reference solutions");
    let criticals = parallel::all(&rest.systems, observe, [0.0; 2], &now, |&(element, ref system), observe| {
        Ok((element, critical(&Setting { element, ..own }.apply(scene), system, observe)))
    })?;
    let solve_references = |factors: &[f64], shares: [f64; 2]| {
        parallel::all(factors, observe, shares, &now, |&factor, observe| rest.reference(factor, observe))
    };
    // A reference may have been found before that of a smaller load at which the material folds.
    let displacement = |factor: f64| Some(rest.known(factor)?.probe?.displacement);
    let count = (PER_DECADE * (RANGE[1] / RANGE[0]).log10()).round() as u32;
    let factors: Vec<f64> = (0..=count).map(|step| RANGE[0] * 10f64.powf(f64::from(step) / PER_DECADE)).collect();
    solve_references(&factors, [0.0, 0.8 * REFERENCE])?;
    // Between two loads, the error is measured where the displacement grows fast, else only convergence is tried.
    let between = factors.array_windows().flat_map(|&[from, to]| {
        let ratio = displacement(to).zip(displacement(from)).map_or(1.0, |(b, a)| b.norm() / a.norm());
        let is_fast = ratio.ln() > FAST * (to / from).ln();
        let parts: &[f64] = if is_fast { &[0.25, 0.5, 0.75] } else { &[0.5] };
        parts.iter().map(move |part| (from * (to / from).powf(*part), is_fast))
    });
    let mut loads: Vec<(f64, bool)> = between.collect();
    let compared = |loads: &[(f64, bool)]| -> Vec<f64> {
        loads.iter().filter(|(_, is_compared)| *is_compared).map(|(factor, _)| *factor).collect()
    };
    solve_references(&compared(&loads), [0.8 * REFERENCE, REFERENCE])?;
    loads.extend(factors.into_iter().map(|factor| (factor, true)));
    loads.sort_by(|(a, _), (b, _)| a.total_cmp(b));
    let reference = compared(&loads).into_iter().map(|factor| (factor, displacement(factor))).collect();
    let methods = METHODS.iter().map(|entry| entry.kind).filter(|method| *method != MethodKind::Auto);
    let all = scene
        .elements()
        .flat_map(|element| methods.clone().map(move |method| Setting { element, method, iterations: 0, ..own }));
    // The scene's own early stop has a strip too.
    let settings = (own.iterations > 0).then_some(own).into_iter().chain(all);
    let limits = MethodLimits { range: RANGE, criticals, reference, ..MethodLimits::default() };
    limits.followed(scene, settings, &loads, |setting, load, o| rest.solve(setting, load, o), observe, partial)
}

/// A scene at rest, and what its strips share.
struct AtRest<'a> {
    scene: &'a Scene,
    /// System of each element, which its methods share; that of the scene first.
    systems: Vec<(ElementKind, Arc<System>)>,
    /// References under parts of the load, each computed once.
    references: Mutex<Vec<KnownReference>>,
}

/// Reference of the first probe under a part of the load.
#[derive(Clone, Copy, Default)]
struct KnownReference {
    factor: f64,
    /// `None` if there is none, so that the error is not known.
    probe: Option<ProbeReference>,
    /// `true` if the material folds on finer meshes: such a reference takes long, and is inaccurate.
    folds: bool,
}

impl AtRest<'_> {
    /// Returns the reference under a part of the load if it has been computed, or need not be: it has none beyond a load at
    /// which the material folds and the reference does not tell good results from others.
    fn known(&self, factor: f64) -> Option<KnownReference> {
        let all = lock(&self.references);
        let is_bad = |probe: ProbeReference| probe.own_error_percent > USABLE;
        let is_end = |known: &KnownReference| known.folds && known.factor < factor && known.probe.is_none_or(is_bad);
        let own = || all.iter().find(|known| known.factor == factor).copied();
        if all.iter().any(is_end) { Some(KnownReference::default()) } else { own() }
    }

    /// Returns the reference under a part of the load, which is computed unless it is known.
    fn reference(&self, factor: f64, observe: Observer<'_>) -> Result<KnownReference> {
        if let Some(known) = self.known(factor) {
            return Ok(known);
        }
        let found = match Reference::find(&at(self.scene, factor), None, Extent::Quick, observe) {
            Err(StudyError::Cancelled) => return Err(StudyError::Cancelled),
            found => found.ok(),
        };
        let probe = found.as_ref().and_then(Reference::first);
        let known = KnownReference { factor, probe, folds: found.is_some_and(|reference| reference.folds) };
        lock(&self.references).push(known);
        Ok(known)
    }

    /// Solves the scene from rest under a part of its load, and compares the result with the reference if `is_compared`.
    fn solve(&self, setting: &Setting, load: (f64, bool), observe: Observer<'_>) -> Result<LimitPoint> {
        let (factor, is_compared) = load;
        let system = self.systems.iter().find(|(element, _)| *element == setting.element);
        let (_, system) = system.ok_or(StudyError::NoReference)?;
        let mut solved = Simulation::with_system(&at(&setting.apply(self.scene), factor), system.clone())?;
        check(solved.solve_watched(&mut |_| observe(Progress::at(0.0))))?;
        let converges = solved.status().is_success();
        let known = match converges && is_compared {
            true => self.reference(factor, observe)?,
            false => self.known(factor).unwrap_or_default(),
        };
        let point = LimitPoint { factor, converges, seeks_errors: !known.folds, ..LimitPoint::default() };
        if !converges {
            return Ok(point);
        }
        let (displacement, probe) = (first_probe(&solved)?, known.probe.filter(|_| is_compared));
        let deformation = Deformation::of(solved.problem(), solved.state(), &solved.nodal_stress());
        Ok(LimitPoint {
            displacement,
            max_strain: Some(deformation.max_strain),
            inverted_elements: deformation.inverted_elements,
            is_compared,
            error_percent: probe.and_then(|probe| known_error(&probe, displacement)),
            reference_percent: probe.map(|probe| probe.own_error_percent),
            ..point
        })
    }
}

/// Returns the largest error of a displacement, percent; `None` if the reference's own error hides if it is usable.
fn known_error(reference: &ProbeReference, displacement: Vector2<f64>) -> Option<f64> {
    let distance = error_percent(displacement, reference.displacement)?;
    let bound = reference.error_bound(distance);
    let is_hidden = reference.own_error_percent > GOOD && distance <= USABLE && bound > USABLE;
    (!is_hidden).then_some(bound)
}

/// Returns the part of the load at which the load path from rest buckles or jumps, if it does so in the range.
fn critical(scene: &Scene, system: &Arc<System>, observe: Observer<'_>) -> Option<f64> {
    if system.dofs() > MAX_UNKNOWNS {
        return None;
    }
    let simulation = Simulation::with_system(scene, system.clone()).ok()?;
    LoadPath::first_event(&simulation, RANGE[1], observe)
}

/// Returns the scene under a part of its loads and prescribed displacements.
fn at(scene: &Scene, factor: f64) -> Scene {
    let mut scene = scene.clone();
    scene.scale_loads(factor);
    scene
}
