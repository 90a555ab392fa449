//! Regions around a lumen: shells, then tissue, then one mesh of all.

use super::assemble::{Layout, assemble};
use super::error::DomainError;
use super::organ::organ;
use super::plan::{DomainPlan, ShellPlan, TissuePlan};
use super::surface::LumenSurface;
use crate::fidelity::Tubes;
use anastomesh_mesh::progress::Progress;
use anastomesh_mesh::{TriMesh, VolumeMesh};
use anastomesh_skeleton::Skeleton;
use anastomesh_tet::{Interior, Obstacle, Shell, Shells, Sizing, TetError, TetMesh, Tetrahedralizer};
use rayon::prelude::*;
use serde::Serialize;

/// Mesh with several regions.
#[derive(Clone, Debug, Default)]
#[non_exhaustive]
pub struct Domain {
    /// The mesh. Its blocks are the regions, and its boundary contains the interfaces.
    pub mesh: VolumeMesh,
    /// Names of the regions with their ids, ascending.
    pub regions: Vec<(i32, String)>,
    /// Thickness of the shells.
    pub shells: ShellsReport,
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
    /// Least share, and its place; `None` if all are complete.
    pub thinnest: Option<(f64, [f64; 3])>,
}

impl Domain {
    /// Adds shells and tissue to the mesh of a lumen. `network` is the network that was meshed.
    ///
    /// # Errors
    /// See [`DomainError`].
    pub fn around(
        lumen: VolumeMesh,
        network: &Skeleton,
        plan: &DomainPlan,
        progress: &dyn Progress,
    ) -> Result<Self, DomainError> {
        plan.validate()?;
        let surface = LumenSurface::of(&lumen);
        let radii = radii(&surface.surface, network);
        let outer = |radius: &f64| radius + plan.shells.iter().map(|shell| shell.thickness.at(*radius)).sum::<f64>();
        let largest = radii.iter().map(outer).fold(0.0, f64::max);
        let around = plan.tissue.as_ref().map(|tissue| organ(tissue, &surface.surface, largest)).transpose()?;
        let shells = shells(&surface, &radii, &plan.shells, around.as_ref(), progress)?;
        let report = report(&shells, &surface);
        let layout = Layout::new(&surface, &shells, around.as_ref());
        let tissue = match &plan.tissue {
            Some(plan) => Some(fill(plan, layout.outside(), progress)?),
            None => None,
        };
        let (mesh, regions) = assemble(lumen, &layout, tissue.as_ref(), plan);
        Ok(Self { mesh, regions, shells: report })
    }
}

/// Radius of the nearest vessel at each point of a wall.
fn radii(surface: &TriMesh, network: &Skeleton) -> Vec<f64> {
    let tubes = Tubes::of(network);
    let radius = |p| tubes.nearest_wall(p).map_or(tubes.typical, |near| near.radius);
    surface.points.par_iter().map(radius).collect()
}

fn shells(
    lumen: &LumenSurface,
    radii: &[f64],
    plans: &[ShellPlan],
    around: Option<&TriMesh>,
    progress: &dyn Progress,
) -> Result<Shells, DomainError> {
    if plans.is_empty() {
        return Ok(Shells::default());
    }
    let shell = |plan: &ShellPlan| {
        let thickness = radii.iter().map(|&radius| plan.thickness.at(radius)).collect();
        Shell::new(thickness).layers(plan.layers).growth(plan.growth)
    };
    let wanted: Vec<Shell> = plans.iter().map(shell).collect();
    Shells::around(&lumen.surface, &lumen.caps, &wanted, around, progress).map_err(|source| {
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
    ShellsReport { points, complete: points - less, thin: shells.thin(), thinnest: shells.thinnest().map(place) }
}

/// Fills the tissue. The points of its mesh begin with those of the surface.
fn fill(plan: &TissuePlan, surface: &TriMesh, progress: &dyn Progress) -> Result<TetMesh, DomainError> {
    let mut filler = Tetrahedralizer::new().interior(Interior::Growing { growth: plan.growth });
    if let Some(size) = plan.size {
        filler = filler.sizing(Sizing::Constant(size));
    }
    let _ = progress;
    Ok(filler.run(surface).map_err(DomainError::Tissue)?.mesh)
}
