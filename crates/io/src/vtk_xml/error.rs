//! Errors of VTK XML files.

use crate::xml::XmlFault;

/// Errors of a VTK XML file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum VtkError {
    /// The file has no element.
    #[error("the file has no XML element; is it a VTK file (.vtp, .vtu)?")]
    Empty,
    /// The file is no XML.
    #[error(transparent)]
    Xml(#[from] XmlFault),
    /// The nesting depth exceeds the limit.
    #[error("elements are nested too deeply: save the file again")]
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
    #[error("expected a VTK file of type '{wanted}', found '{found}': give another file, or convert this one")]
    WrongFileType {
        /// Text that was found.
        found: String,
        /// Expected type.
        wanted: &'static str,
    },
    /// An attribute of `VTKFile` has an unsupported value.
    #[error("{attribute}=\"{value}\" is not supported; save the file with {}", supported(attribute))]
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
    #[error("unsupported encoding of <AppendedData>: use raw or base64")]
    BadAppendedData,
    /// The type of an array is unknown.
    #[error("array '{array}' has the unsupported type '{kind}': use Float64 or Int64")]
    UnknownType {
        /// Array name.
        array: String,
        /// Type name.
        kind: String,
    },
    /// The format of an array is unknown.
    #[error("array '{array}' has the unsupported format '{format}': use ascii, binary or appended")]
    UnknownFormat {
        /// Array name.
        array: String,

        /// Format that was found.
        format: String,
    },
    /// The offset of an array is missing, not a number, or beyond the appended data.
    #[error("the data of array '{array}' lies beyond the end of the file: copy it again")]
    BadOffset {
        /// Array name.
        array: String,
    },
    /// The bytes of an array are truncated.
    #[error("the data of array '{array}' is truncated: copy the file again")]
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
    #[error("the data of array '{array}' is not valid base64: copy the file again")]
    BadBase64 {
        /// Array name.
        array: String,
    },
    /// The decompressed length of a block is wrong.
    #[error("compressed block {block} of array '{array}' is damaged: copy the file again")]
    BadZlib {
        /// Array name.
        array: String,
        /// Block index, from 0.
        block: usize,
    },
    /// The array size is not a multiple of the value or tuple size.
    #[error("the length of array '{array}' is not a multiple of {size} bytes: copy the file again")]
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

/// Supported values of an attribute of `VTKFile`.
fn supported(attribute: &str) -> &'static str {
    match attribute {
        "byte_order" => "LittleEndian or BigEndian",
        "header_type" => "UInt32 or UInt64",
        _ => "zlib compression or none",
    }
}
