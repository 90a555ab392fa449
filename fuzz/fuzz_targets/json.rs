//! Whatever the bytes: a network or an error; what is read is sound, or said not to be.
#![no_main]

use anastomesh::io::NetworkOptions;
use anastomesh::testing::{NetworkFormat, read_network_from};
use anastomesh::network::clean;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    if let Ok(file) = read_network_from(bytes, NetworkFormat::Json, &NetworkOptions::default()) {
        let _ = clean(&file.skeleton);
    }
});
