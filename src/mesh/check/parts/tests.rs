//! Meshes cut into parts: the check of the parts says what the check of the whole says, and planted faults are found.

use super::*;
use crate::geometry::Vec3;
use crate::mesh::adjacency::{boundary_faces, face_vertices, tet_adjacency};
use crate::mesh::check::cells::sorted;
use crate::mesh::check::disjoint_sets::DisjointSets;
use crate::mesh::check::{CheckReport, Expectation, Outcome, Skipped, Verdict, check_volume};
use crate::mesh::shapes::{cube_lattice, perturb, tube_lattice};
use crate::mesh::{Patch, VolumeMesh, WALL};
use std::collections::{BTreeMap, BTreeSet};

/// A part in memory.
#[derive(Clone, Default)]
struct Piece {
    mesh: TetMesh,
    joints: Vec<Vec<[u32; 3]>>,
    caps: Vec<(Cap, Vec<[u32; 3]>)>,
    /// Ids in the whole.
    vertices: Vec<u32>,
    tets: Vec<u64>,
}

/// Parts in memory.
#[derive(Clone, Default)]
struct Cut {
    pieces: Vec<Piece>,
    joined: Vec<[(u32, u32); 2]>,
    patches: Vec<Patch>,
    expectation: Expectation,
    certificates: Vec<Certificate>,
}

impl Piece {
    fn certificate(&self) -> Certificate {
        certify(&PartView { mesh: &self.mesh, joints: &self.joints, caps: &self.caps })
    }

    /// Some of its faces, with points and ids of their own.
    fn faces(&self, faces: &[[u32; 3]]) -> WallPiece {
        let mut used: Vec<u32> = faces.as_flattened().to_vec();
        used.sort_unstable();
        used.dedup();
        WallPiece {
            points: used.iter().map(|&v| self.mesh.points[v as usize]).collect(),
            vertices: used.iter().map(|&v| self.vertices[v as usize]).collect(),
            faces: faces.iter().map(|f| f.map(|v| used.binary_search(&v).unwrap() as u32)).collect(),
        }
    }
}

impl Parts for Cut {
    fn count(&self) -> usize {
        self.pieces.len()
    }

    fn certificate(&self, part: u32) -> io::Result<Certificate> {
        Ok(self.certificates[part as usize].clone())
    }

    fn wall(&self, part: u32) -> io::Result<WallPiece> {
        let piece = &self.pieces[part as usize];
        let is_joined = |j: u32| self.joined.as_flattened().contains(&(part, j));
        let inner: BTreeSet<[u32; 3]> = (0..)
            .zip(&piece.joints)
            .filter(|(j, _)| is_joined(*j))
            .flat_map(|(_, faces)| faces.iter().map(|&f| sorted(f)))
            .collect();
        let mut faces = boundary_faces(&piece.mesh);
        faces.retain(|&f| !inner.contains(&sorted(f)));
        Ok(piece.faces(&faces))
    }

    fn joined(&self) -> &[[(u32, u32); 2]] {
        &self.joined
    }

    fn joint(&self, part: u32, joint: u32) -> io::Result<JointFaces> {
        let piece = &self.pieces[part as usize];
        let WallPiece { points, vertices, faces } = piece.faces(&piece.joints[joint as usize]);
        Ok(JointFaces { points, vertices, faces })
    }

    fn vertex(&self, part: u32, local: u32) -> u32 {
        self.pieces[part as usize].vertices[local as usize]
    }

    fn tet(&self, part: u32, local: u32) -> u64 {
        self.pieces[part as usize].tets[local as usize]
    }
}

