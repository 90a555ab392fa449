//! Numbers of files, in text or in bytes.

use anyhow::{Context as _, Result, bail};
use std::str::FromStr;

/// Type of a number, with its length in bytes.
#[derive(Clone, Copy)]
pub enum Kind {
    Signed(usize),
    Unsigned(usize),
    Real(usize),
}

/// Types that several formats share.
pub const INT: Kind = Kind::Signed(4);
pub const LONG: Kind = Kind::Signed(8);
pub const DOUBLE: Kind = Kind::Real(8);

impl Kind {
    /// Type by its name in VTK's files, or in PLY files in lower case.
    pub fn named(name: &str) -> Result<Self> {
        Ok(match name.to_ascii_lowercase().as_str() {
            "char" | "int8" => Self::Signed(1),
            "short" | "int16" => Self::Signed(2),
            "int" | "int32" => Self::Signed(4),
            "int64" => Self::Signed(8),
            "uchar" | "uint8" => Self::Unsigned(1),
            "ushort" | "uint16" => Self::Unsigned(2),
            "uint" | "uint32" => Self::Unsigned(4),
            "uint64" => Self::Unsigned(8),
            "float" | "float32" => Self::Real(4),
            "double" | "float64" => Self::Real(8),
            _ => bail!("type '{name}' is not supported"),
        })
    }

    pub fn width(self) -> usize {
        let (Self::Signed(width) | Self::Unsigned(width) | Self::Real(width)) = self;
        width
    }
}

/// Integer or floating-point number.
pub trait Number: FromStr + Copy + Default {
    /// Value of bits; `None` if it has another type.
    fn of(kind: Kind, bits: u64) -> Option<Self>;
}

impl Number for i64 {
    fn of(kind: Kind, bits: u64) -> Option<Self> {
        match kind {
            // Sign extension.
            Kind::Signed(width) => Some(((bits << (64 - 8 * width)) as i64) >> (64 - 8 * width)),
            Kind::Unsigned(_) => Some(bits.try_into().unwrap_or(i64::MAX)),
            Kind::Real(_) => None,
        }
    }
}

impl Number for f64 {
    fn of(kind: Kind, bits: u64) -> Option<Self> {
        match kind {
            Kind::Real(8) => Some(f64::from_bits(bits)),
            Kind::Real(_) => Some(f32::from_bits(bits as u32).into()),
            _ => i64::of(kind, bits).map(|whole| whole as f64),
        }
    }
}

/// Way in which numbers are stored: as words, or as bytes in one of both orders.
#[derive(Clone, Copy, PartialEq)]
pub enum Order {
    Text,
    Little,
    Big,
}

impl Order {
    /// Bits of a number of at most 8 bytes.
    pub fn bits(self, bytes: &[u8]) -> u64 {
        let fold = |bits: u64, &byte: &u8| bits << 8 | u64::from(byte);
        if self == Self::Big { bytes.iter().fold(0, fold) } else { bytes.iter().rev().fold(0, fold) }
    }
}

/// Reader of one number after the other.
pub struct Numbers<'a> {
    pub rest: &'a [u8],
    pub order: Order,
}

impl<'a> Numbers<'a> {
    /// Numbers of a text, between white space.
    pub fn text(text: &'a str) -> Self {
        Self { rest: text.as_bytes(), order: Order::Text }
    }

    pub fn next<T: Number>(&mut self, kind: Kind) -> Result<T> {
        let is_text = self.order == Order::Text;
        if is_text {
            self.rest = self.rest.trim_ascii_start();
        }
        let word = || self.rest.iter().position(u8::is_ascii_whitespace).unwrap_or(self.rest.len());
        let length = if is_text { word() } else { kind.width() };
        let bytes = self.rest.split_off(..length).context("the file ends early")?;
        let parsed = || std::str::from_utf8(bytes).ok()?.parse().ok();
        let number = if is_text { parsed() } else { T::of(kind, self.order.bits(bytes)) };
        number.context("the file ends early or has a word that is not a number")
    }

    /// The next `N` numbers.
    pub fn array<T: Number, const N: usize>(&mut self, kind: Kind) -> Result<[T; N]> {
        let mut numbers = [T::default(); N];
        for number in &mut numbers {
            *number = self.next(kind)?;
        }
        Ok(numbers)
    }

    /// The next numbers. A damaged count is an error at the end of the file, before it takes memory.
    pub fn list<T: Number>(&mut self, kind: Kind, count: i64) -> Result<Vec<T>> {
        (0..count).map(|_| self.next(kind)).collect()
    }
}
