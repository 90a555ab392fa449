//! Writer of `TetGen` file families: separate files for points, tetrahedra, faces, edges and neighbours.

use super::error::TetgenFileError;
use crate::file::{OutputSet, Writing, ensure_sound, extension, stage_all};
use anastomesh_mesh::adjacency::{Incidence, NONE, tet_adjacency};
use anastomesh_mesh::progress::Progress;
use anastomesh_mesh::{TET_FACES, TetMesh, VolumeMesh};
use rustc_hash::FxHashMap;
use std::borrow::Cow;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// Selection of faces or edges to write.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Extent {
    /// None: the file is not written.
    Nothing,
    /// Boundary only.
    #[default]
    Boundary,
    /// All; inner ones have marker 0.
    All,
}

/// File family of a mesh with positive tetrahedra: `.node`, `.ele`, and optional `.face`, `.edge`, `.neigh`.
///
/// ```
/// use anastomesh_io::tetgen::{Extent, MeshFamily};
/// use anastomesh_mesh::{Point3, TetMesh};
///
/// let points = vec![Point3::origin(), Point3::new(1., 0., 0.), Point3::new(0., 1., 0.), Point3::new(0., 0., 1.)];
/// let mesh = TetMesh { points, tets: vec![[0, 1, 2, 3]] };
/// let folder = tempfile::tempdir()?;
/// let written = MeshFamily::new(&mesh).first_number(1).edges(Extent::All).write(&folder.path().join("one.ele"))?;
/// assert_eq!(std::fs::read_to_string(written.last().unwrap())?, "1 4 0\n1 1 2 3 4\n");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone)]
pub struct MeshFamily<'a> {
    mesh: &'a TetMesh,
    boundary: Option<(&'a [[u32; 3]], &'a [i32])>,
    point_markers: Option<&'a [i32]>,
    point_attributes: (&'a [f64], usize),
    segments: &'a [[u32; 2]],
    regions: Option<&'a [i32]>,
    /// Attributes of regions by id, ascending; others have their id.
    region_attributes: &'a [(i32, f64)],
    faces: Extent,
    edges: Extent,
    neighbors: bool,
    first: u32,
    progress: &'a dyn Progress,
}

impl<'a> MeshFamily<'a> {
    /// Possible paths of a mesh's files, which [`Self::write`] may replace.
    pub fn paths(base: &Path) -> [PathBuf; 5] {
        ["node", "face", "edge", "neigh", "ele"].map(|kind| member(base, kind))
    }

    /// All five files of a mesh, numbered from 0. The boundary is computed and has marker 1.
    pub fn new(mesh: &'a TetMesh) -> Self {
        Self {
            mesh,
            boundary: None,
            point_markers: None,
            point_attributes: (&[], 0),
            segments: &[],
            regions: None,
            region_attributes: &[],
            faces: Extent::Boundary,
            edges: Extent::Boundary,
            neighbors: true,
            first: 0,
            progress: &(),
        }
    }

    /// All five files of a labelled mesh: patches become markers, blocks become attributes of tetrahedra.
    pub fn of_volume(volume: &'a VolumeMesh) -> Self {
        Self::new(&volume.mesh).boundary(&volume.boundary, &volume.boundary_patch).regions(&volume.tet_block)
    }

    /// Sets the boundary faces and their markers (0 if missing). Faces keep their orientation, usually outwards
    /// (`TetGen` itself writes them inwards).
    #[must_use]
    pub fn boundary(mut self, faces: &'a [[u32; 3]], markers: &'a [i32]) -> Self {
        self.boundary = Some((faces, markers));
        self
    }

    /// Sets the markers of the points (0 if missing). The default is the marker of the first boundary face at the
    /// point, and 0 inside.
    #[must_use]
    pub fn point_markers(mut self, markers: &'a [i32]) -> Self {
        self.point_markers = Some(markers);
        self
    }

    /// Adds edges with marker −1, as `TetGen` does for segments, whether or not faces contain them.
    #[must_use]
    pub fn segments(mut self, segments: &'a [[u32; 2]]) -> Self {
        self.segments = segments;
        self
    }

