//! Rotation, assembly, factorization, solve and the whole frame, at four sizes of the same cantilever.
//!
//! `cargo bench` reports medians of this machine; compare them with each other, not with another machine's.
#![allow(clippy::unwrap_used, missing_docs, reason = "a benchmark may fail")]

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use nalgebra::{Matrix2, Vector2};
use warpbeam::assembly::System;
use warpbeam::method::{METHODS, Workspace};
use warpbeam::rotation::{Rotation, polar};
use warpbeam::scene::{Scene, Source, open, registry};
use warpbeam::simulation::Simulation;

fn scene(id: &str, set: &[String]) -> Scene {
    open(&Source { name: id.to_owned(), assignments: set.to_vec() }).unwrap()
}

/// A cantilever of about 120, 1 440, 5 440 and 20 000 unknowns.
fn sizes() -> Vec<Scene> {
    [[20, 2], [80, 8], [160, 16], [320, 30]]
        .map(|[nx, ny]| scene("cantilever", &[format!("beam.cells=[{nx},{ny}]")]))
        .to_vec()
}

fn stages(c: &mut Criterion) {
    for scene in sizes() {
        let system = System::new(&scene).unwrap();
        let dofs = system.dofs();
        // A state with all rotations different.
        let u: Vec<Vector2<f64>> =
            system.mesh.nodes.iter().map(|x| Rotation::from_angle(-0.05 * x.x).apply(*x) - x).collect();
        let mut r = vec![Rotation::IDENTITY; system.elements.point_count()];
        system.elements.rotations(&u, &mut r);
        let mut workspace = Workspace::new(&system).unwrap();
        let (mut force, mut magnitude) = (u.clone(), u.clone());

        c.bench_with_input(BenchmarkId::new("rotate", dofs), &u, |b, u| {
            b.iter(|| system.elements.rotations(black_box(u), &mut r))
        });
        c.bench_with_input(BenchmarkId::new("assemble", dofs), &u, |b, u| {
            b.iter(|| {
                system.stiffness(&r, &mut workspace.values);
                system.internal_force(black_box(u), &r, &mut force, &mut magnitude);
            });
        });
        system.stiffness(&r, &mut workspace.values);
        c.bench_function(&format!("factorize/{dofs}"), |b| {
            b.iter(|| workspace.factor.factorize(black_box(&workspace.values)).unwrap());
        });
        c.bench_function(&format!("solve/{dofs}"), |b| {
            b.iter(|| {
                workspace.free.fill(1.0);
                workspace.factor.solve_in_place(black_box(&mut workspace.free));
            });
        });
    }
}

/// One frame of every method, from rest.
fn frames(c: &mut Criterion) {
    for entry in METHODS {
        for mut scene in sizes() {
            scene.solver.method = entry.kind;
            let mut simulation = Simulation::new(&scene).unwrap();
            let id = format!("frame/{}/{}", entry.kind.id(), simulation.system().dofs());
            c.bench_function(&id, |b| {
                b.iter(|| {
                    simulation.reset();
                    simulation.step();
                });
            });
        }
    }
}

/// Every built-in scene, from rest to the end.
fn scenes(c: &mut Criterion) {
    for built_in in registry::BUILT_IN {
        let mut simulation = Simulation::new(&scene(built_in.id, &[])).unwrap();
        c.bench_function(&format!("scene/{}", built_in.id), |b| {
            b.iter(|| {
                simulation.reset();
                simulation.solve();
            });
        });
    }
}

fn rotation(c: &mut Criterion) {
    let f = Matrix2::new(0.55, -1.02, 0.875, 0.5);
    c.bench_function("polar", |b| b.iter(|| polar(black_box(&f))));
}

criterion_group!(benches, rotation, stages, frames, scenes);
criterion_main!(benches);
