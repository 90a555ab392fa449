//! Files of a folder `mesh-complete`: tetrahedra, exterior, walls and surfaces.

use super::layout::{EXTERIOR, MESH, WALLS};
use super::sheet::{Chosen, Sheet, WideSheet, corners, used};
use super::spool::Spool;
use crate::file::{Asked, AtomicFile, AtomicFolder};
use crate::volume::second::CellNodes;
use crate::volume::vtu::arrays::{ArrayLocation, ArrayWriter, INT32, Width, cell_arrays, points_array};
use crate::volume::vtu::{ELEMENT_ID, NODE_ID, Recounted, file::File};
use crate::vtk_xml::Blocks;
use anastomesh_mesh::faces::OuterFace;
use anastomesh_mesh::progress::Progress;
use anastomesh_mesh::source::MeshSource;
use std::collections::BTreeMap;
use std::io::{self, Seek, Write};

/// Numbers of points and tetrahedra in files; a mesh of its own has those of its order.
#[derive(Clone, Copy)]
pub(super) struct Numbers<'a> {
    pub(super) points: Option<&'a [u32]>,
    pub(super) tets: Option<&'a [u32]>,
    pub(super) region: i32,
}

impl Default for Numbers<'_> {
    fn default() -> Self {
        Self { points: None, tets: None, region: 1 }
    }
}

impl Numbers<'_> {
    /// Number of a point, from 1.
    fn node(&self, v: u32) -> u32 {
        1 + self.points.map_or(v, |points| points[v as usize])
    }

    /// Number of a tetrahedron, from 1.
    fn element(&self, tet: u32) -> u32 {
        1 + self.tets.map_or(tet, |tets| tets[tet as usize])
    }
}

/// Writer of a mesh with its exterior and its walls.
pub(super) struct MeshComplete<'a> {
    pub(super) folder: &'a AtomicFolder,
    /// Beginning of the names of its files.
    pub(super) prefix: &'a str,
    /// Mesh, with midpoints after its points.
    pub(super) mesh: &'a dyn MeshSource,
    pub(super) nodes: CellNodes<'a>,
    pub(super) spool: &'a Spool,
    pub(super) numbers: Numbers<'a>,
    pub(super) progress: &'a dyn Progress,
}

impl MeshComplete<'_> {
    pub(super) fn write(&self, is_wall: Chosen) -> io::Result<()> {
        self.put(MESH, &|out| write_tets(out, self.mesh, self.nodes, &self.numbers))?;
        self.put_wide(EXTERIOR, &|_| true)?;
        self.put_wide(WALLS, is_wall)
    }

    /// Writes a file of the folder.
    fn put(&self, name: &str, write: &dyn Fn(&mut SheetOutput) -> io::Result<()>) -> io::Result<()> {
        let mut file = self.folder.file(&format!("{}{name}", self.prefix))?;
        write(&mut Asked { out: &mut file, progress: self.progress })?;
        file.commit()
    }

    /// Writes a file with the selected faces.
    fn put_wide(&self, name: &str, has: Chosen) -> io::Result<()> {
        let Self { mesh, nodes, spool, .. } = *self;
        let (used, faces) = used(mesh.counts().points, nodes, spool, has)?;
        let sheet = WideSheet { mesh, nodes, spool, has, used: &used, ranks: used.ranks(), faces };
        self.put(name, &|out| write_sheet(out, &sheet, &self.numbers))
    }
}

type SheetOutput<'a> = Asked<'a, &'a mut AtomicFile>;

/// Faces of the selected patches.
pub(super) fn caps(spool: &Spool, has: impl Fn(i32) -> bool) -> io::Result<BTreeMap<i32, Vec<OuterFace>>> {
    let mut caps: BTreeMap<i32, Vec<OuterFace>> = BTreeMap::new();
    spool.each(|faces| {
        for &face in faces.iter().filter(|face| has(face.patch)) {
            caps.entry(face.patch).or_default().push(face);
        }
        Ok(())
    })?;
    Ok(caps)
}

/// Checks that all counts fit into 32 bits, as the readers require.
pub(super) fn ensure_countable(mesh: &dyn MeshSource, nodes: CellNodes) -> io::Result<()> {
    let counts = mesh.counts();
    if Width::of(counts, nodes) == Width::Int32 {
        return Ok(());
    }
    let text = format!(
        "{} tetrahedra are more than SimVascular's numbers of 32 bits allow; mesh parts, or use a smaller rho",
        counts.tets
    );
    Err(io::Error::new(io::ErrorKind::InvalidInput, text))
}

