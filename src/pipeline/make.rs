//! Making of one block, or lookup in the store.

use std::io;
use std::sync::Arc;

use super::attempts::{self, RetryStrategy, Tried};
use super::effort::Effort;
use super::plan::{JointStyle, MeshPlan};
use super::routes::Tangle;
use super::store::{BlockRecords, Key, KeyMaker, Store, StoreError};
use crate::block::{About, BlockError, ConnectorEnd, Cured, StoredEnd};
use crate::partition::{Cluster, ClusterId, Cut, CutId, EndKind, ForkCell, Layout};
use anastomesh_skeleton::Skeleton;
use anastomesh_tet::parts::Watch;

/// Finished block in the store, with its contribution to the counts of the mesh. There are millions of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StoredBlock {
    /// Places in the store.
    pub records: BlockRecords,
    /// Number of its points, without those shared with earlier blocks.
    pub points: u32,
    pub tets: u32,
}

/// Block, or its error. The error is boxed to keep results small: there are millions of blocks, and few fail.
pub type BlockResult = Result<StoredBlock, Box<BlockError>>;

/// Common input of all blocks of a run, and their store.
#[derive(Clone, Copy, Debug)]
pub struct Workshop<'a> {
    pub skeleton: &'a Arc<Skeleton>,
    pub plan: &'a MeshPlan,
    pub store: &'a Store,
    /// Effort for each cluster.
    pub effort: Effort,
}

impl<'a> Workshop<'a> {
    /// Input of all blocks of a run.
    pub fn new(skeleton: &'a Arc<Skeleton>, plan: &'a MeshPlan, store: &'a Store) -> Self {
        Self { skeleton, plan, store, effort: Effort::full(1) }
    }

    /// Shop with the effort for each cluster of a run with this number of clusters. Must not be called while blocks are made.
    pub fn among(self, clusters: usize) -> Self {
        Self { effort: self.store.ledger().effort(clusters), ..self }
    }
}

impl Workshop<'_> {
    /// Makes a cluster. `first`: first strategy to try.
    ///
    /// # Errors
    /// The store fails. A failed block is not an error here.
    pub fn cluster(
        &self,
        id: ClusterId,
        cluster: &Cluster,
        tangle: Tangle,
        first: RetryStrategy,
        watch: &Watch,
    ) -> Result<BlockResult, StoreError> {
        let plan = &*self.plan.of_tube(cluster.size);
        let key = cluster_key(cluster, plan, tangle, first);
        if let Some(kept) = self.found(key)? {
            return Ok(Ok(kept));
        }
        let original = |node| self.skeleton.node(node).original;
        let tried = attempts::cluster(id, cluster, (plan, self.effort), (tangle, first), original, watch);
        if tried.result.is_err() {
            self.store.ledger().add(tried.spent);
        }
        self.keep(key, tried)
    }

    /// Makes a connector between discs that depend on the vessel alone.
    ///
    /// # Errors
    /// The store fails. A failed block is not an error here.
    pub fn free_connector(&self, id: CutId, cut: &Cut) -> Result<BlockResult, StoreError> {
        let plan = &*self.plan.of_tube(cut.size);
        let key = connector_key(cut, plan, &[]);
        if let Some(kept) = self.found(key)? {
            return Ok(Ok(kept));
        }
        self.keep(key, attempts::free_connector(id, cut, plan))
    }

    /// Makes a connector between the ends of its two finished clusters.
    ///
    /// # Errors
    /// The store fails. A failed block is not an error here.
    pub fn woven_connector(&self, id: CutId, cut: &Cut, ends: &[StoredEnd; 2]) -> Result<BlockResult, StoreError> {
        let key = connector_key(cut, self.plan, ends);
        if let Some(kept) = self.found(key)? {
            return Ok(Ok(kept));
        }
        self.keep(key, attempts::connector(id, cut, ends.each_ref().map(ConnectorEnd::from), self.plan))
    }

    fn keep(&self, key: Key, Tried { result, failures, way, .. }: Tried) -> Result<BlockResult, StoreError> {
        let mut finished = match result {
            Ok(finished) => finished,
            Err(error) => return Ok(Err(Box::new(error))),
        };
        if let Some(first) = failures.first() {
            finished.about.cured = Some(Cured { failure: first.to_string(), remedy: way });
        }
        let points = finished.mesh.points.len() as u32 - finished.shared;
        let tets = finished.mesh.tets.len() as u32;
        Ok(Ok(StoredBlock { records: self.store.keep_block(key, &finished)?, points, tets }))
    }

    fn found(&self, key: Key) -> io::Result<Option<StoredBlock>> {
        let Some(records) = self.store.find_block(key)? else { return Ok(None) };
        let sizes = self.store.connectivity(records.connectivity)?.sizes();
        Ok(Some(StoredBlock { records, points: sizes.points - sizes.shared, tets: sizes.tets }))
    }

    /// Report data of a block.
    ///
    /// # Errors
    /// The block cannot be read.
    pub fn about(&self, kept: &StoredBlock) -> io::Result<About> {
        Ok(self.store.geometry(kept.records.geometry)?.notes()?.1)
    }

    /// Ends between which a connector is woven; `None` beside a failed cluster.
    ///
    /// # Errors
    /// The blocks cannot be read.
    pub fn stored_ends(
        &self,
        partition: &Layout,
        id: CutId,
        cut: &Cut,
        clusters: &[BlockResult],
    ) -> io::Result<Option<[StoredEnd; 2]>> {
        let mut ends = Vec::with_capacity(2);
        for (side, place) in joints_of_cut(partition, id).into_iter().enumerate() {
            let Ok(kept) = &clusters[place.part as usize] else { return Ok(None) };
            let block = self.store.block(kept.records)?.block()?;
            let section = partition.cluster(ClusterId(place.part)).ends[cut.sides[side].1 as usize].section;
            let end = block.end_surface(place.joint as usize, id, side as u8, section);
            ends.push(end.ok_or_else(|| io::Error::from(io::ErrorKind::InvalidData))?);
        }
        Ok(ends.try_into().ok())
    }
}

