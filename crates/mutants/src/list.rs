//! Mutants of a source tree, as cargo-mutants lists them.

use serde_json::Value;
use std::io;
use std::path::Path;
use std::process::Command;

/// Kind of a mutant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Genre {
    /// The body of a function becomes a constant.
    Value,
    /// A binary operator, also one that assigns, becomes another.
    Binary,
    /// A unary operator is deleted.
    Unary,
    /// An arm of a `match` is deleted.
    Arm,
    /// The guard of an arm becomes `true` or `false`.
    Guard,
}

/// A small change of the sources.
#[derive(Clone, Debug)]
pub struct Mutant {
    /// Path of the source file from the root of the tree.
    pub file: String,
    /// Kind. `None` for kinds that are not tried.
    pub genre: Option<Genre>,
    /// New text.
    pub replacement: String,
    /// Line and column of the change, both from 1. Columns count characters.
    pub start: (usize, usize),
    /// Name, such as `src/a.rs:3:7: replace + with - in f`.
    pub name: String,
}

/// Mutants of all packages of the tree.
///
/// # Errors
///
/// cargo-mutants cannot be run, or its list cannot be read.
pub fn mutants(tree: &Path) -> io::Result<Vec<Mutant>> {
    let output =
        Command::new("cargo").args(["mutants", "--list", "--json", "--workspace"]).current_dir(tree).output()?;
    if !output.status.success() {
        return Err(io::Error::other(String::from_utf8_lossy(&output.stderr).into_owned()));
    }
    let list: Vec<Value> = serde_json::from_slice(&output.stdout)?;
    let parsed: Option<Vec<Mutant>> = list.iter().map(mutant).collect();
    parsed.ok_or_else(|| io::Error::other("the list of cargo-mutants has an unknown form: install version 27"))
}

fn mutant(json: &Value) -> Option<Mutant> {
    let text = |key: &str| json[key].as_str().map(str::to_owned);
    let position = |key: &str| json["span"]["start"][key].as_u64().map(|n| n as usize);
    let returned = json["function"]["return_type"].as_str().unwrap_or_default();
    let genre = match json["genre"].as_str()? {
        // A constant has another type than the `impl Trait` of the function's last expression.
        "FnValue" if returned.contains("impl ") => None,
        "FnValue" => Some(Genre::Value),
        "BinaryOperator" => Some(Genre::Binary),
        "UnaryOperator" => Some(Genre::Unary),
        "MatchArm" => Some(Genre::Arm),
        "MatchArmGuard" => Some(Genre::Guard),
        _ => None,
    };
    Some(Mutant {
        file: text("file")?,
        genre,
        replacement: text("replacement")?,
        start: (position("line")?, position("column")?),
        name: text("name")?,
    })
}
