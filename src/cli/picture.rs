//! Picture options, and drawing.

use std::io;
use std::path::Path;

use super::edge_values::EdgeValues;
use super::exit::Failure;
use super::network::NetworkArgs;
use super::numbers::above_zero;
use super::values::{ArrayName, ArrayValues};
use crate::picture::{
    Background, Camera, Canvas, Colour, Direction, Image, Legend, MeshPicture, NetworkPicture, Opening, Outline,
    PlaneWish, Shown,
};
use anastomesh_flow::{Datum, VesselData};
use anastomesh_mesh::beside::Beside;
use anastomesh_mesh::geometry::Point3;
use anastomesh_mesh::source::MeshSource;
use anastomesh_skeleton::{NodeId, Skeleton};
use rustc_hash::FxHashSet;

#[derive(Clone, Debug, clap::Args)]
#[command(next_help_heading = "Picture")]
pub struct PictureArgs {
    /// Width and height in pixels
    #[arg(long, value_name = "WxH", default_value = "1200x900", value_parser = size)]
    size: [usize; 2],
    /// View direction: auto (shows the longest two axes), front, back, left, right, top, bottom, or azimuth and elevation
    /// in degrees: 30,20
    #[arg(long, value_name = "FROM", default_value = "auto", value_parser = direction, allow_hyphen_values = true)]
    view: Direction,
    /// Magnification; at 1 the whole object just fits
    #[arg(long, value_name = "FACTOR", default_value_t = 1.0, value_parser = above_zero)]
    zoom: f64,
    /// Point in the centre of the picture
    #[arg(long, value_name = "X,Y,Z", value_parser = place, allow_hyphen_values = true)]
    at: Option<Point3>,
    /// Quantity shown by colours (default: patch for a mesh, radius for a network)
    #[arg(long, value_enum)]
    color: Option<Colour>,
    /// Array of nodes or vessels shown by colours, with the unit of its values: Pressure:Pa
    #[arg(long, value_name = "NAME[:UNIT]", conflicts_with = "color")]
    pub data: Option<ArrayName>,
    /// Background
    #[arg(long, value_enum, default_value_t = BackgroundColour::Light)]
    background: BackgroundColour,
    /// Remove tetrahedra in front of a plane: x, y, z or view; -x, -y, -z remove those behind it. The plane passes through
    /// the centre, or a coordinate or percentage: x:12.5, view:40%
    #[arg(long, value_name = "PLANE", allow_hyphen_values = true)]
    clip: Option<PlaneWish>,
    /// Cut the wall open at a plane
    #[arg(long, value_name = "PLANE", allow_hyphen_values = true, conflicts_with = "clip")]
    cut_away: Option<PlaneWish>,
    /// Samples per pixel and direction for smooth edges (reduced for large pictures)
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = clap::value_parser!(u8).range(1..=4))]
    samples: u8,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum BackgroundColour {
    /// White
    Light,
    /// Dark grey
    Dark,
    /// Transparent
    None,
}

/// Maximum number of pixels.
const MOST_PIXELS: usize = 64_000_000;
/// Maximum number of samples, of 16 bytes each.
const MOST_SAMPLES: usize = 100_000_000;

fn size(text: &str) -> Result<[usize; 2], String> {
    let help = "give width and height in pixels: 1200x900";
    let (width, height) = text.split_once('x').ok_or(help)?;
    let size = [width, height].map(|n| n.parse::<usize>().unwrap_or(0));
    match size {
        [w, h] if w == 0 || h == 0 => Err(help.into()),
        [w, h] if w.saturating_mul(h) > MOST_PIXELS => Err("give at most 64 million pixels".into()),
        size => Ok(size),
    }
}

fn numbers<const N: usize>(text: &str) -> Option<[f64; N]> {
    let found: Option<Vec<f64>> =
        text.split(',').map(|n| n.trim().parse().ok().filter(|x: &f64| x.is_finite())).collect();
    found?.try_into().ok()
}

fn direction(text: &str) -> Result<Direction, String> {
    let [azimuth, elevation] = match text {
        "auto" => return Ok(Direction::Broadside),
        "front" => [0.0, 0.0],
        "right" => [90.0, 0.0],
        "back" => [180.0, 0.0],
        "left" => [-90.0, 0.0],
        "top" => [0.0, 90.0],
        "bottom" => [0.0, -90.0],
        _ => numbers(text).ok_or("give auto, front, back, left, right, top, bottom or two angles: 30,20")?,
    };
    Ok(Direction::by_angles(azimuth, elevation))
}

fn place(text: &str) -> Result<Point3, String> {
    numbers(text).map(|p: [f64; 3]| p.into()).ok_or_else(|| "give three coordinates: 1.5,0,-20".into())
}

/// Reads a network and finds its roots.
pub fn vessels(args: &NetworkArgs) -> Result<(Skeleton, Vec<NodeId>), Failure> {
    let network = args.read()?;
    let inlets: FxHashSet<u32> = network.inlets()?.list.iter().map(|inlet| inlet.original).collect();
    let skeleton = network.skeleton;
    let roots = skeleton.node_ids().filter(|&n| inlets.contains(&skeleton.node(n).original)).collect();
    Ok((skeleton, roots))
}

