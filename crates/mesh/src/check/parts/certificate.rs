//! Certificate of one part, checked separately.

use super::sums::{face_sum, point_sum};
use super::{Certificate, Fault, HeldCap, HeldJoint, HeldSurface, PartView};
use crate::TetMesh;
use crate::adjacency::{NONE, TetAdjacency, face_vertices};
use crate::check::cells;
use crate::check::labels;
use crate::check::nested::{Enclosed, enclosed};
use crate::check::result::{Line, LineResult, Offender, OffenderKind, Tally};
use crate::check::surface::Boundary;
use crate::check::surfaces::{Surface, Surfaces, surfaces};
use crate::face_key;
use crate::geometry::predicates::in_exact_range;
use crate::geometry::{Aabb, DisjointSets, Point3, Vec3, is_star_shaped};
use crate::quality::{QualityPiece, QualitySum};
use nalgebra::Matrix3;
use std::borrow::Borrow;

/// Pairs of faces that meet improperly which a certificate keeps.
const KEPT_INTERSECTIONS: usize = 100;

/// Owner of a boundary face.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Owner {
    Wall,
    Joint(u32),
    Cap(u32),
}

/// Checks a part alone; see the [module](super) for what that says of the whole. Sequential: the thread that made a part
/// certifies it. `adjacency` gives what [`tet_adjacency`](crate::adjacency::tet_adjacency) says of the part's mesh.
pub fn certify_with<A: Borrow<TetAdjacency>>(part: &PartView, adjacency: impl FnOnce() -> A) -> Certificate {
    let mesh = part.mesh;
    let mut certificate = Certificate {
        points: mesh.points.len() as u32,
        tets: mesh.tets.len() as u32,
        joints: vec![HeldJoint::default(); part.joints.len()],
        ..Certificate::default()
    };
    if !has_sound_arrays(mesh) {
        certificate.take([cells::finite_points(mesh), cells::indices_in_range(mesh)]);
        certificate.unsound = true;
        return certificate;
    }
    let adjacency = adjacency();
    let adjacency = adjacency.borrow();
    let are_cells_sound = certificate.measure_cells(mesh, adjacency);
    if !are_cells_sound {
        certificate.take(cells::lines(mesh, adjacency));
    }
    certificate.look_at_boundary(part, adjacency, are_cells_sound);
    // Else equal points are excluded by what has been found, see `super`.
    if !certificate.faults.is_empty() {
        certificate.take([cells::no_duplicate_points(mesh)]);
    }
    certificate
}

/// As [`certify_with`], for a part that is its closed surface `hull` alone. What concerns tetrahedra holds of those that
/// could fill it.
pub fn certify_hollow(part: &PartView, hull: &[[u32; 3]]) -> Certificate {
    let mesh = part.mesh;
    let mut certificate = Certificate {
        points: mesh.points.len() as u32,
        joints: vec![HeldJoint::default(); part.joints.len()],
        ..Certificate::default()
    };
    let mut indices = Tally::new(Line::IndicesInRange);
    for &face in hull.iter().filter(|face| face.iter().any(|&v| v as usize >= mesh.points.len())) {
        indices.add(|| labels::face_at(&mesh.points, face));
    }
    let indices = indices.done();
    if !has_sound_arrays(mesh) || indices.fails() {
        certificate.take([cells::finite_points(mesh), indices]);
        certificate.unsound = true;
        return certificate;
    }
    certificate.look_at_hull(part, hull);
    if !certificate.faults.is_empty() {
        certificate.take([cells::no_duplicate_points(mesh)]);
    }
    certificate
}

fn has_sound_arrays(mesh: &TetMesh) -> bool {
    has_sound_points(mesh) && mesh.tets.as_flattened().iter().all(|&v| (v as usize) < mesh.points.len())
}

pub(super) fn has_sound_points(mesh: &TetMesh) -> bool {
    mesh.points.iter().all(|p| p.iter().all(|&x| in_exact_range(x)))
}

/// True if all tetrahedra are positive, with their volume and their quality.
pub(super) fn measured(mesh: &TetMesh) -> (bool, f64, QualityPiece) {
    let mut quality = QualitySum::default();
    let (are_positive, volume) = quality.include_all(&mesh.points, &mesh.tets);
    (are_positive, volume / 6.0, quality.piece())
}

