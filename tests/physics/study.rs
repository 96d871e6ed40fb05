//! Tests of the speed–accuracy study of bodies at rest and in motion, and the atlas of motions.

use std::fs;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};

use crate::common::*;
use warpbeam::study::{StudyReference, Tuning};

/// They reach an error for which six-node triangles need at least twice the unknowns.
#[test]
fn single_rows_of_bending_elements_are_studied() {
    for id in ["cantilever", "elastica"] {
        let study = Study::new(&scene(id), Extent::Quick, &go_on).unwrap();
        let fewest = |element| {
            let close = study.measurements.iter().filter(|m| m.setting.element == element && m.error_percent() <= 1.0);
            close.min_by_key(|m| m.dofs).unwrap()
        };
        let [q4, t6] = [ElementKind::Q4, ElementKind::T6].map(fewest);
        assert!(2 * q4.dofs <= t6.dofs, "{id}: {} unknowns {}, {} {}", q4.dofs, q4.setting, t6.dofs, t6.setting);
        for method in METHODS.iter().map(|m| m.kind) {
            for cells in [5, 10, 20, 40].map(|along| [along, 1]) {
                let own = (ElementKind::Q4, Some(cells), method);
                let mut settings = study.measurements.iter().map(|m| m.setting);
                assert!(settings.any(|s| (s.element, s.cells, s.method) == own), "{id}: {} {cells:?}", method.id());
            }
        }
    }
}

/// The progress never decreases; each element's measurements go from coarse to fine.
#[test]
fn a_study_reports_its_progress_and_measures_the_likely_best_settings_first() {
    let (last, mut elements) = (Mutex::new(0.0), Vec::new());
    let observe = |progress: Progress<'_>| {
        let mut last = last.lock().unwrap();
        assert!((*last..=1.0 + 1e-9).contains(&progress.fraction), "from {last} to {}", progress.fraction);
        *last = progress.fraction;
        ControlFlow::Continue(())
    };
    let partial = &mut |study: &Study| {
        let mut known: Vec<ElementKind> = study.measurements.iter().map(|m| m.setting.element).collect();
        known.dedup();
        elements.push(known);
    };
    let study = Study::with_partial(&scene("cantilever"), Extent::Quick, &observe, partial).unwrap();
    let last = last.into_inner().unwrap();
    assert!((last - 1.0).abs() < 1e-9, "it ends at {last}");
    assert_eq!(elements[0], [ElementKind::T6]);
    let all: Vec<ElementKind> = scene("cantilever").elements().collect();
    assert_eq!(elements.last(), Some(&all));
    let settings = || study.measurements.iter().map(|m| m.setting);
    let unknowns = |element| settings().filter(move |s| s.element == element).map(|s| s.cells);
    assert!(all.into_iter().all(|element| unknowns(element).is_sorted()), "coarse to fine");
}

