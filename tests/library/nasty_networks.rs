//! Pathological networks: each run ends in time, with a valid mesh or an informative error. `NASTY_CASES=20` runs that
//! number of each kind instead of one; results are printed by kind.

use anastomesh::Point3;
use anastomesh::meshing::{MeshPlan, RunError, mesh_network};
use anastomesh::network::{PrepareParams, RefineParams, Skeleton, prepare, refine};
use anastomesh::skeleton::{Edge, Node, NodeId};
use std::collections::BTreeMap;
use std::time::{Duration, Instant};

/// Platform-independent xorshift generator.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.next()
    }

    fn direction(&mut self) -> [f64; 3] {
        loop {
            let v = [(); 3].map(|()| self.between(-1.0, 1.0));
            let norm = v.iter().map(|x| x * x).sum::<f64>().sqrt();
            if norm > 0.1 && norm < 1.0 {
                return v.map(|x| x / norm);
            }
        }
    }
}

#[derive(Default)]
struct Builder(Skeleton);

impl Builder {
    fn node(&mut self, place: [f64; 3], radius: f64) -> u32 {
        let id = self.0.nodes.len() as u32;
        self.0.nodes.push(Node { position: Point3::from(place), radius, original: id });
        id
    }

    fn edge(&mut self, a: u32, b: u32) {
        let radii = [a, b].map(|n| self.0.nodes[n as usize].radius);
        self.0.edges.push(Edge { nodes: [NodeId(a), NodeId(b)], radii });
    }

    /// Polyline along a curve.
    fn line(&mut self, count: u32, radius: f64, place: impl Fn(f64) -> [f64; 3]) -> Vec<u32> {
        let ids: Vec<u32> = (0..=count).map(|i| self.node(place(f64::from(i) / f64::from(count)), radius)).collect();
        ids.windows(2).for_each(|pair| self.edge(pair[0], pair[1]));
        ids
    }
}

fn along(from: [f64; 3], way: [f64; 3], length: f64) -> [f64; 3] {
    [0, 1, 2].map(|k| from[k] + way[k] * length)
}

type Make = fn(&mut Random) -> Skeleton;