/// Bounding box of faces.
pub(super) fn bounds_of(points: &[Point3], faces: &[[u32; 3]]) -> [[f64; 3]; 2] {
    let bounds = Aabb::of_points(faces.as_flattened().iter().map(|&v| &points[v as usize]));
    [bounds.min.coords.into(), bounds.max.coords.into()]
}

/// True if the boundary of positive tetrahedra is star-shaped. They meet from opposite sides, so it is a cycle.
pub(super) fn is_star(part: &PartView, boundary: &[[u32; 3]]) -> bool {
    is_star_shaped(&part.mesh.points, boundary, &middle(part))
}

impl Certificate {
    /// Keeps the lines that fail.
    fn take(&mut self, lines: impl IntoIterator<Item = LineResult>) {
        for line in lines.into_iter().filter(LineResult::fails) {
            self.faults.push(Fault { line: line.line, count: line.count, offenders: line.offenders });
        }
    }

    /// Measures the tetrahedra, and says whether all lines about them hold.
    fn measure_cells(&mut self, mesh: &TetMesh, adjacency: &TetAdjacency) -> bool {
        let mut used = vec![false; mesh.points.len()];
        let are_positive;
        (are_positive, self.volume, self.quality) = measured(mesh);
        mesh.tets.as_flattened().iter().for_each(|&v| used[v as usize] = true);
        // Positive tetrahedra have four vertices each. Two with the same vertices are neighbours by a face (or it is
        // crowded), and when both are positive they see it turn the same way.
        let are_linked = adjacency.crowded.is_empty() && neighbors_are_opposite(mesh, adjacency);
        are_positive && are_linked && used.iter().all(|&used| used)
    }

    /// Everything about the part's closed surface.
    fn look_at_boundary(&mut self, part: &PartView, adjacency: &TetAdjacency, are_cells_sound: bool) {
        let handles: Vec<u32> = adjacency.boundary().collect();
        let faces: Vec<[u32; 3]> = handles.iter().map(|&handle| face_vertices(&part.mesh.tets, handle)).collect();
        let is_star = are_cells_sound && is_star(part, &faces);
        let (owners, surfaces) = self.look_at_faces(part, &faces, is_star);
        let enclosed = match surfaces.all.len() {
            // The tetrahedra tell better.
            1 => vec![Enclosed::exactly(self.volume)],
            _ => enclosed(&part.mesh.points, &faces, &surfaces),
        };
        self.hold_surfaces(&faces, &owners, &surfaces, enclosed);
        self.hold_components(adjacency, &handles, &owners);
        self.hold_joints(part, &surfaces);
        self.hold_caps(part);
    }

    /// Checks a part that has faces only. Each outer surface encloses one component.
    fn look_at_hull(&mut self, part: &PartView, faces: &[[u32; 3]]) {
        let (owners, surfaces) = self.look_at_faces(part, faces, false);
        let enclosed = enclosed(&part.mesh.points, faces, &surfaces);
        self.volume = enclosed.iter().map(Enclosed::volume).sum();
        self.components = enclosed.iter().filter(|enclosed| !enclosed.is_cavity()).count() as u32;
        self.hold_surfaces(faces, &owners, &surfaces, enclosed);
        self.hold_joints(part, &surfaces);
        self.hold_caps(part);
    }

    /// Checks the boundary faces. Returns the owner and the surface of each.
    fn look_at_faces(&mut self, part: &PartView, faces: &[[u32; 3]], is_star: bool) -> (Vec<Owner>, Surfaces) {
        let points = &part.mesh.points[..];
        let (owners, labels) = owners(part, faces);
        self.take([labels]);
        let surfaces = if is_star { surfaces(points.len(), faces) } else { self.compare_faces(points, faces) };
        self.bounds = bounds_of(points, faces);
        let sums: Vec<u64> = points.iter().map(point_sum).collect();
        for (face, owner) in faces.iter().zip(&owners) {
            let sum = face_sum(face.map(|v| sums[v as usize]));
            match *owner {
                Owner::Joint(j) => self.joints[j as usize].sum = self.joints[j as usize].sum.wrapping_add(sum),
                Owner::Wall | Owner::Cap(_) => {
                    self.wall_sum = self.wall_sum.wrapping_add(sum);
                    self.wall_faces += 1;
                }
            }
        }
        (owners, surfaces)
    }

