//! Fingerprint of a machine's arithmetic.
//!
//! Functions of the C library differ in the last bit between versions, and between processors with and without fused
//! multiplication. Blocks of two such machines would have different discs at their common joint.

use super::key::{Key, KeyMaker};

/// Number of values of each function. Two libraries that differ do so at about one argument in some hundreds.
const SAMPLES: u32 = 4096;

/// A key of what the functions give that meshing uses.
pub(super) fn fingerprint() -> Key {
    let mut key = KeyMaker::new("arithmetic");
    for i in 1..=SAMPLES {
        // Arguments of the usual sizes, with all of their bits in use.
        let x = f64::from(i) * 0.001_370_359_991_773;
        let unit = (x * 0.179).min(1.0);
        for y in [x.exp(), x.ln(), x.sin(), x.cos(), x.cbrt(), x.powf(2.85), unit.acos(), unit.asin(), x.atan2(2.5 - x)]
        {
            key.float(y);
        }
    }
    key.finish()
}
