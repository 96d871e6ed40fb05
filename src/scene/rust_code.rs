//! Conversion of a scene to a Rust program that builds and solves it with this library.

use std::collections::BTreeSet;
use std::fmt::Debug;
use std::path::Path;

use super::{
    Analysis, Axis, Beam, DynamicsSettings, Load, Material, MeshFile, Place, Scene, SectionLine, SolverSettings, Start,
    Support,
};
use crate::mesh::Mesh;

/// Longest line that rustfmt does not wrap.
const LINE: usize = 100;

const HEADER: &str = "\
// Save as src/main.rs of a new project (`cargo new beam`), then:
// cargo add --git URL warpbeam --no-default-features && cargo run --release
";

const SOLVE: &str = "    simulation.solve();\n    println!(\"{}\", simulation.status().word());\n";

const MOVE: &str = r#"    while *simulation.status() == Status::Running {
        simulation.step();
    }
    let time = simulation.state().time();
    println!("{} at {time} s", simulation.status().word());
"#;

const PRINT: &str = r#"    for probe in simulation.solution().probes {
        let (name, x, y) = (&probe.name, probe.u.x, probe.u.y);
        println!("{name} moved by ({x:.6}, {y:.6}) m");
    }
    Ok(())
"#;

impl Scene {
    /// Returns the scene as a Rust program that builds and solves it with this library. The program sets only values
    /// that differ from the defaults, and reads a mesh file relative to `folder`.
    ///
    /// ```
    /// use warpbeam::Scene;
    ///
    /// let program = Scene::beam(4.0, 1.0).clamp("left").force("right", [0.0, -0.5]).to_rust("".as_ref());
    /// assert!(program.contains(r#".force("right", [0.0, -0.5])"#));
    /// ```
    #[must_use]
    pub fn to_rust(&self, folder: &Path) -> String {
        let mut code = Code { uses: BTreeSet::from(["Scene", "Simulation"]), ..Code::default() };
        let start = code.geometry(self, folder);
        code.material(&self.material);
        code.solver(&self.solver);
        self.supports.iter().for_each(|support| code.support(support));
        self.loads.iter().for_each(|load| code.load(load));
        for probe in &self.probes {
            code.call("probe", &[text(&probe.name), place(&probe.place)]);
        }
        for SectionLine { at, angle } in &self.sections {
            code.call("section", &[pair((*at).into()), number(*angle)]);
        }
        if self.analysis == Analysis::Dynamic {
            code.motion(&self.dynamics, &self.start);
        }
        code.program(&start, self)
    }
}

/// Parts of the program.
#[derive(Debug, Default)]
struct Code {
    /// Names imported from this library.
    uses: BTreeSet<&'static str>,
    /// Builder calls.
    calls: String,
    /// Assignments to fields without builder.
    assignments: String,
}

impl Code {
    /// Adds a builder call.
    fn call(&mut self, name: &str, arguments: &[String]) {
        self.calls += &format!("\n        .{name}({})", arguments.join(", "));
    }

    /// Adds a builder call with a variant of an enumeration as the argument.
    fn choose(&mut self, name: &str, kind: &'static str, variant: impl Debug) {
        self.uses.insert(kind);
        self.call(name, &[format!("{kind}::{variant:?}")]);
    }

    /// Adds an assignment to a field of the scene if its value is not the default.
    fn assign<T: Debug + PartialEq>(&mut self, field: &str, value: T, default: T) {
        if value != default {
            self.assignments += &format!("    scene.{field} = {value:?};\n");
        }
    }

    fn assign_text(&mut self, field: &str, text: &str, default: &str) {
        if text != default {
            self.assignments += &format!("    scene.{field} = {text:?}.to_owned();\n");
        }
    }

    /// Returns the expression that the chain of calls starts with.
    fn geometry(&mut self, scene: &Scene, folder: &Path) -> String {
        match (&scene.beam, &scene.mesh) {
            (Some(beam), _) => self.beam(beam, &scene.name),
            (None, Some(mesh)) => self.mesh(mesh, scene, folder),
            (None, None) => format!("Scene::named({:?})", scene.name),
        }
    }

    fn beam(&mut self, beam: &Beam, name: &str) -> String {
        let plain = Scene::beam(beam.length, beam.height);
        self.assign_text("name", name, &plain.name);
        if let Some(plain) = plain.beam {
            if beam.cells != plain.cells {
                self.call("with_cells", &beam.cells.map(|cells| cells.to_string()));
            }
            if beam.rise != plain.rise {
                self.call("with_rise", &[number(beam.rise)]);
            }
            if beam.element != plain.element {
                self.choose("with_element", "ElementKind", beam.element);
            }
            if beam.diagonals != plain.diagonals {
                self.choose("with_diagonals", "Diagonals", beam.diagonals);
            }
        }
        format!("Scene::beam({}, {})", number(beam.length), number(beam.height))
    }

    fn mesh(&mut self, mesh: &MeshFile, scene: &Scene, folder: &Path) -> String {
        self.uses.insert("SceneError");
        self.assign_text("name", &scene.name, &mesh.file);
        let own = mesh.text.as_deref().and_then(Mesh::gmsh_element);
        if let Some(element) = mesh.element.filter(|element| Some(*element) != own) {
            self.choose("with_element", "ElementKind", element);
        }
        if let Some(scale) = mesh.scale {
            self.call("with_scale", &[number(scale)]);
        }
        format!("Scene::mesh_file({:?}, {:?})?", mesh.file, folder.display().to_string())
    }

