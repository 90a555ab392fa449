//! Boundaries of the regions around the vessels, in common numbers.
//!
//! Numbers count the points of the lumen's surface, then those of the shells, then those of the surfaces around the tissue.

use super::error::DomainError;
use super::organ::Surroundings;
use super::surface::LumenSurface;
use anastomesh_mesh::TriMesh;
use anastomesh_mesh::geometry::{DisjointSets, Point3};
use anastomesh_tet::Shells;
use rustc_hash::FxHashMap;
use std::ops::Range;

/// Lumen and shells, and the boundaries of the regions around them.
pub struct Layout<'a> {
    pub lumen: &'a LumenSurface,
    pub shells: &'a Shells,
    pub around: Option<&'a Surroundings>,
    pub outsides: Vec<Outside>,
    /// Surface that directly contains each point of lumen and shells; empty if all are in the first.
    homes: Vec<usize>,
}

/// Boundary of a region around the vessels, with its own points.
pub struct Outside {
    pub boundary: TriMesh,
    /// Number of each point, ascending.
    pub numbers: Vec<u32>,
    /// Triangles of each surface in the boundary.
    pub of_surfaces: Vec<(usize, Range<usize>)>,
}

impl<'a> Layout<'a> {
    /// Boundaries of all regions.
    ///
    /// # Errors
    /// The opening of the organ for a vessel cannot be joined to the vessel's end.
    pub fn new(
        lumen: &'a LumenSurface,
        shells: &'a Shells,
        around: Option<&'a Surroundings>,
    ) -> Result<Self, DomainError> {
        let mut layout = Self { lumen, shells, around, outsides: Vec::new(), homes: Vec::new() };
        let Some(around) = around else { return Ok(layout) };
        let vessels = layout.vessels(&|cap| around.openings.iter().all(|opening| opening.gate.cap != cap));
        if around.surfaces.len() > 1 {
            layout.homes = layout.find_homes(&vessels, around);
        }
        let outsides = (0..around.surfaces.len()).map(|region| layout.outside(region, &vessels, around));
        layout.outsides = outsides.collect::<Result<_, _>>()?;
        Ok(layout)
    }

    /// Boundaries of the regions around the vessels, the tissue first.
    pub fn outsides(&self) -> impl Iterator<Item = &TriMesh> {
        self.outsides.iter().map(|outside| &outside.boundary)
    }

    /// Number in the mesh of a point. Those of the lumen keep theirs, and all others follow its `of_lumen` points.
    pub fn in_mesh(&self, of_lumen: u32, v: u32) -> u32 {
        match v.checked_sub(self.lumen.points.len() as u32) {
            Some(i) => of_lumen + i,
            None => self.lumen.points[v as usize],
        }
    }

    /// Surface that directly contains a point of lumen or shells on the outside.
    pub fn home(&self, v: u32) -> usize {
        self.homes.get(v as usize).copied().unwrap_or(0)
    }

    /// Outer surface of the vessels, with some of their ends.
    fn vessels(&self, has_end: &dyn Fn(u32) -> bool) -> Vec<[u32; 3]> {
        let Self { lumen, shells, .. } = *self;
        let wall = || lumen.surface.triangles.iter().zip(&lumen.caps).filter(|(_, cap)| cap.is_none());
        let bare = || wall().map(|(t, _)| *t).collect();
        let mut triangles: Vec<[u32; 3]> = shells.sides.last().cloned().unwrap_or_else(bare);
        triangles.extend(self.ends(has_end));
        triangles
    }

    /// Ends of vessels with their shells.
    fn ends(&self, of: &dyn Fn(u32) -> bool) -> impl Iterator<Item = [u32; 3]> {
        let Self { lumen, shells, .. } = *self;
        let caps = lumen.surface.triangles.iter().zip(&lumen.caps).filter(move |(_, cap)| cap.is_some_and(of));
        let rings = shells.rings.iter().filter(move |ring| of(ring.cap));
        caps.map(|(t, _)| *t).chain(rings.flat_map(|ring| ring.triangles.iter().copied()))
    }

    fn place(&self, v: u32, around: &Surroundings) -> Point3 {
        let mut index = v as usize;
        let surfaces = around.surfaces.iter().map(|surface| &surface.points);
        for points in [&self.lumen.surface.points, &self.shells.points].into_iter().chain(surfaces) {
            match points.get(index) {
                Some(p) => return *p,
                None => index -= points.len(),
            }
        }
        Point3::origin()
    }

    /// Innermost surface around each point of the vessels. Each component lies on one side of every surface.
    fn find_homes(&self, vessels: &[[u32; 3]], around: &Surroundings) -> Vec<usize> {
        let count = self.lumen.surface.points.len() + self.shells.points.len();
        let mut joined = DisjointSets::new(count);
        for &[a, b, c] in vessels {
            joined.join(a, b);
            joined.join(b, c);
        }
        let mut roots: Vec<u32> = vessels.iter().map(|t| joined.find(t[0])).collect();
        roots.sort_unstable();
        roots.dedup();
        let places: Vec<Point3> = roots.iter().map(|&root| self.place(root, around)).collect();
        let of_root: FxHashMap<u32, usize> = roots.into_iter().zip(around.homes(&places)).collect();
        (0..count as u32).map(|v| of_root.get(&joined.find(v)).copied().unwrap_or(0)).collect()
    }

    /// Boundary of a region, oriented outwards: the vessels in it, its own surface, and the surfaces in it.
    fn outside(&self, region: usize, vessels: &[[u32; 3]], around: &Surroundings) -> Result<Outside, DomainError> {
        let mut triangles: Vec<[u32; 3]> = vessels.iter().filter(|t| self.home(t[0]) == region).copied().collect();
        for t in &mut triangles {
            t.swap(1, 2);
        }
        let mut of_surfaces = Vec::new();
        let inner = (1..around.surfaces.len()).filter(|&i| around.parents[i] == region && i != region);
        for i in [region].into_iter().chain(inner) {
            let before: usize = around.surfaces[..i].iter().map(|surface| surface.points.len()).sum();
            let first = (self.lumen.surface.points.len() + self.shells.points.len() + before) as u32;
            let start = triangles.len();
            let outward = |[a, b, c]: [u32; 3]| if i == region { [a, b, c] } else { [a, c, b] };
            triangles.extend(around.surfaces[i].triangles.iter().map(|t| outward(t.map(|v| v + first))));
            if i == 0 {
                for opening in &around.openings {
                    let place = |v| self.place(v, around);
                    triangles.extend(opening.ring(self.ends(&|cap| cap == opening.gate.cap), first, &place)?);
                }
            }
            of_surfaces.push((i, start..triangles.len()));
        }
        let mut numbers = triangles.as_flattened().to_vec();
        numbers.sort_unstable();
        numbers.dedup();
        let own: FxHashMap<u32, u32> = numbers.iter().copied().zip(0..).collect();
        triangles.as_flattened_mut().iter_mut().for_each(|v| *v = own[v]);
        let points = numbers.iter().map(|&v| self.place(v, around)).collect();
        Ok(Outside { boundary: TriMesh { points, triangles }, numbers, of_surfaces })
    }
}
