//! Repair of a triangle surface without ambiguous choices.
//!
//! The repair merges points at equal positions and removes degenerate and duplicate triangles. It orients triangles
//! consistently, with the outside in front.
//!
//! All decisions are exact. Holes are not filled, and intersecting parts are not separated.

mod sheets;

use super::TriMesh;
use super::adjacency::{NONE, tri_adjacency};
use super::face_key;
use crate::geometry::place_key;
use crate::geometry::predicates::{collinear, orient2d, orient3d};
use crate::geometry::{Aabb, Bvh, Point3, Vec3};

/// Triangles of a component tried to find its nesting depth.
const TRIES: usize = 32;

/// Summary of a repair.
#[derive(Clone, Debug, Default, PartialEq, Eq, serde::Serialize)]
#[non_exhaustive]
pub struct RepairReport {
    /// Points at the position of an earlier one.
    pub merged_points: usize,
    /// Triangles with a repeated vertex, perhaps after merging, or a missing one.
    pub collapsed_triangles: usize,
    /// Triangles with the vertices of an earlier one, which stays.
    pub duplicate_triangles: usize,
    /// Triangles removed in pairs back to back, because they enclosed nothing.
    pub sheet_triangles: usize,
    /// Triangles without area whose longest edge was exchanged for the other diagonal.
    pub flat_triangles: usize,
    /// Triangles that were reversed.
    pub turned_triangles: usize,
    /// Components connected by edges of two triangles.
    pub components: usize,
    /// Components that cannot be oriented.
    pub not_orientable: usize,
}

impl RepairReport {
    /// True if anything was changed.
    pub fn changed(&self) -> bool {
        let removed = self.collapsed_triangles + self.duplicate_triangles + self.sheet_triangles;
        self.merged_points + removed + self.flat_triangles + self.turned_triangles > 0
    }
}

/// A repaired surface, and its relation to the input.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Repaired {
    /// The surface.
    pub surface: TriMesh,
    /// Input triangle of each triangle.
    pub source: Vec<u32>,
    /// New index of each input point.
    pub point: Vec<u32>,
    /// Summary of changes.
    pub report: RepairReport,
}

/// Repairs a surface meant to bound a volume. One of several duplicate triangles stays. Of two back to back, none stays
/// unless the surface needs it to be closed. Coordinates that are not finite are left unchanged.
///
/// ```
/// use anastomesh_mesh::{Point3, TriMesh, repair::repair};
///
/// let points = vec![Point3::origin(), Point3::new(1., 0., 0.), Point3::new(0., 1., 0.), Point3::new(0., 0., 1.)];
/// // The last triangle is turned the wrong way.
/// let surface = TriMesh { points, triangles: vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 2, 3]] };
/// let repaired = repair(&surface);
/// assert_eq!((repaired.report.turned_triangles, repaired.surface.triangles[3]), (1, [0, 3, 2]));
/// ```
pub fn repair(surface: &TriMesh) -> Repaired {
    repaired(surface, true)
}

/// Repairs facets, which may lie anywhere: as [`repair`], but one of several duplicates stays in any orientation.
pub fn repair_facets(surface: &TriMesh) -> Repaired {
    repaired(surface, false)
}

fn repaired(surface: &TriMesh, bounds: bool) -> Repaired {
    let mut r = merge_points(surface);
    drop_triangles(&mut r, bounds);
    flip_flat(&mut r);
    orient(&mut r);
    r
}

fn merge_points(surface: &TriMesh) -> Repaired {
    let points = &surface.points;
    let mut order: Vec<u32> = (0..points.len() as u32).collect();
    order.sort_unstable_by_key(|&i| (place_key(&points[i as usize]), i));
    let mut first: Vec<u32> = (0..points.len() as u32).collect();
    for run in order.chunk_by(|&i, &j| points[i as usize] == points[j as usize]) {
        for &i in run {
            first[i as usize] = run[0];
        }
    }
    let mut r = Repaired { point: vec![NONE; points.len()], ..Repaired::default() };
    for (i, &f) in first.iter().enumerate() {
        if f as usize == i {
            r.point[i] = r.surface.points.len() as u32;
            r.surface.points.push(points[i]);
        } else {
            r.point[i] = r.point[f as usize];
            r.report.merged_points += 1;
        }
    }
    let vertex = |v: u32| r.point.get(v as usize).copied().unwrap_or(NONE);
    r.surface.triangles = surface.triangles.iter().map(|t| t.map(vertex)).collect();
    r
}

