//! All faces of a mesh that is read in parts, with the two tetrahedra of each, or its patch.
//!
//! Faces inside a part are paired when the part is read. Only faces between parts are stored: about 50 bytes each.

use super::source::{FacePiece, MeshSource, miscounted};
use super::{TET_FACES, face_key};
use std::borrow::Cow;
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
}

impl<'a> Faces<'a> {
    /// Finds the faces between parts: reads tetrahedra and boundary once.
    ///
    /// # Errors
    /// Errors of reading the mesh; `InvalidData` if a face has more than two sides, or one side and no patch.
    pub fn of(mesh: &'a dyn MeshSource) -> io::Result<Self> {
        Self::look(mesh, false, |_, _| Ok(()))
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
        let faces = Self::look(mesh, true, |first, mut ends| {
            inner += ends.pairs;
            outer += ends.outer.len();
            // Writers have announced the number of faces before.
            if outer > counts.boundary {
                return Err(miscounted());
            }
            for face in &mut ends.outer {
                face.tet += first;
            }
            each(&ends.outer)
        })?;
        let apart = faces.known.iter().filter(|(_, _, side)| matches!(side, Side::Patch(_))).count();
        inner += faces.known.len() - apart;
        if outer + apart != counts.boundary || 2 * inner + counts.boundary != 4 * counts.tets {
            return Err(miscounted());
        }
        Ok(apart == 0)
    }

