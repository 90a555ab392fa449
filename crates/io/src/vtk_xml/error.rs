//! Errors of VTK XML files.

use crate::xml::XmlFault;

/// Errors of a VTK XML file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum VtkError {
    /// The file has no element.
    #[error("there is no XML element in the file; is it a VTK file (.vtp, .vtu)?")]
    Empty,
    /// The file is no XML.
    #[error(transparent)]
    Xml(#[from] XmlFault),
    /// The nesting depth exceeds the limit.
    #[error("elements are nested deeper than any VTK file has them: save the file again")]
    TooDeep,
    /// The file is truncated.
    #[error("the file ends too early: it was not written or copied completely; write or copy it again")]
    CutShort,
    /// The root element is not `VTKFile`.
    #[error("the outermost XML element is <{root}>, not <VTKFile>: give the file the extension of its format")]
    NotVtk {
        /// Name of the root element.
        root: String,
    },
    /// The file type is wrong.
    #[error("a VTK file of type '{found}', but '{wanted}' is needed here: name another file, or save this one as such")]
    WrongFileType {
        /// Text that was found.
        found: String,
        /// Expected type.
        wanted: &'static str,
    },
    /// An attribute of `VTKFile` has an unsupported value.
    #[error("{attribute}=\"{value}\" is not supported; save the file with zlib compression or none")]
    UnknownLayout {
        /// Attribute.
        attribute: &'static str,
        /// Value that was found.
        value: String,
    },
    /// A count attribute is not a number.
    #[error("{attribute}=\"{value}\" is not a count: correct it")]
    BadCount {
        /// Attribute.
        attribute: &'static str,
        /// Value that was found.
        value: String,
    },
    /// `AppendedData` is neither raw nor base64.
    #[error("the encoding of <AppendedData> is neither raw nor base64: save the file with one of these")]
    BadAppendedData,
    /// The type of an array is unknown.
    #[error("array '{array}' has the unknown type '{kind}': save it as Float64 or Int64")]
    UnknownType {
        /// Array name.
        array: String,
        /// Type name.
        kind: String,
    },
    /// The format of an array is unknown.
    #[error("array '{array}' has the unknown format '{format}': save it as ascii, binary or appended")]
    UnknownFormat {
        /// Array name.
        array: String,

        /// Format that was found.
        format: String,
    },
    /// The offset of an array is missing, not a number, or beyond the appended data.
    #[error("the data of array '{array}' lies beyond the end of the file: write or copy it again")]
    BadOffset {
        /// Array name.
        array: String,
    },
    /// The bytes of an array are truncated.
    #[error("the data of array '{array}' is cut short: write or copy it again")]
    ArrayCutShort {
        /// Array name.
        array: String,
    },
    /// A value of an ascii array is not a number of its type.
    #[error("value {index} of array '{array}' is '{text}', not a number of its type: correct it")]
    BadNumber {
        /// Array name.
        array: String,
        /// Value index, from 0.
        index: usize,
        /// Text found.
        text: String,
    },
    /// Base64 text is malformed.
    #[error("the data of array '{array}' is not well-formed base64: write or copy it again")]
    BadBase64 {
        /// Array name.
        array: String,
    },
    /// The decompressed length of a block is wrong.
    #[error("block {block} of the compressed data of array '{array}' is damaged: write or copy it again")]
    BadZlib {
        /// Array name.
        array: String,
        /// Block index, from 0.
        block: usize,
    },
    /// The array size is not a multiple of the value or tuple size.
    #[error("array '{array}' does not hold a whole number of values of {size} bytes: write or copy it again")]
    Ragged {
        /// Array name.
        array: String,
        /// Bytes per value.
        size: usize,
    },
    /// An unsigned value is out of range.
    #[error("value {index} of array '{array}' is too large: correct it")]
    TooLarge {
        /// Array name.
        array: String,
        /// Value index, from 0.
        index: usize,
    },
}
