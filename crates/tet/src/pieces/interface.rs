//! The interface between both sides of a plane, and the halves of a region that it separates.

use super::band::Band;
use super::plane::Plane;
use super::sides::{Side, Sides};
use anastomesh_mesh::adjacency::{NONE, face_vertices};
use anastomesh_mesh::geometry::{Aabb, Bvh, Point3};
use anastomesh_mesh::{TetMesh, TriMesh};
use rustc_hash::{FxHashMap, FxHashSet};
use std::f64::consts::PI;

/// Passes in which tetrahedra change sides.
const PASSES: usize = 40;

/// Passes in which they do so at all sharp edges. After them, only the sharpest do.
const SHARP_PASSES: usize = 20;

/// Passes after which all tetrahedra at the ends of an edge change sides with those at the edge.
const NARROW_PASSES: usize = 8;

/// Angle between two faces of a half below which their edge is sharp, in radians.
const SHARP: f64 = 0.5;

/// Faces of both halves at edges of the interface, oriented outwards.
type Around = FxHashMap<[u32; 2], [Vec<[u32; 3]>; 2]>;

/// Two halves of a region.
pub(super) struct Cut {
    /// Points of the interface that are no points of the region. Their numbers follow those of the region.
    pub points: Vec<Point3>,
    /// Triangles of the closed surface of each half, oriented outwards.
    pub halves: [Vec<[u32; 3]>; 2],
}

/// Tetrahedra near a plane.
pub(super) struct Interface<'a> {
    pub mesh: &'a TetMesh,
    pub band: &'a Band,
    /// The whole region.
    pub surface: &'a TriMesh,
    pub plane: Plane,
    pub sides: Sides,
}

