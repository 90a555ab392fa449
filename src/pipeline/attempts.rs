//! The parameters with which a block is tried, one after the other, before its cuts are touched.

use super::once::{self, Connector};
use super::plan::{JointStyle, MeshPlan};
use super::tips;
use crate::block::{BlockError, BlockParams, ConnectorEnd, DIVISIONS, EndStyle, Finished};
use crate::partition::{Cluster, ClusterId, Cut, CutId};
use crate::skeleton::NodeId;
use crate::tet::Watch;

/// Result of a block, and the failures before it.
#[derive(Debug)]
pub struct Tried {
    /// The block, or the failure of the first attempt.
    pub result: Result<Finished, BlockError>,
    /// Failures of the other attempts.
    pub failures: Vec<BlockError>,
    /// What the way is called in which it came out.
    pub way: String,
}

/// A way of making a cluster.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Way {
    /// As the plan has it.
    Usual,
    /// With the grid of the contour moved: another triangulation of the same wall.
    Shifted,
    /// With a narrower kernel: parallel vessels fuse when their axes are closer than √(1 + 2 κ² ln 2) times the sum of their
    /// radii.
    Narrower,
    /// With ends of the other kind where joints are woven, else with yet another grid and a kernel in between.
    Other,
    /// With edges that follow the radius half as far: a thin vessel beside a thick one is lost in triangles as large as that.
    Even,
    /// `Shifted`, with smaller voxels.
    FinerShifted,
    /// `Narrower`, with smaller voxels.
    FinerNarrower,
    /// With the smallest voxels and the thinnest kernel.
    Finest,
}

impl Way {
    /// All, in the order in which they are tried.
    const ALL: [Self; 8] = [
        Self::Usual,
        Self::Shifted,
        Self::Narrower,
        Self::Other,
        Self::Even,
        Self::FinerShifted,
        Self::FinerNarrower,
        Self::Finest,
    ];

    /// Those that begin a new try at a cluster whose wall meets that of another.
    pub const APART: [Self; 2] = [Self::FinerNarrower, Self::Finest];

    /// What it is called in a report.
    pub fn name(self) -> &'static str {
        match self {
            Self::Usual => "as usual",
            Self::Shifted => "grid shifted",
            Self::Even => "more even edges",
            Self::Narrower => "narrower kernel",
            Self::Other => "other ends or grid",
            Self::FinerShifted => "finer voxel, grid shifted",
            Self::FinerNarrower => "finer voxel, narrower kernel",
            Self::Finest => "much finer voxel, thin kernel",
        }
    }

    /// Whether it may keep vessels apart that come close to each other.
    fn may_part(self) -> bool {
        matches!(self, Self::Usual | Self::Shifted | Self::Even | Self::FinerNarrower | Self::Finest)
    }

    fn params(self, plan: &MeshPlan) -> BlockParams {
        let usual = plan.block_params();
        let shifted = BlockParams { shift: [0.37, -0.23, 0.11], ..usual };
        let narrower = BlockParams { kappa: 0.25, ..usual };
        let finer = |params| BlockParams { voxel_factor: 0.75, ..params };
        match self {
            Self::Usual => usual,
            Self::Shifted => shifted,
            Self::Even => BlockParams { follow: 0.5 * usual.follow, ..usual },
            Self::Narrower => narrower,
            Self::Other => match plan.joint {
                JointStyle::Woven => BlockParams { ends: EndStyle::Open, ..usual },
                JointStyle::Disc | JointStyle::None => BlockParams { shift: [-0.29, 0.43, 0.31], kappa: 0.29, ..usual },
            },
            Self::FinerShifted => finer(shifted),
            Self::FinerNarrower => finer(narrower),
            Self::Finest => BlockParams { kappa: 0.2, voxel_factor: 0.5, ..shifted },
        }
    }
}

/// One attempt at a block.
#[derive(Clone, Debug)]
struct Attempt {
    name: String,
    params: BlockParams,
}

/// The attempts at a cluster. `overlapping`: vessels of the network overlap in it, or come so close to each other that they
/// may. If neither another grid nor a finer one with a narrower kernel keeps them apart they are taken as one, at once if
/// that is what is wanted. `first`: the first of the ways that is tried.
fn attempts(plan: &MeshPlan, overlapping: bool, first: Way) -> Vec<Attempt> {
    let ways = || Way::ALL.into_iter().filter(move |&way| way >= first);
    let apart = ways().filter(|way| !overlapping || (!plan.fuse && way.may_part()));
    let apart = apart.map(|way| Attempt { name: way.name().into(), params: way.params(plan) });
    let fused = ways().filter(|_| overlapping).map(|way| Attempt {
        name: format!("vessels that overlap taken as one, {}", way.name()),
        params: BlockParams { allow_fused: true, ..way.params(plan) },
    });
    apart.chain(fused).collect()
}

