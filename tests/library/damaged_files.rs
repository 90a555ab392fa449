//! Damages files of every readable format: readers return a result or an error in time, without panics. Every number
//! and word is replaced, every byte range removed, and byte words are overwritten. Random combinations follow for
//! `ANASTOMESH_DAMAGE_SECONDS` seconds.

use crate::common::fixture;
use anastomesh::check::{check_tets, check_volume};
use anastomesh::io::NetworkOptions;
use anastomesh::network::clean;
use anastomesh::testing::*;
use anastomesh::{Point3, TetMesh, VolumeMesh};
use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Maximum length of files that are damaged everywhere; longer ones are damaged at their start and end.
const WHOLE: usize = 1500;

/// Time limit for reading a file of this length.
const PATIENCE: Duration = Duration::from_secs(10);

/// Reader of a file.
type Reader = Box<dyn Fn(&[u8])>;

/// Valid file and its reader.
struct Sample {
    name: String,
    bytes: Vec<u8>,
    read: Reader,
}

impl Sample {
    fn of(path: &Path) -> Option<Self> {
        let read: Reader = if path.ends_with("npy/mesh.json") || path.extension().is_some_and(|e| e == "npy") {
            Self::of_arrays(path)
        } else if let Ok(format) = NetworkFormat::of(path) {
            Box::new(move |bytes| {
                if let Ok(file) = read_network_from(bytes, format, &NetworkOptions::default()) {
                    let _ = clean(&file.skeleton);
                }
            })
        } else if let Ok(format) = SurfaceFormat::of(path) {
            Box::new(move |bytes| drop(read_surface_from(bytes, format)))
        } else {
            let format = MeshFormat::of(path).ok().filter(|format| !matches!(format, MeshFormat::Tetgen))?;
            Box::new(move |bytes| {
                if let Ok(file) = read_mesh_from(bytes, format) {
                    let volume = &file.volume;
                    let _ = if file.labelled { check_volume(volume, None) } else { check_tets(&volume.mesh, None) };
                }
            })
        };
        let bytes = fs::read(path).unwrap_or_default();
        Some(Self { name: path.display().to_string(), bytes, read })
    }

    /// Reads one file of an array folder, together with the others, as every possible kind of data.
    fn of_arrays(path: &Path) -> Reader {
        let name = |path: &Path| path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let beside = path.parent().and_then(|folder| fs::read_dir(folder).ok()).into_iter().flatten().flatten();
        let others = beside.map(|entry| entry.path()).filter(|other| other != path);
        let others: Vec<_> = others.map(|other| (name(&other), fs::read(other).unwrap_or_default())).collect();
        let own = name(path);
        Box::new(move |bytes| {
            let mut files: Vec<(&str, &[u8])> = others.iter().map(|(name, bytes)| (&**name, &**bytes)).collect();
            files.push((&own, bytes));
            if let Ok(file) = read_mesh_arrays(&files) {
                let _ = check_volume(&file.volume, None);
            }
            if let Ok(file) = read_network_arrays(&files, &NetworkOptions::default()) {
                let _ = clean(&file.skeleton);
            }
            drop(read_complex_arrays(&files));
        })
    }

    /// Reports the damage if reading panics or takes too long.
    fn survives(&self, bytes: &[u8], damage: &dyn Fn() -> String) -> Result<(), String> {
        let start = Instant::now();
        let outcome = catch_unwind(AssertUnwindSafe(|| (self.read)(bytes)));
        let taken = start.elapsed();
        if outcome.is_ok() && taken <= PATIENCE {
            return Ok(());
        }
        let kept = std::env::temp_dir().join("anastomesh_damaged_file");
        let _ = fs::write(&kept, bytes);
        Err(format!("{}: {} ({taken:.1?}); the last such file is {}", self.name, damage(), kept.display()))
    }

    /// Positions to damage.
    fn places(&self) -> Vec<usize> {
        let count = self.bytes.len();
        (0..count).filter(|&at| count <= WHOLE || at < WHOLE * 2 / 3 || at + WHOLE / 3 >= count).collect()
    }
}

/// Files of the repository, and binary ones created here.
fn samples(folder: &Path) -> Vec<Sample> {
    let points = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(Point3::from);
    let mesh = TetMesh { points: points.to_vec(), tets: vec![[0, 1, 2, 3]] };
    let faces = vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]];
    let labels = vec![1, 1, 2, 1];
    let volume =
        VolumeMesh { mesh, tet_block: vec![0], boundary: faces, boundary_patch: labels, ..VolumeMesh::default() };
    for (format, name) in [(MeshFormat::Vtu, "written.vtu"), (MeshFormat::Msh, "written.msh")] {
        let mut file = fs::File::create(folder.join(name)).expect("a file");
        write_mesh_to(&mut file, format, &volume, &anastomesh::io::MeshNotes::default()).expect("written");
    }
    let seeds = fixture("../fuzz/seeds");
    let mut folders: Vec<PathBuf> = fs::read_dir(seeds).into_iter().flatten().flatten().map(|e| e.path()).collect();
    folders.extend([fixture("networks"), folder.to_path_buf()]);
    let files = folders.iter().flat_map(|folder| fs::read_dir(folder).into_iter().flatten().flatten());
    let mut paths: Vec<PathBuf> = files.map(|entry| entry.path()).collect();
    paths.sort();
    let all: Vec<Sample> = paths.iter().filter_map(|path| Sample::of(path)).collect();
    // The seeds are not part of the package.
    let expected = if fixture("../fuzz/seeds").is_dir() { 40 } else { 10 };
    assert!(all.len() >= expected, "{}", all.len());
    all
}

