use super::super::complex::NONE;
use super::super::delaunay::delaunay;
use super::*;
use proptest::prelude::*;

/// Points of a cube, its corners and others inside.
fn cube() -> Vec<Point3> {
    let mut points: Vec<Point3> =
        (0..8).map(|i| Point3::new(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2))).collect();
    let coordinate = |i: u32, k: u32| f64::from((i * 7919 + k * 104_729) % 997 + 1) / 1000.0;
    points.extend((0..60).map(|i| Point3::new(coordinate(i, 1), coordinate(3 * i + 1, 2), coordinate(7 * i + 2, 3))));
    points
}

/// The cells of a complex, to be broken.
#[derive(Clone)]
struct Parts {
    points: Vec<Point3>,
    cells: Vec<Cell>,
}

impl Parts {
    fn of(points: &[Point3]) -> Self {
        let c = delaunay(points).unwrap();
        let cells: Vec<Cell> = (0..c.slots() as u32).filter(|&t| c.is_alive(t)).map(|t| *c.cell(t)).collect();
        assert_eq!(cells.len(), c.slots(), "no slot is free");
        Self { points: points.to_vec(), cells }
    }

    fn complex(&self) -> Complex {
        let vertex_tet = vec![NONE; self.points.len()];
        Complex::from_cells(self.points.clone(), self.cells.clone(), Vec::new(), vertex_tet)
    }

    fn certify(&self) -> Result<Vec<[u32; 3]>, CertifyError> {
        certify_hull(&self.complex())
    }

    fn is_ghost(&self, t: u32) -> bool {
        self.cells[t as usize].verts[3] == NONE
    }

    /// The first tetrahedron all of whose neighbours are tetrahedra, too.
    fn inner(&self) -> u32 {
        let real = |t: u32| !self.is_ghost(t);
        let inner = |t: &u32| real(*t) && self.cells[*t as usize].mates.iter().all(|&mate| real(mate >> 2));
        (0..self.cells.len() as u32).find(inner).unwrap()
    }

    fn glue(&mut self, a: u32, b: u32) {
        self.cells[(a >> 2) as usize].mates[(a & 3) as usize] = b;
        self.cells[(b >> 2) as usize].mates[(b & 3) as usize] = a;
    }

    fn mate(&self, half: u32) -> u32 {
        self.cells[(half >> 2) as usize].mates[(half & 3) as usize]
    }

    /// Takes cells out, closes the hole with ghosts and glues these to each other, all consistently.
    fn without(&self, gone: &[u32]) -> Self {
        let kept = |t: &u32| !gone.contains(t) && !self.is_ghost(*t);
        let tets: Vec<[u32; 4]> =
            (0..self.cells.len() as u32).filter(kept).map(|t| self.cells[t as usize].verts).collect();
        let c = Complex::from_mesh(self.points.clone(), &tets).unwrap();
        Self { points: self.points.clone(), cells: (0..c.slots() as u32).map(|t| *c.cell(t)).collect() }
    }

    /// Appends other cells with points of their own.
    fn append(&mut self, other: &Self) {
        let (points, cells) = (self.points.len() as u32, self.cells.len() as u32);
        let moved = |v: u32| if v == NONE { v } else { v + points };
        let shifted =
            |cell: &Cell| Cell { verts: cell.verts.map(moved), mates: cell.mates.map(|mate| mate + 4 * cells) };
        self.cells.extend(other.cells.iter().map(shifted));
        self.points.extend(&other.points);
    }
}

#[test]
fn a_tetrahedralization_passes_and_its_hull_is_reported() {
    let parts = Parts::of(&cube());
    let hull = parts.certify().unwrap();
    assert_eq!(hull.len(), parts.cells.iter().filter(|cell| cell.verts[3] == NONE).count());
    let area = |f: &[u32; 3]| {
        let [p, q, r] = f.map(|v| parts.points[v as usize]);
        (q - p).cross(&(r - p)).norm() / 2.0
    };
    assert!((hull.iter().map(area).sum::<f64>() - 6.0).abs() < 1e-12);
}

