//! Reader of edge lengths at the points or in the cells of an earlier mesh.

use super::error::{ResultError, ResultFault};
use crate::file::{FileError, read_bytes};
use crate::vtk_xml::{ElementId, VtkXml};
use anastomesh_mesh::geometry::{Point3, Vec3};
use std::path::Path;

/// VTK's types of cells with a volume: tetrahedra, hexahedra, prisms, pyramids, of first and second order.
const SOLID: [i64; 11] = [10, 11, 12, 13, 14, 24, 25, 26, 27, 29, 32];

/// Reads edge lengths from an array of a VTK unstructured grid (`.vtu`): points with their lengths. The values of a cell
/// array belong to the centres of the cells that have a volume.
///
/// # Errors
/// The file cannot be read, it has no such array, or a value is not a length: one finite number above zero.
pub fn read_lengths(path: &Path, array: &str) -> Result<(Vec<Point3>, Vec<f64>), ResultError> {
    let bytes = read_bytes(path)?;
    Ok(lengths(&bytes, array).map_err(FileError::content(path))?)
}

fn lengths(bytes: &[u8], array: &str) -> Result<(Vec<Point3>, Vec<f64>), ResultFault> {
    let xml = VtkXml::parse(bytes, "UnstructuredGrid")?;
    let grid = xml.child(VtkXml::ROOT, "UnstructuredGrid").ok_or_else(|| missing("UnstructuredGrid"))?;
    let (mut points, mut lengths) = (Vec::new(), Vec::new());
    for piece in xml.children(grid, "Piece") {
        let (places, values) = Piece { xml: &xml, piece }.lengths(array)?;
        points.extend(places);
        lengths.extend(values);
    }
    if points.is_empty() {
        return Err(missing("Points"));
    }
    Ok((points, lengths))
}

fn missing(what: &str) -> ResultFault {
    ResultFault::Missing { what: what.to_owned() }
}

/// A piece of the grid.
struct Piece<'a> {
    xml: &'a VtkXml<'a>,
    piece: ElementId,
}

impl Piece<'_> {
    fn lengths(&self, array: &str) -> Result<(Vec<Point3>, Vec<f64>), ResultFault> {
        let points = self.points()?;
        if let Some(values) = self.values("PointData", array)? {
            ResultFault::ensure_length(&format!("array {array}"), points.len(), values.len())?;
            ensure_lengths(array, values.iter().copied().enumerate())?;
            return Ok((points, values));
        }
        let values = self.values("CellData", array)?.ok_or_else(|| self.no_array(array))?;
        let centers = self.centers(&points)?;
        ResultFault::ensure_length(&format!("array {array}"), centers.len(), values.len())?;
        let solid = || centers.iter().zip(&values).enumerate().filter_map(|(i, (c, &v))| c.map(|c| (i, c, v)));
        ensure_lengths(array, solid().map(|(i, _, value)| (i, value)))?;
        Ok(solid().map(|(_, center, value)| (center, value)).unzip())
    }

    fn points(&self) -> Result<Vec<Point3>, ResultFault> {
        let list = self.xml.child(self.piece, "Points").ok_or_else(|| missing("Points"))?;
        let (_, array) = self.xml.arrays(list).next().ok_or_else(|| missing("Points"))?;
        let values = self.xml.read(array)?.into_floats();
        ResultFault::ensure_finite("Points", &values)?;
        Ok(values.as_chunks::<3>().0.iter().map(|&p| Point3::from(p)).collect())
    }

    /// Values of a scalar array; `None` if there is no such array.
    fn values(&self, section: &str, name: &str) -> Result<Option<Vec<f64>>, ResultFault> {
        let Some(data) = self.xml.child(self.piece, section) else { return Ok(None) };
        let Some((_, element)) = self.xml.arrays(data).find(|(found, _)| *found == name) else { return Ok(None) };
        let array = self.xml.read(element)?;
        match array.components {
            1 => Ok(Some(array.into_floats())),
            components => Err(ResultFault::NotScalar { array: name.to_owned(), components }),
        }
    }

    /// Centre of each cell; `None` for cells without a volume.
    fn centers(&self, points: &[Point3]) -> Result<Vec<Option<Point3>>, ResultFault> {
        let [nodes, ends, types] = [self.cells("connectivity")?, self.cells("offsets")?, self.cells("types")?];
        ResultFault::ensure_length("types", ends.len(), types.len())?;
        let astray = |index, count| ResultFault::Astray { what: "a cell", index, count };
        let mut from = 0;
        let mut center = |(&end, kind): (&i64, &i64)| {
            let to = usize::try_from(end).map_err(|_| astray(end, nodes.len()))?;
            let ids = nodes.get(from..to).ok_or_else(|| astray(end, nodes.len()))?;
            from = to;
            let corner = |&id: &i64| {
                let point = usize::try_from(id).ok().and_then(|id| points.get(id));
                point.map(|p| p.coords).ok_or_else(|| astray(id, points.len()))
            };
            let sum = ids.iter().map(corner).sum::<Result<Vec3, ResultFault>>()?;
            let is_solid = SOLID.contains(kind) && !ids.is_empty();
            Ok(is_solid.then(|| Point3::from(sum / ids.len() as f64)))
        };
        ends.iter().zip(&types).map(&mut center).collect()
    }

    fn cells(&self, name: &str) -> Result<Vec<i64>, ResultFault> {
        let cells = self.xml.child(self.piece, "Cells").ok_or_else(|| missing("Cells"))?;
        let (_, array) = self.xml.arrays(cells).find(|(found, _)| *found == name).ok_or_else(|| missing(name))?;
        self.xml.read(array)?.into_ints().ok_or_else(|| missing(name))
    }

    fn no_array(&self, array: &str) -> ResultFault {
        let sections = ["PointData", "CellData"].into_iter().filter_map(|name| self.xml.child(self.piece, name));
        let found = sections.flat_map(|section| self.xml.arrays(section)).map(|(name, _)| format!("'{name}'"));
        ResultFault::NoArray { array: array.to_owned(), found: found.collect() }
    }
}

