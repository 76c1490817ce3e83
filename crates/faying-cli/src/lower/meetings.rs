//! Points in which patches of one mesh meet without a common facet: they share the function of that point.

use crate::case::Case;
use crate::shapes::point_of;
use faying::linalg::Vector;
use faying::problem::Problem;
use std::collections::BTreeMap;

/// Functions (patch, function) of patches of one mesh that are one, with their point.
pub(super) fn found<const S: usize, const N: usize>(case: &Case, problem: &Problem<S, N>) -> Vec<(Vec<(usize, usize)>, Vector<N>)> {
    let mut wanted: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for (m, meeting) in case.meetings.iter().enumerate() {
        meeting.patches.iter().for_each(|k| wanted.entry(*k).or_default().push(m));
    }
    let mut found: Vec<(Vec<(usize, usize)>, Vector<N>)> = vec![(Vec::new(), Vector::zeros()); case.meetings.len()];
    for (k, body) in problem.bodies().enumerate() {
        let Some(meetings) = wanted.get(&k) else { continue };
        let place = |&m: &usize| Some((m, point_of::<N>(&case.patches[k], case.meetings[m].point)?));
        let (numbers, places): (Vec<usize>, Vec<Vector<N>>) = meetings.iter().filter_map(place).unzip();
        for (place, function) in body.functions_at(&places) {
            let (functions, x) = &mut found[numbers[place]];
            functions.push((k, function));
            *x = places[place];
        }
    }
    found
}
