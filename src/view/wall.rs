//! Wall of a mesh by blocks and patches, at full or reduced resolution.

use super::collapse::Collapse;
use super::rings::{rings, thinned};
use super::tube::straight;
use anastomesh_mesh::beside::Beside;
use anastomesh_mesh::geometry::{Aabb, Point3, Vec3};
use anastomesh_mesh::quality::triangle_ratio;
use anastomesh_mesh::source::{FacePiece, MeshSource};
use rayon::prelude::*;
use rustc_hash::FxHashMap;
use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::io;

/// Maximum number of faces shown at full resolution.
const AS_IT_IS: usize = 400_000;
/// Approximate number of faces of a reduced wall, unless vessels would get too few sides for their size on the screen.
const SHOWN: f64 = 900_000.0;
/// Assumed screen width, in pixels. The number of sides of a vessel depends on its radius on the screen.
const SCREEN: f64 = 1500.0;
/// Fraction of shown faces below which straight tubes become strips between their rings.
const STRAIGHTENED: f64 = 0.2;
/// Number of sides of the thinnest and of the thickest vessels.
const SIDES: [f64; 2] = [3.0, 24.0];

/// Additional data of the wall.
#[derive(Default)]
pub struct WallOptions<'a> {
    /// Vessel radius at points in the first column, Strahler order of cells in the second.
    pub vessels: Option<&'a dyn Beside>,
    /// Values at points in the first column.
    pub values: Option<&'a dyn Beside>,
}

/// Faces of a block on one patch.
#[derive(Clone, Debug, Default)]
pub struct Group {
    pub patch: i32,
    pub points: Vec<Point3>,
    pub triangles: Vec<[u32; 3]>,
    /// Worst radius ratio of the faces at each point, in 1/255.
    pub quality: Vec<u8>,
    /// Vessel radius at each point; 0 if unknown.
    pub radii: Vec<f64>,
    /// Strahler order at each point.
    pub orders: Vec<u8>,
    /// Value at each point, if requested.
    pub values: Vec<f64>,
}

/// Wall of a block.
#[derive(Clone, Debug, Default)]
pub struct BlockWall {
    pub block: i32,
    /// Mean radius of its rings; infinite without rings.
    pub radius: f64,
    /// Lines that replace a piece thinner than a pixel.
    pub lines: Vec<[Point3; 2]>,
    pub groups: Vec<Group>,
}

/// Wall of a mesh.
#[derive(Debug)]
pub struct Wall {
    pub pieces: Vec<BlockWall>,
    /// True if shown at full resolution.
    pub exact: bool,
    /// Number of boundary faces of the mesh.
    pub faces: usize,
}

impl Wall {
    /// Reads the boundary of a mesh, in one pass if inlets and outlets define its extent.
    ///
    /// # Errors
    /// The mesh cannot be read.
    pub fn of(mesh: &dyn MeshSource, options: &WallOptions) -> io::Result<Self> {
        let faces = mesh.counts().boundary;
        let exact = faces <= AS_IT_IS;
        let coarse = if exact {
            None
        } else {
            Some(Coarse { pixels: SCREEN / extent(mesh)?, share: (SHOWN / faces as f64).min(1.0) })
        };
        let mut pieces = Vec::new();
        mesh.each_part(
            |part| {
                let piece = mesh.boundary(part)?;
                let corners = mesh.corners_of(&piece.faces)?;
                let blocks: Vec<_> = by_block(&piece).into_iter().collect();
                let made = |(block, faces): (i32, Vec<usize>)| made(block, &faces, &piece, &corners, coarse, options);
                Ok(blocks.into_par_iter().map(made).collect::<Vec<_>>())
            },
            |made| {
                pieces.extend(made);
                Ok(())
            },
        )?;
        Ok(Self { pieces, exact, faces })
    }

    /// Number of triangles shown.
    pub fn triangles(&self) -> usize {
        self.pieces.iter().flat_map(|p| &p.groups).map(|g| g.triangles.len()).sum()
    }
}

/// Degree of simplification.
#[derive(Clone, Copy, Debug)]
struct Coarse {
    /// Screen pixels per unit of length.
    pixels: f64,
    /// Sufficient fraction of the faces.
    share: f64,
}

/// Extent of a mesh, from its inlets and outlets if it has enough.
fn extent(mesh: &dyn MeshSource) -> io::Result<f64> {
    let caps: Vec<Point3> = mesh.patches().iter().filter_map(|patch| Some(patch.cap?.center)).collect();
    let mut all = Aabb::of_points(&caps);
    if caps.len() < 3 {
        mesh.each_face_corners(|corners| {
            all = corners.iter().fold(all, |all, corners| all.union(&Aabb::of_points(&corners[..1])));
            Ok(())
        })?;
    }
    Ok((all.max - all.min).norm().max(f64::MIN_POSITIVE))
}

fn by_block(piece: &FacePiece) -> BTreeMap<i32, Vec<usize>> {
    let mut blocks: BTreeMap<i32, Vec<usize>> = BTreeMap::new();
    for i in 0..piece.faces.len() {
        blocks.entry(piece.blocks.get(i).copied().unwrap_or(0)).or_default().push(i);
    }
    blocks
}

