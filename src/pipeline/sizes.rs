//! Note on edges whose length differs from the resolution.

use super::plan::{MOST_STRETCH, MeshPlan};
use crate::partition::Layout;
use anastomesh_mesh::progress::Progress;
use anastomesh_mesh::units::counted;
use anastomesh_skeleton::{EdgeId, FineStation, LEAST_SIZE, SizeAt, Skeleton};

/// Share of the vessels with shorter edges above which a finer resolution is cheaper: no vessel is cut there.
const MANY: f64 = 0.5;

/// Reports the numbers of finer forks and stretched tubes, and of those that exceed the limits.
pub(super) fn announce(skeleton: &Skeleton, partition: &Layout, plan: &MeshPlan, observer: &dyn Progress) {
    let Some(sizes) = &plan.size_at else { return };
    if let SizeAt::Field(field) = sizes {
        let text = of_field(partition.fine_stations(), skeleton, plan.rho);
        return observer.note(&format!("sizes-from {}: {text}", field.array()));
    }
    let forks: Vec<f64> = partition.clusters().flat_map(|cluster| cluster.fine).map(|fork| fork.factor).collect();
    let mut parts = vec![match range(&forks) {
        Some(range) => format!("edge length at {} multiplied by {range}", counted(forks.len(), "fork")),
        None => "no shorter edges at forks".to_owned(),
    }];
    if let SizeAt::Nodes(_) = sizes {
        let asked = partition.clusters().map(|cluster| cluster.size).chain(partition.cuts().map(|cut| cut.size));
        let asked: Vec<f64> = asked.flatten().filter(|&size| size > 1.0).collect();
        let tubes: Vec<f64> = asked.iter().map(|&size| size.min(MOST_STRETCH)).collect();
        parts.push(match range(&tubes) {
            Some(range) => format!("{} stretched by {range}", counted(tubes.len(), "tube")),
            None => "no stretched tubes".to_owned(),
        });
        let adjacency = skeleton.adjacency();
        let is_below =
            |&node: &_| adjacency.valence(node) > 2 && sizes.at_fork(skeleton.node(node).original) < LEAST_SIZE;
        let below = skeleton.node_ids().filter(is_below).count();
        let above = asked.iter().filter(|&&size| size > MOST_STRETCH).count();
        if below + above > 0 {
            parts.push(format!(
                "limited to the range {LEAST_SIZE} to {MOST_STRETCH}: {} and {}",
                counted(below, "fork"),
                counted(above, "tube")
            ));
        }
    }
    observer.note(&format!("size-at: {}", parts.join("; ")));
}

/// Effect of a size field.
fn of_field(stations: &[FineStation], skeleton: &Skeleton, rho: f64) -> String {
    let factors: Vec<f64> = stations.iter().map(|station| station.place.factor).collect();
    let Some(range) = range(&factors) else {
        return format!("edges are at most as long as requested everywhere with rho {rho}");
    };
    let mut parts = vec![format!("edge length at {} multiplied by {range}", counted(stations.len(), "place"))];
    let below = stations.iter().filter(|station| station.asked < LEAST_SIZE).count();
    if below > 0 {
        parts.push(format!("at {below} of them the field requests less: a larger --rho gives it"));
    }
    // Places are a radius apart.
    let tubes = (0..skeleton.edges.len() as u32).map(|edge| skeleton.tube(EdgeId(edge)));
    let radii: f64 = tubes.map(|tube| 2.0 * tube.length() / (tube.ra + tube.rb)).sum();
    if stations.len() as f64 > MANY * radii {
        let mut asked: Vec<f64> = stations.iter().map(|station| station.asked).collect();
        let middle = asked.len() / 2;
        let (_, median, _) = asked.select_nth_unstable_by(middle, f64::total_cmp);
        parts.push(format!("most vessels need shorter edges, which --rho {:.1} gives at less cost", rho / *median));
    }
    parts.join("; ")
}

/// Range of numbers as `0.5` or `0.3 to 0.9`; `None` without numbers.
fn range(values: &[f64]) -> Option<String> {
    let least = values.iter().copied().reduce(f64::min)?;
    let most = values.iter().copied().reduce(f64::max)?;
    let short = |x: f64| format!("{}", (1000.0 * x).round() / 1000.0);
    Some(if least == most { short(least) } else { format!("{} to {}", short(least), short(most)) })
}
