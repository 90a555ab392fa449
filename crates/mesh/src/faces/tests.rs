use super::*;
use crate::adjacency::boundary_faces;
use crate::geometry::Point3;
use crate::shapes::cube_lattice;
use crate::source::{SourceCounts, TetPiece};
use crate::{Patch, VolumeMesh};
use std::borrow::Cow;

/// A cube whose lower side is patch 3, in unrelated parts of a given number of tetrahedra and labelled faces.
struct Cut(VolumeMesh, usize);

impl Cut {
    fn new(size: usize) -> Self {
        let mesh = cube_lattice(3);
        let boundary = boundary_faces(&mesh);
        let low = |face: &[u32; 3]| face.iter().all(|&v| mesh.points[v as usize].z == 0.0);
        let boundary_patch = boundary.iter().map(|face| if low(face) { 3 } else { 1 }).collect();
        Self(VolumeMesh { mesh, boundary, boundary_patch, ..VolumeMesh::default() }, size)
    }

    fn some<'a, T: Clone>(&self, list: &'a [T], part: u32) -> Cow<'a, [T]> {
        list.chunks(self.1).nth(part as usize).unwrap_or_default().into()
    }
}

impl MeshSource for Cut {
    fn counts(&self) -> SourceCounts {
        self.0.counts()
    }
    fn patches(&self) -> &[Patch] {
        &[]
    }
    fn parts(&self) -> u32 {
        self.0.mesh.tets.len().div_ceil(self.1) as u32
    }
    fn points(&self, part: u32) -> io::Result<Cow<'_, [Point3]>> {
        Ok(self.some(&self.0.mesh.points, part))
    }
    fn tets(&self, part: u32) -> io::Result<TetPiece<'_>> {
        Ok(TetPiece { tets: self.some(&self.0.mesh.tets, part), ..TetPiece::default() })
    }
    fn boundary(&self, part: u32) -> io::Result<FacePiece<'_>> {
        let patches = self.some(&self.0.boundary_patch, part);
        Ok(FacePiece { faces: self.some(&self.0.boundary, part), patches, ..FacePiece::default() })
    }
}

fn all(cut: &Cut) -> PartFaces {
    let mut all = PartFaces::default();
    let gather = |part: &PartFaces| {
        all.inner.extend_from_slice(&part.inner);
        all.outer.extend_from_slice(&part.outer);
        Ok(())
    };
    Faces::of(cut).unwrap().each(gather).unwrap();
    all.outer.sort_unstable();
    all
}

#[test]
fn every_face_is_there_once_in_the_order_of_its_tetrahedra() {
    let cut = Cut::new(1000);
    let PartFaces { inner, outer } = all(&cut);
    assert_eq!(2 * inner.len() + outer.len(), 4 * cut.0.mesh.tets.len());
    assert!(inner.is_sorted() && inner.iter().all(|face| face.tets[0] < face.tets[1]));
    let of = |tet: u32| TET_FACES.map(|side| side.map(|corner| cut.0.mesh.tets[tet as usize][corner]));
    for face in &inner {
        assert!(of(face.tets[0]).contains(&face.vertices));
        assert!(of(face.tets[1]).map(face_key).contains(&face_key(face.vertices)));
    }
    assert!(outer.iter().all(|face| of(face.tet).contains(&face.vertices)));
    assert_eq!(outer.iter().filter(|face| face.patch == 3).count(), 18);
}

#[test]
fn parts_make_no_difference() {
    let whole = all(&Cut::new(1000));
    for size in [1, 5, 40, 161] {
        assert_eq!(all(&Cut::new(size)), whole, "{size}");
    }
}

#[test]
fn a_face_without_patch_or_with_three_tetrahedra_is_named() {
    for size in [1000, 20] {
        let mut cut = Cut::new(size);
        let [a, b, c] = face_key(cut.0.boundary.pop().unwrap());
        let error = Faces::of(&cut).err().unwrap();
        assert!(error.to_string().contains(&format!("points {a}, {b} and {c}")), "{error}");
        let mut cut = Cut::new(size);
        cut.0.mesh.tets.push(cut.0.mesh.tets[0]);
        assert_eq!(Faces::of(&cut).err().unwrap().kind(), io::ErrorKind::InvalidData);
    }
}
