//! Recorded steps of the recovery: flips with each rule, removal of Steiner points, and exact strategies. Each starts with
//! the Delaunay complex, so that no other step hides its results. Operations are recorded, too, since budgets count
//! them. The other tests say what is right; these say what has changed.

use super::exact::{ExactRecovery, Missing, RecoveryStrategy};
use super::*;
use crate::conform;
use crate::delaunay::{delaunay, hash};
use crate::input::validate;
use crate::plc::{InputKind, Plc};
use crate::recorded::{Family, families};
use crate::turned_tests::{Rng, plate, turned};
use anastomesh_mesh::budget::Budget;
use std::fmt::Write;

/// Maximum operations of a step.
const OPERATIONS: u64 = 300_000;

/// A surface and the complex of its points.
struct Case {
    surface: TriMesh,
    edges: SurfaceEdges,
    complex: Complex,
}

impl Case {
    fn new(plc: Plc) -> Self {
        let surface = plc.surface;
        let kind = if plc.segments.is_empty() { InputKind::Closed } else { InputKind::Plc };
        let edges = validate(&surface, &plc.segments, kind).expect("a valid surface");
        let mut points = surface.points.clone();
        points.extend(conform::box_corners(&surface.points));
        let complex = delaunay(&points).expect("points in space");
        Self { surface, edges, complex }
    }
}

/// Sums over the results of a step.
#[derive(Default)]
struct Sums {
    /// Cases in which nothing is missing.
    whole: usize,
    tets: usize,
    operations: u64,
    hash: u64,
}

impl Sums {
    fn add(&mut self, c: &Complex, result: &str, operations: u64) {
        self.tets += c.real_tets().count();
        self.operations += operations;
        let words = c.points.iter().flat_map(|p| p.iter().map(|x| x.to_bits()));
        let tets = (0..c.slots() as u32).filter(|&t| c.is_alive(t)).flat_map(|t| {
            let frozen =
                (4 * t..4 * t + 4).filter(|&half| c.is_frozen(half)).fold(0, |sum, half| sum | 1 << (half & 3));
            c.verts(t).map(u64::from).into_iter().chain([frozen])
        });
        let all = words.chain(tets).chain(result.bytes().map(u64::from)).chain([operations]);
        self.hash = all.fold(self.hash, |sum, x| hash(sum.rotate_left(7) ^ x));
    }
}

/// Flips in at most `passes` passes with Steiner points, then removal of Steiner points.
fn flip(case: &Case, rule: Rule, passes: u32, sums: &mut Sums) {
    let mut c = case.complex.clone();
    let budget = Budget::new(OPERATIONS);
    let mut priority = Priority::default();
    let last = case.surface.triangles.len() as u32 - 1;
    let [p, q, _] = case.surface.triangles[last as usize];
    priority.add(Missing { edges: &[[p.min(q), p.max(q)]], triangles: &[last] });
    let watch = Watch::NOBODY.within(&budget);
    let result = recover_with(&mut c, &case.surface, &case.edges, (rule, passes, &priority), &watch);
    sums.whole += usize::from(result.is_ok());
    sums.add(&c, &format!("{result:?}"), budget.spent());
    let removed = remove_steiner_points(&mut c, case.surface.points.len(), &Watch::NOBODY.within(&budget));
    sums.add(&c, &format!("{removed:?}"), budget.spent());
}

/// Exact recovery from the Delaunay complex by two strategies, the second with what the first leaves.
fn exact(case: &Case, ways: [RecoveryStrategy; 2], flat: f64, sums: &mut Sums) {
    let mut c = case.complex.clone();
    let (edges, triangles) = survey(&mut c, &case.surface, &case.edges);
    let missing = Missing { edges: &edges, triangles: &triangles };
    let mut recovery = ExactRecovery::new(c, (&case.surface, &case.edges), missing, flat);
    for way in ways {
        let budget = Budget::new(OPERATIONS);
        let result = recovery.attempt(way, 1, &Watch::NOBODY.within(&budget));
        match result {
            Ok((c, summary)) => {
                sums.whole += 1;
                return sums.add(&c, &format!("{summary:?}"), budget.spent());
            }
            Err(error) => sums.add(&case.complex, &format!("{error}"), budget.spent()),
        }
    }
    let left = format!("{:?}", recovery.missing_parts().edges);
    let (c, made, _) = recovery.into_complex();
    sums.add(&c, &format!("{left} {made}"), 0);
}

