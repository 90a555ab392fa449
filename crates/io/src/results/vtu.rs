//! Reader of `svMultiPhysics`' results: tetrahedra with velocity and pressure at their nodes.

use super::content::{FlowResult, InnerFlux, Near, OuterFlux};
use super::error::ResultFault;
use crate::volume::{MeshFormat, read_mesh_from};
use crate::vtk_xml::VtkXml;
use anastomesh_mesh::TetMesh;
use anastomesh_mesh::adjacency::{NONE, face_vertices, tet_adjacency};
use anastomesh_mesh::geometry::{Point3, Vec3};

/// Largest speed of nodes on a wall, relative to the largest speed.
const STILL: f64 = 1e-9;

/// Fields at the nodes.
struct Fields {
    velocity: Vec<Vec3>,
    pressure: Vec<f64>,
    /// Magnitude of the wall shear stress.
    shear: Option<Vec<f64>>,
}

pub(super) fn read(bytes: &[u8], name: &str) -> Result<FlowResult, ResultFault> {
    let mesh = read_mesh_from(bytes, MeshFormat::Vtu)?.volume.mesh;
    let nodes = mesh.points.len();
    if let Some(&index) = mesh.tets.iter().flatten().find(|&&node| node as usize >= nodes) {
        return Err(ResultFault::Astray { what: "a cell", index: index.into(), count: nodes });
    }
    let fields = Fields::read(bytes, nodes)?;
    let mut result = FlowResult { name: name.to_owned(), is_nodal: true, ..FlowResult::default() };
    for tet in &mesh.tets {
        let corners = tet.map(|node| mesh.points[node as usize]);
        result.cells.push(center(&corners));
        let [u, v, w] = [1, 2, 3].map(|i| corners[i] - corners[0]);
        result.volumes.push(u.cross(&v).dot(&w).abs() / 6.0);
        result.pressures.push(tet.iter().map(|&node| fields.pressure[node as usize]).sum::<f64>() / 4.0);
    }
    fields.add_faces(&mesh, &mut result);
    if !result.outer.iter().any(|face| face.is_wall) {
        return Err(ResultFault::NoWall { found: "no boundary face has zero velocity".into() });
    }
    Ok(result)
}

fn center<const N: usize>(corners: &[Point3; N]) -> Point3 {
    Point3::from(corners.iter().map(|p| p.coords).sum::<Vec3>() / N as f64)
}

impl Fields {
    fn read(bytes: &[u8], nodes: usize) -> Result<Self, ResultFault> {
        let xml = VtkXml::parse(bytes, "UnstructuredGrid")?;
        let field = |name: &str, components: usize| -> Result<Option<Vec<f64>>, ResultFault> {
            let mut values = Vec::new();
            let grid = xml.child(VtkXml::ROOT, "UnstructuredGrid");
            for piece in grid.into_iter().flat_map(|grid| xml.children(grid, "Piece")) {
                let Some(data) = xml.child(piece, "PointData") else { return Ok(None) };
                let Some((_, array)) = xml.arrays(data).find(|(found, _)| *found == name) else { return Ok(None) };
                values.extend(xml.read(array)?.into_floats());
            }
            ResultFault::ensure_length(&format!("array {name}"), components * nodes, values.len())?;
            ResultFault::ensure_finite(&format!("array {name}"), &values)?;
            Ok(Some(values))
        };
        let required =
            |name: &str, components| field(name, components)?.ok_or(ResultFault::Missing { what: name.to_owned() });
        let vectors = |values: &[f64]| values.as_chunks::<3>().0.iter().map(|&v| Vec3::from(v)).collect::<Vec<_>>();
        let velocity = vectors(&required("Velocity", 3)?);
        let pressure = required("Pressure", 1)?;
        let shear = field("WSS", 3)?.map(|values| vectors(&values).iter().map(Vec3::norm).collect());
        Ok(Self { velocity, pressure, shear })
    }

    fn add_faces(&self, mesh: &TetMesh, result: &mut FlowResult) {
        let adjacency = tet_adjacency(&mesh.tets, mesh.points.len());
        let fastest = self.velocity.iter().fold(0.0, |most: f64, velocity| most.max(velocity.norm()));
        for handle in 0..4 * mesh.tets.len() as u32 {
            let (tet, other) = (handle / 4, adjacency.neighbors[(handle / 4) as usize][(handle % 4) as usize]);
            if other != NONE && other / 4 < tet {
                continue;
            }
            let nodes = face_vertices(&mesh.tets, handle).map(|node| node as usize);
            let corners = nodes.map(|node| mesh.points[node]);
            let area = 0.5 * (corners[1] - corners[0]).cross(&(corners[2] - corners[0]));
            let opposite = mesh.tets[tet as usize][(handle % 4) as usize] as usize;
            let offset = mesh.points[opposite] - corners[0];
            // Outwards, whatever the orientation of the tetrahedron.
            let area = if area.dot(&offset) > 0.0 { -area } else { area };
            let mean = nodes.iter().map(|&node| self.velocity[node]).sum::<Vec3>() / 3.0;
            if other != NONE {
                result.inner.push(InnerFlux { cells: [tet, other / 4], flux: mean.dot(&area) });
                continue;
            }
            let is_wall = nodes.iter().all(|&node| self.velocity[node].norm() <= STILL * fastest);
            let shear = self.shear.as_ref().filter(|_| is_wall);
            result.outer.push(OuterFlux {
                cell: tet,
                center: center(&corners),
                area,
                flux: mean.dot(&area),
                pressure: nodes.iter().map(|&node| self.pressure[node]).sum::<f64>() / 3.0,
                is_wall,
                shear: shear.map(|shear| nodes.iter().map(|&node| shear[node]).sum::<f64>() / 3.0),
                near: Near::of(&self.velocity[opposite], &offset, &area),
            });
        }
    }
}
