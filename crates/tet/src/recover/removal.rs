//! Steiner point suppression: removal of the Steiner points that a recovered surface does not need.
//!
//! The star of a vertex is joined to one of its neighbours that sees all of it, which contracts the edge between both.
//! If there is none, edges at the vertex are flipped away first, until a neighbour sees the rest. A failed search is
//! undone. Faces of the surface are not touched, and all tetrahedra stay positive.

use super::journal::Journal;
use crate::complex::{Complex, NONE};
use crate::flips::{Flipper, MAX_RING};
use crate::progress::Watch;
use crate::star::Star;
use anastomesh_mesh::budget::Stop;
use anastomesh_mesh::geometry::predicates::orient3d;

/// Maximum passes over the Steiner points. Later ones removed nothing on the shared surfaces.
const MAX_PASSES: usize = 8;

/// Maximum edges at one vertex to flip away, and to try, in one pass.
const MAX_FLIPS: usize = 24;

/// Maximum tetrahedra at a vertex whose edges are flipped away. Each flip removes few, and each search visits all.
const MAX_STAR: usize = 200;

/// Operations per vertex and pass, as counted by budgets.
const OPERATIONS: usize = 500;

/// Removes vertices from `first` on as far as possible, and renumbers the rest. Returns the number that stays.
pub(crate) fn remove_steiner_points(c: &mut Complex, first: usize, watch: &Watch) -> Result<usize, Stop> {
    let mut waiting: Vec<u32> = (first as u32..c.points.len() as u32).filter(|&v| c.vertex_tet(v) != NONE).collect();
    let mut work = Removal::default();
    for _ in 0..MAX_PASSES {
        let before = waiting.len();
        watch.spend(OPERATIONS * before)?;
        waiting.retain(|&v| !work.remove(c, v));
        if waiting.len() == before {
            break;
        }
    }
    if first + waiting.len() < c.points.len() {
        let mut id = vec![NONE; c.points.len()];
        let mut points = c.points[..first].to_vec();
        id[..first].iter_mut().zip(0..).for_each(|(slot, v)| *slot = v);
        for &v in &waiting {
            id[v as usize] = points.len() as u32;
            points.push(c.points[v as usize]);
        }
        *c = c.part(points, &id, |_| true);
    }
    Ok(waiting.len())
}

#[derive(Default)]
struct Removal {
    star: Star,
    flipper: Flipper,
    journal: Journal,
    created: Vec<u32>,
}

impl Removal {
    /// Removes a vertex. Changes nothing if that is impossible.
    fn remove(&mut self, c: &mut Complex, v: u32) -> bool {
        if self.contract(c, v) {
            return true;
        }
        self.journal.clear();
        let done = self.thin_out(c, v);
        if !done {
            self.journal.undo_to(c, 0);
        }
        done
    }

    /// Flips edges at a vertex away, the ones with the smallest rings first, until the vertex can be removed.
    fn thin_out(&mut self, c: &mut Complex, v: u32) -> bool {
        let mut tries = 0;
        loop {
            let Some(around) = self.neighbors(c, v) else { return false };
            let removed = around.into_iter().take(MAX_FLIPS).any(|(_, w, t)| {
                tries += 1;
                let fits = |c: &Complex, tet: &[u32; 4]| (c.orient(tet) > 0.0).then(|| shape(c, tet));
                self.flipper.plan_edge(c, t, v, w, MAX_RING, fits).is_ok()
                    && self.journal.commit(c, &mut self.flipper).is_ok()
            });
            if !removed || tries > 4 * MAX_FLIPS {
                return false;
            }
            if self.contract(c, v) {
                return true;
            }
        }
    }

    /// Neighbours of a vertex, with the size of the ring around the edge and one of its tetrahedra. `None` on the boundary,
    /// and for more than [`MAX_STAR`] tetrahedra.
    fn neighbors(&mut self, c: &Complex, v: u32) -> Option<Vec<(usize, u32, u32)>> {
        let star = self.star.around(c, v);
        if star.len() > MAX_STAR || star.iter().any(|&t| c.is_ghost(t)) {
            return None;
        }
        let mut ends: Vec<(u32, u32)> =
            star.iter().flat_map(|&t| c.verts(t).map(|w| (w, t))).filter(|e| e.0 != v).collect();
        ends.sort_unstable();
        let mut around: Vec<(usize, u32, u32)> =
            ends.chunk_by(|x, y| x.0 == y.0).map(|ring| (ring.len(), ring[0].0, ring[0].1)).collect();
        around.sort_unstable();
        Some(around)
    }

