//! Reading of the input, triangulation of facets, and repair.

use anastomesh_mesh::geometry::place_key;
use std::io::Read;
use std::path::{Path, PathBuf};

use super::format::{InputFormat, is_stream};
use super::numbers::{Counted, FileNumbers};
use super::plan::TetPlan;
use crate::cli::exit::Failure;
use anastomesh_io::surface::{
    ArrayComplex, ArrayRegion, SurfaceContent, read_complex, read_content_as, read_content_from,
};
use anastomesh_io::tetgen::{self, Nodes};
use anastomesh_mesh::facets::{self, FacetTriangles};
use anastomesh_mesh::repair::{RepairReport, Repaired, repair, repair_facets};
use anastomesh_mesh::units::counted;
use anastomesh_tet::{Plc, Region};
use rustc_hash::FxHashMap;

/// Input of a tetrahedralization.
#[derive(Clone, Debug, Default)]
pub struct Input {
    /// Input files.
    pub files: Vec<PathBuf>,
    /// Points, triangles, segments, holes and regions.
    pub plc: Plc,
    /// True if the input has only points.
    pub only_points: bool,
    /// True if the file has facet markers.
    pub marked: bool,
    /// Names of markers, ascending.
    pub names: Vec<(i32, String)>,
    /// Attributes of regions in the file, by id, if some are not whole numbers.
    pub attributes: Vec<(i32, f64)>,
    /// Number of facets; `None` for triangles.
    pub facets: Option<usize>,
    /// Numbers of triangles and points in the file.
    pub numbers: FileNumbers,
    /// Notes on the file.
    pub notes: Vec<String>,
    /// Default number of the first item in output files.
    pub first: u32,
    /// Marker of each point; may be empty.
    pub point_markers: Vec<i32>,
    /// Attributes of all points.
    pub point_attributes: Vec<f64>,
    /// Number of attributes per point.
    pub attribute_count: usize,
}

impl Input {
    /// Reads a file or standard input.
    pub fn read(path: &Path, format: InputFormat, plan: &TetPlan) -> Result<Self, Failure> {
        let from = if is_stream(path) { "standard input".into() } else { path.display().to_string() };
        let source = if is_stream(path) { Self::of_stream(format)? } else { Self::of_file(path, format)? };
        let mut files = vec![path.to_path_buf()];
        let input = match source {
            Source::Surface(content) => Self::of_surface(content),
            Source::Arrays(complex) => Self::of_arrays(complex, plan),
            Source::Points(nodes) => Self::of_points(nodes),
            Source::Complex(plc) => {
                if plc.points_beside {
                    files.push(path.with_extension("node"));
                }
                Self::of_complex(plc, plan).map_err(|e| Failure::input(format!("{from}: {e}")))?
            }
        };
        match input.notes.first() {
            Some(note) if plan.strict => {
                Err(Failure::input(format!("{from}: {note}; correct the file, or omit --strict")))
            }
            _ => Ok(Self { files, ..input }),
        }
    }

    fn of_surface(content: SurfaceContent) -> Self {
        let SurfaceContent { mesh, first, face_of, corner_of, notes, markers, names, .. } = content;
        let counted = if corner_of.is_empty() { Counted::Faces } else { Counted::Corners };
        let numbers = FileNumbers { counted, first, cut: !face_of.is_empty(), face_of, point_of: corner_of };
        let marked = !markers.is_empty();
        let plc = Plc::from(mesh).markers(markers);
        let notes = notes.iter().map(ToString::to_string).collect();
        Self { plc, marked, names, numbers, notes, ..Self::default() }
    }

