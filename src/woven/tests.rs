//! Tests of trimmed clusters and the connectors between them.

use super::cluster::mesh_trimmed;
use super::fixtures::lattice_tube;
use super::trim::{TrimOptions, trim};
use crate::block::fixtures::{
    assert_mesh, assert_taken_over, bifurcation, facing, flipped, neighbours, straight, wall_angle, worst_ratio,
};
use crate::block::{BlockParams, ConnectorEnd, CutEnd, Division, connector_surface, mesh_cluster, mesh_connector};
use crate::partition::{Cluster, ClusterId, CutId};
use anastomesh_mesh::geometry::{Point3, Tube};
use anastomesh_tet::parts::Watch;

#[test]
fn bifurcations_are_meshed_and_joined() {
    for seed in 0..6 {
        let params = BlockParams::with_rho(3.0 + (seed % 2) as f64);
        // The discs may also come from the walls of the two clusters.
        let mesh = |id, cluster: &Cluster| match seed % 3 {
            2 => mesh_cluster(id, cluster, &params),
            _ => mesh_trimmed(id, cluster, &params, &Watch::NOBODY),
        };
        let cluster = bifurcation(seed);
        let lower = mesh(ClusterId(0), &cluster).expect("cluster");
        assert_mesh(&lower.mesh, 2);
        assert_eq!((lower.ends.len(), lower.caps.len()), (2, 1));
        for end in &lower.ends {
            assert_eq!(end.check(&lower.mesh.points), Ok(()));
        }
        let (facing, gap) = facing(&cluster);
        let upper = mesh(ClusterId(1), &facing).expect("facing cluster");
        let ends = [
            ConnectorEnd { surface: &lower.ends[0], points: &lower.mesh.points },
            ConnectorEnd { surface: &upper.ends[0], points: &upper.mesh.points },
        ];
        let connector = mesh_connector(CutId(0), &gap, ends, &params).expect("connector");
        assert_mesh(&connector.mesh, 2);
        assert!(connector.failed.is_empty());
        for (p, v) in connector.mesh.points.iter().zip(&connector.shared) {
            assert_eq!(*p, ends[v.side as usize].points[v.vertex as usize]);
        }
        assert!(worst_ratio(&connector.mesh) > 0.03, "{}", worst_ratio(&connector.mesh));
    }
}

#[test]
fn trimmed_tubes_are_joined() {
    let (mut worst, mut joined) = (180.0f64, 0);
    for seed in 0..24 {
        let rho = 3.0 + (seed % 3) as f64;
        let h = 2.0 / rho;
        let path = straight(seed, 3.0, [1.0, 1.0]);
        let axis = path[0].axis;
        let tube = |a: Point3, b: Point3| Tube { a, b, ra: 1.0, rb: 1.0 };
        let lower = lattice_tube(&tube(path[0].origin - axis * 4.0, path[0].origin + axis * 1.5), h, 0.2, seed);
        let upper = lattice_tube(&tube(path[1].origin - axis * 1.5, path[1].origin + axis * 4.0), h, 0.2, seed + 1);
        let options = TrimOptions { edge: h, relax: true, depth: 2.0 };
        let cut = |side, section| CutEnd { cut: CutId(0), side, section };
        let a = trim(&lower, &neighbours(&lower), &[cut(0, path[0])], &[], &options);
        let b = trim(&upper, &neighbours(&upper), &[cut(1, flipped(&path[1]))], &[], &options);
        let (Ok(a), Ok(b)) = (a, b) else { continue };
        let ends = [
            ConnectorEnd { surface: &a.ends[0], points: &a.mesh.points },
            ConnectorEnd { surface: &b.ends[0], points: &b.mesh.points },
        ];
        let Ok(out) = connector_surface(&path, ends, Division::Rings(1.0)) else { continue };
        assert_taken_over(&out, ends);
        joined += 1;
        worst = worst.min(wall_angle(&out));
    }
    assert!(joined >= 22, "{joined}");
    // Staircase rims are far worse than those of a contoured wall.
    assert!(worst > 8.0, "{worst}");
}
