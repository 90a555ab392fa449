//! Reader of a node table and an edge table.

use super::error::{CsvError, Table};
use crate::network::columns::Value;
use crate::network::content::{NetworkFile, NetworkOptions};
use crate::network::graph::{Graph, GraphPlace};
use crate::network::radii::plain;
use anastomesh_mesh::units::counted;

/// Names of node id columns.
const IDS: &[&str] = &["id", "nodeid", "node", "vertexid", "vertex", "name", "label", "index", ""];
/// Names of the column pairs with the ends of an edge.
const ENDS: [[&str; 2]; 16] = [
    ["source", "target"],
    ["from", "to"],
    ["node1id", "node2id"],
    ["node1", "node2"],
    ["nodea", "nodeb"],
    ["start", "end"],
    ["startnode", "endnode"],
    ["sourceid", "targetid"],
    ["fromnode", "tonode"],
    ["vertex1", "vertex2"],
    ["v1", "v2"],
    ["n1", "n2"],
    ["u", "v"],
    ["tail", "head"],
    ["parent", "child"],
    ["in", "out"],
];

/// Reads both tables from one file, separated by an empty line.
pub(in crate::network) fn read(bytes: &[u8], options: &NetworkOptions) -> Result<NetworkFile, CsvError> {
    let trimmed = bytes.trim_ascii_end();
    let mut begin = 0;
    // Blank lines before the first table are no separator.
    let mut in_table = false;
    for line in trimmed.split_inclusive(|&b| b == b'\n') {
        let end = begin + line.len();
        let blank = line.trim_ascii().is_empty();
        if blank && in_table {
            return tables((&trimmed[..begin], 0), (&trimmed[end..], lines(&trimmed[..end])), options);
        }
        in_table |= !blank;
        begin = end;
    }
    Err(CsvError::OneTable)
}

/// Reads a node table and an edge table from two files.
pub(in crate::network) fn read_tables(
    nodes: &[u8],
    edges: &[u8],
    options: &NetworkOptions,
) -> Result<NetworkFile, CsvError> {
    tables((nodes, 0), (edges, 0), options)
}

/// Number of lines of a text that ends with a line break.
fn lines(text: &[u8]) -> usize {
    text.split(|&b| b == b'\n').count() - 1
}

/// Reads two tables, each with the number of lines before it.
fn tables(nodes: (&[u8], usize), edges: (&[u8], usize), options: &NetworkOptions) -> Result<NetworkFile, CsvError> {
    let mut graph = Graph::default();
    add_nodes(&mut graph, nodes)?;
    add_edges(&mut graph, edges)?;
    Ok(graph.into_network(options)?)
}

fn add_nodes(graph: &mut Graph, (bytes, before): (&[u8], usize)) -> Result<(), CsvError> {
    let mut rows = Rows::of(bytes, before, Table::Nodes)?;
    let id = rows.column(IDS);
    while let Some(place) = rows.next()? {
        let row = match id {
            Some(id) => graph.node(rows.field(id), place)?,
            // Without an id column, nodes are named by their order.
            None => graph.node(&(rows.count - 1).to_string(), place)?,
        };
        rows.each(|name, value| graph.nodes.set(row, name, value));
    }
    Ok(())
}

fn add_edges(graph: &mut Graph, (bytes, before): (&[u8], usize)) -> Result<(), CsvError> {
    let mut rows = Rows::of(bytes, before, Table::Edges)?;
    let both = |[from, to]: [&str; 2]| rows.column(&[from]).zip(rows.column(&[to]));
    let ends = ENDS.into_iter().find_map(both);
    let (from, to) =
        ends.ok_or_else(|| CsvError::NoEnds { available: rows.names.iter().take(40).cloned().collect() })?;
    while let Some(place) = rows.next()? {
        let row = graph.edge([rows.field(from), rows.field(to)], place)?;
        rows.each(|name, value| graph.edges.set(row, name, value));
    }
    Ok(())
}

/// Rows of a table.
struct Rows<'a> {
    reader: csv::Reader<&'a [u8]>,
    table: Table,
    /// Column names.
    names: Vec<String>,
    record: csv::ByteRecord,
    /// Number of rows read.
    count: usize,
    /// Number of lines before the table.
    before: usize,
}

impl<'a> Rows<'a> {
    fn of(bytes: &'a [u8], before: usize, table: Table) -> Result<Self, CsvError> {
        let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
        let mut reader = csv::ReaderBuilder::new()
            .delimiter(delimiter(bytes))
            .trim(csv::Trim::All)
            .comment(Some(b'#'))
            .from_reader(bytes);
        let head = reader.byte_headers().map_err(|error| row_error(&error, table, before))?;
        let names = head.iter().map(|name| String::from_utf8_lossy(name).into_owned()).collect();
        Ok(Self { reader, table, names, record: csv::ByteRecord::new(), count: 0, before })
    }

    /// Finds the first column with one of these names, reduced to lower case letters and digits.
    fn column(&self, wanted: &[&str]) -> Option<usize> {
        wanted.iter().find_map(|w| self.names.iter().position(|name| plain(name) == *w))
    }

    /// Advances to the next row and returns its position.
    fn next(&mut self) -> Result<Option<GraphPlace>, CsvError> {
        let table = self.table;
        let there = self.reader.read_byte_record(&mut self.record);
        if !there.map_err(|error| row_error(&error, table, self.before))? {
            return Ok(None);
        }
        self.count += 1;
        let line = self.record.position().map_or(0, |p| p.line() as usize);
        Ok(Some(GraphPlace::Line(self.before + line)))
    }

    fn field(&self, column: usize) -> &str {
        self.record.get(column).and_then(|field| std::str::from_utf8(field).ok()).unwrap_or_default()
    }

    /// Calls `set` for each column name and value of the row.
    fn each(&self, mut set: impl FnMut(&str, Value)) {
        for (name, field) in self.names.iter().zip(&self.record) {
            set(name, Value::of(&String::from_utf8_lossy(field)));
        }
    }
}

/// Error of a row, with its line counted from the start of the file.
fn row_error(error: &csv::Error, table: Table, before: usize) -> CsvError {
    let line = before + error.position().map_or(1, |p| p.line() as usize);
    let what = match error.kind() {
        csv::ErrorKind::UnequalLengths { expected_len, len, .. } => {
            let found = counted(usize::try_from(*len).unwrap_or(usize::MAX), "column");
            format!("{found} where the first row has {expected_len}")
        }
        _ => error.to_string(),
    };
    CsvError::Row { line, table, what }
}

/// Detects the column delimiter: the most frequent candidate in the first line.
fn delimiter(bytes: &[u8]) -> u8 {
    let head = bytes.split(|&b| b == b'\n').find(|line| !line.trim_ascii().is_empty() && !line.starts_with(b"#"));
    let times = |d: u8| head.unwrap_or_default().split(|&b| b == d).count();
    [b',', b'\t', b';'].into_iter().max_by_key(|&d| times(d)).unwrap_or(b',')
}
