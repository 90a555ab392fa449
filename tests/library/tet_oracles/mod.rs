//! Comparison of the tetrahedralizer with CGAL and TetGen: with recorded answers in `fixtures/oracle`, and with the
//! programs if available.

mod delaunay;
mod plc;
mod recorded;
mod tetgen;
