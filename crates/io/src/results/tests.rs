use super::*;
use crate::file::FileError;
use std::path::Path;

/// A case of one cube between `inlet` (x = 0) and `outlet` (x = 2), cut into two cells.
fn write_case(folder: &Path) {
    let head = |class: &str| format!("FoamFile\n{{ version 2.0; format ascii; class {class}; }}\n");
    let points: String =
        (0..3).flat_map(|x| [[0, 0], [0, 1], [1, 0], [1, 1]].map(move |[y, z]| format!("({x} {y} {z})\n"))).collect();
    // The face between the cells, then inlet, outlet and wall, outwards.
    let faces = "11\n(4(4 6 7 5)\n4(0 1 3 2)\n4(8 10 11 9)\n\
                 4(0 4 5 1) 4(2 3 7 6) 4(0 2 6 4) 4(1 5 7 3)\n4(4 8 9 5) 4(6 7 11 10) 4(4 6 10 8) 4(5 9 11 7))\n";
    let boundary = "3 ( inlet { type patch; nFaces 1; startFace 1; } outlet { type patch; nFaces 1; startFace 2; }\n\
                    wall { type wall; inGroups 1(wall); nFaces 8; startFace 3; } )";
    let velocity = "dimensions [0 1 -1 0 0 0 0];\ninternalField nonuniform List<vector> 2 ((3 0 0) (3 0 0));\n\
                    boundaryField { inlet { type fixedValue; value uniform (3 0 0); }\n\
                    outlet { type zeroGradient; } wall { type noSlip; } }";
    let pressure = "dimensions [0 2 -2 0 0 0 0]; // kinematic\ninternalField nonuniform List<scalar> 2(7 5);\n\
                    boundaryField { inlet { type zeroGradient; } outlet { type fixedValue; value uniform 4; } wall { type zeroGradient; } }";
    let files = [
        ("constant/polyMesh/points", "vectorField", format!("12\n(\n{points})\n")),
        ("constant/polyMesh/faces", "faceList", faces.to_owned()),
        ("constant/polyMesh/owner", "labelList", "11(0 0 1 0 0 0 0 1 1 1 1)".to_owned()),
        ("constant/polyMesh/neighbour", "labelList", "1(1)".to_owned()),
        ("constant/polyMesh/boundary", "polyBoundaryMesh", boundary.to_owned()),
        ("0/U", "volVectorField", velocity.replace('3', "9")),
        ("12/U", "volVectorField", velocity.to_owned()),
        ("12/p", "volScalarField", pressure.to_owned()),
        ("9/U", "volVectorField", velocity.replace('3', "8")),
    ];
    for (name, class, text) in files {
        let path = folder.join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, head(class) + &text).unwrap();
    }
}

fn case() -> tempfile::TempDir {
    let folder = tempfile::Builder::new().suffix(".foam").tempdir().unwrap();
    write_case(folder.path());
    folder
}

/// Replaces text in a file of a case, and returns the message of its reader.
fn refused(file: &str, from: &str, to: &str) -> String {
    let folder = case();
    let path = folder.path().join(file);
    let text = std::fs::read_to_string(&path).unwrap();
    assert!(text.contains(from), "{text}");
    std::fs::write(&path, text.replacen(from, to, 1)).unwrap();
    read_result(folder.path()).unwrap_err().to_string()
}

#[test]
fn the_latest_time_of_a_case_is_read() {
    let folder = case();
    let result = read_result(folder.path()).unwrap();
    assert_eq!((result.name.as_str(), result.is_kinematic), ("12", true));
    assert!(
        result
            .cells
            .iter()
            .zip([0.5, 1.5])
            .all(|(cell, x)| (cell - anastomesh_mesh::Point3::new(x, 0.5, 0.5)).norm() < 1e-12)
    );
    assert!(result.volumes.iter().all(|volume| (volume - 1.0).abs() < 1e-12));
    assert_eq!(result.pressures, [7.0, 5.0]);
    // Without fluxes in the files, they come from the velocity.
    assert_eq!(result.inner, [InnerFlux { cells: [0, 1], flux: 3.0 }]);
    let caps: Vec<[f64; 2]> =
        result.outer.iter().filter(|face| !face.is_wall).map(|face| [face.flux, face.pressure]).collect();
    assert_eq!(caps, [[-3.0, 7.0], [3.0, 4.0]]);
    let wall: Vec<Near> = result.outer.iter().filter(|face| face.is_wall).map(|face| face.near).collect();
    assert!(wall.len() == 8 && wall.iter().all(|near| near.speed == 3.0 && (near.height - 0.5).abs() < 1e-12));
    // The marker of the case names it, too.
    std::fs::write(folder.path().join("case.foam"), "").unwrap();
    assert_eq!(read_result(&folder.path().join("case.foam")).unwrap(), result);
}

