//! Tests of the natural frequencies against beam theory.

use nalgebra::Matrix4;

use super::lowest_frequency;
use crate::assembly::Mass;
use crate::scene::{IntegratorKind, Scene};
use crate::simulation::Simulation;

/// Returns the lowest angular frequency of a clamped beam of length 1 m without loads, rad/s, from its bending stiffness
/// EI (N m²), shear compliance 1/GA (1/N), mass per length (kg/m) and rotary inertia per length (kg m): Timoshenko beam;
/// without shear compliance and rotary inertia, Euler–Bernoulli beam.
///
/// With amplitudes w, θ, M, V over the length: w′ = θ + V/GA, θ′ = M/EI, M′ = −V − ω² J θ, V′ = −ω² m w; w and θ
/// vanish at the clamp, M and V at the tip.
fn frequency_in_theory(bending: f64, shear_compliance: f64, mass: f64, rotary_inertia: f64) -> f64 {
    let (shear, rotary) = (bending * shear_compliance, rotary_inertia / mass);
    // In units of EI, β⁴ = ω² m/EI.
    let at_tip = |beta: f64| {
        let mu = beta.powi(4);
        #[rustfmt::skip]
        let slope = Matrix4::new(
            0.0, 1.0, 0.0, shear,
            0.0, 0.0, 1.0, 0.0,
            0.0, -mu * rotary, 0.0, -1.0,
            -mu, 0.0, 0.0, 0.0,
        );
        slope.exp().fixed_view::<2, 2>(2, 2).determinant()
    };
    /// Upper bound of β, between the first two roots of the slender beam, 1.875 and 4.694.
    const MAX_BETA: f64 = 4.0;
    const SCAN: f64 = 0.05;
    let (mut low, mut high) = (SCAN, 2.0 * SCAN);
    while at_tip(high) > 0.0 {
        (low, high) = (high, high + SCAN);
        assert!(high <= MAX_BETA, "no frequency below β = {MAX_BETA}");
    }
    while high - low > 1e-14 * high {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            break;
        }
        if at_tip(middle) > 0.0 { low = middle } else { high = middle }
    }
    low * low * (bending / mass).sqrt()
}

#[test]
fn first_frequencies_are_beam_theorys() {
    let measured = |slenderness: f64, cells: u32| {
        let scene = Scene::beam(1.0, 1.0 / slenderness).with_cells(cells, 1).clamp("left").probe("tip", "right");
        let scene = scene.moving(IntegratorKind::TrBdf2, 1e-3);
        let simulation = Simulation::new(&scene).unwrap();
        let mass = Mass::new(simulation.system(), scene.material.area_density());
        lowest_frequency(simulation.problem(), &mass).unwrap()
    };
    let theory = |slenderness: f64, shear: bool| {
        let (height, young, poisson, density) = (1.0 / slenderness, 1e6, 0.3, 1000.0);
        let inertia = f64::powi(height, 3) / 12.0;
        let shear_area = 5.0 / 6.0 * young / (2.0 * (1.0 + poisson)) * height;
        let [compliance, rotary] = if shear { [1.0 / shear_area, density * inertia] } else { [0.0; 2] };
        frequency_in_theory(young * inertia, compliance, density * height, rotary)
    };
    // Euler–Bernoulli theory in closed form.
    let closed = 1.875_104_068_711_961_f64.powi(2) * (1e6_f64 / 12.0 / 1000.0).sqrt() / 50.0;
    assert!((theory(50.0, false) / closed - 1.0).abs() < 1e-9);
    for (slenderness, cells, shear) in [(50.0, 40, false), (100.0, 80, false), (10.0, 20, true)] {
        let (measured, theory) = (measured(slenderness, cells), theory(slenderness, shear));
        assert!((measured / theory - 1.0).abs() < 0.005, "L/H = {slenderness}: {measured} {theory}");
    }
    // Shear and rotary inertia matter at L/H = 10.
    assert!(theory(10.0, true) < 0.995 * theory(10.0, false));
}
