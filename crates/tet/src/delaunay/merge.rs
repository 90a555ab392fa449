//! Merging of two Delaunay tetrahedralizations on the two sides of a plane.
//!
//! A tetrahedron is *final* if its circumsphere does not reach the plane. No point of the other side can lie in it, so
//! it belongs to the result. A vertex with a final star keeps it. So all other tetrahedra of the result have only
//! vertices of tetrahedra or ghosts that are not final. These vertices form a layer along the plane with few others.
//! Their Delaunay tetrahedralization contains everything missing, outside the boundary faces of the final part. The
//! perturbed result is unique, so both sides of each such face fit.

use crate::complex::{Cell, GHOST, NONE, face_key, face_of, opposed};
use anastomesh_mesh::geometry::Point3;
use rayon::prelude::*;
use rustc_hash::FxHashMap;

/// A plane across an axis, with points below on its lower side and points on or above it on the other.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cut {
    pub(super) axis: usize,
    pub(super) at: f64,
}

/// Tetrahedra of one side of a cut.
pub(super) struct Half {
    cells: Vec<Cell>,
    /// Tetrahedra that are not final, in ascending order.
    open: Vec<u32>,
    /// True for tetrahedra that are not final.
    is_open: Vec<bool>,
}

impl Half {
    /// Finds the tetrahedra on one side of a cut that are not final, by a search inward from the ghosts. If a
    /// circumsphere reaches a point of the plane, so do those of all tetrahedra between its own and that point.
    pub(super) fn new(points: &[Point3], cells: Vec<Cell>, cut: Cut, lower: bool) -> Self {
        let is_final = |cell: &Cell| {
            let corners = cell.verts.map(|v| points.get(v as usize));
            let [Some(a), Some(b), Some(c), Some(d)] = corners else { return false };
            clear_of(cut, lower, [a, b, c, d])
        };
        let mut is_open: Vec<bool> = cells.iter().map(|cell| cell.verts[3] == GHOST).collect();
        let mut open: Vec<u32> = (0..).zip(&is_open).filter(|(_, open)| **open).map(|(t, _)| t).collect();
        let mut head = 0;
        while let Some(&t) = open.get(head) {
            head += 1;
            for n in cells[t as usize].mates.map(|mate| mate >> 2) {
                if !is_open[n as usize] && !is_final(&cells[n as usize]) {
                    is_open[n as usize] = true;
                    open.push(n);
                }
            }
        }
        open.sort_unstable();
        Self { cells, open, is_open }
    }

    pub(super) fn final_count(&self) -> usize {
        self.cells.len() - self.open.len()
    }

    pub(super) fn into_cells(self) -> Vec<Cell> {
        self.cells
    }
}

/// True if the circumsphere of the positive tetrahedron `a, b, c, d` certainly stays on its side of the cut. Roundoff
/// may make the answer false, never true.
///
/// With `a` as origin the centre is `n / 2v`. The sphere ends before distance `h` if `n_y² + n_z² < 4 h v (h v − n_x)`.
fn clear_of(cut: Cut, lower: bool, [a, b, c, d]: [&Point3; 4]) -> bool {
    let (b, c, d) = (b - a, c - a, d - a);
    let size = b.amax().max(c.amax()).max(d.amax());
    let (bc, cd, db) = (b.cross(&c), c.cross(&d), d.cross(&b));
    let volume = b.dot(&cd);
    let n = cd * b.norm_squared() + db * c.norm_squared() + bc * d.norm_squared();
    // Each numerator is the sum of 18 products of at most four lengths, each with a dozen roundings; the volume of 6.
    let slack = 1e-13 * (size * size) * (size * size);
    let volume = volume - 1e-14 * size * size * size;
    let to_plane = if lower { cut.at - a[cut.axis] } else { a[cut.axis] - cut.at };
    let h = to_plane * (1.0 - 1e-15);
    let along = if lower { n[cut.axis] } else { -n[cut.axis] } + slack;
    let room = (h * volume) * (1.0 - 1e-15) - along;
    if !(h > 0.0 && volume > 0.0 && room > 0.0) {
        return false;
    }
    let across = [1, 2].map(|i| n[(cut.axis + i) % 3].abs() + slack);
    let left = 4.0 * h * volume * room * (1.0 - 1e-14);
    // Below that, the squares may have lost digits to underflow.
    left > 1e-280 && left > across[0] * across[0] + across[1] * across[1]
}

/// Merges the tetrahedra of both sides. `tetrahedralize` handles a subset of the points. Returns `None` if that fails
/// or if the subset would be most of the points.
pub(super) fn merge(
    points: &[Point3],
    [low, high]: [Half; 2],
    tetrahedralize: impl FnOnce(&[u32]) -> Option<Vec<Cell>>,
) -> Option<Vec<Cell>> {
    let ids = open_vertices(points.len(), [&low, &high]);
    if 3 * ids.len() > 2 * points.len() {
        return None;
    }
    let between = tetrahedralize(&ids)?;
    let shift = low.cells.len() as u32;
    let mut seam = Seam::default();
    add_seam(&mut seam, &low, 0);
    add_seam(&mut seam, &high, shift);
    let mut slots: Vec<u32> = low.open.iter().copied().chain(high.open.iter().map(|t| t + shift)).collect();
    let mut cells = low.cells;
    // The seam replaces pointers to slots that are not final.
    let shifted = |cell: &Cell| Cell { verts: cell.verts, mates: cell.mates.map(|mate| mate.wrapping_add(4 * shift)) };
    cells.par_extend(high.cells.par_iter().map(shifted));
    drop(high.cells);
    let gap = Gap::new(&between, &seam, points.len())?;
    let unused = gap.fill(&between, &mut cells, &mut slots);
    Some(compact(cells, unused))
}