/// Steiner points of each round, at once in the Delaunay complex.
fn add_points(case: &Case, sums: &mut Sums) {
    for round in 0..6 {
        let mut c = case.complex.clone();
        let (edges, triangles) = survey(&mut c, &case.surface, &case.edges);
        let mut r = Recovery::new(&mut c, &case.surface, (&case.edges, Rule::Positive), &Watch::NOBODY);
        let added = r.add_steiner_points(&edges, &triangles, round);
        sums.add(&c, &added.to_string(), 0);
    }
}

type Step = fn(&Case, &mut Sums);

fn flat(case: &Case) -> f64 {
    flat_height(&case.surface.points)
}

fn coarse(case: &Case) -> f64 {
    coarse_height(&case.surface.points)
}

/// Flips and Steiner points.
const FLIPS: [(&str, Step); 4] = [
    ("flips", |case, sums| flip(case, Rule::Positive, MAX_FLIP_PASSES, sums)),
    ("flips, nothing flat", |case, sums| flip(case, Rule::Thick(flat(case)), MAX_FLIP_PASSES, sums)),
    ("one pass", |case, sums| flip(case, Rule::Thick(coarse(case)), 1, sums)),
    ("points", add_points),
];

/// Exact recovery with cavities alone.
const CAVITIES: [(&str, Step); 2] = [
    ("seen", |case, sums| exact(case, [RecoveryStrategy::GIVEN[0], RecoveryStrategy::GIVEN[2]], flat(case), sums)),
    ("deep", |case, sums| exact(case, [RecoveryStrategy::GIVEN[1], RecoveryStrategy::LAST[5]], flat(case), sums)),
];

/// Exact recovery that exchanges edges in planes first.
const PLANES: [(&str, Step); 3] = [
    ("planes", |case, sums| exact(case, RecoveryStrategy::PLANES, flat(case), sums)),
    ("turned", |case, sums| {
        exact(case, [RecoveryStrategy::TURNED[1], RecoveryStrategy::TURNED[2]], coarse(case), sums);
    }),
    ("last", |case, sums| exact(case, [RecoveryStrategy::LAST[1], RecoveryStrategy::LAST[2]], flat(case), sums)),
];

/// Number of members of a family that are tried: the larger ones would take most of the time.
fn tried(name: &str, count: u32) -> u32 {
    match name {
        "plates" => 16,
        "split plates" | "complexes" => 10,
        _ => count,
    }
}

/// Plates with many missing edges in planes: exact ones first, then turned ones.
fn large_plates(k: u32) -> Plc {
    let mut rng = Rng(7);
    let plate = plate(240 - 60 * k, 0.2, &mut rng);
    Plc::from(&if k == 0 { plate } else { turned(plate, &mut rng) })
}

/// Text on the results of steps for each family.
fn results<const N: usize>(steps: [(&str, Step); N]) -> String {
    let mut all = String::new();
    let large: Family = ("large plates", 2, large_plates);
    for (name, count, make) in families().into_iter().chain([large]) {
        let mut sums = steps.map(|_| Sums::default());
        for k in 0..tried(name, count) {
            let case = Case::new(make(k));
            steps.iter().zip(&mut sums).for_each(|((_, run), sums)| run(&case, sums));
        }
        for ((step, _), Sums { whole, tets, operations, hash }) in steps.iter().zip(&sums) {
            writeln!(all, "{name}, {step}: {whole} whole, {tets} tetrahedra, {operations} operations, {hash:016x}")
                .expect("text");
        }
    }
    all
}

#[test]
fn flips_are_as_recorded() {
    insta::assert_snapshot!(results(FLIPS));
}

#[test]
fn cavities_are_as_recorded() {
    insta::assert_snapshot!(results(CAVITIES));
}

#[test]
fn exchanges_in_planes_are_as_recorded() {
    insta::assert_snapshot!(results(PLANES));
}