/// A joint of a part of the whole.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, serde::Serialize, serde::Deserialize)]
pub struct JointPlace {
    /// The part: clusters by their ids, then connectors.
    pub part: u32,
    pub joint: u32,
}

/// The joints of the two clusters at a cut, side 0 first.
pub fn joints_of_cut(partition: &Layout, cut: CutId) -> [JointPlace; 2] {
    let joint =
        |(cluster, end): (ClusterId, u32)| JointPlace { part: cluster.0, joint: partition.cuts_before(cluster, end) };
    partition.sides_of_cut(cut).map(joint)
}

fn options(key: &mut KeyMaker, plan: &MeshPlan) {
    key.float(plan.rho);
    key.float(plan.follow);
    key.float(plan.stretch);
    key.float(plan.core);
    key.id(plan.layers.map_or(0, |layers| layers.count));
    plan.layers.iter().flat_map(|layers| [layers.growth, layers.thickness]).for_each(|x| key.float(x));
    key.id(u32::from(plan.hollow) + 2 * u32::from(plan.unfolded));
    key.id(match plan.joint {
        JointStyle::Disc => 0,
        JointStyle::Woven => 1,
        JointStyle::None => 2,
    });
}

fn cluster_key(cluster: &Cluster, plan: &MeshPlan, tangle: Tangle, first: RetryStrategy) -> Key {
    let mut key = KeyMaker::new("cluster");
    options(&mut key, plan);
    key.id(tangle as u32);
    key.id(u32::from(plan.fuse));
    key.text(first.name());
    key.count(cluster.tubes.len());
    for tube in &cluster.tubes {
        key.point(&tube.a);
        key.point(&tube.b);
        key.float(tube.ra);
        key.float(tube.rb);
    }
    key.count(cluster.ends.len());
    for end in &cluster.ends {
        key.section(&end.section);
        match end.kind {
            EndKind::Cut { side, .. } => key.id(u32::from(side)),
            EndKind::Terminal(node) => {
                key.id(2);
                key.id(node.0);
            }
        }
        key.id(end.overrun);
    }
    key.count(cluster.cells.len());
    for ForkCell { sides, steps } in &cluster.cells {
        for id in sides.map(u32::from).into_iter().chain(steps.map(|step| step as u32)) {
            key.id(id);
        }
    }
    // Clusters without are found by the keys that they always had.
    for fork in &cluster.fine {
        key.point(&fork.at);
        key.float(fork.within);
        key.float(fork.factor);
    }
    key.finish()
}

