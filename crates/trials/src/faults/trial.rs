//! One run with a fault, and the comparison of its files with undisturbed runs.

use super::jobs::{Files, Job, LIMITS, Reference};
use crate::judge::{Judged, Outcome, template};
use crate::process::{Ended, run};
use std::io;
use std::path::Path;

/// One run with a fault.
pub struct Trial<'a> {
    /// Command.
    pub job: &'a Job,
    /// Undisturbed results.
    pub reference: &'a Reference,
    /// Program under trial.
    pub mesher: &'a Path,
    /// Folder of the run.
    pub folder: &'a Path,
    /// True if files of an earlier run exist at the output.
    pub has_earlier: bool,
}

/// State of the files in the output folder, relative to both versions.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Place {
    /// All files are those before the run.
    Earlier,
    /// All files are those of a complete run.
    New,
    /// Each file is complete, but some are of the earlier run.
    Mixed(String),
    /// A file is neither of both.
    Broken(String),
}

/// Files that a run writes before its other output, and that stay if it fails later.
const EARLY: [&str; 1] = ["refined.vtp"];

/// Compares files with both versions. Names of neither version are left to the caller.
pub fn place(found: &Files, earlier: &Files, new: &Files) -> Place {
    for (name, bytes) in found {
        let known = [earlier, new].into_iter().filter_map(|files| files.get(name));
        let is_known = earlier.contains_key(name) || new.contains_key(name);
        if is_known && !known.into_iter().any(|known| known == bytes) {
            return Place::Broken(format!("{name} has {} bytes of neither version", bytes.len()));
        }
    }
    let is_as = |files: &Files| files.iter().all(|(name, bytes)| found.get(name) == Some(bytes));
    let is_early = |name: &String| EARLY.contains(&name.as_str());
    let is_kept = |(name, bytes)| found.get(name) == Some(bytes) || is_early(name);
    let is_known = |name| earlier.contains_key(name) || !new.contains_key(name) || is_early(name);
    if is_as(new) {
        return Place::New;
    }
    if earlier.iter().all(is_kept) && found.keys().all(is_known) {
        return Place::Earlier;
    }
    if let Some(name) = earlier.keys().find(|name| !found.contains_key(*name)) {
        return Place::Broken(format!("{name} of the earlier run is missing"));
    }
    let changed = new.iter().filter(|(name, bytes)| found.get(*name) == Some(*bytes));
    let names: Vec<&str> = changed.map(|(name, _)| name.as_str()).take(5).collect();
    Place::Mixed(format!("new: {}", names.join(", ")))
}

impl Trial<'_> {
    /// Files in the output folder before the run.
    pub fn earlier(&self) -> Files {
        if self.has_earlier { self.reference.earlier.clone() } else { Files::new() }
    }

    /// Names in the output folder that belong to neither version.
    fn strangers(&self, found: &Files) -> Vec<String> {
        let known = |name: &String| self.reference.new.contains_key(name) || self.reference.earlier.contains_key(name);
        found.keys().filter(|name| !known(name)).cloned().collect()
    }

    /// Outcome of a run that ended with a code: complete files, or earlier files and a message.
    pub fn after_code(&self, code: i32, stderr: &str, may_leave: bool) -> io::Result<Outcome> {
        let found = Job::output(self.folder)?;
        let place = place(&found, &self.earlier(), &self.reference.new);
        let strangers = self.strangers(&found);
        let what = format!("{}, exit code {code}: {}", self.job.line(), stderr.trim());
        if let (Place::Broken(text), true) = (&place, stderr.contains("panicked at")) {
            return Ok(finding("partial file", format!("{what}: {text}")));
        }
        if stderr.contains("failed printing to stderr") {
            return Ok(finding("stderr cannot be written", what));
        }
        if stderr.contains("panicked at") {
            return Ok(finding("panic", what));
        }
        if !strangers.is_empty() && !may_leave {
            return Ok(finding("files left", format!("{what}: {strangers:?}")));
        }
        Ok(match (code, place) {
            (_, Place::Broken(text)) => finding("partial file", format!("{what}: {text}")),
            (0, Place::New) => Outcome::Valid { by_both: true },
            (0, _) => finding("incomplete success", what),
            (_, Place::Mixed(text)) => finding("mixed files", format!("{what}: {text}")),
            (1 | 2 | 5.., _) if code != 130 => finding("exit code", what),
            (_, _) => match stderr.lines().find_map(|line| line.strip_prefix("anastomesh: ")) {
                Some(line) => Outcome::Typed { code, message: template(line) },
                None => finding("no message", what),
            },
        })
    }

    /// Runs the job again without a fault: it must complete with the same bytes.
    pub fn again(&self, outcome: Outcome) -> io::Result<Outcome> {
        if matches!(outcome, Outcome::Finding { .. }) {
            return Ok(outcome);
        }
        let run = run(self.mesher, &self.job.arguments(), self.folder, LIMITS)?;
        let found = Job::output(self.folder)?;
        let is_complete = self.reference.new.iter().all(|(name, bytes)| found.get(name) == Some(bytes));
        if run.ended == Ended::Code(0) && is_complete {
            return Ok(outcome);
        }
        let text = format!("{}: second run: {:?} {}", self.job.line(), run.ended, run.stderr.trim());
        Ok(finding("second run", text))
    }
}

/// Finding of a trial.
pub fn finding(sort: &'static str, text: String) -> Outcome {
    Outcome::Finding { sort, text }
}

/// Outcome of a fault that this machine cannot make.
pub fn skipped(why: &str) -> Judged {
    let outcome = Outcome::Typed { code: 0, message: format!("not tried: {why}") };
    Judged { outcome, seconds: 0.0, stderr: String::new() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::faults::jobs::JOBS;

    #[test]
    fn places_are_told() {
        let files = |list: &[(&str, &str)]| -> Files {
            list.iter().map(|(name, text)| ((*name).to_owned(), text.as_bytes().to_vec())).collect()
        };
        let (old, new) = (files(&[("a", "1"), ("b", "1")]), files(&[("a", "2"), ("b", "2"), ("c", "2")]));
        assert_eq!(place(&old, &old, &new), Place::Earlier);
        assert_eq!(place(&new, &old, &new), Place::New);
        assert!(matches!(place(&files(&[("a", "2"), ("b", "1")]), &old, &new), Place::Mixed(_)));
        assert!(matches!(place(&files(&[("a", "2"), ("b", "")]), &old, &new), Place::Broken(_)));
        assert!(matches!(place(&files(&[("a", "1")]), &old, &new), Place::Broken(_)));
        assert_eq!(place(&files(&[]), &files(&[]), &new), Place::Earlier);
        assert!(matches!(place(&files(&[("c", "2")]), &files(&[]), &new), Place::Mixed(_)));
        let [old, new] = ["1", "2"].map(|text| files(&[("a", text), ("refined.vtp", text)]));
        assert_eq!(place(&files(&[("a", "1"), ("refined.vtp", "2")]), &old, &new), Place::Earlier);
        assert!(matches!(place(&files(&[("a", "2"), ("refined.vtp", "1")]), &old, &new), Place::Mixed(_)));
    }

    #[test]
    fn jobs_have_lines() {
        assert!(JOBS.iter().all(|job| job.line().starts_with("anastomesh ")));
    }
}
