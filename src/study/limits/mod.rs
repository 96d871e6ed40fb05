//! Limits of every method and element on a scene: up to which load each is within 1 % and 5 % of the reference solution,
//! where it stops to converge, and where strains leave the linear law. In motion: the same of every integrator, up to
//! which time step. Loads are tried from small to large; each stated end lies between two of them that differ by at most
//! one percent.

use std::sync::Mutex;

use serde::{Deserialize, Serialize};

use super::figure::{Ink, LoadAxis};
use super::load_path::{LoadPath, MAX_UNKNOWNS};
use super::prelude::*;
use super::reference::{first_probe, system_of};
use super::{ProbeReference, Reference};
use crate::stress::LAW_HOLDS;

mod motion;

/// Smallest and largest part of the scene's loads and prescribed displacements.
pub const RANGE: [f64; 2] = [0.01, 10.0];
/// Smallest and largest part of the time step of a motion.
pub const TIME_STEPS: [f64; 2] = [1.0 / 16.0, 8.0];
/// Loads per decade; at every second one the error is measured too, which takes longest.
const PER_DECADE: i32 = 12;
/// Further loads of a strip relative to the critical load of its mesh, near which errors change within a percent of the
/// load.
const NEAR_CRITICAL: [f64; 2] = [0.99, 1.01];
/// Error, percent, up to which a result counts as good.
pub const GOOD: f64 = 1.0;
/// Error, percent, up to which a result counts as usable.
pub const USABLE: f64 = 5.0;
/// Ratio of the reference's own error to a limit from which on it may hide if an error is within the limit.
const LARGE_OWN: f64 = 0.5;
/// Ratio of two loads between which a change is not sought any more.
const FINE: f64 = 1.01;
/// Largest number of loads of a strip that are added to find where its results change.
const MAX_ADDED: usize = 60;

/// Error of a result, in classes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rating {
    /// Error up to [`GOOD`].
    Good,
    /// Error up to [`USABLE`].
    Usable,
    /// Larger error.
    Beyond,
    /// Error without a known bound.
    Unknown,
    /// The method does not converge, or the motion stops early.
    NotConverged,
}

impl Rating {
    /// All classes, in the order of a legend.
    pub const ALL: [Self; 5] = [Self::Good, Self::Usable, Self::Beyond, Self::NotConverged, Self::Unknown];

    /// Returns the colour of the class, and its name at rest or in motion.
    pub fn entry(self, moves: bool) -> (Ink, Sentence) {
        let (color, name) = match self {
            Self::Good => ([0x3a, 0x9d, 0x5d], sentence!("within %{percent} %", percent = number(GOOD))),
            Self::Usable => ([0xe6, 0xc2, 0x3a], sentence!("within %{percent} %", percent = number(USABLE))),
            Self::Beyond => ([0xe0, 0x7b, 0x39], sentence!("above %{percent} %", percent = number(USABLE))),
            Self::NotConverged if moves => ([0xbe, 0x14, 0x1e], sentence!("stops early")),
            Self::NotConverged => ([0xbe, 0x14, 0x1e], sentence!("does not converge")),
            Self::Unknown => ([0xc4, 0xc8, 0xcc], sentence!("error not known")),
        };
        (Ink::Fixed(color), name)
    }
}

/// Part of a strip with one rating.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Piece {
    /// Smallest and largest part of the scene's loads.
    pub range: [f64; 2],
    /// Rating of the errors.
    pub rating: Rating,
    /// `true` if elements are inverted, or strains exceed those of the linear law.
    pub is_beyond_law: bool,
}

/// Load that a method was tried at, or time step of an integrator, and its result.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct LimitPoint {
    /// Part of the scene's loads and prescribed displacements, or of its time step.
    pub factor: f64,
    /// `false` if the method does not converge, or the motion stops early.
    pub converges: bool,
    /// Displacement of the first probe, m; of a motion at its end.
    pub displacement: Vector2<f64>,
    /// Largest strain, of a motion over its time; `None` if there is no result, or only convergence was tried.
    pub max_strain: Option<f64>,
    /// Number of inverted elements.
    pub inverted_elements: usize,
    /// `true` if the result was compared with the reference solution.
    pub is_compared: bool,
    /// Largest error, percent of the reference's displacement, its own error included; `None` if the reference solution is
    /// not known, or is too inaccurate to tell if the error is within [`USABLE`].
    pub error_percent: Option<f64>,
    /// Error of the reference solution, a part of [`Self::error_percent`]; `None` without a reference solution.
    pub reference_percent: Option<f64>,
}

/// Property of a result whose limits are sought.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Property {
    /// The error is at most this, percent.
    Within(f64),
    /// The method converges.
    Converges,
    /// Strains are those of the linear law.
    Law,
}

impl LimitPoint {
    /// Returns the answer if it was sought at this load: `Some(true)` if the load has the property, `None` if the reference
    /// solution does not tell.
    fn answer(&self, property: Property) -> Option<Option<bool>> {
        match property {
            Property::Converges => Some(Some(self.converges)),
            Property::Law => Some(Some(self.max_strain? <= LAW_HOLDS && self.inverted_elements == 0)),
            Property::Within(_) if !self.converges => Some(Some(false)),
            Property::Within(limit) => self.is_compared.then_some(match (self.error_percent, self.reference_percent) {
                (None, _) => None,
                (Some(error), _) if error <= limit => Some(true),
                // Without the error of the reference, which is large, it may be within the limit.
                (Some(error), Some(own)) if error - own <= limit && own > LARGE_OWN * limit => None,
                _ => Some(false),
            }),
        }
    }

