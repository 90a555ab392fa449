//! Locates the file with the other table by its name.

use std::path::{Path, PathBuf};

/// Name parts that identify node tables and edge tables.
const NODES: [&str; 5] = ["vertices", "nodes", "points", "vertex", "node"];
const EDGES: [&str; 5] = ["edges", "links", "segments", "vessels", "edge"];

/// Returns the partner file of a table, with true if it is the edge table.
pub(in crate::network) fn partner(path: &Path) -> Option<(PathBuf, bool)> {
    let name = path.file_name()?.to_str()?;
    other(path, name, &NODES, &EDGES)
        .map(|p| (p, true))
        .or_else(|| other(path, name, &EDGES, &NODES).map(|p| (p, false)))
}

/// Finds the first existing file whose name replaces a word of `here` by one of `there`.
fn other(path: &Path, name: &str, here: &[&str], there: &[&str]) -> Option<PathBuf> {
    let lower = name.to_ascii_lowercase();
    let (at, word) = here.iter().find_map(|word| lower.rfind(word).map(|at| (at, *word)))?;
    let as_here = |new: &str| {
        let first = name[at..].chars().next().is_some_and(char::is_uppercase);
        let all = name[at..at + word.len()].chars().all(char::is_uppercase);
        match (all, first) {
            (true, _) => new.to_ascii_uppercase(),
            (false, true) => new[..1].to_ascii_uppercase() + &new[1..],
            (false, false) => new.to_owned(),
        }
    };
    let with = |new: &&str| path.with_file_name(format!("{}{}{}", &name[..at], as_here(new), &name[at + word.len()..]));
    there.iter().map(with).find(|candidate| candidate.is_file())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_find_each_other() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        for name in ["rat_Nodes.csv", "rat_Edges.csv", "vertices.csv", "segments.csv", "alone.csv"] {
            std::fs::write(at(name), "x").unwrap();
        }
        assert_eq!(partner(&at("rat_Nodes.csv")), Some((at("rat_Edges.csv"), true)));
        assert_eq!(partner(&at("rat_Edges.csv")), Some((at("rat_Nodes.csv"), false)));
        assert_eq!(partner(&at("vertices.csv")), Some((at("segments.csv"), true)));
        assert_eq!(partner(&at("alone.csv")), None);
    }
}
