//! The whole mesh as a plan over stored blocks: which number each vertex and tetrahedron gets, and passes over them in
//! that order. Nothing but the plan is held; blocks are read when their turn comes.

mod left;
mod numbering;
#[cfg(test)]
mod tests;

use std::borrow::Cow;
use std::io;

use rayon::prelude::*;

use super::blocks::{Blocks, Meetings};
use super::make::JointPlace;
use super::report::MeshSize;
use super::store::{Store, StoredBytes};
use crate::block::{Connectivity, FinishedCap, FinishedJoint, Geometry, Record};
use anastomesh_flow::TerminalPatches;
use anastomesh_mesh::check::parts::{Certificate, FacesApart, Looked, Parts};
use anastomesh_mesh::geometry::{Aabb, Point3};
use anastomesh_mesh::progress::{Progress, ask};
use anastomesh_mesh::source::{FacePiece, LabelPiece, MeshSource, SourceCounts, TetPiece};
use anastomesh_mesh::{Patch, WALL};
use anastomesh_skeleton::Skeleton;
use numbering::{Numbering, PartPlan};

pub use left::LeftWhole;

/// The whole mesh: a plan, and the store of its blocks.
#[derive(Debug)]
pub struct Whole<'a> {
    store: &'a Store,
    listener: CancelOnly<'a>,
    plan: Cow<'a, Numbering>,
}

/// Listener that can stop the run.
struct CancelOnly<'a>(&'a dyn Progress);

impl std::fmt::Debug for CancelOnly<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        f.write_str("Listener")
    }
}

/// Number of blocks read at a time to assemble the boundary.
const READ: usize = 1 << 14;

impl<'a> Whole<'a> {
    /// Numbers everything.
    ///
    /// # Errors
    /// There are too many vertices, or a block cannot be read.
    pub(crate) fn new(
        store: &'a Store,
        progress: &'a dyn Progress,
        skeleton: &Skeleton,
        blocks: &Blocks,
        terminals: &TerminalPatches,
    ) -> io::Result<Self> {
        let first_patch = terminals.of.values().map(|(id, _)| *id).max().unwrap_or(WALL) + 1;
        let plan = Numbering::of(blocks, first_patch)?;
        let mut whole = Self { store, listener: CancelOnly(progress), plan: Cow::Owned(plan) };
        let (outer, caps) = whole.boundary_of_blocks()?;
        let boundary = outer + whole.open_faces()?;
        let plan = whole.plan.to_mut();
        plan.counts.boundary = boundary;
        for cap in &caps {
            plan.cap_faces += cap.faces.len();
            let Some((id, name)) = terminals.of.get(&cap.node) else { continue };
            let disc = cap.disc(skeleton.node(cap.node).original);
            plan.patches.push(Patch { id: *id, name: name.clone(), cap: Some(disc) });
            plan.patch_of.push((cap.node.0, *id));
        }
        plan.patches.sort_by_key(|patch| patch.id);
        plan.patch_of.sort_unstable();
        Ok(whole)
    }

    /// Numbers everything as far as walls need it: joints that are open are known, caps are wall.
    ///
    /// # Errors
    /// There are too many vertices.
    pub(crate) fn of_walls(store: &'a Store, progress: &'a dyn Progress, blocks: &Blocks) -> io::Result<Self> {
        let plan = Cow::Owned(Numbering::of(blocks, WALL + 1)?);
        Ok(Self { store, listener: CancelOnly(progress), plan })
    }

    /// Counts boundary faces that are in no joint, and collects the caps, in order.
    fn boundary_of_blocks(&self) -> io::Result<(usize, Vec<FinishedCap>)> {
        let read = |part: &PartPlan| {
            let sizes = self.connectivity(*part)?.sizes();
            let caps = if sizes.caps > 0 { self.record(*part)?.caps()? } else { Vec::new() };
            Ok((sizes.outer_faces() as usize, caps))
        };
        let (mut faces, mut caps) = (0, Vec::new());
        for some in self.plan.parts.chunks(READ) {
            for (more, found) in some.par_iter().map(read).collect::<io::Result<Vec<_>>>()? {
                faces += more;
                caps.extend(found);
            }
        }
        Ok((faces, caps))
    }

