//! Fill-reducing orders of symmetric matrices: geometric nested dissection and the postorder of an elimination tree.
//!
//! A set of vertices is cut in two near the plane through its median; the separator comes last, both halves are cut again.
//! It is the rim of one half where a line of the grid runs along the plane, else the smallest set that parts a band around it.
//! Vertices at one place are cut as one.
//! The order depends on the pattern and the places only, not on the number of threads.
//!
//! Source: George, SIAM J. Numer. Anal. 10 (1973) 345-363; Liu, SIAM J. Matrix Anal. 11 (1990) 134-172.

use std::collections::BTreeMap;

/// Sets of at most this many vertices are ordered by minimum degree.
const LEAF: usize = 100;
/// No vertex with fewer neighbours than this counts as tied to a large part of all.
const FEW: usize = 64;
/// Halves of more vertices than this are ordered in parallel.
const PARALLEL: usize = 4096;
/// Projections closer than this part of the extent count as equal, so that a cut follows a line of the grid.
const EQUAL: f64 = 1e-9;
/// Half width, as part of all vertices, of the band in which the smallest separator is sought.
const BAND: f64 = 0.1;
/// The same half width in separators of the straight cut, for large sets.
const LAYERS: usize = 8;
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

/// Renumbers `order` by a postorder of its elimination tree: the same fill, larger supernodes.
///
/// `ptr`, `cols`: one triangle of the pattern or both; `order[new] = old` before and after.
pub fn postordered(ptr: &[usize], cols: &[usize], order: &[usize]) -> Vec<usize> {
    let n = order.len();
    let parent = elimination_tree(ptr, cols, order);
    // children as linked lists, filled from the back so that they ascend
    let (mut first, mut next) = (vec![NONE; n], vec![NONE; n]);
    for k in (0..n).rev() {
        let p = parent[k];
        if p != NONE {
            next[k] = first[p];
            first[p] = k;
        }
    }
    let (mut result, mut stack) = (Vec::with_capacity(n), Vec::new());
    for root in (0..n).filter(|&k| parent[k] == NONE) {
        stack.push(root);
        while let Some(&k) = stack.last() {
            let child = first[k];
            if child == NONE {
                result.push(order[k]);
                stack.pop();
            } else {
                first[k] = next[child];
                stack.push(child);
            }
        }
    }
    result
}

/// Number of entries of the Cholesky factor (diagonal included) under `order`: what orders are compared by.
pub fn factor_entries(ptr: &[usize], cols: &[usize], order: &[usize]) -> usize {
    let n = order.len();
    let (below_ptr, below) = permuted(ptr, cols, order);
    let parent = elimination_tree(ptr, cols, order);
    let mut mark = vec![NONE; n];
    let mut count = n;
    for k in 0..n {
        // row k of the factor: the paths of the tree from the entries of row k up to k
        mark[k] = k;
        for &i in &below[below_ptr[k]..below_ptr[k + 1]] {
            let mut i = i as usize;
            while mark[i] != k {
                mark[i] = k;
                count += 1;
                i = parent[i];
            }
        }
    }
    count
}

const NONE: usize = usize::MAX;

/// Parent of every column in the elimination tree, numbered by `order`; [`NONE`] for roots.
fn elimination_tree(ptr: &[usize], cols: &[usize], order: &[usize]) -> Vec<usize> {
    let n = order.len();
    let (below_ptr, below) = permuted(ptr, cols, order);
    let (mut parent, mut ancestor) = (vec![NONE; n], vec![NONE; n]);
    for k in 0..n {
        for &i in &below[below_ptr[k]..below_ptr[k + 1]] {
            let mut i = i as usize;
            while i != NONE && i < k {
                let up = ancestor[i];
                ancestor[i] = k; // path compression
                if up == NONE {
                    parent[i] = k;
                }
                i = up;
            }
        }
    }
    parent
}

