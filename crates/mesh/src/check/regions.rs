//! Conditions on regions and the faces between them.
//!
//! The boundary of a region consists of its outer faces and its interfaces. It is checked as that of a mesh of its own.

use super::cells::{self, face_offender};
use super::labels::{LABEL_LINES, cap_lines, face_at, labels_match, own_patch};
use super::result::{self, Expectation, Line, LineResult, Offender, OffenderKind, RegionCounts, Skipped, Tally};
use super::surface::Boundary;
use crate::adjacency::TetAdjacency;
use crate::progress::Progress;
use crate::quality::volume6;
use crate::region::{RegionFace, faces_with};
use crate::{NamedRegion, Patch, TetMesh, VolumeMesh, WALL, face_key, same_turn};
use rustc_hash::FxHashMap;
use std::collections::BTreeMap;

/// Mesh with regions during a check.
pub(super) struct RegionCheck<'a> {
    volume: &'a VolumeMesh,
    regions: &'a [NamedRegion],
    /// Outer faces and interfaces.
    faces: Vec<RegionFace>,
    /// Number of components of each region.
    components: BTreeMap<i32, usize>,
    /// Place of each outer face and interface in `faces`.
    places: FxHashMap<[u32; 3], u32>,
    /// Number of places where each region touches itself, once [`Self::lines`] has counted them.
    touches: BTreeMap<i32, u64>,
}

impl<'a> RegionCheck<'a> {
    pub(super) fn of(volume: &'a VolumeMesh, regions: &'a [NamedRegion], adjacency: &TetAdjacency) -> Self {
        let faces = faces_with(&volume.mesh.tets, &volume.tet_block, adjacency);
        let components = components(volume, adjacency);
        let places = faces.iter().map(|face| face_key(face.vertices)).zip(0..).collect();
        Self { volume, regions, faces, components, places, touches: BTreeMap::new() }
    }

    fn lumen(&self) -> Option<i32> {
        NamedRegion::id_of(self.regions, NamedRegion::LUMEN)
    }

    /// Face at these vertices, if it bounds a region.
    fn face(&self, vertices: [u32; 3]) -> Option<&RegionFace> {
        self.places.get(&face_key(vertices)).map(|&place| &self.faces[place as usize])
    }

    /// Faces on the boundary of a region, oriented out of it.
    fn faces_of(&self, id: i32) -> Vec<[u32; 3]> {
        let of_region = |face: &RegionFace| {
            let [a, b, c] = face.vertices;
            let beyond = face.beyond.is_some_and(|(_, region)| region == id).then_some([a, c, b]);
            if face.region == id { Some([a, b, c]) } else { beyond }
        };
        self.faces.iter().filter_map(of_region).collect()
    }

    /// Ids of tetrahedra and of the list of regions, ascending.
    fn ids(&self) -> Vec<i32> {
        let mut ids: Vec<i32> = self.components.keys().copied().chain(self.regions.iter().map(|r| r.id)).collect();
        ids.sort_unstable();
        ids.dedup();
        ids
    }

    /// Compares the components of the lumen with those of the skeleton.
    pub(super) fn components(&self, expectation: Option<&Expectation>) -> LineResult {
        match self.lumen() {
            None if expectation.is_some() => LineResult::skipped(Line::Components, Skipped::NoLumen),
            id => result::components(expectation, id.and_then(|id| self.components.get(&id)).copied().unwrap_or(0)),
        }
    }

    /// Compares the genus of the lumen with the loops of the skeleton.
    pub(super) fn loops(&self, expectation: Option<&Expectation>) -> LineResult {
        let Some(expected) = expectation else {
            return LineResult::skipped(Line::Loops, Skipped::NoExpectation);
        };
        let Some(id) = self.lumen() else {
            return LineResult::skipped(Line::Loops, Skipped::NoLumen);
        };
        let faces = self.faces_of(id);
        let boundary = Boundary::new(&self.volume.mesh.points, &faces);
        if boundary.manifold_lines().iter().any(LineResult::fails) {
            return LineResult::skipped(Line::Loops, Skipped::Because(Line::RegionBoundaries));
        }
        boundary.loops(&expected.loops)
    }

