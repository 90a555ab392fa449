//! Numbering of the vertices and tetrahedra of the whole mesh.

use std::collections::BTreeMap;
use std::io;

use crate::partition::CutId;
use crate::pipeline::blocks::Blocks;
use crate::pipeline::make::{JointPlace, StoredBlock, joints_of_cut};
use crate::pipeline::store::BlockRecords;
use anastomesh_mesh::source::SourceCounts;
use anastomesh_mesh::{Patch, WALL};

/// Parts in order: clusters by their ids, then connectors. A vertex that two parts have is numbered by the cluster.
#[derive(Clone, Debug, serde::Serialize, serde::Deserialize)]
pub(super) struct Numbering {
    pub parts: Vec<PartPlan>,
    /// Number of parts that are clusters.
    pub clusters: u32,
    #[serde(with = "super::left::patches")]
    pub patches: Vec<Patch>,
    /// Patch of each terminal's cap, ascending by node.
    pub patch_of: Vec<(u32, i32)>,
    /// Joints that nothing is joined to, because a block is missing, each with the patch of its disc.
    pub open: BTreeMap<JointPlace, i32>,
    /// Joints of clusters and connectors that are one, connector by connector, two for each.
    pub joined: Vec<[(u32, u32); 2]>,
    pub counts: SourceCounts,
    /// Those of the boundary faces that close terminals.
    pub cap_faces: usize,
}

/// One part's place in the whole. How much it holds is told by the place of the next.
#[derive(Clone, Copy, Debug, serde::Serialize, serde::Deserialize)]
pub(super) struct PartPlan {
    #[serde(skip)]
    pub records: BlockRecords,
    /// Its number among all blocks, those that are missing included.
    pub block: i32,
    /// Number of the first vertex that is this part's own.
    pub first_point: u32,
    /// Number of its first tetrahedron.
    pub first_tet: u64,
}

/// More vertices than 32 bits can count.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the mesh has {0} points, more than 32-bit indices allow; mesh the network in parts, or give a smaller rho")]
pub struct TooManyPoints(pub u64);

impl Numbering {
    /// Numbers all vertices and tetrahedra; faces are not counted. Joints that are open get patches from `patch` on.
    ///
    /// # Errors
    /// There are too many vertices.
    pub fn of(blocks: &Blocks, mut patch: i32) -> io::Result<Self> {
        let mut all = Self {
            parts: Vec::with_capacity(blocks.clusters.len() + blocks.connectors.len()),
            clusters: 0,
            patches: vec![Patch { id: WALL, name: "wall".into(), cap: None }],
            patch_of: Vec::new(),
            open: BTreeMap::new(),
            joined: Vec::with_capacity(2 * blocks.connectors.len()),
            counts: SourceCounts::default(),
            cap_faces: 0,
        };
        // Clusters that failed have no part.
        let mut part_of = Vec::with_capacity(blocks.clusters.len());
        for (block, made) in (0..).zip(&blocks.clusters) {
            part_of.push(made.as_ref().ok().map(|kept| all.add(*kept, block)).transpose()?);
        }
        all.clusters = all.parts.len() as u32;
        let connectors = blocks.connectors.iter().enumerate();
        for (block, (number, made)) in (blocks.clusters.len() as i32..).zip(connectors) {
            let sides = joints_of_cut(&blocks.partition, CutId(number as u32));
            let sides = sides.map(|place| part_of[place.part as usize].map(|part| JointPlace { part, ..place }));
            match (made, sides) {
                (Some(Ok(kept)), [Some(a), Some(b)]) => {
                    let part = all.add(*kept, block)?;
                    let join = |side, place: JointPlace| [(place.part, place.joint), (part, side)];
                    all.joined.extend([join(0, a), join(1, b)]);
                }
                _ => {
                    for (side, place) in sides.into_iter().enumerate().filter_map(|(side, place)| Some((side, place?)))
                    {
                        all.patches.push(Patch { id: patch, name: format!("missing_{number}_{side}"), cap: None });
                        all.open.insert(place, patch);
                        patch += 1;
                    }
                }
            }
        }
        Ok(all)
    }

    fn add(&mut self, kept: StoredBlock, block: i32) -> io::Result<u32> {
        let SourceCounts { points, tets, .. } = &mut self.counts;
        let (first, first_tet) = (*points, *tets as u64);
        *points += kept.points as usize;
        *tets += kept.tets as usize;
        let (Ok(first_point), Ok(_)) = (u32::try_from(first), u32::try_from(*points)) else {
            return Err(io::Error::other(TooManyPoints(*points as u64)));
        };
        self.parts.push(PartPlan { records: kept.records, block, first_point, first_tet });
        Ok(self.parts.len() as u32 - 1)
    }

    /// True if places and joints read from a file are consistent.
    pub fn is_sound(&self) -> bool {
        let ends = |plan: &PartPlan| (u64::from(plan.first_point), plan.first_tet);
        let last = self.parts.last().map_or((0, 0), ends);
        let connectors = self.parts.len().checked_sub(self.clusters as usize);
        self.parts.is_sorted_by(|a, b| ends(a).0 <= ends(b).0 && ends(a).1 <= ends(b).1)
            && last.0 <= self.counts.points as u64
            && last.1 <= self.counts.tets as u64
            && u32::try_from(self.counts.points).is_ok()
            && connectors.is_some_and(|connectors| self.joined.len() == 2 * connectors)
            && self.joined.iter().flatten().all(|(part, _)| (*part as usize) < self.parts.len())
            && self.open.keys().all(|place| (place.part as usize) < self.parts.len())
    }

    pub fn part(&self, part: u32) -> PartPlan {
        self.parts[part as usize]
    }

    /// Number of points that belong to one part.
    pub fn points_of(&self, part: u32) -> u32 {
        let end = self.parts.get(part as usize + 1).map_or(self.counts.points as u32, |next| next.first_point);
        end - self.part(part).first_point
    }

    /// Number of tetrahedra of a part.
    pub fn tets_of(&self, part: u32) -> usize {
        let end = self.parts.get(part as usize + 1).map_or(self.counts.tets as u64, |next| next.first_tet);
        (end - self.part(part).first_tet) as usize
    }

    /// The joints of clusters that hold the vertices which a connector shares, in order; none for clusters.
    pub fn joined_to(&self, part: u32) -> &[[(u32, u32); 2]] {
        match part.checked_sub(self.clusters) {
            Some(connector) => &self.joined[2 * connector as usize..][..2],
            None => &[],
        }
    }
}
