//! Paths of equilibria by pseudo-arclength continuation: a curve of solutions of r(x, λ) = 0, followed in its own
//! length, so that it can turn back in λ.
//!
//! A step predicts along the unit tangent of (x, λ) and corrects by Newton's method in the plane normal to it, with two
//! back substitutions of one factor (Riks 1979; Keller 1977). It is accepted if
//!
//! - the corrections contract at least by Θ = ¼ (Deuflhard, *Newton Methods for Nonlinear Problems*, section 5.1), and
//!   the first one is at most half of the step;
//! - the tangent turns by an angle with a cosine of at least 0.8;
//! - the **inertia is consistent**: the number of negative eigenvalues of the tangent matrix changes by one exactly
//!   where dλ/ds changes its sign, and nowhere else. A step that left its branch violates this.
//!
//! Otherwise the step is shortened. Failed corrections are first tried again with the other stress in the tangent matrix, if
//! the equations allow it. An inertia that stays inconsistent in the smallest step is a bifurcation.

/// Equations r(x, λ) = 0 of a path.
pub(crate) trait PathEquations {
    /// State x.
    type Configuration: Clone;

    /// Returns the number of unknowns.
    fn unknowns(&self) -> usize;

    /// Moves a state by `length` times `direction` over the unknowns, and its prescribed components from the first load
    /// factor λ to the second.
    fn advance(&self, state: &mut Self::Configuration, direction: &[f64], length: f64, factors: [f64; 2]);

    /// Sets the parts of a state that follow from its unknowns, such as the rotations of elements; a state of unknowns
    /// alone has none.
    fn complete(&self, _state: &mut Self::Configuration) {}

    /// Linearizes the equations at a state and load factor: writes Newton's correction at fixed λ into `correction` and
    /// dx/dλ at fixed residual into `rate`. Returns the number of negative eigenvalues of the tangent matrix, or `None`
    /// if the results are not finite. If `stressed` is given, the tangent matrix has the stress of that state.
    fn linearize(
        &mut self,
        state: &mut Self::Configuration,
        factor: f64,
        stressed: Option<&Self::Configuration>,
        correction: &mut [f64],
        rate: &mut [f64],
    ) -> Option<usize>;

    /// Returns the critical mode of the last linearization: the one with the eigenvalue closest to 0. `None` if unknown.
    fn critical_mode(&mut self) -> Option<CriticalMode>;
}

/// Mode of the tangent matrix with the eigenvalue closest to 0.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CriticalMode {
    /// Eigenvalue: its stiffness.
    pub stiffness: f64,
    /// Cosine of the angle between the growing load and the mode. It vanishes where another path crosses.
    pub cosine: f64,
}

/// Equilibrium on a path.
#[derive(Clone, Debug)]
pub(crate) struct ContinuationPoint<S> {
    /// State x.
    pub state: S,
    /// Load factor λ.
    pub factor: f64,
    /// Number of negative eigenvalues of the tangent matrix.
    pub modes: usize,
    /// Unit tangent: dx/ds.
    tangent: Vec<f64>,
    /// Unit tangent: dλ/ds.
    pub slope: f64,
    /// Estimates of the first and second derivatives of the tangent along the path, over (x, λ).
    derivatives: Vec<Vec<f64>>,
}

/// Critical point that a step has passed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Critical {
    /// λ has an extreme value there: a limit point.
    Limit,
    /// λ has an extreme value there, but no mode loses its stability: a branch ends in another path.
    Tip,
    /// Another path crosses this one; the numbers of negative eigenvalues before and after it.
    Bifurcation([usize; 2]),
}

/// Reason why a path could not be continued.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum PathFailure {
    /// No step was accepted, however short.
    Stuck,
    /// The number of linearizations reached its limit.
    Limit,
}

