//! Vessels of known shape through the whole pipeline: radius, caps, loops.

use crate::common;
use anastomesh::check::Line;
use anastomesh::meshing::Meshed;
use anastomesh::network::Skeleton;
use anastomesh::skeleton::{Edge, Node, NodeId};
use anastomesh::{Point3, Vec3, VolumeMesh, WALL};
use std::collections::BTreeSet;
use std::f64::consts::{PI, TAU};

/// Typical resolutions.
const RHO: [f64; 3] = [3.0, 4.0, 5.0];

fn skeleton(nodes: &[(Point3, f64)], edges: &[[u32; 2]]) -> Skeleton {
    let node = |(i, &(position, radius)): (usize, &(Point3, f64))| Node { position, radius, original: i as u32 };
    let edge = |&ends: &[u32; 2]| Edge { nodes: ends.map(NodeId), radii: ends.map(|n| nodes[n as usize].1) };
    Skeleton { nodes: nodes.iter().enumerate().map(node).collect(), edges: edges.iter().map(edge).collect() }
}

/// A vessel through these nodes.
fn vessel(nodes: &[(Point3, f64)]) -> Skeleton {
    let edges: Vec<[u32; 2]> = (1..nodes.len() as u32).map(|i| [i - 1, i]).collect();
    skeleton(nodes, &edges)
}

/// An axis that is not aligned with any grid.
fn axis() -> Vec3 {
    Vec3::new(0.62, -0.31, 0.72).normalize()
}

/// Straight vessel of `pieces` equal edges, with a radius from `radii[0]` to `radii[1]`.
fn straight(length: f64, pieces: u32, radii: [f64; 2]) -> Skeleton {
    let at = |i: u32| {
        let t = f64::from(i) / f64::from(pieces);
        (Point3::new(3.0, 1.0, -2.0) + axis() * (length * t), radii[0] + (radii[1] - radii[0]) * t)
    };
    vessel(&(0..=pieces).map(at).collect::<Vec<_>>())
}

fn valid_mesh(network: &Skeleton, rho: f64) -> Meshed {
    let meshed = common::mesh(network, rho);
    assert!(meshed.check.is_valid(), "rho {rho}\n{}", meshed.check);
    assert_eq!(meshed.report.retries, [], "rho {rho}");
    meshed
}

fn volume(mesh: &VolumeMesh) -> f64 {
    let six = |t: &[u32; 4]| {
        let [a, b, c, d] = t.map(|v| mesh.mesh.points[v as usize]);
        (b - a).cross(&(c - a)).dot(&(d - a))
    };
    mesh.mesh.tets.iter().map(six).sum::<f64>() / 6.0
}

/// Properties of a cap, computed from its triangles alone.
struct Disc {
    name: String,
    /// Mean of its points.
    middle: Point3,
    normal: Vec3,
    area: f64,
    /// Maximum distance of a point from the plane through the middle.
    unevenness: f64,
}

/// Caps in the order of their patches.
fn discs(mesh: &VolumeMesh) -> Vec<Disc> {
    let at = |v: u32| mesh.mesh.points[v as usize];
    let disc = |id: i32, name: &str| {
        let faces: Vec<[u32; 3]> =
            mesh.boundary.iter().zip(&mesh.boundary_patch).filter(|(_, p)| **p == id).map(|(f, _)| *f).collect();
        let vertices: BTreeSet<u32> = faces.iter().flatten().copied().collect();
        let middle = vertices.iter().fold(Vec3::zeros(), |sum, &v| sum + at(v).coords) / vertices.len() as f64;
        let middle = Point3::from(middle);
        let doubled = faces.iter().fold(Vec3::zeros(), |sum, f| {
            let [a, b, c] = f.map(at);
            sum + (b - a).cross(&(c - a))
        });
        let normal = doubled.normalize();
        let unevenness = vertices.iter().map(|&v| (at(v) - middle).dot(&normal).abs()).fold(0.0, f64::max);
        Disc { name: name.to_owned(), middle, normal, area: 0.5 * doubled.norm(), unevenness }
    };
    mesh.patches.iter().filter(|p| p.id != WALL).map(|p| disc(p.id, &p.name)).collect()
}

