//! The program: readers, exit codes, certificates.

use super::common::{cuboid, label, tube, vtu};
use std::fmt::Write as _;
use std::path::Path;
use std::process::Command;

/// Standard output and exit code.
fn run(dir: &Path, words: &[&str]) -> (String, Option<i32>) {
    let out =
        Command::new(env!("CARGO_BIN_EXE_anastomesh-verify")).current_dir(dir).args(words).output().expect("it runs");
    let text = String::from_utf8_lossy(&out.stdout).into_owned() + &String::from_utf8_lossy(&out.stderr);
    (text, out.status.code())
}

fn write(dir: &Path, name: &str, text: impl AsRef<[u8]>) {
    std::fs::write(dir.join(name), text).expect("a writable folder");
}

#[test]
fn a_line_per_mesh() {
    let folder = tempfile::tempdir().expect("a folder");
    let dir = folder.path();
    write(dir, "good.vtu", vtu(&tube()));
    let mut bad = tube();
    bad.tets[3].swap(0, 1);
    write(dir, "bad.vtu", vtu(&bad));
    write(dir, "cut.vtu", &vtu(&tube())[..900]);
    write(dir, "list", "good.vtu\nbad.vtu\n");
    let valid = "good.vtu: valid: tetrahedra 144, boundary faces 128, components 1, genus 0, conditions 25\n";
    assert_eq!(run(dir, &["good.vtu"]), (valid.into(), Some(0)));
    let (text, code) = run(dir, &["--list", "list"]);
    assert!(text.starts_with(valid) && code == Some(1));
    assert!(text.contains("bad.vtu: NOT valid: positive_tets: inverted or flat tetrahedra: 1 (3); opposite_sides"));
    let (text, code) = run(dir, &["good.vtu", "cut.vtu", "missing.vtu"]);
    assert!(text.contains("cut.vtu: unreadable: ") && text.contains("missing.vtu: unreadable: ") && code == Some(3));
    let (text, code) = run(dir, &["--json", "bad.vtu"]);
    assert!(text.contains("\"file\":\"bad.vtu\"") && text.contains("\"valid\":false") && code == Some(1));
    assert_eq!(run(dir, &["--colour"]).1, Some(2));
    assert_eq!(run(dir, &[]).1, Some(2));
}

#[test]
fn bad_arguments_have_a_reason() {
    let folder = tempfile::tempdir().expect("a folder");
    let dir = folder.path();
    write(dir, "one", "b.vtu\n");
    write(dir, "empty", "\n");
    let number = "for '--tolerance <R>': a positive number is needed";
    for (words, reason) in [
        (&["--colour", "m.vtu"][..], "unexpected argument '--colour' found"),
        (&["m.vtu", "--tolerance", "0"], &format!("invalid value '0' {number}")),
        (&["m.vtu", "--tolerance", "much"], &format!("invalid value 'much' {number}")),
        (&["m.vtu", "--tolerance"], "a value is required for '--tolerance <R>' but none was supplied"),
        (&["a.vtu", "b.vtu", "--certificate", "c.json"], "a certificate belongs to one mesh"),
        (&["a.vtu", "b.vtu", "--write-certificate", "c.json"], "a certificate belongs to one mesh"),
        (&["a.vtu", "--list", "one", "--certificate", "c.json"], "a certificate belongs to one mesh"),
        (&["--json"], "the following required arguments were not provided:\n  <MESH>..."),
        (&["--list", "empty"], "no mesh"),
        (&["--list", "none"], "invalid value 'none' for '--list <FILE>': No such file or directory (os error 2)"),
    ] {
        let (text, code) = run(dir, words);
        assert_eq!((text.starts_with(&format!("error: {reason}\n")), code), (true, Some(2)), "{text}");
        assert!(text.contains("'--help'"), "{text}");
    }
    let (text, code) = run(dir, &["m.vtu", "--help"]);
    assert!(text.starts_with("Check tetrahedral meshes, ") && text.ends_with("3 unreadable file\n") && code == Some(0));
    let version = format!("anastomesh-verify {}\n", env!("CARGO_PKG_VERSION"));
    for word in ["-V", "--version"] {
        assert_eq!(run(dir, &[word]), (version.clone(), Some(0)));
    }
    assert_eq!(run(dir, &["-h"]), (text, Some(0)));
}

