//! Repairs of tetrahedra that neither smoothing nor flips improve.
//!
//! A repair inserts a vertex in a cavity around them, or contracts an edge to remove an inner vertex.

use super::improver::CavityBuffers;
use super::{Effort, Improver};
use anastomesh_mesh::geometry::{Point3, Vec3};
use anastomesh_mesh::quality::{TET_EDGES, radius_ratio};

/// Maximum tetrahedra in a cavity.
const MAX_CAVITY: usize = 40;
/// Maximum tetrahedra around an edge that a new vertex may split.
const MAX_RING: usize = 10;
/// Minimum factor by which an insertion or contraction must raise the worst radius ratio.
const GAIN: f64 = 1.1;
/// Factor of the worst radius ratio beside needles above which a rise in strain is accepted.
const LEAP: f64 = 3.0;
/// Maximum rounds over the stubborn tetrahedra.
const MAX_STUBBORN_PASSES: usize = 4;

impl Improver<'_> {
    /// Inserts and contracts vertices at tetrahedra below the stubborn limit, worst first.
    pub(super) fn treat_stubborn(&mut self) {
        for _ in 0..MAX_STUBBORN_PASSES {
            let list = self.worst_first(self.options.stubborn_below);
            let mut changes = 0;
            for &entry in &list {
                if self.is_current(entry) && self.spend() && self.treat(entry.1) {
                    changes += 1;
                }
            }
            self.keep_list(list);
            if changes == 0 {
                break;
            }
        }
    }

    fn treat(&mut self, t: u32) -> bool {
        if self.flip_tet(t) {
            self.report.flips += 1;
            return true;
        }
        if self.lift_corners(t) {
            return true;
        }
        if !self.options.keep_points && self.contract_corner(t) {
            self.report.contracted += 1;
            return true;
        }
        if self.insert_near(t) {
            self.report.inserted += 1;
            return true;
        }
        false
    }

    pub(super) fn lift_corners(&mut self, t: u32) -> bool {
        let before = self.quality[t as usize];
        let mut any = false;
        for v in self.c.verts(t) {
            if self.movable[v as usize] && self.lift_vertex(v) {
                self.report.moved += 1;
                any = true;
            }
        }
        any && self.quality[t as usize] > before * GAIN
    }

    /// Contracts a movable vertex of `t` onto one of its neighbours.
    pub(super) fn contract_corner(&mut self, t: u32) -> bool {
        for v in self.c.verts(t) {
            if self.movable[v as usize] && self.contract(v) {
                return true;
            }
        }
        false
    }

    /// Contracts movable vertex `v` onto the neighbour with the best resulting worst radius ratio.
    fn contract(&mut self, v: u32) -> bool {
        let mut k = std::mem::take(&mut self.cavity);
        k.tets.clear();
        k.tets.extend_from_slice(self.star.around(&self.c, v));
        // Full effort asks for less strain instead of a better worst ratio, which may be impossible.
        let floor = match self.options.effort {
            Effort::Quick | Effort::Fast => self.worst_of(&k.tets) * GAIN,
            Effort::Full => self.report.worst_before,
        };
        k.neighbors.clear();
        k.neighbors.extend(k.tets.iter().flat_map(|&t| self.c.verts(t)).filter(|&w| w != v));
        k.neighbors.sort_unstable();
        k.neighbors.dedup();
        let mut best = (floor, None);
        for &w in &k.neighbors {
            let q = self.worst_after_contraction(&k.tets, [v, w], best.0);
            if q > best.0 {
                best = (q, Some(w));
            }
        }
        let mut done = false;
        if let Some(w) = best.1 {
            let stays = k.tets.iter().map(|&t| self.c.verts(t)).filter(|x| !x.contains(&w));
            k.new.clear();
            k.new.extend(stays.map(|x| x.map(|u| if u == v { w } else { u })));
            done = self.eases(&k.tets, &k.new) && self.exchange(&mut k);
            if done {
                self.movable[v as usize] = false;
            }
        }
        self.cavity = k;
        done
    }

    /// Worst radius ratio around `w` if `v` is contracted onto it. Any value up to `floor` means it is not above.
    fn worst_after_contraction(&self, star: &[u32], [v, w]: [u32; 2], floor: f64) -> f64 {
        let mut worst = f64::INFINITY;
        for &t in star {
            let x = self.c.verts(t);
            if x.contains(&w) {
                continue;
            }
            let q = self.score(&x.map(|u| if u == v { w } else { u })).unwrap_or(f64::NEG_INFINITY);
            worst = worst.min(q);
            if worst <= floor {
                break;
            }
        }
        worst
    }

    /// Tries a new vertex in the middle of `t` and of each of its inner edges.
    pub(super) fn insert_near(&mut self, t: u32) -> bool {
        let mut k = std::mem::take(&mut self.cavity);
        let v = self.c.verts(t);
        let mut done = false;
        for [i, j] in TET_EDGES {
            let (a, b) = (v[i], v[j]);
            if !k.ring.collect(&self.c, t, a, b, MAX_RING) {
                continue;
            }
            // At a boundary edge, needles may leave no other choice.
            let under = k.ring.touches_ghost();
            if under && self.allowance.is_empty() {
                continue;
            }
            k.tets.clear();
            k.tets.extend(k.ring.tets.iter().filter(|&&t| !self.c.is_ghost(t)));
            let start = if under {
                self.widen(&mut k.tets);
                self.middle(&k.tets)
            } else {
                self.center([a, b])
            };
            done = self.insert_in_cavity(&mut k, start, t);
            if !done && under {
                let ends = v.into_iter().filter(|&w| w != a && w != b);
                done = self.insert_for_both(&mut k, ends, t);
            }
            if done {
                break;
            }
        }
        if !done {
            k.tets.clear();
            k.tets.push(t);
            done = self.insert_in_cavity(&mut k, self.center(v), t);
        }
        self.cavity = k;
        done
    }

    /// Tries a new vertex in growing layers of tetrahedra around `t` and the tetrahedra below a radius ratio connected
    /// to it. If they all lie in a flat patch, the vertex goes off its plane.
    pub(super) fn insert_beside(&mut self, t: u32, below: f64, layers: usize) -> bool {
        let mut k = std::mem::take(&mut self.cavity);
        let mut done = false;
        for layer in 1..=layers {
            k.tets.clear();
            k.tets.push(t);
            self.spread(&mut k.tets, below);
            for _ in 0..layer {
                self.widen(&mut k.tets);
            }
            let start = self.middle(&k.tets);
            done = self.insert_in_cavity(&mut k, start, t);
            if done {
                break;
            }
        }
        self.cavity = k;
        done
    }

    /// Replaces the two vertices of `t` off a boundary edge by one, if both may go. Of the tetrahedra around the edge,
    /// those on the boundary remain.
    pub(super) fn insert_for_both(&mut self, k: &mut CavityBuffers, ends: impl Iterator<Item = u32>, t: u32) -> bool {
        let mut pair = [0; 2];
        for (slot, w) in pair.iter_mut().zip(ends) {
            *slot = w;
        }
        if self.options.keep_points || pair.iter().any(|&w| !self.movable[w as usize]) {
            return false;
        }
        k.tets.clear();
        for w in pair {
            k.tets.extend_from_slice(self.star.around(&self.c, w));
        }
        k.tets.sort_unstable();
        k.tets.dedup();
        let done = self.insert_in_cavity(k, self.center(pair), t);
        if done {
            for w in pair {
                self.movable[w as usize] = false;
            }
        }
        done
    }

    fn center<const N: usize>(&self, v: [u32; N]) -> Point3 {
        Point3::from(v.iter().map(|&w| self.c.points[w as usize].coords).sum::<Vec3>() / N as f64)
    }

    /// Adds connected tetrahedra below a radius ratio.
    fn spread(&self, tets: &mut Vec<u32>, below: f64) {
        let mut head = 0;
        while let Some(&t) = tets.get(head).filter(|_| tets.len() < MAX_CAVITY) {
            head += 1;
            for half in 4 * t..4 * t + 4 {
                let n = self.c.mate(half) >> 2;
                let crossed = !self.c.is_frozen(half) && !self.c.is_ghost(n) && self.quality[n as usize] < below;
                if crossed && !tets.contains(&n) {
                    tets.push(n);
                }
            }
        }
    }

    /// Adds the neighbours of tetrahedra, since the ring of a short edge is too narrow.
    fn widen(&self, tets: &mut Vec<u32>) {
        for at in 0..tets.len() {
            for half in 4 * tets[at]..4 * tets[at] + 4 {
                let n = self.c.mate(half) >> 2;
                if !self.c.is_frozen(half) && !self.c.is_ghost(n) && !tets.contains(&n) {
                    tets.push(n);
                }
            }
        }
    }

    /// Mean of the centres of tetrahedra.
    fn middle(&self, tets: &[u32]) -> Point3 {
        let sum: Vec3 = tets.iter().map(|&t| self.center(self.c.verts(t)).coords).sum();
        Point3::from(sum / tets.len().max(1) as f64)
    }

    /// Grows the cavity `k.tets` around a new vertex near `p` while that helps, and positions the vertex. Makes the
    /// exchange if the worst radius ratio rises.
    fn insert_in_cavity(&mut self, k: &mut CavityBuffers, mut p: Point3, t: u32) -> bool {
        let floor = self.quality[t as usize] * GAIN;
        if !self.outline(k) {
            return false;
        }
        let mut worst = f64::NEG_INFINITY;
        for _ in 0..MAX_CAVITY {
            (p, worst) = self.place_in_cavity(p, &k.faces);
            if !self.grow(k, &p, worst) {
                break;
            }
        }
        let before = self.worst_of(&k.tets);
        if worst <= floor || worst <= before * GAIN || !self.sees(&p, &k.faces) || !self.may_remove_inner(k) {
            return false;
        }
        let vertex = self.c.add_point(p);
        self.movable.push(true);
        k.new.clear();
        k.new.extend(k.faces.iter().map(|&[a, b, c]| [vertex, a, b, c]));
        // A large rise of the worst ratio beside needles outweighs more strain, which later rounds can reduce.
        let leap = !self.allowance.is_empty() && worst > LEAP * before;
        if (leap || self.eases(&k.tets, &k.new)) && self.exchange(k) {
            return true;
        }
        self.c.pop_point();
        self.movable.pop();
        false
    }

    /// Collects the outer faces of the cavity. Returns false if it has too many tetrahedra or a frozen face inside.
    fn outline(&self, k: &mut CavityBuffers) -> bool {
        k.faces.clear();
        k.halves.clear();
        for &t in &k.tets {
            for half in 4 * t..4 * t + 4 {
                if !k.tets.contains(&(self.c.mate(half) >> 2)) {
                    k.faces.push(self.c.face(half));
                    k.halves.push(half);
                } else if self.c.is_frozen(half) {
                    return false;
                }
            }
        }
        k.tets.len() <= 2 * MAX_CAVITY
    }

    /// Adds the tetrahedron behind the worst face, if the vertex sees its other faces better.
    fn grow(&self, k: &mut CavityBuffers, p: &Point3, worst: f64) -> bool {
        let ratio = |f: &[u32; 3]| {
            let [a, b, c] = f.map(|w| &self.c.points[w as usize]);
            radius_ratio(p, a, b, c) / self.allowance.of_face(*f)
        };
        let Some(at) = (0..k.faces.len()).min_by(|&i, &j| ratio(&k.faces[i]).total_cmp(&ratio(&k.faces[j]))) else {
            return false;
        };
        let half = k.halves[at];
        let mate = self.c.mate(half);
        let n = mate >> 2;
        if self.c.is_frozen(half) || self.c.is_ghost(n) || k.tets.len() >= MAX_CAVITY {
            return false;
        }
        let others = (4 * n..4 * n + 4).filter(|&h| h != mate);
        let better =
            others.filter(|&h| !k.tets.contains(&(self.c.mate(h) >> 2))).all(|h| ratio(&self.c.face(h)) > worst);
        if better {
            k.tets.push(n);
            if !self.outline(k) {
                k.tets.pop();
                self.outline(k);
                return false;
            }
        }
        better
    }

    /// True if every vertex inside the cavity may be removed.
    fn may_remove_inner(&self, k: &CavityBuffers) -> bool {
        let on_outline = |v: u32| k.faces.iter().any(|f| f.contains(&v));
        k.tets
            .iter()
            .flat_map(|&t| self.c.verts(t))
            .all(|v| on_outline(v) || (!self.options.keep_points && self.movable[v as usize]))
    }

    /// Exchanges `k.tets` for `k.new`.
    fn exchange(&mut self, k: &mut CavityBuffers) -> bool {
        let done = self.c.replace(&k.tets, &k.new, &mut k.created);
        if done {
            self.remeasure(&k.created);
        }
        done
    }
}
