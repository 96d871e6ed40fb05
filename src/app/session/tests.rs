//! Tests of the session without user interface: edits, undo history, background solves, files, motions and grabs.

use std::fs;

use super::*;
use crate::app::session::facts::CurveFact;
use crate::app::task::keyed::Keyed;

fn cantilever(force: f64) -> Scene {
    Scene::beam(4.0, 1.0).with_cells(8, 2).clamp("left").force("right", [0.0, force]).probe("tip", "right")
}

fn source(name: impl Into<PathBuf>) -> Source {
    Source { name: name.into(), assignments: Vec::new() }
}

fn session(scene: Scene) -> Session {
    let simulation = Simulation::new(&scene).unwrap();
    Session::new(source("-"), scene, simulation)
}

fn solved(scene: Scene) -> Session {
    let mut session = session(scene);
    session.solve(false);
    session
}

/// Returns a session with a scene of this name.
fn open(source: Source) -> Session {
    let scene = crate::scene::open(&source).unwrap();
    let simulation = Simulation::new(&scene).unwrap();
    Session::new(source, scene, simulation)
}

fn edited(session: &Session, label: &'static str, change: impl FnOnce(&mut Scene)) -> Edit {
    let mut scene = session.scene().clone();
    change(&mut scene);
    Edit::Scene(label, Box::new(scene))
}

fn with_force(session: &Session, force: f64) -> Edit {
    edited(session, "Force", |scene| scene.set_force(0, [0.0, force]).unwrap())
}

fn tip(session: &Session) -> f64 {
    session.simulation().probe("tip").unwrap().y
}

/// Polls until the background work is done.
fn wait(session: &mut Session) {
    while session.is_working() {
        session.poll();
        std::thread::yield_now();
    }
}

#[test]
fn edits_change_the_solution_and_are_undone_and_redone() {
    let mut session = solved(cantilever(-100.0));
    let first = tip(&session);
    let changed = session.apply(with_force(&session, -200.0)).unwrap();
    assert_eq!(changed, Changed { scene: true, ..Changed::default() });
    assert!(session.is_edited() && session.iterates());
    session.solve(false);
    let second = tip(&session);
    assert!(second < 1.5 * first, "twice the force: {first} and {second} m");
    session.apply(Edit::Undo).unwrap();
    session.solve(false);
    assert!((tip(&session) - first).abs() < 1e-6 * first.abs() && !session.is_edited());
    assert!(!session.undo.can_undo() && session.undo.can_redo());
    session.apply(Edit::Redo).unwrap();
    session.solve(false);
    assert!((tip(&session) - second).abs() < 1e-6 * second.abs());
}

#[test]
fn a_refused_edit_leaves_the_session_unchanged() {
    let mut session = solved(cantilever(-100.0));
    let (scene, first) = (session.scene().clone(), tip(&session));
    session.changed = Changed::default();
    assert!(session.apply(edited(&session, "Poisson ν", |scene| scene.material.poisson = 0.9)).is_err());
    assert!(*session.scene() == scene && tip(&session) == first && !session.undo.can_undo());
    assert_eq!(std::mem::take(&mut session.changed), Changed::default());
    assert!(session.apply(Edit::Open(source("nowhere.toml"))).is_err());
    assert!(*session.scene() == scene && !session.undo.can_undo());
}

