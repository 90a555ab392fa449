//! Runs all kinds in rotation for a given time, and records results and findings.

use crate::faults::{Fault, References};
use crate::judge::{Judged, Outcome, Programs, judge};
use crate::kinds::Kind;
use crate::random::fnv;
use crate::shrink::shrink;
use crate::state::{self, Batch, Finding};
use std::fmt::Write as _;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

/// Settings of a run.
#[derive(Clone, Debug)]
pub struct Settings {
    /// Programs.
    pub programs: Programs,
    /// State file.
    pub state: PathBuf,
    /// Folder for findings.
    pub findings: PathBuf,
    /// Folder for files of running cases.
    pub scratch: PathBuf,
    /// Total time.
    pub duration: Duration,
    /// Only kinds whose family and name begin with one of these; all if empty.
    pub only: Vec<String>,
    /// Maximum cases of a kind before the next kind.
    pub batch: u64,
    /// Time of a kind before the next kind.
    pub batch_time: Duration,
    /// Maximum time to shrink a finding.
    pub shrink_time: Duration,
    /// Cases at the same time.
    pub jobs: usize,
}

/// Source of cases.
#[derive(Clone)]
pub enum Task {
    /// Kind of input.
    Kind(Kind),
    /// Kind of fault.
    Fault(Fault),
}

impl Task {
    /// Family and name.
    pub fn id(&self) -> String {
        match self {
            Self::Kind(kind) => kind.id(),
            Self::Fault(fault) => format!("faults/{}", fault.name()),
        }
    }

    /// Runs the case of a seed.
    pub fn judge(&self, seed: u64, programs: &Programs, references: &References, folder: &Path) -> io::Result<Judged> {
        match self {
            Self::Kind(kind) => judge(&kind.case(seed), programs, folder),
            Self::Fault(fault) => fault.judge(seed, programs, references, folder),
        }
    }
}

/// All tasks, or those whose id begins with one of the prefixes.
pub fn tasks(only: &[String]) -> Vec<Task> {
    let kinds = crate::kinds::all().into_iter().map(Task::Kind);
    let all = kinds.chain(Fault::ALL.into_iter().map(Task::Fault));
    all.filter(|task| only.is_empty() || only.iter().any(|prefix| task.id().starts_with(prefix))).collect()
}

/// Version of a program with the hash of its file, which identifies the build.
pub fn version(program: &Path) -> io::Result<String> {
    let said = Command::new(program).arg("--version").output()?;
    let hash = fnv(&fs::read(program)?);
    Ok(format!("{} build {:08x}", String::from_utf8_lossy(&said.stdout).trim(), hash as u32))
}

/// Runs all tasks in rotation until the time is over. Returns the number of cases and of findings.
pub fn run(settings: &Settings) -> io::Result<(u64, u64)> {
    let start = Instant::now();
    let (version, batches) = (version(&settings.programs.mesher)?, state::read(&settings.state)?);
    let tasks = tasks(&settings.only);
    if tasks.is_empty() {
        return Err(io::Error::other("no kind begins with the names of --only; `anastomesh-trials kinds` lists them"));
    }
    let seeds: Vec<Mutex<u64>> = tasks.iter().map(|t| Mutex::new(state::next_seed(&batches, &t.id()))).collect();
    let (turn, totals, references) = (AtomicUsize::new(0), Mutex::new((0, 0)), References::default());
    let worker = |number: usize| -> io::Result<()> {
        let folder = settings.scratch.join(format!("job{number}/case"));
        while start.elapsed() < settings.duration {
            let at = turn.fetch_add(1, Ordering::Relaxed) % tasks.len();
            // Another worker may still be at this kind.
            let Ok(mut seed) = seeds[at].try_lock() else { continue };
            let batch = one_batch(&tasks[at], *seed, settings, &references, &folder, start)?;
            *seed += batch.count;
            let batch = Batch { version: version.clone(), ..batch };
            let mut totals = totals.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
            totals.0 += batch.count;
            totals.1 += batch.findings.len() as u64;
            state::append(&settings.state, &batch)?;
            report(&batch, start);
        }
        Ok(())
    };
    std::thread::scope(|scope| {
        let workers: Vec<_> = (0..settings.jobs).map(|i| scope.spawn(move || worker(i))).collect();
        workers
            .into_iter()
            .try_for_each(|handle| handle.join().unwrap_or_else(|_| Err(io::Error::other("a worker panicked"))))
    })?;
    let totals = totals.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
    Ok(*totals)
}

fn report(batch: &Batch, start: Instant) {
    let typed: u64 = batch.typed.values().sum();
    println!(
        "{:6.0} s  {:60} seeds {}..{}: {} valid, {} refused, {} findings, worst {:.1} s",
        start.elapsed().as_secs_f64(),
        batch.kind,
        batch.first,
        batch.first + batch.count,
        batch.valid + batch.valid_by_one,
        typed,
        batch.findings.len(),
        batch.worst
    );
}

