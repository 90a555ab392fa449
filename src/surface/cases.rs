//! The 256 sign cases of a grid cell, derived from one rule: inside corners stay separate on ambiguous faces. Both
//! cells of a face see it alike, so the patches of neighbouring cells always match.
//!
//! Corner c of a cell lies at offset (c & 1, c >> 1 & 1, c >> 2 & 1). Edge 4·d + k runs along axis d; its start has
//! offset k & 1 along axis d + 1 and k >> 1 along axis d + 2. Face 2·d + s lies across axis d at offset s.

/// Topology of the wall within a cell.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Case {
    /// Number of patches (connected pieces of the wall), at most 4.
    pub patches: u8,
    /// Patch of each edge's crossing; `NONE` for edges without a crossing.
    pub patch_of_edge: [u8; 12],
    /// Bit f is set if the signs alternate around face f.
    pub ambiguous: u8,
}

/// Marks the absence of a patch.
pub(crate) const NONE: u8 = u8::MAX;

/// Cases indexed by the set of inside corners (bit c: corner c is inside).
pub(crate) static CASES: [Case; 256] = derive();

/// Edges of each face, in cyclic order seen from outside the cell.
pub(crate) const FACE_EDGES: [[u8; 4]; 6] = face_edges();

/// First and last corner of an edge.
pub(crate) const fn edge_corners(edge: usize) -> [usize; 2] {
    let (d, k) = (edge / 4, edge % 4);
    let first = ((k & 1) << ((d + 1) % 3)) | ((k >> 1) << ((d + 2) % 3));
    [first, first | 1 << d]
}

const fn edge_between(a: usize, b: usize) -> u8 {
    let mut e = 0;
    while e < 12 {
        let [p, q] = edge_corners(e);
        if (p == a && q == b) || (p == b && q == a) {
            return e as u8;
        }
        e += 1;
    }
    NONE
}

/// Corners of a face, counter-clockwise seen from outside the cell.
const fn face_corners(face: usize) -> [usize; 4] {
    let (d, side) = (face / 2, face % 2);
    let (u, v) = (1 << ((d + 1) % 3), 1 << ((d + 2) % 3));
    let base = side << d;
    if side == 1 { [base, base | u, base | u | v, base | v] } else { [base, base | v, base | u | v, base | u] }
}

const fn face_edges() -> [[u8; 4]; 6] {
    let mut out = [[0; 4]; 6];
    let mut f = 0;
    while f < 6 {
        let c = face_corners(f);
        let mut i = 0;
        while i < 4 {
            out[f][i] = edge_between(c[i], c[(i + 1) % 4]);
            i += 1;
        }
        f += 1;
    }
    out
}

const fn derive() -> [Case; 256] {
    let mut out = [Case { patches: 0, patch_of_edge: [NONE; 12], ambiguous: 0 }; 256];
    let mut mask = 0;
    while mask < 256 {
        out[mask] = derive_case(mask);
        mask += 1;
    }
    out
}

const fn inside(mask: usize, corner: usize) -> bool {
    mask >> corner & 1 == 1
}

const fn derive_case(mask: usize) -> Case {
    // Label crossings by the smallest edge they are joined to, then number the labels.
    let mut label = [NONE; 12];
    let mut e = 0;
    while e < 12 {
        let [p, q] = edge_corners(e);
        if inside(mask, p) != inside(mask, q) {
            label[e] = e as u8;
        }
        e += 1;
    }
    let mut ambiguous = 0;
    let mut f = 0;
    while f < 6 {
        let c = face_corners(f);
        let mut leaving = 0;
        let mut i = 0;
        while i < 4 {
            if inside(mask, c[i]) && !inside(mask, c[(i + 1) % 4]) {
                leaving += 1;
                // The segment on the face joins the exit of an inside run with its entry.
                let mut j = i;
                while inside(mask, c[j]) {
                    j = (j + 3) % 4;
                }
                label = joined(label, FACE_EDGES[f][i], FACE_EDGES[f][j]);
            }
            i += 1;
        }
        if leaving == 2 {
            ambiguous |= 1 << f;
        }
        f += 1;
    }
    let (patches, patch_of_edge) = numbered(label);
    Case { patches, patch_of_edge, ambiguous }
}

const fn joined(mut label: [u8; 12], a: u8, b: u8) -> [u8; 12] {
    let (x, y) = (label[a as usize], label[b as usize]);
    let (low, high) = if x < y { (x, y) } else { (y, x) };
    let mut e = 0;
    while e < 12 {
        if label[e] == high {
            label[e] = low;
        }
        e += 1;
    }
    label
}

const fn numbered(label: [u8; 12]) -> (u8, [u8; 12]) {
    let mut out = [NONE; 12];
    let mut count = 0;
    let mut e = 0;
    while e < 12 {
        if label[e] == e as u8 {
            let mut k = e;
            while k < 12 {
                if label[k] == e as u8 {
                    out[k] = count;
                }
                k += 1;
            }
            count += 1;
        }
        e += 1;
    }
    (count, out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_crossing_is_in_one_patch_and_no_patch_is_smaller_than_three() {
        for (mask, case) in CASES.iter().enumerate() {
            let mut sizes = vec![0; case.patches as usize];
            for e in 0..12 {
                let [p, q] = edge_corners(e);
                let crossed = inside(mask, p) != inside(mask, q);
                assert_eq!(crossed, case.patch_of_edge[e] != NONE, "case {mask} edge {e}");
                if crossed {
                    sizes[case.patch_of_edge[e] as usize] += 1;
                }
            }
            assert!(case.patches <= 4 && sizes.iter().all(|&n| n >= 3), "case {mask}: {sizes:?}");
        }
    }

    #[test]
    fn inside_corners_are_kept_apart_on_ambiguous_faces() {
        // Two opposite corners of the cell's lower face: two patches of three.
        assert_eq!(CASES[0b0000_1001].patches, 2);
        // The complement joins the outside corners through the cell's side: one patch.
        assert_eq!(CASES[0b1111_0110].patches, 1);
        assert_eq!(CASES[0b1001_0110].patches, 4);
        assert_eq!(CASES[0b0000_0000].patches + CASES[0b1111_1111].patches, 0);
    }
}
