//! Certificates of the parts, in compact form, and their combination.

use super::tallies::Tallies;
use super::{Certificate, FacesApart, HeldCap, HeldJoint, HeldSurface, Parts, sums};
use crate::check::nested::Enclosed;
use crate::check::result::{Intersection, Line};
use crate::geometry::DisjointSets;
use crate::geometry::{Aabb, Point3};
use crate::quality::QualitySum;
use rayon::prelude::*;
use rustc_hash::{FxHashMap, FxHashSet};
use std::io;
use std::ops::Range;

/// Certificates read at a time.
const READ: usize = 4096;

#[derive(Clone, Copy, Debug)]
struct Part {
    points: u32,
    wall_faces: u32,
    wall_sum: u64,
    first_surface: u32,
    first_joint: u32,
    first_component: u32,
}

/// Stored compactly: there are four for each connector.
#[derive(Clone, Copy, Debug)]
struct Joint {
    faces: u32,
    vertices: u32,
    sum: u64,
}

/// All parts; surfaces, joints and components are numbered across parts.
#[derive(Debug, Default)]
pub(super) struct Held {
    parts: Vec<Part>,
    surfaces: Vec<HeldSurface>,
    joints: Vec<Joint>,
    /// Surface and component of the joints that are not on the first ones of their parts.
    elsewhere: FxHashMap<u32, [u32; 2]>,
    /// Parts with faults of their own.
    faulty: FxHashSet<u32>,
    components: u32,
    pub caps: Vec<HeldCap>,
    pub points: u64,
    pub tets: u64,
    pub volume: f64,
    pub quality: QualitySum,
    pub intersections: Vec<Intersection>,
}

pub(super) fn invalid(what: impl Into<String>) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, what.into())
}

impl Held {
    /// Reads the certificates. Also returns the boxes of the parts.
    pub(super) fn read(parts: &dyn Parts, tallies: &mut Tallies) -> io::Result<(Self, Vec<Aabb>)> {
        let count = u32::try_from(parts.count()).map_err(|_| invalid("more than 2^32 parts"))?;
        let mut held = Self { parts: Vec::with_capacity(count as usize), ..Self::default() };
        let mut boxes = Vec::with_capacity(count as usize);
        for first in (0..count).step_by(READ) {
            let some = first..count.min(first + READ as u32);
            let certificates: Vec<Certificate> =
                some.into_par_iter().map(|part| parts.certificate(part)).collect::<io::Result<_>>()?;
            for (part, certificate) in (first..).zip(certificates) {
                boxes.push(certificate.bounds());
                held.add(parts, part, certificate, tallies)?;
            }
        }
        held.surfaces.shrink_to_fit();
        held.joints.shrink_to_fit();
        Ok((held, boxes))
    }

    fn add(&mut self, parts: &dyn Parts, part: u32, c: Certificate, tallies: &mut Tallies) -> io::Result<()> {
        self.parts.push(Part {
            points: c.points,
            wall_faces: c.wall_faces,
            wall_sum: c.wall_sum,
            first_surface: self.surfaces.len() as u32,
            first_joint: self.joints.len() as u32,
            first_component: self.components,
        });
        if !c.faults.is_empty() {
            self.faulty.insert(part);
        }
        let wrong = |j: &HeldJoint| j.surface as usize >= c.surfaces.len() || j.component >= c.components;
        // Joints that are empty or off the boundary are faults already.
        if c.faults.is_empty() && c.joints.iter().any(wrong) {
            return Err(invalid(format!("the certificate of part {part} contradicts itself")));
        }
        self.surfaces.extend(c.surfaces);
        for (number, joint) in (self.joints.len() as u32..).zip(&c.joints) {
            let HeldJoint { surface, component, faces, vertices, sum } = *joint;
            self.joints.push(Joint { faces, vertices, sum });
            if [surface, component] != [0; 2] {
                self.elsewhere.insert(number, [surface, component]);
            }
        }
        self.components += c.components;
        self.caps.extend(c.caps);
        self.points += u64::from(c.points);
        self.tets += u64::from(c.tets);
        self.volume += c.volume;
        if !self.quality.add_piece(&c.quality) {
            return Err(invalid(format!("the certificate of part {part} cannot be read")));
        }
        for fault in &c.faults {
            tallies.add_fault(parts, part, fault);
        }
        let whole = |face: [u32; 3]| face.map(|v| parts.vertex(part, v));
        let kept = c.intersections.iter().map(|i| Intersection { faces: i.faces.map(whole), kind: i.kind });
        self.intersections.extend(kept);
        Ok(())
    }

