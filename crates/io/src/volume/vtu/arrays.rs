//! Arrays of an unstructured grid and the sources of their values.

use super::names::{
    CELL_IDS, ELEMENT_ID, GHOSTS, GLOBAL_IDS, LAYER, NODE_ID, REGION, VTK_QUADRATIC_TETRA, VTK_QUADRATIC_TRIANGLE,
    VTK_TETRA, VTK_TRIANGLE, field,
};
use crate::volume::content::MeshNotes;
use crate::volume::layers::LayerNumbers;
use crate::volume::second::CellNodes;
use crate::vtk_xml::Blocks;
use anastomesh_mesh::Patch;
use anastomesh_mesh::beside::{Beside, Column};
use anastomesh_mesh::boundary::BoundarySurface;
use anastomesh_mesh::geometry::Point3;
use anastomesh_mesh::source::{MeshSource, SourceCounts};
use std::io;

/// Section of an array in the file.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(in crate::volume) enum ArrayLocation {
    Field,
    PointData,
    Points,
    Cells,
    Polys,
    CellData,
}

/// Name of a value type, and its size in bytes.
pub(in crate::volume) type Kind = (&'static str, usize);

const UINT8: Kind = ("UInt8", 1);
pub(in crate::volume) const INT32: Kind = ("Int32", 4);
const INT64: Kind = ("Int64", 8);
const FLOAT32: Kind = ("Float32", 4);
const FLOAT64: Kind = ("Float64", 8);

/// Writes the values of an array as little-endian bytes.
pub(in crate::volume) type Fill<'a> = Box<dyn Fn(&mut Blocks) -> io::Result<()> + 'a>;

/// Array of the file: name, type and source of its values.
pub(in crate::volume) struct ArrayWriter<'a> {
    pub place: ArrayLocation,
    pub name: &'static str,
    pub kind: &'static str,
    /// Bytes per value.
    pub width: usize,
    pub components: usize,
    pub values: usize,
    pub fill: Fill<'a>,
    /// True if compression is worthwhile: coordinates and vertex numbers compress little.
    pub shrinks: bool,
}

impl<'a> ArrayWriter<'a> {
    pub(in crate::volume) fn new(
        place: ArrayLocation,
        name: &'static str,
        (kind, width): Kind,
        values: usize,
        fill: impl Fn(&mut Blocks) -> io::Result<()> + 'a,
    ) -> Self {
        Self { place, name, kind, width, components: 1, values, fill: Box::new(fill), shrinks: true }
    }
}

/// Points, cells and labels of a mesh. Blocks are also regions if `has_regions`.
pub(super) fn of_mesh<'a>(
    mesh: &'a dyn MeshSource,
    nodes: CellNodes<'a>,
    float32: bool,
    has_regions: bool,
) -> Vec<ArrayWriter<'a>> {
    let mut all = vec![points_array(mesh.counts().points, float32, |each| mesh.each_points(each))];
    all.extend(cell_arrays(mesh, nodes, Width::of(mesh.counts(), nodes)));
    all.extend([patch_array(mesh), block_array("block", mesh)]);
    all.extend(has_regions.then(|| block_array(REGION, mesh)));
    all
}

/// Maximum patch id with a name in the file: the name list has an entry for every smaller number.
pub(super) const LARGEST_NAMED: i32 = 1 << 16;

/// Names by patch id: that of the inside for 0, empty for unused ids.
fn patch_names(patches: &[Patch], inside: &str) -> Vec<String> {
    let largest = patches.iter().map(|p| p.id).filter(|&id| id <= LARGEST_NAMED).max().unwrap_or(0).max(0) as usize;
    let mut names = vec![String::new(); largest + 1];
    names[0] = inside.into();
    for patch in patches {
        if patch.id > 0
            && let Some(name) = names.get_mut(patch.id as usize)
        {
            name.clone_from(&patch.name);
        }
    }
    names
}

