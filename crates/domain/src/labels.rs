//! Names for regions, interfaces and outer boundaries.

use super::layout::Layout;
use super::plan::DomainPlan;
use anastomesh_mesh::{NamedRegion, Patch, WALL};
use std::collections::BTreeMap;

/// Region inside the vessels.
pub const LUMEN_ID: i32 = 1;

/// Regions of a plan, by ascending id.
pub fn regions(plan: &DomainPlan) -> Vec<NamedRegion> {
    (LUMEN_ID..).zip(plan.names()).map(|(id, name)| NamedRegion::new(id, name)).collect()
}

/// Region of the tissue; further regions in it follow.
pub fn tissue_id(plan: &DomainPlan) -> i32 {
    LUMEN_ID + 1 + plan.shells.len() as i32
}

/// Faces with their patches.
#[derive(Default)]
pub struct Labelled {
    pub faces: Vec<[u32; 3]>,
    pub patches: Vec<i32>,
    pub regions: Vec<i32>,
    names: BTreeMap<String, i32>,
    /// All patches.
    pub list: Vec<Patch>,
}

impl Labelled {
    /// Adds faces under a region to a patch.
    fn add(&mut self, name: &str, region: i32, faces: impl IntoIterator<Item = [u32; 3]>) {
        let before = self.faces.len();
        self.faces.extend(faces);
        if self.faces.len() > before {
            let id = self.patch(name);
            self.patches.resize(self.faces.len(), id);
            self.regions.resize(self.faces.len(), region);
        }
    }

    /// Id of the patch with this name, which is added if there is none.
    fn patch(&mut self, name: &str) -> i32 {
        let next = self.list.iter().map(|patch| patch.id).max().unwrap_or(0) + 1;
        let id = *self.names.entry(name.to_owned()).or_insert(next);
        if id == next {
            self.list.push(Patch { id, name: name.to_owned(), cap: None });
        }
        id
    }
}

impl Labelled {
    /// Labels the faces of all regions. `lumen` has its patches, and its faces with theirs, or none of them. `in_mesh` is the
    /// number in the mesh of a point of the layout.
    pub fn of(
        lumen: (Vec<Patch>, Vec<[u32; 3]>, Vec<i32>),
        layout: &Layout,
        plan: &DomainPlan,
        in_mesh: &dyn Fn(u32) -> u32,
    ) -> Self {
        let (list, lumen_faces, lumen_patches) = lumen;
        let (regions, tissue_id) = (regions(plan), tissue_id(plan));
        let tissue = layout.outsides.len();
        let Layout { lumen: surface, shells, .. } = layout;
        let mut faces = Self { list, ..Self::default() };
        let name_of = |region: i32| regions[(region - LUMEN_ID) as usize].name.as_str();
        let last = LUMEN_ID + plan.shells.len() as i32;
        // Outer side of a lumen or shell in the region of a surface.
        let side = |region: i32, home: usize| match region {
            _ if region < last => format!("interface_{}_{}", name_of(region), name_of(region + 1)),
            _ if tissue > 0 => format!("interface_{}_{}", name_of(region), name_of(tissue_id + home as i32)),
            LUMEN_ID => "wall".to_owned(),
            _ => format!("{}_outer", name_of(region)),
        };
        // Walls keep their id, and caps keep theirs with their names.
        if let Some(wall) = faces.list.iter_mut().find(|patch| patch.id == WALL) {
            wall.name = side(LUMEN_ID, 0);
        }
        faces.patches = lumen_patches;
        if shells.sides.is_empty() {
            divide_wall(&mut faces, layout, tissue, &|home| side(LUMEN_ID, home));
        }
        faces.faces = lumen_faces;
        faces.regions = vec![LUMEN_ID; faces.faces.len()];
        for (region, triangles) in (LUMEN_ID + 1..).zip(&shells.sides) {
            let homes = if region == last { tissue.max(1) } else { 1 };
            for home in 0..homes {
                let own = triangles.iter().filter(|t| homes == 1 || layout.home(t[0]) == home);
                faces.add(&side(region, home), region, own.map(|t| t.map(in_mesh)));
            }
        }
        let cap_names: BTreeMap<i32, String> = faces.list.iter().map(|patch| (patch.id, patch.name.clone())).collect();
        for ring in &shells.rings {
            let region = LUMEN_ID + 1 + ring.shell as i32;
            let cap = cap_names.get(&surface.patches[ring.cap as usize]).map_or("cap", String::as_str);
            let name =
                if shells.sides.len() == 1 { format!("ring_{cap}") } else { format!("ring_{}_{cap}", name_of(region)) };
            faces.add(&name, region, ring.triangles.iter().map(|t| t.map(in_mesh)));
        }
        let region_name = |k: usize| name_of(tissue_id + k as i32);
        label_tissue(&mut faces, layout, (tissue_id, &region_name), in_mesh);
        if tissue > 1 {
            let used = &faces.patches;
            faces.list.retain(|patch| used.contains(&patch.id));
        }
        faces
    }
}

/// Gives the lumen's wall a patch in each region around it, beyond the first.
fn divide_wall(faces: &mut Labelled, layout: &Layout, regions: usize, name: &dyn Fn(usize) -> String) {
    let homes: Vec<usize> = layout.lumen.surface.triangles.iter().map(|t| layout.home(t[0])).collect();
    for home in 1..regions {
        let is_own = |(own, patch): (&usize, &i32)| *own == home && *patch == WALL;
        if homes.iter().zip(&faces.patches).any(is_own) {
            let id = faces.patch(&name(home));
            for (own, patch) in homes.iter().zip(&mut faces.patches) {
                if is_own((own, patch)) {
                    *patch = id;
                }
            }
        }
    }
}

/// Labels the surfaces around the tissue: that of the organ, and interfaces between regions of the tissue.
fn label_tissue<'a>(
    faces: &mut Labelled,
    layout: &Layout,
    (first, name): (i32, &dyn Fn(usize) -> &'a str),
    in_mesh: &dyn Fn(u32) -> u32,
) {
    for (k, outside) in layout.outsides.iter().enumerate() {
        for (i, range) in &outside.of_surfaces {
            // Region on the other side of the surface; the first surface has none.
            let beyond = if *i == k { layout.around.map_or(0, |around| around.parents[*i]) } else { *i };
            let patch = match (k, *i) {
                (0, 0) => "organ".to_owned(),
                // The region with the smaller id lists the face.
                _ if beyond < k => continue,
                _ => format!("interface_{}_{}", name(k), name(beyond)),
            };
            let own = outside.boundary.triangles[range.clone()].iter();
            let own = own.map(|t| t.map(|v| in_mesh(outside.numbers[v as usize])));
            faces.add(&patch, first + k as i32, own);
        }
    }
}
