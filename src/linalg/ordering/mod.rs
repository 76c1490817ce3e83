//! Fill-reducing orders of symmetric matrices: geometric nested dissection and the postorder of an elimination tree.
//!
//! A set of vertices is cut in two near the plane through its median; the separator comes last, both halves are cut again.
//! Planes are tried across the directions that its short edges have, those of a grid wherever it lies, turned or bent.
//! The separator is the rim of one half where a line of the grid runs along the plane, else the smallest set that parts a band around it.
//! Vertices at one place are cut as one.
//! The order depends on the pattern and the places only, not on the number of threads.
//!
//! Source: George, SIAM J. Numer. Anal. 10 (1973) 345-363; Liu, SIAM J. Matrix Anal. 11 (1990) 134-172.

mod cut;
mod flow;
mod frame;
mod tree;

use cut::{LEFT, RIGHT, SEPARATOR, best_cut};

pub use tree::{factor_entries, postordered};

/// Sets of at most this many vertices are ordered by minimum degree.
const LEAF: usize = 100;
/// No vertex with fewer neighbours than this counts as tied to a large part of all.
const FEW: usize = 64;
/// Halves of more vertices than this are ordered in parallel.
const PARALLEL: usize = 4096;
/// A place shared by more unknowns than this tells nothing about the pattern.
const CROWD: usize = 256;

/// Nested dissection of the graph of a symmetric matrix by the places of its unknowns.
///
/// `ptr`, `cols`: rows of the pattern, one triangle or both. Returns `order[new] = old`, or `None` where the places do
/// not tell the unknowns apart (absent, not finite, too many at one point): take a minimum degree order there.
pub fn nested_dissection(ptr: &[usize], cols: &[usize], places: &[[f64; 3]]) -> Option<Vec<usize>> {
    let n = ptr.len() - 1;
    if places.len() != n || n == 0 || places.iter().flatten().any(|x| !x.is_finite()) {
        return None;
    }
    // unknowns of one node, and the multiplier that acts on it, share a place: one vertex with a weight
    let mut sorted: Vec<usize> = (0..n).collect();
    sorted.sort_unstable_by(|&i, &j| compare(&places[i], &places[j]).then(i.cmp(&j)));
    let mut start = vec![0usize];
    for k in 1..n {
        if compare(&places[sorted[k - 1]], &places[sorted[k]]).is_ne() {
            start.push(k);
        }
    }
    let groups = start.len();
    start.push(n);
    if start.windows(2).any(|w| w[1] - w[0] > CROWD) && groups < n.div_ceil(8) {
        return None;
    }
    let mut group = vec![0u32; n];
    for g in 0..groups {
        for &i in &sorted[start[g]..start[g + 1]] {
            group[i] = index(g);
        }
    }
    let edges = group_edges(ptr, cols, &group, &sorted, &start);
    let graph = symmetric(groups, &edges);
    drop(edges);

    // a vertex tied to a large part of all others (the unknown of a rigid body, say) would be in every separator
    let bound = (10.0 * (groups as f64).sqrt()).max(FEW as f64) as usize;
    let dense: Vec<bool> = (0..groups).map(|g| graph.neighbours(g).len() > bound).collect();
    let num_dense = dense.iter().filter(|&&d| d).count();
    let keep_dense = num_dense == 0 || 10 * num_dense > groups;
    let whole = Piece {
        ids: (0..groups).map(index).collect(),
        graph: graph.clone(),
        weight: (0..groups).map(|g| index(start[g + 1] - start[g])).collect(),
        at: (0..groups).map(|g| places[sorted[start[g]]]).collect(),
    };
    let mut order = if keep_dense {
        dissect(whole, &graph)
    } else {
        let label: Vec<u8> = dense.iter().map(|&d| u8::from(d)).collect();
        dissect(whole.part(&label, 0), &graph)
    };
    if !keep_dense {
        order.extend((0..groups).filter(|&g| dense[g]).map(index));
    }
    let mut result = Vec::with_capacity(n);
    for g in order {
        result.extend_from_slice(&sorted[start[g as usize]..start[g as usize + 1]]);
    }
    Some(result)
}

/// Neighbours of every vertex.
#[derive(Clone)]
struct Graph {
    ptr: Vec<usize>,
    adjacency: Vec<u32>,
}

impl Graph {
    fn neighbours(&self, v: usize) -> &[u32] {
        &self.adjacency[self.ptr[v]..self.ptr[v + 1]]
    }
}

/// A part of the graph with places; `ids` are the vertices' numbers in the whole graph.
struct Piece {
    ids: Vec<u32>,
    graph: Graph,
    weight: Vec<u32>,
    at: Vec<[f64; 3]>,
}

impl Piece {
    fn neighbours(&self, v: usize) -> &[u32] {
        self.graph.neighbours(v)
    }

    /// The graph of the vertices with the given label.
    fn part(&self, label: &[u8], wanted: u8) -> Self {
        let mut local = vec![u32::MAX; self.ids.len()];
        let members: Vec<usize> = (0..self.ids.len()).filter(|&v| label[v] == wanted).collect();
        for (k, &v) in members.iter().enumerate() {
            local[v] = index(k);
        }
        let (mut ptr, mut adjacency) = (Vec::with_capacity(members.len() + 1), Vec::new());
        ptr.push(0);
        for &v in &members {
            adjacency.extend(self.neighbours(v).iter().map(|&u| local[u as usize]).filter(|&u| u != u32::MAX));
            ptr.push(adjacency.len());
        }
        Self {
            ids: members.iter().map(|&v| self.ids[v]).collect(),
            graph: Graph { ptr, adjacency },
            weight: members.iter().map(|&v| self.weight[v]).collect(),
            at: members.iter().map(|&v| self.at[v]).collect(),
        }
    }
}

