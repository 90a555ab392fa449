//! Random cuts and random faults.

use super::*;
use proptest::prelude::*;

/// Parts of a bar of random length, cut at random layers.
fn any_cut() -> impl Strategy<Value = MemoryParts> {
    (2_u32..4, 4_u32..12, prop::collection::vec(any::<bool>(), 12), 0..1000_u64).prop_map(
        |(rings, layers, cuts, seed)| {
            let mut mesh = tube_lattice(rings, layers, 0.4);
            let mut inner = vec![true; mesh.points.len()];
            boundary_faces(&mesh).as_flattened().iter().for_each(|&v| inner[v as usize] = false);
            perturb(&mut mesh.points, &inner, 0.03, seed);
            // Layer by layer, with a cut below some.
            let per_layer = mesh.tets.len() / layers as usize;
            let parts: Vec<u32> = (0..layers as usize)
                .map(|layer| cuts[1..=layer].iter().map(|&cut| u32::from(cut)).sum())
                .flat_map(|part| std::iter::repeat_n(part, per_layer))
                .collect();
            MemoryParts::with_parts(&mesh, &parts, &[], vec![0])
        },
    )
}

/// Kinds of damage to a part.
#[derive(Clone, Copy, Debug)]
enum Damage {
    MovePoint(f64),
    FlipTet,
    DropTet,
    CopyTet,
    ExchangeVertex,
}

fn any_damage() -> impl Strategy<Value = Damage> {
    prop_oneof![
        (0.0..1.0_f64).prop_map(Damage::MovePoint),
        Just(Damage::FlipTet),
        Just(Damage::DropTet),
        Just(Damage::CopyTet),
        Just(Damage::ExchangeVertex),
    ]
}

/// Damages a tetrahedron without a vertex in a joint. Returns false if nothing was done.
fn harm(cut: &mut MemoryParts, harm: Damage, part: usize, at: usize) -> bool {
    let next = cut.pieces.iter().flat_map(|p| &p.tets).max().unwrap() + 1;
    let part = part % cut.pieces.len();
    let piece = &mut cut.pieces[part];
    let on_joint = |v: u32| piece.joints.iter().flatten().flatten().any(|&w| w == v);
    let tet = at % piece.mesh.tets.len();
    let other = (at / 7 % piece.mesh.points.len()) as u32;
    // At a vertex of a joint, parts are judged more strictly than the whole.
    if piece.mesh.tets[tet].iter().any(|&v| on_joint(v)) || on_joint(other) {
        return false;
    }
    match harm {
        Damage::MovePoint(by) => {
            piece.mesh.points[piece.mesh.tets[tet][0] as usize] += Vec3::new(by, 0.3 * by, 0.1 * by);
        }
        Damage::FlipTet => piece.mesh.tets[tet].swap(0, 1),
        Damage::DropTet => {
            piece.mesh.tets.remove(tet);
            piece.tets.remove(tet);
        }
        Damage::CopyTet => {
            piece.mesh.tets.push(piece.mesh.tets[tet]);
            piece.tets.push(next);
        }
        Damage::ExchangeVertex => piece.mesh.tets[tet][0] = other,
    }
    cut.certify();
    true
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn cuts_say_what_the_whole_says(cut in any_cut()) {
        assert_same(&cut);
        prop_assert_eq!(cut.failing(), []);
    }

    /// For any damage inside a part, the same conditions fail.
    #[test]
    fn harmed_parts_fail_as_the_whole_does(cut in any_cut(), how in any_damage(), part in 0..12_usize, at in 0..10_000_usize) {
        let mut cut = cut;
        if harm(&mut cut, how, part, at) {
            let (parts, whole) = (cut.check(), cut.whole());
            for (p, w) in parts.lines.iter().zip(&whole.lines) {
                let open = p.line == Line::Loops && matches!(p.outcome, Outcome::NotChecked(Skipped::Because(_)));
                prop_assert!(open || is_unknown(p) || p.outcome == w.outcome, "{:?}: {:?} {:?}", how, p, w);
            }
            prop_assert_eq!(parts.verdict, whole.verdict);
        }
    }
}
