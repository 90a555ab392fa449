//! Command line tests of `view`: one page, rendered by a browser.

use crate::common::fixture;
use crate::common::oracle::missing;
use crate::common::program::*;
use anastomesh::io::{MeshNotes, write_mesh};
use anastomesh::mesh::shapes::walled_channel;
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn view(input: &Path, out: &Path, options: &[&str]) -> Output {
    run("view", &[input, Path::new("--output"), out], options)
}

/// Metadata of the page.
#[track_caller]
fn facts(path: &Path) -> Value {
    let html = fs::read_to_string(path).expect("a page");
    for outside in ["http:", "https:", "src=", "@import", "import("] {
        assert!(!html.contains(outside), "{outside}");
    }
    let start = html.find("id=\"facts\">").expect("facts") + 11;
    let end = start + html[start..].find("</script>").expect("their end");
    serde_json::from_str(&html[start..end]).expect("JSON")
}

#[test]
fn a_mesh_a_network_and_a_surface_become_pages() {
    let folder = folder();
    let [tree, page] = ["a<b>.vtu", "p.html"].map(|name| folder.path().join(name));
    let network = fixture("tree_30.vtp");
    assert_code(&mesh(&network, &tree, &["-q"]), FINE);
    assert_code(&view(&tree, &page, &["--network", network.to_str().expect("a path")]), FINE);
    let known = facts(&page);
    let volume = anastomesh::io::read_mesh(&tree).expect("a mesh").volume;
    assert_eq!(known["title"], "a<b>.vtu");
    assert_eq!(known["wall"]["exact"], true);
    assert_eq!(known["wall"]["faces"], volume.boundary.len());
    assert_eq!(known["tets"]["shown"], volume.mesh.tets.len());
    assert_eq!(known["network"]["edges"], 29);
    assert_eq!(known["patches"].as_array().map(Vec::len), Some(volume.patches.len()));
    assert_eq!((&known["faults"], &known["unit"]), (&Value::Array(Vec::new()), &Value::Null));
    assert_eq!(known["check"]["verdict"], "valid");
    assert!(fs::metadata(&page).expect("a page").len() < 1_000_000);
    assert_code(&view(&tree, &page, &["-q", "--no-check", "--units", "um:mm"]), FINE);
    assert_eq!((&facts(&page)["check"]["verdict"], &facts(&page)["unit"]), (&"not_checked".into(), &"mm".into()));
    assert_code(&view(&network, &page, &["-q"]), FINE);
    assert!(facts(&page)["wall"].is_null() && facts(&page)["network"]["orders"].as_u64() > Some(2));
    assert_code(&view(&fixture("torus.off"), &page, &["-q"]), FINE);
    assert!(facts(&page)["network"].is_null() && facts(&page)["tets"]["all"] == 0);
}

#[test]
fn regions_are_listed_with_their_interfaces() {
    let folder = folder();
    let (volume, regions) = walled_channel(1);
    let path = folder.path().join("organ.vtu");
    write_mesh(&path, &volume, &MeshNotes { regions, ..MeshNotes::default() }).expect("a file");
    let page = folder.path().join("organ.html");
    assert_code(&view(&path, &page, &[]), FINE);
    let facts = facts(&page);
    assert_eq!(facts["regions"][1], serde_json::json!({ "id": 2, "name": "wall" }));
    let beyond: Vec<_> = facts["patches"].as_array().expect("patches").iter().map(|patch| &patch["beyond"]).collect();
    // Inlet, outlet and both interfaces.
    assert_eq!(beyond[..4], [&Value::Null, &Value::Null, &2.into(), &3.into()]);
    assert_eq!(facts["check"]["verdict"], "no_fault_found");
}

