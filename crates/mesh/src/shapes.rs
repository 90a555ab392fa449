//! Analytic meshes for tests.

use super::region::{NamedRegion, RegionFace, region_faces};
use super::{Patch, TetMesh, TriMesh, VolumeMesh};
use crate::geometry::{Point3, Vec3};
use rustc_hash::FxHashMap;

/// Unit cube as n × n × n cells of six tetrahedra each (Kuhn's subdivision).
pub fn cube_lattice(n: u32) -> TetMesh {
    let id = |x: u32, y: u32, z: u32| (z * (n + 1) + y) * (n + 1) + x;
    let mut mesh = TetMesh::default();
    for z in 0..=n {
        for y in 0..=n {
            for x in 0..=n {
                mesh.points.push(Point3::from([x, y, z].map(|i| f64::from(i) / f64::from(n))));
            }
        }
    }
    for cell in 0..n * n * n {
        let corner = [cell % n, cell / n % n, cell / n / n];
        for [i, j, odd] in [[0, 1, 0], [1, 2, 0], [2, 0, 0], [1, 0, 1], [2, 1, 1], [0, 2, 1]] {
            let mut way = [corner; 4];
            way[1][i] += 1;
            way[2][i] += 1;
            way[2][j] += 1;
            way[3] = corner.map(|x| x + 1);
            let [a, b, c, d] = way.map(|[x, y, z]| id(x, y, z));
            mesh.tets.push(if odd == 0 { [a, b, c, d] } else { [a, c, b, d] });
        }
    }
    mesh
}

/// Unit sphere: an icosahedron with triangles split in four `level` times.
pub fn sphere_surface(level: usize) -> TriMesh {
    let phi = f64::midpoint(1.0, 5.0_f64.sqrt());
    let mut points: Vec<Point3> = Vec::new();
    for (x, y) in [(-1.0, phi), (1.0, phi), (-1.0, -phi), (1.0, -phi)] {
        points.push(Point3::new(x, y, 0.0));
    }
    for (y, z) in [(-1.0, phi), (1.0, phi), (-1.0, -phi), (1.0, -phi)] {
        points.push(Point3::new(0.0, y, z));
    }
    for (x, z) in [(phi, -1.0), (phi, 1.0), (-phi, -1.0), (-phi, 1.0)] {
        points.push(Point3::new(x, 0.0, z));
    }
    let mut triangles = vec![
        [0, 11, 5],
        [0, 5, 1],
        [0, 1, 7],
        [0, 7, 10],
        [0, 10, 11],
        [1, 5, 9],
        [5, 11, 4],
        [11, 10, 2],
        [10, 7, 6],
        [7, 1, 8],
        [3, 9, 4],
        [3, 4, 2],
        [3, 2, 6],
        [3, 6, 8],
        [3, 8, 9],
        [4, 9, 5],
        [2, 4, 11],
        [6, 2, 10],
        [8, 6, 7],
        [9, 8, 1],
    ];
    for _ in 0..level {
        let mut middle: FxHashMap<[u32; 2], u32> = FxHashMap::default();
        let mut next = Vec::with_capacity(4 * triangles.len());
        for [a, b, c] in triangles {
            let [ab, bc, ca] = [[a, b], [b, c], [c, a]].map(|[u, v]: [u32; 2]| {
                *middle.entry([u.min(v), u.max(v)]).or_insert_with(|| {
                    points.push(nalgebra::center(&points[u as usize], &points[v as usize]));
                    points.len() as u32 - 1
                })
            });
            next.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
        }
        triangles = next;
    }
    for p in &mut points {
        *p /= p.coords.norm();
    }
    TriMesh { points, triangles }
}

