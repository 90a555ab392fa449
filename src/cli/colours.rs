//! Terminal colours: errors red, success green, row labels cyan.

use std::fmt::Write as _;

use clap::builder::styling::{AnsiColor, Effects, Style};

const GOOD: Style = AnsiColor::Green.on_default().effects(Effects::BOLD);
const BAD: Style = AnsiColor::Red.on_default().effects(Effects::BOLD);
const ODD: Style = AnsiColor::Yellow.on_default().effects(Effects::BOLD);
const HEAD: Style = AnsiColor::Cyan.on_default();

/// Width of row labels, in columns.
pub const LABEL: usize = 8;

/// True if the environment allows colours (<https://no-color.org>).
pub fn are_wanted() -> bool {
    let is_set = |name| std::env::var_os(name).is_some_and(|value| !value.is_empty());
    !is_set("NO_COLOR") && std::env::var_os("TERM").is_none_or(|terminal| terminal != "dumb")
}

/// Returns a message with colours.
pub fn painted(level: &str, before: &str, message: &str) -> String {
    let mut out = match level {
        "error" => wrapped(BAD, before),
        "warning" => wrapped(ODD, before),
        _ => before.to_owned(),
    };
    if level == "failure" {
        return out + &wrapped(BAD, message);
    }
    if level != "result" {
        return out + message;
    }
    for (i, line) in message.lines().enumerate() {
        if i > 0 {
            out.push('\n');
        }
        out.push_str(&row(line));
    }
    out
}

/// Returns a line of a result with colours.
fn row(line: &str) -> String {
    let (blank, text) = line.split_at(line.len() - line.trim_start().len());
    let words = [
        (BAD, "FAIL"),
        (BAD, "FAILED"),
        (BAD, "NOT valid"),
        (GOOD, "valid"),
        (GOOD, "ok"),
        (GOOD, "no vessels overlap"),
        (ODD, "no fault found"),
    ];
    // Deeper lines continue a row.
    for (style, word) in words.into_iter().filter(|_| blank.len() <= LABEL) {
        if let Some(rest) = text.strip_prefix(word).filter(|rest| !rest.starts_with(char::is_alphanumeric)) {
            return format!("{blank}{}{rest}", wrapped(style, word));
        }
    }
    match line.split_at_checked(LABEL) {
        Some((word, rest)) if is_head(word) && rest.starts_with(' ') && !rest.starts_with("  ") => {
            format!("{}{rest}", wrapped(HEAD, word))
        }
        _ => line.to_owned(),
    }
}

/// True for a lower-case word padded with blanks.
fn is_head(word: &str) -> bool {
    let letters = word.trim_end();
    !letters.is_empty() && letters.chars().all(|c| c.is_ascii_lowercase())
}

fn wrapped(style: Style, text: &str) -> String {
    let mut out = String::new();
    // Writing to a string cannot fail.
    let _ = write!(out, "{style}{text}{style:#}");
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    /// As codes, to be read: {1 is the beginning of a colour, } its end.
    fn shown(level: &str, before: &str, message: &str) -> String {
        painted(level, before, message).replace("\u{1b}[0m", "}").replace("\u{1b}[", "{")
    }

    #[test]
    fn rows_verdicts_and_faults_have_colours_and_notes_have_none() {
        let text = "file     a.vtu (1 kB)\nFAIL every cap: 3 found\n         points 1 2\n  ok   caps\nNOT valid";
        let expected = "{36mfile    } a.vtu (1 kB)\n{1m{31mFAIL} every cap: 3 found\n         points 1 2\n  {1m{32mok}   caps\n\
                        {1m{31mNOT valid}";
        assert_eq!(shown("result", "", text), expected);
        assert_eq!(shown("note", "", text), text);
        assert_eq!(shown("error", "anastomesh: ", "a.swc: empty"), "{1m{31manastomesh: }a.swc: empty");
        assert_eq!(shown("result", "", "validness is all"), "validness is all");
    }
}
