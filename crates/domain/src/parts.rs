//! Large meshes with regions in parts, most of which are stored.
//!
//! The lumen is read from its own mesh. Tetrahedra of shells are made from their prisms when they are read. Those of the tissue
//! are stored piece by piece.

use super::build::{Grown, ShellsReport};
use super::error::DomainError;
use super::labels::{LUMEN_ID, Labelled, regions, tissue_id};
use super::layout::Layout;
use super::plan::{DomainPlan, TissuePlan};
use super::shelf::{Filled, Shelf, key_of};
use anastomesh_mesh::check::{CheckReport, check_regions_in_passes};
use anastomesh_mesh::geometry::Point3;
use anastomesh_mesh::progress::{Progress, Stage};
use anastomesh_mesh::source::{FacePiece, MeshSource, SourceCounts, TetPiece};
use anastomesh_mesh::{NamedRegion, Patch, TriMesh};
use anastomesh_skeleton::Skeleton;
use anastomesh_tet::parts::{Piece, Pieces, Prisms, Watch, fill_spaced};
use anastomesh_tet::{TetError, Tetrahedralizer};
use rayon::prelude::*;
use std::borrow::Cow;
use std::io;
use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Triangles of the wall whose prisms are one part.
const TRIANGLES: usize = 20_000;

/// Large mesh with several regions, most of which is stored.
pub struct DomainInParts<'a> {
    /// The mesh. Its blocks are the regions, and its boundary contains the interfaces.
    pub mesh: RegionParts<'a>,
    /// Regions, by ascending id.
    pub regions: Vec<NamedRegion>,
    /// Thickness of the shells; `None` without any.
    pub shells: Option<ShellsReport>,
    /// Report of the validity check.
    pub check: CheckReport,
}

/// Mesh with regions that is read in parts: those of the lumen, of the shells, of the surfaces around the tissue, and of the
/// tissue.
pub struct RegionParts<'a> {
    lumen: &'a dyn MeshSource,
    of_lumen: SourceCounts,
    /// First point of each part of the lumen, if points have moved.
    starts: Vec<u32>,
    /// Points of the lumen that have moved, ascending.
    moved: Vec<(u32, Point3)>,
    /// Points of the lumen's surface, ascending, and their positions.
    on_surface: (Vec<u32>, Vec<Point3>),
    shells: Vec<Point3>,
    prisms: Prisms,
    /// Parts of the shells.
    of_shells: u32,
    /// Points of the surfaces around the tissue, then of interfaces in it.
    around: Vec<Point3>,
    tissue: i32,
    pieces: Vec<StoredPiece>,
    shelf: &'a dyn Shelf,
    /// Labelled faces of shells and tissue.
    faces: Labelled,
    counts: SourceCounts,
}

/// Piece of the tissue.
struct StoredPiece {
    filled: Filled,
    /// Number in the mesh of each point of its surface.
    numbers: Vec<u32>,
    /// First of its other points.
    first: u32,
}

impl StoredPiece {
    /// Number after that of its last point.
    fn end(&self) -> u32 {
        self.first + self.filled.points
    }
}

impl DomainPlan {
    /// True if the regions can be made in parts: without regions in the tissue, and with all of them in the result.
    pub fn may_be_in_parts(&self) -> bool {
        self.without.is_empty() && self.tissue.as_ref().is_none_or(|tissue| tissue.regions.is_empty())
    }
}

