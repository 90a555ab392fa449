//! Chunks of nearby wall pieces, so that off-screen parts are not drawn.

use super::pack::{Grid, Pack};
use super::wall::{Group, Piece, Wall};
use anastomesh_mesh::geometry::Point3;
use anastomesh_mesh::geometry::hilbert::hilbert_key;
use serde::Serialize;

/// Approximate number of points per chunk.
const POINTS: usize = 40_000;
/// Grid resolution of a chunk, in steps.
const STEPS: u32 = 65_535;

/// Metadata of a chunk for the page.
#[derive(Debug, Serialize)]
struct Head {
    grid: Grid,
    pieces: usize,
    groups: usize,
}

/// Packs a wall and returns the metadata for the page.
pub fn pack_wall(wall: Wall, pack: &mut Pack) -> serde_json::Value {
    let Wall { mut pieces, exact, faces } = wall;
    let radii = pieces.iter().flat_map(|p| &p.groups).flat_map(|g| &g.radii).filter(|r| **r > 0.0);
    let [low, high] = radii.fold([f64::INFINITY, 0.0_f64], |[l, h], &r| [l.min(r), h.max(r)]);
    let scale = RadiusScale { low, high };
    let all = Grid::of(pieces.iter().filter_map(|p| p.groups.first()?.points.first()), 1 << 16);
    let place = |piece: &Piece| {
        let first = piece.groups.first().and_then(|g| g.points.first()).copied().unwrap_or_else(Point3::origin);
        let cell = [0, 1, 2].map(|k| ((first[k] - all.origin[k]) / all.step).clamp(0.0, 65_535.0) as u32);
        hilbert_key(cell, 16)
    };
    pieces.sort_by_cached_key(|piece| (place(piece), piece.block));
    let mut heads = Vec::new();
    while !pieces.is_empty() {
        let mut points = 0;
        let count = pieces.iter().take_while(|piece| {
            let fits = points < POINTS;
            points += piece.groups.iter().map(|g| g.points.len()).sum::<usize>();
            fits
        });
        let rest = pieces.split_off(count.count());
        heads.push(pack_chunk(heads.len(), std::mem::replace(&mut pieces, rest), &scale, pack));
    }
    serde_json::json!({ "exact": exact, "faces": faces, "chunks": heads,
        "radii": (low <= high).then_some([low, high]) })
}

struct RadiusScale {
    low: f64,
    high: f64,
}

impl RadiusScale {
    /// Logarithmic code of a radius, 1 to 255; 0 if unknown.
    fn step(&self, radius: f64) -> i32 {
        if radius <= 0.0 || self.low > self.high {
            return 0;
        }
        let ratio = (self.high / self.low).ln();
        if ratio > 0.0 { 1 + (254.0 * (radius / self.low).ln() / ratio).clamp(0.0, 254.0) as i32 } else { 128 }
    }
}

fn pack_chunk(number: usize, mut pieces: Vec<Piece>, scale: &RadiusScale, pack: &mut Pack) -> Head {
    // Sorted by radius, because the page draws thick pieces as faces and thin ones as lines.
    pieces.sort_by(|a, b| b.radius.total_cmp(&a.radius).then(a.block.cmp(&b.block)));
    let groups: Vec<(&Piece, &Group)> = pieces.iter().flat_map(|p| p.groups.iter().map(move |g| (p, g))).collect();
    let points = || groups.iter().flat_map(|(_, g)| &g.points);
    let ends: Vec<Point3> = pieces.iter().flat_map(|p| p.lines.iter().flatten().copied()).collect();
    let grid = Grid::of(points().chain(&ends), STEPS);
    let mut add = |name: &str, values: &[i32], stride| pack.add(format!("{name}{number}"), values, stride);
    add("position", &grid.steps(points()), 3);
    let mut first = 0;
    let mut corners = Vec::new();
    for (_, group) in &groups {
        corners.extend(group.triangles.iter().flatten().map(|&v| (first + v) as i32));
        first += group.points.len() as u32;
    }
    add("corner", &corners, 1);
    let bytes = |of: fn(&Group) -> &[u8]| -> Vec<i32> {
        groups.iter().flat_map(|(_, g)| of(g).iter().map(|&x| i32::from(x))).collect()
    };
    add("quality", &bytes(|g| &g.quality), 1);
    let radii: Vec<i32> = groups.iter().flat_map(|(_, g)| g.radii.iter().map(|&r| scale.step(r))).collect();
    add("radius", &radii, 1);
    add("order", &bytes(|g| &g.orders), 1);
    let of_groups = |of: &dyn Fn(&(&Piece, &Group)) -> i32| -> Vec<i32> { groups.iter().map(of).collect() };
    add("groupBlock", &of_groups(&|(p, _)| p.block), 1);
    add("groupPatch", &of_groups(&|(_, g)| g.patch), 1);
    add("groupPoints", &of_groups(&|(_, g)| g.points.len() as i32), 1);
    add("groupFaces", &of_groups(&|(_, g)| g.triangles.len() as i32), 1);
    let of_pieces = |of: &dyn Fn(&Piece) -> i32| -> Vec<i32> { pieces.iter().map(of).collect() };
    add("pieceGroups", &of_pieces(&|p| p.groups.len() as i32), 1);
    // In steps of the grid; pieces without a radius are always drawn.
    add("pieceRadius", &of_pieces(&|p| (p.radius / grid.step * 16.0).min(f64::from(i32::MAX / 2)) as i32), 1);
    add("pieceLines", &of_pieces(&|p| p.lines.len() as i32), 1);
    add("line", &grid.steps(ends.iter()), 6);
    Head { grid, pieces: pieces.len(), groups: groups.len() }
}
