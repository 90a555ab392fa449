//! Tests of round trips for every type and order, and of errors.

use super::folder::Arrays;
use super::{NpyError, NpyFault, write_array};
use proptest::prelude::*;

/// A file with this header.
fn npy(version: u8, header: &str, data: &[u8]) -> Vec<u8> {
    let length = header.len() as u32;
    let length = if version == 1 { length.to_le_bytes()[..2].to_vec() } else { length.to_le_bytes().to_vec() };
    [b"\x93NUMPY", &[version, 0][..], &length, header.as_bytes(), data].concat()
}

fn dict(descr: &str, fortran: bool, shape: &str) -> String {
    let fortran = if fortran { "True" } else { "False" };
    format!("{{'descr': '{descr}', 'fortran_order': {fortran}, 'shape': {shape}, }}    \n")
}

fn floats<const N: usize>(bytes: &[u8]) -> Result<Vec<[f64; N]>, NpyError> {
    Arrays::of(&[("a.npy", bytes)]).floats("a")
}

fn fault(bytes: &[u8]) -> NpyFault {
    floats::<2>(bytes).expect_err("a fault").fault
}

#[test]
fn every_kind_of_number_is_read_in_both_orders() {
    macro_rules! holds {
        ($($name:literal $kind:ty),*) => {$(
            let values: [$kind; 6] = [1, 2, 3, 4, 5, 100].map(|i| i as $kind);
            for (order, bytes) in
                [('<', values.map(<$kind>::to_le_bytes).concat()), ('>', values.map(<$kind>::to_be_bytes).concat())]
            {
                for version in 1..=3 {
                    let rows = npy(version, &dict(&format!("{order}{}", $name), false, "(3, 2)"), &bytes);
                    assert_eq!(floats(&rows), Ok(vec![[1.0, 2.0], [3.0, 4.0], [5.0, 100.0]]), "{order}{}", $name);
                    let columns = npy(version, &dict(&format!("{order}{}", $name), true, "(3, 2)"), &bytes);
                    assert_eq!(floats(&columns), Ok(vec![[1.0, 4.0], [2.0, 5.0], [3.0, 100.0]]), "{order}{}", $name);
                }
            }
        )*};
    }
    holds!("f4" f32, "f8" f64, "i1" i8, "i2" i16, "i4" i32, "i8" i64, "u1" u8, "u2" u16, "u4" u32, "u8" u64);
}

#[test]
fn headers_are_held_against_the_file() {
    let data = [0; 32];
    for shape in ["(2, 2)", "(2,2,)", "( 2 , 2 )"] {
        assert!(floats::<2>(&npy(1, &dict("<f8", false, shape), &data)).is_ok(), "{shape}");
    }
    for (shape, announced) in [("(3, 2)", 48), ("(1, 2)", 16), ("(9223372036854775807, 2)", u64::MAX)] {
        let found = fault(&npy(1, &dict("<f8", false, shape), &data));
        assert_eq!(found, NpyFault::Length { announced, found: 32 }, "{shape}");
    }
    assert_eq!(fault(b"no array"), NpyFault::NotNpy);
    assert_eq!(fault(&npy(4, "", b"")), NpyFault::Version { major: 4 });
    assert_eq!(
        fault(&npy(1, &dict("<f8", false, "(4,)"), &data)),
        NpyFault::Shape { found: vec![4], wanted: "(n, 2)".into() }
    );
    let object = fault(&npy(1, &dict("|O", false, "(2, 2)"), &data));
    assert!(matches!(object, NpyFault::Type { .. }), "{object}");
    for header in [
        "",
        "{",
        "{}",
        "{'descr': '<f8'}",
        "{'descr': [('x', '<f8')], 'fortran_order': False, 'shape': (2, 2)}",
        "{'descr': '<f8', 'fortran_order': 0, 'shape': (2, 2)}",
        "{'descr': '<f8', 'fortran_order': False, 'shape': (2, -2)}",
        "{'descr': '<f8', 'fortran_order': False, 'shape': (2, 2)} x",
        "{'descr': '<f8', 'fortran_order': False, 'shape': (2, 99999999999999999999)}",
        "{'descr': '<f8', 'fortran_order': False, 'shape': (2, 2), 'more': 1}",
    ] {
        assert!(matches!(fault(&npy(1, header, &data)), NpyFault::Header { .. }), "{header}");
    }
    let whole = npy(2, &dict("<f8", false, "(2, 2)"), &data);
    for end in 0..whole.len() {
        assert!(floats::<2>(&whole[..end]).is_err(), "{end}");
    }
}

#[test]
fn rows_that_are_wrong_are_named() {
    let mut bytes = Vec::new();
    write_array(&mut bytes, &[[0_i32, 1], [2, 5], [-1, 0]]).unwrap();
    let arrays = Arrays::of(&[("a.npy", &bytes)]);
    let named = |count| arrays.indices::<2>("a", ("points.npy", count)).expect_err("a fault").to_string();
    assert_eq!(named(5), "a.npy: row 1 refers to 5, but points.npy has 5 rows, numbered from 0");
    assert_eq!(named(6), "a.npy: row 2 refers to -1, but points.npy has 6 rows, numbered from 0");
    bytes.clear();
    write_array(&mut bytes, &[[0.0, 1.0, 2.0], [0.0, f64::NAN, 1.0]]).unwrap();
    let arrays = Arrays::of(&[("p.npy", &bytes)]);
    assert_eq!(arrays.points("p").unwrap_err().fault, NpyFault::NotFinite { row: 1 });
    assert_eq!(arrays.points("q").unwrap_err().to_string(), "q.npy: is missing: write it with numpy.save");
    bytes.clear();
    write_array(&mut bytes, &[[1_u32], [u32::MAX]]).unwrap();
    let arrays = Arrays::of(&[("m.npy", &bytes)]);
    let label = arrays.labels("m", ("a.npy", 2)).unwrap_err();
    assert_eq!(label.fault, NpyFault::NoLabel { row: 1, value: u32::MAX.to_string() });
    assert_eq!(
        arrays.labels("m", ("a.npy", 3)).unwrap_err().fault,
        NpyFault::Rows { found: 2, of: "a.npy", wanted: 3 }
    );
}

proptest! {
    #[test]
    fn what_is_written_is_read(rows in prop::collection::vec([any::<f64>(), any::<f64>(), any::<f64>()], 0..50)) {
        let mut bytes = Vec::new();
        write_array(&mut bytes, &rows).unwrap();
        prop_assert_eq!((bytes.len() - 24 * rows.len()) % 64, 0, "items begin at a multiple of 64");
        let bits = |rows: &[[f64; 3]]| rows.as_flattened().iter().map(|x| x.to_bits()).collect::<Vec<_>>();
        prop_assert_eq!(bits(&floats::<3>(&bytes).unwrap()), bits(&rows));
    }
}