#[test]
fn a_work_directory_is_viewed_as_the_mesh_that_came_of_it() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    let work = |name: &str| at(name).to_str().expect("a path").to_owned();
    assert_code(&mesh(&fixture("tree_30.vtp"), &at("tree.vtu"), &["-q", "--work-dir", &work("w")]), FINE);
    assert_code(&view(&at("w"), &at("w.html"), &["-q"]), FINE);
    assert_code(&view(&at("tree.vtu"), &at("tree.html"), &["-q"]), FINE);
    let [left, written] = ["w.html", "tree.html"].map(|name| facts(&at(name)));
    for fact in ["wall", "tets", "patches", "arrays", "faults"] {
        assert_eq!(left[fact], written[fact], "{fact}");
    }
    let draw = |input: &str, out: &str| {
        let out = at(out);
        assert_code(&run("render", &[&at(input), Path::new("-o"), &out], &["-q", "--size", "120x90"]), FINE);
        fs::read(out).expect("a picture")
    };
    assert!(draw("w", "w.png") == draw("tree.vtu", "tree.png"));
    // Available parts of a failed run, and the positions of failures.
    fs::write(at("h.vtp"), HOPELESS).expect("written");
    assert_code(&mesh(&at("h.vtp"), &at("h.vtu"), &["-q", "--work-dir", &work("v")]), STAGE_FAILED);
    assert_code(&view(&at("v"), &at("v.html"), &["-q", "--dump-dir", &work("h.vtu.failed")]), FINE);
    let failed = facts(&at("v.html"));
    assert!(failed["wall"]["faces"].as_u64() > Some(50) && failed["faults"].as_array().map(Vec::len) == Some(1));
    // Missing blocks are not a mesh.
    fs::remove_file(at("w").join("anastomesh.blocks")).expect("removed");
    assert_says(&view(&at("w"), &at("w.html"), &[]), BAD_INPUT, &["w", "No such file"]);
    fs::remove_file(at("w").join("anastomesh.whole")).expect("removed");
    assert_says(&view(&at("w"), &at("w.html"), &[]), BAD_INPUT, &["work directory"]);
}

#[test]
fn the_bytes_do_not_depend_on_the_threads() {
    let folder = folder();
    let tree = folder.path().join("tree.vtu");
    assert_code(&mesh(&fixture("tree_30.vtp"), &tree, &["-q"]), FINE);
    let [one, two] = ["1", "2"].map(|threads| {
        let out = folder.path().join(threads).with_extension("html");
        assert_code(&view(&tree, &out, &["-j", threads, "-q"]), FINE);
        fs::read(out).expect("a file")
    });
    assert!(one == two);
}

#[test]
fn faults_are_listed() {
    let folder = folder();
    let [network, page] = ["h.vtp", "h.html"].map(|name| folder.path().join(name));
    fs::write(&network, HOPELESS).expect("written");
    assert_code(&mesh(&network, &folder.path().join("m.vtu"), &["-q"]), STAGE_FAILED);
    let dumps = folder.path().join("m.vtu.failed");
    assert_code(&view(&network, &page, &["--dump-dir", dumps.to_str().expect("a path")]), FINE);
    let faults = &facts(&page)["faults"];
    let group = faults.as_array().expect("a list").iter().find(|group| group["kind"] == "blocks not meshed");
    let failed = group.map(|group| &group["faults"][0]).expect("a failed block");
    assert!(failed["what"].as_str().is_some_and(|what| what.contains("cluster")));
    let place = failed["place"][0].as_f64().expect("a position");
    assert!((place - 50.0).abs() < 5.0, "{faults}");
}

#[test]
fn what_cannot_be_viewed_is_said() {
    let folder = folder();
    let page = folder.path().join("p.html");
    let network = fixture("tree_30.swc");
    assert_says(&view(&network, &folder.path().join("p.txt"), &[]), BAD_INPUT, &["p.txt", ".html"]);
    assert_says(&view(&network, &folder.path().join("no/p.html"), &[]), BAD_INPUT, &["cannot be written"]);
    assert_says(&view(&folder.path().join("absent.vtu"), &page, &[]), BAD_INPUT, &["absent.vtu"]);
    assert_says(&view(&network, &page, &["--dump-dir", "absent"]), BAD_INPUT, &["absent", "cannot be read"]);
    assert!(entries(folder.path()).is_empty());
}

