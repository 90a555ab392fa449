//! Contouring on a graded grid, for vessels whose radii differ much. Cells are the leaves of an octree, as large as the vessels
//! nearby are wide.
//!
//! Neighbouring leaves differ by one level at most. Each leaf is divided into tetrahedra between its centre, the centres of its
//! faces, and the edges of these. Where a neighbour is smaller, faces and edges are those of the neighbour. So the tetrahedra
//! conform, and their marching-tetrahedra patches form a closed 2-manifold for every sign field.

use super::field::Field;
use super::{SurfaceError, SurfaceParams};
use anastomesh_mesh::TriMesh;
use anastomesh_mesh::geometry::{Point3, Tube, Vec3, point_segment};
use anastomesh_skeleton::resolution::GROWTH;
use anastomesh_tet::parts::Watch;
use rustc_hash::{FxHashMap, FxHashSet};
use std::rc::Rc;

/// Side of a leaf, in target edge lengths. Tetrahedra have edges of about half a side.
const SIDE: f64 = 1.3;
/// Distance of the wall from a vessel, in its radii, up to which blending with others may move it.
const BLENDING: f64 = 0.4;
/// Depth inside a vessel, in its radii, from which there is no wall. With the usual kernel it is .68 radii beyond a free end, with
/// narrower ones further.
const DEEP: f64 = 0.45;
/// Minimum radius of vessels that are wide beside a cube, in its sides. Within their wall there is no other.
const WIDE: f64 = 4.0;
/// Factor on the change of their field within the cube, as its gradient is not constant, and a margin.
const CURVED: f64 = 2.0;
const MARGIN: f64 = 1e-3;
/// Maximum level of a leaf: coordinates in half cells have 32 bits.
const DEEPEST: usize = 30;
/// Minimum share of an edge between a crossing and either end.
const INWARD: f64 = 0.12;
/// Leaves between two checks for cancellation and the budget.
const ASKED_EVERY: usize = 256;
/// Operations per leaf, as counted by budgets.
const OPERATIONS: usize = 60;

/// Index of a cube among those of its level, or a point in half cells of the finest level.
type Index = [u32; 3];

/// Contours the level 1 of the field.
///
/// # Errors
/// `TooLarge` if there are too many leaves or levels; `Stopped`.
pub(super) fn contour(
    tubes: &[Tube],
    field: &mut Field,
    params: &SurfaceParams,
    watch: &Watch,
) -> Result<TriMesh, SurfaceError> {
    let mut octree = Octree::new(tubes, field, params)?;
    octree.divide(tubes, field, params, watch)?;
    octree.balance(params.max_cells, watch)?;
    octree.find_graded(watch)?;
    let mut marching = Marching {
        octree: &octree,
        field,
        values: FxHashMap::default(),
        vertices: FxHashMap::default(),
        mesh: TriMesh::default(),
    };
    for (level, leaves) in octree.leaves.iter().enumerate() {
        let mut leaves: Vec<&Index> = leaves.iter().collect();
        leaves.sort_unstable();
        for (i, leaf) in leaves.into_iter().enumerate() {
            if i.is_multiple_of(ASKED_EVERY) {
                watch.spend(ASKED_EVERY * OPERATIONS + marching.field.operations())?;
            }
            marching.leaf(level, leaf);
        }
    }
    Ok(marching.mesh)
}

/// Cubes that the wall may cross.
struct Octree {
    origin: Point3,
    side: f64,
    /// Leaves of each level, and an empty level below the finest one.
    leaves: Vec<FxHashSet<Index>>,
    /// Those that touch smaller ones.
    graded: Vec<FxHashSet<Index>>,
}

/// Square face of a cube, in half cells.
struct Face {
    /// Lowest corner.
    at: Index,
    size: u32,
    /// Axis that it is normal to, and the end of the cube there: 0 or 1.
    axis: usize,
    end: u32,
    level: usize,
}

impl Face {
    /// Axes that it lies along.
    fn across(&self) -> [usize; 2] {
        [(self.axis + 1) % 3, (self.axis + 2) % 3]
    }

