//! Tests of round trips, and of text files written by Gmsh.

use super::error::MshFault;
use super::read::read;
use super::write::write;
use super::write_2::write as write_2;
use crate::volume::content::{MeshFile, MeshNotes};
use crate::volume::fixtures::labelled_tube;
use crate::volume::in_pieces::InPieces;
use anastomesh_mesh::VolumeMesh;
use anastomesh_mesh::beside::{Beside, Column};
use anastomesh_mesh::geometry::Point3;
use anastomesh_mesh::region::{NamedRegion, label_faces};
use anastomesh_mesh::source::MeshSource;
use std::io;

type WriteFn = fn(&mut Vec<u8>, &dyn MeshSource, &MeshNotes) -> io::Result<()>;

/// Both versions.
const WRITERS: [WriteFn; 2] = [
    |out, mesh, notes| write(out, mesh, notes, (None, None)),
    |out, mesh, notes| write_2(out, mesh, notes, (None, None)),
];

#[test]
fn what_is_written_is_read_but_for_the_blocks() {
    let (mut volume, notes) = labelled_tube(5);
    let both = WRITERS.map(|write| {
        let mut bytes = Vec::new();
        write(&mut bytes, &volume, &notes).unwrap();
        bytes
    });
    volume.tet_block.fill(0);
    volume.boundary_block.fill(0);
    for bytes in both {
        let expected = MeshFile { volume: volume.clone(), labelled: true, second_order: None, notes: notes.clone() };
        assert_eq!(read(&bytes).unwrap(), expected);
    }
}

#[test]
fn the_older_version_is_text() {
    let (volume, notes) = labelled_tube(1);
    let mut bytes = Vec::new();
    write_2(&mut bytes, &volume, &notes, (None, None)).unwrap();
    let text = String::from_utf8(bytes).unwrap();
    assert!(text.starts_with("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n"), "{text}");
    let first = text.lines().skip_while(|line| *line != "$Elements").nth(2).unwrap();
    let words: Vec<&str> = first.split(' ').collect();
    assert_eq!((words.len(), &words[..3]), (8, &["1", "2", "2"][..]), "{first}");
    let of = |from: &str, to: &str| read(text.replacen(from, to, 1).as_bytes());
    assert!(matches!(of("2.2 0 8", "2.2 1 8"), Err(MshFault::UnsupportedVersion { .. })));
    assert!(matches!(of("2.2 0 8", "1.0 0 8"), Err(MshFault::UnsupportedVersion { .. })));
    assert!(matches!(of("\n1 2 2 ", "\n1 5 2 "), Err(MshFault::UnsupportedCell { kind: 5, .. })));
    assert!(of("\n1 2 2 ", "\n1 2 99999999999 ").is_err());
}

#[test]
fn regions_become_volumes() {
    let (mut volume, mut notes) = labelled_tube(5);
    notes.regions = [2, 7, 1_000_000].map(NamedRegion::numbered).to_vec();
    for (tet, block) in volume.tet_block.iter_mut().enumerate() {
        *block = [7, 2, 1_000_000][tet % 3];
    }
    let both = WRITERS.map(|write| {
        let mut bytes = Vec::new();
        write(&mut bytes, &volume, &notes).unwrap();
        bytes
    });
    label_faces(&mut volume);
    for bytes in both {
        assert_eq!(
            read(&bytes).unwrap(),
            MeshFile { volume: volume.clone(), labelled: true, second_order: None, notes: notes.clone() }
        );
        let names = String::from_utf8_lossy(&bytes).into_owned();
        assert!(names.contains("3 2 \"region_2\"\n3 7 \"region_7\"\n3 1000000 \"region_1000000\"\n"));
    }
}

#[test]
fn regions_without_a_positive_id_get_free_groups() {
    let (mut volume, mut notes) = labelled_tube(5);
    for (ids, names) in [
        ([-9, 7], ["3 8 \"region_-9\"", "3 7 \"region_7\""]),
        ([0, 7], ["3 8 \"region_0\"", "3 7 \"region_7\""]),
        ([-9, -3], ["3 1 \"region_-9\"", "3 2 \"region_-3\""]),
    ] {
        volume.tet_block.iter_mut().enumerate().for_each(|(tet, block)| *block = ids[tet % 2]);
        notes.regions = NamedRegion::all_numbered(ids);
        for write in WRITERS {
            let mut bytes = Vec::new();
            write(&mut bytes, &volume, &notes).unwrap();
            let file = read(&bytes).unwrap();
            assert_eq!(file.notes.regions, NamedRegion::all_numbered(ids));
            assert_eq!(file.volume.tet_block, volume.tet_block, "{ids:?}");
            let text = String::from_utf8_lossy(&bytes);
            assert!(names.iter().all(|name| text.contains(name)), "{ids:?}");
        }
    }
}

/// Height of each point.
struct PointHeights;

impl Beside for PointHeights {
    fn columns(&self) -> &[Column] {
        const COLUMNS: [Column; 2] = [
            Column { name: "height", at_points: true, is_integer: false },
            Column { name: "middle", at_points: false, is_integer: false },
        ];
        &COLUMNS
    }

    fn at_points(&self, _: usize, points: &[Point3]) -> Vec<f64> {
        points.iter().map(|p| p.z).collect()
    }

    fn in_tets(&self, _: usize, tets: &[[Point3; 4]]) -> Vec<f64> {
        tets.iter().map(|t| t.iter().map(|p| p.z).sum::<f64>() / 4.0).collect()
    }

    fn in_faces(&self, _: usize, faces: &[[Point3; 3]]) -> Vec<f64> {
        faces.iter().map(|t| t.iter().map(|p| p.z).sum::<f64>() / 3.0).collect()
    }
}