    /// Returns the rating of the error; `None` if it was not sought.
    fn rating(&self) -> Option<Rating> {
        match self.error_percent {
            _ if !self.converges => Some(Rating::NotConverged),
            _ if !self.is_compared => None,
            None => Some(Rating::Unknown),
            Some(error) if error <= GOOD => Some(Rating::Good),
            Some(error) if error <= USABLE => Some(Rating::Usable),
            Some(_) => Some(Rating::Beyond),
        }
    }
}

/// Loads in a row that have a property.
#[derive(Clone, Copy, Debug, PartialEq)]
struct LoadRange {
    /// First and last load.
    range: [f64; 2],
    /// `true` if no load was tried below.
    is_first: bool,
    /// `true` if the load next to the last one does not have the property: it is the last one indeed.
    ends: bool,
}

/// Results of a method with an element, from small to large loads; of an integrator, from short to long time steps.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Strip {
    /// Element, method and number of iterations, or integrator.
    pub setting: Setting,
    /// Loads that have been tried, from small to large.
    pub points: Vec<LimitPoint>,
    /// Fraction of the loads that have been solved; 1 once the strip is complete.
    pub done: f64,
}

impl Strip {
    /// Returns a strip before the first load is solved.
    fn new(setting: Setting) -> Self {
        Self { setting, points: Vec::new(), done: 0.0 }
    }

