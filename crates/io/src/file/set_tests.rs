//! Tests of sets of outputs whose moves fail.

use super::OutputSet;
use crate::file::hidden::is_hidden_name;
use crate::file::staged::{Contents, Staged};
use crate::file::{AtomicFile, AtomicFolder};
use std::fs::{self, File};
use std::io;
use std::path::Path;
use std::time::{Duration, SystemTime};

/// All files below a folder with their text, in order; folders have the text `/`.
fn state(folder: &Path) -> Vec<(String, String)> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let entry = entry.unwrap();
        let name = entry.file_name().into_string().unwrap();
        if entry.path().is_dir() {
            found.extend(state(&entry.path()).into_iter().map(|(inner, text)| (format!("{name}/{inner}"), text)));
            found.push((name, "/".into()));
        } else {
            found.push((name, fs::read_to_string(entry.path()).unwrap()));
        }
    }
    found.sort();
    found
}

fn is_ours(name: &str) -> bool {
    name == "points"
}

/// Set of a mesh, a folder, a table and a page, which have this text.
fn outputs(folder: &Path, text: &str) -> OutputSet {
    let mut outputs = OutputSet::default();
    outputs.add_bytes(&folder.join("a.vtu"), text.as_bytes()).unwrap();
    let case = AtomicFolder::create(&folder.join("a.foam"), is_ours).unwrap();
    case.put("points", text.as_bytes()).unwrap();
    outputs.append(case.stage());
    outputs.add_bytes(&folder.join("a.csv"), text.as_bytes()).unwrap();
    outputs.add_bytes(&folder.join("a.html"), text.as_bytes()).unwrap();
    outputs
}

/// State after the set with this text was placed.
fn complete(text: &str) -> Vec<(String, String)> {
    let files = [("a.csv", text), ("a.foam", "/"), ("a.foam/points", text), ("a.html", text), ("a.vtu", text)];
    files.map(|(name, text)| (name.to_owned(), text.to_owned())).into()
}

#[test]
fn outputs_appear_together_and_replace_earlier_ones() {
    let folder = tempfile::tempdir().unwrap();
    let waiting = outputs(folder.path(), "first");
    let temporary = waiting.temporary(&folder.path().join("a.csv")).unwrap();
    assert_eq!(fs::read_to_string(temporary).unwrap(), "first");
    assert!(waiting.temporary(&folder.path().join("b.csv")).is_none());
    assert!(state(folder.path()).iter().all(|(name, _)| name.starts_with('.')));
    drop(waiting);
    assert!(state(folder.path()).is_empty());
    for text in ["first", "second"] {
        outputs(folder.path(), text).place().unwrap();
        assert_eq!(state(folder.path()), complete(text));
    }
    OutputSet::default().place().unwrap();
}

#[test]
fn a_failed_move_takes_back_all_others() {
    for has_earlier in [false, true] {
        let folder = tempfile::tempdir().unwrap();
        if has_earlier {
            outputs(folder.path(), "first").place().unwrap();
            fs::remove_file(folder.path().join("a.html")).unwrap();
        }
        let waiting = outputs(folder.path(), "second");
        // A folder in the way of the last file.
        fs::create_dir(folder.path().join("a.html")).unwrap();
        let before: Vec<_> = state(folder.path()).into_iter().filter(|(name, _)| !name.starts_with('.')).collect();
        let error = waiting.place().unwrap_err();
        assert_eq!(error.path, folder.path().join("a.html"));
        assert!(error.to_string().contains("a.html: cannot be written: "), "{error}");
        assert_eq!(state(folder.path()), before);
    }
}

#[test]
fn nothing_is_moved_if_an_output_is_known_to_fail() {
    let folder = tempfile::tempdir().unwrap();
    outputs(folder.path(), "first").place().unwrap();
    let waiting = outputs(folder.path(), "second");
    fs::write(folder.path().join("a.foam/result"), "theirs").unwrap();
    let error = waiting.place().unwrap_err();
    assert_eq!(error.source.kind(), io::ErrorKind::AlreadyExists);
    assert_eq!(fs::read_to_string(folder.path().join("a.vtu")).unwrap(), "first");
    assert!(state(folder.path()).iter().all(|(name, _)| !name.starts_with('.')));
}