    /// Its quarters, which are faces of cubes of the next level.
    fn quarters(&self) -> [Self; 4] {
        let ([u, v], half) = (self.across(), self.size / 2);
        [(0, 0), (0, 1), (1, 0), (1, 1)].map(|(i, j)| Self {
            at: moved(moved(self.at, u, i * half), v, j * half),
            size: half,
            level: self.level + 1,
            ..*self
        })
    }
}

/// A cube to be divided, and the vessels near it.
struct Pending {
    level: usize,
    at: Index,
    /// Vessels whose walls may cross it, or that its size depends on.
    near: Rc<[u32]>,
}

impl Octree {
    /// A root around the vessels, and no leaves.
    fn new(tubes: &[Tube], field: &Field, params: &SurfaceParams) -> Result<Self, SurfaceError> {
        let (low, high) = field.bounds();
        let radii = |t: &Tube| [t.ra, t.rb];
        let target = |r: f64| SIDE * params.edge_at(r);
        let largest = target(tubes.iter().flat_map(radii).fold(0.0, f64::max));
        let smallest = target(tubes.iter().flat_map(radii).fold(f64::INFINITY, f64::min));
        let side = (high - low).amax() + 4.0 * largest;
        let levels = libm::ceil(libm::log2(side / smallest));
        if levels.is_nan() || levels > DEEPEST as f64 {
            return Err(SurfaceError::TooLarge { cells: side / smallest, limit: 1 << DEEPEST });
        }
        let origin = nalgebra::center(&low, &high) + Vec3::from(params.shift) * largest - Vec3::repeat(side / 2.0);
        let none = vec![FxHashSet::default(); levels.max(0.0) as usize + 2];
        Ok(Self { origin, side, leaves: none.clone(), graded: none })
    }

    /// Level of the smallest leaves.
    fn finest(&self) -> usize {
        self.leaves.len() - 2
    }

    /// Adds the leaves.
    fn divide(
        &mut self,
        tubes: &[Tube],
        field: &Field,
        params: &SurfaceParams,
        watch: &Watch,
    ) -> Result<(), SurfaceError> {
        let sides = (0..=self.finest()).map(|level| self.side / f64::from(1u32 << level));
        let mut wide: Vec<Option<Field>> = sides.map(|side| field.of_wide(WIDE * side)).collect();
        let mut pending = vec![Pending { level: 0, at: [0; 3], near: (0..tubes.len() as u32).collect() }];
        let mut count = 0;
        while let Some(Pending { level, at, near }) = pending.pop() {
            count += 1;
            if count % ASKED_EVERY == 0 {
                watch.spend(ASKED_EVERY * near.len())?;
            }
            if count > params.max_cells {
                return Err(SurfaceError::TooLarge { cells: count as f64, limit: params.max_cells });
            }
            let side = self.side / f64::from(1u32 << level);
            let middle = self.origin + Vec3::from(at.map(|x| (f64::from(x) + 0.5) * side));
            let around: Vec<Nearby> = near.iter().map(|&i| Nearby::of(&tubes[i as usize], &middle, side)).collect();
            if around.iter().any(|tube| tube.is_around) || !around.iter().any(Nearby::may_cross) {
                continue;
            }
            if wide[level].as_mut().is_some_and(|wide| is_within(wide, &middle, side)) {
                continue;
            }
            let target = |tube: &Nearby| params.edge_at(tube.radius) + GROWTH * tube.away.max(0.0);
            if level == self.finest() || side <= SIDE * around.iter().map(target).fold(f64::INFINITY, f64::min) {
                self.leaves[level].insert(at);
                continue;
            }
            let is_near = |tube: &Nearby| tube.may_cross() || SIDE * target(tube) < side / 2.0;
            let kept = near.iter().zip(&around).filter(|(_, tube)| is_near(tube));
            let near: Rc<[u32]> = kept.map(|(&i, _)| i).collect();
            pending.extend(children(at).map(|at| Pending { level: level + 1, at, near: Rc::clone(&near) }));
        }
        Ok(())
    }

