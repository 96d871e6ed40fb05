//! Orders of elimination that know where the nodes are: nested dissection, and minimum degree from the rim inwards.
//!
//! A. George, *Nested dissection of a regular finite element mesh*, SIAM J. Numer. Anal. 1973. What is left between the
//! separators is ordered by minimum degree, with the separators around it in sight: F. Pellegrini, J. Roman, P. Amestoy,
//! *Hybridizing nested dissection and halo approximate minimum degree for efficient sparse matrix ordering*, 2000.

use nalgebra::Vector2;

use crate::solver::{Graph, SolverError};

/// Regions of so many vertices are not cut further.
const LEAF: usize = 1000;
/// Nor are those longer than so many widths, which minimum degree sweeps along: cutting them costs up to twice the
/// operations.
pub(super) const LONGEST_CUT: f64 = 3.0;
/// The separators around a leaf are coupled, each with each, where that makes no more than so many times the leaf's
/// entries; others are left out of sight. It bounds the memory on meshes with nodes that very many elements share.
const LARGEST_HALO: usize = 16;

/// Every vertex of a graph once, in the order of elimination: from the halves of halves to the first separator.
pub(super) fn dissect(graph: &Graph, positions: &[Vector2<f64>]) -> Result<Vec<usize>, SolverError> {
    let mut dissection = Dissection::new(graph, positions);
    dissection.region((0..graph.size()).collect())?;
    Ok(dissection.order)
}

/// The order of minimum degree that takes, of vertices of one degree, those on the rim first: on regular meshes, whose
/// vertices have the same degrees over long stretches, it then goes round and round.
pub(super) fn rim_first(graph: &Graph, positions: &[Vector2<f64>]) -> Result<Vec<usize>, SolverError> {
    let mut whole = Dissection::new(graph, positions);
    whole.leaf((0..graph.size()).collect())?;
    Ok(whole.order)
}

/// About how many times its width a body is long.
pub(super) fn length_in_widths(graph: &Graph, positions: &[Vector2<f64>]) -> f64 {
    Dissection::new(graph, positions).best_cut(&mut (0..graph.size()).collect::<Vec<_>>()).length_in_widths()
}

struct Dissection<'a> {
    graph: &'a Graph,
    positions: &'a [Vector2<f64>],
    /// The set that a vertex was put into last, and how many sets there have been.
    set: Vec<usize>,
    sets: usize,
    /// The place of a vertex in the leaf that it was in last.
    place: Vec<usize>,
    order: Vec<usize>,
}

/// A region in two halves that are not coupled, and what couples them.
struct Cut {
    halves: [Vec<usize>; 2],
    separator: Vec<usize>,
}

impl Cut {
    /// About how many times its width the region is long; 0 where nothing couples the halves.
    fn length_in_widths(&self) -> f64 {
        let width = self.separator.len() as f64;
        let vertices = (self.halves[0].len() + self.halves[1].len() + self.separator.len()) as f64;
        if width > 0.0 { vertices / (width * width) } else { 0.0 }
    }
}

impl<'a> Dissection<'a> {
    fn new(graph: &'a Graph, positions: &'a [Vector2<f64>]) -> Self {
        let n = graph.size();
        Self { graph, positions, set: vec![0; n], sets: 0, place: vec![0; n], order: Vec::with_capacity(n) }
    }

    fn region(&mut self, mut region: Vec<usize>) -> Result<(), SolverError> {
        if region.len() <= LEAF {
            return self.leaf(region);
        }
        let mut cut = self.best_cut(&mut region);
        if cut.length_in_widths() > LONGEST_CUT {
            return self.leaf(region);
        }
        drop(region);
        for half in cut.halves {
            self.region(half)?;
        }
        cut.separator.sort_unstable();
        self.order.extend(cut.separator);
        Ok(())
    }

    /// Cuts across or along, by the smaller separator.
    fn best_cut(&mut self, region: &mut [usize]) -> Cut {
        let [first, second] = [0, 1].map(|axis| self.cut(region, axis));
        if second.separator.len() < first.separator.len() { second } else { first }
    }

    /// Cuts at the median of one coordinate. The separator is of the nodes of one half that are coupled with the other:
    /// of whichever half has fewer of them.
    fn cut(&mut self, region: &mut [usize], axis: usize) -> Cut {
        let n = region.len();
        let at = |vertex: usize| self.positions[vertex][axis];
        let ascending = |&a: &usize, &b: &usize| at(a).total_cmp(&at(b)).then(a.cmp(&b));
        let (below, &mut median, _) = region.select_nth_unstable_by(n / 2, ascending);
        // A line of nodes goes to one half as a whole, where that leaves the other a third.
        let is_below = |&&vertex: &&usize| at(vertex) < at(median);
        let halves: [Vec<usize>; 2] = if 3 * below.iter().filter(is_below).count() >= n {
            let (low, high) = region.iter().partition(is_below);
            [low, high]
        } else {
            let (low, high) = region.split_at(n / 2);
            [low, high].map(<[usize]>::to_vec)
        };
        let [low, high] = [0, 1].map(|half| self.mark(&halves[half]));
        let border = |half: &[usize], other: usize| -> Vec<usize> {
            let is_coupled = |&&vertex: &&usize| self.graph.neighbours(vertex).iter().any(|&n| self.set[n] == other);
            half.iter().filter(is_coupled).copied().collect()
        };
        let [of_low, of_high] = [border(&halves[0], high), border(&halves[1], low)];
        let separator = if of_high.len() < of_low.len() { of_high } else { of_low };
        let separating = self.mark(&separator);
        let halves = halves.map(|mut half| {
            half.retain(|&vertex| self.set[vertex] != separating);
            half
        });
        Cut { halves, separator }
    }

