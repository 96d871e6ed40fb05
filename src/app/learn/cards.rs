//! The cards: a new one is an entry here, and a file for what it draws.

use egui::{Painter, Ui};

use super::{Learn, Needs, Shown, View, area, exploded, frames, locking, matrices, residuals, trade};
use crate::app::action::Action;
use crate::scene::{Load, MethodKind, Scene};
use crate::simulation::Field;

/// A step of the way through the article.
pub(in crate::app) struct Card {
    pub title: &'static str,
    /// Two or three sentences.
    pub words: &'static str,
    /// One or several, in the markup of [`super::formula`].
    pub formula: &'static [&'static str],
    /// One thing to do.
    pub task: &'static str,
    pub setup: Setup,
    /// What takes a while to find out, and is asked for.
    pub needs: Needs,
    /// Shows numbers and controls beside the words.
    pub show: fn(&mut Ui, &Shown<'_>, &mut Learn, &mut Vec<Action>),
    /// Paints over the body.
    pub paint: fn(&Painter, &View<'_>, &Learn),
    /// Whether the elements are drawn apart.
    pub apart: bool,
}

/// What a card makes of scene and view.
#[derive(Clone, Copy)]
pub(in crate::app) struct Setup {
    /// Changes the article's scene.
    pub edit: fn(&mut Scene),
    pub field: Field,
    /// Outlines: of the exact solution, at rest.
    pub exact: bool,
    pub rest: bool,
    pub start: Start,
}

/// How the body gets to its equilibrium.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::app) enum Start {
    /// From where it is.
    Now,
    /// From rest.
    Rest,
    /// From rest, when told.
    Waiting,
}

/// Where the warped iteration converges, and where it does not: the force on the article's beam, N.
const NEAR: f64 = 30e3;
const FAR: f64 = 60e3;

fn with(scene: &mut Scene, method: MethodKind, force: f64) {
    scene.solver.method = method;
    for load in &mut scene.loads {
        if let Load::Force { force: vector, .. } = load {
            *vector = [0.0, -force];
        }
    }
}

