//! Reader of TetGen's `.node`, `.ele` and `.face`.

use crate::mesh::{Mesh, Read, fail, index};
use std::path::Path;

/// Reads the tetrahedra of an `.ele` file, and the files of the same name beside it. `.face` may be missing.
pub fn read(path: &Path) -> Read<Mesh> {
    let mut mesh = Mesh { is_undirected: true, ..Mesh::default() };
    let (nodes, _) = table(&path.with_extension("node"), 3)?;
    let first = nodes.first().map_or(0, |row| row[0] as i64);
    for (i, row) in nodes.iter().enumerate() {
        if row[0] as i64 != first + i as i64 {
            return fail(format!("node {i} of the .node file is out of order"));
        }
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
            mesh.labels.push(if has_marker { row.get(4).map_or(0, |&marker| marker as i64) } else { 0 });
        }
    }
    Ok(mesh)
}

/// Rows of a table with at least as many numbers after the id, and its first line.
fn table(path: &Path, columns: usize) -> Read<(Vec<Vec<f64>>, Vec<f64>)> {
    let Ok(text) = std::fs::read_to_string(path) else { return fail(format!("{} is not readable", path.display())) };
    let lines = text.lines().map(|line| line.split('#').next().unwrap_or_default()).filter(|l| !l.trim().is_empty());
    let mut rows = Vec::new();
    for line in lines {
        let row: Option<Vec<f64>> = line.split_ascii_whitespace().map(|word| word.parse().ok()).collect();
        let Some(row) = row.filter(|row| rows.is_empty() || row.len() > columns) else {
            return fail(format!("{}: row {} is not a row of numbers", path.display(), rows.len()));
        };
        rows.push(row);
    }
    if rows.is_empty() || rows[0].first() != Some(&((rows.len() - 1) as f64)) {
        return fail(format!("{}: the number of rows differs from the first line", path.display()));
    }
    let head = rows.remove(0);
    Ok((rows, head))
}
