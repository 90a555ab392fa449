use super::*;
use crate::{Point3, TetMesh, VolumeMesh};

/// Two layers at the wall triangles `[0, 1, 2]` and `[2, 1, 3]`, whose copies are 4 to 7 and 8 to 11.
fn two_stacks() -> VolumeMesh {
    let prism = |[a, b, c]: [u32; 3], layer: u32, turned: bool| {
        let (o, i) = (|v: u32| v + 4 * layer, |v: u32| v + 4 * layer + 4);
        let tets = [[o(b), o(a), o(c), i(c)], [o(a), o(b), i(b), i(c)], [i(a), o(a), i(b), i(c)]];
        tets.map(|tet| plain(tet, turned))
    };
    let tets = [([0, 1, 2], false), ([1, 2, 3], true)]
        .into_iter()
        .flat_map(|(triangle, turned)| [0, 1].map(|layer| prism(triangle, layer, turned)))
        .flatten()
        // A tetrahedron of the core.
        .chain([[8, 9, 10, 12]])
        .collect();
    let mesh = TetMesh { points: vec![Point3::origin(); 13], tets };
    let boundary = vec![[0, 1, 2], [2, 1, 3]];
    VolumeMesh { mesh, boundary, boundary_patch: vec![WALL; 2], ..VolumeMesh::default() }
}

fn found(volume: &VolumeMesh) -> Vec<(usize, LayerCell)> {
    in_part(&volume.mesh.tets, &volume.boundary(0).unwrap()).0
}

#[test]
fn three_tetrahedra_of_a_layer_are_a_prism() {
    let volume = two_stacks();
    let cells = found(&volume);
    let bases: Vec<_> = cells.iter().map(|(at, cell)| (*at, cell.tets, cell.base, cell.top)).collect();
    assert_eq!(
        bases,
        [
            (0, 3, [0, 1, 2], [4, 5, 6]),
            (3, 3, [4, 5, 6], [8, 9, 10]),
            (6, 3, [1, 2, 3], [5, 6, 7]),
            (9, 3, [5, 6, 7], [9, 10, 11])
        ]
    );
    let cells = Cells::of(&volume).unwrap().unwrap();
    let numbers: Vec<u32> = (0..13).map(|tet| cells.of_tet(tet)).collect();
    assert_eq!(numbers, [0, 0, 0, 1, 1, 1, 2, 2, 2, 3, 3, 3, 4]);
    assert_eq!((cells.len(), cells.is_empty()), (5, false));
}

#[test]
fn two_tetrahedra_are_a_pyramid_if_the_next_layer_has_its_apex() {
    // Vertex 0 has no copies.
    let mut volume = two_stacks();
    let of_layer = |layer: u32| {
        let (o, i) = (|v: u32| v + 4 * layer, |v: u32| v + 4 * layer + 4);
        [[o(1), 0, o(2), i(2)], [0, o(1), i(1), i(2)]]
    };
    let pyramids = [of_layer(0), of_layer(1)].concat();
    volume.mesh.tets.splice(..6, pyramids);
    let cells = found(&volume);
    assert_eq!(cells[0], (0, LayerCell { tets: 2, base: [0, 1, 2], top: [0, 5, 6] }));
    assert_eq!(cells[1], (2, LayerCell { tets: 2, base: [0, 5, 6], top: [0, 9, 10] }));
    assert_eq!(cells[0].1.pyramid(), Some([1, 2, 6, 5, 0]));
    assert_eq!((cells[2].0, cells.len()), (4, 4));
    // A single layer does not show it.
    volume.mesh.tets.drain(2..4);
    assert_eq!(found(&volume)[0].0, 2);
}

#[test]
fn layers_are_counted_from_the_wall() {
    let volume = two_stacks();
    let layers = layers_in(&volume.mesh.tets, &volume.boundary(0).unwrap());
    assert_eq!(layers, [1, 1, 1, 2, 2, 2, 1, 1, 1, 2, 2, 2, 0]);
}

#[test]
fn tetrahedra_in_another_order_are_no_layers() {
    let mut volume = two_stacks();
    volume.mesh.tets.reverse();
    assert!(Cells::of(&volume).unwrap().is_none());
    let mut volume = two_stacks();
    volume.boundary_patch = vec![WALL + 1; 2];
    assert!(Cells::of(&volume).unwrap().is_none());
}