/// Errors follow the orders of the integrators, energies their promises, and no setting on the front is dominated.
#[test]
fn a_swing_is_studied() {
    let study = Study::new(&scene_with("swing", &["dynamics.duration=1"]), Extent::Quick, &go_on).unwrap();
    let own = study.own_error_percent;
    assert!(own > 0.0 && own < 0.5, "{own}");
    let reference = &study.reference;
    assert!((reference.samples.duration() - 1.0).abs() < 1e-9);
    let at = |kind, rate: f64, iterations| -> &Measurement {
        let found = study.measurements.iter().find(|m| {
            let s = &m.setting;
            (s.element, s.cells, s.method) == (ElementKind::T6, Some([20, 1]), MethodKind::Newton)
                && s.iterations == iterations
                && s.stepping.is_some_and(|t| t.integrator == kind && (t.time_step * rate - 1.0).abs() < 1e-9)
        });
        found.unwrap()
    };
    let steps = |kind, iterations| {
        [60.0, 120.0, 240.0].map(|rate| at(kind, rate, iterations)).map(|m| m.error.unwrap().iteration)
    };
    for (kind, iterations, overall, last) in [
        (IntegratorKind::TrBdf2, 1, 8.0..11.0, 3.0..4.5),
        (IntegratorKind::TrBdf2, 0, 7.5..11.0, 2.8..4.5),
        (IntegratorKind::EnergyMomentum, 0, 7.0..11.0, 2.4..4.5),
        (IntegratorKind::ImplicitEuler, 1, 2.8..4.2, 1.6..2.2),
        (IntegratorKind::ImplicitEuler, 0, 2.8..4.2, 1.6..2.2),
    ] {
        let [a, b, c] = steps(kind, iterations);
        assert!(overall.contains(&(a / c)) && last.contains(&(b / c)), "{} {iterations}: {a} {b} {c}", kind.id());
    }
    for m in &study.measurements {
        let setting = m.setting;
        let motion = m.motion.unwrap();
        assert!(!motion.is_cut_short && m.converged, "{setting}");
        let (e, rms, drift) = (m.error.unwrap(), motion.rms_percent, motion.drift_percent);
        let parts = [e.total, rms, e.discretization, e.iteration, e.model, drift, m.milliseconds];
        assert!(parts.iter().all(|v| v.is_finite()) && m.milliseconds > 0.0 && motion.counts.halvings == 0, "{m:?}");
        // The parts are distances along a chain from the path to the reference's path.
        assert!(e.total <= m.error_percent() * (1.0 + 1e-9) && rms <= e.total, "{setting}: {e:?}");
        assert_eq!(e.model == 0.0, setting.method != MethodKind::Linear, "{setting}");
        match setting.stepping.unwrap().integrator {
            IntegratorKind::EnergyMomentum => assert!(drift.abs() < 1e-3, "{setting}: {drift}"),
            IntegratorKind::ImplicitEuler => assert!(drift < -0.01, "{setting}: {drift}"),
            _ => {}
        }
    }
    // Explicit steps are 0.9 of the critical step, rounded to integer parts of 1/60 s, so that they
    // end with those of the others.
    let stepping = study.measurements.iter().filter_map(|m| m.setting.stepping);
    for explicit in stepping.filter(|s| s.integrator == IntegratorKind::SymplecticEuler) {
        let parts = 1.0 / 60.0 / explicit.time_step;
        assert!(parts > 2.0 && (parts - parts.round()).abs() < 1e-6, "{explicit:?}");
    }
    // No setting is better than the front, every other setting is worse, and the front is sorted by time and by error.
    let pair = |m: &Measurement| (m.milliseconds, m.error_percent().max(own));
    for m in &study.measurements {
        let (time, error) = pair(m);
        let beaten =
            study.measurements.iter().map(pair).any(|(t, e)| t <= time && e <= error && (t, e) != (time, error));
        assert_eq!(m.pareto, !beaten, "{}", m.setting);
    }
    let front: Vec<_> = study.front().into_iter().map(pair).collect();
    assert!(front.len() > 2 && front.windows(2).all(|w| w[0].0 < w[1].0 && w[0].1 > w[1].1), "{front:?}");
    // The error of the chosen setting and the reference's own error are together within the requested error.
    let chosen = study.within(10.0)[0];
    assert!(chosen.error_percent() + own <= 10.0);
    assert!(study.within(0.5 * own).is_empty());
}

/// A study that is cancelled during timed or untimed runs keeps its measurements too.
#[test]
fn a_motion_study_reports_its_progress_and_keeps_its_measurements() {
    let scene = scene_with("swing", &["dynamics.duration=0.1"]);
    let until = |is_enough: &(dyn Fn(usize, usize) -> bool + Sync)| {
        let seen = Mutex::new((0.0, 0, Vec::new()));
        let observe = |progress: Progress<'_>| {
            let mut seen = seen.lock().unwrap();
            let (last, timed, meshes) = &mut *seen;
            assert!((*last..=1.0).contains(&progress.fraction), "from {last} to {}", progress.fraction);
            *last = progress.fraction;
            let now = progress.now.map_or_else(String::new, ToString::to_string);
            if now.ends_with("paths of its settings") {
                meshes.push(now);
                meshes.dedup();
            } else {
                *timed += usize::from(!meshes.is_empty());
            }
            if is_enough(meshes.len(), *timed) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        let study = Study::new(&scene, Extent::Quick, &observe).unwrap();
        assert!(!study.front().is_empty() && !study.summary().contains("NaN"));
        let mut meshes: Vec<_> = study.measurements.iter().map(|m| (m.setting.element, m.setting.cells)).collect();
        meshes.dedup();
        (study.is_partial, meshes.len(), study.measurements.len())
    };
    // The study is cancelled when it reports the fourth setting, which is then not measured.
    assert_eq!(until(&|_, timed| timed == 4), (true, 1, 3));
    let (is_partial, meshes, measured) = until(&|meshes, _| meshes == 2);
    assert!(is_partial && meshes == 1 && measured > 20, "{is_partial} {meshes} {measured}");
    // Two meshes of every element.
    let all = 2 * ELEMENTS.len();
    assert_eq!(until(&|_, _| false), (false, all, all * measured));
}

