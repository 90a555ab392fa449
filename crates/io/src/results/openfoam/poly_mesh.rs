//! Mesh of a case: faces with their areas and cells, and patches.

use super::data::Scanner;
use super::dictionary::{Entry, entries, header};
use crate::results::error::ResultFault;
use anastomesh_mesh::geometry::{Point3, Vec3};

/// Mesh of polyhedra.
#[derive(Debug, Default)]
pub(super) struct PolyMesh {
    /// Centres of the faces.
    pub centers: Vec<Point3>,
    /// Areas times unit normals, out of the owner.
    pub areas: Vec<Vec3>,
    pub owner: Vec<u32>,
    /// Cells beyond the inner faces, which are the first ones.
    pub neighbour: Vec<u32>,
    pub patches: Vec<FoamPatch>,
    pub cells: Vec<Point3>,
    pub volumes: Vec<f64>,
}

/// Consecutive faces of the boundary.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct FoamPatch {
    pub name: String,
    pub is_wall: bool,
    pub first: usize,
    pub count: usize,
}

/// Reads points.
pub(super) fn points(bytes: &[u8]) -> Result<Vec<Point3>, ResultFault> {
    let mut scanner = Scanner::new(bytes);
    header(&mut scanner)?;
    let count = scanner.count("a number of points")?;
    let values = scanner.floats(count, 3, "points")?;
    ResultFault::ensure_finite("points", &values)?;
    Ok(values.as_chunks::<3>().0.iter().map(|&p| Point3::from(p)).collect())
}

/// Reads cell numbers of faces.
pub(super) fn labels(bytes: &[u8], what: &'static str) -> Result<Vec<u32>, ResultFault> {
    let mut scanner = Scanner::new(bytes);
    header(&mut scanner)?;
    let labels = scanner.labels(what)?;
    let label = |index: i64| u32::try_from(index).map_err(|_| ResultFault::Astray { what, index, count: 0 });
    labels.into_iter().map(label).collect()
}

/// Reads faces: their points, one face after the other, and the end of each.
pub(super) fn faces(bytes: &[u8], points: usize) -> Result<(Vec<u32>, Vec<usize>), ResultFault> {
    let mut scanner = Scanner::new(bytes);
    let class = header(&mut scanner)?;
    let (mut corners, mut ends) = (Vec::new(), Vec::new());
    if class == "faceCompactList" {
        let offsets = scanner.labels("offsets of faces")?;
        corners = scanner.labels("faces")?;
        for pair in offsets.windows(2) {
            let end = usize::try_from(pair[1]).ok().filter(|&end| pair[0] <= pair[1] && end <= corners.len());
            let astray = || ResultFault::Astray { what: "an offset of faces", index: pair[1], count: corners.len() };
            ends.push(end.ok_or_else(astray)?);
        }
    } else {
        // Lists of labels within a list are text in these files.
        scanner.layout.binary = false;
        let count = scanner.count("a number of faces")?;
        scanner.need(b'(', "faces")?;
        for _ in 0..count {
            corners.extend(scanner.labels("a face")?);
            ends.push(corners.len());
        }
    }
    let checked = |index: i64| {
        let inside = u32::try_from(index).ok().filter(|&index| (index as usize) < points);
        inside.ok_or(ResultFault::Astray { what: "a face", index, count: points })
    };
    Ok((corners.into_iter().map(checked).collect::<Result<_, _>>()?, ends))
}

/// Reads the patches.
pub(super) fn patches(bytes: &[u8]) -> Result<Vec<FoamPatch>, ResultFault> {
    let mut scanner = Scanner::new(bytes);
    header(&mut scanner)?;
    let count = scanner.count("a number of patches")?;
    scanner.need(b'(', "patches")?;
    let mut patches = Vec::new();
    for _ in 0..count {
        let name = scanner.word().to_owned();
        scanner.need(b'{', "a patch")?;
        let patch = entries(&mut scanner, true, 1)?;
        let words = |key: &str| match patch.get(key) {
            Some(Entry::Words(words)) => words.as_str(),
            _ => "",
        };
        let number = |key: &str| {
            let missing = || ResultFault::Missing { what: format!("{key} of patch {name}") };
            words(key).parse::<usize>().map_err(|_| missing())
        };
        let (first, count, is_wall) = (number("startFace")?, number("nFaces")?, words("type") == "wall");
        patches.push(FoamPatch { name, is_wall, first, count });
    }
    scanner.need(b')', "the end of the patches")?;
    Ok(patches)
}

