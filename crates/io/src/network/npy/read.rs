//! Reader of nodes and edges.

use crate::network::content::{NetworkFile, NetworkOptions};
use crate::network::polylines::{Polylines, Radii};
use crate::network::radii::{Choice, RadiusFault};
use crate::npy::{Arrays, NpyError, NpyFault, ensure_rows};
use anastomesh_skeleton::{NodeId, Skeleton};

/// Arrays to read.
pub(in crate::network) const ARRAYS: [&str; 5] = [NODES, EDGES, RADII, EDGE_RADII, ROOTS];

pub(super) const NODES: &str = "nodes";
pub(super) const EDGES: &str = "edges";
pub(super) const RADII: &str = "radii";
pub(super) const EDGE_RADII: &str = "edge_radii";
const ROOTS: &str = "roots";

/// Errors of a network in arrays.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum NpyNetworkError {
    /// An array is missing or invalid.
    #[error(transparent)]
    Array(#[from] NpyError),
    /// No array is usable as radius.
    #[error(transparent)]
    Radius(#[from] RadiusFault),
}

/// Reads `nodes` (n, 3), `edges` (m, 2), `radii` (n), `edge_radii` (m) or (m, 2), and optional `roots` (k).
pub(in crate::network) fn read(arrays: &Arrays, options: &NetworkOptions) -> Result<NetworkFile, NpyNetworkError> {
    let points = arrays.points(NODES)?;
    let of_nodes = ("nodes.npy", points.len());
    let edges = arrays.indices::<2>(EDGES, of_nodes)?;
    let choice = Choice::of(&arrays.present(&[RADII]), &arrays.present(&[EDGE_RADII]), options)?;
    let mut radii = Radii::default();
    if let Some(name) = &choice.points {
        let values = arrays.values(name)?;
        ensure_rows(name, values.len(), of_nodes)?;
        radii.nodes = Some(values);
    }
    if let Some(name) = &choice.cells {
        let of_edges = ("edges.npy", edges.len());
        if arrays.columns(name)? == 2 {
            let rows = arrays.floats::<2>(name)?;
            ensure_rows(name, rows.len(), of_edges)?;
            radii.corners = Some(rows.into_flattened());
        } else {
            let values = arrays.values(name)?;
            ensure_rows(name, values.len(), of_edges)?;
            radii.lines = Some(values);
        }
    }
    let roots = arrays.if_there(ROOTS, |arrays, name| arrays.indices::<1>(name, of_nodes))?;
    let ends = (1..=edges.len()).map(|i| 2 * i).collect();
    let lines = Polylines { points, ends, path: edges.into_flattened() };
    let mut skeleton = Skeleton::default();
    if !lines.fits(&skeleton) {
        return Err(NpyFault::TooMany { found: lines.path.len() / 2 }.of("edges.npy").into());
    }
    lines.append_to(&mut skeleton, &radii);
    let roots = roots.into_iter().flatten().map(NodeId).collect();
    Ok(NetworkFile { skeleton, notes: choice.notes(), roots, ..NetworkFile::default() })
}
