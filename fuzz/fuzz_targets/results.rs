//! Results of flow solvers: a VTU file of `svMultiPhysics`, or one damaged file of an OpenFOAM case. The first byte selects
//! the file that the others replace.
#![no_main]

use anastomesh_io::results::{FlowResult, read_result};
use libfuzzer_sys::fuzz_target;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

macro_rules! seeds {
    ($($seed:literal => $path:literal),*) => { [$(($path, include_bytes!(concat!("../seeds/results/", $seed)).as_slice())),*] };
}

/// Files with their seeds, whose first byte is the number of the file.
const FILES: [(&str, &[u8]); 8] = seeds!(
    "vtu" => "result_003.vtu", "points" => "case.foam/constant/polyMesh/points", "faces" => "case.foam/constant/polyMesh/faces",
    "owner" => "case.foam/constant/polyMesh/owner", "neighbour" => "case.foam/constant/polyMesh/neighbour",
    "boundary" => "case.foam/constant/polyMesh/boundary", "velocity" => "case.foam/12/U", "pressure" => "case.foam/12/p"
);

/// Folder of this process with the sound files.
fn folder() -> &'static Path {
    static FOLDER: OnceLock<PathBuf> = OnceLock::new();
    FOLDER.get_or_init(|| {
        let folder = std::env::temp_dir().join(format!("anastomesh-fuzz-results-{}", std::process::id()));
        for (path, seed) in FILES {
            write(&folder.join(path), &seed[1..]);
        }
        folder
    })
}

fn write(path: &Path, bytes: &[u8]) {
    if let Some(parent) = path.parent() {
        fs::create_dir_all(parent).expect("a folder for temporary files");
    }
    fs::write(path, bytes).expect("a folder for temporary files");
}

/// Lists of a result agree with each other, and its numbers are finite.
fn check(result: &FlowResult) {
    let count = result.cells.len();
    assert!(result.volumes.len() == count && result.pressures.len() == count);
    let of_faces = result.inner.iter().flat_map(|face| face.cells).chain(result.outer.iter().map(|face| face.cell));
    assert!(of_faces.into_iter().all(|cell| (cell as usize) < count));
    assert!(result.pressures.iter().all(|p| p.is_finite()));
}

fuzz_target!(|bytes: &[u8]| {
    let Some((&first, rest)) = bytes.split_first() else { return };
    let (path, sound) = FILES[usize::from(first) % FILES.len()];
    let file = folder().join(path);
    write(&file, rest);
    let read = if path.ends_with(".vtu") { file.clone() } else { folder().join("case.foam") };
    if let Ok(result) = read_result(&read) {
        check(&result);
    }
    write(&file, &sound[1..]);
});
