//! The whole mesh as a plan over stored blocks: which number each vertex and tetrahedron gets, and passes over them in
//! that order. Nothing but the plan is held; blocks are read when their turn comes.

#[cfg(feature = "cli")]
mod left;

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::io;

use super::blocks::Blocks;
use super::make::{JointPlace, Kept, joints_of_cut};
use super::report::MeshSize;
use super::store::{Store, StoredBytes};
use super::terminals::TerminalPatches;
use crate::block::{FinishedJoint, Record};
use crate::geometry::Point3;
use crate::mesh::check::Expectation;
use crate::mesh::check::parts::{Certificate, FacesApart, Parts, PartsCheck, check_parts};
use crate::mesh::source::{FacePiece, LabelPiece, MeshSource, SourceCounts, TetPiece};
use crate::mesh::{Patch, WALL};
use crate::partition::CutId;
use crate::progress::{Progress, ask};
use crate::skeleton::Skeleton;

#[cfg(feature = "cli")]
pub use left::LeftWhole;

/// The whole mesh: parts in order, clusters by their ids, then connectors. A vertex that two parts have is numbered by the
/// cluster.
#[derive(Debug)]
pub struct Whole<'a> {
    store: &'a Store,
    listener: Listener<'a>,
    parts: Vec<PartPlan>,
    patches: Vec<Patch>,
    /// Patch of each terminal's cap, ascending by node.
    patch_of: Vec<(u32, i32)>,
    /// Joints that nothing is joined to, because a block is missing, each with the patch of its disc.
    open: BTreeMap<JointPlace, i32>,
    joined: Vec<[(u32, u32); 2]>,
    counts: SourceCounts,
}

/// One part's place in the whole.
#[derive(Clone, Copy, Debug)]
struct PartPlan {
    kept: Kept,
    /// Its number among all blocks, those that are missing included.
    block: i32,
    /// Number of the first vertex that is this part's own.
    first_point: u32,
    /// Number of its first tetrahedron.
    first_tet: u64,
    /// The joints of other parts that hold the vertices it shares, in order.
    joined_to: Option<[JointPlace; 2]>,
}

/// Who says whether to stop.
struct Listener<'a>(&'a dyn Progress);

impl std::fmt::Debug for Listener<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        f.write_str("Listener")
    }
}

/// More vertices than 32 bits can count.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the whole mesh has {0} points, more than 32 bits can count; mesh its parts, or give a smaller --rho")]
pub struct TooManyPoints(pub u64);

impl<'a> Whole<'a> {
    /// Numbers everything.
    ///
    /// # Errors
    /// When there are too many vertices or a block cannot be read.
    pub fn new(
        store: &'a Store,
        progress: &'a dyn Progress,
        skeleton: &Skeleton,
        blocks: &Blocks,
        terminals: &TerminalPatches,
    ) -> io::Result<Self> {
        let mut whole = Self {
            store,
            listener: Listener(progress),
            parts: Vec::with_capacity(blocks.clusters.len() + blocks.connectors.len()),
            patches: vec![Patch { id: WALL, name: "wall".into(), cap: None }],
            patch_of: Vec::new(),
            open: BTreeMap::new(),
            joined: Vec::new(),
            counts: SourceCounts::default(),
        };
        // Clusters that failed have no part.
        let mut part_of = Vec::with_capacity(blocks.clusters.len());
        for (block, made) in (0..).zip(&blocks.clusters) {
            part_of.push(made.as_ref().ok().map(|kept| whole.add(*kept, block, None)).transpose()?);
        }
        let connectors = blocks.connectors.iter().enumerate();
        let mut next = terminals.of.values().map(|(id, _)| *id).max().unwrap_or(WALL) + 1;
        for (block, (number, made)) in (blocks.clusters.len() as i32..).zip(connectors) {
            let sides = joints_of_cut(&blocks.partition, CutId(number as u32));
            let sides = sides.map(|place| part_of[place.part as usize].map(|part| JointPlace { part, ..place }));
            match (made, sides) {
                (Some(Ok(kept)), [Some(a), Some(b)]) => {
                    let part = whole.add(*kept, block, Some([a, b]))?;
                    let join = |side, place: JointPlace| [(place.part, place.joint), (part, side)];
                    whole.joined.extend([join(0, a), join(1, b)]);
                }
                _ => {
                    for (side, place) in sides.into_iter().enumerate().filter_map(|(side, place)| Some((side, place?)))
                    {
                        whole.patches.push(Patch { id: next, name: format!("missing_{number}_{side}"), cap: None });
                        whole.open.insert(place, next);
                        next += 1;
                    }
                }
            }
        }
        whole.add_open_faces()?;
        whole.add_patches(skeleton, terminals)?;
        Ok(whole)
    }