/// Largest ratio of successive corrections.
const MAX_CONTRACTION: f64 = 0.25;
/// Contraction at which the length of steps stays as it is.
const WANTED_CONTRACTION: f64 = 0.1;
/// Largest first correction relative to the step.
const MAX_FIRST_CORRECTION: f64 = 0.5;
/// Largest second-order or third-order part of a prediction relative to the step.
const MAX_TURN: f64 = 0.25;
/// Smallest cosine of the angle between successive tangents.
const MIN_COSINE: f64 = 0.8;
/// Cosine of the angle between tangents below which steps do not grow.
const STRAIGHT: f64 = 0.95;
/// Correction, relative to the step, with which a point counts as converged: the inertia is then that of the path. The next
/// step corrects the remaining error.
const CONVERGED: f64 = 1e-5;
/// Largest error of a point that counts as converged.
const RESIDUE: f64 = 2e-3;
/// Correction that is only rounding error.
const ROUNDING: f64 = 1e-9;
/// Largest number of corrections of a step.
const MAX_CORRECTIONS: u32 = 8;
/// Length of the first step.
const FIRST_STEP: f64 = 0.1;
/// Longest step, in the norm of (x, λ), unless the path is long.
const MAX_STEP: f64 = 1.0;
/// Longest step relative to the length of the path so far. Bodies that are stretched to many times their size have long
/// and straight paths.
const MAX_RELATIVE_STEP: f64 = 0.05;
/// Step in which an inconsistent inertia counts as a bifurcation in any case: steps of this length resolve the turn of a
/// column with an imperfection of about 1e-13 of the load.
const BIFURCATION_STEP: f64 = 1e-6;
/// Fraction of the smaller slope dλ/ds at the ends of a step; if λ rises less in between, the step may pass two limit
/// points.
const MIN_SLOPE_BETWEEN: f64 = 0.25;
/// Steps shorter than this are not halved where they may pass two limit points.
const MIN_RESOLVED_STEP: f64 = 1e-3;
/// Factor by which a step with an inconsistent inertia is shortened.
const SHORTER: f64 = 0.25;
/// Step in which several bifurcations count as one.
const MIN_SEPARATION: f64 = 1e-3;
/// Step below which a path counts as ended.
const MIN_STEP: f64 = 1e-7;
/// Largest number of retreats: if no step is accepted, the last one is taken back and repeated shorter, because near a sharp
/// turn a small error of a point can change its number of negative eigenvalues.
const MAX_RETREATS: u32 = 4;
/// Length of the step after a retreat, relative to the step that is taken back.
const RETREAT: f64 = 0.3;
/// Relative error of a limit point's load factor.
const LIMIT_TOLERANCE: f64 = 1e-6;

/// Stiffness of the critical mode at a bifurcation, relative to that at the point before it.
const CROSSING_TOLERANCE: f64 = 1e-5;
/// Largest cosine between load and critical mode that is rounding error.
const ORTHOGONAL: f64 = 2e-14;
/// On a path that is unstable already: largest cosine between load and critical mode at a bifurcation.
const NEARLY_ORTHOGONAL: f64 = 1e-7;

/// Path of solutions from a first one, followed step by step.
#[derive(Clone, Debug)]
pub(crate) struct Continuation<S> {
    /// Last point.
    pub(crate) point: ContinuationPoint<S>,
    /// Point before the last step.
    pub(crate) before: ContinuationPoint<S>,
    step: f64,
    /// Length of the path so far.
    length: f64,
    /// Length of the last step, if that can be taken back.
    last_step: Option<f64>,
    /// Number of steps that were taken back.
    retreats: u32,
    /// Mean curvature of the last step, and its length.
    curvature: Option<(Vec<f64>, f64)>,
    /// Weight of the square of x in the norm of (x, λ).
    weight: f64,
    /// Number of linearizations so far.
    pub(crate) linearizations: u32,
    /// Number of these that only locate bifurcations beyond the first.
    pub(crate) located: u32,
    /// Largest number of linearizations.
    pub(crate) max_linearizations: u32,
    /// Largest change of λ in a step.
    pub(crate) max_by_factor: f64,
    /// `true` if bifurcations beyond the first one, where the path is unstable already, are located too.
    pub(crate) locates_all: bool,
    /// Number of places in a unit of λ at which steps look for bifurcations that hide each other.
    pub(crate) places: f64,
    /// `true` if a step that is not accepted is tried with the other value of `stress_lags`.
    pub(crate) may_lag: bool,
    /// `true` if the tangent matrix has the stress before each correction.
    stress_lags: bool,
    scratch: [Vec<f64>; 2],
}

