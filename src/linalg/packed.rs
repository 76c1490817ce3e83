//! Packed lower triangles, column after column, and their sum into the front of a parent.

/// Numbers of a packed lower triangle.
pub(super) fn triangle(n: usize) -> usize {
    n * (n + 1) / 2
}

/// Adds the columns of a packed lower triangle whose positions lie in `from..to` to `target`, the columns `from..` of a front and its rows
/// from `from` on, `height` numbers from column to column.
pub(super) fn add(packed: &[f64], position: &[u32], [from, to]: [usize; 2], target: &mut [f64], height: usize, runs: &mut Vec<RowRun>) {
    let n = position.len();
    let [first, last] = [from, to].map(|bound| position.partition_point(|&p| (p as usize) < bound));
    // positions mostly follow one another
    runs.clear();
    for (row, &p) in position.iter().enumerate().skip(first) {
        match runs.last_mut() {
            Some(run) if run.at + row - run.first == p as usize => run.end = row + 1,
            _ => runs.push(RowRun { first: row, end: row + 1, at: p as usize }),
        }
    }
    let (mut at, mut current) = (triangle(n) - triangle(n - first), 0);
    for column in first..last {
        let values = &packed[at..at + n - column];
        let line = &mut target[(position[column] as usize - from) * height..][..height];
        current += usize::from(runs[current].end == column);
        for run in &runs[current..] {
            let begin = run.first.max(column);
            let to = run.at + begin - run.first - from;
            for (t, v) in line[to..to + run.end - begin].iter_mut().zip(&values[begin - column..run.end - column]) {
                *t += v;
            }
        }
        at += n - column;
    }
}

/// Rows `first..end` of a child at positions from `at` on.
pub(super) struct RowRun {
    first: usize,
    end: usize,
    at: usize,
}