/// Kinds of networks with their generators.
const KINDS: [(&str, Make); 19] = [
    ("star of up to 30 vessels", |r| {
        let mut b = Builder::default();
        let middle = b.node([0.0; 3], 1.0);
        for _ in 0..r.between(4.0, 31.0) as u32 {
            let tip = b.node(along([0.0; 3], r.direction(), r.between(8.0, 20.0)), 1.0);
            b.edge(middle, tip);
        }
        b.0
    }),
    ("fork of 0.5 to 20 degrees", |r| {
        let mut b = Builder::default();
        let angle = r.between(0.5, 20.0).to_radians();
        let ids = [[-15.0, 0.0, 0.0], [0.0; 3], [30.0, 0.0, 0.0], [30.0 * angle.cos(), 30.0 * angle.sin(), 0.0]];
        let ids = ids.map(|p| b.node(p, 1.0));
        for (i, j) in [(0, 1), (1, 2), (1, 3)] {
            b.edge(ids[i], ids[j]);
        }
        b.0
    }),
    ("radius that jumps twentyfold", |r| {
        let mut b = Builder::default();
        let ids = [[0.0; 3], [40.0, 0.0, 0.0], [80.0, 0.0, 0.0]].map(|p| b.node(p, 4.0));
        let thin = r.between(0.2, 1.0);
        b.edge(ids[0], ids[1]);
        b.edge(ids[1], ids[2]);
        let tip = b.node([40.0, r.between(10.0, 30.0), 0.0], thin);
        b.0.edges.push(Edge { nodes: [NodeId(ids[1]), NodeId(tip)], radii: [thin; 2] });
        b.0
    }),
    ("twig shorter than its radius", |r| {
        let mut b = Builder::default();
        let ids = b.line(20, 1.0, |t| [30.0 * t, 0.0, 0.0]);
        let tip = b.node([15.0, r.between(0.05, 1.5), 0.0], r.between(0.05, 1.0));
        b.edge(ids[10], tip);
        b.0
    }),
    ("loop within a lumen", |r| {
        let mut b = Builder::default();
        let ids = b.line(30, 1.0, |t| [30.0 * t, 0.0, 0.0]);
        let off = b.node([15.0, r.between(0.1, 0.9), 0.0], 0.8);
        b.edge(ids[14], off);
        b.edge(off, ids[16]);
        b.0
    }),
    ("parallel vessels 0.1 to 2.2 radii apart", |r| {
        let mut b = Builder::default();
        let apart = r.between(0.1, 2.2);
        b.line(30, 1.0, |t| [30.0 * t, 0.0, 0.0]);
        b.line(30, 1.0, |t| [30.0 * t, apart, 0.2 * t]);
        b.0
    }),
    ("exact crossing", |r| {
        let mut b = Builder::default();
        b.line(20, 1.0, |t| [30.0 * t - 15.0, 0.0, 0.0]);
        let tilt = r.between(0.0, 3.0);
        b.line(20, 1.0, |t| [tilt * (t - 0.5), 30.0 * t - 15.0, 0.0]);
        b.0
    }),
    ("one component within another", |r| {
        let mut b = Builder::default();
        b.line(20, 4.0, |t| [60.0 * t, 0.0, 0.0]);
        let off = r.between(0.0, 2.0);
        b.line(10, 0.5, |t| [20.0 + 20.0 * t, off, 0.0]);
        b.0
    }),
    ("ring", |r| {
        let mut b = Builder::default();
        let around = r.between(1.2, 8.0);
        let angle = |t: f64| std::f64::consts::TAU * t;
        let ids =
            b.line(23, 1.0, |t| [around * angle(t * 23.0 / 24.0).cos(), around * angle(t * 23.0 / 24.0).sin(), 0.0]);
        b.edge(ids[23], ids[0]);
        b.0
    }),
    ("helix", |r| {
        let mut b = Builder::default();
        let (pitch, around) = (r.between(0.5, 5.0), r.between(0.5, 4.0));
        b.line(150, 1.0, |t| {
            let a = 30.0 * t;
            [around * a.cos(), around * a.sin(), pitch * a / std::f64::consts::TAU]
        });
        b.0
    }),
    ("vessel wider than long", |r| {
        let mut b = Builder::default();
        let ids = [[0.0; 3], [r.between(0.001, 2.0), 0.0, 0.0]].map(|p| b.node(p, 1.0));
        b.edge(ids[0], ids[1]);
        b.0
    }),
    ("noise along a vessel, in tiny or huge units", |r| {
        let mut b = Builder::default();
        let unit = if r.next() < 0.5 { 1e-9 } else { 1e9 };
        let noise: Vec<[f64; 3]> = (0..=100).map(|_| along([0.0; 3], r.direction(), r.between(0.0, 0.4))).collect();
        b.line(100, unit, |t| {
            let n = noise[(100.0 * t).round() as usize];
            [unit * (40.0 * t + n[0]), unit * n[1], unit * n[2]]
        });
        b.0
    }),
    ("a vessel drawn twice, all but in one place", |r| {
        let mut b = Builder::default();
        for _ in 0..2 {
            let off = along([0.0; 3], r.direction(), 10.0_f64.powf(r.between(-12.0, -1.0)));
            b.line(30, 1.0, |t| [30.0 * t + off[0], off[1], off[2]]);
        }
        b.0
    }),
    ("theta graph", |r| {
        let mut b = Builder::default();
        let [from, to] = [0.0, 20.0].map(|x| b.node([x, 0.0, 0.0], 1.0));
        for high in [-1.0, 0.0, 1.0].map(|side| side * r.between(0.5, 12.0)) {
            let radius = r.between(0.2, 1.0);
            let ids = b.line(8, radius, |t| [2.0 + 16.0 * t, high * (1.0 - (2.0 * t - 1.0).powi(2)), 0.0]);
            b.edge(from, ids[0]);
            b.edge(ids[8], to);
        }
        b.0
    }),
    ("tree in a plane", |r| {
        let mut b = Builder::default();
        let mut front = vec![(b.node([0.0; 3], 1.0), [0.0; 3], 1.57, 1.0)];
        for _ in 0..4 {
            let parents = std::mem::take(&mut front);
            for (node, at, heading, radius) in parents {
                for side in [-1.0, 1.0] {
                    let angle: f64 = heading + side * r.between(0.2, 1.2);
                    let place = along(at, [angle.cos(), angle.sin(), 0.0], radius * r.between(3.0, 10.0));
                    let tip = b.node(place, 0.79 * radius);
                    b.edge(node, tip);
                    front.push((tip, place, angle, 0.79 * radius));
                }
            }
        }
        b.0
    }),
    ("radii over four decades", |r| {
        let mut b = Builder::default();
        let mut trunk = b.node([0.0; 3], 100.0);
        for k in 0..5 {
            let radius = 10.0_f64.powi(2 - k);
            let at = *b.0.nodes[trunk as usize].position.coords.as_ref();
            let next = b.node(along(at, [1.0, 0.0, 0.0], radius * r.between(4.0, 12.0)), 0.1 * radius);
            b.0.edges.push(Edge { nodes: [NodeId(trunk), NodeId(next)], radii: [radius; 2] });
            trunk = next;
        }
        b.0
    }),
    ("daughters that fold back by 170 to 180 degrees", |r| {
        let mut b = Builder::default();
        let [root, fork] = [[-20.0, 0.0, 0.0], [0.0; 3]].map(|p| b.node(p, 1.0));
        b.edge(root, fork);
        for side in [-1.0, 1.0] {
            let angle = r.between(0.0, 10.0).to_radians();
            let tip =
                b.node([-r.between(5.0, 30.0) * angle.cos(), side * 20.0 * angle.sin(), 0.0], r.between(0.2, 1.0));
            b.edge(fork, tip);
        }
        b.0
    }),
    ("tree in units of 1e-150 or 1e150", |r| {
        let mut b = Builder::default();
        let unit = if r.next() < 0.5 { 1e-150 } else { 1e150 };
        let ids = [[0.0; 3], [12.0, 0.0, 0.0], [20.0, 9.0, 0.0], [20.0, -8.0, 1.0]]
            .map(|p| b.node(p.map(|x| x * unit), unit));
        for (i, j) in [(0, 1), (1, 2), (1, 3)] {
            b.edge(ids[i], ids[j]);
        }
        b.0
    }),
    ("tips in a crowd", |r| {
        let mut b = Builder::default();
        let fork = b.node([0.0; 3], 1.0);
        let root = b.node([-15.0, 0.0, 0.0], 1.0);
        b.edge(root, fork);
        for _ in 0..6 {
            let tip = b.node([15.0, r.between(-2.0, 2.0), r.between(-2.0, 2.0)], 0.5);
            b.edge(fork, tip);
        }
        b.0
    }),
];