/// Returns the scalar product of two vectors.
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Returns the difference of two vectors over a length.
fn slope(from: &[f64], to: &[f64], length: f64) -> Vec<f64> {
    from.iter().zip(to).map(|(from, to)| (to - from) / length).collect()
}

/// Returns the derivatives of the tangent at the second of two points at this distance: differences of the tangents, and
/// of the curvatures of this step and the one before, `last`, with its length.
fn derivatives<S>(
    [from, to]: [&ContinuationPoint<S>; 2],
    step: f64,
    last: Option<&(Vec<f64>, f64)>,
) -> (Vec<f64>, Vec<Vec<f64>>) {
    let whole = |p: &ContinuationPoint<S>| [&p.tangent[..], &[p.slope]].concat();
    let curvature = slope(&whole(from), &whole(to), step);
    let derivatives = match last {
        Some((before, length)) => {
            let second = slope(before, &curvature, 0.5 * (length + step));
            // The difference is the curvature in the middle of the step.
            let first = curvature.iter().zip(&second).map(|(c, d)| c + 0.5 * step * d).collect();
            vec![first, second]
        }
        None => vec![curvature.clone()],
    };
    (curvature, derivatives)
}

/// Returns `true` if λ may have extreme values between two points at this distance, with slopes of the same sign: its
/// cubic interpolation rises much less between them than at either.
fn may_pass_limits<S>(from: &ContinuationPoint<S>, to: &ContinuationPoint<S>, step: f64) -> bool {
    let sign = from.slope.signum();
    let [start, end, mean] = [from.slope, to.slope, (to.factor - from.factor) / step].map(|slope| sign * slope);
    // The cubic's slope is start (1 − t)² + 2 m t (1 − t) + end t², with this m.
    let m = 3.0 * mean - start - end;
    let curvature = start + end - 2.0 * m;
    let at = if curvature > 0.0 { ((start - m) / curvature).clamp(0.0, 1.0) } else { 0.0 };
    let least = start * (1.0 - at).powi(2) + 2.0 * m * at * (1.0 - at) + end * at * at;
    least < MIN_SLOPE_BETWEEN * start.min(end)
}

impl<S: Clone> Continuation<S> {
    /// Starts at a solution at λ = `factor`, toward growing λ. A unit of the norm is `unit` for the root mean square of
    /// the unknowns, and 1 for λ.
    pub fn start(
        equations: &mut impl PathEquations<Configuration = S>,
        mut state: S,
        factor: f64,
        unit: f64,
        max_linearizations: u32,
    ) -> Option<Self> {
        let n = equations.unknowns();
        let weight = 1.0 / (n.max(1) as f64 * unit * unit);
        let (mut correction, mut rate) = (vec![0.0; n], vec![0.0; n]);
        let modes = equations.linearize(&mut state, factor, None, &mut correction, &mut rate)?;
        let length = (weight * dot(&rate, &rate) + 1.0).sqrt();
        let slope = 1.0 / length;
        let tangent = rate.iter().map(|v| v * slope).collect();
        let point = ContinuationPoint { state, factor, modes, tangent, slope, derivatives: Vec::new() };
        let usable = weight.is_finite() && slope.is_finite() && slope > 0.0;
        let before = point.clone();
        let (step, scratch) = (FIRST_STEP, [correction, rate]);
        let made = Self {
            point,
            before,
            step,
            length: 0.0,
            last_step: None,
            retreats: 0,
            curvature: None,
            weight,
            linearizations: 1,
            located: 0,
            max_linearizations,
            max_by_factor: f64::INFINITY,
            locates_all: false,
            places: 0.0,
            may_lag: false,
            stress_lags: false,
            scratch,
        };
        usable.then_some(made)
    }