/// Drops triangles with a repeated vertex or those of an earlier triangle; of bounding surfaces also sheets.
fn drop_triangles(r: &mut Repaired, bounds: bool) {
    let triangles = std::mem::take(&mut r.surface.triangles);
    let broken = |t: &[u32; 3]| t[0] == t[1] || t[1] == t[2] || t[2] == t[0] || t.contains(&NONE);
    let mut order: Vec<([u32; 3], u32)> = triangles.iter().map(|&t| face_key(t)).zip(0..).collect();
    order.retain(|(t, _)| !broken(t));
    r.report.collapsed_triangles = triangles.len() - order.len();
    order.sort_unstable();
    // First copy of each, and the number of copies if some have opposite orientation.
    let mut first: Vec<(u32, usize)> = Vec::with_capacity(order.len());
    for run in order.chunk_by(|x, y| x.0 == y.0) {
        let turned = |&(_, i): &([u32; 3], u32)| turned_over(&triangles[i as usize], &triangles[run[0].1 as usize]);
        first.push((run[0].1, if run.iter().any(turned) { run.len() } else { 0 }));
    }
    first.sort_unstable();
    r.report.duplicate_triangles = order.len() - first.len();
    let distinct: Vec<[u32; 3]> = first.iter().map(|&(i, _)| triangles[i as usize]).collect();
    let sheets: Vec<u32> = first.iter().zip(0..).filter(|((_, n), _)| bounds && *n > 0).map(|(_, k)| k).collect();
    for ((t, (source, copies)), stays) in distinct.iter().zip(first).zip(sheets::kept(&distinct, &sheets)) {
        if stays {
            r.surface.triangles.push(*t);
            r.source.push(source);
        } else {
            r.report.duplicate_triangles -= copies - 1;
            r.report.sheet_triangles += copies;
        }
    }
}

/// Removes triangles without area. Their middle vertex splits the triangle behind the longest edge.
fn flip_flat(r: &mut Repaired) {
    // Each round may make new flat triangles beside the old ones, in a strip of them.
    for _ in 0..TRIES {
        let s = &mut r.surface;
        let flat = |t: &[u32; 3], p: &[Point3]| collinear(&p[t[0] as usize], &p[t[1] as usize], &p[t[2] as usize]);
        let found: Vec<u32> = s.triangles.iter().zip(0..).filter(|(t, _)| flat(t, &s.points)).map(|(_, i)| i).collect();
        if found.is_empty() {
            return;
        }
        let edges = tri_adjacency(&s.triangles, s.points.len());
        let mut busy = vec![false; s.triangles.len()];
        let mut changed = false;
        for &i in &found {
            let t = s.triangles[i as usize];
            let k = longest_edge(t, &s.points);
            let mate = edges.neighbors[i as usize][k];
            if mate == NONE {
                continue;
            }
            let (n, j) = (mate as usize / 3, mate as usize % 3);
            let (a, b, m) = (t[k], t[(k + 1) % 3], t[(k + 2) % 3]);
            let d = s.triangles[n][(j + 2) % 3];
            if d == m || busy[n] || busy[i as usize] {
                continue;
            }
            // Either orientation: the neighbour may be reversed.
            let same = s.triangles[n][j] == a;
            let pair = if same { [[a, m, d], [m, b, d]] } else { [[a, d, m], [m, d, b]] };
            s.triangles[i as usize] = pair[0];
            s.triangles[n] = pair[1];
            // Their neighbours' links are out of date until the next round.
            for x in [i as usize, n] {
                busy[x] = true;
                edges.neighbors[x].iter().filter(|&&h| h != NONE).for_each(|&h| busy[h as usize / 3] = true);
            }
            changed = true;
            r.report.flat_triangles += 1;
        }
        if !changed {
            return;
        }
    }
}

/// Edge of three collinear points that contains the third.
fn longest_edge(t: [u32; 3], points: &[Point3]) -> usize {
    let length = |k: usize| (points[t[(k + 1) % 3] as usize] - points[t[k] as usize]).norm_squared();
    (0..3).max_by(|&i, &j| length(i).total_cmp(&length(j))).unwrap_or(0)
}

