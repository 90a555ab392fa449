//! Assignment of points and boundary faces to the surfaces of an MSH file, one per patch.
//!
//! A point belongs to the surface of lowest id that has a face with it, or else to the inside. The first surface (the
//! vessel wall, nearly all of the boundary) is stored as one bit per point. Its faces are read again for writing. The
//! few faces of other surfaces (caps) are held in memory.

use anastomesh_mesh::bits::Bits;
use anastomesh_mesh::geometry::{Aabb, Point3};
use anastomesh_mesh::source::MeshSource;
use rustc_hash::FxHashMap;
use std::io;

/// Boundary faces of one patch.
pub(super) struct Surface {
    pub patch: i32,
    /// Number of faces.
    pub faces: usize,
    /// Number of points that are on no earlier surface.
    pub points: usize,
    /// Bounding box.
    pub bounds: Aabb,
}

/// Face of a surface other than the first.
pub(super) struct HeldFace {
    patch: i32,
    /// Index among the boundary faces.
    pub face: usize,
    pub corners: [u32; 3],
}

/// Surfaces of a mesh, in ascending order of their patches.
pub(super) struct Surfaces {
    /// Surfaces with faces.
    pub list: Vec<Surface>,
    /// Points of the first surface.
    pub first: Bits,
    /// All points on the boundary.
    pub outer: Bits,
    /// Faces of the other surfaces, by surface.
    held: Vec<HeldFace>,
    /// Points of the other surfaces, ascending, including those shared with the first.
    points: Vec<(u32, Point3)>,
    /// Points owned by the other surfaces, by surface: indices into `points`.
    owned: Vec<(i32, u32)>,
    /// Bounding box of all points.
    pub bounds: Aabb,
    /// Largest patch id in use.
    pub largest: Option<i32>,
}

impl Surfaces {
    /// Reads the boundary twice and the points once. Faces without a patch belong to no surface.
    ///
    /// # Errors
    /// The mesh source fails; `InvalidData` if a face refers to a missing point.
    pub(super) fn of(mesh: &dyn MeshSource) -> io::Result<Self> {
        let points = mesh.counts().points;
        let mut surfaces = Self {
            list: counted(mesh)?,
            first: Bits::new(points),
            outer: Bits::new(points),
            held: Vec::new(),
            points: Vec::new(),
            owned: Vec::new(),
            bounds: Aabb::EMPTY,
            largest: None,
        };
        surfaces.largest = surfaces.list.last().map(|surface| surface.patch);
        surfaces.read_faces(mesh)?;
        surfaces.give_points();
        surfaces.read_points(mesh)?;
        surfaces.bound();
        Ok(surfaces)
    }

    fn read_faces(&mut self, mesh: &dyn MeshSource) -> io::Result<()> {
        let Some(first) = self.list.first().map(|surface| surface.patch) else { return Ok(()) };
        let mut before = 0;
        mesh.each_faces(|piece| {
            for (i, (&corners, &patch)) in piece.faces.iter().zip(&*piece.patches).enumerate() {
                if patch != first {
                    self.held.push(HeldFace { patch, face: before + i, corners });
                }
                for v in corners {
                    let there = self.outer.insert(v) && (patch != first || self.first.insert(v));
                    if !there {
                        return Err(io::Error::new(
                            io::ErrorKind::InvalidData,
                            format!("boundary face {} names the point {v}, which does not exist", before + i),
                        ));
                    }
                }
            }
            before += piece.faces.len();
            Ok(())
        })?;
        // Stable sort: faces stay in order.
        self.held.sort_by_key(|held| held.patch);
        Ok(())
    }

    /// Assigns each point of the held faces to the first surface that contains it.
    fn give_points(&mut self) {
        let mut ids: Vec<u32> = self.held.iter().flat_map(|held| held.corners).collect();
        ids.sort_unstable();
        ids.dedup();
        let mut given = vec![false; ids.len()];
        for held in &self.held {
            for v in held.corners {
                let Ok(index) = ids.binary_search(&v) else { continue };
                if !self.first.has(v) && !std::mem::replace(&mut given[index], true) {
                    self.owned.push((held.patch, index as u32));
                }
            }
        }
        self.owned.sort_unstable();
        self.points = ids.into_iter().map(|v| (v, Point3::origin())).collect();
    }

    /// Reads the positions of points on held faces, and the boxes of all points and of the first surface.
    fn read_points(&mut self, mesh: &dyn MeshSource) -> io::Result<()> {
        let (mut before, mut next) = (0_u32, 0);
        let mut of_first = Aabb::EMPTY;
        mesh.each_points(|points| {
            for (v, p) in (before..).zip(points) {
                self.bounds.include(p);
                if self.first.has(v) {
                    of_first.include(p);
                }
                if let Some(held) = self.points.get_mut(next).filter(|held| held.0 == v) {
                    held.1 = *p;
                    next += 1;
                }
            }
            before += points.len() as u32;
            Ok(())
        })?;
        if let Some(first) = self.list.first_mut() {
            first.bounds = of_first;
            first.points = self.first.count();
        }
        Ok(())
    }

    fn bound(&mut self) {
        for surface in self.list.iter_mut().skip(1) {
            surface.points = run(&self.owned, surface.patch, |owned| owned.0).len();
            for held in run(&self.held, surface.patch, |held| held.patch) {
                for v in held.corners {
                    if let Ok(i) = self.points.binary_search_by_key(&v, |point| point.0) {
                        surface.bounds.include(&self.points[i].1);
                    }
                }
            }
        }
    }

    /// Faces of a surface other than the first, in order.
    pub(super) fn faces_of(&self, patch: i32) -> &[HeldFace] {
        run(&self.held, patch, |held| held.patch)
    }

    /// Points of a surface other than the first, in order.
    pub(super) fn points_of(&self, patch: i32) -> impl Iterator<Item = &(u32, Point3)> {
        run(&self.owned, patch, |owned| owned.0).iter().filter_map(|&(_, i)| self.points.get(i as usize))
    }
}

/// Patches with their numbers of faces.
fn counted(mesh: &dyn MeshSource) -> io::Result<Vec<Surface>> {
    let mut faces: FxHashMap<i32, usize> = FxHashMap::default();
    mesh.each_faces(|piece| {
        for &patch in piece.patches.iter().take(piece.faces.len()) {
            *faces.entry(patch).or_default() += 1;
        }
        Ok(())
    })?;
    let surface = |(patch, faces)| Surface { patch, faces, points: 0, bounds: Aabb::EMPTY };
    let mut list: Vec<Surface> = faces.into_iter().map(surface).collect();
    list.sort_unstable_by_key(|surface| surface.patch);
    Ok(list)
}

/// Part of a sorted list with this key.
pub(super) fn run<T>(sorted: &[T], key: i32, of: impl Fn(&T) -> i32) -> &[T] {
    let start = sorted.partition_point(|item| of(item) < key);
    let length = sorted[start..].partition_point(|item| of(item) == key);
    &sorted[start..start + length]
}