/// Unit sphere with `rings` bands and `2 · rings` points around each.
pub fn banded_sphere(rings: u32) -> TriMesh {
    let around = 2 * rings;
    let mut mesh = TriMesh::default();
    let angle = |part: u32, of: u32| std::f64::consts::PI * f64::from(part) / f64::from(of);
    for ring in 1..rings {
        let (sin, cos) = libm::sincos(angle(ring, rings));
        for i in 0..around {
            let (y, x) = libm::sincos(angle(2 * i, around));
            mesh.points.push(Point3::new(sin * x, sin * y, cos));
        }
    }
    let (north, south) = (mesh.points.len() as u32, mesh.points.len() as u32 + 1);
    mesh.points.extend([Point3::new(0.0, 0.0, 1.0), Point3::new(0.0, 0.0, -1.0)]);
    let at = |ring: u32, i: u32| (ring - 1) * around + i % around;
    for i in 0..around {
        mesh.triangles.push([north, at(1, i), at(1, i + 1)]);
        mesh.triangles.push([south, at(rings - 1, i + 1), at(rings - 1, i)]);
        for ring in 1..rings - 1 {
            let [a, b, c, d] = [at(ring, i), at(ring + 1, i), at(ring + 1, i + 1), at(ring, i + 1)];
            mesh.triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    mesh
}

/// Torus around z: a tube of this radius along the unit circle, with `n` points along it and `m` around it.
pub fn torus_surface(n: u32, m: u32, tube: f64) -> TriMesh {
    let angle = |part: u32, of: u32| libm::sincos(std::f64::consts::TAU * f64::from(part) / f64::from(of));
    let at = |i: u32, j: u32| {
        let ((su, cu), (sv, cv)) = (angle(i, n), angle(j, m));
        Point3::new((1.0 + tube * cv) * cu, (1.0 + tube * cv) * su, tube * sv)
    };
    let id = |i: u32, j: u32| (i % n) * m + j % m;
    let cells = || (0..n).flat_map(|i| (0..m).map(move |j| (i, j)));
    let quads = cells().map(|(i, j)| [id(i, j), id(i + 1, j), id(i + 1, j + 1), id(i, j + 1)]);
    let triangles = quads.flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    TriMesh { points: cells().map(|(i, j)| at(i, j)).collect(), triangles }
}

/// Solid tube of radius 1 and height `layers · step`: a disc of hexagonal rings swept along z. It has `rings` rings of
/// vertices around the axis, with `6 · ring` vertices each.
pub fn tube_lattice(rings: u32, layers: u32, step: f64) -> TetMesh {
    let mut mesh = TetMesh::default();
    let (disc, flat) = disc_lattice(rings);
    let count = disc.len() as u32;
    for layer in 0..=layers {
        mesh.points.extend(disc.iter().map(|p| p + Vec3::z() * (f64::from(layer) * step)));
    }
    for layer in 0..layers {
        for triangle in &flat {
            // A prism cut by the order of its vertices conforms with its neighbours.
            let mut t = *triangle;
            t.rotate_left((0..3).min_by_key(|&i| triangle[i]).unwrap_or(0));
            let [a, b, c] = t.map(|v| v + layer * count);
            let [d, e, f] = [a + count, b + count, c + count];
            if b < c {
                mesh.tets.extend([[a, b, c, f], [a, b, f, e], [a, e, f, d]]);
            } else {
                mesh.tets.extend([[a, b, c, e], [a, e, c, f], [a, e, f, d]]);
            }
        }
    }
    mesh
}

fn disc_lattice(rings: u32) -> (Vec<Point3>, Vec<[u32; 3]>) {
    let mut points = vec![Point3::origin()];
    let start = |ring: u32| if ring == 0 { 0 } else { 1 + 3 * ring * (ring - 1) };
    for ring in 1..=rings {
        for i in 0..6 * ring {
            let (sin, cos) = libm::sincos(std::f64::consts::TAU * f64::from(i) / f64::from(6 * ring));
            points.push(Point3::new(cos, sin, 0.0) * (f64::from(ring) / f64::from(rings)));
        }
    }
    let mut triangles = Vec::new();
    for ring in 1..=rings {
        let outer = |i: u32| start(ring) + i % (6 * ring);
        let inner = |i: u32| if ring == 1 { 0 } else { start(ring - 1) + i % (6 * (ring - 1)) };
        for sector in 0..6 {
            for i in 0..ring {
                let (o, n) = (sector * ring + i, sector * (ring - 1) + i);
                triangles.push([inner(n), outer(o), outer(o + 1)]);
                if i + 1 < ring {
                    triangles.push([inner(n), outer(o + 1), inner(n + 1)]);
                }
            }
        }
    }
    (points, triangles)
}

/// Moves the points marked in `movable` by up to `size` in each coordinate, by a fixed pseudo-random sequence.
pub fn perturb(points: &mut [Point3], movable: &[bool], size: f64, seed: u64) {
    let mut state = seed;
    let mut next = || {
        // SplitMix64
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    };
    for (p, _) in points.iter_mut().zip(movable).filter(|(_, m)| **m) {
        *p += Vec3::new(next(), next(), next()) * size;
    }
}

/// Unit cube of three regions along z: a square channel (`lumen`), its `wall`, and the `tissue` around it. Each of the five
/// bands across the cube has `fineness` layers of cells.
///
/// ```
/// use anastomesh_mesh::shapes::walled_channel;
///
/// let (volume, regions) = walled_channel(1);
/// assert_eq!(regions.iter().map(|region| region.name.as_str()).collect::<Vec<_>>(), ["lumen", "wall", "tissue"]);
/// assert_eq!(volume.patches[2].name, "interface_lumen_wall");
/// ```
pub fn walled_channel(fineness: u32) -> (VolumeMesh, Vec<NamedRegion>) {
    let mesh = cube_lattice(5 * fineness);
    let centre = |t: &[u32]| t.iter().map(|&v| mesh.points[v as usize].coords).sum::<Vec3>() / t.len() as f64;
    let of_tet = |t: &[u32; 4]| {
        let c = centre(t);
        match (c.x - 0.5).abs().max((c.y - 0.5).abs()) {
            ..0.1 => 1,
            ..0.3 => 2,
            _ => 3,
        }
    };
    let tet_block: Vec<i32> = mesh.tets.iter().map(of_tet).collect();
    let names =
        ["inlet", "outlet_0", "interface_lumen_wall", "interface_wall_tissue", "ring_inlet", "ring_outlet_0", "organ"];
    let patch_of = |face: &RegionFace| {
        let z = centre(&face.vertices).z;
        match (face.region, face.beyond) {
            (1, Some(_)) => 4,
            (2, Some(_)) => 5,
            (1, None) => 2 + i32::from(z > 0.5),
            (2, None) => 6 + i32::from(z > 0.5),
            _ => 8,
        }
    };
    let faces = region_faces(&mesh, &tet_block);
    let volume = VolumeMesh {
        boundary: faces.iter().map(|face| face.vertices).collect(),
        boundary_block: faces.iter().map(|face| face.region).collect(),
        boundary_patch: faces.iter().map(patch_of).collect(),
        patches: (2..).zip(names).map(|(id, name)| Patch { id, name: name.into(), cap: None }).collect(),
        tet_block,
        mesh,
    };
    (volume, vec![NamedRegion::new(1, NamedRegion::LUMEN), NamedRegion::new(2, "wall"), NamedRegion::new(3, "tissue")])
}
