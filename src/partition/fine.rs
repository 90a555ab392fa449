//! Places along vessels at which a size field requests shorter edges.

use anastomesh_skeleton::course::Courses;
use anastomesh_skeleton::{FineStation, SizeField};
use rayon::prelude::*;

/// Places with shorter edges along all branches, by branch and arc length.
pub(super) fn stations(courses: Courses, field: &SizeField, rho: f64) -> Vec<FineStation> {
    let of_branch = |branch| field.stations(branch, &courses.get(branch), rho);
    (0..courses.len() as u32).into_par_iter().flat_map_iter(of_branch).collect()
}

/// Those of one branch.
pub(super) fn of_branch(stations: &[FineStation], branch: u32) -> &[FineStation] {
    let from = stations.partition_point(|station| station.branch < branch);
    let count = stations[from..].partition_point(|station| station.branch == branch);
    &stations[from..from + count]
}
