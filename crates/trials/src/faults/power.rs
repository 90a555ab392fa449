//! Loss of power: what was not flushed to the disk may be lost.
//!
//! A run is killed at a system call, and its calls are recorded by strace. Contents that were not flushed are then cut off or
//! replaced by zeros. The last changes of names that were not flushed are undone, as a journal of the file system would do.

use super::inject::{calls, strace};
use super::jobs::{Files, Job, LIMITS};
use super::trial::{Place, Trial, finding, place};
use crate::judge::{Judged, Outcome};
use crate::process::{Ended, run_command};
use crate::random::Random;
use std::collections::BTreeMap;
use std::fs::{self, OpenOptions};
use std::io::{self, Seek, SeekFrom, Write};
use std::path::Path;

/// Size of a page, the unit of loss.
const PAGE: u64 = 4096;

/// Loses power at a random call of a run, or after it, and runs the job again.
pub fn judge(trial: &Trial, random: &mut Random) -> io::Result<Judged> {
    let calls = match calls(trial)? {
        Ok(calls) => calls,
        Err(skipped) => return Ok(skipped),
    };
    let log = trial.folder.with_extension("power");
    let mut command = strace(trial, &log.to_string_lossy());
    if random.chance(0.75) {
        // Half of the losses come near the end, when outputs are moved.
        let first = if random.chance(0.5) { calls.len().saturating_sub(30) } else { 0 };
        let call = &calls[first + random.below(calls.len() - first)];
        command.args(["-e", &format!("inject={}:signal=KILL:when={}", call.name, call.number)]);
    }
    command.arg(trial.mesher).args(trial.job.arguments());
    let run = run_command(command, trial.folder, LIMITS)?;
    let (folder, earlier) = (trial.folder.canonicalize()?, trial.earlier());
    let mut disk = Disk::new(&folder, &earlier);
    disk.replay(&fs::read_to_string(&log)?);
    let lost = disk.lose(random)?;
    let outcome = trial.again(outcome(trial, &run.ended, &lost)?)?;
    Ok(Judged { outcome, seconds: run.seconds, stderr: run.stderr })
}

/// Outcome after the loss: complete files, new ones if the run had ended with success.
fn outcome(trial: &Trial, ended: &Ended, lost: &[String]) -> io::Result<Outcome> {
    let place = place(&Job::output(trial.folder)?, &trial.earlier(), &trial.reference.new);
    let what = format!("{}, {ended:?}, lost: {}", trial.job.line(), lost.join(", "));
    let typed = |message: &str| Outcome::Typed { code: 130, message: message.into() };
    Ok(match (place, ended) {
        (Place::Broken(text), _) => finding("partial file", format!("{what}: {text}")),
        (Place::New, _) => Outcome::Valid { by_both: true },
        (_, Ended::Code(0)) => finding("lost after success", what),
        (Place::Earlier, _) => typed("power was lost, earlier files intact"),
        (Place::Mixed(_), _) => typed("power was lost between two moves, complete files of both runs"),
    })
}

/// File as far as the log tells.
#[derive(Clone, Debug, Default)]
struct Written {
    bytes: u64,
    flushed: u64,
    /// Name in the output folder of the earlier run.
    earlier: Option<String>,
}

/// Change of names.
#[derive(Clone, Debug, PartialEq)]
enum Change {
    /// New file or link.
    File(String),
    Folder(String),
    Moved([String; 2]),
    Swapped([String; 2]),
    /// Removed file, and its name in the output folder of the earlier run.
    Removed(String, Option<String>),
    RemovedFolder(String),
}

/// Files below the folder of a run, and changes of names that were not flushed.
struct Disk<'a> {
    folder: &'a Path,
    earlier: &'a Files,
    files: BTreeMap<String, Written>,
    changes: Vec<Change>,
}

