//! Assignment of cells to parts: ranges of blocks along the tree of blocks.

use super::bisect::{Site, bisect};
use super::error::PartsError;
use super::tree::BlockGraph;
use anastomesh_mesh::geometry::hilbert::{Grid, hilbert_key};
use anastomesh_mesh::geometry::{Aabb, Point3, Vec3};
use anastomesh_mesh::source::{MeshSource, miscounted};
use anastomesh_mesh::stacks::Cells;
use rustc_hash::FxHashSet;
use std::io;
use std::num::NonZeroUsize;
use std::ops::Range;

/// Bits per axis of positions along the Hilbert curve.
const BITS: u32 = 20;

/// Maximum distance of a cut from its ideal place, as a fraction of the mean part, for a cut between two blocks. Sizes of
/// parts thus differ from the mean by at most 3 %. A cut between blocks is a disc of about 20 faces; a cut through a
/// bifurcation has hundreds.
const TOLERANCE: f64 = 0.015;

/// Consecutive cells of a source: a part of it, or tetrahedra of one block in a source with a single part.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(in crate::volume) struct CellRun {
    /// Part of the source.
    pub source: u32,
    /// Number of the first tetrahedron of that part.
    pub start: u32,
    /// Tetrahedra.
    pub tets: Range<u32>,
    /// Cells that begin in the run.
    pub cells: Range<u32>,
    place: Place,
}

/// Parts of the cells of a run.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Place {
    /// One part, with the number in it of the first cell.
    Whole { part: u32, local: u32 },
    /// Several parts.
    Divided {
        /// New position of each cell in the run: the cells of the first part come first.
        order: Vec<u32>,
        pieces: Vec<Piece>,
    },
}

/// Cells of a divided run in one part.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Piece {
    part: u32,
    /// First of their new positions.
    start: u32,
    /// Number in the part of their first cell.
    local: u32,
}

/// Balanced parts of a mesh. Part sizes differ from the mean by at most 3 %, and by one cell at least.
///
/// Blocks are ordered along the trees of blocks that share points, and the trees along a Hilbert curve. Parts are ranges
/// of this order. A block at the end of a range is divided by planes ([`bisect`]), unless its end is near. Cells in a
/// part keep the order of the mesh.
///
/// Needs about 200 bytes per block, and 4 bytes per cell of the divided blocks, of which there are fewer than parts. A mesh
/// without blocks is one block. While blocks are ordered, 4 bytes per point are held. While a block is divided, 16 bytes per
/// cell of it are held, and its corners.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(in crate::volume) struct Partition {
    /// In the order of the mesh.
    runs: Vec<CellRun>,
    /// Number of cells of each part.
    sizes: Vec<u32>,
}

/// Sums over the tetrahedra of a run.
struct RunSums {
    tets: u32,
    /// Sum of the centres.
    centre: Vec3,
    bounds: Aabb,
    /// Points, ascending; empty if there is a single run.
    points: Vec<u32>,
}

impl Partition {
    /// Divides the cells of a mesh: `cells`, or tetrahedra. Reads the mesh once, and divided blocks once more.
    ///
    /// # Errors
    /// The mesh source fails; `PartsError` if there are more parts than cells.
    pub(in crate::volume) fn of(mesh: &dyn MeshSource, parts: NonZeroUsize, cells: Option<&Cells>) -> io::Result<Self> {
        let count = cells.map_or(mesh.counts().tets, Cells::len);
        if count < parts.get() || u32::try_from(count).is_err() {
            return Err(PartsError::TooFewCells { parts: parts.get(), cells: count }.into());
        }
        let (mut runs, mut centres) = (Vec::new(), Vec::new());
        let mut bounds = Aabb::EMPTY;
        let mut joints = Joints::default();
        let (mut source, mut start, mut at) = (0, 0_u32, 0_u32);
        // Number of cells that begin before a tetrahedron.
        let before = |tet: u32| match (cells, tet.checked_sub(1)) {
            (Some(cells), Some(last)) => cells.of_tet(last) + 1,
            _ => tet,
        };
        mesh.each_part(
            |part| sums_of(mesh, part),
            |sums| {
                for sum in sums {
                    let end = at.checked_add(sum.tets).filter(|&end| end as usize <= mesh.counts().tets);
                    let tets = at..end.ok_or_else(miscounted)?;
                    at = tets.end;
                    let cells = before(tets.start)..before(tets.end);
                    runs.push(CellRun { source, start, tets, cells, place: Place::Whole { part: 0, local: 0 } });
                    centres.push(Point3::from(sum.centre / f64::from(sum.tets)));
                    joints.add(runs.len() as u32 - 1, &sum.points);
                    bounds = bounds.union(&sum.bounds);
                }
                (source, start) = (source + 1, at);
                Ok(())
            },
        )?;
        if at as usize != mesh.counts().tets {
            return Err(miscounted());
        }
        let grid = Grid::new([bounds.min, bounds.max], BITS);
        let mut along: Vec<u32> = (0..runs.len() as u32).collect();
        along.sort_by_cached_key(|&run| (hilbert_key(grid.cell(&centres[run as usize]), BITS), run));
        let sizes = runs.iter().map(|run| run.cells.len() as u64).collect();
        let order = joints.graph(sizes).in_preorder(along);
        let shares = shares(&order, &runs, count, parts.get());
        let mut partition = Self { runs, sizes: vec![0; parts.get()] };
        partition.assign(mesh, cells, &starts(&order, &centres), &shares)?;
        Ok(partition)
    }

