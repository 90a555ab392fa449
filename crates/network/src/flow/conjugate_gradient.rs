//! Preconditioned conjugate gradient method (Hestenes and Stiefel 1952) for the nodal pressures of a network that is too
//! densely looped to be eliminated. The variable names are those of Barrett et al., *Templates for the Solution of Linear
//! Systems* (1994), section 2.3.1.
//!
//! The nodal conductance matrix of a network with a path to ground from every node is symmetric positive definite. The
//! preconditioner is its diagonal (Jacobi), so that wide vessels weigh no more than thin ones. Sums are in one order: the
//! result does not depend on the number of threads.

use thiserror::Error;

/// Bounds of the iteration.
#[derive(Clone, Copy, Debug)]
struct Budget {
    /// Largest residual at a node that ends the iteration, as a share of the total inflow.
    tolerance: f64,
    /// Restarts from the true residual: the recurrence for the residual drifts by rounding.
    restarts: usize,
    /// Iterations between two restarts.
    max_iterations: usize,
}

const BUDGET: Budget = Budget { tolerance: 1e-13, restarts: 8, max_iterations: 5000 };

/// Largest residual at a node that is accepted where rounding or the budget ends the iteration, as a share of the total
/// inflow. Beds of capillaries of 10,000 nodes end below 1e-10.
const ACCEPTED: f64 = 1e-6;

/// Gauss-Seidel sweeps over the solution. They spread the error that is left evenly over neighbouring nodes.
const SWEEPS: usize = 20;

/// The iteration ended above the accepted residual.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[error(
    "the flow solver did not converge: residual {residual:.1e} of the total inflow after {iterations} iterations \
     (tolerance {ACCEPTED:.0e}); check the radii of the vessels"
)]
pub struct NotConverged {
    /// Largest residual at a node, as a share of the total inflow.
    pub residual: f64,
    /// Iterations done.
    pub iterations: usize,
}

/// The system of equations: a sparse symmetric matrix by rows and its right-hand side.
#[derive(Debug, Default)]
pub(super) struct NodalSystem {
    /// Index of each row's first entry.
    row_starts: Vec<usize>,
    /// Neighbours of a node, each with the conductance to it.
    entries: Vec<(u32, f64)>,
    /// Conductance from each node to all neighbours and to ground.
    diagonal: Vec<f64>,
    inflow: Vec<f64>,
}

impl NodalSystem {
    /// Adds a node with its neighbours, its conductance to ground, and the inflow from outside.
    pub(super) fn add(&mut self, neighbors: impl Iterator<Item = (u32, f64)>, ground: f64, inflow: f64) {
        let start = self.entries.len();
        self.row_starts.push(start);
        self.entries.extend(neighbors);
        self.diagonal.push(ground + self.entries[start..].iter().map(|(_, g)| g).sum::<f64>());
        self.inflow.push(inflow);
    }

    /// Solves for the pressure of each node.
    pub(super) fn pressures(&self) -> Result<Vec<f64>, NotConverged> {
        self.solve(BUDGET)
    }

    fn solve(&self, budget: Budget) -> Result<Vec<f64>, NotConverged> {
        let mut pressure = vec![0.0; self.diagonal.len()];
        let total_inflow: f64 = self.inflow.iter().sum();
        let tolerance = budget.tolerance * total_inflow;
        let mut residual = self.residual(&pressure);
        let (mut iterations, mut restarts) = (0, 0);
        let mut previous = f64::INFINITY;
        // A restart that does not halve the residual has reached the precision of doubles.
        while max_norm(&residual) > tolerance && max_norm(&residual) <= 0.5 * previous && restarts < budget.restarts {
            previous = max_norm(&residual);
            iterations += self.iterate(&mut pressure, residual, 0.1 * tolerance, budget.max_iterations);
            residual = self.residual(&pressure);
            restarts += 1;
        }
        let left = max_norm(&residual);
        // NaN is not accepted either.
        let is_accepted = left <= ACCEPTED * total_inflow;
        if total_inflow > 0.0 && !is_accepted {
            return Err(NotConverged { residual: left / total_inflow, iterations });
        }
        for _ in 0..SWEEPS {
            for node in 0..pressure.len() {
                pressure[node] =
                    (self.inflow[node] + self.inflow_from_neighbors(node, &pressure)) / self.diagonal[node];
            }
        }
        Ok(pressure)
    }

