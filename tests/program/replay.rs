//! Command line tests of `replay`: blocks that fail again, blocks that succeed, and invalid dumps.

use crate::common::program::*;
use serde_json::{Value, json as value};
use std::fs;
use std::path::{Path, PathBuf};

/// Dump of a network with a hopeless vessel.
fn failing(folder: &Path) -> PathBuf {
    let network = folder.join("hopeless.vtp");
    fs::write(&network, HOPELESS).expect("a file");
    assert_code(&mesh(&network, &folder.join("out.vtu"), &["-q"]), STAGE_FAILED);
    let dumps = folder.join("out.vtu.failed");
    let [name] = &entries(&dumps)[..] else { panic!("one dump") };
    dumps.join(name)
}

/// Modified copy of a dump.
fn changed(dump: &Path, name: &str, change: impl FnOnce(&mut Value)) -> PathBuf {
    let mut content = serde_json::from_slice(&fs::read(dump).expect("the dump")).expect("JSON");
    change(&mut content);
    let path = dump.with_file_name(name);
    fs::write(&path, content.to_string()).expect("a file");
    path
}

/// Replaces the bifurcation by a straight vessel.
fn thicken(content: &mut Value) {
    let tube = |a: f64, b: f64| value!({"a": [50.0, 0.0, a], "b": [50.0, 0.0, b], "ra": 1.0, "rb": 1.0});
    let end = |z: f64, way: f64, node: u32| {
        let section = value!({"origin": [50.0, 0.0, z], "axis": [0.0, 0.0, way], "radius": 1.0});
        value!({"section": section, "kind": {"terminal": node}, "overrun": node - 1})
    };
    let cluster = &mut content["input"]["cluster"]["cluster"];
    cluster["tubes"] = value!([tube(0.0, 9.0), tube(0.0, -1.0), tube(9.0, 10.0)]);
    cluster["ends"] = value!([end(0.0, -1.0, 2), end(9.0, 1.0, 3)]);
}

#[test]
fn a_block_fails_again_in_the_same_place() {
    let folder = folder();
    let dump = failing(folder.path());
    let out = folder.path().join("block.vtu");
    let again = run("replay", &[&dump, Path::new("-o"), &out], &[]);
    assert_says(&again, STAGE_FAILED, &["cluster 2 (nodes [2, 3, 4, 5])", "'wall'", "grid cells, more than the limit"]);
    assert!(!out.exists());
    let again = run("replay", &[&dump], &["--json"]);
    assert_code(&again, STAGE_FAILED);
    let said = json(&again);
    assert_eq!((&said["block"], &said["nodes"]), (&"cluster 2".into(), &value!([2, 3, 4, 5])));
    assert_eq!((&said["failed"]["stage"], &said["mesh"]), (&"wall".into(), &Value::Null));
    assert!(said["written_by"].as_str().is_some_and(|by| by.starts_with("anastomesh ")));
}

#[test]
fn a_block_that_comes_out_is_written_on_request() {
    let folder = folder();
    let dump = changed(&failing(folder.path()), "thick.json", thicken);
    assert_says(&run("replay", &[&dump], &[]), FINE, &["was meshed", "tetrahedra", "-o MESH"]);
    for name in ["block.vtu", "block.msh"] {
        let out = folder.path().join(name);
        let made = run("replay", &[&dump, Path::new("-o"), &out], &["--json"]);
        assert_code(&made, FINE);
        assert!(json(&made)["mesh"]["tets"].as_u64() > Some(100) && json(&made)["failed"].is_null());
        let patches = anastomesh::io::read_mesh(&out).expect("a mesh").volume.patches;
        assert_eq!(patches.iter().map(|p| p.name.as_str()).collect::<Vec<_>>(), ["wall", "terminal_2", "terminal_3"]);
        let checked = run("check", &[&out], &[]);
        assert_code(&checked, FINE);
    }
}