    /// Markers of the parts with these numbers or names.
    pub fn markers_of(&self, parts: &[String]) -> Result<Vec<i32>, Failure> {
        let mut known: Vec<i32> = self.plc.markers.clone();
        known.sort_unstable();
        known.dedup();
        let name =
            |id: i32| self.names.iter().find(|named| named.0 == id).map_or(id.to_string(), |named| named.1.clone());
        let find = |part: &String| {
            let named = self.names.iter().find(|named| named.1 == *part).map(|named| named.0);
            let marker = named.or_else(|| part.parse().ok()).filter(|id| known.contains(id));
            marker.ok_or_else(|| match known.as_slice() {
                [] => Failure::usage("--layers-on needs markers, and the input has none"),
                known => {
                    let known: Vec<String> = known.iter().map(|&id| name(id)).collect();
                    Failure::usage(format!("--layers-on: no part is named '{part}'; parts: {}", known.join(", ")))
                }
            })
        };
        parts.iter().map(find).collect()
    }

    /// Orients the triangles and merges duplicates. Returns the changes as sentences.
    pub fn repair(&mut self, is_complex: bool) -> Vec<String> {
        let plc = &mut self.plc;
        let repair = if is_complex { repair_facets } else { repair };
        let Repaired { surface, source, point, report, .. } = repair(&plc.surface);
        plc.markers = source.iter().filter_map(|&i| plc.markers.get(i as usize).copied()).collect();
        let named = |v: u32| point.get(v as usize).copied().unwrap_or(u32::MAX);
        plc.segments = plc.segments.iter().map(|edge| edge.map(named)).map(|[a, b]| [a.min(b), a.max(b)]).collect();
        plc.segments.retain(|[a, b]| a != b);
        plc.segments.sort_unstable();
        plc.segments.dedup();
        // The first of equal points is kept.
        let mut kept = vec![u32::MAX; surface.points.len()];
        for (old, &new) in point.iter().enumerate().rev() {
            if let Some(slot) = kept.get_mut(new as usize) {
                *slot = old as u32;
            }
        }
        self.numbers.select(&source, &kept);
        let each = self.attribute_count;
        self.point_markers = kept.iter().filter_map(|&i| self.point_markers.get(i as usize).copied()).collect();
        let attributes =
            kept.iter().filter_map(|&i| self.point_attributes.get(i as usize * each..(i as usize + 1) * each));
        self.point_attributes = attributes.flatten().copied().collect();
        plc.surface = surface;
        said(&report)
    }

    /// Gives regions their sizes and growths, and checks that those with layers exist.
    pub fn limit_regions(&mut self, plan: &TetPlan) -> Result<(), Failure> {
        let missing =
            |flag: &str, id: i32| Failure::usage(format!("{flag}: no region of the input has the number {id}"));
        for &(id, size) in &plan.region_sizes {
            self.regions_of(id).ok_or_else(|| missing("--region-size", id))?.for_each(|r| r.size = Some(size));
        }
        for &(id, growth) in &plan.region_growths {
            self.regions_of(id).ok_or_else(|| missing("--region-growth", id))?.for_each(|r| r.growth = Some(growth));
        }
        for &id in &plan.layers_in {
            if self.regions_of(id).is_none() {
                return Err(missing("--layers-in", id));
            }
        }
        Ok(())
    }

    /// Regions with a number, if any.
    fn regions_of(&mut self, id: i32) -> Option<impl Iterator<Item = &mut Region>> {
        let mut found = self.plc.regions.iter_mut().filter(move |r| r.id == id).peekable();
        found.peek().is_some().then_some(found)
    }

    /// Removes segments that the mesh does not have; `ids` are ascending.
    pub fn leave_out(&mut self, ids: &[u32]) {
        let mut ids = ids.iter().peekable();
        let mut i = 0;
        self.plc.segments.retain(|_| {
            i += 1;
            ids.next_if_eq(&&(i - 1)).is_none()
        });
    }

    /// Takes over the segments of a remeshed surface. Returns true if attributes or markers of points are dropped, because the
    /// points are others.
    pub fn take_remeshed(&mut self, segments: &[[u32; 2]]) -> bool {
        self.plc.segments = segments.to_vec();
        let had = self.attribute_count > 0 || !self.point_markers.is_empty();
        (self.attribute_count, self.point_attributes, self.point_markers) = (0, Vec::new(), Vec::new());
        had
    }