impl<'a> Disk<'a> {
    fn new(folder: &'a Path, earlier: &'a Files) -> Self {
        let of = |(name, bytes): (&String, &Vec<u8>)| {
            let size = bytes.len() as u64;
            (format!("out/{name}"), Written { bytes: size, flushed: size, earlier: Some(name.clone()) })
        };
        Self { folder, earlier, files: earlier.iter().map(of).collect(), changes: Vec::new() }
    }

    /// Follows the calls of a log. A call that another thread interrupts has two lines.
    fn replay(&mut self, log: &str) {
        let mut waiting: BTreeMap<&str, (&str, u64)> = BTreeMap::new();
        for line in log.lines() {
            let Some((thread, text)) = line.split_once(' ') else { continue };
            let text = text.trim_start();
            if let Some(begun) = text.strip_suffix(" <unfinished ...>") {
                waiting.insert(thread, (begun, self.size(begun)));
            } else if text.starts_with("<... ") {
                let Some((begun, size)) = waiting.remove(thread) else { continue };
                let rest = text.split_once("resumed>").map_or("", |(_, rest)| rest);
                self.call(&format!("{begun}{rest}"), size);
            } else {
                self.call(text, self.size(text));
            }
        }
    }

    /// Bytes written so far to the file of a call's descriptor.
    fn size(&self, text: &str) -> u64 {
        descriptors(text).first().and_then(|path| self.files.get(&self.name(path)?)).map_or(0, |file| file.bytes)
    }

    /// Name of a path relative to the folder.
    fn name(&self, path: &str) -> Option<String> {
        let path = Path::new(path);
        let relative = if path.is_absolute() { path.strip_prefix(self.folder).ok()? } else { path };
        Some(relative.to_string_lossy().into_owned())
    }

    /// Takes over a successful call. `size`: bytes of its file when it began.
    fn call(&mut self, text: &str, size: u64) {
        let Some((call, result)) = text.rsplit_once(" = ") else { return };
        let Some(number) = result.split([' ', '<']).next().and_then(|word| word.parse::<u64>().ok()) else { return };
        let Some((name, rest)) = call.split_once('(') else { return };
        let strings: Vec<String> = quoted(rest).into_iter().filter_map(|path| self.name(path)).collect();
        let descriptors: Vec<String> = descriptors(rest).into_iter().filter_map(|path| self.name(path)).collect();
        match (name, strings.as_slice(), descriptors.as_slice()) {
            ("openat", [path], _) if rest.contains("O_CREAT") => self.create(path),
            ("write" | "writev" | "pwrite64", _, [path, ..]) | ("copy_file_range", _, [_, path, ..]) => {
                self.files.entry(path.clone()).or_default().bytes += number;
            }
            ("fsync" | "fdatasync", _, [path]) => match self.files.get_mut(path) {
                Some(file) => file.flushed = file.flushed.max(size),
                // A flushed folder: the journal is on the disk up to here.
                None => self.changes.clear(),
            },
            ("syncfs", ..) => {
                self.changes.clear();
                self.files.values_mut().for_each(|file| file.flushed = file.bytes);
            }
            ("mkdir", [path], _) => self.changes.push(Change::Folder(path.clone())),
            ("rmdir", [path], _) => self.changes.push(Change::RemovedFolder(path.clone())),
            ("unlink", [path], _) => {
                let earlier = self.files.remove(path).and_then(|file| file.earlier);
                self.changes.push(Change::Removed(path.clone(), earlier));
            }
            ("link" | "linkat", [from, to], _) => {
                let file = self.files.get(from).cloned().unwrap_or_default();
                self.files.insert(to.clone(), file);
                self.changes.push(Change::File(to.clone()));
            }
            ("rename" | "renameat" | "renameat2", [from, to], _) => {
                self.rename([from, to].map(Clone::clone), rest.contains("RENAME_EXCHANGE"));
            }
            _ => {}
        }
    }

    fn create(&mut self, path: &str) {
        if !self.files.contains_key(path) {
            self.files.insert(path.into(), Written::default());
            self.changes.push(Change::File(path.into()));
        }
    }

