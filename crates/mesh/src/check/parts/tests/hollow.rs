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

/// Cube with its points, and faces oriented out of it or into it.
fn cube_hull(corner: [f64; 3], size: f64, is_cavity: bool) -> (Vec<Point3>, Vec<[u32; 3]>) {
    let filled = cube_lattice(1);
    let mut hull = boundary_faces(&filled);
    if is_cavity {
        for face in &mut hull {
            face.swap(0, 1);
        }
    }
    (filled.points.iter().map(|p| Point3::from(p.coords * size + Vec3::from(corner))).collect(), hull)
}

/// Parts of surfaces alone, without joints.
#[derive(Default)]
struct Hollow(Vec<(TetMesh, Vec<[u32; 3]>)>);

impl Hollow {
    fn add(&mut self, hulls: &[(Vec<Point3>, Vec<[u32; 3]>)]) {
        let (mut points, mut faces) = (Vec::new(), Vec::new());
        for (own, hull) in hulls {
            faces.extend(hull.iter().map(|face| face.map(|v| v + points.len() as u32)));
            points.extend_from_slice(own);
        }
        self.0.push((TetMesh { points, tets: Vec::new() }, faces));
    }
}

impl Parts for Hollow {
    fn count(&self) -> usize {
        self.0.len()
    }

    fn certificate(&self, part: u32) -> io::Result<Certificate> {
        let (mesh, hull) = &self.0[part as usize];
        Ok(certify_hollow(&PartView { mesh, joints: &[], caps: &[] }, hull))
    }

    fn wall(&self, part: u32) -> io::Result<FacesApart> {
        let (mesh, hull) = &self.0[part as usize];
        let vertices = self.vertices(part, mesh.points.len() as u32)?;
        Ok(FacesApart { points: mesh.points.clone(), vertices, faces: hull.clone() })
    }

    fn joined(&self) -> &[[(u32, u32); 2]] {
        &[]
    }

    fn joint(&self, _: u32, _: u32) -> io::Result<FacesApart> {
        unreachable!("there are no joints")
    }

    fn vertex(&self, part: u32, local: u32) -> u32 {
        self.0[..part as usize].iter().map(|(mesh, _)| mesh.points.len() as u32).sum::<u32>() + local
    }

    fn tet(&self, _: u32, _: u32) -> u64 {
        unreachable!("there are no tetrahedra")
    }
}

#[test]
fn surfaces_without_tetrahedra_are_checked_as_surfaces() {
    let mut parts = Hollow::default();
    parts.add(&[cube_hull([0.0; 3], 1.0, false), cube_hull([0.25; 3], 0.5, true)]);
    parts.add(&[cube_hull([2.0, 0.0, 0.0], 1.0, false)]);
    let wall = [Patch { id: WALL, name: "wall".into(), cap: None }];
    let expected = Expectation { loops: vec![0, 0, 0], terminals: vec![] };
    let check = |parts: &Hollow| check_parts(parts, &wall, Some(&expected), usize::MAX).unwrap().report;
    let report = check(&parts);
    let failed: Vec<Line> = report.failed().map(|result| result.line).collect();
    // Three surfaces bound two components.
    assert_eq!((report.counts.components, report.counts.boundary_components), (2, 3));
    assert_eq!(failed, [Line::Components]);
    assert!((report.counts.volume - 1.875).abs() < 1e-12, "{}", report.counts.volume);
    // Conditions on tetrahedra, and their quality, are not among the results.
    assert_eq!(report.quality, None);
    assert!(report.line(Line::PositiveTets).is_none() && report.line(Line::NoSelfIntersection).is_some());
    parts.add(&[cube_hull([2.9, 0.2, 0.2], 1.0, false)]);
    assert!(check(&parts).failed().any(|result| result.line == Line::NoSelfIntersection));
}
