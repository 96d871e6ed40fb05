//! Keys of a scene file: the kind, range, default and meaning of each.
//!
//! The parser of units, the messages about missing keys, the reference in `docs/reference/scene-file.md` and the JSON
//! Schema in `assets/scene.schema.json` are all made from this list. `tests/commands/docs.rs` compares it with the keys that the
//! reader accepts.

use super::limits::{self, Limit};

/// Key of a scene file.
#[derive(Clone, Copy, Debug)]
pub struct Key {
    /// Path without list indices: `load.pulse.start`.
    pub path: &'static str,
    /// Kind and range of the value.
    pub kind: KeyKind,
    /// Condition under which the key must be given.
    pub need: Need,
    /// Accepted value, as written in the file.
    pub example: &'static str,
    /// Meaning, in one or two sentences.
    pub about: &'static str,
}

/// Kind and range of a key's value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum KeyKind {
    /// Table with keys of its own.
    Table,
    /// List of tables, written `[[…]]`.
    Tables,
    /// Text.
    Text,
    /// One of these texts.
    Choice(&'static [&'static str]),
    /// List of these texts.
    Choices(&'static [&'static str]),
    /// Number, or text of a number with a unit.
    Number(Limit),
    /// List of two numbers, each in this range.
    Pair(Limit),
    /// List of two numbers, the components of a vector whose length is in this range.
    Vector(Limit),
    /// Integer.
    Integer(Limit),
    /// List of two integers.
    IntegerPair(Limit),
}