    /// Gives each run its parts, and each cell its number in its part.
    fn assign(
        &mut self,
        mesh: &dyn MeshSource,
        cells: Option<&Cells>,
        starts: &[Point3],
        shares: &[Vec<Share>],
    ) -> io::Result<()> {
        for ((run, shares), &from) in self.runs.iter_mut().zip(shares).zip(starts) {
            let mut pieces: Vec<Piece> = Vec::with_capacity(shares.len());
            let mut start = 0;
            for share in shares {
                let local = &mut self.sizes[share.part as usize];
                pieces.push(Piece { part: share.part, start, local: *local });
                (start, *local) = (start + share.cells, *local + share.cells);
            }
            run.place = match pieces[..] {
                [Piece { part, local, .. }] => Place::Whole { part, local },
                // A run without cells: its tetrahedra belong to a cell of the run before.
                [] => Place::Whole { part: 0, local: 0 },
                _ => Place::Divided { order: divided(mesh, cells, run, from, &pieces)?, pieces },
            };
        }
        Ok(())
    }

    /// Number of parts.
    pub(in crate::volume) fn parts(&self) -> usize {
        self.sizes.len()
    }

    /// Number of cells of each part.
    pub(in crate::volume) fn sizes(&self) -> &[u32] {
        &self.sizes
    }

    /// Starts looking up cells.
    pub(in crate::volume) fn lookup(&self) -> Lookup<'_> {
        Lookup { partition: self, last: 0 }
    }

    /// Cells of a part, ascending.
    pub(in crate::volume) fn cells_of(&self, part: u32) -> Vec<u32> {
        let mut cells = Vec::with_capacity(self.sizes[part as usize] as usize);
        for run in self.runs_of(part) {
            match run.only_part() {
                Some(_) => cells.extend(run.cells.clone()),
                None => cells.extend(run.cells.clone().filter(|&cell| run.locate(cell).0 == part)),
            }
        }
        cells
    }

    /// Runs with cells of a part, in the order of the mesh.
    pub(in crate::volume) fn runs_of(&self, part: u32) -> impl Iterator<Item = &CellRun> {
        self.runs.iter().filter(move |run| run.has(part))
    }
}

impl CellRun {
    /// True if cells of the run are in the part.
    pub(in crate::volume) fn has(&self, part: u32) -> bool {
        match &self.place {
            Place::Whole { part: only, .. } => *only == part && !self.cells.is_empty(),
            Place::Divided { pieces, .. } => pieces.iter().any(|piece| piece.part == part),
        }
    }

    /// The part of all cells; `None` if there are several.
    pub(in crate::volume) fn only_part(&self) -> Option<u32> {
        match self.place {
            Place::Whole { part, .. } => Some(part),
            Place::Divided { .. } => None,
        }
    }

    /// Part of a cell of the run, and its number there.
    fn locate(&self, cell: u32) -> (u32, u32) {
        let index = cell - self.cells.start;
        match &self.place {
            Place::Whole { part, local } => (*part, local + index),
            Place::Divided { order, pieces } => {
                let place = order[index as usize];
                let piece = &pieces[pieces.partition_point(|piece| piece.start <= place).saturating_sub(1)];
                (piece.part, piece.local + place - piece.start)
            }
        }
    }
}

