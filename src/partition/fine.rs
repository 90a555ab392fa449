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

#[cfg(test)]
mod tests {
    use super::*;
    use anastomesh_mesh::geometry::Point3;
    use anastomesh_skeleton::FinePlace;

    #[test]
    fn stations_of_a_branch_are_consecutive() {
        let place = FinePlace { at: Point3::origin(), within: 1.0, factor: 0.5 };
        let station = |branch| FineStation { branch, arc: f64::from(branch), usual: 1.0, asked: 0.5, place };
        let stations = [1, 1, 3, 3, 3, 4].map(station);
        let count = |branch| {
            let own = of_branch(&stations, branch);
            assert!(own.iter().all(|station| station.branch == branch));
            own.len()
        };
        assert_eq!([0, 1, 2, 3, 4, 5].map(count), [0, 2, 0, 3, 1, 0]);
    }
}