    /// Returns the name of the method, translated by `text`, with the number of iterations of an early stop: `warped:2`.
    pub fn method_name(&self, text: impl Fn(&'static str) -> String) -> String {
        let Setting { method, iterations, .. } = self.setting;
        let method = text(method.id());
        if iterations == 0 { method } else { format!("{method}:{iterations}") }
    }

    /// Returns the name of the integrator, or the names of element and method, translated by `text`.
    pub fn name(&self, text: impl Fn(&'static str) -> String) -> String {
        match self.setting.stepping {
            Some(stepping) => text(stepping.integrator.id()),
            None => format!("{} {}", self.setting.element.id(), self.method_name(text)),
        }
    }

    /// Returns the loads at which a property was sought, with the answers.
    fn answers(&self, property: Property) -> impl Iterator<Item = (f64, Option<bool>)> {
        self.points.iter().filter_map(move |point| Some((point.factor, point.answer(property)?)))
    }

    /// Returns the rows of loads that have a property, from small to large, but none with an accident: errors are small
    /// where results that grow too fast cross those of the reference.
    fn runs(&self, property: Property) -> Vec<LoadRange> {
        /// Ratio of the ends of a range that is more than a crossing.
        const WIDE: f64 = 1.5;
        let answers: Vec<(f64, Option<bool>)> = self.answers(property).collect();
        let rows: Vec<_> = answers.chunk_by(|(_, a), (_, b)| a == b).collect();
        let runs = rows.iter().enumerate().filter(|(_, row)| row[0].1 == Some(true)).map(|(i, row)| {
            let [first, last] = [row[0].0, row[row.len() - 1].0];
            let ends = rows.get(i + 1).is_some_and(|next| next[0].1 == Some(false) && next[0].0 <= FINE * last);
            LoadRange { range: [first, last], is_first: i == 0, ends }
        });
        let is_wide = |run: &LoadRange| run.is_first || run.range[1] > WIDE * run.range[0];
        runs.filter(|run| !matches!(property, Property::Within(_)) || is_wide(run)).collect()
    }

    /// Returns the part of the load up to which the error is at most `percent`: 0 if it is larger at the smallest load, and
    /// `None` if it is not larger up to [`Self::last_known`].
    pub fn within(&self, percent: f64) -> Option<f64> {
        let property = Property::Within(percent);
        let is_within = self.answers(property).next()?.1?;
        let end = if is_within { self.runs(property).first()?.range[1] } else { 0.0 };
        (self.last_known() != Some(end)).then_some(end)
    }

    /// Returns the largest part of the load up to which the error is known at every load; `None` if it is not known at the
    /// smallest load.
    pub fn last_known(&self) -> Option<f64> {
        let compared = self.points.iter().filter_map(|point| Some((point.factor, point.rating()?)));
        let is_known = |rating: Rating| !matches!(rating, Rating::Unknown | Rating::NotConverged);
        compared.take_while(|(_, rating)| is_known(*rating)).last().map(|(factor, _)| factor)
    }

    /// Returns the pairs of loads between which the method does not converge, from small to large; the first is 0 if it does
    /// not converge at the smallest load, and the last the largest load if it does not converge there.
    pub fn fails(&self) -> Vec<[f64; 2]> {
        let runs = self.runs(Property::Converges);
        let Some(last) = self.points.last().map(|point| point.factor) else { return Vec::new() };
        let starts = std::iter::once(0.0).chain(runs.iter().map(|run| run.range[1]));
        let ends = runs.iter().map(|run| if run.is_first { 0.0 } else { run.range[0] }).chain([last]);
        starts.zip(ends).map(|(start, end)| [start, end]).filter(|[start, end]| start < end).collect()
    }

    /// Returns the part of the load from which elements are inverted or strains exceed those of the linear law.
    pub fn law_ends_at(&self) -> Option<f64> {
        self.answers(Property::Law).find(|(_, answer)| *answer == Some(false)).map(|(factor, _)| factor)
    }

    /// Returns the strip in pieces: each load has the middle between it and its neighbours. The pieces of a strip that is
    /// not complete end at its last load. `range` is that of the limits.
    pub fn pieces(&self, range: [f64; 2]) -> Vec<Piece> {
        let mut pieces: Vec<Piece> = Vec::new();
        for (i, point) in self.points.iter().enumerate() {
            let end = self.points.get(i + 1).map(|next| (point.factor * next.factor).sqrt());
            let end = end.unwrap_or(if self.done == 1.0 { range[1] } else { point.factor });
            let last = pieces.last().copied();
            // Loads at which the error was not sought have that of the load below.
            let rating = point.rating().or(last.map(|last| last.rating)).unwrap_or(Rating::Unknown);
            let is_beyond_law = match point.answer(Property::Law) {
                Some(answer) => answer == Some(false),
                None => point.converges && last.is_some_and(|last| last.is_beyond_law),
            };
            match pieces.last_mut() {
                Some(last) if (last.rating, last.is_beyond_law) == (rating, is_beyond_law) => last.range[1] = end,
                last => {
                    let start = last.map_or(range[0], |last| last.range[1]);
                    pieces.push(Piece { range: [start, end], rating, is_beyond_law });
                }
            }
        }
        pieces
    }

    /// Returns in words the loads up to which the error is within 1 % and 5 %, that up to which the method converges, and
    /// that from which strains exceed 10 %. `axis` is that of the scene, and `range` that of the limits.
    pub fn words(&self, axis: &LoadAxis, range: [f64; 2]) -> [Sentence; 4] {
        let load = |factor: f64| load_text(axis, factor);
        let of = |property: Property| {
            let runs = self.runs(property);
            let Some(run) = runs.first() else {
                return match self.answers(property).next() {
                    Some((_, Some(false))) => sentence!("not at %{load}", load = load(range[0])),
                    _ => sentence!("not known"),
                };
            };
            let [from, to] = run.range.map(load);
            let loads = match (run.is_first, run.ends) {
                (true, true) => to.into(),
                (true, false) => sentence!("at least %{load}", load = to),
                (false, true) => sentence!("%{from} to %{to}", from, to),
                (false, false) => sentence!("from %{load}", load = from),
            };
            if runs.len() > 1 && run.ends { sentence!("%{loads}, not everywhere beyond", loads) } else { loads }
        };
        let law = self.law_ends_at().map_or_else(|| "\u{2013}".into(), |f| sentence!("from %{load}", load = load(f)));
        [of(Property::Within(GOOD)), of(Property::Within(USABLE)), of(Property::Converges), law]
    }

    /// Returns in words the load up to which the error is within 1 %, or within 5 % if it is larger near the smallest load;
    /// or the load from which it is within 5 %, or else up to which the method converges; `None` before the first load is
    /// solved. `range` is that of the limits.
    pub fn end(&self, axis: &LoadAxis, range: [f64; 2]) -> Option<Sentence> {
        /// Ratio of the loads that are near the smallest one.
        const NEAR: f64 = 2.0;
        let load = |factor: f64| load_text(axis, factor);
        let first = self.points.first()?;
        let found = [GOOD, USABLE].map(|percent| Some((percent, *self.runs(Property::Within(percent)).first()?)));
        let is_far = |(_, run): &(f64, LoadRange)| run.is_first && run.range[1] > NEAR * range[0];
        let best = found.iter().copied().flatten().find(is_far).or(found[1]);
        Some(match (best, self.runs(Property::Converges).first()) {
            (Some((limit, run)), _) => {
                let ([from, to], percent) = (run.range.map(load), number(limit));
                match (run.is_first, run.ends) {
                    (false, _) => sentence!("%{percent} % from %{load}", percent, load = from),
                    (true, true) => sentence!("%{percent} % to %{load}", percent, load = to),
                    (true, false) if run.range[1] == range[1] => sentence!("within %{percent} %", percent),
                    (true, false) => sentence!("%{percent} % to at least %{load}", percent, load = to),
                }
            }
            (None, None) => sentence!("not at %{load}", load = load(range[0])),
            (None, Some(_))
                if first.rating() == Some(Rating::Unknown)
                    && let Some(own) = first.reference_percent =>
            {
                sentence!("reference \u{b1} %{own}", own = percent(own))
            }
            (None, Some(LoadRange { range: [_, to], is_first: true, ends: true })) => match self.setting.stepping {
                Some(_) => sentence!("finishes to %{load}", load = load(*to)),
                None => sentence!("converges to %{load}", load = load(*to)),
            },
            (None, Some(_)) => sentence!("not within %{percent} %", percent = number(USABLE)),
        })
    }

    /// Returns the middle between two neighbouring loads at which a property that `is_sought` at the larger one differs,
    /// unless they lie next to each other; and `true` if the property is an error.
    fn change(&self, is_sought: &dyn Fn(Property, f64) -> bool) -> Option<(f64, bool)> {
        let all = [Property::Within(GOOD), Property::Within(USABLE), Property::Converges, Property::Law];
        all.into_iter().find_map(|property| {
            let answers: Vec<(f64, Option<bool>)> = self.answers(property).collect();
            let change = answers.array_windows().find(|&&[(from, before), (to, after)]| {
                let changes = before.zip(after).is_some_and(|(before, after)| before != after);
                changes && to > FINE * from && is_sought(property, to)
            });
            change.map(|[(from, _), (to, _)]| ((from * to).sqrt(), matches!(property, Property::Within(_))))
        })
    }

    /// Returns a load beside the largest of the errors around it that is below a limit, but may exceed it next to there: near
    /// buckling, errors have a narrow peak.
    fn beside_peak(&self, is_sought: &dyn Fn(Property, f64) -> bool) -> Option<f64> {
        /// Part of the limit from which on a measured peak may belong to one above the limit.
        const CLOSE: f64 = 0.5;
        /// Ratio of two loads between which no peak is sought.
        const NARROW: f64 = 1.05;
        let errors = self.points.iter().filter_map(|point| Some((point.factor, point.error_percent?)));
        let errors: Vec<(f64, f64)> = errors.collect();
        let peaks = errors.array_windows().filter_map(|&[(before, a), (at, peak), (after, b)]| {
            let is_close =
                |limit: f64| (CLOSE * limit..=limit).contains(&peak) && is_sought(Property::Within(limit), after);
            let [from, to] = if at * at > before * after { [before, at] } else { [at, after] };
            let is_peak = peak >= a && peak >= b && to > NARROW * from && (is_close(GOOD) || is_close(USABLE));
            is_peak.then(|| (from * to).sqrt())
        });
        peaks.min_by(f64::total_cmp)
    }

    /// Returns a load next to the first one at which the method stops to converge, if none was tried there: there, a method
    /// may converge at some loads and not at others.
    fn untried(&self) -> Option<f64> {
        /// Distance of the loads next to the end, and their numbers below and above it.
        const STEP: f64 = 0.005;
        const NEXT: [i32; 2] = [-6, 2];
        let end = self.runs(Property::Converges).first().filter(|run| run.ends)?.range[1];
        let is_tried = |factor: &f64| self.points.iter().any(|point| (point.factor / factor - 1.0).abs() < 0.5 * STEP);
        (NEXT[0]..=NEXT[1]).map(|n| end * (1.0 + STEP * f64::from(n))).find(|factor| !is_tried(factor))
    }
}

/// Returns the name of the axis, with the critical load of the scene's mesh if there is one, or with the error of a
/// motion's mesh.
pub fn axis_text(limits: &MethodLimits, axis: &LoadAxis) -> Sentence {
    match (limits.critical(), limits.mesh_error_text()) {
        (Some(factor), _) => {
            sentence!("%{load}; critical load (dashed) %{value}", load = &axis.name, value = load_text(axis, factor))
        }
        (None, Some(text)) => sentence!("%{load}; %{text}", load = &axis.name, text),
        (None, None) => axis.name.clone(),
    }
}

/// Formats a part of a scene's load or time step.
pub fn load_text(axis: &LoadAxis, factor: f64) -> String {
    engineering(three_digits(factor * axis.full), axis.unit)
}

/// Limits of all methods and elements on a scene at rest, or of all integrators of a motion.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MethodLimits {
    /// Smallest and largest part of the scene's loads, or of its time step.
    pub range: [f64; 2],
    /// Simulated time of a motion, s.
    pub duration: Option<f64>,
    /// Error of the mesh of a motion, which each of its errors includes, percent of the size of the reference's path; with
    /// the reference's own error.
    pub mesh_error_percent: Option<f64>,
    /// Part of the load at which the load path from rest buckles or jumps on the mesh of each element, that of the scene
    /// first; `None` if it does neither in the range, or the mesh has more than 6000 unknowns. Empty for a motion.
    pub criticals: Vec<(ElementKind, Option<f64>)>,
    /// Reference displacement of the first probe, m, at every load; `None` if it is not known. Empty for a motion.
    pub reference: Vec<(f64, Option<Vector2<f64>>)>,
    /// Strips, by element and method.
    pub strips: Vec<Strip>,
}

impl MethodLimits {
    /// Returns the largest error of the reference solution, percent, if it decides about a rating of [`GOOD`].
    pub fn large_reference_error_percent(&self) -> Option<f64> {
        let points = self.strips.iter().flat_map(|strip| &strip.points);
        let errors = points.filter_map(|point| point.reference_percent);
        errors.max_by(f64::total_cmp).filter(|error| *error > LARGE_OWN * GOOD)
    }