/// Condition under which a key must be given.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Need {
    /// Always, inside its table. The text is the expected value of a key that holds no number.
    Required(&'static str),
    /// Never: this is the value if it is not given, as written in the file.
    Default(&'static str),
    /// Sometimes: the condition, or the effect of leaving the key out.
    Optional(&'static str),
}

impl KeyKind {
    /// Returns the range of the numbers of the value; `None` if it holds no number that can have a unit.
    pub fn quantity(self) -> Option<Limit> {
        match self {
            Self::Number(limit) | Self::Pair(limit) | Self::Vector(limit) => Some(limit),
            _ => None,
        }
    }
}

macro_rules! keys {
    ($($path:literal: $kind:expr, $need:expr, $example:literal, $about:literal;)*) => {
        &[$(Key { path: $path, kind: $kind, need: $need, example: $example, about: $about }),*]
    };
}

use KeyKind::{Choice, Choices, Integer, IntegerPair, Number, Pair, Table, Tables, Text, Vector};
use Need::{Default, Optional, Required};

const ELEMENTS: &[&str] = &["t3", "t6", "q4"];

/// Every key of a scene file, in the order of the reference. A table comes before its keys.
pub const KEYS: &[Key] = keys! {
    "name": Text, Required("a title"), r#""Cantilever""#,
        "Title, shown in the window and in results.";
    "about": Text, Default(r#""""#), r#""A beam under a force at its end.""#,
        "One sentence about the scene.";
    "analysis": Choice(&["static", "dynamic"]), Default(r#""static""#), r#""static""#,
        "Equilibrium, or motion in time.";

    "beam": Table, Optional("Either [beam] or [mesh] is required"), "",
        "Meshed rectangle [0, length] × [−height/2, height/2], with the edges left, right, bottom and top.";
    "beam.length": Number(Limit::new("m", 1e-6, 1e6)), Required(""), "10.0",
        "Length.";
    "beam.height": Number(Limit::new("m", 1e-6, 1e6)), Required(""), r#""50 cm""#,
        "Height.";
    "beam.cells": IntegerPair(Limit::new("", 1.0, 100_000.0)), Required("the cells along and across, as in [20, 2]"), "[20, 2]",
        "Cells along and across: at most 250,000 in all, and at most 100,000 times as long as high or as high as long.";
    "beam.element": Choice(ELEMENTS), Default(r#""t3""#), r#""q4""#,
        "Element of every cell. A cell is one quadrilateral (q4), or is cut into two triangles (t3, t6).";
    "beam.rise": Number(Limit::new("m", -1e6, 1e6)), Default("0.0"), "0.2",
        "Rise of the axis in the middle of the span, along a parabola from end to end: a shallow arch, free of stress.";
    "beam.diagonals": Choice(&["alternating", "same"]), Default(r#""alternating""#), r#""same""#,
        "Cut of the cells into triangles: cell (i, j) from lower left to upper right where i + j is even, else from upper left to lower right; or every cell from lower left to upper right.";

    "mesh": Table, Optional("Either [beam] or [mesh] is required"), "",
        "Mesh from a Gmsh file.";
    "mesh.file": Text, Required("the name of a mesh file"), r#""bracket.msh""#,
        "Path of a file in the format MSH 4.1, ASCII, relative to the scene file. Its physical curves name the edges. If there is no such file, ../meshes/clip.msh, bracket.msh and cook.msh there are those of the built-in scenes, and a warning says so.";
    "mesh.element": Choice(ELEMENTS), Optional("the element of the file"), r#""t6""#,
        "Element type. Nodes in the middle of sides are added or left out; triangles and quadrilaterals are not exchanged.";
    "mesh.scale": Number(Limit::new("m", 1e-9, 1e6)), Optional("1: the file is in metres"), "0.001",
        "Metres per unit of the file: 0.001 reads a file in millimetres.";

    "material": Table, Required("the table [material]"), "",
        "Linear elastic, isotropic material.";
    "material.young": Number(Limit::new("Pa", 1e-6, 1e15)), Required(""), r#""210 GPa""#,
        "Young's modulus E.";
    "material.poisson": Number(Limit::new("", -0.99, 0.5)), Required(""), "0.3",
        "Poisson's ratio ν. In plane strain at most 0.4999.";
    "material.density": Number(Limit::new("kg/m³", 0.0, 1e6)), Default("1000.0"), r#""7.8 g/cm³""#,
        "Density ρ, for gravity and motion. A dynamic scene needs more than 0.";
    "material.thickness": Number(Limit::new("m", 1e-6, 1e6)), Default("1.0"), r#""3 mm""#,
        "Thickness t out of the plane. Forces and masses are those of the whole thickness.";
    "material.plane": Choice(&["stress", "strain"]), Default(r#""stress""#), r#""strain""#,
        "Plane stress, as in a thin plate, or plane strain, as in a slice of a long body.";

    "support": Tables, Optional("A static scene needs at least one"), "",
        "Held nodes or points. A pin holds a point in x and y, a roller in one direction, a clamp an edge in x and y. On an edge, a roller normal to it also keeps the edge from rotating. A dynamic scene without supports is a free body.";
    "support.edge": Text, Optional("edge or at is required"), r#""left""#,
        "Edge all of whose nodes are held.";
    "support.at": Pair(limits::COORDINATE), Optional("edge or at is required"), "[10.0, 0.0]",
        "Point, at rest.";
    "support.acts_on": Choice(&["node", "point"]), Default(r#""node""#), r#""point""#,
        "Of a support with at: node holds the node nearest to the point; point holds the point itself, which moves with the nodes of the element there in proportion to their shape functions.";
    "support.width": Number(limits::WIDTH), Default("0.0"), r#""10 cm""#,
        "Of a support with at: holds the mean displacement over this length of the body's outline, or of the horizontal line through an inner point. Unlike that of a point, its error has a limit on finer meshes.";
    "support.fix": Choices(&["x", "y"]), Required(r#"the directions it fixes, as in ["x", "y"]"#), r#"["x", "y"]"#,
        "Directions that are held; at least one.";
    "support.displacement": Pair(limits::COORDINATE), Default("[0.0, 0.0]"), r#"[0.0, "-3 mm"]"#,
        "Prescribed displacement, in the directions of fix. Static scenes only.";
    "support.turn": Number(limits::ROTATION), Default("0.0"), r#""30°""#,
        "Prescribed rotation of an edge about its middle, counter-clockwise; a number without unit is in rad. Needs edge, and fix = [\"x\", \"y\"]. Static scenes only.";

    "load": Tables, Default("[]"), "",
        "Forces, moments and gravity.";
    "load.kind": Choice(&["force", "gravity", "moment"]), Required(r#"one of "force", "gravity", "moment""#), r#""force""#,
        "Force and gravity keep their direction as the body rotates; a moment rotates with its edge.";
    "load.edge": Text, Optional("required for a moment; edge or at for a force"), r#""right""#,
        "Edge over which the force or moment is spread. The edge of a moment is straight.";
    "load.at": Pair(limits::COORDINATE), Optional("edge or at is required for a force"), "[5.0, 0.25]",
        "Point, at rest, for a force.";
    "load.acts_on": Choice(&["node", "point"]), Default(r#""node""#), r#""point""#,
        "Of a force with at: node puts it on the node nearest to the point; point puts it on the nodes of the element there, in proportion to their shape functions.";
    "load.width": Number(limits::WIDTH), Default("0.0"), r#""10 cm""#,
        "Of a force with at: spreads it evenly over this length of the body's outline, or of the horizontal line through an inner point.";
    "load.force": Vector(Limit::new("N", 0.0, 1e15)), Optional("required for a force"), r#"[0.0, "-12 kN"]"#,
        "Total force; on an edge a uniform traction.";
    "load.acceleration": Vector(Limit::new("m/s²", 0.0, 1e6)), Optional("required for gravity"), "[0.0, -9.81]",
        "Acceleration of gravity.";
    "load.moment": Number(Limit::new("N m", -1e15, 1e15)), Optional("required for a moment"), r#""2 kN m""#,
        "Moment, counter-clockwise.";
    "load.pulse": Table, Optional("a constant load"), "{ start = 0.2, duration = 0.1 }",
        "Makes the load act for a time: times sin²(π (t − start)/duration) during the pulse, and 0 otherwise. The load is the peak; its impulse is half of load times duration. Dynamic scenes only.";
    "load.pulse.start": Number(Limit::new("s", -1e6, 1e6)), Required(""), "0.2",
        "Start of the pulse.";
    "load.pulse.duration": Number(Limit::new("s", 1e-9, 1e6)), Required(""), r#""100 ms""#,
        "Duration of the pulse.";

    "probe": Tables, Default("[]"), "",
        "Places whose displacements are printed, plotted and compared with the reference solution.";
    "probe.name": Text, Required("a name for its results"), r#""tip""#,
        "Name in results; each probe has its own.";
    "probe.edge": Text, Optional("edge or at is required"), r#""right""#,
        "Edge over which the displacement is averaged.";
    "probe.at": Pair(limits::COORDINATE), Optional("edge or at is required"), "[10.0, 0.0]",
        "Material point, at rest; the displacement is interpolated.";

    "section": Tables, Default("[]"), "",
        "Cuts through the body whose normal force, shear force and bending moment are printed.";
    "section.at": Pair(limits::COORDINATE), Required("a point of the body, as in [5.0, 0.0]"), "[5.0, 0.0]",
        "Point of the cut, at rest.";
    "section.angle": Number(limits::ROTATION), Default("0.0"), r#""30°""#,
        "Direction of the cut's normal, counter-clockwise from the x axis; a number without unit is in rad. The normal points to the part in front, whose force on the part behind is printed.";

    "solver": Table, Optional("Optional"), "",
        "Settings of the solver.";
    "solver.method": Choice(&["linear", "warped", "newton", "auto"]), Default(r#""newton""#), r#""warped""#,
        "linear: linear theory. warped: the article's iteration. newton: Newton's method with the exact tangent. auto: one of these, by an estimate of its error, which max_error_percent limits.";
    "solver.tolerance": Number(Limit::new("", 1e-14, 0.1)), Default("1e-8"), "1e-10",
        "Unbalanced force, relative to the sum of all forces of elements, below which a solve has converged.";
    "solver.max_iterations": Integer(Limit::new("", 1.0, 100_000.0)), Default("1000"), "50",
        "Linear solves after which a solve has failed.";
    "solver.accept_after": Integer(Limit::new("", 0.0, 100_000.0)), Default("0"), "3",
        "Iterations after which the result is accepted without convergence (status accepted, exit code 0); 0: never. Static scenes only.";
    "solver.max_error_percent": Number(Limit::new("%", 1e-6, 100.0)), Default("1.0"), "0.5",
        "Largest error that method auto allows itself, percent of the displacement that the scene's mesh has at equilibrium.";

    "dynamics": Table, Optional("Optional"), "",
        "Settings of a motion. Dynamic scenes only.";
    "dynamics.integrator": Choice(&["implicit-euler", "tr-bdf2", "energy-momentum", "symplectic-euler"]), Default(r#""tr-bdf2""#), r#""energy-momentum""#,
        "Time integration method.";
    "dynamics.time_step": Number(Limit::new("s", 1e-9, 1e3)), Default("0.016666666666666666"), r#""5 ms""#,
        "Time step h. For a pulse at most a twentieth of its duration, for a vibration at most a twentieth of its period.";
    "dynamics.duration": Number(Limit::new("s", 1e-9, 1e6)), Default("10.0"), "2.0",
        "Time after which a run without a window ends.";
    "dynamics.iterations": Integer(Limit::new("", 0.0, 100.0)), Default("1"), "0",
        "Solves per stage of a time step; 0: until solver.tolerance is met.";
    "dynamics.damping": Table, Optional("no damping"), "{ mass = 0.1, stiffness = 0.001 }",
        "Rayleigh damping. Rigid rotation is not damped by stiffness.";
    "dynamics.damping.mass": Number(Limit::new("1/s", 0.0, 1e6)), Default("0.0"), "0.1",
        "Mass-proportional factor α: a mode of angular frequency ω decays at the rate α/2.";
    "dynamics.damping.stiffness": Number(Limit::new("s", 0.0, 1e6)), Default("0.0"), "0.001",
        "Stiffness-proportional factor β: a mode decays at the rate β ω²/2.";

    "start": Table, Optional("Optional"), "",
        "Initial velocities. Dynamic scenes only.";
    "start.velocity": Vector(Limit::new("m/s", 0.0, 1e6)), Default("[0.0, 0.0]"), "[1.0, 0.0]",
        "Velocity of the body.";
    "start.spin": Number(Limit::new("rad/s", -1e6, 1e6)), Default("0.0"), r#""90 °/s""#,
        "Angular velocity about the centre of mass, counter-clockwise.";
};

/// Returns the range of the numbers of a key. In a constant, a path without numbers does not compile.
pub const fn range(path: &str) -> Limit {
    let mut i = 0;
    loop {
        match KEYS[i].kind {
            Number(limit) | Pair(limit) | Vector(limit) | Integer(limit) | IntegerPair(limit)
                if are_equal(KEYS[i].path.as_bytes(), path.as_bytes()) =>
            {
                return limit;
            }
            _ => i += 1,
        }
    }
}

/// Compares texts, as `==` does outside of constants.
const fn are_equal(a: &[u8], b: &[u8]) -> bool {
    let mut i = 0;
    while i < a.len() && i < b.len() && a[i] == b[i] {
        i += 1;
    }
    i == a.len() && i == b.len()
}
