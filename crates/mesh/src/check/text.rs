//! Text form of a check's result; its JSON form is `CheckReport` itself.

use super::result::{PRINTED_OFFENDERS, without};
use super::{CheckReport, LineResult, Offender, OffenderKind, Outcome, RegionCounts, Skipped, Verdict};
use crate::units::{counted, digits, grouped, place, tetrahedra};
use std::fmt::{self, Write as _};

/// Maximum offenders per condition in a summary.
const MAX_NAMED: usize = 3;

/// Text report: one line per condition, the first offenders of failed ones, sizes and shape, and finally the verdict.
impl fmt::Display for CheckReport {
    fn fmt(&self, out: &mut fmt::Formatter) -> fmt::Result {
        writeln!(out, "{}\n{}", conditions(self), sizes(self))?;
        self.regions.iter().try_for_each(|region| writeln!(out, "region {}: {}", region.name, region_sizes(region)))?;
        if let Some(shape) = shape(self) {
            writeln!(out, "{shape}")?;
        }
        writeln!(out, "{}", verdict(self.verdict))
    }
}

/// Sizes of a mesh.
pub fn sizes(check: &CheckReport) -> String {
    let counts = &check.counts;
    let tets = if counts.tets > 0 { tetrahedra(counts.tets) + ", " } else { String::new() };
    let (points, faces) = (counted(counts.points, "point"), counted(counts.boundary_faces, "boundary face"));
    let components = match counts.components {
        1 => String::new(),
        n => format!(", {}", counted(n, "component")),
    };
    let (caps, volume) = (counted(counts.caps, "cap"), digits(counts.volume));
    format!("{tets}{points}, {faces}, {caps}{components}, volume {volume}")
}

/// Sizes of a region.
pub fn region_sizes(region: &RegionCounts) -> String {
    let (components, faces) =
        (counted(region.components, "component"), counted(region.boundary_faces, "boundary face"));
    let touches = match region.touches {
        0 => String::new(),
        n => format!(", touches itself at {}", counted(n as usize, "place")),
    };
    format!("{}, {components}, {faces}{touches}, volume {}", tetrahedra(region.tets), digits(region.volume))
}

/// Quality of the tetrahedra.
pub fn shape(check: &CheckReport) -> Option<String> {
    let q = check.quality.as_ref()?;
    let angles = format!("dihedral angles {:.0}° to {:.0}°", q.dihedral_min, q.dihedral_max);
    Some(format!("radius ratio mean {:.2}, min {:.2}; {angles}", q.mean, q.min))
}

/// Number of conditions that hold. `listed` tells if they are listed elsewhere.
pub fn tally(check: &CheckReport, listed: bool) -> String {
    let (all, failed) = (check.lines.len(), check.failed().count());
    let unchecked = check.lines.iter().filter(|line| matches!(line.outcome, Outcome::NotChecked(_))).count();
    let skipped = match unchecked {
        0 => String::new(),
        n => format!(", {n} skipped"),
    };
    let hint = if listed { "" } else { " (-v lists them)" };
    match failed + unchecked {
        0 => format!("all {all} conditions hold{hint}"),
        other => format!("{} of {all} conditions hold{skipped}{hint}", all - other),
    }
}

/// Failed conditions, with the first offenders of each.
pub fn faults(check: &CheckReport, hint: &str) -> String {
    let mut out = String::new();
    for failed in check.failed() {
        // Writing to a string cannot fail.
        let _ = writeln!(out, "FAIL {}", violation(failed));
        let shown = failed.offenders.len().min(MAX_NAMED);
        for offender in &failed.offenders[..shown] {
            let _ = writeln!(out, "         {}", describe(offender));
        }
        let hidden = failed.count.saturating_sub(shown as u64);
        if hidden > 0 {
            let hidden = grouped(hidden as usize);
            let _ = writeln!(out, "         and {hidden} more{hint}");
        }
    }
    out
}

/// Returns a verdict as words.
pub fn verdict(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Valid => "valid",
        Verdict::NoFaultFound => "no fault found, but some conditions were skipped",
        Verdict::Invalid => "NOT valid",
    }
}