    /// Counts the faces of joints that nothing is joined to.
    fn open_faces(&self) -> io::Result<usize> {
        let mut faces = 0;
        for place in self.plan.open.keys() {
            let joints = self.connectivity(self.plan.part(place.part))?.joints()?;
            faces += joints.get(place.joint as usize).map_or(0, |joint| joint.faces.len());
        }
        Ok(faces)
    }

    /// The geometry of a part. Every pass reads one of its records, so all of them ask whether to stop.
    fn geometry(&self, part: PartPlan) -> io::Result<Geometry<StoredBytes<'_>>> {
        ask(self.listener.0)?;
        self.store.geometry(part.records.geometry)
    }

    /// The connectivity of a part.
    fn connectivity(&self, part: PartPlan) -> io::Result<Connectivity<StoredBytes<'_>>> {
        ask(self.listener.0)?;
        self.store.connectivity(part.records.connectivity)
    }

    /// Both records of a part.
    fn record(&self, part: PartPlan) -> io::Result<Record<StoredBytes<'_>>> {
        ask(self.listener.0)?;
        self.store.block(part.records)
    }

    /// Numbers in the whole of the vertices of a part, of which `count` are shared.
    fn numbers(&self, part: u32, count: u32) -> io::Result<PointNumbers> {
        let mut shared = Vec::with_capacity(count as usize);
        for &[(cluster, joint), _] in self.plan.joined_to(part) {
            let cluster = self.plan.part(cluster);
            let joints = self.connectivity(cluster)?.joints()?;
            // Clusters share nothing, so all of their vertices are their own.
            let vertices = joints.get(joint as usize).map_or(&[][..], |joint| &joint.vertices);
            shared.extend(vertices.iter().map(|v| cluster.first_point + v));
        }
        if shared.len() != count as usize {
            return Err(io::Error::new(io::ErrorKind::InvalidData, "two blocks have different discs at their joint"));
        }
        Ok(PointNumbers { shared, first: self.plan.part(part).first_point, own: self.plan.points_of(part) })
    }

    /// Reads a part for a single request.
    fn numbers_alone(&self, part: u32) -> io::Result<Vec<u32>> {
        Ok(self.numbers(part, self.connectivity(self.plan.part(part))?.sizes().shared)?.all())
    }

    /// Boundary faces of the whole that a part has, ascending, each with its patch.
    fn outer_faces(&self, part: u32, connectivity: &Connectivity<StoredBytes>) -> io::Result<Vec<(u32, i32)>> {
        let mut faces: Vec<(u32, i32)> = connectivity.wall()?.into_iter().map(|face| (face, WALL)).collect();
        if connectivity.sizes().caps > 0 {
            let patch_of = &self.plan.patch_of;
            for cap in self.record(self.plan.part(part))?.caps()? {
                let found = patch_of.binary_search_by_key(&cap.node.0, |(node, _)| *node);
                let patch = found.map_or(WALL, |i| patch_of[i].1);
                faces.extend(cap.faces.into_iter().map(|face| (face, patch)));
            }
        }
        let first = JointPlace { part, joint: 0 };
        let last = JointPlace { part, joint: u32::MAX };
        if self.plan.open.range(first..=last).next().is_some() {
            let joints = connectivity.joints()?;
            for (place, patch) in self.plan.open.range(first..=last) {
                let open = joints.get(place.joint as usize).into_iter().flat_map(|j| &j.faces);
                faces.extend(open.map(|&face| (face, *patch)));
            }
        }
        faces.sort_unstable();
        Ok(faces)
    }

    /// Counts it.
    pub(crate) fn size(&self) -> MeshSize {
        let SourceCounts { points, tets, boundary } = self.plan.counts;
        let cap_triangles = self.plan.cap_faces;
        MeshSize { tets, points, wall_triangles: boundary - cap_triangles, cap_triangles }
    }

    /// First half of its check. `memory` limits the bytes of walls that are in memory at a time.
    ///
    /// # Errors
    /// A block cannot be read.
    pub(crate) fn look(&self, memory: u64) -> io::Result<Looked<'_>> {
        Looked::at(self, memory as usize)
    }

    /// The number of a part among all blocks, those that are missing included.
    pub(crate) fn block_of(&self, part: u32) -> u32 {
        self.plan.part(part).block as u32
    }

    /// The numbers of all parts, in order.
    pub(crate) fn blocks(&self) -> impl Iterator<Item = u32> {
        self.plan.parts.iter().map(|part| part.block as u32)
    }

    /// Pairs of blocks whose walls meet, by their numbers.
    pub(crate) fn blocks_that_meet(&self, looked: &Looked) -> Meetings {
        looked.meeting().iter().map(|pair| pair.map(|part| self.block_of(part))).collect()
    }

    /// The box of a part's boundary.
    ///
    /// # Errors
    /// The block cannot be read.
    pub(crate) fn bounds(&self, part: u32) -> io::Result<Aabb> {
        Ok(self.certificate(part)?.bounds())
    }

    /// The vertices of every joint, by their numbers in the whole.
    ///
    /// # Errors
    /// A block cannot be read.
    #[cfg(feature = "woven")]
    pub(crate) fn joint_vertices(&self) -> io::Result<Vec<Vec<u32>>> {
        let mut all = Vec::with_capacity(self.plan.joined.len());
        for part in self.plan.clusters..self.plan.parts.len() as u32 {
            let connectivity = self.connectivity(self.plan.part(part))?;
            let numbers = self.numbers(part, connectivity.sizes().shared)?;
            let joints = connectivity.joints()?;
            all.extend(joints.iter().map(|joint| joint.vertices.iter().map(|&v| numbers.of(v)).collect()));
        }
        Ok(all)
    }
}

