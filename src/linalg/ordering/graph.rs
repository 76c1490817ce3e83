//! Graphs of vertices with coordinates, and their parts.

use super::parts::index;
use super::parts::{LEFT, SEPARATOR};

/// Rounding of projections, as part of the largest coordinate.
const ROUNDING: f64 = 1e-14;

/// Neighbours of every vertex, ascending.
pub(super) struct Graph {
    ptr: Vec<usize>,
    adjacency: Vec<u32>,
}

impl Graph {
    pub(super) fn neighbours(&self, v: usize) -> &[u32] {
        &self.adjacency[self.ptr[v]..self.ptr[v + 1]]
    }

    /// The symmetric graph between groups of unknowns: `group` of each, and the unknowns of group g in `sorted[start[g]..start[g + 1]]`.
    pub(super) fn between(ptr: &[usize], cols: &[usize], group: &[u32], sorted: &[u32], start: &[u32]) -> Self {
        let groups = start.len() - 1;
        let mut seen = vec![u32::MAX; groups];
        let (mut first, mut to) = (vec![0usize], Vec::with_capacity(cols.len()));
        for g in 0..groups {
            let own = index(g);
            seen[g] = own;
            for &i in &sorted[start[g] as usize..start[g + 1] as usize] {
                for &j in &cols[ptr[i as usize]..ptr[i as usize + 1]] {
                    let h = group[j];
                    if seen[h as usize] != own {
                        seen[h as usize] = own;
                        to.push(h);
                    }
                }
            }
            first.push(to.len());
        }
        symmetric(&first, &to)
    }
}

/// Rows of the symmetric graph with the edges `to[first[a]..first[a + 1]]` of every a; ascending, no edge twice.
fn symmetric(first: &[usize], to: &[u32]) -> Graph {
    let n = first.len() - 1;
    let mut ptr = vec![0usize; n + 1];
    for a in 0..n {
        ptr[a + 1] += first[a + 1] - first[a];
        to[first[a]..first[a + 1]].iter().for_each(|&b| ptr[b as usize + 1] += 1);
    }
    for a in 0..n {
        ptr[a + 1] += ptr[a];
    }
    // both directions of every edge, then their transpose: visiting rows in ascending order sorts the columns
    let (mut place, mut both) = (ptr.clone(), vec![0u32; ptr[n]]);
    for a in 0..n {
        for &b in &to[first[a]..first[a + 1]] {
            for (from, to) in [(a, b as usize), (b as usize, a)] {
                both[place[from]] = to as u32;
                place[from] += 1;
            }
        }
    }
    place.copy_from_slice(&ptr);
    let mut adjacency = vec![0u32; ptr[n]];
    for a in 0..n {
        let own = a as u32;
        for &b in &both[ptr[a]..ptr[a + 1]] {
            let (begin, next) = (ptr[b as usize], place[b as usize]);
            if next == begin || adjacency[next - 1] != own {
                adjacency[next] = own;
                place[b as usize] += 1;
            }
        }
    }
    // gaps where an edge was given in both directions
    let (mut end, mut begin) = (0, 0);
    for a in 0..n {
        let next = ptr[a + 1];
        adjacency.copy_within(begin..place[a], end);
        end += place[a] - begin;
        (begin, ptr[a + 1]) = (next, end);
    }
    adjacency.truncate(end);
    Graph { ptr, adjacency }
}

/// A part of the graph with coordinates; `ids` are the vertices' numbers in the whole graph.
pub(super) struct Subgraph {
    pub ids: Vec<u32>,
    graph: Graph,
    pub weight: Vec<u32>,
    pub at: Vec<[f64; 3]>,
    /// Upper bound of the length of each vertex's edges in the whole graph, and so of their projections.
    pub reach: Vec<f64>,
}

impl Subgraph {
    /// All vertices of a graph.
    pub(super) fn whole(graph: Graph, weight: Vec<u32>, at: Vec<[f64; 3]>) -> Self {
        let size = at.iter().flatten().fold(0.0, |m: f64, x| m.max(x.abs()));
        let square = |a: &[f64; 3], b: &[f64; 3]| (0..3).map(|d| (a[d] - b[d]) * (a[d] - b[d])).sum::<f64>();
        let longest = |v: usize| graph.neighbours(v).iter().fold(0.0, |m: f64, &u| m.max(square(&at[v], &at[u as usize])));
        let reach = (0..at.len()).map(|v| longest(v).sqrt() * (1.0 + 1e-9) + ROUNDING * size).collect();
        Self { ids: (0..at.len()).map(index).collect(), graph, weight, at, reach }
    }

    pub(super) fn neighbours(&self, v: usize) -> &[u32] {
        self.graph.neighbours(v)
    }

    /// Sum of the numbers of neighbours.
    pub(super) fn degrees(&self) -> usize {
        self.graph.adjacency.len()
    }

    pub(super) fn total_weight(&self) -> u64 {
        self.weight.iter().map(|&w| u64::from(w)).sum()
    }

    /// The vertices left and right of a separator.
    pub(super) fn halves(&self, label: &[u8]) -> [Self; 2] {
        let n = self.ids.len();
        let mut local = vec![u32::MAX; n];
        let (mut vertices, mut edges) = ([0usize; 2], [0usize; 2]);
        for v in (0..n).filter(|&v| label[v] != SEPARATOR) {
            let side = usize::from(label[v] != LEFT);
            local[v] = vertices[side] as u32;
            vertices[side] += 1;
            edges[side] += self.neighbours(v).len();
        }
        let mut parts = [0, 1].map(|side| {
            let mut ptr = Vec::with_capacity(vertices[side] + 1);
            ptr.push(0);
            let graph = Graph { ptr, adjacency: vec![0; edges[side]] };
            let many = vertices[side];
            let (ids, weight) = (Vec::with_capacity(many), Vec::with_capacity(many));
            Self { ids, graph, weight, at: Vec::with_capacity(many), reach: Vec::with_capacity(many) }
        });
        for v in (0..n).filter(|&v| label[v] != SEPARATOR) {
            let part = &mut parts[usize::from(label[v] != LEFT)];
            part.ids.push(self.ids[v]);
            part.weight.push(self.weight[v]);
            part.at.push(self.at[v]);
            part.reach.push(self.reach[v]);
            let mut end = part.graph.ptr[part.graph.ptr.len() - 1];
            for &u in self.neighbours(v) {
                // a neighbour is on the same side or in the separator
                let u = local[u as usize];
                part.graph.adjacency[end] = u;
                end += usize::from(u != u32::MAX);
            }
            part.graph.ptr.push(end);
        }
        for part in &mut parts {
            part.graph.adjacency.truncate(part.graph.ptr[part.graph.ptr.len() - 1]);
        }
        parts
    }
}
