//! Lines of the width of the terminal, broken between words.

use super::colours::LABEL;

/// Minimum width of wrapped text, in columns.
const LEAST: usize = 24;

/// Width of the terminal on standard error or standard output, in columns; `None` without a terminal. The variable
/// `COLUMNS` takes precedence.
pub fn width() -> Option<usize> {
    let columns = std::env::var("COLUMNS").ok().and_then(|columns| columns.trim().parse().ok());
    let size = || {
        let size = terminal_size::terminal_size_of(std::io::stderr());
        size.or_else(terminal_size::terminal_size).map(|(terminal_size::Width(width), _)| usize::from(width))
    };
    columns.or_else(size).filter(|&width| width > 0)
}

/// Breaks the lines of a text that are longer than a width. Continued lines begin below the text of a row, or below the
/// indentation of their first line. A word that is longer than a line stays whole, so that paths can be copied.
pub fn wrapped(text: &str, width: usize) -> String {
    text.lines().map(|line| broken(line, width)).collect::<Vec<_>>().join("\n")
}

fn broken(line: &str, width: usize) -> String {
    let indent = indent(line);
    if line.chars().count() <= width || width < indent + LEAST {
        return line.to_owned();
    }
    let mut out = String::new();
    let mut column = 0;
    // Blanks before a word belong to it, so that aligned text keeps its shape.
    for word in words(line) {
        let length = word.chars().count();
        if column > indent && column + length > width {
            out.push('\n');
            out.push_str(&" ".repeat(indent));
            let word = word.trim_start();
            out.push_str(word);
            column = indent + word.chars().count();
        } else {
            out.push_str(word);
            column += length;
        }
    }
    out
}

/// Column in which the continuation of a line begins.
fn indent(line: &str) -> usize {
    let blanks = line.len() - line.trim_start().len();
    let is_row = line.split_at_checked(LABEL).is_some_and(|(label, rest)| {
        let name = label.trim_end();
        let is_name = !name.is_empty() && name.chars().all(|c| c.is_ascii_lowercase());
        is_name && rest.starts_with(' ') && !rest.starts_with("  ")
    });
    if is_row { LABEL + 1 } else { blanks + 2 }
}

/// Words with the blanks before them. A percent sign belongs to its number.
fn words(line: &str) -> impl Iterator<Item = &str> {
    let mut rest = line;
    std::iter::from_fn(move || {
        let start = rest.len() - rest.trim_start().len();
        let mut end = rest[start..].find(' ').map_or(rest.len(), |at| start + at);
        if rest[end..].starts_with(" %") {
            end += 2;
        }
        let (word, left) = rest.split_at(end);
        rest = left;
        (!word.is_empty()).then_some(word)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_and_notes_continue_below_their_text() {
        let row = "axis     displaced by median 0.1 radii, 99 % 0.2, max 0.3 at node 7";
        let expected = "axis     displaced by median 0.1 radii,\n         99 % 0.2, max 0.3 at node 7";
        assert_eq!(wrapped(row, 43), expected);
        assert_eq!(wrapped(row, 200), row);
        let note = "  edges 1-2 and 3-4: distance 0.25, sum of radii 2.0";
        assert_eq!(wrapped(note, 36), "  edges 1-2 and 3-4: distance 0.25,\n    sum of radii 2.0");
        let path = "file     a/rather/long/path/that/has/no/blanks/and/stays/whole.vtu (1 kB)";
        assert!(wrapped(path, 40).contains("a/rather/long/path/that/has/no/blanks/and/stays/whole.vtu"));
        assert!(wrapped(path, 40).lines().skip(1).all(|line| line.starts_with("         ")));
        assert_eq!(wrapped("too narrow for words", 8), "too narrow for words");
    }

    #[test]
    fn no_word_is_lost() {
        let text = "network  30 nodes, 29 edges\n\n  a longer note that has to be broken several times to fit into few columns";
        for width in 20..90 {
            let broken = wrapped(text, width);
            let words = |text: &str| text.split_whitespace().map(str::to_owned).collect::<Vec<_>>();
            assert_eq!(words(&broken), words(text));
            assert!(width < 34 || broken.lines().all(|line| line.chars().count() <= width), "{broken}");
        }
    }
}
