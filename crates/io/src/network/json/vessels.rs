//! Meshes of `Flows1D0D3D`: a list of vertices, and a list of vessels with the points of their axes.

use crate::network::content::{NetworkFile, NetworkNote, NetworkOptions, NodeNames};
use crate::network::polylines::{Polylines, Radii};
use anastomesh_mesh::geometry::Point3;
use anastomesh_mesh::units::counted;
use rustc_hash::FxHashMap;
use serde::Deserialize;
use serde_json::Value;

/// Errors of a list of vessels.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum VesselListError {
    /// An entry of a list has another form.
    #[error("entry {entry} of the list '{list}' (from 0): {source}; correct it")]
    Form {
        /// Name of the list.
        list: &'static str,
        /// Index of the entry, from 0.
        entry: usize,
        /// Error of the JSON reader.
        source: serde_json::Error,
    },
    /// Two vertices have an equal id.
    #[error("two vertices have the id {id}; ids must differ")]
    RepeatedVertex {
        /// Id in the file.
        id: i64,
    },
    /// A vessel ends at a vertex that does not exist.
    #[error("vessel {vessel} ends at vertex {vertex}, which is not in the list 'vertices'; correct it")]
    NoVertex {
        /// Id of the vessel.
        vessel: i64,
        /// Id of the vertex.
        vertex: i64,
    },
    /// A vessel has fewer than two points.
    #[error(
        "vessel {vessel} has {} in 'embedded_coordinates', and a mesh needs at least 2: a model without positions has no lumen",
        counted(*points, "point")
    )]
    Points {
        /// Id of the vessel.
        vessel: i64,
        /// Number of points.
        points: usize,
    },
    /// A vessel has another number of radii than of points.
    #[error(
        "vessel {vessel} has {}, and the list 'radii' has length {radii}: give one radius per point, or 'radius'",
        counted(*points, "point")
    )]
    Radii {
        /// Id of the vessel.
        vessel: i64,
        /// Number of points.
        points: usize,
        /// Number of radii.
        radii: usize,
    },
    /// Values of nodes are requested.
    #[error("lists of vessels have no node arrays, so '{wanted}' does not exist; node arrays: none")]
    NoNodeArrays {
        /// Requested name.
        wanted: String,
    },
    /// The number of nodes exceeds the index range.
    #[error("too many nodes for 32-bit indices ({})", u32::MAX)]
    TooMany,
}

#[derive(Deserialize)]
struct Vertex {
    id: i64,
}

#[derive(Deserialize)]
struct Vessel {
    id: i64,
    left_vertex_id: i64,
    right_vertex_id: i64,
    #[serde(default)]
    embedded_coordinates: Vec<[f64; 3]>,
    #[serde(default)]
    radius: Option<f64>,
    #[serde(default)]
    radii: Vec<f64>,
}

impl Vessel {
    /// Radius at a point; `None` if the file has none.
    fn radius(&self, point: usize) -> Option<f64> {
        self.radii.get(point).copied().or(self.radius)
    }

    fn check(&self) -> Result<(), VesselListError> {
        let (points, radii) = (self.embedded_coordinates.len(), self.radii.len());
        if points < 2 {
            return Err(VesselListError::Points { vessel: self.id, points });
        }
        if radii != 0 && radii != points {
            return Err(VesselListError::Radii { vessel: self.id, points, radii });
        }
        Ok(())
    }
}

/// True if a JSON object is a mesh of `Flows1D0D3D`.
pub(super) fn is_vessel_list(whole: &Value) -> bool {
    let list = |name| whole.get(name).and_then(Value::as_array);
    list("vertices").is_some()
        && list("vessels").is_some_and(|vessels| vessels.first().is_some_and(|v| v.get("left_vertex_id").is_some()))
}

