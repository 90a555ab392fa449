//! The parameters with which a block is tried, one after the other, before its cuts are touched.

use super::block_budget::BlockBudget;
use super::effort::Effort;
use super::once::{self, Connector};
use super::plan::{JointStyle, MeshPlan};
use super::routes::Tangle;
use super::tips;
use crate::block::{BlockError, BlockParams, ConnectorEnd, DIVISIONS, EndStyle, Finished};
use crate::partition::{Cluster, ClusterId, Cut, CutId};
use anastomesh_skeleton::NodeId;
use anastomesh_tet::parts::Watch;

/// Result of a block, and the failures before it.
#[derive(Debug)]
pub struct Tried {
    /// The block, or the failure of the first attempt.
    pub result: Result<Finished, BlockError>,
    /// Failures of the other attempts.
    pub failures: Vec<BlockError>,
    /// Name of the successful attempt.
    pub way: String,
    /// Operations of all attempts, as counted by budgets.
    pub spent: u64,
}

/// A way of making a cluster.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum RetryStrategy {
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
    /// With much smaller voxels and a thin kernel.
    Finest,
    /// With the smallest voxels and the thinnest kernel, for vessels that almost meet. Those that overlap would still fuse.
    Narrowest,
}

impl RetryStrategy {
    /// All, in the order in which they are tried.
    const ALL: [Self; 9] = [
        Self::Usual,
        Self::Shifted,
        Self::Narrower,
        Self::Other,
        Self::Even,
        Self::FinerShifted,
        Self::FinerNarrower,
        Self::Finest,
        Self::Narrowest,
    ];

    /// Those that begin a new try at a cluster whose wall meets that of another.
    pub const APART: [Self; 2] = [Self::FinerNarrower, Self::Finest];

    /// Name in reports.
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
            Self::Narrowest => "finest voxel, thinnest kernel",
        }
    }

    /// True if the strategy may separate close vessels.
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
            Self::Narrowest => BlockParams { kappa: 0.15, voxel_factor: 0.3, ..shifted },
        }
    }
}

/// One attempt at a block.
#[derive(Clone, Debug)]
struct BlockAttempt {
    name: String,
    params: BlockParams,
}

/// Attempts at a cluster. `first`: first strategy to try.
///
/// If neither another grid nor a finer one with a narrower kernel gives a block, narrow gaps between vessels are closed. If that
/// fails, too, vessels that overlap or meet are fused. With `plan.fuse`, they are fused at once.
fn attempts(plan: &MeshPlan, tangle: Tangle, first: RetryStrategy) -> Vec<BlockAttempt> {
    let tangled = tangle != Tangle::Free;
    let ways = || RetryStrategy::ALL.into_iter().filter(move |&way| way >= first && way != RetryStrategy::Narrowest);
    let apart = ways().filter(|way| !tangled || (!plan.fuse && way.may_part()));
    let almost_meet = tangle != Tangle::Overlapping && !(tangled && plan.fuse);
    let apart = apart.chain(almost_meet.then_some(RetryStrategy::Narrowest));
    let apart = apart.map(|way| BlockAttempt { name: way.name().into(), params: way.params(plan) });
    let closed = ways().filter(|way| way.may_part() && !(tangled && plan.fuse)).map(|way| BlockAttempt {
        name: format!("narrow gaps closed, {}", way.name()),
        params: BlockParams { close_gaps: true, ..way.params(plan) },
    });
    let fused = ways().filter(|_| tangled).map(|way| BlockAttempt {
        name: format!("vessels that overlap taken as one, {}", way.name()),
        params: BlockParams { allow_fused: true, ..way.params(plan) },
    });
    apart.chain(closed).chain(fused).collect()
}

/// A block with a smaller radius ratio is tried in other ways, too; a stretched one, with one that is smaller by as much,
const FLAT: f64 = 0.1;
/// and one with layers, which are flat.
const FLAT_LAYERS: f64 = 1e-3;
/// So is one with a smaller dihedral angle in degrees; but then few ways will do, as there are forks that have to have one.
const SLIM: f64 = 12.0;
const WAYS_OUT_OF_SLIM: usize = 3;