impl PictureArgs {
    /// Network quantity shown by the colours, if any.
    fn datum(&self) -> Option<Datum> {
        match self.color {
            Some(Colour::Radius) => Some(Datum::Radius),
            Some(Colour::Order) => Some(Datum::Strahler),
            _ => None,
        }
    }

    /// Draws a network, with the values of its array if requested.
    pub fn network(
        &self,
        network: &Skeleton,
        roots: &[NodeId],
        values: Option<&ArrayValues>,
    ) -> Result<(Image, Shown), Failure> {
        if self.clip.is_some() {
            return Err(Failure::usage("--clip needs tetrahedra, which a network does not have; use --cut-away"));
        }
        let picture = match values {
            Some(ArrayValues { values, legend }) => NetworkPicture::by_values(network, values, *legend),
            None => NetworkPicture::new(network, self.color.map_or(Colour::Radius, Colour::from), roots)?,
        };
        let outline = picture.outline();
        let mut canvas = self.canvas(&outline);
        canvas.cut = self.cut_away.map(|wish| wish.plane(&canvas.camera, &outline));
        picture.draw(&mut canvas);
        Ok((canvas.finish(self.background()), picture.shown()))
    }

    /// Draws a mesh, and its network if known, with the values of its array.
    pub fn mesh(
        &self,
        path: &Path,
        mesh: &dyn MeshSource,
        network: Option<(&Skeleton, Option<&ArrayValues>)>,
    ) -> Result<(Image, Shown), Failure> {
        if self.data.is_some() && network.is_none() {
            return Err(Failure::usage("--data needs the network with the array: give --network NETWORK"));
        }
        let failed = |e: io::Error| Failure::input(format!("{}: {e}; run `anastomesh check`", path.display()));
        let vessels: Option<(Box<dyn Beside>, Legend)> = match (self.datum(), network) {
            (_, Some((network, Some(ArrayValues { values, legend })))) => {
                Some((Box::new(EdgeValues::new(network, values.clone())), *legend))
            }
            (Some(datum), Some((network, None))) => {
                let legend = legend(datum, network, mesh)?;
                Some((Box::new(VesselData::new(vec![datum], network, mesh)?), legend))
            }
            (Some(datum), None) => {
                let what = datum.name();
                return Err(Failure::usage(format!("colours by {what} need the network: give --network NETWORK")));
            }
            _ => None,
        };
        let colour = if self.data.is_some() { Colour::Values } else { self.color.unwrap_or(Colour::Patch) };
        let values = vessels.as_ref().map(|(data, legend)| (data.as_ref(), *legend));
        let shown = Shown { colour, legend: values.map(|(_, legend)| legend) };
        let outline = MeshPicture::outline(mesh).map_err(failed)?;
        let mut canvas = self.canvas(&outline);
        let cut = |wish: PlaneWish| wish.plane(&canvas.camera, &outline);
        let cut = self.clip.map(|wish| Opening::Tets(cut(wish))).or(self.cut_away.map(|wish| Opening::Wall(cut(wish))));
        MeshPicture { mesh, colour, values }.draw(&mut canvas, cut).map_err(failed)?;
        Ok((canvas.finish(self.background()), shown))
    }

    fn canvas(&self, outline: &Outline) -> Canvas {
        let fits = (MOST_SAMPLES / (self.size[0] * self.size[1])).isqrt();
        let factor = usize::from(self.samples).min(fits).max(1);
        let camera = Camera::new(self.view, outline, self.size.map(|n| n * factor), self.zoom, self.at);
        Canvas::new(camera, factor)
    }

    fn background(&self) -> Background {
        match self.background {
            BackgroundColour::Light => Background::Light,
            BackgroundColour::Dark => Background::Dark,
            BackgroundColour::None => Background::None,
        }
    }
}

/// Colour scale of a network quantity.
fn legend(datum: Datum, network: &Skeleton, mesh: &dyn MeshSource) -> Result<Legend, Failure> {
    if datum == Datum::Radius {
        return Ok(Legend::of(network.edges.iter().flat_map(|e| e.radii), true));
    }
    let data = VesselData::new(vec![datum], network, mesh)?;
    let middle = |e| {
        let tube = network.tube(e);
        Point3::from((tube.a.coords + tube.b.coords) * 0.5)
    };
    let places: Vec<[Point3; 3]> = network.edge_ids().map(|e| [middle(e); 3]).collect();
    Ok(Legend::of(data.in_faces(0, &places).into_iter(), false))
}

#[cfg(test)]
mod tests {
    use super::*;
    use anastomesh_mesh::geometry::Vec3;

    #[test]
    fn sizes_places_and_directions_are_read() {
        assert_eq!(size("640x480"), Ok([640, 480]));
        for wrong in ["", "640", "0x9", "x", "-1x5", "100000x100000", "99999999999999999999x2"] {
            assert!(size(wrong).is_err(), "{wrong}");
        }
        assert_eq!(place("1, -2,3e2"), Ok(Point3::new(1.0, -2.0, 300.0)));
        assert!(
            place("1,2").is_err() && place("1,2,nan").is_err() && direction("1").is_err() && above_zero("0").is_err()
        );
        let Ok(Direction::From { towards, .. }) = direction("right") else { panic!("a direction") };
        assert!((towards - Vec3::x()).norm() < 1e-12);
    }
}