    /// Iterates from a pressure and its residual until the largest residual is within the tolerance; returns the number of
    /// iterations.
    fn iterate(&self, pressure: &mut [f64], mut residual: Vec<f64>, tolerance: f64, max_iterations: usize) -> usize {
        let precondition =
            |residual: &[f64]| -> Vec<f64> { residual.iter().zip(&self.diagonal).map(|(r, d)| r / d).collect() };
        let mut direction = precondition(&residual);
        let mut rho = dot(&residual, &direction);
        for iteration in 0..max_iterations {
            let image = self.apply(&direction);
            let alpha = rho / dot(&direction, &image);
            if !alpha.is_finite() {
                return iteration;
            }
            for node in 0..pressure.len() {
                pressure[node] += alpha * direction[node];
                residual[node] -= alpha * image[node];
            }
            if max_norm(&residual) <= tolerance {
                return iteration + 1;
            }
            let preconditioned = precondition(&residual);
            let next_rho = dot(&residual, &preconditioned);
            let beta = next_rho / rho;
            direction.iter_mut().zip(&preconditioned).for_each(|(p, z)| *p = z + beta * *p);
            rho = next_rho;
        }
        max_iterations
    }

    /// Returns the product of the matrix and a vector: the net outflow of each node at a pressure.
    fn apply(&self, pressure: &[f64]) -> Vec<f64> {
        (0..pressure.len())
            .map(|node| self.diagonal[node] * pressure[node] - self.inflow_from_neighbors(node, pressure))
            .collect()
    }

    /// Returns the inflow of each node less its net outflow.
    fn residual(&self, pressure: &[f64]) -> Vec<f64> {
        self.apply(pressure).iter().zip(&self.inflow).map(|(out, inflow)| inflow - out).collect()
    }

    /// Returns the inflow of a node from its neighbours at a pressure of 0.
    fn inflow_from_neighbors(&self, node: usize, pressure: &[f64]) -> f64 {
        let end = self.row_starts.get(node + 1).copied().unwrap_or(self.entries.len());
        let row = &self.entries[self.row_starts[node]..end];
        row.iter().map(|&(other, g)| g * pressure[other as usize]).sum()
    }
}