    /// Takes one step; returns the critical point that it has passed, with its place, if any.
    pub fn step(
        &mut self,
        equations: &mut impl PathEquations<Configuration = S>,
    ) -> Result<Option<(Critical, ContinuationPoint<S>)>, PathFailure> {
        let longest = MAX_STEP.max(MAX_RELATIVE_STEP * self.length);
        let mut step = self.step.min(longest).min(self.max_by_factor / self.point.slope.abs());
        let mut was_rejected = false;
        loop {
            if self.linearizations >= self.max_linearizations {
                return Err(PathFailure::Limit);
            }
            let from = self.point.clone();
            let corrected = self.correct(equations, &from, step, None).or_else(|| {
                self.stress_lags ^= self.may_lag;
                self.may_lag.then(|| self.correct(equations, &from, step, None))?
            });
            let Some((point, contraction, cosine)) = corrected else {
                step *= 0.5;
                was_rejected = true;
                if step < MIN_STEP {
                    step = self.retreat().ok_or(PathFailure::Stuck)?;
                }
                continue;
            };
            let turns = (point.slope < 0.0) != (from.slope < 0.0);
            let change = point.modes.abs_diff(from.modes);
            let consistent = if turns { change == 1 } else { change == 0 };
            // Several bifurcations in one step are told apart in shorter ones.
            let is_single = change == 1 || step <= MIN_SEPARATION;
            let mode = if !consistent && !turns && is_single { equations.critical_mode() } else { None };
            // On a path that is unstable already, small imperfections count as none.
            let orthogonal = if from.modes > 0 { NEARLY_ORTHOGONAL } else { ORTHOGONAL };
            // After a long step the eigenvalue of another mode may be closer to 0 than the one that has changed its sign.
            let has_crossed = |mode: &CriticalMode| (mode.stiffness < 0.0) == (point.modes > from.modes);
            let crossed = mode.filter(|mode| mode.cosine <= orthogonal && has_crossed(mode));
            if !consistent && crossed.is_none() && step > BIFURCATION_STEP {
                step = (SHORTER * step).max(BIFURCATION_STEP);
                continue;
            }
            // A second bifurcation within a step may undo the first: both ends then have as many unstable modes.
            let places = (self.places * (point.factor - from.factor).abs()) as u32;
            let mut hides_two = || {
                (1..=places).any(|place| {
                    let part = f64::from(place) / f64::from(places + 1);
                    let between = self.correct_between(equations, &from, [0.0, step], part);
                    between.is_some_and(|(_, between)| between.modes != point.modes)
                })
            };
            let is_long = consistent && !turns && step > MIN_RESOLVED_STEP;
            if is_long && (may_pass_limits(&from, &point, step) || hides_two()) {
                step *= 0.5;
                was_rejected = true;
                continue;
            }
            let may_grow = cosine >= STRAIGHT && !was_rejected;
            let growth = (WANTED_CONTRACTION / contraction).sqrt().min(if may_grow { 2.0 } else { 1.0 });
            self.step = step * growth;
            self.length += step;
            self.last_step = (consistent && !turns).then_some(step);
            self.before = std::mem::replace(&mut self.point, point);
            let last = self.curvature.take();
            let (curvature, derivatives) = derivatives([&self.before, &self.point], step, last.as_ref());
            self.curvature = Some((curvature, step));
            self.point.derivatives = derivatives;
            if !consistent && !turns {
                let modes = [self.before.modes, self.point.modes];
                return Ok(Some((Critical::Bifurcation(modes), self.crossing(equations, step, crossed))));
            }
            let kind = if consistent { Critical::Limit } else { Critical::Tip };
            return Ok(turns.then(|| (kind, self.limit(equations, step))));
        }
    }