    /// Returns the part of the load at which the load path from rest buckles or jumps on the scene's mesh.
    pub fn critical(&self) -> Option<f64> {
        self.criticals.first()?.1
    }

    /// Returns the part of the load at which the load path from rest buckles or jumps on the mesh of an element.
    pub fn critical_of(&self, element: ElementKind) -> Option<f64> {
        self.criticals.iter().find(|(own, _)| *own == element)?.1
    }

    /// Returns the critical loads of the meshes in words; `None` if there are none.
    pub fn criticals_text(&self, axis: &LoadAxis) -> Option<String> {
        let of = |(element, critical): &(ElementKind, Option<f64>)| {
            Some(format!("{} with {}", load_text(axis, (*critical)?), element.id()))
        };
        let criticals: Vec<String> = self.criticals.iter().filter_map(of).collect();
        let text = || {
            format!("critical load of this mesh, where the path from rest buckles or jumps: {}", criticals.join(", "))
        };
        (!criticals.is_empty()).then(text)
    }

    /// Returns the error of a motion's mesh in words: however short its time steps are, no integrator has a smaller error.
    pub fn mesh_error_text(&self) -> Option<Sentence> {
        /// Smallest error that is worth a sentence, percent.
        const SEEN: f64 = 1e-3;
        let error = percent(self.mesh_error_percent.filter(|error| *error >= SEEN)?);
        Some(sentence!("each error includes %{error} of the mesh", error))
    }

