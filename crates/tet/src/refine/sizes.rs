//! Edge lengths wanted at the vertices of a surface, and further bounds on them.

use anastomesh_mesh::TriMesh;
use anastomesh_mesh::geometry::Point3;

/// Maximum size at a vertex, in lengths of its shortest edge. The other vertices of tetrahedra at that edge are then
/// close enough for dihedral angles of about 15 degrees.
const SHORTEST: f64 = 3.0;

/// Minimum size at a vertex relative to the mean length of its edges, however short the shortest is.
const LEAST: f64 = 1.0 / 32.0;

/// If more than one vertex in this many has an edge much shorter than the mean, the surface consists of needles.
/// Interior points cannot repair these, so only the mean counts then.
const NEEDLES: usize = 20;

/// Upper bound on edge lengths, in addition to the surface's own.
#[derive(Clone, Copy)]
pub enum SizeLimit<'a> {
    /// Constant bound.
    Constant(f64),
    /// Bound at each vertex of the surface.
    PerVertex(&'a [f64]),
    /// Bounds at points inside.
    Inside(&'a [(Point3, f64)]),
    /// Bound as a function of position; called from one thread, for points in and near the surface's bounding box.
    Function(&'a (dyn Fn(&Point3) -> f64 + 'a)),
}

impl std::fmt::Debug for SizeLimit<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        match self {
            Self::Constant(size) => write!(f, "Constant({size})"),
            Self::PerVertex(sizes) => write!(f, "PerVertex({} values)", sizes.len()),
            Self::Inside(points) => write!(f, "Inside({} points)", points.len()),
            Self::Function(_) => write!(f, "Function"),
        }
    }
}

impl SizeLimit<'_> {
    /// Value of a constant bound.
    pub fn constant(&self) -> Option<f64> {
        match self {
            Self::Constant(size) => Some(*size),
            Self::PerVertex(_) | Self::Inside(_) | Self::Function(_) => None,
        }
    }
}

/// Edge length wanted at each vertex of a surface: the mean length of its edges, or less if one of them is much shorter.
/// Vertices without edges get 0.
pub fn vertex_sizes(surface: &TriMesh) -> Vec<f64> {
    let n = surface.points.len();
    let (mut sum, mut count, mut least) = (vec![0.0_f64; n], vec![0_u32; n], vec![f64::INFINITY; n]);
    for t in &surface.triangles {
        for i in 0..3 {
            let (a, b) = (t[i] as usize, t[(i + 1) % 3] as usize);
            let length = (surface.points[a] - surface.points[b]).norm();
            for v in [a, b] {
                sum[v] += length;
                count[v] += 1;
                least[v] = least[v].min(length);
            }
        }
    }
    let mean: Vec<f64> = sum.iter().zip(&count).map(|(s, &c)| s / f64::from(c.max(1))).collect();
    let short = (0..n).filter(|&v| SHORTEST * least[v] < 0.5 * mean[v]).count();
    if short * NEEDLES > n {
        return mean;
    }
    (0..n).map(|v| mean[v].min((SHORTEST * least[v]).max(LEAST * mean[v]))).collect()
}
