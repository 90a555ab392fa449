//! Tests of reading files according to the manual, and of written file families.

use super::*;
use crate::damage::damage;
use crate::file::FileError;
use crate::text::TextFault;
use crate::volume::fixtures::labelled_tube;
use anastomesh_mesh::VolumeMesh;
use anastomesh_mesh::adjacency::tet_adjacency;
use anastomesh_mesh::geometry::Point3;
use anastomesh_mesh::shapes::cube_lattice;
use proptest::prelude::*;
use std::collections::BTreeSet;
use std::path::Path;

const NODE: &str = "# four points\n4 3 2 1\n\n1 0 0 0  0.5 7  -1\n2 1 0 0  1.5 8  0\n3 0 1 0 2.5 9 3 # here\n\
    4 0 0 1 3.5 nan 4\n";

/// A cube with a square window in its lid, numbered from 1, with a region.
const POLY: &str = "8 3 0 0\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n5 0 0 1\n6 1 0 1\n7 1 1 1\n8 0 1 1\n\
    3 1\n1 0 -7 # floor\n4 1 2 3\n 4\n3 1 2 # lid\n4 5 6 7 8\n2 5 7\n1 6\n1 0.5 0.6 1\n1\n4 1 2 6 5\n\
    1\n1 0.5 0.5 0.5\n2\n1 0.1 0.1 0.1 10 0.25\n2 0.2 0.1 0.1 20 -1\n";

const SMESH: &str =
    "4 3\n0 0 0 0\n1 1 0 0\n2 0 1 0\n3 0 0 1\n4 1\n3 0 2 1 11\n3 0 1 3 12\n3 1 2 3\n3 2 0 3 -14\n0\n0\n";

#[test]
fn points_with_attributes_and_markers() {
    let nodes = Nodes::parse(NODE.as_bytes()).unwrap();
    assert_eq!(nodes.points[2], Point3::new(0.0, 1.0, 0.0));
    assert_eq!((nodes.attribute_count, nodes.attributes.len(), nodes.attributes[5]), (2, 8, 9.0));
    assert_eq!((nodes.markers, nodes.first), (vec![-1, 0, 3, 4], 1));
    let fault = |from: &str, to: &str| Nodes::parse(NODE.replacen(from, to, 1).as_bytes()).unwrap_err();
    assert_eq!(fault("\n1 0", "\n2 0"), TetgenFault::BadNumber { line: 4, found: 2, expected: 0 });
    assert_eq!(fault("\n3 0", "\n5 0"), TetgenFault::BadNumber { line: 6, found: 5, expected: 3 });
    assert_eq!(fault("4 3 2 1", "4 2 2 1"), TetgenFault::Dimension { line: 2, dimension: 2 });
    assert!(matches!(fault("  0\n", "\n"), TetgenFault::Text(TextFault::LineTooShort { line: 5, .. })));
    assert!(matches!(fault("4 3 2 1", "3 3 2 1"), TetgenFault::Text(TextFault::Surplus { line: 7 })));
    assert!(matches!(fault("4 3 2 1", "5 3 2 1"), TetgenFault::Text(TextFault::CutShort { .. })));
    assert!(matches!(fault("4 3 2 1", "4 3 9999999999 1"), TetgenFault::Text(TextFault::CountTooLarge { .. })));
    assert_eq!(Nodes::parse(b"0 3 0 0\n"), Err(TetgenFault::NoPoints));
}

