//! Sound meshes of tetrahedra, made of hexahedral cells.

use anastomesh_verify::{Cap, Mesh};
use std::collections::HashMap;

/// Tetrahedra around the diagonal of a cell, by corners with bits x, y and z.
const KUHN: [[usize; 4]; 6] = [[0, 1, 3, 7], [0, 3, 2, 7], [0, 2, 6, 7], [0, 6, 4, 7], [0, 4, 5, 7], [0, 5, 1, 7]];

/// Mesh of the cells of a lattice that a function selects. The lattice is periodic in x if `is_ring`.
pub fn lattice(
    size: [i32; 3],
    is_ring: bool,
    position: &dyn Fn([i32; 3]) -> [f64; 3],
    has: &dyn Fn([i32; 3]) -> bool,
) -> Mesh {
    let mut mesh = Mesh::default();
    let mut numbers: HashMap<[i32; 3], u32> = HashMap::new();
    for i in 0..size[0] {
        for j in 0..size[1] {
            for k in 0..size[2] {
                if !has([i, j, k]) {
                    continue;
                }
                let corner = |c: usize| {
                    let at = [i + (c & 1) as i32, j + (c >> 1 & 1) as i32, k + (c >> 2) as i32];
                    if is_ring { [at[0] % size[0], at[1], at[2]] } else { at }
                };
                let corners: Vec<u32> = (0..8)
                    .map(|c| {
                        *numbers.entry(corner(c)).or_insert_with(|| {
                            mesh.points.push(position(corner(c)));
                            mesh.points.len() as u32 - 1
                        })
                    })
                    .collect();
                mesh.tets.extend(KUHN.map(|t| t.map(|c| corners[c])));
            }
        }
    }
    mesh
}

/// Block of cubes.
pub fn cuboid(size: [i32; 3]) -> Mesh {
    lattice(size, false, &|p| p.map(f64::from), &|_| true)
}

/// Ring of cells around the z axis, whose boundary is a torus.
pub fn torus() -> Mesh {
    let position = |[i, j, k]: [i32; 3]| {
        let (angle, radius) = (f64::from(i) * std::f64::consts::TAU / 8.0, 3.0 - f64::from(j) * 0.5);
        [radius * angle.cos(), radius * angle.sin(), 0.5 * f64::from(k)]
    };
    lattice([8, 2, 2], true, &position, &|_| true)
}

/// Number of corners of a tube's section.
const CORNERS: u32 = 16;

/// Tube along z of radius 1 with caps at both ends, named as of a network with nodes 0 and 1.
pub fn tube() -> Mesh {
    let mut mesh = Mesh::default();
    let ring = CORNERS + 1;
    for k in 0..4 {
        mesh.points.push([0.0, 0.0, f64::from(k)]);
        for i in 0..CORNERS {
            let angle = f64::from(i) * std::f64::consts::TAU / f64::from(CORNERS);
            mesh.points.push([angle.cos(), angle.sin(), f64::from(k)]);
        }
    }
    for k in 0..3 {
        for i in 0..CORNERS {
            let (low, high) = (k * ring, (k + 1) * ring);
            let (a, b) = (1 + i, 1 + (i + 1) % CORNERS);
            // Prisms are split from the smaller corner, so that neighbours agree.
            let (a, b, flip) = if a < b { (a, b, false) } else { (b, a, true) };
            let prism = [
                [low, low + a, low + b, high + b],
                [low, low + a, high + b, high + a],
                [low, high + a, high + b, high],
            ];
            mesh.tets.extend(prism.map(|[p, q, r, s]| if flip { [p, r, q, s] } else { [p, q, r, s] }));
        }
    }
    label(&mut mesh, &|[p, q, r]| match [p[2], q[2], r[2]] {
        [0.0, 0.0, 0.0] => 2,
        [3.0, 3.0, 3.0] => 3,
        _ => 1,
    });
    mesh.patches = vec![(1, "wall".into()), (2, "inlet".into()), (3, "outlet_0".into())];
    mesh.caps = [(2, 0, 0.0, -1.0), (3, 1, 3.0, 1.0)]
        .map(|(patch, node, z, up)| Cap { patch, node, center: [0.0, 0.0, z], normal: [0.0, 0.0, up], radius: 1.0 })
        .to_vec();
    mesh.expected_loops = Some(vec![0]);
    mesh.expected_terminals = Some(vec![0, 1]);
    mesh
}

