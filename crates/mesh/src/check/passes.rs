//! Validity check of a mesh with regions in passes over its parts, without loading all of it.
//!
//! # Correctness
//!
//! Three facts are checked.
//!
//! 1. Every tetrahedron is positive by the exact predicate.
//! 2. For every region, the faces of its tetrahedra, with their orientation, add up to its labelled faces: outer faces, and
//!    interfaces from their own side. Faces of opposite orientation cancel. The sums are those of two 64-bit hashes of the
//!    vertices, so that a difference is missed with a probability of 2^-128.
//! 3. Take a region together with all regions that have a smaller id. Their common boundary is a closed 2-manifold without
//!    self-intersections, and none of its surfaces lies inside another with the same orientation. This holds for every region.
//!
//! By 2 and 3, the winding number of the boundary of these regions together is 0 or 1 everywhere. By 1, it is the number of their
//! tetrahedra at a place. So no tetrahedra overlap, no face has more than two, and those of two are on opposite sides. Equal points
//! would be in overlapping tetrahedra, or on a boundary that intersects itself.
//!
//! The conditions on the network hold for the lumen, and are taken from its own check.

use super::parts::id_sums;
use super::result::{CheckReport, Counts, Line, LineResult, Offender, OffenderKind, RegionCounts, Skipped, Tally};
use super::surface::Boundary;
use crate::geometry::predicates::{MAX_MAGNITUDE, orient3d};
use crate::geometry::{DisjointSets, Point3};
use crate::progress::{Progress, Stage, ask};
use crate::quality::{QualitySum, Spokes, volume6};
use crate::region::NamedRegion;
use crate::source::{FacePiece, MeshSource, TetPiece};
use crate::{Patch, TET_FACES};
use rustc_hash::{FxHashMap, FxHashSet};
use std::io;

/// Checks a mesh whose regions are consecutive parts, by ascending id. `lumen` is the report on the lumen alone.
///
/// # Errors
/// Errors of reading the mesh. Cancellation.
pub fn check_regions_in_passes(
    mesh: &dyn MeshSource,
    regions: &[NamedRegion],
    lumen: &CheckReport,
    progress: &dyn Progress,
) -> io::Result<CheckReport> {
    let mut check = Passes::new(mesh, regions, progress);
    let unnamed = check.faces()?;
    check.tetrahedra(&unnamed)?;
    drop(unnamed);
    check.labels()?;
    check.compare();
    let surfaces = check.surfaces()?;
    Ok(check.report(lumen, surfaces))
}

/// Sum of oriented faces.
type Chain = [u64; 2];

fn add(chain: &mut Chain, face: [u32; 3], is_reversed: bool) {
    let [a, b, c] = face;
    let mut key = face;
    key.sort_unstable();
    // Odd permutations of the ascending order have the opposite sign.
    let is_odd = key != [a, b, c] && key != [b, c, a] && key != [c, a, b];
    for (sum, term) in chain.iter_mut().zip(id_sums(key)) {
        *sum = if is_odd == is_reversed { sum.wrapping_add(term) } else { sum.wrapping_sub(term) };
    }
}

/// Sizes of a region, and the sum of the faces of its tetrahedra.
#[derive(Clone, Copy, Debug, Default)]
struct RegionSum {
    tets: usize,
    volume: f64,
    chain: Chain,
}

/// Result of a part's tetrahedra.
#[derive(Default)]
struct PartSum {
    regions: FxHashMap<i32, RegionSum>,
    quality: QualitySum,
    repeated: Vec<u32>,
    flat: Vec<(u32, Point3)>,
    /// Tetrahedra, and the region of each.
    tets: Vec<[u32; 4]>,
    of_tets: Vec<i32>,
    /// Faces on no named interface that the tetrahedra have from the other side, with their region.
    beyond: Vec<([u32; 3], i32)>,
}

/// Face with its smallest vertex first, so that equal faces of one orientation have equal vertices.
fn oriented([a, b, c]: [u32; 3]) -> [u32; 3] {
    [a, b, c].min([b, c, a]).min([c, a, b])
}