    /// Takes the last step back, if it passed no critical point; returns the length of the next one.
    fn retreat(&mut self) -> Option<f64> {
        let last = self.last_step.take().filter(|_| self.retreats < MAX_RETREATS)?;
        self.retreats += 1;
        self.length -= last;
        self.curvature = None;
        self.point = self.before.clone();
        Some(RETREAT * last)
    }

    /// Counts a linearization; `None` if the limit of their number is reached.
    fn count(&mut self) -> Option<()> {
        let has_more = self.linearizations < self.max_linearizations;
        self.linearizations += u32::from(has_more);
        has_more.then_some(())
    }

    /// Returns the last point before the bifurcation within the last step, of this length; `beyond` is the critical mode
    /// at its end.
    fn crossing(
        &mut self,
        equations: &mut impl PathEquations<Configuration = S>,
        step: f64,
        beyond: Option<CriticalMode>,
    ) -> ContinuationPoint<S> {
        /// Largest number of trial steps.
        const MAX_TRIALS: u32 = 20;
        /// Number of bisections for bifurcations beyond the first.
        const MAX_BISECTIONS: u32 = 9;
        let from = self.before.clone();
        let mut best = from.clone();
        if step <= BIFURCATION_STEP {
            return best;
        }
        if from.modes > 0 {
            // Beyond the first bifurcation, the critical mode at `from` may be the one of the bifurcation before.
            let (mut low, mut high, before) = (0.0, step, self.linearizations);
            for _ in 0..if self.locates_all { MAX_BISECTIONS } else { 0 } {
                // Next to the singular tangent, the last point before it is a better start.
                let found = self.correct_between(equations, &from, [low, high], 0.5).or_else(|| {
                    let (step, point) = self.correct_between(equations, &best, [0.0, high - low], 0.5)?;
                    Some((low + step, point))
                });
                let Some((middle, point)) = found else { break };
                if point.modes == from.modes { (low, best) = (middle, point) } else { high = middle }
            }
            self.located += self.linearizations - before;
            return best;
        }
        if self.count().is_none() {
            return best;
        }
        let mut state = from.state.clone();
        let [correction, rate] = &mut self.scratch;
        let _ = equations.linearize(&mut state, from.factor, None, correction, rate);
        let stiffness = |mode: Option<CriticalMode>| mode.map(|mode| mode.stiffness);
        let (Some(first), Some(last)) = (stiffness(equations.critical_mode()), stiffness(beyond)) else { return best };
        let (mut low, mut high, mut was_good) = ((0.0, first), (step, last), true);
        for _ in 0..MAX_TRIALS {
            // A secant if both ends have the crossing mode and the last trial was good, else a bisection.
            let uses_secant = low.1 > 0.0 && high.1 < 0.0 && was_good;
            let part = if uses_secant { low.1 / (low.1 - high.1) } else { 0.5 };
            let width = high.0 - low.0;
            let ends = [low.0, high.0];
            let Some((middle, point)) = self.correct_between(equations, &from, ends, part) else { break };
            let Some(stiffness) = stiffness(equations.critical_mode()) else { break };
            let is_near = stiffness.abs() <= CROSSING_TOLERANCE * first.abs();
            if point.modes == from.modes {
                (low, best) = ((middle, stiffness), point);
            } else {
                high = (middle, stiffness);
                // A point just beyond the bifurcation serves too, with the number of negative eigenvalues before it.
                if is_near {
                    best = ContinuationPoint { modes: from.modes, ..point };
                }
            }
            if is_near {
                break;
            }
            was_good = high.0 - low.0 <= 0.5 * width;
        }
        best
    }

