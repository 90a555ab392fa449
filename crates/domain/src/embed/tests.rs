//! Pieces against an independent division in exact rationals, and embeddings as a whole.

use super::*;
use crate::error::DomainError;
use crate::plan::{DomainPlanError, Thickness, TissuePlan, TissueShape};
use anastomesh_mesh::geometry::{Aabb, Vec3};
use anastomesh_mesh::shapes::{cube_lattice, perturb, sphere_surface};
use anastomesh_mesh::{Point3, TetMesh};
use anastomesh_skeleton::Skeleton;
use anastomesh_skeleton::fixtures::{network, tangle};
use anastomesh_tet::TetError;
use num_rational::BigRational;
use proptest::prelude::*;

type Vector = [BigRational; 3];

fn exact(x: f64) -> BigRational {
    BigRational::from_float(x).expect("finite")
}

fn minus(p: &Point3, q: &Point3) -> Vector {
    std::array::from_fn(|i| exact(p[i]) - exact(q[i]))
}

fn det([a, b, c]: [&Vector; 3]) -> BigRational {
    let minor = |i: usize, j: usize| &b[i] * &c[j] - &b[j] * &c[i];
    &a[0] * minor(1, 2) + &a[1] * minor(2, 0) + &a[2] * minor(0, 1)
}

/// Parameters between which a segment lies in a closed tetrahedron; `None` if that is a point or nothing.
fn interval([p, q]: [&Point3; 2], at: [&Point3; 4]) -> Option<[BigRational; 2]> {
    let (mut low, mut high) = (exact(0.0), exact(1.0));
    for i in 0..4 {
        let [a, b, c] = [1, 2, 3].map(|k| at[(i + k) % 4]);
        let (u, v) = (minus(b, a), minus(c, a));
        let side = |x: &Point3| det([&u, &v, &minus(x, a)]);
        let inwards = side(at[i]);
        let [from, to] = [p, q].map(|x| side(x) * &inwards);
        let zero = exact(0.0);
        let turn = || &from / (&from - &to);
        match (from < zero, to < zero) {
            (true, true) => return None,
            (true, false) => low = low.max(turn()),
            (false, true) => high = high.min(turn()),
            (false, false) => {}
        }
    }
    (low < high).then_some([low, high])
}

/// First cell and parameters of each part of a segment.
fn divided(mesh: &TetMesh, ends: [&Point3; 2]) -> Vec<(u32, [BigRational; 2])> {
    let corners = |tet: &[u32; 4]| tet.map(|v| &mesh.points[v as usize]);
    let around = Aabb::of_points(ends);
    let near = |at: [&Point3; 4]| Aabb::of_points(at).overlaps(&around);
    let found = |(id, tet)| Some(corners(tet)).filter(|at| near(*at)).and_then(|at| Some((interval(ends, at)?, id)));
    let mut parts: Vec<([BigRational; 2], u32)> = (0..).zip(&mesh.tets).filter_map(found).collect();
    parts.sort();
    parts.dedup_by(|later, earlier| later.0 == earlier.0);
    parts.into_iter().map(|(interval, id)| (id, interval)).collect()
}

fn agrees(mesh: &TetMesh, vessels: &Skeleton) {
    let pieces = Pieces::of(mesh, vessels, &()).expect("inside");
    assert_eq!(pieces.check(mesh, vessels), Ok(()));
    let mut found = pieces.list.iter();
    for edge in vessels.edge_ids() {
        let tube = vessels.tube(edge);
        for (tet, [low, high]) in divided(mesh, [&tube.a, &tube.b]) {
            let piece = found.next().expect("as many pieces");
            assert_eq!((piece.edge, piece.tet), (edge, tet), "{piece:?} {low} {high}");
            for (found, expected) in piece.ends.iter().zip([low, high]) {
                let error = exact(*found) - expected;
                assert!(error < exact(1e-12) && error > exact(-1e-12), "{piece:?}");
            }
        }
    }
    assert_eq!(found.next(), None);
}

#[test]
fn lines_of_the_grid_are_divided_as_in_exact_arithmetic() {
    let mesh = cube_lattice(2);
    let mut lines = Vec::new();
    let coordinates = [0.0, 0.25, 0.5, 1.0];
    for a in coordinates {
        for b in coordinates {
            // Along the axes, on faces, edges and in the interior of the cubes; and along diagonals.
            lines.extend([[[0.0, a, b], [1.0, a, b]], [[a, 1.0, b], [a, 0.0, b]], [[b, a, 0.25], [b, a, 0.75]]]);
            lines.push([[0.0, 0.0, a], [1.0, 1.0, b]]);
            lines.push([[0.0, a, 0.0], [1.0, b, 1.0]]);
        }
    }
    let points: Vec<[f64; 3]> = lines.into_iter().filter(|[p, q]| p != q).flatten().collect();
    let edges: Vec<(u32, u32)> = (0..points.len() as u32 / 2).map(|i| (2 * i, 2 * i + 1)).collect();
    agrees(&mesh, &network(&points, 0.1, &edges));
}

