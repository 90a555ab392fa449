//! Reader of VTU files.

use crate::mesh::{Cap, Mesh, index};
use crate::xml::VtkFile;
use anyhow::{Context as _, Result, bail, ensure};

/// VTK's cell types.
const TRIANGLE: i64 = 5;
const TETRAHEDRON: i64 = 10;
/// Cells of dimension 0 and 1, which are ignored: vertex, poly-vertex, line, polyline.
const THIN: [i64; 4] = [1, 2, 3, 4];
/// Cell arrays with patches, in order of preference.
const LABELS: [&str; 5] = ["patch", "PatchId", "gmsh:physical", "CellEntityIds", "ModelFaceID"];

/// Reads a mesh of one piece.
pub fn read(bytes: &[u8]) -> Result<Mesh> {
    let file = VtkFile::parse(bytes)?;
    let (kind, pieces) = (file.kind(), file.pieces);
    let is_grid = kind == "UnstructuredGrid" && pieces == 1;
    ensure!(is_grid, "{kind} of {pieces} pieces instead of an unstructured grid of one");
    let mut mesh = Mesh { points: file.required("Points", "")?.as_chunks().0.to_vec(), ..Mesh::default() };
    cells(&file, &mut mesh)?;
    notes(&file, &mut mesh)?;
    Ok(mesh)
}

fn cells(file: &VtkFile, mesh: &mut Mesh) -> Result<()> {
    let names = file.names("CellData");
    let data = |name: &&str| file.array::<i64>("CellData", name);
    let labels = LABELS.iter().find(|label| names.contains(label)).map_or(Ok(None), data)?;
    let regions = data(&"region")?;
    let of = |name| file.required::<i64>("Cells", name);
    let (connectivity, ends, types) = (of("connectivity")?, of("offsets")?, of("types")?);
    let mut arrays = [Some(&ends), labels.as_ref(), regions.as_ref()].into_iter().flatten();
    ensure!(arrays.all(|array| array.len() == types.len()), "arrays of cells differ in length");
    let mut start = 0;
    for (i, (&kind, &end)) in types.iter().zip(&ends).enumerate() {
        let end = usize::try_from(end).unwrap_or(usize::MAX);
        let vertices = connectivity.get(start..end).with_context(|| format!("cell {i} has a bad offset"))?;
        start = end;
        match (kind, vertices) {
            (TETRAHEDRON, &[a, b, c, d]) => {
                mesh.tets.push([a, b, c, d].map(index));
                mesh.tet_regions.extend(regions.as_ref().map(|regions| regions[i]));
            }
            (TRIANGLE, &[a, b, c]) => {
                mesh.triangles.push([a, b, c].map(index));
                mesh.labels.push(labels.as_ref().map_or(0, |labels| labels[i]));
            }
            (kind, _) if THIN.contains(&kind) => {}
            _ => bail!("cell {i} of type {kind} with {} vertices is not supported", vertices.len()),
        }
    }
    Ok(())
}

/// Texts that end with zeros.
fn texts(bytes: Vec<i64>) -> Vec<String> {
    let bytes: Vec<u8> = bytes.into_iter().map(|b| b as u8).collect();
    let texts = bytes.strip_suffix(&[0]).unwrap_or(&bytes).split(|&b| b == 0);
    texts.map(|text| String::from_utf8_lossy(text).into_owned()).collect()
}

/// Field arrays that `anastomesh` writes: names of patches, caps and the expectation.
fn notes(file: &VtkFile, mesh: &mut Mesh) -> Result<()> {
    let whole = |name| file.array::<i64>("FieldData", name);
    if let Some(bytes) = whole("patch_names")? {
        // The first is the name of the volume. Numbers without a patch have no name.
        let named = (0..).zip(texts(bytes)).skip(1);
        mesh.patches = named.filter(|(_, name)| !name.is_empty()).collect();
    }
    if let (Some(ids), Some(names)) = (whole("region_ids")?, whole("region_names")?) {
        mesh.regions = ids.into_iter().zip(texts(names)).collect();
    }
    mesh.expected_loops = whole("expected_loops")?;
    mesh.expected_terminals = whole("expected_terminals")?;
    let Some(patches) = whole("cap_patch")? else { return Ok(()) };
    let real = |name| file.required::<f64>("FieldData", name);
    let (centers, normals, radii) = (real("cap_center")?, real("cap_normal")?, real("cap_radius")?);
    let nodes = file.required::<i64>("FieldData", "cap_node")?;
    let (centers, normals) = (centers.as_chunks().0, normals.as_chunks().0);
    let lengths = [nodes.len(), centers.len(), normals.len(), radii.len()];
    ensure!(lengths == [patches.len(); 4], "arrays of caps differ in length");
    let cap = |i| Cap { patch: patches[i], node: nodes[i], center: centers[i], normal: normals[i], radius: radii[i] };
    mesh.caps = (0..patches.len()).map(cap).collect();
    Ok(())
}
