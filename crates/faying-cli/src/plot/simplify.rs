//! Fewer shapes for pictures of fine meshes: pieces are merged, invisible points of lines are removed.

use super::sample::Drawn;

/// Corners and value of a piece.
pub(super) type ShadedPolygon = (Vec<[f64; 2]>, f64);

/// Most pieces of a view.
pub(super) const PIECES: usize = 9000;
/// Most lines between elements of a view; a mesh of more is too fine to be seen.
const LINES: usize = 6000;

/// The pieces of one body, at most `most`: close ones are merged into their convex hull with their mean value.
///
/// Groups are cut in the middle of the longer extent of their centres, the widest group first, so the area decides and not
/// the number of pieces.
pub(super) fn joined(pieces: Vec<ShadedPolygon>, most: usize) -> Vec<ShadedPolygon> {
    let most = most.max(1);
    if pieces.len() <= most {
        return pieces;
    }
    let centers: Vec<[f64; 2]> = pieces.iter().map(|(corners, _)| center(corners)).collect();
    let mut groups = std::collections::BinaryHeap::from([Group::new((0..pieces.len()).collect(), &centers)]);
    while groups.len() < most {
        let Some(group) = groups.pop() else { break };
        if group.members.len() < 2 {
            groups.push(group); // the widest group is a single piece, so all are
            break;
        }
        let Group { mut members, axis, at, number, .. } = group;
        let mut upper: Vec<usize>;
        (members, upper) = members.into_iter().partition(|&m| centers[m][axis] <= at);
        if members.is_empty() || upper.is_empty() {
            // all centres coincide, or are not finite
            members.append(&mut upper);
            upper = members.split_off(members.len() / 2);
        }
        let next = groups.len() + 1;
        groups.push(Group { number, ..Group::new(members, &centers) });
        groups.push(Group { number: next, ..Group::new(upper, &centers) });
    }
    let mut groups = groups.into_vec();
    groups.sort_by_key(|g| g.number);
    groups
        .iter()
        .map(|g| {
            let corners =
                hull(g.members.iter().flat_map(|&k| pieces[k].0.iter().copied()).filter(|p| p.iter().all(|x| x.is_finite())).collect());
            let values = g.members.iter().map(|&k| pieces[k].1).filter(|v| v.is_finite());
            let (sum, count) = values.fold((0.0, 0usize), |(sum, n), v| (sum + v, n + 1));
            (corners, if count > 0 { sum / count as f64 } else { f64::NAN })
        })
        .collect()
}

/// Pieces that may be merged into one.
struct Group {
    members: Vec<usize>,
    /// Longer extent of the centres; negative for a single piece.
    extent: f64,
    axis: usize,
    /// Middle of that extent.
    at: f64,
    number: usize,
}

impl Group {
    fn new(members: Vec<usize>, centers: &[[f64; 2]]) -> Self {
        let ranges = [0, 1].map(|k| {
            let values = members.iter().map(|&m| centers[m][k]);
            values.fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), v| (lo.min(v), hi.max(v)))
        });
        let axis = usize::from(ranges[1].1 - ranges[1].0 > ranges[0].1 - ranges[0].0);
        let (lo, hi) = ranges[axis];
        Self { extent: if members.len() < 2 { -1.0 } else { (hi - lo).max(0.0) }, axis, at: 0.5 * (lo + hi), number: 0, members }
    }
}

impl Ord for Group {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.extent.total_cmp(&other.extent).then(other.number.cmp(&self.number))
    }
}