    fn rename(&mut self, [from, to]: [String; 2], is_exchange: bool) {
        let moved = self.take(&from);
        if is_exchange {
            let back = self.take(&to);
            self.files.extend(back.into_iter().map(|(rest, file)| (format!("{from}{rest}"), file)));
        }
        self.files.extend(moved.into_iter().map(|(rest, file)| (format!("{to}{rest}"), file)));
        self.changes.push(if is_exchange { Change::Swapped([from, to]) } else { Change::Moved([from, to]) });
    }

    /// Removes a file, or the files below a folder, and returns them with the rest of their names.
    fn take(&mut self, path: &str) -> Vec<(String, Written)> {
        let is_below =
            |name: &&String| name.strip_prefix(path).is_some_and(|rest| rest.is_empty() || rest.starts_with('/'));
        let names: Vec<String> = self.files.keys().filter(is_below).cloned().collect();
        names.into_iter().filter_map(|name| Some((name[path.len()..].to_owned(), self.files.remove(&name)?))).collect()
    }

    /// Loses a random part of what was not flushed. Returns what was lost.
    fn lose(&mut self, random: &mut Random) -> io::Result<Vec<String>> {
        let mut lost = Vec::new();
        for (name, file) in &self.files {
            let path = self.folder.join(name);
            let size = fs::metadata(&path).map_or(0, |data| data.len());
            if file.flushed < size && lose_contents(&path, [file.flushed, size], random)? {
                lost.push(format!("contents of {name} from {} to {size}", file.flushed));
            }
        }
        let last = if random.chance(0.7) { random.below(self.changes.len() + 1) } else { 0 };
        for _ in 0..last {
            let Some(change) = self.changes.pop().filter(|change| self.can_undo(change)) else { break };
            lost.push(format!("{change:?}"));
            self.undo(change)?;
        }
        Ok(lost)
    }

    /// False for a move that replaced a file of the same run, whose contents are not known any more.
    fn can_undo(&self, change: &Change) -> bool {
        match change {
            Change::Moved([_, to]) => !to.starts_with("work/") || !self.changes.iter().any(|before| before.makes(to)),
            _ => true,
        }
    }

    fn undo(&self, change: Change) -> io::Result<()> {
        let path = |name: &str| self.folder.join(name);
        let missing = |error: io::Error| if error.kind() == io::ErrorKind::NotFound { Ok(()) } else { Err(error) };
        match change {
            Change::File(name) => fs::remove_file(path(&name)).or_else(missing),
            Change::Folder(name) => fs::remove_dir_all(path(&name)).or_else(missing),
            Change::RemovedFolder(name) => fs::create_dir_all(path(&name)),
            Change::Removed(name, earlier) => {
                let bytes = earlier.and_then(|name| self.earlier.get(&name));
                fs::write(path(&name), bytes.map_or(&[][..], Vec::as_slice))
            }
            Change::Swapped([from, to]) => {
                let aside = path("aside");
                fs::rename(path(&from), &aside)?;
                fs::rename(path(&to), path(&from))?;
                fs::rename(aside, path(&to))
            }
            Change::Moved([from, to]) => {
                fs::rename(path(&to), path(&from))?;
                match to.strip_prefix("out/").and_then(|name| self.earlier.get(name)) {
                    Some(bytes) => fs::write(path(&to), bytes),
                    None => Ok(()),
                }
            }
        }
    }
}

impl Change {
    fn makes(&self, name: &str) -> bool {
        match self {
            Self::File(made) | Self::Moved([_, made]) => made == name,
            _ => false,
        }
    }
}

/// Cuts off or clears contents that were not flushed, or neither. True if some are lost.
fn lose_contents(path: &Path, [flushed, size]: [u64; 2], random: &mut Random) -> io::Result<bool> {
    let left = flushed + (random.unit() * (size - flushed) as f64) as u64;
    if random.chance(0.3) {
        return Ok(false);
    }
    let mut file = OpenOptions::new().write(true).open(path)?;
    if random.chance(0.6) {
        file.set_len(left)?;
        return Ok(true);
    }
    let first = (left / PAGE * PAGE).max(flushed);
    file.seek(SeekFrom::Start(first))?;
    file.write_all(&vec![0; (size - first).min(PAGE) as usize])?;
    Ok(true)
}

