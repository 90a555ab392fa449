//! Table of flow rates over time, from a CSV file.

use super::{Waveform, WaveformFault};
use crate::file::FileError;
use anastomesh_mesh::units::counted;
use std::path::Path;

/// Flow rates over one period, for one or several inlets.
///
/// The first column of the file is the time in seconds. Each further column is a flow rate, in volume per second. The
/// first row names the columns; rows that begin with `#` are comments.
///
/// ```
/// use anastomesh_io::flow::FlowTable;
///
/// let table = FlowTable::parse(b"time,flow\n0,1\n0.4,3\n0.8,1\n")?;
/// let (name, waveform) = &table.columns()[0];
/// assert_eq!((name.as_str(), waveform.period(), waveform.mean()), ("flow", 0.8, 2.0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct FlowTable {
    columns: Vec<(String, Waveform)>,
}

/// Error of a table of flow rates.
pub type FlowTableError = FileError<FlowTableFault>;

/// Reason why a file is not a table of flow rates. Lines are numbered from 1.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FlowTableFault {
    /// The file is not UTF-8 text.
    #[error("line {line}: not UTF-8 text; write the table as text, with commas")]
    NotText {
        /// Line of the file.
        line: usize,
    },
    /// The first row holds a number.
    #[error("line {line}: the first row begins with {text}; name the columns, such as 'time,flow'")]
    NoHeader {
        /// Line of the file.
        line: usize,
        /// First field.
        text: String,
    },
    /// The header has a single column.
    #[error(
        "line {line}: the only column is '{column}'; give times and at least one column of flow rates, with commas"
    )]
    NoRates {
        /// Line of the file.
        line: usize,
        /// Its column.
        column: String,
    },
    /// Two columns have the same name.
    #[error("line {line}: two columns are named '{column}'; name each by its inlet")]
    NamedTwice {
        /// Line of the file.
        line: usize,
        /// Name of the columns.
        column: String,
    },
    /// A row has another number of fields than the header.
    #[error("line {line}: {} instead of {expected}; give a time and a rate for each column", counted(*found, "field"))]
    FieldCount {
        /// Line of the file.
        line: usize,
        /// Number of fields.
        found: usize,
        /// Number of columns.
        expected: usize,
    },
    /// A field is empty.
    #[error("line {line}, column '{column}': empty; give a number, or remove the row")]
    Gap {
        /// Line of the file.
        line: usize,
        /// Name of the column.
        column: String,
    },
    /// A field is not a number.
    #[error("line {line}, column '{column}': expected a number, found '{text}'; correct it")]
    NotANumber {
        /// Line of the file.
        line: usize,
        /// Name of the column.
        column: String,
        /// Text found.
        text: String,
    },
    /// The samples of a column are not one period.
    #[error("line {line}, column '{column}': {fault}")]
    Samples {
        /// Line of the file.
        line: usize,
        /// Name of the column.
        column: String,
        /// Fault of the samples.
        fault: WaveformFault,
    },
}

impl FlowTable {
    /// Table with these named columns.
    #[must_use]
    pub fn new(columns: Vec<(String, Waveform)>) -> Self {
        Self { columns }
    }

    /// Reads a file.
    ///
    /// # Errors
    /// [`FlowTableError`] with the path, the line and the column.
    pub fn read(path: &Path) -> Result<Self, FlowTableError> {
        let bytes = std::fs::read(path).map_err(|source| FileError::Read { path: path.into(), source })?;
        if bytes.trim_ascii().is_empty() {
            return Err(FileError::Empty { path: path.into() });
        }
        Self::parse(&bytes).map_err(|fault| FileError::Content { path: path.into(), fault })
    }

    /// Parses the contents of a file.
    ///
    /// # Errors
    /// [`FlowTableFault`] with the line and the column.
    pub fn parse(bytes: &[u8]) -> Result<Self, FlowTableFault> {
        let text = std::str::from_utf8(bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes)).map_err(|error| {
            let line = bytes[..error.valid_up_to()].split(|&byte| byte == b'\n').count();
            FlowTableFault::NotText { line }
        })?;
        let is_row = |(_, line): &(usize, &str)| !line.trim().is_empty() && !line.trim_start().starts_with('#');
        let mut rows = (1..).zip(text.lines()).filter(is_row).map(|(line, row)| (line, fields(row)));
        let (head_line, names) = header(rows.next().unwrap_or_default())?;
        let mut columns = vec![Vec::new(); names.len()];
        let mut lines = Vec::new();
        for (line, row) in rows {
            if row.len() != names.len() {
                return Err(FlowTableFault::FieldCount { line, found: row.len(), expected: names.len() });
            }
            for ((column, name), text) in columns.iter_mut().zip(&names).zip(row) {
                column.push(number(line, name, text)?);
            }
            lines.push(line);
        }
        let mut columns = columns.into_iter();
        let times = columns.next().unwrap_or_default();
        let waveform = |(name, rates): (&String, Vec<f64>)| {
            let made = Waveform::new(times.clone(), rates);
            made.map(|made| (name.clone(), made)).map_err(|fault| place(fault, &lines, head_line, [&names[0], name]))
        };
        Ok(Self { columns: names[1..].iter().zip(columns).map(waveform).collect::<Result<_, _>>()? })
    }

    /// Names and waveforms of the columns; all have the same times.
    #[must_use]
    pub fn columns(&self) -> &[(String, Waveform)] {
        &self.columns
    }

    /// Duration of a period in seconds; 0 for a table without columns.
    #[must_use]
    pub fn period(&self) -> f64 {
        self.columns.first().map_or(0.0, |(_, waveform)| waveform.period())
    }
}

