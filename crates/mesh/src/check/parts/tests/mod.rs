//! Meshes cut into parts: the checks of parts and whole agree, and planted faults are found.

mod contradictions;
mod faults;
mod hollow;
mod images;
mod meetings;
mod pieces;
mod random;
mod served;

use super::*;
use crate::adjacency::{boundary_faces, face_vertices, tet_adjacency};
use crate::check::{CheckReport, Expectation, LineResult, Outcome, Skipped, Verdict, check_volume};
use crate::face_key;
use crate::geometry::DisjointSets;
use crate::geometry::Vec3;
use crate::shapes::{cube_lattice, perturb, tube_lattice};
use crate::{Patch, VolumeMesh, WALL};
use std::collections::{BTreeMap, BTreeSet};

/// A part in memory.
#[derive(Clone, Debug, Default)]
struct Piece {
    mesh: TetMesh,
    joints: Vec<Vec<[u32; 3]>>,
    caps: Vec<(Cap, Vec<[u32; 3]>)>,
    /// Ids in the whole.
    vertices: Vec<u32>,
    tets: Vec<u64>,
}

/// Parts in memory.
#[derive(Clone, Debug, Default)]
struct MemoryParts {
    pieces: Vec<Piece>,
    joined: Vec<[(u32, u32); 2]>,
    patches: Vec<Patch>,
    expectation: Expectation,
    certificates: Vec<Certificate>,
}

impl Piece {
    fn certificate(&self) -> Certificate {
        let view = PartView { mesh: &self.mesh, joints: &self.joints, caps: &self.caps };
        certify_with(&view, || tet_adjacency(&self.mesh.tets, self.mesh.points.len()))
    }

    /// Some of its faces with a point array and ids of their own.
    fn faces(&self, faces: &[[u32; 3]]) -> FacesApart {
        let mut used: Vec<u32> = faces.as_flattened().to_vec();
        used.sort_unstable();
        used.dedup();
        FacesApart {
            points: used.iter().map(|&v| self.mesh.points[v as usize]).collect(),
            vertices: used.iter().map(|&v| self.vertices[v as usize]).collect(),
            faces: faces.iter().map(|f| f.map(|v| used.binary_search(&v).unwrap() as u32)).collect(),
        }
    }
}

impl Parts for MemoryParts {
    fn count(&self) -> usize {
        self.pieces.len()
    }

    fn certificate(&self, part: u32) -> io::Result<Certificate> {
        Ok(self.certificates[part as usize].clone())
    }

    fn wall(&self, part: u32) -> io::Result<FacesApart> {
        let piece = &self.pieces[part as usize];
        let is_joined = |j: u32| self.joined.as_flattened().contains(&(part, j));
        let inner: BTreeSet<[u32; 3]> = (0..)
            .zip(&piece.joints)
            .filter(|(j, _)| is_joined(*j))
            .flat_map(|(_, faces)| faces.iter().map(|&f| face_key(f)))
            .collect();
        let mut faces = boundary_faces(&piece.mesh);
        faces.retain(|&f| !inner.contains(&face_key(f)));
        Ok(piece.faces(&faces))
    }

    fn joined(&self) -> &[[(u32, u32); 2]] {
        &self.joined
    }

    fn joint(&self, part: u32, joint: u32) -> io::Result<FacesApart> {
        let piece = &self.pieces[part as usize];
        Ok(piece.faces(&piece.joints[joint as usize]))
    }

    fn vertex(&self, part: u32, local: u32) -> u32 {
        self.pieces[part as usize].vertices[local as usize]
    }

    fn tet(&self, part: u32, local: u32) -> u64 {
        self.pieces[part as usize].tets[local as usize]
    }
}