/// Field data of a mesh.
pub(super) fn of_fields<'a>(patches: &[Patch], notes: &MeshNotes) -> Vec<ArrayWriter<'a>> {
    let caps: Vec<_> = patches.iter().filter_map(|p| p.cap.map(|cap| (p.id, cap))).collect();
    let inside = if notes.regions.is_empty() { "lumen" } else { "interior" };
    let mut arrays = vec![strings(field::PATCH_NAMES, &patch_names(patches, inside))];
    if !caps.is_empty() {
        let vectors = |f: fn(&anastomesh_mesh::Cap) -> [f64; 3]| caps.iter().flat_map(|(_, cap)| f(cap)).collect();
        arrays.push(ints(field::CAP_PATCH, caps.iter().map(|&(id, _)| i64::from(id)).collect()));
        arrays.push(ints(field::CAP_NODE, caps.iter().map(|(_, cap)| i64::from(cap.node)).collect()));
        arrays.push(floats(field::CAP_CENTER, 3, vectors(|cap| cap.center.coords.into())));
        arrays.push(floats(field::CAP_NORMAL, 3, vectors(|cap| cap.normal.into())));
        arrays.push(floats(field::CAP_RADIUS, 1, caps.iter().map(|(_, cap)| cap.radius).collect()));
    }
    if let Some(expected) = &notes.expectation {
        arrays.push(ints(field::LOOPS, expected.loops.iter().map(|&n| i64::from(n)).collect()));
        arrays.push(ints(field::TERMINALS, expected.terminals.iter().map(|&n| i64::from(n)).collect()));
    }
    if !notes.regions.is_empty() {
        arrays.push(ints(field::REGION_IDS, notes.regions.iter().map(|region| i64::from(region.id)).collect()));
        let names: Vec<String> = notes.regions.iter().map(|region| region.name.clone()).collect();
        arrays.push(strings(field::REGION_NAMES, &names));
    }
    for (name, text) in [(field::GENERATOR, &notes.generator), (field::OPTIONS, &notes.options)] {
        if !text.is_empty() {
            arrays.push(strings(name, std::slice::from_ref(text)));
        }
    }
    // Empty arrays are legal in VTK but break other readers.
    arrays.retain(|array| array.values > 0);
    arrays
}

/// Texts as bytes with terminating zeros, like VTK's string arrays. Real string arrays make some readers (meshio)
/// reject the file, bytes do not.
fn strings<'a>(name: &'static str, texts: &[String]) -> ArrayWriter<'a> {
    let mut bytes = Vec::new();
    for text in texts {
        bytes.extend(text.bytes().filter(|&b| b != 0));
        bytes.push(0);
    }
    ArrayWriter::new(ArrayLocation::Field, name, UINT8, bytes.len(), move |out| out.push(bytes.len(), |i| [bytes[i]]))
}

fn ints<'a>(name: &'static str, values: Vec<i64>) -> ArrayWriter<'a> {
    let count = values.len();
    ArrayWriter::new(ArrayLocation::Field, name, INT64, count, move |out| out.push(count, |i| values[i].to_le_bytes()))
}

fn floats<'a>(name: &'static str, components: usize, values: Vec<f64>) -> ArrayWriter<'a> {
    let count = values.len();
    let fill = move |out: &mut Blocks| out.push(count, |i| values[i].to_le_bytes());
    ArrayWriter { components, ..ArrayWriter::new(ArrayLocation::Field, name, FLOAT64, count, fill) }
}

/// Number in the whole mesh of each point of a piece.
pub(super) fn of_ids(ids: &[u32]) -> ArrayWriter<'_> {
    let fill = |out: &mut Blocks| out.push(ids.len(), |i| u64::from(ids[i]).to_le_bytes());
    ArrayWriter::new(ArrayLocation::PointData, GLOBAL_IDS, INT64, ids.len(), fill)
}

