//! Fill-reducing orders of symmetric matrices: geometric nested dissection and the postorder of an elimination tree.
//!
//! A set of vertices is cut in two by a plane through its median; the vertices of one half that touch the other
//! are the separator and come last; both halves are cut again. Vertices at one place are cut as one.
//! The order depends on the pattern and the places only, not on the number of threads.
//!
//! Source: George, SIAM J. Numer. Anal. 10 (1973) 345-363; Liu, SIAM J. Matrix Anal. 11 (1990) 134-172.

/// Sets of at most this many vertices are ordered by minimum degree (the bits of one word).
const LEAF: usize = 64;
/// Halves of more vertices than this are ordered in parallel.
const PARALLEL: usize = 4096;
/// Projections closer than this part of the extent count as equal, so that a cut follows a line of the grid.
const EQUAL: f64 = 1e-9;
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
    let (adjacency_ptr, adjacency) = symmetric(groups, &edges);
    drop(edges);

    // a vertex tied to a large part of all others (the unknown of a rigid body, say) would be in every separator
    let bound = (10.0 * (groups as f64).sqrt()).max(LEAF as f64) as usize;
    let degree = |g: usize| adjacency_ptr[g + 1] - adjacency_ptr[g];
    let dense: Vec<bool> = (0..groups).map(|g| degree(g) > bound).collect();
    let num_dense = dense.iter().filter(|&&d| d).count();
    let keep_dense = num_dense == 0 || 10 * num_dense > groups;
    let whole = Piece {
        ids: (0..groups).map(index).collect(),
        ptr: adjacency_ptr,
        adjacency,
        weight: (0..groups).map(|g| index(start[g + 1] - start[g])).collect(),
        at: (0..groups).map(|g| places[sorted[start[g]]]).collect(),
    };
    let mut order = if keep_dense {
        dissect(whole)
    } else {
        let label: Vec<u8> = dense.iter().map(|&d| u8::from(d)).collect();
        dissect(whole.part(&label, 0))
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

/// A graph with places; `ids` are the vertices' numbers in the whole graph.
struct Piece {
    ids: Vec<u32>,
    ptr: Vec<usize>,
    adjacency: Vec<u32>,
    weight: Vec<u32>,
    at: Vec<[f64; 3]>,
}

impl Piece {
    fn neighbours(&self, v: usize) -> &[u32] {
        &self.adjacency[self.ptr[v]..self.ptr[v + 1]]
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
            ptr,
            adjacency,
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
fn dissect(piece: Piece) -> Vec<u32> {
    let n = piece.ids.len();
    if n <= LEAF {
        return minimum_degree(&piece);
    }
    let Some(label) = best_cut(&piece) else {
        return piece.ids;
    };
    let (left, right) = (piece.part(&label, LEFT), piece.part(&label, RIGHT));
    let separator: Vec<u32> = (0..n).filter(|&v| label[v] == SEPARATOR).map(|v| piece.ids[v]).collect();
    drop(piece);
    let (mut order, right) = if n > PARALLEL { rayon::join(|| dissect(left), || dissect(right)) } else { (dissect(left), dissect(right)) };
    order.extend(right);
    order.extend(separator);
    order
}

/// The cheapest cut over the axes and the longest direction of inertia; `None` where no cut leaves two halves.
fn best_cut(piece: &Piece) -> Option<Vec<u8>> {
    let mut best: Option<(f64, Vec<u8>)> = None;
    let mut directions = vec![[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    directions.extend(oblique_direction(&piece.at));
    for direction in directions {
        if let Some((cost, label)) = cut(piece, &direction) {
            // the first of two equal cuts: the result does not depend on rounding of a later one
            if best.as_ref().is_none_or(|b| cost < 0.999 * b.0) {
                best = Some((cost, label));
            }
        }
    }
    best.map(|b| b.1)
}

/// Cuts across `direction` at the median: (cost, labels). The cost is the weight of the separator, more where the halves differ.
fn cut(piece: &Piece, direction: &[f64; 3]) -> Option<(f64, Vec<u8>)> {
    let n = piece.ids.len();
    let t: Vec<f64> = piece.at.iter().map(|x| x[0] * direction[0] + x[1] * direction[1] + x[2] * direction[2]).collect();
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
    if weight[0] == 0 || weight[1] == 0 {
        return None;
    }
    let from = if rim[0] < rim[1] || (rim[0] == rim[1] && weight[0] > weight[1]) { LEFT } else { RIGHT };
    let other = 1 - from;
    let separator: Vec<usize> =
        (0..n).filter(|&v| label[v] == from && piece.neighbours(v).iter().any(|&u| label[u as usize] == other)).collect();
    for v in separator {
        label[v] = SEPARATOR;
    }
    weight[from as usize] -= rim[from as usize];
    let total = (weight[0] + weight[1]) as f64;
    if weight[from as usize] == 0 {
        return None;
    }
    let difference = weight[0].abs_diff(weight[1]) as f64 / total;
    Some((rim[from as usize] as f64 * (1.0 + difference * difference), label))
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

/// Minimum degree order of at most 64 vertices; adjacency as bits.
fn minimum_degree(piece: &Piece) -> Vec<u32> {
    let n = piece.ids.len();
    let mut tied: Vec<u64> = (0..n).map(|v| piece.neighbours(v).iter().fold(0, |m, &u| m | (1 << u))).collect();
    let mut alive: Vec<usize> = (0..n).collect();
    let mut order = Vec::with_capacity(n);
    while let Some((k, &v)) = alive.iter().enumerate().min_by_key(|&(_, &v)| (tied[v].count_ones(), v)) {
        alive.remove(k);
        order.push(piece.ids[v]);
        let clique = tied[v];
        for &u in &alive {
            if clique >> u & 1 == 1 {
                tied[u] = (tied[u] | clique) & !(1 << u) & !(1 << v);
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
fn symmetric(n: usize, edges: &[(u32, u32)]) -> (Vec<usize>, Vec<u32>) {
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
    (ptr, adjacency)
}

/// Lexicographic order of points; finite coordinates, zero without a sign.
fn compare(a: &[f64; 3], b: &[f64; 3]) -> std::cmp::Ordering {
    (0..3).map(|d| (a[d] + 0.0).total_cmp(&(b[d] + 0.0))).find(|o| o.is_ne()).unwrap_or(std::cmp::Ordering::Equal)
}

fn index(i: usize) -> u32 {
    u32::try_from(i).expect("fewer than 2^32 unknowns")
}
