//! Validity check of small meshes with damage: turned, dropped, copied and changed tetrahedra, moved, merged and copied
//! points. A simple check in integers finds the same faults.
#![no_main]

use anastomesh_fuzz::stay_on_this_thread;
use anastomesh_mesh::adjacency::{boundary_faces, tet_adjacency};
use anastomesh_mesh::check::parts::{PartView, certify_with};
use anastomesh_mesh::check::{CheckReport, Expectation, Line, Verdict, check_tets, check_volume};
use anastomesh_mesh::{Patch, Point3, TetMesh, VolumeMesh, WALL};
use anastomesh_tet::parts::delaunay;
use libfuzzer_sys::fuzz_target;
use std::collections::{BTreeMap, BTreeSet};

fuzz_target!(|bytes: &[u8]| {
    stay_on_this_thread();
    let [count, rest @ ..] = bytes else { return };
    let (places, damage) = rest.split_at((2 * (4 + usize::from(count & 15))).min(rest.len()));
    let Some(mut mesh) = delaunay_mesh(places) else { return };
    for &[kind, a, b] in damage.as_chunks::<3>().0.iter().take(8) {
        harm(&mut mesh, kind, usize::from(a), usize::from(b));
    }
    verify(&mesh);
});

/// Makes a mesh of distinct points on a grid of 16³ points.
fn delaunay_mesh(bytes: &[u8]) -> Option<TetMesh> {
    let places: BTreeSet<[u8; 3]> = bytes.chunks_exact(2).map(|b| [b[0] & 15, b[0] >> 4, b[1] & 15]).collect();
    let points: Vec<Point3> = places.into_iter().map(|p| p.map(f64::from).into()).collect();
    Some(delaunay(&points).ok()?.into_mesh())
}

/// Damages a mesh. Coordinates remain small integers.
fn harm(mesh: &mut TetMesh, kind: u8, a: usize, b: usize) {
    let (tets, points) = (mesh.tets.len(), mesh.points.len());
    if tets == 0 {
        return;
    }
    let (tet, corner) = (a % tets, b & 3);
    match kind % 9 {
        0 => mesh.tets[tet].swap(corner, (corner + 1) % 4),
        1 => {
            mesh.tets.remove(tet);
        }
        2 => mesh.tets.push(mesh.tets[tet]),
        3 => mesh.tets[tet][corner] = (b / 4 % points) as u32,
        4 => mesh.points[a % points] = Point3::new((b & 15) as f64, (b >> 4) as f64, f64::from(kind / 9)),
        5 => mesh.points[a % points] = mesh.points[b % points],
        6 => {
            let (from, to) = ((a % points) as u32, (b % points) as u32);
            mesh.tets.as_flattened_mut().iter_mut().filter(|v| **v == from).for_each(|v| *v = to);
        }
        7 => {
            // The corner gets a point of its own at the same place.
            mesh.points.push(mesh.points[mesh.tets[tet][corner] as usize]);
            mesh.tets[tet][corner] = points as u32;
        }
        _ => {
            // A tetrahedron on a face of another one.
            let mut new = mesh.tets[tet];
            new.swap(0, 1);
            new[corner] = points as u32;
            mesh.points.push(Point3::new((b & 15) as f64, (b >> 4) as f64, f64::from(kind / 9)));
            mesh.tets.push(new);
        }
    }
}

fn verify(mesh: &TetMesh) {
    let report = check_tets(mesh, None);
    let failed: BTreeSet<Line> = report.failed().map(|result| result.line).collect();
    let simple = faults(mesh);
    let invalid = report.verdict == Verdict::Invalid;
    assert!(simple.is_empty() || invalid, "the check misses {simple:?}\n{mesh:?}");
    if mesh.tets.is_empty() {
        return;
    }
    for (line, name) in EXACT {
        assert_eq!(failed.contains(&line), simple.contains(name), "{name}\n{mesh:?}");
    }
    let others = [Line::NoSelfIntersection];
    assert!(!simple.is_empty() || failed.iter().all(|line| others.contains(line)), "{failed:?}\n{mesh:?}");
    assert!(!overlaps(mesh) || invalid, "tetrahedra overlap\n{mesh:?}");
    verify_labelled(mesh, &report);
    // Nested surfaces are a property of all parts together.
    let view = PartView { mesh, joints: &[], caps: &[] };
    let part = certify_with(&view, || tet_adjacency(&mesh.tets, mesh.points.len()));
    assert!(part.is_sound() || invalid, "{:?}\n{mesh:?}", part.broken_line());
    assert!(!part.is_sound() || failed.iter().all(|line| others.contains(line)), "{failed:?}\n{mesh:?}");
}

/// Checks the mesh with its boundary as wall. The conditions on the mesh have the same results.
fn verify_labelled(mesh: &TetMesh, report: &CheckReport) {
    let boundary = boundary_faces(mesh);
    let volume = VolumeMesh {
        mesh: mesh.clone(),
        tet_block: vec![0; mesh.tets.len()],
        boundary_block: vec![0; boundary.len()],
        boundary_patch: vec![WALL; boundary.len()],
        boundary,
        patches: vec![Patch { id: WALL, name: "wall".into(), cap: None }],
    };
    let loops = vec![0; report.counts.components];
    let labelled = check_volume(&volume, Some(&Expectation { loops, terminals: Vec::new() }));
    for result in &report.lines {
        let other = labelled.line(result.line).map(|other| other.outcome);
        assert!(other == Some(result.outcome) || result.line >= Line::Components, "{:?}\n{mesh:?}", result.line);
    }
    assert!(report.verdict != Verdict::Invalid || labelled.verdict == Verdict::Invalid);
}

