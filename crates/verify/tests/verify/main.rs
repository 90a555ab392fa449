//! Tests of the second checker on meshes that are broken in one way each.

mod caps;
mod certificates;
mod common;
mod conditions;
mod limits;
mod program;
mod readers;
mod regions;
