//! Regions around a lumen on the command line.

use crate::common;
use crate::common::program::{assert_code, folder, program, stderr, stdout};
use crate::common::surfaces::text;
use anastomesh::mesh::{Point3, TriMesh, Vec3, shapes::sphere_surface};
use std::path::{Path, PathBuf};
use std::process::Output;

/// Three vessels at a fork.
const FORK: &str = "1 1 0 0 0 1 -1\n2 1 0 0 10 1 1\n3 1 6 0 16 1 2\n4 1 -6 0 16 1 2\n";

fn mesh(network: &Path, out: &Path, options: &[&str]) -> Output {
    common::program::mesh(network, out, options)
}

fn check(file: &Path) -> Output {
    program().arg("check").arg(file).output().expect("the program runs")
}

fn fork(folder: &tempfile::TempDir) -> PathBuf {
    text(folder, "fork.swc", FORK)
}

#[test]
fn wall_and_tissue_are_valid_regions() {
    let folder = folder();
    let network = fork(&folder);
    let out = folder.path().join("organ.vtu");
    let done = mesh(&network, &out, &["--wall", "0.2r", "--annulus", "0.1r:1", "--tissue", "box", "--split-regions"]);
    assert_code(&done, 0);
    let said = stderr(&done) + &stdout(&done);
    for row in ["lumen: ", "wall: ", "annulus: ", "tissue: ", "full thickness at ", "organ_annulus.vtu"] {
        assert!(said.contains(row), "{row}\n{said}");
    }
    let whole = check(&out);
    assert_code(&whole, 0);
    assert!(stdout(&whole).ends_with("valid\n"), "{}", stdout(&whole));
    for region in ["lumen", "wall", "annulus", "tissue"] {
        assert_code(&check(&folder.path().join(format!("organ_{region}.vtu"))), 0);
    }
}

#[test]
fn tissue_alone_has_the_vessels_as_holes() {
    let folder = folder();
    let network = fork(&folder);
    let out = folder.path().join("tissue.msh");
    assert_code(&mesh(&network, &out, &["--tissue", "box:8", "--tissue-growth", "2", "--without", "lumen"]), 0);
    let checked = check(&out);
    assert_code(&checked, 0);
    assert!(stdout(&checked).contains("tissue: ") && !stdout(&checked).contains("lumen: "));
}

/// Path of a ball at (0, y, 8).
fn ball(folder: &tempfile::TempDir, name: &str, y: f64, radius: f64) -> String {
    let ball = sphere_surface(2);
    let place = |p: &Point3| p * radius + Vec3::new(0.0, y, 8.0);
    let path = folder.path().join(name);
    let surface = TriMesh { points: ball.points.iter().map(place).collect(), ..ball };
    anastomesh::io::surface::write_surface(&path, &surface).expect("written");
    path.to_str().expect("text").to_owned()
}

#[test]
fn a_hull_is_closed_and_has_good_tetrahedra() {
    let folder = folder();
    let network = fork(&folder);
    let out = folder.path().join("hull.vtu");
    let done = mesh(&network, &out, &["--wall", "0.2r", "--tissue", "hull:1.5", "--split-regions"]);
    assert_code(&done, 0);
    let whole = check(&out);
    assert_code(&whole, 0);
    let tissue = check(&folder.path().join("hull_tissue.vtu"));
    assert_code(&tissue, 0);
    let said = stdout(&tissue);
    let least = said.split("min ").nth(1).and_then(|rest| rest.split(';').next()).expect("a quality");
    assert!(least.parse::<f64>().expect("a number") > 0.1, "{said}");
}

#[test]
fn regions_lie_in_each_other_and_around_vessels() {
    let folder = folder();
    let network = fork(&folder);
    let out = folder.path().join("organ.vtu");
    let organ = ball(&folder, "organ.stl", 0.0, 20.0);
    let inner = [("tumour", 9.0, 2.0), ("core", 9.0, 1.0), ("lobe", 0.0, 15.0)]
        .map(|(name, y, radius)| format!("{name}={}", ball(&folder, &format!("{name}.stl"), y, radius)));
    let mut options = vec!["--wall", "0.2r", "--split-regions", "--tissue", &organ];
    options.extend(inner.iter().flat_map(|region| ["--tissue-region", region.as_str()]));
    assert_code(&mesh(&network, &out, &options), 0);
    let whole = check(&out);
    assert_code(&whole, 0);
    let said = stdout(&whole);
    for region in ["lumen", "wall", "tissue", "tumour", "core", "lobe"] {
        assert!(said.contains(&format!("{region}: ")), "{region} {said}");
        assert_code(&check(&folder.path().join(format!("organ_{region}.vtu"))), 0);
    }
    let named = folder.path().join("organ.msh");
    options.retain(|option| !["--wall", "0.2r", "--split-regions"].contains(option));
    assert_code(&mesh(&network, &named, &options), 0);
    assert_code(&check(&named), 0);
    let text = String::from_utf8_lossy(&std::fs::read(&named).expect("read")).into_owned();
    for patch in ["lumen_lobe", "tissue_lobe", "tumour_core", "tumour_lobe"] {
        assert!(text.contains(&format!("\"interface_{patch}\"")), "{patch}");
    }
    assert!(!text.contains("interface_lumen_tissue"));
}

