//! All faces of a mesh that is read in parts, with the two tetrahedra of each, or its patch.
//!
//! Faces inside a part are paired when the part is read. Only faces between parts are stored: about 50 bytes each.

use super::source::{FacePiece, MeshSource, miscounted};
use super::{TET_FACES, face_key};
use std::io;

/// A face between two tetrahedra.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct InnerFace {
    /// The tetrahedra by their numbers in the whole mesh, the lower first.
    pub tets: [u32; 2],
    /// Vertices, counter-clockwise seen from the second tetrahedron.
    pub vertices: [u32; 3],
}

/// A face of the boundary.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct OuterFace {
    /// Its tetrahedron, by its number in the whole mesh.
    pub tet: u32,
    /// Its patch.
    pub patch: i32,
    /// Vertices, oriented outwards.
    pub vertices: [u32; 3],
}

/// Faces numbered with a part.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct PartFaces {
    /// Faces with their lower tetrahedron in the part, ascending by tetrahedra.
    pub inner: Vec<InnerFace>,
    /// Boundary faces with their tetrahedron in the part, ascending by tetrahedron.
    pub outer: Vec<OuterFace>,
}

/// Source of the faces of each part of a mesh.
pub struct Faces<'a> {
    mesh: &'a dyn MeshSource,
    /// Number of the first tetrahedron of each part.
    first: Vec<u32>,
    /// Opposite sides of faces that are no pair within a part, by tetrahedron and vertices.
    known: Vec<(u32, [u32; 3], Side)>,
}

/// Opposite side of a face.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Side {
    Tet(u32),
    Patch(i32),
}

/// A face not paired within its part: its vertices in ascending order, and one of its sides.
type Loose = ([u32; 3], Side);

/// Faces of a part, with tetrahedra counted from 0.
#[derive(Default)]
struct Sorted {
    tets: Vec<[u32; 4]>,
    /// Handles of faces between two tetrahedra: four times the tetrahedron, plus the face.
    pairs: Vec<[u32; 2]>,
    /// Handles of boundary faces, with their patches.
    labelled: Vec<(u32, i32)>,
    /// Handles of other faces.
    open: Vec<u32>,
    /// Labels of the part without a face in it.
    strays: Vec<Loose>,
}

impl<'a> Faces<'a> {
    /// Finds the faces between parts: reads tetrahedra and boundary once.
    ///
    /// # Errors
    /// Errors of reading the mesh; `InvalidData` if a face has more than two sides, or one side and no patch.
    pub fn of(mesh: &'a dyn MeshSource) -> io::Result<Self> {
        Self::look(mesh, |sorted| (sorted.loose(), ()), |_, ()| Ok(()))
    }

    /// Passes on the boundary faces labelled in their own part, in order, reading tetrahedra and boundary once. Returns
    /// true if these are all: some labels may be in another part than their face.
    ///
    /// # Errors
    /// Errors of reading the mesh or of `each`; `InvalidData` as [`of`](Self::of), and if the mesh contradicts its
    /// counts.
    pub fn each_own(
        mesh: &'a dyn MeshSource,
        mut each: impl FnMut(&[OuterFace]) -> io::Result<()>,
    ) -> io::Result<bool> {
        let counts = mesh.counts();
        let (mut inner, mut outer) = (0, 0);
        let faces = Self::look(
            mesh,
            |sorted| (sorted.loose(), (sorted.pairs.len(), sorted.outer(0))),
            |first, (pairs, mut faces)| {
                inner += pairs;
                outer += faces.len();
                // Writers have announced the number of faces before.
                if outer > counts.boundary {
                    return Err(miscounted());
                }
                for face in &mut faces {
                    face.tet += first;
                }
                each(&faces)
            },
        )?;
        let apart = faces.known.iter().filter(|(_, _, side)| matches!(side, Side::Patch(_))).count();
        inner += faces.known.len() - apart;
        if outer + apart != counts.boundary || 2 * inner + counts.boundary != 4 * counts.tets {
            return Err(miscounted());
        }
        Ok(apart == 0)
    }

    /// Reads all parts and collects their unpaired faces. `each` receives the number of the first tetrahedron of each
    /// part and the additional result of `take`.
    fn look<T: Send>(
        mesh: &'a dyn MeshSource,
        take: impl Fn(&Sorted) -> (Vec<Loose>, T) + Sync,
        mut each: impl FnMut(u32, T) -> io::Result<()>,
    ) -> io::Result<Self> {
        let (mut first, mut tets) = (Vec::with_capacity(mesh.parts() as usize), 0_u32);
        let mut loose: Vec<Loose> = Vec::new();
        mesh.each_part(
            |part| Sorted::read(mesh, part).map(|sorted| (sorted.tets.len(), take(&sorted))),
            |(count, (found, taken))| {
                loose.extend(found.into_iter().map(|(key, side)| match side {
                    Side::Tet(tet) => (key, Side::Tet(tets + tet)),
                    patch @ Side::Patch(_) => (key, patch),
                }));
                first.push(tets);
                let start = tets;
                tets = u32::try_from(count).ok().and_then(|count| tets.checked_add(count)).ok_or_else(miscounted)?;
                each(start, taken)
            },
        )?;
        loose.sort_unstable();
        Ok(Self { mesh, first, known: joined(&loose)? })
    }

