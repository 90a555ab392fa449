//! Kinds that draw options at random for moderate input.

use super::complexes::grid;
use super::make::{MakeCase, MakeNetwork};
use super::repeated;
use super::repeated::bifurcation;
use super::surfaces::{boxes, spiky};
use crate::case::{Case, Expect, Input};
use crate::random::Random;

pub const KINDS: [(&str, MakeCase); 5] = [
    ("options of mesh", meshed),
    ("walls and tissue of mesh", walled),
    ("vessels as lines in tissue", embedded),
    ("options of tetrahedralize", filled),
    ("options of tetrahedralize on complexes", filled_complex),
];

/// Options with the values to draw from; a bare name stands for a switch.
type Choices = [(&'static str, &'static [&'static str])];

const MESH: &Choices = &[
    ("--refine", &[]),
    ("--rho", &["2.5", "3", "4", "5"]),
    ("--follow", &["0", "0.5", "1"]),
    ("--stretch", &["1", "3", "20"]),
    ("--core", &["0.5", "2", "4"]),
    ("--size-at", &["0.25", "0.5", "1"]),
    ("--layers", &["1", "2", "5"]),
    ("--layer-growth", &["1", "1.5", "4"]),
    ("--layer-thickness", &["0.01", "0.12", "0.4"]),
    ("--order", &["2"]),
    ("--joint", &["disc", "woven", "none"]),
    ("--frozen-joints", &[]),
    ("--keep-going", &[]),
    ("--data", &["radius", "radius,distance,branch,generation,strahler,node,ratio"]),
    ("--outlets", &["separate", "grouped", "by-order"]),
    ("--extend-outlets", &["1", "5", "20"]),
    ("--extend-inlets", &["2", "10"]),
    ("--float32", &[]),
    ("--compress", &["none"]),
    ("--as-is", &[]),
    ("--keep-joints", &[]),
    ("--keep-points", &[]),
    ("--keep-spurs", &[]),
    ("--keep-short-tips", &[]),
    ("--touching", &["join", "retract", "keep"]),
    ("--smooth-noise", &[]),
    ("--residual", &["report", "shrink", "fuse"]),
    ("--crowded-terminals", &["keep", "part", "merge"]),
    ("--clearance", &["1", "1.2", "2"]),
    ("--max-move", &["0.5", "3", "inf"]),
    ("--max-displacement", &["0.01", "10"]),
    ("--radius-scale", &["0.5", "1.5"]),
    ("--scale", &["0.001", "1000"]),
    ("--memory", &["200MB", "2GiB"]),
    ("-j", &["1", "2", "4"]),
];

const REGIONS: &Choices = &[
    ("--wall", &["0.2r", "0.05", "0.1r+0.01", "1r"]),
    ("--wall-layers", &["1", "3"]),
    ("--wall-growth", &["1", "2"]),
    ("--annulus", &["0.1r", "0.3:2"]),
    ("--shell", &["adventitia=0.1r:2"]),
    ("--tissue", &["box", "hull", "box:3", "hull:2"]),
    ("--tissue-size", &["1", "5"]),
    ("--tissue-growth", &["1.1", "1.3", "2"]),
    ("--without", &["lumen"]),
    ("--layers", &["2"]),
    ("--order", &["2"]),
    ("--refine", &[]),
    ("--rho", &["2.5", "3", "4"]),
    ("--split-regions", &[]),
];

const EMBED: &Choices = &[
    ("--embed-size", &["2r", "1", "0.5r"]),
    ("--tissue", &["box", "hull", "box:5"]),
    ("--tissue-size", &["2", "10"]),
    ("--tissue-growth", &["1.2", "1.5"]),
];

const FILL: &Choices = &[
    ("--no-refine", &[]),
    ("--max-radius-edge", &["1.2", "1.4", "2"]),
    ("--min-dihedral", &["5", "15", "25"]),
    ("--max-volume", &["0.001", "0.1"]),
    ("--size", &["0.1", "0.3", "1"]),
    ("--growth", &["1.1", "1.5", "3"]),
    ("--uniform", &[]),
    ("--split", &[]),
    ("--remesh-surface", &[]),
    ("--layers", &["1", "3"]),
    ("--layer-thickness", &["0.05", "0.3"]),
    ("--order", &["2"]),
    ("--repair", &[]),
    ("--strict", &[]),
    ("--plc", &[]),
    ("-j", &["1", "2", "4"]),
];

/// Options that need others.
const NEEDS: [(&str, &str); 7] = [
    ("--layer-growth", "--layers 2"),
    ("--layer-thickness", "--layers 2"),
    ("--frozen-joints", "--joint woven"),
    ("--wall-layers", "--wall 0.2r"),
    ("--wall-growth", "--wall 0.2r"),
    ("--tissue-size", "--tissue box"),
    ("--tissue-growth", "--tissue box"),
];

/// Adds the options that others need, and a format that holds the results of all.
fn completed(mut case: Case) -> Case {
    for (name, needed) in NEEDS {
        let first = needed.split(' ').next().unwrap_or_default();
        if case.has(name) && !case.has(first) && !case.has("--embed") {
            case = case.with(needed);
        }
    }
    if case.has("--order") || case.has("--data") {
        case.output = "out.vtu";
    }
    case
}

/// Adds 1 to `count` options of a list.
fn drawn(mut case: Case, list: &Choices, count: usize, r: &mut Random) -> Case {
    for _ in 0..=r.below(count) {
        let (name, values) = r.pick(list);
        if !case.has(name) {
            let value = if values.is_empty() { "" } else { r.pick(values) };
            case = case.with(&format!("{name} {value}"));
        }
    }
    case
}

fn network(r: &mut Random) -> Input {
    let easy: [MakeNetwork; 3] = [
        |r| bifurcation(r.between(0.5, 2.0), r.between(0.5, 2.0)),
        |r| (repeated::KINDS[14].1)(r),
        |r| (repeated::KINDS[8].1)(r),
    ];
    Input::Network(r.pick(&easy)(r))
}

/// Options of `mesh` in all formats.
fn meshed(r: &mut Random) -> Case {
    let mut case = drawn(Case::new(network(r), Expect::Any), MESH, 6, r);
    case.output = r.pick(&["out.vtu", "out.vtu", "out.vtu", "out.msh", "out.msh2", "out.ele", "out.mesh", "out.pvtu"]);
    completed(case)
}

/// Regions around a lumen.
fn walled(r: &mut Random) -> Case {
    let case =
        Case::new(network(r), Expect::Any).with(r.pick(&["--wall 0.2r", "--tissue box", "--wall 0.1 --tissue hull"]));
    let mut case = drawn(case, REGIONS, 4, r);
    case.output = r.pick(&["out.vtu", "out.vtu", "out.msh"]);
    completed(case)
}

/// Vessels embedded in tissue.
fn embedded(r: &mut Random) -> Case {
    drawn(Case::new(network(r), Expect::Any).with("--embed"), EMBED, 3, r)
}

/// Options for surfaces.
fn filled(r: &mut Random) -> Case {
    let surface = if r.chance(0.5) { boxes(r) } else { spiky(r) };
    let mut case = drawn(Case::new(Input::Surface(surface), Expect::Any), FILL, 4, r);
    case.output = r.pick(&["out.vtu", "out.vtu", "out.msh", "out.ele", "out.mesh", "out.pvtu"]);
    completed(case)
}

/// Options for complexes with regions.
fn filled_complex(r: &mut Random) -> Case {
    let mut case = drawn(Case::new(Input::Complex(grid(r)), Expect::Any), FILL, 4, r);
    if r.chance(0.3) {
        case = case.with(r.pick(&["--region-size 1=0.1", "--region-growth 2=1.2", "--layers-in 1"]));
    }
    case.output = r.pick(&["out.vtu", "out.vtu", "out.msh", "out.ele"]);
    completed(case)
}
