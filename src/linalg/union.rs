//! Sets of numbers that are united.

/// Disjoint sets of the numbers below a count; the least number of a set is its root.
pub(crate) struct Union(Vec<usize>);

impl Union {
    /// Sets of one number each, below `count`.
    pub fn new(count: usize) -> Self {
        Self((0..count).collect())
    }

    /// The root of the set of a number.
    pub fn root(&mut self, mut i: usize) -> usize {
        while self.0[i] != i {
            self.0[i] = self.0[self.0[i]];
            i = self.0[i];
        }
        i
    }

    /// Makes the sets of both one.
    pub fn unite(&mut self, a: usize, b: usize) {
        let (a, b) = (self.root(a), self.root(b));
        self.0[a.max(b)] = a.min(b);
    }

    /// Consecutive numbers of the sets in the order of their roots, one per number, and the count of the sets.
    pub fn numbers(mut self) -> (Vec<usize>, usize) {
        let mut count = 0;
        let mut number = vec![0; self.0.len()];
        for i in 0..self.0.len() {
            let root = self.root(i);
            if root == i {
                number[i] = count;
                count += 1;
            } else {
                number[i] = number[root];
            }
        }
        (number, count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sets_are_numbered_by_their_least_numbers() {
        let mut sets = Union::new(7);
        for (a, b) in [(5, 1), (6, 5), (0, 3), (3, 0)] {
            sets.unite(a, b);
        }
        assert_eq!([6, 3, 4].map(|i| sets.root(i)), [1, 0, 4]);
        assert_eq!(sets.numbers(), (vec![0, 1, 2, 0, 3, 1, 1], 4));
    }
}
