//! Cluster without a template: wall, caps, tetrahedra, end surfaces (section 3.2.2 of the paper).

use super::buried::buried;
use super::end_surface::{CutEnd, EndSurface, disc_rim};
use super::error::{BlockError, FlattenFailure};
use super::faithful::{Astray, fused_by_field};
use super::layered::{ThinLayers, Walled, disc_at_end};
use super::loops::Loops;
use super::params::{BlockParams, EndStyle, filling};
use super::topology::Topology;
use super::webs::{Gaps, webs};
use crate::partition::{Cluster, ClusterEnd, ClusterId, EndKind};
use crate::surface::{
    CapError, CapFailure, CappedSurface, Closing, Contour, Field, Finer, SharedDisc, SizedWall, SurfaceParams,
    cap_terminals, euler_characteristic,
};
use anastomesh_mesh::budget::Stop;
use anastomesh_mesh::geometry::{Point3, Section, Tube};
use anastomesh_mesh::{TetMesh, TriMesh};
use anastomesh_skeleton::NodeId;
use anastomesh_tet::parts::{Inset, split_corner_tets};
use anastomesh_tet::{
    TetError,
    parts::{Watch, fill_outward},
};
use std::borrow::Cow;
use std::sync::Arc;

/// Flat cap of a terminal.
#[derive(Clone, Debug, PartialEq)]
pub struct CapFaces {
    /// Node of the terminal.
    pub node: NodeId,
    /// Cap plane; its axis points out of the mesh.
    pub section: Section,
    /// Boundary triangles, oriented outwards.
    pub triangles: Vec<[u32; 3]>,
}

/// Mesh of a cluster.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ClusterMesh {
    /// Points and tetrahedra; no tetrahedra with [`BlockParams::hollow`].
    pub mesh: TetMesh,
    /// Closed surface with [`BlockParams::hollow`], else empty.
    pub hull: Vec<[u32; 3]>,
    /// End surfaces of the cut ends, in the order of `Cluster::ends`, which identifies them: cuts may be renumbered.
    /// Empty with [`EndStyle::Open`].
    pub ends: Vec<EndSurface>,
    /// Caps of the terminals, in the order of `Cluster::ends`.
    pub caps: Vec<CapFaces>,
    /// Terminals without a cap, because their tips lie in another vessel (only with [`BlockParams::allow_fused`]).
    pub uncapped: Vec<NodeId>,
    /// Deviations of the wall from its vessels (only with [`BlockParams::allow_fused`]).
    pub astray: Astray,
    /// Cell size of the contouring grid.
    pub voxel: f64,
    /// Mean edge length of the wall.
    pub edge: f64,
    /// Triangle count of the wall before trimming, including caps.
    pub surface_triangles: usize,
    /// Genus of the wall.
    pub handles: i64,
    /// Independent loops of the cluster's skeleton, minus filled ones; equals `handles` unless deviations are allowed.
    pub loops: i64,
    /// Skeleton loops that are filled by their own lumen.
    pub filled: i64,
    /// Report of layers that are thinner than requested.
    pub thin: Option<ThinLayers>,
    /// Places of narrow gaps that were closed (only with [`BlockParams::close_gaps`]).
    pub closed_gaps: Vec<Point3>,
    /// Topology of an image of a template, with the discs of cuts first, then those of caps.
    pub(crate) topology: Option<Arc<Topology>>,
}

impl ClusterMesh {
    /// True if the mesh is the image of a template.
    pub fn is_image(&self) -> bool {
        self.topology.is_some()
    }
}

/// Contours a cluster, closes it, and fills it.
///
/// # Errors
/// Any stage may fail; the error contains the cluster id.
pub(super) fn contoured(
    id: ClusterId,
    cluster: &Cluster,
    params: &BlockParams,
    watch: &Watch,
) -> Result<ClusterMesh, BlockError> {
    let wall = cluster_surface(id, cluster, params, watch)?;
    filled(id, cluster, wall, params, watch)
}