    /// Compares the boundary faces with each other. Returns the surface of each.
    fn compare_faces(&mut self, points: &[Point3], faces: &[[u32; 3]]) -> Surfaces {
        let boundary = Boundary::new(points, faces);
        let (contacts, intersections) = boundary.self_intersections(false, &());
        self.take(boundary.manifold_lines().into_iter().chain([contacts]));
        self.intersections = intersections;
        self.intersections.truncate(KEPT_INTERSECTIONS);
        boundary.into_surfaces()
    }

    fn hold_surfaces(&mut self, faces: &[[u32; 3]], owners: &[Owner], surfaces: &Surfaces, enclosed: Vec<Enclosed>) {
        let held = |(surface, enclosed): (&Surface, Enclosed)| HeldSurface {
            vertex: NONE,
            euler: surface.euler() as i32,
            enclosed,
        };
        self.surfaces = surfaces.all.iter().zip(enclosed).map(held).collect();
        // Vertices inside joints are none of the whole's boundary.
        for (face, _) in faces.iter().zip(owners).filter(|(_, owner)| !matches!(owner, Owner::Joint(_))) {
            for &v in face {
                let held = &mut self.surfaces[surfaces.of[v as usize] as usize];
                held.vertex = held.vertex.min(v);
            }
        }
    }

    fn hold_components(&mut self, adjacency: &TetAdjacency, handles: &[u32], owners: &[Owner]) {
        let count = adjacency.neighbors.len();
        if is_connected(adjacency) {
            self.components = count.min(1) as u32;
            return;
        }
        let mut sets = DisjointSets::new(count);
        for (tet, row) in adjacency.neighbors.iter().enumerate() {
            for &neighbor in row.iter().filter(|&&neighbor| neighbor != NONE) {
                sets.join(tet as u32, neighbor / 4);
            }
        }
        let mut number = vec![NONE; count];
        for tet in (0..count as u32).filter(|&tet| sets.root(tet) == tet).collect::<Vec<_>>() {
            number[tet as usize] = self.components;
            self.components += 1;
        }
        for (handle, owner) in handles.iter().zip(owners) {
            if let Owner::Joint(j) = *owner {
                self.joints[j as usize].component = number[sets.root(handle / 4) as usize];
            }
        }
    }

    /// Joints must be discs without common vertices.
    fn hold_joints(&mut self, part: &PartView, surfaces: &Surfaces) {
        let points = &part.mesh.points;
        let mut fans = Tally::new(Line::BoundaryFans);
        let mut joint_of = vec![NONE; points.len()];
        for (j, faces) in (0..).zip(part.joints) {
            let held = &mut self.joints[j as usize];
            held.faces = faces.len() as u32;
            let exist = faces.as_flattened().iter().all(|&v| (v as usize) < points.len());
            let Some(first) = faces.first() else {
                fans.add(|| Offender { kind: OffenderKind::Face, ids: Vec::new(), position: None });
                continue;
            };
            if !exist {
                // Named with the labels.
                continue;
            }
            for &v in faces.as_flattened() {
                let of = &mut joint_of[v as usize];
                held.vertices += u32::from(*of != j);
                if *of != NONE && *of != j {
                    fans.add(|| cells::point_offender(points, v));
                }
                *of = j;
            }
            held.surface = surfaces.of[first[0] as usize];
            if !labels::is_disc(faces) {
                fans.add(|| cells::face_offender(points, *first));
            }
        }
        self.take([fans.done()]);
    }

    pub(super) fn hold_caps(&mut self, part: &PartView) {
        let points = &part.mesh.points;
        let hold = |(cap, faces): &(crate::Cap, Vec<[u32; 3]>)| HeldCap {
            node: cap.node,
            center: cap.center.coords.into(),
            normal: cap.normal.into(),
            radius: cap.radius,
            faces: faces.len() as u32,
            shape: if faces.as_flattened().iter().all(|&v| (v as usize) < points.len()) {
                labels::cap_shape(points, cap, faces)
            } else {
                [false; 5]
            },
        };
        self.caps = part.caps.iter().map(hold).collect();
    }
}