impl<'a> DomainInParts<'a> {
    /// Adds shells and tissue to the mesh of a lumen, and checks the whole, as [`Domain::around`](super::Domain::around) does.
    /// Pieces of tissue are kept in `shelf`, and found there by a later run. `lumen_check` is the report on the lumen.
    ///
    /// # Errors
    /// See [`DomainError`].
    pub fn around(
        lumen: &'a dyn MeshSource,
        network: &Skeleton,
        plan: &DomainPlan,
        lumen_check: &CheckReport,
        shelf: &'a dyn Shelf,
        progress: &dyn Progress,
    ) -> Result<Self, DomainError> {
        let Grown { surface, moved, mut shells, prisms, around, report } = Grown::of(lumen, network, plan, progress)?;
        let of_lumen = lumen.counts();
        let mut layout = Layout::new(&surface, &shells, around.as_ref())?;
        let of_patches = (lumen.patches().to_vec(), Vec::new(), Vec::new());
        let faces = Labelled::of(of_patches, &layout, plan, &|v| layout.in_mesh(of_lumen.points as u32, v));
        let boundary = layout.outsides.pop().map(|outside| {
            let numbers: Vec<u32> =
                outside.numbers.iter().map(|&v| layout.in_mesh(of_lumen.points as u32, v)).collect();
            (outside.boundary, numbers)
        });
        // Only points are needed from here on.
        drop(layout);
        let on_surface = surface.into_points();
        let shell_points = std::mem::take(&mut shells.points);
        drop(shells);
        let mut around: Vec<Point3> =
            around.into_iter().flat_map(|around| around.surfaces).flat_map(|surface| surface.points).collect();
        let mut pieces = Vec::new();
        if let (Some(plan), Some((boundary, numbers))) = (&plan.tissue, boundary) {
            let first = (of_lumen.points + shell_points.len() + around.len()) as u32;
            let tissue = Tissue { plan, filler: plan.filler(), shelf, progress };
            let interfaces;
            (interfaces, pieces) = tissue.fill(boundary, &numbers, first)?;
            around.extend(interfaces);
        }
        let mut mesh = RegionParts {
            lumen,
            of_lumen,
            starts: Vec::new(),
            moved,
            on_surface,
            of_shells: prisms.len().div_ceil(TRIANGLES).max(1) as u32,
            prisms,
            shells: shell_points,
            around,
            tissue: tissue_id(plan),
            pieces,
            shelf,
            faces,
            counts: SourceCounts::default(),
        };
        mesh.count()?;
        progress.at(Stage::Check, 0, 0);
        let regions = regions(plan);
        let check = check_regions_in_passes(&mesh, &regions, lumen_check, progress)?;
        Ok(Self { mesh, regions, shells: report, check })
    }
}

/// Filling of the tissue.
struct Tissue<'a> {
    plan: &'a TissuePlan,
    filler: Tetrahedralizer,
    shelf: &'a dyn Shelf,
    progress: &'a dyn Progress,
}

impl Tissue<'_> {
    /// Divides the tissue into pieces and fills them. Returns the points of interfaces, which have numbers from `first` on, and
    /// the pieces, whose own points follow.
    fn fill(
        &self,
        boundary: TriMesh,
        numbers: &[u32],
        first: u32,
    ) -> Result<(Vec<Point3>, Vec<StoredPiece>), DomainError> {
        self.progress.at(Stage::Tissue, 0, 0);
        let watch = Watch::asking(self.progress);
        let Pieces { mut points, pieces, .. } =
            Pieces::of(&self.filler, &boundary, self.plan.piece, &watch).map_err(DomainError::Tissue)?;
        drop(boundary);
        let interfaces = points.split_off(numbers.len());
        let given = numbers.len() as u32;
        let in_mesh = |v: u32| numbers.get(v as usize).copied().unwrap_or_else(|| first + v - given);
        let (done, total) = (AtomicUsize::new(0), pieces.len() as u64);
        let fill = |piece: Piece| {
            let filled = self.filled(&piece, &watch)?;
            self.progress.at(Stage::Tissue, done.fetch_add(1, Ordering::Relaxed) as u64 + 1, total);
            Ok((piece.numbers.into_iter().map(in_mesh).collect(), filled))
        };
        let filled: Vec<(Vec<u32>, Filled)> = pieces.into_par_iter().map(fill).collect::<Result<_, DomainError>>()?;
        let mut next = u64::from(first) + interfaces.len() as u64;
        let mut stored = Vec::with_capacity(filled.len());
        for (numbers, filled) in filled {
            stored.push(StoredPiece { filled, numbers, first: next as u32 });
            next += u64::from(filled.points);
        }
        if next > u64::from(u32::MAX) {
            let (estimate, limit) = (next as usize, u32::MAX as usize);
            return Err(DomainError::Tissue(TetError::TooMany { estimate, limit }));
        }
        Ok((interfaces, stored))
    }

    /// Fills a piece, unless the shelf has it.
    fn filled(&self, piece: &Piece, watch: &Watch) -> Result<Filled, DomainError> {
        let TissuePlan { size, growth, .. } = self.plan;
        let key = key_of(&format!("{size:?} {growth:?}"), &piece.surface);
        if let Some(found) = Filled::find(self.shelf, key)? {
            return Ok(found);
        }
        let mesh = fill_spaced(&self.filler, &piece.surface, watch).map_err(DomainError::Tissue)?.mesh;
        Ok(Filled::keep(self.shelf, key, &mesh.points[piece.numbers.len()..], &mesh.tets)?)
    }
}

