//! Reader that converts edges and their points to polylines.

use super::error::AmiraError;
use super::sections::{AmiraArray, AmiraSections, Of};
use crate::network::content::{NetworkFile, NetworkOptions};
use crate::network::polylines::{Polylines, Radii};
use crate::network::radii::Choice;
use anastomesh_mesh::geometry::Point3;

pub(in crate::network) fn read(bytes: &[u8], options: &NetworkOptions) -> Result<NetworkFile, AmiraError> {
    let sections = AmiraSections::of(bytes)?;
    if sections.count(Of::Edges) == 0 {
        return Err(AmiraError::Missing { what: "EDGE" });
    }
    let scalars = |of: Of| -> Vec<String> {
        let of_kind = sections.arrays.iter().filter(|a| a.of == of && a.components == 1);
        of_kind.map(|a| a.name.clone()).collect()
    };
    // Radii on edge points have priority; an array on vertices alone has no values for points between.
    let choice = Choice::of(&scalars(Of::Points), &scalars(Of::Edges), options)?;
    let values = |of: Of, name: Option<&str>| {
        let name = name?;
        let array = sections.arrays.iter().find(|a| a.of == of && a.components == 1 && a.name == name)?;
        Some((array, choice.radii(name, array.values.clone())))
    };
    let along = values(Of::Points, choice.points.as_deref());
    let lines = values(Of::Edges, choice.cells.as_deref());
    for (array, radii) in along.iter().chain(&lines) {
        full(&sections, array, radii.len())?;
    }
    let (polylines, corners) = polylines(&sections, along.as_ref().map(|(_, r)| r.as_slice()))?;
    let mut network = NetworkFile { notes: choice.notes(), ..NetworkFile::default() };
    if !polylines.fits(&network.skeleton) {
        return Err(AmiraError::TooMany);
    }
    let radii = Radii { nodes: None, lines: lines.map(|(_, radii)| radii), corners };
    polylines.append_to(&mut network.skeleton, &radii);
    Ok(network)
}

/// Checks that an array has all its values.
fn full(sections: &AmiraSections, array: &AmiraArray, found: usize) -> Result<(), AmiraError> {
    if found == sections.count(array.of) { Ok(()) } else { Err(AmiraError::Missing { what: "complete radius data" }) }
}

/// Edges as polylines, with the radii along them. Vertices are the first points. Edge points follow, except the ends of
/// each edge, which coincide with its vertices.
fn polylines(sections: &AmiraSections, along: Option<&[f64]>) -> Result<(Polylines, Option<Vec<f64>>), AmiraError> {
    let places = |values: &[f64]| -> Vec<Point3> { values.as_chunks::<3>().0.iter().map(|&p| p.into()).collect() };
    let mut points = places(sections.find(Of::Vertices, "VertexCoordinates", 3)?);
    let course = places(sections.find(Of::Points, "EdgePointCoordinates", 3)?);
    let ends = sections.find(Of::Edges, "EdgeConnectivity", 2)?.as_chunks::<2>().0;
    let counts = sections.find(Of::Edges, "NumEdgePoints", 1)?;
    let vertices = points.len();
    let differ = |found: usize| AmiraError::PointsDiffer { expected: course.len(), found };
    let (mut path, mut line_ends, mut corners) = (Vec::new(), Vec::new(), along.map(|_| Vec::new()));
    let mut start = 0_usize;
    for (edge, (&[a, b], &count)) in ends.iter().zip(counts).enumerate() {
        let vertex = |v: f64| {
            let known = v >= 0.0 && v.fract() == 0.0 && v < vertices as f64;
            let vertex = v as i64;
            if known { Ok(v as u32) } else { Err(AmiraError::UnknownVertex { edge, vertex, vertices }) }
        };
        let (a, b) = (vertex(a)?, vertex(b)?);
        let end = start.saturating_add(count.max(0.0) as usize);
        let inside = course.get(start..end).ok_or_else(|| differ(end))?;
        let first = usize::from(inside.first().is_some_and(|p| *p == points[a as usize]));
        let last = inside.len() - usize::from(inside.len() > first && inside.last() == Some(&points[b as usize]));
        path.push(a);
        path.extend((first..last).map(|i| (points.len() + i - first) as u32));
        path.push(b);
        points.extend_from_slice(&inside[first..last]);
        line_ends.push(path.len());
        if let (Some(corners), Some(along)) = (&mut corners, along) {
            add_corners(corners, &along[start..end], first..last);
        }
        start = end;
    }
    if start != course.len() {
        return Err(differ(start));
    }
    Ok((Polylines { points, ends: line_ends, path }, corners))
}

/// Appends the radii along an edge: at its first vertex, at the kept points, and at its last vertex.
fn add_corners(corners: &mut Vec<f64>, along: &[f64], kept: std::ops::Range<usize>) {
    // An edge without points has no radius.
    corners.push(along.first().copied().unwrap_or(f64::NAN));
    corners.extend_from_slice(&along[kept]);
    corners.push(along.last().copied().unwrap_or(f64::NAN));
}