    /// Opposite side of a face not paired within its part. `None` if the lower tetrahedron stores it.
    fn other_side(&self, sorted: &Sorted, first: u32, handle: u32) -> Option<Side> {
        let at = (first + (handle >> 2), face_key(face_of(&sorted.tets, handle)));
        let place = self.known.binary_search_by_key(&at, |&(tet, key, _)| (tet, key)).ok()?;
        Some(self.known[place].2)
    }

    /// Faces of a part.
    ///
    /// # Errors
    /// Errors of reading the mesh.
    pub fn of_part(&self, part: u32) -> io::Result<PartFaces> {
        let sorted = Sorted::read(self.mesh, part)?;
        let first = self.first[part as usize];
        let inner = |handle: u32, tets: [u32; 2]| InnerFace { tets, vertices: face_of(&sorted.tets, handle) };
        let pair = |&[a, b]: &[u32; 2]| inner(a, [a, b].map(|handle| first + (handle >> 2)));
        let mut faces = PartFaces { inner: sorted.pairs.iter().map(pair).collect(), outer: sorted.outer(first) };
        for &handle in &sorted.open {
            match self.other_side(&sorted, first, handle) {
                Some(Side::Tet(other)) => faces.inner.push(inner(handle, [first + (handle >> 2), other])),
                Some(Side::Patch(patch)) => faces.outer.push(sorted.outer_face(first, handle, patch)),
                None => {}
            }
        }
        faces.inner.sort_unstable();
        faces.outer.sort_unstable();
        Ok(faces)
    }

    /// Passes on the faces of all parts, in order.
    ///
    /// # Errors
    /// Errors of reading the mesh or of `each`; `InvalidData` if the mesh contradicts its own counts.
    pub fn each(&self, mut each: impl FnMut(&PartFaces) -> io::Result<()>) -> io::Result<()> {
        self.each_with(|_, _, _| Ok(()), |faces, ()| each(faces))
    }

    /// Passes on the faces of all parts, in order, each with a result of `take`. That runs on all threads, and receives
    /// the number of the part and of its first tetrahedron.
    ///
    /// # Errors
    /// Errors of reading the mesh, of `take` or of `each`; `InvalidData` if the mesh contradicts its own counts.
    pub fn each_with<T: Send>(
        &self,
        take: impl Fn(u32, u32, &PartFaces) -> io::Result<T> + Sync,
        mut each: impl FnMut(&PartFaces, T) -> io::Result<()>,
    ) -> io::Result<()> {
        let counts = self.mesh.counts();
        let (mut sides, mut labelled) = (0, 0);
        self.mesh.each_part(
            |part| {
                let faces = self.of_part(part)?;
                let taken = take(part, self.first[part as usize], &faces)?;
                Ok((faces, taken))
            },
            |(faces, taken)| {
                sides += 2 * faces.inner.len() + faces.outer.len();
                labelled += faces.outer.len();
                // Writers have announced the number of faces before.
                if sides > 4 * counts.tets || labelled > counts.boundary {
                    return Err(miscounted());
                }
                each(&faces, taken)
            },
        )?;
        if sides == 4 * counts.tets && labelled == counts.boundary { Ok(()) } else { Err(miscounted()) }
    }
}

/// Both sides of each unpaired face; the input is sorted.
fn joined(loose: &[Loose]) -> io::Result<Vec<(u32, [u32; 3], Side)>> {
    let mut known = Vec::with_capacity(loose.len() / 2);
    for sides in loose.chunk_by(|a, b| a.0 == b.0) {
        match *sides {
            [(key, Side::Tet(tet)), (_, other)] => known.push((tet, key, other)),
            _ => return Err(unpaired(sides[0].0, sides.len())),
        }
    }
    known.sort_unstable();
    Ok(known)
}

fn unpaired([a, b, c]: [u32; 3], sides: usize) -> io::Error {
    let text = match sides {
        1 => format!(
            "the face of points {a}, {b} and {c} has a tetrahedron or a patch on one side and nothing on the other"
        ),
        _ => format!("the face of points {a}, {b} and {c} has {sides} tetrahedra and patches instead of two"),
    };
    io::Error::new(io::ErrorKind::InvalidData, text)
}