    /// Returns `true` if a part of the scene's loads, or of its time step, is in the range of the limits: that of a very
    /// short time step is not.
    pub fn contains(&self, factor: f64) -> bool {
        /// Relative rounding error of a factor with three digits.
        const ROUNDING: f64 = 1e-2;
        let [low, high] = self.range;
        (low * (1.0 - ROUNDING)..=high * (1.0 + ROUNDING)).contains(&factor)
    }

    /// Computes the limits of a scene with a probe, on the scene's cells. The reference solution is that of
    /// [`Reference`] at every load, or that of a quick study of the motion. `partial` receives the limits so far each time a
    /// load has been solved; strips with the scene's own element and method are computed first.
    ///
    /// # Errors
    /// [`StudyError`]: the scene has no probe or cannot be simulated, or `observe` cancelled the computation.
    pub fn of(scene: &Scene, observe: Observer<'_>, partial: &(dyn Fn(&Self) + Sync)) -> Result<Self, StudyError> {
        if scene.analysis == Analysis::Dynamic {
            return motion::limits(scene, observe, partial);
        }
        if scene.probes.is_empty() {
            return Err(StudyError::NoProbe);
        }
        let own = Setting::of(scene);
        // Methods share the system of an element.
        let system = |element| Ok((element, system_of(&Setting { element, ..own }.apply(scene))?));
        let mut systems = scene.elements().map(system).collect::<Result<Vec<_>, StudyError>>()?;
        systems.sort_by_key(|(element, _)| *element != own.element);
        let methods = METHODS.iter().map(|entry| entry.kind).filter(|method| *method != MethodKind::Auto);
        let all = scene
            .elements()
            .flat_map(|element| methods.clone().map(move |method| Setting { element, method, iterations: 0, ..own }));
        // The scene's own early stop has a strip too.
        let early = (own.iterations > 0).then_some(own);
        let strips: Vec<Strip> = early.into_iter().chain(all).map(Strip::new).collect();
        let mut rows: Vec<(usize, Setting)> = strips.iter().map(|strip| strip.setting).enumerate().collect();
        let now = sentence!("reference solutions");
        let criticals = parallel::all(&systems, observe, [0.0; 2], &now, |&(element, ref system), observe| {
            Ok((element, critical(&Setting { element, ..own }.apply(scene), system, observe)))
        })?;
        let between = factors().into_iter().skip(1).step_by(2);
        let factors: Vec<f64> = factors().into_iter().step_by(2).collect();
        let all = (factors.len() + rows.len()) as f64;
        let reference = factors.iter().map(|&factor| (factor, None)).collect();
        let limits = Self { range: RANGE, duration: None, mesh_error_percent: None, criticals, reference, strips };
        let sweep = Sweep { scene, limits: Mutex::new(limits), references: Mutex::default(), partial };
        let solve_references = |factors: &[f64], before: usize| {
            let shares = [before, before + factors.len()].map(|done| (done as f64 / all).min(1.0));
            sweep.solve_references(factors, shares, observe)
        };
        solve_references(&factors, 0)?;
        let added = steep(&lock(&sweep.limits).reference);
        sweep.change(|limits| {
            limits.reference.extend(added.iter().map(|&factor| (factor, None)));
            limits.reference.sort_by(|(a, _), (b, _)| a.total_cmp(b));
        });
        solve_references(&added, factors.len())?;
        let compared: Vec<f64> = lock(&sweep.limits).reference.iter().map(|(factor, _)| *factor).collect();
        let is_new = |factor: &f64| compared.iter().all(|other| (other / factor).ln().abs() > FINE.ln());
        let between: Vec<(f64, bool)> = between.filter(is_new).map(|factor| (factor, false)).collect();
        rows.sort_by_key(|(_, setting)| {
            u8::from(setting.element != own.element) + u8::from(setting.method != own.method)
        });
        let now = sentence!("following each method");
        let begun = compared.len() as f64 / (compared.len() + rows.len()) as f64;
        parallel::all(&rows, observe, [begun, 1.0], &now, |&(row, setting), observe| {
            let system = systems.iter().find(|(element, _)| *element == setting.element);
            let (own, system) = (setting.apply(scene), &system.ok_or(StudyError::NoReference)?.1);
            let folds = |factor: f64| sweep.known(factor).is_some_and(|known| known.folds);
            let is_sought =
                |property: Property, factor: f64| !(matches!(property, Property::Within(_)) && folds(factor));
            let critical = lock(&sweep.limits).critical_of(setting.element);
            let near = critical.into_iter().flat_map(|at| NEAR_CRITICAL.map(|part| part * at));
            let near = near.filter(|factor| (RANGE[0]..RANGE[1]).contains(factor));
            let mut factors: Vec<(f64, bool)> = compared.iter().copied().chain(near).map(|at| (at, true)).collect();
            factors.extend(&between);
            factors.sort_by(|(a, _), (b, _)| a.total_cmp(b));
            let point = |factor, is_compared| sweep.point(&own, system, (factor, is_compared), observe);
            sweep.follow(row, &factors, &point, &is_sought)
        })?;
        Ok(lock(&sweep.limits).clone())
    }
}

/// Limits that become known in parts, on several threads, and the reference solutions of a scene at rest.
struct Sweep<'a> {
    scene: &'a Scene,
    limits: Mutex<MethodLimits>,
    /// References of the first probe under parts of the load, each computed once.
    references: Mutex<Vec<KnownReference>>,
    partial: &'a (dyn Fn(&MethodLimits) + Sync),
}

