//! What a check found, for people; its JSON form is `CheckReport` itself.

use crate::mesh::check::{CheckReport, LineResult, Offender, OffenderKind, Outcome, Skipped, Verdict};
use std::fmt;

/// For people: a line per line of the definition, the first offenders below those that fail, sizes and shape, and the
/// verdict at the end.
impl fmt::Display for CheckReport {
    fn fmt(&self, out: &mut fmt::Formatter) -> fmt::Result {
        for line in &self.lines {
            write_line(out, line)?;
        }
        let counts = &self.counts;
        let tets = if counts.tets > 0 { format!("{} tetrahedra, ", counts.tets) } else { String::new() };
        writeln!(
            out,
            "\n{tets}{} points, {} boundary faces, {} caps, {} component{}, volume {:.6e}",
            counts.points,
            counts.boundary_faces,
            counts.caps,
            counts.components,
            if counts.components == 1 { "" } else { "s" },
            counts.volume,
        )?;
        if let Some(quality) = &self.quality {
            writeln!(
                out,
                "radius ratio: mean {:.4}, 1st percentile {:.4}, min {:.4}; dihedral angles {:.2}° to {:.2}°",
                quality.mean, quality.percentile_1, quality.min, quality.dihedral_min, quality.dihedral_max,
            )?;
        }
        writeln!(out, "{}", verdict(self.verdict))
    }
}

pub(super) fn verdict(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Valid => "valid",
        Verdict::NoFaultFound => "no fault found, but not every line could be checked",
        Verdict::Invalid => "NOT valid",
    }
}

fn write_line(out: &mut fmt::Formatter, result: &LineResult) -> fmt::Result {
    let statement = result.line.statement();
    match result.outcome {
        Outcome::Pass => writeln!(out, "  ok   {statement}"),
        Outcome::NotChecked(why) => writeln!(out, "  -    {statement}: not checked, {}", reason(why)),
        Outcome::Fail => writeln!(out, "  FAIL {statement}: {}", extent(result)),
    }?;
    for offender in &result.offenders {
        writeln!(out, "         {}", describe(offender))?;
    }
    let hidden = result.count - result.offenders.len() as u64;
    if hidden > 0 {
        writeln!(out, "         and {hidden} more")?;
    }
    Ok(())
}

pub(super) fn reason(why: Skipped) -> String {
    match why {
        Skipped::NoLabels => "the boundary has no labels".into(),
        Skipped::NoExpectation => "the file does not say what to expect".into(),
        Skipped::NoCaps => "the labels do not say which caps they are".into(),
        Skipped::Because(line) => format!("because this fails: {}", line.statement()),
    }
}

/// How many offenders, or what was expected and what found.
pub(super) fn extent(result: &LineResult) -> String {
    match (&result.expected, &result.found) {
        (Some(expected), Some(found)) => format!("expected {}, found {}", list(expected), list(found)),
        _ => format!("{} found", result.count),
    }
}

/// A list of numbers, in full when it is short.
fn list(numbers: &[u32]) -> String {
    const SHOWN: usize = 12;
    let shown: Vec<String> = numbers.iter().take(SHOWN).map(ToString::to_string).collect();
    match numbers.len() {
        0 => "none".into(),
        n if n > SHOWN => format!("{} … ({n} in all)", shown.join(" ")),
        _ => shown.join(" "),
    }
}

pub(super) fn describe(offender: &Offender) -> String {
    let kind = match offender.kind {
        OffenderKind::Point => "point",
        OffenderKind::Edge => "points",
        OffenderKind::Tet => "tetrahedron",
        OffenderKind::TetPair => "tetrahedra",
        OffenderKind::Face => "face of points",
        OffenderKind::FacePair => "faces of points",
        OffenderKind::Patch => "patch",
        OffenderKind::Node => "node",
    };
    let separator = |i| if offender.kind == OffenderKind::FacePair && i == 3 { " and " } else { " " };
    let ids: String = offender.ids.iter().enumerate().map(|(i, id)| format!("{}{id}", separator(i))).collect();
    let place = offender.position.map_or_else(String::new, |[x, y, z]| format!(" at ({x}, {y}, {z})"));
    format!("{kind}{ids}{place}")
}

#[cfg(test)]
mod tests {
    use crate::mesh::TetMesh;
    use crate::mesh::check::{Expectation, check_tets};
    use crate::mesh::shapes::cube_lattice;

    fn text_of(mesh: &TetMesh) -> String {
        check_tets(mesh, Some(&Expectation { loops: vec![0], terminals: Vec::new() })).to_string()
    }

    #[test]
    fn a_sound_mesh_without_labels() {
        let text = text_of(&cube_lattice(2));
        assert!(text.contains("  ok   every tetrahedron is positive\n"));
        assert!(text.contains("  -    caps face outwards: not checked, the boundary has no labels\n"));
        assert!(text.ends_with("no fault found, but not every line could be checked\n"));
        assert!(text.contains("48 tetrahedra, 27 points, 48 boundary faces, 0 caps, 1 component, volume 1.0"));
    }

    #[test]
    fn a_fault_is_shown_with_its_places() {
        let mut mesh = cube_lattice(2);
        mesh.tets[3].swap(0, 1);
        for t in &mut mesh.tets[20..35] {
            t.swap(0, 1);
        }
        let text = text_of(&mesh);
        assert!(text.contains("  FAIL every tetrahedron is positive: 16 found\n         tetrahedron 3 at ("));
        assert!(text.contains("         and 6 more\n") && text.ends_with("NOT valid\n"));
        mesh = cube_lattice(1);
        let other = mesh.clone();
        mesh.points.extend(other.points.iter().map(|p| p + crate::geometry::Vec3::repeat(0.5)));
        mesh.tets.extend(other.tets.iter().map(|t| t.map(|v| v + 8)));
        let text = text_of(&mesh);
        assert!(text.contains("  FAIL components as expected: expected 1, found 2\n"));
        assert!(text.contains("  FAIL loops (genus) as expected: expected 0, found 0 0\n"));
        assert!(text.contains("         faces of points ") && text.contains(" and "));
    }
}
