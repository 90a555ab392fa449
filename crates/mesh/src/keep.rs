//! Renumbering after removal: the remaining items keep their order.

use super::TetMesh;

/// New numbers of the items that stay.
#[derive(Clone, Debug)]
pub struct Kept {
    /// New number of each item, or `u32::MAX`.
    pub number: Vec<u32>,
    count: u32,
}

impl Kept {
    /// Keeps the items marked true, in order.
    pub fn of(stays: impl IntoIterator<Item = bool>) -> Self {
        let mut count = 0;
        let mut number = |stays: bool| {
            if !stays {
                return u32::MAX;
            }
            count += 1;
            count - 1
        };
        let number = stays.into_iter().map(&mut number).collect();
        Self { number, count }
    }

    /// Keeps the first `fixed` points, and all points of cells.
    pub fn used<'a, const N: usize>(
        cells: impl IntoIterator<Item = &'a [u32; N]>,
        points: usize,
        fixed: usize,
    ) -> Self {
        let mut used = vec![false; points];
        used[..fixed.min(points)].fill(true);
        for &v in cells.into_iter().flatten() {
            used[v as usize] = true;
        }
        Self::of(used)
    }

    /// A cell with its vertices renumbered.
    pub fn cell<const N: usize>(&self, cell: &[u32; N]) -> [u32; N] {
        cell.map(|v| self.number[v as usize])
    }

    /// Properties of the items that stay.
    pub fn select<T: Copy>(&self, all: &[T]) -> Vec<T> {
        let mut kept = Vec::with_capacity(self.count as usize);
        kept.extend(all.iter().zip(&self.number).filter(|(_, n)| **n != u32::MAX).map(|(thing, _)| *thing));
        kept
    }
}

impl TetMesh {
    /// Drops unused points from index `fixed` on, keeping the order of the others.
    pub fn drop_unused_points(&mut self, fixed: usize) {
        let used = Kept::used(&self.tets, self.points.len(), fixed);
        self.points = used.select(&self.points);
        for tet in &mut self.tets {
            *tet = used.cell(tet);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_stays_keeps_its_order() {
        let kept = Kept::used(&[[4, 2], [2, 6]], 7, 1);
        assert_eq!(kept.select(&['a', 'b', 'c', 'd', 'e', 'f', 'g']), ['a', 'c', 'e', 'g']);
        assert_eq!(kept.cell(&[6, 0, 4]), [3, 0, 2]);
        assert_eq!(kept.number[1], u32::MAX);
    }
}