/// A block with a smaller radius ratio is tried in other ways, too; a stretched one, with one that is smaller by as much,
const FLAT: f64 = 0.1;
/// and one with layers, which are flat.
const FLAT_LAYERS: f64 = 1e-3;

/// The smallest radius ratio of a block that is taken at once.
fn flat(params: &BlockParams) -> f64 {
    if params.layers.is_some() { FLAT_LAYERS } else { FLAT / params.stretch }
}

/// Makes a block in the first way that does it well: nothing fails, no tetrahedron is all but flat, and the block's own check
/// finds no fault. Else the best of those that came out is taken. When nothing helps, the failure of the first way counts: it
/// is what the dump of the input reproduces.
fn first_good(
    block: &str,
    attempts: Vec<Attempt>,
    mut make: impl FnMut(&BlockParams) -> Result<Finished, BlockError>,
) -> Tried {
    let mut failures: Vec<BlockError> = Vec::new();
    let mut best: Option<(usize, Attempt, Finished)> = None;
    for attempt in attempts {
        // Vessels that can be kept apart are not taken as one for the sake of a tetrahedron.
        if best.as_ref().is_some_and(|(_, best, _)| best.params.allow_fused != attempt.params.allow_fused) {
            break;
        }
        match make(&attempt.params) {
            Ok(made) if goodness(&made) >= (true, flat(&attempt.params)) => {
                return Tried { result: Ok(made), failures, way: attempt.name };
            }
            Ok(made) => {
                let before = failures.len();
                failures.push(BlockError::Flat { block: block.to_owned(), ratio: made.certificate.worst_ratio() });
                if best.as_ref().is_none_or(|(_, _, best)| goodness(&made) > goodness(best)) {
                    best = Some((before, attempt, made));
                }
            }
            Err(error) => failures.push(error),
        }
    }
    match best {
        Some((before, attempt, made)) => {
            failures.truncate(before);
            Tried { result: Ok(made), failures, way: attempt.name }
        }
        None => Tried { result: Err(failures.swap_remove(0)), failures, way: String::new() },
    }
}

/// A block is better if it is sound, and of sound ones the one whose flattest tetrahedron is rounder.
fn goodness(block: &Finished) -> (bool, f64) {
    let worst = if block.hull.is_empty() { block.certificate.worst_ratio() } else { f64::INFINITY };
    (block.certificate.is_sound(), worst)
}

/// Meshes a cluster. `overlapping`: vessels of the network overlap in it; `first`: the way that is tried first; `original`:
/// the number of a terminal in the network as it was read.
pub fn cluster(
    id: ClusterId,
    cluster: &Cluster,
    plan: &MeshPlan,
    overlapping: bool,
    first: Way,
    original: impl Fn(NodeId) -> u32,
    watch: &Watch,
) -> Tried {
    let name = format!("cluster {}", id.0);
    let made = |cluster: &Cluster| {
        let make = |params: &BlockParams| once::cluster(id, cluster, params, &original, watch);
        first_good(&name, attempts(plan, overlapping, first), make)
    };
    let tried = made(cluster);
    let open = tips::uncapped(cluster, &tried.result, &tried.failures);
    let Some((block, way, failures)) =
        [false, true].into_iter().find_map(|all| with_tips_moved(cluster, &open, all, made))
    else {
        return tried;
    };
    let failures = [tried.failures, tried.result.err().into_iter().collect(), failures].concat();
    Tried { result: Ok(block), failures, way }
}

/// Makes a cluster with its tips moved until all are capped: the way in which it came out, and what failed in it. `all`: every
/// tip that could not be capped at some time, by the same; else a tip stays where it could be capped.
fn with_tips_moved(
    cluster: &Cluster,
    uncapped: &[u32],
    all: bool,
    made: impl Fn(&Cluster) -> Tried,
) -> Option<(Finished, String, Vec<BlockError>)> {
    let mut open = uncapped.to_vec();
    let mut moves: Vec<(u32, f64)> = Vec::new();
    for radii in tips::MOVES.into_iter().take_while(|_| !uncapped.is_empty()) {
        moves.retain(|(end, _)| !open.contains(end) && !all);
        moves.extend(open.iter().map(|&end| (end, radii)));
        let Some(moved) = tips::moved(cluster, &moves) else { continue };
        let again = made(&moved);
        let still = tips::uncapped(&moved, &again.result, &again.failures);
        match again.result {
            Ok(block) if still.is_empty() => {
                return Some((block, format!("{}, {}", tips::described(&moves), again.way), again.failures));
            }
            // Another one may be in the way now.
            _ if all => open.extend(still.into_iter().filter(|end| !uncapped.contains(end))),
            // What failed otherwise says nothing about tips.
            _ if !still.is_empty() => open = still,
            _ => {}
        }
        open.sort_unstable();
        open.dedup();
    }
    None
}

