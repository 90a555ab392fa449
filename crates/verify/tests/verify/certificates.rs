//! Certificates: each changed claim is named, and all files of a mesh have a hash.

use super::common::{cuboid, tube, vtu};
use anastomesh_verify::{Demands, Mesh, certificate, verify};
use serde_json::{Value, json};
use std::path::Path;

/// Violations of each condition of certificates after a change of the certificate, seals excepted.
fn changed(mesh: &Mesh, change: impl FnOnce(&mut Value)) -> Vec<String> {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("m.vtu");
    std::fs::write(&file, vtu(mesh)).expect("a file");
    let mut report = verify(mesh, &Demands::default());
    let text = certificate::write(&report, &file, None, None).expect("a certificate");
    let mut value: Value = serde_json::from_str(&text).expect("JSON");
    change(&mut value);
    certificate::check(&value.to_string(), &file, None, None, &mut report).expect("a certificate");
    let claims = report.outcomes.iter().find(|outcome| outcome.condition.name() == "claims").expect("a condition");
    assert_eq!(claims.count.min(3), claims.first.len());
    claims.first.clone()
}

#[test]
fn every_changed_claim_is_named() {
    for name in ["points", "tets", "boundary_faces", "components", "genus"] {
        for by in [-1, 1] {
            let names =
                changed(&tube(), |c| c["figures"][name] = (c["figures"][name].as_i64().expect("one") + by).into());
            assert_eq!(names, [name]);
        }
    }
    for volume in [json!(null), json!(0.0), json!(-1.0), json!(9.0), json!(9.3)] {
        assert_eq!(changed(&tube(), |c| c["figures"]["volume"] = volume), ["volume"]);
    }
    assert_eq!(changed(&tube(), |c| c["valid"] = false.into()), ["valid"]);
    // A claim is that of the condition with its name. Others may be absent or unknown.
    let position = |c: &Value, name: &str| {
        let list = c["conditions"].as_array().expect("a list");
        list.iter().position(|claim| claim["name"] == name).expect("a claim")
    };
    let names = changed(&tube(), |c| {
        let at = position(c, "loops");
        c["conditions"][at]["violations"] = 1.into();
    });
    assert_eq!(names, ["loops"]);
    let names = changed(&tube(), |c| {
        let at = position(c, "loops");
        c["conditions"][at]["name"] = "knots".into();
        c["conditions"][at]["violations"] = 1.into();
    });
    assert_eq!(names, [""; 0]);
    // Programs without an expectation do not state the genus.
    assert_eq!(changed(&tube(), |c| c["figures"]["genus"] = Value::Null), [""; 0]);
}

#[test]
fn a_mesh_that_is_not_valid_has_a_certificate() {
    assert_eq!(changed(&Mesh::default(), |_| ()), [""; 0]);
    assert_eq!(changed(&Mesh::default(), |c| c["valid"] = true.into()), ["valid"]);
    let mut inverted = cuboid([2, 1, 1]);
    inverted.tets.iter_mut().for_each(|t| t.swap(0, 1));
    assert!(verify(&inverted, &Demands::default()).figures.volume < 0.0);
    assert_eq!(changed(&inverted, |_| ()), [""; 0]);
    assert_eq!(changed(&inverted, |c| c["figures"]["volume"] = json!(-2.1)), ["volume"]);
    assert_eq!(changed(&inverted, |c| c["figures"]["volume"] = json!(-1.9)), ["volume"]);
}

#[test]
fn a_certificate_has_the_names_and_the_figures() {
    let folder = tempfile::tempdir().expect("a folder");
    let [mesh, input] = ["m.vtu", "net.swc"].map(|name| folder.path().join(name));
    std::fs::write(&mesh, "abc").expect("a file");
    std::fs::write(&input, "").expect("a file");
    let report = verify(&tube(), &Demands::default());
    let text = certificate::write(&report, &mesh, Some(&input), None).expect("a certificate");
    let value: Value = serde_json::from_str(&text).expect("JSON");
    assert_eq!(value["format"], "anastomesh-certificate-1");
    // Hashes of FIPS 180-4.
    let abc = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
    assert_eq!(value["mesh"], json!({"file": "m.vtu", "sha256": abc}));
    let nothing = "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855";
    assert_eq!(value["input"], json!({"file": "net.swc", "sha256": nothing}));
    assert_eq!((&value["valid"], &value["figures"]["tets"]), (&true.into(), &144.into()));
    assert_eq!(value["conditions"].as_array().map(Vec::len), Some(25));
}

#[test]
fn hashes_cover_the_files_beside_a_mesh_of_tetgen() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = |name: &str| folder.path().join(name);
    for name in ["m.ele", "m.node", "m.vtu"] {
        std::fs::write(at(name), name).expect("a file");
    }
    assert_eq!(anastomesh_verify::files_of(&at("m.ele")), [at("m.ele"), at("m.node")]);
    assert_eq!(anastomesh_verify::files_of(&at("m.vtu")), [at("m.vtu")]);
    std::fs::write(at("m.face"), "").expect("a file");
    assert_eq!(anastomesh_verify::files_of(&at("m.ele")), [at("m.ele"), at("m.node"), at("m.face")]);
    let error = certificate::hash(&[at("m.ele"), at("none")]).expect_err("no file").to_string();
    assert!(error.contains("No such file"), "{error}");
}

#[test]
fn texts_of_another_format_are_errors() {
    let mut report = verify(&tube(), &Demands::default());
    let mut check = |text: &str| {
        certificate::check(text, Path::new("m.vtu"), None, None, &mut report).expect_err("no certificate").to_string()
    };
    assert_eq!(check("{"), "the certificate is not JSON");
    assert_eq!(check("{\"format\": 1}"), "the certificate does not have the format 'anastomesh-certificate-1'");
}