    /// Divides leaves until those that touch differ by one level at most.
    fn balance(&mut self, max_leaves: usize, watch: &Watch) -> Result<(), SurfaceError> {
        for level in (1..self.finest()).rev() {
            self.around_divided(level, watch, |octree, beside| octree.refine(beside, level))?;
            let count: usize = self.leaves.iter().map(FxHashSet::len).sum();
            if count > max_leaves {
                return Err(SurfaceError::TooLarge { cells: count as f64, limit: max_leaves });
            }
        }
        Ok(())
    }

    /// Finds the leaves that touch smaller ones, when levels are balanced.
    fn find_graded(&mut self, watch: &Watch) -> Result<(), SurfaceError> {
        for level in 0..self.finest() {
            self.around_divided(level, watch, |octree, beside| {
                if octree.leaves[level].contains(&beside) {
                    octree.graded[level].insert(beside);
                }
            })?;
        }
        Ok(())
    }

    /// Calls `each` for the cubes of a level that touch a divided one.
    fn around_divided(
        &mut self,
        level: usize,
        watch: &Watch,
        mut each: impl FnMut(&mut Self, Index),
    ) -> Result<(), SurfaceError> {
        let divided: FxHashSet<Index> = self.leaves[level + 1].iter().map(|at| at.map(|x| x >> 1)).collect();
        for (i, at) in divided.into_iter().enumerate() {
            if i.is_multiple_of(ASKED_EVERY) {
                watch.spend(ASKED_EVERY * OPERATIONS)?;
            }
            for beside in around(at, level) {
                each(self, beside);
            }
        }
        Ok(())
    }

    /// Divides the leaf that contains a cube, if it is larger.
    fn refine(&mut self, cube: Index, level: usize) {
        let within = |above: usize| cube.map(|x| x >> (level - above));
        let Some(first) = (0..level).find(|&above| self.leaves[above].contains(&within(above))) else { return };
        for above in first..level {
            self.leaves[above].remove(&within(above));
            self.leaves[above + 1].extend(children(within(above)));
        }
    }

    /// Side of a leaf in half cells of the finest level.
    fn size(&self, level: usize) -> u32 {
        2 << (self.finest() - level)
    }

    /// Corners of the tetrahedra of a leaf that touches no smaller one.
    fn points(&self, level: usize, leaf: &Index) -> impl Iterator<Item = Index> {
        let half = self.size(level) / 2;
        let corner = leaf.map(|x| 2 * x * half);
        let steps = (0..27).map(|k: u32| [k % 3, k / 3 % 3, k / 9]);
        // The middles of edges are left out.
        let used = steps.filter(|step| step.iter().filter(|&&x| x == 1).count() != 1);
        used.map(move |step| std::array::from_fn(|k| corner[k] + step[k] * half))
    }

    /// Calls `each` with the corners of the positive tetrahedra of a leaf, in half cells.
    fn tets(&self, level: usize, leaf: &Index, mut each: impl FnMut([Index; 4])) {
        let is_graded = self.graded[level].contains(leaf);
        let size = self.size(level);
        let corner = leaf.map(|x| x * size);
        let middle = corner.map(|x| x + size / 2);
        for (axis, end) in (0..3).flat_map(|axis| [(axis, 0), (axis, 1)]) {
            let face = Face { at: moved(corner, axis, end * size), size, axis, end, level };
            if is_graded && self.is_face_divided(&face) {
                for quarter in face.quarters() {
                    self.fan(&quarter, middle, is_graded, &mut each);
                }
            } else {
                self.fan(&face, middle, is_graded, &mut each);
            }
        }
    }

    /// Tetrahedra between the middle of a leaf, that of a face, and the edges of the face.
    fn fan(&self, face: &Face, middle: Index, is_graded: bool, each: &mut impl FnMut([Index; 4])) {
        let ([u, v], size) = (face.across(), face.size);
        let centre = moved(moved(face.at, u, size / 2), v, size / 2);
        let ring = [face.at, moved(face.at, u, size), moved(moved(face.at, u, size), v, size), moved(face.at, v, size)];
        for i in 0..4 {
            let (p, q) = (ring[i], ring[(i + 1) % 4]);
            let (p, q) = if face.end == 1 { (p, q) } else { (q, p) };
            if is_graded && self.is_edge_divided(p, q, face.level) {
                let half: Index = std::array::from_fn(|k| p[k].midpoint(q[k]));
                each([middle, centre, p, half]);
                each([middle, centre, half, q]);
            } else {
                each([middle, centre, p, q]);
            }
        }
    }