    pub(super) fn count(&self) -> u32 {
        self.parts.len() as u32
    }

    /// True if there is neither a tetrahedron nor, in a hollow part, a surface.
    pub(super) fn is_empty(&self) -> bool {
        self.tets == 0 && self.surfaces.is_empty()
    }

    pub(super) fn joint_count(&self) -> usize {
        self.joints.len()
    }

    pub(super) fn points_of(&self, part: u32) -> u32 {
        self.parts[part as usize].points
    }

    /// True if a part has no faults of its own.
    pub(super) fn is_sound(&self, part: u32) -> bool {
        !self.faulty.contains(&part)
    }

    /// Global number of a part's joint, if it exists.
    pub(super) fn joint_number(&self, (part, joint): (u32, u32)) -> Option<u32> {
        let range = self.joints_of(part)?;
        let number = range.start.checked_add(joint)?;
        range.contains(&number).then_some(number)
    }

    pub(super) fn joint(&self, number: u32) -> HeldJoint {
        let Joint { faces, vertices, sum } = self.joints[number as usize];
        let [surface, component] = self.elsewhere.get(&number).copied().unwrap_or_default();
        HeldJoint { surface, component, faces, vertices, sum }
    }

    fn joints_of(&self, part: u32) -> Option<Range<u32>> {
        let first = self.parts.get(part as usize)?.first_joint;
        let end = self.parts.get(part as usize + 1).map_or(self.joints.len() as u32, |next| next.first_joint);
        Some(first..end)
    }

    /// Numbers of a part's surfaces.
    pub(super) fn surfaces_of(&self, part: u32) -> Range<u32> {
        let first = self.parts[part as usize].first_surface;
        let end = self.parts.get(part as usize + 1).map_or(self.surfaces.len() as u32, |next| next.first_surface);
        first..end
    }

    /// Part of a surface.
    pub(super) fn part_of_surface(&self, number: u32) -> u32 {
        self.parts.partition_point(|part| part.first_surface <= number).saturating_sub(1) as u32
    }

    pub(super) fn surface(&self, number: u32) -> &HeldSurface {
        &self.surfaces[number as usize]
    }

    /// Number of faces of a part's wall, including joints without partner.
    pub(super) fn faces_of(&self, part: u32, is_joined: &[bool]) -> u64 {
        self.wall(part, is_joined).0
    }

    fn wall(&self, part: u32, is_joined: &[bool]) -> (u64, u64) {
        let held = &self.parts[part as usize];
        let open = self.joints_of(part).unwrap_or_default().filter(|&j| !is_joined[j as usize]);
        open.fold((u64::from(held.wall_faces), held.wall_sum), |(faces, sum), j| {
            let joint = self.joint(j);
            (faces + u64::from(joint.faces), sum.wrapping_add(joint.sum))
        })
    }

    /// True if a wall is the certified one. Joints off the boundary are faults already.
    pub(super) fn is_wall(&self, part: u32, is_joined: &[bool], wall: &FacesApart) -> bool {
        let (faces, sum) = self.wall(part, is_joined);
        let Some(found) = sum_of(&wall.points, &wall.faces) else { return false };
        let same = faces == wall.faces.len() as u64 && found == sum;
        wall.points.len() == wall.vertices.len() && (same || !self.is_sound(part))
    }
}

