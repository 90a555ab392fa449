//! One mesh of lumen, shells and tissue, with names for its regions, interfaces and outer boundaries.
//!
//! Points are those of the lumen, of the shells, of the surfaces around the tissue, and inside each of its regions, in this order.

use super::labels::{LUMEN_ID, Labelled, regions, tissue_id};
use super::layout::Layout;
use super::plan::DomainPlan;
use super::without::without;
use anastomesh_mesh::{NamedRegion, VolumeMesh};
use anastomesh_tet::Tetrahedralization;

/// Assembles the mesh; returns it with the ids and names of its regions. `tissue` has the regions around the vessels.
pub fn assemble(
    lumen: VolumeMesh,
    layout: &Layout,
    tissue: &[Tetrahedralization],
    plan: &DomainPlan,
) -> (VolumeMesh, Vec<NamedRegion>) {
    let regions = regions(plan);
    let shells = layout.shells;
    let of_lumen = lumen.mesh.points.len() as u32;
    let in_mesh = |v: u32| layout.in_mesh(of_lumen, v);
    let mut mesh = lumen.mesh;
    let more: usize = tissue.iter().map(|region| region.mesh.tets.len()).sum();
    mesh.tets.reserve_exact(shells.tets.len() + more);
    let mut tet_block = Vec::with_capacity(mesh.tets.capacity());
    tet_block.resize(mesh.tets.len(), LUMEN_ID);
    mesh.points.extend_from_slice(&shells.points);
    mesh.tets.extend(shells.tets.iter().map(|t| t.map(in_mesh)));
    tet_block.extend(shells.shell_of.iter().map(|&shell| LUMEN_ID + 1 + shell as i32));
    mesh.points.extend(layout.around.iter().flat_map(|around| &around.surfaces).flat_map(|surface| &surface.points));
    for ((id, region), outside) in (tissue_id(plan)..).zip(tissue).zip(&layout.outsides) {
        let (given, last) = (outside.numbers.len(), mesh.points.len() as u32);
        let of_region = |v: u32| match v.checked_sub(given as u32) {
            Some(i) => last + i,
            None => in_mesh(outside.numbers[v as usize]),
        };
        mesh.points.extend_from_slice(&region.mesh.points[given..]);
        mesh.tets.extend(region.mesh.tets.iter().map(|t| t.map(of_region)));
        tet_block.resize(mesh.tets.len(), id);
    }

    let of_lumen = (lumen.patches, lumen.boundary, lumen.boundary_patch);
    let labelled = Labelled::of(of_lumen, layout, plan, &in_mesh);
    let Labelled { faces, patches: boundary_patch, regions: boundary_block, list, .. } = labelled;
    let volume = VolumeMesh { mesh, tet_block, boundary: faces, boundary_block, boundary_patch, patches: list };
    let (out, kept): (Vec<NamedRegion>, Vec<NamedRegion>) =
        regions.into_iter().partition(|region| plan.without.contains(&region.name));
    let out: Vec<i32> = out.into_iter().map(|region| region.id).collect();
    (if out.is_empty() { volume } else { without(volume, &out) }, kept)
}
