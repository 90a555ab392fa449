//! Reference programs for comparisons, and random numbers for their inputs.

use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::Mutex;

/// Program of `tests/oracles/NAME.cpp`, built on demand. `None` with a note without CGAL or a compiler, unless
/// `ANASTOMESH_REQUIRE_ORACLES` is set.
pub fn cgal(name: &str) -> Option<PathBuf> {
    static BUILDING: Mutex<()> = Mutex::new(());
    let _building = BUILDING.lock();
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("tests/oracles/{name}.cpp"));
    let program = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let age = |path: &Path| path.metadata().and_then(|data| data.modified());
    if age(&program).is_ok_and(|built| age(&source).is_ok_and(|written| built > written)) {
        return Some(program);
    }
    let mut compile = Command::new("g++");
    // Other processes may build it at the same time, so it is renamed atomically.
    let mine = program.with_extension(std::process::id().to_string());
    compile.args(["-std=c++17", "-O1", "-w", "-o"]).arg(&mine).arg(&source).args(["-lgmp", "-lmpfr"]);
    let built = compile.stderr(Stdio::null()).status().is_ok_and(|status| status.success());
    let done = built && std::fs::rename(&mine, &program).is_ok();
    if !done {
        missing("the oracle cannot be built (g++ and libcgal-dev are needed)");
    }
    done.then_some(program)
}

/// Program `tetgen`; `None` with a note if missing, unless `ANASTOMESH_REQUIRE_ORACLES` is set.
pub fn tetgen() -> Option<PathBuf> {
    let there = Command::new("tetgen").arg("-h").stdout(Stdio::null()).stderr(Stdio::null()).status().is_ok();
    if !there {
        missing("tetgen is not there");
    }
    there.then(|| PathBuf::from("tetgen"))
}

/// Notes a missing program, which skips a comparison. Panics when `ANASTOMESH_REQUIRE_ORACLES` is set.
pub fn missing(what: &str) {
    assert!(std::env::var_os("ANASTOMESH_REQUIRE_ORACLES").is_none(), "{what}");
    eprintln!("skipped: {what}");
}

/// Output of a program for this standard input.
pub fn answer(program: &Path, input: String) -> String {
    let mut child =
        Command::new(program).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().expect("the oracle runs");
    let mut stdin = child.stdin.take().expect("a pipe");
    let feed = std::thread::spawn(move || stdin.write_all(input.as_bytes()));
    let output = child.wait_with_output().expect("the oracle ends");
    feed.join().expect("no panic").expect("the oracle reads its input");
    assert!(output.status.success(), "the oracle refuses its input: {}", output.status);
    String::from_utf8(output.stdout).expect("text")
}

/// `SplitMix64` generator.
pub struct Random(pub u64);

impl Random {
    /// Next 64 bits.
    pub fn word(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Uniform number in [0, 1).
    pub fn unit(&mut self) -> f64 {
        (self.word() >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// Program of `OpenFOAM`; `None` with a note if missing, unless `ANASTOMESH_REQUIRE_ORACLES` is set.
pub fn openfoam(program: &str) -> Option<Command> {
    let there = |command: &mut Command| command.stdout(Stdio::null()).stderr(Stdio::null()).status().is_ok();
    if !there(Command::new(program).arg("-help")) {
        missing(&format!("{program} is not there"));
        return None;
    }
    let mut command = Command::new(program);
    // Debian's version needs this to find its own files.
    let debian = Path::new("/usr/share/openfoam");
    if std::env::var_os("WM_PROJECT_DIR").is_none() && debian.is_dir() {
        command.env("WM_PROJECT_DIR", debian);
    }
    Some(command)
}
