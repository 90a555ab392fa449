//! Tests of stopped runs, with real signals to the real program.
#![cfg(target_os = "linux")]

use crate::common::fixture;
use crate::common::program::*;
use crate::common::surfaces::{save, sphere};
use std::fs;
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

/// Starts the program with captured output.
fn start(verb: &str, paths: &[&Path], options: &[&str]) -> Child {
    let mut command = program();
    command.arg(verb).args(paths).args(options).stdout(Stdio::piped()).stderr(Stdio::piped());
    command.spawn().expect("the program runs")
}

fn signal(child: &Child, name: &str) {
    let sent = Command::new("kill").args([name, &child.id().to_string()]).status().expect("kill runs");
    assert!(sent.success());
}

/// Waits for a condition while the program runs.
fn wait_for(child: &mut Child, what: &str, is_there: impl Fn() -> bool) {
    let start = Instant::now();
    while !is_there() {
        assert!(child.try_wait().expect("a child").is_none(), "it ended before {what}");
        assert!(start.elapsed() < Duration::from_secs(60), "no {what}");
        std::thread::sleep(Duration::from_millis(2));
    }
}

/// True if a process handles SIGINT and SIGTERM.
fn listens(id: u32) -> bool {
    let status = fs::read_to_string(format!("/proc/{id}/status")).unwrap_or_default();
    let caught = status.lines().find_map(|line| line.strip_prefix("SigCgt:")).unwrap_or("0");
    u64::from_str_radix(caught.trim(), 16).is_ok_and(|mask| mask & 0x4002 == 0x4002)
}

/// True if all threads of a process are stopped.
fn is_held(id: u32) -> bool {
    let threads = fs::read_dir(format!("/proc/{id}/task")).into_iter().flatten().flatten();
    let state = |file: &Path| fs::read_to_string(file).unwrap_or_default();
    threads.map(|thread| state(&thread.path().join("status"))).all(|status| status.contains("State:\tT"))
}

/// Final output of a process, and the time until its end.
fn ended(child: Child) -> (Output, Duration) {
    let start = Instant::now();
    let output = child.wait_with_output().expect("it ends");
    (output, start.elapsed())
}

/// Starts a mesh run that takes some time.
fn fine(folder: &Path, work: &Path) -> Child {
    let (network, out) = (fixture("tree_30.vtp"), folder.join("a.vtu"));
    let paths = [&*network, Path::new("-o"), &out, Path::new("--work-dir"), work];
    start("mesh", &paths, &["--rho", "9", "--memory", "20GiB", "-j", "1"])
}

#[test]
fn a_mesh_that_is_stopped_leaves_its_blocks_and_says_how_it_goes_on() {
    for name in ["-INT", "-TERM"] {
        let folder = folder();
        let work = folder.path().join("my work");
        let blocks = work.join("anastomesh.blocks");
        let mut child = fine(folder.path(), &work);
        let length = || fs::metadata(&blocks).map_or(0, |data| data.len());
        wait_for(&mut child, "a finished block", || length() > 0);
        signal(&child, name);
        let (output, took) = ended(child);
        assert_says(
            &output,
            STOPPED,
            &["stopping; press Ctrl-C again", "finished blocks are kept in", "Continue with"],
        );
        let said = stderr(&output);
        assert!(
            said.trim_end().ends_with(&format!("--work-dir '{}' --rho 9 --memory 20GiB -j 1", work.display())),
            "{said}"
        );
        assert_eq!(entries(folder.path()), ["my work"]);
        assert!(took < Duration::from_secs(20), "{took:?}");
        let kept = length();
        // The printed command continues the run without recomputing blocks.
        let last = said.lines().last().expect("a command").trim();
        let mut again = Command::new("sh");
        let again = again.args(["-c", &format!("exec {last} -q --json")]).output().expect("a shell");
        assert_code(&again, FINE);
        assert!(length() > kept);
        assert_eq!(entries(folder.path()), ["a.vtu", "a_patches.csv", "my work"]);
        if name == "-INT" {
            let whole = folder.path().join("b.vtu");
            assert_code(&mesh(&fixture("tree_30.vtp"), &whole, &["--rho", "9", "--memory", "20GiB", "-q"]), FINE);
            assert!(fs::read(whole).expect("a mesh") == fs::read(folder.path().join("a.vtu")).expect("a mesh"));
        }
    }
}

