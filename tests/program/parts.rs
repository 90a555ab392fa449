//! Command line tests of `--parts`: meshes for parallel solvers. Cases are checked and solved with OpenFOAM in parallel.

use crate::common::fixture;
use crate::common::oracle;
use crate::common::program::{BAD_INPUT, FINE, USAGE, assert_code, assert_says, entries, folder, mesh, run, stdout};
use anastomesh::io::read_mesh;
use std::fs;
use std::path::Path;
use std::process::Command;

fn convert(input: &Path, out: &Path, options: &[&str]) -> std::process::Output {
    run("convert", &[input, Path::new("--output"), out], options)
}

/// OpenFOAM's program on all parts of a case, if it and MPI exist.
fn parallel(program: &str, parts: usize, case: &Path) -> Option<Command> {
    let found = oracle::openfoam(program)?;
    let mut command = Command::new("mpirun");
    if Command::new("mpirun").arg("--version").output().is_err() {
        return None;
    }
    command.args(["--allow-run-as-root", "--oversubscribe", "-np", &parts.to_string(), program, "-parallel", "-case"]);
    command.arg(case).envs(found.get_envs().filter_map(|(name, value)| Some((name, value?))));
    Some(command)
}

#[test]
fn a_case_in_parts_is_checked_and_solved_in_parallel() {
    let folder = folder();
    for options in [&[][..], &["--layers", "2"]] {
        let case = folder.path().join(format!("tree{}.foam", options.len()));
        let all = [&["--units", "mm:m", "--inflow", "1e-6", "--parts", "2", "-q"], options].concat();
        assert_code(&mesh(&fixture("tree_30.swc"), &case, &all), FINE);
        for name in ["constant", "processor0", "processor1", "system"] {
            assert!(entries(&case).contains(&name.to_owned()), "{name}");
        }
        let (Some(mut check), Some(mut solve)) = (parallel("checkMesh", 2, &case), parallel("simpleFoam", 2, &case))
        else {
            return;
        };
        let said = stdout(&check.output().expect("checkMesh runs"));
        assert!(said.contains("End") && !said.contains("FATAL"), "{said}");
        let said = stdout(&solve.output().expect("simpleFoam runs"));
        assert!(said.contains("SIMPLE solution converged"), "{said}");
        let Some(mut reconstruct) = oracle::openfoam("reconstructPar") else { return };
        let done = reconstruct.args(["-latestTime", "-case"]).arg(&case).output().expect("reconstructPar runs");
        assert!(stdout(&done).contains("End"), "{}", stdout(&done));
        let times = entries(&case).into_iter().filter_map(|name| name.parse::<u32>().ok()).max();
        assert!(case.join(format!("{}/U", times.expect("a result"))).is_file());
    }
}

#[test]
fn meshes_in_parts_stay_valid_and_are_converted_back() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    assert_code(&mesh(&fixture("tree_30.swc"), &at("tree.vtu"), &["-q"]), FINE);
    let whole = read_mesh(&at("tree.vtu")).expect("a mesh").volume;
    for name in ["a.pvtu", "a.msh"] {
        assert_code(&mesh(&fixture("tree_30.swc"), &at(name), &["-q", "--parts", "5"]), FINE);
        assert_code(&run("check", &[&at(name)], &[]), FINE);
        let volume = read_mesh(&at(name)).expect("a mesh").volume;
        assert_eq!(volume.mesh.points, whole.mesh.points);
        assert_eq!([volume.mesh.tets.len(), volume.boundary.len()], [whole.mesh.tets.len(), whole.boundary.len()]);
        // A mesh from a file has the same parts.
        let again = at(&format!("b_{name}"));
        assert_code(&convert(&at("tree.vtu"), &again, &["-q", "--parts", "5"]), FINE);
        assert_code(&run("check", &[&again], &[]), FINE);
    }
    assert_eq!(entries(&at("a")).len(), 5);
    assert!(fs::read(at("a/a_0003.vtu")).expect("a file") == fs::read(at("b_a/b_a_0003.vtu")).expect("a file"));
    let surface = at("torus.msh");
    assert_code(
        &run("tetrahedralize", &[&fixture("torus.off"), Path::new("-o"), &surface], &["-q", "--parts", "2"]),
        FINE,
    );
    assert_code(&run("check", &[&surface], &[]), FINE);
}

#[test]
fn impossible_parts_are_refused_and_nothing_is_written() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    let tree = fixture("tree_30.swc");
    assert_says(&mesh(&tree, &at("a.foam"), &["--parts", "0"]), USAGE, &["--parts"]);
    assert_says(&mesh(&tree, &at("a.vtu"), &["--parts", "2"]), USAGE, &["--parts", "use .foam, .pvtu or .msh"]);
    let prisms = ["--parts", "2", "--layers", "2", "--prisms"];
    assert_says(&mesh(&tree, &at("a.pvtu"), &prisms), USAGE, &["--parts does not combine with --prisms"]);
    let regions = ["--parts", "2", "--wall", "0.1"];
    assert_says(&mesh(&tree, &at("a.msh"), &regions), USAGE, &["--parts with regions", ".pvtu"]);
    for name in ["a.foam", "a.pvtu", "a.msh"] {
        let made = mesh(&tree, &at(name), &["-q", "--parts", "10000000"]);
        assert_says(&made, BAD_INPUT, &["10000000 parts need at least 10000000 cells", "ask for fewer parts"]);
    }
    assert!(entries(folder.path()).is_empty(), "{:?}", entries(folder.path()));
    assert_code(&mesh(&tree, &at("a.vtu"), &["-q"]), FINE);
    assert_says(&convert(&at("a.vtu"), &at("a.stl"), &["--parts", "2"]), USAGE, &["--parts"]);
    let stream = run("tetrahedralize", &[&fixture("box.poly")], &["-o", "-", "--to", "msh", "--parts", "2"]);
    assert_says(&stream, USAGE, &["--parts"]);
}
