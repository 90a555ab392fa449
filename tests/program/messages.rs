//! Messages of the program for users: command, message, exit code. `messages_of_files` tests those of readers,
//! `messages` those in the sources.

use crate::common::program::*;
use crate::common::{fixture, surfaces};
use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use tempfile::TempDir;

/// A point with an edge length.
const LENGTHS: &str = "<VTKFile type='UnstructuredGrid'><UnstructuredGrid><Piece NumberOfPoints='1' NumberOfCells='0'>\
    <Points><DataArray type='Float64' NumberOfComponents='3' format='ascii'>0 0 0</DataArray></Points>\
    <Cells></Cells><PointData><DataArray type='Float64' Name='edge' format='ascii'>0.1</DataArray></PointData>\
    </Piece></UnstructuredGrid></VTKFile>";

/// A bifurcation with a wide angle.
const FORK: &str = "1 0 0 0 0 1 -1\n2 0 0 0 9 1 1\n3 0 0 6 16 0.8 2\n4 0 0 -6 16 0.8 2\n";
/// This network with a number for each node, one of them invalid for edges.
const SIZED: &str = "id,x,y,z,radius,Size\na,0,0,0,1,2\nb,0,0,9,1,0.5\nc,0,6,16,0.8,-2\nd,0,-6,16,0.8,2\n\nsource,target\na,b\nb,c\nb,d\n";
/// Two crossing vessels.
const CROSSED: &str = "1 0 0 0 0 1 -1\n2 0 0 0 20 1 1\n3 0 -10 0 10 1 -1\n4 0 10 0.5 10 1 3\n";

/// Record of commands and their messages.
struct Record {
    folder: TempDir,
    text: String,
}

impl Record {
    fn new() -> Self {
        Self { folder: folder(), text: String::new() }
    }

    fn file(&self, name: &str, content: impl AsRef<[u8]>) -> &Self {
        fs::write(self.folder.path().join(name), content).expect("written");
        self
    }

    /// Runs a command line in the folder and records its output.
    fn run(&mut self, line: &str) {
        let mut command = program();
        command.current_dir(self.folder.path()).args(line.split(' ')).env("NO_COLOR", "1");
        let made = command.output().expect("the program runs");
        let said = [stdout(&made), stderr(&made)].concat();
        let code = made.status.code().expect("an exit code");
        assert!(code != 70, "{line}: {said}");
        let _ = writeln!(self.text, "$ anastomesh {line}\n{}[{code}]\n", Self::stable(&said));
    }

    /// Removes parts that vary between machines or implementations: times, sizes, positions.
    fn stable(said: &str) -> String {
        let numbered = [
            "mesh ",
            "shape ",
            "axis ",
            "radius ",
            "lumen ",
            "surface ",
            "file ",
            "FAIL ",
            "         ",
            "  layers ",
            "NOT valid",
        ];
        let line = |line: &str| {
            let has = numbered.iter().any(|start| line.starts_with(start));
            if has { format!("{}\n", without_numbers(line)) } else { format!("{line}\n") }
        };
        said.lines().filter(|line| !line.starts_with("time ")).map(line).collect()
    }
}

/// Replaces each number by #.
fn without_numbers(line: &str) -> String {
    let is_number = |c: char| c.is_ascii_digit() || ".,".contains(c);
    let mut out = String::new();
    let mut before = false;
    for (c, next) in line.chars().zip(line.chars().skip(1).chain([' '])) {
        let is = c.is_ascii_digit() || (before && is_number(c) && next.is_ascii_digit());
        match is {
            true if before => {}
            true => out.push('#'),
            false => out.push(c),
        }
        before = is;
    }
    out
}

fn networks(record: &Record) {
    record
        .file("fork.swc", FORK)
        .file("lengths.vtu", LENGTHS)
        .file("crossed.swc", CROSSED)
        .file("empty.swc", "")
        .file("words.swc", "It was the best of times.\n")
        .file("radius.swc", "1 0 0 0 0 0 -1\n2 0 0 0 9 1 1\n")
        .file("parent.swc", "1 0 0 0 0 1 -1\n2 0 0 0 9 1 7\n")
        .file("point.swc", "1 0 0 0 0 1 -1\n")
        .file("huge.swc", "1 0 0 0 0 1 -1\n2 0 0 0 1e200 1 1\n")
        .file("hair.vtp", HOPELESS)
        .file("noradius.csv", "source,target\na,b\n")
        .file("cut.vtp", &fs::read(fixture("tree_30.vtp")).expect("a fixture")[..900])
        .file("sized.csv", SIZED)
        .file("graph.xyz", "what is this\n");
}