/// Reads vertices and vessels. The widest vessel at a vertex sets its position. Other vessels that end elsewhere are
/// joined to it by an edge.
pub(super) fn read(whole: &Value, options: &NetworkOptions) -> Result<NetworkFile, VesselListError> {
    if let Some(wanted) = &options.node_array {
        return Err(VesselListError::NoNodeArrays { wanted: wanted.clone() });
    }
    let vertices: Vec<Vertex> = entries(whole, "vertices")?;
    let vessels: Vec<Vessel> = entries(whole, "vessels")?;
    let mut rows = FxHashMap::default();
    for (row, vertex) in vertices.iter().enumerate() {
        if rows.insert(vertex.id, row).is_some() {
            return Err(VesselListError::RepeatedVertex { id: vertex.id });
        }
    }
    let ends = vessels.iter().map(|vessel| {
        vessel.check()?;
        let row = |vertex| rows.get(&vertex).copied().ok_or(VesselListError::NoVertex { vessel: vessel.id, vertex });
        Ok([row(vessel.left_vertex_id)?, row(vessel.right_vertex_id)?])
    });
    let ends: Vec<[usize; 2]> = ends.collect::<Result<_, VesselListError>>()?;
    build(&vertices, &vessels, &ends)
}

/// All entries of a list.
fn entries<T: for<'a> Deserialize<'a>>(whole: &Value, list: &'static str) -> Result<Vec<T>, VesselListError> {
    let values = whole.get(list).and_then(Value::as_array).into_iter().flatten();
    let form = |entry| move |source| VesselListError::Form { list, entry, source };
    values.enumerate().map(|(entry, value)| T::deserialize(value).map_err(form(entry))).collect()
}

fn build(vertices: &[Vertex], vessels: &[Vessel], ends: &[[usize; 2]]) -> Result<NetworkFile, VesselListError> {
    let mut points = positions(vertices.len(), vessels, ends);
    let mut names: Vec<String> = vertices.iter().map(|vertex| vertex.id.to_string()).collect();
    let (mut path, mut corners, mut path_ends) = (Vec::new(), Vec::new(), Vec::new());
    for (vessel, ends) in vessels.iter().zip(ends) {
        let last = vessel.embedded_coordinates.len() - 1;
        let mut push = |node: usize, point: usize| {
            path.push(node as u32);
            corners.push(vessel.radius(point).unwrap_or(0.0));
        };
        for (i, &[x, y, z]) in vessel.embedded_coordinates.iter().enumerate() {
            let at = Point3::new(x, y, z);
            let end = (i == 0).then_some(ends[0]).or((i == last).then_some(ends[1]));
            if end.is_some_and(|vertex| points[vertex] == at) {
                push(end.unwrap_or_default(), i);
                continue;
            }
            if i == 0 {
                push(ends[0], i);
            }
            points.push(at);
            names.push(format!("point {i} of vessel {}", vessel.id));
            push(points.len() - 1, i);
            if i == last {
                push(ends[1], i);
            }
        }
        path_ends.push(path.len());
    }
    let polylines = Polylines { points, ends: path_ends, path };
    let has_radii = vessels.iter().all(|vessel| vessel.radius(0).is_some());
    let note = if has_radii { NetworkNote::EdgeRadii { array: "radius".into() } } else { NetworkNote::NoRadii };
    let mut network = NetworkFile { notes: vec![note], names: NodeNames::Words(names), ..NetworkFile::default() };
    if !polylines.fits(&network.skeleton) {
        return Err(VesselListError::TooMany);
    }
    let radii = Radii { corners: has_radii.then_some(corners), ..Radii::default() };
    polylines.append_to(&mut network.skeleton, &radii);
    Ok(network)
}

/// Positions of the vertices: the end of the widest vessel.
fn positions(vertices: usize, vessels: &[Vessel], ends: &[[usize; 2]]) -> Vec<Point3> {
    let mut points = vec![Point3::origin(); vertices];
    let mut widest = vec![f64::NEG_INFINITY; vertices];
    for (vessel, ends) in vessels.iter().zip(ends) {
        let last = vessel.embedded_coordinates.len() - 1;
        for (vertex, point) in ends.iter().copied().zip([0, last]) {
            let radius = vessel.radius(point).unwrap_or(0.0);
            if radius > widest[vertex] {
                widest[vertex] = radius;
                points[vertex] = Point3::from(vessel.embedded_coordinates[point]);
            }
        }
    }
    points
}