impl Interface<'_> {
    /// Halves of the region. `None` if they are not closed, if the interface comes near a triangle beyond the band, or if faces
    /// form smaller angles than `least` (radians).
    pub fn cut(mut self, least: f64) -> Option<Cut> {
        for pass in 0..PASSES {
            let faces = self.faces();
            let around = self.around(&faces);
            let mut moves = Self::crowded(&around, pass);
            moves.extend(self.sharp(&around, pass, if pass < SHARP_PASSES { SHARP } else { least }));
            if moves.is_empty() {
                return (self.is_closed(&faces) && self.is_clear(&faces)).then(|| self.halves(&faces));
            }
            moves.sort_unstable_by_key(|(edge, side)| (*edge, side.half()));
            self.change(&moves, pass >= NARROW_PASSES);
        }
        None
    }

    /// Faces between the sides, oriented away from the lower one.
    fn faces(&self) -> Vec<[u32; 3]> {
        let Sides { of_tets: sides, adjacency, is_core, on_surface, .. } = &self.sides;
        let mut found = Vec::new();
        for (tet, mates) in (0..).zip(&adjacency.neighbors).filter(|(tet, _)| is_core[*tet as usize]) {
            for (half, &mate) in (4 * tet..).zip(mates) {
                if mate == NONE || on_surface[half as usize] {
                    continue;
                }
                let other = (mate >> 2) as usize;
                match (sides[tet as usize], sides[other]) {
                    (Side::Below, Side::Above) => found.push(face_vertices(&self.mesh.tets, half)),
                    // The others are met from the lower side.
                    (Side::Above, Side::Below) if !is_core[other] => {
                        found.push(face_vertices(&self.mesh.tets, mate));
                    }
                    _ => {}
                }
            }
        }
        found
    }

    /// Side of a triangle of the band.
    fn side_of(&self, triangle: usize) -> Side {
        self.sides.of_tets[self.sides.inner[triangle] as usize]
    }

    fn around(&self, faces: &[[u32; 3]]) -> Around {
        let mut around = Around::default();
        for &[a, b, c] in faces {
            for edge in edges([a, b, c]) {
                let [below, above] = around.entry(edge).or_default();
                below.push([a, b, c]);
                above.push([a, c, b]);
            }
        }
        for (i, &t) in self.band.boxed.triangles[..self.band.triangles.len()].iter().enumerate() {
            for edge in edges(t) {
                if let Some(at) = around.get_mut(&edge) {
                    at[self.side_of(i).half()].push(t);
                }
            }
        }
        around
    }

    /// Edges at which a half has more than two faces. Their tetrahedra go to either side in turn.
    fn crowded(around: &Around, pass: usize) -> Vec<([u32; 2], Side)> {
        let side = if pass.is_multiple_of(2) { Side::Below } else { Side::Above };
        let is_crowded = |at: &[Vec<[u32; 3]>; 2]| at.iter().any(|faces| faces.len() > 2);
        around.iter().filter(|(_, at)| is_crowded(at)).map(|(edge, _)| (*edge, side)).collect()
    }

    /// Edges at which two faces of a half form a small angle inside it. Their tetrahedra go to the other half and back to it
    /// in turn.
    fn sharp(&self, around: &Around, pass: usize, below: f64) -> Vec<([u32; 2], Side)> {
        let sides = [Side::Below, Side::Above];
        let at_half = |(edge, faces, half): ([u32; 2], &Vec<[u32; 3]>, usize)| match faces[..] {
            [f, g] if angle(&self.mesh.points, edge, f, g) < below => Some((edge, sides[(half + 1 + pass) % 2])),
            _ => None,
        };
        let each =
            |(edge, at): (&[u32; 2], &'_ [Vec<[u32; 3]>; 2])| [0, 1].map(|half| at_half((*edge, &at[half], half)));
        around.iter().flat_map(each).flatten().collect()
    }

    /// Moves the tetrahedra at edges to a side, or all at their ends.
    fn change(&mut self, moves: &[([u32; 2], Side)], is_wide: bool) {
        let ends: FxHashSet<u32> = moves.iter().flat_map(|(edge, _)| *edge).collect();
        let mut at: FxHashMap<u32, Vec<u32>> = FxHashMap::default();
        for (tet, all) in (0..).zip(&self.mesh.tets) {
            if self.sides.is_core[tet as usize] && self.sides.of_tets[tet as usize] != Side::Outside {
                for v in all.iter().filter(|v| ends.contains(v)) {
                    at.entry(*v).or_default().push(tet);
                }
            }
        }
        for &([a, b], side) in moves {
            let tets = |v: u32| at.get(&v).into_iter().flatten().copied();
            let at_edge = tets(a).filter(|&t| self.mesh.tets[t as usize].contains(&b));
            let moved: Vec<u32> = if is_wide { tets(a).chain(tets(b)).collect() } else { at_edge.collect() };
            for t in moved {
                self.sides.of_tets[t as usize] = side;
            }
        }
    }

    /// Side of each triangle of the region. Those beyond the band are on the side of the plane where they lie.
    fn sides_of_surface(&self) -> Vec<Side> {
        let side = |t: &[u32; 3]| Side::at(self.plane.distance(&self.surface.points[t[0] as usize]));
        let mut all: Vec<Side> = self.surface.triangles.iter().map(side).collect();
        for (i, &t) in self.band.triangles.iter().enumerate() {
            all[t as usize] = self.side_of(i);
        }
        all
    }

    /// Triangles of the region beyond the band.
    fn beyond(&self) -> impl Iterator<Item = &[u32; 3]> {
        let mut in_band = vec![false; self.surface.triangles.len()];
        self.band.triangles.iter().for_each(|&t| in_band[t as usize] = true);
        self.surface.triangles.iter().zip(in_band).filter(|(_, in_band)| !in_band).map(|(t, _)| t)
    }

    /// True if no triangle beyond the band comes near the interface.
    fn is_clear(&self, faces: &[[u32; 3]]) -> bool {
        let boxes: Vec<Aabb> =
            faces.iter().map(|f| Aabb::of_points(f.map(|v| &self.mesh.points[v as usize]))).collect();
        let whole = boxes.iter().fold(Aabb::EMPTY, |all, one| all.union(one));
        let bvh = Bvh::of(boxes);
        self.beyond().map(|t| Aabb::of_points(t.map(|v| &self.surface.points[v as usize]))).all(|own| {
            let mut is_clear = true;
            if own.overlaps(&whole) {
                bvh.query(&own, |_| is_clear = false);
            }
            is_clear
        })
    }

    /// True if each edge of a half has two triangles that pass it in opposite directions. Triangles beyond the band lie on the
    /// side of their neighbours, so only edges of the band and the interface are tested.
    fn is_closed(&self, faces: &[[u32; 3]]) -> bool {
        let count = self.band.triangles.len();
        let mut halves = [faces.to_vec(), faces.iter().map(|&[a, b, c]| [a, c, b]).collect()];
        for (i, t) in self.band.boxed.triangles[..count].iter().enumerate() {
            halves[self.side_of(i).half()].push(*t);
        }
        let own: Vec<usize> = halves.iter().map(Vec::len).collect();
        let mut number = vec![NONE; self.surface.points.len()];
        (0..).zip(&self.band.points).for_each(|(i, &v)| number[v as usize] = i);
        for t in self.beyond() {
            let side = Side::at(self.plane.distance(&self.surface.points[t[0] as usize]));
            let local = t.map(|v| number[v as usize]);
            if local.iter().filter(|&&v| v != NONE).count() > 1 {
                halves[side.half()].push(local);
            }
        }
        halves.iter().zip(own).all(|(half, own)| {
            let sides = |(i, &[a, b, c]): (usize, &[u32; 3])| {
                [[a, b], [b, c], [c, a]].map(|[a, b]| ([a.min(b), a.max(b)], a < b, i < own))
            };
            let mut all: Vec<([u32; 2], bool, bool)> = half.iter().enumerate().flat_map(sides).collect();
            all.sort_unstable();
            all.chunk_by(|x, y| x.0 == y.0).all(|run| {
                let is_other = run.iter().all(|(.., is_own)| !is_own);
                is_other || matches!(run, [(_, false, _), (_, true, _)])
            })
        })
    }

    /// Surfaces of both halves in the numbers of the region.
    fn halves(&self, faces: &[[u32; 3]]) -> Cut {
        let n = self.surface.points.len() as u32;
        let mut points = Vec::new();
        let mut added: FxHashMap<u32, u32> = FxHashMap::default();
        let mut number = |v: u32| match self.band.points.get(v as usize) {
            Some(&given) => given,
            None => *added.entry(v).or_insert_with(|| {
                points.push(self.mesh.points[v as usize]);
                n + points.len() as u32 - 1
            }),
        };
        let faces: Vec<[u32; 3]> = faces.iter().map(|f| f.map(&mut number)).collect();
        let mut halves = [Vec::new(), Vec::new()];
        for (side, t) in self.sides_of_surface().into_iter().zip(&self.surface.triangles) {
            halves[side.half()].push(*t);
        }
        halves[0].extend_from_slice(&faces);
        halves[1].extend(faces.iter().map(|&[a, b, c]| [a, c, b]));
        Cut { points, halves }
    }
}

fn edges([a, b, c]: [u32; 3]) -> [[u32; 2]; 3] {
    [[a, b], [b, c], [c, a]].map(|[x, y]| [x.min(y), x.max(y)])
}

/// Angle inside a closed surface between two of its triangles at an edge.
fn angle(points: &[Point3], [a, b]: [u32; 2], f: [u32; 3], g: [u32; 3]) -> f64 {
    let normal = |t: [u32; 3]| {
        let [a, b, c] = t.map(|v| points[v as usize]);
        (b - a).cross(&(c - a)).try_normalize(0.0).unwrap_or_default()
    };
    let (n, m) = (normal(f), normal(g));
    let is_forward = (0..3).any(|i| [f[i], f[(i + 1) % 3]] == [a, b]);
    let [start, end] = if is_forward { [a, b] } else { [b, a] }.map(|v| points[v as usize]);
    let along = (end - start).try_normalize(0.0).unwrap_or_default();
    PI - libm::atan2(n.cross(&m).dot(&along), n.dot(&m))
}
