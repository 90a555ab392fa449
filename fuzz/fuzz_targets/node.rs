//! Points in TetGen's `.node`.
#![no_main]

use anastomesh_io::tetgen::Nodes;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    if let Ok(nodes) = Nodes::parse(bytes) {
        assert_eq!(nodes.attributes.len(), nodes.points.len() * nodes.attribute_count);
        assert!(nodes.markers.is_empty() || nodes.markers.len() == nodes.points.len());
    }
});
