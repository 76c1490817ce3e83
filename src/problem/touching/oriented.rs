//! Slaves and masters among sides that touch one another.

use crate::problem::model::BodySide;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Tolerance of the covered share of a side's facets: a side is fully covered from 1 - `ALL` on.
const ALL: f64 = 1e-9;

/// Chooses slaves and masters from `shares`, the share of facets of one side that another covers; `ends_beyond`: whether a corner of a
/// facet of a side lies on no other.
pub(super) fn oriented<const S: usize, const N: usize>(
    all: &[Arc<BodySide<S, N>>],
    shares: &BTreeMap<(usize, usize), f64>,
    ends_beyond: &[bool],
) -> Vec<(usize, Vec<usize>)> {
    let mut neighbours: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for &(a, b) in shares.keys() {
        for (a, b) in [(a, b), (b, a)] {
            let list = neighbours.entry(a).or_default();
            if !list.contains(&b) {
                list.push(b);
            }
        }
    }
    let mut class: BTreeMap<usize, usize> = BTreeMap::new();
    let mut out = Vec::new();
    for &start in neighbours.keys() {
        if class.contains_key(&start) {
            continue;
        }
        // connected group of touching sides, divided into two classes
        let mut members = vec![start];
        class.insert(start, 0);
        let mut next = 0;
        while let Some(&a) = members.get(next) {
            next += 1;
            for &b in &neighbours[&a] {
                if !class.contains_key(&b) {
                    class.insert(b, 1 - class[&a]);
                    members.push(b);
                }
            }
        }
        let covered = |a: usize| -> f64 { neighbours[&a].iter().filter_map(|&b| shares.get(&(a, b))).sum() };
        let of = |c: usize| members.iter().copied().filter(|m| class[m] == c).collect::<Vec<_>>();
        let classes = [of(0), of(1)];
        let whole = classes.each_ref().map(|list| list.iter().all(|&a| covered(a) >= 1.0 - ALL && !ends_beyond[a]));
        let facets = classes.each_ref().map(|list| list.iter().map(|&a| all[a].trace.facets.len()).sum::<usize>());
        let slave = if whole[0] != whole[1] { usize::from(whole[1]) } else { usize::from(facets[1] > facets[0]) };
        for &a in &classes[slave] {
            let mut masters: Vec<usize> = neighbours[&a].iter().copied().filter(|b| class[b] != class[&a]).collect();
            masters.sort_unstable();
            out.push((a, masters));
        }
    }
    out
}