    /// Puts vertices into a new set, and returns its number.
    fn mark(&mut self, vertices: &[usize]) -> usize {
        self.sets += 1;
        for &vertex in vertices {
            self.set[vertex] = self.sets;
        }
        self.sets
    }

    /// Orders a region by minimum degree, its rim first. Whatever it is coupled with comes later.
    fn leaf(&mut self, mut region: Vec<usize>) -> Result<(), SolverError> {
        self.sort_rim_first(&mut region);
        let own = region.len();
        let mut entries = 0;
        for (place, &vertex) in region.iter().enumerate() {
            self.place[vertex] = place;
            entries += self.graph.neighbours(vertex).len();
        }
        // The vertices around it follow its own.
        let mut all = region;
        for i in 0..own {
            for &neighbour in self.graph.neighbours(all[i]) {
                if all.get(self.place[neighbour]) != Some(&neighbour) {
                    self.place[neighbour] = all.len();
                    all.push(neighbour);
                }
            }
        }
        if (all.len() - own).pow(2) > LARGEST_HALO * entries {
            all.truncate(own);
        }
        let (mut starts, mut neighbours) = (vec![0], Vec::with_capacity(entries));
        for (place, &vertex) in all.iter().enumerate() {
            let start = neighbours.len();
            let coupled = self.graph.neighbours(vertex).iter().filter(|&&n| all.get(self.place[n]) == Some(&n));
            let coupled = coupled.map(|&n| self.place[n]);
            if place < own {
                neighbours.extend(coupled);
            } else {
                neighbours.extend(coupled.filter(|&n| n < own));
                neighbours.extend((own..all.len()).filter(|&n| n != place));
            }
            neighbours[start..].sort_unstable();
            starts.push(neighbours.len());
        }
        let order = Graph::new(starts, neighbours).minimum_degree()?;
        self.order.extend(order.into_iter().filter(|&place| place < own).map(|place| all[place]));
        Ok(())
    }

    /// Sorts vertices into rings, the outermost first, each as square as their bounds; in a ring, later numbers first.
    fn sort_rim_first(&self, vertices: &mut [usize]) {
        let mut bounds = [Vector2::repeat(f64::INFINITY), Vector2::repeat(f64::NEG_INFINITY)];
        for &vertex in &*vertices {
            bounds = [bounds[0].inf(&self.positions[vertex]), bounds[1].sup(&self.positions[vertex])];
        }
        let middle = 0.5 * (bounds[0] + bounds[1]);
        let scale = (bounds[1] - bounds[0]).map(|size| if size > 0.0 { 1.0 / size } else { 0.0 });
        // What only rounding tells apart is in one ring.
        let ring = |vertex: usize| ((self.positions[vertex] - middle).component_mul(&scale).amax() * 1e9).round();
        vertices.sort_unstable_by(|&a, &b| ring(b).total_cmp(&ring(a)).then(b.cmp(&a)));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A lattice, every node coupled with the eight around it.
    fn lattice([nx, ny]: [usize; 2]) -> (Graph, Vec<Vector2<f64>>) {
        let (mut starts, mut neighbours, mut positions) = (vec![0], Vec::new(), Vec::new());
        for i in 0..nx {
            for j in 0..ny {
                for k in i.saturating_sub(1)..(i + 2).min(nx) {
                    for l in j.saturating_sub(1)..(j + 2).min(ny) {
                        if [k, l] != [i, j] {
                            neighbours.push(k * ny + l);
                        }
                    }
                }
                starts.push(neighbours.len());
                positions.push(Vector2::new(i as f64, j as f64));
            }
        }
        (Graph::new(starts, neighbours), positions)
    }

    #[test]
    fn separators_separate() {
        let (graph, mut positions) = lattice([60, 41]);
        for stretch in [1.0, 100.0] {
            positions.iter_mut().for_each(|x| x.y *= stretch);
            let mut dissection = Dissection::new(&graph, &positions);
            let mut all: Vec<usize> = (0..graph.size()).collect();
            let cut = dissection.best_cut(&mut all);
            assert_eq!(cut.separator.len(), 41);
            let [low, high] = &cut.halves;
            assert_eq!(low.len() + high.len() + 41, graph.size());
            assert!(low.len().min(high.len()) > graph.size() / 3);
            assert!(
                low.iter().all(|&vertex| graph.neighbours(vertex).iter().all(|neighbour| !high.contains(neighbour)))
            );
        }
    }

    /// The last to be eliminated are the first separator, and before it come those of the halves.
    #[test]
    fn separators_come_last() {
        let (graph, positions) = lattice([60, 41]);
        let order = dissect(&graph, &positions).unwrap_or_default();
        let line = |vertices: &[usize], axis: usize| {
            vertices.iter().all(|&v| positions[v][axis] == positions[vertices[0]][axis])
        };
        let (rest, separator) = order.split_at(order.len() - 41);
        assert!(line(separator, 0));
        assert!(line(&rest[rest.len() - 30..], 1));
    }
}