#[test]
fn a_large_model_is_solved_in_the_background_and_a_cancelled_edit_is_taken_back() {
    let mut session = solved(cantilever(-100.0));
    let first = tip(&session);
    session.most_unknowns = 0;
    session.apply(with_force(&session, -200.0)).unwrap();
    assert!(session.is_working() && session.work().is_some());
    wait(&mut session);
    assert!(session.simulation().status().is_success() && tip(&session) < 1.5 * first);
    assert_eq!(session.simulation().scene(), session.scene());
    // A new mesh of a large model is made in the background, too.
    let second = tip(&session);
    let finer = Edit::Scene("Cells along", Box::new(session.scene().clone().with_cells(64, 16)));
    session.changed = Changed::default();
    session.apply(finer.clone()).unwrap();
    assert!(session.is_working() && !std::mem::take(&mut session.changed).mesh, "the display keeps the last model");
    session.cancel();
    wait(&mut session);
    assert_eq!(session.scene().beam.as_ref().unwrap().cells, [8, 2]);
    assert!(tip(&session) == second && session.work().is_none());
    session.apply(Edit::Undo).unwrap();
    wait(&mut session);
    assert!((tip(&session) - first).abs() < 1e-6 * first.abs(), "the cancelled edit is no step");
    session.apply(finer).unwrap();
    wait(&mut session);
    assert!(session.changed.mesh && session.simulation().system().mesh().element_count() == 2 * 64 * 16);
}

#[test]
fn a_cancelled_solve_is_not_displayed_after_the_next_edit() {
    let mut session = solved(cantilever(-100.0));
    let first = session.scene().clone();
    session.most_unknowns = 0;
    for cells in [[16, 4], [8, 2]] {
        let cancelled = first.clone().with_cells(cells[0], cells[1]).force("top", [0.0, -50.0]);
        session.apply(Edit::Scene("Force", Box::new(cancelled.clone()))).unwrap();
        // The thread has ended, and nothing has polled its result, when the user cancels.
        std::thread::sleep(std::time::Duration::from_millis(100));
        session.cancel();
        session.apply(with_force(&session, -150.0)).unwrap();
        while session.is_working() {
            session.poll();
            assert!(*session.simulation().scene() != cancelled, "the display shows the cancelled scene");
        }
        assert!(session.simulation().status().is_success() && session.simulation().scene() == session.scene());
        session.apply(Edit::Undo).unwrap();
        wait(&mut session);
        assert_eq!(*session.scene(), first);
    }
}

#[test]
fn a_model_that_is_refused_in_the_background_is_reported() {
    let folder = tempfile::tempdir().unwrap();
    let mut session = solved(cantilever(-100.0));
    session.most_unknowns = 0;
    let first = session.scene().clone();
    let file = folder.path().join("none.msh").to_str().unwrap().to_owned();
    let mut wrong = first.clone();
    (wrong.beam, wrong.mesh) = (None, Some(crate::scene::MeshFile { file, element: None, scale: None, text: None }));
    let edited = session.apply(Edit::Scene("Mesh", Box::new(wrong)));
    wait(&mut session);
    let notices = std::mem::take(&mut session.notices);
    let is_reported = matches!(notices.as_slice(), [Notice { label: Some("Mesh"), .. }]);
    assert!(edited.is_err() || is_reported, "{notices:?}");
    assert_eq!(*session.scene(), first);
}

/// A motion that has exploded starts again with other settings: its body would still be many times its size.
#[test]
fn an_exploded_motion_starts_again_with_other_settings() {
    let scene = Scene::beam(2.0, 0.5).clamp("left").probe("tip", "right").gravity([0.0, -9.81]);
    let mut session = session(scene.moving(IntegratorKind::SymplecticEuler, 0.05));
    while !session.has_ended() {
        session.iterate();
    }
    assert!(matches!(session.simulation().status(), Status::Stopped(_)), "{:?}", session.simulation().status());
    let integrator = |scene: &mut Scene| scene.dynamics.integrator = IntegratorKind::TrBdf2;
    session.apply(edited(&session, "Integrator", integrator)).unwrap();
    assert_eq!((session.simulation().state().time(), tip(&session)), (0.0, 0.0));
    session.iterate();
    assert!(session.simulation().state().time() > 0.0 && tip(&session).abs() < 0.1, "{}", tip(&session));
}

