//! Command line tests of solver cases, of patches shared by outlets, and of the table beside every mesh.

use crate::common;
use crate::common::oracle;
use crate::common::program::{
    BAD_INPUT, FINE, USAGE, assert_code, assert_says, entries, folder, mesh, number, run, stdout, table,
};
use anastomesh::io::read_mesh;
use std::fs;
use std::path::{Path, PathBuf};

/// A vessel of radius 2 with branches of 1.6, 1.2 and 0.8; nodes are numbered from 5.
const FORKS: &str = "5 0 0 0 0 2 -1\n6 0 0 0 40 2 5\n7 0 0 30 70 1.6 6\n8 0 0 -30 70 1.6 6\n9 0 20 50 110 1.2 7\n\
                     10 0 -20 50 110 0.8 7\n";

/// Writes and meshes the network.
fn meshed(folder: &Path, name: &str, options: &[&str]) -> PathBuf {
    let (network, out) = (folder.join("forks.swc"), folder.join(name));
    fs::write(&network, FORKS).expect("a file");
    assert_code(&mesh(&network, &out, options), FINE);
    out
}

#[test]
fn every_mesh_has_a_table_of_its_patches_beside_it() {
    let folder = folder();
    meshed(folder.path(), "forks.vtu", &["--inflow", "0.03"]);
    assert_eq!(entries(folder.path()), ["forks.swc", "forks.vtu", "forks_patches.csv"]);
    let rows = table(&folder.path().join("forks_patches.csv"));
    let column = |name: &str| rows.iter().map(|row| row[name].as_str()).collect::<Vec<_>>();
    assert_eq!(column("name"), ["inlet", "outlet_0", "outlet_1", "outlet_2"]);
    assert_eq!(column("node"), ["5", "8", "9", "10"]);
    assert_eq!(column("id"), ["2", "3", "4", "5"]);
    assert_eq!(column("strahler_order"), ["2", "1", "1", "1"]);
    assert_eq!(number(&rows[0], "flow"), 0.03);
    assert_eq!(column("model"), ["", "pressure", "pressure", "pressure"]);
    assert_eq!(column("resistance"), ["", "0.0", "0.0", "0.0"]);
    let out: f64 = rows[1..].iter().map(|row| number(row, "flow")).sum();
    assert!((out - 0.03).abs() < 1e-14, "{out}");
    let file = read_mesh(&folder.path().join("forks.vtu")).expect("the mesh");
    for (row, patch) in rows.iter().zip(&file.volume.patches[1..]) {
        let cap = patch.cap.as_ref().expect("a cap");
        assert_eq!([number(row, "center_x"), number(row, "normal_z")], [cap.center.x, cap.normal.z]);
    }
}

#[test]
fn outlets_share_patches_of_the_same_names_in_every_format() {
    let folder = folder();
    for (outlets, name) in [("grouped", "outlets"), ("by-order", "outlets_order_")] {
        let mut all = Vec::new();
        for format in ["vtu", "msh", "msh2"] {
            let path = meshed(folder.path(), &format!("{outlets}.{format}"), &["--outlets", outlets]);
            assert_code(&run("check", &[&path], &[]), FINE);
            let volume = read_mesh(&path).expect("the mesh").volume;
            let faces = |id| volume.boundary_patch.iter().filter(|&&patch| patch == id).count();
            all.push(volume.patches.iter().map(|p| (p.id, p.name.clone(), faces(p.id))).collect::<Vec<_>>());
        }
        assert!(all.windows(2).all(|pair| pair[0] == pair[1]), "{all:?}");
        assert!(all[0][2..].iter().all(|(_, patch, faces)| patch.starts_with(name) && *faces > 0), "{all:?}");
        let case = meshed(folder.path(), &format!("{outlets}.foam"), &["--outlets", outlets]);
        let boundary = fs::read_to_string(case.join("constant/polyMesh/boundary")).expect("patches");
        for (_, patch, faces) in &all[0] {
            assert!(
                boundary.lines().any(|line| line.trim().starts_with(&format!("{patch} {{"))
                    && line.contains(&format!("nFaces {faces};"))),
                "{boundary}"
            );
        }
        let rows = table(&folder.path().join(format!("{outlets}_patches.csv")));
        assert!(rows.len() == 4 && rows[1..].iter().all(|row| row["name"].starts_with(name)), "{rows:?}");
    }
}