#[test]
fn a_connector_without_its_clusters_is_made_again() {
    let folder = folder();
    let section = |z: f64| value!({"origin": [0.0, 0.0, z], "axis": [0.0, 0.0, 1.0], "radius": 1.0});
    let cut = value!({"branch": 0, "sides": [[0, 0], [1, 0]], "path": [section(0.0), section(3.0)]});
    let first = failing(folder.path());
    let dump = |name: &str, cut: Value| {
        changed(&first, name, |content| {
            content["input"] = value!({"free_connector": {"id": 7, "cut": cut}});
        })
    };
    let out = folder.path().join("block.vtu");
    let good = dump("good.json", cut.clone());
    assert_says(&run("replay", &[&good, Path::new("-o"), &out], &[]), FINE, &["connector 7"]);
    assert_code(&run("check", &[&out], &[]), FINE);
    for path in [value!([]), value!([section(0.0)]), value!([section(0.0), section(0.0)])] {
        let mut short = cut.clone();
        short["path"] = path;
        assert_says(&run("replay", &[&dump("short.json", short)], &[]), STAGE_FAILED, &["connector 7", "'wall'"]);
    }
}

#[test]
fn what_is_no_dump_is_refused_with_what_to_do() {
    let folder = folder();
    let dump = failing(folder.path());
    let whole = fs::read(&dump).expect("the dump");
    let other = folder.path().join("other.json");
    let refused = |path: &Path, words: &[&str]| {
        let refused = run("replay", &[path], &[]);
        assert_code(&refused, BAD_INPUT);
        assert_message(&refused, path, words);
    };
    for length in [0, 1, whole.len() / 3, whole.len() - 1] {
        fs::write(&other, &whole[..length]).expect("a file");
        refused(&other, &["truncated", "run `mesh` again"]);
    }
    for text in [&b"[1, 2]"[..], b"It was the best of times", b"\xff\xfe", b"{\"format\": \"new\"}", b"7"] {
        fs::write(&other, text).expect("a file");
        refused(&other, &["not a block dump", "MESH.failed"]);
    }
    refused(&folder.path().join("missing.json"), &["cannot be read"]);
    refused(folder.path(), &["cannot be read"]);
    let without =
        changed(&dump, "without.json", |content| drop(content.as_object_mut().expect("a map").remove("format")));
    refused(&without, &["the format version is missing"]);
    let newer = changed(&dump, "newer.json", |content| {
        content["format"] = 99.into();
        content["program"] = "anastomesh 9.9".into();
        content["input"] = Value::Null;
    });
    refused(&newer, &["format version 99", "anastomesh 9.9", "run `mesh` again"]);
}

#[test]
fn numbers_that_no_block_has_are_refused() {
    let folder = folder();
    let dump = failing(folder.path());
    let refused = |pointer: &str, number: Value, words: &[&str]| {
        let path = changed(&dump, "absurd.json", |content| {
            thicken(content);
            *content.pointer_mut(pointer).expect("a place") = number;
        });
        let refused = run("replay", &[&path], &[]);
        assert_code(&refused, BAD_INPUT);
        assert_message(&refused, &path, words);
    };
    let cluster = "/input/cluster/cluster";
    refused("/params/rho", (-3.0).into(), &["rho", "which is out of range"]);
    refused("/params/rho", 1e9.into(), &["--memory"]);
    refused("/params/voxel_factor", 1e-9.into(), &["--memory"]);
    refused("/params/first_division", 1000.into(), &["first_division"]);
    refused(&format!("{cluster}/tubes/0/ra"), 0.0.into(), &["a radius is 0"]);
    refused(&format!("{cluster}/tubes/0/ra"), Value::Null, &["not a block dump"]);
    refused(&format!("{cluster}/tubes/0/a"), value!([1e300, 0.0, 0.0]), &["a point lies at"]);
    refused(&format!("{cluster}/ends/0/section/axis"), value!([0.0, 0.0, 0.0]), &["an axis has the length 0"]);
    refused(&format!("{cluster}/ends/0/overrun"), 77.into(), &["tube 77 of 3"]);
    refused(&format!("{cluster}/ends/0/kind"), value!({"cut": {"cut": 0, "side": 2}}), &["side"]);
    // Faults beyond the file format belong to the block, and are reported by a stage.
    let path = changed(&dump, "empty.json", |content| content["input"]["cluster"]["cluster"]["tubes"] = value!([]));
    assert_code(&run("replay", &[&path], &[]), BAD_INPUT);
}
