//! Elements in the order of reading, and their conversion to blocks and groups.

use super::kinds::ElementType;
use super::scan::Source;
use crate::budget::Budget;
use crate::{FileError, Group, MeshBlock};
use std::collections::BTreeMap;

/// Approximate memory of a small list or an entry of a map beside its items \[bytes\].
const ENTRY: u64 = 256;

/// Elements of one type.
#[derive(Debug)]
pub(super) struct Bucket {
    pub number: i64,
    pub kind: ElementType,
    pub nodes: Vec<u32>,
    pub ids: Vec<u64>,
    /// First element and key of every run of elements with the same key.
    runs: Vec<(usize, i64)>,
}

impl Bucket {
    pub fn new(number: i64, kind: ElementType) -> Self {
        Self { number, kind, nodes: Vec::new(), ids: Vec::new(), runs: Vec::new() }
    }

    /// Starts a run: the elements that follow belong to `key`.
    pub fn start_run(&mut self, key: i64, budget: &mut Budget) -> Result<(), FileError> {
        match self.runs.last_mut() {
            Some((_, last)) if *last == key => {}
            Some((first, last)) if *first == self.ids.len() => *last = key,
            _ => {
                budget.room(&mut self.runs, 1)?;
                self.runs.push((self.ids.len(), key));
            }
        }
        Ok(())
    }

    fn bytes(&self) -> u64 {
        (self.nodes.capacity() * 4 + self.ids.capacity() * 8 + self.runs.capacity() * 16) as u64
    }
}

/// Numbers of the groups of entities.
#[derive(Debug, Default)]
pub(super) struct Entities {
    /// Dimension, number, and the place and count in `groups`.
    pub list: Vec<(usize, i64, usize, usize)>,
    pub groups: Vec<i64>,
}

impl Entities {
    /// Reads the section of version 4: of every entity its number, its box, its groups and its bounds.
    pub fn read<S: Source>(&mut self, source: &mut S, budget: &mut Budget) -> Result<(), FileError> {
        let mut counts = [0; 4];
        for count in &mut counts {
            *count = source.size()?;
        }
        for (dimension, count) in counts.into_iter().enumerate() {
            for _ in 0..count {
                let number = source.int()?;
                for _ in 0..if dimension == 0 { 3 } else { 6 } {
                    source.real()?;
                }
                let first = self.groups.len();
                for _ in 0..source.size()? {
                    let group = source.int()?;
                    budget.room(&mut self.groups, 1)?;
                    self.groups.push(group);
                }
                if dimension > 0 {
                    for _ in 0..source.size()? {
                        source.int()?;
                    }
                }
                let groups = self.groups.len() - first;
                if groups > 0 {
                    budget.room(&mut self.list, 1)?;
                    self.list.push((dimension, number, first, groups));
                }
            }
        }
        self.list.sort_unstable();
        if let Some(pair) = self.list.windows(2).find(|w| (w[0].0, w[0].1) == (w[1].0, w[1].1)) {
            return Err(source.broken(format!("entity {} of dimension {} stands twice", pair[0].1, pair[0].0)));
        }
        Ok(())
    }

    /// Numbers of the groups of an entity; empty if it is not listed. The list must be sorted.
    fn groups_of(&self, dimension: usize, number: i64) -> &[i64] {
        match self.list.binary_search_by_key(&(dimension, number), |e| (e.0, e.1)) {
            Ok(k) => &self.groups[self.list[k].2..][..self.list[k].3],
            Err(_) => &[],
        }
    }
}

/// Meaning of the key of a run.
#[derive(Clone, Copy, Debug)]
pub(super) enum Keys<'a> {
    /// A group, zero for none; an element is listed once for each of its groups.
    Group,
    /// An entity.
    Entity(&'a Entities),
}

