use super::*;
use crate::volume::fixtures::{labelled_tube, slab};
use crate::volume::in_pieces::InPieces;
use anastomesh_mesh::VolumeMesh;
use anastomesh_mesh::shapes::tube_lattice;
use anastomesh_mesh::source::MeshSource;
use anastomesh_mesh::stacks::Cells;
use std::num::NonZeroUsize;

fn divided(mesh: &dyn MeshSource, parts: usize) -> Partition {
    Partition::of(mesh, NonZeroUsize::new(parts).unwrap(), None).unwrap()
}

/// A long tube in blocks of this many tetrahedra.
fn tube_in_blocks(size: usize) -> VolumeMesh {
    let mesh = tube_lattice(3, 60, 0.3);
    VolumeMesh {
        tet_block: (0..mesh.tets.len()).map(|tet| (tet / size) as i32).collect(),
        mesh,
        ..VolumeMesh::default()
    }
}

/// Checks the numbers of all cells, and returns the largest part and the smallest.
fn sizes(mesh: &dyn MeshSource, parts: usize) -> [u32; 2] {
    let partition = divided(mesh, parts);
    let mut lookup = partition.lookup();
    let mut next = vec![0; parts];
    for cell in 0..mesh.counts().tets as u32 {
        let (part, local) = lookup.locate(cell);
        assert_eq!(local, next[part as usize], "cells keep their order");
        next[part as usize] += 1;
    }
    assert_eq!(next, partition.sizes());
    for part in 0..parts as u32 {
        let cells = partition.cells_of(part);
        assert!(cells.is_sorted() && cells.len() == next[part as usize] as usize);
        assert!(cells.iter().all(|&cell| partition.lookup().locate(cell).0 == part));
    }
    [next.iter().max(), next.iter().min()].map(|size| *size.unwrap())
}

#[test]
fn parts_are_balanced() {
    for size in [50, 700, 1_000_000] {
        let mesh = tube_in_blocks(size);
        for parts in [1, 2, 3, 8, 29] {
            let mean = mesh.mesh.tets.len() as f64 / parts as f64;
            let [largest, smallest] = sizes(&mesh, parts).map(f64::from);
            assert!(largest <= 1.03 * mean + 1.0 && smallest >= 0.97 * mean - 1.0, "{size} {parts}");
        }
    }
    let (volume, _) = labelled_tube(1);
    let all = volume.mesh.tets.len();
    assert_eq!(sizes(&volume, all), [1, 1]);
}

#[test]
fn cuts_lie_between_blocks_if_their_ends_are_near() {
    let mesh = tube_in_blocks(tube_in_blocks(1).mesh.tets.len() / 16 + 1);
    let partition = divided(&mesh, 4);
    assert!(partition.runs_of(1).all(|run| run.only_part() == Some(1)));
    assert!(divided(&mesh, 5).runs_of(1).any(|run| run.only_part().is_none()));
}

#[test]
fn a_part_of_a_tube_is_connected() {
    // A tube is cut across.
    let mesh = tube_in_blocks(usize::MAX);
    let partition = divided(&mesh, 4);
    let mut lookup = partition.lookup();
    let part_of: Vec<u32> = (0..mesh.mesh.tets.len() as u32).map(|cell| lookup.locate(cell).0).collect();
    let extent = |part: u32| {
        let of_part = mesh.mesh.tets.iter().zip(&part_of).filter(|(_, own)| **own == part);
        let heights = of_part.flat_map(|(tet, _)| tet.map(|v| mesh.mesh.points[v as usize].z));
        heights.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], z| [low.min(z), high.max(z)])
    };
    let total: f64 = (0..4).map(extent).map(|[low, high]| high - low).sum();
    assert!(total < 1.5 * 60.0 * 0.3, "{total}");
}

#[test]
fn parts_of_a_source_in_pieces_are_divided_too() {
    let (volume, _) = labelled_tube(9);
    for sizes_of_pieces in [vec![7, 300], vec![1000]] {
        let pieces = InPieces { volume: &volume, sizes: &sizes_of_pieces };
        sizes(&pieces, 5);
    }
}

#[test]
fn prisms_stay_whole() {
    let volume = slab();
    let cells = Cells::of(&volume).unwrap().unwrap();
    let partition = Partition::of(&volume, NonZeroUsize::new(3).unwrap(), Some(&cells)).unwrap();
    assert_eq!(partition.sizes().iter().sum::<u32>(), 4);
    let error = Partition::of(&volume, NonZeroUsize::new(5).unwrap(), Some(&cells)).unwrap_err();
    assert_eq!(
        error.get_ref().unwrap().downcast_ref::<PartsError>(),
        Some(&PartsError::TooFewCells { parts: 5, cells: 4 })
    );
}
