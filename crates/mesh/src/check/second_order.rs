//! Conditions on second-order meshes.

use super::labels::AREA;
use super::result::{CheckReport, Line, LineResult, Offender, OffenderKind, Outcome, Skipped, Tally};
use crate::geometry::Vec3;
use crate::second_order::{FACE_EDGES, SecondOrder, check_jacobians, volume_of};
use crate::{TetMesh, VolumeMesh};
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::f64::consts::PI;

impl CheckReport {
    /// Adds the conditions on the midpoints of a second-order mesh to the report on the mesh of its corners. Volumes and areas of caps
    /// become those within the curved surfaces.
    ///
    /// ```
    /// use anastomesh_mesh::VolumeMesh;
    /// use anastomesh_mesh::check::{Line, Outcome, check_tets};
    /// use anastomesh_mesh::second_order::SecondOrder;
    /// use anastomesh_mesh::shapes::cube_lattice;
    ///
    /// let volume = VolumeMesh { mesh: cube_lattice(2), ..VolumeMesh::default() };
    /// let second = SecondOrder::straight(&volume);
    /// let report = check_tets(&volume.mesh, None).with_second_order(&volume, &second);
    /// assert_eq!(report.line(Line::PositiveJacobians).map(|line| line.outcome), Some(Outcome::Pass));
    /// ```
    ///
    /// # Panics
    /// If the mesh has no invalid vertex index, and an edge of it has no midpoint.
    #[must_use]
    pub fn with_second_order(self, volume: &VolumeMesh, second: &SecondOrder) -> Self {
        let Self { mut counts, mut regions, mut lines, quality, intersections, .. } = self;
        let invalid = [Line::FinitePoints, Line::IndicesInRange];
        let broken = lines.iter().find(|line| line.outcome == Outcome::Fail && invalid.contains(&line.line));
        if let Some(line) = broken.map(|line| line.line) {
            lines.extend(Line::OF_SECOND_ORDER.map(|skipped| LineResult::skipped(skipped, Skipped::Because(line))));
        } else {
            let mesh = &volume.mesh;
            lines.extend([shared_midpoints(mesh, second), positive_jacobians(mesh, second)]);
            let volumes = volumes(volume, second);
            counts.volume = volumes.values().sum();
            for region in &mut regions {
                region.volume = volumes.get(&region.id).copied().unwrap_or(0.0);
            }
            let was_checked = |line: &&mut LineResult| matches!(line.outcome, Outcome::Pass | Outcome::Fail);
            if let Some(areas) = lines.iter_mut().find(|line| line.line == Line::CapArea).filter(was_checked) {
                *areas = cap_areas(volume, second);
            }
        }
        Self { regions, ..Self::new(counts, lines, quality, intersections) }
    }
}

/// Volume of the elements of each block.
fn volumes(volume: &VolumeMesh, second: &SecondOrder) -> BTreeMap<i32, f64> {
    let VolumeMesh { mesh, tet_block, .. } = volume;
    let of_tets: Vec<f64> = mesh.tets.par_iter().map(|tet| volume_of(&second.nodes(&mesh.points, *tet))).collect();
    let mut volumes = BTreeMap::new();
    for (i, own) in of_tets.into_iter().enumerate() {
        *volumes.entry(tet_block.get(i).copied().unwrap_or(0)).or_insert(0.0) += own;
    }
    volumes
}

