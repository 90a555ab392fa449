//! Report of a tetrahedralization, as text and JSON.

use super::rows::{Ended, row};
use super::second_order::of_midpoints;
use super::verdict::Verdict;
use crate::pipeline::StageTime;
use anastomesh_mesh::geometry::Point3;
use anastomesh_mesh::quality::{TetQuality, dihedral_range, volume6};
use anastomesh_mesh::second_order::Curving;
use anastomesh_mesh::units::{counted, digits, grouped, tetrahedra};
use anastomesh_mesh::{Bounds, face_key};
use anastomesh_mesh::{TET_FACES, TetMesh};
use anastomesh_tet::{LayerSummary, RemeshSummary};
use serde::Serialize;
use std::fmt::Write as _;

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct InputSize {
    /// Number of points.
    pub points: usize,
    /// Number of facets, if the file has non-triangular ones.
    pub facets: Option<usize>,
    /// Number of triangles.
    pub triangles: usize,
    /// Number of segments that are not edges of triangles.
    pub segments: usize,
    /// Number of holes.
    pub holes: usize,
}

/// Size of the mesh.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct OutputSize {
    /// Number of points.
    pub points: usize,
    /// Number of points that are not in the input.
    pub added_points: usize,
    /// Number of tetrahedra.
    pub tets: usize,
    /// Faces that are input triangles or parts of them.
    pub faces: usize,
    /// Number of these faces between two tetrahedra.
    pub interior_faces: usize,
    /// Volume of all tetrahedra.
    pub volume: f64,
}

/// Input elements that are not in the mesh, because they lie outside the filled region or in a hole. Numbers are those
/// of the file.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct LeftOut {
    /// Number of triangles.
    pub triangles: usize,
    /// Element type that the triangle numbers count: triangles, or the elements of which they are pieces.
    #[serde(skip)]
    pub triangles_of: &'static str,
    /// Faces or facets of the file that contain the triangles.
    pub faces: Vec<u32>,
    /// End points of each segment.
    pub segments: Vec<[u32; 2]>,
    /// Number of the first face and of the first point.
    pub counted_from: u32,
    /// Number of input points without tetrahedra; they are still points of the mesh.
    pub unused_points: usize,
}

impl LeftOut {
    /// Maximum number of listed indices.
    const NAMED: usize = 10;

    /// Text with one line per element type; empty if nothing is left out.
    pub fn text(&self) -> String {
        const WHY: &str = "outside the filled region, or in a hole (--strict refuses this)";
        let from = self.counted_from;
        let mut lines = String::new();
        if self.triangles > 0 {
            let faces: Vec<String> = self.faces.iter().map(ToString::to_string).collect();
            let (n, of, named) = (self.triangles, self.triangles_of, Self::named(&faces));
            let _ = writeln!(lines, "omitted: {n} {of} {WHY}: {named} (counted from {from})");
        }
        if !self.segments.is_empty() {
            let ends: Vec<String> = self.segments.iter().map(|[a, b]| format!("{a}-{b}")).collect();
            let (segments, named) = (counted(ends.len(), "segment"), Self::named(&ends));
            let _ = writeln!(lines, "omitted: {segments} {WHY}: {named} (points counted from {from})");
        }
        if self.unused_points > 0 {
            let points = counted(self.unused_points, "input point");
            let _ = writeln!(lines, "unused: {points} without tetrahedra, kept with their numbers");
        }
        lines
    }

    fn named(all: &[String]) -> String {
        let first = all[..all.len().min(Self::NAMED)].join(", ");
        if all.len() > Self::NAMED { format!("{first} and {} more", all.len() - Self::NAMED) } else { first }
    }
}

/// Region of the mesh.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct RegionSize {
    pub id: i32,
    /// Number of tetrahedra.
    pub tets: usize,
    /// Volume of these tetrahedra.
    pub volume: f64,
}

