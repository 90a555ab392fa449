//! Tests of round trips, of files of other programs, and of damaged files.

use super::error::MeditFault;
use super::read::read;
use crate::damage::damage;
use crate::text::TextFault;
use crate::volume::fixtures::labelled_tube;
use crate::volume::{MeshNotes, read_mesh, write_mesh};
use proptest::prelude::*;

const MESH: &str = "MeshVersionFormatted 1\n\nDimension\n3\n# by hand\nVertices 4\n0 0 0 1\n1 0 0 1\n0 1 0 1\n0 0 1 1\n\
    Edges\n1\n1 2 5\nTriangles\n2\n1 3 2 1\n1 2 4 3\nHexahedra\n0\nRequiredVertices 1 1\nTetrahedra 1\n1 2 3 4 9\nEnd\n";

#[test]
fn what_is_written_is_read_but_for_the_blocks_of_the_boundary() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("tube.mesh");
    let (mut volume, _) = labelled_tube(5);
    write_mesh(&path, &volume, &MeshNotes::default()).unwrap();
    let back = read_mesh(&path).unwrap().volume;
    volume.boundary_block.fill(0);
    volume.patches.clone_from(&back.patches);
    assert_eq!(back, volume);
}

#[test]
fn by_hand() {
    let volume = read(MESH.as_bytes()).unwrap().volume;
    assert_eq!((volume.mesh.tets, volume.tet_block), (vec![[0, 1, 2, 3]], vec![9]));
    assert_eq!((volume.boundary, volume.boundary_patch), (vec![[0, 2, 1], [0, 1, 3]], vec![1, 3]));
    let names: Vec<_> = volume.patches.iter().map(|p| (p.id, p.name.as_str())).collect();
    assert_eq!(names, [(1, "wall"), (3, "outlet_0")]);
    let fault = |from: &str, to: &str| read(MESH.replacen(from, to, 1).as_bytes()).unwrap_err();
    let bad = |index| MeditFault::BadIndex { kind: "Tetrahedra", cell: 0, index, points: 4 };
    assert_eq!(fault("1 2 3 4 9", "1 2 3 5 9"), bad(5));
    assert_eq!(fault("1 2 3 4 9", "0 2 3 4 9"), bad(0));
    assert_eq!(fault("\n3\n", "\n2\n"), MeditFault::Dimension { line: 4, dimension: 2 });
    assert!(matches!(fault("Hexahedra\n0", "Hexahedra\n1 2"), MeditFault::UnsupportedCells { line: 18, .. }));
    assert!(matches!(fault("Tetrahedra 1", "Tetrahedra 99"), MeditFault::Text(TextFault::CountTooLarge { .. })));
    assert!(matches!(fault("Tetrahedra 1\n1 2 3 4 9", ""), MeditFault::Missing { what: "Tetrahedra" }));
    assert!(matches!(fault("Edges", "Triangles 0 Triangles"), MeditFault::Repeated { line: 11, .. }));
    assert!(matches!(fault("MeshVersionFormatted", "OFF"), MeditFault::NotMedit { line: 1, .. }));
    assert!(matches!(fault("Vertices 4", "Vertices 3"), MeditFault::Text(TextFault::Surplus { line: 10 })));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    /// Damaged files are read or rejected; meshes from them are valid.
    #[test]
    fn damaged_files_make_no_panic(damage in damage()) {
        if let Ok(file) = read(&damage.done_to(MESH.as_bytes())) {
            let volume = file.volume;
            let points = volume.mesh.points.len();
            prop_assert!(volume.mesh.tets.iter().flatten().all(|&v| (v as usize) < points));
            prop_assert!(volume.boundary.iter().flatten().all(|&v| (v as usize) < points));
        }
    }
}