/// Replacements of numbers and words.
const WORDS: [&str; 14] = [
    "",
    "0",
    "-1",
    "3",
    "256",
    "2147483648",
    "4294967295",
    "99999999999",
    "9223372036854775807",
    "1e308",
    "-1e-308",
    "nan",
    "x",
    "\"",
];

/// Replacements of 1, 2, 4 and 8 bytes.
const BYTES: [[u8; 8]; 4] =
    [[0; 8], [0xff; 8], [0xff, 0xff, 0xff, 0x7f, 0xff, 0xff, 0xff, 0x7f], [0, 0, 0, 0x80, 0, 0, 0, 0x80]];

/// Words of a file and the gaps between them: runs of letters, digits and signs.
fn words(bytes: &[u8]) -> Vec<(usize, usize)> {
    let of_word = |b: u8| b.is_ascii_alphanumeric() || b"+-._".contains(&b);
    let mut start = 0;
    let ends = bytes.chunk_by(|&a, &b| of_word(a) == of_word(b)).map(|run| {
        start += run.len();
        (start - run.len(), start, of_word(run[0]))
    });
    ends.filter(|run| run.2).map(|run| (run.0, run.1)).collect()
}

fn with(bytes: &[u8], from: usize, to: usize, instead: &[u8]) -> Vec<u8> {
    [&bytes[..from], instead, &bytes[to..]].concat()
}

#[test]
fn every_word_replaced_and_every_range_cut_is_survived() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut faults = Vec::new();
    for sample in samples(folder.path()) {
        let bytes = &sample.bytes;
        faults.extend(sample.survives(bytes, &|| "as it is".into()).err());
        let places = sample.places();
        for (from, to) in words(bytes).into_iter().filter(|word| places.binary_search(&word.0).is_ok()) {
            for instead in WORDS {
                let damage = || format!("{from}..{to} is '{instead}'");
                faults.extend(sample.survives(&with(bytes, from, to, instead.as_bytes()), &damage).err());
            }
        }
        for &at in &places {
            for width in [1, 2, 4, 8].into_iter().filter(|width| at + width <= bytes.len()) {
                for instead in BYTES {
                    let damage = || format!("{at}..{} is {:?}", at + width, &instead[..width]);
                    faults.extend(sample.survives(&with(bytes, at, at + width, &instead[..width]), &damage).err());
                }
            }
            for length in [1, 2, 5, 12, 40, 200, bytes.len()] {
                let end = bytes.len().min(at + length);
                let damage = || format!("{at}..{end} is cut");
                faults.extend(sample.survives(&with(bytes, at, end, b""), &damage).err());
            }
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn damage_upon_damage_is_survived() {
    let folder = tempfile::tempdir().expect("a folder");
    let seconds: f64 = std::env::var("ANASTOMESH_DAMAGE_SECONDS").ok().and_then(|s| s.parse().ok()).unwrap_or(2.0);
    let samples = samples(folder.path());
    let end = Instant::now() + Duration::from_secs_f64(seconds);
    let mut files = 0_u64;
    while Instant::now() < end || files == 0 {
        for sample in &samples {
            let bytes = damaged(&sample.bytes, &mut Random(files));
            sample.survives(&bytes, &|| format!("the file of seed {files}")).unwrap_or_else(|fault| panic!("{fault}"));
            files += 1;
        }
    }
    eprintln!("{files} files");
}

/// Pseudo-random numbers (`SplitMix64`).
struct Random(u64);

impl Random {
    /// Random number below `end`.
    fn below(&mut self, end: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) % end as u64) as usize
    }
}

/// Applies one to five faults.
fn damaged(bytes: &[u8], random: &mut Random) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    for _ in 0..=random.below(5) {
        let at = random.below(bytes.len() + 1);
        let end = bytes.len().min(at + [1, 2, 4, 8, 30, 300][random.below(6)]);
        let words = words(&bytes);
        let instead: Vec<u8> = match random.below(4) {
            0 => Vec::new(),
            1 => (at..end).map(|_| random.below(256) as u8).collect(),
            // Bytes from elsewhere in the file.
            2 => bytes[random.below(at + 1)..].iter().take(end - at).copied().collect(),
            _ if words.is_empty() => b"0".to_vec(),
            _ => {
                let (from, to) = words[random.below(words.len())];
                bytes = with(&bytes, from, to, WORDS[random.below(WORDS.len())].as_bytes());
                continue;
            }
        };
        bytes = with(&bytes, at, end, &instead);
    }
    bytes
}
