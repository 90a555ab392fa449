//! Certificates of parts that are joined in a chain, such as the pieces of a tube.
//!
//! The chain is one part of the whole. Conditions on its vertices follow from those on its links, as those on the whole
//! follow from those on the parts ([module](super)). Links have no further edge or face in common, which [`Link::new`] checks.

use super::{Certificate, HeldJoint, PartView, certify_with};
use crate::adjacency::tet_adjacency;
use crate::{TET_FACES, face_key};
use rustc_hash::FxHashSet;

/// Part with two joints that can be a link of a chain. Only the numbers of its vertices are kept, so all of its images are
/// links.
#[derive(Clone, Debug, PartialEq)]
pub struct Link {
    certificate: Certificate,
    /// Faces of the first joint, and those of the second reversed, in order. Vertices are those of the joint, ascending.
    ends: [Vec<[u32; 3]>; 2],
}

impl Link {
    /// `None` if the part is not sound, connected and bounded by one surface. Also if an edge or a face of a tetrahedron has all
    /// of its vertices in a joint, but is not in it. The next link may have it, too.
    pub fn new(part: &PartView) -> Option<Self> {
        let [first, second] = part.joints else { return None };
        let certificate = certify_with(part, || tet_adjacency(&part.mesh.tets, part.mesh.points.len()));
        let [_] = certificate.surfaces[..] else { return None };
        let is_sound = certificate.is_sound() && !certificate.unsound && certificate.components == 1;
        let is_alone = |joint: &Vec<[u32; 3]>| shares_nothing_else(part, joint);
        (is_sound && part.caps.is_empty() && is_alone(first) && is_alone(second)).then(|| {
            let reversed: Vec<[u32; 3]> = second.iter().map(|&[a, b, c]| [a, c, b]).collect();
            Self { certificate, ends: [in_order(first), in_order(&reversed)] }
        })
    }
}

/// True if edges and faces with all vertices in a joint are edges and faces of the joint.
fn shares_nothing_else(part: &PartView, joint: &[[u32; 3]]) -> bool {
    let vertices: FxHashSet<u32> = joint.iter().flatten().copied().collect();
    let faces: FxHashSet<[u32; 3]> = joint.iter().map(|&face| face_key(face)).collect();
    let edges: FxHashSet<[u32; 2]> = joint.iter().flat_map(|&face| edges_of(face)).collect();
    part.mesh.tets.iter().all(|tet| {
        // Edges of the wall are some of all edges.
        TET_FACES.map(|face| face.map(|i| tet[i])).into_iter().all(|face| {
            let is_in = |list: &[u32]| list.iter().all(|v| vertices.contains(v));
            (!is_in(&face) || faces.contains(&face_key(face)))
                && edges_of(face).iter().all(|edge| !is_in(edge) || edges.contains(edge))
        })
    })
}

fn edges_of([a, b, c]: [u32; 3]) -> [[u32; 2]; 3] {
    [[a, b], [b, c], [c, a]].map(|[a, b]| [a.min(b), a.max(b)])
}

/// Faces by the ranks of their vertices, each from its smallest vertex on, in order.
fn in_order(faces: &[[u32; 3]]) -> Vec<[u32; 3]> {
    let mut vertices = faces.as_flattened().to_vec();
    vertices.sort_unstable();
    vertices.dedup();
    let rank = |v: u32| vertices.partition_point(|&x| x < v) as u32;
    let mut ordered: Vec<[u32; 3]> = faces
        .iter()
        .map(|face| {
            let mut face = face.map(rank);
            let least = (0..3).min_by_key(|&i| face[i]).unwrap_or_default();
            face.rotate_left(least);
            face
        })
        .collect();
    ordered.sort_unstable();
    ordered
}