/// After a grab the body is in the equilibrium before, with all its numbers: no search has taken their place.
#[test]
fn a_released_body_has_the_numbers_of_its_equilibrium() {
    let mut session = solved(cantilever(-100.0));
    let numbers = |session: &Session| {
        let simulation = session.simulation();
        let certificate = simulation.equilibrium().unwrap().certificate();
        let solve = (simulation.status().clone(), simulation.iterations(), *simulation.timings());
        (solve, certificate, session.model.residuals.to_vec(), simulation.displacement().to_vec())
    };
    let before = numbers(&session);
    assert!(before.1.is_some());
    let point = session.simulation().system().mesh().locate(Vector2::new(4.0, 0.5)).unwrap();
    session.grab(Grab { start: Some(point), ..Grab::default() });
    let (spring, force) = session.simulation().mouse_spring().unwrap();
    assert!(force.norm() < 1e-6 * spring.largest_force(), "a hand that does not pull pulls with {force} N");
    session.grab(Grab { target: Some(Vector2::new(3.0, 2.0)), ..Grab::default() });
    (0..40).for_each(|_| session.iterate());
    assert!(tip(&session) > 1.0, "the pull lifts the tip");
    session.grab(Grab { release: true, ..Grab::default() });
    assert_eq!(numbers(&session), before);
    // So has an iterate that has been accepted.
    session.apply(edited(&session, "Accept", |scene| scene.solver.accept_after = 2)).unwrap();
    session.solve(false);
    let accepted = numbers(&session);
    session.grab(Grab { start: Some(point), ..Grab::default() });
    (0..10).for_each(|_| session.iterate());
    session.grab(Grab { release: true, ..Grab::default() });
    assert!(numbers(&session) == accepted && !session.iterates(), "{:?}", accepted.0);
    session.apply(Edit::Undo).unwrap();
    session.solve(false);
    // A load that has changed meanwhile counts.
    session.grab(Grab { start: Some(point), target: Some(Vector2::new(3.0, 2.0)), release: false });
    session.apply(with_force(&session, -200.0)).unwrap();
    session.grab(Grab { release: true, ..Grab::default() });
    session.solve(false);
    assert!(tip(&session) < 1.5 * before.3.iter().map(|u| u.y).fold(0.0, f64::min), "{}", tip(&session));
}

#[test]
fn results_are_computed_at_rest_and_invalidated_by_edits_that_change_them() {
    let mut session = session(cantilever(-100.0));
    assert!(!session.request_facts(false, false, false), "the body is not at rest yet");
    session.solve(false);
    // The reference that follows a load is prepared in the background.
    while session.request_facts(false, false, false) {
        std::thread::yield_now();
    }
    let (facts, scene, mut curve) = (&session.facts, session.scene(), Keyed::<CurveFact>::default());
    curve.wait(scene);
    assert!(facts.reference.get(scene).is_some() && curve.get(scene).is_some());
    // The reference solution depends on the load, but not on the method.
    session.apply(edited(&session, "Method", |scene| scene.solver.method = MethodKind::Warped)).unwrap();
    assert!(!session.facts.reference.is_pending(session.scene()) && curve.is_pending(session.scene()));
    session.apply(with_force(&session, -150.0)).unwrap();
    assert!(session.facts.reference.is_pending(session.scene()) && session.facts.reference.latest().is_some());
    session.solve(false);
    assert!(session.facts.reference.get(session.scene()).is_some());
}