fn face_of(tets: &[[u32; 4]], handle: u32) -> [u32; 3] {
    let tet = &tets[(handle >> 2) as usize];
    TET_FACES[(handle & 3) as usize].map(|corner| tet[corner])
}

/// Vertices in ascending order and a handle, packed into one sortable number.
fn packed([a, b, c]: [u32; 3], handle: u32) -> u128 {
    (u128::from(a) << 96) | (u128::from(b) << 64) | (u128::from(c) << 32) | u128::from(handle)
}

/// Flag of a handle that is the index of a label.
const LABEL: u32 = 1 << 31;

/// Vertices of a packed side.
fn vertices_of(side: u128) -> [u32; 3] {
    [96, 64, 32].map(|shift| (side >> shift) as u32)
}

/// Distributes sides to buckets, equal faces to one bucket. Returns the ends of the buckets, too. Sorting small buckets
/// takes half as long as sorting all.
fn buckets(sides: &[u128]) -> (Vec<u128>, Vec<u32>) {
    let bits = sides.len().max(8).ilog2() - 2;
    let bucket_of = |side: u128| {
        let mixed = ((side >> 64) as u64 ^ u64::from((side >> 32) as u32) << 17).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        (mixed >> (u64::BITS - bits)) as usize
    };
    let mut ends = vec![0_u32; 1 << bits];
    for &side in sides {
        ends[bucket_of(side)] += 1;
    }
    let mut before = 0;
    for end in &mut ends {
        before += std::mem::replace(end, before);
    }
    let mut sorted = vec![0; sides.len()];
    for &side in sides {
        let end = &mut ends[bucket_of(side)];
        sorted[*end as usize] = side;
        *end += 1;
    }
    (sorted, ends)
}

impl Sorted {
    fn read(mesh: &dyn MeshSource, part: u32) -> io::Result<Self> {
        let tets = mesh.tets(part)?.tets.into_owned();
        let FacePiece { faces, patches, .. } = mesh.boundary(part)?;
        // Handles have 31 bits: the last one marks labels.
        if tets.len() >= (LABEL / 4) as usize || faces.len() >= LABEL as usize {
            return Err(io::Error::new(io::ErrorKind::InvalidData, "a part of the mesh has more than 2^29 tetrahedra"));
        }
        let mut sorted = Self { tets, ..Self::default() };
        let handles = 0..4 * sorted.tets.len() as u32;
        let labels = (0..).zip(faces.iter()).map(|(i, &face)| packed(face_key(face), LABEL | i));
        let sides: Vec<u128> = handles.map(|h| packed(face_key(face_of(&sorted.tets, h)), h)).chain(labels).collect();
        let patch = |side: u128| patches.get((side as u32 & !LABEL) as usize).copied().unwrap_or(0);
        let (mut sides, ends) = buckets(&sides);
        let mut start = 0;
        for end in ends {
            let bucket = &mut sides[start..end as usize];
            start = end as usize;
            bucket.sort_unstable();
            for same in bucket.chunk_by(|a, b| a >> 32 == b >> 32) {
                // Tetrahedra come before labels.
                match *same {
                    [one] if one as u32 & LABEL == 0 => sorted.open.push(one as u32),
                    [label] => sorted.strays.push((vertices_of(label), Side::Patch(patch(label)))),
                    [one, two] if one as u32 & LABEL == 0 && two as u32 & LABEL == 0 => {
                        sorted.pairs.push([one as u32, two as u32]);
                    }
                    [one, label] if one as u32 & LABEL == 0 => sorted.labelled.push((one as u32, patch(label))),
                    _ => return Err(unpaired(vertices_of(same[0]), same.len())),
                }
            }
        }
        Ok(sorted)
    }

    /// Boundary faces labelled in the part itself, ascending by tetrahedra.
    fn outer(&self, first: u32) -> Vec<OuterFace> {
        let mut outer: Vec<OuterFace> =
            self.labelled.iter().map(|&(handle, patch)| self.outer_face(first, handle, patch)).collect();
        outer.sort_unstable();
        outer
    }

    fn outer_face(&self, first: u32, handle: u32, patch: i32) -> OuterFace {
        OuterFace { tet: first + (handle >> 2), patch, vertices: face_of(&self.tets, handle) }
    }

    fn loose(&self) -> Vec<Loose> {
        let open = self.open.iter().map(|&handle| (face_key(face_of(&self.tets, handle)), Side::Tet(handle >> 2)));
        open.chain(self.strays.iter().copied()).collect()
    }
}

#[cfg(test)]
mod tests;