    fn add(&mut self, kept: Kept, block: i32, joined_to: Option<[JointPlace; 2]>) -> io::Result<u32> {
        let SourceCounts { points, tets, boundary } = &mut self.counts;
        let Ok(first_point) = u32::try_from(*points) else {
            return Err(io::Error::other(TooManyPoints(*points as u64)));
        };
        self.parts.push(PartPlan { kept, block, first_point, first_tet: *tets as u64, joined_to });
        *points += (kept.sizes.points - kept.sizes.shared) as usize;
        *tets += kept.sizes.tets as usize;
        *boundary += kept.sizes.outer_faces() as usize;
        Ok(self.parts.len() as u32 - 1)
    }

    fn add_open_faces(&mut self) -> io::Result<()> {
        for place in self.open.keys() {
            let joints = Record::open(&self.record(self.parts[place.part as usize])?)?.joints()?;
            self.counts.boundary += joints.get(place.joint as usize).map_or(0, |joint| joint.faces.len());
        }
        Ok(())
    }

    fn add_patches(&mut self, skeleton: &Skeleton, terminals: &TerminalPatches) -> io::Result<()> {
        for &part in self.parts.iter().filter(|part| part.kept.sizes.caps > 0) {
            for cap in Record::open(&self.store.bytes(part.kept.record))?.caps()? {
                let Some((id, name)) = terminals.of.get(&cap.node) else { continue };
                let disc = cap.disc(skeleton.node(cap.node).original);
                self.patches.push(Patch { id: *id, name: name.clone(), cap: Some(disc) });
                self.patch_of.push((cap.node.0, *id));
            }
        }
        self.patches.sort_by_key(|patch| patch.id);
        self.patch_of.sort_unstable();
        Ok(())
    }

