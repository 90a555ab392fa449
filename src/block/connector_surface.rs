//! Surface of a connector (section 3.2.3 of the paper, Fig. 6): a regular tube between two reversed end surfaces.

use super::end_surface::{EndSurface, StoredEnd};
use super::path::{AxisPath, PathEnd};
use super::rings::{Rim, RingVertex, rings, strip_count};
use super::strip::best_strip;
use super::wall::TubeWall;
use anastomesh_mesh::TriMesh;
use anastomesh_mesh::geometry::{Point3, Section};
use std::f64::consts::TAU;

/// One side of a connector: an end surface with the points of its cluster.
#[derive(Clone, Copy, Debug)]
pub struct ConnectorEnd<'a> {
    pub surface: &'a EndSurface,
    /// Points of the cluster.
    pub points: &'a [Point3],
}

impl<'a> From<&'a StoredEnd> for ConnectorEnd<'a> {
    fn from(end: &'a StoredEnd) -> Self {
        Self { surface: &end.surface, points: &end.points }
    }
}

/// Connector vertex that is a vertex of one of the two clusters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct EndVertex {
    /// Side of the cut, 0 or 1.
    pub side: u8,
    /// Index in that side's cluster, or in its [`crate::surface::SharedDisc`] for a connector without clusters.
    pub vertex: u32,
}

/// Closed surface of a connector.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ConnectorSurface {
    /// Surface; its points begin with those of `shared`.
    pub surface: TriMesh,
    /// Cluster vertices of the first points: side 0's, then side 1's, ascending.
    pub shared: Vec<EndVertex>,
    /// Number of triangles in the end surfaces; they come first.
    pub end_triangles: u32,
    /// Number of rings between the rims.
    pub rings: u32,
}

/// Reasons for a missing connector surface.
#[non_exhaustive]
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ConnectorFault {
    /// The path has no length.
    #[error("the path has zero length")]
    Path,
    /// The disc of a side cannot be triangulated.
    #[error("the disc of side {0} cannot be triangulated")]
    Disc(u8),
    /// A rim does not wind once around the axis.
    #[error("the rim of side {0} does not wind once around the axis")]
    Rim(u8),
    /// The end surfaces intersect each other's planes.
    #[error("the end surfaces overlap along the axis")]
    Overlap,
    /// Every strip between two neighbouring rings folds.
    #[error("the surface folds at strip {0}")]
    Fold(u32),
}

/// Division of the tube between the rims.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Division {
    /// Rings at this multiple of the default density.
    Rings(f64),
    /// No rings: the rims are joined directly.
    Direct,
}

/// Creates the surface of a connector along `path`, which runs from side 0 to side 1.
///
/// # Errors
/// See [`ConnectorFault`].
pub fn connector_surface(
    path: &[Section],
    ends: [ConnectorEnd; 2],
    division: Division,
) -> Result<ConnectorSurface, ConnectorFault> {
    let path = AxisPath::new(path).ok_or(ConnectorFault::Path)?;
    let mut out = ConnectorSurface::default();
    let loops = [copy_end(&mut out, ends[0], 0), copy_end(&mut out, ends[1], 1)];
    out.end_triangles = out.surface.triangles.len() as u32;
    let rims = [
        rim(&path, &out.surface.points, &loops[0], PathEnd::Start).ok_or(ConnectorFault::Rim(0))?,
        rim(&path, &out.surface.points, &loops[1], PathEnd::End).ok_or(ConnectorFault::Rim(1))?,
    ];
    if rims[0].level >= rims[1].level {
        return Err(ConnectorFault::Overlap);
    }
    let both = [&rims[0], &rims[1]];
    let strips = match division {
        Division::Rings(density) => strip_count(&path, both, density),
        Division::Direct => 1,
    };
    let rows = rings(&path, both, strips);
    out.rings = rows.len() as u32;
    build_wall(&path, &mut out, &loops, both, &rows)?;
    Ok(out)
}

/// Adopts an end surface, reversed. Returns its rim, counter-clockwise about the path's direction.
fn copy_end(out: &mut ConnectorSurface, end: ConnectorEnd, side: u8) -> Vec<u32> {
    let vertices = end.surface.vertices();
    let base = out.surface.points.len() as u32;
    let local = |v: &u32| base + vertices.partition_point(|x| x < v) as u32;
    out.surface.points.extend(vertices.iter().map(|&v| end.points[v as usize]));
    out.surface.triangles.extend(end.surface.triangles.iter().map(|t| [local(&t[0]), local(&t[2]), local(&t[1])]));
    let mut rim: Vec<u32> = end.surface.rim.iter().map(local).collect();
    if side == 1 {
        rim.reverse();
    }
    out.shared.extend(vertices.iter().map(|&vertex| EndVertex { side, vertex }));
    rim
}

/// Rim in path coordinates; `None` unless it winds once around the axis.
fn rim(path: &AxisPath, points: &[Point3], vertices: &[u32], end: PathEnd) -> Option<Rim> {
    let located: Vec<(f64, f64, f64)> = vertices.iter().map(|&v| path.locate(&points[v as usize], end)).collect();
    let rim = Rim::new(&located);
    let first = *rim.theta.first()?;
    let last = *rim.theta.last()?;
    let winding = last + anastomesh_mesh::geometry::turn(first - last) - first;
    ((winding - TAU).abs() < 0.1).then_some(rim)
}

fn build_wall(
    path: &AxisPath,
    out: &mut ConnectorSurface,
    loops: &[Vec<u32>; 2],
    rims: [&Rim; 2],
    rows: &[Vec<RingVertex>],
) -> Result<(), ConnectorFault> {
    let first_free = out.surface.points.len() as u32;
    let mut points = std::mem::take(&mut out.surface.points);
    let mut cycles: Vec<(Vec<u32>, f64)> = vec![(loops[0].clone(), rims[0].level)];
    let mut vertices = Vec::new();
    for row in rows {
        let start = points.len() as u32;
        points.extend(row.iter().map(|v| path.at(v.s).point(v.theta, v.distance)));
        vertices.extend_from_slice(row);
        let level = row.iter().map(|v| v.s).sum::<f64>() / row.len() as f64;
        cycles.push(((start..points.len() as u32).collect(), level));
    }
    cycles.push((loops[1].clone(), rims[1].level));
    let mut triangles = Vec::new();
    for (k, pair) in cycles.windows(2).enumerate() {
        let place = path.at(0.5 * (pair[0].1 + pair[1].1));
        let strip = best_strip(&points, &pair[0].0, &pair[1].0, place.origin, place.axis);
        triangles.extend(strip.ok_or(ConnectorFault::Fold(k as u32))?.0);
    }
    let mut wall = TubeWall::new(path, points, triangles, first_free, vertices);
    wall.improve();
    out.surface.points = wall.points;
    out.surface.triangles.extend(wall.triangles);
    Ok(())
}
