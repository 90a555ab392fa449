//! Reader of `OpenFOAM` cases: mesh, and velocity, pressure and face fluxes of the latest time.

mod assemble;
mod case;
mod data;
mod dictionary;
mod poly_mesh;

pub(super) use case::read;
