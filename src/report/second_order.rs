//! Report of second-order elements.

use super::rows::row;
use anastomesh_mesh::second_order::Curving;
use anastomesh_mesh::units::{counted, grouped};

/// Midpoints of curved edges, midpoints pulled back, and the least scaled Jacobian.
pub fn of_midpoints(curving: &Curving) -> String {
    let Curving { midpoints, curved, pulled, straightened, least_scaled } = *curving;
    let pulled = match (pulled, straightened) {
        (0, _) => "none pulled back".into(),
        (n, 0) => format!("{} pulled back", grouped(n)),
        (n, m) => format!("{} pulled back, {} of them to straight edges", grouped(n), grouped(m)),
    };
    let curved = format!("{} of {} on curved edges", grouped(curved), counted(midpoints, "midpoint"));
    row("order 2", &format!("{curved}, {pulled}; scaled Jacobian min {least_scaled:.2}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pulled_midpoints_are_told() {
        let curving = Curving { midpoints: 1200, curved: 30, pulled: 0, straightened: 0, least_scaled: 0.5 };
        assert!(
            of_midpoints(&curving)
                .contains("30 of 1,200 midpoints on curved edges, none pulled back; scaled Jacobian min 0.50")
        );
        assert!(of_midpoints(&Curving { pulled: 4, ..curving }).contains("edges, 4 pulled back; scaled"));
        let straight = Curving { pulled: 4, straightened: 1, ..curving };
        assert!(of_midpoints(&straight).contains("4 pulled back, 1 of them to straight edges; scaled"));
    }
}
