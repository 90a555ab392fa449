use super::*;
use crate::vtk_xml::{Packing, write_blocks};
use flate2::Compression;
use std::io::{Cursor, Seek, SeekFrom, Write};

/// File with ascending 32-bit numbers after some other bytes.
fn file_of(values: usize, packing: Packing) -> (tempfile::NamedTempFile, u64) {
    let mut bytes = Cursor::new(vec![0; 100]);
    bytes.seek(SeekFrom::End(0)).unwrap();
    write_blocks(&mut bytes, values, 4, packing, |out| out.push(values, |i| (i as u32).to_le_bytes())).unwrap();
    let mut file = tempfile::NamedTempFile::new().unwrap();
    file.write_all(bytes.get_ref()).unwrap();
    (file, 100)
}

#[test]
fn any_range_of_values_is_read() {
    let [none, fast] = [Compression::none(), Compression::fast()].map(Packing::Zlib);
    for (values, packing) in [
        (0, none),
        (7, fast),
        (98_304, none),
        (250_000, fast),
        (0, Packing::Raw),
        (98_304, Packing::Raw),
        (250_000, Packing::Raw),
    ] {
        let (file, offset) = file_of(values, packing);
        let zlib = matches!(packing, Packing::Zlib(_));
        // The cache holds at most one block.
        let blocks = BlockFile::open(file.path(), 500_000).unwrap();
        let array = blocks.array(offset, values as u64, 4, zlib).unwrap();
        assert_eq!(array.blocks(), values.div_ceil(98_304) as u64);
        let n = values as u64;
        for range in [0..0, 0..n, n..n, n / 3..n / 2, n / 2..n, n.saturating_sub(1)..n, 0..n.min(1)] {
            let bytes = blocks.values(&array, range.clone()).unwrap();
            let read: Vec<u64> = bytes.as_chunks().0.iter().map(|w| u64::from(u32::from_le_bytes(*w))).collect();
            assert_eq!(read, range.collect::<Vec<_>>());
        }
        assert!(blocks.values(&array, 0..n + 1).is_err());
        assert!(blocks.kept.lock().unwrap().bytes <= 500_000);
    }
}

#[test]
fn sizes_that_do_not_fit_are_errors() {
    let (file, offset) = file_of(250_000, Packing::Zlib(Compression::fast()));
    let bytes = std::fs::read(file.path()).unwrap();
    let open = |bytes: &[u8], values, width| {
        let mut file = tempfile::NamedTempFile::new().unwrap();
        file.write_all(bytes).unwrap();
        let blocks = BlockFile::open(file.path(), 1 << 20).unwrap();
        blocks.array(offset, values, width, true).and_then(|array| blocks.values(&array, 0..values))
    };
    assert!(open(&bytes, 250_000, 4).is_ok());
    for (values, width) in [(249_999, 4), (250_001, 4), (125_000, 4), (u64::MAX, 4), (125_000, 8 * 5)] {
        assert!(open(&bytes, values, width).is_err(), "{values} of {width}");
    }
    for at in (100..148).step_by(8) {
        for word in [0, 1, u64::MAX, 1 << 40] {
            let mut other = bytes.clone();
            other[at..at + 8].copy_from_slice(&u64::to_le_bytes(word));
            assert!(open(&other, 250_000, 4).is_err(), "{word} at {at}");
        }
    }
    for length in [100, 108, 130, 1000, bytes.len() - 1] {
        assert!(open(&bytes[..length], 250_000, 4).is_err(), "{length} bytes");
    }
}

#[test]
fn an_array_as_it_is_has_the_size_that_it_says() {
    let (file, offset) = file_of(1000, Packing::Raw);
    let open = |values, width| {
        let blocks = BlockFile::open(file.path(), 1 << 20).unwrap();
        blocks.array(offset, values, width, false).and_then(|array| blocks.values(&array, 0..values))
    };
    assert!(open(1000, 4).is_ok() && open(500, 8).is_ok());
    assert!(open(999, 4).is_err() && open(1001, 4).is_err() && open(u64::MAX, 4).is_err());
    file.as_file().set_len(100 + 8 + 3999).unwrap();
    assert!(open(1000, 4).is_err());
}