#[test]
fn unreadable_files_are_named() {
    let folder = tempfile::tempdir().expect("a folder");
    let dir = folder.path();
    write(dir, "m.vtu", vtu(&tube()));
    let none = "No such file or directory (os error 2)";
    let json = format!("{{\"error\":\"{none}\",\"file\":\"a.vtu\"}}\n");
    assert_eq!(run(dir, &["--json", "a.vtu"]), (json, Some(3)));
    write(dir, "list", "\nm.vtu\n\na.vtu\n");
    let (text, code) = run(dir, &["--list", "list"]);
    assert_eq!((text.lines().count(), code), (2, Some(3)), "{text}");
    assert!(text.ends_with(&format!("\na.vtu: unreadable: {none}\n")), "{text}");
    for words in [&["--key", "none"][..], &["--certificate", "none"]] {
        let text = format!("m.vtu: unreadable: none: {none}\n");
        assert_eq!(run(dir, &[&["m.vtu"], words].concat()), (text, Some(3)));
    }
    let (text, code) = run(dir, &["m.vtu", "--write-certificate", "none/c.json"]);
    assert_eq!((text, code), (format!("m.vtu: unreadable: none/c.json: {none}\n"), Some(3)));
    for option in ["--surface", "--network"] {
        assert_eq!(run(dir, &["m.vtu", option, "none"]), (format!("error: none: {none}\n"), Some(3)));
    }
}

/// Gmsh's formats and TetGen's files of a cube of six tetrahedra.
#[test]
fn other_formats() {
    let folder = tempfile::tempdir().expect("a folder");
    let dir = folder.path();
    let mut mesh = cuboid([1, 1, 1]);
    label(&mut mesh, &|_| 1);
    for is_sound in [true, false] {
        if !is_sound {
            mesh.triangles[2].swap(0, 1);
        }
        write(dir, "m2.msh", msh_2(&mesh));
        write(dir, "m4.msh", msh_4(&mesh, false));
        write(dir, "m4b.msh", msh_4(&mesh, true));
        tetgen(dir, &mesh);
        for name in ["m2.msh", "m4.msh", "m4b.msh", "m.ele"] {
            let (text, code) = run(dir, &[name]);
            // TetGen's faces have no direction.
            let is_valid = is_sound || name == "m.ele";
            assert_eq!(code, Some(i32::from(!is_valid)), "{text}");
            assert_eq!(text.contains("labels_match_boundary: differences"), !is_valid, "{text}");
        }
    }
    let cut = msh_4(&mesh, true);
    write(dir, "cut.msh", &cut[..cut.len() - 200]);
    assert_eq!(run(dir, &["cut.msh"]).1, Some(3));
    write(dir, "m.ele", "6 4 0\n0 1 2 3 4\n");
    assert_eq!(run(dir, &["m.ele"]).1, Some(3));
}

pub fn msh_2(mesh: &anastomesh_verify::Mesh) -> String {
    let mut text = format!(
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n2 1 \"wall\"\n$EndPhysicalNames\n$Nodes\n{}\n",
        mesh.points.len()
    );
    for (i, [x, y, z]) in mesh.points.iter().enumerate() {
        let _ = writeln!(text, "{} {x} {y} {z}", 10 + i);
    }
    let _ = writeln!(text, "$EndNodes\n$Elements\n{}", mesh.tets.len() + mesh.triangles.len());
    for [a, b, c] in mesh.triangles.iter().map(|t| t.map(|v| v + 10)) {
        let _ = writeln!(text, "1 2 2 1 1 {a} {b} {c}");
    }
    for [a, b, c, d] in mesh.tets.iter().map(|t| t.map(|v| v + 10)) {
        let _ = writeln!(text, "1 4 2 5 1 {a} {b} {c} {d}");
    }
    text + "$EndElements\n"
}

