//! The numbers of the window are those of `warpbeam solve --json`, wherever they stand: status bar, summary, Details, the
//! panes of Compare, the cards of Learn, and plots. Those of Measure are those of
//! `warpbeam study` and `warpbeam limits`.

use crate::common::lab::*;
use serde_json::Value;

/// Texts of the window.
#[derive(Debug)]
pub struct Shown(pub Vec<String>);

fn open_of(lab: Lab) -> Ui {
    let mut ui = window([1280.0, 2000.0], lab);
    ui.run_steps(3);
    ui
}

/// Returns the numbers of `solve` for a scene.
pub fn solve(scene: &Scene) -> Value {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.toml");
    std::fs::write(&path, scene.to_toml().unwrap()).unwrap();
    solve_end(&[path.to_str().unwrap()]).1
}

/// Formats a displacement as plots do.
fn pair(value: &Value) -> String {
    engineering_pair([0, 1].map(|i| three_digits(value[i].as_f64().unwrap())), "m")
}

impl Shown {
    fn of(id: &str, scene: Scene) -> Self {
        let mut lab = lab_of(id, scene);
        lab.solve();
        let mut ui = open_of(lab);
        unfold(&mut ui, "stable");
        Self::labels(&ui)
    }

    fn in_view(ui: &Ui) -> Self {
        Self::with_role(ui, &|_| true)
    }

    pub fn labels(ui: &Ui) -> Self {
        Self::with_role(ui, &|role| role == Role::Label)
    }

    pub fn with_role(ui: &Ui, has: &dyn Fn(Role) -> bool) -> Self {
        let nodes = ui.get_all_by(|node| has(node.role())).map(|node| node.accesskit_node());
        Self(nodes.filter_map(|node| node.value().or(node.label())).collect())
    }

    /// Returns the value of a row of Details.
    pub fn row(&self, name: &str) -> &str {
        let at = self.0.iter().position(|text| text == name);
        at.and_then(|at| self.0.get(at + 1)).map_or_else(|| panic!("no row {name:?}: {:?}", self.0), String::as_str)
    }

    pub fn starting_with(&self, start: &str) -> Option<&str> {
        self.0.iter().map(String::as_str).find(|text| text.starts_with(start))
    }

    pub fn has(&self, text: &str) -> bool {
        self.0.iter().any(|shown| shown == text)
    }
}

/// Returns the start of the error in the bar: an error far below that of the reference is a bound.
fn headline(error: f64, probe: &Value) -> String {
    let bound = error + probe["reference_error_percent"].as_f64().unwrap_or(0.0);
    let is_hidden = bound > 0.01 && bound > 3.0 * error;
    format!("ERROR {}", if is_hidden { format!("≤ {}", bound_percent(bound)) } else { percent(error) })
}