/// Report of the boundary recovery.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Recovery {
    /// Edges missing in the Delaunay tetrahedralization.
    pub missing_edges: usize,
    /// Triangles missing in the Delaunay tetrahedralization.
    pub missing_triangles: usize,
    /// Points added to recover them.
    pub steiner_points: usize,
}

/// Requested bound and the number of tetrahedra that violate it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BoundResult {
    /// Bounded quantity.
    pub bound: &'static str,
    /// Value of the bound.
    pub value: f64,
    /// Number of tetrahedra beyond the bound.
    pub beyond: usize,
    /// Number of these tetrahedra at fixed input triangles.
    pub on_input: usize,
}

/// Requested edge length that fixed longer input edges prevent.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct SizeUnmet {
    /// Requested length.
    pub size: f64,
    /// Number of input edges so long that they would be split if allowed.
    pub longer: usize,
    /// Number of input edges.
    pub edges: usize,
    /// Length of the longest input edge.
    pub longest: f64,
}

impl SizeUnmet {
    /// Compares the edges of fixed triangles and segments with the requested length. Returns `None` if no edge exceeds
    /// `factor` times that length.
    pub fn of(
        size: f64,
        factor: f64,
        points: &[Point3],
        triangles: &[[u32; 3]],
        segments: &[[u32; 2]],
    ) -> Option<Self> {
        let sides = triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]).chain(segments.iter().copied());
        let mut edges: Vec<[u32; 2]> = sides.map(|[a, b]| [a.min(b), a.max(b)]).collect();
        edges.sort_unstable();
        edges.dedup();
        let length = |&[a, b]: &[u32; 2]| (points[a as usize] - points[b as usize]).norm();
        let longer = edges.iter().filter(|e| length(e) > factor * size).count();
        let longest = edges.iter().map(length).fold(0.0, f64::max);
        (longer > 0).then_some(Self { size, longer, edges: edges.len(), longest })
    }
}

/// Report of boundary layers.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LayerReport {
    /// Number of tetrahedra in layers.
    pub tets: usize,
    /// Number of regions with layers.
    pub regions: usize,
    /// Quality of all other tetrahedra.
    pub inside: TetQuality,
    /// Surface points with less than half the requested layer thickness.
    pub thin: usize,
    /// Point with the thinnest layers, and their thickness relative to the request.
    pub thinnest: Option<(u32, f64)>,
    /// Surface points without layers.
    pub without: Vec<u32>,
    /// Flat parts without layers that have other triangles than the input, with layers along their rims.
    pub shrunk_caps: usize,
    /// Parts without layers that keep their triangles.
    pub kept_caps: usize,
}

impl LayerReport {
    /// Maximum number of listed points without layers.
    const NAMED: usize = 5;

    /// Creates the report; `name` maps points to their numbers in the file.
    pub fn of(made: &LayerSummary, mesh: &TetMesh, name: impl Fn(u32) -> u32) -> Self {
        Self {
            tets: made.tets,
            regions: made.regions,
            inside: TetQuality::of_tets(mesh, &mesh.tets[made.tets..]),
            thin: made.thin,
            thinnest: made.thinnest.map(|(v, share)| (name(v), share)),
            without: made.without.iter().map(|&v| name(v)).collect(),
            shrunk_caps: made.shrunk_caps,
            kept_caps: made.kept_caps,
        }
    }