/// Numbers from 1 of points and cells in the whole mesh, given from 0.
pub(super) fn of_solver<'a>(points: &'a [u32], cells: [&'a [u32]; 2]) -> [ArrayWriter<'a>; 2] {
    let from_one = |place, name, lists: Vec<&'a [u32]>| {
        let count = lists.iter().map(|list| list.len()).sum();
        ArrayWriter::new(place, name, INT32, count, move |out| {
            lists.iter().try_for_each(|list| out.push(list.len(), |i| (list[i] + 1).to_le_bytes()))
        })
    };
    [
        from_one(ArrayLocation::PointData, NODE_ID, vec![points]),
        from_one(ArrayLocation::CellData, ELEMENT_ID, cells.to_vec()),
    ]
}

/// Arrays of a piece with ghost cells.
#[derive(Clone, Copy)]
pub(in crate::volume) struct PieceArrays<'a> {
    /// Mark of each point, and of each tetrahedron: 1 for copies. Boundary faces are no copies.
    pub point_ghosts: &'a [u8],
    pub tet_ghosts: &'a [u8],
    /// Numbers in the whole mesh of tetrahedra, and of boundary faces.
    pub tets: &'a [u32],
    pub faces: &'a [u32],
    /// Number of tetrahedra of the whole mesh.
    pub all_tets: usize,
}

/// Marks of ghosts, and numbers of cells in the whole mesh. `faces` boundary faces are in the file: all, or none.
pub(super) fn of_piece(piece: PieceArrays<'_>, faces: usize) -> [ArrayWriter<'_>; 3] {
    let PieceArrays { point_ghosts, tet_ghosts, tets, faces: face_ids, all_tets } = piece;
    let cells = tets.len() + faces;
    let ids = move |out: &mut Blocks| {
        out.push(tets.len(), |i| u64::from(tets[i]).to_le_bytes())?;
        out.push(faces, |i| (all_tets as u64 + u64::from(face_ids[i])).to_le_bytes())
    };
    let marks = move |out: &mut Blocks| {
        out.push(tet_ghosts.len(), |i| [tet_ghosts[i]])?;
        out.push(faces, |_| [0])
    };
    let of_points = move |out: &mut Blocks| out.push(point_ghosts.len(), |i| [point_ghosts[i]]);
    [
        ArrayWriter::new(ArrayLocation::PointData, GHOSTS, UINT8, point_ghosts.len(), of_points),
        ArrayWriter::new(ArrayLocation::CellData, CELL_IDS, INT64, cells, ids),
        ArrayWriter::new(ArrayLocation::CellData, GHOSTS, UINT8, cells, marks),
    ]
}

/// Callback for points in batches.
type EachPoints<'a> = dyn FnMut(&[Point3]) -> io::Result<()> + 'a;

/// Coordinates array; `pass` provides all points.
pub(in crate::volume) fn points_array<'a>(
    count: usize,
    float32: bool,
    pass: impl Fn(&mut EachPoints) -> io::Result<()> + 'a,
) -> ArrayWriter<'a> {
    let kind = if float32 { FLOAT32 } else { FLOAT64 };
    let fill = move |out: &mut Blocks| {
        pass(&mut |points| {
            if float32 {
                out.push(points.len(), |i| point_bytes::<4, 12>(&points[i], |x| (x as f32).to_le_bytes()))
            } else {
                out.push(points.len(), |i| point_bytes::<8, 24>(&points[i], f64::to_le_bytes))
            }
        })
    };
    let array = ArrayWriter::new(ArrayLocation::Points, "Points", kind, 3 * count, fill);
    ArrayWriter { components: 3, shrinks: false, ..array }
}

fn point_bytes<const W: usize, const N: usize>(p: &Point3, word: impl Fn(f64) -> [u8; W]) -> [u8; N] {
    let mut bytes = [0; N];
    let (words, _) = bytes.as_chunks_mut::<W>();
    for (place, x) in words.iter_mut().zip([p.x, p.y, p.z]) {
        *place = word(x);
    }
    bytes
}