fn max_norm(vector: &[f64]) -> f64 {
    vector.iter().fold(0.0, |most: f64, x| most.max(x.abs()))
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{DMatrix, DVector};

    const SIDE: usize = 6;

    /// A square grid of unit conductors with the last node grounded and the right-hand side of a given pressure.
    fn grid_with_solution(solution: impl Fn(usize) -> f64) -> (NodalSystem, Vec<f64>) {
        let expected: Vec<f64> = (0..SIDE * SIDE).map(solution).collect();
        let mut system = NodalSystem::default();
        for node in 0..SIDE * SIDE {
            let (x, y) = (node % SIDE, node / SIDE);
            let mut neighbors = Vec::new();
            neighbors.extend((x > 0).then(|| node as u32 - 1));
            neighbors.extend((x + 1 < SIDE).then_some(node as u32 + 1));
            neighbors.extend((y > 0).then(|| (node - SIDE) as u32));
            neighbors.extend((y + 1 < SIDE).then_some((node + SIDE) as u32));
            let ground = if node + 1 == SIDE * SIDE { 1.0 } else { 0.0 };
            system.add(neighbors.into_iter().map(|other| (other, 1.0)), ground, 0.0);
        }
        system.inflow = system.apply(&expected);
        (system, expected)
    }

    /// The difference of a solution from the expected one, measured by the system: the norm that the method minimises.
    fn energy_norm(system: &NodalSystem, found: &[f64], expected: &[f64]) -> f64 {
        let error: Vec<f64> = found.iter().zip(expected).map(|(a, b)| a - b).collect();
        dot(&error, &system.apply(&error)).max(0.0).sqrt()
    }

    #[test]
    fn a_network_with_loops_has_its_known_solution() {
        // Two ways round a square, of conductances 2 and 1/2, then 1 to ground: 1 + 1 / 2.5 at the inlet.
        let mut ring = NodalSystem::default();
        ring.add([(1, 4.0), (2, 1.0)].into_iter(), 0.0, 1.0);
        ring.add([(0, 4.0), (3, 4.0)].into_iter(), 0.0, 0.0);
        ring.add([(0, 1.0), (3, 1.0)].into_iter(), 0.0, 0.0);
        ring.add([(1, 4.0), (2, 1.0)].into_iter(), 1.0, 0.0);
        let found = ring.pressures().unwrap();
        assert!(found.iter().zip([1.4, 1.2, 1.2, 1.0]).all(|(a, b)| (a - b).abs() < 1e-12), "{found:?}");
    }

    #[test]
    fn the_residual_is_below_the_tolerance() {
        let (mut system, _) = grid_with_solution(|_| 0.0);
        system.inflow[0] = 2.0;
        system.inflow[17] = 0.5;
        let found = system.pressures().unwrap();
        let residual = max_norm(&system.residual(&found));
        assert!(residual <= BUDGET.tolerance * 2.5, "{residual}");
    }

    #[test]
    fn the_error_stays_within_the_convergence_bound() {
        let (system, expected) = grid_with_solution(|node| 1.0 + (7 * node % 11) as f64);
        // The condition number of the preconditioned matrix gives the bound 2 ((√κ - 1) / (√κ + 1))^k.
        let n = expected.len();
        let column = |j: usize| system.apply(&(0..n).map(|i| f64::from(i == j)).collect::<Vec<f64>>());
        let columns: Vec<DVector<f64>> = (0..n).map(|j| DVector::from_vec(column(j))).collect();
        let scale = |i: usize| system.diagonal[i].sqrt();
        let scaled = DMatrix::from_columns(&columns).map_with_location(|i, j, x| x / (scale(i) * scale(j)));
        let eigenvalues = scaled.symmetric_eigenvalues();
        let root = (eigenvalues.max() / eigenvalues.min()).sqrt();
        let start = energy_norm(&system, &vec![0.0; n], &expected);
        for iterations in [1, 5, 10, 20, 40] {
            let mut pressure = vec![0.0; n];
            let residual = system.residual(&pressure);
            system.iterate(&mut pressure, residual, 0.0, iterations);
            let bound = 2.0 * ((root - 1.0) / (root + 1.0)).powi(iterations as i32) * start;
            let error = energy_norm(&system, &pressure, &expected);
            assert!(error <= bound * (1.0 + 1e-9) + 1e-12, "{iterations} iterations: {error} > {bound}");
        }
        // In exact arithmetic the method ends after as many iterations as there are unknowns.
        let found = system.pressures().unwrap();
        assert!(energy_norm(&system, &found, &expected) < 1e-10 * start);
    }

    #[test]
    fn the_budget_ends_the_iteration_with_an_error() {
        let (mut system, _) = grid_with_solution(|_| 0.0);
        system.inflow[0] = 1.0;
        let error = system.solve(Budget { restarts: 2, max_iterations: 3, ..BUDGET }).unwrap_err();
        assert!(error.iterations <= 6 && error.residual > ACCEPTED, "{error:?}");
        assert!(error.to_string().contains("after"), "{error}");
    }
}
