//! `mesh --embed`: vessels as lines in tissue.

use crate::common;
use crate::common::program::{assert_code, folder, number, program, stderr, stdout, table};
use crate::common::surfaces::text;
use anastomesh::io::{MeshFile, read_mesh};
use anastomesh::mesh::Point3;
use std::collections::BTreeMap;
use std::path::Path;

/// Three vessels at a fork, on lines of a grid.
const FORK: &str = "1 1 0 0 0 1 -1\n2 1 0 0 10 1 1\n3 1 6 0 16 0.5 2\n4 1 -6 0 16 0.5 2\n";

/// Box from (-8, -8, 0) to (8, 8, 16), with the root of the fork and both tips on its sides.
const BOX: &str = "OFF\n8 12 0\n-8 -8 0\n8 -8 0\n8 8 0\n-8 8 0\n-8 -8 16\n8 -8 16\n8 8 16\n-8 8 16\n\
    3 0 2 1\n3 0 3 2\n3 4 5 6\n3 4 6 7\n3 0 1 5\n3 0 5 4\n3 1 2 6\n3 1 6 5\n3 2 3 7\n3 2 7 6\n3 3 0 4\n3 3 4 7\n";

/// Four lines. The second has no length, and the third is a copy of the first.
const LINES: &str = r#"<VTKFile type="PolyData"><PolyData><Piece NumberOfPoints="4" NumberOfLines="4">
<PointData><DataArray type="Float64" Name="Radius" format="ascii">1 1 1 1</DataArray></PointData>
<Points><DataArray type="Float64" NumberOfComponents="3" format="ascii">0 0 0 0 0 9 0 0 9 5 0 9</DataArray></Points>
<Lines><DataArray type="Int64" Name="connectivity" format="ascii">0 1 1 2 0 1 2 3</DataArray>
<DataArray type="Int64" Name="offsets" format="ascii">2 4 6 8</DataArray></Lines></Piece></PolyData></VTKFile>"#;

fn embed(network: &Path, out: &Path, options: &[&str]) -> std::process::Output {
    common::program::mesh(network, out, &[&["--embed"], options].concat())
}

/// True if a point lies in a closed tetrahedron, except for roundoff.
fn is_inside(at: [Point3; 4], p: &Point3) -> bool {
    let volume = |[a, b, c, d]: [Point3; 4]| (b - a).cross(&(c - a)).dot(&(d - a));
    (0..4).all(|i| {
        let mut with = at;
        with[i] = *p;
        volume(with) >= -1e-9 * volume(at)
    })
}

/// Checks the table against the mesh and the nodes of the fork; returns the length of each edge.
fn lengths(out: &Path, pieces: &Path) -> BTreeMap<String, f64> {
    let MeshFile { volume, notes, .. } = read_mesh(out).expect("a mesh");
    assert_eq!(notes.regions.iter().map(|region| region.name.as_str()).collect::<Vec<_>>(), ["tissue"]);
    let node = |name: &str| {
        let line: Vec<&str> = FORK.lines().find(|line| line.starts_with(name)).expect("a node").split(' ').collect();
        let [x, y, z] = [2, 3, 4].map(|i| line[i].parse::<f64>().expect("a number"));
        Point3::new(x, y, z)
    };
    let (mut sums, mut end) = (BTreeMap::new(), 1.0);
    for row in table(pieces) {
        let number = |column: &str| number(&row, column);
        let [p, q] = [node(&row["first_node"]), node(&row["second_node"])];
        let cell: usize = row["cell"].parse().expect("a number");
        let at = volume.mesh.tets[cell].map(|v| volume.mesh.points[v as usize]);
        assert!(is_inside(at, &p.lerp(&q, 0.5 * (number("start") + number("end")))), "{row:?}");
        assert_eq!(number("start"), if end == 1.0 { 0.0 } else { end }, "{row:?}");
        assert!((0.5..=1.0).contains(&number("radius")), "{row:?}");
        end = number("end");
        *sums.entry(row["edge"].clone()).or_insert(0.0) += number("length");
    }
    assert_eq!(end, 1.0);
    sums
}

