//! Search for nested boundary surfaces of the whole, by a ray from a point of each.

use super::boxes::Boxes;
use super::glue::{Glued, invalid};
use super::walls::{Reader, Wall};
use crate::check::nested::is_within;
use crate::check::result::{Offender, OffenderKind};
use crate::geometry::DisjointSets;
use crate::geometry::{Aabb, Bvh, Point3, crossing};
use rayon::prelude::*;
use std::io;

/// Returns a vertex of each surface inside the mesh. Walls must be closed and must not intersect.
pub(super) fn within(reader: Reader, glued: &Glued, parts: &Boxes) -> io::Result<Vec<Offender>> {
    let boxes = boxes(&reader, glued, parts);
    let surfaces: Vec<Aabb> = glued.surfaces().map(|root| boxes[root as usize]).collect();
    let outer = Bvh::new(&surfaces);
    let test = |(i, root): (u32, u32)| -> io::Result<Option<Offender>> {
        let (vertex, p) = vertex_of(&reader, root)?;
        let here = Aabb { min: p, max: p };
        let mut others = 0;
        outer.query(&here, |other| others += u32::from(other != i));
        if others == 0 || !is_within(winding(&reader, glued, parts.tree(), root, &p)?, glued.enclosed(root)) {
            return Ok(None);
        }
        Ok(Some(Offender::new(OffenderKind::Point, &[vertex], Some(p))))
    };
    let roots: Vec<(u32, u32)> = (0..).zip(glued.surfaces()).collect();
    let found: Vec<Option<Offender>> = roots.into_par_iter().map(test).collect::<io::Result<_>>()?;
    Ok(found.into_iter().flatten().collect())
}

/// Bounding boxes of the whole's surfaces, by their roots.
fn boxes(reader: &Reader, glued: &Glued, parts: &Boxes) -> Vec<Aabb> {
    let mut boxes = vec![Aabb::EMPTY; glued.roots_len()];
    for part in 0..reader.held.count() {
        for surface in reader.held.surfaces_of(part) {
            let of = &mut boxes[glued.root(surface) as usize];
            *of = of.union(parts.of(part));
        }
    }
    boxes
}

/// A vertex of a surface: its id and its point.
fn vertex_of(reader: &Reader, surface: u32) -> io::Result<(u32, Point3)> {
    let part = reader.held.part_of_surface(surface);
    let id = reader.parts.vertex(part, reader.held.surface(surface).vertex);
    let wall = reader.wall(part)?;
    let place = wall.ids.iter().position(|&v| v == id).and_then(|i| wall.points.get(i));
    let p = place.ok_or_else(|| invalid(format!("the wall of part {part} has no vertex {id}")))?;
    Ok((id, *p))
}

/// Winding number of all other surfaces around a point of a surface.
fn winding(reader: &Reader, glued: &Glued, tree: &Bvh, own: u32, p: &Point3) -> io::Result<i64> {
    let mut parts = Vec::new();
    tree.query(&Aabb { min: *p, max: Point3::new(f64::INFINITY, p.y, p.z) }, |part| parts.push(part));
    parts.sort_unstable();
    let mut sum = 0;
    for part in parts {
        let surfaces = reader.held.surfaces_of(part);
        if surfaces.clone().all(|surface| glued.root(surface) == own) {
            continue;
        }
        let wall = reader.wall(part)?;
        let of = surfaces_of_points(reader, part, &wall);
        for face in &wall.faces {
            if of[face[0] as usize].is_none_or(|surface| glued.root(surface) != own) {
                let corners = face.map(|v| &wall.points[v as usize]);
                sum += i64::from(crossing(p, corners).unwrap_or_default());
            }
        }
    }
    Ok(sum)
}

/// Surface of each point of a wall. The rest of a surface without its joints is connected.
fn surfaces_of_points(reader: &Reader, part: u32, wall: &Wall) -> Vec<Option<u32>> {
    let surfaces = reader.held.surfaces_of(part);
    if surfaces.len() == 1 {
        return vec![Some(surfaces.start); wall.points.len()];
    }
    let mut sets = DisjointSets::new(wall.points.len());
    for &[a, b, c] in &wall.faces {
        sets.join(a, b);
        sets.join(b, c);
    }
    let mut surface_of = vec![None; wall.points.len()];
    for surface in surfaces {
        let id = reader.parts.vertex(part, reader.held.surface(surface).vertex);
        if let Some(i) = wall.ids.iter().position(|&v| v == id) {
            surface_of[sets.root(i as u32) as usize] = Some(surface);
        }
    }
    (0..wall.points.len() as u32).map(|i| surface_of[sets.root(i) as usize]).collect()
}