    /// True if leaves of the next level are on the other side of a face.
    fn is_face_divided(&self, face: &Face) -> bool {
        face.quarters().iter().any(|quarter| {
            let mut beyond = quarter.at.map(|x| x / quarter.size);
            let Some(across) = (beyond[face.axis] + face.end).checked_sub(1) else { return false };
            beyond[face.axis] = across;
            self.leaves[quarter.level].contains(&beyond)
        })
    }

    /// True if leaves of the next level have a half of an edge.
    fn is_edge_divided(&self, p: Index, q: Index, level: usize) -> bool {
        let low: Index = std::array::from_fn(|k| p[k].min(q[k]));
        let Some(axis) = (0..3).find(|&k| p[k] != q[k]) else { return false };
        let half = p[axis].abs_diff(q[axis]) / 2;
        let first = low.map(|x| x / half);
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        (0..8).any(|k: u32| {
            let mut at = moved(first, axis, k & 1);
            let Some(i) = (at[u] + (k >> 1 & 1)).checked_sub(1) else { return false };
            let Some(j) = (at[v] + (k >> 2)).checked_sub(1) else { return false };
            (at[u], at[v]) = (i, j);
            self.leaves[level + 1].contains(&at)
        })
    }

    /// Place of a point in half cells.
    fn place(&self, at: Index) -> Point3 {
        let half = self.side / f64::from(2u32 << self.finest());
        self.origin + Vec3::from(at.map(|x| f64::from(x) * half))
    }
}

fn moved(mut at: Index, axis: usize, by: u32) -> Index {
    at[axis] += by;
    at
}

fn children(at: Index) -> impl Iterator<Item = Index> {
    (0..8).map(move |c: u32| std::array::from_fn(|k| 2 * at[k] + (c >> k & 1)))
}

/// Cubes of the same level that touch a cube.
fn around(at: Index, level: usize) -> impl Iterator<Item = Index> {
    let last = (1u32 << level) - 1;
    let steps = (0..27).filter(|&k| k != 13).map(|k: u32| [k % 3, k / 3 % 3, k / 9]);
    steps.filter_map(move |step| {
        let to: Index = std::array::from_fn(|k| (at[k] + step[k]).wrapping_sub(1));
        to.iter().all(|&x| x <= last).then_some(to)
    })
}

/// True if a cube is within the wall of wide vessels.
fn is_within(wide: &mut Field, middle: &Point3, side: f64) -> bool {
    let (value, gradient) = wide.value_and_gradient(middle);
    value + CURVED * gradient.norm() * reach(side) + MARGIN < 1.0
}

/// Distance of a cube's corners from its middle.
fn reach(side: f64) -> f64 {
    side * 0.75_f64.sqrt()
}

/// A vessel as seen from a cube.
struct Nearby {
    radius: f64,
    /// Minimum distance of the cube from the vessel.
    away: f64,
    /// True if the cube is deep inside the vessel.
    is_around: bool,
}

impl Nearby {
    fn of(tube: &Tube, middle: &Point3, side: f64) -> Self {
        let reach = reach(side);
        let (share, distance) = point_segment(middle, &tube.a, &tube.b);
        let length = tube.length();
        let slope = (tube.rb - tube.ra).abs() / length.max(f64::MIN_POSITIVE);
        let at = tube.radius(share);
        let [least, most] =
            [(at - slope * reach).max(tube.ra.min(tube.rb)), (at + slope * reach).min(tube.max_radius())];
        let is_around = distance + reach < (1.0 - DEEP) * least;
        Self { radius: least, away: distance - most - reach, is_around }
    }

    /// True if the wall of the vessel may cross the cube.
    fn may_cross(&self) -> bool {
        self.away <= BLENDING * self.radius
    }
}