/// Checksum of faces; `None` if they refer to missing points.
pub(super) fn sum_of(points: &[Point3], faces: &[[u32; 3]]) -> Option<u64> {
    let mut sum = 0_u64;
    for face in faces {
        let [a, b, c] = face.map(|v| points.get(v as usize).map(sums::point_sum));
        sum = sum.wrapping_add(sums::face_sum([a?, b?, c?]));
    }
    Some(sum)
}

/// Components and boundary surfaces of the whole.
#[derive(Debug)]
pub(super) struct Glued {
    pub components: usize,
    /// For each surface of a part, the smallest one connected to it.
    roots: Vec<u32>,
    /// Euler number of each root.
    eulers: Vec<i64>,
    enclosed: Vec<Enclosed>,
}

impl Glued {
    /// Connects parts by pairs of joints, each a part with the number of a joint in it.
    pub(super) fn new<'a>(held: &Held, pairs: impl Iterator<Item = &'a [(u32, u32); 2]>) -> Self {
        let mut components = DisjointSets::new(held.components as usize);
        let mut surfaces = DisjointSets::new(held.surfaces.len());
        let mut joints = vec![0_i64; held.surfaces.len()];
        for pair in pairs {
            let place = |joint: (u32, u32)| {
                let of = &held.parts[joint.0 as usize];
                let joint = held.joint(held.joint_number(joint)?);
                Some((of.first_component + joint.component, of.first_surface + joint.surface))
            };
            // Joints that do not exist have been refused.
            let [Some(a), Some(b)] = pair.map(place) else { continue };
            let exist = |i: u32, n: usize| (i as usize) < n;
            if exist(a.0.max(b.0), held.components as usize) {
                components.join(a.0, b.0);
            }
            if exist(a.1.max(b.1), held.surfaces.len()) {
                surfaces.join(a.1, b.1);
                joints[a.1 as usize] += 1;
            }
        }
        let roots: Vec<u32> = (0..held.surfaces.len() as u32).map(|i| surfaces.root(i)).collect();
        let mut eulers = vec![0_i64; roots.len()];
        let mut enclosed = vec![Enclosed::default(); roots.len()];
        for (i, &root) in roots.iter().enumerate() {
            let surface = &held.surfaces[i];
            eulers[root as usize] += i64::from(surface.euler) - 2 * joints[i];
            enclosed[root as usize].add(surface.enclosed);
        }
        let components = (0..held.components).filter(|&i| components.root(i) == i).count();
        Self { components, roots, eulers, enclosed }
    }

    /// Smallest surface connected to a surface.
    pub(super) fn root(&self, surface: u32) -> u32 {
        self.roots[surface as usize]
    }

    /// Surfaces of the whole, by their smallest surfaces.
    pub(super) fn surfaces(&self) -> impl Iterator<Item = u32> {
        (0..).zip(&self.roots).filter(|&(i, &root)| i == root).map(|(_, &root)| root)
    }

    /// Surfaces of parts with this root.
    pub(super) fn joined_to(&self, root: u32) -> impl Iterator<Item = u32> {
        (0..).zip(&self.roots).filter(move |&(_, &of)| of == root).map(|(i, _)| i)
    }

    /// Number of surfaces of all parts, an upper bound on the number of roots.
    pub(super) fn roots_len(&self) -> usize {
        self.roots.len()
    }

    pub(super) fn euler(&self, root: u32) -> i64 {
        self.eulers[root as usize]
    }

    pub(super) fn enclosed(&self, root: u32) -> &Enclosed {
        &self.enclosed[root as usize]
    }
}

/// True for conditions that require usable arrays in all parts.
pub(super) fn needs_sound_arrays(line: Line) -> bool {
    !matches!(line, Line::NotEmpty | Line::FinitePoints | Line::IndicesInRange)
}