/// Starts a command, waits until it handles signals, and interrupts it.
fn stopped(verb: &str, paths: &[&Path], options: &[&str]) -> Output {
    let mut child = start(verb, paths, options);
    let id = child.id();
    wait_for(&mut child, "listening", || listens(id));
    std::thread::sleep(Duration::from_millis(300));
    signal(&child, "-INT");
    let (output, took) = ended(child);
    assert!(took < Duration::from_secs(20), "{took:?}");
    output
}

#[test]
fn without_a_work_directory_nothing_is_left() {
    let folder = folder();
    let out = folder.path().join("a.vtu");
    fs::write(&out, "an earlier mesh").expect("written");
    let paths = [&*fixture("tree_30.vtp"), Path::new("-o"), &*out];
    let fine = ["--rho", "9", "--memory", "20GiB"];
    for joint in ["disc", "woven"] {
        let output = stopped("mesh", &paths, &[&fine[..], &["--joint", joint]].concat());
        assert_says(&output, STOPPED, &["nothing is kept", "--work-dir"]);
        assert_eq!(entries(folder.path()), ["a.vtu"]);
        assert_eq!(fs::read(&out).expect("there"), b"an earlier mesh");
    }
}

#[test]
fn a_tetrahedralization_that_is_stopped_leaves_nothing() {
    let folder = folder();
    let surface = save(&folder, "s.off", &sphere(40));
    for name in ["a.vtu", "a.ele"] {
        let out = folder.path().join(name);
        let output = stopped("tetrahedralize", &[&surface, Path::new("-o"), &out], &["--size", "0.02"]);
        assert_says(&output, STOPPED, &["nothing is kept"]);
        assert_eq!(entries(folder.path()), ["s.off"]);
    }
    let quiet = stopped(
        "tetrahedralize",
        &[&surface, Path::new("-o"), &folder.path().join("a.vtu")],
        &["--size", "0.02", "-q"],
    );
    assert_eq!(stderr(&quiet), "anastomesh: stopped; nothing is kept, and no file was changed\n");
}

#[test]
fn a_refinement_that_is_stopped_leaves_nothing() {
    let folder = folder();
    let network = folder.path().join("net.vtp");
    assert_code(&run("generate", &[Path::new("-o"), &network], &["--terminals", "3000", "-q"]), FINE);
    let out = folder.path().join("out.vtp");
    let output = stopped("refine", &[&network, Path::new("-o"), &out], &["--every", "1"]);
    assert_says(&output, STOPPED, &["nothing is kept, and no file was changed"]);
    assert_eq!(entries(folder.path()), ["net.vtp"]);
}

#[test]
fn the_second_signal_ends_it_at_once() {
    let folder = folder();
    let surface = save(&folder, "s.off", &sphere(40));
    let out = folder.path().join("a.vtu");
    // The process is stopped while both signals are sent; otherwise it could end before the second. (Two equal signals
    // would merge.) Missing output shows that the second signal ended it.
    let ended_by_second = |first: &str, second: &str| {
        let mut child = start("tetrahedralize", &[&surface, Path::new("-o"), &out], &["--size", "0.02"]);
        let id = child.id();
        wait_for(&mut child, "listening", || listens(id));
        std::thread::sleep(Duration::from_millis(100));
        signal(&child, "-STOP");
        wait_for(&mut child, "standing still", || is_held(id));
        for name in [first, second, "-CONT"] {
            signal(&child, name);
        }
        let (output, took) = ended(child);
        assert_code(&output, STOPPED);
        assert!(took < Duration::from_secs(10), "{took:?}");
        assert!(!out.exists());
        !stderr(&output).contains("nothing is kept")
    };
    // Two threads may handle one signal each at the same time; then neither counts as the second.
    for (first, second) in [("-INT", "-TERM"), ("-TERM", "-INT")] {
        assert!((0..6).any(|_| ended_by_second(first, second)), "{first} {second}");
    }
}

/// Commands without cancellation do not handle signals: the signal ends them like any program.
#[test]
fn other_verbs_end_as_any_program_does() {
    use std::os::unix::process::ExitStatusExt;
    let folder = folder();
    let out = folder.path().join("net.vtp");
    let child = start("generate", &[Path::new("-o"), &out], &["--terminals", "1000000"]);
    std::thread::sleep(Duration::from_millis(300));
    // A shell may have told programs in the background to ignore SIGINT.
    signal(&child, "-TERM");
    let (output, _) = ended(child);
    assert_eq!(output.status.signal(), Some(15));
    assert!(!out.exists());
}

