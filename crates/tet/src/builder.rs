//! Builder of tetrahedralizations: options, runs and results.

use super::certify::Place;
use super::contacts;
use super::error::{LayersConflict, TetError};
use super::fill::fill;
use super::layer::Layers;
use super::layers::{LayerSides, LayerSummary, Layered, layered};
use super::optimize::{Effort, OptimizeReport};
use super::options::{Boundary, Interior, Refinement, Sizing};
use super::outside::without;
use super::plc::LeftOut;
use super::plc::{InputKind, InputPart, Plc, PlcRef};
use super::progress::{Progress, Stage, Watch};
use super::recover::RecoverySummary;
use super::refine::RefineReport;
use super::remesh::{RemeshSummary, Remeshed, Wanted, remesh};
use super::request::Request;
use super::{delaunay, input, sized};
use anastomesh_mesh::geometry::Point3;
use anastomesh_mesh::{TetMesh, TriMesh};
use std::borrow::Cow;
use std::sync::Arc;

/// Tetrahedralizer of surfaces, piecewise linear complexes and points. The crate's page has an example.
///
/// It can be cloned, sent to other threads and reused. Runs share no state.
///
/// ```
/// use anastomesh_tet::{Interior, Tetrahedralizer};
///
/// let surface = anastomesh_mesh::shapes::sphere_surface(2);
/// let made = Tetrahedralizer::new().interior(Interior::None).optimize(false).run(&surface)?;
/// assert_eq!(made.faces, surface.triangles);
/// # Ok::<(), anastomesh_tet::TetError>(())
/// ```
#[derive(Clone)]
pub struct Tetrahedralizer {
    kind: InputKind,
    interior: Interior,
    /// True if edge lengths of a growing interior grow as fast as they may.
    spaced: bool,
    /// Edge lengths at points inside.
    sources: Arc<[(Point3, f64)]>,
    refinement: Option<Refinement>,
    sizing: Sizing,
    boundary: Boundary,
    layers: Option<Layers>,
    layers_on: Vec<i32>,
    layers_in: Vec<i32>,
    optimize: bool,
    effort: Effort,
    strict: bool,
    max_tets: usize,
    progress: Option<Arc<dyn Progress + Send>>,
}

/// Certified mesh, with a summary of its run.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Tetrahedralization {
    /// The mesh. Its points begin with all points of the input, in their order and bit for bit, including unused ones. With
    /// [`Boundary::Remesh`] they begin with the points of the remeshed surface.
    pub mesh: TetMesh,
    /// Region of each tetrahedron. Empty for a single region without an id from a seed.
    pub regions: Vec<i32>,
    /// Input triangles in their order, or their pieces if they were split, or the triangles of the remeshed surface. Triangles of `summary.left_out` are omitted.
    /// Boundary triangles are oriented outwards; interior ones keep their orientation.
    pub faces: Vec<[u32; 3]>,
    /// Marker of each of `faces`; empty if the input has no markers.
    pub face_markers: Vec<i32>,
    /// Input triangle of each of `faces`, or the one that it is a piece of. In a plane facet whose edges were flipped, it is one
    /// of the facet's triangles. In a remeshed surface it is the input triangle close to its centroid. Empty if each face is the input triangle of the same index, because none was split or left out.
    pub origins: Vec<u32>,
    /// Layer of each tetrahedron, counted from 1 at the wall; 0 inside the layers. Empty in a mesh without layers.
    pub layers: Vec<i32>,
    /// Summary of the run.
    pub summary: Summary,
}

/// Summary of a run.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Summary {
    /// Result of the recovery.
    pub recovery: RecoverySummary,
    /// Result of the improvement, if requested.
    pub optimize: Option<OptimizeReport>,
    /// Result of the refinement, if requested.
    pub refine: Option<RefineReport>,
    /// Number of regions.
    pub regions: usize,
    /// Seeds without effect, as indices into [`Plc::regions`](crate::Plc::regions), each with the earlier seed in its region.
    pub ignored_seeds: Vec<[u32; 2]>,
    /// Boundary triangles that were oriented inwards in the input.
    pub reversed: usize,
    /// Input triangles between two tetrahedra.
    pub interior_faces: usize,
    /// Triangles and segments of the input that lie outside the filled region or in a hole. The mesh does not contain
    /// them. Always empty in a strict run.
    pub left_out: LeftOut,
    /// Result of the layers, if requested.
    pub layers: Option<LayerSummary>,
    /// Change of the surface by remeshing, if requested.
    pub remesh: Option<RemeshSummary>,
}

