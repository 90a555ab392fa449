//! Memory and disk: how much may be used, how much is there, and where finished blocks go.

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
    scaled(number, f64::from(power).exp2())
}

fn thousands(number: &str, power: i32) -> Result<u64, String> {
    scaled(number, 1000_f64.powi(power))
}

fn scaled(number: &str, unit: f64) -> Result<u64, String> {
    let value: f64 = number.parse().map_err(|_| format!("'{number}' is no number"))?;
    if value > 0.0 && value * unit < 2_f64.powi(62) {
        Ok((value * unit) as u64)
    } else {
        Err("the size must be above 0 and can be no larger than an exbibyte".into())
    }
}

/// Where finished blocks are to be kept.
#[derive(Clone, Debug)]
pub enum BlockPlace {
    /// In memory: they are few.
    Memory,
    /// In a file without a name in this folder.
    Passing(PathBuf),
    /// In a work directory.
    Folder(PathBuf),
}

/// Bytes of memory per tetrahedron of a mesh that is gathered to be written.
const GATHERED_PER_TET: f64 = 60.0;

/// Finished blocks stay in memory when they take less than this share of what is allowed.
const KEPT_IN_MEMORY: u64 = 8;

impl BlockPlace {
    /// Opens memory for what is small, else a file beside the output.
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

/// The folder that a file is in.
pub fn folder_of(file: &Path) -> PathBuf {
    match file.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder.to_path_buf(),
        _ => PathBuf::from("."),
    }
}

/// Refuses blocks that the memory that is allowed cannot hold.
pub fn block_fits(estimate: &Estimate, plan: &MeshPlan) -> Result<(), TooLarge> {
    let (estimate, memory) = (*estimate, plan.memory);
    if estimate.largest_block_bytes > memory { Err(TooLarge::Block { estimate, memory }) } else { Ok(()) }
}

/// Refuses what the memory that is allowed, or the room on the disks, cannot hold. `kept`: bytes of blocks that an earlier run
/// left at their place.
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
        // Where the system does not tell, writing will.
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

/// Where the system does not tell, one disk for both is the safe guess.
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