impl MemoryParts {
    /// Cuts a mesh. Faces between two parts that are connected by vertices form a joint.
    fn new(mesh: &TetMesh, part_of: impl Fn(Vec3) -> u32, caps: &[Patch], loops: Vec<u32>) -> Self {
        let middle = |t: &[u32; 4]| t.iter().fold(Vec3::zeros(), |s, &v| s + mesh.points[v as usize].coords) / 4.0;
        let parts: Vec<u32> = mesh.tets.iter().map(|t| part_of(middle(t))).collect();
        Self::with_parts(mesh, &parts, caps, loops)
    }

    fn with_parts(mesh: &TetMesh, parts: &[u32], caps: &[Patch], loops: Vec<u32>) -> Self {
        let count = parts.iter().max().map_or(0, |&p| p + 1);
        let terminals = caps.iter().filter_map(|p| p.cap.map(|c| c.node)).collect();
        let mut cut = Self { patches: caps.to_vec(), expectation: Expectation { loops, terminals }, ..Self::default() };
        for part in 0..count {
            let tets: Vec<u64> = (0..).zip(parts).filter(|(_, p)| **p == part).map(|(i, _)| i).collect();
            let mut vertices: Vec<u32> = tets.iter().flat_map(|&i| mesh.tets[i as usize]).collect();
            vertices.sort_unstable();
            vertices.dedup();
            let local = |v: u32| vertices.binary_search(&v).unwrap() as u32;
            let own = TetMesh {
                points: vertices.iter().map(|&v| mesh.points[v as usize]).collect(),
                tets: tets.iter().map(|&i| mesh.tets[i as usize].map(local)).collect(),
            };
            let mut piece = Piece { mesh: own, vertices, tets, ..Piece::default() };
            let faces = boundary_faces(&piece.mesh);
            for cap in caps.iter().filter_map(|p| p.cap) {
                let on = |v: u32| {
                    let d = piece.mesh.points[v as usize] - cap.center;
                    d.dot(&cap.normal).abs() < 1e-12 && d.norm() < 1.01 * cap.radius
                };
                let of: Vec<_> = faces.iter().copied().filter(|f| f.iter().all(|&v| on(v))).collect();
                if !of.is_empty() {
                    piece.caps.push((cap, of));
                }
            }
            cut.pieces.push(piece);
        }
        cut.find_joints(mesh, parts);
        cut.certify();
        cut
    }

    fn find_joints(&mut self, mesh: &TetMesh, parts: &[u32]) {
        let adjacency = tet_adjacency(&mesh.tets, mesh.points.len());
        let mut between: BTreeMap<[u32; 2], Vec<[u32; 3]>> = BTreeMap::new();
        for (handle, &n) in (0..).zip(adjacency.neighbors.as_flattened()) {
            if n != u32::MAX {
                let [a, b] = [handle, n].map(|h: u32| parts[h as usize / 4]);
                if a < b {
                    between.entry([a, b]).or_default().push(face_vertices(&mesh.tets, handle));
                }
            }
        }
        for ([a, b], faces) in between {
            let mut sets = DisjointSets::new(mesh.points.len());
            for &[p, q, r] in &faces {
                sets.join(p, q);
                sets.join(q, r);
            }
            let mut joints: BTreeMap<u32, Vec<[u32; 3]>> = BTreeMap::new();
            for face in faces {
                joints.entry(sets.root(face[0])).or_default().push(face);
            }
            for faces in joints.into_values() {
                let mut ends = [(a, 0), (b, 0)];
                for (turned, end) in ends.iter_mut().enumerate() {
                    let piece = &mut self.pieces[end.0 as usize];
                    end.1 = piece.joints.len() as u32;
                    let local = |&[p, q, r]: &[u32; 3]| {
                        let face = if turned == 1 { [p, r, q] } else { [p, q, r] };
                        face.map(|v| piece.vertices.binary_search(&v).unwrap() as u32)
                    };
                    let own = faces.iter().map(local).collect();
                    piece.joints.push(own);
                }
                self.joined.push(ends);
            }
        }
    }

    fn certify(&mut self) {
        self.certificates = self.pieces.iter().map(Piece::certificate).collect();
    }

