//! What is seen in each sample: the facet nearest to the viewer.

use super::camera::Camera;
use super::colours::Rgb;
use super::plane::Plane;
use anastomesh_mesh::geometry::{Point3, Vec3};
use rayon::prelude::*;

/// A triangle to be drawn.
#[derive(Clone, Copy, Debug)]
pub struct Facet {
    pub corners: [Point3; 3],
    /// Outward, one per corner: where they differ the facet looks curved.
    pub normals: [Vec3; 3],
    /// Seen from outside.
    pub colour: Rgb,
    /// Seen from inside.
    pub inside: Rgb,
    /// Whether its edges are drawn, where they can be told apart.
    pub lined: bool,
}

impl Facet {
    /// A flat one. Triangles without area are never seen.
    pub fn flat(corners: [Point3; 3], colour: Rgb, inside: Rgb) -> Self {
        let normal = (corners[1] - corners[0]).cross(&(corners[2] - corners[0]));
        let normal = normal.try_normalize(0.0).unwrap_or_else(Vec3::zeros);
        Self { corners, normals: [normal; 3], colour, inside, lined: true }
    }
}

/// What is seen in a sample.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sample {
    /// How far towards the viewer, in samples; −∞ where there is nothing.
    pub depth: f32,
    pub colour: Rgb,
    /// How much of it is an edge.
    pub line: u8,
    /// As the viewer sees it, in 32,767ths.
    pub normal: [i16; 3],
}

const NOTHING: Sample = Sample { depth: f32::NEG_INFINITY, colour: [0; 3], line: 0, normal: [0; 3] };

/// Rows that one thread draws at a time.
const BAND: usize = 48;
/// Facets that are drawn at a time.
const BATCH: usize = 1 << 16;
/// Edges appear when facets are so many pixels high, and are fully there at the second.
const LINED: [f64; 2] = [5.0, 14.0];
/// Half the width of an edge, pixels.
const LINE: f64 = 0.6;

/// A picture in the making.
pub struct Canvas {
    pub camera: Camera,
    /// Samples per pixel and direction.
    pub(super) factor: usize,
    /// What is before this plane is not drawn.
    pub cut: Option<Plane>,
    pub(super) samples: Vec<Sample>,
    waiting: Vec<Facet>,
}

/// A facet in samples.
struct Projected {
    corners: [[f64; 3]; 3],
    /// How far behind the cut.
    behind: [f64; 3],
    /// Twice its area.
    area: f64,
    normals: [[f64; 3]; 3],
    colour: Rgb,
    /// Heights over the three edges; infinite where edges are not drawn.
    heights: [f64; 3],
    strength: f64,
}

impl Canvas {
    /// An empty one; the camera counts samples.
    pub fn new(camera: Camera, factor: usize) -> Self {
        let [width, height] = camera.size;
        Self { camera, factor, cut: None, samples: vec![NOTHING; width * height], waiting: Vec::new() }
    }

    /// How many pixels a length is.
    pub fn pixels(&self, length: f64) -> f64 {
        length * self.camera.scale / self.factor as f64
    }

    /// Draws a facet, now or later.
    pub fn add(&mut self, facet: Facet) {
        self.waiting.push(facet);
        if self.waiting.len() >= BATCH {
            self.flush();
        }
    }

    /// Draws what was added.
    pub fn flush(&mut self) {
        let facets: Vec<Projected> = self.waiting.par_iter().filter_map(|facet| self.project(facet)).collect();
        self.waiting.clear();
        let width = self.camera.size[0];
        self.samples.par_chunks_mut(BAND * width).enumerate().for_each(|(band, samples)| {
            let (first, rows) = (band * BAND, samples.len() / width);
            for facet in &facets {
                facet.draw(samples, first, rows, width, self.factor);
            }
        });
    }

