//! Runs TetGen on a file in a separate folder.

use crate::common::oracle;
use anastomesh::{Point3, TetMesh};
use std::fmt::Write as _;
use std::path::Path;
use std::process::{Command, Stdio};

/// Output of TetGen.
pub struct Output {
    /// Tetrahedra, with the opposite orientation of ours.
    pub mesh: TetMesh,
    /// Number of faces on the boundary or in facets.
    pub faces: usize,
    /// Number of distinct attributes of tetrahedra.
    pub regions: usize,
}

/// Output for a `poly` or `node` input; `None` without TetGen.
pub fn run(switches: &str, kind: &str, input: String) -> Option<Output> {
    let program = oracle::tetgen()?;
    let folder = tempfile::tempdir().expect("a folder");
    let file = format!("in.{kind}");
    std::fs::write(folder.path().join(&file), input).expect("a file");
    let mut command = Command::new(program);
    let status = command.args([switches, &file]).current_dir(folder.path()).stdout(Stdio::null()).status();
    assert!(status.is_ok_and(|s| s.success()), "tetgen fails");
    let rows = |kind: &str| rows(&folder.path().join(format!("in.1.{kind}")));
    let points = rows("node").iter().map(|r| Point3::new(r[1], r[2], r[3])).collect();
    let elements = rows("ele");
    let tets = elements.iter().map(|r| [1, 2, 3, 4].map(|k| r[k] as u32)).collect();
    let mut regions: Vec<i64> = elements.iter().filter_map(|r| r.get(5)).map(|&r| r as i64).collect();
    regions.sort_unstable();
    regions.dedup();
    Some(Output { mesh: TetMesh { points, tets }, faces: rows("face").len(), regions: regions.len() })
}

fn rows(path: &Path) -> Vec<Vec<f64>> {
    let text = std::fs::read_to_string(path).expect("TetGen's file");
    let lines = text.lines().filter(|l| !l.trim_start().starts_with('#')).skip(1);
    lines.map(|l| l.split_whitespace().map(|w| w.parse().expect("a number")).collect()).collect()
}

/// Point section at the start of the files.
pub fn points_section(points: &[Point3]) -> String {
    let mut text = format!("{} 3 0 0\n", points.len());
    for (i, p) in points.iter().enumerate() {
        let _ = writeln!(text, "{i} {} {} {}", p.x, p.y, p.z);
    }
    text
}

/// Total volume of the tetrahedra, for any orientation.
pub fn volume(mesh: &TetMesh) -> f64 {
    let of_tet = |t: &[u32; 4]| {
        let [a, b, c, d] = t.map(|v| mesh.points[v as usize]);
        ((b - a).cross(&(c - a)).dot(&(d - a)) / 6.0).abs()
    };
    mesh.tets.iter().map(of_tet).sum()
}
