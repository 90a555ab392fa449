//! Several surfaces as one facet complex.

use super::input::Input;
use super::numbers::FileNumbers;
use anastomesh_mesh::geometry::place_key;
use rustc_hash::{FxHashMap, FxHashSet};
use std::path::Path;

/// Joins surfaces. Equal points of different files become one. Each file is a marker, named like the file, or has one
/// marker per marker of its own. A triangle that several files have stays once, with the marker of the first.
pub fn join(parts: Vec<Input>) -> Input {
    let mut all = Input { marked: true, ..Input::default() };
    let mut point_of_place: FxHashMap<_, u32> = FxHashMap::default();
    let mut known_faces: FxHashSet<[u32; 3]> = FxHashSet::default();
    let (mut before, mut faces_before) = (0, 0);
    let (mut point_of, mut face_of) = (Vec::new(), Vec::new());
    for part in parts {
        let names = markers(&part, &mut all);
        let own: Vec<u32> = part
            .plc
            .surface
            .points
            .iter()
            .zip(before..)
            .map(|(p, i)| {
                *point_of_place.entry(place_key(p)).or_insert_with(|| {
                    all.plc.surface.points.push(*p);
                    point_of.push(i);
                    all.plc.surface.points.len() as u32 - 1
                })
            })
            .collect();
        for (i, triangle) in part.plc.surface.triangles.iter().enumerate() {
            let triangle = triangle.map(|v| own[v as usize]);
            let mut key = triangle;
            key.sort_unstable();
            if known_faces.insert(key) {
                all.plc.surface.triangles.push(triangle);
                all.plc.markers.push(names(i));
                face_of.push(faces_before + i as u32);
            }
        }
        before += part.plc.surface.points.len() as u32;
        faces_before += part.plc.surface.triangles.len() as u32;
        let file = part.files.first().map(|path| path.display().to_string()).unwrap_or_default();
        all.notes.extend(part.notes.iter().map(|note| format!("{file}: {note}")));
        all.files.extend(part.files);
    }
    all.numbers = FileNumbers { face_of, point_of, ..FileNumbers::default() };
    all
}

/// Adds the markers of a file to those of all. Returns the marker of each of its triangles.
fn markers(part: &Input, all: &mut Input) -> impl Fn(usize) -> i32 + use<> {
    let stem = part.files.first().and_then(|path: &std::path::PathBuf| Path::new(path).file_stem());
    let stem = stem.map_or_else(|| "surface".into(), |stem| stem.to_string_lossy().into_owned());
    let mut own: Vec<i32> = part.plc.markers.clone();
    own.sort_unstable();
    own.dedup();
    let first = all.names.len() as i32 + 1;
    let name = |marker: &i32| {
        let named = part.names.iter().find(|named| named.0 == *marker);
        named.map_or_else(|| format!("{stem}_{marker}"), |named| format!("{stem}_{}", named.1))
    };
    let names: Vec<String> = if own.is_empty() { vec![stem.clone()] } else { own.iter().map(name).collect() };
    all.names.extend((first..).zip(names));
    let of_triangles = part.plc.markers.clone();
    move |i| match of_triangles.get(i) {
        Some(marker) => first + own.binary_search(marker).unwrap_or(0) as i32,
        None => first,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use anastomesh_mesh::{Point3, TriMesh};

    fn square(z: f64, file: &str) -> Input {
        let points = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)].map(|(x, y)| Point3::new(x, y, z)).to_vec();
        let plc = TriMesh { points, triangles: vec![[0, 1, 2], [0, 2, 3]] }.into();
        Input { plc, files: vec![file.into()], ..Input::default() }
    }

    #[test]
    fn files_are_markers_and_share_points() {
        let mut marked = square(1.0, "b.stl");
        marked.plc.markers = vec![5, 3];
        marked.names = vec![(5, "lid".into())];
        let mut again = square(0.0, "c.off");
        again.plc.surface.triangles[1] = [1, 2, 3];
        let all = join(vec![square(0.0, "x/a.off"), marked, again]);
        assert_eq!((all.plc.surface.points.len(), all.plc.surface.triangles.len()), (8, 5));
        assert_eq!(all.plc.markers, [1, 1, 3, 2, 4]);
        let names: Vec<&str> = all.names.iter().map(|(_, name)| name.as_str()).collect();
        assert_eq!(names, ["a", "b_3", "b_lid", "c"]);
        assert_eq!(all.numbers.face_of, [0, 1, 2, 3, 5]);
    }
}
