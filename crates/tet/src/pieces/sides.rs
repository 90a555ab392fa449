//! Sides of the tetrahedra near a plane.

use super::band::Band;
use super::plane::Plane;
use anastomesh_mesh::adjacency::{NONE, TetAdjacency, face_vertices, tet_adjacency};
use anastomesh_mesh::{TetMesh, face_key, same_turn};
use rustc_hash::FxHashMap;

/// Position of a tetrahedron.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Side {
    /// Outside the region, or not reached.
    Outside,
    Below,
    Above,
}

impl Side {
    /// Side of the plane at a signed distance.
    pub fn at(distance: f64) -> Self {
        if distance < 0.0 { Self::Below } else { Self::Above }
    }

    /// Index of the half on this side.
    pub fn half(self) -> usize {
        usize::from(self == Self::Above)
    }
}

/// Tetrahedra of a band with their sides.
///
/// Only those that meet the plane are known to lie inside or outside the region. All others have the side of the plane on
/// which they lie.
pub(super) struct Sides {
    /// Side of each tetrahedron.
    pub of_tets: Vec<Side>,
    pub adjacency: TetAdjacency,
    /// True for tetrahedra that meet the plane.
    pub is_core: Vec<bool>,
    /// Tetrahedron inside the region at each triangle of the band.
    pub inner: Vec<u32>,
    /// True for faces (`4 · tet + face`) that are triangles of the band.
    pub on_surface: Vec<bool>,
}

impl Sides {
    /// Finds the sides. Those that meet the plane are reached from triangles of the surface through others that meet it.
    /// `None` if one is both inside and outside, or if a triangle has no tetrahedron inside.
    pub fn of(mesh: &TetMesh, band: &Band, plane: Plane) -> Option<Self> {
        let place = |tet: &[u32; 4]| tet.map(|v| plane.distance(&mesh.points[v as usize]));
        let centroid = |tet: &[u32; 4]| Side::at(place(tet).iter().sum());
        let meets = |tet: &[u32; 4]| place(tet).iter().any(|x| *x <= 0.0) && place(tet).iter().any(|x| *x >= 0.0);
        let mut made = Self {
            of_tets: vec![Side::Outside; mesh.tets.len()],
            adjacency: tet_adjacency(&mesh.tets, mesh.points.len()),
            is_core: mesh.tets.iter().map(meets).collect(),
            inner: vec![NONE; band.triangles.len()],
            on_surface: vec![false; 4 * mesh.tets.len()],
        };
        let starts = made.starts(mesh, band);
        let mut is_inside: Vec<Option<bool>> = vec![None; mesh.tets.len()];
        let mut queue = Vec::new();
        for (tet, inside) in starts {
            if is_inside[tet as usize].is_some_and(|known| known != inside) {
                return None;
            }
            is_inside[tet as usize] = Some(inside);
            queue.push(tet);
        }
        let mut next = 0;
        while let Some(&tet) = queue.get(next) {
            next += 1;
            for (i, &mate) in made.adjacency.neighbors[tet as usize].iter().enumerate() {
                let other = (mate >> 2) as usize;
                let is_open = mate != NONE && !made.on_surface[4 * tet as usize + i];
                if is_open && made.is_core[other] && is_inside[other].is_none() {
                    is_inside[other] = is_inside[tet as usize];
                    queue.push(other as u32);
                }
            }
        }
        for (i, tet) in mesh.tets.iter().enumerate() {
            if !made.is_core[i] || is_inside[i] == Some(true) {
                made.of_tets[i] = centroid(tet);
            }
        }
        (!made.inner.contains(&NONE)).then_some(made)
    }

    /// Marks the faces that are triangles of the band, and lists the tetrahedra at them that meet the plane. `true` stands for
    /// inside.
    fn starts(&mut self, mesh: &TetMesh, band: &Band) -> Vec<(u32, bool)> {
        let own = &band.boxed.triangles[..band.triangles.len()];
        let by_face: FxHashMap<[u32; 3], u32> = own.iter().map(|t| face_key(*t)).zip(0..).collect();
        let of_surface = |v: &&u32| (**v as usize) < band.points.len();
        let mut starts = Vec::new();
        for (tet, _) in (0..).zip(&mesh.tets).filter(|(_, all)| all.iter().filter(of_surface).count() > 2) {
            for half in 4 * tet..4 * tet + 4 {
                let face = face_vertices(&mesh.tets, half);
                let Some(&t) = by_face.get(&face_key(face)) else { continue };
                self.on_surface[half as usize] = true;
                let is_inside = same_turn(own[t as usize], face);
                if is_inside {
                    self.inner[t as usize] = tet;
                }
                if self.is_core[tet as usize] {
                    starts.push((tet, is_inside));
                }
            }
        }
        starts
    }
}
