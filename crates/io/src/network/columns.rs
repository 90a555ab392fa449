//! What a file says of its nodes or edges under names: numbers, short lists of them, or words.
//!
//! Values are kept with the row that has them, so that memory grows with the file, whatever names it makes up.

use super::radii::plain;
use rustc_hash::FxHashMap;

/// A value under a name.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Value {
    Number(f64),
    /// At most four are kept: one more than a position has.
    List(Vec<f64>),
    /// Anything else; the beginning of it.
    Text(String),
}

impl Value {
    /// What a text holds: a number, or a list such as `1 2 3`, `(1, 2, 3)` or `[1;2]`, or words.
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

/// A value that is no number where one is needed.
#[derive(Debug)]
pub(super) struct NoNumber {
    pub row: u32,
    pub text: String,
}

impl Columns {
    /// Sets what a row has under a name; what it had before is replaced.
    pub(super) fn set(&mut self, row: u32, name: &str, value: Value) {
        let at = self.index.get(name).copied().unwrap_or_else(|| {
            self.index.insert(name.to_owned(), self.names.len());
            self.names.push(name.to_owned());
            self.values.push(Vec::new());
            self.names.len() - 1
        });
        self.values[at].push((row, value));
    }

    /// The names, in the order in which they first came.
    pub(super) fn names(&self) -> &[String] {
        &self.names
    }

    /// The first name that fits, in lower case with letters and digits only, one of `wanted`; the earlier of these first.
    pub(super) fn find(&self, wanted: &[&str]) -> Option<&str> {
        wanted.iter().find_map(|w| self.names.iter().find(|name| plain(name) == *w)).map(String::as_str)
    }

    /// The values under a name, one per row; none where a row has none.
    pub(super) fn values(&self, name: &str, rows: usize) -> Vec<Option<&Value>> {
        let mut dense = vec![None; rows];
        for (row, value) in self.index.get(name).map(|&at| self.values[at].as_slice()).unwrap_or_default() {
            if let Some(slot) = dense.get_mut(*row as usize) {
                *slot = Some(value);
            }
        }
        dense
    }

    /// The numbers under a name, one per row; not a number where a row has none.
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
