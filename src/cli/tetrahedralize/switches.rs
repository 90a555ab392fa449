//! `TetGen` switches (manual of version 1.5, section 4): a string such as `pYq1.4a0.1`.

use anastomesh_mesh::{Bounds, REGULAR_DIHEDRAL};

/// Parsed switches.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Switches {
    /// `p`: the input holds facets.
    pub plc: bool,
    /// `Y`: the input's triangles are kept as they are.
    pub keep_boundary: bool,
    /// `q`: bad tetrahedra are refined.
    pub quality: Option<Bounds>,
    /// `a` with a number: no tetrahedron is larger.
    pub max_volume: Option<f64>,
    /// `a` without a number: no tetrahedron is larger than its region says.
    pub region_volumes: bool,
    /// `A`: each region has its own number.
    pub regions: bool,
    /// `d`: intersections are looked for, and nothing else is done.
    pub check_only: bool,
    /// `O0`: the mesh is not improved.
    pub no_optimization: bool,
    /// `z`: files count from 0.
    pub from_zero: bool,
    /// `n`: the neighbours are written.
    pub neighbors: bool,
    /// `f`: all faces are written.
    pub all_faces: bool,
    /// `e`: all edges are written.
    pub all_edges: bool,
    /// `F`: no faces and no edges are written.
    pub no_faces: bool,
    /// `V`, as often as it stands.
    pub verbose: u8,
    /// `Q`: nothing is printed but errors.
    pub quiet: bool,
    /// Notes on switches without effect.
    pub without_effect: Vec<String>,
}

/// Default bound of `q`.
const USUAL_RATIO: f64 = 2.0;

/// Errors of a switch string.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SwitchError {
    /// The switch is not supported.
    #[error("switch {switch} of --tetgen: {what} is not supported; {instead}")]
    Unsupported {
        /// The switch, in quotes.
        switch: String,
        /// Requested feature.
        what: &'static str,
        /// Remedy.
        instead: &'static str,
    },
    /// The switch is unknown.
    #[error("unknown switch '{switch}' of --tetgen; known: p Y q a A d O z n f e F V Q, as in --tetgen pYq1.4a0.1")]
    Unknown {
        /// The letter.
        switch: char,
    },
    /// The number of the switch is invalid.
    #[error("invalid number '{number}' of switch '{switch}' of --tetgen; {expected}")]
    BadNumber {
        /// The letter.
        switch: char,
        /// Text after the switch.
        number: String,
        /// Expected text.
        expected: &'static str,
    },
}

/// Unsupported switches, with feature and remedy.
const UNSUPPORTED: [(char, &str, &str); 15] = [
    ('r', "refinement of an existing mesh", "give the surface of the mesh as input"),
    ('R', "coarsening", "give a coarser surface as input"),
    (
        'm',
        "a sizing function from a .mtr or background mesh",
        "use --sizes-from with --array, or the library with Sizing::Function",
    ),
    ('i', "inserting a list of points", "put the points into the .node file, or use the library with Interior::Points"),
    ('w', "a weighted Delaunay tetrahedralization", "leave the weights out"),
    ('c', "keeping the convex hull", "give a .node file alone, which is filled up to its hull"),
    ('v', "the Voronoi diagram", "leave the switch out"),
    ('S', "a bound on the number of Steiner points", "use a bound on the volume instead"),
    ('T', "a tolerance for coplanar points", "leave it out: all decisions are exact"),
    ('X', "inexact arithmetic", "leave it out: all decisions are exact"),
    ('N', "leaving the .node file out", "leave the switch out: .node and .ele are always written"),
    ('E', "leaving the .ele file out", "leave the switch out: .node and .ele are always written"),
    ('k', "an additional .vtk file", "use -o MESH.vtu"),
    ('g', "an additional .mesh file", "use -o MESH.mesh"),
    ('h', "help", "use anastomesh tetrahedralize --help"),
];

/// Switches without effect, with the reason.
const WITHOUT_EFFECT: [(char, &str); 10] = [
    ('C', "every mesh is proved to be consistent"),
    ('I', "files are named as -o says, without a number"),
    ('J', "all points of the input are kept"),
    ('M', "facets are never merged"),
    ('B', "boundary markers are always written"),
    ('D', "the mesh is already constrained Delaunay where the boundary allows it"),
    ('l', "the order of insertion is fixed"),
    ('L', "the order of insertion is fixed"),
    ('s', "the order of insertion is fixed"),
    ('P', "points are numbered as in the input"),
];

impl Switches {
    /// Parses a string of switches; a dash before it and blanks between groups are passed over.
    pub fn parse(text: &str) -> Result<Self, SwitchError> {
        let mut switches = Self::default();
        for group in text.split_whitespace() {
            let mut cursor = Cursor { rest: group.strip_prefix('-').unwrap_or(group) };
            while let Some(letter) = cursor.letter() {
                switches.take(letter, &mut cursor)?;
            }
        }
        Ok(switches)
    }