impl RegionParts<'_> {
    /// Counts points and cells, and where parts of the lumen begin.
    fn count(&mut self) -> io::Result<()> {
        if !self.moved.is_empty() {
            let mut first = 0;
            for part in 0..self.lumen.parts() {
                self.starts.push(first);
                first += self.lumen.points(part)?.len() as u32;
            }
        }
        let own: usize = self.pieces.iter().map(|piece| piece.filled.points as usize).sum();
        let tets: usize = self.pieces.iter().map(|piece| piece.filled.tets as usize).sum();
        self.counts = SourceCounts {
            points: self.of_lumen.points + self.shells.len() + self.around.len() + own,
            tets: self.of_lumen.tets + self.prisms.len() * self.prisms.tets_per_triangle() + tets,
            boundary: self.of_lumen.boundary + self.faces.faces.len(),
        };
        Ok(())
    }

    /// Kind of a part.
    fn kind(&self, part: u32) -> Kind<'_> {
        let lumen = self.lumen.parts();
        match part.checked_sub(lumen) {
            None => Kind::Lumen,
            Some(i) if i < self.of_shells => Kind::Shells(i),
            Some(i) if i == self.of_shells => Kind::Around,
            Some(i) => Kind::Tissue(&self.pieces[(i - self.of_shells - 1) as usize]),
        }
    }

    /// Share of `count` items that a part of the shells has.
    fn share(&self, part: u32, count: usize) -> Range<usize> {
        let at = |part: u32| count * part as usize / self.of_shells as usize;
        at(part)..at(part + 1)
    }

    /// Number in the mesh of a point of the shells' prisms.
    fn in_mesh(&self, v: u32) -> u32 {
        let on_surface = self.on_surface.0.len() as u32;
        match v.checked_sub(on_surface) {
            Some(i) => self.of_lumen.points as u32 + i,
            None => self.on_surface.0[v as usize],
        }
    }

    /// Points of the lumen with these indices.
    fn lumen_points(&self, ids: &[u32]) -> io::Result<Vec<Point3>> {
        let (on, positions) = &self.on_surface;
        let place = |id: &u32| on.binary_search(id).ok().map(|i| positions[i]);
        let known: Vec<Option<Point3>> = ids.iter().map(place).collect();
        let others: Vec<u32> = ids.iter().zip(&known).filter(|(_, p)| p.is_none()).map(|(id, _)| *id).collect();
        let mut read = if others.is_empty() { Vec::new() } else { self.lumen.points_of(&others)? }.into_iter();
        let found: Option<Vec<Point3>> = known.into_iter().map(|p| p.or_else(|| read.next())).collect();
        found.ok_or_else(|| io::ErrorKind::InvalidData.into())
    }
}

/// Content of a part.
enum Kind<'a> {
    Lumen,
    Shells(u32),
    Around,
    Tissue(&'a StoredPiece),
}