/// Writes a mesh of which `count` tetrahedra are inverted.
fn write_inverted(folder: &Path, count: usize) -> PathBuf {
    let [tree, broken] = ["tree.mesh", "broken.mesh"].map(|name| folder.join(name));
    assert_code(&mesh(&fixture("tree_30.vtp"), &tree, &["-q"]), FINE);
    let text = fs::read_to_string(&tree).expect("a mesh");
    let mut lines: Vec<String> = text.lines().map(Into::into).collect();
    let first = lines.iter().position(|l| l.trim() == "Tetrahedra").expect("tetrahedra") + 2;
    for line in &mut lines[first..first + count] {
        let mut words: Vec<&str> = line.split_whitespace().collect();
        words.swap(0, 1);
        *line = words.join(" ");
    }
    fs::write(&broken, lines.join("\n")).expect("written");
    broken
}

#[test]
fn every_fault_of_an_invalid_mesh_is_listed_and_reachable() {
    const COUNT: usize = 176;
    let folder = folder();
    let page = folder.path().join("p.html");
    assert_code(&view(&write_inverted(folder.path(), COUNT), &page, &["-q"]), FINE);
    let known = facts(&page);
    let of = |words: &str| {
        let groups = known["faults"].as_array().expect("groups").iter();
        groups.filter(|g| g["kind"].as_str().is_some_and(|kind| kind.contains(words))).collect::<Vec<_>>()
    };
    let [positive] = of("tetrahedra are inverted or flat")[..] else { panic!("{}", known["faults"]) };
    assert_eq!(known["check"]["verdict"], "invalid");
    assert_eq!(
        (positive["count"].as_u64(), positive["faults"].as_array().map(Vec::len)),
        (Some(COUNT as u64), Some(COUNT))
    );
    let sizes: Vec<usize> =
        of("").iter().filter_map(|g| g["faults"].as_array()).map(Vec::len).filter(|&n| n > 0).collect();
    let Some(html) = shown(&page, "fault=2") else {
        return missing("no browser was found (apt-get install chromium)");
    };
    assert!(html.contains("role=\"status\" class=\"\">NOT valid: "), "no banner");
    // One tab stop per list, from which arrow keys lead to the other faults.
    let stops = |index: &str| html.matches(&format!("<li><button type=\"button\" tabindex=\"{index}\"")).count();
    assert_eq!((stops("0"), stops("-1")), (sizes.len(), sizes.iter().map(|n| n - 1).sum()));
    assert_eq!(html.matches("aria-current=\"true\"").count(), 1);
    assert!(html.contains("<output id=\"pick\">failed: 176 tetrahedra are inverted or flat\ntetrahedron 1\nat "));
}

/// Page rendered by a browser with a fragment in its address; `None` without a browser.
fn shown(page: &Path, fragment: &str) -> Option<String> {
    let address = format!("file://{}#{fragment}", page.display());
    let browser = ["chromium", "chromium-browser", "google-chrome"]
        .into_iter()
        .find(|name| Command::new(name).arg("--version").output().is_ok_and(|o| o.status.success()))?;
    let switches = ["--headless", "--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"];
    let time = ["--window-size=800,600", "--virtual-time-budget=20000", "--enable-logging=stderr", "--dump-dom"];
    let made = Command::new(browser).args(switches).args(time).arg(address).output().ok()?;
    let said = stderr(&made);
    assert!(!said.lines().any(|l| l.contains("CONSOLE") && l.contains("rror")), "{said}");
    Some(stdout(&made))
}

