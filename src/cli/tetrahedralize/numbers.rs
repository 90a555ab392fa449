//! Numbers of triangles and points in the file. They differ from indices if polygons were triangulated, points were merged,
//! or the format counts from 1.

use anastomesh_tet::parts::Names;

/// Items with numbers in a file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Counted {
    /// Faces and points.
    #[default]
    Faces,
    /// Facets and points.
    Facets,
    /// Triangles with unshared corners: corner `k` of triangle `t` has the number 3 `t` + `k`.
    Corners,
}

/// Numbers of the triangles and points of an input in its file.
#[derive(Clone, Debug, Default)]
pub struct FileNumbers {
    pub counted: Counted,
    /// Number of the first face and of the first point.
    pub first: u32,
    /// Face of each triangle, from 0; empty if equal to the triangle.
    pub face_of: Vec<u32>,
    /// Point of the file for each point, from 0; empty if equal.
    pub point_of: Vec<u32>,
    /// True if faces may have been cut into several triangles.
    pub cut: bool,
}

impl FileNumbers {
    /// Renumbers after a repair: `triangles` and `points` are the old ids of the new ones.
    pub fn select(&mut self, triangles: &[u32], points: &[u32]) {
        self.face_of = triangles.iter().map(|&i| old(&self.face_of, i)).collect();
        self.point_of = points.iter().map(|&i| old(&self.point_of, i)).collect();
    }

    /// Noun for triangles in messages.
    pub fn triangles_of(&self) -> &'static str {
        match (self.counted, self.cut) {
            (Counted::Facets, _) => "triangles of the facets",
            (Counted::Faces, true) => "triangles of the faces",
            _ => "triangles",
        }
    }

    /// Text on the numbering of triangles and points in a message.
    pub fn legend(&self, triangles: bool, points: bool) -> String {
        let faces = match (self.counted, self.cut) {
            (Counted::Facets, _) => Some("facets"),
            (Counted::Faces, true) => Some("faces"),
            _ => None,
        };
        let pieces = match faces {
            Some(faces) if triangles => format!("triangles have the numbers of their {faces}; "),
            _ => String::new(),
        };
        let items = match (self.counted, triangles, points) {
            (_, false, false) => return String::new(),
            (Counted::Corners, false, true) => "corners of triangles".into(),
            (_, false, true) => "points".into(),
            (Counted::Corners, true, _) | (_, true, false) => faces.unwrap_or("triangles").into(),
            (_, true, true) => format!("{} and points", faces.unwrap_or("triangles")),
        };
        let corners = match self.counted {
            Counted::Corners if points => ", point 3 t + k is corner k of triangle t",
            _ => "",
        };
        format!(" ({pieces}{items} count from {}, as in the file{corners})", self.first)
    }
}

impl Names for FileNumbers {
    fn point(&self, id: u32) -> u32 {
        old(&self.point_of, id).saturating_add(self.first)
    }

    fn triangle(&self, id: u32) -> u32 {
        old(&self.face_of, id).saturating_add(self.first)
    }

    fn seed(&self, index: u32) -> u32 {
        index.saturating_add(self.first)
    }
}

/// Entry of a list that is empty if it maps every id to itself.
fn old(list: &[u32], id: u32) -> u32 {
    list.get(id as usize).copied().unwrap_or(id)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_go_back_to_the_file() {
        let mut numbers = FileNumbers { first: 1, ..FileNumbers::default() };
        assert_eq!((numbers.triangle(4), numbers.point(7)), (5, 8));
        assert_eq!(numbers.legend(true, true), " (triangles and points count from 1, as in the file)");
        (numbers.face_of, numbers.cut) = (vec![0, 0, 1, 2, 2], true);
        numbers.select(&[1, 3, 4], &[0, 2]);
        assert_eq!([0, 1, 2].map(|t| numbers.triangle(t)), [1, 3, 3]);
        assert_eq!([0, 1].map(|v| numbers.point(v)), [1, 3]);
        numbers.select(&[2], &[1]);
        assert_eq!((numbers.triangle(0), numbers.point(0)), (3, 3));
        let said = numbers.legend(true, false);
        assert_eq!(said, " (triangles have the numbers of their faces; faces count from 1, as in the file)");
        assert_eq!(numbers.legend(false, false), "");
    }
}