/// Saving is not an edit: undo after "Save as" keeps the new file and everything that belongs to it.
#[test]
fn a_saved_scene_stays_the_same_document_when_edits_are_undone() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    fs::write(path("first.toml"), cantilever(-100.0).to_toml().unwrap()).unwrap();
    let mut session = open(Source { name: path("first.toml"), assignments: vec!["load.0.force=[0,-150]".into()] });
    let scene = session.scene().clone();
    for (label, force) in [("Force", -200.0), ("Direction", -300.0), ("Force", -400.0)] {
        let change = |scene: &mut Scene| scene.set_force(0, [0.0, force]).unwrap();
        session.apply(edited(&session, label, change)).unwrap();
    }
    session.apply(Edit::Undo).unwrap();
    session.changed = Changed::default();
    let saved = session.scene().clone();
    for name in ["first.toml", "second.toml"] {
        session.save(&path(name)).unwrap();
        let check = |session: &mut Session| {
            assert_eq!(session.document().path(), Some(path(name).as_path()));
            assert!(!std::mem::take(&mut session.changed).document);
        };
        for _ in 0..2 {
            session.apply(Edit::Undo).unwrap();
            check(&mut session);
        }
        assert!(*session.scene() == scene && session.is_edited() && !session.undo.can_undo());
        for force in [-200.0, -300.0] {
            session.apply(Edit::Redo).unwrap();
            check(&mut session);
            assert_eq!(session.is_edited(), force > -300.0);
        }
        assert_eq!(*session.scene(), saved);
    }
    // A cancelled solve does not return to the previous file either.
    session.most_unknowns = 0;
    session.apply(with_force(&session, -500.0)).unwrap();
    session.save(&path("third.toml")).unwrap();
    session.cancel();
    assert_eq!(session.document().path(), Some(path("third.toml").as_path()));
    wait(&mut session);
    // An earlier document keeps its own file.
    session.apply(Edit::Open(source(path("first.toml")))).unwrap();
    wait(&mut session);
    session.save(&path("fourth.toml")).unwrap();
    session.apply(Edit::Undo).unwrap();
    assert_eq!(session.document().path(), Some(path("third.toml").as_path()));
}

/// A change of the scene's file between the crash and the restoration is noticed.
#[test]
fn restored_edits_know_what_their_file_contained() {
    let folder = tempfile::tempdir().unwrap();
    let copies = folder.path().join("unsaved");
    let path = folder.path().join("scene.toml");
    let mut crashed = session(cantilever(-100.0));
    crashed.save(&path).unwrap();
    crashed.apply(with_force(&crashed, -200.0)).unwrap();
    for is_changed in [false, true] {
        let (mut recovery, _) = recovery::RecoveryCopies::open(&copies).unwrap();
        recovery.keep(crashed.unsaved()).unwrap();
        drop(recovery);
        if is_changed {
            fs::write(&path, cantilever(-50.0).to_toml().unwrap()).unwrap();
        }
        let (mut recovery, left) = recovery::RecoveryCopies::open(&copies).unwrap();
        let left = left.unwrap();
        let mut next = session(cantilever(-1.0));
        next.apply(Edit::Restore(Box::new(left))).unwrap();
        assert!(next.scene() == crashed.scene() && next.is_edited());
        assert_eq!((next.is_outdated, next.document().has_changed()), (is_changed, is_changed));
        recovery.discard_left(None).unwrap();
    }
}

/// Where nothing more can be written, the scene's file and the copy of unsaved edits keep their content.
#[cfg(unix)]
#[test]
fn a_full_disk_leaves_file_and_copy_as_they_were() {
    const FOLDER: &str = "WARPBEAM_TEST_FULL_DISK";
    let edited = |folder: &Path, force: f64| {
        let mut session = open(source(folder.join("scene.toml")));
        session.apply(with_force(&session, force)).unwrap();
        session
    };
    let copy = |session: &Session, folder: &Path| {
        let (mut recovery, left) = recovery::RecoveryCopies::open(&folder.join("unsaved")).unwrap();
        (recovery.keep_at_once(session.unsaved()), left)
    };
    if let Some(folder) = std::env::var_os(FOLDER).map(PathBuf::from) {
        let mut session = edited(&folder, -300.0);
        assert!(session.save(&folder.join("scene.toml")).is_err() && session.is_edited());
        let (kept, left) = copy(&session, &folder);
        assert!(kept.is_err() && left.is_some());
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("scene.toml"), cantilever(-100.0).to_toml().unwrap()).unwrap();
    copy(&edited(folder.path(), -200.0), folder.path()).0.unwrap();
    let files = || -> Vec<_> {
        let entries =
            [folder.path().to_owned(), folder.path().join("unsaved")].map(|folder| fs::read_dir(folder).unwrap());
        let paths = entries.into_iter().flatten().map(|entry| entry.unwrap().path());
        let mut files: Vec<_> =
            paths.filter(|path| path.is_file()).map(|path| (fs::read(&path).unwrap(), path)).collect();
        files.retain(|(_, path)| path.extension().is_none_or(|extension| extension != "lock"));
        files.sort();
        files
    };
    let before = files();
    assert_eq!(before.len(), 2);
    // A process whose files may have no byte; pipes are not limited.
    let name = "app::session::tests::a_full_disk_leaves_file_and_copy_as_they_were";
    let output = std::process::Command::new("sh")
        .args(["-c", "trap '' XFSZ; ulimit -f 0; exec \"$0\" --exact \"$1\""])
        .args([std::env::current_exe().unwrap().as_os_str(), name.as_ref()])
        .env(FOLDER, folder.path())
        .output()
        .unwrap();
    let out = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success() && out.contains("1 passed"), "{out}");
    assert_eq!(files(), before);
}

