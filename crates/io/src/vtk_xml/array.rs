//! Decoded arrays, widened to 64 bits.

/// Values of an array.
#[derive(Clone, Debug, PartialEq)]
pub enum Values {
    /// Values of a floating-point array.
    Float(Vec<f64>),
    /// Values of an integer array; string arrays contain bytes, with 0 after each string.
    Int(Vec<i64>),
}

#[derive(Clone, Debug, PartialEq)]
pub struct DataArray {
    /// Values per point or cell.
    pub components: usize,
    /// `components` values per point or cell.
    pub values: Values,
}

impl DataArray {
    /// Number of values.
    pub fn len(&self) -> usize {
        match &self.values {
            Values::Float(v) => v.len(),
            Values::Int(v) => v.len(),
        }
    }

    /// Converts the values to floating-point numbers.
    pub fn into_floats(self) -> Vec<f64> {
        match self.values {
            Values::Float(v) => v,
            Values::Int(v) => v.into_iter().map(|x| x as f64).collect(),
        }
    }

    /// Returns the integer values; `None` for a floating-point array.
    pub fn into_ints(self) -> Option<Vec<i64>> {
        match self.values {
            Values::Float(_) => None,
            Values::Int(v) => Some(v),
        }
    }

    /// Returns the strings of a string array; `None` for a floating-point array.
    pub fn into_strings(self) -> Option<Vec<String>> {
        let bytes: Vec<u8> = self.into_ints()?.into_iter().map(|x| x as u8).collect();
        let mut strings: Vec<String> =
            bytes.split(|&b| b == 0).map(|s| String::from_utf8_lossy(s).into_owned()).collect();
        if strings.last().is_some_and(String::is_empty) {
            strings.pop();
        }
        Some(strings)
    }
}
