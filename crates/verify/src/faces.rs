//! Conditions on tetrahedra and their faces.

use crate::exact::orient_3d;
use crate::mesh::Mesh;
use crate::report::{Condition as C, Ids, Report};
use crate::sets::Sets;
use crate::space::{cross, dot, minus};

/// Faces of a positive tetrahedron, oriented outwards.
pub const SIDES: [[usize; 3]; 4] = [[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]];

/// Faces of exactly one tetrahedron.
pub struct Boundary {
    /// Vertices, oriented outwards.
    pub faces: Vec<[u32; 3]>,
    /// Component of the tetrahedron of each face, from 0.
    pub component: Vec<u32>,
    /// Sorted faces between two tetrahedra that are also labelled.
    pub labelled_inside: Vec<[u32; 3]>,
}

/// Checks points, indices and tetrahedra; `None` if the arrays cannot be checked further.
pub fn check(mesh: &Mesh, report: &mut Report) -> Option<Boundary> {
    let count = mesh.points.len();
    (report.figures.points, report.figures.tets) = (count, mesh.tets.len());
    let is_inside = |t: &[u32; 4]| t.iter().all(|&v| (v as usize) < count);
    let is_finite = |i: &usize| mesh.points[*i].iter().all(|x| x.is_finite());
    let arrays = [
        report.add(C::NotEmpty, mesh.tets.is_empty().then_some("the mesh has none")),
        report.add(C::FinitePoints, (0..count).filter(|i| !is_finite(i))),
        report.add(C::IndicesInRange, (0..mesh.tets.len()).filter(|&i| !is_inside(&mesh.tets[i]))),
    ];
    if arrays != [true; 3] {
        return None;
    }
    cells(mesh, report);
    points(mesh, report);
    Some(faces(mesh, report))
}

fn cells(mesh: &Mesh, report: &mut Report) {
    let mut sorted: Vec<([u32; 4], u32)> = mesh.tets.iter().copied().zip(0..).collect();
    for (t, _) in &mut sorted {
        t.sort_unstable();
    }
    let is_repeated = |t: &[u32; 4]| t.windows(2).any(|pair| pair[0] == pair[1]);
    report.add(C::NoRepeatedVertex, sorted.iter().filter(|(t, _)| is_repeated(t)).map(|(_, i)| i));
    sorted.sort_unstable();
    let pairs = sorted.windows(2).filter(|pair| pair[0].0 == pair[1].0);
    report.add(C::NoDuplicateTets, pairs.map(|pair| Ids([pair[0].1, pair[1].1])));
    let sign = |t: &[u32; 4]| {
        let [a, b, c, d] = t.map(|v| &mesh.points[v as usize]);
        orient_3d(a, b, c, d)
    };
    report.add(C::PositiveTets, (0..mesh.tets.len()).filter(|&i| sign(&mesh.tets[i]) <= 0));
    let volume = |t: &[u32; 4]| {
        let [a, b, c, d] = t.map(|v| mesh.points[v as usize]);
        let [u, v, w] = [b, c, d].map(|p| minus(p, a));
        dot(u, cross(v, w))
    };
    report.figures.volume = mesh.tets.iter().map(volume).sum::<f64>() / 6.0;
}

fn points(mesh: &Mesh, report: &mut Report) {
    let mut used = vec![false; mesh.points.len()];
    mesh.tets.iter().flatten().for_each(|&v| used[v as usize] = true);
    // Adding zero makes both zeros equal.
    let mut places: Vec<([u64; 3], u32)> =
        mesh.points.iter().map(|p| p.map(|x| (x + 0.0).to_bits())).zip(0..).collect();
    places.sort_unstable();
    let equal = places.windows(2).filter(|pair| pair[0].0 == pair[1].0);
    report.add(C::NoDuplicatePoints, equal.map(|pair| Ids([pair[0].1, pair[1].1])));
    report.add(C::NoUnusedPoints, used.iter().enumerate().filter(|(_, used)| !**used).map(|(i, _)| i));
}

/// Vertices in ascending order.
pub fn key(mut face: [u32; 3]) -> [u32; 3] {
    face.sort_unstable();
    face
}

/// True if sorting the vertices of a triangle is an odd permutation.
pub fn is_odd(face: [u32; 3]) -> bool {
    (face[0] > face[1]) ^ (face[0] > face[2]) ^ (face[1] > face[2])
}

fn faces(mesh: &Mesh, report: &mut Report) -> Boundary {
    let face = |handle: u32| SIDES[handle as usize % 4].map(|i| mesh.tets[handle as usize / 4][i]);
    let mut sorted: Vec<([u32; 3], u32)> = (0..4 * mesh.tets.len() as u32).map(|h| (key(face(h)), h)).collect();
    sorted.sort_unstable();
    let mut labelled: Vec<[u32; 3]> = mesh.triangles.iter().map(|&t| key(t)).collect();
    labelled.sort_unstable();
    let mut sets = Sets::new(mesh.tets.len());
    let (mut crowded, mut one_sided, mut outer, mut labelled_inside) = (vec![], vec![], vec![], vec![]);
    for group in sorted.chunk_by(|a, b| a.0 == b.0) {
        group.windows(2).for_each(|pair| sets.join(pair[0].1 / 4, pair[1].1 / 4));
        match group {
            [(_, only)] => outer.push(*only),
            [(_, first), (_, second)] if is_odd(face(*first)) == is_odd(face(*second)) => one_sided.push(group[0].0),
            [_, _] => {}
            _ => crowded.push(group[0].0),
        }
        if group.len() > 1 && labelled.binary_search(&group[0].0).is_ok() {
            labelled_inside.push(group[0].0);
        }
    }
    report.add(C::FacesSharedByTwo, crowded.into_iter().map(Ids));
    report.add(C::OppositeSides, one_sided.into_iter().map(Ids));
    let (component, count) = sets.numbered();
    report.figures.components = count as usize;
    outer.sort_unstable();
    report.figures.boundary_faces = outer.len();
    Boundary {
        faces: outer.iter().map(|&handle| face(handle)).collect(),
        component: outer.iter().map(|&handle| component[handle as usize / 4]).collect(),
        labelled_inside,
    }
}

#[cfg(test)]
mod tests {
    use super::is_odd;

    #[test]
    fn orders_of_vertices_are_odd_or_even() {
        assert_eq!([[1, 2, 3], [2, 3, 1], [3, 1, 2]].map(is_odd), [false; 3]);
        assert_eq!([[1, 3, 2], [3, 2, 1], [2, 1, 3]].map(is_odd), [true; 3]);
        // Equal vertices keep their order.
        assert_eq!(
            [[1, 1, 2], [2, 1, 2], [1, 2, 1], [1, 2, 2], [1, 1, 1]].map(is_odd),
            [false, true, true, false, false]
        );
    }
}