/// Point of the unit cube on a coarse grid, or anywhere.
fn place() -> impl Strategy<Value = [f64; 3]> {
    let coordinate = || prop_oneof![(0u32..=8).prop_map(|i| f64::from(i) / 8.0), 0.0..1.0f64];
    (coordinate(), coordinate(), coordinate()).prop_map(|(x, y, z)| [x, y, z])
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn pieces_are_those_of_exact_arithmetic(p in place(), q in place(), r in place(), is_perturbed: bool) {
        prop_assume!(p != q && q != r);
        let mut mesh = cube_lattice(2);
        if is_perturbed {
            let inside = |p: &Point3| p.iter().all(|&x| x > 0.0 && x < 1.0);
            let movable: Vec<bool> = mesh.points.iter().map(inside).collect();
            perturb(&mut mesh.points, &movable, 0.2, 7);
        }
        agrees(&mesh, &network(&[p, q, r], 0.1, &[(0, 1), (1, 2)]));
    }
}

#[test]
fn vessels_that_leave_the_mesh_are_errors() {
    let mesh = cube_lattice(2);
    let leaving = network(&[[0.5, 0.5, 0.5], [0.5, 0.5, 2.0]], 0.1, &[(0, 1)]);
    let fault = Pieces::of(&mesh, &leaving, &());
    assert_eq!(fault, Err(PiecesError::Outside { edge: 0, at: [0.5, 0.5, 2.0] }));
    // Two boxes, and a segment that leaves one for the other.
    let mut two = cube_lattice(1);
    let count = two.points.len() as u32;
    let moved: Vec<Point3> = two.points.iter().map(|p| p + Vec3::x() * 2.0).collect();
    two.points.extend(moved);
    two.tets.extend(two.tets.clone().iter().map(|t| t.map(|v| v + count)));
    let across = network(&[[0.5, 0.5, 0.5], [2.5, 0.5, 0.5]], 0.1, &[(0, 1)]);
    assert_eq!(Pieces::of(&two, &across, &()), Err(PiecesError::Outside { edge: 0, at: [1.0, 0.5, 0.5] }));
}

#[test]
fn faults_of_pieces_are_found() {
    let mesh = cube_lattice(2);
    let vessel = network(&[[0.1, 0.2, 0.3], [0.9, 0.7, 0.4]], 0.1, &[(0, 1)]);
    let sound = Pieces::of(&mesh, &vessel, &()).expect("inside");
    assert!(sound.list.len() > 3);
    let with = |change: &dyn Fn(&mut Pieces)| {
        let mut pieces = sound.clone();
        change(&mut pieces);
        pieces.check(&mesh, &vessel)
    };
    assert!(matches!(with(&|p| p.list.truncate(1)), Err(PieceFault::Cover { .. })));
    assert!(matches!(with(&|p| p.list.rotate_left(1)), Err(PieceFault::Cover { .. })));
    assert!(matches!(with(&|p| p.list[0].length *= 2.0), Err(PieceFault::Length { .. })));
    assert_eq!(with(&|p| p.list[1].tet = p.list[0].tet), Err(PieceFault::Cell { piece: 1 }));
}

/// Mean edge length of the cells that vessels pass through.
fn mean_edge(made: &Embedding) -> f64 {
    let mesh = &made.mesh.mesh;
    let edges = made.pieces.list.iter().flat_map(|piece| {
        let at = mesh.tets[piece.tet as usize].map(|v| mesh.points[v as usize]);
        [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)].map(|(i, j)| (at[i] - at[j]).norm())
    });
    edges.clone().sum::<f64>() / edges.count() as f64
}

#[test]
fn cells_have_the_length_wanted_at_vessels() {
    let vessel = network(&[[0.0, 0.0, 0.0], [20.0, 0.0, 0.0], [30.0, 8.0, 0.0]], 0.5, &[(0, 1), (1, 2)]);
    for (plan, length) in
        [(EmbedPlan::default(), 1.0), (EmbedPlan::default().size(Thickness::Law { length: 0.5, radii: 0.0 }), 0.5)]
    {
        let made = Embedding::of(&vessel, &plan, &()).expect("a mesh");
        assert_eq!(made.check.failed().next(), None);
        agrees(&made.mesh.mesh, &vessel);
        let mean = mean_edge(&made);
        // Edges grow away from the vessel, also those of cells that it passes through.
        assert!(mean > 1.0 * length && mean < 1.6 * length, "{mean} {length}");
    }
}