/// Meshes a connector between the ends of its two clusters.
pub fn connector(id: CutId, cut: &Cut, ends: [ConnectorEnd; 2], plan: &MeshPlan) -> Tried {
    divided(id, plan, |params| once::connector(id, cut, ends, params))
}

/// The same for a connector that is made without its clusters.
pub fn free_connector(id: CutId, cut: &Cut, plan: &MeshPlan) -> Tried {
    divided(id, plan, |params| once::free_connector(id, cut, params))
}

/// A connector, its tube divided in one way after the other.
fn divided(id: CutId, plan: &MeshPlan, mut make: impl FnMut(&BlockParams) -> Result<Connector, BlockError>) -> Tried {
    let way = |first_division| Attempt {
        name: "other division of the tube".into(),
        params: BlockParams { first_division, ..plan.block_params() },
    };
    let mut before: Vec<BlockError> = Vec::new();
    let mut tried = first_good(&format!("connector {}", id.0), (0..DIVISIONS).map(way).collect(), |params| {
        let (made, divisions) = make(params)?;
        // A division that fails gives way to the next one at once.
        let failed = |attempt| BlockError::Connector { cut: id, at: [f64::NAN; 3], attempts: vec![attempt] };
        before.extend(divisions.into_iter().map(failed));
        Ok(made)
    });
    tried.failures.extend(before);
    tried
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A block of one tetrahedron of this height over an equilateral triangle, nearly above its centre.
    fn block(height: f64) -> Finished {
        let p = |x, y, z| crate::geometry::Point3::new(x, y, z);
        let points = vec![p(0., 0., 0.), p(1., 0., 0.), p(0.5, 0.75_f64.sqrt(), 0.), p(0.5, 0.3, height)];
        let mesh = crate::mesh::TetMesh { points, tets: vec![[0, 1, 2, 3]] };
        let cluster = crate::block::ClusterMesh { mesh, ..Default::default() };
        Finished::of_cluster(cluster, |node| node.0).expect("a wall of four faces")
    }

    #[test]
    fn flat_blocks_are_kept_only_when_nothing_better_comes() {
        let usual = MeshPlan::default().block_params();
        let failed = || BlockError::Parameter { name: "none", value: 0.0 };
        let try_all = |results: &[Option<f64>]| {
            let way = |first_division: usize| Attempt {
                name: first_division.to_string(),
                params: BlockParams { first_division, ..usual },
            };
            first_good("block", (0..results.len()).map(way).collect(), |params| {
                results[params.first_division].map(block).ok_or_else(failed)
            })
        };
        let of = |results: &[Option<f64>]| {
            let Tried { result, failures, .. } = try_all(results);
            (result.ok(), failures.len())
        };
        assert_eq!(of(&[Some(0.8), Some(0.9)]), (Some(block(0.8)), 0));
        assert_eq!(of(&[None, Some(1e-3), Some(0.8)]), (Some(block(0.8)), 2));
        assert_eq!(of(&[Some(1e-3), Some(2e-3), None]), (Some(block(2e-3)), 1));
        assert_eq!(of(&[Some(2e-3), Some(1e-3), None]), (Some(block(2e-3)), 0));
        assert_eq!(of(&[None, None]), (None, 1));
        let Tried { failures, way, .. } = try_all(&[Some(1e-3), Some(0.8)]);
        assert_eq!(way, "1");
        assert_eq!(try_all(&[None, Some(2e-3), Some(1e-3), None]).way, "1");
        assert!(failures[0].to_string().contains("all but flat"), "{}", failures[0]);
    }

    #[test]
    fn vessels_that_may_overlap_are_kept_apart_if_they_can_be() {
        let fused = |plan: &MeshPlan, overlapping| -> Vec<bool> {
            attempts(plan, overlapping, Way::Usual).iter().map(|attempt| attempt.params.allow_fused).collect()
        };
        let plan = MeshPlan::default();
        assert_eq!(fused(&plan, false), [false; Way::ALL.len()]);
        assert_eq!(fused(&plan, true), [[false; 5].as_slice(), &[true; Way::ALL.len()]].concat());
        assert_eq!(fused(&MeshPlan { fuse: true, ..plan.clone() }, true), [true; Way::ALL.len()]);
        let names: Vec<String> = attempts(&plan, true, Way::Usual).into_iter().map(|attempt| attempt.name).collect();
        assert_eq!(names[3], "finer voxel, narrower kernel");
        assert_eq!(names[5], "vessels that overlap taken as one, as usual");
        assert!(Way::ALL.is_sorted());
        for first in Way::APART {
            assert_eq!(attempts(&plan, false, first)[0].name, first.name());
            assert!(attempts(&plan, true, first).iter().any(|attempt| !attempt.params.allow_fused));
        }
    }
}