/// Fills a cluster within its closed wall.
///
/// # Errors
/// See [`contoured`].
pub(super) fn filled(
    id: ClusterId,
    cluster: &Cluster,
    wall: ClusterWall,
    params: &BlockParams,
    watch: &Watch,
) -> Result<ClusterMesh, BlockError> {
    let ClusterWall { surface, voxel, astray, closed_gaps } = wall;
    let edge = surface.mesh.mean_edge();
    let failed = |source| BlockError::of_filling(id, source);
    let FilledSurface { mesh, hull, discs, thin } = inside(cluster, &surface, params, watch).map_err(failed)?;
    let caps = caps(cluster, &discs);
    let surface_triangles = surface.mesh.triangles.len();
    let handles = 1 - euler_characteristic(&surface.mesh) / 2;
    let Loops { all, expected: loops } = Loops::of(cluster, handles, watch).map_err(|stop| stopped(id, stop))?;
    let uncapped = uncapped(cluster, &caps);
    let mut out = ClusterMesh {
        mesh,
        hull,
        caps,
        uncapped,
        astray,
        voxel,
        edge,
        surface_triangles,
        handles,
        loops,
        filled: all - loops,
        thin,
        closed_gaps,
        ends: Vec::new(),
        topology: None,
    };
    if params.ends != EndStyle::Open {
        out.ends = disc_ends(id, cluster, |end| discs[end as usize].clone(), &out.mesh)?;
    }
    if params.ends == EndStyle::Shared {
        check_shared(id, cluster, &out, params)?;
    }
    Ok(out)
}

/// Interior of a cluster's surface.
struct FilledSurface {
    /// Points and tetrahedra; points only if hollow.
    mesh: TetMesh,
    /// Closed surface if hollow, else empty.
    hull: Vec<[u32; 3]>,
    /// Triangles of each end; empty if the end is open.
    discs: Vec<Vec<[u32; 3]>>,
    /// Report of thin layers.
    thin: Option<ThinLayers>,
}

fn inside(
    cluster: &Cluster,
    surface: &CappedSurface,
    params: &BlockParams,
    watch: &Watch,
) -> Result<FilledSurface, TetError> {
    let discs: Vec<Vec<[u32; 3]>> = (0..cluster.ends.len() as u32).map(|end| faces_of(surface, end)).collect();
    let fill = |surface: &TriMesh| fill_outward(&filling(surface, params.core), surface, watch);
    if let Some(layers) = &params.layers {
        let caps = surface.cap.iter().map(|cap| cap.map(|end| cluster.ends[end as usize].section.origin)).collect();
        let axes = cluster.tubes.iter().map(|tube| [tube.a, tube.b]).collect();
        let (Inset { mesh, numbers, .. }, thin) = Walled { surface: &surface.mesh, caps, axes }.fill(layers, fill)?;
        let discs = discs.iter().map(|disc| numbers.disc(disc)).collect();
        return Ok(FilledSurface { mesh, hull: Vec::new(), discs, thin });
    }
    if params.hollow {
        let TriMesh { points, triangles } = surface.mesh.clone();
        return Ok(FilledSurface { mesh: TetMesh { points, tets: Vec::new() }, hull: triangles, discs, thin: None });
    }
    let mut mesh = fill(&surface.mesh)?;
    // Discs at cuts lie inside the final mesh.
    let of_cut = |end: u32| matches!(cluster.ends[end as usize].kind, EndKind::Cut { .. });
    split_corner_tets(&mut mesh, &surface.mesh, |i| !surface.cap[i].is_some_and(of_cut));
    Ok(FilledSurface { mesh, hull: Vec::new(), discs, thin: None })
}

/// Closed wall of a cluster.
pub(super) struct ClusterWall {
    /// Wall with caps.
    pub surface: CappedSurface,
    /// Cell size of the contouring grid.
    pub voxel: f64,
    /// Deviations from the vessels.
    pub astray: Astray,
    /// Places of gaps that were closed.
    pub closed_gaps: Vec<Point3>,
}

