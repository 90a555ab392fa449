//! Translation of the ids in errors to those of the caller, such as polygon numbers in a file.

use super::error::{Obstacle, TetError};
use super::plc::InputPart;

/// Names of the items of an input, for instance in its file.
pub trait Names {
    /// Returns the number of a point.
    fn point(&self, id: u32) -> u32;

    /// Returns the number of a triangle, or of the polygon that it is a piece of.
    fn triangle(&self, id: u32) -> u32;

    /// Returns the number of the seed of a hole or region.
    fn seed(&self, index: u32) -> u32 {
        index
    }
}

impl TetError {
    /// Renames points, triangles and seeds of an error; segments keep their ids.
    #[must_use]
    pub fn renamed(mut self, names: &impl Names) -> Self {
        let points = |ids: &mut [u32]| ids.iter_mut().for_each(|id| *id = names.point(*id));
        let faces = |ids: &mut [u32]| ids.iter_mut().for_each(|id| *id = names.triangle(*id));
        let part = |obstacle: &mut Obstacle| match obstacle {
            Obstacle::Triangle(corners) => points(corners),
            Obstacle::Edge(ends) => points(ends),
            Obstacle::Point(p) => *p = names.point(*p),
        };
        match &mut self {
            Self::OutOfRange { points: ids, .. } => points(ids),
            Self::DuplicatePoints { pairs, .. } => points(pairs.as_flattened_mut()),
            Self::BadTriangle { triangles, vertices, .. } | Self::FlatTriangle { triangles, vertices, .. } => {
                faces(triangles);
                points(vertices);
            }
            Self::DuplicateTriangles { pairs, .. } | Self::SelfIntersection { pairs, .. } => {
                faces(pairs.as_flattened_mut());
            }
            Self::Open(found) | Self::NotShared(found) | Self::NotManifold(found) | Self::NotOriented(found) => {
                faces(&mut found.triangles);
                points(&mut found.edge);
            }
            Self::BadSeed { index, .. } => *index = names.seed(*index),
            Self::EdgeMeets { edge, obstacle } => {
                points(edge);
                part(obstacle);
            }
            Self::NotRecovered { edges, triangles } => {
                points(edges.as_flattened_mut());
                faces(triangles);
            }
            Self::Stuck { part: met, .. } => part(met),
            Self::NotSeparating { triangle } => *triangle = names.triangle(*triangle),
            Self::Outside { part: InputPart::Triangles, ids, .. } => faces(ids),
            _ => {}
        }
        self
    }
}
