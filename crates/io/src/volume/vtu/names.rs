//! Names shared by writer and reader.

/// VTK cell types.
pub(super) const VTK_TRIANGLE: u8 = 5;
pub(super) const VTK_QUAD: u8 = 9;
pub(super) const VTK_TETRA: u8 = 10;
pub(super) const VTK_PRISM: u8 = 13;
pub(super) const VTK_PYRAMID: u8 = 14;
pub(super) const VTK_QUADRATIC_EDGE: u8 = 21;
pub(super) const VTK_QUADRATIC_TRIANGLE: u8 = 22;
pub(super) const VTK_QUADRATIC_TETRA: u8 = 24;

/// Names of the field arrays.
pub(super) mod field {
    pub const PATCH_NAMES: &str = "patch_names";
    pub const CAP_PATCH: &str = "cap_patch";
    pub const CAP_NODE: &str = "cap_node";
    pub const CAP_CENTER: &str = "cap_center";
    pub const CAP_NORMAL: &str = "cap_normal";
    pub const CAP_RADIUS: &str = "cap_radius";
    pub const LOOPS: &str = "expected_loops";
    pub const TERMINALS: &str = "expected_terminals";
    pub const REGION_IDS: &str = "region_ids";
    pub const REGION_NAMES: &str = "region_names";
    pub const GENERATOR: &str = "generator";
    pub const OPTIONS: &str = "options";
}

/// Names of the arrays by which `svMultiPhysics` and other solvers number points and cells, from 1.
pub(in crate::volume) const NODE_ID: &str = "GlobalNodeID";
pub(in crate::volume) const ELEMENT_ID: &str = "GlobalElementID";

/// Name of the cell array with the region of each cell.
pub(in crate::volume) const REGION: &str = "region";
/// Layer of a cell, from 1 at the wall.
pub(in crate::volume) const LAYER: &str = "layer";

/// Name of the point array with the number of each point in the whole mesh.
pub(in crate::volume) const GLOBAL_IDS: &str = "GlobalPointIds";

/// Name of the cell array with the number of each cell in the whole mesh, tetrahedra before boundary faces.
pub(in crate::volume) const CELL_IDS: &str = "GlobalCellIds";

/// Name of VTK's array that marks copies of the cells and points of other pieces.
pub(in crate::volume) const GHOSTS: &str = "vtkGhostType";
