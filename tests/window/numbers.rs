//! The numbers of the window are those of `warpbeam solve --json`, wherever they stand: status bar, summary, Details.

use egui::accesskit::Role;
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use serde_json::Value;

use crate::common::lab::unfold;
use crate::common::{ids_of, scene, warpbeam};
use warpbeam::app::Lab;
use warpbeam::format::{engineering, engineering_pair, percent, three_digits, two_digits};
use warpbeam::scene::{Analysis, Source};
use warpbeam::{MethodKind, Scene, Simulation};

/// Texts of the window.
struct Shown(Vec<String>);

impl Shown {
    fn of(id: &str, scene: Scene) -> Self {
        let simulation = Simulation::new(&scene).unwrap();
        let mut lab = Lab::new(Source { name: id.into(), assignments: Vec::new() }, scene, simulation);
        lab.solve();
        let mut harness: Harness<'_, Lab> = Harness::builder().with_size([1280.0, 2000.0]).build_ui_state(
            |ui, lab: &mut Lab| {
                lab.advance(ui.input(|i| i.time));
                lab.ui(ui);
            },
            lab,
        );
        harness.run_steps(3);
        unfold(&mut harness, "stable");
        let labels = harness.get_all_by(|node| node.role() == Role::Label);
        Self(labels.filter_map(|node| node.accesskit_node().value().or(node.accesskit_node().label())).collect())
    }

    /// Returns the value of a row of Details.
    fn row(&self, name: &str) -> &str {
        let at = self.0.iter().position(|text| text == name);
        let value = at.and_then(|at| self.0.get(at + 1));
        value.map_or_else(|| panic!("no row {name:?}: {:?}", self.0), String::as_str)
    }

    fn starting_with(&self, start: &str) -> Option<&str> {
        self.0.iter().map(String::as_str).find(|text| text.starts_with(start))
    }
}

fn number(value: &Value) -> Option<f64> {
    value.as_f64()
}

/// Compares all numbers of a result in equilibrium.
fn compare(what: &str, shown: &Shown, json: &Value) {
    let probe = &json["probes"][0];
    let iterations = json["iterations"].as_u64().unwrap();
    let residual = format!("{iterations}, residual {:.2e}", number(&json["residual"]).unwrap());
    assert_eq!(shown.row("Iterations"), residual, "{what}");
    let bar = shown.starting_with("ERROR ").unwrap();
    match number(&probe["error_percent"]) {
        Some(error) => {
            assert!(bar.starts_with(&format!("ERROR {}", percent(error))), "{what}: {bar}, {error}");
            assert!(shown.row("Error").starts_with(&format!("{} of", percent(error))), "{what}: {error}");
        }
        None => {
            assert!(!bar.contains('%') && shown.row("Error") == "\u{2013}", "{what}: {bar}, {}", shown.row("Error"))
        }
    }
    let summary = shown.starting_with("Converged").unwrap();
    assert!(summary.contains(&format!("· {iterations} iteration")), "{what}: {summary}");
    let stable = json["stable"].as_bool().map_or("\u{2013}", |stable| if stable { "stable" } else { "unstable" });
    assert_eq!(shown.row("Equilibrium"), stable, "{what}");
    assert!(stable == "\u{2013}" || summary.contains(&format!("· {stable} ·")), "{what}: {summary}");
    let name = probe["name"].as_str().unwrap();
    let u = [0, 1].map(|i| number(&probe["u"][i]).unwrap());
    assert_eq!(shown.row(&format!("{name} x, y")), engineering_pair(u, "m"), "{what}");
    let mesh_error = format!("{} (estimate)", percent(number(&json["mesh_error_percent"]).unwrap()));
    assert_eq!(shown.row("Mesh error"), mesh_error, "{what}");
    let strain = engineering(three_digits(100.0 * number(&json["max_strain"]).unwrap()), "%");
    assert!(
        [strain.clone(), format!("{strain}: too large")].contains(&shown.row("Strain").to_owned()),
        "{what}: {strain}"
    );
    assert_eq!(shown.row("Energy"), engineering(number(&json["energy"]["elastic"]).unwrap(), "J"), "{what}");
    if json["method"] == "warped" {
        let rho = number(&json["fixed_point_rho"]);
        let bar = rho.map_or_else(|| "ρ \u{2013}".to_owned(), |rho| format!("ρ {} per iteration", two_digits(rho)));
        assert_eq!(shown.starting_with("ρ "), Some(bar.as_str()), "{what}");
        let claims = json["claims"].as_array().unwrap();
        let words =
            claims.iter().find(|claim| claim["claim"] == "disturbance").and_then(|claim| claim["text"].as_str());
        let digits = words.and_then(|words| words.split("ρ = ").nth(1)?.split([';', ' ']).next());
        assert_eq!(digits.is_some(), rho.is_some(), "{what}: {words:?}");
        assert!(
            digits.is_none_or(|digits| shown.row("ρ").contains(&format!("ρ = {digits}"))),
            "{what}: {digits:?}, {}",
            shown.row("ρ")
        );
    }
}

/// Every built-in scene at rest, under its own load, under a tenth, and under a hundred times its load, where `warped`
/// diverges: a result has the numbers of `solve`, a diverged iteration none.
#[test]
fn numbers_are_those_of_solve() {
    let folder = tempfile::tempdir().unwrap();
    let (mut results, mut diverged) = (0, 0);
    for id in ids_of(Analysis::Static) {
        for factor in [0.1, 1.0, 100.0] {
            let mut scene = scene(id);
            // The files of meshes lie elsewhere.
            if factor != 1.0 && scene.mesh.is_some() {
                continue;
            }
            scene.scale_loads(factor);
            if factor > 1.0 {
                scene.solver.method = MethodKind::Warped;
            }
            let path = folder.path().join("scene.toml");
            std::fs::write(&path, scene.to_toml().unwrap()).unwrap();
            let name = if scene.mesh.is_some() { id } else { path.to_str().unwrap() };
            let what = format!("{id} at {factor}");
            let json: Value = serde_json::from_slice(&warpbeam(&["solve", name, "--json"]).stdout).unwrap();
            let shown = Shown::of(id, scene);
            if json["status"] == "converged" {
                compare(&what, &shown, &json);
                results += 1;
            } else {
                let bar = shown.starting_with("ERROR ").unwrap();
                assert!(!bar.contains('%'), "{what}: {bar}");
                assert_eq!(
                    (shown.starting_with("ρ "), shown.row("Mesh error")),
                    (Some("ρ \u{2013}"), "\u{2013}"),
                    "{what}"
                );
                assert!(shown.starting_with("Converged").is_none(), "{what}: {:?}", shown.0);
                diverged += 1;
            }
        }
    }
    assert!(results > 20 && diverged > 4, "{results} results, {diverged} diverged");
}