/// Writes tetrahedra only, as the solver accepts no other cells.
fn write_tets(
    out: &mut (impl Write + Seek),
    mesh: &dyn MeshSource,
    nodes: CellNodes,
    numbers: &Numbers,
) -> io::Result<()> {
    let mesh: &dyn MeshSource = &Recounted::without_boundary(mesh);
    let counts = mesh.counts();
    let (points, tets) = (counts.points, counts.tets);
    let mut arrays = vec![points_array(points, false, |each| mesh.each_points(each))];
    arrays.extend(cell_arrays(mesh, nodes, Width::Int32));
    let (node, element, region) = (|v| numbers.node(v), |tet| numbers.element(tet), |_| numbers.region.cast_unsigned());
    arrays.push(uncompressed(ints(ArrayLocation::PointData, NODE_ID, points, &node)));
    arrays.push(uncompressed(ints(ArrayLocation::CellData, ELEMENT_ID, tets, &element)));
    arrays.push(ints(ArrayLocation::CellData, "ModelRegionID", tets, &region));
    let counts = format!("NumberOfPoints=\"{points}\" NumberOfCells=\"{tets}\"");
    File { kind: "UnstructuredGrid", counts, arrays, raw: false }.write(out)
}

/// Array that is stored as it is. Compression of different numbers saves little space for its time.
fn uncompressed(array: ArrayWriter) -> ArrayWriter {
    ArrayWriter { shrinks: false, ..array }
}

/// Array of numbers.
fn ints<'a>(
    place: ArrayLocation,
    name: &'static str,
    count: usize,
    number: &'a (dyn Fn(u32) -> u32 + Sync),
) -> ArrayWriter<'a> {
    ArrayWriter::new(place, name, INT32, count, move |out| out.push(count, |i| number(i as u32).to_le_bytes()))
}

/// Array of a number for each face.
fn labels<'a>(sheet: &'a dyn Sheet, name: &'static str, of: &'a (dyn Fn(&OuterFace) -> u32 + Sync)) -> ArrayWriter<'a> {
    ArrayWriter::new(ArrayLocation::CellData, name, INT32, sheet.counts().1, move |out| {
        sheet.each_faces(&mut |some| out.push(some.len(), |i| of(&some[i]).to_le_bytes()))
    })
}

/// Writes a surface with the mesh numbers of its points and adjacent tetrahedra.
pub(super) fn write_sheet(out: &mut (impl Write + Seek), sheet: &dyn Sheet, numbers: &Numbers) -> io::Result<()> {
    let (points, faces) = sheet.counts();
    let (nodes, per_face) = (sheet.nodes(), sheet.nodes().per_face());
    let connectivity = ArrayWriter::new(ArrayLocation::Polys, "connectivity", INT32, per_face * faces, |out| {
        sheet.each_faces(&mut |some| {
            let corners = corners(some);
            let all = nodes.of_faces(&corners);
            out.push(all.len(), |i| sheet.own_number(all[i]).to_le_bytes())
        })
    });
    let offsets = move |out: &mut Blocks| out.push(faces, |face| ((per_face * (face + 1)) as u32).to_le_bytes());
    let ids = ArrayWriter::new(ArrayLocation::PointData, NODE_ID, INT32, points, |out| {
        sheet.each_ids(&mut |ids| out.push(ids.len(), |i| numbers.node(ids[i]).to_le_bytes()))
    });
    let element = |face: &OuterFace| numbers.element(face.tet);
    let region = |_: &OuterFace| numbers.region.cast_unsigned();
    let patch = |face: &OuterFace| face.patch.cast_unsigned();
    let arrays = vec![
        uncompressed(ids),
        points_array(points, false, |mut each| sheet.each_points(&mut each)),
        uncompressed(connectivity),
        uncompressed(ArrayWriter::new(ArrayLocation::Polys, "offsets", INT32, faces, offsets)),
        uncompressed(labels(sheet, ELEMENT_ID, &element)),
        labels(sheet, "ModelRegionID", &region),
        labels(sheet, "ModelFaceID", &patch),
    ];
    let counts = format!("NumberOfPoints=\"{points}\" NumberOfPolys=\"{faces}\"");
    File { kind: "PolyData", counts, arrays, raw: false }.write(out)
}