    /// Conditions on labels: those of the outer faces, and of the lumen's wall and caps. `outer` is the real boundary.
    pub(super) fn labels(&self, outer: &[[u32; 3]], expectation: Option<&Expectation>) -> Vec<LineResult> {
        let volume = self.volume;
        if volume.boundary.is_empty() {
            return LABEL_LINES.map(|line| LineResult::skipped(line, Skipped::NoLabels)).into();
        }
        let inside = self.inside();
        let listed = (0..volume.boundary.len()).filter(|&i| !inside[i]).map(|i| volume.boundary[i]).collect();
        let mut lines = vec![labels_match(&of_labels(listed, Vec::new(), volume), outer)];
        let readable = volume.boundary.as_flattened().iter().all(|&v| (v as usize) < volume.mesh.points.len());
        let skipped = match self.lumen() {
            None => Some(Skipped::NoLumen),
            Some(_) if !readable => Some(Skipped::Because(Line::LabelsMatchBoundary)),
            Some(_) => None,
        };
        if let Some(why) = skipped {
            let rest = LABEL_LINES[1..].iter().filter(|line| **line != Line::OwnPatch);
            lines.extend(rest.map(|&line| LineResult::skipped(line, why)));
            lines.push(own_patch(&volume.patches));
            return lines;
        }
        lines.extend(cap_lines(&self.lumen_boundary(), expectation));
        lines
    }

    /// True for each labelled face inside the mesh.
    fn inside(&self) -> Vec<bool> {
        let mut sides: FxHashMap<[u32; 3], u8> = self.volume.boundary.iter().map(|&face| (face_key(face), 0)).collect();
        for tet in &self.volume.mesh.tets {
            for side in crate::TET_FACES {
                if let Some(count) = sides.get_mut(&face_key(side.map(|corner| tet[corner]))) {
                    *count = count.saturating_add(1);
                }
            }
        }
        self.volume.boundary.iter().map(|&face| sides.get(&face_key(face)).is_some_and(|&count| count > 1)).collect()
    }

    /// Labelled boundary of the lumen, whose interfaces without a cap are wall.
    fn lumen_boundary(&self) -> VolumeMesh {
        let volume = self.volume;
        let Some(id) = self.lumen() else { return VolumeMesh::default() };
        let is_wall = |patch: &&Patch| patch.cap.is_none() && patch.name.starts_with(NamedRegion::INTERFACE);
        let walls: Vec<i32> = volume.patches.iter().filter(is_wall).map(|patch| patch.id).collect();
        let (mut faces, mut patches) = (Vec::new(), Vec::new());
        for (&face, &patch) in volume.boundary.iter().zip(&volume.boundary_patch) {
            let Some(found) = self.face(face) else { continue };
            let is_interface = found.beyond.is_some_and(|(_, region)| region == id);
            if found.region != id && !is_interface {
                continue;
            }
            let [a, b, c] = face;
            faces.push(if is_interface { [a, c, b] } else { face });
            patches.push(if walls.contains(&patch) { WALL } else { patch });
        }
        of_labels(faces, patches, volume)
    }

    /// Conditions on the regions. In a mesh without expectation, regions may touch themselves, and no interface need be
    /// labelled.
    pub(super) fn lines(&mut self, is_expected: bool, progress: &dyn Progress) -> [LineResult; 5] {
        let [boundaries, intersections] = self.boundaries(is_expected, progress);
        let [sides, labelled] = self.interfaces(is_expected);
        [self.named(), boundaries, intersections, sides, labelled]
    }

    /// Finds tetrahedra outside all named regions, and regions without tetrahedra.
    fn named(&self) -> LineResult {
        let mut tally = Tally::new(Line::RegionsNamed);
        let mut known: Vec<i32> = self.regions.iter().map(|region| region.id).collect();
        known.sort_unstable();
        let TetMesh { points, tets } = &self.volume.mesh;
        for (i, tet) in tets.iter().enumerate() {
            let region = self.volume.tet_block.get(i).copied().unwrap_or(0);
            if known.binary_search(&region).is_err() {
                let place = cells::centroid(points, tet);
                tally.add(|| Offender::new(OffenderKind::Tet, &[i as u32], Some(place)));
            }
        }
        for region in self.regions.iter().filter(|region| !self.components.contains_key(&region.id)) {
            let ids = vec![i64::from(region.id)];
            tally.add(|| Offender { kind: OffenderKind::Region, ids, position: None });
        }
        tally.done()
    }

    /// Checks the boundary of each region as that of a mesh, and counts the places where it touches itself.
    fn boundaries(&mut self, is_expected: bool, progress: &dyn Progress) -> [LineResult; 2] {
        let mut manifold = Tally::new(Line::RegionBoundaries);
        let mut intersections = Tally::new(Line::RegionIntersections);
        for id in self.ids() {
            let faces = self.faces_of(id);
            let boundary = Boundary::new(&self.volume.mesh.points, &faces);
            let lines = boundary.manifold_lines();
            let is_closed = !lines[0].fails();
            intersections.add_all(boundary.self_intersections(is_closed, progress).0);
            self.touches.insert(id, lines.iter().map(|line| line.count).sum());
            for line in lines {
                manifold.add_all(line);
            }
        }
        let manifold = manifold.done();
        [if is_expected { manifold } else { manifold.may_touch() }, intersections.done()]
    }

