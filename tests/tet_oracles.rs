//! The tetrahedralizer against CGAL and TetGen: the answers they gave once, which `fixtures/oracle` keeps, and where the
//! programs are there, the ones they give now.

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