/// Conditions that both checks test in the same way.
const EXACT: [(Line, &str); 6] = [
    (Line::NoRepeatedVertex, "a repeated vertex"),
    (Line::NoDuplicateTets, "equal tetrahedra"),
    (Line::PositiveTets, "a tetrahedron that is not positive"),
    (Line::NoDuplicatePoints, "equal points"),
    (Line::NoUnusedPoints, "an unused point"),
    (Line::FacesSharedByTwo, "a face of three tetrahedra"),
];

/// Finds faults from definitions, in integers.
fn faults(mesh: &TetMesh) -> BTreeSet<&'static str> {
    let mut faults = BTreeSet::new();
    let mut add = |fault: &'static str, found: bool| {
        if found {
            faults.insert(fault);
        }
    };
    add("no tetrahedra", mesh.tets.is_empty());
    let places: Vec<[i64; 3]> = mesh.points.iter().map(place).collect();
    add("equal points", places.iter().collect::<BTreeSet<_>>().len() < places.len());
    let used: BTreeSet<u32> = mesh.tets.as_flattened().iter().copied().collect();
    add("an unused point", used.len() < places.len());
    let sorted = |t: &[u32; 4]| {
        let mut t = *t;
        t.sort_unstable();
        t
    };
    add("equal tetrahedra", mesh.tets.iter().map(sorted).collect::<BTreeSet<_>>().len() < mesh.tets.len());
    let mut faces: BTreeMap<[u32; 3], Vec<[u32; 3]>> = BTreeMap::new();
    for t in &mesh.tets {
        add("a repeated vertex", sorted(t).windows(2).any(|pair| pair[0] == pair[1]));
        add("a tetrahedron that is not positive", volume6(t.map(|v| places[v as usize])) <= 0);
        let [a, b, c, d] = *t;
        for face in [[b, c, d], [a, d, c], [a, b, d], [a, c, b]] {
            let mut key = face;
            key.sort_unstable();
            faces.entry(key).or_default().push(face);
        }
    }
    add("a face of three tetrahedra", faces.values().any(|of| of.len() > 2));
    let turns = |[a, b, c]: [u32; 3]| [[a, b, c], [b, c, a], [c, a, b]];
    add(
        "a face with both tetrahedra on one side",
        faces.values().any(|of| of.len() == 2 && turns(of[0]).contains(&of[1])),
    );
    let boundary: Vec<[u32; 3]> = faces.into_values().filter(|of| of.len() == 1).flatten().collect();
    // Each edge and the face that follows it around its first vertex.
    let mut edges: BTreeMap<[u32; 2], Vec<u32>> = BTreeMap::new();
    for &[a, b, c] in &boundary {
        for (from, to, apex) in [(a, b, c), (b, c, a), (c, a, b)] {
            edges.entry([from, to]).or_default().push(apex);
        }
    }
    let is_single = |edge: &[u32; 2]| edges.get(edge).is_some_and(|of| of.len() == 1);
    let is_closed = edges.keys().all(|&[a, b]| is_single(&[a, b]) && is_single(&[b, a]));
    add("a boundary edge that is not in two faces", !is_closed);
    if is_closed {
        let mut degree: BTreeMap<u32, usize> = BTreeMap::new();
        edges.keys().for_each(|edge| *degree.entry(edge[0]).or_default() += 1);
        add("two fans at a vertex", degree.iter().any(|(&v, &degree)| fan(&edges, v) < degree));
    }
    faults
}

/// Number of faces in the fan of a vertex that contains its first edge.
fn fan(edges: &BTreeMap<[u32; 2], Vec<u32>>, vertex: u32) -> usize {
    let Some((&[_, first], _)) = edges.range([vertex, 0]..).next() else { return 0 };
    let (mut at, mut faces) = (first, 0);
    loop {
        faces += 1;
        at = edges[&[vertex, at]][0];
        if at == first {
            return faces;
        }
    }
}

fn place(p: &Point3) -> [i64; 3] {
    [p.x as i64, p.y as i64, p.z as i64]
}

/// Six times the volume of a tetrahedron.
fn volume6([a, b, c, d]: [[i64; 3]; 4]) -> i64 {
    let [u, v, w] = [b, c, d].map(|p| [p[0] - a[0], p[1] - a[1], p[2] - a[2]]);
    u[0] * (v[1] * w[2] - v[2] * w[1]) + u[1] * (v[2] * w[0] - v[0] * w[2]) + u[2] * (v[0] * w[1] - v[1] * w[0])
}

/// Returns true if the centroid of a tetrahedron lies inside another one. Coordinates are multiplied by 4.
fn overlaps(mesh: &TetMesh) -> bool {
    let corners = |t: &[u32; 4]| t.map(|v| place(&mesh.points[v as usize]));
    let all: Vec<[[i64; 3]; 4]> = mesh.tets.iter().take(40).map(corners).collect();
    all.iter().enumerate().any(|(i, t)| {
        let centroid = std::array::from_fn(|k| t[0][k] + t[1][k] + t[2][k] + t[3][k]);
        let is_inside = |other: &[[i64; 3]; 4]| {
            let wide = other.map(|p| p.map(|x| 4 * x));
            (0..4).all(|k| {
                let mut part = wide;
                part[k] = centroid;
                volume6(part) > 0
            })
        };
        all.iter().enumerate().any(|(j, other)| i != j && is_inside(other))
    })
}