/// Certificate of links joined each to the next, whose common vertices have equal order in both. Holds for conditions on
/// vertices; [`certify_image`](super::certify_image) tests those on points. `None` if the joints between two links differ.
pub fn chained<'a>(links: impl IntoIterator<Item = &'a Link>) -> Option<Certificate> {
    let mut links = links.into_iter();
    let mut last = links.next()?;
    let mut chain = last.certificate.clone();
    for link in links {
        if last.ends[1] != link.ends[0] {
            return None;
        }
        let next = &link.certificate;
        let [before, joint] = [&chain, next].map(|c| <[HeldJoint; 2]>::try_from(&c.joints[..]).ok());
        let ([first, inner], [_, second]) = (before?, joint?);
        chain.points += next.points - inner.vertices;
        chain.tets += next.tets;
        chain.wall_faces += next.wall_faces;
        // A joint removes a disc of both surfaces.
        chain.surfaces[0].euler += next.surfaces[0].euler - 2;
        chain.joints = vec![first, second];
        last = link;
    }
    Some(chain)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::TetMesh;
    use crate::check::parts::certify_image;
    use crate::geometry::Point3;

    /// Prism over a square with its center, between two heights: 5 points below, then 5 above.
    fn prism(low: f64, high: f64) -> TetMesh {
        let ring = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]];
        let at = |z: f64| ring.map(|[x, y]| Point3::new(x, y, z));
        let points = [at(low), at(high)].concat();
        let prism = |[a, b, c]: [u32; 3]| [[a, b, c, c + 5], [a, b, c + 5, b + 5], [a, b + 5, c + 5, a + 5]];
        // Vertices of a prism ascend, so that diagonals of neighbors agree.
        let positive = |t: [u32; 4]| {
            let [a, b, c, d] = t.map(|v| points[v as usize]);
            if (b - a).cross(&(c - a)).dot(&(d - a)) > 0.0 { t } else { [t[1], t[0], t[2], t[3]] }
        };
        let bases = [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 1, 4]];
        TetMesh { tets: bases.into_iter().flat_map(prism).map(positive).collect(), points }
    }

    fn discs(base: u32) -> [Vec<[u32; 3]>; 2] {
        let down = vec![[0, 2, 1], [0, 3, 2], [0, 4, 3], [0, 1, 4]];
        let up = down.iter().map(|&[a, b, c]| [a, c, b].map(|v| v + base)).collect();
        [down, up]
    }

    #[test]
    fn a_chain_has_the_certificate_of_the_joined_mesh() {
        let link = |mesh: &TetMesh| Link::new(&PartView { mesh, joints: &discs(5), caps: &[] }).expect("a link");
        let (below, above) = (prism(0.0, 1.0), prism(1.0, 2.0));
        let mut joined = below.clone();
        joined.points.extend_from_slice(&above.points[5..]);
        joined.tets.extend(above.tets.iter().map(|t| t.map(|v| v + 5)));
        let joints = discs(10);
        let part = PartView { mesh: &joined, joints: &joints, caps: &[] };
        let adjacency = tet_adjacency(&joined.tets, joined.points.len());
        let all = adjacency.boundary().map(|face| crate::adjacency::face_vertices(&joined.tets, face));
        let is_wall = |face: &[u32; 3]| !joints.iter().flatten().any(|f| face_key(*f) == face_key(*face));
        let wall: Vec<[u32; 3]> = all.filter(is_wall).collect();
        let chain = chained([&link(&below), &link(&above)]).expect("a chain");
        let image = certify_image(&part, &wall, &chain).expect("sound");
        assert_eq!(image, certify_with(&part, || &adjacency));
        assert!(image.is_sound());
    }

    #[test]
    fn links_with_other_discs_or_further_common_edges_are_no_chain() {
        let mesh = prism(0.0, 1.0);
        let link = Link::new(&PartView { mesh: &mesh, joints: &discs(5), caps: &[] }).expect("a link");
        let turned =
            Link { ends: [link.ends[1].iter().map(|&[a, b, c]| [a, c, b]).collect(), Vec::new()], ..link.clone() };
        assert!(chained([&link, &turned]).is_none());
        // Half of a disc: edges between its halves are beside it, and the faces of the other half.
        let [down, up] = discs(5);
        let half = [vec![down[0], down[2]], up];
        assert!(Link::new(&PartView { mesh: &mesh, joints: &half, caps: &[] }).is_none());
        assert!(!shares_nothing_else(&PartView { mesh: &mesh, joints: &half, caps: &[] }, &half[0]));
    }

    #[test]
    fn a_chain_has_the_loops_of_all_its_links() {
        let mesh = prism(0.0, 1.0);
        let mut link = Link::new(&PartView { mesh: &mesh, joints: &discs(5), caps: &[] }).expect("a link");
        // Each with one handle.
        link.certificate.surfaces[0].euler = 0;
        let chain = chained([&link, &link, &link]).expect("a chain");
        assert_eq!(chain.surfaces[0].euler, 2 - 2 * 3);
    }

    #[test]
    fn links_have_equal_ends_if_their_vertices_have_equal_order() {
        assert_eq!(in_order(&[[9, 4, 7], [4, 9, 8]]), [[0, 1, 3], [0, 3, 2]]);
        assert_eq!(in_order(&[[8, 4, 9], [7, 9, 4]]), [[0, 1, 3], [0, 3, 2]]);
        assert_eq!(in_order(&[[2, 0, 1], [2, 3, 0]]), [[0, 1, 2], [0, 2, 3]]);
    }

    #[test]
    fn edges_and_faces_between_vertices_of_a_joint_belong_to_it() {
        let shares_nothing_else = |tets: &[[u32; 4]], joint: &[[u32; 3]]| {
            let mesh = TetMesh { points: Vec::new(), tets: tets.to_vec() };
            shares_nothing_else(&PartView { mesh: &mesh, joints: &[], caps: &[] }, joint)
        };
        let joint = [[1, 2, 3], [2, 1, 4]];
        assert!(shares_nothing_else(&[[1, 2, 3, 5], [2, 1, 4, 5]], &joint));
        // An edge from 3 to 4, in no face of the joint.
        assert!(!shares_nothing_else(&[[3, 4, 5, 6]], &joint));
        // All edges of a face are in the joint, but the face is not.
        assert!(!shares_nothing_else(&[[1, 2, 3, 4]], &[[1, 2, 4], [2, 3, 4], [3, 1, 4]]));
    }
}
