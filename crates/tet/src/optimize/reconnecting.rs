//! Reconnection of small cavities within the improver.

use super::Improver;
use super::reconnect::{Reconnection, Room};

impl Improver<'_> {
    /// Reconnects a cavity of up to `size` tetrahedra around `t`. Returns false if nothing better was found within
    /// `nodes` steps of the search.
    pub(super) fn reconnect(&mut self, t: u32, size: usize, nodes: usize) -> bool {
        let mut r = std::mem::take(&mut self.reconnection);
        let done = self.reconnect_with(&mut r, t, size, nodes);
        self.reconnection = r;
        done
    }

    fn reconnect_with(&mut self, r: &mut Reconnection, t: u32, size: usize, nodes: usize) -> bool {
        let room = Room { c: &self.c, allowance: &self.allowance };
        let found = r.find(room, [t as usize, size, nodes], self.report.worst_before, |tets| self.strain_of(tets));
        if !found {
            return false;
        }
        let fixed = |v: &u32| self.options.keep_points || !self.movable[*v as usize];
        let all = r.vertices.iter().filter(|v| fixed(v)).all(|v| r.new.iter().any(|t| t.contains(v)));
        let positive = r.new.iter().all(|v| self.score(v).is_some());
        if !all || !positive || !self.eases(&r.tets, &r.new) || !self.c.replace(&r.tets, &r.new, &mut r.created) {
            return false;
        }
        self.remeasure(&r.created);
        true
    }
}
