//! The order of elimination of a mesh: the one of three that takes the fewest operations, in large systems.

use nalgebra::Vector2;

use super::Pattern;
use super::dissection::{LONGEST_CUT, dissect, length_in_widths, rim_first};
use crate::mesh::Mesh;
use crate::solver::{Graph, SolverError, Symbolic};

/// From so many free unknowns on three orders are compared; smaller systems take minimum degree. On square plates a
/// factorization takes 0.56 of the time so (three-node triangles, 245 000 unknowns; six-node ones, 106 000), with
/// quadrilaterals and on irregular meshes about the same; comparing takes about as long as one iteration.
const LEAST_UNKNOWNS: usize = 10_000;
/// Bodies longer than so many widths take minimum degree too.
const LONGEST: f64 = 10.0;

/// An order is taken in place of another where it costs less than this part of its operations: it may well have more
/// entries, and small differences are not seen in the times.
const CLEARLY_FEWER: f64 = 0.85;

/// Makes an order of the vertices of a graph at these positions.
type Order = fn(&Graph, &[Vector2<f64>]) -> Result<Vec<usize>, SolverError>;

/// Orders and analyses a pattern of a mesh.
pub(super) fn analyse(mesh: &Mesh, pattern: &Pattern) -> Result<Symbolic, SolverError> {
    let (starts, rows) = (pattern.column_starts(), pattern.row_indices());
    if pattern.dofs() < LEAST_UNKNOWNS {
        return Symbolic::new(starts, rows);
    }
    let nodes = FreeNodes::new(pattern);
    let positions: Vec<Vector2<f64>> = nodes.numbers.iter().map(|&node| mesh.node(node)).collect();
    let order = fewest_operations(&nodes.graph(pattern), &positions)?;
    Symbolic::in_order(starts, rows, &nodes.unknowns(&order))
}

/// Minimum degree as the mesh is numbered, from the rim inwards, or nested dissection.
fn fewest_operations(graph: &Graph, positions: &[Vector2<f64>]) -> Result<Vec<usize>, SolverError> {
    let mut best = graph.minimum_degree()?;
    if best.is_empty() {
        return Ok(best);
    }
    let others: &[Order] = match length_in_widths(graph, positions) {
        length if length <= LONGEST_CUT => &[rim_first, dissect],
        length if length <= LONGEST => &[rim_first],
        _ => return Ok(best),
    };
    let mut fewest = graph.operations(&best)?;
    for other in others {
        let order = other(graph, positions)?;
        let operations = graph.operations(&order)?;
        if operations < CLEARLY_FEWER * fewest {
            (best, fewest) = (order, operations);
        }
    }
    Ok(best)
}

/// The nodes that have free unknowns, which stay together.
struct FreeNodes {
    /// Their numbers in the mesh.
    numbers: Vec<u32>,
    /// The first unknown of each, and the end of the last.
    first: Vec<usize>,
    /// The node, by its place here, of every free unknown.
    of: Vec<usize>,
}

impl FreeNodes {
    fn new(pattern: &Pattern) -> Self {
        let (mut numbers, mut first, mut of) = (Vec::new(), Vec::new(), Vec::with_capacity(pattern.dofs()));
        for (free, &unknown) in pattern.free().iter().enumerate() {
            let node = unknown / 2;
            if numbers.last() != Some(&node) {
                numbers.push(node);
                first.push(free);
            }
            of.push(numbers.len() - 1);
        }
        first.push(pattern.dofs());
        Self { numbers, first, of }
    }

    /// Which of them are coupled.
    fn graph(&self, pattern: &Pattern) -> Graph {
        let mut neighbours: Vec<Vec<usize>> = vec![Vec::new(); self.numbers.len()];
        for (node, &first) in self.first[..self.numbers.len()].iter().enumerate() {
            let [start, end] = [first, first + 1].map(|column| pattern.column_starts()[column]);
            // A column has the rows from its own on, node by node: the lists come out sorted.
            let mut last = node;
            for other in pattern.row_indices()[start..end].iter().map(|&row| self.of[row]) {
                if other != last {
                    neighbours[node].push(other);
                    neighbours[other].push(node);
                    last = other;
                }
            }
        }
        let mut starts = vec![0];
        starts.extend(neighbours.iter().scan(0, |end, list| {
            *end += list.len();
            Some(*end)
        }));
        Graph::new(starts, neighbours.concat())
    }

