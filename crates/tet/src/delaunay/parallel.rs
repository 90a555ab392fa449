//! Parallel tetrahedralization of large sets: split by a plane, tetrahedralize both sides in parallel, merge.
//!
//! The cuts and the numbering of the tetrahedra depend on the points alone, never on the number of threads.

use super::merge::{Cut, Half, compact, merge};
use super::order::hash;
use super::order::{brio_of_sorted, hilbert};
use super::ordered::Ordered;
use super::sequence::insert_all;
use crate::complex::{Cell, Complex, GHOST, NONE};
use crate::progress::Watch;
use anastomesh_mesh::geometry::Point3;
use rayon::prelude::*;

/// Minimum number of points for a split. Merging adds 1/7 to the work, even without threads to share it. Smaller sets
/// take at most two or three seconds in one piece.
pub(super) const SPLIT_FROM: usize = 1_200_000;

/// Size of the sample that decides if a split pays off.
const SAMPLE: usize = 16_000;

/// Maximum fraction of the sample's tetrahedra that may reach across the cut. It is 0.2 in evenly filled space, 1 on a
/// sphere.
const CROSSING: f64 = 0.45;

/// Tetrahedralizes points in parts. Returns `None` if one piece is better, on errors, and if the watch cancels.
pub(super) fn tetrahedralize(points: &[Point3], watch: &Watch) -> Option<Ordered> {
    in_parts(points, SPLIT_FROM, watch)
}

/// As [`tetrahedralize`], with a bound on the size of parts.
pub(super) fn in_parts(points: &[Point3], from: usize, watch: &Watch) -> Option<Ordered> {
    let order = hilbert(points);
    let sorted: Vec<Point3> = order.iter().map(|&i| points[i as usize]).collect();
    let cells = split(&sorted, from, watch)?;
    let vertex_tet = vertex_tets(&cells, points.len());
    Some(Ordered { complex: Complex::from_cells(sorted, cells, Vec::new(), vertex_tet), order })
}

fn rename(cells: &mut [Cell], names: &[u32]) {
    let named = |v: u32| names.get(v as usize).copied().unwrap_or(GHOST);
    cells.par_iter_mut().for_each(|cell| cell.verts = cell.verts.map(named));
}

/// As [`in_parts`], for points along the Hilbert curve.
fn split(points: &[Point3], from: usize, watch: &Watch) -> Option<Vec<Cell>> {
    let cut = middle(points)?;
    if !is_worth_splitting(points, cut, watch) {
        return None;
    }
    let sides: [Vec<u32>; 2] = {
        let below = |&i: &u32| points[i as usize][cut.axis] < cut.at;
        (0..points.len() as u32).partition(below).into()
    };
    let (low, high) = rayon::join(|| part(points, &sides[0], from, watch), || part(points, &sides[1], from, watch));
    let halves = [Half::new(points, low?, cut, true), Half::new(points, high?, cut, false)];
    merge(points, halves, |ids| part(points, ids, from, watch))
}

/// Tetrahedra of a subset of the points.
fn part(points: &[Point3], ids: &[u32], from: usize, watch: &Watch) -> Option<Vec<Cell>> {
    let own: Vec<Point3> = ids.iter().map(|&i| points[i as usize]).collect();
    if own.len() >= from
        && let Some(mut cells) = split(&own, from, watch)
    {
        rename(&mut cells, ids);
        return Some(cells);
    }
    let mut order = brio_of_sorted(own.len());
    let inserter = insert_all(&own, &order, watch).ok()?;
    drop(own);
    for i in &mut order {
        *i = ids[*i as usize];
    }
    let (cells, free) = inserter.into_cells(&order);
    Some(compact(cells, free))
}

/// Plane that halves the points across the longest side of their box. `None` if many share its coordinate.
fn middle(points: &[Point3]) -> Option<Cut> {
    let first = points.first()?;
    let (low, high) = points.iter().fold((*first, *first), |(low, high), p| (low.inf(p), high.sup(p)));
    let axis = (high - low).imax();
    let mut coordinates: Vec<f64> = points.iter().map(|p| p[axis]).collect();
    let half = coordinates.len() / 2;
    let (below, &mut at, _) = coordinates.select_nth_unstable_by(half, f64::total_cmp);
    let below = below.iter().filter(|&&x| x < at).count();
    (4 * below > points.len()).then_some(Cut { axis, at })
}

/// True if most of the tetrahedra of a sample stay on one side of the cut.
fn is_worth_splitting(points: &[Point3], cut: Cut, watch: &Watch) -> bool {
    let every = (points.len() / SAMPLE).max(1) as u64;
    let sample: Vec<Point3> =
        (0..).zip(points).filter(|&(i, _)| hash(i).is_multiple_of(every)).map(|(_, &p)| p).collect();
    let order = brio_of_sorted(sample.len());
    let Ok(inserter) = insert_all(&sample, &order, watch) else { return false };
    let (cells, _) = inserter.into_cells(&order);
    let count = cells.len() as f64;
    let low = Half::new(&sample, cells, cut, true);
    let final_count = low.final_count();
    let final_count = final_count + Half::new(&sample, low.into_cells(), cut, false).final_count();
    count - final_count as f64 <= CROSSING * count
}

/// A tetrahedron at each point.
fn vertex_tets(cells: &[Cell], points: usize) -> Vec<u32> {
    let mut tets = vec![NONE; points];
    for (t, cell) in (0..).zip(cells) {
        for v in cell.verts {
            if let Some(own) = tets.get_mut(v as usize) {
                *own = t;
            }
        }
    }
    tets
}
