//! Inlets and outlets: where each cap is, how large, and what flows through it by the one-dimensional solution; and which
//! outlets are one patch.

use std::collections::{BTreeMap, BTreeSet};
use std::io;

use anastomesh_io::flow::{CapFlow, Flow, OutletModel, USUAL_REYNOLDS, flow_of_reynolds};
use anastomesh_mesh::quality::triangle_area_vector;
use anastomesh_mesh::relabel::Relabelled;
use anastomesh_mesh::source::MeshSource;
use anastomesh_mesh::{Cap, Patch, WALL};
use anastomesh_network::flow::{NetworkFlow, Orders, solve};
use anastomesh_skeleton::{NodeId, Skeleton};

/// Fluid properties and flow rate of each inlet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fluid {
    /// Mass per volume.
    pub density: f64,
    /// Dynamic viscosity.
    pub viscosity: f64,
    /// Volume per time into each inlet; none for what has the usual Reynolds number there.
    pub inflow: Option<f64>,
}

/// Grouping of outlets into patches.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Outlets {
    /// None: each has its own.
    #[default]
    Separate,
    /// All.
    Grouped,
    /// Those whose vessels have the same diameter-defined Strahler order.
    ByOrder,
}

/// An inlet or outlet.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct CapRow {
    /// Its patch, which other outlets may have as well.
    pub id: i32,
    /// The name of the patch.
    pub name: String,
    /// The cap.
    pub cap: Cap,
    /// Area of its triangles.
    pub area: f64,
    /// Strahler order of its vessel.
    pub strahler: u32,
    /// Diameter-defined Strahler order.
    pub order: u32,
    /// Volume per time, in at an inlet, out at an outlet.
    pub flow: f64,
    /// Pressure, against none at the outlets.
    pub pressure: f64,
    /// Pressure per flow beyond an outlet that leaves the flows as they are: all of what is beyond the outlets takes as much
    /// pressure as the network.
    pub resistance: f64,
    is_inlet: bool,
}

/// All inlets and outlets of a mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct Caps {
    /// In the order of their patches as the mesh has them.
    pub rows: Vec<CapRow>,
    fluid: Fluid,
    /// Outlets that are one patch.
    outlets: Outlets,
}

impl Caps {
    /// Of the mesh of a network. Inlets and outlets are known by the names of their patches.
    ///
    /// # Errors
    /// The mesh cannot be read, or the pressures in the network cannot be found.
    pub fn of(mesh: &dyn MeshSource, network: &Skeleton, fluid: Fluid) -> io::Result<Self> {
        let adjacency = network.adjacency();
        let terminals: BTreeMap<u32, NodeId> =
            adjacency.terminals().into_iter().map(|node| (network.node(node).original, node)).collect();
        let caps = mesh.patches().iter().filter_map(|patch| {
            let cap = patch.cap?;
            Some((patch, cap, *terminals.get(&cap.node)?))
        });
        let caps: Vec<(&Patch, Cap, NodeId)> = caps.collect();
        let usual = |cap: &Cap| flow_of_reynolds(USUAL_REYNOLDS, cap.radius, fluid.density, fluid.viscosity);
        let inlets = caps.iter().filter(|(patch, ..)| patch.is_inlet());
        let inlets = inlets.map(|(_, cap, node)| (*node, fluid.inflow.unwrap_or_else(|| usual(cap)))).collect();
        let solved = solve(network, &inlets, fluid.viscosity).map_err(io::Error::other)?;
        let orders = Orders::of(network, &solved.pressure);
        let drops = drops(network, &solved, &inlets);
        let areas = areas(mesh)?;
        let row = |(patch, cap, node): (&Patch, Cap, NodeId)| {
            let (edge, is_inlet) = (adjacency.edges(node)[0].index(), patch.is_inlet());
            let flow = solved.of_terminal.get(&node).copied().unwrap_or(0.0);
            CapRow {
                id: patch.id,
                name: patch.name.clone(),
                cap,
                area: areas.get(&patch.id).copied().unwrap_or(0.0),
                strahler: orders.strahler[edge],
                order: orders.by_diameter[edge],
                flow,
                pressure: solved.pressure[node.index()],
                resistance: if is_inlet || flow <= 0.0 { 0.0 } else { drops[node.index()] / flow },
                is_inlet,
            }
        };
        Ok(Self { rows: caps.into_iter().map(row).collect(), fluid, outlets: Outlets::Separate })
    }

