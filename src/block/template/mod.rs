//! Template meshes for tubes between two discs.
//!
//! With edges proportional to the radius, all discs of one ρ have equal corner counts. A vessel between two discs is
//! then the image of a straight tube of radius 1. The map takes the axial position in radii, and the position in the
//! disc, to the vessel. No filling is needed; longer vessels use several images in sequence. The disc at the second end may
//! be rotated. The last template then has its second disc rotated by a whole number of corners, and the map turns by the
//! rest. If taper, bend or twist spoil a tetrahedron, the tube is meshed individually.

mod canonical;
mod filled;
mod joined;
#[cfg(test)]
mod tests;
mod wafer;

use super::params::BlockParams;
use super::path::AxisPath;
use super::topology::Topology;
use crate::surface::SharedDisc;
use anastomesh_mesh::TetMesh;
use anastomesh_mesh::geometry::{Point3, Section};
use anastomesh_mesh::quality::{all_have_ratio, has_ratio};
use canonical::Template;
use joined::joined;
use std::f64::consts::TAU;
use std::sync::Arc;

pub use filled::FilledTube;

/// Maximum template length, in radii. Inner discs are flat, and their neighbours slightly worse than others.
const LONGEST: f64 = 12.0;
/// Minimum template length, in radii. A shorter vessel between two caps has one layer of tetrahedra.
const SHORTEST: f64 = 0.5;
/// Maximum twist of the map, in radians per radius of length.
const TWIST: f64 = 0.15;
/// Length of the last template of a tube with a rotated second disc, in radii. One template per rotation serves all lengths.
const LAST: f64 = 2.0;
/// Maximum length of such a tube that is the image of one template.
const SHORT: f64 = 4.0;
/// Core factor for axis edges as long as those of the wall.
const PLAIN: f64 = 1.0;
/// Minimum radius ratio of an image's tetrahedra.
const LEAST: f64 = 0.3;

/// Tube along a path between the discs of its end sections; `caps` marks discs that are caps. Returns `None` if no
/// template fits. Depends on ρ, stretch, core and layers of the parameters.
pub fn tube(path: &[Section], discs: &[SharedDisc; 2], caps: [bool; 2], params: &BlockParams) -> Option<FilledTube> {
    let corners = discs[0].rim.len();
    if discs[1].rim.len() != corners || discs[0].points.len() != discs[1].points.len() {
        return None;
    }
    let path = AxisPath::new(path)?;
    let (radii, twist) = (path.radii(), path.twist());
    let corner = TAU / corners as f64;
    let rotation = (twist / corner).round();
    let twist = twist - rotation * corner;
    let length = radii[radii.len() - 1];
    if length < SHORTEST && caps == [true; 2] && rotation == 0.0 && params.layers.is_none() {
        return wafer::wafer(discs);
    }
    if !(length.is_finite() && length >= SHORTEST && twist.abs() <= TWIST * length) {
        return None;
    }
    // The stretch of a short tube is limited to leave one radius of template.
    let stretch = params.stretch.min(length).max(1.0);
    let lengths = lengths(length / stretch, rotation != 0.0);
    if lengths.len() > 1 && caps != [false; 2] {
        return None;
    }
    let rotation = rotation.rem_euclid(corners as f64) as u32;
    let [first, last] = [lengths[0], lengths[lengths.len() - 1]];
    let starts: Vec<f64> = (0..=lengths.len()).map(|i| lengths[..i].iter().sum::<f64>() * stretch / length).collect();
    let (path, discs, radii, starts) = (&path, discs, &radii[..], &starts[..]);
    let image =
        |templates: [&Template; 2]| TemplateImage { templates, path, discs, radii, twist, stretch, starts }.tube();
    let of_core = |core: f64| {
        let params = BlockParams { core, ..*params };
        let with = |length, rotation| canonical::template(&params, [corners as u32, rotation], length, caps);
        let last = with(last, rotation)?;
        let first = if lengths.len() > 1 { with(first, 0)? } else { Arc::clone(&last) };
        image([&first, &last])
    };
    // If longer axis edges spoil a tetrahedron, uniform edges may work.
    of_core(params.core).or_else(|| if params.core == PLAIN { None } else { of_core(PLAIN) })
}

/// Lengths of the templates in a tube, in radii.
fn lengths(length: f64, is_rotated: bool) -> Vec<f64> {
    let last = if is_rotated && length > SHORT { LAST } else { 0.0 };
    let count = ((length - last) / LONGEST).ceil().max(1.0);
    let mut lengths = vec![(length - last) / count; count as usize];
    lengths.extend((last > 0.0).then_some(last));
    lengths
}

/// Templates and the vessel that is their image.
struct TemplateImage<'a> {
    /// Template of all pieces but the last, and of the last.
    templates: [&'a Template; 2],
    path: &'a AxisPath,
    discs: &'a [SharedDisc; 2],
    /// Length of the path in radii, up to each of its stations.
    radii: &'a [f64],
    twist: f64,
    stretch: f64,
    /// Start of each piece, and the end of the last, as shares of the length in radii.
    starts: &'a [f64],
}

