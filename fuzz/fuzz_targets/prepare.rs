//! Preparation of small networks with missing radii, repeated and empty edges, short and touching vessels. The result
//! satisfies the check of skeletons, and cleaning it again changes nothing.
#![no_main]

use anastomesh_fuzz::networks::network;
use anastomesh_fuzz::stay_on_this_thread;
use anastomesh_network::{PrepareParams, Prepared, Size, Touching, prepare};
use anastomesh_skeleton::{LineGroup, Skeleton, SkeletonError, clean, is_usable_radius};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    stay_on_this_thread();
    let [mode, switches, cures, rest @ ..] = bytes else { return };
    let raw = network(*mode, rest, false);
    cleaned(&raw);
    let params = params(*switches, *cures);
    let groups = groups(*mode, raw.nodes.len());
    match prepare(&raw, &groups, &params) {
        Ok(prepared) => {
            verify(&raw, &prepared);
            if params == PrepareParams::as_is() {
                assert_eq!(clean(&raw).map(|(network, _)| network), Ok(prepared.skeleton));
            }
        }
        Err(SkeletonError::NoVessel { .. }) => {}
        Err(SkeletonError::BadNodeRadius { .. } | SkeletonError::BadEdgeRadius { .. }) => {
            assert!(!params.radii || !raw.nodes.iter().any(|node| is_usable_radius(node.radius)), "{raw:?}");
        }
        Err(error) => panic!("{error}\n{raw:?}"),
    }
});

/// Cleans a network twice.
fn cleaned(raw: &Skeleton) {
    if let Ok((network, _)) = clean(raw) {
        assert_eq!(network.check(), Ok(()));
        let (again, report) = clean(&network).expect("a clean network");
        assert!(again == network && report.is_empty());
    }
}

fn verify(raw: &Skeleton, prepared: &Prepared) {
    for network in [&prepared.skeleton, &prepared.given, &prepared.outline] {
        assert_eq!(network.check(), Ok(()), "{raw:?}");
        assert!(network.nodes.iter().all(|node| (node.original as usize) < raw.nodes.len()));
    }
    cleaned(&prepared.skeleton);
    assert_eq!(prepared.report.given, Size::of(raw));
    assert_eq!(prepared.report.result, Size::of(&prepared.skeleton));
    assert_eq!(prepared.report.read, Size::of(&prepared.given));
}

fn params(switches: u8, cures: u8) -> PrepareParams {
    let on = |bit: u8| switches & bit != 0;
    let touching = [Touching::Keep, Touching::Retract, Touching::Join][usize::from(cures & 3) % 3];
    let params = if on(128) { PrepareParams::default() } else { PrepareParams::as_is() };
    if on(64) {
        return params;
    }
    params
        .radii(on(1) || cures & 64 == 0)
        .merge(on(2))
        .spurs(on(4))
        .join(on(8))
        .short_tips(on(16))
        .resample(on(32))
        .touching(touching)
        .lossless(cures & 4 != 0)
        .smooth(cures & 8 != 0)
        .only_measured(cures & 16 != 0)
        .drop_islands(if cures & 32 == 0 { 0 } else { 4 })
}

/// Groups of the lines in the form of VMTK, by node; none for most modes.
fn groups(mode: u8, nodes: usize) -> Vec<Option<LineGroup>> {
    if mode & 24 != 24 {
        return Vec::new();
    }
    let group = |i: usize| LineGroup { group: (i / 3) as i64 % 3, blanked: mode & 32 != 0 && i % 5 == 0 };
    (0..nodes).map(|i| Some(group(i))).collect()
}
