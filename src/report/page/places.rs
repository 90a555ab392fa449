//! Size of the region around a point that shows its context.

use anastomesh_mesh::geometry::Point3;
use anastomesh_mesh::source::MeshSource;
use std::collections::BinaryHeap;
use std::io;

/// Number of boundary faces visible around a point.
const FACES: usize = 500;

/// Distance from each point within which `FACES` boundary faces start, or all faces of a smaller mesh.
///
/// # Errors
/// The mesh cannot be read.
pub fn extents(mesh: &dyn MeshSource, places: &[Point3]) -> io::Result<Vec<f64>> {
    // Max-heaps of the smallest distances. Bits of non-negative floats sort like their values.
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
