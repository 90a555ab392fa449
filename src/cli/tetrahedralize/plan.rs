//! Resolved options: flags or `TetGen` switches as one plan.

use super::args::{Args, RemeshArgs};
use super::format::{InputFormat, Target};
use super::switches::Switches;
use crate::cli::blocks::size_field;
use crate::cli::exit::Failure;
use anastomesh_mesh::{Bound, Bounds, Point3, REGULAR_DIHEDRAL};
use anastomesh_skeleton::SizeField;
use anastomesh_tet::{Boundary, Effort, InputKind, Interior, Layers, Refinement, Region, Sizing, Tetrahedralizer};
use serde::Serialize;
use std::sync::Arc;

/// Side of the lattice cubes in edge lengths, so that a body-centred lattice has edges of about that length.
const LATTICE_CELL: f64 = 1.08;

/// Resolved options.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TetPlan {
    /// True if the input is a facet complex, false for a closed surface.
    pub plc: bool,
    /// True if interior points are added to improve the shape of tetrahedra.
    pub refine: bool,
    /// Bounds on the tetrahedra.
    #[serde(flatten)]
    pub bounds: Bounds,
    /// Maximum edge length; `None`: any that the growth gives.
    pub size: Option<f64>,
    /// Maximum edge lengths at points.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sizes_from: Option<SizeField>,
    /// Growth of edge lengths per layer of tetrahedra; `None`: they are uniform.
    pub growth: Option<f64>,
    /// Maximum edge length in regions, by number.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub region_sizes: Vec<(i32, f64)>,
    /// Growth in regions, by number.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub region_growths: Vec<(i32, f64)>,
    /// Maximum number of tetrahedra.
    pub max_tets: usize,
    /// True if input triangles may be split.
    pub split: bool,
    /// Remeshing of the surface.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub remesh_surface: Option<RemeshArgs>,
    /// Layers along the surface.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub layers: Option<Layers>,
    /// Parts with layers; empty for all.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub layers_on: Vec<String>,
    /// Numbers of the regions with layers; empty for all.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub layers_in: Vec<i32>,
    /// True if tetrahedra are improved.
    pub optimize: bool,
    /// True if the improvement is quick.
    pub quick: bool,
    /// True if the input is repaired: oriented, and exact duplicates merged.
    pub repair: bool,
    /// True if ignored input is an error.
    pub strict: bool,
    /// True if regions are distinguished.
    pub regions: bool,
    /// True if volume bounds of regions apply.
    pub region_volumes: bool,
    /// True if the input is only checked.
    pub check_only: bool,
    /// Selected `TetGen` files.
    pub family: Family,
    /// True if only errors are printed.
    #[serde(skip)]
    pub quiet: bool,
}

/// Selection of `TetGen` files.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Family {
    /// Number of the first item; `None`: that of the input.
    pub first: Option<u32>,
    /// `.face`.
    pub faces: Wanted,
    /// `.edge`.
    pub edges: Wanted,
    /// True if `.neigh` is written.
    pub neighbors: bool,
}

/// Selection of faces or edges.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Wanted {
    /// None.
    Nothing,
    /// Those of the input.
    Boundary,
    /// All.
    All,
}

impl TetPlan {
    /// Resolves the arguments. Returns the plan and notes on ignored switches.
    pub fn resolve(args: &Args, format: InputFormat) -> Result<(Self, Vec<String>), Failure> {
        let mut notes = Vec::new();
        let mut plan = match &args.tetgen {
            Some(text) => {
                let switches = Switches::parse(text).map_err(|e| Failure::usage(e.to_string()))?;
                notes.extend(switches.without_effect.iter().cloned());
                Self::of_switches(&switches, format)
            }
            None => Self::of_flags(args, format),
        };
        plan.quiet |= args.common.quiet;
        plan.check_only |= args.check_only;
        plan.repair = args.repair;
        plan.strict = args.strict;
        plan.plc |= !args.others.is_empty();
        plan.layers_on.clone_from(&args.layers_on);
        plan.layers_in.clone_from(&args.layers_in);
        if !plan.plc && !args.hole.is_empty() {
            return Err(Failure::usage("--hole is for facet complexes: give --plc"));
        }
        plan.layers = args.layers.asked()?;
        plan.region_sizes.clone_from(&args.region_size);
        plan.region_growths.clone_from(&args.region_growth);
        plan.max_tets = args.max_tets;
        plan.growth = Some(args.growth).filter(|_| !args.uniform);
        if let (Some(path), Some(array)) = (&args.sizes_from, &args.array) {
            plan.sizes_from = Some(size_field(path, array)?);
        }
        Self::validate(args)?;
        Ok((plan, notes))
    }

    fn of_flags(args: &Args, format: InputFormat) -> Self {
        let refine = !args.no_refine;
        Self {
            plc: args.plc || format.is_complex(),
            refine,
            bounds: bounds_of(args),
            size: args.size,
            sizes_from: None,
            growth: None,
            region_sizes: Vec::new(),
            region_growths: Vec::new(),
            max_tets: Tetrahedralizer::MAX_TETS,
            split: args.split,
            remesh_surface: args.remesh_surface,
            layers: None,
            layers_on: Vec::new(),
            layers_in: Vec::new(),
            optimize: refine,
            quick: false,
            repair: false,
            strict: false,
            regions: true,
            region_volumes: refine,
            check_only: false,
            family: Family { first: None, faces: Wanted::Boundary, edges: Wanted::Boundary, neighbors: true },
            quiet: false,
        }
    }