    /// The bytes of a part. Every pass comes here for each part, so this is where it is asked whether to stop.
    fn record(&self, part: PartPlan) -> io::Result<StoredBytes<'a>> {
        ask(self.listener.0)?;
        Ok(self.store.bytes(part.kept.record))
    }

    /// Numbers of the vertices that a part shares with earlier ones.
    fn shared(&self, part: PartPlan) -> io::Result<Vec<u32>> {
        let mut shared = Vec::with_capacity(part.kept.sizes.shared as usize);
        for place in part.joined_to.iter().flatten() {
            let cluster = self.parts[place.part as usize];
            let joints = Record::open(&self.record(cluster)?)?.joints()?;
            // Clusters share nothing, so all of their vertices are their own.
            let vertices = joints.get(place.joint as usize).map_or(&[][..], |joint| &joint.vertices);
            shared.extend(vertices.iter().map(|v| cluster.first_point + v));
        }
        Ok(shared)
    }

    /// Number in the whole of each vertex of a part.
    fn numbers(&self, part: PartPlan) -> io::Result<Vec<u32>> {
        let mut numbers = self.shared(part)?;
        let own = part.kept.sizes.points - part.kept.sizes.shared;
        if numbers.len() != part.kept.sizes.shared as usize {
            return Err(io::Error::new(io::ErrorKind::InvalidData, "two blocks have different discs at their joint"));
        }
        numbers.extend(part.first_point..part.first_point + own);
        Ok(numbers)
    }

    /// Boundary faces of the whole that a part has, ascending, each with its patch.
    fn outer_faces(&self, part: u32, record: &Record<StoredBytes>) -> io::Result<Vec<(u32, i32)>> {
        let mut faces: Vec<(u32, i32)> = record.wall()?.into_iter().map(|face| (face, WALL)).collect();
        if record.sizes().caps > 0 {
            for cap in record.caps()? {
                let found = self.patch_of.binary_search_by_key(&cap.node.0, |(node, _)| *node);
                let patch = found.map_or(WALL, |i| self.patch_of[i].1);
                faces.extend(cap.faces.into_iter().map(|face| (face, patch)));
            }
        }
        let first = JointPlace { part, joint: 0 };
        let last = JointPlace { part, joint: u32::MAX };
        if self.open.range(first..=last).next().is_some() {
            let joints = record.joints()?;
            for (place, patch) in self.open.range(first..=last) {
                let open = joints.get(place.joint as usize).into_iter().flat_map(|j| &j.faces);
                faces.extend(open.map(|&face| (face, *patch)));
            }
        }
        faces.sort_unstable();
        Ok(faces)
    }

    /// Counts it.
    pub fn size(&self) -> MeshSize {
        let cap_triangles = self.parts.iter().map(|part| part.kept.sizes.cap_faces as usize).sum();
        let SourceCounts { points, tets, boundary } = self.counts;
        MeshSize { tets, points, wall_triangles: boundary - cap_triangles, cap_triangles }
    }

    /// Checks it, with walls of so many bytes in memory at a time. What meets is named by the blocks' numbers.
    ///
    /// # Errors
    /// When a block cannot be read.
    pub fn check(&self, expectation: &Expectation, memory: u64) -> io::Result<PartsCheck> {
        let PartsCheck { report, mut meeting } = check_parts(self, &self.patches, Some(expectation), memory as usize)?;
        meeting.as_flattened_mut().iter_mut().for_each(|part| *part = self.parts[*part as usize].block as u32);
        Ok(PartsCheck { report, meeting })
    }

    /// The vertices of every joint, by their numbers in the whole.
    ///
    /// # Errors
    /// When a block cannot be read.
    pub fn joint_vertices(&self) -> io::Result<Vec<Vec<u32>>> {
        let mut all = Vec::with_capacity(self.joined.len());
        for &part in self.parts.iter().filter(|part| part.joined_to.is_some()) {
            let joints = Record::open(&self.record(part)?)?.joints()?;
            let numbers = self.numbers(part)?;
            all.extend(joints.iter().map(|joint| joint.vertices.iter().map(|&v| numbers[v as usize]).collect()));
        }
        Ok(all)
    }
}

