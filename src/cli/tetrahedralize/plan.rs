//! What was typed, resolved: flags, or `TetGen`'s switches, become one plan.

use super::args::Args;
use super::format::{InputFormat, Target};
use super::switches::Switches;
use crate::cli::exit::Failure;
use anastomesh_mesh::{Bound, Bounds, REGULAR_DIHEDRAL};
use anastomesh_tet::{Boundary, Effort, InputKind, Interior, Layers, Refinement, Region, Sizing, Tetrahedralizer};
use serde::Serialize;

/// Side of the lattice's cubes in edge lengths: what gives a body-centred lattice edges of about that length.
const LATTICE_CELL: f64 = 1.08;

/// The lattice of a run that goes by TetGen's switches, in edge lengths of the surface nearby: about as many tetrahedra as
/// TetGen makes.
const SPARSE: Interior = Interior::Local { cell: 2.0, clearance: 0.45 };

/// What is to be done.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TetPlan {
    /// Whether the input is a complex of facets; otherwise a surface that bounds a volume. Points have neither.
    pub plc: bool,
    /// Whether points are put inside to make tetrahedra of good shape.
    pub refine: bool,
    /// Bounds on the tetrahedra.
    #[serde(flatten)]
    pub bounds: Bounds,
    /// Edge length wanted everywhere; none: as the surface has it nearby.
    pub size: Option<f64>,
    /// Whether the triangles of the input may be split.
    pub split: bool,
    /// Layers along the surface.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub layers: Option<Layers>,
    /// Whether tetrahedra are improved.
    pub optimize: bool,
    /// Whether no more is put inside, and no more improved, than a bound on shapes asks for.
    pub sparse: bool,
    /// Whether the orientation is mended and exact duplicates are joined first.
    pub repair: bool,
    /// Whether a part of the input that would be left out, or passed over, is an error.
    pub strict: bool,
    /// Whether regions are told apart.
    pub regions: bool,
    /// Whether the bounds on volume that regions have are kept.
    pub region_volumes: bool,
    /// Whether the input is checked and nothing else done.
    pub check_only: bool,
    /// Which files of the family are written.
    pub family: Family,
    /// Whether nothing is printed but errors.
    #[serde(skip)]
    pub quiet: bool,
}

/// What of `TetGen`'s family of files is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Family {
    /// Number of the first item; none: as in the input.
    pub first: Option<u32>,
    /// `.face`.
    pub faces: Wanted,
    /// `.edge`.
    pub edges: Wanted,
    /// Whether `.neigh` is written.
    pub neighbors: bool,
}

/// Which faces or edges are written.
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
    /// Resolves the arguments; the notes are what a person should know about them.
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
        plan.layers = args.layers.asked()?;
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
            split: args.split,
            layers: None,
            optimize: refine,
            sparse: false,
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
            split: !s.keep_boundary,
            layers: None,
            optimize: refine && !s.no_optimization,
            // With a bound on volumes the lattice follows that; one on angles takes all there is to meet.
            sparse: s.max_volume.is_none() && !s.region_volumes && !s.quality.is_some_and(bounds_angles),
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
                "{} is {angle}; give degrees from 0 to below {REGULAR_DIHEDRAL:.2}, the angle of the regular tetrahedron",
                flag(bound)
            ))),
            Some((bound, value)) => Err(not_positive(&flag(bound), value)),
            None => match args.size.filter(|size| !(*size > 0.0 && size.is_finite())) {
                Some(size) => Err(not_positive("--size", size)),
                None => Ok(()),
            },
        }
    }

    /// The tetrahedralizer that does it for an input with these regions.
    pub fn tetrahedralizer(&self, regions: &[Region]) -> Tetrahedralizer {
        let refinement = Refinement::default().bounds(self.bounds);
        let lattice = if self.sparse {
            SPARSE
        } else {
            Interior::Lattice { cell: self.size.map(|size| LATTICE_CELL * size), clearance: None }
        };
        let bounded = self.bounds != Bounds::default() || regions.iter().any(|region| region.max_volume.is_some());
        Tetrahedralizer::new()
            .kind(if self.plc { InputKind::Plc } else { InputKind::Closed })
            .interior(if self.refine { lattice } else { Interior::None })
            .refine(bounded.then_some(refinement))
            .sizing(self.size.filter(|_| bounded || self.split).map_or(Sizing::Surface, Sizing::Constant))
            .boundary(if self.split { Boundary::Split } else { Boundary::Keep })
            .layers(self.layers)
            .optimize(self.optimize)
            .effort(if self.sparse { Effort::Quick } else { Effort::Full })
            .strict(self.strict)
    }
}

/// The bounds among the flags.
fn bounds_of(args: &Args) -> Bounds {
    Bounds { max_radius_edge: args.max_radius_edge, min_dihedral: args.min_dihedral, max_volume: args.max_volume }
}

/// Whether there is a bound on dihedral angles that not all tetrahedra meet.
fn bounds_angles(bounds: Bounds) -> bool {
    bounds.min_dihedral.is_some_and(|degrees| degrees > 0.0)
}

fn not_positive(flag: &str, value: f64) -> Failure {
    Failure::usage(format!("{flag} is {value}; give a finite number above 0"))
}

/// What belongs together between target and plan.
pub fn ensure_fits(plan: &TetPlan, args: &Args, target: Option<&Target>) -> Result<(), Failure> {
    match target {
        None if !plan.check_only => Err(Failure::usage(
            "there is no output: name one with -o MESH (.vtu, .pvtu, .msh, .mesh or .ele), or give --check-only",
        )),
        Some(Target::Stream(_)) if args.common.json && !plan.check_only => {
            Err(Failure::usage("--json and -o - both write to standard output: name a file with -o"))
        }
        _ => Ok(()),
    }
}