    fn of_file(path: &Path, format: InputFormat) -> Result<Source, Failure> {
        let failed = |e: &dyn std::error::Error| Failure::input(e.to_string());
        if let Some(surface) = format.surface() {
            return Ok(Source::Surface(read_content_as(path, surface).map_err(|e| failed(&e))?));
        }
        if format == InputFormat::Npyd {
            return Ok(Source::Arrays(read_complex(path).map_err(|e| failed(&e))?));
        }
        match format.complex() {
            Some(format) => Ok(Source::Complex(tetgen::read_plc_as(path, format).map_err(|e| failed(&e))?)),
            None => Ok(Source::Points(tetgen::read_nodes_as(path).map_err(|e| failed(&e))?)),
        }
    }

    fn of_stream(format: InputFormat) -> Result<Source, Failure> {
        if format == InputFormat::Npyd {
            return Err(Failure::usage("standard input cannot be a folder of arrays: give its path"));
        }
        let mut bytes = Vec::new();
        let failed = |e: &dyn std::fmt::Display| Failure::input(format!("standard input: {e}"));
        std::io::stdin().lock().read_to_end(&mut bytes).map_err(|e| failed(&e))?;
        if bytes.trim_ascii().is_empty() {
            return Err(failed(&"empty"));
        }
        if let Some(surface) = format.surface() {
            return Ok(Source::Surface(read_content_from(&bytes, surface).map_err(|e| failed(&e))?));
        }
        match format.complex() {
            Some(format) => Ok(Source::Complex(tetgen::Plc::parse(&bytes, format).map_err(|e| failed(&e))?)),
            None => Ok(Source::Points(Nodes::parse(&bytes).map_err(|e| failed(&e))?)),
        }
    }

    fn of_points(nodes: Nodes) -> Self {
        Self {
            plc: Plc::new(nodes.points, Vec::new()),
            only_points: true,
            first: nodes.first,
            numbers: FileNumbers { first: nodes.first, ..FileNumbers::default() },
            point_markers: nodes.markers,
            point_attributes: nodes.attributes,
            attribute_count: nodes.attribute_count,
            ..Self::default()
        }
    }

    fn of_arrays(complex: ArrayComplex, plan: &TetPlan) -> Self {
        let ArrayComplex { mesh, markers, segments, holes, regions } = complex;
        let region = |ArrayRegion { point, id, max_volume }| {
            Region::new(point, id).max_volume(max_volume.filter(|_| plan.region_volumes))
        };
        let mut input = Self {
            marked: !markers.is_empty(),
            only_points: mesh.triangles.is_empty() && segments.is_empty(),
            plc: mesh.into(),
            ..Self::default()
        };
        let ordered = |[a, b]: [u32; 2]| [a.min(b), a.max(b)];
        input.plc.segments = segments.into_iter().map(ordered).filter(|[a, b]| a != b).collect();
        input.plc.segments.sort_unstable();
        input.plc.segments.dedup();
        input.plc.markers = markers;
        input.plc.holes = holes;
        input.plc.regions = regions.into_iter().map(region).collect();
        input
    }

