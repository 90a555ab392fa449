//! Parts that are closed surfaces without tetrahedra.

use super::*;

/// Whole of one hollow part, a cube.
fn checked(change: impl FnOnce(&mut TetMesh, &mut Vec<[u32; 3]>)) -> (Certificate, Vec<Line>) {
    let filled = cube_lattice(2);
    let mut hull = boundary_faces(&filled);
    let used = crate::Kept::used(&hull, filled.points.len(), 0);
    for face in &mut hull {
        *face = used.cell(face);
    }
    let mut mesh = TetMesh { points: used.select(&filled.points), tets: Vec::new() };
    change(&mut mesh, &mut hull);
    let view = PartView { mesh: &mesh, joints: &[], caps: &[] };
    let certificate = certify_hollow(&view, &hull);
    let lines = certificate.faults.iter().map(|fault| fault.line).collect();
    (certificate, lines)
}

#[test]
fn a_closed_surface_is_sound() {
    let (certificate, faults) = checked(|_, _| ());
    assert!(certificate.is_sound() && faults.is_empty(), "{faults:?}");
}

#[test]
fn faults_of_points_and_faces_are_found() {
    let lines = |change: fn(&mut TetMesh, &mut Vec<[u32; 3]>)| {
        let (certificate, lines) = checked(change);
        assert!(!certificate.is_sound(), "{lines:?}");
        lines
    };
    assert!(lines(|mesh, _| mesh.points[3].x = f64::NAN).contains(&Line::FinitePoints));
    assert_eq!(lines(|_, hull| hull[5][1] = u32::MAX), [Line::IndicesInRange]);
    // A point that two corners share, so that their fans do not meet.
    let pinched = lines(|mesh, hull| {
        let last = mesh.points.len() as u32 - 1;
        hull.as_flattened_mut().iter_mut().filter(|v| **v == last).for_each(|v| *v = 0);
        mesh.points.push(mesh.points[0]);
    });
    assert!(pinched.contains(&Line::BoundaryFans) && pinched.contains(&Line::NoDuplicatePoints), "{pinched:?}");
}
