//! Data shared by all runs in a work directory, made by one and read by the others: the refined network, the
//! partition.

use std::fs::File;
use std::io::{self, BufReader, BufWriter, Read, Write};
use std::path::Path;

use serde::Serialize;
use serde::de::DeserializeOwned;
use xxhash_rust::xxh3::Xxh3;

use super::error::StoreError;
use super::key::Key;
use super::locks::wait_for;
use super::whole_file::part_of;
use anastomesh_mesh::progress::Progress;

/// Reads the stored value `what` of a key in `folder`, or makes and stores it.
///
/// Other runs wait while one run makes it. If that run is killed, another one makes it.
///
/// # Errors
/// That of `make`, or the folder cannot be used.
pub(super) fn once<T: Serialize + DeserializeOwned, E: From<StoreError>>(
    folder: &Path,
    (what, key): (&str, Key),
    progress: &dyn Progress,
    make: impl FnOnce() -> Result<T, E>,
) -> Result<T, E> {
    let path = folder.join(format!("anastomesh.{what}-{:032x}", key.0));
    if let Some(kept) = read(&path) {
        return Ok(kept);
    }
    let _lock = wait_for(folder, &format!("anastomesh.{what}.lock"), progress)?;
    // Another run may have made it in the meantime.
    if let Some(kept) = read(&path) {
        return Ok(kept);
    }
    let made = make()?;
    write(&path, &made).map_err(|source| StoreError::Write { place: path.display().to_string(), source })?;
    Ok(made)
}

/// Writer that adds all bytes to a checksum.
struct Summed<S> {
    inner: S,
    sum: Xxh3,
}

impl<S> Summed<S> {
    fn new(inner: S) -> Self {
        Self { inner, sum: Xxh3::new() }
    }
}

impl<W: Write> Write for Summed<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let written = self.inner.write(bytes)?;
        self.sum.update(&bytes[..written]);
        Ok(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.inner.flush()
    }
}

impl<R: Read> Read for Summed<R> {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        let read = self.inner.read(bytes)?;
        self.sum.update(&bytes[..read]);
        Ok(read)
    }
}

/// Writes the value, then the checksum of its bytes. The file gets its name when it is complete.
pub(super) fn write<T: Serialize>(path: &Path, value: &T) -> io::Result<()> {
    let mut out = Summed::new(BufWriter::with_capacity(1 << 18, part_of(path)?));
    postcard::to_io(value, &mut out).map_err(io::Error::other)?;
    let Summed { inner: mut out, sum } = out;
    out.write_all(&sum.digest().to_le_bytes())?;
    let part = out.into_inner().map_err(io::IntoInnerError::into_error)?;
    part.as_file().sync_all()?;
    part.persist(path).map(drop).map_err(|e| e.error)
}

/// Reads the stored value; `None` if it is missing or damaged, and has to be made again.
pub(super) fn read<T: DeserializeOwned>(path: &Path) -> Option<T> {
    let input = Summed::new(BufReader::with_capacity(1 << 18, File::open(path).ok()?));
    // Numbers are read through this. Texts would need room for their length: nothing that is kept has any.
    let mut scratch = [0; 64];
    let (value, (mut input, _)) = postcard::from_io((input, &mut scratch)).ok()?;
    let sum = input.sum.digest();
    let mut tail = [0; 8];
    input.inner.read_exact(&mut tail).ok()?;
    (u64::from_le_bytes(tail) == sum).then_some(value)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pipeline::store::KeyMaker;

    fn kept(folder: &Path, key: Key, makes: &mut u32) -> Vec<(u32, f64)> {
        let make = || {
            *makes += 1;
            Ok::<_, StoreError>((0..1000).map(|i| (i, f64::from(i).sqrt())).collect())
        };
        once(folder, ("thing", key), &(), make).expect("a folder")
    }

    #[test]
    fn it_is_made_once_for_each_key_and_again_when_it_is_damaged() {
        let folder = tempfile::tempdir().expect("a folder");
        let [a, b] = ["a", "b"].map(|name| KeyMaker::new(name).finish());
        let mut makes = 0;
        let first = kept(folder.path(), a, &mut makes);
        assert_eq!((kept(folder.path(), a, &mut makes), makes), (first.clone(), 1));
        assert_eq!((kept(folder.path(), b, &mut makes), makes), (first.clone(), 2));
        let path = folder.path().join(format!("anastomesh.thing-{:032x}", a.0));
        let whole = std::fs::read(&path).expect("kept");
        for at in (0..whole.len()).step_by(97) {
            let mut flipped = whole.clone();
            flipped[at] ^= 0x40;
            for bytes in [&whole[..at], &flipped] {
                std::fs::write(&path, bytes).expect("written");
                let before = makes;
                assert_eq!((kept(folder.path(), a, &mut makes), makes), (first.clone(), before + 1), "{at}");
            }
        }
        assert_eq!(std::fs::read(&path).expect("kept"), whole);
    }

    #[test]
    fn what_cannot_be_made_is_not_kept() {
        let folder = tempfile::tempdir().expect("a folder");
        let key = KeyMaker::new("a").finish();
        let fail = || Err::<u32, StoreError>(io::Error::other("planted").into());
        assert!(once(folder.path(), ("thing", key), &(), fail).is_err());
        assert_eq!(once(folder.path(), ("thing", key), &(), || Ok::<_, StoreError>(7)).expect("made"), 7);
    }
}
