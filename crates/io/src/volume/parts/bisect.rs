//! Recursive inertial bisection: points are divided by planes across their longest extent.

use anastomesh_mesh::geometry::{Point3, Vec3};
use nalgebra::{Matrix3, SymmetricEigen};

/// Cell to divide: its centre relative to the first one, rounded to 32 bits, and its number.
#[derive(Clone, Copy, Debug)]
pub(super) struct Site {
    place: [f32; 3],
    pub(super) cell: u32,
}

impl Site {
    pub(super) fn new(offset: Vec3, cell: u32) -> Self {
        Self { place: [offset.x as f32, offset.y as f32, offset.z as f32], cell }
    }

    fn place(&self) -> Vec3 {
        self.place.map(f64::from).into()
    }
}

/// Orders sites so that the first `sizes[0]` are the first piece, and so on. Pieces begin on the side of `from`, given relative
/// to the same origin. Ties are broken by the number, so that equal input gives equal pieces.
pub(super) fn bisect(sites: &mut [Site], sizes: &[usize], from: Point3) {
    let half = sizes.len() / 2;
    if half == 0 {
        return;
    }
    let before: usize = sizes[..half].iter().sum();
    let (axis, centre) = principal_axis(sites);
    let axis = if axis.dot(&(from.coords - centre)) > 0.0 { -axis } else { axis };
    let along = |site: &Site| axis.dot(&site.place());
    if before > 0 && before < sites.len() {
        sites.select_nth_unstable_by(before, |a, b| along(a).total_cmp(&along(b)).then(a.cell.cmp(&b.cell)));
    }
    let (first, second) = sites.split_at_mut(before);
    bisect(first, &sizes[..half], from);
    bisect(second, &sizes[half..], (centre - axis * axis.dot(&centre)).into());
}

/// Direction of the largest extent, and the mean.
fn principal_axis(sites: &[Site]) -> (Vec3, Vec3) {
    let centre = sites.iter().fold(Vec3::zeros(), |sum, site| sum + site.place()) / sites.len().max(1) as f64;
    let spread = sites.iter().fold(Matrix3::zeros(), |sum, site| {
        let d = site.place() - centre;
        sum + d * d.transpose()
    });
    let eigen = SymmetricEigen::new(spread);
    (eigen.eigenvectors.column(eigen.eigenvalues.imax()).into_owned(), centre)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_is_cut_across_from_the_given_side() {
        let row = |from: f64| {
            let mut sites: Vec<Site> = (0..9).map(|i| Site::new(Vec3::new(0.0, f64::from(i), 0.1), i)).collect();
            bisect(&mut sites, &[2, 3, 4], Point3::new(0.0, from, 0.0));
            let pieces = [&sites[..2], &sites[2..5], &sites[5..]];
            pieces.map(|piece| {
                let mut cells: Vec<u32> = piece.iter().map(|site| site.cell).collect();
                cells.sort_unstable();
                cells
            })
        };
        assert_eq!(row(-5.0)[0], [0, 1]);
        assert_eq!(row(15.0)[0], [7, 8]);
        let mut all = row(-5.0).concat();
        all.sort_unstable();
        assert!(all.into_iter().eq(0..9));
    }
}
