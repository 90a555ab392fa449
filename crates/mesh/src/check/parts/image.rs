//! Certificate of another image of a template.

use super::certificate::{bounds_of, has_sound_points, is_star, measured};
use super::sums::{face_sum, point_sum};
use super::{Certificate, HeldJoint, HeldSurface, PartView};
use crate::adjacency::NONE;
use crate::check::nested::Enclosed;
use crate::check::surface::Boundary;

/// Certificate of a part that differs from another one in its points alone. Tetrahedra, joints and caps have the same
/// vertices, and `like` is the other's certificate. `wall`: boundary faces in no joint and no cap.
///
/// Conditions on vertices hold of both. Those on points are tested: tetrahedra are positive, and the boundary does not
/// intersect itself. Returns `None` if one fails, or if the other is not sound, connected and bounded by one surface.
/// [`certify_with`](super::certify_with) then says what is wrong.
pub fn certify_image(part: &PartView, wall: &[[u32; 3]], like: &Certificate) -> Option<Certificate> {
    let [surface] = like.surfaces[..] else { return None };
    let is_sound = like.faults.is_empty() && !like.unsound && like.components == 1;
    let mesh = part.mesh;
    let counts = [mesh.points.len() as u32, mesh.tets.len() as u32];
    let is_like = counts == [like.points, like.tets]
        && part.joints.len() == like.joints.len()
        && part.caps.len() == like.caps.len();
    if !is_sound || !is_like || !has_sound_points(mesh) {
        return None;
    }
    let (are_positive, volume, quality) = measured(mesh);
    let caps = part.caps.iter().map(|(_, faces)| faces);
    let faces: Vec<[u32; 3]> = part.joints.iter().chain(caps.clone()).flatten().chain(wall).copied().collect();
    if !are_positive || !(is_star(part, &faces) || is_apart(part, &faces)) {
        return None;
    }
    let sums: Vec<u64> = mesh.points.iter().map(point_sum).collect();
    let sum_of = |faces: &[[u32; 3]]| {
        faces.iter().fold(0, |sum: u64, face| sum.wrapping_add(face_sum(face.map(|v| sums[v as usize]))))
    };
    let joint = |(held, faces): (&HeldJoint, &Vec<[u32; 3]>)| HeldJoint { sum: sum_of(faces), ..*held };
    // Vertices inside joints are none of the whole's boundary.
    let vertex = caps.clone().flatten().chain(wall).flatten().copied().min().unwrap_or(NONE);
    let mut certificate = Certificate {
        volume,
        quality,
        bounds: bounds_of(&mesh.points, &faces),
        wall_sum: caps.fold(sum_of(wall), |sum, faces| sum.wrapping_add(sum_of(faces))),
        surfaces: vec![HeldSurface { vertex, enclosed: Enclosed::exactly(volume), ..surface }],
        joints: like.joints.iter().zip(part.joints).map(joint).collect(),
        ..like.clone()
    };
    certificate.hold_caps(part);
    Some(certificate)
}

/// True if no two faces meet improperly.
fn is_apart(part: &PartView, faces: &[[u32; 3]]) -> bool {
    let (contacts, _) = Boundary::new(&part.mesh.points, faces).self_intersections(false, &());
    !contacts.fails()
}