    /// Sets the attributes of the tetrahedra (0 if missing).
    #[must_use]
    pub fn regions(mut self, regions: &'a [i32]) -> Self {
        self.regions = Some(regions);
        self
    }

    /// Attributes of regions that are not their ids, by id, ascending.
    #[must_use]
    pub fn region_attributes(mut self, attributes: &'a [(i32, f64)]) -> Self {
        self.region_attributes = attributes;
        self
    }

    /// Selects the faces to write.
    #[must_use]
    pub fn faces(mut self, extent: Extent) -> Self {
        self.faces = extent;
        self
    }

    /// Selects the edges to write.
    #[must_use]
    pub fn edges(mut self, extent: Extent) -> Self {
        self.edges = extent;
        self
    }

    /// Enables or disables the neighbour file.
    #[must_use]
    pub fn neighbors(mut self, written: bool) -> Self {
        self.neighbors = written;
        self
    }

    /// Sets the number of the first item in each file: 0 or 1.
    #[must_use]
    pub fn first_number(mut self, first: u32) -> Self {
        self.first = first.min(1);
        self
    }

    /// Sets the point attributes, `each` values per point; missing ones are 0.
    #[must_use]
    pub fn point_attributes(mut self, attributes: &'a [f64], each: usize) -> Self {
        self.point_attributes = (attributes, each);
        self
    }

    /// Sets the cancellation source.
    #[must_use]
    pub fn progress(mut self, progress: &'a dyn Progress) -> Self {
        self.progress = progress;
        self
    }

    /// Writes the files `base.node` and so on, together; `base` may have any of their extensions. `.ele` appears last.
    /// Returns their paths in this order.
    ///
    /// # Errors
    /// `BadMesh` if a cell refers to a missing point, or `Write` with the reason.
    pub fn write(&self, base: &Path) -> Result<Vec<PathBuf>, TetgenFileError> {
        let (paths, outputs) = self.stage(base)?;
        outputs.place()?;
        Ok(paths)
    }

    /// Writes the files like [`MeshFamily::write`] under temporary names. [`OutputSet::place`] moves them to their paths.
    ///
    /// # Errors
    /// See [`MeshFamily::write`].
    pub fn stage(&self, base: &Path) -> Result<(Vec<PathBuf>, OutputSet), TetgenFileError> {
        let points = self.mesh.points.len();
        ensure_sound(base, &self.mesh.tets, points)?;
        ensure_sound(base, self.boundary.map_or(&[], |(faces, _)| faces), points)?;
        ensure_sound(base, self.segments, points)?;
        let (faces, markers) = self.listed();
        let boundary = MarkedFaces { faces: &faces, markers: &markers };
        let nodes = |out: &mut dyn Write| self.write_nodes(out, boundary);
        let face_list = |out: &mut dyn Write| self.write_faces(out, boundary);
        let edges = |out: &mut dyn Write| self.write_edges(out, boundary);
        let neighbors = |out: &mut dyn Write| self.write_neighbors(out);
        let tets = |out: &mut dyn Write| self.write_tets(out);
        let mut files: Vec<Writing> = vec![(member(base, "node"), &nodes)];
        if self.faces != Extent::Nothing {
            files.push((member(base, "face"), &face_list));
        }
        if self.edges != Extent::Nothing {
            files.push((member(base, "edge"), &edges));
        }
        if self.neighbors {
            files.push((member(base, "neigh"), &neighbors));
        }
        files.push((member(base, "ele"), &tets));
        let outputs = stage_all(&files, self.progress)?;
        Ok((files.into_iter().map(|(path, _)| path).collect(), outputs))
    }

    /// Given boundary, or all faces with one adjacent tetrahedron, with marker 1.
    fn listed(&self) -> (Cow<'a, [[u32; 3]]>, Cow<'a, [i32]>) {
        if let Some((faces, markers)) = self.boundary {
            return (faces.into(), markers.into());
        }
        let faces: Vec<[u32; 3]> = self.mesh_faces(|neighbor, _| neighbor == NONE).collect();
        let markers = vec![1; faces.len()];
        (faces.into(), markers.into())
    }

