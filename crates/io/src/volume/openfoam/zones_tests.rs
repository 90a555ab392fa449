//! Cases of meshes with regions.

use super::tests::lists;
use super::zones::{CELL_ZONES, FACE_ZONES};
use crate::volume::in_pieces::InPieces;
use crate::volume::{MeshNotes, write_mesh};
use anastomesh_mesh::VolumeMesh;
use anastomesh_mesh::geometry::Point3;
use anastomesh_mesh::region::NamedRegion;
use anastomesh_mesh::shapes::walled_channel;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

fn channel() -> (VolumeMesh, MeshNotes) {
    let (volume, regions) = walled_channel(1);
    (volume, MeshNotes { regions, ..MeshNotes::default() })
}

/// Lists of numbers of each zone.
fn zones(path: &Path) -> BTreeMap<String, Vec<Vec<usize>>> {
    let text = fs::read_to_string(path).unwrap();
    let body = text.split_once("}\n\n").unwrap().1;
    let (count, rest) = body.split_once("\n(\n").unwrap();
    let mut zones = BTreeMap::new();
    for zone in rest.split("}\n").filter(|zone| zone.contains('{')) {
        let (name, entries) = zone.split_once("\n{").unwrap();
        let lists = entries.split("List<").skip(1).map(|list| {
            let (head, numbers) = list.split_once("(\n").unwrap();
            let numbers: Vec<usize> =
                numbers.split_once(')').unwrap().0.split_whitespace().map(|n| n.parse().unwrap()).collect();
            assert_eq!(head.split_once(">\n").unwrap().1.trim().parse(), Ok(numbers.len()));
            numbers
        });
        zones.insert(name.trim().to_owned(), lists.collect());
    }
    assert_eq!(count.trim().parse(), Ok(zones.len()));
    zones
}

#[test]
fn interfaces_are_inner_faces_in_zones() {
    let (volume, notes) = channel();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.foam");
    write_mesh(&path, &volume, &notes).unwrap();
    let cells = zones(&path.join(CELL_ZONES));
    for region in &notes.regions {
        let expected: Vec<usize> = (0..volume.mesh.tets.len()).filter(|&i| volume.tet_block[i] == region.id).collect();
        assert_eq!(cells[&region.name], [expected], "{}", region.name);
    }
    let mesh = path.join("constant/polyMesh");
    let [faces, owner, neighbour] = ["faces", "owner", "neighbour"].map(|name| lists(&mesh.join(name)));
    let (corners, owner, neighbour) = (faces[1].as_chunks::<3>().0, &owner[0], &neighbour[0]);
    let centre = |face: usize| {
        let at = |v: u32| volume.mesh.points[v as usize].coords;
        Point3::from(corners[face].map(at).into_iter().sum::<anastomesh_mesh::Vec3>() / 3.0)
    };
    let interfaces = zones(&path.join(FACE_ZONES));
    let sizes: Vec<(&str, usize)> = interfaces.iter().map(|(name, lists)| (name.as_str(), lists[0].len())).collect();
    assert_eq!(sizes, [("interface_wall_tissue", 120)]);
    for (lists, [inner, outer]) in interfaces.values().zip([[2, 3]]) {
        for (&face, &flip) in lists[0].iter().zip(&lists[1]) {
            let sides = [owner[face], neighbour[face]].map(|cell| volume.tet_block[cell as usize]);
            assert_eq!(sides, if flip == 0 { [inner, outer] } else { [outer, inner] });
            // Faces are oriented out of their owner.
            let [a, b, c] = corners[face].map(|v| volume.mesh.points[v as usize]);
            let from_axis = centre(face) - Point3::new(0.5, 0.5, centre(face).z);
            assert_eq!((b - a).cross(&(c - a)).dot(&from_axis) > 0.0, flip == 0);
        }
    }
    let text = fs::read_to_string(mesh.join("boundary")).unwrap();
    let patches = ["inlet", "outlet_0", "ring_inlet", "ring_outlet_0", "organ"];
    assert!(patches.iter().all(|name| text.contains(&format!("    {name} {{ type "))), "{text}");
    assert!(!text.contains("interface_"), "{text}");
    for (own, region, other) in
        [("lumen_to_wall", "wall", "wall_to_lumen"), ("wall_to_lumen", "lumen", "lumen_to_wall")]
    {
        let line = text.lines().find(|line| line.starts_with(&format!("    {own} "))).unwrap();
        assert!(line.contains("type mappedWall;") && line.contains("nFaces 40;"), "{line}");
        assert!(line.contains(&format!("sampleRegion {region}; samplePatch {other};")), "{line}");
    }
}

#[test]
fn the_case_is_one_of_diffusion() {
    let (volume, mut notes) = channel();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.foam");
    let text = |name: &str| fs::read_to_string(path.join(name)).unwrap();
    write_mesh(&path, &InPieces { volume: &volume, sizes: &[7, 100] }, &notes).unwrap();
    assert!(text("system/controlDict").contains("application     laplacianFoam;"));
    let concentration = text("0/T");
    assert!(concentration.contains("    ring_inlet\n    {\n        type zeroGradient;"), "{concentration}");
    for side in ["lumen_to_wall", "wall_to_lumen"] {
        let fixed = format!("    {side}\n    {{\n        type fixedValue;\n        value uniform 1;");
        assert!(concentration.contains(&fixed), "{concentration}");
    }
    assert!(concentration.contains("    organ\n    {\n        type fixedValue;"), "{concentration}");
    let before = fs::read(path.join(CELL_ZONES)).unwrap();
    // Written again over itself, in one piece.
    notes.regions[0] = NamedRegion::new(1, "blood");
    write_mesh(&path, &volume, &notes).unwrap();
    let after = String::from_utf8(fs::read(path.join(CELL_ZONES)).unwrap()).unwrap();
    assert_eq!(String::from_utf8(before).unwrap().replace("\nlumen\n", "\nblood\n"), after);
    assert!(!text("constant/polyMesh/boundary").contains("lumen"));
    // Flow has other files, which are no longer there.
    write_mesh(&path, &volume, &MeshNotes::default()).unwrap_err();
    assert!(!path.join("0/U").exists());
}