/// Creates the closed wall of a cluster with its caps, for [`contoured`].
///
/// # Errors
/// The wall cannot be created, has a different topology than the skeleton, or cannot be capped; `Stopped` if the watch
/// stops it.
fn cluster_surface(
    id: ClusterId,
    cluster: &Cluster,
    params: &BlockParams,
    watch: &Watch,
) -> Result<ClusterWall, BlockError> {
    params.check()?;
    if !params.allow_fused
        && let Some((end, node, ClusterEnd { section, .. })) = buried(cluster).next()
    {
        let source = CapError::End { end, node: Some(node), origin: section.origin, reason: CapFailure::Buried };
        return Err(BlockError::Cap { cluster: id, source });
    }
    if !params.allow_fused
        && let Some([at, _]) = fused_by_field(cluster, params.kappa, watch).map_err(|stop| stopped(id, stop))?
    {
        return Err(BlockError::Fused { cluster: id, at: at.into() });
    }
    let thin = smallest_radius(cluster);
    let voxel = 2.0 * thin / params.rho * params.voxel_factor;
    let surface_params = SurfaceParams {
        kappa: params.kappa,
        shift: params.shift,
        thin,
        follow: params.follow,
        ..SurfaceParams::with_voxel(voxel)
    };
    let failed = |source| BlockError::of_wall(id, source);
    let stopped = |stop| stopped(id, stop);
    let cuts = cluster.ends.iter().filter(|end| matches!(end.kind, EndKind::Cut { .. }));
    let finer = Finer::new(&cluster.fine, cuts.map(|end| end.section).collect());
    let OpenWall { wall, tubes, closed_gaps } = open_wall(id, cluster, params, (&surface_params, &finer), watch)?;
    let astray = Astray::of(&wall.mesh, cluster, watch).map_err(stopped)?;
    if !params.allow_fused {
        stays(id, astray)?;
    }
    let mut field = Field::new(&tubes, params.kappa).map_err(failed)?;
    let closed: Vec<(u32, &ClusterEnd)> = capped_ends(cluster, params.ends).collect();
    let given =
        |e: &ClusterEnd| disc_of_end(&e.section, e.kind, params.rho).filter(|_| params.ends == EndStyle::Shared);
    let discs: Vec<Option<SharedDisc>> = closed.iter().map(|(_, e)| given(e)).collect();
    let closing = |((_, end), disc): (&(u32, &ClusterEnd), _)| Closing {
        section: end.section,
        node: if let EndKind::Terminal(node) = end.kind { Some(node) } else { None },
        disc,
    };
    let ends: Vec<Closing> = closed.iter().zip(discs.iter().map(Option::as_ref)).map(closing).collect();
    let capped = cap_terminals(&wall, &mut field, &ends, &surface_params, params.allow_fused, watch);
    let mut capped = capped.map_err(|source| match source {
        CapError::Stopped(stop) => stopped(stop),
        source => BlockError::Cap { cluster: id, source: name_end(source, &closed) },
    })?;
    // Converts cap indices from closed ends to all ends.
    for cap in capped.cap.iter_mut().flatten() {
        *cap = closed[*cap as usize].0;
    }
    Ok(ClusterWall { surface: capped, voxel, astray, closed_gaps })
}

/// Wall of a cluster before its ends are closed.
struct OpenWall<'a> {
    wall: SizedWall,
    /// Tubes whose field it bounds: those of the cluster, and those in closed gaps.
    tubes: Cow<'a, [Tube]>,
    /// Places of gaps that were closed.
    closed_gaps: Vec<Point3>,
}

