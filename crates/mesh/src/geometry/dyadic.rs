//! Integers with a fixed number of 64-bit limbs in two's complement, for exact determinants of dyadic numbers.
//! Arithmetic wraps; the caller chooses a sufficient width.

/// Integer of `64 · N` bits, least significant limb first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Int<const N: usize>([u64; N]);

impl<const N: usize> Int<N> {
    pub(super) const ZERO: Self = Self([0; N]);

    pub(super) fn new(x: i64) -> Self {
        let mut limbs = [if x < 0 { u64::MAX } else { 0 }; N];
        limbs[0] = x.cast_unsigned();
        Self(limbs)
    }

    pub(super) fn unsigned(x: u128) -> Self {
        let mut limbs = [0; N];
        limbs[0] = x as u64;
        limbs[1] = (x >> 64) as u64;
        Self(limbs)
    }

    #[inline]
    pub(super) fn add(&self, other: &Self) -> Self {
        let mut out = [0; N];
        let mut carry = false;
        for i in 0..N {
            let (x, c1) = self.0[i].overflowing_add(other.0[i]);
            let (x, c2) = x.overflowing_add(u64::from(carry));
            out[i] = x;
            carry = c1 | c2;
        }
        Self(out)
    }

    #[inline]
    pub(super) fn sub(&self, other: &Self) -> Self {
        let mut out = [0; N];
        let mut borrow = false;
        for i in 0..N {
            let (x, b1) = self.0[i].overflowing_sub(other.0[i]);
            let (x, b2) = x.overflowing_sub(u64::from(borrow));
            out[i] = x;
            borrow = b1 | b2;
        }
        Self(out)
    }

    #[inline]
    pub(super) fn mul(&self, other: &Self) -> Self {
        let mut out = [0; N];
        for i in 0..N {
            let x = u128::from(self.0[i]);
            if x == 0 {
                continue;
            }
            let mut carry = 0u128;
            for j in 0..N - i {
                let sum = x * u128::from(other.0[j]) + u128::from(out[i + j]) + carry;
                out[i + j] = sum as u64;
                carry = sum >> 64;
            }
        }
        Self(out)
    }

    /// Multiplies by 2ᵏ.
    pub(super) fn shl(&self, k: u32) -> Self {
        let (limbs, bits) = ((k / 64) as usize, k % 64);
        let mut out = [0; N];
        for i in limbs..N {
            out[i] = self.0[i - limbs] << bits;
            if bits > 0 && i > limbs {
                out[i] |= self.0[i - limbs - 1] >> (64 - bits);
            }
        }
        Self(out)
    }

    /// −1, 0 or 1.
    pub(super) fn sign(&self) -> i32 {
        if self.0[N - 1] >> 63 == 1 { -1 } else { i32::from(self.0.iter().any(|&x| x != 0)) }
    }

    /// Number of bits of the magnitude, up to one.
    pub(super) fn bits(&self) -> u32 {
        let fill = if self.sign() < 0 { u64::MAX } else { 0 };
        let top = (0..N).rev().find(|&i| self.0[i] != fill);
        top.map_or(0, |i| 64 * i as u32 + 64 - (self.0[i] ^ fill).leading_zeros())
    }

    /// Absolute value.
    pub(super) fn abs(&self) -> Self {
        if self.sign() < 0 { Self::ZERO.sub(self) } else { *self }
    }

    /// Quotient by a larger or equal number, both non-negative, as a fraction with `bits` bits, rounded down.
    pub(super) fn fraction(&self, divisor: &Self, bits: u32) -> u128 {
        let mut rest = *self;
        let mut quotient = 0;
        for bit in 0..=bits {
            let less = rest.sub(divisor);
            quotient <<= 1;
            if less.sign() >= 0 {
                rest = less;
                quotient |= 1;
            }
            if bit < bits {
                rest = rest.shl(1);
            }
        }
        quotient
    }

    /// Converts to another width.
    #[inline]
    pub(super) fn resize<const M: usize>(&self) -> Int<M> {
        let fill = if self.0[N - 1] >> 63 == 1 { u64::MAX } else { 0 };
        let mut out = [fill; M];
        let n = N.min(M);
        out[..n].copy_from_slice(&self.0[..n]);
        Int(out)
    }
}

/// Decomposes a finite number into `m · 2ᵉ` with odd `m`; zero into `(0, i32::MAX)`.
pub(super) fn decompose(x: f64) -> (i64, i32) {
    let bits = x.to_bits();
    let exponent = ((bits >> 52) & 0x7ff) as i32;
    let fraction = (bits & ((1 << 52) - 1)).cast_signed();
    let (m, e) = if exponent == 0 { (fraction, -1074) } else { (fraction | (1 << 52), exponent - 1075) };
    if m == 0 {
        return (0, i32::MAX);
    }
    let zeros = m.trailing_zeros();
    let m = m >> zeros;
    (if x < 0.0 { -m } else { m }, e + zeros.cast_signed())
}
