//! The tetrahedralizer against CGAL and TetGen: the answers they gave once, which `fixtures/oracle` keeps, and where the
//! programs are there, the ones they give now.

#[path = "differential/delaunay.rs"]
mod delaunay;
#[allow(dead_code, reason = "each test binary uses its own part")]
#[path = "common/oracle.rs"]
mod oracle;
#[path = "differential/plc.rs"]
mod plc;
#[path = "differential/recorded.rs"]
mod recorded;
#[path = "differential/tetgen.rs"]
mod tetgen;
