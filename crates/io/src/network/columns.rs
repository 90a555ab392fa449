//! Named attributes of nodes or edges: numbers, short lists of numbers, or text.
//!
//! Values are stored sparsely with their rows, so that memory is bounded by the file size for any number of names.

use super::radii::plain;
use rustc_hash::FxHashMap;

/// Attribute value.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Value {
    Number(f64),
    /// At most four numbers: one more than a position has.
    List(Vec<f64>),
    /// Any other text, truncated.
    Text(String),
}

impl Value {
    /// Parses a text: a number, a list such as `1 2 3`, `(1, 2, 3)` or `[1;2]`, or text.
    pub(super) fn of(text: &str) -> Self {
        let text = text.trim();
        if let Ok(number) = text.parse() {
            return Self::Number(number);
        }
        let inner = text.trim_matches(['(', ')', '[', ']', '{', '}']);
        let separates = |c: char| c.is_whitespace() || matches!(c, ',' | ';');
        let words = inner.split(separates).filter(|w| !w.is_empty());
        let numbers: Option<Vec<f64>> = words.take(4).map(|w| w.parse().ok()).collect();
        match numbers {
            Some(list) if !list.is_empty() => Self::List(list),
            _ => Self::Text(text.chars().take(40).collect()),
        }
    }
}

/// Values by name and row.
#[derive(Debug, Default)]
pub(super) struct Columns {
    names: Vec<String>,
    index: FxHashMap<String, usize>,
    values: Vec<Vec<(u32, Value)>>,
}

/// Value that is not a number where one is needed.
#[derive(Debug)]
pub(super) struct NoNumber {
    pub row: u32,
    pub text: String,
}

impl Columns {
    /// Sets the value of a row under a name, and replaces an earlier value.
    pub(super) fn set(&mut self, row: u32, name: &str, value: Value) {
        let at = self.index.get(name).copied().unwrap_or_else(|| {
            self.index.insert(name.to_owned(), self.names.len());
            self.names.push(name.to_owned());
            self.values.push(Vec::new());
            self.names.len() - 1
        });
        self.values[at].push((row, value));
    }

    /// Attribute names in order of first occurrence.
    pub(super) fn names(&self) -> &[String] {
        &self.names
    }

    /// Finds the first of `wanted` that equals a name reduced to lower case letters and digits.
    pub(super) fn find(&self, wanted: &[&str]) -> Option<&str> {
        wanted.iter().find_map(|w| self.names.iter().find(|name| plain(name) == *w)).map(String::as_str)
    }

    /// Values under a name, one per row; `None` for rows without a value.
    pub(super) fn values(&self, name: &str, rows: usize) -> Vec<Option<&Value>> {
        let mut dense = vec![None; rows];
        for (row, value) in self.index.get(name).map(|&at| self.values[at].as_slice()).unwrap_or_default() {
            if let Some(slot) = dense.get_mut(*row as usize) {
                *slot = Some(value);
            }
        }
        dense
    }

    /// Numbers under a name, one per row; NaN for rows without a value.
    pub(super) fn numbers(&self, name: &str, rows: usize) -> Result<Vec<f64>, NoNumber> {
        let number = |(row, value): (usize, Option<&Value>)| match value {
            None => Ok(f64::NAN),
            Some(Value::Number(number)) => Ok(*number),
            Some(Value::List(list)) if list.len() == 1 => Ok(list[0]),
            Some(Value::List(list)) => Err(NoNumber { row: row as u32, text: format!("{list:?}") }),
            Some(Value::Text(text)) if text.is_empty() => Ok(f64::NAN),
            Some(Value::Text(text)) => Err(NoNumber { row: row as u32, text: text.clone() }),
        };
        self.values(name, rows).into_iter().enumerate().map(number).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_lists_and_words() {
        assert_eq!(Value::of(" 1.5e1 "), Value::Number(15.0));
        assert_eq!(Value::of("(1, 2.5, -3)"), Value::List(vec![1.0, 2.5, -3.0]));
        assert_eq!(Value::of("[1 2]"), Value::List(vec![1.0, 2.0]));
        assert_eq!(Value::of("1 2 3 4 5"), Value::List(vec![1.0, 2.0, 3.0, 4.0]));
        assert_eq!(Value::of("root node"), Value::Text("root node".into()));
        assert_eq!(Value::of(""), Value::Text(String::new()));
    }

    #[test]
    fn the_last_value_of_a_row_holds() {
        let mut columns = Columns::default();
        columns.set(1, "Pos X", Value::Number(1.0));
        columns.set(1, "Pos X", Value::Number(2.0));
        columns.set(9, "Pos X", Value::Number(3.0));
        assert_eq!(columns.find(&["x", "posx"]), Some("Pos X"));
        let numbers = columns.numbers("Pos X", 3).unwrap();
        assert!(numbers[0].is_nan() && numbers[1] == 2.0 && numbers[2].is_nan());
        columns.set(2, "Pos X", Value::Text("wide".into()));
        assert_eq!(columns.numbers("Pos X", 3).unwrap_err().row, 2);
    }
}