#[test]
fn a_folder_for_simvascular_names_every_patch() {
    let folder = folder();
    let path = meshed(folder.path(), "forks.svmesh", &["--outlet-model", "resistance", "--total-resistance", "5"]);
    let all = [
        "inlet.flow",
        "mesh-complete.exterior.vtp",
        "mesh-complete.mesh.vtu",
        "mesh-surfaces",
        "solver.xml",
        "walls_combined.vtp",
    ];
    assert_eq!(entries(&path), all);
    let surfaces = ["inlet.vtp", "outlet_0.vtp", "outlet_1.vtp", "outlet_2.vtp", "wall.vtp"];
    assert_eq!(entries(&path.join("mesh-surfaces")), surfaces);
    let solver = fs::read_to_string(path.join("solver.xml")).expect("a file");
    for surface in surfaces {
        let name = surface.strip_suffix(".vtp").expect("a surface");
        assert!(
            solver.contains(&format!("<Add_face name=\"{name}\">"))
                && solver.contains(&format!("<Add_BC name=\"{name}\">"))
        );
    }
    let rows = table(&folder.path().join("forks_patches.csv"));
    assert!(solver.contains(&format!("<Value> {:e} </Value>", number(&rows[1], "resistance"))), "{solver}");
    // Obstructing files are reported before meshing.
    fs::write(path.join("results.vtu"), "").expect("a file");
    assert_says(&mesh(&folder.path().join("forks.swc"), &path, &[]), BAD_INPUT, &["also holds results.vtu"]);
    assert_says(&run("check", &[&path], &[]), BAD_INPUT, &["solver cases can be written but not read"]);
}

#[test]
fn outlets_go_on_straight_and_keep_their_names() {
    let folder = folder();
    let path = meshed(folder.path(), "forks.vtu", &["--extend-outlets", "5", "--extend-inlets", "2"]);
    assert_code(&run("check", &[&path], &[]), FINE);
    let rows = table(&folder.path().join("forks_patches.csv"));
    assert_eq!((rows[0]["node"].as_str(), rows[1]["node"].as_str()), ("5", "8"));
    let near = |row: usize, column: &str, expected: f64| (number(&rows[row], column) - expected).abs() < 1e-9;
    let further = 5.0 * 1.6 * 0.5_f64.sqrt();
    assert!(near(0, "center_z", -4.0) && near(1, "center_y", -30.0 - further) && near(1, "center_z", 70.0 + further));
}

/// Waveform with a mean of 0.02.
const PULSE: &str = "time,flow\n0,0.01\n0.4,0.03\n0.8,0.01\n";

#[test]
fn outlet_models_are_in_the_table_and_in_the_case() {
    let folder = folder();
    fs::write(folder.path().join("pulse.csv"), PULSE).expect("a file");
    let pulse = folder.path().join("pulse.csv");
    let pulse = pulse.to_str().expect("a path");
    let rcr =
        ["--outlet-model", "rcr", "--mean-pressure", "9", "--outlet-pressure", "2", "--outlet-time-constant", "1.5"];
    let time = ["--inflow", pulse, "--periods", "2", "--outputs", "5", "--inlet-profile", "womersley", "--ramp", "0"];
    let path = meshed(folder.path(), "forks.svmesh", &[&rcr[..], &time[..]].concat());
    let rows = table(&folder.path().join("forks_patches.csv"));
    assert!((number(&rows[0], "flow") - 0.02).abs() < 1e-12);
    assert!((number(&rows[0], "pressure") / 9.0 - 1.0).abs() < 1e-10, "{rows:?}");
    let solver = fs::read_to_string(path.join("solver.xml")).expect("a file");
    for row in &rows[1..] {
        let [all, proximal, distal, capacitance, flow, pressure] =
            ["resistance", "proximal_resistance", "distal_resistance", "capacitance", "flow", "pressure"]
                .map(|column| number(row, column));
        assert_eq!((row["model"].as_str(), number(row, "distal_pressure")), ("rcr", 2.0));
        assert!((proximal / all - 0.09).abs() < 1e-12 && ((proximal + distal) / all - 1.0).abs() < 1e-12);
        assert!((distal * capacitance - 1.5).abs() < 1e-12 && ((2.0 + all * flow) / pressure - 1.0).abs() < 1e-10);
        assert!(solver.contains(&format!("<Capacitance> {capacitance:e} </Capacitance>")), "{solver}");
    }
    assert!(entries(&path).contains(&"inlet.velocity".to_owned()) && solver.contains("<Time_dependence> General"));
}