/// A document whose body is too large to be displayed at once starts over, also where an edit makes the body small first.
#[test]
fn a_large_document_that_becomes_small_starts_over() {
    let mut session = solved(cantilever(-100.0));
    let large = large(6);
    let document = Document::new(source("large"), large.clone());
    session.apply(Edit::Restore(Box::new(Version { document, scene: large }))).unwrap();
    assert!(session.is_working() && !std::mem::take(&mut session.changed).document);
    let small = Edit::Scene("Cells along", Box::new(cantilever(-1000.0)));
    assert!(session.apply(small).unwrap().document && !session.is_working());
    assert!(session.iterates() && tip(&session) == 0.0, "it starts from rest");
}

/// Returns a cantilever with about this many thousand unknowns.
fn large(thousands: u32) -> Scene {
    cantilever(-1000.0).with_cells(28 * thousands, 4)
}

/// A load has one answer, whatever state the search begins from: one that fails begins again at rest.
#[test]
fn a_search_that_fails_begins_again_at_rest() {
    let mut session = open(source("cantilever"));
    for force in [-1500.0, -2080.0, -2210.0, -2040.0, -2120.0, -1900.0, -2040.0, -2120.0] {
        session.apply(with_force(&session, force)).unwrap();
        let mut alone = Simulation::new(session.scene()).unwrap();
        let is_found = *alone.solve() == Status::Converged;
        for frame in 0.. {
            if !(session.advance(f64::from(frame)) || session.follow_edit()) {
                break;
            }
        }
        assert_eq!(*session.simulation().status() == Status::Converged, is_found, "{force} N");
    }
}

/// A large body without an equilibrium is not certified again and again.
#[test]
fn a_large_body_without_an_equilibrium_comes_to_rest() {
    let mut scene = large(3).with_method(MethodKind::Warped);
    scene.set_force(0, [0.0, -1e6]).unwrap();
    let mut session = session(scene);
    session.iterate_to_end();
    assert!(is_lost(session.simulation()), "{:?}", session.simulation().status());
    let begun = Instant::now();
    session.request_facts(false, false, false);
    while session.facts.certifying.is_some() {
        assert!(begun.elapsed().as_secs() < 60, "it is certified without end");
        session.request_facts(false, false, false);
        std::thread::yield_now();
    }
}

