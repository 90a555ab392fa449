//! Midpoints on curved surfaces, pulled back where an element would be distorted.

use super::edges::{Edges, FACE_EDGES};
use super::extend::{Carried, Middles, Planes, extend};
use super::jacobian::{Sign, jacobian_above};
use super::midpoints::SecondOrder;
use super::surface::{self, Flat};
use crate::VolumeMesh;
use crate::geometry::{Point3, Vec3};
use crate::progress::{Progress, ask};
use rayon::prelude::*;
use rustc_hash::FxHashMap;
use std::io;

/// Least Jacobian determinant of a curved element, relative to that of the straight one with the same corners. Elements below it are
/// pulled back. A positive determinant suffices for solvers; the margin keeps their matrices regular.
const LEAST_SCALED: f64 = 0.1;

/// Number of times the offset of an edge is halved before the edge becomes straight.
const HALVINGS: u8 = 4;

/// Maximum number of rounds. Afterwards, all edges become straight.
const ROUNDS: usize = 100;

/// Counts of midpoints, and the distortion of the elements of a mesh.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Curving {
    /// All midpoints.
    pub midpoints: usize,
    /// Midpoints off the middles of their corners: on a smooth surface or near it, or pulled back.
    pub curved: usize,
    /// Midpoints pulled back from their places.
    pub pulled: usize,
    /// Pulled midpoints that are the middles of their corners, and not among `curved`.
    pub straightened: usize,
    /// Lower bound of the Jacobian determinants of all elements, each relative to that of the straight element with the same
    /// corners. 1 for straight elements.
    pub least_scaled: f64,
}

impl SecondOrder {
    /// Midpoints of a mesh. Those of labelled faces lie on a smooth surface through the vertices of the faces; caps and other flat
    /// parts stay flat. Edges near a curved face follow it. Where an element would be distorted, the midpoints of its edges are
    /// pulled back. The result does not depend on the number of threads.
    ///
    /// All tetrahedra must be positive.
    ///
    /// # Panics
    /// If a face is no face of a tetrahedron.
    pub fn curved(volume: &VolumeMesh) -> (Self, Curving) {
        Self::curved_watched(volume, &()).expect("only cancellation fails, and no listener can ask for it")
    }

    /// As [`curved`](Self::curved), with cancellation.
    ///
    /// # Errors
    /// Cancellation.
    ///
    /// # Panics
    /// See [`curved`](Self::curved).
    pub fn curved_watched(volume: &VolumeMesh, progress: &dyn Progress) -> io::Result<(Self, Curving)> {
        let edges = Edges::of_cells(&volume.mesh.tets, &volume.boundary, volume.mesh.points.len());
        ask(progress)?;
        let offsets = surface::offsets(volume, &edges);
        ask(progress)?;
        let second = Self::straight_with(&volume.mesh.points, edges);
        let offsets = inner_offsets(volume, &second, &offsets);
        ask(progress)?;
        curve(volume, second, offsets, progress)
    }
}

/// Offsets of all edges from those of the edges of faces. Edges in flat faces stay in their planes.
fn inner_offsets(volume: &VolumeMesh, second: &SecondOrder, offsets: &[Vec3]) -> Vec<Vec3> {
    let points = &volume.mesh.points;
    let mut given = Vec::new();
    let mut planes: FxHashMap<u32, Planes> = FxHashMap::default();
    for (face, flat) in volume.boundary.iter().zip(Flat::faces(volume, &second.edges, offsets)) {
        for [i, j] in FACE_EDGES {
            let edge = second.listed(face[i], face[j]);
            let offset = offsets[edge as usize];
            if flat.height != 0.0 || offset != Vec3::zeros() {
                let length = (points[face[j] as usize] - points[face[i] as usize]).norm();
                given.push((edge, Carried::on_surface(offset, length)));
            } else {
                planes.entry(edge).or_default().add(flat.normal);
            }
        }
    }
    extend(&Middles::new(second, (points, &volume.mesh.tets), planes), offsets.len(), given.into_iter())
}

/// Places the midpoints of edges at the given offsets from the middles, as far as the elements permit.
fn curve(
    volume: &VolumeMesh,
    second: SecondOrder,
    offsets: Vec<Vec3>,
    progress: &dyn Progress,
) -> io::Result<(SecondOrder, Curving)> {
    let mut state = State {
        volume,
        touched: offsets.iter().map(|offset| *offset != Vec3::zeros()).collect(),
        halvings: vec![0; offsets.len()],
        least: vec![1.0; volume.mesh.tets.len()],
        second,
        offsets,
    };
    state.place();
    for _ in 0..ROUNDS {
        let bad = state.distorted(progress);
        ask(progress)?;
        if bad.is_empty() {
            return Ok(state.finish());
        }
        state.pull(&bad);
    }
    state.straighten();
    Ok(state.finish())
}