/// For every new index k the new indices i < k it is tied to.
fn permuted(ptr: &[usize], cols: &[usize], order: &[usize]) -> (Vec<usize>, Vec<u32>) {
    let n = order.len();
    let mut new = vec![0usize; n];
    for (k, &i) in order.iter().enumerate() {
        new[i] = k;
    }
    let mut below_ptr = vec![0usize; n + 1];
    for i in 0..n {
        for &j in &cols[ptr[i]..ptr[i + 1]] {
            if i != j {
                below_ptr[new[i].max(new[j]) + 1] += 1;
            }
        }
    }
    for k in 0..n {
        below_ptr[k + 1] += below_ptr[k];
    }
    let (mut place, mut below) = (below_ptr.clone(), vec![0u32; below_ptr[n]]);
    for i in 0..n {
        for &j in &cols[ptr[i]..ptr[i + 1]] {
            if i != j {
                let (a, b) = (new[i].min(new[j]), new[i].max(new[j]));
                below[place[b]] = index(a);
                place[b] += 1;
            }
        }
    }
    (below_ptr, below)
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

/// Labels of a cut.
const LEFT: u8 = 0;
const RIGHT: u8 = 1;
const SEPARATOR: u8 = 2;

/// Order of the ids of a piece: left half, right half, separator.
fn dissect(piece: Piece, graph: &Graph) -> Vec<u32> {
    let n = piece.ids.len();
    if n <= LEAF {
        return minimum_degree(&piece.ids, graph);
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

/// The cheapest cut over the axes and the longest direction of inertia; `None` where no cut leaves two halves.
fn best_cut(piece: &Piece) -> Option<Vec<u8>> {
    let mut best: Option<Cut> = None;
    let mut directions = vec![[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    directions.extend(oblique_direction(&piece.at));
    for direction in directions {
        let t: Vec<f64> = piece.at.iter().map(|x| x[0] * direction[0] + x[1] * direction[1] + x[2] * direction[2]).collect();
        if let Some(cut) = median_cut(piece, t) {
            // the first of two equal cuts: the result does not depend on rounding of a later one
            if best.as_ref().is_none_or(|b| cut.cost < 0.999 * b.cost) {
                best = Some(cut);
            }
        }
    }
    let best = best?;
    if !best.straight {
        // oblique to the grid, or no grid: the smallest separator in a band around the median follows the mesh
        if let Some((cost, label)) = band_cut(piece, &best.t, best.label.iter().filter(|&&l| l == SEPARATOR).count())
            && cost < 0.98 * best.cost
        {
            return Some(label);
        }
    }
    Some(best.label)
}

/// A cut: labels, their cost, the projections behind it.
struct Cut {
    cost: f64,
    label: Vec<u8>,
    t: Vec<f64>,
    /// The separator is one line of equal projections.
    straight: bool,
}

/// The weight of a separator, more where the halves differ; `None` where a half is empty.
fn cost(piece: &Piece, label: &[u8]) -> Option<f64> {
    let mut weight = [0u64; 3];
    for v in 0..label.len() {
        weight[label[v] as usize] += u64::from(piece.weight[v]);
    }
    if weight[0] == 0 || weight[1] == 0 {
        return None;
    }
    let difference = weight[0].abs_diff(weight[1]) as f64 / (weight[0] + weight[1]) as f64;
    Some(weight[2] as f64 * (1.0 + difference * difference))
}

/// Cuts the projections at their median; the separator is the rim of one half.
fn median_cut(piece: &Piece, t: Vec<f64>) -> Option<Cut> {
    let n = piece.ids.len();
    let (low, high) = t.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), &x| (l.min(x), h.max(x)));
    let extent = high - low;
    if extent <= 1e-12 * low.abs().max(high.abs()) {
        return None;
    }
    let mut values = t.clone();
    let median = *values.select_nth_unstable_by(n / 2, f64::total_cmp).1;
    let (before, after) = (median - EQUAL * extent, median + EQUAL * extent);
    // before or after the run of equal projections, whichever halves better
    let (num_before, num_after) = (t.iter().filter(|&&x| x < before).count(), t.iter().filter(|&&x| x <= after).count());
    let bound = if num_after == n || (num_before > 0 && n / 2 - num_before <= num_after - n / 2) { before } else { after };
    let mut label: Vec<u8> = t.iter().map(|&x| if x < bound { LEFT } else { RIGHT }).collect();
    let mut weight = [0u64; 2];
    let mut rim = [0u64; 2];
    for v in 0..n {
        let side = label[v];
        weight[side as usize] += u64::from(piece.weight[v]);
        if piece.neighbours(v).iter().any(|&u| label[u as usize] != side) {
            rim[side as usize] += u64::from(piece.weight[v]);
        }
    }
    let from = if rim[0] < rim[1] || (rim[0] == rim[1] && weight[0] > weight[1]) { LEFT } else { RIGHT };
    let other = 1 - from;
    let separator: Vec<usize> =
        (0..n).filter(|&v| label[v] == from && piece.neighbours(v).iter().any(|&u| label[u as usize] == other)).collect();
    let (mut first, mut last) = (f64::INFINITY, f64::NEG_INFINITY);
    for v in separator {
        label[v] = SEPARATOR;
        (first, last) = (first.min(t[v]), last.max(t[v]));
    }
    let straight = last - first <= 2.0 * EQUAL * extent;
    Some(Cut { cost: cost(piece, &label)?, label, t, straight })
}

/// The smallest separator between the lowest and the highest projections, by maximum flow through the band between them.
fn band_cut(piece: &Piece, t: &[f64], separator: usize) -> Option<(f64, Vec<u8>)> {
    let n = t.len();
    let mut values = t.to_vec();
    let width = ((BAND * n as f64) as usize).min(LAYERS * separator);
    let low = *values.select_nth_unstable_by(n / 2 - width, f64::total_cmp).1;
    let high = *values.select_nth_unstable_by((n / 2 + width).min(n - 1), f64::total_cmp).1;
    let mut label: Vec<u8> = t
        .iter()
        .map(|&x| {
            if x < low {
                LEFT
            } else if x > high {
                RIGHT
            } else {
                SEPARATOR
            }
        })
        .collect();
    let band: Vec<usize> = (0..n).filter(|&v| label[v] == SEPARATOR).collect();
    let mut local = vec![u32::MAX; n];
    for (k, &v) in band.iter().enumerate() {
        local[v] = index(k);
    }
    // vertex k enters at 2 k and leaves at 2 k + 1, its weight is what it lets through
    let (source, sink) = (2 * band.len(), 2 * band.len() + 1);
    let mut net = Network::new(sink + 1);
    for (k, &v) in band.iter().enumerate() {
        net.arc(2 * k, 2 * k + 1, piece.weight[v]);
        let (mut left, mut right) = (false, false);
        for &u in piece.neighbours(v) {
            match label[u as usize] {
                LEFT => left = true,
                RIGHT => right = true,
                _ => net.arc(2 * k + 1, 2 * local[u as usize] as usize, u32::MAX),
            }
        }
        if left {
            net.arc(source, 2 * k, u32::MAX);
        }
        if right {
            net.arc(2 * k + 1, sink, u32::MAX);
        }
    }
    // an edge across the band leaves no separator inside it
    if (0..n).any(|v| label[v] == LEFT && piece.neighbours(v).iter().any(|&u| label[u as usize] == RIGHT)) {
        return None;
    }
    net.saturate(source, sink);
    let reached = net.reached(source);
    for (k, &v) in band.iter().enumerate() {
        label[v] = match (reached[2 * k], reached[2 * k + 1]) {
            (_, true) => LEFT,
            (true, false) => SEPARATOR,
            (false, false) => RIGHT,
        };
    }
    Some((cost(piece, &label)?, label))
}

/// A network for maximum flow (Dinic: shortest augmenting paths, all of one length at a time).
struct Network {
    first: Vec<u32>,
    next: Vec<u32>,
    to: Vec<u32>,
    /// What each arc still lets through; arc k and k ^ 1 are each other's reverse.
    room: Vec<u32>,
    level: Vec<u32>,
}

impl Network {
    fn new(nodes: usize) -> Self {
        Self { first: vec![u32::MAX; nodes], next: Vec::new(), to: Vec::new(), room: Vec::new(), level: vec![u32::MAX; nodes] }
    }

    fn arc(&mut self, from: usize, to: usize, room: u32) {
        for (a, b, room) in [(from, to, room), (to, from, 0)] {
            self.next.push(self.first[a]);
            self.first[a] = index(self.to.len());
            self.to.push(index(b));
            self.room.push(room);
        }
    }

    /// Levels of the nodes that `source` still reaches.
    fn search(&mut self, source: usize) {
        self.level.fill(u32::MAX);
        self.level[source] = 0;
        let mut queue = vec![index(source)];
        let mut head = 0;
        while head < queue.len() {
            let a = queue[head] as usize;
            head += 1;
            let mut k = self.first[a];
            while k != u32::MAX {
                let b = self.to[k as usize] as usize;
                if self.room[k as usize] > 0 && self.level[b] == u32::MAX {
                    self.level[b] = self.level[a] + 1;
                    queue.push(index(b));
                }
                k = self.next[k as usize];
            }
        }
    }

    fn saturate(&mut self, source: usize, sink: usize) {
        loop {
            self.search(source);
            if self.level[sink] == u32::MAX {
                return;
            }
            let mut current = self.first.clone();
            let mut path: Vec<u32> = Vec::new();
            loop {
                let node = path.last().map_or(source, |&k| self.to[k as usize] as usize);
                if node == sink {
                    let flow = path.iter().map(|&k| self.room[k as usize]).min().expect("a path has arcs");
                    let mut cut = path.len();
                    for (i, &k) in path.iter().enumerate().rev() {
                        // "without bound" stays so
                        if self.room[k as usize] != u32::MAX {
                            self.room[k as usize] -= flow;
                        }
                        if self.room[k as usize ^ 1] != u32::MAX {
                            self.room[k as usize ^ 1] += flow;
                        }
                        if self.room[k as usize] == 0 {
                            cut = i;
                        }
                    }
                    path.truncate(cut);
                    continue;
                }
                let mut k = current[node];
                while k != u32::MAX {
                    let b = self.to[k as usize] as usize;
                    if self.room[k as usize] > 0 && self.level[b] == self.level[node] + 1 {
                        break;
                    }
                    k = self.next[k as usize];
                }
                current[node] = k;
                if k != u32::MAX {
                    path.push(k);
                } else if let Some(back) = path.pop() {
                    let from = self.to[back as usize ^ 1] as usize;
                    current[from] = self.next[back as usize];
                } else {
                    break;
                }
            }
        }
    }

    fn reached(&mut self, source: usize) -> Vec<bool> {
        self.search(source);
        self.level.iter().map(|&l| l != u32::MAX).collect()
    }
}

/// The direction in which the points spread most, where it is clearly longest and no axis.
fn oblique_direction(points: &[[f64; 3]]) -> Option<[f64; 3]> {
    let n = points.len() as f64;
    let mut mean = [0.0; 3];
    for x in points {
        for d in 0..3 {
            mean[d] += x[d] / n;
        }
    }
    let mut c = [[0.0; 3]; 3];
    for x in points {
        for a in 0..3 {
            for b in 0..3 {
                c[a][b] += (x[a] - mean[a]) * (x[b] - mean[b]);
            }
        }
    }
    let trace = c[0][0] + c[1][1] + c[2][2];
    if trace <= 0.0 {
        return None;
    }
    // power iteration from the column of the largest variance: a rough direction is enough
    let k = (0..3).max_by(|&a, &b| c[a][a].total_cmp(&c[b][b])).expect("three axes");
    let mut v = [c[0][k], c[1][k], c[2][k]];
    let mut value = 0.0;
    for _ in 0..16 {
        let length = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
        let unit = [v[0] / length, v[1] / length, v[2] / length];
        for a in 0..3 {
            v[a] = c[a][0] * unit[0] + c[a][1] * unit[1] + c[a][2] * unit[2];
        }
        value = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
    }
    let unit = [v[0] / value, v[1] / value, v[2] / value];
    let along_axis = unit.iter().any(|x| x.abs() > 0.99);
    (value > 0.6 * trace && !along_axis).then_some(unit)
}

/// Minimum degree order of a small set; its neighbours outside, all of them ordered later, count in the degrees.
///
/// Adjacency as bits: first the vertices of the set, then the neighbours.
fn minimum_degree(ids: &[u32], graph: &Graph) -> Vec<u32> {
    let n = ids.len();
    let mut local: BTreeMap<u32, usize> = ids.iter().enumerate().map(|(k, &v)| (v, k)).collect();
    for &v in ids {
        for &u in graph.neighbours(v as usize) {
            let next = local.len();
            local.entry(u).or_insert(next);
        }
    }
    let words = local.len().div_ceil(64);
    let mut tied = vec![vec![0u64; words]; n];
    for (row, &v) in tied.iter_mut().zip(ids) {
        for u in graph.neighbours(v as usize) {
            let k = local[u];
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
