//! Pictures for a page, with a transparent background for light and dark themes.

use crate::picture::{
    Background, Camera, Canvas, Colour, Direction, Image, MeshPicture, NetworkPicture, Opening, Plane,
};
use anastomesh_mesh::check::text::describe;
use anastomesh_mesh::check::{CheckReport, Offender, OffenderKind};
use anastomesh_mesh::geometry::Point3;
use anastomesh_mesh::source::MeshSource;
use anastomesh_skeleton::{EdgeId, Skeleton};
use std::io;

use super::figures::LengthUnit;
use super::legend::Legend;
use super::places::extents;

const SIZE: [usize; 2] = [720, 540];
const SAMPLES: usize = 2;
/// Minimum zoom for close-ups of tetrahedra.
const CLOSER: f64 = 3.0;
/// Depths of the plane of a close-up below a point of the wall, as fractions of the picture.
const CLOSE_UP_DEPTHS: [f64; 3] = [0.15, 0.05, 0.0];
/// Maximum number of pictured offenders, and number of candidates: one of several neighbours is enough.
const SHOWN: usize = 6;
const CANDIDATES: usize = 24;
/// Minimum distance between pictured offenders, as a fraction of the picture.
const BESIDE: f64 = 0.5;

/// Picture with its caption and legend.
#[derive(Debug)]
pub struct Picture {
    pub image: Image,
    pub caption: String,
    pub legend: Option<Legend>,
}

/// Pictures of a mesh: the whole, its blocks if there are several, and some tetrahedra.
///
/// # Errors
/// The mesh cannot be read.
pub fn mesh_pictures(mesh: &dyn MeshSource) -> io::Result<Vec<Picture>> {
    let outline = MeshPicture::outline(mesh)?;
    let size = SIZE.map(|n| n * SAMPLES);
    let camera = Camera::new(Direction::Broadside, &outline, size, 1.0, None);
    let image = draw(mesh, camera, Colour::Patch, None)?;
    // Other patches than those of a network have colours by number.
    let has_kinds = mesh.patches().iter().any(|patch| patch.is_inlet() || patch.is_outlet());
    let mut pictures =
        vec![Picture { image, caption: "Mesh by boundary patch".into(), legend: has_kinds.then(Legend::patches) }];
    if mesh.counts().tets == 0 {
        return Ok(pictures);
    }
    // A point of the object itself, as the centre of its box may be far away.
    let middle = camera.centre;
    let near = |a: &&Point3, b: &&Point3| (*a - middle).norm_squared().total_cmp(&(*b - middle).norm_squared());
    let Some(&place) = outline.points().iter().min_by(near) else { return Ok(pictures) };
    let extent = extents(mesh, &[place])?[0];
    let zoom = (outline.range(camera.towards)[1] - outline.range(camera.towards)[0]).max(extent) / extent;
    let close = Camera::new(Direction::Broadside, &outline, size, zoom.max(CLOSER), Some(place));
    // Behind the point at the wall, unless the vessel is thinner than that.
    let mut image = None;
    for depth in CLOSE_UP_DEPTHS {
        let cut = Plane { normal: close.towards, offset: place.coords.dot(&close.towards) - depth * extent };
        let drawn = draw(mesh, close, Colour::Quality, Some(Opening::Tets(cut)))?;
        let is_empty = drawn.pixels.iter().all(|pixel| pixel[3] == 0);
        image = Some(drawn);
        if !is_empty {
            break;
        }
    }
    let Some(image) = image else { return Ok(pictures) };
    pictures.push(Picture {
        image,
        caption: "Close-up of tetrahedra by radius ratio".into(),
        legend: Some(Legend::quality()),
    });
    Ok(pictures)
}

/// Picture of a network with some edges highlighted.
pub fn network_picture(network: &Skeleton, marked: &[EdgeId], caption: &str, unit: LengthUnit) -> Picture {
    let mut picture = NetworkPicture::by_radius(network);
    picture.mark(marked);
    let camera = Camera::new(Direction::Broadside, &picture.outline(), SIZE.map(|n| n * SAMPLES), 1.0, None);
    let mut canvas = Canvas::new(camera, SAMPLES);
    picture.draw(&mut canvas);
    let legend = picture.shown().legend.as_ref().map(|scale| Legend::radius(scale, unit));
    Picture { image: canvas.finish(Background::None), caption: caption.into(), legend }
}

/// Pictures of the first offenders of failed lines.
///
/// # Errors
/// The mesh cannot be read.
pub fn offenders(check: &CheckReport, mesh: &dyn MeshSource) -> io::Result<Vec<Picture>> {
    // The first of each line comes before the second of any.
    let mut found: Vec<(usize, &Offender, &'static str, Point3)> = Vec::new();
    for line in check.failed() {
        let placed = line.offenders.iter().filter_map(|o| Some((o, Point3::from(o.position?))));
        found.extend(placed.enumerate().map(|(i, (offender, place))| (i, offender, line.line.statement(), place)));
    }
    found.sort_by_key(|(i, ..)| *i);
    found.truncate(CANDIDATES);
    if found.is_empty() || mesh.counts().boundary == 0 {
        return Ok(Vec::new());
    }
    let outline = MeshPicture::outline(mesh)?;
    let extents = extents(mesh, &found.iter().map(|(.., place)| *place).collect::<Vec<_>>())?;
    let mut pictures = Vec::new();
    let mut shown: Vec<Point3> = Vec::new();
    for ((_, offender, statement, place), extent) in found.into_iter().zip(extents) {
        if shown.len() == SHOWN || shown.iter().any(|other| (other - place).norm() < BESIDE * extent) {
            continue;
        }
        shown.push(place);
        let mut camera = Camera::new(Direction::Broadside, &outline, SIZE.map(|n| n * SAMPLES), 1.0, Some(place));
        camera.scale = (camera.size[1] as f64 / (2.0 * extent)).max(camera.scale);
        let at = place.coords.dot(&camera.towards);
        let cut = match offender.kind {
            OffenderKind::Tet | OffenderKind::TetPair => Opening::Tets(Plane { normal: camera.towards, offset: at }),
            // Everything in front of it is clipped.
            _ => Opening::Wall(Plane { normal: camera.towards, offset: at + 0.4 * extent }),
        };
        let image = draw(mesh, camera, Colour::Patch, Some(cut))?;
        let caption = format!("Failed: {statement}: {} (circled)", describe(offender));
        pictures.push(Picture { image, caption, legend: None });
    }
    Ok(pictures)
}

fn draw(mesh: &dyn MeshSource, camera: Camera, colour: Colour, cut: Option<Opening>) -> io::Result<Image> {
    let mut canvas = Canvas::new(camera, SAMPLES);
    MeshPicture { mesh, colour, values: None }.draw(&mut canvas, cut)?;
    Ok(canvas.finish(Background::None))
}
