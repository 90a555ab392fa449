//! Regions: connected parts of the volume, bounded by frozen faces.

use super::complex::Complex;
use super::error::{SeedKind, TetError};
use super::plc::Region;
use anastomesh_mesh::geometry::predicates::orient3d;
use anastomesh_mesh::geometry::{Aabb, Bvh, Point3};

const UNSEEN: u32 = u32::MAX;

/// First tetrahedron in slot order that contains each point, including its boundary.
pub(super) fn tets_of_seeds(c: &Complex, seeds: &[Point3]) -> Vec<Option<u32>> {
    let mut found = vec![None; seeds.len()];
    if seeds.is_empty() {
        return found;
    }
    let boxes: Vec<Aabb> = seeds
        .iter()
        .map(|p| if p.iter().all(|x| x.is_finite()) { Aabb::of_points([p]) } else { Aabb::EMPTY })
        .collect();
    let tree = Bvh::new(&boxes);
    for t in c.real_tets() {
        let corners = c.verts(t).map(|v| &c.points[v as usize]);
        tree.query(&Aabb::of_points(corners), |seed| {
            let slot = &mut found[seed as usize];
            if slot.is_none() && holds(c, t, &seeds[seed as usize]) {
                *slot = Some(t);
            }
        });
    }
    found
}

/// True if a point lies inside or on the boundary of a tetrahedron.
fn holds(c: &Complex, t: u32, p: &Point3) -> bool {
    (0..4).all(|i| {
        let [a, b, d] = c.face(4 * t + i).map(|v| &c.points[v as usize]);
        orient3d(a, b, d, p) <= 0.0
    })
}

/// Connected parts of a carved complex.
pub(super) struct Regions {
    /// Region of each slot, numbered in the order of first slots.
    of: Vec<u32>,
    /// Id of each region.
    ids: Vec<i32>,
    /// Seed in each region.
    seeds: Vec<Option<u32>>,
    /// Seeds in regions with an earlier one, each with that one.
    ignored: Vec<[u32; 2]>,
}

impl Regions {
    /// Finds the regions of a carved complex. Each takes the id of its first seed; the others take the smallest
    /// positive ids that no seed has.
    ///
    /// # Errors
    /// [`TetError::BadSeed`] for a seed outside.
    pub(super) fn of(c: &Complex, seeds: &[Region]) -> Result<Self, TetError> {
        let (of, count) = flood(c);
        let places: Vec<Point3> = seeds.iter().map(|r| r.seed).collect();
        let mut seed_of = vec![None; count];
        let mut ignored = Vec::new();
        for (index, (t, &position)) in (0..).zip(tets_of_seeds(c, &places).into_iter().zip(&places)) {
            let t = t.ok_or(TetError::BadSeed { seed: SeedKind::Region, index, position })?;
            let first = *seed_of[of[t as usize] as usize].get_or_insert(index);
            if first != index {
                ignored.push([index, first]);
            }
        }
        let mut taken: Vec<i32> = seeds.iter().map(|r| r.id).collect();
        taken.sort_unstable();
        let mut free = (1..).filter(|id| taken.binary_search(id).is_err());
        let ids = seed_of
            .iter()
            .map(|seed| match seed {
                Some(s) => seeds[*s as usize].id,
                None => free.next().unwrap_or(i32::MAX),
            })
            .collect();
        Ok(Self { of, ids, seeds: seed_of, ignored })
    }

    /// Seed of each region.
    pub(super) fn seeds(&self) -> impl Iterator<Item = Option<u32>> {
        self.seeds.iter().copied()
    }

    /// Region of each slot.
    pub(super) fn into_slots(self) -> Vec<u32> {
        self.of
    }

    /// Seeds in regions with an earlier one, each with that one.
    pub(super) fn into_ignored(self) -> Vec<[u32; 2]> {
        self.ignored
    }

    /// Number of regions.
    pub(super) fn len(&self) -> usize {
        self.ids.len()
    }

    /// True if there are several regions, or a seed names the only one.
    pub(super) fn matter(&self) -> bool {
        self.len() > 1 || self.seeds.iter().any(Option::is_some)
    }

    /// Id of each real tetrahedron, in slot order.
    pub(super) fn ids(&self, c: &Complex) -> Vec<i32> {
        c.real_tets().map(|t| self.ids[self.of[t as usize] as usize]).collect()
    }
}

/// Region of each slot, and the number of regions.
fn flood(c: &Complex) -> (Vec<u32>, usize) {
    let mut of = vec![UNSEEN; c.slots()];
    let mut stack = Vec::new();
    let mut count = 0;
    for start in c.real_tets() {
        if of[start as usize] != UNSEEN {
            continue;
        }
        of[start as usize] = count;
        stack.push(start);
        while let Some(t) = stack.pop() {
            for i in 0..4 {
                let half = 4 * t + i;
                let n = c.mate(half) >> 2;
                if of[n as usize] == UNSEEN && !c.is_frozen(half) && !c.is_ghost(n) {
                    of[n as usize] = count;
                    stack.push(n);
                }
            }
        }
        count += 1;
    }
    (of, count as usize)
}
