//! Tetrahedra for cut views: all of a small mesh, otherwise those of selected blocks.

use super::pack::{Pack, QuantizationGrid};
use super::wall::Wall;
use anastomesh_mesh::geometry::Point3;
use anastomesh_mesh::source::{MeshSource, TetPiece};
use rustc_hash::{FxHashMap, FxHashSet};
use std::io;

/// Maximum number of tetrahedra in a page with the whole mesh.
const MOST: usize = 1_000_000;
/// Maximum number of tetrahedra in a page with selected blocks.
const SOME: usize = 300_000;
/// Grid resolution of their points, in steps.
const STEPS: u32 = 1 << 20;

/// Adds tetrahedra and returns the metadata for the page. Of a large mesh, selects blocks at the middle plane across
/// the longest side, widest first. If the blocks are regions, selects the tetrahedra at that plane.
///
/// # Errors
/// The mesh cannot be read.
pub fn add_tets(
    mesh: &dyn MeshSource,
    wall: &Wall,
    has_regions: bool,
    pack: &mut Pack,
) -> io::Result<serde_json::Value> {
    let count = mesh.counts().tets;
    let mut held = Held::default();
    let plane = middle(wall);
    if count <= MOST {
        mesh.each_part(
            |part| held_part(mesh, part),
            |(piece, corners)| {
                held.add(&piece, &corners, MOST, |_, _| true);
                Ok(())
            },
        )?;
    } else if has_regions {
        let (axis, at) = plane;
        mesh.each_part(
            |part| held_part(mesh, part),
            |(piece, corners)| {
                held.add(&piece, &corners, SOME, |_, corners| {
                    let behind = corners.iter().filter(|corner| corner[axis] < at).count();
                    (1..4).contains(&behind)
                });
                Ok(())
            },
        )?;
    } else {
        let wanted = crossed(wall, plane);
        // Each part is a block, or a single part in memory holds all blocks.
        for part in 0..mesh.parts() {
            let is_wanted = mesh.parts() == 1 || {
                let blocks = mesh.face_labels(part)?.blocks;
                blocks.first().is_some_and(|block| wanted.contains(block))
            };
            if is_wanted && held.tets.len() < 4 * SOME {
                let (piece, corners) = held_part(mesh, part)?;
                held.add(&piece, &corners, SOME, |block, _| wanted.contains(&block));
            }
        }
    }
    let grid = QuantizationGrid::of(held.points.iter(), STEPS);
    pack.add("tetPosition", &grid.steps(held.points.iter()), 3);
    pack.add("tet", &held.tets, 4);
    pack.add("tetBlock", &held.blocks, 1);
    Ok(serde_json::json!({ "grid": grid, "shown": held.blocks.len(), "all": count, "plane": plane }))
}

type TetPart<'a> = (TetPiece<'a>, Vec<[Point3; 4]>);

fn held_part(mesh: &dyn MeshSource, part: u32) -> io::Result<TetPart<'_>> {
    let piece = mesh.tets(part)?;
    let corners = mesh.corners_of(&piece.tets)?;
    Ok((piece, corners))
}

/// Collected tetrahedra with renumbered points.
#[derive(Default)]
struct Held {
    numbers: FxHashMap<u32, i32>,
    points: Vec<Point3>,
    tets: Vec<i32>,
    blocks: Vec<i32>,
}

impl Held {
    /// Adds the tetrahedra of a part that are selected by block and corners, up to a limit.
    fn add(&mut self, piece: &TetPiece, corners: &[[Point3; 4]], most: usize, has: impl Fn(i32, &[Point3; 4]) -> bool) {
        for (i, (tet, at)) in piece.tets.iter().zip(corners).enumerate() {
            let block = piece.blocks.get(i).copied().unwrap_or(0);
            if self.blocks.len() >= most || !has(block, at) {
                continue;
            }
            for k in 0..4 {
                let number = *self.numbers.entry(tet[k]).or_insert_with(|| {
                    self.points.push(at[k]);
                    self.points.len() as i32 - 1
                });
                self.tets.push(number);
            }
            self.blocks.push(block);
        }
    }
}

/// Longest axis of a wall and the middle coordinate on it.
fn middle(wall: &Wall) -> (usize, f64) {
    let points = || wall.pieces.iter().flat_map(|p| &p.groups).flat_map(|g| &g.points);
    let range = |k: usize| points().fold([f64::INFINITY, f64::NEG_INFINITY], |[l, h], p| [l.min(p[k]), h.max(p[k])]);
    let ranges = [0, 1, 2].map(range);
    let longest = (0..3).max_by(|&a, &b| {
        let [a, b] = [a, b].map(|k| ranges[k][1] - ranges[k][0]);
        a.total_cmp(&b)
    });
    let k = longest.unwrap_or(0);
    let middle = f64::midpoint(ranges[k][0], ranges[k][1]);
    (k, if middle.is_finite() { middle } else { 0.0 })
}

/// Widest blocks whose wall crosses the plane, as many as the limit allows.
fn crossed(wall: &Wall, (axis, at): (usize, f64)) -> FxHashSet<i32> {
    let cuts = |piece: &&super::wall::BlockWall| {
        let mut sides = piece.groups.iter().flat_map(|g| &g.points).map(|p| p[axis] < at);
        let first = sides.next();
        first.is_some_and(|first| sides.any(|side| side != first))
    };
    let mut found: Vec<(f64, i32)> = wall.pieces.iter().filter(cuts).map(|p| (p.radius, p.block)).collect();
    found.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    // A block has at least some hundred tetrahedra.
    found.truncate(SOME / 300);
    found.into_iter().map(|(_, block)| block).collect()
}