#[test]
fn networks_that_cannot_be_read() {
    let mut record = Record::new();
    networks(&record);
    for name in [
        "absent.swc",
        "empty.swc",
        "words.swc",
        "radius.swc",
        "parent.swc",
        "point.swc",
        "huge.swc",
        "cut.vtp",
        "noradius.csv",
        "graph.xyz",
        ".",
    ] {
        record.run(&format!("info {name}"));
        record.run(&format!("mesh {name} -o out.vtu"));
    }
    insta::assert_snapshot!(record.text);
}

#[test]
fn options_that_make_no_sense() {
    let mut record = Record::new();
    networks(&record);
    for line in [
        "mesh fork.swc",
        "mesh fork.swc -o out.xyz",
        "mesh fork.swc -o nowhere/out.vtu",
        "mesh fork.swc -o out.vtu --rho 0.1",
        "mesh fork.swc -o out.vtu --rho many",
        "mesh fork.swc -o out.vtu --stretch 90",
        "mesh fork.swc -o out.vtu --size-at 0.1",
        "mesh fork.swc -o out.vtu --size-at 2",
        "mesh fork.swc -o out.vtu --size-at 0.5 --joint woven",
        "mesh fork.swc -o out.vtu --size-at Size",
        "mesh sized.csv -o out.vtu --size-at Size",
        "mesh sized.csv -o out.vtu --size-at Length",
        "mesh sized.csv -o out.vtu --size-at Length --stretch 4",
        "surface sized.csv -o out.stl --size-at Size",
        "mesh fork.swc -o out.vtu --sizes-from lengths.vtu",
        "mesh fork.swc -o out.vtu --sizes-from nowhere.vtu --array edge",
        "mesh fork.swc -o out.vtu --sizes-from fork.swc --array edge",
        "mesh fork.swc -o out.vtu --sizes-from lengths.vtu --array edge --size-at 0.5",
        "mesh fork.swc -o out.vtu --sizes-from lengths.vtu --array edge --follow 0",
        "mesh fork.swc -o out.vtu --sizes-from lengths.vtu --array edge --joint none",
        "mesh fork.swc -o out.vtu --core 9",
        "mesh fork.swc -o out.vtu --follow -1",
        "mesh fork.swc -o out.vtu --layers 0",
        "mesh fork.swc -o out.vtu --layers 3 --layer-thickness 2",
        "mesh fork.swc -o out.vtu --root 2",
        "mesh fork.swc -o out.vtu --root 99",
        "mesh fork.swc -o out.vtu --memory lots",
        "mesh fork.swc -o out.vtu --memory 1MiB --rho 60",
        "mesh fork.swc -o out.vtu --units furlong",
        "mesh fork.swc -o out.vtu --scale -2",
        "mesh fork.swc -o out.vtu --data height",
        "mesh fork.swc -o out.ele --data radius",
        "mesh fork.swc -o out.vtu --inflow -3",
        "mesh fork.swc -o out.vtu --inflow absent.csv",
        "mesh fork.swc -o out.vtu --inflow 1e9",
        "mesh fork.swc -o out.vtu --outlet-model rcr --outlet-time-constant 1",
        "mesh fork.swc -o out.vtu --total-resistance 3",
        "mesh fork.swc -o out.vtu --shard 1/2",
        "mesh fork.swc -o out.vtu --work-dir w --shard 3/2",
        "mesh fork.swc -o out.vtu --work-dir w --shard 1/2 --joint woven",
        "mesh fork.swc -o out.vtu --work-dir w --joint woven",
        "mesh fork.swc -o out.vtu --radius-array Height",
        "mesh fork.swc -o out.vtu --report page.pdf",
        "mesh fork.swc -o out.vtu --report nowhere/page.html",
        "mesh fork.swc -o out.vtu --config absent.toml",
        "mesh fork.swc -o out.vtu --quiet --verbose",
        "mesh fork.swc -o fork.swc",
        "surface fork.swc -o wall.vtu",
        "prepare fork.swc -o out.stl",
        "prepare fork.swc -o out.vtp --axis-tolerance 2",
        "refine fork.swc -o out.swc",
        "refine fork.swc -o out.vtp --hold beauty",
        "refine fork.swc -o out.vtp --clearance 0",
        "generate --terminals 0 -o out.vtp",
        "generate --terminals 8 --capillaries -o out.vtp",
        "generate --terminals 8 --size 1 -o out.vtp",
        "convert fork.swc -o out.vtu",
        "convert fork.swc -o out.stl",
        "convert absent.vtu -o out.msh",
        "render fork.swc -o out.jpg",
        "render fork.swc -o out.png --color block",
        "render fork.swc -o out.png --clip y",
        "render fork.swc -o out.png --size big",
        "view fork.swc -o out.pdf",
        "view fork.swc --dump-dir absent",
        "replay fork.swc",
        "check fork.swc",
        "melt fork.swc",
    ] {
        record.run(line);
    }
    insta::assert_snapshot!(record.text);
}

