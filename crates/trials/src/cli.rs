//! Command line: arguments to exit code.

use crate::faults::References;
use crate::judge::{Outcome, Programs};
use crate::rotate::{self, Settings};
use crate::{compact, figures, gate, kinds, page, state};
use std::io;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Duration;

const HELP: &str = "\
Run the mesher on difficult input and under faults

Usage: anastomesh-trials COMMAND [OPTIONS]

Commands:
  run               Try all kinds in rotation, and append the results to the state file
  repeat            Run all findings of the state file again
  case KIND SEED    Run one case, and print its outcome
  write KIND SEED   Write the input of a case to the scratch folder, and print the command
  kinds             List all kinds
  page              Compact the state file, and write the page of results
  gate              Compare the newest build with earlier ones
  add mutants PART OUTCOMES    Record figures of anastomesh-mutants
  add coverage FILE            Record figures of `cargo llvm-cov report --json --summary-only`
  add fuzz TARGET LOG          Record figures of libFuzzer: a log with `-print_final_stats=1`
  add predicates FILE          Record figures of the example `predicates`

Options:
  --minutes M       Time of `run` [default: 10]
  --only PREFIX     Only kinds whose names begin with this; repeatable
  --jobs N          Cases at the same time [default: 1]
  --batch N         Maximum cases of a kind before the next kind [default: 25]
  --batch-seconds S Time of a kind before the next kind [default: 20]
  --shrink-seconds S Maximum time to shrink a finding [default: 60]
  --mesher FILE     Program under trial [default: anastomesh beside this program]
  --verifier FILE   Second checker [default: anastomesh-verify beside this program]
  --state FILE      State file [default: docs/trust.jsonl]
  --findings DIR    Folder for findings [default: target/trials/findings]
  --scratch DIR     Folder for running cases [default: target/trials/scratch]
  --page FILE       Page of results [default: docs/trust.md]

Exit codes: 0 no findings, 1 at least one, 2 bad arguments, 3 a file cannot be used
";

struct Args {
    words: Vec<String>,
    settings: Settings,
    page: PathBuf,
}

/// Runs the program `anastomesh-trials`.
pub fn program() -> ExitCode {
    let words: Vec<String> = std::env::args().skip(1).collect();
    if words.iter().any(|word| ["-h", "--help"].contains(&word.as_str())) {
        print!("{HELP}");
        return ExitCode::SUCCESS;
    }
    let args = match parse(words) {
        Ok(args) => args,
        Err(problem) => {
            eprintln!("error: {problem}; --help lists commands and options");
            return ExitCode::from(2);
        }
    };
    match command(&args) {
        Ok(Some(code)) => ExitCode::from(code),
        Ok(None) => {
            eprintln!("error: unknown command or kind '{}'; --help lists commands", args.words.join(" "));
            ExitCode::from(2)
        }
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(3)
        }
    }
}

fn defaults() -> Args {
    let beside = |name: &str| {
        let own = std::env::current_exe().unwrap_or_default();
        own.with_file_name(format!("{name}{}", std::env::consts::EXE_SUFFIX))
    };
    let settings = Settings {
        programs: Programs { mesher: beside("anastomesh"), verifier: beside("anastomesh-verify") },
        state: "docs/trust.jsonl".into(),
        findings: "target/trials/findings".into(),
        scratch: "target/trials/scratch".into(),
        duration: Duration::from_secs(600),
        only: Vec::new(),
        batch: 25,
        batch_time: Duration::from_secs(20),
        shrink_time: Duration::from_secs(60),
        jobs: 1,
    };
    Args { words: Vec::new(), settings, page: "docs/trust.md".into() }
}

fn parse(words: Vec<String>) -> Result<Args, String> {
    let (mut args, mut words) = (defaults(), words.into_iter());
    while let Some(word) = words.next() {
        if !word.starts_with("--") {
            args.words.push(word);
            continue;
        }
        let value = words.next().ok_or_else(|| format!("{word} needs a value"))?;
        let number = || value.parse::<f64>().ok().filter(|x| *x >= 0.0 && *x < 1e9);
        let number = || number().ok_or_else(|| format!("{word}: not a number: {value}"));
        let settings = &mut args.settings;
        match word.as_str() {
            "--minutes" => settings.duration = Duration::from_secs_f64(60.0 * number()?),
            "--batch-seconds" => settings.batch_time = Duration::from_secs_f64(number()?),
            "--shrink-seconds" => settings.shrink_time = Duration::from_secs_f64(number()?),
            "--jobs" => settings.jobs = number()?.max(1.0) as usize,
            "--batch" => settings.batch = number()?.max(1.0) as u64,
            "--only" => settings.only.push(value),
            "--mesher" => settings.programs.mesher = value.into(),
            "--verifier" => settings.programs.verifier = value.into(),
            "--state" => settings.state = value.into(),
            "--findings" => settings.findings = value.into(),
            "--scratch" => settings.scratch = value.into(),
            "--page" => args.page = value.into(),
            _ => return Err(format!("unknown option {word}")),
        }
    }
    Ok(args)
}