/// Wall of a block, simplified if `coarse` is given.
fn made(
    block: i32,
    faces: &[usize],
    piece: &FacePiece,
    corners: &[[Point3; 3]],
    coarse: Option<Coarse>,
    options: &WallOptions,
) -> BlockWall {
    let mut patches: BTreeMap<i32, Vec<usize>> = BTreeMap::new();
    for &i in faces {
        patches.entry(piece.patches.get(i).copied().unwrap_or(0)).or_default().push(i);
    }
    let mut out = BlockWall { block, radius: f64::INFINITY, ..BlockWall::default() };
    let locals: Vec<Local> = patches.iter().map(|(&patch, faces)| Local::of(patch, faces, piece, corners)).collect();
    // The patch with the most faces is the wall.
    if let Some(wall) = locals.iter().max_by_key(|local| local.group.triangles.len()) {
        let rings: Vec<Ring> = wall.rings.iter().map(|ring| Ring::of(ring, &wall.group.points)).collect();
        if !rings.is_empty() {
            out.radius = rings.iter().map(|ring| ring.radius).sum::<f64>() / rings.len() as f64;
            out.lines = lines(&rings);
        }
    }
    out.groups = locals.into_iter().map(|local| local.finished(coarse, options)).collect();
    out
}

/// Ring: centre, and radius of a circle of equal circumference.
struct Ring {
    centre: Point3,
    radius: f64,
}

impl Ring {
    fn of(ring: &[u32], points: &[Point3]) -> Self {
        let at = |i: usize| points[ring[i % ring.len()] as usize];
        let length: f64 = (0..ring.len()).map(|i| (at(i + 1) - at(i)).norm()).sum();
        let sum: Vec3 = (0..ring.len()).map(|i| at(i).coords).sum();
        Self { centre: Point3::from(sum / ring.len() as f64), radius: length / TAU }
    }
}

/// Lines between two rings, or from the common centre to each ring.
fn lines(rings: &[Ring]) -> Vec<[Point3; 2]> {
    match rings {
        [a, b] => vec![[a.centre, b.centre]],
        [_] => Vec::new(),
        rings => {
            let sum: Vec3 = rings.iter().map(|r| r.centre.coords).sum();
            let middle = Point3::from(sum / rings.len() as f64);
            rings.iter().map(|r| [middle, r.centre]).collect()
        }
    }
}

/// Group with the global numbers of its points.
struct Local {
    group: Group,
    numbers: Vec<u32>,
    rings: Vec<Vec<u32>>,
}

impl Local {
    fn of(patch: i32, faces: &[usize], piece: &FacePiece, corners: &[[Point3; 3]]) -> Self {
        let mut places: FxHashMap<u32, u32> = FxHashMap::default();
        let mut local = Self { group: Group { patch, ..Group::default() }, numbers: Vec::new(), rings: Vec::new() };
        for &i in faces {
            let (face, at) = (piece.faces[i], corners[i]);
            let ratio = (255.0 * triangle_ratio(&at).clamp(0.0, 1.0)) as u8;
            let triangle = [0, 1, 2].map(|k| {
                let v = *places.entry(face[k]).or_insert_with(|| {
                    local.numbers.push(face[k]);
                    local.group.points.push(at[k]);
                    local.group.quality.push(255);
                    local.numbers.len() as u32 - 1
                });
                let worst = &mut local.group.quality[v as usize];
                *worst = (*worst).min(ratio);
                v
            });
            local.group.triangles.push(triangle);
        }
        local.rings = rings(&local.group.triangles);
        local
    }

    fn finished(self, coarse: Option<Coarse>, options: &WallOptions) -> Group {
        let mut group = match coarse {
            Some(coarse) => self.coarser(coarse),
            None => self.group,
        };
        if let Some(vessels) = options.vessels {
            let places: Vec<[Point3; 3]> = group.points.iter().map(|&p| [p; 3]).collect();
            group.radii = vessels.at_points(0, &group.points);
            group.orders = vessels.in_faces(1, &places).iter().map(|&o| o.clamp(0.0, 255.0) as u8).collect();
        }
        if let Some(values) = options.values {
            group.values = values.at_points(0, &group.points);
        }
        group
    }

