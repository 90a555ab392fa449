//! Conditions on tetrahedra and their faces.

use crate::exact::orient_3d;
use crate::mesh::Mesh;
use crate::report::{Condition as C, Ids, Report};
use crate::sets::Sets;
use crate::sides::{FACES, Sides, key};
use crate::space::{cross, dot, minus};
use itertools::Itertools as _;

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
    let sorted = mesh.tets.iter().map(|&t| key(t)).collect_vec();
    let is_repeated = |t: &[u32; 4]| t.windows(2).any(|pair| pair[0] == pair[1]);
    report.add(C::NoRepeatedVertex, (0..sorted.len()).filter(|&i| is_repeated(&sorted[i])));
    report.add(C::NoDuplicateTets, equal_pairs(sorted));
    let corners = |t: &[u32; 4]| t.map(|v| mesh.points[v as usize]);
    let is_positive = |t: &[u32; 4]| {
        let [a, b, c, d] = corners(t);
        orient_3d(&a, &b, &c, &d) > 0
    };
    report.add(C::PositiveTets, (0..mesh.tets.len()).filter(|&i| !is_positive(&mesh.tets[i])));
    let volume = |t: &[u32; 4]| {
        let [a, b, c, d] = corners(t);
        let [u, v, w] = [b, c, d].map(|p| minus(p, a));
        dot(u, cross(v, w))
    };
    report.figures.volume = mesh.tets.iter().map(volume).sum::<f64>() / 6.0;
}

fn points(mesh: &Mesh, report: &mut Report) {
    // Adding zero makes both zeros equal.
    let places = mesh.points.iter().map(|p| p.map(|x| (x + 0.0).to_bits()));
    report.add(C::NoDuplicatePoints, equal_pairs(places.collect()));
    let mut used = vec![false; mesh.points.len()];
    for &v in mesh.tets.as_flattened() {
        used[v as usize] = true;
    }
    report.add(C::NoUnusedPoints, (0..used.len()).filter(|&i| !used[i]));
}

/// Pairs of numbers of equal values.
fn equal_pairs<T: Ord + Copy>(values: Vec<T>) -> Vec<Ids<2>> {
    let numbered = values.into_iter().zip(0_u32..).sorted_unstable().collect_vec();
    let pairs = numbered.windows(2).filter(|pair| pair[0].0 == pair[1].0);
    pairs.map(|pair| Ids([pair[0].1, pair[1].1])).collect()
}

fn faces(mesh: &Mesh, report: &mut Report) -> Boundary {
    let sides = Sides::new(&mesh.tets, FACES);
    let labelled = mesh.triangles.iter().map(|&t| key(t)).sorted_unstable().collect_vec();
    let mut sets = Sets::new(mesh.tets.len());
    let (mut crowded, mut one_sided, mut outer, mut labelled_inside) = (vec![], vec![], vec![], vec![]);
    for group in sides.groups() {
        group.windows(2).for_each(|pair| sets.join(pair[0].1 / 4, pair[1].1 / 4));
        match group {
            [(_, only)] => outer.push(*only),
            [first, second] if sides.is_odd(first) == sides.is_odd(second) => one_sided.push(first.0),
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
    outer.sort_unstable();
    (report.figures.components, report.figures.boundary_faces) = (count as usize, outer.len());
    Boundary {
        faces: outer.iter().map(|&handle| sides.vertices(handle)).collect(),
        component: outer.iter().map(|&handle| component[handle as usize / 4]).collect(),
        labelled_inside,
    }
}
