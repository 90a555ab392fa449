//! Tests of the second checker on meshes that are broken in one way each.

mod common;
mod conditions;
mod program;
mod regions;
