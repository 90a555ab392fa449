//! Certificates of images, compared with full ones.

use super::*;
use crate::check::parts::certify_image;

/// Certificate of a piece by that of another image.
fn by_image(piece: &Piece, like: &Certificate) -> Option<Certificate> {
    let caps = piece.caps.iter().map(|(_, faces)| faces);
    let others: BTreeSet<_> = piece.joints.iter().chain(caps).flatten().map(|&face| face_key(face)).collect();
    let mut wall = boundary_faces(&piece.mesh);
    wall.retain(|&face| !others.contains(&face_key(face)));
    certify_image(&PartView { mesh: &piece.mesh, joints: &piece.joints, caps: &piece.caps }, &wall, like)
}

fn moved(piece: &Piece, to: impl Fn(&Point3) -> Point3) -> Piece {
    let mut piece = piece.clone();
    piece.mesh.points = piece.mesh.points.iter().map(to).collect();
    piece
}

/// Straight vessel of radius 1 and length 24.
fn straight() -> Piece {
    Piece { mesh: tube_lattice(2, 48, 0.5), ..Piece::default() }
}

/// Bends the straight vessel into an arc of this radius. At 24 / 2π its ends meet.
fn bent(radius: f64) -> Piece {
    moved(&straight(), |p| {
        let (sine, cosine) = libm::sincos(p.z / radius);
        Point3::new((radius + p.x) * cosine, p.y, (radius + p.x) * sine)
    })
}

#[test]
fn images_have_the_certificates_of_other_parts() {
    let bar = bar();
    // A slice with two joints, and one with a joint and a cap.
    for (piece, like) in bar.pieces.iter().zip(&bar.certificates).take(2) {
        let image = moved(piece, |p| Point3::new(7.0 - 2.0 * p.y, 2.0 * p.x, 2.0 * p.z));
        assert_eq!(by_image(&image, like), Some(image.certificate()));
    }
    // Not star-shaped.
    let image = bent(6.0);
    assert_eq!(by_image(&image, &straight().certificate()), Some(image.certificate()));
}

#[test]
fn images_with_faults_have_none() {
    let like = straight().certificate();
    let crossing = bent(3.5);
    assert!(!crossing.certificate().is_sound(), "its ends cross");
    let mirrored = moved(&straight(), |p| Point3::new(-p.x, p.y, p.z));
    let far = moved(&straight(), |p| p * f64::INFINITY);
    for image in [&crossing, &mirrored, &far] {
        assert_eq!(by_image(image, &like), None);
    }
    // Parts that are not sound, or have other tetrahedra, are not alike.
    assert_eq!(by_image(&straight(), &mirrored.certificate()), None);
    assert_eq!(by_image(&Piece { mesh: tube_lattice(2, 47, 0.5), ..Piece::default() }, &like), None);
}
