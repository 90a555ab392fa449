//! Helper triangles for edges with fewer than two facets. Thin triangles beside such an edge divide its star into
//! sectors. They are cut into the complex like facets, and dropped once the edge is recovered.

use super::parts::{Part, sides, sorted};
use super::push::Push;
use crate::delaunay::hash;
use anastomesh_mesh::geometry::{Point3, Vec3};
use rustc_hash::FxHashMap;

/// Initial height of a helper relative to the length of its edge.
const HEIGHT: f64 = 0.03;

/// Helper triangles of a part.
#[derive(Default)]
pub(super) struct Helpers {
    /// Indices of the triangles, following those of the input.
    pub triangles: Vec<u32>,
    /// Sides of the triangles except the edge they help.
    pub edges: Vec<[u32; 2]>,
}

/// Adds triangles beside each edge of a part that has fewer than two facets. Larger salts make lower triangles.
pub(super) fn add_helpers(push: &mut Push, part: &Part, salt: u64) -> Helpers {
    let mut facets: FxHashMap<[u32; 2], Vec<u32>> = FxHashMap::default();
    for &t in &part.triangles {
        for side in sides(push.triangles[t as usize]) {
            facets.entry(side).or_default().push(t);
        }
    }
    let mut helpers = Helpers::default();
    for &[a, b] in &part.edges {
        // Another recovery step may have made a missing edge.
        if push.s.has_edge(a, b) {
            continue;
        }
        let at = facets.get(&sorted(a, b)).map_or(&[][..], |f| f);
        let corner = at.first().and_then(|&t| push.triangles[t as usize].into_iter().find(|v| ![a, b].contains(v)));
        for k in at.len()..2 {
            let Some(w) = place_beside(push, [a, b], corner, k as u64 + 2 * salt) else { continue };
            helpers.triangles.push(push.triangles.len() as u32);
            push.triangles.push([a, b, w]);
            helpers.edges.extend([[a, w], [b, w]]);
        }
    }
    helpers
}

/// Inserts a vertex beside the middle of an edge, away from `corner` if given.
fn place_beside(push: &mut Push, [a, b]: [u32; 2], corner: Option<u32>, salt: u64) -> Option<u32> {
    let [p, q] = [a, b].map(|v| *push.s.point(v));
    let (along, length) = ((q - p).normalize(), (q - p).norm());
    let coin = |k: u64| (hash(hash(u64::from(a) << 32 | u64::from(b)) ^ k) >> 11) as f64 / (1u64 << 53) as f64 - 0.5;
    // The helpers of an edge lie in opposite directions, chosen at random to avoid planes of the input.
    let any = Vec3::new(coin(1), coin(2), coin(3));
    let any = if salt.is_multiple_of(2) { any } else { -any };
    let aim = corner.map_or(any, |c| (p - push.s.point(c)) + any * (0.1 * length));
    let aside = (aim - along * aim.dot(&along)).try_normalize(0.0)?;
    let height = HEIGHT * 0.1_f64.powi((salt / 2) as i32) * length;
    (0..4).find_map(|k| {
        let at = Point3::from(p + (q - p) * (0.5 + 0.2 * coin(8 + k)) + aside * height);
        push.s.insert_point(at)
    })
}
