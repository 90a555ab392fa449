//! Second checker of tetrahedral meshes. It shares no code with the mesher and its checker. Readers, exact arithmetic,
//! topology and geometry are its own, so that no fault hides in both.
//!
//! ```
//! use anastomesh_verify::{Demands, Mesh, verify};
//!
//! let points = vec![[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0., 0., 1.]];
//! let mut mesh = Mesh { points, tets: vec![[0, 1, 2, 3]], ..Mesh::default() };
//! assert!(verify(&mesh, &Demands::default()).is_valid());
//! mesh.tets[0].swap(0, 1);
//! let report = verify(&mesh, &Demands::default());
//! assert_eq!(report.violated().next().map(|found| found.condition.name()), Some("positive_tets"));
//! ```

mod boundary;
pub mod certificate;
mod crossing;
mod exact;
mod faces;
mod labels;
mod mesh;
mod msh;
mod network;
mod numbers;
mod regions;
mod report;
mod sets;
mod sides;
mod space;
mod surface;
mod tetgen;
mod vtu;
mod xml;

pub use mesh::{Cap, Mesh};
pub use network::Cone;
pub use report::{Condition, Figures, Outcome, Report};
pub use surface::Soup;

use anyhow::{Context as _, Result, bail, ensure};
use std::path::{Path, PathBuf};

/// Maximum number of tetrahedra and of points.
const MAX_COUNT: usize = u32::MAX as usize / 4;

/// Conditions beyond those of the mesh alone.
#[derive(Default)]
pub struct Demands {
    /// Surface whose triangles must be boundary faces.
    pub surface: Option<Soup>,
    /// Vessels near which the wall must be, and the tolerance in radii.
    pub network: Option<(Vec<Cone>, f64)>,
}

/// Checks all conditions that apply to a mesh.
pub fn verify(mesh: &Mesh, demands: &Demands) -> Report {
    if mesh.regions.is_empty() {
        return verify_whole(mesh, demands);
    }
    // The expectation is that of the lumen. Without it, the faces of caps bound the tissue, from the other side.
    let mut whole = Mesh { expected_loops: None, expected_terminals: None, ..mesh.clone() };
    if !mesh.regions.iter().any(|(_, name)| name == regions::LUMEN) {
        whole.caps.clear();
    }
    let mut report = verify_whole(&whole, demands);
    if [Condition::NotEmpty, Condition::IndicesInRange].iter().all(|&condition| report.holds(condition)) {
        if mesh.expected_loops.is_none() {
            report.allow_touching();
        }
        regions::verify(mesh, &mut report, |part| verify_whole(part, &Demands::default()));
    }
    report
}

/// Checks a mesh without regard to its regions.
fn verify_whole(mesh: &Mesh, demands: &Demands) -> Report {
    let mut report = Report::default();
    let Some(boundary) = faces::check(mesh, &mut report) else { return report };
    boundary::check(mesh, &boundary, &mut report);
    labels::check(mesh, &boundary, &mut report);
    if let Some(surface) = &demands.surface {
        surface::check(surface, mesh, &boundary, &mut report);
    }
    if let Some((cones, tolerance)) = &demands.network {
        network::check(cones, *tolerance, mesh, &boundary, &mut report);
    }
    report
}

/// Reads a mesh: VTU, MSH 4.1 or 2.2, or TetGen's files by the name of the `.ele` file.
///
/// # Errors
/// A file that is missing, damaged, or has cells other than tetrahedra and triangles.
pub fn read_mesh(path: &Path) -> Result<Mesh> {
    let mesh = match extension(path) {
        "vtu" => vtu::read(&std::fs::read(path)?),
        "msh" | "msh2" => msh::read(&std::fs::read(path)?),
        "ele" => tetgen::read(path),
        other => bail!("meshes '.{other}' are not supported; use .vtu, .msh or .ele"),
    }?;
    // Numbers of faces and corners have 32 bits.
    ensure!(mesh.tets.len().max(mesh.points.len()) <= MAX_COUNT, "more than {MAX_COUNT} tetrahedra or points");
    Ok(mesh)
}

/// Reads a surface: OFF, STL or PLY.
///
/// # Errors
/// A file that is missing, damaged, or has faces other than triangles.
pub fn read_surface(path: &Path) -> Result<Soup> {
    read_named(path, surface::read)
}

/// Reads a network: SWC, or VTP with an array whose name contains `radius`.
///
/// # Errors
/// A file that is missing, damaged or has no vessels.
pub fn read_network(path: &Path) -> Result<Vec<Cone>> {
    read_named(path, network::read)
}

/// Result of a reader, with the path in its error.
fn read_named<T>(path: &Path, reader: fn(&Path, &[u8]) -> Result<T>) -> Result<T> {
    let named = || path.display().to_string();
    reader(path, &std::fs::read(path).with_context(named)?).with_context(named)
}

/// Returns the files that make a mesh: the file itself, and those beside it in TetGen's format.
pub fn files_of(path: &Path) -> Vec<PathBuf> {
    let beside = ["node", "face"].map(|e| path.with_extension(e));
    let beside = beside.into_iter().filter(|other| extension(path) == "ele" && other.exists());
    std::iter::once(path.to_owned()).chain(beside).collect()
}

fn extension(path: &Path) -> &str {
    path.extension().and_then(|e| e.to_str()).unwrap_or_default()
}
