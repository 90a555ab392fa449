//! Figures of a mesh on which the convergence of a cell-centred solver depends, by the definitions of `checkMesh`.

use anastomesh_mesh::faces::PartFaces;
use anastomesh_mesh::geometry::{Point3, Vec3};
use anastomesh_mesh::source::MeshSource;
use anastomesh_mesh::stacks::Cells;
use std::io;

/// Number of tetrahedra up to which all parts of a mesh are measured. Of larger meshes a sample is.
const MEASURED: usize = 2_000_000;

/// Parts of a mesh that are measured: all of a small mesh, else every n-th.
pub(super) struct Sample {
    step: u32,
}

impl Sample {
    pub(super) fn of(mesh: &dyn MeshSource) -> Self {
        Self { step: (mesh.counts().tets.div_ceil(MEASURED) as u32).clamp(1, mesh.parts().max(1)) }
    }

    pub(super) fn holds(&self, part: u32) -> bool {
        part.is_multiple_of(self.step)
    }
}

/// Figures of the faces inside parts of a mesh.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Figures {
    /// Maximum angle between a face normal and the line between the centres of its cells, in degrees.
    pub(super) max_angle: f64,
    /// Sum of these angles over the faces.
    pub(super) angles: f64,
    pub(super) faces: u64,
    /// Maximum distance of a face's centre from the line between its cells' centres, as a fraction of the face's extent in
    /// this direction.
    pub(super) skewness: f64,
    /// Maximum ratio of the volumes of two neighbouring cells.
    pub(super) growth: f64,
}

impl Figures {
    /// Mean angle, in degrees.
    pub(super) fn mean_angle(&self) -> f64 {
        if self.faces == 0 { 0.0 } else { self.angles / self.faces as f64 }
    }

    /// Combines both figures.
    pub(super) fn extend(&mut self, other: Self) {
        self.max_angle = self.max_angle.max(other.max_angle);
        self.angles += other.angles;
        self.faces += other.faces;
        self.skewness = self.skewness.max(other.skewness);
        self.growth = self.growth.max(other.growth);
    }

    /// Measures the faces between the cells of a part, whose tetrahedra are numbered from `first`.
    pub(super) fn of_part(
        mesh: &dyn MeshSource,
        part: u32,
        first: u32,
        faces: &PartFaces,
        cells: Option<&Cells>,
    ) -> io::Result<Self> {
        let tets = mesh.tets(part)?.tets;
        if tets.is_empty() {
            return Ok(Self::default());
        }
        let corners = mesh.corners_of(&tets)?;
        let end = first + tets.len() as u32;
        let cell_of = |tet: u32| cells.map_or(tet, |cells| cells.of_tet(tet));
        let start = cell_of(first);
        let all = centres(&corners, |i| (cell_of(first + i as u32) - start) as usize);
        let place = |[a, b, c]: [u32; 3], tet: u32| {
            let i = (tet - first) as usize;
            let at = |v: u32| tets[i].iter().position(|&own| own == v).map(|at| corners[i][at]);
            Some([at(a)?, at(b)?, at(c)?])
        };
        let inside = faces.inner.iter().filter(|face| face.tets[1] < end);
        let between = inside.filter_map(|face| {
            let cells = face.tets.map(|tet| (cell_of(tet) - start) as usize);
            (cells[0] != cells[1]).then_some((cells, place(face.vertices, face.tets[0])?))
        });
        let mut figures = Self::default();
        let mut measure = |same: &[([usize; 2], [Point3; 3])]| {
            if let [Some(owner), Some(neighbour)] = same[0].0.map(|cell| all.get(cell)) {
                figures.measure([owner, neighbour], same);
            }
        };
        if cells.is_none() {
            between.for_each(|face| measure(&[face]));
        } else {
            let mut between: Vec<_> = between.collect();
            between.sort_by_key(|face| face.0);
            between.chunk_by(|a, b| a.0 == b.0).for_each(measure);
        }
        Ok(figures)
    }

    /// Measures the face between two cells, which may be in triangles.
    fn measure(&mut self, [owner, neighbour]: [&Centre; 2], triangles: &[([usize; 2], [Point3; 3])]) {
        let (mut normal, mut sum, mut area) = (Vec3::zeros(), Vec3::zeros(), 0.0);
        for (_, [a, b, c]) in triangles {
            let half = (b - a).cross(&(c - a)) * 0.5;
            let size = half.norm();
            normal += half;
            sum += size * (a.coords + b.coords + c.coords) / 3.0;
            area += size;
        }
        let way = neighbour.place - owner.place;
        let along = normal.dot(&way);
        let size = normal.norm() * way.norm();
        if !(area > 0.0 && size > 0.0) {
            return;
        }
        let angle = arc_cosine(along / size).to_degrees();
        self.max_angle = self.max_angle.max(angle);
        self.angles += angle;
        self.faces += 1;
        let centre = sum / area;
        let from = centre - owner.place;
        let aside = from - way * (normal.dot(&from) / along);
        let corners = triangles.iter().flat_map(|(_, corners)| corners);
        let distance = aside.norm();
        let extent = |p: &Point3| (aside.dot(&(p.coords - centre)) / distance).abs();
        let extent = corners.map(extent).fold(0.2 * way.norm(), f64::max);
        if distance > 0.0 && along != 0.0 {
            self.skewness = self.skewness.max(distance / extent);
        }
        let [small, large] = [owner.volume.min(neighbour.volume), owner.volume.max(neighbour.volume)];
        self.growth = self.growth.max(if small > 0.0 { large / small } else { f64::INFINITY });
    }
}

