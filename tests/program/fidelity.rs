//! Tests of the last line of a run and its exit code: they say whether the result represents the given network.

use crate::common::fixture;
use crate::common::program::*;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Output;
use tempfile::TempDir;

/// Rows of an SWC file, numbered from 11, that form polylines.
#[derive(Default)]
struct Swc {
    rows: String,
    count: usize,
}

impl Swc {
    /// Appends a line of points with a distance of at most `step`; returns the first and the last id.
    fn line(&mut self, from: [f64; 3], to: [f64; 3], radius: f64, step: f64, parent: Option<usize>) -> [usize; 2] {
        let way: Vec<f64> = from.iter().zip(to).map(|(a, b)| b - a).collect();
        let count = (way.iter().map(|d| d * d).sum::<f64>().sqrt() / step).ceil() as usize;
        let first = self.count + 11;
        for i in usize::from(parent.is_some())..=count {
            let at: Vec<f64> = (0..3).map(|k| from[k] + way[k] * i as f64 / count as f64).collect();
            let id = self.count + 11;
            let before = if id > first { Some(id - 1) } else { parent };
            let before = before.map_or("-1".to_owned(), |id| id.to_string());
            writeln!(self.rows, "{id} 0 {} {} {} {radius} {before}", at[0], at[1], at[2]).expect("text");
            self.count += 1;
        }
        [first, self.count + 10]
    }

    fn save(&self, folder: &TempDir, name: &str) -> PathBuf {
        let path = folder.path().join(name);
        fs::write(&path, &self.rows).expect("written");
        path
    }
}

/// Asserts the exit code and the last line of the messages.
#[track_caller]
fn ends(output: &Output, code: i32, start: &str) -> String {
    let said = stderr(output);
    assert_code(output, code);
    let last = said.lines().last().expect("a line");
    assert!(last.starts_with(start), "{start}: {said}");
    assert!(code == FINE || said.lines().all(|line| line != "valid"), "{said}");
    said
}

/// Helix of radius 1 around a circle, which rises by `rise` in .2 radians.
fn helix(folder: &TempDir, around: f64, rise: f64) -> PathBuf {
    let mut swc = Swc::default();
    let at = |i: u32| {
        let (sine, cosine) = (0.2 * f64::from(i)).sin_cos();
        [around * cosine, around * sine, rise * f64::from(i)]
    };
    for i in 0..150 {
        let parent = (i > 0).then(|| swc.count + 10);
        swc.line(at(i), at(i + 1), 1.0, 10.0, parent);
    }
    swc.save(folder, "helix.swc")
}

#[test]
fn windings_that_touch_are_one_lumen_and_the_verdict_says_so() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("a.vtu");
    let made = mesh(&helix(&folder, 1.47, 0.070_646), &out, &["--refine"]);
    let said = ends(&made, GATE_NOT_MET, "not faithful: separate vessels fused into one lumen in 1 block");
    assert!(said.contains("those that overlap or touch were meshed as one lumen"), "{said}");
    assert_code(&run("check", &[&out], &[]), FINE);
}

#[test]
fn windings_that_almost_touch_are_meshed_with_finer_edges() {
    let folder = tempfile::tempdir().expect("a folder");
    let made = mesh(&helix(&folder, 1.532_655, 0.069_735), &folder.path().join("a.vtu"), &["--refine"]);
    let said = ends(&made, FINE, "valid");
    assert!(said.contains("meshed with finer edges, rho 6"), "{said}");
}

/// Two thick vessels side by side, and a thin one from the first to the wall of the second, without space for a cap.
fn beside(folder: &TempDir) -> (PathBuf, usize) {
    let mut swc = Swc::default();
    let [_, fork] = swc.line([0.0, 0.0, -200.0], [0.0; 3], 2.0, 1.0, None);
    swc.line([0.0; 3], [0.0, 0.0, 200.0], 2.0, 1.0, Some(fork));
    let [_, tip] = swc.line([0.0; 3], [3.9, 0.0, 0.0], 0.25, 1.0, Some(fork));
    swc.line([6.0, 0.0, -200.0], [6.0, 0.0, 200.0], 2.0, 1.0, None);
    (swc.save(folder, "beside.swc"), tip)
}