/// Contours a cluster, closes narrow gaps with [`BlockParams::close_gaps`], and relaxes the wall. The genus is compared first, as
/// relaxation changes no topology.
///
/// # Errors
/// See [`cluster_surface`].
fn open_wall<'a>(
    id: ClusterId,
    cluster: &'a Cluster,
    params: &BlockParams,
    (surface_params, finer): (&SurfaceParams, &Finer),
    watch: &Watch,
) -> Result<OpenWall<'a>, BlockError> {
    let failed = |source| BlockError::of_wall(id, source);
    let stopped = |stop| stopped(id, stop);
    let contour = |tubes: &[Tube]| Contour::of(tubes, surface_params, watch).map_err(failed);
    let relaxed = |contour: Contour| contour.relaxed(surface_params, finer, watch).map_err(failed);
    let count = |contour: &Contour| {
        let handles = contour.handles();
        Loops::of(cluster, handles, watch).map(|loops| [handles, loops.expected]).map_err(stopped)
    };
    let mut tubes = Cow::Borrowed(&cluster.tubes[..]);
    let first = contour(&tubes)?;
    let [mut handles, mut loops] = count(&first)?;
    let wrong_genus = |[handles, loops]: [i64; 2]| {
        let is_wrong = handles != loops && !params.allow_fused;
        if is_wrong { Err(BlockError::Genus { cluster: id, handles, loops }) } else { Ok(()) }
    };
    if !params.close_gaps {
        wrong_genus([handles, loops])?;
    }
    let mut wall = relaxed(first)?;
    let mut closed_gaps = Vec::new();
    if params.close_gaps {
        let open = wall.mesh.clone();
        let kinds: &[Gaps] = if handles > loops { &[Gaps::Enclosed, Gaps::Inner] } else { &[Gaps::Ends] };
        for &kind in kinds {
            let webs = webs(&open, cluster, kind, watch).map_err(stopped)?;
            if webs.gaps.is_empty() {
                return Err(BlockError::NoGap { cluster: id });
            }
            tubes = Cow::Owned([&cluster.tubes[..], &webs.tubes].concat());
            closed_gaps = webs.gaps;
            let closed = contour(&tubes)?;
            [handles, loops] = count(&closed)?;
            wall = relaxed(closed)?;
            if handles == loops {
                break;
            }
        }
        wrong_genus([handles, loops])?;
    }
    Ok(OpenWall { wall, tubes, closed_gaps })
}

/// Failure of a cluster that was stopped.
fn stopped(cluster: ClusterId, source: Stop) -> BlockError {
    BlockError::Stopped { cluster, source }
}

/// Checks that a wall matches its vessels.
fn stays(cluster: ClusterId, astray: Astray) -> Result<(), BlockError> {
    match astray {
        Astray { outside: Some(at), .. } => Err(BlockError::Outside { cluster, at: at.into() }),
        Astray { fused: Some([at, _]), .. } => Err(BlockError::Fused { cluster, at: at.into() }),
        Astray { outside: None, fused: None } => Ok(()),
    }
}

/// Shared disc at an end of a cluster, if the end is a cut.
fn disc_of_end(section: &Section, kind: EndKind, rho: f64) -> Option<SharedDisc> {
    match kind {
        EndKind::Cut { side, .. } => SharedDisc::at_end(section, side, rho),
        EndKind::Terminal(_) => None,
    }
}

/// Ends closed by discs, with their indices in `Cluster::ends`.
fn capped_ends(cluster: &Cluster, style: EndStyle) -> impl Iterator<Item = (u32, &ClusterEnd)> {
    let closed = move |e: &ClusterEnd| style != EndStyle::Open || matches!(e.kind, EndKind::Terminal(_));
    (0..).zip(&cluster.ends).filter(move |(_, e)| closed(e))
}

/// Converts the end index of an error from closed ends to all ends.
fn name_end(error: CapError, closed: &[(u32, &ClusterEnd)]) -> CapError {
    match error {
        CapError::End { end, node, origin, reason } => {
            CapError::End { end: closed.get(end as usize).map_or(end, |(i, _)| *i), node, origin, reason }
        }
        other => other,
    }
}

/// Smallest radius in a cluster, including cuts.
pub(super) fn smallest_radius(cluster: &Cluster) -> f64 {
    let tubes = cluster.tubes.iter().map(Tube::min_radius);
    tubes.chain(cluster.ends.iter().map(|e| e.section.radius)).fold(f64::INFINITY, f64::min)
}