impl Default for Tetrahedralizer {
    fn default() -> Self {
        Self {
            kind: InputKind::default(),
            interior: Interior::default(),
            spaced: false,
            sources: Arc::default(),
            refinement: None,
            sizing: Sizing::default(),
            boundary: Boundary::default(),
            layers: None,
            layers_on: Vec::new(),
            layers_in: Vec::new(),
            optimize: true,
            effort: Effort::Full,
            strict: false,
            max_tets: Self::MAX_TETS,
            progress: None,
        }
    }
}

impl Tetrahedralizer {
    /// Default of [`Tetrahedralizer::max_tets`]. They need 4 to 8 GB.
    pub const MAX_TETS: usize = 40_000_000;

    /// Default options: closed surfaces are kept, points fill the interior with a spacing that grows away from the surface,
    /// and the mesh is improved.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Kind of the input.
    #[must_use]
    pub fn kind(mut self, kind: InputKind) -> Self {
        self.kind = kind;
        self
    }

    /// Interior points, inserted before recovery.
    #[must_use]
    pub fn interior(mut self, interior: Interior) -> Self {
        self.interior = interior;
        self
    }

    /// Delaunay refinement: tetrahedra that are too large or badly shaped are split.
    #[must_use]
    pub fn refine(mut self, refinement: impl Into<Option<Refinement>>) -> Self {
        self.refinement = refinement.into();
        self
    }

    /// Edge length of a refined mesh.
    #[must_use]
    pub fn sizing(mut self, sizing: Sizing) -> Self {
        self.sizing = sizing;
        self
    }

    /// Allows splitting of input triangles, or remeshing of the surface.
    #[must_use]
    pub fn boundary(mut self, boundary: Boundary) -> Self {
        self.boundary = boundary;
        self
    }

    /// Layers of thin tetrahedra along a closed surface, or along the facets of a complex. All other options apply to the
    /// volume inside the layers.
    ///
    /// In a complex, facets between two regions have layers on both sides. [`Tetrahedralizer::layers_in`] limits them to some
    /// regions. Facets with one region on both sides have none. Layers have thickness zero at these facets, and at segments.
    #[must_use]
    pub fn layers(mut self, layers: impl Into<Option<Layers>>) -> Self {
        self.layers = layers.into();
        self
    }

    /// Limits the layers to triangles with these markers; an empty list stands for all triangles.
    ///
    /// Flat parts with other markers, such as inlets, shrink towards their centres. A ring of layers takes the rest of their
    /// area. These parts then have more triangles than the input. Layers end with thickness zero
    /// at parts that are curved, not star-shaped or shared by two regions, which stay unchanged.
    #[must_use]
    pub fn layers_on(mut self, markers: impl Into<Vec<i32>>) -> Self {
        self.layers_on = markers.into();
        self
    }

