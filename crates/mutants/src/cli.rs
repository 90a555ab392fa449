//! Command line.

use crate::build::{Program, Tree};
use crate::list::{self, Mutant};
use crate::parts::{Part, copy_tree};
use crate::trial::{self, Outcome, Test};
use serde_json::{Value, json};
use std::cmp::Reverse;
use std::collections::{BTreeSet, HashMap};
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

const HELP: &str = "\
Mutation tests. cargo-mutants lists the mutants; all of a run are compiled once, and each is chosen when a test runs. A
mutant is tried with the tests that reach it, those of its module first.

Usage: anastomesh-mutants [OPTIONS] --part NAME=PREFIX[,PREFIX...]...

  --part NAME=PREFIXES  Mutants of the files whose paths begin with one of the prefixes; may be repeated
  --package NAME[:lib]  Package whose tests are run, or only its unit tests; may be repeated
  --out DIR             Copy of the sources, build and results (default target/mutants)
  --limit N             Mutants of a part: every n-th if it has more (default 100000)
  --budget SECONDS      Time of the tests of a mutant without it, at most (default 30)
  --jobs N              Mutants at the same time (default 1)
  --earlier DIR         OUT of an earlier run: mutants that it caught are not tried again. Only if tests were added since

Each part has a file OUT/NAME.json, with outcomes as in outcomes.json of cargo-mutants.";

/// Outcome of mutants that cannot be chosen when a test runs.
const NOT_TRIED: &str = "";

struct Options {
    parts: Vec<Part>,
    packages: Vec<String>,
    out: PathBuf,
    limit: usize,
    budget: Duration,
    jobs: usize,
    earlier: Option<PathBuf>,
}

fn options(arguments: &[String]) -> Option<Options> {
    let mut options = Options {
        parts: Vec::new(),
        packages: Vec::new(),
        out: "target/mutants".into(),
        limit: 100_000,
        budget: Duration::from_secs(30),
        jobs: 1,
        earlier: None,
    };
    for pair in arguments.chunks(2) {
        let [name, value] = pair else { return None };
        match name.as_str() {
            "--part" => options.parts.push(Part::parse(value)?),
            "--package" => options.packages.push(value.clone()),
            "--out" => options.out = value.into(),
            "--limit" => options.limit = value.parse().ok()?,
            "--budget" => options.budget = Duration::from_secs(value.parse().ok()?),
            "--earlier" => options.earlier = Some(value.into()),
            "--jobs" => options.jobs = value.parse().ok()?,
            _ => return None,
        }
    }
    (!options.parts.is_empty() && !options.packages.is_empty()).then_some(options)
}

/// Runs the program `anastomesh-mutants`.
pub fn program() -> ExitCode {
    match run(&std::env::args().skip(1).collect::<Vec<_>>()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(2)
        }
    }
}

fn run(arguments: &[String]) -> io::Result<()> {
    let Some(options) = options(arguments) else {
        println!("{HELP}");
        return if arguments.iter().any(|argument| argument == "--help") {
            Ok(())
        } else {
            Err(io::Error::other("unknown or missing arguments: see above"))
        };
    };
    fs::create_dir_all(&options.out)?;
    let out = options.out.canonicalize()?;
    let (root, target) = (out.join("tree"), out.join("build"));
    copy_tree(Path::new("."), &root)?;
    let all = list::mutants(&root)?;
    let samples: Vec<(&Part, Vec<usize>, usize)> = options
        .parts
        .iter()
        .map(|part| {
            let (sample, of) = part.sample(&all, options.limit);
            (part, sample, of)
        })
        .collect();
    let chosen: BTreeSet<usize> = samples.iter().flat_map(|(_, sample, _)| sample).copied().collect();
    let mutants: Vec<Mutant> = chosen.iter().map(|&i| all[i].clone()).collect();
    let mut tree = Tree::new(&root, &target, &mutants)?;
    let programs = tree.programs(&options.packages)?;
    eprintln!(
        "{} mutants, of which {} do not compile; {} test programs",
        mutants.len(),
        tree.unviable.len(),
        programs.len()
    );
    let tests = record(&programs, &out, options.jobs)?;
    let caught = earlier(&options)?;
    let outcomes = try_all(&mutants, &tree, &programs, &tests, &caught, &options)?;
    for (part, sample, of) in samples {
        let of_part: Vec<Value> = (0..mutants.len())
            .zip(&chosen)
            .filter(|(id, i)| sample.contains(i) && outcomes[*id] != NOT_TRIED)
            .map(|(id, _)| json!({"summary": outcomes[id], "scenario": {"Mutant": {"name": mutants[id].name}}}))
            .collect();
        let count = |summary: &str| of_part.iter().filter(|outcome| outcome["summary"] == summary).count();
        let (caught, missed) = (count("CaughtMutant") + count("Timeout"), count("MissedMutant"));
        println!("{}: {} of {of} tried, {caught} caught, {missed} missed", part.name, of_part.len());
        fs::write(out.join(format!("{}.json", part.name)), json!({"outcomes": of_part, "of": of}).to_string())?;
    }
    Ok(())
}