struct Passes<'a> {
    mesh: &'a dyn MeshSource,
    regions: &'a [NamedRegion],
    progress: &'a dyn Progress,
    /// Regions on both sides of the interfaces with a patch.
    pairs: FxHashMap<i32, [i32; 2]>,
    /// Region beyond each face on no named interface that tetrahedra have from the other side.
    beyond: FxHashMap<[u32; 3], i32>,
    /// Sum of the labelled faces of each region, and their number.
    labelled: FxHashMap<i32, (Chain, usize)>,
    sums: FxHashMap<i32, RegionSum>,
    components: FxHashMap<i32, usize>,
    /// Components of all regions together.
    joined: usize,
    quality: QualitySum,
    tallies: FxHashMap<Line, Tally>,
}

/// Results for the boundary of some regions together.
struct SurfaceLines {
    faces: usize,
    surfaces: usize,
    lines: Vec<LineResult>,
}

impl<'a> Passes<'a> {
    fn new(mesh: &'a dyn MeshSource, regions: &'a [NamedRegion], progress: &'a dyn Progress) -> Self {
        let pair = |patch: &Patch| Some((patch.id, NamedRegion::pair_of(regions, &patch.name)?));
        Self {
            mesh,
            regions,
            progress,
            pairs: mesh.patches().iter().filter_map(pair).collect(),
            beyond: FxHashMap::default(),
            labelled: FxHashMap::default(),
            sums: FxHashMap::default(),
            components: FxHashMap::default(),
            joined: 0,
            quality: QualitySum::default(),
            tallies: FxHashMap::default(),
        }
    }

    fn tally(&mut self, line: Line) -> &mut Tally {
        self.tallies.entry(line).or_insert_with(|| Tally::new(line))
    }

    /// Region under each labelled face of a piece, and that beyond it.
    fn sides(&self, piece: &FacePiece) -> Vec<(i32, Option<i32>)> {
        let at = |values: &[i32], i: usize| values.get(i).copied().unwrap_or(0);
        let pair = |(i, face): (usize, &[u32; 3])| {
            let own = at(&piece.blocks, i);
            let other = |[a, b]: &[i32; 2]| if *a == own { *b } else { *a };
            let named = self.pairs.get(&at(&piece.patches, i)).map(other);
            (own, named.or_else(|| self.beyond.get(&oriented(*face)).copied()))
        };
        piece.faces.iter().enumerate().map(pair).collect()
    }

    /// Returns the faces on no named interface. Tests the others for the region under them.
    fn faces(&mut self) -> io::Result<FxHashSet<[u32; 3]>> {
        let (mut wrong, mut unnamed) = (Vec::new(), FxHashSet::default());
        self.mesh.each_faces(|piece| {
            ask(self.progress)?;
            for (i, &face) in piece.faces.iter().enumerate() {
                match piece.patches.get(i).and_then(|patch| self.pairs.get(patch)) {
                    None => {
                        unnamed.insert(oriented(face));
                    }
                    Some(pair) if piece.blocks.get(i) != Some(&pair[0]) => wrong.push(face),
                    Some(_) => {}
                }
            }
            Ok(())
        })?;
        for face in wrong {
            self.tally(Line::InterfaceSides).add(|| Offender::new(OffenderKind::Face, &face, None));
        }
        Ok(unnamed)
    }

    /// Adds up the labelled faces.
    fn labels(&mut self) -> io::Result<()> {
        let mut labelled: FxHashMap<i32, (Chain, usize)> = FxHashMap::default();
        self.mesh.each_faces(|piece| {
            ask(self.progress)?;
            for (&face, (own, beyond)) in piece.faces.iter().zip(self.sides(piece)) {
                for (region, is_reversed) in [(Some(own), false), (beyond, true)] {
                    if let Some(region) = region {
                        let (chain, count) = labelled.entry(region).or_default();
                        add(chain, face, is_reversed);
                        *count += 1;
                    }
                }
            }
            Ok(())
        })?;
        self.labelled = labelled;
        Ok(())
    }

