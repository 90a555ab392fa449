//! Declarations and data sections of a spatial graph.

use super::error::AmiraError;
use crate::text::{TextFault, Words, shown};

/// Element type of an array.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Of {
    Vertices,
    Edges,
    Points,
}

/// Array with its values.
pub(super) struct Array {
    pub of: Of,
    pub name: String,
    /// Values per element.
    pub components: usize,
    pub values: Vec<f64>,
}

/// Arrays of a file.
#[derive(Default)]
pub(super) struct Sections {
    /// Number of vertices, edges and points.
    counts: [usize; 3],
    pub arrays: Vec<Array>,
    /// Data mark of each array.
    marks: Vec<Vec<u8>>,
}

impl Sections {
    pub(super) fn of(bytes: &[u8]) -> Result<Self, AmiraError> {
        let first = bytes.split(|&b| b == b'\n').next().unwrap_or_default();
        if !first.starts_with(b"# AmiraMesh") && !first.starts_with(b"# Avizo") {
            return Err(AmiraError::NotAmira);
        }
        if first.windows(6).any(|w| w == b"BINARY") {
            return Err(AmiraError::Binary);
        }
        let mut words = Words::new(bytes, false);
        let mut sections = Self::default();
        while let Some(word) = words.word() {
            if word.starts_with(b"@") && word.len() > 1 {
                sections.fill(word, &mut words)?;
            } else {
                match (word, kind(word)) {
                    (b"define", _) => sections.define(&mut words)?,
                    (_, Some(of)) => sections.declare(of, &mut words)?,
                    _ => words.skip_line(),
                }
            }
        }
        Ok(sections)
    }

    /// Number of vertices, edges or points.
    pub(super) fn count(&self, of: Of) -> usize {
        self.counts[of as usize]
    }

    /// Finds an array by name and number of components.
    pub(super) fn find(&self, of: Of, name: &'static str, components: usize) -> Result<&[f64], AmiraError> {
        let found = self.arrays.iter().find(|a| a.of == of && a.name == name && a.components == components);
        let full = found.filter(|a| Some(a.values.len()) == self.count(of).checked_mul(components));
        full.map(|a| a.values.as_slice()).ok_or(AmiraError::Missing { what: name })
    }

    /// Parses `define VERTEX 148`; other definitions are ignored.
    fn define(&mut self, words: &mut Words) -> Result<(), AmiraError> {
        if let Some(of) = words.word_here().and_then(kind) {
            self.counts[of as usize] = words.count("a number of vertices, edges or points", 1)?;
        }
        words.skip_line();
        Ok(())
    }

    /// Parses `{ float[3] VertexCoordinates } @1`.
    fn declare(&mut self, of: Of, words: &mut Words) -> Result<(), AmiraError> {
        let line = words.line();
        let mut next = || words.word_here().ok_or(AmiraError::BadDeclaration { line });
        if next()? != b"{" {
            // A parameter group with this name.
            words.skip_line();
            return Ok(());
        }
        let (kind, name, end, mark) = (next()?, next()?, next()?, next()?);
        if end != b"}" || !mark.starts_with(b"@") {
            return Err(AmiraError::BadDeclaration { line });
        }
        let components = match kind.iter().position(|&b| b == b'[') {
            None => Some(1),
            Some(at) => std::str::from_utf8(&kind[at + 1..]).ok().and_then(|k| k.trim_end_matches(']').parse().ok()),
        };
        let components = components.ok_or(AmiraError::BadDeclaration { line })?;
        self.arrays.push(Array { of, name: shown(name), components, values: Vec::new() });
        self.marks.push(mark.to_owned());
        Ok(())
    }

    /// Reads the values below a mark.
    fn fill(&mut self, mark: &[u8], words: &mut Words) -> Result<(), AmiraError> {
        let line = words.line();
        let at = self.marks.iter().position(|m| m == mark);
        let at = at.ok_or_else(|| AmiraError::Undeclared { line, mark: shown(mark) })?;
        let count = self.counts[self.arrays[at].of as usize].saturating_mul(self.arrays[at].components);
        // Each value takes at least a separator and a digit, which bounds the count by the file size.
        if count > words.rest() {
            return Err(TextFault::CutShort { line, missing: "all values of an array" }.into());
        }
        let mut values = Vec::with_capacity(count);
        for _ in 0..count {
            let word = words.need("a value of an array")?;
            values.push(words.as_float(word, "a value of an array")?);
        }
        self.arrays[at].values = values;
        Ok(())
    }
}

fn kind(word: &[u8]) -> Option<Of> {
    match word {
        b"VERTEX" => Some(Of::Vertices),
        b"EDGE" => Some(Of::Edges),
        b"POINT" => Some(Of::Points),
        _ => None,
    }
}