    /// Limits the layers to regions with these ids, such as the fluid; an empty list stands for all regions. Ids are those of
    /// [`Region::id`](crate::Region::id).
    ///
    /// ```
    /// use anastomesh_tet::{InputKind, Layers, Plc, Point3, Region, Tetrahedralizer};
    ///
    /// let mut plc = Plc::from(anastomesh_mesh::shapes::sphere_surface(2));
    /// plc.regions = vec![Region::new(Point3::origin(), 7)];
    /// let made = Tetrahedralizer::new().kind(InputKind::Plc).layers(Layers::default()).layers_in([7]).run(&plc)?;
    /// let layers = made.summary.layers.ok_or("no layers")?;
    /// assert_eq!((layers.tets, layers.regions), (3 * 3 * plc.surface.triangles.len(), 1));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn layers_in(mut self, regions: impl Into<Vec<i32>>) -> Self {
        self.layers_in = regions.into();
        self
    }

    /// Turns the improvement on or off. It keeps the boundary.
    #[must_use]
    pub fn optimize(mut self, optimize: bool) -> Self {
        self.optimize = optimize;
        self
    }

    /// Effort of the improvement; by default the largest.
    #[must_use]
    pub fn effort(mut self, effort: Effort) -> Self {
        self.effort = effort;
        self
    }

    /// Fails with [`TetError::Outside`] if triangles or segments have only the outside or holes on all their sides.
    /// Otherwise they are left out and listed in the summary. Their points remain in the mesh, unused.
    #[must_use]
    pub fn strict(mut self, strict: bool) -> Self {
        self.strict = strict;
        self
    }

    /// Limits the number of tetrahedra. A run that expects more ends with [`TetError::TooMany`] before it begins. A
    /// refinement that reaches the limit ends with it, too.
    ///
    /// ```
    /// use anastomesh_tet::{Sizing, TetError, Tetrahedralizer};
    ///
    /// let surface = anastomesh_mesh::shapes::sphere_surface(2);
    /// let fine = Tetrahedralizer::new().sizing(Sizing::Constant(1e-4)).run(&surface);
    /// assert!(matches!(fine, Err(TetError::TooMany { .. })));
    /// # Ok::<(), anastomesh_tet::TetError>(())
    /// ```
    #[must_use]
    pub fn max_tets(mut self, limit: usize) -> Self {
        self.max_tets = limit;
        self
    }

    /// Listener for progress and cancellation. A cancelled run ends with [`TetError::Cancelled`].
    #[must_use]
    pub fn progress(mut self, progress: impl Progress + Send + 'static) -> Self {
        self.progress = Some(Arc::new(progress));
        self
    }

    /// Checks a number of tetrahedra that a run has reached.
    pub(super) fn ensure_within(&self, tets: usize) -> Result<(), TetError> {
        if tets <= self.max_tets { Ok(()) } else { Err(TetError::TooMany { estimate: tets, limit: self.max_tets }) }
    }

    /// Requested interior and sizing.
    pub(super) fn spacing(&self) -> (&Interior, &Sizing) {
        (&self.interior, &self.sizing)
    }

    /// Requested refinement and sizing.
    pub(super) fn refinement_and_sizing(&self) -> (Option<&Refinement>, &Sizing) {
        (self.refinement.as_ref(), &self.sizing)
    }

    pub(super) fn watch(&self) -> Watch<'_> {
        self.progress.as_deref().map_or(Watch::NOBODY, |progress| Watch::of(progress))
    }

    /// Meshes a surface (`&TriMesh`) or a complex (`&Plc`) without copying it. A returned mesh has passed the certificate:
    /// each input triangle on or in the filled volume is one of its faces.
    ///
    /// # Errors
    /// [`TetError`]: the fault of the input, or the part that could not be recovered.
    pub fn run<'a>(&self, input: impl Into<PlcRef<'a>>) -> Result<Tetrahedralization, TetError> {
        self.run_watched(input.into(), &self.watch())
    }

    /// As [`Tetrahedralizer::run`], with a watch.
    pub(super) fn run_watched(&self, plc: PlcRef, watch: &Watch) -> Result<Tetrahedralization, TetError> {
        watch.report(Stage::Validate, 0, 1)?;
        input::check_lengths(plc)?;
        let surface = plc.surface;
        let edges = input::validate(surface, plc.segments, self.kind)?;
        watch.report(Stage::Validate, 1, 1)?;
        self.check_layers(plc)?;
        sized::check_growth(&self.interior, plc.regions)?;
        if self.boundary == Boundary::Split {
            sized::check(self.refinement.as_ref(), &self.sizing, surface.points.len())?;
            return self.run_split(plc);
        }
        if let Boundary::Remesh { tolerance } = self.boundary {
            return self.run_remeshed(plc, tolerance, watch);
        }
        let request = Request {
            surface,
            edges: &edges,
            segments: plc.segments,
            kind: self.kind,
            baffles: 0,
            holes: if self.kind == InputKind::Plc { plc.holes } else { &[] },
            regions: plc.regions,
            region: None,
            interior: &self.interior,
            refinement: self.refinement.as_ref(),
            sizing: &self.sizing,
            heights: &[],
            optimize: self.optimize,
            certify: true,
            spaced: self.spaced,
            sources: &self.sources,
            spare_needles: true,
            effort: self.effort,
            strict: self.strict,
            max_tets: Some(self.max_tets),
            label: true,
            watch,
        };
        let (filled, layers, of_tets, outer) = match &self.layers {
            Some(layers) => {
                let sides = LayerSides { markers: plc.markers, on: &self.layers_on, within: &self.layers_in };
                let Layered { filled, summary, of_tets, outer } = layered(&request, layers, &sides)?;
                (filled, Some(summary), of_tets, outer)
            }
            None => (fill(&request)?, None, Vec::new(), None),
        };
        let outward = |(t, place): (&[u32; 3], &Place)| match place {
            Place::Reversed => [t[0], t[2], t[1]],
            Place::Boundary | Place::Inside => *t,
        };
        let count = |wanted: Place| filled.places.iter().filter(|&&p| p == wanted).count();
        let outside = &filled.left_out.triangles;
        let (kept, origins, face_markers) = if let Some((outer, origins)) = outer {
            let markers = origins.iter().filter_map(|&t| plc.markers.get(t as usize).copied()).collect();
            (Cow::Owned(outer), origins, markers)
        } else {
            let origins = if outside.is_empty() { Vec::new() } else { without(&triangle_ids(surface), outside) };
            (filled.left_out.kept_surface(surface), origins, without(plc.markers, outside))
        };
        Ok(Tetrahedralization {
            faces: kept.triangles.iter().zip(&filled.places).map(outward).collect(),
            face_markers,
            origins,
            summary: Summary {
                recovery: filled.recovery,
                optimize: filled.optimize,
                refine: filled.refine,
                regions: filled.region_count,
                ignored_seeds: filled.ignored_seeds,
                reversed: count(Place::Reversed),
                interior_faces: count(Place::Inside),
                left_out: filled.left_out,
                layers,
                remesh: None,
            },
            mesh: filled.mesh,
            regions: filled.regions,
            layers: of_tets,
        })
    }

    /// Meshes a checked complex after remeshing its surface.
    fn run_remeshed(&self, plc: PlcRef, tolerance: Option<f64>, watch: &Watch) -> Result<Tetrahedralization, TetError> {
        sized::check(self.refinement.as_ref(), &self.sizing, plc.surface.points.len())?;
        contacts::no_contacts(plc.surface, watch)?;
        let keep = match &self.sizing {
            // The lengths at points of the input also apply to the new points.
            Sizing::PerVertex(_) => {
                let size: sized::SizeFunction = Arc::new(sized::size_function(plc.surface, &self.sizing, None));
                self.clone().sizing(Sizing::Function(size))
            }
            _ => self.clone(),
        };
        let keep = keep.boundary(Boundary::Keep);
        let Remeshed { plc: new, origins, summary } = keep.remeshed(plc, tolerance, watch)?;
        let origin = |&t: &u32| origins.get(t as usize).copied().unwrap_or(t);
        let mut done = keep.run_watched((&new).into(), watch).map_err(|error| match error {
            TetError::Outside { part: part @ InputPart::Triangles, ids, count } => {
                TetError::Outside { part, ids: ids.iter().map(origin).collect(), count }
            }
            other => other,
        })?;
        done.origins =
            if done.origins.is_empty() { origins.clone() } else { done.origins.iter().map(origin).collect() };
        let left_out = &mut done.summary.left_out.triangles;
        *left_out = left_out.iter().map(origin).collect();
        left_out.sort_unstable();
        left_out.dedup();
        done.summary.remesh = Some(summary);
        Ok(done)
    }

    /// Remeshes the surface of a checked complex. Lengths are not given per point.
    fn remeshed(&self, plc: PlcRef, tolerance: Option<f64>, watch: &Watch) -> Result<Remeshed, TetError> {
        let max_volume = self.refinement.as_ref().and_then(|r| r.bounds.max_volume);
        let constant;
        let size: Option<&dyn Fn(&Point3) -> f64> = match &self.sizing {
            Sizing::Surface | Sizing::PerVertex(_) => None,
            Sizing::Constant(size) => {
                constant = move |_: &Point3| *size;
                Some(&constant)
            }
            Sizing::Function(size) => Some(size.as_ref()),
        };
        let longest = max_volume.map_or(f64::INFINITY, sized::edge_of_volume);
        remesh(plc, &Wanted { tolerance, size, longest, most: self.max_tets }, watch)
    }

    /// Checks the requested layers, and their combination with other options.
    fn check_layers(&self, plc: PlcRef) -> Result<(), TetError> {
        let Some(layers) = &self.layers else { return Ok(()) };
        layers.check()?;
        let along = |what| Err(TetError::LayersAlong(what));
        match () {
            () if self.boundary == Boundary::Split => along(LayersConflict::SplitBoundary),
            () if self.layers_on.iter().any(|marker| !plc.markers.contains(marker)) => along(LayersConflict::Marker),
            () => Ok(()),
        }
    }

    /// Checks an input without meshing it.
    ///
    /// It makes all checks of [`Tetrahedralizer::run`], and verifies that no points coincide and no triangle is
    /// duplicated. Triangles may intersect only in common vertices and edges, and no other point may lie in a triangle.
    /// Segments are not tested against triangles.
    ///
    /// ```
    /// use anastomesh_tet::{EdgeFaults, TetError, Tetrahedralizer};
    ///
    /// let mut surface = anastomesh_mesh::shapes::sphere_surface(2);
    /// surface.triangles.pop();
    /// let fault = Tetrahedralizer::new().check(&surface);
    /// assert!(matches!(fault, Err(TetError::Open(EdgeFaults { edges: 3, .. }))), "{fault:?}");
    /// # Ok::<(), anastomesh_tet::TetError>(())
    /// ```
    ///
    /// # Errors
    /// The first fault, with the ids of the offenders.
    pub fn check<'a>(&self, input: impl Into<PlcRef<'a>>) -> Result<(), TetError> {
        let plc = input.into();
        let surface = plc.surface;
        let watch = self.watch();
        watch.report(Stage::Validate, 0, 1)?;
        input::check_lengths(plc)?;
        input::validate(surface, plc.segments, self.kind)?;
        input::no_duplicate_points(&surface.points)?;
        input::no_duplicate_triangles(&surface.triangles)?;
        contacts::no_contacts(surface, &watch)?;
        contacts::no_points_in_triangles(surface)?;
        watch.report(Stage::Validate, 1, 1)
    }

    /// Returns the Delaunay tetrahedralization of points. `faces` are those of the convex hull.
    ///
    /// A returned mesh has passed a certificate: every tetrahedron is positive, and tetrahedra meet face to face. They
    /// fill the convex hull of the points without overlaps. Empty spheres are not part of the certificate.
    ///
    /// ```
    /// use anastomesh_mesh::Point3;
    ///
    /// let points = vec![Point3::origin(), Point3::new(1., 0., 0.), Point3::new(0., 1., 0.), Point3::new(0., 0., 1.)];
    /// let made = anastomesh_tet::Tetrahedralizer::new().delaunay(&points)?;
    /// assert_eq!((made.mesh.tets.len(), made.faces.len()), (1, 4));
    /// # Ok::<(), anastomesh_tet::TetError>(())
    /// ```
    ///
    /// # Errors
    /// [`TetError::Empty`], [`TetError::OutOfRange`], [`TetError::DuplicatePoints`], [`TetError::Flat`],
    /// [`TetError::Cancelled`].
    pub fn delaunay(&self, points: &[Point3]) -> Result<Tetrahedralization, TetError> {
        let watch = self.watch();
        watch.report(Stage::Delaunay, 0, 1)?;
        let made = delaunay::delaunay_ordered(points, &watch)?;
        watch.report(Stage::Delaunay, 1, 1)?;
        watch.report(Stage::Certify, 0, 1)?;
        let faces = made.certify(points)?;
        let mesh = made.into_mesh(points);
        watch.report(Stage::Certify, 1, 1)?;
        Ok(Tetrahedralization { mesh, faces, ..Tetrahedralization::default() })
    }
}

