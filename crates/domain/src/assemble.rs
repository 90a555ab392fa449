//! One mesh of lumen, shells and tissue, with names for its regions, interfaces and outer boundaries.
//!
//! Points are those of the lumen, then those of the shells, then those of the organ's surface and inside the tissue.

use super::plan::DomainPlan;
use super::surface::LumenSurface;
use super::without::without;
use anastomesh_mesh::geometry::Point3;
use anastomesh_mesh::{NamedRegion, Patch, TetMesh, TriMesh, VolumeMesh, WALL};
use anastomesh_tet::Shells;
use std::collections::BTreeMap;

/// Region inside the vessels.
const LUMEN_ID: i32 = 1;

/// Lumen and shells, and the surface that the tissue fills.
pub struct Layout<'a> {
    lumen: &'a LumenSurface,
    shells: &'a Shells,
    /// Boundary of the tissue with its own points.
    outside: TriMesh,
    /// Points of `outside` on the vessels, in the numbers of lumen surface and shells.
    on_vessels: Vec<u32>,
    /// Triangles of the organ's surface, which come last in `outside`.
    of_organ: usize,
}

impl<'a> Layout<'a> {
    pub fn new(lumen: &'a LumenSurface, shells: &'a Shells, organ: Option<&TriMesh>) -> Self {
        let count = lumen.surface.points.len();
        let capped = lumen.surface.triangles.iter().zip(&lumen.caps);
        let own = |is_cap: bool| capped.clone().filter(move |(_, cap)| cap.is_some() == is_cap).map(|(t, _)| *t);
        let mut triangles: Vec<[u32; 3]> = match shells.sides.last() {
            Some(outer) => outer.clone(),
            None => own(false).collect(),
        };
        triangles.extend(own(true));
        triangles.extend(shells.rings.iter().flat_map(|ring| &ring.triangles));
        let mut on_vessels = triangles.as_flattened().to_vec();
        on_vessels.sort_unstable();
        on_vessels.dedup();
        let mut number = vec![u32::MAX; count + shells.points.len()];
        (0..).zip(&on_vessels).for_each(|(i, &v)| number[v as usize] = i);
        for t in &mut triangles {
            *t = t.map(|v| number[v as usize]);
        }
        let place = |&v: &u32| match (v as usize).checked_sub(count) {
            Some(i) => shells.points[i],
            None => lumen.surface.points[v as usize],
        };
        let mut points: Vec<Point3> = on_vessels.iter().map(place).collect();
        let mut of_organ = 0;
        if let Some(organ) = organ {
            let first = points.len() as u32;
            points.extend_from_slice(&organ.points);
            triangles.extend(organ.triangles.iter().map(|t| t.map(|v| v + first)));
            of_organ = organ.triangles.len();
        }
        Self { lumen, shells, outside: TriMesh { points, triangles }, on_vessels, of_organ }
    }

    /// Boundary of the tissue.
    pub fn outside(&self) -> &TriMesh {
        &self.outside
    }
}

/// Faces with their patches.
#[derive(Default)]
struct Labelled {
    faces: Vec<[u32; 3]>,
    patches: Vec<i32>,
    regions: Vec<i32>,
    names: BTreeMap<String, i32>,
    list: Vec<Patch>,
}

impl Labelled {
    /// Adds faces under a region to a patch.
    fn add(&mut self, name: &str, region: i32, faces: impl IntoIterator<Item = [u32; 3]>) {
        let next = self.list.iter().map(|patch| patch.id).max().unwrap_or(0) + 1;
        let id = *self.names.entry(name.to_owned()).or_insert(next);
        let before = self.faces.len();
        self.faces.extend(faces);
        if id == next && self.faces.len() > before {
            self.list.push(Patch { id, name: name.to_owned(), cap: None });
        }
        self.patches.resize(self.faces.len(), id);
        self.regions.resize(self.faces.len(), region);
    }
}