#[test]
fn a_faithful_mesh_is_compared_in_four_rows() {
    let folder = folder();
    let out = folder.path().join("a.vtu");
    let made = mesh(&fixture("tree_30.swc"), &out, &["--refine"]);
    let said = ends(&made, FINE, "valid");
    let row =
        |label: &str| said.lines().find(|line| line.starts_with(label)).unwrap_or_else(|| panic!("{label}: {said}"));
    assert!(row("axis     ").contains("displaced by median 0 radii, 99 % 0, max 0"));
    assert!(row("radius   ").contains("section error median "));
    assert!(row("lumen    ").contains(", given network 200.8"));
    assert!(row("changes  ").ends_with("nothing moved, shrunk, fused or dropped"));
    assert!(said.contains("the network gives a valid mesh as it is: nothing was moved"), "{said}");
    let mut crossing = Swc::default();
    crossing.line([-20.0, 0.0, 0.0], [20.0, 0.0, 0.0], 2.0, 1.0, None);
    crossing.line([0.0, -20.0, 3.2], [0.0, 20.0, 3.2], 2.0, 1.0, None);
    let made = mesh(&crossing.save(&folder, "crossing.swc"), &out, &["--refine", "--allow-displaced"]);
    let said = ends(&made, FINE, "valid");
    let overlaps = said.lines().find(|line| line.starts_with("overlaps ")).unwrap_or_else(|| panic!("{said}"));
    assert!(overlaps.contains("0 edge pairs (") && overlaps.contains(" before refinement"), "{said}");
    let refined = run("refine", &[&fixture("tree_30.swc"), Path::new("-o"), &folder.path().join("b.vtp")], &[]);
    let said = ends(&refined, FINE, "no vessels overlap");
    assert!(
        ["\naxis     ", "\nradius   ", "\nlumen    ", "\nchanges  "].iter().all(|row| said.contains(row)),
        "{said}"
    );
}

#[test]
fn a_lumen_of_another_size_is_no_success() {
    let folder = folder();
    let (network, out) = (folder.path().join("close.swc"), folder.path().join("a.vtu"));
    // Two vessels within each other: apart, they have more volume than together.
    fs::write(&network, "1 0 0 0 0 1 -1\n2 0 30 0 0 1 1\n3 0 0 0.9 0 1 -1\n4 0 30 0.9 0 1 3\n").expect("written");
    ends(&mesh(&network, &out, &["--refine"]), GATE_NOT_MET, "not faithful: lumen ");
    let tree = fixture("tree_30.swc");
    let strict = mesh(&tree, &out, &["--max-lumen-error", "0.001"]);
    let said = ends(&strict, GATE_NOT_MET, "not faithful: lumen ");
    assert!(said.ends_with(" % larger than the given network (limit 0.1 %)\n"), "{said}");
    assert!(said.contains("\ncheck    all 24 conditions hold"), "{said}");
    let quiet = mesh(&tree, &out, &["--max-lumen-error", "0.001", "-q"]);
    let said = ends(&quiet, GATE_NOT_MET, "anastomesh: not faithful: lumen ");
    assert_eq!(said.lines().count(), 1, "{said}");
    let report = json(&mesh(&tree, &out, &["--max-lumen-error", "0.001", "--json", "-q"]));
    assert!(report["verdict"].as_str().is_some_and(|verdict| verdict.starts_with("not faithful: lumen ")));
    assert!(report["defects"][0]["lumen"]["bound"] == 0.001 && report["fidelity"]["lumen"].is_number());
    assert_says(&mesh(&tree, &out, &["--max-lumen-error", "-1"]), USAGE, &["--max-lumen-error -1", "at least 0"]);
    assert_says(&mesh(&tree, &out, &["--max-lumen-error", "abc"]), USAGE, &["expected a number"]);
}

#[test]
fn a_dropped_vessel_is_no_success_unless_allowed() {
    let folder = folder();
    let (network, tip) = beside(&folder);
    let out = folder.path().join("a.vtu");
    let made = mesh(&network, &out, &[]);
    let said = ends(&made, GATE_NOT_MET, "not faithful: ");
    let reason = format!(" radii of the vessel of tip {tip} dropped (limit 2)");
    assert!(said.lines().last().is_some_and(|line| line.ends_with(&reason)), "{said}");
    assert!(said.contains(&format!("1 vessel dropped or shortened, most at node {tip} (")), "{said}");
    assert!(said.contains("\n--allow-dropped accepts"), "{said}");
    let allowed = mesh(&network, &out, &["--allow-dropped"]);
    let said = ends(&allowed, FINE, "valid");
    assert!(said.contains("warning: accepted: ") && said.contains(&reason), "{said}");
    // A tip deep within the other vessel leaves the gap between both.
    let mut swc = Swc::default();
    let [_, fork] = swc.line([0.0, 0.0, -60.0], [0.0; 3], 2.0, 1.0, None);
    swc.line([0.0; 3], [0.0, 0.0, 60.0], 2.0, 1.0, Some(fork));
    let [_, deep] = swc.line([0.0; 3], [5.5, 0.0, 0.0], 0.25, 1.0, Some(fork));
    swc.line([6.0, 0.0, -60.0], [6.0, 0.0, 60.0], 2.0, 1.0, None);
    let said = ends(&mesh(&swc.save(&folder, "deep.swc"), &out, &[]), GATE_NOT_MET, "not faithful: ");
    assert!(said.contains(&format!(" radii of the vessel of tip {deep} dropped (limit 2)")), "{said}");
    // Refinement moves the vessels apart instead.
    let said = ends(&mesh(&network, &out, &["--refine"]), FINE, "valid");
    assert!(
        said.contains(&format!("tip {tip} at edge ")) && said.contains("kept, as too much of its vessel"),
        "{said}"
    );
    assert_code(&run("refine", &[&network, Path::new("-o"), &folder.path().join("b.vtp")], &["-q"]), FINE);
}