    fn text(&self) -> String {
        let Self { tets, regions, inside: q, thin, thinnest, without, shrunk_caps, kept_caps } = self;
        let within = if *regions > 1 { format!(" in {regions} regions") } else { String::new() };
        let mut out = format!(
            "layers: {}{within}; radius ratio of all others: mean {:.4}, 1st percentile {:.4}, min {:.4}; \
             dihedral angles {:.2}° to {:.2}°\n",
            tetrahedra(*tets),
            q.mean,
            q.percentile_1,
            q.min,
            q.dihedral_min,
            q.dihedral_max
        );
        if shrunk_caps + kept_caps > 0 {
            let _ = writeln!(
                out,
                "  layers end in rings on {}, whose other triangles changed in their plane, and at thickness 0 at {}",
                counted(*shrunk_caps, "flat part"),
                counted(*kept_caps, "other part")
            );
        }
        if let Some((point, share)) = thinnest {
            let _ = writeln!(
                out,
                "  thinner than half of the request at {}; thinnest at point {point}: {:.2} %",
                counted(*thin, "point"),
                100.0 * share
            );
        }
        if !without.is_empty() {
            let named: Vec<String> = without.iter().take(Self::NAMED).map(ToString::to_string).collect();
            let more = if without.len() > Self::NAMED { ", …" } else { "" };
            let _ = writeln!(
                out,
                "  no layers at {} without space or an inward direction: {}{more}",
                counted(without.len(), "point"),
                named.join(", ")
            );
        }
        out
    }
}

/// Report of a remeshed surface.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct RemeshReport {
    /// Maximum allowed distance between input and new surface.
    pub tolerance: f64,
    /// Largest measured distance, in both directions.
    pub distance: f64,
    /// Number of triangles before and after.
    pub triangles: [usize; 2],
    /// Smallest angle of a triangle in degrees, before and after.
    pub smallest_angle: [f64; 2],
    /// First percentile of the smallest angles of triangles in degrees, before and after.
    pub angle_percentile_1: [f64; 2],
    /// Number of input triangles that stay, because new ones would intersect there.
    pub kept: usize,
}

impl RemeshReport {
    pub fn of(change: &RemeshSummary) -> Self {
        Self {
            tolerance: change.tolerance,
            distance: change.distance,
            triangles: change.triangles,
            smallest_angle: change.smallest_angle,
            angle_percentile_1: change.percentile_1,
            kept: change.frozen,
        }
    }

    fn text(&self) -> String {
        let ([before, after], [least, now]) = (self.triangles.map(grouped), self.smallest_angle);
        let angles = format!("smallest angle {least:.2}° to {now:.2}°");
        let distance = format!("max distance {} (tolerance {})", digits(self.distance), digits(self.tolerance));
        let kept = match self.kept {
            0 => String::new(),
            n => format!("; {} of the input kept, as new ones would intersect", counted(n, "triangle")),
        };
        row("remeshed", &format!("{before} to {after} triangles, {angles}, {distance}{kept}"))
    }
}

/// Complete report of a tetrahedralization.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct TetReport {
    pub input: InputSize,
    /// Anomalies of the file, as sentences.
    pub notes: Vec<String>,
    /// Repairs of the file, as sentences.
    pub repaired: Vec<String>,
    pub mesh: OutputSize,
    /// Input elements that are not in the mesh.
    pub left_out: LeftOut,
    /// Change of the surface by remeshing, if requested.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub remeshed: Option<RemeshReport>,
    /// Quality of the tetrahedra.
    pub quality: Option<TetQuality>,
    /// Report of layers, if requested.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub layers: Option<LayerReport>,
    /// Midpoints of second-order elements, if requested.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub second_order: Option<Curving>,
    /// Requested bounds.
    pub bounds: Vec<BoundResult>,
    /// Requested edge length that the input prevents.
    pub size_unmet: Option<SizeUnmet>,
    /// Option that permits splitting of input triangles, if they are fixed.
    pub to_split: Option<&'static str>,
    /// Regions in ascending order; empty for a single region.
    pub regions: Vec<RegionSize>,
    /// Report of the boundary recovery.
    pub recovery: Recovery,
    /// Wall time per stage.
    pub stages: Vec<StageTime>,
    /// Peak memory in bytes, if the system reports it.
    pub peak_memory: Option<u64>,
    /// Names of the output files.
    pub files: Vec<String>,
}

impl BoundResult {
    /// Name of the volume bound.
    const VOLUME: &'static str = "volume at most";

