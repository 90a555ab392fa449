//! Division of vessels between the cells of a mesh.

use super::clip::{Cells, Lost};
use super::error::{PieceFault, PiecesError};
use super::inside::{corners, tets_of_nodes};
use anastomesh_mesh::TetMesh;
use anastomesh_mesh::geometry::Point3;
use anastomesh_mesh::progress::{Progress, Stage};
use anastomesh_skeleton::{EdgeId, Skeleton};
use rayon::prelude::*;

/// Edges that are divided in parallel between two checks for cancellation.
const BATCH: usize = 1024;

/// Maximum distance of the middle of a piece from its cell, relative to the length of the edge and the size of the cell.
/// Parameters along an edge are rounded after nine digits.
const ROUNDOFF: f64 = 1e-8;

/// Part of a vessel in one cell of a mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Piece {
    /// Edge of the network.
    pub edge: EdgeId,
    /// Tetrahedron of the mesh.
    pub tet: u32,
    /// Parameters along the edge where the piece begins and ends, from 0 to 1.
    pub ends: [f64; 2],
    /// Length.
    pub length: f64,
}

impl Piece {
    /// Parameter of its middle.
    pub fn middle(&self) -> f64 {
        f64::midpoint(self.ends[0], self.ends[1])
    }
}

/// Pieces of all vessels, one for each vessel and cell that it passes through.
///
/// Exact predicates decide which cells these are. A piece on a face, on an edge or at a vertex between several cells
/// belongs to the one with the least index. Pieces that are shorter than the roundoff of the parameters are left out.
///
/// ```
/// use anastomesh_domain::Pieces;
/// use anastomesh_mesh::{Point3, shapes::cube_lattice};
/// use anastomesh_skeleton::{Edge, Node, NodeId, Skeleton};
///
/// let node = |x: f64, original| Node { position: Point3::new(x, 0.5, 0.25), radius: 0.01, original };
/// let edges = vec![Edge { nodes: [NodeId(0), NodeId(1)], radii: [0.01; 2] }];
/// let vessel = Skeleton { nodes: vec![node(0.0, 0), node(1.0, 1)], edges };
/// let mesh = cube_lattice(1);
/// let pieces = Pieces::of(&mesh, &vessel, &())?;
/// assert_eq!(pieces.list.iter().map(|piece| piece.ends).collect::<Vec<_>>(), [[0.0, 0.25], [0.25, 0.5], [0.5, 1.0]]);
/// assert_eq!(pieces.check(&mesh, &vessel), Ok(()));
/// # Ok::<(), anastomesh_domain::PiecesError>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Pieces {
    /// Pieces by edge, and along each edge.
    pub list: Vec<Piece>,
}

impl Pieces {
    /// Divides the edges of a network between the tetrahedra of a valid mesh. The network may touch the boundary of the mesh.
    ///
    /// # Errors
    /// If an edge leaves the mesh, or `progress` cancels.
    pub fn of(mesh: &TetMesh, network: &Skeleton, progress: &dyn Progress) -> Result<Self, PiecesError> {
        let total = network.edges.len();
        progress.at(Stage::Embed, 0, total as u64);
        let cells = Cells::new(mesh);
        let starts = tets_of_nodes(mesh, network);
        let edges: Vec<EdgeId> = network.edge_ids().collect();
        let mut list = Vec::new();
        for batch in edges.chunks(BATCH) {
            if progress.is_cancelled() {
                return Err(PiecesError::Cancelled);
            }
            let found: Result<Vec<Vec<Piece>>, PiecesError> =
                batch.par_iter().map(|&edge| pieces_of(&cells, network, edge, &starts)).collect();
            list.extend(found?.into_iter().flatten());
            let done = batch.last().map_or(0, |edge| edge.index() + 1);
            progress.at(Stage::Embed, done as u64, total as u64);
        }
        Ok(Self { list })
    }