    /// Checks the labels of faces inside the mesh, and that no interface lacks one.
    fn interfaces(&self, is_expected: bool) -> [LineResult; 2] {
        let volume = self.volume;
        if volume.boundary.is_empty() {
            return [Line::InterfaceSides, Line::InterfacesLabelled].map(|l| LineResult::skipped(l, Skipped::NoLabels));
        }
        let points = &volume.mesh.points;
        let (mut sides, mut labelled) = (Tally::new(Line::InterfaceSides), Tally::new(Line::InterfacesLabelled));
        let pairs = self.pairs();
        let mut count = vec![0_u8; self.faces.len()];
        for (i, (&face, inside)) in volume.boundary.iter().zip(self.inside()).enumerate() {
            let place = self.places.get(&face_key(face)).map(|&place| place as usize);
            let found = place.map(|place| &self.faces[place]);
            let regions = found.and_then(|found| Some([found.region, found.beyond?.1]));
            let pair = volume.boundary_patch.get(i).and_then(|patch| pairs.get(patch));
            // Faces that are neither inside nor on the boundary belong to another condition.
            if (inside && regions.is_none()) || (found.is_some() && pair.is_some_and(|pair| regions != Some(*pair))) {
                sides.add(|| face_at(points, face));
            }
            let (Some(place), Some([own, _])) = (place, regions) else { continue };
            count[place] = count[place].saturating_add(1);
            let block = volume.boundary_block.get(i).copied().unwrap_or(own);
            if count[place] > 1 || block != own || !same_turn(face, self.faces[place].vertices) {
                labelled.add(|| face_at(points, face));
            }
        }
        let labels_none = count.iter().all(|&count| count == 0) && !is_expected;
        let interfaces = || self.faces.iter().zip(&count).filter(|(face, _)| face.beyond.is_some());
        if labels_none && interfaces().count() > 0 {
            return [sides.done(), LineResult::skipped(Line::InterfacesLabelled, Skipped::NoInterfaces)];
        }
        for (face, _) in interfaces().filter(|(_, count)| **count == 0) {
            labelled.add(|| face_offender(points, face.vertices));
        }
        [sides.done(), labelled.done()]
    }

    /// Regions of the patches that are named after two regions, the smaller id first.
    fn pairs(&self) -> FxHashMap<i32, [i32; 2]> {
        let pair = |patch: &Patch| Some((patch.id, NamedRegion::pair_of(self.regions, &patch.name)?));
        self.volume.patches.iter().filter_map(pair).collect()
    }

    /// Sizes of all regions.
    pub(super) fn counts(&self) -> Vec<RegionCounts> {
        let TetMesh { points, tets } = &self.volume.mesh;
        let mut sizes: BTreeMap<i32, (usize, f64)> = BTreeMap::new();
        for (i, tet) in tets.iter().enumerate() {
            let region = self.volume.tet_block.get(i).copied().unwrap_or(0);
            let [a, b, c, d] = tet.map(|v| &points[v as usize]);
            let (count, volume) = sizes.entry(region).or_default();
            (*count, *volume) = (*count + 1, *volume + volume6(a, b, c, d) / 6.0);
        }
        let counts = |id: i32| {
            let (tets, volume) = sizes.get(&id).copied().unwrap_or_default();
            RegionCounts {
                id,
                name: NamedRegion::name_of(self.regions, id),
                tets,
                components: self.components.get(&id).copied().unwrap_or(0),
                boundary_faces: self.faces_of(id).len(),
                touches: self.touches.get(&id).copied().unwrap_or(0),
                volume,
            }
        };
        self.ids().into_iter().map(counts).collect()
    }
}

/// Number of components of each region: tetrahedra of a region connected by faces.
fn components(volume: &VolumeMesh, adjacency: &TetAdjacency) -> BTreeMap<i32, usize> {
    let of = |tet: u32| volume.tet_block.get(tet as usize).copied().unwrap_or(0);
    let mut components = BTreeMap::new();
    for tet in cells::components(adjacency, of) {
        *components.entry(of(tet)).or_default() += 1;
    }
    components
}

/// Mesh without tetrahedra that has these labelled faces.
fn of_labels(boundary: Vec<[u32; 3]>, boundary_patch: Vec<i32>, volume: &VolumeMesh) -> VolumeMesh {
    VolumeMesh {
        mesh: TetMesh { points: volume.mesh.points.clone(), tets: Vec::new() },
        boundary,
        boundary_patch,
        patches: volume.patches.clone(),
        ..VolumeMesh::default()
    }
}

#[cfg(test)]
#[path = "regions_tests.rs"]
mod tests;