impl PartialOrd for Group {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Group {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Group {}

fn center(corners: &[[f64; 2]]) -> [f64; 2] {
    [0, 1].map(|k| corners.iter().map(|p| p[k]).sum::<f64>() / corners.len().max(1) as f64)
}

/// The convex hull, counterclockwise (Andrew, Information Processing Letters 9, 1979).
fn hull(mut points: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    points.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    points.dedup();
    let left = |a: [f64; 2], b: [f64; 2], c: [f64; 2]| (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]) > 0.0;
    let chain = |points: &mut dyn Iterator<Item = [f64; 2]>| {
        let mut out: Vec<[f64; 2]> = Vec::new();
        for p in points {
            while out.len() > 1 && !left(out[out.len() - 2], out[out.len() - 1], p) {
                out.pop();
            }
            out.push(p);
        }
        out.pop();
        out
    };
    let mut lower = chain(&mut points.iter().copied());
    lower.extend(chain(&mut points.iter().rev().copied()));
    lower
}

/// Whether the lines between elements are few enough to be drawn.
pub(super) fn few_lines(drawn: &[Drawn]) -> bool {
    drawn.iter().map(|d| d.edges.iter().filter(|(_, outer)| !outer).count()).sum::<usize>() <= LINES
}

/// Lines that follow each other, end to start, as one.
pub(super) fn chained(lines: Vec<Vec<(i32, i32)>>) -> Vec<Vec<(i32, i32)>> {
    let mut starts: std::collections::BTreeMap<(i32, i32), Vec<usize>> = std::collections::BTreeMap::new();
    for (k, line) in lines.iter().enumerate() {
        if let Some(first) = line.first() {
            starts.entry(*first).or_default().push(k);
        }
    }
    let mut used = vec![false; lines.len()];
    let mut out = Vec::new();
    for k in 0..lines.len() {
        if std::mem::replace(&mut used[k], true) {
            continue;
        }
        let mut line = lines[k].clone();
        while let Some(next) = line.last().and_then(|end| starts.get(end)).and_then(|list| list.iter().copied().find(|&n| !used[n])) {
            used[next] = true;
            line.extend(lines[next].iter().skip(1));
        }
        out.push(line);
    }
    out
}

/// The line without points that are within `by` units of the straight line between the remaining ones.
pub(super) fn straightened(line: &[(i32, i32)], by: f64) -> Vec<(i32, i32)> {
    let mut keep = vec![false; line.len()];
    let mut open = vec![(0, line.len().saturating_sub(1))];
    while let Some((a, b)) = open.pop() {
        if line.is_empty() {
            break;
        }
        (keep[a], keep[b]) = (true, true);
        let off = |k: usize| distance(line[k], line[a], line[b]);
        if let Some(far) = (a + 1..b).max_by(|&i, &j| off(i).total_cmp(&off(j))).filter(|&k| off(k) > by) {
            open.extend([(a, far), (far, b)]);
        }
    }
    line.iter().zip(keep).filter(|(_, keep)| *keep).map(|(p, _)| *p).collect()
}

/// Distance of p to the stretch from a to b.
fn distance(p: (i32, i32), a: (i32, i32), b: (i32, i32)) -> f64 {
    let minus = |p: (i32, i32), q: (i32, i32)| (f64::from(p.0) - f64::from(q.0), f64::from(p.1) - f64::from(q.1));
    let (d, r) = (minus(b, a), minus(p, a));
    let length = d.0 * d.0 + d.1 * d.1;
    let t = if length > 0.0 { ((r.0 * d.0 + r.1 * d.1) / length).clamp(0.0, 1.0) } else { 0.0 };
    (r.0 - t * d.0).hypot(r.1 - t * d.1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn many_pieces_become_few_that_cover_the_same() {
        let n = 200;
        let at = |i: usize| i as f64 / n as f64;
        let pieces: Vec<ShadedPolygon> = (0..n * n)
            .map(|k| (k % n, k / n))
            .map(|(i, j)| (vec![[at(i), at(j)], [at(i + 1), at(j)], [at(i + 1), at(j + 1)], [at(i), at(j + 1)]], at(i)))
            .collect();
        let few = joined(pieces, PIECES);
        assert_eq!(few.len(), PIECES);
        let area: f64 = few
            .iter()
            .map(|(p, _)| (0..p.len()).map(|i| (p[i], p[(i + 1) % p.len()])).map(|(a, b)| 0.5 * (a[0] * b[1] - b[0] * a[1])).sum::<f64>())
            .sum();
        assert!((area - 1.0).abs() < 1e-12, "groups of squares are rectangles: {area}");
    }

    #[test]
    fn lines_are_joined_and_lose_what_lies_between() {
        let lines = vec![vec![(0, 0), (10, 0)], vec![(20, 0), (20, 20)], vec![(10, 0), (20, 0)]];
        let one = chained(lines);
        assert_eq!(one, [vec![(0, 0), (10, 0), (20, 0), (20, 20)]]);
        assert_eq!(straightened(&one[0], 1.0), [(0, 0), (20, 0), (20, 20)]);
    }
}