#[test]
fn a_browser_shows_it_and_names_what_is_there() {
    let folder = folder();
    let [tree, page] = ["tree.vtu", "p.html"].map(|name| folder.path().join(name));
    let network = fixture("tree_30.vtp");
    assert_code(&mesh(&network, &tree, &["-q"]), FINE);
    let volume = anastomesh::io::read_mesh(&tree).expect("a mesh").volume;
    let cap = volume.patches[1].cap.expect("the inlet");
    let inside = cap.center - cap.normal * cap.radius;
    assert_code(&view(&tree, &page, &["-q", "--network", network.to_str().expect("a path")]), FINE);
    let at = format!("at={},{},{}", inside.x, inside.y, inside.z);
    let Some(html) = shown(&page, &at) else {
        return missing("no browser was found (apt-get install chromium)");
    };
    assert!(html.contains("data-ready=") && !html.contains("id=\"loading\""));
    assert!(html.contains("✓ valid") && html.contains("role=\"status\" hidden"));
    let triad = html.split("<g class=").skip(1).filter(|axis| axis.contains("x2=") && axis.contains("</text>"));
    assert_eq!(triad.count(), 3);
    let bar = html.split_once("aria-label=\"Scale bar: ").expect("a scale bar").1;
    let length: f64 = bar.split_once('"').and_then(|(length, _)| length.parse().ok()).expect("its length");
    assert!(length > 0.0 && html.contains("clipped tetrahedra"));
    for word in ["patch 1: wall", "block ", "vessel (branch)", "nearest node", "radius "] {
        assert!(html.contains(word), "'{word}'");
    }
    assert_code(&view(&network, &page, &["-q"]), FINE);
    let html = shown(&page, &at).expect("a browser");
    assert!(html.contains("vessel (branch)") && html.contains("data-ready="));
}

#[test]
fn arrays_of_a_network_are_colours() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    let (flow, tree, page) = (at("flow.vtp"), at("tree.vtu"), at("p.html"));
    let network = flow.to_str().expect("a path");
    assert_code(
        &run("flow", &[&fixture("tree_30.vtp"), Path::new("--output"), &flow], &["-q", "--inflow", "1e-3"]),
        FINE,
    );
    assert_code(&mesh(&fixture("tree_30.vtp"), &tree, &["-q"]), FINE);
    assert_code(&view(&flow, &page, &["-q", "--data", "Flow:mm3/s"]), FINE);
    let data = &facts(&page)["data"];
    assert_eq!((&data["name"], &data["unit"]), (&"Flow".into(), &"mm3/s".into()));
    assert_eq!(data["scale"]["high"], 1e-3);
    assert_code(&view(&tree, &page, &["-q", "--network", network, "--data", "WallShear:Pa"]), FINE);
    let known = facts(&page);
    let arrays = known["arrays"].as_array().expect("arrays");
    let count = |name: &str| arrays.iter().find(|a| a["name"] == name).map(|a| a["count"].clone());
    assert!(count("edgeValue") == Some(58.into()) && count("value0") == count("radius0"));
    let inlet = anastomesh::io::read_mesh(&tree).expect("a mesh").volume.patches[1].cap.expect("the inlet");
    let inside = inlet.center - inlet.normal * inlet.radius;
    if let Some(html) = shown(&page, &format!("at={},{},{}", inside.x, inside.y, inside.z)) {
        assert!(html.contains("<option value=\"value\">WallShear</option>") && html.contains("WallShear in Pa"));
        assert!(html.contains("\nWallShear ") && html.contains(" Pa\n"), "no value where the page was opened");
    }
    assert_says(&view(&tree, &page, &["--data", "Flow"]), USAGE, &["--network NETWORK"]);
    assert_says(&view(&flow, &page, &["--data", "Speed"]), BAD_INPUT, &["'Speed'", "Pressure, ", "WallShear"]);
    assert_says(&view(&fixture("tree_30.swc"), &page, &["--data", "Flow"]), USAGE, &["SWC has no named arrays"]);
}