impl MeshSource for Whole<'_> {
    fn counts(&self) -> SourceCounts {
        self.plan.counts
    }

    fn patches(&self) -> &[Patch] {
        &self.plan.patches
    }

    fn parts(&self) -> u32 {
        self.plan.parts.len() as u32
    }

    fn points(&self, part: u32) -> io::Result<Cow<'_, [Point3]>> {
        let mut points = self.geometry(self.plan.part(part))?.points()?;
        let shared = points.len().saturating_sub(self.plan.points_of(part) as usize);
        points.drain(..shared);
        Ok(points.into())
    }

    fn points_of(&self, ids: &[u32]) -> io::Result<Vec<Point3>> {
        let mut found = Vec::with_capacity(ids.len());
        while let Some(&id) = ids.get(found.len()) {
            // Of parts that begin with the same number, only the last has points of its own.
            let part = self.plan.parts.partition_point(|part| part.first_point <= id).saturating_sub(1);
            let first = self.plan.parts[part].first_point;
            let points = self.points(part as u32)?;
            let here = ids[found.len()..].iter().map_while(|&id| points.get(id.checked_sub(first)? as usize));
            let before = found.len();
            found.extend(here.copied());
            if found.len() == before {
                return Err(io::Error::new(io::ErrorKind::InvalidInput, format!("there is no point {id}")));
            }
        }
        Ok(found)
    }

    fn tets(&self, part: u32) -> io::Result<TetPiece<'_>> {
        let plan = self.plan.part(part);
        let connectivity = self.connectivity(plan)?;
        let numbers = self.numbers(part, connectivity.sizes().shared)?.all();
        let mut tets = connectivity.tets()?;
        tets.as_flattened_mut().iter_mut().for_each(|v| *v = numbers[*v as usize]);
        let blocks = vec![plan.block; tets.len()].into();
        Ok(TetPiece { tets: tets.into(), blocks })
    }

    fn boundary(&self, part: u32) -> io::Result<FacePiece<'_>> {
        let plan = self.plan.part(part);
        let connectivity = self.connectivity(plan)?;
        let numbers = self.numbers(part, connectivity.sizes().shared)?;
        let (faces, patches): (Vec<u32>, Vec<i32>) = self.outer_faces(part, &connectivity)?.into_iter().unzip();
        let mut faces = connectivity.triangles(&faces)?;
        faces.as_flattened_mut().iter_mut().for_each(|v| *v = numbers.of(*v));
        let blocks = vec![plan.block; faces.len()].into();
        Ok(FacePiece { faces: faces.into(), patches: patches.into(), blocks })
    }

    fn tet_labels(&self, part: u32) -> io::Result<LabelPiece<'_>> {
        let count = self.plan.tets_of(part);
        Ok(LabelPiece { count, blocks: vec![self.plan.part(part).block; count].into(), ..LabelPiece::default() })
    }

    fn face_labels(&self, part: u32) -> io::Result<LabelPiece<'_>> {
        let plan = self.plan.part(part);
        let faces = self.outer_faces(part, &self.connectivity(plan)?)?;
        let patches = faces.iter().map(|(_, patch)| *patch).collect();
        Ok(LabelPiece { count: faces.len(), patches, blocks: vec![plan.block; faces.len()].into() })
    }
}