#[test]
fn flow_is_the_same_from_a_configuration_file() {
    let folder = folder();
    fs::write(folder.path().join("pulse.csv"), PULSE).expect("a file");
    let pulse = folder.path().join("pulse.csv").display().to_string();
    let options =
        format!("inflow = '{pulse}'\noutlet-model = 'resistance'\ntotal-resistance = 3\noutlet-split = 'murray'\n");
    let config = folder.path().join("plan.toml");
    fs::write(&config, options).expect("a file");
    meshed(
        folder.path(),
        "typed.vtu",
        &["--inflow", &pulse, "--outlet-model", "resistance", "--total-resistance", "3", "--outlet-split", "murray"],
    );
    meshed(folder.path(), "config.vtu", &["--config", config.to_str().expect("a path")]);
    let [typed, config] = ["typed", "config"].map(|name| table(&folder.path().join(format!("{name}_patches.csv"))));
    assert_eq!(typed, config);
    // Murray's law: resistance inverse to the cube of the radius.
    let product = |row: usize| number(&typed[row], "resistance") * number(&typed[row], "radius").powi(3);
    assert!((product(1) / product(3) - 1.0).abs() < 1e-9, "{typed:?}");
}

#[test]
fn waveforms_and_models_that_make_no_sense_leave_nothing() {
    let folder = folder();
    let network = folder.path().join("forks.swc");
    fs::write(&network, FORKS).expect("a file");
    let (out, table) = (folder.path().join("a.svmesh"), folder.path().join("pulse.csv"));
    let pulse = table.to_str().expect("a path");
    let refused = |code: i32, options: &[&str], says: &[&str]| {
        assert_says(&mesh(&network, &out, options), code, says);
        assert!(!out.exists() && !folder.path().join("a_patches.csv").exists());
    };
    for (text, says) in [
        ("time,flow\n0,0.01\n0.4,\n0.8,0.01\n", "pulse.csv: line 3, column 'flow': empty"),
        ("time,flow\n0,0.01\n0.4,1\n0.3,1\n0.8,0.01\n", "pulse.csv: line 4, column 'time': time 0.3"),
        ("time,flow\n0,0.01\n0.4,1\n0.8,0.02\n", "pulse.csv: line 4, column 'flow': the period ends"),
        ("time,aorta,inlet\n0,0.01,1\n1,0.01,1\n", "column 'aorta' is not an inlet"),
        ("time,flow\n0,10\n1,10\n", "a Reynolds number of"),
        ("time,flow\n0,-0.01\n1,-0.01\n", "a mean flow rate of -1e-2"),
    ] {
        fs::write(&table, text).expect("a file");
        refused(BAD_INPUT, &["--inflow", pulse], &[says]);
    }
    refused(BAD_INPUT, &["--inflow", "absent.csv"], &["--inflow absent.csv: cannot be read"]);
    refused(BAD_INPUT, &["--inflow", "10"], &["a Reynolds number of", "--units"]);
    refused(BAD_INPUT, &["--outlet-model", "resistance"], &["no reference", "--total-resistance, --mean-pressure"]);
    let low = ["--inflow", "0.01", "--outlet-model", "resistance", "--mean-pressure", "1e-9"];
    refused(BAD_INPUT, &low, &["leaves nothing for the outlets"]);
    let tree = ["--outlet-model", "structured-tree", "--tree-minimum-radius", "1"];
    refused(BAD_INPUT, &tree, &["the outlet at node 10 has radius 8e-1"]);
    for (options, says) in [
        (
            &["--total-resistance", "3"][..],
            "--total-resistance has an effect only with --outlet-model resistance or rcr",
        ),
        (&["--periods", "2"], "--periods has an effect only with pulsatile flow"),
        (&["--ramp", "2"], "--ramp has an effect only with pulsatile flow"),
        (&["--outlet-model", "rcr", "--total-resistance", "3"], "needs --outlet-time-constant"),
        (&["--outlet-model", "structured-tree"], "needs --tree-minimum-radius"),
        (&["--murray-exponent", "2"], "--murray-exponent has an effect only with --outlet-split murray"),
    ] {
        refused(USAGE, options, &[says]);
    }
}

