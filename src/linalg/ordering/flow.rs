//! Maximum flow through a small network.

use super::index;

/// A network for maximum flow (Dinic: shortest augmenting paths, all of one length at a time).
pub(super) struct Network {
    first: Vec<u32>,
    next: Vec<u32>,
    to: Vec<u32>,
    /// What each arc still lets through; arc k and k ^ 1 are each other's reverse.
    room: Vec<u32>,
    level: Vec<u32>,
}

impl Network {
    pub(super) fn new(nodes: usize) -> Self {
        Self { first: vec![u32::MAX; nodes], next: Vec::new(), to: Vec::new(), room: Vec::new(), level: vec![u32::MAX; nodes] }
    }

    pub(super) fn arc(&mut self, from: usize, to: usize, room: u32) {
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

    pub(super) fn saturate(&mut self, source: usize, sink: usize) {
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

    pub(super) fn reached(&mut self, source: usize) -> Vec<bool> {
        self.search(source);
        self.level.iter().map(|&l| l != u32::MAX).collect()
    }
}