#[test]
fn tetrahedra_that_are_inverted_flat_or_out_of_range_are_found() {
    let sound = Parts::of(&cube());
    let tet = sound.inner();
    let mut inverted = sound.clone();
    inverted.cells[tet as usize].verts.swap(0, 1);
    assert!(matches!(inverted.certify(), Err(CertifyError::NotPositive { tet: t, .. }) if t == tet));
    let mut repeated = sound.clone();
    repeated.cells[tet as usize].verts[0] = repeated.cells[tet as usize].verts[1];
    assert!(matches!(repeated.certify(), Err(CertifyError::NotPositive { tet: t, .. }) if t == tet));
    let mut out = sound.clone();
    out.cells[tet as usize].verts[2] = 1_000_000;
    assert!(matches!(out.certify(), Err(CertifyError::NotPositive { tet: t, .. }) if t == tet));
    let mut next = sound.clone();
    next.cells[tet as usize].verts[2] = sound.points.len() as u32;
    assert!(matches!(next.certify(), Err(CertifyError::NotPositive { tet: t, .. }) if t == tet));
    let mut nan = sound.clone();
    nan.points[sound.cells[tet as usize].verts[0] as usize].x = f64::NAN;
    assert!(matches!(nan.certify(), Err(CertifyError::NotPositive { .. })));
}

#[test]
fn every_wrong_neighbor_is_found() {
    let sound = Parts::of(&cube());
    assert_eq!(one_sided(&sound.complex()), None);
    for half in 0..4 * sound.cells.len() as u32 {
        let mate = sound.mate(half);
        // Pointing nowhere, at nothing that exists, at itself, at another face of the neighbour, at another cell.
        let far = 4 * sound.cells.len() as u32 + 1;
        for wrong in [NONE, far, half, mate ^ 1, (mate + 4) % (far - 1)] {
            let mut broken = sound.clone();
            broken.cells[(half >> 2) as usize].mates[(half & 3) as usize] = wrong;
            let result = broken.certify();
            assert!(matches!(result, Err(CertifyError::NotConforming { .. })), "{half} -> {wrong}: {result:?}");
            // Neither the face nor its former neighbour has a mate that refers back to it.
            assert_eq!(one_sided(&broken.complex()), Some(half.min(mate)), "{half} -> {wrong}");
        }
    }
}

#[test]
fn mutual_neighbors_without_a_common_face_are_found() {
    let sound = Parts::of(&cube());
    let half = 4 * sound.inner();
    let mut crossed = sound.clone();
    let (a, b) = (sound.mate(half), sound.mate(half + 1));
    crossed.glue(half, b);
    crossed.glue(half + 1, a);
    assert!(matches!(crossed.certify(), Err(CertifyError::NotConforming { .. })));
}

#[test]
fn a_missing_tetrahedron_is_found() {
    let sound = Parts::of(&cube());
    let tet = sound.inner();
    // Its neighbours point at a free slot.
    let vertex_tet = vec![NONE; sound.points.len()];
    let c = Complex::from_cells(sound.points.clone(), sound.cells.clone(), vec![tet], vertex_tet);
    assert!(matches!(certify_hull(&c), Err(CertifyError::NotConforming { .. })));
    // A cavity and a dent, consistently under ghosts.
    assert!(matches!(sound.without(&[tet]).certify(), Err(CertifyError::NotConvex { .. })));
    for ghost in (0..sound.cells.len() as u32).filter(|&t| sound.is_ghost(t)) {
        let result = sound.without(&[sound.cells[ghost as usize].mates[3] >> 2]).certify();
        let found = matches!(result, Err(CertifyError::NotConvex { .. } | CertifyError::PointUnused { .. }));
        assert!(found, "{ghost}: {result:?}");
    }
}

#[test]
fn a_repeated_tetrahedron_is_found() {
    let sound = Parts::of(&cube());
    let (tet, count) = (sound.inner(), sound.cells.len() as u32);
    // With the neighbours of the first.
    let mut twice = sound.clone();
    twice.cells.push(sound.cells[tet as usize]);
    assert!(matches!(twice.certify(), Err(CertifyError::NotConforming { .. })));
    // With ghosts of its own: a face has four tetrahedra or ghosts, and all neighbours fit.
    let mut apart = sound.clone();
    let own = Complex::from_mesh(sound.points.clone(), &[sound.cells[tet as usize].verts]).unwrap();
    let shifted = |t: u32| Cell { verts: own.verts(t), mates: own.cell(t).mates.map(|mate| mate + 4 * count) };
    apart.cells.extend((0..own.slots() as u32).map(shifted));
    assert!(matches!(apart.certify(), Err(CertifyError::NotConvex { .. } | CertifyError::Winding { .. })));
}

