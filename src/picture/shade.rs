//! Lighting: converts samples to pixels.
//!
//! One lamp is above and to the left of the viewer; ambient sky light is reduced by occlusion.

use super::canvas::{Canvas, Sample};
use super::colours::Background;
use super::image::Image;
use rayon::prelude::*;
use std::f64::consts::TAU;

/// Unit vector to the lamp, in view coordinates.
const LAMP: [f64; 3] = [-0.408_248, 0.408_248, 0.816_497];
const LAMP_LIGHT: f64 = 0.62;
const SKY_LIGHT: f64 = 0.46;
/// Opacity of edges.
const LINE_DARKNESS: f64 = 0.62;
/// Maximum fraction by which distant samples fade into the background.
const FADING: f64 = 0.42;
/// Number of ambient occlusion samples, and their maximum distance as a fraction of the picture.
const LOOKS: usize = 28;
const REACH: f64 = 0.045;
/// Angle between successive occlusion samples: the golden angle avoids equal directions.
const GOLDEN_ANGLE: f64 = 2.399_963_229_728_653;

impl Canvas {
    /// Computes the lighting of the rendered samples.
    pub fn finish(mut self, background: Background) -> Image {
        self.flush();
        let [width, height] = self.camera.size.map(|n| n / self.factor);
        let light = Light::new(&self, background);
        let mut pixels = vec![[0; 4]; width * height];
        pixels.par_chunks_mut(width).enumerate().for_each(|(y, row)| {
            for (x, pixel) in row.iter_mut().enumerate() {
                *pixel = light.pixel(x, y);
            }
        });
        Image { width: width as u32, height: height as u32, pixels }
    }
}

struct Light<'a> {
    canvas: &'a Canvas,
    background: Background,
    /// Depth of the nearest and of the furthest sample.
    depths: [f32; 2],
    /// Linear values of the 256 sRGB levels.
    linear: [f64; 256],
    looks: Vec<[f64; 2]>,
    reach: f64,
}

impl<'a> Light<'a> {
    fn new(canvas: &'a Canvas, background: Background) -> Self {
        let seen = canvas.samples.iter().map(|s| s.depth).filter(|d| d.is_finite());
        let depths = seen.fold([f32::NEG_INFINITY, f32::INFINITY], |[near, far], d| [near.max(d), far.min(d)]);
        let reach = REACH * canvas.camera.size.map(|n| n as f64).into_iter().fold(f64::INFINITY, f64::min);
        let look = |i: usize| {
            let (angle, share) = (i as f64 * GOLDEN_ANGLE, (i as f64 + 0.5) / LOOKS as f64);
            [libm::cos(angle) * share * reach, libm::sin(angle) * share * reach]
        };
        let linear = std::array::from_fn(|i| libm::pow(i as f64 / 255.0, 2.2));
        Self { canvas, background, depths, linear, looks: (0..LOOKS).map(look).collect(), reach }
    }

    fn sample(&self, x: usize, y: usize) -> &Sample {
        &self.canvas.samples[y * self.canvas.camera.size[0] + x]
    }

    /// Mean of a pixel's samples.
    fn pixel(&self, x: usize, y: usize) -> [u8; 4] {
        let n = self.canvas.factor;
        let ground = self.background.colour().map(|c| self.linear[c as usize]);
        let (mut sum, mut covered, mut sky) = ([0.0; 3], 0.0, None);
        for (i, j) in (0..n).flat_map(|j| (0..n).map(move |i| (i, j))) {
            let (x, y) = (n * x + i, n * y + j);
            let sample = self.sample(x, y);
            // Distant samples are translucent, empty ones transparent.
            let (own, share) = if sample.depth.is_finite() {
                // One occlusion test per pixel suffices.
                let sky = *sky.get_or_insert_with(|| self.sky(sample, x, y));
                (self.lit(sample, sky), 1.0 - self.faded(sample))
            } else {
                ([0.0; 3], 0.0)
            };
            covered += share;
            (0..3).for_each(|c| sum[c] += own[c] * share);
        }
        let all = (n * n) as f64;
        if self.background != Background::None {
            (0..3).for_each(|c| sum[c] += ground[c] * (all - covered));
            covered = all;
        }
        let screen = |x: f64| (255.0 * libm::pow((x / covered.max(1e-9)).clamp(0.0, 1.0), 1.0 / 2.2)).round() as u8;
        let [r, g, b] = sum.map(screen);
        [r, g, b, (255.0 * covered / all).round() as u8]
    }

    fn lit(&self, sample: &Sample, sky: f64) -> [f64; 3] {
        let normal = sample.normal.map(|x| f64::from(x) / 32_767.0);
        let lamp = normal.iter().zip(LAMP).map(|(a, b)| a * b).sum::<f64>().max(0.0);
        // More sky light comes from above than from below.
        let above = 0.75 + 0.25 * normal[1];
        let light = LAMP_LIGHT * lamp * (0.55 + 0.45 * sky) + SKY_LIGHT * above * sky;
        let ink = 1.0 - LINE_DARKNESS * f64::from(sample.line) / 255.0;
        sample.colour.map(|c| self.linear[c as usize] * light * ink)
    }

    /// Fraction by which a sample fades into the background.
    fn faded(&self, sample: &Sample) -> f64 {
        let [near, far] = self.depths.map(f64::from);
        let faded = FADING * ((near - f64::from(sample.depth)) / (near - far).max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
        faded * self.deep()
    }

    /// Strength of the depth fading: full for objects as deep as wide, zero for flat ones.
    fn deep(&self) -> f64 {
        let width = self.canvas.camera.size[0] as f64;
        (f64::from(self.depths[0] - self.depths[1]) / width).clamp(0.0, 1.0)
    }

    /// Visible fraction of the sky at a sample, from 0 to 1.
    fn sky(&self, sample: &Sample, x: usize, y: usize) -> f64 {
        let normal = sample.normal.map(|x| f64::from(x) / 32_767.0);
        let [width, height] = self.canvas.camera.size;
        // The sampling pattern rotates between pixels in blocks of four by four, which avoids rings.
        let [column, row] = [x, y].map(|n| (n / self.canvas.factor) & 3);
        let turn = TAU * ((4 * column + row) * 7 % 16) as f64 / 16.0;
        let (sin, cos) = libm::sincos(turn);
        let mut hidden = 0.0;
        for &[u, v] in &self.looks {
            let [u, v] = [u * cos - v * sin, u * sin + v * cos];
            let (column, row) = (x as f64 + u, y as f64 + v);
            if column < 0.0 || row < 0.0 || column >= width as f64 || row >= height as f64 {
                continue;
            }
            let other = self.sample(column as usize, row as usize).depth;
            if !other.is_finite() {
                continue;
            }
            let away = [u, -v, f64::from(other - sample.depth)];
            let length = away.iter().map(|x| x * x).sum::<f64>().sqrt().max(1e-9);
            let over = away.iter().zip(normal).map(|(a, b)| a * b).sum::<f64>() / length;
            hidden += (over - 0.12).max(0.0) / (1.0 + (length / self.reach).powi(2));
        }
        (1.0 - 2.4 * hidden / LOOKS as f64).clamp(0.12, 1.0)
    }
}