#[test]
fn vessels_are_divided_between_the_cells_of_the_file() {
    let folder = folder();
    let network = text(&folder, "fork.swc", FORK);
    let organ = text(&folder, "box.off", BOX);
    let organ = organ.to_str().expect("text");
    for (file, options) in [("a.vtu", &["--tissue", organ][..]), ("b.msh", &["--embed-size", "1+1r"])] {
        let out = folder.path().join(file);
        let done = embed(&network, &out, options);
        assert_code(&done, 0);
        let said = stderr(&done) + &stdout(&done);
        for row in ["4 nodes, 3 edges", "pieces of edges in", "total length 26.97", "_embedding.csv"] {
            assert!(said.contains(row), "{row}\n{said}");
        }
        let checked = program().arg("check").arg(&out).output().expect("the program runs");
        assert_code(&checked, 0);
        let sums = lengths(&out, &folder.path().join(file.replace('.', "_embedding.")).with_extension("csv"));
        assert_eq!(sums.keys().map(String::as_str).collect::<Vec<_>>(), ["0", "1", "2"]);
        for (edge, length) in [("0", 10.0), ("1", 72.0_f64.sqrt()), ("2", 72.0_f64.sqrt())] {
            assert!((sums[edge] - length).abs() < 1e-12, "{sums:?}");
        }
    }
}

#[test]
fn the_result_does_not_depend_on_threads() {
    let folder = folder();
    let network = text(&folder, "fork.swc", FORK);
    let made = |threads: &str| {
        let out = folder.path().join(format!("{threads}.vtu"));
        assert_code(&embed(&network, &out, &["-j", threads]), 0);
        let table = folder.path().join(format!("{threads}_embedding.csv"));
        [out, table].map(|path| std::fs::read(path).expect("a file"))
    };
    let [one, four] = [made("1"), made("4")];
    assert!(one == four);
}

#[test]
fn edges_have_the_numbers_of_the_file() {
    let folder = folder();
    let network = text(&folder, "lines.vtp", LINES);
    let out = folder.path().join("x.vtu");
    let done = embed(&network, &out, &["--json"]);
    assert_code(&done, 0);
    let report = stdout(&done);
    assert!(report.contains("\"embedding\"") && report.contains("\"pieces\""), "{report}");
    let rows = table(&folder.path().join("x_embedding.csv"));
    let mut numbers: Vec<&str> = rows.iter().map(|row| row["edge"].as_str()).collect();
    numbers.dedup();
    assert_eq!(numbers, ["0", "3"]);
}

#[test]
fn embeddings_that_cannot_be_made_are_refused() {
    let folder = folder();
    let network = text(&folder, "fork.swc", FORK);
    let small = text(&folder, "small.off", &BOX.replace("16", "12"));
    let small = small.to_str().expect("text");
    let out = folder.path().join("x.vtu");
    let cases: [(&[&str], i32, &str); 9] = [
        (&["--rho", "3"], 2, "cannot be used with"),
        (&["--wall", "0.2r"], 2, "cannot be used with"),
        (&["--layers", "2"], 2, "cannot be used with"),
        (&["--embed-size", "0"], 2, "invalid edge length at the vessels 0"),
        (&["--embed-size", "thin"], 3, "thin"),
        (&["--tissue-growth", "1"], 2, "invalid growth of the tissue 1"),
        (&["--tissue", small], 3, "2 nodes lie outside the surface around the tissue, first node 3"),
        (&["--embed-size", "1e-7"], 3, "--embed-size"),
        (&["--embed-size", "0.1r", "--memory", "5MB"], 3, "raise --memory"),
    ];
    for (options, code, needle) in cases {
        let done = embed(&network, &out, options);
        assert_code(&done, code);
        assert!(stderr(&done).contains(needle), "{options:?}: {}", stderr(&done));
        assert!(!out.exists(), "{options:?}");
    }
    let done = embed(&network, &folder.path().join("x.svmesh"), &[]);
    assert_code(&done, 2);
    assert!(stderr(&done).contains("lumen"), "{}", stderr(&done));
    let alone = common::program::mesh(&network, &out, &["--embed-size", "2r"]);
    assert_code(&alone, 2);
}