impl Parts for Whole<'_> {
    fn count(&self) -> usize {
        self.plan.parts.len()
    }

    fn certificate(&self, part: u32) -> io::Result<Certificate> {
        Ok(self.geometry(self.plan.part(part))?.notes()?.0)
    }

    fn wall(&self, part: u32) -> io::Result<FacesApart> {
        let Record { connectivity, geometry } = self.record(self.plan.part(part))?;
        let faces: Vec<u32> = self.outer_faces(part, &connectivity)?.into_iter().map(|(face, _)| face).collect();
        let sizes = connectivity.sizes();
        let numbers = self.numbers(part, sizes.shared)?;
        let (faces, vertices) = compact(connectivity.triangles(&faces)?, sizes.points as usize);
        Ok(FacesApart {
            points: geometry.points_at(&vertices)?,
            vertices: vertices.iter().map(|&v| numbers.of(v)).collect(),
            faces,
        })
    }

    fn joined(&self) -> &[[(u32, u32); 2]] {
        &self.plan.joined
    }

    fn joint(&self, part: u32, joint: u32) -> io::Result<FacesApart> {
        let Record { connectivity, geometry } = self.record(self.plan.part(part))?;
        let FinishedJoint { vertices, faces } = connectivity
            .joints()?
            .into_iter()
            .nth(joint as usize)
            .ok_or_else(|| io::Error::from(io::ErrorKind::InvalidData))?;
        let numbers = self.numbers(part, connectivity.sizes().shared)?;
        let local = |v: u32| vertices.partition_point(|&x| x < v) as u32;
        Ok(FacesApart {
            points: geometry.points_at(&vertices)?,
            vertices: vertices.iter().map(|&v| numbers.of(v)).collect(),
            faces: connectivity.triangles(&faces)?.into_iter().map(|face| face.map(local)).collect(),
        })
    }

    fn vertex(&self, part: u32, local: u32) -> u32 {
        // Asked for offenders alone.
        let numbers = self.numbers_alone(part).unwrap_or_default();
        numbers.get(local as usize).copied().unwrap_or(u32::MAX)
    }

    fn tet(&self, part: u32, local: u32) -> u64 {
        self.plan.part(part).first_tet + u64::from(local)
    }

    fn vertices(&self, part: u32, _: u32) -> io::Result<Vec<u32>> {
        self.numbers_alone(part)
    }
}

/// Numbers in the whole of the vertices of a part: first those that it shares with clusters.
struct PointNumbers {
    shared: Vec<u32>,
    /// Number of the first vertex that is its own.
    first: u32,
    /// Number of vertices that are its own.
    own: u32,
}

impl PointNumbers {
    fn of(&self, v: u32) -> u32 {
        self.shared.get(v as usize).copied().unwrap_or_else(|| self.first + (v - self.shared.len() as u32))
    }

    fn all(mut self) -> Vec<u32> {
        self.shared.extend(self.first..self.first + self.own);
        self.shared
    }
}

/// Faces that name only the vertices that they use, and these vertices, ascending.
fn compact(mut faces: Vec<[u32; 3]>, points: usize) -> (Vec<[u32; 3]>, Vec<u32>) {
    let mut place = vec![u32::MAX; points];
    for &v in faces.as_flattened() {
        place[v as usize] = 0;
    }
    let used: Vec<u32> = (0..points as u32).filter(|&v| place[v as usize] == 0).collect();
    for (new, &old) in (0..).zip(&used) {
        place[old as usize] = new;
    }
    faces.as_flattened_mut().iter_mut().for_each(|v| *v = place[*v as usize]);
    (faces, used)
}
