//! Networks in Pajek's format.
#![no_main]

use anastomesh_fuzz::network;
use anastomesh_io::network::NetworkFormat;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| network(bytes, NetworkFormat::Pajek));