pub fn msh_4(mesh: &anastomesh_verify::Mesh, is_binary: bool) -> Vec<u8> {
    let mut out = format!("$MeshFormat\n4.1 {} 8\n$EndMeshFormat\n$Entities\n", u8::from(is_binary)).into_bytes();
    // Letters of the format: i for 32 bits, s for 64 bits, d for coordinates.
    let put = |out: &mut Vec<u8>, letters: &str, numbers: &[f64]| {
        for (letter, &x) in letters.chars().zip(numbers) {
            match letter {
                'i' if is_binary => out.extend((x as i32).to_le_bytes()),
                's' if is_binary => out.extend((x as u64).to_le_bytes()),
                _ if is_binary => out.extend(x.to_le_bytes()),
                _ => out.extend(format!("{x} ").bytes()),
            }
        }
        if !is_binary {
            out.push(b'\n');
        }
    };
    put(&mut out, "ssss", &[0., 0., 1., 1.]);
    put(&mut out, "iddddddsis", &[7., 0., 0., 0., 1., 1., 1., 1., 1., 0.]);
    put(&mut out, "iddddddssi", &[1., 0., 0., 0., 1., 1., 1., 0., 1., 7.]);
    out.extend(b"\n$EndEntities\n$Nodes\n");
    let (points, tets, triangles) = (mesh.points.len() as f64, mesh.tets.len() as f64, mesh.triangles.len() as f64);
    put(&mut out, "ssss", &[1., points, 1., points]);
    put(&mut out, "iiis", &[3., 1., 0., points]);
    (0..mesh.points.len()).for_each(|i| put(&mut out, "s", &[i as f64 + 1.]));
    mesh.points.iter().for_each(|p| put(&mut out, "ddd", p));
    out.extend(b"\n$EndNodes\n$Elements\n");
    put(&mut out, "ssss", &[2., tets + triangles, 1., tets + triangles]);
    put(&mut out, "iiis", &[2., 7., 2., triangles]);
    mesh.triangles
        .iter()
        .for_each(|t| put(&mut out, "ssss", &[1., f64::from(t[0] + 1), f64::from(t[1] + 1), f64::from(t[2] + 1)]));
    put(&mut out, "iiis", &[3., 1., 4., tets]);
    for t in mesh.tets.iter().map(|t| t.map(|v| f64::from(v + 1))) {
        put(&mut out, "sssss", &[1., t[0], t[1], t[2], t[3]]);
    }
    out.extend(b"\n$EndElements\n");
    out
}

fn tetgen(dir: &Path, mesh: &anastomesh_verify::Mesh) {
    let rows =
        |list: Vec<String>| list.iter().enumerate().map(|(i, row)| format!("{} {row}\n", i + 1)).collect::<String>();
    let points = mesh.points.iter().map(|[x, y, z]| format!("{x} {y} {z}")).collect();
    let tets = mesh.tets.iter().map(|t| t.map(|v| v + 1)).map(|[a, b, c, d]| format!("{a} {b} {c} {d}")).collect();
    let faces = mesh.triangles.iter().map(|t| t.map(|v| v + 1)).map(|[a, b, c]| format!("{a} {b} {c} 1")).collect();
    write(dir, "m.node", format!("{} 3 0 0\n{}# end\n", mesh.points.len(), rows(points)));
    write(dir, "m.ele", format!("{} 4 0\n{}", mesh.tets.len(), rows(tets)));
    write(dir, "m.face", format!("{} 1\n{}", mesh.triangles.len(), rows(faces)));
}

