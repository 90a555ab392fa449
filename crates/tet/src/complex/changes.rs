//! Record of changes of a complex, to keep them or to take them back.

use super::Complex;
use super::undo::Change;
use anastomesh_mesh::geometry::Point3;

impl Complex {
    /// Records all further changes, until [`Complex::keep_changes`] or [`Complex::undo_changes`].
    pub(crate) fn record(&mut self) {
        self.log.changes.clear();
        self.log.recording = true;
    }

    /// Ends the record. Returns the number of changes.
    pub(crate) fn keep_changes(&mut self) -> usize {
        let count = self.log.changes.len();
        self.log.changes.clear();
        self.log.recording = false;
        count
    }

    /// Takes back all recorded changes, with all slots, and ends the record. Returns the number of changes.
    pub(crate) fn undo_changes(&mut self) -> usize {
        let changes = std::mem::take(&mut self.log.changes);
        self.log.recording = false;
        for change in changes.iter().rev() {
            match *change {
                Change::Slot(t, cell, frozen) => {
                    self.cells[t as usize] = cell;
                    self.frozen[t as usize] = frozen;
                }
                Change::SlotAdded => {
                    self.cells.pop();
                    self.frozen.pop();
                }
                Change::Freed => {
                    self.free.pop();
                }
                Change::Taken(t) => self.free.push(t),
                Change::VertexTet(v, t) => self.vertex_tet[v as usize] = t,
                Change::Position(v, p) => self.points[v as usize] = p,
                Change::PointAdded => {
                    self.points.pop();
                    self.vertex_tet.pop();
                }
                Change::PointRemoved(p, t) => {
                    self.points.push(p);
                    self.vertex_tet.push(t);
                }
            }
        }
        changes.len()
    }

    /// Moves a vertex.
    pub(crate) fn move_point(&mut self, v: u32, p: Point3) {
        let before = std::mem::replace(&mut self.points[v as usize], p);
        self.note(Change::Position(v, before));
    }

    #[inline]
    fn note(&mut self, change: Change) {
        if self.log.recording {
            self.log.changes.push(change);
        }
    }

    /// To be called before a slot changes.
    #[inline]
    pub(super) fn note_slot(&mut self, t: u32) {
        if self.log.recording {
            self.log.changes.push(Change::Slot(t, self.cells[t as usize], self.frozen[t as usize]));
        }
    }

    #[inline]
    pub(super) fn note_slot_added(&mut self) {
        self.note(Change::SlotAdded);
    }

    #[inline]
    pub(super) fn note_freed(&mut self) {
        self.note(Change::Freed);
    }

    #[inline]
    pub(super) fn note_taken(&mut self, t: u32) {
        self.note(Change::Taken(t));
    }

    /// To be called before the tetrahedron of a vertex changes.
    #[inline]
    pub(super) fn note_vertex(&mut self, v: u32) {
        if self.log.recording {
            self.log.changes.push(Change::VertexTet(v, self.vertex_tet[v as usize]));
        }
    }

    pub(super) fn note_point_added(&mut self) {
        self.note(Change::PointAdded);
    }

    /// To be called before the last point is removed.
    pub(super) fn note_point_removed(&mut self) {
        if let (true, Some(&p), Some(&t)) = (self.log.recording, self.points.last(), self.vertex_tet.last()) {
            self.log.changes.push(Change::PointRemoved(p, t));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::delaunay::delaunay;
    use crate::flips::Flipper;
    use anastomesh_mesh::shapes::sphere_surface;

    /// All content of a complex.
    fn content(c: &Complex) -> String {
        format!("{:?} {:?} {:?} {:?} {:?}", c.points, c.cells, c.frozen, c.free, c.vertex_tet)
    }

    #[test]
    fn undone_changes_restore_everything() {
        let mut c = delaunay(&sphere_surface(2).points).unwrap();
        let mut flipper = Flipper::default();
        let positive = |c: &Complex, v: &[u32; 4]| (c.orient(v) > 0.0).then_some(1.0);
        let mut made = Vec::new();
        for round in 0..3 {
            let before = content(&c);
            c.record();
            let faces = 4 * c.slots() as u32;
            for half in (0..faces).filter(|half| half % 3 == round) {
                if c.is_real(half >> 2) && flipper.plan_face(&c, half, positive).is_ok() {
                    flipper.commit(&mut c).unwrap();
                }
            }
            let t = c.real_tets().next().unwrap();
            let v = c.verts(t);
            c.freeze(4 * t);
            let p = Point3::from(
                v.map(|v| c.points[v as usize].coords).iter().sum::<anastomesh_mesh::geometry::Vec3>() / 4.0,
            );
            let new = c.add_point(p);
            c.add_point(p);
            c.pop_point();
            let faces: Vec<[u32; 4]> = (0..4).map(|i| c.face(4 * t + i)).map(|[a, b, d]| [a, d, b, new]).collect();
            assert!(c.replace(&[t], &faces, &mut made));
            c.move_point(new, p + (c.points[v[0] as usize] - p) * 0.1);
            c.sanity_check().unwrap();
            assert!(content(&c) != before);
            if round == 2 {
                assert!(c.keep_changes() > 0);
                assert_eq!(c.undo_changes(), 0);
                assert!(content(&c) != before);
            } else {
                assert!(c.undo_changes() > 0);
                assert_eq!(content(&c), before);
            }
        }
        c.sanity_check().unwrap();
    }
}
