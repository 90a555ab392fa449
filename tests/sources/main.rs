//! Tests of the repository: structure, public names, messages, texts and the pages' commands. They are not in the package.

#[path = "../common/mod.rs"]
mod common;

mod docs;
mod layering;
mod messages;
mod public_api;
mod style;