/// Weight of the middle between joints and caps against their axes.
const PULL: f64 = 0.01;

/// Point near the axes of all joints and caps, and about in the middle between them: the node of a fork.
fn middle(part: &PartView) -> Point3 {
    let points = &part.mesh.points;
    let discs = part.joints.iter().chain(part.caps.iter().map(|(_, faces)| faces));
    let (mut matrix, mut right) = (Matrix3::zeros(), Vec3::zeros());
    for disc in discs {
        let corners = disc.as_flattened().iter().filter_map(|&v| points.get(v as usize));
        let center = corners.map(|p| p.coords).sum::<Vec3>() / disc.as_flattened().len().max(1) as f64;
        let area = |face: &[u32; 3]| match face.map(|v| points.get(v as usize)) {
            [Some(a), Some(b), Some(c)] => (b - a).cross(&(c - a)),
            _ => Vec3::zeros(),
        };
        let axis = disc.iter().map(area).sum::<Vec3>().try_normalize(0.0).unwrap_or_default();
        let across = Matrix3::identity() * (1.0 + PULL) - axis * axis.transpose();
        matrix += across;
        right += across * center;
    }
    matrix.try_inverse().map_or_else(Point3::origin, |inverse| Point3::from(inverse * right))
}

/// As [`cells::opposite_sides`], without saying where not.
fn neighbors_are_opposite(mesh: &TetMesh, adjacency: &TetAdjacency) -> bool {
    adjacency.neighbors.as_flattened().iter().enumerate().all(|(handle, &neighbor)| {
        let handle = handle as u32;
        neighbor == NONE || handle > neighbor || {
            let ([a, b, _], [p, q, r]) = (face_vertices(&mesh.tets, handle), face_vertices(&mesh.tets, neighbor));
            // The vertices are known to be equal.
            ![[p, q], [q, r], [r, p]].contains(&[a, b])
        }
    })
}

fn is_connected(adjacency: &TetAdjacency) -> bool {
    let count = adjacency.neighbors.len();
    let mut met = vec![false; count];
    let mut pending: Vec<u32> = Vec::with_capacity(count.min(1));
    if let Some(first) = met.first_mut() {
        *first = true;
        pending.push(0);
    }
    let mut left = count;
    while let Some(tet) = pending.pop() {
        left -= 1;
        for &neighbor in &adjacency.neighbors[tet as usize] {
            if neighbor != NONE && !std::mem::replace(&mut met[neighbor as usize / 4], true) {
                pending.push(neighbor / 4);
            }
        }
    }
    left == 0
}

/// Returns the owner of each boundary face. Faces of joints and caps must be boundary faces
/// of the same orientation, each listed once.
fn owners(part: &PartView, faces: &[[u32; 3]]) -> (Vec<Owner>, LineResult) {
    let points = &part.mesh.points;
    let mut named: Vec<([u32; 3], Owner, [u32; 3])> = Vec::new();
    for (j, list) in (0..).zip(part.joints) {
        named.extend(list.iter().map(|&face| (face_key(face), Owner::Joint(j), face)));
    }
    for (c, (_, list)) in (0..).zip(part.caps) {
        named.extend(list.iter().map(|&face| (face_key(face), Owner::Cap(c), face)));
    }
    named.sort_by_key(|entry| entry.0);
    let mut on = vec![false; points.len()];
    for &v in named.iter().flat_map(|(key, ..)| key) {
        if let Some(on) = on.get_mut(v as usize) {
            *on = true;
        }
    }
    let mut met = vec![false; named.len()];
    let mut owner_of = |&face: &[u32; 3]| {
        if face.iter().all(|&v| on[v as usize])
            && let Ok(i) = named.binary_search_by_key(&face_key(face), |entry| entry.0)
            && crate::same_turn(face, named[i].2)
        {
            met[i] = true;
            return named[i].1;
        }
        Owner::Wall
    };
    let owners = faces.iter().map(&mut owner_of).collect();
    let mut tally = Tally::new(Line::LabelsMatchBoundary);
    for ((.., face), _) in named.iter().zip(&met).filter(|(_, met)| !**met) {
        tally.add(|| labels::face_at(points, *face));
    }
    (owners, tally.done())
}

#[cfg(test)]
#[path = "certificate_tests.rs"]
mod tests;
