use super::canonical::Canonical;
use super::cells::shared_cells;
use super::fork;
use super::image::image;
use super::shape::{Fork, middle};
use crate::block::contoured::contoured;
use crate::block::topology::Topology;
use crate::block::{BlockParams, EndStyle, Finished, mesh_cluster};
use crate::partition::{Cluster, ClusterEnd, ClusterId, CutId, EndKind, ForkCell};
use anastomesh_mesh::geometry::{Point3, Section, Tube, Vec3};
use anastomesh_mesh::quality::TetQuality;
use anastomesh_skeleton::NodeId;
use anastomesh_tet::parts::Watch;
use nalgebra::Rotation3;

/// Azimuth in degrees, length and radii at both ends.
type Vessel = (f64, f64, [f64; 2]);

/// Fork or bend of some vessels at a node. The first one ends there.
fn cluster<const N: usize>(node: Point3, turn: Rotation3<f64>, rise: f64, vessels: [Vessel; N]) -> Cluster {
    let mut cluster = Cluster::default();
    let normal = turn * Vec3::z();
    for (i, (azimuth, length, radii)) in (0..).zip(vessels) {
        let (y, x) = libm::sincos(azimuth.to_radians());
        let axis = turn * Vec3::new(x, y, rise).normalize();
        let at = node + axis * length;
        cluster.tubes.push(Tube { a: node, b: at, ra: radii[0], rb: radii[1] });
        cluster.tubes.push(Tube { a: at, b: at + axis * 1.07 * radii[1], ra: radii[1], rb: radii[1] });
        let section = Section { up: Some(normal), ..Section::new(at, axis, radii[1]) };
        let kind = EndKind::Cut { cut: CutId(i), side: u8::from(i == 0) };
        cluster.ends.push(ClusterEnd { section, kind, overrun: 2 * i + 1 });
    }
    in_own_cell(cluster)
}

fn own_cell(cluster: &Cluster) -> Option<ForkCell> {
    Fork::of(cluster)?.shape(1.0)?.cell()
}

fn in_own_cell(cluster: Cluster) -> Cluster {
    Cluster { cells: own_cell(&cluster).into_iter().collect(), ..cluster }
}

fn plain() -> [Vessel; 3] {
    [(4.0, 2.2, [1.0, 1.05]), (128.0, 2.3, [1.0, 0.95]), (251.0, 2.1, [1.0, 0.9])]
}

fn turned(seed: f64) -> Rotation3<f64> {
    Rotation3::from_euler_angles(seed, 1.3 * seed, 2.9 * seed)
}

fn shared() -> BlockParams {
    BlockParams { ends: EndStyle::Shared, ..BlockParams::with_rho(3.0) }
}

#[test]
fn images_are_sound_and_as_good_as_contoured_forks() {
    let mut images = 0;
    for i in 0..9 {
        let vary = |k: u32, by: f64| by * (f64::from((7 * i + 3 * k) % 9) / 4.0 - 1.0);
        let limb = |k: u32, azimuth| (azimuth + vary(k, 15.0), 2.25 + vary(k + 1, 0.2), [1.0, 1.0 + vary(k + 2, 0.1)]);
        let vessels = [limb(0, 0.0), limb(1, 120.0), limb(2, 240.0)];
        let input = cluster(Point3::new(100.0, -3.0, 7.0), turned(1.0 + f64::from(i)), vary(3, 0.2), vessels);
        let Some(made) = fork(&input, &shared()) else { continue };
        images += 1;
        let topology = Topology::of(&made.mesh, made.discs.iter().map(Vec::as_slice));
        assert_eq!(*made.topology, topology.expect("its discs are on its boundary"), "{i}");
        let [image, direct] =
            [mesh_cluster(ClusterId(0), &input, &shared()), contoured(ClusterId(0), &input, &shared(), &Watch::NOBODY)]
                .map(|made| {
                    Finished::of_cluster(made.expect("a cluster"), |node| node.0).expect("its ends are on its boundary")
                });
        assert!(image.certificate.is_sound(), "{i}");
        // The same discs, whether by template or not.
        for (a, b) in image.joints.iter().zip(&direct.joints) {
            let points = |block: &Finished, vertices: &[u32]| -> Vec<Point3> {
                vertices.iter().map(|&v| block.mesh.points[v as usize]).collect()
            };
            assert_eq!(points(&image, &a.vertices), points(&direct, &b.vertices));
        }
        let [a, b] = [&image, &direct].map(|block| TetQuality::of(&block.mesh));
        assert!(a.min > 0.3 && a.mean > b.mean - 0.04, "{i}: {a:?} {b:?}");
        let [a, b] = [&image, &direct].map(volume);
        assert!((a / b - 1.0).abs() < 0.015, "{i}: {a} {b}");
    }
    assert!(images > 3, "{images}");
}

fn volume(block: &Finished) -> f64 {
    let of = |t: &[u32; 4]| {
        let [a, b, c, d] = t.map(|v| block.mesh.points[v as usize]);
        (b - a).cross(&(c - a)).dot(&(d - a)) / 6.0
    };
    block.mesh.tets.iter().map(of).sum()
}

