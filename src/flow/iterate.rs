//! Pressures by conjugate gradients, where elimination would fill in too much: what is left of a network with hundreds of
//! thousands of loops when its nodes of few neighbours are gone.
//!
//! A conductance is symmetric and the ground takes from every node, so the system is positive definite. Scaled by what leaves
//! each node in all, wide vessels weigh no more than thin ones. Sums are in one order: the same for any number of threads.

/// What may be missing at a node, as a share of all that flows in.
const MISSING: f64 = 1e-13;
/// Times that the iteration begins anew from what is really missing.
const ROUNDS: usize = 8;
/// Steps of a round, at most.
const STEPS: usize = 5000;
/// Sweeps at the end that level each node with its neighbours: what is left of the error is even then.
const SWEEPS: usize = 20;

/// Nodes that all conduct to others, or to the ground.
#[derive(Debug, Default)]
pub(super) struct Linked {
    /// Where each node's neighbours begin.
    first: Vec<usize>,
    /// Neighbours, each with the conductance to it.
    around: Vec<(u32, f64)>,
    /// What leaves each node at a pressure of 1: the conductance to all neighbours and to the ground.
    total: Vec<f64>,
    inflow: Vec<f64>,
}

impl Linked {
    /// Adds a node with its neighbours, the conductance to the ground and what flows in.
    pub(super) fn add(&mut self, around: impl Iterator<Item = (u32, f64)>, ground: f64, inflow: f64) {
        self.first.push(self.around.len());
        self.around.extend(around);
        let to_others: f64 = self.around[self.first[self.first.len() - 1]..].iter().map(|(_, g)| g).sum();
        self.total.push(ground + to_others);
        self.inflow.push(inflow);
    }

    /// The pressure of each node.
    pub(super) fn pressures(&self) -> Vec<f64> {
        let mut pressure = vec![0.0; self.total.len()];
        let enough = MISSING * self.inflow.iter().sum::<f64>();
        let mut before = f64::INFINITY;
        for _ in 0..ROUNDS {
            let missing = self.missing(&pressure);
            let most = missing.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
            // Beyond what doubles can tell nothing gets better.
            if most <= enough || most > 0.5 * before {
                break;
            }
            before = most;
            self.approach(&mut pressure, missing, enough);
        }
        for _ in 0..SWEEPS {
            for node in 0..pressure.len() {
                pressure[node] = (self.inflow[node] + self.through(node, &pressure)) / self.total[node];
            }
        }
        pressure
    }

    fn around(&self, node: usize) -> &[(u32, f64)] {
        let end = self.first.get(node + 1).copied().unwrap_or(self.around.len());
        &self.around[self.first[node]..end]
    }

    /// What the neighbours of a node let in.
    fn through(&self, node: usize, pressure: &[f64]) -> f64 {
        self.around(node).iter().map(|&(other, g)| g * pressure[other as usize]).sum()
    }

    /// What leaves each node and does not come in.
    fn leaves(&self, pressure: &[f64]) -> Vec<f64> {
        (0..pressure.len()).map(|node| self.total[node] * pressure[node] - self.through(node, pressure)).collect()
    }

    /// What flows into each node and does not leave.
    fn missing(&self, pressure: &[f64]) -> Vec<f64> {
        self.leaves(pressure).iter().zip(&self.inflow).map(|(out, inflow)| inflow - out).collect()
    }

    /// Conjugate gradients from some pressures on, at which so much is missing.
    fn approach(&self, pressure: &mut [f64], mut missing: Vec<f64>, enough: f64) {
        let scaled =
            |missing: &[f64]| -> Vec<f64> { missing.iter().zip(&self.total).map(|(x, total)| x / total).collect() };
        let mut step = scaled(&missing);
        let mut size = dot(&missing, &step);
        for _ in 0..STEPS {
            let leaves = self.leaves(&step);
            let along = size / dot(&step, &leaves);
            if !along.is_finite() {
                return;
            }
            let mut most = 0.0_f64;
            for node in 0..pressure.len() {
                pressure[node] += along * step[node];
                missing[node] -= along * leaves[node];
                most = most.max(missing[node].abs());
            }
            if most <= 0.1 * enough {
                return;
            }
            let down = scaled(&missing);
            let now = dot(&missing, &down);
            let turn = now / size;
            step.iter_mut().zip(&down).for_each(|(step, down)| *step = down + turn * *step);
            size = now;
        }
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