/// Fields of a row, without spaces and quotation marks around them.
fn fields(row: &str) -> Vec<&str> {
    fn quoted(field: &str) -> Option<&str> {
        field.strip_prefix('"')?.strip_suffix('"')
    }
    row.split(',').map(str::trim).map(|field| quoted(field).unwrap_or(field)).collect()
}

/// Line and names of the header.
fn header((line, row): (usize, Vec<&str>)) -> Result<(usize, Vec<String>), FlowTableFault> {
    let names: Vec<String> = row.into_iter().map(str::to_owned).collect();
    match &names[..] {
        [first, ..] if first.parse::<f64>().is_ok() => {
            return Err(FlowTableFault::NoHeader { line, text: first.clone() });
        }
        [] | [_] => {
            return Err(FlowTableFault::NoRates { line, column: names.first().cloned().unwrap_or_default() });
        }
        _ => {}
    }
    match names.iter().enumerate().find(|(at, name)| names[..*at].contains(name)) {
        Some((_, column)) => Err(FlowTableFault::NamedTwice { line, column: column.clone() }),
        None => Ok((line, names)),
    }
}

fn number(line: usize, column: &str, text: &str) -> Result<f64, FlowTableFault> {
    let column = || column.to_owned();
    if text.is_empty() {
        return Err(FlowTableFault::Gap { line, column: column() });
    }
    text.parse().map_err(|_| FlowTableFault::NotANumber { line, column: column(), text: text.to_owned() })
}

/// Line and column of a fault.
fn place(fault: WaveformFault, lines: &[usize], head: usize, [times, rates]: [&String; 2]) -> FlowTableFault {
    let of = |sample: usize| lines.get(sample - 1).copied().unwrap_or(head);
    let last = lines.last().copied().unwrap_or(head);
    let (line, column) = match fault {
        WaveformFault::TooFew { .. } => (last, times),
        WaveformFault::NotFinite { sample, .. } => (of(sample), rates),
        WaveformFault::NotIncreasing { sample, .. } => (of(sample), times),
        WaveformFault::StartsLate { .. } => (of(1), times),
        WaveformFault::NotPeriodic { .. } => (last, rates),
    };
    FlowTableFault::Samples { line, column: column.clone(), fault }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fault(text: &str) -> String {
        FlowTable::parse(text.as_bytes()).unwrap_err().to_string()
    }

    #[test]
    fn columns_are_waveforms_with_the_times_of_the_first_column() {
        let text = "\u{feff}# aorta\ntime, inlet, inlet_1\n0,1,5\n\n# systole\n0.5,3,-1\n1, 1, 5\n";
        let table = FlowTable::parse(text.as_bytes()).unwrap();
        let names: Vec<&str> = table.columns().iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!((names, table.period()), (vec!["inlet", "inlet_1"], 1.0));
        assert_eq!([table.columns()[0].1.mean(), table.columns()[1].1.at(0.5)], [2.0, -1.0]);
    }

    #[test]
    fn faults_name_line_and_column() {
        assert!(fault("time\n0\n").starts_with("line 1: the only column is 'time'"));
        assert!(fault("0,1\n1,1\n").starts_with("line 1: the first row begins with 0"));
        assert!(fault("t,a,a\n0,1,1\n").starts_with("line 1: two columns are named 'a'"));
        assert!(fault("t,a\n0,1\n1\n").starts_with("line 3: 1 field instead of 2"));
        assert!(fault("t,a\n0,1\n0.5,\n1,1\n").starts_with("line 3, column 'a': empty"));
        assert!(
            fault("t,a\n0,1\n# note\nlater,1\n").starts_with("line 4, column 't': expected a number, found 'later'")
        );
        assert!(fault("t,a\n0,1\n0.5,nan\n1,1\n").starts_with("line 3, column 'a': sample 2 is not finite"));
        assert!(fault("t,a\n0,1\n0.5,1\n0.4,1\n").starts_with("line 4, column 't': time 0.4 of sample 3"));
        assert!(fault("t,a\n1,1\n2,1\n").starts_with("line 2, column 't': the first time is 1"));
        assert!(fault("t,a,b\n0,1,1\n1,1,2\n").starts_with("line 3, column 'b': the period ends with rate 2"));
        assert!(fault("t,a\n0,1\n").starts_with("line 2, column 't': 1 time and 1 rate"));
        assert!(matches!(FlowTable::parse(b"t,a\n0,\xff\n"), Err(FlowTableFault::NotText { line: 2 })));
    }

    #[test]
    fn files_are_named_in_errors() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("pulse.csv");
        let error = |path: &Path| FlowTable::read(path).unwrap_err().to_string();
        assert!(error(&path).contains("pulse.csv: cannot be read"));
        std::fs::write(&path, " \n").unwrap();
        assert!(error(&path).contains("pulse.csv: the file is empty"));
        std::fs::write(&path, "t,a\n0,1\n1,2\n").unwrap();
        assert!(error(&path).contains("pulse.csv: line 3, column 'a'"), "{}", error(&path));
    }
}