impl MeshSource for Whole<'_> {
    fn counts(&self) -> SourceCounts {
        self.counts
    }

    fn patches(&self) -> &[Patch] {
        &self.patches
    }

    fn parts(&self) -> u32 {
        self.parts.len() as u32
    }

    fn points(&self, part: u32) -> io::Result<Cow<'_, [Point3]>> {
        let part = self.parts[part as usize];
        let points = Record::open(&self.record(part)?)?.points()?.split_off(part.kept.sizes.shared as usize);
        Ok(points.into())
    }

    fn points_of(&self, ids: &[u32]) -> io::Result<Vec<Point3>> {
        let mut found = Vec::with_capacity(ids.len());
        while let Some(&id) = ids.get(found.len()) {
            // Of parts that begin with the same number, all but the last have no points of their own.
            let part = self.parts.partition_point(|part| part.first_point <= id).saturating_sub(1);
            let first = self.parts[part].first_point;
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
        let part = self.parts[part as usize];
        let numbers = self.numbers(part)?;
        let mut tets = Record::open(&self.record(part)?)?.tets()?;
        tets.as_flattened_mut().iter_mut().for_each(|v| *v = numbers[*v as usize]);
        let blocks = vec![part.block; tets.len()].into();
        Ok(TetPiece { tets: tets.into(), blocks })
    }

    fn boundary(&self, part: u32) -> io::Result<FacePiece<'_>> {
        let plan = self.parts[part as usize];
        let numbers = self.numbers(plan)?;
        let bytes = self.record(plan)?;
        let record = Record::open(&bytes)?;
        let (faces, patches): (Vec<u32>, Vec<i32>) = self.outer_faces(part, &record)?.into_iter().unzip();
        let mut faces = record.triangles(&faces)?;
        faces.as_flattened_mut().iter_mut().for_each(|v| *v = numbers[*v as usize]);
        let blocks = vec![plan.block; faces.len()].into();
        Ok(FacePiece { faces: faces.into(), patches: patches.into(), blocks })
    }

    fn tet_labels(&self, part: u32) -> io::Result<LabelPiece<'_>> {
        let part = self.parts[part as usize];
        let count = part.kept.sizes.tets as usize;
        Ok(LabelPiece { count, blocks: vec![part.block; count].into(), ..LabelPiece::default() })
    }

    fn face_labels(&self, part: u32) -> io::Result<LabelPiece<'_>> {
        let plan = self.parts[part as usize];
        let faces = self.outer_faces(part, &Record::open(&self.record(plan)?)?)?;
        let patches = faces.iter().map(|(_, patch)| *patch).collect();
        Ok(LabelPiece { count: faces.len(), patches, blocks: vec![plan.block; faces.len()].into() })
    }
}

impl Parts for Whole<'_> {
    fn count(&self) -> usize {
        self.parts.len()
    }

    fn certificate(&self, part: u32) -> io::Result<Certificate> {
        Ok(Record::open(&self.record(self.parts[part as usize])?)?.notes()?.0)
    }

    fn wall(&self, part: u32) -> io::Result<FacesApart> {
        let plan = self.parts[part as usize];
        let bytes = self.record(plan)?;
        let record = Record::open(&bytes)?;
        let faces: Vec<u32> = self.outer_faces(part, &record)?.into_iter().map(|(face, _)| face).collect();
        let (points, numbers) = (record.points()?, self.numbers(plan)?);
        let (faces, vertices) = compact(record.triangles(&faces)?, points.len());
        let at = |&v: &u32| points[v as usize];
        let number = |&v: &u32| numbers[v as usize];
        Ok(FacesApart {
            points: vertices.iter().map(at).collect(),
            vertices: vertices.iter().map(number).collect(),
            faces,
        })
    }

    fn joined(&self) -> &[[(u32, u32); 2]] {
        &self.joined
    }

    fn joint(&self, part: u32, joint: u32) -> io::Result<FacesApart> {
        let plan = self.parts[part as usize];
        let bytes = self.record(plan)?;
        let record = Record::open(&bytes)?;
        let FinishedJoint { vertices, faces } = record
            .joints()?
            .into_iter()
            .nth(joint as usize)
            .ok_or_else(|| io::Error::from(io::ErrorKind::InvalidData))?;
        let (points, numbers) = (record.points()?, self.numbers(plan)?);
        let local = |v: u32| vertices.partition_point(|&x| x < v) as u32;
        Ok(FacesApart {
            points: vertices.iter().map(|&v| points[v as usize]).collect(),
            vertices: vertices.iter().map(|&v| numbers[v as usize]).collect(),
            faces: record.triangles(&faces)?.into_iter().map(|face| face.map(local)).collect(),
        })
    }

    fn vertex(&self, part: u32, local: u32) -> u32 {
        // Asked for offenders alone.
        let numbers = self.numbers(self.parts[part as usize]).unwrap_or_default();
        numbers.get(local as usize).copied().unwrap_or(u32::MAX)
    }

    fn tet(&self, part: u32, local: u32) -> u64 {
        self.parts[part as usize].first_tet + u64::from(local)
    }

    fn vertices(&self, part: u32, _: u32) -> io::Result<Vec<u32>> {
        self.numbers(self.parts[part as usize])
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