    fn take(&mut self, letter: char, cursor: &mut Cursor) -> Result<(), SwitchError> {
        match letter {
            'p' => {
                self.plc = true;
                self.ignore_number(cursor, "'p/…'", "facets are taken as they are, coplanar or not");
            }
            'Y' => {
                self.keep_boundary = true;
                self.ignore_number(cursor, "'Y/…'", "all of the boundary is kept");
            }
            'q' => self.quality = Some(quality(cursor)?),
            'a' => match cursor.number() {
                "" => self.region_volumes = true,
                number => self.max_volume = Some(positive('a', number, "expected a volume above 0, as in a0.1")?),
            },
            'A' => self.regions = true,
            'd' => self.check_only = true,
            'O' => self.no_optimization = optimization(cursor),
            'o' => self.take_o(cursor)?,
            'z' => self.from_zero = true,
            'n' => {
                self.neighbors = true;
                // `nn` asks for more than fits into the file.
                if cursor.rest.starts_with('n') {
                    return Err(unsupported('n', "nn: neighbours of faces", "use n alone"));
                }
            }
            'f' => self.all_faces = true,
            'e' => {
                self.all_edges = true;
                if cursor.rest.starts_with('e') {
                    return Err(unsupported('e', "ee: tetrahedra of edges", "use e alone"));
                }
            }
            'F' => self.no_faces = true,
            'V' => self.verbose = self.verbose.saturating_add(1),
            'Q' => self.quiet = true,
            _ => return self.take_other(letter, cursor),
        }
        Ok(())
    }

    fn take_o(&mut self, cursor: &mut Cursor) -> Result<(), SwitchError> {
        if cursor.rest.starts_with('2') {
            return Err(unsupported('o', "o2: tetrahedra with ten points", "use --order 2 with .vtu, .msh or .npyd"));
        }
        self.ignore_number(cursor, "'o/…'", "improvement begins with the worst tetrahedra and has no target angle");
        Ok(())
    }

    fn take_other(&mut self, letter: char, cursor: &mut Cursor) -> Result<(), SwitchError> {
        if let Some(&(_, what, instead)) = UNSUPPORTED.iter().find(|row| row.0 == letter) {
            return Err(unsupported(letter, what, instead));
        }
        let Some(&(_, why)) = WITHOUT_EFFECT.iter().find(|row| row.0 == letter) else {
            return Err(SwitchError::Unknown { switch: letter });
        };
        cursor.numbers();
        self.without_effect.push(format!("switch '{letter}' of --tetgen has no effect: {why}"));
        Ok(())
    }

    /// Skips numbers after a switch, with a note.
    fn ignore_number(&mut self, cursor: &mut Cursor, shown: &str, why: &str) {
        if cursor.numbers() {
            self.without_effect.push(format!("the number of {shown} of --tetgen has no effect: {why}"));
        }
    }
}

fn unsupported(letter: char, what: &'static str, instead: &'static str) -> SwitchError {
    SwitchError::Unsupported { switch: format!("'{letter}'"), what, instead }
}

/// `q[ratio][/mindihedral]`.
fn quality(cursor: &mut Cursor) -> Result<Bounds, SwitchError> {
    const RATIO: &str =
        "expected a bound on circumradius over shortest edge above 0.612 (usual are 1.4 to 2), as in q1.4";
    const ANGLE: &str = "expected an angle in degrees from 0 to below 70.53 after the slash, as in q1.4/10";
    let max_radius_edge = match cursor.number() {
        "" => USUAL_RATIO,
        number => {
            let ratio = positive('q', number, RATIO)?;
            // The regular tetrahedron has √6/4.
            if ratio <= 0.612_372_435_695_794_5 {
                return Err(SwitchError::BadNumber { switch: 'q', number: number.into(), expected: RATIO });
            }
            ratio
        }
    };
    let mut min_dihedral = None;
    if cursor.skip('/') {
        let number = cursor.number();
        let angle = number.parse::<f64>().ok().filter(|angle| (0.0..REGULAR_DIHEDRAL).contains(angle));
        let bad = || SwitchError::BadNumber { switch: 'q', number: format!("/{number}"), expected: ANGLE };
        min_dihedral = Some(angle.ok_or_else(bad)?).filter(|&angle| angle > 0.0);
    }
    Ok(Bounds { max_radius_edge: Some(max_radius_edge), min_dihedral, max_volume: None })
}

/// `O[level][/operations]`: true if it disables improvement.
fn optimization(cursor: &mut Cursor) -> bool {
    let level = cursor.number();
    let none = level == "0";
    if cursor.skip('/') {
        cursor.number();
    }
    none
}

fn positive(switch: char, number: &str, expected: &'static str) -> Result<f64, SwitchError> {
    let value = number.parse::<f64>().ok().filter(|value| *value > 0.0 && value.is_finite());
    value.ok_or_else(|| SwitchError::BadNumber { switch, number: number.into(), expected })
}

/// Remaining switches.
struct Cursor<'a> {
    rest: &'a str,
}

