//! A region as a closed surface with numbers of its own.

use super::regions::RegionShape;
use crate::error::{Obstacle, TetError};
use crate::input::SurfaceEdges;
use crate::options::{Interior, Refinement, Sizing};
use crate::plc::{InputKind, Region};
use crate::request::Request;
use anastomesh_mesh::TriMesh;
use anastomesh_mesh::geometry::Aabb;

/// Region as a surface whose points and triangles are numbered from 0.
pub(super) struct Local<'a> {
    pub shape: &'a RegionShape,
    /// Closed boundary, seen from outside, followed by the baffles.
    pub surface: TriMesh,
    /// Segments inside.
    pub segments: Vec<[u32; 2]>,
    region: Option<&'a Region>,
    refinement: Option<Refinement>,
    sizing: Option<Sizing>,
    interior: Option<Interior>,
    /// Numbers of the interior points given, if they are limited to the region.
    interior_of: Vec<u32>,
    max_tets: Option<usize>,
}

/// Tetrahedra and points that count towards the limits of a run before a region is filled.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Spent {
    pub tets: usize,
    pub points: usize,
}

impl<'a> Local<'a> {
    pub(super) fn new(r: &Request<'a>, shape: &'a RegionShape, spent: Spent) -> Self {
        let number = |v: u32| shape.points.partition_point(|&w| w < v) as u32;
        let baffles = shape.baffles.iter().map(|&t| r.surface.triangles[t as usize]);
        let triangles = shape.boundary.iter().map(|side| side.vertices).chain(baffles);
        let points = shape.points.iter().map(|&v| r.surface.points[v as usize]).collect();
        let surface = TriMesh { points, triangles: triangles.map(|t| t.map(number)).collect() };
        let sizing = match r.sizing {
            Sizing::PerVertex(sizes) => {
                Some(Sizing::PerVertex(shape.points.iter().map(|&v| sizes[v as usize]).collect()))
            }
            _ => None,
        };
        let (interior, interior_of) = interior_within(r.interior, &surface);
        let limited = |refinement: &Refinement| Refinement {
            max_points: refinement.max_points.map(|most| most.saturating_sub(spent.points)),
            ..*refinement
        };
        Self {
            shape,
            surface,
            segments: shape.segments.iter().map(|edge| edge.map(number)).collect(),
            region: shape.seed.and_then(|seed| r.regions.get(seed as usize)),
            refinement: r.refinement.map(limited),
            sizing,
            interior,
            interior_of,
            max_tets: r.max_tets.map(|limit| limit.saturating_sub(spent.tets)),
        }
    }

    /// Request to fill the region, with `surface` in place of its own.
    pub(super) fn request<'b>(&'b self, r: &Request<'b>, surface: &'b TriMesh, edges: &'b SurfaceEdges) -> Request<'b> {
        Request {
            surface,
            edges,
            segments: &self.segments,
            kind: InputKind::Closed,
            baffles: self.shape.baffles.len(),
            holes: &[],
            regions: &[],
            region: self.region,
            interior: self.interior.as_ref().unwrap_or(r.interior),
            refinement: self.refinement.as_ref(),
            sizing: self.sizing.as_ref().unwrap_or(r.sizing),
            certify: false,
            strict: false,
            max_tets: self.max_tets,
            label: false,
            ..*r
        }
    }

    /// Number of triangles of the closed boundary.
    pub(super) fn boundary(&self) -> usize {
        self.shape.boundary.len()
    }

    /// Replaces the numbers in an error by those of the input.
    pub(super) fn as_given(&self, error: TetError, spent: Spent) -> TetError {
        let point = |v: u32| self.shape.points.get(v as usize).copied().unwrap_or(v);
        let boundary = self.shape.boundary.iter().map(|side| side.triangle);
        let numbers: Vec<u32> = boundary.chain(self.shape.baffles.iter().copied()).collect();
        let triangle = |t: u32| numbers.get(t as usize).copied().unwrap_or(t);
        let part = |part: Obstacle| match part {
            Obstacle::Triangle(t) => Obstacle::Triangle(t.map(point)),
            Obstacle::Edge(edge) => Obstacle::Edge(edge.map(point)),
            Obstacle::Point(v) => Obstacle::Point(point(v)),
        };
        match error {
            TetError::Stuck { part: stuck, reason } => TetError::Stuck { part: part(stuck), reason },
            TetError::EdgeMeets { edge, obstacle } => {
                TetError::EdgeMeets { edge: edge.map(point), obstacle: part(obstacle) }
            }
            TetError::NotRecovered { edges, triangles } => TetError::NotRecovered {
                edges: edges.into_iter().map(|edge| edge.map(point)).collect(),
                triangles: triangles.into_iter().map(triangle).collect(),
            },
            TetError::SelfIntersection { pairs, count, complete } => {
                let pairs = pairs.into_iter().map(|pair| pair.map(triangle)).collect();
                TetError::SelfIntersection { pairs, count, complete }
            }
            TetError::NotSeparating { triangle: t } => TetError::NotSeparating { triangle: triangle(t) },
            TetError::BadInteriorPoint { index, position } => {
                let index = self.interior_of.get(index as usize).copied().unwrap_or(index);
                TetError::BadInteriorPoint { index, position }
            }
            TetError::TooMany { estimate, limit } => {
                TetError::TooMany { estimate: estimate + spent.tets, limit: limit + spent.tets }
            }
            other => other,
        }
    }
}

/// Interior points given that lie in the box of a surface, with their numbers. Points that are not finite stay, and are
/// refused later.
fn interior_within(interior: &Interior, surface: &TriMesh) -> (Option<Interior>, Vec<u32>) {
    let Interior::Points(points) = interior else { return (None, Vec::new()) };
    let Aabb { min, max } = Aabb::of_points(&surface.points);
    let is_outside = |axis: usize, x: f64| x < min[axis] || x > max[axis];
    let near = points.iter().zip(0..).filter(|(p, _)| !(0..3).any(|axis| is_outside(axis, p[axis])));
    let (points, numbers) = near.unzip();
    (Some(Interior::Points(points)), numbers)
}