    fn material(&mut self, material: &Material) {
        let Material { young, poisson, density, thickness, plane } = *material;
        let plain = Material::new(young, poisson);
        let mut fields = String::new();
        for (name, value, plain) in [("density", density, plain.density), ("thickness", thickness, plain.thickness)] {
            if value != plain {
                fields += &format!("            {name}: {},\n", number(value));
            }
        }
        if plane != plain.plane {
            self.uses.insert("Plane");
            fields += &format!("            plane: Plane::{plane:?},\n");
        }
        let base = match plain == Material::default() {
            true => "Material::default()".to_owned(),
            false => format!("Material::new({}, {})", number(young), number(poisson)),
        };
        if *material == Material::default() {
            return;
        }
        self.uses.insert("Material");
        match fields.is_empty() {
            true => self.call("with_material", &[base]),
            false => self.call("with_material", &[format!("Material {{\n{fields}            ..{base}\n        }}")]),
        }
    }

    fn solver(&mut self, solver: &SolverSettings) {
        let plain = SolverSettings::default();
        if solver.method != plain.method {
            self.choose("with_method", "MethodKind", solver.method);
        }
        self.assign("solver.tolerance", solver.tolerance, plain.tolerance);
        self.assign("solver.max_iterations", solver.max_iterations, plain.max_iterations);
        self.assign("solver.accept_after", solver.accept_after, plain.accept_after);
        self.assign("solver.max_error_percent", solver.max_error_percent, plain.max_error_percent);
    }

    fn support(&mut self, support: &Support) {
        let place = place(&support.place);
        if !support.at_point && support.fix[..] == [Axis::X, Axis::Y] {
            self.call("clamp", &[place]);
        } else {
            self.uses.insert("Axis");
            let name = if support.at_point { "point_support" } else { "support" };
            let axes: Vec<String> = support.fix.iter().map(|axis| format!("Axis::{axis:?}")).collect();
            self.call(name, &[place, format!("&[{}]", axes.join(", "))]);
        }
        if support.moves() {
            self.call("moved", &[pair(support.displacement), number(support.turn)]);
        }
    }

    fn load(&mut self, load: &Load) {
        match load {
            Load::Force { place: at, at_point, force, .. } => {
                let name = if *at_point { "point_force" } else { "force" };
                self.call(name, &[place(at), pair(*force)]);
            }
            Load::Moment { edge, moment, .. } => self.call("moment", &[text(edge), number(*moment)]),
            Load::Gravity { acceleration, .. } => self.call("gravity", &[pair(*acceleration)]),
        }
        if let Some(pulse) = load.pulse() {
            self.call("pulse", &[number(pulse.start), number(pulse.duration)]);
        }
    }

    fn motion(&mut self, dynamics: &DynamicsSettings, start: &Start) {
        let plain = DynamicsSettings::default();
        self.uses.extend(["IntegratorKind", "Status"]);
        let DynamicsSettings { integrator, time_step, damping, .. } = dynamics;
        self.call("moving", &[format!("IntegratorKind::{integrator:?}"), number(*time_step)]);
        if !start.is_rest() {
            self.call("starting", &[pair(start.velocity), number(start.spin)]);
        }
        self.assign("dynamics.duration", dynamics.duration, plain.duration);
        self.assign("dynamics.iterations", dynamics.iterations, plain.iterations);
        self.assign("dynamics.damping.mass", damping.mass, plain.damping.mass);
        self.assign("dynamics.damping.stiffness", damping.stiffness, plain.damping.stiffness);
    }

    /// Assembles the program from its parts.
    fn program(mut self, start: &str, scene: &Scene) -> String {
        self.assign_text("about", &scene.about, "");
        let Self { uses, calls, assignments } = &self;
        let is_fallible = uses.contains("SceneError");
        let (returned, question) = if is_fallible { ("Result<Scene, SceneError>", "?") } else { ("Scene", "") };
        let wrapped = |value: &str| if is_fallible { format!("Ok({value})") } else { value.to_owned() };
        let chain = format!("{start}{calls}");
        let body = match assignments.is_empty() {
            true => format!("    {}\n", wrapped(&chain)),
            false => format!("    let mut scene = {chain};\n{assignments}    {}\n", wrapped("scene")),
        };
        let run = if scene.analysis == Analysis::Dynamic { MOVE } else { SOLVE };
        format!(
            "{HEADER}\nuse std::error::Error;\n\n{imports}\n\
             fn main() -> Result<(), Box<dyn Error>> {{\n    \
             let mut simulation = Simulation::new(&scene(){question})?;\n{run}{PRINT}}}\n\n\
             fn scene() -> {returned} {{\n{body}}}\n",
            imports = imports(uses),
        )
    }
}

/// Formats a number literal with all its digits.
fn number(value: f64) -> String {
    const LARGE: f64 = 1e6;
    if value.abs() < LARGE { format!("{value:?}") } else { format!("{value:e}") }
}

fn pair([x, y]: [f64; 2]) -> String {
    format!("[{}, {}]", number(x), number(y))
}

fn text(text: &str) -> String {
    format!("{text:?}")
}

fn place(place: &Place) -> String {
    match place {
        Place::Edge(edge) => text(edge),
        Place::At(at) => pair(*at),
    }
}

fn imports(uses: &BTreeSet<&'static str>) -> String {
    let names = uses.iter().copied().collect::<Vec<_>>().join(", ");
    let line = format!("use warpbeam::{{{names}}};\n");
    match line.trim_end().len() <= LINE {
        true => line,
        false => format!("use warpbeam::{{\n    {names},\n}};\n"),
    }
}
