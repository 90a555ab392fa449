//! Writer of each region as a mesh of its own, with the numbers of the whole mesh.

use super::content::MeshNotes;
use super::error::MeshFileError;
use super::options::GridOptions;
use super::vtu::{Grid, SolverIds};
use crate::file::{Asked, FileError, OutputSet, stage_whole};
use crate::flow::plain;
use anastomesh_mesh::progress::Progress;
use anastomesh_mesh::region::{NamedRegion, RegionMesh, RegionMeshes};
use anastomesh_mesh::source::{MeshSource, gather};
use anastomesh_mesh::units::counted;
use std::borrow::Cow;
use std::io;
use std::path::{Path, PathBuf};

/// Paths of the regions of a mesh at `path`: `NAME_lumen.vtu` beside `NAME.vtu` or `NAME.msh`.
///
/// ```
/// use anastomesh_io::volume::region_paths;
/// use anastomesh_mesh::NamedRegion;
/// use std::path::{Path, PathBuf};
///
/// let regions = [NamedRegion::new(1, "lumen"), NamedRegion::new(2, "wall")];
/// let paths = region_paths(Path::new("out/tree.msh"), &regions);
/// assert_eq!(paths, [PathBuf::from("out/tree_lumen.vtu"), PathBuf::from("out/tree_wall.vtu")]);
/// ```
pub fn region_paths(path: &Path, regions: &[NamedRegion]) -> Vec<PathBuf> {
    let stem = path.file_stem().unwrap_or(path.as_os_str()).to_string_lossy().into_owned();
    regions.iter().map(|region| path.with_file_name(format!("{stem}_{}.vtu", plain(&region.name)))).collect()
}

/// Writes a VTU file for each region beside a mesh at `path`, all or none, and returns the files.
///
/// Each has the point array `GlobalNodeID` and the cell array `GlobalElementID`: numbers in the whole mesh, counted from 1.
/// A boundary face has the number of its tetrahedron. Points on an interface have equal numbers and coordinates on both
/// sides. Interfaces are patches of both regions, oriented out of each. The expectation of the notes is that of the lumen.
/// The mesh is held in memory, and one region.
///
/// ```
/// use anastomesh_io::volume::{GridOptions, MeshNotes, read_mesh, write_regions};
/// use anastomesh_mesh::shapes::walled_channel;
///
/// let (volume, regions) = walled_channel(1);
/// let folder = tempfile::tempdir()?;
/// let notes = MeshNotes { regions, ..MeshNotes::default() };
/// let files = write_regions(&folder.path().join("a.vtu"), &volume, &notes, GridOptions::default(), &())?;
/// let wall = read_mesh(&files[1])?;
/// assert_eq!(wall.notes.regions[0].name, "wall");
/// assert_eq!(wall.volume.mesh.tets.len(), 5 * 8 * 6);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// `Write` with the reason. The operating system or the mesh source fails, or the mesh has no regions. Two regions have one
/// file name, or numbers exceed 32 bits.
pub fn write_regions(
    path: &Path,
    mesh: &dyn MeshSource,
    notes: &MeshNotes,
    grid: GridOptions,
    progress: &dyn Progress,
) -> Result<Vec<PathBuf>, MeshFileError> {
    let (paths, outputs) = stage_regions(path, mesh, notes, grid, progress)?;
    outputs.place()?;
    Ok(paths)
}

/// Writes files like [`write_regions`] under temporary names. [`OutputSet::place`] moves them to their paths.
///
/// # Errors
/// See [`write_regions`].
pub fn stage_regions(
    path: &Path,
    mesh: &dyn MeshSource,
    notes: &MeshNotes,
    grid: GridOptions,
    progress: &dyn Progress,
) -> Result<(Vec<PathBuf>, OutputSet), MeshFileError> {
    let failed = FileError::write(path);
    let unfit = |text: String| FileError::write(path)(io::Error::new(io::ErrorKind::InvalidInput, text));
    if notes.regions.is_empty() {
        return Err(unfit("the mesh has no regions to split".into()));
    }
    let paths = region_paths(path, &notes.regions);
    if let Some(twice) = (1..paths.len()).find(|&i| paths[..i].contains(&paths[i])) {
        return Err(unfit(format!("two regions would be written to {}; rename one", paths[twice].display())));
    }
    let counts = mesh.counts();
    if i32::try_from(counts.points.max(counts.tets)).is_err() {
        let size = counted(counts.tets, "tetrahedron");
        return Err(unfit(format!("{size} are more than numbers of 32 bits can count; mesh parts")));
    }
    let volume = match mesh.whole() {
        Some(volume) => Cow::Borrowed(volume),
        None => Cow::Owned(gather(mesh).map_err(failed)?),
    };
    let regions = RegionMeshes::of(&volume, &notes.regions);
    let mut outputs = OutputSet::default();
    for (region, file) in notes.regions.iter().zip(&paths) {
        let staged = stage_region(file, &regions.mesh(region), notes, grid, progress);
        outputs.append(staged.map_err(FileError::write(file))?);
    }
    Ok((paths, outputs))
}

