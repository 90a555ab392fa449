//! Depth buffer: each sample keeps the facet nearest to the viewer.

use super::camera::Camera;
use super::colours::Rgb;
use super::plane::Plane;
use anastomesh_mesh::geometry::{Point3, Vec3};
use rayon::prelude::*;

/// Triangle to render.
#[derive(Clone, Copy, Debug)]
pub struct Facet {
    pub corners: [Point3; 3],
    /// Outward normal at each corner; different normals make the facet look curved.
    pub normals: [Vec3; 3],
    /// Colour of the outside.
    pub colour: Rgb,
    /// Colour of the inside.
    pub inside: Rgb,
    /// True if edges are drawn where they are large enough.
    pub lined: bool,
}

impl Facet {
    /// Creates a flat facet. Triangles without area are invisible.
    pub fn flat(corners: [Point3; 3], colour: Rgb, inside: Rgb) -> Self {
        let normal = (corners[1] - corners[0]).cross(&(corners[2] - corners[0]));
        let normal = normal.try_normalize(0.0).unwrap_or_else(Vec3::zeros);
        Self { corners, normals: [normal; 3], colour, inside, lined: true }
    }
}

/// Visible state of a sample.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sample {
    /// Depth towards the viewer, in samples; −∞ if empty.
    pub depth: f32,
    pub colour: Rgb,
    /// Edge coverage.
    pub line: u8,
    /// Normal in view coordinates, in 1/32,767.
    pub normal: [i16; 3],
}

const NOTHING: Sample = Sample { depth: f32::NEG_INFINITY, colour: [0; 3], line: 0, normal: [0; 3] };

/// Rows per parallel task.
const BAND: usize = 48;
/// Facets per batch.
const BATCH: usize = 1 << 16;
/// Facet sizes at which edges begin to appear and are fully visible, in pixels.
const LINED: [f64; 2] = [5.0, 14.0];
/// Half the line width of an edge, in pixels.
const LINE: f64 = 0.6;

/// Picture during rendering.
pub struct Canvas {
    pub camera: Camera,
    /// Samples per pixel in each direction.
    pub(super) factor: usize,
    /// Clipping plane: everything before it is hidden.
    pub cut: Option<Plane>,
    pub(super) samples: Vec<Sample>,
    waiting: Vec<Facet>,
}

/// Facet in sample coordinates.
struct Projected {
    corners: [[f64; 3]; 3],
    /// Distances behind the clipping plane.
    behind: [f64; 3],
    /// Twice the signed area.
    area: f64,
    normals: [[f64; 3]; 3],
    colour: Rgb,
    /// Heights over the three edges; infinite if edges are hidden.
    heights: [f64; 3],
    strength: f64,
}

impl Canvas {
    /// Creates an empty canvas; the camera size is in samples.
    pub fn new(camera: Camera, factor: usize) -> Self {
        let [width, height] = camera.size;
        Self { camera, factor, cut: None, samples: vec![NOTHING; width * height], waiting: Vec::new() }
    }

    /// Length in pixels.
    pub fn pixels(&self, length: f64) -> f64 {
        length * self.camera.scale / self.factor as f64
    }

    /// Queues a facet for rendering.
    pub fn add(&mut self, facet: Facet) {
        self.waiting.push(facet);
        if self.waiting.len() >= BATCH {
            self.flush();
        }
    }

    /// Renders all queued facets.
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

    /// Projects a facet; returns `None` if it is invisible.
    fn project(&self, facet: &Facet) -> Option<Projected> {
        let corners = facet.corners.map(|p| self.camera.project(&p));
        let [width, height] = self.camera.size.map(|n| n as f64);
        let within = |axis: usize, most: f64| {
            let values = corners.map(|c| c[axis]);
            let (low, high) = (values[0].min(values[1]).min(values[2]), values[0].max(values[1]).max(values[2]));
            // Such close bounds contain no sample centre.
            low < most && high > 0.0 && (low - 0.5).ceil() <= (high - 0.5).floor()
        };
        if !corners.iter().flatten().all(|x| x.is_finite()) || !within(0, width) || !within(1, height) {
            return None;
        }
        let behind = self.cut.map_or([1.0; 3], |cut| facet.corners.map(|p| cut.behind(&p)));
        if behind.iter().all(|&b| b < 0.0) {
            return None;
        }
        // Facets are counter-clockwise from outside, and rows are counted downwards.
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

    /// Heights over the edges in pixels, and the opacity of edges.
    fn heights(&self, corners: &[[f64; 3]; 3], area: f64, lined: bool) -> ([f64; 3], f64) {
        let pixels = area.abs().sqrt() / self.factor as f64;
        let strength = ((pixels - LINED[0]) / (LINED[1] - LINED[0])).clamp(0.0, 1.0);
        if !lined || strength <= 0.0 {
            return ([f64::INFINITY; 3], 0.0);
        }
        let length = |a: [f64; 3], b: [f64; 3]| libm::hypot(a[0] - b[0], a[1] - b[1]).max(1e-9);
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
    /// Renders the part within a band of rows.
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
        // The line fades out over one sample.
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
