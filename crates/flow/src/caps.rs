//! Inlets and outlets: where each cap is, how large, and what flows through it by the one-dimensional solution; and which
//! outlets are one patch.

use std::collections::btree_map::Entry;
use std::collections::{BTreeMap, BTreeSet};
use std::io;

use super::error::FlowError;
use super::plan::{FlowPlan, FlowSolution, InletSite};
use anastomesh_io::flow::{CapFlow, Flow, OutletModel, Waveform};
use anastomesh_io::network::NodeNames;
use anastomesh_mesh::quality::triangle_area_vector;
use anastomesh_mesh::relabel::Relabelled;
use anastomesh_mesh::source::MeshSource;
use anastomesh_mesh::{Cap, Patch, WALL};
use anastomesh_network::flow::Orders;
use anastomesh_skeleton::{NodeId, Skeleton};

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
    /// Mean volume per time, in at an inlet, out at an outlet.
    pub flow: f64,
    /// Pressure at mean flow.
    pub pressure: f64,
    /// Model beyond an outlet; `None` at an inlet.
    pub outlet: Option<OutletModel>,
    /// Pulsatile flow rate into an inlet.
    pub waveform: Option<Waveform>,
}

/// All inlets and outlets of a mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct Caps {
    /// In the order of their patches as the mesh has them.
    pub rows: Vec<CapRow>,
    plan: FlowPlan,
    /// Outlets that are one patch.
    outlets: Outlets,
}

/// Reason why the flow of a mesh cannot be computed.
#[derive(Debug, thiserror::Error)]
pub enum CapsError {
    /// The flow plan does not fit the network.
    #[error(transparent)]
    Flow(#[from] FlowError),
    /// The mesh cannot be read.
    #[error(transparent)]
    Mesh(#[from] io::Error),
}

impl Caps {
    /// Inlets and outlets of the mesh of a network, known by the names of their patches. `names` are those of the nodes.
    ///
    /// # Errors
    /// The mesh cannot be read, or the plan does not fit the network.
    pub fn of(
        mesh: &dyn MeshSource,
        network: &Skeleton,
        plan: &FlowPlan,
        names: &NodeNames,
    ) -> Result<Self, CapsError> {
        let adjacency = network.adjacency();
        let terminals: BTreeMap<u32, NodeId> =
            adjacency.terminals().into_iter().map(|node| (network.node(node).original, node)).collect();
        let caps = mesh.patches().iter().filter_map(|patch| {
            let cap = patch.cap?;
            Some((patch, cap, *terminals.get(&cap.node)?))
        });
        let caps: Vec<(&Patch, Cap, NodeId)> = caps.collect();
        let name = |node: u32| names.of(NodeId(node));
        let inlets = caps.iter().filter(|(patch, ..)| patch.is_inlet());
        let site = |(patch, cap, node): &(&Patch, Cap, NodeId)| InletSite {
            node: *node,
            patch: patch.name.clone(),
            name: name(cap.node),
            radius: cap.radius,
        };
        let FlowSolution { flow, mut outlets, mut waveforms } =
            plan.solve(network, &inlets.map(site).collect::<Vec<_>>(), &name)?;
        let orders = Orders::of(network, &flow.pressure);
        let areas = areas(mesh)?;
        let row = |(patch, cap, node): (&Patch, Cap, NodeId)| {
            let edge = adjacency.edges(node)[0].index();
            CapRow {
                id: patch.id,
                name: patch.name.clone(),
                cap,
                area: areas.get(&patch.id).copied().unwrap_or(0.0),
                strahler: orders.strahler[edge],
                order: orders.by_diameter[edge],
                flow: flow.of_terminal.get(&node).copied().unwrap_or(0.0),
                pressure: flow.pressure[node.index()],
                outlet: outlets.remove(&node),
                waveform: waveforms.remove(&node),
            }
        };
        Ok(Self { rows: caps.into_iter().map(row).collect(), plan: plan.clone(), outlets: Outlets::Separate })
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
        let groups: BTreeSet<u32> = self.rows.iter().filter(|row| row.outlet.is_some()).map(of_row).collect();
        let groups: BTreeMap<u32, i32> = groups.into_iter().zip(first..).collect();
        patches.extend(groups.iter().map(|(&group, &id)| Patch { id, name: name(group), cap: None }));
        let mut ids = BTreeMap::new();
        for row in self.rows.iter_mut().filter(|row| row.outlet.is_some()) {
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
        self.rows.iter().filter(|row| row.outlet.is_none()).map(|row| row.cap.node).collect()
    }

    /// Boundary conditions for a solver; outlets of one patch are combined.
    pub fn flow(&self) -> Flow {
        let mut caps: BTreeMap<i32, CapFlow> = BTreeMap::new();
        for row in &self.rows {
            let outlet = row.outlet.unwrap_or_default();
            let new = || CapFlow::default().outlet(outlet).waveform(row.waveform.clone());
            match caps.entry(row.id) {
                Entry::Vacant(entry) => entry.insert(new().flow(row.flow)),
                Entry::Occupied(entry) => {
                    let cap = entry.into_mut();
                    cap.outlet = cap.outlet.parallel(&outlet).unwrap_or(outlet);
                    cap.flow += row.flow;
                    cap
                }
            };
        }
        let FlowPlan { density, viscosity, profile, .. } = self.plan;
        Flow::new(density, viscosity).caps(caps).profile(profile).transient(self.plan.transient())
    }
}

/// Faces of caps whose points are read at a time.
const FACES: usize = 1 << 14;

/// The area of each patch but the wall.
fn areas(mesh: &dyn MeshSource) -> io::Result<BTreeMap<i32, f64>> {
    let (mut faces, mut patches) = (Vec::new(), Vec::new());
    let mut areas = BTreeMap::new();
    mesh.each_faces(|piece| {
        for (&face, &patch) in piece.faces.iter().zip(&*piece.patches).filter(|(_, patch)| **patch != WALL) {
            faces.push(face);
            patches.push(patch);
        }
        if faces.len() >= FACES {
            add_areas(mesh, &mut faces, &mut patches, &mut areas)?;
        }
        Ok(())
    })?;
    add_areas(mesh, &mut faces, &mut patches, &mut areas)?;
    Ok(areas)
}

/// Adds the areas of faces to those of their patches, and removes the faces.
fn add_areas(
    mesh: &dyn MeshSource,
    faces: &mut Vec<[u32; 3]>,
    patches: &mut Vec<i32>,
    areas: &mut BTreeMap<i32, f64>,
) -> io::Result<()> {
    for ([a, b, c], patch) in mesh.corners_of(faces)?.into_iter().zip(patches.drain(..)) {
        *areas.entry(patch).or_insert(0.0) += triangle_area_vector(&a, &b, &c).norm();
    }
    faces.clear();
    Ok(())
}
