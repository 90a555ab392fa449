use super::error::VtkLegacyError;
use super::read;
use crate::network::content::{NetworkFile, NetworkNote, NetworkOptions};
use crate::text::Place;

const TEXT: &str = include_str!("../../../../../fixtures/networks/fork_2.vtk");
const BINARY: &[u8] = include_bytes!("../../../../../fixtures/networks/fork_51.vtk");

fn text(text: &str) -> Result<NetworkFile, VtkLegacyError> {
    read(text.as_bytes(), &NetworkOptions::default())
}

fn replaced(from: &str, to: &str) -> VtkLegacyError {
    assert!(TEXT.contains(from), "{from}");
    text(&TEXT.replacen(from, to, 1)).unwrap_err()
}

#[test]
fn cells_that_are_no_lines_are_told() {
    let grid = text(TEXT).unwrap();
    assert_eq!((grid.skeleton.nodes.len(), grid.skeleton.edges.len()), (4, 3));
    assert!(grid.notes.contains(&NetworkNote::OtherCells { count: 2 }), "{:?}", grid.notes);
    assert!(grid.notes.contains(&NetworkNote::NodeRadii { array: "Radius of vessel".into() }));
    let poly = read(BINARY, &NetworkOptions::default()).unwrap();
    assert!(poly.notes.contains(&NetworkNote::OtherCells { count: 1 }));
    assert!(poly.notes.contains(&NetworkNote::Halved { array: "diameter".into() }));
}

#[test]
fn radii_of_cells_run_over_all_cells() {
    let order = NetworkOptions { radius_array: Some("order".into()), ..NetworkOptions::default() };
    let network = read(TEXT.as_bytes(), &order).unwrap();
    assert_eq!(network.skeleton.edges.iter().map(|e| e.radii[0]).collect::<Vec<_>>(), [1.0, 1.0, 2.0]);
}

#[test]
fn faults_have_their_line() {
    assert_eq!(text("vtk").unwrap_err(), VtkLegacyError::NotVtk);
    assert!(matches!(replaced("ASCII", "EBCDIC"), VtkLegacyError::UnknownEncoding { .. }));
    assert!(matches!(replaced("UNSTRUCTURED_GRID", "STRUCTURED_POINTS"), VtkLegacyError::WrongDataset { .. }));
    assert!(matches!(replaced("POINTS 4", "POINTS four"), VtkLegacyError::BadKeyword { place: Place::Line(5), .. }));
    assert!(matches!(replaced("POINTS 4", "POINTS 5"), VtkLegacyError::UnknownKeyword { place: Place::Line(10), .. }));
    assert!(matches!(
        replaced("POINTS 4", "POINTS 99999999999999999"),
        VtkLegacyError::CutShort { place: Place::Line(6), .. }
    ));
    assert!(matches!(
        replaced("0 5 20", "0 five 20"),
        VtkLegacyError::NotANumber { place: Place::Line(7), index: 7, .. }
    ));
    assert!(matches!(replaced("float", "gauge"), VtkLegacyError::UnknownType { .. }));
    assert!(matches!(replaced("2 1\n3", "2 1\n4"), VtkLegacyError::UnknownPoint { line: 2, point: 4, points: 4 }));
    assert!(matches!(replaced("2 1\n3", "2 1\n-1"), VtkLegacyError::UnknownPoint { point: -1, .. }));
    assert!(matches!(replaced("CELLS 4 13", "CELLS 9 13"), VtkLegacyError::BadCells { list: "CELLS", cell: 4, .. }));
    assert!(matches!(replaced("VECTORS", "VICTORS"), VtkLegacyError::UnknownKeyword { place: Place::Line(25), .. }));
    assert!(matches!(replaced("POINT_DATA 4", "POINT_DATA 3"), VtkLegacyError::UnknownKeyword { .. }));
    assert!(matches!(replaced("Radius", "Width"), VtkLegacyError::Radius(_)));
    assert!(matches!(replaced("1\n4\n3\n5", "1\n1\n1\n1"), VtkLegacyError::NoLines { others: 4 }));
}

#[test]
fn a_binary_file_that_is_cut_has_its_byte() {
    let whole = read(BINARY, &NetworkOptions::default()).unwrap();
    for cut in 0..BINARY.len() {
        match read(&BINARY[..cut], &NetworkOptions::default()) {
            // The last byte is a line break.
            Ok(network) => assert!(cut == BINARY.len() - 1 && network == whole, "{cut}"),
            Err(VtkLegacyError::CutShort { place, .. }) => {
                assert!(matches!(place, Place::Byte(b) if b <= cut), "{cut}");
            }
            Err(_) => {}
        }
    }
}

#[test]
fn groups_are_those_of_the_cells_that_are_lines() {
    let arrays = "SCALARS GroupIds int 1\nLOOKUP_TABLE default\n0 7 8 9\nSCALARS Blanking int 1\nLOOKUP_TABLE default\n0 0 1 0\n";
    let network = text(&TEXT.replacen("SCALARS order", &format!("{arrays}SCALARS order"), 1)).unwrap();
    let group = |n: usize| network.groups[n].map(|g| (g.group, g.blanked));
    // The second point is on both lines.
    assert_eq!([0, 1, 2, 3].map(group), [Some((7, false)), None, Some((7, false)), Some((8, true))]);
    assert!(network.notes.contains(&NetworkNote::Grouped { vessels: 1 }));
    let short = TEXT.replacen("SCALARS order", &format!("{}SCALARS order", arrays.replace("0 0 1 0", "0 0 one 0")), 1);
    assert!(text(&short).unwrap().groups.is_empty());
}
