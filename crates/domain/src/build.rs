//! Regions around a lumen: shells, then tissue, then one mesh of all.

use super::assemble::assemble;
use super::before::ends;
use super::error::DomainError;
use super::gate::Gate;
use super::layout::Layout;
use super::organ::{Surroundings, Vessels};
use super::plan::{DomainPlan, ShellPlan, Site, TissuePlan};
use super::surface::LumenSurface;
use super::unfold::unfold;
use anastomesh_mesh::check::{CheckReport, Expectation, check_regions_watched};
use anastomesh_mesh::geometry::Point3;
use anastomesh_mesh::progress::{Progress, Stage};
use anastomesh_mesh::source::MeshSource;
use anastomesh_mesh::{NamedRegion, TriMesh, VolumeMesh};
use anastomesh_skeleton::{Skeleton, Tubes};
use anastomesh_tet::parts::{Prisms, Watch, fill_in_pieces};
use anastomesh_tet::{Interior, Obstacle, Shell, Shells, Sizing, TetError, Tetrahedralization, Tetrahedralizer};
use rayon::prelude::*;
use serde::Serialize;

/// Mesh with several regions.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Domain {
    /// The mesh. Its blocks are the regions, and its boundary contains the interfaces.
    pub mesh: VolumeMesh,
    /// Regions, by ascending id.
    pub regions: Vec<NamedRegion>,
    /// Thickness of the shells; `None` without any.
    pub shells: Option<ShellsReport>,
    /// Report of the validity check.
    pub check: CheckReport,
}

/// Thickness of all shells together, relative to what was asked for.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct ShellsReport {
    /// Number of points of the wall.
    pub points: usize,
    /// Points with the full thickness.
    pub complete: usize,
    /// Points with less than half of it.
    pub thin: usize,
    /// Points of the wall that were moved, because it was folded there.
    pub moved: usize,
    /// Least share, and its place; `None` if all are complete.
    pub thinnest: Option<(f64, [f64; 3])>,
}

impl Domain {
    /// Adds shells and tissue to the mesh of a lumen, and checks the whole. `network` is the network that was meshed, and
    /// `expectation` that of the lumen.
    ///
    /// # Errors
    /// See [`DomainError`].
    pub fn around(
        lumen: VolumeMesh,
        network: &Skeleton,
        plan: &DomainPlan,
        expectation: &Expectation,
        progress: &dyn Progress,
    ) -> Result<Self, DomainError> {
        let grown = Grown::of(&lumen, network, plan, progress)?;
        let mut lumen = lumen;
        for &(v, place) in &grown.moved {
            lumen.mesh.points[v as usize] = place;
        }
        let Grown { surface, mut shells, prisms, around, report, .. } = grown;
        (shells.tets, shells.shell_of) = prisms.tets(0..prisms.len()).unzip();
        drop(prisms);
        let layout = Layout::new(&surface, &shells, around.as_ref())?;
        let fill = |tissue: &TissuePlan| {
            let (filler, watch) = (tissue.filler(), Watch::of(progress));
            let mut left = tissue.max_tets;
            let fill = |outside| {
                let made = fill_in_pieces(&filler.clone().max_tets(left), outside, tissue.piece, &watch)?;
                left = left.saturating_sub(made.mesh.tets.len());
                Ok(made)
            };
            layout.outsides().map(fill).collect::<Result<_, _>>().map_err(DomainError::Tissue)
        };
        let tissue: Vec<Tetrahedralization> = plan.tissue.as_ref().map_or(Ok(Vec::new()), fill)?;
        let (mesh, regions) = assemble(lumen, &layout, &tissue, plan);
        // The check needs about as much memory as they do.
        drop(layout);
        drop((tissue, shells, surface, around));
        progress.at(Stage::Check, 0, 0);
        let check = check_regions_watched(&mesh, &regions, Some(expectation), progress)?;
        Ok(Self { mesh, regions, shells: report, check })
    }
}

/// Surface of a lumen with its shells, and what is around them.
pub(super) struct Grown {
    pub surface: LumenSurface,
    /// Points of the lumen that have moved, ascending.
    pub moved: Vec<(u32, Point3)>,
    /// Shells without their tetrahedra, which the prisms make.
    pub shells: Shells,
    pub prisms: Prisms,
    pub around: Option<Surroundings>,
    pub report: Option<ShellsReport>,
}

