//! Refinement of small networks with few iterations. The result satisfies the check of skeletons, has the topology of
//! the input, and agrees with its report.
#![no_main]

use anastomesh_fuzz::networks::{network, shape};
use anastomesh_fuzz::stay_on_this_thread;
use anastomesh_network::{Crowded, Freedom, Metric, RefineParams, Refined, Residual, refine};
use anastomesh_skeleton::{Skeleton, clean};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    stay_on_this_thread();
    let [mode, switches, iterations, rest @ ..] = bytes else { return };
    let Ok((given, _)) = clean(&network(*mode, rest, true)) else { return };
    let params = params(*switches, usize::from(iterations % 24));
    let refined = refine(&given, &params, &()).unwrap_or_else(|error| panic!("{error}\n{given:?}"));
    verify(&given, &params, &refined);
});

fn verify(given: &Skeleton, params: &RefineParams, refined: &Refined) {
    let Refined { skeleton, origin, report, .. } = refined;
    assert_eq!(skeleton.check(), Ok(()), "{given:?}");
    assert_eq!(skeleton.nodes.len(), origin.len());
    assert!(skeleton.nodes.iter().all(|node| (node.original as usize) < 18));
    assert!(origin.iter().all(|p| p.iter().all(|x| x.is_finite())));
    if params.crowded != Crowded::Merge {
        assert_eq!(shape(given), shape(skeleton), "{given:?}");
    }
    assert_eq!(report.size_before, [given.nodes.len(), given.edges.len()]);
    if report.residual.shrunk_edges == 0 {
        assert_eq!(report.size_after, [skeleton.nodes.len(), skeleton.edges.len()]);
    }
    let max = skeleton.nodes.iter().zip(origin).fold(0.0, |max: f64, (n, o)| max.max((n.position - o).norm()));
    assert!(report.displacement.max.is_finite() && max.is_finite());
    assert!(max <= 21.0 * report.unit * (1.0 + 1e-9), "{given:?}");
    let (before, after) = (&report.given, &report.result);
    assert!(!params.hold.contains(&Metric::Overlaps) || after.overlaps <= before.overlaps, "{given:?}");
    if params.lengthens(given) {
        let overlaps = |network: &Skeleton| network.overlaps(&network.adjacency()).pairs.len();
        assert_eq!((before.overlaps, after.overlaps), (overlaps(given), overlaps(skeleton)), "{given:?}");
        assert!(!params.hold.contains(&Metric::FarPairs) || after.far <= before.far, "{given:?}");
    }
    if params.residual == Residual::Report {
        assert_eq!((report.residual.left, report.residual.shrunk_edges), (after.overlaps, 0));
    }
}

fn params(switches: u8, iterations: usize) -> RefineParams {
    let pick = |shift: u32| usize::from(switches >> shift & 3);
    RefineParams::default()
        .iterations(iterations)
        .every(0)
        .residual([Residual::Shrink, Residual::Report, Residual::Fuse, Residual::Shrink][pick(0)])
        .crowded([Crowded::Part, Crowded::Keep, Crowded::Merge, Crowded::Part][pick(2)])
        .freedom([Freedom::Auto, Freedom::Grown, Freedom::Measured, Freedom::Radii(0.5)][pick(4)])
        .bends(switches & 64 == 0)
        .free_terminals(if switches & 128 == 0 { 0.0 } else { 2.0 })
}