fn one_batch(
    task: &Task,
    first: u64,
    settings: &Settings,
    references: &References,
    folder: &Path,
    start: Instant,
) -> io::Result<Batch> {
    let begin = Instant::now();
    let mut batch = Batch { kind: task.id(), first, date: state::today(), ..Batch::default() };
    while batch.count < settings.batch && begin.elapsed() < settings.batch_time {
        if batch.count > 0 && start.elapsed() > settings.duration {
            break;
        }
        let seed = first + batch.count;
        let judged = task.judge(seed, &settings.programs, references, folder)?;
        record(&mut batch, seed, &judged);
        if let Outcome::Finding { sort, text } = &judged.outcome {
            keep(task, seed, sort, text, settings, folder)?;
        }
    }
    Ok(batch)
}

/// Adds the outcome of a case to a batch.
pub fn record(batch: &mut Batch, seed: u64, judged: &Judged) {
    batch.count += 1;
    (batch.seconds, batch.timed) = (batch.seconds + judged.seconds, batch.timed + 1);
    if judged.seconds > batch.worst {
        (batch.worst, batch.worst_seed) = (judged.seconds, seed);
    }
    match &judged.outcome {
        Outcome::Valid { by_both: true } => batch.valid += 1,
        Outcome::Valid { by_both: false } => batch.valid_by_one += 1,
        Outcome::Typed { code, message } => *batch.typed.entry(format!("{code}: {message}")).or_default() += 1,
        Outcome::Finding { sort, text } => {
            batch.findings.push(Finding { seed, sort: (*sort).into(), text: text.chars().take(1000).collect() });
        }
    }
}

/// Findings of one sort and kind with files. Further ones are in the state file.
const EXAMPLES: usize = 5;

/// Writes a finding: the files of the case, a smaller case, and the commands that reproduce them.
fn keep(task: &Task, seed: u64, sort: &str, text: &str, settings: &Settings, folder: &Path) -> io::Result<()> {
    let id = task.id();
    let name: String = id.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '-' }).collect();
    let sorts = settings.findings.join(sort.replace(' ', "-"));
    fs::create_dir_all(&sorts)?;
    let known = fs::read_dir(&sorts)?.flatten().filter(|e| e.file_name().to_string_lossy().starts_with(&name)).count();
    if known >= EXAMPLES {
        return Ok(());
    }
    let target = sorts.join(format!("{name}-{seed}"));
    fs::create_dir_all(&target)?;
    let mut readme = format!("{sort}: {text}\n\nanastomesh-trials case '{id}' {seed}\n");
    if let Task::Kind(kind) = task {
        let case = kind.case(seed);
        fs::write(target.join(case.file()), case.text())?;
        let _ = writeln!(readme, "anastomesh {}", words(&case.arguments()));
        // A hang takes the whole limit at each step.
        if sort != "hang" {
            let small = shrink(&case, sort, &settings.programs, folder, settings.shrink_time)?;
            let file = format!("small-{}", small.file());
            fs::write(target.join(&file), small.text())?;
            let arguments: Vec<String> =
                small.arguments().into_iter().map(|a| if a == small.file() { file.clone() } else { a }).collect();
            let _ = writeln!(readme, "\nShrunk to {} parts:\nanastomesh {}", small.size(), words(&arguments));
        }
    }
    fs::write(target.join("finding.txt"), readme)
}

/// Arguments as words of a shell.
pub fn words(arguments: &[String]) -> String {
    let plain = |a: &str| a.chars().all(|c| c.is_ascii_alphanumeric() || "-_./=,:+".contains(c));
    arguments.iter().map(|a| if plain(a) { a.clone() } else { format!("'{a}'") }).collect::<Vec<_>>().join(" ")
}

/// Runs all findings of the state file again, and records the outcomes under the present build.
pub fn repeat(settings: &Settings) -> io::Result<(u64, u64)> {
    let version = version(&settings.programs.mesher)?;
    let batches = state::read(&settings.state)?;
    let (references, folder) = (References::default(), settings.scratch.join("job0/case"));
    let (mut again, mut count) = (0, 0);
    for task in tasks(&settings.only) {
        let id = task.id();
        let mut seeds: Vec<u64> =
            batches.iter().filter(|b| b.kind == id).flat_map(|b| b.findings.iter().map(|f| f.seed)).collect();
        seeds.sort_unstable();
        seeds.dedup();
        for seed in seeds {
            let mut batch = Batch { kind: id.clone(), first: seed, repeats: true, ..Batch::default() };
            (batch.version, batch.date) = (version.clone(), state::today());
            record(&mut batch, seed, &task.judge(seed, &settings.programs, &references, &folder)?);
            let found = batch.findings.first().map_or("gone", |finding| &finding.sort);
            println!("{id} {seed}: {found}");
            count += 1;
            again += batch.findings.len() as u64;
            state::append(&settings.state, &batch)?;
        }
    }
    Ok((count, again))
}
