//! Cache of failed searches for a vertex position. The same stars are searched repeatedly for less and less clearance.
//! While a star is unchanged, the last result tells if another search is worthwhile.

/// Search methods for the position of a vertex.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum PlacementMethod {
    /// Existing neighbors only.
    Corners,
    /// Neighbors, then points in the star.
    Points,
    /// Neighbors, then points in an enlarged cavity.
    Wider,
}

/// Search results for one vertex.
#[derive(Clone, Copy, Default)]
struct Known {
    /// Time of the last change of the star.
    changed: u32,
    /// Time of the last search by each method, and the upper bound on the clearance it found.
    places: [(u32, f64); 3],
    /// Time of the last search for a better position.
    relaxed: u32,
}

/// Search results for all vertices. Time is counted in changes.
#[derive(Clone, Default)]
pub(super) struct Looks {
    now: u32,
    /// Results from before this time are forgotten.
    since: u32,
    known: Vec<Known>,
}

impl Looks {
    /// Forgets all results.
    pub(super) fn forget(&mut self) {
        self.now += 1;
        self.since = self.now;
    }

    /// Marks the stars of the given corners as changed.
    pub(super) fn change(&mut self, corners: impl Iterator<Item = u32>) {
        self.now += 1;
        let now = self.now;
        for v in corners {
            self.of(v).changed = now;
        }
    }

    /// True if a position with clearance of at least `least` may exist.
    pub(super) fn worth(&mut self, v: u32, least: f64, way: PlacementMethod) -> bool {
        let since = self.since;
        let known = self.of(v);
        let (when, room) = known.places[way as usize];
        when <= known.changed.max(since) || room >= least
    }

    /// Records that no position has more clearance than `room`.
    pub(super) fn found(&mut self, v: u32, room: f64, way: PlacementMethod) {
        let now = self.now + 1;
        self.of(v).places[way as usize] = (now, room);
    }

    /// True if a better position may exist. Records a search.
    pub(super) fn worth_relaxing(&mut self, v: u32) -> bool {
        let (now, since) = (self.now + 1, self.since);
        let known = self.of(v);
        std::mem::replace(&mut known.relaxed, now) <= known.changed.max(since)
    }

    fn of(&mut self, v: u32) -> &mut Known {
        let v = v as usize;
        if v >= self.known.len() {
            self.known.resize(v + 1 + v / 2, Known::default());
        }
        &mut self.known[v]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_search_that_failed_is_repeated_after_a_change_or_for_less() {
        let (mut looks, way) = (Looks::default(), PlacementMethod::Points);
        assert!(looks.worth(5, 0.1, way));
        looks.found(5, 0.01, way);
        assert!(!looks.worth(5, 0.1, way) && looks.worth(5, 0.01, way) && looks.worth(5, 0.001, way));
        assert!(looks.worth(5, 0.1, PlacementMethod::Wider) && looks.worth(4, 0.1, way));
        looks.change([4, 6].into_iter());
        assert!(!looks.worth(5, 0.1, way));
        looks.change([5].into_iter());
        assert!(looks.worth(5, 0.1, way));
        looks.found(5, 0.01, way);
        assert!(!looks.worth(5, 0.1, way));
        looks.forget();
        assert!(looks.worth(5, 0.1, way));
        looks.found(5, 0.01, way);
        assert!(!looks.worth(5, 0.1, way));
    }

    #[test]
    fn a_vertex_moves_once_for_each_change() {
        let mut looks = Looks::default();
        assert_eq!([looks.worth_relaxing(3), looks.worth_relaxing(3)], [true, false]);
        looks.change([3].into_iter());
        assert_eq!([looks.worth_relaxing(3), looks.worth_relaxing(3)], [true, false]);
        looks.change([2].into_iter());
        assert!(!looks.worth_relaxing(3));
        looks.forget();
        assert_eq!([looks.worth_relaxing(3), looks.worth_relaxing(3)], [true, false]);
    }
}
