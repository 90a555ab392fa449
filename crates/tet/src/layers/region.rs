//! A region filled with layers along its wall, or without.

use super::caps::{Cap, caps as caps_of, shrunk};
use super::constraints::Constraints;
use super::direction::Directions;
use super::half_width::half_widths;
use super::inset::{Inset, Places, inset, lower};
use super::local::Local;
use super::slide::Slides;
use super::stack::{Numbers, rims};
use crate::error::{Obstacle, Stuck, TetError};
use crate::fill::fill;
use crate::input;
use crate::layer::Layers;
use crate::optimize::OptimizeReport;
use crate::plc::InputKind;
use crate::recover::RecoverySummary;
use crate::refine::RefineReport;
use crate::request::{Filled, Request};
use anastomesh_mesh::geometry::{Point3, Vec3};
use anastomesh_mesh::{TetMesh, TriMesh};
use rustc_hash::FxHashSet;

/// Maximum difference of neighbouring thicknesses, relative to their distance.
const GRADE: f64 = 0.3;

/// Filled region. All numbers are those of the region.
#[derive(Default)]
pub(super) struct FilledRegion {
    /// Mesh, whose first tetrahedra are those of the layers. Its points begin with those of the region.
    pub mesh: TetMesh,
    /// Layer of each layer tetrahedron, counted from 1 at the wall.
    pub of_layers: Vec<i32>,
    /// Vertices of the wall, ascending, and their thicknesses relative to those asked for.
    pub shares: Vec<(u32, f64)>,
    /// Flat parts without layers that shrank or slid.
    pub discs: Vec<Disc>,
    /// Number of parts beside the layers that keep their triangles.
    pub kept_caps: usize,
    pub recovery: RecoverySummary,
    pub optimize: Option<OptimizeReport>,
    pub refine: Option<RefineReport>,
}

/// Flat part without layers that shrank, or whose vertices at the wall slid.
pub(super) struct Disc {
    /// Its triangles, as indices into the boundary.
    pub triangles: Vec<u32>,
    /// New vertices of these triangles, followed by the triangles of the ring around them.
    pub faces: Vec<[u32; 3]>,
}

/// Fills a region without layers.
pub(super) fn fill_plain(r: &Request, local: &Local) -> Result<FilledRegion, TetError> {
    let edges = input::validate(&local.surface, &local.segments, InputKind::Plc)?;
    let Filled { mesh, recovery, optimize, refine, .. } = fill(&local.request(r, &local.surface, &edges))?;
    Ok(FilledRegion { mesh, recovery, optimize, refine, ..FilledRegion::default() })
}

/// Part of the boundary of a region that gets layers.
pub(super) struct Wall<'a> {
    local: &'a Local<'a>,
    layers: &'a Layers,
    triangles: Vec<[u32; 3]>,
    is_rim: Vec<bool>,
    constraints: Constraints,
    caps: Vec<Cap>,
    slides: Slides,
    /// Inward direction at each vertex.
    ways: Vec<Vec3>,
    /// Offset asked for at each vertex.
    asked: Vec<f64>,
}

/// Wanted inner positions, and results of filling inside the layers.
struct Core {
    wanted: Vec<Point3>,
    recovery: RecoverySummary,
    optimize: Option<OptimizeReport>,
    refine: Option<RefineReport>,
}

impl<'a> Wall<'a> {
    /// Wall of the boundary triangles for which `is_wall` is true. `markers` are those of the boundary, and `uses` counts the
    /// triangles of the input at each vertex.
    pub(super) fn new(
        local: &'a Local,
        is_wall: &[bool],
        (markers, uses): (&[i32], &[u32]),
        layers: &'a Layers,
    ) -> Self {
        let surface = &local.surface;
        let triangles: Vec<[u32; 3]> =
            surface.triangles.iter().zip(is_wall).filter(|(_, wall)| **wall).map(|(t, _)| *t).collect();
        let is_rim = rims(surface, |t| is_wall.get(t).copied().unwrap_or(false));
        let constraints = Constraints::of(local);
        let kinds: Vec<(i32, bool)> =
            markers.iter().zip(&local.shape.boundary).map(|(&marker, side)| (marker, side.is_outer)).collect();
        let (caps, slides, asked, ways) = Default::default();
        let mut wall = Self { local, layers, triangles, is_rim, constraints, caps, slides, ways, asked };
        wall.caps = caps_of(surface, is_wall, &kinds);
        wall.hold_caps(uses);
        wall.set_directions();
        wall
    }

