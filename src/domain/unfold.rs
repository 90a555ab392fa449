//! Smoothing of a lumen's wall where it is folded, so that a shell fits.
//!
//! At a folded vertex no direction leads away from all triangles of the wall, and prisms would invert. The vertex moves
//! towards its neighbours as far as the tetrahedra of the lumen stay positive.

use super::surface::LumenSurface;
use anastomesh_mesh::TetMesh;
use anastomesh_mesh::adjacency::Incidence;
use anastomesh_mesh::geometry::predicates::orient3d;
use anastomesh_mesh::geometry::{Point3, Vec3};
use anastomesh_tet::parts::blind_vertices;
use rustc_hash::{FxHashMap, FxHashSet};

/// Passes over the folded vertices.
const PASSES: usize = 8;
/// Shares of the way to the centre of the neighbours, in order of preference.
const SHARES: [f64; 4] = [0.5, 0.25, 0.1, 0.03];

/// Moves folded vertices of the wall. Returns their number.
pub fn unfold(mesh: &mut TetMesh, lumen: &mut LumenSurface) -> usize {
    let surface = &mut lumen.surface;
    let wall: Vec<[u32; 3]> =
        surface.triangles.iter().zip(&lumen.caps).filter(|(_, cap)| cap.is_none()).map(|(t, _)| *t).collect();
    let seen_from_inside: Vec<[u32; 3]> = wall.iter().map(|&[a, b, c]| [a, c, b]).collect();
    let capped = surface.triangles.iter().zip(&lumen.caps).filter(|(_, cap)| cap.is_some());
    let of_caps: FxHashSet<u32> = capped.flat_map(|(t, _)| *t).collect();
    let mut moved = FxHashSet::default();
    let mut around = None;
    for _ in 0..PASSES {
        let folded = blind_vertices(&surface.points, &seen_from_inside);
        if folded.is_empty() {
            break;
        }
        let neighbours = around.get_or_insert_with(|| Incidence::of_vertices(&wall, surface.points.len()));
        // A fold has several vertices, of which each may be in the way of the others.
        let mut vertices: Vec<u32> =
            folded.iter().flat_map(|&v| neighbours.get(v)).copied().chain(folded.iter().copied()).collect();
        vertices.sort_unstable();
        vertices.dedup();
        vertices.retain(|v| !of_caps.contains(v));
        let tets = tets_at(mesh, vertices.iter().map(|&v| lumen.points[v as usize]));
        for v in vertices {
            let ring = neighbours.get(v);
            let sum: Vec3 = ring.iter().map(|&w| surface.points[w as usize].coords).sum();
            let centre = Point3::from(sum / ring.len().max(1) as f64);
            let (own, vertex) = (surface.points[v as usize], lumen.points[v as usize]);
            let fits = |p: &Point3| stays_positive(mesh, &tets[&vertex], vertex, p);
            let place = SHARES.into_iter().map(|share| own + (centre - own) * share).find(fits);
            if let Some(place) = place {
                surface.points[v as usize] = place;
                mesh.points[vertex as usize] = place;
                moved.insert(v);
            }
        }
    }
    moved.len()
}

/// Tetrahedra at some vertices.
fn tets_at(mesh: &TetMesh, vertices: impl Iterator<Item = u32>) -> FxHashMap<u32, Vec<[u32; 4]>> {
    let mut found: FxHashMap<u32, Vec<[u32; 4]>> = vertices.map(|v| (v, Vec::new())).collect();
    for tet in &mesh.tets {
        for v in tet {
            if let Some(own) = found.get_mut(v) {
                own.push(*tet);
            }
        }
    }
    found
}

/// True if tetrahedra stay positive when a vertex moves.
fn stays_positive(mesh: &TetMesh, tets: &[[u32; 4]], vertex: u32, place: &Point3) -> bool {
    tets.iter().all(|tet| {
        let [a, b, c, d] = tet.map(|v| if v == vertex { place } else { &mesh.points[v as usize] });
        orient3d(a, b, c, d) > 0.0
    })
}
