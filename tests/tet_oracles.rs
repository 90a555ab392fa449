//! Comparison of the tetrahedralizer with CGAL and TetGen: with recorded answers in `fixtures/oracle`, and with the
//! programs if available.

#[path = "tet_oracles/delaunay.rs"]
mod delaunay;
#[allow(dead_code, reason = "each test binary uses its own part")]
#[path = "common/oracle.rs"]
mod oracle;
#[path = "tet_oracles/plc.rs"]
mod plc;
#[path = "tet_oracles/recorded.rs"]
mod recorded;
#[path = "tet_oracles/tetgen.rs"]
mod tetgen;