#[test]
fn surfaces_and_networks() {
    let folder = tempfile::tempdir().expect("a folder");
    let dir = folder.path();
    write(dir, "tube.vtu", vtu(&tube()));
    write(dir, "net.swc", "# vessel\n1 1 0 0 0 1 -1\n2 1 0 0 3 1.0 1\n");
    write(dir, "thin.swc", "1 1 0 0 0 0.8 -1\n2 1 0 0 3 0.8 1\n");
    assert_eq!(run(dir, &["tube.vtu", "--network", "net.swc", "--tolerance", "1e-9"]).1, Some(0));
    // A radius of 1 differs from 0.8 by a quarter.
    assert_eq!(run(dir, &["tube.vtu", "--network", "thin.swc", "--tolerance", "0.26"]).1, Some(0));
    let (text, code) = run(dir, &["tube.vtu", "--network", "thin.swc", "--tolerance", "0.24"]);
    assert!(text.contains("wall_distance: wall vertices far from the vessels: 32 (18, 19, 20, …)") && code == Some(1));
    let lines = "<VTKFile type='PolyData'><PolyData><Piece><PointData><DataArray type='Float64' Name='Radius' \
        format='ascii'>1 1</DataArray></PointData><Points><DataArray type='Float32' format='ascii'>0 0 0 0 0 3</DataArray>\
        </Points><Lines><DataArray type='Int64' Name='connectivity' format='ascii'>0 1</DataArray><DataArray type='Int64' \
        Name='offsets' format='ascii'>2</DataArray></Lines></Piece></PolyData></VTKFile>";
    write(dir, "net.vtp", lines);
    assert_eq!(run(dir, &["tube.vtu", "--network", "net.vtp", "--tolerance", "1e-9"]).1, Some(0));
    // A taper from 1 to 0.8 has the radii 0.93 and 0.87 where the tube has vertices.
    write(dir, "taper.vtp", lines.replace("1 1", "1 0.8"));
    for (tolerance, code) in [("0.16", 0), ("0.14", 1)] {
        assert_eq!(run(dir, &["tube.vtu", "--network", "taper.vtp", "--tolerance", tolerance]).1, Some(code));
    }

    // A triangle of the cap at z = 0, in all formats of surfaces.
    let p = &tube().points;
    let [a, b, c] = [0, 1, 2].map(|i| p[i].map(|x| x.to_string()).join(" "));
    write(dir, "s.off", format!("OFF\n3 1 0\n{a}\n{b}\n{c}\n3 0 1 2 # cap\n"));
    write(dir, "s.stl", format!("solid s\nouter loop\nvertex {a}\n vertex {b}\nvertex {c}\nendloop\n"));
    let head = "element vertex 3\nproperty double x\nproperty double y\nproperty double z\nproperty uchar red\n\
        element face 1\nproperty list uchar int vertex_indices\nend_header\n";
    write(dir, "s.ply", format!("ply\nformat ascii 1.0\n{head}{a} 255\n{b} 255\n{c} 255\n3 0 1 2\n"));
    let mut binary = format!("ply\nformat binary_big_endian 1.0\n{head}").into_bytes();
    for point in &p[..3] {
        binary.extend(point.iter().flat_map(|x| x.to_be_bytes()));
        binary.push(255);
    }
    binary.push(3);
    (0..3_i32).for_each(|v| binary.extend(v.to_be_bytes()));
    write(dir, "b.ply", &binary);
    for surface in ["s.off", "s.stl", "s.ply", "b.ply"] {
        let (text, code) = run(dir, &["tube.vtu", "--surface", surface]);
        assert_eq!(code, Some(0), "{surface}: {text}");
    }
    // Binary STL has numbers of 32 bits.
    let mut cube = cuboid([1, 1, 1]);
    label(&mut cube, &|_| 1);
    write(dir, "cube.vtu", vtu(&cube));
    let mut binary_stl = [&[b' '; 80][..], &(cube.triangles.len() as u32).to_le_bytes()].concat();
    for t in &cube.triangles {
        let corners = t.map(|v| cube.points[v as usize].map(|x| x as f32));
        let numbers = [[0.0; 3], corners[0], corners[1], corners[2]];
        binary_stl.extend(numbers.as_flattened().iter().flat_map(|x| x.to_le_bytes()));
        binary_stl.extend([0; 2]);
    }
    write(dir, "b.stl", binary_stl);
    assert_eq!(run(dir, &["cube.vtu", "--surface", "b.stl"]).1, Some(0));
    write(dir, "other.off", format!("OFF\n3 1 0\n{a}\n{b}\n0.1 0.2 0.3\n3 0 1 2\n"));
    assert_eq!(run(dir, &["tube.vtu", "--surface", "other.off"]).1, Some(1));
    write(dir, "cut.ply", &binary[..binary.len() - 3]);
    let (text, code) = run(dir, &["tube.vtu", "--surface", "cut.ply"]);
    assert_eq!((text.as_str(), code), ("error: cut.ply: the file ends early\n", Some(3)));
}