impl<'a> Cursor<'a> {
    fn letter(&mut self) -> Option<char> {
        let letter = self.rest.chars().next()?;
        self.rest = &self.rest[letter.len_utf8()..];
        Some(letter)
    }

    fn skip(&mut self, mark: char) -> bool {
        let rest = self.rest.strip_prefix(mark);
        self.rest = rest.unwrap_or(self.rest);
        rest.is_some()
    }

    /// Takes the next number; empty if missing. An `e` without digits after it is the next switch.
    fn number(&mut self) -> &'a str {
        let bytes = self.rest.as_bytes();
        let digits = |from: usize| bytes.iter().skip(from).take_while(|b| b.is_ascii_digit()).count();
        let mut end = bytes.iter().take_while(|b| b.is_ascii_digit() || **b == b'.').count();
        if end > 0 && matches!(bytes.get(end), Some(b'e' | b'E')) {
            let sign = usize::from(matches!(bytes.get(end + 1), Some(b'+' | b'-')));
            let exponent = digits(end + 1 + sign);
            if exponent > 0 {
                end += 1 + sign + exponent;
            }
        }
        let (number, rest) = self.rest.split_at(end);
        self.rest = rest;
        number
    }

    /// Skips numbers separated by slashes; true if there were any.
    fn numbers(&mut self) -> bool {
        let before = self.rest.len();
        loop {
            self.number();
            if !self.skip('/') {
                return self.rest.len() < before;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bounds(max_radius_edge: f64, min_dihedral: Option<f64>) -> Bounds {
        Bounds { max_radius_edge: Some(max_radius_edge), min_dihedral, max_volume: None }
    }

    fn parse(text: &str) -> Switches {
        Switches::parse(text).unwrap_or_else(|e| panic!("{text}: {e}"))
    }

    fn fault(text: &str) -> String {
        Switches::parse(text).unwrap_err().to_string()
    }

    #[test]
    fn what_people_write() {
        let all = parse("pYq1.4a0.1");
        let quality = Some(bounds(1.4, None));
        let expected =
            Switches { plc: true, keep_boundary: true, quality, max_volume: Some(0.1), ..Default::default() };
        assert_eq!(all, expected);
        for same in ["-pYq1.4a0.1", " -p -Y -q1.4 -a0.1", "a.1q1.4Yp", "pYq1.4a1e-1", "pYq1.40a1.0E-1"] {
            assert_eq!(parse(same), expected, "{same}");
        }
        assert_eq!(parse(""), Switches::default());
        assert_eq!(parse("-"), Switches::default());
    }

    #[test]
    fn quality_has_a_ratio_and_an_angle() {
        let quality = |text| parse(text).quality.unwrap();
        assert_eq!(quality("q"), bounds(2.0, None));
        assert_eq!(quality("q/18"), bounds(2.0, Some(18.0)));
        assert_eq!(quality("q1.1/20.5p"), bounds(1.1, Some(20.5)));
        assert_eq!(quality("q1.2/0"), bounds(1.2, None));
        for bad in ["q0", "q0.5", "q1.2.3", "q1.4/80", "q1.4/", "q."] {
            assert!(fault(bad).starts_with("invalid number '"), "{}", fault(bad));
        }
        assert!(fault("a0").contains("'a'") && fault("a.").contains("above 0"));
    }

    #[test]
    fn output_switches() {
        let some = parse("pzfenVVAaQ");
        assert!(some.from_zero && some.all_faces && some.all_edges && some.neighbors && some.regions && some.quiet);
        assert!(some.region_volumes && some.max_volume.is_none() && some.verbose == 2);
        let both = parse("pa0.5aAF");
        assert!(both.region_volumes && both.max_volume == Some(0.5) && both.no_faces);
        // The `e` is a switch, not the beginning of an exponent.
        let volume = parse("a0.1e");
        assert!(volume.all_edges && volume.max_volume == Some(0.1));
        assert!(parse("O0").no_optimization && !parse("O2/7").no_optimization && parse("d").check_only);
    }

    #[test]
    fn what_has_no_effect_is_said() {
        for (text, part) in [("C", "'C'"), ("o/150", "'o/…'"), ("Y/1", "'Y/…'"), ("p/0.1", "'p/…'"), ("s4/3", "'s'")]
        {
            let notes = parse(text).without_effect;
            assert!(notes.len() == 1 && notes[0].contains(part), "{text}: {notes:?}");
        }
        assert!(parse("pYq1.4").without_effect.is_empty());
    }

    #[test]
    fn what_is_not_followed_is_named_with_a_remedy() {
        assert_eq!(
            fault("rq"),
            "switch 'r' of --tetgen: refinement of an existing mesh is not supported; give the surface of the mesh as input"
        );
        for (text, part) in
            [("pw", "'w'"), ("o2", "o2"), ("pnn", "nn"), ("ee", "ee"), ("T1e-8", "'T'"), ("S100", "'S'")]
        {
            assert!(fault(text).contains(part), "{}", fault(text));
        }
        assert!(fault("pY?").starts_with("unknown switch '?' of --tetgen") && fault("pä").contains("'ä'"));
    }
}