/// Strings of a call.
fn quoted(text: &str) -> Vec<&str> {
    text.split('"').skip(1).step_by(2).collect()
}

/// Paths of the descriptors of a call, but for the working folder.
fn descriptors(text: &str) -> Vec<&str> {
    let arguments = text.rsplit_once(" = ").map_or(text, |(call, _)| call);
    let parts = arguments.split('<').zip(arguments.split('<').skip(1));
    parts
        .filter(|(before, _)| !before.ends_with("AT_FDCWD"))
        .filter_map(|(_, part)| Some(part.split_once('>')?.0))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const LOG: &str = "\
7 openat(AT_FDCWD</x>, \"out/.a.1.part\", O_WRONLY|O_CREAT|O_EXCL, 0666) = 3</x/out/.a.1.part>
7 write(3</x/out/.a.1.part>, \"\"..., 10) = 10
8  fdatasync(3</x/out/.a.1.part> <unfinished ...>
7 write(3</x/out/.a.1.part>, \"\"..., 5) = 5
8  <... fdatasync resumed>) = 0
7 mkdir(\"out/.b.old\", 0777) = 0
7 renameat2(AT_FDCWD</x>, \"out/.b.part\", AT_FDCWD</x>, \"out/b\", RENAME_EXCHANGE) = 0
7 rename(\"out/.a.1.part\", \"/x/out/a\") = 0
7 unlink(\"out/.b.part/c\") = 0
7 unlink(\"out/d\") = -1 ENOENT (No such file or directory)
";

    #[test]
    fn logs_tell_what_is_not_flushed() {
        let earlier = Files::from([("a".into(), b"old".to_vec()), ("b/c".into(), b"old".to_vec())]);
        let mut disk = Disk::new(Path::new("/x"), &earlier);
        disk.replay(LOG);
        let file = &disk.files["out/a"];
        assert_eq!((file.bytes, file.flushed, &file.earlier), (15, 10, &None));
        let names = |[a, b]: [&str; 2]| [a.to_owned(), b.to_owned()];
        let expected = [
            Change::File("out/.a.1.part".into()),
            Change::Folder("out/.b.old".into()),
            Change::Swapped(names(["out/.b.part", "out/b"])),
            Change::Moved(names(["out/.a.1.part", "out/a"])),
            Change::Removed("out/.b.part/c".into(), Some("b/c".into())),
        ];
        assert_eq!(disk.changes, expected);
        disk.replay("7 fsync(4</x/out>) = 0\n");
        assert!(disk.changes.is_empty());
    }

    #[test]
    fn changes_of_names_are_undone() {
        let folder = std::env::temp_dir().join(format!("anastomesh-power-{}", std::process::id()));
        fs::create_dir_all(folder.join("out/b")).expect("a folder");
        fs::create_dir_all(folder.join("out/.b.part")).expect("a folder");
        for (name, text) in [("out/a", "new"), ("out/b/c", "new")] {
            fs::write(folder.join(name), text).expect("a file");
        }
        let earlier = Files::from([("a".into(), b"old".to_vec()), ("b/c".into(), b"old".to_vec())]);
        let mut disk = Disk::new(&folder, &earlier);
        disk.replay(&LOG.replace("/x", &folder.to_string_lossy()));
        while let Some(change) = disk.changes.pop() {
            disk.undo(change).expect("an undone change");
        }
        let found = Job::output(&folder).expect("files");
        assert_eq!(
            found,
            Files::from([
                ("a".into(), b"old".to_vec()),
                (".b.part/c".into(), b"new".to_vec()),
                ("b/c".into(), b"old".to_vec())
            ])
        );
        fs::remove_dir_all(folder).expect("removed");
    }
}
