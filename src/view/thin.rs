//! A surface thinned out at a stroke: faces become points, as long as there are far too many of them. What is left is made coarser
//! with care.

use crate::geometry::Point3;
use rustc_hash::FxHashMap;

/// A stroke that leaves more than this share of the faces is the last one.
const WORTH: f64 = 0.8;

/// Lets whole faces go until no more than `enough` are left, or few can. Points that are fixed stay.
pub fn thinned_out(
    points: Vec<Point3>,
    mut triangles: Vec<[u32; 3]>,
    fixed: Vec<bool>,
    enough: usize,
) -> (Vec<Point3>, Vec<[u32; 3]>, Vec<bool>) {
    if triangles.len() <= enough {
        return (points, triangles, fixed);
    }
    while triangles.len() > enough {
        let before = triangles.len();
        stroke(&mut triangles, &fixed);
        if triangles.len() as f64 > WORTH * before as f64 {
            break;
        }
    }
    let mut numbers: FxHashMap<u32, u32> = FxHashMap::default();
    let mut old = Vec::new();
    for v in triangles.as_flattened_mut() {
        *v = *numbers.entry(*v).or_insert_with(|| {
            old.push(*v as usize);
            old.len() as u32 - 1
        });
    }
    (old.iter().map(|&v| points[v]).collect(), triangles, old.iter().map(|&v| fixed[v]).collect())
}

/// Makes faces that share no point with each other, nor with what stays, one point each.
fn stroke(triangles: &mut Vec<[u32; 3]>, fixed: &[bool]) {
    let mut stands: Vec<u32> = (0..fixed.len() as u32).collect();
    let mut taken = fixed.to_vec();
    for t in &*triangles {
        if t.iter().all(|&v| !taken[v as usize]) {
            for &v in t {
                stands[v as usize] = t[0];
                taken[v as usize] = true;
            }
        }
    }
    triangles.iter_mut().for_each(|t| *t = t.map(|v| stands[v as usize]));
    triangles.retain(|[a, b, c]| a != b && b != c && c != a);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::view::rings::rings;

    #[test]
    fn a_sheet_keeps_its_rim_and_few_faces() {
        let n = 20_u32;
        let at = |i: u32, j: u32| j * (n + 1) + i;
        let cell = |(i, j): (u32, u32)| {
            [[at(i, j), at(i + 1, j), at(i, j + 1)], [at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]]
        };
        let triangles: Vec<[u32; 3]> = (0..n).flat_map(|j| (0..n).map(move |i| (i, j))).flat_map(cell).collect();
        let place = |v: u32| Point3::new(f64::from(v % (n + 1)), f64::from(v / (n + 1)), 0.0);
        let points: Vec<Point3> = (0..(n + 1) * (n + 1)).map(place).collect();
        let is_rim = |p: &Point3| [p.x, p.y].iter().any(|&x| x == 0.0 || x == f64::from(n));
        let fixed: Vec<bool> = points.iter().map(is_rim).collect();
        let rim = fixed.iter().filter(|f| **f).count();
        let (found, faces, stays) = thinned_out(points.clone(), triangles.clone(), fixed.clone(), 300);
        assert!(faces.len() < 400, "{}", faces.len());
        assert_eq!(rings(&faces).iter().map(Vec::len).sum::<usize>(), rim);
        assert!(found.iter().zip(&stays).all(|(p, &stays)| stays == is_rim(p)));
        // What is not too many stays as it is.
        assert_eq!(thinned_out(points, triangles.clone(), fixed, 800).1, triangles);
    }
}