/// Writes the file of a region under a temporary name.
fn stage_region(
    path: &Path,
    region: &RegionMesh,
    notes: &MeshNotes,
    grid: GridOptions,
    progress: &dyn Progress,
) -> io::Result<OutputSet> {
    let notes = notes_of(region, notes);
    let ids = SolverIds { points: &region.points, tets: &region.tets, faces: &region.face_tets };
    let grid = Grid { solver_ids: Some(ids), ..Grid::of(&region.volume, &notes, grid) };
    stage_whole(path, |out| grid.write(&mut Asked { out, progress }))
}

/// Notes of a region: only the lumen has the network's loops and terminals.
fn notes_of(region: &RegionMesh, notes: &MeshNotes) -> MeshNotes {
    let is_lumen = region.region.name == NamedRegion::LUMEN;
    MeshNotes {
        expectation: notes.expectation.clone().filter(|_| is_lumen),
        regions: vec![region.region.clone()],
        ..notes.clone()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::volume::read_mesh;
    use crate::vtk_xml::VtkXml;
    use anastomesh_mesh::VolumeMesh;
    use anastomesh_mesh::check::check_regions;
    use anastomesh_mesh::shapes::walled_channel;
    use std::collections::BTreeMap;

    fn channel() -> (VolumeMesh, MeshNotes) {
        let (volume, regions) = walled_channel(2);
        (volume, MeshNotes { regions, ..MeshNotes::default() })
    }

    /// Integer array of the points or cells of a file.
    fn ids(path: &Path, section: &str, name: &str) -> Vec<i64> {
        let bytes = std::fs::read(path).unwrap();
        let xml = VtkXml::parse(&bytes, "UnstructuredGrid").unwrap();
        let grid = xml.child(VtkXml::ROOT, "UnstructuredGrid").unwrap();
        let section = xml.child(xml.child(grid, "Piece").unwrap(), section).unwrap();
        let (_, array) = xml.arrays(section).find(|(n, _)| *n == name).unwrap();
        xml.read(array).unwrap().into_ints().unwrap()
    }

    #[test]
    fn regions_share_the_numbers_of_their_points() {
        let folder = tempfile::tempdir().unwrap();
        let (volume, notes) = channel();
        let files = write_regions(&folder.path().join("a.msh"), &volume, &notes, GridOptions::default(), &()).unwrap();
        let mut places: BTreeMap<i64, ([u64; 3], usize)> = BTreeMap::new();
        let mut elements = Vec::new();
        for (file, region) in files.iter().zip(&notes.regions) {
            let part = read_mesh(file).unwrap();
            assert_eq!(part.notes.regions, std::slice::from_ref(region));
            assert_eq!(check_regions(&part.volume, &part.notes.regions, None).failed().count(), 0);
            let nodes = ids(file, "PointData", "GlobalNodeID");
            for (p, &node) in part.volume.mesh.points.iter().zip(&nodes) {
                assert_eq!(*p, volume.mesh.points[node as usize - 1]);
                let bits = <[f64; 3]>::from(p.coords).map(f64::to_bits);
                let known = places.entry(node).or_insert((bits, 0));
                assert_eq!(known.0, bits);
                known.1 += 1;
            }
            let cells = ids(file, "CellData", "GlobalElementID");
            let (tets, faces) = cells.split_at(part.volume.mesh.tets.len());
            for (tet, &number) in part.volume.mesh.tets.iter().zip(tets) {
                let whole = volume.mesh.tets[number as usize - 1].map(|v| i64::from(v) + 1);
                assert_eq!(tet.map(|v| nodes[v as usize]), whole);
            }
            for (face, number) in part.volume.boundary.iter().zip(faces) {
                let tet = volume.mesh.tets[*number as usize - 1];
                assert!(face.iter().all(|&v| tet.contains(&(nodes[v as usize] as u32 - 1))));
            }
            elements.extend_from_slice(tets);
        }
        elements.sort_unstable();
        assert!(elements.into_iter().eq(1..=volume.mesh.tets.len() as i64));
        assert_eq!(places.len(), volume.mesh.points.len());
        // Points of both interfaces: 11 rings of 8 and of 24 points.
        assert_eq!(places.values().filter(|(_, regions)| *regions == 2).count(), 11 * (8 + 24));
    }

    #[test]
    fn meshes_without_regions_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let (volume, mut notes) = channel();
        let path = folder.path().join("a.vtu");
        let mut refused = |regions: Vec<NamedRegion>| {
            notes.regions = regions;
            write_regions(&path, &volume, &notes, GridOptions::default(), &()).unwrap_err().to_string()
        };
        assert!(refused(Vec::new()).contains("a.vtu: cannot be written: the mesh has no regions to split"));
        let same = vec![NamedRegion::new(1, "a b"), NamedRegion::new(2, "a_b")];
        assert!(refused(same).contains("two regions would be written to "));
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    }
}