/// Coefficients of an arc cosine (Abramowitz and Stegun, 4.4.46), from the highest power.
const ARC_COSINE: [f64; 8] = [
    -0.001_262_491_1,
    0.006_670_090_1,
    -0.017_088_125_6,
    0.030_891_881_0,
    -0.050_174_304_6,
    0.088_978_987_4,
    -0.214_598_801_6,
    1.570_796_305_0,
];

/// Arc cosine with an error below 3e-8, faster than the system's and equal on all processors.
fn arc_cosine(x: f64) -> f64 {
    let y = x.abs().min(1.0);
    let angle = (1.0 - y).sqrt() * ARC_COSINE.iter().fold(0.0, |sum, a| sum * y + a);
    if x < 0.0 { std::f64::consts::PI - angle } else { angle }
}

/// Centroid and volume of a cell.
#[derive(Clone, Copy, Default)]
struct Centre {
    place: Vec3,
    volume: f64,
}

/// Centroids of cells, given by the corners of their tetrahedra, which are consecutive.
fn centres(corners: &[[Point3; 4]], cell_of: impl Fn(usize) -> usize) -> Vec<Centre> {
    let mut all: Vec<Centre> = Vec::with_capacity(corners.len());
    for (i, [a, b, c, d]) in corners.iter().enumerate() {
        let volume = (b - a).cross(&(c - a)).dot(&(d - a)).abs() / 6.0;
        let cell = cell_of(i);
        if cell >= all.len() {
            all.resize(cell + 1, Centre::default());
        }
        all[cell].volume += volume;
        all[cell].place += volume * (a.coords + b.coords + c.coords + d.coords) / 4.0;
    }
    for cell in &mut all {
        cell.place /= cell.volume.max(f64::MIN_POSITIVE);
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use anastomesh_mesh::faces::Faces;
    use anastomesh_mesh::{TetMesh, VolumeMesh};

    fn measured(points: Vec<Point3>) -> Figures {
        let tets = vec![[0, 1, 2, 3], [0, 2, 1, 4]];
        let mesh = VolumeMesh { mesh: TetMesh { points, tets }, ..VolumeMesh::default() };
        let outer = [[0, 1, 3], [1, 2, 3], [2, 0, 3], [1, 0, 4], [2, 1, 4], [0, 2, 4]];
        let mesh = VolumeMesh { boundary: outer.to_vec(), boundary_patch: vec![1; 6], ..mesh };
        let faces = Faces::of(&mesh).unwrap().of_part(0).unwrap();
        Figures::of_part(&mesh, 0, 0, &faces, None).unwrap()
    }

    #[test]
    fn arc_cosines_are_those_of_the_system() {
        for i in -1000..=1000 {
            let x = f64::from(i) / 1000.0;
            assert!((arc_cosine(x) - libm::acos(x)).abs() < 3e-8, "{x}");
        }
        assert_eq!(arc_cosine(1.000_000_1), 0.0);
    }

    #[test]
    fn angle_skewness_and_growth_of_two_tetrahedra() {
        let base = [Point3::new(0., 0., 0.), Point3::new(3., 0., 0.), Point3::new(0., 3., 0.)];
        // Both apexes are above the centre of the common face.
        let even = [base.to_vec(), vec![Point3::new(1., 1., 2.), Point3::new(1., 1., -2.)]].concat();
        let figures = measured(even);
        assert!(figures.max_angle < 1.2e-6 && figures.skewness < 1e-12 && (figures.growth - 1.0).abs() < 1e-12);
        // Centres are a quarter of the way to the apexes: at (1, 1, 1) and (2, 1, -0.5).
        let uneven = [base.to_vec(), vec![Point3::new(1., 1., 4.), Point3::new(5., 1., -2.)]].concat();
        let figures = measured(uneven);
        let angle = libm::atan(1.0_f64 / 1.5).to_degrees();
        assert!((figures.max_angle - angle).abs() < 1.2e-6 && (figures.mean_angle() - angle).abs() < 1.2e-6);
        assert!((figures.growth - 2.0).abs() < 1e-12);
        // The line meets the face at (5/3, 1, 0). The corner at x = 3 is 2 away from its centre.
        assert!((figures.skewness - (2.0 / 3.0) / 2.0).abs() < 1e-12, "{figures:?}");
    }
}
