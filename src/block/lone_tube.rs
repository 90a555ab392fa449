//! Single-tube clusters: the end of a vessel beyond its last cut, or the piece between two cuts.

use super::layered::disc_at_end;
use super::params::{BlockParams, EndStyle};
use super::template::{self, FilledTube};
use crate::partition::{Cluster, EndKind, SHARP_BEND};
use crate::surface::SharedDisc;
use anastomesh_mesh::geometry::{Section, Vec3};

/// Meshes a single-tube cluster by template. Returns `None` for other clusters, for those with shorter edges, or if no
/// template fits.
pub(super) fn lone_tube(cluster: &Cluster, params: &BlockParams) -> Option<FilledTube> {
    if params.ends != EndStyle::Shared || !params.by_template() || !cluster.fine.is_empty() {
        return None;
    }
    let path = path(cluster)?;
    let disc = |end: usize| -> Option<SharedDisc> {
        let section = if end == 0 { path.first()? } else { path.last()? };
        disc_at_end(section, 0, params)
    };
    let caps = [0, 1].map(|end| matches!(cluster.ends[end].kind, EndKind::Terminal(_)));
    template::tube(&path, &[disc(0)?, disc(1)?], caps, params)
}

/// Sections from the first end to the second, if the cluster is a single vessel between them.
fn path(cluster: &Cluster) -> Option<Vec<Section>> {
    let [first, last] = cluster.ends.as_slice() else { return None };
    let mut overruns = [first.overrun as usize, last.overrun as usize];
    overruns.sort_unstable();
    let tubes = cluster.tubes.get(..overruns[0])?;
    if overruns != [tubes.len(), tubes.len() + 1] || cluster.tubes.len() != tubes.len() + 2 {
        return None;
    }
    let (begin, end) = (tubes.first()?, tubes.last()?);
    let whole = begin.a == first.section.origin && end.b == last.section.origin;
    if !whole || tubes.windows(2).any(|pair| pair[0].b != pair[1].a) {
        return None;
    }
    let ways: Option<Vec<Vec3>> = tubes.iter().map(|t| (t.b - t.a).try_normalize(0.0)).collect();
    let ways = ways?;
    let mut path = vec![Section { axis: -first.section.axis, ..first.section }];
    for (pair, ways) in tubes.windows(2).zip(ways.windows(2)) {
        if ways[0].angle(&ways[1]) > SHARP_BEND {
            return None;
        }
        let axis = (ways[0] + ways[1]).normalize();
        path.push(Section::new(pair[1].a, axis, 0.5 * (pair[0].rb + pair[1].ra)));
    }
    path.push(last.section);
    // Caps have the frame of the disc at the other end.
    let ends = [first, last].map(|end| end.section.up);
    path[0].up = ends[0].or(ends[1]);
    path.last_mut().into_iter().for_each(|section| section.up = ends[1].or(ends[0]));
    Some(path)
}
