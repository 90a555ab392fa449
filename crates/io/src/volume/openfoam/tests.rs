use super::*;
use crate::volume::fixtures::labelled_tube;
use crate::volume::in_pieces::InPieces;
use crate::volume::write_mesh;
use anastomesh_mesh::{TET_FACES, VolumeMesh, face_key};
use std::fs;

/// Lists of a binary file, as words.
pub(super) fn lists(path: &Path) -> Vec<Vec<u32>> {
    let bytes = fs::read(path).unwrap();
    let mut at = bytes.windows(3).position(|w| w == b"}\n\n").unwrap() + 3;
    let mut lists = Vec::new();
    while at < bytes.len() {
        let open = at + bytes[at..].iter().position(|&b| b == b'(').unwrap();
        let count: usize = std::str::from_utf8(&bytes[at..open]).unwrap().trim().parse().unwrap();
        let end = open + 1 + 4 * count;
        lists.push(bytes[open + 1..end].chunks(4).map(|w| u32::from_le_bytes(w.try_into().unwrap())).collect());
        assert_eq!(&bytes[end..end + 2], b")\n");
        at = end + 2;
    }
    lists
}

/// Type, number of faces and first face of each patch.
fn patches(path: &Path) -> Vec<(String, String, usize, usize)> {
    let text = fs::read_to_string(path).unwrap();
    let entries = text.lines().filter(|line| line.contains("startFace"));
    let value = |line: &str, key: &str| {
        let rest = line.split_once(key).unwrap().1.trim();
        rest.split_once(';').unwrap().0.to_owned()
    };
    let patch = |line: &str| {
        let number = |key| value(line, key).parse().unwrap();
        (line.split_whitespace().next().unwrap().into(), value(line, "type"), number("nFaces"), number("startFace"))
    };
    entries.map(patch).collect()
}

fn written(mesh: &dyn MeshSource, notes: &MeshNotes) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    write_mesh(&folder.path().join("a.foam"), mesh, notes).unwrap();
    folder
}

#[test]
fn faces_are_in_upper_triangular_order_and_patches_bunched() {
    let (volume, notes) = labelled_tube(7);
    let folder = written(&volume, &notes);
    let mesh = folder.path().join("a.foam/constant/polyMesh");
    let [faces, owner, neighbour] = ["faces", "owner", "neighbour"].map(|name| lists(&mesh.join(name)));
    let (starts, corners) = (&faces[0], &faces[1]);
    let (owner, neighbour) = (&owner[0], &neighbour[0]);
    let outer = volume.boundary.len();
    assert_eq!((owner.len(), 2 * neighbour.len() + outer), (neighbour.len() + outer, 4 * volume.mesh.tets.len()));
    assert!(starts.iter().zip(0..).all(|(&start, i)| start == 3 * i) && starts.len() == owner.len() + 1);
    let cells: Vec<(u32, u32)> = owner.iter().copied().zip(neighbour.iter().copied()).collect();
    assert!(cells.is_sorted() && cells.iter().all(|(a, b)| a < b));
    // Each face belongs to its owner and is oriented outwards.
    let (faces, _) = corners.as_chunks::<3>();
    let of = |cell: u32| TET_FACES.map(|side| side.map(|corner| volume.mesh.tets[cell as usize][corner]));
    assert!(faces.iter().zip(owner).all(|(face, &cell)| of(cell).contains(face)));
    let found = patches(&mesh.join("boundary"));
    let count = |id| volume.boundary_patch.iter().filter(|&&patch| patch == id).count();
    let (inner, wall) = (neighbour.len(), count(1));
    let expected = [("wall", "wall", wall, inner), ("outlet_0", "patch", count(3), inner + wall)];
    let expected: Vec<_> =
        expected.iter().map(|&(name, kind, n, first)| (name.into(), kind.into(), n, first)).collect();
    assert_eq!(found, expected);
    let mut labelled: Vec<_> =
        volume.boundary.iter().zip(&volume.boundary_patch).map(|(&f, &p)| (p, face_key(f))).collect();
    let of_patch = |(face, place): (&[u32; 3], usize)| (if place < inner + wall { 1 } else { 3 }, face_key(*face));
    let mut placed: Vec<_> = faces[inner..].iter().zip(inner..).map(of_patch).collect();
    labelled.sort_unstable();
    placed.sort_unstable();
    assert_eq!(placed, labelled);
}

#[test]
fn pieces_make_no_difference() {
    let (volume, notes) = labelled_tube(9);
    let whole = written(&volume, &notes);
    for sizes in [vec![1], vec![7, 30], vec![1000]] {
        let cut = written(&InPieces { volume: &volume, sizes: &sizes }, &notes);
        // Settings follow the figures of the faces inside parts.
        let texts = TEXTS.map(|(name, _)| name).into_iter().filter(|name| !name.starts_with("system/fv"));
        for name in poly_mesh::FILES.into_iter().chain(texts) {
            let read = |folder: &tempfile::TempDir| fs::read(folder.path().join("a.foam").join(name)).unwrap();
            assert!(read(&cut) == read(&whole), "{name} {sizes:?}");
        }
    }
}

#[test]
fn names_are_words_and_patches_without_a_name_have_their_own() {
    let (mut volume, notes) = labelled_tube(3);
    volume.patches[1].name = "outlet {left} 1".into();
    volume.boundary_patch[0] = 77;
    let folder = written(&volume, &notes);
    let names: Vec<String> =
        patches(&folder.path().join("a.foam/constant/polyMesh/boundary")).into_iter().map(|patch| patch.0).collect();
    assert_eq!(names, ["wall", "outlet__left__1", "outlet_74"]);
}

#[test]
fn results_are_not_removed_and_nothing_is_left_of_a_mesh_without_labels() {
    let (volume, notes) = labelled_tube(3);
    let folder = written(&volume, &notes);
    let path = folder.path().join("a.foam");
    fs::create_dir(path.join("83")).unwrap();
    fs::write(path.join("83/U"), "").unwrap();
    assert!(write_mesh(&path, &volume, &notes).unwrap_err().to_string().contains("also holds 83/U"));
    let bare = VolumeMesh { mesh: volume.mesh, ..VolumeMesh::default() };
    let error = write_mesh(&folder.path().join("b.foam"), &bare, &notes).unwrap_err().to_string();
    assert!(error.contains("has a tetrahedron or a patch on one side and nothing on the other"), "{error}");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
}