    /// None where nothing of it can be seen.
    fn project(&self, facet: &Facet) -> Option<Projected> {
        let corners = facet.corners.map(|p| self.camera.project(&p));
        let [width, height] = self.camera.size.map(|n| n as f64);
        let within = |axis: usize, most: f64| {
            let values = corners.map(|c| c[axis]);
            let (low, high) = (values[0].min(values[1]).min(values[2]), values[0].max(values[1]).max(values[2]));
            // No sample's middle lies between them where they are that close.
            low < most && high > 0.0 && (low - 0.5).ceil() <= (high - 0.5).floor()
        };
        if !corners.iter().flatten().all(|x| x.is_finite()) || !within(0, width) || !within(1, height) {
            return None;
        }
        let behind = self.cut.map_or([1.0; 3], |cut| facet.corners.map(|p| cut.behind(&p)));
        if behind.iter().all(|&b| b < 0.0) {
            return None;
        }
        // Counter-clockwise from outside, and rows are counted downwards.
        let area = -cross(corners[0], corners[1], corners[2]);
        if area == 0.0 {
            return None;
        }
        let turn = if area > 0.0 { 1.0 } else { -1.0 };
        let normals = facet.normals.map(|n| self.camera.turned(&n).map(|x| turn * x));
        let colour = if area > 0.0 { facet.colour } else { facet.inside };
        let (heights, strength) = self.heights(&corners, area, facet.lined);
        Some(Projected { corners, behind, area, normals, colour, heights, strength })
    }

    /// Heights over the edges in pixels, and how clearly edges are drawn.
    fn heights(&self, corners: &[[f64; 3]; 3], area: f64, lined: bool) -> ([f64; 3], f64) {
        let pixels = area.abs().sqrt() / self.factor as f64;
        let strength = ((pixels - LINED[0]) / (LINED[1] - LINED[0])).clamp(0.0, 1.0);
        if !lined || strength <= 0.0 {
            return ([f64::INFINITY; 3], 0.0);
        }
        let length = |a: [f64; 3], b: [f64; 3]| (a[0] - b[0]).hypot(a[1] - b[1]).max(1e-9);
        let [a, b, c] = *corners;
        let over = |length: f64| area.abs() / length / self.factor as f64;
        ([over(length(b, c)), over(length(c, a)), over(length(a, b))], strength)
    }
}

/// Twice the signed area of a triangle.
#[inline]
fn cross(a: [f64; 3], b: [f64; 3], c: [f64; 3]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

impl Projected {
    /// Draws what lies in some rows.
    fn draw(&self, samples: &mut [Sample], first: usize, rows: usize, width: usize, factor: usize) {
        let [a, b, c] = self.corners;
        let range = |axis: usize, from: usize, count: usize| {
            let (low, high) = (a[axis].min(b[axis]).min(c[axis]), a[axis].max(b[axis]).max(c[axis]));
            let (low, high) =
                ((low - 0.5).ceil().max(from as f64), (high - 0.5).floor().min((from + count) as f64 - 1.0));
            if low <= high { low as usize..high as usize + 1 } else { 0..0 }
        };
        let (lines, columns) = (range(1, first, rows), range(0, 0, width));
        let over = -1.0 / self.area;
        for y in lines {
            let row = (y - first) * width;
            for x in columns.clone() {
                let p = [x as f64 + 0.5, y as f64 + 0.5, 0.0];
                let weights = [cross(b, c, p) * over, cross(c, a, p) * over, cross(a, b, p) * over];
                if weights.iter().any(|&w| w < 0.0) || weigh(weights, self.behind) < 0.0 {
                    continue;
                }
                let depth = weigh(weights, self.corners.map(|c| c[2])) as f32;
                let sample = &mut samples[row + x];
                if depth > sample.depth {
                    *sample = self.sample(depth, weights, factor);
                }
            }
        }
    }

    fn sample(&self, depth: f32, weights: [f64; 3], factor: usize) -> Sample {
        let normal = [0, 1, 2].map(|i| weigh(weights, self.normals.map(|n| n[i])));
        let length = normal.iter().map(|x| x * x).sum::<f64>().sqrt().max(1e-12);
        let edge = weights.iter().zip(self.heights).map(|(w, h)| w * h).fold(f64::INFINITY, f64::min);
        // Fades out over a sample.
        let soft = 0.5 / factor as f64;
        let line = self.strength * ((LINE + soft - edge) / (2.0 * soft)).clamp(0.0, 1.0);
        Sample {
            depth,
            colour: self.colour,
            line: (255.0 * line) as u8,
            normal: normal.map(|x| (32_767.0 * x / length) as i16),
        }
    }
}

#[inline]
fn weigh(weights: [f64; 3], values: [f64; 3]) -> f64 {
    weights[0] * values[0] + weights[1] * values[1] + weights[2] * values[2]
}