/// Orients the triangles of each component consistently. A closed component gets its volume behind it, or in front of
/// it if the component lies inside an odd number of others.
fn orient(r: &mut Repaired) {
    let before = r.surface.triangles.clone();
    let parts = SurfaceComponents::new(&mut r.surface, &mut r.report);
    let depths = parts.depths(&r.surface);
    let volumes = parts.volumes(&r.surface);
    let wrong = |part: u32| {
        let (volume, depth) = (volumes[part as usize], depths[part as usize]);
        parts.closed[part as usize] && volume != 0.0 && (volume < 0.0) != (depth % 2 == 1)
    };
    for (t, &part) in r.surface.triangles.iter_mut().zip(&parts.of) {
        if wrong(part) {
            t.swap(1, 2);
        }
    }
    r.report.turned_triangles =
        r.surface.triangles.iter().zip(&before).filter(|(now, then)| turned_over(now, then)).count();
}

/// True if two triangles with the same vertices have opposite orientation.
fn turned_over(t: &[u32; 3], u: &[u32; 3]) -> bool {
    let at = t.iter().position(|&v| v == u[0]).unwrap_or(0);
    t[(at + 1) % 3] != u[1]
}

/// Components of a surface connected by edges of two triangles.
struct SurfaceComponents {
    /// Component of each triangle.
    of: Vec<u32>,
    /// True if each of its edges has two triangles with consistent orientation.
    closed: Vec<bool>,
}

impl SurfaceComponents {
    /// Finds the components and orients their triangles like the first one of each.
    fn new(surface: &mut TriMesh, report: &mut RepairReport) -> Self {
        let edges = tri_adjacency(&surface.triangles, surface.points.len());
        let triangles = &mut surface.triangles;
        let mut of = vec![NONE; triangles.len()];
        let mut turned = vec![false; triangles.len()];
        let (mut closed, mut sound) = (Vec::new(), Vec::new());
        let mut stack = Vec::new();
        // Ends of an edge in the input orientation.
        let ends = |t: &[u32; 3], i: usize| [t[i], t[(i + 1) % 3]];
        for start in 0..triangles.len() {
            if of[start] != NONE {
                continue;
            }
            let part = closed.len() as u32;
            let (mut whole, mut orientable) = (true, true);
            of[start] = part;
            stack.push(start);
            while let Some(t) = stack.pop() {
                for i in 0..3 {
                    let mate = edges.neighbors[t][i];
                    if mate == NONE {
                        whole = false;
                        continue;
                    }
                    let (n, j) = (mate as usize / 3, mate as usize % 3);
                    let disagree = ends(&triangles[t], i) == ends(&triangles[n], j);
                    if of[n] == NONE {
                        of[n] = part;
                        turned[n] = turned[t] ^ disagree;
                        stack.push(n);
                    } else if turned[n] != turned[t] ^ disagree {
                        orientable = false;
                    }
                }
            }
            report.not_orientable += usize::from(!orientable);
            closed.push(whole && orientable);
            sound.push(orientable);
        }
        report.components = closed.len();
        for ((t, turned), &part) in triangles.iter_mut().zip(turned).zip(&of) {
            if turned && sound[part as usize] {
                t.swap(1, 2);
            }
        }
        Self { of, closed }
    }

    /// Signed volume of each component, relative to its first point.
    fn volumes(&self, surface: &TriMesh) -> Vec<f64> {
        let mut origin: Vec<Option<Point3>> = vec![None; self.closed.len()];
        let mut volume = vec![0.0; self.closed.len()];
        for (t, &part) in surface.triangles.iter().zip(&self.of) {
            let o = *origin[part as usize].get_or_insert(surface.points[t[0] as usize]);
            let [a, b, c]: [Vec3; 3] = t.map(|v| surface.points[v as usize] - o);
            volume[part as usize] += a.cross(&b).dot(&c);
        }
        volume
    }

    /// Number of other closed components around each component.
    fn depths(&self, surface: &TriMesh) -> Vec<usize> {
        let mut depths = vec![0; self.closed.len()];
        if self.closed.len() < 2 {
            return depths;
        }
        let corners = |i: usize| surface.triangles[i].map(|v| &surface.points[v as usize]);
        let sound = |i: usize| corners(i).iter().all(|p| p.iter().all(|x| x.is_finite()));
        let boxes: Vec<Aabb> = (0..surface.triangles.len())
            .map(|i| if sound(i) { Aabb::of_points(corners(i)) } else { Aabb::EMPTY })
            .collect();
        let tree = Bvh::new(&boxes);
        let far = boxes.iter().fold(Aabb::EMPTY, |sum, b| sum.union(b)).max.x;
        let mut tries = vec![0; self.closed.len()];
        for (i, &part) in self.of.iter().enumerate() {
            let tried = &mut tries[part as usize];
            if *tried > TRIES {
                continue;
            }
            *tried += 1;
            let [a, b, c] = corners(i);
            let p = Point3::from((a.coords + b.coords + c.coords) / 3.0);
            if let Some(depth) = self.depth(surface, &tree, part, &p, far) {
                depths[part as usize] = depth;
                *tried = usize::MAX - 1;
            }
        }
        depths
    }