/// Asserts flat discs of the right size at both ends of a vessel, with names and outward orientation.
fn assert_caps(mesh: &VolumeMesh, ends: [(Point3, Vec3, f64); 2]) {
    let caps = discs(mesh);
    let names: Vec<&str> = caps.iter().map(|c| c.name.as_str()).collect();
    assert_eq!(names, ["inlet", "outlet_0"]);
    for (node, outwards, radius) in ends {
        let near = |c: &&Disc| (c.middle - node).norm() < 0.1 * radius;
        let found: Vec<&Disc> = caps.iter().filter(near).collect();
        let [cap] = found[..] else { panic!("{} caps at {node}", found.len()) };
        assert!(cap.unevenness <= 1e-9 * radius, "{}: {:e}", cap.name, cap.unevenness);
        assert!(cap.normal.dot(&outwards) > 1.0 - 1e-9, "{}: {}", cap.name, cap.normal);
        let share = cap.area / (PI * radius * radius);
        assert!((share - 1.0).abs() <= 0.05, "{}: {share} of its area", cap.name);
    }
}

/// Distance between the planes of the two caps.
fn length_between_caps(mesh: &VolumeMesh) -> f64 {
    let caps = discs(mesh);
    (caps[0].middle - caps[1].middle).dot(&axis()).abs()
}

fn ends_of(network: &Skeleton) -> [(Point3, Vec3, f64); 2] {
    let (first, last) = (network.nodes[0], network.nodes[network.nodes.len() - 1]);
    [(first.position, -axis(), first.radius), (last.position, axis(), last.radius)]
}

/// Asserts the radius of the cylinder with the volume and length of the mesh.
fn assert_straight_tube(network: &Skeleton, name: &str) {
    for rho in RHO {
        let mesh = valid_mesh(network, rho).mesh;
        assert_caps(&mesh, ends_of(network));
        let radius = (volume(&mesh) / (PI * length_between_caps(&mesh))).sqrt();
        let error = radius / network.nodes[0].radius - 1.0;
        println!("{name}, rho {rho}: radius {:+.2} %", 100.0 * error);
        assert!(error.abs() <= 0.01, "{name}, rho {rho}: the radius is off by {:.2} %", 100.0 * error);
    }
}

#[test]
fn a_tube_of_two_nodes_has_its_radius() {
    assert_straight_tube(&straight(14.0, 1, [1.0; 2]), "two nodes");
}

#[test]
fn a_short_tube_has_its_radius() {
    assert_straight_tube(&straight(4.0, 1, [1.0; 2]), "short");
}

/// Most measured networks have edges shorter than their radius.
#[test]
fn a_polyline_of_short_edges_has_its_radius() {
    assert_straight_tube(&straight(14.0, 70, [1.0; 2]), "edges of 0.2 radii");
}

/// This tube in metres and in nanometres.
#[test]
fn the_unit_of_length_does_not_matter() {
    for scale in [1e-6, 1e6] {
        let mut network = straight(10.0, 5, [1.0; 2]);
        for node in &mut network.nodes {
            node.position *= scale;
            node.radius *= scale;
        }
        for edge in &mut network.edges {
            edge.radii = [scale; 2];
        }
        let mesh = valid_mesh(&network, 3.0).mesh;
        assert_caps(&mesh, ends_of(&network));
        let radius = (volume(&mesh) / (PI * length_between_caps(&mesh))).sqrt() / scale;
        assert!((radius - 1.0).abs() <= 0.01, "scale {scale:e}: {radius}");
    }
}