    /// Simplifies a group: ring points by the vessel's screen size, and as few faces between them as possible.
    fn coarser(self, Coarse { pixels, share }: Coarse) -> Group {
        let Group { patch, points, triangles, quality, .. } = self.group;
        let mut stands: Vec<u32> = (0..points.len() as u32).collect();
        let mut fixed = vec![false; points.len()];
        let mut target = 0;
        let mut kept: Vec<Vec<u32>> = Vec::new();
        for ring in &self.rings {
            let radius = Ring::of(ring, &points).radius;
            let seen = (SIDES[0] + 1.4 * (radius * pixels).sqrt()).clamp(SIDES[0], SIDES[1]);
            let keep = seen.max(ring.len() as f64 * share.sqrt()) as usize;
            for (v, to) in thinned(ring, keep, |v| self.numbers[v as usize]) {
                stands[v as usize] = to;
                fixed[to as usize] = true;
            }
            kept.push(ring.iter().copied().filter(|&v| fixed[v as usize]).collect());
            target += keep;
        }
        let worst = quality.into_iter().min().unwrap_or(255);
        let of = |(points, triangles): (Vec<Point3>, Vec<[u32; 3]>)| Group {
            patch,
            quality: vec![worst; points.len()],
            points,
            triangles,
            ..Group::default()
        };
        if let [first, second] = &kept[..]
            && share < STRAIGHTENED
            && let Some(strip) = straight(&points, [first, second])
        {
            return of(compact(&points, strip));
        }
        let mapped = triangles.iter().map(|t| t.map(|v| stands[v as usize]));
        let triangles: Vec<[u32; 3]> = mapped.filter(|[a, b, c]| a != b && b != c && c != a).collect();
        // A closed surface has no rings that define its size.
        let target = if target == 0 { 100 } else { target + target / 8 };
        let target = target.max((triangles.len() as f64 * share) as usize);
        of(Collapse::new(points, triangles, fixed).run(target))
    }
}

/// Returns the points used by triangles, and renumbered triangles.
fn compact(points: &[Point3], mut triangles: Vec<[u32; 3]>) -> (Vec<Point3>, Vec<[u32; 3]>) {
    let mut used: Vec<u32> = triangles.as_flattened().to_vec();
    used.sort_unstable();
    used.dedup();
    for v in triangles.as_flattened_mut() {
        *v = used.partition_point(|&u| u < *v) as u32;
    }
    (used.iter().map(|&v| points[v as usize]).collect(), triangles)
}

#[cfg(test)]
mod tests {
    use super::*;
    use anastomesh_mesh::adjacency::boundary_faces;
    use anastomesh_mesh::shapes::tube_lattice;
    use anastomesh_mesh::{VolumeMesh, WALL};
    use std::collections::BTreeSet;

    /// A tube of two blocks with caps at both ends.
    fn tube() -> VolumeMesh {
        let mesh = tube_lattice(4, 40, 0.3);
        let boundary = boundary_faces(&mesh);
        let top = mesh.points.iter().map(|p| p.z).fold(0.0, f64::max);
        let all = |f: &[u32; 3], z: f64| f.iter().all(|&v| (mesh.points[v as usize].z - z).abs() < 1e-9);
        let patch = |f: &[u32; 3]| {
            if all(f, 0.0) {
                2
            } else if all(f, top) {
                3
            } else {
                WALL
            }
        };
        let low = |f: &[u32; 3]| f.iter().all(|&v| mesh.points[v as usize].z < 0.501 * top);
        VolumeMesh {
            boundary_patch: boundary.iter().map(patch).collect(),
            boundary_block: boundary.iter().map(|f| i32::from(!low(f))).collect(),
            boundary,
            mesh,
            ..VolumeMesh::default()
        }
    }

    #[test]
    fn small_walls_are_shown_as_they_are() {
        let mesh = tube();
        let wall = Wall::of(&mesh, &WallOptions::default()).unwrap();
        assert!(wall.exact && wall.triangles() == mesh.boundary.len() && wall.pieces.len() == 2);
        for piece in &wall.pieces {
            assert_eq!((piece.groups.len(), piece.lines.len()), (2, 1));
            assert!(piece.radius > 0.2 && piece.radius < 10.0, "{}", piece.radius);
        }
    }

    #[test]
    fn coarse_blocks_fit_together() {
        let mesh = tube();
        let piece = mesh.boundary(0).unwrap();
        let corners = (&mesh as &dyn MeshSource).corners_of(&piece.faces).unwrap();
        let blocks: Vec<BlockWall> = by_block(&piece)
            .into_iter()
            .map(|(block, faces)| {
                made(
                    block,
                    &faces,
                    &piece,
                    &corners,
                    Some(Coarse { pixels: 1e-6, share: 0.0 }),
                    &WallOptions::default(),
                )
            })
            .collect();
        // Exact points of a group's rings: both blocks share those at the joint.
        let rims = |piece: &BlockWall, patch: i32| -> BTreeSet<[u64; 3]> {
            let group = piece.groups.iter().find(|g| g.patch == patch).unwrap();
            let key = |&v: &u32| <[f64; 3]>::from(group.points[v as usize].coords).map(f64::to_bits);
            rings(&group.triangles).iter().flatten().map(key).collect()
        };
        let shared = rims(&blocks[0], WALL).intersection(&rims(&blocks[1], WALL)).count();
        assert_eq!(shared, 3);
        let faces: usize = blocks.iter().flat_map(|p| &p.groups).map(|g| g.triangles.len()).sum();
        assert!(faces < 40, "{faces}");
        // Caps match the rim of their wall.
        assert!(rims(&blocks[0], 2).is_subset(&rims(&blocks[0], WALL)));
    }
}
