//! Whatever the bytes: a network or an error; what is read is sound, or said not to be.
#![no_main]

use anastomesh::io::network::{NetworkFormat, NetworkOptions, parse_network};
use anastomesh::skeleton::clean;
use libfuzzer_sys::fuzz_target;
use std::path::Path;

fuzz_target!(|bytes: &[u8]| {
    if let Ok(file) = parse_network(bytes, NetworkFormat::Vtp, &NetworkOptions::default(), Path::new("fuzzed")) {
        let _ = clean(&file.skeleton);
    }
});