fn connector_key(cut: &Cut, plan: &MeshPlan, ends: &[StoredEnd]) -> Key {
    let mut key = KeyMaker::new("connector");
    options(&mut key, plan);
    key.count(cut.path.len());
    cut.path.iter().for_each(|section| key.section(section));
    key.count(ends.len());
    for end in ends {
        key.count(end.points.len());
        end.points.iter().for_each(|p| key.point(p));
        end.surface.triangles.as_flattened().iter().for_each(|&v| key.id(v));
    }
    key.finish()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pipeline::plan::MOST_STRETCH;
    use anastomesh_skeleton::{FinePlace, SizeAt};
    use anastomesh_tet::Layers;

    #[test]
    fn a_cluster_is_found_only_by_all_that_it_depends_on() {
        let (cluster, plan) = (Cluster::default(), MeshPlan::default());
        let plain = cluster_key(&cluster, &plan, Tangle::Overlapping, RetryStrategy::Usual);
        let others = [
            MeshPlan { rho: 4.0, ..plan.clone() },
            MeshPlan { follow: 0.5, ..plan.clone() },
            MeshPlan { stretch: 2.0, ..plan.clone() },
            MeshPlan { core: 2.0, ..plan.clone() },
            MeshPlan { layers: Some(Layers::default()), ..plan.clone() },
            MeshPlan { layers: Some(Layers::default().growth(1.5)), ..plan.clone() },
            MeshPlan { joint: JointStyle::Woven, ..plan.clone() },
            MeshPlan { fuse: true, ..plan.clone() },
            MeshPlan { hollow: true, ..plan.clone() },
            MeshPlan { unfolded: true, ..plan.clone() },
        ];
        for other in others {
            assert_ne!(cluster_key(&cluster, &other, Tangle::Overlapping, RetryStrategy::Usual), plain, "{other:?}");
        }
        for tangle in [Tangle::Free, Tangle::Meeting] {
            assert_ne!(cluster_key(&cluster, &plan, tangle, RetryStrategy::Usual), plain);
        }
        assert_ne!(cluster_key(&cluster, &plan, Tangle::Overlapping, RetryStrategy::Finest), plain);
        assert_eq!(cluster_key(&cluster, &plan, Tangle::Overlapping, RetryStrategy::Usual), plain);
        // What is asked for of forks counts where there is one, and what tubes are stretched by once it is known.
        let asked = MeshPlan { size_at: Some(SizeAt::Forks(0.5)), ..plan.clone() };
        assert_eq!(cluster_key(&cluster, &asked, Tangle::Overlapping, RetryStrategy::Usual), plain);
        let forked = |factor| {
            let fork = FinePlace { at: anastomesh_mesh::geometry::Point3::origin(), within: 1.0, factor };
            cluster_key(
                &Cluster { fine: vec![fork], ..cluster.clone() },
                &asked,
                Tangle::Overlapping,
                RetryStrategy::Usual,
            )
        };
        assert!(forked(0.5) != plain && forked(0.5) != forked(0.4));
        let stretched = |size| cluster_key(&cluster, &asked.of_tube(size), Tangle::Overlapping, RetryStrategy::Usual);
        assert!(stretched(Some(2.0)) != plain && stretched(Some(2.0)) != stretched(Some(3.0)));
        assert_eq!([None, Some(0.3), Some(1.0)].map(stretched), [plain; 3]);
        assert_eq!(stretched(Some(90.0)), stretched(Some(MOST_STRETCH)));
    }
}