/// Number of equal failures after which a large cluster is not tried in further ways of the same kind. It would fail at the same
/// place on another grid.
const ALIKE: usize = 2;

/// Limits for the worst tetrahedron of a block.
#[derive(Clone, Copy, Debug)]
struct Bar {
    ratio: f64,
    dihedral: f64,
    /// No vertex of the wall may be folded.
    unfolded: bool,
}

impl Bar {
    fn of(params: &BlockParams) -> Self {
        let unfolded = params.unfolded;
        if params.layers.is_some() {
            Self { ratio: FLAT_LAYERS, dihedral: 0.0, unfolded }
        } else {
            Self { ratio: FLAT / params.stretch, dihedral: SLIM / params.stretch, unfolded }
        }
    }

    fn is_passed(self, block: &Finished) -> bool {
        self.will_do(block) && (!block.hull.is_empty() || block.certificate.least_dihedral() >= self.dihedral)
    }

    fn is_not_flat(self, block: &Finished) -> bool {
        block.certificate.is_sound() && worst_ratio(block) >= self.ratio
    }

    fn is_unfolded(self, block: &Finished) -> bool {
        !self.unfolded || block.fold().is_none()
    }

    /// Reason why a block does not pass.
    fn fault(self, name: &str, made: &Finished) -> BlockError {
        let block = name.to_owned();
        match made.fold().filter(|_| self.unfolded && self.is_not_flat(made)) {
            Some(at) => BlockError::Folded { block, at: at.into() },
            None => BlockError::Flat {
                block,
                ratio: made.certificate.worst_ratio(),
                dihedral: made.certificate.least_dihedral(),
                limits: [self.ratio, self.dihedral],
            },
        }
    }

    fn will_do(self, block: &Finished) -> bool {
        self.is_not_flat(block) && self.is_unfolded(block)
    }

    /// Sort key of blocks; larger is better. Sound blocks precede others, then blocks without flat tetrahedra, then
    /// those without folded vertices. Of these, the larger smallest dihedral angle is better; of flat ones, the larger worst
    /// radius ratio.
    fn goodness(self, block: &Finished) -> (bool, bool, bool, f64) {
        let is_not_flat = self.is_not_flat(block);
        let worst = if is_not_flat { block.certificate.least_dihedral() } else { worst_ratio(block) };
        (block.certificate.is_sound(), is_not_flat, self.is_unfolded(block), worst)
    }
}

fn worst_ratio(block: &Finished) -> f64 {
    if block.hull.is_empty() { block.certificate.worst_ratio() } else { f64::INFINITY }
}

/// Failures of attempts of each kind, to find equal ones.
#[derive(Default)]
struct Alike(Vec<([bool; 2], String)>);

impl Alike {
    /// True if attempts of this kind failed [`ALIKE`] times with the same error at the same place.
    fn is_enough(&self, params: &BlockParams) -> bool {
        let kind = Self::kind(params);
        let equal = |error: &str| self.0.iter().filter(|(k, other)| *k == kind && other == error).count();
        self.0.iter().any(|(k, error)| *k == kind && equal(error) >= ALIKE)
    }

    fn add(&mut self, params: &BlockParams, error: &BlockError) {
        self.0.push((Self::kind(params), error.to_string()));
    }

    fn kind(params: &BlockParams) -> [bool; 2] {
        [params.close_gaps, params.allow_fused]
    }
}

