//! Bit sets of mesh points.

/// Set of points, one bit each.
pub struct Bits {
    words: Vec<u64>,
    points: usize,
}

impl Bits {
    /// Creates an empty set of points below `points`.
    pub fn new(points: usize) -> Self {
        Self { words: vec![0; points.div_ceil(64)], points }
    }

    /// Inserts a point. Returns false if the point does not exist.
    #[inline]
    pub fn insert(&mut self, v: u32) -> bool {
        let there = (v as usize) < self.points;
        if let Some(word) = self.words.get_mut(v as usize / 64).filter(|_| there) {
            *word |= 1 << (v % 64);
        }
        there
    }

    /// True if the set contains a point.
    #[inline]
    pub fn has(&self, v: u32) -> bool {
        self.words.get(v as usize / 64).is_some_and(|word| word >> (v % 64) & 1 == 1)
    }

    /// Number of points in the set.
    pub fn count(&self) -> usize {
        self.words.iter().map(|word| word.count_ones() as usize).sum()
    }

    /// Removes all points.
    pub fn clear(&mut self) {
        self.words.fill(0);
    }

    /// Replaces the set by its complement.
    pub fn invert(&mut self) {
        self.words.iter_mut().for_each(|word| *word = !*word);
        if let Some(last) = self.words.last_mut().filter(|_| !self.points.is_multiple_of(64)) {
            *last &= (1 << (self.points % 64)) - 1;
        }
    }

    /// Adds all points of a set of the same size.
    pub fn unite(&mut self, other: &Self) {
        self.words.iter_mut().zip(&other.words).for_each(|(word, more)| *word |= more);
    }

    /// Points of the set, ascending.
    pub fn ids(&self) -> Vec<u32> {
        let mut ids = Vec::with_capacity(self.count());
        for (i, &word) in self.words.iter().enumerate() {
            let mut word = word;
            while word != 0 {
                ids.push(64 * i as u32 + word.trailing_zeros());
                word &= word - 1;
            }
        }
        ids
    }

    /// Number of points of the set before each word.
    pub fn ranks(&self) -> Ranks<'_> {
        let mut sum = 0;
        let before = self.words.iter().map(|word| {
            sum += word.count_ones();
            sum - word.count_ones()
        });
        Ranks { before: before.collect(), words: &self.words }
    }
}

/// Numbers the points of a set.
pub struct Ranks<'a> {
    words: &'a [u64],
    before: Vec<u32>,
}

impl Ranks<'_> {
    /// Number of points of the set below `v`, which is the index of a point in the set.
    #[inline]
    pub fn rank(&self, v: u32) -> u32 {
        let (word, bit) = (v as usize / 64, v % 64);
        let here = self.words.get(word).map_or(0, |word| (word & ((1 << bit) - 1)).count_ones());
        self.before.get(word).map_or(0, |before| before + here)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sets_of_points() {
        let mut bits = Bits::new(130);
        for v in [129, 0, 64, 63, 64] {
            assert!(bits.insert(v));
        }
        assert!(!bits.insert(130) && !bits.has(130) && !bits.has(1) && bits.has(129));
        assert_eq!((bits.ids(), bits.count()), (vec![0, 63, 64, 129], 4));
        let ranks = bits.ranks();
        assert_eq!([0, 63, 64, 129, 100].map(|v| ranks.rank(v)), [0, 1, 2, 3, 3]);
        bits.invert();
        assert_eq!(bits.count(), 126);
        let mut all = bits;
        all.insert(0);
        let mut rest = Bits::new(130);
        assert_eq!([63, 64, 129].map(|v| rest.insert(v)), [true; 3]);
        all.unite(&rest);
        assert_eq!(all.count(), 130);
        all.clear();
        assert_eq!(all.count(), 0);
    }
}