#[test]
fn a_tapering_tube_has_the_volume_of_its_frustum() {
    for pieces in [1, 40] {
        let network = straight(16.0, pieces, [1.2, 0.8]);
        for rho in RHO {
            let mesh = valid_mesh(&network, rho).mesh;
            assert_caps(&mesh, ends_of(&network));
            let frustum = PI / 3.0 * length_between_caps(&mesh) * (1.44 + 1.2 * 0.8 + 0.64);
            let error = (volume(&mesh) / frustum).sqrt() - 1.0;
            println!("taper in {pieces}, rho {rho}: radius {:+.2} %", 100.0 * error);
            assert!(error.abs() <= 0.015, "{pieces} edges, rho {rho}: the radius is off by {:.2} %", 100.0 * error);
        }
    }
}

/// Quarter torus: its volume is that of a straight tube with the length of its axis (Pappus).
#[test]
fn a_bent_tube_has_the_volume_of_its_axis() {
    const BEND: f64 = 8.0;
    let at = |i: i32| {
        let (sin, cos) = (f64::from(i) * PI / 80.0).sin_cos();
        (Point3::new(BEND * cos, BEND * sin, 0.0), 1.0)
    };
    let network = vessel(&(0..=40).map(at).collect::<Vec<_>>());
    let mesh = valid_mesh(&network, 4.0).mesh;
    let radius = (volume(&mesh) / (PI * BEND * PI / 2.0)).sqrt();
    assert!((radius - 1.0).abs() <= 0.015, "{radius}");
}

/// Euler characteristic V − E + F of the boundary.
fn euler(mesh: &VolumeMesh) -> i64 {
    let vertices: BTreeSet<u32> = mesh.boundary.iter().flatten().copied().collect();
    let edges: BTreeSet<[u32; 2]> = mesh
        .boundary
        .iter()
        .flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]])
        .map(|[a, b]| [a.min(b), a.max(b)])
        .collect();
    vertices.len() as i64 - edges.len() as i64 + mesh.boundary.len() as i64
}

/// A ring with one vessel in and one vessel out.
#[test]
fn a_loop_is_a_handle() {
    const RING: u32 = 48;
    let mut nodes: Vec<(Point3, f64)> = (0..RING)
        .map(|i| {
            let (sin, cos) = (f64::from(i) / f64::from(RING) * TAU).sin_cos();
            (Point3::new(12.0 * cos, 12.0 * sin, 0.4 * cos), 1.0)
        })
        .collect();
    let mut edges: Vec<[u32; 2]> = (0..RING).map(|i| [i, (i + 1) % RING]).collect();
    for (x, ring) in [(22.0, 0), (-22.0, RING / 2)] {
        edges.push([ring, nodes.len() as u32]);
        nodes.push((Point3::new(x, 0.0, 0.0), 1.0));
    }
    let meshed = valid_mesh(&skeleton(&nodes, &edges), 3.0);
    let loops = meshed.check.line(Line::Loops).expect("every line is there");
    assert_eq!((loops.expected.as_deref(), loops.found.as_deref()), (Some(&[1][..]), Some(&[1][..])));
    assert_eq!(euler(&meshed.mesh), 0);
    assert_eq!(discs(&meshed.mesh).len(), 2);
}

/// Two unrelated vessels: two components, with one inlet each.
#[test]
fn components_stay_apart() {
    let at = |x: f64, z: f64, r: f64| (Point3::new(x, 0.0, z), r);
    let network =
        skeleton(&[at(0.0, 0.0, 1.0), at(0.5, 9.0, 0.9), at(6.0, 0.0, 0.5), at(6.0, 8.0, 0.6)], &[[0, 1], [2, 3]]);
    let meshed = valid_mesh(&network, 3.0);
    assert_eq!(meshed.check.counts.components, 2);
    let mut names: Vec<String> = discs(&meshed.mesh).into_iter().map(|d| d.name).collect();
    names.sort_unstable();
    assert_eq!(names, ["inlet", "inlet_1", "outlet_0", "outlet_1"]);
    assert_eq!(euler(&meshed.mesh), 4);
}
