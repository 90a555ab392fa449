//! One block, made once with given parameters.

use crate::block::{
    BlockDump, BlockError, BlockInput, BlockParams, ConnectorAttempt, ConnectorEnd, ConnectorMesh, EndStyle,
    EndSurface, Finished, mesh_cluster_watched, mesh_connector, mesh_free_connector, shared_ends,
};
use crate::partition::{Cluster, ClusterId, Cut, CutId};
use anastomesh_skeleton::NodeId;
use anastomesh_tet::parts::Watch;

/// A cluster. `original`: the number of a terminal in the network as it was read.
pub fn cluster(
    id: ClusterId,
    cluster: &Cluster,
    params: &BlockParams,
    original: impl Fn(NodeId) -> u32,
    watch: &Watch,
) -> Result<Finished, BlockError> {
    let mesh = match params.ends {
        EndStyle::Disc | EndStyle::Shared => mesh_cluster_watched(id, cluster, params, watch)?,
        #[cfg(feature = "woven")]
        EndStyle::Open => crate::woven::mesh_trimmed(id, cluster, params, watch)?,
        #[cfg(not(feature = "woven"))]
        EndStyle::Open => return Err(BlockError::NoWovenJoints),
    };
    let name = || format!("cluster {}", id.0);
    let made = Finished::of_cluster(mesh, original);
    sound(made.map_err(|source| BlockError::Faces { block: name(), source })?, name)
}

/// A hollow block is taken only if it could be filled: those that are filled have shown it.
fn sound(block: Finished, name: impl Fn() -> String) -> Result<Finished, BlockError> {
    match block.certificate.broken_line().filter(|_| !block.hull.is_empty()) {
        Some(line) => Err(BlockError::Unsound { block: name(), line }),
        None => Ok(block),
    }
}

/// A connector, and how its tube could not be divided.
pub type Connector = (Finished, Vec<ConnectorAttempt>);

/// A connector between the ends that its clusters have.
pub fn connector(id: CutId, cut: &Cut, ends: [ConnectorEnd; 2], params: &BlockParams) -> Result<Connector, BlockError> {
    finished(id, mesh_connector(id, cut, ends, params)?, ends.map(|end| end.surface))
}

/// A connector between the discs that the vessel alone gives.
pub fn free_connector(id: CutId, cut: &Cut, params: &BlockParams) -> Result<Connector, BlockError> {
    let mesh = mesh_free_connector(id, cut, params)?;
    let no_disc = || BlockError::Connector { cut: id, at: [f64::NAN; 3], attempts: Vec::new() };
    let ends = shared_ends(id, cut, params).ok_or_else(no_disc)?;
    finished(id, mesh, ends.each_ref())
}

fn finished(id: CutId, mut mesh: ConnectorMesh, ends: [&EndSurface; 2]) -> Result<Connector, BlockError> {
    let failed = std::mem::take(&mut mesh.failed);
    let name = || format!("connector {}", id.0);
    let made = Finished::of_connector(mesh, ends);
    Ok((sound(made.map_err(|source| BlockError::Faces { block: name(), source })?, name)?, failed))
}

/// The block of a dump, again.
///
/// # Errors
/// The block's.
pub fn replay(dump: &BlockDump, watch: &Watch) -> Result<Finished, BlockError> {
    let params = &dump.params;
    match &dump.input {
        BlockInput::Cluster { id, cluster: input } => cluster(*id, input, params, |node| node.0, watch),
        BlockInput::Connector { id, cut, ends } => {
            Ok(connector(*id, cut, ends.each_ref().map(ConnectorEnd::from), params)?.0)
        }
        BlockInput::FreeConnector { id, cut } => Ok(free_connector(*id, cut, params)?.0),
    }
}

#[cfg(all(test, feature = "woven"))]
mod tests {
    use super::*;
    use crate::block::fixtures::{bifurcation, facing};
    use anastomesh_skeleton::FinePlace;

    #[test]
    fn a_dumped_block_runs_again_to_the_same_bits() {
        let params = BlockParams { shift: [0.1, 0.2, 0.3], ..BlockParams::default() };
        let input = bifurcation(11);
        let (opposite, gap) = facing(&input);
        let whole = |input: &Cluster, ends| {
            let params = BlockParams { ends, ..params };
            cluster(ClusterId(0), input, &params, |node| node.0, &Watch::NOBODY).expect("a cluster")
        };
        let again = |dump: BlockDump, made: &Finished| {
            let read = BlockDump::from_json(dump.to_json().expect("json").as_bytes()).expect("a dump");
            assert_eq!(read, dump);
            assert_eq!(replay(&read, &Watch::NOBODY).expect("runs again"), *made);
        };
        let fork = FinePlace { at: input.tubes[0].a, within: 1.2, factor: 0.5 };
        let finer = Cluster { fine: vec![fork], ..input.clone() };
        let dump = BlockDump::of_cluster(ClusterId(0), &finer, params, vec![1, 2], |node| node.0);
        let made = whole(&finer, params.ends);
        assert_ne!(made, whole(&input, params.ends));
        again(dump, &made);
        for ends in [EndStyle::Disc, EndStyle::Shared, EndStyle::Open] {
            let params = BlockParams { ends, ..params };
            let dump = BlockDump::of_cluster(ClusterId(0), &input, params, vec![1, 2], |node| node.0);
            again(dump, &whole(&input, ends));
        }
        let ends = [(&input, 0), (&opposite, 1)].map(|(input, side)| {
            let section = input.ends[0].section;
            whole(input, EndStyle::Open).end_surface(0, CutId(0), side, section).expect("an end")
        });
        let made = connector(CutId(0), &gap, ends.each_ref().map(ConnectorEnd::from), &params).expect("a connector");
        again(BlockDump::of_connector(CutId(0), &gap, ends, params, vec![1, 2]), &made.0);
        let made = free_connector(CutId(0), &gap, &params).expect("a connector");
        again(BlockDump::of_free_connector(CutId(0), &gap, params, Vec::new()), &made.0);
    }
}