#[test]
fn networks_that_cannot_be_meshed() {
    let mut record = Record::new();
    networks(&record);
    record.run("mesh crossed.swc -o crossed.vtu");
    record.run("check crossed.vtu");
    record.run("refine crossed.swc -o apart.vtp --max-move 0.1 --residual report");
    record.run("mesh hair.vtp -o hair.vtu");
    record.run("mesh hair.vtp -o hair.vtu --keep-going");
    record.run("surface hair.vtp -o hair.stl");
    record.run("mesh fork.swc -o fork.vtu --work-dir w -q");
    record.run("mesh fork.swc -o fork.vtu --work-dir w --rho 4");
    record.run("mesh crossed.swc -o fork.vtu --work-dir w");
    record.run("mesh fork.swc -o fork.vtu --work-dir fork.swc");
    fs::create_dir(record.folder.path().join("begun")).expect("a folder");
    record.file("begun/anastomesh.json", "{}");
    record.run("view begun");
    record.run("mesh fork.swc -o fork.vtu --work-dir begun");
    insta::assert_snapshot!(record.text);
}

#[test]
fn meshes_that_are_not_sound() {
    let mut record = Record::new();
    networks(&record);
    record.run("mesh fork.swc -o fork.vtu -q");
    let whole = fs::read(record.folder.path().join("fork.vtu")).expect("a mesh");
    record.file("cut.vtu", &whole[..whole.len() / 2]).file("empty.msh", "").file("words.mesh", "It was.\n");
    let flat = "MeshVersionFormatted 2\nDimension 3\nVertices\n4\n0 0 0 1\n1 0 0 1\n0 1 0 1\n0 0 1 1\nTetrahedra\n1\n2 1 3 4 1\nEnd\n";
    record.file("turned.mesh", flat).file("beyond.mesh", flat.replace("2 1 3 4", "2 1 3 9"));
    for name in ["cut.vtu", "empty.msh", "words.mesh", "turned.mesh", "beyond.mesh", "absent.vtu", "fork.stl"] {
        record.run(&format!("check {name}"));
    }
    record.run("view cut.vtu");
    record.run("render cut.vtu -o cut.png");
    record.run("convert cut.vtu -o cut.msh");
    insta::assert_snapshot!(record.text);
}

