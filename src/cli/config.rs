//! `--config PLAN.toml`: options from a file, and the resolved options beside the output.
//!
//! Keys are the long names of options. Command-line options take precedence.

use std::ffi::{OsStr, OsString};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use clap::parser::ValueSource;
use clap::{Arg, ArgAction, ArgMatches, Command};
use toml::Value;

use super::exit::Failure;
use anastomesh_io::write_text;

const OPTION: &str = "--config";
/// Options of this run.
static OPTIONS: OnceLock<Vec<Vec<String>>> = OnceLock::new();

/// Command line with the options of the file inserted before the typed ones, and the path of the file.
pub fn expanded(mut words: Vec<OsString>, definition: &Command) -> Result<(Vec<OsString>, Option<PathBuf>), Failure> {
    let is_option = |word: &OsString| word == OPTION || word.to_string_lossy().starts_with("--config=");
    let Some(at) = words.iter().position(is_option) else { return Ok((words, None)) };
    let word = words.remove(at);
    let file = match word.to_string_lossy().strip_prefix("--config=") {
        Some(file) => PathBuf::from(file),
        None if at < words.len() => PathBuf::from(words.remove(at)),
        None => return Err(Failure::usage("--config needs a file: --config PLAN.toml")),
    };
    let verb = words.iter().enumerate().skip(1).find_map(|(i, word)| Some((i, find(definition, word)?)));
    let Some((place, verb)) = verb else {
        return Err(Failure::usage("--config needs a command: anastomesh mesh --config PLAN.toml …"));
    };
    let options = options(&file, verb)?;
    words.splice(place + 1..=place, options);
    Ok((words, Some(file)))
}

fn find<'a>(definition: &'a Command, word: &OsStr) -> Option<&'a Command> {
    definition.get_subcommands().find(|verb| word == verb.get_name())
}

/// Options of a file as command-line words.
fn options(file: &Path, verb: &Command) -> Result<Vec<OsString>, Failure> {
    let path = file.display();
    let text = std::fs::read_to_string(file).map_err(|e| Failure::unreadable(file, &e))?;
    let table: toml::Table = text.parse().map_err(|e| Failure::input(format!("{path}: {e}")))?;
    let mut words = Vec::new();
    for (key, value) in &table {
        if !verb.get_arguments().any(|arg| arg.get_long() == Some(key)) || key == "config" {
            let name = verb.get_name();
            return Err(Failure::input(format!(
                "{path}: unknown option '{key}' of {name}; `{name} --help` lists all options"
            )));
        }
        words.extend(typed(key, value).ok_or_else(|| {
            Failure::input(format!("{path}: '{key}' must be a number, a string, a boolean, or a list of these"))
        })?);
    }
    Ok(words)
}

/// Option as command-line words; `None` if the type of the value is not supported.
fn typed(key: &str, value: &Value) -> Option<Vec<OsString>> {
    let word = |value: &dyn std::fmt::Display| Some(vec![format!("--{key}={value}").into()]);
    match value {
        Value::Boolean(true) => Some(vec![format!("--{key}").into()]),
        Value::Boolean(false) => Some(Vec::new()),
        Value::Integer(n) => word(n),
        Value::Float(x) => word(x),
        Value::String(text) => word(text),
        Value::Array(list) => {
            let all: Option<Vec<_>> = list.iter().map(|value| typed(key, value)).collect();
            Some(all?.concat())
        }
        Value::Datetime(_) | Value::Table(_) => None,
    }
}

/// Writes all options of a command with their values beside its output; defaults are commented out.
pub fn write_resolved(verb: &Command, matches: &ArgMatches) -> Result<(), Failure> {
    let Ok(Some(output)) = matches.try_get_one::<PathBuf>("output") else { return Ok(()) };
    let mut name = output.file_stem().unwrap_or_default().to_owned();
    name.push("_plan.toml");
    let path = output.with_file_name(name);
    let mut text = format!("# anastomesh {} {}\n", env!("CARGO_PKG_VERSION"), verb.get_name());
    for arg in verb.get_arguments() {
        let Some((key, value)) = resolved(arg, matches) else { continue };
        // Defaults are comments, as some options are valid only together with others.
        let asked = matches.value_source(arg.get_id().as_str()) != Some(ValueSource::DefaultValue);
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{}{key} = {value}", if asked { "" } else { "# " });
    }
    write_text(&path, &text).map_err(|e| Failure::unwritable(&path, &e))
}

/// All options of a verb: name, value, and source of the value. Given ones come first.
pub fn options_in_force() -> &'static [Vec<String>] {
    OPTIONS.get().map_or(&[], Vec::as_slice)
}

/// Keeps the options of this run for `options_in_force`.
pub fn keep_options(verb: &Command, matches: &ArgMatches) {
    let row = |arg: &Arg| {
        let key = arg.get_long().filter(|key| !matches!(*key, "help" | "version"))?;
        let value = match resolved(arg, matches) {
            Some((_, Value::String(text))) => text,
            Some((_, value)) => value.to_string(),
            None => "none".into(),
        };
        let is_given = !matches!(matches.value_source(arg.get_id().as_str()), None | Some(ValueSource::DefaultValue));
        Some(vec![format!("--{key}"), value, if is_given { "given" } else { "default" }.into()])
    };
    let mut rows: Vec<Vec<String>> = verb.get_arguments().filter_map(row).collect();
    rows.sort_by_key(|row| row[2] == "default");
    // The process runs one verb; a second call changes nothing.
    let _ = OPTIONS.set(rows);
}

/// Option and its value, if present.
fn resolved<'a>(arg: &'a Arg, matches: &ArgMatches) -> Option<(&'a str, Value)> {
    let key = arg.get_long().filter(|key| !matches!(*key, "config" | "help" | "version"))?;
    let id = arg.get_id().as_str();
    if matches!(arg.get_action(), ArgAction::SetTrue) {
        return Some((key, Value::Boolean(matches.get_flag(id))));
    }
    let values: Vec<Value> = matches.try_get_raw(id).ok()??.map(|raw| value(&raw.to_string_lossy())).collect();
    match &values[..] {
        [] => None,
        [one] => Some((key, one.clone())),
        _ => Some((key, Value::Array(values))),
    }
}

/// TOML value of a text: a number if possible.
fn value(text: &str) -> Value {
    if let Ok(n) = text.parse::<i64>() {
        return Value::Integer(n);
    }
    match text.parse::<f64>() {
        Ok(x) if x.is_finite() => Value::Float(x),
        _ => Value::String(text.to_owned()),
    }
}