impl MeshSource for RegionParts<'_> {
    fn counts(&self) -> SourceCounts {
        self.counts
    }

    fn patches(&self) -> &[Patch] {
        &self.faces.list
    }

    fn parts(&self) -> u32 {
        self.lumen.parts() + self.of_shells + 1 + self.pieces.len() as u32
    }

    fn points(&self, part: u32) -> io::Result<Cow<'_, [Point3]>> {
        match self.kind(part) {
            Kind::Lumen => {
                let mut points = self.lumen.points(part)?;
                if let Some(&first) = self.starts.get(part as usize) {
                    let from = self.moved.partition_point(|(v, _)| *v < first);
                    for &(v, place) in &self.moved[from..] {
                        let Some(_) = points.get((v - first) as usize) else { break };
                        points.to_mut()[(v - first) as usize] = place;
                    }
                }
                Ok(points)
            }
            Kind::Shells(i) => Ok((&self.shells[self.share(i, self.shells.len())]).into()),
            Kind::Around => Ok((&self.around[..]).into()),
            Kind::Tissue(piece) => Ok(piece.filled.points(self.shelf)?.into()),
        }
    }

    fn tets(&self, part: u32) -> io::Result<TetPiece<'_>> {
        let (tets, blocks): (Vec<[u32; 4]>, Vec<i32>) = match self.kind(part) {
            Kind::Lumen => {
                let mut piece = self.lumen.tets(part)?;
                piece.blocks = vec![LUMEN_ID; piece.tets.len()].into();
                return Ok(piece);
            }
            Kind::Shells(i) => {
                let own = self.prisms.tets(self.share(i, self.prisms.len()));
                own.map(|(tet, shell)| (tet.map(|v| self.in_mesh(v)), LUMEN_ID + 1 + shell as i32)).unzip()
            }
            Kind::Around => (Vec::new(), Vec::new()),
            Kind::Tissue(piece) => {
                let given = piece.numbers.len() as u32;
                let number = |v: u32| piece.numbers.get(v as usize).copied().unwrap_or_else(|| piece.first + v - given);
                let tets: Vec<[u32; 4]> = piece.filled.tets(self.shelf)?.into_iter().map(|t| t.map(number)).collect();
                let count = tets.len();
                (tets, vec![self.tissue; count])
            }
        };
        Ok(TetPiece { tets: tets.into(), blocks: blocks.into() })
    }

    fn boundary(&self, part: u32) -> io::Result<FacePiece<'_>> {
        match self.kind(part) {
            Kind::Lumen => {
                let mut piece = self.lumen.boundary(part)?;
                piece.blocks = vec![LUMEN_ID; piece.faces.len()].into();
                Ok(piece)
            }
            Kind::Shells(i) => {
                let Labelled { faces, patches, regions, .. } = &self.faces;
                let own = self.share(i, faces.len());
                let (faces, patches) = ((&faces[own.clone()]).into(), (&patches[own.clone()]).into());
                Ok(FacePiece { faces, patches, blocks: (&regions[own]).into() })
            }
            Kind::Around | Kind::Tissue(_) => Ok(FacePiece::default()),
        }
    }

    fn points_of(&self, ids: &[u32]) -> io::Result<Vec<Point3>> {
        let of_shells = self.of_lumen.points as u32;
        let of_around = of_shells + self.shells.len() as u32;
        let of_tissue = of_around + self.around.len() as u32;
        let [a, b, c] = [of_shells, of_around, of_tissue].map(|end| ids.partition_point(|&id| id < end));
        let mut found = self.lumen_points(&ids[..a])?;
        found.extend(ids[a..b].iter().map(|id| self.shells[(id - of_shells) as usize]));
        found.extend(ids[b..c].iter().map(|id| self.around[(id - of_around) as usize]));
        let mut rest = &ids[c..];
        while let Some(&id) = rest.first() {
            let place = self.pieces.partition_point(|piece| piece.end() <= id);
            let piece = self.pieces.get(place).ok_or(io::ErrorKind::InvalidInput)?;
            let (here, others) = rest.split_at(rest.partition_point(|&id| id < piece.end()));
            let points = piece.filled.points(self.shelf)?;
            let at = |id: &u32| points.get((id - piece.first) as usize).copied().ok_or(io::ErrorKind::InvalidData);
            for id in here {
                found.push(at(id)?);
            }
            rest = others;
        }
        Ok(found)
    }
}