/// Integer width of vertex numbers and offsets.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(in crate::volume) enum Width {
    Int32,
    Int64,
}

impl Width {
    /// Ids are u32: within the signed range they fit into 32 bits, otherwise 64 bits are needed.
    pub(in crate::volume) fn of(counts: SourceCounts, nodes: CellNodes) -> Self {
        let fits = |count: usize| i32::try_from(count).is_ok();
        let narrow = fits(nodes.per_tet() * counts.tets + nodes.per_face() * counts.boundary) && fits(counts.points);
        if narrow { Self::Int32 } else { Self::Int64 }
    }

    fn kind(self) -> Kind {
        if self == Self::Int32 { INT32 } else { INT64 }
    }

    fn push(self, out: &mut Blocks, count: usize, value: impl Fn(usize) -> u64 + Sync) -> io::Result<()> {
        match self {
            Self::Int32 => out.push(count, |i| (value(i) as u32).to_le_bytes()),
            Self::Int64 => out.push(count, |i| value(i).to_le_bytes()),
        }
    }
}

/// Nodes, offsets and types of tetrahedra and boundary faces.
pub(in crate::volume) fn cell_arrays<'a>(
    mesh: &'a dyn MeshSource,
    nodes: CellNodes<'a>,
    width: Width,
) -> [ArrayWriter<'a>; 3] {
    let SourceCounts { tets, boundary, .. } = mesh.counts();
    let [per_tet, per_face] = [nodes.per_tet(), nodes.per_face()];
    let corners = move |out: &mut Blocks| {
        let mut push = |ids: &[u32]| width.push(out, ids.len(), |i| u64::from(ids[i]));
        mesh.each_tets(|piece| push(&nodes.of_tets(&piece.tets)))?;
        mesh.each_faces(|piece| push(&nodes.of_faces(&piece.faces)))
    };
    let offsets = move |out: &mut Blocks| {
        width.push(out, tets, |tet| (per_tet * (tet + 1)) as u64)?;
        width.push(out, boundary, |face| (per_tet * tets + per_face * (face + 1)) as u64)
    };
    let [tet_type, face_type] =
        if nodes.0.is_some() { [VTK_QUADRATIC_TETRA, VTK_QUADRATIC_TRIANGLE] } else { [VTK_TETRA, VTK_TRIANGLE] };
    let types = move |out: &mut Blocks| {
        out.push(tets, |_| [tet_type])?;
        out.push(boundary, |_| [face_type])
    };
    let values = per_tet * tets + per_face * boundary;
    let corners = ArrayWriter::new(ArrayLocation::Cells, "connectivity", width.kind(), values, corners);
    [
        // Half of a wide number is zeros.
        ArrayWriter { shrinks: width == Width::Int64, ..corners },
        ArrayWriter::new(ArrayLocation::Cells, "offsets", width.kind(), tets + boundary, offsets),
        ArrayWriter::new(ArrayLocation::Cells, "types", UINT8, tets + boundary, types),
    ]
}

/// Types of cells.
pub(super) fn types_array<'a>(types: Vec<u8>) -> ArrayWriter<'a> {
    ArrayWriter::new(ArrayLocation::Cells, "types", UINT8, types.len(), move |out| {
        out.push(types.len(), |i| [types[i]])
    })
}