    /// Mesh merged by ids.
    fn merged(&self) -> VolumeMesh {
        let mut points = BTreeMap::new();
        let mut tets = BTreeMap::new();
        let mut labels: Vec<([u32; 3], i32)> = Vec::new();
        for (part, piece) in self.pieces.iter().enumerate() {
            let whole = |v: u32| piece.vertices[v as usize];
            for (&id, &p) in piece.vertices.iter().zip(&piece.mesh.points) {
                points.entry(id).or_insert(p);
            }
            tets.extend(piece.tets.iter().zip(&piece.mesh.tets).map(|(&id, t)| (id, t.map(whole))));
            let wall = self.wall(part as u32).unwrap();
            for face in &wall.faces {
                let face = face.map(|v| wall.vertices[v as usize]);
                let patch =
                    piece.caps.iter().find(|(_, of)| of.iter().any(|f| face_key(f.map(whole)) == face_key(face)));
                let id = patch.and_then(|(cap, _)| self.patches.iter().find(|p| p.cap == Some(*cap)));
                labels.push((face, id.map_or(WALL, |p| p.id)));
            }
        }
        assert!(points.keys().copied().eq(0..points.len() as u32));
        VolumeMesh {
            mesh: TetMesh { points: points.into_values().collect(), tets: tets.into_values().collect() },
            boundary: labels.iter().map(|l| l.0).collect(),
            boundary_patch: labels.iter().map(|l| l.1).collect(),
            patches: self.patches.clone(),
            ..VolumeMesh::default()
        }
    }

    fn check(&self) -> CheckReport {
        check_parts(self, &self.patches, Some(&self.expectation), 1 << 20).unwrap().report
    }

    fn whole(&self) -> CheckReport {
        check_volume(&self.merged(), Some(&self.expectation))
    }

    fn failing(&self) -> Vec<Line> {
        self.check().failed().map(|result| result.line).collect()
    }
}

/// Certifies again after a change, and returns the failing conditions.
fn planted(cut: &MemoryParts, change: impl FnOnce(&mut MemoryParts)) -> (MemoryParts, Vec<Line>) {
    let mut cut = cut.clone();
    change(&mut cut);
    cut.certify();
    let failing = cut.failing();
    (cut, failing)
}

fn same_offenders(parts: &CheckReport, whole: &CheckReport, line: Line) {
    let named = |report: &CheckReport| {
        let line = report.line(line).unwrap();
        let ids: BTreeSet<Vec<i64>> = line.offenders.iter().map(|o| o.ids.clone()).collect();
        (line.outcome, line.count, ids)
    };
    assert_eq!(named(parts), named(whole), "{line:?}");
}

/// If other conditions fail, equal points of different parts may stay unknown.
fn is_unknown(line: &LineResult) -> bool {
    line.line == Line::NoDuplicatePoints && matches!(line.outcome, Outcome::NotChecked(Skipped::Because(_)))
}

/// Asserts equality except roundoff.
fn assert_same(cut: &MemoryParts) {
    let (parts, whole) = (cut.check(), cut.whole());
    assert_eq!(parts.verdict, whole.verdict, "{:?}", parts.failed().collect::<Vec<_>>());
    for (p, w) in parts.lines.iter().zip(&whole.lines) {
        if is_unknown(p) {
            assert_eq!(w.outcome, Outcome::Pass);
            continue;
        }
        assert_eq!(
            (p.line, p.outcome, p.count, &p.expected, &p.found),
            (w.line, w.outcome, w.count, &w.expected, &w.found)
        );
        if p.count <= p.offenders.len() as u64 && p.line != Line::Loops {
            same_offenders(&parts, &whole, p.line);
        }
    }
    let close = |a: f64, b: f64| (a - b).abs() <= 1e-12 * b.abs().max(1.0);
    assert!(close(parts.counts.volume, whole.counts.volume));
    assert_eq!(crate::check::Counts { volume: whole.counts.volume, ..parts.counts }, whole.counts);
    let (p, w) = (parts.quality.unwrap(), whole.quality.unwrap());
    assert!(close(p.mean, w.mean) && close(p.dihedral_min, w.dihedral_min) && close(p.dihedral_max, w.dihedral_max));
    assert_eq!((p.tets, p.histogram, p.min.to_bits()), (w.tets, w.histogram, w.min.to_bits()));
    assert!((p.percentile_1 - w.percentile_1).abs() <= 0.0025);
}

