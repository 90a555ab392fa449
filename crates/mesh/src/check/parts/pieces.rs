//! Check of a labelled mesh that is read in pieces, as parts. Unlabelled boundary faces of a piece are its joints to
//! other pieces, matched by their faces.
//!
//! Pieces are [`Unfit`] as parts if they touch elsewhere or labels are inconsistent. The mesh may still be valid, and
//! must be checked as a whole.

use super::{Certificate, FacesApart, PartView, Parts, certify_with, check_parts, sums};
use crate::adjacency::{NONE, face_vertices, tet_adjacency};
use crate::check::result::{CheckReport, Expectation};
use crate::face_key;
use crate::geometry::DisjointSets;
use crate::same_turn;
use crate::source::{FacePiece, MeshSource};
use crate::{Cap, TetMesh, WALL};
use rayon::prelude::*;
use rustc_hash::FxHashMap;
use std::io;
use std::ops::Range;

/// Reason why pieces cannot be checked as parts. Pieces are counted from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Unfit {
    /// A tetrahedron or labelled face refers to a missing point, or one not used by the piece.
    #[error("piece {0} refers to missing points")]
    Points(u32),
    /// A labelled face is not on the boundary of the piece, is reversed, or is labelled twice.
    #[error("the labelled faces of piece {0} are not its boundary")]
    Labels(u32),
    /// A face is neither wall nor of a cap.
    #[error("faces of piece {0} are neither wall nor cap")]
    Patch(u32),
    /// Faces without label that occur in no other piece, or in more than one.
    #[error("piece {0} has unlabelled faces that it does not share with exactly one other piece")]
    Joint(u32),
    /// Pieces share points outside joints, or some points are in no piece.
    #[error("pieces share points outside common faces, or points are unused")]
    Shared,
}

/// Reason why pieces were not checked.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PiecesError {
    /// Reading failed.
    #[error(transparent)]
    Read(#[from] io::Error),
    /// The pieces are not parts.
    #[error(transparent)]
    Unfit(#[from] Unfit),
}

/// Checks a mesh in pieces that serve as parts. Holds `memory` bytes of walls at a time, and about 1 kB per piece.
///
/// # Errors
/// If the pieces cannot be read, or meet elsewhere than in joints.
pub fn check_pieces(
    pieces: &dyn MeshSource,
    expectation: Option<&Expectation>,
    memory: usize,
) -> Result<CheckReport, PiecesError> {
    let caps: FxHashMap<i32, Cap> = pieces.patches().iter().filter_map(|p| Some((p.id, p.cap?))).collect();
    let known: Vec<Known> =
        (0..pieces.parts()).into_par_iter().map(|i| Known::new(pieces, &caps, i)).collect::<Result<_, _>>()?;
    let joined = join(&known)?;
    let cut = SplitMesh { pieces, known, joined };
    if cut.points() != pieces.counts().points as u64 {
        return Err(Unfit::Shared.into());
    }
    Ok(check_parts(&cut, pieces.patches(), expectation, memory)?.report)
}

/// The pieces as parts.
struct SplitMesh<'a> {
    pieces: &'a dyn MeshSource,
    known: Vec<Known>,
    joined: Vec<[(u32, u32); 2]>,
}

/// Data stored per piece.
struct Known {
    /// Serialized by postcard, which is smaller.
    certificate: Vec<u8>,
    points: u32,
    tets: u32,
    joints: Vec<KnownJoint>,
}

/// Data stored per joint.
struct KnownJoint {
    /// Checksum of the faces, equal in both pieces.
    sum: u64,
    vertices: u32,
    /// Its faces, as handles into the piece's tetrahedra.
    faces: Box<[u32]>,
}

/// Global ids of the points of a piece, ascending; positions are the piece's local ids.
struct Ids {
    all: Vec<u32>,
    /// Positions of the longest run of consecutive ids, which contains nearly all ids that are looked up.
    run: Range<u32>,
}

impl Ids {
    fn of(tets: &[[u32; 4]]) -> Self {
        let all = distinct(tets.as_flattened());
        let mut end = 0;
        let runs = all.chunk_by(|a, b| a + 1 == *b).map(|run| {
            let start = end;
            end += run.len() as u32;
            start..end
        });
        let run = runs.max_by_key(Range::len).unwrap_or_default();
        Self { all, run }
    }

    fn local(&self, id: u32) -> Option<u32> {
        let in_run = id.wrapping_sub(self.all.get(self.run.start as usize).copied()?);
        if in_run < self.run.len() as u32 {
            return Some(self.run.start + in_run);
        }
        self.all.binary_search(&id).ok().map(|i| i as u32)
    }
}

/// Distinct ids, ascending.
fn distinct(ids: &[u32]) -> Vec<u32> {
    let mut all = ids.to_vec();
    all.sort_unstable();
    all.dedup();
    all
}

