//! Tests of the folders of processors.

use super::tests::lists;
use super::*;
use crate::volume::fixtures::{labelled_tube, slab};
use crate::volume::in_pieces::InPieces;
use crate::volume::{MeshFileError, WriteOptions, write_mesh_with};
use anastomesh_mesh::VolumeMesh;
use std::collections::HashMap;
use std::fs;

fn written(mesh: &dyn MeshSource, notes: &MeshNotes, parts: usize) -> Result<tempfile::TempDir, MeshFileError> {
    let folder = tempfile::tempdir().unwrap();
    let options = WriteOptions::default().parts(NonZeroUsize::new(parts));
    write_mesh_with(&options, &folder.path().join("a.foam"), mesh, notes, &())?;
    Ok(folder)
}

/// Mesh of a folder.
struct Mesh {
    points: Vec<[u64; 3]>,
    faces: Vec<Vec<u32>>,
    owner: Vec<u32>,
    neighbour: Vec<u32>,
    /// Name, first face and number of faces.
    patches: Vec<(String, usize, usize)>,
}

fn mesh_of(folder: &Path) -> Mesh {
    let list = |name: &str| lists(&folder.join(name));
    let [starts, corners] = <[_; 2]>::try_from(list("faces")).unwrap();
    let bytes = fs::read(folder.join("points")).unwrap();
    let open = bytes.iter().position(|&b| b == b'(').unwrap() + 1;
    let (words, _) = bytes[open..bytes.len() - 2].as_chunks::<8>();
    let (points, _) = words.as_chunks::<3>();
    let text = fs::read_to_string(folder.join("boundary")).unwrap();
    let number = |line: &str, key: &str| {
        line.split_once(key).unwrap().1.trim().split(';').next().unwrap().trim().parse().unwrap()
    };
    let patch = |line: &str| {
        let name = line.split_whitespace().next().unwrap().to_owned();
        (name, number(line, "startFace"), number(line, "nFaces"))
    };
    Mesh {
        points: points.iter().map(|p| p.map(u64::from_le_bytes)).collect(),
        faces: starts.windows(2).map(|two| corners[two[0] as usize..two[1] as usize].to_vec()).collect(),
        owner: list("owner").remove(0),
        neighbour: list("neighbour").remove(0),
        patches: text.lines().filter(|line| line.contains("startFace")).map(patch).collect(),
    }
}

/// Checks all folders of processors against the undivided mesh. Returns the number of faces between them.
fn check(case: &Path, parts: usize) -> usize {
    let whole = mesh_of(&case.join("constant/polyMesh"));
    let mut seen_cells = vec![0; 1 + *whole.owner.iter().max().unwrap() as usize];
    let mut seen_faces = vec![0; whole.faces.len()];
    let mut sides: HashMap<(String, usize), Vec<[u64; 3]>> = HashMap::new();
    for part in 0..parts {
        let folder = case.join(format!("processor{part}/constant/polyMesh"));
        let own = mesh_of(&folder);
        let [cells, points, faces, patches] = ["cell", "point", "face", "boundary"]
            .map(|name| lists(&folder.join(format!("{name}ProcAddressing"))).remove(0));
        for (&id, point) in points.iter().zip(&own.points) {
            assert_eq!(whole.points[id as usize], *point);
        }
        assert!(cells.is_sorted() && points.is_sorted() && points.len() == own.points.len());
        for cell in &cells {
            seen_cells[*cell as usize] += 1;
        }
        let inner: Vec<_> = own.owner.iter().zip(&own.neighbour).collect();
        assert!(inner.is_sorted() && inner.iter().all(|(a, b)| a < b), "upper-triangular");
        let names: Vec<&str> = own.patches.iter().map(|patch| &*patch.0).collect();
        let global: Vec<&str> = whole.patches.iter().map(|patch| &*patch.0).collect();
        assert!(names.starts_with(&global), "{names:?}");
        assert_eq!(patches.len(), names.len());
        assert_eq!(patches[..global.len()], (0..global.len() as u32).collect::<Vec<_>>());
        assert!(patches[global.len()..].iter().all(|&patch| patch == u32::MAX));
        let mut next = own.neighbour.len();
        for (index, (name, first, count)) in own.patches.iter().enumerate() {
            assert_eq!(*first, next);
            next += count;
            if index >= global.len() {
                let places = own.faces[*first..next].iter().flatten().map(|&v| own.points[v as usize]).collect();
                sides.insert((name.replace("procBoundary", ""), *count), places);
            }
        }
        assert_eq!(next, own.faces.len());
        for (i, address) in faces.iter().map(|address| address.cast_signed()).enumerate() {
            let number = address.unsigned_abs() as usize - 1;
            // Faces between processors are on both sides.
            seen_faces[number] += if own.patches.get(global.len()).is_some_and(|patch| i >= patch.1) { 1 } else { 2 };
            // The first vertex stays.
            let mut face: Vec<u32> = own.faces[i].iter().map(|&v| points[v as usize]).collect();
            if address < 0 {
                face[1..].reverse();
            }
            assert_eq!(face, whole.faces[number]);
            let cell = cells[own.owner[i] as usize];
            assert_eq!(cell, if address < 0 { whole.neighbour[number] } else { whole.owner[number] });
            if let Some(&other) = own.neighbour.get(i) {
                assert_eq!(cells[other as usize], whole.neighbour[number]);
            }
        }
        assert!(case.join(format!("processor{part}/0/U")).exists());
    }
    assert!(seen_cells.iter().all(|&count| count == 1) && seen_faces.iter().all(|&count| count == 2));
    let mut between = 0;
    for ((name, count), places) in &sides {
        let (a, b) = name.split_once("to").unwrap();
        let other = &sides[&(format!("{b}to{a}"), *count)];
        // The faces of both sides are in one order, with opposite orientations.
        let corners = places.len() / count;
        for (one, two) in places.chunks(corners).zip(other.chunks(corners)) {
            assert_eq!(one[0], two[0]);
            assert!(one[1..].iter().eq(two[1..].iter().rev()) || places.len() % count != 0);
        }
        between += count;
    }
    between / 2
}