    /// Faces of the mesh selected by `wanted` (neighbour's handle, own handle), oriented outwards.
    fn mesh_faces(&self, wanted: impl Fn(u32, u32) -> bool) -> impl Iterator<Item = [u32; 3]> {
        let TetMesh { points, tets } = self.mesh;
        let neighbors = tet_adjacency(tets, points.len()).neighbors;
        (0..4 * tets.len() as u32).filter_map(move |handle| {
            let (tet, side) = ((handle / 4) as usize, (handle % 4) as usize);
            wanted(neighbors[tet][side], handle).then(|| TET_FACES[side].map(|corner| tets[tet][corner]))
        })
    }

    fn write_nodes(&self, out: &mut dyn Write, boundary: MarkedFaces) -> io::Result<()> {
        let points = &self.mesh.points;
        let markers: Cow<[i32]> = match self.point_markers {
            Some(markers) => markers.into(),
            None => boundary.point_markers(points.len()).into(),
        };
        let (attributes, each) = self.point_attributes;
        writeln!(out, "{} 3 {each} 1", points.len())?;
        for (i, p) in points.iter().enumerate() {
            let marker = markers.get(i).unwrap_or(&0);
            write!(out, "{} {:?} {:?} {:?}", self.number(i as u32), p.x, p.y, p.z)?;
            for k in 0..each {
                write!(out, " {:?}", attributes.get(i * each + k).unwrap_or(&0.0))?;
            }
            writeln!(out, " {marker}")?;
        }
        Ok(())
    }

    fn write_tets(&self, out: &mut dyn Write) -> io::Result<()> {
        writeln!(out, "{} 4 {}", self.mesh.tets.len(), u8::from(self.regions.is_some()))?;
        for (i, tet) in self.mesh.tets.iter().enumerate() {
            let [a, b, c, d] = tet.map(|v| self.number(v));
            write!(out, "{} {a} {b} {c} {d}", self.number(i as u32))?;
            match self.regions {
                Some(regions) => {
                    let id = regions.get(i).copied().unwrap_or(0);
                    match self.region_attributes.binary_search_by_key(&id, |region| region.0) {
                        Ok(at) => writeln!(out, " {:?}", self.region_attributes[at].1)?,
                        Err(_) => writeln!(out, " {id}")?,
                    }
                }
                None => writeln!(out)?,
            }
        }
        Ok(())
    }

    fn write_faces(&self, out: &mut dyn Write, boundary: MarkedFaces) -> io::Result<()> {
        if self.faces == Extent::Boundary {
            return self.write_face_list(out, boundary.faces, |i, _| boundary.marker(i));
        }
        let mut marker_of: FxHashMap<[u32; 3], i32> = FxHashMap::default();
        for (i, &face) in boundary.faces.iter().enumerate() {
            marker_of.entry(sorted(face)).or_insert(boundary.marker(i));
        }
        // `NONE` exceeds every handle, so each pair of sides counts once.
        let faces: Vec<[u32; 3]> = self.mesh_faces(|neighbor, handle| neighbor > handle).collect();
        self.write_face_list(out, &faces, |_, face| marker_of.get(&sorted(face)).copied().unwrap_or(0))
    }

    fn write_face_list(
        &self,
        out: &mut dyn Write,
        faces: &[[u32; 3]],
        marker: impl Fn(usize, [u32; 3]) -> i32,
    ) -> io::Result<()> {
        writeln!(out, "{} 1", faces.len())?;
        for (i, &face) in faces.iter().enumerate() {
            let [a, b, c] = face.map(|v| self.number(v));
            writeln!(out, "{} {a} {b} {c} {}", self.number(i as u32), marker(i, face))?;
        }
        Ok(())
    }