/// All tests that pass without a mutant.
fn record(programs: &[Program], out: &Path, jobs: usize) -> io::Result<Vec<Test>> {
    let start = Instant::now();
    let mut names: Vec<(usize, String)> = Vec::new();
    for (number, program) in programs.iter().enumerate() {
        names.extend(trial::names(program)?.into_iter().map(|name| (number, name)));
    }
    let all = Mutex::new(Vec::new());
    in_parallel(jobs, names.len(), |i| {
        let (number, name) = &names[i];
        match trial::recorded(programs, *number, name, &out.join(format!("reached{i}")))? {
            Some(test) => all.lock().map_err(|_| panicked())?.push(test),
            None => eprintln!("{} {name} fails without a mutant, and is not run", programs[*number].package),
        }
        Ok(())
    })?;
    let all = all.into_inner().map_err(|_| panicked())?;
    eprintln!("{} tests in {:.0} s", all.len(), start.elapsed().as_secs_f64());
    Ok(all)
}

/// Calls a function with all numbers below `count`, in `jobs` threads.
fn in_parallel(jobs: usize, count: usize, call: impl Fn(usize) -> io::Result<()> + Sync) -> io::Result<()> {
    let next = AtomicUsize::new(0);
    let work = || {
        loop {
            let i = next.fetch_add(1, Ordering::Relaxed);
            if i >= count {
                return Ok(());
            }
            call(i)?;
        }
    };
    std::thread::scope(|scope| {
        let threads: Vec<_> = (0..jobs.max(1)).map(|_| scope.spawn(work)).collect();
        threads.into_iter().try_for_each(|thread| thread.join().unwrap_or_else(|_| Err(panicked())))
    })
}

fn panicked() -> io::Error {
    io::Error::other("a thread panicked")
}

/// Mutants that an earlier run caught, with their outcomes.
fn earlier(options: &Options) -> io::Result<HashMap<String, &'static str>> {
    let mut caught = HashMap::new();
    let Some(folder) = &options.earlier else { return Ok(caught) };
    for part in &options.parts {
        let json: Value = serde_json::from_slice(&fs::read(folder.join(format!("{}.json", part.name)))?)?;
        for outcome in json["outcomes"].as_array().into_iter().flatten() {
            let summary = ["CaughtMutant", "Timeout"].into_iter().find(|summary| outcome["summary"] == *summary);
            if let (Some(summary), Some(name)) = (summary, outcome["scenario"]["Mutant"]["name"].as_str()) {
                caught.insert(name.to_owned(), summary);
            }
        }
    }
    Ok(caught)
}

/// Outcome of each mutant, by the names of cargo-mutants.
fn try_all(
    mutants: &[Mutant],
    tree: &Tree<'_>,
    programs: &[Program],
    tests: &[Test],
    caught: &HashMap<String, &'static str>,
    options: &Options,
) -> io::Result<Vec<&'static str>> {
    let untried = |id: u32| if tree.unviable.contains(&id) { "Unviable" } else { NOT_TRIED };
    let outcomes = Mutex::new((0..).zip(mutants).map(|(id, _)| untried(id)).collect::<Vec<_>>());
    let start = Instant::now();
    in_parallel(options.jobs, mutants.len(), |id| {
        let (mutant, number) = (&mutants[id], id as u32);
        if !tree.built.contains(&number) {
            return Ok(());
        }
        if let Some(&summary) = caught.get(&mutant.name) {
            outcomes.lock().map_err(|_| panicked())?[id] = summary;
            return Ok(());
        }
        let reaching = in_order(mutant, number, tests);
        let summary = match trial::tried(programs, &reaching, number, options.budget)? {
            Outcome::Caught => "CaughtMutant",
            Outcome::Timeout => "Timeout",
            Outcome::Missed => "MissedMutant",
        };
        if summary != "CaughtMutant" {
            eprintln!("{:.0} s: {summary} {} ({} tests)", start.elapsed().as_secs_f64(), mutant.name, reaching.len());
        }
        outcomes.lock().map_err(|_| panicked())?[id] = summary;
        Ok(())
    })?;
    outcomes.into_inner().map_err(|_| panicked())
}

/// Tests that reach a mutant: those of its module first, then short ones.
fn in_order<'t>(mutant: &Mutant, number: u32, tests: &'t [Test]) -> Vec<&'t Test> {
    let inside = mutant.file.rsplit_once("src/").map_or("", |(_, inside)| inside);
    let modules = inside.trim_end_matches(".rs").replace('/', "::");
    let common = |test: &Test| modules.split("::").zip(test.name.split("::")).take_while(|(a, b)| a == b).count();
    let mut reaching: Vec<&Test> = tests.iter().filter(|test| test.reaches.contains(&number)).collect();
    reaching.sort_by_key(|test| (Reverse(common(test)), test.time));
    reaching
}