#[test]
fn a_hull_face_without_a_ghost_is_found() {
    let sound = Parts::of(&cube());
    let ghost = (0..sound.cells.len() as u32).find(|&t| sound.is_ghost(t)).unwrap();
    // The tetrahedron points nowhere, and the ghosts beside keep pointing at the ghost.
    let mut open = sound.clone();
    let half = open.cells[ghost as usize].mates[3];
    open.cells[(half >> 2) as usize].mates[(half & 3) as usize] = NONE;
    assert!(matches!(open.certify(), Err(CertifyError::NotConforming { .. })));
    // The ghost is no more.
    let vertex_tet = vec![NONE; sound.points.len()];
    let c = Complex::from_cells(sound.points.clone(), sound.cells.clone(), vec![ghost], vertex_tet);
    assert!(matches!(certify_hull(&c), Err(CertifyError::NotConforming { .. })));
}

#[test]
fn two_ghosts_back_to_back_are_found() {
    let mut parts = Parts::of(&cube());
    let count = parts.cells.len() as u32;
    let at = |t: u32| 4 * (count + t);
    parts.cells.push(Cell { verts: [0, 1, 2, NONE], mates: [at(1), at(1) + 2, at(1) + 1, at(1) + 3] });
    parts.cells.push(Cell { verts: [0, 2, 1, NONE], mates: [at(0), at(0) + 2, at(0) + 1, at(0) + 3] });
    assert!(matches!(parts.certify(), Err(CertifyError::NotConforming { .. })));
}

#[test]
fn an_unused_point_is_found() {
    let mut parts = Parts::of(&cube());
    parts.points.push(Point3::new(0.5, 0.5, 0.5));
    assert_eq!(parts.certify(), Err(CertifyError::PointUnused { point: parts.points.len() as u32 - 1 }));
}

#[test]
fn places_that_are_covered_twice_or_apart_are_found() {
    let sound = Parts::of(&cube());
    let mut doubled = sound.clone();
    doubled.append(&sound);
    assert!(matches!(doubled.certify(), Err(CertifyError::Winding { crossed: 2, .. })));
    let mut beside = sound.clone();
    let moved: Vec<Point3> = sound.points.iter().map(|p| Point3::new(p.x + 3.0, p.y, p.z)).collect();
    beside.append(&Parts { points: moved, cells: sound.cells.clone() });
    assert!(matches!(beside.certify(), Err(CertifyError::NotConvex { .. })));
}

/// Coordinates of few values: flat hulls, cospherical points, repeated projections.
fn points() -> impl Strategy<Value = Vec<Point3>> {
    let grid = prop::collection::btree_set((0..5_u8, 0..5_u8, 0..4_u8), 5..60);
    (grid, 0.1..1.0_f64).prop_map(|(grid, step)| {
        grid.into_iter()
            .map(|(x, y, z)| Point3::new(f64::from(x) * step, f64::from(y) * 0.1, f64::from(z) / 3.0))
            .collect()
    })
}

proptest! {
    #[test]
    fn tetrahedralizations_pass_and_lose_no_tetrahedron(points in points(), pick in 0..1000_usize) {
        let Ok(c) = delaunay(&points) else { return Ok(()) };
        let hull = certify_hull(&c).unwrap();
        let faces = anastomesh_mesh::adjacency::boundary_faces(&c.clone().into_mesh());
        prop_assert_eq!(&hull, &faces);
        // Without one, the mesh fills no convex hull.
        let mut tets = c.clone().into_mesh().tets;
        tets.remove(pick % tets.len());
        if let Ok(broken) = Complex::from_mesh(points.clone(), &tets) {
            let result = certify_hull(&broken);
            prop_assert!(result.is_err(), "{result:?}");
        }
    }
}