#[test]
fn scenes_that_cannot_be_studied_are_refused() {
    let refused = |scene: &Scene| Study::new(scene, Extent::Quick, &go_on).unwrap_err();
    assert_eq!(refused(&scene_with("swing", &["probe=[]"])), StudyError::NoProbe);
    assert_eq!(refused(&scene_with("swing", &["load=[]", "beam.cells=[2,1]"])), StudyError::NoProbe);
    let moving = scene("swing");
    assert_eq!(Tuning::of(&moving, Demand::default(), &go_on).unwrap_err(), StudyError::InMotion);
    for after in [0, 3] {
        let heard = AtomicU32::new(0);
        let observe = |progress: Progress<'_>| {
            assert!((0.0..=1.0).contains(&progress.fraction));
            let is_enough = heard.fetch_add(1, Ordering::Relaxed) >= after;
            if is_enough { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        assert_eq!(Study::new(&moving, Extent::Quick, &observe).unwrap_err(), StudyError::Cancelled);
    }
}

/// A block sheared until its elements invert, a force on the measured point, an error below the reference's.
#[test]
fn tuning_refuses_demands_below_the_known_error() {
    let block = scene_with("shear", &["load.0.force=[1e6,0]"]);
    let point = Scene::beam(2.0, 1.0).clamp("left").force([2.0, 0.5], [0.0, -100.0]).probe("tip", [2.0, 0.5]);
    for (name, scene, asked) in [("block", block, 5.0), ("point", point, 1.0), ("shear", scene("shear"), 0.01)] {
        let refused = Tuning::of(&scene, Demand { max_error_percent: Some(asked), max_time_ms: None }, &go_on);
        assert!(refused.as_ref().is_err_and(StudyError::is_unknown), "{name}: {:?}", refused.map(|t| t.chosen));
    }
    let [text, _] = ends_in(".".as_ref(), 1, &["tune", "shear", "--error", "0.01%"]);
    assert!(text.contains("not known which settings meet at most 0.01 % error"), "{text}");
}

/// A cancelled search for a setting chooses from the measurements taken so far.
#[test]
fn a_cancelled_tuning_chooses_from_what_was_measured() {
    let scene = scene("elastica");
    let measured = AtomicU32::new(0);
    let observe = |progress: Progress<'_>| {
        let is_setting = progress.now.is_some_and(|now| now.to_string().contains("×"));
        let count = measured.fetch_add(u32::from(is_setting), Ordering::Relaxed) + u32::from(is_setting);
        if count < 12 { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
    };
    let own = Reference::of(&scene).unwrap().first().unwrap().own_error_percent;
    let demand = Demand { max_error_percent: Some(own * 1.001), max_time_ms: None };
    let tuning = Tuning::of(&scene, demand, &observe).unwrap();
    assert!(tuning.study.is_partial && !tuning.met && tuning.chosen.converged, "{tuning}");
    assert!(tuning.study.measurements.len() < 60);
}

/// The files have finite numbers. A step that is too short to be run to the end is reported.
#[test]
fn study_of_a_motion_writes_its_files() {
    let folder = tempfile::tempdir().unwrap();
    for (id, set) in [("swing", "dynamics.duration=0.25"), ("chime", "dynamics.duration=0.01")] {
        let out = folder.path().join(id);
        let summary = succeeds(&["study", id, "--quick", "--set", set, "--out", out.to_str().unwrap()]);
        assert_eq!(summary, fs::read_to_string(out.join("study.txt")).unwrap());
        has_all(&summary, "its own error about|an error of 10 % costs");
        let csv = fs::read_to_string(out.join("study.csv")).unwrap();
        let (header, rows) = table(&csv);
        assert_eq!(
            header.join(","),
            "element,cells_along,cells_across,dofs,integrator,method,time_step_s,solves,ending,ms_per_simulated_second,\
             error_percent,rms_error_percent,discretization_percent,integration_percent,model_percent,error_bound_percent,\
             resolved,energy_drift_percent,energy,steps_taken,solves_taken,factorizations,pareto,at_most_percent,undecided"
        );
        let text = ["element", "integrator", "method", "ending", "resolved", "energy", "pareto", "undecided"];
        for row in &rows {
            assert_eq!(row.len(), header.len());
            let finished = row[8] == "finished";
            for (column, value) in header.iter().zip(row).filter(|(column, _)| !text.contains(column)) {
                // A run that did not finish has no error.
                let empty = value.is_empty() && !finished && column.ends_with("_percent");
                assert!(empty || value.parse::<f64>().unwrap().is_finite(), "{column}: {row:?}");
            }
        }
        let has = |column: usize, word: &str| rows.iter().any(|row| row[column] == word);
        assert!(["tr-bdf2", "energy-momentum", "implicit-euler", "symplectic-euler"].iter().all(|i| has(4, i)));
        assert!(["linear", "newton", "auto"].iter().all(|m| has(5, m)) && has(0, "t3") && has(0, "t6"));
        assert!(has(22, "true") && has(22, "false") && has(18, "lost") && has(18, "kept"));
        assert_eq!(has(8, "cut_short"), id == "chime");
        assert_eq!(summary.contains("did not reach the end"), id == "chime", "{summary}");
        let svg = fs::read_to_string(out.join("study.svg")).unwrap();
        assert!(svg.contains("Pareto front") && svg.contains("real time") && svg.contains("t6 energy-momentum"));
        assert!(!svg.contains("NaN") && !svg.contains("inf"));
    }
}

/// Motions are studied over periods or their duration, however slow: linear theory is wrong for a body that sags.
#[test]
fn slow_motions_are_studied_over_their_periods() {
    for (name, duration) in [("slow-gravity", 40_000.0..=40_000.0), ("slow-cantilever", 15.0..=16.1)] {
        let slow = scene(&file(name));
        // The study ends with the first mesh on which linear theory is wrong.
        let is_seen = AtomicBool::new(false);
        let observe = |_: Progress<'_>| match is_seen.load(Ordering::Relaxed) {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        };
        let partial = &mut |study: &Study| {
            let linear = study.measurements.iter().filter(|m| m.setting.method == MethodKind::Linear);
            let model = linear.filter_map(|m| Some(m.error?.model)).fold(0.0, f64::max);
            is_seen.store(model > 1.0, Ordering::Relaxed);
        };
        let study = Study::with_partial(&slow, Extent::Quick, &observe, partial).unwrap();
        let (reference, studied) = (&study.reference, study.reference.samples.duration());
        assert!(duration.contains(&studied), "{name}: {studied} s");
        assert!(is_seen.into_inner(), "{name}: linear theory is not wrong");
        // The body moves through the whole of its vibration.
        let highest = reference.path.iter().map(|u| u.y).fold(f64::NEG_INFINITY, f64::max);
        let lowest = reference.path.iter().map(|u| u.y).fold(f64::INFINITY, f64::min);
        assert!(highest > 0.5 * lowest && lowest < 0.0, "{name}: from {lowest} to {highest} m");
    }
    for (id, set) in [("chime", "dynamics.duration=0.01"), ("spin", "dynamics.duration=0.2")] {
        let reference = StudyReference::new(&scene_with(id, &[set]), Extent::Quick, &go_on).unwrap();
        let studied = reference.samples.interval * reference.path.len() as f64;
        let whole: f64 = set.split('=').nth(1).unwrap().parse().unwrap();
        assert!(studied <= whole * (1.0 + 1e-9) && studied > 0.8 * whole, "{id}: {studied} s of {whole} s");
    }
}

/// The summary and the table include the reference's error; ranks that it leaves open are marked.
#[test]
fn bounds_of_a_study_include_the_error_of_the_reference() {
    let study = Study::new(&scene("shear"), Extent::Quick, &go_on).unwrap();
    let own = study.own_error_percent;
    assert!(own > 0.0);
    let (csv, summary) = (study.table(), study.summary());
    let (header, rows) = table(&csv);
    let column = |name: &str| header.iter().position(|column| *column == name).unwrap();
    let undecided: Vec<bool> = study.measurements.iter().map(|m| m.undecided).collect();
    for ((row, m), undecided) in rows.iter().zip(&study.measurements).zip(&undecided) {
        let at_most: f64 = row[column("at_most_percent")].parse().unwrap();
        assert!((at_most - m.error_percent() - own).abs() < 1e-9 * at_most, "{row:?}");
        assert!((study.error_bound(m) - at_most).abs() < 1e-9 * at_most);
        assert_eq!(row[column("undecided")], undecided.to_string());
        let faster = study.measurements.iter().filter(|o| *o != m && o.milliseconds <= m.milliseconds);
        let best = faster.map(|o| o.error_percent()).fold(f64::INFINITY, f64::min);
        assert_eq!(*undecided, (best - m.error_percent()).abs() < own, "{}", m.setting);
    }
    assert!(undecided.contains(&true) && undecided.contains(&false));
    let front = summary.lines().skip_while(|line| !line.contains("at most, %")).skip(1);
    let mut marked = false;
    for (line, m) in front.zip(study.front()) {
        let stated: f64 = line.split_whitespace().nth(1).unwrap().parse().unwrap();
        assert!(stated >= own && (stated - study.error_bound(m)).abs() < 1e-4, "{line}");
        let index = study.measurements.iter().position(|o| o == m).unwrap();
        assert_eq!(line.ends_with("(rank undecided)"), undecided[index], "{line}");
        marked |= undecided[index];
        // A bound within one percent costs some time.
        let within = summary.lines().any(|line| line.starts_with("an error of 1 % costs "));
        assert!(stated > 1.0 || within, "{summary}");
    }
    assert_eq!(summary.contains("rank undecided: a faster setting"), marked, "{summary}");
    let demand = Demand { max_error_percent: Some(5.0), max_time_ms: None };
    let tuning = Tuning::of(&scene("shear"), demand, &go_on).unwrap();
    let bound = format!("error at most {:.4} %", tuning.study.error_bound(&tuning.chosen));
    assert!(tuning.to_string().contains(&bound), "{tuning}");
    let moving = Study::new(&scene_with("swing", &["dynamics.duration=.1"]), Extent::Quick, &go_on).unwrap();
    let own = moving.own_error_percent;
    for m in moving.front() {
        let bound = moving.error_bound(m);
        assert!((bound - m.error_percent() - own).abs() < 1e-12);
        assert!([bound, bound.next_down()].map(|most| moving.within(most).contains(&m)) == [true, false]);
        assert!(moving.summary().contains(&format!(" {bound:.4} ")), "{}", moving.summary());
    }
}

/// The stated error of a motion's reference covers its distance from a finer one, whatever mesh the scene has.
#[test]
fn references_of_motions_state_their_errors() {
    let scenes: &[(&str, [&str; 2])] = &[
        ("swing", ["beam.cells=[20,1]", "beam.cells=[40,2]"]),
        ("flick", ["beam.cells=[20,1]", "beam.cells=[80,2]"]),
        ("jelly", ["beam.cells=[8,6]", "beam.cells=[16,12]"]),
        ("sway", ["beam.cells=[1,30]", "beam.cells=[2,60]"]),
        ("spin", ["beam.cells=[20,1]", "beam.cells=[40,2]"]),
        ("chime", ["beam.cells=[25,1]", "beam.cells=[50,2]"]),
    ];
    let (count, longest) = if sweeps_run_in_full() { (scenes.len(), 2.0) } else { (1, 1.0) };
    let reference = |id: &str, sets: &[&str]| {
        let mut scene = scene_with(id, sets);
        scene.dynamics.duration = scene.dynamics.duration.min(longest);
        StudyReference::new(&scene, Extent::Quick, &go_on).unwrap()
    };
    for (id, [coarse, fine]) in &scenes[..count] {
        let best = reference(id, &["beam.element=t6", fine]);
        for sets in [["beam.element=q4", coarse], ["beam.element=t6", coarse]] {
            let own = reference(id, &sets);
            let [distance, _] = best.distance(&own.path, &best.path);
            let stated = own.error_percent + best.error_percent;
            assert!(distance <= stated, "{id} {sets:?}: {distance} % > {stated} %, {}", own.text);
        }
    }
}
