//! Limits of every method and element on a scene: up to which load each is within 1 % and 5 % of the reference solution,
//! where it stops to converge, and where strains leave the linear law. In motion: the same of every integrator, up to
//! which time step. Loads are tried from small to large; each stated end lies between two of them that differ by at most
//! one percent.

use std::sync::Mutex;

use serde::{Deserialize, Serialize};

use super::figure::{Ink, LoadAxis};
use super::prelude::*;
use crate::stress::LAW_HOLDS;

mod motion;
mod rest;

/// Smallest and largest part of the scene's loads and prescribed displacements.
pub const RANGE: [f64; 2] = [0.01, 10.0];
/// Smallest and largest part of the time step of a motion.
pub const TIME_STEPS: [f64; 2] = [1.0 / 16.0, 8.0];
/// Further loads of a strip relative to the critical load of its mesh, near which errors change within a percent of the
/// load.
const NEAR_CRITICAL: [f64; 2] = [0.99, 1.01];
/// Error, percent, up to which a result counts as good.
pub const GOOD: f64 = 1.0;
/// Error, percent, up to which a result counts as usable.
pub const USABLE: f64 = 5.0;
/// Ratio of the reference's own error to a limit from which on it may hide if an error is within the limit.
pub const LARGE_OWN: f64 = 0.5;
/// Ratio of two loads between which a change is not sought any more.
const FINE: f64 = 1.01;
/// Largest number of loads of a strip that are added to find where its results change.
const MAX_ADDED: usize = 60;
/// Approximate fraction of the time spent on the reference solutions.
const REFERENCE: f64 = 0.5;

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
    /// `true` if ends of errors are sought below this load: not where the reference folds, nor between the time steps of a
    /// motion.
    pub seeks_errors: bool,
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
            Property::Within(limit) => self.is_compared.then(|| {
                let (error, own) = (self.error_percent?, self.reference_percent.unwrap_or_default());
                // Without the error of the reference, which is large, it may be within the limit.
                let is_hidden = error > limit && error - own <= limit && own > LARGE_OWN * limit;
                (!is_hidden).then_some(error <= limit)
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

/// Loads in a row with one value: the first and the last of them.
type LoadRange<T> = ([f64; 2], T);

/// Returns the rows of loads with equal values.
fn rows<T: Copy + PartialEq>(loads: impl Iterator<Item = (f64, T)>) -> Vec<LoadRange<T>> {
    let loads: Vec<(f64, T)> = loads.collect();
    let rows = loads.chunk_by(|(_, a), (_, b)| a == b);
    rows.map(|row| ([row[0].0, row[row.len() - 1].0], row[0].1)).collect()
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
    /// Returns the name of the integrator, or the names of element and method, translated by `text`, with the number of
    /// iterations of an early stop: `q4 warped:2`.
    pub fn name(&self, text: impl Fn(&'static str) -> String) -> String {
        let Setting { element, iterations, stepping, .. } = self.setting;
        let name = text(self.setting.series());
        match (stepping, iterations) {
            (Some(_), _) => name,
            (None, 0) => format!("{} {name}", element.id()),
            (None, _) => format!("{} {name}:{iterations}", element.id()),
        }
    }

    /// Returns the loads at which a property was sought, with the answers.
    fn answers(&self, property: Property) -> impl Iterator<Item = (&LimitPoint, Option<bool>)> {
        self.points.iter().filter_map(move |point| Some((point, point.answer(property)?)))
    }

    /// Returns the rows of loads with one answer.
    fn rows(&self, property: Property) -> Vec<LoadRange<Option<bool>>> {
        rows(self.answers(property).map(|(point, answer)| (point.factor, answer)))
    }

    /// Returns the part of the load up to which the error is at most `percent`: 0 if it is larger at the smallest load, and
    /// `None` if it is not known there. It is larger beyond unless this is [`Self::last_known`].
    pub fn within(&self, percent: f64) -> Option<f64> {
        let (range, is_within) = *self.rows(Property::Within(percent)).first()?;
        Some(if is_within? { range[1] } else { 0.0 })
    }

    /// Returns the largest part of the load up to which the error is known at every load; `None` if it is not known at the
    /// smallest load.
    pub fn last_known(&self) -> Option<f64> {
        let rated = self.points.iter().filter_map(|point| Some((point.factor, point.rating()?)));
        let known = rated.take_while(|(_, rating)| !matches!(rating, Rating::Unknown | Rating::NotConverged));
        known.last().map(|(factor, _)| factor)
    }

    /// Returns the pairs of loads between which the method does not converge, from small to large; the first is 0 if it does
    /// not converge at the smallest load, and the last the largest load if it does not converge there.
    pub fn fails(&self) -> Vec<[f64; 2]> {
        let rows = self.rows(Property::Converges);
        let around = |(i, (range, _)): (usize, &LoadRange<Option<bool>>)| {
            let before = i.checked_sub(1).map_or(0.0, |before| rows[before].0[1]);
            [before, rows.get(i + 1).map_or(range[1], |(after, _)| after[0])]
        };
        rows.iter().enumerate().filter(|(_, (_, answer))| *answer == Some(false)).map(around).collect()
    }

    /// Returns the part of the load from which elements are inverted or strains exceed those of the linear law.
    pub fn law_ends_at(&self) -> Option<f64> {
        self.answers(Property::Law).find(|(_, answer)| *answer == Some(false)).map(|(point, _)| point.factor)
    }

    /// Returns the pieces of the strip from its first to its last load, each with its ends, its rating, and `true` if elements
    /// are inverted or strains exceed those of the linear law. Pieces meet in the middle between two loads.
    pub fn pieces(&self) -> Vec<([f64; 2], (Rating, bool))> {
        // A load at which a property was not sought has that of the load below.
        let mut last = (Rating::Unknown, false);
        let mut pieces = rows(self.points.iter().map(|point| {
            let is_beyond = point.answer(Property::Law).map(|answer| answer == Some(false));
            last = (point.rating().unwrap_or(last.0), is_beyond.unwrap_or(point.converges && last.1));
            (point.factor, last)
        }));
        for i in 1..pieces.len() {
            let middle = (pieces[i - 1].0[1] * pieces[i].0[0]).sqrt();
            (pieces[i - 1].0[1], pieces[i].0[0]) = (middle, middle);
        }
        pieces
    }

    /// Returns in words the loads up to which the error is within 1 % and 5 %, that up to which the method converges, and
    /// that from which strains exceed 10 %. `axis` is that of the scene.
    pub fn words(&self, axis: &LoadAxis) -> [Sentence; 4] {
        /// Ratio of the ends of a row that is no accident: errors are small too where results that grow too fast cross those
        /// of the reference.
        const WIDE: f64 = 1.5;
        let load = |factor: f64| load_text(axis, factor);
        let of = |property: Property| {
            let rows = self.rows(property);
            let is_wide = |[first, last]: [f64; 2]| property == Property::Converges || last > WIDE * first;
            let mut held = (0..rows.len()).filter(|&i| rows[i].1 == Some(true) && (i == 0 || is_wide(rows[i].0)));
            let Some(i) = held.next() else {
                return match rows.first() {
                    Some(([first, _], Some(false))) => sentence!("not at %{load}", load = load(*first)),
                    _ => sentence!("not known"),
                };
            };
            let (range, next) = (rows[i].0, rows.get(i + 1));
            let ends = next.is_some_and(|(next, answer)| *answer == Some(false) && next[0] <= FINE * range[1]);
            let [from, to] = range.map(load);
            let loads = match (i == 0, ends) {
                (true, true) => to.into(),
                (true, false) => sentence!("at least %{load}", load = to),
                (false, true) => sentence!("%{from} to %{to}", from, to),
                (false, false) => sentence!("from %{load}", load = from),
            };
            if ends && held.next().is_some() { sentence!("%{loads}, not everywhere beyond", loads) } else { loads }
        };
        let law = self.law_ends_at().map_or_else(|| "\u{2013}".into(), |f| sentence!("from %{load}", load = load(f)));
        [of(Property::Within(GOOD)), of(Property::Within(USABLE)), of(Property::Converges), law]
    }

    /// Returns in words the load up to which the error is within 1 %, or within 5 % if it is larger near the smallest load;
    /// `None` before the first load is solved.
    pub fn end(&self, axis: &LoadAxis) -> Option<Sentence> {
        /// Ratio of the loads that are near the smallest one.
        const NEAR: f64 = 2.0;
        let (first, [good, usable, ..]) = (self.points.first()?.factor, self.words(axis));
        let is_good = self.within(GOOD) > Some(NEAR * first);
        let (percent, loads) = if is_good { (number(GOOD), good) } else { (number(USABLE), usable) };
        Some(sentence!("%{percent} %: %{loads}", percent, loads))
    }

    /// Returns the load to try next, and `true` if its result is compared with the reference: between two loads at which a
    /// property differs, beside a peak of the error, or next to the end of convergence; `None` if all ends are found.
    fn next(&self) -> Option<(f64, bool)> {
        let peak = || Some((self.beside_peak()?, true));
        self.change().or_else(peak).or_else(|| Some((self.untried()?, false)))
    }

    /// Returns the middle between two neighbouring loads at which a property differs, unless they lie next to each other; and
    /// `true` if the property is an error.
    fn change(&self) -> Option<(f64, bool)> {
        // Shorter and longer time steps of a motion are only tried for convergence.
        let law = self.setting.stepping.is_none().then_some(Property::Law);
        let all = [Property::Within(GOOD), Property::Within(USABLE), Property::Converges].into_iter().chain(law);
        all.into_iter().find_map(|property| {
            let is_error = matches!(property, Property::Within(_));
            let answers: Vec<_> = self.answers(property).collect();
            let change = answers.array_windows().find(|[(from, before), (to, after)]| {
                let changes = before.zip(*after).is_some_and(|(before, after)| before != after);
                changes && to.factor > FINE * from.factor && (to.seeks_errors || !is_error)
            });
            change.map(|[(from, _), (to, _)]| ((from.factor * to.factor).sqrt(), is_error))
        })
    }

    /// Returns a load beside the largest of the errors around it that is below a limit, but may exceed it next to there: near
    /// buckling, errors have a narrow peak.
    fn beside_peak(&self) -> Option<f64> {
        /// Part of the limit from which on a measured peak may belong to one above the limit.
        const CLOSE: f64 = 0.5;
        /// Ratio of two loads between which no peak is sought.
        const NARROW: f64 = 1.05;
        let errors: Vec<_> = self.points.iter().filter_map(|point| Some((point, point.error_percent?))).collect();
        errors.array_windows().find_map(|&[(before, a), (at, peak), (after, b)]| {
            let is_close = [GOOD, USABLE].iter().any(|&limit| (CLOSE * limit..=limit).contains(&peak));
            let other = if at.factor.powi(2) > before.factor * after.factor { before } else { after };
            let is_wide = (other.factor / at.factor).ln().abs() > NARROW.ln();
            let is_peak = peak >= a && peak >= b && is_close && is_wide && after.seeks_errors;
            is_peak.then(|| (at.factor * other.factor).sqrt())
        })
    }

    /// Returns a load next to the first one at which the method stops to converge, if none was tried there: there, a method
    /// may converge at some loads and not at others.
    fn untried(&self) -> Option<f64> {
        /// Distance of the loads next to the end.
        const STEP: f64 = 0.005;
        let [end, _] = self.fails().into_iter().find(|[end, _]| *end > 0.0)?;
        let is_tried = |factor: &f64| self.points.iter().any(|point| (point.factor / factor - 1.0).abs() < 0.5 * STEP);
        (-6..=2).map(|n| end * (1.0 + STEP * f64::from(n))).find(|factor| !is_tried(factor))
    }
}

/// Formats a part of a scene's load or time step.
pub fn load_text(axis: &LoadAxis, factor: f64) -> String {
    engineering(three_digits(factor * axis.full), axis.unit)
}

/// Limits of all methods and elements on a scene at rest, or of all integrators of a motion.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
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
    /// Returns the part of the load at which the load path from rest buckles or jumps on the scene's mesh.
    pub fn critical(&self) -> Option<f64> {
        self.criticals.first()?.1
    }

    /// Returns the part of the load at which the load path from rest buckles or jumps on the mesh of an element.
    pub fn critical_of(&self, element: ElementKind) -> Option<f64> {
        self.criticals.iter().find(|(own, _)| *own == element)?.1
    }

    /// Returns the name of the axis, with the critical load of the scene's mesh if there is one, or with the error of a
    /// motion's mesh.
    pub fn axis_text(&self, axis: &LoadAxis) -> Sentence {
        let critical = || Some(sentence!("critical load (dashed) %{load}", load = load_text(axis, self.critical()?)));
        match self.mesh_error_text().or_else(critical) {
            Some(text) => sentence!("%{load}; %{text}", load = &axis.name, text),
            None => axis.name.clone(),
        }
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
        let [low, high] = self.range;
        // A factor has three digits.
        (0.99 * low..=1.01 * high).contains(&factor)
    }

    /// Computes the limits of a scene with a probe, on the scene's cells. The reference solution is that of
    /// [`Reference`](super::Reference) at every load, or that of a quick study of the motion. `partial` receives the limits
    /// so far each time a load has been solved; strips with the scene's own element and method are computed first.
    ///
    /// # Errors
    /// [`StudyError`]: the scene has no probe or cannot be simulated, or `observe` cancelled the computation.
    pub fn of(scene: &Scene, observe: Observer<'_>, partial: &(dyn Fn(&Self) + Sync)) -> Result<Self, StudyError> {
        match scene.analysis {
            Analysis::Static => rest::limits(scene, observe, partial),
            Analysis::Dynamic => motion::limits(scene, observe, partial),
        }
    }

    /// Adds strips with these settings, and tries these loads with each, from small to large, and then those that
    /// [`Strip::next`] adds. `loads` have `true` where the result is compared with the reference, as `solve` is told.
    fn followed(
        mut self,
        scene: &Scene,
        settings: impl Iterator<Item = Setting>,
        loads: &[(f64, bool)],
        solve: impl Fn(&Setting, (f64, bool), Observer<'_>) -> Result<LimitPoint> + Sync,
        observe: Observer<'_>,
        partial: &(dyn Fn(&Self) + Sync),
    ) -> Result<Self> {
        let own = Setting::of(scene);
        self.strips = settings.map(|setting| Strip { setting, points: Vec::new(), done: 0.0 }).collect();
        let now = match own.stepping {
            Some(_) => sentence!("following each integrator"),
            None => sentence!("following each method"),
        };
        let mut rows: Vec<(usize, Setting)> = self.strips.iter().map(|strip| strip.setting).enumerate().collect();
        rows.sort_by_key(|(_, setting)| {
            usize::from(setting.element != own.element) + usize::from(setting.series() != own.series())
        });
        let limits = Mutex::new(self.clone());
        parallel::all(&rows, observe, [REFERENCE, 1.0], &now, |&(row, setting), observe| {
            let (mut strip, critical) = (self.strips[row].clone(), self.critical_of(setting.element));
            let near = critical.into_iter().flat_map(|at| NEAR_CRITICAL.map(|part| (part * at, true)));
            let near = near.filter(|(factor, _)| (self.range[0]..self.range[1]).contains(factor));
            let mut loads: Vec<_> = loads.iter().copied().chain(near).collect();
            loads.sort_by(|(a, _), (b, _)| a.total_cmp(b));
            let report = |strip: &Strip| {
                let mut limits = lock(&limits);
                limits.strips[row].clone_from(strip);
                partial(&limits);
            };
            for tried in 0..loads.len() + MAX_ADDED {
                let Some(load) = loads.get(tried).copied().or_else(|| strip.next()) else { break };
                let place = strip.points.partition_point(|other| other.factor < load.0);
                strip.points.insert(place, solve(&setting, load, observe)?);
                strip.done = (tried + 1).min(loads.len()) as f64 / (loads.len() + 1) as f64;
                report(&strip);
            }
            strip.done = 1.0;
            report(&strip);
            Ok(())
        })?;
        Ok(lock(&limits).clone())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns a strip of loads with their errors, percent: `inf` where the method does not converge, `NaN` where the error
    /// is not known, nothing where only convergence was tried. Strains are large where errors are. `own` is the error of the
    /// reference.
    fn strip(own: f64, points: &str) -> Strip {
        let point = |text: &str| {
            let (factor, error) = text.split_once(':').unwrap();
            let error: Option<f64> = error.parse().ok();
            let is_compared = error.is_some_and(|error| error < f64::INFINITY || error.is_nan());
            LimitPoint {
                factor: factor.parse().unwrap(),
                converges: error != Some(f64::INFINITY),
                max_strain: is_compared.then_some(if error > Some(8.0) { 0.2 } else { 1e-3 }),
                is_compared,
                error_percent: error.filter(|error| error.is_finite()),
                reference_percent: Some(own),
                ..LimitPoint::default()
            }
        };
        let setting = Setting::of(&Scene::beam(10.0, 1.0));
        Strip { setting, points: points.split(' ').map(point).collect(), done: 1.0 }
    }

    /// An end is stated only where loads on both sides of it lie next to each other, and the errors of both are known.
    #[test]
    fn an_end_lies_between_two_loads_that_were_tried() {
        let axis = LoadAxis::of(&Scene::beam(10.0, 1.0).clamp("left").force("right", [0.0, -1000.0]));
        for (own, points, expected) in [
            // An error that only the reference's own error puts above a limit is not said to be above it.
            (1.6, "1:1.8 1.004:1.9", "not known | at least 1 kN | – | 5 %: at least 1 kN"),
            (0.1, "1:1.8 1.004:1.9", "not at 1 kN | at least 1 kN | – | 5 %: at least 1 kN"),
            (0.8, "1:0.9 1.004:1.5", "at least 1 kN | at least 1 kN | – | 5 %: at least 1 kN"),
            (0.1, "1:0.9 1.004:1.5", "1 kN | at least 1 kN | – | 5 %: at least 1 kN"),
            (0.0, "1:0.2 16:9", "at least 1 kN | at least 16 kN | from 16 kN | 5 %: at least 1 kN"),
            (0.0, "1:0.2 4:0.9 4.01:7 16:9", "4 kN | at least 16 kN | from 16 kN | 1 %: 4 kN"),
            (0.0, "1:0.2 4:0.9 4.01:inf 8:0.5 16:inf", "4 kN | 4 kN, not everywhere beyond | – | 1 %: 4 kN"),
            (0.0, "1:inf 2:0.5 16:0.6", "from 2 kN | from 2 kN | – | 5 %: from 2 kN"),
            (0.0, "1:30 4:40 4.01:inf 16:inf", "not at 1 kN | 4 kN | from 1 kN | 5 %: not at 1 kN"),
            // Where the error is not known, nothing is said of the loads beyond.
            (0.0, "1:0.5 4:NaN 16:7", "at least 1 kN | at least 16 kN | – | 5 %: at least 1 kN"),
        ] {
            let strip = strip(own, points);
            let [good, _, converges, law] = strip.words(&axis);
            let words = [good, converges, law, strip.end(&axis).unwrap()].map(|words| words.to_string());
            assert_eq!(words.join(" | "), expected, "{points}");
        }
        assert_eq!(strip(0.0, "1:0.2 4.01:inf 8:0.5 16:inf").fails(), [[1.0, 8.0], [8.0, 16.0]]);
        let unknown = strip(0.0, "1:0.5 4:NaN 16:7");
        assert_eq!((unknown.within(GOOD), unknown.last_known()), (Some(1.0), Some(1.0)));
    }

    /// Pieces cover the whole range, with the rating of the loads in them.
    #[test]
    fn each_load_has_the_piece_around_it() {
        let strip = strip(0.0, "1:0.2 3: 4:9 8:NaN 16:inf");
        let pieces = strip.pieces();
        assert!(pieces.array_windows().all(|[(a, _), (b, _)]| a[1] == b[0]), "{pieces:?}");
        assert_eq!([pieces[0].0[0], pieces[pieces.len() - 1].0[1]], [1.0, 16.0]);
        for point in &strip.points {
            let (_, found) = pieces.iter().find(|(range, _)| point.factor <= range[1]).unwrap();
            let is_beyond_law = point.answer(Property::Law) == Some(Some(false));
            assert_eq!(*found, (point.rating().unwrap_or(Rating::Good), is_beyond_law), "{point:?}");
        }
    }
}