/// Compares the areas of caps with those of their discs. Each rim edge e with the offset o adds the area of a parabola, ⅔ |o × e|.
fn cap_areas(volume: &VolumeMesh, second: &SecondOrder) -> LineResult {
    let points = &volume.mesh.points;
    let mut areas: BTreeMap<i32, Vec3> = BTreeMap::new();
    for (face, &patch) in volume.boundary.iter().zip(&volume.boundary_patch) {
        let corners = face.map(|v| points[v as usize]);
        let mut area = (corners[1] - corners[0]).cross(&(corners[2] - corners[0])) * 0.5;
        for [i, j] in FACE_EDGES {
            let Some(edge) = second.edge_between(face[i], face[j]) else { continue };
            let offset = second.middles()[edge as usize] - nalgebra::center(&corners[i], &corners[j]);
            area += offset.cross(&(corners[j] - corners[i])) * (2.0 / 3.0);
        }
        *areas.entry(patch).or_default() += area;
    }
    let mut tally = Tally::new(Line::CapArea);
    for (patch, cap) in volume.patches.iter().filter_map(|patch| Some((patch.id, patch.cap?))) {
        let (found, disc) = (areas.get(&patch).map_or(0.0, Vec3::norm), PI * cap.radius * cap.radius);
        let off = (found - disc).abs();
        if off.is_nan() || off > AREA * disc {
            let position = Some(cap.center.coords.into());
            tally.add(|| Offender { kind: OffenderKind::Patch, ids: vec![patch.into()], position });
        }
    }
    tally.done()
}

fn shared_midpoints(mesh: &TetMesh, second: &SecondOrder) -> LineResult {
    let mut tally = Tally::new(Line::SharedMidpoints);
    for &edge in second.split_edges() {
        let ends = second.edges()[edge as usize];
        tally.add(|| Offender::new(OffenderKind::Edge, &ends, Some(mesh.points[ends[0] as usize])));
    }
    tally.done()
}

fn positive_jacobians(mesh: &TetMesh, second: &SecondOrder) -> LineResult {
    let mut tally = Tally::new(Line::PositiveJacobians);
    for tet in check_jacobians(mesh, second).invalid {
        let corner = mesh.tets[tet as usize][0];
        tally.add(|| Offender::new(OffenderKind::Tet, &[tet], Some(mesh.points[corner as usize])));
    }
    tally.done()
}

#[cfg(test)]
mod tests {
    use crate::check::{Line, Verdict, check_tets};
    use crate::second_order::{QuadraticMesh, SecondOrder};
    use crate::shapes::cube_lattice;
    use crate::{Point3, VolumeMesh};

    #[test]
    fn midpoints_that_fold_elements_or_differ_between_them_are_found() {
        let volume = VolumeMesh { mesh: cube_lattice(2), ..VolumeMesh::default() };
        let second = SecondOrder::straight(&volume);
        let whole = QuadraticMesh {
            points: volume.mesh.points.iter().chain(second.middles()).copied().collect(),
            tets: volume.mesh.tets.iter().map(|&tet| second.tet_nodes(tet)).collect(),
            faces: Vec::new(),
        };
        let failed = |change: &dyn Fn(&mut QuadraticMesh)| {
            let mut mesh = whole.clone();
            change(&mut mesh);
            let parts = mesh.parts().unwrap();
            let mesh = crate::TetMesh { points: parts.points, tets: parts.tets };
            let volume = VolumeMesh { mesh, ..VolumeMesh::default() };
            let report = check_tets(&volume.mesh, None).with_second_order(&volume, &parts.second);
            let lines: Vec<Line> = report.failed().map(|failed| failed.line).collect();
            assert_eq!(report.verdict == Verdict::Invalid, !lines.is_empty());
            lines
        };
        assert_eq!(failed(&|_| ()), []);
        let inner = second.edge_between(0, 13).unwrap() as usize + volume.mesh.points.len();
        assert_eq!(failed(&|mesh| mesh.points[inner] = Point3::new(0.6, 0.0, 0.1)), [Line::PositiveJacobians]);
        assert_eq!(failed(&|mesh| mesh.points[inner].x = f64::NAN), [Line::PositiveJacobians]);
        let apart = |mesh: &mut QuadraticMesh| {
            mesh.points.push(mesh.points[inner]);
            let own = mesh.points.len() as u32 - 1;
            let node = mesh.tets.iter_mut().flatten().find(|node| **node == inner as u32).unwrap();
            *node = own;
        };
        assert_eq!(failed(&apart), [Line::SharedMidpoints]);
    }
}