    /// Their unknowns, in an order of the nodes.
    fn unknowns(&self, order: &[usize]) -> Vec<usize> {
        order.iter().flat_map(|&node| self.first[node]..self.first[node + 1]).collect()
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test may fail")]

    use super::*;
    use crate::assembly::{Forces, Kinematics, Matrix, Problem, System};
    use crate::element::{ELEMENTS, Tangent};
    use crate::scene::{ElementKind, Scene};
    use crate::solver::Factor;

    fn plate(element: ElementKind, cells: [u32; 2]) -> Scene {
        let mut scene = Scene::beam(f64::from(cells[0]), f64::from(cells[1])).clamp("left").force("right", [0.0, -1.0]);
        let beam = scene.beam.as_mut().unwrap();
        (beam.element, beam.cells) = (element, cells);
        scene
    }

    fn graph(scene: &Scene) -> (Graph, Vec<Vector2<f64>>) {
        let system = System::new(scene).unwrap();
        let nodes = FreeNodes::new(system.pattern());
        let positions = nodes.numbers.iter().map(|&node| system.mesh().node(node)).collect();
        (nodes.graph(system.pattern()), positions)
    }

    fn is_permutation(mut order: Vec<usize>, n: usize) -> bool {
        order.sort_unstable();
        order.into_iter().eq(0..n)
    }

    /// The lists of all that are coupled, from pairs.
    fn coupled(n: usize, pairs: impl Iterator<Item = [usize; 2]>) -> Graph {
        let mut lists = vec![Vec::new(); n];
        for [a, b] in pairs {
            lists[a].push(b);
            lists[b].push(a);
        }
        let mut starts = vec![0];
        for list in &mut lists {
            list.sort_unstable();
            starts.push(starts[starts.len() - 1] + list.len());
        }
        Graph::new(starts, lists.concat())
    }

    #[test]
    fn every_order_has_every_vertex_once() {
        for entry in ELEMENTS {
            for cells in [[40, 40], [300, 6], [70, 30]] {
                let (graph, positions) = graph(&plate(entry.kind, cells));
                for order in [rim_first, dissect, fewest_operations] {
                    let order = order(&graph, &positions).unwrap();
                    assert!(is_permutation(order, graph.size()), "{} {cells:?}", entry.id);
                }
            }
        }
    }

    /// Positions that tell nothing apart, or less than they should, and graphs of no mesh.
    #[test]
    fn degenerate_bodies_are_ordered_too() {
        let n = 5000;
        let chain = || coupled(n, (1..n).map(|i| [i - 1, i]));
        let star = || coupled(n, (1..n).map(|i| [0, i]));
        let loose = || coupled(n, std::iter::empty());
        let two = || coupled(n, (2..n).map(|i| [i - 2, i]));
        let graphs = [chain(), star(), loose(), two(), coupled(1, std::iter::empty()), coupled(0, std::iter::empty())];
        let places: [fn(usize) -> Vector2<f64>; 5] = [
            |_| Vector2::new(3.0, -1.0),
            |i| Vector2::new(i as f64, 0.0),
            |i| Vector2::new(0.0, -(i as f64)),
            |i| Vector2::new(f64::from(u8::from(i == 7)), 1e300 * i as f64),
            |i| Vector2::new(f64::MAX * (-1.0_f64).powi(i as i32), f64::NAN),
        ];
        for (which, graph) in graphs.iter().enumerate() {
            for (place, at) in places.iter().enumerate() {
                let positions: Vec<_> = (0..graph.size()).map(at).collect();
                for order in [rim_first, dissect, fewest_operations] {
                    let order = order(graph, &positions).unwrap();
                    assert!(is_permutation(order, graph.size()), "graph {which}, positions {place}");
                }
            }
        }
    }

    /// Dissection costs six-node triangles and quadrilaterals less than minimum degree does, the rim three-node
    /// triangles; what is taken never costs more, and long beams are swept along.
    #[test]
    fn plates_take_fewer_operations() {
        let compare = |element, cells, order: Order| {
            let (graph, positions) = graph(&plate(element, cells));
            let plain = graph.operations(&graph.minimum_degree().unwrap()).unwrap();
            let operations = |order: Order| graph.operations(&order(&graph, &positions).unwrap()).unwrap() / plain;
            let taken = operations(fewest_operations);
            assert!(taken <= 1.0 && CLEARLY_FEWER * taken <= operations(order), "{element:?} {cells:?}: {taken}");
            operations(order)
        };
        for (element, cells, order, most) in [
            (ElementKind::T3, [100, 100], rim_first as Order, 0.75),
            (ElementKind::T6, [70, 70], dissect, 0.7),
            (ElementKind::Q4, [140, 140], dissect, 1.05),
        ] {
            let ratio = compare(element, cells, order);
            assert!(ratio < most, "{element:?} {cells:?}: {ratio}");
        }
        let beam = graph(&plate(ElementKind::T3, [600, 8]));
        assert_eq!(fewest_operations(&beam.0, &beam.1).unwrap(), beam.0.minimum_degree().unwrap());
        assert!((length_in_widths(&beam.0, &beam.1) / (600.0 / 9.0) - 1.0).abs() < 0.01);
    }

    #[test]
    fn solutions_are_those_of_minimum_degree() {
        for entry in ELEMENTS {
            let scene = plate(entry.kind, if entry.sides[0].len() == 3 { [40, 40] } else { [80, 80] });
            let problem = Problem::new(&scene, System::new(&scene).unwrap().into()).unwrap();
            let system = problem.system();
            let pattern = system.pattern();
            assert!(pattern.dofs() >= LEAST_UNKNOWNS);
            let still = vec![Vector2::zeros(); system.mesh().nodes().len()];
            let mut state = system.state_of(&still).unwrap();
            system.follow(&mut state, Kinematics::Linear);
            let (mut forces, mut matrix) = (Forces::new(still.len()), Matrix::new(pattern));
            problem.linearize(&state, &mut forces, Some((Tangent::WARPED, &mut matrix)));
            let plain = Symbolic::new(pattern.column_starts(), pattern.row_indices()).unwrap();
            let [u, expected] = [system.symbolic(), &plain].map(|symbolic| {
                let mut factor = Factor::new(symbolic).unwrap();
                factor.factorize(matrix.values()).unwrap();
                let mut u = vec![1.0; pattern.dofs()];
                factor.solve_in_place(&mut u);
                u
            });
            let largest = expected.iter().fold(0.0, |most: f64, u| most.max(u.abs()));
            for (u, expected) in u.iter().zip(&expected) {
                assert!((u - expected).abs() < 1e-9 * largest, "{}: {u} {expected}", entry.id);
            }
            assert_ne!(u, expected, "{}: one order, not two", entry.id);
        }
    }
}