/// Fills a closed surface in any orientation, as [`Tetrahedralizer::run`] does, with selected points in a growing interior.
/// Their distances follow the growth, where the cubes of an octree grow by at most a fifth per layer.
///
/// # Errors
/// Those of [`Tetrahedralizer::run`]; [`TetError::Cancelled`] if the watch asks to stop.
pub fn fill_spaced(by: &Tetrahedralizer, surface: &TriMesh, watch: &Watch) -> Result<Tetrahedralization, TetError> {
    fill_around(by, surface, &[], watch)
}

/// As [`fill_spaced`], with edge lengths at points inside, from which they grow as from the surface.
///
/// # Errors
/// See [`fill_spaced`].
pub fn fill_around(
    by: &Tetrahedralizer,
    surface: &TriMesh,
    sources: &[(Point3, f64)],
    watch: &Watch,
) -> Result<Tetrahedralization, TetError> {
    Tetrahedralizer { spaced: true, sources: sources.into(), ..by.clone() }.run_watched(surface.into(), watch)
}

/// Remeshes closed surfaces as [`Boundary::Remesh`] does, with edges of about this length, or of their own lengths.
/// `markers` tell the surfaces apart. Returns the new surface, and the marker of each of its triangles.
///
/// # Errors
/// Those of [`Tetrahedralizer::run`] for the surface, size and tolerance.
pub fn remesh_closed(
    surface: &TriMesh,
    markers: &[i32],
    (size, tolerance): (Option<f64>, Option<f64>),
    watch: &Watch,
) -> Result<(TriMesh, Vec<i32>), TetError> {
    let sizing = size.map_or(Sizing::Surface, Sizing::Constant);
    sized::check(None, &sizing, surface.points.len())?;
    input::validate(surface, &[], InputKind::Closed)?;
    contacts::no_contacts(surface, watch)?;
    let plc = Plc::from(surface).markers(markers.to_vec());
    let made = Tetrahedralizer::new().sizing(sizing).remeshed((&plc).into(), tolerance, watch)?;
    Ok((made.plc.surface, made.plc.markers))
}