    /// Corrects after a part of an interval of steps from a point; if that fails, as it does next to a singular tangent,
    /// after other parts of it. Returns the step and the point.
    fn correct_between(
        &mut self,
        equations: &mut impl PathEquations<Configuration = S>,
        from: &ContinuationPoint<S>,
        [low, high]: [f64; 2],
        part: f64,
    ) -> Option<(f64, ContinuationPoint<S>)> {
        let steps = [part, 0.5 * part, 0.5 * (1.0 + part)].map(|part| low + (high - low) * part);
        steps.into_iter().find_map(|step| Some((step, self.correct(equations, from, step, None)?.0)))
    }

    /// Returns the limit point within the last step, of this length.
    fn limit(&mut self, equations: &mut impl PathEquations<Configuration = S>, step: f64) -> ContinuationPoint<S> {
        /// Largest number of trial steps.
        const MAX_TRIALS: u32 = 12;
        let from = self.before.clone();
        let mut best = if from.slope.abs() < self.point.slope.abs() { from.clone() } else { self.point.clone() };
        let (mut low, mut high) = ((0.0, from.slope), (step, self.point.slope));
        for _ in 0..MAX_TRIALS {
            // Between secant and bisection, so that both ends move.
            let secant = low.0 + (high.0 - low.0) * low.1 / (low.1 - high.1);
            let middle = 0.8 * secant + 0.1 * (low.0 + high.0);
            let Some((point, ..)) = self.correct(equations, &from, middle, None) else { break };
            let slope = point.slope;
            if slope.abs() < best.slope.abs() {
                best = point;
            }
            if (slope < 0.0) == (low.1 < 0.0) {
                low = (middle, slope)
            } else {
                high = (middle, slope)
            }
            if best.slope.abs() * (high.0 - low.0) <= LIMIT_TOLERANCE * best.factor.abs() {
                break;
            }
        }
        best
    }

    /// Returns the point on the path at λ = `goal` between two of its points, with an error of order [`CONVERGED`];
    /// `None` if they do not enclose it, or no point is found.
    pub fn between(
        &mut self,
        equations: &mut impl PathEquations<Configuration = S>,
        from: &ContinuationPoint<S>,
        to: &ContinuationPoint<S>,
        goal: f64,
    ) -> Option<ContinuationPoint<S>> {
        /// Largest number of trial steps.
        const MAX_TRIALS: u32 = 30;
        let way = |p: &ContinuationPoint<S>| (goal - p.factor) / p.slope;
        if (goal - from.factor) * (goal - to.factor) > 0.0 {
            return None;
        }
        let modes = from.modes.min(to.modes)..=from.modes.max(to.modes);
        let is_between = |point: &ContinuationPoint<S>| modes.contains(&point.modes);
        // From the nearer end: where λ is nearly constant, a step at fixed λ is long.
        let is_forward = way(from).abs() <= way(to).abs();
        let mut near = if is_forward { from.clone() } else { to.clone() };
        // The last point before the goal; short steps from it meet the goal where the path turns sharply.
        let mut last = near.clone();
        let mut length = (0.5 * way(&near)).clamp(-MAX_STEP, MAX_STEP);
        for _ in 0..MAX_TRIALS {
            let found = self.correct(equations, &near, way(&near), Some(goal)).map(|(point, ..)| point);
            if let Some(found) = found.filter(|p| is_between(p) && (p.slope < 0.0) == (near.slope < 0.0)) {
                return Some(found);
            }
            if self.linearizations >= self.max_linearizations {
                break;
            }
            match self.correct(equations, &last, length, None).map(|(point, ..)| point).filter(is_between) {
                Some(point) => {
                    let is_before = (goal - point.factor) * (goal - last.factor) > 0.0;
                    if is_before {
                        let longest = (2.0 * length.abs()).min(MAX_STEP);
                        length = (0.5 * way(&point)).clamp(-longest, longest);
                        last = point.clone();
                    } else {
                        length *= 0.5;
                    }
                    near = point;
                }
                None => length *= 0.5,
            }
        }
        // Next to a bifurcation the corrections are rounding errors, and the prediction is more accurate.
        let mut state = from.state.clone();
        equations.advance(&mut state, &from.tangent, way(from), [from.factor, goal]);
        equations.complete(&mut state);
        (from.modes != to.modes).then(|| ContinuationPoint {
            state,
            factor: goal,
            derivatives: Vec::new(),
            ..from.clone()
        })
    }