#[test]
fn vessels_leave_the_organ_through_openings_or_end_inside() {
    let folder = folder();
    let network = fork(&folder);
    let out = folder.path().join("organ.vtu");
    // Balls of radius 7 and 10 around (0, 0, 8): all three ends lie outside of the first, the last two near the second.
    for (radius, ends, note) in [
        (7.0, "surface", "3 vessels cut, 3 nodes removed, 3 openings, first at node 1, "),
        (7.0, "inside", "3 vessels cut, 3 nodes removed, 0 openings, first at node 1, "),
        (10.3, "surface", "0 vessels cut, 0 nodes removed, 2 openings, first at node 3, 6,0,16"),
    ] {
        let organ = ball(&folder, "organ.stl", 0.0, radius);
        let options = ["--wall", "0.2r", "--tissue", &organ, "--tissue-growth", "2", "--tissue-ends", ends];
        let done = mesh(&network, &out, &options);
        assert_code(&done, 0);
        assert!(stderr(&done).contains(note), "{}", stderr(&done));
        let checked = check(&out);
        assert_code(&checked, 0);
        let caps_outside = stdout(&checked).matches("interface").count();
        assert!(stdout(&checked).ends_with("valid\n"), "{caps_outside}\n{}", stdout(&checked));
    }
}

#[test]
fn surfaces_are_remeshed_on_request() {
    let folder = folder();
    let network = fork(&folder);
    let out = folder.path().join("organ.vtu");
    let organ = ball(&folder, "organ.stl", 0.0, 20.0);
    let tumour = format!("tumour={}", ball(&folder, "tumour.stl", 9.0, 2.0));
    let faces = |more: &[&str]| {
        let options = [&["--tissue", &organ, "--tissue-region", &tumour, "--tissue-size", "3"], more].concat();
        assert_code(&mesh(&network, &out, &options), 0);
        let checked = check(&out);
        assert_code(&checked, 0);
        let said = stdout(&checked);
        let count = said.split(" boundary faces").next().and_then(|text| text.rsplit(' ').next()).expect("a number");
        count.replace(',', "").parse::<u32>().expect("a number")
    };
    assert_eq!(faces(&[]), 320);
    assert!(faces(&["--tissue-remesh", "--tissue-tolerance", "0.5"]) > 640);
}

#[test]
fn regions_that_cannot_be_made_are_refused() {
    let folder = folder();
    let network = fork(&folder);
    let out = folder.path().join("x.vtu");
    let small =
        text(&folder, "small.off", "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n");
    let open = text(&folder, "open.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 2 1\n");
    let organ = ball(&folder, "organ.stl", 0.0, 20.0);
    let region = |name: &str, y, radius| format!("{name}={}", ball(&folder, &format!("{name}.stl"), y, radius));
    let [apart, across, beside, far] =
        [region("apart", 9.0, 2.0), region("across", 0.0, 6.0), region("beside", 7.0, 2.0), region("far", 50.0, 2.0)];
    let (cut, torn) = (ball(&folder, "cut.stl", 0.0, 10.3), format!("torn={}", open.to_str().expect("text")));
    let (beyond, oblique) = (ball(&folder, "beyond.stl", 90.0, 9.0), ball(&folder, "oblique.stl", 9.4, 10.0));
    let crossing = "pass through the surface of across, first between nodes 1 and 2 at";
    let cases: [(&[&str], i32, &str); 24] = [
        (&["--tissue", "box", "--tissue-size", "1e-5"], 3, "tetrahedra, more than the limit of"),
        (&["--tissue", "box", "--tissue-size", "0.2", "--memory", "20MB"], 3, "give a larger --tissue-size"),
        (&["--tissue", "hull:-1"], 2, "invalid margin"),
        (&["--tissue", "hull:0.001"], 3, "the margin 0.001 of the hull is too small"),
        (&["--tissue", "box:0.1", "--wall", "0.5r"], 3, "give a wider margin"),
        (&["--tissue", "box", "--tissue-remesh"], 2, "nothing to remesh"),
        (&["--tissue", "box:20", "--tissue-region", &across], 3, crossing),
        (&["--tissue", "box", "--tissue-region", &far], 3, "in far, 162 points lie outside"),
        (&["--tissue", "hull:5", "--tissue-region", &far], 3, "in far, 162 points lie outside"),
        (
            &["--tissue", &organ, "--tissue-region", &apart, "--tissue-region", &beside],
            3,
            "surfaces of apart and beside meet",
        ),
        (&["--tissue", &organ, "--tissue-region", &torn], 3, "the surface of torn cannot be filled"),
        (&["--tissue", &organ, "--tissue-region", "wall"], 2, "give NAME=SURFACE"),
        (&["--tissue", &organ, "--tissue-region", "lumen=organ.stl"], 3, "organ.stl"),
        (&["--tissue", &cut, "--tissue-ends", "refuse"], 3, "pass through the surface of tissue, first between nodes"),
        (&["--tissue", &beyond], 3, "no vessel lies inside"),
        (&["--tissue", &oblique], 3, "cannot be opened for the vessel at"),
        (&["--wall", "thick"], 3, "thick"),
        (&["--wall", "0.2q"], 2, "unknown unit"),
        (&["--wall", "5um"], 2, "--units"),
        (&["--wall", "-0.1r"], 2, "invalid thickness of wall"),
        (&["--wall", "0.1r", "--without", "walls"], 2, "no region is called 'walls'"),
        (&["--split-regions"], 2, "needs several regions"),
        (
            &["--tissue", small.to_str().expect("text"), "--tissue-ends", "refuse"],
            3,
            "outside the surface around the tissue",
        ),
        (&["--tissue", open.to_str().expect("text")], 3, "cannot be filled"),
    ];
    for (options, code, needle) in cases {
        let done = mesh(&network, &out, options);
        assert_code(&done, code);
        assert!(stderr(&done).contains(needle), "{options:?}: {}", stderr(&done));
        assert!(!out.exists(), "{options:?}");
    }
}