/// One line per condition, with the first offenders.
pub fn conditions(check: &CheckReport) -> String {
    let mut out = String::new();
    for line in &check.lines {
        let statement = line.line.statement();
        let _ = match line.outcome {
            Outcome::Pass => writeln!(out, "  ok   {statement}"),
            Outcome::NotChecked(why) => writeln!(out, "  -    {statement}: skipped, because {}", reason(why)),
            Outcome::Fail => writeln!(out, "  FAIL {}", violation(line)),
        };
        let shown = line.offenders.len().min(PRINTED_OFFENDERS);
        for offender in &line.offenders[..shown] {
            let _ = writeln!(out, "         {}", describe(offender));
        }
        let hidden = line.count - shown as u64;
        if hidden > 0 {
            let _ = writeln!(out, "         and {} more", grouped(hidden as usize));
        }
    }
    out
}

/// Reason why a condition was skipped, to follow 'because'.
pub fn reason(why: Skipped) -> String {
    match why {
        Skipped::NoLabels => "the boundary has no labels".into(),
        Skipped::NoExpectation => "the file does not contain the expected loops and terminals".into(),
        Skipped::NoCaps => "the labels do not identify the caps".into(),
        Skipped::NoLumen => "no region is named 'lumen'".into(),
        Skipped::NoInterfaces => "the file labels no interfaces".into(),
        Skipped::MayTouch => "a complex and its regions may touch themselves, at edges and vertices".into(),
        Skipped::Because(line) => format!("the condition '{}' failed", line.statement()),
    }
}

/// Statement about a failed condition, with the number of offenders or the expected and found values.
pub fn violation(result: &LineResult) -> String {
    let [one, many] = result.line.violation();
    match (&result.expected, &result.found) {
        (Some(expected), Some(found)) if expected.len() + found.len() > 2 => {
            let (only_expected, only_found) = (without(expected, found), without(found, expected));
            let components = found.len().max(expected.len());
            let differ = only_found.len().max(only_expected.len());
            let [expected, found] = [only_expected, only_found].map(|left| list(&left));
            format!(
                "{many} differs in {differ} of {}: expected {expected}, found {found}",
                counted(components, "component")
            )
        }
        (Some(expected), Some(found)) => format!("{many}: expected {}, found {}", list(expected), list(found)),
        _ if result.count == 1 => one.to_owned(),
        _ => many.replace("{}", &grouped(result.count as usize)),
    }
}

/// A list of numbers, shortened if long.
fn list(numbers: &[u32]) -> String {
    const SHOWN: usize = 12;
    let shown: Vec<String> = numbers.iter().take(SHOWN).map(ToString::to_string).collect();
    match numbers.len() {
        0 => "none".into(),
        n if n > SHOWN => format!("{} … ({n} in all)", shown.join(" ")),
        _ => shown.join(" "),
    }
}

/// Returns an offender as words, with its ids.
pub fn describe(offender: &Offender) -> String {
    let kind = match offender.kind {
        OffenderKind::Point => "point",
        OffenderKind::Edge => "points",
        OffenderKind::Tet => "tetrahedron",
        OffenderKind::TetPair => "tetrahedra",
        OffenderKind::Face => "face of points",
        OffenderKind::FacePair => "faces of points",
        OffenderKind::Patch => "patch",
        OffenderKind::Node => "node",
        OffenderKind::Region => "region",
    };
    let separator = |i| if offender.kind == OffenderKind::FacePair && i == 3 { " and " } else { " " };
    let ids: String = offender.ids.iter().enumerate().map(|(i, id)| format!("{}{id}", separator(i))).collect();
    let place = offender.position.map_or_else(String::new, |at| format!(" at {}", place(at)));
    format!("{kind}{ids}{place}")
}

#[cfg(test)]
mod tests {
    use super::super::{Expectation, check_tets};
    use super::*;
    use crate::TetMesh;
    use crate::geometry::Point3;
    use crate::shapes::cube_lattice;

    fn text_of(mesh: &TetMesh) -> String {
        check_tets(mesh, Some(&Expectation { loops: vec![0], terminals: Vec::new() })).to_string()
    }