#[test]
fn flow_that_makes_no_sense_is_refused() {
    let folder = folder();
    let out = folder.path().join("a.foam");
    for option in [["--inflow", "-1"], ["--viscosity", "0"], ["--density", "inf"]] {
        assert_says(&mesh(&common::fixture("tree_30.swc"), &out, &option), USAGE, &["a finite number above zero"]);
    }
}

#[test]
fn a_case_passes_openfoams_check_and_converges_as_it_is() {
    let (Some(mut check), Some(mut solve)) = (oracle::openfoam("checkMesh"), oracle::openfoam("simpleFoam")) else {
        return;
    };
    let folder = folder();
    let case = meshed(folder.path(), "forks.foam", &[]);
    let checked =
        check.arg("-case").arg(&case).args(["-allTopology", "-allGeometry"]).output().expect("checkMesh runs");
    let said = stdout(&checked);
    for ok in
        ["Upper triangular ordering OK", "Boundary definition OK", "Face pyramids OK", "Number of regions: 1 (OK)"]
    {
        assert!(said.contains(ok), "{said}");
    }
    let solved = solve.arg("-case").arg(&case).output().expect("simpleFoam runs");
    assert!(stdout(&solved).contains("SIMPLE solution converged"), "{}", stdout(&solved));
    // The flow through each outlet agrees with the table, except for losses at bifurcations, which the table ignores.
    let rows = table(&folder.path().join("forks_patches.csv"));
    let inflow = number(&rows[0], "flow");
    let time = entries(&case).into_iter().filter_map(|name| name.parse::<u32>().ok()).max().expect("a result");
    let phi = fs::read(case.join(format!("{time}/phi"))).expect("a result");
    for row in &rows {
        let (flow, expected) = (through(&phi, &row["name"]).abs() / inflow, number(row, "flow") / inflow);
        assert!((flow - expected).abs() < 0.02, "{}: {flow} instead of {expected}", row["name"]);
    }
}

#[test]
fn layers_are_prisms_that_openfoam_accepts_and_converges_on() {
    let (Some(mut check), Some(mut solve)) = (oracle::openfoam("checkMesh"), oracle::openfoam("simpleFoam")) else {
        return;
    };
    let folder = folder();
    let case = meshed(folder.path(), "layers.foam", &["--layers", "2", "--stretch", "4"]);
    let checked = check.arg("-case").arg(&case).arg("-allTopology").output().expect("checkMesh runs");
    let said = stdout(&checked);
    let prisms = said.lines().find_map(|line| line.trim().strip_prefix("prisms:")).expect("a count");
    assert!(prisms.trim().parse::<u32>().expect("a number") > 1000, "{said}");
    assert!(said.contains("Mesh OK"), "{said}");
    let solved = solve.arg("-case").arg(&case).output().expect("simpleFoam runs");
    assert!(stdout(&solved).contains("SIMPLE solution converged"), "{}", stdout(&solved));
}

/// Total flux through a patch in a binary field.
fn through(field: &[u8], patch: &str) -> f64 {
    let find = |from: usize, what: &str| {
        let found = field[from..].windows(what.len()).position(|window| window == what.as_bytes());
        from + found.unwrap_or_else(|| panic!("no {what} in the field")) + what.len()
    };
    let start = find(find(find(0, "boundaryField"), &format!("\n    {patch}\n")), "List<scalar>");
    let open = find(start, "(");
    let count: usize =
        std::str::from_utf8(&field[start..open - 1]).expect("a number").trim().parse().expect("a number");
    let (words, _) = field[open..open + 8 * count].as_chunks::<8>();
    words.iter().map(|word| f64::from_le_bytes(*word)).sum()
}
