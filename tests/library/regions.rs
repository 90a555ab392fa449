//! Regions around the lumen of a network, by the library.

use anastomesh::check::{CheckReport, Expectation, check_tets, check_volume};
use anastomesh::domain::{
    Domain, DomainInParts, DomainPlan, DomainPlanError, MemoryShelf, ShellPlan, Thickness, TissuePlan, TissueShape,
};
use anastomesh::mesh::adjacency::{boundary_faces, vertices_of};
use anastomesh::mesh::source::gather;
use anastomesh::mesh::{NamedRegion, TetMesh, VolumeMesh};
use anastomesh::meshing::{MeshPlan, mesh_network};
use anastomesh::skeleton::Skeleton;
use anastomesh::skeleton::fixtures::network;

/// A fork of three vessels, and its lumen.
fn fork() -> (Skeleton, VolumeMesh) {
    let points = [[0.0, 0.0, 0.0], [0.0, 0.0, 10.0], [6.0, 0.0, 16.0], [-6.0, 0.0, 16.0]];
    let network = network(&points, 1.0, &[(0, 1), (1, 2), (1, 3)]);
    let made = mesh_network(&network, &MeshPlan::default(), &()).expect("meshed").mesh;
    (network, made)
}

fn wall(share: f64) -> ShellPlan {
    ShellPlan::new("wall", Thickness::Law { length: 0.0, radii: share })
}

/// Expectation of the fork.
fn expected() -> Expectation {
    Expectation { loops: vec![0], terminals: vec![0, 2, 3] }
}

/// Mesh of one region.
fn region(volume: &VolumeMesh, id: i32) -> TetMesh {
    let tets = volume.mesh.tets.iter().zip(&volume.tet_block).filter(|(_, block)| **block == id).map(|(t, _)| *t);
    let mut mesh = TetMesh { points: volume.mesh.points.clone(), tets: tets.collect() };
    let used = vertices_of(&mesh.tets, mesh.points.len());
    let mut number = vec![0; used.len()];
    let mut points = Vec::new();
    for v in (0..used.len()).filter(|&v| used[v]) {
        number[v] = points.len() as u32;
        points.push(mesh.points[v]);
    }
    mesh.points = points;
    mesh.tets.iter_mut().for_each(|t| *t = t.map(|v| number[v as usize]));
    mesh
}

#[test]
fn wall_and_tissue_conform_to_the_lumen() {
    let (network, lumen) = fork();
    let tissue = TissuePlan::new(TissueShape::Box { margin: Some(2.0) });
    let shells = vec![wall(0.2), ShellPlan::new("annulus", Thickness::Law { length: 0.3, radii: 0.0 }).layers(1)];
    let plan = DomainPlan::default().shells(shells).tissue(tissue);
    let domain = Domain::around(lumen.clone(), &network, &plan, &expected(), &()).expect("made");
    assert_eq!(
        domain.regions.iter().map(|r| r.name.as_str()).collect::<Vec<_>>(),
        ["lumen", "wall", "annulus", "tissue"]
    );
    let volume = &domain.mesh;
    assert_eq!(volume.mesh.tets[..lumen.mesh.tets.len()], lumen.mesh.tets);
    let faults: Vec<_> = check_tets(&volume.mesh, None).failed().map(|line| (line.line, line.count)).collect();
    assert!(faults.is_empty(), "{faults:?}");
    for NamedRegion { id, name } in &domain.regions {
        let faults: Vec<_> = check_tets(&region(volume, *id), None).failed().map(|line| line.line).collect();
        assert!(faults.is_empty(), "{name}: {faults:?}");
    }
    let names: Vec<&str> = volume.patches.iter().map(|patch| patch.name.as_str()).collect();
    for name in
        ["interface_lumen_wall", "interface_wall_annulus", "interface_annulus_tissue", "organ", "ring_wall_inlet"]
    {
        assert!(names.contains(&name), "{name} {names:?}");
    }
    assert!(domain.check.is_valid(), "{:?}", domain.check.failed().collect::<Vec<_>>());
    let shells = domain.shells.expect("shells");
    assert!(shells.complete * 10 > shells.points * 9, "{shells:?}");
}

#[test]
fn regions_in_parts_are_the_same_mesh() {
    let (network, lumen) = fork();
    let tissue = TissuePlan::new(TissueShape::Box { margin: Some(2.0) }).piece(3_000);
    let shells = vec![wall(0.2), ShellPlan::new("annulus", Thickness::Law { length: 0.3, radii: 0.0 }).layers(1)];
    let shelf = MemoryShelf::default();
    let lumen_check = check_volume(&lumen, Some(&expected()));
    for plan in [DomainPlan::default().shells(shells.clone()).tissue(tissue), DomainPlan::default().shells(shells)] {
        let whole = Domain::around(lumen.clone(), &network, &plan, &expected(), &()).expect("made");
        // The second time, pieces are found.
        for _ in 0..2 {
            let parts = DomainInParts::around(&lumen, &network, &plan, &lumen_check, &shelf, &()).expect("made");
            assert_eq!(gather(&parts.mesh).expect("readable"), whole.mesh);
            assert_eq!((&parts.regions, &parts.shells), (&whole.regions, &whole.shells));
            assert_eq!(parts.check.failed().count(), 0);
            assert!(parts.check.is_valid());
            let [few, many] = [&parts.check, &whole.check];
            assert_eq!(few.counts.components, many.counts.components);
            assert_eq!(few.counts.boundary_components, many.counts.boundary_components);
            let sizes = |check: &CheckReport| {
                check.regions.iter().map(|r| (r.tets, r.components, r.boundary_faces)).collect::<Vec<_>>()
            };
            assert_eq!(sizes(few), sizes(many));
        }
    }
}

#[test]
fn regions_can_be_left_out() {
    let (network, lumen) = fork();
    let plan = DomainPlan::default().shells(vec![wall(0.3)]).without(vec!["lumen".into()]);
    let domain = Domain::around(lumen, &network, &plan, &expected(), &()).expect("made");
    assert_eq!(domain.regions, [NamedRegion::new(2, "wall")]);
    let volume = &domain.mesh;
    assert!(check_tets(&volume.mesh, None).failed().next().is_none());
    let mut outer: Vec<[u32; 3]> = boundary_faces(&volume.mesh);
    let mut listed = volume.boundary.clone();
    for faces in [&mut outer, &mut listed] {
        for face in faces.iter_mut() {
            let least = (0..3).min_by_key(|&i| face[i]).unwrap_or_default();
            face.rotate_left(least);
        }
        faces.sort_unstable();
    }
    assert_eq!(outer, listed);
}

#[test]
fn senseless_plans_are_refused() {
    let none = DomainPlan::default();
    let refused = |plan: DomainPlan| plan.validate().expect_err("refused");
    assert!(matches!(refused(none.clone().shells(vec![wall(-0.1)])), DomainPlanError::Thickness { .. }));
    assert!(matches!(refused(none.clone().shells(vec![wall(0.1).layers(0)])), DomainPlanError::Layers { .. }));
    assert!(matches!(refused(none.clone().shells(vec![wall(0.1), wall(0.2)])), DomainPlanError::SameName(_)));
    assert!(matches!(refused(none.clone().without(vec!["wall".into()])), DomainPlanError::Unknown { .. }));
    assert!(matches!(refused(none.clone().without(vec!["lumen".into()])), DomainPlanError::Nothing));
    let tissue = TissuePlan::new(TissueShape::Box { margin: Some(0.0) });
    assert!(matches!(refused(none.tissue(tissue)), DomainPlanError::Tissue { what: "margin", .. }));
}