/// Makes a block with the first strategy that succeeds: no error, no flat or slim tetrahedron, no fault in its own check.
///
/// Otherwise the best block is returned. If no attempt gives a block, the failure of the first is returned, because the
/// dump of the input reproduces it. Further attempts for which `is_over` is true are left out. If the block `is_large`, so are
/// ways like those that failed alike.
fn first_good(
    block: &str,
    attempts: Vec<BlockAttempt>,
    (is_large, is_over): (bool, impl Fn(&BlockParams) -> bool),
    mut make: impl FnMut(&BlockParams) -> Result<Finished, BlockError>,
) -> Tried {
    let mut failures: Vec<BlockError> = Vec::new();
    let mut alike = Alike::default();
    let mut best: Option<(usize, BlockAttempt, Finished)> = None;
    for (tried, attempt) in attempts.into_iter().enumerate() {
        let bar = Bar::of(&attempt.params);
        // Vessels that can be kept apart are not taken as one for the sake of a tetrahedron.
        let will_do = |(_, best, made): &(usize, BlockAttempt, Finished)| {
            best.params.allow_fused != attempt.params.allow_fused && Bar::of(&best.params).is_unfolded(made)
                || tried > WAYS_OUT_OF_SLIM && Bar::of(&best.params).will_do(made)
        };
        if best.as_ref().is_some_and(will_do) {
            break;
        }
        if tried > 0 && is_over(&attempt.params) || is_large && alike.is_enough(&attempt.params) {
            continue;
        }
        match make(&attempt.params) {
            Ok(made) if bar.is_passed(&made) => {
                return Tried { result: Ok(made), failures, way: attempt.name, spent: 0 };
            }
            Ok(made) => {
                let before = failures.len();
                failures.push(bar.fault(block, &made));
                if best.as_ref().is_none_or(|(_, _, best)| bar.goodness(&made) > bar.goodness(best)) {
                    best = Some((before, attempt, made));
                }
            }
            Err(error) => {
                alike.add(&attempt.params, &error);
                failures.push(error);
            }
        }
    }
    match best {
        Some((before, attempt, made)) => {
            failures.truncate(before);
            Tried { result: Ok(made), failures, way: attempt.name, spent: 0 }
        }
        None => Tried { result: Err(failures.swap_remove(0)), failures, way: String::new(), spent: 0 },
    }
}

/// Meshes a cluster.
///
/// - `tangle`: how close its vessels come to each other
/// - `first`: first strategy to try
/// - `original`: number of a terminal in the network as it was read
pub fn cluster(
    id: ClusterId,
    cluster: &Cluster,
    (plan, effort): (&MeshPlan, Effort),
    (tangle, first): (Tangle, RetryStrategy),
    original: impl Fn(NodeId) -> u32,
    watch: &Watch,
) -> Tried {
    let name = format!("cluster {}", id.0);
    let budget = BlockBudget::of(id, cluster, plan, effort, watch);
    // A cluster that is made again with finer edges is not fused for that.
    let may_exceed = first == RetryStrategy::Usual && !plan.fuse;
    let budget = if may_exceed { budget.with_reserve(cluster) } else { budget };
    let made = |cluster: &Cluster| {
        let make = |params: &BlockParams| {
            budget.attempt(cluster, params, |watch| once::cluster(id, cluster, params, &original, watch))
        };
        let is_over = |params: &BlockParams| budget.is_over_for(params);
        first_good(&name, attempts(plan, tangle, first), (budget.is_large, is_over), make)
    };
    let tried = made(cluster);
    let open = tips::uncapped(cluster, &tried.result, &tried.failures);
    let is_over = || budget.is_over();
    let mut tried_moves = Vec::new();
    let Some((block, way, failures)) =
        [false, true].into_iter().find_map(|all| with_tips_moved(cluster, &open, all, is_over, &mut tried_moves, made))
    else {
        return Tried { spent: budget.spent(), ..tried };
    };
    let failures = [tried.failures, tried.result.err().into_iter().collect(), failures].concat();
    Tried { result: Ok(block), failures, way, spent: budget.spent() }
}

/// Moves of tips that failed, and the tips that they left uncapped.
type TriedMoves = (Vec<(u32, f64)>, Vec<u32>);