impl TemplateImage<'_> {
    fn tube(&self) -> Option<FilledTube> {
        let [first, last] = self.templates;
        let pieces = self.starts.len() as u32 - 1;
        let numbers = |list: &[[u32; 3]], piece: u32| -> Vec<[u32; 3]> {
            list.iter().map(|t| t.map(|v| self.number(piece, v))).collect()
        };
        let tets = |piece: u32| self.template(piece).tets.iter().map(move |t| t.map(|v| self.number(piece, v)));
        // A single piece has the numbers of its template.
        let tets = if pieces == 1 { first.tets.clone() } else { (0..pieces).flat_map(tets).collect() };
        let mesh = TetMesh { points: self.points(), tets };
        self.is_good(&mesh).then(|| FilledTube {
            disc: first.disc,
            ends: [numbers(&first.ends[0], 0), numbers(&last.ends[1], pieces - 1)],
            wall: (0..pieces).flat_map(|piece| numbers(&self.template(piece).wall, piece)).collect(),
            rings: (0..pieces).map(|piece| self.template(piece).rings + 1).sum::<u32>() - 1,
            topology: self.topology(),
            mesh,
        })
    }

    fn topology(&self) -> Arc<Topology> {
        let pieces = self.starts.len() as u32 - 1;
        if pieces == 1 {
            return Arc::clone(&self.templates[0].topology);
        }
        Arc::new(joined((0..pieces).map(|piece| self.template(piece))))
    }

    fn template(&self, piece: u32) -> &Template {
        self.templates[usize::from(self.is_last(piece))]
    }

    fn is_last(&self, piece: u32) -> bool {
        piece as usize + 2 == self.starts.len()
    }

    /// Number of a template point in a piece of the tube. The two end discs come first. For each piece follow its inner
    /// points, and the disc at its end unless it is the last.
    fn number(&self, piece: u32, v: u32) -> u32 {
        let Template { disc, points, .. } = self.templates[0];
        let alone = points.len() as u32 - 2 * disc;
        let begin = |piece: u32| 2 * disc + piece * (alone + disc);
        match v {
            _ if v >= 2 * disc => begin(piece) + v - 2 * disc,
            _ if v >= *disc && self.is_last(piece) => v,
            _ if v >= *disc => begin(piece) + alone + v - disc,
            _ if piece == 0 => v,
            _ => begin(piece - 1) + alone + v,
        }
    }

    fn points(&self) -> Vec<Point3> {
        let mut out: Vec<Point3> = self.discs.iter().flat_map(|d| d.points.iter().copied()).collect();
        for piece in 0..self.starts.len() as u32 - 1 {
            let Template { disc, points, .. } = self.template(piece);
            let (discs, alone) = points.split_at(2 * *disc as usize);
            out.extend(alone.iter().map(|p| self.map(piece, p)));
            if !self.is_last(piece) {
                out.extend(discs[*disc as usize..].iter().map(|p| self.map(piece, p)));
            }
        }
        out
    }

    /// Maps a template point to a piece of the tube.
    fn map(&self, piece: u32, p: &Point3) -> Point3 {
        let [start, end] = [0, 1].map(|i| self.starts[piece as usize + i]);
        let share = start + (end - start) * p.z;
        let place = self.path.at(self.path.arc_of(self.radii, share * self.radii[self.radii.len() - 1]));
        let (x, y) = if self.twist == 0.0 {
            (p.x, p.y)
        } else {
            let (sine, cosine) = libm::sincos(self.twist * share);
            (cosine * p.x - sine * p.y, sine * p.x + cosine * p.y)
        };
        place.origin + (place.u * x + place.w * y) * place.radius
    }

    /// True if no tetrahedron is much worse than in the template, after undoing the stretch along the axis.
    fn is_good(&self, mesh: &TetMesh) -> bool {
        let has_layers = self.templates.iter().any(|template| template.layers > 0);
        if self.stretch == 1.0 && !has_layers {
            return all_have_ratio(mesh, LEAST, |_| false);
        }
        let shrunk = |p: &[Point3; 4]| -> [Point3; 4] {
            let path = (p[0] - self.path.at(0.0).origin).norm();
            let axis = self.path.at(path.min(self.path.length())).axis;
            p.map(|q| q - axis * ((q - p[0]).dot(&axis) * (1.0 - 1.0 / self.stretch)))
        };
        let pieces = (0..self.starts.len() as u32 - 1).map(|piece| self.template(piece));
        let bounds = pieces.flat_map(|Template { tets, layers, least, .. }| {
            (0..tets.len()).map(move |i| if i < *layers { LEAST * least } else { LEAST })
        });
        mesh.tets.iter().zip(bounds).all(|(t, bound)| {
            let corners = t.map(|v| mesh.points[v as usize]);
            let corners = if self.stretch > 1.0 { shrunk(&corners) } else { corners };
            has_ratio(corners.each_ref(), bound)
        })
    }
}
