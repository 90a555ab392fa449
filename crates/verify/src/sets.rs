//! Disjoint sets of numbers.

/// Partition of the numbers from 0.
pub struct Sets(Vec<u32>);

impl Sets {
    /// Sets of one number each.
    pub fn new(count: usize) -> Self {
        Self((0..count as u32).collect())
    }

    fn root(&mut self, mut i: u32) -> u32 {
        while self.0[i as usize] != i {
            let up = self.0[self.0[i as usize] as usize];
            self.0[i as usize] = up;
            i = up;
        }
        i
    }

    /// Joins the sets of two numbers.
    pub fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.root(a), self.root(b));
        self.0[a.max(b) as usize] = a.min(b);
    }

    /// Number of the set of each number, in order of first members, and the number of sets.
    pub fn numbered(mut self) -> (Vec<u32>, u32) {
        let (mut numbers, mut count) = (Vec::with_capacity(self.0.len()), 0);
        for i in 0..self.0.len() as u32 {
            let root = self.root(i);
            numbers.push(if root == i { count } else { numbers[root as usize] });
            count += u32::from(root == i);
        }
        (numbers, count)
    }

    /// Members of each set, in order of first members.
    pub fn groups(self) -> Vec<Vec<u32>> {
        let (numbers, count) = self.numbered();
        let mut groups = vec![Vec::new(); count as usize];
        (0..).zip(numbers).for_each(|(i, number)| groups[number as usize].push(i));
        groups
    }
}