/// Checks that values are lengths; each has its index in the file.
fn ensure_lengths(array: &str, mut values: impl Iterator<Item = (usize, f64)>) -> Result<(), ResultFault> {
    match values.find(|(_, value)| !(*value > 0.0 && value.is_finite())) {
        Some((index, value)) => Err(ResultFault::NotALength { array: array.to_owned(), number: index + 1, value }),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A tetrahedron and one of its faces, with a value at points and one in cells.
    fn grid(at_points: &str, in_cells: &str) -> String {
        let array =
            |kind, name, values| format!("<DataArray type='{kind}' Name='{name}' format='ascii'>{values}</DataArray>");
        let points =
            "<DataArray type='Float64' NumberOfComponents='3' format='ascii'>0 0 0 4 0 0 0 4 0 0 0 4</DataArray>";
        let cells = [("connectivity", "0 1 2 3 0 1 2"), ("offsets", "4 7"), ("types", "10 5")];
        let cells: String = cells.iter().map(|(name, values)| array("Int64", *name, *values)).collect();
        format!(
            "<VTKFile type='UnstructuredGrid'><UnstructuredGrid><Piece NumberOfPoints='4' NumberOfCells='2'>\
            <Points>{points}</Points><Cells>{cells}</Cells>\
            <PointData>{}</PointData><CellData>{}</CellData></Piece></UnstructuredGrid></VTKFile>",
            array("Float64", "p", at_points),
            array("Float64", "c", in_cells),
        )
    }

    #[test]
    fn lengths_belong_to_points_or_to_centres_of_solid_cells() {
        let file = grid("1 2 3 4", "0.5 0");
        let (points, lengths) = lengths(file.as_bytes(), "p").expect("lengths");
        assert_eq!((points[1], lengths), (Point3::new(4.0, 0.0, 0.0), vec![1.0, 2.0, 3.0, 4.0]));
        assert_eq!(
            super::lengths(file.as_bytes(), "c").expect("lengths"),
            (vec![Point3::new(1.0, 1.0, 1.0)], vec![0.5])
        );
    }

    #[test]
    fn other_arrays_and_values_are_named() {
        let text = |file: String, array| lengths(file.as_bytes(), array).expect_err("bad").to_string();
        assert!(text(grid("1 2 3 4", "1 1"), "h").contains("'p', 'c'"));
        assert!(text(grid("1 2 -3 4", "1 1"), "p").contains("-3 (number 3)"));
        assert!(text(grid("1 2 3 4", "nan 1"), "c").contains("number 1"));
        assert!(text(grid("1 2 3", "1 1"), "p").contains("length 3 instead of 4"));
        let vectors = grid("1 2 3 4", "1 1").replace("Name='p'", "Name='p' NumberOfComponents='2'");
        assert!(text(vectors, "p").contains("2 components"));
        assert!(text(grid("1 2 3 4", "1 1").replace("0 1 2 3 0", "0 1 9 3 0"), "c").contains("refers to 9"));
    }
}
