//! Maximum flow through a small network.

use super::parts::index;

/// A network for maximum flow (Dinic: shortest augmenting paths, all of one length at a time).
pub(super) struct Network {
    /// Arcs of node a: `first[a]..first[a + 1]`.
    first: Vec<u32>,
    to: Vec<u32>,
    /// Residual capacity of each arc.
    room: Vec<u32>,
    /// The reverse of each arc.
    back: Vec<u32>,
    level: Vec<u32>,
    queue: Vec<u32>,
}

/// An arc: from, to, capacity.
pub(super) type Arc = (u32, u32, u32);

impl Network {
    pub(super) fn new(nodes: usize, arcs: &[Arc]) -> Self {
        let mut first = vec![0u32; nodes + 1];
        for &(a, b, _) in arcs {
            first[a as usize + 1] += 1;
            first[b as usize + 1] += 1;
        }
        for a in 0..nodes {
            first[a + 1] += first[a];
        }
        let (mut place, count) = (first.clone(), 2 * arcs.len());
        let (mut to, mut room, mut back) = (vec![0; count], vec![0; count], vec![0; count]);
        for &(a, b, most) in arcs {
            let [k, l] = [a, b].map(|node| {
                place[node as usize] += 1;
                place[node as usize] - 1
            });
            (to[k as usize], room[k as usize], back[k as usize]) = (b, most, l);
            (to[l as usize], room[l as usize], back[l as usize]) = (a, 0, k);
        }
        Self { first, to, room, back, level: vec![u32::MAX; nodes], queue: Vec::with_capacity(nodes) }
    }

    fn arcs(&self, a: usize) -> std::ops::Range<usize> {
        self.first[a] as usize..self.first[a + 1] as usize
    }

    /// Computes the levels of the nodes that `source` still reaches, up to the level of `sink`.
    fn search(&mut self, source: usize, sink: Option<usize>) {
        self.level.fill(u32::MAX);
        self.level[source] = 0;
        self.queue.clear();
        self.queue.push(index(source));
        let mut head = 0;
        while let Some(&a) = self.queue.get(head) {
            head += 1;
            let next = self.level[a as usize] + 1;
            for k in self.arcs(a as usize) {
                let b = self.to[k] as usize;
                if self.room[k] > 0 && self.level[b] == u32::MAX {
                    self.level[b] = next;
                    if sink == Some(b) {
                        return;
                    }
                    self.queue.push(index(b));
                }
            }
        }
    }

    pub(super) fn saturate(&mut self, source: usize, sink: usize) {
        loop {
            self.search(source, Some(sink));
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
                        let (k, back) = (k as usize, self.back[k as usize] as usize);
                        // "without bound" stays so
                        if self.room[k] != u32::MAX {
                            self.room[k] -= flow;
                        }
                        if self.room[back] != u32::MAX {
                            self.room[back] += flow;
                        }
                        if self.room[k] == 0 {
                            cut = i;
                        }
                    }
                    path.truncate(cut);
                    continue;
                }
                let end = self.first[node + 1];
                let found = (current[node]..end).find(|&k| {
                    let b = self.to[k as usize] as usize;
                    self.room[k as usize] > 0 && self.level[b] == self.level[node] + 1
                });
                current[node] = found.unwrap_or(end);
                if let Some(k) = found {
                    path.push(k);
                } else if let Some(dead) = path.pop() {
                    let from = self.to[self.back[dead as usize] as usize] as usize;
                    current[from] = dead + 1;
                } else {
                    break;
                }
            }
        }
    }

    pub(super) fn reached(&mut self, source: usize) -> Vec<bool> {
        self.search(source, None);
        self.level.iter().map(|&l| l != u32::MAX).collect()
    }
}