/// Points, triangles and labels of a boundary. Blocks are also regions if `has_regions`.
pub(super) fn of_surface<'a>(surface: &'a BoundarySurface, float32: bool, has_regions: bool) -> Vec<ArrayWriter<'a>> {
    let counts = surface.counts();
    let (width, faces) = (Width::of(counts, CellNodes::default()), counts.boundary);
    let corners = move |out: &mut Blocks| {
        surface.each_faces(|piece| {
            let ids = piece.faces.as_flattened();
            width.push(out, ids.len(), |i| u64::from(ids[i]))
        })
    };
    let offsets = move |out: &mut Blocks| width.push(out, faces, |face| 3 * (face as u64 + 1));
    let patch = move |out: &mut Blocks| surface.each_faces(|piece| out.push_ints(&piece.patches));
    let block = |name| {
        let fill = move |out: &mut Blocks| surface.each_faces(|piece| out.push_ints(&piece.blocks));
        ArrayWriter::new(ArrayLocation::CellData, name, INT32, faces, fill)
    };
    let corners = ArrayWriter::new(ArrayLocation::Polys, "connectivity", width.kind(), 3 * faces, corners);
    let mut all = vec![
        points_array(counts.points, float32, |each| surface.each_points(each)),
        ArrayWriter { shrinks: width == Width::Int64, ..corners },
        ArrayWriter::new(ArrayLocation::Polys, "offsets", width.kind(), faces, offsets),
        ArrayWriter::new(ArrayLocation::CellData, "patch", INT32, faces, patch),
        block("block"),
    ];
    all.extend(has_regions.then(|| block(REGION)));
    all
}

/// Additional values at points and in cells. Cell values derive from the corners.
pub(super) fn of_values<'a>(mesh: &'a dyn MeshSource, values: &'a dyn Beside) -> Vec<ArrayWriter<'a>> {
    let SourceCounts { points, tets, boundary } = mesh.counts();
    let array = |(column, named): (usize, &Column)| {
        let Column { name, at_points, is_integer } = *named;
        let kind = if is_integer { INT32 } else { FLOAT64 };
        let push = move |out: &mut Blocks, found: Vec<f64>| {
            if is_integer {
                out.push(found.len(), |i| (found[i] as i32).to_le_bytes())
            } else {
                out.push(found.len(), |i| found[i].to_le_bytes())
            }
        };
        if at_points {
            return ArrayWriter::new(ArrayLocation::PointData, name, kind, points, move |out| {
                mesh.each_points(|some| push(out, values.at_points(column, some)))
            });
        }
        ArrayWriter::new(ArrayLocation::CellData, name, kind, tets + boundary, move |out| {
            mesh.each_tet_corners(|some| push(out, values.in_tets(column, some)))?;
            mesh.each_face_corners(|some| push(out, values.in_faces(column, some)))
        })
    };
    values.columns().iter().enumerate().map(array).collect()
}

/// Patches of the boundary faces; tetrahedra have 0.
fn patch_array(mesh: &dyn MeshSource) -> ArrayWriter<'_> {
    let SourceCounts { tets, boundary, .. } = mesh.counts();
    ArrayWriter::new(ArrayLocation::CellData, "patch", INT32, tets + boundary, move |out| {
        out.push(tets, |_| [0; 4])?;
        mesh.each_face_labels(|piece| push_known(out, &piece.patches, piece.count))
    })
}

/// Layer of each cell; boundary faces have 0.
pub(super) fn layer_array(layers: LayerNumbers<'_>, counts: SourceCounts) -> ArrayWriter<'_> {
    let SourceCounts { tets, boundary, .. } = counts;
    ArrayWriter::new(ArrayLocation::CellData, LAYER, INT32, tets + boundary, move |out| {
        layers.each(|some| out.push_ints(some))?;
        out.push(boundary, |_| [0; 4])
    })
}

fn block_array<'a>(name: &'static str, mesh: &'a dyn MeshSource) -> ArrayWriter<'a> {
    let SourceCounts { tets, boundary, .. } = mesh.counts();
    ArrayWriter::new(ArrayLocation::CellData, name, INT32, tets + boundary, |out| {
        mesh.each_tet_labels(|piece| push_known(out, &piece.blocks, piece.count))?;
        mesh.each_face_labels(|piece| push_known(out, &piece.blocks, piece.count))
    })
}

/// Appends `count` values, 0 where unknown.
fn push_known(out: &mut Blocks, values: &[i32], count: usize) -> io::Result<()> {
    let known = values.len().min(count);
    out.push_ints(&values[..known])?;
    out.push(count - known, |_| [0; 4])
}
