//! Reader of vertices and faces; other elements are skipped.

use super::data::Data;
use super::head::{PlyElement, parse};
use crate::surface::content::SurfaceContent;
use crate::surface::error::SurfaceFault;
use crate::surface::faces::Faces;
use anastomesh_mesh::geometry::Point3;

/// Names of integer properties that are read as markers of faces.
const MARKERS: [&[u8]; 7] = [b"marker", b"label", b"patch", b"group", b"region", b"ModelFaceID", b"boundary_marker"];

/// Parses a file.
pub(in crate::surface) fn read(bytes: &[u8]) -> Result<SurfaceContent, SurfaceFault> {
    let head = parse(bytes)?;
    let mut positions = Vec::new();
    let mut list = None;
    // Faces may precede the vertices, so their corners are checked against the announced number of points.
    let points = head.elements.iter().find(|e| e.name == b"vertex").map_or(0, |e| e.count);
    let points = usize::try_from(points).unwrap_or(usize::MAX).min(u32::MAX as usize - 1);
    let mut data = Data::new(bytes, &head);
    let mut vertices = false;
    for element in &head.elements {
        data.ensure_room(element)?;
        match element.name.as_slice() {
            b"vertex" if !vertices => {
                read_vertices(&mut data, element, &mut positions)?;
                vertices = true;
            }
            b"face" if list.is_none() => list = Some(read_faces(&mut data, element, points)?),
            _ => skip_items(&mut data, element)?,
        }
    }
    if !vertices {
        return Err(SurfaceFault::Missing { what: "the element 'vertex'" });
    }
    data.expect_end()?;
    let (faces, markers) = list.unwrap_or_else(|| (Faces::new(points, 0, 0), Vec::new()));
    Ok(faces.into_surface(positions)?.marked(markers))
}

fn skip_items(data: &mut Data, element: &PlyElement) -> Result<(), SurfaceFault> {
    // Items without properties occupy no bytes, whatever their count.
    let count = if element.properties.is_empty() { 0 } else { element.count };
    for _ in 0..count {
        for index in 0..element.properties.len() {
            skip_property(data, element, index)?;
        }
    }
    Ok(())
}

fn skip_property(data: &mut Data, element: &PlyElement, index: usize) -> Result<(), SurfaceFault> {
    let property = &element.properties[index];
    let count = match property.count {
        Some(kind) => data.list_count(kind)? as u64,
        None => 1,
    };
    data.skip(property.value, count)
}

fn read_vertices(data: &mut Data, element: &PlyElement, points: &mut Vec<Point3>) -> Result<(), SurfaceFault> {
    let mut columns = [0; 3];
    for (column, name) in columns.iter_mut().zip([b"x", b"y", b"z"]) {
        let found = element.property(&[name]).filter(|&i| element.properties[i].count.is_none());
        *column = found.ok_or(SurfaceFault::Missing { what: "one of the properties x, y, z of the vertices" })?;
    }
    points.reserve_exact(element.count as usize);
    for point in 0..element.count as usize {
        let mut position = Point3::origin();
        for (index, property) in element.properties.iter().enumerate() {
            match columns.iter().position(|&column| column == index) {
                Some(axis) => position[axis] = data.coordinate(property.value, point)?,
                None => skip_property(data, element, index)?,
            }
        }
        points.push(position);
    }
    Ok(())
}

/// Reads faces and their markers.
fn read_faces(data: &mut Data, element: &PlyElement, points: usize) -> Result<(Faces, Vec<i32>), SurfaceFault> {
    const MISSING: SurfaceFault = SurfaceFault::Missing { what: "the list vertex_indices of the faces" };
    let list = element.property(&[b"vertex_indices", b"vertex_index"]).ok_or(MISSING)?;
    let counted = element.properties[list].count.ok_or(MISSING)?;
    let is_marker = |i: &usize| element.properties[*i].count.is_none() && !element.properties[*i].value.is_float();
    let marker = element.property(&MARKERS).filter(is_marker);
    let mut faces = Faces::new(points, 0, element.count as usize);
    let mut markers = Vec::new();
    for _ in 0..element.count {
        for (index, property) in element.properties.iter().enumerate() {
            if Some(index) == marker {
                let place = data.place();
                let value = data.integer(property.value)?;
                let found = || SurfaceFault::unexpected(value.to_string().as_bytes(), "a marker within 32 bits", place);
                markers.push(i32::try_from(value).map_err(|_| found())?);
                continue;
            }
            if index != list {
                skip_property(data, element, index)?;
                continue;
            }
            let count = data.list_count(counted)?;
            let place = data.place();
            for _ in 0..count {
                let named = data.integer(property.value)?;
                faces.corner(named, place)?;
            }
            faces.end_face(place)?;
        }
    }
    Ok((faces, markers))
}
