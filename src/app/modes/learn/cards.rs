//! Cards of the mode Learn. A new card is an entry here, and a module for its drawing.

use super::*;

/// Card that explains one step of the article.
pub(crate) struct Card {
    pub title: &'static str,
    /// Text of two or three sentences.
    pub text: &'static str,
    /// Formulas in the markup of [`super::formula`].
    pub formula: &'static [&'static str],
    /// Definitions of the symbols that appear for the first time.
    pub symbols: &'static str,
    /// Task for the reader.
    pub task: &'static str,
    pub setup: Setup,
    pub content: CardDisplay,
}

/// Display of a card next to its text and over the body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum CardDisplay {
    Area,
    Frames,
    /// Triangles apart from each other, rotated back.
    Exploded,
    Matrices,
    /// Lines of the pseudocode; a step goes to the next one.
    Code,
    /// Residuals, with the buttons that iterate, or those of two methods.
    Steps,
    Methods,
    /// Errors of all elements.
    Elements,
    /// Button that leads to Measure.
    ToMeasure,
}

/// Scene and view of a card.
#[derive(Clone, Copy)]
pub(crate) struct Setup {
    /// Method, and force on the article's beam, N.
    pub method: MethodKind,
    pub force: f64,
    pub field: Field,
    /// `true` if the outline of the reference solution is shown, and (`rest`) the outline at rest.
    pub exact: bool,
    pub rest: bool,
    /// `true` if the card iterates from rest when the user starts it, in slow motion.
    pub waits: bool,
    /// Largest force that the card's slider reaches, N: the view leaves room for its body from the beginning.
    pub reach: Option<f64>,
}

/// Forces on the article's beam, N: with the first the warped iteration converges, with the second it does not.
const NEAR: f64 = 30e3;
const FAR: f64 = 60e3;

/// Setup of most cards.
const SETUP: Setup = Setup {
    method: MethodKind::Warped,
    force: NEAR,
    field: Field::VonMises,
    exact: false,
    rest: true,
    waits: false,
    reach: None,
};

impl Setup {
    /// Edits the article's scene.
    pub(crate) fn edit(&self, scene: &mut Scene) {
        scene.solver.method = self.method;
        for load in &mut scene.loads {
            if let Load::Force { force, .. } = load {
                *force = [0.0, -self.force];
            }
        }
    }
}

