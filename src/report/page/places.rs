//! How large the surroundings of a place are that show what it belongs to.

use anastomesh_mesh::geometry::Point3;
use anastomesh_mesh::source::MeshSource;
use std::collections::BinaryHeap;
use std::io;

/// Faces of the boundary that are seen about a place.
const FACES: usize = 500;

/// For each place the distance within which some hundred faces of the boundary begin; of a smaller mesh all.
///
/// # Errors
/// What reading the mesh fails with.
pub fn extents(mesh: &dyn MeshSource, places: &[Point3]) -> io::Result<Vec<f64>> {
    // Distances of what is nearest so far, the largest on top. Bits of numbers that are not negative are in their order.
    let mut nearest: Vec<BinaryHeap<u64>> = vec![BinaryHeap::with_capacity(FACES + 1); places.len()];
    mesh.each_face_corners(|corners| {
        for [corner, ..] in corners {
            for (place, heap) in places.iter().zip(&mut nearest) {
                let distance = (corner - place).norm().to_bits();
                if heap.len() < FACES || heap.peek().is_some_and(|&most| distance < most) {
                    heap.push(distance);
                    if heap.len() > FACES {
                        heap.pop();
                    }
                }
            }
        }
        Ok(())
    })?;
    let extent = |heap: &BinaryHeap<u64>| heap.peek().map_or(1.0, |&bits| f64::from_bits(bits));
    Ok(nearest.iter().map(extent).map(|x| if x > 0.0 && x.is_finite() { x } else { 1.0 }).collect())
}
