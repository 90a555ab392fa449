//! Mesh as read from a file, before any check.

/// Tetrahedra with labelled triangles, as in the file. Vertices may be out of range.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Positions, in the unit of the file.
    pub points: Vec<[f64; 3]>,
    /// Vertices of each tetrahedron.
    pub tets: Vec<[u32; 4]>,
    /// Vertices of each labelled triangle.
    pub triangles: Vec<[u32; 3]>,
    /// True if labelled triangles may have either direction, as in TetGen's files.
    pub is_undirected: bool,
    /// Patch of each labelled triangle.
    pub labels: Vec<i64>,
    /// Region of each tetrahedron; empty in a mesh without regions.
    pub tet_regions: Vec<i64>,
    /// Ids and names of regions; empty in a mesh without regions.
    pub regions: Vec<(i64, String)>,
    /// Ids and names of patches.
    pub patches: Vec<(i64, String)>,
    /// Caps of terminals, where the file describes them.
    pub caps: Vec<Cap>,
    /// Number of independent loops of each component of the network, where the file stores it.
    pub expected_loops: Option<Vec<i64>>,
    /// Nodes of the network that have a cap, where the file stores them.
    pub expected_terminals: Option<Vec<i64>>,
}

impl Mesh {
    /// Region of a tetrahedron; 0 if unknown.
    pub(crate) fn region_of(&self, tet: usize) -> i64 {
        self.tet_regions.get(tet).copied().unwrap_or(0)
    }

    /// Labelled triangles with their patches.
    pub(crate) fn labelled(&self) -> impl Iterator<Item = ([u32; 3], i64)> {
        self.triangles.iter().copied().zip(self.labels.iter().copied())
    }

    /// Name of a patch; empty if unknown.
    pub(crate) fn patch_name(&self, label: i64) -> &str {
        self.patches.iter().find(|(id, _)| *id == label).map_or("", |(_, name)| name)
    }
}

/// Flat disc at a terminal of the network.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cap {
    /// Id of its patch.
    pub patch: i64,
    /// Node of the network.
    pub node: i64,
    /// Position of the node.
    pub center: [f64; 3],
    /// Unit vector out of the mesh.
    pub normal: [f64; 3],
    /// Radius of the vessel.
    pub radius: f64,
}

/// Vertex index of a file; indices that no mesh can have become the largest number.
pub(crate) fn index(number: i64) -> u32 {
    u32::try_from(number).unwrap_or(u32::MAX)
}