    /// Keeps the flat parts without layers that must not shrink.
    fn hold_caps(&mut self, uses: &[u32]) {
        let mut caps = std::mem::take(&mut self.caps);
        for cap in caps.iter_mut().filter(|cap| cap.centre.is_some()) {
            cap.centre = cap.centre.filter(|_| self.is_free(cap, uses));
        }
        self.caps = caps;
    }

    /// Sets inward directions and offsets.
    fn set_directions(&mut self) {
        let surface = &self.local.surface;
        let mut directions = Directions::new(&surface.points, &self.triangles);
        let pinned = &self.constraints.is_pinned;
        directions.ways.iter_mut().zip(pinned).filter(|(_, pinned)| **pinned).for_each(|(way, _)| way.fill(0.0));
        let mut owners = vec![0_u32; surface.points.len()];
        self.caps.iter().flat_map(|cap| &cap.vertices).for_each(|&v| owners[v as usize] += 1);
        let kept: Vec<&Cap> = self.caps.iter().filter(|cap| cap.centre.is_none() && !self.has_segment(cap)).collect();
        let is_free = |v: u32| owners[v as usize] == 1 && !pinned[v as usize];
        let is_outer = |t: u32| self.local.shape.boundary[t as usize].is_outer;
        let slides = Slides::find((surface, &self.is_rim), &kept, &(is_free, is_outer), &mut directions);
        let mut asked = half_widths(surface, &slides.probes(&directions.ways));
        self.constraints.limit(&mut asked, &surface.points);
        self.asked = asked.into_iter().map(|half| self.layers.thickness * half).collect();
        (self.slides, self.ways) = (slides, directions.ways);
    }

    /// Fills the region. If it cannot be filled with the parts that shrink or slide, they keep their triangles.
    pub(super) fn fill(mut self, r: &Request) -> Result<FilledRegion, TetError> {
        let changes = self.caps.iter().any(|cap| cap.centre.is_some()) || !self.slides.is_empty();
        let (inset, core) = match self.inset(r) {
            Err(error) if !error.is_stop() && changes => {
                self.caps.iter_mut().for_each(|cap| cap.centre = None);
                self.slides = Slides::default();
                self.inset(r)?
            }
            made => made?,
        };
        let discs = discs(&inset.numbers, &self.local.surface, &self.caps);
        let beside = |cap: &&Cap| cap.vertices.iter().any(|&v| self.is_rim[v as usize]);
        Ok(FilledRegion {
            of_layers: inset.numbers.layers_at(&self.triangles),
            shares: self.shares(&inset, &core),
            kept_caps: self.caps.iter().filter(beside).count() - discs.len(),
            discs,
            mesh: inset.mesh,
            recovery: core.recovery,
            optimize: core.optimize,
            refine: core.refine,
        })
    }

    /// True if nothing but the region and its layers meets a flat part without layers, so that it may shrink.
    fn is_free(&self, cap: &Cap, uses: &[u32]) -> bool {
        let Local { shape, surface, .. } = self.local;
        let mut here = vec![0; surface.points.len()];
        cap.triangles.iter().flat_map(|&t| surface.triangles[t as usize]).for_each(|v| here[v as usize] += 1);
        let is_own = |&v: &u32| {
            let v = v as usize;
            !self.constraints.is_pinned[v] && (self.is_rim[v] || here[v] == uses[shape.points[v] as usize])
        };
        let is_outer = |&t: &u32| shape.boundary[t as usize].is_outer;
        cap.triangles.iter().all(is_outer) && cap.vertices.iter().all(is_own) && !self.has_segment(cap)
    }

