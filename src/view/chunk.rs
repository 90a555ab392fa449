//! Chunks of nearby wall pieces, so that off-screen parts are not drawn.

use super::pack::{Pack, QuantizationGrid};
use super::scale::Scale;
use super::wall::{BlockWall, Group, Wall};
use anastomesh_mesh::geometry::Point3;
use anastomesh_mesh::geometry::hilbert::hilbert_key;
use serde::Serialize;

/// Approximate number of points per chunk.
const POINTS: usize = 40_000;
/// Grid resolution of a chunk, in steps.
const STEPS: u32 = 65_535;

/// Metadata of a chunk for the page.
#[derive(Debug, Serialize)]
struct ChunkHeader {
    grid: QuantizationGrid,
    pieces: usize,
    groups: usize,
}

/// Largest code of a colour, above the first.
const CODES: f64 = 254.0;

/// Packs a wall, with its values on their scale, and returns the metadata for the page.
pub fn pack_wall(wall: Wall, values: Option<Scale>, pack: &mut Pack) -> serde_json::Value {
    let Wall { mut pieces, exact, faces } = wall;
    let radii = pieces.iter().flat_map(|p| &p.groups).flat_map(|g| &g.radii).filter(|r| **r > 0.0);
    let [low, high] = radii.fold([f64::INFINITY, 0.0_f64], |[l, h], &r| [l.min(r), h.max(r)]);
    let scales = [Some(Scale { low, high, logarithmic: true }), values];
    let all = QuantizationGrid::of(pieces.iter().filter_map(|p| p.groups.first()?.points.first()), 1 << 16);
    let place = |piece: &BlockWall| {
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
        heads.push(pack_chunk(heads.len(), std::mem::replace(&mut pieces, rest), scales, pack));
    }
    serde_json::json!({ "exact": exact, "faces": faces, "chunks": heads,
        "radii": (low <= high).then_some([low, high]) })
}

fn pack_chunk(
    number: usize,
    mut pieces: Vec<BlockWall>,
    [radius, value]: [Option<Scale>; 2],
    pack: &mut Pack,
) -> ChunkHeader {
    // Sorted by radius, because the page draws thick pieces as faces and thin ones as lines.
    pieces.sort_by(|a, b| b.radius.total_cmp(&a.radius).then(a.block.cmp(&b.block)));
    let groups: Vec<(&BlockWall, &Group)> = pieces.iter().flat_map(|p| p.groups.iter().map(move |g| (p, g))).collect();
    let points = || groups.iter().flat_map(|(_, g)| &g.points);
    let ends: Vec<Point3> = pieces.iter().flat_map(|p| p.lines.iter().flatten().copied()).collect();
    let grid = QuantizationGrid::of(points().chain(&ends), STEPS);
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
    let codes = |scale: Scale, of: fn(&Group) -> &[f64]| -> Vec<i32> {
        groups.iter().flat_map(|(_, g)| of(g).iter().map(|&x| scale.code(x, CODES))).collect()
    };
    add("radius", &radius.map_or_else(Vec::new, |scale| codes(scale, |g| &g.radii)), 1);
    if let Some(scale) = value {
        add("value", &codes(scale, |g| &g.values), 1);
    }
    add("order", &bytes(|g| &g.orders), 1);
    let of_groups = |of: &dyn Fn(&(&BlockWall, &Group)) -> i32| -> Vec<i32> { groups.iter().map(of).collect() };
    add("groupBlock", &of_groups(&|(p, _)| p.block), 1);
    add("groupPatch", &of_groups(&|(_, g)| g.patch), 1);
    add("groupPoints", &of_groups(&|(_, g)| g.points.len() as i32), 1);
    add("groupFaces", &of_groups(&|(_, g)| g.triangles.len() as i32), 1);
    let of_pieces = |of: &dyn Fn(&BlockWall) -> i32| -> Vec<i32> { pieces.iter().map(of).collect() };
    add("pieceGroups", &of_pieces(&|p| p.groups.len() as i32), 1);
    // In steps of the grid; pieces without a radius are always drawn.
    add("pieceRadius", &of_pieces(&|p| (p.radius / grid.step * 16.0).min(f64::from(i32::MAX / 2)) as i32), 1);
    add("pieceLines", &of_pieces(&|p| p.lines.len() as i32), 1);
    add("line", &grid.steps(ends.iter()), 6);
    ChunkHeader { grid, pieces: pieces.len(), groups: groups.len() }
}