/// Marching tetrahedra.
struct Marching<'a> {
    octree: &'a Octree,
    field: &'a mut Field,
    /// Values at points, less the level.
    values: FxHashMap<Index, f64>,
    /// Vertices by the ends of their edges.
    vertices: FxHashMap<[Index; 2], u32>,
    mesh: TriMesh,
}

/// Even permutations of the corners of a tetrahedron by the set of those inside: these come first, or a single one outside.
fn order(inside: u8) -> [usize; 4] {
    match inside {
        0b0010 | 0b1101 => [1, 0, 3, 2],
        0b0100 | 0b1011 | 0b1100 => [2, 3, 0, 1],
        0b1000 | 0b0111 => [3, 2, 1, 0],
        0b0101 => [0, 2, 3, 1],
        0b1001 => [0, 3, 1, 2],
        0b0110 => [1, 2, 0, 3],
        0b1010 => [1, 3, 2, 0],
        _ => [0, 1, 2, 3],
    }
}

impl Marching<'_> {
    /// Adds the triangles within a leaf.
    fn leaf(&mut self, level: usize, leaf: &Index) {
        let octree = self.octree;
        if !octree.graded[level].contains(leaf) {
            let mut signs = octree.points(level, leaf).map(|at| self.value(at) < 0.0);
            let first = signs.next();
            if signs.all(|sign| Some(sign) == first) {
                return;
            }
        }
        octree.tets(level, leaf, |tet| self.march(tet));
    }

    /// Adds the triangles within a positive tetrahedron.
    fn march(&mut self, tet: [Index; 4]) {
        let values = tet.map(|at| self.value(at));
        let inside = (0..4).fold(0, |set, i| set | u8::from(values[i] < 0.0) << i);
        let [a, b, c, d] = order(inside);
        let mut vertex = |i: usize, j: usize| self.vertex([tet[i], tet[j]], [values[i], values[j]]);
        match inside.count_ones() {
            1 => {
                let triangle = [vertex(a, b), vertex(a, c), vertex(a, d)];
                self.mesh.triangles.push(triangle);
            }
            3 => {
                let triangle = [vertex(a, c), vertex(a, b), vertex(a, d)];
                self.mesh.triangles.push(triangle);
            }
            2 => {
                let quad = [vertex(a, c), vertex(a, d), vertex(b, d), vertex(b, c)];
                self.mesh.triangles.extend([[quad[0], quad[1], quad[2]], [quad[0], quad[2], quad[3]]]);
            }
            _ => {}
        }
    }

    fn value(&mut self, at: Index) -> f64 {
        let (octree, field) = (self.octree, &mut *self.field);
        *self.values.entry(at).or_insert_with(|| field.value(&octree.place(at)) - 1.0)
    }

    fn vertex(&mut self, [p, q]: [Index; 2], [at_p, at_q]: [f64; 2]) -> u32 {
        let (key, share) = if p < q { ([p, q], at_p / (at_p - at_q)) } else { ([q, p], at_q / (at_q - at_p)) };
        let (octree, points) = (self.octree, &mut self.mesh.points);
        *self.vertices.entry(key).or_insert_with(|| {
            let [from, to] = key.map(|at| octree.place(at));
            points.push(from + (to - from) * share.clamp(INWARD, 1.0 - INWARD));
            points.len() as u32 - 1
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::euler_characteristic;
    use super::super::halfedge::HalfEdges;
    use super::*;
    use anastomesh_skeleton::resolution::KAPPA;

    fn tube(a: [f64; 3], b: [f64; 3], radius: f64) -> Tube {
        Tube { a: a.into(), b: b.into(), ra: radius, rb: radius }
    }

    /// A wide vessel with a thin branch.
    fn branch(thin: f64) -> ([Tube; 3], SurfaceParams) {
        let tubes = [
            tube([-5.0, 0.0, 0.0], [0.0; 3], 1.0),
            tube([0.0; 3], [5.0, 0.1, 0.2], 1.0),
            tube([0.0; 3], [0.1, 1.0 + 20.0 * thin, 0.0], thin),
        ];
        let params = SurfaceParams { thin, follow: 1.0, ..SurfaceParams::with_voxel(2.0 / 3.0 * thin) };
        (tubes, params)
    }

    #[test]
    fn contours_are_closed_and_grow_little_with_the_ratio_of_radii() {
        let mut counts = Vec::new();
        for thin in [1e-1, 1e-2, 1e-3, 1e-4, 1e-6] {
            let (tubes, params) = branch(thin);
            let mut field = Field::new(&tubes, KAPPA).expect("a field");
            let mesh = contour(&tubes, &mut field, &params, &Watch::NOBODY).expect("a contour");
            HalfEdges::new(&mesh).expect("a closed manifold");
            assert_eq!(euler_characteristic(&mesh), 2, "{thin}");
            // Crossings are at the wall, but for the distance that is kept from ends of edges.
            let off = mesh.points.iter().map(|p| (field.value(p) - 1.0).abs()).fold(0.0, f64::max);
            assert!(off < 0.2, "{thin}: {off}");
            counts.push(mesh.triangles.len());
        }
        assert!(counts.iter().all(|&count| count < 4 * counts[0]), "{counts:?}");
    }

    #[test]
    fn branches_at_one_node_are_joined_to_the_vessel() {
        // Where many vessels meet, the field gives each less weight, so the wall is within that of the wide vessel alone.
        let (tubes, params) = branch(1e-3);
        let other = |x: f64, y: f64, z: f64, radius| tube([0.0; 3], [x, 1.1 * y, 1.1 * z], radius);
        let more =
            [other(0.0, -0.8, 0.6, 1e-3), other(0.0, 0.0, -1.0, 0.05), tube([-6.0, 0.0, 0.0], [-5.0, 0.0, 0.0], 1.0)];
        let tubes = [&tubes[..], &more, &[tube([5.0, 0.1, 0.2], [6.0, 0.12, 0.24], 1.0)]].concat();
        let mut field = Field::new(&tubes, KAPPA).expect("a field");
        let mesh = contour(&tubes, &mut field, &params, &Watch::NOBODY).expect("a contour");
        HalfEdges::new(&mesh).expect("a closed manifold");
        assert_eq!(euler_characteristic(&mesh), 2);
    }

    #[test]
    fn leaves_that_touch_differ_by_one_level() {
        let (tubes, params) = branch(0.05);
        let field = Field::new(&tubes, KAPPA).expect("a field");
        let mut octree = Octree::new(&tubes, &field, &params).expect("a root");
        // One small leaf in the corner of the root.
        let finest = octree.finest();
        octree.leaves[0].insert([0; 3]);
        octree.refine([0; 3], finest);
        assert_eq!(octree.leaves.iter().map(FxHashSet::len).sum::<usize>(), 7 * finest + 1);
        let small: Vec<Index> = octree.leaves[finest].drain().collect();
        octree.leaves[finest - 1].insert([0; 3]);
        octree.refine([1 << (finest - 1); 3].map(|x| x - 1), finest);
        octree.balance(usize::MAX, &Watch::NOBODY).expect("levels");
        octree.find_graded(&Watch::NOBODY).expect("levels");
        for level in 2..=finest {
            for leaf in &octree.leaves[level] {
                for beside in around(leaf.map(|x| x >> 1), level - 1) {
                    let within = |above: usize| beside.map(|x| x >> (level - 1 - above));
                    assert!((0..level - 1).all(|above| !octree.leaves[above].contains(&within(above))), "{leaf:?}");
                }
            }
        }
        assert!(small.len() == 8 && octree.graded.iter().any(|graded| !graded.is_empty()));
    }

    #[test]
    fn contours_can_be_stopped_and_are_bounded() {
        let (tubes, params) = branch(1e-3);
        let mut field = Field::new(&tubes, KAPPA).expect("a field");
        let few = SurfaceParams { max_cells: 1000, ..params };
        assert!(matches!(
            contour(&tubes, &mut field, &few, &Watch::NOBODY),
            Err(SurfaceError::TooLarge { limit: 1000, .. })
        ));
        let (tubes, params) = branch(1e-9);
        let mut field = Field::new(&tubes, KAPPA).expect("a field");
        assert!(matches!(contour(&tubes, &mut field, &params, &Watch::NOBODY), Err(SurfaceError::TooLarge { .. })));
    }
}