const LENGTH: f64 = 5.0;

/// A vessel along z with a cap at either end, in slices of two layers.
fn bar() -> MemoryParts {
    let mut mesh = tube_lattice(3, 20, LENGTH / 20.0);
    let surface = boundary_faces(&mesh);
    let mut inner = vec![true; mesh.points.len()];
    surface.as_flattened().iter().for_each(|&v| inner[v as usize] = false);
    perturb(&mut mesh.points, &inner, 0.02, 5);
    let cap = |id, name: &str, node, z, normal| {
        let cap = Cap { node, center: Point3::new(0.0, 0.0, z), normal, radius: 1.0 };
        Patch { id, name: name.into(), cap: Some(cap) }
    };
    let wall = Patch { id: WALL, name: "wall".into(), cap: None };
    let caps = [wall, cap(2, "inlet", 7, 0.0, -Vec3::z()), cap(3, "outlet_0", 3, LENGTH, Vec3::z())];
    let layers = |c: Vec3| (c.z / LENGTH * 20.0) as u32 / 2;
    let mut cut = MemoryParts::new(&mesh, layers, &caps, vec![0]);
    // A polygon of 18 corners is no disc.
    cut.patches.iter_mut().filter_map(|p| p.cap.as_mut()).for_each(|cap| cap.radius = 0.99);
    cut.pieces.iter_mut().flat_map(|p| &mut p.caps).for_each(|(cap, _)| cap.radius = 0.99);
    cut.certify();
    cut
}

/// Cells of a lattice, each in a part.
fn voxels(n: u32, loops: Vec<u32>, part_of: impl Fn([u32; 3]) -> Option<u32>) -> MemoryParts {
    let mut mesh = cube_lattice(n);
    let cell = |c: Vec3| [c.x, c.y, c.z].map(|x| (x * f64::from(n)) as u32);
    let middle = |t: &[u32; 4]| t.iter().fold(Vec3::zeros(), |s, &v| s + mesh.points[v as usize].coords) / 4.0;
    let tets: Vec<[u32; 4]> = mesh.tets.iter().filter(|t| part_of(cell(middle(t))).is_some()).copied().collect();
    let mut used: Vec<u32> = tets.as_flattened().to_vec();
    used.sort_unstable();
    used.dedup();
    mesh.tets = tets.iter().map(|t| t.map(|v| used.binary_search(&v).unwrap() as u32)).collect();
    mesh.points = used.iter().map(|&v| mesh.points[v as usize]).collect();
    let wall = Patch { id: WALL, name: "wall".into(), cap: None };
    MemoryParts::new(&mesh, |c| part_of(cell(c)).unwrap(), &[wall], loops)
}

/// A block with six arms of two cells each.
fn star() -> MemoryParts {
    voxels(7, vec![0], |c| {
        let inner = |x: u32| (2..5).contains(&x);
        if c.iter().all(|&x| inner(x)) {
            return Some(0);
        }
        let arm = (0..3).find(|&i| !inner(c[i]))?;
        let straight = (0..3).all(|i| i == arm || c[i] == 3);
        straight.then(|| 1 + 2 * arm as u32 + u32::from(c[arm] > 3))
    })
}

/// A square frame in the given number of parts.
fn ring(parts: u32) -> MemoryParts {
    voxels(5, vec![1], |[x, y, z]| {
        let on = z == 2 && (x == 0 || x == 4 || y == 0 || y == 4);
        let part = match (x, y) {
            (2.., 4) => 1,
            (4, ..4) => 2,
            (_, 0) => 3,
            _ => 0,
        };
        on.then_some(part % parts)
    })
}
