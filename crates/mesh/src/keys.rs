//! Keys of faces and cells by vertices, independent of orientation.

/// Vertices of a face in ascending order, equal for both its sides.
#[inline]
pub fn face_key([a, b, c]: [u32; 3]) -> [u32; 3] {
    let (a, b) = (a.min(b), a.max(b));
    let (b, c) = (b.min(c), b.max(c));
    [a.min(b), a.max(b), c]
}

/// Vertices of a tetrahedron in ascending order.
#[inline]
pub fn tet_key(mut tet: [u32; 4]) -> [u32; 4] {
    tet.sort_unstable();
    tet
}

/// True if two triangles with the same vertices have the same orientation.
#[inline]
pub fn same_turn(a: [u32; 3], b: [u32; 3]) -> bool {
    a == b || a == [b[1], b[2], b[0]] || a == [b[2], b[0], b[1]]
}