/// Writes a lattice of vessels that overlap, whose only block fails in every attempt.
fn overlapping_lattice(path: &Path, radius: u32) {
    const SIDE: usize = 6;
    let places: Vec<[usize; 3]> = (0..SIDE.pow(3)).map(|i| [i % SIDE, i / SIDE % SIDE, i / (SIDE * SIDE)]).collect();
    let lines: Vec<[usize; 2]> = (0..places.len())
        .flat_map(|i| [1, SIDE, SIDE * SIDE].into_iter().zip(places[i]).map(move |(step, x)| (i, step, x)))
        .filter(|&(_, _, x)| x + 1 < SIDE)
        .map(|(i, step, _)| [i, i + step])
        .collect();
    let points = places.iter().map(|[x, y, z]| format!("{} {} {}", 25 * x, 25 * y, 25 * z));
    let text = [
        vec!["# vtk DataFile Version 3.0".into(), "lattice".into(), "ASCII".into(), "DATASET POLYDATA".into()],
        vec![format!("POINTS {} double", places.len())],
        points.collect(),
        vec![format!("LINES {} {}", lines.len(), 3 * lines.len())],
        lines.iter().map(|[a, b]| format!("2 {a} {b}")).collect(),
        vec![format!("POINT_DATA {}", places.len()), "SCALARS Radius double 1".into(), "LOOKUP_TABLE default".into()],
        vec![radius.to_string(); places.len()],
    ];
    fs::write(path, text.concat().join("\n") + "\n").expect("written");
}

fn remove_all_but_lattice(folder: &Path) {
    for left in entries(folder).iter().filter(|name| *name != "lattice.vtk") {
        let path = folder.join(left);
        let _ = fs::remove_file(&path).or_else(|_| fs::remove_dir_all(&path));
    }
}

/// Stop requests at several moments of a run, in the order of a low-discrepancy sequence.
#[test]
fn a_stop_request_is_honoured_at_any_moment() {
    let folder = folder();
    let lattice = folder.path().join("lattice.vtk");
    overlapping_lattice(&lattice, 10);
    let out = folder.path().join("a.vtu");
    let tree = fixture("tree_30.vtp");
    let cases: [(&Path, &[&str]); 3] = [
        (&lattice, &["--rho", "5"]),
        (&lattice, &["--rho", "5", "--refine"]),
        (&tree, &["--rho", "9", "--memory", "20GiB"]),
    ];
    let mut stopped = 0;
    for (i, (network, options)) in cases.into_iter().cycle().take(12).enumerate() {
        let mut child = start("mesh", &[network, Path::new("-o"), &out], options);
        let id = child.id();
        let begin = Instant::now();
        let after = Duration::from_secs_f64(0.02 + 1.2 * (0.618 * (i + 1) as f64).fract());
        while child.try_wait().expect("a child").is_none() && (begin.elapsed() < after || !listens(id)) {
            std::thread::sleep(Duration::from_millis(2));
        }
        if child.try_wait().expect("a child").is_some() {
            remove_all_but_lattice(folder.path());
            continue;
        }
        signal(&child, "-TERM");
        let (output, took) = ended(child);
        // A second of patience, and another one for a busy machine.
        assert!(took < Duration::from_secs(4), "case {i}: {took:?}");
        if output.status.code() == Some(STOPPED) {
            stopped += 1;
            assert_eq!(entries(folder.path()), ["lattice.vtk"], "case {i}");
        }
        remove_all_but_lattice(folder.path());
    }
    assert!(stopped >= 6, "{stopped}");
}

/// A network whose only block fails in every attempt ends with a typed fault.
#[test]
fn blocks_that_cannot_be_meshed_end() {
    let folder = folder();
    let lattice = folder.path().join("lattice.vtk");
    overlapping_lattice(&lattice, 13);
    let out = folder.path().join("a.vtu");
    let start = Instant::now();
    let output = mesh(&lattice, &out, &[]);
    assert_ne!(output.status.code(), Some(FINE), "{}", stderr(&output));
    assert!(start.elapsed() < Duration::from_secs(100), "{:?}", start.elapsed());
}