/// A piece with local ids.
struct Local {
    ids: Ids,
    mesh: TetMesh,
}

impl Local {
    fn read(pieces: &dyn MeshSource, piece: u32) -> Result<Self, PiecesError> {
        let mut tets = pieces.tets(piece)?.tets.into_owned();
        let ids = Ids::of(&tets);
        if ids.all.last().is_some_and(|&last| last as usize >= pieces.counts().points) {
            return Err(Unfit::Points(piece).into());
        }
        let points = pieces.points_of(&ids.all)?;
        for v in tets.as_flattened_mut() {
            *v = ids.local(*v).unwrap_or(NONE);
        }
        Ok(Self { ids, mesh: TetMesh { points, tets } })
    }

    /// Labelled faces with local ids, sorted by their vertices, each with its patch.
    fn labelled(&self, pieces: &dyn MeshSource, piece: u32) -> Result<Vec<([u32; 3], i32)>, PiecesError> {
        let FacePiece { faces, patches, .. } = pieces.boundary(piece)?;
        let mut labelled = Vec::with_capacity(faces.len());
        for (face, &patch) in faces.iter().zip(&*patches) {
            let [Some(a), Some(b), Some(c)] = face.map(|v| self.ids.local(v)) else {
                return Err(Unfit::Points(piece).into());
            };
            labelled.push(([a, b, c], patch));
        }
        labelled.sort_unstable_by_key(|(face, _)| face_key(*face));
        Ok(labelled)
    }

    fn faces(&self, handles: &[u32]) -> Vec<[u32; 3]> {
        handles.iter().map(|&handle| face_vertices(&self.mesh.tets, handle)).collect()
    }

    /// Checksum of faces by global ids, independent of order and orientation.
    fn sum(&self, faces: &[[u32; 3]]) -> u64 {
        let id = |v: u32| self.ids.all[v as usize];
        faces.iter().fold(0, |sum, face| sum.wrapping_add(sums::id_sum(face_key(face.map(id)))))
    }
}

impl Known {
    fn new(pieces: &dyn MeshSource, caps: &FxHashMap<i32, Cap>, piece: u32) -> Result<Self, PiecesError> {
        let local = Local::read(pieces, piece)?;
        let labelled = local.labelled(pieces, piece)?;
        let adjacency = tet_adjacency(&local.mesh.tets, local.mesh.points.len());
        let mut met = vec![false; labelled.len()];
        let is_labelled = |&handle: &u32| {
            let face = face_vertices(&local.mesh.tets, handle);
            let found = labelled.binary_search_by_key(&face_key(face), |(label, _)| face_key(*label));
            found.is_ok_and(|i| same_turn(face, labelled[i].0) && !std::mem::replace(&mut met[i], true))
        };
        let (_, open): (Vec<u32>, Vec<u32>) = adjacency.boundary().partition(is_labelled);
        if met.contains(&false) {
            return Err(Unfit::Labels(piece).into());
        }
        let handles = connected(&local.mesh, open);
        let joints: Vec<Vec<[u32; 3]>> = handles.iter().map(|of| local.faces(of)).collect();
        let caps = caps_of(&labelled, caps).ok_or(Unfit::Patch(piece))?;
        let view = PartView { mesh: &local.mesh, joints: &joints, caps: &caps };
        let certificate = postcard::to_stdvec(&certify_with(&view, || adjacency)).map_err(io::Error::other)?;
        let known = |(faces, handles): (&Vec<[u32; 3]>, Vec<u32>)| KnownJoint {
            sum: local.sum(faces),
            vertices: distinct(faces.as_flattened()).len() as u32,
            faces: handles.into(),
        };
        let joints = joints.iter().zip(handles).map(known).collect();
        let TetMesh { points, tets } = &local.mesh;
        Ok(Self { certificate, points: points.len() as u32, tets: tets.len() as u32, joints })
    }
}

/// Groups of faces connected by vertices, each in ascending order.
fn connected(mesh: &TetMesh, handles: Vec<u32>) -> Vec<Vec<u32>> {
    if handles.is_empty() {
        return Vec::new();
    }
    let mut sets = DisjointSets::new(mesh.points.len());
    for &handle in &handles {
        let [a, b, c] = face_vertices(&mesh.tets, handle);
        sets.join(a, b);
        sets.join(b, c);
    }
    let mut place: FxHashMap<u32, usize> = FxHashMap::default();
    let mut all: Vec<Vec<u32>> = Vec::new();
    for handle in handles {
        let root = sets.root(face_vertices(&mesh.tets, handle)[0]);
        let i = *place.entry(root).or_insert(all.len());
        if i == all.len() {
            all.push(Vec::new());
        }
        all[i].push(handle);
    }
    all
}