#[test]
fn an_output_without_a_temporary_file_takes_back_all_others() {
    let folder = tempfile::tempdir().unwrap();
    outputs(folder.path(), "first").place().unwrap();
    for name in ["a.vtu", "a.csv", "a.html"] {
        let waiting = outputs(folder.path(), "second");
        fs::remove_file(waiting.temporary(&folder.path().join(name)).unwrap()).unwrap();
        assert_eq!(waiting.place().unwrap_err().path, folder.path().join(name));
        assert_eq!(state(folder.path()), complete("first"));
    }
}

#[test]
fn an_earlier_file_that_cannot_be_restored_is_named_and_kept() {
    let folder = tempfile::tempdir().unwrap();
    let [mesh, case, table, page] = ["a.vtu", "a.foam", "a.csv", "a.html"].map(|name| folder.path().join(name));
    outputs(folder.path(), "first").place().unwrap();
    let OutputSet { mut staged } = outputs(folder.path(), "second");
    for (i, output) in staged.iter_mut().enumerate() {
        output.keep_earlier(i == 3).unwrap();
        output.place().unwrap();
    }
    // A new file and a new folder that others have replaced in the meantime.
    fs::remove_file(&mesh).unwrap();
    fs::create_dir(&mesh).unwrap();
    fs::remove_dir_all(&case).unwrap();
    let sentences: Vec<String> =
        staged.iter_mut().filter_map(|output| output.take_back().err().map(|_| output.unrestored())).collect();
    assert_eq!(sentences.len(), 2, "{sentences:?}");
    drop(staged);
    for (sentence, target) in sentences.iter().zip([&mesh, &case]) {
        let (start, hidden) = sentence.split_once(": its earlier version is ").unwrap();
        assert_eq!(start, format!("{} could not be restored", target.display()));
        let hidden = Path::new(hidden);
        // Later runs do not remove it.
        let long_ago = SystemTime::now() - Duration::from_secs(3600);
        File::open(hidden).unwrap().set_modified(long_ago).unwrap();
        fs::remove_dir_all(&mesh).unwrap_or_default();
        AtomicFile::create(&mesh).unwrap().commit().unwrap();
        drop(AtomicFolder::create(&case, is_ours).unwrap());
        let file = if hidden.is_dir() { hidden.join("points") } else { hidden.to_owned() };
        assert_eq!(fs::read_to_string(file).unwrap(), "first");
    }
    // The other two are as they were, but no earlier version of the last one was kept.
    assert_eq!(fs::read_to_string(table).unwrap(), "first");
    assert!(!page.exists());
}

/// Files of a folder that cannot be removed.
#[derive(Debug)]
struct Stuck;

impl Contents for Stuck {
    fn ensure_replaceable(&self, _: &Path) -> io::Result<()> {
        Ok(())
    }

    fn remove(&self, _: &Path) {}
}

#[test]
fn an_earlier_folder_that_cannot_be_removed_is_left_to_later_runs() {
    let folder = tempfile::tempdir().unwrap();
    let [target, temporary] = ["a.foam", "new"].map(|name| folder.path().join(name));
    for (path, text) in [(&target, "first"), (&temporary, "second")] {
        fs::create_dir(path).unwrap();
        fs::write(path.join("points"), text).unwrap();
    }
    OutputSet::one(Staged::folder(temporary, target.clone(), None, Box::new(Stuck))).place().unwrap();
    assert_eq!(fs::read_to_string(target.join("points")).unwrap(), "second");
    let names: Vec<String> = state(folder.path()).into_iter().map(|(name, _)| name).collect();
    let hidden: Vec<&String> = names.iter().filter(|name| name.starts_with('.') && !name.contains('/')).collect();
    assert!(hidden.len() == 1 && is_hidden_name(hidden[0].as_ref(), "a.foam", "part"), "{names:?}");
}
