//! Meshes read in pieces: joints are found, and unsuitable pieces are refused.

use super::*;
use crate::check::parts::pieces::Unfit;
use crate::source::{FacePiece, MeshSource, SourceCounts, TetPiece};
use std::borrow::Cow;

/// A mesh with its pieces stored one after another.
#[derive(Clone)]
struct Stack {
    whole: VolumeMesh,
    expectation: Expectation,
    /// Number of tetrahedra and of labelled faces of each piece.
    sizes: Vec<(usize, usize)>,
}

impl Stack {
    fn of(cut: &Cut) -> Self {
        let merged = cut.merged();
        let (mut tets, mut sizes) = (Vec::new(), Vec::new());
        for (part, piece) in (0..).zip(&cut.pieces) {
            tets.extend(piece.mesh.tets.iter().map(|t| t.map(|v| piece.vertices[v as usize])));
            sizes.push((piece.mesh.tets.len(), cut.wall(part).unwrap().faces.len()));
        }
        let mesh = TetMesh { points: merged.mesh.points, tets };
        Self { whole: VolumeMesh { mesh, ..merged }, expectation: cut.expectation.clone(), sizes }
    }

    fn check(&self) -> Result<CheckReport, PiecesError> {
        check_pieces(self, Some(&self.expectation), 1 << 20)
    }

    /// Reason for refusal after a change.
    fn refused(&self, change: impl FnOnce(&mut Self)) -> Unfit {
        let mut stack = self.clone();
        change(&mut stack);
        match stack.check() {
            Err(PiecesError::Unfit(why)) => why,
            other => panic!("{other:?}"),
        }
    }

    /// Asserts agreement with the check of the whole except roundoff.
    fn assert_same(&self) -> CheckReport {
        let (pieces, whole) = (self.check().unwrap(), check_volume(&self.whole, Some(&self.expectation)));
        assert_eq!(pieces.verdict, whole.verdict);
        for (p, w) in pieces.lines.iter().zip(&whole.lines).filter(|(p, _)| !is_unknown(p)) {
            assert_eq!((p.line, p.outcome, p.count), (w.line, w.outcome, w.count));
            if p.line != Line::Loops {
                same_offenders(&pieces, &whole, p.line);
            }
        }
        let (p, w) = (&pieces.counts, &whole.counts);
        assert_eq!(
            (p.points, p.tets, p.boundary_faces, p.components),
            (w.points, w.tets, w.boundary_faces, w.components)
        );
        pieces
    }
}

impl MeshSource for Stack {
    fn counts(&self) -> SourceCounts {
        self.whole.counts()
    }

    fn patches(&self) -> &[Patch] {
        &self.whole.patches
    }

    fn parts(&self) -> u32 {
        self.sizes.len() as u32
    }

    fn points(&self, part: u32) -> io::Result<Cow<'_, [Point3]>> {
        Ok(if part == 0 { Cow::Borrowed(&self.whole.mesh.points) } else { Cow::default() })
    }

    fn tets(&self, part: u32) -> io::Result<TetPiece<'_>> {
        let first: usize = self.sizes[..part as usize].iter().map(|size| size.0).sum();
        let tets = &self.whole.mesh.tets[first..first + self.sizes[part as usize].0];
        Ok(TetPiece { tets: tets.into(), ..TetPiece::default() })
    }

    fn boundary(&self, part: u32) -> io::Result<FacePiece<'_>> {
        let first: usize = self.sizes[..part as usize].iter().map(|size| size.1).sum();
        let range = first..first + self.sizes[part as usize].1;
        let patches = self.whole.boundary_patch[range.clone()].into();
        Ok(FacePiece { faces: self.whole.boundary[range].into(), patches, ..FacePiece::default() })
    }
}

#[test]
fn pieces_are_checked_as_the_whole_is() {
    for cut in [bar(), star(), ring(4), ring(2)] {
        let report = Stack::of(&cut).assert_same();
        assert_eq!(report.verdict, Verdict::Valid);
    }
}

#[test]
fn faults_are_named_in_numbers_of_the_whole() {
    let mut stack = Stack::of(&bar());
    // A tetrahedron without a face on the boundary.
    let on_wall: BTreeSet<u32> = stack.whole.boundary.as_flattened().iter().copied().collect();
    let inner = stack.whole.mesh.tets.iter().rposition(|t| !t.iter().any(|v| on_wall.contains(v))).unwrap();
    stack.whole.mesh.tets[inner].swap(0, 1);
    let report = stack.assert_same();
    assert_eq!(report.line(Line::PositiveTets).unwrap().offenders[0].ids, [inner as i64]);

    let mut stack = Stack::of(&bar());
    stack.expectation.loops = vec![1];
    stack.expectation.terminals.push(99);
    let failing: Vec<Line> = stack.assert_same().failed().map(|result| result.line).collect();
    assert_eq!(failing, [Line::Loops, Line::CapPerTerminal]);
}

#[test]
fn walls_that_meet_are_found() {
    let mut stack = Stack::of(&star());
    // Moves the end of one arm into another.
    let end = |axis: usize, side: f64| {
        let at = |p: &Point3| if side > 0.0 { p[axis] > 0.99 } else { p[axis] < 0.01 };
        stack.whole.mesh.points.iter().position(at).unwrap()
    };
    let (from, to) = (end(0, 1.0), end(1, 1.0));
    stack.whole.mesh.points[from] = stack.whole.mesh.points[to];
    let report = stack.check().unwrap();
    assert!(report.failed().any(|result| result.line == Line::NoSelfIntersection));
    assert_eq!(report.verdict, Verdict::Invalid);
}

#[test]
fn what_cannot_be_parts_is_refused() {
    let stack = Stack::of(&bar());
    let last = stack.whole.boundary.len() - 1;
    let piece = stack.sizes.len() as u32 - 1;
    let refused = |change: &dyn Fn(&mut Stack)| stack.refused(|stack| change(stack));
    assert_eq!(refused(&|s| s.whole.boundary[last].swap(0, 1)), Unfit::Labels(piece));
    assert_eq!(refused(&|s| s.whole.boundary[last] = s.whole.boundary[last - 1]), Unfit::Labels(piece));
    assert_eq!(refused(&|s| s.whole.boundary[last][0] = 0), Unfit::Points(piece));
    assert_eq!(refused(&|s| s.whole.boundary_patch[last] = 77), Unfit::Patch(piece));
    assert_eq!(refused(&|s| s.whole.mesh.tets[0][0] = 1_000_000), Unfit::Points(0));
    assert_eq!(refused(&|s| s.whole.mesh.points.push(Point3::origin())), Unfit::Shared);
    // A face without its label.
    let unlabelled = refused(&|s| {
        s.sizes[piece as usize].1 -= 1;
        s.whole.boundary.pop();
    });
    assert_eq!(unlabelled, Unfit::Joint(piece));
    // The first face of a joint belongs to three tetrahedra.
    let thrice = refused(&|s| {
        let t = s.whole.mesh.tets[0];
        s.whole.mesh.tets.push(t);
        s.sizes.push((1, 0));
    });
    assert!(matches!(thrice, Unfit::Joint(_)), "{thrice:?}");
}