    /// Checks the tetrahedra, and adds up their faces. Finds the regions beyond faces on no named interface.
    fn tetrahedra(&mut self, unnamed: &FxHashSet<[u32; 3]>) -> io::Result<()> {
        let counts = self.mesh.counts();
        let mut unused = vec![true; counts.points];
        let mut sets = RegionSets::new(counts.points);
        let (mut first, mut seen) = (0_usize, FxHashMap::<i32, RegionSum>::default());
        let mesh = self.mesh;
        let (mut quality, mut repeated, mut flat) = (QualitySum::default(), Vec::new(), Vec::new());
        let progress = self.progress;
        let mut unnamed_points = vec![false; counts.points];
        for &v in unnamed.iter().flatten() {
            unnamed_points[v as usize] = true;
        }
        let is_unnamed = |face: &[u32; 3]| face.iter().all(|&v| unnamed_points[v as usize]) && unnamed.contains(face);
        let mut beyond = FxHashMap::default();
        mesh.each_part(
            |part| {
                ask(progress)?;
                part_sum(mesh, &mesh.tets(part)?, &is_unnamed)
            },
            |part| {
                beyond.extend(part.beyond);
                quality.add_piece(&part.quality.piece());
                repeated.extend(part.repeated.iter().map(|i| first as u32 + i));
                flat.extend(part.flat.iter().map(|(i, p)| (first as u32 + i, *p)));
                for (region, sum) in part.regions {
                    let all = seen.entry(region).or_default();
                    all.tets += sum.tets;
                    all.volume += sum.volume;
                    all.chain = [0, 1].map(|i| all.chain[i].wrapping_add(sum.chain[i]));
                }
                part.tets.as_flattened().iter().for_each(|&v| unused[v as usize] = false);
                sets.add(&part.tets, &part.of_tets);
                first += part.tets.len();
                progress.at(Stage::Check, first as u64, counts.tets as u64);
                Ok(())
            },
        )?;
        self.beyond = beyond;
        for tet in repeated {
            self.tally(Line::NoRepeatedVertex).add(|| Offender::new(OffenderKind::Tet, &[tet], None));
        }
        for (tet, place) in flat {
            self.tally(Line::PositiveTets).add(|| Offender::new(OffenderKind::Tet, &[tet], Some(place)));
        }
        for v in (0..).zip(unused).filter(|(_, unused)| *unused).map(|(v, _)| v) {
            self.tally(Line::NoUnusedPoints).add(|| Offender::new(OffenderKind::Point, &[v], None));
        }
        (self.sums, self.quality) = (seen, quality);
        (self.components, self.joined) = sets.done();
        Ok(())
    }

    /// Compares the sums of both, and the regions with their list.
    fn compare(&mut self) {
        let mut ids: Vec<i32> = self.sums.keys().chain(self.labelled.keys()).copied().collect();
        ids.extend(self.regions.iter().map(|region| region.id));
        ids.sort_unstable();
        ids.dedup();
        for id in ids {
            let offender = || Offender { kind: OffenderKind::Region, ids: vec![i64::from(id)], position: None };
            let found = self.sums.get(&id).map(|sum| sum.chain);
            let is_named = self.regions.iter().any(|region| region.id == id);
            if !is_named || found.is_none() {
                self.tally(Line::RegionsNamed).add(offender);
            }
            if found != self.labelled.get(&id).map(|(chain, _)| *chain) {
                self.tally(Line::LabelsMatchBoundary).add(offender);
            }
        }
    }

    /// Checks the boundary of the regions up to each.
    fn surfaces(&self) -> io::Result<Vec<SurfaceLines>> {
        self.regions.iter().map(|region| self.surface_up_to(region.id)).collect()
    }

