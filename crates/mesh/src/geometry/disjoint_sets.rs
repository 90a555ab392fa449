//! Disjoint sets (union-find).

/// Partition of `0..n` with union; the smallest member of a set is its root.
#[derive(Clone, Debug)]
pub struct DisjointSets(Vec<u32>);

impl DisjointSets {
    /// Returns `n` sets of one element each.
    pub fn new(n: usize) -> Self {
        Self((0..n as u32).collect())
    }

    /// Adds a number in a set of its own.
    #[inline]
    pub fn push(&mut self) -> u32 {
        let new = self.0.len() as u32;
        self.0.push(new);
        new
    }

    /// Number of elements.
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// Returns `true` if there are no numbers.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Smallest number in the set of `i`, with path compression.
    #[inline]
    pub fn root(&mut self, mut i: u32) -> u32 {
        while self.0[i as usize] != i {
            let above = self.0[self.0[i as usize] as usize];
            self.0[i as usize] = above;
            i = above;
        }
        i
    }

    /// Smallest number in the set of `i`, without path compression.
    #[inline]
    pub fn find(&self, mut i: u32) -> u32 {
        while self.0[i as usize] != i {
            i = self.0[i as usize];
        }
        i
    }

    /// Joins the sets of two numbers.
    #[inline]
    pub fn join(&mut self, i: u32, j: u32) {
        let (i, j) = (self.root(i), self.root(j));
        self.0[i.max(j) as usize] = i.min(j);
    }

    /// Makes every element point at its root.
    pub fn flatten(&mut self) {
        for i in 0..self.0.len() {
            // Parents are smaller, so their path is short already.
            self.0[i] = self.0[self.0[i] as usize];
        }
    }

    /// Set index of each number; sets are numbered in the order of their roots.
    pub fn numbered(&mut self) -> Vec<u32> {
        self.flatten();
        let mut count = 0;
        let mut out: Vec<u32> = Vec::with_capacity(self.0.len());
        for (i, &root) in (0..).zip(&self.0) {
            out.push(if root == i { count } else { out[root as usize] });
            count += u32::from(root == i);
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_smallest_number_names_its_set() {
        let mut sets = DisjointSets::new(5);
        for [i, j] in [[4, 1], [3, 4], [1, 3]] {
            sets.join(i, j);
        }
        assert_eq!(sets.push(), 5);
        assert_eq!([0, 1, 2, 3, 4, 5].map(|i| sets.find(i)), [0, 1, 2, 1, 1, 5]);
        assert_eq!([0, 1, 2, 3, 4, 5].map(|i| sets.root(i)), [0, 1, 2, 1, 1, 5]);
        assert_eq!(sets.numbered(), [0, 1, 2, 1, 1, 3]);
        assert_eq!(sets.len(), 6);
    }
}