    /// True if a segment of the input is an edge inside a part without layers.
    fn has_segment(&self, cap: &Cap) -> bool {
        let Local { shape, surface, .. } = self.local;
        if shape.edges.is_empty() {
            return false;
        }
        let sides = |t: [u32; 3]| [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]].map(|[a, b]| [a.min(b), a.max(b)]);
        let of_wall: FxHashSet<[u32; 2]> = self.triangles.iter().flat_map(|&t| sides(t)).collect();
        let given = |edge: [u32; 2]| edge.map(|v| shape.points[v as usize]);
        let inside = cap.triangles.iter().flat_map(|&t| sides(surface.triangles[t as usize]));
        inside.filter(|edge| !of_wall.contains(edge)).any(|edge| shape.edges.binary_search(&given(edge)).is_ok())
    }

    /// Fills the surface inside the layers, which end at caps.
    fn inset(&self, r: &Request) -> Result<(Inset, Core), TetError> {
        let Self { local, layers, slides, .. } = self;
        let points = &local.surface.points;
        let mut held = shrunk(&local.surface, &self.caps, layers.thickness);
        held.iter_mut().enumerate().filter(|(v, _)| slides.has(*v)).for_each(|(_, place)| *place = None);
        let of_cap = |v: usize| held[v].map(|p| (p - points[v]).norm());
        let mut heights: Vec<f64> = (0..points.len()).map(|v| of_cap(v).unwrap_or(self.asked[v])).collect();
        lower(&mut heights, points, &self.triangles, GRADE);
        slides.fit(&mut heights, &self.ways, (points, &self.triangles), GRADE);
        let wanted = |v: usize| held[v].unwrap_or_else(|| points[v] + self.ways[v] * heights[v]);
        let places = Places {
            surface: &local.surface,
            wall: &self.triangles,
            is_rim: self.is_rim.clone(),
            wanted: (0..points.len()).map(wanted).collect(),
            is_held: held.iter().map(Option::is_some).collect(),
            is_narrow: true,
        };
        let (mut recovery, mut optimize, mut refine) = Default::default();
        let made = inset(&places, &layers.depths(), |inner| {
            if let Some(&part) = slides.small(points, |v| inner.points[v as usize], 0.0).first() {
                return Err(TetError::Stuck { part: Obstacle::Triangle(part), reason: Stuck::Layer });
            }
            let edges = input::validate(inner, &local.segments, InputKind::Plc)?;
            let heights = self.next_heights(inner);
            let request = local.request(r, inner, &edges);
            let filled = fill(&Request { spare_needles: false, heights: &heights, ..request })?;
            self.constraints.check((&filled.mesh, &filled.left_out), inner, &self.triangles)?;
            (recovery, optimize, refine) = (filled.recovery, filled.optimize, filled.refine);
            Ok(filled.mesh)
        })?;
        Ok((made, Core { wanted: places.wanted, recovery, optimize, refine }))
    }

    /// Heights that continue the growth of the layers inside them.
    fn next_heights(&self, inner: &TriMesh) -> Vec<f64> {
        let depths = self.layers.depths();
        let last = 1.0 - depths.iter().rev().nth(1).copied().unwrap_or(0.0);
        let mut is_wall = vec![false; inner.points.len()];
        self.triangles.as_flattened().iter().for_each(|&v| is_wall[v as usize] = true);
        let height = |(v, is_wall): (usize, bool)| {
            let offset = (inner.points[v] - self.local.surface.points[v]).norm();
            if is_wall && offset > 0.0 { self.layers.growth * last * offset } else { f64::INFINITY }
        };
        is_wall.into_iter().enumerate().map(height).collect()
    }

    /// Vertices of the wall, and their thicknesses relative to those asked for.
    fn shares(&self, inset: &Inset, core: &Core) -> Vec<(u32, f64)> {
        let surface: &TriMesh = &self.local.surface;
        // At a cap that shrinks, the share of its own size is asked for.
        let of_caps = shrunk(surface, &self.caps, self.layers.thickness);
        let mut on_wall: Vec<u32> = self.triangles.as_flattened().to_vec();
        on_wall.sort_unstable();
        on_wall.dedup();
        let share = |v: u32| {
            let (v, p) = (v as usize, surface.points[v as usize]);
            let of_cap = of_caps[v].map(|q| (q - p).norm()).filter(|d| *d > 0.0);
            match of_cap.unwrap_or(self.asked[v]) {
                0.0 => 0.0,
                asked => inset.shares[v] * (core.wanted[v] - p).norm() / asked,
            }
        };
        on_wall.into_iter().map(|v| (v, share(v))).collect()
    }
}

/// New triangles of the parts that shrank or slid.
fn discs(numbers: &Numbers, surface: &TriMesh, caps: &[Cap]) -> Vec<Disc> {
    let disc = |cap: &Cap| {
        let own: Vec<[u32; 3]> = cap.triangles.iter().map(|&t| surface.triangles[t as usize]).collect();
        Disc { triangles: cap.triangles.clone(), faces: numbers.disc(&own) }
    };
    let changes = |v: &u32| numbers.copy(*v, numbers.layers()) != *v;
    caps.iter().filter(|cap| cap.vertices.iter().any(changes)).map(disc).collect()
}