/// Reference of a scene's first probe under a part of its load.
#[derive(Clone, Copy)]
struct KnownReference {
    factor: f64,
    probe: Option<ProbeReference>,
    /// `true` if the material folds on finer meshes: such a reference takes long, and is inaccurate.
    folds: bool,
}

impl Sweep<'_> {
    /// Changes the limits, and reports them.
    fn change(&self, change: impl FnOnce(&mut MethodLimits)) {
        let mut limits = lock(&self.limits);
        change(&mut limits);
        (self.partial)(&limits);
    }

    /// Computes the reference solutions under these parts of the load, and reports the progress between two fractions.
    fn solve_references(&self, factors: &[f64], shares: [f64; 2], observe: Observer<'_>) -> Result<()> {
        let now = sentence!("reference solutions");
        parallel::all(factors, observe, shares, &now, |&factor, observe| {
            self.reference(factor, observe)?;
            // A reference may have been found before that of a smaller load at which the material folds.
            let known = |factor: f64| self.known(factor).filter(|_| !self.is_beyond_folds(factor))?.probe;
            let displacement = |factor: f64| known(factor).map(|probe| probe.displacement);
            self.change(|limits| limits.reference.iter_mut().for_each(|(factor, u)| *u = displacement(*factor)));
            Ok(())
        })
        .map(|_| ())
    }

    /// Returns the reference under a part of the load; `None` if there is none, so that the error is not known, or if it is
    /// beyond a load at which the material folds and the reference does not tell good results from others.
    fn reference(&self, factor: f64, observe: Observer<'_>) -> Result<Option<ProbeReference>> {
        if self.is_beyond_folds(factor) {
            return Ok(None);
        }
        if let Some(known) = self.known(factor) {
            return Ok(known.probe);
        }
        let found = match Reference::find(&at(self.scene, factor), None, Extent::Quick, observe) {
            Err(StudyError::Cancelled) => return Err(StudyError::Cancelled),
            found => found.ok(),
        };
        let probe = found.as_ref().and_then(Reference::first);
        let folds = found.is_some_and(|reference| reference.folds);
        lock(&self.references).push(KnownReference { factor, probe, folds });
        Ok(probe)
    }

    /// Returns `true` if the material folds at a smaller part of the load, and the reference does not tell good results there.
    fn is_beyond_folds(&self, factor: f64) -> bool {
        let is_bad = |probe: Option<ProbeReference>| probe.is_none_or(|probe| probe.own_error_percent > USABLE);
        lock(&self.references).iter().any(|known| known.folds && is_bad(known.probe) && known.factor < factor)
    }

    /// Returns the reference under a part of the load, if it has been computed.
    fn known(&self, factor: f64) -> Option<KnownReference> {
        lock(&self.references).iter().find(|known| known.factor == factor).copied()
    }

    /// Solves a scene from rest under a part of its load, and compares the result with the reference if `is_compared`.
    fn point(
        &self,
        own: &Scene,
        system: &Arc<System>,
        (factor, is_compared): (f64, bool),
        observe: Observer<'_>,
    ) -> Result<LimitPoint> {
        let mut solved = Simulation::with_system(&at(own, factor), system.clone())?;
        check(solved.solve_watched(&mut |_| observe(Progress::at(0.0))))?;
        if !solved.status().is_success() {
            return Ok(LimitPoint { factor, ..LimitPoint::default() });
        }
        let displacement = first_probe(&solved)?;
        let known = if is_compared { self.reference(factor, &|_| observe(Progress::at(0.0)))? } else { None };
        let deformation = Deformation::of(solved.problem(), solved.state(), &solved.nodal_stress());
        Ok(LimitPoint {
            factor,
            converges: true,
            displacement,
            max_strain: Some(deformation.max_strain),
            inverted_elements: deformation.inverted_elements,
            is_compared,
            error_percent: known.and_then(|known| known_error(&known, displacement)),
            reference_percent: known.map(|known| known.own_error_percent),
        })
    }

    /// Tries a strip's loads, from small to large, and then those between which a property changes that `is_sought`, beside a
    /// peak of the error, and next to the end of convergence. `factors` have `true` where the result is compared with the
    /// reference, as the second argument of `solve` says, which starts from rest.
    fn follow(
        &self,
        row: usize,
        factors: &[(f64, bool)],
        solve: &dyn Fn(f64, bool) -> Result<LimitPoint>,
        is_sought: &dyn Fn(Property, f64) -> bool,
    ) -> Result<()> {
        let mut strip = lock(&self.limits).strips[row].clone();
        let report = |strip: &Strip| self.change(|limits| limits.strips[row].clone_from(strip));
        for (i, &(factor, is_compared)) in factors.iter().enumerate() {
            strip.points.push(solve(factor, is_compared)?);
            strip.done = (i + 1) as f64 / (factors.len() + 1) as f64;
            report(&strip);
        }
        for _ in 0..MAX_ADDED {
            let peak = || Some((strip.beside_peak(is_sought)?, true));
            let next = strip.change(is_sought).or_else(peak).or_else(|| Some((strip.untried()?, false)));
            let Some((factor, is_error)) = next else { break };
            let place = strip.points.partition_point(|other| other.factor < factor);
            strip.points.insert(place, solve(factor, is_error)?);
        }
        strip.done = 1.0;
        report(&strip);
        Ok(())
    }
}