/// Order of the ids of a piece: left half, right half, separator.
fn dissect(piece: Piece, graph: &Graph) -> Vec<u32> {
    let n = piece.ids.len();
    if n <= LEAF {
        return minimum_degree(&piece, graph);
    }
    let Some(label) = best_cut(&piece) else {
        return piece.ids;
    };
    let (left, right) = (piece.part(&label, LEFT), piece.part(&label, RIGHT));
    let separator: Vec<u32> = (0..n).filter(|&v| label[v] == SEPARATOR).map(|v| piece.ids[v]).collect();
    drop(piece);
    let (mut order, right) = if n > PARALLEL {
        rayon::join(|| dissect(left, graph), || dissect(right, graph))
    } else {
        (dissect(left, graph), dissect(right, graph))
    };
    order.extend(right);
    order.extend(separator);
    order
}

/// Minimum degree order of a small set; its neighbours outside, all of them ordered later, count in the degrees.
///
/// Adjacency as bits: first the vertices of the set, then the neighbours.
fn minimum_degree(piece: &Piece, graph: &Graph) -> Vec<u32> {
    let (n, ids) = (piece.ids.len(), &piece.ids);
    // ids ascend in the piece and in both graphs: what is not met in the piece lies outside
    let outside = |v: usize| {
        let mut inner = piece.neighbours(v).iter().map(|&u| ids[u as usize]).peekable();
        graph.neighbours(ids[v] as usize).iter().copied().filter(move |u| inner.next_if_eq(u).is_none())
    };
    let mut others: Vec<u32> = (0..n).flat_map(outside).collect();
    others.sort_unstable();
    others.dedup();
    let words = (n + others.len()).div_ceil(64);
    let mut tied = vec![vec![0u64; words]; n];
    for (v, row) in tied.iter_mut().enumerate() {
        let inner = piece.neighbours(v).iter().map(|&u| u as usize);
        let mut from = 0;
        let outer = outside(v).map(|u| {
            // both lists ascend
            from += others[from..].partition_point(|&o| o < u);
            n + from
        });
        for k in inner.chain(outer) {
            row[k / 64] |= 1 << (k % 64);
        }
    }
    let mut degree: Vec<u32> = tied.iter().map(|row| row.iter().map(|w| w.count_ones()).sum()).collect();
    let mut alive: Vec<usize> = (0..n).collect();
    let mut order = Vec::with_capacity(n);
    while let Some((k, &v)) = alive.iter().enumerate().min_by_key(|&(_, &v)| (degree[v], v)) {
        alive.remove(k);
        order.push(ids[v]);
        let clique = std::mem::take(&mut tied[v]);
        for &u in &alive {
            if clique[u / 64] >> (u % 64) & 1 == 1 {
                let row = &mut tied[u];
                for (w, c) in row.iter_mut().zip(&clique) {
                    *w |= c;
                }
                row[u / 64] &= !(1 << (u % 64));
                row[v / 64] &= !(1 << (v % 64));
                degree[u] = row.iter().map(|w| w.count_ones()).sum();
            }
        }
    }
    order
}

/// Edges between groups, each at least once, none twice in the same direction.
fn group_edges(ptr: &[usize], cols: &[usize], group: &[u32], sorted: &[usize], start: &[usize]) -> Vec<(u32, u32)> {
    let groups = start.len() - 1;
    let mut seen = vec![u32::MAX; groups];
    let mut edges = Vec::new();
    for g in 0..groups {
        let g32 = index(g);
        seen[g] = g32;
        for &i in &sorted[start[g]..start[g + 1]] {
            for &j in &cols[ptr[i]..ptr[i + 1]] {
                let h = group[j];
                if seen[h as usize] != g32 {
                    seen[h as usize] = g32;
                    edges.push((g32, h));
                }
            }
        }
    }
    edges
}

/// Rows of the symmetric graph with these edges; sorted, no edge twice.
fn symmetric(n: usize, edges: &[(u32, u32)]) -> Graph {
    let mut count = vec![0usize; n + 1];
    for &(a, b) in edges {
        count[a as usize + 1] += 1;
        count[b as usize + 1] += 1;
    }
    for v in 0..n {
        count[v + 1] += count[v];
    }
    let (mut place, mut all) = (count.clone(), vec![0u32; count[n]]);
    for &(a, b) in edges {
        all[place[a as usize]] = b;
        place[a as usize] += 1;
        all[place[b as usize]] = a;
        place[b as usize] += 1;
    }
    let (mut ptr, mut adjacency) = (vec![0usize], Vec::with_capacity(all.len()));
    for v in 0..n {
        let row = &mut all[count[v]..count[v + 1]];
        row.sort_unstable();
        let first = adjacency.len();
        for &u in row.iter() {
            if adjacency.len() == first || adjacency.last() != Some(&u) {
                adjacency.push(u);
            }
        }
        ptr.push(adjacency.len());
    }
    Graph { ptr, adjacency }
}

/// Lexicographic order of points; finite coordinates, zero without a sign.
fn compare(a: &[f64; 3], b: &[f64; 3]) -> std::cmp::Ordering {
    (0..3).map(|d| (a[d] + 0.0).total_cmp(&(b[d] + 0.0))).find(|o| o.is_ne()).unwrap_or(std::cmp::Ordering::Equal)
}

fn index(i: usize) -> u32 {
    u32::try_from(i).expect("fewer than 2^32 unknowns")
}
