//! Stress singularities of linear elasticity, where a finer mesh only gives a larger stress.

use nalgebra::Vector2;

use crate::assembly::{NodalSupport, Problem};
use crate::mesh::{Mesh, Segment};
use crate::scene::{Load, Material, Place, Plane};
use crate::sentence::{Sentence, displayed, sentence};

/// Cause of an unbounded stress.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Singularity {
    /// Force on a single node.
    PointForce,
    /// Support of a single node.
    PointSupport,
    /// End of a supported edge.
    SupportEnd,
    /// Re-entrant corner.
    ReentrantCorner,
}

displayed!(Singularity);

impl From<&Singularity> for Sentence {
    fn from(singularity: &Singularity) -> Self {
        let place = match singularity {
            Singularity::PointForce => sentence!("at a point force"),
            Singularity::PointSupport => sentence!("at a point support"),
            Singularity::SupportEnd => sentence!("at the end of a support"),
            Singularity::ReentrantCorner => sentence!("at a re-entrant corner"),
        };
        sentence!("the largest stress is %{place}, where it grows without limit as the mesh is refined", place = place)
    }
}

/// Smallest excess of a corner's angle over 180°, rad, that counts as a corner; smaller ones occur on curved outlines
/// made of straight sides.
const CORNER: f64 = 0.6;

impl Singularity {
    /// Returns the cause of an unbounded stress at a node or, at the end of a support or a re-entrant corner, at the others
    /// of its elements, to which the largest recovered stress of a coarse mesh may belong; `None` if the stress is bounded.
    pub fn near(problem: &Problem, node: u32) -> Option<Self> {
        let own = problem.system().mesh().elements().filter(|element| element.contains(&node));
        // Across the height from a point support or force the stress of bending may be the largest.
        let is_of_body = |cause: &Self| matches!(cause, Self::SupportEnd | Self::ReentrantCorner);
        let beside = || own.flatten().find_map(|&node| Self::at(problem, node).filter(is_of_body));
        Self::at(problem, node).or_else(beside)
    }

    /// Returns the cause of an unbounded stress at a node; `None` if the stress is bounded.
    pub fn at(problem: &Problem, node: u32) -> Option<Self> {
        let mesh = problem.system().mesh();
        let is_there = |place: &Place| matches!(place, Place::At(at) if mesh.nearest_node((*at).into()) == node);
        let is_among = |weights: &[(u32, f64)]| weights.iter().any(|(own, weight)| *own == node && weight.abs() > 1e-9);
        let holds = |support: &NodalSupport| match support.point {
            Some(_) => support.width == 0.0 && is_among(&support.weights),
            None => is_there(&support.place),
        };
        if problem.supports().all().iter().any(holds) {
            return Some(Self::PointSupport);
        }
        let acts = |load: &Load| match load {
            Load::Force { force: [0.0, 0.0], .. } => false,
            Load::Force { at_point: true, width, .. } if *width > 0.0 => false,
            Load::Force { place: Place::At(at), at_point: true, .. } => {
                mesh.weights_at((*at).into()).is_some_and(|weights| is_among(&weights))
            }
            Load::Force { place, .. } => is_there(place),
            _ => false,
        };
        if problem.scene_loads.iter().any(acts) {
            return Some(Self::PointForce);
        }
        let outline = mesh.outline();
        let own = outline.iter().filter(|side| side.ends().contains(&node));
        let [a, b] = own.map(|side| fixed_directions(problem, side)).collect::<Vec<_>>()[..] else { return None };
        let angle = interior_angle(mesh, node);
        let straight = std::f64::consts::PI;
        match (a, b) {
            (2, 0) | (0, 2) => is_singular_clamp(angle, problem.material()).then_some(Self::SupportEnd),
            // A roller is a symmetry condition: the mirror image continues the body.
            (1, 0) | (0, 1) => (2.0 * angle > straight + CORNER).then_some(Self::SupportEnd),
            _ => (angle > straight + CORNER).then_some(Self::ReentrantCorner),
        }
    }
}

/// Returns the number of directions in which supports fix a side of the outline.
fn fixed_directions(problem: &Problem, side: &Segment) -> usize {
    let is_fixed = |axis: &usize| {
        side.nodes().iter().all(|node| {
            let mut held = problem.supports().all().iter().flat_map(|s| &s.nodes);
            held.any(|(held, axes)| held == node && axes[*axis])
        })
    };
    [0, 1].iter().filter(|axis| is_fixed(axis)).count()
}

/// Returns the angle of the body at a node, rad; π at a node between corners of an element.
fn interior_angle(mesh: &Mesh, node: u32) -> f64 {
    let entry = mesh.element().entry();
    let corners = entry.cell.corners;
    let mut angle = 0.0;
    for own in mesh.elements() {
        let Some(corner) = own.iter().take(corners.len()).position(|&n| n == node) else { continue };
        let rest: Vec<Vector2<f64>> = own.iter().map(|&n| mesh.node(n)).collect();
        let jacobian = entry.jacobian(&rest, corners[corner]);
        let towards = |other: usize| {
            let [to, from] = [other % corners.len(), corner].map(|c| Vector2::from(corners[c]));
            jacobian * (to - from)
        };
        let (next, previous) = (towards(corner + 1), towards(corner + corners.len() - 1));
        angle += next.perp(&previous).atan2(next.dot(&previous));
    }
    if angle == 0.0 { std::f64::consts::PI } else { angle }
}

/// Returns `true` if stresses at a corner of this angle between a clamped and a free side are unbounded: if sin²(λω) =
/// ((κ + 1)² − 4 λ² sin² ω) / 4κ has a root with a real part below 1 (Williams 1952, *Stress singularities resulting
/// from various boundary conditions in angular corners of plates in extension*). Displacements are proportional to the
/// distance to the power λ. For angles above 90° there is always such a root, real or complex.
fn is_singular_clamp(angle: f64, material: &Material) -> bool {
    const STEPS: u32 = 200;
    /// 90° plus a tolerance for rounding errors, rad.
    const OBTUSE: f64 = 1.6;
    if angle > OBTUSE {
        return true;
    }
    let nu = material.poisson;
    let kappa = match material.plane {
        Plane::Stress => (3.0 - nu) / (1.0 + nu),
        Plane::Strain => 3.0 - 4.0 * nu,
    };
    let gap = |lambda: f64| {
        let (turned, own) = ((lambda * angle).sin(), lambda * angle.sin());
        turned * turned - ((kappa + 1.0).powi(2) - 4.0 * own * own) / (4.0 * kappa)
    };
    // The gap is negative at λ = 0, so a positive value means that there is a root.
    (1..STEPS).any(|i| gap(f64::from(i) / f64::from(STEPS)) > 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{FRAC_PI_2, PI};

    #[test]
    fn clamps_are_singular_as_williams_found() {
        let material = |poisson, plane| Material { plane, ..Material::new(1.0, poisson) };
        for (angle, poisson, plane, singular) in [
            (FRAC_PI_2, 0.0, Plane::Stress, false),
            (FRAC_PI_2, 0.3, Plane::Stress, true),
            (FRAC_PI_2, 0.0, Plane::Strain, false),
            (FRAC_PI_2, 0.45, Plane::Strain, true),
            (PI, 0.0, Plane::Stress, true),
            (0.5 * FRAC_PI_2, 0.3, Plane::Stress, false),
        ] {
            assert_eq!(is_singular_clamp(angle, &material(poisson, plane)), singular, "{angle} {poisson} {plane:?}");
        }
    }
}
