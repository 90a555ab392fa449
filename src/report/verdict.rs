//! Verdict of a run: its last line.

use crate::fidelity::share;
use crate::pipeline::{RunReport, named};
use crate::run::Defect;
use anastomesh_mesh::check::text::{verdict, violation};
use anastomesh_mesh::check::{CheckReport, Verdict as Validity};
use anastomesh_mesh::units::{counted, number};
use anastomesh_network::{NameOf, RefineReport};

/// Result of a run in one line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Verdict {
    /// True if the result is what was asked for.
    pub is_good: bool,
    /// The line: the result, with the reason if it is not a success.
    pub text: String,
}

impl Verdict {
    /// Success.
    pub fn good(text: impl Into<String>) -> Self {
        Self { is_good: true, text: text.into() }
    }

    /// A result that is not what was asked for.
    pub fn bad(text: impl Into<String>) -> Self {
        Self { is_good: false, text: text.into() }
    }

    /// Verdict of a validity check.
    pub fn of_check(check: &CheckReport) -> Self {
        let text = verdict(check.verdict);
        if check.verdict != Validity::Invalid {
            return Self::good(text);
        }
        let mut failed = check.failed();
        let first = failed.next().map_or_else(String::new, |line| format!(": {}", violation(line)));
        let others = match failed.count() {
            0 => String::new(),
            n => format!("; {} failed, too", counted(n, "other condition")),
        };
        Self::bad(format!("{text}{first}{others}"))
    }

    /// Verdict of a run that made a mesh or a surface, with the defects that are not accepted.
    pub fn of_mesh(check: &CheckReport, run: &RunReport, defects: &[&Defect], name: NameOf) -> Self {
        let validity = Self::of_check(check);
        if !run.failed.is_empty() {
            return Self::bad(format!("NOT complete: {}", missing(run, name)));
        }
        match (validity.is_good, unfaithful(defects, run, name)) {
            (_, None) => validity,
            (true, Some(reasons)) => Self::bad(format!("not faithful: {reasons}")),
            (false, Some(reasons)) => Self::bad(format!("{}; not faithful: {reasons}", validity.text)),
        }
    }

    /// Verdict of a refinement. `ensures`: an overlap that is left is a failure.
    pub fn of_refinement(report: &RefineReport, ensures: bool, defects: &[&Defect], name: NameOf) -> Self {
        let left = report.residual.left;
        let overlaps = match left {
            0 => "no vessels overlap".to_owned(),
            n => format!("{} left", counted(n, "overlapping pair")),
        };
        match (ensures && left > 0, unfaithful(defects, &RunReport::default(), name)) {
            (false, None) => Self::good(overlaps),
            (true, None) => Self::bad(format!("NOT refined: {overlaps}")),
            (false, Some(reasons)) => Self::bad(format!("not faithful: {reasons}")),
            (true, Some(reasons)) => Self::bad(format!("NOT refined: {overlaps}; not faithful: {reasons}")),
        }
    }
}

/// Number of failed blocks, with the reason of the first.
pub fn missing(run: &RunReport, name: NameOf) -> String {
    let blocks = counted(run.failed.len(), "block");
    let first = run.failed.first().map_or_else(String::new, |failed| {
        let first = if run.failed.len() > 1 { "first " } else { "" };
        format!(": {first}{} (nodes {})", failed.reason, named(&failed.nodes, name))
    });
    format!("{blocks} could not be meshed{first}")
}

/// Reasons why a result does not represent its network; `None` if it does.
fn unfaithful(defects: &[&Defect], run: &RunReport, name: NameOf) -> Option<String> {
    let reasons: Vec<String> = defects.iter().filter_map(|defect| reason(defect, run, name)).collect();
    (!reasons.is_empty()).then(|| reasons.join("; "))
}

/// Reason of a defect of fidelity; `None` for other defects.
pub fn reason(defect: &Defect, run: &RunReport, name: NameOf) -> Option<String> {
    let radii = |x: f64| number((1000.0 * x).round() / 1000.0);
    Some(match defect {
        Defect::MissingBlocks(_) | Defect::Invalid => return None,
        Defect::VesselsNotKept => {
            let blocks = |count: usize| counted(count, "block");
            let [outside, fused] = [
                run.fused.iter().filter(|f| f.astray.outside.is_some()).count(),
                run.fused.iter().filter(|f| f.is_one_lumen()).count(),
            ];
            match (outside, fused) {
                (0, n) => format!("separate vessels fused into one lumen in {}", blocks(n)),
                (n, _) => format!("a vessel axis lies outside the wall in {}", blocks(n)),
            }
        }
        Defect::Displaced { bound, p99, places } => match places.first() {
            Some(place) if p99 <= bound => {
                let (far, node) = (radii(place.radii), name(place.node));
                format!("axis displaced by {far} radii at node {node} (limit {bound})")
            }
            _ => format!("axis displaced by {} radii at 99 % (limit {bound})", radii(*p99)),
        },
        Defect::Lumen { excess, bound } => {
            let than = if *excess < 0.0 { "smaller" } else { "larger" };
            format!("lumen {} {than} than the given network (limit {})", share(*excess), number(100.0 * bound) + " %")
        }
        Defect::Dropped { vessels, bound } => {
            let (far, node) = (radii(vessels.worst), name(vessels.node));
            format!("{far} radii of the vessel of tip {node} dropped (limit {bound})")
        }
        Defect::Extended { tips, bound } => {
            let (far, node) = (radii(tips.worst), name(tips.node));
            format!("tip {node} extended by {far} lengths of its vessel (limit {bound})")
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fidelity::{Change, Displaced};
    use anastomesh_mesh::check::check_tets;
    use anastomesh_mesh::shapes::cube_lattice;

    fn line(check: &CheckReport, defects: &[&Defect]) -> String {
        Verdict::of_mesh(check, &RunReport::default(), defects, &|node| format!("n{node}")).text
    }

    #[test]
    fn the_reason_stands_in_the_verdict() {
        let sound = check_tets(&cube_lattice(2), None);
        assert_eq!(line(&sound, &[]), "no fault found, but some conditions were skipped");
        let lumen = Defect::Lumen { excess: 0.1234, bound: 0.1 };
        assert_eq!(line(&sound, &[&lumen]), "not faithful: lumen 12.3 % larger than the given network (limit 10 %)");
        let place = Displaced { given: [3, 4], node: 4, place: [0.0; 3], meshed: [3, 4], radii: 1.5 };
        let displaced = Defect::Displaced { bound: 1.0, p99: 0.4, places: vec![place] };
        let dropped = Defect::Dropped { vessels: Change { count: 2, worst: 16.25, node: 7 }, bound: 2.0 };
        assert_eq!(
            line(&sound, &[&displaced, &dropped]),
            "not faithful: axis displaced by 1.5 radii at node n4 (limit 1); 16.25 radii of the vessel of tip n7 dropped (limit 2)"
        );
        let mut mesh = cube_lattice(2);
        mesh.tets[0].swap(0, 1);
        let broken = check_tets(&mesh, None);
        let said = line(&broken, &[&lumen]);
        assert!(said.starts_with("NOT valid: 1 tetrahedron is inverted or flat"), "{said}");
        assert!(said.ends_with("; not faithful: lumen 12.3 % larger than the given network (limit 10 %)"), "{said}");
    }
}