/// Returns the blocks, sorted by shape, order and groups; the groups, sorted by dimension and number; the number of repeated elements.
pub(super) fn finish(
    buckets: Vec<Bucket>,
    names: BTreeMap<(usize, i64), String>,
    keys: Keys<'_>,
    budget: &mut Budget,
) -> Result<(Vec<MeshBlock>, Vec<Group>, usize), FileError> {
    let numbers = |bucket: &Bucket, key: i64| -> Vec<i64> {
        match keys {
            // a negative number means the elements run against their entity
            Keys::Group => {
                if key == 0 {
                    Vec::new()
                } else {
                    vec![key.saturating_abs()]
                }
            }
            Keys::Entity(entities) => {
                let mut list: Vec<i64> =
                    entities.groups_of(bucket.kind.shape.dimension(), key).iter().map(|n| n.saturating_abs()).collect();
                list.sort_unstable();
                list.dedup();
                list
            }
        }
    };
    let mut known: BTreeMap<(usize, i64), usize> = names.keys().map(|k| (*k, 0)).collect();
    let mut resolved: Vec<BTreeMap<i64, Vec<i64>>> = Vec::new();
    for bucket in &buckets {
        let mut own = BTreeMap::new();
        for &(_, key) in &bucket.runs {
            if let std::collections::btree_map::Entry::Vacant(entry) = own.entry(key) {
                let list = numbers(bucket, key);
                budget.take(ENTRY + 64 * list.len() as u64)?;
                for n in &list {
                    known.entry((bucket.kind.shape.dimension(), *n)).or_insert(0);
                }
                entry.insert(list);
            }
        }
        resolved.push(own);
    }
    known.values_mut().enumerate().for_each(|(place, v)| *v = place);
    let mut names = names;
    let groups = known.keys().map(|k| Group { dimension: k.0, number: k.1, name: names.remove(k) }).collect();

    let mut blocks = Vec::new();
    let mut twice = 0;
    for (bucket, own) in buckets.into_iter().zip(resolved) {
        let dimension = bucket.kind.shape.dimension();
        let mut sets = Sets::default();
        let places = |list: &[i64]| -> Vec<usize> { list.iter().map(|n| known[&(dimension, *n)]).collect() };
        let set_of: BTreeMap<i64, usize> = own.iter().map(|(key, list)| (*key, sets.place(places(list)))).collect();
        let mut runs: Vec<(usize, Option<usize>)> = Vec::new();
        let merged = if matches!(keys, Keys::Group) && own.len() > 1 { copies(&bucket, budget)? } else { Vec::new() };
        if merged.is_empty() {
            budget.room(&mut runs, bucket.runs.len())?;
            runs.extend(bucket.runs.iter().map(|(first, key)| (*first, Some(set_of[key]))));
        } else {
            twice += merge(&bucket, &merged, &set_of, &mut sets, &mut runs, budget)?;
        }
        split(bucket, &runs, sets, &mut blocks, budget)?;
    }
    blocks.sort_by(|a, b| (a.shape, a.order, &a.groups).cmp(&(b.shape, b.order, &b.groups)));
    Ok((blocks, groups, twice))
}

/// Sets of groups with a number each.
#[derive(Debug, Default)]
struct Sets {
    numbers: BTreeMap<Vec<usize>, usize>,
}

impl Sets {
    fn place(&mut self, set: Vec<usize>) -> usize {
        let next = self.numbers.len();
        *self.numbers.entry(set).or_insert(next)
    }

    fn list(self) -> Vec<Vec<usize>> {
        let mut list = vec![Vec::new(); self.numbers.len()];
        self.numbers.into_iter().for_each(|(set, k)| list[k] = set);
        list
    }
}

/// Elements with the same nodes: lists of two or more, as pairs (number of the list, element), sorted.
fn copies(bucket: &Bucket, budget: &mut Budget) -> Result<Vec<(u64, u32)>, FileError> {
    let n = bucket.kind.place.len();
    let sorted = |e: u32| {
        let mut nodes = bucket.nodes[e as usize * n..][..n].to_vec();
        nodes.sort_unstable();
        nodes
    };
    let mut pairs: Vec<(u64, u32)> = Vec::new();
    budget.room(&mut pairs, bucket.ids.len())?;
    let mut key = Vec::with_capacity(n);
    pairs.extend(bucket.nodes.chunks_exact(n).zip(0u32..).map(|(nodes, e)| {
        key.clear();
        key.extend_from_slice(nodes);
        key.sort_unstable();
        // any mixing will do: equal sums are compared node by node
        let hash = key.iter().fold(0u64, |h, v| (h.rotate_left(5) ^ u64::from(*v)).wrapping_mul(0x517c_c1b7_2722_0a95));
        (hash, e)
    }));
    pairs.sort_unstable();
    let mut found = Vec::new();
    let mut lists = 0;
    for run in pairs.chunk_by_mut(|a, b| a.0 == b.0).filter(|run| run.len() > 1) {
        run.sort_by_cached_key(|pair| (sorted(pair.1), pair.1));
        for same in run.chunk_by(|a, b| sorted(a.1) == sorted(b.1)).filter(|same| same.len() > 1) {
            budget.room(&mut found, same.len())?;
            found.extend(same.iter().map(|pair| (lists, pair.1)));
            lists += 1;
        }
    }
    budget.give(16 * pairs.capacity() as u64);
    Ok(found)
}