/// All cards, in the order of the article.
pub(crate) const CARDS: &[Card] = &[
    Card {
        title: "Linear theory makes the area grow",
        text: "Linear theory replaces a rotation by its tangent: a part that rotates by an angle θ moves along a \
               straight line instead of an arc, and grows. Its area growth is θ² (θ in radians), whatever the \
               material. The dashed line is the reference solution, which rotates and hardly grows.",
        formula: &["K u = f", "`det` ( I + θ J ) = 1 + θ^{2}"],
        symbols: "K: stiffness matrix (N/m). u: displacements of the nodes (m). f: forces on the nodes (N). I: \
                  identity matrix. J: rotation by 90°. det: determinant, the factor by which an area grows.",
        task: "Drag the tip force and watch the area.",
        setup: Setup {
            method: MethodKind::Linear,
            field: Field::LargestStrain,
            exact: true,
            reach: Some(area::LARGEST_FORCE),
            ..SETUP
        },
        content: CardDisplay::Area,
    },
    Card {
        title: "Every triangle rotates",
        text: "The shape of a triangle at rest and its shape now define a matrix F. Polar decomposition splits F into \
               a rotation R and a stretch S, in exactly one way for a triangle that is not inverted; in the plane \
               there is a closed formula. The two arrows in each triangle are the axes of its frame, the columns of R.",
        formula: &["F = R S", "R^{T} R = I", "S = S^{T}"],
        symbols: "F: deformation gradient. R: rotation matrix. S: stretch, a symmetric matrix with positive \
                  eigenvalues. T: transpose. All are 2×2.",
        task: "Click a triangle to see its numbers.",
        setup: Setup { field: Field::RotationAngle, ..SETUP },
        content: CardDisplay::Frames,
    },
    Card {
        title: "Rotate back",
        text: "Here each triangle is rotated back by the transpose of its own R and laid onto its shape at rest. The \
               difference between the two is the strain ε, and the stiffness K acts on that alone. The strain does not \
               depend on the rotation.",
        formula: &["R^{T} F = S = I + ε"],
        symbols: "ε: strain, a symmetric 2×2 matrix (Biot strain).",
        task: "Move the slider between the bent beam and the triangles rotated back.",
        setup: Setup { field: Field::LargestStrain, rest: false, ..SETUP },
        content: CardDisplay::Exploded,
    },
    Card {
        title: "Rotate the stiffness instead",
        text: "K is computed once, at rest. Rotated by R it acts on the bent beam, and the rest shape moves to the \
               right-hand side. Each triangle adds nine 2×2 blocks, at the rows and columns of its three nodes. The \
               four unknowns of the two clamped nodes drop out: 24 \u{2212} 4 = 20.",
        formula: &["R K R^{T} x = f + R K X"],
        symbols: "x, X: positions of the nodes now and at rest (m); u = x \u{2212} X. K with index e: stiffness matrix \
                  of one triangle (element). R here: 6×6, with the triangle’s rotation in three blocks on its \
                  diagonal. Σ: sum over all triangles.",
        task: "Click triangles, and point at entries for their values.",
        setup: Setup { field: Field::RotationAngle, ..SETUP },
        content: CardDisplay::Matrices,
    },
    Card {
        title: "The method in ten lines",
        text: "This is the whole warped stiffness method. One pass through lines 3 to 10 is an iteration. The program \
               runs the whole iteration when you reach line 8; the numbers next to a line describe the beam as it is \
               drawn.",
        formula: &["A = Σ R K_{e} R^{T}", "b = Σ R K_{e} X"],
        symbols: "A: stiffness matrix of the rotated triangles (N/m). b: forces that stand for the rest shape (N). f \
                  with index int: internal forces, of all triangles; with index e: of one. r: residual, the share of \
                  the forces that is out of balance; Σ | f | adds the absolute values of each component at every node.",
        task: "Press “Next line” (N) and follow the numbers.",
        setup: Setup { field: Field::RotationAngle, waits: true, ..SETUP },
        content: CardDisplay::Code,
    },
    Card {
        title: "Iterate",
        text: "R depends on the positions, and the positions depend on R. So solve with the current R, compute the new \
               R, and solve again: a fixed-point iteration. Near the equilibrium each iteration multiplies the \
               residual by ρ. On other cards a frame iterates to the equilibrium; here a step is one iteration.",
        formula: &["A x_{k+1} = f + R_{k} K X", "A = R_{k} K R_{k}^{T}", "| r_{k+1} | ≈ ρ | r_{k} |"],
        symbols: "k: number of the iteration. r: residual. ρ: convergence factor (spectral radius); below 1 the \
                  iteration converges from a start that is near enough.",
        task: "Press “Step once” (N) again and again: after a few steps the points fall along the line.",
        setup: Setup { waits: true, ..SETUP },
        content: CardDisplay::Steps,
    },
    Card {
        title: "Beyond ρ = 1 it does not converge",
        text: "Under twice the force, a change of R changes the forces by more than A accounts for: the spectral \
               radius ρ is above 1. Even next to the equilibrium each iteration leads away from it. Newton’s method \
               adds the missing part G: how the forces change as R rotates. An iteration costs about the same.",
        formula: &["ρ = | λ |_{`max`} ( A^{\u{2212}1} G )", "( A + G ) Δx = f \u{2212} f_{`int`}"],
        symbols: "λ: eigenvalues; the largest counts. G: geometric stiffness (N/m). Δx: change of the positions (m). \
                  Far from the equilibrium the residual leaves the line and levels off.",
        task: "Switch to newton, and back.",
        setup: Setup { force: FAR, ..SETUP },
        content: CardDisplay::Methods,
    },
    Card {
        title: "Shear locking",
        text: "The forces balance, and still the beam is far from the reference (dashed). A three-node triangle has \
               the same strain everywhere, so it bends only with extra stretch and shear, which make it too stiff. \
               Another element on the same five cells cures this.",
        formula: &["`error` = | u \u{2212} u_{`reference`} | / | u_{`reference`} |"],
        symbols: "u here: displacement of the tip (m). t3, t6: triangles of three and six nodes. q4: quadrilateral of four.",
        task: "Try t6 and q4, and watch the error.",
        setup: Setup { method: MethodKind::Newton, exact: true, ..SETUP },
        content: CardDisplay::Elements,
    },
    Card {
        title: "The trade-off",
        text: "Element, mesh and method each cost time and leave an error, and which choice is cheapest depends on \
               your machine. Measure has the errors and times of all of them for your own scene. It shows their Pareto \
               front: the settings that no other one beats in both time and error.",
        formula: &["`error` ≤ `mesh` + `iteration` + `theory`"],
        symbols: "mesh: error of the finite cells. iteration: error of stopping early. theory: error of linear theory.",
        task: "Open Measure, and press “Measure on this machine”.",
        setup: Setup { method: MethodKind::Newton, exact: true, ..SETUP },
        content: CardDisplay::ToMeasure,
    },
];
