//! OBJ: lines `v x y z` and `f v/vt/vn …`; a negative index counts back from the last vertex so far.

use super::super::text::{TextFault, Words};
use super::{Place, SurfaceFault};
use crate::mesh::TriMesh;
use std::io::{self, Write};

/// Parses a file.
pub(super) fn read(bytes: &[u8]) -> Result<TriMesh, SurfaceFault> {
    let mut words = Words::new(bytes, true);
    let mut reader = Reader::default();
    while let Some(keyword) = words.word() {
        match keyword {
            b"v" => {
                if reader.mesh.points.len() >= u32::MAX as usize - 1 {
                    let value = reader.mesh.points.len() as i64;
                    let line = words.line();
                    return Err(TextFault::OutOfRange { line, what: "the count of points", value }.into());
                }
                // A weight or a colour may follow.
                reader.mesh.points.push(words.point_here()?);
            }
            b"f" => reader.read_face(&mut words)?,
            _ => {}
        }
        words.skip_line();
    }
    reader.finish()
}

/// A face that names a vertex which has not come yet.
struct Ahead {
    index: i64,
    face: usize,
    line: usize,
}

#[derive(Default)]
struct Reader {
    mesh: TriMesh,
    /// The face that names the vertex furthest ahead.
    ahead: Option<Ahead>,
}

impl Reader {
    fn read_face(&mut self, words: &mut Words) -> Result<(), SurfaceFault> {
        let face = self.mesh.triangles.len();
        let line = words.line();
        let mut triangle = [0; 3];
        let mut count = 0;
        while let Some(word) = words.word_here() {
            // A backslash continues the line.
            if word == b"\\" {
                words.skip_line();
                continue;
            }
            if count < 3 {
                let named = word.split(|&b| b == b'/').next().unwrap_or_default();
                let named = words.as_integer(named, "a corner of a face")?;
                triangle[count] = self.index(named, face, line)?;
            }
            count += 1;
        }
        if count != 3 {
            return Err(SurfaceFault::NotATriangle { face, corners: count as i64, place: Place::Line(line) });
        }
        self.mesh.triangles.push(triangle);
        Ok(())
    }

    fn index(&mut self, named: i64, face: usize, line: usize) -> Result<u32, SurfaceFault> {
        let points = self.mesh.points.len() as i64;
        let from_zero = if named < 0 { points.saturating_add(named) } else { named - 1 };
        if from_zero < 0 || from_zero >= i64::from(u32::MAX) {
            return Err(self.bad_index(&Ahead { index: named, face, line }));
        }
        if from_zero >= points && self.ahead.as_ref().is_none_or(|ahead| ahead.index < named) {
            self.ahead = Some(Ahead { index: named, face, line });
        }
        Ok(from_zero as u32)
    }

    fn bad_index(&self, &Ahead { index, face, line }: &Ahead) -> SurfaceFault {
        SurfaceFault::BadIndex { face, index, points: self.mesh.points.len(), first: 1, place: Place::Line(line) }
    }

    fn finish(self) -> Result<TriMesh, SurfaceFault> {
        match &self.ahead {
            Some(ahead) if ahead.index > self.mesh.points.len() as i64 => Err(self.bad_index(ahead)),
            _ => Ok(self.mesh),
        }
    }
}

pub(super) fn write(out: &mut impl Write, mesh: &TriMesh) -> io::Result<()> {
    for p in &mesh.points {
        writeln!(out, "v {:?} {:?} {:?}", p.x, p.y, p.z)?;
    }
    for [a, b, c] in &mesh.triangles {
        writeln!(out, "f {} {} {}", u64::from(*a) + 1, u64::from(*b) + 1, u64::from(*c) + 1)?;
    }
    Ok(())
}