    fn surface_up_to(&self, last: i32) -> io::Result<SurfaceLines> {
        let mut faces: Vec<[u32; 3]> = Vec::new();
        self.mesh.each_faces(|piece| {
            ask(self.progress)?;
            let bounds = |(own, beyond): (i32, Option<i32>)| own <= last && beyond.is_none_or(|beyond| beyond > last);
            let sides = self.sides(piece);
            faces.extend(piece.faces.iter().zip(sides).filter(|(_, sides)| bounds(*sides)).map(|(face, _)| *face));
            Ok(())
        })?;
        let mut used = faces.as_flattened().to_vec();
        used.sort_unstable();
        used.dedup();
        let points = self.mesh.points_of(&used)?;
        for v in faces.as_flattened_mut() {
            *v = used.partition_point(|u| u < v) as u32;
        }
        let boundary = Boundary::new(&points, &faces);
        let mut lines: Vec<LineResult> = boundary.manifold_lines().into();
        let is_closed = !lines[0].fails();
        let surfaces = boundary.surfaces().all.len();
        lines.push(boundary.self_intersections(is_closed, self.progress).0);
        ask(self.progress)?;
        for offender in lines.iter_mut().flat_map(|line| &mut line.offenders) {
            offender.ids.iter_mut().for_each(|id| *id = i64::from(used[*id as usize]));
        }
        Ok(SurfaceLines { faces: faces.len(), surfaces, lines })
    }

    /// Report on all conditions.
    fn report(mut self, lumen: &CheckReport, surfaces: Vec<SurfaceLines>) -> CheckReport {
        let counts = self.mesh.counts();
        let outer = surfaces.last().map_or((0, 0), |outer| (outer.faces, outer.surfaces));
        let within = surfaces.len().saturating_sub(1);
        for (i, SurfaceLines { lines, .. }) in surfaces.into_iter().enumerate() {
            let names = if i == within {
                [Line::BoundaryEdges, Line::BoundaryFans, Line::NoSelfIntersection]
            } else {
                [Line::RegionBoundaries, Line::RegionBoundaries, Line::RegionIntersections]
            };
            for (name, found) in names.into_iter().zip(lines) {
                self.tally(name).add_all(found);
            }
        }
        let is_sound = self.tallies.values().all(Tally::holds);
        let of_network: FxHashSet<Line> = OF_NETWORK.into_iter().collect();
        let mut lines = Vec::new();
        for line in Line::ALL.into_iter().chain(Line::OF_REGIONS) {
            let own = self.tallies.remove(&line).map(Tally::done);
            let taken = || lumen.line(line).filter(|_| of_network.contains(&line)).cloned();
            lines.push(own.or_else(taken).unwrap_or_else(|| {
                // The first three facts imply the rest.
                let implied = Tally::new(line).done();
                if is_sound { implied } else { LineResult::skipped(line, Skipped::Because(Line::PositiveTets)) }
            }));
        }
        let region = |region: &NamedRegion| {
            let sum = self.sums.get(&region.id).copied().unwrap_or_default();
            RegionCounts {
                id: region.id,
                name: region.name.clone(),
                tets: sum.tets,
                components: self.components.get(&region.id).copied().unwrap_or(0),
                boundary_faces: self.labelled.get(&region.id).map_or(0, |(_, count)| *count),
                touches: 0,
                volume: sum.volume,
            }
        };
        let regions: Vec<RegionCounts> = self.regions.iter().map(region).collect();
        let counts = Counts {
            points: counts.points,
            tets: counts.tets,
            boundary_faces: outer.0,
            components: self.joined,
            boundary_components: outer.1,
            caps: self.mesh.patches().iter().filter(|patch| patch.cap.is_some()).count(),
            volume: regions.iter().map(|region| region.volume).sum(),
        };
        CheckReport { regions, ..CheckReport::new(counts, lines, Some(self.quality.quality()), Vec::new()) }
    }
}

/// Conditions that compare the lumen with its network.
const OF_NETWORK: [Line; 10] = [
    Line::Components,
    Line::Loops,
    Line::WallOrCap,
    Line::OwnPatch,
    Line::CapPerTerminal,
    Line::CapDisc,
    Line::CapFlat,
    Line::CapCentred,
    Line::CapArea,
    Line::CapNormal,
];