#[test]
fn a_complex_with_holes_segments_and_regions() {
    let plc = Plc::parse(POLY.as_bytes(), PlcFormat::Poly).unwrap();
    assert_eq!((plc.points.len(), plc.first, plc.point_markers.len()), (8, 1, 0));
    assert_eq!(plc.facets[0], Facet { polygons: vec![vec![0, 1, 2, 3]], holes: vec![], marker: -7 });
    let lid = Facet {
        polygons: vec![vec![4, 5, 6, 7], vec![4, 6], vec![5]],
        holes: vec![Point3::new(0.5, 0.6, 1.0)],
        marker: 2,
    };
    assert_eq!(plc.facets[1], lid);
    assert_eq!(plc.facets[2], Facet { polygons: vec![vec![0, 1, 5, 4]], ..Facet::default() });
    assert_eq!(plc.holes, [Point3::new(0.5, 0.5, 0.5)]);
    assert_eq!((plc.regions[0].attribute, plc.regions[0].max_volume), (10.0, Some(0.25)));
    assert_eq!((plc.regions[1].attribute, plc.regions[1].max_volume), (20.0, None));
    let fault = |from: &str, to: &str| {
        assert!(POLY.contains(from), "{from}");
        Plc::parse(POLY.replacen(from, to, 1).as_bytes(), PlcFormat::Poly).unwrap_err()
    };
    let index = |index| TetgenFault::BadIndex { line: 16, facet: 2, index, points: 8, first: 1 };
    assert_eq!(fault("2 5 7", "2 5 9"), index(9));
    assert_eq!(fault("2 5 7", "2 5 0"), index(0));
    assert_eq!(fault("1 6\n", "0\n"), TetgenFault::EmptyFacet { line: 17, facet: 2 });
    assert!(matches!(fault("0.6", "inf"), TetgenFault::Text(TextFault::NotFinite { line: 18, .. })));
    assert!(matches!(fault("3 1\n", "3000000 1\n"), TetgenFault::Text(TextFault::CountTooLarge { line: 10, .. })));
    let one_number = Plc::parse(POLY.replacen("10 0.25", "10", 1).as_bytes(), PlcFormat::Poly).unwrap();
    assert_eq!((one_number.regions[0].attribute, one_number.regions[0].max_volume), (10.0, Some(10.0)));
    assert!(matches!(fault(" 10 0.25", ""), TetgenFault::Text(TextFault::LineTooShort { line: 24, .. })));
    let no_regions = POLY.find("2\n1 0.1").unwrap();
    assert!(Plc::parse(&POLY.as_bytes()[..no_regions], PlcFormat::Poly).unwrap().regions.is_empty());
}

#[test]
fn a_simple_complex() {
    let plc = Plc::parse(SMESH.as_bytes(), PlcFormat::Smesh).unwrap();
    assert_eq!(plc.facets.iter().map(|f| f.marker).collect::<Vec<_>>(), [11, 12, 0, -14]);
    assert_eq!(plc.facets[3].polygons, [[2, 0, 3]]);
    let fault = Plc::parse(SMESH.replacen("2 0 3", "2 0 4", 1).as_bytes(), PlcFormat::Smesh).unwrap_err();
    assert_eq!(fault, TetgenFault::BadIndex { line: 10, facet: 3, index: 4, points: 4, first: 0 });
}

#[test]
fn points_in_the_file_beside() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    std::fs::write(path("a.poly"), "0 3 0 1\n1 0\n1\n3 1 2 4\n0\n0\n").unwrap();
    assert!(matches!(read_plc(&path("a.poly")), Err(FileError::Read { path, .. }) if path.ends_with("a.node")));
    std::fs::write(path("a.node"), NODE).unwrap();
    let plc = read_plc(&path("a.poly")).unwrap();
    assert_eq!((plc.points.len(), &plc.point_markers[..], plc.first), (4, &[-1, 0, 3, 4][..], 1));
    assert_eq!(plc.facets[0].polygons, [[0, 1, 3]]);
    assert_eq!(read_nodes(&path("a.node")).unwrap().points, plc.points);
    assert!(matches!(read_plc(&path("a.node")), Err(FileError::UnknownFormat { .. })));
    assert!(matches!(read_nodes(&path("a.poly")), Err(FileError::UnknownFormat { .. })));
}

/// Rows of a written file, without its header.
fn rows(path: &Path) -> Vec<Vec<i64>> {
    let text = std::fs::read_to_string(path).unwrap();
    let mut lines = text.lines();
    let count: usize = lines.next().unwrap().split(' ').next().unwrap().parse().unwrap();
    let rows: Vec<Vec<i64>> = lines.map(|line| line.split(' ').map(|w| w.parse().unwrap()).collect()).collect();
    assert_eq!(rows.len(), count);
    rows
}

