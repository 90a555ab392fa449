//! Writer of meshes.

use super::names::{ARRAYS, NOTES, POINTS, TET_BLOCKS, TET_LAYER, TETS, TRIANGLE_BLOCKS, TRIANGLE_PATCHES, TRIANGLES};
use super::notes::Notes;
use crate::file::{Asked, AtomicFolder, OutputSet};
use crate::npy::{Item, head};
use crate::volume::content::MeshNotes;
use crate::volume::layers::LayerNumbers;
use crate::volume::options::WriteOptions;
use crate::volume::second::{CellNodes, WithMiddles};
use anastomesh_mesh::beside::{Beside, Column};
use anastomesh_mesh::geometry::Point3;
use anastomesh_mesh::progress::Progress;
use anastomesh_mesh::source::MeshSource;
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::Path;

/// Name prefixes of additional values: at points, in tetrahedra, in boundary faces.
const VALUES: [&str; 3] = ["point_", "tet_", "triangle_"];

fn is_ours(file: &str) -> bool {
    let is_array = |name: &str| ARRAYS.contains(&name) || VALUES.iter().any(|prefix| name.starts_with(prefix));
    file == NOTES || file.strip_suffix(".npy").is_some_and(is_array)
}

/// Checks that the folder can be created or replaced, without side effects.
pub(in crate::volume) fn ensure_writable(path: &Path) -> io::Result<()> {
    AtomicFolder::create(path, is_ours).map(drop)
}

/// Writes the folder of a multi-pass mesh under a temporary name. Corners are `int32`, which most programs expect, or `uint32` for large point
/// counts. Tetrahedra have 10 columns and triangles 6 in a second-order mesh. Values become separate arrays: `point_radius`, `tet_branch`, `triangle_branch`.
///
/// # Errors
/// The operating system or the mesh source fails.
pub(in crate::volume) fn stage(
    path: &Path,
    mesh: &dyn MeshSource,
    notes: &MeshNotes,
    options: &WriteOptions,
    progress: &dyn Progress,
) -> io::Result<OutputSet> {
    let folder = AtomicFolder::create(path, is_ours)?;
    let writer = ArrayFolder { folder: &folder, progress };
    let nodes = CellNodes(options.second_order);
    let with_middles = options.second_order.map(|second| WithMiddles { mesh, second });
    let mesh: &dyn MeshSource = with_middles.as_ref().map_or(mesh, |mesh| mesh);
    let counts = mesh.counts();
    writer.array::<f64>(POINTS, counts.points, 3, |out| {
        mesh.each_points(|points| points.iter().try_for_each(|p| p.iter().try_for_each(|x| x.put(out))))
    })?;
    if i32::try_from(counts.points).is_ok() {
        writer.cells(mesh, nodes, |v| v as i32)?;
    } else {
        writer.cells(mesh, nodes, |v| v)?;
    }
    writer.labels(mesh)?;
    if let Some(layers) = LayerNumbers::of(mesh, options.layers)? {
        writer.array::<i32>(TET_LAYER, counts.tets, 1, |out| {
            layers.each(|some| some.iter().try_for_each(|layer| layer.put(out)))
        })?;
    }
    if let Some(values) = options.values {
        writer.values(mesh, values)?;
    }
    let text = serde_json::to_string_pretty(&Notes::new(notes, mesh.patches()))?;
    folder.put(NOTES, text.as_bytes())?;
    Ok(folder.stage())
}

/// Writer of arrays in a folder.
struct ArrayFolder<'a> {
    folder: &'a AtomicFolder,
    progress: &'a dyn Progress,
}

/// Output stream of an array.
type Out<'a> = Asked<'a, BufWriter<File>>;

impl ArrayFolder<'_> {
    fn array<T: Item>(
        &self,
        name: &str,
        rows: usize,
        columns: usize,
        fill: impl FnOnce(&mut Out) -> io::Result<()>,
    ) -> io::Result<()> {
        let mut out = Asked { out: self.folder.quick_file(&format!("{name}.npy"))?, progress: self.progress };
        head::<T>(&mut out, rows, columns)?;
        fill(&mut out)?;
        out.flush()
    }

    /// Writes the nodes of tetrahedra and boundary faces.
    fn cells<T: Item>(&self, mesh: &dyn MeshSource, nodes: CellNodes, number: impl Fn(u32) -> T) -> io::Result<()> {
        let counts = mesh.counts();
        self.array::<T>(TETS, counts.tets, nodes.per_tet(), |out| {
            mesh.each_tets(|piece| nodes.of_tets(&piece.tets).iter().try_for_each(|&v| number(v).put(out)))
        })?;
        self.array::<T>(TRIANGLES, counts.boundary, nodes.per_face(), |out| {
            mesh.each_faces(|piece| nodes.of_faces(&piece.faces).iter().try_for_each(|&v| number(v).put(out)))
        })
    }

    /// Writes blocks and patches.
    fn labels(&self, mesh: &dyn MeshSource) -> io::Result<()> {
        let counts = mesh.counts();
        self.array::<i32>(TET_BLOCKS, counts.tets, 1, |out| {
            mesh.each_tet_labels(|piece| put_labels(out, &piece.blocks, piece.count))
        })?;
        self.array::<i32>(TRIANGLE_PATCHES, counts.boundary, 1, |out| {
            mesh.each_face_labels(|piece| put_labels(out, &piece.patches, piece.count))
        })?;
        self.array::<i32>(TRIANGLE_BLOCKS, counts.boundary, 1, |out| {
            mesh.each_face_labels(|piece| put_labels(out, &piece.blocks, piece.count))
        })
    }

    fn values(&self, mesh: &dyn MeshSource, values: &dyn Beside) -> io::Result<()> {
        let counts = mesh.counts();
        let [at_points, in_tets, in_faces] = VALUES;
        for (i, column) in values.columns().iter().enumerate() {
            if column.at_points {
                let each = |give: Give| mesh.each_points(|points: &[Point3]| give(&values.at_points(i, points)));
                self.column(at_points, column, counts.points, each)?;
                continue;
            }
            let each = |give: Give| mesh.each_tet_corners(|tets| give(&values.in_tets(i, tets)));
            self.column(in_tets, column, counts.tets, each)?;
            let each = |give: Give| mesh.each_face_corners(|faces| give(&values.in_faces(i, faces)));
            self.column(in_faces, column, counts.boundary, each)?;
        }
        Ok(())
    }

    fn column(
        &self,
        prefix: &str,
        column: &Column,
        rows: usize,
        each: impl FnOnce(Give) -> io::Result<()>,
    ) -> io::Result<()> {
        let name = format!("{prefix}{}", column.name);
        if column.is_integer {
            self.array::<i32>(&name, rows, 1, |out| {
                each(&mut |values| values.iter().try_for_each(|&value| (value as i32).put(out)))
            })
        } else {
            self.array::<f64>(&name, rows, 1, |out| {
                each(&mut |values| values.iter().try_for_each(|value| value.put(out)))
            })
        }
    }
}

/// Callback for values.
type Give<'a> = &'a mut dyn FnMut(&[f64]) -> io::Result<()>;

/// Writes labels, 0 if unknown.
fn put_labels(out: &mut Out, labels: &[i32], count: usize) -> io::Result<()> {
    (0..count).try_for_each(|i| labels.get(i).copied().unwrap_or(0).put(out))
}