/// Fills a closed surface that is oriented outwards, with the interior, improvement and effort of the tetrahedralizer.
///
/// The points of the mesh begin with those of the surface. The mesh has no certificate; callers check their final mesh.
///
/// # Errors
/// [`TetError`]; [`TetError::Cancelled`] if the watch asks to stop.
pub fn fill_outward(by: &Tetrahedralizer, surface: &TriMesh, watch: &Watch) -> Result<TetMesh, TetError> {
    let edges = input::validate(surface, &[], InputKind::Closed)?;
    input::outward(surface)?;
    let request = Request {
        surface,
        edges: &edges,
        segments: &[],
        kind: InputKind::Closed,
        baffles: 0,
        holes: &[],
        regions: &[],
        region: None,
        interior: &by.interior,
        refinement: None,
        sizing: &Sizing::Surface,
        heights: &[],
        optimize: by.optimize,
        certify: false,
        spaced: by.spaced,
        sources: &by.sources,
        spare_needles: false,
        effort: by.effort,
        strict: true,
        max_tets: None,
        label: false,
        watch,
    };
    Ok(fill(&request)?.mesh)
}

fn triangle_ids(surface: &TriMesh) -> Vec<u32> {
    (0..surface.triangles.len() as u32).collect()
}

impl std::fmt::Debug for Tetrahedralizer {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        f.debug_struct("Tetrahedralizer")
            .field("kind", &self.kind)
            .field("interior", &self.interior)
            .field("refinement", &self.refinement)
            .field("sizing", &self.sizing)
            .field("boundary", &self.boundary)
            .field("optimize", &self.optimize)
            .field("effort", &self.effort)
            .field("strict", &self.strict)
            .field("max_tets", &self.max_tets)
            .field("watch", &self.watch())
            .finish_non_exhaustive()
    }
}