/// Assembles the mesh; returns it with the ids and names of its regions.
pub fn assemble(
    lumen: VolumeMesh,
    layout: &Layout,
    tissue: Option<&TetMesh>,
    plan: &DomainPlan,
) -> (VolumeMesh, Vec<NamedRegion>) {
    let regions: Vec<NamedRegion> =
        (LUMEN_ID..).zip(plan.names()).map(|(id, name)| NamedRegion::new(id, name)).collect();
    let Layout { lumen: surface, shells, .. } = layout;
    let (of_lumen, on_surface) = (lumen.mesh.points.len() as u32, surface.points.len() as u32);
    let in_mesh = |v: u32| match v.checked_sub(on_surface) {
        Some(i) => of_lumen + i,
        None => surface.points[v as usize],
    };
    let mut mesh = lumen.mesh;
    let more = tissue.map_or(0, |tissue| tissue.tets.len());
    mesh.tets.reserve_exact(shells.tets.len() + more);
    let mut tet_block = Vec::with_capacity(mesh.tets.capacity());
    tet_block.resize(mesh.tets.len(), LUMEN_ID);
    mesh.points.extend_from_slice(&shells.points);
    mesh.tets.extend(shells.tets.iter().map(|t| t.map(in_mesh)));
    tet_block.extend(shells.shell_of.iter().map(|&shell| LUMEN_ID + 1 + shell as i32));
    let tissue_id = LUMEN_ID + 1 + plan.shells.len() as i32;
    let last = mesh.points.len() as u32;
    let vessels = layout.on_vessels.len() as u32;
    let of_tissue = |v: u32| match v.checked_sub(vessels) {
        Some(i) => last + i,
        None => in_mesh(layout.on_vessels[v as usize]),
    };
    if let Some(tissue) = tissue {
        mesh.points.extend_from_slice(&tissue.points[vessels as usize..]);
        mesh.tets.extend(tissue.tets.iter().map(|t| t.map(of_tissue)));
        tet_block.resize(mesh.tets.len(), tissue_id);
    }

    let mut faces = Labelled { list: lumen.patches, ..Labelled::default() };
    let name_of = |region: i32| regions[(region - LUMEN_ID) as usize].name.as_str();
    let beyond = |region: i32| regions.get((region + 1 - LUMEN_ID) as usize).map(|next| next.name.as_str());
    let side = |region: i32| match (beyond(region), region) {
        (Some(next), _) => format!("interface_{}_{next}", name_of(region)),
        (None, LUMEN_ID) => "wall".to_owned(),
        (None, _) => format!("{}_outer", name_of(region)),
    };
    // Walls keep their id, and caps keep theirs with their names.
    if let Some(wall) = faces.list.iter_mut().find(|patch| patch.id == WALL) {
        wall.name = side(LUMEN_ID);
    }
    faces.faces = lumen.boundary;
    faces.patches = lumen.boundary_patch;
    faces.regions = vec![LUMEN_ID; faces.faces.len()];
    for (region, triangles) in (LUMEN_ID + 1..).zip(&shells.sides) {
        faces.add(&side(region), region, triangles.iter().map(|t| t.map(in_mesh)));
    }
    let cap_names: BTreeMap<i32, String> = faces.list.iter().map(|patch| (patch.id, patch.name.clone())).collect();
    for ring in &shells.rings {
        let region = LUMEN_ID + 1 + ring.shell as i32;
        let cap = cap_names.get(&surface.patches[ring.cap as usize]).map_or("cap", String::as_str);
        let name =
            if shells.sides.len() == 1 { format!("ring_{cap}") } else { format!("ring_{}_{cap}", name_of(region)) };
        faces.add(&name, region, ring.triangles.iter().map(|t| t.map(in_mesh)));
    }
    if tissue.is_some() {
        let organ = &layout.outside.triangles[layout.outside.triangles.len() - layout.of_organ..];
        faces.add("organ", tissue_id, organ.iter().map(|t| t.map(of_tissue)));
    }
    let Labelled { faces, patches: boundary_patch, regions: boundary_block, list, .. } = faces;
    let volume = VolumeMesh { mesh, tet_block, boundary: faces, boundary_block, boundary_patch, patches: list };
    let (out, kept): (Vec<NamedRegion>, Vec<NamedRegion>) =
        regions.into_iter().partition(|region| plan.without.contains(&region.name));
    let out: Vec<i32> = out.into_iter().map(|region| region.id).collect();
    (if out.is_empty() { volume } else { without(volume, &out) }, kept)
}