#[test]
fn fluxes_and_shear_of_the_solver_take_precedence() {
    let folder = case();
    let head = |class: &str| {
        format!("FoamFile\n{{ version 2.0; format binary; arch \"LSB;label=32;scalar=64\"; class {class}; }}\n")
    };
    let mut flux = (head("surfaceScalarField")
        + "dimensions [0 3 -1 0 0 0 0]; oriented oriented;\ninternalField nonuniform List<scalar> \n1\n(")
        .into_bytes();
    flux.extend(2.5_f64.to_le_bytes());
    flux.extend(b");\nboundaryField { inlet { type calculated; value uniform -2.5; } outlet { type calculated; value nonuniform List<scalar> 1(");
    flux.extend(2.25_f64.to_le_bytes());
    flux.extend(b"); } wall { type calculated; value uniform 0; } }\n");
    std::fs::write(folder.path().join("12/phi"), flux).unwrap();
    let shear = "internalField uniform (0 0 0); boundaryField { inlet { type calculated; value uniform (0 0 0); }\n\
                 outlet { type calculated; value uniform (0 0 0); } wall { type calculated; value nonuniform List<vector> 8{(0 3 -4)}; } }";
    std::fs::write(folder.path().join("12/wallShearStress"), head("volVectorField") + shear).unwrap();
    let result = read_result(folder.path()).unwrap();
    assert_eq!(result.inner[0].flux, 2.5);
    assert_eq!(result.outer.iter().map(|face| face.flux).sum::<f64>(), -0.25);
    assert!(result.outer.iter().all(|face| face.shear == face.is_wall.then_some(5.0)));
}

#[test]
fn faults_of_cases_are_named() {
    for (file, from, to, message) in [
        ("12/U", "2 ((3 0 0) (3 0 0))", "1 ((3 0 0))", "U has length 1 instead of 2; give a result of this mesh"),
        ("12/U", "(3 0 0))", "(3 0 nan))", "U has a value that is not finite (number 6); the solver diverged"),
        ("12/U", "inlet {", "entry {", "'patch inlet of U' is missing; run the solver with this field"),
        ("12/p", "internalField", "internal", "'internalField of p' is missing; run the solver with this field"),
        ("12/p", "FoamFile", "Foam", "byte 0: expected a header FoamFile"),
        ("constant/polyMesh/owner", "0 0 1", "0 0 99", "owner refers to 99, and there are 11"),
        ("constant/polyMesh/faces", "4(4 6 7 5)", "4(4 6 7 55)", "a face refers to 55, and there are 12"),
        ("constant/polyMesh/boundary", "type wall", "type patch", "the mesh has no wall: patches inlet, outlet, wall"),
        ("constant/polyMesh/boundary", "startFace 3", "startFace 9", "a patch refers to 9, and there are 11"),
    ] {
        let found = refused(file, from, to);
        assert!(found.contains(message), "{file}: {found}");
    }
}

#[test]
fn truncated_files_are_errors() {
    let names = [
        "constant/polyMesh/points",
        "constant/polyMesh/faces",
        "constant/polyMesh/owner",
        "constant/polyMesh/boundary",
        "12/U",
        "12/p",
    ];
    for name in names {
        let folder = case();
        let path = folder.path().join(name);
        let text = std::fs::read(&path).unwrap();
        for length in (0..text.len() - 2).step_by(7) {
            std::fs::write(&path, &text[..length]).unwrap();
            assert!(read_result(folder.path()).is_err(), "{name} {length}");
        }
    }
}

