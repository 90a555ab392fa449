//! What is written can be read again; text as Gmsh writes it is read.

use super::error::MshFault;
use super::read::read;
use super::write::write;
use crate::geometry::Point3;
use crate::io::volume::content::{MeshFile, MeshNotes};
use crate::io::volume::fixtures::labelled_tube;
use crate::mesh::VolumeMesh;

#[test]
fn what_is_written_is_read_but_for_the_blocks() {
    let (mut volume, notes) = labelled_tube(5);
    let mut bytes = Vec::new();
    write(&mut bytes, &volume, &notes).unwrap();
    volume.tet_block.fill(0);
    volume.boundary_block.fill(0);
    assert_eq!(read(&bytes).unwrap(), MeshFile { volume, labelled: true, notes });
}

#[test]
fn regions_become_volumes() {
    let (mut volume, mut notes) = labelled_tube(5);
    notes.regions = true;
    for (tet, block) in volume.tet_block.iter_mut().enumerate() {
        *block = [7, 2, 1_000_000][tet % 3];
    }
    let mut bytes = Vec::new();
    write(&mut bytes, &volume, &notes).unwrap();
    volume.boundary_block.fill(0);
    notes.regions = false;
    assert_eq!(read(&bytes).unwrap(), MeshFile { volume, labelled: true, notes });
    let names = String::from_utf8_lossy(&bytes).into_owned();
    assert!(names.contains("3 2 \"region_2\"\n3 7 \"region_7\"\n3 1000000 \"region_1000000\"\n"));
}

#[test]
fn an_empty_mesh() {
    let mut bytes = Vec::new();
    write(&mut bytes, &VolumeMesh::default(), &MeshNotes::default()).unwrap();
    assert_eq!(read(&bytes).unwrap(), MeshFile::default());
}

#[test]
fn every_cut_is_noticed() {
    let (volume, notes) = labelled_tube(2);
    let mut whole = Vec::new();
    write(&mut whole, &volume, &notes).unwrap();
    // Once the elements are complete only what a check would want to know is lost.
    let end = b"$EndElements";
    let end = whole.windows(end.len()).position(|window| window == end).unwrap() + end.len();
    for cut in (0..end).step_by(31).chain([end - 1]) {
        assert!(read(&whole[..cut]).is_err(), "cut at {cut} of {end}");
    }
    assert!(read(&whole[..whole.len() - 2]).is_err());
}

const TEXT: &str = "$MeshFormat
4.1 0 8
$EndMeshFormat
$Comments
anything at all
$EndComments
$PhysicalNames
2
2 4 \"outlet_1\"
3 9 \"lumen\"
$EndPhysicalNames
$Entities
1 1 1 1
1 0 0 0 0
2 0 0 0 1 0 0 0 2 1 1
3 0 0 0 1 1 0 1 4 0
7 0 0 0 1 1 1 1 9 1 3
$EndEntities
$Nodes
2 4 10 40
2 3 0 3
20
10
30
1 0 0
0 0 0
0 1 0
3 7 0 1
40
0 0 1
$EndNodes
$Elements
4 4 1 4
0 1 15 1
1 10
1 2 1 1
2 10 20
2 3 2 1
3 10 30 20
3 7 4 1
4 10 20 30 40
$EndElements
";

#[test]
fn text_with_tags_in_any_order() {
    let file = read(TEXT.as_bytes()).unwrap();
    assert_eq!(file.volume.mesh.points[1], Point3::new(1.0, 0.0, 0.0));
    assert_eq!(file.volume.mesh.tets, [[0, 1, 2, 3]]);
    assert_eq!((file.volume.boundary, file.volume.boundary_patch), (vec![[0, 2, 1]], vec![4]));
    assert_eq!(file.volume.patches[0].name, "outlet_1");
    assert!(file.labelled);
}

#[test]
fn what_is_not_supported_is_named() {
    let fault = |text: String| read(text.as_bytes()).unwrap_err();
    assert!(matches!(fault(TEXT.replace("4.1 0", "2.2 0")), MshFault::UnsupportedVersion { .. }));
    assert!(matches!(fault(TEXT.replace("3 7 4 1", "3 7 5 1")), MshFault::UnsupportedCell { kind: 5, .. }));
    assert!(matches!(fault(TEXT.replace("\n30\n", "\n10\n")), MshFault::RepeatedTag { tag: 10 }));
    assert!(matches!(fault(TEXT.replace("0 1 0\n3", "0 one 0\n3")), MshFault::BadNumber { .. }));
    assert!(matches!(fault("solid".into()), MshFault::CutShort));
    let dangling = read(TEXT.replace("4 10 20 30 40", "4 10 20 30 99").as_bytes()).unwrap();
    assert_eq!(dangling.volume.mesh.tets, [[0, 1, 2, u32::MAX]]);
}
