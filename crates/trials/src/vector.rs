//! Points and vectors as arrays.

/// Point or vector.
pub type Vector = [f64; 3];

/// Returns `from + direction * length`.
pub fn along(from: Vector, direction: Vector, length: f64) -> Vector {
    [0, 1, 2].map(|k| from[k] + direction[k] * length)
}

/// Dot product.
pub fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Cross product.
pub fn cross(a: Vector, b: Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Length of a vector.
pub fn norm(v: Vector) -> f64 {
    dot(v, v).sqrt()
}

/// Unit vector of a direction.
pub fn unit(v: Vector) -> Vector {
    let length = norm(v);
    v.map(|x| x / length)
}

/// Three orthogonal unit vectors, the first along `axis`.
pub fn frame(axis: Vector) -> [Vector; 3] {
    let first = unit(axis);
    let helper = if first[0].abs() < 0.7 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
    let second = unit(cross(first, helper));
    [first, second, cross(first, second)]
}

/// Coordinates of a point in a frame turned to world coordinates.
pub fn turned(point: Vector, frame: &[Vector; 3]) -> Vector {
    [0, 1, 2].map(|k| point[0] * frame[0][k] + point[1] * frame[1][k] + point[2] * frame[2][k])
}