impl Cut {
    /// Cuts a mesh; faces between two parts that hang together by vertices are a joint.
    fn new(mesh: &TetMesh, part_of: impl Fn(Vec3) -> u32, caps: &[Patch], loops: Vec<u32>) -> Self {
        let middle = |t: &[u32; 4]| t.iter().fold(Vec3::zeros(), |s, &v| s + mesh.points[v as usize].coords) / 4.0;
        let parts: Vec<u32> = mesh.tets.iter().map(|t| part_of(middle(t))).collect();
        let count = parts.iter().max().map_or(0, |&p| p + 1);
        let terminals = caps.iter().filter_map(|p| p.cap.map(|c| c.node)).collect();
        let mut cut = Self { patches: caps.to_vec(), expectation: Expectation { loops, terminals }, ..Self::default() };
        for part in 0..count {
            let tets: Vec<u64> = (0..).zip(&parts).filter(|(_, p)| **p == part).map(|(i, _)| i).collect();
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
        cut.find_joints(mesh, &parts);
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

    /// The mesh put together by ids.
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
                let patch = piece.caps.iter().find(|(_, of)| of.iter().any(|f| sorted(f.map(whole)) == sorted(face)));
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
        check_parts(self, &self.patches, Some(&self.expectation), 1 << 20).unwrap()
    }

    fn whole(&self) -> CheckReport {
        check_volume(&self.merged(), Some(&self.expectation))
    }

    fn failing(&self) -> Vec<Line> {
        self.check().failed().map(|result| result.line).collect()
    }
}

/// Certifies again after a change, and names the lines that fail.
fn planted(cut: &Cut, change: impl FnOnce(&mut Cut)) -> (Cut, Vec<Line>) {
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

/// Everything but roundoff is the same.
fn assert_same(cut: &Cut) {
    let (parts, whole) = (cut.check(), cut.whole());
    assert_eq!(parts.verdict, whole.verdict, "{:?}", parts.failed().collect::<Vec<_>>());
    for (p, w) in parts.lines.iter().zip(&whole.lines) {
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
    assert_eq!(crate::mesh::check::Counts { volume: whole.counts.volume, ..parts.counts }, whole.counts);
    let (p, w) = (parts.quality.unwrap(), whole.quality.unwrap());
    assert!(close(p.mean, w.mean) && close(p.dihedral_min, w.dihedral_min) && close(p.dihedral_max, w.dihedral_max));
    assert_eq!((p.tets, p.histogram, p.min.to_bits()), (w.tets, w.histogram, w.min.to_bits()));
    assert!((p.percentile_1 - w.percentile_1).abs() <= 0.0025);
}

const LENGTH: f64 = 5.0;

/// A vessel along z with a cap at either end, in slices of two layers.
fn bar() -> Cut {
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
    let mut cut = Cut::new(&mesh, layers, &caps, vec![0]);
    // A polygon of 18 corners is no disc.
    cut.patches.iter_mut().filter_map(|p| p.cap.as_mut()).for_each(|cap| cap.radius = 0.99);
    cut.pieces.iter_mut().flat_map(|p| &mut p.caps).for_each(|(cap, _)| cap.radius = 0.99);
    cut.certify();
    cut
}

/// Cells of a lattice, each in a part.
fn voxels(n: u32, loops: Vec<u32>, part_of: impl Fn([u32; 3]) -> Option<u32>) -> Cut {
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
    Cut::new(&mesh, |c| part_of(cell(c)).unwrap(), &[wall], loops)
}

/// A block with six arms of two cells each.
fn star() -> Cut {
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

/// A square frame, in this many parts.
fn ring(parts: u32) -> Cut {
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

#[test]
fn parts_of_sound_meshes_pass_as_the_whole_does() {
    let bar = bar();
    assert_eq!((bar.pieces.len(), bar.joined.len()), (10, 9));
    assert_eq!(bar.check().verdict, Verdict::Valid);
    for cut in [bar, star(), ring(4), ring(2)] {
        assert!(cut.certificates.iter().all(Certificate::is_sound));
        assert_same(&cut);
        assert_eq!(cut.check().verdict, Verdict::Valid, "{:?}", cut.check().failed().collect::<Vec<_>>());
    }
    assert_eq!(ring(2).joined.len(), 4);
}

#[test]
fn certificates_survive_being_stored() {
    for certificate in
        bar().certificates.iter().chain(&planted(&bar(), |c| c.pieces[3].mesh.tets[5].swap(0, 1)).0.certificates)
    {
        let text = serde_json::to_string(certificate).unwrap();
        assert_eq!(&serde_json::from_str::<Certificate>(&text).unwrap(), certificate);
    }
}

#[test]
fn genus_and_components_are_compared() {
    let mut cut = ring(4);
    cut.expectation.loops = vec![0];
    let report = cut.check();
    assert_eq!(report.failed().map(|l| l.line).collect::<Vec<_>>(), [Line::Loops]);
    assert_same(&cut);
    cut.expectation.loops = vec![1, 0];
    assert_eq!(cut.failing(), [Line::Components, Line::Loops]);
    assert_same(&cut);
}

#[test]
fn faults_inside_a_part_are_named_in_numbers_of_the_whole() {
    let inverted = planted(&bar(), |c| c.pieces[4].mesh.tets[7].swap(1, 2)).0;
    assert_same(&inverted);
    assert_eq!(inverted.failing(), [Line::PositiveTets, Line::OppositeSides]);
    let (twice, lines) = planted(&star(), |c| {
        let t = c.pieces[0].mesh.tets[5];
        c.pieces[0].mesh.tets.push(t);
        c.pieces[0].tets.push(10_000);
    });
    assert!(lines.contains(&Line::NoDuplicateTets) && lines.contains(&Line::FacesSharedByTwo));
    same_offenders(&twice.check(), &twice.whole(), Line::FacesSharedByTwo);
    let (unused, lines) = planted(&star(), |c| {
        c.pieces[3].mesh.points.push(Point3::new(0.3, 0.2, 0.1));
        let id = c.pieces.iter().flat_map(|p| &p.vertices).max().unwrap() + 1;
        c.pieces[3].vertices.push(id);
    });
    assert_eq!(lines, [Line::NoUnusedPoints]);
    assert_same(&unused);
    let (copied, lines) = planted(&star(), |c| {
        let p = c.pieces[3].mesh.points[2];
        c.pieces[3].mesh.points.push(p);
        let id = c.pieces.iter().flat_map(|p| &p.vertices).max().unwrap() + 1;
        c.pieces[3].vertices.push(id);
    });
    assert_eq!(lines, [Line::NoDuplicatePoints, Line::NoUnusedPoints]);
    assert_same(&copied);
    let (moved, lines) = planted(&bar(), |c| c.pieces[4].mesh.points[0] = Point3::new(f64::NAN, 0.0, 0.0));
    assert_eq!(lines, [Line::FinitePoints]);
    assert_eq!(
        moved.check().line(Line::Loops).unwrap().outcome,
        Outcome::NotChecked(Skipped::Because(Line::FinitePoints))
    );
    let (_, lines) = planted(&bar(), |c| c.pieces[4].mesh.tets[3][1] = 1_000_000);
    assert_eq!(lines, [Line::IndicesInRange]);
    assert_eq!(Cut::default().failing(), [Line::NotEmpty]);
}

#[test]
fn faults_of_joints() {
    // A joint's vertex moved in one of its parts.
    let bar = bar();
    let v = bar.pieces[5].joints[0][0][0];
    let id = i64::from(bar.pieces[5].vertices[v as usize]);
    let (moved, lines) = planted(&bar, |c| c.pieces[5].mesh.points[v as usize].x += 1e-9);
    assert_eq!(lines, [Line::NoDuplicatePoints]);
    assert_eq!(moved.check().line(Line::NoDuplicatePoints).unwrap().offenders[0].ids, [id]);
    // A joint that is joined to nothing: twice the same faces.
    let (_, lines) = planted(&bar, |c| {
        c.joined.remove(4);
    });
    assert!(lines.contains(&Line::NoSelfIntersection) && lines.contains(&Line::Components), "{lines:?}");
    // Joined twice.
    let (twice, lines) = planted(&bar, |c| c.joined.push(c.joined[4]));
    assert_eq!(lines, [Line::FacesSharedByTwo]);
    assert_eq!(twice.check().line(Line::FacesSharedByTwo).unwrap().count, bar.pieces[5].joints[0].len() as u64);
    // A face less in one of its parts.
    let face = bar.pieces[5].joints[0][3];
    let (less, lines) = planted(&bar, |c| {
        c.pieces[5].joints[0].remove(3);
    });
    assert!(lines.contains(&Line::LabelsMatchBoundary), "{lines:?}");
    let ids: BTreeSet<i64> = face.iter().map(|&v| i64::from(bar.pieces[5].vertices[v as usize])).collect();
    let named = &less.check().line(Line::LabelsMatchBoundary).unwrap().offenders[0].ids.clone();
    assert_eq!(named.iter().copied().collect::<BTreeSet<_>>(), ids);
    // Turned the wrong way.
    let (_, lines) = planted(&bar, |c| c.pieces[5].joints[0].iter_mut().for_each(|f| f.swap(0, 1)));
    assert!(lines.contains(&Line::LabelsMatchBoundary), "{lines:?}");
    // Two ids exchanged in one of its parts.
    let (_, lines) = planted(&bar, |c| {
        let w = c.pieces[5].joints[0][0][1];
        c.pieces[5].vertices.swap(v as usize, w as usize);
    });
    assert!(lines.contains(&Line::NoDuplicatePoints), "{lines:?}");
    // A joint that is no face of the part.
    let inner = tet_adjacency(&bar.pieces[5].mesh.tets, bar.pieces[5].mesh.points.len()).neighbors;
    let handle = inner.as_flattened().iter().position(|&n| n != u32::MAX).unwrap() as u32;
    let face = face_vertices(&bar.pieces[5].mesh.tets, handle);
    let (_, lines) = planted(&bar, |c| c.pieces[5].joints[0][0] = face);
    assert!(lines.contains(&Line::LabelsMatchBoundary), "{lines:?}");
    let mut piece = bar.pieces[5].clone();
    piece.joints[0][0] = [1_000_000, 0, 1];
    assert_eq!(piece.certificate().faults()[0].line, Line::LabelsMatchBoundary);
    // Joints that do not exist are no mesh at all.
    let mut wrong = bar.clone();
    wrong.joined.push([(3, 9), (4, 0)]);
    assert!(check_parts(&wrong, &wrong.patches, None, 0).is_err());
}

#[test]
fn faults_of_ids() {
    // A point of an arm's tip is called as one of another arm's.
    let star = star();
    let ids: Vec<u32> = star.pieces[1].vertices.clone();
    let free = ids.iter().copied().find(|id| !star.pieces[0].vertices.contains(id)).unwrap();
    let tip = star.pieces[4].vertices.iter().position(|id| !star.pieces[0].vertices.contains(id)).unwrap();
    let own = star.pieces[4].vertices[tip];
    let (twice, lines) = planted(&star, |c| c.pieces[4].vertices[tip] = free);
    assert_eq!(lines, [Line::NoUnusedPoints, Line::BoundaryFans]);
    assert_eq!(twice.check().line(Line::BoundaryFans).unwrap().offenders[0].ids, [i64::from(free)]);
    assert_eq!(twice.check().line(Line::NoUnusedPoints).unwrap().offenders[0].ids, [i64::from(own)]);
    let (_, lines) = planted(&star, |c| c.pieces[4].vertices[tip] = 1_000_000);
    assert_eq!(lines, [Line::IndicesInRange, Line::NoUnusedPoints]);
}

/// Adds a part that is joined to nothing, and expects a component more.
fn with_part(cut: &Cut, mesh: TetMesh) -> (Cut, Vec<Line>) {
    planted(cut, |c| {
        let first = c.pieces.iter().flat_map(|p| &p.vertices).max().unwrap() + 1;
        let tets = c.pieces.iter().flat_map(|p| &p.tets).max().unwrap() + 1;
        let vertices = (0..mesh.points.len() as u32).map(|v| v + first).collect();
        let tets = (0..mesh.tets.len() as u64).map(|t| t + tets).collect();
        c.pieces.push(Piece { mesh, vertices, tets, ..Piece::default() });
        c.expectation.loops.push(0);
    })
}

fn cube_at(corner: [f64; 3], size: f64) -> TetMesh {
    let mut mesh = cube_lattice(2);
    mesh.points.iter_mut().for_each(|p| *p = Point3::from(p.coords * size + Vec3::from(corner)));
    mesh
}

#[test]
fn parts_that_meet_are_found() {
    let star = star();
    assert_same(&with_part(&star, cube_at([2.0, 0.0, 0.0], 0.1)).0);
    let seventh = 1.0 / 7.0;
    let cases = [
        // Through a wall; on a wall with a corner; with an edge on an edge; corner to corner; face to face.
        [0.7, 0.45, 0.43],
        [5.0 * seventh, 0.45, 0.69],
        [5.0 * seventh, 5.0 * seventh, 0.5],
        [5.0 * seventh, 5.0 * seventh, 5.0 * seventh],
        [5.0 * seventh, 0.31, 0.31],
    ];
    for corner in cases {
        let (cut, lines) = with_part(&star, cube_at(corner, 0.09));
        assert!(lines.contains(&Line::NoSelfIntersection), "{lines:?}");
        let (parts, whole) = (cut.check(), cut.whole());
        same_offenders_or_more(&parts, &whole);
        let set = |r: &CheckReport| r.intersections.iter().map(|i| (faces(i), i.kind)).collect::<BTreeSet<_>>();
        assert_eq!(set(&parts), set(&whole));
    }
}

fn faces(i: &Intersection) -> BTreeSet<[u32; 3]> {
    i.faces.iter().map(|&f| sorted(f)).collect()
}

/// The same lines fail; where parts overlap, equal points need not be known.
fn same_offenders_or_more(parts: &CheckReport, whole: &CheckReport) {
    for (p, w) in parts.lines.iter().zip(&whole.lines) {
        let unknown = Outcome::NotChecked(Skipped::Because(Line::NoSelfIntersection));
        assert!(p.outcome == w.outcome || (p.line == Line::NoDuplicatePoints && p.outcome == unknown), "{p:?} {w:?}");
        if p.outcome == Outcome::Fail {
            assert_eq!(p.count, w.count, "{:?}", p.line);
        }
    }
}

#[test]
fn a_part_within_another_is_found_and_one_in_a_cavity_is_not() {
    let (nested, lines) = with_part(&star(), cube_at([0.45, 0.45, 0.45], 0.05));
    assert_eq!(lines, [Line::NoSelfIntersection]);
    let (parts, whole) = (nested.check(), nested.whole());
    same_offenders(&parts, &whole, Line::NoSelfIntersection);
    same_offenders_or_more(&parts, &whole);
    // A hollow block in two halves would have a joint that is no disc; in one part with a stem it is legal.
    let hollow = voxels(5, vec![0, 0], |c| {
        if c.iter().all(|&x| x == 1) {
            return None;
        }
        c.iter().all(|&x| x < 3).then_some(0).or_else(|| (c[0] >= 3 && c[1] == 1 && c[2] == 1).then_some(1))
    });
    assert_eq!(hollow.check().counts.boundary_components, 2);
    assert_eq!(hollow.failing(), [Line::Components]);
    assert_same(&hollow);
    let (inside, lines) = with_part(&hollow, cube_at([0.25, 0.25, 0.25], 0.1));
    assert!(!lines.contains(&Line::NoSelfIntersection));
    assert_same(&inside);
    let (inside, lines) = with_part(&hollow, cube_at([0.05, 0.05, 0.05], 0.1));
    assert!(lines.contains(&Line::NoSelfIntersection));
    same_offenders(&inside.check(), &inside.whole(), Line::NoSelfIntersection);
}

#[test]
fn faults_of_caps() {
    let bar = bar();
    let (missing, lines) = planted(&bar, |c| c.pieces[0].caps.clear());
    assert_eq!(lines, [Line::CapDisc, Line::CapFlat, Line::CapCentred, Line::CapArea, Line::CapNormal]);
    assert_same(&missing);
    let (_, lines) = planted(&bar, |c| drop(c.patches.remove(1)));
    assert_eq!(lines, [Line::WallOrCap, Line::CapPerTerminal]);
    let (hole, lines) = planted(&bar, |c| {
        c.pieces[0].caps[0].1.remove(0);
    });
    assert!(lines.contains(&Line::CapDisc));
    assert_same(&hole);
    let (_, lines) = planted(&bar, |c| {
        let face = c.pieces[0].joints[0][0];
        c.pieces[0].caps[0].1.push(face);
    });
    assert!(lines.contains(&Line::LabelsMatchBoundary) && lines.contains(&Line::CapDisc), "{lines:?}");
    let (tilted, lines) = planted(&bar, |c| {
        let tilt = Vec3::new(1e-8, 0.0, -1.0).normalize();
        c.pieces[0].caps[0].0.normal = tilt;
        c.patches[1].cap.as_mut().unwrap().normal = tilt;
    });
    assert_eq!(lines, [Line::CapFlat]);
    assert_same(&tilted);
}

/// Walls that were changed after they were certified.
#[test]
fn what_was_not_certified_is_refused() {
    let mut cut = bar();
    cut.pieces[4].mesh.points.iter_mut().for_each(|p| p.x *= 1.5);
    assert_eq!(check_parts(&cut, &cut.patches, None, 0).unwrap_err().kind(), io::ErrorKind::InvalidData);
}

#[test]
fn the_result_depends_neither_on_memory_nor_on_threads() {
    let (cut, _) = with_part(&star(), cube_at([0.7, 0.45, 0.43], 0.09));
    let expected = cut.check();
    for memory in [0, 20_000, usize::MAX] {
        let report = check_parts(&cut, &cut.patches, Some(&cut.expectation), memory).unwrap();
        assert_eq!((&report, &report.intersections), (&expected, &expected.intersections));
    }
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    assert_eq!(pool.install(|| cut.check()), expected);
}