    /// Counts the tetrahedra beyond each active bound, and those of them with a fixed face.
    pub fn of(bounds: &Bounds, mesh: &TetMesh, staying: &[[u32; 3]]) -> Vec<Self> {
        // Tolerance for tetrahedra built to lie exactly on the bound.
        const ROUNDING: f64 = 1e-9;
        let corners = |t: &[u32; 4]| t.map(|v| &mesh.points[v as usize]);
        let mut staying: Vec<[u32; 3]> = staying.iter().map(|&f| face_key(f)).collect();
        staying.sort_unstable();
        let on_input =
            |t: &[u32; 4]| TET_FACES.iter().any(|f| staying.binary_search(&face_key(f.map(|i| t[i]))).is_ok());
        let mut results = Vec::new();
        let mut count = |bound, value, beyond: &dyn Fn([&Point3; 4]) -> bool| {
            let found: Vec<&[u32; 4]> = mesh.tets.iter().filter(|t| beyond(corners(t))).collect();
            let on_input = found.iter().filter(|t| on_input(t)).count();
            results.push(Self { bound, value, beyond: found.len(), on_input });
        };
        if let Some(value) = bounds.max_radius_edge {
            let beyond = |t: [&Point3; 4]| radius_edge(t) > value * (1.0 + ROUNDING);
            count("circumradius over shortest edge at most", value, &beyond);
        }
        if let Some(value) = bounds.min_dihedral {
            let beyond = |t: [&Point3; 4]| dihedral_range(t).0.to_degrees() < value * (1.0 - ROUNDING);
            count("dihedral angles at least", value, &beyond);
        }
        if let Some(value) = bounds.max_volume {
            let beyond = |[a, b, c, d]: [&Point3; 4]| volume6(a, b, c, d) / 6.0 > value * (1.0 + ROUNDING);
            count(Self::VOLUME, value, &beyond);
        }
        results
    }
}

/// Ratio of circumradius to shortest edge; infinite for a flat tetrahedron.
fn radius_edge([a, b, c, d]: [&Point3; 4]) -> f64 {
    let (u, v, w) = (b - a, c - a, d - a);
    let center = v.cross(&w) * u.norm_squared() + w.cross(&u) * v.norm_squared() + u.cross(&v) * w.norm_squared();
    let radius = center.norm() / (2.0 * volume6(a, b, c, d).abs());
    let squares = [u, v, w, c - b, d - b, d - c].map(|e| e.norm_squared());
    let ratio = radius / squares.into_iter().fold(f64::INFINITY, f64::min).sqrt();
    if ratio.is_nan() { f64::INFINITY } else { ratio }
}

/// Regions of a mesh in ascending order; `regions` has the id of each tetrahedron.
pub fn region_sizes(mesh: &TetMesh, regions: &[i32]) -> Vec<RegionSize> {
    let mut sizes: std::collections::BTreeMap<i32, RegionSize> = std::collections::BTreeMap::new();
    for (t, &id) in mesh.tets.iter().zip(regions) {
        let size = sizes.entry(id).or_insert(RegionSize { id, tets: 0, volume: 0.0 });
        size.tets += 1;
        size.volume += volume_of(mesh, t);
    }
    sizes.into_values().collect()
}

/// Volume of a tetrahedron of a mesh.
pub fn volume_of(mesh: &TetMesh, t: &[u32; 4]) -> f64 {
    let [a, b, c, d] = t.map(|v| &mesh.points[v as usize]);
    volume6(a, b, c, d) / 6.0
}

impl TetReport {
    /// Verdict of the run; `checked`: the input was only checked.
    pub fn verdict(&self, checked: bool) -> Verdict {
        if checked {
            return Verdict::good("no fault found");
        }
        // Only the bound on the volume can always be met.
        let mut violated = self.bounds.iter().filter(|b| b.bound == BoundResult::VOLUME && b.beyond > 0);
        violated.next().map_or_else(
            || Verdict::good("meshed"),
            |b| {
                Verdict::bad(format!("NOT within bounds: {} {} violated by {}", b.bound, b.value, tetrahedra(b.beyond)))
            },
        )
    }

