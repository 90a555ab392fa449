//! Folders of meshes with regions.

use super::layout::{MESH, SOLVER};
use crate::flow::Flow;
use crate::volume::{MeshNotes, write_mesh};
use crate::vtk_xml::VtkXml;
use anastomesh_mesh::shapes::walled_channel;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

/// Folder of the channel with these names of regions.
fn written(names: [&str; 3], flow: Option<Flow>) -> (tempfile::TempDir, Result<(), String>) {
    let folder = tempfile::tempdir().unwrap();
    let (volume, mut regions) = walled_channel(1);
    regions.iter_mut().zip(names).for_each(|(region, name)| region.name = name.into());
    let notes = MeshNotes { regions, flow, ..MeshNotes::default() };
    let done = write_mesh(&folder.path().join("a.svmesh"), &volume, &notes).map_err(|e| e.to_string());
    (folder, done)
}

/// Points by their numbers, and the values of a cell array.
fn read(path: &Path, kind: &'static str, cells: &str) -> (BTreeMap<i64, [u64; 3]>, Vec<i64>) {
    let bytes = fs::read(path).unwrap();
    let xml = VtkXml::parse(&bytes, kind).unwrap();
    let piece = xml.child(xml.child(VtkXml::ROOT, kind).unwrap(), "Piece").unwrap();
    let array = |section: &str, name: &str| {
        let section = xml.child(piece, section).unwrap();
        let (_, array) = xml.arrays(section).find(|(n, _)| *n == name).unwrap();
        xml.read(array).unwrap()
    };
    let points = array("Points", "Points").into_floats();
    let ids = array("PointData", "GlobalNodeID").into_ints().unwrap();
    let places = points.as_chunks::<3>().0.iter().map(|p| p.map(f64::to_bits));
    (ids.into_iter().zip(places).collect(), array("CellData", cells).into_ints().unwrap())
}

#[test]
fn each_region_is_a_mesh_and_interfaces_share_numbers() {
    let (folder, done) = written(["lumen", "wall", "tissue"], None);
    done.unwrap();
    let path = folder.path().join("a.svmesh");
    let surfaces = |region: &str| -> BTreeSet<String> {
        let entries = fs::read_dir(path.join(region).join("mesh-surfaces")).unwrap();
        entries.map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned()).collect()
    };
    let names = |names: &[&str]| names.iter().map(|name| format!("{name}.vtp")).collect::<BTreeSet<_>>();
    assert_eq!(surfaces("lumen"), names(&["inlet", "outlet_0", "interface_lumen_wall"]));
    let of_wall = ["interface_lumen_wall", "interface_wall_tissue", "ring_inlet", "ring_outlet_0"];
    assert_eq!(surfaces("wall"), names(&of_wall));
    assert_eq!(surfaces("tissue"), names(&["interface_wall_tissue", "organ"]));
    let mut elements = BTreeSet::new();
    for region in ["lumen", "wall", "tissue"] {
        let (nodes, tets) = read(&path.join(region).join(MESH), "UnstructuredGrid", "GlobalElementID");
        let before = elements.len();
        elements.extend(tets.iter().copied());
        assert_eq!(elements.len(), before + tets.len());
        for surface in surfaces(region) {
            let surface = path.join(region).join("mesh-surfaces").join(surface);
            let (points, faces) = read(&surface, "PolyData", "GlobalElementID");
            assert!(points.iter().all(|(node, place)| nodes.get(node) == Some(place)), "{}", surface.display());
            assert!(faces.iter().all(|tet| tets.contains(tet)));
        }
    }
    let interface = |region: &str| {
        let file = path.join(region).join("mesh-surfaces/interface_lumen_wall.vtp");
        read(&file, "PolyData", "ModelFaceID")
    };
    let (fluid, solid) = (interface("lumen"), interface("wall"));
    assert_eq!(fluid, solid);
    assert_eq!((fluid.0.len(), fluid.1.len()), (6 * 4, 40));
}

#[test]
fn the_case_couples_lumen_and_solids() {
    let (folder, done) = written(["lumen", "wall", "tissue"], None);
    done.unwrap();
    let text = fs::read_to_string(folder.path().join("a.svmesh").join(SOLVER)).unwrap();
    let count = |what: &str| text.matches(what).count();
    assert_eq!((count("<Add_mesh "), count("<Add_projection "), count("<Add_equation ")), (3, 2, 2));
    let projection = "<Add_projection name=\"wall_interface_lumen_wall\">\n  <Project_from_face> \
                      lumen_interface_lumen_wall </Project_from_face>";
    assert!(text.contains(projection), "{text}");
    assert_eq!(count("<Equation> struct </Equation>"), 2);
    assert!(text.contains("<Elasticity_modulus> 4e5 </Elasticity_modulus>"), "{text}");
    // Inlet, outlet, two rings and the organ; the mesh stays at inlet and outlet.
    let conditions: Vec<&str> = text.lines().filter_map(|line| line.trim().strip_prefix("<Add_BC name=")).collect();
    let expected = ["lumen_inlet", "lumen_outlet_0", "wall_ring_inlet", "wall_ring_outlet_0", "tissue_organ"];
    let expected = expected.into_iter().chain(["lumen_inlet", "lumen_outlet_0"]);
    assert_eq!(conditions, expected.map(|name| format!("\"{name}\">")).collect::<Vec<_>>());
    // All files and faces that it names exist.
    let faces: BTreeSet<&str> =
        text.lines().filter_map(|line| line.trim().strip_prefix("<Add_face name=\"")?.strip_suffix("\">")).collect();
    assert_eq!(faces.len(), 9);
    for line in text.lines().filter(|line| line.contains("_file_path>")) {
        let path = line.split_whitespace().nth(1).unwrap();
        assert!(folder.path().join("a.svmesh").join(path).exists(), "{path}");
    }
    for name in conditions {
        assert!(faces.contains(name.trim_matches(['"', '>'])), "{name}");
    }
}

#[test]
fn materials_have_the_units_of_the_fluid() {
    // Centimetres, grams and seconds.
    let (folder, done) = written(["lumen", "wall", "tissue"], Some(Flow::new(1.06, 0.04)));
    done.unwrap();
    let text = fs::read_to_string(folder.path().join("a.svmesh").join(SOLVER)).unwrap();
    assert!(text.contains("<Elasticity_modulus> 4e6 </Elasticity_modulus>"), "{text}");
    assert!(text.contains("<Density> 1.1236e0 </Density>"), "{text}");
}

#[test]
fn a_mesh_without_lumen_is_refused() {
    let (folder, done) = written(["blood", "wall", "tissue"], None);
    assert!(done.unwrap_err().contains("no region is named 'lumen'"));
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}
