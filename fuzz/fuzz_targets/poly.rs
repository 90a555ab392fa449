//! Complexes in TetGen's `.poly`.
#![no_main]

use anastomesh_fuzz::complex;
use anastomesh_io::tetgen::PlcFormat;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| complex(bytes, PlcFormat::Poly));
