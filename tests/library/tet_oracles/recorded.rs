//! Recorded answers, one line per case that starts with its name. With `ANASTOMESH_RECORD_ORACLES` set, tests record
//! the programs' answers instead of comparing them.

use std::path::{Path, PathBuf};
use std::sync::Mutex;

fn path(file: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/oracle").join(file)
}

/// True in recording mode.
pub fn recording() -> bool {
    std::env::var_os("ANASTOMESH_RECORD_ORACLES").is_some()
}

/// Recorded line of a case, without its name.
pub fn line(file: &str, case: &str) -> String {
    let text = std::fs::read_to_string(path(file)).unwrap_or_else(|e| panic!("{file}: {e}"));
    let of_case = |line: &str| line.strip_prefix(case)?.strip_prefix(' ').map(str::to_owned);
    text.lines().find_map(of_case).unwrap_or_else(|| panic!("{file} has no answer for {case}"))
}

/// Replaces the recorded line of a case.
pub fn record(file: &str, case: &str, line: &str) {
    static WRITING: Mutex<()> = Mutex::new(());
    let _writing = WRITING.lock();
    let text = std::fs::read_to_string(path(file)).unwrap_or_default();
    let (head, mut rest): (Vec<&str>, Vec<&str>) = text.lines().partition(|line| line.starts_with('#'));
    rest.retain(|line| line.strip_prefix(case).is_none_or(|l| !l.starts_with(' ')));
    let line = format!("{case} {line}");
    rest.push(&line);
    rest.sort_unstable();
    let lines = head.iter().chain(&rest).map(|l| format!("{l}\n")).collect::<String>();
    std::fs::write(path(file), lines).unwrap_or_else(|e| panic!("{file}: {e}"));
}