    fn write_edges(&self, out: &mut dyn Write, boundary: MarkedFaces) -> io::Result<()> {
        let mut edges = boundary.edges(self.segments);
        if self.edges == Extent::All {
            edges = with_inner_edges(self.mesh, &edges);
        }
        writeln!(out, "{} 1", edges.len())?;
        for (i, &(a, b, marker)) in edges.iter().enumerate() {
            writeln!(out, "{} {} {} {marker}", self.number(i as u32), self.number(a), self.number(b))?;
        }
        Ok(())
    }

    /// Writes the neighbours: neighbour `i` is opposite corner `i`; −1 is outside.
    fn write_neighbors(&self, out: &mut dyn Write) -> io::Result<()> {
        let neighbors = tet_adjacency(&self.mesh.tets, self.mesh.points.len()).neighbors;
        writeln!(out, "{} 4", neighbors.len())?;
        for (i, row) in neighbors.iter().enumerate() {
            let number = |handle: u32| if handle == NONE { -1 } else { self.number(handle / 4) as i64 };
            let [a, b, c, d] = row.map(number);
            writeln!(out, "{} {a} {b} {c} {d}", self.number(i as u32))?;
        }
        Ok(())
    }

    fn number(&self, index: u32) -> u64 {
        u64::from(index) + u64::from(self.first)
    }
}

/// Faces with markers.
#[derive(Clone, Copy)]
struct MarkedFaces<'a> {
    faces: &'a [[u32; 3]],
    markers: &'a [i32],
}

impl MarkedFaces<'_> {
    fn marker(&self, face: usize) -> i32 {
        self.markers.get(face).copied().unwrap_or(0)
    }

    fn point_markers(&self, points: usize) -> Vec<i32> {
        let mut markers = vec![0; points];
        // Backwards, so that the first face has priority.
        for (i, face) in self.faces.iter().enumerate().rev() {
            for &v in face {
                markers[v as usize] = self.marker(i);
            }
        }
        markers
    }

    /// Edges `(a, b, marker)` with `a < b` in ascending order, marked by the first face with the edge.
    fn edges(&self, segments: &[[u32; 2]]) -> Vec<(u32, u32, i32)> {
        let mut edges: Vec<(u32, u32, i32)> = Vec::with_capacity(3 * self.faces.len() + segments.len());
        for (i, &[a, b, c]) in self.faces.iter().enumerate() {
            let marker = self.marker(i);
            edges.extend([(a, b), (b, c), (c, a)].map(|(a, b)| (a.min(b), a.max(b), marker)));
        }
        edges.extend(segments.iter().map(|&[a, b]| (a.min(b), a.max(b), -1)));
        // Stable sort: the first face stays first.
        edges.sort_by_key(|&(a, b, _)| (a, b));
        edges.dedup_by_key(|&mut (a, b, _)| (a, b));
        edges
    }
}

/// All edges of a mesh in ascending order, with their markers if they have one.
fn with_inner_edges(mesh: &TetMesh, marked: &[(u32, u32, i32)]) -> Vec<(u32, u32, i32)> {
    let around = Incidence::of_vertices(&mesh.tets, mesh.points.len());
    let mut marked = marked.iter().peekable();
    let mut edges = Vec::new();
    for a in 0..mesh.points.len() as u32 {
        for &b in around.get(a).iter().filter(|&&b| b > a) {
            while marked.next_if(|&&(c, d, _)| (c, d) < (a, b)).is_some() {}
            let marker = marked.next_if(|&&(c, d, _)| (c, d) == (a, b)).map_or(0, |&(.., marker)| marker);
            edges.push((a, b, marker));
        }
    }
    edges
}

/// Sorted corners of a face, equal for both of its sides.
pub(super) fn sorted(mut face: [u32; 3]) -> [u32; 3] {
    face.sort_unstable();
    face
}

/// Path of one file of the family.
pub(super) fn member(base: &Path, kind: &str) -> PathBuf {
    if matches!(extension(base).as_str(), "node" | "ele" | "face" | "edge" | "neigh") {
        return base.with_extension(kind);
    }
    // An apparent extension may be part of the name, as in `mesh.1`.
    let mut name = base.as_os_str().to_os_string();
    name.push(".");
    name.push(kind);
    name.into()
}