/// Makes a cluster with its tips moved until all are capped: the way in which it came out, and what failed in it. `all`: every
/// tip that could not be capped at some time, by the same; else a tip stays where it could be capped. `tried`: moves that
/// failed, and the tips that they left uncapped. They are not repeated.
fn with_tips_moved(
    cluster: &Cluster,
    uncapped: &[u32],
    all: bool,
    is_over: impl Fn() -> bool,
    tried: &mut Vec<TriedMoves>,
    made: impl Fn(&Cluster) -> Tried,
) -> Option<(Finished, String, Vec<BlockError>)> {
    let mut open = uncapped.to_vec();
    let mut moves: Vec<(u32, f64)> = Vec::new();
    for radii in tips::MOVES.into_iter().take_while(|_| !uncapped.is_empty() && !is_over()) {
        moves.retain(|(end, _)| !open.contains(end) && !all);
        moves.extend(open.iter().map(|&end| (end, radii)));
        let known = tried.iter().find(|(tried, _)| *tried == moves).map(|(_, still)| still.clone());
        let still = if let Some(still) = known {
            still
        } else {
            let Some(moved) = tips::moved(cluster, &moves) else { continue };
            let again = made(&moved);
            let still = tips::uncapped(&moved, &again.result, &again.failures);
            if let Ok(block) = again.result
                && still.is_empty()
            {
                return Some((block, format!("{}, {}", tips::described(&moves), again.way), again.failures));
            }
            tried.push((moves.clone(), still.clone()));
            still
        };
        if all {
            // Another one may be in the way now.
            open.extend(still.into_iter().filter(|end| !uncapped.contains(end)));
        } else if !still.is_empty() {
            // What failed otherwise says nothing about tips.
            open = still;
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

/// Makes a connector without its clusters.
pub fn free_connector(id: CutId, cut: &Cut, plan: &MeshPlan) -> Tried {
    divided(id, plan, |params| once::free_connector(id, cut, params))
}

/// A connector, its tube divided in one way after the other.
fn divided(id: CutId, plan: &MeshPlan, mut make: impl FnMut(&BlockParams) -> Result<Connector, BlockError>) -> Tried {
    let way = |first_division| BlockAttempt {
        name: "other division of the tube".into(),
        params: BlockParams { first_division, ..plan.block_params() },
    };
    let mut before: Vec<BlockError> = Vec::new();
    let mut tried =
        first_good(&format!("connector {}", id.0), (0..DIVISIONS).map(way).collect(), (false, |_| false), |params| {
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
        let p = |x, y, z| anastomesh_mesh::geometry::Point3::new(x, y, z);
        let points = vec![p(0., 0., 0.), p(1., 0., 0.), p(0.5, 0.75_f64.sqrt(), 0.), p(0.5, 0.3, height)];
        let mesh = anastomesh_mesh::TetMesh { points, tets: vec![[0, 1, 2, 3]] };
        let cluster = crate::block::ClusterMesh { mesh, ..Default::default() };
        Finished::of_cluster(cluster, |node| node.0).expect("a wall of four faces")
    }

    #[test]
    fn flat_blocks_are_kept_only_when_nothing_better_comes() {
        let usual = MeshPlan::default().block_params();
        let failed = || BlockError::Parameter { name: "none", value: 0.0 };
        let try_all = |results: &[Option<f64>]| {
            let way = |first_division: usize| BlockAttempt {
                name: first_division.to_string(),
                params: BlockParams { first_division, ..usual },
            };
            first_good("block", (0..results.len()).map(way).collect(), (false, |_| false), |params| {
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
        assert!(failures[0].to_string().contains("radius ratio "), "{}", failures[0]);
    }

    /// A block of one tetrahedron with edges of 1 but for one of this length.
    fn wedge(thin: f64) -> Finished {
        let p = |x, y, z| anastomesh_mesh::geometry::Point3::new(x, y, z);
        let apex = (0.75 - 0.25 * thin * thin).sqrt();
        let points = vec![p(-0.5, 0., 0.), p(0.5, 0., 0.), p(0., apex, -0.5 * thin), p(0., apex, 0.5 * thin)];
        let mesh = anastomesh_mesh::TetMesh { points, tets: vec![[0, 1, 2, 3]] };
        let cluster = crate::block::ClusterMesh { mesh, ..Default::default() };
        Finished::of_cluster(cluster, |node| node.0).expect("a wall of four faces")
    }

    #[test]
    fn few_ways_are_tried_for_the_sake_of_an_angle() {
        let usual = MeshPlan::default().block_params();
        let bar = Bar::of(&usual);
        let slim = [0.1, 0.12, 0.11, 0.09, 0.15].map(wedge);
        for block in &slim {
            assert!(bar.is_not_flat(block) && !bar.is_passed(block));
        }
        assert!(bar.is_passed(&wedge(0.3)));
        assert!(bar.goodness(&slim[0]) > bar.goodness(&block(0.03)));
        let way =
            |first_division| BlockAttempt { name: String::new(), params: BlockParams { first_division, ..usual } };
        let mut asked = 0;
        let tried = first_good("block", (0..slim.len()).map(way).collect(), (false, |_| false), |params| {
            asked += 1;
            Ok(slim[params.first_division].clone())
        });
        assert_eq!(asked, 1 + WAYS_OUT_OF_SLIM);
        assert_eq!((tried.result.ok(), tried.failures.len()), (Some(slim[1].clone()), 1));
    }

    #[test]
    fn attempts_end_with_the_budget() {
        let usual = MeshPlan::default().block_params();
        let asked = std::cell::Cell::new(0);
        let attempts = || vec![BlockAttempt { name: String::new(), params: usual }; 5];
        let failed = |_: &BlockParams| {
            asked.set(asked.get() + 1);
            Err(BlockError::Parameter { name: "none", value: f64::from(asked.get()) })
        };
        let Tried { result, failures, .. } =
            first_good("block", attempts(), (false, |_: &BlockParams| asked.get() >= 2), failed);
        // The first failure counts, and the attempt that begins within the budget is not the last word.
        assert_eq!(result.err(), Some(BlockError::Parameter { name: "none", value: 1.0 }));
        assert_eq!((asked.get(), failures.len()), (2, 1));
        // One attempt is made in any case, or there would be no reason to report.
        asked.set(7);
        assert!(first_good("block", attempts(), (false, |_| true), failed).result.is_err());
        assert_eq!(asked.get(), 8);
    }

    #[test]
    fn a_large_block_is_not_tried_again_where_it_failed_alike() {
        let usual = MeshPlan::default().block_params();
        let attempts: Vec<BlockAttempt> = [false, true]
            .into_iter()
            .flat_map(|allow_fused| [0, 0, 1, 1, 1, 2].map(|first_division| (allow_fused, first_division)))
            .map(|(allow_fused, first_division)| BlockParams { first_division, allow_fused, ..usual })
            .map(|params| BlockAttempt { name: String::new(), params })
            .collect();
        let asked = |is_large| {
            let mut asked = Vec::new();
            let failed = |params: &BlockParams| {
                asked.push(params.first_division);
                Err(BlockError::Parameter { name: "none", value: (params.first_division / 2) as f64 })
            };
            assert!(first_good("block", attempts.clone(), (is_large, |_| false), failed).result.is_err());
            asked
        };
        assert_eq!(asked(false).len(), attempts.len());
        // Two of each kind.
        assert_eq!(asked(true), [0, 0, 0, 0]);
    }

    #[test]
    fn a_cluster_is_fused_when_other_attempts_have_used_the_budget() {
        // They overlap so little that only the wall shows that they fuse.
        let points = [[0., 0., 0.], [20., 0., 0.], [20., 12., 1.5], [10., 12., 1.5], [10., -12., 1.5]];
        let network = anastomesh_skeleton::fixtures::network(&points, 1.0, &[(0, 1), (1, 2), (2, 3), (3, 4)]);
        let params = crate::partition::PartitionParams { long: 1e9, ..Default::default() };
        let crossing = crate::partition::partition(&network, &params).expect("a partition").clusters.remove(0);
        let tried = |plan: &MeshPlan, effort, first| {
            let tangle = (Tangle::Overlapping, first);
            cluster(ClusterId(0), &crossing, (plan, effort), tangle, |node| node.0, &Watch::NOBODY)
        };
        let plan = MeshPlan::default();
        let scarce = Effort::linear(1e4, 0.0);
        let fused = tried(&plan, scarce, RetryStrategy::Usual);
        assert_eq!(fused.way, "vessels that overlap taken as one, as usual");
        assert!(fused.failures.len() == 1 && fused.failures[0].is_over_budget(), "{:?}", fused.failures);
        let ample = tried(&plan, Effort::full(1), RetryStrategy::Usual);
        assert_eq!((ample.result, ample.way), (fused.result, fused.way));
        assert!(ample.failures.len() > 1 && ample.spent > fused.spent);
        // A cluster whose wall meets another one stays as it is.
        assert!(tried(&plan, scarce, RetryStrategy::FinerNarrower).result.is_err());
    }

    #[test]
    fn moved_tips_are_tried_once_each() {
        let cluster = crate::block::fixtures::bifurcation(3);
        let end = (0..).zip(&cluster.ends).find(|(_, end)| matches!(end.kind, crate::partition::EndKind::Terminal(_)));
        let (tip, _) = end.expect("a tip");
        let made = std::cell::RefCell::new(Vec::new());
        let fails = |moved: &Cluster| {
            made.borrow_mut().push(moved.ends[tip as usize].section.origin);
            let failure = BlockError::Parameter { name: "none", value: 0.0 };
            Tried { result: Err(failure), failures: Vec::new(), way: String::new(), spent: 0 }
        };
        let mut tried = Vec::new();
        for all in [false, true] {
            assert!(with_tips_moved(&cluster, &[tip], all, || false, &mut tried, fails).is_none());
        }
        let count = made.borrow().len();
        assert!(count > 2 && count <= tips::MOVES.len(), "{count}");
        for (i, place) in made.borrow().iter().enumerate() {
            assert!(!made.borrow()[..i].contains(place));
        }
        assert!(with_tips_moved(&cluster, &[tip], false, || true, &mut Vec::new(), fails).is_none());
        assert_eq!(made.borrow().len(), count);
    }

    #[test]
    fn vessels_that_may_overlap_are_kept_apart_if_they_can_be() {
        let fused = |plan: &MeshPlan, tangle| -> Vec<bool> {
            attempts(plan, tangle, RetryStrategy::Usual).iter().map(|attempt| attempt.params.allow_fused).collect()
        };
        let plan = MeshPlan::default();
        let all = RetryStrategy::ALL.len();
        assert_eq!(fused(&plan, Tangle::Free), vec![false; all + 5]);
        let overlapping = [vec![false; 10], vec![true; all - 1]].concat();
        assert_eq!(fused(&plan, Tangle::Overlapping), overlapping);
        assert_eq!(fused(&plan, Tangle::Meeting), [&[false], &overlapping[..]].concat());
        for tangle in [Tangle::Meeting, Tangle::Overlapping] {
            assert_eq!(fused(&MeshPlan { fuse: true, ..plan.clone() }, tangle), vec![true; all - 1]);
        }
        let names: Vec<String> = attempts(&plan, Tangle::Overlapping, RetryStrategy::Usual)
            .into_iter()
            .map(|attempt| attempt.name)
            .collect();
        assert_eq!(names[3], "finer voxel, narrower kernel");
        assert_eq!(names[5], "narrow gaps closed, as usual");
        assert_eq!(names[10], "vessels that overlap taken as one, as usual");
        assert!(RetryStrategy::ALL.is_sorted());
        for first in RetryStrategy::APART {
            assert_eq!(attempts(&plan, Tangle::Free, first)[0].name, first.name());
            assert!(attempts(&plan, Tangle::Overlapping, first).iter().any(|attempt| !attempt.params.allow_fused));
        }
    }
}