    /// Makes outlets one patch. What the mesh is then; none where it stays as it is.
    pub fn group<'a>(&mut self, mesh: &'a dyn MeshSource, outlets: Outlets) -> Option<Relabelled<'a>> {
        let by_order = match outlets {
            Outlets::Separate => return None,
            Outlets::Grouped => false,
            Outlets::ByOrder => true,
        };
        self.outlets = outlets;
        let of_row = |row: &CapRow| if by_order { row.order } else { 0 };
        let name = |group: u32| if by_order { format!("outlets_order_{group}") } else { "outlets".to_owned() };
        let left = mesh.patches().iter().filter(|patch| patch.cap.is_none() || patch.is_inlet());
        let mut patches: Vec<Patch> = left.cloned().collect();
        let first = patches.iter().map(|patch| patch.id).max().unwrap_or(WALL) + 1;
        let groups: BTreeSet<u32> = self.rows.iter().filter(|row| !row.is_inlet).map(of_row).collect();
        let groups: BTreeMap<u32, i32> = groups.into_iter().zip(first..).collect();
        patches.extend(groups.iter().map(|(&group, &id)| Patch { id, name: name(group), cap: None }));
        let mut ids = BTreeMap::new();
        for row in self.rows.iter_mut().filter(|row| !row.is_inlet) {
            let group = of_row(row);
            ids.insert(row.id, groups[&group]);
            (row.id, row.name) = (groups[&group], name(group));
        }
        Some(Relabelled::new(mesh, patches, ids))
    }

    /// True if outlets share patches.
    pub fn is_grouped(&self) -> bool {
        self.outlets != Outlets::Separate
    }

    /// The nodes of inlets, whose caps are patches of their own in any case.
    pub fn alone(&self) -> Vec<u32> {
        self.rows.iter().filter(|row| row.is_inlet).map(|row| row.cap.node).collect()
    }

    /// Boundary conditions for a solver; outlets of one patch are combined.
    pub fn flow(&self) -> Flow {
        let mut caps: BTreeMap<i32, CapFlow> = BTreeMap::new();
        for row in &self.rows {
            let outlet = OutletModel::Resistance { resistance: row.resistance, distal_pressure: 0.0 };
            let cap = caps.entry(row.id).or_insert_with(|| CapFlow::default().outlet(outlet));
            if cap.flow != 0.0 {
                cap.outlet = cap.outlet.parallel(&outlet).unwrap_or(outlet);
            }
            cap.flow += row.flow;
        }
        Flow::new(self.fluid.density, self.fluid.viscosity).caps(caps)
    }
}

/// By node, the pressure that its component takes: the mean at its inlets by their flow.
fn drops(network: &Skeleton, solved: &NetworkFlow, inlets: &BTreeMap<NodeId, f64>) -> Vec<f64> {
    let components = network.components(&network.adjacency());
    let mut sums = vec![[0.0; 2]; components.list.len()];
    for (node, flow) in inlets {
        let [power, all] = &mut sums[components.of_node[node.index()] as usize];
        *power += flow * solved.pressure[node.index()];
        *all += flow;
    }
    let drop = |&component: &u32| match sums[component as usize] {
        [power, all] if all > 0.0 => power / all,
        _ => 0.0,
    };
    components.of_node.iter().map(drop).collect()
}

/// The area of each patch but the wall.
fn areas(mesh: &dyn MeshSource) -> io::Result<BTreeMap<i32, f64>> {
    let (mut faces, mut patches) = (Vec::new(), Vec::new());
    mesh.each_faces(|piece| {
        for (&face, &patch) in piece.faces.iter().zip(&*piece.patches).filter(|(_, patch)| **patch != WALL) {
            faces.push(face);
            patches.push(patch);
        }
        Ok(())
    })?;
    let mut areas = BTreeMap::new();
    for ([a, b, c], patch) in mesh.corners_of(&faces)?.into_iter().zip(patches) {
        *areas.entry(patch).or_insert(0.0) += triangle_area_vector(&a, &b, &c).norm();
    }
    Ok(areas)
}

#[cfg(test)]
mod tests;
