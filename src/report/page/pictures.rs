//! Pictures for a page, with a transparent background for light and dark themes.

use crate::picture::{
    Background, Camera, Canvas, Colour, Direction, Image, MeshPicture, NetworkPicture, Opening, Plane,
};
use anastomesh_mesh::check::{CheckReport, Offender, OffenderKind};
use anastomesh_mesh::geometry::Point3;
use anastomesh_mesh::source::MeshSource;
use anastomesh_skeleton::{EdgeId, Skeleton};
use std::io;

use super::places::extents;

const SIZE: [usize; 2] = [720, 540];
const SAMPLES: usize = 2;
/// Minimum zoom for close-ups of tetrahedra.
const CLOSER: f64 = 3.0;
/// Maximum number of pictured offenders, and number of candidates: one of several neighbours is enough.
const SHOWN: usize = 6;
const CANDIDATES: usize = 24;
/// Minimum distance between pictured offenders, as a fraction of the picture.
const BESIDE: f64 = 0.5;

/// Pictures of a mesh: the whole, its blocks if there are several, and some tetrahedra.
///
/// # Errors
/// The mesh cannot be read.
pub fn mesh_pictures(mesh: &dyn MeshSource) -> io::Result<Vec<(Image, String)>> {
    let outline = MeshPicture::outline(mesh)?;
    let size = SIZE.map(|n| n * SAMPLES);
    let camera = Camera::new(Direction::Broadside, &outline, size, 1.0, None);
    let mut pictures =
        vec![(draw(mesh, camera, Colour::Patch, None)?, "The mesh: wall red, inlets blue, outlets yellow.".to_owned())];
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
    let cut = Plane { normal: close.towards, offset: place.coords.dot(&close.towards) - 0.15 * extent };
    pictures.push((
        draw(mesh, close, Colour::Quality, Some(Opening::Tets(cut)))?,
        "Some of its tetrahedra by their radius ratio, from red (0) to blue (1).".to_owned(),
    ));
    Ok(pictures)
}

/// Picture of a network with some edges highlighted.
pub fn network_picture(network: &Skeleton, marked: &[EdgeId], caption: &str) -> (Image, String) {
    let mut picture = NetworkPicture::by_radius(network);
    picture.mark(marked);
    let camera = Camera::new(Direction::Broadside, &picture.outline(), SIZE.map(|n| n * SAMPLES), 1.0, None);
    let mut canvas = Canvas::new(camera, SAMPLES);
    picture.draw(&mut canvas);
    (canvas.finish(Background::None), caption.to_owned())
}

/// Pictures of the first offenders of failed lines.
///
/// # Errors
/// The mesh cannot be read.
pub fn offenders(check: &CheckReport, mesh: &dyn MeshSource) -> io::Result<Vec<(Image, String)>> {
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
        let [x, y, z]: [f64; 3] = place.into();
        pictures.push((image, format!("Failed: {statement} (circled, at {x:.6} {y:.6} {z:.6})")));
    }
    Ok(pictures)
}

fn draw(mesh: &dyn MeshSource, camera: Camera, colour: Colour, cut: Option<Opening>) -> io::Result<Image> {
    let mut canvas = Canvas::new(camera, SAMPLES);
    MeshPicture { mesh, colour, values: None }.draw(&mut canvas, cut)?;
    Ok(canvas.finish(Background::None))
}
