//! Temporary file of boundary faces and their tetrahedra, which are computed once and read several times.

use anastomesh_mesh::faces::{Faces, OuterFace};
use anastomesh_mesh::progress::{Progress, ask};
use anastomesh_mesh::source::MeshSource;
use std::fs::File;
use std::io::{self, BufWriter, Read, Seek, Write};
use std::path::Path;

/// File of faces.
pub(super) struct Spool(File);

/// Bytes per face, and number of faces per read.
const FACE: usize = 20;
const AT_A_TIME: usize = 1 << 14;

impl Spool {
    /// Computes all faces and stores them on the disk of `beside`.
    pub(super) fn of(mesh: &dyn MeshSource, beside: &Path, progress: &dyn Progress) -> io::Result<Self> {
        let folder = beside.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let mut file = tempfile::tempfile_in(folder)?;
        let put = |file: &mut BufWriter<&File>, outer: &[OuterFace]| {
            ask(progress)?;
            for OuterFace { patch, tet, vertices: [a, b, c] } in outer {
                for word in [patch.cast_unsigned(), *tet, *a, *b, *c] {
                    file.write_all(&word.to_le_bytes())?;
                }
            }
            Ok(())
        };
        let mut out = BufWriter::with_capacity(1 << 18, &file);
        let all = Faces::each_own(mesh, |outer| put(&mut out, outer))?;
        out.flush()?;
        drop(out);
        if !all {
            // Sorted by tetrahedron nevertheless.
            file.rewind()?;
            file.set_len(0)?;
            let mut out = BufWriter::with_capacity(1 << 18, &file);
            Faces::of(mesh)?.each(|faces| put(&mut out, &faces.outer))?;
            out.flush()?;
        }
        Ok(Self(file))
    }

    /// Calls `each` with batches of all faces, in order.
    pub(super) fn each(&self, mut each: impl FnMut(&[OuterFace]) -> io::Result<()>) -> io::Result<()> {
        let mut file = &self.0;
        file.rewind()?;
        let mut bytes = Vec::with_capacity(FACE * AT_A_TIME);
        loop {
            bytes.clear();
            file.take((FACE * AT_A_TIME) as u64).read_to_end(&mut bytes)?;
            if bytes.is_empty() {
                return Ok(());
            }
            let (faces, _) = bytes.as_chunks::<FACE>();
            each(&faces.iter().map(face_of).collect::<Vec<_>>())?;
        }
    }
}

fn face_of(bytes: &[u8; FACE]) -> OuterFace {
    let word = |i: usize| u32::from_le_bytes([bytes[4 * i], bytes[4 * i + 1], bytes[4 * i + 2], bytes[4 * i + 3]]);
    OuterFace { patch: word(0).cast_signed(), tet: word(1), vertices: [word(2), word(3), word(4)] }
}
