//! Triangle complexes as arrays: the input of a tetrahedralizer.

use super::error::SurfaceFileError;
use crate::file::FileError;
use crate::npy::{Arrays, NpyError, NpyFault};
use anastomesh_mesh::TriMesh;
use anastomesh_mesh::geometry::Point3;
use std::path::Path;

/// Arrays to read.
const ARRAYS: [&str; 6] = ["points", "triangles", "markers", "segments", "holes", "regions"];

/// Complex from a file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ArrayComplex {
    /// `points` (n, 3) and optional `triangles` (m, 3).
    pub mesh: TriMesh,
    /// `markers` (m) of the triangles; empty if missing.
    pub markers: Vec<i32>,
    /// `segments` (k, 2).
    pub segments: Vec<[u32; 2]>,
    /// `holes` (h, 3): a point in each hole.
    pub holes: Vec<Point3>,
    /// `regions` (r, 5).
    pub regions: Vec<ArrayRegion>,
}

/// Row of `regions`: a point, the region's number, and its volume bound.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ArrayRegion {
    /// Point in the region.
    pub point: Point3,
    /// Label of its tetrahedra.
    pub id: i32,
    /// Maximum volume of its tetrahedra; `None` if missing or not positive.
    pub max_volume: Option<f64>,
}

/// Reads a folder `.npyd`.
///
/// # Errors
/// `Read` with the error of the operating system, or `Content` with the array and row at fault.
pub fn read_complex(folder: &Path) -> Result<ArrayComplex, SurfaceFileError> {
    complex_of(&Arrays::read(folder, &ARRAYS, None)?).map_err(FileError::content(folder))
}

/// Reads a complex from the bytes of the files in a folder.
///
/// # Errors
/// Returns the array and row at fault.
pub fn read_complex_arrays(files: &[(&str, &[u8])]) -> Result<ArrayComplex, NpyError> {
    complex_of(&Arrays::of(files))
}

fn complex_of(arrays: &Arrays) -> Result<ArrayComplex, NpyError> {
    let points = arrays.points("points")?;
    let of_points = ("points.npy", points.len());
    let triangles = arrays.if_there("triangles", |arrays, name| arrays.indices(name, of_points))?;
    let markers = arrays.labels("markers", ("triangles.npy", triangles.len()))?;
    let segments = arrays.if_there("segments", |arrays, name| arrays.indices(name, of_points))?;
    let holes = arrays.if_there("holes", Arrays::points)?;
    let regions = arrays.if_there("regions", regions)?;
    Ok(ArrayComplex {
        mesh: TriMesh { points, triangles },
        markers: markers.unwrap_or_default(),
        segments,
        holes,
        regions,
    })
}

fn regions(arrays: &Arrays, name: &str) -> Result<Vec<ArrayRegion>, NpyError> {
    let fault = |fault: NpyFault| fault.of(format!("{name}.npy"));
    let rows = arrays.floats::<5>(name)?.into_iter().enumerate();
    rows.map(|(row, [x, y, z, id, volume])| {
        if ![x, y, z, id].iter().all(|x| x.is_finite()) {
            return Err(fault(NpyFault::NotFinite { row }));
        }
        if id.fract() != 0.0 || id.abs() > f64::from(i32::MAX) {
            return Err(fault(NpyFault::NoLabel { row, value: id.to_string() }));
        }
        Ok(ArrayRegion { point: Point3::new(x, y, z), id: id as i32, max_volume: Some(volume).filter(|v| *v > 0.0) })
    })
    .collect()
}