/// The eigenvalues of a large body are computed in the background, and are those of the body itself.
#[test]
fn a_large_result_is_certified_in_the_background() {
    let scene = large(3).with_method(MethodKind::Newton);
    let mut session = session(scene.clone());
    session.iterate_to_end();
    let certificate = |session: &Session| session.simulation().equilibrium().unwrap().certificate();
    assert!(session.request_facts(false, false, false) && session.facts.certifying.is_some());
    assert_eq!(certificate(&session), None, "it is not computed between two frames");
    while session.facts.certifying.is_some() {
        session.request_facts(false, false, false);
        std::thread::yield_now();
    }
    let mut own = Simulation::new(&scene).unwrap();
    own.solve();
    assert_eq!(certificate(&session), Some(own.certify()));
    assert!(session.model.quality.stress.mesh_error_percent.is_some());
    // An edit in the meantime keeps its own result.
    session.apply(with_force(&session, -1100.0)).unwrap();
    session.iterate_to_end();
    session.request_facts(false, false, false);
    session.apply(with_force(&session, -1200.0)).unwrap();
    while session.iterates() || session.facts.certifying.is_some() {
        session.iterate();
        session.request_facts(false, false, false);
    }
    own.edit(|scene| scene.set_force(0, [0.0, -1200.0])).unwrap();
    own.solve();
    assert!((tip(&session) - own.probe("tip").unwrap().y).abs() < 1e-6);
    assert_eq!(certificate(&session).unwrap().stable, Some(true));
}

/// A mesh of thousands of unknowns is made in the background, and iterates between frames once it is there.
#[test]
fn a_large_mesh_is_made_in_the_background() {
    let mut session = solved(cantilever(-1000.0));
    let (before, finer) = (session.simulation().system().dofs(), large(5));
    session.apply(Edit::Scene("Cells", Box::new(finer.clone()))).unwrap();
    assert!(session.is_working(), "the mesh is not made between two frames");
    assert_eq!((session.simulation().system().dofs(), session.work().is_none()), (before, true));
    wait(&mut session);
    assert_eq!(session.simulation().scene(), &finer);
    assert!(!session.is_in_background() && session.simulation().iterations() == 0 && session.linear().is_some());
    assert!(session.advance(0.0) && session.simulation().iterations() >= 1);
    // Its loads are edited between frames.
    session.apply(with_force(&session, -900.0)).unwrap();
    assert!(!session.is_working());
    session.apply(Edit::Undo).unwrap();
    session.apply(Edit::Undo).unwrap();
    assert_eq!(session.simulation().system().dofs(), before);
}

/// A displayed frame ends in time, however many iterations are asked for.
#[test]
fn a_frame_makes_as_many_iterations_as_it_has_time_for() {
    let mut session = session(large(12));
    assert!(session.advance(0.0));
    let made = session.simulation().iterations();
    assert!((1..100).contains(&made) && session.iterates(), "{made} iterations");
}

/// The file of a scene finds its mesh, however often and wherever it is saved.
#[test]
fn a_saved_scene_has_its_mesh() {
    let [first, second] = [(); 2].map(|()| tempfile::tempdir().unwrap());
    let open_file = |path: &Path| open(source(path));
    let mut session = open(source("bracket"));
    let path = first.path().join("mine.toml");
    session.save(&path).unwrap();
    assert!(!session.is_edited(), "saving is no edit");
    let name = |path: &Path| open_file(path).scene().mesh.as_ref().unwrap().file.clone();
    assert_eq!(name(&path), "bracket.msh");
    // Saved in another folder, and there once more after an edit.
    let mut session = open_file(&path);
    let elsewhere = second.path().join("copy.toml");
    for young in [2e6, 3e6] {
        let mut edited = session.scene().clone();
        edited.material.young = young;
        session.set_scene(edited).unwrap();
        session.save(&elsewhere).unwrap();
        assert!(!session.is_edited());
        assert_eq!(open_file(&elsewhere).scene().material.young, young);
        assert_eq!(Path::new(&name(&elsewhere)), first.path().join(".").join("bracket.msh"));
    }
    // Another file with the name of the built-in mesh is left alone.
    std::fs::write(second.path().join("bracket.msh"), "mine").unwrap();
    let mut session = open(source("bracket"));
    session.save(&second.path().join("third.toml")).unwrap();
    assert_eq!(std::fs::read_to_string(second.path().join("bracket.msh")).unwrap(), "mine");
    assert_eq!(name(&second.path().join("third.toml")), "../meshes/bracket.msh");
}