/// Looks up cells, faster in the order of the mesh.
pub(in crate::volume) struct Lookup<'a> {
    partition: &'a Partition,
    /// Run of the last cell.
    last: usize,
}

impl Lookup<'_> {
    /// Part of a cell, and its number among the cells of the part.
    pub(in crate::volume) fn locate(&mut self, cell: u32) -> (u32, u32) {
        let runs = &self.partition.runs;
        if !runs[self.last].cells.contains(&cell) {
            self.last = runs.partition_point(|run| run.cells.end <= cell).min(runs.len() - 1);
        }
        runs[self.last].locate(cell)
    }
}

/// Cells of a run in one part.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Share {
    part: u32,
    cells: u32,
}

/// Runs that share points.
#[derive(Default)]
struct Joints {
    /// First run of each point.
    first: Vec<u32>,
    pairs: FxHashSet<[u32; 2]>,
}

impl Joints {
    /// Adds the points of the next run.
    fn add(&mut self, run: u32, points: &[u32]) {
        if let Some(&last) = points.last()
            && self.first.len() <= last as usize
        {
            self.first.resize(last as usize + 1, u32::MAX);
        }
        for &v in points {
            let first = &mut self.first[v as usize];
            if *first == u32::MAX {
                *first = run;
            } else if *first != run {
                self.pairs.insert([*first, run]);
            }
        }
    }

    fn graph(self, sizes: Vec<u64>) -> BlockGraph {
        let mut neighbors = vec![Vec::new(); sizes.len()];
        let mut pairs: Vec<[u32; 2]> = self.pairs.into_iter().collect();
        pairs.sort_unstable();
        for [a, b] in pairs {
            neighbors[a as usize].push(b);
            neighbors[b as usize].push(a);
        }
        BlockGraph { neighbors, sizes }
    }
}

/// Centre of the run before each run in this order; of the first one its own.
fn starts(order: &[u32], centres: &[Point3]) -> Vec<Point3> {
    let mut starts = centres.to_vec();
    for two in order.windows(2) {
        starts[two[1] as usize] = centres[two[0] as usize];
    }
    starts
}

/// Shares of each run, for runs in this order.
fn shares(order: &[u32], runs: &[CellRun], cells: usize, parts: usize) -> Vec<Vec<Share>> {
    let lengths: Vec<u64> = order.iter().map(|&run| runs[run as usize].cells.len() as u64).collect();
    let cuts = cuts(&lengths, cells as u64, parts as u64);
    let mut shares = vec![Vec::new(); runs.len()];
    let (mut at, mut part) = (0, 0);
    for (&run, length) in order.iter().zip(lengths) {
        let end = at + length;
        while at < end {
            let until = cuts.get(part).copied().unwrap_or(u64::MAX).min(end);
            if until > at {
                shares[run as usize].push(Share { part: part as u32, cells: (until - at) as u32 });
                at = until;
            }
            part += usize::from(cuts.get(part) == Some(&at));
        }
    }
    shares
}

/// Positions between parts: at the ideal place, or at the end of a run near it.
fn cuts(lengths: &[u64], cells: u64, parts: u64) -> Vec<u64> {
    let tolerance = (TOLERANCE * cells as f64 / parts as f64) as u64;
    let mut ends = lengths.iter().scan(0, |sum, length| {
        *sum += length;
        Some(*sum)
    });
    let (mut before, mut after) = (0, ends.next().unwrap_or(cells));
    let mut cut = |ideal: u64| {
        while after < ideal {
            before = after;
            after = ends.next().unwrap_or(cells);
        }
        let nearest = if ideal - before < after - ideal { before } else { after };
        // The tolerance is less than half a part, so that cuts ascend.
        if nearest.abs_diff(ideal) <= tolerance { nearest } else { ideal }
    };
    (1..parts).map(|part| cut((u128::from(part) * u128::from(cells) / u128::from(parts)) as u64)).collect()
}

/// Minimum mean length of the runs of a mesh in memory. Tetrahedra of scattered blocks are divided one by one.
const MIN_MEAN_RUN: usize = 20;