    /// Appends the results of requested bounds, and the influence of the input.
    fn write_bounds(&self, out: &mut String) {
        let mut stays = false;
        for b in &self.bounds {
            let on = match (self.to_split, b.on_input) {
                (Some(_), n) if n > 0 => format!(", of which {} at fixed input triangles", grouped(n)),
                _ => String::new(),
            };
            stays |= !on.is_empty();
            let _ = match b.beyond {
                0 => writeln!(out, "  {} {}: met", b.bound, b.value),
                n => writeln!(out, "  {} {}: violated by {}{on}", b.bound, b.value, tetrahedra(n)),
            };
        }
        if let Some(s) = self.size_unmet {
            stays = true;
            let SizeUnmet { size, longest, .. } = s;
            let [longer, edges] = [s.longer, s.edges].map(grouped);
            let _ = writeln!(
                out,
                "  edge length {size}: exceeded at the boundary by {longer} of {edges} input edges, max {longest:.6}"
            );
        }
        if let (true, Some(how)) = (stays, self.to_split) {
            let _ = writeln!(out, "  note: input triangles are fixed; {how} allows splitting them");
        }
    }

    /// Maximum number of regions in a summary.
    const REGIONS: usize = 10;

    /// Text report; with `all` it lists every region and stage.
    pub fn text(&self, all: bool, ended: &Ended) -> String {
        let mut out = String::new();
        // Writing to a string cannot fail.
        let (i, m, r) = (&self.input, &self.mesh, &self.recovery);
        let facets = i.facets.map_or_else(String::new, |n| format!(" of {}", counted(n, "facet")));
        let (points, triangles) = (counted(i.points, "point"), counted(i.triangles, "triangle"));
        let beside = [extra(i.segments, "segment"), extra(i.holes, "hole")].concat();
        out += &row("input", &format!("{points}, {triangles}{facets}{beside}"));
        for line in &self.repaired {
            let _ = writeln!(out, "  repaired: {line}");
        }
        out.push_str(&self.remeshed.as_ref().map_or_else(String::new, RemeshReport::text));
        out.push_str(&self.left_out.text());
        let (tets, points) = (tetrahedra(m.tets), counted(m.points, "point"));
        let (added, volume) = (grouped(m.added_points), digits(m.volume));
        out += &row("mesh", &format!("{tets}, {points} ({added} added), volume {volume}"));
        if i.triangles > 0 {
            let inside =
                if m.interior_faces > 0 { format!(", {} inside", grouped(m.interior_faces)) } else { String::new() };
            let [faces, edges, triangles, points] = [
                (m.faces, "face"),
                (r.missing_edges, "edge"),
                (r.missing_triangles, "triangle"),
                (r.steiner_points, "point"),
            ]
            .map(|(count, what)| counted(count, what));
            let missing = format!("{edges} and {triangles} recovered with {points}");
            out += &row("surface", &format!("{faces}{inside}; {missing}"));
        }
        self.write_regions(all, &mut out);
        if let Some(q) = &self.quality {
            let ratio = format!("radius ratio mean {:.2}, min {:.2}", q.mean, q.min);
            out += &row("shape", &format!("{ratio}; dihedral angles {:.0}° to {:.0}°", q.dihedral_min, q.dihedral_max));
        }
        out.push_str(&self.layers.as_ref().map_or_else(String::new, LayerReport::text));
        self.write_bounds(&mut out);
        out += &self.second_order.as_ref().map_or_else(String::new, of_midpoints);
        if all {
            let times: Vec<String> = self.stages.iter().map(|s| format!("{} {:.2} s", s.stage, s.seconds)).collect();
            out += &row("stages", &times.join(", "));
        }
        out + &ended.rows(&self.stages)
    }

