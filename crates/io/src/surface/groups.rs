//! Named groups of faces: solids of STL; groups, objects and materials of OBJ.

use rustc_hash::FxHashMap;

/// Names in the order of first use, and the current one of each face.
#[derive(Debug, Default)]
pub(super) struct Groups {
    names: Vec<String>,
    known: FxHashMap<String, u32>,
    current: Option<u32>,
    of_faces: Vec<u32>,
}

impl Groups {
    /// Begins a group, or continues one with the same name.
    pub(super) fn begin(&mut self, name: &[u8]) {
        let name = String::from_utf8_lossy(name.trim_ascii()).into_owned();
        let next = self.names.len() as u32;
        let group = *self.known.entry(name).or_insert_with_key(|name| {
            self.names.push(name.clone());
            next
        });
        self.current = Some(group);
    }

    /// Adds a face to the current group; faces before the first group are in one without a name.
    pub(super) fn add_face(&mut self) {
        if self.current.is_none() {
            self.begin(b"");
        }
        self.of_faces.extend(self.current);
    }

    /// True if there are several groups.
    pub(super) fn are_several(&self) -> bool {
        self.names.len() > 1
    }

    /// Group of each face, and the names of groups.
    pub(super) fn parts(&self) -> (&[u32], &[String]) {
        (&self.of_faces, &self.names)
    }
}