/// Returns the largest error of a displacement, percent; `None` if the reference's own error hides if it is usable.
fn known_error(reference: &ProbeReference, displacement: Vector2<f64>) -> Option<f64> {
    let distance = error_percent(displacement, reference.displacement)?;
    let bound = reference.error_bound(distance);
    let is_hidden = reference.own_error_percent > GOOD && distance <= USABLE && bound > USABLE;
    (!is_hidden).then_some(bound)
}

/// Returns the parts of the load, evenly spaced in their logarithm; the error is measured at every second one.
fn factors() -> Vec<f64> {
    let decades = (RANGE[1] / RANGE[0]).log10();
    let count = (f64::from(PER_DECADE) * decades).round() as i32;
    (0..=count).map(|i| RANGE[0] * 10f64.powf(f64::from(i) / f64::from(PER_DECADE))).collect()
}

/// Returns further parts of the load, between those at which the reference displacement grows much faster than the load,
/// as next to buckling with an imperfection: there the errors have a peak.
fn steep(reference: &[(f64, Option<Vector2<f64>>)]) -> Vec<f64> {
    /// Power of the load above which a displacement grows fast.
    const FAST: f64 = 2.0;
    /// Number of parts of an interval of loads.
    const PARTS: i32 = 4;
    let between = |&[(from, a), (to, b)]: &[(f64, Option<Vector2<f64>>); 2]| {
        let ratio = b.zip(a).map_or(1.0, |(b, a)| b.norm() / a.norm());
        let parts = if ratio.ln() > FAST * (to / from).ln() { PARTS } else { 1 };
        (1..parts).map(move |part| from * (to / from).powf(f64::from(part) / f64::from(PARTS)))
    };
    reference.array_windows().flat_map(between).collect()
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns a load with an error and one of the reference, percent, and a strain.
    fn compared(factor: f64, percent: Option<f64>, own: f64, max_strain: f64) -> LimitPoint {
        LimitPoint {
            factor,
            converges: true,
            max_strain: Some(max_strain),
            is_compared: true,
            error_percent: percent,
            reference_percent: Some(own),
            ..LimitPoint::default()
        }
    }

    fn point(factor: f64, percent: Option<f64>) -> LimitPoint {
        compared(factor, percent, 0.0, 1e-3)
    }

    /// Returns a load at which the method does not converge.
    fn failed(factor: f64) -> LimitPoint {
        LimitPoint { factor, ..LimitPoint::default() }
    }

    fn strip(points: Vec<LimitPoint>) -> Strip {
        Strip { points, done: 1.0, ..Strip::new(Setting::of(&Scene::beam(10.0, 1.0))) }
    }

    /// Axis of a force of 1 kN.
    fn one_kilonewton() -> LoadAxis {
        LoadAxis::of(&Scene::beam(10.0, 1.0).clamp("left").force("right", [0.0, -1000.0]))
    }

    /// An error that only the reference's own error puts above a limit is not said to be above it.
    #[test]
    fn words_tell_a_hidden_error_from_a_large_one() {
        let words = |own: f64, errors: [f64; 2]| {
            let points = [(1.0, errors[0]), (1.004, errors[1])].map(|(at, error)| compared(at, Some(error), own, 1e-3));
            strip(points.into()).words(&one_kilonewton(), [1.0, 1.004])[0].to_string()
        };
        assert_eq!(words(1.6, [1.8, 1.9]), "not known");
        assert_eq!(words(0.1, [1.8, 1.9]), "not at 1 kN");
        assert_eq!(words(0.8, [0.9, 1.5]), "at least 1 kN");
        assert_eq!(words(0.1, [0.9, 1.5]), "1 kN");
    }

    /// An end is stated only where loads on both sides of it lie next to each other.
    #[test]
    fn an_end_lies_between_two_loads_that_were_tried() {
        let range = [1.0, 16.0];
        let words = |points: &[LimitPoint]| {
            let strip = strip(points.to_vec());
            let [good, _, converges, law] = strip.words(&one_kilonewton(), range).map(|words| words.to_string());
            (good, converges, law, strip.end(&one_kilonewton(), range).unwrap().to_string())
        };
        let texts = |texts: [&str; 4]| (texts[0].into(), texts[1].into(), texts[2].into(), texts[3].into());
        let (small, beyond) = (point(1.0, Some(0.2)), compared(16.0, Some(9.0), 0.0, 0.2));
        let all = "at least 16 kN";
        assert_eq!(words(&[small, beyond]), texts(["at least 1 kN", all, "from 16 kN", "5 % to at least 1 kN"]));
        let found = [small, point(4.0, Some(0.9)), point(4.01, Some(7.0)), beyond];
        assert_eq!(words(&found), texts(["4 kN", all, "from 16 kN", "1 % to 4 kN"]));
        let fails = [small, point(4.0, Some(0.9)), failed(4.01), point(8.0, Some(0.5)), failed(16.0)];
        let again = "4 kN, not everywhere beyond";
        assert_eq!(words(&fails), texts(["4 kN", again, "\u{2013}", "1 % to 4 kN"]));
        assert_eq!(strip(fails.to_vec()).fails(), [[4.0, 8.0], [8.0, 16.0]]);
        let late = [failed(1.0), point(2.0, Some(0.5)), point(16.0, Some(0.6))];
        assert_eq!(words(&late), texts(["from 2 kN", "from 2 kN", "\u{2013}", "5 % from 2 kN"]));
        let bad = [point(1.0, Some(30.0)), point(4.0, Some(40.0)), failed(4.01), failed(16.0)];
        assert_eq!(words(&bad), texts(["not at 1 kN", "4 kN", "\u{2013}", "converges to 4 kN"]));
        assert_eq!(words(&bad[..2]).3, "not within 5 %");
        // Where the error is not known, nothing is said of the loads beyond.
        let unknown = [point(1.0, Some(0.5)), point(4.0, None), point(16.0, Some(7.0))];
        assert_eq!(words(&unknown).0, "at least 1 kN");
        assert_eq!((strip(unknown.to_vec()).within(GOOD), strip(unknown.to_vec()).last_known()), (None, Some(1.0)));
    }

    /// Pieces cover the whole range, with the rating of the loads in them.
    #[test]
    fn each_load_has_the_piece_around_it() {
        let only_converges = LimitPoint { factor: 3.0, converges: true, ..LimitPoint::default() };
        let points = vec![
            point(1.0, Some(0.2)),
            only_converges,
            compared(4.0, Some(3.0), 0.0, 0.2),
            point(8.0, None),
            failed(16.0),
        ];
        let pieces = strip(points.clone()).pieces([1.0, 16.0]);
        assert!(pieces.windows(2).all(|pair| pair[0].range[1] == pair[1].range[0]), "{pieces:?}");
        let ends = [pieces[0].range[0], pieces[pieces.len() - 1].range[1]];
        assert_eq!(ends, [1.0, 16.0]);
        for point in points {
            let piece = pieces.iter().find(|piece| point.factor <= piece.range[1]).unwrap();
            let rating = point.rating().unwrap_or(Rating::Good);
            let is_beyond_law = point.answer(Property::Law) == Some(Some(false));
            assert_eq!((piece.rating, piece.is_beyond_law), (rating, is_beyond_law), "{point:?}");
        }
    }

    /// Where a fine mesh folds, the reference of `article` is inaccurate: the error of a good element is not known there,
    /// that of one that locks is large all the same.
    #[test]
    fn an_inaccurate_reference_ends_what_is_known() {
        let source = crate::scene::Source { name: "article".into(), assignments: Vec::new() };
        let article = at(&crate::scene::open(&source).unwrap(), 74.0 / 30.0);
        let reference = Reference::of(&article).unwrap();
        let first = reference.first().unwrap();
        assert!(reference.folds && first.own_error_percent > USABLE, "{first:?}");
        let error = |element: ElementKind| {
            let mut scene = article.clone().with_method(MethodKind::Newton);
            scene.set_element(element);
            let mut simulation = Simulation::new(&scene).unwrap();
            simulation.solve();
            known_error(&first, first_probe(&simulation).unwrap())
        };
        assert_eq!(error(ElementKind::T6), None);
        assert!(error(ElementKind::T3).is_some_and(|error| error > USABLE));
    }

    /// A column buckles at Euler's load; a beam that is bent does not.
    #[test]
    fn the_critical_load_of_a_column_is_eulers() {
        let euler = std::f64::consts::PI.powi(2) * 1e6 * 0.5f64.powi(3) / 12.0 / 400.0;
        let column = Scene::beam(10.0, 0.5).with_cells(20, 2).with_element(ElementKind::Q4).clamp("left");
        let critical = |scene: &Scene| {
            let system = Arc::new(System::new(scene).unwrap());
            super::critical(scene, &system, &|_| std::ops::ControlFlow::Continue(()))
        };
        let bent = column.clone().force("right", [0.0, -0.1 * euler]).probe("tip", "right");
        assert_eq!(critical(&bent), None);
        let column = column.force("right", [-0.5 * euler, 0.0]).probe("tip", "right");
        assert!((0.5 * critical(&column).unwrap() - 1.0).abs() < 0.02);
    }

    /// Next to the buckling load of a column with an imperfection the error has a peak, which is not missed: single solves
    /// there are within the limits of their strip.
    #[test]
    fn the_peak_of_the_error_of_an_imperfect_column_is_found() {
        let source = crate::scene::Source { name: "column".into(), assignments: Vec::new() };
        let column = crate::scene::open(&source).unwrap();
        let limits = MethodLimits::of(&column, &|_| std::ops::ControlFlow::Continue(()), &|_| {}).unwrap();
        for factor in [0.68, 500.0 / 700.0, 0.73] {
            let reference = Reference::of(&at(&column, factor)).unwrap().first().unwrap();
            for element in [ElementKind::T6, ElementKind::Q4] {
                let mut scene = at(&column, factor);
                scene.set_element(element);
                let mut simulation = Simulation::new(&scene).unwrap();
                simulation.solve();
                let probe = first_probe(&simulation).unwrap();
                let error = reference.error_bound(error_percent(probe, reference.displacement).unwrap());
                let is_own = |strip: &&Strip| {
                    strip.setting == Setting { element, method: MethodKind::Newton, ..Setting::of(&column) }
                };
                let strip = limits.strips.iter().find(is_own).unwrap();
                let piece = strip.pieces(RANGE).into_iter().find(|piece| factor < piece.range[1]).unwrap();
                let stated = if piece.rating == Rating::Good { GOOD } else { USABLE };
                assert!(error < 1.1 * stated, "{element:?} at {factor}: {error} %, {piece:?}");
            }
        }
    }
}