#[test]
fn the_family_of_a_labelled_mesh() {
    let folder = tempfile::tempdir().unwrap();
    let (volume, _) = labelled_tube(4);
    let base = folder.path().join("tube.1");
    let written = MeshFamily::of_volume(&volume).first_number(1).write(&base).unwrap();
    let kinds: Vec<_> = written.iter().map(|p| p.extension().unwrap().to_str().unwrap()).collect();
    assert_eq!(kinds, ["node", "face", "edge", "neigh", "ele"]);
    assert!(written[0].ends_with("tube.1.node"));
    let nodes = read_nodes(&written[0]).unwrap();
    assert_eq!((&nodes.points, nodes.first), (&volume.mesh.points, 1));
    for (row, (face, patch)) in rows(&written[1]).iter().zip(volume.boundary.iter().zip(&volume.boundary_patch)) {
        assert_eq!(row[1..4], face.map(|v| i64::from(v) + 1));
        assert_eq!(row[4], i64::from(*patch));
        assert!(face.iter().all(|&v| nodes.markers[v as usize] != 0));
    }
    let interior = nodes.markers.iter().filter(|&&m| m == 0).count();
    let on_boundary: BTreeSet<u32> = volume.boundary.iter().flatten().copied().collect();
    assert_eq!(interior, volume.mesh.points.len() - on_boundary.len());
    for (row, (tet, block)) in rows(&written[4]).iter().zip(volume.mesh.tets.iter().zip(&volume.tet_block)) {
        assert_eq!(row[1..5], tet.map(|v| i64::from(v) + 1));
        assert_eq!(row[5], i64::from(*block));
    }
    // A neighbour shares all corners except the one opposite the face.
    let tets = &volume.mesh.tets;
    for row in rows(&written[3]) {
        for side in 0..4 {
            let tet = tets[row[0] as usize - 1];
            if row[side + 1] > 0 {
                let other = tets[row[side + 1] as usize - 1];
                assert!((0..4).all(|i| other.contains(&tet[i]) == (i != side)));
            }
        }
    }
}

#[test]
fn all_faces_and_edges_of_a_lattice() {
    let folder = tempfile::tempdir().unwrap();
    let mesh = cube_lattice(3);
    let base = folder.path().join("cube.ele");
    let family = MeshFamily::new(&mesh);
    let boundary = family.clone().write(&base).unwrap();
    let outer = (rows(&boundary[1]).len(), rows(&boundary[2]).len());
    assert!(rows(&boundary[1]).iter().chain(&rows(&boundary[2])).all(|row| row.last() == Some(&1)));
    let all = family.faces(Extent::All).edges(Extent::All).neighbors(false).write(&base).unwrap();
    assert_eq!(all.len(), 4);
    assert!(all[0].ends_with("cube.node"));
    let (faces, edges) = (rows(&all[1]), rows(&all[2]));
    let marked = |rows: &[Vec<i64>]| rows.iter().filter(|row| row.last() == Some(&1)).count();
    assert_eq!((marked(&faces), marked(&edges)), outer);
    let open =
        tet_adjacency(&mesh.tets, mesh.points.len()).neighbors.iter().flatten().filter(|&&n| n == u32::MAX).count();
    assert_eq!(outer.0, open);
    // Euler characteristic: the cube is one ball, its boundary one sphere.
    let points = mesh.points.len() as i64;
    assert_eq!(points - edges.len() as i64 + faces.len() as i64 - mesh.tets.len() as i64, 1);
    let keys: BTreeSet<_> = edges.iter().map(|row| (row[1], row[2])).collect();
    assert_eq!(keys.len(), edges.len());
}