    fn write_regions(&self, all: bool, out: &mut String) {
        let shown = if all { self.regions.len() } else { Self::REGIONS.min(self.regions.len()) };
        for region in &self.regions[..shown] {
            let (tets, volume) = (tetrahedra(region.tets), digits(region.volume));
            let _ = writeln!(out, "  region {}: {tets}, volume {volume}", region.id);
        }
        if shown < self.regions.len() {
            let _ = writeln!(out, "  and {} more (-v lists them)", counted(self.regions.len() - shown, "region"));
        }
    }
}

/// Formats a count as `, 3 holes`, or as nothing if it is 0.
fn extra(count: usize, what: &str) -> String {
    if count == 0 { String::new() } else { format!(", {}", counted(count, what)) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use anastomesh_mesh::shapes::cube_lattice;

    #[test]
    fn bounds_are_counted() {
        let h = 0.75_f64.sqrt();
        let points = vec![
            Point3::origin(),
            Point3::new(1.0, 0.0, 0.0),
            Point3::new(0.5, h, 0.0),
            Point3::new(0.5, h / 3.0, (2.0_f64 / 3.0).sqrt()),
            Point3::new(0.5, h / 3.0, -0.01),
        ];
        let mesh = TetMesh { points, tets: vec![[0, 1, 2, 3], [0, 2, 1, 4]] };
        let bounds = Bounds { max_radius_edge: Some(0.613), min_dihedral: Some(70.5), max_volume: Some(0.1) };
        let results = BoundResult::of(&bounds, &mesh, &[[3, 0, 1]]);
        assert_eq!(results.iter().map(|r| r.beyond).collect::<Vec<_>>(), [1, 1, 1]);
        // The face belongs to the first tetrahedron, which is too large; the second is flat.
        assert_eq!(results.iter().map(|r| r.on_input).collect::<Vec<_>>(), [0, 0, 1]);
        let report = TetReport { bounds: results, to_split: Some("--split"), ..TetReport::default() };
        let verdict = report.verdict(false);
        assert!(
            !verdict.is_good && verdict.text.ends_with("volume at most 0.1 violated by 1 tetrahedron"),
            "{verdict:?}"
        );
        assert!(TetReport::default().verdict(false).is_good);
        let text = report.text(false, &Ended::default());
        assert!(text.contains("volume at most 0.1: violated by 1 tetrahedron, of which 1 at fixed input triangles\n"));
        assert!(text.contains("--split allows splitting them"));
        let free = TetReport { to_split: None, ..report };
        assert!(
            !free.text(false, &Ended::default()).contains("input\n  note")
                && !free.text(false, &Ended::default()).contains("split")
        );
    }

    #[test]
    fn a_length_is_unmet_where_edges_that_stay_are_longer() {
        let points = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 2.0, 0.0]].map(Point3::from);
        let of = |size| SizeUnmet::of(size, 1.5, &points, &[[0, 1, 2], [0, 2, 1]], &[[1, 0]]);
        assert_eq!(of(1.5), None);
        let unmet = of(1.0).unwrap();
        assert_eq!((unmet.longer, unmet.edges, unmet.longest), (2, 3, 5.0_f64.sqrt()));
        assert_eq!(of(0.5).unwrap().longer, 3);
        let report = TetReport { size_unmet: Some(unmet), to_split: Some("--split"), ..TetReport::default() };
        let text = report.text(false, &Ended::default());
        assert!(text.contains("edge length 1: exceeded at the boundary by 2 of 3 input edges, max 2.236068"));
        assert!(text.contains("--split allows splitting them"));
    }

    #[test]
    fn regions_are_summed() {
        let mesh = cube_lattice(2);
        let regions: Vec<i32> = (0..mesh.tets.len() as i32).map(|i| if i < 12 { 9 } else { -1 }).collect();
        let sizes = region_sizes(&mesh, &regions);
        assert_eq!(sizes.iter().map(|r| (r.id, r.tets)).collect::<Vec<_>>(), [(-1, 36), (9, 12)]);
        assert!((sizes.iter().map(|r| r.volume).sum::<f64>() - 1.0).abs() < 1e-12);
    }
}
