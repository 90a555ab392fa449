//! Snapshots of reader messages for damaged files: every number and word of small files is replaced, and files are
//! truncated. Each distinct message is recorded once per format.

use crate::common::fixture;
use anastomesh::io::NetworkOptions;
use anastomesh::network::clean;
use anastomesh::testing::*;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// Replacements of numbers and words.
const WORDS: [&str; 8] = ["", "0", "-1", "99999999999", "1e308", "nan", "x", "\""];

/// Length of the damaged head of longer files.
const HEAD: usize = 1500;

/// Message of a reader; `None` if it accepts the bytes or does not read such files.
fn said(path: &Path, bytes: &[u8]) -> Option<String> {
    if let Ok(format) = NetworkFormat::of(path) {
        return match read_network_from(bytes, format, &NetworkOptions::default()) {
            Ok(file) => clean(&file.skeleton).err().map(|e| e.to_string()),
            Err(e) => Some(e.to_string()),
        };
    }
    if let Ok(format) = SurfaceFormat::of(path) {
        return read_surface_from(bytes, format).err().map(|e| e.to_string());
    }
    let format = MeshFormat::of(path).ok().filter(|format| !matches!(format, MeshFormat::Tetgen))?;
    read_mesh_from(bytes, format).err().map(|e| e.to_string())
}

/// Words of a file: runs of letters, digits and signs.
fn words(bytes: &[u8]) -> Vec<(usize, usize)> {
    let of_word = |b: u8| b.is_ascii_alphanumeric() || b"+-._".contains(&b);
    let mut start = 0;
    let runs = bytes.chunk_by(|&a, &b| of_word(a) == of_word(b)).map(|run| {
        start += run.len();
        (start - run.len(), start, of_word(run[0]))
    });
    runs.filter(|run| run.2).map(|run| (run.0, run.1)).collect()
}

/// Message without numbers and quoted words, to identify equal messages.
fn shape(message: &str) -> String {
    let unquoted: String = message.split('\'').step_by(2).collect::<Vec<_>>().join("'");
    unquoted.chars().filter(|c| !c.is_ascii_digit() && !"-.e+".contains(*c)).collect()
}

/// Damages a file in every way, and collects the messages.
fn damage(path: &Path, bytes: &[u8], found: &mut BTreeMap<String, String>) {
    let mut read = |bytes: &[u8]| {
        if let Some(message) = said(path, bytes) {
            found.entry(shape(&message)).or_insert(message);
        }
    };
    let head = bytes.len().min(HEAD);
    for (from, to) in words(&bytes[..head]) {
        for instead in WORDS {
            read(&[&bytes[..from], instead.as_bytes(), &bytes[to..]].concat());
        }
        read(&bytes[..from]);
        read(&bytes[to..]);
    }
    for at in 0..head {
        read(&[&bytes[..at], &bytes[at + 1..]].concat());
        let mut flipped = bytes.to_vec();
        flipped[at] ^= 0xff;
        read(&flipped);
    }
}

#[test]
fn each_is_written_down() {
    let seeds = fixture("../fuzz/seeds");
    let mut folders: Vec<PathBuf> = fs::read_dir(&seeds).into_iter().flatten().flatten().map(|e| e.path()).collect();
    folders.push(fixture("networks"));
    let files = folders.iter().flat_map(|folder| fs::read_dir(folder).into_iter().flatten().flatten());
    let mut paths: Vec<PathBuf> = files.map(|entry| entry.path()).filter(|path| path.is_file()).collect();
    paths.sort();
    let mut formats: BTreeMap<String, BTreeMap<String, String>> = BTreeMap::new();
    for path in &paths {
        let bytes = fs::read(path).expect("a file");
        let extension = path.extension().unwrap_or_default().to_string_lossy().into_owned();
        damage(path, &bytes, formats.entry(extension).or_default());
    }
    formats.retain(|_, messages| !messages.is_empty());
    if !seeds.is_dir() {
        eprintln!("skipped: the seeds are no part of the package");
        return;
    }
    assert!(formats.len() > 12, "{:?}", formats.keys());
    for (extension, messages) in formats {
        let mut all: Vec<&str> = messages.values().map(String::as_str).collect();
        all.sort_unstable();
        insta::assert_snapshot!(extension, all.join("\n"));
    }
}
