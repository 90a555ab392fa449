//! Undo journal of flips. A search that fails restores the complex with all slots, so that lists of tetrahedra and
//! crossings stay valid.

use crate::complex::Complex;
use crate::flips::{Flipper, Refusal};

/// Flips made, in order.
#[derive(Clone, Debug, Default)]
pub(super) struct Journal {
    /// Removed tetrahedra of all flips.
    old: Vec<[u32; 4]>,
    /// Created slots of all flips.
    created: Vec<u32>,
    /// Lengths of both lists before each flip.
    starts: Vec<(usize, usize)>,
}

impl Journal {
    /// Number of flips.
    pub(super) fn len(&self) -> usize {
        self.starts.len()
    }

    /// Forgets all flips.
    pub(super) fn clear(&mut self) {
        self.old.clear();
        self.created.clear();
        self.starts.clear();
    }

    /// Makes the flip that `flipper` has planned, and records it.
    ///
    /// # Errors
    /// See [`Flipper::commit`].
    pub(super) fn commit(&mut self, c: &mut Complex, flipper: &mut Flipper) -> Result<(), Refusal> {
        let start = (self.old.len(), self.created.len());
        self.old.extend(flipper.removed_tets().iter().map(|&t| c.verts(t)));
        let done = flipper.commit(c);
        if done.is_ok() {
            self.created.extend_from_slice(flipper.created());
            self.starts.push(start);
        } else {
            self.old.truncate(start.0);
        }
        done
    }

    /// Undoes all flips after the first `count`. Slots are freed and allocated in reverse order, so that each
    /// tetrahedron returns to its slot.
    pub(super) fn undo_to(&mut self, c: &mut Complex, count: usize) {
        let mut slots = Vec::new();
        while self.starts.len() > count {
            let Some((old, created)) = self.starts.pop() else { return };
            self.created[created..].reverse();
            self.old[old..].reverse();
            let fits = c.replace(&self.created[created..], &self.old[old..], &mut slots);
            debug_assert!(fits, "a flip can be undone");
            self.old.truncate(old);
            self.created.truncate(created);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::complex::Complex;
    use anastomesh_mesh::shapes::sphere_surface;

    #[test]
    fn undone_flips_restore_every_slot() {
        let points = sphere_surface(2).points;
        let mut c = crate::delaunay::delaunay(&points).unwrap();
        let cells = |c: &Complex| (0..c.slots() as u32).map(|t| (c.is_alive(t), c.verts(t))).collect::<Vec<_>>();
        let before = cells(&c);
        let (mut journal, mut flipper) = (Journal::default(), Flipper::default());
        let positive = |c: &Complex, v: &[u32; 4]| (c.orient(v) > 0.0).then_some(1.0);
        for half in 0..4 * before.len() as u32 {
            if c.is_real(half >> 2) && flipper.plan_face(&c, half, positive).is_ok() {
                journal.commit(&mut c, &mut flipper).unwrap();
            }
        }
        assert!(journal.len() > 20);
        journal.undo_to(&mut c, 10);
        journal.undo_to(&mut c, 0);
        c.sanity_check().unwrap();
        let after = cells(&c);
        assert_eq!(after[..before.len()], before);
        assert!(after[before.len()..].iter().all(|(alive, _)| !alive));
    }
}