fn faces_of(surface: &CappedSurface, end: u32) -> Vec<[u32; 3]> {
    surface.mesh.triangles.iter().zip(&surface.cap).filter(|(_, c)| **c == Some(end)).map(|(t, _)| *t).collect()
}

/// Caps of the terminals; `discs` are the triangles of each end.
pub(super) fn caps(cluster: &Cluster, discs: &[Vec<[u32; 3]>]) -> Vec<CapFaces> {
    (cluster.ends.iter().zip(discs))
        .filter_map(|(end, triangles)| match end.kind {
            EndKind::Terminal(node) => Some(CapFaces { node, section: end.section, triangles: triangles.clone() }),
            EndKind::Cut { .. } => None,
        })
        .filter(|cap| !cap.triangles.is_empty())
        .collect()
}

/// Terminals without a cap.
fn uncapped(cluster: &Cluster, caps: &[CapFaces]) -> Vec<NodeId> {
    let terminal = |end: &ClusterEnd| match end.kind {
        EndKind::Terminal(node) => Some(node),
        EndKind::Cut { .. } => None,
    };
    cluster.ends.iter().filter_map(terminal).filter(|node| !caps.iter().any(|cap| cap.node == *node)).collect()
}

/// Cut ends with their indices in `Cluster::ends`.
pub(crate) fn cut_ends(cluster: &Cluster) -> Vec<(u32, CutEnd)> {
    (0..)
        .zip(&cluster.ends)
        .filter_map(|(i, end)| match end.kind {
            EndKind::Cut { cut, side } => Some((i, CutEnd { cut, side, section: end.section })),
            EndKind::Terminal(_) => None,
        })
        .collect()
}

/// End surfaces that are discs of the surface.
pub(super) fn disc_ends(
    id: ClusterId,
    cluster: &Cluster,
    faces: impl Fn(u32) -> Vec<[u32; 3]>,
    mesh: &TetMesh,
) -> Result<Vec<EndSurface>, BlockError> {
    cut_ends(cluster)
        .into_iter()
        .map(|(i, end)| {
            let failed = || BlockError::at_end(id, i, &end, FlattenFailure::NotADisc);
            let triangles = faces(i);
            let rim = disc_rim(&triangles).ok_or_else(failed)?;
            let surface = EndSurface { cut: end.cut, side: end.side, section: end.section, triangles, rim };
            surface.check_flat(&mesh.points).map_err(|_| failed())?;
            Ok(surface)
        })
        .collect()
}

/// Sorted triangles, each starting with its smallest vertex.
fn sorted(triangles: impl Iterator<Item = [u32; 3]>) -> Vec<[u32; 3]> {
    let mut turned: Vec<[u32; 3]> = triangles
        .map(|mut t| {
            let least = (0..3).min_by_key(|&i| t[i]).unwrap_or_default();
            t.rotate_left(least);
            t
        })
        .collect();
    turned.sort_unstable();
    turned
}

/// Checks that the mesh contains every shared disc unchanged: equal points in equal order, and equal triangles.
pub(super) fn check_shared(
    id: ClusterId,
    cluster: &Cluster,
    mesh: &ClusterMesh,
    params: &BlockParams,
) -> Result<(), BlockError> {
    for ((i, end), surface) in cut_ends(cluster).iter().zip(&mesh.ends) {
        let vertices = surface.vertices();
        let same = disc_at_end(&end.section, end.side, params).is_some_and(|disc| {
            let local = |v: u32| vertices.partition_point(|&x| x < v) as u32;
            let points = vertices.iter().map(|&v| mesh.mesh.points[v as usize]);
            points.eq(disc.points.iter().copied())
                && sorted(surface.triangles.iter().map(|t| t.map(local))) == sorted(disc.triangles.iter().copied())
        });
        if !same {
            return Err(BlockError::at_end(id, *i, end, FlattenFailure::NotShared));
        }
    }
    Ok(())
}