    #[test]
    fn a_sound_mesh_without_labels() {
        let text = text_of(&cube_lattice(2));
        assert!(text.contains("  ok   every tetrahedron has positive volume\n"));
        assert!(text.contains("  -    every cap faces outwards: skipped, because the boundary has no labels\n"));
        assert!(text.ends_with("no fault found, but some conditions were skipped\n"));
        assert!(text.contains("48 tetrahedra, 27 points, 48 boundary faces, 0 caps, volume 1.0000"));
        assert!(text.contains("\nradius ratio mean 0.72, min 0.72; dihedral angles 45° to 90°\n"), "{text}");
        assert!(!text.contains(" more"), "{text}");
    }

    #[test]
    fn sizes_without_tetrahedra_are_those_of_a_surface() {
        let report = check_tets(&TetMesh { points: vec![Point3::origin()], tets: Vec::new() }, None);
        assert_eq!(sizes(&report), "1 point, 0 boundary faces, 0 caps, 0 components, volume 0.0000");
        assert_eq!(shape(&report), None);
    }

    #[test]
    fn few_faults_are_named() {
        let mut mesh = cube_lattice(2);
        assert_eq!(faults(&check_tets(&mesh, None), ""), "");
        for t in &mut mesh.tets[20..35] {
            t.swap(0, 1);
        }
        let text = faults(&check_tets(&mesh, None), " (-v)");
        let first = text.split("FAIL ").nth(1).unwrap_or_default();
        assert!(first.starts_with("15 tetrahedra are inverted or flat\n         tetrahedron 20 at "), "{text}");
        assert!(first.ends_with(&format!("\n         and {} more (-v)\n", 15 - MAX_NAMED)), "{text}");
        assert_eq!(first.lines().count(), 2 + MAX_NAMED);
        mesh = cube_lattice(1);
        mesh.tets[0].swap(0, 1);
        let text = faults(&check_tets(&mesh, None), " (-v)");
        assert!(text.starts_with("FAIL 1 tetrahedron is inverted or flat\n         tetrahedron 0 at "), "{text}");
        assert_eq!(text.split("FAIL ").nth(1).map(|first| first.lines().count()), Some(2));
    }

    #[test]
    fn lists_are_shortened_and_compared() {
        let numbers: Vec<u32> = (0..13).collect();
        assert_eq!(list(&[]), "none");
        assert_eq!(list(&numbers[..12]), "0 1 2 3 4 5 6 7 8 9 10 11");
        assert_eq!(list(&numbers), "0 1 2 3 4 5 6 7 8 9 10 11 … (13 in all)");
        assert_eq!(without(&[1, 1, 2, 5], &[1, 3, 5]), [1, 2]);
        assert_eq!(without(&[1, 2], &[]), [1, 2]);
        let pair = Offender::new(OffenderKind::FacePair, &[1, 2, 3, 4, 5, 6], None);
        assert_eq!(describe(&pair), "faces of points 1 2 3 and 4 5 6");
        assert_eq!(describe(&Offender::new(OffenderKind::Edge, &[1, 2], None)), "points 1 2");
    }

    #[test]
    fn a_fault_is_shown_with_its_places() {
        let mut mesh = cube_lattice(2);
        mesh.tets[3].swap(0, 1);
        for t in &mut mesh.tets[20..35] {
            t.swap(0, 1);
        }
        let text = text_of(&mesh);
        assert!(text.contains("  FAIL 16 tetrahedra are inverted or flat\n         tetrahedron 3 at "));
        assert!(text.contains("         and 6 more\n") && text.ends_with("NOT valid\n"));
        mesh = cube_lattice(1);
        let other = mesh.clone();
        mesh.points.extend(other.points.iter().map(|p| p + crate::geometry::Vec3::repeat(0.5)));
        mesh.tets.extend(other.tets.iter().map(|t| t.map(|v| v + 8)));
        let text = text_of(&mesh);
        assert!(text.contains("  FAIL number of components: expected 1, found 2\n"));
        assert!(text.contains("  FAIL number of loops (genus) differs in 1 of 2 components: expected none, found 0\n"));
        assert!(text.contains("         faces of points ") && text.contains(" and "));
    }
}
