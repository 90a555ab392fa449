//! Moves of wall vertices: Taubin smoothing, and a search along the wall that improves the worst tetrahedron. Exact
//! predicates guard each move.

use super::region::JointRegion;
use anastomesh_mesh::adjacency::Incidence;
use anastomesh_mesh::geometry::{Point3, Vec3, predicates::orient3d};
use anastomesh_mesh::quality::{radius_ratio, triangle_area_vector};
use anastomesh_mesh::smooth::Taubin;

/// Rounds of the search along the wall; the step is halved after a round without success.
const MAX_SEARCH_STEPS: usize = 10;
/// Maximum distance of a vertex from its tangent plane in Taubin smoothing, in mean edge lengths.
const OFF_WALL: f64 = 0.25;
/// Maximum move of a vertex along the wall in one search, in mean edge lengths.
const ALONG_WALL: f64 = 0.5;

/// Incidences of a region's wall vertices.
pub(super) struct Walls {
    tets: Incidence,
    faces: Incidence,
    neighbors: Incidence,
    movable: Vec<u32>,
}

/// Neighbourhood of one wall vertex.
struct Fan<'a> {
    region: &'a JointRegion,
    vertex: u32,
    tets: &'a [u32],
    faces: &'a [u32],
    /// Unit normal: normalized sum of the area vectors of its wall faces.
    normal: Vec3,
    /// Mean distance to its neighbours on the wall.
    edge: f64,
}

impl Walls {
    pub fn new(region: &JointRegion) -> Self {
        let points = region.mesh.points.len();
        Self {
            tets: Incidence::of_cells(&region.mesh.tets, points),
            faces: Incidence::of_cells(&region.faces, points),
            neighbors: Incidence::of_vertices(&region.faces, points),
            movable: (0..points as u32).filter(|&v| region.on_wall[v as usize]).collect(),
        }
    }

    /// Taubin smoothing of all movable wall vertices; each moves as far as the guards permit.
    pub fn taubin(&mut self, region: &mut JointRegion, taubin: &Taubin, good: f64) -> usize {
        let good = good.max(region.worst());
        let mut goals = region.mesh.points.clone();
        taubin.smooth_points(&mut goals, &self.neighbors, &self.movable);
        let mut moves = 0;
        for &v in &self.movable {
            let start = region.mesh.points[v as usize];
            let goal = goals[v as usize];
            let Some(fan) = self.fan(region, v) else { continue };
            let before = fan.worst(&start, f64::NEG_INFINITY);
            let step = fan.held_to_wall(goal - start);
            let fits = |share: &f64| {
                let p = start + step * *share;
                let floor = before.min(good);
                fan.worst(&p, floor.next_down()) >= floor && fan.is_sound(&p)
            };
            if step != Vec3::zeros()
                && let Some(share) = [1.0, 0.5, 0.25].iter().find(|s| fits(s))
            {
                region.mesh.points[v as usize] = start + step * *share;
                moves += 1;
            }
        }
        moves
    }

    /// Improves tetrahedra with a radius ratio less than `below` by moving wall vertices along the wall, in order.
    pub fn lift(&mut self, region: &mut JointRegion, below: f64) -> usize {
        let mut moves = 0;
        for &v in &self.movable {
            let Some(fan) = self.fan(region, v) else { continue };
            let start = region.mesh.points[v as usize];
            let before = fan.worst(&start, f64::NEG_INFINITY);
            if before >= below {
                continue;
            }
            let (best, worst) = fan.search(start, before);
            if worst > before && fan.is_sound(&best) {
                region.mesh.points[v as usize] = best;
                moves += 1;
            }
        }
        moves
    }

    fn fan<'a>(&'a self, region: &'a JointRegion, vertex: u32) -> Option<Fan<'a>> {
        let faces = self.faces.get(vertex);
        let at = |v: u32| &region.mesh.points[v as usize];
        let area = |&f: &u32| {
            let [a, b, c] = region.faces[f as usize].map(at);
            triangle_area_vector(a, b, c)
        };
        let neighbors = self.neighbors.get(vertex);
        let length = neighbors.iter().map(|&w| (at(w) - at(vertex)).norm()).sum::<f64>();
        Some(Fan {
            region,
            vertex,
            tets: self.tets.get(vertex),
            faces,
            normal: faces.iter().map(area).sum::<Vec3>().try_normalize(0.0)?,
            edge: length / neighbors.len().max(1) as f64,
        })
    }
}

impl Fan<'_> {
    fn corners<const N: usize>(&self, cell: &[u32; N], p: &Point3) -> [Point3; N] {
        cell.map(|v| if v == self.vertex { *p } else { self.region.mesh.points[v as usize] })
    }

    /// Smallest radius ratio around the vertex placed at `p`; stops early at any value up to `floor`.
    fn worst(&self, p: &Point3, floor: f64) -> f64 {
        let mut worst = f64::INFINITY;
        for &t in self.tets {
            let [a, b, c, d] = self.corners(&self.region.mesh.tets[t as usize], p);
            worst = worst.min(radius_ratio(&a, &b, &c, &d));
            if worst <= floor {
                break;
            }
        }
        worst
    }

    /// True if, with the vertex at `p`, adjacent tetrahedra are positive and no wall face is inverted.
    fn is_sound(&self, p: &Point3) -> bool {
        let positive = self.tets.iter().all(|&t| {
            let [a, b, c, d] = self.corners(&self.region.mesh.tets[t as usize], p);
            orient3d(&a, &b, &c, &d) > 0.0
        });
        positive
            && self.faces.iter().all(|&f| {
                let [a, b, c] = self.corners(&self.region.faces[f as usize], p);
                triangle_area_vector(&a, &b, &c).dot(&self.normal) > 0.0
            })
    }

    /// Limits a step to `OFF_WALL` edges along the normal and `ALONG_WALL` edges tangentially.
    fn held_to_wall(&self, step: Vec3) -> Vec3 {
        let off = self.normal.dot(&step);
        let along = step - self.normal * off;
        let limit = |length: f64, most: f64| if length > most { most / length } else { 1.0 };
        self.normal * (off * limit(off.abs(), OFF_WALL * self.edge))
            + along * limit(along.norm(), ALONG_WALL * self.edge)
    }

    /// Best position found along the wall, and the worst radius ratio there.
    fn search(&self, start: Point3, before: f64) -> (Point3, f64) {
        let i = self.normal.iamin();
        let mut e = Vec3::zeros();
        e[i] = 1.0;
        let Some(u) = (e - self.normal * self.normal.dot(&e)).try_normalize(0.0) else { return (start, before) };
        let w = self.normal.cross(&u);
        let diagonal = std::f64::consts::FRAC_1_SQRT_2;
        let ways = [u, -u, w, -w, (u + w) * diagonal, (u - w) * diagonal, (w - u) * diagonal, -(u + w) * diagonal];
        let (mut best, mut worst) = (start, before);
        let mut step = 0.25 * self.edge;
        for _ in 0..MAX_SEARCH_STEPS {
            let from = best;
            for way in ways {
                let p = from + way * step;
                if (p - start).norm() > ALONG_WALL * self.edge {
                    continue;
                }
                let q = self.worst(&p, worst);
                if q > worst {
                    (best, worst) = (p, q);
                }
            }
            if best == from {
                step *= 0.5;
            }
        }
        (best, worst)
    }
}