    fn of_complex(mut file: tetgen::Plc, plan: &TetPlan) -> Result<Self, ComplexError> {
        if plan.repair {
            name_first_of_duplicates(&mut file);
        }
        let mut input = Self {
            marked: file.facets.iter().any(|facet| facet.marker != 0),
            facets: Some(file.facets.len()),
            first: file.first,
            numbers: FileNumbers { counted: Counted::Facets, first: file.first, cut: true, ..FileNumbers::default() },
            point_markers: file.point_markers,
            point_attributes: file.point_attributes,
            attribute_count: file.attribute_count,
            ..Self::default()
        };
        for (facet, piece) in file.facets.iter().enumerate() {
            let cut = facets::triangulate(&file.points, &piece.polygons, &piece.holes);
            let FacetTriangles { triangles, segments } = cut.map_err(|fault| {
                let (facet, first) = (facet + file.first as usize, file.first);
                ComplexError::Facet { facet, first, fault: fault.renamed(|point| point + first) }
            })?;
            let face_of = &mut input.numbers.face_of;
            face_of.resize(face_of.len() + triangles.len(), facet as u32);
            input.plc.markers.resize(input.plc.markers.len() + triangles.len(), piece.marker);
            input.plc.surface.triangles.extend(triangles);
            input.plc.segments.extend(segments);
        }
        input.plc.segments.sort_unstable();
        input.plc.segments.dedup();
        (input.plc.regions, input.attributes) = regions(&file.regions, plan);
        if !input.attributes.is_empty() {
            input
                .notes
                .push("region attributes are not whole numbers: regions are numbered from 1 by attribute".into());
        }
        input.plc.surface.points = file.points;
        input.plc.holes = file.holes;
        input.only_points = input.plc.surface.triangles.is_empty() && input.plc.segments.is_empty();
        Ok(input)
    }
}

/// Contents of a file.
enum Source {
    Surface(SurfaceContent),
    Points(Nodes),
    Arrays(ArrayComplex),
    Complex(tetgen::Plc),
}

/// Reason why a facet complex is invalid. Facets and points are numbered as in the file.
#[derive(Debug, thiserror::Error)]
enum ComplexError {
    #[error("facet {facet} (facets and points count from {first}) cannot be triangulated: {fault}")]
    Facet { facet: usize, first: u32, fault: facets::FacetError },
}

/// Regions of a file. Attributes that are not whole numbers become ids from 1, in ascending order of the attributes, which
/// are returned with their ids.
fn regions(listed: &[tetgen::Region], plan: &TetPlan) -> (Vec<Region>, Vec<(i32, f64)>) {
    let is_whole = |a: f64| a.fract() == 0.0 && a.abs() <= f64::from(i32::MAX);
    let mut attributes: Vec<f64> = listed.iter().map(|region| region.attribute).collect();
    attributes.sort_unstable_by(f64::total_cmp);
    attributes.dedup();
    let numbered = if attributes.iter().all(|&a| is_whole(a)) { Vec::new() } else { (1..).zip(attributes).collect() };
    let id = |attribute: f64| {
        let found = numbered.iter().find(|(_, a): &&(i32, f64)| *a == attribute);
        found.map_or(attribute as i32, |(id, _)| *id)
    };
    let region = |&tetgen::Region { point, attribute, max_volume }: &tetgen::Region| {
        Region::new(point, id(attribute)).max_volume(max_volume.filter(|_| plan.region_volumes))
    };
    (listed.iter().map(region).collect(), numbered)
}

/// Replaces duplicate points in polygons by the first of them.
fn name_first_of_duplicates(file: &mut tetgen::Plc) {
    let mut known = FxHashMap::default();
    let first: Vec<u32> = file.points.iter().zip(0..).map(|(p, i)| *known.entry(place_key(p)).or_insert(i)).collect();
    for corner in file.facets.iter_mut().flat_map(|facet| facet.polygons.iter_mut().flatten()) {
        *corner = first[*corner as usize];
    }
}

/// Changes of a repair, one sentence per kind.
fn said(report: &RepairReport) -> Vec<String> {
    let counts = [
        (report.merged_points, "duplicate point", "merged"),
        (report.collapsed_triangles, "degenerate triangle", "removed"),
        (report.duplicate_triangles, "duplicate triangle", "removed"),
        (report.sheet_triangles, "back-to-back triangle", "removed"),
        (report.flat_triangles, "triangle", "without area merged into a neighbour"),
        (report.turned_triangles, "triangle", "reoriented"),
        (report.not_orientable, "part", "not orientable"),
    ];
    let found = counts.iter().filter(|(count, ..)| *count > 0);
    found.map(|&(count, what, change)| format!("{} {change}", counted(count, what))).collect()
}