impl Grown {
    /// Grows the shells of a plan.
    ///
    /// # Errors
    /// See [`DomainError`].
    pub fn of(
        lumen: &dyn MeshSource,
        network: &Skeleton,
        plan: &DomainPlan,
        progress: &dyn Progress,
    ) -> Result<Self, DomainError> {
        plan.validate()?;
        let mut surface = LumenSurface::of(lumen)?;
        let moved = if plan.shells.is_empty() { Vec::new() } else { unfold(lumen, &mut surface)? };
        let sites = sites(&surface.surface, network);
        let thickness: Vec<f64> = sites.iter().map(|site| plan.thickness(site)).collect();
        let outer = sites.iter().zip(&thickness).map(|(site, own)| site.radius + own).fold(0.0, f64::max);
        let vessels = Vessels { surface: &surface.surface, thickness: &thickness, outer };
        let watch = Watch::asking(progress);
        let surround = |tissue: &TissuePlan| {
            let places: Vec<Point3> = ends(tissue, network).into_iter().map(|(place, _)| place).collect();
            Surroundings::of(tissue, &vessels, Gate::find(&surface, &thickness, &places)?, &watch)
        };
        let around = plan.tissue.as_ref().map(surround).transpose()?;
        let obstacles = around.as_ref().map(Surroundings::joined);
        let wanted: Vec<Shell> = plan.shells.iter().map(|shell| shell.at(&sites)).collect();
        drop((sites, thickness));
        let (shells, prisms) = shells(&surface, &plan.shells, &wanted, obstacles.as_ref(), progress)?;
        let report =
            (!plan.shells.is_empty()).then(|| ShellsReport { moved: moved.len(), ..report(&shells, &surface) });
        Ok(Self { surface, moved, shells, prisms, around, report })
    }
}

impl DomainPlan {
    /// Thickness of all shells together at a place.
    pub(super) fn thickness(&self, site: &Site) -> f64 {
        self.shells.iter().map(|shell| shell.thickness.at(site)).sum()
    }
}

impl ShellPlan {
    /// Shell with its thickness at each of these places.
    fn at(&self, sites: &[Site]) -> Shell {
        let thickness = sites.iter().map(|site| self.thickness.at(site)).collect();
        Shell::new(thickness).layers(self.layers).growth(self.growth)
    }
}

/// Place on the nearest vessel of each point of a wall.
fn sites(surface: &TriMesh, network: &Skeleton) -> Vec<Site> {
    let tubes = Tubes::of(network);
    let site = |p| {
        let near = tubes.nearest_wall(p)?;
        let ends = network.edge(near.edge).nodes.map(|node| network.node(node).original);
        Some(Site { radius: near.radius, ends, t: near.t })
    };
    // There is no wall without a vessel.
    let none = Site { radius: tubes.typical, ends: [0; 2], t: 0.0 };
    surface.points.par_iter().map(|p| site(p).unwrap_or(none)).collect()
}

fn shells(
    lumen: &LumenSurface,
    plans: &[ShellPlan],
    wanted: &[Shell],
    around: Option<&TriMesh>,
    progress: &dyn Progress,
) -> Result<(Shells, Prisms), DomainError> {
    if plans.is_empty() {
        return Ok(Default::default());
    }
    Shells::grown(&lumen.surface, &lumen.caps, wanted, around, progress).map_err(|source| {
        let v = match &source {
            TetError::Stuck {
                part: Obstacle::Triangle([v, ..]) | Obstacle::Edge([v, _]) | Obstacle::Point(v), ..
            } => *v,
            _ => 0,
        };
        let at = lumen.surface.points[v as usize].coords.into();
        let names: Vec<&str> = plans.iter().map(|plan| plan.name.as_str()).collect();
        DomainError::Shell { shells: names.join(", "), at, source }
    })
}

fn report(shells: &Shells, lumen: &LumenSurface) -> ShellsReport {
    let mut on_wall = vec![false; lumen.surface.points.len()];
    let wall = lumen.surface.triangles.iter().zip(&lumen.caps).filter(|(_, cap)| cap.is_none());
    wall.flat_map(|(t, _)| t).for_each(|&v| on_wall[v as usize] = true);
    let points = on_wall.iter().filter(|&&on_wall| on_wall).count();
    let less = shells.shares.iter().filter(|&&share| share < 1.0 - 1e-9).count();
    let place = |(v, share): (u32, f64)| (share, lumen.surface.points[v as usize].coords.into());
    ShellsReport {
        points,
        complete: points - less,
        thin: shells.thin(),
        moved: 0,
        thinnest: shells.thinnest().map(place),
    }
}

impl TissuePlan {
    /// Tetrahedralizer of the tissue.
    pub(super) fn filler(&self) -> Tetrahedralizer {
        let filler = Tetrahedralizer::new().interior(Interior::Growing { growth: self.growth });
        self.size.map_or(filler.clone(), |size| filler.sizing(Sizing::Constant(size)))
    }
}