    /// Predicts by a step along the tangent and corrects in the plane normal to it, or at fixed λ = `goal`. Returns the
    /// point, the largest contraction, and the cosine of the angle between the tangents.
    fn correct(
        &mut self,
        equations: &mut impl PathEquations<Configuration = S>,
        from: &ContinuationPoint<S>,
        step: f64,
        goal: Option<f64>,
    ) -> Option<(ContinuationPoint<S>, f64, f64)> {
        let mut state = from.state.clone();
        // Load factors of the prediction, and of the state.
        let (mut factor, mut at) = (goal.unwrap_or(from.factor + step * from.slope), from.factor);
        // Higher orders of the prediction keep slender bodies from a spurious stretch, under which they are stiff.
        let orders = [0.5 * step * step, step.powi(3) / 6.0];
        for (by, part) in from.derivatives.iter().zip(orders).filter(|_| goal.is_none()) {
            let (by_factor, by_x) = by.split_last()?;
            let size = (self.weight * dot(by_x, by_x) + by_factor * by_factor).sqrt();
            if part.abs() * size > MAX_TURN * step.abs() {
                break;
            }
            factor += part * by_factor;
            equations.advance(&mut state, by_x, part, [at, factor]);
            at = factor;
        }
        equations.advance(&mut state, &from.tangent, step, [at, factor]);
        let least = if goal.is_some() { RESIDUE } else { 0.0 };
        let first = (MAX_FIRST_CORRECTION * step.abs()).max(least);
        let converged = (CONVERGED * step.abs()).max(1e-4 * least);
        let (mut last, mut contraction): (Option<f64>, f64) = (None, 1e-3);
        // The start of the step; after a correction, the corrected state with the rotations before.
        let mut stressed = self.stress_lags.then(|| from.state.clone());
        for _ in 0..MAX_CORRECTIONS {
            self.count()?;
            let [correction, rate] = &mut self.scratch;
            let modes = equations.linearize(&mut state, factor, stressed.as_ref(), correction, rate)?;
            let [along, across] = [&*correction, &*rate].map(|v| self.weight * dot(&from.tangent, v));
            let by = if goal.is_some() { 0.0 } else { -along / (across + from.slope) };
            correction.iter_mut().zip(&*rate).for_each(|(c, r)| *c += by * r);
            let size = (self.weight * dot(correction, correction) + by * by).sqrt();
            if let Some(last) = last.filter(|last| *last > ROUNDING) {
                contraction = contraction.max(size / last);
            }
            let allowed = last.map_or(first, |last| MAX_CONTRACTION * last);
            if size.is_nan() || size > allowed.max(ROUNDING) {
                return None;
            }
            equations.advance(&mut state, correction, 1.0, [factor, factor + by]);
            factor += by;
            // The prediction stretches a slender body, and a stretched body has another tangent: one small correction does
            // not prove convergence.
            let is_corrected = last.replace(size).is_some() || goal.is_some();
            if size <= ROUNDING || is_corrected && size <= converged {
                equations.complete(&mut state);
                let length = (self.weight * dot(rate, rate) + 1.0).sqrt();
                let cosine = (self.weight * dot(&from.tangent, rate) + from.slope) / length;
                let slope = cosine.signum() / length;
                let tangent = rate.iter().map(|v| v * slope).collect();
                let point = ContinuationPoint { state, factor, modes, tangent, slope, derivatives: Vec::new() };
                return (cosine.abs() >= MIN_COSINE).then_some((point, contraction, cosine.abs()));
            }
            stressed = stressed.map(|_| state.clone());
        }
        None
    }
}
