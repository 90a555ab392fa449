//! Keys: hashes of all inputs of a block.

use xxhash_rust::xxh3::Xxh3;

use anastomesh_mesh::geometry::{Point3, Section, Vec3};

/// Hash of all inputs of a record, 128 bits. Two of 2^40 different inputs have equal keys with a probability below 2^-48.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Key(pub u128);

/// Lookup key of records: 96 bits of the key, because there are millions of records. The probability that two of 2^24
/// records have equal lookup keys is below 2^-48.
pub(super) type ShortKey = [u32; 3];

impl Key {
    pub(super) fn short(self) -> ShortKey {
        [self.0 as u32, (self.0 >> 32) as u32, (self.0 >> 64) as u32]
    }
}

/// Makes a key out of values, in their order.
pub struct KeyMaker(Xxh3);

impl KeyMaker {
    /// `what` keeps keys of different kinds apart.
    pub fn new(what: &str) -> Self {
        let mut maker = Self(Xxh3::new());
        maker.text(what);
        maker
    }

    /// Bytes, with their number, so that neighbours do not flow into each other.
    pub fn text(&mut self, text: &str) {
        self.count(text.len());
        self.0.update(text.as_bytes());
    }

    /// A number of things that follow.
    pub fn count(&mut self, count: usize) {
        self.0.update(&(count as u64).to_le_bytes());
    }

    /// An integer.
    pub fn id(&mut self, id: u32) {
        self.0.update(&id.to_le_bytes());
    }

    /// A float, bit for bit.
    pub fn float(&mut self, x: f64) {
        self.0.update(&x.to_bits().to_le_bytes());
    }

    pub fn point(&mut self, p: &Point3) {
        p.iter().for_each(|&x| self.float(x));
    }

    fn vector(&mut self, v: &Vec3) {
        v.iter().for_each(|&x| self.float(x));
    }

    pub fn section(&mut self, s: &Section) {
        self.point(&s.origin);
        self.vector(&s.axis);
        self.float(s.radius);
        self.id(u32::from(s.up.is_some()));
        s.up.iter().for_each(|up| self.vector(up));
    }

    pub fn finish(&self) -> Key {
        Key(self.0.digest128())
    }
}