#[test]
fn cases_without_results_are_errors() {
    let folder = case();
    for time in ["9", "12"] {
        std::fs::remove_dir_all(folder.path().join(time)).unwrap();
    }
    let message = read_result(folder.path()).unwrap_err().to_string();
    assert!(message.ends_with("no time folder with U and p: run the solver"), "{message}");
    std::fs::create_dir(folder.path().join("processor0")).unwrap();
    let message = read_result(folder.path()).unwrap_err().to_string();
    assert!(message.ends_with("run the solver, then reconstructPar -latestTime"), "{message}");
    let unknown = read_result(Path::new("Cargo.toml")).unwrap_err();
    assert!(matches!(unknown, ResultError::File(FileError::UnknownFormat { .. })), "{unknown}");
}

/// Two tetrahedra on the plane z = 0, with text arrays.
fn vtu(velocity: &str, pressure: &str) -> String {
    format!(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" byte_order=\"LittleEndian\">\n<UnstructuredGrid>\n\
         <Piece NumberOfPoints=\"5\" NumberOfCells=\"2\">\n<PointData>\n<DataArray type=\"Float64\" Name=\"Velocity\" \
         NumberOfComponents=\"3\" format=\"ascii\">{velocity}</DataArray>\n<DataArray type=\"Float64\" Name=\"Pressure\" \
         format=\"ascii\">{pressure}</DataArray>\n</PointData>\n<Points>\n<DataArray type=\"Float64\" NumberOfComponents=\"3\" \
         format=\"ascii\">0 0 0  1 0 0  0 1 0  1 1 0  0.5 0.5 1</DataArray>\n</Points>\n<Cells>\n<DataArray type=\"Int32\" \
         Name=\"connectivity\" format=\"ascii\">0 1 2 4  1 3 2 4</DataArray>\n<DataArray type=\"Int32\" Name=\"offsets\" \
         format=\"ascii\">4 8</DataArray>\n<DataArray type=\"UInt8\" Name=\"types\" format=\"ascii\">10 10</DataArray>\n</Cells>\n\
         </Piece>\n</UnstructuredGrid>\n</VTKFile>\n"
    )
}

#[test]
fn nodal_results_are_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("result_003.vtu");
    std::fs::write(&path, vtu("0 0 0  0 0 0  0 0 0  0 0 0  6 0 3", "1 2 3 4 8")).unwrap();
    let result = read_result(&path).unwrap();
    assert_eq!(
        (result.name.as_str(), result.is_kinematic, result.pressures.as_slice()),
        ("result_003.vtu", false, &[3.5, 4.25][..])
    );
    let wall: Vec<&OuterFlux> = result.outer.iter().filter(|face| face.is_wall).collect();
    assert!(wall.len() == 2 && wall.iter().all(|face| face.near == Near { speed: 6.0, height: 1.0 }), "{wall:?}");
    // Both cells together lose what leaves through their common face and the others.
    let [cell, flux] = [result.inner[0].cells[0], result.inner[0].cells[1]].map(|cell| {
        let outer: f64 = result.outer.iter().filter(|face| face.cell == cell).map(|face| face.flux).sum();
        outer
    });
    assert!((cell + result.inner[0].flux).is_finite() && result.inner[0].flux > 0.0 && flux.is_finite());
    for (velocity, pressure, message) in [
        ("0 0 0", "1 2 3 4 8", "array Velocity has length 3 instead of 15"),
        (
            "0 0 0  0 0 0  0 0 0  0 0 0  6 0 nan",
            "1 2 3 4 8",
            "array Velocity has a value that is not finite (number 15)",
        ),
        ("1 0 0  1 0 0  1 0 0  1 0 0  6 0 3", "1 2 3 4 8", "the mesh has no wall: no boundary face has zero velocity"),
    ] {
        std::fs::write(&path, vtu(velocity, pressure)).unwrap();
        let found = read_result(&path).unwrap_err().to_string();
        assert!(found.contains(message), "{found}");
    }
    std::fs::write(&path, vtu("", "").replace("Velocity", "Speed")).unwrap();
    assert!(read_result(&path).unwrap_err().to_string().contains("'Velocity' is missing"));
}