/// Outcome of a network.
fn end(given: &Skeleton) -> Result<&'static str, String> {
    let prepared = match prepare(given, &[], &PrepareParams::default()) {
        Ok(prepared) => prepared,
        Err(e) => return Ok(said(&e.to_string())),
    };
    let refined = match refine(&prepared.skeleton, &RefineParams::default(), &()) {
        Ok(refined) => refined,
        Err(e) => return Ok(said(&e.to_string())),
    };
    match mesh_network(&refined.skeleton, &MeshPlan::default(), &()) {
        Ok(made) if made.check.is_valid() => {
            // Checked again as one mesh, without prior knowledge.
            let again = anastomesh::check::check_volume(&made.mesh, Some(&made.expectation));
            if again.is_valid() { Ok("valid") } else { Err(format!("called valid: {again}")) }
        }
        Ok(_) => Ok("not valid, and says so"),
        Err(RunError::BlocksFailed(report)) => Ok(said(&report.failed[0].reason)),
        Err(e) => Ok(said(&e.to_string())),
    }
}

fn said(words: &str) -> &'static str {
    assert!(!words.is_empty());
    "an error that says why"
}

#[test]
fn every_nasty_network_ends_valid_or_says_why() {
    let cases: u64 = std::env::var("NASTY_CASES").ok().and_then(|n| n.parse().ok()).unwrap_or(1);
    let mut became: BTreeMap<(&str, &str), usize> = BTreeMap::new();
    for (name, make) in KINDS {
        for seed in 1..=cases {
            let mut random = Random(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1);
            for _ in 0..8 {
                random.next();
            }
            let start = Instant::now();
            let how = end(&make(&mut random)).unwrap_or_else(|e| panic!("{name}, seed {seed}: {e}"));
            assert!(start.elapsed() < Duration::from_secs(60), "{name}, seed {seed}: {:?}", start.elapsed());
            *became.entry((name, how)).or_default() += 1;
        }
    }
    for ((name, how), count) in &became {
        eprintln!("{name}: {how} {count}");
    }
    let valid: usize = became.iter().filter(|((_, how), _)| *how == "valid").map(|(_, count)| count).sum();
    assert!(2 * valid >= KINDS.len() * cases as usize, "{became:?}");
}