#[test]
fn certificates() {
    let folder = tempfile::tempdir().expect("a folder");
    let dir = folder.path();
    write(dir, "m.vtu", vtu(&tube()));
    write(dir, "net.swc", "1 1 0 0 0 1 -1\n2 1 0 0 3 1 1\n");
    write(dir, "key", "secret");
    let with = |words: &[&str]| {
        let (text, code) = run(dir, words);
        (text.split(": ").nth(2).unwrap_or_default().to_owned(), code)
    };
    let (input, key) = (["--input", "net.swc"], ["--key", "key"]);
    for is_keyed in [false, true] {
        let key = if is_keyed { &key[..] } else { &[] };
        let wrong_key = if is_keyed { &[][..] } else { &["--key", "key"] };
        let words = |option, key: &[&'static str]| [&["m.vtu", option, "c.json"][..], &input, key].concat();
        write(dir, "m.vtu", vtu(&tube()));
        assert_eq!(run(dir, &words("--write-certificate", key)).1, Some(0));
        let check = words("--certificate", key);
        assert_eq!(run(dir, &check).1, Some(0));
        assert_eq!(with(&words("--certificate", wrong_key)), ("seal".into(), Some(1)));
        let text = std::fs::read_to_string(dir.join("c.json")).expect("a certificate");
        write(dir, "c.json", text.replace("\"tets\": 144", "\"tets\": 145"));
        assert_eq!(with(&check), ("seal".into(), Some(1)));
        assert!(run(dir, &check).0.contains("claims: claims of the certificate that do not hold: 1 (tets)"));
        // Volumes may differ by rounding.
        for (by, holds) in [(5e-7, true), (2e-6, false)] {
            let mut claimed: serde_json::Value = serde_json::from_str(&text).expect("JSON");
            let volume = claimed["figures"]["volume"].as_f64().expect("a volume");
            claimed["figures"]["volume"] = (volume * (1.0 + by)).into();
            write(dir, "c.json", claimed.to_string());
            assert_eq!(!run(dir, &check).0.contains("(volume)"), holds, "{by}");
        }
        write(dir, "c.json", &text);
        write(dir, "m.vtu", vtu(&tube()) + "\n");
        assert_eq!(with(&check), ("hashes".into(), Some(1)));
        // Another mesh of the same size: the condition that fails is a claim that does not hold.
        let mut bad = tube();
        bad.tets[3].swap(0, 1);
        write(dir, "m.vtu", vtu(&bad));
        assert!(run(dir, &check).0.contains("(positive_tets, opposite_sides, "), "{}", run(dir, &check).0);
    }
    write(dir, "m.vtu", vtu(&tube()));
    assert_eq!(run(dir, &["m.vtu", "--write-certificate", "c.json", "--input", "net.swc"]).1, Some(0));
    write(dir, "net.swc", "1 1 0 0 0 1 -1\n2 1 0 0 3 1 1 \n");
    assert_eq!(with(&["m.vtu", "--certificate", "c.json", "--input", "net.swc"]), ("hashes".into(), Some(1)));
    write(dir, "c.json", "{}");
    assert_eq!(run(dir, &["m.vtu", "--certificate", "c.json"]).1, Some(3));
}

/// Files with changed, missing and repeated bytes: an answer with one of three exit codes, and no panic.
#[test]
fn damaged_files_have_an_answer() {
    let folder = tempfile::tempdir().expect("a folder");
    let dir = folder.path();
    let mut mesh = cuboid([1, 1, 1]);
    label(&mut mesh, &|_| 1);
    tetgen(dir, &mesh);
    let files = [
        ("vtu", vtu(&tube()).into_bytes()),
        ("msh", msh_2(&mesh).into_bytes()),
        ("msh", msh_4(&mesh, false)),
        ("msh", msh_4(&mesh, true)),
        ("ele", std::fs::read(dir.join("m.ele")).expect("written")),
    ];
    // Linear congruential generator of Knuth.
    let mut state = 1_u64;
    let mut random = |below: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % below
    };
    let mut names = Vec::new();
    for (extension, bytes) in &files {
        for i in 0..60 {
            let mut damaged = bytes.clone();
            for _ in 0..=random(3) {
                let at = random(damaged.len());
                match random(4) {
                    0 => damaged.truncate(at.max(1)),
                    1 => damaged[at] = random(256) as u8,
                    2 => damaged[at] ^= 1 << random(8),
                    _ => drop(damaged.splice(at..at, bytes[at.min(bytes.len() - 1)..].iter().copied().take(20))),
                }
            }
            let name = format!("d{}_{i}.{extension}", names.len());
            write(dir, &name, damaged);
            std::fs::copy(dir.join("m.node"), dir.join(&name).with_extension("node")).expect("copied");
            names.push(name);
        }
    }
    write(dir, "list", names.join("\n"));
    let (text, code) = run(dir, &["--list", "list"]);
    assert!(!text.contains("panicked") && text.lines().count() == names.len() && code == Some(3), "{text}");
    let answers = [": valid", ": NOT valid", ": unreadable"].map(|answer| text.matches(answer).count());
    assert!(answers.iter().all(|&count| count > 0) && answers.iter().sum::<usize>() == names.len(), "{answers:?}");
}
