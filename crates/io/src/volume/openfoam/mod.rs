//! `OpenFOAM` cases: a folder with the mesh in `constant/polyMesh` and all dictionaries for `simpleFoam`.

mod boundary;
mod case;
mod head;
mod poly_mesh;
#[cfg(test)]
mod tests;

use super::content::MeshNotes;
use crate::file::AtomicFolder;
use crate::flow::Flow;
use anastomesh_mesh::progress::Progress;
use anastomesh_mesh::source::MeshSource;
use boundary::Boundary;
use std::io;
use std::path::Path;

/// Writer of a text file in the folder.
type Text = fn(&Boundary, &Flow) -> String;

const TEXTS: [(&str, Text); 9] = [
    ("constant/polyMesh/boundary", |boundary, _| case::boundary(boundary)),
    ("constant/transportProperties", |_, flow| case::transport(flow)),
    ("constant/turbulenceProperties", |_, _| case::turbulence()),
    ("system/controlDict", |_, _| case::control()),
    ("system/fvSchemes", |_, _| case::schemes()),
    ("system/fvSolution", |_, _| case::solution()),
    ("system/decomposeParDict", |_, _| case::decompose()),
    ("0/U", case::velocity),
    ("0/p", |boundary, _| case::pressure(boundary)),
];

/// Empty marker file that `ParaView` opens.
const FOR_PARAVIEW: &str = "case.foam";

/// Checks that the folder can be created or replaced, without side effects.
pub(super) fn ensure_writable(path: &Path) -> io::Result<()> {
    AtomicFolder::create(path, is_ours).map(drop)
}

fn is_ours(name: &str) -> bool {
    name == FOR_PARAVIEW || poly_mesh::FILES.contains(&name) || TEXTS.iter().any(|(text, _)| *text == name)
}

/// Writes a case atomically. Solver results in an existing folder are an error.
///
/// Tetrahedra are read twice, points once, the boundary three times. Memory holds the faces between parts of the mesh,
/// about 50 bytes each, and the position of every patch.
///
/// # Errors
/// The operating system or the mesh source fails; `InvalidData` if the labelled faces are not its boundary.
pub(super) fn write(path: &Path, mesh: &dyn MeshSource, notes: &MeshNotes, progress: &dyn Progress) -> io::Result<()> {
    let folder = AtomicFolder::create(path, is_ours)?;
    let boundary = Boundary::of(mesh)?;
    poly_mesh::write(&folder, mesh, &boundary, progress)?;
    let flow = &notes.flow_of(mesh.patches());
    for (name, text) in TEXTS {
        folder.put(name, text(&boundary, flow).as_bytes())?;
    }
    folder.put(FOR_PARAVIEW, b"")?;
    folder.commit()
}
