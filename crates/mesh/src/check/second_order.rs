//! Conditions on second-order meshes.

use super::result::{CheckReport, Line, LineResult, Offender, OffenderKind, Outcome, Skipped, Tally};
use crate::TetMesh;
use crate::second_order::{SecondOrder, check_jacobians};

impl CheckReport {
    /// Adds the conditions on the midpoints of a second-order mesh to the report on the mesh of its corners.
    ///
    /// ```
    /// use anastomesh_mesh::VolumeMesh;
    /// use anastomesh_mesh::check::{Line, Outcome, check_tets};
    /// use anastomesh_mesh::second_order::SecondOrder;
    /// use anastomesh_mesh::shapes::cube_lattice;
    ///
    /// let volume = VolumeMesh { mesh: cube_lattice(2), ..VolumeMesh::default() };
    /// let second = SecondOrder::straight(&volume);
    /// let report = check_tets(&volume.mesh, None).with_second_order(&volume.mesh, &second);
    /// assert_eq!(report.line(Line::PositiveJacobians).map(|line| line.outcome), Some(Outcome::Pass));
    /// ```
    ///
    /// # Panics
    /// If the mesh has no invalid vertex index, and an edge of it has no midpoint.
    #[must_use]
    pub fn with_second_order(self, mesh: &TetMesh, second: &SecondOrder) -> Self {
        let Self { counts, regions, mut lines, quality, intersections, .. } = self;
        let invalid = [Line::FinitePoints, Line::IndicesInRange];
        let broken = lines.iter().find(|line| line.outcome == Outcome::Fail && invalid.contains(&line.line));
        match broken.map(|line| line.line) {
            Some(line) => {
                lines.extend(Line::OF_SECOND_ORDER.map(|skipped| LineResult::skipped(skipped, Skipped::Because(line))));
            }
            None => lines.extend([shared_midpoints(mesh, second), positive_jacobians(mesh, second)]),
        }
        Self { regions, ..Self::new(counts, lines, quality, intersections) }
    }
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
            let report = check_tets(&mesh, None).with_second_order(&mesh, &parts.second);
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
