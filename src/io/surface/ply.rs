//! PLY: elements with properties in any order; the vertices' `x`, `y`, `z` and the faces' `vertex_indices` are taken,
//! all others passed over.

use super::super::text::{TextFault, Words};
use super::faces::Faces;
use super::ply_head::{Element, Encoding, Head, Scalar, parse};
use super::{Place, SurfaceContent, SurfaceFault};
use crate::geometry::Point3;
use crate::mesh::TriMesh;
use std::io::{self, Write};

/// Parses a file.
pub(super) fn read(bytes: &[u8]) -> Result<SurfaceContent, SurfaceFault> {
    let head = parse(bytes)?;
    let mut positions = Vec::new();
    let mut list = None;
    // Faces may stand before the vertices: their corners are compared with the number of points that is announced.
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
    list.unwrap_or_else(|| Faces::new(points, 0, 0)).into_surface(positions)
}

/// The numbers behind the head.
enum Data<'a> {
    Text(Words<'a>),
    Binary { bytes: &'a [u8], at: usize, big: bool },
}

impl<'a> Data<'a> {
    fn new(bytes: &'a [u8], head: &Head) -> Self {
        if head.encoding == Encoding::Text {
            Self::Text(Words::from_line(&bytes[head.end..], head.line))
        } else {
            Self::Binary { bytes, at: head.end, big: head.encoding == Encoding::Big }
        }
    }

    fn place(&self) -> Place {
        match self {
            Self::Text(words) => Place::Line(words.line()),
            Self::Binary { at, .. } => Place::Byte(*at),
        }
    }

    /// Refuses an element that cannot fit into the rest of the file.
    fn ensure_room(&self, element: &Element) -> Result<(), SurfaceFault> {
        let (encoding, rest) = match self {
            Self::Text(words) => (Encoding::Text, words.rest() as u64 + 1),
            Self::Binary { bytes, at, .. } => (Encoding::Little, (bytes.len() - at) as u64),
        };
        let needed = element.count.saturating_mul(element.least(encoding) as u64);
        if needed <= rest && element.count < u64::from(u32::MAX) {
            return Ok(());
        }
        match self {
            Self::Text(words) => {
                let count = i64::try_from(element.count).unwrap_or(i64::MAX);
                Err(TextFault::CountTooLarge { line: words.line(), what: "the count of an element", count }.into())
            }
            Self::Binary { bytes, at, .. } => {
                Err(SurfaceFault::Length { announced: needed.saturating_add(*at as u64), found: bytes.len() as u64 })
            }
        }
    }

    /// The next number; integers of all types are exact in it.
    #[inline]
    fn number(&mut self, kind: Scalar) -> Result<f64, SurfaceFault> {
        match self {
            Self::Text(words) => {
                let word = words.need("a number")?;
                Ok(words.as_float(word, "a number")?)
            }
            Self::Binary { bytes, at, big } => {
                let end = *at + kind.size();
                let Some(taken) = bytes.get(*at..end) else {
                    return Err(SurfaceFault::Length { announced: end as u64, found: bytes.len() as u64 });
                };
                *at = end;
                Ok(decode(taken, kind, *big))
            }
        }
    }

    /// The next number, which has to be an integer.
    fn integer(&mut self, kind: Scalar) -> Result<i64, SurfaceFault> {
        if let Self::Text(words) = self {
            return Ok(words.integer("an integer")?);
        }
        let place = self.place();
        let value = self.number(kind)?;
        if value.fract() == 0.0 && value.abs() < 1e15 {
            return Ok(value as i64);
        }
        Err(SurfaceFault::Unexpected { found: format!("{value:?}"), expected: "an integer", place })
    }

    /// The next coordinate.
    fn coordinate(&mut self, kind: Scalar, point: usize) -> Result<f64, SurfaceFault> {
        if let Self::Text(words) = self {
            return Ok(words.finite("a coordinate")?);
        }
        let Place::Byte(byte) = self.place() else { return Err(SurfaceFault::Missing { what: "a coordinate" }) };
        let value = self.number(kind)?;
        if value.is_finite() { Ok(value) } else { Err(SurfaceFault::NotFinite { point, byte }) }
    }

    /// The count of a list.
    fn list_count(&mut self, kind: Scalar) -> Result<i64, SurfaceFault> {
        let place = self.place();
        let count = self.integer(kind)?;
        if count >= 0 {
            return Ok(count);
        }
        Err(SurfaceFault::Unexpected { found: count.to_string(), expected: "the count of a list", place })
    }

    /// Passes over numbers.
    fn skip(&mut self, kind: Scalar, count: u64) -> Result<(), SurfaceFault> {
        match self {
            Self::Text(words) => {
                for _ in 0..count {
                    words.need("a number")?;
                }
            }
            Self::Binary { bytes, at, .. } => {
                let end = count.saturating_mul(kind.size() as u64).saturating_add(*at as u64);
                if end > bytes.len() as u64 {
                    return Err(SurfaceFault::Length { announced: end, found: bytes.len() as u64 });
                }
                *at = end as usize;
            }
        }
        Ok(())
    }

    fn expect_end(&mut self) -> Result<(), SurfaceFault> {
        match self {
            Self::Text(words) => Ok(words.expect_end()?),
            // Some programs end the last line of a binary file, too.
            Self::Binary { bytes, at, .. } if bytes[*at..].trim_ascii().is_empty() => Ok(()),
            Self::Binary { bytes, at, .. } => {
                Err(SurfaceFault::Length { announced: *at as u64, found: bytes.len() as u64 })
            }
        }
    }
}

/// A number of a binary file; zero when the bytes are too few, which the caller excludes.
fn decode(taken: &[u8], kind: Scalar, big: bool) -> f64 {
    let mut low = [0_u8; 8];
    for (i, slot) in low[..taken.len()].iter_mut().enumerate() {
        *slot = if big { taken[taken.len() - 1 - i] } else { taken[i] };
    }
    let bits = u64::from_le_bytes(low);
    match kind {
        Scalar::I8 => f64::from(bits as i8),
        Scalar::U8 => f64::from(bits as u8),
        Scalar::I16 => f64::from(bits as i16),
        Scalar::U16 => f64::from(bits as u16),
        Scalar::I32 => f64::from(bits as i32),
        Scalar::U32 => f64::from(bits as u32),
        Scalar::F32 => f64::from(f32::from_bits(bits as u32)),
        Scalar::F64 => f64::from_bits(bits),
    }
}

fn skip_items(data: &mut Data, element: &Element) -> Result<(), SurfaceFault> {
    // Items without properties are not in the file, however many there are.
    let count = if element.properties.is_empty() { 0 } else { element.count };
    for _ in 0..count {
        for index in 0..element.properties.len() {
            skip_property(data, element, index)?;
        }
    }
    Ok(())
}

fn skip_property(data: &mut Data, element: &Element, index: usize) -> Result<(), SurfaceFault> {
    let property = &element.properties[index];
    let count = match property.count {
        Some(kind) => data.list_count(kind)? as u64,
        None => 1,
    };
    data.skip(property.value, count)
}

fn read_vertices(data: &mut Data, element: &Element, points: &mut Vec<Point3>) -> Result<(), SurfaceFault> {
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

fn read_faces(data: &mut Data, element: &Element, points: usize) -> Result<Faces, SurfaceFault> {
    const MISSING: SurfaceFault = SurfaceFault::Missing { what: "the list vertex_indices of the faces" };
    let list = element.property(&[b"vertex_indices", b"vertex_index"]).ok_or(MISSING)?;
    let counted = element.properties[list].count.ok_or(MISSING)?;
    let mut faces = Faces::new(points, 0, element.count as usize);
    for _ in 0..element.count {
        for (index, property) in element.properties.iter().enumerate() {
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
    Ok(faces)
}

/// Writes binary, little endian, with doubles.
pub(super) fn write(out: &mut impl Write, mesh: &TriMesh) -> io::Result<()> {
    // Some programs know no unsigned indices.
    let index = if i32::try_from(mesh.points.len()).is_ok() { "int" } else { "uint" };
    write!(
        out,
        "ply\nformat binary_little_endian 1.0\ncomment anastomesh\nelement vertex {}\n\
         property double x\nproperty double y\nproperty double z\nelement face {}\n\
         property list uchar {index} vertex_indices\nend_header\n",
        mesh.points.len(),
        mesh.triangles.len()
    )?;
    for value in mesh.points.iter().flat_map(Point3::iter) {
        out.write_all(&value.to_le_bytes())?;
    }
    for triangle in &mesh.triangles {
        out.write_all(&[3])?;
        for corner in triangle {
            out.write_all(&corner.to_le_bytes())?;
        }
    }
    Ok(())
}