    /// Number of other closed components around a point: those that the ray along x crosses an odd number of times.
    /// `None` if the ray grazes an edge.
    fn depth(&self, surface: &TriMesh, tree: &Bvh, own: u32, p: &Point3, far: f64) -> Option<usize> {
        let mut near = Vec::new();
        tree.query(&Aabb::of_points([p, &Point3::new(far.max(p.x), p.y, p.z)]), |i| near.push(i));
        let mut crossed = Vec::new();
        for i in near {
            let part = self.of[i as usize];
            if part != own && self.closed[part as usize] && crosses(surface, i, p)? {
                crossed.push(part);
            }
        }
        crossed.sort_unstable();
        Some(crossed.chunk_by(|a, b| a == b).filter(|run| run.len() % 2 == 1).count())
    }
}

/// True if the ray from `p` along x crosses a triangle; `None` if it meets its border.
fn crosses(surface: &TriMesh, triangle: u32, p: &Point3) -> Option<bool> {
    let [a, b, c] = surface.triangles[triangle as usize].map(|v| &surface.points[v as usize]);
    let flat = |q: &Point3| [q.y, q.z];
    let turns = [[a, b], [b, c], [c, a]].map(|[u, v]| orient2d(flat(u), flat(v), flat(p)));
    if turns.iter().any(|&x| x > 0.0) && turns.iter().any(|&x| x < 0.0) {
        return Some(false);
    }
    if turns.contains(&0.0) {
        return None;
    }
    // Seen against x, p lies behind a counter-clockwise triangle if p has the smaller x.
    let side = orient3d(a, b, c, p);
    if side == 0.0 { None } else { Some((side < 0.0) == (turns[0] > 0.0)) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes::sphere_surface;

    fn joined(mut a: TriMesh, b: &TriMesh, scale: f64, shift: Vec3) -> TriMesh {
        let n = a.points.len() as u32;
        a.points.extend(b.points.iter().map(|p| Point3::from(p.coords * scale + shift)));
        a.triangles.extend(b.triangles.iter().map(|t| t.map(|v| v + n)));
        a
    }

    fn volume(s: &TriMesh) -> f64 {
        let term = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|v| s.points[v as usize].coords);
            a.cross(&b).dot(&c) / 6.0
        };
        s.triangles.iter().map(term).sum()
    }

    #[test]
    fn a_sound_surface_stays_as_it_is() {
        let s = sphere_surface(2);
        let r = repair(&s);
        assert_eq!(r.surface, s);
        assert!(!r.report.changed() && r.report.components == 1, "{:?}", r.report);
        assert!(r.source.iter().zip(0..).all(|(&a, b)| a == b));
    }

    #[test]
    fn a_soup_of_turned_triangles_becomes_the_sphere() {
        let s = sphere_surface(2);
        let mut soup = TriMesh::default();
        for (i, t) in s.triangles.iter().enumerate() {
            soup.points.extend(t.map(|v| s.points[v as usize]));
            let n = 3 * i as u32;
            soup.triangles.push(if i % 3 == 1 { [n, n + 2, n + 1] } else { [n, n + 1, n + 2] });
        }
        soup.triangles.push([0, 0, 1]);
        soup.triangles.push([0, 1, 2]);
        let r = repair(&soup);
        assert_eq!(r.surface.points.len(), s.points.len());
        assert_eq!((r.report.collapsed_triangles, r.report.duplicate_triangles), (1, 1));
        assert_eq!(r.report.turned_triangles, s.triangles.len().div_ceil(3));
        assert!((volume(&r.surface) - volume(&s)).abs() < 1e-12);
        assert!(r.point.iter().zip(&soup.points).all(|(&n, p)| r.surface.points[n as usize] == *p));
    }

    #[test]
    fn sheets_go_where_they_enclose_nothing() {
        let mut s = sphere_surface(1);
        let n = s.triangles.len();
        let [a, b, c] = s.triangles[7];
        let twice = |s: &mut TriMesh, t: [u32; 3]| s.triangles.extend([t, [t[1], t[0], t[2]]]);
        // One triangle of the surface with its reverse, and a fin of three copies.
        s.points.push(Point3::new(3.0, 3.0, 3.0));
        let tip = s.points.len() as u32 - 1;
        s.triangles.push([b, a, c]);
        twice(&mut s, [a, b, tip]);
        s.triangles.push([tip, a, b]);
        let r = repair(&s);
        assert_eq!(r.surface.triangles, s.triangles[..n]);
        assert_eq!((r.report.duplicate_triangles, r.report.sheet_triangles), (1, 3));
        assert!(r.source.iter().zip(0..).all(|(&a, b)| a == b));
        // Among facets one of each stays.
        let r = repair_facets(&s);
        assert_eq!((r.surface.triangles.len(), r.report.duplicate_triangles), (n + 1, 3));
        assert_eq!(r.source.last(), Some(&(n as u32 + 1)));
    }

    #[test]
    fn nested_shells_are_turned_by_turns() {
        let s = sphere_surface(1);
        let mut all = s.clone();
        for scale in [0.75, 0.5, 0.25] {
            all = joined(all, &s, scale, Vec3::zeros());
        }
        all = joined(all, &s, 0.5, Vec3::new(4.0, 0.0, 0.0));
        let r = repair(&all);
        assert_eq!((r.report.components, r.report.turned_triangles), (5, 2 * s.triangles.len()));
        let whole = volume(&s) * (1.0 - 0.75_f64.powi(3) + 0.125 - 0.25_f64.powi(3) + 0.125);
        assert!((volume(&r.surface) - whole).abs() < 1e-12);
    }

    #[test]
    fn a_vertex_on_an_edge_cuts_the_neighbour() {
        // A tetrahedron with a flat triangle along one edge.
        let p = |x: f64, y: f64, z: f64| Point3::new(x, y, z);
        let points = vec![p(0., 0., 0.), p(2., 0., 0.), p(0., 2., 0.), p(0., 0., 2.), p(1., 0., 0.)];
        let triangles = vec![[0, 2, 1], [1, 2, 3], [0, 3, 2], [0, 4, 3], [4, 1, 3], [0, 1, 4]];
        let r = repair(&TriMesh { points, triangles });
        assert_eq!((r.report.flat_triangles, r.surface.triangles.len()), (1, 6));
        let none = |t: &[u32; 3]| {
            !collinear(
                &r.surface.points[t[0] as usize],
                &r.surface.points[t[1] as usize],
                &r.surface.points[t[2] as usize],
            )
        };
        assert!(r.surface.triangles.iter().all(none));
        let edges = tri_adjacency(&r.surface.triangles, r.surface.points.len());
        assert!(edges.neighbors.iter().flatten().all(|&n| n != NONE));
        assert!((volume(&r.surface) - 8.0 / 6.0).abs() < 1e-12);
    }

    #[test]
    fn a_moebius_strip_is_named() {
        let mut s = TriMesh::default();
        for i in 0..8 {
            let (a, h) = (f64::from(i) / 8.0 * std::f64::consts::TAU, f64::from(i) / 8.0 * std::f64::consts::PI);
            for side in [-0.3, 0.3] {
                let r = 1.0 + side * libm::cos(h);
                s.points.push(Point3::new(r * libm::cos(a), r * libm::sin(a), side * libm::sin(h)));
            }
        }
        for i in 0..8_u32 {
            let [a, b] = [2 * i, 2 * i + 1];
            let [c, d] = if i == 7 { [1, 0] } else { [a + 2, b + 2] };
            s.triangles.extend([[a, c, b], [b, c, d]]);
        }
        assert_eq!(repair(&s).report.not_orientable, 1);
    }

    #[test]
    fn nonsense_does_not_panic() {
        let points = vec![Point3::new(f64::NAN, 0.0, 0.0), Point3::new(1.0, f64::INFINITY, 0.0), Point3::origin()];
        let triangles = vec![[0, 1, 2], [7, 8, 9], [2, 1, 0], [u32::MAX, 0, 1]];
        assert_eq!(repair(&TriMesh { points, triangles }).surface.triangles.len(), 1);
        assert_eq!(repair(&TriMesh::default()), Repaired::default());
    }
}
