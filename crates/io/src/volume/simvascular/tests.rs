use super::layout::{EXTERIOR, MESH};
use super::sheet::{Sheet, WideSheet, used};
use super::*;
use crate::volume::fixtures::labelled_tube;
use crate::volume::in_pieces::InPieces;
use crate::volume::{read_mesh, write_mesh};
use anastomesh_mesh::faces::OuterFace;
use std::fs;

fn files(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let own = |folder: &Path| -> Vec<(String, Vec<u8>)> {
        let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).filter(|path| path.is_file());
        entries.map(|path| (path.file_name().unwrap().to_string_lossy().into(), fs::read(path).unwrap())).collect()
    };
    let mut all = own(folder);
    all.extend(own(&folder.join("mesh-surfaces")));
    all.sort();
    all
}

#[test]
fn pieces_make_no_difference_and_tetrahedra_are_alone() {
    let folder = tempfile::tempdir().unwrap();
    let (volume, notes) = labelled_tube(9);
    let path = |name: &str| folder.path().join(name);
    write_mesh(&path("whole.svmesh"), &volume, &notes).unwrap();
    let whole = files(&path("whole.svmesh"));
    let names: Vec<&str> = whole.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names, [EXTERIOR, MESH, "outlet_0.vtp", SOLVER, "wall.vtp", WALLS]);
    for sizes in [vec![1], vec![7, 30]] {
        write_mesh(&path("cut.svmesh"), &InPieces { volume: &volume, sizes: &sizes }, &notes).unwrap();
        assert!(files(&path("cut.svmesh")) == whole, "{sizes:?}");
    }
    let read = read_mesh(&path("whole.svmesh").join(MESH)).unwrap();
    assert_eq!((&read.volume.mesh, read.labelled), (&volume.mesh, false));
    assert!(read_mesh(&path("whole.svmesh")).unwrap_err().to_string().contains("written but not read"));
}

#[test]
fn faces_come_back_from_the_spool_with_their_tetrahedra() {
    let (volume, _) = labelled_tube(30);
    let folder = tempfile::tempdir().unwrap();
    let spool = Spool::of(&volume, &folder.path().join("x"), &()).unwrap();
    for _ in 0..2 {
        let mut all = Vec::new();
        spool
            .each(|faces| {
                all.extend_from_slice(faces);
                Ok(())
            })
            .unwrap();
        assert_eq!(all.len(), volume.boundary.len());
        let has = |face: &OuterFace| face.vertices.iter().all(|v| volume.mesh.tets[face.tet as usize].contains(v));
        assert!(all.iter().all(has));
    }
}

#[test]
fn a_cap_has_the_points_of_its_faces_by_their_numbers_in_the_mesh() {
    let (volume, _) = labelled_tube(3);
    let folder = tempfile::tempdir().unwrap();
    let spool = Spool::of(&volume, &folder.path().join("x"), &()).unwrap();
    let faces = &caps(&spool, |patch| patch != WALL).unwrap()[&3];
    let cap = CapSheet::new(&volume, CellNodes::default(), faces).unwrap();
    let (used, count) =
        used(volume.mesh.points.len(), CellNodes::default(), &spool, &|face: &OuterFace| face.patch == 3).unwrap();
    let wide = WideSheet {
        mesh: &volume,
        nodes: CellNodes::default(),
        spool: &spool,
        has: &|f: &OuterFace| f.patch == 3,
        used: &used,
        ranks: used.ranks(),
        faces: count,
    };
    // Held and multi-pass surfaces are equal.
    let bytes = |sheet: &dyn Sheet| {
        let mut bytes = Cursor::new(Vec::new());
        write_sheet(&mut bytes, sheet, &Numbers::default()).unwrap();
        bytes.into_inner()
    };
    assert!(bytes(&cap) == bytes(&wide));
    cap.each_ids(&mut |ids| {
        assert_eq!(ids, used.ids());
        assert!(ids.iter().zip(0..).all(|(&id, own)| cap.own_number(id) == own && wide.own_number(id) == own));
        Ok(())
    })
    .unwrap();
}
