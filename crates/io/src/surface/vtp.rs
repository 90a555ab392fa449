//! Polygons of VTK poly data (`.vtp`), with `SimVascular`'s face ids.

use super::content::SurfaceContent;
use super::error::SurfaceFault;
use super::faces::Faces;
use crate::text::Place;
use crate::vtk_xml::{DataArray, ElementId, VtkXml};
use anastomesh_mesh::geometry::Point3;

/// Integer arrays of cells that are read as markers, in order of preference.
const MARKERS: [&str; 6] = ["ModelFaceID", "patch", "CellEntityIds", "marker", "label", "region"];

/// Parses a file with one or several pieces. Other cells than polygons are skipped.
pub(super) fn read(bytes: &[u8]) -> Result<SurfaceContent, SurfaceFault> {
    let document = VtkXml::parse(bytes, "PolyData")?;
    let data =
        document.child(VtkXml::ROOT, "PolyData").ok_or(SurfaceFault::Missing { what: "the element PolyData" })?;
    let mut points = Vec::new();
    let mut polygons: Vec<Vec<i64>> = Vec::new();
    let mut markers = Vec::new();
    for piece in document.children(data, "Piece") {
        let first = points.len() as i64;
        read_points(&document, piece, &mut points)?;
        let faces = read_polygons(&document, piece)?;
        markers.extend(read_markers(&document, piece, faces.len())?);
        let shifted =
            |face: Vec<i64>| face.into_iter().map(|v| if v < 0 { v } else { v.saturating_add(first) }).collect();
        polygons.extend(faces.into_iter().map(shifted));
    }
    let mut faces = Faces::new(points.len(), 0, polygons.len());
    for corners in &polygons {
        corners.iter().try_for_each(|&corner| faces.corner(corner, Place::Byte(0)))?;
        faces.end_face(Place::Byte(0))?;
    }
    let content = faces.into_surface(points)?;
    // A piece without markers leaves all without.
    Ok(if markers.len() == polygons.len() { content.marked(markers) } else { content })
}

fn read_points(document: &VtkXml, piece: ElementId, points: &mut Vec<Point3>) -> Result<(), SurfaceFault> {
    let expected = document.count(piece, "NumberOfPoints")?.saturating_mul(3);
    let array = document.child(piece, "Points").and_then(|section| document.arrays(section).next());
    let values = match array {
        Some((_, array)) => document.read(array)?.into_floats(),
        None => Vec::new(),
    };
    if values.len() != expected {
        return Err(SurfaceFault::ArrayLength { array: "Points".into(), expected, found: values.len() });
    }
    let first = points.len();
    points.extend(values.as_chunks::<3>().0.iter().map(|&p| Point3::from(p)));
    match points[first..].iter().position(|p| !p.iter().all(|x| x.is_finite())) {
        Some(point) => Err(SurfaceFault::NotFinite { point: first + point, byte: 0 }),
        None => Ok(()),
    }
}

fn read_polygons(document: &VtkXml, piece: ElementId) -> Result<Vec<Vec<i64>>, SurfaceFault> {
    let count = document.count(piece, "NumberOfPolys")?;
    let Some(section) = document.child(piece, "Polys").filter(|_| count > 0) else { return Ok(Vec::new()) };
    let ints = |name: &'static str| {
        let array = document.arrays(section).find(|(found, _)| *found == name);
        let values = array.map(|(_, array)| document.read(array)).transpose()?.and_then(DataArray::into_ints);
        values.ok_or(SurfaceFault::Missing { what: name })
    };
    let (connectivity, offsets) = (ints("connectivity")?, ints("offsets")?);
    if offsets.len() != count {
        return Err(SurfaceFault::ArrayLength { array: "offsets".into(), expected: count, found: offsets.len() });
    }
    let mut start = 0;
    let mut polygons = Vec::with_capacity(count);
    for (face, &offset) in offsets.iter().enumerate() {
        let end = usize::try_from(offset).ok().filter(|&end| end >= start && end <= connectivity.len());
        let end = end.ok_or(SurfaceFault::BadOffset { face, offset, length: connectivity.len() })?;
        polygons.push(connectivity[start..end].to_vec());
        start = end;
    }
    Ok(polygons)
}

/// Markers of the polygons of a piece, which follow vertices and lines in its cell arrays.
fn read_markers(document: &VtkXml, piece: ElementId, polygons: usize) -> Result<Vec<i32>, SurfaceFault> {
    let Some(data) = document.child(piece, "CellData") else { return Ok(Vec::new()) };
    let before = document.count(piece, "NumberOfVerts")?.saturating_add(document.count(piece, "NumberOfLines")?);
    for name in MARKERS {
        let Some((_, array)) = document.arrays(data).find(|(found, _)| *found == name) else { continue };
        let Some(values) = document.read(array)?.into_ints() else { continue };
        let own = values.get(before..before.saturating_add(polygons));
        let found = values.len();
        let short =
            || SurfaceFault::ArrayLength { array: name.into(), expected: before.saturating_add(polygons), found };
        return Ok(own.ok_or_else(short)?.iter().map(|&value| value as i32).collect());
    }
    Ok(Vec::new())
}
