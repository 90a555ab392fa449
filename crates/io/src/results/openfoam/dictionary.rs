//! Dictionaries with fields: the header, and entries of a field file.

use super::data::{Layout, Scanner};
use crate::results::error::ResultFault;
use std::collections::BTreeMap;

/// Maximum nesting depth.
const DEEPEST: usize = 16;

/// Value of an entry.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Entry {
    Words(String),
    /// Values for all cells or faces, or a single one for all of them.
    Field(Field),
    Dictionary(Dictionary),
}

#[derive(Clone, Debug, PartialEq)]
pub(super) struct Field {
    pub is_uniform: bool,
    pub components: usize,
    pub values: Vec<f64>,
}

pub(super) type Dictionary = BTreeMap<String, Entry>;

/// Reads the header of a file, which defines the encoding, and returns its class.
pub(super) fn header(scanner: &mut Scanner) -> Result<String, ResultFault> {
    if scanner.word() != "FoamFile" {
        return Err(ResultFault::Syntax { at: 0, expected: "a header FoamFile" });
    }
    scanner.need(b'{', "a header FoamFile")?;
    let header = entries(scanner, true, 0)?;
    let word = |key: &str| match header.get(key) {
        Some(Entry::Words(words)) => words.trim_matches('"').to_owned(),
        _ => String::new(),
    };
    let arch = word("arch");
    scanner.layout = Layout {
        binary: word("format") == "binary",
        wide_labels: arch.contains("label=64"),
        narrow_scalars: arch.contains("scalar=32"),
        big_endian: arch.contains("MSB"),
    };
    Ok(word("class"))
}

/// Reads entries up to the closing brace of a dictionary, or the end of the file.
pub(super) fn entries(scanner: &mut Scanner, nested: bool, depth: usize) -> Result<Dictionary, ResultFault> {
    let mut found = Dictionary::new();
    if depth > DEEPEST {
        return Err(scanner.fault("less than 16 nested dictionaries"));
    }
    loop {
        match scanner.peek() {
            None if nested => return Err(ResultFault::Truncated { within: "a dictionary".to_owned() }),
            None => return Ok(found),
            Some(b'}') if nested => {
                scanner.take(b'}');
                return Ok(found);
            }
            Some(b';') => {
                scanner.take(b';');
                continue;
            }
            _ => {}
        }
        let key = scanner.word();
        if key.is_empty() {
            return Err(scanner.fault("the name of an entry"));
        }
        let entry =
            if scanner.take(b'{') { Entry::Dictionary(entries(scanner, true, depth + 1)?) } else { value(scanner)? };
        found.insert(key.trim_matches('"').to_owned(), entry);
    }
}

/// Value of an entry, up to its semicolon.
fn value(scanner: &mut Scanner) -> Result<Entry, ResultFault> {
    let mut words = String::new();
    loop {
        match scanner.peek() {
            None => return Err(ResultFault::Truncated { within: "an entry".to_owned() }),
            Some(b';') => {
                scanner.take(b';');
                return Ok(Entry::Words(words));
            }
            Some(byte @ (b'(' | b')' | b'{' | b'}')) => {
                scanner.take(byte);
                words.push(byte as char);
                continue;
            }
            _ => {}
        }
        let word = scanner.word();
        match word {
            "uniform" => {
                let components = if scanner.peek() == Some(b'(') { 3 } else { 1 };
                let values = scanner.tuple(components, "a uniform value")?;
                return field_end(scanner, Field { is_uniform: true, components, values });
            }
            "nonuniform" => {
                let components = match scanner.word() {
                    "List<scalar>" => 1,
                    "List<vector>" => 3,
                    "List<symmTensor>" => 6,
                    "List<tensor>" => 9,
                    // An empty list has no type.
                    "0" => return field_end(scanner, Field { is_uniform: false, components: 1, values: Vec::new() }),
                    _ => return Err(scanner.fault("a list of scalars or vectors")),
                };
                let count = scanner.count("the length of a list")?;
                if scanner.take(b'{') {
                    // Equal values.
                    let values = scanner.tuple(components, "a field")?;
                    scanner.need(b'}', "a field")?;
                    return field_end(scanner, Field { is_uniform: true, components, values });
                }
                let values = scanner.floats(count, components, "a field")?;
                return field_end(scanner, Field { is_uniform: false, components, values });
            }
            _ => {
                words.push_str(if words.is_empty() { "" } else { " " });
                words.push_str(word);
            }
        }
    }
}

fn field_end(scanner: &mut Scanner, field: Field) -> Result<Entry, ResultFault> {
    if scanner.take(b'(') {
        scanner.need(b')', "an empty list")?;
    }
    scanner.need(b';', "a semicolon")?;
    Ok(Entry::Field(field))
}

impl Field {
    /// Values for this number of cells or faces.
    pub(super) fn expand(&self, what: &str, count: usize, components: usize) -> Result<Vec<f64>, ResultFault> {
        if self.components != components && !self.values.is_empty() {
            let (expected, found) = (components, self.components);
            return Err(ResultFault::Length { what: format!("a value of {what}"), expected, found });
        }
        let values = if self.is_uniform {
            self.values.iter().copied().cycle().take(count * components).collect()
        } else {
            ResultFault::ensure_length(what, count, self.values.len() / components)?;
            self.values.clone()
        };
        ResultFault::ensure_finite(what, &values)?;
        Ok(values)
    }
}