impl PolyMesh {
    /// Computes areas and volumes.
    pub(super) fn new(
        points: &[Point3],
        (corners, ends): &(Vec<u32>, Vec<usize>),
        owner: Vec<u32>,
        neighbour: Vec<u32>,
        patches: Vec<FoamPatch>,
    ) -> Result<Self, ResultFault> {
        ResultFault::ensure_length("owner", ends.len(), owner.len())?;
        let mut mesh = Self { owner, neighbour, patches, ..Self::default() };
        if mesh.neighbour.len() > ends.len() {
            return Err(ResultFault::Length {
                what: "neighbour".into(),
                expected: ends.len(),
                found: mesh.neighbour.len(),
            });
        }
        for patch in &mesh.patches {
            if patch.first.checked_add(patch.count).is_none_or(|end| end > ends.len()) {
                let index = patch.first as i64;
                return Err(ResultFault::Astray { what: "a patch", index, count: ends.len() });
            }
        }
        let mut start = 0;
        for &end in ends {
            let face: Vec<Point3> = corners[start..end].iter().map(|&p| points[p as usize]).collect();
            let (center, area) = measure(&face);
            mesh.centers.push(center);
            mesh.areas.push(area);
            start = end;
        }
        mesh.add_cells()?;
        Ok(mesh)
    }

    fn add_cells(&mut self) -> Result<(), ResultFault> {
        // More cells than faces would mean cells without faces.
        let faces = self.owner.len();
        for (what, cells) in [("owner", &self.owner), ("neighbour", &self.neighbour)] {
            if let Some(&cell) = cells.iter().find(|&&cell| cell as usize >= faces) {
                return Err(ResultFault::Astray { what, index: cell.into(), count: faces });
            }
        }
        let count = self.owner.iter().chain(&self.neighbour).max().map_or(0, |&cell| cell as usize + 1);
        let mut sums = vec![(Vec3::zeros(), 0.0_f64); count];
        self.each_side(|cell, face, _| {
            let sum = &mut sums[cell];
            (sum.0, sum.1) = (sum.0 + face.0.coords, sum.1 + 1.0);
        });
        let middles: Vec<Point3> = sums.iter().map(|(sum, number)| Point3::from(sum / number.max(1.0))).collect();
        let mut weighted = vec![(Vec3::zeros(), 0.0); count];
        self.each_side(|cell, (center, area), sign| {
            let volume = sign * (center - middles[cell]).dot(area) / 3.0;
            let centroid = 0.75 * center.coords + 0.25 * middles[cell].coords;
            let sum = &mut weighted[cell];
            (sum.0, sum.1) = (sum.0 + volume * centroid, sum.1 + volume);
        });
        let centroid = |((sum, volume), middle): (&(Vec3, f64), &Point3)| {
            if *volume > 0.0 { Point3::from(sum / *volume) } else { *middle }
        };
        self.cells = weighted.iter().zip(&middles).map(centroid).collect();
        self.volumes = weighted.iter().map(|(_, volume)| volume.max(0.0)).collect();
        Ok(())
    }

    /// Calls a function with the centre and area of each face of each cell; the sign is −1 if the area points inwards.
    fn each_side(&self, mut visit: impl FnMut(usize, (&Point3, &Vec3), f64)) {
        for (face, (center, area)) in self.centers.iter().zip(&self.areas).enumerate() {
            visit(self.owner[face] as usize, (center, area), 1.0);
            if let Some(&cell) = self.neighbour.get(face) {
                visit(cell as usize, (center, area), -1.0);
            }
        }
    }
}

/// Centre and area of a polygon, as the sum of triangles around the mean of its corners.
fn measure(corners: &[Point3]) -> (Point3, Vec3) {
    let middle = Point3::from(corners.iter().map(|p| p.coords).sum::<Vec3>() / corners.len().max(1) as f64);
    let (mut area, mut weighted, mut total) = (Vec3::zeros(), Vec3::zeros(), 0.0);
    for (i, a) in corners.iter().enumerate() {
        let b = &corners[(i + 1) % corners.len()];
        let part = 0.5 * (a - middle).cross(&(b - middle));
        let size = part.norm();
        area += part;
        weighted += size * (a.coords + b.coords + middle.coords) / 3.0;
        total += size;
    }
    let center = if total > 0.0 { Point3::from(weighted / total) } else { middle };
    (center, area)
}
