//! Limits of memory and disk space, and the place of finished blocks.

use std::path::{Path, PathBuf};

use super::exit::Failure;
use crate::pipeline::{Estimate, MeshPlan, Store, TooLarge};
use anastomesh_io::volume::MeshFormat;

/// Reads a size such as `2GiB`, `500M` or `1.5 GB`.
pub fn size(text: &str) -> Result<u64, String> {
    let text = text.trim();
    let digits = text.find(|c: char| !c.is_ascii_digit() && c != '.').unwrap_or(text.len());
    let (number, unit) = text.split_at(digits);
    let power = match unit.trim().to_ascii_lowercase().as_str() {
        "k" | "kib" => 10,
        "m" | "mib" => 20,
        "g" | "gib" => 30,
        "t" | "tib" => 40,
        "kb" => return thousands(number, 1),
        "mb" => return thousands(number, 2),
        "gb" => return thousands(number, 3),
        "tb" => return thousands(number, 4),
        _ => return Err("give a number and a unit, such as 2GiB, 500MiB or 4GB".into()),
    };
    scaled(number, libm::exp2(f64::from(power)))
}

fn thousands(number: &str, power: i32) -> Result<u64, String> {
    scaled(number, 1000_f64.powi(power))
}

fn scaled(number: &str, unit: f64) -> Result<u64, String> {
    let value: f64 = number.parse().map_err(|_| format!("'{number}' is not a number"))?;
    if value > 0.0 && value * unit < 2_f64.powi(62) {
        Ok((value * unit) as u64)
    } else {
        Err("the size must be above 0 and at most 4 EiB".into())
    }
}

/// Place of finished blocks.
#[derive(Clone, Debug)]
pub enum BlockPlace {
    /// In memory, if they are few.
    Memory,
    /// In an anonymous temporary file in this folder.
    Passing(PathBuf),
    /// In a work directory.
    Folder(PathBuf),
}

/// Memory per tetrahedron of a mesh that is collected before writing, in bytes.
const GATHERED_PER_TET: f64 = 60.0;

/// Finished blocks stay in memory if they need less than this fraction (1/N) of the limit.
const KEPT_IN_MEMORY: u64 = 8;

impl BlockPlace {
    /// Opens a store in memory for small meshes, or else a temporary file beside the output.
    pub fn beside(output: &Path, estimate: &Estimate, memory: u64) -> Result<(Self, Store), Failure> {
        if estimate.stored_bytes < memory / KEPT_IN_MEMORY {
            return Ok((Self::Memory, Store::in_memory()));
        }
        let folder = folder_of(output);
        let store = Store::in_passing(&folder)?;
        Ok((Self::Passing(folder), store))
    }

    fn folder(&self) -> Option<&Path> {
        match self {
            Self::Memory => None,
            Self::Passing(folder) | Self::Folder(folder) => Some(folder),
        }
    }
}

/// Parent folder of a file.
pub fn folder_of(file: &Path) -> PathBuf {
    match file.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder.to_path_buf(),
        _ => PathBuf::from("."),
    }
}

/// Checks that the largest block fits into the memory limit.
pub fn block_fits(estimate: &Estimate, plan: &MeshPlan) -> Result<(), TooLarge> {
    let (estimate, memory) = (*estimate, plan.memory);
    if estimate.largest_block_bytes > memory { Err(TooLarge::Block { estimate, memory }) } else { Ok(()) }
}

/// Checks that a run fits into the memory limit and the disks. `kept`: bytes of blocks of an earlier run.
pub fn fits(
    estimate: &Estimate,
    plan: &MeshPlan,
    place: &BlockPlace,
    kept: u64,
    (output, format): (&Path, MeshFormat),
) -> Result<(), TooLarge> {
    block_fits(estimate, plan)?;
    let (estimate, memory) = (*estimate, plan.memory);
    if !format.is_written_in_passes() {
        let bytes = (estimate.tets * GATHERED_PER_TET) as u64;
        if bytes > memory {
            let (why, instead) = ("TetGen's files", "another format");
            return Err(TooLarge::Whole { estimate, why, instead, bytes, memory });
        }
    }
    let target = folder_of(output);
    let mut stored = estimate.stored_bytes.saturating_sub(kept);
    let mut written = estimate.written_bytes;
    match place.folder() {
        None => stored = 0,
        Some(folder) if same_disk(folder, &target) => {
            written += stored;
            stored = 0;
        }
        Some(_) => {}
    }
    for (folder, bytes, place) in
        [(place.folder(), stored, "the disk of the work directory"), (Some(&*target), written, "the disk of the mesh")]
    {
        // If the free space is unknown, writing reports the error.
        let Some(free) = folder.and_then(|folder| fs4::available_space(folder).ok()) else { continue };
        if bytes > free {
            return Err(TooLarge::Disk { estimate, bytes, free, place });
        }
    }
    Ok(())
}

#[cfg(unix)]
fn same_disk(a: &Path, b: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    let device = |path: &Path| path.metadata().map(|m| m.dev()).ok();
    device(a) == device(b)
}

/// Assumes one disk for both, which is the safe case.
#[cfg(not(unix))]
fn same_disk(_: &Path, _: &Path) -> bool {
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_read_with_their_units() {
        assert_eq!(size("2GiB"), Ok(2 << 30));
        assert_eq!(size(" 512 m "), Ok(512 << 20));
        assert_eq!(size("1.5GB"), Ok(1_500_000_000));
        for wrong in ["", "2", "GiB", "-1G", "0M", "1e3M", "9999999T", "2 GiB more"] {
            assert!(size(wrong).is_err(), "{wrong}");
        }
    }
}