/// Midpoints between two rounds.
struct State<'a> {
    volume: &'a VolumeMesh,
    second: SecondOrder,
    /// Present offset of each edge.
    offsets: Vec<Vec3>,
    /// Number of times each offset was halved.
    halvings: Vec<u8>,
    /// Edges whose midpoints were moved last.
    touched: Vec<bool>,
    /// Distortion of each element: its least determinant, relative to that of the straight element.
    least: Vec<f64>,
}

impl State<'_> {
    /// Places the touched midpoints.
    fn place(&mut self) {
        let Self { volume, second, offsets, touched, .. } = self;
        let SecondOrder { edges, middles, .. } = second;
        let all = middles.par_iter_mut().zip(edges.list()).zip(offsets).zip(touched).filter(|(_, touched)| **touched);
        all.for_each(|(((middle, ends), offset), _)| {
            let [a, b] = ends.map(|v| volume.mesh.points[v as usize]);
            *middle = nalgebra::center(&a, &b) + *offset;
        });
    }

    /// Curved edges of distorted elements, ascending. Examines the elements with a touched edge, none after cancellation.
    fn distorted(&mut self, progress: &dyn Progress) -> Vec<u32> {
        let Self { volume, second, offsets, touched, least, .. } = self;
        let examine = |(&tet, least): (&[u32; 4], &mut f64)| -> Vec<u32> {
            let edges = second.edges_of(tet);
            if !edges.iter().any(|&edge| touched[edge as usize]) || progress.is_cancelled() {
                return Vec::new();
            }
            let curved: Vec<u32> = edges.into_iter().filter(|&edge| offsets[edge as usize] != Vec3::zeros()).collect();
            // A straight element is valid if the tetrahedron of its corners is.
            let found = if curved.is_empty() { Some(1.0) } else { scaled(&second.nodes(&volume.mesh.points, tet)) };
            *least = found.unwrap_or(*least);
            if found.is_some() { Vec::new() } else { curved }
        };
        let mut bad: Vec<u32> = volume.mesh.tets.par_iter().zip(least).flat_map_iter(examine).collect();
        bad.par_sort_unstable();
        bad.dedup();
        bad
    }

    /// Halves the offsets of edges, and places their midpoints.
    fn pull(&mut self, edges: &[u32]) {
        self.touched.fill(false);
        for &edge in edges {
            let edge = edge as usize;
            self.halvings[edge] += 1;
            let factor = if self.halvings[edge] > HALVINGS { 0.0 } else { 0.5 };
            self.offsets[edge] *= factor;
            self.touched[edge] = true;
        }
        self.place();
    }

    /// Makes all edges straight, and so all elements valid.
    fn straighten(&mut self) {
        for (offset, halvings) in self.offsets.iter_mut().zip(&mut self.halvings) {
            *halvings += u8::from(*offset != Vec3::zeros());
            *offset = Vec3::zeros();
        }
        self.touched.fill(true);
        self.least.fill(1.0);
        self.place();
    }

    fn finish(self) -> (SecondOrder, Curving) {
        let is_curved = |edge: &usize| self.offsets[*edge] != Vec3::zeros();
        let pulled: Vec<usize> = (0..self.offsets.len()).filter(|&edge| self.halvings[edge] > 0).collect();
        let curving = Curving {
            midpoints: self.offsets.len(),
            curved: (0..self.offsets.len()).filter(is_curved).count(),
            pulled: pulled.len(),
            straightened: pulled.iter().filter(|edge| !is_curved(edge)).count(),
            least_scaled: self.least.iter().copied().fold(1.0, f64::min),
        };
        (self.second, curving)
    }
}

/// Lower bound of the determinant of an element, relative to that of the straight element. `None` if it is not proved to be positive
/// and at least [`LEAST_SCALED`].
fn scaled(nodes: &[Point3; 10]) -> Option<f64> {
    let [a, b, c, d] = [nodes[0], nodes[1], nodes[2], nodes[3]];
    let straight = (b - a).cross(&(c - a)).dot(&(d - a)).max(f64::MIN_POSITIVE);
    match jacobian_above(nodes, LEAST_SCALED * straight) {
        Sign::Above { least } => Some(least / straight),
        Sign::Below | Sign::Undecided => None,
    }
}