#[test]
fn coarser_plans_need_fewer_cells() {
    let vessels = tangle(4, 3);
    let cells = |plan: &EmbedPlan| Embedding::of(&vessels, plan, &()).expect("a mesh").mesh.mesh.tets.len();
    let tissue = TissuePlan::new(TissueShape::Box { margin: None });
    let usual = cells(&EmbedPlan::default());
    let grown = cells(&EmbedPlan::default().tissue(tissue.growth(2.0)));
    let coarse = cells(&EmbedPlan::default().size(Thickness::Law { length: 0.0, radii: 4.0 }));
    assert!(grown < usual && coarse < usual, "{usual} {grown} {coarse}");
}

#[test]
fn nodes_on_the_surface_of_an_organ_are_inside() {
    let organ = sphere_surface(2);
    let [on, other] = [0, 5].map(|v| organ.points[v].coords.into());
    let name = |node: u32| format!("n{node}");
    let plan = EmbedPlan::default()
        .tissue(TissuePlan::new(TissueShape::Organ(organ)))
        .size(Thickness::Law { length: 0.2, radii: 0.0 });
    let vessel = network(&[on, [0.0; 3], other], 0.05, &[(0, 1), (1, 2)]);
    plan.check(&vessel, &name).expect("inside");
    let made = Embedding::of(&vessel, &plan, &()).expect("a mesh");
    assert_eq!(made.check.failed().next(), None);
    assert_eq!(made.pieces.check(&made.mesh.mesh, &vessel), Ok(()));
    agrees(&made.mesh.mesh, &vessel);
    let far = network(&[on, [0.0; 3], [3.0, 0.0, 0.0]], 0.05, &[(0, 1), (1, 2)]);
    let fault = plan.check(&far, &name).expect_err("outside").to_string();
    assert!(fault.starts_with("1 node lies outside the surface around the tissue, first node n2"), "{fault}");
}

#[test]
fn edges_that_cross_the_surface_are_named() {
    // A cavity between both nodes.
    let mut organ = sphere_surface(1);
    let count = organ.points.len() as u32;
    let small: Vec<Point3> = organ.points.iter().map(|p| p * 0.2).collect();
    organ.points.extend(small);
    let inner: Vec<[u32; 3]> = organ.triangles.iter().map(|&[a, b, c]| [a + count, c + count, b + count]).collect();
    organ.triangles.extend(inner);
    // Both ends lie on the cavity, so that the segment between them crosses no triangle.
    let [from, to] = [0, 3].map(|v| (organ.points[count as usize + v]).coords.into());
    let across = network(&[from, to], 0.1, &[(0, 1)]);
    let plan = EmbedPlan::default().tissue(TissuePlan::new(TissueShape::Organ(organ)));
    let fault = Embedding::of(&across, &plan, &()).map(|made| made.pieces);
    assert!(
        matches!(&fault, Err(DomainError::Pieces(PiecesError::Outside { edge: 0, at })) if *at == from),
        "{fault:?}"
    );
    let through = network(&[[-0.5, 0.01, 0.02], [0.5, 0.02, 0.01]], 0.1, &[(0, 1)]);
    let fault = plan.check(&through, &|node| format!("n{node}")).expect_err("a cavity");
    assert!(matches!(&fault, DomainError::EdgesOutside { count: 1, ends, .. } if ends == &["n0", "n1"]), "{fault}");
}

#[test]
fn plans_that_need_too_much_are_refused() {
    let vessel = network(&[[0.0; 3], [20.0, 0.0, 0.0]], 0.5, &[(0, 1)]);
    let size = |length: f64| EmbedPlan::default().size(Thickness::Law { length, radii: 0.0 });
    for length in [1e-9, 1e-2] {
        let fault = Embedding::of(&vessel, &size(length).max_tets(100_000), &());
        assert!(matches!(fault, Err(DomainError::Tissue(TetError::TooMany { .. }))), "{fault:?}");
    }
    let fault = Embedding::of(&vessel, &size(-1.0), &());
    assert!(matches!(fault, Err(DomainError::Plan(DomainPlanError::Size(-1.0)))), "{fault:?}");
}