/// Runs a command; `None` if it is unknown.
fn command(args: &Args) -> io::Result<Option<u8>> {
    let mut settings = args.settings.clone();
    let words: Vec<&str> = args.words.iter().map(String::as_str).collect();
    if matches!(words[..], ["run" | "repeat" | "case", ..]) {
        std::fs::create_dir_all(&settings.scratch)?;
        for path in [&mut settings.programs.mesher, &mut settings.programs.verifier, &mut settings.scratch] {
            *path = std::path::absolute(&*path)?;
        }
    }
    let _lock = matches!(words[..], ["run" | "repeat" | "case", ..]).then(|| lock(&settings.scratch)).transpose()?;
    match words[..] {
        ["run"] => rotate::run(&settings).map(|totals| Some(verdict(totals))),
        ["repeat"] => rotate::repeat(&settings).map(|totals| Some(verdict(totals))),
        ["kinds"] => {
            for task in rotate::tasks(&settings.only) {
                println!("{}", task.id());
            }
            Ok(Some(0))
        }
        ["page"] => write_page(&settings, &args.page).map(|()| Some(0)),
        ["add", ref figures @ ..] => figures::add(figures, &settings.state),
        ["gate"] => {
            let worse = gate::compare(&state::read(&settings.state)?);
            for line in &worse {
                println!("{line}");
            }
            println!("kinds that are worse than with earlier builds: {}", worse.len());
            Ok(Some(u8::from(!worse.is_empty())))
        }
        ["case", kind, seed] => one_case(kind, seed, &settings),
        ["write", kind, seed] => write_case(kind, seed, &settings.scratch),
        _ => Ok(None),
    }
}

/// Locks the scratch folder: two runs in it would delete each other's files.
fn lock(scratch: &Path) -> io::Result<std::fs::File> {
    let file = std::fs::File::create(scratch.join("lock"))?;
    let busy =
        |e: std::fs::TryLockError| io::Error::other(format!("{}: {e}; give another --scratch", scratch.display()));
    file.try_lock().map_err(busy)?;
    Ok(file)
}

/// Writes the page. The state file is compacted first, unless a run appends to it.
fn write_page(settings: &Settings, page: &Path) -> io::Result<()> {
    std::fs::create_dir_all(&settings.scratch)?;
    match lock(&settings.scratch) {
        Ok(_lock) => compact::rewrite(&settings.state)?,
        Err(error) => eprintln!("warning: the state file is not compacted: {error}"),
    }
    page::write(&settings.state, page)
}

fn verdict((cases, findings): (u64, u64)) -> u8 {
    println!("{cases} cases, {findings} findings");
    u8::from(findings > 0)
}

fn one_case(kind: &str, seed: &str, settings: &Settings) -> io::Result<Option<u8>> {
    let tasks = rotate::tasks(&[]);
    let (Some(task), Ok(seed)) = (tasks.iter().find(|task| task.id() == kind), seed.parse()) else { return Ok(None) };
    let folder = settings.scratch.join("case");
    let judged = task.judge(seed, &settings.programs, &References::default(), &folder)?;
    print!("{}", judged.stderr);
    println!("{:?}\n{:.2} s; files in {}", judged.outcome, judged.seconds, folder.display());
    Ok(Some(u8::from(matches!(judged.outcome, Outcome::Finding { .. }))))
}

fn write_case(kind: &str, seed: &str, folder: &Path) -> io::Result<Option<u8>> {
    let kinds = kinds::all();
    let (Some(kind), Ok(seed)) = (kinds.iter().find(|k| k.id() == kind), seed.parse()) else { return Ok(None) };
    let case = kind.case(seed);
    std::fs::create_dir_all(folder)?;
    std::fs::write(folder.join(case.file()), case.text())?;
    println!("cd {} && anastomesh {}", folder.display(), rotate::words(&case.arguments()));
    Ok(Some(0))
}