    fn of_switches(s: &Switches, format: InputFormat) -> Self {
        let refine = s.quality.is_some() || s.max_volume.is_some() || s.region_volumes;
        let all = |wanted: bool| if wanted { Wanted::All } else { Wanted::Boundary };
        let (faces, edges) =
            if s.no_faces { (Wanted::Nothing, Wanted::Nothing) } else { (all(s.all_faces), all(s.all_edges)) };
        Self {
            // TetGen takes every surface as a complex.
            plc: s.plc || format.is_complex(),
            refine,
            bounds: Bounds { max_volume: s.max_volume, ..s.quality.unwrap_or_default() },
            size: None,
            sizes_from: None,
            growth: None,
            region_sizes: Vec::new(),
            region_growths: Vec::new(),
            max_tets: Tetrahedralizer::MAX_TETS,
            split: !s.keep_boundary,
            remesh_surface: None,
            layers: None,
            layers_on: Vec::new(),
            layers_in: Vec::new(),
            optimize: refine && !s.no_optimization,
            // As fast as TetGen, unless angles are bounded.
            quick: !s.quality.is_some_and(bounds_angles),
            repair: false,
            strict: false,
            regions: s.regions,
            region_volumes: s.region_volumes,
            check_only: s.check_only,
            family: Family { first: s.from_zero.then_some(0), faces, edges, neighbors: s.neighbors },
            quiet: s.quiet && s.verbose == 0,
        }
    }

    fn validate(args: &Args) -> Result<(), Failure> {
        let flag = |bound: Bound| format!("--{}", bound.to_string().replace('_', "-"));
        match bounds_of(args).senseless() {
            Some((bound @ Bound::MinDihedral, angle)) => Err(Failure::usage(format!(
                "{} is {angle}: give degrees from 0 to below {REGULAR_DIHEDRAL:.2}, the angle of the regular tetrahedron",
                flag(bound)
            ))),
            Some((bound, value)) => Err(not_positive(&flag(bound), value)),
            None => validate_sizes(args),
        }
    }

    /// Treatment of the input triangles.
    fn boundary(&self) -> Boundary {
        match self.remesh_surface {
            Some(RemeshArgs { tolerance }) => Boundary::Remesh { tolerance },
            None if self.split => Boundary::Split,
            None => Boundary::Keep,
        }
    }

    /// True if input triangles stay faces of the mesh.
    pub fn keeps_triangles(&self) -> bool {
        self.boundary() == Boundary::Keep
    }

    /// Tetrahedralizer for an input with these regions.
    pub fn tetrahedralizer(&self, regions: &[Region]) -> Tetrahedralizer {
        let refinement = Refinement::default().bounds(self.bounds);
        let interior = match self.growth {
            _ if !self.refine => Interior::None,
            Some(growth) => Interior::Growing { growth },
            None => Interior::Lattice { cell: self.size.map(|size| LATTICE_CELL * size), clearance: None },
        };
        // A size of a uniform lattice needs no further field.
        let sized = self.growth.is_some() || self.boundary() != Boundary::Keep || self.bounds != Bounds::default();
        let bounded = self.bounds != Bounds::default() || regions.iter().any(|region| region.max_volume.is_some());
        Tetrahedralizer::new()
            .kind(if self.plc { InputKind::Plc } else { InputKind::Closed })
            .interior(interior)
            .refine(bounded.then_some(refinement))
            .sizing(match &self.sizes_from {
                Some(field) => sizing_of(field.clone()),
                None => self.size.filter(|_| sized).map_or(Sizing::Surface, Sizing::Constant),
            })
            .boundary(self.boundary())
            .layers(self.layers)
            .layers_in(self.layers_in.as_slice())
            .optimize(self.optimize)
            .effort(if self.quick { Effort::Quick } else { Effort::Full })
            .max_tets(self.max_tets)
            .strict(self.strict)
    }
}

/// Edge lengths of the nearest point of a field.
fn sizing_of(field: SizeField) -> Sizing {
    Sizing::Function(Arc::new(move |p: &Point3| field.nearest(p)))
}

/// Checks lengths and growths.
fn validate_sizes(args: &Args) -> Result<(), Failure> {
    let sizes = args.size.iter().map(|size| ("--size", size));
    let sizes = sizes.chain(args.region_size.iter().map(|(_, size)| ("--region-size", size)));
    for (flag, &size) in sizes {
        if !(size > 0.0 && size.is_finite()) {
            return Err(not_positive(flag, size));
        }
    }
    let least = Interior::LEAST_GROWTH;
    let growths = [("--growth", &args.growth)].into_iter();
    for (flag, &growth) in growths.chain(args.region_growth.iter().map(|(_, growth)| ("--region-growth", growth))) {
        if !(growth >= least && growth.is_finite()) {
            return Err(Failure::usage(format!("{flag} is {growth}: give a finite number of at least {least}")));
        }
    }
    Ok(())
}

/// Bounds of the flags.
fn bounds_of(args: &Args) -> Bounds {
    Bounds { max_radius_edge: args.max_radius_edge, min_dihedral: args.min_dihedral, max_volume: args.max_volume }
}

/// True for a positive bound on dihedral angles.
fn bounds_angles(bounds: Bounds) -> bool {
    bounds.min_dihedral.is_some_and(|degrees| degrees > 0.0)
}

fn not_positive(flag: &str, value: f64) -> Failure {
    Failure::usage(format!("{flag} is {value}: give a finite number above 0"))
}

/// Checks that target and plan are consistent.
pub fn ensure_fits(plan: &TetPlan, args: &Args, target: Option<&Target>) -> Result<(), Failure> {
    match target {
        None if !plan.check_only => {
            Err(Failure::usage("missing output: give -o MESH (.vtu, .pvtu, .msh, .mesh or .ele), or --check-only"))
        }
        Some(Target::Stream(_)) if args.common.json && !plan.check_only => {
            Err(Failure::usage("--json and -o - both write to standard output: give a file with -o"))
        }
        _ => Ok(()),
    }
}
