//! Sheets: two triangles back to back that enclose nothing. Both are removed, unless one is needed to close the
//! surface.
//!
//! A closed surface has an even number of triangles at each edge. If a sheet is alone with other triangles at an edge,
//! their number decides, and then perhaps the next sheet. Undecided sheets form a surface in which every triangle has a
//! reverse; they are kept if closed among themselves.

use rustc_hash::FxHashMap;

/// Triangles at an edge of a sheet.
#[derive(Default)]
struct Edge {
    /// Triangles that stay.
    kept: usize,
    /// Undecided sheets.
    open: Vec<u32>,
}

/// Marks the triangles that stay: all except `sheets`, and the sheets that close the surface. If nothing would be left,
/// all stay. No two triangles may have the same vertices.
pub(super) fn kept(triangles: &[[u32; 3]], sheets: &[u32]) -> Vec<bool> {
    let mut keep = vec![true; triangles.len()];
    if sheets.is_empty() {
        return keep;
    }
    let mut at = Sheets::new(triangles, sheets);
    at.decide_by_edges(sheets, &mut keep);
    at.decide_remaining(sheets, &mut keep);
    if !keep.contains(&true) {
        keep.fill(true);
    }
    keep
}

fn edges_of([a, b, c]: [u32; 3]) -> [[u32; 2]; 3] {
    [[a, b], [b, c], [c, a]].map(|[a, b]| [a.min(b), a.max(b)])
}

struct Sheets<'a> {
    triangles: &'a [[u32; 3]],
    edges: FxHashMap<[u32; 2], Edge>,
}

impl<'a> Sheets<'a> {
    fn new(triangles: &'a [[u32; 3]], sheets: &[u32]) -> Self {
        let mut edges: FxHashMap<[u32; 2], Edge> = FxHashMap::default();
        for &s in sheets {
            for e in edges_of(triangles[s as usize]) {
                edges.entry(e).or_default().open.push(s);
            }
        }
        let mut sheet = sheets.iter().copied().peekable();
        for (&t, _) in triangles.iter().zip(0_u32..).filter(|(_, i)| sheet.next_if_eq(i).is_none()) {
            for e in edges_of(t) {
                if let Some(edge) = edges.get_mut(&e) {
                    edge.kept += 1;
                }
            }
        }
        Self { triangles, edges }
    }

    fn edges(&self, sheet: u32) -> impl Iterator<Item = &Edge> {
        edges_of(self.triangles[sheet as usize]).into_iter().filter_map(|e| self.edges.get(&e))
    }

    /// Decision of an edge without other open sheets, if the sheet has one.
    fn verdict(&self, sheet: u32) -> Option<bool> {
        self.edges(sheet).find(|edge| edge.open.len() == 1).map(|edge| edge.kept % 2 == 1)
    }

    fn decide(&mut self, sheet: u32, stays: bool) {
        for e in edges_of(self.triangles[sheet as usize]) {
            if let Some(edge) = self.edges.get_mut(&e) {
                edge.open.retain(|&s| s != sheet);
                edge.kept += usize::from(stays);
            }
        }
    }

    fn is_open(&self, sheet: u32) -> bool {
        self.edges(sheet).any(|edge| edge.open.contains(&sheet))
    }

    /// Decides sheets by edges as long as possible.
    fn decide_by_edges(&mut self, sheets: &[u32], keep: &mut [bool]) {
        let mut due: Vec<u32> = sheets.iter().rev().copied().collect();
        while let Some(s) = due.pop() {
            if !self.is_open(s) {
                continue;
            }
            let Some(stays) = self.verdict(s) else { continue };
            keep[s as usize] = stays;
            self.decide(s, stays);
            due.extend(self.edges(s).flat_map(|edge| &edge.open));
        }
    }

    /// Decides the others, connected ones alike.
    fn decide_remaining(&mut self, sheets: &[u32], keep: &mut [bool]) {
        for &start in sheets {
            if !self.is_open(start) {
                continue;
            }
            let part = self.part(start);
            let closed =
                part.iter().all(|&s| self.edges(s).all(|edge| (edge.kept + edge.open.len()).is_multiple_of(2)));
            for &s in &part {
                keep[s as usize] = closed;
                self.decide(s, closed);
            }
        }
    }

    /// Open sheets connected to a sheet.
    fn part(&self, start: u32) -> Vec<u32> {
        let mut part = vec![start];
        let mut known: rustc_hash::FxHashSet<u32> = part.iter().copied().collect();
        let mut next = 0;
        while let Some(&s) = part.get(next) {
            next += 1;
            let beside: Vec<u32> = self.edges(s).flat_map(|edge| edge.open.iter().copied()).collect();
            part.extend(beside.into_iter().filter(|&other| known.insert(other)));
        }
        part
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sides of a tetrahedron and some more triangles.
    const CLOSED: [[u32; 3]; 4] = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];

    fn with(more: &[[u32; 3]]) -> Vec<[u32; 3]> {
        CLOSED.iter().chain(more).copied().collect()
    }

    #[test]
    fn what_closes_the_surface_stays() {
        for sheet in 0..4 {
            assert_eq!(kept(&CLOSED, &[sheet]), [true; 4]);
        }
        assert_eq!(kept(&CLOSED, &[0, 2]), [true; 4]);
        // Every triangle has its reverse.
        assert_eq!(kept(&CLOSED, &[0, 1, 2, 3]), [true; 4]);
    }

    #[test]
    fn what_encloses_nothing_goes() {
        // A fin of two triangles, one with an edge at the surface, and an unconnected one.
        let fin = with(&[[0, 1, 4], [1, 5, 4], [7, 8, 9]]);
        assert_eq!(kept(&fin, &[4, 5, 6]), [true, true, true, true, false, false, false]);
        // All with their reverse.
        assert_eq!(kept(&fin, &[0, 1, 2, 3, 4, 5, 6]), [true, true, true, true, false, false, false]);
        // The wall between two tetrahedra.
        let two = with(&[[0, 4, 1], [1, 4, 2], [2, 4, 0]]);
        assert_eq!(kept(&two, &[0]), [false, true, true, true, true, true, true]);
    }

    #[test]
    fn not_everything_goes() {
        assert_eq!(kept(&CLOSED[..3], &[0, 1, 2]), [true; 3]);
        assert!(kept(&[], &[]).is_empty());
    }
}