/// Labels the faces of single tetrahedra.
pub fn label(mesh: &mut Mesh, patch: &dyn Fn([[f64; 3]; 3]) -> i64) {
    let mut faces: HashMap<[u32; 3], Vec<[u32; 3]>> = HashMap::new();
    for t in &mesh.tets {
        for side in [[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]] {
            let face = side.map(|i: usize| t[i]);
            let mut key = face;
            key.sort_unstable();
            faces.entry(key).or_default().push(face);
        }
    }
    let mut outer: Vec<[u32; 3]> = faces.into_values().filter(|list| list.len() == 1).flatten().collect();
    outer.sort_unstable();
    mesh.labels = outer.iter().map(|face| patch(face.map(|v| mesh.points[v as usize]))).collect();
    mesh.triangles = outer;
}

/// Adds another mesh without labels, moved.
pub fn add(mesh: &mut Mesh, other: &Mesh, shift: [f64; 3]) {
    let count = mesh.points.len() as u32;
    mesh.points.extend(other.points.iter().map(|p| [p[0] + shift[0], p[1] + shift[1], p[2] + shift[2]]));
    mesh.tets.extend(other.tets.iter().map(|t| t.map(|v| v + count)));
}

/// Text of a VTU file with the mesh.
pub fn vtu(mesh: &Mesh) -> String {
    let floats = |list: &[[f64; 3]]| list.as_flattened().iter().map(|x| format!("{x} ")).collect::<String>();
    let whole = |list: &mut dyn Iterator<Item = i64>| list.map(|n| format!("{n} ")).collect::<String>();
    let array = |kind: &str, name: &str, text: String| {
        format!("<DataArray type=\"{kind}\" Name=\"{name}\" format=\"ascii\">{text}</DataArray>\n")
    };
    let (tets, triangles) = (mesh.tets.len(), mesh.triangles.len());
    let vertices = mesh.tets.as_flattened().iter().chain(mesh.triangles.as_flattened());
    let ends = (1..=tets).map(|i| 4 * i).chain((1..=triangles).map(|i| 4 * tets + 3 * i));
    let types = (0..tets + triangles).map(|i| if i < tets { 10 } else { 5 });
    let mut fields = String::new();
    if let (Some(loops), Some(terminals)) = (&mesh.expected_loops, &mesh.expected_terminals) {
        let names = mesh.patches.iter().fold(String::from("lumen\0"), |all, (_, name)| all + name + "\0");
        fields += &array("UInt8", "patch_names", whole(&mut names.bytes().map(i64::from)));
        fields += &array("Int64", "expected_loops", whole(&mut loops.iter().copied()));
        fields += &array("Int64", "expected_terminals", whole(&mut terminals.iter().copied()));
        fields += &array("Int64", "cap_patch", whole(&mut mesh.caps.iter().map(|cap| cap.patch)));
        fields += &array("Int64", "cap_node", whole(&mut mesh.caps.iter().map(|cap| cap.node)));
        let of = |get: fn(&Cap) -> [f64; 3]| floats(&mesh.caps.iter().map(get).collect::<Vec<_>>());
        fields += &array("Float64", "cap_center", of(|cap| cap.center));
        fields += &array("Float64", "cap_normal", of(|cap| cap.normal));
        let radii: String = mesh.caps.iter().map(|cap| format!("{} ", cap.radius)).collect();
        fields += &array("Float64", "cap_radius", radii);
    }
    let labels = std::iter::repeat_n(0, tets).chain(mesh.labels.iter().copied());
    format!(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\">\n\
         <UnstructuredGrid>\n<FieldData>\n{fields}</FieldData>\n<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n\
         <Points>\n{}</Points>\n<Cells>\n{}{}{}</Cells>\n<CellData>\n{}</CellData>\n</Piece></UnstructuredGrid></VTKFile>\n",
        mesh.points.len(),
        tets + triangles,
        array("Float64", "Points", floats(&mesh.points)).replace("Name", "NumberOfComponents=\"3\" Name"),
        array("Int64", "connectivity", whole(&mut vertices.map(|&v| i64::from(v)))),
        array("Int64", "offsets", whole(&mut ends.map(|n| n as i64))),
        array("UInt8", "types", whole(&mut types.into_iter())),
        array("Int32", "patch", whole(&mut labels.into_iter())),
    )
}
