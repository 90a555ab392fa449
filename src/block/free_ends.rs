//! Shared discs at the two ends of a connector, derived from the vessel alone, without clusters.

use super::connector_surface::{ConnectorEnd, ConnectorFault};
use super::end_surface::EndSurface;
use super::layered::disc_at_end;
use super::params::BlockParams;
use crate::partition::{Cut, CutId};
use crate::surface::SharedDisc;
use anastomesh_mesh::geometry::Section;

/// Both discs, also as end surfaces of the adjacent clusters.
pub(super) struct FreeEnds {
    pub discs: [SharedDisc; 2],
    pub surfaces: [EndSurface; 2],
}

impl FreeEnds {
    pub(super) fn new(id: CutId, cut: &Cut, params: &BlockParams) -> Result<Self, ConnectorFault> {
        let (Some(first), Some(last)) = (cut.path.first(), cut.path.last()) else { return Err(ConnectorFault::Path) };
        let outward = [*first, Section { axis: -last.axis, ..*last }];
        let disc = |side: u8| disc_at_end(&outward[usize::from(side)], side, params).ok_or(ConnectorFault::Disc(side));
        let discs = [disc(0)?, disc(1)?];
        let surfaces =
            [0_u8, 1].map(|side| EndSurface::of_disc(&discs[usize::from(side)], id, side, outward[usize::from(side)]));
        Ok(Self { discs, surfaces })
    }

    pub(super) fn both(&self) -> [ConnectorEnd<'_>; 2] {
        [0, 1].map(|side| ConnectorEnd { surface: &self.surfaces[side], points: &self.discs[side].points })
    }
}

/// End surfaces of a connector without clusters; `None` if the vessel gives no disc.
pub fn shared_ends(id: CutId, cut: &Cut, params: &BlockParams) -> Option<[EndSurface; 2]> {
    FreeEnds::new(id, cut, params).ok().map(|ends| ends.surfaces)
}