#[test]
fn what_is_written_is_read() {
    let folder = tempfile::tempdir().unwrap();
    let (volume, _) = labelled_tube(4);
    for (first, faces) in [(0, Extent::Boundary), (1, Extent::All)] {
        let base = folder.path().join("a.ele");
        MeshFamily::of_volume(&volume).first_number(first).faces(faces).write(&base).unwrap();
        let back = read_mesh(&base).unwrap();
        assert_eq!((&back.mesh, &back.tet_block), (&volume.mesh, &volume.tet_block));
        let rows = |volume: &VolumeMesh| -> BTreeSet<([u32; 3], i32)> {
            volume.boundary.iter().copied().zip(volume.boundary_patch.iter().copied()).collect()
        };
        // Cyclic permutations of corners are allowed.
        let turned = |rows: BTreeSet<([u32; 3], i32)>| -> BTreeSet<([u32; 3], i32)> {
            let least = |[a, b, c]: [u32; 3]| [[a, b, c], [b, c, a], [c, a, b]].into_iter().min().unwrap();
            rows.into_iter().map(|(face, patch)| (least(face), patch)).collect()
        };
        assert_eq!(turned(rows(&back)), turned(rows(&volume)));
    }
    std::fs::remove_file(folder.path().join("a.face")).unwrap();
    assert!(read_mesh(&folder.path().join("a.node")).unwrap().boundary.is_empty());
    let ele = folder.path().join("a.ele");
    let text = std::fs::read_to_string(&ele).unwrap();
    let fault = |from: &str, to: &str| {
        std::fs::write(&ele, text.replacen(from, to, 1)).unwrap();
        let Err(FileError::Content { fault, .. }) = read_mesh(&ele) else { panic!("{from} {to}") };
        fault
    };
    assert_eq!(fault(" 4 1\n", " 10 1\n"), TetgenFault::Order { line: 1, corners: 10 });
    let index = volume.mesh.points.len() as i64 + 1;
    let row = text.lines().nth(1).unwrap();
    let bad = row.rsplitn(3, ' ').last().unwrap().to_owned() + &format!(" {index} 0");
    let fault = fault(row, &bad);
    assert!(matches!(fault, TetgenFault::BadCell { line: 2, cell: 0, index: i, .. } if i == index), "{fault}");
}

#[test]
fn point_attributes_come_first() {
    let folder = tempfile::tempdir().unwrap();
    let mesh = cube_lattice(1);
    let attributes = [0.5, 1.5, 2.5, 3.5];
    let written = MeshFamily::new(&mesh).point_attributes(&attributes, 2).write(&folder.path().join("a")).unwrap();
    let nodes = read_nodes(&written[0]).unwrap();
    assert_eq!(nodes.attribute_count, 2);
    assert_eq!((&nodes.attributes[..4], nodes.attributes[4..].iter().all(|&a| a == 0.0)), (&attributes[..], true));
}

#[test]
fn meshes_that_are_none_are_not_written() {
    let folder = tempfile::tempdir().unwrap();
    let mut mesh = cube_lattice(1);
    mesh.tets[3][2] = 8;
    let written = MeshFamily::new(&mesh).write(&folder.path().join("a.ele"));
    assert!(matches!(written, Err(FileError::BadMesh { cell: 3, .. })));
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    /// Damaged files are read or rejected; meshes from them are valid.
    #[test]
    fn damaged_files_make_no_panic(which in 0..3_usize, damage in damage()) {
        let bytes = damage.done_to([NODE, POLY, SMESH][which].as_bytes());
        if which == 0 {
            if let Ok(nodes) = Nodes::parse(&bytes) {
                prop_assert_eq!(nodes.attributes.len(), nodes.points.len() * nodes.attribute_count);
            }
        } else if let Ok(plc) = Plc::parse(&bytes, [PlcFormat::Poly, PlcFormat::Smesh][which - 1]) {
            let corners = plc.facets.iter().flat_map(|f| f.polygons.iter().flatten());
            prop_assert!(corners.into_iter().all(|&v| (v as usize) < plc.points.len()));
        }
    }
}