/// Sums over the runs of a part of the source: the blocks of a source with one part, else the whole part.
fn sums_of(mesh: &dyn MeshSource, part: u32) -> io::Result<Vec<RunSums>> {
    let piece = mesh.tets(part)?;
    let mut lengths = vec![piece.tets.len()];
    if mesh.parts() == 1 && piece.blocks.len() == piece.tets.len() {
        let runs = || piece.blocks.chunk_by(|a, b| a == b);
        if runs().count() <= piece.tets.len() / MIN_MEAN_RUN {
            lengths = runs().map(<[i32]>::len).collect();
        }
    }
    let mut rest = &piece.tets[..];
    let mut sums = Vec::with_capacity(lengths.len());
    for length in lengths.into_iter().filter(|&length| length > 0) {
        let (tets, after) = rest.split_at(length);
        rest = after;
        let mut sum = RunSums { tets: length as u32, centre: Vec3::zeros(), bounds: Aabb::EMPTY, points: Vec::new() };
        if mesh.parts() > 1 || length < piece.tets.len() {
            sum.points = tets.as_flattened().to_vec();
            sum.points.sort_unstable();
            sum.points.dedup();
            // A missing point is an error that the corners show.
            sum.points.retain(|&v| (v as usize) < mesh.counts().points);
        }
        each_corners(mesh, tets, |corners| {
            sum.centre += centre_of(corners);
            for corner in corners {
                sum.bounds.include(corner);
            }
        })?;
        sums.push(sum);
    }
    Ok(sums)
}

/// Passes on the corners of tetrahedra, in order.
fn each_corners(mesh: &dyn MeshSource, tets: &[[u32; 4]], mut each: impl FnMut(&[Point3; 4])) -> io::Result<()> {
    if mesh.parts() > 1 {
        mesh.corners_of(tets)?.iter().for_each(each);
        return Ok(());
    }
    // One part is in memory.
    let points = mesh.points(0)?;
    for tet in tets {
        match tet.map(|v| points.get(v as usize).copied()) {
            [Some(a), Some(b), Some(c), Some(d)] => each(&[a, b, c, d]),
            _ => return Err(io::Error::new(io::ErrorKind::InvalidData, "a cell names a point that does not exist")),
        }
    }
    Ok(())
}

fn centre_of(corners: &[Point3; 4]) -> Vec3 {
    let [a, b, c, d] = corners.map(|corner| corner.coords);
    (a + b + c + d) * 0.25
}

/// New positions of the cells of a run, which has several parts. The first part is on the side of `from`.
fn divided(
    mesh: &dyn MeshSource,
    cells: Option<&Cells>,
    run: &CellRun,
    from: Point3,
    pieces: &[Piece],
) -> io::Result<Vec<u32>> {
    let tets = mesh.tets(run.source)?.tets;
    let inside = (run.tets.start - run.start) as usize..(run.tets.end - run.start) as usize;
    let tets = tets.get(inside).ok_or_else(miscounted)?;
    let cell_of = |tet: u32| cells.map_or(tet, |cells| cells.of_tet(tet)).checked_sub(run.cells.start);
    // The place of a cell is that of its first tetrahedron.
    let mut sites: Vec<Site> = Vec::with_capacity(run.cells.len());
    let (mut tet, mut origin) = (run.tets.start, None);
    each_corners(mesh, tets, |corners| {
        if let Some(cell) = cell_of(tet).filter(|&cell| cell as usize == sites.len()) {
            let centre = centre_of(corners);
            sites.push(Site::new(centre - *origin.get_or_insert(centre), cell));
        }
        tet += 1;
    })?;
    if sites.len() != run.cells.len() {
        return Err(miscounted());
    }
    let ends = pieces.iter().skip(1).map(|piece| piece.start as usize).chain([sites.len()]);
    let sizes: Vec<usize> = pieces.iter().zip(ends).map(|(piece, end)| end - piece.start as usize).collect();
    bisect(&mut sites, &sizes, from - origin.unwrap_or_default());
    let mut order = vec![0; sites.len()];
    let mut rest = &sites[..];
    for (piece, size) in (0..).zip(sizes) {
        let (own, after) = rest.split_at(size);
        for site in own {
            order[site.cell as usize] = piece;
        }
        rest = after;
    }
    let mut next: Vec<u32> = pieces.iter().map(|piece| piece.start).collect();
    for place in &mut order {
        let piece = *place as usize;
        *place = next[piece];
        next[piece] += 1;
    }
    Ok(order)
}
