//! What can be wrong with a VTK XML file.

/// Why a VTK XML file could not be understood.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum VtkError {
    /// There is no element in it.
    #[error("there is no XML element in the file; is it a VTK file (.vtp, .vtu)?")]
    Empty,
    /// The part that should be XML is not UTF-8 text.
    #[error("no XML: byte {byte} is not text; is it a VTK file (.vtp, .vtu)?")]
    NotText {
        /// Where.
        byte: usize,
    },
    /// The XML parser gave up.
    #[error("no well-formed XML at byte {byte}: {source}; correct the file, or copy it again if it was cut short")]
    Xml {
        /// Where.
        byte: u64,
        /// Why.
        source: quick_xml::Error,
    },
    /// A tag's attributes cannot be read.
    #[error("the attributes of the tag before byte {byte} cannot be read: write them as name=\"value\"")]
    BadAttribute {
        /// Where.
        byte: u64,
    },
    /// Elements are nested absurdly deep.
    #[error("elements are nested deeper than any VTK file has them: save the file again")]
    TooDeep,
    /// The file ends before it is complete.
    #[error("the file ends too early: it was not written or copied completely; write or copy it again")]
    CutShort,
    /// It is XML, but not VTK's.
    #[error("the outermost XML element is <{root}>, not <VTKFile>: give the file the extension of its format")]
    NotVtk {
        /// The outermost element.
        root: String,
    },
    /// It is a VTK file of another kind.
    #[error("a VTK file of type '{found}', but '{wanted}' is needed here: name another file, or save this one as such")]
    WrongFileType {
        /// Text that was found.
        found: String,
        /// What was expected.
        wanted: &'static str,
    },
    /// An attribute of `VTKFile` has a value that is not supported.
    #[error("{attribute}=\"{value}\" is not supported; save the file with zlib compression or none")]
    UnknownLayout {
        /// Attribute.
        attribute: &'static str,
        /// Value that was found.
        value: String,
    },
    /// A number of points, cells, … is no number.
    #[error("{attribute}=\"{value}\" is not a count: correct it")]
    BadCount {
        /// Attribute.
        attribute: &'static str,
        /// Value that was found.
        value: String,
    },
    /// `AppendedData` has an encoding other than raw and base64.
    #[error("the encoding of <AppendedData> is neither raw nor base64: save the file with one of these")]
    BadAppendedData,
    /// An array's type is unknown.
    #[error("array '{array}' has the unknown type '{kind}': save it as Float64 or Int64")]
    UnknownType {
        /// Name of the array.
        array: String,
        /// Its type.
        kind: String,
    },
    /// An array's format is unknown.
    #[error("array '{array}' has the unknown format '{format}': save it as ascii, binary or appended")]
    UnknownFormat {
        /// Name of the array.
        array: String,

        /// Format that was found.
        format: String,
    },
    /// An array's offset is missing, no number, or beyond the end of the appended data.
    #[error("the data of array '{array}' lies beyond the end of the file: write or copy it again")]
    BadOffset {
        /// Name of the array.
        array: String,
    },
    /// An array's bytes are cut short.
    #[error("the data of array '{array}' is cut short: write or copy it again")]
    ArrayCutShort {
        /// Name of the array.
        array: String,
    },
    /// A value of an ascii array is no number of the array's type.
    #[error("value {index} of array '{array}' is '{text}', not a number of its type: correct it")]
    BadNumber {
        /// Name of the array.
        array: String,
        /// Which value (from 0).
        index: usize,
        /// What is there.
        text: String,
    },
    /// Base64 text is malformed.
    #[error("the data of array '{array}' is not well-formed base64: write or copy it again")]
    BadBase64 {
        /// Name of the array.
        array: String,
    },
    /// A compressed block does not decompress to the length that is announced.
    #[error("block {block} of the compressed data of array '{array}' is damaged: write or copy it again")]
    BadZlib {
        /// Name of the array.
        array: String,
        /// Which block (from 0).
        block: usize,
    },
    /// An array does not hold a whole number of values or tuples.
    #[error("array '{array}' does not hold a whole number of values of {size} bytes: write or copy it again")]
    Ragged {
        /// Name of the array.
        array: String,
        /// Bytes per value.
        size: usize,
    },
    /// An unsigned value does not fit.
    #[error("value {index} of array '{array}' is too large: correct it")]
    TooLarge {
        /// Name of the array.
        array: String,
        /// Which value (from 0).
        index: usize,
    },
}