#[test]
fn surfaces_that_cannot_be_filled() {
    let mut record = Record::new();
    let cube = surfaces::cube();
    let obj = |triangles: &[[u32; 3]]| {
        let points: String = cube.points.iter().map(|p| format!("v {} {} {}\n", p.x, p.y, p.z)).collect();
        let faces: String = triangles.iter().map(|[a, b, c]| format!("f {} {} {}\n", a + 1, b + 1, c + 1)).collect();
        points + &faces
    };
    let t = &cube.triangles;
    let mut turned = t.clone();
    turned[3].swap(0, 1);
    let inside_out: Vec<[u32; 3]> = t.iter().map(|&[a, b, c]| [b, a, c]).collect();
    let mut twice = t.clone();
    twice.push(t[0]);
    let through = [t.clone(), vec![[0, 7, 3], [0, 3, 7]]].concat();
    record
        .file("cube.obj", obj(t))
        .file("open.obj", obj(&t[1..]))
        .file("turned.obj", obj(&turned))
        .file("inside_out.obj", obj(&inside_out))
        .file("twice.obj", obj(&twice))
        .file("through.obj", obj(&through))
        .file("nothing.obj", obj(&[]))
        .file("beyond.obj", obj(&[[0, 1, 20]]))
        .file("nan.obj", obj(t).replacen("v 0 0 0", "v nan 0 0", 1))
        .file("words.stl", "solid it was\n")
        .file("empty.off", "")
        .file("region.poly", "4 3 0 0\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n1 0\n1\n3 1 2 9\n0\n0\n");
    for name in ["open", "turned", "inside_out", "twice", "through", "nothing", "beyond", "nan"] {
        record.run(&format!("tetrahedralize {name}.obj -o out.vtu"));
    }
    for line in [
        "tetrahedralize words.stl -o out.vtu",
        "tetrahedralize empty.off -o out.vtu",
        "tetrahedralize region.poly -o out.vtu",
        "tetrahedralize absent.off -o out.vtu",
        "tetrahedralize cube.obj",
        "tetrahedralize cube.obj -o out.xyz",
        "tetrahedralize cube.obj -o out.vtu --tetgen pC",
        "tetrahedralize cube.obj -o out.vtu --tetgen pq0",
        "tetrahedralize cube.obj -o out.vtu --max-radius-edge 0.1",
        "tetrahedralize cube.obj -o out.vtu --min-dihedral 80",
        "tetrahedralize cube.obj -o out.vtu --max-volume 0",
        "tetrahedralize cube.obj -o out.vtu --size -1",
        "tetrahedralize cube.obj -o out.vtu --layers 2 --layer-growth 0",
        "tetrahedralize - -o out.vtu",
        "tetrahedralize cube.obj -o out.vtu --size 0.2",
        "tetrahedralize cube.obj --check-only",
    ] {
        record.run(line);
    }
    insta::assert_snapshot!(record.text);
}

/// In program mode every line of any command is a JSON object, for all errors; `--json` output is unchanged.
#[test]
fn all_of_it_is_objects_for_programs() {
    let folder = folder();
    for (name, content) in [("fork.swc", FORK), ("crossed.swc", CROSSED), ("bad.swc", "1 0 0\n")] {
        fs::write(folder.path().join(name), content).expect("written");
    }
    fs::copy(fixture("torus.off"), folder.path().join("torus.off")).expect("copied");
    let mut levels = std::collections::BTreeSet::new();
    for line in [
        "mesh fork.swc -o fork.vtu",
        "mesh crossed.swc -o crossed.vtu -v --report crossed.html",
        "mesh fork.swc -o dry.vtu --dry-run",
        "mesh fork.swc -o w.vtu --work-dir w --shard 1/1",
        "mesh fork.swc -o w.vtu --work-dir w",
        "mesh fork.swc",
        "mesh bad.swc -o bad.vtu",
        "surface fork.swc -o fork.stl -v",
        "prepare crossed.swc -o prepared.vtp",
        "refine crossed.swc -o refined.vtp -v",
        "dual fork.swc -o dual.vtp",
        "generate --terminals 20 -o grown.vtp",
        "tetrahedralize torus.off -o torus.vtu --size 0.4",
        "tetrahedralize torus.off --check-only",
        "convert fork.vtu -o fork.msh",
        "render fork.vtu -o fork.png --size 80x60",
        "view fork.vtu",
        "view w",
        "check fork.vtu",
        "check crossed.vtu -v",
        "info crossed.swc",
        "nothing",
    ] {
        let mut command = program();
        command.current_dir(folder.path()).args(["--log-format", "json"]).args(line.split(' '));
        let made = command.output().expect("the program runs");
        let all = [stdout(&made), stderr(&made)].concat();
        assert!(!all.is_empty(), "{line}");
        for said in all.lines() {
            let said: serde_json::Value = serde_json::from_str(said).unwrap_or_else(|e| panic!("{line}: {e}: {said}"));
            let level = said["level"].as_str().expect("a level");
            assert!(
                said["message"].is_string() || (level == "progress" && said["progress"]["stage"].is_string()),
                "{said}"
            );
            levels.insert(level.to_owned());
        }
    }
    assert_eq!(levels.iter().map(String::as_str).collect::<Vec<_>>(), ["error", "note", "progress", "result"]);
    let mesh = folder.path().join("fork.vtu");
    let checked = json(&run("check", &[Path::new(&mesh)], &["--json", "--log-format", "json"]));
    assert_eq!(checked["verdict"], "valid");
}