#[test]
fn a_vessel_may_end_at_a_terminal() {
    let mut input = cluster(Point3::new(3.0, 2.0, 1.0), turned(0.7), 0.1, plain());
    input.ends[2].kind = EndKind::Terminal(NodeId(7));
    input.ends[2].section.up = None;
    let input = in_own_cell(input);
    assert!(fork(&input, &shared()).is_some());
    let made = mesh_cluster(ClusterId(0), &input, &shared()).expect("a cluster");
    let block = Finished::of_cluster(made, |node| node.0).expect("its ends are on its boundary");
    assert!(block.certificate.is_sound(), "{:?}", block.certificate.broken_line());
    assert_eq!((block.joints.len(), block.caps.len(), block.caps[0].node), (2, 1, NodeId(7)));
    // A terminal inside another vessel is left to the contour.
    let mut buried = input.clone();
    for tube in &mut buried.tubes[..2] {
        (tube.ra, tube.rb) = (9.0, 9.0);
    }
    buried.ends[0].section.radius = 9.0;
    assert!(fork(&buried, &shared()).is_none());
}

#[test]
fn bends_are_images_too() {
    let bend = |azimuth: f64| {
        cluster(Point3::new(2.0, 1.0, -5.0), turned(azimuth), 0.0, [plain()[0], (azimuth, 3.0, [1.0, 0.9])])
    };
    for azimuth in [70.0, 85.0, 100.0, 115.0, 130.0, 145.0, 155.0] {
        let input = bend(azimuth);
        let made = fork(&input, &shared()).unwrap_or_else(|| panic!("no image at {azimuth}"));
        let topology = Topology::of(&made.mesh, made.discs.iter().map(Vec::as_slice));
        assert_eq!(*made.topology, topology.expect("its discs are on its boundary"), "{azimuth}");
        let block = mesh_cluster(ClusterId(0), &input, &shared()).expect("a cluster");
        let block = Finished::of_cluster(block, |node| node.0).expect("its ends are on its boundary");
        assert!(block.certificate.is_sound() && block.joints.len() == 2, "{azimuth}");
        assert!(TetQuality::of(&block.mesh).min > 0.2, "{azimuth}");
    }
    // The frames at a bend are normal to its plane.
    let mut tilted = bend(90.0);
    let up = Some(tilted.ends[0].section.axis + tilted.ends[1].section.axis);
    tilted.ends.iter_mut().for_each(|end| end.section.up = up);
    assert!(Fork::of(&tilted).is_none());
}

#[test]
fn images_turn_with_their_forks() {
    let at = |node: Point3, turn: Rotation3<f64>| {
        let input = cluster(node, turn, 0.05, plain());
        fork(&input, &shared()).expect("a fork").mesh
    };
    let (there, turn) = (Point3::new(5.0, -8.0, 2.0), turned(2.0));
    let (still, moved) = (at(Point3::origin(), Rotation3::identity()), at(there, turn));
    assert_eq!(still.tets, moved.tets);
    for (p, q) in still.points.iter().zip(&moved.points) {
        assert!((there + turn * p.coords - q).norm() < 1e-9);
    }
}

#[test]
fn the_middle_of_a_cell_is_its_own_image() {
    let params = shared();
    let cell = own_cell(&cluster(Point3::origin(), turned(0.5), 0.0, plain())).expect("a cell");
    let canonical = Canonical::of(&cell, &params).expect("a canonical fork");
    let middle = middle(&cell, 2.0 * 1.6 / 3.0, 1.0);
    let fork = Fork::of(&middle).expect("a fork");
    assert_eq!(own_cell(&middle), Some(cell));
    let made = image(&canonical, &fork, &middle, &params).expect("an image");
    for (p, q) in canonical.points.iter().zip(&made.mesh.points) {
        assert!((p - q).norm() < 1e-2, "{p} {q}");
    }
    // The same cell gives the same fork.
    let again = Canonical::of(&cell, &params).expect("a canonical fork");
    assert_eq!((canonical.points, canonical.tets), (again.points, again.tets));
}

#[test]
fn hollow_forks_have_the_same_boundary() {
    let input = cluster(Point3::origin(), turned(3.0), 0.0, plain());
    let of = |hollow| {
        let made = mesh_cluster(ClusterId(0), &input, &BlockParams { hollow, ..shared() }).expect("a cluster");
        Finished::of_cluster(made, |node| node.0).expect("its ends are on its boundary")
    };
    let (filled, hollow) = (of(false), of(true));
    assert!(hollow.certificate.is_sound() && hollow.mesh.tets.is_empty());
    assert_eq!(
        hollow.hull.len(),
        filled.wall.len() + filled.joints.iter().map(|joint| joint.faces.len()).sum::<usize>()
    );
}