fn nothing(_: &Painter, _: &View<'_>, _: &Learn) {}

/// Every card, in the order of the article.
pub(in crate::app) const CARDS: &[Card] = &[
    Card {
        title: "Linear theory swells",
        words: "Linear theory knows no turns. What turns by an angle \u{3b8} moves along the tangent instead of the arc, \
                and grows: its area by \u{3b8}\u{b2}, whatever it is made of. The dashed line is the exact beam, which \
                turns without growing.",
        formula: &["K u = f", "`det` ( I + \u{3b8} J ) = 1 + \u{3b8}^{2}"],
        task: "Drag the tip force, and watch the area.",
        setup: Setup {
            edit: |scene| with(scene, MethodKind::Linear, NEAR),
            field: Field::LargestStrain,
            exact: true,
            rest: true,
            start: Start::Now,
        },
        needs: Needs::Nothing,
        show: area::show,
        paint: nothing,
        apart: false,
    },
    Card {
        title: "Every triangle turns",
        words: "A triangle at rest and the same triangle now define a matrix F. Polar decomposition splits it into a turn \
                R and a stretch S, in one way only, and in the plane in closed form. The two arrows in each triangle are \
                the axes of its frame R.",
        formula: &["F = R S", "R^{T}R = I", "S = S^{T}"],
        task: "Click a triangle: its numbers appear beside.",
        setup: Setup {
            edit: |scene| with(scene, MethodKind::Warped, NEAR),
            field: Field::RotationAngle,
            exact: false,
            rest: true,
            start: Start::Now,
        },
        needs: Needs::Nothing,
        show: frames::show,
        paint: frames::paint,
        apart: false,
    },
    Card {
        title: "Turn back",
        words: "Here each triangle is turned back by its own R\u{2019}s transpose and laid onto its shape at rest. What \
                is left between the two is the strain, and that is all the stiffness K ever sees. It knows nothing of \
                the turn.",
        formula: &["R^{T} F = S = I + \u{3b5}"],
        task: "Move the slider between the bent beam and the triangles turned back.",
        setup: Setup {
            edit: |scene| with(scene, MethodKind::Warped, NEAR),
            field: Field::LargestStrain,
            exact: false,
            rest: false,
            start: Start::Now,
        },
        needs: Needs::Nothing,
        show: exploded::show,
        paint: exploded::paint,
        apart: true,
    },
    Card {
        title: "Turn the stiffness instead",
        words: "K is made once, at rest. Turned forward by R it acts on the bent beam, with an offset on the right. Each \
                triangle adds nine 2\u{d7}2 blocks, at the rows and columns of its three nodes. The four unknowns of the \
                two clamped nodes leave: 24 \u{2212} 4 = 20.",
        formula: &["R K R^{T} x = f + R K X"],
        task: "Click triangles, and point at entries for their values.",
        setup: Setup {
            edit: |scene| with(scene, MethodKind::Warped, NEAR),
            field: Field::RotationAngle,
            exact: false,
            rest: true,
            start: Start::Now,
        },
        needs: Needs::Nothing,
        show: matrices::show,
        paint: frames::paint,
        apart: false,
    },
    Card {
        title: "Iterate",
        words: "R depends on where the beam is, and that on R. So solve with the present R, take the new R, and solve \
                again. Near the equilibrium each iteration leaves the part \u{3c1} of the residual before it.",
        formula: &["A x_{k+1} = f + R_{k} K X", "A = R_{k} K R_{k}^{T}", "| r_{k+1} | \u{2248} \u{3c1} | r_{k} |"],
        task: "Press \u{201c}Step once\u{201d} (N) again and again: the points fall along the line.",
        setup: Setup {
            edit: |scene| with(scene, MethodKind::Warped, NEAR),
            field: Field::VonMises,
            exact: false,
            rest: true,
            start: Start::Waiting,
        },
        needs: Needs::Rho,
        show: residuals::steps,
        paint: nothing,
        apart: false,
    },
    Card {
        title: "Beyond \u{3c1} = 1 it walks in circles",
        words: "Under twice the force a turn of R changes the forces by more than A answers for: \u{3c1} is above 1, and \
                no number of iterations helps. Newton adds what is missing, G: how the forces turn with R. It costs the \
                same an iteration.",
        formula: &["\u{3c1} = | \u{3bb} |_{`max`} ( A^{\u{2212}1} G )", "( A + G ) \u{394}x = f \u{2212} f_{`int`}"],
        task: "Switch to newton, and back.",
        setup: Setup {
            edit: |scene| with(scene, MethodKind::Warped, FAR),
            field: Field::VonMises,
            exact: false,
            rest: true,
            start: Start::Rest,
        },
        needs: Needs::Rho,
        show: residuals::methods,
        paint: nothing,
        apart: false,
    },
    Card {
        title: "Locking",
        words: "The forces balance, and still the beam is far from the exact one (dashed). A three-node triangle has one \
                strain throughout, so triangles cannot bend without stretching, and resist. On the same five cells \
                another element cures it.",
        formula: &["`error` = | u \u{2212} u_{`exact`} | / | u_{`exact`} |"],
        task: "Try t6 and q4.",
        setup: Setup {
            edit: |scene| with(scene, MethodKind::Newton, NEAR),
            field: Field::VonMises,
            exact: true,
            rest: true,
            start: Start::Now,
        },
        needs: Needs::Errors,
        show: locking::show,
        paint: nothing,
        apart: false,
    },
    Card {
        title: "The trade",
        words: "Element, mesh and method each cost time and leave an error, and what is cheapest depends on your machine. \
                In the table: the time of the fastest setting that keeps the error you ask for. The mode Budget has them \
                all.",
        formula: &["`error` \u{2264} `mesh` + `iteration` + `theory`"],
        task: "Press \u{201c}Measure\u{201d}; it runs beside the window. Then ask for another error.",
        setup: Setup {
            edit: |scene| with(scene, MethodKind::Newton, NEAR),
            field: Field::VonMises,
            exact: true,
            rest: true,
            start: Start::Now,
        },
        needs: Needs::Nothing,
        show: trade::show,
        paint: nothing,
        apart: false,
    },
];
