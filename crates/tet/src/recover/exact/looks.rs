//! What is known of the room around vertices. Their stars are looked at again and again for less and less room; as long
//! as they have not changed, what was found the last time tells whether that is worth it.

/// How a place for a vertex is looked for.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum PlacementMethod {
    /// At its neighbors.
    Corners,
    /// There, or anywhere in its star.
    Points,
    /// There, or in a wider cavity.
    Wider,
}

/// What is known of one vertex.
#[derive(Clone, Copy, Default)]
struct Known {
    /// When the star changed.
    changed: u32,
    /// When a place was looked for in each way, and the largest room that one may have.
    places: [(u32, f64); 3],
    /// When it was looked at for a better place.
    relaxed: u32,
}

/// What is known of all vertices. Times are counted in changes.
#[derive(Clone, Default)]
pub(super) struct Looks {
    now: u32,
    /// Before this nothing was known.
    since: u32,
    known: Vec<Known>,
}

impl Looks {
    /// Forgets everything.
    pub(super) fn forget(&mut self) {
        self.now += 1;
        self.since = self.now;
    }

    /// The stars of all corners of some faces change.
    pub(super) fn change(&mut self, corners: impl Iterator<Item = u32>) {
        self.now += 1;
        let now = self.now;
        for v in corners {
            self.of(v).changed = now;
        }
    }

    /// Whether there may be a place with at least `least` room for a vertex.
    pub(super) fn worth(&mut self, v: u32, least: f64, way: PlacementMethod) -> bool {
        let since = self.since;
        let known = self.of(v);
        let (when, room) = known.places[way as usize];
        when <= known.changed.max(since) || room >= least
    }

    /// There is no place with more than that much room for a vertex.
    pub(super) fn found(&mut self, v: u32, room: f64, way: PlacementMethod) {
        let now = self.now + 1;
        self.of(v).places[way as usize] = (now, room);
    }

    /// Whether a vertex may have a better place now; it is taken to be looked for.
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
