//! Memory of the check of a mesh in parts. The allocator is that of the whole program, so this is a program of its own.

use std::io;

use anastomesh_mesh::TetMesh;
use anastomesh_mesh::adjacency::tet_adjacency;
use anastomesh_mesh::check::parts::{Certificate, FacesApart, PartView, Parts, certify_with, check_parts};
use anastomesh_mesh::geometry::Point3;
use peak_alloc::PeakAlloc;

#[global_allocator]
static ALLOCATOR: PeakAlloc = PeakAlloc;

/// Most bytes per part. The plan of the whole mesh has some 40 more.
const MOST: usize = 150;

/// Corners of the four points at each end of a cube.
const CORNERS: [[f64; 2]; 4] = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]];

/// Cube as six tetrahedra around its diagonal. Points 0 to 3 are at one end, 4 to 7 at the other.
const TETS: [[u32; 4]; 6] = [[0, 1, 3, 7], [0, 5, 1, 7], [0, 4, 5, 7], [0, 6, 4, 7], [0, 2, 6, 7], [0, 3, 2, 7]];

/// Row of cubes. Each is a part, with joints at both ends.
struct Row {
    count: u32,
    joined: Vec<[(u32, u32); 2]>,
}

impl Row {
    fn new(count: u32) -> Self {
        // The first cube has one joint, which is its last end.
        let first = |part: u32| u32::from(part > 0);
        Self { count, joined: (1..count).map(|part| [(part - 1, first(part - 1)), (part, 0)]).collect() }
    }

    fn mesh(part: u32) -> TetMesh {
        let end = |z: u32| CORNERS.map(|[x, y]| Point3::new(x, y, f64::from(z)));
        TetMesh { points: [part, part + 1].map(end).as_flattened().to_vec(), tets: TETS.to_vec() }
    }

    /// Boundary faces outside joints, and those of each joint.
    fn faces(&self, part: u32) -> (Vec<[u32; 3]>, Vec<Vec<[u32; 3]>>) {
        let (mut wall, mut ends) = (Vec::new(), [Vec::new(), Vec::new()]);
        let mesh = Self::mesh(part);
        for handle in tet_adjacency(&mesh.tets, 8).boundary() {
            let face = anastomesh_mesh::adjacency::face_vertices(&mesh.tets, handle);
            match face.map(|v| v / 4) {
                [0, 0, 0] if part > 0 => ends[0].push(face),
                [1, 1, 1] if part + 1 < self.count => ends[1].push(face),
                _ => wall.push(face),
            }
        }
        (wall, ends.into_iter().filter(|end| !end.is_empty()).collect())
    }

    fn apart(&self, part: u32, faces: Vec<[u32; 3]>) -> FacesApart {
        let points = Self::mesh(part).points;
        FacesApart { vertices: (0..8).map(|v| self.vertex(part, v)).collect(), points, faces }
    }
}

impl Parts for Row {
    fn count(&self) -> usize {
        self.count as usize
    }

    fn certificate(&self, part: u32) -> io::Result<Certificate> {
        let (mesh, joints) = (Self::mesh(part), self.faces(part).1);
        let view = PartView { mesh: &mesh, joints: &joints, caps: &[] };
        Ok(certify_with(&view, || tet_adjacency(&mesh.tets, 8)))
    }

    fn wall(&self, part: u32) -> io::Result<FacesApart> {
        Ok(self.apart(part, self.faces(part).0))
    }

    fn joined(&self) -> &[[(u32, u32); 2]] {
        &self.joined
    }

    fn joint(&self, part: u32, joint: u32) -> io::Result<FacesApart> {
        let faces = self.faces(part).1.swap_remove(joint as usize);
        let end = faces[0][0] / 4;
        let FacesApart { points, vertices, .. } = self.apart(part, Vec::new());
        let own = 4 * end as usize..4 * end as usize + 4;
        let faces = faces.into_iter().map(|face| face.map(|v| v - 4 * end)).collect();
        Ok(FacesApart { points: points[own.clone()].to_vec(), vertices: vertices[own].to_vec(), faces })
    }

    fn vertex(&self, part: u32, local: u32) -> u32 {
        4 * part + local
    }

    fn tet(&self, part: u32, local: u32) -> u64 {
        6 * u64::from(part) + u64::from(local)
    }
}

/// Most bytes that the check holds, beyond the row itself.
fn peak(count: u32) -> usize {
    let row = Row::new(count);
    let before = ALLOCATOR.current_usage();
    ALLOCATOR.reset_peak_usage();
    let checked = check_parts(&row, &[], None, 1 << 20).expect("readable");
    assert_eq!(checked.report.failed().count(), 0, "{:?}", checked.report.failed().collect::<Vec<_>>());
    assert_eq!(checked.report.counts.tets, 6 * count as usize);
    ALLOCATOR.peak_usage() - before
}

#[test]
fn a_check_holds_few_bytes_per_part() {
    // More than the parts and joints that are read at a time, so that buffers have their full size in both.
    let (few, many) = (17_000, 34_000);
    let more = peak(many).saturating_sub(peak(few)) / (many - few) as usize;
    assert!(more <= MOST, "{more} bytes per part");
}
