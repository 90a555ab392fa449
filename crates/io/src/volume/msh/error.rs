//! What can be wrong with an MSH file.

/// Why a file is no tetrahedral mesh in Gmsh's MSH 4.1 or 2.2.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum MshFault {
    /// Something that every such file has is not there.
    #[error("'{what}' is missing: was it written or copied completely?")]
    Missing {
        /// Name of the section.
        what: &'static str,
    },
    /// The file ends before it is complete.
    #[error("the file ends too early: it was not written or copied completely; write or copy it again")]
    CutShort,
    /// Something else stands where a number or name has to be.
    #[error("no number or name of the format before byte {byte}: was it written or copied completely?")]
    BadNumber {
        /// Where.
        byte: usize,
    },
    /// Two nodes have the same tag.
    #[error("two nodes have the tag {tag}: give each its own")]
    RepeatedTag {
        /// Tag that was found.
        tag: u64,
    },
    /// A version of the format that is not read.
    #[error("version {version} of the format is not read; Gmsh writes 4.1 with -format msh41")]
    UnsupportedVersion {
        /// Version that was found.
        version: String,
    },
    /// There are elements that are neither tetrahedra nor triangles.
    #[error("cell {cell} is of type {kind}; only linear tetrahedra and triangles are supported")]
    UnsupportedCell {
        /// Type of the element, in the numbers of the format.
        kind: i64,
        /// The first such element.
        cell: usize,
    },
}