    /// Reads all parts and collects their unpaired faces. `each` receives the number of the first tetrahedron of each
    /// part and its ends, with boundary faces if `labelled`.
    fn look(
        mesh: &'a dyn MeshSource,
        labelled: bool,
        mut each: impl FnMut(u32, Ends) -> io::Result<()>,
    ) -> io::Result<Self> {
        let (mut first, mut tets) = (Vec::with_capacity(mesh.parts() as usize), 0_u32);
        let mut loose: Vec<Loose> = Vec::new();
        mesh.each_part(
            |part| Ends::read(mesh, part, labelled),
            |mut ends| {
                let count = ends.tets;
                loose.extend(std::mem::take(&mut ends.loose).into_iter().map(|(key, side)| match side {
                    Side::Tet(tet) => (key, Side::Tet(tets + tet)),
                    patch @ Side::Patch(_) => (key, patch),
                }));
                first.push(tets);
                let start = tets;
                tets = u32::try_from(count).ok().and_then(|count| tets.checked_add(count)).ok_or_else(miscounted)?;
                each(start, ends)
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
                Some(Side::Patch(patch)) => faces.outer.push(outer_face(&sorted.tets, first, handle, patch)),
                None => {}
            }
        }
        faces.inner = by_lower_tet(&faces.inner, first, sorted.tets.len());
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

/// Sorts faces whose lower tetrahedra are `count` from `first` on.
fn by_lower_tet(faces: &[InnerFace], first: u32, count: usize) -> Vec<InnerFace> {
    let mut ends = vec![0_u32; count + 1];
    for face in faces {
        ends[(face.tets[0] - first) as usize + 1] += 1;
    }
    for i in 1..ends.len() {
        ends[i] += ends[i - 1];
    }
    let mut sorted = vec![InnerFace { tets: [0; 2], vertices: [0; 3] }; faces.len()];
    for &face in faces {
        let end = &mut ends[(face.tets[0] - first) as usize];
        sorted[*end as usize] = face;
        *end += 1;
    }
    let mut start = 0;
    for &end in &ends[..count] {
        sorted[start..end as usize].sort_unstable();
        start = end as usize;
    }
    sorted
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

/// Tetrahedra and labels of a part. Handles have 31 bits: the last one marks labels.
fn read_part(mesh: &dyn MeshSource, part: u32) -> io::Result<(Cow<'_, [[u32; 4]]>, FacePiece<'_>)> {
    let (tets, labels) = (mesh.tets(part)?.tets, mesh.boundary(part)?);
    if tets.len() >= (LABEL / 4) as usize || labels.faces.len() >= LABEL as usize {
        return Err(io::Error::new(io::ErrorKind::InvalidData, "a part of the mesh has more than 2^29 tetrahedra"));
    }
    Ok((tets, labels))
}

/// Patch of the label with this handle.
fn patch_of(labels: &FacePiece, handle: u32) -> i32 {
    labels.patches.get((handle & !LABEL) as usize).copied().unwrap_or(0)
}

impl Sorted {
    fn read(mesh: &dyn MeshSource, part: u32) -> io::Result<Self> {
        let (tets, labels) = read_part(mesh, part)?;
        let mut sorted = Self { tets: tets.into_owned(), ..Self::default() };
        let handles = 0..4 * sorted.tets.len() as u32;
        let marks = (0..).zip(labels.faces.iter()).map(|(i, &face)| packed(face_key(face), LABEL | i));
        let sides: Vec<u128> = handles.map(|h| packed(face_key(face_of(&sorted.tets, h)), h)).chain(marks).collect();
        let (mut sides, ends) = buckets(&sides);
        let mut start = 0;
        for end in ends {
            let bucket = &mut sides[start..end as usize];
            start = end as usize;
            bucket.sort_unstable();
            for same in bucket.chunk_by(|a, b| a >> 32 == b >> 32) {
                match paired(same)? {
                    Paired::Open(handle) => sorted.open.push(handle),
                    Paired::Stray(_) => {}
                    Paired::Inner(pair) => sorted.pairs.push(pair),
                    Paired::Outer(handle, label) => sorted.labelled.push((handle, patch_of(&labels, label))),
                }
            }
        }
        Ok(sorted)
    }

    /// Boundary faces labelled in the part itself, ascending by tetrahedra.
    fn outer(&self, first: u32) -> Vec<OuterFace> {
        let mut outer: Vec<OuterFace> =
            self.labelled.iter().map(|&(handle, patch)| outer_face(&self.tets, first, handle, patch)).collect();
        outer.sort_unstable();
        outer
    }
}

fn outer_face(tets: &[[u32; 4]], first: u32, handle: u32, patch: i32) -> OuterFace {
    OuterFace { tet: first + (handle >> 2), patch, vertices: face_of(tets, handle) }
}

/// Sides of a face within a part, by their handles.
enum Paired {
    /// One tetrahedron.
    Open(u32),
    /// One label.
    Stray(u32),
    /// Two tetrahedra.
    Inner([u32; 2]),
    /// A tetrahedron and a label.
    Outer(u32, u32),
}

/// Pairs the sides of one face, given in ascending order: tetrahedra come before labels.
fn paired(same: &[u128]) -> io::Result<Paired> {
    let is_label = |side: u128| side as u32 & LABEL != 0;
    match *same {
        [one] if !is_label(one) => Ok(Paired::Open(one as u32)),
        [label] => Ok(Paired::Stray(label as u32)),
        [one, two] if !is_label(two) => Ok(Paired::Inner([one as u32, two as u32])),
        [one, label] if !is_label(one) => Ok(Paired::Outer(one as u32, label as u32)),
        _ => Err(unpaired(vertices_of(same[0]), same.len())),
    }
}

/// Ends of a part: faces that are no pair within it, and boundary faces on request.
struct Ends {
    /// Number of tetrahedra.
    tets: usize,
    loose: Vec<Loose>,
    /// Number of faces between two tetrahedra.
    pairs: usize,
    /// Boundary faces labelled in the part itself, ascending by tetrahedra, which are counted from 0.
    outer: Vec<OuterFace>,
}

/// Sums of hashes in a table. The upper bits are the exclusive or of the hashes, and the lowest two the number of sides, at
/// most 3.
struct Sums {
    table: Vec<u64>,
    shift: u32,
}

impl Sums {
    /// Slots per side. With four, 12 % of the pairs share their slot.
    const SLOTS: usize = 4;

    fn new(sides: usize) -> Self {
        let bits = (Self::SLOTS * sides.max(1)).next_power_of_two().ilog2().max(1);
        Self { table: vec![0; 1 << bits], shift: u64::BITS - bits }
    }

    fn add(&mut self, hash: u64, sides: u64) {
        let slot = &mut self.table[(hash >> self.shift) as usize];
        *slot = ((*slot ^ (hash << 2)) & !3) | ((*slot & 3) + sides).min(3);
    }

    /// True if the slot of this hash holds one pair and nothing else.
    fn is_pair(&self, hash: u64) -> bool {
        self.table[(hash >> self.shift) as usize] == 2
    }
}

fn hash_of([a, b, c]: [u32; 3]) -> u64 {
    let two = (u64::from(a) << 32 | u64::from(b)).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    (two.rotate_left(32) ^ u64::from(c).wrapping_mul(0xd6e8_feb8_6659_fd93)).wrapping_mul(0x9fb2_1c65_1e98_df25)
}

impl Ends {
    /// Reads a part. Most faces are found to be pairs by their hashes, without sorting. A false pair, of two faces with equal
    /// hashes of 64 bits, contradicts the counts of the mesh later.
    fn read(mesh: &dyn MeshSource, part: u32, labelled: bool) -> io::Result<Self> {
        let (tets, labels) = read_part(mesh, part)?;
        let sides = 4 * tets.len() as u32;
        let key = |handle: u32| face_key(face_of(&tets, handle));
        let hashes: Vec<u64> = (0..sides).map(|handle| hash_of(key(handle))).collect();
        let marks: Vec<u64> = labels.faces.iter().map(|&face| hash_of(face_key(face))).collect();
        let mut sums = Sums::new(hashes.len() + marks.len());
        for &hash in &hashes {
            sums.add(hash, 1);
        }
        // A slot with 3 sides is never a pair.
        for &hash in &marks {
            sums.add(hash, if labelled { 3 } else { 1 });
        }
        let tet_sides = (0..sides).zip(&hashes).filter(|(_, hash)| !sums.is_pair(**hash));
        let mut rest: Vec<u128> = tet_sides.map(|(handle, _)| packed(key(handle), handle)).collect();
        let skipped = hashes.len() - rest.len();
        let label_sides = (0..).zip(labels.faces.iter().zip(&marks)).filter(|(_, (_, hash))| !sums.is_pair(**hash));
        rest.extend(label_sides.map(|(i, (&face, _))| packed(face_key(face), LABEL | i)));
        rest.sort_unstable();
        let mut ends = Self { tets: tets.len(), loose: Vec::new(), pairs: skipped / 2, outer: Vec::new() };
        for same in rest.chunk_by(|a, b| a >> 32 == b >> 32) {
            let vertices = vertices_of(same[0]);
            match paired(same)? {
                Paired::Open(handle) => ends.loose.push((vertices, Side::Tet(handle >> 2))),
                Paired::Stray(label) => ends.loose.push((vertices, Side::Patch(patch_of(&labels, label)))),
                Paired::Inner(_) => ends.pairs += 1,
                Paired::Outer(handle, label) => {
                    ends.outer.push(outer_face(&tets, 0, handle, patch_of(&labels, label)));
                }
            }
        }
        ends.outer.sort_unstable();
        Ok(ends)
    }
}

#[cfg(test)]
mod tests;
