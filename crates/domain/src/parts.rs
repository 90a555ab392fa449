//! Large meshes with regions in parts, most of which are stored.
//!
//! The lumen is read from its own mesh, tetrahedra of shells are made from their prisms when they are read, and those of the
//! tissue are stored piece by piece.

use super::build::{Grown, PIECE, ShellsReport};
use super::error::DomainError;
use super::labels::{LUMEN_ID, Labelled, regions, tissue_id};
use super::layout::Layout;
use super::plan::DomainPlan;
use super::shelf::{Filled, Shelf};
use anastomesh_mesh::check::{CheckReport, check_regions_in_passes};
use anastomesh_mesh::geometry::Point3;
use anastomesh_mesh::progress::{Progress, Stage};
use anastomesh_mesh::source::{FacePiece, MeshSource, SourceCounts, TetPiece};
use anastomesh_mesh::{NamedRegion, Patch};
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

/// Filled piece of the tissue.
struct StoredPiece {
    record: u64,
    /// Number in the mesh of each point of its surface.
    numbers: Vec<u32>,
    /// First of its other points.
    first: u32,
    points: u32,
    tets: usize,
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
        let Grown { surface, moved, shells, prisms, around, report, .. } = Grown::of(lumen, network, plan, progress)?;
        let of_lumen = lumen.counts();
        let mut layout = Layout::new(&surface, &shells, around.as_ref())?;
        let in_mesh = |layout: &Layout, v: u32| layout.in_mesh(of_lumen.points as u32, v);
        let faces =
            Labelled::of((lumen.patches().to_vec(), Vec::new(), Vec::new()), &layout, plan, &|v| in_mesh(&layout, v));
        let mut around_points: Vec<Point3> =
            around.iter().flat_map(|around| &around.surfaces).flat_map(|surface| &surface.points).copied().collect();
        let mut pieces = Vec::new();
        let outside = layout.outsides.pop();
        if let (Some(tissue), Some(outside)) = (&plan.tissue, outside) {
            let filler = tissue.filler();
            let numbers: Vec<u32> = outside.numbers.iter().map(|&v| in_mesh(&layout, v)).collect();
            let (boundary, text) = (
                outside.boundary,
                format!("{tissue_growth:?} {tissue_size:?}", tissue_growth = tissue.growth, tissue_size = tissue.size),
            );
            let first = (of_lumen.points + shells.points.len() + around_points.len()) as u32;
            let made = Tissue { filler: &filler, text: &text, shelf, progress }.fill(
                &boundary,
                numbers,
                first,
                &mut around_points,
            )?;
            pieces = made;
        }
        drop(layout);
        let mut mesh = RegionParts {
            lumen,
            of_lumen,
            starts: Vec::new(),
            moved,
            on_surface: (surface.points, surface.surface.points),
            of_shells: prisms.len().div_ceil(TRIANGLES).max(1) as u32,
            prisms,
            shells: shells.points,
            around: around_points,
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
    filler: &'a Tetrahedralizer,
    /// Options that the result depends on.
    text: &'a str,
    shelf: &'a dyn Shelf,
    progress: &'a dyn Progress,
}

impl Tissue<'_> {
    /// Divides the tissue into pieces and fills them. The points of interfaces have numbers from `first` on, and are added to
    /// `added`; those of pieces follow.
    fn fill(
        &self,
        boundary: &anastomesh_mesh::TriMesh,
        numbers: Vec<u32>,
        first: u32,
        added: &mut Vec<Point3>,
    ) -> Result<Vec<StoredPiece>, DomainError> {
        let watch = Watch::asking(self.progress);
        self.progress.at(Stage::Tissue, 0, 0);
        let Pieces { points, pieces, .. } =
            Pieces::of(self.filler, boundary, PIECE, &watch).map_err(DomainError::Tissue)?;
        let given = numbers.len();
        let in_mesh = |v: u32| numbers.get(v as usize).copied().unwrap_or_else(|| first + v - given as u32);
        added.extend_from_slice(&points[given..]);
        let mut next = u64::from(first) + (points.len() - given) as u64;
        drop(points);
        let (done, total) = (AtomicUsize::new(0), pieces.len());
        let fill = |piece: Piece| {
            let found = self.stored(&piece, &watch)?;
            self.progress.at(Stage::Tissue, done.fetch_add(1, Ordering::Relaxed) as u64 + 1, total as u64);
            Ok((piece.numbers, found))
        };
        let filled: Vec<(Vec<u32>, (u64, u32, usize))> =
            pieces.into_par_iter().map(fill).collect::<Result<_, DomainError>>()?;
        let mut stored = Vec::with_capacity(filled.len());
        for (own, (record, points, tets)) in filled {
            let numbers = own.into_iter().map(in_mesh).collect();
            stored.push(StoredPiece { record, numbers, first: next as u32, points, tets });
            next += u64::from(points);
        }
        if next > u64::from(u32::MAX) {
            let estimate = next as usize;
            return Err(DomainError::Tissue(TetError::TooMany { estimate, limit: u32::MAX as usize }));
        }
        Ok(stored)
    }

    /// Record of a filled piece, with the number of its own points and of its tetrahedra.
    fn stored(&self, piece: &Piece, watch: &Watch) -> Result<(u64, u32, usize), DomainError> {
        let key = self.shelf.key(self.text, &piece.surface);
        let given = piece.numbers.len();
        if let Some(record) = self.shelf.find(key) {
            let counts = Filled::counts(&self.shelf.read(record, 0..Filled::HEAD)?)?;
            return Ok((record, counts[0], counts[1] as usize));
        }
        let mesh = fill_spaced(self.filler, &piece.surface, watch).map_err(DomainError::Tissue)?.mesh;
        let record = self.shelf.keep(key, Filled::bytes(&mesh.points[given..], &mesh.tets))?;
        Ok((record, (mesh.points.len() - given) as u32, mesh.tets.len()))
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
        let own: usize = self.pieces.iter().map(|piece| piece.points as usize).sum();
        let tets: usize = self.pieces.iter().map(|piece| piece.tets).sum();
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
            Kind::Tissue(piece) => {
                let end = Filled::HEAD + Filled::POINT * u64::from(piece.points);
                Ok(Filled::points(&self.shelf.read(piece.record, Filled::HEAD..end)?).into())
            }
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
                let first = Filled::HEAD + Filled::POINT * u64::from(piece.points);
                let end = first + Filled::TET * piece.tets as u64;
                let given = piece.numbers.len() as u32;
                let number = |v: u32| piece.numbers.get(v as usize).copied().unwrap_or_else(|| piece.first + v - given);
                let mut tets = Filled::tets(&self.shelf.read(piece.record, first..end)?);
                tets.as_flattened_mut().iter_mut().for_each(|v| *v = number(*v));
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
            let piece = &self.pieces[self.pieces.partition_point(|piece| piece.first <= id).saturating_sub(1)];
            let (here, others) = rest.split_at(rest.partition_point(|&id| id < piece.first + piece.points));
            if here.is_empty() {
                return Err(io::ErrorKind::InvalidInput.into());
            }
            let end = Filled::HEAD + Filled::POINT * u64::from(piece.points);
            let points = Filled::points(&self.shelf.read(piece.record, Filled::HEAD..end)?);
            found.extend(here.iter().map(|id| points[(id - piece.first) as usize]));
            rest = others;
        }
        Ok(found)
    }
}
