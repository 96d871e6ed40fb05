//! Solves a triangulated ring segment that no scene file describes: its mesh is made here.
//!
//! `cargo run --release --example own_mesh --no-default-features`

use std::collections::BTreeMap;
use std::error::Error;

use warpbeam::nalgebra::Vector2;
use warpbeam::{ElementKind, Mesh, Scene, Segment, Simulation, Status};

const ALONG: u32 = 24;
const ACROSS: u32 = 3;

fn main() -> Result<(), Box<dyn Error>> {
    let (elements, largest) = hook()?;
    println!("{elements} elements; largest von Mises stress {largest:.0} Pa");
    Ok(())
}

/// Pulls at the end of a half ring. Returns the number of elements, and the largest von Mises (Cauchy) stress, Pa.
pub fn hook() -> Result<(usize, f64), Box<dyn Error>> {
    let node = |i: u32, j: u32| i * (ACROSS + 1) + j;
    let mut nodes = Vec::new();
    for i in 0..=ALONG {
        let (sin, cos) = (std::f64::consts::PI * f64::from(i) / f64::from(ALONG)).sin_cos();
        nodes.extend((0..=ACROSS).map(|j| Vector2::new(cos, sin) * (0.8 + 0.1 * f64::from(j))));
    }
    let mut triangles = Vec::new();
    for (i, j) in (0..ALONG).flat_map(|i| (0..ACROSS).map(move |j| (i, j))) {
        let [a, b, c, d] = [node(i, j), node(i, j + 1), node(i + 1, j + 1), node(i + 1, j)];
        triangles.extend([a, b, c, a, c, d]);
    }
    let end = |i: u32| (0..ACROSS).filter_map(|j| Segment::new(&[node(i, j), node(i, j + 1)])).collect();
    let edges = BTreeMap::from([("root".to_owned(), end(0)), ("tip".to_owned(), end(ALONG))]);
    let mesh = Mesh::new(nodes, ElementKind::T3, triangles, edges)?;

    let scene = Scene::named("Hook").clamp("root").force("tip", [0.0, -50.0]);
    let mut hook = Simulation::with_mesh(&scene, mesh)?;
    if *hook.solve() != Status::Converged {
        return Err(format!("{:?}", hook.status()).into());
    }
    let (_, largest) = hook.nodal_stress().largest_von_mises().ok_or("the stress is not finite")?;
    Ok((hook.mesh().element_count(), largest))
}