fn part_sum(mesh: &dyn MeshSource, piece: &TetPiece, is_unnamed: &dyn Fn(&[u32; 3]) -> bool) -> io::Result<PartSum> {
    let mut made = PartSum::default();
    let corners = mesh.corners_of(&piece.tets)?;
    for (i, (tet, corners)) in (0..).zip(piece.tets.iter().zip(&corners)) {
        let region = piece.blocks.get(i as usize).copied().unwrap_or(0);
        let sum = made.regions.entry(region).or_default();
        for face in TET_FACES.map(|side| side.map(|corner| tet[corner])) {
            add(&mut sum.chain, face, false);
            let other_side = oriented([face[0], face[2], face[1]]);
            if is_unnamed(&other_side) {
                made.beyond.push((other_side, region));
            }
        }
        let [a, b, c, d] = corners.each_ref();
        sum.tets += 1;
        sum.volume += volume6(a, b, c, d) / 6.0;
        let is_repeated = (0..4).any(|k| tet[k + 1..].contains(&tet[k]));
        if is_repeated {
            made.repeated.push(i);
        }
        let is_finite = corners.iter().all(|p| p.iter().all(|x| x.abs() <= MAX_MAGNITUDE));
        if !is_finite || orient3d(a, b, c, d) <= 0.0 {
            made.flat.push((i, *a));
        }
        made.quality.include(&Spokes::new([a, b, c, d]), [a, b, c, d]);
        made.of_tets.push(region);
    }
    made.tets = piece.tets.to_vec();
    Ok(made)
}

/// Components of regions, and of all together. Tetrahedra with a common point are connected. A region ends with the last of
/// consecutive parts that have it.
struct RegionSets {
    open: Vec<OpenRegion>,
    /// Component of an earlier region with each point.
    before: Vec<u32>,
    all: DisjointSets,
    found: FxHashMap<i32, usize>,
}

struct OpenRegion {
    region: i32,
    sets: DisjointSets,
    is_in: Vec<bool>,
}

impl RegionSets {
    fn new(points: usize) -> Self {
        let before = vec![u32::MAX; points];
        Self { open: Vec::new(), before, all: DisjointSets::new(0), found: FxHashMap::default() }
    }

    /// Adds the tetrahedra of a part.
    fn add(&mut self, tets: &[[u32; 4]], regions: &[i32]) {
        if tets.is_empty() {
            return;
        }
        let mut here = regions.to_vec();
        here.sort_unstable();
        here.dedup();
        let (open, closed) = std::mem::take(&mut self.open).into_iter().partition(|open| here.contains(&open.region));
        self.open = open;
        self.close(closed);
        for region in here {
            if !self.open.iter().any(|open| open.region == region) {
                let points = self.before.len();
                self.open.push(OpenRegion { region, sets: DisjointSets::new(points), is_in: vec![false; points] });
            }
            let Some(OpenRegion { sets, is_in, .. }) = self.open.iter_mut().find(|open| open.region == region) else {
                continue;
            };
            for (tet, _) in tets.iter().zip(regions).filter(|(_, of)| **of == region) {
                for &v in tet {
                    is_in[v as usize] = true;
                    sets.join(tet[0], v);
                }
            }
        }
    }

    /// Ends regions.
    fn close(&mut self, regions: Vec<OpenRegion>) {
        for OpenRegion { region, mut sets, is_in } in regions {
            let mut numbers: FxHashMap<u32, u32> = FxHashMap::default();
            for v in (0..).zip(is_in).filter(|(_, is_in)| *is_in).map(|(v, _)| v) {
                let own = *numbers.entry(sets.root(v)).or_insert_with(|| self.all.push());
                let before = &mut self.before[v as usize];
                if *before != u32::MAX {
                    self.all.join(own, *before);
                }
                *before = own;
            }
            *self.found.entry(region).or_default() += numbers.len();
        }
    }

    fn done(mut self) -> (FxHashMap<i32, usize>, usize) {
        let rest = std::mem::take(&mut self.open);
        self.close(rest);
        let roots: FxHashSet<u32> = (0..self.all.len() as u32).map(|i| self.all.find(i)).collect();
        (self.found, roots.len())
    }
}

#[cfg(test)]
#[path = "passes_tests.rs"]
mod tests;