#[test]
fn processors_share_faces_in_one_order() {
    let (volume, notes) = labelled_tube(9);
    for parts in [1, 2, 5, 16] {
        let folder = written(&volume, &notes, parts).unwrap();
        let case = folder.path().join("a.foam");
        let between = check(&case, parts);
        assert_eq!(between > 0, parts > 1);
        let text = fs::read_to_string(case.join("system/decomposeParDict")).unwrap();
        assert!(text.contains(&format!("numberOfSubdomains {parts};")));
        assert!(fs::read_to_string(case.join("processor0/0/p")).unwrap().contains("procBoundary.*"));
    }
}

#[test]
fn a_source_in_pieces_gives_sound_processors() {
    let (volume, notes) = labelled_tube(9);
    let folder = written(&InPieces { volume: &volume, sizes: &[7, 100] }, &notes, 4).unwrap();
    check(&folder.path().join("a.foam"), 4);
}

#[test]
fn prisms_stay_whole() {
    let folder = written(&slab(), &MeshNotes::default(), 2).unwrap();
    assert!(check(&folder.path().join("a.foam"), 2) > 0);
}

#[test]
fn bad_requests_write_nothing() {
    let (volume, notes) = labelled_tube(1);
    let error = written(&volume, &notes, 1_000_000).unwrap_err().to_string();
    assert!(error.contains("1000000 parts need at least 1000000 cells, and the mesh has "), "{error}");
    let regions = vec![anastomesh_mesh::NamedRegion::new(1, "lumen")];
    let error = written(&volume, &MeshNotes { regions, ..notes.clone() }, 2).unwrap_err().to_string();
    assert!(error.contains("regions of an OpenFOAM case cannot be written in parts"), "{error}");
    let folder = tempfile::tempdir().unwrap();
    let options = WriteOptions::default().parts(NonZeroUsize::new(2));
    let error = write_mesh_with(&options, &folder.path().join("a.vtu"), &volume, &notes, &()).unwrap_err().to_string();
    assert!(error.contains("this format has no parts; use .foam, .pvtu or .msh"), "{error}");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[test]
fn a_case_in_parts_replaces_another() {
    let folder = written(&slab(), &MeshNotes::default(), 4).unwrap();
    let path = folder.path().join("a.foam");
    let volume: VolumeMesh = slab();
    let options = WriteOptions::default().parts(NonZeroUsize::new(2));
    write_mesh_with(&options, &path, &volume, &MeshNotes::default(), &()).unwrap();
    assert!(path.join("processor1").exists() && !path.join("processor2").exists());
    // Results are kept.
    fs::create_dir_all(path.join("processor1/100")).unwrap();
    fs::write(path.join("processor1/100/U"), "").unwrap();
    assert!(write_mesh_with(&options, &path, &volume, &MeshNotes::default(), &()).is_err());
}