/// Moves the last tetrahedra into the empty slots.
pub(super) fn compact(mut cells: Vec<Cell>, mut free: Vec<u32>) -> Vec<Cell> {
    for &slot in &free {
        cells[slot as usize].verts = [NONE; 4];
    }
    free.sort_unstable();
    for slot in free {
        while cells.last().is_some_and(|cell| cell.verts[0] == NONE) {
            cells.pop();
        }
        if slot as usize >= cells.len() {
            break;
        }
        let Some(cell) = cells.pop() else { break };
        cells[slot as usize] = cell;
        for (i, mate) in (0..).zip(cell.mates) {
            cells[(mate >> 2) as usize].mates[(mate & 3) as usize] = 4 * slot + i;
        }
    }
    cells
}

/// Vertices of tetrahedra that are not final, in ascending order.
fn open_vertices(points: usize, halves: [&Half; 2]) -> Vec<u32> {
    let mut open = vec![false; points];
    for half in halves {
        for v in half.open.iter().flat_map(|&t| half.cells[t as usize].verts) {
            if let Some(slot) = open.get_mut(v as usize) {
                *slot = true;
            }
        }
    }
    (0..).zip(open).filter(|&(_, open)| open).map(|(v, _)| v).collect()
}

/// Faces between final and other tetrahedra: sorted vertices to the final half-face and its vertices seen from there.
type Seam = FxHashMap<[u32; 3], (u32, [u32; 3])>;

/// Adds the seam of one side, with tetrahedra numbered from `shift`.
fn add_seam(seam: &mut Seam, half: &Half, shift: u32) {
    for mate in half.open.iter().flat_map(|&t| half.cells[t as usize].mates) {
        let t = (mate >> 2) as usize;
        if !half.is_open[t] {
            let face = face_of(&half.cells[t].verts, (mate & 3) as usize);
            seam.insert(face_key(face), (4 * shift + mate, face));
        }
    }
}

/// Tetrahedra of the open vertices that lie outside the final part.
struct Gap {
    /// Indices of the tetrahedra, in ascending order.
    kept: Vec<u32>,
    /// Final half-face that is the mate of each half-face on the seam.
    seam: FxHashMap<u32, u32>,
}

impl Gap {
    /// Finds the tetrahedra outside the seam. `None` if a face of the seam is missing, which cannot happen.
    fn new(cells: &[Cell], seam: &Seam, points: usize) -> Option<Self> {
        let mut on_seam = vec![false; points];
        for &v in seam.keys().flatten() {
            on_seam[v as usize] = true;
        }
        let mut found = FxHashMap::default();
        let mut inside = vec![false; cells.len()];
        let mut reached = Vec::new();
        for (t, cell) in (0..).zip(cells) {
            let near = cell.verts.map(|v| on_seam.get(v as usize).copied().unwrap_or(false));
            for i in (0..4).filter(|&i| (0..4).all(|k| k == i || near[k])) {
                let face = face_of(&cell.verts, i);
                if let Some(&(mate, other)) = seam.get(&face_key(face))
                    && opposed(face, other)
                {
                    found.insert(4 * t + i as u32, mate);
                    inside[t as usize] = true;
                }
            }
            inside[t as usize] |= cell.verts[3] == GHOST;
            if inside[t as usize] {
                reached.push(t);
            }
        }
        if found.len() != seam.len() {
            return None;
        }
        while let Some(t) = reached.pop() {
            for (i, mate) in (0..).zip(cells[t as usize].mates) {
                let n = (mate >> 2) as usize;
                if !inside[n] && !found.contains_key(&(4 * t + i)) {
                    inside[n] = true;
                    reached.push(n as u32);
                }
            }
        }
        let kept = (0..cells.len() as u32).filter(|&t| inside[t as usize]).collect();
        Some(Self { kept, seam: found })
    }

    /// Stores the kept tetrahedra in the slots, then after the others, and connects them to each other and to the final
    /// part. Returns the remaining slots.
    fn fill(&self, between: &[Cell], cells: &mut Vec<Cell>, slots: &mut Vec<u32>) -> Vec<u32> {
        let unused = slots.split_off(slots.len().min(self.kept.len()));
        slots.extend(cells.len() as u32..(cells.len() + self.kept.len() - slots.len()) as u32);
        let mut place = vec![NONE; between.len()];
        for (&t, &slot) in self.kept.iter().zip(slots.iter()) {
            place[t as usize] = slot;
        }
        cells.resize(cells.len().max(slots.last().map_or(0, |&slot| slot as usize + 1)), Cell::EMPTY);
        for (&t, &slot) in self.kept.iter().zip(slots.iter()) {
            let Cell { verts, mut mates } = between[t as usize];
            for (i, mate) in (0..).zip(&mut mates) {
                if let Some(&other) = self.seam.get(&(4 * t + i)) {
                    cells[(other >> 2) as usize].mates[(other & 3) as usize] = 4 * slot + i;
                    *mate = other;
                } else {
                    *mate = 4 * place[(*mate >> 2) as usize] + (*mate & 3);
                }
            }
            cells[slot as usize] = Cell { verts, mates };
        }
        unused
    }
}
