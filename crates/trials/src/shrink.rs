//! Shrinking of findings: parts of the input and options are removed while the sort of the finding stays.

use crate::case::{Case, Expect, Input};
use crate::judge::{Outcome, Programs, judge};
use crate::network::Network;
use crate::surface::Surface;
use std::io;
use std::path::Path;
use std::time::{Duration, Instant};

/// Shrinks a case that leads to a finding of this sort, in at most the given time.
pub fn shrink(case: &Case, sort: &str, programs: &Programs, folder: &Path, limit: Duration) -> io::Result<Case> {
    let start = Instant::now();
    let mut failure = None;
    let small = smallest(case.clone(), &mut |candidate| {
        if failure.is_some() || start.elapsed() > limit {
            return false;
        }
        match judge(candidate, programs, folder) {
            Ok(judged) => matches!(judged.outcome, Outcome::Finding { sort: found, .. } if found == sort),
            Err(error) => {
                failure = Some(error);
                false
            }
        }
    });
    failure.map_or(Ok(small), Err)
}

/// Removes options and parts of the input while `is_same` holds.
pub fn smallest(mut case: Case, is_same: &mut dyn FnMut(&Case) -> bool) -> Case {
    loop {
        let size = (case.size(), case.options.len(), case.text().len());
        case = without_options(case, is_same);
        case = match case.input.clone() {
            Input::Network(network) => smaller_network(case, network, is_same),
            Input::Surface(surface) => smaller_surface(case, surface, Input::Surface, is_same),
            Input::Complex(complex) => smaller_surface(case, complex, Input::Complex, is_same),
            Input::Text(_) => case,
        };
        if (case.size(), case.options.len(), case.text().len()) >= size {
            return case;
        }
    }
}

fn without_options(mut case: Case, is_same: &mut dyn FnMut(&Case) -> bool) -> Case {
    for i in (0..case.options.len()).rev() {
        let mut fewer = case.clone();
        fewer.options.remove(i);
        if is_same(&fewer) {
            case = fewer;
        }
    }
    case
}

/// Removes elements in chunks that halve in size (delta debugging, Zeller 2002).
fn fewer(count: usize, is_same: &mut dyn FnMut(&[bool]) -> bool) -> Vec<bool> {
    let mut kept = vec![true; count];
    let mut chunk = count.div_ceil(2);
    while chunk > 0 {
        for start in (0..count).step_by(chunk) {
            let range = start..(start + chunk).min(count);
            if kept[range.clone()].iter().all(|kept| !kept) {
                continue;
            }
            let mut without = kept.clone();
            without[range].fill(false);
            if without.contains(&true) && is_same(&without) {
                kept = without;
            }
        }
        chunk /= 2;
    }
    kept
}

fn smaller_network(mut case: Case, mut network: Network, is_same: &mut dyn FnMut(&Case) -> bool) -> Case {
    let with = |case: &Case, network: &Network| Case { input: Input::Network(network.clone()), ..case.clone() };
    let kept = fewer(network.edges.len(), &mut |kept| is_same(&with(&case, &network.with_edges(kept))));
    network = network.with_edges(&kept);
    let mut at = 0;
    while at < network.edges.len() {
        let [a, b] = network.edges[at];
        let merged = network.merged(a, b);
        if !merged.edges.is_empty() && merged.edges.len() < network.edges.len() && is_same(&with(&case, &merged)) {
            network = merged;
        } else {
            at += 1;
        }
    }
    for digits in [1, 3] {
        let mut rounded = network.clone();
        let numbers = rounded.points.iter_mut().flatten().chain(&mut rounded.radii);
        numbers.chain(rounded.edge_radii.iter_mut().flatten()).for_each(|x| *x = round(*x, digits));
        if is_same(&with(&case, &rounded)) {
            network = rounded;
            break;
        }
    }
    case.input = Input::Network(network);
    case
}

/// Number with the given digits after its first.
fn round(x: f64, digits: usize) -> f64 {
    format!("{x:.digits$e}").parse().unwrap_or(x)
}

fn smaller_surface(
    mut case: Case,
    mut surface: Surface,
    wrap: fn(Surface) -> Input,
    is_same: &mut dyn FnMut(&Case) -> bool,
) -> Case {
    let with = |case: &Case, surface: &Surface| Case { input: wrap(surface.clone()), ..case.clone() };
    let components = surface.components();
    let mut roots = components.clone();
    roots.sort_unstable();
    roots.dedup();
    let chosen = |kept: &[bool]| -> Vec<bool> {
        components.iter().map(|c| roots.binary_search(c).is_ok_and(|i| kept[i])).collect()
    };
    let kept = fewer(roots.len(), &mut |kept| is_same(&with(&case, &surface.with_triangles(&chosen(kept)))));
    surface = surface.with_triangles(&chosen(&kept));
    // Further changes could make a valid input invalid, so that its refusal is right.
    if case.expect != Expect::Valid {
        let kept = fewer(surface.triangles.len(), &mut |kept| is_same(&with(&case, &surface.with_triangles(kept))));
        surface = surface.with_triangles(&kept);
        surface = collapsed(&case, surface, &with, is_same);
    }
    case.input = wrap(surface);
    case
}

/// Collapses edges.
fn collapsed(
    case: &Case,
    mut surface: Surface,
    with: &dyn Fn(&Case, &Surface) -> Case,
    is_same: &mut dyn FnMut(&Case) -> bool,
) -> Surface {
    let mut at = 0;
    while at < surface.triangles.len() {
        let [a, b, c] = surface.triangles[at];
        let smaller = [[a, b], [b, c], [c, a]].into_iter().map(|[a, b]| surface.collapsed(a, b));
        let found = smaller.into_iter().find(|smaller| !smaller.triangles.is_empty() && is_same(&with(case, smaller)));
        match found {
            Some(smaller) => surface = smaller,
            None => at += 1,
        }
    }
    surface
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::{cuboid, sphere};

    #[test]
    fn a_network_shrinks_to_the_guilty_edge() {
        let mut network = Network::default();
        network.line(40, 1.0, |t| [40.0 * t, 0.123_456_789, 0.0]);
        let guilty = |case: &Case| {
            let Input::Network(network) = &case.input else { return false };
            network.edges.iter().any(|e| e.iter().any(|v| (network.points[*v][0] - 17.0).abs() < 0.5)) && case.has("-x")
        };
        let case = Case::new(Input::Network(network), Expect::Any).with("-x").with("-y 3");
        let small = smallest(case, &mut |case| guilty(case));
        assert_eq!((small.size(), small.options.len()), (1, 1));
        assert!(small.text().contains("0.12 "), "{}", small.text());
    }

    #[test]
    fn a_valid_surface_loses_components_only() {
        let mut surface = cuboid([2.0; 3], [3.0; 3]);
        surface.add(&sphere(4));
        let case = Case::new(Input::Surface(surface), Expect::Valid);
        let small = smallest(case.clone(), &mut |case| case.size() > 12);
        assert_eq!(small.size(), sphere(4).triangles.len());
        let small = smallest(Case { expect: Expect::Any, ..case }, &mut |case| case.size() > 3);
        assert_eq!(small.size(), 4);
    }
}