#[test]
fn other_clusters_are_no_forks() {
    let straight = cluster(Point3::origin(), turned(3.0), 0.0, plain());
    assert!(fork(&straight, &shared()).is_some());
    let layered = BlockParams { layers: Some(anastomesh_tet::Layers::default()), ..shared() };
    assert!(fork(&straight, &layered).is_none());
    assert!(fork(&straight, &BlockParams { shift: [0.5, 0.0, 0.0], ..shared() }).is_none());
    let mut bent = straight.clone();
    bent.ends[1].section.axis = (bent.ends[1].section.axis + Vec3::new(0.0, 0.05, 0.0)).normalize();
    assert!(fork(&bent, &shared()).is_none());
    let mut unframed = straight.clone();
    unframed.ends[2].section.up = None;
    assert!(fork(&unframed, &shared()).is_none());
    let mut apart = straight;
    apart.tubes[2].a += Vec3::new(0.0, 0.0, 1e-9);
    assert!(fork(&apart, &shared()).is_none());
}

#[test]
fn forks_are_images_of_the_nearest_shared_cells() {
    let fork = |azimuth: f64, radius: f64| {
        let mut vessels = plain();
        (vessels[1].0, vessels[1].2) = (azimuth, [radius; 2]);
        cluster(Point3::origin(), turned(azimuth), 0.0, vessels)
    };
    // Eight in one cell; eight in another and one beside it; three in three cells near each other; one alone.
    let alike = (0..8).map(|i| fork(122.0 + 0.5 * f64::from(i), 0.95));
    let similar = [95.0, 96.0, 98.0, 104.0, 95.5, 96.5, 97.0, 97.5, 92.0].map(|azimuth| fork(azimuth, 0.5));
    let loose = [(92.0, 0.26), (92.0, 0.29), (102.0, 0.26)].map(|(azimuth, radius)| fork(azimuth, radius));
    let clusters: Vec<Cluster> = alike.chain(similar).chain(loose).chain([fork(150.0, 0.1)]).collect();
    let cells_of = |count: u32| shared_cells(count, 1.0, |i| clusters[i as usize].clone());
    let cells = cells_of(21);
    let own = |i: u32| vec![own_cell(&clusters[i as usize]).expect("a cell")];
    assert_eq!(cells.chosen.len(), 3);
    for (forks, cell) in [(0..8, own(0)), (8..17, own(8))] {
        forks.for_each(|i| assert_eq!(cells.of(i), cell, "{i}"));
    }
    assert_ne!(own(16), own(8));
    let loose: Vec<ForkCell> = (17..20).flat_map(own).collect();
    for i in 17..20 {
        assert_eq!(cells.of(i)[..], cells.chosen[2..], "{i}");
    }
    assert!(loose.contains(&cells.chosen[2]) && loose[0] != loose[1] && loose[0] != loose[2]);
    // Two are not enough.
    assert!(cells.of(20).is_empty() && cells_of(2).chosen.is_empty() && cells_of(7).chosen.len() == 1);
    let image =
        |i: u32, cells: Vec<ForkCell>| super::fork(&Cluster { cells, ..clusters[i as usize].clone() }, &shared());
    assert!(image(0, own(0)).is_some() && image(0, Vec::new()).is_none() && image(16, cells.of(16)).is_some());
    // The second cell is tried if the first one has no image of the fork.
    assert!(image(0, vec![own(20)[0], own(0)[0]]).is_some() && image(0, own(20)).is_none());
}

#[test]
fn stretched_forks_have_fewer_tetrahedra() {
    let mut vessels = plain();
    for (_, length, _) in &mut vessels {
        *length += 0.8;
    }
    let input = cluster(Point3::origin(), turned(0.4), 0.0, vessels);
    let made = |stretch: f64| {
        let cells = shared_cells(8, stretch, |_| input.clone()).of(0);
        let input = Cluster { cells, ..input.clone() };
        let params = BlockParams { stretch, ..shared() };
        let mesh = mesh_cluster(ClusterId(0), &input, &params).expect("a cluster");
        assert!(mesh.is_image());
        Finished::of_cluster(mesh, |node| node.0).expect("its ends are on its boundary")
    };
    let [plain, stretched] = [1.0, 4.0].map(made);
    assert!(stretched.certificate.is_sound() && plain.joints.len() == stretched.joints.len());
    let [n, m] = [&plain, &stretched].map(|block| block.mesh.tets.len());
    assert!(10 * m < 9 * n, "{m} {n}");
    let [a, b] = [&plain, &stretched].map(volume);
    assert!((a / b - 1.0).abs() < 0.01, "{a} {b}");
}

#[test]
fn azimuths_beside_half_a_turn_are_near_each_other() {
    let fork = |azimuth: f64| {
        let mut vessels = plain();
        (vessels[1].0, vessels[2].0) = (azimuth, 60.0);
        cluster(Point3::origin(), turned(0.0), 0.0, vessels)
    };
    let clusters: Vec<Cluster> = (0..9).map(|i| fork(if i < 8 { 168.0 } else { -168.0 })).collect();
    let cells = shared_cells(9, 1.0, |i| clusters[i as usize].clone());
    assert_ne!(own_cell(&clusters[0]), own_cell(&clusters[8]));
    assert_eq!(cells.of(8), cells.of(0));
}