/// Runs in which the first of equal elements has all their groups and the others none; number of elements repeated within one group.
fn merge(
    bucket: &Bucket,
    copies: &[(u64, u32)],
    set_of: &BTreeMap<i64, usize>,
    sets: &mut Sets,
    runs: &mut Vec<(usize, Option<usize>)>,
    budget: &mut Budget,
) -> Result<usize, FileError> {
    let mut own: Vec<Option<usize>> = Vec::new();
    budget.room(&mut own, bucket.ids.len())?;
    let ends = bucket.runs.iter().skip(1).map(|r| r.0).chain([bucket.ids.len()]);
    for ((first, key), end) in bucket.runs.iter().zip(ends) {
        own.extend(std::iter::repeat_n(Some(set_of[key]), end - first));
    }
    let plain: BTreeMap<usize, Vec<usize>> = sets.numbers.iter().map(|(set, k)| (*k, set.clone())).collect();
    let mut twice = 0;
    for same in copies.chunk_by(|a, b| a.0 == b.0) {
        let mut union: Vec<usize> = same.iter().flat_map(|p| own[p.1 as usize].map_or(&[][..], |k| &plain[&k])).copied().collect();
        union.sort_unstable();
        let all = union.len();
        union.dedup();
        twice += usize::from(union.len() < all || all < same.len());
        budget.take(8 * union.len() as u64)?;
        same.iter().for_each(|p| own[p.1 as usize] = None);
        own[same[0].1 as usize] = Some(sets.place(union));
    }
    for (e, set) in own.iter().enumerate() {
        if runs.last().is_none_or(|last| last.1 != *set) {
            budget.room(runs, 1)?;
            runs.push((e, *set));
        }
    }
    budget.give(16 * own.capacity() as u64);
    Ok(twice)
}

/// One block per set of groups.
fn split(
    bucket: Bucket,
    runs: &[(usize, Option<usize>)],
    sets: Sets,
    blocks: &mut Vec<MeshBlock>,
    budget: &mut Budget,
) -> Result<(), FileError> {
    let (shape, order, n, count) = (bucket.kind.shape, bucket.kind.order, bucket.kind.place.len(), bucket.ids.len());
    let lists = sets.list();
    if let [(_, Some(set)), rest @ ..] = runs
        && rest.iter().all(|r| r.1 == Some(*set))
    {
        blocks.push(MeshBlock { shape, order, nodes: bucket.nodes, ids: bucket.ids, groups: lists[*set].clone() });
        return Ok(());
    }
    let spans = || runs.iter().zip(runs.iter().skip(1).map(|r| r.0).chain([count])).filter_map(|(r, end)| r.1.map(|s| (s, r.0..end)));
    let mut sizes = vec![0; lists.len()];
    spans().for_each(|(set, span)| sizes[set] += span.len());
    let mut parts: Vec<(Vec<u32>, Vec<u64>)> = Vec::new();
    for size in &sizes {
        budget.take(ENTRY)?;
        let mut part = (Vec::new(), Vec::new());
        budget.room(&mut part.0, size * n)?;
        budget.room(&mut part.1, *size)?;
        parts.push(part);
    }
    for (set, span) in spans() {
        parts[set].0.extend_from_slice(&bucket.nodes[span.start * n..span.end * n]);
        parts[set].1.extend_from_slice(&bucket.ids[span]);
    }
    budget.give(bucket.bytes());
    let full = lists.into_iter().zip(parts).filter(|(_, part)| !part.1.is_empty());
    blocks.extend(full.map(|(groups, (nodes, ids))| MeshBlock { shape, order, nodes, ids, groups }));
    Ok(())
}