#[test]
fn a_tip_that_its_own_length_gives_no_room_is_joined_to_its_parent() {
    let folder = folder();
    let mut swc = Swc::default();
    let [_, fork] = swc.line([0.0, 0.0, -15.0], [0.0; 3], 1.0, 0.5, None);
    swc.line([0.0; 3], [0.0, 0.0, 15.0], 1.0, 0.5, Some(fork));
    let [_, tip] = swc.line([0.0; 3], [1.0, 0.0, 1.4], 1.0, 0.3, Some(fork));
    let (network, out) = (swc.save(&folder, "stub.swc"), folder.path().join("a.vtu"));
    let made = mesh(&network, &out, &["--keep-spurs", "--keep-doubles"]);
    let said = ends(&made, FINE, "valid");
    assert!(
        said.contains(&format!("tip {tip} from node {fork}: length 1.7205: removed, as its cap needs length")),
        "{said}"
    );
    assert!(said.contains(&format!("1 vessel dropped or shortened, most at node {tip} (0 radii outside")), "{said}");
}

/// An invalid mesh has its reason in the last line, and nothing else with `--quiet`.
#[test]
fn an_invalid_mesh_says_why_in_its_last_line() {
    let folder = folder();
    let (network, out) = (folder.path().join("crossed.swc"), folder.path().join("a.vtu"));
    fs::write(&network, "11 0 0 0 0 1 -1\n12 0 0 0 20 1 11\n13 0 -10 0 10 1 -1\n14 0 10 0.5 10 1 13\n")
        .expect("written");
    let said = ends(&mesh(&network, &out, &[]), GATE_NOT_MET, "NOT valid: the boundary intersects itself at ");
    assert_eq!(said.matches("edges 11-12 and 13-14: distance").count(), 1, "{said}");
    let quiet = stderr(&mesh(&network, &out, &["-q"]));
    assert!(quiet.lines().count() == 1 && quiet.starts_with("anastomesh: NOT valid: the boundary "), "{quiet}");
    let checked = run("check", &[&out], &["-q"]);
    assert_code(&checked, GATE_NOT_MET);
    assert!(stdout(&checked).is_empty() && stderr(&checked).lines().count() == 1, "{}", stderr(&checked));
    let parted = ends(&mesh(&network, &out, &["--refine"]), FINE, "valid");
    assert!(
        parted.contains("\noverlaps 0 edge pairs (1 before refinement)\n") && parted.contains(" moved, most at node 1"),
        "{parted}"
    );
}

/// Every command that writes something ends with its verdict.
#[test]
fn the_last_line_is_the_verdict_of_every_command() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    let (tree, o) = (fixture("tree_30.swc"), Path::new("-o"));
    ends(&run("prepare", &[&fixture("measured.swc"), o, &at("p.vtp")], &[]), FINE, "repaired");
    ends(&run("prepare", &[&tree, o, &at("p.vtp")], &["--as-is"]), FINE, "no repair needed");
    ends(&run("surface", &[&tree, o, &at("s.off")], &[]), FINE, "valid");
    ends(&run("convert", &[&at("s.off"), o, &at("s.stl")], &[]), FINE, "converted");
    ends(&fill(&at("s.off"), &at("s.vtu"), &[]), FINE, "meshed");
    ends(&fill(&at("s.off"), &at("s.vtu"), &["--check-only"]), FINE, "no fault found");
}

/// `info` describes networks that `mesh` would repair, and names nodes as the file does.
#[test]
fn info_shows_networks_without_some_radii() {
    let folder = folder();
    let network = folder.path().join("holes.swc");
    fs::write(&network, "5 0 0 0 0 2 -1\n6 0 0 0 30 0 5\n7 0 0 0 60 2 6\n8 0 1 0 30 2 -1\n9 0 40 0 30 2 8\n")
        .expect("written");
    let info = run("info", &[&network], &[]);
    assert_code(&info, FINE);
    let said = stdout(&info);
    assert!(said.contains("nodes: 5 (4 terminals)"), "{said}");
    assert!(said.contains("repairs: 1 node with a missing or implausible radius; `mesh` fills it"), "{said}");
    assert!(said.contains("  5-6 and 8-9: distance") || said.contains("  6-7 and 8-9: distance"), "{said}");
    assert!(
        said.contains("unit: not in the file; the sizes are those of vessels in micrometres (median radius 2 µm"),
        "{said}"
    );
    assert!(stdout(&run("info", &[&network], &["--units", "mm"])).contains("unit: mm (--units)"));
    assert_eq!(json(&run("info", &[&network], &["--json"]))["nodes_without_radius"], 1);
}