    /// Joins the star of a vertex to the neighbour that makes the best of the worst tetrahedra.
    fn contract(&mut self, c: &mut Complex, v: u32) -> bool {
        let star = self.star.around(c, v);
        let mut faces = Vec::with_capacity(star.len());
        for &t in star {
            let Some(i) = c.slot_of(t, v).filter(|_| !c.is_ghost(t)) else { return false };
            // A frozen face at the vertex would be lost.
            if (0..4).any(|k| k != i && c.is_frozen(4 * t + k as u32)) {
                return false;
            }
            let [a, b, d] = c.face(4 * t + i as u32);
            faces.push([a, d, b]);
        }
        let mut rim: Vec<u32> = faces.iter().flatten().copied().collect();
        rim.sort_unstable();
        rim.dedup();
        let mut best: Option<(f64, u32)> = None;
        for w in rim {
            let bound = best.map_or(0.0, |b| b.0);
            let mut worst = f64::INFINITY;
            let better = faces.iter().filter(|f| !f.contains(&w)).all(|&[a, b, d]| {
                let tet = [a, b, d, w];
                let [p, q, r, s] = tet.map(|x| &c.points[x as usize]);
                if orient3d(p, q, r, s) <= 0.0 {
                    return false;
                }
                worst = worst.min(shape(c, &tet));
                worst > bound
            });
            if better {
                best = Some((worst, w));
            }
        }
        let Some((_, w)) = best else { return false };
        let new: Vec<[u32; 4]> = faces.iter().filter(|f| !f.contains(&w)).map(|&[a, b, d]| [a, b, d, w]).collect();
        let star = self.star.around(c, v).to_vec();
        c.replace(&star, &new, &mut self.created)
    }
}

/// Volume over the cubed root mean square edge length, up to a factor. Positive even where rounding hides the volume.
fn shape(c: &Complex, tet: &[u32; 4]) -> f64 {
    let p = tet.map(|v| c.points[v as usize]);
    let volume = (p[1] - p[0]).cross(&(p[2] - p[0])).dot(&(p[3] - p[0])).abs();
    let squared: f64 = (0..4).map(|i| (0..i).map(|j| (p[i] - p[j]).norm_squared()).sum::<f64>()).sum();
    (volume / (squared * squared.sqrt())).max(f64::MIN_POSITIVE)
}

#[cfg(test)]
mod tests {
    use super::*;
    use anastomesh_mesh::shapes::sphere_surface;

    #[test]
    fn points_that_are_not_needed_are_removed() {
        let mut points = sphere_surface(2).points;
        let first = points.len();
        for k in 0..40 {
            let w = f64::from(k);
            points.push(
                anastomesh_mesh::geometry::Point3::new(libm::sin(w), libm::cos(1.7 * w), libm::sin(0.6 * w)) * 0.4,
            );
        }
        let mut c = crate::delaunay::delaunay(&points).unwrap();
        let volume = |c: &Complex| c.real_tets().map(|t| c.orient(&c.verts(t))).sum::<f64>();
        let before = volume(&c);
        let left = remove_steiner_points(&mut c, first, &Watch::NOBODY).unwrap();
        c.sanity_check().unwrap();
        assert_eq!((left, c.points.len()), (0, first));
        assert!((volume(&c) - before).abs() < 1e-9 * before);
    }

    #[test]
    fn stars_of_more_than_200_tetrahedra_are_left() {
        // The centre of a sphere has as many tetrahedra as the sphere has triangles.
        let count = |level: usize| {
            let surface = sphere_surface(level);
            let mut points = surface.points;
            points.push(anastomesh_mesh::geometry::Point3::origin());
            let c = crate::delaunay::delaunay(&points).unwrap();
            let center = points.len() as u32 - 1;
            let around = Removal::default().neighbors(&c, center).map(|around| around.len());
            (surface.triangles.len(), around)
        };
        assert_eq!([1, 2].map(count), [(80, Some(42)), (320, None)]);
    }

    #[test]
    fn a_point_that_holds_a_prism_stays() {
        // Schönhardt's prism has no tetrahedralization without a further point.
        let mut surface = anastomesh_mesh::TriMesh::default();
        for (z, turn) in [(0.0, 0.0), (1.0, -0.5_f64)] {
            for i in 0..3 {
                let w = f64::from(i) / 3.0 * std::f64::consts::TAU + turn;
                surface.points.push(anastomesh_mesh::geometry::Point3::new(libm::cos(w), libm::sin(w), z));
            }
        }
        surface.triangles =
            vec![[0, 2, 1], [3, 4, 5], [0, 1, 3], [1, 4, 3], [1, 2, 4], [2, 5, 4], [2, 0, 5], [0, 3, 5]];
        let center = anastomesh_mesh::geometry::Point3::new(0.0, 0.0, 0.5);
        let mut points = surface.points.clone();
        points.push(center);
        let tets: Vec<[u32; 4]> = surface.triangles.iter().map(|&[a, b, d]| [a, b, d, 6]).collect();
        let tets = if Complex::from_mesh(points.clone(), &tets).is_ok() {
            tets
        } else {
            tets.into_iter().map(|[a, b, d, e]| [a, d, b, e]).collect()
        };
        let mut c = Complex::from_mesh(points, &tets).unwrap();
        assert_eq!(remove_steiner_points(&mut c, 6, &Watch::NOBODY), Ok(1));
        assert_eq!(c.real_tets().count(), 8);
    }
}