/// Caps of a piece with their faces, by patch id; `None` if a face is neither wall nor of a cap.
fn caps_of(labelled: &[([u32; 3], i32)], caps: &FxHashMap<i32, Cap>) -> Option<Vec<(Cap, Vec<[u32; 3]>)>> {
    let mut of_caps: Vec<(i32, [u32; 3])> =
        labelled.iter().filter(|(_, patch)| *patch != WALL).map(|&(face, patch)| (patch, face)).collect();
    of_caps.sort_by_key(|(patch, _)| *patch);
    let with_cap = |run: &[(i32, [u32; 3])]| Some((*caps.get(&run[0].0)?, run.iter().map(|(_, face)| *face).collect()));
    of_caps.chunk_by(|a, b| a.0 == b.0).map(with_cap).collect()
}

/// Connects the joints with equal faces.
fn join(known: &[Known]) -> Result<Vec<[(u32, u32); 2]>, Unfit> {
    let mut all: Vec<([u64; 2], (u32, u32))> = Vec::new();
    for (part, known) in (0..).zip(known) {
        let key = |joint: &KnownJoint| [joint.sum, joint.faces.len() as u64];
        all.extend((0..).zip(&known.joints).map(|(j, joint)| (key(joint), (part, j))));
    }
    all.sort_unstable();
    let mut joined = Vec::with_capacity(all.len() / 2);
    for run in all.chunk_by(|a, b| a.0 == b.0) {
        // Joints of one piece have no common vertex, so two with equal faces are of different pieces.
        let [(_, a), (_, b)] = *run else { return Err(Unfit::Joint(run[0].1.0)) };
        joined.push([a, b]);
    }
    joined.sort_unstable();
    Ok(joined)
}

impl SplitMesh<'_> {
    /// Number of points of the whole if pieces share only those of joints.
    fn points(&self) -> u64 {
        let all: u64 = self.known.iter().map(|known| u64::from(known.points)).sum();
        let vertices = |(part, joint): (u32, u32)| u64::from(self.known[part as usize].joints[joint as usize].vertices);
        all.saturating_sub(self.joined.iter().map(|pair| vertices(pair[0])).sum())
    }

    fn ids(&self, part: u32) -> io::Result<Vec<u32>> {
        Ok(Ids::of(&self.pieces.tets(part)?.tets).all)
    }
}

impl Parts for SplitMesh<'_> {
    fn count(&self) -> usize {
        self.known.len()
    }

    fn certificate(&self, part: u32) -> io::Result<Certificate> {
        postcard::from_bytes(&self.known[part as usize].certificate).map_err(io::Error::other)
    }

    fn wall(&self, part: u32) -> io::Result<FacesApart> {
        apart(self.pieces, &self.pieces.boundary(part)?.faces)
    }

    fn joined(&self) -> &[[(u32, u32); 2]] {
        &self.joined
    }

    fn joint(&self, part: u32, joint: u32) -> io::Result<FacesApart> {
        let tets = self.pieces.tets(part)?.tets;
        let handles = &self.known[part as usize].joints[joint as usize].faces;
        let faces: Vec<[u32; 3]> = handles.iter().map(|&handle| face_vertices(&tets, handle)).collect();
        apart(self.pieces, &faces)
    }

    fn vertex(&self, part: u32, local: u32) -> u32 {
        // Called for offenders only.
        self.ids(part).ok().and_then(|ids| ids.get(local as usize).copied()).unwrap_or(NONE)
    }

    fn tet(&self, part: u32, local: u32) -> u64 {
        // Called for offenders only, too.
        let before: u64 = self.known[..part as usize].iter().map(|known| u64::from(known.tets)).sum();
        before + u64::from(local)
    }

    fn vertices(&self, part: u32, _: u32) -> io::Result<Vec<u32>> {
        self.ids(part)
    }
}

/// Copies faces with global ids to a point array of their own.
fn apart(pieces: &dyn MeshSource, faces: &[[u32; 3]]) -> io::Result<FacesApart> {
    let vertices = distinct(faces.as_flattened());
    let points = pieces.points_of(&vertices)?;
    let place = |v: u32| vertices.partition_point(|&x| x < v) as u32;
    let faces = faces.iter().map(|face| face.map(place)).collect();
    Ok(FacesApart { points, vertices, faces })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ids_have_their_positions() {
        let ids = Ids::of(&[[9, 3, 4, 5], [6, 1, 20, 21]]);
        let all = [1, 3, 4, 5, 6, 9, 20, 21];
        assert_eq!((&ids.all[..], ids.run.clone()), (&all[..], 1..5));
        for id in 0..23 {
            assert_eq!(ids.local(id), all.binary_search(&id).ok().map(|i| i as u32), "{id}");
        }
        assert_eq!(Ids::of(&[]).local(0), None);
    }
}
