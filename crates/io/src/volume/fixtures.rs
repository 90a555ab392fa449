//! Meshes for tests of all formats.

use super::content::MeshNotes;
use anastomesh_mesh::adjacency::boundary_faces;
use anastomesh_mesh::check::Expectation;
use anastomesh_mesh::geometry::{Point3, Vec3};
use anastomesh_mesh::shapes::tube_lattice;
use anastomesh_mesh::source::{FacePiece, MeshSource, SourceCounts, TetPiece};
use anastomesh_mesh::{Cap, Patch, VolumeMesh, WALL};
use std::borrow::Cow;
use std::io;
use std::ops::Range;

/// Tube with its foot labelled as inlet; every second tetrahedron is in block 1.
pub fn labelled_tube(layers: u32) -> (VolumeMesh, MeshNotes) {
    let mesh = tube_lattice(3, layers, 0.3);
    let boundary = boundary_faces(&mesh);
    let foot = |f: &[u32; 3]| f.iter().all(|&v| mesh.points[v as usize].z < 0.1);
    let cap = Cap { node: 4_000_000_000, center: Point3::new(0.1, 1e-17, 0.0), normal: -Vec3::z(), radius: 1.25 };
    let volume = VolumeMesh {
        tet_block: (0..mesh.tets.len() as i32).map(|i| i % 2).collect(),
        boundary_block: (0..boundary.len() as i32).map(|i| i % 3).collect(),
        boundary_patch: boundary.iter().map(|f| if foot(f) { 3 } else { WALL }).collect(),
        patches: vec![
            Patch { id: WALL, name: "wall".into(), cap: None },
            Patch { id: 3, name: "outlet_0".into(), cap: Some(cap) },
        ],
        boundary,
        mesh,
    };
    let notes = MeshNotes {
        expectation: Some(Expectation { loops: vec![0, 2], terminals: vec![7, 4_000_000_000] }),
        generator: "anastomesh 0.1.0".into(),
        options: "rho = 3 # größer".into(),
        regions: false,
        flow: None,
    };
    (volume, notes)
}

/// Mesh in memory, served in parts of these sizes, repeated cyclically.
pub(super) struct Cut<'a> {
    pub volume: &'a VolumeMesh,
    pub sizes: &'a [usize],
}

impl Cut<'_> {
    fn ranges(&self, count: usize) -> Vec<Range<usize>> {
        let mut ranges = Vec::new();
        let (mut at, mut sizes) = (0, self.sizes.iter().cycle());
        while at < count {
            let end = count.min(at + sizes.next().unwrap());
            ranges.push(at..end);
            at = end;
        }
        ranges
    }

    /// Items of a part among `count`; the last parts may be empty.
    fn range(&self, count: usize, part: u32) -> Range<usize> {
        self.ranges(count).get(part as usize).cloned().unwrap_or(count..count)
    }
}

/// Available part of a list, possibly empty.
fn known(values: &[i32], range: Range<usize>) -> Cow<'_, [i32]> {
    values.get(range).unwrap_or_default().into()
}

impl MeshSource for Cut<'_> {
    fn counts(&self) -> SourceCounts {
        self.volume.counts()
    }

    fn patches(&self) -> &[Patch] {
        &self.volume.patches
    }

    fn parts(&self) -> u32 {
        let SourceCounts { points, tets, boundary } = self.counts();
        self.ranges(points.max(tets).max(boundary)).len() as u32
    }

    fn points(&self, part: u32) -> io::Result<Cow<'_, [Point3]>> {
        let points = &self.volume.mesh.points;
        Ok(points[self.range(points.len(), part)].into())
    }

    fn tets(&self, part: u32) -> io::Result<TetPiece<'_>> {
        let VolumeMesh { mesh, tet_block, .. } = self.volume;
        let range = self.range(mesh.tets.len(), part);
        Ok(TetPiece { tets: mesh.tets[range.clone()].into(), blocks: known(tet_block, range) })
    }

    fn boundary(&self, part: u32) -> io::Result<FacePiece<'_>> {
        let VolumeMesh { boundary, boundary_patch, boundary_block, .. } = self.volume;
        let range = self.range(boundary.len(), part);
        Ok(FacePiece {
            faces: boundary[range.clone()].into(),
            patches: known(boundary_patch, range.clone()),
            blocks: known(boundary_block, range),
        })
    }
}
