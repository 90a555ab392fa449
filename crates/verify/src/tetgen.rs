//! Reader of TetGen's `.node`, `.ele` and `.face`.

use crate::mesh::{Mesh, index};
use anyhow::{Context as _, Result, ensure};
use std::path::Path;

/// Reads the tetrahedra of an `.ele` file, and the files of the same name beside it. `.face` may be missing.
pub fn read(path: &Path) -> Result<Mesh> {
    let mut mesh = Mesh { is_undirected: true, ..Mesh::default() };
    let (nodes, _) = table(&path.with_extension("node"), 3)?;
    let first = nodes.first().map_or(0, |row| row[0] as i64);
    for (i, row) in nodes.iter().enumerate() {
        ensure!(row[0] as i64 == first + i as i64, "node {i} of the .node file is out of order");
        mesh.points.push([row[1], row[2], row[3]]);
    }
    let vertex = |x: f64| index(x as i64 - first);
    for row in table(&path.with_extension("ele"), 4)?.0 {
        mesh.tets.push([row[1], row[2], row[3], row[4]].map(vertex));
    }
    let faces = path.with_extension("face");
    if faces.exists() {
        let (rows, head) = table(&faces, 3)?;
        let has_marker = head.get(1).is_some_and(|&n| n > 0.0);
        for row in rows {
            mesh.triangles.push([row[1], row[2], row[3]].map(vertex));
            mesh.labels.push(row.get(4).filter(|_| has_marker).map_or(0, |&marker| marker as i64));
        }
    }
    Ok(mesh)
}

/// Rows of a table with at least as many numbers after the id, and its first line.
fn table(path: &Path, columns: usize) -> Result<(Vec<Vec<f64>>, Vec<f64>)> {
    let shown = path.display();
    let text = std::fs::read_to_string(path).ok().with_context(|| format!("{shown} is not readable"))?;
    let lines = text.lines().map(|line| line.split('#').next().unwrap_or_default()).filter(|l| !l.trim().is_empty());
    let mut rows: Vec<Vec<f64>> = Vec::new();
    for line in lines {
        let row: Option<Vec<f64>> = line.split_ascii_whitespace().map(|word| word.parse().ok()).collect();
        let row = row.filter(|row| rows.is_empty() || row.len() > columns);
        rows.push(row.with_context(|| format!("{shown}: row {} is not a row of numbers", rows.len()))?);
    }
    let is_complete = rows.first().is_some_and(|head| head.first() == Some(&((rows.len() - 1) as f64)));
    ensure!(is_complete, "{shown}: the number of rows differs from the first line");
    let head = rows.remove(0);
    Ok((rows, head))
}