/// Compares all numbers of a result in equilibrium.
fn compare(what: &str, shown: &Shown, json: &Value) {
    let probe = &json["probes"][0];
    let iterations = json["iterations"].as_u64().unwrap();
    let residual = format!("{iterations} since the last change, residual {:.2e}", json["residual"].as_f64().unwrap());
    assert_eq!(shown.row("Iterations"), residual, "{what}");
    let bar = shown.starting_with("ERROR ").unwrap();
    match probe["error_percent"].as_f64() {
        Some(error) => {
            assert!(bar.starts_with(&headline(error, probe)), "{what}: {bar}, {error}");
            assert!(shown.row("Error").starts_with(&format!("{} ± ", percent(error))), "{what}: {error}");
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
    let whole_pair = |value: &Value| engineering_pair([0, 1].map(|i| value[i].as_f64().unwrap()), "m");
    assert_eq!(shown.row(&format!("{name} Δx, Δy")), whole_pair(&probe["u"]), "{what}");
    let mesh_error = format!("{} (estimate)", percent(json["mesh_error_percent"].as_f64().unwrap()));
    assert_eq!(shown.row("Error in energy"), mesh_error, "{what}");
    let strain = engineering(three_digits(100.0 * json["max_strain"].as_f64().unwrap()), "%");
    let stress = &json["max_von_mises"];
    let place = |value: f64| format!("{} at {}", engineering(three_digits(value), "Pa"), whole_pair(&stress["at"]));
    let stress = stress["value"].as_f64().map_or("\u{2013}".to_owned(), place);
    assert!(shown.row("Stress").starts_with(&stress), "{what}: {stress}, {}", shown.row("Stress"));
    let row = shown.row("Strain");
    assert!(row == strain || row == format!("{strain}: too large"), "{what}: {strain}");
    assert_eq!(shown.row("Energy"), engineering(json["energy"]["elastic"].as_f64().unwrap(), "J"), "{what}");
    assert!(json["method"] != "newton" || !shown.has("ρ"), "{what}: it does not iterate so");
    if json["method"] == "warped" {
        let rho = json["fixed_point_rho"].as_f64();
        let bar = rho.map_or_else(
            || "ρ \u{2013}".to_owned(),
            |rho| format!("ρ {} per iteration", engineering(two_digits(rho), "")),
        );
        assert_eq!(shown.starting_with("ρ "), Some(bar.as_str()), "{what}");
        let claims = json["claims"].as_array().unwrap();
        let words =
            claims.iter().find(|claim| claim["claim"] == "disturbance").and_then(|claim| claim["text"].as_str());
        let digits = words.and_then(|words| words.split("ρ = ").nth(1)?.split([';', ' ']).next());
        assert_eq!(digits.is_some(), rho.is_some(), "{what}: {words:?}");
        let has = |digits| shown.row("ρ").contains(&format!("ρ = {digits}"));
        assert!(digits.is_none_or(has), "{what}: {digits:?}, {}", shown.row("ρ"));
    }
}

/// Each scene has its own load and a hundred times it, where `warped` diverges and has no numbers; some have a tenth too.
#[test]
fn numbers_are_those_of_solve() {
    let (mut results, mut diverged) = (0, 0);
    let little = sampled(ids_of(Analysis::Static), 4);
    for id in ids_of(Analysis::Static) {
        for factor in [1.0, 100.0].into_iter().chain(little.contains(&id).then_some(0.1)) {
            let mut scene = scene(id);
            // The files of meshes lie elsewhere.
            if factor != 1.0 && scene.mesh.is_some() {
                continue;
            }
            scene.scale_loads(factor);
            if factor > 1.0 {
                scene.solver.method = MethodKind::Warped;
            }
            let what = format!("{id} at {factor}");
            let json = if scene.mesh.is_some() { solve_end(&[id]).1 } else { solve(&scene) };
            let shown = Shown::of(id, scene.clone());
            if json["status"] == "converged" {
                compare(&what, &shown, &json);
                results += 1;
            } else {
                let bar = shown.starting_with("ERROR ").unwrap();
                assert!(!bar.contains('%'), "{what}: {bar}");
                // ρ is that of the equilibrium that Newton's method finds.
                let newton = solve(&scene.with_method(MethodKind::Newton));
                let rho = newton["fixed_point_rho"].as_f64().filter(|_| newton["status"] == "converged");
                let rho = rho
                    .map_or_else(|| "ρ \u{2013}".to_owned(), |rho| format!("ρ {} ", engineering(two_digits(rho), "")));
                let seen = shown.starting_with("ρ ").unwrap();
                assert!(!seen.contains("per iteration"), "{what}: {seen} is not that of the body that is drawn");
                assert!(seen.starts_with(&rho) && shown.row("Error in energy") == "\u{2013}", "{what}: {seen}, {rho}");
                assert!(shown.starting_with("Converged").is_none(), "{what}: {:?}", shown.0);
                diverged += 1;
            }
        }
    }
    let fewest = if sweeps_run_in_full() { 21 } else { 15 };
    assert!(results >= fewest && diverged > 4, "{results} results, {diverged} diverged");
}

/// Each pane of Compare has the numbers of `solve` for the pane's scene. The time in the header is the pane's.
#[test]
fn panes_have_the_numbers_of_solve() {
    let mut diverged = 0;
    for (id, factor) in [("article", 1.0), ("cantilever", 1.0), ("cantilever", 3.0), ("gravity", 1.0)] {
        let mut scene = scene(id);
        scene.scale_loads(factor);
        let mut lab = lab_of(id, scene);
        lab.show_comparison(&parse_panes("linear,warped,newton,newton:t6").unwrap());
        lab.solve();
        let ui = open_of(lab);
        let shown = Shown::in_view(&ui);
        let bar = ui.state().desk.session.timed_from_rest().map(|solve| solve.timings.total().as_secs_f64());
        for (number, pane) in ui.state().panes().iter().enumerate() {
            let json = solve(pane.run.wanted.as_ref().unwrap());
            let setting = pane.setting.of(ui.scene());
            let what = format!("{id} at {factor}, {setting}");
            let header = shown.starting_with(&format!("Pane {}: ", number + 1)).unwrap();
            if json["status"] != "converged" {
                assert!(header.contains("Does not converge") && !header.contains("error"), "{what}: {header}");
                diverged += 1;
                continue;
            }
            let probe = &json["probes"][0];
            let error = probe["error_percent"].as_f64().map(percent).unwrap();
            // A pane with the panel's settings has the time of the status bar.
            let is_panels = pane.run.wanted.as_ref() == Some(ui.scene());
            let seconds = bar.filter(|_| is_panels).unwrap_or_else(|| pane.seconds().unwrap());
            let time = engineering(two_digits(seconds), "s");
            let iterations = count(json["iterations"].as_u64().unwrap(), "iteration");
            let (header, area) = header.rsplit_once(" \u{b7} area ").unwrap();
            let strain = 100.0 * json["max_strain"].as_f64().unwrap();
            let strain = if strain > 10.0 { format!("nodal strain {}, ", percent(strain)) } else { String::new() };
            let expected = format!(": error {error}, {strain}{time} \u{b7} {iterations}");
            assert!(header.ends_with(&expected), "{what}: {header}, expected {expected}");
            let area: f64 = area.replace('\u{2212}', "-").trim_end_matches(" %").parse().unwrap();
            let change = json["area_change_percent"].as_f64().unwrap();
            assert!((area - change).abs() < 0.006 + 0.05 * area.abs(), "{what}: {header}, {area} %");
        }
    }
    assert!(diverged > 0);
}

/// The rows of the load curve have the numbers of `solve` by linear theory and by Newton's method, and those of the reference
/// solution.
#[test]
fn rows_of_the_load_curve_have_the_numbers_of_solve() {
    for id in ["cantilever", "elastica"] {
        let scene = scene(id);
        let mut lab = lab_of(id, scene.clone());
        lab.show_tab(MeasureTab::LoadCurve);
        lab.solve();
        let shown = Shown::in_view(&open_of(lab));
        let probe = |method| solve(&scene.clone().with_method(method))["probes"][0].clone();
        let exact = probe(MethodKind::Newton);
        for (name, u) in [
            (format!("{} linear", scene.element().id()), &probe(MethodKind::Linear)["u"]),
            ("load path".to_owned(), &exact["u"]),
            ("exact beam".to_owned(), &exact["reference_u"]),
        ] {
            assert!(shown.has(&format!("{name}: {}", pair(u))), "{id} {name}: {u}, {:?}", shown.0);
        }
    }
}

/// On every card of Learn the status bar has the numbers of `solve` for the card's scene.
#[test]
fn cards_have_the_numbers_of_solve() {
    let mut lab = lab_of("cantilever", scene("cantilever"));
    lab.show_card(1);
    let (mut errors, mut rhos) = (0, 0);
    for number in 1..=lab.card().unwrap().1 {
        lab.show_card(number);
        lab.solve();
        let mut ui = open_of(lab);
        let scene = ui.scene().clone();
        let (shown, json) = (Shown::in_view(&ui), solve(&scene));
        let what = format!("card {number}");
        let is_solved = *ui.simulation().status() == Status::Converged;
        assert_eq!(json["status"] == "converged", is_solved, "{what}: {}", json["status"]);
        let bar = shown.starting_with("ERROR ").unwrap();
        match json["probes"][0]["error_percent"].as_f64().filter(|_| is_solved) {
            Some(error) => {
                assert!(bar.starts_with(&headline(error, &json["probes"][0])), "{what}: {bar}, {error}");
                errors += 1;
            }
            None => assert!(!bar.contains('%'), "{what}: {bar}"),
        }
        // A card about the iteration has ρ at the equilibrium, which `newton` finds.
        if let Some(text) = shown.0.iter().find(|text| text.contains("rho = ")) {
            let rho = solve(&scene.with_method(MethodKind::Newton))["fixed_point_rho"].as_f64().unwrap();
            assert!(text.ends_with(&format!("rho = {}", two_digits(rho))), "{what}: {text}, {rho}");
            rhos += 1;
        }
        ui.step();
        lab = ui.0.into_state();
    }
    assert!(errors >= 6 && rhos == 2, "{errors} errors, {rhos} numbers ρ");
}

/// The list of settings has the errors of `study`. The error of the scene's own setting is that of `solve`.
#[test]
fn settings_have_the_errors_of_study() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().to_str().unwrap();
    succeeds(&["study", "article", "--quick", "--out", out]);
    let csv = std::fs::read_to_string(folder.path().join("study.csv")).unwrap();
    let (head, rows) = table(&csv);
    let column = |name: &str| head.iter().position(|own| *own == name).unwrap();
    let scene = scene("article");
    let study = Study::new(&scene, Extent::Quick, &go_on).unwrap();
    let written: Vec<_> = rows.into_iter().zip(&study.measurements).collect();
    assert_eq!(written.len(), study.measurements.len());
    let texts = written.iter().map(|(row, m)| {
        assert_eq!((row[column("element")], row[column("method")]), (m.setting.element.id(), m.setting.method.id()));
        let time = engineering(two_digits(1e-3 * m.milliseconds), "s");
        let bound: f64 = row[column("at_most_percent")].parse().unwrap();
        let at_most = format!("\u{2264}{}", bound_percent(bound));
        (format!("{time:>7}  {at_most:>8}  {}", m.setting), bound)
    });
    let texts: Vec<(String, f64)> = texts.collect();
    let mut lab = lab_of("article", scene.clone());
    lab.solve();
    lab.show_study(study.clone());
    let ui = open_of(lab);
    let buttons = Shown::with_role(&ui, &|role| role == Role::Button);
    let listed: Vec<&String> = buttons.0.iter().filter(|text| text.contains(" %  ")).collect();
    assert!(listed.len() > 3, "{listed:?}");
    for label in listed {
        assert!(texts.iter().any(|(text, bound)| text == label && *bound <= 1.0), "{label} is not in the table");
    }
    let scene = scene.with_method(MethodKind::Newton);
    let own = written.iter().find(|(row, m)| m.applied() == Setting::of(&scene) && row[column("converged")] == "true");
    let (row, _) = own.unwrap();
    let error: f64 = row[column("error_percent")].parse().unwrap();
    assert_eq!(percent(error), percent(solve(&scene)["probes"][0]["error_percent"].as_f64().unwrap()));
}

/// Each strip of Limits has the words of a row of `limits`.
#[test]
fn strips_have_the_words_of_limits() {
    let text = stdout(&warpbeam(&["limits", "article"]));
    let mut lab = lab_of("article", scene("article"));
    lab.show_tab(MeasureTab::HowFar);
    lab.solve();
    let shown = Shown::in_view(&open_of(lab));
    let rows: Vec<&str> = text.lines().skip(3).filter(|row| !row.is_empty()).collect();
    assert_eq!(rows.len(), 9, "{text}");
    for row in rows {
        // Columns are at least two spaces apart.
        let cells: Vec<&str> = row.split("  ").map(str::trim).filter(|cell| !cell.is_empty()).collect();
        let [name, good, usable, converges, law] = cells[..] else { panic!("{row}") };
        let words = format!(
            "{name}: within 1 %: {good}; within 5 %: {usable}; converges: {converges}; strains above 10 %: {law}"
        );
        assert!(shown.has(&words), "{words}: {:?}", shown.0);
    }
}