/// Tags and values of a data section.
fn rows(bytes: &[u8], section: &str, name: &str, binary: bool) -> Vec<(i32, f64)> {
    let head = format!("${section}\n1\n\"{name}\"\n1\n0.0\n3\n0\n1\n");
    let start = bytes.windows(head.len()).position(|w| w == head.as_bytes()).unwrap() + head.len();
    let line = bytes[start..].iter().position(|&b| b == b'\n').unwrap();
    let count: usize = str::from_utf8(&bytes[start..start + line]).unwrap().parse().unwrap();
    let rest = &bytes[start + line + 1..];
    let end = format!("$End{section}\n");
    if binary {
        assert_eq!(&rest[12 * count..][..=end.len()], format!("\n{end}").as_bytes());
        let row = |row: &[u8; 12]| {
            let (tag, value) = row.split_first_chunk().unwrap();
            (i32::from_le_bytes(*tag), f64::from_le_bytes(value.try_into().unwrap()))
        };
        return rest[..12 * count].as_chunks().0.iter().map(row).collect();
    }
    let lines: Vec<&str> = str::from_utf8(rest).unwrap().lines().take(count + 1).collect();
    assert_eq!(lines[count], end.trim());
    let row = |line: &str| line.split_once(' ').map(|(tag, x)| (tag.parse().unwrap(), x.parse().unwrap())).unwrap();
    lines[..count].iter().map(|line| row(line)).collect()
}

#[test]
fn values_stand_beside_nodes_and_elements() {
    let (volume, mut notes) = labelled_tube(5);
    let mean =
        |points: &[Point3], cell: &[u32]| cell.iter().map(|&v| points[v as usize].z).sum::<f64>() / cell.len() as f64;
    // Patches and notes are as without values; tetrahedra and faces are equal up to order.
    let known = |file: MeshFile| {
        let points = &file.volume.mesh.points;
        let mut tets: Vec<f64> = file.volume.mesh.tets.iter().map(|tet| mean(points, tet)).collect();
        tets.sort_unstable_by(f64::total_cmp);
        let mut faces: Vec<(i32, u64)> = (file.volume.boundary_patch.iter().copied())
            .zip(file.volume.boundary.iter().map(|face| mean(points, face).to_bits()))
            .collect();
        faces.sort_unstable();
        (tets, faces, file.volume.patches, file.notes)
    };
    for (binary, regions) in [(true, false), (true, true), (false, false)] {
        notes.regions = if regions { [0, 1].map(NamedRegion::numbered).to_vec() } else { Vec::new() };
        let bytes_of = |mesh: &dyn MeshSource, values: Option<&dyn Beside>| {
            let mut bytes = Vec::new();
            if binary {
                write(&mut bytes, mesh, &notes, (values, None)).unwrap();
            } else {
                write_2(&mut bytes, mesh, &notes, (values, None)).unwrap();
            }
            bytes
        };
        let bytes = bytes_of(&volume, Some(&PointHeights));
        assert!(bytes == bytes_of(&InPieces { volume: &volume, sizes: &[7] }, Some(&PointHeights)));
        let file = read(&bytes).unwrap();
        let heights = rows(&bytes, "NodeData", "height", binary);
        let points = &file.volume.mesh.points;
        assert!(heights.iter().map(|row| row.0).eq(1..=points.len() as i32));
        assert!(heights.iter().zip(points).all(|(row, p)| row.1.to_bits() == p.z.to_bits()));
        let middles = rows(&bytes, "ElementData", "middle", binary);
        let cells = file.volume.boundary.iter().map(|face| mean(points, face));
        let cells = cells.chain(file.volume.mesh.tets.iter().map(|tet| mean(points, tet)));
        assert!(middles.iter().map(|row| row.1).eq(cells));
        assert!(middles.iter().map(|row| row.0).eq(1..=middles.len() as i32));
        assert!(known(file) == known(read(&bytes_of(&volume, None)).unwrap()), "{binary} {regions}");
    }
}

#[test]
fn an_empty_mesh() {
    for write in WRITERS {
        let mut bytes = Vec::new();
        write(&mut bytes, &VolumeMesh::default(), &MeshNotes::default()).unwrap();
        assert_eq!(read(&bytes).unwrap(), MeshFile::default());
    }
}

#[test]
fn every_cut_is_noticed() {
    let (volume, notes) = labelled_tube(2);
    for write in WRITERS {
        let mut whole = Vec::new();
        write(&mut whole, &volume, &notes).unwrap();
        // After the elements, only data for checks are lost.
        let end = b"$EndElements";
        let end = whole.windows(end.len()).position(|window| window == end).unwrap() + end.len();
        for cut in (0..end).step_by(31).chain([end - 1]) {
            assert!(read(&whole[..cut]).is_err(), "cut at {cut} of {end}");
        }
        assert!(read(&whole[..whole.len() - 2]).is_err());
    }
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
    assert!(matches!(fault(TEXT.replace("4.1 0", "3.0 0")), MshFault::UnsupportedVersion { .. }));
    assert!(matches!(fault(TEXT.replace("3 7 4 1", "3 7 5 1")), MshFault::UnsupportedCell { kind: 5, .. }));
    assert!(matches!(fault(TEXT.replace("\n30\n", "\n10\n")), MshFault::RepeatedTag { tag: 10 }));
    assert!(matches!(fault(TEXT.replace("0 1 0\n3", "0 one 0\n3")), MshFault::BadNumber { .. }));
    assert!(matches!(fault("solid".into()), MshFault::CutShort));
    let dangling = read(TEXT.replace("4 10 20 30 40", "4 10 20 30 99").as_bytes()).unwrap();
    assert_eq!(dangling.volume.mesh.tets, [[0, 1, 2, u32::MAX]]);
}