    /// Verifies that the pieces of each edge cover it without gaps or overlaps, and that their lengths add up to that of the
    /// edge. The middle of each piece must lie in its cell.
    ///
    /// # Errors
    /// The first fault.
    pub fn check(&self, mesh: &TetMesh, network: &Skeleton) -> Result<(), PieceFault> {
        let mut next = 0;
        for edge in network.edge_ids() {
            let from = next;
            while self.list.get(next).is_some_and(|piece| piece.edge == edge) {
                next += 1;
            }
            covers(&self.list[from..next], network, edge)?;
        }
        if let Some(piece) = self.list.get(next) {
            return Err(PieceFault::Cover { edge: piece.edge.0, at: piece.ends[0] });
        }
        let is_outside = |piece: &Piece| !is_in_cell(piece, mesh, network);
        self.list.iter().position(is_outside).map_or(Ok(()), |piece| Err(PieceFault::Cell { piece }))
    }
}

/// Ends of an edge.
fn ends(network: &Skeleton, edge: EdgeId) -> [&Point3; 2] {
    network.edges[edge.index()].nodes.map(|node| &network.nodes[node.index()].position)
}

fn pieces_of(cells: &Cells, network: &Skeleton, edge: EdgeId, starts: &[u32]) -> Result<Vec<Piece>, PiecesError> {
    let [p, q] = ends(network, edge);
    let nodes = network.edges[edge.index()].nodes;
    if let Some(node) = nodes.into_iter().find(|node| starts[node.index()] == u32::MAX) {
        let at = network.nodes[node.index()].position.coords.into();
        return Err(PiecesError::Outside { edge: edge.0, at });
    }
    let (length, mut list) = ((q - p).norm(), Vec::new());
    let add = |tet: u32, ends: [f64; 2]| list.push(Piece { edge, tet, ends, length: (ends[1] - ends[0]) * length });
    match cells.follow([p, q], starts[nodes[0].index()], add) {
        Ok(()) => Ok(list),
        Err(Lost::Leaves(t)) => Err(PiecesError::Outside { edge: edge.0, at: p.lerp(q, t).coords.into() }),
        Err(Lost::Invalid) => Err(PiecesError::Mesh { edge: edge.0 }),
    }
}

/// Checks the parameters and lengths of the pieces of an edge.
fn covers(pieces: &[Piece], network: &Skeleton, edge: EdgeId) -> Result<(), PieceFault> {
    let (mut at, mut found) = (0.0, 0.0);
    for piece in pieces {
        let [from, to] = piece.ends;
        if from != at || to <= from {
            return Err(PieceFault::Cover { edge: edge.0, at });
        }
        at = to;
        found += piece.length;
    }
    let expected = network.length(edge);
    if at != 1.0 {
        return Err(PieceFault::Cover { edge: edge.0, at });
    }
    // Each piece and each sum is rounded.
    let roundoff = 4.0 * f64::EPSILON * expected * (pieces.len() + 1) as f64;
    if (found - expected).abs() <= roundoff {
        Ok(())
    } else {
        Err(PieceFault::Length { edge: edge.0, found, expected })
    }
}

/// True if the middle of a piece lies in its closed cell, except for roundoff.
fn is_in_cell(piece: &Piece, mesh: &TetMesh, network: &Skeleton) -> bool {
    let [p, q] = ends(network, piece.edge);
    let middle = p.lerp(q, piece.middle());
    let at = corners(mesh, piece.tet);
    let size = (at[1] - at[0]).norm();
    let tolerance = ROUNDOFF * (size + (q - p).norm()) + 4.0 * f64::EPSILON * middle.coords.amax();
    (0..4).all(|i| {
        let [a, b, c] = [1, 2, 3].map(|k| at[(i + k) % 4]);
        let normal = (b - a).cross(&(c - a));
        // Distance from the face, positive on the side of the fourth corner.
        let inwards = normal.dot(&(at[i] - a)).signum();
        inwards * normal.dot(&(middle - a)) >= -tolerance * normal.norm()
    })
}
